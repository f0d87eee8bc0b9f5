//! The analysis of absolute positions: the geometry is calibrated stage by stage, then what yields and what turns
//! unevenly is added effect by effect.

use super::align;
use super::fit::{Fitted, Sample, fit};
use super::kinematics::{Geometry, Number, number_groups};
use super::loads::{Yielding, candidates, sags};
use super::points::{Point, points};
use super::tree::Tree;
use crate::arm::Arm;
use crate::arm::effect::kind::Yields;
use crate::reconcile::fit::stats::median;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::verdict::stage::Stage;
use nalgebra::Vector3;
use rayon::prelude::*;
use serde_json::Value;

/// Hands the poses are dealt into; one is kept out at a time.
const HANDS: usize = 5;
/// Errors beyond this many scales are gross.
const GROSS: f64 = 8.0;
/// Scale of the errors before anything is fitted \[m\].
const ROUGH_M: f64 = 0.01;
/// Step of gravity's direction for slopes \[rad\].
const LEAN: f64 = 1e-3;

/// The classes of effects in the order in which they are looked for.
const CLASSES: [Yields; 3] = [Yields::AboutAxis, Yields::Tilt, Yields::Frame];

/// Everything a positions campaign tells.
#[derive(Clone)]
pub struct Positions {
    /// The table of errors, effect by effect.
    pub stages: Vec<Stage>,
    /// All that could yield.
    pub candidates: Vec<Yielding>,
    /// Which of them come into question.
    pub(super) considered: Vec<bool>,
    /// The final fit.
    pub fitted: Fitted,
    /// The same geometry's numbers fitted without any effect.
    pub rigid: Fitted,
    /// Rows that are gross errors, from 0, with their error \[mm\].
    pub gross: Vec<(usize, f64)>,
    pub(super) samples: Vec<Sample>,
    pub(super) numbers: Vec<Number>,
    /// Driven joints with a transmission error, by their place in a pose.
    pub(super) transmissions: Vec<usize>,
    pub(super) tree: Tree,
    /// Points, those of separate sessions apart.
    pub(super) points: Vec<Point>,
    /// Where sessions were told apart, in words.
    pub(super) sessions: Vec<String>,
    /// Errors of the last stage's kept-out predictions \[m\], by row.
    pub(super) kept_out: Vec<Vector3<f64>>,
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

    /// Fits the model of the moment again.
    pub(super) fn refit(&mut self) {
        let all: Vec<&Sample> = self.samples.iter().collect();
        self.fitted = fit(&all, &self.numbers, &self.fitted.effects, &self.fitted);
    }

    /// Computes what gravity does anew, for the geometry as fitted.
    pub(super) fn refresh(&mut self, campaign: &Campaign) {
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
    pub(super) fn stage(&mut self, added: String, dropped: Vec<String>) {
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

/// The measured positions with what gravity does to each.
pub(super) fn samples(
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
