//! Local upper bounds of the incumbents. They describe the region in which further designs of the front may lie.
//!
//! Incumbents are the designs found so far. The search region is the set of all triples of mass, deflection and mode
//! that no incumbent dominates. It is the union of the regions below local upper bounds. A design below a local upper
//! bound is lighter, deflects less and has a higher mode than the bound.
//!
//! One sweep over the incumbents by rising mass finds all local upper bounds. Deflection and mode of the incumbents so
//! far form a staircase, with a bound between any two neighbouring steps. When a heavier incumbent cuts off such a
//! bound, the bound is complete and its mass is the mass of this incumbent.

use super::bound::BoxBound;
use crate::pareto::objectives::Objectives;

/// A local upper bound: a mass \[kg\], a tip deflection \[m\] and a frequency \[Hz\]. A design below it (of less mass,
/// less deflection and a higher mode) is not dominated by the incumbents from which the bound was made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalUpperBound {
    pub mass_kg: f64,
    pub tip_m: f64,
    pub hz: f64,
}

impl LocalUpperBound {
    /// The bound of the smallest region that contains the regions below this local upper bound and below `other`. It
    /// has the larger mass and deflection and the lower frequency of the two.
    fn join(&self, other: &Self) -> Self {
        Self {
            mass_kg: self.mass_kg.max(other.mass_kg),
            tip_m: self.tip_m.max(other.tip_m),
            hz: self.hz.min(other.hz),
        }
    }

    /// Whether a box of designs with the ideal point `box_bound` may have a member below this local upper bound.
    #[inline]
    pub(super) fn admits(&self, box_bound: &BoxBound) -> bool {
        box_bound.mass_kg <= self.mass_kg && box_bound.tip_m <= self.tip_m && box_bound.hz >= self.hz
    }

    /// Whether a design lies below this local upper bound.
    fn contains(&self, design: &Objectives) -> bool {
        design.mass_kg < self.mass_kg
            && design.tip_deflection_m < self.tip_m
            && design.lowest_mode_hz > self.hz
    }

    /// Whether the region below this local upper bound contains the region below `other`.
    fn covers(&self, other: &Self) -> bool {
        other.mass_kg <= self.mass_kg && other.tip_m <= self.tip_m && other.hz >= self.hz
    }

    /// The eigenvalue `(2πf)²` of the frequency `f` of this local upper bound \[1/s²\].
    pub(super) fn lambda(&self) -> f64 {
        (self.hz * std::f64::consts::TAU).powi(2)
    }

    /// Mass, deflection and frequency in this order.
    fn numbers(&self) -> [f64; 3] {
        [self.mass_kg, self.tip_m, self.hz]
    }
}

/// A group of local upper bounds. Together they describe the region in which a search looks for designs.
#[derive(Clone)]
pub(super) struct LocalUpperBounds(Vec<LocalUpperBound>);

impl LocalUpperBounds {
    /// The local upper bounds of the region that `designs` leave undominated within `limits`, the limits of the study.
    /// Dominated designs are removed from `designs`.
    pub(super) fn new(designs: &mut Vec<Objectives>, limits: LocalUpperBound) -> Self {
        designs.sort_unstable_by(|a, b| {
            (a.mass_kg.total_cmp(&b.mass_kg))
                .then(a.tip_deflection_m.total_cmp(&b.tip_deflection_m))
                .then(b.lowest_mode_hz.total_cmp(&a.lowest_mode_hz))
        });
        let mut stairs = Stairs { steps: Vec::new(), limits };
        let mut upper_bounds = Vec::new();
        designs.retain(|design| stairs.add(design, &mut upper_bounds));
        upper_bounds.extend((0..=stairs.steps.len()).map(|k| stairs.bound_before(k, limits.mass_kg)));
        // A bound that asks for no deflection, or for an infinite mode, admits no design.
        upper_bounds.retain(|c| c.tip_m > 0.0 && c.hz < f64::INFINITY);
        Self(upper_bounds)
    }

    /// The group of a single local upper bound.
    pub(super) fn single(upper: LocalUpperBound) -> Self {
        Self(vec![upper])
    }

    /// All bounds of the group.
    pub(super) fn all(&self) -> &[LocalUpperBound] {
        &self.0
    }

    /// The least local upper bound that covers all of the group. `None` if the group is empty.
    pub(super) fn join(&self) -> Option<LocalUpperBound> {
        self.0.iter().copied().reduce(|a, b| a.join(&b))
    }

    /// Whether a box of designs with the ideal point `box_bound` may have a member below some bound of the group.
    pub(super) fn admit(&self, box_bound: &BoxBound) -> bool {
        self.0.iter().any(|upper| upper.admits(box_bound))
    }

    /// Keeps only the bounds for which `keep` is true.
    pub(super) fn retain(&mut self, keep: impl FnMut(&LocalUpperBound) -> bool) {
        self.0.retain(keep);
    }

    /// Divides the group at the median of the objective whose greatest value is the largest multiple of its least
    /// value. `None` if the group has fewer than two bounds.
    pub(super) fn halves(mut self) -> Option<[Self; 2]> {
        if self.0.len() < 2 {
            return None;
        }
        let ratio = |axis: usize| {
            let (low, high) = self.0.iter().fold((f64::INFINITY, f64::MIN_POSITIVE), |(low, high), c| {
                let x = c.numbers()[axis];
                (low.min(x), if x.is_finite() { high.max(x) } else { high })
            });
            high / low.max(f64::MIN_POSITIVE)
        };
        let ratios = [ratio(0), ratio(1), ratio(2)];
        let axis = (0..3).max_by(|&a, &b| ratios[a].total_cmp(&ratios[b])).unwrap_or(0);
        let middle = self.0.len() / 2;
        self.0.select_nth_unstable_by(middle, |a, b| a.numbers()[axis].total_cmp(&b.numbers()[axis]));
        let high = self.0.split_off(middle);
        Some([self, Self(high)])
    }

