//! Transmission error that repeats once and twice a turn of the motor. It is removed from the signals before they are
//! differentiated.
//!
//! Such an error varies fast. Its second derivative is as large as the acceleration of the motion and would be taken
//! for inertia. The error is found in the fast part of the twist `y`, which is `y - smooth(y)`. The sines and cosines
//! that are fitted to the twist are filtered in the same way, so that slow torque and inertia have no influence.

use super::smooth::smooth;
use crate::reconcile::readings::record::{JointSignals, Record};
use nalgebra::{Matrix4, Vector4};

/// Half width of the window that separates the fast from the slow part of a signal \[rows\].
const HALF: usize = 16;
/// A transmission error is removed only if it explains at least this fraction of the sum of squares of the fast part of
/// the twist (see [`fast`]).
const TELLING: f64 = 0.1;

/// Transmission error of a joint's gear once and twice a turn of the motor.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Wave {
    /// Amplitudes of sine and cosine once a turn, then twice a turn, at the output \[rad\]. All zero if there is no
    /// error.
    waves_rad: [f64; 4],
    /// Whether the error appears in the motor's recorded angle (`true`) or in the link's (`false`).
    is_of_motor: bool,
}

/// Sine and cosine of the angle `phase` \[rad\], then of twice this angle.
fn shapes(phase: f64) -> [f64; 4] {
    let (sin, cos) = libm::sincos(phase);
    [sin, cos, 2.0 * sin * cos, cos * cos - sin * sin]
}

/// Fast part of the signal `x`, which is sampled at the times `t_s` \[s\]: the signal minus its smoothed value, in its
/// own unit. Zero near ends and gaps, where there is no smoothed value.
fn fast(t_s: &[f64], x: &[f64]) -> Vec<f64> {
    let slow = smooth(t_s, x, HALF).value;
    x.iter().zip(slow).map(|(x, slow)| if slow.is_nan() { 0.0 } else { x - slow }).collect()
}

impl Wave {
    /// Finds the transmission error of the joint with the name `joint` from all records. It is zero if the ratio is
    /// not stated or if the error explains too little.
    pub(crate) fn find(records: &[Record], joint: &str) -> Self {
        let own: Vec<(&[f64], &JointSignals)> = records
            .iter()
            .flat_map(|r| r.joints.iter().map(move |j| (r.t_s.as_slice(), j)))
            .filter(|(_, j)| j.joint == joint && !j.link_rad.is_empty() && j.ratio.is_some_and(|n| n > 1.0))
            .collect();
        let (mut normal, mut right, mut total) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
        for (t_s, signals) in &own {
            let twist: Vec<f64> =
                signals.motor_rad.iter().zip(&signals.link_rad).map(|(m, l)| m - l).collect();
            let phases = signals.motor_rad.iter().map(|q| shapes(signals.ratio.unwrap_or(1.0) * q));
            let waves: Vec<[f64; 4]> = phases.collect();
            let columns: [Vec<f64>; 4] =
                std::array::from_fn(|k| fast(t_s, &waves.iter().map(|w| w[k]).collect::<Vec<_>>()));
            for (i, y) in fast(t_s, &twist).into_iter().enumerate() {
                let row = Vector4::from_fn(|k, _| columns[k][i]);
                normal += row * row.transpose();
                right += row * y;
                total += y * y;
            }
        }
        let Some(found) = normal.cholesky().map(|c| c.solve(&right)) else { return Self::default() };
        if found.dot(&right) < TELLING * total {
            return Self::default();
        }
        let waves_rad = [found[0], found[1], found[2], found[3]];
        let calmed = [true, false].map(|is_of_motor| Self { waves_rad, is_of_motor }.calms(&own));
        Self { waves_rad, is_of_motor: calmed[0] < calmed[1] }
    }

    /// Ratio by which removing the error reduces the acceleration of the signal that has it: the sum of squares of the
    /// acceleration after the removal, divided by the sum before. 1 if the acceleration is zero.
    fn calms(&self, own: &[(&[f64], &JointSignals)]) -> f64 {
        let size = |t_s: &[f64], x: &[f64]| -> f64 {
            smooth(t_s, x, HALF).curvature.iter().filter(|a| !a.is_nan()).map(|a| a * a).sum()
        };
        let (mut without, mut with) = (0.0, 0.0);
        for (t_s, signals) in own {
            let [motor_rad, link_rad] = self.taken_from(signals);
            let (calm, raw) = if self.is_of_motor {
                (motor_rad, &signals.motor_rad)
            } else {
                (link_rad, &signals.link_rad)
            };
            without += size(t_s, &calm);
            with += size(t_s, raw);
        }
        if with > 0.0 { without / with } else { 1.0 }
    }

    /// Angles of motor and link \[rad\], one per row, with the error removed from the side that has it.
    pub(crate) fn taken_from(&self, signals: &JointSignals) -> [Vec<f64>; 2] {
        let [mut motor_rad, mut link_rad] = [signals.motor_rad.clone(), signals.link_rad.clone()];
        let Some(ratio) = signals.ratio.filter(|_| self.waves_rad != [0.0; 4]) else {
            return [motor_rad, link_rad];
        };
        for (motor, link) in motor_rad.iter_mut().zip(&mut link_rad) {
            let twist: f64 = shapes(ratio * *motor).iter().zip(self.waves_rad).map(|(s, a)| s * a).sum();
            if self.is_of_motor {
                *motor -= twist;
            } else {
                *link += twist;
            }
        }
        [motor_rad, link_rad]
    }
}
