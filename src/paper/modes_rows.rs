//! Rows on the paper's dynamic numbers: frequencies, the effect of a joint four times as stiff, and the bandwidth
//! of the servo.

use super::arm::PaperArm;
use super::coupled::{CoupledArm, single_spring_hz};
use super::rows::PaperRow;
use super::third_spring::{PRINTED_HZ, Reading};
use crate::arm::LinkModel;
use crate::arm::section::{LinkMaterial, Section};
use crate::report::number::{fixed, percent_change, significant};

/// All rows about frequencies. `matching` is an interpretation of the third spring that gives the paper's
/// frequencies.
pub(crate) fn rows(matching: &Reading) -> Vec<PaperRow> {
    let arm = PaperArm::table_1();
    [
        frequencies(&arm, matching),
        four_times(&arm, matching),
        checks(&arm),
        tip_force(&arm),
        bandwidth(&arm),
        thin_tubes(),
    ]
    .concat()
}

fn frequencies(arm: &PaperArm, matching: &Reading) -> Vec<PaperRow> {
    let flexible = arm.solve(LinkModel::Full).in_plane_hz;
    let literal = CoupledArm::new(arm).frequencies_hz();
    let longer = PaperArm { third_link_m: 0.20, ..arm.clone() };
    let longer_rigid = CoupledArm::new(&longer).frequencies_hz();
    let longer_flexible = longer.solve(LinkModel::Full).in_plane_hz;
    let words = ["14.8", "74.6", "159.6"];
    let set = |ids: [&'static str; 3],
               names: [&'static str; 3],
               ours: [f64; 3],
               exact: &[f64],
               reading: &str,
               reason: &str| {
        (0..3)
            .map(|i| {
                PaperRow::new(ids[i], names[i], "Hz", 3)
                    .paper(PRINTED_HZ[i], words[i])
                    .reading(ours[i], reading)
                    .exact(exact[i])
                    .because(if i == 0 { reason } else { "" })
            })
            .collect::<Vec<_>>()
    };
    let found = matching_words(arm, matching);
    [
        set(
            ["f1_literal", "f2_literal", "f3_literal"],
            ["lowest mode, Table 1 literally", "second mode, Table 1 literally", "third mode, Table 1 literally"],
            literal,
            &flexible,
            "Eqs 16, 17 with rigid links, load 0.05 m from the wrist",
            "the printed frequencies do not follow from Table 1; the exact frame has flexible links",
        ),
        set(
            ["f1_third_link", "f2_third_link", "f3_third_link"],
            ["lowest mode, third link 0.20 m", "second mode, third link 0.20 m", "third mode, third link 0.20 m"],
            longer_rigid,
            &longer_flexible,
            "Eqs 16, 17 with rigid links, load 0.20 m from the wrist",
            "a longer third link brings the third mode near, the lowest stays too high: mass is missing at the wrist",
        ),
        set(
            ["f1_matching", "f2_matching", "f3_matching"],
            ["lowest mode, masses that match", "second mode, masses that match", "third mode, masses that match"],
            matching.frequencies_hz,
            &matching.arm.solve(LinkModel::Full).in_plane_hz,
            &found,
            "mass at the wrist is missing from Table 1; other third springs with other masses give the same \
             three frequencies, so they cannot identify it (see the table of third springs)",
        ),
    ]
    .concat()
}

/// Text that states the masses and the third spring with which Eq 16 gives the frequencies that the paper prints.
fn matching_words(arm: &PaperArm, matching: &Reading) -> String {
    format!(
        "{} kg at and beyond the wrist (Table 1: {} kg), third spring K4 and K5 in series, \
         {} kg at {} m: within {} %",
        significant(matching.outboard_kg(), 4),
        significant(arm.wrist_kg + arm.load_kg, 4),
        significant(matching.arm.load_kg, 3),
        fixed(matching.arm.third_link_m, 4),
        fixed(100.0 * matching.worst(), 3)
    )
}

fn four_times(arm: &PaperArm, matching: &Reading) -> Vec<PaperRow> {
    let rigid = |factors| {
        let stiffer = CoupledArm::new(&arm.with_stiffness_factors(factors)).frequencies_hz();
        100.0 * (stiffer[0] / CoupledArm::new(arm).frequencies_hz()[0] - 1.0)
    };
    let flexible = |factors| {
        let stiffer = arm.with_stiffness_factors(factors).solve(LinkModel::Full);
        100.0 * (stiffer.lowest_hz() / arm.solve(LinkModel::Full).lowest_hz() - 1.0)
    };
    let row = |id, quantity, factors: [f64; 3]| {
        PaperRow::new(id, quantity, "%", 1)
            .reading(rigid(factors), "rise of the lowest mode, Table 1 literally, rigid links")
            .exact(flexible(factors))
    };
    let single = 100.0 * (single_spring_hz(4.0, 1.0) / single_spring_hz(1.0, 1.0) - 1.0);
    vec![
        PaperRow::new("four_k_joint_2_matching", "4 x K of joint 2, masses that match", "%", 1)
            .paper(70.0, "about 70")
            .reading(100.0 * (matching.four_times_joint_2 - 1.0), "rise of the lowest mode, rigid links"),
        row("four_k_joint_2", "4 x K of joint 2", [4.0, 1.0, 1.0]).paper(70.0, "about 70").because(
            "more wrist mass than Table 1 lowers the rise to the paper's; flexible links lower it too",
        ),
        row("four_k_joint_3", "4 x K of joint 3", [1.0, 4.0, 1.0]),
        row("four_k_joint_4", "4 x K of joint 4", [1.0, 1.0, 4.0]),
        row("four_k_all", "4 x K of all joints", [4.0; 3])
            .because("with rigid links every frequency doubles; flexible links keep their own compliance"),
        PaperRow::new("four_k_single", "4 x K of one spring and mass (Eq 18)", "%", 1)
            .paper(100.0, "100 (doubling)")
            .reading(single, "Eq 18")
            .because("the arm is coupled: no single joint reaches it"),
    ]
}

fn checks(arm: &PaperArm) -> Vec<PaperRow> {
    let rigid = arm.solve(LinkModel::Rigid).in_plane_hz;
    let flexible = arm.solve(LinkModel::Full).in_plane_hz;
    let printed = CoupledArm::new(arm).frequencies_hz();
    let gap = printed.iter().zip(&rigid).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
    vec![
        PaperRow::new("margin_rigid", "finite elements against Eq 16, rigid links", "%", 6)
            .paper(1.5, "within 1.5")
            .reading(100.0 * gap, "general mechanics with rigid links beside the cubic of Eq 17, worst mode")
            .because("the two are the same model, so a margin of 1.5 % must come from something else"),
        PaperRow::new("margin_flexible", "lowest mode, flexible against rigid links", "%", 1)
            .paper(1.5, "within 1.5")
            .exact(100.0 * (flexible[0] / rigid[0] - 1.0))
            .because("what flexible steel links cost"),
    ]
}

fn tip_force(arm: &PaperArm) -> Vec<PaperRow> {
    let coupled = CoupledArm::new(arm);
    let micrometres = |right_side| 1e6 * coupled.tip_compliance_m_per_n(right_side).unwrap_or(f64::NAN);
    let pulled = |links| {
        let structure = arm.arm().structure(crate::arm::JointModel::K2);
        let chain = crate::mechanics::chain::Chain::new(&structure, links);
        let tip = |force_n: f64| {
            let force = nalgebra::Vector3::z() * force_n;
            chain.pose_rad(&[0.0; 3], &arm.payload(), force).statics().tip_displacement_m.z
        };
        1e6 * (tip(1.0) - tip(0.0))
    };
    vec![
        PaperRow::new("tip_compliance_printed", "static answer to F, right side as printed", "um/N", 4)
            .reading(micrometres(&coupled.printed_right_side_m()), "Eq 16 with [l2, l2, l3] F")
            .exact(pulled(LinkModel::Full))
            .because("the virtual work of a vertical tip force on psi_1 is l1 F: the first entry must be l1"),
        PaperRow::new("tip_compliance_corrected", "static answer to F, right side corrected", "um/N", 4)
            .reading(micrometres(&coupled.lengths_m), "Eq 16 with [l1, l2, l3] F")
            .exact(pulled(LinkModel::Full))
            .because(format!(
                "rigid links in the general mechanics give {}",
                fixed(pulled(LinkModel::Rigid), 4)
            )),
    ]
}

fn bandwidth(arm: &PaperArm) -> Vec<PaperRow> {
    let lowest = arm.solve(LinkModel::Full).lowest_hz();
    let row = |id, quantity, ratio: f64| {
        let amplification = 1.0 / (1.0 - ratio.powi(-2));
        PaperRow::new(id, quantity, "Hz", 2).exact(lowest / ratio).because(format!(
            "a disturbance at that frequency is amplified {} times",
            fixed(amplification, 3)
        ))
    };
    vec![
        PaperRow::new("servo_bandwidth", "servo bandwidth must lie below", "Hz", 2)
            .paper(15.0, "about 15")
            .reading(CoupledArm::new(arm).frequencies_hz()[0], "the lowest mode, rigid links")
            .exact(lowest)
            .because("at the lowest mode itself only damping limits the motion"),
        row("servo_bandwidth_2", "servo bandwidth with a margin of 2", 2.0),
        row("servo_bandwidth_3", "servo bandwidth with a margin of 3", 3.0),
    ]
}

/// Rows on the lowest mode if both links are thin tubes: outer size 0.07 m, wall 2 mm.
fn thin_tubes() -> Vec<PaperRow> {
    let aluminium = LinkMaterial {
        youngs_modulus_pa: 7.0e10,
        shear_modulus_pa: 7.0e10 / 2.66,
        density_kg_m3: 2700.0,
        poisson: 0.33,
        strength: None,
        class: None,
    };
    let thin = Section::RectangularTube { width_m: 0.07, height_m: 0.07, wall_m: 0.002 };
    let steel = PaperArm { sections: [thin; 2], ..PaperArm::table_1() };
    let light = PaperArm { material: aluminium, ..steel.clone() };
    let [steel_hz, light_hz] = [&steel, &light].map(|arm| arm.solve(LinkModel::Full).lowest_hz());
    let row = |id, quantity, arm: &PaperArm, exact: f64| {
        PaperRow::new(id, quantity, "Hz", 1)
            .reading(CoupledArm::new(arm).frequencies_hz()[0], "Eqs 16, 17: rigid links")
            .exact(exact)
    };
    vec![
        row("thin_steel", "lowest mode, links of 0.07 m x 2 mm steel", &steel, steel_hz),
        row("thin_aluminium", "lowest mode, links of 0.07 m x 2 mm aluminium", &light, light_hz).because(format!(
            "rigid links rank aluminium first; in truth it is {} against steel: for thin tubes the links may not be \
             taken as rigid",
            percent_change(light_hz / steel_hz, 0)
        )),
    ]
}
