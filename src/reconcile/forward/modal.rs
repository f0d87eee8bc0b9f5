//! Natural frequencies by a reduced flexibility form, with exact sensitivities.
//!
//! Let `F` hold the inertia forces of the nominal arm's lowest modes, all coordinates included, those
//! without compliance too. The trial shapes `C F` are then right to first order in every compliance
//! and mass, and with `B = C F` the reduced problem is `BᵀM B z = μ FᵀB z`, `μ = 1/ω²`. From one
//! solution `x = B z` (scaled to `xᵀK x = 1`, `y = M x`) every parameter's effect follows:
//! `dμ = yᵀ dC y / μ + xᵀ dM x`.

use super::coefficients::{Coefficients, Layout};
use super::datum::{Datum, group_of};
use super::statics::PoseGeometry;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::subject::Subject;
use crate::arm::joint_law::{Curve, JointLaw};
use crate::arm::load::Payload;
use crate::mechanics::chain::Chain;
use crate::mechanics::chain::Posed;
use crate::mechanics::displacement_at;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::{Cholesky, DMatrix, DVector, Matrix3xX, SymmetricEigen, Vector3};
use std::f64::consts::TAU;

/// Trial shapes beyond the modes that are compared.
const SPARE_SHAPES: usize = 12;

/// Most that one frequency can cost when lists are compared \[squared standard deviations\].
const MISS: f64 = 400.0;

/// Most that one frequency can cost when its number is in question \[ln\]: what tolerance does to frequencies, and more.
const OFF: f64 = 0.05;

/// Fall from a mode to a higher one that noise does not make \[standard deviations of the difference\].
const UNMISTAKABLE: f64 = 5.0;

/// One pose and payload whose modes were listed.
pub struct ModalTest {
    geometry: PoseGeometry,
    payload: Payload,
    /// Datum and mode index (from 0) it is compared with.
    pub modes: Vec<(usize, usize)>,
    mass: DMatrix<f64>,
    /// Factors `L` of the matrices of a unit of each added mass, `L Lᵀ`: few columns, and only the rows of the
    /// coordinates that move it, those inboard of it.
    factors: Vec<DMatrix<f64>>,
    tip: Matrix3xX<f64>,
    spin: Matrix3xX<f64>,
    forces: DMatrix<f64>,
}

/// A solved mode.
pub struct Solved {
    /// `1/ω²`.
    pub mu: f64,
    /// Shape, strain energy ½ J.
    pub x: DVector<f64>,
    /// Its inertia forces.
    pub y: DVector<f64>,
}

/// Prepares the modal tests and appends their data.
pub fn prepare(
    campaign: &Campaign,
    layout: &Layout,
    nominal: &Subject,
    groups: &mut Vec<(Vec<f64>, String)>,
    data: &mut Vec<Datum>,
) -> Vec<ModalTest> {
    let mut tests: Vec<ModalTest> = Vec::new();
    let mut keys: Vec<(Vec<f64>, Payload)> = Vec::new();
    for row in &campaign.modal {
        let group = group_of(&row.pose_deg, groups);
        let key = (row.pose_deg.clone(), row.payload);
        // a repeated test starts a list of its own when a mode number comes again
        let found = keys
            .iter()
            .rposition(|k| *k == key)
            .filter(|&i| tests[i].modes.iter().all(|(_, mode)| *mode != row.mode - 1));
        let index = found.unwrap_or_else(|| {
            tests.push(ModalTest::new(layout, nominal, &row.pose_deg, &row.payload));
            keys.push(key);
            tests.len() - 1
        });
        tests[index].modes.push((data.len(), row.mode - 1));
        data.push(Datum {
            channel: Channel::Modal,
            row: row.row,
            component: 0,
            group,
            value: row.frequency_hz,
            sigma: row.sigma_hz,
        });
    }
    for test in &mut tests {
        test.refresh(layout, &Coefficients::new(layout, nominal, nominal));
    }
    tests
}

impl ModalTest {
    fn new(layout: &Layout, nominal: &Subject, pose_deg: &[f64], payload: &Payload) -> Self {
        let pose_rad: Vec<f64> = pose_deg.iter().map(|a| a.to_radians()).collect();
        let empty = Payload::default();
        let posed = layout.template.pose_rad(&pose_rad, &empty, Vector3::zeros());
        let mass = posed.mass_matrix();
        let added = |c: &Chain| c.pose_rad(&pose_rad, &empty, Vector3::zeros()).mass_matrix() - &mass;
        let factors = layout.with_mass.iter().map(|chain| factor(&added(chain))).collect();
        let (tip, spin) = tip_jacobians(&posed);
        Self {
            factors,
            geometry: PoseGeometry::new(layout, nominal, pose_deg),
            payload: *payload,
            modes: Vec::new(),
            mass,
            tip,
            spin,
            forces: DMatrix::zeros(layout.n, 0),
        }
    }

