//! The scale of an axis: linear or logarithmic.

/// The scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Linear scale: equal steps of the value have equal lengths.
    #[default]
    Linear,
    /// Logarithmic scale: equal ratios of values have equal lengths. Values that are not positive are left out.
    Log,
}
