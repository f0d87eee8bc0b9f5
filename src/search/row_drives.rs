//! The drives of a joint as a row sees them: numbers of one kind side by side.

use crate::arm::joint_law::{Curve, JointLaw};
use crate::space::slot::Slot;

/// The drives of a joint by index. Each has its mass and its torsion curve of three segments, with the connection in
/// series. The numbers of one kind stand together, so that a lane can gather them.
#[derive(Debug, Clone, Default)]
pub(crate) struct DriveAttributes {
    pub mass_kg: Vec<f64>,
    /// Twist per torque \[rad/(N m)\] in each segment.
    pub compliance: [Vec<f64>; 3],
    /// Whether modes see the first segment alone, at every torque.
    pub first_in_modes: bool,
    /// Ends of the first two segments \[N m\].
    pub ends_nm: [Vec<f64>; 2],
}

impl DriveAttributes {
    /// Adds a drive. A rigid or linear joint becomes a curve whose segments are equal.
    fn push(&mut self, mass_kg: f64, law: &JointLaw) {
        let (stiffness, ends_nm) = match law.curve.as_windup().map(|windup| windup.segments()) {
            None => ([f64::INFINITY; 3], [f64::INFINITY; 2]),
            Some(segments) => {
                (segments.map(|s| s.stiffness_nm_per_rad), [segments[0].to_nm, segments[1].to_nm])
            }
        };
        self.first_in_modes = matches!(law.curve, Curve::WindupK1(_));
        self.mass_kg.push(mass_kg);
        for (all, stiffness) in self.compliance.iter_mut().zip(stiffness) {
            all.push(1.0 / stiffness + law.connection_rad_per_nm);
        }
        for (all, end_nm) in self.ends_nm.iter_mut().zip(ends_nm) {
            all.push(end_nm);
        }
    }
}

/// The drives that can be in a slot.
pub(super) fn drive_attributes(slot: &Slot) -> DriveAttributes {
    let mut drives = DriveAttributes::default();
    match slot {
        Slot::Given { law, mass_kg } => drives.push(*mass_kg, law),
        Slot::Bearing { laws, .. } => laws.iter().for_each(|law| drives.push(0.0, law)),
        Slot::Sized(sized) => {
            sized.laws.iter().enumerate().for_each(|(i, law)| drives.push(sized.table.mass_kg(i), law));
        }
        _ => {}
    }
    drives
}
