use armwright::arm::*;
use armwright::study::paper::{arm::*, coupled::*, equations::*};
#[test]
fn explore() {
    let a = PaperArm::table_1();
    let s = a.solve(LinkModel::Rigid);
    println!("{:?} {:?}", s.statics.joint_torques_nm, s.in_plane_hz);
    let c = CoupledArm::new(&a).frequencies_hz();
    for (x, y) in c.iter().zip(&s.in_plane_hz) {
        println!("{x} {:e}", x / y - 1.0);
    }
    let s = a.solve(LinkModel::Full);
    println!("{} {} {:?}", s.drop_m(), s.links_m(), s.in_plane_hz);
    println!("{:?}", printed_deflection(&a, EndForce::AllOutboard));
    println!("{:?}", printed_deflection(&a, EndForce::AllOutboard).total_m());
    println!("{:?}", printed_deflection(&a, EndForce::DriveAtTheEnd).links_sum_m());
    println!("{:?}", dynamic_torque_at_joint_2(&a, 100.0, 0.00039));
    for k in [30e3, 40e3, 54e3, 70e3, 90e3, 108e3, 150e3, 1.0 / (2.0 / 108e3 + 1.0 / 17.5e3)] {
        for (m, l, d) in [(8.78, 7.33, 0.124), (12.0, 4.0, 0.2), (8.78, 5.0, 0.05), (3.0, 13.0, 0.1)] {
            let mut b = a.clone();
            b.curves[2] = Curve::Linear(k);
            b.wrist_kg = m;
            b.load_kg = l;
            b.third_link_m = d;
            if let Some(f) = masses_that_give(&b, [14.8, 74.6, 159.6]) {
                println!(
                    "{k} -> {} {} {} tot {}",
                    f.wrist_kg,
                    f.load_kg,
                    f.third_link_m,
                    f.wrist_kg + f.load_kg
                );
            } else {
                println!("{k} none");
            }
        }
    }
    let mut b = a.clone();
    b.curves[2] = Curve::Linear(54e3);
    b.load_kg = 7.33;
    b.third_link_m = 0.124;
    println!("{:?}", CoupledArm::new(&b).frequencies_hz());
    for f in [[4.0, 1., 1.], [1., 4., 1.], [4.; 3]] {
        println!(
            "{:?}",
            (
                CoupledArm::new(&b.with_stiffness_factors(f)).frequencies_hz()[0]
                    / CoupledArm::new(&b).frequencies_hz()[0],
                CoupledArm::new(&a.with_stiffness_factors(f)).frequencies_hz()[0] / c[0]
            )
        );
    }
}
