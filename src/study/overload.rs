//! What a load or a speed overloads: the first joint or link of an arm that fails.

use crate::catalog::Catalogs;
use crate::space::design_space::{DesignSpace, SpacePiece};
use crate::space::problem::ArmProblem;

/// The first joint or link that is overloaded.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Overload {
    /// Name of the joint or link.
    pub piece: String,
    /// Label of the check that fails.
    pub check: String,
}

/// The first piece of the arm with these options that is overloaded in the cases with the indices `cases`; `None` if no
/// piece is.
pub(super) fn overload(
    space: &DesignSpace,
    catalogs: &Catalogs,
    options: &[u32],
    cases: &[usize],
) -> Option<Overload> {
    let problem = ArmProblem::new(space, catalogs);
    problem.overload(options, cases, catalogs).map(|(piece, fails)| {
        let piece = space.pieces.get(piece).map_or("", SpacePiece::name).to_string();
        Overload { piece, check: fails.label().to_string() }
    })
}
