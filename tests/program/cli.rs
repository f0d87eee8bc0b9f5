//! The command line: help, exit codes, and which text goes to standard output and which to standard error.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn armwright(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    command.current_dir(folder);
    command
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn project() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Standard output of a command that succeeds.
fn said(folder: &Path, words: &[&str]) -> String {
    let output = armwright(folder).args(words).output().expect("it runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "armwright {}: {errors}", words.join(" "));
    String::from_utf8(output.stdout).expect("text")
}

/// Exit code and standard error of a command that fails.
fn refused(folder: &Path, words: &[&str]) -> (i32, String) {
    let output = armwright(folder).args(words).output().expect("it runs");
    assert!(!output.status.success(), "armwright {} succeeds", words.join(" "));
    assert!(output.stdout.is_empty(), "answers go to standard output, faults do not");
    (output.status.code().expect("a code"), String::from_utf8(output.stderr).expect("text"))
}

/// The verbs that the main help lists.
fn verbs(help: &str) -> Vec<String> {
    let commands = help.split("Commands:").nth(1).expect("a list of commands");
    let lines = commands.lines().skip(1).take_while(|line| !line.trim().is_empty());
    let first = lines.filter_map(|line| line.strip_prefix("  ")?.split_whitespace().next());
    first.filter(|verb| *verb != "help").map(String::from).collect()
}

#[test]
fn the_help_of_every_verb_with_arguments_has_an_example() {
    let here = folder();
    let verbs = verbs(&said(here.path(), &["--help"]));
    for verb in ["run", "size", "analyze", "design", "catalog"] {
        assert!(verbs.contains(&verb.to_string()), "{verb} is missing from {verbs:?}");
    }
    for verb in verbs {
        let help = said(here.path(), &[&verb, "--help"]);
        let takes_arguments = help.lines().any(|l| l.starts_with("Usage:") && l.contains(['<', '.']));
        if takes_arguments {
            assert!(help.contains("Example"), "armwright {verb} --help shows no example");
            assert!(help.contains(&format!("armwright {verb}")), "the example of {verb} is of another verb");
        }
    }
}

#[test]
fn every_exit_code_of_the_help_is_described_in_the_docs() {
    let help = said(folder().path(), &["--help"]);
    let doc = std::fs::read_to_string(project().join("docs/results-format.md")).expect("the page");
    let codes = help.split("Exit codes:").nth(1).expect("exit codes").split("\n\n").next().expect("text");
    let numbers: Vec<&str> = codes.split([';', ' ', '\n', '.']).filter(|w| w.parse::<u8>().is_ok()).collect();
    assert!(numbers.len() >= 10, "{numbers:?}");
    for number in numbers {
        assert!(doc.contains(&format!("\n| {number} |")), "code {number} is not in docs/results-format.md");
    }
}

#[test]
fn the_version_is_the_packages() {
    let line = format!("armwright {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(said(folder().path(), &["--version"]), line);
}

#[test]
fn each_reason_to_fail_has_its_own_exit_code() {
    let here = folder();
    let write = |name: &str, text: &str| std::fs::write(here.path().join(name), text).expect("written");
    let code = |words: &[&str]| refused(here.path(), words).0;
    assert_eq!(code(&["run"]), 2, "a missing argument");
    assert_eq!(code(&["run", "no-such-study"]), 2, "an unknown study");
    write("faulty.json", r#"{"name": "x", "chain": [], "poses": []}"#);
    assert_eq!(code(&["run", "faulty.json"]), 3, "a faulty study");
    std::fs::create_dir(here.path().join("parts")).expect("created");
    write("parts/motors.csv", "type,model\nwind,M1\n");
    assert_eq!(code(&["run", "paper-table1", "--catalogs", "parts"]), 4, "a faulty catalog");
    let mut study = bench_arm();
    study["drives"] = json!({"gear_series": ["CSG"], "ratios": [30]});
    write("empty.json", &study.to_string());
    assert_eq!(code(&["run", "empty.json"]), 5, "no drive to choose from");
    let mut study = bench_arm();
    study["constraints"]["tip_deflection_max_mm"] = json!(1e-6);
    write("stiff.json", &study.to_string());
    let (infeasible, message) = refused(here.path(), &["run", "stiff.json", "--out", "none"]);
    assert_eq!(infeasible, 6, "an infeasible study");
    assert!(message.contains("tip_deflection_max_mm"), "{message}");
    assert!(!here.path().join("none/front.csv").exists(), "nothing is half-written");
    assert_eq!(code(&["analyze", "missing.json"]), 7, "a missing file");
    assert_eq!(code(&["run", "missing.json"]), 7, "a missing study file");
    write("file", "");
    assert_eq!(code(&["run", "paper-table1", "--out", "file"]), 7, "a folder that is a file");
}

#[test]
fn a_closed_pipe_is_no_error() {
    let here = folder();
    let mut child = Command::new(env!("CARGO_BIN_EXE_armwright"))
        .args(["catalog", "show", "profiles"])
        .current_dir(here.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it runs");
    // nobody reads: the reading end closes before the program writes
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{:?} {}", output.status, String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

fn study_file(name: &str) -> Value {
    let text = std::fs::read_to_string(project().join(name)).expect("the study");
    serde_json::from_str(&text).expect("JSON")
}

fn bench_arm() -> Value {
    study_file("examples/bench-arm.json")
}

/// The study of the README's first command, with two sizes a link.
fn small_study() -> Value {
    let mut study = study_file("studies/compare-materials.json");
    for piece in study["chain"].as_array_mut().expect("a chain") {
        let Some(sections) = piece.get_mut("choose").and_then(|c| c["sections"].as_array_mut()) else {
            continue;
        };
        for family in sections {
            for key in ["width_mm", "height_mm"] {
                family[key] = json!([80, 120]);
            }
            family["wall_mm"] = json!([3]);
        }
    }
    study
}

#[test]
fn the_readmes_first_command_works_on_a_reduced_study() {
    let here = folder();
    std::fs::write(here.path().join("small.json"), small_study().to_string()).expect("written");
    let output =
        armwright(here.path()).args(["run", "small.json", "--out", "out"]).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for stream in [&output.stdout, &output.stderr] {
        assert!(!stream.contains(&b'\r'), "a carriage return in what may be a file");
    }
    let text = |name: &str| std::fs::read_to_string(here.path().join("out").join(name)).expect(name);
    let run: Value = serde_json::from_str(&text("run.json")).expect("JSON");
    assert_eq!(run["status"], "complete");
    let front = text("front.csv");
    assert_eq!(run["front_size"], json!(front.lines().count() - 1));
    for material in run["materials"].as_array().expect("materials") {
        let slug = material["slug"].as_str().expect("a slug");
        assert!(text(&format!("front.{slug}.csv")).lines().count() > 1, "{slug} has no front");
    }
    let id = front.lines().nth(1).expect("a design").split(',').next().expect("an id").to_string();
    let taken = said(here.path(), &["design", "out", &id, "--out", "arm"]);
    assert!(taken.starts_with(&format!("design {id} of ")), "{taken}");
    let analyzed = said(here.path(), &["analyze", "arm/arm.json", "--cases", "arm/cases.json", "--json"]);
    let cases: Value = serde_json::from_str(&analyzed).expect("JSON");
    let worst_mm = cases.as_array().expect("cases").iter().map(tip_mm).fold(0.0, f64::max);
    assert_eq!(worst_mm, cell(&front, "tip_deflection_mm"), "analyze reproduces the front");
    let lowest = |case: &Value| case["modes"][0]["frequency_hz"].as_f64().expect("a mode");
    let lowest_hz = cases.as_array().expect("cases").iter().map(lowest).fold(f64::INFINITY, f64::min);
    assert_eq!(lowest_hz, cell(&front, "lowest_mode_hz"), "analyze reproduces the front");
}

/// Leaves every link the first few of its materials.
fn offer_materials(study: &mut Value, most: usize) {
    for piece in study["chain"].as_array_mut().expect("a chain") {
        if let Some(materials) = piece.get_mut("choose").and_then(|choose| choose["materials"].as_array_mut())
        {
            materials.truncate(most);
        }
    }
}

#[test]
fn a_run_into_the_folder_of_another_leaves_nothing_of_it_but_what_is_the_users() {
    let here = folder();
    let mut study = small_study();
    offer_materials(&mut study, 2);
    std::fs::write(here.path().join("both.json"), study.to_string()).expect("written");
    offer_materials(&mut study, 1);
    std::fs::write(here.path().join("one.json"), study.to_string()).expect("written");
    said(
        here.path(),
        &["run", "both.json", "--out", "out", "--within", "5%", "--tolerance", "mass", "--samples", "50"],
    );
    let files = || -> Vec<String> {
        let entries = std::fs::read_dir(here.path().join("out")).expect("a folder");
        entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("text")).collect()
    };
    let of_materials = |files: &[String]| files.iter().filter(|name| name.starts_with("front.")).count();
    let before = files();
    assert!(before.contains(&"near.csv".into()) && before.contains(&"tolerance.csv".into()), "{before:?}");
    std::fs::write(here.path().join("out/notes.txt"), "mine").expect("written");
    said(here.path(), &["run", "one.json", "--out", "out"]);
    let after = files();
    assert!(of_materials(&after) < of_materials(&before), "{before:?}, {after:?}");
    assert!(!after.contains(&"near.csv".into()) && !after.contains(&"tolerance.csv".into()), "{after:?}");
    assert!(after.contains(&"notes.txt".into()), "{after:?}");
    said(here.path(), &["run", "one.json", "--out", "new"]);
    let count = |dir: &str| std::fs::read_dir(here.path().join(dir)).expect("a folder").count();
    assert_eq!(count("out/plots"), count("new/plots"));
    assert_eq!(count("out"), count("new") + 1);
}

#[test]
fn a_size_that_is_listed_twice_is_one_size() {
    let here = folder();
    let mut study = study_file("examples/bench-arm.json");
    let total = |study: &Value| -> Value {
        std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
        said(here.path(), &["run", "study.json", "--out", "out"]);
        let run = std::fs::read_to_string(here.path().join("out/run.json")).expect("run.json");
        serde_json::from_str::<Value>(&run).expect("JSON")["designs_total"].clone()
    };
    let once = total(&study);
    for piece in study["chain"].as_array_mut().expect("a chain") {
        if let Some(sections) = piece.get_mut("choose").and_then(|c| c["sections"].as_array_mut()) {
            sections.extend(sections.clone());
        }
    }
    assert_eq!(total(&study), once);
}

#[test]
fn the_drive_of_a_design_that_is_too_weak_is_named_with_what_it_lacks() {
    let (code, said) = refused(
        &project(),
        &["size", "examples/bench-arm.json", "--design", "100", "--catalogs", "catalogs"],
    );
    assert_eq!(code, 6, "{said}");
    for words in ["the drive of this design, does not hold", "needed", "allowed", "--all-fits"] {
        assert!(said.contains(words), "{words}: {said}");
    }
}

#[test]
fn an_analysis_says_what_effects_add_and_which_are_left_out() {
    let here = folder();
    let arm = json!({
        "name": "small",
        "materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
        "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": 5},
            {"type": "link", "name": "boom", "vector_m": [0.8, 0, 0], "material": "steel",
                "section": {"shape": "round_tube", "diameter_m": 0.1, "wall_m": 0.01}}],
        "effects": [
            {"effect": "extra_mass", "at": "j1", "parameters": {"delta_kg": 3}},
            {"effect": "link_flexibility", "at": "boom", "parameters": {"factor": 2}}]
    });
    std::fs::write(here.path().join("arm.json"), arm.to_string()).expect("written");
    let bends = said(here.path(), &["analyze", "arm.json"]);
    assert!(bends.contains("effects add              3.000 kg") && !bends.contains("left out"), "{bends}");
    for of_response in [["--damping", "0.1"], ["--response-hz", "1,10,10"]] {
        let (code, why) = refused(here.path(), &[&["analyze", "arm.json"], &of_response[..]].concat());
        assert!(code == 2 && why.contains("--response-n"), "{code}: {why}");
    }
    let rigid = said(here.path(), &["analyze", "arm.json", "--links", "rigid"]);
    assert!(rigid.contains("links are held rigid: link_flexibility at boom"), "{rigid}");
    let mut soft = arm;
    soft["materials"]["steel"]["youngs_modulus_pa"] = json!(210);
    std::fs::write(here.path().join("arm.json"), soft.to_string()).expect("written");
    let far = said(here.path(), &["analyze", "arm.json"]);
    assert!(far.contains("small displacements") && far.contains("unit"), "{far}");
    assert!(!bends.contains("small displacements"), "{bends}");
    let far: Value =
        serde_json::from_str(&said(here.path(), &["analyze", "arm.json", "--json"])).expect("JSON");
    assert_eq!(far["small_displacements"], json!(false));
}

fn tip_mm(case: &Value) -> f64 {
    let tip = case["tip_displacement_m"].as_array().expect("a vector");
    let [x, y, z] = [0, 1, 2].map(|i| tip[i].as_f64().expect("a number"));
    nalgebra::Vector3::new(x, y, z).norm() * 1e3
}

/// The number in the first row of a front under a column.
fn cell(front: &str, column: &str) -> f64 {
    let mut rows = csv::Reader::from_reader(front.as_bytes());
    let at = rows.headers().expect("a header").iter().position(|c| c == column).expect("the column");
    let first = rows.records().next().expect("a row").expect("sound");
    first[at].parse().expect("a number")
}

#[test]
fn an_arm_without_anything_elastic_has_no_modes() {
    let here = folder();
    let arm = r#"{"name": "stiff", "materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10,
        "density_kg_m3": 7850}}, "chain": [{"type": "link", "name": "a", "vector_m": [0, 0, 1], "material": "steel",
        "section": {"shape": "round_tube", "diameter_m": 0.1, "wall_m": 0.005}}]}"#;
    std::fs::write(here.path().join("arm.json"), arm).expect("written");
    let solved = said(here.path(), &["analyze", "arm.json", "--links", "rigid", "--json"]);
    let solved: serde_json::Value = serde_json::from_str(&solved).expect("JSON");
    assert_eq!(solved["modes"], json!([]));
    assert_eq!(solved["tip_displacement_m"], json!([0.0, 0.0, 0.0]));
}

