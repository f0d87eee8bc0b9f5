//! The strength of links against closed forms: layers of fibres that are weak in shear, and tubes that the study gives.

use crate::exact_support::read as read_study;
use armwright::catalog::Catalogs;
use armwright::space::ArmProblem;
use armwright::study::{Study, sizing_of};
use serde_json::{Value, json};

const GRAVITY_M_S2: f64 = 9.81;

/// A round tube of 0.3 m that carries 20 kg at its end, 0.5 m to the side.
fn twisted(material: &str) -> Value {
    json!({"name": "twisted", "extras": "none", "payload": {"mass_kg": 20}, "poses": [{"pose_deg": [0]}], "chain": [
        {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 50000},
        {"type": "link", "name": "b", "vector_m": [0.3, 0, 0], "choose": {"materials": [material],
            "sections": [{"shape": "round_tube", "diameter_mm": 40, "wall_mm": 1.5}]}},
        {"type": "link", "name": "o", "vector_m": [0, 0.5, 0]}]})
}

fn peak_factor(study: &Study) -> f64 {
    1.0 + study.space.motion.tip_speed_m_s / study.space.motion.ramp_time_s / GRAVITY_M_S2
}

/// Second moment of area and area of a round tube.
fn round(diameter_m: f64, wall_m: f64) -> [f64; 2] {
    let hollow = |power: i32| diameter_m.powi(power) - (diameter_m - 2.0 * wall_m).powi(power);
    [std::f64::consts::PI / 64.0 * hollow(4), std::f64::consts::PI / 4.0 * hollow(2)]
}

/// `(σ/X)² + (τ/S)²` at the root: σ = M r / I, τ = T r / 2 I. Von Mises' stress against the strength of the fibres gave ten
/// times as much.
#[test]
fn fibres_along_a_link_are_weak_where_it_is_twisted() {
    let catalogs = Catalogs::builtin();
    let name = "CFRP T300/5208 (standard modulus) UD";
    let study = read_study(&twisted(name), &catalogs);
    let problem = ArmProblem::new(&study.space, &catalogs);
    let arm = problem.walk(&[0], |_, _| {}).expect("a design");
    let found = problem.stress_safety_factor(&arm).expect("a known strength");

    let row = catalogs.material(name).expect("in the catalog");
    let [second_moment_m4, area_m2] = round(0.04, 0.0015);
    let weight_n = row.density_kg_m3 * area_m2 * 0.3 * GRAVITY_M_S2;
    let bending_nm = 20.0 * GRAVITY_M_S2 * 0.3 + weight_n * 0.15;
    let torsion_nm = 20.0 * GRAVITY_M_S2 * 0.5;
    let normal_pa = bending_nm * 0.02 / second_moment_m4;
    let shear_pa = torsion_nm * 0.02 / (2.0 * second_moment_m4);
    let along_pa = row.strength_pa.expect("known").min(row.compressive_strength_pa.expect("known"));
    let used = (normal_pa / along_pa).hypot(shear_pa / row.shear_strength_pa.expect("known"));
    let expected = 1.0 / (used * peak_factor(&study));
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    assert!((1.5..1.7).contains(&found), "{found}");
}

/// A layer of fibres whose strength in shear the catalog does not state cannot be checked. Other materials can.
#[test]
fn a_limit_on_the_stress_leaves_out_fibres_of_unknown_shear_strength() {
    let mut catalogs = Catalogs::builtin();
    for material in &mut catalogs.materials {
        material.shear_strength_pa = None;
    }
    let mut text = twisted("CFRP T300/5208 (standard modulus) UD");
    text["chain"][1]["choose"]["materials"] =
        json!(["CFRP T300/5208 (standard modulus) UD", "CFRP T300/5208 (standard modulus) quasi-isotropic"]);
    text["constraints"] = json!({"stress_safety_factor_min": 0.01});
    let study = read_study(&text, &catalogs);
    assert_eq!(study.not_checked.len(), 1, "{:?}", study.not_checked);
    assert!(study.not_checked[0].contains("UD has no shear strength"), "{}", study.not_checked[0]);
}

/// A thin root that the study gives, and a forearm that it chooses.
fn weak_root() -> Value {
    json!({"name": "weak root", "extras": "none", "payload": {"mass_kg": 8}, "poses": [{"pose_deg": [0, 0]}], "chain": [
        {"type": "joint", "name": "a", "axis": [0, 1, 0], "stiffness_nm_per_rad": 5e4},
        {"type": "link", "name": "root", "vector_m": [0.6, 0, 0], "material": "Aluminium 6082-T6",
            "section": {"shape": "round_tube", "diameter_m": 0.03, "wall_m": 0.001}},
        {"type": "joint", "name": "b", "axis": [0, 1, 0], "stiffness_nm_per_rad": 5e4},
        {"type": "link", "name": "fore", "vector_m": [0.3, 0, 0], "choose": {"materials": ["Aluminium 6082-T6"],
            "sections": [{"shape": "round_tube", "diameter_mm": 50, "wall_mm": 2}]}}],
        "constraints": {"stress_safety_factor_min": 2}})
}

/// Strength over stress at the root of the given tube.
fn factor_of_root(study: &Study, catalogs: &Catalogs) -> f64 {
    let row = catalogs.material("Aluminium 6082-T6").expect("in the catalog");
    let [[second_moment_m4, root_m2], [_, fore_m2]] = [round(0.03, 0.001), round(0.05, 0.002)];
    let weight_n = |area_m2: f64, length_m: f64| row.density_kg_m3 * area_m2 * length_m * GRAVITY_M_S2;
    let moment_nm = 8.0 * GRAVITY_M_S2 * 0.9 + weight_n(root_m2, 0.6) * 0.3 + weight_n(fore_m2, 0.3) * 0.75;
    row.strength_pa.expect("known") / (moment_nm * 0.015 / second_moment_m4 * peak_factor(study))
}

/// A tube that the study gives excludes no design, but the reader is told that it is stressed too much, by how much, and
/// nothing where it holds.
#[test]
fn a_given_tube_that_is_stressed_too_much_is_named_with_its_factor() {
    let catalogs = Catalogs::builtin();
    let remarks = |text: &Value| {
        let study = read_study(text, &catalogs);
        let expected = factor_of_root(&study, &catalogs);
        (sizing_of(&study, None, &catalogs).expect("a design").remarks.join(" "), expected)
    };
    let (weak, expected) = remarks(&weak_root());
    assert!((1.3..1.6).contains(&expected), "{expected}");
    assert!(
        weak.contains("stressed too much") && weak.contains(&format!("root ({expected:.2} times)")),
        "{weak}"
    );

    let mut stout = weak_root();
    stout["constraints"]["stress_safety_factor_min"] = json!(1.2);
    let (holds, expected) = remarks(&stout);
    assert!(!holds.contains("stressed too much") && expected > 1.2, "{holds}");
}
