//! Lists the candidates of a search: every effect at every place that a campaign could show, with the largest size that
//! is sought and the points where fits start.

use super::expected::Sizes;
use super::parameters::{Candidate, FreeParameter, Number};
use crate::arm::BASE;
use crate::arm::effect::catalogue::KINDS;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::immersion::PAYLOAD_DENSITY;
use crate::arm::effect::kind::{ElasticRotation, Freed, Kind, Parameter, Place, Removes, Scale, Setting};
use crate::arm::effect::soft_windup::MIDDLE_SLOPE;
use crate::arm::effect::validate::fits_nominal;
use crate::arm::effect::wrong_unit::{self, UnitColumn, UnitSlip};
use crate::arm::effect::{connection_compliance, servo_compliance, thermal_modulus, travel_compliance};
use crate::arm::joint_law::Curve;
use crate::arm::structure::Piece;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::forward::statics::StaticPose;
use std::ops::RangeInclusive;

/// The candidates of a campaign: every effect at every place of the arm that the channels of the campaign could show.
pub fn candidates(forward: &Forward) -> Vec<Candidate> {
    let structure = &forward.nominal.structure;
    let sizes = Sizes::of(forward);
    let mut out = Vec::new();
    for kind in KINDS.iter().filter(|kind| kind.traits.is_sought) {
        for place in kind.places {
            for at in structure.places(*place) {
                if fits_nominal(kind, &at, structure) && channel_is_sought(forward, kind, *place) {
                    out.extend(variants(forward, &sizes, kind, *place, &at));
                }
            }
        }
    }
    // an effect with two names would count twice, and each name would be listed as an alternative of the other
    merge_twins(forward, &mut out);
    name_servos(forward, &mut out);
    out.extend(unit_slips(forward));
    out
}

/// Merges candidates that stand for the same compliance in this arm. If the first joint is vertical and at the
/// origin, the tilt of its bearing is the same as the tilt of the base.
fn merge_twins(forward: &Forward, candidates: &mut Vec<Candidate>) {
    let Some(Piece::Joint(first)) = forward.nominal.structure.pieces.first() else { return };
    if first.axis.z.abs() < 1.0 - 1e-12 {
        return;
    }
    let twin_of = |c: &Candidate| c.kind.traits.same_at_vertical_first_joint;
    let twins: Vec<&str> = candidates.iter().filter_map(twin_of).collect();
    candidates.retain(|c| !(twins.contains(&c.kind.name) && c.at == first.name));
    for candidate in candidates {
        candidate.twins.extend(twin_of(candidate).map(|twin| (twin.to_string(), first.name.clone())));
    }
}

/// Lists the compliance of a servo as a twin of a joint's connection compliance if only one channel shows how the
/// joint twists. The readings then cannot tell whether the joint is softer in this channel only.
fn name_servos(forward: &Forward, candidates: &mut [Candidate]) {
    for candidate in candidates.iter_mut().filter(|c| c.kind.name == connection_compliance::KIND.name) {
        let shown = channels_of_joint(forward, &candidate.at);
        if shown.len() == 1 && servo_compliance::KIND.traits.sought_in.contains(&shown[0]) {
            candidate.twins.push((servo_compliance::KIND.name.into(), candidate.at.clone()));
        }
    }
}

fn channel_is_sought(forward: &Forward, kind: &Kind, place: Place) -> bool {
    let is_tried = |channel| kind.traits.sought_in.is_empty() || kind.traits.sought_in.contains(&channel);
    match place {
        Place::Channel(channel) => !forward.range(channel).is_empty() && is_tried(channel),
        _ => true,
    }
}

/// The candidates of a kind of effect at the place named `at`: one for each set of parameters that may be fitted
/// (variant), or one for each channel if the effect acts in one channel.
fn variants(forward: &Forward, sizes: &Sizes, kind: &'static Kind, place: Place, at: &str) -> Vec<Candidate> {
    let asked = Asked { kind, place, at, freed: None, channel: None };
    let candidate = |asked: Asked| candidate(forward, sizes, asked);
    if (kind.parameters)(place).iter().any(|p| p.is_channel) {
        let channels = channels_apart(forward, kind, at).into_iter();
        return channels.map(|channel| candidate(Asked { channel: Some(channel), ..asked })).collect();
    }
    match kind.traits.variants {
        [] => vec![candidate(asked)],
        several => {
            let several = several.iter().filter(|freed| is_measured(forward, freed));
            several.map(|freed| candidate(Asked { freed: Some(freed), ..asked })).collect()
        }
    }
}

