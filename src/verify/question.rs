//! What a study asks, as plain data.
//!
//! The verifier must not learn the question from the code that it checks: not from the search's tables of drives, not
//! from its list of pieces. So whoever asks copies the study into these types, field by field, and everything that
//! follows from them (which drives hold, what a tube weighs, where a joint is) is worked out in this room.

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

/// An arm with choices, what it must do, and how it is judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Gravity \[m/s²\].
    pub gravity_m_s2: f64,
    /// Its direction in the world, a unit vector.
    pub down: Vector3<f64>,
    /// Joints and links from base to tip.
    pub pieces: Vec<AskedPiece>,
    /// All poses and loads, each with the models of links and joints.
    pub cases: Vec<LoadCase>,
    /// Indices of the cases that deflection and lowest mode are taken over.
    pub judged_cases: Vec<usize>,
    /// Indices of the cases in which drives must hold and the arm accelerates.
    pub sizing_cases: Vec<usize>,
    /// The motion that the tip must be able to make.
    pub motion: AskedMotion,
    /// Physics of the links.
    pub links: LinkModel,
    /// Physics of the joints.
    pub joints: JointModel,
    /// What every design must meet.
    pub limits: Limits,
    /// Physics of the product beyond the nominal model; effects of a test do not belong here.
    pub effects: Vec<Effect>,
}

/// One piece of the chain.
#[derive(Debug, Clone, PartialEq)]
pub enum AskedPiece {
    /// A joint.
    Joint(AskedJoint),
    /// A prismatic joint, which the study gives.
    Prismatic(Prismatic),
    /// A link or offset without a choice.
    Link(Link),
    /// A link whose tube is chosen.
    Choice(AskedLink),
}

/// A joint and how its drive is found.
#[derive(Debug, Clone, PartialEq)]
pub struct AskedJoint {
    /// Name.
    pub name: String,
    /// Axis in the carried frame.
    pub axis: Unit<Vector3<f64>>,
    /// Where its output bearing comes from.
    pub bearing: BearingSource,
    /// Where the masses beyond gear, motor and bearing come from.
    pub extras: ExtrasSource,
    /// Rigid bodies that it carries beyond all these.
    pub bodies: JointBodies,
    /// How its drive is found.
    pub drive: AskedDrive,
    /// Largest speed, if the study gives one \[rad/s\]; else it follows from the speed of the tip.
    pub max_speed_rad_s: Option<f64>,
    /// Whether a brake holds it at rest.
    pub has_brake: bool,
    /// The duty that the study states for it in place of its cycle; empty if none.
    pub duty: Vec<AskedDutyPhase>,
    /// What is asked of the sizes of its parts.
    pub fit: AskedFit,
    /// Compliance of its connections, as a share of that of a gear of the catalogs and of the gear's bearing.
    pub connection_share: f64,
    /// The stage between motor and gear, of a drive that is sized.
    pub stage: AskedStage,
}

/// A stage between motor and gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AskedStage {
    /// Turns of the motor per turn of the gear's input.
    pub ratio: f64,
    /// Part of the power that arrives.
    pub efficiency: f64,
    /// Moment of inertia at the motor \[kg m²\].
    pub inertia_kgm2: f64,
    /// Twist of the gear's input per torque there \[rad/(N m)\].
    pub rad_per_nm: f64,
}

impl AskedStage {
    /// The motor turns the gear itself.
    pub const NONE: Self = Self { ratio: 1.0, efficiency: 1.0, inertia_kgm2: 0.0, rad_per_nm: 0.0 };
}

/// What is asked of the sizes of a joint's parts; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AskedFit {
    /// Largest ratio of the gear's outer diameter to the width of the link that the joint carries.
    pub gear_to_link_max: Option<f64>,
    /// Whether the motor must go into the hollow of that link.
    pub motor_in_link: bool,
    /// Whether the motor is behind the gear on its axis.
    pub motor_on_axis: bool,
    /// Smallest bore of what is on the axis \[m\].
    pub cable_bore_min_m: Option<f64>,
    /// Largest length of what is on the axis \[m\].
    pub drive_length_max_m: Option<f64>,
}

/// One phase of a duty that the study states for a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AskedDutyPhase {
    /// Torque at the joint \[N m\]; negative where the load drives the motor.
    pub torque_nm: f64,
    /// How long it lasts \[s\].
    pub time_s: f64,
    /// Mean speed of the joint \[rpm\].
    pub speed_rpm: f64,
}

/// How a joint's drive is found.
#[derive(Debug, Clone, PartialEq)]
pub enum AskedDrive {
    /// The study gives it.
    Given {
        /// Torsion curve.
        curve: Curve,
        /// Mass \[kg\].
        mass_kg: f64,
    },
    /// The lightest drive of the catalogs that holds; of equal masses the first by the names of gear and motor.
    FirstFit(AllowedParts),
    /// Any drive of the catalogs that holds: a choice of the search.
    AllFits(AllowedParts),
}

/// Which parts of the catalogs a joint may use; `None` allows all.
#[derive(Debug, Clone, PartialEq)]
pub struct AllowedParts {
    /// Whether a gear counts with the mass of its housed unit or of its component set.
    pub gear_mass: GearMass,
    /// Series of gears.
    pub gear_series: Option<Vec<String>>,
    /// Reduction ratios.
    pub ratios: Option<Vec<f64>>,
    /// Kinds of gears other than actuators.
    pub gear_kinds: Option<Vec<GearKind>>,
    /// Gears by name.
    pub gears: Option<Vec<String>>,
    /// Actuators by model.
    pub actuators: Option<Vec<String>>,
    /// Kinds of motors other than those of actuators.
    pub motor_kinds: Option<Vec<MotorKind>>,
    /// Motors by name.
    pub motors: Option<Vec<String>>,
}

