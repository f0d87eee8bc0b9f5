//! Lists what a search looks for: every effect at every place that a campaign could show, how large it may be
//! and where fits start.

use super::expected::Sizes;
use super::parameters::{Candidate, FreeParameter};
use crate::arm::effect::catalogue::KINDS;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::immersion::PAYLOAD_DENSITY;
use crate::arm::effect::kind::{Kind, Parameter, Place, Removes, Setting, Yields};
use crate::arm::effect::validate::fits_nominal;
use crate::arm::effect::wrong_unit;
use crate::arm::joint_law::Curve;
use crate::arm::structure::Piece;
use crate::reconcile::forward::prepared::Forward;

/// Every effect at every place of this arm that the campaign's channels could show.
pub fn candidates(forward: &Forward) -> Vec<Candidate> {
    let structure = &forward.nominal.structure;
    let sizes = Sizes::of(forward);
    let mut out = Vec::new();
    for kind in KINDS.iter().filter(|kind| kind.traits.is_sought) {
        for place in kind.places {
            for at in structure.places(*place) {
                if fits_nominal(kind, &at, structure) && channel_is_read(forward, *place) {
                    out.push(candidate(forward, &sizes, kind, *place, at));
                }
            }
        }
    }
    // two names for the same thing would count as two places and as an alternative
    merge_twins(forward, &mut out);
    out.extend(unit_slips(forward));
    out
}

/// Merges two candidates that are the same thing in this arm. Where the first joint is vertical and at the
/// origin, the tilt of its bearing is the tilt of the base.
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

fn channel_is_read(forward: &Forward, place: Place) -> bool {
    match place {
        Place::Channel(channel) => !forward.range(channel).is_empty(),
        _ => true,
    }
}

fn candidate(forward: &Forward, sizes: &Sizes, kind: &'static Kind, place: Place, at: String) -> Candidate {
    let joint_stiffness = reference_stiffness(forward, &at);
    let bearing = nominal_bearing_nm_per_rad(forward, kind, &at);
    let reference = match kind.traits.is_gear_curve {
        true => middle_stiffness(forward, &at),
        false => bearing.unwrap_or(joint_stiffness),
    };
    // at least 1 N m, so that logarithms exist for a joint without torque
    let torque_nm = largest_torque_nm(forward, &at).max(1.0);
    let mut free_parameters = Vec::new();
    let mut fixed = Vec::new();
    for parameter in (kind.parameters)(place) {
        match parameter.default {
            None => {
                let sized = &of_size(parameter, sizes);
                let free = (0..sized.count).map(|component| FreeParameter::new(sized, component, reference));
                free_parameters.extend(free.map(|free| within_torque(free, parameter, torque_nm)));
            }
            Some(_) if parameter.name == PAYLOAD_DENSITY => fixed.push(forward.payload_density_kg_m3),
            Some(default) => fixed.push(default),
        }
    }
    if let Some(stiffness) = bearing {
        // a bearing may be far stiffer than what yields beside it: as soft as beside a joint is looked for
        free_parameters[0].high *= (stiffness / joint_stiffness).max(1.0);
    }
    if let Some(least_kg) = lightest_kg(forward, kind, &at) {
        // a small mass remains, because nothing oscillates without mass
        free_parameters[0].low =
            free_parameters[0].low.max(-0.999 * least_kg / free_parameters[0].value(1.0));
    }
    let values_at_one: Vec<f64> = free_parameters.iter().map(|free| free.value(1.0)).collect();
    let setting = Setting { torque_nm, twist_rad: torque_nm / reference, values_at_one: &values_at_one };
    let starts = (kind.traits.starts)(&setting);
    Candidate { kind, at, free_parameters, before: Vec::new(), fixed, starts, twins: Vec::new() }
}

/// Limits a torque to parts of the largest torque of the campaign. A law that changes where no torque reaches
/// cannot be told from another.
fn within_torque(free: FreeParameter, parameter: &Parameter, torque_nm: f64) -> FreeParameter {
    match parameter.torque_parts {
        Some((low, high)) => free.within(libm::log(low * torque_nm), libm::log(high * torque_nm)),
        None => free,
    }
}

