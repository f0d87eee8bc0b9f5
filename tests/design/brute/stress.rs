//! The stress in the links at peak load.
//!
//! Peak load is gravity, payload and tip force times 1 + a / g in the sizing poses, the paper's reading of Eq 8, and
//! times 1 in the others. At
//! either end of a link, bending in both planes and the axial force add up at the worst corner (round: on the rim);
//! with the shear stress of torsion they make an equivalent stress. Transverse shear is left out. The normal stress is
//! compared with the lower of the strengths in tension and in compression, the shear stress with the strength in shear,
//! and the squares of both ratios add (Tsai and Hill); without a strength in shear this is von Mises' stress.

use nalgebra::Vector3;

use super::arm::{Chosen, Link, Tube, section_axes};
use super::demand::bodies;
use super::study::{Pose, Posed, Study};
use crate::witness::rectangle_in_torsion;

/// Strength over the largest stress of all links in all poses; none if no strength is known.
pub fn stress_safety_factor(study: &Study, poses: &[(&Pose, Posed)], chain: &[Chosen]) -> Option<f64> {
    let peak = 1.0 + study.motion.tip_speed_m_s / study.motion.ramp_time_s / study.gravity_m_s2;
    let mut least: Option<f64> = None;
    for (index, piece) in chain.iter().enumerate() {
        let Chosen::Link(Link { option: Some(option), vector_m, .. }) = piece else { continue };
        for pose in poses {
            let load = if pose.0.sizes { peak } else { 1.0 };
            for is_root in [true, false] {
                let (force_n, moment_nm) = wrench(study, pose, index, chain, is_root);
                let axes = pose.1.places[index].frame * section_axes(vector_m);
                let (force_n, moment_nm) = (axes.transpose() * force_n, axes.transpose() * moment_nm);
                let [normal_pa, shear_pa] = stresses_pa(&option.tube, &force_n, &moment_nm);
                let strength_pa = option.strength_pa?;
                let shear_strength_pa = option.shear_strength_pa.unwrap_or(strength_pa / 3f64.sqrt());
                let used = (normal_pa / strength_pa).hypot(shear_pa / shear_strength_pa);
                let factor = 1.0 / (load * used);
                least = Some(least.map_or(factor, |other| other.min(factor)));
            }
        }
    }
    least
}

/// Force and moment at an end of the link at `index`, of everything beyond.
fn wrench(
    study: &Study,
    (pose, posed): &(&Pose, Posed),
    index: usize,
    chain: &[Chosen],
    is_root: bool,
) -> (Vector3<f64>, Vector3<f64>) {
    let mut beyond = bodies(study, pose, posed, index, &chain[index + 1..]);
    let at_m = match is_root {
        true => posed.places[index].start_m,
        false => posed.places.get(index + 1).map_or(posed.tip_m, |place| place.start_m),
    };
    if is_root {
        beyond.push(chain[index].body(&posed.places[index]));
        beyond.extend(study.added(&study.pieces[index], &posed.places[index]));
    }
    let tip_force_n = pose.case.tip_force_n;
    let mut total = (tip_force_n, (posed.tip_m - at_m).cross(&tip_force_n));
    for body in beyond {
        let weight_n = Vector3::new(0.0, 0.0, -body.mass_kg * study.gravity_m_s2);
        total.0 += weight_n;
        total.1 += (body.centre_m - at_m).cross(&weight_n);
    }
    total
}

/// The largest normal stress and the largest shear stress.
fn stresses_pa(tube: &Tube, force_n: &Vector3<f64>, moment_nm: &Vector3<f64>) -> [f64; 2] {
    let bending_pa = if tube.is_round {
        moment_nm.y.hypot(moment_nm.z) * tube.width_m / 2.0 / tube.over_z2_m4
    } else {
        moment_nm.y.abs() * tube.height_m / 2.0 / tube.over_z2_m4
            + moment_nm.z.abs() * tube.width_m / 2.0 / tube.over_y2_m4
    };
    let normal_pa = bending_pa + force_n.x.abs() / tube.area_m2;
    let shear_pa = moment_nm.x.abs() * shear_per_torque_1_m3(tube);
    [normal_pa, shear_pa]
}

/// A rectangle as in the finite elements; a round section exactly, on its outside.
fn shear_per_torque_1_m3(tube: &Tube) -> f64 {
    if tube.is_round {
        return tube.width_m / 2.0 / (2.0 * tube.over_z2_m4);
    }
    rectangle_in_torsion(tube.width_m, tube.height_m, tube.wall_m).1
}
