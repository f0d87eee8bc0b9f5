//! Lower bounds on the mass of every design that is at least as stiff as a pick and has at least as high a lowest
//! mode.

use crate::catalog::Catalogs;
use crate::exact::domain_reduction::DomainReduction;
use crate::pareto::objectives::Objectives;
use crate::relax::relaxation::{MassBound, Relaxation};
use crate::space::design_space::DesignSpace;
use crate::space::problem::ArmProblem;

/// Largest number of link options that are tabulated for the whole space. With more options, the bound of each pick
/// is computed only from those options that a design as good as the pick may have.
const MOST_TABULATED: usize = 10_000;

/// The options from which the bounds are computed.
pub(super) enum MassBounds<'a> {
    /// The bounds are computed from all options of the space, which are tabulated once.
    Tabulated(&'a ArmProblem<'a>, Relaxation<'a>),
    /// The bound of each pick is computed from the options that a design as good as this pick may have. `reach` finds
    /// these options; no bound can be computed if it is `None`.
    InReach { space: &'a DesignSpace, catalogs: &'a Catalogs, reach: Option<DomainReduction<'a>> },
}

impl MassBounds<'_> {
    /// Whether the space has few enough options to tabulate all of them.
    pub(super) fn can_tabulate(space: &DesignSpace) -> bool {
        space.link_options() <= MOST_TABULATED
    }

    /// A lower bound on the mass of every design that is as good as a known design in deflection and lowest mode.
    /// `known` is the number of this design in the whole space, `objectives` are its objectives. `None` if the bound
    /// cannot be computed.
    pub(super) fn below(&self, known: u128, objectives: &Objectives) -> Option<MassBound> {
        match self {
            // the linear program covers neither linkages nor springs nor some effects
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
