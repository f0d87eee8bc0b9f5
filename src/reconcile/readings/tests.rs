//! Tests of the readers on whole folders of campaigns.

use super::campaign::Campaign;
use crate::catalog::Catalogs;
use crate::input::json::InputError;
use tempfile::TempDir;

const ARM: &str = r#"{"name": "arm", "chain": [
  {"type": "joint", "name": "sh", "axis": [0,1,0], "stiffness_nm_per_rad": 1e4, "mass_kg": 2},
  {"type": "link", "name": "upper", "vector_m": [0.4,0,0], "mass_kg": 1},
  {"type": "joint", "name": "el", "axis": [0,1,0], "stiffness_nm_per_rad": 5e3, "mass_kg": 1},
  {"type": "link", "name": "fore", "vector_m": [0.3,0,0], "mass_kg": 1}]}"#;

/// A folder with the arm, this statement, and these files.
fn folder(statement: &str, files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    for (name, text) in [("arm.json", ARM), ("campaign.json", statement)].iter().chain(files) {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

/// The campaign with these files, or all of its faults in one text.
fn read(statement: &str, files: &[(&str, &str)]) -> Result<Campaign, String> {
    let folder = folder(statement, files);
    Campaign::read(folder.path(), &Catalogs::default()).map_err(|error| match error {
        InputError::Faulty(faults) => faults.0.iter().map(|fault| format!("{fault}\n")).collect(),
        other => other.to_string(),
    })
}

/// Two rows of displacements under a header.
fn statics(header: &str) -> String {
    format!("{header}\n1,10,20,1,-0.11,0.01\n2,30,-40,2,-0.13,0.01\n")
}

const STATIC: &str = "test,q_sh_deg,q_el_deg,payload_kg,dz_mm,sigma_mm";

/// A record of 200 rows with these names of its columns.
fn record(header: &str) -> String {
    let row = |i: usize| format!("{},{},{},1\n", i as f64 * 0.004, i as f64 * 0.01, i as f64 * 0.01);
    format!("{header}\n{}", (0..200).map(row).collect::<String>())
}

#[test]
fn blank_rows_of_a_table_are_skipped_and_keep_the_numbers_of_the_others() {
    let text = format!("{},,,,,\n \n,,,,,\n3,30,x,2,-0.1,0.01\n,,,,,\n", statics(STATIC));
    let faults = read("{}", &[("static.csv", &text)]).expect_err("one cell is no number");
    assert!(faults.lines().count() == 1 && faults.contains(":7: q_el_deg"), "{faults}");
    let text = format!("\n,,,,,\n{},,,,,\n", statics(STATIC));
    assert_eq!(read("{}", &[("static.csv", &text)]).expect("sound").statics.len(), 2);
    let text = format!("{},,,\n\n", record("t_s,sh_motor_deg,sh_link_deg,sh_motor_torque_nm"));
    assert_eq!(read("{}", &[("record.csv", &text)]).expect("sound").records[0].t_s.len(), 200);
}

#[test]
fn columns_of_a_record_may_be_named_once_for_all_records() {
    let statement = r#"{"columns": {"t_s": "Zeit", "sh_motor_deg": "Mot", "sh_link_deg": "Arm"}}"#;
    let campaign = read(statement, &[("record.csv", &record("Zeit,Mot,Arm,M"))]).expect("sound");
    assert_eq!(campaign.records[0].joints[0].link_rad.len(), 200);
    // a record that calls a column otherwise says so itself
    let own = statement.replace("}}", r#"}, "records": [{"columns": {"sh_link_deg": "Link"}}]}"#);
    let campaign = read(&own, &[("record.csv", &record("t_s,Mot,Link,M"))]).expect("sound");
    assert_eq!(campaign.records[0].joints[0].link_rad.len(), 200);
    let wrong = statement.replace("sh_link_deg", "wrist_link_deg");
    let faults = read(&wrong, &[("record.csv", &record("Zeit,Mot,Arm,M"))]).expect_err("no such joint");
    assert!(faults.contains("maps an unknown name"), "{faults}");
    let faults = read(r#"{"columns": {"statik": {}}}"#, &[]).expect_err("no such channel");
    assert!(faults.contains("did you mean \"static\""), "{faults}");
}

#[test]
fn a_column_in_another_unit_is_to_be_converted_and_that_of_another_joint_is_not_suggested() {
    let of = |from: &str, to: &str| {
        let text = statics(&STATIC.replace(from, to));
        read("{}", &[("static.csv", &text)]).expect_err("a misspelt column")
    };
    let faults = of("dz_mm", "dz_um");
    assert!(faults.contains("is it dz_mm?; convert its values from um to mm"), "{faults}");
    let faults = of("q_sh_deg", "q_sh_rad");
    assert!(
        faults.contains(
            "q_sh_rad: is the angle or travel of no driven joint; convert its values from rad to deg"
        ),
        "{faults}"
    );
    let faults = of("q_sh_deg", "sh");
    assert!(faults.contains("q_sh_deg: the column is missing") && !faults.contains("is it"), "{faults}");
}

#[test]
fn columns_that_nobody_reads_are_named_with_the_ones_they_may_be() {
    let remark = |file: &str, text: &str| read("{}", &[(file, text)]).expect("sound").remarks.join("\n");
    let modal = "q_sh_deg,q_el_deg,mass_kg,mode,frequency_hz,sigma_hz,operator\n10,20,8,1,4.5,0.01,A\n";
    let said = remark("modal.csv", modal);
    assert_eq!(said, "modal.csv: columns that are not used: mass_kg (is it payload_kg?), operator");
    let forces =
        statics(&STATIC.replace("dz_mm,sigma_mm", "fz_n,dz_mm,sigma_mm")).replace(",-0.1", ",-40,-0.1");
    let said = remark("static.csv", &forces);
    assert!(said.contains("fz_n (is it force_x_n or force_y_n or force_z_n?)"), "{said}");
    let said = remark("static.csv", &statics("test,q_sh_deg,q_el_deg,payload_kg,dx_mm,sigma_mm"));
    assert_eq!(said, "");
    let other = "test,q_sh_deg,q_el_deg,payload_kg,dx_mm,sigma_mm,delta_z_mm\n1,10,20,1,-0.1,0.01,-0.4\n";
    let said = remark("static.csv", other);
    assert_eq!(said, "static.csv: columns that are not used: delta_z_mm (is it dy_mm or dz_mm?)");
    let other = "test,q_sh_deg,q_el_deg,payload_kg,dx_mm,dz_mm,sigma_mm\n1,10,20,1,,-0.1,0.01\n";
    let said = remark("static.csv", other);
    assert_eq!(said, "static.csv: columns without any reading, taken as not measured: dx_mm");
}

#[test]
fn a_formula_without_a_value_is_no_blank_cell() {
    let statement = r#"{"files": {"static": {"file": "formula.xlsx"}}}"#;
    let folder = folder(statement, &[]);
    let data = format!("{}/tests/data/spreadsheets/formula.xlsx", env!("CARGO_MANIFEST_DIR"));
    std::fs::copy(data, folder.path().join("formula.xlsx")).expect("copied");
    let error = Campaign::read(folder.path(), &Catalogs::default()).expect_err("a cell without a value");
    let InputError::Faulty(faults) = error else { panic!("{error}") };
    let said = faults.0[0].to_string();
    assert!(faults.0.len() == 1 && said.contains("cell E2") && said.contains("without a value"), "{said}");
}

#[test]
fn a_record_that_is_no_csv_file_says_what_it_is() {
    let statement = r#"{"records": [{"file": "record.xlsx"}]}"#;
    let faults = read(statement, &[("record.xlsx", "PK\u{3}\u{4} and so on")]).expect_err("a spreadsheet");
    assert!(faults.contains("is a spreadsheet") && !faults.contains("PK"), "{faults}");
    let text = record("t_s,sh_motor_deg,sh_link_deg,sh_motor_torque_nm").replace(',', ";");
    let faults = read("{}", &[("record.csv", &text)]).expect_err("semicolons");
    assert!(faults.lines().count() == 1 && faults.contains("separated by semicolons"), "{faults}");
    let faults = read("{}", &[("record.csv", "\u{1}\u{2}\u{0}binary\n1,2\n")]).expect_err("no text");
    assert!(faults.contains("is no text"), "{faults}");
}
