//! Places all transmissions of a chain, and finds all faults in them. Arm files and studies both use this module.

use super::Element;
use super::transmission::Carrier;
use super::transmission::{Placed, Seen, SeenMotion, Transmission, turns_with_joints_inboard};
use crate::input::json::Node;

/// A joint of a chain, with what its file says about its drive.
pub(crate) struct Driven<'n> {
    /// The object of the joint in its file, for the place of faults.
    pub node: Node<'n>,
    /// Number of the joint in the chain, counted from 0 at the base.
    pub joint: usize,
    /// How the motor drives the joint; `None` if the file has no key for it.
    pub transmission: Option<Transmission>,
    /// The joints that turn this joint while its own motor stands still, each with its factor, as the file states them.
    pub turns_with: Vec<(String, f64)>,
}

/// Places every transmission in the chain. Each item of the result is the number of the driven joint and its placed
/// transmission. `None` if one of them has a fault.
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
    /// The properties of this element that a transmission needs.
    pub(crate) fn seen(&self) -> Seen {
        let motion = match self {
            Element::Joint(joint) => SeenMotion::turning(&joint.axis, joint.coupled.as_deref()),
            Element::Prismatic(_) => SeenMotion::Slides,
            Element::Link(_) => SeenMotion::Stays,
        };
        Seen { name: self.name().to_string(), motion }
    }

    /// The bodies of the element, so that parts of transmissions can be added to them.
    pub(crate) fn carrier(&mut self) -> Carrier<'_> {
        match self {
            Element::Joint(joint) => Carrier::Joint(&mut joint.bodies),
            Element::Prismatic(joint) => Carrier::Joint(&mut joint.bodies),
            Element::Link(link) => Carrier::Link(&mut link.bodies),
        }
    }
}

impl SeenMotion {
    /// A joint that turns about an axis. `coupled` has its drivers if it is the passive joint of a linkage.
    pub(crate) fn turning(axis: &nalgebra::Vector3<f64>, coupled: Option<&[(String, f64)]>) -> Self {
        let drivers = coupled.into_iter().flatten().map(|(name, _)| name.clone()).collect();
        SeenMotion::Turns(*axis, drivers)
    }
}
