//! Derivatives of the deflection of a point with respect to the calibrated geometry.
//!
//! A fit changes the geometry, while the deflection stays as it was computed for the geometry of the fit before. It is
//! computed again after each stage. Some changes leave the arm as it is, such as a rotation of the base about the first
//! axis and a zero of this joint that makes up for it. A fit that knew how the deflection turns with the base, but not with the
//! zero, would take them for a way to fit the noise. So the steps of a fit lack a part of the derivatives with respect to the geometry:
//! longer links, for example, give the weights longer levers. This part is small, of the order of deflection over
//! reach. But it is the only derivative of some combinations of numbers, such as the height of the base and the length
//! of the first link along a vertical axis. Without it the readings would leave these combinations as uncertain as
//! their priors, and this would widen the intervals of the compliances. The intervals therefore use these derivatives
//! too. The missing part is computed as a difference quotient, and for rotations of the base from the displacement. It
//! is left out for transmission errors and for rotations between sessions.

use super::fitted::{Fitted, Sample};
use super::kinematics::{Geometry, Number, rate};
use super::loads::Loads;
use super::normal::Normal;
use crate::reconcile::readings::rows::PositionRow;
use nalgebra::{Rotation3, Vector3};

/// Step of each number for the difference quotient, in the unit of the number \[m or rad\]. The deflection is nearly linear
/// over it.
const STEP: f64 = 1e-3;

/// The part of the derivatives with respect to the geometry that comes from the deflection.
pub(super) struct GeometrySlopes<'a> {
    rows: &'a [PositionRow],
    fitted: &'a Fitted,
    from_level: Rotation3<f64>,
    /// The arms with the calibrated geometry.
    here: Loads<'a>,
    /// The numbers on which the deflection depends.
    moved: Vec<Moved<'a>>,
    /// The index of each number that turns the base, and the instrument axis about which it turns the base.
    turned: Vec<(usize, usize)>,
}

/// A number of the geometry after a step.
struct Moved<'a> {
    /// Index of the number.
    index: usize,
    number: &'a Number,
    /// The arms after the step.
    loads: Loads<'a>,
    /// For each arm, whether the number belongs to it. A number of another arm only moves the weights of that arm on
    /// the trunk. This influence is neglected.
    is_of_arm: Vec<bool>,
}

impl<'a> GeometrySlopes<'a> {
    /// Prepares the derivatives for the samples of `rows`. `arms` prepares the arms for a given geometry. They must
    /// contain everything that deflects according to the fit `fitted`.
    pub(super) fn new(
        rows: &'a [PositionRow],
        numbers: &'a [Number],
        fitted: &'a Fitted,
        arms: impl Fn(&Geometry) -> Loads<'a>,
    ) -> Self {
        let mut geometry = fitted.geometry.clone();
        geometry.relevel();
        let all = || numbers.iter().enumerate();
        let moved = all().filter(|(_, number)| moves_weights(number)).map(|(index, number)| {
            let mut moved = geometry.clone();
            moved.step(std::slice::from_ref(number), &[STEP]);
            let is_of_arm = (0..geometry.arms()).map(|arm| geometry.has(arm, number)).collect();
            Moved { index, number, loads: arms(&moved), is_of_arm }
        });
        let turned = all().filter_map(|(k, number)| match number {
            Number::BaseRotation(axis) => Some((k, *axis)),
            _ => None,
        });
        Self {
            rows,
            fitted,
            from_level: geometry.level_to_instrument(),
            here: arms(&geometry),
            moved: moved.collect(),
            turned: turned.collect(),
        }
    }
}

impl Geometry {
    /// Whether the number belongs to the arm with the index `arm`, or to all arms.
    fn has(&self, arm: usize, number: &Number) -> bool {
        let chain = &self.arms[arm];
        match *number {
            Number::Mount(piece, _)
            | Number::MountVector(piece, _)
            | Number::Axis(piece, _)
            | Number::Vector(piece, _)
            | Number::Ratio(piece, _) => chain.contains(&piece),
            Number::Zero(driven) => {
                chain.iter().any(|&i| self.angles[i].as_ref().is_some_and(|angle| rate(angle, driven) != 0.0))
            }
            _ => true,
        }
    }
}

