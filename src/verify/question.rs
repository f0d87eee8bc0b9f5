//! The search question of a study, as plain data.
//!
//! The verifier must not take the question from the code that it checks, for example from the search's tables of
//! drives or its list of pieces. So the caller copies the study into these types, field by field. Everything that
//! follows from them (which drives pass, what a tube weighs, where a joint is) is computed in this folder.

use crate::arm::bearing::{Bearing, BearingSource};
use crate::arm::body::{JointBodies, RigidBody};
use crate::arm::effect::Effect;
use crate::arm::extras::{Extras, ExtrasSource};
use crate::arm::joint_law::Curve;
use crate::arm::load::LoadCase;
use crate::arm::prismatic::Prismatic;
use crate::arm::section::{LinkMaterial, Section};
use crate::arm::structure::{JointPiece, LinkPiece, Piece, Structure};
use crate::arm::{Arm, Element, Joint, JointModel, Link, LinkBody, LinkModel};
use crate::catalog::gear::{Gear, GearKind, GearMass};
use crate::catalog::motor::{Motor, MotorKind};
use nalgebra::{Unit, Vector3};

/// An arm with open choices, the motion and limits that it must meet, and the cases by which it is judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Magnitude of gravity \[m/s²\].
    pub gravity_m_s2: f64,
    /// Direction of gravity in the world, a unit vector.
    pub down: Vector3<f64>,
    /// Joints and links from base to tip.
    pub pieces: Vec<AskedPiece>,
    /// All poses and loads, each with the models of links and joints.
    pub cases: Vec<LoadCase>,
    /// Indices of the judged cases, over which tip deflection and lowest mode are taken.
    pub judged_cases: Vec<usize>,
    /// Indices of the sizing cases, in which drives are checked and stresses include acceleration.
    pub sizing_cases: Vec<usize>,
    /// The motion that the tip must be able to make.
    pub motion: AskedMotion,
    /// Which deformations of the links are modelled.
    pub links: LinkModel,
    /// Which torsion curve of the gears is used: the slope K2 alone or three segments.
    pub joints: JointModel,
    /// Limits that every design must meet.
    pub limits: Limits,
    /// Effects of the product beyond the nominal model. Effects of a test do not belong here.
    pub effects: Vec<Effect>,
}

/// A prismatic joint (rail) whose numbers the study gives.
#[derive(Debug, Clone, PartialEq)]
pub struct AskedRail {
    /// Stiffness, guide, masses and axis of the joint.
    pub joint: Prismatic,
    /// Largest speed \[m/s\]; `None` if it is the speed of the tip.
    pub max_speed_m_s: Option<f64>,
}

/// One piece of the chain.
#[derive(Debug, Clone, PartialEq)]
pub enum AskedPiece {
    /// A joint that turns.
    Joint(AskedJoint),
    /// A prismatic joint (rail). The study gives all of its numbers.
    Prismatic(AskedRail),
    /// A link or offset that the study gives.
    Link(Link),
    /// A link whose tube the search chooses.
    Choice(AskedLink),
}

/// A joint, with the rule by which its drive is found.
#[derive(Debug, Clone, PartialEq)]
pub struct AskedJoint {
    /// Name of the joint.
    pub name: String,
    /// Axis of the joint in the carried frame, which turns with the joints inboard.
    pub axis: Unit<Vector3<f64>>,
    /// Where the output bearing of the joint comes from.
    pub bearing: BearingSource,
    /// Where the masses in addition to gear, motor and bearing come from.
    pub extras: ExtrasSource,
    /// Rigid bodies at the joint, in addition to drive, bearing and extra parts.
    pub bodies: JointBodies,
    /// How the drive of the joint is found.
    pub drive: AskedDrive,
    /// Largest speed of the joint, if the study gives one \[rad/s\]; otherwise it follows from the speed of the
    /// tip.
    pub max_speed_rad_s: Option<f64>,
    /// Whether a brake holds the joint at rest.
    pub has_brake: bool,
    /// The duty that the study states for this joint in place of the duty cycle of all joints; empty if none.
    pub duty: Vec<AskedDutyPhase>,
    /// Limits on the sizes of gear and motor.
    pub fit: AskedFit,
    /// Compliance of the joint's connections, as a fraction of the compliance of a catalog gear and of that gear's
    /// bearing.
    pub connection_share: f64,
    /// The stage between motor and gear. It is used only if the drive comes from the catalogs.
    pub stage: AskedStage,
}

