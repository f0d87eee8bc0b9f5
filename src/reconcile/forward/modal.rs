//! Predicts natural frequencies by a reduced flexibility form, with exact derivatives.
//!
//! Let the columns of `F` be the inertia forces of the nominal arm's lowest modes, with an entry for every coordinate,
//! even one without compliance. The trial shapes `C F` are then correct to first order in every compliance and mass.
//! Here `C` is the diagonal matrix of the compliances, `K` its inverse and `M` the mass matrix. With `B = C F` the
//! reduced problem is `BᵀM B z = μ FᵀB z`, where `μ = 1/ω²`. One solution `x = B z`, scaled to `xᵀK x = 1`, with
//! `y = M x`, gives the effect of every parameter: `dμ = yᵀ dC y / μ + xᵀ dM x`.

use super::added_mass::Factor;
use super::coefficients::{Coefficients, Layout};
use super::datum::{Datum, Groups};
use super::statics::PoseGeometry;
use super::tangents::{lifted_tangent, tangent};
use crate::arm::effect::channel::Channel;
use crate::arm::effect::subject::Subject;
use crate::arm::effect::warming::Moment;
use crate::arm::load::Payload;
use crate::mechanics::chain::Chain;
use crate::mechanics::chain::Posed;
use crate::mechanics::eigenpairs::Eigenpairs;
use crate::mechanics::product::{Panels, symmetric_product};
use crate::mechanics::{Wrench, displacement_at};
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::rows::ModalRow;
use nalgebra::{Cholesky, DMatrix, DVector, Matrix3xX, SymmetricEigen, Vector3};
use std::f64::consts::TAU;

/// Number of trial shapes that are used in addition to the number of measured modes.
const SPARE_SHAPES: usize = 12;

/// Upper limit of the cost of one frequency (its squared residual) when two numberings of a list are compared
/// \[squared standard deviations\].
const LARGEST_COST: f64 = 400.0;

/// Upper limit of the misfit of one frequency when two numberings of a list are compared to put it in order. The misfit
/// is the magnitude of the logarithm of measured over predicted frequency. The limit is larger than the misfit that a
/// change of stiffnesses and masses within tolerance causes.
const LARGEST_LOG_RATIO: f64 = 0.05;

/// A list is out of order if a mode has a frequency lower than that of a mode with a smaller number, by more than
/// this \[standard deviations of the difference\]. Noise does not produce such a fall.
const OUT_OF_ORDER_SIGMAS: f64 = 5.0;

/// The modal test of one pose and payload: the list of its measured modes, and what their computation needs.
pub struct ModalTest {
    /// Geometry of the pose.
    pub(crate) geometry: PoseGeometry,
    payload: Payload,
    /// Time and temperature of the first mode of the list.
    when: Moment,
    /// For each datum of the list: its index, and the number of its mode, from 0.
    pub modes: Vec<(usize, usize)>,
    /// Mass matrix of the nominal arm without payload, arranged in memory for matrix products.
    mass: Panels,
    /// For each added mass, the factor `L` of its mass matrix `L Lᵀ`. A factor has few columns, and only the rows of
    /// coordinates inboard of the mass.
    factors: Vec<Factor>,
    tip: Matrix3xX<f64>,
    spin: Matrix3xX<f64>,
    forces: DMatrix<f64>,
}

/// One vibration mode that was solved for.
pub struct Solved {
    /// Eigenvalue `μ = 1/ω²`, the reciprocal of the squared angular frequency \[s²\].
    pub mu: f64,
    /// Mode shape, scaled to a strain energy of 0.5 J.
    pub x: DVector<f64>,
    /// Mass matrix times mode shape: the amplitudes of the inertia forces at an angular frequency of 1 rad/s.
    pub y: DVector<f64>,
}

