//! How an arm behaves: one formulation for statics, modes and response.
//!
//! Every elastic thing is a handful of *strain coordinates*, each a scalar spring: a joint has one
//! (its twist), a tilting bearing two, a link a few polynomials of curvature, shear, twist and
//! stretch ([`beam`]). A unit of a coordinate moves everything outboard of it as a rigid body, by its
//! *twist*. Then
//!
//! - statics ([`statics`]): the generalized force on a coordinate is the work of the outboard wrench
//!   on its twist; the coordinate yields by force times compliance; the tip moves by the sum
//!   (Eqs 1-4, 7, 13-15);
//! - modes ([`modes`]): `M` from the outboard composite inertia seen by each pair of twists, the
//!   compliance matrix diagonal, so that `C^½ M C^½ ψ = ψ/ω²` (Eqs 16-18 are the rigid-link case);
//! - response ([`response`]): the modes summed under a harmonic force at the tip (F(t) of Eq 16).
//!
//! [`centre_line`] turns the coordinates of any of them into the places of the arm's points, for drawings.
//!
//! Twists and wrenches are written about the world origin: twist `(v, ω)` with `v` the velocity of the
//! body point at the origin, wrench `(F, M)` with `M` the moment about the origin.

pub(crate) mod beam;
pub(crate) mod centre_line;
pub(crate) mod chain;
pub(crate) mod condensed;
pub(crate) mod lanes;
pub(crate) mod linkage;
pub(crate) mod lowest;
pub(crate) mod lowest_lanes;
pub(crate) mod modes;
pub(crate) mod response;
pub(crate) mod statics;

pub use centre_line::Station;
pub use chain::{Chain, Posed};
pub use modes::{Mode, Modes};
pub use response::{Response, frequency_response};
pub use statics::{LinkRoot, Statics};

use nalgebra::{Matrix6, Vector3, Vector6};

/// Translation and rotation of a body: `(v, ω)` about the world origin.
pub type Twist = Vector6<f64>;
/// Force and moment: `(F, M)` about the world origin.
pub type Wrench = Vector6<f64>;

/// The twist of a rotation by 1 rad about `axis` through `point`.
pub fn rotation_twist(axis: &Vector3<f64>, point: &Vector3<f64>) -> Twist {
    stack(&point.cross(axis), axis)
}

/// The wrench of a force at a point.
pub fn force_wrench(force: &Vector3<f64>, point: &Vector3<f64>) -> Wrench {
    stack(force, &point.cross(force))
}

/// Displacement of the point of a moved body that is at `point`.
pub fn displacement_at(twist: &Twist, point: &Vector3<f64>) -> Vector3<f64> {
    linear(twist) + angular(twist).cross(point)
}

pub(crate) fn stack(first: &Vector3<f64>, second: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(first.x, first.y, first.z, second.x, second.y, second.z)
}

pub(crate) fn linear(six: &Vector6<f64>) -> Vector3<f64> {
    six.fixed_rows::<3>(0).into_owned()
}

pub(crate) fn angular(six: &Vector6<f64>) -> Vector3<f64> {
    six.fixed_rows::<3>(3).into_owned()
}

/// Inertia of a rigid body about the world origin, as a 6x6 matrix from twist to momentum.
pub fn body_inertia(
    mass_kg: f64,
    cg_m: &Vector3<f64>,
    inertia_about_cg: &nalgebra::Matrix3<f64>,
) -> Matrix6<f64> {
    let cross = cg_m.cross_matrix();
    let mut out = Matrix6::zeros();
    out.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(mass_kg);
    out.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-mass_kg * cross));
    out.fixed_view_mut::<3, 3>(3, 0).copy_from(&(mass_kg * cross));
    out.fixed_view_mut::<3, 3>(3, 3).copy_from(&(inertia_about_cg - mass_kg * cross * cross));
    out
}
