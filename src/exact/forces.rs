//! The forces of a case as intervals, within what a region holds.

use super::held::Held;
use super::interval::interval;
use super::problem::Problem;
use std::sync::Arc;

impl Problem<'_> {
    /// The force of each row of a case between weights; `None` if what is held leaves none.
    pub fn forces(&self, case: usize, weights: &[Vec<[f64; 2]>], forces: &mut Vec<[f64; 2]>) -> Option<()> {
        let rows = &self.poses[case].rows;
        forces.clear();
        for row in rows {
            let mut force = interval(row.fixed, &row.per_n, &weights[case]);
            for held in self.held.iter() {
                // in water of another density the same parts weigh something else
                if self.poses[held.case].water_kg_m3 == self.poses[case].water_kg_m3 {
                    let by = &self.poses[held.case].rows[held.row];
                    held.tighten(row, by, &weights[case], &mut force);
                }
            }
            if force[0] > force[1] {
                return None;
            }
            forces.push(force);
        }
        Some(())
    }

    /// The problem with a force held between bounds, within those it is held between already.
    pub fn holding(&self, case: usize, row: usize, [low, high]: [f64; 2]) -> Self {
        let mut held = self.held.to_vec();
        match held.iter_mut().find(|held| held.case == case && held.row == row) {
            Some(Held { between, .. }) => *between = [between[0].max(low), between[1].min(high)],
            None => held.push(Held { case, row, between: [low, high] }),
        }
        Self { held: Arc::from(held), ..self.clone() }
    }

    /// The problem with no force held.
    pub fn holding_nothing(&self) -> Self {
        Self { held: Arc::default(), ..self.clone() }
    }
}
