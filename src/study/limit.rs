//! The limits of a study one by one: which quantity of a design each limits, the stated limit, and the value of a
//! design.

use crate::pareto::objectives::{Objective, Objectives};
use crate::report::number::significant;
use crate::space::constraint::Constraints;
use crate::space::problem::{ArmProblem, Partial};

/// A quantity of a design that a study can limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Deflection,
    Mode,
    Mass,
    Stress,
    Slenderness,
    Cost,
}

impl Quantity {
    const ALL: [Self; 6] =
        [Self::Deflection, Self::Mode, Self::Mass, Self::Stress, Self::Slenderness, Self::Cost];

    /// The quantities that are checked whenever a part is added to an arm.
    pub(super) const OF_PARTS: [Self; 4] = [Self::Slenderness, Self::Stress, Self::Cost, Self::Mass];

    /// The quantities on which `constraints` has a limit.
    pub(super) fn limited(constraints: &Constraints) -> Vec<Self> {
        Self::ALL.into_iter().filter(|quantity| quantity.asked(constraints).is_some()).collect()
    }

    /// The limit on this quantity, in the unit of the library: m, Hz, kg, EUR or a ratio. `None` if it is not
    /// limited.
    pub(super) fn asked(self, constraints: &Constraints) -> Option<f64> {
        match self {
            Self::Deflection => constraints.tip_deflection_max_m,
            Self::Mode => Some(constraints.required_mode_hz()).filter(|hz| *hz > 0.0),
            Self::Mass => constraints.mass_max_kg,
            Self::Stress => constraints.stress_safety_factor_min,
            Self::Slenderness => constraints.wall_slenderness_max,
            Self::Cost => constraints.material_cost_max_eur,
        }
    }

    /// Sets the limit on this quantity in `constraints`; `None` removes it.
    pub(super) fn set(self, constraints: &mut Constraints, limit: Option<f64>) {
        match self {
            Self::Deflection => constraints.tip_deflection_max_m = limit,
            Self::Mode => (constraints.lowest_mode_min_hz, constraints.servo) = (limit, None),
            Self::Mass => constraints.mass_max_kg = limit,
            Self::Stress => constraints.stress_safety_factor_min = limit,
            Self::Slenderness => constraints.wall_slenderness_max = limit,
            Self::Cost => constraints.material_cost_max_eur = limit,
        }
    }

    /// The value of this quantity for a part of an arm, as far as it is built; `None` for a quantity that only a complete
    /// arm has, or if a strength or a cost is unknown.
    pub(super) fn of_part(self, problem: &ArmProblem, arm: &Partial) -> Option<f64> {
        match self {
            Self::Stress => problem.stress_safety_factor(arm),
            Self::Slenderness => Some(problem.wall_slenderness(arm)),
            Self::Cost => problem.material_cost_eur(arm),
            Self::Mass => Some(problem.mass_kg(arm)),
            Self::Deflection | Self::Mode => None,
        }
    }

    /// The value of this quantity for a complete design: `arm` is the arm as the search builds it, `objectives` are its
    /// objectives. `None` if a strength or a cost is unknown.
    pub(super) fn of(self, problem: &ArmProblem, arm: &Partial, objectives: &Objectives) -> Option<f64> {
        match self {
            Self::Deflection => Some(objectives.tip_deflection_m),
            Self::Mode => Some(objectives.lowest_mode_hz),
            Self::Mass => Some(objectives.mass_kg),
            Self::Stress => Some(self.of_part(problem, arm).unwrap_or(f64::INFINITY)),
            Self::Slenderness | Self::Cost => self.of_part(problem, arm),
        }
    }

    /// The objective that this quantity is, or `None` if it is no objective.
    pub(super) fn objective(self) -> Option<Objective> {
        match self {
            Self::Deflection => Some(Objective::TipDeflection),
            Self::Mode => Some(Objective::LowestMode),
            Self::Mass => Some(Objective::Mass),
            Self::Stress | Self::Slenderness | Self::Cost => None,
        }
    }

