//! Laws without a name: smooth, general functions that are not effects of the library. They reveal physics that the
//! library lacks.
//!
//! A law may be a twist of a joint:
//!
//! - as a function of its torque (odd or even), of its angle or of the order of the tests,
//! - in proportion to the torque of a neighbouring joint,
//! - by friction that is proportional to the torque,
//! - by a zero of its angle that is off.
//!
//! A law may be a part that differs from the model:
//!
//! - a base, a bearing or a link that is more compliant in one direction only,
//! - a guide whose compliance changes with the position,
//! - a link whose mass, wall or length differs from the drawing,
//! - another direction of gravity,
//! - a stiffness that depends on the occasion of a reading (the order of the tests, how long a pose is kept, the temperature,
//!   the sense of loading), on the size of the load, or on the angle several times a turn.
//!
//! A law may also be an error of a reading as a function of the true value, of the direction, of the kind of load, of
//! the time in a pose, or of the order of the tests, like that of a base on ground that settles. A law consists of a few
//! columns: changes of the readings, linearized about a fit.

mod coupling;
mod course;
mod friction;
mod guides;
mod joints;
mod lengths;
mod level;
mod links;
mod occasions;
mod parts;
mod readings;
mod sizes;
mod zeros;

use self::occasions::{Occasion, occasions};
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::DVector;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The change of an angle that counts as the full size of a law \[deg\]. The prior of a law's size is relative to its
/// full size.
const FULL_ANGLE_DEG: f64 = 30.0;

/// A law without a name: a way in which readings can differ from the model.
#[derive(Clone)]
pub(crate) struct Law {
    /// Description of the law in words.
    pub what: String,
    /// Name of the part, or of the channel, that deviates: it says where an effect of the library with this law would be.
    /// `None` if the law has no such place.
    pub at: Option<String>,
    /// Name of an effect that is seldom met, if the law at its place only describes it more closely.
    pub refines: Option<&'static str>,
    /// Name of the effect of the library that is the same as this law; `None` if there is none.
    pub effect: Option<&'static str>,
    /// The law's columns: for each of its parameters, the change of each predicted reading per unit of the parameter,
    /// in the unit of the file.
    pub columns: Vec<Vec<f64>>,
}

impl Law {
    /// A law with its description `what` and its columns, that has no place and nothing to do with an effect.
    fn new(what: impl Into<String>, columns: Vec<Vec<f64>>) -> Self {
        Self { what: what.into(), at: None, refines: None, effect: None, columns }
    }
}

/// Calls `each` for every law at every place, and returns the results. The columns of a law are linearized about
/// `fit`. Laws are built in groups, because the columns of all laws together would need much memory.
pub(crate) fn of_every_law<T: Send>(
    campaign: &Campaign,
    forward: &Forward,
    fit: &Fit,
    each: impl Fn(&Law) -> T + Sync,
) -> Vec<T> {
    let builder = Builder::new(campaign, forward, fit);
    let mut out = Vec::new();
    let mut ask = |mut group: Vec<Law>| {
        // a law that changes no reading cannot be tested
        let is_seen = |law: &Law| law.columns.iter().all(|c| c.iter().any(|x| *x != 0.0));
        group.retain(|law| !law.columns.is_empty() && is_seen(law));
        out.par_extend(group.par_iter().map(&each));
    };
    for (joint, slot) in forward.layout.joints.iter().enumerate() {
        ask(placed(&slot.name, builder.joint_laws(joint)));
    }
    ask(builder.friction_laws());
    ask(builder.zero_laws());
    ask(builder.level_laws());
    ask(builder.course_laws());
    ask(builder.length_laws());
    ask(builder.coupling_laws());
    ask(builder.guide_laws());
    ask(builder.compliance_laws());
    ask(builder.link_laws());
    ask(builder.reading_laws());
    for part in builder.parts() {
        ask(placed(&part.at, [builder.occasion_laws(&part), builder.angle_laws(&part)].concat()));
    }
    ask(builder.size_laws());
    out
}

struct Builder<'a> {
    campaign: &'a Campaign,
    forward: &'a Forward,
    fit: &'a Fit<'a>,
    torques_nm: Vec<Vec<f64>>,
    /// The occasion of every reading, in the order of the data.
    occasions: Vec<Occasion>,
}

impl<'a> Builder<'a> {
    fn new(campaign: &'a Campaign, forward: &'a Forward, fit: &'a Fit<'a>) -> Self {
        let torques_nm = forward.torques_nm(&fit.point.coefficients);
        Self { campaign, forward, fit, torques_nm, occasions: occasions(campaign, forward) }
    }

    /// Sets the entries of `truth` that belong to frequencies: the first-order change of each frequency \[Hz\] when
    /// the compliance matrix changes by `dC`. `energy` receives the index of a modal test, that of a datum and the inertia
    /// forces `y` of its mode, and returns `yᵀ dC y`.
    fn add_modal(&self, truth: &mut [f64], energy: impl Fn(usize, usize, &DVector<f64>) -> f64) {
        for (index, (test, solved)) in self.forward.modal.iter().zip(&self.fit.point.solved).enumerate() {
            for &(datum, mode) in &test.modes {
                let Some(s) = solved.get(mode) else { continue };
                let d_mu = energy(index, datum, &s.y) / s.mu;
                truth[datum] = -0.5 * d_mu / s.mu / (TAU * s.mu.sqrt());
            }
        }
    }

    /// Converts changes of actual values into changes of the readings that the measuring channels show. `truth` has
    /// one entry per datum, in its unit.
    fn read(&self, truth: &[f64]) -> Vec<f64> {
        let channels = &self.fit.point.coefficients.channels;
        truth.iter().zip(&self.forward.data).map(|(t, d)| t * channels[d.channel as usize].factor).collect()
    }
}

/// The laws `laws`, all of them at the place `at`.
fn placed(at: &str, mut laws: Vec<Law>) -> Vec<Law> {
    laws.iter_mut().for_each(|law| law.at = Some(at.to_string()));
    laws
}

/// Three laws with the description `what`: one with the first column, one with the second, and one with both.
fn one_or_both(what: &str, columns: [Vec<f64>; 2]) -> Vec<Law> {
    let [a, b] = columns;
    [vec![a.clone()], vec![b.clone()], vec![a, b]].map(|columns| Law::new(what, columns)).into()
}

#[cfg(test)]
mod testing {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::reconcile::fit::descent::{Effort, fit};
    use crate::reconcile::fit::noise::Noise;
    use crate::reconcile::model::calibration::Nuisance;
    use crate::reconcile::model::parameters::Model;
    use std::path::Path;

    /// Calls `check` with a builder of laws for a test campaign, linearized about the nominal arm, and with the
    /// calibrated parameters.
    pub(super) fn about_the_nominal_arm(check: impl FnOnce(&Builder, &Nuisance)) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        let forward = Forward::new(&campaign);
        let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
        let baseline = Model::baseline(&nuisance);
        let weights = Noise::default().weights(&forward);
        let effort = Effort { steps: 0, tolerance: 0.0 };
        let fit = fit(&forward, &baseline, &vec![0.0; baseline.len()], &weights, effort);
        check(&Builder::new(&campaign, &forward, &fit), &nuisance);
    }
}
