//! Reads springs and counterweights, of arm files and of studies.

use super::BASE;
use super::body::{JointBodies, RigidBody};
use super::keys::{COUNTERWEIGHT, SPRING, SPRING_END, TORSION_SPRING};
use super::load::vector;
use super::springs::{Spring, SpringEnd, SpringKind, SpringLaw, SpringPlace};
use crate::input::json::{Node, Object};
use nalgebra::{Matrix3, Vector3};

/// Name of an element of the chain, and whether it is a joint.
pub(crate) type Named<'a> = (&'a str, bool);

/// Whether a number of a spring or of a counterweight may be a list of values to choose from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Values {
    /// Every number has one value, as in an arm.
    One,
    /// A list of values is allowed, as in a study. The first value stands for the list.
    Choices,
}

impl Values {
    /// Reads a number with `read`, or the first number of a list, all of whose numbers `read` must accept. Returns
    /// `None` after recording a fault.
    fn first<'a>(self, node: &Node<'a>, read: fn(&Node<'a>) -> Option<f64>) -> Option<f64> {
        if self == Self::One || !node.value().is_array() {
            return read(node);
        }
        let values: Vec<Option<f64>> = node.array()?.iter().map(read).collect();
        match values.into_iter().collect::<Option<Vec<f64>>>()?.first() {
            Some(value) => Some(*value),
            None => node.fault("is an empty list", "give the values to choose from, or one number"),
        }
    }
}

/// Reads the key `springs`; an empty list without the key. `elements` are the elements of the chain, base to tip.
/// Returns `None` after recording a fault.
pub(crate) fn read_springs(object: &Object, elements: &[Named], values: Values) -> Option<Vec<Spring>> {
    object.or("springs", Vec::new(), |node| {
        let items = node.array()?;
        let read: Vec<_> =
            items.iter().enumerate().map(|(i, n)| read_spring(n, i, elements, values)).collect();
        let springs = read.into_iter().collect::<Option<Vec<Spring>>>()?;
        let mut sound = Some(());
        for (i, item) in items.iter().enumerate() {
            if springs[..i].iter().any(|other| other.name == springs[i].name) {
                sound = item.fault(
                    format!("the name \"{}\" is taken", springs[i].name),
                    "give every spring a name of its own",
                );
            }
        }
        sound.map(|()| springs)
    })
}

fn read_spring(node: &Node, index: usize, elements: &[Named], values: Values) -> Option<Spring> {
    let is_torsion = node.value().get("joint").is_some();
    let object = node.shaped(if is_torsion { &TORSION_SPRING } else { &SPRING })?;
    let name = object.or("name", format!("spring {}", index + 1), |n| match n.string()? {
        "" => n.fault("is empty", "give the spring a name, or leave the key away"),
        name => Some(name.to_string()),
    });
    let kind = match is_torsion {
        true => read_torsion(&object, elements, values),
        false => read_line(&object, elements, values),
    };
    Some(Spring { name: name?, kind: kind? })
}

fn read_torsion(object: &Object, elements: &[Named], values: Values) -> Option<SpringKind> {
    let joint = object.required("joint").and_then(|n| {
        let name = n.string()?;
        elements.iter().position(|(known, is_joint)| *known == name && *is_joint).or_else(|| {
            let joints = elements.iter().filter(|(_, is_joint)| *is_joint).map(|(name, _)| *name);
            let joints: Vec<&str> = joints.collect();
            let hint = match joints.is_empty() {
                true => {
                    "the chain has no joint that turns: state the spring between two points, with from and to"
                        .into()
                }
                false => format!("choose one of: {}", joints.join(", ")),
            };
            n.fault(format!("\"{name}\" is no joint that turns"), &hint)
        })
    });
    let stiffness = object.required("stiffness_nm_per_rad").and_then(|n| values.first(&n, Node::positive));
    let free_deg = object.required("free_deg").and_then(|n| values.first(&n, Node::number));
    Some(SpringKind::Torsion { joint: joint?, stiffness_nm_per_rad: stiffness?, free_deg: free_deg? })
}

fn read_line(object: &Object, elements: &[Named], values: Values) -> Option<SpringKind> {
    let end = |key| object.required(key).and_then(|n| read_end(&n, elements));
    let (from, to) = (end("from"), end("to"));
    let law = read_law(object, values);
    let (from, to) = (from?, to?);
    let fixed = |end: SpringEnd| matches!(end.on, SpringPlace::World | SpringPlace::Base);
    if from.on == to.on || (fixed(from) && fixed(to)) {
        return object.node().fault(
            "has both ends on one part of the arm, where it moves nothing",
            "fix one end to another element, to \"base\" or to \"world\"",
        );
    }
    Some(SpringKind::Line { ends: [from, to], law: law? })
}