    /// Whether the limit is a lower limit, as for the lowest mode and the safety factor.
    pub(super) fn is_least(self) -> bool {
        matches!(self, Self::Mode | Self::Stress)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Deflection => "tip deflection",
            Self::Mode => "lowest mode",
            Self::Mass => "mass",
            Self::Stress => "strength over stress",
            Self::Slenderness => "wall slenderness",
            Self::Cost => "material cost",
        }
    }

    /// Unit of this quantity in a study file, and the factor that converts from the library's unit (m, Hz, kg, EUR) to
    /// it.
    fn unit(self) -> (&'static str, f64) {
        match self {
            Self::Deflection => ("mm", 1e3),
            Self::Mode => ("Hz", 1.0),
            Self::Mass => ("kg", 1.0),
            Self::Cost => ("EUR", 1.0),
            Self::Stress | Self::Slenderness => ("", 1.0),
        }
    }

    /// The keys of a study file that limit this quantity and that a design with the value `reached` violates. Each key
    /// comes with a value that would admit the design, in the unit of the key.
    fn enough(self, constraints: &Constraints, reached: f64) -> Vec<(&'static str, f64)> {
        let round = if self.is_least() { rounded_down } else { rounded_up };
        let key = match self {
            Self::Mode => return mode_keys(constraints, reached).map(|(key, x)| (key, round(x))).collect(),
            Self::Deflection => "tip_deflection_max_mm",
            Self::Mass => "mass_max_kg",
            Self::Stress => "stress_safety_factor_min",
            Self::Slenderness => "wall_slenderness_max",
            Self::Cost => "material_cost_max_eur",
        };
        vec![(key, round(reached * self.unit().1))]
    }

    /// The stated limit, the value `reached` by a design, and the difference between the two, in words.
    pub(super) fn shortfall_words(self, constraints: &Constraints, reached: f64) -> String {
        let (unit, scale) = self.unit();
        let words = |x: f64| match unit {
            "" => short(x * scale),
            unit => format!("{} {unit}", short(x * scale)),
        };
        let asked = self.asked(constraints).unwrap_or_default();
        format!(
            "{}: {} asked, {} reached by designs that meet all else (short by {})",
            self.name(),
            words(asked),
            words(reached),
            words((reached - asked).abs())
        )
    }

    /// Whether an arm with the value `reached` breaks the limit on this quantity.
    pub(super) fn is_broken(self, constraints: &Constraints, reached: f64) -> bool {
        self.asked(constraints)
            .is_some_and(|asked| if self.is_least() { reached < asked } else { reached > asked })
    }

    /// The value `reached` by an arm and the limit that it breaks, in words.
    pub(super) fn broken_words(self, constraints: &Constraints, reached: f64) -> String {
        let (unit, scale) = self.unit();
        let words = |x: f64| format!("{} {unit}", short(x * scale)).trim_end().to_string();
        let bound = if self.is_least() { "at least" } else { "at most" };
        let asked = self.asked(constraints).unwrap_or_default();
        format!("{} is {} and {bound} {} is asked", self.name(), words(reached), words(asked))
    }

    /// The keys of the study file that have to be changed to admit a design with the value `reached`, each with a value
    /// that suffices, such as `"mass_max_kg" to 31.7`.
    pub(super) fn enough_words(self, constraints: &Constraints, reached: f64) -> String {
        let keys = self.enough(constraints, reached).into_iter();
        keys.map(|(key, value)| format!("\"{key}\" to {value}")).collect::<Vec<_>>().join(" and ")
    }
}

/// The keys that demand a higher lowest mode than `reached_hz`, each with a value that this mode satisfies \[Hz\].
/// The key of the servo states a bandwidth, which is the mode divided by a ratio.
fn mode_keys(constraints: &Constraints, reached_hz: f64) -> impl Iterator<Item = (&'static str, f64)> {
    let stated = constraints.lowest_mode_min_hz.filter(|hz| *hz > reached_hz);
    let servo = constraints.servo.filter(|servo| servo.bandwidth_hz * servo.ratio > reached_hz);
    let stated = stated.map(|_| ("lowest_mode_min_hz", reached_hz));
    stated.into_iter().chain(servo.map(|servo| ("servo_bandwidth_hz", reached_hz / servo.ratio)))
}

/// A number with four significant digits.
pub(super) fn short(x: f64) -> String {
    significant(x, 4)
}

// Limits are rounded to the side that admits more designs, so that a value that suffices still does so after rounding.

/// Rounds a number up to five significant digits.
fn rounded_up(x: f64) -> f64 {
    let scale = five_digits(x);
    (x * scale * (1.0 + 1e-12)).ceil() / scale
}

/// Rounds a number down to five significant digits.
pub(super) fn rounded_down(x: f64) -> f64 {
    let scale = five_digits(x);
    (x * scale * (1.0 - 1e-12)).floor() / scale
}

/// The power of ten by which the number `x` must be multiplied to have five digits before the decimal point.
fn five_digits(x: f64) -> f64 {
    10f64.powi(4 - libm::log10(x.abs().max(f64::MIN_POSITIVE)).floor() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::constraint::Servo;

    #[test]
    fn a_value_that_is_enough_is_rounded_to_stay_enough() {
        assert_eq!(rounded_up(2.917_24), 2.9173);
        assert_eq!(rounded_down(2.917_24), 2.9172);
        assert!(rounded_up(12.0) >= 12.0 && rounded_down(12.0) <= 12.0);
        assert!(rounded_up(1e-7 / 3.0) >= 1e-7 / 3.0);
    }

    #[test]
    fn a_mode_that_two_keys_ask_for_needs_both_relaxed() {
        let servo = Some(Servo { bandwidth_hz: 10.0, ratio: 3.0 });
        let both = Constraints { lowest_mode_min_hz: Some(25.0), servo, ..Constraints::default() };
        let words = |hz: f64| Quantity::Mode.enough_words(&both, hz);
        assert_eq!(words(27.3), "\"servo_bandwidth_hz\" to 9.0999");
        assert_eq!(words(24.3), "\"lowest_mode_min_hz\" to 24.299 and \"servo_bandwidth_hz\" to 8.0999");
    }
}
