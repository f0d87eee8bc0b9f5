//! Drives that a study gives by name, and what a joint holds while another one moves.

use crate::exact_support::read;
use armwright::catalog::Catalogs;
use armwright::sizing::JointSizingRow;
use armwright::study::{capacity_of, sizing_of};
use serde_json::{Value, json};

/// A shoulder with the payload at the end of a massless link of 0.5 m, slow enough for these parts.
fn one_joint(joint: Value) -> Value {
    let mut shoulder = json!({"type": "joint", "name": "s", "axis": [0, 1, 0], "extras": "none"});
    for (key, value) in joint.as_object().expect("an object") {
        shoulder[key] = value.clone();
    }
    json!({"name": "given", "chain": [shoulder, {"type": "link", "name": "l", "vector_m": [0.5, 0, 0], "mass_kg": 0}],
        "payload": {"mass_kg": 8}, "poses": [{"pose_deg": [0]}],
        "motion": {"tip_speed_m_s": 0.5, "ramp_time_s": 0.3, "life_h": 1000}})
}

fn row(study: &Value, catalogs: &Catalogs) -> JointSizingRow {
    let study = read(study, catalogs);
    let sizing = sizing_of(&study, None, catalogs).expect("the study has a design");
    sizing.rows.into_iter().next().expect("one joint with a drive")
}

#[test]
fn a_drive_that_is_given_by_name_limits_the_payload_as_the_same_drive_that_is_chosen() {
    let catalogs = Catalogs::builtin();
    let given = one_joint(json!({"gear": "CSG-25-100", "motor": "ILM70x18"}));
    let sized = one_joint(
        json!({"drive": "first_fit", "drives": {"gears": ["CSG-25-100"], "motor_models": ["ILM70x18"]}}),
    );
    let [given, sized] = [given, sized].map(|study| {
        let most = capacity_of(&read(&study, &catalogs), None, &catalogs).expect("a capacity").window.most;
        (most.payload_kg, most.check)
    });
    assert!(given.0.is_finite() && (given.0 / sized.0 - 1.0).abs() < 1e-9, "{given:?}, chosen {sized:?}");
    assert_eq!(given.1, sized.1);
}

/// A vertical axis has no torque at rest, and what the load tilts is its bearing: no slot of an effect is judged as a drive.
#[test]
fn a_given_drive_of_a_vertical_axis_is_judged_by_what_turns_it() {
    let catalogs = Catalogs::builtin();
    let upright = |joint: Value| {
        let mut study = one_joint(joint);
        study["chain"][0]["axis"] = json!([0, 0, 1]);
        study["effects"] =
            json!([{"effect": "base_compliance", "at": "base", "parameters": {"stiffness_nm_per_rad": 1e6}}]);
        let found = capacity_of(&read(&study, &catalogs), None, &catalogs).expect("a capacity");
        assert!(found.largest_speed.is_some(), "{found:?}");
        (found.window.most.payload_kg, found.window.most.check)
    };
    let given = upright(json!({"gear": "CSG-25-100", "motor": "ILM70x18"}));
    let sized = upright(
        json!({"drive": "first_fit", "drives": {"gears": ["CSG-25-100"], "motor_models": ["ILM70x18"]}}),
    );
    assert!((given.0 / sized.0 - 1.0).abs() < 1e-9, "{given:?}, chosen {sized:?}");
    assert_eq!(given.1, sized.1);
}

#[test]
fn a_given_drive_that_is_too_weak_for_the_payload_holds_a_smaller_one() {
    let catalogs = Catalogs::builtin();
    let payload_kg = |stated_kg: f64| {
        let mut study = one_joint(json!({"gear": "CSG-25-100", "motor": "ILM70x18"}));
        study["payload"]["mass_kg"] = json!(stated_kg);
        capacity_of(&read(&study, &catalogs), None, &catalogs).expect("a capacity").window.most.payload_kg
    };
    let held_kg = payload_kg(8.0);
    assert!(
        (payload_kg(3.0 * held_kg) / held_kg - 1.0).abs() < 1e-9,
        "{} {held_kg}",
        payload_kg(3.0 * held_kg)
    );
}

