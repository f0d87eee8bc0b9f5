//! Predicts positions of points on several arms of one trunk. The trunk is loaded by the weight of all arms.

use super::kinematics::{Geometry, Placing};
use super::loads::Loads;
use super::pose::Pose;
use super::tree::Tree;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::subject::Subject;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::placement::Placed;
use crate::reconcile::readings::placement::Stand;
use crate::reconcile::readings::rows::PositionRow;
use nalgebra::Rotation3;
use rayon::prelude::*;

/// Predicted position of each row of the campaign, in the instrument's frame \[mm\]. `arms` gives the placements of the
/// arms, and `subjects` gives each arm with all of its effects.
pub(crate) fn predicted_mm(mut campaign: Campaign, arms: &[Placed], subjects: &[Subject]) -> Vec<[f64; 3]> {
    for row in &mut campaign.positions {
        row.payload = subjects[row.arm].payload(&row.payload);
    }
    let tree = Tree::new(&campaign);
    let stands = |i: usize| arms[i].placement.stands(&campaign.positions);
    let stands: Vec<Vec<&Stand>> = (0..arms.len()).map(stands).collect();
    let mut geometry = Geometry::nominal(&tree, 0);
    let mut points = Vec::with_capacity(campaign.positions.len());
    for (i, row) in campaign.positions.iter().enumerate() {
        let tool_m = stands[row.arm][i].point_m(&row.point);
        let known = geometry.tools_m.iter().position(|at_m| *at_m == tool_m);
        points.push(known.unwrap_or(geometry.tools_m.len()));
        if known.is_none() {
            geometry.tools_m.push(tool_m);
        }
    }
    let loads = Loads::new(&campaign, &tree, &geometry, &[]);
    let displaced_m =
        |row: &PositionRow, point: usize| loads.known_m(row, point) + loads.second_order_m(row, point);
    let known_m: Vec<_> =
        campaign.positions.par_iter().zip(&points).map(|(row, &point)| displaced_m(row, point)).collect();
    let rows = campaign.positions.iter().zip(&points).zip(known_m);
    rows.enumerate()
        .map(|(i, ((row, &point), known_m))| {
            let stand = stands[row.arm][i];
            let asked_rad: Vec<f64> = row.pose_deg.iter().map(|a| a.to_radians()).collect();
            let own_rad = subjects[row.arm].turned_rad(&tree.pose_of(row.arm, &asked_rad));
            let pose = Pose::new(&tree.with_pose_of(row.arm, &own_rad, &asked_rad));
            geometry.base = Rotation3::from_matrix_unchecked(stand.rotation);
            geometry.origin_m = stand.origin_m;
            let placing = Placing { arm: row.arm, pose: &pose, point, station: 0 };
            let at_m = geometry.place_m(placing) + stand.rotation * known_m;
            let reading = &subjects[row.arm].channels[Channel::Positions as usize];
            std::array::from_fn(|c| reading.of(1e3 * at_m[c], c, row.row))
        })
        .collect()
}
