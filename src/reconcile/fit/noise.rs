//! Finds gross errors and wrongly declared standard deviations from the residuals of a model.

use super::descent::Fit;
use super::held_out::rms;
use super::stats::{MEDIAN_OF_NORMAL, median};
use super::weights::Weights;
use crate::arm::effect::channel::Channel;
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::datum::Datum;
use crate::reconcile::forward::modal::ModalTest;
use crate::reconcile::forward::prepared::Forward;
use std::collections::{HashMap, HashSet};

/// Quality of the readings as the residuals of a fit show it: gross errors, and how much more the readings scatter
/// than declared.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// Factors on the declared standard deviations of static, modal and windup readings, in this order.
    pub scale: [f64; 3],
    /// Rows that are gross errors.
    pub outliers: Vec<Outlier>,
}

/// A row that is far from what a model predicts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Kind of the reading.
    pub channel: Channel,
    /// Row of the file, counted from 0.
    pub row: usize,
    /// Size of the residual in declared standard deviations.
    pub sigmas: f64,
}

impl Outlier {
    /// The place of the row among all readings.
    fn place(&self) -> (usize, usize) {
        (self.channel as usize, self.row)
    }
}

/// Charge for a gross error that is assumed instead of an effect \[ln of the evidence\]. About one row in a thousand
/// is a gross error, and ln 1000 is about 7.
pub(crate) const GROSS_ERROR_CHARGE: f64 = 7.0;
/// A reading is a gross error if its residual exceeds this many standard deviations. If the model fits a channel badly,
/// the standard deviation of the channel's residuals counts instead of the declared one, up to three times the latter.
const GROSS_SIGMAS: f64 = 5.5;
/// A row is a gross error, before any effect is sought, only if its residual is larger than this \[standard
/// deviations\]. The limit is high, because play or a break point can shift a single reading by ten standard
/// deviations.
const UNMISTAKABLE_SIGMAS: f64 = 16.0;
/// Largest fraction of a channel's rows, or of the positions, that can be gross errors. If there are more, the cause is
/// something that the model lacks.
pub(crate) const FEW: f64 = 0.10;
/// Largest fraction of a channel's rows that can be gross errors before any effect is sought. It is smaller than
/// [`FEW`], because an effect may change only a few frequencies, and these must not be left out.
const FEW_UNSEEN: f64 = 0.05;
/// If at least this many rows of a channel are gross errors below [`UNMISTAKABLE_SIGMAS`], they are no slips: slips are
/// few, and mostly much larger.
const FEWEST_ODD_ROWS: usize = 3;
/// Largest fraction of the frequency lists (modes of one pose and payload) that can have been numbered wrongly.
const FEW_LISTS: f64 = 0.34;
/// Largest number of gross errors that may be assumed instead of an effect. More of them have a common cause.
const MOST_SLIPS: usize = 2;
/// The channels (kinds of readings) whose quality is judged.
const CHANNELS: [Channel; 3] = [Channel::Static, Channel::Modal, Channel::Windup];
/// Largest factor on the declared standard deviations. A larger scatter is ascribed to missing physics and not to a
/// wrong declaration.
const LARGEST_SCALE: f64 = 1.4;
/// A model fits most readings of a channel if the standard deviation of its residuals exceeds the declared one by at
/// most this fraction. The standard deviation is estimated from the median of their absolute values (robust). For a
/// channel with few readings, [`BY_CHANCE`] allows more.
const CLOSE_FIT: f64 = 0.5;
/// Allowance for chance when the robust standard deviation of n residuals is tested: it may exceed the declared one
/// by the fraction `BY_CHANCE / √n`. This is three times its own standard deviation, which is 1.17 / √n of the
/// declared one, because it comes from the median of absolute values.
const BY_CHANCE: f64 = 3.5;
/// Weight of the declared standard deviation when its factor is estimated from the residuals, as a number of
/// readings.
const WEIGHT_OF_DECLARED: f64 = 15.0;

