//! Values with their 95 % intervals, and effects found with such values.

use crate::arm::effect::catalogue::kind;
use crate::arm::effect::entry::{Effect, word_of};
use serde_json::{Map, Value, json};

/// The 95 % interval of a fitted parameter, in the scaled parameter `u` (of the order of 1). An end is `None` where
/// the data do not bound it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end of the interval, in the scaled parameter `u`.
    pub low: Option<f64>,
    /// Upper end of the interval, in the scaled parameter `u`.
    pub high: Option<f64>,
}

impl Interval {
    /// This interval, widened if necessary to contain the best value `u`.
    pub(crate) fn with(self, u: f64) -> Self {
        Self { low: self.low.map(|v| v.min(u)), high: self.high.map(|v| v.max(u)) }
    }

    /// This interval with both ends moved outwards by `by`. An end that then lies beyond the bounds `low` and `high`
    /// of the parameter becomes `None`.
    pub(crate) fn wider(self, by: f64, (low, high): (f64, f64)) -> Self {
        Self {
            low: self.low.map(|v| v - by).filter(|v| *v > low),
            high: self.high.map(|v| v + by).filter(|v| *v < high),
        }
    }
}

/// A value with its 95 % interval. An end is `None` where the data do not bound it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Best value, in the unit of the parameter.
    pub value: f64,
    /// Lower end of the interval, in the unit of the parameter.
    pub low: Option<f64>,
    /// Upper end of the interval, in the unit of the parameter.
    pub high: Option<f64>,
}

impl Estimate {
    /// The value and the two ends of its interval as a JSON object.
    pub(crate) fn json(&self) -> Value {
        json!({"value": self.value, "low": self.low, "high": self.high})
    }
}

/// Half of the width of a 95 % interval of a normal distribution, in standard deviations.
pub(crate) const Z_95: f64 = 1.959_963_984_540_054;
/// Rise of an objective (a sum of squared residuals in standard deviations) at the ends of a 95 % interval: the 95 %
/// quantile of chi-squared with one degree of freedom.
pub(crate) const RISE_AT_95: f64 = Z_95 * Z_95;

/// Parameters that say how an effect acts, and not how large it is.
const NO_SIZES: [&str; 3] = ["torque_nm", "preload_nm", "phases_rad"];

/// An effect that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Name of the effect.
    pub effect: String,
    /// Place of the effect: the name of a joint or link, `base`, or a channel.
    pub at: String,
    /// Name of each parameter and its estimate; a vector has several estimates, one per component.
    pub parameters: Vec<(String, Vec<Estimate>)>,
    /// Name and place of effects that these readings cannot tell from this one.
    pub indistinguishable_from: Vec<(String, String)>,
}

impl Finding {
    /// Label of the finding: `effect@place`.
    pub fn label(&self) -> String {
        format!("{}@{}", self.effect, self.at)
    }

    /// The finding with its estimates multiplied by `factor`, which is positive.
    pub(crate) fn times(&self, factor: f64) -> Self {
        let mut out = self.clone();
        for estimate in out.parameters.iter_mut().flat_map(|(_, list)| list) {
            let [low, high] = [estimate.low, estimate.high].map(|end| end.map(|x| x * factor));
            *estimate = Estimate { value: estimate.value * factor, low, high };
        }
        out
    }

    /// The finding as an entry of an arm file, with values that such a file may have. `source` says which readings it
    /// comes from.
    pub(crate) fn as_effect(&self, source: Value) -> Effect {
        let kind = kind(&self.effect);
        let readable = |name: &str, value: f64| match kind.and_then(|kind| kind.parameter(name)) {
            Some(parameter) => parameter.nearest(value),
            None => value,
        };
        let values = |name: &str, list: &[Estimate]| list.iter().map(|e| readable(name, e.value)).collect();
        let parameters = self.parameters.iter().map(|(name, list)| (name.clone(), values(name, list)));
        let parameters = parameters.collect();
        Effect { effect: self.effect.clone(), at: self.at.clone(), parameters, source: Some(source) }
    }

