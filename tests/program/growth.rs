//! Input that is too large is refused before it fills the memory of the machine. The message names the limit.

use crate::running::armwright;
use serde_json::json;
use std::fmt::Write;
use std::path::Path;

/// Exit code and everything that was said.
#[test]
fn a_chain_of_thousands_of_joints_is_refused_with_the_limit() {
    let here = tempfile::tempdir().expect("a folder");
    let joint = |k: usize| json!({"type": "joint", "name": format!("j{k}"), "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": 1});
    let chain: Vec<_> = (0..2001).map(joint).collect();
    let arm = json!({"name": "long", "chain": chain});
    let study = json!({"name": "long", "chain": chain, "payload": {"mass_kg": 1},
        "poses": [{"name": "out", "pose_deg": vec![0; 2001]}]});
    std::fs::write(here.path().join("arm.json"), arm.to_string()).expect("written");
    std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
    for words in [["analyze", "arm.json"], ["run", "study.json"], ["size", "study.json"]] {
        let (code, said) = armwright(here.path(), &words);
        assert!(
            code == 3 && said.contains("2001 joints and links, and the limit is 2000"),
            "{words:?}: {said}"
        );
    }
}

#[test]
fn a_study_of_more_joints_or_cases_than_a_search_takes_is_refused_with_the_limit() {
    let here = tempfile::tempdir().expect("a folder");
    let joint = |k: usize| json!({"type": "joint", "name": format!("j{k}"), "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": 1});
    let study = |joints: usize, poses: usize| {
        let chain: Vec<_> = (0..joints).map(joint).collect();
        let poses = vec![json!({"pose_deg": vec![0; joints]}); poses];
        json!({"name": "long", "chain": chain, "payload": {"mass_kg": 1}, "poses": poses})
    };
    for (study, limit) in [
        (study(201, 1), "has 201 joints, and the limit of a study is 200"),
        (study(1, 2001), "makes 2001 cases, and the limit of a study is 2000"),
    ] {
        std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
        for words in [["run", "study.json"], ["size", "study.json"], ["check", "study.json"]] {
            let (code, said) = armwright(here.path(), &words);
            assert!(code == 3 && said.contains(limit), "{words:?}: {said}");
        }
    }
}

#[test]
fn numbers_that_no_quantity_has_are_refused() {
    let here = tempfile::tempdir().expect("a folder");
    let arm = |length_m: f64, mass_kg: f64| {
        json!({"name": "far", "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": mass_kg},
            {"type": "link", "name": "arm", "vector_m": [length_m, 0, 0], "mass_kg": 1}]})
    };
    for (arm, words) in [
        (arm(1e160, 1.0), "chain[1].vector_m[0]: = 1e160 is beyond 1e30"),
        (arm(1.0, -1e31), "chain[0].mass_kg: = -1e31 is beyond 1e30"),
    ] {
        std::fs::write(here.path().join("arm.json"), arm.to_string()).expect("written");
        let (code, said) = armwright(here.path(), &["analyze", "arm.json"]);
        assert!(code == 3 && said.contains(words), "{said}");
    }
    std::fs::write(here.path().join("arm.json"), arm(1.0, 1.0).to_string()).expect("written");
    for words in
        [["analyze", "arm.json", "--force-n", "1e200,0,0"], ["analyze", "arm.json", "--payload-kg", "1e200"]]
    {
        let (code, said) = armwright(here.path(), &words);
        assert!(code == 2 && said.contains("beyond 1e30"), "{said}");
    }
}

#[test]
fn a_product_of_grids_is_refused_before_it_is_made() {
    let here = tempfile::tempdir().expect("a folder");
    let grid = json!({"from": 1, "to": 90_000, "step": 1});
    let study = |sections: serde_json::Value| {
        json!({"name": "fine", "payload": {"mass_kg": 1}, "poses": [{"name": "out", "pose_deg": [0]}], "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": 1},
            {"type": "link", "name": "arm", "vector_m": [1, 0, 0],
             "choose": {"materials": ["Structural steel S355"], "sections": [sections]}}]})
    };
    for sections in [
        json!({"shape": "round_tube", "diameter_mm": grid, "wall_mm": grid}),
        json!({"shape": "rectangular_tube", "width_mm": grid, "height_mm": grid, "wall_mm": grid}),
        json!({"shape": "rectangular_bar", "width_mm": grid, "height_mm": grid}),
    ] {
        std::fs::write(here.path().join("study.json"), study(sections).to_string()).expect("written");
        let (code, said) = armwright(here.path(), &["run", "study.json"]);
        assert!(code == 3 && said.contains("8100000000 sections") && said.contains("the limit is"), "{said}");
    }
}

#[test]
fn a_catalog_of_too_many_rows_is_refused() {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(here.path().join("parts")).expect("created");
    let mut text = String::from("type,model\n");
    for k in 0..100_001 {
        let _ = writeln!(text, "electric,M{k}");
    }
    std::fs::write(here.path().join("parts/motors.csv"), text).expect("written");
    let (code, said) = armwright(here.path(), &["catalog", "check", "--catalogs", "parts"]);
    assert!(
        code == 4 && said.contains("more than 100000 rows, which is the limit"),
        "{code} {}",
        &said[..300]
    );
}

#[test]
fn too_many_readings_are_refused() {
    let here = tempfile::tempdir().expect("a folder");
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dial_gauge/full_conn");
    for entry in std::fs::read_dir(from).expect("a campaign") {
        let path = entry.expect("an entry").path();
        if path.is_file() {
            std::fs::copy(&path, here.path().join(path.file_name().expect("a name"))).expect("copied");
        }
    }
    let file = here.path().join("static.csv");
    let mut text = std::fs::read_to_string(&file).expect("readings").trim_end().to_string();
    let row = text.lines().last().expect("a row").split_once(',').expect("cells").1.to_string();
    for k in 0..100_001 {
        let _ = write!(text, "\nmore{k},{row}");
    }
    std::fs::write(&file, text).expect("written");
    let (code, said) = armwright(here.path(), &["reconcile", ".", "--out", "out"]);
    assert!(code == 3 && said.contains("and the limit is 100000"), "{code} {}", &said[..said.len().min(400)]);
}

#[test]
fn a_time_that_cannot_be_waited_for_is_no_limit() {
    let here = tempfile::tempdir().expect("a folder");
    for limit in ["inf", "1e19", "nan", "-1", "0"] {
        for words in [&["run", "light-arm"][..], &["front", "check", "x"]] {
            let (code, said) = armwright(here.path(), &[words, &[&format!("--time-limit={limit}")]].concat());
            assert!(code == 2 && said.contains("ten years"), "{words:?} {limit}: {code} {said}");
        }
    }
}
