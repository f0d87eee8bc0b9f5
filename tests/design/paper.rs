//! The paper's numbers and the claims of its figures, to the digits the project states.

use crate::paper_support::{check_xml, file, table};

use armwright::arm::Curve;
use armwright::arm::LinkModel;
use armwright::arm::Section;
use armwright::catalog::Catalogs;
use armwright::paper;
use armwright::paper::arm::PaperArm;
use armwright::paper::claim::Claim;
use armwright::paper::coupled::CoupledArm;
use armwright::paper::equations::deflection_eq_4_m;
use armwright::paper::figures;
use armwright::paper::figures::{FORCE_N, LENGTH_M, WALL_M, fig2, fig3, fig4};
use armwright::paper::remedies::{CatalogGears, connections, error_left, stiffer};
use armwright::paper::rows::PaperRow;
use armwright::paper::third_spring::{PRINTED_HZ, closest_reading, readings};
use armwright::paper::{NAMES, PaperError, PaperStudyOutput, table1};

fn row(rows: &[PaperRow], id: &str) -> PaperRow {
    rows.iter().find(|r| r.id == id).unwrap_or_else(|| panic!("row {id}")).clone()
}

/// Asserts that a number, rounded as a statement rounds it, is the stated one.
fn assert_digits(what: &str, value: Option<f64>, stated: &str) {
    let decimals = stated.split_once('.').map_or(0, |(_, d)| d.len());
    let ours = format!("{:.*}", decimals, value.unwrap_or_else(|| panic!("{what} has no value")));
    assert_eq!(ours, stated, "{what}: {value:?}");
}

fn output(name: &str) -> PaperStudyOutput {
    paper::run(name, &Catalogs::builtin()).unwrap()
}

#[test]
fn the_papers_numbers_come_out_under_the_stated_readings() {
    let rows = table1::compute(&Catalogs::builtin()).unwrap().rows;
    for (id, stated) in [
        ("torque_joint_2", "568.3"),
        ("torque_joint_3", "112.4"),
        ("torque_joint_4", "2.45"),
        ("deflection_joint_2", "1.2171"),
        ("deflection_joint_3", "0.1388"),
        ("deflection_joint_4", "0.0000"),
        ("deflection_link_1", "0.0264"),
        ("deflection_link_2", "0.0046"),
        ("deflection_links", "0.0310"),
        ("deflection_links_drive_only", "0.0189"),
        ("deflection_total", "1.3868"),
        ("f1_literal", "15.689"),
        ("f2_literal", "84.892"),
        ("f3_literal", "560.62"),
        ("f1_third_link", "15.27"),
        ("f2_third_link", "74.38"),
        ("f3_third_link", "164.3"),
        ("four_k_joint_2", "75.2"),
        ("four_k_joint_2_matching", "70.9"),
        ("four_k_joint_3", "3.6"),
        ("four_k_all", "100.0"),
        ("four_k_single", "100.0"),
        ("thin_steel", "20.3"),
        ("t_lin_factor", "0.5097"),
        ("t_rot_rotor", "0.14"),
        ("tip_compliance_corrected", "3.7725"),
    ] {
        assert_digits(id, row(&rows, id).reading_value, stated);
    }
}

#[test]
fn the_exact_frame_gives_the_values_of_the_independent_programs() {
    let rows = table1::compute(&Catalogs::builtin()).unwrap().rows;
    for (id, stated) in [
        ("deflection_total", "1.4815"),
        ("deflection_links", "0.0638"),
        ("deflection_links_percent", "4.3"),
        ("deflection_joints", "1.4177"),
        ("deflection_joints_catalog_k2", "1.413"),
        ("deflection_joints_catalog_curve", "1.698"),
        ("f1_literal", "15.350"),
        ("margin_flexible", "-2.2"),
        ("thin_steel", "11.1"),
        ("thin_aluminium", "7.3"),
        ("t_rot_rotor", "14.4"),
        ("joint_2_acceleration", "3.7"),
    ] {
        assert_digits(id, row(&rows, id).exact, stated);
    }
    // 16 Timoshenko elements a link against polynomials over the whole link
    for (id, fedem_hz) in [("f1_literal", 15.350), ("f2_literal", 82.045), ("f3_literal", 547.28)] {
        let ours = row(&rows, id).exact.unwrap();
        assert!((ours / fedem_hz - 1.0).abs() < 3e-4, "{id}: {ours} against {fedem_hz}");
    }
}

