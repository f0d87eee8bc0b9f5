//! The threshold of an effect is the torque scale of a joint's play, or the preload of a base that lifts off. This
//! module finds its best value, and the intervals of the threshold and of the half width or stiffness that depends on
//! it.
//!
//! A few thresholds are tried in the search for effects. The best of them is refined, because a wrong threshold changes
//! the half width too and leaves a structure in the errors. The intervals are those of the profile likelihood. At each
//! threshold `s`, the logarithm of the likelihood falls from its best value `L(s)` like a parabola in the half width
//! `h`. So the interval of `h` is the union of `h(s) ± σ(s) √(2 (1.92 - (L_max - L(s))))` over all `s`.
//!
//! In a long campaign the threshold was refined already on the rows on which effects are screened. Near this value, the
//! logarithm of the likelihood of all rows is close to a parabola in the logarithm of the threshold. So a few fits find
//! the vertex of this parabola, and only the nearest thresholds on both sides are tried for the interval.

use super::analysis::Positions;
use super::fit::{fit, likeliest};
use super::fitted::{Fitted, Sample};
use super::kinematics::Number;
use crate::reconcile::model::estimate::{Estimate, RISE_AT_95};
use rayon::prelude::*;
use std::sync::Arc;

/// Fall of the logarithm of the likelihood at the ends of a 95 % interval: half of the 95 % quantile of chi-squared
/// with one degree of freedom.
const FALL: f64 = RISE_AT_95 / 2.0;
/// Number of steps of the golden section search for the best threshold. They narrow the threshold to an interval of 0.4
/// %.
const STEPS: usize = 13;
/// Fraction of an interval that remains after each step of the golden section search.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// A better threshold is sought between the best one so far divided by this factor and the best one so far times this
/// factor. The torque scales of play that the search tries differ by about this factor.
const BRACKET: f64 = 2.7;
/// The likelihood is computed for the intervals at thresholds whose ratio to the best one is one of these, or its
/// reciprocal.
const RATIOS: [f64; 8] = [1.05, 1.12, 1.25, 1.5, 2.0, 3.0, 6.0, 20.0];
/// The size is also computed at thresholds between the best one and each end of its interval. These are the positions
/// of these thresholds as fractions of the way, in the logarithm of the threshold.
const PARTS: [f64; 4] = [0.3, 0.6, 0.85, 0.97];
/// Distances between the logarithms of the three thresholds through which a parabola is fitted, for the first and the
/// second parabola.
const WIDTHS: [f64; 2] = [0.1, 0.03];
/// The vertex of a parabola is moved no farther from the middle point than this many times the distance of the points.
const FARTHEST: f64 = 3.0;
/// Largest threshold that is tried, as a multiple of the largest torque. Play with a larger torque scale acts as a
/// spring.
const LARGEST_RATIO: f64 = 3.0;

/// A fit, with standard deviations or without.
type Fit = fn(&[&Sample], &[Number], &[usize], &Fitted) -> Fitted;

/// The size of an effect and its likelihood for one value of its threshold.
struct Tried {
    threshold_nm: f64,
    size: f64,
    deviation: f64,
    /// By how much the logarithm of the likelihood is lower than with the best threshold. The difference is divided by
    /// the factor by which heavy tails of the errors and compliances outside the model increase the variance of the
    /// size.
    fall: f64,
}

impl Tried {
    /// Half of the width of the interval of the size at this threshold; `None` if no size is likely enough.
    fn reach(&self) -> Option<f64> {
        (self.fall < FALL).then(|| self.deviation * (2.0 * (FALL - self.fall.max(0.0))).sqrt())
    }
}

