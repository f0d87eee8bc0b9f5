//! Competing laws of a joint's angle: errors of the angle that are not a transmission error once and twice a turn, but
//! look like one if the joint turns through only a part of a turn. A sensor with a wrong scale makes an error in
//! proportion to the angle. The error of a cable or a magnet is a smooth function of the angle. The error of a gear's
//! teeth repeats many times a turn. Each law is tried in the place of a transmission error that was found, and fitted
//! with all other numbers of the model. If a law fits clearly better, the transmission error is not named. If the law
//! fits as well with fewer numbers, the verdict says so.

use super::analysis::Positions;
use super::fit::likeliest;
use super::fitted::Sample;
use super::kinematics::{Number, Placer};
use super::normal::Factor;
use super::pose::Pose;
use super::rows::normal;
use super::search::{FULL_FITS, TIE};
use super::transmission::{EFFECT, numbers};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Orders of the waves that are tried: the number of periods per turn.
const ORDERS: std::ops::RangeInclusive<usize> = 3..=12;
/// Number of Gauss-Newton steps with which a law is fitted. The errors of angles are small, so a few steps are enough.
const STEPS: usize = 3;

/// A law of a joint's angle: an error of the angle as a sum of functions of the angle.
enum AngleLaw {
    /// A polynomial of the angle, up to this power. It has no constant term, because the zero is calibrated already.
    Powers(i32),
    /// A sine and a cosine with this number of periods per turn.
    Waves(usize),
}

impl AngleLaw {
    /// All laws, the simplest first.
    fn all() -> Vec<AngleLaw> {
        [1, 2, 3].map(AngleLaw::Powers).into_iter().chain(ORDERS.map(AngleLaw::Waves)).collect()
    }

    /// Values of the law's functions at an angle \[rad\].
    fn at(&self, angle_rad: f64) -> Vec<f64> {
        match self {
            AngleLaw::Powers(most) => (1..=*most).map(|power| (angle_rad / PI).powi(power)).collect(),
            AngleLaw::Waves(order) => {
                let (sin, cos) = libm::sincos(*order as f64 * angle_rad);
                vec![sin, cos]
            }
        }
    }

    /// The law in words, for the joint `name`.
    fn words(&self, name: &str) -> String {
        match self {
            AngleLaw::Powers(1) => format!("an angle of {name} that is off in proportion to itself"),
            AngleLaw::Powers(_) => format!("an angle of {name} that is off by a smooth curve"),
            AngleLaw::Waves(order) => format!("an angle of {name} that is off {order} times a turn"),
        }
    }
}

/// A law of a joint's angle that competes with a transmission error that was found: the law is fitted in place of the
/// transmission error.
pub(super) struct Competing {
    /// Name of the joint.
    joint: String,
    /// The law in words.
    words: String,
    /// Logarithm of the likelihood with the law, less the logarithm of the likelihood with the transmission error.
    likelihood_gain: f64,
    /// `likelihood_gain`, less the price of the law, plus the price of the transmission error.
    score_gain: f64,
}

impl Competing {
    /// Sentence that the transmission error must not be named, because the law fits clearly better, or about as well
    /// with so few numbers that it is far more probable. `None` if neither holds.
    pub(super) fn better(&self) -> Option<String> {
        (self.score_gain > 0.0 && self.likelihood_gain.max(self.score_gain) > TIE).then(|| {
            format!(
                "{} explains the positions better than {EFFECT}@{}: this is no error once and twice a turn",
                self.words, self.joint
            )
        })
    }

    /// The sentence that the law explains as much as the transmission error with fewer numbers; `None` if the law does
    /// not.
    pub(super) fn as_good(&self) -> Option<String> {
        (self.score_gain > 0.0).then(|| {
            format!(
                "{} would explain as much as {EFFECT}@{}, with fewer numbers: turn the joint through a whole turn to tell them \
                 apart",
                self.words, self.joint
            )
        })
    }
}

