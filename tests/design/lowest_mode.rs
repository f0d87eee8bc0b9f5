//! The lowest mode, which is computed from products with the mass matrix, against the whole eigenvalue problem: on
//! random arms with tapered links, bodies, bearings, linkages, prismatic joints, feet that lift and motions that nothing
//! resists, and on arms with two equal lowest modes.

use crate::dice::Dice;
use armwright::arm::{Arm, JointModel, LinkModel, Payload, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use nalgebra::Vector3;
use serde_json::{Value, json};

fn read(chain: &[Value], effects: &Value) -> Arm {
    let text = json!({"materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
        "chain": chain, "effects": effects})
    .to_string();
    let document = Document::parse("arm.json", &text).expect("JSON");
    read_arm_document(document, &Catalogs::builtin()).unwrap_or_else(|faults| panic!("{faults}\n{text}"))
}

/// The lowest mode and the three lowest of the whole problem, in a pose \[Hz\].
fn solved(arm: &Arm, links: LinkModel, pose: &[f64], payload: &Payload) -> (f64, Vec<f64>) {
    let chain = Chain::new(&arm.structure(JointModel::ThreeSegment), links);
    let posed = chain.pose_rad(pose, payload, Vector3::new(3.0, -20.0, 40.0));
    let statics = posed.statics();
    let whole = posed.solve_modes(&statics).finite().take(3).map(|(_, frequency_hz)| frequency_hz).collect();
    (posed.lowest_frequency_hz(&statics), whole)
}

fn axis(dice: &mut Dice) -> [f64; 3] {
    let askew = [dice.within(-1.0, 1.0), dice.within(-1.0, 1.0), dice.within(0.1, 1.0)];
    dice.of(&[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], askew])
}

fn link(dice: &mut Dice, name: &str) -> Value {
    let length_m = dice.within(0.1, 0.8);
    let mut out = json!({"type": "link", "name": name, "vector_m": [length_m, 0, 0]});
    let tube = |diameter_m: f64| json!({"shape": "round_tube", "diameter_m": diameter_m, "wall_m": 0.003});
    let first = dice.within(0.05, 0.15);
    match dice.below(4) {
        // one tapered link is enough for the whole problem to take long
        1 if name != "l0" => {}
        0 => out["mass_kg"] = json!(dice.of(&[0.0, 2.0])),
        1 => {
            let piece =
                json!({"length_m": length_m, "section": tube(first), "end_section": tube(0.6 * first)});
            (out["material"], out["pieces"]) = (json!("steel"), json!([piece]));
        }
        _ => {
            (out["material"], out["section"]) = (json!("Aluminium 6061-T6"), tube(first));
            out["bodies"] = json!([{"mass_kg": dice.within(0.1, 4.0), "cg_m": [0.5 * length_m, 0.05, 0.02],
                "inertia_kgm2": [[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]]}]);
        }
    }
    out
}

/// A joint, and whether it has an entry of a pose. `driver` is the name of a driven revolute joint inboard of it.
fn joint(dice: &mut Dice, name: &str, driver: Option<&str>) -> (Value, bool) {
    let (axis, stiffness) = (axis(dice), 10f64.powf(dice.within(3.0, 6.0)));
    let mut out = json!({"type": "joint", "name": name, "axis": axis, "mass_kg": dice.of(&[0.0, 3.0]),
        "stiffness_nm_per_rad": stiffness});
    match (dice.below(6), driver) {
        (0, _) => {
            return (
                json!({"type": "prismatic", "name": name, "axis": axis, "stiffness_n_per_m": 1e2 * stiffness, "mass_kg": 2,
                "moves": dice.of(&["carriage", "ram"]),
                "guide": {"roll_nm_per_rad": stiffness, "pitch_nm_per_rad": 1e5, "yaw_nm_per_rad": 3e5}}),
                true,
            );
        }
        (1, Some(driver)) => {
            out["coupled"] = json!({driver: dice.of(&[-1.0, 0.5])});
            out["stiffness_nm_per_rad"] = dice.of(&[Value::Null, json!(stiffness)]);
        }
        (2, _) => out["stiffness_nm_per_rad"] = Value::Null,
        (3, Some(driver)) => out["turns_with"] = json!({driver: -1}),
        _ => out["bearing"] = json!({"tilt_stiffness_nm_per_rad": 2.0 * stiffness, "mass_kg": 0.3}),
    }
    let is_driven = out.get("coupled").is_none();
    (out, is_driven)
}

