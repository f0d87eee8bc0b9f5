//! Rows that bound mass, deflection and mode of a box's members together.
//!
//! A box is a set of designs, its members. The bound of a box takes every part at its lightest *and* at its stiffest,
//! but a part is one or the other. A row is a linear inequality. The rows below are sums of one number for each part,
//! so lightness and stiffness are traded part by part:
//!
//! - *mass*: the sum of the masses. It is exact.
//! - *displacement of the tip* in a case, along a fixed direction: the twists of the gears, each at a torque of its
//!   own, and the deflections of tubes and bearings. A product of the force `F` and the compliance `c` of a tube or a
//!   bearing is replaced by `F₀ c + c₀ (F - F₀)`, where `F₀` and `c₀` are the least values in the box (McCormick's
//!   envelope). The error is at most the product of the widths of the two intervals.
//! - *torque of a gear*: the torque at which its curve is evaluated, minus the torque that the weights outboard cause.
//!   For a member the difference is zero, so this row is exact.
//! - *mode*: `λ xᵀMx - xᵀKx` for a trial shape `x`. It is not positive for a member whose eigenvalues are at least `λ`.
//!   The error is about the square of the shape's error.
//!
//! For a member below a [`LocalUpperBound`] each row has an upper limit. With multipliers that are not
//! negative, the weighted sum of the rows then has an upper limit too. This is the Lagrangian relaxation of the region;
//! [`lagrangian`](super::lagrangian) minimizes the sum.

use super::bound::{BoxBound, DesignBox, START_SHAPES};
use super::box_work::BoxWork;
use super::drives_by_curve::{FeasibleDrives, PricedDrives};
use super::dual_price::Gear;
use super::incumbents::BETTER_BY;
use super::local_upper_bounds::LocalUpperBound;
use super::parts::{INERTIAS, STIFFNESSES};
use super::pose::Row;
use super::problem::{Part, Problem};
use super::shape::Shape;
use super::tip_row::TipRow;

/// Relative margin by which incumbents (designs found already) are made worse before a region is bounded by them. It is
/// larger than the relative amount by which an incumbent must be better to dominate, and than the difference below
/// which objectives count as equal.
pub(super) const DOMINANCE_MARGIN: f64 = 2.0 * BETTER_BY;
/// Margin for the rounding of sums whose terms are about 1.
pub(super) const ROUNDING: f64 = 1e-9;

/// Multipliers, trial shapes and feasible drives of the parent box, from which the search for multipliers starts.
#[derive(Clone, Default)]
pub(super) struct WarmStart {
    /// Multipliers of the mass row, of the tip rows and of the mode rows. Every box computes its own multipliers for
    /// torque rows.
    pub multipliers: Vec<f64>,
    /// Trial shapes (motions that bound the lowest mode): for each judged case (a case that counts for deflection and
    /// lowest mode), one for each starting acceleration.
    pub shapes: Vec<Shape>,
    /// The feasible drives of each level; `None` for a level of links.
    drives: Vec<Option<FeasibleDrives>>,
}

impl WarmStart {
    /// The warm start of the box of all designs: no multipliers, and the box's own trial shapes.
    pub(super) fn new(shapes: &[Shape]) -> Self {
        Self { multipliers: Vec::new(), shapes: shapes.to_vec(), drives: Vec::new() }
    }
}

/// The rows of a box: linear inequalities in the numbers of the parts. Every member below a local upper bound satisfies
/// them.
pub(super) struct Rows<'a> {
    pub problem: &'a Problem<'a>,
    pub work: &'a BoxWork,
    /// The scale of each row (inequality): the row's values divided by its scale are about 1.
    pub scale: Vec<f64>,
    /// The constant term of each row, divided by the scale. It does not depend on any choice.
    pub fixed: Vec<f64>,
    /// For each judged case, the row (inequality) on the displacement of the tip.
    pub tips: Vec<TipRow>,
    /// The gears that are not rigid, listed by judged case: the gears of the first judged case come first.
    pub gears: Vec<Gear>,
    /// The generalized forces to which rows set a least and a greatest value. Each has two rows.
    pub forces: Vec<Force<'a>>,
    /// Eigenvalue `λ` for which the mode rows are made \[1/s²\].
    pub lambda: f64,
    /// The trial shapes (motions of the arm) whose Rayleigh quotients bound the modes. Each has one row.
    pub modes: Vec<Mode>,
    /// Index of the first mode row.
    pub first_mode: usize,
    /// The feasible drives of each level; `None` for a level of links.
    drives: Vec<Option<FeasibleDrives>>,
    /// The feasible drives of each level with the states that their gears may have in this box; `None` for a level of
    /// links.
    pub priced: Vec<Option<PricedDrives>>,
}

