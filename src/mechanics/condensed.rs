//! Condensed links: a link reduced to the six motions of its end.
//!
//! A link deforms in its strain coordinates `q`, which are polynomials of curvature, shear, twist and stretch. Only six
//! combinations `g` of them move its end. The other shapes vibrate inside
//! the link, at frequencies far above the lowest frequency of the arm. Let `E` be the motion of the end per unit of
//! each `q`, and `C` the diagonal compliance matrix. The compliance of the end is then `F = E C Eᵀ = L Lᵀ`. The
//! coordinates `g` are chosen such that the end moves by `L g` and that their stiffness matrix is the unit matrix.
//! The remainder, `G = C - C Eᵀ F⁻¹ E C`, is the compliance of the inner shapes while the end is held. Eliminating
//! these shapes from `K - λM` gives
//!
//! ```text
//! M_eff(λ) = M₀ + λ M₁ + λ² M₂ + O(λ³),  M₁ = M_qᵀ G M_q,  M₂ = M_qᵀ G M_qq G M_q
//! ```
//!
//! over the motion of the root and `g`.
//!
//! *Validity.* The neglected term is of the order `(λ/λ_inner)³`, where `λ_inner` is the lowest eigenvalue of the inner
//! shapes. It is at most 1e-6 of the link's inertia if `λ_inner` is a hundred times `λ`. The inner modes then have ten
//! times the frequency of the arm's lowest mode. The search uses this form. Every number that it reports is computed by
//! the full model.

use super::beam::PreparedBeam;
use nalgebra::{DMatrix, Matrix3, Matrix6, SMatrix, Vector3, Vector6};

/// Inertia matrix over the motion of the root (rows 0-5) and the end coordinates `g` (rows 6-11).
pub(crate) type Inertia12 = SMatrix<f64, 12, 12>;

/// A condensed link, in its section frame.
#[derive(Debug, Clone)]
pub(crate) struct CondensedLink {
    /// Effective inertia as a polynomial in λ: the coefficients `M₀, M₁, M₂`.
    pub inertia: [Inertia12; 3],
    /// Displacement (rows 0-2) and rotation (rows 3-5) of the end per unit of each end coordinate: the matrix `L`.
    pub end: Matrix6<f64>,
    /// Values of the end coordinates under a uniform load along the link of 1 N/m, in the direction of each axis of the
    /// section \[1/(N/m)\]: one column for each axis.
    pub end_per_line_load: SMatrix<f64, 6, 3>,
    /// Values of the end coordinates under the weight of the bodies on the link, if gravity acts along an axis of the
    /// section: one column for each axis.
    pub end_under_bodies: SMatrix<f64, 6, 3>,
    /// For each point of the axis at which a spring acts: values of the end coordinates per unit of force (columns 0-2)
    /// and of moment (columns 3-5) at this point, in the section frame.
    pub end_per_pull: Vec<Matrix6<f64>>,
    /// Sum of `1/λ` over the inner modes with root and end held \[s²\]. As a sum of positive numbers it is an upper
    /// bound of each `1/λ`.
    pub inner_trace_s2: f64,
}

impl CondensedLink {
    /// Condenses a prepared link. `pulled_at` are the points of its axis (0 to 1) at which springs act.
    pub(crate) fn new(beam: &PreparedBeam, pulled_at: &[f64]) -> Self {
        let n = beam.compliances.len();
        let compliance = DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(&beam.compliances));
        let end_fields = DMatrix::from_iterator(6, n, beam.end_fields.iter().copied());
        let flexibility = &end_fields * &compliance * end_fields.transpose();
        let end = semidefinite_cholesky(&Matrix6::from_iterator(flexibility.iter().copied()));
        // Strain coordinates per unit of each end coordinate: C Eᵀ L⁻ᵀ.
        let spread = &compliance * end_fields.transpose() * inverse_transpose(&end);
        let inner = &compliance - &spread * spread.transpose();
        // This matrix converts root motion and end coordinates `g` to root motion and strain coordinates `q`.
        let mut expand = DMatrix::zeros(6 + n, 12);
        expand.view_mut((0, 0), (6, 6)).fill_with_identity();
        expand.view_mut((6, 6), (n, 6)).copy_from(&spread);
        let over_q = beam.inertia.rows(6, n) * &expand;
        let inner_mass = beam.inertia.view((6, 6), (n, n));
        let first = over_q.transpose() * &inner;
        let fixed = |m: DMatrix<f64>| Inertia12::from_iterator(m.iter().copied());
        let areas = DMatrix::from_fn(n, 3, |q, axis| beam.area_fields[(axis, q)]);
        let bodies = DMatrix::from_fn(n, 3, |q, axis| beam.bodies.fields[(axis, q)]);
        Self {
            inertia: [
                fixed(expand.transpose() * &beam.inertia * &expand),
                fixed(&first * &over_q),
                fixed(&first * inner_mass * first.transpose()),
            ],
            end,
            end_per_line_load: SMatrix::from_iterator((spread.transpose() * areas).iter().copied()),
            end_under_bodies: SMatrix::from_iterator((spread.transpose() * bodies).iter().copied()),
            end_per_pull: pulled_at.iter().map(|xi| end_per_pull(beam, &spread, *xi)).collect(),
            // Without inner shapes the trace is zero, but rounding may make it slightly negative.
            inner_trace_s2: (&inner * inner_mass).trace().max(0.0),
        }
    }

    /// The condensed link in a pose. `root_m` and `end_m` are the positions of its root and end \[m\], `frame` is its
    /// section frame and `down` the direction of gravity, all in the world.
    pub(crate) fn place(
        &self,
        root_m: &Vector3<f64>,
        end_m: &Vector3<f64>,
        frame: &Matrix3<f64>,
        down: &Vector3<f64>,
    ) -> PlacedLink {
        let to_root = world_to_local(root_m, frame);
        let mut to_local = Inertia12::identity();
        to_local.fixed_view_mut::<6, 6>(0, 0).copy_from(&to_root);
        let mut end = Matrix6::zeros();
        for (mut out, local) in end.column_iter_mut().zip(self.end.column_iter()) {
            let rotation = frame * local.fixed_rows::<3>(3);
            out.copy_from(&super::stack(
                &(frame * local.fixed_rows::<3>(0) + end_m.cross(&rotation)),
                &rotation,
            ));
        }
        PlacedLink {
            inertia: self.inertia.map(|m| to_local.transpose() * m * to_local),
            end,
            end_per_weight: self.end_per_line_load * (frame.transpose() * down),
            end_under_bodies: self.end_under_bodies * (frame.transpose() * down),
            inner_trace_s2: self.inner_trace_s2,
        }
    }
}

