//! Laws of a base, of bearings and of links whose stiffness changes with the size of their load: feet in rolling contact,
//! a flange that opens, a bearing that loses its preload.
//!
//! The size of the load on a part with the compliances `c` and the generalized forces `g` is `s = √(Σ c g²)`, the root of
//! twice its strain energy. The law adds the strains `c g s/s_max`, with the largest size `s_max` of the campaign. Small
//! oscillations about the static load then meet the further compliance `(c + c g gᵀ c/s²) s/s_max`.

use super::{Builder, Law};
use crate::reconcile::forward::modal::ModalTest;

impl Builder<'_> {
    /// For each part with a linear compliance, the law that its compliance grows with the size of its load. A part that
    /// the nominal arm has as rigid may also have a compliance without load.
    pub(super) fn size_laws(&self) -> Vec<Law> {
        let mut out = Vec::new();
        for (at, name, coordinates) in self.linear_parts() {
            let Some(column) = self.size_column(&coordinates) else { continue };
            let what = format!("a stiffness of {name} that changes with the size of its load");
            let law = |columns| Law { at: Some(at.clone()), ..Law::new(what.clone(), columns) };
            let is_rigid = coordinates.iter().all(|(i, _)| self.fit.point.coefficients.linear[*i] == 0.0);
            if is_rigid {
                out.push(law(vec![self.compliance_column(&coordinates), column.clone()]));
            }
            out.push(law(vec![column]));
        }
        out
    }

    /// The change of every reading, in its unit, by the further strains of a part with these strain coordinates and
    /// compliances; `None` if nothing loads it.
    fn size_column(&self, coordinates: &[(usize, f64)]) -> Option<Vec<f64>> {
        let (forward, own) = (self.forward, &self.fit.point.coefficients);
        let size = |forces: &[f64]| -> f64 {
            let energy = coordinates.iter().zip(forces).map(|((_, c), g)| c * g * g);
            energy.sum::<f64>().sqrt()
        };
        let mut largest = 0.0f64;
        let mut truth = vec![0.0; forward.data.len()];
        for pose in &forward.statics {
            let movers: Vec<_> = coordinates
                .iter()
                .map(|(index, _)| pose.geometry.linear.iter().find(|mover| mover.index == *index))
                .collect();
            let dead: Vec<f64> = coordinates.iter().map(|(i, _)| pose.geometry.dead_forces[*i]).collect();
            let before = size(&dead);
            for (load, wrench) in pose.wrenches(&forward.layout, own).iter().enumerate() {
                let forces: Vec<f64> =
                    coordinates.iter().map(|(i, _)| pose.geometry.force_on(*i, wrench)).collect();
                let after = size(&forces);
                largest = largest.max(after);
                for (component, datum) in pose.measured(load) {
                    let strains = coordinates.iter().zip(&movers).zip(forces.iter().zip(&dead));
                    truth[datum] = strains
                        .filter_map(|(((_, c), mover), (force, dead))| {
                            Some(1e3 * (*mover)?.tip[component] * c * (force * after - dead * before))
                        })
                        .sum();
                }
            }
        }
        let forces_in_modal_tests = self.forces_in_modal_tests(coordinates);
        self.add_modal(&mut truth, |test, _, y| {
            let forces = &forces_in_modal_tests[test];
            let size = size(forces);
            let (mut along, mut all) = (0.0, 0.0);
            for ((index, c), force) in coordinates.iter().zip(forces) {
                along += c * force * y[*index];
                all += c * y[*index] * y[*index];
            }
            if size > 0.0 { size * all + along * along / size } else { 0.0 }
        });
        let largest = forces_in_modal_tests.iter().map(|forces| size(forces)).fold(largest, f64::max);
        if largest == 0.0 {
            return None;
        }
        truth.iter_mut().for_each(|change| *change /= largest);
        Some(self.read(&truth))
    }

    /// For each modal test, the static forces on these strain coordinates.
    fn forces_in_modal_tests(&self, coordinates: &[(usize, f64)]) -> Vec<Vec<f64>> {
        let (forward, own) = (self.forward, &self.fit.point.coefficients);
        let of_test = |test: &ModalTest| {
            let wrench = test.wrench(&forward.layout, own);
            coordinates.iter().map(|(index, _)| test.geometry.force_on(*index, &wrench)).collect()
        };
        forward.modal.iter().map(of_test).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::about_the_nominal_arm;
    use crate::arm::effect::channel::Channel;
    use crate::reconcile::forward::modal::ModalTest;

    #[test]
    fn a_part_whose_compliance_grows_with_its_moment_meets_oscillations_with_twice_the_further_compliance() {
        about_the_nominal_arm(|builder, _| {
            let forward = builder.forward;
            let own = &builder.fit.point.coefficients;
            let moments_about = |index: usize| -> Vec<f64> {
                let of_test = |test: &ModalTest| {
                    let mover = test.geometry.linear.iter().find(|mover| mover.index == index);
                    let further = mover.map_or(0.0, |m| m.twist.dot(&test.wrench(&forward.layout, own)));
                    (test.geometry.dead_forces[index] + further).abs()
                };
                forward.modal.iter().map(of_test).collect()
            };
            // the tilt of a bearing that has the largest moment in the modal tests
            let tilts = forward.layout.joints.iter().flat_map(|joint| [joint.twist - 2, joint.twist - 1]);
            let largest_about = |index: usize| moments_about(index).into_iter().fold(0.0, f64::max);
            let index = tilts.max_by(|a, b| largest_about(*a).total_cmp(&largest_about(*b))).expect("joints");
            let moments_nm = moments_about(index);
            let compliance = 1e-7;
            let coordinates = [(index, compliance)];
            let column = builder.size_column(&coordinates).expect("loaded");
            let constant = builder.compliance_column(&coordinates);
            let ratio = |datum: usize| column[datum] / constant[datum];
            let is_moved = |datum: usize| constant[datum].abs() > 1e-9;
            let mut loaded = forward.modal.iter().zip(&moments_nm).filter(|(_, nm)| **nm > 1.0);
            let per_nm = loaded
                .find_map(|(test, nm)| {
                    test.modes.iter().find(|(datum, _)| is_moved(*datum)).map(|(d, _)| ratio(*d) / nm)
                })
                .expect("a mode that the tilt moves");
            assert!(per_nm > 0.0);
            for (test, moment_nm) in forward.modal.iter().zip(&moments_nm) {
                for (datum, _) in test.modes.iter().filter(|(datum, _)| is_moved(*datum)) {
                    let right = per_nm * moment_nm;
                    assert!((ratio(*datum) - right).abs() < 1e-9 * (1.0 + right), "datum {datum}");
                }
            }
            // a displacement is that of the moment times its size, which is half of what oscillations meet
            let largest = 2.0 / per_nm;
            let mut seen = 0;
            for pose in &forward.statics {
                let Some(mover) = pose.geometry.linear.iter().find(|mover| mover.index == index) else {
                    continue;
                };
                let before_nm = pose.geometry.dead_forces[index];
                for (load, wrench) in pose.wrenches(&forward.layout, own).iter().enumerate() {
                    let after_nm = before_nm + mover.twist.dot(wrench);
                    for (component, datum) in pose.measured(load) {
                        let turned_rad =
                            compliance * (after_nm * after_nm.abs() - before_nm * before_nm.abs()) / largest;
                        let right = 1e3 * mover.tip[component] * turned_rad;
                        assert!((column[datum] - right).abs() < 1e-9, "{} and {right}", column[datum]);
                        seen += usize::from(right.abs() > 1e-6);
                    }
                }
            }
            assert!(seen > 50 && forward.data[0].channel == Channel::Static, "{seen}");
        });
    }
}
