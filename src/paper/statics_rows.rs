//! Rows on the paper's static numbers: torques, deflection, and the part of the deflection that the links cause.

use super::arm::{JOINTS, LINKS, PaperArm};
use super::equations::{EndForce, PrintedDeflection, printed_deflection};
use super::remedies::CatalogGears;
use super::rows::PaperRow;
use crate::arm::LinkModel;
use crate::report::number::{fixed, percent_change};

/// All rows on the paper's static numbers. `gears` are the catalog's gears in the joints of the arm.
pub(crate) fn rows(gears: &CatalogGears) -> Vec<PaperRow> {
    let arm = PaperArm::table_1();
    [torques(&arm), joints(&arm), links(&arm), total(&arm), catalog_gears(gears)].concat()
}

fn torques(arm: &PaperArm) -> Vec<PaperRow> {
    let solved = arm.solve(LinkModel::Full);
    let printed = arm.solve(LinkModel::Rigid);
    let row = |id, quantity, joint: &str| {
        PaperRow::new(id, quantity, "N m", 3)
            .reading(printed.torque_nm(joint), "Eq 7: every weight outboard, once, times its lever")
            .exact(solved.torque_nm(joint))
    };
    vec![
        row("torque_joint_2", "static torque T2", JOINTS[0]).because(
            "the printed sum of cumulative torques would count a weight once for every joint inboard of it",
        ),
        row("torque_joint_3", "static torque T3", JOINTS[1]),
        row("torque_joint_4", "static torque T4", JOINTS[2]),
    ]
}

fn joints(arm: &PaperArm) -> Vec<PaperRow> {
    let printed = printed_deflection(arm, EndForce::AllOutboard);
    let exact = arm.solve(LinkModel::Full);
    let row = |id, quantity, i: usize| {
        PaperRow::new(id, quantity, "mm", 4)
            .reading(1e3 * printed.joints_m[i], "Eq 13 with L_tot to the wrist")
            .exact(1e3 * exact.share_m(JOINTS[i]))
    };
    vec![
        row("deflection_joint_2", "deflection by joint 2", 0)
            .because("the load hangs 0.05 m beyond the wrist: L_tot is 1.35 m there, not 1.30 m"),
        row("deflection_joint_3", "deflection by joint 3", 1).because("0.55 m, not 0.50 m"),
        row("deflection_joint_4", "deflection by joint 4", 2).because("0.05 m, not 0"),
        PaperRow::new("deflection_joints", "deflection by the joints (Eq 14)", "mm", 4)
            .reading(1e3 * printed.joints_m.iter().sum::<f64>(), "sum of the three")
            .exact(1e3 * exact.joints_m()),
    ]
}

fn links(arm: &PaperArm) -> Vec<PaperRow> {
    let printed = printed_deflection(arm, EndForce::AllOutboard);
    let drive_only = printed_deflection(arm, EndForce::DriveAtTheEnd);
    let exact = arm.solve(LinkModel::Full);
    let share =
        format!("{} of {} mm", fixed(1e3 * printed.links_sum_m(), 4), fixed(1e3 * printed.total_m(), 4));
    let row = |id, quantity, i: usize| {
        PaperRow::new(id, quantity, "mm", 4)
            .reading(1e3 * printed.links_m[i], "Eq 4 with F = all outboard weight, T = outboard moment")
            .exact(1e3 * exact.share_m(LINKS[i]))
    };
    vec![
        row("deflection_link_1", "deflection by link 1", 0).because(what_eq_15_drops(arm, &printed)),
        row("deflection_link_2", "deflection by link 2", 1),
        PaperRow::new("deflection_links", "deflection by the links", "mm", 4)
            .paper(0.03, "0.03")
            .reading(1e3 * printed.links_sum_m(), "Eq 15 as printed: the sum of both")
            .exact(1e3 * exact.links_m())
            .because("Eq 15 adds the links' own deflections and drops the end slope of link 1"),
        PaperRow::new("deflection_links_drive_only", "the same, F = motor and gear alone", "mm", 4)
            .paper(0.03, "0.03")
            .reading(1e3 * drive_only.links_sum_m(), "Eq 4 with F as the text words it")
            .because("does not give the printed 0.03: F must be the weight of all that is outboard"),
        PaperRow::new("deflection_links_percent", "the links' part of the deflection", "%", 2)
            .paper(3.0, "less than 3")
            .reading(100.0 * printed.links_sum_m() / printed.total_m(), share)
            .exact(100.0 * exact.links_m() / exact.drop_m())
            .because("with end slopes the links' part is above 3 %; the joints still dominate"),
    ]
}

/// Text that divides the exact deflection of the links into three parts: the part in Eq 15, the part by the end slopes
/// that Eq 15 leaves out, and the part by shear.
fn what_eq_15_drops(arm: &PaperArm, printed: &PrintedDeflection) -> String {
    let [bending, full] = [LinkModel::Bending, LinkModel::Full].map(|model| arm.solve(model).links_m());
    format!(
        "links in all: Eq 15 gives {} mm, end slopes add {} mm, shear adds {} mm",
        fixed(1e3 * printed.links_sum_m(), 4),
        fixed(1e3 * (bending - printed.links_sum_m()), 4),
        fixed(1e3 * (full - bending), 4)
    )
}

fn total(arm: &PaperArm) -> Vec<PaperRow> {
    let printed = printed_deflection(arm, EndForce::AllOutboard);
    vec![
        PaperRow::new("deflection_total", "total deflection (Eq 15)", "mm", 4)
            .paper(1.39, "1.39")
            .reading(1e3 * printed.total_m(), "joints to the wrist plus links without end slopes")
            .exact(1e3 * arm.solve(LinkModel::Full).drop_m())
            .because("the exact figure is at the load, with end slopes and shear"),
    ]
}

/// Largest relative difference between the compliances that a joint has in arm `a` and in arm `b`.
fn worst_gap(a: &PaperArm, b: &PaperArm) -> f64 {
    let compliance = |arm: &PaperArm, i: usize| arm.curves[i].tangent_compliance_rad_per_nm(0.0);
    (0..JOINTS.len()).map(|i| (compliance(a, i) / compliance(b, i) - 1.0).abs()).fold(0.0, f64::max)
}

fn catalog_gears(gears: &CatalogGears) -> Vec<PaperRow> {
    let [k2, curve] = [&gears.middle_slope, &gears.curve].map(|arm| arm.solve(LinkModel::Full));
    let row = |id, quantity| PaperRow::new(id, quantity, "mm", 3);
    vec![
        row("deflection_joints_catalog_k2", "joints at the load, catalog K2")
            .exact(1e3 * k2.joints_m())
            .because(format!(
                "the table's stiffnesses are the gears' middle slopes K2, from an older print, within {} %",
                fixed(100.0 * worst_gap(&PaperArm::table_1(), &gears.middle_slope), 1)
            )),
        row("deflection_joints_catalog_curve", "joints at the load, three-segment curve")
            .exact(1e3 * curve.joints_m())
            .because(format!(
                "{}: the soft first segment up to T1 is a large part of the twist",
                percent_change(curve.joints_m() / k2.joints_m(), 1)
            )),
        row("deflection_total_catalog_curve", "total, three-segment curve, full links")
            .paper(1.39, "1.39")
            .exact(1e3 * curve.drop_m())
            .because("how far the paper's arm would deflect with the catalog's gears"),
    ]
}
