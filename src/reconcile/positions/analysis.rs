//! Analyses absolute positions: calibrates the geometry stage by stage, and then adds compliances and transmission
//! errors, effect by effect.

use super::align;
use super::dependence::Dependence;
use super::fit::{fit, fits_without, likeliest};
use super::fitted::{Fitted, Sample, errors_m, predictions_m};
use super::kinematics::{Geometry, Number, number_groups};
use super::loads::{CompliantPlace, Loads, candidates};
use super::moved::{Boundary, Kind};
use super::points::{Point, points};
use super::pose::Pose;
use super::posterior::Posterior;
use super::shaped::with_shapes;
use super::tree::Tree;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::drift;
use crate::arm::effect::kind::ElasticRotation;
use crate::arm::effect::transmission_error;
use crate::arm::{Arm, BASE};
use crate::reconcile::fit::stats::median;
use crate::reconcile::model::estimate::Finding;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::components::Components;
use crate::reconcile::readings::rows::{PositionRow, pose_key};
use crate::reconcile::verdict::stage::Stage;
use nalgebra::{Rotation3, Vector3};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::Arc;

/// Number of folds into which the poses are divided. One fold is held out at a time.
const FOLDS: usize = 5;
/// A position is a gross error if its residual is more than this many times the fitted scale of the position errors.
const GROSS: f64 = 8.0;
/// Scale of the position errors that is assumed before anything is fitted \[m\].
const ROUGH_M: f64 = 0.01;
/// Angle by which gravity is tilted to compute derivatives of the deflection numerically \[rad\].
const LEAN: f64 = 1e-3;

/// Classes of compliances (about a joint's axis, tilt, frame), in the order in which the search for effects tries
/// them.
const CLASSES: [ElasticRotation; 3] =
    [ElasticRotation::AboutAxis, ElasticRotation::Tilt, ElasticRotation::Frame];

/// Result of the analysis of a campaign of positions.
#[derive(Clone)]
pub(crate) struct Positions {
    /// The table of position errors, stage by stage.
    pub stages: Vec<Stage>,
    /// All candidates: one for each effect at each place where it may be added to the model.
    pub candidates: Vec<CompliantPlace>,
    /// For each candidate, whether it may be named as an effect.
    pub(super) considered: Vec<bool>,
    /// Whether a transmission error may be named as an effect.
    pub(super) considers_transmissions: bool,
    /// The fit of the final model: geometry, compliances and sessions.
    pub fitted: Fitted,
    /// A fit with the same freed numbers of the geometry and no added compliance.
    pub rigid: Fitted,
    /// Rows that are gross errors, counted from 0, each with the length of its error \[mm\].
    pub gross: Vec<(usize, f64)>,
    pub(super) samples: Vec<Sample>,
    pub(super) numbers: Vec<Number>,
    /// Indices of the driven joints for which a transmission error was found, counted as in a pose.
    pub(super) transmissions: Vec<usize>,
    /// What the nominal deflection depends on; empty if the arm is rigid in its file.
    pub(super) dependences: Vec<Dependence>,
    /// Indices of the dependences that are effects of the model.
    pub(super) named_dependences: Vec<usize>,
    pub(super) tree: Tree,
    /// The points on the tools. A point that was moved on the tool between two sessions is listed as two points.
    pub(super) points: Vec<Point>,
    /// The boundaries between sessions (runs of rows with one set-up) that are in the model.
    pub(super) sessions: Vec<Boundary>,
    /// Error of each row's position after the last stage, as predicted by a fit without the row's fold \[m\].
    pub(super) held_out: Vec<Vector3<f64>>,
    /// Number of rows on which effects were screened; `None` if all rows were searched.
    pub(super) screened: Option<usize>,
    /// What the readings say about the numbers of the final model; `None` before it is found, and without effects.
    pub(super) posterior: Option<Arc<Posterior>>,
}

