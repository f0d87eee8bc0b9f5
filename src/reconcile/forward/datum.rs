//! One measured number of a campaign, and the grouping of the data by pose.

use crate::arm::effect::channel::Channel;
use crate::reconcile::readings::rows::pose_key;
use std::collections::HashMap;

/// One measured number.
#[derive(Debug, Clone, PartialEq)]
pub struct Datum {
    /// Channel of the reading.
    pub channel: Channel,
    /// Row in the file of the channel, from 0.
    pub row: usize,
    /// Index of the row in the campaign's list of readings of this channel, such as `Campaign::statics`, from 0.
    pub index: usize,
    /// Index of the component, 0 to 2, if the reading is a vector; 0 for a single value.
    pub component: usize,
    /// Index of the pose; `usize::MAX` for the bench, where there is no pose. Data of one pose are held out together.
    pub group: usize,
    /// Measured value, in the unit of the file.
    pub value: f64,
    /// Standard deviation of the value, in the unit of the file.
    pub sigma: f64,
}

/// The different poses of a campaign. The data of one pose form a group.
#[derive(Debug, Default)]
pub(crate) struct Groups {
    /// Names of the groups: the angles of each pose, separated by commas.
    pub names: Vec<String>,
    known: HashMap<Vec<u64>, usize>,
}

impl Groups {
    /// Index of the group of a pose, which is given by its joint positions. A pose that was not seen before starts a
    /// new group.
    pub(crate) fn of(&mut self, pose_deg: &[f64]) -> usize {
        *self.known.entry(pose_key(pose_deg)).or_insert_with(|| {
            self.names.push(pose_deg.iter().map(|a| format!("{a}")).collect::<Vec<_>>().join(","));
            self.names.len() - 1
        })
    }
}
