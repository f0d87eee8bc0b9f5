//! What `armwright catalog` prints.

use armwright::catalog::Catalogs;
use armwright::command_line::{Cli, Failure, run};
use clap::Parser;

fn said(line: &str) -> Result<String, Failure> {
    let words = ["armwright", "catalog"].into_iter().chain(line.split_whitespace());
    run(Cli::try_parse_from(words).map_err(|e| Failure::Usage(e.to_string()))?).map(|answer| answer.text)
}

fn shown(line: &str) -> String {
    said(line).expect("sound")
}

#[test]
fn tables_fit_the_terminal() {
    for parts in ["gears", "actuators", "motors", "materials", "profiles"] {
        let text = shown(&format!("show {parts}"));
        let widest = text.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(110), "{parts}: {widest:?}");
    }
}

#[test]
fn filters_choose_rows() {
    assert!(shown("show gears --series CSG --size 32").contains("\n5 of 195; a blank cell is unknown"));
    assert!(shown("show gears --series csf --size 58").contains("HFUC-58-100"));
    assert!(shown("show motors --kind electric").contains("80 of 99"));
    assert!(shown("show materials --class composite").contains("16 of 41"));
    assert!(shown("show profiles --family steel --shape square").contains("of 435"));
}

#[test]
fn unknown_and_stray_filters_are_refused() {
    let refused = |line: &str| said(line).expect_err(line).to_string();
    assert_eq!(
        refused("show gears --series XYZ"),
        "--series XYZ is not known; choose one of: AF, CSG, HFUC, RVE, RVN, SHG, TPMA, TPMF, ZKRV"
    );
    assert!(refused("show motors --kind steam").contains("electric, hydraulic"));
    assert!(refused("show motors --size 32").contains("--size filters Gears, not Motors"));
    assert!(refused("show").contains("required"));
}

#[test]
fn one_part_is_shown_with_source_and_trust() {
    let text = shown("show --part HFUC-58-100");
    for piece in [
        "k2_nm_per_rad",
        "610000",
        "confidence: verified",
        "unverified: efficiency_rated_2000rpm",
        "read from: built-in gears.csv:",
    ] {
        assert!(text.contains(piece), "{piece} in\n{text}");
    }
    assert!(shown("show --part F11-10").contains("from memory"));
    assert!(said("show --part F11-1O").expect_err("letter O").to_string().contains("nearest: F11-10"));
}

#[test]
fn csv_is_a_file_that_a_catalog_folder_can_hold() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (parts, file) in [
        ("gears", "gears.csv"),
        ("motors", "motors.csv"),
        ("materials", "materials.csv"),
        ("profiles", "profiles.csv"),
    ] {
        std::fs::write(folder.path().join(file), shown(&format!("show {parts} --csv"))).expect("writable");
    }
    let (again, builtin) = (Catalogs::load(Some(folder.path())).expect("sound"), Catalogs::builtin());
    let ids = |c: &Catalogs| c.motors.iter().map(|m| (m.id.clone(), m.mass_kg)).collect::<Vec<_>>();
    assert_eq!((ids(&again), again.gears.len(), again.profiles.len()), (ids(&builtin), 195 + 52, 435));
}

#[test]
fn check_counts_rows_trust_blanks_and_warnings() {
    let text = said("check").expect("sound");
    for piece in ["built-in gears.csv", "average_input_speed_limit_rpm", "No faults. Warnings (4):"] {
        assert!(text.contains(piece), "{piece} in\n{text}");
    }
}

#[test]
fn faults_of_an_overlay_are_printed_with_file_line_and_column() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text =
        "type,model,mass_kg,source,confidence\nac-servo,M1,-2,own,verified\nac-servo,M2,2 kg,own,verified\n";
    std::fs::write(folder.path().join("motors.csv"), text).expect("writable");
    let shown =
        said(&format!("check --catalogs {}", folder.path().display())).expect_err("two faults").to_string();
    assert!(shown.starts_with("in the catalogs, 2 faults in the input:"), "{shown}");
    assert!(shown.contains("motors.csv:2: mass_kg: = -2 must be greater than 0"), "{shown}");
    assert!(shown.contains("motors.csv:3: mass_kg: \"2 kg\" is not a number"), "{shown}");
}

#[test]
fn every_help_says_what_a_flag_does_and_gives_an_example() {
    use clap::CommandFactory;
    let mut program = Cli::command();
    let program = program.find_subcommand_mut("catalog").expect("a verb");
    let show = program.find_subcommand_mut("show").expect("a verb");
    assert!(
        show.get_arguments().all(|a| a.is_global_set() || a.get_id() == "help" || a.get_help().is_some())
    );
    assert!(show.render_long_help().to_string().contains("armwright catalog show --part HFUC-58-100"));
}

#[test]
fn a_material_without_a_shear_modulus_is_among_the_parts_that_cannot_be_used() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let rows = "name,class,e_pa,density_kg_m3,source,confidence\nCast X,metal,1.1e11,7200,a test,verified\n";
    std::fs::write(folder.path().join("materials.csv"), rows).expect("written");
    let text = shown(&format!("check --catalogs {}", folder.path().display()));
    let listed = text.split("cannot be used because a rating is blank").nth(1).expect("a list");
    assert!(listed.contains("Cast X: no link can be made of it: no g_pa (torsion and shear)"), "{text}");
}
