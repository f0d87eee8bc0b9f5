//! Motors that do not sit at the joint they drive, and the belts, chains, shafts and gear stages between motor and
//! joint.
//!
//! *Torsion.* A torque passes through all stages one after the other, and the ratio of each multiplies it. At the joint
//! the compliance of the stages is the sum of `1/(k R²)`, in series with the gear. Here k is the stiffness at the
//! output of a stage, and R is the product of the ratios after this stage.
//!
//! *Coupled motion.* A motor may sit on a part inboard of other joints. The stages then have a pulley on the axis of
//! each of these joints. While the motor stands still, it keeps the pulley still and the link turns under it. Seen from
//! the link, the pulley turns back by the angle of the joint. The driven joint turns by this angle over the product R
//! of the ratios from this pulley on: `q = e - Σ qᵢ / Rᵢ`, with the twist `e` of gear and stages. By virtual work the
//! torque on the drive of joint i is the torque on joint i plus `-1/Rᵢ` times the torque on the driven joint. The part
//! on which the motor sits takes the rest. Motion and torque both enter the mechanics as a
//! [`Linkage`](super::linkage::Linkage).
//!
//! *Masses.* The motor, with the gear if it sits at the motor, is a point mass on the part on which the motor sits. A
//! stage between two axes has half of its mass on each. If several stages sit at the motor, the last of them has half
//! of its mass on the next axis.

use super::body::{JointBodies, RigidBody};
use super::element_keys::read_coupling;
use super::joint_law::Curve;
use super::keys::STAGE;
use super::load::vector;
use crate::catalog::Catalogs;
use crate::input::json::{Node, Object};
use nalgebra::{Matrix3, Vector3};
use serde_json::{Value, json};

/// One stage between a motor and what it drives, or several stages combined into one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Turns of the input per turn of the output.
    pub ratio: f64,
    /// Fraction of the input power that arrives at the output.
    pub efficiency: f64,
    /// Twist of the output per torque at the output, with the input held \[rad/(N m)\].
    pub rad_per_nm: f64,
    /// Moment of inertia of the stage, referred to its input \[kg m²\].
    pub inertia_kgm2: f64,
    /// Mass of the stage \[kg\].
    pub mass_kg: f64,
}

impl Stage {
    /// No stage at all.
    pub const NONE: Self =
        Self { ratio: 1.0, efficiency: 1.0, rad_per_nm: 0.0, inertia_kgm2: 0.0, mass_kg: 0.0 };

    /// This stage and the stage `next` that its output drives, combined into one.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        Self {
            ratio: self.ratio * next.ratio,
            efficiency: self.efficiency * next.efficiency,
            rad_per_nm: self.rad_per_nm / (next.ratio * next.ratio) + next.rad_per_nm,
            inertia_kgm2: self.inertia_kgm2 + next.inertia_kgm2 / (self.ratio * self.ratio),
            mass_kg: self.mass_kg + next.mass_kg,
        }
    }

    fn read(node: &Node) -> Option<Self> {
        let object = node.shaped(&STAGE)?;
        let ratio = object.required("ratio").and_then(|n| n.positive());
        let efficiency = object.or("efficiency", 1.0, |n| match n.positive()? {
            part if part <= 1.0 => Some(part),
            part => n.fault(format!("= {part} is more than the whole"), "give a part such as 0.95"),
        });
        let rad_per_nm = object.or("stiffness_nm_per_rad", 0.0, |n| match n.is_null() {
            true => Some(0.0),
            false => n.positive().map(|k| 1.0 / k),
        });
        let inertia_kgm2 = object.or("inertia_kgm2", 0.0, Node::non_negative);
        let mass_kg = object.or("mass_kg", 0.0, Node::non_negative);
        Some(Self {
            ratio: ratio?,
            efficiency: efficiency?,
            rad_per_nm: rad_per_nm?,
            inertia_kgm2: inertia_kgm2?,
            mass_kg: mass_kg?,
        })
    }
}

