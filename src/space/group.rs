//! Of which material the chosen links of a design are.

/// The material of the links so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) enum Group {
    #[default]
    None,
    One(usize),
    Mixed,
}

impl Group {
    /// The material, if all links so far are of one.
    pub(crate) fn material(self) -> Option<usize> {
        match self {
            Group::One(material) => Some(material),
            _ => None,
        }
    }

    /// The group with one more link. A given tube has no material here and changes nothing.
    pub(crate) fn with(self, material: Option<usize>) -> Self {
        match (self, material) {
            (group, None) => group,
            (Group::None, Some(m)) => Group::One(m),
            (Group::One(a), Some(m)) if a == m => Group::One(a),
            _ => Group::Mixed,
        }
    }
}
