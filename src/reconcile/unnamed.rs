//! Smooth laws that no effect of the library has, as rivals of the effects that were named.
//!
//! An effect of the library can imitate physics that the library lacks: a joint that stiffens as it is
//! loaded looks like lost motion, a sensor that is not straight like a gain. So every named effect must stand
//! against general laws: the twist of a joint as a smooth function of its torque, odd or even, of its angle
//! or of the order of the tests; a reading as a smooth function of the true value, or of the direction.
//! Such a law is a few columns of changes of the readings, made linear about a fit, and is fitted jointly with
//! the calibration, beside the named effects or instead of them.

use super::campaign::Campaign;
use super::fit::{Effort, Fit, Weights, normal, objective};
use super::forward::{ARCMIN_PER_RAD, Forward};
use super::lack_of_fit::{Structure, waves};
use super::select::{Scored, Search};
use super::stats::ln_chi_squared_tail;
use crate::arm::effect::Channel;
use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Part of a law's full size, at which a stiffness or a reading changes by all of itself, below which
/// sizes are equally likely.
const SMALL: f64 = 0.02;
/// Most reweighted steps of the linear fit.
const STEPS: usize = 6;
/// Fall of the objective at which the linear fit is at its end.
const SETTLED: f64 = 0.01;
/// Rise of the evidence from which a law without a name is believed rather than effects with one, and
/// from which it is mentioned where no effect is named.
const BETTER: f64 = 2.0;

/// A law without a name.
struct Law {
    /// What it says, in words.
    what: String,
    /// Change of each prediction per unit of each of its numbers, in the unit of the file.
    columns: Vec<Vec<f64>>,
}

/// A model with a law in it.
struct Rival {
    what: String,
    numbers: usize,
    objective: f64,
    /// ln of the evidence.
    evidence: f64,
}

/// A law that explains the readings better than what it stands for.
pub struct Better {
    /// What it says, in words.
    pub what: String,
    /// How many numbers it has.
    pub numbers: usize,
    /// `Σ ρ(r) + Σ u²` with it.
    pub objective: f64,
    /// By how much the evidence rises.
    pub gain: f64,
}

/// What each law would take from the residuals of a model, as questions put to them.
pub fn beside(campaign: &Campaign, forward: &Forward, fit: &Fit, weights: &Weights) -> Vec<Structure> {
    let rivals = rivals(forward, fit, &laws(campaign, forward, fit), weights);
    let asked = (rivals.len() as f64).max(1.0).ln();
    rivals
        .into_iter()
        .map(|rival| {
            let (statistic, dof) = (fit.point.objective - rival.objective, rival.numbers as f64);
            let ln_p = (ln_chi_squared_tail(statistic, dof) + asked).min(0.0);
            Structure { channel: None, follows: rival.what, statistic, dof, ln_p }
        })
        .collect()
}

/// The law that explains the readings better, beside calibration alone, than calibration does.
pub fn beside_calibration(search: &Search, bare: &Fit) -> Option<Better> {
    let places = search.places() as f64;
    let laws = laws(search.campaign, search.forward, bare);
    best_of(rivals(search.forward, bare, &laws, search.weights), bare.evidence, places)
}

/// The law that explains the readings better, in place of one of the named effects or of all of them, than
/// they do.
pub fn instead(search: &Search, best: &Scored, bare: &Fit) -> Option<Better> {
    let (named, places) = (best.effects.len(), search.places() as f64);
    let single = (0..named).filter(|_| named > 1).map(|i| {
        let (effects, u) = search.without(best, i);
        search.fit(&effects, &u, Effort::default())
    });
    let fits: Vec<Fit> = single.collect();
    let better = |fit: &Fit| {
        let laws = laws(search.campaign, search.forward, fit);
        let evidence = best.score + fit.model.effects.len() as f64 * places.ln();
        best_of(rivals(search.forward, fit, &laws, search.weights), evidence, places)
    };
    fits.iter().chain([bare]).filter_map(better).max_by(|a, b| a.gain.total_cmp(&b.gain))
}

/// The best of the rivals if it is better than an evidence that does not pay for the places of effects
/// that stay.
fn best_of(rivals: Vec<Rival>, evidence: f64, places: f64) -> Option<Better> {
    let gain = |r: &Rival| r.evidence - places.ln() - evidence;
    let best = rivals.into_iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))?;
    let better =
        Better { gain: gain(&best), what: best.what, numbers: best.numbers, objective: best.objective };
    (better.gain > BETTER).then_some(better)
}

