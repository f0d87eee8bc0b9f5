//! Motors that do not sit at their joints: closed forms of belt-driven arms, random arms against the work of their
//! weights, and studies that size drives behind a stage or with their motors elsewhere. [`add_stages`] puts stages into the
//! random studies of other tests.

use crate::dice::Dice;
use crate::exact_support::{both_searches, read};
use armwright::arm::{Arm, JointModel, LinkModel, Payload, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use armwright::space::{ArmProblem, OutwardIn, evaluate};
use armwright::study::read_study;
use nalgebra::{DMatrix, Rotation3, SymmetricEigen, Unit, Vector3};
use serde_json::{Value, json};

const G: f64 = 9.81;

/// Puts a stage before the gear of every drive of a random study that is sized.
pub fn add_stages(study: &mut Value, seed: u64) {
    let dice = &mut Dice(seed.wrapping_mul(0x2545_F491_4F6C_DD1D) ^ 0x57A6E);
    for piece in study["chain"].as_array_mut().expect("a chain") {
        if piece.get("drive").is_some() {
            piece["transmission"] = json!([{"ratio": dice.within(0.7, 1.6), "efficiency": dice.within(0.8, 1.0),
                "inertia_kgm2": dice.within(0.0, 1e-4), "stiffness_nm_per_rad": dice.within(50.0, 900.0),
                "mass_kg": dice.within(0.0, 1.0)}]);
        }
    }
}

fn arm_of(chain: &Value) -> Result<Arm, String> {
    let text = json!({"gravity_m_s2": G, "chain": chain}).to_string();
    let document = Document::parse("arm.json", &text).expect("JSON");
    read_arm_document(document, &Catalogs::builtin()).map_err(|faults| faults.to_string())
}

fn chain_of(arm: &Arm) -> Chain {
    Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full)
}

/// Two links of 0.5 and 0.3 m; the motor of the second joint stands at the base and drives it by a belt of ratio 1.
fn belt_arm(more: Value) -> Value {
    let mut elbow = json!({"type": "joint", "name": "elbow", "axis": [0, 1, 0], "stiffness_nm_per_rad": null,
        "motor_at": "base", "motor_mass_kg": 7, "gear_at": "motor",
        "transmission": [{"ratio": 1, "stiffness_nm_per_rad": 2e4, "mass_kg": 0}]});
    for (key, value) in more.as_object().expect("an object") {
        elbow[key] = value.clone();
    }
    json!([
        {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
        {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0]}, elbow,
        {"type": "link", "name": "lower", "vector_m": [0.3, 0, 0]}])
}

#[test]
fn a_belt_from_the_base_holds_the_forearm_level_and_takes_its_moment_past_the_shoulder() {
    let arm = arm_of(&belt_arm(json!({}))).expect("sound");
    assert!((arm.mass_kg() - 7.0).abs() < 1e-12, "the motor counts");
    let chain = chain_of(&arm);
    let payload = Payload { mass_kg: 6.0, ..Payload::default() };
    let (weight_n, a, b, ka, kb) = (6.0 * G, 0.5, 0.3, 1e4, 2e4);
    let posed = chain.pose_rad(&[0.0, 0.0], &payload, Vector3::zeros());
    let statics = posed.statics();
    // the reaction of the belt is at the base: the shoulder feels the weight at the elbow alone
    assert!((statics.joint_torques_nm[0].1 - weight_n * a).abs() < 1e-9);
    assert!((statics.joint_torques_nm[1].1 - weight_n * b).abs() < 1e-9);
    let sag_m = weight_n * (a * a / ka + b * b / kb);
    assert!((statics.tip_displacement_m.z + sag_m).abs() < 1e-12);
    // with the elbow at a right angle both links move the payload at right angles: two inertias on two springs
    let bent = chain.pose_rad(&[0.0, 90f64.to_radians()], &payload, Vector3::zeros());
    let modes = bent.modes(&bent.statics(), 3);
    let hz = |k: f64, lever_m: f64| (k / (6.0 * lever_m * lever_m)).sqrt() / std::f64::consts::TAU;
    assert!((modes[0].frequency_hz / hz(ka, a) - 1.0).abs() < 1e-9, "{}", modes[0].frequency_hz);
    assert!((modes[1].frequency_hz / hz(kb, b) - 1.0).abs() < 1e-9, "{}", modes[1].frequency_hz);
    // what is written reads back the same
    let again = read_arm_document(
        Document::parse("again.json", &arm.to_json().to_string()).expect("JSON"),
        &Catalogs::builtin(),
    );
    assert_eq!(again.expect("sound"), arm);
}

