//! The relaxation of a design space: rounds of solving the program and dropping options.

use super::parts::Parts;
use super::program::Program;
use super::row::Row;
use super::shapes::ShapeModel;
use super::statics::CaseLoads;
use crate::pareto::objectives::Objectives;
use crate::space::problem::ArmProblem;

/// Greatest number of rounds of solving and dropping options.
const ROUNDS: usize = 4;
/// Greatest number of solutions of the program in a round. After each, trial shapes or options are added.
const STEPS: usize = 40;
/// Relative margin for rounding of an objective.
const ROUNDING: f64 = 1e-9;

/// What the relaxation proves about the designs that meet the objectives asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct MassBound {
    /// No design with at most this deflection and at least this lowest mode is lighter \[kg\].
    pub mass_lower_bound_kg: f64,
    /// The bound before it was used to drop options \[kg\]. It is about the mass of the lightest mixture of catalog
    /// parts.
    pub mixture_kg: f64,
    /// For each piece from base to tip, how many options are left for a design that meets the objectives and is no
    /// heavier than the known design. Tilting bearings and added masses are pieces too.
    pub options_left: Vec<usize>,
    /// Whether some load may have either sign within the remaining options. The bound then has to take the
    /// more favourable sign and is weaker.
    pub loads_oppose: bool,
}

/// A design space compiled for bounds.
pub struct Relaxation<'a> {
    problem: &'a ArmProblem<'a>,
    cases: Vec<CaseLoads>,
    /// One model for each judged case.
    models: Vec<ShapeModel>,
}

impl<'a> Relaxation<'a> {
    /// Compiles every case of the problem.
    pub fn new(problem: &'a ArmProblem<'a>) -> Self {
        Self {
            problem,
            cases: (0..problem.stations().len()).map(|c| CaseLoads::new(problem, c)).collect(),
            models: problem.space().judged_cases.iter().map(|&c| ShapeModel::new(problem, c)).collect(),
        }
    }

    /// Bounds the mass of every design that deflects no more and vibrates no lower than `asked`. `known` is a design
    /// (one option for each level) that meets these objectives and weighs at most the mass in `asked`. `None` if a
    /// part of the known design cannot carry its load.
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
        // If nothing else is left, the known design is the lightest.
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
    /// For each judged case, the direction in which the known design's tip moves.
    directions: Vec<(usize, nalgebra::Vector3<f64>)>,
    models: &'a [ShapeModel],
    parts: Parts,
    /// Trial shapes, each with its judged case and its strain coordinates.
    shapes: Vec<(usize, nalgebra::DVector<f64>)>,
    best_kg: f64,
    /// The best bound after the first round of solving \[kg\].
    first_kg: f64,
}

impl Search<'_> {
    /// Alternates between solving and dropping options until nothing changes.
    fn run(&mut self) {
        for round in 0..ROUNDS {
            self.reduce();
            let before: usize = self.parts.alive.iter().map(Vec::len).sum();
            self.solve();
            if round == 0 {
                self.first_kg = self.best_kg;
            }
            self.reduce();
            let after: usize = self.parts.alive.iter().map(Vec::len).sum();
            // Nothing was dropped, or the bound has reached the known design.
            if after == before || self.best_kg >= self.asked.mass_kg * (1.0 - 1e-6) {
                return;
            }
        }
    }

    /// Drops the options with which some row exceeds its limit even if every other piece has its best option.
    fn reduce(&mut self) {
        loop {
            let mut dropped = self.parts.drop_drives(self.problem, self.cases);
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

    /// Every inequality that holds for the designs that meet the objectives.
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
        rows.extend(self.shapes.iter().map(|(model, shape)| self.shape_row(&stiffness, *model, shape)));
        rows
    }

    /// The least eigenvalue that the required mode allows \[1/s²\].
    fn eigenvalue(&self) -> f64 {
        let omega = std::f64::consts::TAU * self.asked.lowest_mode_hz;
        omega * omega * (1.0 - ROUNDING)
    }

    /// For each judged case and each slot, the greatest stiffness of the joint's options \[N m/rad\].
    fn stiffness(&self) -> Vec<Vec<Vec<f64>>> {
        self.models.iter().map(|m| self.cases[m.case].stiffest(self.problem, &self.parts)).collect()
    }

    fn shape_row(&self, stiffness: &[Vec<Vec<f64>>], model: usize, shape: &nalgebra::DVector<f64>) -> Row {
        self.models[model].row(&self.parts, &stiffness[model], shape, self.eigenvalue())
    }

    /// Solves the program, and adds the trial shapes that the mixture violates and the options that it lacks.
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
        // With the best multipliers of this round, options that make the mass exceed that asked for are
        // dropped.
        program.drop_options(&mut self.parts, self.asked.mass_kg * (1.0 + ROUNDING));
    }

    /// Trial shapes whose inequalities the mixture violates, each with its judged case.
    fn violated(
        &self,
        stiffness: &[Vec<Vec<f64>>],
        weights: &[Vec<f64>],
    ) -> Vec<(usize, nalgebra::DVector<f64>)> {
        let mut found = Vec::new();
        for (index, model) in self.models.iter().enumerate() {
            let shapes = model.violated(&self.parts, &stiffness[index], weights, self.eigenvalue());
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
