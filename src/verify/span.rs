//! Intervals, and functions that are linear in the weights of parts.

use nalgebra::Vector3;

/// An interval: all numbers from `least` to `most`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Span {
    pub least: f64,
    pub most: f64,
}

impl Span {
    /// The interval of `factor` times a number of this interval.
    pub(super) fn times(self, factor: f64) -> Self {
        let (a, b) = (self.least * factor, self.most * factor);
        Self { least: a.min(b), most: a.max(b) }
    }

    /// The interval of the sums of a number of this interval and a number of `other`.
    pub(super) fn plus(self, other: Self) -> Self {
        Self { least: self.least + other.least, most: self.most + other.most }
    }

    /// The smallest interval that contains this interval and `other`.
    pub(super) fn with(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), most: self.most.max(other.most) }
    }

    /// The least product of a number of this interval and a compliance in the interval `compliance`. Compliances are
    /// never negative.
    pub(super) fn least_product(self, compliance: Self) -> f64 {
        let factor = if self.least >= 0.0 { compliance.least } else { compliance.most };
        if self.least == 0.0 { 0.0 } else { self.least * factor }
    }

    /// Smallest magnitude of the numbers in the interval. Zero if the interval contains zero.
    pub(super) fn least_size(self) -> f64 {
        self.least.max(-self.most).max(0.0)
    }

    /// Largest magnitude of the numbers in the interval.
    pub(super) fn largest_size(self) -> f64 {
        self.most.max(-self.least)
    }

    pub(super) fn middle(self) -> f64 {
        0.5 * (self.least + self.most)
    }
}

/// A linear function of the loads: a constant, and a coefficient for each load.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Linear {
    pub fixed: f64,
    pub per_load: Vec<f64>,
}

impl Linear {
    /// The interval of the function's values over intervals of the loads. It is exact, because every load enters
    /// only once.
    pub(super) fn over(&self, loads: &[Span]) -> Span {
        let start = Span { least: self.fixed, most: self.fixed };
        self.per_load.iter().zip(loads).fold(start, |sum, (factor, load)| sum.plus(load.times(*factor)))
    }
}

/// A vector whose three components are linear functions of the loads.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct LinearVector {
    pub fixed: Vector3<f64>,
    pub per_load: Vec<Vector3<f64>>,
}

impl LinearVector {
    /// The interval of the component of this vector along `direction`, if each load lies in its interval of `loads`.
    pub(super) fn along(&self, direction: &Vector3<f64>, loads: &[Span]) -> Span {
        let fixed = self.fixed.dot(direction);
        let start = Span { least: fixed, most: fixed };
        self.per_load
            .iter()
            .zip(loads)
            .fold(start, |sum, (factor, load)| sum.plus(load.times(factor.dot(direction))))
    }

    /// This vector, if each load is in the middle of its interval.
    pub(super) fn middle(&self, loads: &[Span]) -> Vector3<f64> {
        let sum = |sum, (factor, load): (&Vector3<f64>, &Span)| sum + factor * load.middle();
        self.per_load.iter().zip(loads).fold(self.fixed, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_sum_is_largest_and_least_at_the_corners() {
        let linear = Linear { fixed: 1.0, per_load: vec![2.0, -3.0] };
        let loads = [Span { least: 1.0, most: 2.0 }, Span { least: -1.0, most: 4.0 }];
        assert_eq!(linear.over(&loads), Span { least: 1.0 + 2.0 - 12.0, most: 1.0 + 4.0 + 3.0 });
    }

    #[test]
    fn a_product_with_a_compliance_is_least_at_the_right_end() {
        let compliance = Span { least: 2.0, most: 5.0 };
        assert_eq!(Span { least: 3.0, most: 4.0 }.least_product(compliance), 6.0);
        assert_eq!(Span { least: -3.0, most: 4.0 }.least_product(compliance), -15.0);
        let rigid = Span { least: 0.0, most: f64::INFINITY };
        assert_eq!(Span { least: 0.0, most: 4.0 }.least_product(rigid), 0.0);
    }
}