#[test]
fn a_gear_at_the_joint_divides_what_the_belt_does_and_a_reversed_axis_turns_its_sign() {
    let factor = |more: Value, axis: [f64; 3]| {
        let mut chain = belt_arm(more);
        chain[0]["axis"] = json!(axis);
        arm_of(&chain).expect("sound").joints().nth(1).expect("the elbow").turns_with[0].1
    };
    let geared = json!({"gear_at": "joint", "gear_ratio": 50, "transmission": [{"ratio": 2}]});
    assert_eq!(factor(json!({}), [0.0, 1.0, 0.0]), -1.0);
    assert_eq!(factor(geared.clone(), [0.0, 1.0, 0.0]), -0.01);
    assert_eq!(factor(geared, [0.0, -1.0, 0.0]), 0.01);
    assert_eq!(factor(json!({"turns_with": {"shoulder": 0.25}}), [1.0, 0.0, 0.0]), 0.25);
    // springs in series: the belt before the gear counts by the square of its ratio
    let chain = belt_arm(json!({"stiffness_nm_per_rad": 5e4, "gear_at": "joint", "gear_ratio": 10,
        "transmission": [{"ratio": 3, "stiffness_nm_per_rad": 40}, {"ratio": 2, "stiffness_nm_per_rad": 100}]}));
    let elbow = arm_of(&chain).expect("sound").joints().nth(1).expect("the elbow").curve;
    let by_hand = 1.0 / 5e4 + 1.0 / (100.0 * 100.0) + 1.0 / (40.0 * 400.0);
    assert!((elbow.tangent_compliance_rad_per_nm(1.0) / by_hand - 1.0).abs() < 1e-12);
    // two thirds of a three-segment gear at the motor, behind a belt of ratio 1.5
    let windup =
        json!({"k1_nm_per_rad": 1e3, "k2_nm_per_rad": 2e3, "k3_nm_per_rad": 4e3, "t1_nm": 10, "t2_nm": 20});
    let mut chain = belt_arm(json!({"windup": windup, "transmission": [{"ratio": 1.5}]}));
    chain[2].as_object_mut().expect("a joint").remove("stiffness_nm_per_rad");
    let curve = arm_of(&chain).expect("sound").joints().nth(1).expect("the elbow").curve;
    let at_gear = 10.0 / 1e3 + 10.0 / 2e3 + 4.0 / 4e3;
    assert!((curve.angle_rad(36.0) - at_gear / 1.5).abs() < 1e-15);
}

#[test]
fn every_fault_of_a_transmission_says_what_to_write() {
    let says = |more: Value, words: &str| {
        let faults = arm_of(&belt_arm(more.clone())).expect_err("a fault");
        assert!(faults.contains(words), "{more}: {faults}");
    };
    says(json!({"motor_at": "lower"}), "choose base, or one of: shoulder, upper");
    says(json!({"transmission": []}), "give a stage for every link along which a belt runs");
    says(json!({"axis": [0, 0, 1]}), "say in \"turns_with\"");
    says(json!({"turns_with": {"elbow": 1}}), "joints inboard: shoulder");
    says(json!({"gear_at": "hip"}), "choose one of: joint, motor");
    says(json!({"gear_at": "joint"}), "add \"gear_ratio\"");
    says(json!({"transmission": [{"ratio": 1, "efficiency": 1.2}]}), "more than the whole");
    says(json!({"coupled": {"shoulder": 1}}), "write it at the joint that drives it");
    let mut chain = belt_arm(json!({}));
    chain[2].as_object_mut().expect("a joint").remove("motor_at");
    assert!(arm_of(&chain).expect_err("a fault").contains("has no \"motor_at\" beside it"));
    chain = belt_arm(json!({}));
    let rail = json!({"type": "prismatic", "name": "rail", "axis": [1, 0, 0], "stiffness_n_per_m": null});
    chain.as_array_mut().expect("a chain").insert(1, rail);
    assert!(arm_of(&chain).expect_err("a fault").contains("let the motor travel along"));
}

