//! Trial shapes: linear inequalities that follow from a required lowest mode, in one case.
//!
//! `λ₁ = min_x xᵀK x / xᵀM x`. So a design whose `λ₁` is at least `ω²` satisfies `ω² xᵀM x - xᵀK x ≤ 0` for every
//! shape `x` of strain coordinates (joint angles and the polynomials of [`beam`](crate::mechanics::beam)). `M` is
//! linear in the masses of the pieces and `K` in their stiffnesses. For a fixed `x` the left side is therefore a sum
//! with one number for each piece. The shapes that matter are the modes of mixtures whose lowest mode is below the
//! required lowest mode. They are found one after the other.

use super::parts::Parts;
use super::row::Row;
use crate::arm::LinkModel;
use crate::arm::body::RigidBody;
use crate::arm::structure::{LinkPiece, Structure};
use crate::mechanics::beam::{PreparedBeam, compliances, line_densities};
use crate::mechanics::{displacement_at, stack};
use crate::space::design_space::{DesignSpace, SpacePiece};
use crate::space::effects::{Carried, Carrier, Layer};
use crate::space::problem::ArmProblem;
use crate::space::station::{StationSlot, Walk};
use nalgebra::{DMatrix, DVector, Matrix3, Matrix6xX, SymmetricEigen, Vector3};

/// Greatest number of shapes that are taken from one mixture.
const MOST_SHAPES: usize = 3;

/// Inertias and stiffnesses of the arm in one case, over the strain coordinates.
pub(super) struct ShapeModel {
    /// Index of the case among all cases of the study.
    pub case: usize,
    /// Inertia matrix of everything that is the same in all designs: the payload, rigid offsets and bodies.
    given: DMatrix<f64>,
    joints: Vec<JointShape>,
    links: Vec<LinkShape>,
}

/// A joint of the model: the index of its coordinate, and the motion of its mass.
struct JointShape {
    slot: usize,
    column: usize,
    /// Displacement of the joint's mass per unit of each coordinate: three rows (x, y, z), and one column for each
    /// coordinate.
    motion: DMatrix<f64>,
}

/// A tube of the model: its coordinates, its motion, and the inertia and stiffness of its options.
struct LinkShape {
    slot: usize,
    first: usize,
    /// Displacement and rotation at each Gauss point per unit of each coordinate, times the square root of the
    /// point's weight.
    fields: Vec<Matrix6xX<f64>>,
    /// For each option, its inertia per length for each of the six components of motion.
    densities: Vec<[f64; 6]>,
    /// For each option, the stiffness of each of the tube's coordinates.
    stiffness: Vec<Vec<f64>>,
}

impl LinkShape {
    /// The tube in slot `slot`. Its strain coordinates start at the index `first`, `fields` is its motion at each Gauss
    /// point, and `tubes` are its options.
    fn new(
        slot: usize,
        first: usize,
        fields: Vec<Matrix6xX<f64>>,
        tubes: &[LinkPiece],
        structure: &Structure,
        links: LinkModel,
    ) -> Self {
        let densities = tubes.iter().map(|tube| line_densities(tube, structure, links)).collect();
        let stiffness =
            tubes.iter().map(|tube| compliances(tube, links).iter().map(|c| 1.0 / c).collect()).collect();
        Self { slot, first, fields, densities, stiffness }
    }
}

/// Writes the motion of everything outboard of a tube, per unit of each coordinate of the tube, into the columns of
/// `twist` from `column` on.
fn add_end_motions(
    twist: &mut DMatrix<f64>,
    beam: &PreparedBeam,
    frame: &Matrix3<f64>,
    end_m: &Vector3<f64>,
    column: usize,
) {
    for (k, field) in beam.end_fields.column_iter().enumerate() {
        let turn: Vector3<f64> = frame * field.fixed_rows::<3>(3);
        let move_m = frame * field.fixed_rows::<3>(0) + end_m.cross(&turn);
        twist.set_column(column + k, &stack(&move_m, &turn));
    }
}

