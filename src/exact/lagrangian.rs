//! The Lagrangian bound of a box, part by part, and the multipliers that improve it.
//!
//! A box is a set of designs, its members. A local upper bound is a mass, a deflection and a frequency, and the search
//! asks whether a member is below it (lighter, stiffer and with a higher mode). A row is an inequality that every such
//! member satisfies: on the mass, on the displacement of the tip, on a mode or on a torque.
//!
//! For multipliers `y ≥ 0`, the weighted sum of the rows ([`rows`](super::rows)) is a sum of one number for each part,
//! the price of the part. The least sum over all members of the box is therefore the sum of the least prices. They are
//! found level by level. The parts with the least prices make a *relaxed design*. This least sum is the value of the
//! dual function at `y`. If it exceeds the weighted limits of a local upper bound, no member lies below that bound. The
//! bound is then *refuted*.
//!
//! The next multipliers are the solution of a *matrix game* (Kelley's cutting-plane method). They are the weights of
//! the rows that make the least weighted sum, over the relaxed designs found so far, as large as possible. If no
//! multipliers refute the bound, the modes of the mixed arm give new rows. The mixed arm has the mean stiffnesses and
//! inertias of the relaxed designs, weighted by the solution of the game.

use super::bound::START_SHAPES;
use super::dual_price::{DualPrice, JointPrice, TubePrice};
use super::local_upper_bounds::LocalUpperBound;
use super::matrix_game::{Game, solve};
use super::parts::{INERTIAS, LinkBox, STIFFNESSES, inertia, stiffness_of};
use super::pose::{TILT, TORSION};
use super::problem::{Part, Problem};
use super::rows::{DualPoint, Force, Mode, RelaxedDesign, Rows};
use super::shape::{BoxWork as ShapeWork, Ideal, Shape, dot, products};
use super::torsion::CurveBox;

/// Number of steps of inverse iteration towards a mode of the mixed arm.
const STEPS: usize = 3;

/// Stiffnesses and line inertias of each piece of an arm.
type Arm = (Vec<[f64; STIFFNESSES]>, Vec<[f64; INERTIAS]>);

/// The numbers of a joint that is to be added to a relaxed design (the cheapest parts under some multipliers). `curve`
/// is `None` for a rigid joint. `tilt_rad_per_nm` has the least and the greatest tilt of its bearing per moment.
struct AddedJoint<'a> {
    piece: usize,
    mass_kg: f64,
    curve: Option<&'a CurveBox>,
    tilt_rad_per_nm: [f64; 2],
}

impl Problem<'_> {
    /// Mass of a piece divided by its first line inertia (mass per metre): the length of a tube \[m\]. It is 1 for any
    /// other piece, because its first line inertia is the mass itself.
    fn length_m(&self, piece: usize) -> f64 {
        match &self.parts[piece] {
            Part::Links { length_m, .. } | Part::Tube { length_m, .. } => *length_m,
            _ => 1.0,
        }
    }
}