/// Random arms of four joints: weights hang at points, some joints are driven from beyond others. The torque of every drive
/// is the work of the weights per twist of that drive, by differences of the positions; the modes follow from the same
/// derivatives. Differences of 1e-6 rad leave 1e-8 of a torque.
#[test]
fn drives_hold_the_work_of_the_weights_on_what_they_move() {
    let dice = &mut Dice(5);
    for round in 0..30 {
        let axes: Vec<Vector3<f64>> =
            (0..4).map(|_| Vector3::from_fn(|_, _| dice.within(-1.0, 1.0)).normalize()).collect();
        let vectors: Vec<Vector3<f64>> =
            (0..4).map(|_| Vector3::from_fn(|_, _| dice.within(-0.4, 0.4))).collect();
        let masses: Vec<f64> = (0..4).map(|_| dice.within(1.0, 5.0)).collect();
        let k: Vec<f64> = (0..4).map(|_| dice.within(1e4, 5e4)).collect();
        // the third joint turns with the first two, the fourth with the third
        let turns =
            [(2, 0, dice.within(-1.0, 1.0)), (2, 1, dice.within(-1.0, 1.0)), (3, 2, dice.within(-1.0, 1.0))];
        let pose: Vec<f64> = (0..4).map(|_| dice.within(-2.0, 2.0)).collect();
        let mut chain = Vec::new();
        for i in 0..4 {
            let with: serde_json::Map<String, Value> =
                turns.iter().filter(|t| t.0 == i).map(|t| (format!("j{}", t.1), json!(t.2))).collect();
            chain.push(json!({"type": "joint", "name": format!("j{i}"), "axis": axes[i].as_slice(),
                "stiffness_nm_per_rad": k[i], "turns_with": with}));
            chain.push(json!({"type": "link", "name": format!("l{i}"), "vector_m": vectors[i].as_slice(),
                "bodies": [{"mass_kg": masses[i], "cg_m": vectors[i].as_slice()}]}));
        }
        // places of the four masses when every drive twists by `e`
        let places = |e: &[f64; 4]| {
            let mut q = [0.0; 4];
            for i in 0..4 {
                q[i] = e[i] + turns.iter().filter(|t| t.0 == i).map(|t| t.2 * q[t.1]).sum::<f64>();
            }
            let (mut at, mut turn, mut out) = (Vector3::zeros(), Rotation3::identity(), Vec::new());
            for i in 0..4 {
                turn *= Rotation3::from_axis_angle(&Unit::new_normalize(axes[i]), pose[i] + q[i]);
                at += turn * vectors[i];
                out.push(at);
            }
            out
        };
        let rate = |i: usize| {
            let step = 1e-6;
            let moved = |sign: f64| places(&std::array::from_fn(|j| if i == j { sign * step } else { 0.0 }));
            let (to, from) = (moved(1.0), moved(-1.0));
            to.iter().zip(from).map(|(a, b)| (a - b) / (2.0 * step)).collect::<Vec<_>>()
        };
        let rates: Vec<Vec<Vector3<f64>>> = (0..4).map(rate).collect();
        let chain = chain_of(&arm_of(&json!(chain)).expect("sound"));
        let posed = chain.pose_rad(&pose, &Payload::default(), Vector3::zeros());
        let statics = posed.statics();
        for (rates, (name, torque)) in rates.iter().zip(&statics.joint_torques_nm) {
            let work: f64 = rates.iter().zip(&masses).map(|(rate, m)| -m * G * rate.z).sum();
            assert!((torque - work).abs() < 1e-6, "round {round}, {name}: {torque} and {work}");
        }
        let tip: Vector3<f64> = (0..4).map(|i| rates[i][3] * statics.joint_torques_nm[i].1 / k[i]).sum();
        assert!((tip - statics.tip_displacement_m).norm() < 1e-9, "round {round}");
        let flexibility = DMatrix::from_fn(4, 4, |i, j| {
            let both = rates[i].iter().zip(&rates[j]).zip(&masses);
            both.map(|((a, b), m)| m * a.dot(b)).sum::<f64>() / (k[i] * k[j]).sqrt()
        });
        let largest = SymmetricEigen::new(flexibility).eigenvalues.max();
        let hz = posed.lowest_frequency_hz(&statics);
        assert!((hz * std::f64::consts::TAU * largest.sqrt() - 1.0).abs() < 1e-7, "round {round}: {hz}");
    }
}

