//! Makes campaigns with a hidden effect from the independent model, in the files that `reconcile` reads. Seeds are new,
//! parameters scatter within their tolerance, and readings have noise and gross errors.
//!
//! Friction with play, which the independent model lacks, is added here. It is computed from the torques of that model
//! and from kinematics that were written for this file.

mod conditions;
mod dice;
mod hidden;
mod plan;
mod positions;
mod specimen;
pub mod unknown;

use super::witness::{self, Effects, LoadCase, Options, Payload, ThreeSegment};
use conditions::Conditions;
use nalgebra::{Rotation3, Unit, Vector3};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use unknown::Unknown;

pub use dice::Dice;
pub use plan::Plan;
pub use specimen::Specimen;
use specimen::{Rig, stiffness_nm_per_rad};

const ARCMIN_PER_RAD: f64 = 10800.0 / std::f64::consts::PI;

/// Makes one campaign below `out`. Returns its name and what is hidden in it.
///
/// - `set`: `plain` and `hard` have six-axis arms; `static`, `modal` and `windup` one kind of readings; `varied` all kinds;
///   `geared` all kinds, with torsion curves.
/// - `class`: what is hidden: `one` or `two` effects, `none`, `unknown` physics, or `later` or `further` for one of the effects,
///   or of the unknown physics, that came later. `number` goes through all effects in turn.
/// - `eased`: makes an effect that nobody could see larger, by 40 % a step; from the third step on, no file is left out.
pub fn make(
    out: &Path,
    set: &str,
    class: &str,
    seed: u64,
    number: usize,
    eased: i32,
) -> (String, Vec<Value>) {
    let mut dice = Dice(seed.wrapping_mul(1000).wrapping_add(number as u64));
    let specimen = match set {
        "varied" if ["unknown", "further"].contains(&class) => Specimen::varied(&mut dice, 0.0),
        "varied" => Specimen::varied(&mut dice, 0.3),
        "geared" => Specimen::varied(&mut dice, 1.0),
        _ => Specimen::six_axis(&mut dice),
    };
    let mut plan = match set {
        "hard" => Plan::hard(&mut dice),
        "varied" | "geared" => Plan::varied(&mut dice),
        "plain" => Plan::plain(),
        channel => Plan::of_channel(channel),
    };
    plan.size *= 1.4f64.powi(eased);
    if eased >= 3 {
        (plan.modal_poses, plan.bench) = (plan.modal_poses.max(6), true);
    }
    let (known, strange) = (hidden::seen_in(set), unknown::everything());
    let mut draw = |k: usize| {
        let number = number + k * (7 + number % 11);
        let (name, at) = match set {
            "varied" | "geared" => hidden::anywhere(&mut dice, &specimen, number),
            _ => (known[number % known.len()].0, known[number % known.len()].1.to_string()),
        };
        hidden::effect(&mut dice, &specimen, name, &at, plan.size)
    };
    let hidden = match class {
        "none" => Vec::new(),
        "later" => vec![hidden::later(&mut dice, &specimen, number, plan.size)],
        "one" => vec![draw(0)],
        "two" => vec![draw(0), draw(1)],
        "further" => vec![unknown::further(&mut dice, &specimen, number, plan.size)],
        "unknown" => {
            let (name, at) = strange[number % strange.len()];
            vec![unknown::effect(&mut dice, name, at, plan.size)]
        }
        other => panic!("{other} is none of one, two, none, later, unknown, further"),
    };
    let name = format!("{set}-{class}-{seed}-{number:03}");
    std::fs::create_dir_all(out.join("keys")).expect("folder");
    let key = out.join("keys").join(format!("{name}.json"));
    write(&mut dice, &out.join("campaigns").join(&name), &key, &specimen, &hidden, &plan);
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
    conditions: Conditions,
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
        if beyond.conditions.takes(effect) {
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
pub fn write(dice: &mut Dice, folder: &Path, key: &Path, specimen: &Specimen, hidden: &[Value], plan: &Plan) {
    std::fs::create_dir_all(folder).expect("folder");
    let name = folder.file_name().expect("name").to_string_lossy().to_string();
    let (effects, beyond) = split(hidden);
    let rig = specimen.rig.clone();
    let mut built =
        Built { arm: scattered(dice, specimen), effects: Effects::from_json(&effects), beyond, rig };
    built.beyond.unknown.build(&mut built.arm);
    if plan.lengths_m > 0.0 {
        positions::with_lengths_off(dice, &mut built.arm, plan.lengths_m);
    }
    let mut campaign = json!({
        "name": name, "arm": "arm.json",
        "tolerance": {
            "joint_stiffness": built.rig.stiffness_tolerance,
            "modulus": built.rig.modulus_tolerance,
            "joint_mass": built.rig.mass_tolerance,
        },
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
    if plan.bench && !built.rig.bench.is_empty() {
        campaign["windup"] = json!({"file": "windup.csv"});
        save("windup.csv", built.bench(dice, plan));
    }
    if plan.positions > 0 {
        campaign["positions"] = positions::free();
        save("positions.csv", built.positions(dice, plan));
    }
    save("campaign.json", campaign.to_string());
    save("arm.json", specimen.arm.to_string());
    std::fs::write(key, json!({"campaign": name, "hidden": hidden}).to_string()).expect("written");
}

/// Stiffness and mass of each joint and the modulus scattered within tolerance.
fn scattered(dice: &mut Dice, Specimen { arm, rig }: &Specimen) -> Value {
    let mut arm = arm.clone();
    let mut times = |value: &mut Value, tolerance: f64| {
        let factor = (dice.normal() * tolerance / 2.0).exp();
        *value = json!(value.as_f64().expect("number") * factor);
        factor
    };
    for part in arm["chain"].as_array_mut().expect("chain") {
        if part["type"] == "joint" {
            if part["windup"].is_object() {
                let factor = times(&mut part["windup"]["k2_nm_per_rad"], rig.stiffness_tolerance);
                for key in ["k1_nm_per_rad", "k3_nm_per_rad"] {
                    part["windup"][key] = json!(part["windup"][key].as_f64().expect("number") * factor);
                }
            } else {
                times(&mut part["stiffness_nm_per_rad"], rig.stiffness_tolerance);
            }
            times(&mut part["mass_kg"], rig.mass_tolerance);
        }
    }
    for (_, material) in arm["materials"].as_object_mut().expect("materials") {
        let factor = times(&mut material["youngs_modulus_pa"], rig.modulus_tolerance);
        let shear = material["shear_modulus_pa"].as_f64().expect("G");
        material["shear_modulus_pa"] = json!(shear * factor);
    }
    arm
}

struct Built {
    arm: Value,
    effects: Effects,
    beyond: Beyond,
    rig: Rig,
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
                (name, Vector3::from(three(&p["axis"])), stiffness_nm_per_rad(p).expect("k"))
            })
            .collect()
    }

    fn angles(&self) -> String {
        let names = self.joints().into_iter().map(|(name, ..)| format!("q_{name}_deg"));
        names.collect::<Vec<_>>().join(",")
    }

    fn pose(&self, dice: &mut Dice) -> Vec<f64> {
        self.rig.ranges_deg.iter().map(|r| dice.rounded(-r, *r, 1)).collect()
    }

    /// The arm in a pose when `part` of the tests are done, `row` rows of a channel among them.
    fn arm_during(&self, channel: &str, pose_deg: &[f64], part: f64, row: usize) -> Value {
        let arm = self.with_stiffness(|j, name, k| k * self.stiffness_factor(name, pose_deg[j], part));
        self.beyond.conditions.of(channel, arm, row)
    }

    /// Factor on the stiffness of a joint at an angle when `part` of the tests are done.
    fn stiffness_factor(&self, name: &str, angle_deg: f64, part: f64) -> f64 {
        let Beyond { unknown, conditions, .. } = &self.beyond;
        unknown.stiffness_factor(name, angle_deg, part) * conditions.stiffness_factor(name, angle_deg)
    }

    /// The effects as they are in the tests of a channel.
    fn options_in(&self, channel: &str, modes: usize) -> Options {
        let mut options = self.options(modes);
        for (joint, k) in self.beyond.conditions.servos(channel) {
            let own = options.effects.connection_compliance_nm_per_rad.get(joint).map_or(0.0, |c| 1.0 / c);
            options.effects.connection_compliance_nm_per_rad.insert(joint.clone(), 1.0 / (own + 1.0 / k));
        }
        options
    }

    /// The arm with other stiffnesses of its joints: number, name and stiffness of each are given.
    fn with_stiffness(&self, of: impl Fn(usize, &str, f64) -> f64) -> Value {
        let mut arm = self.arm.clone();
        let parts = arm["chain"].as_array_mut().expect("chain").iter_mut();
        for (j, part) in parts.filter(|p| p["type"] == "joint").enumerate() {
            let name = part["name"].as_str().expect("name").to_string();
            if let Some(k) = part["stiffness_nm_per_rad"].as_f64() {
                part["stiffness_nm_per_rad"] = json!(of(j, &name, k));
            } else if part["windup"].is_object() {
                for key in ["k1_nm_per_rad", "k2_nm_per_rad", "k3_nm_per_rad"] {
                    let k = part["windup"][key].as_f64().expect("stiffness");
                    part["windup"][key] = json!(of(j, &name, k));
                }
            }
        }
        arm
    }

    /// The arm with the stiffness its joints have for small motions about a load.
    fn arm_about(&self, pose_deg: &[f64], case: &LoadCase, part: f64, row: usize) -> Value {
        let unknown = &self.beyond.unknown;
        let arm = self.arm_during("modal", pose_deg, part, row);
        let answer = witness::analyze(&arm, case, &self.options_in("modal", 0));
        let arm = self.with_stiffness(|j, name, k| {
            let further = unknown.further_twist(name, torque(&answer, name), k).1;
            k * self.stiffness_factor(name, pose_deg[j], part) / (1.0 + k * further)
        });
        self.beyond.conditions.of("modal", arm, row)
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
        let sigma = self.rig.sigma_mm;
        let mut out = format!(
            "test,{},payload_kg,payload_cg_x_m,payload_cg_y_m,payload_cg_z_m,force_x_n,force_y_n,force_z_n,branch,dx_mm,dy_mm,dz_mm,sigma_mm\n",
            self.angles(),
        );
        let mut row = 0;
        for number in 0..plan.static_poses {
            let part = number as f64 / plan.static_poses as f64;
            let pose = self.pose(dice);
            let cg = self.rig.cg_along.map({
                let [least, most] = self.rig.cg_m;
                let cg = dice.rounded(least, most, 3);
                move |along| along * cg
            });
            let most_n = self.rig.force_n;
            let force: [f64; 3] = std::array::from_fn(|_| dice.rounded(-most_n, most_n, 1));
            let [light, middle, heavy] = self.rig.payloads_kg;
            let loads = [
                (light, "loading"),
                (middle, "loading"),
                (heavy, "loading"),
                (middle, "unloading"),
                (0.0, "loading"),
            ];
            let cases: Vec<LoadCase> = loads
                .iter()
                .map(|(kg, _)| {
                    let case = LoadCase::unloaded(&pose);
                    if *kg > 0.0 {
                        case.with_payload(Payload::point(*kg, cg))
                    } else {
                        case.with_tip_force(force.map(|f| f * self.beyond.unknown.force_factor()))
                    }
                })
                .collect();
            for (i, d) in self.displacements_mm(&pose, &cases, part, row).into_iter().enumerate() {
                let (kg, branch) = loads[i];
                let f = if kg > 0.0 { [0.0; 3] } else { force };
                let gross =
                    if dice.uniform() < plan.gross { 25.0 * sigma * dice.normal().signum() } else { 0.0 };
                let read: [f64; 3] = std::array::from_fn(|c| {
                    let b = &self.beyond;
                    let noise = sigma * plan.noise * dice.normal() + if c == i % 3 { gross } else { 0.0 };
                    b.static_gain * d[c] + b.bias_mm[c] + b.drift_mm[c] * row as f64 + noise
                });
                row += 1;
                out.push_str(&format!(
                    "{row},{},{kg},{},{},{},{},{branch},{:.4},{:.4},{:.4},{sigma}\n",
                    list(&pose),
                    list(&cg),
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

    /// Displacements from the unloaded reference, friction play following the order of the loads. `first` rows were taken
    /// before.
    fn displacements_mm(
        &self,
        pose: &[f64],
        cases: &[LoadCase],
        part: f64,
        first: usize,
    ) -> Vec<Vector3<f64>> {
        let options = self.options_in("static", 0);
        let unknown = &self.beyond.unknown;
        let unloaded = |arm: &Value| witness::analyze(arm, &LoadCase::unloaded(pose), &options);
        // friction follows the reference before the first load
        let reference = unloaded(&self.arm_during("static", pose, 0.0, first));
        let (tip_m, levers) = self.levers(pose);
        let mut play: Vec<(usize, f64, f64)> = Vec::new();
        for (j, (name, _, k)) in self.joints().iter().enumerate() {
            let t0 = torque(&reference, name);
            let width_nm = self.width_nm(name, *k, t0);
            if width_nm > 0.0 || self.beyond.unknown.friction(name) > 0.0 {
                // what rounding leaves of a vertical joint's torque has no sense
                let sense = if t0.abs() < 1e-6 { 0.0 } else { t0.signum() };
                play.push((j, *k, t0 - sense * width_nm));
            }
        }
        let names: Vec<String> = self.joints().into_iter().map(|j| j.0).collect();
        let lag = |play: &mut Vec<(usize, f64, f64)>, answer: &witness::Answer| -> Vector3<f64> {
            play.iter_mut()
                .map(|(j, k, s)| {
                    let t = torque(answer, &names[*j]);
                    let width_nm = self.width_nm(&names[*j], *k, t);
                    *s = s.max(t - width_nm).min(t + width_nm);
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
            .enumerate()
            .map(|(row, case)| {
                let arm = self.arm_during("static", pose, part, first + row);
                let answer = witness::analyze(&arm, case, &options);
                let moved = answer.tip_displacement_m + lag(&mut play, &answer) + further(&answer);
                unknown.reading_mm(1e3 * (moved - zero), tip_m, row, part)
            })
            .collect()
    }

    /// Half width of a joint's friction at a torque.
    fn width_nm(&self, joint: &str, k: f64, torque_nm: f64) -> f64 {
        let play = self.beyond.play.get(joint).copied().unwrap_or(0.0);
        k * play + self.beyond.unknown.friction(joint) * torque_nm.abs()
    }

    fn modal(&self, dice: &mut Dice, plan: &Plan) -> String {
        let mut out = format!(
            "test,{},payload_kg,payload_cg_x_m,payload_cg_y_m,payload_cg_z_m,mode,frequency_hz,sigma_hz\n",
            self.angles(),
        );
        let (payload_kg, cg_m) = self.rig.modal_payload;
        let cg = self.rig.cg_along.map(|along| along * cg_m);
        let (mut test, mut row) = (0, 0);
        for number in 0..plan.modal_poses {
            let part = number as f64 / plan.modal_poses as f64;
            let pose = self.pose(dice);
            for kg in [0.0, payload_kg] {
                test += 1;
                let case = LoadCase::unloaded(&pose).with_payload(Payload::point(kg, cg));
                let arm = self.arm_about(&pose, &case, part, row);
                let answer = witness::analyze(&arm, &case, &self.options_in("modal", self.rig.modes));
                row += answer.modes.len();
                for (m, mode) in answer.modes.iter().enumerate() {
                    let f = mode.frequency_hz * self.beyond.modal_gain;
                    let sigma = self.rig.modal_sigma * f;
                    let read = f + sigma * plan.noise * dice.normal();
                    out.push_str(&format!(
                        "{test},{},{kg},{},{},{read:.4},{sigma:.4}\n",
                        list(&pose),
                        list(&cg),
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
        let sigma = self.rig.sigma_arcmin;
        for (name, _, k) in self.joints().into_iter().filter(|j| self.rig.bench.contains(&j.0)) {
            let largest = match (k * 9e-4 / 50.0).round() * 50.0 {
                0.0 => (k * 9e-4).ceil(),
                coarse => coarse,
            };
            let up: Vec<f64> = (-8..=8).map(|i| largest * i as f64 / 8.0).collect();
            let down: Vec<f64> = up.iter().rev().copied().collect();
            let law = self.law(&name, k);
            let mut s = 0.0f64;
            for recorded in [false, true] {
                for (branch, torques) in [("loading", &up), ("unloading", &down)] {
                    for &t in torques {
                        let width_nm = self.width_nm(&name, k, t);
                        s = s.max(t - width_nm).min(t + width_nm);
                        let angle = law(t) + (s - t) / k;
                        if recorded {
                            test += 1;
                            let read = angle * ARCMIN_PER_RAD + sigma * plan.noise * dice.normal();
                            out.push_str(&format!("{test},{name},{t},{branch},{read:.4},{sigma}\n"));
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

fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|n| format!("{n}")).collect::<Vec<_>>().join(",")
}
