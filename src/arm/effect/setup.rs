//! Setups: differences between the arm in the tests of one channel and the arm by itself. Instruments may hang on the
//! arm in one kind of test only. A joint may be held by its servo in one kind of test and by its brake in another, and
//! the servo may be softer than the brake.

use super::warming::Softening;
use crate::arm::structure::{FrameCompliance, LinkPiece, Piece, Structure};
use nalgebra::Vector3;

/// A base that turned once between two rows of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turned {
    /// Rotation vector about the origin of the chain \[rad\].
    pub turn_rad: Vector3<f64>,
    /// The first row of the file after the base turned, counted from 0.
    pub from_row: usize,
}

impl Turned {
    /// Displacement \[m\] of the point `at_m` by this rotation. `row` is the row of the file, counted from 0; in the
    /// rows before the rotation the displacement is zero.
    pub fn moved_m(&self, at_m: &Vector3<f64>, row: usize) -> Vector3<f64> {
        if row < self.from_row { Vector3::zeros() } else { self.turn_rad.cross(at_m) }
    }
}

/// The differences between the arm in the tests of one channel and the arm by itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Setup {
    /// Additional mass at the tip \[kg\].
    pub mass_kg: f64,
    /// Centre of gravity of the additional mass, measured from the tip in the last frame \[m\].
    pub cg_m: Vector3<f64>,
    /// Additional compliance of joints about their axes in these tests: name of the joint and compliance
    /// \[rad/(N m)\].
    pub servo_rad_per_nm: Vec<(String, f64)>,
    /// Joints that soften in the course of the tests, by name.
    pub softening: Vec<(String, Softening)>,
    /// Rotation of the base between two rows of the tests; `None` if the base did not turn.
    pub turned: Option<Turned>,
}

impl Setup {
    /// Whether the arm has neither additional mass nor additional compliance in the tests of this channel, and no joint
    /// softens.
    pub fn is_plain(&self) -> bool {
        self.mass_kg == 0.0 && self.servo_rad_per_nm.is_empty() && self.is_steady()
    }

    /// Whether the structure is the same in all rows.
    pub fn is_steady(&self) -> bool {
        self.softening.is_empty()
    }

    /// How the joint named `joint` softens in these tests; `None` if it does not.
    pub fn softening_of(&self, joint: &str) -> Option<Softening> {
        self.softening.iter().rfind(|(name, _)| name == joint).map(|(_, softening)| *softening)
    }

    /// Multiplies the compliance of each joint that softens in these tests, in `structure`, by the value of `factor`.
    pub(crate) fn soften(&self, structure: &mut Structure, factor: impl Fn(&Softening) -> f64) {
        for (name, softening) in &self.softening {
            if let Some(joint) = structure.joint_mut(name) {
                joint.law = joint.law.softer(factor(softening));
            }
        }
    }

    /// Additional compliance of the joint named `joint` about its axis in these tests \[rad/(N m)\]; 0 if there is
    /// none.
    pub fn servo_of(&self, joint: &str) -> f64 {
        self.servo_rad_per_nm.iter().filter(|(name, _)| name == joint).map(|(_, c)| c).sum()
    }

    /// The `structure` of an arm, changed to the arm in the tests of this channel. The additional mass is placed by two
    /// rigid offsets, one forth and one back, so that the tip stays where it is.
    pub fn of(&self, structure: &Structure) -> Structure {
        let mut out = structure.clone();
        for (name, compliance) in &self.servo_rad_per_nm {
            if let Some(joint) = out.joint_mut(name) {
                joint.law.connection_rad_per_nm += compliance;
            }
        }
        if self.mass_kg != 0.0 {
            // the point mass of an offset is at its mid-length, so the offset is twice as long as the way to the mass
            let there = offset("test_mass", 2.0 * self.cg_m, self.mass_kg);
            out.pieces.extend([there, offset("test_mass.back", -2.0 * self.cg_m, 0.0)]);
        }
        out
    }
}

fn offset(name: &str, vector_m: Vector3<f64>, point_mass_kg: f64) -> Piece {
    Piece::Link(LinkPiece {
        name: name.into(),
        vector_m,
        beam: None,
        point_mass_kg,
        bodies: Vec::new(),
        harness_kg_per_m: 0.0,
        root_frame: FrameCompliance::default(),
    })
}
