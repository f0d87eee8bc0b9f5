//! A prismatic joint of a study: its stiffness, guide and masses are given.

use crate::arm::body::RigidBody;
use crate::arm::prismatic::Prismatic;
use nalgebra::{Matrix3, Vector3};

/// A prismatic joint whose numbers the study gives.
#[derive(Debug, Clone, PartialEq)]
pub struct SpacePrismatic {
    /// The joint.
    pub joint: Prismatic,
    /// Smallest and largest travel \[mm\]; `None`: not stated.
    pub range_mm: Option<[f64; 2]>,
    /// All that stays where the joint begins.
    pub(crate) staying: Vec<RigidBody>,
    /// All that travels, measured from the moved point.
    pub(crate) travelling: Vec<RigidBody>,
}

impl SpacePrismatic {
    /// A joint with a range of travel \[mm\].
    pub fn new(joint: Prismatic, range_mm: Option<[f64; 2]>) -> Self {
        let mut out = Self { joint, range_mm, staying: Vec::new(), travelling: Vec::new() };
        out.collect_bodies();
        out
    }

    /// Collects what stays and what travels from the masses and bodies of the joint.
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
