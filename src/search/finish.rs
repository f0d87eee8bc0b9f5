//! Rows of designs, finished together.
//!
//! A *row* is the set of designs that differ in the row level alone. Whatever depends on the options of that level but
//! not on the arm outboard of them is compiled once ([`FinishRows::compile`]). Each worker then finishes rows in working
//! space of its own.

use super::row::Row;
use super::row_begun::RowScratch;
use super::row_lanes::RowsWork;
use crate::mechanics::lanes::in_lanes;
use crate::space::levels::{DesignRow, Keep, OutwardIn};
use crate::space::problem::{ArmProblem, Partial};

/// A tree of designs that knows how to finish whole rows.
pub trait FinishRows: OutwardIn {
    /// The row level and all that is inboard of it, compiled once for all rows.
    type Compiled: Send + Sync;
    /// Working space of a worker, kept from one row to the next.
    type Scratch: Send;

    /// Compiles the row level.
    fn compile(&self) -> Self::Compiled;

    /// Working space for one worker.
    fn scratch(&self) -> Self::Scratch;

    /// Finishes rows of designs and shows them to `keep`.
    fn finish<K: Keep>(
        &self,
        compiled: &Self::Compiled,
        rows: &[DesignRow<Self::Partial>],
        scratch: &mut Self::Scratch,
        keep: &mut K,
    );
}

/// Finishes rows design by design. It is slower than rows in lanes and works for every tree.
pub(crate) fn finish_one_by_one<P: OutwardIn>(
    problem: &P,
    rows: &[DesignRow<P::Partial>],
    spare: &mut P::Partial,
    keep: &mut dyn Keep,
) {
    let Some(&options) = problem.level_sizes().get(problem.row_level()) else { return };
    for row in rows {
        for option in 0..options {
            problem.finish_one(row, option, spare, keep);
        }
    }
}

/// The row level of an arm, compiled. It is `None` inside if the rows are finished design by design.
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
        rows: &[DesignRow<Partial>],
        scratch: &mut RowScratch,
        keep: &mut K,
    ) {
        let Some(row) = &compiled.0 else {
            return finish_one_by_one(self, rows, &mut scratch.spare, keep);
        };
        let options = self.level_sizes().get(self.row_level()).copied().unwrap_or(0);
        scratch.begin(self, row, rows.iter().map(|row| &row.from));
        in_lanes(RowsWork { problem: self, row, rows, options, scratch, keep });
    }
}
