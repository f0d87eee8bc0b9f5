//! Positions of points on several arms of one trunk, each loaded by the weight of all.

use super::kinematics::{Geometry, Placing};
use super::loads::sags;
use super::tree::Tree;
use crate::arm::effect::{Channel, Subject};
use crate::reconcile::campaign::Campaign;
use crate::reconcile::predict::Placed;
use nalgebra::Rotation3;

/// The positions that the campaign's arms would show \[mm\]; `subjects`: each arm with all of its effects.
pub fn predicted_mm(mut campaign: Campaign, arms: &[Placed], subjects: &[Subject]) -> Vec<[f64; 3]> {
    for row in &mut campaign.positions {
        row.payload = subjects[row.arm].payload(&row.payload);
    }
    let tree = Tree::new(&campaign);
    let names: Vec<(usize, &str)> = arms
        .iter()
        .enumerate()
        .flat_map(|(i, a)| a.placement.points_m.iter().map(move |(name, _)| (i, name.as_str())))
        .collect();
    let mut geometry = Geometry::nominal(&tree, names.len() + 1);
    let offsets = arms.iter().flat_map(|a| a.placement.points_m.iter().map(|(_, at_m)| *at_m));
    geometry.tools_m.iter_mut().zip(offsets).for_each(|(tool, at_m)| *tool = at_m);
    // the last point is the tip, for points that no placement has
    let point_of = |arm: usize, name: &str| names.iter().position(|known| *known == (arm, name));
    let points: Vec<usize> =
        campaign.positions.iter().map(|r| point_of(r.arm, &r.point).unwrap_or(names.len())).collect();
    let sags = sags(&campaign, &tree, &geometry, &[], &points);
    let rows = campaign.positions.iter().zip(&points).zip(sags);
    rows.map(|((row, &point), sag)| {
        let placement = &arms[row.arm].placement;
        let asked_rad: Vec<f64> = row.pose_deg.iter().map(|a| a.to_radians()).collect();
        let own_rad = subjects[row.arm].turned_rad(&tree.pose_of(row.arm, &asked_rad));
        let pose_rad = tree.with_pose_of(row.arm, &own_rad, &asked_rad);
        geometry.base = Rotation3::from_matrix_unchecked(placement.rotation);
        geometry.origin_m = placement.origin_m;
        let placing = Placing { arm: row.arm, pose_rad: &pose_rad, point, station: 0 };
        let at_m = geometry.place(placing, &[]).at_m + placement.rotation * sag.known_m;
        let reading = &subjects[row.arm].channels[Channel::Positions as usize];
        std::array::from_fn(|c| reading.of(1e3 * at_m[c], c, row.row))
    })
    .collect()
}
