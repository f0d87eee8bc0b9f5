//! Poses of an imported robot that are beyond the ranges of its joints, as its `import.json` states them.

use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::report::number::significant;
use serde_json::Value;

/// A sentence on the joints that are beyond their ranges in some pose; `None` if none is. `import` is the content of
/// `import.json`.
pub(crate) fn beyond_ranges(import: &Value, arm: &Arm, cases: &[LoadCase]) -> Option<String> {
    let stated = import["joints"].as_array()?;
    let driven = arm.driven_joints();
    let of_joint = |(i, name): (usize, &str)| -> Option<String> {
        let own = stated.iter().find(|joint| joint["name"] == name)?;
        let (unit, keys) = match own["lower_mm"].is_null() {
            true => ("deg", ["lower_deg", "upper_deg"]),
            false => ("mm", ["lower_mm", "upper_mm"]),
        };
        let [low, high] = keys.map(|key| own[key].as_f64());
        let (low, high) = (low?, high?);
        let is_beyond = |case: &&LoadCase| !(low - ROUNDING..=high + ROUNDING).contains(&case.pose_deg[i]);
        let case = cases.iter().find(is_beyond)?;
        let [at, low, high] = [case.pose_deg[i], low, high].map(|x| significant(x, 4));
        Some(format!("{name} at {at} {unit} in \u{201c}{}\u{201d} (range {low} to {high})", case.name))
    };
    let names = driven.iter().map(|joint| joint.name.as_str());
    let beyond: Vec<String> = names.enumerate().filter_map(of_joint).collect();
    (!beyond.is_empty()).then(|| {
        format!(
            "The robot cannot take every pose that is asked for: {}. Ranges: import.json.",
            beyond.join(", ")
        )
    })
}

/// Amount by which a pose may exceed a range without being reported \[deg or mm\]. The range was converted from radians
/// or metres, so its ends have rounding errors.
const ROUNDING: f64 = 1e-6;
