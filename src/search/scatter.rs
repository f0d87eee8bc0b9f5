//! Scatter: designs as they might be built, with parts that differ a little from their catalog ratings.
//!
//! Each rating has one factor. The factor of a gear's stiffness applies to its whole torsion curve (K1, K2 and K3; the
//! break points T1 and T2 stay). The factor of a material's modulus applies to E and to G. Masses of gears and motors have
//! factors of their own. A factor belongs to a row of a catalog, so it is the same in every joint and every design
//! that uses the row. The stiffness of an output bearing has a factor too: that of the gear's row where the bearing comes
//! with the chosen gear, and one of its own at each joint whose bearing is stated. What an effect adds to the tilt is
//! exact.
//!
//! The designs are not sized again: they keep their drives and sections whatever the true ratings are.

use crate::arm::joint_law::JointLaw;
use crate::arm::{Link, LinkBody};
use crate::pareto::objectives::Objectives;
use crate::sizing::drive::Drive;
use crate::space::design_space::{DesignSpace, DriveChoice, SpaceJoint, SpacePiece};
use crate::space::problem::{ArmProblem, Partial, objectives_over};
use crate::space::slot::Slot;
use crate::space::station::{Station, StationSlot};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A catalog rating that scatters, with the name of its row.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rating {
    /// The torsion curve of a gear.
    GearStiffness(String),
    /// E and G of a material.
    Modulus(String),
    /// The mass of a gear.
    GearMass(String),
    /// The mass of a motor.
    MotorMass(String),
    /// The tilting stiffness of the output bearing of a gear.
    BearingStiffness(String),
    /// The tilting stiffness of the bearing that is stated for a joint.
    StatedBearingStiffness(String),
}

/// Ratio of the true value to the catalog's, for each rating. A rating that is not listed is exact.
pub type Factors = BTreeMap<Rating, f64>;

/// Designs of a problem whose parts are to scatter.
pub struct ChosenParts<'p, 'c> {
    problem: &'p ArmProblem<'c>,
    /// Option of every slot, design by design.
    designs: Vec<Vec<u32>>,
    /// Options that the designs use, slot by slot. Only these are built.
    used: Vec<BTreeSet<u32>>,
    /// The joint whose stated bearing is the spring in a slot, slot by slot.
    tilting: Vec<Option<&'p SpaceJoint>>,
}

/// A joint as it might be built.
struct BuiltJoint {
    law: JointLaw,
    mass_kg: f64,
}

/// The parts of [`ChosenParts`] with one set of factors.
pub struct BuiltParts<'p, 'c> {
    chosen: &'p ChosenParts<'p, 'c>,
    /// The cases with links of other moduli; `None` if no modulus scatters.
    stations: Option<Vec<Station>>,
    joints: Vec<BTreeMap<u32, BuiltJoint>>,
}

impl<'p, 'c> ChosenParts<'p, 'c> {
    /// The parts of designs, each given by its options, one for each level. Returns `None` if a design cannot hold.
    pub fn new(problem: &'p ArmProblem<'c>, designs: &[Vec<u32>]) -> Option<Self> {
        let complete =
            designs.iter().map(|options| problem.walk(options, |_, _| {}).ok().map(|arm| arm.options));
        let designs = complete.collect::<Option<Vec<_>>>()?;
        let used = (0..problem.slots().len()).map(|s| designs.iter().map(|d| d[s]).collect()).collect();
        let layers = problem.space().layers();
        let tilting = layers.iter().map(|(_, layer)| layer.bearing_of()).collect();
        Some(Self { problem, designs, used, tilting })
    }

    /// Number of designs.
    pub fn len(&self) -> usize {
        self.designs.len()
    }

    /// Whether there is no design.
    pub fn is_empty(&self) -> bool {
        self.designs.is_empty()
    }

