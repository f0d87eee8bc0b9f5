//! The reference arms, solved by FEDEM, CalculiX, Pinocchio, MuJoCo and an independent finite-element
//! chain, against the library, to the tolerances their files state.

use armwright::arm::read_arm_document;
use armwright::arm::{Arm, JointModel, LinkModel};
use armwright::arm::{LoadCase, Payload};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use armwright::mechanics::Mode;
use armwright::mechanics::Statics;
use nalgebra::Vector3;
use serde_json::Value;

fn load(file: &str) -> Value {
    let path = format!("{}/tests/data/{file}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("reference file")).expect("JSON")
}

fn arm(case: &Value) -> Arm {
    let document = Document::parse("case", &case["arm"].to_string()).expect("JSON");
    read_arm_document(document, &Catalogs::default()).expect("sound arm")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map(|a| a.iter().filter_map(Value::as_f64).collect()).unwrap_or_default()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_iterator(numbers(value).into_iter().chain([0.0; 3]).take(3))
}

fn load_case(case: &Value, links: LinkModel) -> LoadCase {
    let payload = &case["payload"];
    let inertia = |key: &str| payload["inertia_about_cg_kgm2"][key].as_f64().unwrap_or(0.0);
    LoadCase {
        name: case["id"].to_string(),
        pose_deg: numbers(&case["pose_deg"]),
        payload: Payload {
            mass_kg: payload["mass_kg"].as_f64().expect("mass"),
            cg_m: vector(&payload["cg_m"]),
            inertia_about_cg_kgm2: Vector3::new(inertia("ixx"), inertia("iyy"), inertia("izz")),
        },
        tip_force_n: vector(&case["tip_force_n"]),
        tip_moment_nm: Vector3::zeros(),
        links,
        joints: JointModel::ThreeSegment,
        water: None,
    }
}

fn solve(arm: &Arm, case: &LoadCase, modes: usize) -> (Statics, Vec<Mode>) {
    let chain = Chain::new(&arm.structure(case.joints), case.links);
    let posed = chain.pose(case);
    let statics = posed.statics();
    let modes = posed.modes(&statics, modes);
    (statics, modes)
}

/// The sixth mode of the spatial arms bends stout links. The reference's elements take the slope dv/dx for
/// the section's rotation in the mass matrix, which overrates rotary inertia by up to 0.26 % here; with the
/// same shapes the witness of `reference_arms.rs` reproduces it to 0.03 %, with Timoshenko's it agrees with
/// us. Refining our own model does not move it.
const SIXTH_MODE_PCT: f64 = 0.3;

fn split_last(numbers: &[f64]) -> (Vec<f64>, f64) {
    let (last, rest) = numbers.split_last().expect("frequencies");
    (rest.to_vec(), *last)
}

/// Largest relative deviation of a set of numbers \[%\].
fn worst_pct(ours: &[f64], theirs: &[f64]) -> f64 {
    assert!(ours.len() >= theirs.len(), "{ours:?} against {theirs:?}");
    ours.iter().zip(theirs).map(|(a, b)| 100.0 * (a / b - 1.0).abs()).fold(0.0, f64::max)
}

fn tip_deviation_pct(statics: &Statics, expected_mm: &Vector3<f64>, floor_mm: f64) -> f64 {
    let gap = (statics.tip_displacement_m * 1e3 - expected_mm).norm();
    100.0 * gap / expected_mm.norm().max(floor_mm)
}

#[test]
fn planar_arms_agree_with_four_independent_programs() {
    let file = load("planar-arms.json");
    for case in file["cases"].as_array().expect("cases") {
        let arm = arm(case);
        for (model, expected) in case["expected_in_plane"].as_object().expect("models") {
            let links = if model == "rigid_links" { LinkModel::Rigid } else { LinkModel::Full };
            let tolerance = file["suggested_tolerance_pct"][model].as_f64().expect("tolerance");
            let (statics, modes) = solve(&arm, &load_case(case, links), 20);
            let in_plane: Vec<f64> =
                modes.iter().filter(|m| m.plane == Some("xz")).map(|m| m.frequency_hz).collect();
            let frequency = worst_pct(&in_plane, &numbers(&expected["frequency_hz"]));
            let tip = tip_deviation_pct(
                &statics,
                &vector(&expected["tip_mm"]),
                file["tip_floor_mm"].as_f64().expect("floor"),
            );
            println!(
                "{} {model}: tip {tip:.4} %, modes {frequency:.4} % (allowed {tolerance} %)",
                case["id"]
            );
            assert!(tip <= tolerance && frequency <= tolerance);
        }
    }
}

#[test]
fn spatial_arms_agree_with_an_independent_finite_element_chain() {
    let file = load("spatial-arms.json");
    for case in file["cases"].as_array().expect("cases") {
        let arm = arm(case);
        for (model, expected) in case["expected"].as_object().expect("models") {
            let links = if model == "rigid_links" { LinkModel::Rigid } else { LinkModel::Full };
            let tolerance = file["suggested_tolerance_pct"][model].as_f64().expect("tolerance");
            let (statics, modes) = solve(&arm, &load_case(case, links), 6);
            let ours: Vec<f64> = modes.iter().map(|m| m.frequency_hz).collect();
            let tip = tip_deviation_pct(&statics, &vector(&expected["tip_mm"]), 0.01);
            let (theirs, last) = split_last(&numbers(&expected["frequency_hz"]));
            let frequency = worst_pct(&ours, &theirs);
            let last_pct = worst_pct(&ours[5..], &[last]);
            println!(
                "{} {model}: tip {tip:.4} %, modes 1-5 {frequency:.4} %, mode 6 {last_pct:.4} %",
                case["id"]
            );
            assert!(tip <= tolerance && frequency <= tolerance, "{ours:?}");
            assert!(last_pct <= tolerance.max(SIXTH_MODE_PCT), "{ours:?}");
            for (name, torque_nm) in &statics.joint_torques_nm {
                let theirs = expected["joint_torque_nm"][name].as_f64().expect("torque");
                assert!(
                    (torque_nm - theirs).abs() < 0.0005 * theirs.abs() + 0.002,
                    "{name} {torque_nm} {theirs}"
                );
            }
        }
    }
}

#[test]
fn shares_sum_to_the_tip_displacement_and_strain_energies_to_one() {
    let file = load("spatial-arms.json");
    for case in file["cases"].as_array().expect("cases") {
        let (statics, modes) = solve(&arm(case), &load_case(case, LinkModel::Full), 6);
        let sum: Vector3<f64> = statics.shares_m.iter().map(|(_, s)| s).sum();
        assert!((sum - statics.tip_displacement_m).norm() < 1e-15);
        for mode in modes {
            let total: f64 = mode.strain_energy.iter().map(|(_, e)| e).sum();
            assert!((total - 1.0).abs() < 1e-12);
        }
    }
}

/// How exact modes are in which a single tube bends by itself, as docs/model.md says: `(βL)² √(EI/ρA) / L²`.
#[test]
fn the_third_bending_mode_of_a_cantilever_is_three_per_cent_too_high_at_most() {
    let case = serde_json::json!({
        "id": "cantilever", "payload": {"mass_kg": 0.0}, "pose_deg": [],
        "arm": {"name": "cantilever",
            "materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
            "chain": [{"type": "link", "name": "tube", "vector_m": [1, 0, 0], "material": "steel",
                "section": {"shape": "rectangular_tube", "width_m": 0.02, "height_m": 0.04, "wall_m": 0.002}}]}});
    let (_, modes) = solve(&arm(&case), &load_case(&case, LinkModel::Bending), 6);
    let (width_m, height_m, wall_m) = (0.02f64, 0.04f64, 0.002f64);
    let (inner_width_m, inner_height_m) = (width_m - 2.0 * wall_m, height_m - 2.0 * wall_m);
    let area_m2 = width_m * height_m - inner_width_m * inner_height_m;
    let across_m4 = (height_m * width_m.powi(3) - inner_height_m * inner_width_m.powi(3)) / 12.0;
    let speed = (2.1e11 * across_m4 / (7850.0 * area_m2)).sqrt() / std::f64::consts::TAU;
    let across: Vec<f64> = modes
        .iter()
        .filter(|mode| mode.plane.is_some_and(|p| p == "xy"))
        .map(|mode| mode.frequency_hz)
        .collect();
    for (found_hz, (beta, most_pct)) in
        across.iter().zip([(1.875104, 0.01), (4.694091, 0.6), (7.854757, 2.7)])
    {
        let excess_pct = 100.0 * (found_hz / (f64::powi(beta, 2) * speed) - 1.0);
        assert!((-1e-3..most_pct).contains(&excess_pct), "{found_hz} Hz: {excess_pct} %");
    }
    assert!(across.len() >= 3, "{across:?}");
}
