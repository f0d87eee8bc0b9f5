//! Finds the row before which something happened in the course of the tests: a base turned, an instrument moved, or a
//! payload slipped. A descent cannot find this row, because predicted readings jump as the row changes.

use crate::arm::effect::channel::Channel;
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::forward::statics::StaticPose;
use nalgebra::{Matrix3, Vector3};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Smallest number of poses that must come before a turn of the base, and of poses that must come after it.
const FEWEST_POSES: usize = 2;
/// Smallest number of rows that must come before an event, and of rows that must come after it, if the event may be
/// between any two rows.
const FEWEST_ROWS: usize = 4;
/// Fraction of the trace of the curvature matrix that is added to its diagonal, so that the equations stay regular if a
/// parameter has no influence on the readings.
const RIDGE: f64 = 1e-9;
/// Displacement of a payload's centre of gravity by which its influence on the readings is computed \[m\].
const SLIP_STEP_M: f64 = 1e-3;

/// The rows of the displacements, counted from 0, at which a pose begins. Only rows with at least [`FEWEST_POSES`]
/// poses before them, and at least as many from them on, are listed.
pub(super) fn pose_starts(forward: &Forward) -> Vec<usize> {
    let first_row = |pose: &StaticPose| {
        let data = (0..pose.count()).flat_map(|load| pose.measured(load));
        data.map(|(_, datum)| forward.data[datum].row).min()
    };
    let starts: BTreeSet<usize> = forward.statics.iter().filter_map(first_row).collect();
    inner(starts, FEWEST_POSES)
}

/// The rows of the displacements, counted from 0, that have at least [`FEWEST_ROWS`] rows before them and from which on
/// there are at least as many.
pub(super) fn static_rows(forward: &Forward) -> Vec<usize> {
    inner(rows_of(forward, Channel::Static), FEWEST_ROWS)
}

fn rows_of(forward: &Forward, channel: Channel) -> BTreeSet<usize> {
    forward.data[forward.range(channel)].iter().map(|datum| datum.row).collect()
}

/// Those of the `rows` that have at least `fewest` rows before them, and from which on there are at least `fewest`
/// rows.
fn inner(rows: BTreeSet<usize>, fewest: usize) -> Vec<usize> {
    let last = (rows.len() + 1).saturating_sub(fewest);
    rows.into_iter().take(last).skip(fewest).collect()
}

/// Normal equations of three parameters.
#[derive(Debug, Clone, Copy)]
struct Equations {
    curvature: Matrix3<f64>,
    gradient: Vector3<f64>,
}

impl Equations {
    fn none() -> Self {
        Self { curvature: Matrix3::zeros(), gradient: Vector3::zeros() }
    }

    fn plus(&self, other: &Self) -> Self {
        Self { curvature: self.curvature + other.curvature, gradient: self.gradient + other.gradient }
    }

    /// Fall of chi-squared if the parameters are fitted; 0 if the readings show none of them. A parameter that no reading
    /// shows, such as a direction that was not measured, stays at zero.
    fn gain(&self) -> f64 {
        let ridge = Matrix3::from_diagonal_element(RIDGE * self.curvature.trace());
        let factor = (self.curvature + ridge).cholesky();
        factor.map_or(0.0, |factor| self.gradient.dot(&factor.solve(&self.gradient)))
    }
}

/// The changes of all readings by an event with three parameters, and the residuals of a fit without the event.
struct Influence {
    /// For each parameter, the change of each reading per unit, in standard deviations.
    columns: [Vec<f64>; 3],
    /// Residual of each reading, in standard deviations.
    residuals: Vec<f64>,
    /// For each reading, the row, from 0, that decides whether the reading was taken after the event.
    rows: Vec<usize>,
}

impl Influence {
    /// `columns` has the change of each reading in its unit.
    fn new(forward: &Forward, fit: &Fit, weights: &Weights, columns: [Vec<f64>; 3]) -> Self {
        let scaled =
            |column: Vec<f64>| column.iter().zip(&weights.inverse).map(|(c, weight)| c * weight).collect();
        let mut rows: Vec<usize> = forward.data.iter().map(|datum| datum.row).collect();
        for test in &forward.modal {
            test.modes.iter().for_each(|(datum, _)| rows[*datum] = test.first_row());
        }
        Self { columns: columns.map(scaled), residuals: fit.residuals(forward, weights), rows }
    }

    /// For each row, the normal equations of its readings. Only readings in `range` are used.
    fn by_row(&self, range: &Range<usize>) -> BTreeMap<usize, Equations> {
        let mut out = BTreeMap::new();
        for i in range.clone() {
            let slope = Vector3::from_fn(|k, _| self.columns[k][i]);
            let own = Equations { curvature: slope * slope.transpose(), gradient: slope * self.residuals[i] };
            let row = out.entry(self.rows[i]).or_insert_with(Equations::none);
            *row = row.plus(&own);
        }
        out
    }

