//! Rows that bound mass, deflection and mode of a box's members together.
//!
//! The bound of a box takes every part at its lightest *and* at its stiffest, but a part is one or the other.
//! The rows below are sums of one number for each part, so lightness and stiffness are traded part by part:
//!
//! | row | sum over the parts | what is lost |
//! |---|---|---|
//! | mass | exact | nothing |
//! | displacement of the tip in a case, along a fixed direction | twist of the gears, each at a torque of its own; `F₀ c + c₀ (F - F₀)` for the force `F` and the compliance `c` of a tube or a bearing, with `F₀` and `c₀` the least of the box (McCormick) | the product of the widths of `F` and `c` |
//! | torque of a gear | its own torque less the torque that the weights outboard make: zero | nothing |
//! | mode | `λ xᵀMx - xᵀKx` for a trial shape `x`: not positive for a member whose eigenvalues are at least `λ` | the square of the shape's error |
//!
//! For a member below a [`LocalUpperBound`] each row has an upper limit. With multipliers that are not
//! negative, the weighted sum of the rows then has one too. This is the Lagrangian relaxation of the region;
//! [`lagrangian`](super::lagrangian) minimizes the sum.

use super::bound::{BoxBound, DesignBox, STARTS};
use super::drives_by_curve::{FeasibleDrives, PricedDrives};
use super::dual_price::Gear;
use super::local_upper_bounds::LocalUpperBound;
use super::parts::{INERTIAS, STIFFNESSES};
use super::pose::Row;
use super::problem::{Part, Problem};
use super::shape::Shape;
use super::tip_row::TipRow;
use super::work::Work;

/// Relative amount by which an incumbent must be better to dominate. It is more than the difference below which
/// objectives count as equal.
pub(super) const DOMINANCE_MARGIN: f64 = 2e-7;
/// Rounding of sums whose terms are about 1.
pub(super) const ROUNDING: f64 = 1e-9;

/// Multipliers, trial shapes and feasible drives of the parent box, with which the search for multipliers starts.
#[derive(Clone, Default)]
pub(super) struct WarmStart {
    /// Multipliers of the mass, the tip rows and the modes. Every box makes its own for torque rows.
    pub multipliers: Vec<f64>,
    pub shapes: Vec<Shape>,
    /// The feasible drives of each level of drives.
    drives: Vec<Option<FeasibleDrives>>,
}

impl WarmStart {
    /// The warm start of the box of all designs: no multipliers, and the box's own trial shapes.
    pub(super) fn new(shapes: &[Shape]) -> Self {
        Self { multipliers: Vec::new(), shapes: shapes.to_vec(), drives: Vec::new() }
    }
}

/// The rows of a box: the inequalities that every member below a local upper bound satisfies.
pub(super) struct Rows<'a> {
    pub problem: &'a Problem<'a>,
    pub work: &'a Work,
    /// The scale of each row, which makes its values about 1.
    pub scale: Vec<f64>,
    /// The part of each row, scaled, that no choice changes.
    pub fixed: Vec<f64>,
    /// The displacement of the tip in each judged case.
    pub tips: Vec<TipRow>,
    /// For each judged case, the gears that yield.
    pub gears: Vec<Gear>,
    /// The forces that the bound has rows for, two rows for each force.
    pub forces: Vec<Force<'a>>,
    /// Eigenvalue at which the mode rows are taken \[1/s²\].
    pub lambda: f64,
    /// The trial shapes. Each has one row.
    pub modes: Vec<Mode>,
    /// Index of the first mode row.
    pub first_mode: usize,
    /// The feasible drives of each level; `None` for a level of links.
    drives: Vec<Option<FeasibleDrives>>,
    /// They with the states that their gears may have in this box.
    pub priced: Vec<Option<PricedDrives>>,
}

/// A force that the weights make in a judged case. It takes two rows, one for its least and one for its greatest
/// value.
pub(super) struct Force<'a> {
    pub judged: usize,
    pub per_n: &'a [f64],
    pub row: usize,
}

