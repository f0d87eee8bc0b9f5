//! Laws of displacements that grow in the course of the tests although no load does: ground that settles under the base, and a
//! zero of the instrument that creeps.

use super::{Builder, Law, placed};
use crate::arm::BASE;
use crate::arm::effect::channel::Channel;
use crate::reconcile::forward::datum::Datum;
use nalgebra::Vector3;

/// In the first such fraction of the tests, a part that creeps moves as far as in the next two together. Soil and polymers creep
/// with the logarithm of the time.
const EARLY: f64 = 0.05;

impl Builder<'_> {
    /// The laws of the static readings that follow the order of the tests.
    pub(super) fn course_laws(&self) -> Vec<Law> {
        let range = self.forward.range(Channel::Static);
        let data = &self.forward.data[range];
        let largest_mm = data.iter().map(|d| d.value.abs()).fold(0.0, f64::max);
        let column = |of: &dyn Fn(usize, &Datum) -> f64| -> Vec<f64> {
            let mut truth = vec![0.0; self.forward.data.len()];
            truth.iter_mut().zip(data).enumerate().for_each(|(i, (out, d))| *out = largest_mm * of(i, d));
            self.read(&truth)
        };
        let creeps = |i: usize| crept(self.occasions[i].part);
        let tips_m = self.tips_m();
        let reach_m = tips_m.iter().map(|tip| tip.norm()).fold(1e-9, f64::max);
        // by how much the tip moves if the base turns about an axis
        let moved = |axis: Vector3<f64>, d: &Datum| axis.cross(&tips_m[d.index])[d.component] / reach_m;
        let turning = |when: &dyn Fn(usize) -> f64| {
            seen(
                [Vector3::x(), Vector3::y(), Vector3::z()]
                    .map(|axis| column(&|i, d| when(i) * moved(axis, d))),
            )
        };
        let base = vec![
            Law::new(
                "a base that turns steadily in the course of the tests",
                turning(&|i| self.occasions[i].part),
            ),
            Law::new("a base that settles, fast at first", turning(&creeps)),
        ];
        let along = |c: usize| column(&|i, d| if d.component == c { creeps(i) } else { 0.0 });
        let zero = Law::new("static readings whose zero creeps, fast at first", seen([0, 1, 2].map(along)));
        [placed(BASE, base), placed(Channel::Static.word(), vec![zero])].concat()
    }

    /// Position of the tip in every row of the static readings \[m\].
    fn tips_m(&self) -> Vec<Vector3<f64>> {
        let mut tips_m = vec![Vector3::zeros(); self.campaign.statics.len()];
        for pose in &self.forward.statics {
            for (_, datum) in (0..pose.count()).flat_map(|load| pose.measured(load)) {
                tips_m[self.forward.data[datum].index] = pose.geometry.tip_m;
            }
        }
        tips_m
    }
}

/// The columns that change a reading. A gauge in one direction does not see every turn of the base.
fn seen(columns: [Vec<f64>; 3]) -> Vec<Vec<f64>> {
    columns.into_iter().filter(|column| column.iter().any(|change| *change != 0.0)).collect()
}

/// How far a part that creeps has moved after the fraction `part` of the tests, relative to all tests.
fn crept(part: f64) -> f64 {
    libm::log1p(part / EARLY) / libm::log1p(1.0 / EARLY)
}

#[cfg(test)]
mod tests {
    use super::super::testing::about_the_nominal_arm;
    use super::*;
    use crate::reconcile::fit::descent::{Effort, fit};
    use crate::reconcile::fit::noise::Noise;
    use crate::reconcile::forward::prepared::Forward;
    use crate::reconcile::model::parameters::Model;

    #[test]
    fn what_creeps_moves_fast_at_first() {
        assert_eq!([0.0, 1.0].map(crept), [0.0, 1.0]);
        assert!((crept(3.0 * EARLY) - 2.0 * crept(EARLY)).abs() < 1e-12);
    }

    #[test]
    fn a_base_that_turns_moves_the_tip_across_its_radius_and_later_rows_more() {
        about_the_nominal_arm(|builder, _| {
            let laws = builder.course_laws();
            assert_eq!(laws.iter().map(|law| law.columns.len()).collect::<Vec<_>>(), [3, 3, 3]);
            let tips_m = builder.tips_m();
            let modal = builder.forward.starts[1];
            for law in &laws {
                for column in &law.columns {
                    assert!(column[modal..].iter().all(|change| *change == 0.0));
                    assert!(column[..3].iter().all(|change| *change == 0.0), "the first row");
                }
            }
            let turned = |law: &Law, row: usize| {
                let of = |column: &[f64]| Vector3::from_fn(|c, _| column[3 * row + c]);
                [0, 1, 2].map(|axis| of(&law.columns[axis]))
            };
            let last = builder.campaign.statics.len() - 1;
            for moved in turned(&laws[0], last) {
                assert!(moved.norm() > 0.0 && moved.dot(&tips_m[last]).abs() < 1e-9 * moved.norm());
            }
            // early rows have moved further where the ground settles
            let share = |law: &Law| turned(law, 3)[0].norm() / tips_m[3].norm();
            assert!(share(&laws[1]) > 1.5 * share(&laws[0]));
        });
    }

    #[test]
    fn a_gauge_in_one_direction_sees_two_turns_of_the_base_and_one_creeping_zero() {
        about_the_nominal_arm(|builder, nuisance| {
            let mut campaign = builder.campaign.clone();
            campaign.statics.iter_mut().for_each(|row| (row.measured[0], row.measured[1]) = (None, None));
            let forward = Forward::new(&campaign);
            let baseline = Model::baseline(nuisance);
            let weights = Noise::default().weights(&forward);
            let effort = Effort { steps: 0, tolerance: 0.0 };
            let fit = fit(&forward, &baseline, &vec![0.0; baseline.len()], &weights, effort);
            let laws = Builder::new(&campaign, &forward, &fit).course_laws();
            assert_eq!(laws.iter().map(|law| law.columns.len()).collect::<Vec<_>>(), [2, 2, 1]);
        });
    }
}
