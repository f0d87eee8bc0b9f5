//! What the catalogs offer a joint: every drive that may be used, turns fast enough and has all numbers that are needed.

use super::demand::Demand;
use super::duty::Duty;
use super::question::{AllowedParts, AskedDrive, AskedJoint, Question};
use super::ratings::Ratings;
use crate::arm::joint_law::{Curve, JointLaw, Windup};
use crate::catalog::Catalogs;
use crate::catalog::gear::Gear;
use crate::catalog::motor::Motor;
use std::collections::HashMap;

/// A gear and a motor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Offer {
    /// Place of the gear in the catalogs.
    pub gear: usize,
    /// Place of the motor in the catalogs.
    pub motor: usize,
    pub mass_kg: f64,
    /// The gear's torsion curve.
    pub windup: Windup,
    /// How the joint twists with it, effects included.
    pub law: JointLaw,
    pub ratings: Ratings,
}

/// The drive of a joint: given, or offers of the catalogs.
pub(super) enum JointOffers {
    Given { law: JointLaw, mass_kg: f64 },
    Catalog(CatalogOffers),
}

/// The drives of the catalogs that a joint may have.
pub(super) struct CatalogOffers {
    pub duty: Duty,
    /// Whether any that holds may be chosen; else the lightest that holds is.
    pub is_choice: bool,
    /// Lightest first, equal masses by the names of gear and motor.
    pub offers: Vec<Offer>,
    /// Where the drive of a gear and a motor stands.
    places: HashMap<(usize, usize), u32>,
}

impl JointOffers {
    /// The drives of a joint whose axis the tip is at most `reach_m` away from.
    pub(super) fn new(question: &Question, joint: &AskedJoint, reach_m: f64, catalogs: &Catalogs) -> Self {
        let law = |curve| question.joint_piece(joint, curve).law;
        let allowed = match &joint.drive {
            AskedDrive::Given { curve, mass_kg } => {
                return Self::Given { law: law(*curve), mass_kg: *mass_kg };
            }
            AskedDrive::FirstFit(allowed) | AskedDrive::AllFits(allowed) => allowed,
        };
        let duty = Duty::new(&question.motion, reach_m, joint);
        let offers = offers(allowed, &duty, catalogs, law);
        let places = (0..).zip(&offers).map(|(place, offer)| ((offer.gear, offer.motor), place)).collect();
        Self::Catalog(CatalogOffers { duty, is_choice: joint.drive.is_choice(), offers, places })
    }

    /// The drives of the catalogs, if they give the drive.
    pub(super) fn of_catalog(&self) -> Option<&CatalogOffers> {
        match self {
            Self::Given { .. } => None,
            Self::Catalog(offers) => Some(offers),
        }
    }
}

fn offers(
    allowed: &AllowedParts,
    duty: &Duty,
    catalogs: &Catalogs,
    law: impl Fn(Curve) -> JointLaw,
) -> Vec<Offer> {
    let mut offers = Vec::new();
    for (gear_place, gear) in catalogs.gears.iter().enumerate().filter(|(_, gear)| allowed.allows_gear(gear))
    {
        // a gear whose torsion is not known cannot be judged
        let Some(windup) = torsion_curve(gear) else { continue };
        let law = law(Curve::Windup(windup));
        let motors = catalogs.motors.iter().enumerate().filter(|(_, motor)| allowed.allows_motor(motor));
        offers.extend(motors.filter_map(|(motor_place, motor)| {
            Some(Offer {
                gear: gear_place,
                motor: motor_place,
                mass_kg: mass_kg(allowed, gear, motor)?,
                windup,
                law,
                ratings: Ratings::of(gear, motor, duty)?,
            })
        }));
    }
    let names = |offer: &Offer| (&catalogs.gears[offer.gear].id, &catalogs.motors[offer.motor].id);
    offers.sort_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg).then_with(|| names(a).cmp(&names(b))));
    offers
}

/// Mass of gear and motor, to the microgram: sums that are equal on paper are then equal here, which ties are made of.
fn mass_kg(allowed: &AllowedParts, gear: &Gear, motor: &Motor) -> Option<f64> {
    const PER_KG: f64 = 1e9;
    Some(((gear.mass_kg(allowed.gear_mass)? + motor.mass_kg?) * PER_KG).round() / PER_KG)
}

/// The torsion curve of a gear, if the catalog has all of it.
fn torsion_curve(gear: &Gear) -> Option<Windup> {
    let [k1_nm_per_rad, k2_nm_per_rad, k3_nm_per_rad] =
        [gear.k1_nm_per_rad?, gear.k2_nm_per_rad?, gear.k3_nm_per_rad?];
    Some(Windup { k1_nm_per_rad, k2_nm_per_rad, k3_nm_per_rad, t1_nm: gear.t1_nm?, t2_nm: gear.t2_nm? })
}

impl CatalogOffers {
    /// Places of the drives that can be the lightest that holds: those that no lighter one covers in every rating.
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

    /// Places of the drives in sets of equal mass and torsion, which no objective tells apart.
    pub(super) fn ties(&self) -> Vec<Vec<u32>> {
        let mut sets: Vec<Vec<u32>> = Vec::new();
        let mut place = 0;
        for of_mass in self.offers.chunk_by(|a, b| a.mass_kg == b.mass_kg) {
            let first = sets.len();
            for offer in of_mass {
                let has_law = |set: &&mut Vec<u32>| self.offers[set[0] as usize].law == offer.law;
                match sets[first..].iter_mut().find(has_law) {
                    Some(set) => set.push(place),
                    None => sets.push(vec![place]),
                }
                place += 1;
            }
        }
        sets
    }

    /// The lightest drive that holds a demand.
    pub(super) fn first_fit(&self, demand: &Demand) -> Option<&Offer> {
        self.offers.iter().find(|offer| offer.ratings.hold(demand))
    }

    /// The first of the drives of a drive's mass and torsion.
    pub(super) fn first_tie<'o>(&'o self, offer: &'o Offer) -> &'o Offer {
        let first = self.offers.partition_point(|other| other.mass_kg < offer.mass_kg);
        self.offers[first..].iter().find(|other| other.law == offer.law).unwrap_or(offer)
    }

    /// The drive of some gear and motor.
    pub(super) fn of(&self, gear: usize, motor: usize) -> Option<&Offer> {
        self.places.get(&(gear, motor)).map(|&place| &self.offers[place as usize])
    }
}
