//! Placement of an arm in the frame of an instrument, session by session.
//!
//! The placement changes between two sessions, for example because a reflector is put back slightly differently, or
//! because the instrument or the base is moved. The number of a row's test tells to which session the row belongs, if
//! the tests are numbered as in the campaign from which the placement was found. All other rows get the placement that
//! fits all sessions best.

use super::rows::PositionRow;
use crate::arm::Arm;
use nalgebra::{Matrix3, Vector3};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Where the arm stands in the instrument's frame, and where the measured points are on its last frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Stand {
    /// Rotation matrix that turns vectors of the arm's base frame into the instrument's frame.
    pub rotation: Matrix3<f64>,
    /// Origin of the base frame in the instrument's frame \[m\].
    pub origin_m: Vector3<f64>,
    /// Name of each measured point, and its position in the last frame of the arm \[m\].
    pub points_m: Vec<(String, Vector3<f64>)>,
}

/// A session: the tests with numbers in one range, during which the placement stayed the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    /// Upper limit of the test numbers: the tests of the session have smaller numbers than this. Infinite for the last
    /// session.
    pub before_test: f64,
    /// The placement during the session.
    pub stand: Stand,
}

/// The placement of an arm in the instrument's frame: for all sessions together, and for each session.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Placement {
    /// The one placement that fits all sessions best.
    pub usual: Stand,
    /// The sessions in the order of their tests; empty if there is only one.
    pub sessions: Vec<Session>,
    /// Mark of the pose of each test of the campaign, by the name of the test. [`pose_mark`] gives the mark. It shows
    /// whether other rows with the same test names have the same poses.
    pub tests: BTreeMap<String, String>,
    /// Names of the tests in the order of the campaign, if the names are not rising numbers. The number of a test is
    /// then its place in this list, from 0. Empty if the names of the tests are numbers.
    pub order: Vec<String>,
}

impl Default for Stand {
    fn default() -> Self {
        Self { rotation: Matrix3::identity(), origin_m: Vector3::zeros(), points_m: Vec::new() }
    }
}

impl Stand {
    /// Position of the point `name` in the last frame of the arm \[m\]; zero, which is the tip, if there is no such
    /// point.
    pub fn point_m(&self, name: &str) -> Vector3<f64> {
        self.points_m.iter().find(|(n, _)| n == name).map_or(Vector3::zeros(), |(_, at)| *at)
    }

    fn from_json(stand: &Value) -> Option<Self> {
        let vector = |v: &Value| Vector3::from_fn(|i, _| v[i].as_f64().unwrap_or_default());
        let points = stand["points_m"].as_object()?;
        Some(Self {
            rotation: Matrix3::from_fn(|i, j| stand["rotation"][i][j].as_f64().unwrap_or_default()),
            origin_m: vector(&stand["origin_m"]),
            points_m: points.iter().map(|(name, v)| (name.clone(), vector(v))).collect(),
        })
    }

    fn to_json(&self) -> Value {
        let rows: Vec<Vec<f64>> = (0..3).map(|i| self.rotation.row(i).iter().copied().collect()).collect();
        let point = |(name, at): &(String, Vector3<f64>)| (name.clone(), json!(at.as_slice()));
        let points: Map<String, Value> = self.points_m.iter().map(point).collect();
        json!({"rotation": rows, "origin_m": self.origin_m.as_slice(), "points_m": points})
    }
}

impl Placement {
    /// Reads the `placement` in the provenance of a corrected arm, from the JSON of its arm file. If there is none, the
    /// base frame is the instrument's frame and there are no sessions.
    pub fn from_json(arm_file: &Value) -> Self {
        let placement = &arm_file["provenance"]["placement"];
        let session = |s: &Value| {
            let before_test = s["before_test"].as_f64().unwrap_or(f64::INFINITY);
            Some(Session { before_test, stand: Stand::from_json(s)? })
        };
        let tests = placement["tests"].as_object().into_iter().flatten();
        Self {
            usual: Stand::from_json(placement).unwrap_or_default(),
            sessions: placement["sessions"].as_array().into_iter().flatten().filter_map(session).collect(),
            tests: tests.filter_map(|(test, mark)| Some((test.clone(), mark.as_str()?.into()))).collect(),
            order: placement["order"]
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(|test| Some(test.as_str()?.to_string()))
                .collect(),
        }
    }