/// Whether the readings contain the quantity to which the fitted parameters `freed` refer, such as temperatures.
fn is_measured(forward: &Forward, freed: &[Freed]) -> bool {
    forward.has_temperatures || freed.iter().all(|(name, _)| *name != thermal_modulus::PER_K)
}

/// An effect at a place, and which of its parameters are fitted.
#[derive(Clone, Copy)]
struct Asked<'a> {
    kind: &'static Kind,
    place: Place,
    at: &'a str,
    /// The parameters that are fitted in a variant of the effect. `None` means that all parameters without a default
    /// value are fitted.
    freed: Option<&'static [Freed]>,
    /// The channel in which the effect acts, if the effect has a channel as a parameter.
    channel: Option<Channel>,
}

/// The channels in which a further compliance of the joint is sought. Each of these compliances acts in the tests of
/// its channel only. Empty if a single channel shows how the joint twists, because the compliance could then not be
/// told from one that acts in all channels.
fn channels_apart(forward: &Forward, kind: &Kind, joint: &str) -> Vec<Channel> {
    let shown = channels_of_joint(forward, joint);
    let sought = kind.traits.sought_in.iter().filter(|channel| shown.contains(channel));
    sought.copied().filter(|_| shown.len() > 1).collect()
}

/// The channels of the campaign that show how the joint named `joint` twists.
fn channels_of_joint(forward: &Forward, joint: &str) -> Vec<Channel> {
    let index = forward.layout.joints.iter().position(|slot| slot.name == joint);
    let on_bench = index.is_some_and(|index| forward.bench_torques_nm(index).next().is_some());
    let is_shown = |channel: &Channel| match channel {
        Channel::Windup => on_bench,
        other => !forward.range(*other).is_empty(),
    };
    Channel::ALL.into_iter().filter(is_shown).collect()
}

/// Whether the component with index `component` of a parameter is fitted. `freed` lists the fitted parameters of a
/// variant; with `None`, the parameters without a default value are fitted.
fn is_free(parameter: &Parameter, component: usize, freed: Option<&[Freed]>) -> bool {
    let Some(freed) = freed else { return parameter.default.is_none() && !parameter.is_channel };
    let is_own = |(name, one): &Freed| *name == parameter.name && one.is_none_or(|one| one == component);
    freed.iter().any(is_own)
}

/// The value of a parameter that is not fitted, in the parameter's unit. `channel` is the value of a parameter that
/// names a channel.
fn stated(forward: &Forward, parameter: &Parameter, channel: Option<Channel>) -> f64 {
    match parameter.name {
        _ if parameter.is_channel => channel.map_or(0.0, |channel| channel as usize as f64),
        PAYLOAD_DENSITY => forward.payload_density_kg_m3,
        _ => parameter.default.unwrap_or_default(),
    }
}

fn candidate(forward: &Forward, sizes: &Sizes, asked: Asked) -> Candidate {
    let Asked { kind, place, freed, channel, .. } = asked;
    let at = asked.at.to_string();
    let joint_stiffness = match place {
        Place::Prismatic => reference_of_prismatic(forward, kind, &at),
        _ => reference_stiffness(forward, &at),
    };
    let bearing = nominal_bearing_nm_per_rad(forward, kind, &at);
    let reference = match kind.traits.is_gear_curve {
        true => middle_stiffness(forward, &at),
        false => bearing.unwrap_or(joint_stiffness),
    };
    // at least 1 N m, so that logarithms exist for a joint without torque
    let torque_nm = largest_torque_nm(forward, &at).max(1.0);
    let mut free_parameters = Vec::new();
    let mut numbers = Vec::new();
    let mut fitted = Vec::new();
    for parameter in (kind.parameters)(place) {
        let sized = &of_size(parameter, sizes);
        for component in 0..parameter.count {
            if is_free(parameter, component, freed) {
                let reference = if parameter.scale == Scale::Torque { torque_nm } else { reference };
                let free = FreeParameter::new(sized, component, reference);
                let free = within_torque(free, parameter, torque_nm);
                let free = within_tolerance(free, parameter, forward.stiffness_tolerance);
                free_parameters.push(within_rows(free, rows_of_campaign(forward)));
                fitted.push(parameter);
                numbers.push(Number::Free);
            } else {
                numbers.push(Number::Stated(stated(forward, parameter, channel)));
            }
        }
    }
    if let Some(stiffness) = bearing {
        // here the upper limit is a multiple of the bearing's compliance; it is raised to the largest compliance that
        // is sought for a rigid bearing
        free_parameters[0].high *= (stiffness / joint_stiffness).max(1.0);
    }
    if let Some(least_kg) = lightest_kg(forward, kind, &at) {
        // a small part of the mass remains, because a massless body has no natural frequency
        free_parameters[0].low =
            free_parameters[0].low.max(-0.999 * least_kg / free_parameters[0].value(1.0));
    }
    free_parameters.iter_mut().zip(fitted).for_each(|(free, parameter)| free.keep_readable(parameter));
    let values_at_one: Vec<f64> = free_parameters.iter().map(|free| free.value(1.0)).collect();
    let rows = rows_of_campaign(forward);
    let setting =
        Setting { torque_nm, twist_rad: torque_nm / reference, rows, values_at_one: &values_at_one };
    let starts = (kind.traits.starts)(&setting);
    Candidate { kind, at, free_parameters, numbers, starts, twins: Vec::new() }
}

