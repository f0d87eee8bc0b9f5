//! What `armwright size`, the page and the bill of materials say about drives: the forces of prismatic joints with
//! their units, the mass that moves inboard, and messages that name everything that is missing.

use crate::drives::folder;
use crate::links::armwright;
use serde_json::{Value, json};
use std::path::Path;

const GRAVITY_M_S2: f64 = 9.81;

/// What a command says, without line breaks.
fn said(here: &Path, args: &[&str], code: i32) -> String {
    let (found, said) = armwright(here, args);
    assert_eq!(found, code, "{said}");
    said.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A vertical column of 4 kg that travels on a screw and carries a tube and 3 kg.
fn column() -> Value {
    json!({"name": "column", "payload": {"mass_kg": 3}, "poses": [{"name": "low", "pose": {"z_mm": 100}}],
        "chain": [
            {"type": "prismatic", "name": "z", "axis": [0, 0, 1], "drive": "first_fit", "mass_kg": 4, "fixed_mass_kg": 3,
             "max_speed_m_s": 0.3, "drives": {"motors": ["ac_servo"]},
             "screws": [{"name": "20 x 10", "lead_mm": 10, "root_diameter_mm": 17, "length_mm": 600, "mass_kg": 0.5}]},
            {"type": "link", "name": "boom", "vector_m": [0.4, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
             "sections": [{"shape": "round_tube", "diameter_mm": [50, 60], "wall_mm": 3}]}}],
        "motion": {"tip_speed_m_s": 0.3, "ramp_time_s": 0.3}})
}

#[test]
fn the_forces_of_a_rail_have_keys_and_units_of_their_own() {
    let here = folder(&column(), &[]);
    let (code, text) = armwright(here.path(), &["size", "study.json", "--json"]);
    assert_eq!(code, 0, "{text}");
    let row = serde_json::from_str::<Value>(&text).expect("JSON")[0].clone();
    // the median of two tubes is one of them: 60 x 3 or 50 x 3 mm of 2700 kg/m3
    let tube_kg = |d_mm: f64| std::f64::consts::PI * (d_mm - 3.0) * 3.0 * 1e-6 * 0.4 * 2700.0;
    let weight_n = |d_mm: f64| (4.0 + 3.0 + tube_kg(d_mm)) * GRAVITY_M_S2;
    let static_n = row["static_force_n"].as_f64().unwrap_or_else(|| panic!("{row}"));
    assert!(
        [50.0, 60.0].iter().any(|d_mm| (static_n / weight_n(*d_mm) - 1.0).abs() < 1e-6),
        "{static_n} in {row}"
    );
    assert!((row["joint_speed_m_s"].as_f64().expect("a speed") - 0.3).abs() < 1e-12, "{row}");
    for gone in ["static_torque_nm", "total_torque_nm", "mean_torque_nm", "joint_speed_rpm"] {
        assert!(row.get(gone).is_none(), "{gone} in {row}");
    }
    assert!(row["motor_peak_torque_nm"].is_number() && row["mean_force_n"].is_number(), "{row}");
}

#[test]
fn the_page_has_the_forces_of_a_rail_with_their_unit_and_each_check_under_its_name() {
    let mut study = column();
    let turn = json!({"type": "joint", "name": "turn", "axis": [0, 0, 1], "drive": "first_fit"});
    study["chain"].as_array_mut().expect("a chain").insert(1, turn);
    study["chain"][0]["guide"] =
        json!({"roll_nm_per_rad": 1e6, "pitch_nm_per_rad": 1e6, "yaw_nm_per_rad": 1e6});
    let here = folder(&study, &[]);
    said(here.path(), &["run", "study.json", "--out", "r"], 0);
    let page = std::fs::read_to_string(here.path().join("r/report.html")).expect("a page");
    let drives = page.split("<table class=\"drives\">").nth(1).and_then(|rest| rest.split("</table>").next());
    let drives = drives.expect("a table of drives");
    assert!(drives.contains(" N</td>") && drives.contains("20 x 10"), "{drives}");
    let checks = page.split("<table class=\"checks\">").nth(1).and_then(|rest| rest.split("</table>").next());
    let checks = checks.expect("a table of checks");
    assert!(checks.contains(" N</small>"), "{checks}");
    let names: Vec<&str> = checks.split("<th scope=\"col\"").skip(1).collect();
    let rows: Vec<&str> = checks.split("<th scope=\"row\">").skip(1).collect();
    assert!(
        rows.len() == 2 && rows.iter().all(|row| row.matches("<td").count() == names.len() - 1),
        "{checks}"
    );
    // the screw has no bearing that tilts, so that its cell under this name is empty
    let bearing = names.iter().position(|name| name.contains("bearing moment")).expect("a column");
    assert!(
        rows[0].starts_with('z') && rows[0].split("<td").nth(bearing).expect("a cell").contains("></td>")
    );
    // the guide belongs to the joint, and the picture hatches links alone
    let bars = std::fs::read_to_string(here.path().join("r/plots/deflection.svg")).expect("a picture");
    let hatched: Vec<&str> = bars.lines().filter(|line| line.contains("url(#hatch)")).collect();
    assert!(bars.contains(".guide</title>") && !hatched.is_empty(), "{bars}");
    assert!(hatched.iter().all(|line| !line.contains(".guide")), "{hatched:?}");
    let parts = page.split("torque (7) in this pose").nth(1).and_then(|rest| rest.split("</table>").next());
    let parts = parts.expect("a table of parts");
    assert!(parts.contains(" N</td>"), "{parts}");
}

#[test]
fn the_parts_of_a_sized_rail_are_rows_of_the_bill() {
    let here = folder(&column(), &[]);
    said(here.path(), &["run", "study.json", "--out", "r"], 0);
    let front = std::fs::read_to_string(here.path().join("r/front.csv")).expect("a front");
    let mut lines = front.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let first = lines.next().expect("a design");
    let cell = |name: &str| first[header.iter().position(|h| *h == name).expect("a column")];
    said(here.path(), &["design", "r", cell("design_id"), "--out", "d"], 0);
    let arm = std::fs::read_to_string(here.path().join("d/arm.json")).expect("an arm");
    let arm: Value = serde_json::from_str(&arm).expect("JSON");
    let z = &arm["chain"][0];
    assert_eq!((z["gear"].as_str(), z["motor"].as_str()), (Some("20 x 10"), Some(cell("z_motor"))));
    said(here.path(), &["export", "d/arm.json", "--to", "bom", "--out", "b"], 0);
    let bill = std::fs::read_to_string(here.path().join("b/bom.csv")).expect("a bill");
    let rows: Vec<Vec<&str>> = bill.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let mass_of = |kind: &str| -> f64 {
        let row = rows.iter().find(|row| row[3] == kind).unwrap_or_else(|| panic!("{kind} in {bill}"));
        row[4].parse().expect("a mass")
    };
    // the shaft of 17 mm by 600 mm of 7850 kg/m3 and the half kilogram beyond it
    let screw_kg = std::f64::consts::PI / 4.0 * 0.017f64.powi(2) * 0.6 * 7850.0 + 0.5;
    assert!((mass_of("screw or rack") - screw_kg).abs() < 1e-8, "{bill}");
    assert!((z["motor_mass_kg"].as_f64().expect("kg") - mass_of("motor")).abs() < 1e-12, "{bill}");
    let stays = rows.iter().find(|row| row[2] == "what stays of z").expect("what stays");
    assert!((stays[4].parse::<f64>().expect("kg") - 3.0).abs() < 1e-8, "{bill}");
    let sum_kg: f64 = rows.iter().map(|row| row[4].parse::<f64>().expect("kg")).sum();
    assert!((sum_kg - cell("mass_kg").parse::<f64>().expect("kg")).abs() < 1e-9, "{bill}");
}

#[test]
fn the_mass_that_goes_inward_has_the_stages_and_not_the_motor_that_sits_elsewhere() {
    let study = json!({"name": "belt", "extras": "none", "payload": {"mass_kg": 1}, "poses": [{"pose_deg": [0, 0]}],
        "chain": [
            {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "drive": "first_fit", "bearing": null},
            {"type": "link", "name": "upper", "vector_m": [0.4, 0, 0], "mass_kg": 1},
            {"type": "joint", "name": "elbow", "axis": [0, 1, 0], "drive": "first_fit", "bearing": null,
             "drives": {"gears": ["CSG-17-50"]}, "motor_at": "upper",
             "transmission": [{"ratio": 1, "stiffness_nm_per_rad": 300, "mass_kg": 3}]},
            {"type": "link", "name": "fore", "vector_m": [0.3, 0, 0], "mass_kg": 0.8}],
        "motion": {"tip_speed_m_s": 0.5, "ramp_time_s": 0.3}});
    let here = folder(&study, &[]);
    let (code, text) = armwright(here.path(), &["size", "study.json", "--json"]);
    assert_eq!(code, 0, "{text}");
    let rows: Value = serde_json::from_str(&text).expect("JSON");
    let inward_kg = |row: usize| rows[row]["mass_passed_inward_kg"].as_f64().expect("kg");
    let catalog = armwright::catalog::Catalogs::builtin();
    let gear_kg = catalog.gear("CSG-17-50").expect("a gear").mass_housed_unit_kg.expect("kg");
    // the link, the gear, and the half of the belt on the axis of the elbow
    assert!((inward_kg(0) - (0.8 + gear_kg + 1.5)).abs() < 1e-9, "{text}");
    let [elbow_kg, shoulder_kg] = [0, 1].map(|row: usize| rows[row]["mass_kg"].as_f64().expect("kg"));
    let all_kg = 0.8 + elbow_kg + 3.0 + 1.0 + shoulder_kg;
    assert!((inward_kg(1) - all_kg).abs() < 1e-9, "{all_kg} in {text}");
}

/// 5 kg on a link of 2 kg and 0.8 m, with these drives.
fn one_joint(drives: Value) -> Value {
    json!({"name": "own drive", "payload": {"mass_kg": 5}, "poses": [{"pose_deg": [0]}],
        "chain": [{"type": "joint", "name": "j", "axis": [0, 1, 0], "drive": "first_fit", "max_speed_rad_s": 2},
            {"type": "link", "name": "l", "vector_m": [0.8, 0, 0], "mass_kg": 2}],
        "motion": {"tip_speed_m_s": 1.6, "ramp_time_s": 0.3, "life_h": 7000}, "drives": drives})
}

const GEARS: &str = "kind,series,size,ratio,rated_torque_nm,average_torque_limit_nm,repeated_peak_torque_nm,\
    momentary_peak_torque_nm,max_input_speed_rpm,average_input_speed_limit_rpm,inertia_input_kgm2,mass_housed_unit_kg,\
    k1_nm_per_rad,efficiency_rated_2000rpm,rated_life_h,rated_life_speed_rpm,life_exponent,source,confidence\n\
    planetary,PX,60,40,150,150,240,480,13000,4500,9e-6,1.1,34000,0.94,20000,3000,3,own sheet,third party\n\
    planetary,PY,60,40,150,150,240,480,13000,4500,,,34000,,,,,own sheet,third party\n";
const ACTUATORS: &str = "model,ratio,rated_torque_nm,peak_torque_nm,rated_speed_rpm,max_speed_rpm,inertia_output_kgm2,mass_kg,\
    k1_nm_per_rad,tilting_stiffness_nm_per_rad,permissible_tilting_moment_nm,source,confidence\n\
    ACT-X,100,110,220,15,25,,3.0,52000,150000,200,a test,verified\n";

#[test]
fn messages_on_drives_name_all_that_is_missing_and_nothing_that_cannot_matter() {
    let files = [("gears.csv", GEARS), ("actuators.csv", ACTUATORS)];
    let here = folder(&one_joint(json!({"gears": ["PX-60-40", "PY-60-40"]})), &files);
    let own = |args: &[&str], code| {
        said(here.path(), &[&["size", "study.json", "--catalogs", "parts"], args].concat(), code)
    };
    let explained = own(&["--explain", "j"], 0);
    let all = "PY-60-40 life not checked: lacks rated_life_h; also lacks inertia_input_kgm2, efficiency_rated_2000rpm, \
               rated_life_speed_rpm, mass_housed_unit_kg";
    assert!(explained.contains(all), "{explained}");
    assert!(own(&["--all-fits", "j"], 0).contains("K1 34000 PX-60-40"));

    let here = folder(&one_joint(json!({"actuators": ["ACT-X"]})), &files);
    let refused = said(here.path(), &["size", "study.json", "--catalogs", "parts"], 6);
    let only = "can be checked in full: ACT-X: no inertia_output_kgm2 (peak and stop and rms) (state";
    assert!(refused.contains(only), "{refused}");

    let here = folder(&one_joint(json!({"gear_kinds": ["belt"]})), &[]);
    let refused = said(here.path(), &["size", "study.json"], 3);
    let words = "drives.gear_kinds: the catalogs have no gear of the kind belt; add rows to gears.csv in a folder of your own \
                 (--catalogs DIR), or ask for a kind that has rows: strain_wave";
    assert!(refused.contains("study.json:1: ") && refused.contains(words), "{refused}");
}
