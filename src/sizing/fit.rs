//! Checks of size: whether gear and motor fit into the space at their joint.
//!
//! | asked | size of the parts | limit |
//! |---|---|---|
//! | gear at the link that the joint carries | outer diameter of the gear | factor times width of the link |
//! | motor in the hollow of that link | outer diameter of the motor; the side of a square flange | the smaller clear width of the hollow; for a square in a round tube its diameter over √2 |
//! | motor in that hollow | length of the motor | length of the tubes from the joint to the next one |
//! | cables along the axis | bore of the gear, and of a motor behind it | at least the bore that the study states |
//! | space at the joint | length of the gear, plus the length of a motor behind it | the length that the study states |
//!
//! A size that the catalog leaves blank is not checked and excludes nothing. For component sets the catalog has no
//! sizes at all. The limits of the first two checks follow from the link, so they are part of the
//! [demand](super::demand::JointDemand) on the joint. The other checks exclude a drive whatever the arm. The places of
//! the parts do not depend on these sizes, because the geometry of a chain is stated.

use crate::catalog::envelope::Envelope;
use crate::catalog::motor::Motor;

/// Relative tolerance of the comparisons of size. A part exactly as wide as its space fits, whatever the rounding of
/// a factor times a width.
const ROUNDING: f64 = 1e-9;

/// Limits that a study sets to the sizes of a joint's parts. By default there are none; `None` means no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitRequirement {
    /// Largest ratio of the gear's outer diameter to the width of the link that the joint carries; `None` means no
    /// limit.
    pub gear_to_link_max: Option<f64>,
    /// Where the motor is mounted.
    pub motor: MotorPlace,
    /// Smallest diameter of the passage along the axis \[m\]; `None` means no limit.
    pub cable_bore_min_m: Option<f64>,
    /// Largest length of the drive along the axis \[m\]; `None` means no limit.
    pub drive_length_max_m: Option<f64>,
    /// Largest length of a motor in the hollow of the link \[m\]: the length of that link. It follows from the chain,
    /// so no key states it; `None` if the motor is elsewhere or the joint carries no tube.
    pub link_length_m: Option<f64>,
}

/// Where the motor of a joint is mounted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MotorPlace {
    /// On the axis, behind the gear: cables pass through the motor, and the length of the motor adds to the length of
    /// the gear.
    #[default]
    Behind,
    /// In the hollow of the link that the joint carries.
    InLink,
    /// Somewhere else; its size is not checked.
    Beside,
}

/// Largest widths of the parts of a joint, as given by the link that the joint carries. Infinite if the study sets
/// no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkRoom {
    /// Largest outer diameter that the gear may have \[m\]; infinite if there is no limit.
    pub gear_m: f64,
    /// Largest outer diameter that a round motor may have \[m\]; infinite if there is no limit.
    pub motor_m: f64,
    /// Largest side that the square flange of a motor may have \[m\]; infinite if there is no limit.
    pub square_m: f64,
}

/// Widths of gear and motor of a drive \[m\]. A width is zero if the study does not limit it, or if the
/// catalog leaves it blank.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DriveWidths {
    /// Outer diameter of the gear \[m\].
    pub gear_m: f64,
    /// Outer diameter of a round motor \[m\].
    pub motor_m: f64,
    /// Side of the square flange of a motor \[m\].
    pub square_m: f64,
}

impl Default for LinkRoom {
    fn default() -> Self {
        Self::ANY
    }
}

impl LinkRoom {
    /// No limit on any size.
    pub const ANY: Self = Self { gear_m: f64::INFINITY, motor_m: f64::INFINITY, square_m: f64::INFINITY };

    /// The larger of the widths of this room and of `other`, one by one.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            gear_m: self.gear_m.max(other.gear_m),
            motor_m: self.motor_m.max(other.motor_m),
            square_m: self.square_m.max(other.square_m),
        }
    }

    /// The smaller of the widths of this room and of `other`, one by one.
    pub(crate) fn min(self, other: Self) -> Self {
        Self {
            gear_m: self.gear_m.min(other.gear_m),
            motor_m: self.motor_m.min(other.motor_m),
            square_m: self.square_m.min(other.square_m),
        }
    }
}

impl DriveWidths {
    /// The widths of a gear and a motor. A width that the requirement `fit` does not limit is zero.
    pub(super) fn of(gear: &Envelope, motor: &Motor, fit: &FitRequirement) -> Self {
        let counts = |asked: bool, width_m: Option<f64>| width_m.filter(|_| asked).unwrap_or(0.0);
        let (in_link, is_square) = (fit.motor == MotorPlace::InLink, motor.kind.has_square_flange());
        Self {
            gear_m: counts(fit.gear_to_link_max.is_some(), gear.outer_diameter_m),
            motor_m: counts(in_link && !is_square, motor.envelope.outer_diameter_m),
            square_m: counts(in_link && is_square, motor.envelope.outer_diameter_m),
        }
    }

