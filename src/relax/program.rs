//! The lightest mixture: a linear program solved by Clarabel, and its Lagrangian bound.
//!
//! Minimize `Σ m_so w_so` subject to `Σ_o w_so = 1`, `w ≥ 0` and the rows `Σ c_rso w_so ≤ b_r`. Here `w_so` is the
//! weight of option `o` of slot `s`, `m_so` its mass and `c_rso` its coefficient in row `r`. The solver gets only a
//! few options of each slot. For its multipliers `y ≥ 0`
//!
//! ```text
//! L(y) = Σ_s min_o (m_so + Σ_r y_r c_rso) - Σ_r y_r b_r
//! ```
//!
//! over *all* remaining options is a lower bound, for any `y`. The options that attain the minima are then added to
//! the solver's program (column generation).

use super::parts::Parts;
use super::row::Row;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SupportedConeT};

/// Number of options that are added to each slot of the solver's program in one step.
const OPTIONS_ADDED: usize = 3;

/// The linear program, and the options over which it is solved.
pub(super) struct Program {
    masses: Vec<Vec<f64>>,
    rows: Vec<Row>,
    /// For each slot, the options that are in the solver's program, as indices among the remaining options.
    seen: Vec<Vec<usize>>,
    /// The best lower bound so far \[kg\], and the multipliers of the rows that give it.
    best: (f64, Vec<f64>),
}

/// The solution of the linear program over those options that are in the solver's program.
struct Solved {
    /// The weights of these options in the mixture, slot by slot.
    weights: Vec<f64>,
    /// The multipliers of the rows, all at least zero.
    multipliers: Vec<f64>,
}

/// The result of solving the program once.
pub(super) struct Solution {
    /// Lower bound on the mass \[kg\].
    pub bound_kg: f64,
    /// For each slot, the weight of every remaining option in the mixture that solves the program.
    pub weights: Vec<Vec<f64>>,
    /// Whether options were added to the solver's program. The mixture may then become lighter in the next
    /// solution.
    pub grew: bool,
}

impl Program {
    /// A program that starts with three kinds of options: the options of the known design, the lightest option of each
    /// slot and, for each row, the option of each slot with the least coefficient.
    pub(super) fn new(parts: &Parts, rows: Vec<Row>) -> Self {
        let masses = parts.masses();
        let seen = (0..masses.len())
            .map(|slot| {
                let known = parts.alive[slot].iter().position(|&o| o == parts.known[slot]);
                let mut seen: Vec<usize> = known.into_iter().chain([place_of_least(&masses[slot])]).collect();
                seen.extend(rows.iter().map(|row| place_of_least(&row.coefficients[slot])));
                seen.sort_unstable();
                seen.dedup();
                seen
            })
            .collect();
        Self { masses, rows, seen, best: (0.0, Vec::new()) }
    }

    /// Adds an inequality to the program.
    pub(super) fn add(&mut self, row: Row) {
        for (slot, seen) in self.seen.iter_mut().enumerate() {
            see(seen, place_of_least(&row.coefficients[slot]));
        }
        self.rows.push(row);
    }

    /// Solves the program. `None` if the solver finds no solution.
    pub(super) fn solve(&mut self) -> Option<Solution> {
        let Solved { weights: flat, multipliers } = self.solver()?;
        let mut weights: Vec<Vec<f64>> = self.masses.iter().map(|m| vec![0.0; m.len()]).collect();
        let mut value_kg = 0.0;
        let places =
            self.seen.iter().enumerate().flat_map(|(slot, seen)| seen.iter().map(move |&at| (slot, at)));
        for ((slot, at), weight) in places.zip(flat) {
            weights[slot][at] = weight.max(0.0);
            value_kg += weight * self.masses[slot][at];
        }
        let reduced = self.reduced(&multipliers);
        let bound_kg = self.bound(&reduced, &multipliers);
        if bound_kg > self.best.0 {
            self.best = (bound_kg, multipliers);
        }
        // If the bound has reached the value of the mixture, no further option can improve it.
        let grew = bound_kg < value_kg * (1.0 - 1e-5) && self.see_more(&reduced);
        Some(Solution { bound_kg, weights, grew })
    }

    /// Drops those options from `parts` that no design of at most the mass `mass_kg` can have, by their reduced costs.
    pub(super) fn drop_options(&self, parts: &mut Parts, mass_kg: f64) {
        let (bound_kg, multipliers) = &self.best;
        let reduced = self.reduced(multipliers);
        for (slot, reduced) in reduced.iter().enumerate() {
            let least = reduced.iter().copied().fold(f64::INFINITY, f64::min);
            parts.keep(slot, |at, _| bound_kg + (reduced[at] - least) <= mass_kg);
        }
    }

