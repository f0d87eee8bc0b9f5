//! Effects of unusual size, links that differ from the drawing, and wrong readings together with an effect.

use crate::generator::{self, Dice, Plan, Specimen};
use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::reconcile;
use armwright::reconcile::{Outcome, Verdict};
use serde_json::{Value, json};

/// A campaign of a six-axis arm with what is hidden in it; the drawing says what `redrawn` makes of the arm.
fn campaign(seed: u64, hidden: &[Value], redrawn: impl Fn(&mut Value)) -> tempfile::TempDir {
    let out = tempfile::tempdir().expect("temporary folder");
    let mut dice = Dice(seed);
    let specimen = Specimen::six_axis(&mut dice);
    let key = out.path().join("key.json");
    let plan = Plan { static_poses: 20, modal_poses: 8, ..Plan::plain() };
    generator::write(&mut dice, &out.path().join("c"), &key, &specimen, hidden, &plan);
    let mut arm = specimen.arm.clone();
    redrawn(&mut arm);
    std::fs::write(out.path().join("c/arm.json"), arm.to_string()).expect("written");
    out
}

fn outcome(folder: &tempfile::TempDir) -> Outcome {
    reconcile(&Campaign::read(&folder.path().join("c"), &Catalogs::default()).expect("sound"))
}

fn effect(name: &str, at: &str, parameters: Value) -> Value {
    json!({"effect": name, "at": at, "parameters": parameters})
}

/// Edits the rows of a file, cell by cell; a row that is nothing afterwards is left out.
fn edit(folder: &tempfile::TempDir, file: &str, change: impl Fn(&mut Vec<String>) -> bool) {
    let path = folder.path().join("c").join(file);
    let text = std::fs::read_to_string(&path).expect("text");
    let rows = text.lines().enumerate().filter_map(|(line, row)| {
        let mut cells: Vec<String> = row.split(',').map(String::from).collect();
        (line == 0 || change(&mut cells)).then(|| cells.join(","))
    });
    std::fs::write(&path, rows.collect::<Vec<_>>().join("\n")).expect("written");
}

#[test]
fn an_effect_is_named_however_large_a_part_makes_it() {
    for (hidden, size) in [
        (effect("extra_mass", "j3", json!({"delta_kg": 40.0})), 40.0),
        (effect("extra_mass", "j3", json!({"delta_kg": -8.0})), -8.0),
        (effect("harness_mass", "forearm", json!({"kg_per_m": 55.0})), 55.0),
        (effect("connection_compliance", "j5", json!({"stiffness_nm_per_rad": 5e3})), 5e3),
        (effect("sensor_gain", "static", json!({"gain": 1.9})), 1.9),
    ] {
        let outcome = outcome(&campaign(5, std::slice::from_ref(&hidden), |_| ()));
        assert_eq!(outcome.verdict, Verdict::Explained, "{hidden}: {}", outcome.to_text());
        let label = format!("{}@{}", hidden["effect"].as_str().unwrap(), hidden["at"].as_str().unwrap());
        assert_eq!(outcome.effects[0].label(), label, "{}", outcome.to_text());
        let estimate = &outcome.effects[0].parameters[0].1[0];
        assert!((estimate.value / size - 1.0).abs() < 0.06, "{hidden}: {}", outcome.to_text());
    }
}

#[test]
fn a_size_at_the_limit_of_what_is_looked_for_is_said() {
    let folder = campaign(5, &[effect("extra_mass", "j3", json!({"delta_kg": 100.0}))], |_| ());
    let outcome = outcome(&folder);
    assert_ne!(outcome.verdict, Verdict::NoGap);
    assert!(
        outcome.reasons.iter().any(|r| r.contains("is the largest that is looked for")),
        "{}",
        outcome.to_text()
    );
}

#[test]
fn a_link_with_less_mass_or_a_thinner_wall_than_drawn_is_no_effect_of_the_library() {
    const UPPER_ARM: usize = 3;
    let thicker = |arm: &mut Value| {
        let wall = &mut arm["chain"][UPPER_ARM]["section"]["wall_m"];
        *wall = json!(1.25 * wall.as_f64().expect("wall"));
    };
    let heavier = |arm: &mut Value| {
        let name = arm["chain"][UPPER_ARM]["material"].as_str().expect("name").to_string();
        let mut material = arm["materials"][&name].clone();
        material["density_kg_m3"] = json!(1.5 * material["density_kg_m3"].as_f64().expect("density"));
        arm["materials"]["heavier"] = material;
        arm["chain"][UPPER_ARM]["material"] = json!("heavier");
    };
    for (what, redrawn) in [("wall", &thicker as &dyn Fn(&mut Value)), ("mass", &heavier)] {
        let outcome = outcome(&campaign(6, &[], redrawn));
        println!("{}", outcome.to_text());
        assert_eq!(outcome.verdict, Verdict::Unexplained, "{what}: {}", outcome.to_text());
        let said =
            outcome.reasons.iter().any(|r| r.contains(&format!("{what} of upper_arm other than drawn")));
        assert!(said, "{what}: {}", outcome.to_text());
    }
}

/// Leaves a mode out of lists, and numbers those above it down.
fn without_mode(cells: &mut [String], mode: usize, lists: &[&str]) -> bool {
    let own: usize = cells[11].parse().expect("number of a mode");
    if lists.contains(&cells[0].as_str()) && own > mode {
        cells[11] = (own - 1).to_string();
    }
    !lists.contains(&cells[0].as_str()) || own != mode
}

