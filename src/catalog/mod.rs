//! What can be bought: materials, profiles, gears, motors.
//!
//! One CSV file a kind. A blank cell is unknown, never zero. Every row names its source and how far it
//! can be trusted. [`Catalogs::builtin`] is what the program brings along, [`Catalogs::load`] adds the
//! rows of a folder of the user's; [`Catalogs::gear`] and its sisters find a part by name.

pub(crate) mod efficiency;
pub(crate) mod envelope;
pub(crate) mod gear;
pub(crate) mod load;
pub(crate) mod lookup;
pub(crate) mod material;
pub(crate) mod motor;
pub(crate) mod needs;
pub(crate) mod profile;
pub(crate) mod read;
pub(crate) mod schema;
mod table_schema;

pub use efficiency::{EfficiencyKind, EfficiencyPoint};
pub use envelope::Envelope;
pub use gear::{BearingRatings, Gear, GearKind, GearMass, LifeLaw};
pub use load::Loaded;
pub use lookup::{PartError, PartKind};
pub use material::{Material, MaterialClass};
pub use motor::{Motor, MotorCurvePoint, MotorKind};
pub use needs::Lack;
pub use profile::{Profile, ProfileShape};
pub use schema::{CatalogFile, Cell, Column};

use crate::input::json::Fault;
use std::collections::BTreeMap;
use std::fmt;

/// How far a catalog row can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Confidence {
    /// Read in a vendor's or a library's document.
    Verified,
    /// Read in a transcription by a third party.
    ThirdParty,
    /// Recalled, no document seen.
    FromMemory,
    /// A typical figure of the class, not of this part.
    Representative,
}

impl Confidence {
    /// Words of the column `confidence`.
    pub const WORDS: [&'static str; 5] = [
        "verified",
        "third party",
        "from memory",
        "representative",
        "from memory of vendor data, unverified",
    ];

    /// All levels, from the most trusted to the least.
    pub const ALL: [Confidence; 4] =
        [Confidence::Verified, Confidence::ThirdParty, Confidence::FromMemory, Confidence::Representative];

    /// The level a word of the column means.
    pub fn from_word(word: &str) -> Option<Self> {
        let place = Self::WORDS.iter().position(|w| w.eq_ignore_ascii_case(word))?;
        Some(*Self::ALL.get(place).unwrap_or(&Confidence::FromMemory))
    }
}

impl Provenance {
    /// Whether the row is one that comes with the program.
    pub fn is_built_in(&self) -> bool {
        self.file.starts_with(BUILT_IN)
    }

    /// What is said beside a part whose core figures were not read in its vendor's document: `third party`, `from memory` or
    /// `representative`.
    ///
    /// ```
    /// use armwright::catalog::Catalogs;
    ///
    /// let catalogs = Catalogs::builtin();
    /// let caveat = |name| catalogs.material(name).expect("built in").provenance.caveat();
    /// assert_eq!(caveat("Kevlar 49/epoxy quasi-isotropic"), Some("representative"));
    /// assert_eq!(caveat("Structural steel S355"), None);
    /// ```
    pub fn caveat(&self) -> Option<&'static str> {
        match self.confidence {
            Confidence::Verified => None,
            Confidence::ThirdParty | Confidence::FromMemory | Confidence::Representative => {
                Some(Confidence::WORDS[self.confidence as usize])
            }
        }
    }
}

/// How the names of the program's own files begin.
pub(crate) const BUILT_IN: &str = "built-in ";

impl fmt::Display for Confidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(Self::WORDS[*self as usize])
    }
}

/// Where a catalog row comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// Document or library.
    pub source: String,
    /// Trust in the core figures.
    pub confidence: Confidence,
    /// Columns of this row that were not seen in a document.
    pub unverified_fields: Vec<String>,
    /// File and line the row was read from.
    pub file: String,
    /// Line in that file, from 1.
    pub line: usize,
}

/// Everything that can be bought.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Catalogs {
    /// Gears of every kind, and the gears within actuators.
    pub gears: Vec<Gear>,
    /// Motors, and the motors within actuators.
    pub motors: Vec<Motor>,
    /// Link materials.
    pub materials: Vec<Material>,
    /// Hollow profiles.
    pub profiles: Vec<Profile>,
    /// Points of efficiency curves of gears.
    pub efficiency: Vec<EfficiencyPoint>,
    /// Other names of gear series: the name `CSF` to the series `HFUC`.
    pub series_aliases: BTreeMap<String, String>,
    /// Every row as it stands in its file, by file and line: the columns and their cells.
    pub printed: BTreeMap<(String, usize), PrintedRow>,
    /// How many rows each file gave.
    pub loaded: Vec<Loaded>,
    /// What is odd but no reason to refuse: figures far from the usual, ratings that fall with size.
    pub warnings: Vec<Fault>,
}

/// The cells of a row with their columns, as they stand in the file; columns it lacks are blank.
pub type PrintedRow = Vec<(&'static str, String)>;

impl Catalogs {
    /// The row a part was read from, cell by cell; empty for parts that were not read from a file.
    pub fn printed_row(&self, provenance: &Provenance) -> &[(&'static str, String)] {
        self.printed.get(&(provenance.file.clone(), provenance.line)).map_or(&[], Vec::as_slice)
    }
}
