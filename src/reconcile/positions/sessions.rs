//! Tells sessions apart: until some row of the file a point sat elsewhere on the tool, or the instrument
//! stood elsewhere.
//!
//! Between two sessions a reflector is put back slightly differently, or the instrument or the base is moved.
//! Every row is tried as the first of a new session, by the gain of the linearized model. The earlier rows
//! then have an offset or a placement of their own.

use super::analysis::Positions;
use super::fit::{Fitted, Sample, fit, normal};
use super::kinematics::Number;
use super::normal::Factor;
use super::points::Point;
use nalgebra::{DMatrix, Vector3};

/// Smallest number of positions in a session.
const FEWEST: usize = 5;
/// Number of rows that are tried at first as the first row of a session. The rows around the best of them are tried
/// next.
const TRIED: usize = 40;
/// Largest number of sessions beyond the first.
const MOST: usize = 6;

/// What is placed differently in another session.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Moved {
    /// A point on the tool, by its index.
    Point(usize),
    /// The instrument or the base: the session with this index is divided.
    Station(usize),
}

impl Moved {
    fn has(self, sample: &Sample) -> bool {
        match self {
            Moved::Point(p) => sample.point == p,
            Moved::Station(s) => sample.station == s,
        }
    }

    fn numbers(self) -> Vec<Number> {
        match self {
            Moved::Point(p) => (0..3).map(|c| Number::Tool(p, c)).collect(),
            Moved::Station(s) => {
                let turns = (0..3).map(move |c| Number::SessionRotation(s, c));
                turns.chain((0..3).map(move |c| Number::SessionPosition(s, c))).collect()
            }
        }
    }
}

/// A model with one more session.
struct Split {
    samples: Vec<Sample>,
    numbers: Vec<Number>,
    fitted: Fitted,
    moved: Moved,
    first: usize,
    gain: f64,
}

impl Positions {
    /// Finds sessions, as long as another session is worth its price. Returns one sentence for each.
    pub(crate) fn find_sessions(&mut self, tools_free: bool, base_free: bool) -> Vec<String> {
        let mut out = Vec::new();
        while out.len() < MOST {
            let points = (0..self.points.len()).filter(|_| tools_free).map(Moved::Point);
            let stations = (0..self.fitted.geometry.stations.len()).filter(|_| base_free).map(Moved::Station);
            let kinds: Vec<Moved> = points.chain(stations).collect();
            let splits = kinds.iter().filter_map(|&moved| {
                let first = self.best_first(moved)?;
                Some(self.split(moved, first, kinds.len()))
            });
            let Some(best) = splits.filter(|s| s.gain > 0.0).max_by(|a, b| a.gain.total_cmp(&b.gain)) else {
                break;
            };
            out.push(self.take(best));
        }
        out
    }