/// The stages of a joint's drive on either side of its gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stages {
    /// Between the motor and the gear.
    pub before: Stage,
    /// Between the gear and the joint.
    pub after: Stage,
    /// Ratio of the gear, if the file states it in numbers; otherwise `None`.
    pub gear_ratio: Option<f64>,
}

impl Default for Stages {
    fn default() -> Self {
        Self { before: Stage::NONE, after: Stage::NONE, gear_ratio: None }
    }
}

impl Stages {
    /// Turns of the motor per turn of the joint, with a gear of this ratio.
    pub fn whole_ratio(&self, gear_ratio: f64) -> f64 {
        self.before.ratio * gear_ratio * self.after.ratio
    }

    /// Moment of inertia of rotor, gear input and stages together, referred to the motor \[kg m²\].
    pub fn input_inertia_kgm2(&self, rotor_kgm2: f64, gear_kgm2: f64, gear_ratio: f64) -> f64 {
        let Self { before, after, .. } = self;
        let at_gear_kgm2 = gear_kgm2 + after.inertia_kgm2 / (gear_ratio * gear_ratio);
        rotor_kgm2 + before.inertia_kgm2 + at_gear_kgm2 / (before.ratio * before.ratio)
    }

    /// These stages without compliance and mass. A design has the compliance in its torsion curves and the mass in its
    /// bodies.
    #[must_use]
    pub fn rigid(&self) -> Self {
        let rigid = |stage: Stage| Stage { rad_per_nm: 0.0, mass_kg: 0.0, ..stage };
        Self { before: rigid(self.before), after: rigid(self.after), gear_ratio: self.gear_ratio }
    }

    /// The keys with which files write the stages. Compliance and mass are left out, because the torsion curve and the
    /// bodies include them.
    pub(crate) fn to_json(self) -> Vec<(&'static str, Value)> {
        let one = |stage: Stage| json!([{"ratio": stage.ratio, "efficiency": stage.efficiency, "inertia_kgm2": stage.inertia_kgm2}]);
        let mut out = match (self.before == Stage::NONE, self.after == Stage::NONE) {
            (true, true) if self.gear_ratio.is_none() => Vec::new(),
            (true, false) => vec![("gear_at", json!("motor")), ("transmission", one(self.after))],
            _ => vec![("transmission", one(self.before))],
        };
        out.extend(self.gear_ratio.map(|ratio| ("gear_ratio", json!(ratio))));
        out
    }
}

/// The keys of a joint that say where its motor sits and through which stages it drives the joint.
pub(crate) const TRANSMISSION_KEYS: [&str; 6] =
    ["motor_at", "motor_point_m", "motor_mass_kg", "gear_at", "gear_ratio", "transmission"];

/// How a motor drives its joint, as the file says it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Transmission {
    /// Name of the part that carries the motor, or `base`; `None` if the motor sits at the joint.
    motor_at: Option<String>,
    motor_point_m: Vector3<f64>,
    /// Mass at the place where the motor is mounted \[kg\]: the motor, and the gear if it sits at the motor. It is 0 if
    /// the search chooses the drive, because its motor is not yet known.
    motor_kg: f64,
    /// Whether the gear sits at the motor, before the stages.
    gear_at_motor: bool,
    /// Ratio of the gear at the joint, after the stages; `None` if there is no such gear or its ratio is not known yet.
    gear_ratio: Option<f64>,
    /// Whether the file states this ratio in numbers.
    is_ratio_stated: bool,
    stages: Vec<Stage>,
    /// Whether the file itself states which joints turn this joint (key `turns_with`).
    is_coupling_stated: bool,
}

/// Whether the file states that the gear of a joint sits at the motor (key `gear_at`).
pub(crate) fn gear_is_at_motor(object: &Object) -> bool {
    object.optional("gear_at").is_some_and(|n| n.value().as_str() == Some("motor"))
}

