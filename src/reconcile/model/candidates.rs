//! What is looked for: every effect at every place that a campaign could show, how large it may be and where fits start.

use super::expected::Sizes;
use super::parameters::{Candidate, Knob};
use crate::arm::effect::validate::fits_nominal;
use crate::arm::effect::{Channel, KINDS, Kind, Parameter, Place};
use crate::arm::joint_law::Curve;
use crate::arm::structure::Piece;
use crate::reconcile::forward::Forward;

/// Every effect at every place of this arm that the campaign's channels could show.
pub fn candidates(forward: &Forward) -> Vec<Candidate> {
    let structure = &forward.nominal.structure;
    let sizes = Sizes::of(forward);
    let mut out = Vec::new();
    for kind in KINDS.iter().filter(|k| {
        !matches!(k.name, "outlier" | "time_shift" | "wrong_unit" | "frame_compliance" | "transmission_error")
    }) {
        for place in kind.places {
            for at in structure.places(*place) {
                if fits_nominal(kind, *place, &at, structure) && channel_is_read(forward, *place) {
                    out.push(candidate(forward, &sizes, kind, *place, at));
                }
            }
        }
    }
    merge_twins(forward, &mut out);
    out.extend(unit_slips(forward));
    out
}

/// The tilt of a vertical first joint at the origin is the tilt of the base: one candidate for both.
fn merge_twins(forward: &Forward, candidates: &mut Vec<Candidate>) {
    let Some(Piece::Joint(first)) = forward.nominal.structure.pieces.first() else { return };
    if first.axis.z.abs() < 1.0 - 1e-12 {
        return;
    }
    let name = first.name.clone();
    candidates.retain(|c| !(c.kind.name == "bearing_tilt" && c.at == name));
    if let Some(base) = candidates.iter_mut().find(|c| c.kind.name == "base_compliance") {
        base.twins.push(("bearing_tilt".into(), name));
    }
}

fn channel_is_read(forward: &Forward, place: Place) -> bool {
    match place {
        Place::Channel(channel) => !forward.range(channel).is_empty(),
        _ => true,
    }
}

fn candidate(forward: &Forward, sizes: &Sizes, kind: &'static Kind, place: Place, at: String) -> Candidate {
    let reference = match kind.name {
        "soft_windup" => middle_stiffness(forward, &at),
        _ => reference_stiffness(forward, &at),
    };
    let mut knobs = Vec::new();
    let mut fixed = Vec::new();
    for parameter in (kind.parameters)(place) {
        match parameter.default {
            None => {
                let parameter = &of_size(kind, parameter, sizes);
                knobs.extend((0..parameter.count).map(|c| Knob::new(parameter, c, reference)));
            }
            Some(default) if parameter.name == "payload_density_kg_m3" && default > 0.0 => {
                fixed.push(forward.payload_density_kg_m3)
            }
            Some(default) => fixed.push(default),
        }
    }
    let torque = largest_torque_nm(forward, &at).max(1.0);
    for knob in &mut knobs {
        let parts = match knob.name {
            "t1_nm" => (0.02, 1.0),
            "t2_nm" => (0.05, 1.5),
            "torque_nm" => (0.003, 1.0),
            _ => continue,
        };
        // a law that changes where no torque of the campaign reaches cannot be told from another
        *knob = knob.clone().within((parts.0 * torque).ln(), (parts.1 * torque).ln());
    }
    if let Some(least_kg) = lightest_kg(forward, kind, &at) {
        // a share is left, for nothing swings without a mass
        knobs[0].low = knobs[0].low.max(-0.999 * least_kg / knobs[0].value(1.0));
    }
    let starts = starts(kind, torque, torque / reference, &knobs);
    Candidate { kind, at, knobs, fixed, starts, twins: Vec::new() }
}

/// The mass that an effect takes from, if it can take mass away: a joint's own, the lightest payload's \[kg\].
fn lightest_kg(forward: &Forward, kind: &Kind, at: &str) -> Option<f64> {
    match kind.name {
        "extra_mass" => forward.nominal.structure.joints().find(|j| j.name == at).map(|j| j.mass_kg),
        "payload_mass_error" => Some(forward.lightest_payload_kg),
        _ => None,
    }
}

/// The parameter over a wider range where the arm or its readings are large.
fn of_size(kind: &Kind, parameter: &Parameter, sizes: &Sizes) -> Parameter {
    let Some(size) = sizes.expected(kind.name, parameter.name) else { return *parameter };
    let wider = (size / parameter.prior.1).max(1.0);
    let prior = (parameter.prior.0 * wider, parameter.prior.1 * wider);
    Parameter { prior, low: parameter.low * wider, high: parameter.high * wider, ..*parameter }
}