    /// Whether every size of the effect differs by at most its own standard deviation from the size of an absent
    /// effect. This is an infinite stiffness, a factor of 1, and 0 for any other size. The torque over which play
    /// opens, a preload and a phase are not sizes.
    pub(crate) fn is_within_its_deviation(&self) -> bool {
        let is_near = |name: &str, estimate: &Estimate| {
            let Estimate { value, low, high } = *estimate;
            if name.starts_with("stiffness") {
                // the interval is computed for the compliance, whose upper end is Z_95 standard deviations from its
                // value
                return high.is_none() && low.is_none_or(|low| value > (1.0 + Z_95) * low);
            }
            let absent = if name.ends_with("factor") { 1.0 } else { 0.0 };
            let deviation = low.zip(high).map_or(f64::INFINITY, |(low, high)| (high - low) / (2.0 * Z_95));
            (value - absent).abs() < deviation
        };
        let mut sizes = self.parameters.iter().filter(|(name, _)| !NO_SIZES.contains(&name.as_str()));
        sizes.all(|(name, estimates)| estimates.iter().all(|estimate| is_near(name, estimate)))
    }

    /// The entry of the finding in `verdict.json`.
    pub(crate) fn json(&self) -> Value {
        let parameters: Map<String, Value> = self
            .parameters
            .iter()
            .map(|(name, estimates)| {
                let word = |one: &Estimate| word_of(&self.effect, name, one.value);
                let value = match estimates.as_slice() {
                    [one] if word(one).is_some() => json!({"value": word(one), "low": null, "high": null}),
                    [one] => one.json(),
                    many => {
                        let part = |f: fn(&Estimate) -> Option<f64>| many.iter().map(f).collect::<Vec<_>>();
                        json!({"value": part(|e| Some(e.value)), "low": part(|e| e.low), "high": part(|e| e.high)})
                    }
                };
                (name.clone(), value)
            })
            .collect();
        let others: Vec<Value> = self
            .indistinguishable_from
            .iter()
            .map(|(effect, at)| json!({"effect": effect, "at": at}))
            .collect();
        json!({"effect": self.effect, "at": self.at, "parameters": parameters, "indistinguishable_from": others})
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Value, lower and upper end.
    type Size = (f64, Option<f64>, Option<f64>);

    fn finding(parameters: &[(&str, &[Size])]) -> Finding {
        let estimates =
            |list: &[Size]| list.iter().map(|&(value, low, high)| Estimate { value, low, high }).collect();
        Finding {
            effect: "x".into(),
            at: "j1".into(),
            parameters: parameters.iter().map(|(name, list)| (name.to_string(), estimates(list))).collect(),
            indistinguishable_from: Vec::new(),
        }
    }

    #[test]
    fn an_effect_is_a_suspect_if_it_is_smaller_than_its_deviation() {
        let is_near = |name: &str, value: f64, low: f64, high: Option<f64>| {
            finding(&[(name, &[(value, Some(low), high)])]).is_within_its_deviation()
        };
        assert!(is_near("stiffness_nm_per_rad", 7010.0, 20.9, None));
        assert!(!is_near("stiffness_nm_per_rad", 10_933.0, 5028.0, None), "1.7 deviations");
        assert!(!is_near("stiffness_nm_per_rad", 7010.0, 20.9, Some(1e6)));
        assert!(is_near("delta_kg", 0.3, -0.7, Some(1.3)) && !is_near("delta_kg", 0.9, -0.1, Some(1.9)));
        assert!(is_near("factor", 0.9, 0.5, Some(1.3)));
        let small = (0.1, Some(-0.9), Some(1.1));
        let large = (3.0, Some(2.0), Some(4.0));
        assert!(finding(&[("cos_rad", &[small]), ("sin_rad", &[small])]).is_within_its_deviation());
        assert!(!finding(&[("cos_rad", &[small]), ("sin_rad", &[large])]).is_within_its_deviation());
        assert!(
            !finding(&[("half_width_rad", &[large]), ("torque_nm", &[(1.0, None, None)])])
                .is_within_its_deviation()
        );
    }
}
