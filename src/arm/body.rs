//! Bodies: rigid parts on a link or a joint, with mass, centre of gravity and inertia as CAD programs give them.
//!
//! The centre of gravity is measured from the start of the element, and the inertia is taken about it. Both are written
//! in the frame that carries the body: it turns with the joints inboard, and for a body that rotates or travels with its
//! own joint it moves with that joint too. The vector of a link is written in the frame of its joints inboard. The mass
//! of bodies is added to everything else that an element weighs.

use super::keys::{JOINT_BODY, LINK_BODY};
use super::prismatic_keys::PRISMATIC_BODY;
use crate::input::json::{Node, Object};
use crate::input::key::Shape;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use serde_json::{Value, json};

/// Largest error of an entry of an inertia tensor that is taken as rounding, relative to the largest entry.
const ROUNDING: f64 = 1e-6;

/// A rigid body on a link or a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidBody {
    /// Mass of the body \[kg\].
    pub mass_kg: f64,
    /// Position of the centre of gravity from the start of the element, in the frame that carries the body \[m\].
    pub cg_m: Vector3<f64>,
    /// Inertia about the centre of gravity, in axes of the frame that carries the body \[kg m²\].
    pub inertia_kgm2: Matrix3<f64>,
}

impl RigidBody {
    /// Whether no solid can have this inertia tensor, because a principal moment is larger than the sum of the other
    /// two. Models of robots often have such tensors: a moment that their authors did not need was left at zero.
    pub fn is_impossible(&self) -> bool {
        let moments = SymmetricEigen::new(self.inertia_kgm2).eigenvalues;
        2.0 * moments.max() > moments.sum() + ROUNDING * moments.max()
    }

    fn read(node: &Node, shape: &Shape, moves: &str) -> Option<(Self, bool)> {
        let object = node.shaped(shape)?;
        let mass_kg = object.required("mass_kg").and_then(|n| n.non_negative());
        let cg_m = object.or("cg_m", Vector3::zeros(), |n| n.numbers::<3>().map(Vector3::from));
        let inertia_kgm2 = object.or("inertia_kgm2", Matrix3::zeros(), read_inertia);
        let rotates = object.or(moves, false, Node::boolean);
        Some((Self { mass_kg: mass_kg?, cg_m: cg_m?, inertia_kgm2: inertia_kgm2? }, rotates?))
    }

    /// The body as files write it: mass, centre of gravity, and the inertia tensor as three rows.
    pub(crate) fn to_json(self) -> Value {
        let rows: Vec<Vec<f64>> =
            self.inertia_kgm2.row_iter().map(|row| row.iter().copied().collect()).collect();
        json!({"mass_kg": self.mass_kg, "cg_m": self.cg_m.as_slice(), "inertia_kgm2": rows})
    }
}

/// The bodies of a joint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointBodies {
    /// Bodies inboard of the springs of the joint. They are written in the frame that does not turn or travel with this
    /// joint.
    pub fixed: Vec<RigidBody>,
    /// Bodies outboard of the springs. They are written in the frame that turns or travels with this joint.
    pub rotating: Vec<RigidBody>,
}

impl JointBodies {
    /// Mass of all bodies of the joint \[kg\].
    pub fn mass_kg(&self) -> f64 {
        total_kg(&self.fixed) + total_kg(&self.rotating)
    }

    /// All bodies of the joint: first the bodies inboard of the springs, then the bodies outboard of them.
    pub fn iter(&self) -> impl Iterator<Item = &RigidBody> {
        self.fixed.iter().chain(&self.rotating)
    }

    /// The rigid bodies of the joint (key `bodies` of the arm file) as a JSON list; `None` if the joint has none.
    pub(crate) fn to_json(&self) -> Option<Value> {
        self.to_json_that("rotates")
    }

    /// The rigid bodies of the joint (key `bodies` of the arm file) as a JSON list. `moves` is the key (`rotates` or
    /// `travels`) that is true for bodies outboard of the springs. `None` if the joint has none.
    pub(crate) fn to_json_that(&self, moves: &str) -> Option<Value> {
        let rotating = self.rotating.iter().map(|body| {
            let mut value = body.to_json();
            value[moves] = json!(true);
            value
        });
        let all: Vec<Value> = self.fixed.iter().map(|body| body.to_json()).chain(rotating).collect();
        (!all.is_empty()).then_some(Value::Array(all))
    }
}

/// Sum of the masses of some bodies \[kg\].
pub(crate) fn total_kg(bodies: &[RigidBody]) -> f64 {
    bodies.iter().map(|body| body.mass_kg).sum()
}