impl Default for Noise {
    fn default() -> Self {
        Self { scale: [1.0; 3], outliers: Vec::new() }
    }
}

impl Noise {
    /// Weights of the data: gross errors get 0, and all other data the reciprocal of their standard deviation times
    /// the factor of the channel.
    pub fn weights(&self, forward: &Forward) -> Weights {
        let outliers: HashSet<(usize, usize)> = self.outliers.iter().map(Outlier::place).collect();
        let inverse = forward.data.iter().map(|d| {
            let gross = outliers.contains(&(d.channel as usize, d.row));
            if gross { 0.0 } else { 1.0 / (d.sigma * self.scale[d.channel as usize]) }
        });
        Weights { inverse: inverse.collect(), smooth_only: false }
    }

    /// The weights `weights` with the standard deviations of each channel enlarged to the root mean square of the residuals
    /// that a model leaves there, if they are smaller. `predicted` are the readings of this model.
    pub(crate) fn enlarged(weights: &Weights, forward: &Forward, predicted: &[f64]) -> Weights {
        let mut out = weights.clone();
        for channel in CHANNELS {
            let own = forward.range(channel);
            let used = own.clone().filter(|i| weights.inverse[*i] > 0.0);
            let left = rms(used.map(|i| (forward.data[i].value - predicted[i]) * weights.inverse[i]));
            out.inverse[own].iter_mut().for_each(|inverse| *inverse /= left.max(1.0));
        }
        out
    }

    /// Whether the model of `fit` fits most readings of every channel, judged by the robust standard deviation of the
    /// residuals.
    pub fn is_close(forward: &Forward, fit: &Fit) -> bool {
        let residuals = declared_residuals(forward, &fit.point.predicted);
        CHANNELS.into_iter().all(|channel| {
            let own = &residuals[forward.range(channel)];
            spread(own) < 1.0 + CLOSE_FIT.max(BY_CHANCE / (own.len() as f64).sqrt())
        })
    }

    /// Judges the readings before an effect is sought, by their residuals in `fit`, which was fitted with `weights`. At
    /// most a few extreme outliers of each channel are left out. A single wrong frequency among ten would spoil a
    /// calibration.
    pub fn without_worst(forward: &Forward, fit: &Fit, weights: &Weights) -> Self {
        let mut outliers = misses(forward, fit, weights);
        outliers.retain(|outlier| outlier.sigmas > UNMISTAKABLE_SIGMAS);
        let mut left = CHANNELS.map(|channel| at_most(FEW_UNSEEN, rows(forward, channel)));
        outliers.retain(|outlier| {
            let of_channel = &mut left[outlier.channel as usize];
            let is_among = *of_channel > 0;
            *of_channel -= usize::from(is_among);
            is_among
        });
        Self { outliers, ..Self::default() }
    }

    /// This judgement with one or two more rows left out. These rows are gross errors with the model of `fit`. `None`
    /// if there are no such rows, or more than two.
    pub fn with_slips(&self, forward: &Forward, fit: &Fit) -> Option<Self> {
        let mut slips = misses(forward, fit, &self.weights(forward));
        slips.retain(|slip| slip.sigmas > GROSS_SIGMAS);
        slips.retain(|slip| !self.outliers.iter().any(|known| known.place() == slip.place()));
        let residuals = declared_residuals(forward, &fit.point.predicted);
        let slips: Vec<Outlier> = CHANNELS
            .into_iter()
            .flat_map(|channel| {
                let range = forward.range(channel);
                let own = slips.iter().filter(|slip| slip.channel == channel);
                let own = own.map(|slip| (slip.row, slip.sigmas)).collect();
                let kept = without_runs(&forward.data[range.clone()], &residuals[range], own);
                kept.into_iter().map(move |(row, sigmas)| Outlier { channel, row, sigmas })
            })
            .collect();
        if slips.is_empty() || slips.len() > MOST_SLIPS {
            return None;
        }
        let mut outliers = [self.outliers.clone(), slips].concat();
        outliers.sort_by_key(Outlier::place);
        Some(Self { outliers, ..self.clone() })
    }

