//! All transmissions of a chain, of arm files and of studies: each is put into the chain, and every fault is found.

use super::Element;
use super::transmission::Carrier;
use super::transmission::{Placed, Seen, SeenMotion, Transmission, turns_with_joints_inboard};
use crate::input::json::Node;

/// A joint of a chain with what its file says of its drive.
pub(crate) struct Driven<'n> {
    /// The joint in its file.
    pub node: Node<'n>,
    /// Number of the joint in the chain.
    pub joint: usize,
    /// How its motor drives it, if the file says something of it.
    pub transmission: Option<Transmission>,
    /// How far it turns with others by the file.
    pub turns_with: Vec<(String, f64)>,
}

/// Every transmission in its chain, with the number of its joint.
pub(crate) fn place_all(driven: &[Driven], chain: &[Seen]) -> Option<Vec<(usize, Placed)>> {
    let mut out = Some(Vec::new());
    for of in driven {
        if turns_with_joints_inboard(&of.node, &of.turns_with, of.joint, chain).is_none() {
            out = None;
        }
        let Some(transmission) = &of.transmission else { continue };
        match (transmission.place(&of.node, of.joint, chain), &mut out) {
            (Some(placed), Some(all)) => all.push((of.joint, placed)),
            (None, _) => out = None,
            _ => {}
        }
    }
    out
}

impl Element {
    /// The element as a transmission sees it.
    pub(crate) fn seen(&self) -> Seen {
        let motion = match self {
            Element::Joint(joint) => SeenMotion::turning(&joint.axis, joint.coupled.as_deref()),
            Element::Prismatic(_) => SeenMotion::Slides,
            Element::Link(_) => SeenMotion::Stays,
        };
        Seen { name: self.name().to_string(), motion }
    }

    /// The bodies of the element.
    pub(crate) fn carrier(&mut self) -> Carrier<'_> {
        match self {
            Element::Joint(joint) => Carrier::Joint(&mut joint.bodies),
            Element::Prismatic(joint) => Carrier::Joint(&mut joint.bodies),
            Element::Link(link) => Carrier::Link(&mut link.bodies),
        }
    }
}

impl SeenMotion {
    /// A joint that turns about an axis, perhaps with drivers of a linkage.
    pub(crate) fn turning(axis: &nalgebra::Vector3<f64>, coupled: Option<&[(String, f64)]>) -> Self {
        let drivers = coupled.into_iter().flatten().map(|(name, _)| name.clone()).collect();
        SeenMotion::Turns(*axis, drivers)
    }
}
