//! Drives of equal mass and curve are one option of the exact search: every one of them that holds is listed all the same.

use crate::dice::Dice;
use crate::exact_support::{agree, read, write_listed};
use armwright::catalog::Catalogs;
use armwright::exact::Exact;
use armwright::search::Sweep;
use armwright::space::ArmProblem;
use serde_json::{Value, json};
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::process::Command;
use std::sync::atomic::AtomicBool;

/// Two joints that may have all ratios of both series. What holds is now the motor, which asks for a high ratio, now
/// the gear's life or its speed, which ask for a low one: of drives that weigh and twist alike some hold.
fn study_of_ties(seed: u64) -> Value {
    let dice = &mut Dice(seed);
    let motors = ["ILM50x14", "ILM70x10", "ILM70x18", "ILM85x26", "MF0060008 48V", "MF0076008 48V"];
    let drives = |dice: &mut Dice| {
        let kept: Vec<&str> = motors.iter().copied().filter(|_| dice.below(2) == 0).collect();
        json!({"gear_series": ["CSG", "HFUC"], "ratios": [50, 80, 100, 120, 160],
            "motor_models": if kept.len() < 2 { &motors[2..4] } else { &kept[..] }})
    };
    let open = |name: &str, drives: Value| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "drive": "all_fits", "drives": drives});
    let chain = json!([
        open("shoulder", drives(dice)),
        {"type": "link", "name": "upper_arm", "vector_m": [dice.within(0.3, 0.8), 0, 0],
            "choose": {"materials": ["Structural steel S355", "Aluminium 6061-T6"], "sections":
                [{"shape": "rectangular_tube", "width_mm": [60, 90, 120], "wall_mm": [2, 4]}]}},
        open("elbow", drives(dice)),
        {"type": "link", "name": "forearm", "vector_m": [dice.within(0.2, 0.5), 0, 0], "mass_kg": 1}]);
    let mut study = json!({"name": format!("ties-{seed}"), "chain": chain,
        "poses": [{"pose_deg": [0, 0]}, {"pose_deg": [-40, dice.of(&[80, 150])]}],
        "payload": {"mass_kg": dice.within(0.5, 8.0), "cg_m": [0.03, 0, 0.02]},
        "motion": {"tip_speed_m_s": dice.within(0.5, 1.5), "ramp_time_s": 0.2, "life_h": dice.of(&[5000, 20000])},
        "drives": {"gear_mass": dice.of(&["housed_unit", "component_set"])}});
    // a component set has no bearing of its own
    if study["drives"]["gear_mass"] == "component_set" {
        for joint in [0, 2] {
            study["chain"][joint]["bearing"] = Value::Null;
        }
    }
    study
}

#[test]
fn every_tie_of_drives_that_weigh_and_twist_alike_is_listed() {
    let catalogs = Catalogs::builtin();
    let (mut designs, mut points) = (0, 0);
    for seed in 0..3 {
        let text = study_of_ties(seed);
        designs += agree(&text, seed % 2 == 0);
        let study = read(&text, &catalogs);
        let sweep = Sweep::new(
            &ArmProblem::new(&study.space, &catalogs),
            study.space.constraints,
            &AtomicBool::new(false),
        )
        .run();
        let of = |o: [f64; 3]| o.map(|x| (x.abs().ln() * 1e7).round() as i64);
        points += sweep.front.iter().map(|c| of(c.objectives.minimized())).collect::<BTreeSet<_>>().len();
    }
    println!("{designs} designs of {points} points, the same in both");
    assert!(points > 90 && designs > 2 * points, "{designs} designs of {points} points");
}

