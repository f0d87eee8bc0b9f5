//! Springs against their potential, against a pendulum in closed form, and against tubes that are divided where a spring pulls;
//! and searches of studies with springs against each other.

use crate::dice::Dice;
use crate::exact_front::random_study;
use crate::exact_support::{both_searches, read as read_study};
use armwright::arm::{Arm, JointModel, LinkModel, LoadCase, Payload, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::{Chain, Statics};
use armwright::space::{ArmProblem, OutwardIn, evaluate};
use nalgebra::{Rotation3, Unit, Vector3};
use serde_json::{Value, json};

fn read(arm: &Value) -> Arm {
    let document = Document::parse("arm.json", &arm.to_string()).expect("JSON");
    read_arm_document(document, &Catalogs::builtin()).unwrap_or_else(|faults| panic!("{faults}\n{arm}"))
}

fn statics(arm: &Value, pose_rad: &[f64], payload_kg: f64) -> Statics {
    let chain = Chain::new(&read(arm).structure(JointModel::ThreeSegment), LinkModel::Full);
    let payload = Payload { mass_kg: payload_kg, ..Payload::default() };
    chain.pose_rad(pose_rad, &payload, Vector3::zeros()).statics()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_fn(|i, _| value[i].as_f64().expect("a number"))
}

/// Energy of the springs of an arm file in a pose of its driven joints, from the file alone \[J\].
fn potential_j(arm: &Value, driven_rad: &[f64]) -> f64 {
    let (mut at_m, mut turn) = (Vector3::zeros(), Rotation3::identity());
    let mut angles: Vec<(String, f64)> = Vec::new();
    let mut next = driven_rad.iter();
    let mut frames: Vec<(String, Vector3<f64>, Rotation3<f64>)> = Vec::new();
    for piece in arm["chain"].as_array().expect("a chain") {
        let name = piece["name"].as_str().expect("a name").to_string();
        if piece["type"] == "joint" {
            let angle = match piece["coupled"].as_object() {
                Some(terms) => terms
                    .iter()
                    .map(|(of, factor)| {
                        let (_, angle) = angles.iter().find(|(name, _)| name == of).expect("a driver");
                        angle * factor.as_f64().expect("a factor")
                    })
                    .sum(),
                None => *next.next().expect("an angle"),
            };
            turn *= Rotation3::from_axis_angle(&Unit::new_normalize(vector(&piece["axis"])), angle);
            angles.push((name.clone(), angle));
            frames.push((name, at_m, turn));
        } else {
            frames.push((name, at_m, turn));
            at_m += turn * vector(&piece["vector_m"]);
        }
    }
    let end = |end: &Value| {
        let point_m = vector(&end["point_m"]);
        match frames.iter().find(|(name, ..)| end["at"] == name.as_str()) {
            Some((_, at_m, turn)) => at_m + turn * point_m,
            None => point_m,
        }
    };
    let number = |value: &Value| value.as_f64().unwrap_or(0.0);
    let energy = |spring: &Value| match spring["joint"].as_str() {
        Some(joint) => {
            let (_, angle) = angles.iter().find(|(name, _)| name == joint).expect("a joint");
            0.5 * number(&spring["stiffness_nm_per_rad"])
                * (angle - number(&spring["free_deg"]).to_radians()).powi(2)
        }
        None => {
            let length_m = (end(&spring["from"]) - end(&spring["to"])).norm();
            let drawn_m = length_m - number(&spring["free_length_m"]);
            number(&spring["force_n"]) * length_m
                + 0.5 * number(&spring["stiffness_n_per_m"]) * drawn_m * drawn_m
        }
    };
    arm["springs"].as_array().expect("springs").iter().map(energy).sum()
}

fn random_end(dice: &mut Dice, at: &str) -> Value {
    json!({"at": at, "point_m": [dice.within(-0.4, 0.6), dice.within(-0.3, 0.3), dice.within(-0.3, 0.4)]})
}

/// An arm of three to five joints about any axes, one of them passive at times, with two to four springs of all kinds.
fn random_arm(dice: &mut Dice) -> Value {
    let joints = 3 + dice.below(3);
    let mut chain = Vec::new();
    let mut places: Vec<String> = vec!["base".into(), "world".into()];
    for i in 0..joints {
        let axis = [0; 3].map(|_| dice.within(-1.0, 1.0));
        let mut joint = json!({"type": "joint", "name": format!("j{i}"), "axis": axis,
            "stiffness_nm_per_rad": dice.within(1e4, 1e5), "mass_kg": dice.within(0.5, 5.0)});
        if i == 2 && dice.below(2) == 0 {
            joint["coupled"] = json!({"j0": dice.within(-1.0, 1.0), "j1": -1.0});
        }
        chain.push(joint);
        let vector_m = [dice.within(0.2, 0.7), dice.within(-0.1, 0.1), dice.within(-0.2, 0.2)];
        let mut link = json!({"type": "link", "name": format!("l{i}"), "vector_m": vector_m});
        if dice.below(2) == 0 {
            link["material"] = json!("Aluminium 6061-T6");
            link["section"] = json!({"shape": "round_tube", "diameter_m": 0.06, "wall_m": 0.003});
        }
        chain.push(link);
        places.extend([format!("j{i}"), format!("l{i}")]);
    }
    let springs: Vec<Value> = (0..2 + dice.below(3))
        .map(|i| match dice.below(4) {
            0 => json!({"joint": format!("j{}", dice.below(joints)),
                "stiffness_nm_per_rad": dice.within(5.0, 60.0), "free_deg": dice.within(-90.0, 90.0)}),
            kind => {
                let from = dice.of(&places);
                let moving: Vec<String> = places[2..].iter().filter(|to| **to != from).cloned().collect();
                let to = dice.of(&moving);
                let mut spring = json!({"name": format!("s{i}"), "from": random_end(dice, &from),
                    "to": random_end(dice, &to)});
                if kind != 1 {
                    spring["stiffness_n_per_m"] = json!(dice.within(100.0, 3000.0));
                    spring["free_length_m"] = json!(dice.within(0.0, 0.6));
                }
                if kind != 2 {
                    spring["force_n"] = json!(dice.within(-300.0, 300.0));
                }
                spring
            }
        })
        .collect();
    json!({"chain": chain, "springs": springs})
}

/// The torque of springs on every driven joint is the slope of their energy. Central differences of 1e-5 rad err by some 1e-10 of
/// the energy's third derivative and by rounding of 1e-16 / 1e-5 of the energy: 1e-6 of the largest torque covers both.
#[test]
fn springs_turn_joints_as_their_energy_falls() {
    let dice = &mut Dice(28);
    for round in 0..30 {
        let arm = random_arm(dice);
        let mut without = arm.clone();
        without.as_object_mut().expect("an arm").remove("springs");
        let names: Vec<String> = read(&arm).driven_joint_names().into_iter().map(String::from).collect();
        let pose: Vec<f64> = names.iter().map(|_| dice.within(-2.0, 2.0)).collect();
        let [with, alone] = [&arm, &without].map(|arm| statics(arm, &pose, 3.0));
        let torque = |of: &Statics, name: &str| {
            of.joint_torques_nm.iter().find(|(joint, _)| joint == name).expect("a joint").1
        };
        let all: Vec<(f64, f64)> = names
            .iter()
            .enumerate()
            .map(|(i, name)| {
                let moved = |by: f64| {
                    let mut pose = pose.clone();
                    pose[i] += by;
                    potential_j(&arm, &pose)
                };
                let slope = (moved(-1e-5) - moved(1e-5)) / 2e-5;
                (torque(&with, name) - torque(&alone, name), slope)
            })
            .collect();
        let largest = all.iter().map(|(nm, _)| nm.abs()).fold(1.0, f64::max);
        for (i, (found, slope)) in all.iter().enumerate() {
            assert!(
                (found - slope).abs() < 1e-6 * largest,
                "round {round}, joint {i}: {found} {slope}\n{arm}"
            );
        }
        // what is written reads back as the same arm
        let written = read(&arm).to_json();
        assert_eq!(read(&arm), read(&written), "round {round}");
    }
}

/// A spring of zero free length from `h` above a pivot to `r` along a lever balances a mass at `l` in every pose if
/// `k h r = m g l`.
#[test]
fn a_spring_without_free_length_balances_a_pendulum_at_every_angle() {
    let (mass_kg, lever_m, height_m, arm_m) = (7.0, 0.9, 0.35, 0.25);
    let stiffness = mass_kg * 9.81 * lever_m / (height_m * arm_m);
    let arm = json!({"chain": [
        {"type": "joint", "name": "pivot", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
        {"type": "link", "name": "lever", "vector_m": [lever_m, 0, 0]}],
      "springs": [{"from": {"at": "base", "point_m": [0, 0, height_m]}, "to": {"at": "lever", "point_m": [arm_m, 0, 0]},
        "stiffness_n_per_m": stiffness, "free_length_m": 0}]});
    for angle_deg in (-175..180).step_by(25) {
        let found = statics(&arm, &[f64::from(angle_deg).to_radians()], mass_kg);
        assert!(found.joint_torques_nm[0].1.abs() < 1e-9, "{angle_deg} deg: {:?}", found.joint_torques_nm);
        assert!(found.tip_displacement_m.norm() < 1e-12, "{angle_deg} deg");
    }
    // half the mass leaves half of the torque, the other way round
    let found = statics(&arm, &[0.0], mass_kg / 2.0);
    assert!((found.joint_torques_nm[0].1 + mass_kg / 2.0 * 9.81 * lever_m).abs() < 1e-9);
}

/// A torsion spring turns the joint and loads neither its bearing nor the base.
#[test]
fn a_torsion_spring_is_held_by_its_own_joint() {
    let arm = |springs: Value| {
        json!({"chain": [
            {"type": "joint", "name": "a", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2e4},
            {"type": "link", "name": "one", "vector_m": [0.4, 0, 0]},
            {"type": "joint", "name": "b", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2e4},
            {"type": "link", "name": "two", "vector_m": [0.3, 0, 0]}], "springs": springs})
    };
    let pose = [0.2, 0.5];
    let alone = statics(&arm(json!([])), &pose, 4.0);
    let spring = json!([{"joint": "b", "stiffness_nm_per_rad": 30.0, "free_deg": -10}]);
    let with = statics(&arm(spring), &pose, 4.0);
    let turned_nm = 30.0 * ((-10f64).to_radians() - 0.5);
    assert!((with.joint_torques_nm[1].1 - alone.joint_torques_nm[1].1 - turned_nm).abs() < 1e-12);
    assert!((with.joint_torques_nm[0].1 - alone.joint_torques_nm[0].1).abs() < 1e-12);
    assert!((with.base_wrench - alone.base_wrench).norm() < 1e-12);
}

/// Statics of beams are exact, so a tube is the same as two tubes with the spring at the start of the second: to rounding.
#[test]
fn a_spring_bends_a_tube_as_if_it_were_divided_there() {
    let dice = &mut Dice(5);
    let section = json!({"shape": "rectangular_tube", "width_m": 0.04, "height_m": 0.06, "wall_m": 0.002});
    for round in 0..10 {
        let way: Vector3<f64> = Vector3::new(0.8, dice.within(-0.2, 0.2), dice.within(-0.2, 0.2));
        let (at, beside) = (dice.within(0.1, 0.9), Vector3::new(0.0, dice.within(-0.1, 0.1), 0.12));
        // a point beside the axis is carried by the place of the axis that is nearest to it
        let across = beside - way * (beside.dot(&way) / way.norm_squared());
        let tube = |name: &str, part: Vector3<f64>| {
            json!({"type": "link", "name": name, "vector_m": part.as_slice(), "material": "Aluminium 6061-T6",
                "section": section})
        };
        let joint = json!({"type": "joint", "name": "j", "axis": [0, 1, 0.3], "stiffness_nm_per_rad": 3e4});
        let arm = |links: Vec<Value>, on: &str, point_m: Vector3<f64>| {
            let chain: Vec<Value> = std::iter::once(joint.clone()).chain(links).collect();
            json!({"chain": chain, "springs": [{"from": {"at": "base", "point_m": [-0.2, 0.1, 0.5]},
                "to": {"at": on, "point_m": point_m.as_slice()}, "stiffness_n_per_m": 900, "free_length_m": 0.2}]})
        };
        let whole = arm(vec![tube("tube", way)], "tube", way * at + across);
        let parts = vec![tube("near", way * at), tube("far", way * (1.0 - at))];
        let divided = arm(parts, "far", across);
        let pose = [dice.within(-1.0, 1.0)];
        let [a, b] = [&whole, &divided].map(|arm| statics(arm, &pose, 2.0));
        let apart = (a.tip_displacement_m - b.tip_displacement_m).norm() / a.tip_displacement_m.norm();
        assert!(apart < 1e-9, "round {round}: {apart:e}");
        let root = |of: &Statics| of.link_roots[0].clone();
        assert!((root(&a).moment_nm - root(&b).moment_nm).norm() < 1e-9, "round {round}");
    }
}

/// Hangs springs on a random study: to tubes between their ends, to the flange, and about a joint.
fn add_springs(study: &mut Value, seed: u64) {
    let dice = &mut Dice(seed ^ 0x5912);
    let mut springs = vec![
        json!({"name": "balance", "from": {"at": "shoulder", "point_m": [-0.15, 0.0, 0.2]},
            "to": {"at": "upper_arm", "point_m": [dice.within(0.05, 0.4), dice.of(&[0.0, 0.05]), 0.06]},
            "stiffness_n_per_m": dice.within(500.0, 4000.0), "free_length_m": dice.within(0.0, 0.2)}),
        json!({"joint": "j3", "stiffness_nm_per_rad": dice.within(5.0, 30.0), "free_deg": -40}),
    ];
    match dice.below(3) {
        0 => springs.push(json!({"name": "gas", "from": {"at": "base", "point_m": [0.2, 0, 0.1]},
            "to": {"at": "forearm", "point_m": [0.15, 0, -0.03]}, "force_n": -dice.within(50.0, 200.0)})),
        1 => springs.push(json!({"name": "hoist", "from": {"at": "world", "point_m": [0.6, 0, 2.5]},
            "to": {"at": "flange"}, "force_n": dice.within(20.0, 100.0)})),
        _ => {}
    }
    study["springs"] = json!(springs);
}

/// The sweep adds springs to partial arms, the exact search to its bounds, and the full model to whole arms. They list the
/// same designs, and the fast objectives are the full ones.
#[test]
fn searches_agree_with_springs() {
    let studies: u64 =
        std::env::var("ARMWRIGHT_SPRING_STUDIES").ok().and_then(|n| n.parse().ok()).unwrap_or(2);
    let (catalogs, mut listed, mut moved) = (Catalogs::builtin(), 0, 0);
    for seed in 1..=studies {
        let mut text = random_study(seed);
        let alone = read_study(&text, &catalogs);
        add_springs(&mut text, seed);
        let study = read_study(&text, &catalogs);
        let (front, found) = both_searches(&study, &catalogs, seed % 4 == 3, &format!("seed {seed}: {text}"));
        let problem = ArmProblem::new(&study.space, &catalogs);
        let without = ArmProblem::new(&alone.space, &catalogs);
        for design in front.iter().take(20) {
            let full = evaluate(&problem, design.number).expect("a design of the front").objectives;
            let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
            assert!(close(full.tip_deflection_m, design.objectives.tip_deflection_m), "seed {seed}");
            assert!(close(full.mass_kg, design.objectives.mass_kg), "seed {seed}");
            assert!(close(full.lowest_mode_hz, design.objectives.lowest_mode_hz), "seed {seed}");
            moved += usize::from(
                evaluate(&without, design.number)
                    .is_none_or(|other| !close(other.objectives.tip_deflection_m, full.tip_deflection_m)),
            );
        }
        listed += found;
    }
    println!("{studies} studies, {listed} designs, the same in both");
    assert!(listed > 0 && moved > 0, "{listed} designs, {moved} of them moved by springs");
}

fn lever_study(springs: Value, drive: bool) -> Value {
    let mut joint = json!({"type": "joint", "name": "j", "axis": [0, 1, 0], "bearing": null});
    if drive {
        joint["drive"] = json!("first_fit");
        joint["drives"] = json!({"gear_series": ["CSG"], "ratios": [100]});
    } else {
        joint["stiffness_nm_per_rad"] = json!(1e5);
    }
    json!({"name": "lever", "chain": [joint,
        {"type": "link", "name": "arm", "vector_m": [1.0, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "rectangular_tube", "width_mm": 60, "height_mm": 80, "wall_mm": 3}]}}],
        "payload": {"mass_kg": 20}, "poses": [{"pose_deg": [0]}, {"pose_deg": [0], "payload": {"mass_kg": 0}, "judged": false}],
        "springs": springs})
}

