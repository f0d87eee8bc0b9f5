//! Gravity in any direction, moments at the tip and coupled joints, each against a way of its own.

use crate::dice::Dice;
use crate::exact_front::random_study;
use crate::exact_support::{both_searches, read};
use armwright::arm::{JointModel, LinkModel, Payload, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use armwright::sizing::LinearReading;
use armwright::space::{ArmProblem, evaluate};
use nalgebra::{Rotation3, Unit, Vector3};
use serde_json::{Value, json};

fn array(v: &Vector3<f64>) -> Value {
    json!(v.as_slice())
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_fn(|i, _| value[i].as_f64().expect("a number"))
}

/// An arm on a wall or a ceiling is the same arm upright with its base turned by a rigid joint.
#[test]
fn gravity_along_a_vector_is_a_base_that_was_turned() {
    let (dice, catalogs) = (&mut Dice(21), Catalogs::builtin());
    for round in 0..30 {
        let axis = Vector3::new(dice.within(-1.0, 1.0), dice.within(-1.0, 1.0), dice.within(-1.0, 1.0));
        let angle_deg = dice.within(-180.0, 180.0);
        let tube = json!({"type": "link", "name": "tube", "vector_m": [0.7, 0.1, 0.2], "material": "Aluminium 6061-T6",
            "section": {"shape": "rectangular_tube", "width_m": 0.05, "height_m": 0.08, "wall_m": 0.003},
            "bodies": [{"mass_kg": 1.5, "cg_m": [0.3, 0.1, 0], "inertia_kgm2": [[0.01, 0, 0], [0, 0.02, 0], [0, 0, 0.02]]}]});
        let chain = json!([
            {"type": "joint", "name": "a", "axis": [0.3, 1, 0], "stiffness_nm_per_rad": 5e4, "mass_kg": 3}, tube,
            {"type": "joint", "name": "b", "axis": [0, 1, 0.2], "stiffness_nm_per_rad": 2e4, "mass_kg": 2},
            {"type": "link", "name": "hand", "vector_m": [0.3, 0, 0], "mass_kg": 1}]);
        let mut turned = chain.clone();
        let base =
            json!({"type": "joint", "name": "base_turn", "axis": array(&axis), "stiffness_nm_per_rad": null});
        turned.as_array_mut().expect("a chain").insert(0, base);
        let turn = Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle_deg.to_radians());
        let gravity = turn.inverse() * Vector3::new(0.0, 0.0, -9.81);
        let solve = |chain: &Value, gravity: Value, pose_rad: &[f64], force_n: Vector3<f64>| {
            let text = json!({"gravity_m_s2": gravity, "chain": chain}).to_string();
            let document = Document::parse("arm.json", &text).expect("JSON");
            let arm = read_arm_document(document, &catalogs).unwrap_or_else(|e| panic!("{e}"));
            let chain = Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full);
            let payload = Payload { mass_kg: 4.0, cg_m: Vector3::new(0.0, 0.05, 0.1), ..Payload::default() };
            let posed = chain.pose_rad(pose_rad, &payload, force_n);
            let statics = posed.statics();
            (
                statics.tip_displacement_m,
                statics.joint_torques_nm.clone(),
                posed.lowest_frequency_hz(&statics),
            )
        };
        let force_n = Vector3::new(12.0, -7.0, 3.0);
        let (tip, torques, hz) = solve(&chain, array(&gravity), &[0.4, -0.9], force_n);
        let (tip_2, torques_2, hz_2) =
            solve(&turned, json!(9.81), &[angle_deg.to_radians(), 0.4, -0.9], turn * force_n);
        assert!((turn * tip - tip_2).norm() < 1e-12 * tip.norm().max(1e-3), "round {round}: {tip} {tip_2}");
        for (a, b) in torques.iter().zip(&torques_2[1..]) {
            assert!((a.1 - b.1).abs() < 1e-10, "round {round}: {torques:?} {torques_2:?}");
        }
        assert!((hz / hz_2 - 1.0).abs() < 1e-9, "round {round}: {hz} {hz_2}");
    }
}

