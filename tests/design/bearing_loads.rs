//! Loads on output bearings against closed forms, and what they decide.
//!
//! The arm: a waist turning about the vertical, a shoulder 0.3 m above it, one level tube and a payload at its end. Every
//! force and moment follows from three sums over the outboard masses: weight, first moment and moment of inertia.

use armwright::arm::Element;
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::sizing::{BearingDemand, BearingLoad};
use armwright::space::ArmProblem;
use armwright::study::{Study, read_study};
use serde_json::{Value, json};

const G_M_S2: f64 = 9.81;
const LENGTH_M: f64 = 0.8;
const HEIGHT_M: f64 = 0.3;
const PAYLOAD_KG: f64 = 10.0;
/// A box 0.1 x 0.1 x 0.005 m of steel.
const SIDE_M: f64 = 0.1;
const WALL_M: f64 = 0.005;
/// Structural steel S355 of the catalog.
const DENSITY_KG_M3: f64 = 7800.0;
/// 1 m/s within 0.2 s at 0.8 m.
const ACCELERATION_RAD_S2: f64 = 1.0 / 0.2 / LENGTH_M;
/// The tip's acceleration, which is that of a rail too.
const ACCELERATION_M_S2: f64 = 1.0 / 0.2;
const CARRIAGE_KG: f64 = 4.0;
/// What stays when the carriage travels.
const RAIL_KG: f64 = 7.0;

fn text(waist: Value) -> Value {
    let mut waist = waist;
    waist["type"] = json!("joint");
    waist["name"] = json!("waist");
    waist["axis"] = json!([0, 0, 1]);
    json!({
        "name": "bearings", "question": "what do they carry?",
        "chain": [
            waist,
            {"type": "link", "name": "column", "vector_m": [0, 0, HEIGHT_M]},
            {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "drive": "first_fit"},
            {"type": "link", "name": "arm", "vector_m": [LENGTH_M, 0, 0], "material": "Structural steel S355",
             "section": {"shape": "rectangular_tube", "width_m": SIDE_M, "height_m": SIDE_M, "wall_m": WALL_M}},
        ],
        "payload": {"mass_kg": PAYLOAD_KG},
        "poses": [{"name": "level", "pose_deg": [0, 0]}],
        "motion": {"tip_speed_m_s": 1.0, "ramp_time_s": 0.2},
    })
}

fn read(text: &Value, catalogs: &Catalogs) -> Study {
    read_study(Document::parse("bearings", &text.to_string()).expect("JSON"), catalogs)
        .unwrap_or_else(|fault| panic!("{fault}"))
}

fn study(waist: Value, catalogs: &Catalogs) -> Study {
    read(&text(waist), catalogs)
}

/// The arm with a rail along `axis` as the piece number `place` of its chain, base first. The carriage has a mass.
fn railed(axis: [f64; 3], place: usize, catalogs: &Catalogs) -> Study {
    let mut text = text(json!({"drive": "first_fit"}));
    let rail = json!({"type": "prismatic", "name": "rail", "axis": axis, "stiffness_n_per_m": 1e8, "mass_kg": CARRIAGE_KG,
        "fixed_mass_kg": RAIL_KG});
    text["chain"].as_array_mut().expect("a chain").insert(place, rail);
    text["poses"] = json!([{"name": "level", "pose": {"rail_mm": 0}}]);
    read(&text, catalogs)
}

/// The loads on the bearings of waist and shoulder, and the mass of everything outboard of the waist but the tube \[kg\]:
/// the shoulder's drive, and a rail if there is one.
fn demands(study: &Study, catalogs: &Catalogs) -> ([BearingDemand; 2], f64) {
    let problem = ArmProblem::new(&study.space, catalogs);
    let (mut out, mut masses_kg) = ([BearingDemand::default(); 2], [0.0; 2]);
    let sizes = vec![0; armwright::space::OutwardIn::level_sizes(&problem).len()];
    problem
        .walk(&sizes, |slot, outboard| {
            let joint = match study.space.pieces[problem.piece_of_slot(slot)].name() {
                "waist" => 0,
                "shoulder" => 1,
                _ => return,
            };
            out[joint] = problem.demand_at(outboard, slot).bearing;
            masses_kg[joint] = problem.mass_kg(outboard);
        })
        .expect("some drive holds");
    let tube_kg = tube().0;
    (out, masses_kg[0] - tube_kg)
}

/// Mass \[kg\] of the tube, and its inertia about an axis across it at its root \[kg m²\].
fn tube() -> (f64, f64) {
    let inner_m = SIDE_M - 2.0 * WALL_M;
    let mass_kg = DENSITY_KG_M3 * (SIDE_M.powi(2) - inner_m.powi(2)) * LENGTH_M;
    let second_moment_m4 = (SIDE_M.powi(4) - inner_m.powi(4)) / 12.0;
    (mass_kg, mass_kg * LENGTH_M.powi(2) / 3.0 + DENSITY_KG_M3 * second_moment_m4 * LENGTH_M)
}

