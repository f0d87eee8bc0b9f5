//! Finds the placement of the calibrated arms: in each session, and one common placement that fits all sessions best.

use super::analysis::Positions;
use super::deflection::Deflection;
use super::fit::likeliest;
use super::fitted::{Fitted, Sample};
use super::kinematics::{Geometry, Number};
use super::points::{Point, points};
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::placement::{
    Placement, Session, Stand, pose_mark, test_numbers, tests_in_order,
};
use nalgebra::{Rotation3, Vector3};
use std::collections::HashMap;
use std::sync::Arc;

impl Positions {
    /// The placement of the arm with the index `arm` in the instrument's frame, by the fit `shown`: one placement for
    /// each session, and one for all sessions together. `turned` is the rotation of the arm's last frame that the
    /// calibrated zeros and mountings cause.
    pub(crate) fn placement(
        &self,
        campaign: &Campaign,
        arm: usize,
        shown: &Fitted,
        turned: Rotation3<f64>,
    ) -> Placement {
        let own: Vec<usize> = (0..self.samples.len()).filter(|&i| self.samples[i].arm == arm).collect();
        let own_points: Vec<(usize, Point)> =
            points(campaign).into_iter().enumerate().filter(|(_, point)| point.arm == arm).collect();
        let mut geometry = shown.geometry.clone();
        geometry.relevel();
        let runs = self.runs(campaign, &own);
        if runs.len() < 2 {
            let usual = self.stand(&geometry, campaign, &own_points, &own, turned);
            return Placement { usual, ..Placement::default() };
        }
        let merged = self.merged(campaign, shown);
        let at_rest = |(at, point): &(usize, Point)| (point.name.clone(), turned * merged.tools_m[*at]);
        let usual = Stand {
            rotation: merged.level_to_instrument().into_inner(),
            origin_m: merged.origin_m,
            points_m: own_points.iter().map(at_rest).collect(),
        };
        let rows: Vec<_> = own.iter().map(|&i| campaign.positions[i].clone()).collect();
        let numbered = test_numbers(&rows).filter(|n| n.is_sorted()).map(|numbers| (numbers, Vec::new()));
        let Some((numbers, order)) = numbered.or_else(|| tests_in_order(&rows)) else {
            return Placement { usual, ..Placement::default() };
        };
        let number_of = |i: usize| own.iter().position(|&o| o == i).map_or(f64::INFINITY, |k| numbers[k]);
        let ends = runs.iter().skip(1).map(|next| Some(next[0])).chain([None]);
        let sessions = runs.iter().zip(ends).map(|(run, next)| Session {
            // the limit between two sessions lies halfway between the test numbers on its two sides
            before_test: next.map_or(f64::INFINITY, |next| {
                0.5 * (number_of(next) + number_of(*run.last().unwrap_or(&next)))
            }),
            stand: self.stand(&geometry, campaign, &own_points, run, turned),
        });
        Placement {
            usual,
            sessions: sessions.collect(),
            tests: rows.iter().map(|r| (r.test.clone(), pose_mark(&r.pose_deg))).collect(),
            order,
        }
    }

    /// Divides the samples with the indices `own` (those of one arm) into runs, within each of which neither the
    /// instrument nor a point was moved.
    fn runs(&self, campaign: &Campaign, own: &[usize]) -> Vec<Vec<usize>> {
        let mut out: Vec<Vec<usize>> = Vec::new();
        // for each name of a point, the index of the point in the present run
        let mut seen: HashMap<&str, usize> = HashMap::new();
        for &i in own {
            let (sample, name) = (&self.samples[i], campaign.positions[i].point.as_str());
            let is_same = |run: &Vec<usize>| {
                self.samples[run[0]].station == sample.station
                    && seen.get(name).is_none_or(|point| *point == sample.point)
            };
            match out.last_mut().filter(|run| is_same(run)) {
                Some(run) => run.push(i),
                None => {
                    out.push(vec![i]);
                    seen.clear();
                }
            }
            seen.insert(name, sample.point);
        }
        out
    }

    /// Placement of the arm, and of the points on its tool, during the samples with the indices `run`. `own_points`
    /// lists the arm's points. Each comes with the index among all points that is used if the run does not contain the
    /// point.
    fn stand(
        &self,
        geometry: &Geometry,
        campaign: &Campaign,
        own_points: &[(usize, Point)],
        run: &[usize],
        turned: Rotation3<f64>,
    ) -> Stand {
        let (turn, shift_m) = geometry.stations[run.first().map_or(0, |&i| self.samples[i].station)];
        let point_m = |(usual, point): &(usize, Point)| {
            let seen = run.iter().find(|&&i| Point::of(&campaign.positions[i]) == *point);
            let at = seen.map_or(*usual, |&i| self.samples[i].point);
            (point.name.clone(), turned * geometry.tools_m[at])
        };
        Stand {
            rotation: (turn * geometry.level_to_instrument()).into_inner(),
            origin_m: geometry.origin_m + shift_m,
            points_m: own_points.iter().map(point_m).collect(),
        }
    }

    /// The geometry of the fit `shown`, with one placement of base and points that fits all sessions together. All
    /// other numbers stay as they are.
    fn merged(&self, campaign: &Campaign, shown: &Fitted) -> Geometry {
        let named = points(campaign);
        let together: Vec<Sample> = self
            .samples
            .iter()
            .zip(&campaign.positions)
            .map(|(sample, row)| {
                let mut out = sample.clone();
                out.deflection = Arc::new(Deflection::known(shown.displacement(sample)));
                out.second_order_m = Vector3::zeros();
                out.point = named.iter().position(|p| *p == Point::of(row)).unwrap_or_default();
                out.station = 0;
                out
            })
            .collect();
        let places = |n: &&Number| match n {
            Number::BaseRotation(_) | Number::BasePosition(_) => true,
            Number::Tool(point, _) => *point < named.len(),
            _ => false,
        };
        let numbers: Vec<Number> = self.numbers.iter().filter(places).cloned().collect();
        let mut start = Fitted::rigid(shown.geometry.clone(), shown.scale_m);
        start.geometry.relevel();
        let all: Vec<&Sample> = together.iter().collect();
        likeliest(&all, &numbers, &[], &start).geometry
    }
}
