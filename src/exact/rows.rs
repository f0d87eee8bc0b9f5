//! What no arm of a box can have at once: lightness and stiffness, traded part by part.
//!
//! The ceiling of a box takes every part at its lightest *and* at its stiffest; a part has one or the other.
//! Here mass, tip deflection and lowest mode of every member are bounded together, by sums over the parts:
//!
//! | row | sum over the parts | left out |
//! |---|---|---|
//! | mass | exact | |
//! | way of the tip in a case | twists of the gears, each at a torque of its own; `F₀ c + c₀ (F - F₀)` for force `F` and compliance `c` of a tube, `F₀` and `c₀` the least of the box (McCormick) | product of the widths of `F` and `c` |
//! | torque of a gear | its own, less what the weights outboard make of it: zero | |
//! | mode | `λ xᵀMx - xᵀKx`, not positive for a member whose modes are above `λ`, whatever the shape `x` | the square of the shape's error |
//!
//! A member below a [`Corner`] of the region that no design found beats has each row below what the corner
//! allows. So has every weighted sum of rows with weights that are not negative; and the least such sum of any
//! member is found part by part. If it is more than the corner allows, no member is below the corner. Weights
//! are the best for the members found so far (a matrix game), shapes those of an arm in between them.

use super::bound::{BoxBound, DesignBox, STARTS};
use super::drives_by_curve::DrivesByCurve;
use super::dual_price::Gear;
use super::local_upper_bounds::LocalUpperBound;
use super::parts::{INERTIAS, STIFFNESSES};
use super::pose::Row;
use super::problem::{Part, Problem};
use super::shape::Shape;
use super::tip_row::TipRow;
use super::work::Work;

/// By how much a member must be beaten in every objective, at least: more than what counts as equal.
pub(super) const BEATEN: f64 = 2e-7;
/// Rounding of sums whose terms are about one.
pub(super) const ROUNDING: f64 = 1e-9;
/// Where the search for weights starts: what served the box above.
#[derive(Clone, Default)]
pub(super) struct WarmStart {
    /// Of mass, ways of the tip and modes; torques have their own in every box.
    pub multipliers: Vec<f64>,
    pub shapes: Vec<Shape>,
}

impl WarmStart {
    /// For the box of everything: even weights, its own shapes.
    pub fn new(shapes: &[Shape]) -> Self {
        Self { multipliers: Vec::new(), shapes: shapes.to_vec() }
    }
}

/// The rows of a box.
pub(super) struct Rows<'a> {
    pub problem: &'a Problem<'a>,
    pub work: &'a Work,
    /// What each row is divided by, so that it is about one, and what no part changes.
    pub scale: Vec<f64>,
    pub fixed: Vec<f64>,
    pub tips: Vec<TipRow>,
    pub gears: Vec<Gear>,
    pub forces: Vec<Force<'a>>,
    /// Square of the frequency at which the modes are taken \[1/s²\].
    pub lambda: f64,
    pub modes: Vec<Mode>,
    pub first_mode: usize,
    /// The drives of each level that hold; none of a level of links.
    pub drives: Vec<DrivesByCurve>,
}

/// A force that weights make in a judged case: less of it in a row, more of it in the next.
pub(super) struct Force<'a> {
    pub judged: usize,
    pub per_n: &'a [f64],
    pub row: usize,
}

/// A shape whose quotient bounds the modes of a judged case.
pub(super) struct Mode {
    pub judged: usize,
    pub start: usize,
    pub shape: Shape,
    /// `xᵀMx` of the lightest and of the heaviest parts.
    pub kinetic: [f64; 2],
}

/// A member of the box, or what stands for it in the sums: its gears need not agree with its weights.
pub(super) struct RelaxedDesign {
    /// Its node of each level.
    pub design_box: DesignBox,
    /// Every row of it, and what each piece adds to those before the modes.
    pub values: Vec<f64>,
    pub adds: Vec<Vec<f64>>,
    /// Inertia of each piece; its weight \[N\] and its stiffness in each judged case.
    pub inertia: Vec<[f64; INERTIAS]>,
    pub weights_n: Vec<Vec<f64>>,
    pub stiffness: Vec<Vec<[f64; STIFFNESSES]>>,
}

