//! Laws of joint angles whose zero is off: every pose of the campaign is another one than stated.

use super::{Builder, Law};
use crate::reconcile::forward::prepared::Forward;

/// Half of the difference in angle over which the readings are compared \[deg\].
const STEP_DEG: f64 = 0.1;
/// The angle that counts as the full size of the law \[deg\].
const FULL_SIZE_DEG: f64 = 30.0;

impl Builder<'_> {
    /// For each driven joint, the law that its angle is another than stated, by the same amount in every pose.
    pub(super) fn zero_laws(&self) -> Vec<Law> {
        let names = self.campaign.arm.driven_joint_names();
        let law = |(index, name): (usize, &&str)| Law {
            what: format!("an angle of {name} whose zero is off"),
            effect: None,
            columns: vec![self.zero_column(index)],
        };
        names.iter().enumerate().map(law).collect()
    }

    /// The change of every reading, in its unit, by an angle of the driven joint number `index` that is off in every pose,
    /// per full size.
    fn zero_column(&self, index: usize) -> Vec<f64> {
        let [more, less] = [STEP_DEG, -STEP_DEG].map(|off_deg| self.readings_turned_by(index, off_deg));
        let per_step = FULL_SIZE_DEG / (2.0 * STEP_DEG);
        more.iter().zip(&less).map(|(more, less)| per_step * (more - less)).collect()
    }

    /// The predicted readings if the angle of the driven joint number `index` is larger by `off_deg` in every pose.
    fn readings_turned_by(&self, index: usize, off_deg: f64) -> Vec<f64> {
        let mut campaign = self.campaign.clone();
        campaign.statics.iter_mut().for_each(|row| row.pose_deg[index] += off_deg);
        campaign.modal.iter_mut().for_each(|row| row.pose_deg[index] += off_deg);
        let coefficients = &self.fit.point.coefficients;
        let mut forward = Forward::new(&campaign);
        for (turned, stated) in forward.modal.iter_mut().zip(&self.forward.modal) {
            turned.modes.clone_from(&stated.modes);
        }
        forward.refresh(coefficients);
        forward.predict(coefficients)
    }
}
