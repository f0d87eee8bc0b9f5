//! The choice of the level along which a box is halved.
//!
//! The bound of a box takes every part at its lightest and at its stiffest. A level is the choice of
//! one part. The score of a level is how much the bound would worsen if its part had middle numbers instead.
//! The middle mass is the geometric mean of the least and the greatest mass, and middle stiffnesses are such
//! means too. The level with the greatest score is halved.
//!
//! The bounds of the two halves would be a worse guide, because a box has to be halved several times before
//! its bound moves at all.

use super::bound::{START_SHAPES, linear_strain};
use super::box_work::BoxWork;
use super::parts::{INERTIAS, STIFFNESSES};
use super::problem::{Part, Problem};
use super::shape::{Shape, products};
use super::torsion::Torsion;

/// `√(high / low) - 1`: by which fraction the geometric mean of an interval exceeds its lower end. Zero if the interval
/// has no width or does not begin above zero.
fn middling(low: f64, high: f64) -> f64 {
    if low > 0.0 && high > low { (high / low).sqrt() - 1.0 } else { 0.0 }
}

impl Problem<'_> {
    /// The level (choice of one tube or drive) whose halving should improve the bound of the box most. `shapes` are the
    /// trial shapes of the box, which are motions that bound the lowest mode. `None` if every level has a single option
    /// left.
    pub(super) fn widest_level(
        &self,
        design_box: &[u32],
        shapes: &[Shape],
        work: &mut BoxWork,
    ) -> Option<usize> {
        self.weigh_tip(work);
        let (judged, start) = work.worst;
        let shape = &shapes[judged * START_SHAPES.len() + start];
        let case = self.judged_cases().nth(judged)?;
        let strain = products(&shape.strain, &work.stiff_in[case]);
        let kinetic = shape.kinetic_energy(&work.light);
        let mass_kg: f64 = work.masses.iter().map(|m| m[0]).sum();
        let softened = self.softened_by_torque(case, shape, strain, work);
        let mut best: Option<(f64, usize)> = None;
        for (level, &piece) in self.level_pieces.iter().enumerate() {
            if self.halves(design_box, level).is_none() {
                continue;
            }
            let (mut softer, mut heavier) = (softened[piece], 0.0);
            for k in 0..STIFFNESSES {
                let (soft, stiff) = match &work.curves[piece] {
                    Some(curve) if k == 0 => {
                        let most_nm = work.torques[case][piece][1];
                        (curve.softest(most_nm, most_nm), curve.stiffest(most_nm, most_nm))
                    }
                    _ => (work.soft[piece][k], work.stiff[piece][k]),
                };
                softer += shape.strain[piece][k] * stiff / strain * middling(soft, stiff);
            }
            for k in 0..INERTIAS {
                let (light, heavy) = (work.light[piece][k], work.heavy[piece][k]);
                heavier += shape.kinetic[piece][k] * light / kinetic * middling(light, heavy);
            }
            let [light, heavy] = work.masses[piece];
            let mass = light * middling(light, heavy) / mass_kg.max(f64::MIN_POSITIVE);
            // The frequency is the square root of the Rayleigh quotient, hence the factor of one half.
            let score = libm::log1p(mass)
                + libm::log1p(work.tip_growth[piece])
                + 0.5 * (libm::log1p(softer) + libm::log1p(heavier));
            if best.is_none_or(|(most, _)| score > most) {
                best = Some((score, level));
            }
        }
        best.map(|(_, level)| level)
    }

    /// For each piece, the relative fall of the Rayleigh quotient of `shape` if gears inboard had a middle stiffness.
    /// The bound takes the greatest slope of each gear's torsion curve that any torque of the box reaches. The torque
    /// is known only as an interval, because the weights outboard are intervals. The middle stiffness is the geometric
    /// mean of this slope and the slope at the least torque. The fall is divided among the pieces outboard in
    /// proportion to the width that their weights add to the interval of the torque. `strain` is twice the strain
    /// energy of the shape.
    fn softened_by_torque(&self, case: usize, shape: &Shape, strain: f64, work: &BoxWork) -> Vec<f64> {
        let mut softened = vec![0.0; self.parts.len()];
        let pose = &self.poses[case];
        for row in &pose.rows {
            let Some(curve) = work.curve(row) else { continue };
            let [least_nm, most_nm] = work.torques[case][row.piece];
            let (soft, stiff) = (curve.stiffest(least_nm, least_nm), curve.stiffest(least_nm, most_nm));
            if stiff <= soft {
                continue;
            }
            let part = shape.strain[row.piece][0] * stiff / strain * middling(soft, stiff);
            for (piece, (per_n, weight)) in row.per_n.iter().zip(&work.weights[case]).enumerate() {
                softened[piece] += part * (per_n * (weight[1] - weight[0])).abs() / (most_nm - least_nm);
            }
        }
        softened
    }

    /// Computes `work.tip_growth`: for each piece, the fraction by which the least tip deflection would grow if the
    /// piece had middle stiffnesses instead of its greatest ones. A middle stiffness is the geometric mean of the least
    /// and the greatest stiffness.
    fn weigh_tip(&self, work: &mut BoxWork) {
        work.tip_growth.clear();
        work.tip_growth.resize(self.parts.len(), 0.0);
        let Some((case, direction)) = work.worst_tip else { return };
        let pose = &self.poses[case];
        let mut total = 0.0;
        for (row, &force) in pose.rows.iter().zip(&work.forces[case]) {
            let (moved, softer) = match work.curve(row) {
                Some(curve) => {
                    let play = self.joint_plays[row.piece].as_ref();
                    let middle = |torsion: &Torsion| torsion.windup.k2_nm_per_rad;
                    (curve.twist(play, force), middling(middle(&curve.soft), middle(&curve.stiff)))
                }
                None => {
                    let (resisted, _) = pose.pieces[row.piece].resisted(row.coordinate);
                    let (soft, stiff) = (work.soft[row.piece][resisted], work.stiff[row.piece][resisted]);
                    (linear_strain(pose, row, force, work), middling(soft, stiff))
                }
            };
            // The tip need not move at all along a coordinate whose interval contains zero.
            let least = if moved[0] >= 0.0 { moved[0] } else { moved[1].min(0.0) };
            let part_m = direction.dot(&row.tip_m) * least;
            total += part_m;
            work.tip_growth[row.piece] += part_m.abs() * softer;
        }
        if total > 0.0 {
            work.tip_growth.iter_mut().for_each(|growth| *growth /= total);
        }
    }

    /// The two nodes into which a level of a box is halved. `None` if the level has a single option.
    pub(super) fn halves(&self, design_box: &[u32], level: usize) -> Option<[u32; 2]> {
        match &self.parts[self.level_pieces[level]] {
            Part::Drives { tree, .. } => tree.children(design_box[level]),
            Part::Links { tree, .. } => tree.children(design_box[level]),
            _ => None,
        }
    }
}