fn assert_close(load: BearingLoad, [moment_nm, radial_n, axial_n]: [f64; 3], what: &str) {
    let close = |a: f64, b: f64| (a - b).abs() < 1e-9 * (1.0 + b.abs());
    let right = BearingLoad { moment_nm, radial_n, axial_n };
    assert!(
        close(load.moment_nm, moment_nm) && close(load.radial_n, radial_n) && close(load.axial_n, axial_n),
        "{what}: {load:?} but {right:?} by hand"
    );
}

#[test]
fn waist_and_shoulder_carry_what_the_closed_forms_say() {
    let catalogs = Catalogs::builtin();
    let study = study(json!({"drive": "first_fit"}), &catalogs);
    let ([waist, shoulder], drive_kg) = demands(&study, &catalogs);
    let (tube_kg, tube_kgm2) = tube();
    let mass_kg = tube_kg + PAYLOAD_KG;
    let first_kgm = tube_kg * LENGTH_M / 2.0 + PAYLOAD_KG * LENGTH_M;
    let inertia_kgm2 = tube_kgm2 + PAYLOAD_KG * LENGTH_M.powi(2);
    let (weight_n, torque_nm) = (mass_kg * G_M_S2, first_kgm * G_M_S2);

    // the shoulder: the weight lies across its axis, in the plane of the link, half a width beside the flange. Its own
    // ramp adds a force in that plane; the waist's ramp adds a force along the axis and a moment across it
    let lever_m = SIDE_M / 2.0;
    assert_close(shoulder.at_rest, [lever_m * weight_n, weight_n, 0.0], "shoulder at rest");
    for (load, times, what) in [(shoulder.running, 1.0, "running"), (shoulder.in_stop, 2.0, "in a stop")] {
        let alpha = times * ACCELERATION_RAD_S2;
        let radial_n = weight_n + alpha * first_kgm;
        let moment_nm = alpha * inertia_kgm2 + lever_m * radial_n;
        assert_close(load, [moment_nm, radial_n, alpha * first_kgm], &format!("shoulder {what}"));
    }

    // the waist: the shoulder's drive adds weight along the axis; the shoulder's ramp adds to the moment of the weight
    let axial_n = weight_n + drive_kg * G_M_S2;
    assert_close(waist.at_rest, [torque_nm, 0.0, axial_n], "waist at rest");
    for (load, times, what) in [(waist.running, 1.0, "running"), (waist.in_stop, 2.0, "in a stop")] {
        let alpha = times * ACCELERATION_RAD_S2;
        let by_shoulder_nm = torque_nm + alpha * inertia_kgm2;
        let by_waist_nm = torque_nm.hypot(alpha * first_kgm * HEIGHT_M);
        let right = [by_shoulder_nm.max(by_waist_nm), alpha * first_kgm, axial_n + alpha * first_kgm];
        assert_close(load, right, &format!("waist {what}"));
    }
}

#[test]
fn a_rail_that_ramps_or_stops_loads_the_bearings_on_it_and_below_it() {
    let catalogs = Catalogs::builtin();
    let (tube_kg, tube_kgm2) = tube();
    let mass_kg = tube_kg + PAYLOAD_KG;
    let first_kgm = tube_kg * LENGTH_M / 2.0 + PAYLOAD_KG * LENGTH_M;
    let inertia_kgm2 = tube_kgm2 + PAYLOAD_KG * LENGTH_M.powi(2);
    let lever_m = SIDE_M / 2.0;

    // the waist stands on a rail along the arm: everything outboard is pushed along x
    let ([waist, shoulder], drive_kg) = demands(&railed([1.0, 0.0, 0.0], 0, &catalogs), &catalogs);
    let axial_n = (mass_kg + drive_kg) * G_M_S2;
    for (load, times, what) in [(shoulder.running, 1.0, "running"), (shoulder.in_stop, 2.0, "in a stop")] {
        let (a, alpha) = (times * ACCELERATION_M_S2, times * ACCELERATION_RAD_S2);
        let on_rail_n = (mass_kg * G_M_S2).hypot(mass_kg * a);
        let radial_n = on_rail_n.max(mass_kg * G_M_S2 + alpha * first_kgm);
        // the moment is that of the waist's ramp, whose radial force is the weight
        let moment_nm = alpha * inertia_kgm2;
        let right = [moment_nm + lever_m * radial_n, radial_n, alpha * first_kgm];
        assert_close(load, right, &format!("shoulder on a rail, {what}"));
    }
    for (load, times, what) in [(waist.running, 1.0, "running"), (waist.in_stop, 2.0, "in a stop")] {
        let (a, alpha) = (times * ACCELERATION_M_S2, times * ACCELERATION_RAD_S2);
        let pushed_n = (mass_kg + drive_kg) * a;
        let torque_nm = first_kgm * G_M_S2;
        let moment_nm = torque_nm + (pushed_n * HEIGHT_M).max(alpha * inertia_kgm2);
        let right = [moment_nm, pushed_n.max(alpha * first_kgm), axial_n + alpha * first_kgm];
        assert_close(load, right, &format!("waist on a rail, {what}"));
    }

    // the shoulder stands on a vertical rail on the waist: its carriage and all of the arm are lifted
    let ([waist, shoulder], with_rail_kg) = demands(&railed([0.0, 0.0, 1.0], 1, &catalogs), &catalogs);
    let lifted_kg = mass_kg + with_rail_kg - RAIL_KG;
    let at_rest_n = (lifted_kg + RAIL_KG) * G_M_S2;
    for (load, times, what) in [(shoulder.running, 1.0, "running"), (shoulder.in_stop, 2.0, "in a stop")] {
        let (a, alpha) = (times * ACCELERATION_M_S2, times * ACCELERATION_RAD_S2);
        let radial_n = mass_kg * G_M_S2 + (mass_kg * a).max(alpha * first_kgm);
        let right = [alpha * inertia_kgm2 + lever_m * radial_n, radial_n, alpha * first_kgm];
        assert_close(load, right, &format!("shoulder on a lift, {what}"));
    }
    for (load, times, what) in [(waist.running, 1.0, "running"), (waist.in_stop, 2.0, "in a stop")] {
        let (a, alpha) = (times * ACCELERATION_M_S2, times * ACCELERATION_RAD_S2);
        let by_lift_nm = first_kgm * (G_M_S2 + a);
        let by_shoulder_nm = first_kgm * G_M_S2 + alpha * inertia_kgm2;
        let axial_n = at_rest_n + (lifted_kg * a).max(alpha * first_kgm);
        let right = [by_lift_nm.max(by_shoulder_nm), alpha * first_kgm, axial_n];
        assert_close(load, right, &format!("waist below a lift, {what}"));
    }
}

