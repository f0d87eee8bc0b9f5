//! The drives that the catalogs offer for a joint. A drive is offered if the study allows it, if it turns fast
//! enough and if the catalog has all numbers that the checks need.

use super::bearing::{BearingRatings, with_gear};
use super::demand::Demand;
use super::drive_range::DriveRange;
use super::duty::Duty;
use super::question::{AllowedParts, AskedDrive, AskedJoint, Question};
use super::ratings::Ratings;
use crate::arm::bearing::{Bearing, BearingSource};
use crate::arm::extras::Extras;
use crate::arm::joint_law::{Curve, JointLaw, Windup};
use crate::catalog::Catalogs;
use crate::catalog::gear::Gear;
use crate::catalog::motor::Motor;
use std::collections::HashMap;

/// A drive of the catalogs for one joint: a gear and a motor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Offer {
    /// Index of the gear in the catalogs.
    pub gear: usize,
    /// Index of the motor in the catalogs.
    pub motor: usize,
    /// Mass of gear, motor and the joint's extra parts \[kg\].
    pub mass_kg: f64,
    /// Mass of gear and motor \[kg\].
    pub drive_kg: f64,
    pub extras: Extras,
    /// The gear's torsion curve.
    pub windup: Windup,
    /// The output bearing of the joint with this gear.
    pub bearing: Option<Bearing>,
    /// Torque-to-twist law of the joint with this gear, effects included.
    pub law: JointLaw,
    /// Tilt of the output bearing \[rad/(N m)\] per moment about an axis at right angles to the joint's axis, effects
    /// included.
    pub tilt_rad_per_nm: f64,
    pub ratings: Ratings,
}

/// The drive of a joint: given by the study, or to be found in the catalogs.
pub(super) enum JointOffers {
    Given { law: JointLaw, tilt_rad_per_nm: f64, mass_kg: f64 },
    Catalog(CatalogOffers),
}

/// The drives of the catalogs that a joint may have.
pub(super) struct CatalogOffers {
    pub duty: Duty,
    /// Whether the search may choose any drive that meets the demand. Otherwise the joint takes the lightest drive
    /// that meets it.
    pub is_choice: bool,
    /// The drives, lightest first. Drives of equal mass are ordered by the names of gear and motor.
    pub offers: Vec<Offer>,
    /// Index in `offers` of the drive with this gear and motor.
    places: HashMap<(usize, usize), u32>,
}

impl JointOffers {
    /// The drives that `joint` may have. `reach_m` is the largest distance of the tip from the joint's axis \[m\].
    pub(super) fn new(question: &Question, joint: &AskedJoint, reach_m: f64, catalogs: &Catalogs) -> Self {
        let springs = |curve, bearing| {
            let piece = question.joint_piece(joint, curve, bearing);
            (piece.law, piece.tilt_rad_per_nm)
        };
        let allowed = match &joint.drive {
            AskedDrive::Given { curve, mass_kg } => {
                let (law, tilt_rad_per_nm) = springs(*curve, joint.bearing.stated());
                let mass_kg = mass_kg + joint.extras.stated().total_kg();
                return Self::Given { law, tilt_rad_per_nm, mass_kg };
            }
            AskedDrive::FirstFit(allowed) | AskedDrive::AllFits(allowed) => allowed,
        };
        let duty = Duty::new(&question.motion, reach_m, joint);
        let offers = offers(joint, allowed, &duty, catalogs, springs);
        let places = (0..).zip(&offers).map(|(place, offer)| ((offer.gear, offer.motor), place)).collect();
        Self::Catalog(CatalogOffers { duty, is_choice: joint.drive.is_choice(), offers, places })
    }

    /// The drives that the catalogs offer; `None` if the study gives the drive.
    pub(super) fn of_catalog(&self) -> Option<&CatalogOffers> {
        match self {
            Self::Given { .. } => None,
            Self::Catalog(offers) => Some(offers),
        }
    }