impl Transmission {
    /// Reads the transmission from the keys of a joint. `motor_kg` is the mass of the parts that sit at the motor
    /// \[kg\]. The inner `None` means that the joint has none of these keys, the outer `None` that a fault was
    /// recorded.
    pub(crate) fn read(object: &Object, catalogs: &Catalogs, motor_kg: Option<f64>) -> Option<Option<Self>> {
        fits_beside(object)?;
        if !TRANSMISSION_KEYS.iter().any(|key| object.has(key)) {
            return Some(None);
        }
        let motor_at = object.or("motor_at", None, |n| n.string().map(|name| Some(name.to_string())));
        let motor_point_m = object.or("motor_point_m", Vector3::zeros(), vector);
        let gear_at_motor = object.or("gear_at", false, |n| match n.string()? {
            "joint" => Some(false),
            "motor" => Some(true),
            word => n.fault(format!("\"{word}\" is not known"), "choose one of: joint, motor"),
        });
        let stages = object.or("transmission", Vec::new(), |n| {
            n.array()?.iter().map(Stage::read).collect::<Vec<_>>().into_iter().collect()
        });
        let gear_ratio = object.or("gear_ratio", gear_ratio(object, catalogs), |n| n.positive().map(Some))?;
        let is_told = gear_ratio.is_some() || gear_at_motor != Some(false) || object.has("drive");
        if !is_told && stages.iter().flatten().any(|stage| stage.rad_per_nm > 0.0) {
            return object.node().fault(
                "has compliant stages before a gear of unknown ratio",
                "add \"gear_ratio\" (1 if the stages drive the joint itself), or \"gear_at\": \"motor\"",
            );
        }
        Some(Some(Self {
            motor_at: motor_at?,
            motor_point_m: motor_point_m?,
            motor_kg: motor_kg?,
            gear_at_motor: gear_at_motor?,
            gear_ratio,
            is_ratio_stated: object.has("gear_ratio"),
            stages: stages?,
            is_coupling_stated: object.has("turns_with"),
        }))
    }

    /// This transmission with a gear of the ratio `ratio` at the joint, after the stages.
    pub(crate) fn with_gear_ratio(&self, ratio: f64) -> Self {
        Self { gear_ratio: Some(ratio), ..self.clone() }
    }

    /// All stages combined into one.
    pub(crate) fn stage(&self) -> Stage {
        self.stages.iter().fold(Stage::NONE, |whole, next| whole.then(*next))
    }

    /// The stages on either side of the gear.
    pub(crate) fn stages(&self) -> Stages {
        let gear_ratio = self.gear_ratio.filter(|_| self.is_ratio_stated);
        match self.gear_at_motor {
            true => Stages { after: self.stage(), gear_ratio, ..Stages::default() },
            false => Stages { before: self.stage(), gear_ratio, ..Stages::default() },
        }
    }

    /// Whether the motor sits at the joint and drives the gear itself.
    pub(crate) fn is_none(&self) -> bool {
        self.motor_at.is_none() && self.stages.is_empty()
    }

    /// Whether the motor sits elsewhere than the joint.
    pub(crate) fn is_elsewhere(&self) -> bool {
        self.motor_at.is_some()
    }

    /// The torsion curve of the joint, of gear and stages together. `gear` is the torsion curve of the gear alone.
    pub(crate) fn curve(&self, gear: Curve) -> Curve {
        let stage = self.stage();
        match self.gear_at_motor {
            true => gear.behind(stage.ratio).in_series(stage.rad_per_nm),
            false => gear.in_series(stage.rad_per_nm / self.ratio_at_joint().powi(2)),
        }
    }

    /// Ratio of the gear between the stages and the joint; 1 if the gear sits at the motor or if its ratio is unknown.
    fn ratio_at_joint(&self) -> f64 {
        if self.gear_at_motor { 1.0 } else { self.gear_ratio.unwrap_or(1.0) }
    }
}