/// A stage behind the gear divides torque and multiplies speed at the gear. Figures by hand: a stage of 2 with the
/// efficiency 0.9, a static torque of 8 · 9.81 · 0.5 N m.
#[test]
fn a_gear_at_the_motor_sees_the_torque_and_the_speed_before_its_stage() {
    let catalogs = Catalogs::builtin();
    let stage = json!([{"ratio": 2, "efficiency": 0.9, "inertia_kgm2": 1e-3, "mass_kg": 0.3}]);
    let with_stage = row(
        &one_joint(
            json!({"gear": "CSG-25-100", "motor": "ILM70x18", "motor_at": "base", "gear_at": "motor", "transmission": stage}),
        ),
        &catalogs,
    );
    let direct = row(&one_joint(json!({"gear": "CSG-25-100", "motor": "ILM70x18"})), &catalogs);
    let near = |what: &str, value: f64, expected: f64| {
        assert!((value / expected - 1.0).abs() < 1e-9, "{what}: {value}, expected {expected}");
    };
    near("motor speed", with_stage.motor_speed_rpm, 2.0 * direct.motor_speed_rpm);
    near("static torque", with_stage.static_torque_nm, 8.0 * 9.81 * 0.5 / 1.8);
    // the inertia of the stage sits at its input, which accelerates twice as fast as the joint: ω / t_a · 2
    let own_nm = 1e-3 * 2.0 * (0.5 / 0.5 / 0.3);
    near("linear torque", with_stage.linear_torque_nm, 8.0 * 0.25 * (1.0 / 0.3) / 1.8 + own_nm);
    near(
        "rotary torque",
        with_stage.rotary_torque_motor_nm.expect("known"),
        2.0 * direct.rotary_torque_motor_nm.expect("known"),
    );
    // life: L (T_rated / T_mean)³ (n_rated / n_mean)
    let ratio = (direct.mean_torque_nm / with_stage.mean_torque_nm).powi(3) / 2.0;
    near("life", with_stage.life_h.expect("known") / direct.life_h.expect("known"), ratio);
    assert!(
        with_stage.mean_torque_nm > direct.mean_torque_nm / 1.8,
        "the stage's own inertia counts in the mean"
    );
}

#[test]
fn an_actuator_that_is_named_as_the_gear_is_checked_with_its_own_motor() {
    let catalogs = Catalogs::builtin();
    let actuators = catalogs.gears.iter().filter(|gear| gear.kind == armwright::catalog::GearKind::Actuator);
    let id = actuators.map(|gear| gear.id.clone()).next().expect("an actuator of the catalog");
    let named = |joint: Value| {
        let mut study = one_joint(joint);
        study["chain"][0]["mass_kg"] = json!(3);
        study["chain"][0]["stiffness_nm_per_rad"] = json!(2e4);
        row(&study, &catalogs)
    };
    let (alone, twice) = (named(json!({"gear": id})), named(json!({"gear": id, "motor": id})));
    assert_eq!(alone, twice);
    assert!(!alone.checks.is_empty());
}