    /// Whether the output bearing can tilt with at least one of the drives.
    pub(super) fn tilts(&self) -> bool {
        match self {
            Self::Given { tilt_rad_per_nm, .. } => *tilt_rad_per_nm > 0.0,
            Self::Catalog(offers) => offers.offers.iter().any(|offer| offer.tilt_rad_per_nm > 0.0),
        }
    }

    /// Whether the bearing has a limit with at least one of the drives.
    pub(super) fn checks_bearing(&self) -> bool {
        let limits = |offer: &Offer| offer.ratings.bearing != BearingRatings::UNLIMITED;
        self.of_catalog().is_some_and(|offers| offers.offers.iter().any(limits))
    }
}

impl Offer {
    /// The numbers of the drive as a range that has only this drive.
    pub(super) fn range(&self) -> DriveRange {
        DriveRange::of(&self.law, self.tilt_rad_per_nm, self.mass_kg)
    }

    /// Whether this drive and the drive `other`, which has equal mass, have the same stiffness in torsion and tilt, so
    /// that no objective tells them apart.
    fn yields_like(&self, other: &Self) -> bool {
        self.law == other.law && self.tilt_rad_per_nm == other.tilt_rad_per_nm
    }
}

fn offers(
    joint: &AskedJoint,
    allowed: &AllowedParts,
    duty: &Duty,
    catalogs: &Catalogs,
    springs: impl Fn(Curve, Option<Bearing>) -> (JointLaw, f64),
) -> Vec<Offer> {
    let mut offers = Vec::new();
    for (gear_place, gear) in catalogs.gears.iter().enumerate().filter(|(_, gear)| allowed.allows_gear(gear))
    {
        // A gear whose torsion is not known cannot be judged, so it is not offered.
        let Some(windup) = torsion_curve(gear, joint) else { continue };
        let mut bearing = with_gear(&joint.bearing, gear, allowed.gear_mass);
        if joint.bearing == BearingSource::OfGear
            && let Some(Bearing { tilt_stiffness_nm_per_rad: Some(stiffness), .. }) = &mut bearing
        {
            *stiffness *= 1.0 / (1.0 + joint.connection_share);
        }
        let (law, tilt_rad_per_nm) = springs(Curve::Windup(windup), bearing);
        let size = gear.envelope_as(allowed.gear_mass);
        let extras = |motor| joint.extras.with_parts(gear, motor, allowed.gear_mass);
        let motors = catalogs.motors.iter().enumerate();
        let motors = motors.filter(|(_, motor)| gear.goes_with(motor) && allowed.allows_motor(motor));
        offers.extend(motors.filter_map(|(motor_place, motor)| {
            Some(Offer {
                gear: gear_place,
                motor: motor_place,
                mass_kg: drive_kg(allowed, gear, motor)? + extras(motor).total_kg(),
                drive_kg: drive_kg(allowed, gear, motor)?,
                extras: extras(motor),
                windup,
                bearing,
                law,
                tilt_rad_per_nm,
                ratings: Ratings::of(gear, &size, motor, bearing.as_ref(), duty)?,
            })
        }));
    }
    let names = |offer: &Offer| (&catalogs.gears[offer.gear].id, &catalogs.motors[offer.motor].id);
    offers.sort_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg).then_with(|| names(a).cmp(&names(b))));
    offers
}

/// Mass of gear and motor \[kg\], rounded to the microgram. Sums that are equal on paper are then equal in floating
/// point, as ties require. `None` if a mass is unknown.
fn drive_kg(allowed: &AllowedParts, gear: &Gear, motor: &Motor) -> Option<f64> {
    const PER_KG: f64 = 1e9;
    Some(((gear.mass_kg(allowed.gear_mass)? + motor.mass_kg?) * PER_KG).round() / PER_KG)
}