/// Arms whose geometry alone is calibrated, without a search for effects.
pub(crate) struct Calibrated {
    /// The arms with calibrated geometry. Everything else about them is unchanged.
    pub arms: Vec<Arm>,
    /// The same arms, as they are written to files: with the effect `drift` if the instrument drifted.
    pub written: Vec<Arm>,
    /// The table of position errors, one row for each stage of the calibration.
    pub stages: Vec<Stage>,
    /// Predicted position of each row with the calibrated geometry, in the instrument's frame \[mm\].
    pub predicted_mm: Vec<[f64; 3]>,
    /// Placements of the arms in the instrument's frame, as in `provenance` of a corrected arm.
    pub placements: Value,
}

/// Calibrates the geometry of the campaign's arms, with declared and found sessions, and does not search for effects.
pub(crate) fn calibrated(campaign: &Campaign) -> Calibrated {
    let found = Positions::on_its_geometry(campaign);
    let drift: Vec<Finding> = found.drift_finding(campaign).into_iter().collect();
    let mut placements = json!({});
    let mut arms = |effects: &[Finding]| -> Vec<Arm> {
        let arm = |i| found.corrected(campaign, i, &found.rigid, effects, &mut placements);
        (0..campaign.arms().len()).map(arm).collect()
    };
    let (arms, written) = (arms(&[]), arms(&drift));
    Calibrated {
        arms,
        written,
        placements,
        predicted_mm: found.predictions_m(&found.rigid).iter().map(|at_m| (1e3 * at_m).into()).collect(),
        stages: found.stages,
    }
}

/// Analyses the positions of a campaign: calibrates the geometry, finds sessions, and finds compliances and
/// transmission errors.
///
/// If the rows were taken in one configuration of the arm after the other, a compliance can look like a change of
/// session. So each session is examined again once the effects are in the model. A session is suspect if it is no
/// longer worth its price, or if it begins at a row where something else changes. If some session is suspect, the
/// analysis is repeated with two other sets of sessions: those that remain, and those that are needed in addition to
/// effects that were found without sessions. The model with the best score is kept.
pub(crate) fn analyze(campaign: &Campaign) -> Positions {
    let mut calibrated = Positions::in_declared_sessions(campaign);
    let mut found = calibrated.clone();
    calibrated.drop_deflections();
    found.tell_sessions(campaign);
    found.rigid = found.fitted.clone();
    found.find_effects(campaign);
    let mut reviewed = found.clone();
    let is_other = reviewed.drop_needless_sessions();
    if is_other || found.has_doubtful_session(campaign) {
        calibrated.recompute_deflections(campaign);
        let mut late = calibrated.clone();
        late.find_effects(campaign);
        late.tell_sessions(campaign);
        late.drop_needless_sessions();
        let set_ups = |model: &Positions| (model.boundaries(false), model.drifts());
        let others = [set_ups(&late), set_ups(&reviewed)];
        let mut again: Vec<Positions> = Vec::new();
        for own in
            others.iter().enumerate().filter(|(k, own)| !others[..*k].contains(own)).map(|(_, own)| own)
        {
            again.extend((*own != set_ups(&found)).then(|| calibrated.with_sessions(campaign, own)));
        }
        found =
            again.into_iter().fold(found, |best, next| if next.score() > best.score() { next } else { best });
    }
    let errors = found.errors_m().into_iter().map(|error_m| error_m.norm()).enumerate();
    let gross = errors.filter(|(_, e)| *e > GROSS * found.fitted.scale_m).map(|(i, e)| (i, 1e3 * e));
    found.gross = gross.collect();
    found.widen(campaign);
    found
}

impl Positions {
    fn new(campaign: &Campaign) -> Self {
        let tree = Tree::new(campaign);
        let points = points(campaign);
        let geometry = Geometry::nominal(&tree, points.len());
        let springs = candidates(&tree);
        let mut samples = samples(campaign, &tree, &geometry, &springs, &points);
        let candidates = with_shapes(springs, &samples, &tree.driven);
        let considered = candidates.iter().map(|c| campaign.statement.considers(c.effect)).collect();
        let loads = Loads::new(campaign, &tree, &geometry, &candidates);
        samples.iter_mut().zip(&campaign.positions).for_each(|(sample, row)| {
            sample.deflection = Arc::new(loads.with_all_candidates(row, &sample.deflection));
        });
        let fitted = Fitted::rigid(geometry, ROUGH_M);
        Self {
            stages: Vec::new(),
            candidates,
            considered,
            considers_transmissions: campaign.statement.considers(transmission_error::KIND.name),
            rigid: fitted.clone(),
            fitted,
            gross: Vec::new(),
            samples,
            numbers: Vec::new(),
            transmissions: Vec::new(),
            dependences: Vec::new(),
            named_dependences: Vec::new(),
            tree,
            points,
            sessions: Vec::new(),
            held_out: Vec::new(),
            screened: None,
            posterior: None,
        }
    }

