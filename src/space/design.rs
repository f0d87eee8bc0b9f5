//! One complete design: its number and name, its parts, its arm, and its objectives by the full model.

use super::bearing_loads::resolved;
use super::design_space::{Case, DesignSpace, DriveChoice, LinkOption, MotorPlace, SpaceJoint, SpacePiece};
pub(crate) use super::full_model::full_deflection_m;
pub use super::full_model::{full_objectives, objectives_with};
use super::levels::OutwardIn;
use super::prismatic::SpacePrismatic;
use super::problem::{ArmProblem, Partial};
use crate::arm::body::RigidBody;
use crate::arm::load::LoadCase;
use crate::arm::prismatic::{NamedPart, Prismatic};
use crate::arm::transmission::{Hung, HungOn};
use crate::arm::{Arm, Element, Joint};
use crate::pareto::objectives::Objectives;
use crate::sizing::drive::{Drive, to_the_microgram};
use nalgebra::Matrix3;

/// The part that a design has at one piece of the arm.
#[derive(Debug, Clone)]
pub enum Part<'a> {
    /// The part is a drive from the catalogs.
    Drive(Drive<'a>),
    /// The part is a link, with its material and cross-section.
    Link(&'a LinkOption),
    /// The study gives this piece, so no part is chosen for it.
    Given,
}

/// A design that was evaluated by the full model.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluated {
    /// Number of the design in its design space.
    pub number: u128,
    /// Objectives of the design by the full model.
    pub objectives: Objectives,
    /// Group (material) of the design; `None` if its links are of several materials.
    pub group: Option<usize>,
}

/// Number of the design with these options, one for each level, tip first. It is a mixed-radix number in which the
/// level nearest to the tip is the most significant digit.
pub fn number(level_sizes: &[u32], options: &[u32]) -> u128 {
    level_sizes.iter().zip(options).fold(0, |n, (&size, &option)| n * u128::from(size) + u128::from(option))
}

/// Options of the design with this number, one for each level, tip first; `None` if no design has this number.
pub fn options(level_sizes: &[u32], mut number: u128) -> Option<Vec<u32>> {
    let mut out = vec![0; level_sizes.len()];
    for (slot, &size) in out.iter_mut().zip(level_sizes).rev() {
        // a level without options has no designs
        *slot = number.checked_rem(u128::from(size))? as u32;
        number /= u128::from(size);
    }
    (number == 0).then_some(out)
}

/// First character of the name of a design. Spreadsheets read names such as `463e8` or `0012` as numbers, but no name
/// that begins with a letter.
pub const ID_PREFIX: char = 'x';

/// Name of a design in files: `x` and its number in base 36.
pub fn id_of(mut number: u128) -> String {
    let mut digits = Vec::new();
    while digits.is_empty() || number > 0 {
        digits.push(char::from_digit((number % 36) as u32, 36).unwrap_or('?'));
        number /= 36;
    }
    digits.push(ID_PREFIX);
    digits.iter().rev().collect()
}

/// Number of the design with this name; `None` if the name is not the name of a design. The name begins with `x`; names
/// in results of earlier versions lack the `x` and are read as well. An earlier name that happens to begin with `x`
/// must be read by [`number_of_earlier`] instead.
pub fn number_of(id: &str) -> Option<u128> {
    number_of_earlier(id.strip_prefix(ID_PREFIX).unwrap_or(id))
}

/// Number of the design with this name in a result of an earlier version, where a name is only a number in base 36.
/// `None` if it is not such a number.
pub fn number_of_earlier(id: &str) -> Option<u128> {
    if id.is_empty() {
        return None;
    }
    id.chars().try_fold(0u128, |n, c| n.checked_mul(36)?.checked_add(u128::from(c.to_digit(36)?)))
}