/// Stiffness that compliances are measured by: the joint's own, else the first joint's.
fn reference_stiffness(forward: &Forward, at: &str) -> f64 {
    let joints: Vec<_> = forward.nominal.structure.joints().collect();
    let own = joints.iter().find(|j| j.name == at);
    let first = joints.iter().find(|j| !j.law.is_rigid());
    own.filter(|j| !j.law.is_rigid())
        .or(first.copied().as_ref())
        .map_or(1e5, |j| 1.0 / j.law.tangent_compliance_rad_per_nm(0.0))
}

/// The middle slope of a joint's curve, which is what a gear is known by \[N m/rad\].
fn middle_stiffness(forward: &Forward, at: &str) -> f64 {
    let own = forward.nominal.structure.joints().find(|j| j.name == at);
    match own.map(|joint| joint.law.curve) {
        Some(Curve::Windup(windup)) => windup.k2_nm_per_rad,
        _ => reference_stiffness(forward, at),
    }
}

/// Break points of a gear's curve to start from, as parts of the largest torque.
const BREAKS: [(f64, f64); 8] = [
    (0.08, 0.25),
    (0.08, 0.6),
    (0.15, 0.4),
    (0.15, 0.75),
    (0.25, 0.5),
    (0.25, 0.85),
    (0.4, 0.65),
    (0.5, 0.85),
];

/// Half widths of friction play to start from, by the largest twist of the joint \[rad\]: where the play is as wide as the
/// twist the joint does not move, and a descent sees no slope.
fn friction_starts_rad(twist_rad: f64) -> impl Iterator<Item = f64> {
    const WIDEST: f64 = 0.3;
    let usual = [0.25e-4, 1e-4, 3e-4].into_iter().filter(move |h| *h < WIDEST * twist_rad);
    [0.01, 0.06].into_iter().map(move |part| part * twist_rad).chain(usual)
}

fn starts(kind: &Kind, torque: f64, twist_rad: f64, knobs: &[Knob]) -> Vec<Vec<f64>> {
    match kind.name {
        "connection_compliance" | "bearing_tilt" | "base_compliance" => vec![vec![0.1], vec![0.5]],
        "joint_compliance" => vec![vec![0.5], vec![2.0]],
        "modulus_error" => vec![vec![1.1], vec![1.4]],
        "soft_windup" => {
            BREAKS.iter().map(|(a, b)| vec![1.4, 1.0, 0.85, (a * torque).ln(), (b * torque).ln()]).collect()
        }
        "lost_motion" => [0.03, 0.1, 0.3].iter().map(|part| vec![1.0, (part * torque).ln()]).collect(),
        "sensor_gain" => vec![vec![1.0 / knobs[0].value(1.0)]],
        "hysteresis" => friction_starts_rad(twist_rad).map(|h| vec![knobs[0].u(h)]).collect(),
        "extra_mass" => vec![vec![0.5], vec![2.0]],
        "immersion" => vec![vec![1.0, 1.0]],
        "payload_cg_error" => vec![vec![0.0; 3]],
        "sensor_bias" | "drift" => vec![vec![0.0; knobs.len()]],
        _ => vec![vec![1.0; knobs.len()]],
    }
}

/// Largest torque a joint sees in the campaign, bench included \[N m\].
fn largest_torque_nm(forward: &Forward, at: &str) -> f64 {
    let Some(j) = forward.layout.joints.iter().position(|s| s.name == at) else { return 0.0 };
    let nominal = forward.coefficients(&forward.nominal);
    let statics = forward.statics.iter().flat_map(|p| p.torques_nm(&forward.layout, &nominal));
    let modal = forward.modal.iter().map(|t| t.torques_nm(&forward.layout, &nominal));
    let bench = forward.bench_torques_nm(j);
    statics.chain(modal).map(|t| t[j].abs()).chain(bench).fold(0.0, f64::max)
}

/// A unit slip is a gain that is known exactly: no number to fit.
fn unit_slips(forward: &Forward) -> Vec<Candidate> {
    let kind = crate::arm::effect::kind("wrong_unit").expect("registered");
    let channels = Channel::ALL.into_iter().filter(|c| !forward.range(*c).is_empty());
    channels
        .flat_map(|channel| {
            crate::arm::effect::wrong_unit::SLIPS.iter().map(move |(factor, _)| Candidate {
                kind,
                at: channel.word().into(),
                knobs: Vec::new(),
                fixed: vec![*factor],
                starts: vec![Vec::new()],
                twins: Vec::new(),
            })
        })
        .collect()
}
