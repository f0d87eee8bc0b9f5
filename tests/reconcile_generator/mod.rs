//! Makes campaigns with a hidden effect from the independent witness: fresh seeds, parameters scattered
//! within tolerance, noise, gross errors, in the files that `reconcile` reads.
//!
//! Friction play, which the witness lacks, is added here from its torques and from kinematics written
//! for this file.

mod positions;
pub mod unknown;

use super::witness::{self, Effects, LoadCase, Options, Payload, ThreeSegment};
use nalgebra::{Rotation3, Unit, Vector3};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use unknown::Unknown;

const ARCMIN_PER_RAD: f64 = 10800.0 / std::f64::consts::PI;

/// A small generator of random numbers (splitmix64).
pub struct Dice(pub u64);

impl Dice {
    /// Uniform in 0..1.
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().max(1e-300).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// One of a list.
    pub fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[((self.uniform() * list.len() as f64) as usize).min(list.len() - 1)]
    }

    fn rounded(&mut self, low: f64, high: f64, digits: i32) -> f64 {
        let f = 10f64.powi(digits);
        (self.between(low, high) * f).round() / f
    }
}

/// How large and how clean a campaign is.
#[derive(Clone, Copy)]
pub struct Plan {
    /// Static poses of five loads.
    pub static_poses: usize,
    /// Modal poses, each with and without payload.
    pub modal_poses: usize,
    /// Whether there is a bench test.
    pub bench: bool,
    /// True over declared standard deviation.
    pub noise: f64,
    /// Part of static readings that are gross errors.
    pub gross: f64,
    /// Factor on the typical size of an effect.
    pub size: f64,
    /// Poses whose absolute position is measured.
    pub positions: usize,
    /// Standard deviation of each component of each link's vector \[m\].
    pub lengths_m: f64,
}

impl Plan {
    /// Much clean data.
    pub fn plain() -> Self {
        Self {
            static_poses: 40,
            modal_poses: 12,
            bench: true,
            noise: 1.0,
            gross: 0.0,
            size: 1.0,
            positions: 0,
            lengths_m: 0.0,
        }
    }

    /// Little data, small effects, gross errors, too small declared deviations.
    pub fn hard(dice: &mut Dice) -> Self {
        let modal_poses = if dice.uniform() < 0.7 { 6 } else { 0 };
        let bench = dice.uniform() < 0.6;
        Self {
            static_poses: 14,
            modal_poses,
            bench,
            noise: 1.15,
            gross: 1.0 / 60.0,
            size: 0.35,
            ..Self::plain()
        }
    }
}

/// A random six-axis arm.
pub fn arm(dice: &mut Dice) -> Value {
    let (e, g, density, name) = *dice.pick(&[
        (2.1e11, 8.1e10, 7850.0, "steel"),
        (6.9e10, 2.6e10, 2700.0, "aluminium"),
        (5.5e10, 2.1e10, 1600.0, "carbon"),
    ]);
    let k = dice.rounded(2.5e5, 7e5, -3);
    let tube =
        |w: f64, t: f64| json!({"shape": "rectangular_tube", "width_m": w, "height_m": w, "wall_m": t});
    let joint = |name: &str, axis: [f64; 3], k: f64, m: f64| json!({"type": "joint", "name": name, "axis": axis, "stiffness_nm_per_rad": k, "mass_kg": m});
    let link = |n: &str, v: [f64; 3], section: Value| json!({"type": "link", "name": n, "vector_m": v, "section": section, "material": name});
    let (z, y, x) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    json!({
        "name": format!("{name}-arm"), "gravity_m_s2": 9.81,
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
    })
}

/// Every effect at every place, to draw from.
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
    out.extend([
        ("base_compliance", "base"),
        ("payload_mass_error", "payload"),
        ("payload_cg_error", "payload"),
        ("immersion", "arm"),
        ("sensor_gain", "static"),
        ("sensor_gain", "modal"),
        ("sensor_bias", "static"),
        ("drift", "static"),
    ]);
    out
}

