//! The law of an arm that is not level: the weight of every payload pulls in another direction than stated.

use super::{Builder, FULL_ANGLE_DEG, Law};
use crate::reconcile::forward::prepared::Forward;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Angle by which gravity is tilted for the difference quotient of the readings \[rad\].
const STEP_RAD: f64 = 2e-3;

impl Builder<'_> {
    /// The law that gravity is tilted, with one parameter for each horizontal axis.
    pub(super) fn level_laws(&self) -> Vec<Law> {
        let columns = self.forward.level_columns.get_or_init(|| self.level_columns());
        let what = "a direction of gravity other than stated (an arm that is out of level)";
        vec![Law::new(what, columns.clone())]
    }

    /// For each horizontal axis of the world, the change of every reading of the nominal arm, in its unit, if gravity
    /// is tilted towards the axis by [`FULL_ANGLE_DEG`] (extrapolated from a small step). Two small influences are left
    /// out. Frequencies depend on the direction of gravity only through the curves of the gears. The arm's own weight
    /// deflects the arm equally in the reference of every reading, so it hardly counts.
    fn level_columns(&self) -> Vec<Vec<f64>> {
        let stated = self.static_readings_with(Vector3::zeros());
        let column = |axis: Vector3<f64>| {
            let turned = self.static_readings_with(axis);
            let per_step = FULL_ANGLE_DEG.to_radians() / STEP_RAD;
            let change = turned.iter().zip(&stated).map(|(turned, stated)| per_step * (turned - stated));
            let mut column: Vec<f64> = change.collect();
            column.resize(self.forward.data.len(), 0.0);
            column
        };
        [Vector3::x(), Vector3::y()].into_par_iter().map(column).collect()
    }

    /// The static readings of the nominal arm if every payload also pulls in the horizontal direction `along`, with its
    /// weight times [`STEP_RAD`]. The pull acts at the tip.
    fn static_readings_with(&self, along: Vector3<f64>) -> Vec<f64> {
        let mut campaign = self.campaign.clone();
        campaign.modal.clear();
        campaign.windup.clear();
        let gravity_m_s2 = self.forward.layout.gravity_m_s2;
        for row in &mut campaign.statics {
            row.force_n += along * (STEP_RAD * row.payload.mass_kg * gravity_m_s2);
        }
        let forward = Forward::new(&campaign);
        forward.predict(&forward.coefficients(&self.forward.nominal))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::about_the_nominal_arm;
    use crate::arm::effect::channel::Channel;

    #[test]
    fn an_arm_out_of_level_moves_with_its_payload_and_in_static_tests_alone() {
        about_the_nominal_arm(|builder, _| {
            let laws = builder.level_laws();
            let [along_x, along_y] = laws[0].columns.as_slice() else { panic!("two axes") };
            let statics = builder.forward.range(Channel::Static);
            for column in [along_x, along_y] {
                assert_eq!(column.len(), builder.forward.data.len());
                assert!(column[statics.end..].iter().all(|change| *change == 0.0));
                for (datum, change) in builder.forward.data.iter().zip(column).take(statics.end) {
                    let payload_kg = builder.campaign.statics[datum.index].payload.mass_kg;
                    assert!(payload_kg > 0.0 || *change == 0.0, "row {}: {change}", datum.row);
                }
                assert!(column.iter().any(|change| change.abs() > 1e-3));
            }
        });
    }
}
