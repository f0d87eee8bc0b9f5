//! Output bearings: what loads them and what they hold, from Newton's law and the vendor's procedure.
//!
//! | quantity | definition |
//! |---|---|
//! | load at rest | force and moment about the joint of the weights and the tip force outboard of it |
//! | ramp of a joint k | force -m a and moment of every body outboard of both joints, a = alpha_k x (c - p_k) |
//! | lever | the link beside the joint is that thick along the axis: half of it, or the stated offset |
//! | running moment | M + (lever + R) F_r at most the permissible one, in every ramp |
//! | static safety | C0 / (F_r + 2 M / d_p + 0.44 F_a): 3 at rest, 2 in a stop |
//! | life | 1e6 / (60 n) (C / (1.3 P))^(10/3) h, P = X (F_r + 2 M / d_p) + Y F_a at rest; X, Y = 1, 0.45, or 0.67 both |
//!
//! Of moment, radial and axial force each has its largest value of all sizing poses, of all joints that may move and of
//! both directions.

use nalgebra::{Unit, Vector3};
use serde_json::{Value, json};
use std::f64::consts::TAU;

use super::arm::{Body, Chosen, Link, section_axes};
use super::catalog::{Catalog, Row};
use super::demand::{axis_in, bodies, speed_rad_s, stop_factor};
use super::study::{Piece, Pose, Posed, Study};

/// The numbers of a bearing; blank ones are not checked.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bearing {
    pub tilt_nm_per_rad: Option<f64>,
    pub mass_kg: f64,
    stated_offset_m: Option<f64>,
    permissible_nm: Option<f64>,
    pitch_m: Option<f64>,
    flange_m: Option<f64>,
    static_n: Option<f64>,
    dynamic_n: Option<f64>,
}

/// Where a joint's bearing comes from.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    OfGear,
    Stated(Option<Bearing>),
}

/// Moment across the axis, force across it, force along it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Load {
    pub moment_nm: f64,
    pub radial_n: f64,
    pub axial_n: f64,
}

/// The largest loads.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loads {
    pub at_rest: Load,
    pub running: Load,
    pub in_stop: Load,
    /// Half the thickness of the link beside the joint \[m\].
    pub half_link_m: f64,
}

impl Bearing {
    /// Of a housed gear.
    pub fn of_gear(gear: &Row) -> Self {
        Self {
            tilt_nm_per_rad: gear.number("tilting_stiffness_nm_per_rad"),
            mass_kg: 0.0,
            stated_offset_m: None,
            permissible_nm: gear.number("permissible_tilting_moment_nm"),
            pitch_m: gear.number("bearing_pitch_diameter_m"),
            flange_m: gear.number("bearing_offset_m"),
            static_n: gear.number("bearing_static_load_rating_n"),
            dynamic_n: gear.number("bearing_dynamic_load_rating_n"),
        }
    }

    /// As an arm file has it.
    pub fn entry(&self) -> Value {
        json!({"tilt_stiffness_nm_per_rad": self.tilt_nm_per_rad, "mass_kg": self.mass_kg})
    }

    /// Whether it holds these loads in a joint that turns at a mean speed for so long.
    pub fn holds(&self, loads: &Loads, mean_rad_s: f64, life_h: f64) -> bool {
        let lever_m = self.stated_offset_m.map(f64::abs);
        let lever_m = lever_m.unwrap_or(loads.half_link_m + self.flange_m.unwrap_or(0.0));
        let moment_nm = |load: &Load| load.moment_nm + lever_m * load.radial_n;
        if self.permissible_nm.is_some_and(|most_nm| moment_nm(&loads.running) > most_nm) {
            return false;
        }
        let Some(pitch_m) = self.pitch_m else { return true };
        let across_n = |load: &Load| load.radial_n + 2.0 * moment_nm(load) / pitch_m;
        let safety = |load: &Load| {
            self.static_n.map_or(f64::INFINITY, |c0_n| c0_n / (across_n(load) + 0.44 * load.axial_n))
        };
        let (across, axial) = (across_n(&loads.at_rest), loads.at_rest.axial_n);
        let [x, y] = if axial / across > 1.5 { [0.67, 0.67] } else { [1.0, 0.45] };
        let turns_an_hour = 3600.0 * mean_rad_s / TAU;
        let lives_h = self.dynamic_n.map_or(f64::INFINITY, |c_n| {
            1e6 / turns_an_hour * (c_n / (1.3 * (x * across + y * axial))).powf(10.0 / 3.0)
        });
        safety(&loads.at_rest) >= 3.0 && safety(&loads.in_stop) >= 2.0 && lives_h >= life_h
    }
}