/// A generalized force that the weights cause in a judged case. It has two rows, one for its least and one for its
/// greatest value.
pub(super) struct Force<'a> {
    /// Index of the case among the judged cases (those that count for deflection and lowest mode).
    pub judged: usize,
    /// For each piece, tip first: the force \[N or N m\] per newton of the weight of the piece.
    pub per_n: &'a [f64],
    /// Index of the first of the two rows.
    pub row: usize,
}

/// A trial shape (motion of the arm) that bounds the modes in a judged case, with what is needed to make its row.
pub(super) struct Mode {
    /// Index of the case among the judged cases.
    pub judged: usize,
    /// Index of the starting acceleration from which the shape came.
    pub start: usize,
    pub shape: Shape,
    /// `xᵀMx` of the shape (twice its kinetic energy per squared angular frequency), with the lightest and with the
    /// heaviest parts of the box. Each includes the payload and the bodies that the study gives.
    pub kinetic: [f64; 2],
}

/// A minimizer of the weighted sum of rows over a box. It need not be a member of the box. The torques at which its
/// gears are evaluated need not agree with its weights, and its node of a level may stand for several options.
pub(super) struct RelaxedDesign {
    /// The node of each level, in that level's tree of options.
    pub design_box: DesignBox,
    /// The value of every row, divided by the row's scale.
    pub values: Vec<f64>,
    /// For each piece, the amount that it adds to each row on mass, tip displacement and torque. The amounts are not
    /// divided by the scales.
    pub adds: Vec<f64>,
    /// Line inertias of each piece.
    pub inertia: Vec<[f64; INERTIAS]>,
    /// Weight of each piece in each judged case \[N\], at the index [`place`](Self::place).
    pub weights_n: Vec<f64>,
    /// Stiffnesses of each piece in each judged case, at the index [`place`](Self::place).
    pub stiffness: Vec<[f64; STIFFNESSES]>,
    /// `xᵀMx` of each trial shape, including the payload and the bodies that the study gives.
    pub kinetic: Vec<f64>,
}

impl RelaxedDesign {
    /// The index of `piece` in the lists that have one number for each judged case and each piece.
    pub(super) fn place(&self, judged: usize, piece: usize) -> usize {
        judged * self.inertia.len() + piece
    }

    /// Weight of each piece in a judged case \[N\].
    pub(super) fn weights_in(&self, judged: usize) -> &[f64] {
        &self.weights_n[self.place(judged, 0)..self.place(judged + 1, 0)]
    }

    /// Stiffnesses of each piece, tip first, in the judged case with index `judged`.
    pub(super) fn stiffness_in(&self, judged: usize) -> &[[f64; STIFFNESSES]] {
        &self.stiffness[self.place(judged, 0)..self.place(judged + 1, 0)]
    }
}

/// A point of the dual function: the multipliers of all rows, the least weighted sum `least` over the box, and in
/// `levels` the amount that each level adds to this sum.
pub(super) struct DualPoint {
    pub multipliers: Vec<f64>,
    /// Eigenvalue for which the mode rows were made \[1/s²\].
    pub lambda: f64,
    pub least: f64,
    pub levels: Vec<f64>,
}