/// An effect of a random size.
pub fn effect(dice: &mut Dice, arm: &Value, name: &str, at: &str, size: f64) -> Value {
    let parts = arm["chain"].as_array().expect("chain");
    let stiffness = parts.iter().find(|p| p["name"] == at).and_then(|p| p["stiffness_nm_per_rad"].as_f64());
    let k = stiffness.unwrap_or(5e5);
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
        "extra_mass" => json!({"delta_kg": 2.0 * s}),
        "harness_mass" => json!({"kg_per_m": 3.0 * s}),
        "modulus_error" => json!({"factor": 1.0 / (1.0 + 0.25 * s)}),
        "payload_mass_error" => json!({"delta_kg": sign * 0.4 * s}),
        "payload_cg_error" => json!({"offset_m": [0.03 * s * sign, 0.02 * s, -0.015 * s]}),
        "immersion" => {
            json!({"water_density_kg_m3": 1000.0, "added_mass_coefficient": dice.between(0.8, 1.3)})
        }
        "sensor_gain" if at == "modal" => json!({"gain": 1.0 + sign * 0.015 * s}),
        "sensor_gain" => json!({"gain": 1.0 + sign * 0.05 * s}),
        "sensor_bias" => json!({"bias_mm": [0.01 * s * sign, 0.006 * s, -0.012 * s]}),
        "drift" => json!({"rate_mm_per_row": [1.5e-4 * s, -1.0e-4 * s * sign, 2.0e-4 * s]}),
        other => panic!("no size for {other}"),
    };
    json!({"effect": name, "at": at, "parameters": parameters})
}

/// Makes one campaign below `out`: `set` is `plain` or `hard`, `class` is `one`, `two`, `none` or
/// `unknown`; numbers go through all effects in turn. `eased` makes an effect that nobody could see
/// larger, by 40 % a step, and from the third step on leaves no file out. Returns the campaign's name
/// and what is hidden in it.
pub fn make(
    out: &Path,
    set: &str,
    class: &str,
    seed: u64,
    number: usize,
    eased: i32,
) -> (String, Vec<Value>) {
    let mut dice = Dice(seed.wrapping_mul(1000).wrapping_add(number as u64));
    let arm = arm(&mut dice);
    let mut plan = match set {
        "hard" => Plan::hard(&mut dice),
        _ => Plan::plain(),
    };
    plan.size *= 1.4f64.powi(eased);
    if eased >= 3 {
        (plan.modal_poses, plan.bench) = (plan.modal_poses.max(6), true);
    }
    let (known, strange) = (everything(), unknown::everything());
    let mut draw = |k: usize| {
        let (name, at) = known[(number + k * (7 + number % 11)) % known.len()];
        effect(&mut dice, &arm, name, at, plan.size)
    };
    let hidden = match class {
        "none" => Vec::new(),
        "one" => vec![draw(0)],
        "two" => vec![draw(0), draw(1)],
        "unknown" => {
            let (name, at) = strange[number % strange.len()];
            vec![unknown::effect(&mut dice, name, at, plan.size)]
        }
        other => panic!("{other} is none of one, two, none, unknown"),
    };
    let name = format!("{set}-{class}-{seed}-{number:03}");
    std::fs::create_dir_all(out.join("keys")).expect("folder");
    let key = out.join("keys").join(format!("{name}.json"));
    write(&mut dice, &out.join("campaigns").join(&name), &key, &arm, &hidden, &plan);
    (name, hidden)
}

/// What the witness does not know: play of joints, and how a channel reads.
#[derive(Default)]
struct Beyond {
    play: BTreeMap<String, f64>,
    static_gain: f64,
    modal_gain: f64,
    bias_mm: [f64; 3],
    drift_mm: [f64; 3],
    unknown: Unknown,
}

fn three(v: &Value) -> [f64; 3] {
    std::array::from_fn(|i| v[i].as_f64().expect("three numbers"))
}