/// A weight of twice the payload that pulls up at mid-length takes the moment from the root, and the tube is loaded most where
/// it pulls: `M = P l/2 + w l²/8`. The root alone would have a quarter of the stress.
#[test]
fn stress_is_checked_where_a_spring_pulls() {
    let catalogs = Catalogs::builtin();
    let hoist = json!([{"from": {"at": "world", "point_m": [0.5, 0, 1e4]}, "to": {"at": "arm", "point_m": [0.5, 0, 0]},
        "force_n": 2.0 * 20.0 * 9.81}]);
    let mut text = lever_study(hoist, false);
    text["poses"] = json!([{"pose_deg": [0]}]);
    let study = read_study(&text, &catalogs);
    let problem = ArmProblem::new(&study.space, &catalogs);
    let arm = problem.walk(&[0], |_, _| {}).expect("a design");
    let (width, height, wall): (f64, f64, f64) = (0.06, 0.08, 0.003);
    let hollow = |f: fn(f64, f64) -> f64| f(width, height) - f(width - 2.0 * wall, height - 2.0 * wall);
    let (area, second_moment) = (hollow(|b, h| b * h), hollow(|b, h| b * h * h * h / 12.0));
    let row = catalogs.materials.iter().find(|m| m.name == "Aluminium 6061-T6").expect("in the catalog");
    let weight_n_per_m = row.density_kg_m3 * area * 9.81;
    let moment_nm = 20.0 * 9.81 * 0.5 + weight_n_per_m / 8.0;
    let motion = &study.space.motion;
    let peak = 1.0 + motion.tip_speed_m_s / motion.ramp_time_s / 9.81;
    let expected = row.strength_pa.expect("known") / (moment_nm * height / 2.0 / second_moment * peak);
    let found = problem.stress_safety_factor(&arm).expect("a known strength");
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
}