impl Problem<'_> {
    /// The drives of each level of a box that carry the least demand; `None` for a level of links. `before` has the
    /// drives of the parent box, which are reused if they are the same.
    fn drives_of_levels(
        &self,
        design_box: &[u32],
        work: &BoxWork,
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
    /// Makes the rows (inequalities) of a box for the local upper bound `upper`. `work` has the intervals of the box,
    /// and `warm_start` the shapes and drives of the parent box.
    pub(super) fn new(
        problem: &'a Problem,
        design_box: &[u32],
        box_bound: &BoxBound,
        upper: &LocalUpperBound,
        warm_start: &WarmStart,
        work: &'a BoxWork,
    ) -> Self {
        // If `λ` is far below the modes of the box, the mode rows exclude nothing. The local upper bound may ask for no
        // mode at all; half the box's bound is then taken.
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
            // A local upper bound may be infinite. With a scale far above its values, a row would have no influence in
            // the game.
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
            rows.push_mode(place / START_SHAPES.len(), place % START_SHAPES.len(), shape.clone());
        }
        rows
    }

    /// The feasible drives of each level with the states that their gears may have in the box; `None` for a level of
    /// links.
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
                    // The slope may change within the interval of torque. The gear is then evaluated at a torque of its
                    // own, which two rows force to equal the torque that the weights cause.
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

    /// Adds two rows for each force bound of a judged case: one for the lower and one for the upper limit of the force.
    /// No rows are added for the torque of a gear that has two rows already.
    fn push_force_bounds(&mut self, judged: usize, case: usize) {
        let (problem, work) = (self.problem, self.work);
        for bound in problem.force_bounds.iter().filter(|bound| bound.case == case) {
            let row = &problem.poses[case].rows[bound.row];
            let is_free =
                |gear: &Gear| gear.piece == row.piece && gear.row.is_some() && work.curve(row).is_some();
            // If the bounded force is the torque of a gear with two rows, these rows restrict it already. Any other
            // force needs rows of its own.
            if !self.gears.iter().any(is_free) {
                let between = work.forces[case][bound.row];
                self.push_force(judged, row, between, between);
            }
        }
    }

    /// Index of the first of the two rows of the gear at `piece` in a judged case. `None` if the slope of the gear
    /// cannot change, so that it has no such rows.
    pub(super) fn free_gear(&self, judged: usize, piece: usize) -> Option<usize> {
        self.gears.iter().find(|gear| gear.judged == judged && gear.piece == piece)?.row
    }

    /// Adds a row with the scale `scale` and the constant term `fixed`. The term is divided by the scale.
    fn push(&mut self, scale: f64, fixed: f64) {
        self.scale.push(scale);
        self.fixed.push(fixed / scale);
    }

    /// Adds the two rows of a generalized force. The first is the force's least value less the force that the weights
    /// cause, the second is this force less its greatest value. `between` are the least and the greatest value. The
    /// scale of the rows is taken from the interval from `low` to `high`. Returns the index of the first row.
    fn push_force(&mut self, judged: usize, row: &'a Row, [low, high]: [f64; 2], between: [f64; 2]) -> usize {
        let next = self.scale.len();
        // The scale stays comparable to the scale of other rows even if the interval is narrow.
        let scale = (high - low).max(0.1 * low.abs().max(high.abs())).max(f64::MIN_POSITIVE);
        self.push(scale, between[0] - row.fixed);
        self.push(scale, row.fixed - between[1]);
        self.forces.push(Force { judged, per_n: &row.per_n, row: next });
        next
    }

    /// Adds the row of the trial shape `shape`, which bounds the modes in a judged case. `start` is the index of the
    /// starting acceleration from which the shape came.
    pub(super) fn push_mode(&mut self, judged: usize, start: usize, shape: Shape) {
        let kinetic = [&self.work.light, &self.work.heavy].map(|inertia| shape.kinetic_energy(inertia));
        // A shape without kinetic energy bounds nothing.
        let moves = if kinetic[0] > 0.0 { kinetic[0] } else { 1.0 };
        self.push(self.lambda * moves, self.lambda * shape.kinetic_fixed);
        self.modes.push(Mode { judged, start, shape, kinetic });
    }

    /// The multipliers with which the search for better multipliers starts. `above` are the multipliers of the parent
    /// box. Rows that the parent box did not have get equal multipliers.
    pub(super) fn starting_multipliers(&self, above: &[f64]) -> Vec<f64> {
        let mut multipliers = vec![0.0; self.scale.len()];
        let others: Vec<usize> = (0..=self.tips.len()).chain(self.first_mode..self.scale.len()).collect();
        // New rows have no multiplier from the parent. Equal multipliers are as good a guess as any.
        let even = 1.0 / others.len() as f64;
        for (k, row) in others.into_iter().enumerate() {
            multipliers[row] = above.get(k).copied().unwrap_or(even);
        }
        self.with_torques(multipliers)
    }

    /// Adds multipliers of the torque rows to `multipliers`. With them the price of a gear's twist grows with the
    /// torque that the weights make, by the least compliance of the box (McCormick). Without them a gear could be
    /// evaluated at any torque without raising the weighted sum.
    pub(super) fn with_torques(&self, mut multipliers: Vec<f64>) -> Vec<f64> {
        for gear in &self.gears {
            let Some(row) = gear.row else { continue };
            let tip = 1 + gear.judged;
            let per_twist = multipliers[tip] / self.scale[tip] * self.tips[gear.judged].joints[gear.piece];
            // The row in which the price rises with the torque that the weights cause.
            let at = if per_twist > 0.0 { row + 1 } else { row };
            multipliers[at] += per_twist.abs() * gear.least_compliance * self.scale[at];
        }
        multipliers
    }

    /// Saves the multipliers, the last trial shapes and the feasible drives for the halves of the box.
    pub(super) fn save_warm_start(&mut self, multipliers: &[f64], warm_start: &mut WarmStart) {
        let (tips, kept) = (self.tips.len(), warm_start.shapes.len());
        warm_start.drives = std::mem::take(&mut self.drives);
        warm_start.multipliers.clear();
        warm_start.multipliers.extend(&multipliers[..=tips]);
        warm_start.multipliers.resize(1 + tips + kept, 0.0);
        for (m, mode) in self.modes.drain(..).enumerate() {
            let place = mode.judged * START_SHAPES.len() + mode.start;
            warm_start.multipliers[1 + tips + place] += multipliers.get(self.first_mode + m).unwrap_or(&0.0);
            warm_start.shapes[place] = mode.shape;
        }
    }

    /// Makes the mode rows for another eigenvalue `lambda` \[1/s²\], and updates their values for the relaxed designs
    /// `members`.
    pub(super) fn set_lambda(&mut self, lambda: f64, members: &mut [RelaxedDesign]) {
        let more = lambda - self.lambda;
        for (m, mode) in self.modes.iter().enumerate() {
            let row = self.first_mode + m;
            self.fixed[row] += more * mode.shape.kinetic_fixed / self.scale[row];
            members
                .iter_mut()
                .for_each(|member| member.values[row] += more * member.kinetic[m] / self.scale[row]);
        }
        self.lambda = lambda;
    }

    /// The upper limit that each scaled row has for every member below the local upper bound `upper`. `lambda` is the
    /// eigenvalue for which the mode rows are made \[1/s²\].
    fn row_limits<'b>(&'b self, lambda: f64, upper: &'b LocalUpperBound) -> impl Iterator<Item = f64> + 'b {
        // The bound may ask for another eigenvalue. The difference times `xᵀMx` is bounded with the lightest or the
        // heaviest parts, depending on its sign.
        let below = lambda - upper.lambda();
        let objectives = std::iter::once(upper.mass_kg).chain(self.tips.iter().map(|_| upper.tip_m));
        let torques = (1 + self.tips.len()..self.first_mode).map(|_| 0.0);
        let modes = self.modes.iter().map(move |mode| below * mode.kinetic[usize::from(below > 0.0)]);
        objectives.chain(torques).chain(modes).zip(&self.scale).map(|(row, scale)| row / scale)
    }

    /// The upper limit that each scaled row has for every member below the local upper bound `upper`. The mode rows
    /// are taken for the present eigenvalue.
    pub(super) fn row_limits_now<'b>(&'b self, upper: &'b LocalUpperBound) -> impl Iterator<Item = f64> + 'b {
        self.row_limits(self.lambda, upper)
    }

    /// Sets of multipliers that use a single row. There is one for each row that has a finite limit for members below
    /// `upper`, except for torque rows.
    pub(super) fn single_row_multipliers(&self, upper: &LocalUpperBound) -> Vec<Vec<f64>> {
        let is_torque = |row: usize| (1 + self.tips.len()..self.first_mode).contains(&row);
        let rows =
            self.row_limits_now(upper).enumerate().filter(|(row, a)| a.is_finite() && !is_torque(*row));
        let single = |(row, _)| {
            let mut multipliers = vec![0.0; self.scale.len()];
            multipliers[row] = 1.0;
            self.with_torques(multipliers)
        };
        rows.map(single).collect()
    }

    /// The upper limit that the weighted sum of the rows has for every member below the local upper bound `upper`.
    pub(super) fn allowed_sum(&self, point: &DualPoint, upper: &LocalUpperBound) -> f64 {
        let pairs = point.multipliers.iter().zip(self.row_limits(point.lambda, upper));
        pairs.filter(|(w, _)| **w > 0.0).map(|(w, a)| w * a).sum()
    }
}