    /// Whether gear and motor fit into `room`: none of their widths exceeds the largest width that the link allows.
    #[inline]
    pub fn fit(&self, room: &LinkRoom) -> bool {
        (self.gear_m <= room.gear_m) & (self.motor_m <= room.motor_m) & (self.square_m <= room.square_m)
    }

    /// The smaller of the widths of this drive and of `other`, one by one.
    pub(super) fn min(&self, other: &Self) -> Self {
        Self {
            gear_m: self.gear_m.min(other.gear_m),
            motor_m: self.motor_m.min(other.motor_m),
            square_m: self.square_m.min(other.square_m),
        }
    }

    /// The larger of the widths of this drive and of `other`, one by one.
    pub(super) fn max(&self, other: &Self) -> Self {
        Self {
            gear_m: self.gear_m.max(other.gear_m),
            motor_m: self.motor_m.max(other.motor_m),
            square_m: self.square_m.max(other.square_m),
        }
    }

    /// Whether neither part of this drive is wider than the same part of `other`, so that this drive fits wherever
    /// `other` fits.
    #[inline]
    pub(super) fn cover(&self, other: &Self) -> bool {
        (self.gear_m <= other.gear_m) & (self.motor_m <= other.motor_m) & (self.square_m <= other.square_m)
    }
}

impl FitRequirement {
    /// Whether the study limits any size.
    pub fn is_asked(&self) -> bool {
        self.asks_of_link() || self.cable_bore_min_m.is_some() || self.drive_length_max_m.is_some()
    }

    /// Whether a limit depends on the link that the joint carries.
    pub fn asks_of_link(&self) -> bool {
        self.gear_to_link_max.is_some() || self.motor == MotorPlace::InLink
    }

    /// The largest widths of gear and motor, if the link that the joint carries has the width `width_m` across the
    /// joint's axis \[m\]. `hollow_m` has two clear widths of the link's hollow \[m\]: for a round motor, and for the
    /// side of a square flange.
    pub(crate) fn room(&self, width_m: f64, hollow_m: [f64; 2]) -> LinkRoom {
        let any = f64::INFINITY;
        let in_link = self.motor == MotorPlace::InLink;
        let [motor_m, square_m] =
            hollow_m.map(|clear_m| if in_link { clear_m * (1.0 + ROUNDING) } else { any });
        LinkRoom {
            gear_m: self.gear_to_link_max.map_or(any, |factor| factor * width_m * (1.0 + ROUNDING)),
            motor_m,
            square_m,
        }
    }

    /// Whether the bores and the length of a gear and a motor are within those limits that do not depend on the link. A
    /// size that is unknown is not checked.
    pub(crate) fn allows(&self, gear: &Envelope, motor: &Envelope) -> bool {
        let bore_holds = |bore_m: Option<f64>| match (self.least_bore_m(), bore_m) {
            (Some(least_m), Some(bore_m)) => least_m <= bore_m,
            _ => true,
        };
        let length_holds = match (self.most_length_m(), self.length_m(gear, motor)) {
            (Some(most_m), Some(length_m)) => length_m <= most_m,
            _ => true,
        };
        let link_holds = match (self.most_motor_length_m(), motor.length_m) {
            (Some(most_m), Some(length_m)) => length_m <= most_m,
            _ => true,
        };
        length_holds
            && link_holds
            && bore_holds(gear.hollow_bore_m)
            && (self.motor != MotorPlace::Behind || bore_holds(motor.hollow_bore_m))
    }

    /// Smallest bore that passes \[m\], reduced by the tolerance for rounding; `None` if bores are not limited.
    pub(super) fn least_bore_m(&self) -> Option<f64> {
        self.cable_bore_min_m.map(|least_m| least_m * (1.0 - ROUNDING))
    }

    /// Largest length that passes \[m\], increased by the tolerance for rounding; `None` if the length is not limited.
    pub(super) fn most_length_m(&self) -> Option<f64> {
        self.drive_length_max_m.map(|most_m| most_m * (1.0 + ROUNDING))
    }

    /// Largest length of a motor in the link that passes \[m\], increased by the tolerance for rounding; `None` if it
    /// is not limited.
    pub(super) fn most_motor_length_m(&self) -> Option<f64> {
        self.link_length_m
            .filter(|_| self.motor == MotorPlace::InLink)
            .map(|most_m| most_m * (1.0 + ROUNDING))
    }

    /// Length of a drive along the axis \[m\]; `None` if one of its parts has no length in the catalog.
    pub(super) fn length_m(&self, gear: &Envelope, motor: &Envelope) -> Option<f64> {
        match self.motor {
            MotorPlace::Behind => Some(gear.length_m? + motor.length_m?),
            MotorPlace::InLink | MotorPlace::Beside => gear.length_m,
        }
    }
}
