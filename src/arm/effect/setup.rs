//! Setups: differences between the arm in the tests of one channel and the arm by itself. Instruments may hang on the
//! arm in one kind of test only, and a servo that holds a joint in one kind of test may be softer than a brake in
//! another.

use crate::arm::structure::{FrameCompliance, LinkPiece, Piece, Structure};
use nalgebra::Vector3;

/// Differences between the arm in the tests of one channel and the arm by itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Setup {
    /// Additional mass at the tip \[kg\].
    pub mass_kg: f64,
    /// Centre of gravity of the additional mass, measured from the tip in the last frame \[m\].
    pub cg_m: Vector3<f64>,
    /// Additional compliance of joints about their axes in these tests: name of the joint and compliance
    /// \[rad/(N m)\].
    pub servo_rad_per_nm: Vec<(String, f64)>,
}

impl Setup {
    /// Whether the tests of the channel are made with the arm as it is, without additional mass or compliance.
    pub fn is_plain(&self) -> bool {
        self.mass_kg == 0.0 && self.servo_rad_per_nm.is_empty()
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
