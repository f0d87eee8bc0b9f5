//! Positions of one arm from several campaigns. Between two campaigns the instrument is usually set up again and the
//! reflector put back, so that each campaign has a frame of its own.

use super::align;
use super::analysis::samples;
use super::fitted::Sample;
use super::kinematics::Geometry;
use super::points::points;
use super::tree::Tree;
use crate::arm::BASE;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::declared::DeclaredSession;
use nalgebra::{Rotation3, Vector3};
use std::ops::Range;

/// The campaign with all positions in the frame of the first of the campaigns that were joined. A session is declared
/// at the first row of each later campaign, for everything that `campaign.json` leaves free: the placement of the base
/// and the place of each point. `None` if all positions are from one campaign.
pub(crate) fn in_one_frame(campaign: &Campaign) -> Option<Campaign> {
    let firsts: Vec<usize> =
        campaign.joined_at.iter().copied().filter(|at| (1..campaign.positions.len()).contains(at)).collect();
    if firsts.is_empty() {
        return None;
    }
    let mut out = campaign.clone();
    let ends = firsts.iter().skip(1).copied().chain([campaign.positions.len()]);
    let spec = campaign.statement.positions.clone();
    let setups: Vec<Range<usize>> = firsts.iter().copied().zip(ends).map(|(from, to)| from..to).collect();
    for rows in setups {
        if spec.base_placement {
            out.declare(rows.start, BASE);
            out.bring_into_frame(rows.clone());
        }
        if spec.tool_offset {
            let mut names: Vec<String> =
                campaign.positions[rows.clone()].iter().map(|r| r.point.clone()).collect();
            names.sort_unstable();
            names.dedup();
            names.iter().for_each(|name| out.declare(rows.start, name));
        }
    }
    Some(out)
}

impl Campaign {
    fn declare(&mut self, first: usize, moved: &str) {
        let session = DeclaredSession { from_row: first + 1, moved: moved.into() };
        let declared = &mut self.statement.positions.sessions;
        if !declared.contains(&session) {
            declared.push(session);
        }
    }

    /// Expresses the positions of the rows `later` in the frame of the rows before them. The nominal arm is fitted to
    /// the rows of both frames, which gives the rotation and the shift between the frames. The session that begins at
    /// the rows `later` corrects the remaining error. If a coordinate of some row was not measured, nothing changes.
    fn bring_into_frame(&mut self, later: Range<usize>) {
        if self.positions[..later.end].iter().any(|row| row.measured.iter().any(Option::is_none)) {
            return;
        }
        let [(turn, origin_m), (own_turn, own_origin_m)] =
            [0..later.start, later.clone()].map(|rows| self.standing(rows));
        let back = turn * own_turn.inverse();
        let shift_mm = 1e3 * (origin_m - back * own_origin_m);
        for row in &mut self.positions[later.clone()] {
            let at_mm = Vector3::from(row.measured.map(|read| read.map_or(0.0, |read| read.value_mm)));
            let moved_mm: [f64; 3] = (back * at_mm + shift_mm).into();
            for (read, value_mm) in row.measured.iter_mut().flatten().zip(moved_mm) {
                read.value_mm = value_mm;
            }
        }
        self.remarks.push(format!(
            "positions from row {} on are of another campaign: they are turned by {:.2} deg and moved by {:.1} mm into the \
             frame of the first, and the base has a placement of its own in them",
            later.start + 1,
            back.angle().to_degrees(),
            shift_mm.norm()
        ));
    }

    /// Rotation and origin \[m\] of the nominal arm's base in the frame of the rows `rows`.
    fn standing(&self, rows: Range<usize>) -> (Rotation3<f64>, Vector3<f64>) {
        let (tree, points) = (Tree::new(self), points(self));
        let mut geometry = Geometry::nominal(&tree, points.len());
        let all = samples(self, &tree, &geometry, &[], &points);
        let own: Vec<Sample> = all.into_iter().filter(|sample| rows.contains(&sample.index)).collect();
        align::align(&tree, &self.statement.positions, &own, &mut geometry);
        (geometry.base, geometry.origin_m)
    }
}