    /// This judgement with all frequencies kept as good readings; `None` if it leaves out no frequency.
    pub fn with_frequencies(&self) -> Option<Self> {
        let mut with = self.clone();
        with.outliers.retain(|outlier| outlier.channel != Channel::Modal);
        (with.outliers.len() < self.outliers.len()).then_some(with)
    }

    /// Gross errors that are visible before any effect is sought, by the residuals of the baseline (calibration
    /// alone). They are sought only if the baseline fits most readings, because the signal of an effect must not be
    /// taken for an error.
    pub fn first_look(forward: &Forward, baseline: &Fit, weights: &Weights) -> Self {
        if !Self::is_close(forward, baseline) {
            return Self::default();
        }
        let residuals = declared_residuals(forward, &baseline.point.predicted);
        let mut outliers = Self::from_fit(forward, baseline, weights).outliers;
        outliers.retain(|outlier| outlier.sigmas > UNMISTAKABLE_SIGMAS);
        let in_channel = |channel| outliers.iter().filter(|outlier| outlier.channel == channel).count();
        let few: Vec<Channel> = CHANNELS
            .into_iter()
            .filter(|c| in_channel(*c) <= at_most(FEW_UNSEEN, rows(forward, *c)))
            .collect();
        outliers.retain(|outlier| few.contains(&outlier.channel));
        Self { outliers, ..Self::default() }.with_whole_lists(forward, &residuals)
    }

    /// Judges the readings by the residuals of `fit`, which was fitted with `weights`: finds gross errors, and a
    /// factor on the declared standard deviations of each channel.
    pub fn from_fit(forward: &Forward, fit: &Fit, weights: &Weights) -> Self {
        let mut noise = Self::default();
        let residuals = declared_residuals(forward, &fit.point.predicted);
        let leverages = fit.leverages(weights);
        for channel in CHANNELS {
            let range = forward.range(channel);
            let own = &residuals[range.clone()];
            // if the model fits badly, only rows whose residuals stand out from those of the other rows are gross
            // errors
            let limit = GROSS_SIGMAS * spread(own).clamp(1.0, 3.0);
            let data = &forward.data[range.clone()];
            let mut gross = largest_of_rows(data.iter().zip(own.iter().map(|r| r.abs())));
            gross.retain(|(_, size)| *size > limit);
            // many large residuals have a common cause and are no gross errors
            if gross.len() > at_most(FEW, rows(forward, channel)) {
                continue;
            }
            let gross = without_runs(data, own, gross);
            noise.outliers.extend(gross.iter().map(|&(row, sigmas)| Outlier { channel, row, sigmas }));
            let gross: HashSet<usize> = gross.into_iter().map(|(row, _)| row).collect();
            let kept = range.filter(|i| !gross.contains(&forward.data[*i].row));
            noise.scale[channel as usize] = scale(kept.map(|i| (residuals[i], leverages[i])));
        }
        noise.with_whole_lists(forward, &residuals)
    }

    /// Leaves out the few frequency lists (modes of one pose and payload) in which the model with these coefficients
    /// misses several frequencies by more than 16 standard deviations. `None` if there is no such list, or if more than
    /// a third of the lists are such lists.
    pub fn uncertain_lists(forward: &Forward, coefficients: &Coefficients) -> Option<Self> {
        let residuals = declared_residuals(forward, &forward.predict(coefficients));
        let far = |datum: usize| residuals[datum].abs() > UNMISTAKABLE_SIGMAS;
        let is_doubtful = |test: &&ModalTest| test.modes.iter().filter(|(datum, _)| far(*datum)).count() > 1;
        let doubtful: Vec<&ModalTest> = forward.modal.iter().filter(is_doubtful).collect();
        if doubtful.is_empty() || doubtful.len() > at_most(FEW_LISTS, forward.modal.len()) {
            return None;
        }
        let rows = doubtful.iter().flat_map(|test| &test.modes);
        let outlier = |&(datum, _): &(usize, usize)| Outlier {
            channel: Channel::Modal,
            row: forward.data[datum].row,
            sigmas: residuals[datum].abs(),
        };
        Some(Self { outliers: rows.map(outlier).collect(), ..Self::default() })
    }

