//! Physics an arm has beyond its nominal model. An effect is a piece of the arm: it changes the
//! [`Structure`](super::Structure) that mechanics sees, so that statics, modes and search see it alike.

use serde_json::Value;

/// One effect of an arm, as its file names it.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Name, e.g. `bearing_tilt`.
    pub effect: String,
    /// A joint, a link, `base`, `payload`, `arm` or a channel.
    pub at: String,
    /// Parameters by name; a vector parameter has several numbers.
    pub parameters: Vec<(String, Vec<f64>)>,
    /// Where the values come from, kept as written.
    pub source: Option<Value>,
}
