//! Values with their 95 % intervals, and effects found with such values.

use crate::arm::effect::entry::word_of;
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
    /// This interval, widened to contain the best value `u`.
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

    /// Whether all sizes of the effect may be those of an arm without it, by their 95 % intervals: a stiffness may be
    /// infinite, a factor 1, and any other size 0. The torque over which play opens is no size.
    pub(crate) fn may_be_absent(&self) -> bool {
        let may_be = |name: &str, estimate: &Estimate| {
            let contains =
                |x: f64| estimate.low.is_none_or(|e| e <= x) && estimate.high.is_none_or(|e| x <= e);
            match name {
                _ if name.starts_with("stiffness") => estimate.high.is_none(),
                _ if name.ends_with("factor") => contains(1.0),
                _ => contains(0.0),
            }
        };
        let mut sizes = self.parameters.iter().filter(|(name, _)| name != "torque_nm");
        sizes.all(|(name, estimates)| estimates.iter().all(|estimate| may_be(name, estimate)))
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

    fn finding(parameters: &[(&str, &[[Option<f64>; 2]])]) -> Finding {
        let estimates = |ends: &[[Option<f64>; 2]]| {
            ends.iter().map(|[low, high]| Estimate { value: 0.5, low: *low, high: *high }).collect()
        };
        Finding {
            effect: "x".into(),
            at: "j1".into(),
            parameters: parameters.iter().map(|(name, ends)| (name.to_string(), estimates(ends))).collect(),
            indistinguishable_from: Vec::new(),
        }
    }

    #[test]
    fn an_effect_may_be_absent_if_all_its_sizes_may() {
        let [minus, zero, one, two] = [-1.0, 0.0, 1.0, 2.0].map(Some);
        assert!(finding(&[("stiffness_nm_per_rad", &[[one, None]])]).may_be_absent());
        assert!(!finding(&[("stiffness_nm_per_rad", &[[one, two]])]).may_be_absent());
        assert!(finding(&[("cos_rad", &[[minus, one]]), ("sin_rad", &[[minus, one]])]).may_be_absent());
        assert!(!finding(&[("cos_rad", &[[minus, one]]), ("sin_rad", &[[one, two]])]).may_be_absent());
        assert!(finding(&[("factor", &[[zero, two]])]).may_be_absent());
        assert!(
            !finding(&[("half_width_rad", &[[one, two]]), ("torque_nm", &[[None, None]])]).may_be_absent()
        );
    }
}
