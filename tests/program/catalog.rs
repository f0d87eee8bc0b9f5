//! The catalogs of parts as the program uses them: the built-in rows, the rows that a user's folder adds, and the
//! messages on a faulty folder.

use armwright::catalog::CatalogFile;
use armwright::catalog::MaterialClass;
use armwright::catalog::PartError;
use armwright::catalog::ProfileShape;
use armwright::catalog::{Catalogs, Confidence};
use armwright::catalog::{GearKind, Motor, MotorKind};
use armwright::input::{Fault, InputError};
use std::path::{Path, PathBuf};

const GEAR_HEADER: &str = "series,size,ratio,rated_torque_nm,average_torque_limit_nm,repeated_peak_torque_nm,\
    momentary_peak_torque_nm,t1_nm,t2_nm,k1_nm_per_rad,k2_nm_per_rad,k3_nm_per_rad,source,confidence";
const MOTOR_HEADER: &str = "type,model,rated_torque_nm,peak_torque_nm,mass_kg,source,confidence";

/// A folder with the given files; removed when dropped.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("writable");
    }
    folder
}

fn load(files: &[(&str, &str)]) -> Result<Catalogs, InputError> {
    Catalogs::load(Some(folder(files).path()))
}

fn faults(files: &[(&str, &str)]) -> Vec<Fault> {
    match load(files) {
        Err(InputError::Faulty(faults)) => faults.0,
        other => panic!("expected faults, got {other:?}"),
    }
}

/// File name, line and column of faults.
fn places(faults: &[Fault]) -> Vec<(String, Option<usize>, &str)> {
    let name = |file: &str| PathBuf::from(file).file_name().map(|n| n.to_string_lossy().into_owned());
    faults.iter().map(|f| (name(&f.file).unwrap_or_default(), f.line, f.field.as_str())).collect()
}

#[test]
fn the_built_in_catalogs_have_all_their_rows() {
    let catalogs = Catalogs::builtin();
    let count = |series| catalogs.gears.iter().filter(|g| g.series == series).count();
    assert_eq!(catalogs.gears.len(), 195 + 52, "actuators have a gear within");
    assert_eq!([count("HFUC"), count("CSG"), count("SHG")], [62, 44, 44]);
    assert_eq!(catalogs.motors.len(), 99 + 52);
    assert_eq!(catalogs.motors.iter().filter(|m| m.kind.is_hydraulic()).count(), 11);
    assert_eq!(catalogs.materials.len(), 41);
    assert_eq!(catalogs.profiles.len(), 435);
    assert_eq!(catalogs.efficiency.len(), 42);
}

#[test]
fn the_gears_of_table_1_have_the_middle_slopes_and_masses_of_sources_md() {
    let catalogs = Catalogs::builtin();
    let expected = [
        ("HFUC-58-100", [400e3, 610e3, 710e3], 4.7, 14.6),
        ("HFUC-50-100", [250e3, 400e3, 440e3], 3.2, 8.9),
        ("HFUC-32-100", [67e3, 110e3, 120e3], 0.89, 3.2),
        ("HFUC-20-50", [13e3, 18e3, 23e3], 0.28, 0.98),
    ];
    for (id, slopes, set_kg, unit_kg) in expected {
        let gear = catalogs.gear(id).expect(id);
        assert_eq!([gear.k1_nm_per_rad, gear.k2_nm_per_rad, gear.k3_nm_per_rad], slopes.map(Some), "{id}");
        assert_eq!(
            (gear.mass_component_set_kg, gear.mass_housed_unit_kg),
            (Some(set_kg), Some(unit_kg)),
            "{id}"
        );
    }
}

#[test]
fn the_stiffnesses_of_table_1_are_the_middle_slopes_printed_in_kgf_m_per_arcmin() {
    let catalogs = Catalogs::builtin();
    let nm_per_rad = |kgf_m_per_arcmin: f64| kgf_m_per_arcmin * 9.80665 / (std::f64::consts::PI / 10800.0);
    let table_1 = [
        ("HFUC-58-100", 607e3, 18.0),
        ("HFUC-50-100", 405e3, 12.0),
        ("HFUC-32-100", 108e3, 3.2),
        ("HFUC-20-50", 17.5e3, 0.52),
    ];
    for (id, paper, older_print) in table_1 {
        let k2 = catalogs.gear(id).expect(id).k2_nm_per_rad.expect("a torsion curve");
        assert!((paper / k2 - 1.0).abs() < 0.035, "{id}: paper {paper}, catalog {k2}");
        assert!((paper / nm_per_rad(older_print) - 1.0).abs() < 0.003, "{id}");
    }
}

