//! `armwright analyze`: statics, modes and response of an arm file.

use super::failure::Failure;
use super::values::{choice, entries, number_list, numbers};
use crate::arm::effect::entry::Effect;
use crate::arm::file::read_arm;
use crate::arm::load::{LoadCase, Payload, read_load_cases};
use crate::arm::pose::{DrivenJoint, any_slides, pose_of_keys};
use crate::arm::{Arm, Bearing, Element, JointModel, Link, LinkBody, LinkModel};
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::mechanics::chain::Chain;
use crate::mechanics::modes::Mode;
use crate::mechanics::prismatic::GuideLoad;
use crate::mechanics::response::{Response, frequency_response};
use crate::mechanics::statics::{JointLoad, Statics};
use crate::report::number::percent;
use crate::report::pose::pose_words;
use crate::report::small_displacement::too_far;
use crate::report::words::{TERMINAL, wrap};
use crate::space::bearing_loads::resolved;
use crate::study::creep::creep_sentence;
use clap::Args;
use nalgebra::Vector3;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::PathBuf;

/// Prints the joint torques, the tip displacement with every element's share of it, the natural frequencies,
/// and where the strain energy of each mode sits.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright analyze arm.json --pose-deg 0,-30,60 --payload-kg 5 --payload-cg-m 0.05,0,0\n\
                        With a rail: armwright analyze gantry.json --pose rail_mm=250,j2_deg=30\n\
                        Response: armwright analyze arm.json --response-n 0,0,1 --response-hz 1,100,200 --damping 0.02"
)]
pub(crate) struct AnalyzeArgs {
    /// Arm file (JSON)
    arm: PathBuf,
    /// One angle per joint, base to tip [deg]; default all zero
    #[arg(long, value_name = "Q1,Q2,...", allow_hyphen_values = true, value_parser = pose)]
    pose_deg: Option<Pose>,
    /// Angles and travels by joint, each with its unit; default all zero. For arms with prismatic joints
    #[arg(long, value_name = "RAIL_mm=250,J2_deg=30,...", conflicts_with = "pose_deg", value_parser = pose_entries)]
    pose: Option<PoseEntries>,
    /// Payload mass [kg]
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true, value_parser = non_negative)]
    payload_kg: f64,
    /// Payload centre of gravity from the tip, last frame [m]
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true, value_parser = numbers::<3>)]
    payload_cg_m: [f64; 3],
    /// Payload moments of inertia about its centre [kg m2]
    #[arg(long, value_name = "IXX,IYY,IZZ", default_value = "0,0,0", allow_hyphen_values = true, value_parser = moments)]
    payload_inertia_kgm2: [f64; 3],
    /// Force at the tip, world axes [N]
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true, value_parser = numbers::<3>)]
    force_n: [f64; 3],
    /// Moment at the tip, world axes [N m]
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true, value_parser = numbers::<3>)]
    moment_nm: [f64; 3],
    /// Link model: rigid, bending (Eqs 1-6) or full
    #[arg(long, default_value = "full", value_parser = choice::<LinkModel>)]
    links: LinkModel,
    /// Joint model: k2 (the paper's single number), three_segment, or three_segment_k1 (modes with the
    /// gears' first slope)
    #[arg(long, default_value = "three_segment", value_parser = choice::<JointModel>)]
    joints: JointModel,
    /// How many modes to print
    #[arg(long, default_value_t = 6)]
    modes: usize,
    /// Take pose, payload and models from a cases file instead of these options
    #[arg(long, value_name = "FILE", conflicts_with_all = ["pose_deg", "pose", "payload_kg", "payload_cg_m", "payload_inertia_kgm2", "force_n", "moment_nm", "links", "joints"])]
    cases: Option<PathBuf>,
    /// Amplitude of a harmonic force at the tip, world axes [N]: prints the tip's response (Eq 16)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    response_n: Option<[f64; 3]>,
    /// Damping ratio of every mode
    #[arg(long, requires = "response_n", default_value_t = 0.02, allow_hyphen_values = true, value_parser = non_negative)]
    damping: f64,
    /// Frequencies of the response: from, to [Hz] and number of points
    #[arg(long, requires = "response_n", value_name = "FROM,TO,POINTS", default_value = "1,100,100", allow_hyphen_values = true, value_parser = frequencies)]
    response_hz: Frequencies,
    /// Print JSON, every number to the last digit
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone)]
struct Pose(Vec<f64>);

