//! Computes deflection and frequencies of the paper's arm from its Table 1, with rigid links and with links that
//! deform, and prints them next to the paper's own numbers.
//!
//! Run: cargo run --example paper_frequencies

use armwright::arm::LinkModel;
use armwright::paper::arm::PaperArm;

const PRINTED_HZ: [f64; 3] = [14.8, 74.6, 159.6];

fn main() {
    let arm = PaperArm::table_1();
    println!("links      tip mm      f1 Hz      f2 Hz      f3 Hz");
    for links in [LinkModel::Rigid, LinkModel::Bending, LinkModel::Full] {
        let solved = arm.solve(links);
        let [f1, f2, f3] = [0, 1, 2].map(|k| solved.in_plane_hz[k]);
        let tip_mm = solved.statics.tip_displacement_m.norm() * 1e3;
        println!("{:<8} {tip_mm:8.4} {f1:10.3} {f2:10.3} {f3:10.3}", links.word());
    }
    let [f1, f2, f3] = PRINTED_HZ;
    println!("{:<8} {:8.2} {f1:10.1} {f2:10.1} {f3:10.1}", "printed", 1.39);
    let stiff = arm.with_stiffness_factors([4.0, 1.0, 1.0]).solve(LinkModel::Rigid);
    let before = arm.solve(LinkModel::Rigid).in_plane_hz[0];
    println!(
        "joint 2 four times as stiff: lowest mode {:+.1} %",
        100.0 * (stiff.in_plane_hz[0] / before - 1.0)
    );
}
