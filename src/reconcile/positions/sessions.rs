//! A point that sat elsewhere on the tool, or an instrument that stood elsewhere, until some row of the
//! file.
//!
//! Between two sessions a reflector is put back a little differently, or the instrument is moved. Every
//! row is tried as the first of a new session, by the gain of the model made linear; the point of the
//! earlier rows then has an offset of its own.

use super::Positions;
use super::fit::{Factor, Sample, fit, normal};
use super::kinematics::Number;
use nalgebra::{DMatrix, Vector3};

/// Fewest positions of a session.
const FEWEST: usize = 10;
/// Rows tried at first as the first of a session; those about the best of them next.
const TRIED: usize = 40;
/// Most sessions beyond the first.
const MOST: usize = 3;

impl Positions {
    /// Splits points into those of separate sessions while that is worth its price; says where.
    pub(super) fn find_sessions(&mut self) -> Vec<String> {
        let mut out = Vec::new();
        while out.len() < MOST {
            let best = (0..self.points.len()).filter_map(|p| self.best_split(p)).max_by(|a, b| a.2.total_cmp(&b.2));
            let Some((point, first, _)) = best else { break };
            if !self.split(point, first) {
                break;
            }
            let offset = self.fitted.geometry.tools_m[point] - self.fitted.geometry.tools_m[self.points.len() - 1];
            out.push(format!(
                "{} sat {:.2} mm away on the tool before row {}: another session, with an offset of its own",
                self.points[point],
                1e3 * offset.norm(),
                first + 1
            ));
        }
        out
    }

    /// Point, first row of its new session, and the gain in ln of the likelihood.
    fn best_split(&self, point: usize) -> Option<(usize, usize, f64)> {
        let rows: Vec<usize> = (0..self.samples.len()).filter(|&i| self.samples[i].point == point).collect();
        let inside = FEWEST..rows.len().saturating_sub(FEWEST);
        if inside.is_empty() {
            return None;
        }
        let stride = inside.len().div_ceil(TRIED);
        let coarse = self.split_gains(point, inside.clone().step_by(stride).map(|i| rows[i]).collect());
        let (around, _) = coarse.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let at = rows.iter().position(|&r| r == around)?;
        let near = at.saturating_sub(stride).max(inside.start)..(at + stride + 1).min(inside.end);
        let fine = self.split_gains(point, near.map(|i| rows[i]).collect());
        fine.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(first, gain)| (point, first, gain))
    }

    /// Gain of an offset of its own for the rows before each of `firsts`.
    fn split_gains(&self, point: usize, firsts: Vec<usize>) -> Vec<(usize, f64)> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let tool: Vec<Number> = (0..3).map(|c| Number::Tool(point, c)).collect();
        let columns = |s: &Sample| -> Vec<Vector3<f64>> {
            let index = self.samples.iter().position(|own| std::ptr::eq(own, s)).unwrap_or_default();
            let slopes = self.fitted.geometry.place(s.arm, &s.pose_rad, s.point, &tool).slopes;
            let before = |first: &usize| if index < *first { 1.0 } else { 0.0 };
            firsts.iter().flat_map(|f| slopes.iter().map(move |slope| slope * before(f))).collect()
        };
        let normal = normal(&all, &self.numbers, &self.fitted, &columns);
        let own: Vec<usize> = (0..normal.own).collect();
        let Some(factor) = Factor::new(&normal.curvature, &own) else { return Vec::new() };
        let gain = |k: usize| -> f64 {
            let at = normal.own + 3 * k;
            let cross = normal.curvature.view((0, at), (normal.own, 3)).into_owned();
            let answers: Vec<_> = (0..3).map(|c| factor.solve(&cross.column(c).into_owned())).collect();
            let answered = DMatrix::from_columns(&answers);
            let left = normal.curvature.view((at, at), (3, 3)) - cross.transpose() * &answered;
            let gradient = normal.gradient.rows(at, 3) - answered.transpose() * normal.gradient.rows(0, normal.own);
            left.try_inverse().map_or(0.0, |inverse| 0.5 * gradient.dot(&(inverse * &gradient)))
        };
        firsts.iter().enumerate().map(|(k, first)| (*first, gain(k))).collect()
    }

    /// Gives the rows of a point before `first` a point of their own if that is worth its price.
    fn split(&mut self, point: usize, first: usize) -> bool {
        let new = self.points.len();
        let mut samples = self.samples.clone();
        samples[..first].iter_mut().filter(|s| s.point == point).for_each(|s| s.point = new);
        let mut start = self.fitted.clone();
        start.geometry.tools_m.push(start.geometry.tools_m[point]);
        let mut numbers = self.numbers.clone();
        numbers.extend((0..3).map(|c| Number::Tool(new, c)));
        let all: Vec<&Sample> = samples.iter().collect();
        let fitted = fit(&all, &numbers, &start.effects, &start);
        let count = 3.0 * samples.len() as f64;
        // three numbers, and any row of any point could have been the first
        let price = 1.5 * count.ln() + count.ln() + 3.0;
        if fitted.ln_likelihood < self.fitted.ln_likelihood + price {
            return false;
        }
        (self.samples, self.numbers, self.fitted) = (samples, numbers, fitted);
        self.points.push(format!("{} before row {}", self.points[point], first + 1));
        true
    }
}
