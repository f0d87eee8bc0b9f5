//! Finds a first placement of the arm in the instrument's frame, and the attitude of the part outboard of each link of
//! unknown mounting. No starting values are needed.

use super::fit::likeliest;
use super::fitted::{Fitted, Sample};
use super::kinematics::{Geometry, Number, mount_numbers};
use super::tree::Tree;
use crate::reconcile::readings::campaign::PositionsSpec;
use nalgebra::{Matrix3, Rotation3, Vector3};
use rayon::prelude::*;

/// Scale of the position errors with which each fit starts \[m\]: about the errors that a wrong attitude causes.
const ROUGH_M: f64 = 0.3;

/// Smallest number of positions with all three coordinates from which the nearest rigid motion is computed. With
/// fewer, a fit from several attitudes is used.
const FEWEST_WHOLE: usize = 10;

/// Finds a first placement of the base, which all arms share, and a first attitude of links of unknown mounting. Stores
/// both in `geometry`. If an arm has a link of unknown mounting, the part outboard of the first such link is put into
/// each of the 24 attitudes of a cube. A fit starts from each of these attitudes, and the best fit is used. If the
/// first arms have no such link, the base is placed by the rigid motion that brings the nominal points nearest to the
/// measured ones.
pub(crate) fn align(tree: &Tree, spec: &PositionsSpec, samples: &[Sample], geometry: &mut Geometry) {
    let mounts = mount_numbers(tree, spec);
    let mut placed = false;
    for arm in 0..tree.arms.len() {
        let own: Vec<&Sample> = samples.iter().filter(|s| s.arm == arm).collect();
        let pieces: Vec<usize> = tree.arms[arm].clone();
        let numbers: Vec<Number> = mounts
            .iter()
            .filter(|n| matches!(n, Number::Mount(i, _) | Number::MountVector(i, _) if pieces.contains(i)))
            .cloned()
            .collect();
        match numbers.first() {
            Some(Number::Mount(piece, _)) => {
                *geometry = settle_mount(&own, geometry, *piece, numbers, spec, placed);
                placed = true;
            }
            _ if !placed && spec.base_placement => {
                nearest_motion(&own, geometry);
                placed = true;
            }
            _ => {}
        }
    }
}

/// Finds the best of a cube's 24 attitudes for the part outboard of a link of unknown mounting (the piece with index
/// `piece`), and returns the geometry with this attitude. `own` are the arm's samples (measured positions). `placed`
/// says whether the base is already placed.
fn settle_mount(
    own: &[&Sample],
    geometry: &Geometry,
    piece: usize,
    mut numbers: Vec<Number>,
    spec: &PositionsSpec,
    placed: bool,
) -> Geometry {
    let points: Vec<usize> =
        (0..geometry.tools_m.len()).filter(|p| own.iter().any(|s| s.point == *p)).collect();
    if spec.tool_offset {
        numbers.extend(points.iter().flat_map(|&p| (0..3).map(move |c| Number::Tool(p, c))));
    }
    if spec.base_placement && !placed {
        numbers.extend((0..3).map(Number::BaseRotation).chain((0..3).map(Number::BasePosition)));
    }
    let tried: Vec<Fitted> = cube()
        .into_par_iter()
        .map(|rotation| {
            let mut start = geometry.clone();
            start.set_mount(piece, rotation);
            if spec.base_placement && !placed {
                nearest_motion(own, &mut start);
            }
            likeliest(own, &numbers, &[], &Fitted::rigid(start, ROUGH_M))
        })
        .collect();
    let best = tried.into_iter().min_by(|a, b| a.scale_m.total_cmp(&b.scale_m));
    best.expect("24 attitudes").geometry
}

/// Places the arm by a fit from each of the 24 attitudes of a cube, and stores the best in `geometry`. It is used if
/// too few positions have all three coordinates.
fn nearest_attitude(samples: &[&Sample], geometry: &mut Geometry) {
    let numbers: Vec<Number> =
        (0..3).map(Number::BaseRotation).chain((0..3).map(Number::BasePosition)).collect();
    let from = |rotation| {
        let mut start = geometry.clone();
        (start.base, start.origin_m) = (rotation, Vector3::zeros());
        likeliest(samples, &numbers, &[], &Fitted::rigid(start, ROUGH_M))
    };
    let tried: Vec<Fitted> = cube().into_par_iter().map(from).collect();
    let best = tried.into_iter().min_by(|a, b| a.scale_m.total_cmp(&b.scale_m));
    *geometry = best.expect("24 attitudes").geometry;
}

/// The 24 rotations that map a cube onto itself.
fn cube() -> Vec<Rotation3<f64>> {
    let axes: Vec<Vector3<f64>> =
        (0..3).flat_map(|c| [Vector3::ith(c, 1.0), Vector3::ith(c, -1.0)]).collect();
    let mut out = Vec::new();
    for x in &axes {
        for y in axes.iter().filter(|y| y.dot(x) == 0.0) {
            out.push(Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[*x, *y, x.cross(y)])));
        }
    }
    out
}

/// Finds the rotation and the origin of the base that move the nominal points onto the measured ones (Kabsch's
/// algorithm), and stores them in `geometry`. The computation is repeated with the 90 % of points that have the
/// smallest errors. If too few positions have all three coordinates, [`nearest_attitude`] is used instead.
pub(super) fn nearest_motion(samples: &[&Sample], geometry: &mut Geometry) {
    let whole: Vec<&Sample> = samples.iter().copied().filter(|s| s.readings() == 3).collect();
    if whole.len() < FEWEST_WHOLE.min(samples.len()) {
        return nearest_attitude(samples, geometry);
    }
    let samples = whole.as_slice();
    (geometry.base, geometry.origin_m) = (Rotation3::identity(), Vector3::zeros());
    let mut placer = geometry.placer();
    let nominal: Vec<Vector3<f64>> = samples.iter().map(|s| placer.place_m(s.placing())).collect();
    let mut kept: Vec<usize> = (0..samples.len()).collect();
    for _ in 0..4 {
        let count = kept.len() as f64;
        let from = kept.iter().map(|&i| nominal[i]).sum::<Vector3<f64>>() / count;
        let to = kept.iter().map(|&i| samples[i].measured_m).sum::<Vector3<f64>>() / count;
        let h: Matrix3<f64> =
            kept.iter().map(|&i| (nominal[i] - from) * (samples[i].measured_m - to).transpose()).sum();
        let svd = h.svd(true, true);
        let (Some(u), Some(vt)) = (svd.u, svd.v_t) else { return };
        let mut flip = Matrix3::identity();
        // the determinant decides between a rotation and a reflection
        flip[(2, 2)] = (vt.transpose() * u.transpose()).determinant().signum();
        let rotation = Rotation3::from_matrix_unchecked(vt.transpose() * flip * u.transpose());
        let origin = to - rotation * from;
        geometry.base = rotation;
        geometry.origin_m = origin;
        let error = |i: usize| (samples[i].measured_m - origin - rotation * nominal[i]).norm();
        let mut order: Vec<usize> = (0..samples.len()).collect();
        order.sort_by(|&i, &j| error(i).total_cmp(&error(j)));
        // the 10 % with the largest errors are left out, because gross errors must not turn the arm
        order.truncate((samples.len() * 9).div_ceil(10).max(4));
        kept = order;
    }
}
