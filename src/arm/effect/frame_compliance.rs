//! `frame_compliance`: a structure rotates elastically about three axes, with a different compliance about each and
//! with coupling between them. The structure is the ground under the arm, or the part between a joint and the link
//! outboard of it.

use super::kind::{ElasticRotation, Kind, Parameter, Place, Scope, Traits};
use super::subject::Subject;
use crate::arm::structure::FrameCompliance;
use nalgebra::{Matrix3, SymmetricEigen};

const PARAMETERS: &[Parameter] = &[
    Parameter::vector("diagonal_rad_per_nm", 0.0, 1.0, 5e-6),
    Parameter::vector("coupling_rad_per_nm", -1.0, 1.0, 0.0),
];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "frame_compliance",
    summary: "the base or the structure behind a joint turns per moment about three axes, coupled",
    scope: Scope::Product,
    places: &[Place::Base, Place::Link],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        is_sought: false,
        rotation: Some(ElasticRotation::Frame),
        contradiction,
        ..Traits::USUAL
    },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    let added = matrix(numbers);
    let structure = &mut subject.structure;
    let frame = match structure.place(at, KIND.places) {
        Some(Place::Base) => Some(&mut structure.base_frame),
        // a structure may be only a part of the arm and lack this link; then nothing changes
        _ => structure.link_mut(at).map(|link| &mut link.root_frame),
    };
    if let Some(frame) = frame {
        *frame = FrameCompliance(frame.0 + added);
    }
}

fn matrix(numbers: &[f64]) -> Matrix3<f64> {
    let [xx, yy, zz, xy, xz, yz] = std::array::from_fn(|i| numbers.get(i).copied().unwrap_or_default());
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

fn contradiction(numbers: &[f64]) -> Option<(&'static str, &'static str)> {
    (!is_spring(numbers)).then_some((
        "some moment would turn the frame against itself",
        "each coupling squared is at most the product of its two diagonal numbers",
    ))
}

/// Whether the compliance matrix belongs to a spring. A spring has no negative eigenvalue, so no moment does negative
/// work on it.
fn is_spring(numbers: &[f64]) -> bool {
    let eigenvalues = SymmetricEigen::new(matrix(numbers)).eigenvalues;
    eigenvalues.min() >= -1e-9 * eigenvalues.max().abs()
}

#[cfg(test)]
#[path = "frame_compliance_tests.rs"]
mod tests;