fn split(hidden: &[Value]) -> (Value, Beyond) {
    let mut beyond = Beyond { static_gain: 1.0, modal_gain: 1.0, ..Beyond::default() };
    let mut rest = Vec::new();
    for effect in hidden {
        if let Some(unknown) = Unknown::from_json(effect) {
            beyond.unknown = unknown;
            continue;
        }
        let p = &effect["parameters"];
        let at = effect["at"].as_str().expect("place").to_string();
        match effect["effect"].as_str().expect("name") {
            "hysteresis" => {
                beyond.play.insert(at, p["half_width_rad"].as_f64().expect("h"));
            }
            "sensor_gain" if at == "modal" => beyond.modal_gain = p["gain"].as_f64().expect("gain"),
            "sensor_gain" => beyond.static_gain = p["gain"].as_f64().expect("gain"),
            "sensor_bias" => beyond.bias_mm = three(&p["bias_mm"]),
            "drift" => beyond.drift_mm = three(&p["rate_mm_per_row"]),
            "immersion" => {
                let mut effect = effect.clone();
                effect["parameters"]["payload_density_kg_m3"] = json!(7850.0);
                rest.push(effect);
            }
            _ => rest.push(effect.clone()),
        }
    }
    (Value::Array(rest), beyond)
}

/// Writes a campaign folder and its key.
pub fn write(dice: &mut Dice, folder: &Path, key: &Path, arm: &Value, hidden: &[Value], plan: &Plan) {
    std::fs::create_dir_all(folder).expect("folder");
    let name = folder.file_name().expect("name").to_string_lossy().to_string();
    let (effects, beyond) = split(hidden);
    let mut built = Built { arm: scattered(dice, arm), effects: Effects::from_json(&effects), beyond };
    if plan.lengths_m > 0.0 {
        positions::with_lengths_off(dice, &mut built.arm, plan.lengths_m);
    }
    let mut campaign = json!({
        "name": name, "arm": "arm.json",
        "tolerance": {"joint_stiffness": 0.05, "modulus": 0.02, "joint_mass": 0.01},
        "conventions": {"payload_density_kg_m3": 7850.0},
    });
    let save = |file: &str, text: String| std::fs::write(folder.join(file), text).expect("written");
    for file in ["static.csv", "modal.csv", "windup.csv", "positions.csv"] {
        let _ = std::fs::remove_file(folder.join(file));
    }
    if plan.static_poses > 0 {
        campaign["static"] = json!({"file": "static.csv"});
        save("static.csv", built.statics(dice, plan));
    }
    if plan.modal_poses > 0 {
        campaign["modal"] = json!({"file": "modal.csv"});
        save("modal.csv", built.modal(dice, plan));
    }
    if plan.bench {
        campaign["windup"] = json!({"file": "windup.csv"});
        save("windup.csv", built.bench(dice, plan));
    }
    if plan.positions > 0 {
        campaign["positions"] = positions::free();
        save("positions.csv", built.positions(dice, plan));
    }
    save("campaign.json", campaign.to_string());
    save("arm.json", arm.to_string());
    std::fs::write(key, json!({"campaign": name, "hidden": hidden}).to_string()).expect("written");
}

/// Stiffness and mass of each joint and the modulus scattered within tolerance.
fn scattered(dice: &mut Dice, arm: &Value) -> Value {
    let mut arm = arm.clone();
    let mut times = |value: &mut Value, tolerance: f64| {
        let factor = (dice.normal() * tolerance / 2.0).exp();
        *value = json!(value.as_f64().expect("number") * factor);
        factor
    };
    for part in arm["chain"].as_array_mut().expect("chain") {
        if part["type"] == "joint" {
            if part["windup"].is_object() {
                let factor = times(&mut part["windup"]["k2_nm_per_rad"], 0.05);
                for key in ["k1_nm_per_rad", "k3_nm_per_rad"] {
                    part["windup"][key] = json!(part["windup"][key].as_f64().expect("number") * factor);
                }
            } else {
                times(&mut part["stiffness_nm_per_rad"], 0.05);
            }
            times(&mut part["mass_kg"], 0.01);
        }
    }
    for (_, material) in arm["materials"].as_object_mut().expect("materials") {
        let factor = times(&mut material["youngs_modulus_pa"], 0.02);
        let shear = material["shear_modulus_pa"].as_f64().expect("G");
        material["shear_modulus_pa"] = json!(shear * factor);
    }
    arm
}