/// A drive holds what the spring leaves in each sizing pose. With a spring for half of the load both poses are alike; one for
/// the whole load makes the empty arm the worst.
#[test]
fn a_drive_is_sized_for_what_the_spring_leaves() {
    let catalogs = Catalogs::builtin();
    let static_nm = |springs: Value| {
        let study = read_study(&lever_study(springs, true), &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let mut found = 0.0;
        let partial = problem.walk(&[0], |slot, partial| {
            if problem.piece_of_slot(slot) == 0 {
                found = problem.demand_at(partial, slot).static_torque_nm;
            }
        });
        partial.unwrap_or_else(|slot| panic!("fails at {slot}"));
        found
    };
    let hoist = |force_n: f64| {
        json!([{"from": {"at": "world", "point_m": [1, 0, 1e6]}, "to": {"at": "arm", "point_m": [1, 0, 0]},
            "force_n": force_n}])
    };
    let tube_nm = static_nm(json!([])) - 20.0 * 9.81;
    assert!(tube_nm > 0.0);
    let half_n = 10.0 * 9.81 + tube_nm;
    assert!((static_nm(hoist(half_n)) - 10.0 * 9.81).abs() < 1e-6);
    assert!(
        (static_nm(hoist(20.0 * 9.81 + tube_nm)) - 20.0 * 9.81).abs() < 1e-6,
        "the empty arm is the worst"
    );
}

/// A counterweight behind the joint is the body that it stands for.
#[test]
fn a_counterweight_is_a_body_of_the_element_that_carries_it() {
    let arm = |extra: (&str, Value), bodies: Value| {
        let mut arm = json!({"chain": [
            {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
            {"type": "link", "name": "lever", "vector_m": [0.9, 0, 0], "bodies": bodies}]});
        arm[extra.0] = extra.1;
        read(&arm)
    };
    let weights = json!([{"name": "lead", "at": "lever", "point_m": [-0.3, 0, 0], "mass_kg": 12}]);
    let body = json!([{"mass_kg": 12, "cg_m": [-0.3, 0, 0]}]);
    let (hung, stated) = (arm(("counterweights", weights), json!([])), arm(("effects", json!([])), body));
    assert_eq!(hung, stated);
    assert_eq!(hung.mass_kg(), 12.0);
}

#[test]
fn faults_of_springs_are_told_all_at_once() {
    let arm = json!({"chain": [
        {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
        {"type": "link", "name": "lever", "vector_m": [0.9, 0, 0]}],
      "springs": [
        {"from": {"at": "base"}, "to": {"at": "laver"}, "force_n": 3},
        {"from": {"at": "lever"}, "to": {"at": "lever", "point_m": [1, 0, 0]}, "force_n": 3},
        {"from": {"at": "base"}, "to": {"at": "lever"}, "stiffness_n_per_m": 30},
        {"from": {"at": "base"}, "to": {"at": "lever"}},
        {"joint": "lever", "stiffness_nm_per_rad": 3, "free_deg": 0}],
      "counterweights": [{"at": "nowhere", "point_m": [0, 0, 0], "mass_kg": 1}]});
    let document = Document::parse("arm.json", &arm.to_string()).expect("JSON");
    let faults = read_arm_document(document, &Catalogs::builtin()).expect_err("six faults").to_string();
    for part in [
        "no \"laver\"",
        "on one part",
        "without the other",
        "nothing of its force",
        "no joint",
        "no \"nowhere\"",
    ] {
        assert!(faults.contains(part), "{part}: {faults}");
    }
}

/// Cases that `analyze` and the worst poses use see the springs of the arm that a design is.
#[test]
fn the_arm_of_a_design_has_its_springs() {
    let catalogs = Catalogs::builtin();
    let mut text = random_study(1);
    add_springs(&mut text, 1);
    let study = read_study(&text, &catalogs);
    let problem = ArmProblem::new(&study.space, &catalogs);
    let design = (0..1000).find_map(|number| evaluate(&problem, number)).expect("a design");
    let options = armwright::space::design::options(problem.level_sizes(), design.number).expect("a design");
    let arm = problem.arm(&options).expect("it holds");
    assert_eq!(arm.springs, study.space.springs);
    let cases: Vec<LoadCase> = problem.load_cases();
    let deflection_m = |case: &LoadCase| {
        let chain = Chain::new(&arm.structure_in(case), case.links);
        chain.pose(case).statics().tip_displacement_m.norm()
    };
    let worst_m = cases.iter().map(deflection_m).fold(0.0, f64::max);
    assert!((worst_m / design.objectives.tip_deflection_m - 1.0).abs() < 1e-9);
}