    /// Removes from the region of the group all objectives that a design in `found` dominates. A bound with such
    /// designs below it is replaced by the local upper bounds of the region that these designs leave undominated.
    pub(super) fn cut_by(&mut self, found: &[Objectives]) {
        let mut cut = Vec::new();
        self.0.retain(|upper| {
            let mut inside: Vec<Objectives> = found.iter().copied().filter(|o| upper.contains(o)).collect();
            if inside.is_empty() {
                return true;
            }
            cut.extend(Self::new(&mut inside, *upper).0);
            false
        });
        // The regions below neighbouring bounds overlap, so one new bound may cover another. Covered bounds are left
        // out.
        for (at, upper) in cut.iter().enumerate() {
            let is_covered = |by: &LocalUpperBound| by.covers(upper);
            let elsewhere = || cut[at + 1..].iter().any(is_covered);
            if !self.0.iter().any(is_covered) && !elsewhere() {
                self.0.push(*upper);
            }
        }
    }
}

impl FromIterator<LocalUpperBound> for LocalUpperBounds {
    fn from_iter<I: IntoIterator<Item = LocalUpperBound>>(bounds: I) -> Self {
        Self(bounds.into_iter().collect())
    }
}

/// The staircase of the incumbents added so far: deflection \[m\] and mode \[Hz\] of the incumbents that are not
/// dominated, in ascending order of both.
struct Stairs {
    steps: Vec<[f64; 2]>,
    limits: LocalUpperBound,
}

impl Stairs {
    /// Adds a design that is at least as heavy as all designs added before. Local upper bounds that are complete now
    /// are appended to `upper_bounds`. Returns false if an earlier design dominates this design, and true otherwise.
    fn add(&mut self, design: &Objectives, upper_bounds: &mut Vec<LocalUpperBound>) -> bool {
        let (tip_m, hz) = (design.tip_deflection_m, design.lowest_mode_hz);
        // Steps before `from` deflect less than the design. Steps before `to` have no higher mode.
        let from = self.steps.partition_point(|step| step[0] < tip_m);
        let to = self.steps.partition_point(|step| step[1] <= hz);
        // If one of these conditions is true, an incumbent dominates the design: it deflects no more, has no lower
        // mode, and is no heavier.
        if to < from || self.steps.get(from).is_some_and(|step| step[0] == tip_m && step[1] >= hz) {
            return false;
        }
        // Bound k lies between the steps k - 1 and k. The bounds from `from` to `to` end at the mass of the design. The
        // design becomes a new step, in the place of the steps that it dominates.
        upper_bounds.extend((from..=to).map(|k| self.bound_before(k, design.mass_kg)));
        self.steps.splice(from..to, [[tip_m, hz]]);
        true
    }

    /// The local upper bound between step `k` of the staircase and the step before it. `mass_kg` is its mass. Where one
    /// of the steps is missing, the limits of the study take its place.
    fn bound_before(&self, k: usize, mass_kg: f64) -> LocalUpperBound {
        LocalUpperBound {
            mass_kg,
            tip_m: self.steps.get(k).map_or(self.limits.tip_m, |step| step[0]),
            hz: k.checked_sub(1).map_or(self.limits.hz, |k| self.steps[k][1]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LIMITS: LocalUpperBound = LocalUpperBound { mass_kg: 12.0, tip_m: 12.0, hz: 0.0 };

    fn designs() -> impl Strategy<Value = Vec<Objectives>> {
        let number = || (1u32..12).prop_map(f64::from);
        let design =
            (number(), number(), number()).prop_map(|(mass_kg, tip_deflection_m, lowest_mode_hz)| {
                Objectives { tip_deflection_m, mass_kg, lowest_mode_hz }
            });
        prop::collection::vec(design, 0..40)
    }

    /// Whether a design is below some local upper bound of a group. The group is divided down to single bounds.
    fn is_below(upper_bounds: LocalUpperBounds, design: &Objectives) -> bool {
        let Some(joined) = upper_bounds.join() else { return false };
        let halves = upper_bounds.halves();
        joined.contains(design)
            && halves.is_none_or(|halves| halves.into_iter().any(|half| is_below(half, design)))
    }

    proptest! {
        /// A design is below a bound exactly if no incumbent dominates it, whether the incumbents are all known at the
        /// start or some of them cut the bounds later.
        #[test]
        fn a_design_is_below_a_bound_exactly_if_none_dominates_it(designs in designs(), later in designs()) {
            let mut kept = designs.clone();
            let upper_bounds = LocalUpperBounds::new(&mut kept, LIMITS);
            let mut cut = upper_bounds.clone();
            cut.cut_by(&later);
            for cell in 0..12 * 12 * 12 {
                let [mass_kg, tip_deflection_m, lowest_mode_hz] =
                    [cell % 12, cell / 12 % 12, cell / 144].map(|k| f64::from(k) + 0.5);
                let design = Objectives { tip_deflection_m, mass_kg, lowest_mode_hz };
                let dominates = |o: &Objectives| {
                    o.mass_kg < mass_kg && o.tip_deflection_m < tip_deflection_m && o.lowest_mode_hz > lowest_mode_hz
                };
                let below = is_below(upper_bounds.clone(), &design);
                prop_assert_eq!(below, !designs.iter().any(dominates));
                prop_assert_eq!(below, !kept.iter().any(dominates));
                prop_assert_eq!(is_below(cut.clone(), &design), below && !later.iter().any(dominates));
            }
        }
    }
}
