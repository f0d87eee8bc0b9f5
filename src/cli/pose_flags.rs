//! The pose of an arm on the command line: `--pose-deg` for an arm whose joints all turn, `--pose` for any arm.

use super::failure::Failure;
use super::values::{entries, number_list};
use crate::arm::pose::{DrivenJoint, any_slides, pose_of_keys};
use clap::Args;

/// Options that state a pose.
#[derive(Debug, Clone, Args)]
pub(super) struct PoseArgs {
    /// One angle per joint, base to tip [deg]; default all zero
    #[arg(long, value_name = "Q1,Q2,...", allow_hyphen_values = true, value_parser = pose)]
    pose_deg: Option<Pose>,
    /// Angles and travels by joint, each with its unit; default all zero. For arms with prismatic joints
    #[arg(long, value_name = "RAIL_mm=250,J2_deg=30,...", conflicts_with = "pose_deg", value_parser = pose_entries)]
    pose: Option<PoseEntries>,
}

#[derive(Debug, Clone)]
struct Pose(Vec<f64>);

fn pose(text: &str) -> Result<Pose, String> {
    number_list(text).map(Pose)
}

#[derive(Debug, Clone)]
struct PoseEntries(Vec<(String, f64)>);

fn pose_entries(text: &str) -> Result<PoseEntries, String> {
    entries(text).map(PoseEntries)
}

impl PoseArgs {
    /// Whether a pose is given.
    pub(super) fn is_given(&self) -> bool {
        self.pose.is_some() || self.pose_deg.is_some()
    }

    /// The entries of the pose \[deg, mm\], every joint at 0 by default.
    ///
    /// # Errors
    /// The options do not give a pose of the joints `driven`.
    pub(super) fn entries(&self, driven: &[DrivenJoint]) -> Result<Vec<f64>, Failure> {
        if let Some(PoseEntries(given)) = &self.pose {
            let given = given.iter().map(|(key, entry)| (key.as_str(), *entry));
            return pose_of_keys(driven, given).map_err(|(key, hint)| {
                Failure::Usage(format!("--pose: \"{key}\" is no entry of a pose: {hint}"))
            });
        }
        let Some(Pose(angles_deg)) = &self.pose_deg else { return Ok(vec![0.0; driven.len()]) };
        if any_slides(driven) {
            let keys: Vec<String> = driven.iter().map(|joint| format!("{}=0", joint.key())).collect();
            return Err(Failure::Usage(format!(
                "--pose-deg has angles, and the arm has prismatic joints: write --pose {} with your numbers",
                keys.join(",")
            )));
        }
        if angles_deg.len() != driven.len() {
            let names: Vec<&str> = driven.iter().map(|joint| joint.name.as_str()).collect();
            return Err(Failure::Usage(format!(
                "--pose-deg has {} angles, the arm has {} driven joints: {}",
                angles_deg.len(),
                driven.len(),
                names.join(", ")
            )));
        }
        Ok(angles_deg.clone())
    }
}