    /// The row that is best as the first of a new session.
    fn best_first(&self, moved: Moved) -> Option<usize> {
        let rows: Vec<usize> = (0..self.samples.len()).filter(|&i| moved.has(&self.samples[i])).collect();
        let inside = FEWEST..rows.len().saturating_sub(FEWEST);
        if inside.is_empty() {
            return None;
        }
        let stride = inside.len().div_ceil(TRIED);
        let coarse = self.gains_of(moved, inside.clone().step_by(stride).map(|i| rows[i]).collect());
        let (around, _) = coarse.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let at = rows.iter().position(|&r| r == around)?;
        let near = at.saturating_sub(stride).max(inside.start)..(at + stride + 1).min(inside.end);
        let fine = self.gains_of(moved, near.map(|i| rows[i]).collect());
        fine.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(first, _)| first)
    }

    /// For each row of `firsts`, the gain in ln of the likelihood if the rows before it had their own placement.
    fn gains_of(&self, moved: Moved, firsts: Vec<usize>) -> Vec<(usize, f64)> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let own = moved.numbers();
        let columns = |s: &Sample| -> Vec<Vector3<f64>> {
            let slopes = self.fitted.geometry.place(s.placing(), &own).slopes;
            let before = |first: &usize| if moved.has(s) && s.index < *first { 1.0 } else { 0.0 };
            firsts.iter().flat_map(|f| slopes.iter().map(move |slope| slope * before(f))).collect()
        };
        let normal = normal(&all, &self.numbers, &self.fitted, &columns);
        let model: Vec<usize> = (0..normal.own).collect();
        let Some(factor) = Factor::new(&normal.curvature, &model) else { return Vec::new() };
        let width = own.len();
        let gain = |k: usize| -> f64 {
            let at = normal.own + width * k;
            let cross = normal.curvature.view((0, at), (normal.own, width)).into_owned();
            let answers: Vec<_> = (0..width).map(|c| factor.solve(&cross.column(c).into_owned())).collect();
            let answered = DMatrix::from_columns(&answers);
            let left = normal.curvature.view((at, at), (width, width)) - cross.transpose() * &answered;
            let gradient =
                normal.gradient.rows(at, width) - answered.transpose() * normal.gradient.rows(0, normal.own);
            left.try_inverse().map_or(0.0, |inverse| 0.5 * gradient.dot(&(inverse * &gradient)))
        };
        firsts.iter().enumerate().map(|(k, first)| (*first, gain(k))).collect()
    }

    /// The model in which the rows before `first` have their own placement. Its likelihood is charged for the numbers
    /// of this placement and for having looked at every row.
    fn split(&self, moved: Moved, first: usize, kinds: usize) -> Split {
        let mut samples = self.samples.clone();
        let mut start = self.fitted.clone();
        let geometry = &mut start.geometry;
        let earlier = samples[..first].iter_mut().filter(|s| moved.has(s));
        let new = match moved {
            Moved::Point(p) => {
                let new = geometry.tools_m.len();
                geometry.tools_m.push(geometry.tools_m[p]);
                earlier.for_each(|s| s.point = new);
                Moved::Point(new)
            }
            Moved::Station(s) => {
                let new = geometry.stations.len();
                geometry.stations.push(geometry.stations[s]);
                earlier.for_each(|sample| sample.station = new);
                Moved::Station(new)
            }
        };
        let mut numbers = self.numbers.clone();
        numbers.extend(new.numbers());
        let all: Vec<&Sample> = samples.iter().collect();
        let fitted = fit(&all, &numbers, &start.effects, &start);
        let readings = 3.0 * samples.len() as f64;
        let price = 0.5 * new.numbers().len() as f64 * readings.ln() + (readings * kinds as f64).ln() + 3.0;
        let gain = fitted.ln_likelihood - self.fitted.ln_likelihood - price;
        Split { samples, numbers, fitted, moved, first, gain }
    }

    fn take(&mut self, split: Split) -> String {
        (self.samples, self.numbers, self.fitted) = (split.samples, split.numbers, split.fitted);
        let geometry = &self.fitted.geometry;
        let row = split.first + 1;
        match split.moved {
            Moved::Point(p) => {
                let offset_m = geometry.tools_m[p] - geometry.tools_m[geometry.tools_m.len() - 1];
                self.points.push(Point { before_row: Some(row), ..self.points[p].clone() });
                let (name, mm) = (self.points[p].label(), 1e3 * offset_m.norm());
                format!("{name} sat {mm:.2} mm away on the tool before row {row}: a session of its own")
            }
            Moved::Station(s) => {
                let (turn, shift_m) = geometry.stations[geometry.stations.len() - 1];
                let (own_turn, own_shift_m) = geometry.stations[s];
                let (mm, mrad) = (1e3 * (shift_m - own_shift_m).norm(), 1e3 * turn.angle_to(&own_turn));
                format!(
                    "before row {row} the instrument or the base stood {mm:.2} mm and {mrad:.2} mrad elsewhere: a session of its own"
                )
            }
        }
    }
}
