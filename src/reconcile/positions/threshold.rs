//! The torque scale of a joint's play and the preload of a base that lifts off: the best value, and the intervals of it and of
//! the half width or stiffness that depends on it.
//!
//! A few thresholds are tried in the search for effects. The best is refined, since a threshold that is off changes the half
//! width with it and leaves a structure in the errors. The intervals are those of the profile likelihood: at each threshold `s`
//! the likelihood falls from its best value `L(s)` like a parabola in the half width `h`, so the interval of `h` is the union
//! of `h(s) ± σ(s) √(2 (1.92 - (L_max - L(s))))` over all `s`.

use super::analysis::Positions;
use super::fitted::Sample;
use crate::reconcile::model::estimate::Estimate;
use rayon::prelude::*;
use std::sync::Arc;

/// Fall of the logarithm of the likelihood at the ends of a 95 % interval: half of the 95 % quantile of chi-squared
/// with one degree of freedom.
const FALL: f64 = 1.92;
/// Number of steps of the golden section search for the best threshold.
const STEPS: usize = 9;
/// Part of an interval that the golden section leaves in each step.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// A threshold is sought between the best of those that were tried divided by this factor, and multiplied by it: the ratio
/// of neighbours that were tried.
const BRACKET: f64 = 2.7;
/// Ratios of thresholds to the best one at which the likelihood is computed for the intervals.
const RATIOS: [f64; 8] = [1.05, 1.12, 1.25, 1.5, 2.0, 3.0, 6.0, 20.0];
/// A threshold above this multiple of the largest torque is that of a spring.
const MOST: f64 = 3.0;

/// A model with another threshold.
struct Tried {
    threshold_nm: f64,
    size: f64,
    deviation: f64,
    /// By how much the logarithm of the likelihood is lower than with the best threshold.
    fall: f64,
}

impl Tried {
    /// Half of the width of the interval of the size at this threshold; `None` if no size is likely enough.
    fn reach(&self) -> Option<f64> {
        (self.fall < FALL).then(|| self.deviation * (2.0 * (FALL - self.fall.max(0.0))).sqrt())
    }
}

impl Positions {
    /// Replaces the thresholds of those effects of the model that have one and are not among `known` by better ones, and
    /// fits the model again.
    pub(super) fn refine_thresholds(&mut self, known: &[usize]) {
        let is_new = |position: &usize| !known.contains(&self.fitted.effects[*position]);
        let new: Vec<usize> = (0..self.fitted.effects.len()).filter(is_new).collect();
        for position in new {
            let Some(from_nm) = self.threshold_nm(position) else { continue };
            let most_nm = MOST * self.largest_torque_nm(position);
            let (mut low, mut high) =
                (libm::log(from_nm / BRACKET), libm::log((from_nm * BRACKET).min(most_nm)));
            for _ in 0..STEPS {
                let inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
                let [left, right] = inner.map(|ln| self.with_threshold(position, libm::exp(ln)));
                let is_left = left.fitted.ln_likelihood > right.fitted.ln_likelihood;
                (low, high) = if is_left { (low, inner[1]) } else { (inner[0], high) };
                let better = if is_left { left } else { right };
                if better.fitted.ln_likelihood > self.fitted.ln_likelihood {
                    *self = better;
                }
            }
        }
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

    /// The model with another torque scale or preload of effect number `position` \[N m\], fitted again.
    fn with_threshold(&self, position: usize, nm: f64) -> Self {
        let mut out = self.clone();
        let own = self.fitted.effects[position];
        out.candidates[own].shape = out.candidates[own].shape.with_threshold(nm);
        let changed = |sample: &mut Sample| {
            sample.deflection = Arc::new(sample.deflection.with_threshold(own, nm));
        };
        out.samples.iter_mut().for_each(changed);
        out.refit();
        out
    }

    /// The size (half width \[rad\] or compliance \[rad/(N m)\]) and the threshold \[N m\] of effect number `position`, with
    /// their 95 % intervals; `None` if the effect has no threshold. An end is `None` if no threshold on this side lowers the
    /// likelihood enough.
    pub(super) fn profile(&self, position: usize) -> Option<[Estimate; 2]> {
        let best_nm = self.threshold_nm(position)?;
        let (size, deviation) = (self.fitted.compliances[position][0], self.fitted.deviations[position][0]);
        let most_nm = MOST * self.largest_torque_nm(position);
        let ratios = RATIOS.iter().flat_map(|ratio| [*ratio, 1.0 / ratio]);
        let ratios: Vec<f64> = ratios.filter(|ratio| ratio * best_nm < most_nm).collect();
        let fitted_deviation = self.with_threshold(position, best_nm).fitted.deviations[position][0];
        // compliances without a name widen the interval at every threshold by the same factor
        let widened = (deviation / fitted_deviation).max(1.0);
        let tried = ratios.into_par_iter().map(|ratio| {
            let other = self.with_threshold(position, ratio * best_nm).fitted;
            Tried {
                threshold_nm: ratio * best_nm,
                size: other.compliances[position][0],
                deviation: widened * other.deviations[position][0],
                fall: self.fitted.ln_likelihood - other.ln_likelihood,
            }
        });
        let mut tried: Vec<Tried> = tried.collect();
        tried.push(Tried { threshold_nm: best_nm, size, deviation, fall: 0.0 });
        tried.sort_by(|a, b| a.threshold_nm.total_cmp(&b.threshold_nm));
        let ends = tried.iter().filter_map(|t| Some((t.size - t.reach()?, t.size + t.reach()?)));
        let (low, high) = ends.fold((size, size), |(low, high), (a, b)| (low.min(a), high.max(b)));
        let size = Estimate { value: size, low: Some(low), high: Some(high).filter(|h| h.is_finite()) };
        Some([size, threshold(&tried, best_nm)])
    }
}

/// The threshold with its interval \[N m\]: between a threshold that is likely enough and one that is not, the fall of the
/// likelihood is taken as linear in the logarithm of the threshold.
fn threshold(tried: &[Tried], best_nm: f64) -> Estimate {
    let crossing = |inside: &Tried, outside: &Tried| {
        let part = (FALL - inside.fall) / (outside.fall - inside.fall);
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
    fn an_end_lies_where_the_likelihood_has_fallen_enough() {
        let at = |threshold_nm: f64, fall: f64| Tried { threshold_nm, size: 1.0, deviation: 0.1, fall };
        let found = threshold(&[at(1.0, 3.92), at(10.0, 0.0), at(100.0, 0.96), at(1000.0, 1.0)], 10.0);
        // half of the way down the fall is 1.96, a little more than enough
        assert!((found.low.expect("bounded") - 10.0 * libm::pow(0.1, 1.92 / 3.92)).abs() < 1e-12);
        assert_eq!((found.value, found.high), (10.0, None));
        assert!((at(1.0, 0.0).reach().expect("likely") - 0.196).abs() < 1e-3);
        assert_eq!(at(1.0, 2.0).reach(), None);
    }
}