/// The mass that an effect reduces, if it can reduce one: that of the joint, or of the lightest payload
/// \[kg\].
fn lightest_kg(forward: &Forward, kind: &Kind, at: &str) -> Option<f64> {
    match kind.traits.removes? {
        Removes::JointMass => forward.nominal.structure.joints().find(|j| j.name == at).map(|j| j.mass_kg),
        Removes::PayloadMass => Some(forward.lightest_payload_kg),
    }
}

/// Widens the range of a parameter where the arm or its readings are large.
fn of_size(parameter: &Parameter, sizes: &Sizes) -> Parameter {
    let Some((measure, part)) = parameter.grows_with else { return *parameter };
    let size = sizes.expected(measure, part);
    let wider = (size / parameter.prior.1).max(1.0);
    let prior = (parameter.prior.0 * wider, parameter.prior.1 * wider);
    Parameter { prior, low: parameter.low * wider, high: parameter.high * wider, ..*parameter }
}

/// Tilting stiffness of the nominal bearing of a joint, beyond which an effect tilts \[N m/rad\]; `None` for another effect
/// and for a rigid bearing.
fn nominal_bearing_nm_per_rad(forward: &Forward, kind: &Kind, at: &str) -> Option<f64> {
    let joint = forward.nominal.structure.joints().find(|j| j.name == at)?;
    let tilts = kind.traits.yields == Some(Yields::Tilt) && joint.tilt_rad_per_nm > 0.0;
    tilts.then(|| 1.0 / joint.tilt_rad_per_nm)
}

/// The stiffness in which compliances are expressed: that of the joint itself, or of the first joint that
/// twists \[N m/rad\].
fn reference_stiffness(forward: &Forward, at: &str) -> f64 {
    let joints: Vec<_> = forward.nominal.structure.joints().collect();
    let own = joints.iter().find(|j| j.name == at);
    let first = joints.iter().find(|j| !j.law.is_rigid());
    own.filter(|j| !j.law.is_rigid())
        .or(first.copied().as_ref())
        .map_or(1e5, |j| 1.0 / j.law.tangent_compliance_rad_per_nm(0.0))
}

/// The middle slope of a joint's curve, by which a gear is usually rated \[N m/rad\].
fn middle_stiffness(forward: &Forward, at: &str) -> f64 {
    let own = forward.nominal.structure.joints().find(|j| j.name == at);
    match own.map(|joint| joint.law.curve) {
        Some(Curve::Windup(windup)) => windup.k2_nm_per_rad,
        _ => reference_stiffness(forward, at),
    }
}

/// Largest torque on a joint in the campaign, including the bench \[N m\].
fn largest_torque_nm(forward: &Forward, at: &str) -> f64 {
    let Some(j) = forward.layout.joints.iter().position(|s| s.name == at) else { return 0.0 };
    let nominal = forward.coefficients(&forward.nominal);
    let statics = forward.statics.iter().flat_map(|p| p.torques_nm(&forward.layout, &nominal));
    let modal = forward.modal.iter().map(|t| t.torques_nm(&forward.layout, &nominal));
    let bench = forward.bench_torques_nm(j);
    statics.chain(modal).map(|t| t[j].abs()).chain(bench).fold(0.0, f64::max)
}

/// Candidates for unit slips. A slip has an exactly known factor and therefore no free parameter.
fn unit_slips(forward: &Forward) -> Vec<Candidate> {
    let channels = Channel::ALL.into_iter().filter(|c| !forward.range(*c).is_empty());
    let slip = |channel: Channel, factor: f64| Candidate {
        kind: &wrong_unit::KIND,
        at: channel.word().into(),
        free_parameters: Vec::new(),
        before: Vec::new(),
        fixed: vec![factor],
        starts: vec![Vec::new()],
        twins: Vec::new(),
    };
    channels
        .flat_map(|channel| wrong_unit::SLIPS.iter().map(move |(factor, _)| slip(channel, *factor)))
        .collect()
}
