//! Links in the files and messages of the program: thick walls and solid bars, stainless steel, and the section of
//! median mass.

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
fn a_material_for_which_a_link_has_no_section_is_named_with_the_reason() {
    let profiles = |families: &[&str]| -> Value {
        families
            .iter()
            .map(|f| json!({"profiles": {"family": f, "shapes": ["square"], "max_outer_mm": 60}}))
            .collect()
    };
    let of = |materials: &[&str], sections: Value| {
        let choose = json!({"materials": materials, "sections": sections});
        let here = folder_with("study.json", &study(choose));
        let (code, said) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
        assert_eq!(code, 0, "{said}");
        let run = std::fs::read_to_string(here.path().join("out/run.json")).expect("run.json");
        let run: Value = serde_json::from_str(&run).expect("JSON");
        let mut remarks: Vec<String> = serde_json::from_value(run["remarks"].clone()).expect("a list");
        // the other remark is what every study with gears leaves out
        remarks.retain(|words| words.starts_with("Link "));
        let short = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        for file in ["summary.md", "report.html"] {
            let text = std::fs::read_to_string(here.path().join("out").join(file)).expect(file);
            assert_eq!(short(&text).contains("no section to choose from"), !remarks.is_empty(), "{file}");
        }
        assert_eq!(short(&said).contains("no section to choose from"), !remarks.is_empty(), "{said}");
        remarks
    };
    let told = |materials: &[&str], families: &[&str]| of(materials, profiles(families));
    assert_eq!(
        told(&[STEEL, STAINLESS], &["steel"]),
        [
            "Link upper_arm: Stainless steel 1.4404 (316L) has no section to choose from: the steel profiles of the catalog are \
          sold in structural steel only."
        ]
    );
    assert_eq!(
        told(&["Aluminium 6061-T6", STEEL, "Titanium Ti-6Al-4V"], &["steel"]),
        [
            "Link upper_arm: Aluminium 6061-T6, Titanium Ti-6Al-4V have no section to choose from: the steel profiles of the \
          catalog are sold in structural steel only."
        ]
    );
    assert_eq!(
        told(&["Aluminium 6061-T6", STEEL, STAINLESS], &["stainless", "aluminium"]),
        [
            "Link upper_arm: Structural steel S355 has no section to choose from: the aluminium and stainless profiles of the \
          catalog are sold in aluminium and stainless steel only."
        ]
    );
    assert_eq!(told(&[STEEL, STAINLESS], &["steel", "stainless"]), [""; 0]);
    assert_eq!(told(&[STEEL], &["steel"]), [""; 0]);
    // sizes that are no profiles are those of every material
    let mut sizes = profiles(&["steel"]);
    let tube = json!({"shape": "rectangular_tube", "width_mm": 60, "wall_mm": [2, 3]});
    sizes.as_array_mut().expect("a list").push(tube);
    assert_eq!(of(&[STEEL, STAINLESS], sizes), [""; 0]);
}

