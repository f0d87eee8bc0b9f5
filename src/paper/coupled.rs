//! The paper's coupled masses and springs (Eqs 16 to 18), written separately from the general mechanics.
//!
//! The unknowns are the absolute angles ψ of three rigid links. The matrices follow from Lagrange's equations. In
//! them, m1, m2, I1 and I2 are the masses of the two tubes and their moments of inertia about their centres. The masses
//! of joint 3, of the wrist and of the load are m3, m_w and m_p. The lengths of the links are l1, l2 and l3. The
//! stiffnesses of joints 2, 3 and 4 are K2, K3 and K4.
//!
//! ```text
//! M11 = I1 + m1 l1²/4 + (m3 + m2 + m_w + m_p) l1²     K = | K2+K3  -K3     0  |
//! M12 = (m2/2 + m_w + m_p) l1 l2                          | -K3    K3+K4  -K4 |
//! M13 = m_p l1 l3                                         | 0      -K4     K4 |
//! M22 = I2 + m2 l2²/4 + (m_w + m_p) l2²
//! M23 = m_p l2 l3,  M33 = m_p l3²                     right side for a vertical tip force: [l1, l2, l3] F
//! ```
//!
//! Eq 17 requires `det(K - λ M) = 0`, a cubic in λ = ω². The numbers that the paper calls ω, in Hz, are frequencies f =
//! ω/2π.

use super::arm::PaperArm;
use crate::arm::joint_law::Curve;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// The matrices of Eq 16 for one arm.
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledArm {
    /// Mass matrix \[kg m²\].
    pub mass: Matrix3<f64>,
    /// Stiffness matrix \[N m/rad\].
    pub stiffness: Matrix3<f64>,
    /// Lengths l1, l2, l3 of the links \[m\].
    pub lengths_m: Vector3<f64>,
}

impl CoupledArm {
    /// Eq 16 for an arm with constant joint stiffnesses. For a joint with a torsion curve the middle slope K2 is
    /// used.
    pub fn new(arm: &PaperArm) -> Self {
        let [k2, k3, k4] = arm.curves.map(stiffness_nm_per_rad);
        let lengths_m = Vector3::new(arm.lengths_m[0], arm.lengths_m[1], arm.third_link_m);
        Self {
            mass: mass_matrix(arm, &lengths_m),
            stiffness: Matrix3::new(k2 + k3, -k3, 0.0, -k3, k3 + k4, -k4, 0.0, -k4, k4),
            lengths_m,
        }
    }

    /// The three frequencies \[Hz\] from Eq 17, lowest first.
    pub fn frequencies_hz(&self) -> [f64; 3] {
        cubic_roots(self.characteristic_cubic()).map(|lambda| lambda.sqrt() / TAU)
    }

    /// Coefficients of det(K - λ M), lowest power first. Each is a sum of determinants of K in which some columns are
    /// replaced by the columns of -M.
    pub fn characteristic_cubic(&self) -> [f64; 4] {
        let mut coefficients = [0.0; 4];
        for choice in 0..8u32 {
            let mut columns = self.stiffness;
            for column in (0..3).filter(|c| choice >> c & 1 == 1) {
                columns.set_column(column, &-self.mass.column(column));
            }
            coefficients[choice.count_ones() as usize] += columns.determinant();
        }
        coefficients
    }

    /// Static displacement of the tip per vertical force at the tip \[m/N\]. `right_side_m` is the right-hand side of
    /// Eq 16, divided by this force. `None` if the stiffness matrix is singular.
    pub fn tip_compliance_m_per_n(&self, right_side_m: &Vector3<f64>) -> Option<f64> {
        let angles = self.stiffness.lu().solve(right_side_m)?;
        Some(self.lengths_m.dot(&angles))
    }

    /// The right-hand side of Eq 16 as printed, [l2, l2, l3] \[m\].
    pub fn printed_right_side_m(&self) -> Vector3<f64> {
        Vector3::new(self.lengths_m.y, self.lengths_m.y, self.lengths_m.z)
    }
}

fn stiffness_nm_per_rad(curve: Curve) -> f64 {
    1.0 / curve.middle_slope().tangent_compliance_rad_per_nm(0.0)
}