    /// This judgement with further rows left out: all rows of each frequency list that has several gross errors. The
    /// pose, the payload or the numbering of such a list is wrong, and its remaining rows would mislead.
    fn with_whole_lists(mut self, forward: &Forward, residuals: &[f64]) -> Self {
        for list in gross_lists(forward, &self.weights(forward)) {
            for &(datum, _) in &forward.modal[list].modes {
                let (channel, row) = (Channel::Modal, forward.data[datum].row);
                let outlier = Outlier { channel, row, sigmas: residuals[datum].abs() };
                if !self.outliers.iter().any(|known| known.place() == outlier.place()) {
                    self.outliers.push(outlier);
                }
            }
        }
        self.outliers.sort_by_key(Outlier::place);
        self
    }

    /// Sentences on channels whose readings scatter more than noise as declared and single slips can explain: the
    /// factor on the declared standard deviations is at its limit, or several rows are somewhat too far off to be noise.
    /// Empty if there are none.
    pub(crate) fn beyond_declaration(&self) -> Vec<String> {
        let of_channel = |channel: Channel| {
            let at_limit = self.scale[channel as usize] >= LARGEST_SCALE;
            let is_near = |o: &&Outlier| o.channel == channel && o.sigmas < UNMISTAKABLE_SIGMAS;
            let near = self.outliers.iter().filter(is_near);
            let near: Vec<String> = near.map(|o| format!("{:.0}", o.sigmas)).collect();
            let is_odd = near.len() >= if at_limit { 1 } else { FEWEST_ODD_ROWS };
            let word = channel.word();
            let scatter = at_limit.then(|| {
                format!("the {word} readings scatter at least {LARGEST_SCALE} times as much as declared")
            });
            let odd = is_odd.then(|| {
                format!("{} row(s) of the {word} readings are off by {} sigma", near.len(), near.join(", "))
            });
            scatter.into_iter().chain(odd)
        };
        CHANNELS.into_iter().flat_map(of_channel).collect()
    }

    /// Whether this judgement and `other` leave out the same rows.
    pub fn same_rows(&self, other: &Self) -> bool {
        let rows = |n: &Self| n.outliers.iter().map(Outlier::place).collect::<Vec<_>>();
        rows(self) == rows(other)
    }

    /// Whether this judgement and `other` leave out the same rows and have factors on the standard deviations that
    /// differ by less than 3 %.
    pub fn agrees(&self, other: &Self) -> bool {
        self.same_rows(other) && self.scale.iter().zip(&other.scale).all(|(a, b)| (a / b - 1.0).abs() < 0.03)
    }
}

/// Indices of the frequency lists (modes of one pose and payload) of which `weights` leave out more than one row.
pub fn gross_lists(forward: &Forward, weights: &Weights) -> Vec<usize> {
    let left_out = |list: usize| {
        let modes = forward.modal[list].modes.iter();
        modes.filter(|(datum, _)| weights.inverse[*datum] == 0.0).count()
    };
    (0..forward.modal.len()).filter(|list| left_out(*list) > 1).collect()
}