/// 48.3 mm in metres times 1000 is 48.300000000000004, and a wall of the grid is 2.6 + 0.1 + 0.1 mm.
#[test]
fn a_size_is_written_with_the_digits_that_it_has_and_reads_back() {
    let sections = json!([{"shape": "round_tube", "diameter_mm": [48.3, 60.3],
        "wall_mm": {"from": 2.6, "to": 2.9, "step": 0.1}}, {"profiles": {"family": "steel", "shapes": ["round"], "max_outer_mm": 61}}]);
    let choose = json!({"materials": [STEEL], "sections": sections});
    let here = folder_with("study.json", &study(choose));
    let run = |words: &[&str]| {
        let (code, said) = armwright(here.path(), words);
        assert_eq!(code, 0, "{said}");
        said
    };
    run(&["run", "study.json", "--out", "out"]);
    run(&["front", "check", "out"]);
    let mut front = csv::Reader::from_path(here.path().join("out/front.csv")).expect("a front");
    let header = front.headers().expect("a header").clone();
    let rows: Vec<csv::StringRecord> = front.records().map(|row| row.expect("a row")).collect();
    for (column, _) in
        header.iter().enumerate().filter(|(_, name)| name.ends_with("_mm") && name.starts_with("upper"))
    {
        for row in &rows {
            assert!(row[column].len() <= 5, "{}: {}", &header[column], &row[column]);
        }
    }
    let column = |name: &str| header.iter().position(|c| c == name).expect("the column");
    let number = |text: &str| text.parse::<f64>().expect("a number");
    for row in &rows {
        // the arm of the design has the very size, and the objectives of the row
        let said = run(&["design", "out", &row[0], "--out", "arm"]);
        let arm = std::fs::read_to_string(here.path().join("arm/arm.json")).expect("an arm");
        let section = serde_json::from_str::<Value>(&arm).expect("JSON")["chain"][1]["section"].clone();
        let diameter_mm = number(&row[column("upper_arm_width_mm")]);
        assert!((1e3 * section["diameter_m"].as_f64().expect("round") - diameter_mm).abs() < 1e-9);
        let mass = format!("mass {:.3} kg", number(&row[column("mass_kg")]));
        assert!(said.contains(&mass), "{mass}: {said}");
    }
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
    assert!(said.contains("Figures not seen in a document of the vendor: "), "{said}");
    assert!(said.contains("Aluminium 6082-T6 (representative) in every pick"), "{said}");
    assert!(summary.contains("Aluminium 6082-T6 (representative) (profile representative)"), "{summary}");
    assert!(page.contains("</a> (representative)"), "beside the material of a link");
    let [said, summary, _] = said_of("Aluminium 6061-T6", &grid);
    assert!(!said.contains("6061-T6 (representative)"), "{said}");
    assert!(!summary.contains("6061-T6 (representative)"), "{summary}");
}

/// A rigid joint with a link of this section, 0.6 m long, without gravity; its tip under 100 N downwards and 100 N along y.
fn cantilever_m(link: Value, catalogs: Option<(&str, &str)>) -> ([f64; 2], f64, String) {
    let mut link = link;
    link["type"] = json!("link");
    link["name"] = json!("arm");
    link["vector_m"] = json!([0.6, 0, 0]);
    let steel = json!({"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850});
    let arm = json!({"name": "arm", "gravity_m_s2": 0, "materials": {"steel": steel}, "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": null}, link]});
    let here = folder_with("arm.json", &arm);
    let mut words = vec!["analyze", "arm.json", "--force-n", "0,100,-100"];
    if let Some((name, rows)) = catalogs {
        std::fs::create_dir(here.path().join("p")).expect("a folder");
        std::fs::write(here.path().join("p").join(name), rows).expect("written");
        words.extend(["--catalogs", "p"]);
    }
    let (code, text) = armwright(here.path(), &words);
    assert_eq!(code, 0, "{text}");
    words.push("--json");
    let (_, said) = armwright(here.path(), &words);
    let case: Value = serde_json::from_str(&said).expect("JSON");
    let tip = |i: usize| case["tip_displacement_m"][i].as_f64().expect("a number");
    let hz = case["modes"][0]["frequency_hz"].as_f64().expect("a number");
    ([tip(1), -tip(2)], hz, text)
}