/// Checks that no key is given where it has no meaning. A passive joint has no motor. The keys for the point and the
/// mass of the motor need `motor_at`, and `gear_ratio` needs `transmission`. Returns `None` after recording a fault.
fn fits_beside(object: &Object) -> Option<()> {
    let mut sound = Some(());
    let mut stray = |keys: &[&str], problem: &str, hint: &str| {
        for key in keys.iter().filter(|key| object.has(key)) {
            sound = object.node().fault_below(key, problem, hint);
        }
    };
    if object.has("coupled") {
        let of_motor = [&TRANSMISSION_KEYS[..], &["turns_with"]].concat();
        stray(
            &of_motor,
            "stands beside \"coupled\"",
            "a linkage turns this joint: write it at the joint that drives it",
        );
        return sound;
    }
    if !object.has("motor_at") {
        stray(
            &["motor_point_m", "motor_mass_kg"],
            "has no \"motor_at\" beside it",
            "add \"motor_at\", the part that carries the motor; a motor at the joint counts in mass_kg",
        );
    }
    if !object.has("transmission") {
        stray(&["gear_ratio"], "has no \"transmission\" beside it", "add \"transmission\", or leave it away");
    }
    sound
}

/// Ratio of the gear that the key `gear` names; `None` if the catalogs have no such gear.
fn gear_ratio(object: &Object, catalogs: &Catalogs) -> Option<f64> {
    let gear = object.optional("gear")?;
    catalogs.gear(gear.value().as_str()?).ok().map(|gear| gear.ratio)
}

/// The properties of an element of the chain that a transmission needs.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    /// Name of the element.
    pub name: String,
    /// How the element moves.
    pub motion: SeenMotion,
}

/// How an element of a chain moves, as far as a transmission needs to know.
#[derive(Debug, Clone)]
pub(crate) enum SeenMotion {
    /// A joint that turns. The vector is its axis in the frame with all joint angles zero. The names
    /// belong to the joints that turn a passive joint; the list is empty for a joint with a drive.
    Turns(Vector3<f64>, Vec<String>),
    /// A prismatic joint.
    Slides,
    /// A link.
    Stays,
}

/// The side of an element on which a body is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum HungOn {
    /// The inboard side, which does not move with the joint.
    Start,
    /// The outboard side of a joint, which moves with the joint; for a link, the link itself.
    Moving,
}

/// A motor or a stage of a transmission, as a body on an element of the chain.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hung {
    /// Number of the element in the chain, counted from 0 at the base.
    pub element: usize,
    /// Side of the element on which the part is.
    pub on: HungOn,
    /// The part as a rigid body.
    pub body: RigidBody,
}

/// The place of a motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MotorAt {
    /// Number of the element in the chain, counted from 0 at the base.
    pub element: usize,
    /// Side of the element on which the motor is.
    pub on: HungOn,
    /// Position of the motor in the frame of this side of the element \[m\].
    pub point_m: Vector3<f64>,
}

/// A transmission after it has been placed in its chain.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Placed {
    /// The joints that the stages cross. Each has a factor: the turns of the driven joint per turn of that joint while
    /// the motor stands still. `None` if the file states them.
    pub turns_with: Option<Vec<(String, f64)>>,
    /// Masses of the motor and of the stages.
    pub hung: Vec<Hung>,
    /// Where the motor is. It is at the driven joint if the file names no other place.
    pub motor: MotorAt,
    /// Whether there are joints between the motor and the driven joint, which the stages cross.
    pub crosses: bool,
}

impl Transmission {
    /// Places the transmission of the joint that is element number `joint` in its chain. `node` is the joint in its
    /// file. Returns `None` after recording a fault.
    pub(crate) fn place(&self, node: &Node, joint: usize, chain: &[Seen]) -> Option<Placed> {
        let motor = self.motor_place(node, joint, chain)?;
        let first = match motor.on {
            _ if self.motor_at.is_none() => joint,
            HungOn::Moving => motor.element + 1,
            HungOn::Start => motor.element,
        };
        let crossed = crossed(node, first, joint, chain)?;
        if self.stages.len() < crossed.len() && !(self.is_coupling_stated && self.stages.is_empty()) {
            let names: Vec<&str> = crossed.iter().map(|&(i, _)| chain[i].name.as_str()).collect();
            return node.fault_below(
                "transmission",
                format!(
                    "has {} stages, and between the motor and the joint there are {} joints: {}",
                    self.stages.len(),
                    crossed.len(),
                    names.join(", ")
                ),
                "give a stage for every link along which a belt runs, the last one to this joint; an idler has ratio 1",
            );
        }
        let along = self.stages.len().saturating_sub(crossed.len());
        let turns_with = match self.is_coupling_stated {
            true => None,
            false => Some(self.coupling(node, joint, &crossed, along, chain)?),
        };
        let hung = self.hung(motor, joint, &crossed, along);
        Some(Placed { turns_with, hung, motor, crosses: !crossed.is_empty() })
    }

