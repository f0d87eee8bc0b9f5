//! Laws of friction that is proportional to the torque of a joint, as in bearings and meshing teeth under load.
//!
//! Friction makes the twist lag behind the torque. In the effect [`hysteresis`](crate::arm::effect::hysteresis) the
//! largest lag (half width) is the same at all torques. Here it is a fraction of the torque, so that a joint hardly
//! lags near zero torque and lags much under a large one.

use super::{Builder, Law, placed};

/// Friction torques that are tried, as fractions of the torque. The lag is not linear in this fraction, so a small and
/// a large one are tried.
const TRIED_PARTS: [f64; 2] = [0.02, 0.1];

impl Builder<'_> {
    /// For each compliant joint, the laws of a friction torque that is proportional to its torque.
    pub(super) fn friction_laws(&self) -> Vec<Law> {
        let mut out = Vec::new();
        for (joint, slot) in self.forward.layout.joints.iter().enumerate() {
            if self.fit.point.coefficients.laws[joint].is_rigid() {
                continue;
            }
            let what = format!("a friction of {} in proportion to its torque", slot.name);
            let law = |part: f64| Law::new(what.clone(), vec![self.friction_column(joint, part)]);
            out.extend(placed(&slot.name, TRIED_PARTS.map(law).into()));
        }
        out
    }

    /// The change of every reading, in its unit, if the joint with index `joint` has a friction torque of the fraction
    /// `part` of its torque. The change is divided by `part`. Frequencies do not change, because friction does not slip
    /// in small vibrations.
    fn friction_column(&self, joint: usize, part: f64) -> Vec<f64> {
        let forward = self.forward;
        let coefficients = &self.fit.point.coefficients;
        let per_part = coefficients.laws[joint].tangent_compliance_rad_per_nm(0.0) / part;
        let mut truth = vec![0.0; forward.data.len()];
        for pose in &forward.statics {
            let torques = pose.torques_nm(&forward.layout, coefficients);
            let lags = lags_nm(torques.iter().map(|t| t[joint]), 0.0, part);
            for (load, lag_nm) in lags[1..].iter().enumerate() {
                for (c, datum) in pose.measured(load) {
                    let turned_rad = per_part * (lag_nm - lags[0]);
                    truth[datum] = 1e3 * pose.geometry.joints[joint].tip[c] * turned_rad;
                }
            }
        }
        if let Some(bench) = forward.bench.iter().find(|bench| bench.joint == joint) {
            // the first round brings the friction to its state in a repeated cycle
            let first = lags_nm(bench.torques_nm().iter().copied(), 0.0, part);
            let last_nm = bench.torques_nm().last().map_or(0.0, |t| t + first[first.len() - 1]);
            let lags = lags_nm(bench.torques_nm().iter().copied(), last_nm, part);
            bench.write(&lags.iter().map(|nm| per_part * nm).collect::<Vec<_>>(), &mut truth);
        }
        self.read(&truth)
    }
}

/// The torque that twists the joint, minus the torque on the joint \[N m\], for each torque of a sequence. The two
/// differ by the friction torque, which is at most the fraction `part` of the torque on the joint. `state_nm` is the
/// twisting torque before the first of the sequence.
fn lags_nm(torques_nm: impl Iterator<Item = f64>, mut state_nm: f64, part: f64) -> Vec<f64> {
    let lag = |torque_nm: f64| {
        let reach_nm = part * torque_nm.abs();
        state_nm = state_nm.max(torque_nm - reach_nm).min(torque_nm + reach_nm);
        state_nm - torque_nm
    };
    torques_nm.map(lag).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_lags_a_rising_torque_by_the_friction_and_leads_a_falling_one() {
        let lags = lags_nm([10.0, 40.0, 39.0, 20.0, -5.0].into_iter(), 0.0, 0.1);
        // at 39 N m friction still holds the joint where 40 N m had left it, at 36 N m
        for (lag, right) in lags.iter().zip([-1.0, -4.0, -3.0, 2.0, 0.5]) {
            assert!((lag - right).abs() < 1e-12, "{lags:?}");
        }
    }
}
