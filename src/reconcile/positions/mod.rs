//! Absolute positions: placement, tool offsets, joint zeros, geometry and the direction of gravity are
//! calibrated, what yields is found effect by effect, each stage judged on poses kept out of the fit.
//!
//! `tree` joins the arms that stand on one trunk; [`kinematics`] says where a point is and [`loads`] how
//! gravity moves it; `align` places the arm from nothing, [`fit`](mod@fit) fits, with compliances that are `springs`, `sessions` tells sessions
//! apart and `standing` where the arm stands in each; `search` finds what yields and `transmission` what turns unevenly; `structure` asks what is left and `outcome` concludes.

pub(crate) mod align;
pub mod fit;
pub mod kinematics;
pub mod loads;
pub(crate) mod next_test;
pub(crate) mod outcome;
pub(crate) mod predict;
pub(crate) mod search;
pub(crate) mod sessions;
pub(crate) mod springs;
pub(crate) mod standing;
pub(crate) mod structure;
pub(crate) mod transmission;
pub(crate) mod tree;

pub use outcome::{FEWEST, located, reconcile};
pub use predict::predicted_mm;

use super::fit::stats::median;
use super::readings::campaign::Campaign;
use super::readings::rows::PositionRow;
use crate::arm::Arm;
use fit::{Fitted, Sample, fit};
use kinematics::{Geometry, Number, number_groups};
use loads::{Yielding, candidates, sags};
use nalgebra::Vector3;
use rayon::prelude::*;
use serde_json::Value;
use tree::Tree;

/// Hands the poses are dealt into; one is kept out at a time.
const HANDS: usize = 5;
/// Errors beyond this many scales are gross.
const GROSS: f64 = 8.0;
/// Scale of the errors before anything is fitted \[m\].
const ROUGH_M: f64 = 0.01;
/// Step of gravity's direction for slopes \[rad\].
const LEAN: f64 = 1e-3;

/// The classes of effects in the order in which they are looked for.
const CLASSES: [&[&str]; 3] = [
    &["joint_compliance", "connection_compliance"],
    &["bearing_tilt", "base_compliance"],
    &["frame_compliance"],
];

/// How well a model predicts positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// What was added to the stage before.
    pub added: String,
    /// What it made needless.
    pub dropped: Vec<String>,
    /// Median error of the poses it was fitted to \[mm\].
    pub fitted_median_mm: f64,
    /// Median error of poses kept out of the fit \[mm\].
    pub median_mm: f64,
    /// Their mean error \[mm\].
    pub mean_mm: f64,
    /// Their largest error \[mm\].
    pub max_mm: f64,
}

/// Everything a positions campaign tells.
#[derive(Clone)]
pub struct Positions {
    /// The table of errors, effect by effect.
    pub stages: Vec<Stage>,
    /// All that could yield.
    pub candidates: Vec<Yielding>,
    /// Which of them come into question.
    considered: Vec<bool>,
    /// The final fit.
    pub fitted: Fitted,
    /// The same geometry's numbers fitted without any effect.
    pub rigid: Fitted,
    /// Rows that are gross errors, from 0, with their error \[mm\].
    pub gross: Vec<(usize, f64)>,
    samples: Vec<Sample>,
    numbers: Vec<Number>,
    /// Driven joints with a transmission error, by their place in a pose.
    transmissions: Vec<usize>,
    tree: Tree,
    /// Points, those of separate sessions apart.
    points: Vec<Point>,
    /// Where sessions were told apart, in words.
    sessions: Vec<String>,
    /// Errors of the last stage's kept-out predictions \[m\], by row.
    kept_out: Vec<Vector3<f64>>,
}

/// An arm whose geometry alone is calibrated.
pub struct Calibrated {
    /// The arms with their geometry, effects and all else as they were.
    pub arms: Vec<Arm>,
    /// How the error falls.
    pub stages: Vec<Stage>,
    /// Predicted positions \[mm\], by row.
    pub predicted_mm: Vec<[f64; 3]>,
}

