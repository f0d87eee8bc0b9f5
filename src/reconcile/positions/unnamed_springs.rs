//! Uncertainty that small compliances outside the model add to the parameters in it.
//!
//! Every joint and bearing is slightly compliant. Compliances that are too small to be worth their price are not in the
//! model, and a part of their effect is ascribed to those in the model. The [`Posterior`] of the model takes this into
//! account.

use super::analysis::Positions;
use super::fitted::Sample;
use super::geometry_slopes::{GeometrySlopes, completed};
use super::kinematics::Geometry;
use super::loads::CompliantPlace;
use super::posterior::Posterior;
use super::rows::normal;
use super::shape::Shape;
use super::springs::best_springs;
use crate::arm::BASE;
use crate::arm::effect::kind::ElasticRotation;
use crate::arm::structure::Piece;
use crate::reconcile::readings::campaign::Campaign;
use std::sync::Arc;

impl Positions {
    /// Computes the posterior distribution of the numbers of the model, with compliances outside it. The standard
    /// deviation of each number becomes half the width of its 95 % interval, divided by the normal quantile 1.96.
    pub(super) fn widen(&mut self, campaign: &Campaign) {
        if self.fitted.effects.is_empty() {
            return;
        }
        let Some(posterior) = self.posterior_of(campaign) else {
            return;
        };
        let own = self.fitted.number_deviations.iter_mut().chain(self.fitted.deviations.iter_mut().flatten());
        own.enumerate().for_each(|(number, own)| {
            let [below, above] = posterior.reach(&[(number, 1.0)]);
            *own = 0.5 * (below + above);
        });
        self.posterior = Some(Arc::new(posterior));
    }

    /// Distances of the lower and the upper end of the 95 % interval of a quantity from its fitted value, each divided
    /// by the normal quantile 1.96. The quantity has the derivatives `gradient` with respect to numbers of the model:
    /// those of the geometry first, then the compliances. Without a posterior distribution, the numbers are taken as
    /// independent.
    pub(super) fn reach(&self, gradient: &[(usize, f64)]) -> [f64; 2] {
        if let Some(posterior) = &self.posterior {
            return posterior.reach(gradient);
        }
        let all = self.fitted.number_deviations.iter().chain(self.fitted.deviations.iter().flatten());
        let deviations: Vec<f64> = all.copied().collect();
        let squares = gradient.iter().map(|(number, g)| (g * deviations[*number]).powi(2));
        [squares.sum::<f64>().sqrt(); 2]
    }

    /// The distances of [`reach`](Self::reach) for each compliance of effect number `position` of the model.
    pub(super) fn reaches(&self, position: usize) -> Vec<[f64; 2]> {
        let first = self.first_compliance(position);
        let own = first..first + self.fitted.compliances[position].len();
        own.map(|number| self.reach(&[(number, 1.0)])).collect()
    }

    /// Index among all numbers of the model of the first compliance of effect number `position`.
    pub(super) fn first_compliance(&self, position: usize) -> usize {
        self.numbers.len() + self.fitted.compliances[..position].iter().map(Vec::len).sum::<usize>()
    }

    /// The posterior distribution of the numbers of the model; `None` if the equations are singular.
    fn posterior_of(&self, campaign: &Campaign) -> Option<Posterior> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let (unnamed, named) = (self.unnamed_springs(), self.named_springs());
        let from_level = self.fitted.geometry.level_to_instrument();
        let gravity = &self.fitted.geometry.gravity;
        let arms = |geometry: &Geometry| self.deflecting_arms(campaign, geometry);
        let slopes = GeometrySlopes::new(&campaign.positions, &self.numbers, &self.fitted, arms);
        let parts = normal(&all, &self.numbers, &self.fitted, &|sample, _, columns| {
            for &candidate in &unnamed {
                sample.deflection.per_compliance(candidate, gravity, |by| columns.push(from_level * by));
            }
            slopes.push(sample, columns);
        });
        let equations = completed(&parts, &slopes.incomplete());
        let best = best_springs(&equations, self.numbers.len(), &self.fitted.compliances)?;
        Some(Posterior::new(&equations, &best, self.fitted.robust_factor, &named))
    }

    /// Indices of the candidates with a single compliance that are neither in the model nor contained in a frame of the
    /// model. Of two candidates with the same effect on the positions, only the first is listed.
    fn unnamed_springs(&self) -> Vec<usize> {
        let is_spring = |c: &usize| {
            let candidate = &self.candidates[*c];
            self.considered[*c]
                && candidate.shape == Shape::Spring
                && candidate.rotation != ElasticRotation::Frame
        };
        let mut out: Vec<usize> = Vec::new();
        for c in (0..self.candidates.len()).filter(is_spring) {
            let is_known = |other: &usize| self.is_same_spring(*other, c);
            let is_contained = |e: &usize| self.tree.contains(&self.candidates[*e], &self.candidates[c]);
            let mut named = self.fitted.effects.iter();
            if !out.iter().any(is_known) && !named.any(|e| is_known(e) || is_contained(e)) {
                out.push(c);
            }
        }
        out
    }

    /// Whether two candidates rotate in the same way at the same place. The tilt of the base and the tilt of a first joint
    /// have the same effect.
    fn is_same_spring(&self, a: usize, b: usize) -> bool {
        let place = |c: &CompliantPlace| match (c.rotation, self.tree.pieces.first()) {
            (ElasticRotation::Tilt, Some(Piece::Joint(first))) if c.at == first.name => BASE.to_string(),
            _ => c.at.clone(),
        };
        let [a, b] = [a, b].map(|c| &self.candidates[c]);
        a.rotation == b.rotation && place(a) == place(b)
    }

    /// The compliances \[rad/(N m)\] of those effects of the model that are springs with a single compliance, each with the
    /// index of its number.
    fn named_springs(&self) -> Vec<(usize, f64)> {
        let is_spring = |i: &usize| {
            let compliances = &self.fitted.compliances[*i];
            self.candidates[self.fitted.effects[*i]].shape == Shape::Spring
                && compliances.len() == 1
                && compliances[0] > 0.0
        };
        let springs = (0..self.fitted.effects.len()).filter(is_spring);
        springs.map(|i| (self.first_compliance(i), self.fitted.compliances[i][0])).collect()
    }
}
