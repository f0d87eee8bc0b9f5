//! Exports of arms that are unusual and sound: a passive joint inboard of its driver, and springs that are rigid about
//! one axis.

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Exports an arm to a format, in a folder of its own. Gives the record and the folder of the files.
fn export(folder: &Path, arm: &Value, format: &str) -> (Value, PathBuf) {
    let [file, out] = ["arm-file.json", format].map(|name| folder.join(name));
    fs::write(&file, arm.to_string()).expect("written");
    let output = Command::new(env!("CARGO_BIN_EXE_armwright"))
        .args(["export", "--to", format])
        .args([&file, &PathBuf::from("--out"), &out])
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{format}: {}", String::from_utf8_lossy(&output.stderr));
    (serde_json::from_str(&text(&out, "export.json")).expect("JSON"), out)
}

fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-9 * expected.abs(), "{found} and not {expected}");
}

/// The numbers of a line of a deck.
fn numbers(line: &str) -> Vec<f64> {
    line.split(',').map(|number| number.trim().parse().expect("a number")).collect()
}

/// Angle of the single hinge of a static deck \[rad\], and the displacement of the tip along z \[m\]. Every node moves
/// with the hinge by the coefficient of its equation, so the angle is the work of the loads per unit of it, divided by
/// the stiffness of the hinge.
fn solved_by_hand(deck: &str, stiffness_nm_per_rad: f64) -> (f64, f64) {
    let equations: Vec<Vec<f64>> =
        deck.split("*EQUATION\n").skip(1).filter_map(|after| after.lines().nth(1)).map(numbers).collect();
    let hinge = equations[0][3];
    assert!(equations.iter().all(|terms| terms.len() == 6 && terms[3] == hinge), "one hinge: {deck}");
    let moves = |node: f64, direction: f64| {
        let own = equations.iter().find(|terms| terms[0] == node && terms[1] == direction);
        own.map_or(0.0, |terms| -terms[5] / terms[2])
    };
    let loads =
        deck.split("*CLOAD\n").nth(1).expect("loads").lines().take_while(|line| !line.starts_with('*'));
    let work: f64 = loads.map(numbers).map(|load| load[2] * moves(load[0], load[1])).sum();
    let tip = deck.split("NSET=TIP\n").nth(1).and_then(|after| after.lines().next()).expect("a tip");
    let angle_rad = work / stiffness_nm_per_rad;
    (angle_rad, angle_rad * moves(tip.parse().expect("a node"), 3.0))
}

