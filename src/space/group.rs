//! The material of the chosen links of a design, which decides in which group the design is.

/// The material that the chosen links of a partial arm have in common.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) enum Group {
    #[default]
    /// No link has been chosen so far.
    None,
    /// All chosen links are of the material with this number.
    One(usize),
    /// The chosen links are of several materials.
    Mixed,
}

impl Group {
    /// Number of the material, if all links so far are of one material; otherwise `None`.
    pub(crate) fn material(self) -> Option<usize> {
        match self {
            Group::One(material) => Some(material),
            _ => None,
        }
    }

    /// The group after a link of this material is added. A link that the study gives has no material here (`None`) and
    /// changes nothing.
    pub(crate) fn with(self, material: Option<usize>) -> Self {
        match (self, material) {
            (group, None) => group,
            (Group::None, Some(m)) => Group::One(m),
            (Group::One(a), Some(m)) if a == m => Group::One(a),
            _ => Group::Mixed,
        }
    }
}
