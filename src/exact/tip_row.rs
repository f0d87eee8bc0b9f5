//! The row of the tip's displacement: the displacement along a fixed direction as a sum over the parts of a box's
//! members.

use super::box_work::BoxWork;
use super::parts::STIFFNESSES;
use super::problem::{Part, Problem};

/// The displacement of the tip in a judged case along a fixed direction, as a linear function of the numbers of the
/// parts. The direction is the direction of the tip's least displacement over the box. A judged case counts for
/// deflection and lowest mode.
pub(super) struct TipRow {
    /// Index of the case among all cases of the study.
    pub case: usize,
    /// Displacement of the tip along the direction per newton of each piece's weight \[m/N\]. The deflections of tubes,
    /// bearings and those gears that keep a single slope contribute to it.
    pub per_n: Vec<f64>,
    /// Displacement of the tip along the direction per radian of each joint's torsion \[m/rad\]; 0 for other pieces.
    pub joints: Vec<f64>,
    /// For each gear that keeps a single slope, the torque at which its torsion curve is evaluated \[N m\]. `None` for
    /// other pieces, for gears whose slope may change, and for joints whose drive is chosen by first fit (the
    /// lightest drive that meets the demand).
    pub torques_nm: Vec<Option<f64>>,
    /// Displacement of the tip along the direction per unit of each compliance of a tube, or of a joint's bearing; one
    /// entry for each piece.
    pub compliances: Vec<[f64; STIFFNESSES]>,
}

impl TipRow {
    /// The row of the tip's displacement in a judged case, and the part of this displacement that no choice changes
    /// \[m\]. `judged` is the index of the case among the judged cases, and `case` its index among all cases.
    pub(super) fn new(problem: &Problem, judged: usize, case: usize, work: &BoxWork) -> (Self, f64) {
        let pose = &problem.poses[case];
        let pieces = problem.parts.len();
        let mut tip = Self {
            case,
            per_n: vec![0.0; pieces],
            joints: vec![0.0; pieces],
            torques_nm: vec![None; pieces],
            compliances: vec![[0.0; STIFFNESSES]; pieces],
        };
        let mut fixed_m = 0.0;
        for (row, &force) in pose.rows.iter().zip(&work.forces[case]) {
            let tip_per_unit = work.tip_directions[judged].dot(&row.tip_m);
            let at = if tip_per_unit > 0.0 { force[0] } else { force[1] };
            let least = if let Some(curve) = work.curve(row) {
                tip.joints[row.piece] = tip_per_unit;
                let [least_nm, most_nm] = work.torques[case][row.piece];
                let (breaks, play) = (work.breaks[row.piece], problem.joint_plays[row.piece].as_ref());
                let [less, more] = curve.twist_of_play(play, force);
                fixed_m += tip_per_unit * if tip_per_unit > 0.0 { less } else { more };
                let known = matches!(problem.parts[row.piece], Part::Drives { .. } | Part::Given { .. });
                // A gear whose slope may change is evaluated at a torque of its own, which extra rows force to equal
                // the torque that the weights cause.
                if !known || !curve.keeps_its_slope(play, [least_nm, most_nm], breaks) {
                    continue;
                }
                tip.torques_nm[row.piece] = Some(at);
                tip_per_unit / curve.steepest(least_nm, most_nm)
            } else {
                let (resisted, factor) = pose.pieces[row.piece].resisted(row.coordinate);
                let stiffness = work.stiff[row.piece][resisted];
                if stiffness == 0.0 {
                    continue;
                }
                tip.compliances[row.piece][resisted] += tip_per_unit * at * factor;
                tip_per_unit * factor / stiffness
            };
            fixed_m += least * (row.fixed - at);
            for (total, c) in tip.per_n.iter_mut().zip(&row.per_n) {
                *total += least * c;
            }
        }
        (tip, fixed_m)
    }
}
