//! The report of an import, `import.json`: what became of the links and joints of a robot, what was assumed, and
//! which joints are rigid because no stiffness is known.

use super::given::GivenSprings;
use super::urdf_tree::{UrdfTree, moves, slides};
use crate::input::magnitude::beyond_calculation;
use nalgebra::Isometry3;
use serde_json::{Value, json};
use urdf_rs::{Joint, JointType, Link};

/// Where a joint of a side branch is held.
#[derive(Debug, Clone, Default)]
pub(super) struct Held {
    /// Its angle \[rad\] or travel \[m\].
    pub at: f64,
    /// The joint of the arm that it follows in the robot, and the factor; `None` if it follows none.
    pub follows: Option<(String, f64)>,
}

/// The report of an import.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ImportReport {
    source: String,
    robot: String,
    tip: String,
    joints: Vec<Value>,
    joined: Vec<Value>,
    lumped: Vec<Value>,
    guessed: Vec<String>,
    /// Names of the joints that are rigid because the stiffness file does not name them.
    pub left_rigid: Vec<String>,
    ignored: Vec<String>,
    /// Limits that no joint can have, with what was made of them.
    odd_limits: Vec<String>,
    tip_frame: Value,
    /// Names of elements with an inertia that no solid can have.
    pub impossible: Vec<String>,
    /// Mass of the arm \[kg\].
    pub mass_kg: f64,
}

impl ImportReport {
    pub(super) fn new(source: &str, robot: &str, tip: &str) -> Self {
        Self {
            source: source.into(),
            robot: robot.into(),
            tip: tip.into(),
            joints: Vec::new(),
            joined: Vec::new(),
            lumped: Vec::new(),
            guessed: Vec::new(),
            left_rigid: Vec::new(),
            ignored: Vec::new(),
            odd_limits: Vec::new(),
            tip_frame: Value::Null,
            impossible: Vec::new(),
            mass_kg: 0.0,
        }
    }

    /// Records a joint of the arm. `springs` are the elastic properties that the stiffness file states for it; `None`
    /// if it states none. `offset` is the constant of a joint that follows another one \[rad, or m if it slides\].
    pub(super) fn joint(
        &mut self,
        joint: &Joint,
        springs: Option<&GivenSprings>,
        coupled: Option<&[(String, f64)]>,
        offset: f64,
    ) {
        let stiffness = match springs.map(GivenSprings::is_rigid) {
            None => "rigid: not given",
            Some(true) => "rigid: given so",
            Some(false) => "given",
        };
        if springs.is_none() {
            self.left_rigid.push(joint.name.clone());
        }
        if joint.joint_type == JointType::Continuous {
            self.guessed.push(format!("{}: continuous, taken as revolute without a range", joint.name));
        }
        let (lower, upper) = match joint.joint_type {
            JointType::Continuous => (None, None),
            _ => (finite(joint.limit.lower), finite(joint.limit.upper)),
        };
        if let Some((driver, factor)) = coupled.and_then(|terms| terms.first()) {
            let (offset, unit) =
                if slides(joint) { (1e3 * offset, "mm") } else { (offset.to_degrees(), "deg") };
            self.guessed.push(format!(
                "{}: a passive joint, {factor} times {driver}; its offset of {offset} {unit} is in the zero position",
                joint.name
            ));
        }
        self.odd_limits.extend(odd_limits(joint));
        let positive = |x: f64| finite(x).filter(|x| *x > 0.0);
        let (effort, velocity) = (positive(joint.limit.effort), positive(joint.limit.velocity));
        if slides(joint) {
            self.joints.push(json!({
                "name": joint.name,
                "type": word(joint),
                "lower_mm": lower.map(|m| 1e3 * m),
                "upper_mm": upper.map(|m| 1e3 * m),
                "max_force_n": effort,
                "max_speed_m_s": velocity,
                "stiffness": stiffness,
            }));
            return;
        }
        self.joints.push(json!({
            "name": joint.name,
            "type": word(joint),
            "lower_deg": lower.map(f64::to_degrees),
            "upper_deg": upper.map(f64::to_degrees),
            "max_torque_nm": effort,
            "max_speed_rad_s": velocity,
            "stiffness": stiffness,
            "coupled": coupled.and_then(|terms| terms.first()).map(|(driver, factor)| json!({driver.as_str(): factor})),
        }));
    }

    /// Records a joint on the path to the tip that does not move. `held_at` is the angle \[rad\] or travel \[m\] at
    /// which it is held. The URDF link that is the child of the joint is merged with `link`, a link of the arm.
    pub(super) fn joined(&mut self, joint: &Joint, link: &str, held_at: f64) {
        self.joined.push(json!({
            "joint": joint.name, "type": word(joint), "link": joint.child.link, "onto": link,
            "held_at_deg": (moves(joint) && !slides(joint)).then(|| held_at.to_degrees()),
            "held_at_mm": slides(joint).then_some(1e3 * held_at),
        }));
    }