/// Every law at every place, made linear about a fit.
fn laws(campaign: &Campaign, forward: &Forward, fit: &Fit) -> Vec<Law> {
    let builder = Builder { campaign, forward, fit, torques_nm: forward.torques_nm(&fit.point.coefficients) };
    let joints = (0..forward.layout.joints.len()).flat_map(|j| builder.joint_laws(j));
    let mut out: Vec<Law> = joints.chain(builder.reading_laws()).collect();
    out.retain(|law| law.columns.iter().all(|c| c.iter().any(|x| *x != 0.0)));
    out
}

/// Fits each law together with the parameters of a fit.
fn rivals(forward: &Forward, fit: &Fit, laws: &[Law], weights: &Weights) -> Vec<Rival> {
    laws.par_iter().map(|law| rival(forward, fit, law, weights)).collect()
}

/// The linear fit of a model and a law.
fn rival(forward: &Forward, fit: &Fit, law: &Law, weights: &Weights) -> Rival {
    let own = fit.point.u.len();
    let n = own + law.columns.len();
    let mut columns = fit.jacobian.clone().resize_horizontally(n, 0.0);
    for (k, column) in law.columns.iter().enumerate() {
        columns.column_mut(own + k).copy_from_slice(column);
    }
    let mut origin = fit.point.u.clone();
    origin.resize(n, 0.0);
    let origin = DVector::from_vec(origin);
    let at = |u: &DVector<f64>| -> Vec<f64> {
        let delta = &columns * (u - &origin);
        fit.point.predicted.iter().zip(delta.iter()).map(|(p, d)| p + d).collect()
    };
    let (mut u, mut predicted) = (origin.clone(), fit.point.predicted.clone());
    let mut curvature = DMatrix::zeros(n, n);
    let mut here = fit.point.objective;
    for _ in 0..STEPS {
        let equations = normal(forward, fit.model.calibrated(), u.as_slice(), &predicted, &columns, weights);
        curvature = equations.curvature;
        let mut damped = curvature.clone();
        for p in fit.model.calibrated()..n {
            damped[(p, p)] += 12.0 / width(fit, own, p, u[p]).powi(2);
        }
        let Some(cholesky) = Cholesky::new(damped) else { break };
        u -= cholesky.solve(&equations.gradient);
        predicted = at(&u);
        let before = here;
        here = objective(forward, &fit.model, u.as_slice(), &predicted, weights);
        if (before - here).abs() < SETTLED {
            break;
        }
    }
    let objective = here;
    let mut evidence = -0.5 * objective;
    for p in fit.model.calibrated()..n {
        let width = width(fit, own, p, u[p]);
        curvature[(p, p)] += 12.0 / width.powi(2);
        evidence += 0.5 * TAU.ln() - width.ln();
    }
    let determinant = Cholesky::new(curvature)
        .map_or(f64::INFINITY, |c| 2.0 * c.l().diagonal().iter().map(|d| d.ln()).sum::<f64>());
    evidence -= 0.5 * determinant;
    Rival { what: law.what.clone(), numbers: law.columns.len(), objective, evidence }
}

/// Width of the prior of a parameter: that of an effect's knob, or of a law's number, whose size may be of
/// any order of magnitude.
fn width(fit: &Fit, own: usize, p: usize, u: f64) -> f64 {
    match p < own {
        true => fit.model.knobs().nth(p - fit.model.calibrated()).map_or(1.0, |k| k.width(u)),
        false => 2.0 * (1.0 / SMALL).ln_1p() * (u.abs() + SMALL),
    }
}

/// Where and when a joint carries a torque.
struct State {
    torque_nm: f64,
    angle_deg: f64,
    /// Part of the channel's tests that were done before.
    part: f64,
    channel: Channel,
}

/// A twist beyond torque over stiffness and its slope, each in torque over stiffness.
type Shape<'a> = &'a dyn Fn(&State) -> (f64, f64);

/// A column of a channel from a function of the datum and its predicted reading.
type ColumnOf<'a> = &'a dyn Fn(&dyn Fn(usize, f64) -> f64) -> Vec<f64>;

struct Builder<'a> {
    campaign: &'a Campaign,
    forward: &'a Forward,
    fit: &'a Fit<'a>,
    torques_nm: Vec<Vec<f64>>,
}

