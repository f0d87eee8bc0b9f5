//! Drives of every kind in studies: gears of other makers, parts that lack ratings, actuators, and motors with a torque
//! curve.

use crate::links::armwright;
use serde_json::{Value, json};
use std::path::Path;

const GEARS: &str = "kind,series,size,ratio,rated_torque_nm,average_torque_limit_nm,repeated_peak_torque_nm,\
    momentary_peak_torque_nm,max_input_speed_rpm,average_input_speed_limit_rpm,inertia_input_kgm2,mass_housed_unit_kg,\
    t1_nm,t2_nm,k1_nm_per_rad,k2_nm_per_rad,k3_nm_per_rad,efficiency_rated_2000rpm,rated_life_h,rated_life_speed_rpm,\
    life_exponent,source,confidence";
/// A harmonic drive of another maker, whose data sheet says nothing of life; and an RV gear and a planetary gear with blanks.
const OWN_GEARS: [&str; 4] = [
    ",FSG,25,100,87,140,204,369,5600,3500,4.1e-5,1.5,14,48,31000,50000,57000,0.7,,,,a vendor page,third party",
    "cycloidal,RV,42,127,412,412,1030,2058,7500,3000,1e-4,9.3,,,390000,390000,390000,0.85,6000,1905,,a leaflet,third party",
    "planetary,PLE,60,40,150,150,240,480,13000,4500,9e-6,1.1,,,34000,,,0.94,,,,own sheet,third party",
    "planetary,PLX,60,12.5,150,150,240,480,13000,4500,9e-6,1.1,,,34000,,,0.94,20000,3000,3,own sheet,third party",
];
const ACTUATORS: &str = "model,ratio,rated_torque_nm,peak_torque_nm,rated_speed_rpm,max_speed_rpm,inertia_output_kgm2,mass_kg,\
    k1_nm_per_rad,tilting_stiffness_nm_per_rad,permissible_tilting_moment_nm,source,confidence\n\
    ACT-70,50,70,160,20,30,0.5,2.4,30000,90000,120,a test,verified\n\
    ACT-100,100,110,220,15,25,0.9,3.6,52000,150000,200,a test,verified\n\
    ACT-X,100,110,220,15,25,,3.0,52000,150000,200,a test,verified\n";

/// A folder with a study and own catalogs in `parts`.
pub fn folder(study: &Value, files: &[(&str, &str)]) -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
    std::fs::create_dir(here.path().join("parts")).expect("a folder");
    for (name, text) in files {
        std::fs::write(here.path().join("parts").join(name), text).expect("written");
    }
    here
}

/// A toothed belt as its makers rate it: one torque and a largest speed.
#[test]
fn a_belt_with_one_rated_torque_and_one_largest_speed_is_sized() {
    let belts = format!(
        "{GEARS}\nbelt,GTX,60,12,300,,,,6000,,1e-4,1.2,,,200000,,,0.97,,,,a belt maker,representative\n\
         belt,GTZ,60,12,,,,,6000,,1e-4,1.2,,,200000,,,0.97,,,,a belt maker,representative\n"
    );
    let here = folder(&one_joint(json!({"gears": ["GTX-60-12"]})), &[("gears.csv", &belts)]);
    let row = sized(here.path());
    assert_eq!(row["gear"], "GTX-60-12", "{row}");
    let (code, said) = armwright(here.path(), &["catalog", "check", "--catalogs", "parts"]);
    assert_eq!(code, 0, "{said}");
    let stands = "GTX-60-12: blank, so the next lower rating (of the mean speed: the largest speed) stands for it: average_torque_limit_nm 300, \
                  repeated_peak_torque_nm 300, momentary_peak_torque_nm 300, average_input_speed_limit_rpm 6000";
    assert!(said.contains(stands) && said.contains("not checked: pretension"), "{said}");
    let lacks = "GTZ-60-12: cannot be chosen by size and run: no rated_torque_nm (mean, peak and stop)\n";
    assert!(said.contains(lacks), "{said}");
}