fn pose(text: &str) -> Result<Pose, String> {
    number_list(text).map(Pose)
}

#[derive(Debug, Clone)]
struct PoseEntries(Vec<(String, f64)>);

fn pose_entries(text: &str) -> Result<PoseEntries, String> {
    entries(text).map(PoseEntries)
}

/// Three moments of inertia, none negative.
fn moments(text: &str) -> Result<[f64; 3], String> {
    let moments = numbers::<3>(text)?;
    match moments.iter().all(|&i| i >= 0.0) {
        true => Ok(moments),
        false => Err("a moment of inertia is not negative".into()),
    }
}

/// Frequencies of a response \[Hz\].
#[derive(Debug, Clone)]
struct Frequencies(Vec<f64>);

fn frequencies(text: &str) -> Result<Frequencies, String> {
    let [from, to, points] = numbers::<3>(text)?;
    if from < 0.0 || to <= from {
        return Err("give two frequencies, the second above the first and none negative".into());
    }
    if points.fract() != 0.0 || !(2.0..=100_000.0).contains(&points) {
        return Err(format!("{points} points: give a whole number from 2 to 100000"));
    }
    let last = points - 1.0;
    Ok(Frequencies((0..points as usize).map(|i| from + (to - from) * i as f64 / last).collect()))
}

fn non_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x >= 0.0 && x.is_finite() => Ok(x),
        _ => Err("give a number that is not negative".into()),
    }
}

/// One case, solved.
struct Solved {
    case: LoadCase,
    statics: Statics,
    modes: Vec<Mode>,
    response: Option<Vec<Response>>,
    /// Effects on the bending of links, if the case holds links rigid.
    unbent: Vec<String>,
}

/// Executes the verb.
pub(super) fn run(args: &AnalyzeArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    let arm = read_arm(&args.arm, catalogs)?;
    let cases = match &args.cases {
        Some(path) => read_load_cases(Document::read(path)?, &arm.driven_joints())?,
        None => vec![case_of_flags(args, &arm)?],
    };
    let ignored: Vec<String> = arm.ignored_effects().into_iter().map(Effect::label).collect();
    let solved: Vec<Solved> = cases.into_iter().map(|case| solve(args, &arm, case)).collect();
    Ok(match (args.json, &args.cases) {
        (true, None) => pretty(&solved[0].to_json(&arm, &ignored)),
        (true, Some(_)) => pretty(&Value::Array(solved.iter().map(|s| s.to_json(&arm, &ignored)).collect())),
        (false, _) => {
            let text = solved.iter().map(|s| s.to_text(&arm)).collect::<Vec<_>>().join("\n");
            text + &ignored_text(&ignored) + &creep_text(&arm, catalogs)
        }
    })
}

/// Names the effects that an analysis ignores because they describe a test and not the arm.
fn ignored_text(ignored: &[String]) -> String {
    match ignored {
        [] => String::new(),
        effects => {
            format!("  ignored, because they describe a test and not the arm: {}\n", effects.join(", "))
        }
    }
}

/// What is said of the arm's materials that creep.
fn creep_text(arm: &Arm, catalogs: &Catalogs) -> String {
    let tubes = arm.chain.iter().filter_map(|element| match element {
        Element::Link(Link { name, body: LinkBody::Tube { material_name, .. }, .. }) => {
            Some((material_name, name))
        }
        _ => None,
    });
    let sentences = tubes.filter_map(|(material, link)| creep_sentence(catalogs, material, link));
    sentences.map(|sentence| wrap(&sentence, TERMINAL, "")).collect()
}

fn pretty(value: &Value) -> String {
    serde_json::to_string_pretty(value).expect("a value of numbers and strings serializes")
}

fn case_of_flags(args: &AnalyzeArgs, arm: &Arm) -> Result<LoadCase, Failure> {
    Ok(LoadCase {
        name: "case".into(),
        pose_deg: pose_of_flags(args, &arm.driven_joints())?,
        payload: Payload {
            mass_kg: args.payload_kg,
            cg_m: args.payload_cg_m.into(),
            inertia_about_cg_kgm2: args.payload_inertia_kgm2.into(),
        },
        tip_force_n: args.force_n.into(),
        tip_moment_nm: args.moment_nm.into(),
        links: args.links,
        joints: args.joints,
        water: None,
    })
}