#[test]
fn a_section_by_its_stiffnesses_bends_and_vibrates_as_a_cantilever_of_them() {
    let section = json!({"shape": "stated", "width_m": 0.05, "height_m": 0.08, "ei_y_nm2": 3e4, "ei_z_nm2": 2e4,
        "gj_nm2": 1e4, "kg_per_m": 2.5});
    let ([y_m, z_m], hz, _) = cantilever_m(json!({"section": section}), None);
    let by_hand = |ei: f64| 100.0 * 0.6f64.powi(3) / (3.0 * ei);
    assert!((z_m / by_hand(3e4) - 1.0).abs() < 1e-9, "{z_m}");
    assert!((y_m / by_hand(2e4) - 1.0).abs() < 1e-9, "{y_m}");
    // 1.8751 for the first mode of a cantilever, less what its rotary inertia takes: half of 4.648 (r/L)², with
    // r² = EIz / EA, and EA that of an even outline (Rayleigh's quotient)
    let thin_hz = 1.875_104f64.powi(2) * (2e4 / 2.5f64).sqrt() / (0.6 * 0.6) / (2.0 * PI);
    let ea_n = 12.0 * (3e4 + 2e4) / (0.05f64.powi(2) + 0.08f64.powi(2));
    let mode_hz = thin_hz * (1.0 - 0.5 * 4.648 * (2e4 / ea_n) / (0.6 * 0.6));
    assert!((hz / mode_hz - 1.0).abs() < 3e-4, "{hz}, by hand {mode_hz}");
    let with_material = json!({"material": "steel", "section": {"shape": "stated", "width_m": 0.05, "height_m": 0.08,
        "ei_y_nm2": 3e4, "ei_z_nm2": 2e4, "gj_nm2": 1e4, "kg_per_m": 2.5}});
    let arm = json!({"name": "a", "chain": [{"type": "link", "name": "l", "vector_m": [1, 0, 0],
        "material": with_material["material"], "section": with_material["section"]}]});
    let (code, said) = armwright(folder_with("a.json", &arm).path(), &["analyze", "a.json"]);
    assert!(code == 3 && said.contains("stands beside a section of stated stiffness"), "{said}");
}

#[test]
fn an_i_section_bends_about_both_axes_as_a_beam_with_shear() {
    let section =
        json!({"shape": "i_beam", "width_m": 0.05, "height_m": 0.1, "web_m": 0.004, "flange_m": 0.006});
    let ([y_m, z_m], ..) = cantilever_m(json!({"material": "steel", "section": section}), None);
    let (b, h, web, flange) = (0.05f64, 0.1f64, 0.004, 0.006);
    let (clear, area) = (h - 2.0 * flange, 2.0 * b * flange + (h - 2.0 * flange) * web);
    let iy = 2.0 * (b * flange.powi(3) / 12.0 + b * flange * ((h - flange) / 2.0).powi(2))
        + web * clear.powi(3) / 12.0;
    let iz = 2.0 * flange * b.powi(3) / 12.0 + clear * web.powi(3) / 12.0;
    let bending = |i: f64| 100.0 * 0.6f64.powi(3) / (3.0 * 2.1e11 * i);
    // shear in the web alone is more than Cowper's, whole area less
    let shear = |area_m2: f64| 100.0 * 0.6 / (8.1e10 * area_m2);
    let web_m2 = (h - flange) * web;
    assert!(z_m > bending(iy) + shear(area) && z_m < bending(iy) + 1.5 * shear(web_m2), "{z_m}");
    assert!((0.0..0.02).contains(&(y_m / bending(iz) - 1.0)), "{y_m}");
}

#[test]
fn a_printed_link_is_taken_and_said_to_creep() {
    let rows = "name,class,e_pa,g_pa,density_kg_m3,poisson,yield_or_strength_pa,source,confidence\n\
        PETG printed,polymer,2.0e9,0.73e9,1270,0.38,4e7,filament sheet,third party\n";
    let section = json!({"shape": "round_tube", "diameter_m": 0.06, "wall_m": 0.005});
    let ([_, z_m], _, text) =
        cantilever_m(json!({"material": "PETG printed", "section": section}), Some(("materials.csv", rows)));
    let i = PI / 64.0 * (0.06f64.powi(4) - 0.05f64.powi(4));
    let bending = 100.0 * 0.6f64.powi(3) / (3.0 * 2.0e9 * i);
    assert!((0.0..0.03).contains(&(z_m / bending - 1.0)), "{z_m}, bending alone {bending}");
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("PETG printed (polymer) in arm: it creeps"), "{words}");
}