/// A weighting, the least weighted sum of any member, and what each level adds to it.
pub(super) struct DualPoint {
    pub multipliers: Vec<f64>,
    pub least: f64,
    pub levels: Vec<f64>,
}

impl Problem<'_> {
    /// The drives of each level of a box that hold, those of a level of links none.
    fn drives_by_curve(&self, design_box: &[u32], work: &Work) -> Vec<DrivesByCurve> {
        let of = |(&piece, &node): (&usize, &u32)| match &self.parts[piece] {
            Part::Drives { tree, .. } => DrivesByCurve::new(tree, node, work.least_demands[piece].as_ref()),
            _ => DrivesByCurve::default(),
        };
        self.level_pieces.iter().zip(design_box).map(of).collect()
    }
}

impl<'a> Rows<'a> {
    pub fn new(
        problem: &'a Problem,
        design_box: &[u32],
        box_bound: &BoxBound,
        upper: &LocalUpperBound,
        shapes: &[Shape],
        work: &'a Work,
    ) -> Self {
        let hz = upper.hz.max(0.5 * box_bound.hz.min(1e6));
        let mut rows = Self {
            problem,
            work,
            scale: vec![box_bound.mass_kg.max(f64::MIN_POSITIVE)],
            fixed: vec![0.0],
            tips: Vec::new(),
            gears: Vec::new(),
            forces: Vec::new(),
            lambda: (hz * std::f64::consts::TAU).powi(2),
            modes: Vec::new(),
            first_mode: 0,
            drives: problem.drives_by_curve(design_box, work),
        };
        for (judged, case) in problem.judged_cases().enumerate() {
            let (tip, fixed_m) = TipRow::new(problem, judged, case, work);
            let most = if box_bound.tip_m > 0.0 { 1e3 * box_bound.tip_m } else { 1.0 };
            let scale = upper.tip_m.min(most).max(f64::MIN_POSITIVE);
            rows.tips.push(tip);
            rows.push(scale, fixed_m);
        }
        for (judged, case) in problem.judged_cases().enumerate() {
            for (at, row) in problem.poses[case].rows.iter().enumerate() {
                let Some(curve) = &work.curves[row.piece] else { continue };
                let gear = match rows.tips[judged].torques_nm[row.piece] {
                    Some(torque_nm) => Gear::at(row.piece, judged, torque_nm),
                    None => {
                        let [least_nm, most_nm] = work.torques[case][row.piece];
                        let compliance = 1.0 / curve.steepest(least_nm, most_nm);
                        let torques_nm = work.forces[case][at];
                        let next = rows.push_force(judged, row, torques_nm, [0.0; 2]);
                        Gear::free(row.piece, judged, torques_nm, next, compliance)
                    }
                };
                rows.gears.push(gear);
            }
            for bound in problem.force_bounds.iter().filter(|bound| bound.case == case) {
                let row = &problem.poses[case].rows[bound.row];
                let is_free = |gear: &Gear| gear.piece == row.piece && gear.row.is_some();
                if !rows.gears.iter().any(is_free) {
                    let between = work.forces[case][bound.row];
                    rows.push_force(judged, row, between, between);
                }
            }
        }
        rows.first_mode = rows.scale.len();
        for (place, shape) in shapes.iter().enumerate() {
            rows.push_mode(place / STARTS.len(), place % STARTS.len(), shape.clone());
        }
        rows
    }

    /// The first of the rows of a gear that may leave its segment.
    pub fn free_gear(&self, judged: usize, piece: usize) -> Option<usize> {
        self.gears.iter().find(|gear| gear.judged == judged && gear.piece == piece)?.row
    }

    fn push(&mut self, scale: f64, fixed: f64) {
        self.scale.push(scale);
        self.fixed.push(fixed / scale);
    }

    /// Adds the rows of a force: the least it may be less what the weights make, and that less the most.
    fn push_force(&mut self, judged: usize, row: &'a Row, [low, high]: [f64; 2], between: [f64; 2]) -> usize {
        let next = self.scale.len();
        // in proportion to the other rows, however close the bounds are
        let scale = (high - low).max(0.1 * low.abs().max(high.abs())).max(f64::MIN_POSITIVE);
        self.push(scale, between[0] - row.fixed);
        self.push(scale, row.fixed - between[1]);
        self.forces.push(Force { judged, per_n: &row.per_n, row: next });
        next
    }