/// The joint `lead` at the base turns by half the angle of the joint `late`, which is 1 m outboard of it.
fn driver_outboard() -> Value {
    json!({"name": "driver outboard", "chain": [
        {"type": "joint", "name": "lead", "axis": [0, 1, 0], "stiffness_nm_per_rad": null, "coupled": {"late": 0.5}},
        {"type": "link", "name": "upper", "vector_m": [1, 0, 0], "mass_kg": 2},
        {"type": "joint", "name": "late", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
        {"type": "link", "name": "hand", "vector_m": [0.5, 0, 0], "mass_kg": 3}]})
}

#[test]
fn a_passive_joint_inboard_of_its_driver_follows_it_in_a_deck() {
    let folder = tempfile::tempdir().expect("a folder");
    let (record, out) = export(folder.path(), &driver_outboard(), "calculix");
    // per radian of `late`: the middle of the upper link falls by 0.5 x 0.5 m, that of the hand by 0.5 x 1.25 m + 0.25 m,
    // the tip by 0.5 x 1.5 m + 0.5 m
    let work_nm = 9.81 * (2.0 * 0.25 + 3.0 * 0.875);
    let tip_m = -1.25 * work_nm / 1e4;
    close(record["expected"]["tip_displacement_m"][2].as_f64().expect("m"), tip_m);
    let (angle_rad, found_m) = solved_by_hand(&text(&out, "static.inp"), 1e4);
    close(angle_rad, work_nm / 1e4);
    close(found_m, tip_m);
    assert_eq!(record["left_out"], json!([]));
}

/// A lever of 2 m with 10 kg in its middle, on a base whose feet lift off beyond 50 N m: about one axis they do, about
/// the other they stay.
fn lifting_base() -> Value {
    json!({"name": "lifting", "effects": [
        {"effect": "base_lift", "at": "base", "parameters": {"stiffness_nm_per_rad": 5e5, "preload_nm": 50}}], "chain": [
        {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5},
        {"type": "link", "name": "l", "vector_m": [2, 0, 0], "mass_kg": 10}]})
}

#[test]
fn a_base_that_lifts_off_about_one_axis_has_one_hinge() {
    let folder = tempfile::tempdir().expect("a folder");
    let (record, out) = export(folder.path(), &lifting_base(), "mjcf");
    let xml = text(&out, "arm.xml");
    let of = |line: &str, key: &str| -> f64 {
        let after = line.split(&format!(" {key}=\"")).nth(1).unwrap_or_else(|| panic!("no {key} in {line}"));
        after.split('"').next().and_then(|value| value.parse().ok()).expect("a number")
    };
    let of_base: Vec<&str> = xml.lines().filter(|line| line.contains("<joint name=\"base")).collect();
    assert_eq!(of_base.len(), 1, "{xml}");
    close(of(of_base[0], "stiffness"), 5e5);
    // the spring deflects by what is beyond the preload, so without load it would stand at the preload on the other side
    close(of(of_base[0], "springref").abs(), 50.0 / 5e5);
    let tip_m = -2.0 * (98.1 / 1e5 + 48.1 / 5e5);
    close(record["expected"]["tip_displacement_m"][2].as_f64().expect("m"), tip_m);
    let option = xml.lines().find(|line| line.contains("timestep")).expect("options");
    // the spring of the base vibrates fast, because only the lever's inertia about its axis turns with it
    assert!((1e-8..1e-3).contains(&of(option, "timestep")), "{option}");
}

#[test]
fn no_export_has_a_number_that_is_infinite_or_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut pressed = lifting_base();
    pressed["effects"][0]["parameters"]["preload_nm"] = json!(1e3);
    let slide = |guide: Value| {
        json!({"name": "slide", "chain": [
            {"type": "prismatic", "name": "s", "axis": [0, 0, 1], "stiffness_n_per_m": null, "guide": guide},
            {"type": "link", "name": "l", "vector_m": [0.5, 0, 0], "mass_kg": 2}]})
    };
    let frame = json!({"name": "frame", "effects": [{"effect": "frame_compliance", "at": "base", "parameters":
            {"diagonal_rad_per_nm": [0, 2e-6, 0], "coupling_rad_per_nm": [0, 0, 0]}}], "chain": [
        {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": null},
        {"type": "link", "name": "l", "vector_m": [1, 0, 0], "mass_kg": 5}]});
    let arms = [
        driver_outboard(),
        lifting_base(),
        pressed,
        slide(json!({})),
        slide(json!({"pitch_nm_per_rad": 1e5})),
        frame,
    ];
    for (arm, format) in arms
        .iter()
        .flat_map(|arm| ["calculix", "mjcf", "urdf", "json", "csv", "bom"].map(|format| (arm, format)))
    {
        // decks have nothing that slides
        if arm["name"] == "slide" && format == "calculix" {
            continue;
        }
        let (_, out) = export(folder.path(), arm, format);
        for file in fs::read_dir(&out).expect("a folder") {
            let path = file.expect("a file").path();
            if path.is_dir() {
                continue;
            }
            let content = fs::read_to_string(&path).expect("text").to_lowercase();
            let mut words = content.split(|c: char| !c.is_alphanumeric());
            let odd = words.find(|word| matches!(*word, "inf" | "infinity" | "nan"));
            assert_eq!(odd, None, "{}: {}", arm["name"], path.display());
        }
        fs::remove_dir_all(&out).expect("removed");
    }
}
