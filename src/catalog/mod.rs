//! What can be bought: materials, profiles, gears, motors.
//!
//! One CSV file a kind. A blank cell is unknown, never zero. Every row names its source and how far it
//! can be trusted.

mod gear;
mod material;
mod motor;
mod profile;

pub use gear::{Gear, GearMass};
pub use material::{Material, MaterialClass};
pub use motor::{Motor, MotorKind};
pub use profile::{Profile, ProfileShape};

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
    /// Harmonic-drive gears.
    pub gears: Vec<Gear>,
    /// Motors.
    pub motors: Vec<Motor>,
    /// Link materials.
    pub materials: Vec<Material>,
    /// Hollow profiles.
    pub profiles: Vec<Profile>,
}
