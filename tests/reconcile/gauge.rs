//! Readings as people with a dial gauge take them: one direction, blank cells, zeros that are not readings, a
//! spreadsheet.
//!
//! The folders of `tests/data/dial_gauge` and the campaigns made here are of a bench with two joints, computed in
//! closed form: each joint turns by its torque divided by its stiffness. Gauges have a noise of 0.01 mm.

use crate::positions_maker::Noise;
use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::reconcile;
use armwright::reconcile::{Outcome, Verdict};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Noise of the gauges \[mm\].
const SIGMA_MM: f64 = 0.01;
/// What hides in series with the third joint's 8,000 N m/rad.
const CONNECTION_NM_PER_RAD: f64 = 12_000.0;

fn data(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(folder)
}

fn outcome(folder: &Path) -> Outcome {
    reconcile(&Campaign::read(folder, &Catalogs::default()).expect("readable"))
}

fn faults(folder: &Path) -> String {
    Campaign::read(folder, &Catalogs::default()).expect_err("faulty").to_string()
}

/// That the connection is named, and nothing else, with its size.
fn assert_connection(outcome: &Outcome) {
    assert_eq!(outcome.verdict, Verdict::Explained, "{}", outcome.to_text());
    let labels: Vec<String> = outcome.effects.iter().map(|f| f.label()).collect();
    assert_eq!(labels, ["connection_compliance@j3"]);
    let (_, estimates) = &outcome.effects[0].parameters[0];
    let (low, high) = (estimates[0].low.expect("bounded"), estimates[0].high.expect("bounded"));
    assert!(low < CONNECTION_NM_PER_RAD && CONNECTION_NM_PER_RAD < high, "{low} to {high}");
    // the joints' own tolerance of 10 % leaves this much open, whatever the gauge
    assert!((estimates[0].value / CONNECTION_NM_PER_RAD - 1.0).abs() < 0.25, "{}", estimates[0].value);
}

/// A bench whose arm lies along x in its zero pose.
#[derive(Clone, Copy)]
struct Bench {
    /// Across which the joints turn: y for an arm in the vertical plane, z for one that lies flat.
    axis: [f64; 3],
    /// Stiffness of the third joint as built.
    k3_nm_per_rad: f64,
}

const LINK_M: f64 = 0.4;
const K2_NM_PER_RAD: f64 = 20_000.0;
const K3_NM_PER_RAD: f64 = 8_000.0;
const POSES_DEG: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [-30.0, 30.0],
    [-60.0, 60.0],
    [-45.0, 0.0],
    [-80.0, 90.0],
    [20.0, -40.0],
    [-60.0, 30.0],
    [-20.0, 80.0],
];

impl Bench {
    fn standing(has_connection: bool) -> Self {
        let soft = 1.0 / (1.0 / K3_NM_PER_RAD + 1.0 / CONNECTION_NM_PER_RAD);
        Self { axis: [0.0, 1.0, 0.0], k3_nm_per_rad: if has_connection { soft } else { K3_NM_PER_RAD } }
    }

    fn lying(has_connection: bool) -> Self {
        Self { axis: [0.0, 0.0, 1.0], ..Self::standing(has_connection) }
    }

    /// Displacement under a weight (an arm that stands) or a force along y (one that lies) \[mm\].
    fn displacement_mm(&self, pose_deg: [f64; 2], load_n: f64) -> [f64; 3] {
        let [a, b] = [pose_deg[0].to_radians(), (pose_deg[0] + pose_deg[1]).to_radians()];
        // along the arm, and across it in its plane, right-handed about the axis
        let p1 = [LINK_M * a.cos(), LINK_M * a.sin()];
        let p = [p1[0] + LINK_M * b.cos(), p1[1] + LINK_M * b.sin()];
        // right-handed about y, x turns towards -z, along which the weight pulls
        let torques = [load_n * p[0], load_n * (p[0] - p1[0])];
        let turns = [torques[0] / K2_NM_PER_RAD, torques[1] / self.k3_nm_per_rad];
        let along = -turns[0] * p[1] - turns[1] * (p[1] - p1[1]);
        let across = turns[0] * p[0] + turns[1] * (p[0] - p1[0]);
        match self.axis[1] == 1.0 {
            true => [1e3 * along, 0.0, -1e3 * across],
            false => [1e3 * along, 1e3 * across, 0.0],
        }
    }