/// A trial shape that bounds the modes of a judged case.
pub(super) struct Mode {
    pub judged: usize,
    pub start: usize,
    pub shape: Shape,
    /// `xᵀMx` with the lightest and with the heaviest parts.
    pub kinetic: [f64; 2],
}

/// A minimizer of the weighted sum over a box. It need not be a member of the box: the torques of its gears need not
/// agree with its weights, and its node of a level may be a box of several options.
pub(super) struct RelaxedDesign {
    /// The node of each level.
    pub design_box: DesignBox,
    /// The scaled value of every row.
    pub values: Vec<f64>,
    /// For each piece, the amount that it adds to each row before the modes, unscaled.
    pub adds: Vec<f64>,
    /// Line inertias of each piece.
    pub inertia: Vec<[f64; INERTIAS]>,
    /// Weight of each piece in each judged case \[N\].
    pub weights_n: Vec<f64>,
    /// Stiffnesses of each piece in each judged case.
    pub stiffness: Vec<[f64; STIFFNESSES]>,
}

impl RelaxedDesign {
    /// The place of a piece in the lists that have a number for each judged case and each piece.
    pub(super) fn place(&self, judged: usize, piece: usize) -> usize {
        judged * self.inertia.len() + piece
    }

    /// Weight of each piece in a judged case \[N\].
    pub(super) fn weights_in(&self, judged: usize) -> &[f64] {
        &self.weights_n[self.place(judged, 0)..self.place(judged + 1, 0)]
    }

    /// Stiffnesses of each piece in a judged case.
    pub(super) fn stiffness_in(&self, judged: usize) -> &[[f64; STIFFNESSES]] {
        &self.stiffness[self.place(judged, 0)..self.place(judged + 1, 0)]
    }
}

/// A point of the dual function: the multipliers, the least weighted sum over the box, and the amount that each level
/// adds to this sum.
pub(super) struct DualPoint {
    pub multipliers: Vec<f64>,
    pub least: f64,
    pub levels: Vec<f64>,
}

impl Problem<'_> {
    /// The feasible drives of each level of a box; `None` for a level of links. `before` has those of the parent box.
    fn drives_of_levels(
        &self,
        design_box: &[u32],
        work: &Work,
        before: &[Option<FeasibleDrives>],
    ) -> Vec<Option<FeasibleDrives>> {
        let of = |(level, (&piece, &node)): (usize, (&usize, &u32))| {
            let Part::Drives { tree, .. } = &self.parts[piece] else { return None };
            let before = before.get(level).and_then(Option::as_ref);
            Some(FeasibleDrives::new(tree, node, work.least_demands[piece].as_ref(), before))
        };
        self.level_pieces.iter().zip(design_box).enumerate().map(of).collect()
    }
}

