//! Laws of joints: a further twist as a function of the torque, the angle or the order of the tests.

use super::super::waves::waves;
use super::occasions::part;
use super::{Builder, Law, one_or_both};
use crate::arm::effect::channel::Channel;
use crate::arm::effect::{servo_compliance, stiffness_waves};
use crate::reconcile::forward::bench::ARCMIN_PER_RAD;

/// Torque, angle and test of a joint at the time of a reading.
pub(super) struct State {
    pub(super) torque_nm: f64,
    angle_deg: f64,
    /// Fraction of the channel's rows that were taken before this reading.
    part: f64,
    channel: Channel,
    /// Whether this is the unloaded reference of a displacement, and not the displacement itself.
    is_reference: bool,
}

/// A function that gives two numbers for a state of the joint: an additional torque \[N m\], and its derivative with
/// respect to the joint's torque. The additional twist of the joint is its compliance times the additional torque. The
/// additional tangent compliance is the compliance times the derivative.
pub(super) type Shape<'a> = &'a dyn Fn(&State) -> (f64, f64);

impl Builder<'_> {
    pub(super) fn joint_laws(&self, joint: usize) -> Vec<Law> {
        let law = &self.fit.point.coefficients.laws[joint];
        let compliance = law.tangent_compliance_rad_per_nm(0.0);
        let statics = self.torques_nm.iter().map(|t| t[joint].abs());
        let largest_nm = statics.chain(self.forward.bench_torques_nm(joint)).fold(0.0, f64::max);
        if compliance == 0.0 || largest_nm == 0.0 {
            return Vec::new();
        }
        let name = &self.forward.layout.joints[joint].name;
        let column = |shape: Shape| self.joint_column(joint, compliance, shape);
        let part = |s: &State| s.torque_nm / largest_nm;
        let odd = [
            column(&|s| (s.torque_nm * part(s).abs(), 2.0 * part(s).abs())),
            column(&|s| (s.torque_nm * part(s).powi(2), 3.0 * part(s).powi(2))),
        ];
        let even = [
            column(&|s| (s.torque_nm.abs(), s.torque_nm.signum())),
            column(&|s| (s.torque_nm * part(s), 2.0 * part(s))),
        ];
        // on the bench the angle of the joint is not known
        let wave = |k: usize| {
            column(&|s| {
                let factor = if s.channel == Channel::Windup { 0.0 } else { waves(s.angle_deg)[k] };
                (s.torque_nm * factor, factor)
            })
        };
        let order = |channel: Channel, power: i32| {
            column(&|s| {
                let factor = if s.channel == channel { s.part.powi(power) } else { 0.0 };
                (s.torque_nm * factor, factor)
            })
        };
        let mut out =
            one_or_both(&format!("a stiffness of {name} that changes with the size of its torque"), odd);
        out.extend(one_or_both(
            &format!("a stiffness of {name} that differs between the senses of its torque"),
            even,
        ));
        if self.campaign.arm.driven_joint_names().contains(&name.as_str()) {
            let what = format!("a stiffness of {name} that changes with its angle");
            let effect = Some(stiffness_waves::KIND.name);
            out.push(Law { effect, ..Law::new(what.clone(), vec![wave(0), wave(1)]) });
            out.push(Law { effect, ..Law::new(what, vec![wave(2), wave(3)]) });
        }
        for channel in [Channel::Static, Channel::Modal] {
            let what =
                format!("a stiffness of {name} that changes with the order of the {} tests", channel.word());
            out.extend(one_or_both(&what, [order(channel, 1), order(channel, 2)]));
            // a servo may hold a joint less stiffly than a brake does; with one kind of readings only, this cannot be
            // told from a different stiffness of the joint
            if self.kinds_of_readings() > 1 {
                let what = format!("a stiffness of {name} that is another in the {} tests", channel.word());
                let effect = Some(servo_compliance::KIND.name);
                out.push(Law { effect, ..Law::new(what, vec![order(channel, 0)]) });
            }
        }
        out.extend(self.warming_laws(joint, &column));
        out
    }

    /// Laws of a joint that warms up or works loose in the course of the tests, if all references were read before the
    /// tests. The laws are for the static tests, and for static and modal tests together. `column` builds a column of
    /// the joint.
    fn warming_laws(&self, joint: usize, column: &dyn Fn(Shape) -> Vec<f64>) -> Vec<Law> {
        let name = &self.forward.layout.joints[joint].name;
        let is_empty = |channel| self.forward.range(channel).is_empty();
        let of = |channels: &'static [Channel], tests: &str| {
            let order = |power: i32| {
                column(&|s| {
                    let changes = channels.contains(&s.channel) && !s.is_reference;
                    let factor = if changes { s.part.powi(power) } else { 0.0 };
                    (s.torque_nm * factor, factor)
                })
            };
            let what = format!(
                "a stiffness of {name} that changes with the order of the {tests} tests, from references read before them"
            );
            one_or_both(&what, [order(1), order(2)])
        };
        match (is_empty(Channel::Static), is_empty(Channel::Modal)) {
            (true, _) => Vec::new(),
            (false, true) => of(&[Channel::Static], "static"),
            (false, false) => {
                let mut out = of(&[Channel::Static], "static");
                out.extend(of(&[Channel::Static, Channel::Modal], "static and modal"));
                out
            }
        }
    }

    /// Number of channels for which the campaign has readings.
    pub(super) fn kinds_of_readings(&self) -> usize {
        let channels = [Channel::Static, Channel::Modal, Channel::Windup];
        channels.into_iter().filter(|channel| !self.forward.range(*channel).is_empty()).count()
    }

    /// The change of every reading, in its unit, by an additional twist of the joint with index `joint`. This twist
    /// is `compliance` \[rad/(N m)\] times `shape`, which depends on the torque, angle and row.
    pub(super) fn joint_column(&self, joint: usize, compliance: f64, shape: Shape) -> Vec<f64> {
        let forward = self.forward;
        let driven = self.campaign.arm.driven_joint_names();
        let own = driven.iter().position(|n| *n == forward.layout.joints[joint].name);
        let angle_deg = |pose: &[f64]| own.map_or(0.0, |j| pose[j]);
        let mut truth = vec![0.0; forward.data.len()];
        let mut row = 0;
        for pose in &forward.statics {
            let torques = pose.torques_nm(&forward.layout, &self.fit.point.coefficients);
            let loads = torques.len() - 1;
            for load in 0..loads {
                let state = |load: usize| State {
                    torque_nm: torques[load][joint],
                    angle_deg: angle_deg(&self.campaign.statics[row].pose_deg),
                    part: part(row, self.campaign.statics.len()),
                    channel: Channel::Static,
                    is_reference: load == 0,
                };
                let twist = shape(&state(load + 1)).0 - shape(&state(0)).0;
                for (c, datum) in pose.measured(load) {
                    truth[datum] = 1e3 * pose.geometry.joints[joint].tip[c] * compliance * twist;
                }
                row += 1;
            }
        }
        let slot = &forward.layout.joints[joint];
        self.add_modal(&mut truth, |_, datum, y| {
            let row = datum - forward.starts[1];
            let state = State {
                torque_nm: self.torques_nm[datum][joint],
                angle_deg: angle_deg(&self.campaign.modal[row].pose_deg),
                part: part(row, self.campaign.modal.len()),
                channel: Channel::Modal,
                is_reference: false,
            };
            y[slot.twist].powi(2) * compliance * shape(&state).1
        });
        for (row, datum) in self.campaign.windup.iter().zip(forward.range(Channel::Windup)) {
            if row.joint == slot.name {
                let state = State {
                    torque_nm: row.torque_nm,
                    angle_deg: 0.0,
                    part: 0.0,
                    channel: Channel::Windup,
                    is_reference: false,
                };
                truth[datum] = ARCMIN_PER_RAD * compliance * shape(&state).0;
            }
        }
        self.read(&truth)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::about_the_nominal_arm;
    use crate::reconcile::model::calibration::Calibration;

    #[test]
    fn a_further_twist_in_proportion_to_the_torque_is_a_softer_joint() {
        about_the_nominal_arm(|builder, nuisance| {
            let (forward, fit) = (builder.forward, builder.fit);
            let mut moving = 0;
            for (joint, slot) in forward.layout.joints.iter().enumerate() {
                let law = &fit.point.coefficients.laws[joint];
                let compliance = law.tangent_compliance_rad_per_nm(0.0);
                let column = builder.joint_column(joint, compliance, &|s| (s.torque_nm, 1.0));
                let is_own = |c: &Calibration| *c == Calibration::Stiffness(slot.name.clone());
                let p = nuisance.numbers.iter().position(|(c, _)| is_own(c)).expect("calibrated");
                let largest = fit.jacobian.column(p).amax();
                if largest < 1e-9 {
                    continue; // the axis goes through the tip and the payload, so nothing changes
                }
                moving += 1;
                for (i, own) in column.iter().enumerate() {
                    let softer = -fit.jacobian[(i, p)] / nuisance.numbers[p].1;
                    let scale = largest / nuisance.numbers[p].1;
                    assert!(
                        (own - softer).abs() <= 1e-3 * scale,
                        "{} datum {i}: {own} and {softer}",
                        slot.name
                    );
                }
            }
            assert!(moving >= 5, "only {moving} joints move a reading");
        });
    }
}