/// A stiffness in N m/arcmin, an inertia in kg cm2 and a pitch diameter in mm, as data sheets print them.
#[test]
fn stiffnesses_in_newton_metres_per_arcmin_are_refused() {
    let sheet = format!(
        "{GEARS}\nplanetary,AFX,75,50,110,110,198,330,8000,4000,0.16,1.7,,,7,,,0.92,20000,3000,3,own sheet,third party\n"
    );
    let here = folder(&one_joint(json!({})), &[("gears.csv", &sheet)]);
    let (code, said) = armwright(here.path(), &["catalog", "check", "--catalogs", "parts"]);
    assert_eq!(code, 4, "{said}");
    assert!(said.contains("k1_nm_per_rad") && said.contains("1 N m/arcmin = 3438 N m/rad"), "{said}");
    let per_degree = sheet.replace(",,,7,,,", ",,,420,,,");
    std::fs::write(here.path().join("parts/gears.csv"), per_degree).expect("written");
    let (code, said) = armwright(here.path(), &["catalog", "check", "--catalogs", "parts"]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("gives 9.004e2 arcmin under rated_torque_nm = 110"), "{said}");
    assert!(said.contains("inertia_input_kgm2: = 0.16 gives sqrt(J/m)"), "{said}");
}

fn own_gears() -> String {
    format!("{GEARS}\n{}\n", OWN_GEARS.join("\n"))
}

/// 5 kg on a link of 2 kg and 0.8 m, with these drives.
fn one_joint(drives: Value) -> Value {
    json!({"name": "own drive", "payload": {"mass_kg": 5}, "poses": [{"pose_deg": [0]}],
        "chain": [{"type": "joint", "name": "j", "axis": [0, 1, 0], "drive": "first_fit", "max_speed_rad_s": 2},
            {"type": "link", "name": "l", "vector_m": [0.8, 0, 0], "mass_kg": 2}],
        "motion": {"tip_speed_m_s": 1.6, "ramp_time_s": 0.3, "life_h": 7000}, "drives": drives})
}

fn sized(here: &Path) -> Value {
    let (code, said) = armwright(here, &["size", "study.json", "--catalogs", "parts", "--json"]);
    assert_eq!(code, 0, "{said}");
    serde_json::from_str::<Value>(&said).expect("JSON")[0].clone()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key} in {row}"))
}

#[test]
fn a_harmonic_drive_of_another_maker_lasts_the_usual_life_where_its_row_states_none() {
    let here = folder(&one_joint(json!({"gears": ["FSG-25-100"]})), &[("gears.csv", &own_gears())]);
    let row = sized(here.path());
    assert_eq!(row["gear"], "FSG-25-100");
    let by_hand = 7000.0 * (87.0 / number(&row, "mean_torque_nm")).powi(3) * 2000.0 / (0.4 * 1910.0);
    // the speed by hand is rounded to 1910 rpm
    assert!((number(&row, "life_h") / by_hand - 1.0).abs() < 1e-3, "{row}");
    assert!((97_000.0..99_000.0).contains(&number(&row, "life_h")), "{row}");
    let (_, said) = armwright(here.path(), &["catalog", "check", "--catalogs", "parts"]);
    assert!(
        said.contains("FSG-25-100: no rated_life_h; the usual 7000 h of its kind stand for it"),
        "{said}"
    );
}

