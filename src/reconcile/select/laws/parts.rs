//! Laws of every compliant part of an arm that does not always have the same stiffness.
//!
//! A part is the base, the bearing or the torsion of a joint, or a link; all displacement readings together count as a
//! part too, whose stiffness is the gain of the instrument. Its compliance may depend on the occasion of a reading: on
//! the order of the tests, on the kind of tests, on how long a pose was kept, on whether the load was being taken off, on
//! the temperature and, if it is a joint, on its angle or that of a neighbour. Every part is combined with every
//! dependence, so that no effect of the library is named for lack of a competitor.

use super::super::waves::waves;
use super::occasions::Occasion;
use super::{Builder, Law, one_or_both};
use crate::arm::BASE;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::stiffness_waves;

/// Numbers of waves a turn of a stiffness that varies with the angle. Fewer waves are an effect of the library.
const FINE_WAVES: [f64; 3] = [3.0, 4.0, 5.0];

/// A part with a linear compliance: the name of its place, the part in words, and the index and the compliance of each
/// of its strain coordinates.
pub(super) type LinearPart = (String, String, Vec<(usize, f64)>);

/// A compliant part of the arm, or all displacement readings.
pub(super) struct Part {
    /// Name of the joint or link, of the base, or of the channel.
    pub(super) at: String,
    /// The part in words, such as "a stiffness of j2".
    stiffness: String,
    /// The change of every reading, in its unit, if the compliance of the part is twice as large.
    column: Vec<f64>,
    /// The joint whose torsion the part is.
    joint: Option<usize>,
    /// Whether the part belongs to the arm, and not to the instrument.
    is_of_arm: bool,
}