fn mass_matrix(arm: &PaperArm, l: &Vector3<f64>) -> Matrix3<f64> {
    let tube = |i: usize| (arm.link_kg(i), tube_inertia_kgm2(arm, i));
    let ((m1, i1), (m2, i2)) = (tube(0), tube(1));
    let at_wrist = arm.wrist_kg + arm.load_kg;
    let m11 = i1 + m1 * l.x * l.x / 4.0 + (arm.joint_3_kg + m2 + at_wrist) * l.x * l.x;
    let m12 = (m2 / 2.0 + at_wrist) * l.x * l.y;
    let m22 = i2 + m2 * l.y * l.y / 4.0 + at_wrist * l.y * l.y;
    let (m13, m23, m33) = (arm.load_kg * l.x * l.z, arm.load_kg * l.y * l.z, arm.load_kg * l.z * l.z);
    Matrix3::new(m11, m12, m13, m12, m22, m23, m13, m23, m33)
}

/// Moment of inertia of a tube about an axis through its centre, at right angles to its own axis: m L²/12 + ρ I L \[kg
/// m²\].
fn tube_inertia_kgm2(arm: &PaperArm, link: usize) -> f64 {
    let length_m = arm.lengths_m[link];
    arm.link_kg(link) * length_m * length_m / 12.0
        + arm.material.density_kg_m3 * arm.second_moment_m4(link) * length_m
}

/// The three real roots of a cubic in ascending order, by Vieta's trigonometric form and then Newton's method.
fn cubic_roots([c0, c1, c2, c3]: [f64; 4]) -> [f64; 3] {
    let (a, b, c) = (c2 / c3, c1 / c3, c0 / c3);
    let p = (a * a - 3.0 * b) / 9.0;
    let q = (2.0 * a * a * a - 9.0 * a * b + 27.0 * c) / 54.0;
    let angle = libm::acos((q / libm::pow(p, 1.5)).clamp(-1.0, 1.0));
    let root = |k: f64| -2.0 * p.sqrt() * libm::cos((angle + TAU * k) / 3.0) - a / 3.0;
    let mut roots = [0.0, 1.0, -1.0].map(root).map(|x| polish([c, b, a], x));
    roots.sort_by(f64::total_cmp);
    roots
}

/// The root of `x³ + a x² + b x + c` that Newton's method finds from `start`.
fn polish([c, b, a]: [f64; 3], start: f64) -> f64 {
    (0..4).fold(start, |x, _| {
        let value = ((x + a) * x + b) * x + c;
        let slope = (3.0 * x + 2.0 * a) * x + b;
        if slope == 0.0 { x } else { x - value / slope }
    })
}

/// Eq 18: natural frequency of one spring with one mass \[Hz\].
pub fn single_spring_hz(stiffness_n_per_m: f64, mass_kg: f64) -> f64 {
    (stiffness_n_per_m / mass_kg).sqrt() / TAU
}

/// Changes masses of an arm so that its three frequencies become `wanted_hz`. The third spring stays unchanged.
///
/// The unknowns are the wrist mass, the load mass and the distance of the load. Newton's method on their logarithms
/// starts from the values that the arm has. No step changes an unknown by more than a tenth. `None` if the three
/// frequencies cannot be reached with this spring.
pub fn masses_that_give(arm: &PaperArm, wanted_hz: [f64; 3]) -> Option<PaperArm> {
    let wanted = Vector3::from(wanted_hz.map(libm::log));
    let mut x = Vector3::new(libm::log(arm.wrist_kg), libm::log(arm.load_kg), libm::log(arm.third_link_m));
    for _ in 0..400 {
        let here = log_frequencies(arm, &x);
        let gap = wanted - here;
        if gap.amax() < 1e-13 {
            return Some(with_masses(arm, &x));
        }
        let jacobian = Matrix3::from_columns(&[0, 1, 2].map(|i| {
            let mut step = Vector3::zeros();
            step[i] = 1e-6;
            (log_frequencies(arm, &(x + step)) - log_frequencies(arm, &(x - step))) / 2e-6
        }));
        let step = jacobian.lu().solve(&gap)?;
        x += step * (0.1 / step.amax()).min(1.0);
        if x.amax() > 12.0 || !x.amax().is_finite() {
            return None;
        }
    }
    // rounding may prevent the last digit from converging, so a looser tolerance decides
    let found = with_masses(arm, &x);
    let gap = (log_frequencies(arm, &x) - wanted).amax();
    (gap < 1e-9).then_some(found)
}

fn with_masses(arm: &PaperArm, x: &Vector3<f64>) -> PaperArm {
    PaperArm {
        wrist_kg: libm::exp(x.x),
        load_kg: libm::exp(x.y),
        third_link_m: libm::exp(x.z),
        ..arm.clone()
    }
}

fn log_frequencies(arm: &PaperArm, x: &Vector3<f64>) -> Vector3<f64> {
    Vector3::from(CoupledArm::new(&with_masses(arm, x)).frequencies_hz().map(libm::log))
}
