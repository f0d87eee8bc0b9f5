//! The size that an effect is expected to have, by the size of the arm and of its readings. An error of a few kilograms
//! is large for a small arm and small for a large arm.

use crate::arm::effect::channel::Channel;
use crate::arm::effect::kind::Measure;
use crate::reconcile::forward::bench::ARCMIN_PER_RAD;
use crate::reconcile::forward::prepared::Forward;

/// Sizes of an arm and of its readings. The expected size of an effect is a fraction of one of them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sizes {
    arm_kg: f64,
    arm_m: f64,
    payload_kg: f64,
    displacement_mm: f64,
    twist_arcmin: f64,
    static_rows: f64,
}

impl Sizes {
    /// Determines the sizes of the nominal arm and of the readings of a campaign.
    pub(crate) fn of(forward: &Forward) -> Self {
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
            static_rows: forward.static_rows().max(1) as f64,
        }
    }

    /// The largest expected size of a parameter whose size grows with `measure` (such as the mass of the arm), in the
    /// parameter's unit: `part` times the measure.
    pub(crate) fn expected(&self, measure: Measure, part: f64) -> f64 {
        match measure {
            Measure::ArmMass => part * self.arm_kg,
            Measure::PayloadMass => part * self.payload_kg,
            Measure::ArmMassPerLength => part * self.arm_kg / self.arm_m,
            Measure::Displacement => part * self.displacement_mm,
            Measure::Twist => part * self.twist_arcmin,
            Measure::Angle => {
                let turned_rad = 1e-3 * self.displacement_mm / self.arm_m;
                part * turned_rad.max(self.twist_arcmin / ARCMIN_PER_RAD)
            }
            Measure::DisplacementPerRow => part * self.displacement_mm / self.static_rows,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::effect::kind::Kind;
    use crate::arm::effect::{extra_mass, payload_mass_error};
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
        let of = |sizes: &Sizes, kind: &Kind| {
            let (measure, part) =
                (kind.parameters)(kind.places[0])[0].grows_with.expect("grows with the arm");
            sizes.expected(measure, part)
        };
        let extra = |sizes: &Sizes| of(sizes, &extra_mass::KIND);
        assert!(extra(&small) < 12.0 && extra(&large) > 100.0, "{small:?} {large:?}");
        assert_eq!(of(&large, &payload_mass_error::KIND), 50.0);
    }
}