/// The torsion curve of a gear whose connections add a share of its own compliance; `None` if the catalog lacks a
/// number of the curve.
fn torsion_curve(gear: &Gear, joint: &AskedJoint) -> Option<Windup> {
    let share = joint.connection_share;
    // A stage before the gear is in series with it. Seen from the joint, its compliance is smaller by the square of the
    // gear's ratio.
    let before = joint.stage.rad_per_nm / (gear.ratio * gear.ratio);
    let together = |stiffness: Option<f64>| {
        let own = stiffness? * (1.0 / (1.0 + share));
        Some(if before > 0.0 { 1.0 / (1.0 / own + before) } else { own })
    };
    // The curve is a straight line if the catalog has K1 alone, or three equal slopes with a blank break point. The
    // break points of a straight line have no effect, so any two values serve.
    let [k1, k2, k3] = [gear.k1_nm_per_rad, gear.k2_nm_per_rad, gear.k3_nm_per_rad];
    let breaks = gear.t1_nm.is_some() as usize + gear.t2_nm.is_some() as usize;
    let one_line = (k2.is_none() && k3.is_none() && breaks == 0) || (k1 == k2 && k2 == k3 && breaks < 2);
    if one_line {
        let k = together(k1)?;
        return Some(Windup { k1_nm_per_rad: k, k2_nm_per_rad: k, k3_nm_per_rad: k, t1_nm: 1.0, t2_nm: 2.0 });
    }
    let [k1_nm_per_rad, k2_nm_per_rad, k3_nm_per_rad] =
        [together(gear.k1_nm_per_rad)?, together(gear.k2_nm_per_rad)?, together(gear.k3_nm_per_rad)?];
    Some(Windup { k1_nm_per_rad, k2_nm_per_rad, k3_nm_per_rad, t1_nm: gear.t1_nm?, t2_nm: gear.t2_nm? })
}

impl CatalogOffers {
    /// Indices of the drives that can be the lightest to meet some demand. A drive is left out if a lighter drive
    /// has ratings at least as large in every quantity.
    pub(super) fn first_fits(&self) -> Vec<u32> {
        let mut kept: Vec<u32> = Vec::new();
        for (place, offer) in self.offers.iter().enumerate() {
            let covers = |&lighter: &u32| self.offers[lighter as usize].ratings.cover(&offer.ratings);
            if !kept.iter().any(covers) {
                kept.push(place as u32);
            }
        }
        kept
    }

    /// Indices of the drives, in sets of equal mass, torsion curve and bearing stiffness, which no objective tells
    /// apart.
    pub(super) fn ties(&self) -> Vec<Vec<u32>> {
        let mut sets: Vec<Vec<u32>> = Vec::new();
        let mut place = 0;
        for of_mass in self.offers.chunk_by(|a, b| a.mass_kg == b.mass_kg) {
            let first = sets.len();
            for offer in of_mass {
                let alike = |set: &&mut Vec<u32>| self.offers[set[0] as usize].yields_like(offer);
                match sets[first..].iter_mut().find(alike) {
                    Some(set) => set.push(place),
                    None => sets.push(vec![place]),
                }
                place += 1;
            }
        }
        sets
    }

    /// The lightest drive that meets `demand`; `None` if there is none.
    pub(super) fn first_fit(&self, demand: &Demand) -> Option<&Offer> {
        self.offers.iter().find(|offer| offer.ratings.hold(demand))
    }

    /// The first drive in the list with the same mass, torsion curve and bearing stiffness as the drive `offer`.
    pub(super) fn first_tie<'o>(&'o self, offer: &'o Offer) -> &'o Offer {
        let first = self.offers.partition_point(|other| other.mass_kg < offer.mass_kg);
        self.offers[first..].iter().find(|other| other.yields_like(offer)).unwrap_or(offer)
    }

    /// The drive with the gear and the motor of these indices in the catalogs; `None` if it is not offered.
    pub(super) fn of(&self, gear: usize, motor: usize) -> Option<&Offer> {
        self.places.get(&(gear, motor)).map(|&place| &self.offers[place as usize])
    }
}