#[test]
fn numbers_on_the_command_line_may_begin_with_a_minus_sign() {
    let here = folder();
    let arm = r#"{"chain": [{"type": "joint", "name": "j", "axis": [0, 1e20, 0], "stiffness_nm_per_rad": 1e5},
        {"type": "link", "name": "a", "vector_m": [1, 0, 0], "mass_kg": 2}]}"#;
    std::fs::write(here.path().join("arm.json"), arm).expect("written");
    let torque = |words: &[&str]| {
        let words = [&["analyze", "arm.json", "--json", "--force-n", "0,0,-10"], words].concat();
        let solved: serde_json::Value = serde_json::from_str(&said(here.path(), &words)).expect("JSON");
        solved["joint_torque_nm"]["j"].as_f64().expect("a torque")
    };
    // 2 kg at 0.5 m and 10 N at 1 m
    assert!((torque(&["--pose-deg", "-0"]) - 19.81).abs() < 1e-12);
    assert_eq!(
        torque(&["--payload-inertia-kgm2", "-0,0.1,0.1"]),
        torque(&["--payload-inertia-kgm2=0,0.1,0.1"])
    );
    let (code, message) = refused(here.path(), &["analyze", "arm.json", "--payload-inertia-kgm2", "-1,0,0"]);
    assert!(code == 2 && message.contains("not negative"), "{message}");
}