impl<'a> Rows<'a> {
    /// The rows of a box for a local upper bound. The numbers of the box are in `work`.
    pub(super) fn new(
        problem: &'a Problem,
        design_box: &[u32],
        box_bound: &BoxBound,
        upper: &LocalUpperBound,
        warm_start: &WarmStart,
        work: &'a Work,
    ) -> Self {
        // Far below the modes of the box the rows would say nothing, even if the local upper bound asks for
        // no mode. Half the box's bound keeps them informative.
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
            drives: problem.drives_of_levels(design_box, work, &warm_start.drives),
            priced: Vec::new(),
        };
        for (judged, case) in problem.judged_cases().enumerate() {
            let (tip, fixed_m) = TipRow::new(problem, judged, case, work);
            // A local upper bound may be infinite. A scale far above the values of the row would make the row
            // vanish in the game.
            let most = if box_bound.tip_m > 0.0 { 1e3 * box_bound.tip_m } else { 1.0 };
            let scale = upper.tip_m.min(most).max(f64::MIN_POSITIVE);
            rows.tips.push(tip);
            rows.push(scale, fixed_m);
        }
        for (judged, case) in problem.judged_cases().enumerate() {
            rows.push_gears(judged, case);
            rows.push_force_bounds(judged, case);
        }
        rows.first_mode = rows.scale.len();
        rows.priced = rows.priced_drives();
        for (place, shape) in warm_start.shapes.iter().enumerate() {
            rows.push_mode(place / STARTS.len(), place % STARTS.len(), shape.clone());
        }
        rows
    }

    /// The feasible drives of each level with the states of their gears.
    fn priced_drives(&self) -> Vec<Option<PricedDrives>> {
        let of = |(&piece, drives): (&usize, &Option<FeasibleDrives>)| {
            let gears: Vec<&Gear> = self.gears.iter().filter(|gear| gear.piece == piece).collect();
            let play = self.problem.joint_plays[piece].as_ref();
            drives.as_ref().map(|drives| PricedDrives::new(drives, &gears, play))
        };
        self.problem.level_pieces.iter().zip(&self.drives).map(of).collect()
    }

    /// Adds the gears of a judged case, with two rows for each gear whose slope may change.
    fn push_gears(&mut self, judged: usize, case: usize) {
        let (problem, work) = (self.problem, self.work);
        for (at, row) in problem.poses[case].rows.iter().enumerate() {
            let Some(curve) = work.curve(row) else { continue };
            let gear = match self.tips[judged].torques_nm[row.piece] {
                Some(torque_nm) => Gear::at(row.piece, judged, torque_nm),
                None => {
                    // The slope may change within the interval. The gear gets a torque of its own and two
                    // rows that hold it equal to that of the weights.
                    let [least_nm, most_nm] = work.torques[case][row.piece];
                    let compliance = 1.0 / curve.steepest(least_nm, most_nm);
                    let torques_nm = work.forces[case][at];
                    let next = self.push_force(judged, row, torques_nm, [0.0; 2]);
                    Gear::free(row.piece, judged, torques_nm, next, compliance)
                }
            };
            self.gears.push(gear);
        }
    }

    /// Adds two rows for each force bound of a judged case, unless the force is the torque of a gear that has rows
    /// already.
    fn push_force_bounds(&mut self, judged: usize, case: usize) {
        let (problem, work) = (self.problem, self.work);
        for bound in problem.force_bounds.iter().filter(|bound| bound.case == case) {
            let row = &problem.poses[case].rows[bound.row];
            let is_free =
                |gear: &Gear| gear.piece == row.piece && gear.row.is_some() && work.curve(row).is_some();
            // A bounded force that belongs to no such gear needs rows of its own. The gear's rows cover
            // it otherwise.
            if !self.gears.iter().any(is_free) {
                let between = work.forces[case][bound.row];
                self.push_force(judged, row, between, between);
            }
        }
    }

    /// Index of the first of the two rows of a gear whose slope may change in a case. `None` if the gear has a single
    /// slope.
    pub(super) fn free_gear(&self, judged: usize, piece: usize) -> Option<usize> {
        self.gears.iter().find(|gear| gear.judged == judged && gear.piece == piece)?.row
    }

    fn push(&mut self, scale: f64, fixed: f64) {
        self.scale.push(scale);
        self.fixed.push(fixed / scale);
    }

    /// Adds the two rows of a force: its least value less the force that the weights make, and this force less its
    /// greatest value.
    fn push_force(&mut self, judged: usize, row: &'a Row, [low, high]: [f64; 2], between: [f64; 2]) -> usize {
        let next = self.scale.len();
        // The scale stays comparable to that of the other rows however narrow the interval is.
        let scale = (high - low).max(0.1 * low.abs().max(high.abs())).max(f64::MIN_POSITIVE);
        self.push(scale, between[0] - row.fixed);
        self.push(scale, row.fixed - between[1]);
        self.forces.push(Force { judged, per_n: &row.per_n, row: next });
        next
    }

    pub(super) fn push_mode(&mut self, judged: usize, start: usize, shape: Shape) {
        let kinetic = [&self.work.light, &self.work.heavy].map(|inertia| shape.kinetic_energy(inertia));
        // A shape that moves nothing bounds nothing.
        let moves = if kinetic[0] > 0.0 { kinetic[0] } else { 1.0 };
        self.push(self.lambda * moves, self.lambda * shape.kinetic_fixed);
        self.modes.push(Mode { judged, start, shape, kinetic });
    }

    /// The multipliers of the parent box. Rows that the parent did not have get equal multipliers.
    pub(super) fn starting_multipliers(&self, above: &[f64]) -> Vec<f64> {
        let mut multipliers = vec![0.0; self.scale.len()];
        let others: Vec<usize> = (0..=self.tips.len()).chain(self.first_mode..self.scale.len()).collect();
        // New rows have no multiplier from the parent; equal ones are as good a guess as any.
        let even = 1.0 / others.len() as f64;
        for (k, row) in others.into_iter().enumerate() {
            multipliers[row] = above.get(k).copied().unwrap_or(even);
        }
        self.with_torques(multipliers)
    }

    /// Adds multipliers of torque rows. They make the twist of a gear grow with the torque of the weights, by the
    /// least compliance of the box (McCormick). Without them a gear could choose its torque at no price.
    pub(super) fn with_torques(&self, mut multipliers: Vec<f64>) -> Vec<f64> {
        for gear in &self.gears {
            let Some(row) = gear.row else { continue };
            let tip = 1 + gear.judged;
            let per_twist = multipliers[tip] / self.scale[tip] * self.tips[gear.judged].joints[gear.piece];
            // The row whose sign makes a larger torque dearer.
            let at = if per_twist > 0.0 { row + 1 } else { row };
            multipliers[at] += per_twist.abs() * gear.least_compliance * self.scale[at];
        }
        multipliers
    }

    /// Saves the multipliers, the last shapes and the feasible drives for the halves of the box.
    pub(super) fn save_warm_start(&mut self, multipliers: &[f64], warm_start: &mut WarmStart) {
        let (tips, kept) = (self.tips.len(), warm_start.shapes.len());
        warm_start.drives = std::mem::take(&mut self.drives);
        warm_start.multipliers.clear();
        warm_start.multipliers.extend(&multipliers[..=tips]);
        warm_start.multipliers.resize(1 + tips + kept, 0.0);
        for (m, mode) in self.modes.drain(..).enumerate() {
            let place = mode.judged * STARTS.len() + mode.start;
            warm_start.multipliers[1 + tips + place] += multipliers.get(self.first_mode + m).unwrap_or(&0.0);
            warm_start.shapes[place] = mode.shape;
        }
    }

    /// The upper limit of each scaled row for members below a local upper bound.
    pub(super) fn row_limits<'b>(&'b self, upper: &'b LocalUpperBound) -> impl Iterator<Item = f64> + 'b {
        // The rows are taken at `lambda`, the bound may ask for another eigenvalue. The difference times
        // `xᵀMx` is bounded by the lightest or the heaviest parts, depending on its sign.
        let below = self.lambda - upper.lambda();
        let objectives = std::iter::once(upper.mass_kg).chain(self.tips.iter().map(|_| upper.tip_m));
        let torques = (1 + self.tips.len()..self.first_mode).map(|_| 0.0);
        let modes = self.modes.iter().map(move |mode| below * mode.kinetic[usize::from(below > 0.0)]);
        objectives.chain(torques).chain(modes).zip(&self.scale).map(|(row, scale)| row / scale)
    }

    /// For each row with a limit, the multipliers that use this row alone.
    pub(super) fn single_row_multipliers(&self, upper: &LocalUpperBound) -> Vec<Vec<f64>> {
        let is_torque = |row: usize| (1 + self.tips.len()..self.first_mode).contains(&row);
        let rows = self.row_limits(upper).enumerate().filter(|(row, a)| a.is_finite() && !is_torque(*row));
        let single = |(row, _)| {
            let mut multipliers = vec![0.0; self.scale.len()];
            multipliers[row] = 1.0;
            self.with_torques(multipliers)
        };
        rows.map(single).collect()
    }

    /// The upper limit of the weighted sum for members below a local upper bound.
    pub(super) fn allowed_sum(&self, multipliers: &[f64], upper: &LocalUpperBound) -> f64 {
        let pairs = multipliers.iter().zip(self.row_limits(upper));
        pairs.filter(|(w, _)| **w > 0.0).map(|(w, a)| w * a).sum()
    }
}
