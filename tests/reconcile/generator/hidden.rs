//! Chooses the effects that a made campaign hides, their places and their sizes.

use super::Dice;
use super::specimen::{Specimen, stiffness_nm_per_rad};
use serde_json::{Value, json};

/// Effects that are at no joint and no link.
const ELSEWHERE: [(&str, &str); 8] = [
    ("base_compliance", "base"),
    ("payload_mass_error", "payload"),
    ("payload_cg_error", "payload"),
    ("immersion", "arm"),
    ("sensor_gain", "static"),
    ("sensor_gain", "modal"),
    ("sensor_bias", "static"),
    ("drift", "static"),
];

/// Every effect at every place of a six-axis arm, to draw from.
pub fn everything() -> Vec<(&'static str, &'static str)> {
    let mut out = Vec::new();
    for at in ["j2", "j3", "j5"] {
        out.extend([
            ("connection_compliance", at),
            ("soft_windup", at),
            ("lost_motion", at),
            ("hysteresis", at),
        ]);
    }
    out.extend(["j2", "j3", "j4"].map(|at| ("bearing_tilt", at)));
    out.extend(["j3", "j5", "j6"].map(|at| ("extra_mass", at)));
    out.extend(["upper_arm", "forearm"].map(|at| ("harness_mass", at)));
    out.extend(["upper_arm", "forearm"].map(|at| ("modulus_error", at)));
    out.extend(ELSEWHERE);
    out
}

/// Those that the readings of a set show.
pub fn seen_in(set: &str) -> Vec<(&'static str, &'static str)> {
    let on_bench = ["connection_compliance", "soft_windup", "lost_motion", "hysteresis"];
    let is_seen = |(name, at): &(&str, &str)| match set {
        "windup" => on_bench.contains(name),
        "modal" => *at != "static" && *name != "hysteresis",
        "static" => *at != "modal",
        _ => true,
    };
    everything().into_iter().filter(is_seen).collect()
}

/// An effect by its number, at a random place of any arm.
pub fn anywhere(dice: &mut Dice, specimen: &Specimen, number: usize) -> (&'static str, String) {
    const AT_JOINTS: [&str; 6] =
        ["connection_compliance", "soft_windup", "lost_motion", "hysteresis", "bearing_tilt", "extra_mass"];
    const AT_LINKS: [&str; 2] = ["harness_mass", "modulus_error"];
    // those of joints and links twice as often
    let twice = 2 * (AT_JOINTS.len() + AT_LINKS.len());
    let number = number % (twice + ELSEWHERE.len());
    if number >= twice {
        let (name, at) = ELSEWHERE[number - twice];
        return (name, at.to_string());
    }
    let number = number / 2;
    if let Some(name) = AT_JOINTS.get(number) {
        // a curve or play of a joint that has a curve already is a question of its own
        let asks_a_number = ["soft_windup", "hysteresis"].contains(name);
        let may_have_it = |joint: &String| !asks_a_number || !specimen.joint(joint)["windup"].is_object();
        let joints: Vec<String> = specimen.named("joint").into_iter().filter(may_have_it).collect();
        if !joints.is_empty() {
            return (name, dice.pick(&joints).clone());
        }
    }
    let name = AT_LINKS[number % AT_LINKS.len()];
    (name, dice.pick(&specimen.named("link")).clone())
}

