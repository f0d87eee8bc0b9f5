//! Statics and modes of a model.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SymmetricEigen, Vector3};
use std::f64::consts::TAU;

use super::beam::Matrix12;
use super::model::{Model, Piece};
use super::nodes::NodeMap;

/// Unknowns up to which all modes are computed at once.
const SMALL_MODEL: usize = 60;
/// Modes whose period is a millionth of the longest one come from masses of nothing.
const LEAST_PERIOD_RATIO: f64 = 1e-6;

/// One free vibration.
#[derive(Clone, Debug)]
pub struct Mode {
    pub frequency_hz: f64,
    /// Share of the kinetic energy in the motion within a world plane: `[xy, xz, yz]`.
    pub plane_share: [f64; 3],
    /// Share of the strain energy in each compliant element, summing to 1.
    pub strain_energy: Vec<(String, f64)>,
}

/// What the witness says of an arm in a load case.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Position under load minus position of the weightless arm, world axes.
    pub tip_displacement_m: Vector3<f64>,
    /// Torque of the loads about each joint's axis, which its spring balances; base to tip.
    pub joint_torque_nm: Vec<(String, f64)>,
    /// The lowest modes, sorted.
    pub modes: Vec<Mode>,
}

impl Answer {
    /// The lowest frequencies.
    pub fn frequencies_hz(&self) -> Vec<f64> {
        self.modes.iter().map(|mode| mode.frequency_hz).collect()
    }

    /// Frequencies of the modes that move within the world x-z plane.
    pub fn xz_frequencies_hz(&self) -> Vec<f64> {
        let in_plane = self.modes.iter().filter(|mode| mode.plane_share[1] > 0.5);
        in_plane.map(|mode| mode.frequency_hz).collect()
    }

    /// The torque of one joint.
    pub fn torque_nm(&self, joint: &str) -> f64 {
        let found = self.joint_torque_nm.iter().find(|(name, _)| name == joint);
        found.unwrap_or_else(|| panic!("no joint {joint}")).1
    }
}

/// Solve the model; `modes` is the most modes wanted.
pub fn answer(model: &Model, modes: usize) -> Answer {
    let displaced = static_unknowns(model);
    Answer {
        tip_displacement_m: translation(&model.tip, &displaced),
        joint_torque_nm: torques(model, &displaced),
        modes: if modes == 0 || model.unknowns == 0 { Vec::new() } else { lowest_modes(model, modes) },
    }
}

fn translation(node: &NodeMap, unknowns: &DVector<f64>) -> Vector3<f64> {
    node.displacement(unknowns.as_slice()).fixed_rows::<3>(0).into_owned()
}

fn static_unknowns(model: &Model) -> DVector<f64> {
    if model.unknowns == 0 {
        return DVector::zeros(0);
    }
    let mut stiffness = assembled(model, |piece| &piece.stiffness);
    for spring in &model.springs {
        stiffness[(spring.unknown, spring.unknown)] += spring.secant_nm_per_rad;
    }
    factored(stiffness).solve(&model.generalized_load())
}

/// Spring torques of the joints that have a spring, equilibrium for the rigid ones.
fn torques(model: &Model, displaced: &DVector<f64>) -> Vec<(String, f64)> {
    let spring_torque_nm = |unknown: usize| {
        let springs = model.springs.iter().filter(|spring| spring.unknown == unknown);
        springs.map(|spring| spring.secant_nm_per_rad * displaced[unknown]).sum()
    };
    let torque = |station: &super::model::Station| {
        let torque_nm =
            station.unknown.map_or_else(|| model.equilibrium_torque_nm(station), spring_torque_nm);
        (station.name.clone(), torque_nm)
    };
    model.stations.iter().map(torque).collect()
}

fn factored(stiffness: DMatrix<f64>) -> Cholesky<f64, Dyn> {
    Cholesky::new(stiffness).expect("a clamped chain of springs and beams is positive definite")
}

/// The sum of the pieces' matrices on the unknowns.
fn assembled(model: &Model, matrix_of: impl Fn(&Piece) -> &Matrix12) -> DMatrix<f64> {
    let mut sum = DMatrix::zeros(model.unknowns, model.unknowns);
    for piece in &model.pieces {
        let matrix = matrix_of(piece);
        for (j, right) in &piece.columns {
            let product = matrix * right;
            piece.columns.iter().for_each(|(i, left)| sum[(*i, *j)] += left.dot(&product));
        }
    }
    sum
}

fn lowest_modes(model: &Model, modes: usize) -> Vec<Mode> {
    let mass = assembled(model, |piece| &piece.mass);
    let mut stiffness = assembled(model, |piece| &piece.stiffness);
    for spring in &model.springs {
        stiffness[(spring.unknown, spring.unknown)] += spring.tangent_nm_per_rad;
    }
    let factor = factored(stiffness);
    let pairs = if model.unknowns <= SMALL_MODEL {
        all_pairs(&factor, &mass)
    } else {
        subspace_pairs(&factor, &mass, modes)
    };
    let slowest_s2 = pairs.first().map_or(0.0, |(period2_s2, _)| *period2_s2);
    let is_finite = |period2_s2: f64| period2_s2 > slowest_s2 * LEAST_PERIOD_RATIO.powi(2);
    let finite = pairs.into_iter().filter(|(period2_s2, _)| is_finite(*period2_s2));
    finite.take(modes).map(|(period2_s2, shape)| mode(model, period2_s2, &shape)).collect()
}