/// Widens the range of the middle slope of a gear's curve by three standard deviations of the joint's stiffness, whose
/// 95 % limit is `tolerance`. The curve replaces the joint's stiffness together with its calibrated factor, so the
/// slope must be able to deviate as that factor could. The ranges of the other slopes are wide enough already.
fn within_tolerance(free: FreeParameter, parameter: &Parameter, tolerance: f64) -> FreeParameter {
    match parameter.name == MIDDLE_SLOPE {
        true => free.widened(libm::exp(3.0 * tolerance / 2.0)),
        false => free,
    }
}

/// Limits the range of a torque parameter to fractions of `torque_nm`, the largest torque of the campaign. A torsion
/// law that changes only beyond the torques of the campaign cannot be told from one that does not change. Other
/// parameters are returned as they are.
fn within_torque(free: FreeParameter, parameter: &Parameter, torque_nm: f64) -> FreeParameter {
    match parameter.torque_parts {
        Some((low, high)) => free.within(libm::log(low * torque_nm), libm::log(high * torque_nm)),
        None => free,
    }
}

/// Number of rows of the static or the modal file, whichever has more.
fn rows_of_campaign(forward: &Forward) -> f64 {
    forward.static_rows().max(forward.range(Channel::Modal).len()) as f64
}

/// Limits the range of a time constant, counted in rows, to fractions of the campaign's number of rows. A change that
/// is over within the first rows, or has hardly begun at the last, does not depend on the order of the rows. Other
/// parameters are returned as they are.
fn within_rows(free: FreeParameter, rows: f64) -> FreeParameter {
    match free.name == thermal_modulus::ROWS && rows > 0.0 {
        true => free.within(libm::log(0.02 * rows), libm::log(3.0 * rows)),
        false => free,
    }
}

/// The largest mass that an effect can take away \[kg\]: the mass of the joint, or of the lightest payload. `None` if
/// the effect reduces no mass.
fn lightest_kg(forward: &Forward, kind: &Kind, at: &str) -> Option<f64> {
    match kind.traits.removes? {
        Removes::JointMass => {
            let structure = &forward.nominal.structure;
            let turning = structure.joints().find(|j| j.name == at).map(|j| j.mass_kg);
            turning.or_else(|| structure.prismatics().find(|j| j.name == at).map(|j| j.mass_kg))
        }
        Removes::PayloadMass => Some(forward.lightest_payload_kg),
    }
}

/// The parameter with the largest value that is sought as its upper limit. If its expected size grows with the size of
/// the arm or of its readings, its range and prior are widened.
fn of_size(parameter: &Parameter, sizes: &Sizes) -> Parameter {
    let parameter = &Parameter { high: parameter.sought_up_to.unwrap_or(parameter.high), ..*parameter };
    let Some((measure, part)) = parameter.grows_with else { return *parameter };
    let size = sizes.expected(measure, part);
    let wider = (size / parameter.prior.1).max(1.0);
    let prior = (parameter.prior.0 * wider, parameter.prior.1 * wider);
    Parameter { prior, low: parameter.low * wider, high: parameter.high * wider, ..*parameter }
}