    /// How many modes must be solved for.
    pub fn mode_count(&self) -> usize {
        self.modes.iter().map(|(_, mode)| mode + 1).max().unwrap_or(0)
    }

    /// Takes the trial forces from the full solution for these coefficients; where so little yields that there are not
    /// enough, as in an arm whose links are taken for rigid, from the arm with links that yield as they are drawn and
    /// joints without a stiffness that yield like the softest.
    pub fn refresh(&mut self, layout: &Layout, coefficients: &Coefficients) {
        let mut compliances = self.compliances(layout, coefficients);
        let forces = self.trial_forces(layout, coefficients, &compliances);
        if forces.ncols() == self.wanted() {
            self.forces = forces;
            return;
        }
        let softest = layout.joints.iter().map(|joint| compliances[joint.twist]).fold(0.0, f64::max);
        for (own, drawn) in compliances.iter_mut().zip(&layout.lacking) {
            *own = if *own == 0.0 { *drawn } else { *own };
        }
        for joint in &layout.joints {
            let own = &mut compliances[joint.twist];
            *own = if *own == 0.0 { softest } else { *own };
        }
        self.forces = self.trial_forces(layout, coefficients, &compliances);
    }

    /// Trial shapes at the most.
    fn wanted(&self) -> usize {
        self.mode_count() + SPARE_SHAPES
    }