impl Builder<'_> {
    /// The compliant parts of the arm, and the displacement readings.
    pub(super) fn parts(&self) -> Vec<Part> {
        let own = &self.fit.point.coefficients;
        let layout = &self.forward.layout;
        let mut out = vec![self.readings_as_a_part()];
        for (joint, slot) in layout.joints.iter().enumerate() {
            let compliance = own.laws[joint].tangent_compliance_rad_per_nm(0.0);
            if compliance > 0.0 {
                let column = self.joint_column(joint, compliance, &|state| (state.torque_nm, 1.0));
                let (at, stiffness) = (slot.name.clone(), format!("a stiffness of {}", slot.name));
                out.push(Part { at, stiffness, column, joint: Some(joint), is_of_arm: true });
            }
        }
        let linear = self.linear_parts().into_iter().map(|(at, name, coordinates)| Part {
            at,
            stiffness: format!("a stiffness of {name}"),
            column: self.compliance_column(&coordinates),
            joint: None,
            is_of_arm: true,
        });
        out.extend(linear);
        out
    }

    /// The parts with a linear compliance: base, bearings and links. Each has the name of its place, is described in words,
    /// and has the index and compliance of each of its strain coordinates. A part that is rigid has the compliance of the
    /// first compliant joint.
    pub(super) fn linear_parts(&self) -> Vec<LinearPart> {
        let layout = &self.forward.layout;
        let own = &self.fit.point.coefficients;
        let Some(common) = self.first_compliance_rad_per_nm() else { return Vec::new() };
        let compliance = |i: usize| if own.linear[i] > 0.0 { own.linear[i] } else { common };
        let tilts = |first: usize| vec![(first, compliance(first)), (first + 1, compliance(first + 1))];
        let mut out = vec![(BASE.to_string(), "the base".to_string(), tilts(0))];
        let bearings = layout
            .joints
            .iter()
            .map(|j| (j.name.clone(), format!("the bearing of {}", j.name), tilts(j.twist - 2)));
        out.extend(bearings);
        let links = layout.links.iter().map(|link| {
            let strains = link.first..link.first + link.strains.len();
            (link.name.clone(), link.name.clone(), strains.map(|i| (i, own.linear[i])).collect())
        });
        out.extend(links);
        out
    }

    /// Compliance of the first joint that is compliant, a size of compliances for parts that are rigid \[rad/(N m)\].
    pub(super) fn first_compliance_rad_per_nm(&self) -> Option<f64> {
        let laws = self.fit.point.coefficients.laws.iter();
        laws.map(|law| law.tangent_compliance_rad_per_nm(0.0)).find(|compliance| *compliance > 0.0)
    }

    fn readings_as_a_part(&self) -> Part {
        let predicted = self.fit.point.predicted.iter().zip(&self.forward.data);
        let column = predicted.map(|(d, datum)| if datum.channel == Channel::Static { *d } else { 0.0 });
        Part {
            at: Channel::Static.word().into(),
            stiffness: "a gain of the static readings".into(),
            column: column.collect(),
            joint: None,
            is_of_arm: false,
        }
    }

    /// The laws that the stiffness of a part depends on the occasion of a reading.
    pub(super) fn occasion_laws(&self, part: &Part) -> Vec<Law> {
        let law = |what: &str, column| Law::new(format!("{} {what}", part.stiffness), vec![column]);
        let longest = self.occasions.iter().map(|o| o.rows_in_pose).max().unwrap_or(0).max(1) as f64;
        let kept = [
            self.only(part, Channel::Static, &|o| o.rows_in_pose as f64 / longest),
            self.only(part, Channel::Static, &|o| if o.rows_in_pose > 0 { 1.0 } else { 0.0 }),
        ];
        let mut out = one_or_both(&format!("{} that changes while a pose is kept", part.stiffness), kept);
        let unloading = self.times(part, &|_, o| if o.is_unloading { 1.0 } else { 0.0 });
        out.push(law("that is another while the load is taken off", unloading));
        let warmest = self.occasions.iter().filter_map(|o| o.warmer_k).fold(0.0, |m: f64, k| m.max(k.abs()));
        if warmest > 0.0 {
            let warmer = self.times(part, &|_, o| o.warmer_k.map_or(0.0, |k| k / warmest));
            out.push(law("that changes with the temperature", warmer));
        }
        // a joint has these laws already, and readings that are all larger have a gain
        if part.joint.is_none() {
            let ordered = self.only(part, Channel::Static, &|o| o.part);
            out.push(law("that changes with the order of the static tests", ordered));
        }
        if !part.is_of_arm || self.kinds_of_readings() == 1 {
            return out;
        }
        if part.joint.is_none() {
            out.push(law("that is another in the static tests", self.only(part, Channel::Static, &|_| 1.0)));
        }
        // with one of the two kinds of tests only, these laws are those of its own tests
        let has = |channel| !self.forward.range(channel).is_empty();
        if !has(Channel::Static) || !has(Channel::Modal) {
            return out;
        }
        let both = |channel: Channel, o: &Occasion| if channel == Channel::Windup { 0.0 } else { o.part };
        out.push(law("that changes with the order of the static and modal tests", self.times(part, &both)));
        let course = |channel: Channel, o: &Occasion| match channel {
            Channel::Static => o.part,
            Channel::Modal => 1.0,
            _ => 0.0,
        };
        out.push(law(
            "that changes from the first static test to the modal tests",
            self.times(part, &course),
        ));
        out
    }

    /// The change of every reading if the compliance of a part grows by the factor that `factor` gives for the channel and
    /// the occasion of the reading.
    fn times(&self, part: &Part, factor: &dyn Fn(Channel, &Occasion) -> f64) -> Vec<f64> {
        let data = self.forward.data.iter().zip(&self.occasions).zip(&part.column);
        data.map(|((datum, occasion), change)| change * factor(datum.channel, occasion)).collect()
    }

    /// The same as `times`, for a factor that the readings of one channel have.
    fn only(&self, part: &Part, own: Channel, factor: &dyn Fn(&Occasion) -> f64) -> Vec<f64> {
        self.times(part, &|channel, occasion| if channel == own { factor(occasion) } else { 0.0 })
    }

    /// The laws that the stiffness of a joint varies more than twice a turn, or with the angle of a neighbour.
    pub(super) fn angle_laws(&self, part: &Part) -> Vec<Law> {
        let Some(joint) = part.joint else { return Vec::new() };
        let driven = self.campaign.arm.driven_joint_names();
        let joints = &self.forward.layout.joints;
        let column = |index: usize, waves_a_turn: f64, sine: usize| -> Vec<f64> {
            let wave = |pose: &[f64]| waves(waves_a_turn * pose[index])[sine];
            let changes = part.column.iter().enumerate();
            changes.map(|(i, change)| change * self.pose_deg(i).map_or(0.0, wave)).collect()
        };
        let turned = |joint: usize, all_waves: &[f64], what: String| {
            let index = driven.iter().position(|name| *name == joints[joint].name)?;
            let columns = all_waves.iter().flat_map(|n| [column(index, *n, 0), column(index, *n, 1)]);
            let refines = Some(stiffness_waves::KIND.name);
            Some(Law { refines, ..Law::new(what, columns.collect()) })
        };
        let sets = FINE_WAVES.iter().map(std::slice::from_ref).chain([FINE_WAVES.as_slice()]);
        let what = format!("{} that changes several times a turn with its angle", part.stiffness);
        let fine = sets.filter_map(|set| turned(joint, set, what.clone()));
        let near = [joint.checked_sub(1), Some(joint + 1).filter(|next| *next < joints.len())];
        let neighbours = near.into_iter().flatten().filter_map(|next| {
            let what = format!("{} that changes with the angle of {}", part.stiffness, joints[next].name);
            turned(next, &[1.0], what)
        });
        fine.chain(neighbours).collect()
    }

    /// The pose of a reading \[deg; mm\]; `None` for a reading on a bench.
    fn pose_deg(&self, datum: usize) -> Option<&[f64]> {
        match self.forward.data[datum].channel {
            Channel::Static => Some(&self.campaign.statics[self.forward.data[datum].index].pose_deg),
            Channel::Modal => Some(&self.campaign.modal[datum - self.forward.starts[1]].pose_deg),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::about_the_nominal_arm;
    use crate::arm::effect::channel::Channel;

    #[test]
    fn a_part_that_gives_way_while_a_pose_is_kept_is_as_drawn_in_its_first_row() {
        about_the_nominal_arm(|builder, _| {
            let mut moved = 0;
            for part in builder.parts() {
                let laws = builder.occasion_laws(&part);
                let kept = laws.iter().filter(|law| law.what.ends_with("while a pose is kept"));
                for column in kept.flat_map(|law| &law.columns) {
                    for (i, change) in column.iter().enumerate() {
                        let is_later = builder.forward.data[i].channel == Channel::Static
                            && builder.occasions[i].rows_in_pose > 0;
                        assert!(is_later || *change == 0.0, "{}: datum {i}", part.stiffness);
                        moved += usize::from(*change != 0.0);
                    }
                }
            }
            assert!(moved > 100, "{moved}");
        });
    }

    #[test]
    fn static_tests_and_the_others_together_are_the_whole_part() {
        about_the_nominal_arm(|builder, _| {
            for part in builder.parts() {
                let channels = [Channel::Static, Channel::Modal, Channel::Windup];
                let columns = channels.map(|channel| builder.only(&part, channel, &|_| 1.0));
                for (i, change) in part.column.iter().enumerate() {
                    let sum: f64 = columns.iter().map(|column| column[i]).sum();
                    assert_eq!(sum, *change, "{}: datum {i}", part.stiffness);
                }
            }
        });
    }
}