    /// The placement as JSON: the entry `placement` in the provenance of a corrected arm.
    pub fn to_json(&self) -> Value {
        let mut out = self.usual.to_json();
        if !self.sessions.is_empty() {
            let session = |s: &Session| {
                let mut own = s.stand.to_json();
                own["before_test"] = json!(s.before_test.is_finite().then_some(s.before_test));
                own
            };
            out["sessions"] = self.sessions.iter().map(session).collect();
            out["tests"] = json!(self.tests);
            if !self.order.is_empty() {
                out["order"] = json!(self.order);
            }
        }
        out
    }

    /// The placement for each row of positions, in the order of `rows`. If the rows are numbered as in the campaign, it
    /// is the placement of the session of the row; otherwise it is the usual one.
    pub fn stands<'a>(&'a self, rows: &[PositionRow]) -> Vec<&'a Stand> {
        let numbered = self.numbers(rows).filter(|_| rows.iter().all(|row| self.agrees(row)));
        let Some(numbers) = numbered else { return vec![&self.usual; rows.len()] };
        let of = |number: f64| self.sessions.iter().find(|s| number < s.before_test).map(|s| &s.stand);
        numbers.into_iter().map(|number| of(number).unwrap_or(&self.usual)).collect()
    }

    /// Number of the test of each row, as [`Session::before_test`] counts tests. NaN for a test that
    /// [`Placement::order`] lacks. `None` if that list is empty and the names of the tests are not all numbers.
    fn numbers(&self, rows: &[PositionRow]) -> Option<Vec<f64>> {
        if self.order.is_empty() {
            return test_numbers(rows);
        }
        let place = |row: &PositionRow| self.order.iter().position(|test| test == row.test.trim());
        Some(rows.iter().map(|row| place(row).map_or(f64::NAN, |at| at as f64)).collect())
    }

    /// Indices of the rows that belong to no session, because their tests have no number or have other numbers than in
    /// the campaign. Empty if the placement has no sessions.
    pub(crate) fn strangers(&self, rows: &[PositionRow]) -> Vec<usize> {
        let is_usual = |stand: &Stand| !self.sessions.is_empty() && std::ptr::eq(stand, &self.usual);
        let stands = self.stands(rows).into_iter().enumerate();
        stands.filter(|(_, stand)| is_usual(stand)).map(|(i, _)| i).collect()
    }

    /// Whether a row has the same pose as the test of the same name in the campaign. `true` if the campaign has no such
    /// test.
    fn agrees(&self, row: &PositionRow) -> bool {
        self.tests.get(&row.test).is_none_or(|mark| *mark == pose_mark(&row.pose_deg))
    }
}

/// Number of the test of each row: the name of the test, read as a number. `None` if a name is not a finite number.
pub fn test_numbers(rows: &[PositionRow]) -> Option<Vec<f64>> {
    rows.iter().map(|row| row.test.trim().parse().ok().filter(|n: &f64| n.is_finite())).collect()
}

/// Numbers for tests that have names. The first result is the number of the test of each row, and the second is the
/// list of the names in the order of the rows. The number of a test is the place of its name in this list, from 0.
/// `None` if the rows of one test do not follow each other.
pub fn tests_in_order(rows: &[PositionRow]) -> Option<(Vec<f64>, Vec<String>)> {
    let mut order: Vec<String> = Vec::new();
    let mut numbers = Vec::new();
    for row in rows {
        let name = row.test.trim();
        if order.last().is_none_or(|last| last != name) {
            if order.iter().any(|earlier| earlier == name) {
                return None;
            }
            order.push(name.to_string());
        }
        numbers.push((order.len() - 1) as f64);
    }
    Some((numbers, order))
}