impl Source {
    /// What a joint of a study says.
    pub fn read(joint: &Value, catalog: &Catalog) -> Self {
        let Some(stated) = joint.get("bearing") else {
            // a given drive brings the bearing of the gear that it names, and here none names one
            return if joint["drive"].is_string() { Self::OfGear } else { Self::Stated(None) };
        };
        if let Some(name) = stated.as_str() {
            let gear = catalog.gears.iter().find(|gear| gear.id == name).expect("a gear");
            let [housed_kg, set_kg] = ["mass_housed_unit_kg", "mass_component_set_kg"]
                .map(|column| gear.number(column).expect("a mass"));
            return Self::Stated(Some(Bearing { mass_kg: housed_kg - set_kg, ..Bearing::of_gear(gear) }));
        }
        let number = |key: &str| stated[key].as_f64();
        Self::Stated(stated.is_object().then(|| Bearing {
            tilt_nm_per_rad: number("tilt_stiffness_nm_per_rad"),
            mass_kg: number("mass_kg").unwrap_or(0.0),
            stated_offset_m: number("offset_m"),
            permissible_nm: number("permissible_moment_nm"),
            pitch_m: number("pitch_diameter_m"),
            flange_m: None,
            static_n: number("static_load_rating_n"),
            dynamic_n: number("dynamic_load_rating_n"),
        }))
    }

    /// The bearing beside a gear whose own is `own`.
    pub fn beside(&self, own: Option<Bearing>) -> Option<Bearing> {
        match self {
            Self::OfGear => own,
            Self::Stated(stated) => *stated,
        }
    }
}

/// Force and moment about a point.
#[derive(Clone, Copy, Default)]
struct Wrench {
    force_n: Vector3<f64>,
    moment_nm: Vector3<f64>,
}

impl Wrench {
    fn add(&mut self, force_n: Vector3<f64>, lever_m: Vector3<f64>) {
        self.force_n += force_n;
        self.moment_nm += lever_m.cross(&force_n);
    }

    fn with(&self, other: &Self, times: f64) -> Self {
        Self {
            force_n: self.force_n + times * other.force_n,
            moment_nm: self.moment_nm + times * other.moment_nm,
        }
    }
}

/// The loads on the bearing of the joint at `index`; `outboard` are the pieces beyond it, nearest first.
pub fn loads(study: &Study, sizing: &[(&Pose, Posed)], index: usize, outboard: &[Chosen]) -> Loads {
    let mut largest = Loads { half_link_m: half_link_m(study, index, outboard), ..Loads::default() };
    for (pose, posed) in sizing {
        let (axis, at_m) = (axis_in(study, posed, index), posed.places[index].start_m);
        let mut rest = Wrench::default();
        rest.add(pose.case.tip_force_n, posed.tip_m - at_m);
        for body in bodies(study, pose, posed, index, outboard) {
            let weight_n = Vector3::new(0.0, 0.0, -body.mass_kg * study.gravity_m_s2);
            rest.add(weight_n, body.centre_m - at_m);
        }
        take(&mut largest.at_rest, &rest, &axis);
        for mover in (0..study.pieces.len()).filter(|&k| matches!(study.pieces[k], Piece::Joint { .. })) {
            let carrier = index.max(mover);
            let moved = bodies(study, pose, posed, carrier, &outboard[carrier - index..]);
            let alpha = axis_in(study, posed, mover).into_inner()
                * (speed_rad_s(study, sizing, mover) / study.motion.ramp_time_s);
            let ramp = inertia_forces(&moved, &alpha, &posed.places[mover].start_m, &at_m);
            for sign in [1.0, -1.0] {
                take(&mut largest.running, &rest.with(&ramp, sign), &axis);
                take(
                    &mut largest.in_stop,
                    &rest.with(&ramp, sign * stop_factor(study, sizing, mover)),
                    &axis,
                );
            }
        }
    }
    largest
}

/// Inertia forces of bodies that begin to turn about an axis, with their moment about a point.
fn inertia_forces(
    bodies: &[Body],
    alpha_rad_s2: &Vector3<f64>,
    axis_at_m: &Vector3<f64>,
    at_m: &Vector3<f64>,
) -> Wrench {
    let mut sum = Wrench::default();
    for body in bodies {
        let acceleration_m_s2 = alpha_rad_s2.cross(&(body.centre_m - axis_at_m));
        sum.add(-body.mass_kg * acceleration_m_s2, body.centre_m - at_m);
        sum.moment_nm -= body.inertia_kgm2 * alpha_rad_s2;
    }
    sum
}

fn take(largest: &mut Load, wrench: &Wrench, axis: &Unit<Vector3<f64>>) {
    let across = |v: &Vector3<f64>| (v - axis.into_inner() * axis.dot(v)).norm();
    largest.moment_nm = largest.moment_nm.max(across(&wrench.moment_nm));
    largest.radial_n = largest.radial_n.max(across(&wrench.force_n));
    largest.axial_n = largest.axial_n.max(axis.dot(&wrench.force_n).abs());
}

/// Half the thickness along the axis of a tube beside the joint: of its half sides as two perpendicular legs.
fn half_link_m(study: &Study, index: usize, outboard: &[Chosen]) -> f64 {
    let Piece::Joint { axis, .. } = &study.pieces[index] else { panic!("not a joint") };
    let Some(Chosen::Link(Link { vector_m, option: Some(option), .. })) = outboard.first() else {
        return 0.0;
    };
    let sides = section_axes(vector_m).transpose() * axis;
    (option.tube.width_m * sides.y).hypot(option.tube.height_m * sides.z) / 2.0
}
