//! One linear inequality of the program.

/// Margin for rounding of an inequality, relative to its largest terms.
const ROUNDING: f64 = 1e-9;

/// The inequality `Σ coefficient · weight ≤ limit` over the weights of options in a mixture. There is one list of
/// coefficients for each slot, with one coefficient for each remaining option.
#[derive(Clone)]
pub(super) struct Row {
    pub coefficients: Vec<Vec<f64>>,
    pub limit: f64,
}

impl Row {
    /// For each slot (piece of the arm), the least coefficient that an option of the slot has in this inequality.
    pub(super) fn least(&self) -> Vec<f64> {
        self.coefficients.iter().map(|c| c.iter().copied().fold(f64::INFINITY, f64::min)).collect()
    }

    /// Whether some choice of options violates the inequality. If none does, the inequality can be left out.
    pub(super) fn can_bind(&self) -> bool {
        let most: f64 =
            self.coefficients.iter().map(|c| c.iter().copied().fold(f64::NEG_INFINITY, f64::max)).sum();
        most > self.limit
    }

    /// The same inequality, scaled so that no coefficient exceeds 1 in magnitude, with the margin for rounding
    /// added to its limit.
    pub(super) fn ready(mut self) -> Self {
        let largest_of = |c: &Vec<f64>| c.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        let terms: Vec<f64> = self.coefficients.iter().map(largest_of).collect();
        self.limit += ROUNDING * (self.limit.abs() + terms.iter().sum::<f64>());
        let largest = terms.iter().fold(self.limit.abs(), |largest, x| largest.max(*x));
        if largest > 0.0 {
            self.coefficients.iter_mut().flatten().for_each(|c| *c /= largest);
            self.limit /= largest;
        }
        self
    }
}
