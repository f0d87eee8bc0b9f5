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

use super::bound::{Ceiling, Cell, STARTS, Work};
use super::by_curve::ByCurve;
use super::corners::Corner;
use super::game::{Game, solve};
use super::parts::{INERTIAS, LinkBox, STIFFNESSES, inertia};
use super::pose::Row;
use super::price::{Gear, JointPrice, Price, cheapest};
use super::problem::{Part, Problem};
use super::shape::{Ideal, Shape, dot, products};
use super::tip::Tip;
use super::torsion::CurveBox;

/// By how much a member must be beaten in every objective, at least: more than what counts as equal.
pub(super) const BEATEN: f64 = 2e-7;
/// Rounding of sums whose terms are about one.
pub(super) const ROUNDING: f64 = 1e-9;
/// Steps towards the mode of an arm in between.
const STEPS: usize = 3;

/// Where the search for weights starts: what served the box above.
#[derive(Clone, Default)]
pub(super) struct Trade {
    /// Of mass, ways of the tip and modes; torques have their own in every box.
    pub weights: Vec<f64>,
    pub shapes: Vec<Shape>,
}

impl Trade {
    /// For the box of everything: even weights, its own shapes.
    pub fn new(shapes: &[Shape]) -> Self {
        Self { weights: Vec::new(), shapes: shapes.to_vec() }
    }
}

/// The rows of a box.
pub(super) struct Rows<'a> {
    pub problem: &'a Problem<'a>,
    pub work: &'a Work,
    /// What each row is divided by, so that it is about one, and what no part changes.
    pub scale: Vec<f64>,
    fixed: Vec<f64>,
    pub tips: Vec<Tip>,
    gears: Vec<Gear>,
    forces: Vec<Force<'a>>,
    /// Square of the frequency at which the modes are taken \[1/s²\].
    lambda: f64,
    modes: Vec<Mode>,
    first_mode: usize,
    /// The drives of each level that hold; none of a level of links.
    drives: Vec<ByCurve>,
}

/// A force that weights make in a judged case: less of it in a row, more of it in the next.
struct Force<'a> {
    judged: usize,
    per_n: &'a [f64],
    row: usize,
}

/// A shape whose quotient bounds the modes of a judged case.
struct Mode {
    judged: usize,
    start: usize,
    shape: Shape,
    /// `xᵀMx` of the lightest and of the heaviest parts.
    kinetic: [f64; 2],
}

/// A member of the box, or what stands for it in the sums: its gears need not agree with its weights.
pub(super) struct Member {
    /// Its node of each level.
    pub cell: Cell,
    /// Every row of it, and what each piece adds to those before the modes.
    pub values: Vec<f64>,
    adds: Vec<Vec<f64>>,
    /// Inertia of each piece; its weight \[N\] and its stiffness in each judged case.
    inertia: Vec<[f64; INERTIAS]>,
    pub weights_n: Vec<Vec<f64>>,
    pub stiffness: Vec<Vec<[f64; STIFFNESSES]>>,
}

/// Stiffness and inertia of each piece.
type Arm = (Vec<[f64; STIFFNESSES]>, Vec<[f64; INERTIAS]>);

/// A weighting, the least weighted sum of any member, and what each level adds to it.
pub(super) struct Plane {
    pub weights: Vec<f64>,
    pub least: f64,
    pub levels: Vec<f64>,
}

impl Problem<'_> {
    /// The drives of each level of a box that hold, those of a level of links none.
    fn drives_by_curve(&self, cell: &[u32], work: &Work) -> Vec<ByCurve> {
        let of = |(&piece, &node): (&usize, &u32)| match &self.parts[piece] {
            Part::Drives { tree, .. } => ByCurve::new(tree, node, work.least[piece].as_ref()),
            _ => ByCurve::default(),
        };
        self.level_pieces.iter().zip(cell).map(of).collect()
    }

    /// Mass per line mass of a piece: a tube's length, one for anything else.
    fn length_m(&self, piece: usize) -> f64 {
        match &self.parts[piece] {
            Part::Links { length_m, .. } | Part::Tube { length_m, .. } => *length_m,
            _ => 1.0,
        }
    }
}