/// Tilting stiffness of the nominal bearing of the joint named `at` \[N m/rad\], to which a tilt effect of this kind
/// adds compliance. `None` if the kind of effect is no tilt or the bearing is rigid.
fn nominal_bearing_nm_per_rad(forward: &Forward, kind: &Kind, at: &str) -> Option<f64> {
    let joint = forward.nominal.structure.joints().find(|j| j.name == at)?;
    let tilts = kind.traits.rotation == Some(ElasticRotation::Tilt) && joint.tilt_rad_per_nm > 0.0;
    tilts.then(|| 1.0 / joint.tilt_rad_per_nm)
}

/// Stiffness in which compliances at the place `at` are expressed \[N m/rad\]: the stiffness of the joint there or, if
/// there is no joint or it is rigid, of the first joint that is not rigid; 1e5 N m/rad if all joints are rigid.
fn reference_stiffness(forward: &Forward, at: &str) -> f64 {
    let joints: Vec<_> = forward.nominal.structure.joints().collect();
    let own = joints.iter().find(|j| j.name == at);
    let first = joints.iter().find(|j| !j.law.is_rigid());
    own.filter(|j| !j.law.is_rigid())
        .or(first.copied().as_ref())
        .map_or(1e5, |j| 1.0 / j.law.tangent_compliance_rad_per_nm(0.0))
}

/// Stiffness in which compliances at the prismatic joint `at` are expressed: of its drive along the travel \[N/m\] if
/// the effect is a compliance along the travel, otherwise of its guide about the most compliant axis \[N m/rad\].
fn reference_of_prismatic(forward: &Forward, kind: &Kind, at: &str) -> f64 {
    let joint = forward.nominal.structure.prismatics().find(|joint| joint.name == at);
    let [along, about] = joint.map_or([0.0; 2], |joint| [joint.m_per_n, joint.guide_rad_per_nm.max()]);
    match kind.name == travel_compliance::KIND.name {
        true if along > 0.0 => 1.0 / along,
        true => USUAL_DRIVE_N_PER_M,
        false if about > 0.0 => 1.0 / about,
        false => reference_stiffness(forward, at),
    }
}

/// Reference stiffness along the travel of a prismatic joint whose drive is rigid in the arm file \[N/m\].
const USUAL_DRIVE_N_PER_M: f64 = 2e7;

/// Slope K2 of the torsion curve of the joint named `at` in its middle segment, by which a gear is usually rated \[N
/// m/rad\]. Without such a curve it is the reference stiffness.
fn middle_stiffness(forward: &Forward, at: &str) -> f64 {
    let own = forward.nominal.structure.joints().find(|j| j.name == at);
    match own.map(|joint| joint.law.curve) {
        Some(Curve::Windup(windup)) => windup.k2_nm_per_rad,
        _ => reference_stiffness(forward, at),
    }
}

/// Largest torque on the joint `at` over all tests of the campaign, bench included \[N m\]. For the base, it is the
/// largest moment in static tests.
pub(crate) fn largest_torque_nm(forward: &Forward, at: &str) -> f64 {
    if at == BASE {
        let nominal = forward.coefficients(&forward.nominal);
        let moments = forward.statics.iter().map(|p| p.largest_base_nm(&forward.layout, &nominal));
        return moments.fold(0.0, f64::max);
    }
    let Some(j) = forward.layout.joints.iter().position(|s| s.name == at) else { return 0.0 };
    let nominal = forward.coefficients(&forward.nominal);
    let statics = forward.statics.iter().flat_map(|p| p.torques_nm(&forward.layout, &nominal));
    let modal = forward.modal.iter().map(|t| t.torques_nm(&forward.layout, &nominal));
    let bench = forward.bench_torques_nm(j);
    statics.chain(modal).map(|t| t[j].abs()).chain(bench).fold(0.0, f64::max)
}

/// A factor between two units that lies in this range is no candidate. A missing compliance changes readings by such
/// factors too, and a wrong unit would be preferred to it because it has no free parameter. If a gain near such a
/// factor is found, a sentence in the reasons names the units.
const LIKE_A_STIFFNESS: RangeInclusive<f64> = 0.6..=1.0 / 0.6;

/// Two factors count as equal if their logarithms differ by less than this.
const ONE_FACTOR: f64 = 1e-9;