    pub fn push_mode(&mut self, judged: usize, start: usize, shape: Shape) {
        let kinetic = [&self.work.light, &self.work.heavy].map(|inertia| shape.kinetic_energy(inertia));
        // a shape that moves nothing says nothing
        let moves = if kinetic[0] > 0.0 { kinetic[0] } else { 1.0 };
        self.push(self.lambda * moves, self.lambda * shape.kinetic_fixed);
        self.modes.push(Mode { judged, start, shape, kinetic });
    }

    /// The weights of the box above, for the rows of this one; even ones if there are none.
    pub fn starting_multipliers(&self, above: &[f64]) -> Vec<f64> {
        let mut multipliers = vec![0.0; self.scale.len()];
        let others: Vec<usize> = (0..=self.tips.len()).chain(self.first_mode..self.scale.len()).collect();
        let even = 1.0 / others.len() as f64;
        for (k, row) in others.into_iter().enumerate() {
            multipliers[row] = above.get(k).copied().unwrap_or(even);
        }
        self.with_torques(multipliers)
    }

    /// Weights by which the twist of a gear grows with the torque that the weights make on it, as fast as any gear of
    /// the box does at least (McCormick); without them it would be free to choose a torque.
    pub fn with_torques(&self, mut multipliers: Vec<f64>) -> Vec<f64> {
        for gear in &self.gears {
            let Some(row) = gear.row else { continue };
            let tip = 1 + gear.judged;
            let per_twist = multipliers[tip] / self.scale[tip] * self.tips[gear.judged].joints[gear.piece];
            let at = if per_twist > 0.0 { row + 1 } else { row };
            multipliers[at] += per_twist.abs() * gear.least_compliance * self.scale[at];
        }
        multipliers
    }

    /// Leaves the weights and the last shapes to the halves of the box.
    pub fn save_warm_start(&mut self, multipliers: &[f64], warm_start: &mut WarmStart) {
        let (tips, kept) = (self.tips.len(), warm_start.shapes.len());
        warm_start.multipliers.clear();
        warm_start.multipliers.extend(&multipliers[..=tips]);
        warm_start.multipliers.resize(1 + tips + kept, 0.0);
        for (m, mode) in self.modes.drain(..).enumerate() {
            let place = mode.judged * STARTS.len() + mode.start;
            warm_start.multipliers[1 + tips + place] += multipliers.get(self.first_mode + m).unwrap_or(&0.0);
            warm_start.shapes[place] = mode.shape;
        }
    }

    /// What each row of a member below a corner is at most.
    pub fn row_limits<'b>(&'b self, upper: &'b LocalUpperBound) -> impl Iterator<Item = f64> + 'b {
        let below = self.lambda - upper.lambda();
        let objectives = std::iter::once(upper.mass_kg).chain(self.tips.iter().map(|_| upper.tip_m));
        let torques = (1 + self.tips.len()..self.first_mode).map(|_| 0.0);
        let modes = self.modes.iter().map(move |mode| below * mode.kinetic[usize::from(below > 0.0)]);
        objectives.chain(torques).chain(modes).zip(&self.scale).map(|(row, scale)| row / scale)
    }

    /// Every row by itself of which a corner allows no more than a number.
    pub fn single_row_multipliers(&self, upper: &LocalUpperBound) -> Vec<Vec<f64>> {
        let is_torque = |row: usize| (1 + self.tips.len()..self.first_mode).contains(&row);
        let rows = self.row_limits(upper).enumerate().filter(|(row, a)| a.is_finite() && !is_torque(*row));
        let single = |(row, _)| {
            let mut multipliers = vec![0.0; self.scale.len()];
            multipliers[row] = 1.0;
            self.with_torques(multipliers)
        };
        rows.map(single).collect()
    }

    /// The weighted sum that a corner allows.
    pub fn allowed_sum(&self, multipliers: &[f64], upper: &LocalUpperBound) -> f64 {
        let pairs = multipliers.iter().zip(self.row_limits(upper));
        pairs.filter(|(w, _)| **w > 0.0).map(|(w, a)| w * a).sum()
    }
}