/// Calibrates the geometry and finds nothing that yields.
pub fn calibrated(campaign: &Campaign) -> Calibrated {
    let found = Positions::on_its_geometry(campaign);
    let mut provenance = Value::Null;
    let arm = |i| found.corrected(campaign, i, &found.rigid, &[], &mut provenance);
    Calibrated {
        arms: (0..campaign.arms().len()).map(arm).collect(),
        predicted_mm: found.samples.iter().map(|s| (1e3 * found.rigid.predicted_m(s)).into()).collect(),
        stages: found.stages,
    }
}

/// Calibrates and finds what yields.
pub fn analyze(campaign: &Campaign) -> Positions {
    let mut found = Positions::on_its_geometry(campaign);
    // what turns unevenly hides what yields
    loop {
        for class in CLASSES {
            while found.add(campaign, class) {}
        }
        if !found.add_transmission(campaign) {
            break;
        }
    }
    let errors = found.samples.iter().map(|s| found.fitted.error(s).norm()).enumerate();
    let gross = errors.filter(|(_, e)| *e > GROSS * found.fitted.scale_m).map(|(i, e)| (i, 1e3 * e));
    found.gross = gross.collect();
    found
}

impl Positions {
    fn new(campaign: &Campaign) -> Self {
        let tree = Tree::new(campaign);
        let points = points(campaign);
        let geometry = Geometry::nominal(&tree, points.len());
        let candidates = candidates(&tree);
        let considered = candidates.iter().map(|c| campaign.statement.considers(c.effect)).collect();
        let samples = samples(campaign, &tree, &geometry, &candidates, &points);
        let fitted = Fitted::rigid(geometry, ROUGH_M);
        Self {
            stages: Vec::new(),
            candidates,
            considered,
            rigid: fitted.clone(),
            fitted,
            gross: Vec::new(),
            samples,
            numbers: Vec::new(),
            transmissions: Vec::new(),
            tree,
            points,
            sessions: Vec::new(),
            kept_out: Vec::new(),
        }
    }

    /// What is free in the geometry, fitted; sessions told apart.
    fn on_its_geometry(campaign: &Campaign) -> Self {
        let mut found = Self::new(campaign);
        found.calibrate(campaign);
        let spec = &campaign.statement.positions;
        found.sessions = found.find_sessions(spec.tool_offset, spec.base_placement);
        if !found.sessions.is_empty() {
            found.stage("sessions".into(), Vec::new());
        }
        found.rigid = found.fitted.clone();
        found
    }

    /// Places the arm and lets one group of numbers free after the other.
    fn calibrate(&mut self, campaign: &Campaign) {
        let spec = &campaign.statement.positions;
        align::align(&self.tree, spec, &self.samples, &mut self.fitted.geometry);
        for (name, group) in number_groups(&self.tree, spec, self.points.len()) {
            self.numbers.extend(group);
            // the sag depends on the geometry, a little
            for _ in 0..2 {
                self.refresh(campaign);
                self.refit();
            }
            self.stage(name.into(), Vec::new());
        }
    }

    fn refit(&mut self) {
        let all: Vec<&Sample> = self.samples.iter().collect();
        self.fitted = fit(&all, &self.numbers, &self.fitted.effects, &self.fitted);
    }

    /// Computes what gravity does anew, for the geometry as fitted.
    fn refresh(&mut self, campaign: &Campaign) {
        self.fitted.geometry.relevel();
        let points: Vec<usize> = self.samples.iter().map(|s| s.point).collect();
        let sags = sags(campaign, &self.tree, &self.fitted.geometry, &self.candidates, &points);
        self.samples.iter_mut().zip(sags).for_each(|(sample, sag)| sample.sag = sag);
        if campaign.statement.positions.frees_gravity() {
            (0..2).for_each(|c| self.lean(campaign, &points, c));
        }
    }