/// Candidates for readings, forces or payloads in a wrong unit. The factor between two units is known exactly, so there
/// is no free parameter.
fn unit_slips(forward: &Forward) -> Vec<Candidate> {
    let channels = Channel::ALL.into_iter().filter(|c| !forward.range(*c).is_empty());
    let slip = |channel: Channel, factor: f64| Candidate {
        kind: &wrong_unit::KIND,
        at: channel.word().into(),
        free_parameters: Vec::new(),
        numbers: vec![Number::Stated(factor)],
        starts: vec![Vec::new()],
        twins: Vec::new(),
    };
    channels
        .flat_map(|channel| {
            let mut factors = unit_factors(&possible_slips(forward, channel));
            factors.retain(|factor| !LIKE_A_STIFFNESS.contains(factor));
            factors.into_iter().map(move |factor| slip(channel, factor))
        })
        .collect()
}

/// The units that a column of the channel may have by mistake, as far as the mistake multiplies all readings by one
/// factor. A wrong unit of forces does so only if every row is loaded by a force alone, and a wrong unit of payloads
/// only if every row is loaded by a payload alone.
pub(crate) fn possible_slips(forward: &Forward, channel: Channel) -> Vec<&'static UnitSlip> {
    let loads = || forward.statics.iter().flat_map(StaticPose::loaded_by).map(|(_, by)| by);
    let has = |column: UnitColumn| match column {
        UnitColumn::Force => channel != Channel::Static || loads().all(|by| by.force && !by.payload),
        UnitColumn::Payload => loads().all(|by| by.payload && !by.force),
        UnitColumn::Reading => true,
    };
    wrong_unit::SLIPS.iter().filter(|unit| unit.is_of(channel) && has(unit.column)).collect()
}

/// The different factors of the units `slips`. Units with one factor, such as readings in metres and payloads in grams,
/// are one candidate. Factors that are merely near each other, such as those of readings in tenths (10) and forces in
/// kgf (9.807), stay different candidates.
fn unit_factors(slips: &[&UnitSlip]) -> Vec<f64> {
    let mut out: Vec<f64> = Vec::new();
    for factor in slips.iter().map(|unit| unit.factor) {
        if out.iter().all(|known| libm::log(known / factor).abs() > ONE_FACTOR) {
            out.push(factor);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The range in which a parameter is sought, as in [`candidate`].
    fn sought(parameter: &Parameter, wider: f64, reference: f64, torque_nm: f64) -> FreeParameter {
        let sized = Parameter { low: wider * parameter.low, high: wider * parameter.high, ..*parameter };
        let reference = if parameter.scale == Scale::Torque { torque_nm } else { reference };
        let free = within_torque(FreeParameter::new(&sized, 0, reference), parameter, torque_nm);
        let mut free = within_rows(within_tolerance(free, parameter, 0.1), 3.0);
        free.keep_readable(parameter);
        free
    }

    #[test]
    fn no_parameter_is_sought_where_no_file_may_have_it() {
        let kinds = KINDS.iter().filter(|kind| kind.traits.is_sought);
        let parameters = kinds.flat_map(|kind| kind.places.iter().flat_map(|at| (kind.parameters)(*at)));
        for parameter in parameters.filter(|p| !p.is_channel && p.count > 0) {
            for (wider, reference, torque_nm) in [(1.0, 5.0, 1.0), (1.0, 1e5, 80.0), (1e4, 1e11, 1e7)] {
                let free = sought(parameter, wider, reference, torque_nm);
                // 1e-12 for the rounding of logarithms, which the writer of the corrected arm removes
                let ends = [free.low, free.high].map(|u| free.value(u));
                let is_kept = |x: &f64| (parameter.nearest(*x) - x).abs() <= 1e-12 * x.abs();
                let is_absent = |x: &f64| *x >= 1e15 && parameter.scale == Scale::Stiffness;
                assert!(ends.iter().all(|x| is_kept(x) || is_absent(x)), "{} {ends:?}", parameter.name);
            }
        }
    }

    #[test]
    fn units_with_one_factor_are_one_candidate() {
        let own = wrong_unit::SLIPS.iter().filter(|unit| unit.is_of(Channel::Static));
        let factors = unit_factors(&own.collect::<Vec<_>>());
        assert!(factors.contains(&9.80665) && factors.contains(&10.0));
        assert_eq!(factors.iter().filter(|factor| **factor == 1e-3).count(), 1, "metres and grams");
    }
}
