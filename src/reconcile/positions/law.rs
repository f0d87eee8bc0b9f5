//! The laws that compete with effects in absolute positions. The displacement by a law is linear in its amplitudes.

use super::analysis::Positions;
use super::fitted::Sample;
use super::kinematics::{Number, Placer};
use super::shape::Shape;
use crate::arm::effect::kind::ElasticRotation;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::{Rotation3, Vector3};

/// Torques `T_b` of a bent torsion curve, as fractions of the largest torque on the joint. At `T_b` the twist is half
/// of what the slope at zero torque gives.
const BEND_PARTS: [f64; 3] = [0.1, 0.3, 1.0];
/// A joint that turns by less than this from one row to the next stands still \[deg\].
const STILL_DEG: f64 = 1e-6;

/// A competing law: physics that is no effect in absolute positions.
#[derive(Debug, Clone)]
pub(super) enum Law {
    /// The joint of the candidate (a spring) with this index turns by `c T / (1 + |T|/T_b)`, with this torque `T_b`
    /// \[N m\].
    Bent(usize, f64),
    /// The joint of the candidate with this index turns by `a x + b x|x| + c x³`. Here `x` is the torque on it, divided
    /// by this largest torque \[N m\].
    Curve(usize, f64),
    /// The driven joint with this index lags by a constant angle behind the direction in which it turned into the pose.
    Direction(usize),
    /// The zero of the driven joint with this index changes in the course of the rows.
    Zero(usize),
    /// The tool bends under the payload, differently along the three axes of the last frame.
    Tool,
    /// All points move steadily in the course of the rows.
    Drift,
    /// The arm grows steadily in the course of the rows.
    Growth,
    /// All lengths are off by one factor.
    Scale,
}

impl Law {
    /// Number of amplitudes of the law.
    pub(super) fn count(&self) -> usize {
        match self {
            Law::Bent(..) | Law::Direction(_) | Law::Growth | Law::Scale => 1,
            Law::Curve(..) | Law::Zero(_) | Law::Tool | Law::Drift => 3,
        }
    }

    /// Number of parameters of the law: its amplitudes, and the torque `T_b` of a bent torsion curve.
    pub(super) fn numbers(&self) -> usize {
        self.count() + usize::from(matches!(self, Law::Bent(..)))
    }
}

/// The laws that are tried, and the data from which their columns are computed.
pub(super) struct CompetingLaws<'a> {
    found: &'a Positions,
    /// All laws.
    pub laws: Vec<Law>,
    /// For each sample and driven joint, 1 or -1 by the direction in which the joint turned into the pose; 0 if unknown.
    directions: Vec<Vec<f64>>,
    payloads_kg: Vec<f64>,
}

impl<'a> CompetingLaws<'a> {
    /// Lists the laws that the readings of the campaign can show.
    pub(super) fn new(found: &'a Positions, campaign: &Campaign) -> Self {
        let payloads_kg: Vec<f64> = campaign.positions.iter().map(|row| row.payload.mass_kg).collect();
        let mut laws = Vec::new();
        for (c, candidate) in found.candidates.iter().enumerate() {
            let most_nm = found.samples.iter().map(|s| s.deflection.torque_nm(c)).fold(0.0, f64::max);
            let is_joint =
                candidate.shape == Shape::Spring && candidate.rotation == ElasticRotation::AboutAxis;
            if is_joint && most_nm > 1e-6 {
                laws.extend(BEND_PARTS.map(|part| Law::Bent(c, part * most_nm)));
                laws.push(Law::Curve(c, most_nm));
            }
        }
        for joint in 0..found.tree.driven.len() {
            laws.extend([Law::Direction(joint), Law::Zero(joint)]);
        }
        if payloads_kg.iter().any(|kg| *kg > 0.0) {
            laws.push(Law::Tool);
        }
        laws.extend([Law::Drift, Law::Growth, Law::Scale]);
        Self { found, laws, directions: directions(campaign), payloads_kg }
    }

