//! Mechanics: deflection, natural frequencies and harmonic response of an arm, all from one formulation. Equation
//! numbers refer to docs/model.md.
//!
//! Every elastic element has a few *strain coordinates*, each of them a scalar spring. A joint has one (its angle of
//! torsion), a bearing that tilts has two. The drive of a prismatic joint has one and its guide up to three. A link
//! has some polynomials of curvature, shear, twist and stretch (`beam`). One unit of a coordinate moves everything
//! outboard of it as a rigid body; this motion is called the *twist* of the coordinate.
//!
//! - Statics (`statics`; Eqs 1-4, 7, 13-15): the generalized force on a coordinate is the work of the outboard wrench
//!   on the twist of the coordinate. The coordinate deflects by force times compliance. The displacement of the tip is
//!   the sum over all coordinates.
//! - Modes (`modes`; Eqs 16-18 are the case of rigid links): the mass matrix `M` follows from the inertia of everything
//!   outboard of a coordinate and from each pair of twists. The compliance matrix `C` is diagonal, and `C^½ M C^½ ψ =
//!   ψ/ω²`. `eigenpairs` solves it for the modes that are asked for. The lowest mode alone (`lowest_mode`, `krylov`)
//!   needs products with `M` only. Each product takes two passes over the chain.
//! - Response (`response`; F(t) of Eq 16): the sum of the modes under a harmonic force at the tip.
//!
//! `hanging` repeats the statics in the deflected pose, for large displacements. `tip` computes the displacement of the tip
//! alone, for campaigns of many poses. `centre_line` turns strain coordinates
//! into the displacement of points of the arm, for drawings. `condensed`, `lowest` and `lowest_lanes` are the fast
//! computation of the lowest mode that the search uses.
//!
//! Twists and wrenches are taken about the world's origin. A twist is `(v, ω)`, where `v` is the velocity of that
//! point of the body which is at the origin. A wrench is `(F, M)`, where `M` is the moment about the origin.

pub(crate) mod beam;
pub(crate) mod centre_line;
pub(crate) mod chain;
pub(crate) mod condensed;
pub(crate) mod deflections;
pub(crate) mod eigenpairs;
pub(crate) mod hanging;
pub(crate) mod krylov;
pub(crate) mod lanes;
pub(crate) mod link_stress;
pub(crate) mod linkage;
pub(crate) mod lowest;
pub(crate) mod lowest_lanes;
mod lowest_mode;
pub(crate) mod modes;
pub(crate) mod prismatic;
pub(crate) mod product;
pub(crate) mod response;
pub(crate) mod statics;
pub(crate) mod tip;

pub use centre_line::Station;
pub use chain::{Chain, Posed};
pub use modes::{Mode, Modes};
pub use prismatic::GuideLoad;
pub use response::{Response, frequency_response};
pub use statics::{JointLoad, SectionLoad, Statics};

use nalgebra::{Matrix3, Matrix6, Rotation3, Unit, Vector3, Vector6};

/// Translation and rotation of a body as one vector `(v, ω)`, taken at the world's origin.
pub type Twist = Vector6<f64>;
/// Force and moment as one vector `(F, M)`; the moment is taken about the world's origin.
pub type Wrench = Vector6<f64>;

/// Twist of a rotation by 1 rad about a unit vector `axis` through `point` \[m\].
pub fn rotation_twist(axis: &Vector3<f64>, point: &Vector3<f64>) -> Twist {
    stack(&point.cross(axis), axis)
}

/// Wrench of a force \[N\] at a point \[m\].
pub fn force_wrench(force: &Vector3<f64>, point: &Vector3<f64>) -> Wrench {
    stack(force, &point.cross(force))
}

/// Displacement \[m\] of the point of a body that is at `point` \[m\], when the body makes the small motion `twist`.
pub fn displacement_at(twist: &Twist, point: &Vector3<f64>) -> Vector3<f64> {
    linear(twist) + angular(twist).cross(point)
}

/// Joins two vectors of three components to one of six.
pub(crate) fn stack(first: &Vector3<f64>, second: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(first.x, first.y, first.z, second.x, second.y, second.z)
}

/// The first three components: the velocity of a twist or the force of a wrench.
pub(crate) fn linear(six: &Vector6<f64>) -> Vector3<f64> {
    six.fixed_rows::<3>(0).into_owned()
}

/// The last three components: the angular velocity of a twist or the moment of a wrench.
pub(crate) fn angular(six: &Vector6<f64>) -> Vector3<f64> {
    six.fixed_rows::<3>(3).into_owned()
}

/// Rotation about the axis `axis` by an angle that is given by its sine and cosine (Rodrigues' formula).
pub(crate) fn turn(axis: &Unit<Vector3<f64>>, (sin, cos): (f64, f64)) -> Rotation3<f64> {
    let (x, y, z) = (axis.x, axis.y, axis.z);
    let rest = 1.0 - cos;
    Rotation3::from_matrix_unchecked(Matrix3::new(
        x * x * rest + cos,
        x * y * rest - z * sin,
        x * z * rest + y * sin,
        x * y * rest + z * sin,
        y * y * rest + cos,
        y * z * rest - x * sin,
        x * z * rest - y * sin,
        y * z * rest + x * sin,
        z * z * rest + cos,
    ))
}

/// Two unit vectors perpendicular to `axis` and to each other.
pub(crate) fn across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    // The cross product has the least rounding error with the world axis that is least parallel to `axis`.
    let least = axis.iamin();
    let first = axis.cross(&Vector3::ith(least, 1.0)).normalize();
    [first, axis.cross(&first)]
}

/// Inertia matrix (6x6) of a rigid body about the world's origin. It turns the twist of the body into its momentum.
pub fn body_inertia(mass_kg: f64, cg_m: &Vector3<f64>, inertia_about_cg: &Matrix3<f64>) -> Matrix6<f64> {
    let cross = cg_m.cross_matrix();
    let mut out = Matrix6::zeros();
    out.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(mass_kg);
    out.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-mass_kg * cross));
    out.fixed_view_mut::<3, 3>(3, 0).copy_from(&(mass_kg * cross));
    out.fixed_view_mut::<3, 3>(3, 3).copy_from(&(inertia_about_cg - mass_kg * cross * cross));
    out
}