/// A study of a shoulder and an elbow whose drive is sized.
fn study(elbow: Value) -> Value {
    let mut joint = json!({"type": "joint", "name": "elbow", "axis": [0, 1, 0], "drive": "all_fits",
        "drives": {"gear_series": ["CSG"], "ratios": [100], "motor_models": ["ILM50x14", "ILM70x18", "ILM85x26"]}});
    for (key, value) in elbow.as_object().expect("an object") {
        joint[key] = value.clone();
    }
    json!({"name": "two", "motion": {"tip_speed_m_s": 0.4, "ramp_time_s": 0.2}, "chain": [
        {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "drive": "first_fit",
         "drives": {"gear_series": ["CSG"], "ratios": [100]}},
        {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
         "sections": [{"shape": "round_tube", "diameter_mm": [80, 100], "wall_mm": [2, 4]}]}}, joint,
        {"type": "link", "name": "lower", "vector_m": [0.4, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
         "sections": [{"shape": "round_tube", "diameter_mm": [60, 80], "wall_mm": [2, 4]}]}}],
        "payload": {"mass_kg": 5}, "poses": [{"pose_deg": [0, 0]}, {"pose_deg": [-30, 60]}]})
}

fn belt() -> Value {
    json!({"ratio": 2, "efficiency": 0.95, "inertia_kgm2": 2e-5, "stiffness_nm_per_rad": 300, "mass_kg": 0.4})
}

#[test]
fn both_searches_agree_where_drives_have_a_belt_before_the_gear() {
    let catalogs = Catalogs::builtin();
    let text = study(json!({"transmission": [belt()]}));
    let (_, listed) = both_searches(&read(&text, &catalogs), &catalogs, false, "belt before the gear");
    assert!(listed > 3, "{listed}");
}