    /// Calibrates the geometry, first without sessions and then with the sessions that campaign.json declares.
    fn in_declared_sessions(campaign: &Campaign) -> Self {
        let mut found = Self::new(campaign);
        found.calibrate(campaign);
        found.divide(&found.declared(campaign), true);
        if !found.sessions.is_empty() {
            found.stage("declared sessions".into(), Vec::new());
        }
        found.rigid = found.fitted.clone();
        found
    }

    /// Calibrates the geometry with the declared sessions and with those that the positions show.
    fn on_its_geometry(campaign: &Campaign) -> Self {
        let mut found = Self::in_declared_sessions(campaign);
        found.tell_sessions(campaign);
        found.rigid = found.fitted.clone();
        found
    }

    /// The sessions that campaign.json declares: what was moved, and the first row after that, counted from 0.
    fn declared(&self, campaign: &Campaign) -> Vec<(Kind, usize)> {
        let declared = campaign.statement.positions.sessions.iter();
        let boundaries = declared.flat_map(|session| {
            let first = session.from_row - 1;
            let points = (0..self.points.len()).filter(|&p| self.points[p].name == session.moved);
            let kinds: Vec<Kind> = match session.moved.as_str() {
                BASE => vec![Kind::Station],
                _ => points.map(Kind::Point).collect(),
            };
            kinds.into_iter().map(move |kind| (kind, first))
        });
        boundaries.collect()
    }

    /// Finds sessions that campaign.json does not declare, or a drift, and adds them to the model.
    fn tell_sessions(&mut self, campaign: &Campaign) {
        let spec = &campaign.statement.positions;
        let before = self.clone();
        if self.find_sessions(spec.tool_offset, spec.base_placement) > 0
            && !self.take_drift_instead(campaign, &before)
        {
            self.stage("sessions".into(), Vec::new());
        }
    }

    /// A copy of this calibrated model in which sessions begin at `boundaries` (what was moved, and the first row of
    /// the later session). The copy has a drift if `drifts` is true. The effects that are then found are added to it.
    fn with_sessions(&self, campaign: &Campaign, (boundaries, drifts): &(Vec<(Kind, usize)>, bool)) -> Self {
        let mut out = self.clone();
        if *drifts {
            out = out.with_drift();
            out.stage(format!("{}@{}", drift::KIND.name, Channel::Positions.word()), Vec::new());
        }
        out.divide(boundaries, false);
        if !boundaries.is_empty() {
            out.stage("sessions".into(), Vec::new());
        }
        out.rigid = out.fitted.clone();
        out.find_effects(campaign);
        out
    }

    /// Adds compliances and transmission errors to the model, one by one, as long as one is worth its price. In a long
    /// campaign, the effects that a subset of the rows shows are added first.
    pub(super) fn find_effects(&mut self, campaign: &Campaign) {
        self.take_screened(campaign);
        // Effects that follow a joint's angle can hide a compliance, so the search for compliances starts again after
        // each such effect that is found.
        loop {
            for class in CLASSES {
                while self.add(campaign, class) {}
            }
            if !self.add_periodic(campaign) {
                break;
            }
        }
    }