    /// Records a link of a side branch, whose body is added to the link `onto` of the arm. `by` is the joint that holds
    /// the link, and `held` where it stands.
    pub(super) fn lumped(&mut self, link: &Link, onto: &str, by: &Joint, held: &Held) {
        self.lumped.push(json!({
            "link": link.name, "onto": onto, "mass_kg": link.inertial.mass.value, "joint": by.name, "type": word(by),
        }));
        let held_at = match (held.at == 0.0, slides(by)) {
            (true, _) => "zero".into(),
            (false, true) => format!("{} m", held.at),
            (false, false) => format!("{} rad", held.at),
        };
        if let Some((driver, factor)) = &held.follows {
            self.guessed.push(format!(
                "{}: beside the way to the tip, moves {factor} times as {driver} does in the robot, held at {held_at} here",
                by.name
            ));
        } else if held.at != 0.0 {
            self.guessed
                .push(format!("{}: on a side branch; held at {held_at}, the offset of its <mimic>", by.name));
        }
        let limits = &by.limit;
        let has_range = limits.lower != limits.upper;
        let is_outside = has_range && (held.at < limits.lower || held.at > limits.upper);
        if moves(by) && by.joint_type != JointType::Continuous && is_outside {
            self.guessed.push(format!(
                "{}: beside the way to the tip, held at {held_at}, which is outside its range of {} to {}",
                by.name, limits.lower, limits.upper
            ));
        }
    }

    /// Records properties of the whole robot. `tip` is the frame of the tip link in the world, and `name` is the name
    /// of this link.
    pub(super) fn finish(&mut self, tree: &UrdfTree, tip: &Isometry3<f64>, name: &str) {
        let (roll, pitch, yaw) = tip.rotation.euler_angles();
        self.tip_frame = json!({
            "xyz_m": tip.translation.vector.as_slice(),
            "rpy_deg": [roll.to_degrees(), pitch.to_degrees(), yaw.to_degrees()],
        });
        let shapes: usize = tree.links.iter().map(|link| link.visual.len() + link.collision.len()).sum();
        if shapes > 0 {
            self.ignored.push(format!("{shapes} meshes and shapes of <visual> and <collision>"));
        }
        let damped = tree.joints.iter().filter(|joint| joint.dynamics.is_some()).count();
        if damped > 0 {
            self.ignored.push(format!("damping and friction of {damped} joints (<dynamics>)"));
        }
        let outboard = tree.child_joints(name).count();
        if outboard > 0 {
            self.guessed
                .push(format!("what the tip link \"{name}\" carries is part of the arm, held at zero"));
        }
        self.guessed.push(
            "links are rigid: a URDF has neither sections nor materials, and its bodies have the drives in them".into(),
        );
    }

    /// The report as JSON, the content of `import.json`.
    pub(crate) fn to_json(&self) -> Value {
        json!({
            "source": self.source,
            "robot": self.robot,
            "tip": self.tip,
            "tip_frame_at_zero": self.tip_frame,
            "tip_frame_note": "arms measure payload and tip force in a last frame that is parallel to the root's at zero angles",
            "mass_kg": self.mass_kg,
            "payload": null,
            "gravity_m_s2": 9.81,
            "joints": self.joints,
            "joined": self.joined,
            "lumped": self.lumped,
            "guessed": self.guessed.iter().chain(&self.odd_limits).collect::<Vec<_>>(),
            "left_rigid": self.left_rigid,
            "ignored": self.ignored,
            "impossible_inertias": self.impossible,
        })
    }

    /// The report as text for the terminal.
    pub(crate) fn to_text(&self) -> String {
        let passive = self.joints.iter().filter(|joint| !joint["coupled"].is_null()).count();
        let mut out = format!(
            "{}: {} joints to \"{}\", {:.3} kg\n",
            self.robot,
            self.joints.len(),
            self.tip,
            self.mass_kg
        );
        if passive > 0 {
            out += &format!("  passive joints: {passive}\n");
        }
        out += &format!(
            "  joints on the way that do not move: {}; links beside the way: {}\n",
            self.joined.len(),
            self.lumped.len()
        );
        if !self.left_rigid.is_empty() {
            out +=
                &format!("  left rigid, because nothing gives a stiffness: {}\n", self.left_rigid.join(", "));
        }
        for words in &self.odd_limits {
            out += &format!("  {words}\n");
        }
        if !self.impossible.is_empty() {
            out += &format!("  no solid has the inertia of: {}\n", self.impossible.join(", "));
        }
        out
    }
}

/// Limits of a joint on the path to the tip that no joint can have, in words.
fn odd_limits(joint: &Joint) -> Vec<String> {
    let limit = &joint.limit;
    let largest = [("effort", limit.effort), ("velocity", limit.velocity)];
    let negative = largest.into_iter().filter(|(_, value)| *value < 0.0 || value.is_nan());
    let mut out: Vec<String> = negative
        .map(|(key, value)| {
            format!("{}: <limit {key}=\"{value}\"> is no largest value, taken as unknown", joint.name)
        })
        .collect();
    if joint.joint_type != JointType::Continuous && limit.lower > limit.upper {
        out.push(format!(
            "{}: <limit lower=\"{}\" upper=\"{}\"> has its lower end above its upper end: no pose is within this range",
            joint.name, limit.lower, limit.upper
        ));
    }
    out
}

/// The number; `None` if it is infinite, or so large that no file may state it.
fn finite(x: f64) -> Option<f64> {
    Some(x).filter(|x| beyond_calculation(*x).is_none())
}

fn word(joint: &Joint) -> &'static str {
    match joint.joint_type {
        JointType::Revolute => "revolute",
        JointType::Continuous => "continuous",
        JointType::Prismatic => "prismatic",
        JointType::Fixed => "fixed",
        JointType::Floating => "floating",
        JointType::Planar => "planar",
        JointType::Spherical => "spherical",
    }
}