/// What `size` and `run` say of the lives of the gears; both must say the same, and `run` in all its files.
fn of_lives(study: &Value, gears: &str) -> Vec<String> {
    let here = folder(study, &[("gears.csv", gears)]);
    let read = |words: &[&str]| {
        let (code, said) = armwright(here.path(), words);
        assert_eq!(code, 0, "{said}");
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let size = read(&["size", "study.json", "--catalogs", "parts"]);
    let run = read(&["run", "study.json", "--catalogs", "parts", "--out", "out"]);
    let file = |name: &str| std::fs::read_to_string(here.path().join("out").join(name)).expect(name);
    let json: Value = serde_json::from_str(&file("run.json")).expect("JSON");
    let mut remarks: Vec<String> = serde_json::from_value(json["remarks"].clone()).expect("a list");
    remarks.retain(|words| ["strain-wave", "life not checked"].iter().any(|word| words.contains(word)));
    for words in &remarks {
        for text in [&size, &run, &file("summary.md"), &file("report.html")] {
            assert!(text.contains(words.as_str()), "{words}: {text}");
        }
    }
    remarks
}

#[test]
fn a_life_that_rests_on_a_usual_figure_or_on_none_is_said_beside_the_result() {
    let usual =
        "no rated_life_h in the catalog: the usual 7000 h at 2000 rpm of strain-wave gears stand for it.";
    let study = one_joint(json!({"gears": ["FSG-25-100"]}));
    assert_eq!(
        of_lives(&study, &own_gears()),
        [
            "FSG-25-100: taken as a strain-wave gear (column kind is blank).".into(),
            format!("FSG-25-100: {usual}")
        ]
    );
    let named = own_gears().replace(",FSG,25", "strain_wave,FSG,25");
    assert_eq!(of_lives(&study, &named), [format!("FSG-25-100: {usual}")]);
    let whole = named.replace("57000,0.7,,,,", "57000,0.7,8000,2000,,");
    assert_eq!(of_lives(&study, &whole), [""; 0]);
    let belt = format!(
        "{GEARS}\nbelt,BLT,25,5,90,90,140,200,6000,6000,9e-5,1.6,,,65000,,,0.97,,,,own sheet,third party\n"
    );
    let belts = one_joint(json!({"gears": ["BLT-25-5"]}));
    assert_eq!(of_lives(&belts, &belt), ["BLT-25-5: life not checked: lacks rated_life_h."]);
    let built_in = one_joint(json!({"gears": ["CSG-25-100"]}));
    assert_eq!(of_lives(&built_in, &own_gears()), [""; 0]);
}

#[test]
fn the_life_of_a_cycloidal_gear_goes_with_the_power_ten_thirds_and_that_of_a_stated_exponent_with_it() {
    let here = folder(&one_joint(json!({"gears": ["RV-42-127"]})), &[("gears.csv", &own_gears())]);
    let row = sized(here.path());
    let (mean, rpm) = (number(&row, "mean_torque_nm"), number(&row, "mean_input_speed_rpm"));
    let by_hand = 6000.0 * (412.0 / mean).powf(10.0 / 3.0) * 1905.0 / rpm;
    assert!((number(&row, "life_h") / by_hand - 1.0).abs() < 1e-9, "{by_hand} in {row}");
    assert!(row["emergency_stops_allowed"].is_null() && row["cycle_efficiency"].is_null(), "{row}");
    assert!(!row["not_checked"].to_string().contains("buckling"), "no flexspline: {row}");

    let mut slow = one_joint(json!({"gears": ["PLX-60-12.5"]}));
    slow["motion"]["ramp_time_s"] = json!(0.6);
    let here = folder(&slow, &[("gears.csv", &own_gears())]);
    let row = sized(here.path());
    let (mean, rpm) = (number(&row, "mean_torque_nm"), number(&row, "mean_input_speed_rpm"));
    let by_hand = 20_000.0 * (150.0 / mean).powi(3) * 3000.0 / rpm;
    assert!((number(&row, "life_h") / by_hand - 1.0).abs() < 1e-9, "{by_hand} in {row}");
    assert!((number(&row, "motor_speed_rpm") - 12.5 * 2.0 * 30.0 / std::f64::consts::PI).abs() < 1e-9);
}

#[test]
fn a_gear_that_cannot_be_checked_says_which_figure_is_missing_and_for_what() {
    let here = folder(&one_joint(json!({"gears": ["PLE-60-40"]})), &[("gears.csv", &own_gears())]);
    let (code, said) = armwright(here.path(), &["size", "study.json", "--catalogs", "parts"]);
    assert_eq!(code, 6, "{said}");
    assert!(said.contains("PLE-60-40: no rated_life_h (life), no rated_life_speed_rpm (life)"), "{said}");
    let (code, said) = armwright(here.path(), &["run", "study.json", "--catalogs", "parts", "--out", "out"]);
    assert_ne!(code, 0);
    assert!(said.contains("PLE-60-40: no rated_life_h (life)"), "{said}");
    let (_, said) = armwright(here.path(), &["size", "study.json", "--catalogs", "parts", "--explain", "j"]);
    assert!(said.contains("PLE-60-40 life not checked: lacks rated_life_h"), "{said}");
    let (_, said) = armwright(here.path(), &["catalog", "check", "--catalogs", "parts"]);
    let line =
        said.lines().find(|line| line.contains("PLE-60-40: cannot")).unwrap_or_else(|| panic!("{said}"));
    assert!(line.contains("parts/gears.csv:4"), "{line}");
    assert!(
        line.contains("cannot be chosen by size and run: no rated_life_h (life), no rated_life_speed_rpm"),
        "{line}"
    );
}

#[test]
fn an_incomplete_torsion_curve_is_named_too_and_k1_alone_is_a_curve() {
    let k2_missing = OWN_GEARS[0].replace("31000,50000,57000", "31000,,57000");
    let gears = format!("{GEARS}\n{k2_missing}\n");
    let here = folder(&one_joint(json!({"gears": ["FSG-25-100"]})), &[("gears.csv", &gears)]);
    let (_, said) = armwright(here.path(), &["size", "study.json", "--catalogs", "parts", "--explain", "j"]);
    assert!(said.contains("FSG-25-100 torsion not checked: lacks k2_nm_per_rad"), "{said}");
    let (code, said) = armwright(here.path(), &["size", "study.json", "--catalogs", "parts"]);
    assert!(code == 6 && said.contains("FSG-25-100: no k2_nm_per_rad (torsion)"), "{said}");

    let arm = json!({"name": "a", "chain": [
        {"type": "joint", "name": "j", "axis": [0, 1, 0], "gear": "PLX-60-12.5", "mass_kg": 1},
        {"type": "link", "name": "l", "vector_m": [0.8, 0, 0], "mass_kg": 2}]});
    let here = folder(&arm, &[("gears.csv", &own_gears())]);
    let words =
        ["analyze", "study.json", "--pose-deg", "0", "--force-n", "0,0,-50", "--catalogs", "parts", "--json"];
    let (code, said) = armwright(here.path(), &words);
    assert_eq!(code, 0, "{said}");
    let case: Value = serde_json::from_str(&said).expect("JSON");
    let torque_nm = 0.8 * 50.0 + 0.4 * 2.0 * 9.81;
    let by_hand_m = -torque_nm / 34_000.0 * 0.8;
    let z_m = case["tip_displacement_m"][2].as_f64().expect("a number");
    assert!((z_m / by_hand_m - 1.0).abs() < 1e-12, "{z_m}, by hand {by_hand_m}");
}

#[test]
fn other_kinds_and_actuators_join_a_study_that_asks_for_them_only() {
    let files = [("gears.csv", own_gears()), ("actuators.csv", ACTUATORS.to_string())];
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let gears = |drives: Value| {
        let here = folder(&one_joint(drives), &files);
        armwright(here.path(), &["size", "study.json", "--catalogs", "parts", "--all-fits", "j"]).1
    };
    let usual = gears(json!({}));
    assert!(usual.contains("\nmass kg (with extras)  "), "{usual}");
    assert!(usual.contains("FSG-25-100") && !usual.contains("RV-42") && !usual.contains("ACT-"), "{usual}");
    assert!(gears(json!({"gear_kinds": ["cycloidal", "planetary"]})).contains("RV-42-127"));
    let actuators = gears(json!({"actuators": "all"}));
    assert!(actuators.contains("ACT-100") && !actuators.contains("FSG"), "{actuators}");
    let both = gears(json!({"actuators": ["ACT-100"], "gear_series": ["FSG"]}));
    assert!(both.contains("ACT-100") && both.contains("FSG-25-100 + ") && !both.contains("ACT-70"), "{both}");
    let unknown = gears(json!({"gears": ["ACT-100"], "gear_kinds": ["worm"], "actuators": ["ACT-101"]}));
    for piece in ["\"ACT-100\" is not in the catalog", "\"worm\" is not known", "did you mean \"ACT-100\"?"] {
        assert!(unknown.contains(piece), "{piece} in {unknown}");
    }
}

#[test]
fn an_actuator_is_checked_by_what_its_row_states_at_the_output() {
    let here = folder(&one_joint(json!({"actuators": "all"})), &[("actuators.csv", ACTUATORS)]);
    let row = sized(here.path());
    assert_eq!((row["gear"].as_str(), row["motor"].as_str()), (Some("ACT-70"), Some("ACT-70")));
    // 2 rad/s within 0.3 s; the motor's torque times the ratio is that at the output
    let at_output = 50.0 * number(&row, "motor_peak_torque_nm");
    let by_hand = number(&row, "static_torque_nm") + number(&row, "linear_torque_nm") + 0.5 * 2.0 / 0.3;
    assert!((at_output / by_hand - 1.0).abs() < 1e-12, "{at_output}, by hand {by_hand}");
    assert_eq!(number(&row, "mass_kg"), 2.4);
    assert!(row["life_h"].is_null(), "{row}");
    // 19.1 rpm at the output are within the rated 20 rpm
    assert!((50.0 * number(&row, "motor_continuous_torque_nm") - 70.0).abs() < 1e-9, "{row}");
    let (_, said) = armwright(here.path(), &["size", "study.json", "--catalogs", "parts", "--explain", "j"]);
    // an actuator is one part: one line, and no word of a motor for it or of a gear before it
    let of_x: Vec<&str> =
        said.lines().filter(|line| line.contains("ACT-X") && !line.contains("bearing")).collect();
    assert_eq!(
        of_x,
        ["joint j: ACT-X cannot be checked: no inertia_output_kgm2 (peak and stop and rms)"],
        "{said}"
    );
    let mut heavy = one_joint(json!({"actuators": "all"}));
    heavy["payload"]["mass_kg"] = json!(7.9);
    let here = folder(&heavy, &[("actuators.csv", ACTUATORS)]);
    let (_, said) = armwright(here.path(), &["size", "study.json", "--catalogs", "parts", "--explain", "j"]);
    let of_70: Vec<&str> =
        said.lines().filter(|line| line.contains("ACT-70") && line.contains("rms")).collect();
    assert!(of_70.len() == 1 && of_70[0].starts_with("joint j: ACT-70 "), "{said}");
    assert!(!said.contains("finds no motor") && !said.contains("behind"), "{said}");
    let (_, said) = armwright(here.path(), &["catalog", "check", "--catalogs", "parts"]);
    assert!(
        said.contains(
            "ACT-X: cannot be chosen by size and run: no inertia_output_kgm2 (peak and stop and rms)"
        ),
        "{said}"
    );
}

#[test]
fn the_exact_front_of_actuators_and_gears_of_all_kinds_is_the_exhaustive_one_and_passes_its_check() {
    let parts =
        json!({"actuators": ["ACT-70", "ACT-100"], "gears": ["RV-42-127", "FSG-25-100", "PLX-60-12.5"]});
    let mut study = one_joint(parts);
    study["chain"] = json!([
        {"type": "joint", "name": "j1", "axis": [0, 1, 0], "drive": "all_fits", "max_speed_rad_s": 1.5},
        {"type": "link", "name": "upper", "vector_m": [0.4, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "round_tube", "diameter_mm": [60, 90], "wall_mm": [2, 4]}]}},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "drive": "all_fits", "max_speed_rad_s": 1.5},
        {"type": "link", "name": "fore", "vector_m": [0.3, 0, 0], "mass_kg": 0.5}]);
    study["poses"] = json!([{"pose_deg": [0, 0]}, {"pose_deg": [-30, 60]}]);
    study["payload"] = json!({"mass_kg": 2});
    let files = [("gears.csv", own_gears()), ("actuators.csv", ACTUATORS.to_string())];
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let here = folder(&study, &files);
    let front = |search: &str| {
        let words = ["run", "study.json", "--catalogs", "parts", "--search", search, "--out", search];
        let (code, said) = armwright(here.path(), &words);
        assert_eq!(code, 0, "{said}");
        std::fs::read_to_string(here.path().join(search).join("front.csv")).expect("a front")
    };
    let (slow, exact) = (front("exhaustive"), front("exact"));
    assert_eq!(slow, exact);
    for part in ["ACT-", "FSG-25-100"] {
        assert!(exact.contains(part), "{part} on the front:\n{exact}");
    }
    let (code, said) = armwright(here.path(), &["front", "check", "exact", "--catalogs", "parts"]);
    assert_eq!(code, 0, "{said}");
}

