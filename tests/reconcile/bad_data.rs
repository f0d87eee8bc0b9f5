//! Campaigns with bad data: all faults are listed at once, and too few readings give the verdict that there are too
//! few.

use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::reconcile;
use armwright::reconcile::{Outcome, Verdict};
use std::path::{Path, PathBuf};

fn data(campaign: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns").join(campaign)
}

/// A campaign with one effect whose file is edited line by line; `None` drops a line.
fn edited(file: &str, edit: impl Fn(usize, &str) -> Option<String>) -> tempfile::TempDir {
    edited_of("plain-0251e", file, edit)
}

/// A campaign of an honest arm, edited.
fn edited_honest(file: &str, edit: impl Fn(usize, &str) -> Option<String>) -> tempfile::TempDir {
    edited_of("plain-05e68", file, edit)
}

fn edited_of(campaign: &str, file: &str, edit: impl Fn(usize, &str) -> Option<String>) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    for entry in std::fs::read_dir(data(campaign)).expect("campaign") {
        let path = entry.expect("entry").path();
        let name = path.file_name().expect("name");
        let text = std::fs::read_to_string(&path).expect("text");
        let text = match name == file {
            true => {
                text.lines().enumerate().filter_map(|(i, l)| edit(i + 1, l)).collect::<Vec<_>>().join("\n")
            }
            false => text,
        };
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

fn faults(folder: &Path) -> String {
    Campaign::read(folder, &Catalogs::default()).expect_err("faulty").to_string()
}

fn outcome(folder: &Path) -> Outcome {
    reconcile(&Campaign::read(folder, &Catalogs::default()).expect("readable"))
}

fn cells(line: &str, column: usize, value: &str) -> String {
    let mut cells: Vec<&str> = line.split(',').collect();
    cells[column] = value;
    cells.join(",")
}

#[test]
fn every_fault_of_a_file_is_listed_with_line_column_and_value() {
    let folder = edited("static.csv", |line, text| {
        Some(match line {
            5 => cells(text, 15, "NaN"),
            7 => cells(text, 18, "-0.006"),
            9 => cells(text, 7, "abc"),
            11 => cells(text, 8, "76"),
            _ => text.to_string(),
        })
    });
    let text = faults(folder.path());
    for expected in [
        "static.csv:5: dx_mm: NaN is not a finite number",
        "static.csv:7: sigma_mm: = -0.006; a standard deviation is greater than 0",
        "static.csv:9: payload_kg: \"abc\" is not a number",
        "static.csv:11: payload_cg_x_m: = 76; more than 5 m from the tip: is it in mm?",
    ] {
        assert!(text.contains(expected), "{expected}\n{text}");
    }
}

#[test]
fn missing_columns_and_unknown_joints_are_named() {
    let folder = edited("static.csv", |line, text| {
        Some(if line == 1 {
            text.replace("sigma_mm", "sigma").replace("q_j3_deg", "q_j33_deg")
        } else {
            text.into()
        })
    });
    let text = faults(folder.path());
    assert!(text.contains("sigma_mm: the column is missing"), "{text}");
    assert!(text.contains("q_j33_deg: is the angle or travel of no driven joint"), "{text}");
    let folder = edited("windup.csv", |_, text| Some(text.replace("j5", "j9")));
    assert!(faults(folder.path()).contains("\"j9\" is no joint of the arm"));
}

#[test]
fn a_repeated_row_and_radians_are_refused() {
    let folder = edited("static.csv", |line, text| {
        Some(if line == 4 { format!("{text}\n{text}") } else { text.into() })
    });
    let text = faults(folder.path());
    assert!(text.contains("static.csv:5: repeats line 4 in every value"), "{text}");
    let folder = edited("static.csv", |line, text| {
        if line == 1 {
            return Some(text.into());
        }
        let radians = text.split(',').enumerate().map(|(i, cell)| match i {
            1..=6 => format!("{:.4}", cell.parse::<f64>().expect("angle").to_radians()),
            _ => cell.to_string(),
        });
        Some(radians.collect::<Vec<_>>().join(","))
    });
    assert!(faults(folder.path()).contains("they look like radians"));
}

fn only_static(keep: impl Fn(usize, &str) -> bool) -> tempfile::TempDir {
    let folder = edited("static.csv", |line, text| (line == 1 || keep(line, text)).then(|| text.to_string()));
    for file in ["modal.csv", "windup.csv"] {
        std::fs::remove_file(folder.path().join(file)).expect("removed");
    }
    let path = folder.path().join("campaign.json");
    let mut campaign: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&path).expect("text")).expect("JSON");
    for key in ["modal", "windup"] {
        campaign.as_object_mut().expect("object").remove(key);
    }
    std::fs::write(path, campaign.to_string()).expect("written");
    folder
}