    fn motor_place(&self, node: &Node, joint: usize, chain: &[Seen]) -> Option<MotorAt> {
        let Some(name) = &self.motor_at else {
            return Some(MotorAt { element: joint, on: HungOn::Start, point_m: Vector3::zeros() });
        };
        let point_m = self.motor_point_m;
        let inboard = &chain[..joint];
        match inboard.iter().rposition(|seen| seen.name == *name) {
            _ if name == super::BASE => Some(MotorAt { element: 0, on: HungOn::Start, point_m }),
            Some(element) => Some(MotorAt { element, on: HungOn::Moving, point_m }),
            None => {
                let names: Vec<&str> = inboard.iter().map(|seen| seen.name.as_str()).collect();
                node.fault_below(
                    "motor_at",
                    format!("\"{name}\" is no part of the arm inboard of this joint"),
                    &format!("choose base, or one of: {}", names.join(", ")),
                )
            }
        }
    }

    /// The joints that the stages cross. Each has a factor: the turns of the driven joint per turn of that joint while
    /// the motor stands still. `along` is the index of the first stage that runs along the link outboard of a crossed
    /// joint, and `crossed` are the crossed joints, base to tip. Returns `None` after recording a fault.
    fn coupling(
        &self,
        node: &Node,
        joint: usize,
        crossed: &[(usize, Vector3<f64>)],
        along: usize,
        chain: &[Seen],
    ) -> Option<Vec<(String, f64)>> {
        let SeenMotion::Turns(own, _) = &chain[joint].motion else { return Some(Vec::new()) };
        if !crossed.is_empty() && self.gear_ratio.is_none() && !self.gear_at_motor {
            return node.fault(
                "is driven from beyond another joint, and the ratio of its gear is not known",
                "add \"gear_ratio\" (1 if the stages drive the joint itself), or \"gear_at\": \"motor\"",
            );
        }
        let mut terms = Some(Vec::new());
        for (k, (element, axis)) in crossed.iter().enumerate() {
            let name = &chain[*element].name;
            let from_here: f64 = self.stages[along + k..].iter().map(|stage| stage.ratio).product();
            let cosine = axis.dot(own);
            if cosine.abs() < PARALLEL_COSINE {
                terms = node.fault_below(
                    "motor_at",
                    format!("lies beyond \"{name}\", whose axis is not parallel to that of this joint"),
                    "say in \"turns_with\" how far this joint turns per turn of each joint between, while the motor stands",
                );
                continue;
            }
            if let Some(terms) = &mut terms {
                terms.push((name.clone(), -cosine.signum() / (from_here * self.ratio_at_joint())));
            }
        }
        terms
    }

    /// The motor and the stages as point masses, each on the element and at the point where it sits. `along` is the
    /// index of the first stage that does not sit at the motor.
    fn hung(
        &self,
        motor: MotorAt,
        joint: usize,
        crossed: &[(usize, Vector3<f64>)],
        along: usize,
    ) -> Vec<Hung> {
        // stages before the first crossed joint sit at the motor; the last of them reaches the next axis
        let near = &self.stages[..along];
        let near_kg: f64 = near.iter().map(|stage| stage.mass_kg).sum();
        let half_kg = near.last().map_or(0.0, |stage| stage.mass_kg / 2.0);
        let next = crossed.first().map_or(joint, |(element, _)| *element);
        let mut hung = vec![
            (motor.element, motor.on, motor.point_m, self.motor_kg + near_kg - half_kg),
            (next, HungOn::Start, Vector3::zeros(), half_kg),
        ];
        for (k, stage) in self.stages[along..].iter().enumerate() {
            let end = crossed.get(k + 1).map_or(joint, |(element, _)| *element);
            hung.push((crossed[k].0, HungOn::Moving, Vector3::zeros(), stage.mass_kg / 2.0));
            hung.push((end, HungOn::Start, Vector3::zeros(), stage.mass_kg / 2.0));
        }
        let body = |(element, on, cg_m, mass_kg)| Hung {
            element,
            on,
            body: RigidBody { mass_kg, cg_m, inertia_kgm2: Matrix3::zeros() },
        };
        hung.into_iter().filter(|(.., mass_kg)| *mass_kg > 0.0).map(body).collect()
    }
}

