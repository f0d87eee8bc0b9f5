//! Lower bounds on the mass of a design that is as good as a pick.

use crate::catalog::Catalogs;
use crate::exact::domain_reduction::DomainReduction;
use crate::pareto::objectives::Objectives;
use crate::relax::relaxation::{MassBound, Relaxation};
use crate::space::design_space::DesignSpace;
use crate::space::problem::ArmProblem;

/// If the links have more options than this, they are not tabulated for the whole space: the bound of each
/// pick is computed from the options that a design as good as the pick may have.
const MOST_TABULATED: usize = 10_000;

/// The source of the bounds.
pub(super) enum MassBounds<'a> {
    /// From the options of the whole space.
    Tabulated(&'a ArmProblem<'a>, Relaxation<'a>),
    /// From the options that a design as good as the pick may have.
    InReach { space: &'a DesignSpace, catalogs: &'a Catalogs, reach: Option<DomainReduction<'a>> },
}

impl MassBounds<'_> {
    /// Whether every option of a space can be tabulated.
    pub(super) fn can_tabulate(space: &DesignSpace) -> bool {
        space.link_options() <= MOST_TABULATED
    }

    /// A lower bound on the mass of every design that is as good as a known one, given by its number in the
    /// whole space. `None` if it cannot be computed.
    pub(super) fn below(&self, known: u128, objectives: &Objectives) -> Option<MassBound> {
        match self {
            // the relaxation knows neither linkages, springs nor laws
            Self::Tabulated(problem, _) if problem.space().beyond_bounds().is_some() => None,
            Self::Tabulated(problem, relaxation) => bound(problem, relaxation, known, objectives),
            Self::InReach { space, catalogs, reach } => {
                let options = reach.as_ref()?.options_as_good(objectives)?;
                let space = space.of_options(&options)?;
                if !Self::can_tabulate(&space) || space.beyond_bounds().is_some() {
                    return None;
                }
                let problem = ArmProblem::new(&space, catalogs);
                bound(&problem, &Relaxation::new(&problem), known, objectives)
            }
        }
    }
}

fn bound(
    problem: &ArmProblem,
    relaxation: &Relaxation,
    known: u128,
    objectives: &Objectives,
) -> Option<MassBound> {
    relaxation.mass_lower_bound(&problem.options_of_whole(known)?, objectives)
}
