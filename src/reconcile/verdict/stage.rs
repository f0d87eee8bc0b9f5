//! One row of the table of position errors.

use serde_json::{Value, json};

/// Position errors (distances between measured and predicted point) at one stage of the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// The effect, or the group of calibrated numbers, that this stage added.
    pub added: String,
    /// Effects that the addition made unnecessary and that were dropped.
    pub dropped: Vec<String>,
    /// Median position error of the poses in the fit \[mm\].
    pub fitted_median_mm: f64,
    /// Median position error of held-out poses \[mm\].
    pub median_mm: f64,
    /// Mean position error of held-out poses \[mm\].
    pub mean_mm: f64,
    /// Largest position error of held-out poses \[mm\].
    pub max_mm: f64,
}

impl Stage {
    /// The entry of the stage in `verdict.json`.
    pub fn json(&self) -> Value {
        json!({
            "added": self.added, "dropped": self.dropped, "fitted_median_mm": self.fitted_median_mm, "kept_out_median_mm": self.median_mm,
            "kept_out_mean_mm": self.mean_mm, "kept_out_largest_mm": self.max_mm,
        })
    }
}