impl Positions {
    /// Replaces the thresholds of the model's effects by better ones, and fits the model again. The best threshold
    /// changes with every further effect.
    pub(super) fn refine_thresholds(&mut self) {
        for position in 0..self.fitted.effects.len() {
            let Some(from_nm) = self.threshold_nm(position) else { continue };
            let most_nm = LARGEST_RATIO * self.largest_torque_nm(position);
            let [low, high] = [from_nm / BRACKET, (from_nm * BRACKET).min(most_nm)].map(libm::log);
            let best = match self.is_long() {
                true => self.at_the_vertex(position, libm::log(from_nm), high),
                false => self.golden_section(position, low, high),
            };
            if best.fitted.ln_likelihood > self.fitted.ln_likelihood {
                *self = best;
                self.refit();
            }
        }
    }

    /// The model with the best threshold of effect number `position`, by a golden section search between two logarithms
    /// of the threshold \[ln(N m)\].
    fn golden_section(&self, position: usize, mut low: f64, mut high: f64) -> Self {
        let at = |ln: f64| (ln, self.with_threshold(position, libm::exp(ln), likeliest));
        let is_better = |a: &Self, b: &Self| a.fitted.ln_likelihood > b.fitted.ln_likelihood;
        let mut left = at(high - GOLDEN * (high - low));
        let mut right = at(low + GOLDEN * (high - low));
        for _ in 0..STEPS {
            if is_better(&left.1, &right.1) {
                high = right.0;
                right = left;
                left = at(high - GOLDEN * (high - low));
            } else {
                low = left.0;
                left = right;
                right = at(low + GOLDEN * (high - low));
            }
        }
        if is_better(&left.1, &right.1) { left.1 } else { right.1 }
    }

    /// The model with the best threshold of effect number `position`. The logarithm of the likelihood is computed at
    /// three thresholds about `ln_nm` \[ln(N m)\], and then at the vertex of the parabola through these values. This is
    /// done for each width of [`WIDTHS`]. `high` is the largest logarithm of a threshold that is tried.
    fn at_the_vertex(&self, position: usize, mut ln_nm: f64, high: f64) -> Self {
        let at = |ln: f64| self.with_threshold(position, libm::exp(ln), likeliest);
        let mut best = at(ln_nm);
        for width in WIDTHS {
            // the upper point is nearer than the lower one if it would be above the largest threshold
            let [lower, upper] = [ln_nm - width, (ln_nm + width).min(high)];
            let (below, above) = rayon::join(|| at(lower), || at(upper));
            let fits = [(lower, &below), (ln_nm, &best), (upper, &above)];
            let moved = vertex(fits.map(|(ln, model)| (ln, model.fitted.ln_likelihood)));
            let farthest = FARTHEST * width;
            let vertex = (ln_nm + moved.clamp(-farthest, farthest)).min(high);
            let own = [(lower, below), (upper, above), (vertex, at(vertex))];
            let better = |a: (f64, Self), b: (f64, Self)| {
                if b.1.fitted.ln_likelihood > a.1.fitted.ln_likelihood { b } else { a }
            };
            (ln_nm, best) = own.into_iter().fold((ln_nm, best), better);
        }
        best
    }

    /// Torque scale or preload of effect number `position` \[N m\]; `None` if it has none.
    fn threshold_nm(&self, position: usize) -> Option<f64> {
        self.candidates[self.fitted.effects[position]].shape.threshold_nm()
    }

    /// The largest torque on the place of effect number `position` in the campaign \[N m\].
    fn largest_torque_nm(&self, position: usize) -> f64 {
        let own = self.fitted.effects[position];
        self.samples.iter().map(|s| s.deflection.torque_nm(own)).fold(0.0, f64::max)
    }

    /// The model with another torque scale or preload of effect number `position` \[N m\], fitted again by `fit`.
    fn with_threshold(&self, position: usize, nm: f64, fit: Fit) -> Self {
        let mut out = self.clone();
        let own = self.fitted.effects[position];
        out.candidates[own].shape = out.candidates[own].shape.with_threshold(nm);
        let slots = out.samples.first().map(|sample| sample.deflection.slots_with_threshold(own, nm));
        let changed = |sample: &mut Sample| {
            // all samples have the same candidates
            let slots = slots.iter();
            slots.for_each(|slots| sample.deflection = Arc::new(sample.deflection.with_slots(slots)));
        };
        out.samples.iter_mut().for_each(changed);
        let all: Vec<&Sample> = out.samples.iter().collect();
        out.fitted = fit(&all, &out.numbers, &out.fitted.effects, &out.fitted);
        out
    }

