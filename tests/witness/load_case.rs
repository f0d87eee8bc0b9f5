//! Pose, payload and tip force.

use nalgebra::Vector3;
use serde_json::Value;

use super::arm::{number, vector};

/// What the arm carries; a rigid body fixed to the last frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Payload {
    pub mass_kg: f64,
    /// Centre of mass from the tip, last frame.
    pub cg_m: Vector3<f64>,
    /// Principal inertias about the centre of mass, last frame.
    pub inertia_about_cg_kgm2: Vector3<f64>,
    /// Weight over mass times gravity: less than one in a fluid.
    pub weight_factor: f64,
}

impl Payload {
    pub fn none() -> Self {
        Self::point(0.0, [0.0; 3])
    }

    pub fn point(mass_kg: f64, cg_m: [f64; 3]) -> Self {
        Self {
            mass_kg,
            cg_m: Vector3::from(cg_m),
            inertia_about_cg_kgm2: Vector3::zeros(),
            weight_factor: 1.0,
        }
    }

    /// Inertia as `[ixx, iyy, izz]`, or as an object with any of those keys, or absent.
    fn from_json(payload: &Value) -> Self {
        if payload.is_null() {
            return Self::none();
        }
        let inertia = &payload["inertia_about_cg_kgm2"];
        let keyed = |key: &str| inertia[key].as_f64().unwrap_or(0.0);
        let inertia_about_cg_kgm2 =
            if inertia.is_array() { vector(inertia) } else { ["ixx", "iyy", "izz"].map(keyed).into() };
        let cg_m = if payload["cg_m"].is_null() { Vector3::zeros() } else { vector(&payload["cg_m"]) };
        Self { mass_kg: number(payload, "mass_kg"), cg_m, inertia_about_cg_kgm2, weight_factor: 1.0 }
    }
}

/// One pose under one load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCase {
    /// One angle a joint.
    pub pose_deg: Vec<f64>,
    pub payload: Payload,
    /// World axes, at the tip.
    pub tip_force_n: Vector3<f64>,
}

impl LoadCase {
    /// A pose with nothing in the hand.
    pub fn unloaded(pose_deg: &[f64]) -> Self {
        Self { pose_deg: pose_deg.to_vec(), payload: Payload::none(), tip_force_n: Vector3::zeros() }
    }

    pub fn with_payload(self, payload: Payload) -> Self {
        Self { payload, ..self }
    }

    pub fn with_tip_force(self, force_n: [f64; 3]) -> Self {
        Self { tip_force_n: Vector3::from(force_n), ..self }
    }

    /// An object with `pose_deg`, `payload` and `tip_force_n`, the last two optional.
    pub fn from_json(case: &Value) -> Self {
        let angles = case["pose_deg"].as_array().expect("a load case has a pose");
        let force = &case["tip_force_n"];
        Self {
            pose_deg: angles.iter().map(|angle| angle.as_f64().expect("an angle")).collect(),
            payload: Payload::from_json(&case["payload"]),
            tip_force_n: if force.is_null() { Vector3::zeros() } else { vector(force) },
        }
    }
}
