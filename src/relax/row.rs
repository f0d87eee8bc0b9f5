//! One linear inequality of the program.

/// What rounding may do to an inequality, relative to its largest terms.
const ROUNDING: f64 = 1e-9;

/// `Σ coefficient × weight ≤ limit`, coefficients by slot and by option left.
#[derive(Clone)]
pub(super) struct Row {
    pub coefficients: Vec<Vec<f64>>,
    pub limit: f64,
}

impl Row {
    /// Smallest coefficient of each slot.
    pub fn least(&self) -> Vec<f64> {
        self.coefficients.iter().map(|c| c.iter().copied().fold(f64::INFINITY, f64::min)).collect()
    }

    /// Whether some choice of options exceeds the limit.
    pub fn can_bind(&self) -> bool {
        let most: f64 =
            self.coefficients.iter().map(|c| c.iter().copied().fold(f64::NEG_INFINITY, f64::max)).sum();
        most > self.limit
    }

    /// The same inequality, its limit raised by what rounding may do to it, with no number larger than 1.
    pub fn ready(mut self) -> Self {
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
