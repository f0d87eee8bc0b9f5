//! A row of the table of position errors.

use serde_json::{Value, json};

/// How well a model predicts positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// What was added to the stage before.
    pub added: String,
    /// What it made needless.
    pub dropped: Vec<String>,
    /// Median error of the poses it was fitted to \[mm\].
    pub fitted_median_mm: f64,
    /// Median error of poses kept out of the fit \[mm\].
    pub median_mm: f64,
    /// Their mean error \[mm\].
    pub mean_mm: f64,
    /// Their largest error \[mm\].
    pub max_mm: f64,
}

impl Stage {
    /// As in `verdict.json`.
    pub fn json(&self) -> Value {
        json!({
            "added": self.added, "dropped": self.dropped, "fitted_median_mm": self.fitted_median_mm, "kept_out_median_mm": self.median_mm,
            "kept_out_mean_mm": self.mean_mm, "kept_out_largest_mm": self.max_mm,
        })
    }
}