#[test]
fn ten_rows_one_pose_one_load_or_a_dead_instrument_are_insufficient() {
    for (folder, word) in [
        (only_static(|line, _| line <= 11), "too few"),
        (only_static(|line, _| line <= 6), "distinct pose"),
        (only_static(|_, text| has_payload_of_ten_kg(text)), "same load"),
        (
            edited("static.csv", |line, text| {
                (line == 1 || has_payload_of_ten_kg(text)).then(|| text.to_string())
            }),
            "same load",
        ),
        (
            edited("static.csv", |line, text| {
                let dead = |text: &str, column| cells(text, column, "0.01");
                Some(if line == 1 {
                    text.into()
                } else {
                    (15..18).fold(text.to_string(), |t, c| dead(&t, c))
                })
            }),
            "the instrument did not follow",
        ),
    ] {
        let outcome = outcome(folder.path());
        assert_eq!(outcome.verdict, Verdict::InsufficientData, "{word}: {}", outcome.to_text());
        assert!(outcome.reasons.iter().any(|r| r.contains(word)), "{:?}", outcome.reasons);
        assert!(outcome.effects.is_empty(), "{}", outcome.to_text());
    }
}

fn has_payload_of_ten_kg(row: &str) -> bool {
    row.split(',').nth(7) == Some("10")
}

#[test]
fn swapped_units_are_named_as_a_unit_and_not_as_physics() {
    let folder = edited("static.csv", |line, text| {
        if line == 1 {
            return Some(text.into());
        }
        let inches = text.split(',').enumerate().map(|(i, cell)| match i {
            15..=17 => format!("{:.6}", cell.parse::<f64>().expect("mm") / 25.4),
            _ => cell.to_string(),
        });
        Some(inches.collect::<Vec<_>>().join(","))
    });
    let outcome = outcome(folder.path());
    let named = outcome.effects.iter().any(|f| f.effect == "wrong_unit" && f.at == "static");
    assert!(named || outcome.verdict == Verdict::Unexplained, "{}", outcome.to_text());
}

#[test]
fn payloads_written_in_pounds_are_not_explained_by_physics() {
    let folder = edited("static.csv", |line, text| {
        let cells: Vec<&str> = text.split(',').collect();
        let pounds = |kg: &str| format!("{:.3}", kg.parse::<f64>().expect("kg") * 2.2046);
        Some(if line == 1 { text.into() } else { self::cells(text, 7, &pounds(cells[7])) })
    });
    let outcome = outcome(folder.path());
    assert_ne!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text());
    let of_the_test = ["wrong_unit", "sensor_gain"];
    assert!(
        outcome.effects.iter().all(|f| of_the_test.contains(&f.effect.as_str())),
        "{}",
        outcome.to_text()
    );
}

#[test]
fn a_mode_that_was_missed_is_noticed() {
    // the second mode of one list is not there; those above it were numbered down
    let folder = edited("modal.csv", |_, text| {
        let mut cells: Vec<&str> = text.split(',').collect();
        match (cells[0], cells[11]) {
            ("3", "2") => None,
            ("3", "3") => {
                cells[11] = "2";
                Some(cells.join(","))
            }
            ("3", "4") => {
                cells[11] = "3";
                Some(cells.join(","))
            }
            _ => Some(text.to_string()),
        }
    });
    let outcome = outcome(folder.path());
    assert!(
        outcome.reasons.iter().any(|r| r.contains("appears to be missing from list 3")),
        "{:?}",
        outcome.reasons
    );
    assert_eq!(outcome.effects[0].label(), "lost_motion@j3");
}

