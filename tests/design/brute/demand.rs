//! What is asked of a joint in one pose: Eqs 7 and 8.

use nalgebra::{Matrix3, Unit, Vector3};

use super::arm::{Body, Chosen, turned};
use super::bearing::{Load, Loads, loads};
use super::study::{Piece, Pose, Posed, Study};

/// Torques on a joint in one pose.
#[derive(Clone, Copy, Debug)]
pub struct Torques {
    pub static_nm: f64,
    pub linear_nm: f64,
}

/// All that a drive has to hold.
#[derive(Clone, Copy, Debug)]
pub struct Demand {
    pub speed_rad_s: f64,
    pub acceleration_rad_s2: f64,
    pub stop_factor: f64,
    /// The largest static torque of all sizing poses, and the largest linear torque of all.
    pub worst: Torques,
    /// The largest loads on the output bearing.
    pub bearing: Loads,
}

impl Demand {
    /// The same motion against other torques and loads.
    pub fn with_torques_times(&self, factor: f64) -> Self {
        let Torques { static_nm, linear_nm } = self.worst;
        let Loads { at_rest, running, in_stop, .. } = self.bearing;
        let [at_rest, running, in_stop] =
            [at_rest, running, in_stop].map(|load| between(&Load::default(), &load, factor));
        Self {
            worst: Torques { static_nm: factor * static_nm, linear_nm: factor * linear_nm },
            bearing: Loads { at_rest, running, in_stop, ..self.bearing },
            ..*self
        }
    }

    /// A slower motion, with the same time for the ramp. What ramps and stops add to the loads on the bearing is taken as
    /// linear, which is on the safe side.
    pub fn with_speed_times(&self, factor: f64) -> Self {
        Self {
            speed_rad_s: factor * self.speed_rad_s,
            acceleration_rad_s2: factor * self.acceleration_rad_s2,
            worst: Torques { linear_nm: factor * self.worst.linear_nm, ..self.worst },
            bearing: Loads {
                running: between(&self.bearing.at_rest, &self.bearing.running, factor),
                in_stop: between(&self.bearing.at_rest, &self.bearing.in_stop, factor),
                ..self.bearing
            },
            ..*self
        }
    }
}

/// A load between two.
fn between(a: &Load, b: &Load, part: f64) -> Load {
    let mix = |a: f64, b: f64| a + part * (b - a);
    Load {
        moment_nm: mix(a.moment_nm, b.moment_nm),
        radial_n: mix(a.radial_n, b.radial_n),
        axial_n: mix(a.axial_n, b.axial_n),
    }
}

/// The axis of the joint at `index` in the world. It turns with the joints before it; turning about itself leaves it.
pub fn axis_in(study: &Study, posed: &Posed, index: usize) -> Unit<Vector3<f64>> {
    let Piece::Joint { axis, .. } = &study.pieces[index] else { panic!("not a joint") };
    Unit::new_normalize(posed.places[index].frame * axis)
}

/// Largest distance of the tip from the axis of the joint at `index`, and at least the smallest lever.
fn lever_m(study: &Study, sizing: &[(&Pose, Posed)], index: usize) -> f64 {
    let reach_m = sizing.iter().map(|(_, posed)| {
        let to_tip = posed.tip_m - posed.places[index].start_m;
        to_tip.cross(&axis_in(study, posed, index)).norm()
    });
    reach_m.fold(study.motion.min_lever_m, f64::max)
}

/// Largest speed of the joint at `index`.
pub fn speed_rad_s(study: &Study, sizing: &[(&Pose, Posed)], index: usize) -> f64 {
    let Piece::Joint { max_speed_rad_s, .. } = &study.pieces[index] else { panic!("not a joint") };
    max_speed_rad_s.unwrap_or(study.motion.tip_speed_m_s / lever_m(study, sizing, index))
}

/// How many times as hard as in its ramp the joint at `index` is slowed down in a stop.
pub fn stop_factor(study: &Study, sizing: &[(&Pose, Posed)], index: usize) -> f64 {
    let Some(stop_m_s2) = study.motion.stop_m_s2 else { return 2.0 };
    let stop_rad_s2 = stop_m_s2 / lever_m(study, sizing, index);
    (stop_rad_s2 * study.motion.ramp_time_s / speed_rad_s(study, sizing, index)).max(1.0)
}

/// The demand on the joint at `index`; `outboard` are the pieces beyond it, nearest first.
pub fn demand(study: &Study, sizing: &[(&Pose, Posed)], index: usize, outboard: &[Chosen]) -> Demand {
    let speed_rad_s = speed_rad_s(study, sizing, index);
    let acceleration_rad_s2 = speed_rad_s / study.motion.ramp_time_s;
    let torques = |(pose, posed): &(&Pose, Posed)| {
        let bodies = bodies(study, pose, posed, index, outboard);
        let (axis, at_m) = (axis_in(study, posed, index), posed.places[index].start_m);
        let force_nm = axis.dot(&(posed.tip_m - at_m).cross(&pose.case.tip_force_n));
        let gravity_nm = |body: &Body| {
            let weight_n = Vector3::new(0.0, 0.0, -body.mass_kg * study.gravity_m_s2);
            axis.dot(&(body.centre_m - at_m).cross(&weight_n))
        };
        let static_nm = force_nm + bodies.iter().map(gravity_nm).sum::<f64>();
        let inertia_kgm2: f64 = bodies.iter().map(|body| about_axis_kgm2(body, &axis, &at_m)).sum();
        Torques { static_nm: static_nm.abs(), linear_nm: inertia_kgm2 * acceleration_rad_s2 }
    };
    let larger = |a: Torques, b: Torques| Torques {
        static_nm: a.static_nm.max(b.static_nm),
        linear_nm: a.linear_nm.max(b.linear_nm),
    };
    let worst = sizing.iter().map(torques).reduce(larger).expect("a study sizes in some pose");
    let stop_factor = stop_factor(study, sizing, index);
    Demand {
        speed_rad_s,
        acceleration_rad_s2,
        stop_factor,
        worst,
        bearing: loads(study, sizing, index, outboard),
    }
}

/// Everything beyond the piece at `index`, the payload too.
pub fn bodies(study: &Study, pose: &Pose, posed: &Posed, index: usize, outboard: &[Chosen]) -> Vec<Body> {
    let pieces = outboard.iter().zip(&posed.places[index + 1..]);
    let mut bodies: Vec<Body> = pieces.map(|(piece, place)| piece.body(place)).collect();
    let beyond = study.pieces.iter().zip(&posed.places).skip(index + 1);
    bodies.extend(beyond.filter_map(|(piece, place)| study.added(piece, place)));
    let frame = &posed.places[posed.places.len() - 1].frame;
    let payload = &pose.case.payload;
    bodies.push(Body {
        mass_kg: payload.mass_kg,
        centre_m: posed.tip_m + frame * payload.cg_m,
        inertia_kgm2: turned(frame, &Matrix3::from_diagonal(&payload.inertia_about_cg_kgm2)),
    });
    bodies
}

fn about_axis_kgm2(body: &Body, axis: &Vector3<f64>, at_m: &Vector3<f64>) -> f64 {
    let off_axis_m = (body.centre_m - at_m).cross(axis).norm();
    axis.dot(&(body.inertia_kgm2 * axis)) + body.mass_kg * off_axis_m * off_axis_m
}
