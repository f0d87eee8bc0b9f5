//! The worst poses of a front's picks within the ranges of their joints.
//!
//! A study judges its designs in the poses that it lists. Here each pick is put into other poses, under the loads of
//! the judged cases. The search finds the pose with the largest tip deflection and the pose with the lowest mode.

use super::pose_search::{PoseRanges, Scored};
use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::mechanics::chain::{Chain, Posed};
use crate::space::design::full_objectives;
use rayon::prelude::*;

/// The worst value of one objective over all poses searched.
#[derive(Debug, Clone, PartialEq)]
pub struct WorstPose {
    /// The pose, with one entry for each driven joint, base to tip: an angle \[deg\], or the travel of a prismatic
    /// joint \[mm\].
    pub pose_deg: Vec<f64>,
    /// Name of the judged case whose load the arm has in this pose.
    pub load_of: String,
    /// Value of the objective in this pose (m or Hz).
    pub value: f64,
    /// Worst value of the objective over the judged cases (m or Hz).
    pub judged: f64,
}

/// The worst poses of an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct WorstPoses {
    /// The pose with the largest tip deflection found \[m\].
    pub deflection: WorstPose,
    /// The pose with the lowest mode found \[Hz\].
    pub mode: WorstPose,
}

/// Searches for the worst poses of an arm. `ranges` has the range of each driven joint, base to tip \[deg or mm\];
/// passive joints turn with them. The arm is tried with the load of each case. `None` if there is no case.
pub fn worst_poses(arm: &Arm, cases: &[LoadCase], ranges: &[[f64; 2]]) -> Option<WorstPoses> {
    let judged = full_objectives(arm, cases);
    let found: Vec<[WorstPose; 2]> =
        loads(cases).into_iter().filter_map(|load| worst_under(arm, load, cases, ranges)).collect();
    let [deflections, modes]: [Vec<WorstPose>; 2] =
        [0, 1].map(|which| found.iter().map(|of_load| of_load[which].clone()).collect());
    let deflection = deflections.into_iter().reduce(|a, b| if b.value > a.value { b } else { a })?;
    let mode = modes.into_iter().reduce(|a, b| if b.value < a.value { b } else { a })?;
    Some(WorstPoses {
        deflection: WorstPose { judged: judged.tip_deflection_m, ..deflection },
        mode: WorstPose { judged: judged.lowest_mode_hz, ..mode },
    })
}

/// One case for each different load. Cases with the same payload, tip force, tip moment, water and models have the same
/// load; the first of them is taken.
pub(super) fn loads(cases: &[LoadCase]) -> Vec<&LoadCase> {
    let same = |a: &LoadCase, b: &LoadCase| {
        a.payload == b.payload
            && a.tip_force_n == b.tip_force_n
            && a.tip_moment_nm == b.tip_moment_nm
            && a.water == b.water
            && (a.links, a.joints) == (b.links, b.joints)
    };
    let mut out: Vec<&LoadCase> = Vec::new();
    for case in cases {
        if out.iter().all(|other| !same(other, case)) {
            out.push(case);
        }
    }
    out
}

/// The worst poses under the load of the case `load`: the pose with the largest deflection, and the pose with the
/// lowest mode. The fields `judged` are left undefined (NaN). `None` if there is no pose to start from.
fn worst_under(
    arm: &Arm,
    load: &LoadCase,
    cases: &[LoadCase],
    ranges: &[[f64; 2]],
) -> Option<[WorstPose; 2]> {
    let structure = arm.structure_in(load);
    let chain = Chain::new(&structure, load.links);
    let posed = |pose_deg: &[f64]| {
        let pose_rad = chain.pose_si(pose_deg);
        let posed = chain.pose_rad(&pose_rad, &load.payload, load.tip_force_n);
        Posed { tip_moment_nm: load.tip_moment_nm, ..posed }
    };
    let deflection_m = |pose_deg: &[f64]| posed(pose_deg).statics().tip_displacement_m.norm();
    let both = |pose_deg: &[f64]| {
        let posed = posed(pose_deg);
        let statics = posed.statics();
        [statics.tip_displacement_m.norm(), -posed.lowest_frequency_hz(&statics)]
    };
    let ranges = PoseRanges::new(ranges, &arm.driven_joints()).that_matter(both);
    let mut poses = ranges.first_poses();
    poses.extend(cases.iter().map(|case| ranges.nearest(&case.pose_deg)));
    let values: Vec<[f64; 2]> = poses.par_iter().map(|pose_deg| both(pose_deg)).collect();
    let scored = |which: usize| -> Vec<Scored> {
        let of = |(pose_deg, values): (&Vec<f64>, &[f64; 2])| Scored {
            pose_deg: pose_deg.clone(),
            score: values[which],
        };
        poses.iter().zip(&values).map(of).collect()
    };
    let found = |top: Scored, sign: f64| WorstPose {
        pose_deg: top.pose_deg,
        load_of: load.name.clone(),
        value: sign * top.score,
        judged: f64::NAN,
    };
    Some([
        found(ranges.climb(&scored(0), deflection_m)?, 1.0),
        found(ranges.climb(&scored(1), |pose_deg: &[f64]| both(pose_deg)[1])?, -1.0),
    ])
}
