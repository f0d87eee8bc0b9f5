//! Laws of joint angles whose zero is off, so that every pose differs from the stated one.

use super::{Builder, FULL_ANGLE_DEG, Law};

impl Builder<'_> {
    /// For each driven joint, the law that its angle differs from the stated one by the same amount in every pose.
    pub(super) fn zero_laws(&self) -> Vec<Law> {
        let names = self.campaign.arm.driven_joint_names();
        let slopes = self.forward.turn_slopes(self.campaign);
        let law = |(name, slope): (&&str, &Vec<f64>)| {
            let column = slope.iter().map(|slope| FULL_ANGLE_DEG * slope).collect();
            Law::new(format!("an angle of {name} whose zero is off"), vec![column])
        };
        names.iter().zip(slopes).map(law).collect()
    }
}
