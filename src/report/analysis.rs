//! The results of an arm in one load case (torques, tip displacement, modes and response) as JSON and as text.

use super::divided::{divided_lowest_hz, too_high};
use super::number::{percent, shortest};
use super::pose::pose_words;
use super::small_displacement::too_far;
use super::springs::{spring_json, springs_in, springs_text};
use crate::arm::effect::entry::Effect;
use crate::arm::extras::Extras;
use crate::arm::load::LoadCase;
use crate::arm::pose::any_slides;
use crate::arm::springs::Drawn;
use crate::arm::structure::{JointAngle, JointPiece};
use crate::arm::{Arm, Bearing, Element, JointModel, LinkModel};
use crate::mechanics::chain::Chain;
use crate::mechanics::link_stress::LinkStresses;
use crate::mechanics::modes::Mode;
use crate::mechanics::prismatic::GuideLoad;
use crate::mechanics::response::{Response, frequency_response};
use crate::mechanics::statics::{JointLoad, Statics};
use crate::space::bearing_loads::{at_centre, bearings_of};
use nalgebra::Vector3;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// A harmonic force at the tip, and the frequencies at which the response is computed (Eq 16).
#[derive(Debug, Clone, PartialEq)]
pub struct Harmonic {
    /// Amplitude of the force, in world axes \[N\].
    pub force_n: Vector3<f64>,
    /// Damping ratio of every mode.
    pub damping: f64,
    /// Frequencies at which the response is computed \[Hz\].
    pub frequencies_hz: Vec<f64>,
}

/// The load of a case in words: `payload 3 kg`, with force and moment at the tip if there are any.
fn load_words(case: &LoadCase) -> String {
    let axes = |v: &Vector3<f64>| v.iter().map(|x| shortest(*x)).collect::<Vec<_>>().join(", ");
    let payload = match case.payload.mass_kg {
        0.0 => "no payload".to_string(),
        kg => format!("payload {} kg", shortest(kg)),
    };
    let with = |what: &str, v: &Vector3<f64>, unit: &str| {
        (v.norm() > 0.0).then(|| format!(", {what} ({}) {unit} at the tip", axes(v)))
    };
    let force = with("force", &case.tip_force_n, "N").unwrap_or_default();
    let moment = with("moment", &case.tip_moment_nm, "N m").unwrap_or_default();
    payload + &force + &moment
}

/// The results of an arm in one load case.
///
/// ```
/// use armwright::arm::{read_arm_document, read_load_cases};
/// use armwright::catalog::Catalogs;
/// use armwright::input::Document;
/// use armwright::report::analysis::Analysis;
///
/// let file = r#"{"name": "lever", "chain": [
///     {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
///     {"type": "link", "name": "l1", "vector_m": [1, 0, 0], "mass_kg": 2}]}"#;
/// let arm = read_arm_document(Document::parse("arm.json", file)?, &Catalogs::builtin())?;
/// let case = r#"[{"name": "level", "pose_deg": [0]}]"#;
/// let cases = read_load_cases(Document::parse("cases.json", case)?, &arm.driven_joints())?;
/// let solved = Analysis::of(&arm, cases[0].clone(), 1, None).to_json(&arm);
/// // the weight of 2 kg at half a metre
/// let torque_nm = solved["joint_torque_nm"]["j1"].as_f64().expect("a number");
/// assert!((torque_nm - 2.0 * 9.81 * 0.5).abs() < 1e-12);
/// # Ok::<(), armwright::input::Faults>(())
/// ```
pub struct Analysis {
    /// The load case.
    pub case: LoadCase,
    /// Joint torques, tip displacement, and the displacement that each element causes.
    pub statics: Statics,
    /// The lowest modes, as many as were requested.
    pub modes: Vec<Mode>,
    /// Response to a harmonic force; `None` if it was not requested.
    pub response: Option<Vec<Response>>,
    /// Names of effects on the bending of links, if the case has rigid links and so ignores them.
    unbent: Vec<String>,
    /// Name of each balance spring, with its length and force, or its torque, in the pose of the case.
    springs: Vec<(String, Drawn)>,
    /// The lowest mode, computed with every tube cut into several tubes at the bodies on it \[Hz\]. `None` if no tube
    /// has a body between its ends, or no mode was asked for.
    divided_hz: Option<f64>,
    /// Largest ratio of stress to strength in each link at rest, with the name of the link. Links whose material has no
    /// known strength are left out.
    stress: Vec<(String, f64)>,
}

