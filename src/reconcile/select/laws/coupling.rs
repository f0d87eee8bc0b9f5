//! Laws of joints that twist under the torque of their neighbour, through a common housing, a cable or a belt.

use super::{Builder, Law};

impl Builder<'_> {
    /// For each joint and each of its neighbours, the law that the joint twists in proportion to the neighbour's
    /// torque.
    pub(super) fn coupling_laws(&self) -> Vec<Law> {
        let joints = &self.forward.layout.joints;
        let pairs = (1..joints.len()).flat_map(|j| [(j - 1, j), (j, j - 1)]);
        let law = |(twisted, loaded): (usize, usize)| {
            let laws = &self.fit.point.coefficients.laws;
            let compliance = [twisted, loaded].map(|j| laws[j].tangent_compliance_rad_per_nm(0.0));
            let compliance = compliance.into_iter().fold(0.0, f64::max);
            let what =
                format!("a twist of {} under the torque of {}", joints[twisted].name, joints[loaded].name);
            Law::new(what, vec![self.coupling_column(twisted, loaded, compliance)])
        };
        pairs.map(law).collect()
    }

    /// The change of every reading, in its unit, if the joint with index `twisted` also twists by `compliance` \[rad/(N
    /// m)\] times the torque of the joint with index `loaded`. Bench readings do not change, because a bench loads one
    /// joint alone.
    fn coupling_column(&self, twisted: usize, loaded: usize, compliance: f64) -> Vec<f64> {
        let forward = self.forward;
        let mut truth = vec![0.0; forward.data.len()];
        for pose in &forward.statics {
            let torques_nm = pose.torques_nm(&forward.layout, &self.fit.point.coefficients);
            for load in 0..torques_nm.len() - 1 {
                let twist_rad = compliance * (torques_nm[load + 1][loaded] - torques_nm[0][loaded]);
                for (c, datum) in pose.measured(load) {
                    truth[datum] = 1e3 * pose.geometry.joints[twisted].tip[c] * twist_rad;
                }
            }
        }
        let [own, other] = [twisted, loaded].map(|j| forward.layout.joints[j].twist);
        self.add_modal(&mut truth, |_, _, y| y[own] * y[other] * compliance);
        self.read(&truth)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::about_the_nominal_arm;
    use crate::reconcile::model::calibration::Calibration;

    #[test]
    fn a_joint_that_its_own_torque_twists_is_softer_and_neighbours_have_two_laws() {
        about_the_nominal_arm(|builder, nuisance| {
            let (forward, fit) = (builder.forward, builder.fit);
            let joints = &forward.layout.joints;
            assert_eq!(builder.coupling_laws().len(), 2 * (joints.len() - 1));
            let compliance = fit.point.coefficients.laws[1].tangent_compliance_rad_per_nm(0.0);
            let column = builder.coupling_column(1, 1, compliance);
            let is_own = |c: &Calibration| *c == Calibration::Stiffness(joints[1].name.clone());
            let p = nuisance.numbers.iter().position(|(c, _)| is_own(c)).expect("calibrated");
            let sd = nuisance.numbers[p].1;
            let largest = fit.jacobian.column(p).amax() / sd;
            // a bench loads the joint itself, which is no coupling
            for (i, own) in column.iter().enumerate().take(forward.starts[2]) {
                let softer = -fit.jacobian[(i, p)] / sd;
                assert!((own - softer).abs() <= 1e-3 * largest, "datum {i}: {own} and {softer}");
            }
        });
    }
}
