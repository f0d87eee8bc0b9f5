//! The candidates that are no springs: play, a base that lifts off, and stiffnesses that vary with the angle.

use super::fitted::Sample;
use super::loads::CompliantPlace;
use super::shape::{Shape, Waves};
use crate::arm::effect::kind::ElasticRotation;
use crate::arm::effect::{base_compliance, base_lift, lost_motion, stiffness_waves};

/// Torque scales `T_c` of play that are tried, as fractions of the largest torque on the joint.
const PLAY_PARTS: [f64; 5] = [0.01, 0.03, 0.08, 0.2, 0.5];
/// Preloads of a base that are tried, as fractions of the largest moment on it.
const LIFT_PARTS: [f64; 7] = [0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9];
/// A torque below this size is zero up to rounding \[N m\].
const NOTHING_NM: f64 = 1e-6;

/// Adds candidates that are no springs to the `springs`: play in each joint with five torque scales, a base that lifts
/// off with seven preloads, and a stiffness of each driven joint that varies with its angle. `driven` lists the names
/// of the driven joints.
pub(crate) fn with_shapes(
    mut springs: Vec<CompliantPlace>,
    samples: &[Sample],
    driven: &[String],
) -> Vec<CompliantPlace> {
    let largest_nm = |c: usize| samples.iter().map(|s| s.deflection.torque_nm(c)).fold(0.0, f64::max);
    let like = |c: &CompliantPlace, effect: &'static str, shape: Shape| CompliantPlace {
        effect,
        shape,
        ..c.clone()
    };
    let mut further = Vec::new();
    for (c, spring) in springs.iter().enumerate() {
        let largest_nm = largest_nm(c);
        if largest_nm <= NOTHING_NM {
            continue;
        }
        if spring.rotation == ElasticRotation::AboutAxis {
            let play = PLAY_PARTS.map(|part| Shape::Play(part * largest_nm));
            further.extend(play.map(|shape| like(spring, lost_motion::KIND.name, shape)));
        }
        if spring.effect == base_compliance::KIND.name {
            let lift = LIFT_PARTS.map(|part| Shape::Lift(part * largest_nm));
            further.extend(lift.map(|shape| like(spring, base_lift::KIND.name, shape)));
        }
    }
    for spring in springs.iter().filter(|c| c.rotation == ElasticRotation::AboutAxis) {
        if driven.contains(&spring.at) {
            let waves = [Waves::Once, Waves::Twice, Waves::Both].map(Shape::Waves);
            further.extend(waves.map(|shape| like(spring, stiffness_waves::KIND.name, shape)));
        }
    }
    springs.extend(further);
    springs
}
