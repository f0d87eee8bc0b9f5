//! Makes arms, and the loads and instruments with which they are measured.

use super::{Dice, three};
use nalgebra::{Rotation3, Vector3};
use serde_json::{Value, json};

const GRAVITY: f64 = 9.81;

/// An arm file and the rig that measures the arm.
#[derive(Clone)]
pub struct Specimen {
    pub arm: Value,
    pub rig: Rig,
}

/// Loads, instruments and what the drawing allows.
#[derive(Clone)]
pub struct Rig {
    /// Light, middle and heavy payload of static tests.
    pub payloads_kg: [f64; 3],
    /// Payload of modal tests, and its distance from the tip.
    pub modal_payload: (f64, f64),
    /// Least and greatest distance of a payload from the tip, and its direction in the last frame.
    pub cg_m: [f64; 2],
    pub cg_along: [f64; 3],
    /// Greatest component of a tip force.
    pub force_n: f64,
    /// Greatest angle of each joint.
    pub ranges_deg: Vec<f64>,
    /// Standard deviations: of a displacement, of a frequency as a part of it, of a twist.
    pub sigma_mm: f64,
    pub modal_sigma: f64,
    pub sigma_arcmin: f64,
    pub modes: usize,
    /// Joints that go to the bench.
    pub bench: Vec<String>,
    /// Of joints' stiffness and mass, and of moduli.
    pub stiffness_tolerance: f64,
    pub mass_tolerance: f64,
    pub modulus_tolerance: f64,
    pub sizes: Sizes,
}

/// Typical sizes of effects.
#[derive(Clone)]
pub struct Sizes {
    pub extra_kg: f64,
    pub harness_kg_per_m: f64,
    pub payload_kg: f64,
    pub cg_m: f64,
    pub bias_mm: f64,
    pub drift_mm_per_row: f64,
    /// Stiffness of what stands on nothing stiffer.
    pub base_nm_per_rad: f64,
}

impl Specimen {
    /// An arm file with the rig of a six-axis arm of its size.
    pub fn six_axis_of(arm: Value) -> Self {
        let rig = Rig {
            payloads_kg: [2.5, 5.0, 10.0],
            modal_payload: (5.0, 0.08),
            cg_m: [0.03, 0.1],
            cg_along: [1.0, 0.0, 0.0],
            force_n: 100.0,
            ranges_deg: vec![180.0, 80.0, 120.0, 180.0, 110.0, 180.0],
            sigma_mm: 0.006,
            modal_sigma: 0.003,
            sigma_arcmin: 0.03,
            modes: 4,
            bench: ["j2", "j3", "j5"].map(String::from).to_vec(),
            stiffness_tolerance: 0.05,
            mass_tolerance: 0.01,
            modulus_tolerance: 0.02,
            sizes: Sizes {
                extra_kg: 2.0,
                harness_kg_per_m: 3.0,
                payload_kg: 0.4,
                cg_m: 0.03,
                bias_mm: 0.01,
                drift_mm_per_row: 1.5e-4,
                base_nm_per_rad: 5e5,
            },
        };
        Self { arm, rig }
    }

    /// A random six-axis arm.
    pub fn six_axis(dice: &mut Dice) -> Self {
        let (e, g, density, name) = *dice.pick(&MATERIALS);
        let k = dice.rounded(2.5e5, 7e5, -3);
        let tube =
            |w: f64, t: f64| json!({"shape": "rectangular_tube", "width_m": w, "height_m": w, "wall_m": t});
        let joint = |name: &str, axis: [f64; 3], k: f64, m: f64| json!({"type": "joint", "name": name, "axis": axis, "stiffness_nm_per_rad": k, "mass_kg": m});
        let link = |n: &str, v: [f64; 3], section: Value| json!({"type": "link", "name": n, "vector_m": v, "section": section, "material": name});
        let (z, y, x) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        Self::six_axis_of(json!({
            "name": format!("{name}-arm"), "gravity_m_s2": GRAVITY,
            "materials": {name: {"youngs_modulus_pa": e, "shear_modulus_pa": g, "density_kg_m3": density}},
            "chain": [
                joint("j1", z, k, 12.0),
                link("column", [0.0, 0.0, dice.rounded(0.25, 0.4, 3)], tube(0.18, 0.01)),
                joint("j2", y, k, 12.0),
                link("upper_arm", [dice.rounded(0.6, 0.9, 3), 0.0, 0.0], tube(0.14, 0.007)),
                joint("j3", y, (0.65 * k).round(), 8.5),
                link("forearm", [dice.rounded(0.4, 0.6, 3), 0.0, 0.0], tube(0.1, 0.006)),
                joint("j4", x, (0.18 * k).round(), 3.0),
                joint("j5", y, (0.18 * k).round(), 3.0),
                link("hand", [dice.rounded(0.08, 0.16, 3), 0.0, 0.0], tube(0.08, 0.008)),
                joint("j6", x, (0.03 * k).round(), 3.0),
            ],
        }))
    }