/// The standardized residual of each row of each channel \[declared standard deviations\], the largest one first. It is
/// the residual divided by the root of one minus the leverage, which is the fraction of the datum's variance that the
/// fitted parameters absorb.
fn misses(forward: &Forward, fit: &Fit, weights: &Weights) -> Vec<Outlier> {
    // prevents a division by zero for a row that the fit follows completely
    const LARGEST_LEVERAGE: f64 = 0.9;
    let residuals = declared_residuals(forward, &fit.point.predicted);
    let sizes = residuals.iter().zip(fit.leverages(weights));
    let sizes = sizes.map(|(r, leverage)| r.abs() / (1.0 - leverage.min(LARGEST_LEVERAGE)).sqrt());
    let sizes: Vec<f64> = sizes.collect();
    let mut out: Vec<Outlier> = Vec::new();
    for channel in CHANNELS {
        let range = forward.range(channel);
        let own = forward.data[range.clone()].iter().zip(sizes[range].iter().copied());
        out.extend(largest_of_rows(own).into_iter().map(|(row, sigmas)| Outlier { channel, row, sigmas }));
    }
    out.sort_by(|a, b| b.sigmas.total_cmp(&a.sigmas));
    out
}

/// The gross errors `gross` of a channel (row and size), without those that form a run. A run consists of consecutive
/// rows of one pose, or of the bench, with errors of the same sign. Slips are single rows, whereas a run has a cause,
/// such as a clamp that slips at the end of a load.
fn without_runs(data: &[Datum], residuals: &[f64], gross: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    // the datum with the largest error of each row, and this error
    let mut worst: HashMap<usize, (&Datum, f64)> = HashMap::new();
    for (datum, residual) in data.iter().zip(residuals) {
        let own = worst.entry(datum.row).or_insert((datum, *residual));
        if residual.abs() > own.1.abs() {
            *own = (datum, *residual);
        }
    }
    let is_run = |a: usize, b: usize| match (worst.get(&a), worst.get(&b)) {
        (Some((a, error_a)), Some((b, error_b))) => {
            a.component == b.component && a.group == b.group && error_a.signum() == error_b.signum()
        }
        _ => false,
    };
    // the modes of a list are consecutive rows only because of their numbers, so a run of them means nothing
    let in_order = data.first().is_some_and(|datum| datum.channel != Channel::Modal);
    let rows: HashSet<usize> = gross.iter().map(|(row, _)| *row).collect();
    let follows = |row: usize| {
        let next = rows.contains(&(row + 1)) && is_run(row, row + 1);
        next || (row > 0 && rows.contains(&(row - 1)) && is_run(row - 1, row))
    };
    gross.into_iter().filter(|(row, _)| !(in_order && follows(*row))).collect()
}

/// The rows of a channel, each with the largest of the `sizes` of its data. The rows come in the order of their first
/// datum.
fn largest_of_rows<'a>(sizes: impl Iterator<Item = (&'a Datum, f64)>) -> Vec<(usize, f64)> {
    let mut out: Vec<(usize, f64)> = Vec::new();
    let mut known: HashMap<usize, usize> = HashMap::new();
    for (datum, size) in sizes {
        let at = *known.entry(datum.row).or_insert_with(|| {
            out.push((datum.row, size));
            out.len() - 1
        });
        out[at].1 = out[at].1.max(size);
    }
    out
}

/// Number of rows of a channel that have a datum. The data of a row follow each other.
fn rows(forward: &Forward, channel: Channel) -> usize {
    forward.data[forward.range(channel)].chunk_by(|a, b| a.row == b.row).count()
}

/// Number of rows that make up the fraction `part` of a file with `rows` rows, at least one.
fn at_most(part: f64, rows: usize) -> usize {
    ((part * rows as f64) as usize).max(1)
}

/// Residuals of the readings `predicted`, measured minus predicted \[declared standard deviations\].
fn declared_residuals(forward: &Forward, predicted: &[f64]) -> Vec<f64> {
    forward.data.iter().zip(predicted).map(|(d, p)| (d.value - p) / d.sigma).collect()
}