#[test]
fn the_lowest_mode_alone_is_that_of_the_whole_problem() {
    let mut largest = 0f64;
    let (mut most_coordinates, mut linked) = (0, 0);
    for seed in 0..30 {
        let dice = &mut Dice(seed);
        let (mut chain, mut driven, mut driver) = (Vec::new(), 0, None);
        for i in 0..2 + dice.below(4) {
            let (joint, is_driven) = joint(dice, &format!("j{i}"), driver.as_deref());
            linked += usize::from(joint.get("coupled").is_some() || joint.get("turns_with").is_some());
            driven += usize::from(is_driven);
            if is_driven && joint["type"] == "joint" {
                driver = Some(format!("j{i}"));
            }
            chain.extend([joint, link(dice, &format!("l{i}"))]);
        }
        let effects = match dice.below(3) {
            0 => {
                json!([{"effect": "base_compliance", "at": "base", "parameters": {"stiffness_nm_per_rad": 3e5}}])
            }
            _ => json!([]),
        };
        let arm = read(&chain, &effects);
        let mut position = || {
            let any = dice.within(-2.0, 2.0);
            dice.of(&[0.0, any])
        };
        let pose: Vec<f64> = (0..driven).map(|_| position()).collect();
        let mass_kg = dice.of(&[0.0, 5.0]);
        let payload = Payload { mass_kg, cg_m: Vector3::new(0.05, 0.0, 0.0), ..Payload::default() };
        for links in [LinkModel::Full, LinkModel::Bending, LinkModel::Rigid] {
            let (lowest, whole) = solved(&arm, links, &pose, &payload);
            let Some(expected) = whole.first() else {
                assert_eq!(lowest, f64::INFINITY, "{seed}: nothing vibrates");
                continue;
            };
            let error = (lowest / expected - 1.0).abs();
            assert!(error < 1e-11, "{seed}, {links:?}: {lowest} and {expected} Hz, {error:e} apart");
            largest = largest.max(error);
        }
        let posed = Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full);
        let posed = posed.pose_rad(&pose, &payload, Vector3::zeros());
        most_coordinates = most_coordinates.max(posed.elements().map(|of| of.twists.len()).sum());
    }
    println!(
        "largest difference {largest:.1e}, up to {most_coordinates} coordinates, {linked} linked joints"
    );
    assert!(most_coordinates > 240 && linked > 10, "{most_coordinates} {linked}");
}

/// A straight round arm vibrates in two planes at one frequency; a small mass out of its axis sets the two apart.
#[test]
fn two_lowest_modes_at_nearly_one_frequency_give_the_lower() {
    let section = json!({"shape": "round_tube", "diameter_m": 0.08, "wall_m": 0.003});
    let end = json!({"shape": "round_tube", "diameter_m": 0.05, "wall_m": 0.003});
    let taper = json!({"length_m": 0.8, "section": section, "end_section": end});
    for aside_kg in [0.0, 1e-13, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2] {
        let mut link = json!({"type": "link", "name": "l", "vector_m": [0.8, 0, 0], "material": "steel", "pieces": [taper]});
        if aside_kg > 0.0 {
            link["bodies"] = json!([{"mass_kg": aside_kg, "cg_m": [0.8, 0.1, 0]}]);
        }
        let arm = read(&[link], &json!([]));
        let payload = Payload { mass_kg: 3.0, ..Payload::default() };
        let (lowest, whole) = solved(&arm, LinkModel::Full, &[], &payload);
        assert!((lowest / whole[0] - 1.0).abs() < 1e-12, "{aside_kg} kg: {lowest} and {whole:?} Hz");
        let apart = whole[1] / whole[0] - 1.0;
        assert!(apart < 1e-3, "{aside_kg} kg: {whole:?} Hz");
    }
}