/// Prepares the modal tests (one for each pose and payload) of a campaign, and appends their readings to `data`.
pub(crate) fn prepare(
    campaign: &Campaign,
    layout: &Layout,
    nominal: &Subject,
    groups: &mut Groups,
    data: &mut Vec<Datum>,
) -> Vec<ModalTest> {
    let mut tests: Vec<ModalTest> = Vec::new();
    let mut keys: Vec<(Vec<f64>, Payload)> = Vec::new();
    for (row_index, row) in campaign.modal.iter().enumerate() {
        let group = groups.of(&row.pose_deg);
        let key = (row.pose_deg.clone(), row.payload);
        // A mode number that occurs again starts another list, because the test was repeated.
        let found = keys
            .iter()
            .rposition(|k| *k == key)
            .filter(|&i| tests[i].modes.iter().all(|(_, mode)| *mode != row.mode - 1));
        let index = found.unwrap_or_else(|| {
            tests.push(ModalTest::new(layout, nominal, row));
            keys.push(key);
            tests.len() - 1
        });
        tests[index].modes.push((data.len(), row.mode - 1));
        data.push(Datum {
            channel: Channel::Modal,
            row: row.row,
            index: row_index,
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
    fn new(layout: &Layout, nominal: &Subject, row: &ModalRow) -> Self {
        let pose_rad = nominal.standing_rad(layout.template.pose_si(&row.pose_deg));
        let empty = Payload::default();
        let posed = layout.template.pose_rad(&pose_rad, &empty, Vector3::zeros());
        let mass = posed.mass_matrix();
        let added = |c: &Chain| c.pose_rad(&pose_rad, &empty, Vector3::zeros()).mass_matrix() - &mass;
        let factors = layout.with_mass.iter().map(|chain| Factor::of(&added(chain))).collect();
        let TipJacobians { tip, spin } = tip_jacobians(&posed);
        Self {
            factors,
            geometry: PoseGeometry::new(layout, nominal, &row.pose_deg),
            payload: row.payload,
            when: row.moment(),
            modes: Vec::new(),
            mass: Panels::of_rows(&mass),
            tip,
            spin,
            forces: DMatrix::zeros(layout.n, 0),
        }
    }

    /// The first row of the list in its file, from 0.
    pub(crate) fn first_row(&self) -> usize {
        self.when.row
    }

    /// Number of modes that must be computed: the highest mode number in the list.
    pub fn mode_count(&self) -> usize {
        self.modes.iter().map(|(_, mode)| mode + 1).max().unwrap_or(0)
    }

    /// Computes the trial forces `F` (inertia forces of the lowest modes) from the full eigenvalue problem with these
    /// coefficients.
    ///
    /// If few coordinates are compliant, as in an arm with rigid links, there may be too few trial forces. They then
    /// come from an arm whose links have the compliance that follows from their sections, and whose rigid joints have
    /// the compliance of the softest joint.
    pub fn refresh(&mut self, layout: &Layout, coefficients: &Coefficients) {
        let mut compliances = self.compliances(layout, coefficients);
        let forces = self.trial_forces(layout, coefficients, &compliances);
        if forces.ncols() == self.wanted() {
            self.forces = forces;
            return;
        }
        // a rigid joint to which an effect may give compliance needs a trial shape too
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

    /// Number of trial shapes to use: the number of modes and some more. There may be fewer if few coordinates are
    /// compliant.
    fn wanted(&self) -> usize {
        self.mode_count() + SPARE_SHAPES
    }

    /// The trial forces `F`: the inertia forces of the lowest modes of an arm with these `compliances`, one column
    /// per mode.
    fn trial_forces(
        &self,
        layout: &Layout,
        coefficients: &Coefficients,
        compliances: &[f64],
    ) -> DMatrix<f64> {
        // C^½ M C^½ has the eigenvalues 1/ω² and stays symmetric where some compliances are zero
        let roots = DVector::from_iterator(layout.n, compliances.iter().map(|c| c.sqrt()));
        let mass = self.momenta(coefficients, &DMatrix::identity(layout.n, layout.n));
        let mut a = mass.clone();
        for (mut column, root) in a.column_iter_mut().zip(roots.iter()) {
            column.component_mul_assign(&roots);
            column *= *root;
        }
        let eigen = Eigenpairs::largest(a, self.wanted());
        // smaller eigenvalues are rounding error and would give meaningless shapes
        let floor = 1e-12 * eigen.values.first().copied().unwrap_or(0.0);
        let pairs = eigen.values.iter().zip(&eigen.vectors);
        let columns: Vec<DVector<f64>> = pairs
            .filter(|(value, _)| **value > floor)
            .map(|(value, vector)| &mass * vector.component_mul(&roots) / *value)
            .collect();
        match columns.is_empty() {
            true => DMatrix::zeros(layout.n, 0), // without compliance there are no modes
            false => DMatrix::from_columns(&columns),
        }
    }

    /// The mass matrix times the given `shapes`. The parts of the matrix that parameters change have a low rank, so
    /// the matrix itself need not be assembled.
    fn momenta(&self, coefficients: &Coefficients, shapes: &DMatrix<f64>) -> DMatrix<f64> {
        let mut out = self.mass.times(shapes.as_view());
        for (factor, amount) in self.factors.iter().zip(&coefficients.masses) {
            if *amount != 0.0 {
                let moved = factor.across.times(shapes.rows(0, factor.l.nrows())) * *amount;
                factor.down.add_times(&mut out, moved.as_view());
            }
        }
        let (hung_kg, jacobian) = self.hung_jacobian(coefficients);
        if hung_kg != 0.0 {
            out.gemm_tr(hung_kg, &jacobian, &(&jacobian * shapes), 1.0);
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

    /// Mass of the payload \[kg\], and the displacement of its centre of gravity per unit of each strain coordinate.
    fn payload_jacobian(&self, coefficients: &Coefficients) -> (f64, Matrix3xX<f64>) {
        if self.payload.mass_kg == 0.0 {
            return (0.0, Matrix3xX::zeros(0));
        }
        let offset_m = coefficients.payload_offset_in(Channel::Modal, self.when.row);
        let arm = self.geometry.rotation * (self.payload.cg_m + offset_m);
        (self.payload.mass_kg + coefficients.payload_delta_kg, &self.tip - arm.cross_matrix() * &self.spin)
    }

    /// The additional mass at the tip in modal tests \[kg\], and the displacement of its centre of gravity per unit
    /// of each strain coordinate.
    fn hung_jacobian(&self, coefficients: &Coefficients) -> (f64, Matrix3xX<f64>) {
        let test = &coefficients.tests[Channel::Modal as usize];
        match test.mass_kg {
            0.0 => (0.0, Matrix3xX::zeros(0)),
            kg => (kg, &self.tip - (self.geometry.rotation * test.cg_m).cross_matrix() * &self.spin),
        }
    }

    /// Compliance of every strain coordinate in this test. For a joint's torsion it is the slope of its torsion law
    /// at the static torque of this test.
    fn compliances(&self, layout: &Layout, coefficients: &Coefficients) -> Vec<f64> {
        let mut out = coefficients.linear.clone();
        if !coefficients.warming.is_none() {
            let factor = coefficients.warming.factor(&self.when);
            let strains = layout.links.iter().flat_map(|link| link.first..link.first + link.strains.len());
            strains.for_each(|i| out[i] /= factor);
        }
        let dead = self.geometry.dead_torques_nm(coefficients, layout, Channel::Modal);
        let wrench = self.wrench(layout, coefficients);
        if let Some(lift) = coefficients.lift {
            let moments_nm = self.base_moments_nm(layout, coefficients, &wrench);
            (0..2).for_each(|i| out[i] += lifted_tangent(&lift, moments_nm[i], coefficients.smoothing));
        }
        for (j, slot) in layout.joints.iter().enumerate() {
            let torque = dead[j] + self.geometry.joints[j].twist.dot(&wrench);
            let law = coefficients.law_at(j, Channel::Modal, self.geometry.angles_rad[j], self.when.row);
            out[slot.twist] = tangent(&law, torque, coefficients.smoothing);
        }
        out
    }

    /// Weight of the payload in this test, as a wrench about the world's origin.
    pub(crate) fn wrench(&self, layout: &Layout, coefficients: &Coefficients) -> Wrench {
        let at = (Channel::Modal, self.when.row);
        self.geometry.wrench(&self.payload, &Vector3::zeros(), layout.gravity_m_s2, coefficients, at)
    }

    /// Static moments on the base about world x and y in this test \[N m\]. `wrench` is the weight of the payload.
    fn base_moments_nm(&self, layout: &Layout, coefficients: &Coefficients, wrench: &Wrench) -> [f64; 2] {
        let dead = self.geometry.dead_base_nm(coefficients, layout, Channel::Modal);
        [0, 1].map(|i| dead[i] + self.geometry.base[i].twist.dot(wrench))
    }

    /// Static torques on the joints of an arm with these coefficients in this test, base to tip \[N m\].
    pub fn torques_nm(&self, layout: &Layout, coefficients: &Coefficients) -> Vec<f64> {
        let dead = self.geometry.dead_torques_nm(coefficients, layout, Channel::Modal);
        let wrench = self.wrench(layout, coefficients);
        self.geometry.joints.iter().zip(dead).map(|(m, t)| t + m.twist.dot(&wrench)).collect()
    }

    /// The `count` lowest modes of an arm with these coefficients in this test, lowest first. There are fewer if the
    /// arm has fewer.
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
        let reduced_mass = symmetric_product(&shapes, &momenta);
        let strain = symmetric_product(&self.forces, &shapes);
        let Some((amounts, a)) = unit_strains(strain, &reduced_mass) else { return Vec::new() };
        let eigen = Eigenpairs::largest(a, count);
        let pairs = eigen.values.iter().zip(&eigen.vectors);
        pairs
            .filter_map(|(mu, vector)| {
                let z = amounts.of(vector)?;
                Some(Solved { mu: mu.max(1e-300), x: &shapes * &z, y: &momenta * &z })
            })
            .collect()
    }

    /// Whether the modes of this test are surely the same for two arms, given by their coefficients `from` and `to`.
    pub(crate) fn same_modes(&self, layout: &Layout, from: &Coefficients, to: &Coefficients) -> bool {
        from.masses == to.masses
            && from.payload_delta_kg == to.payload_delta_kg
            && from.payload_offset_m == to.payload_offset_m
            && from.tests[Channel::Modal as usize] == to.tests[Channel::Modal as usize]
            && self.compliances(layout, from) == self.compliances(layout, to)
    }

    /// Whether some measured frequency is lower than the frequency of a mode with a smaller number, by more than
    /// noise explains.
    fn falls(&self, data: &[Datum]) -> bool {
        self.modes.iter().any(|(a, low)| {
            self.modes.iter().any(|(b, high)| {
                let (a, b) = (&data[*a], &data[*b]);
                low < high && a.value - b.value > OUT_OF_ORDER_SIGMAS * libm::hypot(a.sigma, b.sigma)
            })
        })
    }

    /// Renumbers the modes by rising frequency if the list is out of order by more than noise explains, and returns
    /// whether it did. The list is not changed if its present numbering fits the frequencies predicted with these
    /// coefficients better: then a single frequency is wrong.
    pub fn put_in_order(&mut self, layout: &Layout, coefficients: &Coefficients, data: &[Datum]) -> bool {
        if !self.falls(data) {
            return false;
        }
        let spectrum = self.spectrum(layout, coefficients, self.mode_count());
        let cost = |modes: &[(usize, usize)]| -> f64 {
            let off = |&(datum, mode): &(usize, usize)| {
                spectrum.get(mode).map_or(LARGEST_LOG_RATIO, |hz| {
                    libm::log(data[datum].value / hz).abs().min(LARGEST_LOG_RATIO)
                })
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

    /// The `count` lowest natural frequencies of an arm with these coefficients in this test, lowest first \[Hz\].
    fn spectrum(&self, layout: &Layout, coefficients: &Coefficients, count: usize) -> Vec<f64> {
        self.solve(layout, coefficients, count).iter().map(|s| 1.0 / (TAU * s.mu.sqrt())).collect()
    }

    /// Finds a mode that is missing from the measured list. If the list fits the predicted frequencies far better
    /// with all later modes numbered one higher, they are renumbered. Returns the number of the missing mode, counted
    /// from 1, or `None`.
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
                spectrum
                    .get(counted)
                    .map_or(LARGEST_COST, |f| ((f - d.value) / d.sigma).powi(2).min(LARGEST_COST))
            };
            self.modes.iter().map(miss).sum()
        };
        // the cost of the list with its present numbering
        let none = cost(usize::MAX);
        let (best, missed) =
            (0..self.mode_count()).map(|m| (cost(m), m)).min_by(|a, b| a.0.total_cmp(&b.0))?;
        // renumbering must remove one full error and most of the misfit; a smaller gain could come from noise
        if none < best + LARGEST_COST || best > 0.2 * none {
            return None;
        }
        self.modes.iter_mut().filter(|(_, mode)| *mode >= missed).for_each(|(_, mode)| *mode += 1);
        Some(missed + 1)
    }

    /// Solves for the modes of this test, and writes the frequencies of the measured ones to their data in `out`
    /// \[Hz\].
    pub fn predict(&self, layout: &Layout, coefficients: &Coefficients, out: &mut [f64]) {
        let solved = self.solve(layout, coefficients, self.mode_count());
        self.write(&solved, out);
    }

    /// Writes the frequencies of the modes `solved` to the data of this test in `out` \[Hz\]. A measured mode that
    /// the arm does not have gets 0.
    pub fn write(&self, solved: &[Solved], out: &mut [f64]) {
        for &(datum, mode) in &self.modes {
            out[datum] = solved.get(mode).map_or(0.0, |s| 1.0 / (TAU * s.mu.sqrt()));
        }
    }

    /// The product `xᵀ M x` of a mode shape `x` with `M`, the mass matrix of one unit of the added mass with index
    /// `mass`.
    fn energy(&self, mass: usize, shape: &DVector<f64>) -> f64 {
        let factor = &self.factors[mass].l;
        factor.tr_mul(&shape.rows(0, factor.nrows())).norm_squared()
    }

    /// Writes to `out` the linearized change of the frequencies of this test if the coefficients change a little,
    /// from `from` to `to` \[Hz\]. `solved` are the modes with `from`.
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
        let [before_m, after_m] = [from, to].map(|c| c.payload_offset_in(Channel::Modal, self.when.row));
        let payload_moves = from.payload_delta_kg != to.payload_delta_kg || before_m != after_m;
        let payloads = payload_moves.then(|| (self.payload_jacobian(from), self.payload_jacobian(to)));
        let tests = [from, to].map(|c| &c.tests[Channel::Modal as usize]);
        let hung = (tests[0] != tests[1]).then(|| (self.hung_jacobian(from), self.hung_jacobian(to)));
        // twice the kinetic energy of a mass at an angular frequency of 1 rad/s
        let swing = |(kg, jacobian): &(f64, Matrix3xX<f64>), x: &DVector<f64>| match *kg {
            0.0 => 0.0,
            kg => kg * (jacobian * x).norm_squared(),
        };
        for &(datum, mode) in &self.modes {
            let Some(s) = solved.get(mode) else { continue };
            // first-order perturbation of the eigenvalue; the shape itself need not be solved again
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
            if let Some((before, after)) = &hung {
                d_mu += swing(after, &s.x) - swing(before, &s.x);
            }
            out[datum] = -0.5 * d_mu / s.mu / (TAU * s.mu.sqrt());
        }
    }
}

/// A basis of the trial shapes in which the matrix of strain energies is the unit matrix. In this basis the reduced
/// problem is an ordinary symmetric eigenvalue problem.
enum UnitStrains {
    /// The Cholesky factor of the matrix of strain energies. The basis is the inverse transpose of this factor.
    Factor(DMatrix<f64>),
    /// The basis itself, with fewer columns than trial shapes. It is needed if some shapes are linear combinations of
    /// others, as where few coordinates are compliant.
    Columns(DMatrix<f64>),
}

/// A combination of trial shapes is taken as a rounding error, and is dropped, if its strain energy is less than this
/// fraction of the largest strain energy of a combination.
const LEAST_ENERGY: f64 = 1e-10;

/// A Cholesky factor is taken as singular if the ratio of its smallest to its largest pivot is below this.
const SINGULAR_PIVOT_RATIO: f64 = 1e-6;

/// The basis in which the strain energy matrix `strain` becomes the unit matrix, and the reduced mass matrix in this
/// basis. `None` if there is no strain energy.
fn unit_strains(strain: DMatrix<f64>, reduced_mass: &DMatrix<f64>) -> Option<(UnitStrains, DMatrix<f64>)> {
    if let Some(cholesky) = Cholesky::new(strain.clone()) {
        let l = cholesky.l();
        if l.diagonal().min() > SINGULAR_PIVOT_RATIO * l.diagonal().max() {
            let half = l.solve_lower_triangular(reduced_mass)?;
            let a = l.solve_lower_triangular(&half.transpose())?;
            return Some((UnitStrains::Factor(l), a));
        }
    }
    let eigen = SymmetricEigen::new(strain);
    let floor = LEAST_ENERGY * eigen.eigenvalues.max();
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
    /// Converts a vector of amounts in this basis into amounts of the trial shapes. `None` if the factor is singular.
    fn of(&self, combined: &DVector<f64>) -> Option<DVector<f64>> {
        match self {
            UnitStrains::Factor(l) => l.tr_solve_lower_triangular(combined),
            UnitStrains::Columns(columns) => Some(columns * combined),
        }
    }
}

/// Motions of the last frame per unit of each strain coordinate.
struct TipJacobians {
    /// Displacement of the tip.
    tip: Matrix3xX<f64>,
    /// Rotation of the last frame.
    spin: Matrix3xX<f64>,
}

fn tip_jacobians(posed: &Posed) -> TipJacobians {
    let twists = posed.tip_twists();
    let tip: Vec<Vector3<f64>> = twists.iter().map(|t| displacement_at(t, &posed.tip_m)).collect();
    let spin: Vec<Vector3<f64>> = twists.iter().map(|t| t.fixed_rows::<3>(3).into_owned()).collect();
    TipJacobians { tip: Matrix3xX::from_columns(&tip), spin: Matrix3xX::from_columns(&spin) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::reconcile::forward::prepared::Forward;
    use std::path::Path;

    #[test]
    fn added_masses_move_as_their_mass_matrices_say() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        let forward = Forward::new(&campaign);
        let (layout, test) = (&forward.layout, &forward.modal[0]);
        let mut coefficients = forward.coefficients(&forward.nominal);
        let identity = DMatrix::identity(layout.n, layout.n);
        let before = test.momenta(&coefficients, &identity);
        let amounts = [(1, 0.7), (4, -0.2), (layout.joints.len() + 1, 1.3)];
        amounts.iter().for_each(|(mass, amount)| coefficients.masses[*mass] += amount);
        let added = test.momenta(&coefficients, &identity) - before;
        let pose_rad: Vec<f64> = campaign.modal[0].pose_deg.iter().map(|a| a.to_radians()).collect();
        let matrix = |chain: &Chain| {
            chain.pose_rad(&pose_rad, &Payload::default(), Vector3::zeros()).mass_matrix()
                - test.mass.times(identity.as_view())
        };
        let direct: DMatrix<f64> =
            amounts.iter().map(|(mass, amount)| matrix(&layout.with_mass[*mass]) * *amount).sum();
        assert!((&added - &direct).amax() < 1e-10 * direct.amax(), "{}", (added - &direct).amax());
    }
}
