//! Springs that balance an arm, and the forces that they put on it in a pose.
//!
//! A spring between two points at a distance `L` pulls them together with `F = F₀ + k (L - L₀)`. A negative force
//! pushes them apart, as a gas spring does. A torsion spring turns a joint back by the torque `k (q - q₀)`. Both are
//! computed in the undeflected pose. The change of a spring's force by the deflection of the arm is neglected. The
//! stiffness that a spring adds in vibrations is neglected too.

use nalgebra::{Rotation3, Vector3};
use serde_json::{Value, json};

/// A spring of an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// Name, unique among the springs.
    pub name: String,
    /// Whether the spring acts between two points or about a joint, with its properties.
    pub kind: SpringKind,
}

/// Whether a spring acts between two points or about a joint, with its properties.
#[derive(Debug, Clone, PartialEq)]
pub enum SpringKind {
    /// A spring between two points.
    Line {
        /// The two points and what each is fixed to.
        ends: [SpringEnd; 2],
        /// Force as a function of length.
        law: SpringLaw,
    },
    /// A spring between the two sides of a joint, which acts as a torque.
    Torsion {
        /// Index of the joint among all elements of the chain, base to tip.
        joint: usize,
        /// Stiffness of the torsion spring \[N m/rad\].
        stiffness_nm_per_rad: f64,
        /// Angle of the joint at which the torque of the spring is zero, in the unit of files \[deg\].
        free_deg: f64,
    },
}

/// One end of a spring between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpringEnd {
    /// What the end is fixed to: an element, the base or the world.
    pub on: SpringPlace,
    /// Position of the end \[m\]: from the start of the element in the frame that moves with it, or in the world's
    /// frame for base and world.
    pub point_m: Vector3<f64>,
}

/// What an end of a spring is fixed to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpringPlace {
    /// A point outside of the arm.
    World,
    /// The body that carries the first element of the arm. It is outboard of any compliance of the base.
    Base,
    /// An element of the chain by its index, base to tip. For a joint, it is the side that turns.
    Element(usize),
}

/// The force of a spring between two points as a function of its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpringLaw {
    /// Force at the free length \[N\]. If positive it pulls the ends together, if negative it pushes them apart.
    pub force_n: f64,
    /// Stiffness of the spring \[N/m\].
    pub stiffness_n_per_m: f64,
    /// Length at which the force is `force_n`, because the stiffness adds nothing to it \[m\].
    pub free_length_m: f64,
}

impl SpringPlace {
    /// The word for this place in files. `names` are the names of the elements, base to tip.
    fn word<'a>(self, names: &[&'a str]) -> &'a str {
        match self {
            SpringPlace::World => "world",
            SpringPlace::Base => super::BASE,
            SpringPlace::Element(index) => names.get(index).copied().unwrap_or_default(),
        }
    }
}

impl SpringLaw {
    /// The force at a length \[N\]; positive if it pulls.
    pub fn force_at(&self, length_m: f64) -> f64 {
        self.force_n + self.stiffness_n_per_m * (length_m - self.free_length_m)
    }
}

/// Position and attitude of an element of the chain in a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ElementFrame {
    /// Position of the start of the element, in the world \[m\].
    pub at_m: Vector3<f64>,
    /// Rotation from the frame that moves with the element to the world; for a joint, the frame after its rotation.
    pub rotation: Rotation3<f64>,
    /// For a joint: unit vector along its axis in the world, and its angle \[rad\]. `None` for other elements.
    pub hinge: Option<(Vector3<f64>, f64)>,
}

/// A part of the arm on which a spring acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// The body that carries the first element.
    Base,
    /// The inboard side of a joint, which does not turn. The number is the index of the joint.
    Fixed(usize),
    /// A link, or the outboard side of a joint, which turns. The number is the index of the element.
    Moving(usize),
}

/// Force and moment that a spring puts on a part of the arm in a pose, in world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EndLoad {
    pub on: Side,
    /// Point at which the force acts, in the world \[m\].
    pub at_m: Vector3<f64>,
    pub force_n: Vector3<f64>,
    pub moment_nm: Vector3<f64>,
}

/// The state of a spring in a pose: its length and force, or its torque.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawn {
    /// A spring between two points.
    Line {
        /// Distance between the ends \[m\].
        length_m: f64,
        /// Force that pulls the ends together \[N\]; negative if it pushes.
        force_n: f64,
        /// Positions of the two ends in the world \[m\].
        ends_m: [Vector3<f64>; 2],
    },
    /// A torsion spring.
    Torsion {
        /// Torque on the outboard side of the joint, about its axis \[N m\].
        torque_nm: f64,
    },
}

/// Length below which the direction of a spring is undefined, so that its force is taken as zero \[m\].
const NO_LENGTH_M: f64 = 1e-9;

impl Spring {
    /// Length and force of the spring in a pose, or its torque. `frames` are the frames of the elements in this pose,
    /// base to tip. `None` if an element to which the spring is fixed is missing.
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

    /// Forces and moments that the spring puts on the arm in a pose. `frames` are the frames of the elements, base to
    /// tip. A force on a point of the world is left out, because it does not load the arm.
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

    /// The parts of the arm on which the spring acts. They are the same in every pose.
    pub(crate) fn sides(&self) -> Vec<Side> {
        match &self.kind {
            SpringKind::Line { ends, .. } => ends.iter().filter_map(SpringEnd::side).collect(),
            SpringKind::Torsion { joint, .. } => vec![Side::Moving(*joint), Side::Fixed(*joint)],
        }
    }

    /// The spring as files write it. `names` are the names of the elements, base to tip.
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
    /// Position of this end in the world \[m\]; `None` if the chain has no such element. `frames` are the frames of the
    /// elements in the pose, base to tip.
    fn at_m(&self, frames: &[ElementFrame]) -> Option<Vector3<f64>> {
        match self.on {
            SpringPlace::World | SpringPlace::Base => Some(self.point_m),
            SpringPlace::Element(index) => {
                frames.get(index).map(|frame| frame.at_m + frame.rotation * self.point_m)
            }
        }
    }

    /// The part of the arm to which the end is fixed; `None` for the world.
    fn side(&self) -> Option<Side> {
        match self.on {
            SpringPlace::World => None,
            SpringPlace::Base => Some(Side::Base),
            SpringPlace::Element(index) => Some(Side::Moving(index)),
        }
    }
}

/// Forces and moments that all springs put on the arm in a pose. `frames` are the frames of the elements, base to tip.
pub(crate) fn end_loads(springs: &[Spring], frames: &[ElementFrame]) -> Vec<EndLoad> {
    springs.iter().flat_map(|spring| spring.loads(frames)).collect()
}
