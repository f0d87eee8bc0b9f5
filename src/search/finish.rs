//! Evaluates all designs of a row together.
//!
//! A *row* is the set of designs that differ in the row level alone. Some numbers depend on the options of that level
//! but not on the arm outboard of it; they are computed once ([`FinishRows::compile`]). Each worker then completes
//! and evaluates the designs of its rows, in working space of its own.

use super::row::Row;
use super::row_begun::RowScratch;
use super::row_lanes::RowsWork;
use crate::mechanics::lanes::in_lanes;
use crate::space::levels::{DesignRow, Keep, OutwardIn};
use crate::space::problem::{ArmProblem, Partial};

/// A tree of designs in which all designs of a row (the designs that differ in the row level alone) can be completed
/// and evaluated together.
pub trait FinishRows: OutwardIn {
    /// The row level (whose options are evaluated together) and the levels inboard of it, with every number that is the
    /// same in all rows.
    type Compiled: Send + Sync;
    /// Working space of a worker. It is used again for each row, so that memory is allocated once.
    type Scratch: Send;

    /// Computes once the numbers that are the same in all rows.
    fn compile(&self) -> Self::Compiled;

    /// Allocates the working space of one worker.
    fn scratch(&self) -> Self::Scratch;

    /// Completes and evaluates all designs of the rows `rows` and reports them to `keep`. `compiled` has the numbers
    /// that all rows have in common, and `scratch` is the working space.
    fn finish<K: Keep>(
        &self,
        compiled: &Self::Compiled,
        rows: &[DesignRow<Self::Partial>],
        scratch: &mut Self::Scratch,
        keep: &mut K,
    );
}

/// Evaluates the designs of `rows` one by one. This is slower than eight at once, but works for every tree of designs.
/// `spare` is memory for one arm.
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

/// The row level of an arm, with every number that is the same in all rows. It is `None` if eight designs cannot be
/// evaluated at once. The designs are then evaluated one by one.
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