/// Work of a moment on the rotation of the tip: by reciprocity with a force that makes the same moment at a joint.
#[test]
fn a_moment_at_the_tip_is_a_pair_of_forces() {
    let arm = json!({"gravity_m_s2": 0, "chain": [
        {"type": "joint", "name": "a", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
        {"type": "link", "name": "l", "vector_m": [0.5, 0, 0]}]});
    let document = Document::parse("arm.json", &arm.to_string()).expect("JSON");
    let arm = read_arm_document(document, &Catalogs::default()).expect("sound");
    let chain = Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full);
    let mut posed = chain.pose_rad(&[0.0], &Payload::default(), Vector3::zeros());
    posed.tip_moment_nm = Vector3::new(3.0, 20.0, 0.0);
    let statics = posed.statics();
    assert_eq!(statics.joint_torques_nm[0].1, 20.0);
    // 20 N m on 1e4 N m/rad at a lever of 0.5 m: a positive turn about y lowers the tip
    assert!((statics.tip_displacement_m.z + 20.0 / 1e4 * 0.5).abs() < 1e-15);
}

/// Both searches and the full model on studies that hang, lean or float, with moments at the tip.
#[test]
fn searches_agree_in_any_gravity() {
    let catalogs = Catalogs::builtin();
    let mut listed = 0;
    for (seed, gravity) in [
        (1, json!([0, 0, 9.81])),
        (5, json!([9.81, 0, 0])),
        (9, json!([3, -5, -6])),
        (13, json!([0, -9.81, 0])),
    ] {
        let mut text = random_study(seed);
        text["gravity_m_s2"] = gravity;
        text["tip_moment_nm"] = json!([2, 8, -3]);
        text["constraints"] = json!({"stress_safety_factor_min": 1.2});
        listed += both_searches(&read(&text, &catalogs), &catalogs, false, &text.to_string()).1;
    }
    assert!(listed > 20, "{listed}");
}

/// One given joint j at 30 degrees, 2 kg at 0.5 m, and a torque 5 - 8 sin q + 7 cos q beside the weight.
#[test]
fn a_drive_holds_the_torque_that_acts_beside_the_weight() {
    let catalogs = Catalogs::builtin();
    let demand = |effects: Value, reading: LinearReading| {
        let text = json!({"name": "own", "effects": effects,
            "chain": [{"type": "joint", "name": "j", "axis": [0, 1, 0], "drive": "first_fit"},
                {"type": "link", "name": "l", "vector_m": [0.5, 0, 0]}],
            "payload": {"mass_kg": 2}, "poses": [{"pose_deg": [30]}],});
        let mut study = read(&text, &catalogs);
        study.space.motion.linear_reading = reading;
        let problem = ArmProblem::new(&study.space, &catalogs);
        let mut seen = None;
        problem
            .walk(&[], |slot, outboard| {
                if problem.piece_of_slot(slot) == 0 {
                    seen = Some(problem.demand_at(outboard, slot));
                }
            })
            .expect("a drive holds");
        seen.expect("the joint")
    };
    let torque = json!([{"effect": "joint_torque", "at": "j",
        "parameters": {"offset_nm": 5, "sin_nm": -8, "cos_nm": 7}}]);
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let weight_nm = 2.0 * 9.81 * 0.5 * cos;
    for reading in [LinearReading::Exact, LinearReading::Paper] {
        let (alone, with) = (demand(json!([]), reading), demand(torque.clone(), reading));
        assert!((alone.static_torque_nm - weight_nm).abs() < 1e-12);
        assert!((with.static_torque_nm - (weight_nm + 5.0 - 8.0 * sin + 7.0 * cos)).abs() < 1e-12);
        // nothing more has to be accelerated
        assert_eq!(with.linear_torque_nm, alone.linear_torque_nm, "{reading:?}");
        assert!(with.peak_torque_nm() > alone.peak_torque_nm() + 1.0);
    }
}

/// A chain with coupled joints: positions of its point masses, and the mass of each, at driven angles.
fn masses(chain: &Value, driven: &[f64]) -> Vec<(f64, Vector3<f64>)> {
    let pieces = chain.as_array().expect("a chain");
    let names: Vec<&str> = pieces
        .iter()
        .filter(|p| p["type"] == "joint" && p["coupled"].is_null())
        .map(|p| p["name"].as_str().expect("a name"))
        .collect();
    let angle = |name: &str| driven[names.iter().position(|n| *n == name).expect("driven")];
    let (mut at_m, mut turn, mut out) = (Vector3::zeros(), Rotation3::identity(), Vec::new());
    for piece in pieces {
        if piece["type"] == "joint" {
            out.push((piece["mass_kg"].as_f64().unwrap_or(0.0), at_m));
            let q = match piece["coupled"].as_object() {
                Some(terms) => terms.iter().map(|(n, f)| f.as_f64().expect("a factor") * angle(n)).sum(),
                None => angle(piece["name"].as_str().expect("a name")),
            };
            turn *= Rotation3::from_axis_angle(&Unit::new_normalize(vector(&piece["axis"])), q);
        } else {
            let span_m = turn * vector(&piece["vector_m"]);
            out.push((piece["mass_kg"].as_f64().unwrap_or(0.0), at_m + span_m / 2.0));
            at_m += span_m;
        }
    }
    out.push((2.5, at_m));
    out
}