#[test]
fn the_example_of_the_readme_loads_and_its_tables_name_every_column() {
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("catalogs/README.md"))
        .expect("the file");
    let example: Vec<&str> = readme.lines().skip_while(|l| !l.starts_with("type,model")).take(2).collect();
    let catalogs = load(&[("motors.csv", &example.join("\n"))]).expect("sound");
    assert_eq!(catalogs.motors.len(), 99 + 52 + 1);
    assert_eq!(catalogs.warnings, Catalogs::builtin().warnings);
    for file in CatalogFile::ALL {
        for column in file.columns() {
            let written =
                if column.required { format!("**{}**", column.name) } else { column.name.to_string() };
            let also = format!("`{}`", column.name);
            assert!(readme.contains(&written) || readme.contains(&also), "{}: {written}", file.file_name());
        }
    }
}

#[test]
fn the_parts_of_the_paper_are_found() {
    let catalogs = Catalogs::builtin();
    let motor = |name| catalogs.motor(name).map(|m| (m.id.as_str(), m.mass_kg));
    assert_eq!(motor("F11-10"), Ok(("F11-10", Some(7.5))));
    assert_eq!(motor("f11-5"), Ok(("F11-5", Some(5.0))));
    assert_eq!(motor("J 8.2"), Ok(("J 8.2 (129-)", Some(2.0))));
    assert!(matches!(motor("J"), Err(PartError::Ambiguous { candidates, .. }) if candidates.len() == 5));
    assert_eq!(catalogs.gear("CSF-58-100").map(|g| g.id.as_str()), Ok("HFUC-58-100"));
    assert_eq!(catalogs.gear("hfuc-58-100").map(|g| g.ratio), Ok(100.0));
    assert!(catalogs.gear("HFUS-14-50").is_err(), "an outline is no other name");
    assert_eq!(catalogs.profile("SHS160x160x10").map(|p| p.shape), Ok(ProfileShape::Square));
    let s355 = catalogs.material("structural steel S355").expect("the whole name");
    assert_eq!((s355.name.as_str(), s355.class), ("Structural steel S355", MaterialClass::Metal));
    assert_eq!(catalogs.material("S355"), Ok(s355));
    assert_eq!(catalogs.material("titanium ti").map(|m| m.density_kg_m3), Ok(4430.0));
    assert!(matches!(catalogs.material("Boron/epoxy"), Err(PartError::Ambiguous { .. })));
}

#[test]
fn a_blank_cell_is_unknown_and_never_zero() {
    let catalogs = Catalogs::builtin();
    let shg = catalogs.gear("SHG-65-160").expect("built in");
    assert_eq!((shg.average_input_speed_limit_rpm, shg.mass_component_set_kg), (None, None));
    assert_eq!((shg.buckling_torque_nm, shg.envelope.hollow_bore_m), (None, Some(0.08)));
    let orbital = catalogs.motor("J 8.2").expect("built in");
    assert_eq!((orbital.kind, orbital.rotor_inertia_kgm2), (MotorKind::HydraulicOrbital, None));
    let sold = |m: &&Motor| m.kind != MotorKind::OfActuator;
    assert!(
        catalogs
            .motors
            .iter()
            .filter(sold)
            .all(|m| m.mass_kg != Some(0.0) && m.rotor_inertia_kgm2 != Some(0.0))
    );
}