#[test]
fn rigid_links_rank_thin_aluminium_above_thin_steel_and_flexible_links_do_not() {
    let rows = table1::compute(&Catalogs::builtin()).unwrap().rows;
    let [steel, aluminium] = ["thin_steel", "thin_aluminium"].map(|id| row(&rows, id));
    assert!(aluminium.reading_value > steel.reading_value && aluminium.exact < steel.exact);
    assert!((aluminium.reading_value.unwrap() - 20.9).abs() < 0.1);
}

#[test]
fn the_cubic_of_eq_17_and_the_general_mechanics_agree_to_ten_digits() {
    for third_link_m in [0.05, 0.124, 0.20, 0.5] {
        let arm = PaperArm { third_link_m, ..PaperArm::table_1() };
        let cubic = CoupledArm::new(&arm).frequencies_hz();
        let general = arm.solve(LinkModel::Rigid).in_plane_hz;
        assert_eq!(general.len(), 3);
        for (a, b) in cubic.iter().zip(&general) {
            assert!((a / b - 1.0).abs() < 1e-10, "{a} against {b}");
        }
    }
}

#[test]
fn the_tip_answers_a_force_as_the_corrected_right_side_says() {
    let arm = CoupledArm::new(&PaperArm::table_1());
    let by_hand = 1.35f64.powi(2) / 607e3 + 0.55f64.powi(2) / 405e3 + 0.05f64.powi(2) / 108e3;
    let corrected = arm.tip_compliance_m_per_n(&arm.lengths_m).unwrap();
    assert!((corrected / by_hand - 1.0).abs() < 1e-12);
    assert!(arm.tip_compliance_m_per_n(&arm.printed_right_side_m()).unwrap() < 0.9 * corrected);
}

#[test]
fn three_frequencies_do_not_identify_the_third_spring() {
    let found = readings();
    assert_eq!(found.len(), 3);
    for reading in &found {
        assert!(reading.worst() < 1e-9, "{reading:?}");
        // confirmed by the general mechanics, not by the equations that were searched
        for (hz, printed) in reading.arm.solve(LinkModel::Rigid).in_plane_hz.iter().zip(PRINTED_HZ) {
            assert!((hz / printed - 1.0).abs() < 1e-8);
        }
        assert!(reading.outboard_kg() > 16.0 && reading.outboard_kg() < 16.6);
    }
    assert!(found[0].stiffness_nm_per_rad / found[2].stiffness_nm_per_rad > 8.0);
    assert!((found[0].arm.third_link_m / found[2].arm.third_link_m) > 3.0);
}

#[test]
fn the_closest_reading_gives_all_three_frequencies_within_a_twentieth_of_a_percent() {
    let reading = closest_reading();
    assert!(reading.worst() < 5e-4, "{}", reading.worst());
    assert_digits("mass", Some(reading.outboard_kg()), "16.1");
    assert_eq!(reading.arm.wrist_kg, PaperArm::table_1().wrist_kg);
    assert!((reading.stiffness_nm_per_rad - 54e3).abs() < 1e-6);
}

#[test]
fn correcting_for_the_joints_leaves_the_links_and_what_is_unknown_of_the_curve() {
    let gears = CatalogGears::new(&Catalogs::builtin()).unwrap();
    let rows = error_left(&gears);
    let links_m = rows[1].curve_m;
    for (row, error) in rows[2..5].iter().zip([0.05, 0.10, 0.20]) {
        let joints_m = rows[0].curve_m - links_m;
        assert!((row.curve_m - (links_m + error * joints_m)).abs() < 1e-12);
        assert!(row.middle_slope_m < row.curve_m);
    }
    assert_digits("links", Some(1e3 * links_m), "0.064");
    // K2 taken for a gear that follows the curve leaves 1.698 - 1.413 mm and the links
    assert_digits("K2 for the curve", Some(1e3 * (rows[5].curve_m - links_m)), "0.285");
}