/// Robust standard deviation of the residuals, in their unit, from the median of their absolute values. A few large
/// residuals do not change it.
fn spread(residuals: &[f64]) -> f64 {
    median(residuals.iter().map(|r| r.abs()).collect()) / MEDIAN_OF_NORMAL
}

/// Factor on the declared standard deviations of a channel, at least 1. `kept` gives the residual and the leverage of
/// each datum of the channel that is no gross error. The square of a residual has the expectation `1 - leverage`,
/// because the parameters absorb the rest. A factor that could be chance is applied too: waiting for significance would
/// leave intervals too narrow in channels with few readings.
fn scale(kept: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, count) = kept.fold((WEIGHT_OF_DECLARED, WEIGHT_OF_DECLARED), |(sum, count), (r, leverage)| {
        (sum + r * r, count + 1.0 - leverage)
    });
    (sum / count).sqrt().clamp(1.0, LARGEST_SCALE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forty_readings_a_sixth_noisier_than_declared_are_scaled_though_chance_could_do_that() {
        // of 40 squares with a quarter of each taken up by parameters, declared 1, true 1.15
        let readings = (0..40).map(|_| (1.15 * 0.75f64.sqrt(), 0.25));
        assert!((scale(readings) - ((15.0 + 30.0 * 1.15f64.powi(2)) / 45.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn rows_that_slip_one_after_the_other_are_a_structure() {
        let datum = |row: usize, group: usize| Datum {
            channel: Channel::Static,
            row,
            index: row,
            component: 0,
            group,
            value: 0.0,
            sigma: 1.0,
        };
        let data: Vec<Datum> = [0, 0, 0, 1, 1, 1].into_iter().enumerate().map(|(r, g)| datum(r, g)).collect();
        let kept = |residuals: [f64; 6]| {
            let gross = (0..6).filter(|r| residuals[*r].abs() > 5.0).map(|r| (r, residuals[r].abs()));
            let kept = without_runs(&data, &residuals, gross.collect());
            kept.into_iter().map(|(row, _)| row).collect::<Vec<_>>()
        };
        assert_eq!(kept([0.0, 0.0, 0.0, 0.0, 9.0, 8.0]), [0; 0], "the end of a load");
        assert_eq!(kept([0.0, 0.0, 0.0, 0.0, 9.0, -8.0]), [4, 5], "in both senses");
        assert_eq!(kept([0.0, 0.0, 9.0, 8.0, 0.0, 0.0]), [2, 3], "in two poses");
        assert_eq!(kept([9.0, 0.0, 8.0, 0.0, 0.0, 0.0]), [0, 2], "apart");
    }

    #[test]
    fn noise_at_its_limit_and_several_odd_rows_are_beyond_the_declaration() {
        let said = |scale: f64, sigmas: &[f64]| {
            let outlier =
                |(row, sigmas): (usize, &f64)| Outlier { channel: Channel::Static, row, sigmas: *sigmas };
            let outliers = sigmas.iter().enumerate().map(outlier).collect();
            Noise { scale: [scale, 1.0, 1.0], outliers }.beyond_declaration()
        };
        assert_eq!(said(1.39, &[7.0, 8.0, 98.0]), [""; 0], "two odd rows and a slip");
        assert_eq!(said(1.0, &[7.0, 8.0, 9.0]), ["3 row(s) of the static readings are off by 7, 8, 9 sigma"]);
        let at_limit = said(LARGEST_SCALE, &[7.0]);
        assert!(at_limit.len() == 2 && at_limit[0].contains("at least 1.4 times"), "{at_limit:?}");
    }

    #[test]
    fn a_declaration_is_neither_improved_nor_blamed_for_missing_physics() {
        assert_eq!(scale((0..40).map(|_| (0.5, 0.0))), 1.0);
        assert_eq!(scale((0..40).map(|_| (5.0, 0.0))), LARGEST_SCALE);
    }
}