    /// The size (half width \[rad\] or compliance \[rad/(N m)\]) and the threshold \[N m\] of effect number `position`,
    /// with their 95 % intervals; `None` if the effect has no threshold. An end of the threshold's interval is `None`
    /// if no threshold on this side lowers the likelihood enough.
    pub(super) fn profile(&self, position: usize) -> Option<[Estimate; 2]> {
        let best_nm = self.threshold_nm(position)?;
        let (size, deviation) = (self.fitted.compliances[position][0], self.fitted.deviations[position][0]);
        let most_nm = LARGEST_RATIO * self.largest_torque_nm(position);
        let fitted_deviation = self.with_threshold(position, best_nm, fit).fitted.deviations[position][0];
        // compliances without a name widen the interval at every threshold by the same factor
        let widened = (deviation / fitted_deviation).max(1.0);
        let mut tried = vec![Tried { threshold_nm: best_nm, size, deviation, fall: 0.0 }];
        tried.extend(self.tried_outward(position, best_nm, most_nm, widened));
        let Estimate { low, high, .. } = threshold(&mut tried, best_nm);
        let ends_nm = [low, high].into_iter().flatten();
        let near = |end_nm: f64| PARTS.map(|part| best_nm * libm::pow(end_nm / best_nm, part));
        tried.extend(self.tried(position, ends_nm.flat_map(near).collect(), widened));
        let ends = tried.iter().filter_map(|t| Some((t.size - t.reach()?, t.size + t.reach()?)));
        let (low, high) = ends.fold((size, size), |(low, high), (a, b)| (low.min(a), high.max(b)));
        let size = Estimate { value: size, low: Some(low), high: Some(high).filter(|h| h.is_finite()) };
        Some([size, threshold(&mut tried, best_nm)])
    }

    /// Fits with thresholds at all [`RATIOS`] to the best one, `best_nm`, as far as they are below `most_nm`. In a long
    /// campaign, no further thresholds are tried on a side once the likelihood has fallen enough.
    fn tried_outward(&self, position: usize, best_nm: f64, most_nm: f64, widened: f64) -> Vec<Tried> {
        let nm = |ratio: &f64| {
            [*ratio, 1.0 / ratio].map(|ratio| ratio * best_nm).into_iter().filter(|nm| *nm < most_nm)
        };
        if !self.is_long() {
            return self.tried(position, RATIOS.iter().flat_map(nm).collect(), widened);
        }
        let mut out: Vec<Tried> = Vec::new();
        for ratio in &RATIOS {
            let is_open = |nm: &f64| {
                let own = |t: &&Tried| (t.threshold_nm > best_nm) == (*nm > best_nm);
                out.iter().filter(own).all(|t| t.fall < FALL)
            };
            let open: Vec<f64> = nm(ratio).filter(is_open).collect();
            out.extend(self.tried(position, open, widened));
        }
        out
    }

    /// Fits of the model with each of the thresholds `thresholds_nm` of effect number `position`. `widened` is the
    /// factor by which compliances without a name widen the interval of its size.
    fn tried(&self, position: usize, thresholds_nm: Vec<f64>, widened: f64) -> Vec<Tried> {
        // the likelihood falls more slowly along the thresholds, by the square of the factor that widens the interval
        // of the size
        let flatter = (widened * self.fitted.robust_factor).max(1.0).powi(2);
        let tried = thresholds_nm.into_par_iter().map(|threshold_nm| {
            let other = self.with_threshold(position, threshold_nm, fit).fitted;
            Tried {
                threshold_nm,
                size: other.compliances[position][0],
                deviation: widened * other.deviations[position][0],
                fall: (self.fitted.ln_likelihood - other.ln_likelihood) / flatter,
            }
        });
        tried.collect()
    }
}