#[test]
fn the_inner_drive_is_the_one_to_stiffen() {
    let rows = stiffer(&PaperArm::table_1());
    let best = rows.iter().max_by(|a, b| a.frequency_ratio.total_cmp(&b.frequency_ratio)).unwrap();
    assert_eq!(best.element, "j2");
    assert!(rows.iter().all(|r| r.drop_ratio < 1.0 && r.frequency_ratio > 1.0));
}

#[test]
fn a_connection_adds_torque_over_stiffness_times_lever() {
    for c in connections(&PaperArm::table_1()) {
        let (torque_nm, lever_m) = match c.joint {
            "j2" => (568.288395, 1.35),
            "j3" => (112.398075, 0.55),
            _ => (2.4525, 0.05),
        };
        let by_hand = torque_nm / c.output_nm_per_rad * lever_m;
        assert!((c.added_m / by_hand - 1.0).abs() < 1e-9, "{c:?}");
        assert!((c.motor_side_nm_per_rad * 1e4 / c.output_nm_per_rad - 1.0).abs() < 1e-12);
        assert!(c.frequency_ratio < 1.0);
    }
}

#[test]
fn eq_4_is_the_librarys_bending_link() {
    let catalogs = Catalogs::builtin();
    let steel = catalogs.materials.iter().find(|m| m.name == "Structural steel S235").unwrap();
    let section = Section::RectangularTube { width_m: 0.1, height_m: 0.1, wall_m: WALL_M };
    let p = section.properties(0.3);
    let by_eq_4 = deflection_eq_4_m(
        steel.youngs_modulus_pa * p.second_moment_y_m4,
        LENGTH_M,
        FORCE_N,
        p.area_m2 * steel.density_kg_m3 * 9.81,
        0.0,
    );
    let by_library = figures::library_deflection_m(steel, section, LinkModel::Bending).unwrap();
    assert!((by_eq_4 / by_library - 1.0).abs() < 1e-12);
}

fn claim(claims: &[Claim], id: &str) -> bool {
    claims.iter().find(|c| c.id == id).unwrap_or_else(|| panic!("claim {id}")).holds
}

#[test]
fn fig_2_claims_are_decided() {
    let curves = fig2::curves(&Catalogs::builtin()).unwrap();
    let stated =
        [("steel", "0.305", "0.023"), ("titanium", "0.537", "0.038"), ("aluminium", "0.855", "0.059")];
    for (curve, (name, at_70, at_160)) in curves.iter().zip(stated) {
        assert_eq!((curve.name, curve.points.len()), (name, 10));
        assert_digits(name, curve.points.first().map(|p| 1e3 * p.deflection_m), at_70);
        assert_digits(name, curve.points.last().map(|p| 1e3 * p.deflection_m), at_160);
    }
    let claims = fig2::claims(&curves);
    for id in ["grows_stiffer", "converge_in_mm", "light_gains_more", "aluminium_best"] {
        assert!(claim(&claims, id), "{id}");
    }
    assert!(!claim(&claims, "converge_in_ratio"), "the ratio stays that of the moduli");
}

#[test]
fn fig_3_claim_holds_at_every_section_and_grows_by_the_same_weight() {
    let growths = fig3::growths(&Catalogs::builtin()).unwrap();
    assert_eq!(growths.len(), 20);
    assert!(growths.iter().all(|g| g.by_wall.is_some_and(|wall| g.by_width > wall && wall > 1.0)));
    assert!(claim(&fig3::claims(&growths), "width_beats_wall"));
}

#[test]
fn fig_4_claims_are_decided() {
    let curves = fig4::curves(&Catalogs::builtin()).unwrap();
    let claims = fig4::claims(&curves);
    for id in ["lighter_at_reference", "lighter_with_shear", "sizes_differ"] {
        assert!(claim(&claims, id), "{id}");
    }
    assert!(!claim(&claims, "eq_4_suffices"), "unidirectional tubes shear");
    for curve in &curves {
        let section = curve.at_reference.as_ref().unwrap();
        assert!((1e3 * section.deflection_m - 0.2).abs() < 1e-9, "{}", curve.name);
        assert_eq!(curve.axial, curve.name.contains("UD (axial)"));
    }
}

