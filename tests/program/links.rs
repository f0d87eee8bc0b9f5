//! What links are made of, by the program as a user meets it: thick walls and bars, stainless steel, the median section.

use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::Path;
use std::process::Command;

const G_PA: f64 = 26e9;
const E_PA: f64 = 69e9;

/// Exit code and what was said: standard output if it succeeds, standard error if not.
pub fn armwright(here: &Path, words: &[&str]) -> (i32, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    let output = command.current_dir(here).args(words).output().expect("it runs");
    let said = if output.status.success() { output.stdout } else { output.stderr };
    (output.status.code().expect("a code"), String::from_utf8(said).expect("text"))
}

pub fn folder_with(name: &str, file: &Value) -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(here.path().join(name), file.to_string()).expect("written");
    here
}

/// A weightless aluminium bar of 0.5 m with a lever of 0.2 m across its end.
fn bar_with_lever(section: Value) -> Value {
    let aluminium = json!({"youngs_modulus_pa": E_PA, "shear_modulus_pa": G_PA, "density_kg_m3": 2700});
    json!({"name": "bar", "gravity_m_s2": 0, "materials": {"al": aluminium}, "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": null},
        {"type": "link", "name": "bar", "vector_m": [0.5, 0, 0], "material": "al", "section": section},
        {"type": "link", "name": "lever", "vector_m": [0, 0.2, 0], "mass_kg": 0}]})
}

/// How far 50 N press the end of the lever down.
fn drop_m(section: Value) -> f64 {
    let here = folder_with("bar.json", &bar_with_lever(section));
    let (code, said) =
        armwright(here.path(), &["analyze", "bar.json", "--pose-deg", "0", "--force-n", "0,0,-50", "--json"]);
    assert_eq!(code, 0, "{said}");
    let case: Value = serde_json::from_str(&said).expect("JSON");
    -case["tip_displacement_m"][2].as_f64().expect("a number")
}

/// `F L³/3EI + F L/(k G A) + F a² L/(G J)` with a second moment \[m⁴\], shear area \[m²\] and torsion constant \[m⁴\].
fn by_hand_m(second_moment_m4: f64, shear_m2: f64, torsion_m4: f64) -> f64 {
    50.0 * (0.5f64.powi(3) / (3.0 * E_PA * second_moment_m4)
        + 0.5 / (G_PA * shear_m2)
        + 0.2f64.powi(2) * 0.5 / (G_PA * torsion_m4))
}

/// A 40 x 20 mm bar with a slit of 21 x 1 mm. Saint-Venant's J of the solid is 0.229 h b³; Bredt's was 35 % less.
#[test]
fn a_tube_that_is_nearly_solid_twists_as_saint_venant_says() {
    let tube = json!({"shape": "rectangular_tube", "width_m": 0.04, "height_m": 0.02, "wall_m": 0.0095});
    assert!((1e3 * drop_m(tube) / 1.657 - 1.0).abs() < 0.02);
}

#[test]
fn a_solid_bar_bends_and_twists_as_the_textbook_says() {
    let shear_factor = 10.0 * 1.3 / (12.0 + 11.0 * 0.3);
    let hand_m =
        by_hand_m(0.04 * 0.02f64.powi(3) / 12.0, shear_factor * 8e-4, 0.2287 * 0.04 * 0.02f64.powi(3));
    let bar = drop_m(json!({"shape": "rectangular_bar", "width_m": 0.04, "height_m": 0.02}));
    assert!((bar / hand_m - 1.0).abs() < 2e-4, "{bar} m, by hand {hand_m} m");
    let round = drop_m(json!({"shape": "round_bar", "diameter_m": 0.03}));
    let second_moment_m4 = PI / 64.0 * 0.03f64.powi(4);
    let shear_m2 = 6.0 * 1.3 / (7.0 + 6.0 * 0.3) * PI / 4.0 * 0.03f64.powi(2);
    let hand_m = by_hand_m(second_moment_m4, shear_m2, 2.0 * second_moment_m4);
    assert!((round / hand_m - 1.0).abs() < 1e-9, "{round} m, by hand {hand_m} m");
}

#[test]
fn a_tube_whose_wall_fills_it_is_a_bar_and_a_thicker_wall_is_refused() {
    let tube = |wall_m: f64| json!({"shape": "rectangular_tube", "width_m": 0.04, "height_m": 0.02, "wall_m": wall_m});
    let bar = json!({"shape": "rectangular_bar", "width_m": 0.04, "height_m": 0.02});
    assert_eq!(drop_m(tube(0.01)), drop_m(bar));
    let round = |wall_m: f64| json!({"shape": "round_tube", "diameter_m": 0.03, "wall_m": wall_m});
    assert_eq!(drop_m(round(0.015)), drop_m(json!({"shape": "round_bar", "diameter_m": 0.03})));
    let here = folder_with("bar.json", &bar_with_lever(tube(0.011)));
    let (code, said) = armwright(here.path(), &["analyze", "bar.json", "--pose-deg", "0"]);
    assert_eq!(code, 3);
    assert!(said.contains("wall_m = 0.011 leaves no hollow"), "{said}");
}

/// The bench arm of the examples with these choices for its upper arm.
fn study(choose: Value) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bench-arm.json");
    let mut study: Value =
        serde_json::from_str(&std::fs::read_to_string(path).expect("the study")).expect("JSON");
    study["constraints"] = json!({});
    study["chain"][1]["choose"] = choose;
    study
}

const STEEL: &str = "Structural steel S355";
const STAINLESS: &str = "Stainless steel 1.4404 (316L)";