    /// The inertia forces of the lowest modes.
    fn trial_forces(
        &self,
        layout: &Layout,
        coefficients: &Coefficients,
        compliances: &[f64],
    ) -> DMatrix<f64> {
        let roots = DVector::from_iterator(layout.n, compliances.iter().map(|c| c.sqrt()));
        let mass = self.momenta(coefficients, &DMatrix::identity(layout.n, layout.n));
        let mut a = mass.clone();
        for (mut column, root) in a.column_iter_mut().zip(roots.iter()) {
            column.component_mul_assign(&roots);
            column *= *root;
        }
        let eigen = SymmetricEigen::new(a);
        let mut order: Vec<usize> = (0..layout.n).collect();
        order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]).then(i.cmp(&j)));
        let floor = 1e-12 * eigen.eigenvalues[order[0]];
        let columns: Vec<DVector<f64>> = order
            .iter()
            .filter(|&&i| eigen.eigenvalues[i] > floor)
            .take(self.wanted())
            .map(|&i| &mass * eigen.eigenvectors.column(i).component_mul(&roots) / eigen.eigenvalues[i])
            .collect();
        match columns.is_empty() {
            true => DMatrix::zeros(layout.n, 0), // nothing yields, so nothing swings
            false => DMatrix::from_columns(&columns),
        }
    }

    /// The mass matrix times shapes: the parts that parameters change are of low rank, so that the matrix itself
    /// need not be put together.
    fn momenta(&self, coefficients: &Coefficients, shapes: &DMatrix<f64>) -> DMatrix<f64> {
        let mut out = &self.mass * shapes;
        for (factor, amount) in self.factors.iter().zip(&coefficients.masses) {
            if *amount != 0.0 {
                let reach = factor.nrows();
                let moved = factor.tr_mul(&shapes.rows(0, reach));
                out.rows_mut(0, reach).gemm(*amount, factor, &moved, 1.0);
            }
        }
        let (mass_kg, jacobian) = self.payload_jacobian(coefficients);
        if mass_kg != 0.0 {
            out.gemm_tr(mass_kg, &jacobian, &(&jacobian * shapes), 1.0);
            let inertia = &self.payload.inertia_about_cg_kgm2;
            if *inertia != Vector3::zeros() {
                let local = self.geometry.rotation.matrix().transpose() * &self.spin;
                let mut turned = &local * shapes;
                turned.row_iter_mut().zip(inertia.iter()).for_each(|(mut row, i)| row *= *i);
                out.gemm_tr(1.0, &local, &turned, 1.0);
            }
        }
        out
    }

    /// Payload mass \[kg\] and the motion of its centre per coordinate.
    fn payload_jacobian(&self, coefficients: &Coefficients) -> (f64, Matrix3xX<f64>) {
        if self.payload.mass_kg == 0.0 {
            return (0.0, Matrix3xX::zeros(0));
        }
        let arm = self.geometry.rotation * (self.payload.cg_m + coefficients.payload_offset_m);
        (self.payload.mass_kg + coefficients.payload_delta_kg, &self.tip - arm.cross_matrix() * &self.spin)
    }

    /// Compliance of every coordinate, the joints' by the slope of their law at this test's torque.
    fn compliances(&self, layout: &Layout, coefficients: &Coefficients) -> Vec<f64> {
        let mut out = coefficients.linear.clone();
        let dead = self.geometry.dead_torques_nm(coefficients);
        let wrench =
            self.geometry.wrench(&self.payload, &Vector3::zeros(), layout.gravity_m_s2, coefficients);
        for (j, slot) in layout.joints.iter().enumerate() {
            let torque = dead[j] + self.geometry.joints[j].twist.dot(&wrench);
            out[slot.twist] = tangent(&coefficients.laws[j], torque, coefficients.smoothing);
        }
        out
    }

    /// Torques of the joints at this test \[N m\].
    pub fn torques_nm(&self, layout: &Layout, coefficients: &Coefficients) -> Vec<f64> {
        let dead = self.geometry.dead_torques_nm(coefficients);
        let wrench =
            self.geometry.wrench(&self.payload, &Vector3::zeros(), layout.gravity_m_s2, coefficients);
        self.geometry.joints.iter().zip(dead).map(|(m, t)| t + m.twist.dot(&wrench)).collect()
    }

    /// The lowest modes.
    pub fn solve(&self, layout: &Layout, coefficients: &Coefficients, count: usize) -> Vec<Solved> {
        if self.forces.ncols() == 0 {
            return Vec::new();
        }
        let compliances = self.compliances(layout, coefficients);
        let mut shapes = self.forces.clone();
        for mut column in shapes.column_iter_mut() {
            column.iter_mut().zip(&compliances).for_each(|(f, c)| *f *= c);
        }
        let momenta = self.momenta(coefficients, &shapes);
        // products with a transpose written out are the fast ones
        let reduced_mass = shapes.transpose() * &momenta;
        let strain = self.forces.transpose() * &shapes;
        let Some((amounts, a)) = unit_strains(strain, &reduced_mass) else { return Vec::new() };
        let eigen = SymmetricEigen::new((&a + a.transpose()) * 0.5);
        let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
        order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]).then(i.cmp(&j)));
        order
            .into_iter()
            .take(count)
            .filter_map(|i| {
                let z = amounts.of(&eigen.eigenvectors.column(i).into_owned())?;
                Some(Solved { mu: eigen.eigenvalues[i].max(1e-300), x: &shapes * &z, y: &momenta * &z })
            })
            .collect()
    }

    /// Whether a frequency is lower than that of a lower mode by more than noise.
    fn falls(&self, data: &[Datum]) -> bool {
        self.modes.iter().any(|(a, low)| {
            self.modes.iter().any(|(b, high)| {
                let (a, b) = (&data[*a], &data[*b]);
                low < high && a.value - b.value > UNMISTAKABLE * a.sigma.hypot(b.sigma)
            })
        })
    }

    /// Numbers the modes anew if the list falls by more than noise, unless these coefficients have it that one wrong
    /// frequency is the simpler cause; whether it did.
    pub fn put_in_order(&mut self, layout: &Layout, coefficients: &Coefficients, data: &[Datum]) -> bool {
        if !self.falls(data) {
            return false;
        }
        let spectrum = self.spectrum(layout, coefficients, self.mode_count());
        let cost = |modes: &[(usize, usize)]| -> f64 {
            let off = |&(datum, mode): &(usize, usize)| {
                spectrum.get(mode).map_or(OFF, |hz| (data[datum].value / hz).ln().abs().min(OFF))
            };
            modes.iter().map(off).sum()
        };
        let mut numbers: Vec<usize> = self.modes.iter().map(|(_, mode)| *mode).collect();
        numbers.sort_unstable();
        let mut rising = self.modes.clone();
        rising.sort_by(|(a, _), (b, _)| data[*a].value.total_cmp(&data[*b].value));
        rising.iter_mut().zip(numbers).for_each(|((_, mode), number)| *mode = number);
        let is_simpler = cost(&rising) <= cost(&self.modes);
        if is_simpler {
            self.modes = rising;
        }
        is_simpler
    }

    /// The lowest frequencies, as many \[Hz\].
    fn spectrum(&self, layout: &Layout, coefficients: &Coefficients, count: usize) -> Vec<f64> {
        self.solve(layout, coefficients, count).iter().map(|s| 1.0 / (TAU * s.mu.sqrt())).collect()
    }

    /// Whether one mode is missing from the measured list: if counting those above it one higher fits
    /// far better, they are counted so. Returns the number of the missed mode, from 1.
    pub fn find_missed_mode(
        &mut self,
        layout: &Layout,
        coefficients: &Coefficients,
        data: &[Datum],
    ) -> Option<usize> {
        let spectrum = self.spectrum(layout, coefficients, self.mode_count() + 1);
        let cost = |missed: usize| -> f64 {
            let miss = |&(datum, mode): &(usize, usize)| {
                let counted = if mode >= missed { mode + 1 } else { mode };
                let d: &Datum = &data[datum];
                spectrum.get(counted).map_or(MISS, |f| ((f - d.value) / d.sigma).powi(2).min(MISS))
            };
            self.modes.iter().map(miss).sum()
        };
        let none = cost(usize::MAX);
        let (best, missed) =
            (0..self.mode_count()).map(|m| (cost(m), m)).min_by(|a, b| a.0.total_cmp(&b.0))?;
        if none < best + MISS || best > 0.2 * none {
            return None;
        }
        self.modes.iter_mut().filter(|(_, mode)| *mode >= missed).for_each(|(_, mode)| *mode += 1);
        Some(missed + 1)
    }

    /// Frequencies of the compared modes \[Hz\].
    pub fn predict(&self, layout: &Layout, coefficients: &Coefficients, out: &mut [f64]) {
        let solved = self.solve(layout, coefficients, self.mode_count());
        self.write(&solved, out);
    }

    /// Writes the frequencies of solved modes; a mode the arm does not have is 0.
    pub fn write(&self, solved: &[Solved], out: &mut [f64]) {
        for &(datum, mode) in &self.modes {
            out[datum] = solved.get(mode).map_or(0.0, |s| 1.0 / (TAU * s.mu.sqrt()));
        }
    }

    /// `xᵀ M x` of a unit of an added mass.
    fn energy(&self, mass: usize, shape: &DVector<f64>) -> f64 {
        let factor = &self.factors[mass];
        factor.tr_mul(&shape.rows(0, factor.nrows())).norm_squared()
    }

    /// Change of the frequencies \[Hz\] from `from` to the near `to`, to first order.
    pub fn change(
        &self,
        layout: &Layout,
        solved: &[Solved],
        from: &Coefficients,
        to: &Coefficients,
        out: &mut [f64],
    ) {
        let (before, after) = (self.compliances(layout, from), self.compliances(layout, to));
        let masses: Vec<(usize, f64)> = from
            .masses
            .iter()
            .zip(&to.masses)
            .enumerate()
            .filter(|(_, (a, b))| a != b)
            .map(|(i, (a, b))| (i, b - a))
            .collect();
        let payload_moves =
            from.payload_delta_kg != to.payload_delta_kg || from.payload_offset_m != to.payload_offset_m;
        let payloads = payload_moves.then(|| (self.payload_jacobian(from), self.payload_jacobian(to)));
        for &(datum, mode) in &self.modes {
            let Some(s) = solved.get(mode) else { continue };
            let mut d_mu = 0.0;
            for (i, (a, b)) in before.iter().zip(&after).enumerate() {
                if a != b {
                    d_mu += s.y[i] * s.y[i] * (b - a) / s.mu;
                }
            }
            for (i, amount) in &masses {
                d_mu += amount * self.energy(*i, &s.x);
            }
            if let Some(((m0, j0), (m1, j1))) = payloads.as_ref().filter(|((m0, _), _)| *m0 != 0.0) {
                d_mu += m1 * (j1 * &s.x).norm_squared() - m0 * (j0 * &s.x).norm_squared();
            }
            out[datum] = -0.5 * d_mu / s.mu / (TAU * s.mu.sqrt());
        }
    }
}