/// A link whose tube is chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct AskedLink {
    /// Name.
    pub name: String,
    /// From root to end in the carried frame \[m\].
    pub vector_m: Vector3<f64>,
    /// The tubes it can be.
    pub tubes: Vec<AskedTube>,
    /// Rigid bodies that it carries, whichever tube it has.
    pub bodies: Vec<RigidBody>,
}

/// A tube that a link can be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AskedTube {
    /// Elastic properties of its material.
    pub material: LinkMaterial,
    /// Cross-section.
    pub section: Section,
    /// Strength of the material in tension \[Pa\]; unknown strengths are not checked.
    pub strength_pa: Option<f64>,
    /// Strength in compression \[Pa\], if it is another.
    pub compressive_strength_pa: Option<f64>,
    /// Cost of the material \[EUR/kg\].
    pub cost_eur_per_kg: Option<f64>,
}

/// The motion that the tip must be able to make, and how long its gears must last.
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
    /// Whether motors must not overheat over the cycle.
    pub checks_motor_heat: bool,
    /// Number of emergency stops that a gear must bear, if the study asks for one.
    pub emergency_stops: Option<f64>,
}

/// How Eq 8, the torque of linear acceleration, is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinearTorque {
    /// Inertia of everything outboard about the axis, times the joint's acceleration.
    OfInertia,
    /// Acceleration of the tip over gravity, times the static torque, as the paper has it.
    OfStaticTorque,
}

/// One phase of the duty cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AskedPhase {
    /// Duration \[s\].
    pub duration_s: f64,
    /// What the joint does.
    pub kind: AskedPhaseKind,
}

/// What a joint does in one phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AskedPhaseKind {
    /// Speeds up: static plus linear torque, half the speed on average.
    Accelerate,
    /// Turns at its speed under the static torque.
    Constant,
    /// Slows down: the difference of static and linear torque, half the speed on average.
    Decelerate,
    /// Stands still.
    Rest,
    /// Stated fractions of static torque and speed.
    Fraction {
        /// Fraction of the static torque.
        of_static_torque: f64,
        /// Fraction of the joint's speed.
        of_speed: f64,
    },
}

/// What every design must meet; `None` is no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Largest tip deflection \[m\].
    pub tip_deflection_max_m: Option<f64>,
    /// Largest mass \[kg\].
    pub mass_max_kg: Option<f64>,
    /// Smallest lowest mode \[Hz\].
    pub lowest_mode_min_hz: Option<f64>,
    /// A servo's bandwidth \[Hz\], and the least ratio of the lowest mode to the bandwidth.
    pub servo_hz_and_ratio: Option<[f64; 2]>,
    /// Smallest ratio of strength to stress.
    pub stress_safety_factor_min: Option<f64>,
    /// Largest ratio of the flat width (or the diameter) to the wall thickness.
    pub wall_slenderness_max: Option<f64>,
    /// Largest cost of the chosen links' material \[EUR\].
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
    /// The parts that the catalogs may offer; `None` if the study gives the drive.
    pub fn allowed(&self) -> Option<&AllowedParts> {
        match self {
            AskedDrive::Given { .. } => None,
            AskedDrive::FirstFit(allowed) | AskedDrive::AllFits(allowed) => Some(allowed),
        }
    }

    /// Whether the drive is a choice of the search.
    pub fn is_choice(&self) -> bool {
        matches!(self, AskedDrive::AllFits(_))
    }
}

impl AskedPiece {
    /// Whether the part of this piece is a choice of the search.
    pub fn is_choice(&self) -> bool {
        match self {
            AskedPiece::Joint(joint) => joint.drive.is_choice(),
            AskedPiece::Prismatic(_) | AskedPiece::Link(_) => false,
            AskedPiece::Choice(_) => true,
        }
    }
}

impl AskedJoint {
    /// The arm's element for this joint, with a torsion curve and a mass of the drive, an output bearing and extras.
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
    /// The arm's element for this link, with a tube.
    pub(super) fn with_tube(&self, tube: &AskedTube) -> Link {
        let AskedTube { material, section, .. } = *tube;
        let body = LinkBody::Tube { material_name: String::new(), material, section };
        Link { name: self.name.clone(), vector_m: self.vector_m, body, bodies: self.bodies.clone() }
    }
}

impl Question {
    /// The arm of these elements, with the effects of the question.
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

    /// A joint with this torsion curve and bearing and with the effects that act on the joint. Its mass is only that of
    /// the bearing and what the effects add.
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

    /// A link with the effects that act on the link.
    pub(super) fn link_piece(&self, link: Link) -> LinkPiece {
        let arm = self.arm(vec![Element::Link(link)]);
        match arm.structure(self.joints).pieces.pop() {
            Some(Piece::Link(piece)) => piece,
            _ => unreachable!("an arm of one link has one link"),
        }
    }

    /// The arm without its choices, effects applied: joints do not twist and have no drives, stated bearings are there, and
    /// an open link has its first tube. It shows where the pieces are, and what effects put between them.
    pub(super) fn nominal_structure(&self) -> Structure {
        let element = |piece: &AskedPiece| match piece {
            AskedPiece::Joint(joint) => {
                joint.with_drive(Curve::Rigid, 0.0, joint.bearing.stated(), Extras::default())
            }
            AskedPiece::Prismatic(joint) => Element::Prismatic(joint.clone()),
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