/// Whether the weights, the joints or the measured point move in the level frame if the number changes.
fn moves_weights(number: &Number) -> bool {
    match number {
        Number::Tool(..)
        | Number::Mount(..)
        | Number::MountVector(..)
        | Number::Zero(_)
        | Number::Axis(..)
        | Number::Vector(..)
        | Number::Ratio(..) => true,
        Number::BaseRotation(_)
        | Number::BasePosition(_)
        | Number::Transmission(..)
        | Number::Tolerance(_)
        | Number::Effect(_)
        | Number::Gravity(_)
        | Number::SessionRotation(..)
        | Number::SessionPosition(..)
        | Number::Drift(_) => false,
    }
}

impl GeometrySlopes<'_> {
    /// Indices of the numbers whose derivatives lack a part in a fit.
    pub(super) fn incomplete(&self) -> Vec<usize> {
        self.moved.iter().map(|moved| moved.index).chain(self.turned.iter().map(|(k, _)| *k)).collect()
    }

    /// Appends the missing parts of the derivatives of a sample's position to `columns`, for the numbers of
    /// [`incomplete`](Self::incomplete) \[m per unit\].
    pub(super) fn push(&self, sample: &Sample, columns: &mut Vec<Vector3<f64>>) {
        let row = &self.rows[sample.index];
        let pose = self.here.pose(row);
        let here_m = self.here.known_in_m(&pose, row, sample.point);
        columns.extend(self.moved.iter().map(|moved| match moved.number {
            // the offset of another point does not move this point
            Number::Tool(point, _) if *point != sample.point => Vector3::zeros(),
            _ if !moved.is_of_arm[sample.arm] => Vector3::zeros(),
            _ => self.from_level * (moved.loads.known_in_m(&pose, row, sample.point) - here_m) / STEP,
        }));
        let displaced_m = self.from_level * self.fitted.displacement(sample);
        columns.extend(self.turned.iter().map(|(_, axis)| Vector3::ith(*axis, 1.0).cross(&displaced_m)));
    }
}