    /// Places the arm, and then frees one group of the geometry's numbers after the other, with a fit after each.
    fn calibrate(&mut self, campaign: &Campaign) {
        let spec = &campaign.statement.positions;
        let starts = self.starts(campaign);
        if starts.is_empty() {
            align::align(&self.tree, spec, &self.samples, &mut self.fitted.geometry);
        } else {
            // in a long campaign, the deflection of all rows is computed once, for the geometry that fits a part of the
            // rows
            self.fitted = starts[starts.len() - 1].clone();
            self.refresh(campaign);
        }
        // one group after the other, because a fit of all numbers from a bad start can end anywhere
        for (at, (name, group)) in number_groups(&self.tree, spec, self.points.len()).into_iter().enumerate()
        {
            self.numbers.extend(group);
            match starts.get(at) {
                Some(start) => {
                    self.fitted = start.clone();
                    self.refit();
                }
                None => self.settle_geometry(campaign),
            }
            self.stage(name.into(), Vec::new());
        }
        self.free_tolerances(campaign);
    }

    /// Fits the geometry. The deflection depends slightly on it, so two rounds are needed.
    pub(super) fn settle_geometry(&mut self, campaign: &Campaign) {
        for _ in 0..2 {
            self.refresh(campaign);
            self.refit();
        }
    }

    /// This model without the numbers for which `is_gone` is true. The other numbers are not fitted again.
    pub(super) fn without_numbers(&self, is_gone: impl Fn(&Number) -> bool) -> Self {
        let mut out = self.clone();
        let kept = self.numbers.iter().zip(&self.fitted.moved).filter(|(number, _)| !is_gone(number));
        out.fitted.moved = kept.map(|(_, moved)| *moved).collect();
        out.numbers.retain(|number| !is_gone(number));
        out
    }

    /// Fits the current model again to all samples (measured positions), starting from its present values.
    pub(super) fn refit(&mut self) {
        let all: Vec<&Sample> = self.samples.iter().collect();
        self.fitted = fit(&all, &self.numbers, &self.fitted.effects, &self.fitted);
    }

    /// Computes the deflection of each sample under gravity again, for the fitted geometry.
    pub(super) fn refresh(&mut self, campaign: &Campaign) {
        self.fitted.geometry.relevel();
        let upright = &self.fitted.geometry;
        let loads = Loads::new(campaign, &self.tree, upright, &self.candidates);
        let leans = if campaign.statement.positions.frees_gravity() { 2 } else { 0 };
        let leaning: Vec<(Rotation3<f64>, Loads)> = (0..leans)
            .map(|component| {
                let mut leaning = upright.clone();
                leaning.step(&[Number::Gravity(component)], &[LEAN]);
                leaning.relevel();
                // deflections are compared in the same level frame
                let back = upright.level * leaning.level.inverse();
                (back, Loads::new(campaign, &self.tree, &leaning, &[]))
            })
            .collect();
        let samples = self.samples.par_iter_mut().zip(&campaign.positions);
        samples.for_each(|(sample, row)| {
            let pose = loads.pose(row);
            let mut deflection = loads.deflection(&pose, row, sample.point);
            for ((back, loads), slope) in leaning.iter().zip(&mut deflection.known_slopes_m) {
                *slope = (back * loads.known_in_m(&pose, row, sample.point) - deflection.known_m) / LEAN;
            }
            sample.deflection = Arc::new(deflection);
        });
        self.hang(campaign);
    }

    /// Adds a row for the current model to the table of position errors. `added` and `dropped` name the effects or
    /// numbers that changed since the last row.
    pub(super) fn stage(&mut self, added: String, dropped: Vec<String>) {
        self.held_out = self.held_out_errors_m(&self.fitted);
        let mm: Vec<f64> = self.held_out.iter().map(|e| 1e3 * e.norm()).collect();
        let fitted = self.errors_m().into_iter().map(|error_m| 1e3 * error_m.norm());
        self.stages.push(Stage {
            added,
            dropped,
            fitted_median_mm: median(fitted.collect()),
            mean_mm: mm.iter().sum::<f64>() / mm.len().max(1) as f64,
            max_mm: mm.iter().copied().fold(0.0, f64::max),
            median_mm: median(mm),
        });
    }

    /// Predicted position of every sample by the model `fitted`, in the instrument's frame \[m\].
    pub(super) fn predictions_m(&self, fitted: &Fitted) -> Vec<Vector3<f64>> {
        predictions_m(&self.samples.iter().collect::<Vec<_>>(), fitted)
    }

    /// Error of every sample with the fitted model \[m\]; zero where a coordinate was not measured.
    pub(super) fn errors_m(&self) -> Vec<Vector3<f64>> {
        errors_m(&self.samples.iter().collect::<Vec<_>>(), &self.fitted)
    }

