//! Prismatic joints in a pose.
//!
//! A unit of deflection `s` along the travel direction `a` moves everything outboard by `a`. The twist of the drive
//! is therefore `(a, 0)`, and the generalized force on it is the force of gravity and load along the travel,
//! `F = a · Σ f`. The drive deflects by `F/k`. The guide turns everything outboard about three axes through one
//! point, by moment over stiffness. This point is where the runner blocks are: if a carriage moves, it travels with
//! the carriage; if a ram moves, it stays where the joint begins.

use super::beam::section_frame;
use super::chain::{Compliance, ElasticElement, Owner, Walk};
use super::{Wrench, angular, linear, rotation_twist, stack};
use crate::arm::prismatic::{Moves, PrismaticPiece};
use crate::arm::springs::{ElementFrame, Side};
use nalgebra::{Matrix3, Vector3};

/// Force and moment on the guide of a prismatic joint, at the point of its springs.
#[derive(Debug, Clone, PartialEq)]
pub struct GuideLoad {
    /// Name of the joint.
    pub name: String,
    /// Force along the travel, which loads the drive, and forces across the travel, along the y and z axes of the guide
    /// \[N\].
    pub force_n: Vector3<f64>,
    /// Moment about the travel (roll), about the y axis (pitch) and about the z axis (yaw) of the guide \[N m\].
    pub moment_nm: Vector3<f64>,
    /// Direction of the travel, a unit vector in world axes.
    pub travel: Vector3<f64>,
}

impl GuideLoad {
    /// Force and moment on the guide of the joint `name`, given as the `wrench` of everything outboard about the
    /// world's origin. The axes of the guide are the columns of `frame`, and its springs are at `at_m` \[m\].
    pub(super) fn of(name: &str, wrench: &Wrench, frame: &Matrix3<f64>, at_m: &Vector3<f64>) -> Self {
        let force_n = linear(wrench);
        let moment_nm = angular(wrench) - at_m.cross(&force_n);
        Self {
            name: name.to_string(),
            force_n: frame.tr_mul(&force_n),
            moment_nm: frame.tr_mul(&moment_nm),
            travel: frame.column(0).into(),
        }
    }
}

/// Name that the guide of a prismatic joint has among the elastic elements.
pub(crate) fn guide_name(joint: &str) -> String {
    format!("{joint}.guide")
}

impl Walk {
    /// Adds a prismatic joint, moved out by `travel_m` \[m\]: first the mass that stays, then the springs of guide and
    /// drive, then the mass that travels. `index` is its place in the chain.
    pub(super) fn prismatic(&mut self, index: usize, joint: &PrismaticPiece, travel_m: f64) {
        self.point_mass(joint.fixed_mass_kg, self.at_m);
        self.bodies(&joint.bodies.fixed);
        let frame = self.rotation.matrix() * section_frame(&joint.axis);
        let moved_m = self.at_m + frame.column(0) * travel_m;
        let springs_m = match joint.moves {
            Moves::Carriage => moved_m,
            Moves::Ram => self.at_m,
        };
        self.at_m = moved_m;
        if !joint.guide_is_rigid() {
            self.elastic(guide(index, joint, &frame, &springs_m));
        }
        self.elastic(ElasticElement {
            name: joint.name.clone(),
            owner: Owner::Piece(index),
            at_m: springs_m,
            twists: vec![stack(&frame.column(0).into(), &Vector3::zeros())],
            compliance: Compliance::Slide { m_per_n: joint.m_per_n, frame },
            torque_nm: 0.0,
            own: None,
        });
        self.point_mass(joint.mass_kg, self.at_m);
        self.bodies(&joint.bodies.rotating);
        // A spring that is attached to this joint acts on the part that travels.
        self.frames.push(ElementFrame { at_m: self.at_m, rotation: self.rotation, hinge: None });
        self.load(Side::Moving(index));
    }
}

/// The springs of a guide as an elastic element. `frame` has the axes of the guide and `springs_m` is the point of the
/// springs, both in the world. `index` is the place of the joint in the chain. Axes about which the guide is rigid are
/// left out.
fn guide(
    index: usize,
    joint: &PrismaticPiece,
    frame: &Matrix3<f64>,
    springs_m: &Vector3<f64>,
) -> ElasticElement {
    let axes = frame.column_iter().zip(joint.guide_rad_per_nm.iter());
    let (twists, compliances) = axes
        .filter(|(_, compliance)| **compliance > 0.0)
        .map(|(axis, compliance)| (rotation_twist(&axis.into_owned(), springs_m), *compliance))
        .unzip();
    ElasticElement {
        name: guide_name(&joint.name),
        owner: Owner::Piece(index),
        at_m: *springs_m,
        twists,
        compliance: Compliance::Linear(compliances),
        torque_nm: 0.0,
        own: None,
    }
}
