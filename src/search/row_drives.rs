//! The masses and torsion curves of the drives of a joint, as lists with one entry per drive.

use crate::arm::joint_law::{Curve, JointLaw};
use crate::space::slot::Slot;

/// Mass and torsion curve of every drive that a joint can have; the index in each list is the index of the drive. A
/// curve has three segments. Their compliances include the connection between drive and link, which is in series with
/// the gear. Each quantity has a list of its own, so that eight values of it can be loaded at once.
#[derive(Debug, Clone, Default)]
pub(crate) struct DriveAttributes {
    /// Mass of each drive \[kg\].
    pub mass_kg: Vec<f64>,
    /// Compliance \[rad/(N m)\] of each drive, in one list for each of the three segments.
    pub compliance: [Vec<f64>; 3],
    /// Whether a mode uses the compliance of the first segment at every torque (`Curve::WindupK1`), and not the
    /// tangent compliance.
    pub first_in_modes: bool,
    /// Torques \[N m\] at which the first and the second segment end, in one list for each of the two ends.
    pub ends_nm: [Vec<f64>; 2],
}

impl DriveAttributes {
    /// Adds a drive. A rigid or linear joint gets a curve of three equal segments.
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

/// Masses and torsion curves of the drives that can be in a slot (place in the arm). The list is empty for links and
/// offsets. The springs of a bearing count as drives without mass.
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