#[test]
fn ties_that_are_too_many_to_list_have_one_design_each_that_holds() {
    let catalogs = Catalogs::builtin();
    let stop = AtomicBool::new(false);
    let study = read(&study_of_ties(3), &catalogs);
    let search = || Exact::new(&study.space, &catalogs, &stop, None);
    let (all, few) = (search().run(&[]), search().with_ties_up_to(0).run(&[]));
    assert!(all.ties_listed && !few.ties_listed);
    assert!(few.front.len() < all.front.len(), "{} of {}", few.front.len(), all.front.len());
    let point =
        |o: &armwright::pareto::Objectives| o.minimized().map(|x| (x.abs().ln() * 1e8).round() as i64);
    let points: BTreeSet<[i64; 3]> = all.front.iter().map(|c| point(&c.objectives)).collect();
    assert_eq!(points, few.front.iter().map(|c| point(&c.objectives)).collect());
    assert!(few.front.iter().all(|c| all.front.iter().any(|other| other.number == c.number)));
}

#[test]
fn a_search_to_a_gap_lists_fewer_designs_and_none_is_better_by_more() {
    let catalogs = Catalogs::builtin();
    let stop = AtomicBool::new(false);
    let mut fewer = 0;
    for seed in 0..6 {
        let study = read(&study_of_ties(seed), &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let sweep = Sweep::new(&problem, study.space.constraints, &stop).run();
        for regions_from in [100.0, 1e14] {
            let search = Exact::new(&study.space, &catalogs, &stop, None).by_regions_from(regions_from);
            let found = search.to_gap(0.05).run(&[]);
            assert_eq!((found.boxes_open, found.gap), (0, Some(0.05)));
            let listed: Vec<[f64; 3]> = found.front.iter().map(|c| c.objectives.minimized()).collect();
            for there_is in &sweep.front {
                let [kg, m, minus_hz] = there_is.objectives.minimized();
                let is_close = |o: &[f64; 3]| {
                    let by = 1.05 * (1.0 + 1e-9);
                    o[0] <= by * kg && o[1] <= by * m && by * o[2] <= minus_hz
                };
                assert!(listed.iter().any(is_close), "seed {seed}: {there_is:?}");
            }
            fewer += usize::from(found.front.len() < sweep.front.len());
        }
    }
    assert!(fewer > 6, "a gap of 5 % saves designs in {fewer} of 12 searches only");
}

fn armwright(words: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_armwright")).args(words).output().expect("runs");
    let text = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
    (output.status.code().unwrap_or(-1), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// A table as maps from column to cell.
fn rows(path: &Path) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

/// A wrist of three coaxial joints: their drives tie in thousands of ways.
fn study_of_a_wrist() -> Value {
    let joint = |name: &str, axis: [u32; 3]| json!({"type": "joint", "name": name, "axis": axis, "drive": "all_fits"});
    json!({"name": "wrist", "chain": [
        joint("shoulder", [0, 1, 0]),
        {"type": "link", "name": "arm", "vector_m": [0.4, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "round_tube", "diameter_mm": [50, 60, 70, 80, 90], "wall_mm": [1, 2, 4]}]}},
        joint("roll", [1, 0, 0]), joint("pitch", [0, 1, 0]), joint("twist", [1, 0, 0]),
        {"type": "link", "name": "flange", "vector_m": [0.05, 0, 0]}],
        "payload": {"mass_kg": 2, "cg_m": [0, 0, 0.05]}, "poses": [{"pose_deg": [0, 0, 0, 0]}],
        "drives": {"gear_series": ["CSG", "HFUC"], "ratios": [80, 100, 120, 160],
            "motor_models": ["ILM50x14", "ILM70x18", "MF0060008 48V"]}})
}

#[test]
fn ties_too_many_for_the_front_are_listed_beside_it_and_hold() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    std::fs::write(at("wrist.json"), study_of_a_wrist().to_string()).expect("written");
    let [study, out] = [at("wrist.json"), at("out")].map(|p| p.to_string_lossy().into_owned());
    let (code, text) = armwright(&["run", &study, "--search", "exact", "--out", &out]);
    assert_eq!(code, 0, "{text}");
    let front = rows(&at("out/front.csv"));
    let count = format!("The {} rows of the front stand for ", front.len());
    let stands_for = text.split(&count).nth(1).expect("says so").split(' ').next().expect("a number");
    let stands_for: f64 = stands_for.replace(',', "").parse().expect("a number");
    assert!(stands_for > 20_000.0, "{stands_for}");
    // one row a point, its ties in the other file
    let points: BTreeSet<[&str; 3]> = front
        .iter()
        .map(|row| ["mass_kg", "tip_deflection_mm", "lowest_mode_hz"].map(|name| row[name].as_str()))
        .collect();
    let ties = rows(&at("out/ties.csv"));
    let mut all = 0.0;
    for row in &front {
        let of_row = ties.iter().filter(|tie| tie["design_id"] == row["design_id"]);
        all += of_row.map(|tie| 1.0 + tie["instead"].split("; ").count() as f64).product::<f64>();
    }
    assert_eq!(all, stands_for);
    assert!(points.len() * 10 > front.len() * 9, "{} points in {} rows", points.len(), front.len());
    // the check finds the ties and does not call them missing
    let (code, text) = armwright(&["front", "check", &out]);
    assert_eq!(code, 0, "{text}");
    assert!(
        text.contains("no design is missing") && text.contains("that the exact search does not use"),
        "{text}"
    );

    // a tie left out, a drive that is none put in, the file not there
    let listed = std::fs::read_to_string(at("out/ties.csv")).expect("ties.csv");
    let other = listed.replacen("; ", "; another drive; ", 1);
    let fewer: String =
        listed.lines().take(1).chain(listed.lines().skip(2)).map(|l| format!("{l}\n")).collect();
    for (tampered, said) in [(other, "may not be"), (fewer, "may be"), (String::new(), "its columns are")] {
        write_listed(&at("out"), "ties.csv", &tampered);
        let (code, text) = armwright(&["front", "check", &out]);
        assert!(code == 9 && text.contains("ties.csv") && text.contains(said), "{said}: {text}");
    }
    write_listed(&at("out"), "ties.csv", &listed);

    // a front that says that its ties are rows of it, and one that lacks a row, are found out
    let file = at("out/run.json");
    let run: Value = serde_json::from_str(&std::fs::read_to_string(&file).expect("run.json")).expect("JSON");
    assert_eq!(run["ties_listed"], json!(false));
    for material in run["materials"].as_array().expect("materials") {
        let ties = at(&format!("out/ties.{}.csv", material["slug"].as_str().expect("a slug")));
        assert_eq!(ties.exists(), material["ties_listed"] == json!(false), "{material}");
    }
    let with = |key: &str, value: Value| {
        let mut changed = run.clone();
        changed[key] = value;
        std::fs::write(&file, changed.to_string()).expect("written");
    };
    with("ties_listed", json!(true));
    let (code, text) = armwright(&["front", "check", &out]);
    assert_eq!(code, 9, "{text}");
    assert!(text.contains("belongs on the front and is not there"), "{text}");
    let whole = std::fs::read_to_string(at("out/front.csv")).expect("front.csv");
    let mut lines: Vec<&str> = whole.lines().collect();
    let dropped = lines.remove(lines.len() / 2);
    with("front_size", json!(front.len() - 1));
    write_listed(&at("out"), "front.csv", &(lines.join("\n") + "\n"));
    let (code, text) = armwright(&["front", "check", &out]);
    assert_eq!(code, 9, "{text}");
    assert!(text.contains("belongs on the front and is not there"), "{dropped}: {text}");
    write_listed(&at("out"), "front.csv", &whole);

    // two drives that ties.csv names, put in by a study that has no other at these joints, leave the objectives
    let of_design =
        |id: &str, joint: &str| ties.iter().find(|tie| tie["design_id"] == id && tie["at"] == joint);
    let has_both = |row: &&HashMap<String, String>| {
        ["pitch", "roll"].iter().all(|joint| of_design(&row["design_id"], joint).is_some())
    };
    let row = front.iter().find(has_both).expect("a design with ties at two joints");
    let mut swapped = study_of_a_wrist();
    for joint in ["shoulder", "roll", "pitch", "twist"] {
        let other = of_design(&row["design_id"], joint).filter(|_| ["roll", "pitch"].contains(&joint));
        let (gear, motor) = match other {
            Some(tie) => {
                tie["instead"].split("; ").next().and_then(|drive| drive.split_once(" + ")).expect("a drive")
            }
            None => (row[&format!("{joint}_gear")].as_str(), row[&format!("{joint}_motor")].as_str()),
        };
        let pieces = swapped["chain"].as_array_mut().expect("a chain");
        let piece = pieces.iter_mut().find(|piece| piece["name"] == joint).expect("the joint");
        piece["drives"] = json!({"gears": [gear], "motor_models": [motor]});
    }
    std::fs::write(at("swapped.json"), swapped.to_string()).expect("written");
    let [study, out] = [at("swapped.json"), at("swapped")].map(|p| p.to_string_lossy().into_owned());
    let (code, text) = armwright(&["run", &study, "--out", &out]);
    assert_eq!(code, 0, "{text}");
    let objectives = |row: &HashMap<String, String>| -> [f64; 3] {
        ["mass_kg", "tip_deflection_mm", "lowest_mode_hz"].map(|name| row[name].parse().expect("a number"))
    };
    let is_it = |other: &HashMap<String, String>| {
        objectives(row).iter().zip(objectives(other)).all(|(a, b)| (a - b).abs() <= 1e-9 * b)
    };
    assert!(rows(&at("swapped/front.csv")).iter().any(is_it), "{row:?}");
}

