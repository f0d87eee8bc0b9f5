//! Uncertainty that small compliances outside the model add to the parameters in it.
//!
//! Every joint and bearing is slightly compliant. Compliances that are too small to be worth their price are not in the
//! model, and those in the model take over a part of their effect. The linearized model with all of them gives the size
//! of this part. Before the readings are used, the prior standard deviation of a compliance outside the model is that
//! of the smallest compliance in it. With the readings, the compliances outside the model have the most probable values
//! `m` and the covariance matrix `P`. A number of the model with the variance `σ²` changes by `-L` per unit of these
//! compliances. Its variance then becomes `σ² + L P Lᵀ + (L m)²`.

use super::analysis::Positions;
use super::fitted::Sample;
use super::loads::CompliantPlace;
use super::normal::Factor;
use super::rows::normal;
use super::shape::Shape;
use crate::arm::BASE;
use crate::arm::effect::kind::ElasticRotation;
use crate::arm::structure::Piece;
use nalgebra::{Cholesky, DMatrix, DVector};

impl Positions {
    /// Widens the standard deviations of the model's numbers by the uncertainty that comes from compliances outside
    /// the model.
    pub(super) fn widen(&mut self) {
        let unnamed = self.unnamed_springs();
        let Some(usual) = self.stiffest_named().filter(|_| !unnamed.is_empty()) else { return };
        let Some(further) = self.further_variances(&unnamed, usual) else { return };
        let compliances = self.fitted.deviations.iter_mut().flatten();
        let own = self.fitted.number_deviations.iter_mut().chain(compliances);
        own.zip(&further).for_each(|(own, more)| *own = (own.powi(2) + more).sqrt());
    }

    /// Indices of the candidates with a single compliance that are neither in the model nor contained in a frame of
    /// the model.
    fn unnamed_springs(&self) -> Vec<usize> {
        // tilt of the base and tilt of a first joint have the same effect
        let place = |c: &CompliantPlace| match (c.rotation, self.tree.pieces.first()) {
            (ElasticRotation::Tilt, Some(Piece::Joint(first))) if c.at == first.name => BASE.to_string(),
            _ => c.at.clone(),
        };
        let is_named = |c: usize| {
            let candidate = &self.candidates[c];
            self.fitted.effects.iter().any(|&e| {
                let named = &self.candidates[e];
                (named.rotation, place(named)) == (candidate.rotation, place(candidate))
                    || self.tree.contains(named, candidate)
            })
        };
        let is_spring = |c: &usize| {
            let candidate = &self.candidates[*c];
            self.considered[*c]
                && candidate.shape == Shape::Spring
                && candidate.rotation != ElasticRotation::Frame
        };
        (0..self.candidates.len()).filter(is_spring).filter(|c| !is_named(*c)).collect()
    }

    /// The smallest compliance \[rad/(N m)\] among those effects of the model that are springs with a single
    /// compliance; `None` if there are none.
    fn stiffest_named(&self) -> Option<f64> {
        let named = self.fitted.effects.iter().zip(&self.fitted.compliances);
        let springs = named.filter(|(e, own)| self.candidates[**e].shape == Shape::Spring && own.len() == 1);
        springs.map(|(_, own)| own[0]).filter(|c| *c > 0.0).reduce(f64::min)
    }

    /// Variance that the compliances outside the model add to every number of the model, those of the geometry first.
    /// `unnamed` are the indices of the candidates outside the model, and `usual` is the prior standard deviation of
    /// their compliances \[rad/(N m)\]. `None` if the equations are singular.
    fn further_variances(&self, unnamed: &[usize], usual: f64) -> Option<Vec<f64>> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let from_level = self.fitted.geometry.level_to_instrument();
        let gravity = &self.fitted.geometry.gravity;
        let equations = normal(&all, &self.numbers, &self.fitted, &|sample, _, columns| {
            for &candidate in unnamed {
                sample.deflection.per_compliance(candidate, gravity, |by| columns.push(from_level * by));
            }
        });
        let (own, count) = (equations.own, unnamed.len());
        let factor = Factor::new(&equations.curvature, &(0..own).collect::<Vec<_>>())?;
        let cross = equations.curvature.view((0, own), (own, count)).into_owned();
        let columns: Vec<DVector<f64>> =
            (0..count).map(|k| factor.solve(&cross.column(k).into_owned())).collect();
        let moves = DMatrix::from_columns(&columns);
        let whole = equations.curvature.view((own, own), (count, count));
        // in units of `usual`; the errors of the readings are scaled as in the robust fit
        let per = (usual / self.fitted.robust_factor).powi(2);
        let seen = (whole - cross.transpose() * &moves) * per + DMatrix::identity(count, count);
        let pull = equations.gradient.rows(own, count) - moves.transpose() * equations.gradient.rows(0, own);
        let seen = Cholesky::new(seen)?;
        // no compliance is negative
        let likely = seen.solve(&(pull * (per / usual))).map(|c| c.max(0.0) * usual);
        let variance = |row: usize| {
            let row = moves.row(row).transpose();
            row.dot(&seen.solve(&row)) * usual.powi(2) + row.dot(&likely).powi(2)
        };
        Some((0..own).map(variance).collect())
    }
}