    /// Error of every position \[m\], as predicted by a fit of the model `fitted` to all positions but those of its
    /// fold of poses.
    fn held_out_errors_m(&self, fitted: &Fitted) -> Vec<Vector3<f64>> {
        let of_fold = |fold: usize| self.samples.iter().filter(move |s| s.group % FOLDS == fold);
        let folds: Vec<Vec<&Sample>> = (0..FOLDS).map(|fold| of_fold(fold).collect()).collect();
        let fits = match self.is_long() {
            true => fits_without(&folds, &self.numbers, fitted),
            false => {
                let without = |fold: usize| {
                    let rest: Vec<&Sample> =
                        self.samples.iter().filter(|s| s.group % FOLDS != fold).collect();
                    likeliest(&rest, &self.numbers, &fitted.effects, fitted)
                };
                (0..FOLDS).into_par_iter().map(without).collect()
            }
        };
        let mut out = vec![Vector3::zeros(); self.samples.len()];
        for (own, fit) in folds.iter().zip(&fits) {
            own.iter().zip(errors_m(own, fit)).for_each(|(sample, error_m)| out[sample.index] = error_m);
        }
        out
    }
}

/// Weight of each coordinate's error in a fit, from 0.1 to 1; 0 if the coordinate was not measured. The weight is the
/// smallest standard deviation in the row, divided by the standard deviation of the coordinate. It is at least a tenth,
/// because the error of the model is often larger than that of the instrument.
fn precision(measured: &Components) -> Vector3<f64> {
    const LEAST: f64 = 0.1;
    let best_mm = measured.iter().flatten().map(|read| read.sigma_mm).fold(f64::INFINITY, f64::min);
    Vector3::from(measured.map(|read| read.map_or(0.0, |read| (best_mm / read.sigma_mm).max(LEAST))))
}

/// Number of the last row of the file, counted from 0, and at least 1 because row numbers are divided by it.
pub(super) fn last_row(campaign: &Campaign) -> f64 {
    campaign.positions.iter().map(|row| row.row).max().unwrap_or_default().max(1) as f64
}

/// The measured positions as samples. Each has the deflection of its point under gravity, and the deflection that each
/// of the `candidates` would add. `points` lists the measured points on the tools.
pub(super) fn samples(
    campaign: &Campaign,
    tree: &Tree,
    geometry: &Geometry,
    candidates: &[CompliantPlace],
    points: &[Point],
) -> Vec<Sample> {
    let last_row = last_row(campaign);
    let points: Vec<usize> = campaign
        .positions
        .iter()
        .map(|row| points.iter().position(|p| *p == Point::of(row)).unwrap_or_default())
        .collect();
    let loads = Loads::new(campaign, tree, geometry, candidates);
    let pose_rad = |row: &PositionRow| row.pose_deg.iter().map(|a| a.to_radians()).collect();
    let poses = Pose::all(&campaign.positions.iter().map(pose_rad).collect::<Vec<_>>());
    let rows = campaign.positions.par_iter().zip(points).zip(groups(campaign)).zip(poses);
    rows.enumerate()
        .map(|(index, (((row, point), group), pose))| Sample {
            pose,
            arm: row.arm,
            point,
            station: 0,
            part: row.row as f64 / last_row,
            index,
            group,
            measured_m: Vector3::from(row.measured.map(|read| read.map_or(0.0, |read| read.value_mm))) / 1e3,
            precision: precision(&row.measured),
            deflection: Arc::new(loads.deflection(&loads.pose(row), row, point)),
            nominal_m: Arc::default(),
            second_order_m: Vector3::zeros(),
        })
        .collect()
}

/// For each row, the index of its pose among the different poses of the campaign.
fn groups(campaign: &Campaign) -> Vec<usize> {
    let mut poses: HashMap<Vec<u64>, usize> = HashMap::new();
    let group = |row: &PositionRow| {
        let known = poses.len();
        *poses.entry(pose_key(&row.pose_deg)).or_insert(known)
    };
    campaign.positions.iter().map(group).collect()
}