/// Reads the key `bodies` of a link; an empty list without the key. Returns `None` after recording a fault.
pub(crate) fn read_link_bodies(object: &Object) -> Option<Vec<RigidBody>> {
    let bodies = read(object, &LINK_BODY, "")?;
    Some(bodies.into_iter().map(|(body, _)| body).collect())
}

/// Reads the key `bodies` of a joint; no bodies without the key. Returns `None` after recording a fault.
pub(crate) fn read_joint_bodies(object: &Object) -> Option<JointBodies> {
    read_bodies_that(object, &JOINT_BODY, "rotates")
}

/// Reads the key `bodies` of a prismatic joint; no bodies without the key. Returns `None` after recording a fault.
pub(crate) fn read_prismatic_bodies(object: &Object) -> Option<JointBodies> {
    read_bodies_that(object, &PRISMATIC_BODY, "travels")
}

/// Reads the key `bodies` of a joint. The keys of each body are the keys of `shape`. Bodies in which the key named by
/// `moves` is true are outboard of the springs. Returns `None` after recording a fault.
fn read_bodies_that(object: &Object, shape: &Shape, moves: &str) -> Option<JointBodies> {
    let mut out = JointBodies::default();
    for (body, is_outboard) in read(object, shape, moves)? {
        if is_outboard { &mut out.rotating } else { &mut out.fixed }.push(body);
    }
    Some(out)
}

fn read(object: &Object, shape: &Shape, moves: &str) -> Option<Vec<(RigidBody, bool)>> {
    object.or("bodies", Vec::new(), |n| {
        let read: Vec<_> = n.array()?.iter().map(|n| RigidBody::read(n, shape, moves)).collect();
        read.into_iter().collect()
    })
}

/// Reads an inertia tensor. It must be symmetric, and none of its principal moments may be negative. Returns `None`
/// after recording a fault.
fn read_inertia(node: &Node) -> Option<Matrix3<f64>> {
    let rows: Vec<Option<[f64; 3]>> = node.array()?.iter().map(|row| row.numbers::<3>()).collect();
    let rows: Vec<[f64; 3]> = rows.into_iter().collect::<Option<_>>()?;
    let [x, y, z] = rows[..] else {
        return node.fault(
            format!("has {} rows", rows.len()),
            "give [[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]] in kg m² about the centre of gravity",
        );
    };
    let tensor = Matrix3::new(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
    let rounding = ROUNDING * tensor.amax();
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let (above, below) = (tensor[(i, j)], tensor[(j, i)]);
        if (above - below).abs() > rounding {
            return node.fault(
                format!(
                    "is not symmetric: row {}, column {} is {above} and row {}, column {} is {below}",
                    i + 1,
                    j + 1,
                    j + 1,
                    i + 1
                ),
                "write each product of inertia twice, with the sign of the tensor (Ixy = -∫xy dm)",
            );
        }
    }
    let tensor = 0.5 * (tensor + tensor.transpose());
    let least = SymmetricEigen::new(tensor).eigenvalues.min();
    if least < -rounding {
        return node.fault(
            format!("has a negative principal moment, {least} kg m²"),
            "check the signs of the products of inertia, and that the tensor is taken about the centre of gravity",
        );
    }
    Some(tensor)
}

#[cfg(test)]
mod tests {
    use crate::arm::file::read_arm_document;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;

    fn problem(bodies: &str) -> String {
        let text = format!(
            r#"{{"chain": [{{"type": "link", "name": "l", "vector_m": [1, 0, 0], "bodies": {bodies}}}]}}"#
        );
        match read_arm_document(Document::parse("a.json", &text).expect("JSON"), &Catalogs::default()) {
            Ok(_) => String::new(),
            Err(faults) => faults.to_string(),
        }
    }

    #[test]
    fn an_impossible_tensor_is_a_fault_that_names_its_number() {
        let inertia = |tensor: &str| problem(&format!(r#"[{{"mass_kg": 1, "inertia_kgm2": {tensor}}}]"#));
        assert_eq!(inertia("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"), "");
        assert!(inertia("[[1, 0.2, 0], [0.1, 1, 0], [0, 0, 1]]").contains("column 2 is 0.2"));
        assert!(inertia("[[1, 2, 0], [2, 1, 0], [0, 0, 1]]").contains("principal moment, -1"));
        assert!(inertia("[[1, 2, 0], [2, 1, 0]]").contains("has 2 rows"));
        assert!(problem(r#"[{"mass_kg": -1}]"#).contains("mass_kg"));
        assert!(problem(r#"[{"mass_kg": 1, "rotates": true}]"#).contains("rotates"));
    }
}