/// The row with its readings times a factor that depends on its cells.
fn scaled(
    line: usize,
    text: &str,
    columns: std::ops::Range<usize>,
    factor: impl Fn(&[&str]) -> f64,
) -> String {
    if line == 1 {
        return text.into();
    }
    let row: Vec<&str> = text.split(',').collect();
    let factor = factor(&row);
    let cell = |(i, cell): (usize, &&str)| match columns.contains(&i) {
        true => format!("{:.4}", factor * cell.parse::<f64>().expect("number")),
        false => cell.to_string(),
    };
    row.iter().enumerate().map(cell).collect::<Vec<_>>().join(",")
}

#[test]
fn a_force_gauge_that_reads_wrong_is_no_water_and_no_sensor() {
    let folder = edited_honest("static.csv", |line, text| {
        Some(scaled(line, text, 15..18, |row| if row[7] == "0" { 1.08 } else { 1.0 }))
    });
    let outcome = outcome(folder.path());
    assert_eq!(outcome.verdict, Verdict::Unexplained, "{}", outcome.to_text());
}

#[test]
fn modes_that_are_numbered_out_of_order_are_put_in_order() {
    let folder = edited_honest("modal.csv", |_, text| {
        let mut cells: Vec<&str> = text.split(',').collect();
        let swapped = match (cells[0], cells[11]) {
            ("3" | "8", "2") => "3",
            ("3" | "8", "3") => "2",
            (_, mode) => mode,
        };
        cells[11] = swapped;
        Some(cells.join(","))
    });
    let outcome = outcome(folder.path());
    assert_eq!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text());
    assert!(outcome.reasons.iter().any(|r| r.contains("list 8 of the frequencies")), "{:?}", outcome.reasons);
}

#[test]
fn a_dead_bench_is_no_unit_and_readings_below_their_noise_say_nothing() {
    let folder = edited_honest("windup.csv", |line, text| Some(scaled(line, text, 4..5, |_| 0.0)));
    let dead = outcome(folder.path());
    assert_eq!(dead.verdict, Verdict::InsufficientData, "{}", dead.to_text());
    let folder = only_static(|_, _| true);
    let path = folder.path().join("static.csv");
    let text = std::fs::read_to_string(&path).expect("text");
    std::fs::write(&path, text.replace(",0.006", ",60.0")).expect("written");
    let noise = outcome(folder.path());
    assert_eq!(noise.verdict, Verdict::InsufficientData, "{}", noise.to_text());
}

#[test]
fn an_arm_in_which_nothing_yields_has_no_modes_to_compare() {
    let folder = edited_honest("arm.json", |_, text| {
        let is_stiffness = text.contains("stiffness_nm_per_rad");
        Some(if is_stiffness { "\"stiffness_nm_per_rad\": null,".into() } else { text.into() })
    });
    let path = folder.path().join("campaign.json");
    let text = std::fs::read_to_string(&path).expect("text");
    std::fs::write(&path, text.replacen('{', "{\"links\": \"rigid\",", 1)).expect("written");
    let outcome = outcome(folder.path());
    assert_ne!(outcome.verdict, Verdict::NoGap, "{}", outcome.to_text());
}

#[test]
fn numbers_that_overflow_are_refused() {
    let folder = edited("static.csv", |line, text| {
        Some(match line {
            5 => cells(text, 12, "1e300"),
            7 => cells(text, 15, "-1e300"),
            9 => cells(text, 18, "1e-300"),
            _ => text.to_string(),
        })
    });
    let text = faults(folder.path());
    for line in ["static.csv:5: force_y_n", "static.csv:7: dx_mm", "static.csv:9: sigma_mm"] {
        assert!(text.contains(line), "{line}\n{text}");
    }
    let folder = edited("modal.csv", |line, text| {
        Some(if line == 3 { cells(text, 12, "1e300") } else { text.into() })
    });
    assert!(faults(folder.path()).contains("modal.csv:3: frequency_hz"));
}