struct Built {
    arm: Value,
    effects: Effects,
    beyond: Beyond,
}

impl Built {
    fn options(&self, modes: usize) -> Options {
        Options { elements_per_link: 3, ..Options::default() }
            .with_effects(self.effects.clone())
            .with_modes(modes)
    }

    fn joints(&self) -> Vec<(String, Vector3<f64>, f64)> {
        let parts = self.arm["chain"].as_array().expect("chain").iter().filter(|p| p["type"] == "joint");
        parts
            .map(|p| {
                let name = p["name"].as_str().expect("name").to_string();
                let k = p["stiffness_nm_per_rad"].as_f64().or(p["windup"]["k2_nm_per_rad"].as_f64());
                (name, Vector3::from(three(&p["axis"])), k.expect("k"))
            })
            .collect()
    }

    /// The arm in a pose when `part` of the tests are done.
    fn arm_during(&self, pose_deg: &[f64], part: f64) -> Value {
        self.with_stiffness(|j, name, k| k * self.beyond.unknown.stiffness_factor(name, pose_deg[j], part))
    }

    /// The arm with other stiffnesses of its joints: number, name and stiffness of each are given.
    fn with_stiffness(&self, of: impl Fn(usize, &str, f64) -> f64) -> Value {
        let mut arm = self.arm.clone();
        let parts = arm["chain"].as_array_mut().expect("chain").iter_mut();
        for (j, part) in parts.filter(|p| p["type"] == "joint").enumerate() {
            let k = part["stiffness_nm_per_rad"].as_f64().expect("k");
            part["stiffness_nm_per_rad"] = json!(of(j, part["name"].as_str().expect("name"), k));
        }
        arm
    }

    /// The arm with the stiffness its joints have for small motions about a load.
    fn arm_about(&self, pose_deg: &[f64], case: &LoadCase, part: f64) -> Value {
        let unknown = &self.beyond.unknown;
        let answer = witness::analyze(&self.arm_during(pose_deg, part), case, &self.options(0));
        self.with_stiffness(|j, name, k| {
            let further = unknown.further_twist(name, torque(&answer, name), k).1;
            k * unknown.stiffness_factor(name, pose_deg[j], part) / (1.0 + k * further)
        })
    }