#[test]
fn modes_missing_from_lists_are_found_on_a_right_arm_and_beside_an_effect() {
    let soft = effect("connection_compliance", "j3", json!({"stiffness_nm_per_rad": 4e5}));
    let tilt = effect("bearing_tilt", "j2", json!({"stiffness_nm_per_rad": 6e5}));
    for (seed, hidden, kept, mode, lists) in [
        (7, vec![], 16, 2, ["3", "10"].as_slice()),
        (7, vec![soft], 16, 2, &["3", "10"]),
        (4, vec![tilt], 6, 1, &["2"]),
    ] {
        let folder = campaign(seed, &hidden, |_| ());
        edit(&folder, "modal.csv", |cells| cells[0].parse::<usize>().expect("list") <= kept);
        edit(&folder, "modal.csv", |cells| without_mode(cells, mode, lists));
        let outcome = outcome(&folder);
        println!("{}", outcome.to_text());
        let labels: Vec<String> = outcome.effects.iter().map(|e| e.label()).collect();
        let name = |e: &Value| format!("{}@{}", e["effect"].as_str().unwrap(), e["at"].as_str().unwrap());
        assert_eq!(labels, hidden.iter().map(name).collect::<Vec<_>>(), "{}", outcome.to_text());
        assert_eq!(outcome.verdict == Verdict::NoGap, hidden.is_empty(), "{}", outcome.to_text());
        for list in lists {
            let said = format!("mode {mode} appears to be missing from list {list}");
            assert!(outcome.reasons.iter().any(|r| r.contains(&said)), "{}", outcome.to_text());
        }
    }
}

/// Puts a slip of so many standard deviations on one frequency.
fn slip(cells: &mut [String], list: &str, mode: &str, sigmas: f64) -> bool {
    if cells[0] == list && cells[11] == mode {
        let number = |cell: &str| cell.parse::<f64>().expect("number");
        cells[12] = format!("{:.4}", number(&cells[12]) + sigmas * number(&cells[13]));
    }
    true
}

#[test]
fn a_slip_among_the_frequencies_is_no_further_effect_and_no_unknown_physics() {
    let gain = effect("sensor_gain", "modal", json!({"gain": 1.02}));
    for hidden in [vec![], vec![gain]] {
        for (mode, sigmas) in [("1", -9.0), ("4", 30.0), ("2", 15.0)] {
            let folder = campaign(8, &hidden, |_| ());
            edit(&folder, "modal.csv", |cells| cells[0].parse::<usize>().expect("list") < 5);
            edit(&folder, "modal.csv", |cells| slip(cells, "2", mode, sigmas));
            let outcome = outcome(&folder);
            println!("{}", outcome.to_text());
            let labels: Vec<String> = outcome.effects.iter().map(|e| e.label()).collect();
            match hidden.is_empty() {
                true => assert_eq!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text()),
                false => assert_eq!(labels, ["sensor_gain@modal"], "{}", outcome.to_text()),
            }
            assert!(outcome.to_text().contains("gross error: modal row"), "{}", outcome.to_text());
        }
    }
}

#[test]
fn a_frequency_off_beyond_its_neighbour_is_a_gross_error_and_no_wrong_order() {
    let folder = campaign(8, &[], |_| ());
    edit(&folder, "modal.csv", |cells| slip(cells, "2", "2", 150.0));
    let path = folder.path().join("c/modal.csv");
    let text = std::fs::read_to_string(path).expect("text");
    let hz = |mode: &str| -> f64 {
        let row = text.lines().find(|l| l.starts_with("2,") && l.split(',').nth(11) == Some(mode));
        row.expect("the row").split(',').nth(12).expect("cell").parse().expect("number")
    };
    assert!(hz("2") > 1.05 * hz("3"), "beyond its neighbour: {} {}", hz("2"), hz("3"));
    let outcome = outcome(&folder);
    assert_eq!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text());
    assert!(outcome.reasons.iter().all(|r| !r.contains("put in order")), "{}", outcome.to_text());
    assert!(outcome.to_text().contains("gross error: modal row 6"), "{}", outcome.to_text());
}

#[test]
fn deviations_declared_a_quarter_too_small_are_no_gap() {
    let folder = campaign(9, &[], |_| ());
    for (file, column) in [("static.csv", 18), ("modal.csv", 13), ("windup.csv", 5)] {
        edit(&folder, file, |cells| {
            cells[column] = format!("{:.6}", cells[column].parse::<f64>().expect("number") / 1.3);
            true
        });
    }
    let outcome = outcome(&folder);
    assert_eq!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text());
}

#[test]
fn an_effect_of_strong_evidence_is_named_and_one_of_weak_evidence_is_a_suspect() {
    let mut said = [false; 2];
    for gain in [1.02, 1.011, 1.01, 1.009, 1.008, 1.007, 1.006, 1.005] {
        let outcome =
            outcome(&campaign(10, &[effect("sensor_gain", "static", json!({"gain": gain}))], |_| ()));
        let after =
            |text: &str| text.split("the evidence rises by ").nth(1)?.split(' ').next()?.parse::<f64>().ok();
        let Some(rise) = outcome.reasons.iter().find_map(|r| after(r)) else { continue };
        println!("{gain} {rise}");
        let is_named = outcome.verdict == Verdict::Explained;
        assert_eq!(is_named, rise >= 3.0, "{}", outcome.to_text());
        assert_eq!(outcome.suspects.is_empty(), is_named, "{}", outcome.to_text());
        said[usize::from(is_named)] = true;
    }
    assert_eq!(said, [true, true]);
}