#[test]
fn tables_of_other_programs_are_refused_in_one_line() {
    let folder = edited("static.csv", |_, text| Some(text.replace(',', ";").replace('.', ",")));
    let text = faults(folder.path());
    assert!(text.contains("its columns are separated by semicolons"), "{text}");
    assert!(!text.contains("the column is missing"), "{text}");
    let folder = edited("static.csv", |_, text| Some(text.replace(',', "   ")));
    let text = faults(folder.path());
    assert!(text.contains("its columns are separated by spaces"), "{text}");
    assert!(!text.contains("the column is missing"), "{text}");
    let folder = edited("static.csv", |line, text| {
        Some(if line == 1 { format!("{text},dx_mm") } else { format!("{text},0") })
    });
    assert!(faults(folder.path()).contains("dx_mm: the column is there twice"));
    let folder = edited("windup.csv", |line, text| {
        Some(if line == 3 { cells(text, 2, "\"-3,5\"") } else { text.into() })
    });
    assert!(faults(folder.path()).contains("has a decimal comma"));
    let folder = edited("campaign.json", |line, text| {
        Some(if line == 1 { format!("\u{feff}{text}") } else { text.into() })
    });
    assert!(Campaign::read(folder.path(), &Catalogs::default()).is_ok(), "a byte order mark is no fault");
}

/// A campaign in whose file the names of the columns are those that `rename` gives.
fn with_columns(file: &str, rename: impl Fn(&str) -> String) -> tempfile::TempDir {
    edited(file, |line, text| {
        let names = text.split(',').map(&rename).collect::<Vec<_>>().join(",");
        Some(if line == 1 { names } else { text.into() })
    })
}

#[test]
fn a_missing_column_is_named_with_what_to_write() {
    let renamed = |file: &str, name: &'static str, other: &'static str| {
        let folder = with_columns(file, move |column| if column == name { other } else { column }.into());
        faults(folder.path())
    };
    for (file, name) in [("static.csv", "sigma_mm"), ("modal.csv", "sigma_hz")] {
        let said = renamed(file, name, "scatter");
        assert!(said.contains("the standard deviation of one reading"), "{said}");
    }
    let said = renamed("windup.csv", "windup_arcmin", "twist_deg");
    assert!(said.contains("multiply its values by 60"), "{said}");
    let said = renamed("modal.csv", "frequency_hz", "omega_rad_s");
    assert!(said.contains("divide its values by 2 pi"), "{said}");
}

#[test]
fn a_standard_deviation_of_zero_is_one_fault_of_its_row() {
    let folder = edited("static.csv", |line, text| {
        let cells: Vec<&str> = text.split(',').collect();
        Some(if line == 2 { self::cells(text, cells.len() - 1, "0") } else { text.into() })
    });
    let said = faults(folder.path());
    assert_eq!(said.matches("a standard deviation is greater than 0").count(), 1, "{said}");
}

#[test]
fn a_file_that_is_missing_is_named_with_the_command_that_writes_one() {
    let folder = edited("arm.json", |_, text| Some(text.into()));
    std::fs::remove_file(folder.path().join("arm.json")).expect("removed");
    let said = faults(folder.path());
    assert!(said.contains("arm.json") && said.contains("armwright new campaign"), "{said}");
    let folder = edited("campaign.json", |_, text| Some(text.replace("static.csv", "elsewhere.csv")));
    let said = faults(folder.path());
    assert!(said.contains("elsewhere.csv") && said.contains("armwright new campaign"), "{said}");
}

#[test]
fn a_file_without_rows_is_said_to_be_unused() {
    let folder = edited_honest("windup.csv", |line, text| (line == 1).then(|| text.into()));
    let text = outcome(folder.path()).to_text();
    assert!(text.contains("windup.csv: has the names of columns and no row of readings"), "{text}");
}

/// Each displacement is half a metre more than it was: the tip's position.
#[test]
fn positions_in_the_columns_of_displacements_are_asked_for() {
    let folder = edited_honest("static.csv", |line, text| {
        let cells: Vec<&str> = text.split(',').collect();
        let moved = cells.iter().enumerate().map(|(i, cell)| match (line, i) {
            (2.., 15..=17) => format!("{:.4}", 500.0 + cell.parse::<f64>().expect("mm")),
            _ => cell.to_string(),
        });
        Some(moved.collect::<Vec<_>>().join(","))
    });
    let text = outcome(folder.path()).to_text();
    assert!(text.contains("are these positions of the tip?"), "{text}");
}
