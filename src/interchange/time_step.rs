//! The time step with which a simulator can integrate an exported arm.
//!
//! MuJoCo's integrators treat springs explicitly. Without damping, their step (semi-implicit Euler) is stable while
//! `h ω < 2` for every natural frequency `ω` of the model, with motors free to turn. The highest of them belongs to the
//! lightest body between stiff springs. It is the largest eigenvalue of `L⁻¹ K L⁻ᵀ`, where `K` is the stiffness matrix
//! and `M = L Lᵀ` the mass matrix over all hinges of the file. Couplings that the file holds rigid only lower it, so
//! they are left out.

use super::tree::{Hinge, Node};
use crate::mechanics::krylov::largest_eigenvalue;
use crate::mechanics::{Twist, angular, linear, rotation_twist, stack};
use nalgebra::{Cholesky, DMatrix, DVector, Isometry3, Matrix6, Translation3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// Part of the longest stable step that is used. The rest is for other poses, in which frequencies differ.
const USED: f64 = 0.5;
/// Longest time step that a file states \[s\], also if all its frequencies are low.
const LONGEST_S: f64 = 1e-3;

/// An exported arm as a simulator moves it.
pub(super) struct Moving<'n> {
    /// The bodies, base to tip.
    pub nodes: &'n [Node],
    /// Inertia matrix of each body as the file has it, about the world's origin at zero joint angles.
    pub inertias: Vec<Matrix6<f64>>,
    /// Inertia of the rotor on each hinge \[kg m²\].
    pub armatures_kgm2: Vec<f64>,
    /// Position of each hinge \[rad, m\].
    pub positions: Vec<f64>,
    /// Springs: for each, its stiffness and the hinges on whose positions its length depends, with their coefficients.
    pub springs: Vec<(f64, Vec<(usize, f64)>)>,
}

/// A time step, and the frequency that limits it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimeStep {
    /// The step \[s\].
    pub step_s: f64,
    /// Highest natural frequency of the model \[Hz\]; 0 if nothing vibrates.
    pub highest_hz: f64,
}

impl TimeStep {
    /// The step for a model with this highest natural frequency \[rad/s\], rounded down to two digits.
    pub(super) fn below(highest_rad_per_s: f64) -> Self {
        let longest_s = (USED * 2.0 / highest_rad_per_s).min(LONGEST_S);
        let digits_per_s = 10f64.powi(1 - libm::log10(longest_s).floor() as i32);
        // a step that has only two digits must not lose the last one to rounding
        let digits = (longest_s * digits_per_s * (1.0 + 1e-9)).floor();
        Self { step_s: digits / digits_per_s, highest_hz: highest_rad_per_s / TAU }
    }

    /// Whether a simulation needs more than ten times as many steps as with the longest step that a file states.
    pub(super) fn is_short(self) -> bool {
        self.step_s < 0.1 * LONGEST_S
    }
}

impl Moving<'_> {
    /// Highest natural frequency \[rad/s\] in the position of the model; 0 if nothing vibrates.
    pub(super) fn highest_rad_per_s(&self) -> f64 {
        let Some(cholesky) = Cholesky::new(self.mass_matrix()) else { return 0.0 };
        let lower = cholesky.l_dirty();
        let mut stiffness = DMatrix::<f64>::zeros(self.positions.len(), self.positions.len());
        for (stiff, terms) in &self.springs {
            for ((i, a), (j, b)) in terms.iter().flat_map(|a| terms.iter().map(move |b| (a, b))) {
                stiffness[(*i, *j)] += stiff * a * b;
            }
        }
        let squared = largest_eigenvalue(self.positions.len(), |vector| {
            let mut image: DVector<f64> = vector.clone();
            lower.tr_solve_lower_triangular_mut(&mut image);
            image = &stiffness * image;
            lower.solve_lower_triangular_mut(&mut image);
            image
        });
        squared.sqrt()
    }

    /// The mass matrix over all hinges.
    fn mass_matrix(&self) -> DMatrix<f64> {
        let mut placed = Isometry3::identity();
        let (mut twists, mut outboard_of): (Vec<Twist>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut inertias = Vec::with_capacity(self.nodes.len());
        for (at, (node, inertia)) in self.nodes.iter().zip(&self.inertias).enumerate() {
            for hinge in &node.hinges {
                let position = self.positions[twists.len()];
                twists.push(moved(&placed) * twist(hinge));
                outboard_of.push(at);
                placed *= turned(hinge, position);
            }
            let back = moved(&placed.inverse());
            inertias.push(back.transpose() * inertia * back);
        }
        for at in (1..inertias.len()).rev() {
            let outboard = inertias[at];
            inertias[at - 1] += outboard;
        }
        let mut mass = DMatrix::from_diagonal(&DVector::from_column_slice(&self.armatures_kgm2));
        for j in 0..twists.len() {
            let momentum = inertias[outboard_of[j]] * twists[j];
            for i in 0..=j {
                let entry = twists[i].dot(&momentum);
                mass[(i, j)] += entry;
                if i < j {
                    mass[(j, i)] += entry;
                }
            }
        }
        mass
    }
}

