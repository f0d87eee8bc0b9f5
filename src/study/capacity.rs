//! Capacity: the largest payload of an arm with its drives unchanged, in each pose of a study and in all of them.
//!
//! The mass of the payload grows until a drive, an output bearing or the stress of a link exceeds its limit. The
//! payload keeps its centre of gravity and its moments of inertia. The checks are those of sizing. For all poses
//! together, the largest static torque and the largest inertia are combined, which may come from different poses.

use super::chosen::{chosen_design, why_not_held};
use super::definition::Study;
use super::refusal::Refusal;
use crate::catalog::Catalogs;
use crate::space::design_space::{DesignSpace, SpacePiece};
use crate::space::problem::ArmProblem;
use crate::space::station::Walk;
use serde_json::{Value, json};

/// Largest payload that is tried \[kg\]. An arm that still passes with it is reported as having no limit.
const MOST_KG: f64 = 1e6;
/// Relative tolerance of the bisection for the largest payload.
const TOLERANCE: f64 = 1e-10;

/// The largest payload, and what limits it.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// The largest payload that passes every check \[kg\]; infinite if nothing limits it.
    pub payload_kg: f64,
    /// Name of the joint or link that fails beyond this payload; empty if nothing limits it.
    pub piece: String,
    /// Label of the check that fails beyond this payload.
    pub check: String,
}

/// The largest payload in one pose.
#[derive(Debug, Clone, PartialEq)]
pub struct AtPose {
    /// Name of the pose.
    pub pose: String,
    /// Distance of the tip from the origin, measured perpendicular to gravity \[m\].
    pub reach_m: f64,
    /// The largest payload in this pose.
    pub limit: Limit,
}

/// The largest payload of an arm, in all poses and in each of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Capacity {
    /// The largest payload that passes in all sizing poses together.
    pub limit: Limit,
    /// Name of the sizing pose whose largest payload is the smallest of all.
    pub pose: String,
    /// The largest payload in each sizing pose, sorted by reach, shortest first.
    pub table: Vec<AtPose>,
}

impl Limit {
    /// The payload in JSON; null if nothing limits it.
    fn payload_json(&self) -> Value {
        if self.payload_kg.is_finite() { json!(self.payload_kg) } else { Value::Null }
    }
}

impl Capacity {
    /// The capacity as JSON, as `armwright capacity --json` prints it: the limit in all poses together, and one entry
    /// for each pose.
    pub fn to_json(&self) -> Value {
        let rows: Vec<Value> = self
            .table
            .iter()
            .map(|at| {
                json!({"reach_m": at.reach_m, "payload_kg": at.limit.payload_json(), "pose": at.pose,
                "joint": at.limit.piece, "check": at.limit.check})
            })
            .collect();
        json!({"payload_kg": self.limit.payload_json(), "pose": self.pose, "joint": self.limit.piece,
        "check": self.limit.check, "table": rows})
    }
}

/// The capacity of the design with the `design_id` given as `id`. Without an id, it is the capacity of a design with
/// links of median mass and the lightest drives.
///
/// # Errors
/// The study has no such design, or a drive of the design does not meet even the study's own payload.
pub fn capacity_of(study: &Study, id: Option<&str>, catalogs: &Catalogs) -> Result<Capacity, Refusal> {
    let (space, chosen) = chosen_design(study, id, catalogs)?;
    let problem = ArmProblem::new(&space, catalogs);
    let arm = problem.walk(&chosen, |_, _| {}).map_err(|slot| why_not_held(&problem, &chosen, slot))?;
    Ok(capacity(&space, catalogs, arm.slot_options()))
}

/// The capacity of the design with these options, one for each slot of the arm (joint or link, in the order in which
/// the arm is built), tip first. `space` is the space to which the options belong.
pub(crate) fn capacity(space: &DesignSpace, catalogs: &Catalogs, options: &[u32]) -> Capacity {
    let upright = space.down;
    let at_pose = |&case: &usize| {
        let tip_m = Walk::new(space, &space.cases[case]).tip_m;
        AtPose {
            pose: space.cases[case].name.clone(),
            reach_m: (tip_m - upright * upright.dot(&tip_m)).norm(),
            limit: limit(space, catalogs, options, &[case]),
        }
    };
    let mut table: Vec<AtPose> = space.sizing_cases.iter().map(at_pose).collect();
    let least = table.iter().min_by(|a, b| a.limit.payload_kg.total_cmp(&b.limit.payload_kg));
    let pose = least.map_or(String::new(), |at| at.pose.clone());
    table.sort_by(|a, b| a.reach_m.total_cmp(&b.reach_m));
    Capacity { limit: limit(space, catalogs, options, &space.sizing_cases), pose, table }
}

/// The largest payload in the cases with the indices `cases`, by bisection; all other cases are computed without
/// payload. A heavier payload could pass again where it counteracts a tip force; only the first payload that fails
/// counts.
fn limit(space: &DesignSpace, catalogs: &Catalogs, options: &[u32], cases: &[usize]) -> Limit {
    let overload = |payload_kg: f64| {
        let mut loaded = space.clone();
        for (index, case) in loaded.cases.iter_mut().enumerate() {
            // in all other cases the arm is empty, so that they cannot overload a link
            case.payload.mass_kg = if cases.contains(&index) { payload_kg } else { 0.0 };
        }
        let problem = ArmProblem::new(&loaded, catalogs);
        problem.overload(options, cases).map(|(piece, check)| {
            let name =
                space.pieces.get(piece).map_or(String::new(), |piece| SpacePiece::name(piece).to_string());
            (name, check.map_or("link stress".to_string(), |check| check.kind.label().to_string()))
        })
    };
    let (mut low, mut high) = (0.0, 1.0);
    let mut why = overload(0.0);
    if let Some((piece, check)) = why {
        return Limit { payload_kg: 0.0, piece, check };
    }
    loop {
        why = overload(high);
        if why.is_some() || high > MOST_KG {
            break;
        }
        (low, high) = (high, 2.0 * high);
    }
    let Some((mut piece, mut check)) = why else {
        return Limit { payload_kg: f64::INFINITY, piece: String::new(), check: String::new() };
    };
    while high - low > TOLERANCE * high {
        let middle = 0.5 * (low + high);
        match overload(middle) {
            Some(found) => {
                (piece, check) = found;
                high = middle;
            }
            None => low = middle,
        }
    }
    Limit { payload_kg: low, piece, check }
}
