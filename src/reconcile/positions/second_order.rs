//! The error of the linear displacement, which comes from the change of the loads' levers as the arm deflects.
//!
//! Compliances are fitted with a displacement that is linear in them. For an arm that deflects by 5 mm at a reach of 1
//! m, the linear displacement is wrong by 0.03 mm. That is more than the error of a laser tracker. The error changes
//! with the angles of the joints, as the effect of a transmission error does. So the true displacement of the fitted
//! arm is computed too. Its difference from the linear displacement is small and hardly changes with the compliances.
//! So it is kept constant while the compliances are fitted, and is computed again after the fit.

use super::analysis::Positions;
use super::kinematics::Geometry;
use super::loads::{CompliantPlace, Loads};
use super::shape::Shape;
use super::springs::frame_matrix;
use super::waves::as_parameters;
use crate::arm::effect::entry::Effect;
use crate::arm::effect::kind::ElasticRotation;
use crate::arm::effect::subject::Subject;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::Vector3;
use rayon::prelude::*;

impl Positions {
    /// Computes for each sample the difference between the true and the linear displacement, with the effects of the
    /// present fit.
    pub(super) fn hang(&mut self, campaign: &Campaign) {
        let loads = self.deflecting_arms(campaign, &self.fitted.geometry);
        let differences = campaign.positions.par_iter().zip(&self.samples);
        let differences: Vec<Vector3<f64>> =
            differences.map(|(row, sample)| loads.second_order_m(row, sample.point)).collect();
        drop(loads);
        self.samples.iter_mut().zip(differences).for_each(|(sample, by)| sample.second_order_m = by);
    }

    /// The arms with the geometry `geometry`, and with all effects and dependences of the present fit as part of the
    /// arms.
    pub(super) fn deflecting_arms(&self, campaign: &Campaign, geometry: &Geometry) -> Loads<'_> {
        let fitted = &self.fitted;
        let named = fitted.effects.iter().zip(&fitted.compliances);
        let as_effect = |(&c, own): (&usize, &Vec<f64>)| {
            let candidate = &self.candidates[c];
            candidate.as_effect(own, self.mean_rad_per_nm(fitted, &candidate.at).unwrap_or_default())
        };
        let effects: Vec<Effect> = named.filter_map(as_effect).collect();
        let change = |subject: &mut Subject| {
            let dependent = self.dependences.iter().zip(&fitted.geometry.dependences);
            dependent.for_each(|(dependence, x)| dependence.change(*x, subject));
            effects.iter().for_each(|effect| subject.apply(effect));
        };
        Loads::changed(campaign, &self.tree, geometry, &[], &change)
    }
}

impl CompliantPlace {
    /// The candidate as an effect of an arm, with the compliances `compliances` \[rad/(N m)\], or the half width of its
    /// play \[rad\]. `mean` is the compliance of the candidate's joint, averaged over all angles \[rad/(N m)\]. `None`
    /// if the candidate does not deflect.
    fn as_effect(&self, compliances: &[f64], mean: f64) -> Option<Effect> {
        let first = *compliances.first()?;
        let list = |name: &str, values: Vec<f64>| (name.to_string(), values);
        let parameters = match (self.shape, self.rotation) {
            (Shape::Play(torque_nm), _) => {
                vec![list("half_width_rad", vec![first]), list("torque_nm", vec![torque_nm])]
            }
            (Shape::Lift(preload_nm), _) if first > 0.0 => {
                vec![list("stiffness_nm_per_rad", vec![1.0 / first]), list("preload_nm", vec![preload_nm])]
            }
            (Shape::Waves(waves), _) if mean > 0.0 && compliances.iter().any(|c| *c != 0.0) => {
                as_parameters(waves, compliances, mean)
            }
            (Shape::Spring, ElasticRotation::Frame) => {
                let matrix = frame_matrix(compliances);
                let entries = |of: [(usize, usize); 3]| of.map(|at| matrix[at]).to_vec();
                vec![
                    list("diagonal_rad_per_nm", entries([(0, 0), (1, 1), (2, 2)])),
                    list("coupling_rad_per_nm", entries([(0, 1), (0, 2), (1, 2)])),
                ]
            }
            (Shape::Spring, _) if first > 0.0 => vec![list("stiffness_nm_per_rad", vec![1.0 / first])],
            _ => return None,
        };
        Some(Effect { effect: self.effect.into(), at: self.at.clone(), parameters, source: None })
    }
}
