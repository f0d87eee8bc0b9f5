//! The relaxation of a design space: a linear program is solved and options are dropped, in alternation.

use super::parts::Parts;
use super::program::Program;
use super::row::Row;
use super::shapes::ShapeModel;
use super::statics::CaseLoads;
use crate::pareto::objectives::Objectives;
use crate::space::problem::ArmProblem;

/// Greatest number of rounds of solving and dropping options.
const MOST_ROUNDS: usize = 4;
/// Greatest number of solutions of the program in a round. After each solution, trial shapes (each
/// gives an inequality on the lowest mode) or options are added.
const STEPS: usize = 40;
/// Relative amount by which a required objective is relaxed, as a margin for rounding.
const ROUNDING: f64 = 1e-9;

/// The bound on mass for designs that meet the required objectives.
#[derive(Debug, Clone, PartialEq)]
pub struct MassBound {
    /// Every design that deflects at most as far as required, and has at least the required lowest mode, has at least
    /// this mass \[kg\].
    pub mass_lower_bound_kg: f64,
    /// The bound before it was used to drop options \[kg\]. It is close to the mass of the lightest arm whose parts
    /// are mixtures of catalog options.
    pub mixture_kg: f64,
    /// For each piece from base to tip, the number of options left for a design that meets the objectives and is no
    /// heavier than the known design. Tilting bearings and added masses count as pieces.
    pub options_left: Vec<usize>,
    /// Whether the torque of some joint may have either sign within the remaining options. The bound then has to
    /// take the more favourable sign and is weaker.
    pub loads_oppose: bool,
}

/// A design space prepared for lower bounds on mass.
pub struct Relaxation<'a> {
    problem: &'a ArmProblem<'a>,
    cases: Vec<CaseLoads>,
    /// The inertias and stiffnesses of the arm from which trial shapes are made, one model for each judged case. A
    /// judged case counts for deflection and lowest mode.
    models: Vec<ShapeModel>,
}

impl<'a> Relaxation<'a> {
    /// Prepares every case of the problem.
    pub fn new(problem: &'a ArmProblem<'a>) -> Self {
        Self {
            problem,
            cases: (0..problem.stations().len()).map(|c| CaseLoads::new(problem, c)).collect(),
            models: problem.space().judged_cases.iter().map(|&c| ShapeModel::new(problem, c)).collect(),
        }
    }

    /// Lower bound on the mass of every design that deflects at most as far as `asked`, and whose lowest mode is at
    /// least as high as the lowest mode of `asked`. `known` is a design (one option for each level) that meets these
    /// objectives and weighs at most the mass in `asked`. `None` if a part of the known design cannot take its load.
    pub fn mass_lower_bound(&self, known: &[u32], asked: &Objectives) -> Option<MassBound> {
        let arm = self.problem.walk(known, |_, _| {}).ok()?;
        let mut search = Search {
            problem: self.problem,
            asked,
            cases: &self.cases,
            directions: self.problem.judged_directions(&arm),
            models: &self.models,
            parts: Parts::new(self.problem, &arm.options),
            shapes: Vec::new(),
            best_kg: 0.0,
            first_kg: 0.0,
        };
        search.run();
        // If every other option is excluded, only the known design is left, and the bound is its mass.
        let alone = search.parts.alive.iter().all(|options| options.len() == 1);
        Some(MassBound {
            mass_lower_bound_kg: if alone { self.problem.mass_kg(&arm) } else { search.best_kg }
                .min(asked.mass_kg),
            mixture_kg: search.first_kg.min(asked.mass_kg),
            options_left: search.parts.alive.iter().rev().map(Vec::len).collect(),
            loads_oppose: self.cases.iter().any(|case| case.opposes(self.problem, &search.parts)),
        })
    }
}

struct Search<'a> {
    problem: &'a ArmProblem<'a>,
    asked: &'a Objectives,
    cases: &'a [CaseLoads],
    /// The index of each judged case, and the direction in which the tip of the known design moves in this case.
    directions: Vec<(usize, nalgebra::Vector3<f64>)>,
    models: &'a [ShapeModel],
    parts: Parts,
    /// Trial shapes: the index of the model (judged case), and the values of the arm's strain coordinates (torsions of
    /// joints and deformations of links).
    shapes: Vec<(usize, nalgebra::DVector<f64>)>,
    best_kg: f64,
    /// The best bound after the first round of solving \[kg\], before it was used to drop options.
    first_kg: f64,
}