#[test]
fn the_moment_of_the_shoulder_decides_the_gear_of_the_waist() {
    let catalogs = Catalogs::builtin();
    let gear = |waist: Value| {
        let study = study(waist, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let arm = problem.arm(&[]).expect("some drive holds");
        match &arm.chain[0] {
            Element::Joint(joint) => {
                catalogs.gear(joint.gear.as_deref().expect("sized")).expect("known").clone()
            }
            other => panic!("{}", other.name()),
        }
    };
    let ([waist, _], _) = demands(&study(json!({"drive": "first_fit"}), &catalogs), &catalogs);
    let with_bearing = gear(json!({"drive": "first_fit"}));
    let rigid = gear(json!({"drive": "first_fit", "bearing": null}));
    let permissible_nm = |gear: &armwright::catalog::Gear| gear.permissible_tilting_moment_nm.expect("known");
    assert!(permissible_nm(&rigid) < waist.running.moment_nm, "torque alone takes {}", rigid.id);
    assert!(permissible_nm(&with_bearing) >= waist.running.moment_nm, "{}", with_bearing.id);
    assert!(with_bearing.mass_housed_unit_kg > rigid.mass_housed_unit_kg);
}

#[test]
fn a_component_set_must_say_what_its_joint_turns_on() {
    let catalogs = Catalogs::builtin();
    let with = |bearing: Option<Value>| {
        let mut waist = json!({"drive": "first_fit", "drives": {"gear_mass": "component_set"},
            "type": "joint", "name": "waist", "axis": [0, 0, 1]});
        if let Some(bearing) = bearing {
            waist["bearing"] = bearing;
        }
        let text = json!({"name": "set", "question": "?", "poses": [{"name": "p", "pose_deg": [0]}],
            "chain": [waist, {"type": "link", "name": "l", "vector_m": [0.5, 0, 0]}], "payload": {"mass_kg": 5}});
        read_study(Document::parse("set", &text.to_string()).expect("JSON"), &catalogs)
    };
    let fault = with(None).expect_err("nothing is stated").to_string();
    assert!(fault.contains("no output bearing") && fault.contains("\"bearing\""), "{fault}");
    let mass_kg = |bearing: Value| {
        let study = with(Some(bearing)).unwrap_or_else(|fault| panic!("{fault}"));
        let problem = ArmProblem::new(&study.space, &catalogs);
        problem.arm(&[]).expect("some drive holds").mass_kg()
    };
    let rigid_kg = mass_kg(Value::Null);
    let gear = catalogs.gear("HFUC-32-100").expect("in the catalog");
    let bearing_kg = gear.mass_housed_unit_kg.unwrap() - gear.mass_component_set_kg.unwrap();
    assert!(
        (mass_kg(json!("HFUC-32-100")) - rigid_kg - bearing_kg).abs() < 1e-9,
        "a part weighs what it weighs"
    );
    let numbers = json!({"tilt_stiffness_nm_per_rad": 2e5, "permissible_moment_nm": 500.0, "mass_kg": 0.7});
    assert!((mass_kg(numbers) - rigid_kg - 0.7).abs() < 1e-9);
}
