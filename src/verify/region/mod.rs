//! Region by region: a front of a huge space is proved whole below one corner of what it leaves open after the other.
//!
//! Boxes take every part at its lightest and at its stiffest at once. A part is one or the other, and sums over the parts
//! that weigh mass, deflection and modes against each other know it ([`rows`]). Below a corner few options are of
//! any use: a weighting whose least over all members is close to what the corner allows excludes every option that costs
//! more than what is left ([`weigh`], reduced costs).
//!
//! The corners ([`corners`]) are the leaves of a tree, and a node's corner bounds those below. From the root on, at every
//! node, the options are narrowed as long as that pays. If none is left, or if a weighting refutes that any member is below
//! the corner, that part of the tree is done; else its two halves are looked at with the options left. Below a single
//! corner the options of a level, or a torque, are parted in two ([`part`]). What has few designs left is searched box by box.

pub(crate) mod corners;
pub(crate) mod game;
pub(crate) mod part;
pub(crate) mod price;
pub(crate) mod rows;
pub(crate) mod stock;
pub(crate) mod weigh;
pub(crate) mod zone;

use super::arm::{Arm, read};
use super::bound::Members;
use super::drives::Alike;
use super::search::{Found, Halt, Search, eigenvalue_of};
use super::staircase::Staircase;
use super::{By, Witness};
use crate::catalog::Catalogs;
use crate::pareto::objectives::Objectives;
use crate::space::design_space::DesignSpace;
pub(super) use corners::Corner;
use corners::Corners;
use part::Ways;
use rows::Rows;
use std::sync::Arc;
use stock::Stock;
use weigh::Left;
use zone::{Shape, Zone};

/// Part of the designs that must go for the options to be narrowed once more.
const WORTH_IT: f64 = 0.3;

/// A search of all regions beside a front.
pub(super) struct Regions<'s> {
    pub arm: Arc<Arm>,
    stock: Stock,
    front: &'s Staircase,
    /// Zones of no more designs are searched box by box.
    boxes_to: f64,
    halt: &'s Halt<'s>,
}

/// Looks for designs beside the rows of a front; rows closer than `apart` (relative) may stand for each other.
pub(super) fn explore(
    space: &DesignSpace,
    catalogs: &Catalogs,
    (rows, front): (&[Objectives], &Staircase),
    by: By,
    halt: &Halt,
) -> Found {
    let (arm, parts) = read(space, catalogs, Alike::Together);
    let limits = &arm.constraints;
    let room = 1.0 + super::bound::ROUNDING;
    let limit = Corner {
        mass_kg: limits.mass_max_kg.map_or(f64::INFINITY, |most| most * room),
        tip_m: limits.tip_deflection_max_m.map_or(f64::INFINITY, |most| most * room),
        hz: arm.required_hz(),
    };
    let corners = Corners::new(rows, limit, by.apart);
    let (arm, stock) = (Arc::new(arm), Stock::new(parts));
    let Some(zone) = Zone::whole(&stock) else { return Found::default() };
    let regions = Regions { arm, stock, front, boxes_to: by.boxes_to, halt };
    regions.explore(&corners, 0, zone)
}

/// What came of narrowing a zone.
enum Narrowed {
    /// No member is below the corner.
    Refuted,
    Few,
    Many(Ways),
    Stopped,
}

impl Regions<'_> {
    /// Looks below a node of the tree of corners.
    fn explore(&self, corners: &Corners, at: usize, mut zone: Zone) -> Found {
        let Some((corner, halves)) = corners.node(at) else { return Found::default() };
        let mut found = Found::default();
        let ways = match self.narrow(&mut zone, corner, &mut found.boxes) {
            Narrowed::Refuted => return found,
            Narrowed::Stopped => return Found { open: 1, ..found },
            Narrowed::Few => return found.with(self.explore_boxes(&zone, corner)),
            Narrowed::Many(ways) => ways,
        };
        let zones = match halves {
            Some(_) => Some([zone.clone(), zone.clone()]),
            None => ways.halves(&self.stock, &zone),
        };
        let Some([a, b]) = zones else { return found.with(self.explore_boxes(&zone, corner)) };
        let [first, second] = halves.unwrap_or([at; 2]);
        let (a, b) = rayon::join(|| self.explore(corners, first, a), || self.explore(corners, second, b));
        found.with(a).with(b)
    }

    /// Narrows the options of a zone as long as that pays.
    fn narrow(&self, zone: &mut Zone, corner: Corner, regions: &mut u64) -> Narrowed {
        loop {
            if self.halt.stopped() {
                return Narrowed::Stopped;
            }
            *regions += 1;
            let before = zone.designs(&self.stock);
            let Some(ways) = self.narrow_once(zone, corner) else { return Narrowed::Refuted };
            let left = zone.designs(&self.stock);
            if left <= self.boxes_to {
                return Narrowed::Few;
            }
            if left > (1.0 - WORTH_IT) * before {
                return Narrowed::Many(ways);
            }
        }
    }

    /// Leaves out what no member below a corner has, and says where to part the rest; `None` if no member is left.
    fn narrow_once(&self, zone: &mut Zone, corner: Corner) -> Option<Ways> {
        let tubes = zone.tube_ranges(&self.stock);
        let members = zone.hold(&self.arm, &self.stock, &tubes)?;
        let ceiling = self.arm.ceiling(&members)?;
        if !corner.is_in_reach_of(&ceiling) {
            return None;
        }
        let beaten_hz = self.front.beaten_up_to_hz(ceiling.mass_kg, ceiling.tip_m);
        self.stiffest_shapes(zone, &members, corner.hz.max(beaten_hz))?;
        let mut rows = Rows::new(&self.arm, &self.stock, zone, &members, corner);
        if rows.rows.is_empty() {
            return Some(Ways::default());
        }
        let left = rows.left(zone)?;
        let partings = rows.partings(&members, &left);
        let Left { joints, tubes: kept, weights, .. } = left;
        let curves = std::mem::take(&mut rows.curves);
        let (others, of_modes) = weights.split_at(rows.first_mode);
        zone.shapes = rows
            .modes
            .into_iter()
            .zip(of_modes)
            .map(|((case, motion), &weight)| Shape { case, motion, weight })
            .collect();
        zone.keep_shapes(rows.columns.cases);
        zone.weights = others[..rows.first_held].to_vec();
        (zone.joints, zone.tubes) = (joints, kept);
        Some(Ways { partings, curves })
    }

    /// Begins with the lowest mode of the stiffest arm where a zone has no shape; `None` if that is too slow.
    fn stiffest_shapes(&self, zone: &mut Zone, members: &Members, hz: f64) -> Option<()> {
        let eigenvalue = eigenvalue_of(hz);
        if !eigenvalue.is_finite() {
            return None;
        }
        for (case, pose) in self.arm.poses.iter().filter(|pose| pose.judged).enumerate() {
            let pencil = self.arm.pencil(pose, members);
            let factor = pencil.factor(eigenvalue)?;
            if eigenvalue > 0.0 && zone.shapes.iter().all(|shape| shape.case != case) {
                zone.shapes.push(Shape { case, motion: pencil.lowest_mode(&factor), weight: 0.0 });
            }
        }
        Some(())
    }

    /// Searches the designs left box by box.
    fn explore_boxes(&self, zone: &Zone, corner: Corner) -> Found {
        let witness = Witness::of(Arc::clone(&self.arm), zone.parts(&self.stock));
        let search = Search { witness: &witness, front: self.front, corner, halt: self.halt };
        witness.root().map_or_else(Found::default, |root| search.explore(&root))
    }
}
