//! Keys of input files. Each kind of object that a file may hold has one table of its keys ([`Shape`]). The reader refuses
//! keys that are not in it, `armwright schema` prints it as a JSON Schema, and `docs/keys.md` shows it.

/// One kind of object: its keys, and the rules between them.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Name, which is unique within a kind of file.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub about: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
    /// What keys are allowed next to each other.
    pub rules: &'static [Rule],
    /// What other keys hold; `None` makes them faults.
    pub others: Option<&'static Kind>,
}

/// One key of an object.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Name, with the unit.
    pub name: &'static str,
    /// What its value may be.
    pub kind: Kind,
    /// Unit; `-` for none.
    pub unit: &'static str,
    /// What holds without the key, as JSON or in words; `None` if the key is required.
    pub default: Option<&'static str>,
    /// What it is, in a sentence.
    pub about: &'static str,
}

/// What a value may be.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// Any JSON.
    Anything,
    /// `null`.
    Null,
    /// `true` or `false`.
    Flag,
    /// A text.
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
    /// A number from zero to less than this.
    Below(f64),
    /// A number from the first to the second, ends included.
    Range(f64, f64),
    /// A whole number that is at least this.
    Whole(u32),
    /// A list of so many values of a kind.
    Array(usize, &'static Kind),
    /// A list of values of a kind.
    List(&'static Kind),
    /// A list of at least one value of a kind.
    NonEmpty(&'static Kind),
    /// An object of any keys with values of a kind.
    Map(&'static Kind),
    /// An object with keys of its own.
    Object(&'static Shape),
    /// A value of any of some kinds.
    Either(&'static [Kind]),
}

/// Which keys must, and which may not, stand next to each other.
#[derive(Debug, Clone, Copy)]
pub enum Rule {
    /// At least one of these keys is there.
    Any(&'static [&'static str]),
    /// The key needs at least one of the others.
    Needs(&'static str, &'static [&'static str]),
    /// The key refuses the others.
    Refuses(&'static str, &'static [&'static str]),
    /// Where the key is there, its value decides.
    When {
        /// The key.
        key: &'static str,
        /// The kind of its value that the first pair of lists is about; the second pair is about any other value.
        is: Kind,
        /// Keys that are then needed, and those that are refused.
        then: [&'static [&'static str]; 2],
        /// Keys that are needed otherwise, and those that are refused.
        otherwise: [&'static [&'static str]; 2],
    },
}

impl Shape {
    /// A kind of object whose other keys are faults.
    pub const fn new(
        name: &'static str,
        about: &'static str,
        keys: &'static [Key],
        rules: &'static [Rule],
    ) -> Self {
        Self { name, about, keys, rules, others: None }
    }

    /// Whether it has a key of this name.
    pub fn has(&self, name: &str) -> bool {
        self.keys.iter().any(|key| key.name == name)
    }

    /// The names of its keys.
    pub fn names(&self) -> Vec<&'static str> {
        self.keys.iter().map(|key| key.name).collect()
    }
}

/// A key that must be there.
pub(crate) const fn required(name: &'static str, kind: Kind, unit: &'static str, about: &'static str) -> Key {
    Key { name, kind, unit, default: None, about }
}

/// A key that may be left out. `default` is JSON, or says in words what holds then.
pub(crate) const fn optional(
    name: &'static str,
    kind: Kind,
    unit: &'static str,
    default: &'static str,
    about: &'static str,
) -> Key {
    Key { name, kind, unit, default: Some(default), about }
}

/// The address of the schema, which editors look for in a file; programs ignore it.
pub(crate) const SCHEMA_ADDRESS: Key = optional(
    "$schema",
    Kind::Anything,
    "-",
    "none",
    "Where an editor finds the schema of this file; ignored.",
);

/// The words of a table of words and values.
pub(crate) const fn words_of<T, const N: usize>(pairs: &[(&'static str, T)]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = pairs[i].0;
        i += 1;
    }
    words
}