#[test]
fn a_stepper_gives_what_its_curve_says_at_the_speed_of_the_joint() {
    let motors = "type,model,rated_torque_nm,rotor_inertia_kgm2,mass_kg,source,confidence\n\
        stepper,NEMA34,8.5,3.8e-4,3.8,a test,verified\n";
    let curve = "model,speed_rpm,continuous_torque_nm,peak_torque_nm\n\
        NEMA34,0,8,8.5\nNEMA34,300,5,7\nNEMA34,900,1.5,2\n";
    let mut study = one_joint(json!({"gears": ["PLX-60-12.5"], "motor_models": ["NEMA34"]}));
    study["payload"]["mass_kg"] = json!(1);
    study["motion"]["ramp_time_s"] = json!(0.6);
    let gears = own_gears();
    let files = [("gears.csv", gears.as_str()), ("motors.csv", motors), ("motor_curves.csv", curve)];
    let here = folder(&study, &files);
    let row = sized(here.path());
    let rpm = number(&row, "motor_speed_rpm");
    assert!((238.0..239.5).contains(&rpm), "{rpm}");
    let by_hand = 8.0 - 3.0 * rpm / 300.0;
    assert!((number(&row, "motor_continuous_torque_nm") / by_hand - 1.0).abs() < 1e-12, "{row}");

    // no point, no speed: without the curve the row lacks its peak and its speed
    let here = folder(&study, &files[..2]);
    let (code, said) = armwright(here.path(), &["size", "study.json", "--catalogs", "parts"]);
    assert_eq!(code, 6);
    assert!(said.contains("NEMA34: no peak_torque_nm (peak), no max_speed_rpm (speed)"), "{said}");
    let stray = curve.replace("NEMA34,900", "NEMA35,900");
    let here = folder(&study, &[files[0], files[1], ("motor_curves.csv", &stray)]);
    let (code, said) = armwright(here.path(), &["catalog", "check", "--catalogs", "parts"]);
    assert!(code == 4 && said.contains("motor_curves.csv:4: model: \"NEMA35\" is no motor"), "{said}");
}
