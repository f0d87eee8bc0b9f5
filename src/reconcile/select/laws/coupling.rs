//! Laws of joints that twist under the torque of their neighbour, through a common housing, a cable or a belt.

use super::{Builder, Law};

impl Builder<'_> {
    /// For each joint and each neighbour of it, the law that the joint twists in proportion to the neighbour's torque.
    pub(super) fn coupling_laws(&self) -> Vec<Law> {
        let joints = &self.forward.layout.joints;
        let pairs = (1..joints.len()).flat_map(|j| [(j - 1, j), (j, j - 1)]);
        let law = |(twisted, loaded): (usize, usize)| {
            let laws = &self.fit.point.coefficients.laws;
            let compliance = [twisted, loaded].map(|j| laws[j].tangent_compliance_rad_per_nm(0.0));
            let compliance = compliance.into_iter().fold(0.0, f64::max);
            Law {
                what: format!(
                    "a twist of {} under the torque of {}",
                    joints[twisted].name, joints[loaded].name
                ),
                effect: None,
                columns: vec![self.coupling_column(twisted, loaded, compliance)],
            }
        };
        pairs.map(law).collect()
    }

    /// The change of every reading, in its unit, if the joint with index `twisted` also twists by `compliance`
    /// \[rad/(N m)\] times the torque of the joint with index `loaded`. A bench loads one joint alone.
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
        self.add_modal(&mut truth, |_, y| y[own] * y[other] * compliance);
        self.read(&truth)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::about_the_nominal_arm;

    #[test]
    fn a_joint_that_its_own_torque_twists_is_softer_and_neighbours_have_two_laws() {
        about_the_nominal_arm(|builder, _| {
            let joints = builder.forward.layout.joints.len();
            assert_eq!(builder.coupling_laws().len(), 2 * (joints - 1));
            let twist = builder.forward.layout.joints[1].twist;
            let own = builder.coupling_column(1, 1, 1e-6);
            let softer = builder.compliance_column(&[(twist, 1e-6)]);
            let largest = softer.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let bench = builder.forward.starts[2];
            for (i, (own, softer)) in own.iter().zip(&softer).enumerate().take(bench) {
                assert!((own - softer).abs() < 1e-6 * largest, "datum {i}: {own} and {softer}");
            }
        });
    }
}