    /// Normal equations of the readings `range` from the row `from_row` on.
    fn equations(&self, range: &Range<usize>, from_row: usize) -> Equations {
        self.by_row(range).range(from_row..).fold(Equations::none(), |sum, (_, own)| sum.plus(own))
    }

    /// The row of `rows`, which are sorted, at which the event lowers chi-squared of the readings `range` most; the
    /// last one if several lower it equally. `known` are the normal equations of other readings after the event. `None`
    /// if the event lowers chi-squared at no row.
    fn best_row(&self, range: &Range<usize>, rows: &[usize], known: &Equations) -> Option<usize> {
        let mut before = self.by_row(range);
        let mut after = *known;
        let mut best: Option<(f64, usize)> = None;
        for row in rows.iter().rev() {
            after = before.split_off(row).values().fold(after, |sum, own| sum.plus(own));
            let gain = after.gain();
            if gain > best.map_or(0.0, |(largest, _)| largest) {
                best = Some((gain, *row));
            }
        }
        best.map(|(_, row)| row)
    }
}

/// The row of `rows` before which a turn of the base would explain most of the residuals of `fit`.
pub(super) fn of_turn(forward: &Forward, fit: &Fit, weights: &Weights, rows: &[usize]) -> Option<usize> {
    let mut columns = [(); 3].map(|()| vec![0.0; forward.data.len()]);
    for pose in &forward.statics {
        for (component, datum) in (0..pose.count()).flat_map(|load| pose.measured(load)) {
            for (k, column) in columns.iter_mut().enumerate() {
                column[datum] = 1e3 * Vector3::ith(k, 1.0).cross(&pose.geometry.tip_m)[component];
            }
        }
    }
    let influence = Influence::new(forward, fit, weights, columns);
    influence.best_row(&forward.range(Channel::Static), rows, &Equations::none())
}

/// The row of `rows` before which a motion of the instrument would explain most of the residuals of `fit`.
pub(super) fn of_shift(forward: &Forward, fit: &Fit, weights: &Weights, rows: &[usize]) -> Option<usize> {
    let statics = forward.range(Channel::Static);
    let column = |k: usize| {
        let is_moved = |i: usize, component: usize| statics.contains(&i) && component == k;
        let moved = |(i, component): (usize, usize)| if is_moved(i, component) { 1.0 } else { 0.0 };
        forward.data.iter().map(|datum| datum.component).enumerate().map(moved).collect()
    };
    let influence = Influence::new(forward, fit, weights, [0, 1, 2].map(column));
    influence.best_row(&statics, rows, &Equations::none())
}

/// The rows, in the static and in the modal tests, before which a slip of the payload would explain most of the
/// residuals of `fit`. A row is `None` if the payload did not slip in these tests.
pub(super) fn of_slip(forward: &Forward, fit: &Fit, weights: &Weights) -> [Option<usize>; 2] {
    let column = |k: usize| {
        let mut moved = fit.point.coefficients.clone();
        moved.payload_offset_m[k] += SLIP_STEP_M;
        let readings = forward.predict(&moved);
        readings.iter().zip(&fit.point.predicted).map(|(to, from)| (to - from) / SLIP_STEP_M).collect()
    };
    let influence = Influence::new(forward, fit, weights, [0, 1, 2].map(column));
    let (statics, modal) = (forward.range(Channel::Static), forward.range(Channel::Modal));
    let Some(row) = influence.best_row(&statics, &static_rows(forward), &Equations::none()) else {
        return [None, None];
    };
    let known = influence.equations(&statics, row);
    // the payload may have slipped before the modal tests, in their course, or not at all
    let starts: BTreeSet<usize> = forward.modal.iter().map(|test| test.first_row()).collect();
    let starts: Vec<usize> = starts.into_iter().chain([usize::MAX]).collect();
    let in_modal = influence.best_row(&modal, &starts, &known).filter(|row| *row != usize::MAX);
    [Some(row), in_modal]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twelve readings of one direction, on which two of the three parameters have an influence. From row 6 on the
    /// readings are off.
    #[test]
    fn the_row_is_found_where_one_parameter_does_not_show() {
        let readings = 0..12;
        let lever = |i: usize| 1.0 + 0.1 * (i % 4) as f64;
        let influence = Influence {
            columns: [
                readings.clone().map(lever).collect(),
                readings.clone().map(|i| 2.0 - lever(i % 3)).collect(),
                vec![0.0; 12],
            ],
            residuals: readings.clone().map(|i| if i >= 6 { 3.0 * lever(i) } else { 0.0 }).collect(),
            rows: readings.clone().collect(),
        };
        let rows: Vec<usize> = (2..11).collect();
        assert_eq!(influence.best_row(&readings, &rows, &Equations::none()), Some(6));
        let silent = Influence { residuals: vec![0.0; 12], ..influence };
        assert_eq!(silent.best_row(&readings, &rows, &Equations::none()), None);
    }
}