/// The static torque is the derivative of the potential energy by the driver's angle, and the inertia is twice the kinetic
/// energy at one radian a second, both by central differences of places: 1e-6 is what a step of 1e-5 rad leaves.
#[test]
fn a_driver_is_sized_for_what_its_linkages_hand_back() {
    let catalogs = Catalogs::builtin();
    let dice = &mut Dice(4);
    for round in 0..30 {
        let unit = |dice: &mut Dice| [0; 3].map(|_| dice.within(-1.0, 1.0));
        let (mut chain, mut handed_back_nm) = (Vec::new(), [0.0; 3]);
        for i in 0..5 {
            let mut joint = json!({"type": "joint", "name": format!("j{i}"), "axis": unit(dice),
                "stiffness_nm_per_rad": 5e4, "mass_kg": dice.within(0.0, 4.0)});
            if i == 2 || i == 4 {
                joint["coupled"] = json!({"j0": dice.within(-1.5, 1.5), "j1": dice.within(-1.0, 1.0)});
                if i == 4 {
                    handed_back_nm[0] = joint["coupled"]["j0"].as_f64().expect("a factor") * 7.0;
                    handed_back_nm[1] = joint["coupled"]["j1"].as_f64().expect("a factor") * 7.0;
                }
            }
            chain.push(joint);
            chain.push(json!({"type": "link", "name": format!("l{i}"), "vector_m": unit(dice), "mass_kg": dice.within(0.0, 3.0)}));
        }
        let pose_deg: Vec<f64> = (0..3).map(|_| dice.within(-90.0, 90.0)).collect();
        let text = json!({"name": "linked", "chain": chain, "payload": {"mass_kg": 2.5},
            "effects": [{"effect": "joint_torque", "at": "j4", "parameters": {"offset_nm": 7}}],
            "poses": [{"pose_deg": pose_deg}], "motion": {"min_lever_m": 0.5}});
        let study = read(&text, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let driven: Vec<f64> = pose_deg.iter().map(|a| a.to_radians()).collect();
        let mut seen = 0;
        problem
            .walk(&[], |slot, outboard| {
                let piece = problem.piece_of_slot(slot);
                let Some(number) = [0, 2, 6].iter().position(|p| *p == piece) else { return };
                let demand = problem.demand_at(outboard, slot);
                let at = |step: f64| {
                    let mut angles = driven.clone();
                    angles[number] += step;
                    masses(&text["chain"], &angles)
                };
                const STEP: f64 = 1e-5;
                let (back, forth) = (at(-STEP), at(STEP));
                let (mut torque_nm, mut inertia_kgm2) = (0.0, 0.0);
                for ((kg, a), (_, b)) in back.iter().zip(&forth) {
                    let way = (b - a) / (2.0 * STEP);
                    torque_nm += kg * 9.81 * way.z;
                    inertia_kgm2 += kg * way.norm_squared();
                }
                torque_nm -= handed_back_nm[number];
                // 5 m/s2 at the smallest lever of 0.5 m, or at the reach
                let acceleration = demand.linear_torque_nm / inertia_kgm2;
                assert!(
                    (demand.static_torque_nm - torque_nm.abs()).abs() < 1e-6 * (1.0 + torque_nm.abs()),
                    "round {round}, joint {number}: {demand:?} {torque_nm}"
                );
                assert!(
                    (acceleration - 10.0).abs() < 1e-5,
                    "round {round}, joint {number}: {acceleration} rad/s2"
                );
                seen += 1;
            })
            .expect("it holds");
        assert_eq!(seen, 3);
        // the fast deflection is that of the full model, which the mechanics test
        let full = evaluate(&problem, 0).expect("it holds").objectives;
        assert!(full.lowest_mode_hz > 0.0 && full.tip_deflection_m > 0.0);
    }
}