impl ShapeModel {
    /// Prepares the model of one case.
    pub(super) fn new(problem: &ArmProblem, case: usize) -> Self {
        let space = problem.space();
        let around = space.surroundings();
        let structure = Structure { water: space.cases[case].water.or(around.water), ..around };
        let station = &problem.stations()[case];
        let walk = Walk::new(space, &space.cases[case]);
        let layers = space.layers();
        let tubes: Vec<Vec<LinkPiece>> = layers.iter().map(|(_, layer)| tubes(space, layer)).collect();
        let beam = |slot: usize| PreparedBeam::new(tubes[slot].first()?, &structure, space.links);
        let sizes = station.slots.iter().enumerate().map(|(slot, placed)| match placed {
            StationSlot::Joint(_) => 1,
            StationSlot::Body { .. } => 0,
            StationSlot::Link { .. } => tubes[slot].first().map_or(0, |t| compliances(t, space.links).len()),
        });
        let count: usize = sizes.sum();
        let mut model =
            Self { case, given: DMatrix::zeros(count, count), joints: Vec::new(), links: Vec::new() };
        // The kinematic twist (motion) of the chain's end so far per unit of each coordinate, from base to tip.
        let mut twist = DMatrix::<f64>::zeros(6, count);
        let mut column = 0;
        for (slot, placed) in station.slots.iter().enumerate().rev() {
            let (at_m, rotation) = &walk.places[layers[slot].0];
            match placed {
                StationSlot::Joint(joint) => {
                    model.joints.push(JointShape { slot, column, motion: point_motion(&twist, at_m) });
                    twist.set_column(column, &joint.twist);
                    column += 1;
                }
                // Bodies on a tube move with points of the tube, and are added together with the tube.
                StationSlot::Body { .. } if is_on_tube(&layers[slot].1) => {}
                StationSlot::Body { inertia, .. } => model.given += twist.transpose() * inertia * &twist,
                StationSlot::Link { place, .. } => {
                    let Some(beam) = beam(slot) else { continue };
                    let frame = rotation.matrix() * beam.frame;
                    let fields = link_fields(&beam, &frame, &place.root_m, &twist, column);
                    model.links.push(LinkShape::new(
                        slot,
                        column,
                        fields,
                        &tubes[slot],
                        &structure,
                        space.links,
                    ));
                    for body in &tubes[slot][0].bodies {
                        model.given += body_inertia_over(&beam, body, &frame, &place.root_m, &twist, column);
                    }
                    add_end_motions(&mut twist, &beam, &frame, &place.end_m, column);
                    column += beam.compliances.len();
                }
            }
        }
        model.given += twist.transpose() * station.start_inertia * &twist;
        model
    }

    /// The inequality that the trial shape `x` gives for designs whose lowest eigenvalue is at least `eigenvalue`
    /// \[1/s²\]. `stiffness` has the stiffnesses of the remaining options of joints, by slot.
    pub(super) fn row(
        &self,
        parts: &Parts,
        stiffness: &[Vec<f64>],
        x: &DVector<f64>,
        eigenvalue: f64,
    ) -> Row {
        let mut row =
            Row { coefficients: parts.each(|_, _| 0.0), limit: -eigenvalue * x.dot(&(&self.given * x)) };
        for joint in &self.joints {
            let moved = (&joint.motion * x).norm_squared();
            let bent = x[joint.column].powi(2);
            for (at, &option) in parts.alive[joint.slot].iter().enumerate() {
                let resisted = if bent > 0.0 { bent * stiffness[joint.slot][at] } else { 0.0 };
                row.coefficients[joint.slot][at] +=
                    eigenvalue * parts.mass_kg(joint.slot, option) * moved - resisted;
            }
        }
        for link in &self.links {
            let moved = link.moved(x);
            for (at, &option) in parts.alive[link.slot].iter().enumerate() {
                let (densities, stiffness) =
                    (&link.densities[option as usize], &link.stiffness[option as usize]);
                let weighed: f64 = densities.iter().zip(&moved).map(|(d, m)| d * m).sum();
                let own = x.rows(link.first, stiffness.len());
                let bent = own.iter().zip(stiffness).filter(|(x, _)| **x != 0.0);
                let resisted: f64 = bent.map(|(x, k)| x * x * k).sum();
                row.coefficients[link.slot][at] += eigenvalue * weighed - resisted;
            }
        }
        row.ready()
    }

