//! Links of several pieces against a tapered cantilever in closed form, against links written one behind the other, and their
//! faults.

use armwright::arm::{Arm, JointModel, LinkModel, Payload, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::f64::consts::TAU;

fn read(arm: &Value) -> Result<Arm, String> {
    let document = Document::parse("arm.json", &arm.to_string()).expect("JSON");
    read_arm_document(document, &Catalogs::builtin()).map_err(|faults| faults.to_string())
}

fn arm(chain: Value) -> Value {
    json!({"materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
        "gravity_m_s2": 0, "chain": chain})
}

/// Deflection of the tip under a force on it.
fn deflection_m(arm: &Arm, links: LinkModel, force_n: f64) -> f64 {
    let chain = Chain::new(&arm.structure(JointModel::K2), links);
    let posed = chain.pose_rad(&[], &Payload::default(), Vector3::new(0.0, 0.0, -force_n));
    -posed.statics().tip_displacement_m.z
}

fn bar(height_m: f64) -> Value {
    json!({"shape": "rectangular_bar", "width_m": 0.03, "height_m": height_m})
}

/// A bar whose height falls from `h` at the root to `t` at the tip bends by `12 F / (E b g³) (ln(h/t) + 2t/h - t²/(2h²) - 3/2)`,
/// `g = (h - t)/L`. Twelve slices err by 0.6 % at most down to a third of the height; the mass is exact.
#[test]
fn a_tapered_cantilever_bends_as_its_closed_form_says() {
    let length_m: f64 = 0.6;
    for (root_m, tip_m) in [(0.06f64, 0.045f64), (0.06, 0.03), (0.06, 0.02)] {
        let taper = json!({"length_m": length_m, "section": bar(root_m), "end_section": bar(tip_m)});
        let link = json!({"type": "link", "name": "arm", "vector_m": [length_m, 0, 0], "material": "steel", "pieces": [taper]});
        let read = read(&arm(json!([link]))).expect("sound");
        let slope = (root_m - tip_m) / length_m;
        let integral =
            ((root_m / tip_m).ln() + 2.0 * tip_m / root_m - tip_m.powi(2) / (2.0 * root_m.powi(2)) - 1.5)
                / slope.powi(3);
        let expected = 12.0 * 100.0 * integral / (2.1e11 * 0.03);
        let found = deflection_m(&read, LinkModel::Bending, 100.0);
        println!("{root_m} to {tip_m}: {:.3e}", found / expected - 1.0);
        assert!((found / expected - 1.0).abs() < 0.006, "{root_m} to {tip_m}: {found} {expected}");
        let mass_kg = 7850.0 * 0.03 * (root_m + tip_m) / 2.0 * length_m;
        assert!((read.mass_kg() / mass_kg - 1.0).abs() < 1e-12);
    }
}

/// Steps are links one behind the other; a body hangs on the piece at which its centre is.
#[test]
fn steps_are_links_one_behind_the_other() {
    let tube = |wall_m: f64| json!({"shape": "round_tube", "diameter_m": 0.05, "wall_m": wall_m});
    let body = |x: f64| json!([{"mass_kg": 2, "cg_m": [x, 0, 0.05]}]);
    let pieces = json!([{"length_m": 0.2, "section": tube(0.004)}, {"length_m": 0.3, "section": tube(0.002), "material": "Aluminium 6061-T6"}]);
    let whole = arm(
        json!([{"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "material": "steel", "pieces": pieces,
        "bodies": body(0.3)}]),
    );
    let divided = arm(json!([
        {"type": "link", "name": "arm.1", "vector_m": [0.2, 0, 0], "material": "steel", "section": tube(0.004)},
        {"type": "link", "name": "arm.2", "vector_m": [0.3, 0, 0], "material": "Aluminium 6061-T6", "section": tube(0.002), "bodies": body(0.3 - 0.2)}]));
    let (whole, divided) = (read(&whole).expect("sound"), read(&divided).expect("sound"));
    assert_eq!(whole.mass_kg(), divided.mass_kg());
    let [a, b] = [&whole, &divided].map(|arm| deflection_m(arm, LinkModel::Full, 50.0));
    assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    let names: Vec<&str> = whole.links().map(|link| link.name.as_str()).collect();
    assert_eq!(names, ["arm.1", "arm.2"]);
}

/// A factor on the stiffness and one on the mass, and an arm that reads back the same.
#[test]
fn factors_multiply_stiffness_and_mass() {
    let link = |more: Value| {
        let mut link = json!({"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "material": "steel", "section": bar(0.04)});
        link.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        read(&arm(json!([link]))).expect("sound")
    };
    let (plain, drilled) = (link(json!({})), link(json!({"stiffness_factor": 0.8, "mass_factor": 0.7})));
    let ratio = |of: fn(&Arm) -> f64| of(&drilled) / of(&plain);
    assert!((ratio(|arm| deflection_m(arm, LinkModel::Full, 50.0)) - 1.0 / 0.8).abs() < 1e-12);
    assert!((ratio(Arm::mass_kg) - 0.7).abs() < 1e-12);
    assert_eq!(read(&drilled.to_json()).expect("sound"), drilled);
}

/// A link whose stiffnesses are stated has rotary inertia about its axis too: without an axial stiffness, that of mass which
/// fills the outline evenly, and with one, `kg/m (EIy + EIz) / EA`. A soft roll joint shows it.
#[test]
fn a_link_of_stated_stiffnesses_rolls_with_the_inertia_of_its_mass() {
    let roll_hz = |ea_n: Option<f64>| {
        let mut section = json!({"shape": "stated", "ei_y_nm2": 3e4, "ei_z_nm2": 3e4, "gj_nm2": 2e7, "kg_per_m": 4.0,
            "width_m": 0.1, "height_m": 0.1});
        if let Some(ea_n) = ea_n {
            section["ea_n"] = json!(ea_n);
        }
        let chain = json!([
            {"type": "joint", "name": "roll", "axis": [1, 0, 0], "stiffness_nm_per_rad": 1000},
            {"type": "link", "name": "l", "vector_m": [0.5, 0, 0], "section": section}]);
        let arm = read(&arm(chain)).expect("sound");
        let chain = Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full);
        let posed = chain.pose_rad(&[0.0], &Payload::default(), Vector3::zeros());
        posed.modes(&posed.statics(), 1)[0].frequency_hz
    };
    let closed_hz = |inertia_kgm2: f64| (1000.0 / inertia_kgm2).sqrt() / TAU;
    let even_kgm2 = 4.0 * 0.5 * (0.1 * 0.1 + 0.1 * 0.1) / 12.0;
    let of_ea_kgm2 = 4.0 * 0.5 * 6e4 / 4e7;
    // the link itself twists by a ten-thousandth of the joint
    assert!((roll_hz(None) / closed_hz(even_kgm2) - 1.0).abs() < 1e-4, "{}", roll_hz(None));
    assert!((roll_hz(Some(4e7)) / closed_hz(of_ea_kgm2) - 1.0).abs() < 1e-4, "{}", roll_hz(Some(4e7)));
}

#[test]
fn faults_of_pieces_are_told_with_their_numbers() {
    let with = |pieces: Value, more: Value| {
        let mut link = json!({"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "material": "steel", "pieces": pieces});
        link.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        read(&arm(json!([link]))).expect_err("a fault")
    };
    let short = with(json!([{"length_m": 0.2, "section": bar(0.04)}]), json!({}));
    assert!(short.contains("are 0.2 m long together, and vector_m is 0.5 m"), "{short}");
    let round = json!({"shape": "round_bar", "diameter_m": 0.03});
    let shapes = with(json!([{"length_m": 0.5, "section": bar(0.04), "end_section": round}]), json!({}));
    assert!(shapes.contains("tapers from rectangular_bar to round_bar"), "{shapes}");
    let stray = with(json!([{"length_m": 0.5, "section": bar(0.04)}]), json!({"mass_kg": 2}));
    assert!(stray.contains("stands beside \"pieces\""), "{stray}");
}