impl Builder<'_> {
    fn joint_laws(&self, joint: usize) -> Vec<Law> {
        let law = &self.fit.point.coefficients.laws[joint];
        let compliance = law.tangent_compliance_rad_per_nm(0.0);
        let statics = self.torques_nm.iter().map(|t| t[joint].abs());
        let largest_nm = statics.chain(self.forward.bench_torques_nm(joint)).fold(0.0, f64::max);
        if compliance == 0.0 || largest_nm == 0.0 {
            return Vec::new();
        }
        let name = &self.forward.layout.joints[joint].name;
        let column = |shape: Shape| self.joint_column(joint, compliance, shape);
        let part = |s: &State| s.torque_nm / largest_nm;
        let odd = [
            column(&|s| (s.torque_nm * part(s).abs(), 2.0 * part(s).abs())),
            column(&|s| (s.torque_nm * part(s).powi(2), 3.0 * part(s).powi(2))),
        ];
        let even = [
            column(&|s| (s.torque_nm.abs(), s.torque_nm.signum())),
            column(&|s| (s.torque_nm * part(s), 2.0 * part(s))),
        ];
        // at which angle the joint stood on the bench is not known
        let wave = |k: usize| {
            column(&|s| {
                let factor = if s.channel == Channel::Windup { 0.0 } else { waves(s.angle_deg)[k] };
                (s.torque_nm * factor, factor)
            })
        };
        let order = |channel: Channel, power: i32| {
            column(&|s| {
                let factor = if s.channel == channel { s.part.powi(power) } else { 0.0 };
                (s.torque_nm * factor, factor)
            })
        };
        let mut out =
            one_or_both(&format!("a stiffness of {name} that changes with the size of its torque"), odd);
        out.extend(one_or_both(
            &format!("a stiffness of {name} that differs between the senses of its torque"),
            even,
        ));
        if self.campaign.arm.driven_joint_names().contains(&name.as_str()) {
            let what = format!("a stiffness of {name} that changes with its angle");
            out.push(Law { what: what.clone(), columns: vec![wave(0), wave(1)] });
            out.push(Law { what, columns: vec![wave(2), wave(3)] });
        }
        for channel in [Channel::Static, Channel::Modal] {
            let what =
                format!("a stiffness of {name} that changes with the order of the {} tests", channel.word());
            out.extend(one_or_both(&what, [order(channel, 1), order(channel, 2)]));
        }
        out
    }

    /// What a further twist of a joint does to every reading.
    fn joint_column(&self, joint: usize, compliance: f64, shape: Shape) -> Vec<f64> {
        let forward = self.forward;
        let driven = self.campaign.arm.driven_joint_names();
        let own = driven.iter().position(|n| *n == forward.layout.joints[joint].name);
        let angle_deg = |pose: &[f64]| own.map_or(0.0, |j| pose[j]);
        let mut truth = vec![0.0; forward.data.len()];
        let mut row = 0;
        for pose in &forward.statics {
            let torques = pose.torques_nm(&forward.layout, &self.fit.point.coefficients);
            let loads = torques.len() - 1;
            for load in 0..loads {
                let state = |torque_nm: f64| State {
                    torque_nm,
                    angle_deg: angle_deg(&self.campaign.statics[row].pose_deg),
                    part: row as f64 / self.campaign.statics.len() as f64,
                    channel: Channel::Static,
                };
                let twist = shape(&state(torques[load + 1][joint])).0 - shape(&state(torques[0][joint])).0;
                for c in 0..3 {
                    truth[3 * row + c] = 1e3 * pose.geometry.joints[joint].tip[c] * compliance * twist;
                }
                row += 1;
            }
        }
        let slot = &forward.layout.joints[joint];
        for (test, solved) in forward.modal.iter().zip(&self.fit.point.solved) {
            for &(datum, mode) in &test.modes {
                let Some(s) = solved.get(mode) else { continue };
                let row = &self.campaign.modal[datum - forward.starts[1]];
                let state = State {
                    torque_nm: self.torques_nm[datum][joint],
                    angle_deg: angle_deg(&row.pose_deg),
                    part: (datum - forward.starts[1]) as f64 / self.campaign.modal.len() as f64,
                    channel: Channel::Modal,
                };
                let d_mu = s.y[slot.twist].powi(2) * compliance * shape(&state).1 / s.mu;
                truth[datum] = -0.5 * d_mu / s.mu / (TAU * s.mu.sqrt());
            }
        }
        for (row, datum) in self.campaign.windup.iter().zip(forward.range(Channel::Windup)) {
            if row.joint == slot.name {
                let state =
                    State { torque_nm: row.torque_nm, angle_deg: 0.0, part: 0.0, channel: Channel::Windup };
                truth[datum] = ARCMIN_PER_RAD * compliance * shape(&state).0;
            }
        }
        let channels = &self.fit.point.coefficients.channels;
        truth.iter().zip(&forward.data).map(|(t, d)| t * channels[d.channel as usize].factor).collect()
    }

    fn reading_laws(&self) -> Vec<Law> {
        let mut out = Vec::new();
        for channel in [Channel::Static, Channel::Modal, Channel::Windup] {
            let range = self.forward.range(channel);
            let reading = |i: usize| self.fit.point.predicted[i];
            let largest = range.clone().map(|i| reading(i).abs()).fold(0.0, f64::max);
            if largest == 0.0 {
                continue;
            }
            let column = |of: &dyn Fn(usize, f64) -> f64| -> Vec<f64> {
                let inside = |i: usize| if range.contains(&i) { of(i, reading(i)) } else { 0.0 };
                (0..self.forward.data.len()).map(inside).collect()
            };
            let bent = [column(&|_, d| d * d.abs() / largest), column(&|_, d| d * (d / largest).powi(2))];
            out.extend(one_or_both(
                &format!("{} readings that are not straight in the true value", channel.word()),
                bent,
            ));
            if channel == Channel::Static {
                out.extend(self.direction_laws(&column));
            }
        }
        out
    }

    /// A gain of its own for each direction; a turned frame.
    fn direction_laws(&self, column: ColumnOf) -> Vec<Law> {
        let data = &self.forward.data;
        let gain = |c: usize| column(&|i, d| if data[i].component == c { d } else { 0.0 });
        let turned = |axis: usize| {
            column(&|i, _| {
                let c = data[i].component;
                let first = i - c;
                let d = |k: usize| self.fit.point.predicted[first + k];
                match (3 + c - axis) % 3 {
                    1 => -d((axis + 2) % 3),
                    2 => d((axis + 1) % 3),
                    _ => 0.0,
                }
            })
        };
        vec![
            Law {
                what: "static readings with a gain of their own in each direction".into(),
                columns: (0..3).map(gain).collect(),
            },
            Law {
                what: "static readings in a frame that is turned".into(),
                columns: (0..3).map(turned).collect(),
            },
        ]
    }
}