    /// The modes of a mixture whose eigenvalues are below `eigenvalue` \[1/s²\], as trial shapes, the lowest mode
    /// first. `weights` are the weights of the options in the mixture, and `stiffness` the stiffnesses of the joints'
    /// options, both by slot.
    pub(super) fn violated(
        &self,
        parts: &Parts,
        stiffness: &[Vec<f64>],
        weights: &[Vec<f64>],
        eigenvalue: f64,
    ) -> Vec<DVector<f64>> {
        let count = self.given.nrows();
        if count == 0 || !eigenvalue.is_finite() {
            return Vec::new();
        }
        let mut inertia = self.given.clone();
        let mut resistance = vec![0.0; count];
        for joint in &self.joints {
            let mix = mixture(&weights[joint.slot]);
            let mass: f64 =
                mix.clone().map(|(at, w)| w * parts.mass_kg(joint.slot, parts.alive[joint.slot][at])).sum();
            inertia += joint.motion.transpose() * &joint.motion * mass;
            // A joint that may be rigid would make the coefficient infinite, so its coordinate is zero in every
            // shape.
            let rigid = stiffness[joint.slot].iter().any(|k| k.is_infinite());
            resistance[joint.column] =
                if rigid { f64::INFINITY } else { mix.map(|(at, w)| w * stiffness[joint.slot][at]).sum() };
        }
        for link in &self.links {
            let mut densities = [0.0; 6];
            for (at, weight) in mixture(&weights[link.slot]) {
                let option = parts.alive[link.slot][at] as usize;
                densities.iter_mut().zip(&link.densities[option]).for_each(|(sum, d)| *sum += weight * d);
                for (k, own) in link.stiffness[option].iter().enumerate() {
                    resistance[link.first + k] += weight * own;
                }
            }
            for field in &link.fields {
                let mut weighted = field.clone();
                for (mut row, density) in weighted.row_iter_mut().zip(densities) {
                    row *= density;
                }
                inertia += field.transpose() * weighted;
            }
        }
        // The eigenvalue problem is scaled by `K^-½`, so that a rigid coordinate has weight 0 and the matrix stays
        // symmetric.
        let soft = DVector::from_iterator(count, resistance.iter().map(|k| 1.0 / k.sqrt()));
        let scaled = DMatrix::from_fn(count, count, |i, j| soft[i] * inertia[(i, j)] * soft[j]);
        let modes = SymmetricEigen::new(scaled);
        let mut slow: Vec<usize> =
            // An eigenvalue of the scaled matrix is the reciprocal of a squared frequency, so low modes have large
            // eigenvalues.
            (0..count).filter(|&i| modes.eigenvalues[i] * eigenvalue > 1.0 + 1e-7).collect();
        slow.sort_by(|&a, &b| modes.eigenvalues[b].total_cmp(&modes.eigenvalues[a]));
        slow.truncate(MOST_SHAPES);
        slow.into_iter().map(|i| modes.eigenvectors.column(i).component_mul(&soft)).collect()
    }
}

impl LinkShape {
    /// For each of the six components of motion, the integral of its square along the link, if the arm moves by the
    /// shape `x`.
    fn moved(&self, x: &DVector<f64>) -> [f64; 6] {
        let mut out = [0.0; 6];
        for field in &self.fields {
            let here = field * x;
            out.iter_mut().zip(here.iter()).for_each(|(sum, v)| *sum += v * v);
        }
        out
    }
}

