//! The designs of the picks of a front.

use crate::report::front_table::FrontTable;
use crate::report::picks::{designs, picks};
use crate::space::problem::ArmProblem;

/// The options of each pick of `front`, one for each level of `problem`, tip first. A pick of which the problem lacks an
/// option is left out.
pub(super) fn options_of_picks(problem: &ArmProblem, front: &FrontTable) -> Vec<Vec<u32>> {
    let picks = picks(&designs(front));
    picks.iter().filter_map(|pick| problem.options_of_id(&pick.design.design_id)).collect()
}