/// Smallest cosine of the angle between two axes that are taken as parallel.
const PARALLEL_COSINE: f64 = 0.999_999;

/// The joints between a motor and the joint that it drives, each as the number of its element and its axis. `first` is
/// the first element outboard of the motor. Returns `None` after recording a fault.
fn crossed(node: &Node, first: usize, joint: usize, chain: &[Seen]) -> Option<Vec<(usize, Vector3<f64>)>> {
    let mut out = Vec::new();
    for (element, seen) in chain.iter().enumerate().take(joint).skip(first) {
        match &seen.motion {
            SeenMotion::Stays => {}
            SeenMotion::Slides => {
                return node.fault_below(
                    "motor_at",
                    format!("lies beyond \"{}\", which slides", seen.name),
                    "transmissions over prismatic joints are not modelled: let the motor travel along",
                );
            }
            SeenMotion::Turns(axis, drivers) => {
                let outboard = |driver: &&String| !chain[..element].iter().any(|seen| seen.name == **driver);
                if let Some(driver) = drivers.iter().find(outboard) {
                    return node.fault_below(
                        "motor_at",
                        format!("lies beyond \"{}\", which \"{driver}\" turns from further out", seen.name),
                        "put the motor outboard of it",
                    );
                }
                out.push((element, *axis));
            }
        }
    }
    Some(out)
}

/// Reads the key `turns_with`: the joints inboard of a joint that turn it while its own motor stands still, each with
/// its factor. The list is empty without the key. Returns `None` after recording a fault.
pub(crate) fn read_turns_with(object: &Object) -> Option<Vec<(String, f64)>> {
    object.or("turns_with", Vec::new(), read_coupling)
}

/// Checks that every joint in `terms` is a joint that turns and is inboard of the element number `joint`. `terms` is
/// the value of `turns_with` of this element. Returns `None` after recording a fault.
pub(crate) fn turns_with_joints_inboard(
    node: &Node,
    terms: &[(String, f64)],
    joint: usize,
    chain: &[Seen],
) -> Option<()> {
    let turns = |seen: &&Seen| matches!(seen.motion, SeenMotion::Turns(..));
    let inboard: Vec<&str> = chain[..joint].iter().filter(turns).map(|seen| seen.name.as_str()).collect();
    let mut sound = Some(());
    for (name, _) in terms.iter().filter(|(name, _)| !inboard.contains(&name.as_str())) {
        sound = node.fault_below(
            "turns_with",
            format!("\"{name}\" is no joint inboard of this one that turns"),
            &format!("joints inboard: {}", inboard.join(", ")),
        );
    }
    sound
}

/// The bodies of an element, to which parts of transmissions are added.
pub(crate) enum Carrier<'a> {
    /// The bodies of a joint.
    Joint(&'a mut JointBodies),
    /// The bodies of a link.
    Link(&'a mut Vec<RigidBody>),
}

impl Carrier<'_> {
    /// Adds a part of a transmission to the bodies of the element.
    pub(crate) fn carry(&mut self, hung: &Hung) {
        match (self, hung.on) {
            (Self::Joint(bodies), HungOn::Start) => bodies.fixed.push(hung.body),
            (Self::Joint(bodies), HungOn::Moving) => bodies.rotating.push(hung.body),
            // a motor at the base of a chain that begins with a link does not move with the link, so it is put at its
            // start
            (Self::Link(bodies), HungOn::Start) => {
                bodies.push(RigidBody { cg_m: Vector3::zeros(), ..hung.body });
            }
            (Self::Link(bodies), HungOn::Moving) => bodies.push(hung.body),
        }
    }
}
