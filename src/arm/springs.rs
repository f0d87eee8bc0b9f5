//! Springs that balance an arm, and what they do in a pose.
//!
//! A spring between two points a distance `L` apart pulls them together with `F = F₀ + k (L - L₀)`; a negative force pushes
//! them apart, as a gas spring does. A torsion spring turns a joint back by `k (q - q₀)`. Both follow the pose as it is
//! without deflection. How the deflection of the arm changes the force of a spring is left out, and so is the stiffness
//! that a spring adds to modes.

use nalgebra::{Rotation3, Vector3};
use serde_json::{Value, json};

/// A spring of an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// Name, unique among the springs.
    pub name: String,
    /// What the spring acts between.
    pub kind: SpringKind,
}

/// What a spring acts between.
#[derive(Debug, Clone, PartialEq)]
pub enum SpringKind {
    /// Two points.
    Line {
        /// Where the spring hangs and what it pulls.
        ends: [SpringEnd; 2],
        /// Its force.
        law: SpringLaw,
    },
    /// The two sides of a joint.
    Torsion {
        /// Number of the joint in the chain, base to tip.
        joint: usize,
        /// Stiffness \[N m/rad\].
        stiffness_nm_per_rad: f64,
        /// Angle of the joint at which the spring has no torque \[deg\], as files have it.
        free_deg: f64,
    },
}

/// One end of a spring between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpringEnd {
    /// What the end is fixed to.
    pub on: SpringPlace,
    /// The point, from the start of the element in the frame that it carries; of base and world in the world's frame \[m\].
    pub point_m: Vector3<f64>,
}

/// What an end of a spring is fixed to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpringPlace {
    /// Something outside of the arm.
    World,
    /// What carries the first element of the arm. It stands on whatever yields below the arm.
    Base,
    /// An element of the chain by its number, base to tip; of a joint the side that turns.
    Element(usize),
}

/// The force of a spring between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpringLaw {
    /// Force at the free length \[N\]; it pulls the ends together, or pushes them if it is negative.
    pub force_n: f64,
    /// Stiffness \[N/m\].
    pub stiffness_n_per_m: f64,
    /// Length at which the stiffness has no part in the force \[m\].
    pub free_length_m: f64,
}

impl SpringPlace {
    /// The word of files. `names` has the names of the elements, base to tip.
    fn word<'a>(self, names: &[&'a str]) -> &'a str {
        match self {
            SpringPlace::World => "world",
            SpringPlace::Base => "base",
            SpringPlace::Element(index) => names.get(index).copied().unwrap_or_default(),
        }
    }
}

impl SpringLaw {
    /// The force at a length \[N\].
    pub fn force_at(&self, length_m: f64) -> f64 {
        self.force_n + self.stiffness_n_per_m * (length_m - self.free_length_m)
    }
}

/// Where an element of the chain is in a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ElementFrame {
    /// Start of the element in the world \[m\].
    pub at_m: Vector3<f64>,
    /// Attitude of the frame that it carries; of a joint that after its rotation.
    pub rotation: Rotation3<f64>,
    /// Axis in the world and angle \[rad\] of a joint.
    pub hinge: Option<(Vector3<f64>, f64)>,
}

/// A part of the arm that a spring loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// What carries the first element.
    Base,
    /// The side of a joint that does not turn.
    Fixed(usize),
    /// A link, or the side of a joint that turns.
    Moving(usize),
}

/// What a spring does to a part of the arm in a pose, in world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EndLoad {
    pub on: Side,
    /// Where the force acts \[m\].
    pub at_m: Vector3<f64>,
    pub force_n: Vector3<f64>,
    pub moment_nm: Vector3<f64>,
}

/// How far a spring is drawn in a pose and what it does there.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawn {
    /// Length \[m\] and force \[N\] of a spring between two points; a negative force pushes.
    Line {
        /// Distance of the ends \[m\].
        length_m: f64,
        /// Force that pulls the ends together \[N\].
        force_n: f64,
        /// The ends in the world \[m\].
        ends_m: [Vector3<f64>; 2],
    },
    /// Torque of a torsion spring on the outboard side of its joint \[N m\].
    Torsion {
        /// Torque about the axis of the joint \[N m\].
        torque_nm: f64,
    },
}

/// Length below which the two ends of a spring have no direction \[m\].
const NO_LENGTH_M: f64 = 1e-9;