#[test]
fn a_belt_before_the_gear_counts_in_every_figure_of_the_drive() {
    let catalogs = Catalogs::builtin();
    let (with, without) = (study(json!({"transmission": [belt()]})), study(json!({})));
    let drive = |text: &Value, gear: &str, motor: &str| {
        let study = read(text, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let table = &problem.sized_joint(2).expect("the elbow").table;
        let found = (0..table.len()).find(|&i| {
            let drive = table.drive(i);
            drive.gear.id == gear && drive.motor.id == motor
        });
        let drive = table.drive(found.expect("the drive is legal"));
        let figures = (
            drive.ratio(),
            drive.efficiency().expect("known"),
            drive.input_inertia_kgm2().expect("known"),
            drive.motor_speed_rpm(table.motion()),
        );
        (
            figures,
            drive.gear.inertia_input_kgm2.expect("known"),
            drive.motor.rotor_inertia_kgm2.expect("known"),
        )
    };
    let ((ratio, efficiency, inertia, speed), gear_kgm2, rotor_kgm2) = drive(&with, "CSG-20-100", "ILM70x18");
    let ((bare_ratio, bare_efficiency, _, bare_speed), ..) = drive(&without, "CSG-20-100", "ILM70x18");
    assert_eq!((ratio, bare_ratio), (200.0, 100.0));
    assert!((efficiency - 0.95 * bare_efficiency).abs() < 1e-15);
    assert!((inertia - (rotor_kgm2 + 2e-5 + gear_kgm2 / 4.0)).abs() < 1e-18);
    assert!((speed - 2.0 * bare_speed).abs() < 1e-9);
}

#[test]
fn a_motor_at_the_base_weighs_there_in_the_sweep_as_in_the_arm() {
    let catalogs = Catalogs::builtin();
    let motor = json!({"motor_at": "base", "transmission": [belt()]});
    let spaces =
        [study(motor), study(json!({"motor_at": "shoulder", "transmission": [belt()]})), study(json!({}))];
    let mut lightest = Vec::new();
    for text in &spaces {
        let study = read(text, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let sizes: u32 = problem.level_sizes().iter().product();
        let designs = (0..u128::from(sizes)).filter_map(|number| evaluate(&problem, number));
        let mut best: Option<(f64, u128)> = None;
        for design in designs {
            let options =
                armwright::space::design::options(problem.level_sizes(), design.number).expect("in range");
            let arm = problem.arm(&options).expect("it holds");
            // the mass that the search adds up is that of the arm
            let walked = problem.walk(&options, |_, _| {}).expect("it holds");
            assert!((problem.mass_kg(&walked) - arm.mass_kg()).abs() < 1e-9);
            assert!((design.objectives.mass_kg - arm.mass_kg()).abs() < 1e-9);
            if best.is_none_or(|(mass, _)| design.objectives.mass_kg < mass) {
                best = Some((design.objectives.mass_kg, design.number));
            }
        }
        let options = armwright::space::design::options(problem.level_sizes(), best.expect("some hold").1);
        let options = options.expect("in range");
        let mut shoulder_nm = 0.0;
        problem
            .walk(&options, |slot, outboard| {
                if problem.piece_of_slot(slot) == 0 {
                    shoulder_nm = problem.demand_at(outboard, slot).static_torque_nm;
                }
            })
            .expect("it holds");
        // the demand on the shoulder is its torque in the arm, gravity and payload, reaction of the belt included
        let arm = problem.arm(&options).expect("it holds");
        let chain = Chain::new(&arm.structure(study.space.joints), study.space.links);
        let torque = |case: &armwright::arm::LoadCase| chain.pose(case).statics().joint_torques_nm[0].1.abs();
        let largest = problem.load_cases().iter().map(torque).fold(0.0, f64::max);
        assert!((shoulder_nm - largest).abs() < 1e-6 * largest, "{shoulder_nm} {largest}");
        lightest.push(shoulder_nm);
    }
    // the motor at the base does not load the shoulder
    assert!(lightest[0] < lightest[1] + 1e-9 && lightest[1] < lightest[2], "{lightest:?}");
}

#[test]
fn what_a_study_cannot_size_is_refused_by_name() {
    let catalogs = Catalogs::builtin();
    let says = |elbow: Value, words: &str| {
        let document = Document::parse("study.json", &study(elbow).to_string()).expect("JSON");
        let faults = read_study(document, &catalogs).expect_err("a fault").to_string();
        assert!(faults.contains(words), "{faults}");
    };
    says(
        json!({"motor_at": "base", "transmission": [belt()], "drives": {"gear_series": ["CSG"]}}),
        "ask for one of the \"ratios\"",
    );
    says(
        json!({"gear_at": "motor", "motor_at": "base", "transmission": [belt()]}),
        "stands beside \"drive\"",
    );
    says(json!({"motor_at": "upper", "motor_point_m": [0.2, 0, 0]}), "let it stand at the start of the tube");
    says(
        json!({"transmission": [belt()], "drives": {"actuators": "all"}}),
        "an actuator has its motor within",
    );
}

#[test]
fn a_study_with_a_belt_says_what_of_it_is_left_out() {
    let catalogs = Catalogs::builtin();
    let left_out = |text: Value| {
        let study = read(&text, &catalogs);
        study.remarks.iter().any(|words| words.contains("the pull and the strength of belts"))
    };
    assert!(left_out(study(json!({"transmission": [belt()]}))));
    assert!(!left_out(study(json!({}))));
}