/// Motion of the body outboard of a hinge per unit of the hinge's position, at zero joint angles, as a twist about the
/// world's origin.
fn twist(hinge: &Hinge) -> Twist {
    match hinge.slides {
        true => stack(&hinge.axis, &Vector3::zeros()),
        false => rotation_twist(&hinge.axis, &hinge.at_m),
    }
}

/// The motion from position zero of a hinge to the position `by` \[rad, m\].
fn turned(hinge: &Hinge, by: f64) -> Isometry3<f64> {
    if hinge.slides {
        return Translation3::from(hinge.axis * by).into();
    }
    let rotation = UnitQuaternion::from_axis_angle(&Unit::new_normalize(hinge.axis), by);
    Isometry3::from_parts(Translation3::from(hinge.at_m - rotation * hinge.at_m), rotation)
}

/// The matrix that converts a twist whose axis is in its place at zero joint angles to the twist about the same axis
/// after the displacement `by`.
fn moved(by: &Isometry3<f64>) -> Matrix6<f64> {
    let mut out = Matrix6::zeros();
    for (i, mut column) in out.column_iter_mut().enumerate() {
        let unit = Twist::ith(i, 1.0);
        let spin = by.rotation * angular(&unit);
        column.copy_from(&stack(&(by.rotation * linear(&unit) + by.translation.vector.cross(&spin)), &spin));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::tree::Role;
    use super::*;
    use crate::mechanics::body_inertia;
    use nalgebra::Matrix3;

    #[test]
    fn steps_are_half_of_the_longest_stable_one_in_two_digits() {
        for (rad_per_s, step_s) in
            [(0.0, 1e-3), (100.0, 1e-3), (2e3, 5e-4), (1e4, 1e-4), (3e4, 3.3e-5), (4.5e6, 2.2e-7)]
        {
            let found = TimeStep::below(rad_per_s);
            assert!((found.step_s / step_s - 1.0).abs() < 1e-12, "{rad_per_s}: {found:?}");
            assert!(found.step_s * rad_per_s <= 1.0 + 1e-9);
        }
    }

    /// Two bodies that turn about parallel axes: the mass matrix by hand, and with it the highest frequency.
    #[test]
    fn two_turning_bodies_vibrate_as_by_hand() {
        let hinge = |x: f64| Hinge {
            name: String::new(),
            element: String::new(),
            axis: Vector3::z(),
            at_m: Vector3::new(x, 0.0, 0.0),
            slides: false,
            role: Role::Motor,
        };
        let node = |hinges| Node {
            name: String::new(),
            origin_m: Vector3::zeros(),
            hinges,
            inertia: Matrix6::zeros(),
            rods: Vec::new(),
        };
        let nodes = [node(vec![hinge(0.0)]), node(vec![hinge(0.5)])];
        let (angle, masses_kg, springs) = (0.7f64, [2.0, 3.0], [4e3, 9e3]);
        let inertias = vec![
            body_inertia(masses_kg[0], &Vector3::new(0.3, 0.0, 0.0), &Matrix3::identity()),
            body_inertia(masses_kg[1], &Vector3::new(0.9, 0.0, 0.0), &Matrix3::zeros()),
        ];
        let moving = Moving {
            nodes: &nodes,
            inertias,
            armatures_kgm2: vec![0.2, 0.0],
            positions: vec![1.1, angle],
            springs: springs.iter().enumerate().map(|(i, k)| (*k, vec![(i, 1.0)])).collect(),
        };
        let (a, b) = (0.5, 0.4);
        let outer = masses_kg[1] * b * b;
        let across = outer + masses_kg[1] * a * b * angle.cos();
        let inner =
            0.2 + 1.0 + masses_kg[0] * 0.09 + masses_kg[1] * (a * a + b * b + 2.0 * a * b * angle.cos());
        // det(K - x M) = 0, the larger root
        let (p, q) = (inner * outer - across * across, springs[0] * outer + springs[1] * inner);
        let x = (q + (q * q - 4.0 * p * springs[0] * springs[1]).sqrt()) / (2.0 * p);
        let found = moving.highest_rad_per_s();
        assert!((found / x.sqrt() - 1.0).abs() < 1e-12, "{found} {}", x.sqrt());
    }
}
