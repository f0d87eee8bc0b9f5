//! One measured number of a campaign, and the poses that data are grouped by.

use crate::arm::effect::channel::Channel;

/// One measured number.
#[derive(Debug, Clone, PartialEq)]
pub struct Datum {
    /// Channel.
    pub channel: Channel,
    /// Row of its file, from 0.
    pub row: usize,
    /// Component 0-2 of a vector.
    pub component: usize,
    /// Index of the pose. Data of one pose are held out together.
    pub group: usize,
    /// Measured value, in the unit of the file.
    pub value: f64,
    /// Its standard deviation, in the unit of the file.
    pub sigma: f64,
}

/// The group of a pose. A pose that was not seen before starts a new group.
pub(crate) fn group_of(pose_deg: &[f64], groups: &mut Vec<(Vec<f64>, String)>) -> usize {
    if let Some(found) = groups.iter().position(|(p, _)| p == pose_deg) {
        return found;
    }
    let name = pose_deg.iter().map(|a| format!("{a}")).collect::<Vec<_>>().join(",");
    groups.push((pose_deg.to_vec(), name));
    groups.len() - 1
}