/// The pose that the options give, every joint at 0 by default.
fn pose_of_flags(args: &AnalyzeArgs, driven: &[DrivenJoint]) -> Result<Vec<f64>, Failure> {
    if let Some(PoseEntries(given)) = &args.pose {
        let given = given.iter().map(|(key, entry)| (key.as_str(), *entry));
        return pose_of_keys(driven, given).map_err(|(key, hint)| {
            Failure::Usage(format!("--pose: \"{key}\" is no entry of a pose: {hint}"))
        });
    }
    let Some(Pose(angles_deg)) = &args.pose_deg else { return Ok(vec![0.0; driven.len()]) };
    if any_slides(driven) {
        let keys: Vec<String> = driven.iter().map(|joint| format!("{}=0", joint.key())).collect();
        return Err(Failure::Usage(format!(
            "--pose-deg has angles, and the arm has prismatic joints: write --pose {} with your numbers",
            keys.join(",")
        )));
    }
    if angles_deg.len() != driven.len() {
        let names: Vec<&str> = driven.iter().map(|joint| joint.name.as_str()).collect();
        return Err(Failure::Usage(format!(
            "--pose-deg has {} angles, the arm has {} driven joints: {}",
            angles_deg.len(),
            driven.len(),
            names.join(", ")
        )));
    }
    Ok(angles_deg.clone())
}

fn solve(args: &AnalyzeArgs, arm: &Arm, case: LoadCase) -> Solved {
    let structure = arm.structure_in(&case);
    let chain = Chain::new(&structure, case.links);
    let posed = chain.pose(&case);
    let statics = posed.statics();
    let modes = posed.modes(&statics, args.modes);
    let response = args.response_n.map(|force| {
        frequency_response(&posed, &statics, &Vector3::from(force), args.damping, &args.response_hz.0)
    });
    let rigid = case.links == LinkModel::Rigid;
    let unbent = arm.effects.iter().filter(|e| rigid && e.is_of_bending()).map(Effect::label).collect();
    Solved { case, statics, modes, response, unbent }
}

impl Solved {
    fn to_json(&self, arm: &Arm, ignored: &[String]) -> Value {
        let torques: Map<String, Value> =
            self.statics.joint_torques_nm.iter().map(|(n, t)| (n.clone(), json!(t))).collect();
        let moments: Map<String, Value> =
            self.carried().map(|(joint, load)| (joint.to_string(), json!(load.moment_nm))).collect();
        let shares: Vec<Value> = self
            .statics
            .shares_m
            .iter()
            .map(|(n, s)| json!({"element": n, "tip_displacement_m": s.as_slice()}))
            .collect();
        let mut out = json!({
            "name": self.case.name,
            "joint_torque_nm": torques,
            "bearing_moment_nm": moments,
            "bearings": self.bearings_json(arm),
            "rigid_bearings": rigid_bearings(arm),
            "tip_displacement_m": self.statics.tip_displacement_m.as_slice(),
            "small_displacements": too_far(self.statics.tip_displacement_m.norm(), arm.reach_m()).is_none(),
            "shares": shares,
            "modes": self.modes.iter().map(mode_json).collect::<Vec<_>>(),
        });
        self.guides_json(&mut out);
        let impossible = arm.impossible_bodies();
        if !impossible.is_empty() {
            out["impossible_inertias"] = json!(impossible);
        }
        let ignored: Vec<&String> = ignored.iter().chain(&self.unbent).collect();
        if !ignored.is_empty() {
            out["ignored_effects"] = json!(ignored);
        }
        if let Some(response) = &self.response {
            out["response"] = response
                .iter()
                .map(|r| {
                    json!({
                        "frequency_hz": r.frequency_hz,
                        "tip_amplitude_m": r.amplitude_m().as_slice(),
                        "tip_phase_rad": r.phase_rad().as_slice(),
                    })
                })
                .collect();
        }
        out
    }

    /// Adds what drives and guides of prismatic joints hold, if there are any.
    fn guides_json(&self, out: &mut Value) {
        if self.statics.guide_loads.is_empty() {
            return;
        }
        let each = |of: &dyn Fn(&GuideLoad) -> Value| -> Value {
            Value::Object(self.statics.guide_loads.iter().map(|load| (load.name.clone(), of(load))).collect())
        };
        let forces = self.statics.joint_forces_n.iter().map(|(name, n)| (name.clone(), json!(n)));
        out["joint_force_n"] = Value::Object(forces.collect());
        out["guide_force_n"] = each(&|load| json!([load.force_n.y, load.force_n.z]));
        out["guide_moment_nm"] = each(&|load| json!(load.moment_nm.as_slice()));
    }

