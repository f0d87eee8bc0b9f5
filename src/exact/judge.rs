//! The limits that every design must meet, and the evaluation of a single design.

use super::bound::BoxBound;
use super::box_work::BoxWork;
use super::local_upper_bounds::LocalUpperBound;
use super::problem::Problem;
use super::search_state::Findings;
use crate::pareto::objectives::Objectives;
use crate::search::sweep::Candidate;
use crate::space::design::number;

impl Problem<'_> {
    /// The limits of the study on mass, deflection and mode, as a local upper bound. The region below it contains the
    /// whole front.
    pub(super) fn limits(&self) -> LocalUpperBound {
        let limits = &self.space.constraints;
        LocalUpperBound {
            mass_kg: limits.mass_max_kg.unwrap_or(f64::INFINITY),
            tip_m: limits.tip_deflection_max_m.unwrap_or(f64::INFINITY),
            hz: limits.required_mode_hz(),
        }
    }

    /// Evaluates a box of one design, adds the design to `findings` and returns its objectives. Its mass and
    /// deflection are taken from `box_bound`, and its lowest mode is computed anew. `None` if the box has several
    /// designs or if the design breaks a constraint. `None` also if rounding leaves open whether a part carries its
    /// load; the design is then added to the undecided designs of `findings`.
    pub(super) fn judge(
        &self,
        design_box: &[u32],
        box_bound: &BoxBound,
        work: &BoxWork,
        findings: &mut Findings,
    ) -> Option<Objectives> {
        let options = self.options(design_box)?;
        let number = number(&self.level_sizes, &options);
        findings.evaluated += 1;
        let objectives = self.objectives(box_bound, work);
        if !work.is_point() {
            findings.undecided.push(Candidate { number, objectives });
            return None;
        }
        if self.space.constraints.broken(&objectives).contains(&true) {
            return None;
        }
        findings.kept.push(Candidate { number, objectives });
        Some(objectives)
    }
}
