//! Tests of `frame_compliance`.

use super::super::validate::testing::two_link_subject;
use super::*;
use crate::arm::LinkModel;
use crate::arm::load::Payload;
use crate::mechanics::chain::Chain;
use nalgebra::Vector3;

/// The displacement of the tip that the frame compliance alone causes under a force at the tip.
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
    // arm stretched and turned about z by q: the tip is 1 m away
    let tip = Vector3::new(libm::cos(q), libm::sin(q), 0.0);
    let rotation = matrix(&numbers) * tip.cross(&force_n);
    let base = by_frame(&numbers, "base", &[q, 0.0], force_n);
    assert!((base - rotation.cross(&tip)).norm() < 1e-15, "{base}");
    // the root of the forearm is at half that distance, and its frame is turned by q
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

#[test]
fn the_base_is_meant_where_a_link_has_its_name_too() {
    let numbers = [3e-6, 5e-6, 4e-6, 0.0, 0.0, 0.0];
    let mut subject = two_link_subject();
    let link = subject.structure.links().next().expect("a link").name.clone();
    subject.structure.link_mut(&link).expect("a link").name = "base".into();
    apply(&numbers, "base", &mut subject);
    assert_eq!(subject.structure.base_frame.0, matrix(&numbers));
    assert_eq!(subject.structure.links().next().expect("a link").root_frame.0, Matrix3::zeros());
}