#[test]
fn a_gap_in_a_study_or_on_the_command_line_is_proved_and_checked() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name).to_string_lossy().into_owned();
    let mut study = study_of_ties(3);
    study["gap_percent"] = json!(4);
    std::fs::write(at("study.json"), study.to_string()).expect("written");
    let run = |more: &[&str]| -> (String, Value) {
        let [study, out] = [at("study.json"), at("out")];
        let words = [&["run", &study, "--search", "exact", "--out", &out], more].concat();
        let (code, text) = armwright(&words);
        assert_eq!(code, 0, "{text}");
        let file = std::fs::read_to_string(at("out/run.json")).expect("run.json");
        (text, serde_json::from_str(&file).expect("JSON"))
    };
    for (more, gap) in [(&[][..], 0.04), (&["--gap", "9%"], 0.09), (&["--gap", "0%"], 0.0)] {
        let (text, run) = run(more);
        assert_eq!((run["status"].as_str(), run["gap"].as_f64()), (Some("certified"), Some(gap)));
        let (said, checked) = match gap > 0.0 {
            true => {
                let words =
                    format!("for every design of the study some listed one is at most {:.1} %", 100.0 * gap);
                (format!("certified: {words}"), words)
            }
            false => ("certified: every design of the front is listed".into(), "no design is missing".into()),
        };
        // lines may break anywhere
        let flat = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(flat(&text).contains(&said), "{text}");
        let (code, text) = armwright(&["front", "check", &at("out")]);
        assert_eq!(code, 0, "{text}");
        assert!(flat(&text).contains(&checked), "{text}");
    }
    for (words, fault) in [
        (&["--search", "exhaustive", "--gap", "2%"][..], "--gap goes with --search exact"),
        (&["--search", "exact", "--gap=-2%"], "is not a percentage"),
        (&["--search", "exact", "--gap", "200%"], "is not a percentage"),
    ] {
        let (code, text) = armwright(&[&["run", &at("study.json")], words].concat());
        assert_eq!(code, 2, "{text}");
        assert!(text.contains(fault), "{text}");
    }
    study["gap_percent"] = json!(140);
    std::fs::write(at("study.json"), study.to_string()).expect("written");
    let (code, text) = armwright(&["run", &at("study.json")]);
    assert_eq!(code, 3, "{text}");
    assert!(text.contains("gap_percent") && text.contains("140 is no gap"), "{text}");
}
