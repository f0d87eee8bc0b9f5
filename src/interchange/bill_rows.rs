//! Rows of a bill of materials, and what is needed to make them.

use crate::arm::Element;
use crate::arm::body::RigidBody;
use crate::catalog::Provenance;
use crate::catalog::gear::{Gear, GearMass};

/// Relative difference of two masses that counts as rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// One row of a bill.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// Number of equal parts.
    pub count: usize,
    /// Name of the part.
    pub part: String,
    /// Kind of part, such as gear, motor or tube.
    pub kind: &'static str,
    /// Mass of all parts of this row \[kg\].
    pub mass_kg: f64,
    /// Length of each part \[m\]; `None` for parts that are not cut to length.
    pub length_m: Option<f64>,
    /// Source of the data of the part.
    pub source: String,
    /// How far the data can be trusted: the confidence of its catalog row, or `stated`.
    pub confidence: String,
    /// Cost of all parts of this row \[EUR\]; `None` if it is unknown.
    pub cost_eur: Option<f64>,
    /// Names of the joints and links that use the part, one entry for each use.
    pub used_at: Vec<String>,
}

/// The bodies of an element, in the order of the bill.
pub(super) fn bodies_of(element: &Element) -> Vec<&RigidBody> {
    match element {
        Element::Joint(joint) => joint.bodies.iter().collect(),
        Element::Prismatic(joint) => joint.bodies.iter().collect(),
        Element::Link(link) => link.bodies.iter().collect(),
    }
}

/// The row of the bill for a part that is in no catalog and is used at the element `at`. Its data come from the arm
/// file.
pub(super) fn stated(at: &str, part: String, kind: &'static str, mass_kg: f64) -> Row {
    Row {
        count: 1,
        part,
        kind,
        mass_kg,
        length_m: None,
        source: "arm file".into(),
        confidence: "stated".into(),
        cost_eur: None,
        used_at: vec![at.into()],
    }
}

/// The row of the bill for a catalog part that is used at the element `at`. `from` states from where the catalog has
/// the numbers of the part.
pub(super) fn bought(at: &str, part: &str, kind: &'static str, mass_kg: f64, from: &Provenance) -> Row {
    let (source, confidence) = (from.source.clone(), from.confidence.to_string());
    Row { source, confidence, ..stated(at, part.into(), kind, mass_kg) }
}

/// Whether a gear of this mass is the housed unit or the component set of the catalog; `None` if neither has this
/// mass.
pub(super) fn which_mass(gear: &Gear, mass_kg: f64) -> Option<&'static str> {
    let is =
        |which| gear.mass_kg(which).is_some_and(|kg: f64| (kg - mass_kg).abs() <= ROUNDING * kg.max(1.0));
    match (is(GearMass::HousedUnit), is(GearMass::ComponentSet)) {
        (true, _) => Some("housed unit"),
        (_, true) => Some("component set"),
        _ => None,
    }
}
