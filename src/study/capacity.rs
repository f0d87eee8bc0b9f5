//! How much an arm holds: the largest payload with the drives that it has, at every pose of a study and at all of them.
//!
//! The payload keeps its centre and its moments of inertia, and its mass grows until a drive, an output bearing or the stress
//! of a link fails. The checks are those of sizing: in all poses together the largest static torque and the largest inertia
//! count, which may come from different poses.

use crate::catalog::Catalogs;
use crate::space::design_space::{DesignSpace, SpacePiece};
use crate::space::problem::ArmProblem;
use crate::space::station::Walk;

/// Payload beyond which nothing is looked for \[kg\].
const MOST_KG: f64 = 1e6;
/// Relative tolerance of a capacity.
const TOLERANCE: f64 = 1e-10;

/// What ends the payload.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Limit {
    /// The largest payload that holds \[kg\]; infinite if nothing limits it.
    pub payload_kg: f64,
    /// The joint or link that fails beyond it; empty if nothing does.
    pub piece: String,
    /// The check that fails beyond it.
    pub check: String,
}

/// The largest payload in one pose.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AtPose {
    /// Name of the pose.
    pub pose: String,
    /// Distance of the tip from the origin, in the plane across gravity \[m\].
    pub reach_m: f64,
    /// The largest payload there.
    pub limit: Limit,
}

/// The largest payload of an arm.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Capacity {
    /// The largest payload that holds in all poses together.
    pub limit: Limit,
    /// The pose that allows least by itself.
    pub pose: String,
    /// Each sizing pose by itself, the shortest reach first.
    pub table: Vec<AtPose>,
}

/// The capacity of the design with these options, one for each slot of the arm, tip first. `space` has its links.
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

/// The largest payload in some cases, by bisection: a heavier payload may pull against a tip force, but beyond the first
/// payload that fails none is looked for.
fn limit(space: &DesignSpace, catalogs: &Catalogs, options: &[u32], cases: &[usize]) -> Limit {
    let overload = |payload_kg: f64| {
        let mut loaded = space.clone();
        for (index, case) in loaded.cases.iter_mut().enumerate() {
            // in the other cases the arm is empty, so that they cannot overload a link
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
