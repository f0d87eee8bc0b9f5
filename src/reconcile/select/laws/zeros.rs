//! Laws of joint angles whose zero is off, so that every pose differs from the stated one.

use super::{Builder, FULL_ANGLE_DEG, Law};
use rayon::prelude::*;

/// Change of an angle over which the readings are compared \[deg\].
const STEP_DEG: f64 = 0.1;

impl Builder<'_> {
    /// For each driven joint, the law that its angle is another than stated, by the same amount in every pose.
    pub(super) fn zero_laws(&self) -> Vec<Law> {
        let names = self.campaign.arm.driven_joint_names();
        let columns = self.forward.zero_columns.get_or_init(|| self.zero_columns(names.len()));
        let law = |(name, column): (&&str, &Vec<f64>)| Law {
            what: format!("an angle of {name} whose zero is off"),
            effect: None,
            columns: vec![column.clone()],
        };
        names.iter().zip(columns).map(law).collect()
    }

    /// For each of the first `joints` driven joints, the change of every reading of the nominal arm, in its unit, if
    /// the zero of its angle is off by the full size ([`FULL_ANGLE_DEG`]). All poses have to be prepared anew for this.
    /// It is therefore computed once about the nominal arm, and not for every fit.
    fn zero_columns(&self, joints: usize) -> Vec<Vec<f64>> {
        let stated = self.nominal_readings(self.campaign);
        let per_step = FULL_ANGLE_DEG / STEP_DEG;
        let column = |index: usize| {
            let turned = self.readings_turned_by(index, STEP_DEG);
            turned.iter().zip(&stated).map(|(turned, stated)| per_step * (turned - stated)).collect()
        };
        (0..joints).into_par_iter().map(column).collect()
    }

    /// The predicted readings if the angle of the driven joint number `index` is larger by `off_deg` in every pose.
    fn readings_turned_by(&self, index: usize, off_deg: f64) -> Vec<f64> {
        let mut campaign = self.campaign.clone();
        campaign.statics.iter_mut().for_each(|row| row.pose_deg[index] += off_deg);
        campaign.modal.iter_mut().for_each(|row| row.pose_deg[index] += off_deg);
        self.nominal_readings(&campaign)
    }
}