impl Rows<'_> {
    /// Finds the multipliers on the rows (inequalities of the bound) that come nearest to a refutation of the local
    /// upper bound `upper`. Under them, the weighted sum of the rows of each relaxed design in `members` exceeds its
    /// upper limit by as much as possible. They are the solution of a matrix game between the rows and the relaxed
    /// designs.
    pub(super) fn best_multipliers(&self, members: &[RelaxedDesign], upper: &LocalUpperBound) -> Game {
        /// Least difference between a scaled row and its limit that the game sees. A row that is further below its
        /// limit has no influence on the game.
        const NO_SAY: f64 = -10.0;
        let row_limits: Vec<f64> = self.row_limits_now(upper).collect();
        let mut above = Vec::with_capacity(members.len() * row_limits.len());
        for member in members {
            above.extend(member.values.iter().zip(&row_limits).map(|(v, a)| (v - a).max(NO_SAY)));
        }
        // The two rows of a force are balanced columns: the mixture has to satisfy them as an equation.
        let balanced = 1 + self.tips.len()..self.first_mode;
        solve(&above, row_limits.len(), balanced)
    }

    /// Adds a row for each mode of the mixed arm that lies below the frequency of `upper`. `mix` has the weight of each
    /// relaxed design of `members` in the mixed arm. Returns whether a row was added.
    pub(super) fn add_violated_modes(
        &mut self,
        members: &mut [RelaxedDesign],
        mix: &[f64],
        upper: &LocalUpperBound,
    ) -> bool {
        let lambda = upper.lambda();
        let before = self.modes.len();
        for (judged, case) in self.problem.judged_cases().enumerate() {
            let (stiffness, inertia) = self.mixed_arm(members, mix, judged);
            let ideal = Ideal { stiffness: &stiffness, inertia: &inertia };
            let mut room = ShapeWork::default();
            let mut shapes: Vec<Shape> = Vec::new();
            for start in 0..START_SHAPES.len() {
                let last = self.modes.iter().rfind(|m| m.judged == judged && m.start == start);
                let Some(mut shape) = last.map(|mode| mode.shape.clone()) else { continue };
                for _ in 0..STEPS {
                    shape.improve(&self.problem.poses[case], &ideal, &shapes, &mut room);
                }
                shapes.push(shape);
            }
            for (start, shape) in shapes.into_iter().enumerate() {
                // The mixture satisfies the row of a shape with a higher quotient already.
                if shape.quotient(&ideal) < lambda * (1.0 - 1e-6) {
                    self.push_mode(judged, start, shape);
                }
            }
        }
        // The relaxed designs found so far get values of the new rows too, so that the game may use these rows.
        for member in members {
            for mode in &self.modes[before..] {
                let row = member.values.len();
                let value = self.mode_value(mode, member) / self.scale[row] + self.fixed[row];
                member.values.push(value);
                member.kinetic.push(mode.shape.kinetic_energy(&member.inertia));
            }
        }
        self.modes.len() > before
    }

    /// Stiffnesses and inertias of the mixed arm in a judged case (a case that counts for deflection and lowest mode).
    /// They are means over the relaxed designs `members` with the weights `mix`.
    fn mixed_arm(&self, members: &[RelaxedDesign], mix: &[f64], judged: usize) -> Arm {
        let pieces = self.problem.parts.len();
        let mut arm = (vec![[0.0; STIFFNESSES]; pieces], vec![[0.0; INERTIAS]; pieces]);
        for (member, share) in members.iter().zip(mix).filter(|(_, share)| **share > 0.0) {
            let pairs = arm.0.iter_mut().zip(member.stiffness_in(judged));
            let pairs = pairs.chain(arm.1.iter_mut().zip(&member.inertia));
            pairs.for_each(|(sum, x)| sum.iter_mut().zip(x).for_each(|(sum, x)| *sum += share * x));
        }
        arm
    }

    /// Minimizes the weighted sum of the rows (inequalities of the bound) over the members of a box. Returns the
    /// multipliers with this least sum as a dual point, and the relaxed design that attains it.
    pub(super) fn minimize(&self, design_box: &[u32], multipliers: Vec<f64>) -> (DualPoint, RelaxedDesign) {
        let mut total: f64 = multipliers.iter().zip(&self.fixed).map(|(w, f)| w * f).sum();
        let mut levels = Vec::with_capacity(design_box.len());
        let mut member = self.empty_design(design_box);
        for (piece, part) in self.problem.parts.iter().enumerate() {
            let level = levels.len();
            let price = || self.price(piece, &multipliers, self.lambda);
            // The choice of a branching needs the amount that the piece adds to each row. `adds` first stores the
            // values of the rows before the piece is added.
            let before = member.adds.len();
            member.adds.extend_from_slice(&member.values[..self.first_mode]);
            total += match part {
                Part::Drives { tree, .. } => {
                    let price = price();
                    let cheapest = self.priced[level].as_ref().and_then(|drives| drives.cheapest(&price));
                    // If no drive is feasible the sum is infinite, and any local upper bound is refuted.
                    let (least, at) = cheapest.unwrap_or((f64::INFINITY, design_box[level]));
                    member.design_box[level] = at;
                    levels.push(least);
                    let drives = &tree.node(at).bounds;
                    let added = AddedJoint {
                        piece,
                        mass_kg: drives.mass_kg[0],
                        curve: drives.curve.as_ref(),
                        tilt_rad_per_nm: drives.tilt_rad_per_nm,
                    };
                    self.add_joint(&added, &price, &mut member);
                    least
                }
                Part::Links { tree, length_m } => {
                    let price = price();
                    let (least, at) = TubePrice::new(&price).cheapest(tree, design_box[level]);
                    member.design_box[level] = at;
                    levels.push(least);
                    self.add_tube(piece, *length_m, &tree.node(at).bounds, &mut member);
                    least
                }
                Part::Tube { tube, length_m } => {
                    self.add_tube(piece, *length_m, tube, &mut member);
                    // A given part has no options, so its price is a constant of the sum.
                    price().of_tube(tube)
                }
                Part::Given { .. } | Part::FirstFit { .. } => {
                    let (price, mass_kg) = (price(), self.work.masses[piece]);
                    let (curve, tilt_rad_per_nm) = (self.work.curves[piece].as_ref(), self.work.tilts[piece]);
                    let added = AddedJoint { piece, mass_kg: mass_kg[0], curve, tilt_rad_per_nm };
                    self.add_joint(&added, &price, &mut member);
                    price.of_joint(mass_kg, curve, tilt_rad_per_nm)
                }
                Part::Offset { mass_kg } => {
                    member.values[0] += mass_kg;
                    multipliers[0] / self.scale[0] * mass_kg
                }
            };
            let adds = member.adds[before..].iter_mut().zip(&member.values);
            adds.for_each(|(before, value)| *before = value - *before);
        }
        self.complete(&mut member);
        (DualPoint { multipliers, lambda: self.lambda, least: total, levels }, member)
    }

    /// Completes a relaxed design to which all pieces were added: computes the values of its mode rows and divides the
    /// values of all rows by their scales.
    fn complete(&self, member: &mut RelaxedDesign) {
        for (m, mode) in self.modes.iter().enumerate() {
            member.values[self.first_mode + m] = self.mode_value(mode, member);
            member.kinetic.push(mode.shape.kinetic_energy(&member.inertia));
        }
        for ((value, scale), fixed) in member.values.iter_mut().zip(&self.scale).zip(&self.fixed) {
            *value = *value / scale + fixed;
        }
    }

    /// A relaxed design to which no piece was added yet: all of its numbers are zero.
    fn empty_design(&self, design_box: &[u32]) -> RelaxedDesign {
        let pieces = self.problem.parts.len();
        RelaxedDesign {
            design_box: design_box.to_vec(),
            adds: Vec::with_capacity(pieces * self.first_mode),
            weights_n: vec![0.0; pieces * self.tips.len()],
            values: vec![0.0; self.scale.len()],
            inertia: vec![[0.0; INERTIAS]; pieces],
            stiffness: vec![[0.0; STIFFNESSES]; pieces * self.tips.len()],
            kinetic: Vec::with_capacity(self.modes.len()),
        }
    }

    /// Adds a joint's drive to the relaxed design `member`. The gear gets the state (torque and twist) that is cheapest
    /// under `price`.
    fn add_joint(&self, joint: &AddedJoint, price: &DualPrice, member: &mut RelaxedDesign) {
        let AddedJoint { piece, mass_kg, curve, tilt_rad_per_nm } = *joint;
        member.values[0] += mass_kg;
        member.inertia[piece][inertia::MASS] = mass_kg;
        let weight_n = mass_kg * self.problem.space.gravity_m_s2;
        (0..self.tips.len()).for_each(|judged| self.add_weight(piece, judged, weight_n, member));
        for (judged, tip) in self.tips.iter().enumerate() {
            let cheaper = tilt_rad_per_nm[usize::from(price.compliance[TILT] < 0.0)];
            member.values[1 + judged] += tip.compliances[piece][TILT] * cheaper;
            let place = member.place(judged, piece);
            member.stiffness[place][TILT] = stiffness_of(tilt_rad_per_nm[0]);
        }
        let gears = self.gears.iter().filter(|gear| gear.piece == piece);
        for (gear, price) in gears.zip(&price.joint) {
            let state = price.best_of(curve).1;
            member.values[1 + gear.judged] += state.twist_rad * self.tips[gear.judged].joints[piece];
            let place = member.place(gear.judged, piece);
            member.stiffness[place][TORSION] = state.slope;
            if let Some(row) = gear.row {
                member.values[row] += state.torque_nm;
                member.values[row + 1] -= state.torque_nm;
            }
        }
    }

    /// Adds a tube to the relaxed design `member`. For a box of tubes, the least masses and the greatest stiffnesses
    /// are added.
    fn add_tube(&self, piece: usize, length_m: f64, links: &LinkBox, member: &mut RelaxedDesign) {
        let (line, stiffnesses) = (&links.low.inertias, &links.high.stiffnesses);
        let mass_kg = line[inertia::MASS] * length_m;
        member.values[0] += mass_kg;
        member.inertia[piece] = *line;
        for (judged, tip) in self.tips.iter().enumerate() {
            let water_kg = self.problem.poses[tip.case].water_kg_m3 * line[inertia::OUTER_AREA] * length_m;
            self.add_weight(piece, judged, (mass_kg - water_kg) * self.problem.space.gravity_m_s2, member);
            let deflections = tip.compliances[piece].iter().zip(stiffnesses).map(|(c, s)| c / s);
            member.values[1 + judged] += deflections.sum::<f64>();
            // A rigid coordinate stores no strain energy, so its stiffness is 0 here.
            let place = member.place(judged, piece);
            member.stiffness[place] = stiffnesses.map(|s| if s.is_finite() { s } else { 0.0 });
        }
    }

    /// Adds the effects of the weight of a piece to the relaxed design `member` in a judged case: on the displacement
    /// of the tip, and on the torques of the gears inboard.
    fn add_weight(&self, piece: usize, judged: usize, weight_n: f64, member: &mut RelaxedDesign) {
        member.values[1 + judged] += weight_n * self.tips[judged].per_n[piece];
        let place = member.place(judged, piece);
        member.weights_n[place] = weight_n;
        for force in self.forces.iter().filter(|force| force.judged == judged) {
            let Some(per_n) = force.per_n.get(piece) else { continue };
            // In `add_joint`, the torque at which the gear is evaluated enters these rows with the opposite sign.
            member.values[force.row] -= weight_n * per_n;
            member.values[force.row + 1] += weight_n * per_n;
        }
    }

    /// The dual prices of a piece: for each of its numbers, the amount per unit that the piece adds to the weighted sum
    /// of rows under `multipliers`. `lambda` is the eigenvalue for which the mode rows are made \[1/s²\].
    pub(super) fn price(&self, piece: usize, multipliers: &[f64], lambda: f64) -> DualPrice {
        let multiplier = |row: usize| multipliers[row] / self.scale[row];
        let (length_m, is_joint) = (self.problem.length_m(piece), self.problem.parts[piece].is_joint());
        let mut price = DualPrice::default();
        price.inertia[inertia::MASS] = multiplier(0) * length_m;
        let g = self.problem.space.gravity_m_s2 * length_m;
        for (judged, tip) in self.tips.iter().enumerate() {
            let mut per_n = multiplier(1 + judged) * tip.per_n[piece];
            for Force { row, per_n: by, .. } in self.forces.iter().filter(|force| force.judged == judged) {
                per_n -= by.get(piece).map_or(0.0, |c| c * (multiplier(*row) - multiplier(row + 1)));
            }
            price.inertia[inertia::MASS] += g * per_n;
            // Buoyancy: the net weight falls with the outer area.
            price.inertia[inertia::OUTER_AREA] -= g * per_n * self.problem.poses[tip.case].water_kg_m3;
            for (c, tip_per_compliance) in price.compliance.iter_mut().zip(&tip.compliances[piece]) {
                *c += multiplier(1 + judged) * tip_per_compliance;
            }
        }
        // A drive has no outer area in the model, and therefore no buoyancy.
        if is_joint {
            price.inertia[inertia::OUTER_AREA] = 0.0;
        }
        for gear in self.gears.iter().filter(|gear| gear.piece == piece) {
            let modes = self.modes.iter().enumerate().filter(|(_, mode)| mode.judged == gear.judged);
            price.joint.push(JointPrice {
                twist: multiplier(1 + gear.judged) * self.tips[gear.judged].joints[piece],
                slope: modes
                    .map(|(m, mode)| multiplier(self.first_mode + m) * mode.shape.strain[piece][TORSION])
                    .sum(),
                torque: gear.row.map_or(0.0, |row| multiplier(row) - multiplier(row + 1)),
                torques_nm: gear.torques_nm,
                play: self.problem.joint_plays[piece],
            });
        }
        for (m, mode) in self.modes.iter().enumerate() {
            let w = multiplier(self.first_mode + m);
            // Most mode rows have no multiplier; skipping them saves most of the time of this loop.
            if w == 0.0 {
                continue;
            }
            for (p, kinetic) in price.inertia.iter_mut().zip(&mode.shape.kinetic[piece]) {
                *p += w * lambda * kinetic;
            }
            // The slope of a gear depends on its state, so the amount by which it lowers the sum is in `JointPrice`.
            let first = if is_joint { TILT } else { 0 };
            for (p, strain) in price.stiffness.iter_mut().zip(&mode.shape.strain[piece]).skip(first) {
                *p += w * strain;
            }
        }
        price
    }

    /// The amount that one piece of the relaxed design `member` adds to a row, divided by the scale of the row.
    pub(super) fn added(&self, member: &RelaxedDesign, piece: usize, row: usize) -> f64 {
        let adds = match row.checked_sub(self.first_mode) {
            None => member.adds[piece * self.first_mode + row],
            Some(m) => {
                let Mode { shape, judged, .. } = &self.modes[m];
                let moves = dot(&shape.kinetic[piece], &member.inertia[piece]);
                self.lambda * moves - dot(&shape.strain[piece], &member.stiffness_in(*judged)[piece])
            }
        };
        adds / self.scale[row]
    }

    /// The part of a mode row's value, `λ xᵀMx - xᵀKx`, that the parts of the relaxed design `member` contribute. The
    /// payload and the bodies that the study gives are not included.
    fn mode_value(&self, mode: &Mode, member: &RelaxedDesign) -> f64 {
        let moves = products(&mode.shape.kinetic, &member.inertia);
        self.lambda * moves - products(&mode.shape.strain, member.stiffness_in(mode.judged))
    }
}
