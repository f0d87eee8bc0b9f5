//! A prismatic joint of a study: its guide and masses are given, and its drive is given or sized.

use crate::arm::body::RigidBody;
use crate::arm::prismatic::Prismatic;
use crate::catalog::gear::Gear;
use crate::sizing::demand::{JointMotion, LinearReading};
use crate::sizing::requirement::MotionRequirement;
use crate::sizing::select::DriveFilter;
use nalgebra::{Matrix3, Vector3};

/// How the drive of a prismatic joint is sized: the lightest pair of a screw or rack and a motor that passes all
/// checks.
#[derive(Debug, Clone, PartialEq)]
pub struct RailDrive {
    /// Screws and racks to choose from, as gears whose ratings are forces.
    pub gears: Vec<Gear>,
    /// The motors to choose from.
    pub motors: DriveFilter,
    /// Whether a brake holds the joint at rest, so that the motor does not need a holding force.
    pub has_brake: bool,
}

/// The motion of a joint that slides, with metres in the place of radians. The tip moves as far as the joint does, so
/// the lever is 1. The smallest lever that the study sets is for joints that turn, and does not apply.
fn along_its_way(asked: &MotionRequirement, speed_m_s: f64) -> JointMotion {
    MotionRequirement { min_lever_m: 1.0, ..asked.clone() }.joint_motion(1.0, Some(speed_m_s))
}

/// A prismatic joint of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct SpacePrismatic {
    /// Stiffness, guide, masses and axis of the joint.
    pub joint: Prismatic,
    /// Smallest and largest travel \[mm\]; `None` if the study does not state them.
    pub range_mm: Option<[f64; 2]>,
    /// Largest speed that the study asks of the joint \[m/s\]; `None` if it is the speed of the tip.
    pub max_speed_m_s: Option<f64>,
    /// How the drive is sized; `None` if the drive is given, with its stiffness in `joint`.
    pub drive: Option<RailDrive>,
    /// All masses that stay where the joint begins.
    pub(crate) staying: Vec<RigidBody>,
    /// All masses that travel. Their positions are measured from the moving point.
    pub(crate) travelling: Vec<RigidBody>,
}

impl SpacePrismatic {
    /// A prismatic joint. `range_mm` is its smallest and largest travel \[mm\].
    pub fn new(joint: Prismatic, range_mm: Option<[f64; 2]>) -> Self {
        let (staying, travelling) = (Vec::new(), Vec::new());
        let mut out = Self { joint, range_mm, max_speed_m_s: None, drive: None, staying, travelling };
        out.collect_bodies();
        out
    }

    /// The motion of the joint, with metres in the place of radians. All masses that the joint moves have the same
    /// acceleration, so Eq 8 of docs/model.md (the force of linear acceleration) gives exactly mass times acceleration.
    pub(crate) fn motion(&self, asked: &MotionRequirement) -> JointMotion {
        let speed_m_s = self.max_speed_m_s.unwrap_or(asked.tip_speed_m_s);
        let has_brake = self.drive.as_ref().is_some_and(|drive| drive.has_brake);
        let motion = along_its_way(asked, speed_m_s).with_linear_reading(LinearReading::Exact);
        motion.of_joint(Some(speed_m_s), has_brake, None)
    }

    /// Deceleration of the joint in an emergency stop \[m/s²\], at least its acceleration in the ramps.
    pub(crate) fn stop_m_s2(&self, asked: &MotionRequirement) -> f64 {
        let motion = self.motion(asked);
        motion.acceleration_rad_s2 * motion.stop.factor
    }

    /// The joint with the stiffness of the screw or rack `gear`.
    pub(crate) fn driven_by(&self, gear: &Gear) -> Prismatic {
        Prismatic { stiffness_n_per_m: gear.single_slope_nm_per_rad(), ..self.joint.clone() }
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