/// The options of a link, with the effects of the study applied; empty if the layer is not a link.
fn tubes(space: &DesignSpace, layer: &Layer) -> Vec<LinkPiece> {
    match layer {
        Layer::Piece(SpacePiece::Choice(choice)) => {
            choice.options.iter().map(|option| space.link_piece(&choice.link(option))).collect()
        }
        Layer::Piece(SpacePiece::Link(link)) => vec![space.link_piece(link)],
        _ => Vec::new(),
    }
}

/// Indices and weights of the options that have a positive weight in a mixture.
fn mixture(weights: &[f64]) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
    weights.iter().copied().enumerate().filter(|(_, w)| *w > 0.0)
}

/// Displacement of the point `at_m` per unit of each coordinate of the arm: three rows (x, y, z), and one column for
/// each coordinate. Each column of `twist` is the motion of the chain inboard of the point for one coordinate.
fn point_motion(twist: &DMatrix<f64>, at_m: &Vector3<f64>) -> DMatrix<f64> {
    let columns: Vec<Vector3<f64>> =
        twist.column_iter().map(|t| displacement_at(&t.fixed_rows::<6>(0).into_owned(), at_m)).collect();
    DMatrix::from_fn(3, columns.len(), |i, j| columns[j][i])
}

/// Whether a layer is a set of bodies on a tube.
fn is_on_tube(layer: &Layer) -> bool {
    matches!(layer, Layer::Bodies(Carried { by: Carrier::Tube, .. }))
}

/// Inertia matrix of a body on a tube over all coordinates of the arm. The coordinates of the tube start at the index
/// `first`; `twist` has the motion of the tube's root for the coordinates inboard of it.
fn body_inertia_over(
    beam: &PreparedBeam,
    body: &RigidBody,
    frame: &Matrix3<f64>,
    root_m: &Vector3<f64>,
    twist: &DMatrix<f64>,
    first: usize,
) -> DMatrix<f64> {
    let inertia = beam.inertia_of(body);
    let own = inertia.ncols() - 6;
    let mut motion = DMatrix::zeros(6 + own, twist.ncols());
    motion.rows_mut(0, 6).copy_from(&root_motion(frame, root_m, twist));
    motion.view_mut((6, first), (own, own)).fill_with_identity();
    motion.transpose() * inertia * motion
}

/// Translation and rotation of the root of a tube in its section frame, per unit of each coordinate.
fn root_motion(frame: &Matrix3<f64>, root_m: &Vector3<f64>, twist: &DMatrix<f64>) -> DMatrix<f64> {
    let turned = frame.transpose();
    let mut root = DMatrix::zeros(6, twist.ncols());
    root.rows_mut(0, 3).copy_from(&(turned * point_motion(twist, root_m)));
    root.rows_mut(3, 3).copy_from(&(turned * twist.rows(3, 3)));
    root
}

/// Displacement and rotation of the link's section at each Gauss point, in the section frame, per unit of each
/// coordinate of the arm. They are multiplied by the square root of the point's weight.
fn link_fields(
    beam: &PreparedBeam,
    frame: &Matrix3<f64>,
    root_m: &Vector3<f64>,
    twist: &DMatrix<f64>,
    first: usize,
) -> Vec<Matrix6xX<f64>> {
    let root = root_motion(frame, root_m, twist);
    beam.quadrature()
        .map(|(xi, weight)| {
            let fields = beam.fields(xi);
            let mut all = fields.columns(0, 6) * &root;
            let own = fields.ncols() - 6;
            let inner = all.columns(first, own) + fields.columns(6, own);
            all.columns_mut(first, own).copy_from(&inner);
            all * weight.sqrt()
        })
        .collect()
}
