//! Computes the numbers of a box as intervals, part by part from the tip inward.
//!
//! A box is a set of designs, given by one node of the tree of options at each level. A level is the choice of one tube
//! or drive. An interval has the least and the greatest value over the designs of the box.

use super::bearing_rows::Numbers;
use super::box_work::BoxWork;
use super::interval::interval;
use super::parts::{DriveBox, HEAT_ROUNDING, LeastDemand, LinkBox, Rays};
use super::problem::{Ladder, Lever, Part, Problem, Room};
use super::tree::{Bounds, Tree};
use crate::mechanics::link_stress::von_mises;
use crate::sizing::bearing::BearingDemand;
use crate::sizing::demand::JointDemand;
use crate::sizing::fit::LinkRoom;
use crate::space::slot::SizedJoint;

/// Relative margin for rounding of a sum of a few dozen terms.
pub(super) const ROUNDING: f64 = 1e-12;
/// Greatest depth to which a tree of drives is searched for drives that cannot carry a demand.
const MOST_TREE_STEPS: usize = 6;

/// The loads that the drive of a joint carries: the least and the greatest value over the members of a box.
struct Loads {
    /// Static torque \[N m\]: its magnitude in the sizing case in which it is greatest.
    static_nm: [f64; 2],
    /// Inertia of everything outboard about the joint's axis \[kg m²\], in the sizing case in which it is greatest.
    inertia_kgm2: [f64; 2],
}

