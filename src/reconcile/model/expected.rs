//! How large an effect is expected to be in an arm and a campaign of this size: kilograms that are a surprise on
//! a small arm are none on a large one.

use crate::arm::effect::Channel;
use crate::reconcile::forward::Forward;

/// Part of the arm's mass that a joint's housing may add.
const ARM_PART: f64 = 1.0 / 8.0;
/// Part of the arm's mass per length that cables may add.
const CABLE_PART: f64 = 1.0 / 4.0;
/// Part of the largest payload that a statement may be wrong by.
const PAYLOAD_PART: f64 = 1.0 / 4.0;
/// Part of a channel's largest reading that its zero may be off by.
const ZERO_PART: f64 = 1.0 / 4.0;

/// Sizes of an arm and its campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    arm_kg: f64,
    arm_m: f64,
    payload_kg: f64,
    displacement_mm: f64,
    twist_arcmin: f64,
    static_rows: f64,
}

impl Sizes {
    /// Of the nominal arm and the readings.
    pub fn of(forward: &Forward) -> Self {
        let structure = &forward.nominal.structure;
        let largest = |channel| {
            let own = &forward.data[forward.range(channel)];
            own.iter().fold(0.0f64, |m, d| m.max(d.value.abs()))
        };
        let joints_kg: f64 = structure.joints().map(|j| j.mass_kg).sum();
        Self {
            arm_kg: joints_kg + structure.links().map(|l| l.mass_kg()).sum::<f64>(),
            arm_m: structure.links().map(|l| l.vector_m.norm()).sum::<f64>().max(1e-3),
            payload_kg: forward.largest_payload_kg,
            displacement_mm: largest(Channel::Static),
            twist_arcmin: largest(Channel::Windup),
            static_rows: (forward.range(Channel::Static).len() / 3).max(1) as f64,
        }
    }

    /// Largest size expected of a parameter in its own unit, if it goes with the size of the arm or the readings.
    pub fn expected(&self, effect: &str, parameter: &str) -> Option<f64> {
        match (effect, parameter) {
            ("extra_mass", "delta_kg") => Some(ARM_PART * self.arm_kg),
            ("payload_mass_error", "delta_kg") => Some(PAYLOAD_PART * self.payload_kg),
            ("harness_mass", "kg_per_m") => Some(CABLE_PART * self.arm_kg / self.arm_m),
            ("sensor_bias", "bias_mm") => Some(ZERO_PART * self.displacement_mm),
            ("sensor_bias", "bias_arcmin") => Some(ZERO_PART * self.twist_arcmin),
            ("drift", "rate_mm_per_row") => Some(ZERO_PART * self.displacement_mm / self.static_rows),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::reconcile::readings::campaign::Campaign;
    use std::path::Path;

    #[test]
    fn what_is_expected_grows_with_the_arm_and_its_payload() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let mut campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        let sizes = |campaign: &Campaign| Sizes::of(&Forward::new(campaign));
        let small = sizes(&campaign);
        for element in &mut campaign.arm.chain {
            if let crate::arm::Element::Joint(joint) = element {
                joint.mass_kg *= 20.0;
            }
        }
        campaign.statics.iter_mut().for_each(|row| row.payload.mass_kg *= 20.0);
        let large = sizes(&campaign);
        let of = |sizes: &Sizes, effect| sizes.expected(effect, "delta_kg").expect("goes with the size");
        assert!(of(&small, "extra_mass") < 12.0 && of(&large, "extra_mass") > 100.0, "{small:?} {large:?}");
        assert_eq!(of(&large, "payload_mass_error"), 50.0);
    }
}