/// A stage between motor and gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AskedStage {
    /// Turns of the motor per turn of the gear's input.
    pub ratio: f64,
    /// Fraction of the motor's power that reaches the gear's input.
    pub efficiency: f64,
    /// Moment of inertia of the stage, referred to the motor's shaft \[kg m²\].
    pub inertia_kgm2: f64,
    /// Twist of the stage at the gear's input per torque on this input \[rad/(N m)\].
    pub rad_per_nm: f64,
}

impl AskedStage {
    /// No stage: the motor turns the gear's input directly.
    pub const NONE: Self = Self { ratio: 1.0, efficiency: 1.0, inertia_kgm2: 0.0, rad_per_nm: 0.0 };
}

/// Limits on the sizes of a joint's gear and motor. By default there are none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AskedFit {
    /// Largest allowed ratio of the gear's outer diameter to the width of the link that follows the joint.
    pub gear_to_link_max: Option<f64>,
    /// Whether the motor must go into the hollow of the link that follows the joint.
    pub motor_in_link: bool,
    /// Whether the motor is on the joint's axis, in line with the gear.
    pub motor_on_axis: bool,
    /// Smallest bore that the gear must have \[m\], and the motor too if it is on the joint's axis.
    pub cable_bore_min_m: Option<f64>,
    /// Largest length of the gear \[m\], together with the motor if that is on the joint's axis too.
    pub drive_length_max_m: Option<f64>,
    /// Length of the link in whose hollow the motor is \[m\]; `None` if the motor is elsewhere.
    pub link_length_m: Option<f64>,
}

/// One phase of a duty that the study states for a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AskedDutyPhase {
    /// Torque at the joint \[N m\]; negative where the load drives the motor.
    pub torque_nm: f64,
    /// Duration of the phase \[s\].
    pub time_s: f64,
    /// Mean speed of the joint \[rpm\].
    pub speed_rpm: f64,
}

/// How a joint's drive is found.
#[derive(Debug, Clone, PartialEq)]
pub enum AskedDrive {
    /// The study gives the drive.
    Given {
        /// Torsion curve of the joint.
        curve: Curve,
        /// Mass of the drive \[kg\].
        mass_kg: f64,
    },
    /// The lightest drive of the catalogs that meets the demand; of equal masses the first by the names of gear and
    /// motor.
    FirstFit(AllowedParts),
    /// Any drive of the catalogs that meets the demand. The search chooses it.
    AllFits(AllowedParts),
}

/// The parts of the catalogs that a joint may use. `None` in a field allows all.
#[derive(Debug, Clone, PartialEq)]
pub struct AllowedParts {
    /// Which of the two catalog masses of a gear is used: the mass of its housed unit or the mass of its component
    /// set.
    pub gear_mass: GearMass,
    /// Allowed series of gears.
    pub gear_series: Option<Vec<String>>,
    /// Allowed reduction ratios.
    pub ratios: Option<Vec<f64>>,
    /// Allowed kinds of gears. For actuators, `actuators` alone decides.
    pub gear_kinds: Option<Vec<GearKind>>,
    /// Allowed gears by name.
    pub gears: Option<Vec<String>>,
    /// Allowed actuators by model.
    pub actuators: Option<Vec<String>>,
    /// Allowed kinds of motors. For the motors of actuators, `actuators` alone decides.
    pub motor_kinds: Option<Vec<MotorKind>>,
    /// Allowed motors by name.
    pub motors: Option<Vec<String>>,
}

/// A link whose tube the search chooses.
#[derive(Debug, Clone, PartialEq)]
pub struct AskedLink {
    /// Name of the link.
    pub name: String,
    /// Vector from root to end in the carried frame \[m\].
    pub vector_m: Vector3<f64>,
    /// The tubes among which the search chooses.
    pub tubes: Vec<AskedTube>,
    /// Rigid bodies on the link, whichever tube it has.
    pub bodies: Vec<RigidBody>,
}

/// A tube that the search may choose for a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AskedTube {
    /// Elastic properties of the material.
    pub material: LinkMaterial,
    /// Cross-section of the tube.
    pub section: Section,
    /// Cost of the material \[EUR/kg\]; `None` if it is not known.
    pub cost_eur_per_kg: Option<f64>,
}

