//! What every design keeps, and the judgement of one.

use super::bound::{Ceiling, Work};
use super::corners::Corner;
use super::known::Finds;
use super::problem::Problem;
use crate::pareto::objectives::Objectives;
use crate::search::sweep::Candidate;
use crate::space::design::number;

impl Problem<'_> {
    /// What every design on the front keeps.
    pub fn limits(&self) -> Corner {
        let limits = &self.space.constraints;
        Corner {
            mass_kg: limits.mass_max_kg.unwrap_or(f64::INFINITY),
            tip_m: limits.tip_deflection_max_m.unwrap_or(f64::INFINITY),
            hz: limits.required_mode_hz(),
        }
    }

    /// One design: its ceiling is its objectives once its mode is made sure of; `None` if it is not known that it meets
    /// the constraints.
    pub fn judge(
        &self,
        cell: &[u32],
        ceiling: &Ceiling,
        work: &Work,
        finds: &mut Finds,
    ) -> Option<Objectives> {
        let options = self.options(cell)?;
        let number = number(&self.level_sizes, &options);
        finds.evaluated += 1;
        let objectives = self.objectives(ceiling, work);
        if !work.is_point() {
            finds.unsure.push(Candidate { number, objectives });
            return None;
        }
        if self.space.constraints.broken(&objectives).contains(&true) {
            return None;
        }
        finds.kept.push(Candidate { number, objectives });
        Some(objectives)
    }
}