impl<'a> Rows<'a> {
    pub(super) fn new(
        problem: &'a Problem,
        cell: &[u32],
        ceiling: &Ceiling,
        corner: &Corner,
        shapes: &[Shape],
        work: &'a Work,
    ) -> Self {
        let hz = corner.hz.max(0.5 * ceiling.hz.min(1e6));
        let mut rows = Self {
            problem,
            work,
            scale: vec![ceiling.mass_kg.max(f64::MIN_POSITIVE)],
            fixed: vec![0.0],
            tips: Vec::new(),
            gears: Vec::new(),
            forces: Vec::new(),
            lambda: (hz * std::f64::consts::TAU).powi(2),
            modes: Vec::new(),
            first_mode: 0,
            drives: problem.drives_by_curve(cell, work),
        };
        for (judged, case) in problem.judged_cases().enumerate() {
            let (tip, fixed_m) = Tip::new(problem, judged, case, work);
            let most = if ceiling.tip_m > 0.0 { 1e3 * ceiling.tip_m } else { 1.0 };
            let scale = corner.tip_m.min(most).max(f64::MIN_POSITIVE);
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
            for held in problem.held.iter().filter(|held| held.case == case) {
                let row = &problem.poses[case].rows[held.row];
                let is_free = |gear: &Gear| gear.piece == row.piece && gear.row.is_some();
                if !rows.gears.iter().any(is_free) {
                    let between = work.forces[case][held.row];
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

    fn push_mode(&mut self, judged: usize, start: usize, shape: Shape) {
        let kinetic = [&self.work.light, &self.work.heavy].map(|inertia| shape.kinetic_energy(inertia));
        // a shape that moves nothing says nothing
        let moves = if kinetic[0] > 0.0 { kinetic[0] } else { 1.0 };
        self.push(self.lambda * moves, self.lambda * shape.kinetic_fixed);
        self.modes.push(Mode { judged, start, shape, kinetic });
    }

    /// The weights of the box above, for the rows of this one; even ones if there are none.
    pub(super) fn inherited(&self, above: &[f64]) -> Vec<f64> {
        let mut weights = vec![0.0; self.scale.len()];
        let others: Vec<usize> = (0..=self.tips.len()).chain(self.first_mode..self.scale.len()).collect();
        let even = 1.0 / others.len() as f64;
        for (k, row) in others.into_iter().enumerate() {
            weights[row] = above.get(k).copied().unwrap_or(even);
        }
        self.with_torques(weights)
    }

    /// Weights by which the twist of a gear grows with the torque that the weights make on it, as fast as any gear of
    /// the box does at least (McCormick); without them it would be free to choose a torque.
    fn with_torques(&self, mut weights: Vec<f64>) -> Vec<f64> {
        for gear in &self.gears {
            let Some(row) = gear.row else { continue };
            let tip = 1 + gear.judged;
            let per_twist = weights[tip] / self.scale[tip] * self.tips[gear.judged].joints[gear.piece];
            let at = if per_twist > 0.0 { row + 1 } else { row };
            weights[at] += per_twist.abs() * gear.least_compliance * self.scale[at];
        }
        weights
    }

    /// Leaves the weights and the last shapes to the halves of the box.
    pub(super) fn bequeath(&mut self, weights: &[f64], trade: &mut Trade) {
        let (tips, kept) = (self.tips.len(), trade.shapes.len());
        trade.weights.clear();
        trade.weights.extend(&weights[..=tips]);
        trade.weights.resize(1 + tips + kept, 0.0);
        for (m, mode) in self.modes.drain(..).enumerate() {
            let place = mode.judged * STARTS.len() + mode.start;
            trade.weights[1 + tips + place] += weights.get(self.first_mode + m).unwrap_or(&0.0);
            trade.shapes[place] = mode.shape;
        }
    }

    /// What each row of a member below a corner is at most.
    fn allowed<'b>(&'b self, corner: &'b Corner) -> impl Iterator<Item = f64> + 'b {
        let below = self.lambda - corner.lambda();
        let objectives = std::iter::once(corner.mass_kg).chain(self.tips.iter().map(|_| corner.tip_m));
        let torques = (1 + self.tips.len()..self.first_mode).map(|_| 0.0);
        let modes = self.modes.iter().map(move |mode| below * mode.kinetic[usize::from(below > 0.0)]);
        objectives.chain(torques).chain(modes).zip(&self.scale).map(|(row, scale)| row / scale)
    }

    /// Every row by itself of which a corner allows no more than a number.
    pub(super) fn singles(&self, corner: &Corner) -> Vec<Vec<f64>> {
        let is_torque = |row: usize| (1 + self.tips.len()..self.first_mode).contains(&row);
        let rows = self.allowed(corner).enumerate().filter(|(row, a)| a.is_finite() && !is_torque(*row));
        let single = |(row, _)| {
            let mut weights = vec![0.0; self.scale.len()];
            weights[row] = 1.0;
            self.with_torques(weights)
        };
        rows.map(single).collect()
    }

    /// The weighted sum that a corner allows.
    pub(super) fn weighted(&self, weights: &[f64], corner: &Corner) -> f64 {
        let pairs = weights.iter().zip(self.allowed(corner));
        pairs.filter(|(w, _)| **w > 0.0).map(|(w, a)| w * a).sum()
    }

    /// The weights that raise the worst of some members furthest above a corner.
    pub(super) fn game(&self, members: &[Member], corner: &Corner) -> Game {
        /// A row this far below what is allowed has no say.
        const NO_SAY: f64 = -10.0;
        let allowed: Vec<f64> = self.allowed(corner).collect();
        let above = |member: &Member| -> Vec<f64> {
            member.values.iter().zip(&allowed).map(|(v, a)| (v - a).max(NO_SAY)).collect()
        };
        // what a force is does not count among what is to be kept low
        let balanced = 1 + self.tips.len()..self.first_mode;
        solve(&members.iter().flat_map(above).collect::<Vec<f64>>(), allowed.len(), balanced)
    }

    /// Adds the modes of the arm in between some members, where they lie below a corner's; whether any does.
    pub(super) fn separate(&mut self, members: &mut [Member], mix: &[f64], corner: &Corner) -> bool {
        let lambda = corner.lambda();
        let before = self.modes.len();
        for (judged, case) in self.problem.judged_cases().enumerate() {
            let (stiffness, inertia) = self.in_between(members, mix, judged);
            let ideal = Ideal { stiffness: &stiffness, inertia: &inertia };
            let mut room = super::shape::Work::default();
            let mut shapes: Vec<Shape> = Vec::new();
            for start in 0..STARTS.len() {
                let last = self.modes.iter().rfind(|m| m.judged == judged && m.start == start);
                let Some(mut shape) = last.map(|mode| mode.shape.clone()) else { continue };
                for _ in 0..STEPS {
                    shape.improve(&self.problem.poses[case], &ideal, &shapes, &mut room);
                }
                shapes.push(shape);
            }
            for (start, shape) in shapes.into_iter().enumerate() {
                if shape.quotient(&ideal) < lambda * (1.0 - 1e-6) {
                    self.push_mode(judged, start, shape);
                }
            }
        }
        for member in members {
            for mode in &self.modes[before..] {
                let row = member.values.len();
                let value = self.mode_value(mode, member) / self.scale[row] + self.fixed[row];
                member.values.push(value);
            }
        }
        self.modes.len() > before
    }

    /// Stiffness and inertia of the arm in between some members in a case.
    fn in_between(&self, members: &[Member], mix: &[f64], judged: usize) -> Arm {
        let pieces = self.problem.parts.len();
        let mut arm = (vec![[0.0; STIFFNESSES]; pieces], vec![[0.0; INERTIAS]; pieces]);
        for (member, share) in members.iter().zip(mix).filter(|(_, share)| **share > 0.0) {
            let pairs = arm.0.iter_mut().zip(&member.stiffness[judged]);
            let pairs = pairs.chain(arm.1.iter_mut().zip(&member.inertia));
            pairs.for_each(|(sum, x)| sum.iter_mut().zip(x).for_each(|(sum, x)| *sum += share * x));
        }
        arm
    }

    /// The least weighted sum of any member, and the member that has it.
    pub(super) fn least(&self, cell: &[u32], weights: Vec<f64>) -> (Plane, Member) {
        let pieces = self.problem.parts.len();
        let mut total: f64 = weights.iter().zip(&self.fixed).map(|(w, f)| w * f).sum();
        let mut levels = Vec::with_capacity(cell.len());
        let mut member = Member {
            cell: cell.to_vec(),
            adds: Vec::with_capacity(pieces),
            weights_n: vec![vec![0.0; pieces]; self.tips.len()],
            values: vec![0.0; self.scale.len()],
            inertia: vec![[0.0; INERTIAS]; pieces],
            stiffness: vec![vec![[0.0; STIFFNESSES]; pieces]; self.tips.len()],
        };
        for (piece, part) in self.problem.parts.iter().enumerate() {
            let level = levels.len();
            let price = || self.price(piece, &weights);
            let before = member.values[..self.first_mode].to_vec();
            total += match part {
                Part::Drives { tree, .. } => {
                    let price = price();
                    let cheapest = self.drives[level].cheapest(&price);
                    let (least, at) = cheapest.unwrap_or((f64::INFINITY, cell[level]));
                    member.cell[level] = at;
                    levels.push(least);
                    let drives = &tree.node(at).bounds;
                    self.add_joint(piece, drives.mass_kg[0], drives.curve.as_ref(), &price, &mut member);
                    least
                }
                Part::Links { tree, length_m } => {
                    let price = price();
                    let (least, at) = cheapest(tree, cell[level], |links| price.of_tube(links));
                    member.cell[level] = at;
                    levels.push(least);
                    self.add_tube(piece, *length_m, &tree.node(at).bounds, &mut member);
                    least
                }
                Part::Tube { tube, length_m } => {
                    self.add_tube(piece, *length_m, tube, &mut member);
                    price().of_tube(tube)
                }
                Part::Given { .. } | Part::FirstFit { .. } => {
                    let (price, mass_kg) = (price(), self.work.masses[piece]);
                    let curve = self.work.curves[piece].as_ref();
                    self.add_joint(piece, mass_kg[0], curve, &price, &mut member);
                    price.of_joint(mass_kg, curve)
                }
                Part::Offset { mass_kg } => {
                    member.values[0] += mass_kg;
                    weights[0] / self.scale[0] * mass_kg
                }
            };
            member.adds.push(member.values.iter().zip(&before).map(|(a, b)| a - b).collect());
        }
        for (m, mode) in self.modes.iter().enumerate() {
            member.values[self.first_mode + m] = self.mode_value(mode, &member);
        }
        for ((value, scale), fixed) in member.values.iter_mut().zip(&self.scale).zip(&self.fixed) {
            *value = *value / scale + fixed;
        }
        (Plane { weights, least: total, levels }, member)
    }

    /// Puts a drive in its place in the state that its price makes best.
    fn add_joint(
        &self,
        piece: usize,
        mass_kg: f64,
        curve: Option<&CurveBox>,
        price: &Price,
        member: &mut Member,
    ) {
        member.values[0] += mass_kg;
        member.inertia[piece][inertia::MASS] = mass_kg;
        let weight_n = mass_kg * self.problem.space.gravity_m_s2;
        (0..self.tips.len()).for_each(|judged| self.add_weight(piece, judged, weight_n, member));
        let gears = self.gears.iter().filter(|gear| gear.piece == piece);
        for (gear, price) in gears.zip(&price.joint) {
            let state = price.best_of(curve).1;
            member.values[1 + gear.judged] += state.twist_rad * self.tips[gear.judged].joints[piece];
            member.stiffness[gear.judged][piece][0] = state.slope;
            if let Some(row) = gear.row {
                member.values[row] += state.torque_nm;
                member.values[row + 1] -= state.torque_nm;
            }
        }
    }

    /// Puts a tube in its place: of a box the lightest and stiffest.
    fn add_tube(&self, piece: usize, length_m: f64, links: &LinkBox, member: &mut Member) {
        let (line, stiffnesses) = (&links.low.inertias, &links.high.stiffnesses);
        let mass_kg = line[inertia::MASS] * length_m;
        member.values[0] += mass_kg;
        member.inertia[piece] = *line;
        for (judged, tip) in self.tips.iter().enumerate() {
            let water_kg = self.problem.poses[tip.case].water_kg_m3 * line[inertia::OUTER_AREA] * length_m;
            self.add_weight(piece, judged, (mass_kg - water_kg) * self.problem.space.gravity_m_s2, member);
            let yields = tip.tubes[piece].iter().zip(stiffnesses).map(|(c, s)| c / s);
            member.values[1 + judged] += yields.sum::<f64>();
            // what does not yield stores nothing
            member.stiffness[judged][piece] = stiffnesses.map(|s| if s.is_finite() { s } else { 0.0 });
        }
    }

    /// Adds what the weight of a piece does to the tip and to the torques of the gears inboard.
    fn add_weight(&self, piece: usize, judged: usize, weight_n: f64, member: &mut Member) {
        member.values[1 + judged] += weight_n * self.tips[judged].per_n[piece];
        member.weights_n[judged][piece] = weight_n;
        for force in self.forces.iter().filter(|force| force.judged == judged) {
            let Some(per_n) = force.per_n.get(piece) else { continue };
            member.values[force.row] -= weight_n * per_n;
            member.values[force.row + 1] += weight_n * per_n;
        }
    }

    /// What a piece adds to the sum with these weights, by its numbers.
    pub(super) fn price(&self, piece: usize, weights: &[f64]) -> Price {
        let weight = |row: usize| weights[row] / self.scale[row];
        let (length_m, is_joint) = (self.problem.length_m(piece), self.work.curves[piece].is_some());
        let mut price = Price::default();
        price.inertia[inertia::MASS] = weight(0) * length_m;
        let g = self.problem.space.gravity_m_s2 * length_m;
        for (judged, tip) in self.tips.iter().enumerate() {
            let mut per_n = weight(1 + judged) * tip.per_n[piece];
            for Force { row, per_n: by, .. } in self.forces.iter().filter(|force| force.judged == judged) {
                per_n -= by.get(piece).map_or(0.0, |c| c * (weight(*row) - weight(row + 1)));
            }
            price.inertia[inertia::MASS] += g * per_n;
            price.inertia[inertia::OUTER_AREA] -= g * per_n * self.problem.poses[tip.case].water_kg_m3;
            for (c, tube) in price.compliance.iter_mut().zip(&tip.tubes[piece]) {
                *c += weight(1 + judged) * tube;
            }
        }
        if is_joint {
            price.inertia[inertia::OUTER_AREA] = 0.0;
        }
        for gear in self.gears.iter().filter(|gear| gear.piece == piece) {
            let modes = self.modes.iter().enumerate().filter(|(_, mode)| mode.judged == gear.judged);
            price.joint.push(JointPrice {
                twist: weight(1 + gear.judged) * self.tips[gear.judged].joints[piece],
                slope: modes.map(|(m, mode)| weight(self.first_mode + m) * mode.shape.strain[piece][0]).sum(),
                torque: gear.row.map_or(0.0, |row| weight(row) - weight(row + 1)),
                torques_nm: gear.torques_nm,
                play: self.problem.plays[piece],
            });
        }
        for (m, mode) in self.modes.iter().enumerate() {
            let w = weight(self.first_mode + m);
            if w == 0.0 {
                continue;
            }
            for (p, kinetic) in price.inertia.iter_mut().zip(&mode.shape.kinetic[piece]) {
                *p += w * self.lambda * kinetic;
            }
            if !is_joint {
                for (p, strain) in price.stiffness.iter_mut().zip(&mode.shape.strain[piece]) {
                    *p += w * strain;
                }
            }
        }
        price
    }

    /// What a piece of a member adds to a row.
    pub(super) fn added(&self, member: &Member, piece: usize, row: usize) -> f64 {
        let adds = match row.checked_sub(self.first_mode) {
            None => member.adds[piece][row],
            Some(m) => {
                let Mode { shape, judged, .. } = &self.modes[m];
                let moves = dot(&shape.kinetic[piece], &member.inertia[piece]);
                self.lambda * moves - dot(&shape.strain[piece], &member.stiffness[*judged][piece])
            }
        };
        adds / self.scale[row]
    }

    /// `λ xᵀMx - xᵀKx` of a member but for what is fixed.
    fn mode_value(&self, mode: &Mode, member: &Member) -> f64 {
        let moves = products(&mode.shape.kinetic, &member.inertia);
        self.lambda * moves - products(&mode.shape.strain, &member.stiffness[mode.judged])
    }
}
