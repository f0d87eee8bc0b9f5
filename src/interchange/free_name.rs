//! Unique names for the links and joints that a conversion adds to those of an arm or a robot.

use std::collections::BTreeSet;

/// The names that are taken.
#[derive(Debug, Clone, Default)]
pub(super) struct FreeNames {
    taken: BTreeSet<String>,
}

impl FreeNames {
    /// All names are free except for these.
    pub(super) fn all_but(taken: impl IntoIterator<Item = String>) -> Self {
        Self { taken: taken.into_iter().collect() }
    }

    /// Takes the name `name` if it is free. Otherwise appends `end` until the name is free. Returns the name that was
    /// taken.
    pub(super) fn take(&mut self, name: &str, end: &str) -> String {
        let mut free = name.to_string();
        while !self.taken.insert(free.clone()) {
            free.push_str(end);
        }
        free
    }
}