    fn arm(&self) -> Value {
        json!({"name": "bench", "chain": [
            {"type": "joint", "name": "j2", "axis": self.axis, "stiffness_nm_per_rad": K2_NM_PER_RAD, "mass_kg": 1},
            {"type": "link", "name": "upper", "vector_m": [LINK_M, 0, 0], "mass_kg": 2},
            {"type": "joint", "name": "j3", "axis": self.axis, "stiffness_nm_per_rad": K3_NM_PER_RAD, "mass_kg": 1},
            {"type": "link", "name": "fore", "vector_m": [LINK_M, 0, 0], "mass_kg": 1}
        ]})
    }

    /// A campaign whose rows `write` makes from pose, load and the noisy displacement.
    fn campaign(
        &self,
        header: &str,
        write: &dyn Fn(usize, [f64; 2], f64, [f64; 3]) -> String,
    ) -> tempfile::TempDir {
        let mut noise = Noise(7);
        let mut text = format!("test,q_j2_deg,q_j3_deg,{header}\n");
        let mut row = 0;
        for pose in POSES_DEG {
            for kg in [0.5, 1.0, 2.0, 4.0] {
                row += 1;
                let load_n = kg * 9.81;
                let read = self.displacement_mm(pose, load_n).map(|d| d + SIGMA_MM * noise.normal());
                text.push_str(&format!("{row},{},{},{}\n", pose[0], pose[1], write(row, pose, kg, read)));
            }
        }
        folder(&self.arm(), &json!({"name": "made", "tolerance": TOLERANCE.clone()}), &[("static.csv", text)])
    }
}

static TOLERANCE: std::sync::LazyLock<Value> =
    std::sync::LazyLock::new(|| json!({"joint_stiffness": 0.1, "modulus": 0.05, "joint_mass": 0.05}));