impl<'c> ArmProblem<'c> {
    /// The parts of the design with these options, base to tip; `None` if the design breaks a limit.
    pub fn parts(&self, options: &[u32]) -> Option<Vec<Part<'c>>> {
        Some(self.parts_of(&self.walk(options, |_, _| {}).ok()?))
    }

    /// The parts of a complete arm, one for each piece, base to tip.
    pub(crate) fn parts_of(&self, complete: &Partial) -> Vec<Part<'c>> {
        self.space()
            .pieces
            .iter()
            .enumerate()
            .zip(self.options(complete))
            .map(|((piece, what), option)| match what {
                SpacePiece::Choice(choice) => Part::Link(&choice.options[option as usize]),
                SpacePiece::Joint(_) | SpacePiece::Prismatic(_) => self
                    .sized_joint(piece)
                    .map_or(Part::Given, |s| Part::Drive(s.table.drive(option as usize))),
                SpacePiece::Link(_) => Part::Given,
            })
            .collect()
    }

    /// The design with these `options` as an arm in which every part is given in numbers. `None` if the design breaks a
    /// limit.
    pub fn arm(&self, options: &[u32]) -> Option<Arm> {
        self.arm_of(&self.walk(options, |_, _| {}).ok()?)
    }

    /// A complete design as an arm in which every part is given in numbers. `None` if the catalog leaves a mass blank.
    pub(crate) fn arm_of(&self, complete: &Partial) -> Option<Arm> {
        let space = self.space();
        let parts = self.parts_of(complete);
        let mut chain = space
            .pieces
            .iter()
            .zip(&parts)
            .map(|(piece, part)| match (piece, part) {
                (SpacePiece::Choice(choice), Part::Link(option)) => Some(Element::Link(choice.link(option))),
                (SpacePiece::Link(link), _) => Some(Element::Link(link.clone())),
                (SpacePiece::Prismatic(slide), Part::Drive(drive)) => {
                    rail_with(slide, drive).map(Element::Prismatic)
                }
                (SpacePiece::Prismatic(slide), _) => Some(Element::Prismatic(slide.joint.clone())),
                (SpacePiece::Joint(joint), Part::Drive(drive)) => {
                    joint_with(joint, drive).map(Element::Joint)
                }
                (SpacePiece::Joint(joint), _) => given_joint(joint).map(Element::Joint),
                _ => None,
            })
            .collect::<Option<Vec<_>>>()?;
        for (piece, part) in space.pieces.iter().zip(&parts) {
            if let (SpacePiece::Joint(joint), Part::Drive(drive)) = (piece, part) {
                stand_elsewhere(joint, drive, &mut chain);
            }
        }
        Some(Arm {
            name: space.name.clone(),
            gravity_m_s2: space.gravity_m_s2,
            down: space.down,
            chain: with_levers(chain),
            effects: space.effects.clone(),
            springs: space.springs.clone(),
        })
    }

    /// Mass of the parts at the joints of a design that are neither drive nor bearing \[kg\]. `None` if the design
    /// breaks a limit.
    pub fn extras_mass_kg(&self, options: &[u32]) -> Option<f64> {
        let joints = self.space().pieces.iter().zip(self.parts(options)?);
        let extras_kg = joints.map(|(piece, part)| match (piece, part) {
            (_, Part::Drive(drive)) => drive.extras().total_kg(),
            (SpacePiece::Joint(joint), _) => joint.extras.stated().total_kg(),
            _ => 0.0,
        });
        Some(to_the_microgram(extras_kg.sum()))
    }

    /// The judged cases of the study (which count for deflection and lowest mode), as load cases of the full model.
    pub fn load_cases(&self) -> Vec<LoadCase> {
        let space = self.space();
        space.judged_cases.iter().map(|&i| space.load_case(&space.cases[i])).collect()
    }
}

impl DesignSpace {
    /// A case of the study as a load case of the full model.
    pub(crate) fn load_case(&self, case: &Case) -> LoadCase {
        LoadCase {
            name: case.name.clone(),
            pose_deg: case.pose_deg.clone(),
            payload: case.payload,
            tip_force_n: case.tip_force_n,
            tip_moment_nm: case.tip_moment_nm,
            links: self.links,
            joints: self.joints,
            water: case.water,
        }
    }
}

/// Returns the chain with the lever of every output bearing as a number, computed from the link next to the bearing.
fn with_levers(mut chain: Vec<Element>) -> Vec<Element> {
    for index in 0..chain.len() {
        let (inboard, outboard) = chain.split_at_mut(index + 1);
        if let Element::Joint(joint) = &mut inboard[index] {
            joint.bearing = joint.bearing.map(|bearing| resolved(bearing, &joint.axis, outboard.first()));
        }
    }
    chain
}

/// If the motor of a joint does not stand at the joint, adds it as a point mass to the element on which it stands.
fn stand_elsewhere(joint: &SpaceJoint, drive: &Drive, chain: &mut [Element]) {
    let Some(MotorPlace { piece, moves, point_m }) = joint.motor_place else { return };
    let on = if moves { HungOn::Moving } else { HungOn::Start };
    let body = RigidBody { mass_kg: joint.away_kg(drive), cg_m: point_m, inertia_kgm2: Matrix3::zeros() };
    chain[piece].carrier().carry(&Hung { element: piece, on, body });
}

