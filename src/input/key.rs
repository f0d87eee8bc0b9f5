//! Keys of input files. Each kind of object in a file has one table of its keys ([`Shape`]). The reader refuses
//! keys that are not in this table, `armwright schema` prints the table as a JSON Schema, and `docs/keys.md` shows
//! it.

/// One kind of object in a file: its keys, and rules on which of them may occur together.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Name of the kind of object, which is unique within a kind of file.
    pub name: &'static str,
    /// Description in a sentence.
    pub about: &'static str,
    /// Keys of the object.
    pub keys: &'static [Key],
    /// Rules on which keys may or must occur together.
    pub rules: &'static [Rule],
    /// Allowed values of keys that are not in the table; `None` if such keys are faults.
    pub others: Option<&'static Kind>,
}

/// One key of a kind of object.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Name of the key, with the unit.
    pub name: &'static str,
    /// Allowed values.
    pub kind: Kind,
    /// Unit of the value; `-` if it has none.
    pub unit: &'static str,
    /// The value that is used if a file does not have the key, as JSON or in words; `None` if the key is required.
    pub default: Option<&'static str>,
    /// Description in a sentence.
    pub about: &'static str,
}

/// The kind of value that a key allows.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// Any JSON value.
    Anything,
    /// `null`.
    Null,
    /// `true` or `false`.
    Flag,
    /// Any text.
    Text,
    /// A text that is not empty.
    Name,
    /// One of some words.
    Word(&'static [&'static str]),
    /// A finite number.
    Number,
    /// A number greater than zero.
    Positive,
    /// A number not less than zero.
    NonNegative,
    /// A number from zero to below this limit.
    Below(f64),
    /// A number from the first to the second limit, limits included.
    Range(f64, f64),
    /// A whole number that is at least this limit.
    Whole(u32),
    /// A list of exactly this many values of one kind.
    Array(usize, &'static Kind),
    /// A list of any length, whose values are all of one kind.
    List(&'static Kind),
    /// A list with at least one value, whose values are all of one kind.
    NonEmpty(&'static Kind),
    /// An object with any keys, whose values are of one kind.
    Map(&'static Kind),
    /// An object with the keys of a shape.
    Object(&'static Shape),
    /// A value of one of several kinds.
    Either(&'static [Kind]),
}

/// A rule on which keys must occur together and which must not.
#[derive(Debug, Clone, Copy)]
pub enum Rule {
    /// At least one of these keys must occur.
    Any(&'static [&'static str]),
    /// If the key occurs, at least one of the others must occur.
    Needs(&'static str, &'static [&'static str]),
    /// If the key occurs, none of the others may occur.
    Refuses(&'static str, &'static [&'static str]),
    /// If the key occurs, its value determines which other keys must or must not occur.
    When {
        /// Name of the key.
        key: &'static str,
        /// Kind of value that selects `then`. Any other value selects `otherwise`.
        is: Kind,
        /// Keys that must occur, and keys that must not occur, for a value of this kind.
        then: [&'static [&'static str]; 2],
        /// Keys that must occur, and keys that must not occur, for any other value.
        otherwise: [&'static [&'static str]; 2],
    },
}

impl Shape {
    /// A kind of object with the given name, description, keys and rules. Keys that are not among `keys` are faults.
    pub const fn new(
        name: &'static str,
        about: &'static str,
        keys: &'static [Key],
        rules: &'static [Rule],
    ) -> Self {
        Self { name, about, keys, rules, others: None }
    }

    /// Whether the table has a key of this name.
    pub fn has(&self, name: &str) -> bool {
        self.keys.iter().any(|key| key.name == name)
    }

    /// The names of all keys in the table.
    pub fn names(&self) -> Vec<&'static str> {
        self.keys.iter().map(|key| key.name).collect()
    }
}

impl Key {
    /// This key with another default: the value that is used if a file does not have the key, as JSON or in words.
    pub(crate) const fn or(self, default: &'static str) -> Self {
        Self { default: Some(default), ..self }
    }
}

/// A key that must occur.
pub(crate) const fn required(name: &'static str, kind: Kind, unit: &'static str, about: &'static str) -> Key {
    Key { name, kind, unit, default: None, about }
}

/// A key that may be left out. `default` is the value that is then used, as JSON or in words.
pub(crate) const fn optional(
    name: &'static str,
    kind: Kind,
    unit: &'static str,
    default: &'static str,
    about: &'static str,
) -> Key {
    Key { name, kind, unit, default: Some(default), about }
}

/// The key `$schema` with the address of the schema. Editors read it, and the program ignores it.
pub(crate) const SCHEMA_ADDRESS: Key = optional(
    "$schema",
    Kind::Anything,
    "-",
    "none",
    "Where an editor finds the schema of this file; ignored.",
);

/// The words of a table whose entries are pairs of a word and a value, in the same order.
pub(crate) const fn words_of<T, const N: usize>(pairs: &[(&'static str, T)]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = pairs[i].0;
        i += 1;
    }
    words
}