fn folder(arm: &Value, campaign: &Value, files: &[(&str, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write("arm.json", &arm.to_string());
    write("campaign.json", &campaign.to_string());
    files.iter().for_each(|(name, text)| write(name, text));
    folder
}

#[test]
fn three_directions_and_one_find_the_same_connection() {
    assert_connection(&outcome(&data("dial_gauge/full_conn")));
    let zeros = outcome(&data("dial_gauge/z0_conn"));
    assert_connection(&zeros);
    assert!(zeros.reasons.iter().any(|r| r.contains("dx_mm is 0 in all 32 rows")), "{:?}", zeros.reasons);
    assert!(zeros.residuals.iter().all(|r| r.quantity == "dz_mm") && zeros.residuals.len() == 32);
}

#[test]
fn zeros_in_directions_that_nobody_read_are_no_gap() {
    let outcome = outcome(&data("dial_gauge/z0_none"));
    assert_eq!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text());
    let said =
        |column: &str| outcome.reasons.iter().any(|r| r.contains(column) && r.contains("leave a direction"));
    assert!(said("dx_mm") && said("dy_mm"), "{:?}", outcome.reasons);
}

#[test]
fn zeros_blanks_and_absent_columns_are_one_and_the_same() {
    let text = std::fs::read_to_string(data("dial_gauge/z0_conn/static.csv")).expect("text");
    let with = |of: &dyn Fn(&mut Vec<&str>)| {
        let lines = text.lines().map(|line| {
            let mut cells: Vec<&str> = line.split(',').collect();
            of(&mut cells);
            cells.join(",")
        });
        let table = lines.collect::<Vec<_>>().join("\n");
        let statement = json!({"name": "z0_conn", "tolerance": TOLERANCE.clone()});
        outcome(folder(&Bench::standing(true).arm(), &statement, &[("static.csv", table)]).path())
    };
    let zeros = with(&|_| {});
    let blanks = with(&|cells| cells[11..13].iter_mut().filter(|c| **c == "0.000").for_each(|c| *c = ""));
    // neither centre of gravity, nor force, nor branch, nor the other directions
    let absent = with(&|cells| drop(cells.drain(5..13)));
    assert_connection(&absent);
    assert_eq!(zeros.residuals_csv(), blanks.residuals_csv());
    assert_eq!(blanks.residuals_csv(), absent.residuals_csv());
    assert_eq!(absent.residuals_csv().lines().count(), 33);
}

#[test]
fn a_gauge_along_y_finds_the_connection_of_an_arm_that_lies_flat() {
    let header = "force_y_n,dy_mm,sigma_dy_mm";
    let write = |_: usize, _: [f64; 2], kg: f64, d: [f64; 3]| format!("{},{:.3},{SIGMA_MM}", kg * 9.81, d[1]);
    assert_connection(&outcome(Bench::lying(true).campaign(header, &write).path()));
    let none = outcome(Bench::lying(false).campaign(header, &write).path());
    assert_eq!(none.verdict, Verdict::NoGap, "{}", none.to_text());
}

#[test]
fn each_direction_may_have_a_sigma_of_its_own_and_a_row_its_own_blanks() {
    // a coarse scale along x, a gauge along z; now the one, now the other, now both
    let header = "payload_kg,payload_cg_x_m,dx_mm,dz_mm,sigma_mm,sigma_dx_mm";
    let write = |row: usize, _: [f64; 2], kg: f64, d: [f64; 3]| {
        let mut coarse = Noise(row as u64);
        let x = if row.is_multiple_of(3) {
            String::new()
        } else {
            format!("{:.2}", d[0] + 0.05 * coarse.normal())
        };
        let z = if row % 4 == 1 && !row.is_multiple_of(3) { String::new() } else { format!("{:.3}", d[2]) };
        format!("{kg},,{x},{z},{SIGMA_MM},0.051")
    };
    let folder = Bench::standing(true).campaign(header, &write);
    let outcome = outcome(folder.path());
    assert_connection(&outcome);
    let text = std::fs::read_to_string(folder.path().join("static.csv")).expect("text");
    let given = text.lines().skip(1).flat_map(|line| line.split(',').skip(5).take(2).collect::<Vec<_>>());
    assert_eq!(outcome.residuals.len(), given.filter(|cell| !cell.is_empty()).count());
    let sigma = |r: &str| outcome.residuals.iter().find(|x| x.quantity == r).map(|x| x.sigma);
    assert_eq!((sigma("dx_mm"), sigma("dz_mm")), (Some(0.051), Some(SIGMA_MM)));
    let none = reconcile(
        &Campaign::read(Bench::standing(false).campaign(header, &write).path(), &Catalogs::default())
            .expect("readable"),
    );
    assert_eq!(none.verdict, Verdict::NoGap, "{}", none.to_text());
}

#[test]
fn a_gauge_that_counts_the_other_way_is_said_and_not_turned() {
    let header = "payload_kg,dz_mm,sigma_mm";
    let write = |_: usize, _: [f64; 2], kg: f64, d: [f64; 3]| format!("{kg},{:.3},{SIGMA_MM}", -d[2]);
    let outcome = outcome(Bench::standing(false).campaign(header, &write).path());
    assert_eq!(outcome.verdict, Verdict::Unexplained);
    let said = |r: &String| r.contains("dz_mm is") && r.contains("with the other sign");
    assert!(outcome.reasons.iter().any(said), "{:?}", outcome.reasons);
}

#[test]
fn one_gauge_that_is_turned_from_x_to_z_and_zeros_elsewhere_find_it_too() {
    let header = "payload_kg,dx_mm,dy_mm,dz_mm,sigma_mm";
    let write = |row: usize, _: [f64; 2], kg: f64, d: [f64; 3]| match row % 2 {
        0 => format!("{kg},{:.3},0,0,{SIGMA_MM}", d[0]),
        _ => format!("{kg},0,0,{:.3},{SIGMA_MM}", d[2]),
    };
    let outcome = outcome(Bench::standing(true).campaign(header, &write).path());
    assert_connection(&outcome);
    assert!(outcome.reasons.iter().any(|r| r.contains("at least two zeros")), "{:?}", outcome.reasons);
}

#[test]
fn few_rows_of_one_direction_are_too_few_and_read_all_the_same() {
    let outcome = outcome(&data("dial_gauge/blankxy"));
    assert_eq!(outcome.verdict, Verdict::InsufficientData);
    assert_eq!(outcome.residuals.len(), 3);
    let text = faults(&data("dial_gauge/zonly2"));
    assert!(text.contains("static.csv:1: sigma_mm: the column is missing"), "{text}");
    assert!(!text.contains("dx_mm") || !text.contains("dx_mm: the column is missing"), "{text}");
}

#[test]
fn what_looks_like_a_direction_or_a_load_and_is_none_is_named() {
    let campaign = |header: &str, row: &str| {
        let text = format!("test,q_j2_deg,q_j3_deg,{header}\n1,0,0,{row}\n");
        let statement = json!({"name": "made"});
        faults(folder(&Bench::standing(true).arm(), &statement, &[("static.csv", text)]).path())
    };
    for (header, row, expected) in [
        ("payload_kg,d_x_mm,dz_mm,sigma_mm", "1,0.1,0.1,0.01", "d_x_mm: is it dx_mm?"),
        ("payload_kg,dz_mm,sigma_z_mm", "1,0.1,0.01", "sigma_z_mm: is not known"),
        ("payload_kg,payload_cgx_m,dz_mm,sigma_mm", "1,0,0.1,0.01", "payload_cgx_m: is not known"),
        ("payload_kg,force_x,dz_mm,sigma_mm", "1,0,0.1,0.01", "force_x: is not known"),
        ("payload_kg,sigma_mm", "1,0.01", "dx_mm: the column is missing"),
        ("payload_kg,dx_mm,dz_mm,sigma_mm", "1,,,0.01", "no component is given"),
        ("payload_kg,dz_mm,sigma_mm", "1,-,0.01", "dz_mm: \"-\" is not a number; leave the cell blank"),
        ("dz_mm,sigma_mm", "0.1,0.01", "payload_kg: the column is missing"),
    ] {
        let text = campaign(header, row);
        assert!(text.contains(expected), "{header}: {text}");
    }
    let units = "kg,mm,mm\n2,0,0,1,-0.1,0.01\n3,0,0,2,-0.2,0.01";
    let text = campaign("payload_kg,dz_mm,sigma_mm", units);
    // the label and the angles of the first row are numbers: what is no number is named
    assert!(text.contains("\"kg\" is not a number"), "{text}");
    let statement = json!({"name": "made"});
    let table = "test,q_j2_deg,q_j3_deg,payload_kg,dz_mm,sigma_mm\n,deg,deg,kg,mm,mm\n2,0,0,1,-0.1,0.01\n";
    let text =
        faults(folder(&Bench::standing(true).arm(), &statement, &[("static.csv", table.into())]).path());
    assert!(text.contains("static.csv:2: has no numbers") && text.lines().count() < 4, "{text}");
}

#[test]
fn the_same_digits_of_a_repeated_test_are_no_copy_of_a_gauges_row() {
    let header = "payload_kg,dz_mm,sigma_mm";
    let write = |_: usize, _: [f64; 2], kg: f64, d: [f64; 3]| format!("{kg},{:.3},{SIGMA_MM}", d[2]);
    let made = Bench::standing(true).campaign(header, &write);
    let path = made.path().join("static.csv");
    let text = std::fs::read_to_string(&path).expect("text");
    let last = text.lines().last().expect("a row").to_string();
    let again = format!("{text}{}\n", last.replacen("32,", "33,", 1));
    std::fs::write(&path, &again).expect("written");
    assert!(Campaign::read(made.path(), &Catalogs::default()).is_ok());
    std::fs::write(&path, format!("{text}{last}\n")).expect("written");
    assert!(faults(made.path()).contains("repeats line 33 in every value"));
}

fn armwright(folder: &Path, words: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    let output = command.current_dir(folder).args(words).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Columns of a CSV text by name.
fn column(text: &str, name: &str) -> Vec<String> {
    let header = text.lines().next().expect("a header");
    let at = header.split(',').position(|c| c == name).unwrap_or_else(|| panic!("{name} in {header}"));
    text.lines().skip(1).map(|line| line.split(',').nth(at).expect("a cell").to_string()).collect()
}

#[test]
fn predict_fills_what_was_not_measured() {
    let header = "payload_kg,dy_mm,dz_mm,sigma_mm";
    let write = |_: usize, _: [f64; 2], kg: f64, d: [f64; 3]| format!("{kg},,{:.3},{SIGMA_MM}", d[2]);
    let made = Bench::standing(false).campaign(header, &write);
    let words = ["predict", "arm.json", "static.csv", "--campaign", "campaign.json"];
    let text = armwright(made.path(), &words);
    let bench = Bench::standing(false);
    for (row, (x, z)) in column(&text, "model_dx_mm").iter().zip(column(&text, "model_dz_mm")).enumerate() {
        let kg = [0.5, 1.0, 2.0, 4.0][row % 4];
        let truth = bench.displacement_mm(POSES_DEG[row / 4], kg * 9.81);
        let number = |cell: &str| cell.parse::<f64>().expect("a number");
        // the arm's own weight is in the reference reading too, and linear springs do not remember it
        assert!((number(x) - truth[0]).abs() < 1e-5 && (number(&z) - truth[2]).abs() < 1e-5, "row {row}");
    }
    assert!(column(&text, "dy_mm").iter().all(String::is_empty));
}

#[test]
fn predict_refuses_more_readings_than_a_campaign_may_have() {
    let header = "payload_kg,dy_mm,dz_mm,sigma_mm";
    let write = |_: usize, _: [f64; 2], kg: f64, d: [f64; 3]| format!("{kg},,{:.3},{SIGMA_MM}", d[2]);
    let made = Bench::standing(false).campaign(header, &write);
    let file = made.path().join("static.csv");
    let text = std::fs::read_to_string(&file).expect("readings");
    let (header, row) = text.split_once('\n').expect("a header");
    let row = row.lines().next().expect("a row");
    std::fs::write(&file, format!("{header}\n") + &format!("{row}\n").repeat(100_001)).expect("written");
    let words = ["predict", "arm.json", "static.csv", "--campaign", "campaign.json"];
    let output = Command::new(env!("CARGO_BIN_EXE_armwright")).current_dir(made.path()).args(words).output();
    let output = output.expect("it runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("100001 rows") && said.contains("100000"), "{said}");
    assert!(output.stdout.is_empty());
}

fn spreadsheet(file: &str, sheet: Option<&str>) -> tempfile::TempDir {
    let mut statement = json!({
        "name": "gauge", "tolerance": TOLERANCE.clone(),
        "files": {"static": {"file": file, "header_row": 3, "note": "a title is above"}},
        "columns": {"static": {
            "test": "No", "q_j2_deg": "Shoulder", "q_j3_deg": "Elbow", "payload_kg": "Mass", "dz_mm": "Gauge 1",
            "sigma_mm": "Gauge sd"
        }}
    });
    if let Some(sheet) = sheet {
        statement["files"]["static"]["sheet"] = json!(sheet);
    }
    let folder = folder(&Bench::standing(true).arm(), &statement, &[]);
    std::fs::copy(data("spreadsheets").join(file), folder.path().join(file)).expect("copied");
    folder
}

#[test]
fn spreadsheets_are_read_like_tables() {
    let table = outcome(&data("dial_gauge/z0_conn")).residuals_csv();
    for file in ["gauge.xlsx", "gauge.ods"] {
        let folder = spreadsheet(file, Some("May"));
        let outcome = outcome(folder.path());
        assert_connection(&outcome);
        // rows are numbered from the names of the columns on
        assert_eq!(outcome.residuals_csv(), table, "{file}");
        let words = ["predict", "arm.json", file, "--campaign", "campaign.json"];
        let text = armwright(folder.path(), &words);
        assert_eq!(column(&text, "Gauge 1").len(), 32, "the file's own names stay");
        assert_eq!(column(&text, "model_dz_mm").len(), 32);
    }
}

#[test]
fn faults_of_a_spreadsheet_name_sheet_row_and_column_as_it_shows_them() {
    let text = faults(spreadsheet("faulty.xlsx", None).path());
    for expected in [
        "faulty.xlsx, sheet \"May\":6: cell F6 (dz_mm = \"Gauge 1\"): \"n/a\" is not a number",
        "faulty.xlsx, sheet \"May\":8: cell D8 (q_j3_deg = \"Elbow\"): \"x\" is not a number",
        "faulty.xlsx, sheet \"May\":10: cell G10 (sigma_mm = \"Gauge sd\"): = -0.01",
    ] {
        assert!(text.contains(expected), "{expected}\n{text}");
    }
    let text = faults(spreadsheet("gauge.xlsx", Some("June")).path());
    assert!(text.contains("has no sheet \"June\"; its sheets: Notes, May"), "{text}");
    let text = faults(spreadsheet("gauge.ods", None).path());
    assert!(text.contains("has 2 sheets; name one in campaign.json"), "{text}");
}

#[test]
fn a_mapping_that_does_not_fit_is_named() {
    let mapped = |columns: Value| {
        let statement = json!({"name": "made", "columns": {"static": columns}});
        let text = "test,q_j2_deg,q_j3_deg,payload_kg,Gauge,sigma_mm\n1,0,0,1,-0.1,0.01\n";
        faults(folder(&Bench::standing(true).arm(), &statement, &[("static.csv", text.into())]).path())
    };
    assert!(mapped(json!({"dz_mm": "Gage"})).contains("Gage: the column is missing; campaign.json names it"));
    let text = mapped(json!({"dz_m": "Gauge"}));
    assert!(
        text.contains("columns.static.dz_m: static readings have no such column; is it \"dz_mm\"?"),
        "{text}"
    );
    let text = mapped(json!({"dz_mm": "Gauge", "payload_kg": "sigma_mm"}));
    assert!(text.contains("is payload_kg, and so is another column"), "{text}");
}

#[test]
fn a_new_campaign_is_read_once_its_rows_are_filled_in() {
    let here = folder(&Bench::standing(true).arm(), &json!({}), &[]);
    let said = armwright(here.path(), &["new", "campaign", "arm.json", "--out", "may"]);
    assert!(said.contains("STARTER.md"), "{said}");
    let may = here.path().join("may");
    // as it is written, it can be read: there is nothing in it yet
    let empty = outcome(&may);
    assert_eq!(empty.verdict, Verdict::InsufficientData);
    let text = |name: &str| std::fs::read_to_string(may.join(name)).expect("text");
    let page = text("STARTER.md");
    for file in ["static.csv", "modal.csv", "windup.csv", "positions.csv"] {
        let header = text(file);
        for name in header.trim().split(',') {
            assert!(page.contains(&format!("| `{name}` |")), "{name} of {file} is not explained");
        }
    }
    let campaign: Value = serde_json::from_str(&text("campaign.json")).expect("JSON");
    for block in ["tolerance", "conventions", "static", "modal", "windup", "positions"] {
        assert!(campaign[block]["note"].is_string(), "{block} has no note");
    }
    fill(&may);
    let filled = outcome(&may);
    assert_eq!(filled.verdict, Verdict::NoGap, "{}", filled.to_text());
    assert_eq!(filled.residuals.len(), 32 * 3 + 32 + 9 + 40 * 3);
    let again = Command::new(env!("CARGO_BIN_EXE_armwright"))
        .current_dir(here.path())
        .args(["new", "campaign", "arm.json", "--out", "may"])
        .output()
        .expect("it runs");
    assert!(!again.status.success() && String::from_utf8_lossy(&again.stderr).contains("is there already"));
}

/// Fills the tables of a new campaign: first what was done, then, from the model's prediction, what was read.
fn fill(folder: &Path) {
    let mut noise = Noise(11);
    let mut statics = Vec::new();
    let mut modal = Vec::new();
    for [a, b] in POSES_DEG {
        for kg in ["0.5", "1", "2", "4"] {
            statics.push(format!("{a},{b},{kg},0,0,0,0,0,0,loading"));
        }
        for kg in ["0", "2"] {
            modal.extend([1, 2].map(|mode| format!("{a},{b},{kg},0,0,0,{mode}")));
        }
    }
    let windup = (-4..=4).map(|k| format!("j3,{},loading", 10 * k)).collect();
    let positions = (0..40).map(|_| {
        let [a, b] = [(); 2].map(|()| (300.0 * noise.part() - 150.0).round());
        format!("{a},{b},1,0,0,0,tip")
    });
    let positions: Vec<String> = positions.collect();
    for (file, rows, readings, sigma) in [
        ("static.csv", statics, ["dx_mm", "dy_mm", "dz_mm"].as_slice(), 0.01),
        ("modal.csv", modal, ["frequency_hz"].as_slice(), 0.05),
        ("windup.csv", windup, ["windup_arcmin"].as_slice(), 0.1),
        ("positions.csv", positions, ["x_mm", "y_mm", "z_mm"].as_slice(), 0.02),
    ] {
        let header = std::fs::read_to_string(folder.join(file)).expect("text").trim().to_string();
        let blank = ",".repeat(readings.len());
        let planned = rows.iter().enumerate().map(|(i, row)| format!("{},{row}{blank},\n", i + 1));
        let planned = format!("{header}\n{}", planned.collect::<String>());
        std::fs::write(folder.join(file), planned).expect("written");
        let text = armwright(folder, &["predict", "arm.json", file, "--campaign", "campaign.json"]);
        let models: Vec<Vec<String>> =
            readings.iter().map(|r| column(&text, &format!("model_{r}"))).collect();
        let mut filled = format!("{header}\n");
        for (i, row) in rows.iter().enumerate() {
            let read = models.iter().map(|model| {
                let value: f64 = model[i].parse().expect("a prediction");
                format!("{:.4}", value + sigma * noise.normal())
            });
            filled.push_str(&format!("{},{row},{},{sigma}\n", i + 1, read.collect::<Vec<_>>().join(",")));
        }
        std::fs::write(folder.join(file), filled).expect("written");
    }
}
