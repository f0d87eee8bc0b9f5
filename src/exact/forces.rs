//! The generalized forces of a case as intervals, within the force bounds of the region.
//!
//! A generalized force is the force or the torque that strains one coordinate, such as the torque on a joint. A force
//! bound is an interval to which branching has restricted one such force ([`force_bound`](super::force_bound)).

use super::force_bound::ForceBound;
use super::interval::interval;
use super::problem::Problem;
use std::sync::Arc;

impl Problem<'_> {
    /// Writes the interval of each force of a case to `forces`, one for each row of the pose. The forces follow from
    /// `weights`, the weight intervals of the pieces in each case \[N\], and are restricted by the force bounds of the
    /// region. `None` if a force bound leaves an empty interval, so that the region has no member.
    pub(super) fn forces(
        &self,
        case: usize,
        weights: &[Vec<[f64; 2]>],
        forces: &mut Vec<[f64; 2]>,
    ) -> Option<()> {
        let rows = &self.poses[case].rows;
        forces.clear();
        for row in rows {
            let mut force = interval(row.fixed, &row.per_n, &weights[case]);
            for bound in self.force_bounds.iter() {
                // In water of another density the same parts have other weights, so the bound says nothing about the
                // forces of this case.
                if self.poses[bound.case].water_kg_m3 == self.poses[case].water_kg_m3 {
                    let by = &self.poses[bound.case].rows[bound.row];
                    bound.tighten(row, by, &weights[case], &mut force);
                }
            }
            if force[0] > force[1] {
                return None;
            }
            forces.push(force);
        }
        Some(())
    }

    /// The problem with one more force bound: the force of row `row` in case `case` must lie between `low` and `high`.
    /// If this force has a bound already, the two intervals are intersected.
    pub(super) fn with_force_bound(&self, case: usize, row: usize, [low, high]: [f64; 2]) -> Self {
        let mut bounds = self.force_bounds.to_vec();
        match bounds.iter_mut().find(|bound| bound.case == case && bound.row == row) {
            Some(ForceBound { between, .. }) => *between = [between[0].max(low), between[1].min(high)],
            None => bounds.push(ForceBound { case, row, between: [low, high] }),
        }
        Self { force_bounds: Arc::from(bounds), ..self.clone() }
    }

    /// The problem without force bounds: it has all designs that its options allow.
    pub(super) fn without_force_bounds(&self) -> Self {
        Self { force_bounds: Arc::default(), ..self.clone() }
    }
}