    /// What the guides of prismatic joints carry across their travel.
    fn guides_text(&self, out: &mut String) {
        if self.statics.guide_loads.is_empty() {
            return;
        }
        let _ = writeln!(out, "  guide          force across N (y, z)    moment Nm (roll, pitch, yaw)");
        for GuideLoad { name, force_n, moment_nm } in &self.statics.guide_loads {
            let _ = writeln!(
                out,
                "  {name:<14} {:10.3} {:10.3}    {:10.3} {:10.3} {:10.3}",
                force_n.y, force_n.z, moment_nm.x, moment_nm.y, moment_nm.z
            );
        }
    }

    /// The joints with what their output bearings carry at rest.
    fn carried(&self) -> impl Iterator<Item = (&str, &JointLoad)> {
        let joints = self.statics.joint_torques_nm.iter().map(|(name, _)| name.as_str());
        joints.zip(&self.statics.bearing_loads)
    }

    /// The joints that have an output bearing, with the bearing and what it carries.
    fn on_bearings<'a>(&'a self, arm: &'a Arm) -> impl Iterator<Item = (&'a str, OnBearing<'a>)> {
        let bearing = |name: &str| {
            let at = arm.chain.iter().position(|element| element.name() == name)?;
            let Element::Joint(joint) = &arm.chain[at] else { return None };
            Some(resolved(joint.bearing?, &joint.axis, arm.chain.get(at + 1)))
        };
        self.carried()
            .filter_map(move |(name, load)| Some((name, OnBearing { load, bearing: bearing(name)? })))
    }

    fn bearings_json(&self, arm: &Arm) -> Map<String, Value> {
        let of_joint = |(name, on): (&str, OnBearing)| {
            let value = json!({
                "radial_force_n": on.load.radial_n,
                "axial_force_n": on.load.axial_n,
                "offset_m": on.bearing.offset_m,
                "moment_with_offset_nm": on.moment_with_offset_nm(),
                "permissible_moment_nm": on.bearing.permissible_moment_nm,
            });
            (name.to_string(), value)
        };
        self.on_bearings(arm).map(of_joint).collect()
    }

    /// The moments on the output bearings, next to what is permitted.
    fn bearings_text(&self, arm: &Arm, out: &mut String) {
        let mut on_bearings = self.on_bearings(arm).peekable();
        if on_bearings.peek().is_none() {
            return;
        }
        let _ =
            writeln!(out, "  output bearing  moment Nm   at its centre   permitted   (load at rest alone)");
        for (name, on) in on_bearings {
            let permitted = on.bearing.permissible_moment_nm;
            let _ = writeln!(
                out,
                "  {name:<14} {:>10.3} {:>15.3} {:>11}{}",
                on.load.moment_nm,
                on.moment_with_offset_nm(),
                permitted.map_or("unknown".into(), |nm| format!("{nm:.1}")),
                if permitted.is_some_and(|nm| on.moment_with_offset_nm() > nm) { "   too much" } else { "" }
            );
        }
    }

    fn to_text(&self, arm: &Arm) -> String {
        let driven = arm.driven_joints();
        let pose = match any_slides(&driven) {
            true => pose_words(&driven, &self.case.pose_deg),
            false => format!("{:?} deg", self.case.pose_deg),
        };
        let mut out = format!("{}, case \"{}\": pose {pose}\n", arm.name, self.case.name);
        let _ = writeln!(out, "  arm mass            {:10.3} kg", arm.mass_kg());
        let added_kg = arm.structure_in(&self.case).mass_kg() - arm.mass_kg();
        if added_kg.abs() > 1e-9 {
            let _ = writeln!(out, "  effects add         {added_kg:10.3} kg");
        }
        let tip = self.statics.tip_displacement_m * 1e3;
        let _ = writeln!(
            out,
            "  tip displacement    {:10.4} mm   (x {:.4}, y {:.4}, z {:.4} mm)",
            tip.norm(),
            tip.x,
            tip.y,
            tip.z
        );
        if let Some(words) = too_far(self.statics.tip_displacement_m.norm(), arm.reach_m()) {
            let _ = writeln!(
                out,
                "  The tip {words}.\n  Is every number of the file in its unit (Pa, kg/m3, m, kg, N m/rad)?"
            );
        }
        if !self.unbent.is_empty() {
            let _ = writeln!(out, "  ignored, because links are held rigid: {}", self.unbent.join(", "));
        }
        self.shares_text(&mut out);
        self.guides_text(&mut out);
        self.bearings_text(arm, &mut out);
        let impossible = arm.impossible_bodies();
        if !impossible.is_empty() {
            let _ = writeln!(
                out,
                "  no solid has the inertia of a body of {}: one principal moment exceeds the sum of the others",
                impossible.join(", ")
            );
        }
        let rigid = rigid_bearings(arm);
        if !rigid.is_empty() {
            let _ = writeln!(out, "  rigid output bearing without mass: {}", rigid.join(", "));
        }
        self.modes_text(&mut out);
        self.response_text(&mut out);
        out
    }

    fn shares_text(&self, out: &mut String) {
        let total = self.statics.tip_displacement_m;
        let _ = writeln!(out, "  element          torque Nm    moves the tip by mm (x, y, z)      share");
        for (name, share) in &self.statics.shares_m {
            let torque = self.statics.joint_torques_nm.iter().find(|(n, _)| n == name);
            let force = self.statics.joint_forces_n.iter().find(|(n, _)| n == name);
            let torque = match (torque, force) {
                (Some((_, nm)), _) => format!("{nm:.3}"),
                (_, Some((_, newton))) => format!("{newton:.3} N"),
                _ => String::new(),
            };
            let part = 100.0 * share.dot(&total) / total.norm_squared().max(f64::MIN_POSITIVE);
            let mm = share * 1e3;
            let _ = writeln!(
                out,
                "  {name:<14} {torque:>11}  {:10.5} {:10.5} {:10.5}  {part:7.2} %",
                mm.x, mm.y, mm.z
            );
        }
    }

    fn modes_text(&self, out: &mut String) {
        let _ = writeln!(out, "  mode  frequency Hz  plane  where the strain energy sits");
        for (k, mode) in self.modes.iter().enumerate() {
            let mut parts: Vec<&(String, f64)> =
                mode.strain_energy.iter().filter(|(_, e)| *e >= 0.01).collect();
            parts.sort_by(|a, b| b.1.total_cmp(&a.1));
            let parts: Vec<String> =
                parts.iter().map(|(n, e)| format!("{n} {}", percent(100.0 * e, 0))).collect();
            let plane = mode.plane.unwrap_or("-");
            let _ = writeln!(
                out,
                "  {:>4}  {:>12.4}  {plane:<5}  {}",
                k + 1,
                mode.frequency_hz,
                parts.join(", ")
            );
        }
    }

    fn response_text(&self, out: &mut String) {
        let Some(response) = &self.response else { return };
        let _ = writeln!(out, "  frequency Hz   tip amplitude mm (x, y, z)            phase deg (x, y, z)");
        for r in response {
            let (a, p) = (r.amplitude_m() * 1e3, r.phase_rad().map(f64::to_degrees));
            let _ = writeln!(
                out,
                "  {:>12.3}   {:11.6} {:11.6} {:11.6}   {:8.1} {:8.1} {:8.1}",
                r.frequency_hz, a.x, a.y, a.z, p.x, p.y, p.z
            );
        }
    }
}

/// The joints with a gear whose output bearing the arm file leaves out.
fn rigid_bearings(arm: &Arm) -> Vec<&str> {
    let rigid = |element: &Element| matches!(element, Element::Joint(joint) if joint.gear.is_some() && joint.bearing.is_none());
    arm.chain.iter().filter(|element| rigid(element)).map(Element::name).collect()
}

/// An output bearing and what it carries at rest.
struct OnBearing<'a> {
    load: &'a JointLoad,
    bearing: Bearing,
}

impl OnBearing<'_> {
    /// Moment at the centre of the bearing: its lever along the axis counts \[N m\].
    fn moment_with_offset_nm(&self) -> f64 {
        self.load.moment_nm + self.bearing.offset_m.unwrap_or_default().abs() * self.load.radial_n
    }
}

fn mode_json(mode: &Mode) -> Value {
    let energy: Map<String, Value> = mode.strain_energy.iter().map(|(n, e)| (n.clone(), json!(e))).collect();
    json!({"frequency_hz": mode.frequency_hz, "plane": mode.plane, "strain_energy": energy})
}