impl Problem<'_> {
    /// Computes every interval of a box, part by part from the tip inward, and writes it to `work`. Each node of
    /// `design_box` is replaced by the smallest node that contains all options which can carry the least load. `None`
    /// if a level has no option left, or if even the least material cost exceeds the limit.
    pub(super) fn fill(&self, design_box: &mut [u32], work: &mut BoxWork) -> Option<()> {
        work.clear(self.parts.len(), self.poses.len());
        let mut level = 0;
        let mut cost_eur = 0.0;
        for (piece, part) in self.parts.iter().enumerate() {
            match part {
                Part::Given { mass_kg, curve } => work.joint(self, piece, [*mass_kg; 2], *curve, [0.0; 2]),
                Part::Drives { sized, tree, rays, .. } => {
                    self.fill_drives(piece, sized, tree, rays, &mut design_box[level], work)?;
                    level += 1;
                }
                Part::FirstFit { sized, ladder } => self.fill_first_fit(piece, sized, ladder, work)?,
                Part::Links { length_m, tree } => {
                    let node = &mut design_box[level];
                    level += 1;
                    self.fill_links(piece, *length_m, tree, node, work)?;
                    cost_eur += tree.node(*node).bounds.cost_eur_per_m * length_m;
                    let max = self.space.constraints.material_cost_max_eur;
                    if max.is_some_and(|max| cost_eur * (1.0 - ROUNDING) > max) {
                        return None;
                    }
                }
                Part::Tube { length_m, tube } => work.tube(self, piece, *length_m, tube),
                Part::Offset { mass_kg } => {
                    work.masses[piece] = [*mass_kg; 2];
                }
            }
        }
        Some(())
    }

    /// Reduces the drives of a joint to the drives that may carry the least demand, and writes the intervals over them
    /// to `work`. `node` is the node of the joint's tree; it is replaced by a smaller node if that contains all these
    /// drives. `None` if no drive may carry the demand.
    fn fill_drives(
        &self,
        piece: usize,
        sized: &SizedJoint,
        tree: &Tree<DriveBox>,
        rays: &Rays,
        node: &mut u32,
        work: &mut BoxWork,
    ) -> Option<()> {
        let Loads { static_nm, inertia_kgm2 } = self.loads(piece, work);
        let bearing = self.bearing_loads(piece, work);
        let motion = sized.table.motion();
        let [narrowest, widest] = self.room(piece, work);
        let least = LeastDemand::new(motion, rays, static_nm[0], inertia_kgm2[0], bearing[0], widest);
        *node = tree.smallest_node(*node, |drives| drives.may_hold(&least))?;
        let drives = feasible_drives(tree, *node, &least, MOST_TREE_STEPS)?;
        work.joint(self, piece, drives.mass_kg, drives.curve, drives.tilt_rad_per_nm);
        work.breaks[piece] = drives.breaks;
        work.least_demands[piece] = Some(least);
        let most = motion.demand(static_nm[1], inertia_kgm2[1]).with_bearing(bearing[1]).with_room(narrowest);
        work.greatest_demands[piece] = Some(most.with_heat_times(1.0 + HEAT_ROUNDING));
        Some(())
    }

    /// Writes the intervals of a joint that takes the lightest drive which carries its demand (first fit). They extend
    /// over all drives from the first fit of the least demand to the first fit of the greatest demand. `None` if no
    /// drive carries the least demand.
    fn fill_first_fit(
        &self,
        piece: usize,
        sized: &SizedJoint,
        ladder: &Ladder,
        work: &mut BoxWork,
    ) -> Option<()> {
        let Loads { static_nm, inertia_kgm2 } = self.loads(piece, work);
        let bearing = self.bearing_loads(piece, work);
        let [narrowest, widest] = self.room(piece, work);
        let room = [widest, narrowest];
        let demand = |i: usize, heat: f64| {
            let demand = sized.table.motion().demand(static_nm[i], inertia_kgm2[i]);
            demand.with_bearing(bearing[i]).with_room(room[i]).with_heat_times(heat)
        };
        let (least, most) = (demand(0, 1.0 - HEAT_ROUNDING), demand(1, 1.0 + HEAT_ROUNDING));
        let step = |demand: &JointDemand| {
            let fit = sized.table.first_fit(demand)? as u32;
            sized.table.first_fit_candidates().binary_search(&fit).ok()
        };
        let first = step(&least)?;
        // If no drive carries the greatest demand, some member may still have the heaviest drive as its first fit.
        let last = step(&most).unwrap_or(ladder.len() - 1);
        let DriveBox { mass_kg, curve, tilt_rad_per_nm, .. } = ladder.run(first, last);
        work.joint(self, piece, mass_kg, curve, tilt_rad_per_nm);
        Some(())
    }

    /// Reduces the options of a link to the options that may carry the least stress, and writes the intervals over them
    /// to `work`. `node` is the node of the link's tree; it is replaced by a smaller node if that contains all these
    /// options. `None` if no option may carry the stress.
    fn fill_links(
        &self,
        piece: usize,
        length_m: f64,
        tree: &Tree<LinkBox>,
        node: &mut u32,
        work: &mut BoxWork,
    ) -> Option<()> {
        work.tube(self, piece, length_m, &tree.node(*node).bounds);
        while let Some(safety) = self.space.constraints.stress_safety_factor_min {
            let loads = self.least_loads(piece, safety, work);
            let smaller = tree.smallest_node(*node, |links| loads.iter().all(|l| stress_holds(links, l)))?;
            if smaller == *node {
                break;
            }
            // The remaining options are heavier, and a link carries its own weight, so the loads are computed
            // again.
            *node = smaller;
            work.tube(self, piece, length_m, &tree.node(smaller).bounds);
        }
        Some(())
    }

    /// The static torque and the inertia that the drive of a joint carries, each in the sizing case in which it is
    /// greatest.
    fn loads(&self, piece: usize, work: &BoxWork) -> Loads {
        let (mut static_nm, mut inertia_kgm2) = ([0.0f64; 2], [0.0f64; 2]);
        for (pose, weights) in self.poses.iter().zip(&work.weights).filter(|(p, _)| p.sizing) {
            let Some(row) = &pose.inertia_about[piece] else { continue };
            let [low, high] = pose.torque(piece, weights);
            static_nm[0] = static_nm[0].max(low.max(-high).max(0.0));
            static_nm[1] = static_nm[1].max(high.max(-low));
            for (bound, lines) in inertia_kgm2.iter_mut().zip([&work.light, &work.heavy]) {
                let of = row.per_line.iter().zip(lines);
                let chosen: f64 = of.map(|(c, l)| c.iter().zip(l).map(|(c, l)| c * l).sum::<f64>()).sum();
                *bound = bound.max(row.fixed + chosen);
            }
        }
        let rounded = |[least, most]: [f64; 2]| [least * (1.0 - ROUNDING), most * (1.0 + ROUNDING)];
        Loads { static_nm: rounded(static_nm), inertia_kgm2: rounded(inertia_kgm2) }
    }

    /// The least and the greatest loads on the output bearing of a joint, over the sizing cases; zero if this bearing
    /// is not checked.
    pub(super) fn bearing_loads(&self, piece: usize, work: &BoxWork) -> [BearingDemand; 2] {
        let Some(lever) = self.levers[piece] else { return [BearingDemand::default(); 2] };
        let cases = self.poses.iter().zip(&work.weights);
        let [least, most] = cases
            .filter_map(|(pose, weights_n)| {
                let numbers = Numbers { weights_n, light: &work.light, heavy: &work.heavy };
                Some(pose.bearings[piece].as_ref()?.loads(&numbers))
            })
            .fold([BearingDemand::default(); 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        let lever_m = match lever {
            Lever::Given(lever_m) => [lever_m; 2],
            Lever::OfLink(link) => work.levers[link],
        };
        [
            least.with_lever(lever_m[0]).scaled(1.0 - ROUNDING),
            most.with_lever(lever_m[1]).scaled(1.0 + ROUNDING),
        ]
    }

    /// The least and the greatest space that the link outboard of a joint leaves for the joint's gear and motor.
    fn room(&self, piece: usize, work: &BoxWork) -> [LinkRoom; 2] {
        match self.rooms[piece] {
            None => [LinkRoom::ANY; 2],
            Some(Room::Given(room)) => [room; 2],
            Some(Room::OfLink(link)) => work.rooms[link],
        }
    }

    /// The least loads on each end section of a tube in each case: axial force \[N\], moments about y and z and
    /// torsion \[N m\]. They are multiplied by `safety`, the safety factor, and in sizing cases also by the peak
    /// factor, so that they can be compared with the strength.
    fn least_loads(&self, piece: usize, safety: f64, work: &BoxWork) -> Vec<[f64; 4]> {
        let cases = self.poses.iter().zip(&work.weights);
        cases
            .flat_map(|(pose, weights)| {
                let peak = if pose.sizing { self.peak_factor } else { 1.0 };
                let factor = peak * safety * (1.0 - ROUNDING);
                pose.stress.iter().filter(|s| s.piece == piece).map(move |row| {
                    row.loads.each_ref().map(|(fixed, per_n)| {
                        let [low, high] = interval(*fixed, per_n, weights);
                        low.max(-high).max(0.0) * factor
                    })
                })
            })
            .collect()
    }
}

/// The box around the drives below `node` that may carry the demand `asked`. The function goes at most `depth` steps
/// down the tree. Drives that it excludes in these steps do not widen the box. `None` if no drive may carry the
/// demand.
fn feasible_drives(tree: &Tree<DriveBox>, node: u32, asked: &LeastDemand, depth: usize) -> Option<DriveBox> {
    let drives = &tree.node(node).bounds;
    if !drives.may_hold(asked) {
        return None;
    }
    let (Some([a, b]), false) = (tree.children(node), depth == 0 || drives.least_limits.hold(&asked.demand))
    else {
        return Some(drives.clone());
    };
    match (feasible_drives(tree, a, asked, depth - 1), feasible_drives(tree, b, asked, depth - 1)) {
        (Some(a), Some(b)) => Some(a.join(&b)),
        (one, other) => one.or(other),
    }
}

/// Whether some option of the box may carry `load`: axial force \[N\], moments about y and z and torsion \[N m\].
fn stress_holds(links: &LinkBox, load: &[f64; 4]) -> bool {
    let [axial, y, z, torsion]: [f64; 4] = std::array::from_fn(|k| load[k] * links.stress[k]);
    // In a section that is not round, the two bending stresses add up at one edge of the section.
    let bending = if links.round { libm::hypot(y, z) } else { y + z };
    von_mises(axial + bending, torsion) <= 1.0
}