    /// Where the tip is, and its motion per radian of each joint.
    fn levers(&self, pose_deg: &[f64]) -> (Vector3<f64>, Vec<Vector3<f64>>) {
        let (mut at, mut frame) = (Vector3::zeros(), Rotation3::identity());
        let mut axes = Vec::new();
        for part in self.arm["chain"].as_array().expect("chain") {
            if part["type"] == "joint" {
                let axis = Vector3::from(three(&part["axis"]));
                axes.push((frame * axis, at));
                let angle = pose_deg[axes.len() - 1].to_radians();
                frame *= Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle);
            } else {
                at += frame * Vector3::from(three(&part["vector_m"]));
            }
        }
        (at, axes.into_iter().map(|(axis, point)| axis.cross(&(at - point))).collect())
    }

    fn statics(&self, dice: &mut Dice, plan: &Plan) -> String {
        let sigma = 0.006;
        let mut out = String::from(
            "test,q_j1_deg,q_j2_deg,q_j3_deg,q_j4_deg,q_j5_deg,q_j6_deg,payload_kg,payload_cg_x_m,payload_cg_y_m,payload_cg_z_m,force_x_n,force_y_n,force_z_n,branch,dx_mm,dy_mm,dz_mm,sigma_mm\n",
        );
        let mut row = 0;
        for number in 0..plan.static_poses {
            let part = number as f64 / plan.static_poses as f64;
            let pose = pose(dice);
            let cg = dice.rounded(0.03, 0.1, 3);
            let force: [f64; 3] = std::array::from_fn(|_| dice.rounded(-100.0, 100.0, 1));
            let loads =
                [(2.5, "loading"), (5.0, "loading"), (10.0, "loading"), (5.0, "unloading"), (0.0, "loading")];
            let cases: Vec<LoadCase> = loads
                .iter()
                .map(|(kg, _)| {
                    let case = LoadCase::unloaded(&pose);
                    if *kg > 0.0 {
                        case.with_payload(Payload::point(*kg, [cg, 0.0, 0.0]))
                    } else {
                        case.with_tip_force(force)
                    }
                })
                .collect();
            for (i, d) in self.displacements_mm(&pose, &cases, part).into_iter().enumerate() {
                let (kg, branch) = loads[i];
                let f = if kg > 0.0 { [0.0; 3] } else { force };
                let gross = if dice.uniform() < plan.gross { 0.15 * dice.normal().signum() } else { 0.0 };
                let read: [f64; 3] = std::array::from_fn(|c| {
                    let b = &self.beyond;
                    let noise = sigma * plan.noise * dice.normal() + if c == i % 3 { gross } else { 0.0 };
                    b.static_gain * d[c] + b.bias_mm[c] + b.drift_mm[c] * row as f64 + noise
                });
                row += 1;
                out.push_str(&format!(
                    "{row},{},{kg},{cg},0.0,0.0,{},{},{},{branch},{:.4},{:.4},{:.4},{sigma}\n",
                    list(&pose),
                    f[0],
                    f[1],
                    f[2],
                    read[0],
                    read[1],
                    read[2]
                ));
            }
        }
        out
    }

    /// Displacements from the unloaded reference, friction play following the order of the loads.
    fn displacements_mm(&self, pose: &[f64], cases: &[LoadCase], part: f64) -> Vec<Vector3<f64>> {
        let options = self.options(0);
        let unknown = &self.beyond.unknown;
        let reference = witness::analyze(&self.arm_during(pose, 0.0), &LoadCase::unloaded(pose), &options);
        let arm = self.arm_during(pose, part);
        let (tip_m, levers) = self.levers(pose);
        let mut play: Vec<(usize, f64, f64, f64)> = Vec::new();
        for (j, (name, _, k)) in self.joints().iter().enumerate() {
            if let Some(h) = self.beyond.play.get(name) {
                let t0 = torque(&reference, name);
                play.push((j, *k, *h, t0 - t0.signum() * k * h));
            }
        }
        let names: Vec<String> = self.joints().into_iter().map(|j| j.0).collect();
        let lag = |play: &mut Vec<(usize, f64, f64, f64)>, answer: &witness::Answer| -> Vector3<f64> {
            play.iter_mut()
                .map(|(j, k, h, s)| {
                    let t = torque(answer, &names[*j]);
                    *s = s.max(t - *k * *h).min(t + *k * *h);
                    levers[*j] * ((*s - t) / *k)
                })
                .sum()
        };
        let further = |answer: &witness::Answer| -> Vector3<f64> {
            let joints = self.joints().into_iter().zip(&levers);
            joints
                .map(|((name, _, k), lever)| lever * unknown.further_twist(&name, torque(answer, &name), k).0)
                .sum()
        };
        let zero = reference.tip_displacement_m + lag(&mut play, &reference) + further(&reference);
        cases
            .iter()
            .map(|case| {
                let answer = witness::analyze(&arm, case, &options);
                let moved = answer.tip_displacement_m + lag(&mut play, &answer) + further(&answer);
                unknown.reading_mm(1e3 * (moved - zero), tip_m, part)
            })
            .collect()
    }

    fn modal(&self, dice: &mut Dice, plan: &Plan) -> String {
        let mut out = String::from(
            "test,q_j1_deg,q_j2_deg,q_j3_deg,q_j4_deg,q_j5_deg,q_j6_deg,payload_kg,payload_cg_x_m,payload_cg_y_m,payload_cg_z_m,mode,frequency_hz,sigma_hz\n",
        );
        let mut test = 0;
        for number in 0..plan.modal_poses {
            let part = number as f64 / plan.modal_poses as f64;
            let pose = pose(dice);
            for kg in [0.0, 5.0] {
                test += 1;
                let case = LoadCase::unloaded(&pose).with_payload(Payload::point(kg, [0.08, 0.0, 0.0]));
                let arm = self.arm_about(&pose, &case, part);
                let answer = witness::analyze(&arm, &case, &self.options(4));
                for (m, mode) in answer.modes.iter().enumerate() {
                    let f = mode.frequency_hz * self.beyond.modal_gain;
                    let sigma = 0.003 * f;
                    let read = f + sigma * plan.noise * dice.normal();
                    out.push_str(&format!(
                        "{test},{},{kg},0.08,0.0,0.0,{},{read:.4},{sigma:.4}\n",
                        list(&pose),
                        m + 1
                    ));
                }
            }
        }
        out
    }

    fn bench(&self, dice: &mut Dice, plan: &Plan) -> String {
        let mut out = String::from("test,joint,torque_nm,branch,windup_arcmin,sigma_arcmin\n");
        let mut test = 0;
        for (name, _, k) in self.joints().into_iter().filter(|j| ["j2", "j3", "j5"].contains(&j.0.as_str())) {
            let largest = match (k * 9e-4 / 50.0).round() * 50.0 {
                0.0 => (k * 9e-4).ceil(),
                coarse => coarse,
            };
            let up: Vec<f64> = (-8..=8).map(|i| largest * i as f64 / 8.0).collect();
            let down: Vec<f64> = up.iter().rev().copied().collect();
            let (h, law) = (self.beyond.play.get(&name).copied().unwrap_or(0.0), self.law(&name, k));
            let mut s = 0.0f64;
            for recorded in [false, true] {
                for (branch, torques) in [("loading", &up), ("unloading", &down)] {
                    for &t in torques {
                        s = s.max(t - k * h).min(t + k * h);
                        let angle = law(t) + (s - t) / k * f64::from(h > 0.0);
                        if recorded {
                            test += 1;
                            let read = angle * ARCMIN_PER_RAD + 0.03 * plan.noise * dice.normal();
                            out.push_str(&format!("{test},{name},{t},{branch},{read:.4},0.03\n"));
                        }
                    }
                }
            }
        }
        out
    }

    fn law(&self, name: &str, k: f64) -> Box<dyn Fn(f64) -> f64> {
        let e = &self.effects;
        let series = e.connection_compliance_nm_per_rad.get(name).map_or(0.0, |c| 1.0 / c);
        let lost = e.lost_motion.get(name).copied();
        let parts = self.arm["chain"].as_array().expect("chain");
        let own = parts.iter().find(|p| p["name"] == name).map(|p| &p["windup"]).filter(|w| w.is_object());
        let curve = e.soft_windup.get(name).copied().or(own.map(ThreeSegment::from_json));
        let (unknown, name) = (self.beyond.unknown.clone(), name.to_string());
        Box::new(move |t| {
            let gear = match curve {
                None => t / k,
                Some(w) => {
                    let size = t.abs();
                    let first = size.min(w.t1_nm) / w.k1_nm_per_rad;
                    let second = (size.min(w.t2_nm) - w.t1_nm).max(0.0) / w.k2_nm_per_rad;
                    (first + second + (size - w.t2_nm).max(0.0) / w.k3_nm_per_rad) * t.signum()
                }
            };
            let gear = gear + unknown.further_twist(&name, t, k).0;
            gear + series * t + lost.map_or(0.0, |l| l.half_width_rad * (t / l.torque_nm).tanh())
        })
    }
}

fn torque(answer: &witness::Answer, joint: &str) -> f64 {
    answer.joint_torque_nm.iter().find(|(name, _)| *name == joint).map_or(0.0, |(_, t)| *t)
}

fn pose(dice: &mut Dice) -> Vec<f64> {
    [180.0, 80.0, 120.0, 180.0, 110.0, 180.0].iter().map(|r| dice.rounded(-r, *r, 1)).collect()
}

fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|n| format!("{n}")).collect::<Vec<_>>().join(",")
}
