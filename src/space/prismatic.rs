//! A prismatic joint of a study. The study gives its stiffness, its guide and its masses.

use crate::arm::body::RigidBody;
use crate::arm::prismatic::Prismatic;
use nalgebra::{Matrix3, Vector3};

/// A prismatic joint whose numbers are given by the study.
#[derive(Debug, Clone, PartialEq)]
pub struct SpacePrismatic {
    /// Stiffness, guide, masses and axis of the joint.
    pub joint: Prismatic,
    /// Smallest and largest travel \[mm\]; `None` if the study does not state them.
    pub range_mm: Option<[f64; 2]>,
    /// All masses that stay at the beginning of the joint.
    pub(crate) staying: Vec<RigidBody>,
    /// All masses that travel. Their positions are measured from the moving point.
    pub(crate) travelling: Vec<RigidBody>,
}

impl SpacePrismatic {
    /// A prismatic joint. `range_mm` is its smallest and largest travel \[mm\].
    pub fn new(joint: Prismatic, range_mm: Option<[f64; 2]>) -> Self {
        let mut out = Self { joint, range_mm, staying: Vec::new(), travelling: Vec::new() };
        out.collect_bodies();
        out
    }

    /// Fills `staying` and `travelling` from the masses and bodies of the joint.
    pub(crate) fn collect_bodies(&mut self) {
        let with_point = |mass_kg: f64, bodies: &[RigidBody]| {
            let point = RigidBody { mass_kg, cg_m: Vector3::zeros(), inertia_kgm2: Matrix3::zeros() };
            let point = (mass_kg > 0.0).then_some(point);
            point.into_iter().chain(bodies.iter().copied()).collect()
        };
        self.staying = with_point(self.joint.fixed_mass_kg, &self.joint.bodies.fixed);
        self.travelling = with_point(self.joint.mass_kg, &self.joint.bodies.rotating);
    }
}