/// How much of each trial shape makes combinations of unit strain energy that are free of each other.
enum UnitStrains {
    /// By the Cholesky factor of the strain energy.
    Factor(DMatrix<f64>),
    /// By columns, fewer than shapes: some shapes are others' combinations, where little yields.
    Columns(DMatrix<f64>),
}

/// Part of the largest strain energy below which a combination is rounding.
const RANK: f64 = 1e-10;

/// Pivots of a strain energy's factor further apart than this are rounding.
const SINGULAR: f64 = 1e-6;

/// Those combinations, and the reduced mass matrix in them.
fn unit_strains(strain: DMatrix<f64>, reduced_mass: &DMatrix<f64>) -> Option<(UnitStrains, DMatrix<f64>)> {
    if let Some(cholesky) = Cholesky::new(strain.clone()) {
        let l = cholesky.l();
        if l.diagonal().min() > SINGULAR * l.diagonal().max() {
            let half = l.solve_lower_triangular(reduced_mass)?;
            let a = l.solve_lower_triangular(&half.transpose())?;
            return Some((UnitStrains::Factor(l), a));
        }
    }
    let eigen = SymmetricEigen::new(strain);
    let floor = RANK * eigen.eigenvalues.max();
    let columns: Vec<DVector<f64>> = (0..eigen.eigenvalues.len())
        .filter(|&i| eigen.eigenvalues[i] > floor)
        .map(|i| eigen.eigenvectors.column(i) / eigen.eigenvalues[i].sqrt())
        .collect();
    if columns.is_empty() {
        return None;
    }
    let columns = DMatrix::from_columns(&columns);
    let a = columns.transpose() * reduced_mass * &columns;
    Some((UnitStrains::Columns(columns), a))
}

