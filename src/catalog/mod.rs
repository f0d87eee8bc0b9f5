//! Catalogs of parts that can be bought: materials, profiles, gears, motors.
//!
//! There is one CSV file for each kind. A blank cell means unknown, never zero. Every row states its source and its
//! confidence. [`Catalogs::builtin`] are the catalogs that are built into the program. [`Catalogs::load`] adds the
//! rows of a user's folder. [`Catalogs::gear`] and the similar functions find a part by its name.

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

/// The degree to which a catalog row can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Confidence {
    /// The numbers were read in a document of a vendor or from a library.
    Verified,
    /// The numbers were read in a third party's copy of such a document.
    ThirdParty,
    /// The numbers were recalled without a document.
    FromMemory,
    /// The numbers are typical of a class of parts. They are not the numbers of this part.
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

    /// All degrees of confidence, from the most trusted to the least.
    pub const ALL: [Confidence; 4] =
        [Confidence::Verified, Confidence::ThirdParty, Confidence::FromMemory, Confidence::Representative];

    /// The confidence that a word of the column means; `None` if it is not one of [`Self::WORDS`].
    pub fn from_word(word: &str) -> Option<Self> {
        let place = Self::WORDS.iter().position(|w| w.eq_ignore_ascii_case(word))?;
        Some(*Self::ALL.get(place).unwrap_or(&Confidence::FromMemory))
    }
}

impl Provenance {
    /// Whether the row is built into the program.
    pub fn is_built_in(&self) -> bool {
        self.file.starts_with(BUILT_IN)
    }

    /// Whether the number in a column of the row was not read in a document.
    pub(crate) fn is_unverified(&self, column: &str) -> bool {
        self.unverified_fields.iter().any(|listed| listed == column)
    }

    /// The caveat that is printed with a part whose main numbers were not read in a document of its vendor:
    /// `third party`, `from memory` or `representative`; `None` for other parts.
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

/// Beginning of the names of built-in files in messages.
pub(crate) const BUILT_IN: &str = "built-in ";

impl fmt::Display for Confidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(Self::WORDS[*self as usize])
    }
}

/// Source of a catalog row.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// Document or library from which the numbers come.
    pub source: String,
    /// Confidence of the main numbers.
    pub confidence: Confidence,
    /// Columns of this row whose numbers were not read in a document.
    pub unverified_fields: Vec<String>,
    /// Name of the file from which the row was read.
    pub file: String,
    /// Line in that file, counted from 1.
    pub line: usize,
}

/// All catalogs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Catalogs {
    /// Gears of every kind, including the gears inside actuators.
    pub gears: Vec<Gear>,
    /// Motors, including the motors inside actuators.
    pub motors: Vec<Motor>,
    /// Link materials.
    pub materials: Vec<Material>,
    /// Hollow profiles.
    pub profiles: Vec<Profile>,
    /// Points of efficiency curves of gears.
    pub efficiency: Vec<EfficiencyPoint>,
    /// Other names of gear series: from a name such as `CSF` to the series `HFUC`.
    pub series_aliases: BTreeMap<String, String>,
    /// Every row as it is written in its file, by file and line.
    pub printed: BTreeMap<(String, usize), PrintedRow>,
    /// One entry for each file that was read.
    pub loaded: Vec<Loaded>,
    /// Warnings about unusual numbers, or about ratings that decrease with size. A file with warnings is accepted.
    pub warnings: Vec<Fault>,
}

/// The cells of a row with their columns, as they are written in the file. Cells of absent columns are blank.
pub type PrintedRow = Vec<(&'static str, String)>;

impl Catalogs {
    /// The row from which a part was read, cell by cell; empty for parts that were not read from a file.
    pub fn printed_row(&self, provenance: &Provenance) -> &[(&'static str, String)] {
        self.printed.get(&(provenance.file.clone(), provenance.line)).map_or(&[], Vec::as_slice)
    }
}
