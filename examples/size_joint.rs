//! Finds the lightest drive that holds the demand of one joint, and tells why lighter gears do not hold it.
//!
//! Run: cargo run --example size_joint

use armwright::catalog::Catalogs;
use armwright::catalog::GearMass;
use armwright::sizing::MotionRequirement;
use armwright::sizing::{DriveFilter, DriveTable};
use armwright::sizing::{JointSizingRow, render_rows};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let catalogs = Catalogs::builtin();
    // The tip must reach 1 m/s in 0.2 s, and is 1.35 m from the axis of the joint.
    let requirement = MotionRequirement { tip_speed_m_s: 1.0, ramp_time_s: 0.2, ..Default::default() };
    requirement.validate()?;
    let motion = requirement.joint_motion(1.35, None);
    // The joint carries a static torque of 120 N m and moves an inertia of 9 kg m².
    let demand = motion.demand(120.0, 9.0);
    println!(
        "static {:.0} N m, accelerating {:.1} N m, emergency stop {:.1} N m, mean {:.1} N m",
        demand.static_torque_nm,
        demand.peak_torque_nm(),
        demand.stop_torque_nm,
        demand.mean_torque_nm()
    );
    let filter = DriveFilter {
        gear_series: Some(vec!["HFUC".into()]),
        ratios: Some(vec![100.0]),
        ..DriveFilter::everything(GearMass::HousedUnit)
    };
    let table = DriveTable::build("elbow", motion, &filter, &catalogs.gears, &catalogs.motors);
    let best = table.first_fit(&demand).ok_or("no drive of the catalogs holds")?;
    let drive = table.drive(best);
    println!("{} of {} drives hold; the lightest:", table.all_fits(&demand).count(), table.len());
    let row = JointSizingRow::new("elbow", &drive, &motion, &demand, table.mass_kg(best));
    print!("{}", render_rows(&[row]));
    println!("rejected gears:");
    for rejection in table.explain(&demand).iter().filter(|r| r.to_string().contains("HFUC-")).take(4) {
        println!("  {rejection}");
    }
    Ok(())
}