/// Reads the law of a spring between two points. Force or stiffness must be given, or both. Returns `None` after
/// recording a fault.
fn read_law(object: &Object, values: Values) -> Option<SpringLaw> {
    let (has_force, has_stiffness) = (object.has("force_n"), object.has("stiffness_n_per_m"));
    if !has_force && !has_stiffness {
        return object.node().fault(
            "says nothing of its force",
            "add \"stiffness_n_per_m\" and \"free_length_m\", or a constant \"force_n\" (negative: it pushes)",
        );
    }
    if has_stiffness != object.has("free_length_m") {
        return object.node().fault(
            "has one of \"stiffness_n_per_m\" and \"free_length_m\" without the other",
            "give both: the length without tension is 0 for a spring that is wound to have none",
        );
    }
    let force_n = object.or("force_n", 0.0, |n| values.first(n, Node::number));
    let stiffness = object.or("stiffness_n_per_m", 0.0, |n| values.first(n, Node::non_negative));
    let free_length = object.or("free_length_m", 0.0, |n| values.first(n, Node::non_negative));
    Some(SpringLaw { force_n: force_n?, stiffness_n_per_m: stiffness?, free_length_m: free_length? })
}

fn read_end(node: &Node, elements: &[Named]) -> Option<SpringEnd> {
    let object = node.shaped(&SPRING_END)?;
    let on = object.required("at").and_then(|n| read_place(&n, elements));
    let point_m = object.or("point_m", Vector3::zeros(), vector);
    Some(SpringEnd { on: on?, point_m: point_m? })
}

/// Reads what an end of a spring is fixed to. `base` and `world` mean base and world, even if an element has this name.
/// Returns `None` after recording a fault.
fn read_place(node: &Node, elements: &[Named]) -> Option<SpringPlace> {
    match (element(node, elements)?, node.string()?) {
        (_, BASE) => Some(SpringPlace::Base),
        (_, "world") => Some(SpringPlace::World),
        (Some(index), _) => Some(SpringPlace::Element(index)),
        (None, name) => node.fault(
            format!("the chain has no \"{name}\""),
            &format!("choose base, world, or one of: {}", names(elements)),
        ),
    }
}

fn element(node: &Node, elements: &[Named]) -> Option<Option<usize>> {
    let name = node.string()?;
    Some(elements.iter().position(|(known, _)| *known == name))
}

fn names(elements: &[Named]) -> String {
    elements.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

/// Reads the key `counterweights`; an empty list without the key. Each counterweight is a point mass, returned with the
/// index of the element that carries it. For a joint, it is the side that turns. Returns `None` after recording a
/// fault.
pub(crate) fn read_counterweights(
    object: &Object,
    elements: &[Named],
    values: Values,
) -> Option<Vec<(usize, RigidBody)>> {
    object.or("counterweights", Vec::new(), |node| {
        let read: Vec<_> = node.array()?.iter().map(|n| read_counterweight(n, elements, values)).collect();
        read.into_iter().collect()
    })
}

fn read_counterweight(node: &Node, elements: &[Named], values: Values) -> Option<(usize, RigidBody)> {
    let object = node.shaped(&COUNTERWEIGHT)?;
    let name = object.or("name", String::new(), |n| n.string().map(String::from));
    let at = object.required("at").and_then(|n| {
        element(&n, elements)?.or_else(|| {
            let name = n.string()?;
            n.fault(format!("the chain has no \"{name}\""), &format!("choose one of: {}", names(elements)))
        })
    });
    let cg_m = object.required("point_m").and_then(|n| vector(&n));
    let mass_kg = object.required("mass_kg").and_then(|n| values.first(&n, Node::non_negative));
    name?;
    Some((at?, RigidBody { mass_kg: mass_kg?, cg_m: cg_m?, inertia_kgm2: Matrix3::zeros() }))
}

/// The list of bodies of one element of the chain. A counterweight on the element is added to it.
pub(crate) enum BodiesOf<'a> {
    /// The bodies of a joint.
    Joint(&'a mut JointBodies),
    /// The bodies of a link.
    Link(&'a mut Vec<RigidBody>),
}

/// Adds each counterweight to the bodies of the element that carries it.
pub(crate) fn hang<'a>(counterweights: Vec<(usize, RigidBody)>, mut bodies: Vec<BodiesOf<'a>>) {
    for (index, body) in counterweights {
        match &mut bodies[index] {
            BodiesOf::Joint(bodies) => bodies.rotating.push(body),
            BodiesOf::Link(bodies) => bodies.push(body),
        }
    }
}