    /// All catalog ratings on which the designs depend.
    pub fn ratings(&self) -> BTreeSet<Rating> {
        let used = self.used.iter().enumerate().flat_map(|(slot, used)| used.iter().map(move |&o| (slot, o)));
        used.flat_map(|(slot, option)| {
            let drive = self.drive(slot, option);
            [
                self.gear(slot, option).map(Rating::GearStiffness),
                self.material(slot, option).map(Rating::Modulus),
                drive.map(|d| Rating::GearMass(d.gear.id.clone())),
                drive.map(|d| Rating::MotorMass(d.motor.id.clone())),
                self.bearing(slot, option).map(|bearing| bearing.0),
            ]
        })
        .flatten()
        .collect()
    }

    /// The parts with the true values of their ratings.
    pub fn built(&self, factors: &Factors) -> BuiltParts<'_, 'c> {
        let bends = factors.keys().any(|rating| matches!(rating, Rating::Modulus(_)));
        let stations = bends.then(|| {
            let space = with_moduli(self.problem.space(), factors);
            Station::all(&space)
        });
        let joint = |slot: usize, option: u32| Some((option, self.built_joint(slot, option, factors)?));
        let joints = self
            .used
            .iter()
            .enumerate()
            .map(|(slot, used)| used.iter().filter_map(|&option| joint(slot, option)).collect())
            .collect();
        BuiltParts { chosen: self, stations, joints }
    }

    fn built_joint(&self, slot: usize, option: u32, factors: &Factors) -> Option<BuiltJoint> {
        let factor = |rating: Rating| factors.get(&rating).copied().unwrap_or(1.0);
        let mut law = *self.problem.slots()[slot].law(option as usize)?;
        if let Some((rating, nominal_rad_per_nm)) = self.bearing(slot, option) {
            // as a deviation, so that a factor of 1 gives this compliance exactly
            law.connection_rad_per_nm += nominal_rad_per_nm * (1.0 / factor(rating) - 1.0);
        }
        let stiffness = self.gear(slot, option).map_or(1.0, |gear| factor(Rating::GearStiffness(gear)));
        let mass_kg = match &self.problem.slots()[slot] {
            Slot::Given { mass_kg, .. } => *mass_kg,
            Slot::Sized(sized) => {
                let (drive, mass_kg) =
                    (sized.table.drive(option as usize), sized.table.mass_kg(option as usize));
                // as deviations from the mass in the table, so that factors of 1 give this mass exactly
                let motor_kg = drive.motor.mass_kg.unwrap_or(0.0);
                let gear_kg = drive.mass_kg().map_or(0.0, |both_kg| both_kg - motor_kg);
                let gear_off = factor(Rating::GearMass(drive.gear.id.clone())) - 1.0;
                let motor_off = factor(Rating::MotorMass(drive.motor.id.clone())) - 1.0;
                mass_kg + gear_kg * gear_off + motor_kg * motor_off
            }
            _ => 0.0,
        };
        Some(BuiltJoint { law: JointLaw { curve: law.curve.stiffened(stiffness), ..law }, mass_kg })
    }

    /// Name of the catalog gear of a joint, whether chosen or given.
    fn gear(&self, slot: usize, option: u32) -> Option<String> {
        match (self.drive(slot, option), self.problem.piece_in_slot(slot)) {
            (Some(drive), _) => Some(drive.gear.id.clone()),
            (None, Some(SpacePiece::Joint(joint))) => match &joint.drive {
                DriveChoice::Given { gear, .. } => gear.clone(),
                _ => None,
            },
            _ => None,
        }
    }