/// A study of far more designs than can be visited, which names no limit of time.
#[cfg(unix)]
fn endless_study(folder: &Path) {
    let text = std::fs::read_to_string(project().join("studies/compare-materials.json")).expect("readable");
    let mut study: Value = serde_json::from_str(&text).expect("JSON");
    for piece in study["chain"].as_array_mut().expect("pieces") {
        if piece["type"] == "joint" {
            piece.as_object_mut().expect("a joint").remove("drives");
        }
    }
    std::fs::write(folder.join("endless.json"), study.to_string()).expect("written");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_an_exact_search_and_what_was_found_is_written() {
    let folder = folder();
    endless_study(folder.path());
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    let command = command.current_dir(folder.path()).args(["run", "endless.json", "--out", "found"]);
    let search = command.stdout(Stdio::piped()).spawn().expect("it runs");
    std::thread::sleep(std::time::Duration::from_secs(4));
    let interrupt = Command::new("kill").args(["-INT", &search.id().to_string()]).status();
    assert!(interrupt.expect("kill runs").success());
    let output = search.wait_with_output().expect("it ends");
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(8), "interrupted, whatever was kept: {text}");
    // a line of the terminal may end between the two words
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("search partial"), "{text}");
    let run = std::fs::read_to_string(folder.path().join("found/run.json")).expect("written");
    let run: Value = serde_json::from_str(&run).expect("JSON");
    assert_eq!((run["status"].as_str(), run["search"].as_str()), (Some("partial"), Some("exact")));
    assert!(run["front_size"].as_u64() > Some(0) && run["boxes_open"].as_u64() > Some(0), "{run}");
}