#[test]
fn a_bar_may_be_chosen_and_is_taken_out_as_one() {
    let sections = json!([{"shape": "rectangular_bar", "width_mm": [20, 30], "height_mm": 30},
        {"shape": "round_bar", "diameter_mm": 30}]);
    let here =
        folder_with("study.json", &study(json!({"materials": ["Aluminium 6061-T6"], "sections": sections})));
    let (code, said) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
    assert_eq!(code, 0, "{said}");
    let mut shapes = Vec::new();
    let mut front = csv::Reader::from_path(here.path().join("out/front.csv")).expect("a front");
    let header = front.headers().expect("a header").clone();
    let column = |name: &str| header.iter().position(|c| c == name).expect("the column");
    for row in front.records() {
        let row = row.expect("a row");
        let (code, said) = armwright(here.path(), &["design", "out", &row[0], "--out", "arm"]);
        assert_eq!(code, 0, "{said}");
        let arm = std::fs::read_to_string(here.path().join("arm/arm.json")).expect("an arm");
        let section = serde_json::from_str::<Value>(&arm).expect("JSON")["chain"][1]["section"].clone();
        assert_eq!(section["shape"], row[column("upper_arm_shape")]);
        assert!(section.get("wall_m").is_none(), "{section}");
        shapes.push(section["shape"].clone());
    }
    assert!(shapes.contains(&json!("rectangular_bar")), "{shapes:?}");
    let summary = std::fs::read_to_string(here.path().join("out/summary.md")).expect("a summary");
    assert!(summary.contains(" mm bar Aluminium 6061-T6"), "{summary}");
}

#[test]
fn a_study_that_offers_stainless_steel_in_structural_sections_alone_says_so() {
    let profiles = |families: &[&str]| -> Value {
        families
            .iter()
            .map(|f| json!({"profiles": {"family": f, "shapes": ["square"], "max_outer_mm": 60}}))
            .collect()
    };
    let told = |materials: &[&str], families: &[&str]| {
        let choose = json!({"materials": materials, "sections": profiles(families)});
        let here = folder_with("study.json", &study(choose));
        let (code, said) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
        assert_eq!(code, 0, "{said}");
        let run = std::fs::read_to_string(here.path().join("out/run.json")).expect("run.json");
        let run: Value = serde_json::from_str(&run).expect("JSON");
        let mut remarks: Vec<String> = serde_json::from_value(run["remarks"].clone()).expect("a list");
        // the other remark is what every study with gears leaves out
        remarks.retain(|words| words.starts_with("Link "));
        for file in ["summary.md", "report.html"] {
            let text = std::fs::read_to_string(here.path().join("out").join(file)).expect(file);
            assert_eq!(text.contains("offers Stainless"), !remarks.is_empty(), "{file}");
        }
        assert_eq!(said.contains("offers Stainless"), !remarks.is_empty(), "{said}");
        remarks
    };
    let remarks = told(&[STEEL, STAINLESS], &["steel"]);
    assert_eq!(remarks.len(), 1, "{remarks:?}");
    assert!(
        remarks[0].starts_with("Link upper_arm offers Stainless steel 1.4404 (316L) without"),
        "{remarks:?}"
    );
    assert_eq!(told(&[STEEL, STAINLESS], &["steel", "stainless"]), [""; 0]);
    assert_eq!(told(&[STEEL], &["steel"]), [""; 0]);
}

/// Three steel and three aluminium tubes. By kg/m: aluminium 20 x 1, 30 x 1.5, steel 20 x 1, 30 x 1.5, aluminium 50 x 4,
/// steel 50 x 4; the fourth of six is the median. The middle of the list would be the smallest steel tube.
#[test]
fn size_takes_the_section_of_median_mass() {
    let tube = |side: f64, wall: f64| json!({"shape": "rectangular_tube", "width_mm": side, "wall_mm": wall});
    let sections = json!([tube(20.0, 1.0), tube(30.0, 1.5), tube(50.0, 4.0)]);
    let choose = json!({"materials": ["Aluminium 6061-T6", STEEL], "sections": sections});
    let here = folder_with("study.json", &study(choose));
    let (code, said) = armwright(here.path(), &["size", "study.json"]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains(&format!("link upper_arm: {STEEL}, 30 x 30 x 1.5 mm")), "{said}");
}

/// Aluminium 6082-T6 and the stock sizes of aluminium tubes are representative; 6061-T6 was read in a document.
#[test]
fn a_pick_of_a_representative_material_says_so() {
    let profiles = json!([{"profiles": {"family": "aluminium", "max_outer_mm": 60}}]);
    let grid = json!([{"shape": "rectangular_tube", "width_mm": 60, "wall_mm": [2, 3]}]);
    let said_of = |material: &str, sections: &Value| {
        let choose = json!({"materials": [material], "sections": sections});
        let here = folder_with("study.json", &study(choose));
        let (code, said) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
        assert_eq!(code, 0, "{said}");
        let read = |file: &str| std::fs::read_to_string(here.path().join("out").join(file)).expect(file);
        [said.split_whitespace().collect::<Vec<_>>().join(" "), read("summary.md"), read("report.html")]
    };
    let [said, summary, page] = said_of("Aluminium 6082-T6", &profiles);
    assert!(said.contains("Figures not from a document: "), "{said}");
    assert!(said.contains("Aluminium 6082-T6 (representative) in every pick"), "{said}");
    assert!(summary.contains("Aluminium 6082-T6 (representative) (profile representative)"), "{summary}");
    assert!(page.contains("</a> (representative)"), "beside the material of a link");
    let [said, summary, _] = said_of("Aluminium 6061-T6", &grid);
    assert!(!said.contains("6061-T6 (representative)"), "{said}");
    assert!(!summary.contains("6061-T6 (representative)"), "{summary}");
}