    /// The rating of the bearing whose spring is in a slot, with its nominal compliance \[rad/(N m)\].
    fn bearing(&self, slot: usize, option: u32) -> Option<(Rating, f64)> {
        let (rating, bearing) = match &self.problem.slots()[slot] {
            Slot::Bearing { joint, .. } => {
                let drive = self.drive(*joint, option)?;
                let SpacePiece::Joint(asked) = self.problem.piece_in_slot(*joint)? else { return None };
                (Rating::BearingStiffness(drive.gear.id.clone()), asked.bearing_with(&drive))
            }
            Slot::Given { .. } => {
                let joint = self.tilting[slot]?;
                (Rating::StatedBearingStiffness(joint.name.clone()), joint.bearing.stated())
            }
            _ => return None,
        };
        let rad_per_nm = bearing?.tilt_rad_per_nm();
        (rad_per_nm > 0.0).then_some((rating, rad_per_nm))
    }

    /// The drive of a joint that is sized. The drive of a given joint has the mass that the study gives; it does not scatter.
    fn drive(&self, slot: usize, option: u32) -> Option<Drive<'c>> {
        match &self.problem.slots()[slot] {
            Slot::Sized(sized) => Some(sized.table.drive(option as usize)),
            _ => None,
        }
    }

    /// Name of the material of a link, whether chosen or given.
    fn material(&self, slot: usize, option: u32) -> Option<String> {
        match self.problem.piece_in_slot(slot)? {
            SpacePiece::Choice(choice) => Some(choice.options[option as usize].material_name.clone()),
            SpacePiece::Link(Link { body: LinkBody::Tube { material_name, .. }, .. }) => {
                Some(material_name.clone())
            }
            _ => None,
        }
    }
}

impl BuiltParts<'_, '_> {
    /// Objectives of a design. `design` is its place in the list from which the parts were taken.
    pub fn objectives(&self, design: usize) -> Objectives {
        let problem = self.chosen.problem;
        let stations = self.stations.as_deref().unwrap_or(problem.stations());
        let arm = self.arm(stations, &self.chosen.designs[design]);
        objectives_over(problem.space().judged_cases.iter().map(|&i| (&stations[i], &arm.stations[i])), &arm)
    }

    /// The arm of a design, with its states in the judged cases.
    fn arm(&self, stations: &[Station], options: &[u32]) -> Partial {
        let problem = self.chosen.problem;
        let mut arm = problem.empty();
        for (slot, (piece, &option)) in problem.slots().iter().zip(options).enumerate() {
            arm.options[slot] = option;
            let joint = self.joints[slot].get(&option);
            let mass_kg = match piece {
                Slot::Given { .. } | Slot::Sized(_) => joint.map_or(0.0, |j| j.mass_kg),
                Slot::Link { options, .. } => options[option as usize].mass_kg,
                Slot::Offset { mass_kg } => *mass_kg,
                Slot::Bearing { .. } | Slot::Motor { .. } => 0.0,
            };
            arm.mass_kg += mass_kg;
            for &case in &problem.space().judged_cases {
                let state = &mut arm.stations[case];
                match (&stations[case].slots[slot], joint) {
                    (StationSlot::Joint(place), Some(joint)) => {
                        arm.masses_kg[slot] = mass_kg;
                        state.add_joint(slot, place, &joint.law, mass_kg);
                    }
                    (StationSlot::Link { options, .. }, _) => state.add_link(&options[option as usize]),
                    (StationSlot::Body { inertia, weight }, _) => state.add_body(inertia, weight),
                    _ => {}
                }
            }
        }
        arm
    }
}

/// The space with the true moduli of its materials.
fn with_moduli(space: &DesignSpace, factors: &Factors) -> DesignSpace {
    let factor = |name: &str| factors.get(&Rating::Modulus(name.to_string())).copied().unwrap_or(1.0);
    let mut out = space.clone();
    for piece in &mut out.pieces {
        match piece {
            SpacePiece::Choice(choice) => {
                for option in Arc::make_mut(&mut choice.options) {
                    option.material = option.material.stiffened(factor(&option.material_name));
                }
            }
            SpacePiece::Link(Link { body: LinkBody::Tube { material_name, material, .. }, .. }) => {
                *material = material.stiffened(factor(material_name));
            }
            _ => {}
        }
    }
    out
}