    /// An arm of four to seven joints, from a tenth to ten times the weight of the six-axis one, on floor, wall or
    /// ceiling, with instruments of its own; so large a part of its joints have a torsion curve.
    pub fn varied(dice: &mut Dice, curved: f64) -> Self {
        let plan = *dice.pick(&PLANS);
        let size = 10f64.powf(dice.between(-0.4, 0.4));
        let payload_kg = dice.rounded(2.0, 20.0, 1) * size.powi(2);
        let payload_kg = (payload_kg * 10.0).ceil() / 10.0;
        let mounted = match (dice.uniform() * 3.0) as usize {
            0 => Rotation3::identity(),
            1 => Rotation3::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2),
            _ => Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI),
        };
        let turned = |v: [f64; 3]| -> [f64; 3] {
            (mounted * Vector3::from(v)).map(|x| (x * 1e6).round() / 1e6 + 0.0).into()
        };
        let chain = chain(dice, plan, size, payload_kg, curved, &turned);
        let joints: Vec<String> = named(&chain, "joint");
        let materials: serde_json::Map<String, Value> = MATERIALS
            .iter()
            .filter(|(.., name)| chain.iter().any(|part| part["material"] == *name))
            .map(|(e, g, density, name)| {
                let numbers =
                    json!({"youngs_modulus_pa": e, "shear_modulus_pa": g, "density_kg_m3": density});
                (name.to_string(), numbers)
            })
            .collect();
        let stiffest = chain.iter().filter_map(stiffness_nm_per_rad).fold(0.0, f64::max);
        let sigma_mm = dice.rounded(0.002, 0.02, 4) * size;
        let rig = Rig {
            payloads_kg: [0.25, 0.5, 1.0].map(|part| part * payload_kg),
            modal_payload: (0.5 * payload_kg, dice.rounded(0.0, 0.1, 3) * size),
            cg_m: [0.03 * size, 0.1 * size],
            cg_along: turned(plan.last().expect("a chain").along()),
            force_n: 10.0 * payload_kg,
            ranges_deg: joints.iter().map(|_| dice.rounded(70.0, 180.0, 0)).collect(),
            sigma_mm,
            modal_sigma: dice.rounded(0.001, 0.006, 4),
            sigma_arcmin: dice.rounded(0.01, 0.06, 3),
            modes: 2 + (dice.uniform() * 4.0) as usize,
            bench: joints.iter().filter(|_| dice.uniform() < 0.5).cloned().collect(),
            stiffness_tolerance: *dice.pick(&[0.03, 0.05, 0.1]),
            mass_tolerance: *dice.pick(&[0.005, 0.01, 0.03]),
            modulus_tolerance: *dice.pick(&[0.01, 0.02, 0.05]),
            sizes: Sizes {
                extra_kg: 0.15 * payload_kg + size.powi(2),
                harness_kg_per_m: 3.0 * size,
                payload_kg: 0.08 * payload_kg,
                cg_m: 0.03 * size,
                bias_mm: 1.7 * sigma_mm,
                drift_mm_per_row: 0.025 * sigma_mm,
                base_nm_per_rad: stiffest,
            },
        };
        let arm = json!({"name": "varied", "gravity_m_s2": GRAVITY, "materials": materials, "chain": chain});
        Self { arm, rig }
    }

    /// A joint by its name; null if there is none.
    pub fn joint(&self, name: &str) -> &Value {
        let parts = self.arm["chain"].as_array().expect("chain");
        parts.iter().find(|part| part["type"] == "joint" && part["name"] == name).unwrap_or(&Value::Null)
    }

    /// Names of the chain's joints, or of its links.
    pub fn named(&self, kind: &str) -> Vec<String> {
        named(self.arm["chain"].as_array().expect("chain"), kind)
    }
}

/// A joint's one number, or the middle slope of its curve.
pub fn stiffness_nm_per_rad(part: &Value) -> Option<f64> {
    part["stiffness_nm_per_rad"].as_f64().or(part["windup"]["k2_nm_per_rad"].as_f64())
}

/// Young's and shear modulus, density, name.
const MATERIALS: [(f64, f64, f64, &str); 3] = [
    (2.1e11, 8.1e10, 7850.0, "steel"),
    (6.9e10, 2.6e10, 2700.0, "aluminium"),
    (5.5e10, 2.1e10, 1600.0, "carbon"),
];

/// A joint about an axis, or a link along one with its length in an arm of size one \[m\].
#[derive(Clone, Copy)]
enum Step {
    Joint([f64; 3]),
    Link([f64; 3], f64),
}

use Step::{Joint, Link};