/// Values of the end coordinates per unit of force and moment at the point `xi` (0 to 1) of the axis: one column for
/// each component. `spread` has the strain coordinates of the link per unit of each end coordinate.
fn end_per_pull(beam: &PreparedBeam, spread: &DMatrix<f64>, xi: f64) -> Matrix6<f64> {
    let fields = beam.fields(xi).columns_range(6..).into_owned();
    let per_end = fields * spread;
    Matrix6::from_iterator(per_end.transpose().iter().copied())
}

/// A condensed link in a pose. All motions are twists (velocity, angular velocity) about the world's origin.
#[derive(Debug, Clone)]
pub(crate) struct PlacedLink {
    /// The coefficients `M₀, M₁, M₂` of the effective inertia, over the twist of the root and the end coordinates.
    pub inertia: [Inertia12; 3],
    /// Motion of everything outboard of the link per unit of each end coordinate.
    pub end: Matrix6<f64>,
    /// Values of the six end coordinates under the weight of the bodies on the link.
    pub end_under_bodies: Vector6<f64>,
    /// Values of the six end coordinates under a weight, with buoyancy subtracted, of 1 N per metre of the link
    /// \[1/(N/m)\].
    pub end_per_weight: Vector6<f64>,
    /// Sum of `1/λ` over the inner modes with root and end held \[s²\].
    pub inner_trace_s2: f64,
}

/// The matrix that converts a twist about the world's origin to translation and rotation of the point `point_m`
/// \[m\], in the axes of `frame`.
pub(crate) fn world_to_local(point_m: &Vector3<f64>, frame: &Matrix3<f64>) -> Matrix6<f64> {
    let turn = frame.transpose();
    let mut out = Matrix6::zeros();
    out.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
    out.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-turn * point_m.cross_matrix()));
    out.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
    out
}

/// The lower triangular matrix `L` with `L Lᵀ = a`, for a positive semidefinite `a`. Columns of directions without
/// compliance are zero. Zeros of a block-diagonal matrix stay exactly zero, so planes that do not couple stay
/// uncoupled.
fn semidefinite_cholesky(a: &Matrix6<f64>) -> Matrix6<f64> {
    let mut lower = Matrix6::zeros();
    for j in 0..6 {
        let pivot = a[(j, j)] - (0..j).map(|k| lower[(j, k)] * lower[(j, k)]).sum::<f64>();
        // A link model that leaves out a kind of strain may leave a direction without compliance.
        if pivot <= 1e-12 * a[(j, j)] {
            continue;
        }
        let root = pivot.sqrt();
        lower[(j, j)] = root;
        for i in j + 1..6 {
            let rest = a[(i, j)] - (0..j).map(|k| lower[(i, k)] * lower[(j, k)]).sum::<f64>();
            lower[(i, j)] = rest / root;
        }
    }
    lower
}

/// The matrix `L⁻ᵀ` for the lower triangular matrix `L`. Rows and columns of directions without compliance are zero.
fn inverse_transpose(lower: &Matrix6<f64>) -> DMatrix<f64> {
    let mut inverse = DMatrix::zeros(6, 6);
    for column in 0..6 {
        for row in 0..6 {
            if lower[(row, row)] == 0.0 {
                continue;
            }
            let unit = f64::from(row == column);
            let rest: f64 = (0..row).map(|k| lower[(row, k)] * inverse[(k, column)]).sum();
            inverse[(row, column)] = (unit - rest) / lower[(row, row)];
        }
    }
    inverse.transpose()
}