fn mode(model: &Model, inverse_square_s2: f64, shape: &DVector<f64>) -> Mode {
    Mode {
        frequency_hz: 1.0 / (inverse_square_s2.sqrt() * TAU),
        plane_share: plane_shares(model, shape),
        strain_energy: strain_shares(model, shape),
    }
}

/// Pairs (1 / omega^2, shape), largest first: `L^-1 M L^-T`, which a singular mass does not hurt.
fn all_pairs(factor: &Cholesky<f64, Dyn>, mass: &DMatrix<f64>) -> Vec<(f64, DVector<f64>)> {
    let lower = factor.l();
    let half = lower.solve_lower_triangular(mass).expect("a Cholesky factor is regular");
    let flexible_mass =
        lower.solve_lower_triangular(&half.transpose()).expect("a Cholesky factor is regular");
    let eigen = SymmetricEigen::new((&flexible_mass + flexible_mass.transpose()) * 0.5);
    let upper = lower.transpose();
    let shape = |i: usize| {
        let column = eigen.eigenvectors.column(i).into_owned();
        upper.solve_upper_triangular(&column).expect("a Cholesky factor is regular")
    };
    let mut pairs: Vec<_> = (0..eigen.eigenvalues.len()).map(|i| (eigen.eigenvalues[i], shape(i))).collect();
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    pairs
}

/// The same by subspace iteration, for large models.
fn subspace_pairs(
    factor: &Cholesky<f64, Dyn>,
    mass: &DMatrix<f64>,
    modes: usize,
) -> Vec<(f64, DVector<f64>)> {
    let size = (2 * modes + 8).min(mass.nrows());
    let mut shapes = starting_shapes(mass.nrows(), size);
    let mut previous: DVector<f64> = DVector::zeros(size);
    for _ in 0..300 {
        let inertia = mass * &shapes;
        let bent = factor.solve(&inertia);
        let small_stiffness = symmetric(bent.tr_mul(&inertia));
        let small_mass = symmetric(bent.tr_mul(&(mass * &bent)));
        let pairs = all_pairs(&factored(small_stiffness), &small_mass);
        let turn = DMatrix::from_columns(&pairs.iter().map(|(_, shape)| shape.clone()).collect::<Vec<_>>());
        shapes = bent * turn;
        // Unit length keeps the small matrices well scaled.
        for mut shape in shapes.column_iter_mut() {
            shape.normalize_mut();
        }
        let values: DVector<f64> = DVector::from_iterator(size, pairs.iter().map(|(value, _)| *value));
        let change = |i: usize| (values[i] - previous[i]).abs() / values[i];
        let drift = (0..modes.min(size)).map(change).fold(0.0, f64::max);
        previous = values;
        if drift < 1e-13 {
            break;
        }
    }
    (0..size).map(|i| (previous[i], shapes.column(i).into_owned())).collect()
}

fn symmetric(matrix: DMatrix<f64>) -> DMatrix<f64> {
    (&matrix + matrix.transpose()) * 0.5
}

/// Deterministic, rough, independent columns.
fn starting_shapes(rows: usize, columns: usize) -> DMatrix<f64> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    DMatrix::from_fn(rows, columns, |_, _| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    })
}

/// Kinetic energy of the in-plane part of the motion over all of it, for the planes xy, xz and yz.
fn plane_shares(model: &Model, shape: &DVector<f64>) -> [f64; 3] {
    const IN_PLANE: [[f64; 6]; 3] =
        [[1.0, 1.0, 0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 1.0, 1.0, 0.0, 0.0]];
    let energy = |keep: &[f64; 6]| {
        let of_piece = |piece: &Piece| {
            let motion = piece_motion(piece, shape);
            let kept = motion.map_with_location(|row, _, value| value * keep[row % 6]);
            (kept.transpose() * piece.mass * kept)[0]
        };
        model.pieces.iter().map(of_piece).sum::<f64>()
    };
    let whole = energy(&[1.0; 6]);
    IN_PLANE.map(|keep| energy(&keep) / whole)
}

fn strain_shares(model: &Model, shape: &DVector<f64>) -> Vec<(String, f64)> {
    let names = model.compliant_elements();
    let energy = |name: &String| {
        let beams = model.pieces.iter().filter(|piece| &piece.name == name).map(|piece| {
            let motion = piece_motion(piece, shape);
            (motion.transpose() * piece.stiffness * motion)[0]
        });
        let springs = model.springs.iter().filter(|spring| &spring.name == name);
        let springs = springs.map(|spring| spring.tangent_nm_per_rad * shape[spring.unknown].powi(2));
        beams.chain(springs).sum::<f64>()
    };
    let energies: Vec<f64> = names.iter().map(energy).collect();
    let whole: f64 = energies.iter().sum();
    names.into_iter().zip(energies).map(|(name, energy)| (name, energy / whole)).collect()
}

fn piece_motion(piece: &Piece, unknowns: &DVector<f64>) -> nalgebra::SVector<f64, 12> {
    piece.columns.iter().map(|(unknown, column)| column * unknowns[*unknown]).sum()
}