/// The laws of the first column, the second, and both.
fn one_or_both(what: &str, columns: [Vec<f64>; 2]) -> Vec<Law> {
    let [a, b] = columns;
    let law = |columns| Law { what: what.to_string(), columns };
    vec![law(vec![a.clone()]), law(vec![b.clone()]), law(vec![a, b])]
}

#[cfg(test)]
mod tests {
    use super::super::fit::fit;
    use super::super::model::{Calibration, Model, Nuisance};
    use super::super::noise::Noise;
    use super::*;
    use crate::catalog::Catalogs;
    use std::path::Path;

    #[test]
    fn a_further_twist_in_proportion_to_the_torque_is_a_softer_joint() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        let forward = Forward::new(&campaign);
        let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
        let bare = Model::bare(&nuisance);
        let weights = Noise::default().weights(&forward);
        let effort = Effort { steps: 0, tolerance: 0.0 };
        let fit = fit(&forward, &bare, &vec![0.0; bare.len()], &weights, effort);
        let torques_nm = forward.torques_nm(&fit.point.coefficients);
        let builder = Builder { campaign: &campaign, forward: &forward, fit: &fit, torques_nm };
        let mut moving = 0;
        for (joint, slot) in forward.layout.joints.iter().enumerate() {
            let law = &fit.point.coefficients.laws[joint];
            let compliance = law.tangent_compliance_rad_per_nm(0.0);
            let column = builder.joint_column(joint, compliance, &|s| (s.torque_nm, 1.0));
            let is_own = |c: &Calibration| *c == Calibration::Stiffness(slot.name.clone());
            let p = nuisance.numbers.iter().position(|(c, _)| is_own(c)).expect("calibrated");
            let largest = fit.jacobian.column(p).amax();
            if largest < 1e-9 {
                continue; // its axis goes through the tip and the payload
            }
            moving += 1;
            for (i, own) in column.iter().enumerate() {
                let softer = -fit.jacobian[(i, p)] / nuisance.numbers[p].1;
                let scale = largest / nuisance.numbers[p].1;
                assert!((own - softer).abs() <= 1e-3 * scale, "{} datum {i}: {own} and {softer}", slot.name);
            }
        }
        assert!(moving >= 5, "only {moving} joints move a reading");
    }
}
