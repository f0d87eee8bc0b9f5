//! `frame_compliance`: a structure turns about three axes under a moment, each differently and coupled. It is
//! what the arm stands on, or the casting behind a joint.

use super::kind::{Kind, Parameter, Place, Scope, Traits, Yields};
use super::subject::Subject;
use crate::arm::structure::FrameCompliance;
use nalgebra::{Matrix3, SymmetricEigen};

const PARAMETERS: &[Parameter] = &[
    Parameter::vector("diagonal_rad_per_nm", 0.0, 1.0, 5e-6),
    Parameter::vector("coupling_rad_per_nm", -1.0, 1.0, 0.0),
];

/// The effect.
pub const KIND: Kind = Kind {
    name: "frame_compliance",
    summary: "the base or the structure behind a joint turns per moment about three axes, coupled",
    scope: Scope::Product,
    places: &[Place::Base, Place::Link],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { is_sought: false, yields: Some(Yields::Frame), contradiction, ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    let added = matrix(numbers);
    match subject.structure.link_mut(at) {
        Some(link) => link.root_frame = FrameCompliance(link.root_frame.0 + added),
        None if at == "base" => {
            subject.structure.base_frame = FrameCompliance(subject.structure.base_frame.0 + added);
        }
        // a part of an arm may lack the link, and then nothing changes
        None => {}
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

/// Whether the numbers describe a spring: no moment turns the frame against itself.
fn is_spring(numbers: &[f64]) -> bool {
    let eigenvalues = SymmetricEigen::new(matrix(numbers)).eigenvalues;
    eigenvalues.min() >= -1e-9 * eigenvalues.max().abs()
}

#[cfg(test)]
mod tests {
    use super::super::validate::testing::two_link_subject;
    use super::*;
    use crate::arm::LinkModel;
    use crate::arm::load::Payload;
    use crate::mechanics::chain::Chain;
    use nalgebra::Vector3;

    /// The displacement of the tip by a frame alone, under a force at the tip.
    fn by_frame(numbers: &[f64], at: &str, pose_rad: &[f64], force_n: Vector3<f64>) -> Vector3<f64> {
        let mut subject = two_link_subject();
        subject.structure.gravity_m_s2 = 0.0;
        apply(numbers, at, &mut subject);
        let chain = Chain::new(&subject.structure, LinkModel::Rigid);
        let posed = chain.pose_rad(pose_rad, &Payload::default(), force_n);
        let name = format!("{at}.frame_compliance");
        let statics = posed.statics();
        statics.shares_m.iter().find(|(n, _)| *n == name).expect("share").1
    }

    #[test]
    fn the_tip_moves_by_the_matrix_times_the_moment_crossed_with_the_lever() {
        let numbers = [3e-6, 5e-6, 4e-6, 1e-6, -2e-6, 1.5e-6];
        let (q, force_n) = (0.7f64, Vector3::new(3.0, -8.0, -20.0));
        // stretched, turned about z by q: the tip is 1 m out
        let tip = Vector3::new(q.cos(), q.sin(), 0.0);
        let rotation = matrix(&numbers) * tip.cross(&force_n);
        let base = by_frame(&numbers, "base", &[q, 0.0], force_n);
        assert!((base - rotation.cross(&tip)).norm() < 1e-15, "{base}");
        // the forearm's root is half way, its frame is turned by q
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), q);
        let rotation = turn * (matrix(&numbers) * (turn.inverse() * (tip / 2.0).cross(&force_n)));
        let link = by_frame(&numbers, "forearm", &[q, 0.0], force_n);
        assert!((link - rotation.cross(&(tip / 2.0))).norm() < 1e-15, "{link}");
    }

    #[test]
    fn a_part_of_an_arm_without_the_link_keeps_its_base() {
        let mut subject = two_link_subject();
        subject.structure.pieces.clear();
        apply(&[3e-6, 5e-6, 4e-6], "forearm", &mut subject);
        assert_eq!(subject.structure.base_frame, FrameCompliance::default());
        apply(&[3e-6, 5e-6, 4e-6], "base", &mut subject);
        assert_ne!(subject.structure.base_frame, FrameCompliance::default());
    }

    #[test]
    fn alike_about_x_and_y_it_is_the_base_compliance() {
        let force_n = Vector3::new(5.0, -3.0, -10.0);
        let frame = by_frame(&[2e-6, 2e-6, 0.0, 0.0, 0.0, 0.0], "base", &[0.7, 0.3], force_n);
        let mut subject = two_link_subject();
        subject.structure.gravity_m_s2 = 0.0;
        (super::super::base_compliance::KIND.apply)(&[5e5], "base", &mut subject);
        let chain = Chain::new(&subject.structure, LinkModel::Rigid);
        let statics = chain.pose_rad(&[0.7, 0.3], &Payload::default(), force_n);
        let statics = statics.statics();
        let base = statics.shares_m.iter().find(|(n, _)| *n == "base").expect("share").1;
        assert!((frame - base).norm() < 1e-15);
    }
}
