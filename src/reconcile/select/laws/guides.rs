//! Laws of prismatic joints whose guide or drive is more compliant in one part of the travel than in another.

use super::{Builder, Law, one_or_both, placed};
use crate::reconcile::forward::coefficients::GUIDE_ROTATIONS;

impl Builder<'_> {
    /// For each prismatic joint, the laws that the compliance of its guide, or the compliance of its drive, changes
    /// with the position. Examples are a rail that is badly screwed down at one place, and a screw that is longer the
    /// farther the nut travels.
    pub(super) fn guide_laws(&self) -> Vec<Law> {
        let layout = &self.forward.layout;
        let joints = layout.slides.iter().zip(self.forward.nominal.structure.prismatics());
        let laws = joints.flat_map(|(first, joint)| {
            let of = |part: &str, own: std::ops::Range<usize>| {
                let column = |power| self.travel_column(&joint.name, own.clone(), power);
                let what = format!("a {part} of {} whose stiffness changes with its position", joint.name);
                placed(&joint.name, one_or_both(&what, [column(1), column(2)]))
            };
            let travel = first + GUIDE_ROTATIONS;
            of("guide", *first..travel).into_iter().chain(of("drive", travel..travel + 1))
        });
        laws.collect()
    }

    /// The change of every reading, in its unit, if the compliances of the strain coordinates `own` of the prismatic
    /// joint `name` grow by the fraction `(q/q_max)^power`, with the joint's position `q` and the largest position
    /// `q_max` of the campaign.
    fn travel_column(&self, name: &str, own: std::ops::Range<usize>, power: i32) -> Vec<f64> {
        let forward = self.forward;
        let driven = self.campaign.arm.driven_joint_names();
        let mut truth = vec![0.0; forward.data.len()];
        let Some(index) = driven.iter().position(|driven| *driven == name) else { return truth };
        let statics = self.campaign.statics.iter().map(|row| row.pose_deg[index]);
        let modal: Vec<f64> = self.campaign.modal.iter().map(|row| row.pose_deg[index]).collect();
        let largest = statics.chain(modal.iter().copied()).fold(0.0, |m: f64, q| m.max(q.abs()));
        if largest == 0.0 {
            return truth;
        }
        let compliance = |i: usize| self.fit.point.coefficients.linear[i];
        let mut row = 0;
        for pose in &forward.statics {
            let part = (self.campaign.statics[row].pose_deg[index] / largest).powi(power);
            let further: Vec<(usize, f64)> = own.clone().map(|i| (i, part * compliance(i))).collect();
            pose.add_compliant(&forward.layout, &self.fit.point.coefficients, &further, &mut truth);
            row += pose.count();
        }
        self.add_modal(&mut truth, |_, datum, y| {
            let part = (modal[datum - forward.starts[1]] / largest).powi(power);
            own.clone().map(|i| y[i].powi(2) * part * compliance(i)).sum()
        });
        self.read(&truth)
    }
}