impl Analysis {
    /// Computes the results of the arm in the load case `case`: statics, the `modes` lowest modes, and the response to
    /// `harmonic`, a harmonic force at the tip, if it is given.
    pub fn of(arm: &Arm, case: LoadCase, modes: usize, harmonic: Option<&Harmonic>) -> Self {
        let structure = arm.structure_in(&case);
        let chain = Chain::new(&structure, case.links);
        let posed = chain.pose(&case);
        let statics = posed.statics();
        let modes = posed.modes(&statics, modes);
        let response =
            harmonic.map(|h| frequency_response(&posed, &statics, &h.force_n, h.damping, &h.frequencies_hz));
        let rigid = case.links == LinkModel::Rigid;
        let unbent = arm.effects.iter().filter(|e| rigid && e.is_of_bending()).map(Effect::label).collect();
        let springs = springs_in(&chain, &case);
        let divided_hz = if modes.is_empty() { None } else { divided_lowest_hz(arm, &case) };
        let links = LinkStresses::new(arm, &case);
        let stress = links.in_case(&case).into_iter().map(|(link, part)| (link.to_string(), part)).collect();
        Self { case, statics, modes, response, unbent, springs, divided_hz, stress }
    }

    /// The results as `armwright analyze --json` prints them; `docs/arm-format.md` describes the keys.
    pub fn to_json(&self, arm: &Arm) -> Value {
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
            "bearings_without_stiffness": bearings_without_stiffness(arm),
            "without_extras": without_extras(arm),
            "tip_displacement_m": self.statics.tip_displacement_m.as_slice(),
            "small_displacements": too_far(self.statics.tip_displacement_m.norm(), arm.reach_m()).is_none(),
            "shares": shares,
            "modes": self.modes.iter().map(mode_json).collect::<Vec<_>>(),
        });
        if !self.springs.is_empty() {
            out["springs"] = self.springs.iter().map(spring_json).collect();
            out["springs_stiffen_modes"] = json!(false);
        }
        self.guides_json(arm, &mut out);
        if !self.stress.is_empty() {
            let of_links = self.stress.iter().map(|(link, part)| (link.clone(), json!(part)));
            out["link_stress_over_strength"] = Value::Object(of_links.collect());
        }
        if let Some(divided_hz) = self.divided_hz {
            out["lowest_mode_divided_hz"] = json!(divided_hz);
        }
        let impossible = arm.impossible_bodies();
        if !impossible.is_empty() {
            out["impossible_inertias"] = json!(impossible);
        }
        let of_tests = arm.ignored_effects().into_iter().map(Effect::label);
        let ignored: Vec<String> = of_tests.chain(self.unbent.iter().cloned()).collect();
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

    /// Adds the forces of drives and the loads on guides to the object `out`, if the arm has prismatic joints.
    fn guides_json(&self, arm: &Arm, out: &mut Value) {
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
        out["guide_part_used"] = each(&|load| json!(part_used(arm, load)));
    }

    /// Adds a table of the loads on the guides of prismatic joints.
    fn guides_text(&self, arm: &Arm, out: &mut String) {
        if self.statics.guide_loads.is_empty() {
            return;
        }
        let _ = writeln!(
            out,
            "  guide          force across N (y, z)    moment Nm (roll, pitch, yaw)      of what it holds at rest"
        );
        for load in &self.statics.guide_loads {
            let GuideLoad { name, force_n, moment_nm, .. } = load;
            let used = match part_used(arm, load) {
                Some(part) => percent(100.0 * part, 1) + if part > 1.0 { "   too much" } else { "" },
                None => "unknown".into(),
            };
            let _ = writeln!(
                out,
                "  {name:<14} {:10.3} {:10.3}    {:10.3} {:10.3} {:10.3}   {used:>10}",
                force_n.y, force_n.z, moment_nm.x, moment_nm.y, moment_nm.z
            );
        }
        out.push_str(&not_in_the_part(arm));
    }

    /// The joints, each with the load on its output bearing while the joint is at rest.
    fn carried(&self) -> impl Iterator<Item = (&str, &JointLoad)> {
        let joints = self.statics.joint_torques_nm.iter().map(|(name, _)| name.as_str());
        joints.zip(&self.statics.bearing_loads)
    }

    /// The joints that have an output bearing, each with the bearing and the load on the bearing with the joint at
    /// rest.
    fn on_bearings<'a>(&'a self, arm: &'a Arm) -> impl Iterator<Item = (&'a str, OnBearing<'a>)> {
        let bearings: Vec<(&str, Bearing)> = bearings_of(arm).collect();
        let bearing =
            move |name: &str| bearings.iter().find(|(joint, _)| *joint == name).map(|(_, bearing)| *bearing);
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

    /// Adds a table of the moments on the output bearings and of the permissible moments.
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

    /// The results as `armwright analyze` prints them.
    pub fn to_text(&self, arm: &Arm) -> String {
        let driven = arm.driven_joints();
        let pose = match any_slides(&driven) {
            true => pose_words(&driven, &self.case.pose_deg),
            false => format!("{:?} deg", self.case.pose_deg),
        };
        let mut out =
            format!("{}, case \"{}\": pose {pose}, {}\n", arm.name, self.case.name, load_words(&self.case));
        self.mass_and_tip_text(arm, &mut out);
        if !self.unbent.is_empty() {
            let _ = writeln!(out, "  ignored, because links are held rigid: {}", self.unbent.join(", "));
        }
        self.stress_text(&mut out);
        self.shares_text(&mut out);
        self.guides_text(arm, &mut out);
        self.bearings_text(arm, &mut out);
        joints_remarks_text(arm, &mut out);
        springs_text(&self.springs, &mut out);
        self.modes_text(&mut out);
        self.response_text(&mut out);
        out
    }

    /// Adds the mass of the arm and the displacement of its tip.
    fn mass_and_tip_text(&self, arm: &Arm, out: &mut String) {
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
    }

    /// Adds the largest stress in a link, as a part of its strength.
    fn stress_text(&self, out: &mut String) {
        let Some((link, part)) = self.stress.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { return };
        let too_much = if *part > 1.0 { "   too much" } else { "" };
        let _ = writeln!(
            out,
            "  largest stress      {:>10} of the strength, at rest, in {link}{too_much}",
            percent(100.0 * part, 1)
        );
    }

    /// Adds a table of the elements: the torque or force of each joint, and the share of each element in the
    /// displacement of the tip.
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
        let lowest_hz = self.modes.first().map(|mode| mode.frequency_hz);
        if let (Some(lowest_hz), Some(divided_hz)) = (lowest_hz, self.divided_hz)
            && let Some(words) = too_high(lowest_hz, divided_hz)
        {
            let _ = writeln!(out, "  {words}");
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

/// Whether a joint is driven and has no torsion under its torque. A passive joint is left out, because its linkage
/// turns it.
fn is_rigid(joint: &JointPiece) -> bool {
    joint.law.is_rigid() && matches!(joint.angle, JointAngle::Driven(_))
}

/// Adds remarks on the joints: those without torsion, bodies with an inertia that no solid can have, bearings that
/// count as rigid, and joints for which the file states no masses in addition to gear, motor and bearing.
fn joints_remarks_text(arm: &Arm, out: &mut String) {
    let structure = arm.structure(JointModel::ThreeSegment);
    let stiff: Vec<&str> = structure.joints().filter(|j| is_rigid(j)).map(|j| j.name.as_str()).collect();
    if !stiff.is_empty() {
        let _ = writeln!(
            out,
            "  rigid about their axes, as in the file (a real joint lets the tip deflect further): {}",
            stiff.join(", ")
        );
    }
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
    let unknown = bearings_without_stiffness(arm);
    if !unknown.is_empty() {
        let _ = writeln!(
            out,
            "  rigid output bearing, because its tilting stiffness is unknown (the tip deflects more than printed): {}",
            unknown.join(", ")
        );
    }
    let unweighed = without_extras(arm);
    if !unweighed.is_empty() {
        let _ = writeln!(
            out,
            "  nothing weighed beyond gear, motor and bearing (no \"extras\" in the file): {}",
            unweighed.join(", ")
        );
    }
}

/// Lines on the guides of which the arm states some load limits and not all. Each line names the limits that are
/// missing.
fn not_in_the_part(arm: &Arm) -> String {
    let lines = arm.prismatics().filter_map(|joint| {
        let keys = joint.guide.limits.unknown();
        let lacks_some = (1..4).contains(&keys.len());
        lacks_some.then(|| format!("  {}: not in the part, for want of {}\n", joint.name, keys.join(", ")))
    });
    lines.collect()
}

/// The fraction of a guide's load capacity that a load uses, 1 if it is fully used; `None` if the arm states no limit
/// of this guide.
fn part_used(arm: &Arm, load: &GuideLoad) -> Option<f64> {
    let joint = arm.prismatics().find(|joint| joint.name == load.name)?;
    joint.guide.limits.part_used(&load.force_n, &load.moment_nm)
}

/// The joints that have a gear, but for which the arm file states no output bearing. Their bearings count as rigid.
fn rigid_bearings(arm: &Arm) -> Vec<&str> {
    let rigid = |element: &Element| matches!(element, Element::Joint(joint) if joint.gear.is_some() && joint.bearing.is_none());
    arm.chain.iter().filter(|element| rigid(element)).map(Element::name).collect()
}

/// The joints whose output bearing counts as rigid because its tilting stiffness is unknown, each with the name of its
/// gear.
fn bearings_without_stiffness(arm: &Arm) -> Vec<String> {
    let named = |element: &Element| {
        let Element::Joint(joint) = element else { return None };
        joint.bearing.filter(|bearing| bearing.tilt_stiffness_nm_per_rad.is_none())?;
        let gear = joint.gear.as_ref().map_or(String::new(), |gear| format!(" ({gear})"));
        Some(format!("{}{gear}", joint.name))
    };
    arm.chain.iter().filter_map(named).collect()
}

/// The joints with a gear and a motor for which the file states no further masses (`extras`).
fn without_extras(arm: &Arm) -> Vec<&str> {
    let is_bare = |element: &&Element| {
        matches!(element, Element::Joint(joint)
            if joint.gear.is_some() && joint.motor.is_some() && joint.extras == Extras::default())
    };
    arm.chain.iter().filter(is_bare).map(Element::name).collect()
}

/// An output bearing, and the load on it while its joint is at rest.
struct OnBearing<'a> {
    load: &'a JointLoad,
    bearing: Bearing,
}

impl OnBearing<'_> {
    /// Moment at the centre of the bearing \[N m\]: the moment where the link attaches, plus the radial force times
    /// the bearing's offset along the axis.
    fn moment_with_offset_nm(&self) -> f64 {
        at_centre(self.load, &self.bearing).moment_nm
    }
}

fn mode_json(mode: &Mode) -> Value {
    let energy: Map<String, Value> = mode.strain_energy.iter().map(|(n, e)| (n.clone(), json!(e))).collect();
    json!({"frequency_hz": mode.frequency_hz, "plane": mode.plane, "strain_energy": energy})
}