    /// Reduced cost of each remaining option \[kg\]: its mass plus its coefficient in each row times the multiplier of
    /// this row. A row that was added after the last solution has no multiplier and adds nothing.
    fn reduced(&self, multipliers: &[f64]) -> Vec<Vec<f64>> {
        let mut out = self.masses.clone();
        for (row, y) in self.rows.iter().zip(multipliers).filter(|(_, y)| **y > 0.0) {
            for (sums, coefficients) in out.iter_mut().zip(&row.coefficients) {
                sums.iter_mut().zip(coefficients).for_each(|(sum, c)| *sum += y * c);
            }
        }
        out
    }

    /// The Lagrangian lower bound on the mass \[kg\] for these multipliers and the reduced costs that follow from them.
    fn bound(&self, reduced: &[Vec<f64>], multipliers: &[f64]) -> f64 {
        let least: f64 = reduced.iter().map(|r| r.iter().copied().fold(f64::INFINITY, f64::min)).sum();
        least - self.rows.iter().zip(multipliers).map(|(row, y)| y * row.limit).sum::<f64>()
    }

    /// Adds, for each slot, the options with the least reduced cost to the solver's program. Returns whether any of
    /// them was new.
    fn see_more(&mut self, reduced: &[Vec<f64>]) -> bool {
        let mut grew = false;
        for (seen, reduced) in self.seen.iter_mut().zip(reduced) {
            let mut order: Vec<usize> = (0..reduced.len()).collect();
            let most = OPTIONS_ADDED.min(order.len());
            // Only the options with the least reduced costs are needed; a full sort would cost more time.
            if most < order.len() {
                order.select_nth_unstable_by(most, |&a, &b| reduced[a].total_cmp(&reduced[b]));
            }
            for &at in &order[..most] {
                grew |= see(seen, at);
            }
        }
        grew
    }

    /// Solves the program over the options that it has. `None` if the solver fails.
    fn solver(&self) -> Option<Solved> {
        let (slots, rows) = (self.seen.len(), self.rows.len());
        let columns: usize = self.seen.iter().map(Vec::len).sum();
        let (mut starts, mut places, mut values, mut costs) = (vec![0], Vec::new(), Vec::new(), Vec::new());
        for (slot, seen) in self.seen.iter().enumerate() {
            for &at in seen {
                costs.push(self.masses[slot][at]);
                let mut put = |row: usize, value: f64| {
                    if value != 0.0 {
                        places.push(row);
                        values.push(value);
                    }
                };
                put(slot, 1.0);
                for (r, row) in self.rows.iter().enumerate() {
                    put(slots + r, row.coefficients[slot][at]);
                }
                put(slots + rows + costs.len() - 1, -1.0);
                starts.push(places.len());
            }
        }
        let height = slots + rows + columns;
        let matrix = CscMatrix::new(height, columns, starts, places, values);
        let mut right = vec![1.0; slots];
        right.extend(self.rows.iter().map(|row| row.limit));
        right.resize(height, 0.0);
        let cones = [SupportedConeT::ZeroConeT(slots), SupportedConeT::NonnegativeConeT(rows + columns)];
        let settings = DefaultSettingsBuilder::default().verbose(false).build().ok()?;
        let none = CscMatrix::zeros((columns, columns));
        let mut solver = DefaultSolver::new(&none, &costs, &matrix, &right, &cones, settings).ok()?;
        solver.solve();
        let solution = &solver.solution;
        let sound = |v: &[f64]| v.iter().all(|x| x.is_finite());
        let multipliers: Vec<f64> = solution.z[slots..slots + rows].iter().map(|z| z.max(0.0)).collect();
        (sound(&solution.x) && sound(&multipliers))
            .then(|| Solved { weights: solution.x.clone(), multipliers })
    }
}

fn place_of_least(numbers: &[f64]) -> usize {
    (0..numbers.len()).min_by(|&a, &b| numbers[a].total_cmp(&numbers[b])).unwrap_or_default()
}

/// Adds the index `at` to the sorted list `seen`, unless it is in the list already. Returns whether it was added.
fn see(seen: &mut Vec<usize>, at: usize) -> bool {
    match seen.binary_search(&at) {
        Ok(_) => false,
        Err(place) => {
            seen.insert(place, at);
            true
        }
    }
}
