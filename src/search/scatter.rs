//! Scatter: designs as they might be built, with parts whose properties differ a little from their catalog ratings.
//!
//! Each rating has one random factor. The factor of a gear's stiffness applies to its whole torsion curve: it scales
//! K1, K2 and K3, while the break points T1 and T2 stay. The factor of a material's modulus applies to E and to G.
//! Masses of gears and motors have factors of their own. A factor belongs to a row of a catalog, so it is the same in
//! every joint and every design that uses the row. The stiffness of an output bearing has a factor too. It belongs to
//! the row of the gear if the bearing comes with the chosen gear; a bearing that is stated at a joint has a factor for
//! this joint. The compliance that an effect adds to the tilt has no factor.
//!
//! The designs are not sized again: they keep their drives and sections, whatever the sampled ratings are.

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

/// A catalog rating that has a random factor, with the name of the row (or joint) that it belongs to.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rating {
    /// The torsion curve of the gear with this name.
    GearStiffness(String),
    /// E and G of the material with this name.
    Modulus(String),
    /// The mass of the gear with this name.
    GearMass(String),
    /// The mass of the motor with this name.
    MotorMass(String),
    /// The tilting stiffness of the output bearing that comes with the gear of this name.
    BearingStiffness(String),
    /// The tilting stiffness of the bearing that is stated for the joint of this name.
    StatedBearingStiffness(String),
}

/// Ratio of the sampled value to the catalog's value, for each rating. A rating that is not listed has the catalog's
/// value.
pub type Factors = BTreeMap<Rating, f64>;

/// The designs of a problem whose parts are to be varied.
pub struct ChosenParts<'p, 'c> {
    problem: &'p ArmProblem<'c>,
    /// For each design, the option of every slot (piece of the arm), tip first.
    designs: Vec<Vec<u32>>,
    /// For each slot, the options that the designs use. Only these parts are built.
    used: Vec<BTreeSet<u32>>,
    /// For each slot, the joint whose stated bearing is the spring in this slot; `None` for other slots.
    tilting: Vec<Option<&'p SpaceJoint>>,
}

/// A joint with one option, built with the sampled values of its ratings.
struct BuiltJoint {
    /// Angle of the joint as a function of its torque.
    law: JointLaw,
    /// Mass of the drive \[kg\].
    mass_kg: f64,
}

/// The parts of [`ChosenParts`] with one set of sampled values.
pub struct BuiltParts<'p, 'c> {
    chosen: &'p ChosenParts<'p, 'c>,
    /// The stations of the cases with the sampled moduli; `None` if no modulus is sampled.
    stations: Option<Vec<Station>>,
    /// For each slot, the joint with each option that some design uses; empty for links.
    joints: Vec<BTreeMap<u32, BuiltJoint>>,
}

impl<'p, 'c> ChosenParts<'p, 'c> {
    /// Prepares the parts of some designs, so that their ratings can be varied. Each design is given by its options,
    /// one for each level, tip first. `None` if a design breaks a limit.
    pub fn new(problem: &'p ArmProblem<'c>, designs: &[Vec<u32>]) -> Option<Self> {
        let complete =
            designs.iter().map(|options| problem.walk(options, |_, _| {}).ok().map(|arm| arm.options));
        let designs = complete.collect::<Option<Vec<_>>>()?;
        let used = (0..problem.slots().len()).map(|s| designs.iter().map(|d| d[s]).collect()).collect();
        let layers = problem.space().layers();
        let tilting = layers.iter().map(|(_, layer)| layer.bearing_of()).collect();
        Some(Self { problem, designs, used, tilting })
    }

    /// Number of designs whose parts are varied.
    pub fn len(&self) -> usize {
        self.designs.len()
    }

    /// Whether the list of designs whose parts are varied is empty.
    pub fn is_empty(&self) -> bool {
        self.designs.is_empty()
    }

    /// All catalog ratings on which the designs depend, so that factors can be drawn for them.
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

    /// The parts with sampled values of their ratings: the value of the catalog times the rating's factor in `factors`.
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
            // The factor is applied as a difference, so that a factor of 1 gives exactly the nominal compliance.
            law.connection_rad_per_nm += nominal_rad_per_nm * (1.0 / factor(rating) - 1.0);
        }
        let stiffness = self.gear(slot, option).map_or(1.0, |gear| factor(Rating::GearStiffness(gear)));
        let mass_kg = match &self.problem.slots()[slot] {
            Slot::Given { mass_kg, .. } => *mass_kg,
            Slot::Sized(sized) => {
                let (drive, mass_kg) =
                    (sized.table.drive(option as usize), sized.table.mass_kg(option as usize));
                // The factors are applied as differences from the mass in the table, so that factors of 1 give exactly
                // this mass.
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

    /// Name of the catalog gear that the joint in `slot` has with `option`, whether the gear is chosen or given. `None`
    /// if the drive is given in numbers.
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

    /// If `slot` is a spring of an output bearing: the rating of this bearing, and its compliance by the catalog or the
    /// study \[rad/(N m)\]. Otherwise `None`.
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

    /// The drive `option` of the joint in `slot`, if the joint is sized; `None` for other slots. A given drive has the
    /// mass that the study states, and this mass does not scatter.
    fn drive(&self, slot: usize, option: u32) -> Option<Drive<'c>> {
        match &self.problem.slots()[slot] {
            Slot::Sized(sized) => Some(sized.table.drive(option as usize)),
            _ => None,
        }
    }

    /// Name of the material of a link, whether the link is chosen or given; `None` for a rigid offset.
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
    /// Objectives of one design with the sampled values of its ratings. `design` is the index of the design in the list
    /// from which the parts were prepared.
    pub fn objectives(&self, design: usize) -> Objectives {
        let problem = self.chosen.problem;
        let stations = self.stations.as_deref().unwrap_or(problem.stations());
        let arm = self.arm(stations, &self.chosen.designs[design]);
        objectives_over(problem.space().judged_cases.iter().map(|&i| (&stations[i], &arm.stations[i])), &arm)
    }

    /// The complete arm of the design with these `options`, with the sampled values. `stations` are the compiled cases.
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

/// A copy of the space in which the modulus of each material is multiplied by its factor in `factors`.
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