/// The motion that the tip must be able to make, and the life that gears must reach.
#[derive(Debug, Clone, PartialEq)]
pub struct AskedMotion {
    /// Speed of the tip \[m/s\].
    pub tip_speed_m_s: f64,
    /// Time in which the tip speed is reached \[s\].
    pub ramp_time_s: f64,
    /// Deceleration of the tip in an emergency stop \[m/s²\]; `None` means twice the acceleration of the ramp.
    pub emergency_deceleration_m_s2: Option<f64>,
    /// Smallest lever by which the tip speed is divided to give a joint's speed \[m\].
    pub min_lever_m: f64,
    /// Phases of the duty cycle that every joint repeats.
    pub phases: Vec<AskedPhase>,
    /// Required life of a gear, L10 \[h\].
    pub life_h: f64,
    /// How the torque of linear acceleration is computed.
    pub linear_torque: LinearTorque,
    /// Gravity, used by [`LinearTorque::OfStaticTorque`] \[m/s²\].
    pub gravity_m_s2: f64,
    /// Whether the heat of motors over the cycle is checked.
    pub checks_motor_heat: bool,
    /// Number of emergency stops that a gear must survive; `None` if the study asks for none.
    pub emergency_stops: Option<f64>,
}

/// The two ways in which Eq 8, the torque of linear acceleration (see docs/model.md), can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinearTorque {
    /// Inertia of everything outboard about the joint's axis, times the joint's acceleration.
    OfInertia,
    /// Acceleration of the tip divided by gravity, times the static torque. The paper that `src/paper` reproduces reads
    /// Eq 8 in this way.
    OfStaticTorque,
}

/// One phase of the duty cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AskedPhase {
    /// Duration of the phase \[s\].
    pub duration_s: f64,
    /// Motion of the joint in this phase.
    pub kind: AskedPhaseKind,
}

/// Motion and torque of a joint in one phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AskedPhaseKind {
    /// The joint speeds up: static plus linear torque, half the full speed on average.
    Accelerate,
    /// The joint turns at full speed under the static torque.
    Constant,
    /// The joint slows down: static minus linear torque, half the full speed on average.
    Decelerate,
    /// The joint stands still under the static torque.
    Rest,
    /// The joint has stated fractions of the static torque and of the full speed.
    Fraction {
        /// Fraction of the static torque.
        of_static_torque: f64,
        /// Fraction of the joint's full speed.
        of_speed: f64,
    },
}

/// Limits that every design must meet; `None` means no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Largest allowed tip deflection \[m\].
    pub tip_deflection_max_m: Option<f64>,
    /// Largest allowed mass of the arm \[kg\].
    pub mass_max_kg: Option<f64>,
    /// Smallest allowed frequency of the lowest mode \[Hz\].
    pub lowest_mode_min_hz: Option<f64>,
    /// Bandwidth of the servo \[Hz\], and the smallest allowed ratio of the lowest mode to this bandwidth.
    pub servo_hz_and_ratio: Option<[f64; 2]>,
    /// Smallest allowed ratio of strength to stress.
    pub stress_safety_factor_min: Option<f64>,
    /// Largest ratio of the flat width (or of the diameter) of a tube to its wall thickness.
    pub wall_slenderness_max: Option<f64>,
    /// Largest material cost of the chosen links \[EUR\].
    pub material_cost_max_eur: Option<f64>,
}

impl Limits {
    /// The lowest mode that the limits require \[Hz\].
    pub fn required_mode_hz(&self) -> f64 {
        let of_servo = self.servo_hz_and_ratio.map_or(0.0, |[bandwidth_hz, ratio]| bandwidth_hz * ratio);
        of_servo.max(self.lowest_mode_min_hz.unwrap_or(0.0))
    }
}

impl AllowedParts {
    /// Whether a gear may be used.
    pub fn allows_gear(&self, gear: &Gear) -> bool {
        if gear.kind == GearKind::Actuator {
            return is_listed(&self.actuators, |model| *model == gear.id);
        }
        is_listed(&self.gear_series, |series| *series == gear.series)
            && is_listed(&self.ratios, |ratio| *ratio == gear.ratio)
            && is_listed(&self.gear_kinds, |kind| *kind == gear.kind)
            && is_listed(&self.gears, |name| *name == gear.id)
    }

    /// Whether a motor may be used.
    pub fn allows_motor(&self, motor: &Motor) -> bool {
        if motor.kind == MotorKind::OfActuator {
            return is_listed(&self.actuators, |model| *model == motor.id);
        }
        is_listed(&self.motor_kinds, |kind| *kind == motor.kind)
            && is_listed(&self.motors, |name| *name == motor.id)
    }
}

fn is_listed<T>(list: &Option<Vec<T>>, is_it: impl Fn(&T) -> bool) -> bool {
    match list {
        Some(list) => list.iter().any(is_it),
        None => true,
    }
}

