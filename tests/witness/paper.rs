//! The paper's dynamic model (Eqs 16 and 17), written out: three rigid links in a line, three springs.
//!
//! Unknowns are the absolute angles of the links. K is Eq 16's; M follows from Lagrange: a point at distance s along
//! link 2 moves by `l1 psi1 + s psi2`, the load by `l1 psi1 + l2 psi2 + l3 psi3`. Eq 17, det(K - w^2 M) = 0, is solved
//! as the cubic in w^2 that it is.

use std::f64::consts::TAU;

use super::closed_forms::cubic_roots;

/// What Eq 16 needs to know of the arm. Joint and link numbers as in the paper's Table 1.
#[derive(Clone, Copy, Debug)]
pub struct PaperArm {
    /// Joints 2, 3 and the wrist's.
    pub stiffness_nm_per_rad: [f64; 3],
    /// Links 1 and 2, and from the wrist to the load.
    pub length_m: [f64; 3],
    /// Mass per length of links 1 and 2.
    pub line_kg_per_m: [f64; 2],
    /// Rotary inertia per length of links 1 and 2.
    pub rotary_kgm: [f64; 2],
    pub elbow_kg: f64,
    pub wrist_kg: f64,
    pub load_kg: f64,
}

type Matrix3x3 = [[f64; 3]; 3];

impl PaperArm {
    /// Table 1, read literally: the load 5 cm beyond the wrist.
    pub fn table_1() -> Self {
        let (outer_m, density_kg_m3) = ([0.16_f64, 0.12], 7850.0);
        let hole = |outer_m: f64| outer_m - 0.02;
        let area_m2 = outer_m.map(|outer_m| outer_m.powi(2) - hole(outer_m).powi(2));
        let inertia_m4 = outer_m.map(|outer_m| (outer_m.powi(4) - hole(outer_m).powi(4)) / 12.0);
        Self {
            stiffness_nm_per_rad: [607e3, 405e3, 108e3],
            length_m: [0.8, 0.5, 0.05],
            line_kg_per_m: area_m2.map(|area_m2| density_kg_m3 * area_m2),
            rotary_kgm: inertia_m4.map(|inertia_m4| density_kg_m3 * inertia_m4),
            elbow_kg: 8.2,
            wrist_kg: 2.9 + 2.9 + 2.98,
            load_kg: 5.0,
        }
    }

    /// The same arm with one spring's stiffness multiplied.
    pub fn stiffened(mut self, spring: usize, factor: f64) -> Self {
        self.stiffness_nm_per_rad[spring] *= factor;
        self
    }

    /// K of Eq 16.
    pub fn stiffness(&self) -> Matrix3x3 {
        let [k2, k3, k4] = self.stiffness_nm_per_rad;
        [[k2 + k3, -k3, 0.0], [-k3, k3 + k4, -k4], [0.0, -k4, k4]]
    }

    /// M of Eq 16.
    pub fn mass(&self) -> Matrix3x3 {
        let [l1, l2, l3] = self.length_m;
        let [link1_kg, link2_kg] = [self.line_kg_per_m[0] * l1, self.line_kg_per_m[1] * l2];
        let hand_kg = self.wrist_kg + self.load_kg;
        let outboard1_kg = self.elbow_kg + link2_kg + hand_kg;
        let m11 = link1_kg * l1 * l1 / 3.0 + self.rotary_kgm[0] * l1 + outboard1_kg * l1 * l1;
        let m22 = link2_kg * l2 * l2 / 3.0 + self.rotary_kgm[1] * l2 + hand_kg * l2 * l2;
        let m12 = l1 * (link2_kg * l2 / 2.0 + hand_kg * l2);
        let (m13, m23, m33) = (self.load_kg * l1 * l3, self.load_kg * l2 * l3, self.load_kg * l3 * l3);
        [[m11, m12, m13], [m12, m22, m23], [m13, m23, m33]]
    }

    /// The three frequencies, from Eq 17.
    pub fn frequencies_hz(&self) -> [f64; 3] {
        let (k, m) = (self.stiffness(), self.mass());
        // det(K - x M) is a cubic in x; mixed determinants give its coefficients.
        let cubic = -determinant(&m);
        let square = mixed(&k, &m, 1);
        let linear = -mixed(&k, &m, 2);
        let constant = determinant(&k);
        cubic_roots(square / cubic, linear / cubic, constant / cubic).map(|omega2| omega2.sqrt() / TAU)
    }
}

fn determinant(a: &Matrix3x3) -> f64 {
    let minor = |i: usize, j: usize| a[1][i] * a[2][j] - a[1][j] * a[2][i];
    a[0][0] * minor(1, 2) - a[0][1] * minor(0, 2) + a[0][2] * minor(0, 1)
}

/// Sum of the determinants with `from_k` rows of K and the other rows of M.
fn mixed(k: &Matrix3x3, m: &Matrix3x3, from_k: u32) -> f64 {
    let choices = (0_u32..8).filter(|choice| choice.count_ones() == from_k);
    let rows = |choice: u32| [0, 1, 2].map(|row| if choice >> row & 1 == 1 { k[row] } else { m[row] });
    choices.map(|choice| determinant(&rows(choice))).sum()
}
