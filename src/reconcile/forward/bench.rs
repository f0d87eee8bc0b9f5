//! Bench readings: the twist of one joint through a closed cycle of torques.

use super::coefficients::Layout;
use super::datum::Datum;
use crate::arm::effect::channel::Channel;
use crate::arm::joint_law::JointLaw;
use crate::reconcile::readings::campaign::Campaign;

/// Number of arc minutes in a radian.
pub(crate) const ARCMIN_PER_RAD: f64 = 10800.0 / std::f64::consts::PI;

/// One joint's rows on the bench, in the order of the file.
#[derive(Debug, Clone)]
pub(crate) struct Bench {
    /// Index of the joint among the joints of the [`Layout`].
    pub joint: usize,
    torques_nm: Vec<f64>,
    rows: Vec<usize>,
}

/// Gathers the bench rows of each joint, and appends their readings to `data`.
pub(crate) fn prepare(campaign: &Campaign, layout: &Layout, data: &mut Vec<Datum>) -> Vec<Bench> {
    let mut bench: Vec<Bench> = Vec::new();
    for (row_index, row) in campaign.windup.iter().enumerate() {
        let Some(joint) = layout.joints.iter().position(|j| j.name == row.joint) else { continue };
        let index = data.len();
        data.push(Datum {
            channel: Channel::Windup,
            row: row.row,
            index: row_index,
            component: 0,
            group: usize::MAX,
            value: row.windup_arcmin,
            sigma: row.sigma_arcmin,
        });
        match bench.iter_mut().find(|b| b.joint == joint) {
            Some(b) => {
                b.torques_nm.push(row.torque_nm);
                b.rows.push(index);
            }
            None => bench.push(Bench { joint, torques_nm: vec![row.torque_nm], rows: vec![index] }),
        }
    }
    bench
}

impl Bench {
    /// Magnitudes of the torques on the joint in its bench rows \[N m\].
    pub(crate) fn sizes_nm(&self) -> impl Iterator<Item = f64> + '_ {
        self.torques_nm.iter().map(|t| t.abs())
    }

    /// The torques on the joint \[N m\], in the order of the file.
    pub(crate) fn torques_nm(&self) -> &[f64] {
        &self.torques_nm
    }

    /// Writes the twist at every row of the joint \[rad\] to its place in `out` \[arcmin\].
    pub(crate) fn write(&self, twists_rad: &[f64], out: &mut [f64]) {
        for (&index, twist_rad) in self.rows.iter().zip(twists_rad) {
            out[index] = twist_rad * ARCMIN_PER_RAD;
        }
    }

    /// Writes the predicted twist (torsion angle) at every row of the joint to its place in `out` \[arcmin\].
    pub(crate) fn predict(&self, law: &JointLaw, out: &mut [f64]) {
        self.write(&bench_twists_rad(law, &self.torques_nm), out);
    }
}

/// Twists (torsion angles) of a joint on the bench, one per torque \[rad\]. The cycle of torques is computed twice,
/// and the twists of the second time are returned: only then has the friction play reached the state that a repeated
/// cycle has.
pub(crate) fn bench_twists_rad(law: &JointLaw, torques_nm: &[f64]) -> Vec<f64> {
    // the first round brings the play to its state in a repeated cycle
    let mut state = 0.0;
    for &torque in torques_nm {
        law.play_angle_rad(torque, &mut state);
    }
    torques_nm.iter().map(|&torque| law.play_angle_rad(torque, &mut state)).collect()
}
