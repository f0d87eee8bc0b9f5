//! Whether the parts of a joint fit where they go.
//!
//! | asked | compared |
//! |---|---|
//! | gear beside the link that the joint carries | outer diameter of the gear; a factor times the width of the link across the joint's axis |
//! | motor in the hollow of that link | outer diameter of the motor; the smaller clear width of the hollow |
//! | cables along the axis | bore of the gear, and of a motor behind it; the smallest bore asked for |
//! | room at the joint | length of the gear, with that of a motor behind it; the largest length asked for |
//!
//! A size that the catalog leaves blank is not checked and excludes nothing; of component sets it has no sizes at all. The first two follow from the link, so they are part
//! of the [demand](super::demand::JointDemand) on the joint; the others exclude a drive whatever the arm. Where a part is does
//! not depend on these sizes: the geometry of a chain is stated.

use crate::catalog::envelope::Envelope;

/// A part that is just as wide as its room fits; rounding of a factor times a width must not decide.
const ROUNDING: f64 = 1e-9;

/// What a study asks of the sizes of a joint's parts; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitRequirement {
    /// Largest ratio of the gear's outer diameter to the width of the link that the joint carries.
    pub gear_to_link_max: Option<f64>,
    /// Where the motor is.
    pub motor: MotorPlace,
    /// Smallest diameter of the passage along the axis \[m\].
    pub cable_bore_min_m: Option<f64>,
    /// Largest length of the drive along the axis \[m\].
    pub drive_length_max_m: Option<f64>,
}

/// Where the motor of a joint is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MotorPlace {
    /// On the axis, behind the gear: cables pass through it, and its length adds to that of the gear.
    #[default]
    Behind,
    /// In the hollow of the link that the joint carries.
    InLink,
    /// Somewhere else, where there is room.
    Beside,
}

/// The room that the link leaves to the parts of the joint that carries it; infinite where nothing is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkRoom {
    /// Largest outer diameter of the gear \[m\].
    pub gear_m: f64,
    /// Largest outer diameter of the motor \[m\].
    pub motor_m: f64,
}

/// How wide a drive is where its study asks; zero where nothing is asked or the catalog is blank.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DriveWidths {
    /// Outer diameter of the gear \[m\].
    pub gear_m: f64,
    /// Outer diameter of the motor \[m\].
    pub motor_m: f64,
}

impl Default for LinkRoom {
    fn default() -> Self {
        Self::ANY
    }
}

impl LinkRoom {
    /// Room for everything.
    pub const ANY: Self = Self { gear_m: f64::INFINITY, motor_m: f64::INFINITY };

    /// Each number the larger of two.
    pub(crate) fn max(self, other: Self) -> Self {
        Self { gear_m: self.gear_m.max(other.gear_m), motor_m: self.motor_m.max(other.motor_m) }
    }

    /// Each number the smaller of two.
    pub(crate) fn min(self, other: Self) -> Self {
        Self { gear_m: self.gear_m.min(other.gear_m), motor_m: self.motor_m.min(other.motor_m) }
    }
}

impl DriveWidths {
    /// The widths of a gear and a motor that count under a requirement.
    pub(super) fn of(gear: &Envelope, motor: &Envelope, fit: &FitRequirement) -> Self {
        let counts = |asked: bool, width_m: Option<f64>| width_m.filter(|_| asked).unwrap_or(0.0);
        Self {
            gear_m: counts(fit.gear_to_link_max.is_some(), gear.outer_diameter_m),
            motor_m: counts(fit.motor == MotorPlace::InLink, motor.outer_diameter_m),
        }
    }

    /// Whether the parts fit into a room.
    #[inline]
    pub fn fit(&self, room: &LinkRoom) -> bool {
        (self.gear_m <= room.gear_m) & (self.motor_m <= room.motor_m)
    }

    /// The smaller of each width.
    pub(super) fn min(&self, other: &Self) -> Self {
        Self { gear_m: self.gear_m.min(other.gear_m), motor_m: self.motor_m.min(other.motor_m) }
    }

    /// The larger of each width.
    pub(super) fn max(&self, other: &Self) -> Self {
        Self { gear_m: self.gear_m.max(other.gear_m), motor_m: self.motor_m.max(other.motor_m) }
    }

    /// Whether these parts fit wherever the others fit.
    #[inline]
    pub(super) fn cover(&self, other: &Self) -> bool {
        (self.gear_m <= other.gear_m) & (self.motor_m <= other.motor_m)
    }
}

impl FitRequirement {
    /// Whether anything is asked.
    pub fn is_asked(&self) -> bool {
        self.asks_of_link() || self.cable_bore_min_m.is_some() || self.drive_length_max_m.is_some()
    }

    /// Whether the link decides what fits.
    pub fn asks_of_link(&self) -> bool {
        self.gear_to_link_max.is_some() || self.motor == MotorPlace::InLink
    }

    /// The room that a link of a width across the joint's axis and with a hollow leaves \[m\].
    pub(crate) fn room(&self, width_m: f64, hollow_m: f64) -> LinkRoom {
        let any = f64::INFINITY;
        let in_link = self.motor == MotorPlace::InLink;
        LinkRoom {
            gear_m: self.gear_to_link_max.map_or(any, |factor| factor * width_m * (1.0 + ROUNDING)),
            motor_m: if in_link { hollow_m * (1.0 + ROUNDING) } else { any },
        }
    }

    /// Whether a gear and a motor fit whatever the link: their bores and their length, as far as they are known.
    pub(super) fn allows(&self, gear: &Envelope, motor: &Envelope) -> bool {
        let bore_holds = |bore_m: Option<f64>| match (self.least_bore_m(), bore_m) {
            (Some(least_m), Some(bore_m)) => least_m <= bore_m,
            _ => true,
        };
        let length_holds = match (self.most_length_m(), self.length_m(gear, motor)) {
            (Some(most_m), Some(length_m)) => length_m <= most_m,
            _ => true,
        };
        length_holds
            && bore_holds(gear.hollow_bore_m)
            && (self.motor != MotorPlace::Behind || bore_holds(motor.hollow_bore_m))
    }

    /// Smallest bore, but for rounding \[m\].
    pub(super) fn least_bore_m(&self) -> Option<f64> {
        self.cable_bore_min_m.map(|least_m| least_m * (1.0 - ROUNDING))
    }

    /// Largest length, but for rounding \[m\].
    pub(super) fn most_length_m(&self) -> Option<f64> {
        self.drive_length_max_m.map(|most_m| most_m * (1.0 + ROUNDING))
    }

    /// Length of a drive along the axis \[m\]; `None` if one of its parts has no length in the catalog.
    pub(super) fn length_m(&self, gear: &Envelope, motor: &Envelope) -> Option<f64> {
        match self.motor {
            MotorPlace::Behind => Some(gear.length_m? + motor.length_m?),
            MotorPlace::InLink | MotorPlace::Beside => gear.length_m,
        }
    }
}