#[test]
fn every_row_knows_its_file_line_and_trust() {
    let catalogs = Catalogs::builtin();
    let gear = catalogs.gear("HFUC-14-30").expect("built in");
    assert_eq!((gear.provenance.file.as_str(), gear.provenance.line), ("built-in gears.csv", 2));
    let unverified = &gear.provenance.unverified_fields;
    assert_eq!(unverified[..2], ["mass_component_set_kg", "efficiency_rated_2000rpm"]);
    assert!(!unverified.iter().any(|f| f.starts_with("bearing_")), "{unverified:?}");
    let motor = catalogs.motor("F11-10").expect("built in");
    assert_eq!(motor.provenance.confidence, Confidence::FromMemory);
    let unverified = &motor.provenance.unverified_fields;
    assert!(unverified.iter().any(|f| f == "rated_torque_nm") && !unverified.iter().any(|f| f == "mass_kg"));
}

#[test]
fn every_housed_unit_has_the_figures_its_output_bearing_is_checked_with() {
    for gear in Catalogs::builtin().gears.iter().filter(|gear| gear.kind == GearKind::StrainWave) {
        let bearing = gear.bearing;
        let figures = [bearing.pitch_diameter_m, bearing.static_load_rating_n, bearing.dynamic_load_rating_n];
        assert!(figures.iter().all(Option::is_some) && bearing.offset_m.is_some(), "{}", gear.id);
        let [pitch_m, static_n, dynamic_n] = figures.map(Option::unwrap_or_default);
        assert!(static_n > dynamic_n, "{}: a crossed-roller bearing holds more at rest", gear.id);
        // Standing still with the least safety the vendor allows, a bearing bears more than while it runs.
        let at_rest_nm = pitch_m * static_n / (2.0 * 1.5);
        assert!(gear.permissible_tilting_moment_nm.is_some_and(|m| m < at_rest_nm), "{}", gear.id);
    }
    let gear = Catalogs::builtin().gear("CSG-20-100").cloned().expect("built in");
    let printed = [Some(0.050), Some(0.0095), Some(9000.0), Some(5780.0)];
    let bearing = gear.bearing;
    let read = [
        bearing.pitch_diameter_m,
        bearing.offset_m,
        bearing.static_load_rating_n,
        bearing.dynamic_load_rating_n,
    ];
    assert_eq!(read, printed);
}

#[test]
fn a_compressive_strength_is_given_where_it_differs() {
    let catalogs = Catalogs::builtin();
    let kevlar = catalogs.material("Kevlar 49/epoxy UD").expect("built in");
    assert_eq!((kevlar.strength_pa, kevlar.compressive_strength_pa), (Some(1.4e9), Some(3.35e8)));
    for material in catalogs.materials.iter().filter(|m| m.class == MaterialClass::Composite) {
        assert!(material.compressive_strength_pa.is_some(), "{}", material.name);
    }
    assert!(catalogs.material("S355").is_ok_and(|m| m.compressive_strength_pa.is_none()));
}

#[test]
fn only_unidirectional_laminates_are_marked_so() {
    let catalogs = Catalogs::builtin();
    let marked: Vec<_> = catalogs.materials.iter().filter(|m| m.unidirectional).collect();
    assert_eq!(marked.len(), 10);
    assert!(marked.iter().all(|m| m.name.contains("UD") && m.class != MaterialClass::Metal));
}

#[test]
fn the_built_in_catalogs_warn_of_the_four_exceptions_in_the_vendor_tables_only() {
    let catalogs = Catalogs::builtin();
    let shown: Vec<_> = catalogs.warnings.iter().map(|w| format!("{}: {}", w.field, w.problem)).collect();
    assert_eq!(
        shown,
        [
            "rated_torque_nm: HFUC-50-50 = 122 is out of line with HFUC-45-50 = 176",
            "average_torque_limit_nm: HFUC-50-50 = 175 is out of line with HFUC-45-50 = 265",
            "momentary_peak_torque_nm: HFUC-17-120 = 86 is out of line with HFUC-17-100 = 108",
            "momentary_peak_torque_nm: SHG-17-120 = 112 is out of line with SHG-17-100 = 143",
        ]
    );
}