/// Distance of the vertex of the parabola through three points (position and value) from the middle point. It is infinite
/// if the values are not bent as about a maximum, or if the last two positions are the same.
fn vertex([left, middle, right]: [(f64, f64); 3]) -> f64 {
    let [before, after] = [middle.0 - left.0, right.0 - middle.0];
    let rise = (middle.1 - left.1) / before;
    if after <= 0.0 {
        return f64::INFINITY.copysign(rise);
    }
    let further = (right.1 - middle.1) / after;
    let bent = (further - rise) / (before + after);
    let slope = (rise * after + further * before) / (before + after);
    if bent < 0.0 { -0.5 * slope / bent } else { f64::INFINITY.copysign(right.1 - left.1) }
}

/// The threshold with its interval \[N m\]. An end of the interval lies between a threshold that is likely enough and
/// one that is not. The logarithm of the likelihood falls like a parabola in the logarithm of the threshold, so the
/// root of the fall is interpolated linearly. Sorts `tried` by the threshold.
fn threshold(tried: &mut [Tried], best_nm: f64) -> Estimate {
    tried.sort_by(|a, b| a.threshold_nm.total_cmp(&b.threshold_nm));
    let root = |fall: f64| fall.max(0.0).sqrt();
    let crossing = |inside: &Tried, outside: &Tried| {
        let part = (root(FALL) - root(inside.fall)) / (root(outside.fall) - root(inside.fall));
        inside.threshold_nm * libm::pow(outside.threshold_nm / inside.threshold_nm, part)
    };
    let is_in = |t: &Tried| t.fall < FALL;
    let crosses = |pair: &[Tried]| is_in(&pair[0]) != is_in(&pair[1]);
    let low =
        tried.windows(2).find(|pair| pair[1].threshold_nm <= best_nm && !is_in(&pair[0]) && crosses(pair));
    let high =
        tried.windows(2).rfind(|pair| pair[0].threshold_nm >= best_nm && !is_in(&pair[1]) && crosses(pair));
    Estimate {
        value: best_nm,
        low: low.map(|pair| crossing(&pair[1], &pair[0])),
        high: high.map(|pair| crossing(&pair[0], &pair[1])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vertex_of_a_parabola_is_found_from_three_of_its_values() {
        let parabola = |x: f64| (x, 3.0 - 2.0 * (x - 0.4).powi(2));
        assert!((vertex([-1.0, 0.0, 1.0].map(parabola)) - 0.4).abs() < 1e-12);
        // the upper point is nearer where it would be above the largest threshold
        assert!((vertex([-1.0, 0.0, 0.2].map(parabola)) - 0.4).abs() < 1e-12);
        assert_eq!(vertex([(-1.0, 3.0), (0.0, 2.0), (1.0, 1.0)]), f64::NEG_INFINITY);
        assert_eq!(vertex([(-1.0, 1.0), (0.0, 2.0), (0.0, 2.0)]), f64::INFINITY);
    }

    #[test]
    fn an_end_lies_where_the_likelihood_has_fallen_enough() {
        let at = |threshold_nm: f64, fall: f64| Tried { threshold_nm, size: 1.0, deviation: 0.1, fall };
        let mut tried = [at(1.0, 4.0 * FALL), at(10.0, 0.0), at(100.0, 0.5 * FALL), at(1000.0, 1.0)];
        let found = threshold(&mut tried, 10.0);
        // a parabola has a quarter of its fall half of the way
        assert!((found.low.expect("bounded") - 10.0 * libm::pow(0.1, 0.5)).abs() < 1e-12);
        assert_eq!((found.value, found.high), (10.0, None));
        assert!((at(1.0, 0.0).reach().expect("likely") - 0.196).abs() < 1e-3);
        assert_eq!(at(1.0, 2.0).reach(), None);
    }
}