/// The normal equations `parts`, completed with the missing parts of the derivatives with respect to the numbers
/// `incomplete`. The last columns of `parts` are the missing parts of the derivatives. With the other columns `A` and
/// their missing parts `Δ`, the curvature becomes `(A + Δ)ᵀ (A + Δ)`.
pub(super) fn completed(parts: &Normal, incomplete: &[usize]) -> Normal {
    let known = parts.gradient.len() - incomplete.len();
    let mut gradient = parts.gradient.rows(0, known).into_owned();
    let mut curvature = parts.curvature.view((0, 0), (known, known)).into_owned();
    for (i, &a) in incomplete.iter().enumerate() {
        gradient[a] += parts.gradient[known + i];
        for k in 0..known {
            let product = parts.curvature[(k, known + i)];
            curvature[(k, a)] += product;
            curvature[(a, k)] += product;
        }
        for (j, &b) in incomplete.iter().enumerate() {
            curvature[(a, b)] += parts.curvature[(known + i, known + j)];
        }
    }
    Normal { curvature, gradient, own: parts.own }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::arm::load::Payload;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::reconcile::positions::deflection::Deflection;
    use crate::reconcile::positions::pose::Pose;
    use crate::reconcile::positions::tree::Tree;
    use crate::reconcile::readings::campaign::{Campaign, read_statement};
    use nalgebra::{DMatrix, DVector};
    use std::sync::Arc;

    /// A lever of 0.8 m on a spring of 2e4 N m/rad holds 10 kg, level. Its end moves by `c m g l² cos q` at right angles to the
    /// lever.
    #[test]
    fn a_longer_lever_deflects_by_the_square_of_its_length() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("campaign.json");
        std::fs::write(&file, "{}").expect("written");
        let statement = read_statement(&file).expect("sound");
        let text = r#"{"name": "a", "gravity_m_s2": 9.81, "chain": [
            {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2e4},
            {"type": "link", "name": "l", "vector_m": [0.8, 0, 0]}]}"#;
        let arm = read_arm_document(Document::parse("a", text).expect("JSON"), &Catalogs::default());
        let arm = arm.expect("sound");
        let payload = Payload { mass_kg: 10.0, ..Payload::default() };
        let row = PositionRow {
            row: 0,
            test: String::new(),
            pose_deg: vec![0.0],
            payload,
            temperature_c: None,
            arm: 0,
            point: "tip".into(),
            measured: [None; 3],
        };
        let campaign = Campaign::of_positions(&statement, &[&arm], vec![row]).expect("one trunk");
        let tree = Tree::new(&campaign);
        let fitted = Fitted::rigid(Geometry::nominal(&tree, 1), 1e-4);
        let numbers =
            [Number::Vector(1, 0), Number::Zero(0), Number::BaseRotation(1), Number::BasePosition(0)];
        let arms = |geometry: &Geometry| Loads::new(&campaign, &tree, geometry, &[]);
        let slopes = GeometrySlopes::new(&campaign.positions, &numbers, &fitted, arms);
        let down_m = 10.0 * 9.81 * 0.8 * 0.8 / 2e4;
        let sample = Sample {
            pose: Pose::new(&[0.0]),
            arm: 0,
            point: 0,
            station: 0,
            part: 0.0,
            index: 0,
            group: 0,
            measured_m: Vector3::zeros(),
            precision: Vector3::repeat(1.0),
            deflection: Arc::new(Deflection::known(Vector3::new(0.0, 0.0, -down_m))),
            nominal_m: Arc::default(),
            second_order_m: Vector3::zeros(),
        };
        assert_eq!(slopes.incomplete(), [0, 1, 2]);
        let mut columns = Vec::new();
        slopes.push(&sample, &mut columns);
        let expected = [
            // the deflection is proportional to the square of the length
            Vector3::new(0.0, 0.0, -2.0 * down_m / 0.8),
            // a lever that points down by q deflects backwards by sin q of the deflection; to first order cos q is 1
            Vector3::new(-down_m, 0.0, 0.0),
            // a rotation of the base also turns the displacement
            Vector3::new(-down_m, 0.0, 0.0),
        ];
        for (k, (found, expected)) in columns.iter().zip(expected).enumerate() {
            // the difference quotient over a step of 1e-3 is off by a part in a thousand
            assert!((found - expected).norm() < 3e-3 * down_m, "{k}: {found} {expected}");
        }
    }

    #[test]
    fn completed_equations_are_those_of_the_sums_of_the_columns() {
        let columns = |with: bool| {
            let entry = |r: usize, c: usize| ((r * r + 3 * c * c + r * c) as f64 * 0.7).sin();
            DMatrix::from_fn(9, 4, |r, c| {
                entry(r, c) + if with && c < 2 { 0.1 * entry(r, c + 7) } else { 0.0 }
            })
        };
        let errors = DVector::from_fn(9, |r, _| (r as f64).cos());
        let of = |x: &DMatrix<f64>| Normal { curvature: x.tr_mul(x), gradient: x.tr_mul(&errors), own: 3 };
        let (plain, whole) = (columns(false), columns(true));
        let mut with_parts = plain.clone().insert_columns(4, 2, 0.0);
        (0..2).for_each(|c| with_parts.set_column(4 + c, &(whole.column(c) - plain.column(c))));
        let found = completed(&of(&with_parts), &[0, 1]);
        let expected = of(&whole);
        assert!((found.curvature - expected.curvature).amax() < 1e-12);
        assert!((found.gradient - expected.gradient).amax() < 1e-12);
    }
}