#[test]
fn twelve_planted_faults_are_all_reported_and_nothing_else() {
    let gears = format!(
        "{GEAR_HEADER}\n\
         MY,20,100,40,49,82,147,14,48,16e3,25e3,29e3,own,verified\n\
         MY,25,100,\"67,5\",108,157,284,29,108,31e3,50e3,57e3,own,verified\n\
         MY,32,100,137,216,333,647,54,196,67e3,NaN,120e3,own,verified\n\
         MY,40,100,265,372,300,1080,108,382,130e3,200e3,230e3,own,verified\n\
         MY,45,100,353,500,-705,1440,168,598,180e3,290e3,330e3,own,verified\n\
         MY,50,100,470,666,980,1860,235,843,250e3,200e3,440e3,own,verified\n\
         MY,20,100,40,49,82,147,14,48,16e3,25e3,29e3,own,verified\n\
         MY,58,100,600,900,1500,2800,300,1000,400e3,610e3,710e3,own,checked\n\
         MY,65,100,600,900,1500,2800,300,1000,400e3,610e3,710e3,own\n"
    );
    let motors = format!(
        "{MOTOR_HEADER},weight\n\
         brushles servo,M1,1.0,3.0,2.0,own,verified,\n\
         ac-servo,M2,1.0,0.5,2.0,own,verified,\n\
         ac-servo,M3,1.0,3.0,0,own,verified,\n"
    );
    let found = faults(&[("gears.csv", &gears), ("motors.csv", &motors)]);
    let expected: [(&str, usize, &str); 12] = [
        ("gears.csv", 10, ""),
        ("gears.csv", 3, "rated_torque_nm"),
        ("gears.csv", 4, "k2_nm_per_rad"),
        ("gears.csv", 5, "repeated_peak_torque_nm"),
        ("gears.csv", 6, "repeated_peak_torque_nm"),
        ("gears.csv", 7, "k2_nm_per_rad"),
        ("gears.csv", 8, "series,size,ratio"),
        ("gears.csv", 9, "confidence"),
        ("motors.csv", 1, "weight"),
        ("motors.csv", 2, "type"),
        ("motors.csv", 3, "peak_torque_nm"),
        ("motors.csv", 4, "mass_kg"),
    ];
    let expected = expected.map(|(file, line, field)| (file.to_string(), Some(line), field));
    let (mut seen, mut wanted) = (places(&found), expected.to_vec());
    seen.sort();
    wanted.sort();
    assert_eq!(seen, wanted, "{found:#?}");
    assert!(found.iter().all(|f| !f.hint.is_empty()), "{found:#?}");
}

#[test]
fn faults_are_listed_by_file_and_line() {
    let gears = format!("{GEAR_HEADER}\nMY,0,100,,,,,3,2,,,,own,maybe\nMY,1,1,x,,,,,,,,,own,verified\n");
    let found = faults(&[("gears.csv", &gears)]);
    assert_eq!(places(&found).iter().map(|p| p.1).collect::<Vec<_>>(), [Some(2), Some(2), Some(2), Some(3)]);
}

#[test]
fn messages_show_the_value_and_what_is_allowed() {
    let materials = "name,class,e_pa,g_pa,density_kg_m3,poisson,source,confidence\n\
        my steel,metal,210,8.1e10,7850,0.3,own,verified\n\
        my iron,metall,2.1e11,9.9e10,7850,0.3,own,verified\n\
        my bronze,metal,1.1e11,9.9e10,8800,0.34,own,verified\n";
    let found = faults(&[("materials.csv", materials)]);
    let texts: Vec<_> = found.iter().map(ToString::to_string).collect();
    assert_eq!(found.len(), 3, "{texts:#?}");
    assert!(texts[0].contains("e_pa: = 210 is outside 1e8 to 2e12") && texts[0].contains("1 GPa = 1e9 Pa"));
    assert!(texts[1].contains(
        "did you mean \"metal\"? allowed: metal; composite; metal-matrix; polymer; wood; other; MMC"
    ));
    assert!(texts[2].contains("g_pa") && texts[2].contains("G = E/2(1+nu)"));
}