/// A prismatic joint with its screw or rack and its motor; `None` if the catalog leaves a mass blank.
fn rail_with(slide: &SpacePrismatic, drive: &Drive) -> Option<Prismatic> {
    let joint = slide.driven_by(drive.gear);
    let part = |name: &str, mass_kg| Some(NamedPart { name: name.to_string(), mass_kg });
    Some(Prismatic {
        fixed_mass_kg: joint.fixed_mass_kg + drive.mass_kg().ok()?,
        gear: part(&drive.gear.id, drive.gear.mass_kg(drive.gear_mass)?),
        motor: part(&drive.motor.id, drive.motor.mass_kg?),
        ..joint
    })
}

/// A joint with a drive of the catalogs, with its bearing and extras; `None` if the catalog leaves a mass blank.
pub(crate) fn joint_with(joint: &SpaceJoint, drive: &Drive) -> Option<Joint> {
    Some(Joint {
        name: joint.name.clone(),
        axis: joint.axis,
        curve: joint.curve_with(drive.gear),
        mass_kg: drive.mass_kg().ok()? - joint.away_kg(drive),
        bearing: joint.bearing_with(drive),
        extras: drive.extras(),
        bodies: joint.bodies.clone(),
        gear: Some(drive.gear.id.clone()),
        motor: Some(drive.motor.id.clone()),
        coupled: None,
        stages: joint.stages.rigid(),
        turns_with: joint.turns_with.clone(),
    })
}

/// A joint whose drive the study gives; `None` if the drive is sized.
fn given_joint(joint: &SpaceJoint) -> Option<Joint> {
    let DriveChoice::Given { curve, mass_kg, gear, motor } = &joint.drive else { return None };
    Some(Joint {
        name: joint.name.clone(),
        axis: joint.axis,
        curve: *curve,
        mass_kg: *mass_kg,
        bearing: joint.bearing.stated(),
        extras: joint.extras.stated(),
        bodies: joint.bodies.clone(),
        gear: gear.clone(),
        motor: motor.clone(),
        coupled: joint.coupled.clone(),
        stages: joint.stages.rigid(),
        turns_with: joint.turns_with.clone(),
    })
}

/// Evaluates the design with this number by the full model. Returns `None` if there is no such design or if it breaks
/// a limit.
///
/// [`DesignSpace`] has an example.
pub fn evaluate(problem: &ArmProblem, number: u128) -> Option<Evaluated> {
    let options = options(problem.level_sizes(), number)?;
    let complete = problem.walk(&options, |_, _| {}).ok()?;
    let arm = problem.arm(&options)?;
    let objectives = full_objectives(&arm, &problem.load_cases());
    Some(Evaluated { number, objectives, group: problem.group(&complete) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::bearing::BearingSource;
    use crate::arm::extras::ExtrasSource;
    use crate::arm::joint_law::Curve;

    #[test]
    fn a_given_gear_keeps_its_name_without_a_motor() {
        let gear = Some("HFUC-50-100".to_string());
        let drive =
            DriveChoice::Given { curve: Curve::Linear(4e5), mass_kg: 3.2, gear: gear.clone(), motor: None };
        let joint = SpaceJoint {
            name: "j".into(),
            axis: nalgebra::Vector3::z_axis(),
            bearing: BearingSource::Stated(None),
            extras: ExtrasSource::NONE,
            bodies: Default::default(),
            drive,
            max_speed_rad_s: None,
            range_deg: None,
            has_brake: false,
            duty: None,
            fit: Default::default(),
            connection_share: 0.0,
            coupled: None,
            stages: Default::default(),
            motor_place: None,
            turns_with: Vec::new(),
        };
        let given = given_joint(&joint).expect("given");
        assert_eq!((given.curve, given.mass_kg), (Curve::Linear(4e5), 3.2));
        assert_eq!((given.gear, given.motor), (gear, None));
    }

    #[test]
    fn numbers_and_names_are_one_to_one() {
        let sizes = [3, 7, 2];
        for n in 0..42 {
            let o = options(&sizes, n).expect("in range");
            assert_eq!(number(&sizes, &o), n);
            assert_eq!(number_of(&id_of(n)), Some(n));
        }
        assert_eq!(options(&sizes, 42), None);
        assert_eq!(number_of("not an id"), None);
    }
}