impl Positions {
    /// For each transmission error of the model, the law of the joint's angle that competes best with it.
    pub(super) fn angle_laws(&self) -> Vec<Competing> {
        self.transmissions.iter().filter_map(|joint| self.best_angle_law(*joint)).collect()
    }

    /// The law of the angle of the driven joint `joint` with the best score in the place of its transmission error. All laws
    /// are screened with the linearized model, and the most promising are fitted in full.
    fn best_angle_law(&self, joint: usize) -> Option<Competing> {
        let without = self.without_transmission(joint);
        let laws = AngleLaw::all();
        let counts: Vec<usize> = laws.iter().map(|law| law.at(0.0).len()).collect();
        let gains = without.linear_gains(&without.fitted, &counts, true, &|sample, placer, columns| {
            laws.iter().for_each(|law| without.push_columns(law, joint, sample, placer, columns));
        });
        let mut order: Vec<(&AngleLaw, f64)> = laws.iter().zip(gains).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        order.truncate(FULL_FITS);
        let places = self.tree.driven.len();
        let named_price = self.price(numbers(joint).count(), places);
        let competing = order.into_par_iter().filter_map(|(law, _)| {
            let likelihood_gain = without.with_angle_law(joint, law)? - self.fitted.ln_likelihood;
            // the price also charges for the choice among the laws
            let price = self.price(law.at(0.0).len(), places * laws.len());
            Some(Competing {
                joint: self.tree.driven[joint].clone(),
                words: law.words(&self.tree.driven[joint]),
                likelihood_gain,
                score_gain: likelihood_gain + named_price - price,
            })
        });
        let competing: Vec<Competing> = competing.collect();
        competing.into_iter().max_by(|a, b| a.score_gain.total_cmp(&b.score_gain))
    }

    /// Appends to `columns` the derivatives of a sample's position with respect to the amplitudes of a law of the driven
    /// joint `joint` \[m\].
    fn push_columns(
        &self,
        law: &AngleLaw,
        joint: usize,
        sample: &Sample,
        placer: &Placer,
        columns: &mut Vec<Vector3<f64>>,
    ) {
        let mut slope = Vec::with_capacity(1);
        placer.slopes(sample.placing(), &[Number::Zero(joint)], &mut slope);
        let read_rad = self.samples[sample.index].pose.turns()[joint].rad;
        columns.extend(law.at(read_rad).into_iter().map(|size| slope[0] * size));
    }

    /// The logarithm of the likelihood of this model with the law `law` of the angle of the driven joint `joint`. The
    /// amplitudes are found by Gauss-Newton steps, with all other numbers of the model fitted again after each. `None`
    /// if the positions do not determine the amplitudes.
    fn with_angle_law(&self, joint: usize, law: &AngleLaw) -> Option<f64> {
        let mut samples = self.samples.clone();
        let mut sizes = vec![0.0; law.at(0.0).len()];
        let mut fitted = self.fitted.clone();
        for _ in 0..STEPS {
            let all: Vec<&Sample> = samples.iter().collect();
            let normal = normal(&all, &self.numbers, &fitted, &|sample, placer, columns| {
                self.push_columns(law, joint, sample, placer, columns);
            });
            let own: Vec<usize> = (0..normal.own + sizes.len()).collect();
            let step = Factor::new(&normal.curvature, &own)?.solve(&normal.gradient);
            sizes.iter_mut().zip(step.iter().skip(normal.own)).for_each(|(size, step)| *size += step);
            for (sample, read) in samples.iter_mut().zip(&self.samples) {
                let mut angles_rad = read.pose.angles_rad();
                let off_rad: f64 =
                    law.at(angles_rad[joint]).iter().zip(&sizes).map(|(at, size)| at * size).sum();
                angles_rad[joint] += off_rad;
                sample.pose = Pose::new(&angles_rad);
            }
            let all: Vec<&Sample> = samples.iter().collect();
            fitted = likeliest(&all, &self.numbers, &self.fitted.effects, &fitted);
        }
        Some(fitted.ln_likelihood)
    }
}
