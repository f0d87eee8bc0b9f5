//! Rails whose drive is sized: the forces of a lift by hand, the arm of a design, and what is refused.

use crate::exact_support::read;
use armwright::arm::{Element, LoadCase};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use armwright::sizing::{all_hold, checks};
use armwright::space::{ArmProblem, OutwardIn, evaluate};
use armwright::study::{SearchMethod, SearchWish, read_study};
use serde_json::{Value, json};

/// A column that lifts a carriage of 20 kg with an arm of two possible tubes and a payload of 10 kg.
fn lift(rail: Value) -> Value {
    let mut column = json!({"type": "prismatic", "name": "lift", "axis": [0, 0, 1], "mass_kg": 20, "drive": "first_fit",
        "guide": {"pitch_nm_per_rad": 1e6}, "drives": {"motors": ["ac_servo", "brushless_servo"]}, "max_speed_m_s": 0.25,
        "screws": [
            {"name": "thin", "lead_mm": 10, "root_diameter_mm": 6, "length_mm": 1000, "dynamic_load_rating_n": 9000},
            {"name": "right", "lead_mm": 10, "root_diameter_mm": 17, "length_mm": 1000, "dynamic_load_rating_n": 9000,
             "max_force_n": 12000, "mass_kg": 1.5},
            {"name": "thick", "lead_mm": 10, "root_diameter_mm": 36, "length_mm": 1000, "dynamic_load_rating_n": 40000}]});
    for (key, value) in rail.as_object().expect("an object") {
        column[key] = value.clone();
    }
    json!({"name": "lift", "motion": {"tip_speed_m_s": 0.5, "ramp_time_s": 0.2},
        "chain": [column, {"type": "link", "name": "boom", "vector_m": [0.4, 0, 0], "choose": {
            "materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "round_tube", "diameter_mm": [60, 80], "wall_mm": [3]}]}}],
        "payload": {"mass_kg": 10}, "poses": [{"pose": {"lift_mm": 0}}, {"pose": {"lift_mm": 600}}]})
}

#[test]
fn a_lift_holds_accelerates_and_wears_as_by_hand() {
    let catalogs = Catalogs::builtin();
    let study = read(&lift(json!({})), &catalogs);
    let problem = ArmProblem::new(&study.space, &catalogs);
    let options = [0];
    let arm = problem.arm(&options).expect("it holds");
    let mut seen = None;
    let complete = problem
        .walk(&options, |slot, outboard| {
            if problem.piece_of_slot(slot) == 0 {
                seen = Some((problem.demand_at(outboard, slot), problem.mass_kg(outboard)));
            }
        })
        .expect("it holds");
    let (demand, outboard_kg) = seen.expect("the rail");
    // 20 kg travel, the boom and its payload of 10 kg; the mass of a design leaves the payload out
    let moved_kg = outboard_kg + 10.0;
    assert!(outboard_kg > 20.0 && outboard_kg < 23.0, "{outboard_kg}");
    assert!((demand.static_torque_nm - moved_kg * 9.81).abs() < 1e-9);
    let acceleration = 0.25 / 0.2;
    assert!((demand.linear_torque_nm - moved_kg * acceleration).abs() < 1e-9);
    assert!((demand.stop_torque_nm - moved_kg * (9.81 + 2.0 * acceleration)).abs() < 1e-9);

    let sized = problem.sized_joint(0).expect("the rail is sized");
    let index = problem.options(&complete).next().expect("the rail") as usize;
    let drive = sized.table.drive(index);
    // the thin screw whips at 1500 rpm, and the thick one is heavier
    assert_eq!(drive.gear.id, "right");
    let ratio = 2.0 * std::f64::consts::PI / 0.01;
    assert!((drive.ratio() / ratio - 1.0).abs() < 1e-15);
    assert!((drive.motor_speed_rpm(sized.table.motion()) - 1500.0).abs() < 1e-9);
    let made = checks(&drive, sized.table.motion(), &demand);
    assert!(all_hold(&made));
    let of = |name: &str| made.iter().find(|check| check.kind.label() == name).expect(name);
    let shaft_kg = 7850.0 * std::f64::consts::PI / 4.0 * 0.017f64.powi(2);
    let inertia = shaft_kg * 0.017f64.powi(2) / 8.0 + drive.motor.rotor_inertia_kgm2.expect("known");
    let peak_nm = moved_kg * (9.81 + acceleration) / (ratio * 0.9) + inertia * ratio * acceleration;
    assert!((of("motor peak").needed.expect("known") / peak_nm - 1.0).abs() < 1e-12);
    // per cycle: ramps up and down of one t, three t at speed, five of rest; the ramps at half the speed
    let up = moved_kg * (9.81 + acceleration);
    let (steady, down) = (moved_kg * 9.81, moved_kg * (9.81 - acceleration));
    let cubed = (0.5 * up.powi(3) + 3.0 * steady.powi(3) + 0.5 * down.powi(3)) / 4.0;
    let life_h = (9000.0f64.powi(3) / cubed) * 1e6 / (60.0 * 0.4 * 1500.0);
    let life = of("gear life");
    assert!((life.allowed.expect("known") / life_h - 1.0).abs() < 1e-9, "{life:?} {life_h}");
    assert_eq!(life.unit(), "h");
    let buckling = of("gear buckling");
    let euler = 0.5 * 2.0 * std::f64::consts::PI.powi(3) * 2.06e11 * 0.017f64.powi(4) / 64.0;
    assert!((buckling.allowed.expect("known") / euler - 1.0).abs() < 1e-12);
    assert_eq!(buckling.unit(), "N");

    // the arm has the screw's stiffness along the travel and its mass, with the motor's, where the joint begins
    let Element::Prismatic(rail) = &arm.chain[0] else { panic!("a rail") };
    let shaft = 2.06e11 * std::f64::consts::PI / 4.0 * 0.017f64.powi(2);
    assert!((rail.stiffness_n_per_m.expect("it yields") / shaft - 1.0).abs() < 1e-12);
    let drive_kg = shaft_kg + 1.5 + drive.motor.mass_kg.expect("known");
    assert!((rail.fixed_mass_kg - drive_kg).abs() < 1e-9);
    let design = evaluate(&problem, 0).expect("it holds");
    assert!((design.objectives.mass_kg - arm.mass_kg()).abs() < 1e-9);
    assert!((design.objectives.mass_kg - problem.mass_kg(&complete)).abs() < 1e-9);
    // weight over stiffness is in the deflection of the tip
    let statics = |case: &LoadCase| Chain::new(&arm.structure(case.joints), case.links).pose(case).statics();
    let sunk = statics(&problem.load_cases()[0]).shares_m.into_iter().find(|(name, _)| name == "lift");
    let along = sunk.expect("the rail yields").1.z;
    assert!((along + moved_kg * 9.81 / shaft).abs() < 1e-12, "{along}");
    assert_eq!(problem.level_sizes().len(), 1, "the boom alone is a choice");
}

#[test]
fn a_brake_and_a_rack_change_what_a_lift_needs() {
    let catalogs = Catalogs::builtin();
    let lightest = |rail: Value| {
        let study = read(&lift(rail), &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let options = problem.walk(&[0], |_, _| {}).ok()?;
        let index = problem.options(&options).next()? as usize;
        let table = &problem.sized_joint(0)?.table;
        Some((table.mass_kg(index), table.drive(index).gear.id.clone()))
    };
    let (bare_kg, _) = lightest(json!({})).expect("it holds");
    let (braked_kg, _) = lightest(json!({"brake": true})).expect("it holds");
    assert!(braked_kg <= bare_kg);
    let rack = json!([{"name": "rack", "pinion_radius_mm": 20, "ratio": 10, "stiffness_n_per_m": 2e7, "mass_kg": 2}]);
    let with_rack =
        lightest(json!({"racks": rack, "screws": [{"name": "thin", "lead_mm": 10, "root_diameter_mm": 6,
        "length_mm": 1000}]}));
    assert_eq!(with_rack.expect("it holds").1, "rack");
    // a screw that whips is no choice, and nothing else is left
    assert_eq!(
        lightest(
            json!({"screws": [{"name": "thin", "lead_mm": 10, "root_diameter_mm": 6, "length_mm": 1000}]})
        ),
        None
    );
}

#[test]
fn what_a_rail_cannot_have_is_refused_by_name() {
    let catalogs = Catalogs::builtin();
    let says = |rail: Value, words: &str| {
        let document = Document::parse("study.json", &lift(rail).to_string()).expect("JSON");
        let faults = read_study(document, &catalogs).expect_err("a fault").to_string();
        assert!(faults.contains(words), "{faults}");
    };
    says(json!({"drive": "all_fits"}), "write first_fit");
    says(json!({"stiffness_n_per_m": 1e7}), "stands beside \"drive\"");
    says(json!({"gear": "CSG-20-100"}), "has no gear of the catalogs");
    says(json!({"screws": [{"name": "s", "lead_mm": 0, "root_diameter_mm": 6, "length_mm": 10}]}), "lead_mm");
    says(
        json!({"screws": [{"name": "s", "lead_mm": 5, "root_diameter_mm": 6, "length_mm": 10, "ends": "glued"}]}),
        "fixed_free",
    );
    let study = read(&lift(json!({})), &catalogs);
    let exact = SearchWish { method: Some(SearchMethod::Exact), ..SearchWish::default() };
    let refused = exact.check(&study, &catalogs).expect_err("beyond the bounds").to_string();
    assert!(refused.contains("rails whose drive is sized"), "{refused}");
    assert_eq!(
        SearchWish::default().method(&study, &catalogs).expect("it can be searched").0,
        SearchMethod::Exhaustive
    );
}

#[test]
fn a_study_with_a_rail_that_is_sized_says_that_the_friction_of_guides_is_left_out() {
    let study = read(&lift(json!({})), &Catalogs::builtin());
    assert!(
        study
            .remarks
            .iter()
            .any(|words| words.contains("the friction of guides, the strength and life of guides")),
        "{:?}",
        study.remarks
    );
}

#[test]
fn a_screw_without_load_rating_or_largest_force_is_said_to_be_unchecked() {
    let said = |screw: Value| read(&lift(json!({"screws": [screw]})), &Catalogs::builtin()).remarks.join(" ");
    let mut screw = json!({"name": "s-25", "lead_mm": 10, "root_diameter_mm": 20, "length_mm": 800});
    let unrated = said(screw.clone());
    assert!(unrated.contains("the life of s-25 is not checked: no dynamic_load_rating_n"), "{unrated}");
    assert!(unrated.contains("the strength of s-25 is not checked: no max_force_n"), "{unrated}");
    assert!(!unrated.contains("load factor"), "{unrated}");
    screw["dynamic_load_rating_n"] = json!(15000);
    screw["max_force_n"] = json!(9000);
    let rated = said(screw);
    assert!(!rated.contains("not checked") && rated.contains("1.7 to 3.4 times shorter"), "{rated}");
}