impl Step {
    fn along(&self) -> [f64; 3] {
        match self {
            Joint(axis) | Link(axis, _) => *axis,
        }
    }
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Two horizontal arms and a wrist; an upright arm of seven joints; a palletizer; one that turns in the plane; elbow
/// and wrist without a base joint.
const PLANS: [&[Step]; 5] = [
    &[
        Joint(Z),
        Link(Z, 0.35),
        Joint(Y),
        Link(X, 0.7),
        Joint(Y),
        Link(X, 0.6),
        Joint(X),
        Joint(Y),
        Link(X, 0.12),
    ],
    &[
        Joint(Z),
        Link(Z, 0.3),
        Joint(Y),
        Link(Z, 0.35),
        Joint(Z),
        Link(Z, 0.3),
        Joint(Y),
        Link(Z, 0.3),
        Joint(Z),
        Link(Z, 0.25),
        Joint(Y),
        Joint(Z),
        Link(Z, 0.12),
    ],
    &[Joint(Z), Link(Z, 0.5), Joint(Y), Link(X, 0.9), Joint(Y), Link(X, 0.8), Joint(Y), Link(X, 0.15)],
    &[Joint(Z), Link(X, 0.5), Joint(Z), Link(X, 0.4), Joint(X), Link(X, 0.15), Joint(Y), Link(Z, 0.15)],
    &[
        Link(Z, 0.4),
        Joint(Y),
        Link(X, 0.8),
        Joint(Y),
        Link(X, 0.5),
        Joint(X),
        Link(X, 0.2),
        Joint(Y),
        Link(X, 0.1),
    ],
];

fn named(chain: &[Value], kind: &str) -> Vec<String> {
    let parts = chain.iter().filter(|part| part["type"] == kind);
    parts.map(|part| part["name"].as_str().expect("name").to_string()).collect()
}

/// The chain of a plan, sized from its tip inward: a joint yields by about a milliradian under all that is outboard.
fn chain(
    dice: &mut Dice,
    plan: &[Step],
    size: f64,
    payload_kg: f64,
    curved: f64,
    turned: &dyn Fn([f64; 3]) -> [f64; 3],
) -> Vec<Value> {
    let (mut outboard_kg, mut moment_nm) = (payload_kg, 0.0);
    let mut joint = plan.iter().filter(|step| matches!(step, Joint(_))).count();
    let mut link = plan.len() - joint;
    let mut chain = Vec::new();
    let reach: f64 =
        plan.iter().map(|step| if let Link(_, length) = step { size * length } else { 0.0 }).sum();
    for step in plan.iter().rev() {
        match step {
            Joint(axis) => {
                let mass_kg = (0.2 * outboard_kg * dice.between(0.6, 1.4)).max(0.1);
                let torque_nm = f64::max(moment_nm, 0.05 * GRAVITY * outboard_kg * reach);
                let k = (torque_nm / dice.between(3e-4, 1.5e-3)).round();
                let mut part = json!({"type": "joint", "name": format!("j{joint}"), "axis": turned(*axis), "mass_kg": (mass_kg * 1e3).round() / 1e3});
                if dice.uniform() < curved {
                    part["windup"] = json!({
                        "k1_nm_per_rad": (0.6 * k).round(), "k2_nm_per_rad": k, "k3_nm_per_rad": (1.25 * k).round(),
                        "t1_nm": (0.15 * torque_nm * 10.0).round() / 10.0, "t2_nm": (0.5 * torque_nm * 10.0).round() / 10.0});
                } else {
                    part["stiffness_nm_per_rad"] = json!(k);
                }
                chain.push(part);
                outboard_kg += mass_kg;
                joint -= 1;
            }
            Link(along, length) => {
                let length_m = (size * length * dice.between(0.8, 1.2) * 1e3).round() / 1e3;
                let width_m =
                    (0.05 * size * (1.0 + moment_nm.cbrt() / (15.0 * size)) * dice.between(0.8, 1.3) * 1e3)
                        .round()
                        / 1e3;
                let wall_m = (width_m * dice.between(0.04, 0.1) * 1e4).round() / 1e4;
                let (.., density, material) = *dice.pick(&MATERIALS);
                let height_m = (width_m * dice.between(0.8, 1.5) * 1e3).round() / 1e3;
                let (section, area_m2) = match dice.uniform() < 0.4 {
                    true => (
                        json!({"shape": "round_tube", "diameter_m": width_m, "wall_m": wall_m}),
                        std::f64::consts::PI * wall_m * (width_m - wall_m),
                    ),
                    false => (
                        json!({"shape": "rectangular_tube", "width_m": width_m, "height_m": height_m, "wall_m": wall_m}),
                        2.0 * wall_m * (width_m + height_m - 2.0 * wall_m),
                    ),
                };
                let vector: [f64; 3] = three(&json!(turned(*along))).map(|x| x * length_m);
                chain.push(json!({"type": "link", "name": format!("link{link}"), "vector_m": vector, "section": section, "material": material}));
                let mass_kg = density * area_m2 * length_m;
                moment_nm += GRAVITY * length_m * (outboard_kg + 0.5 * mass_kg);
                outboard_kg += mass_kg;
                link -= 1;
            }
        }
    }
    chain.reverse();
    chain
}