#[test]
fn every_study_writes_a_summary_and_well_formed_pictures() {
    for name in NAMES {
        let out = output(name);
        assert!(file(&out, "summary.md").starts_with("# "), "{name}");
        assert!(out.terminal.lines().all(|l| l == l.trim_end()), "{name} prints trailing blanks");
        for (file_name, content) in &out.files {
            let text = std::str::from_utf8(content).unwrap();
            assert!(!text.contains("NaN") && !text.contains("inf,"), "{name}/{file_name}");
            if file_name.ends_with(".svg") {
                check_xml(text);
                assert!(text.contains("role=\"img\"") && text.contains("<desc"), "{file_name}");
            }
        }
    }
}

#[test]
fn pictures_carry_their_labels() {
    for (study, labels) in [
        ("fig2-metals", ["steel", "titanium", "aluminium", "[N/m]", "deflection at the end [mm]", "160 mm"]),
        (
            "fig3-wall-or-width",
            ["outer size 70 to 160 mm,", "wall 10 mm", "[N/\u{b5}m]", "[N/m]", "wall 4", "F/\u{3b4}"],
        ),
        (
            "fig4-composites",
            ["aluminium", "boron UD (axial)", "kevlar quasi-isotropic", "SiC/Al 55 vol%", "0.2 mm", "[mm]"],
        ),
    ] {
        let svg = file(&output(study), &format!("{study}.svg"));
        for label in labels {
            assert!(svg.contains(label), "{study}: {label}");
        }
    }
}

#[test]
fn csv_files_have_the_expected_rows_and_read_back() {
    for (study, csv, count) in [
        ("fig2-metals", "fig2-metals.csv", 30),
        ("fig4-composites", "fig4-composites.csv", 70),
        ("fig4-composites", "at-reference.csv", 7),
        ("fig3-wall-or-width", "growth.csv", 20),
        ("paper-table1", "error-left.csv", 6),
        ("paper-table1", "third-spring.csv", 4),
        ("paper-table1", "connections.csv", 12),
        ("paper-table1", "stiffer.csv", 5),
        ("paper-table1", "gears.csv", 4),
        ("paper-table1", "frequency-response.csv", 601),
    ] {
        assert_eq!(table(&output(study), csv).len(), count, "{study}/{csv}");
    }
    let rows = table(&output("paper-table1"), "paper-table1.csv");
    let computed = table1::compute(&Catalogs::builtin()).unwrap().rows;
    assert_eq!(rows.len(), computed.len());
    for (read, row) in rows.iter().zip(&computed) {
        assert_eq!(read["id"], row.id);
        assert_eq!(read["exact"].parse().ok(), row.exact, "{}", row.id);
    }
}

#[test]
fn the_response_starts_at_the_static_compliance_and_peaks_at_the_lowest_mode() {
    let rows = table(&output("paper-table1"), "frequency-response.csv");
    let numbers = |key: &str| -> Vec<f64> { rows.iter().map(|r| r[key].parse().unwrap()).collect() };
    let (hz, rigid) = (numbers("frequency_hz"), numbers("rigid_links_um_per_n"));
    assert!((rigid[0] / 3.7725 - 1.0).abs() < 0.005, "{}", rigid[0]);
    let peak = (0..rigid.len()).max_by(|a, b| rigid[*a].total_cmp(&rigid[*b])).unwrap();
    assert!((hz[peak] / 15.689 - 1.0).abs() < 0.012, "{}", hz[peak]);
}

#[test]
fn unknown_names_and_missing_parts_are_named() {
    assert!(matches!(paper::run("fig5", &Catalogs::builtin()), Err(PaperError::UnknownStudy { .. })));
    for name in NAMES {
        let message = paper::run(name, &Catalogs::default()).unwrap_err().to_string();
        assert!(message.contains("catalogs have no"), "{message}");
    }
}

#[test]
fn a_stiffness_factor_leaves_a_gear_curve_alone() {
    let gears = CatalogGears::new(&Catalogs::builtin()).unwrap();
    let factored = gears.curve.with_stiffness_factors([4.0; 3]);
    assert!(matches!(factored.curves[0], Curve::Windup(_)) && factored == gears.curve);
}
