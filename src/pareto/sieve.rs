//! Sieve: drops most dominated points in two passes, before anything is sorted.
//!
//! The first two objectives are divided into bins of about equal content, which a sample determines. A table has the
//! smallest third objective of each pair of bins and of all pairs below it. A point is dropped if some point in *lower*
//! bins of both objectives has a smaller third objective. That point is then smaller in all three objectives, because a
//! number in a lower bin is a smaller number. Badly chosen bins let more points through, but never drop a point that is
//! not dominated.

use rayon::prelude::*;
use std::cmp::Ordering;

/// Smallest number of points for which the sieve is used. For fewer points it costs more than it saves.
const WORTH_IT: usize = 1 << 12;
/// Largest number of points in the sample.
const SAMPLE: usize = 1 << 12;
/// Number of bins of each of the two objectives.
const BINS: usize = 256;
/// Number of equal steps of an objective's range. Bins are made of whole steps.
const STEPS: usize = 1 << 12;

/// Indices, ascending, of the points that may be on the front. For every point that is left out, another point is
/// better in all three objectives by more than `slack` (relative).
pub(crate) fn sieve(points: &[[f64; 3]], slack: f64) -> Vec<u32> {
    let index = |i: usize| u32::try_from(i).expect("fewer than 2^32 points fit into memory");
    if points.len() < WORTH_IT {
        return (0..points.len()).map(index).collect();
    }
    let bins = [0, 1].map(|objective| Bins::new(points, objective));
    let table = Table::new(points, &bins);
    let stays = |p: &[f64; 3]| {
        let lowered = p.map(|x| x - slack * x.abs());
        // An infinite objective cannot be lowered. A point with such an objective stays.
        table.best_below(bins[0].of(lowered[0]), bins[1].of(lowered[1])).partial_cmp(&lowered[2])
            != Some(Ordering::Less)
    };
    points.par_iter().enumerate().filter(|(_, p)| stays(p)).map(|(i, _)| index(i)).collect()
}

/// The division of one objective into bins. A larger number is never in a lower bin.
struct Bins {
    low: f64,
    steps_per_unit: f64,
    bin: Vec<u16>,
}

impl Bins {
    /// Divides the objective with the index `objective` into bins.
    fn new(points: &[[f64; 3]], objective: usize) -> Self {
        // The sample is every n-th point, so that the sample and the result are the same in every run.
        let stride = points.len().div_ceil(SAMPLE);
        let mut sample: Vec<f64> =
            points.iter().step_by(stride).map(|p| p[objective]).filter(|x| x.is_finite()).collect();
        sample.sort_unstable_by(f64::total_cmp);
        let (low, high) = (sample.first().copied().unwrap_or(0.0), sample.last().copied().unwrap_or(0.0));
        let steps_per_unit = Some((STEPS - 1) as f64 / (high - low)).filter(|s| s.is_finite()).unwrap_or(0.0);
        let mut bins = Self { low, steps_per_unit, bin: vec![0; STEPS] };
        for (rank, x) in sample.iter().enumerate() {
            let step = bins.step(*x);
            bins.bin[step] = (rank * BINS / sample.len()) as u16;
        }
        for step in 1..STEPS {
            bins.bin[step] = bins.bin[step].max(bins.bin[step - 1]);
        }
        bins
    }

    /// The step in which a number lies. The conversion to an integer saturates, so a number outside of the range
    /// gets the first or the last step.
    fn step(&self, x: f64) -> usize {
        (((x - self.low) * self.steps_per_unit) as usize).min(STEPS - 1)
    }

    /// The index of the bin that contains `x`.
    fn of(&self, x: f64) -> usize {
        self.bin[self.step(x)].into()
    }
}

/// For each pair of bins, the smallest third objective of the points in this pair or in lower bins.
struct Table(Vec<f64>);

impl Table {
    /// Fills the table. Each thread takes a part of the points.
    fn new(points: &[[f64; 3]], bins: &[Bins; 2]) -> Self {
        let empty = || vec![f64::INFINITY; BINS * BINS];
        let share = points.len().div_ceil(rayon::current_num_threads()).max(WORTH_IT);
        let fill = |part: &[[f64; 3]]| {
            let mut cells = empty();
            for p in part {
                let cell = &mut cells[bins[0].of(p[0]) * BINS + bins[1].of(p[1])];
                *cell = cell.min(p[2]);
            }
            cells
        };
        let least = |mut a: Vec<f64>, b: Vec<f64>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a = a.min(b));
            a
        };
        let mut cells = points.par_chunks(share).map(fill).reduce(empty, least);
        for row in 0..BINS {
            for column in 0..BINS {
                let here = row * BINS + column;
                let before = if column > 0 { cells[here - 1] } else { f64::INFINITY };
                let under = if row > 0 { cells[here - BINS] } else { f64::INFINITY };
                cells[here] = cells[here].min(before).min(under);
            }
        }
        Self(cells)
    }

    /// The smallest third objective among points that are in strictly lower bins of both objectives.
    fn best_below(&self, row: usize, column: usize) -> f64 {
        match (row.checked_sub(1), column.checked_sub(1)) {
            (Some(row), Some(column)) => self.0[row * BINS + column],
            _ => f64::INFINITY,
        }
    }
}