/// A short text that identifies a pose, given as the angles of the driven joints \[deg\]. Equal angles give equal
/// texts.
pub fn pose_mark(pose_deg: &[f64]) -> String {
    // rounded, because a file may change the last digits of an angle
    let angles: String = pose_deg.iter().map(|angle| format!("{angle:.6},")).collect();
    blake3::hash(angles.as_bytes()).to_hex()[..8].to_string()
}

/// An arm and its placement in the frame of an instrument.
#[derive(Debug, Clone)]
pub struct Placed {
    /// The arm.
    pub arm: Arm,
    /// Where the arm stands in the instrument's frame; used for absolute positions only.
    pub placement: Placement,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::load::Payload;

    fn row(test: &str, angle_deg: f64) -> PositionRow {
        PositionRow {
            row: 0,
            test: test.into(),
            pose_deg: vec![angle_deg],
            payload: Payload::default(),
            temperature_c: None,
            arm: 0,
            point: "tip".into(),
            measured: [None; 3],
        }
    }

    fn at(x_m: f64) -> Stand {
        Stand { origin_m: Vector3::x() * x_m, ..Stand::default() }
    }

    fn placement() -> Placement {
        let sessions = [(10.5, 1.0), (f64::INFINITY, 2.0)];
        Placement {
            usual: at(1.5),
            sessions: sessions.map(|(before_test, x_m)| Session { before_test, stand: at(x_m) }).into(),
            tests: [("4".into(), pose_mark(&[30.0]))].into(),
            order: Vec::new(),
        }
    }

    fn places(rows: &[PositionRow]) -> Vec<f64> {
        placement().stands(rows).iter().map(|s| s.origin_m.x).collect()
    }

    #[test]
    fn the_number_of_a_test_tells_its_session() {
        assert_eq!(places(&[row("3", 5.0), row("4", 30.0), row("11", -7.0)]), [1.0, 1.0, 2.0]);
    }

    #[test]
    fn tests_that_are_numbered_anew_or_not_at_all_have_the_usual_place() {
        assert_eq!(places(&[row("3", 5.0), row("4", 31.0)]), [1.5, 1.5], "test 4 is another");
        assert_eq!(places(&[row("3", 5.0), row("b", 30.0)]), [1.5, 1.5]);
    }

    #[test]
    fn rows_of_no_known_session_are_counted() {
        let placement = placement();
        assert_eq!(placement.strangers(&[row("4", 30.0), row("11", -7.0)]), [0; 0]);
        assert_eq!(placement.strangers(&[row("3", 5.0), row("4", 31.0)]), [0, 1], "numbered anew");
        let undivided = Placement { sessions: Vec::new(), ..placement };
        assert_eq!(undivided.strangers(&[row("b", 31.0)]), [0; 0]);
    }

    #[test]
    fn tests_with_names_belong_to_sessions_by_their_order() {
        let rows = ["a", "a", "b", "c"].map(|test| row(test, 5.0));
        let (numbers, order) = tests_in_order(&rows).expect("rows of a test follow each other");
        assert_eq!((numbers, order.len()), (vec![0.0, 0.0, 1.0, 2.0], 3));
        assert_eq!(tests_in_order(&["a", "b", "a"].map(|test| row(test, 5.0))), None);
        let sessions = [(1.5, 1.0), (f64::INFINITY, 2.0)];
        let sessions = sessions.map(|(before_test, x_m)| Session { before_test, stand: at(x_m) }).into();
        let named = Placement { sessions, order, tests: BTreeMap::new(), ..placement() };
        let rows = ["c", "a", "new"].map(|test| row(test, 5.0));
        let places: Vec<f64> = named.stands(&rows).iter().map(|s| s.origin_m.x).collect();
        assert_eq!(places, [2.0, 1.0, 1.5]);
        assert_eq!(named.strangers(&rows), [2]);
        let file = json!({"provenance": {"placement": named.to_json()}});
        assert_eq!(Placement::from_json(&file), named);
    }

    #[test]
    fn a_file_holds_all_of_it() {
        let file = json!({"provenance": {"placement": placement().to_json()}});
        assert_eq!(Placement::from_json(&file), placement());
        assert_eq!(Placement::from_json(&json!({})), Placement::default());
    }
}