impl UnitStrains {
    /// A combination of them in the shapes.
    fn of(&self, combined: &DVector<f64>) -> Option<DVector<f64>> {
        match self {
            UnitStrains::Factor(l) => l.tr_solve_lower_triangular(combined),
            UnitStrains::Columns(columns) => Some(columns * combined),
        }
    }
}

/// Number of leading coordinates beyond which a symmetric matrix is zero.
fn leading(matrix: &DMatrix<f64>) -> usize {
    let floor = 1e-14 * matrix.amax();
    (0..matrix.nrows()).rev().find(|&i| matrix.row(i).amax() > floor).map_or(0, |i| i + 1)
}

/// Pivoted Cholesky factor of a positive semidefinite matrix: as many columns as its rank, and the leading rows
/// that are not zero.
fn factor(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let mut rest = matrix.clone();
    let floor = 1e-13 * matrix.diagonal().max();
    let mut columns = Vec::new();
    while columns.len() < matrix.nrows() {
        let pivot = rest.diagonal().imax();
        let size = rest[(pivot, pivot)];
        if size <= floor || size <= 0.0 {
            break;
        }
        let column = rest.column(pivot) / size.sqrt();
        rest.ger(-1.0, &column, &column, 1.0);
        columns.push(column);
    }
    match columns.is_empty() {
        true => DMatrix::zeros(0, 0),
        false => DMatrix::from_columns(&columns).rows(0, leading(matrix)).into_owned(),
    }
}

/// Slope of a joint's law, the steps of a gear's curve smoothed over `width` in ln of the torque.
fn tangent(law: &JointLaw, torque_nm: f64, width: f64) -> f64 {
    let Curve::Windup(w) = law.curve else { return law.tangent_compliance_rad_per_nm(torque_nm) };
    if width == 0.0 {
        return law.tangent_compliance_rad_per_nm(torque_nm);
    }
    let beyond = |t: f64| 0.5 * (1.0 + (((torque_nm.abs().max(1e-12)) / t).ln() / width).tanh());
    let (c1, c2, c3) = (1.0 / w.k1_nm_per_rad, 1.0 / w.k2_nm_per_rad, 1.0 / w.k3_nm_per_rad);
    let smooth = c1 + (c2 - c1) * beyond(w.t1_nm) + (c3 - c2) * beyond(w.t2_nm);
    let sharp = law.curve.tangent_compliance_rad_per_nm(torque_nm);
    law.tangent_compliance_rad_per_nm(torque_nm) - sharp + smooth
}

/// Motion of the tip and rotation of the last frame per coordinate.
fn tip_jacobians(posed: &Posed) -> (Matrix3xX<f64>, Matrix3xX<f64>) {
    let twists = posed.tip_twists();
    let tip: Vec<Vector3<f64>> = twists.iter().map(|t| displacement_at(t, &posed.tip_m)).collect();
    let spin: Vec<Vector3<f64>> = twists.iter().map(|t| t.fixed_rows::<3>(3).into_owned()).collect();
    (Matrix3xX::from_columns(&tip), Matrix3xX::from_columns(&spin))
}