    /// The law in words, as the subject of a sentence.
    pub(super) fn words(&self, law: &Law) -> String {
        let at = |c: &usize| &self.found.candidates[*c].at;
        let name = |joint: &usize| &self.found.tree.driven[*joint];
        match law {
            Law::Bent(c, _) => format!("a torsion of {} that grows ever less with the torque", at(c)),
            Law::Curve(c, _) => format!("a torsion of {} that is not proportional to the torque", at(c)),
            Law::Direction(joint) => {
                format!(
                    "backlash of {} that follows the direction in which it turned into the pose",
                    name(joint)
                )
            }
            Law::Zero(joint) => {
                format!("a zero of {} that changes in the course of the readings", name(joint))
            }
            Law::Tool => "a tool that bends under the payload".into(),
            Law::Drift => "a steady drift in the order of the readings".into(),
            Law::Growth => "an arm that grows in the order of the readings".into(),
            Law::Scale => "a common factor on all lengths".into(),
        }
    }

    /// Appends to `columns` the derivatives of a sample's position with respect to the amplitudes of a law \[m\].
    pub(super) fn push_columns(
        &self,
        law: &Law,
        sample: &Sample,
        placer: &Placer,
        from_level: &Rotation3<f64>,
        columns: &mut Vec<Vector3<f64>>,
    ) {
        let part = sample.index as f64 / self.found.samples.len() as f64;
        let slope = |number: Number| {
            let mut out = Vec::with_capacity(1);
            placer.slopes(sample.placing(), &[number], &mut out);
            out[0]
        };
        let from_base_m = placer.at_m - placer.geometry.origin_m;
        match *law {
            Law::Bent(c, bend_nm) => {
                let (lever, torque_nm) = sample.deflection.lever(c);
                columns.push(from_level * lever * (torque_nm / (1.0 + torque_nm.abs() / bend_nm)));
            }
            Law::Curve(c, most_nm) => {
                let (lever, torque_nm) = sample.deflection.lever(c);
                let x = torque_nm / most_nm;
                columns.extend([x, x * x.abs(), x.powi(3)].map(|size| from_level * lever * size));
            }
            Law::Direction(joint) => {
                columns.push(slope(Number::Zero(joint)) * self.directions[sample.index][joint]);
            }
            Law::Zero(joint) => {
                let turning = slope(Number::Zero(joint));
                columns.extend([part, part.powi(2), part.powi(3)].map(|size| turning * size));
            }
            Law::Tool => {
                let weight = from_level * Vector3::new(0.0, 0.0, -self.payloads_kg[sample.index]);
                let axes = [0, 1, 2].map(|c| slope(Number::Tool(sample.point, c)));
                columns.extend(axes.map(|axis| axis * axis.dot(&weight)));
            }
            Law::Drift => columns.extend((0..3).map(|c| Vector3::ith(c, part))),
            Law::Growth => columns.push(from_base_m * part),
            Law::Scale => columns.push(from_base_m),
        }
    }
}

/// For each row and driven joint, the direction in which the joint turned from the pose of the row before into this
/// one: 1, -1, or 0 before its first motion. A joint that stood still keeps its direction.
fn directions(campaign: &Campaign) -> Vec<Vec<f64>> {
    let joints = campaign.positions.first().map_or(0, |row| row.pose_deg.len());
    let mut now = vec![0.0; joints];
    let mut out = Vec::with_capacity(campaign.positions.len());
    for (i, row) in campaign.positions.iter().enumerate() {
        if let Some(before) = i.checked_sub(1).map(|i| &campaign.positions[i]) {
            for (direction, (to, from)) in now.iter_mut().zip(row.pose_deg.iter().zip(&before.pose_deg)) {
                if (to - from).abs() > STILL_DEG {
                    *direction = (to - from).signum();
                }
            }
        }
        out.push(now.clone());
    }
    out
}