#[test]
fn profiles_must_agree_with_their_outline() {
    let profiles = "designation,shape,material_family,outer_b_m,outer_h_m,wall_t_m,area_m2,source,confidence\n\
        A,square,steel,0.1,0.1,0.05,,own,verified\n\
        B,square,steel,0.1,0.12,0.005,,own,verified\n\
        C,round,steel,0.1,0.1,0.005,1.0e-3,own,verified\n\
        D,round,wood,0.1,0.1,0.005,,own,verified\n\
        E,square,steel,100,100,5,,own,verified\n";
    let found = faults(&[("profiles.csv", profiles)]);
    let columns: Vec<_> = places(&found).iter().map(|p| (p.1.unwrap_or(0), p.2.to_string())).collect();
    let expected = [
        (2, "wall_t_m"),
        (3, "outer_h_m"),
        (4, "area_m2"),
        (5, "material_family"),
        (6, "outer_b_m"),
        (6, "outer_h_m"),
    ];
    let mut sorted = columns;
    sorted.sort();
    assert_eq!(sorted, expected.map(|(line, column)| (line, column.to_string())), "{found:#?}");
}

#[test]
fn an_overlay_adds_rows_and_replaces_rows_of_the_same_name() {
    let gears = format!(
        "{GEAR_HEADER}\nHFUC,58,100,,,,,,,,600e3,,own test,verified\nMY,20,100,,,,,,,,25e3,,own,third party\n"
    );
    let catalogs = load(&[("gears.csv", &gears)]).expect("sound");
    assert_eq!(catalogs.gears.len(), 195 + 52 + 1);
    let replaced = catalogs.gear("HFUC-58-100").expect("there");
    assert_eq!((replaced.k2_nm_per_rad, replaced.rated_torque_nm), (Some(600e3), None));
    assert_eq!((replaced.provenance.line, replaced.provenance.source.as_str()), (2, "own test"));
    assert!(
        replaced.provenance.file.ends_with("gears.csv") && !replaced.provenance.file.contains("built-in")
    );
    assert_eq!(catalogs.gear("MY-20-100").map(|g| g.k2_nm_per_rad), Ok(Some(25e3)));
    assert_eq!(catalogs.motors, Catalogs::builtin().motors);
    let own = catalogs.loaded.last().expect("files");
    assert_eq!((own.rows, own.replaced, own.by_confidence), (2, 1, [1, 1, 0, 0]));
}

#[test]
fn the_order_of_rows_does_not_matter_to_lookups() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("catalogs/motors.csv"))
        .expect("the built-in file");
    let (header, rows) = text.split_once('\n').expect("a header");
    let mut reversed: Vec<&str> = rows.lines().collect();
    reversed.reverse();
    let catalogs = load(&[("motors.csv", &format!("{header}\n{}\n", reversed.join("\n")))]).expect("sound");
    let builtin = Catalogs::builtin();
    for name in builtin.motors.iter().map(|m| m.id.as_str()).chain(["J 8.2", "F11-5", "J", "EC-i 40"]) {
        let figures = |c: &Catalogs| c.motor(name).map(|m| (m.id.clone(), m.mass_kg, m.rated_torque_nm));
        assert_eq!(figures(&catalogs), figures(&builtin), "{name}");
    }
}

#[test]
fn the_same_bytes_give_the_same_catalogs() {
    assert_eq!(Catalogs::builtin(), Catalogs::builtin());
    let files = [("motors.csv", format!("{MOTOR_HEADER}\nac-servo,M1,1,3,,own,verified\n"))];
    let folder = folder(&[(files[0].0, &files[0].1)]);
    let loaded = || Catalogs::load(Some(folder.path())).expect("sound");
    assert_eq!(loaded(), loaded());
}

#[test]
fn a_folder_that_does_not_exist_or_holds_no_catalog_is_an_error() {
    let missing = Catalogs::load(Some(Path::new("/no/such/folder"))).expect_err("missing");
    assert!(
        matches!(&missing, InputError::Unreadable { file, .. } if file == "/no/such/folder"),
        "{missing}"
    );
    let found = faults(&[("gear.csv", "")]);
    assert_eq!(found.len(), 1);
    assert!(found[0].hint.contains("should gear.csv be gears.csv?"), "{}", found[0]);
}

#[test]
fn a_csv_file_of_another_name_is_warned_of() {
    let motors = format!("{MOTOR_HEADER}\nac-servo,M1,1,3,,own,verified\n");
    let catalogs = load(&[("motors.csv", &motors), ("gear.csv", "")]).expect("sound");
    assert!(catalogs.warnings.iter().any(|w| w.file.ends_with("gear.csv") && w.problem == "is not read"));
}