impl Spring {
    /// The spring in a pose; `None` if the chain lacks its elements.
    pub(crate) fn drawn(&self, frames: &[ElementFrame]) -> Option<Drawn> {
        match &self.kind {
            SpringKind::Line { ends, law } => {
                let [a, b] = ends.map(|end| end.at_m(frames));
                let ends_m = [a?, b?];
                let length_m = (ends_m[0] - ends_m[1]).norm();
                Some(Drawn::Line { length_m, force_n: law.force_at(length_m), ends_m })
            }
            SpringKind::Torsion { joint, stiffness_nm_per_rad, free_deg } => {
                let (_, angle_rad) = frames.get(*joint)?.hinge?;
                Some(Drawn::Torsion { torque_nm: stiffness_nm_per_rad * (free_deg.to_radians() - angle_rad) })
            }
        }
    }

    /// What the spring does to the arm in a pose. What it does to the world outside is left out.
    fn loads(&self, frames: &[ElementFrame]) -> Vec<EndLoad> {
        match (&self.kind, self.drawn(frames)) {
            (SpringKind::Line { ends, .. }, Some(Drawn::Line { length_m, force_n, ends_m })) => {
                let pull_n = match length_m > NO_LENGTH_M {
                    true => (ends_m[1] - ends_m[0]) * (force_n / length_m),
                    false => Vector3::zeros(),
                };
                let of = |(end, (at_m, force_n)): (&SpringEnd, (Vector3<f64>, Vector3<f64>))| {
                    Some(EndLoad { on: end.side()?, at_m, force_n, moment_nm: Vector3::zeros() })
                };
                ends.iter().zip([(ends_m[0], pull_n), (ends_m[1], -pull_n)]).filter_map(of).collect()
            }
            (SpringKind::Torsion { joint, .. }, Some(Drawn::Torsion { torque_nm })) => {
                let Some(ElementFrame { at_m, hinge: Some((axis, _)), .. }) = frames.get(*joint) else {
                    return Vec::new();
                };
                let turn = |on: Side, torque_nm: f64| EndLoad {
                    on,
                    at_m: *at_m,
                    force_n: Vector3::zeros(),
                    moment_nm: axis * torque_nm,
                };
                vec![turn(Side::Moving(*joint), torque_nm), turn(Side::Fixed(*joint), -torque_nm)]
            }
            _ => Vec::new(),
        }
    }

    /// The parts of the arm that the spring loads, in any pose.
    pub(crate) fn sides(&self) -> Vec<Side> {
        match &self.kind {
            SpringKind::Line { ends, .. } => ends.iter().filter_map(SpringEnd::side).collect(),
            SpringKind::Torsion { joint, .. } => vec![Side::Moving(*joint), Side::Fixed(*joint)],
        }
    }

    /// The spring as files write it. `names` has the names of the elements, base to tip.
    pub(crate) fn to_json(&self, names: &[&str]) -> Value {
        match &self.kind {
            SpringKind::Line { ends, law } => {
                let [from, to] =
                    ends.map(|end| json!({"at": end.on.word(names), "point_m": end.point_m.as_slice()}));
                json!({
                    "name": self.name, "from": from, "to": to, "force_n": law.force_n,
                    "stiffness_n_per_m": law.stiffness_n_per_m, "free_length_m": law.free_length_m,
                })
            }
            SpringKind::Torsion { joint, stiffness_nm_per_rad, free_deg } => json!({
                "name": self.name, "joint": names.get(*joint).copied().unwrap_or_default(),
                "stiffness_nm_per_rad": stiffness_nm_per_rad, "free_deg": free_deg,
            }),
        }
    }
}

impl SpringEnd {
    /// The end in the world \[m\]; `None` if the chain has no such element.
    fn at_m(&self, frames: &[ElementFrame]) -> Option<Vector3<f64>> {
        match self.on {
            SpringPlace::World | SpringPlace::Base => Some(self.point_m),
            SpringPlace::Element(index) => {
                frames.get(index).map(|frame| frame.at_m + frame.rotation * self.point_m)
            }
        }
    }

    /// The part of the arm that the end is fixed to; `None` for the world.
    fn side(&self) -> Option<Side> {
        match self.on {
            SpringPlace::World => None,
            SpringPlace::Base => Some(Side::Base),
            SpringPlace::Element(index) => Some(Side::Moving(index)),
        }
    }
}

/// What the springs do to the arm in a pose.
pub(crate) fn end_loads(springs: &[Spring], frames: &[ElementFrame]) -> Vec<EndLoad> {
    springs.iter().flat_map(|spring| spring.loads(frames)).collect()
}
