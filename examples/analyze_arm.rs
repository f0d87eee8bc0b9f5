//! Statics and modes of an arm with two joints: how far the tip deflects, and what should be stiffened.
//!
//! Run: cargo run --example analyze_arm

use armwright::arm::read_arm_document;
use armwright::arm::{JointModel, LinkModel};
use armwright::arm::{LoadCase, Payload};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use nalgebra::Vector3;

const ARM: &str = r#"{
  "name": "two-joint arm",
  "chain": [
    {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "gear": "HFUC-40-100", "mass_kg": 8.0},
    {"type": "link", "name": "upper_arm", "vector_m": [0.6, 0, 0], "material": "Aluminium 6061-T6",
     "section": {"shape": "rectangular_tube", "width_m": 0.1, "height_m": 0.1, "wall_m": 0.005}},
    {"type": "joint", "name": "elbow", "axis": [0, 1, 0], "gear": "HFUC-25-100", "mass_kg": 3.0},
    {"type": "link", "name": "forearm", "vector_m": [0.4, 0, 0], "material": "Aluminium 6061-T6",
     "section": {"shape": "round_tube", "diameter_m": 0.08, "wall_m": 0.004}}
  ]
}"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let catalogs = Catalogs::builtin();
    let arm = read_arm_document(Document::parse("arm", ARM)?, &catalogs)?;
    let case = LoadCase {
        name: "elbow bent".into(),
        pose_deg: vec![-30.0, 60.0],
        payload: Payload { mass_kg: 5.0, cg_m: Vector3::new(0.05, 0.0, 0.0), ..Payload::default() },
        tip_force_n: Vector3::zeros(),
        tip_moment_nm: Vector3::zeros(),
        links: LinkModel::Full,
        joints: JointModel::ThreeSegment,
        water: None,
    };
    let chain = Chain::new(&arm.structure(case.joints), case.links);
    let posed = chain.pose(&case);
    let statics = posed.statics();
    println!("{}: {:.2} kg, {}", arm.name, arm.mass_kg(), case.name);
    for (joint, torque_nm) in &statics.joint_torques_nm {
        println!("  torque on {joint:<10} {torque_nm:8.2} N m");
    }
    let tip_mm = statics.tip_displacement_m * 1e3;
    println!("  tip moves by {:.3} mm (down {:.3} mm)", tip_mm.norm(), -tip_mm.z);
    for (element, share_m) in &statics.shares_m {
        println!("    {element:<12} {:8.4} mm down", -share_m.z * 1e3);
    }
    for mode in posed.modes(&statics, 3) {
        let stiffen = mode.strain_energy.iter().max_by(|a, b| a.1.total_cmp(&b.1)).expect("the arm yields");
        println!(
            "  mode at {:7.2} Hz: {:.0} % of its strain energy is in {}",
            mode.frequency_hz,
            100.0 * stiffen.1,
            stiffen.0
        );
    }
    Ok(())
}