    /// How the sag that the model already has changes with one component of the direction of gravity.
    fn lean(&mut self, campaign: &Campaign, points: &[usize], component: usize) {
        let upright = &self.fitted.geometry;
        let mut leaning = upright.clone();
        leaning.step(&[Number::Gravity(component)], &[LEAN]);
        leaning.relevel();
        let back = upright.level * leaning.level.inverse();
        let sags = sags(campaign, &self.tree, &leaning, &self.candidates, points);
        for (sample, sag) in self.samples.iter_mut().zip(sags) {
            sample.sag.known_slopes_m[component] = (back * sag.known_m - sample.sag.known_m) / LEAN;
        }
    }

    /// Notes how well the model of the moment does.
    fn stage(&mut self, added: String, dropped: Vec<String>) {
        self.kept_out = self.kept_out_errors_m(&self.fitted);
        let mm: Vec<f64> = self.kept_out.iter().map(|e| 1e3 * e.norm()).collect();
        let fitted = self.samples.iter().map(|s| 1e3 * self.fitted.error(s).norm());
        self.stages.push(Stage {
            added,
            dropped,
            fitted_median_mm: median(fitted.collect()),
            mean_mm: mm.iter().sum::<f64>() / mm.len().max(1) as f64,
            max_mm: mm.iter().copied().fold(0.0, f64::max),
            median_mm: median(mm),
        });
    }

    /// Error of every position when the hand of its pose is kept out \[m\].
    fn kept_out_errors_m(&self, fitted: &Fitted) -> Vec<Vector3<f64>> {
        let mut out = vec![Vector3::zeros(); self.samples.len()];
        let hands: Vec<Vec<(usize, Vector3<f64>)>> = (0..HANDS)
            .into_par_iter()
            .map(|hand| {
                let (own, rest): (Vec<(usize, &Sample)>, Vec<_>) =
                    self.samples.iter().enumerate().partition(|(_, s)| s.group % HANDS == hand);
                let rest: Vec<&Sample> = rest.into_iter().map(|(_, s)| s).collect();
                let again = fit(&rest, &self.numbers, &fitted.effects, fitted);
                own.into_iter().map(|(i, s)| (i, again.error(s))).collect()
            })
            .collect();
        hands.into_iter().flatten().for_each(|(i, error)| out[i] = error);
        out
    }
}

/// A point on the tool of an arm.
#[derive(Debug, Clone, PartialEq)]
struct Point {
    arm: usize,
    name: String,
    /// Where it sat before this row, from 1, if that was a session of its own.
    before_row: Option<usize>,
}

impl Point {
    /// The point of a row.
    fn of(row: &PositionRow) -> Self {
        Self { arm: row.arm, name: row.point.clone(), before_row: None }
    }

    /// Its name, with the session.
    fn label(&self) -> String {
        match self.before_row {
            Some(row) => format!("{} before row {row}", self.name),
            None => self.name.clone(),
        }
    }
}

fn points(campaign: &Campaign) -> Vec<Point> {
    let mut out: Vec<Point> = Vec::new();
    for point in campaign.positions.iter().map(Point::of) {
        if !out.contains(&point) {
            out.push(point);
        }
    }
    out
}

fn samples(
    campaign: &Campaign,
    tree: &Tree,
    geometry: &Geometry,
    candidates: &[Yielding],
    points: &[Point],
) -> Vec<Sample> {
    let points: Vec<usize> = campaign
        .positions
        .iter()
        .map(|row| points.iter().position(|p| *p == Point::of(row)).unwrap_or_default())
        .collect();
    let sags = sags(campaign, tree, geometry, candidates, &points);
    let mut poses: Vec<&Vec<f64>> = Vec::new();
    let rows = campaign.positions.iter().zip(sags).zip(points);
    rows.enumerate()
        .map(|(index, ((row, sag), point))| {
            let known = poses.iter().position(|p| **p == row.pose_deg);
            let group = known.unwrap_or_else(|| {
                poses.push(&row.pose_deg);
                poses.len() - 1
            });
            Sample {
                pose_rad: row.pose_deg.iter().map(|a| a.to_radians()).collect(),
                arm: row.arm,
                point,
                station: 0,
                index,
                group,
                measured_m: Vector3::from(row.position_mm) / 1e3,
                sag,
            }
        })
        .collect()
}