/// An effect of a random size.
pub fn effect(dice: &mut Dice, specimen: &Specimen, name: &str, at: &str, size: f64) -> Value {
    let typical = &specimen.rig.sizes;
    let k = stiffness_nm_per_rad(specimen.joint(at)).unwrap_or(typical.base_nm_per_rad);
    let sign = if dice.uniform() < 0.5 { -1.0 } else { 1.0 };
    let s = size * dice.between(0.7, 1.4);
    let parameters = match name {
        "connection_compliance" => json!({"stiffness_nm_per_rad": k / (0.35 * s)}),
        "bearing_tilt" | "base_compliance" => json!({"stiffness_nm_per_rad": k / (0.5 * s)}),
        "soft_windup" => {
            let t1 = k * dice.between(2.0e-4, 4.0e-4);
            json!({"k1_nm_per_rad": k / (1.0 + 0.8 * s), "k2_nm_per_rad": k, "k3_nm_per_rad": k * (1.0 + 0.2 * s),
                   "t1_nm": t1, "t2_nm": t1 * dice.between(2.2, 3.2)})
        }
        "lost_motion" => json!({"half_width_rad": 1.5e-4 * s, "torque_nm": k * dice.between(2e-5, 6e-5)}),
        "hysteresis" => json!({"half_width_rad": 1.2e-4 * s}),
        "extra_mass" => json!({"delta_kg": typical.extra_kg * s}),
        "harness_mass" => json!({"kg_per_m": typical.harness_kg_per_m * s}),
        "modulus_error" => json!({"factor": 1.0 / (1.0 + 0.25 * s)}),
        "payload_mass_error" => json!({"delta_kg": sign * typical.payload_kg * s}),
        "payload_cg_error" => {
            let cg_m = [1.0, 2.0 / 3.0, -0.5].map(|part| typical.cg_m * part * s);
            json!({"offset_m": [cg_m[0] * sign, cg_m[1], cg_m[2]]})
        }
        "immersion" => {
            json!({"water_density_kg_m3": 1000.0, "added_mass_coefficient": dice.between(0.8, 1.3)})
        }
        "sensor_gain" if at == "modal" => json!({"gain": 1.0 + sign * 0.015 * s}),
        "sensor_gain" => json!({"gain": 1.0 + sign * 0.05 * s}),
        "sensor_bias" => {
            let bias_mm = [1.0, 0.6, -1.2].map(|part| typical.bias_mm * part * s);
            json!({"bias_mm": [bias_mm[0] * sign, bias_mm[1], bias_mm[2]]})
        }
        "drift" => {
            let rate = [1.0, -2.0 / 3.0, 4.0 / 3.0].map(|part| typical.drift_mm_per_row * part * s);
            json!({"rate_mm_per_row": [rate[0], rate[1] * sign, rate[2]]})
        }
        other => panic!("no size for {other}"),
    };
    json!({"effect": name, "at": at, "parameters": parameters})
}

/// Effects that came later than those of [`everything`], whose order seeds depend on.
const LATER: [&str; 6] =
    ["test_mass", "servo_compliance", "joint_torque", "thermal_modulus", "stiffness_waves", "base_lift"];

/// One of the effects that came later, by its number, at a random place that can have it and of a random size.
pub fn later(dice: &mut Dice, specimen: &Specimen, number: usize, size: f64) -> Value {
    let typical = &specimen.rig.sizes;
    let curved = |joint: &String| specimen.joint(joint)["windup"].is_object();
    let joints = specimen.named("joint");
    let any = dice.pick(&joints).clone();
    let k = |joint: &str| stiffness_nm_per_rad(specimen.joint(joint)).expect("stiffness");
    let s = size * dice.between(0.7, 1.4);
    let sign = if dice.uniform() < 0.5 { -1.0 } else { 1.0 };
    let geared: Vec<String> = joints.iter().filter(|joint| curved(joint)).cloned().collect();
    let name = match LATER[number % LATER.len()] {
        "joint_torque" if geared.is_empty() => "servo_compliance",
        name => name,
    };
    let (at, parameters) = match name {
        "test_mass" => {
            let cg_m: [f64; 3] = std::array::from_fn(|_| typical.cg_m * dice.between(-1.5, 1.5));
            let at_the_tip = dice.uniform() < 0.5;
            let cg_m = if at_the_tip { [0.0; 3] } else { cg_m };
            ("modal".into(), json!({"mass_kg": 0.3 * typical.extra_kg * s, "cg_m": cg_m}))
        }
        "servo_compliance" => {
            let channel = *dice.pick(&["static", "modal"]);
            let stiffness = k(&any) / (0.35 * s);
            (any, json!({"stiffness_nm_per_rad": stiffness, "channel": channel}))
        }
        "joint_torque" => {
            let at = dice.pick(&geared).clone();
            let nm = 3e-4 * k(&at) * s;
            let parameters = match (dice.uniform() * 3.0) as usize {
                0 => json!({"offset_nm": sign * nm}),
                1 => json!({"sin_nm": sign * nm, "cos_nm": 0.3 * nm}),
                _ => json!({"sin_nm": 0.2 * nm, "cos_nm": sign * nm}),
            };
            (at, parameters)
        }
        "thermal_modulus" => {
            ("arm".into(), json!({"change": sign * 0.06 * s, "rows": dice.rounded(10.0, 60.0, 0)}))
        }
        "stiffness_waves" => {
            let phases: [f64; 2] = std::array::from_fn(|_| dice.between(-3.0, 3.0));
            let sizes = *dice.pick(&[[0.2, 0.0], [0.0, 0.2], [0.15, 0.1]]);
            let parameters = json!({"once": sizes[0] * s, "twice": sizes[1] * s, "phases_rad": phases});
            (any, parameters)
        }
        "base_lift" => {
            let moment_nm = 9.81 * specimen.rig.payloads_kg[2] * dice.between(0.3, 1.0);
            let stiffness = typical.base_nm_per_rad / (0.5 * s);
            ("base".into(), json!({"stiffness_nm_per_rad": stiffness, "preload_nm": moment_nm}))
        }
        other => panic!("no size for {other}"),
    };
    json!({"effect": name, "at": at, "parameters": parameters})
}