impl AskedDrive {
    /// The parts from which the drive may be made; `None` if the study gives the drive.
    pub fn allowed(&self) -> Option<&AllowedParts> {
        match self {
            AskedDrive::Given { .. } => None,
            AskedDrive::FirstFit(allowed) | AskedDrive::AllFits(allowed) => Some(allowed),
        }
    }

    /// Whether the search chooses the drive.
    pub fn is_choice(&self) -> bool {
        matches!(self, AskedDrive::AllFits(_))
    }
}

impl AskedPiece {
    /// Whether the search chooses the part of this piece.
    pub fn is_choice(&self) -> bool {
        match self {
            AskedPiece::Joint(joint) => joint.drive.is_choice(),
            AskedPiece::Prismatic(_) | AskedPiece::Link(_) => false,
            AskedPiece::Choice(_) => true,
        }
    }
}

impl AskedJoint {
    /// The arm element of this joint, built with a torsion curve, the mass of the drive, an output bearing and
    /// extras.
    pub(super) fn with_drive(
        &self,
        curve: Curve,
        mass_kg: f64,
        bearing: Option<Bearing>,
        extras: Extras,
    ) -> Element {
        Element::Joint(Joint {
            name: self.name.clone(),
            axis: self.axis,
            curve,
            mass_kg,
            bearing,
            extras,
            bodies: self.bodies.clone(),
            gear: None,
            motor: None,
            coupled: None,
            stages: Default::default(),
            turns_with: Vec::new(),
        })
    }
}

impl AskedLink {
    /// The arm element of this link, built with a tube.
    pub(super) fn with_tube(&self, tube: &AskedTube) -> Link {
        let AskedTube { material, section, .. } = *tube;
        let body = LinkBody::Tube { material_name: String::new(), material, section };
        Link { name: self.name.clone(), vector_m: self.vector_m, body, bodies: self.bodies.clone() }
    }
}

impl Question {
    /// The arm that consists of these elements, with the effects of the question.
    pub(super) fn arm(&self, chain: Vec<Element>) -> Arm {
        Arm {
            name: String::new(),
            gravity_m_s2: self.gravity_m_s2,
            down: self.down,
            chain,
            effects: self.effects.clone(),
            springs: Vec::new(),
        }
    }

    /// A joint with this torsion curve and bearing, and with the effects that act on the joint. Only the bearing
    /// and the effects contribute to its mass here.
    pub(super) fn joint_piece(
        &self,
        joint: &AskedJoint,
        curve: Curve,
        bearing: Option<Bearing>,
    ) -> JointPiece {
        let arm = self.arm(vec![joint.with_drive(curve, 0.0, bearing, Extras::default())]);
        match arm.structure(self.joints).pieces.pop() {
            Some(Piece::Joint(piece)) => piece,
            _ => unreachable!("an arm of one joint has one joint"),
        }
    }

    /// A link, with the effects that act on it.
    pub(super) fn link_piece(&self, link: Link) -> LinkPiece {
        let arm = self.arm(vec![Element::Link(link)]);
        match arm.structure(self.joints).pieces.pop() {
            Some(Piece::Link(piece)) => piece,
            _ => unreachable!("an arm of one link has one link"),
        }
    }

    /// The arm without its choices, with effects applied. Joints are rigid and have no drives, stated bearings are
    /// present, and an open link has its first tube. From this arm the verifier takes the positions of the pieces
    /// and the springs and masses that effects add between them.
    pub(super) fn nominal_structure(&self) -> Structure {
        let element = |piece: &AskedPiece| match piece {
            AskedPiece::Joint(joint) => {
                joint.with_drive(Curve::Rigid, 0.0, joint.bearing.stated(), Extras::default())
            }
            AskedPiece::Prismatic(rail) => Element::Prismatic(rail.joint.clone()),
            AskedPiece::Link(link) => Element::Link(link.clone()),
            AskedPiece::Choice(choice) => Element::Link(match choice.tubes.first() {
                Some(tube) => choice.with_tube(tube),
                None => Link {
                    name: choice.name.clone(),
                    vector_m: choice.vector_m,
                    body: LinkBody::Offset { mass_kg: 0.0 },
                    bodies: choice.bodies.clone(),
                },
            }),
        };
        self.arm(self.pieces.iter().map(element).collect()).structure(self.joints)
    }

    /// The joints from base to tip.
    pub(super) fn joints(&self) -> impl Iterator<Item = &AskedJoint> {
        self.pieces.iter().filter_map(|piece| match piece {
            AskedPiece::Joint(joint) => Some(joint),
            _ => None,
        })
    }
}
