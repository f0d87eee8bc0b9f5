//! Rows of designs, finished together.
//!
//! A *row* is the set of designs that differ in the innermost level alone. Whatever depends on the innermost options but
//! not on the arm outboard of them is compiled once ([`FinishRows::compile`]). Each worker then finishes rows in working
//! space of its own.

use super::row::Row;
use super::row_begun::RowScratch;
use super::row_lanes::RowsWork;
use crate::mechanics::lanes::in_lanes;
use crate::space::levels::{Keep, OutwardIn};
use crate::space::problem::{ArmProblem, Partial};

/// A tree of designs that knows how to finish whole rows.
pub trait FinishRows: OutwardIn {
    /// The innermost level, compiled once for all rows.
    type Compiled: Send + Sync;
    /// Working space of a worker, kept from one row to the next.
    type Scratch: Send;

    /// Compiles the innermost level.
    fn compile(&self) -> Self::Compiled;

    /// Working space for one worker.
    fn scratch(&self) -> Self::Scratch;

    /// Finishes rows of designs and shows them to `keep`. Each row is an arm that lacks only the innermost level, with the
    /// number of its first design.
    fn finish<K: Keep>(
        &self,
        compiled: &Self::Compiled,
        rows: &[(u128, Self::Partial)],
        scratch: &mut Self::Scratch,
        keep: &mut K,
    );
}

/// Finishes rows design by design. It is slower than rows in lanes and works for every tree.
pub(crate) fn finish_one_by_one<P: OutwardIn>(
    problem: &P,
    rows: &[(u128, P::Partial)],
    spare: &mut P::Partial,
    keep: &mut dyn Keep,
) {
    let Some((&options, outer)) = problem.level_sizes().split_last() else { return };
    for (first, from) in rows {
        for option in 0..options {
            problem.finish_one(outer.len(), option, from, *first, spare, keep);
        }
    }
}

/// The innermost level of an arm, compiled. It is `None` inside if the rows are finished design by design.
pub struct CompiledArm(Option<Row>);

impl FinishRows for ArmProblem<'_> {
    type Compiled = CompiledArm;
    type Scratch = RowScratch;

    fn compile(&self) -> CompiledArm {
        CompiledArm(Row::new(self))
    }

    fn scratch(&self) -> RowScratch {
        RowScratch::new(self)
    }

    fn finish<K: Keep>(
        &self,
        compiled: &CompiledArm,
        rows: &[(u128, Partial)],
        scratch: &mut RowScratch,
        keep: &mut K,
    ) {
        let Some(row) = &compiled.0 else {
            return finish_one_by_one(self, rows, &mut scratch.spare, keep);
        };
        let options = self.level_sizes().last().copied().unwrap_or(0);
        scratch.begin(self, row, rows.iter().map(|(_, from)| from));
        in_lanes(RowsWork { problem: self, row, rows, options, scratch, keep });
    }
}