impl Search<'_> {
    /// Alternates between solving and dropping options until nothing changes.
    fn run(&mut self) {
        for round in 0..MOST_ROUNDS {
            self.reduce();
            let before: usize = self.parts.alive.iter().map(Vec::len).sum();
            self.solve();
            if round == 0 {
                self.first_kg = self.best_kg;
            }
            self.reduce();
            let after: usize = self.parts.alive.iter().map(Vec::len).sum();
            // Stop if nothing was dropped, or if the bound has reached the mass of the known design.
            if after == before || self.best_kg >= self.asked.mass_kg * (1.0 - 1e-6) {
                return;
            }
        }
    }

    /// Drops the options with which some inequality is violated even if every other piece takes the option that is best
    /// for this inequality. Drives that cannot meet their demand are dropped too. This is repeated until nothing
    /// changes.
    fn reduce(&mut self) {
        loop {
            let mut dropped = self.parts.drop_drives(self.problem, self.cases);
            self.parts.follow_drives();
            let mass =
                Row { coefficients: self.parts.masses(), limit: self.asked.mass_kg * (1.0 + ROUNDING) };
            for row in self.rows().iter().chain([&mass]) {
                dropped |= self.parts.drop_by(row);
            }
            if !dropped {
                return;
            }
        }
    }

    /// All linear inequalities that every design with the required deflection, mass and lowest mode satisfies.
    fn rows(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        for (case, direction) in &self.directions {
            let limit_m = self.asked.tip_deflection_m;
            rows.extend(self.cases[*case].deflection_rows(self.problem, &self.parts, direction, limit_m));
        }
        for &case in &self.problem.space().sizing_cases {
            rows.extend(self.cases[case].torque_rows(self.problem, &self.parts));
        }
        let stiffness = self.stiffness();
        let shapes = self.shapes.iter().map(|(model, shape)| self.shape_row(&stiffness, *model, shape));
        rows.into_iter().map(|row| self.parts.with_drives(row)).chain(shapes).collect()
    }

    /// The least eigenvalue `(2πf)²` that a design may have if its lowest mode reaches the required lowest mode
    /// \[1/s²\].
    fn eigenvalue(&self) -> f64 {
        let omega = std::f64::consts::TAU * self.asked.lowest_mode_hz;
        omega * omega * (1.0 - ROUNDING)
    }

    /// Greatest tangent stiffness of each remaining option of a joint \[N m/rad\]; first index the judged case, second
    /// the slot (piece of the arm), third the option.
    fn stiffness(&self) -> Vec<Vec<Vec<f64>>> {
        self.models.iter().map(|m| self.cases[m.case].stiffest(self.problem, &self.parts)).collect()
    }

    fn shape_row(&self, stiffness: &[Vec<Vec<f64>>], model: usize, shape: &nalgebra::DVector<f64>) -> Row {
        let row = self.models[model].row(&self.parts, &stiffness[model], shape, self.eigenvalue());
        self.parts.with_drives(row)
    }

    /// Solves the program repeatedly. After each solution, two things are added to the program: the inequalities of
    /// trial shapes that the mixture violates, and options that may make the mixture lighter.
    fn solve(&mut self) {
        let stiffness = self.stiffness();
        let mut program = Program::new(&self.parts, self.rows());
        for _ in 0..STEPS {
            let Some(solution) = program.solve() else { return };
            self.best_kg = self.best_kg.max(solution.bound_kg);
            let found = self.violated(&stiffness, &solution.weights);
            for (model, shape) in &found {
                program.add(self.shape_row(&stiffness, *model, shape));
            }
            self.shapes.extend(found.iter().cloned());
            if found.is_empty() && !solution.grew {
                break;
            }
        }
        // With the best multipliers of this round, options with which the mass would exceed the required mass are
        // dropped.
        program.drop_options(&mut self.parts, self.asked.mass_kg * (1.0 + ROUNDING));
    }

    /// Trial shapes whose inequalities the mixture violates, each with the index of its model (judged case).
    fn violated(
        &self,
        stiffness: &[Vec<Vec<f64>>],
        weights: &[Vec<f64>],
    ) -> Vec<(usize, nalgebra::DVector<f64>)> {
        let weights = self.parts.with_bearings(weights);
        let mut found = Vec::new();
        for (index, model) in self.models.iter().enumerate() {
            let shapes = model.violated(&self.parts, &stiffness[index], &weights, self.eigenvalue());
            found.extend(shapes.into_iter().map(|shape| (index, shape)));
        }
        found
    }
}

impl ArmProblem<'_> {
    /// The unit vector along which the tip of an arm moves in each judged case; downward if it does not move.
    fn judged_directions(
        &self,
        arm: &crate::space::problem::Partial,
    ) -> Vec<(usize, nalgebra::Vector3<f64>)> {
        let down = -nalgebra::Vector3::z();
        let judged = self.space().judged_cases.iter();
        judged.map(|&c| (c, arm.stations[c].tip_m.try_normalize(0.0).unwrap_or(down))).collect()
    }
}