/// Two vertical axes, the payload m at r beyond the second, which is R beyond the first. While the first ramps by α,
/// the second must hold m r (R + r) α, and twice as much in a stop.
#[test]
fn what_a_joint_holds_while_another_one_ramps_is_said() {
    let catalogs = Catalogs::builtin();
    let study = json!({"name": "scara", "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 2e5, "mass_kg": 5},
            {"type": "link", "name": "l", "vector_m": [1, 0, 0], "mass_kg": 3},
            {"type": "joint", "name": "w", "axis": [0, 0, 1], "drive": "first_fit", "extras": "none",
                "drives": {"gear_series": ["CSG"], "motors": ["electric"]}},
            {"type": "link", "name": "m", "vector_m": [0.1, 0, 0], "mass_kg": 0}],
        "payload": {"mass_kg": 25}, "motion": {"tip_speed_m_s": 2, "ramp_time_s": 0.2}, "poses": [{"pose_deg": [0, 0]}]});
    let said = |study: &Value| {
        let study = read(study, &catalogs);
        sizing_of(&study, None, &catalogs).expect("a design").remarks.join("\n")
    };
    let held_nm: f64 = 25.0 * 0.1 * 1.1 * (2.0 / 1.1 / 0.2);
    let words =
        format!("w must hold {held_nm:.1} N m while j1 ramps and {:.1} N m while j1 stops", 2.0 * held_nm);
    let text = said(&study);
    assert!(text.contains(&words), "{words} is not in\n{text}");
    assert!(text.contains("are too much for some of them"), "{text}");
    // on a rail across the arm, whose ramp is 10 m/s², the wrist holds m r a
    let mut railed = study.clone();
    railed["chain"][0] = json!({"type": "prismatic", "name": "rail", "axis": [0, 1, 0], "stiffness_n_per_m": 1e7, "mass_kg": 5});
    railed["poses"] = json!([{"pose": {"rail_mm": 0, "w_deg": 0}}]);
    let text = said(&railed);
    let held_nm: f64 = 25.0 * 0.1 * 10.0;
    assert!(text.contains(&format!("w must hold {held_nm:.1} N m while rail ramps")), "{text}");
    railed["chain"][0]["max_speed_m_s"] = json!(3);
    let text = said(&railed);
    let faster_nm = 25.0 * 0.1 * 3.0 / 0.2;
    assert!(text.contains(&format!("w must hold {faster_nm:.1} N m while rail ramps")), "{text}");
    // a wrist that turns faster needs a stronger drive, which holds the reaction too
    let mut strong = study.clone();
    strong["chain"][2]["drives"] = json!({"gears": ["CSG-40-100"], "motor_models": ["ILM85x26"]});
    strong["chain"][2]["max_speed_rad_s"] = json!(2);
    let text = said(&strong);
    assert!(
        text.contains(
            "withstand the ramps and stops of the other joints in the sizing cases (smallest margin: "
        ),
        "{text}"
    );
    // a stage of 20 behind the gear leaves the gear a twentieth of the torque, and the joint the whole
    let mut staged = study.clone();
    for (key, value) in [
        ("gear", json!("CSG-25-100")),
        ("motor", json!("ILM70x18")),
        ("gear_at", json!("motor")),
        ("motor_at", json!("base")),
        ("transmission", json!([{"ratio": 20}])),
    ] {
        staged["chain"][2][key] = value;
    }
    let wrist = staged["chain"][2].as_object_mut().expect("a joint");
    ["drive", "drives"].iter().for_each(|key| drop(wrist.remove(*key)));
    let text = said(&staged);
    assert!(text.contains("withstand the ramps and stops of the other joints"), "{text}");
    // the mass matrix has no term of a vertical axis and of a pitch whose mass lies in its vertical plane
    let mut pitch = study;
    pitch["chain"][2]["axis"] = json!([0, 1, 0]);
    let text = said(&pitch);
    assert!(!text.contains("Drives are sized for the motion"), "{text}");
}

#[test]
fn a_stop_that_is_gentler_than_the_ramps_does_not_weaken_the_checks() {
    let catalogs = Catalogs::builtin();
    let mut study = one_joint(json!({"gear": "CSG-25-100", "motor": "ILM70x18"}));
    study["motion"]["emergency_deceleration_m_s2"] = json!(0.1);
    let row = row(&study, &catalogs);
    assert!((row.stop_torque_nm - (row.static_torque_nm + row.linear_torque_nm)).abs() < 1e-9, "{row:?}");
    // the stop takes as long as it is stated, so the gear bears fewer of them
    let stops = |deceleration_m_s2: f64| {
        study["motion"]["emergency_deceleration_m_s2"] = json!(deceleration_m_s2);
        self::row(&study, &catalogs).emergency_stops_allowed.expect("a gear with a rule")
    };
    let [gentle, gentler] = [0.2, 0.1].map(stops);
    assert!((gentle / gentler - 2.0).abs() < 0.02, "{gentle} {gentler}");
}
