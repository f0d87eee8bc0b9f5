//! The worst poses of an arm: against a closed form on a fine grid, and against dense random poses.

use super::dice::Dice;
use armwright::arm::{Arm, JointModel, LinkModel, LoadCase, Payload, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use armwright::study::{WorstPose, WorstPoses, worst_poses};
use nalgebra::{Matrix2, Vector2, Vector3};
use serde_json::{Value, json};
use std::f64::consts::TAU;

const GRAVITY_M_S2: f64 = 9.81;

fn arm_of(chain: Value) -> Arm {
    let text = json!({"name": "arm", "gravity_m_s2": GRAVITY_M_S2, "chain": chain}).to_string();
    read_arm_document(Document::parse("arm.json", &text).expect("JSON"), &Catalogs::default()).expect("sound")
}

fn case(pose_deg: &[f64], payload: Payload, tip_force_n: [f64; 3]) -> LoadCase {
    LoadCase {
        name: "judged".into(),
        pose_deg: pose_deg.to_vec(),
        payload,
        tip_force_n: tip_force_n.into(),
        tip_moment_nm: Vector3::zeros(),
        links: LinkModel::Full,
        joints: JointModel::ThreeSegment,
        water: None,
    }
}

fn found(arm: &Arm, cases: &[LoadCase], ranges_deg: &[[f64; 2]]) -> WorstPoses {
    worst_poses(arm, cases, ranges_deg).expect("there is a case")
}

/// Tip deflection \[m\] and lowest mode \[Hz\] by the full model.
fn full_model(arm: &Arm, case: &LoadCase, pose_deg: &[f64]) -> [f64; 2] {
    let chain = Chain::new(&arm.structure_in(case), case.links);
    let case = LoadCase { pose_deg: pose_deg.to_vec(), ..case.clone() };
    let posed = chain.pose(&case);
    let statics = posed.statics();
    [statics.tip_displacement_m.norm(), posed.lowest_frequency_hz(&statics)]
}

/// A planar arm of two joints (axes along y) with rigid massless links and linear springs.
struct Planar {
    links_m: [f64; 2],
    stiffness_nm_per_rad: [f64; 2],
    elbow_kg: f64,
    payload_kg: f64,
    /// Along x and z.
    tip_force_n: Vector2<f64>,
}

impl Planar {
    fn arm(&self) -> Arm {
        let [k1, k2] = self.stiffness_nm_per_rad;
        arm_of(json!([
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": k1},
            {"type": "link", "name": "upper", "vector_m": [self.links_m[0], 0, 0]},
            {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": k2, "mass_kg": self.elbow_kg},
            {"type": "link", "name": "lower", "vector_m": [self.links_m[1], 0, 0]}]))
    }

    fn case(&self) -> LoadCase {
        let payload = Payload { mass_kg: self.payload_kg, ..Payload::default() };
        case(&[0.0, 0.0], payload, [self.tip_force_n.x, 0.0, self.tip_force_n.y])
    }

    /// Tip deflection \[m\] and lowest mode \[Hz\] by hand, in the plane of x and z. A positive turn lowers what is at
    /// positive x: it moves a point at (x, z) from the axis by (z, -x).
    fn by_hand(&self, pose_deg: [f64; 2]) -> [f64; 2] {
        let [first, second] = pose_deg.map(f64::to_radians);
        let along = |angle: f64| Vector2::new(angle.cos(), -angle.sin());
        let elbow = self.links_m[0] * along(first);
        let tip = elbow + self.links_m[1] * along(first + second);
        let turn = |from: Vector2<f64>| Vector2::new(from.y, -from.x);
        let weight = |kg: f64| Vector2::new(0.0, -GRAVITY_M_S2 * kg);
        let at_tip = weight(self.payload_kg) + self.tip_force_n;
        let moves = [turn(tip), turn(tip - elbow)];
        let torque = [moves[0].dot(&at_tip) + turn(elbow).dot(&weight(self.elbow_kg)), moves[1].dot(&at_tip)];
        let stiffness = self.stiffness_nm_per_rad;
        let deflection = moves[0] * (torque[0] / stiffness[0]) + moves[1] * (torque[1] / stiffness[1]);
        let inertia = |i: usize, j: usize| {
            let of_elbow = if i + j == 0 { self.elbow_kg * elbow.norm_squared() } else { 0.0 };
            (self.payload_kg * moves[i].dot(&moves[j]) + of_elbow) / (stiffness[i] * stiffness[j]).sqrt()
        };
        let flexibility = Matrix2::new(inertia(0, 0), inertia(0, 1), inertia(1, 0), inertia(1, 1));
        [deflection.norm(), 1.0 / (flexibility.symmetric_eigenvalues().max().sqrt() * TAU)]
    }
}

/// The largest deflection and the lowest mode over a grid of every quarter of a degree.
fn brute_force(arm: &Planar, ranges_deg: [[f64; 2]; 2]) -> [f64; 2] {
    let angles = ranges_deg.map(|[low, high]| {
        (0..)
            .map(move |i| low + 0.25 * f64::from(i))
            .take_while(move |&angle| angle <= high)
            .collect::<Vec<_>>()
    });
    let mut worst = [0.0, f64::INFINITY];
    for &first in &angles[0] {
        for &second in &angles[1] {
            let [deflection, mode] = arm.by_hand([first, second]);
            worst = [deflection.max(worst[0]), mode.min(worst[1])];
        }
    }
    worst
}

const PLANAR: Planar = Planar {
    links_m: [0.62, 0.47],
    stiffness_nm_per_rad: [31e3, 12e3],
    elbow_kg: 4.0,
    payload_kg: 5.0,
    tip_force_n: Vector2::new(37.0, -11.0),
};

#[test]
fn the_worst_poses_of_a_planar_arm_are_those_of_a_fine_grid_by_hand() {
    // the ranges keep the worst poses between the corners; the second also allows a full turn
    for ranges_deg in [[[-70.0, 95.0], [-150.0, -20.0]], [[-180.0, 180.0], [35.0, 160.0]]] {
        let arm = PLANAR.arm();
        let worst = found(&arm, &[PLANAR.case()], &ranges_deg);
        let brute = brute_force(&PLANAR, ranges_deg);
        for (which, WorstPose { value, pose_deg, .. }) in
            [&worst.deflection, &worst.mode].into_iter().enumerate()
        {
            let by_hand = PLANAR.by_hand([pose_deg[0], pose_deg[1]])[which];
            assert!((value / by_hand - 1.0).abs() < 1e-9, "{value} {by_hand}");
            // without its climb the search misses the grid's worst by more than 0.01 %
            assert!(
                (value / brute[which] - 1.0).abs() < 3e-5,
                "{which}: {value} at {pose_deg:?}, {}",
                brute[which]
            );
            let is_within = |(angle, [low, high]): (&f64, [f64; 2])| (low..=high).contains(angle);
            assert!(pose_deg.iter().zip(ranges_deg).all(is_within), "{pose_deg:?}");
        }
    }
}

#[test]
fn a_vertical_first_joint_does_not_matter_until_something_pushes_sideways() {
    let arm = |shoulder_nm_per_rad: f64| {
        arm_of(json!([
            {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 5e4},
            {"type": "link", "name": "column", "vector_m": [0, 0, 0.3]},
            {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": shoulder_nm_per_rad},
            {"type": "link", "name": "boom", "vector_m": [0.7, 0, 0]}]))
    };
    let payload = Payload { mass_kg: 5.0, ..Payload::default() };
    let ranges_deg = [[25.0, 140.0], [-90.0, 90.0]];
    let hangs = found(&arm(3e4), &[case(&[30.0, 60.0], payload, [0.0; 3])], &ranges_deg);
    assert_eq!(hangs.deflection.pose_deg, [25.0, 0.0]);
    assert_eq!(hangs.mode.pose_deg[0], 25.0);
    let weight_nm = 5.0 * GRAVITY_M_S2 * 0.7;
    assert!((hangs.deflection.value / (weight_nm / 3e4 * 0.7) - 1.0).abs() < 1e-9);
    assert!((hangs.deflection.judged / (0.5 * hangs.deflection.value) - 1.0).abs() < 1e-9);
    // a force along x turns joint 1 most where the boom is along y; the stiff shoulder hardly yields to it
    let pushed = found(&arm(1e7), &[case(&[30.0, 60.0], payload, [90.0, 0.0, 0.0])], &ranges_deg).deflection;
    assert!((pushed.pose_deg[0] - 90.0).abs() < 1.0 && pushed.pose_deg[1].abs() < 1.0, "{pushed:?}");
    assert!((pushed.value / (90.0 * 0.7 / 5e4 * 0.7) - 1.0).abs() < 1e-3, "{pushed:?}");
}

#[test]
fn a_passive_joint_follows_the_joint_that_drives_it() {
    let arm = arm_of(json!([
        {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
        {"type": "link", "name": "arm", "vector_m": [0.6, 0, 0]},
        {"type": "joint", "name": "wrist", "axis": [0, 1, 0], "stiffness_nm_per_rad": null,
         "coupled": {"shoulder": -1}},
        {"type": "link", "name": "hand", "vector_m": [0.2, 0, 0]}]));
    let payload = Payload { mass_kg: 5.0, ..Payload::default() };
    let judged = [case(&[60.0], payload, [0.0; 3])];
    // the hand stays level, so only the arm's 0.6 m count
    let at = |angle_deg: f64| 5.0 * GRAVITY_M_S2 * 0.6 * angle_deg.to_radians().cos() / 1e4 * 0.6;
    for (range_deg, worst_deg) in [([-50.0, 80.0], 0.0), ([22.5, 80.0], 22.5)] {
        let worst = found(&arm, &judged, &[range_deg]).deflection;
        assert_eq!(worst.pose_deg, [worst_deg]);
        assert!(
            (worst.value / at(worst_deg) - 1.0).abs() < 1e-9 && (worst.judged / at(60.0) - 1.0).abs() < 1e-9
        );
    }
}

#[test]
fn each_load_of_the_judged_cases_is_tried_in_every_pose() {
    let arm = PLANAR.arm();
    let light = PLANAR.case();
    let mut heavy = light.clone();
    (heavy.name, heavy.pose_deg) = ("heavy".into(), vec![90.0, 0.0]);
    heavy.payload.mass_kg *= 2.0;
    let full_turns = [[-180.0, 180.0]; 2];
    let both = found(&arm, &[light.clone(), heavy.clone()], &full_turns);
    let alone = found(&arm, &[heavy], &full_turns);
    assert_eq!(both.deflection.load_of, "heavy");
    assert_eq!((both.deflection.value, both.mode.value), (alone.deflection.value, alone.mode.value));
    assert!(alone.deflection.value > 1.5 * found(&arm, &[light], &full_turns).deflection.value);
}

/// A spatial arm of random axes, tubes, offsets, springs and ranges.
fn random_arm(dice: &mut Dice) -> (Arm, LoadCase, Vec<[f64; 2]>) {
    let joints = 4 + dice.below(3) as usize;
    let (mut chain, mut ranges_deg) = (Vec::new(), Vec::new());
    for j in 0..joints {
        let slanted = [(); 3].map(|()| dice.within(-1.0, 1.0));
        let axis = dice.of(&[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], slanted]);
        chain.push(json!({"type": "joint", "name": format!("j{j}"), "axis": axis,
            "stiffness_nm_per_rad": dice.within(1e4, 1e5), "mass_kg": dice.within(0.5, 6.0)}));
        let vector_m = [dice.within(0.1, 0.5), dice.within(-0.2, 0.2), dice.within(-0.2, 0.2)];
        let mut link = json!({"type": "link", "name": format!("l{j}"), "vector_m": vector_m});
        if j == 1 {
            link["material"] = "steel".into();
            link["section"] = json!({"shape": "round_tube", "diameter_m": 0.1, "wall_m": 0.004});
        }
        chain.push(link);
        let (low, width) = (dice.within(-180.0, 0.0), dice.within(40.0, 200.0));
        ranges_deg.push(dice.of(&[[-180.0, 180.0], [low, low + width]]));
    }
    let text = json!({"gravity_m_s2": GRAVITY_M_S2, "chain": chain, "materials":
        {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}}});
    let document = Document::parse("arm.json", &text.to_string()).expect("JSON");
    let arm = read_arm_document(document, &Catalogs::default()).expect("sound");
    let cg_m = Vector3::new(0.0, dice.within(-0.1, 0.1), dice.within(0.0, 0.1));
    let payload = Payload { mass_kg: dice.within(1.0, 10.0), cg_m, ..Payload::default() };
    let push = dice.of(&[0.0, 60.0]);
    let tip_force_n = [(); 3].map(|()| dice.within(-push, push));
    let middle: Vec<f64> = ranges_deg.iter().map(|[low, high]| 0.5 * (low + high)).collect();
    (arm, case(&middle, payload, tip_force_n), ranges_deg)
}

#[test]
fn no_random_pose_of_random_arms_is_worse_by_more_than_half_a_percent() {
    const ARMS: usize = 10;
    const POSES: usize = 3000;
    let mut dice = Dice(20_261_125);
    for index in 0..ARMS {
        let (arm, case, ranges_deg) = random_arm(&mut dice);
        let worst = found(&arm, std::slice::from_ref(&case), &ranges_deg);
        let here = full_model(&arm, &case, &worst.deflection.pose_deg)[0];
        assert_eq!(here, worst.deflection.value, "arm {index}");
        assert_eq!(full_model(&arm, &case, &worst.mode.pose_deg)[1], worst.mode.value, "arm {index}");
        for _ in 0..POSES {
            let pose_deg: Vec<f64> = ranges_deg.iter().map(|[low, high]| dice.within(*low, *high)).collect();
            let [deflection, mode] = full_model(&arm, &case, &pose_deg);
            assert!(deflection < 1.005 * worst.deflection.value, "arm {index}: {pose_deg:?}, {worst:?}");
            assert!(mode > worst.mode.value / 1.005, "arm {index}: {pose_deg:?}, {worst:?}");
        }
    }
}

#[test]
fn the_poses_are_the_same_for_any_number_of_threads() {
    let (arm, case, ranges_deg) = random_arm(&mut Dice(7));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| found(&arm, std::slice::from_ref(&case), &ranges_deg))
    };
    assert_eq!(with(1), with(3));
}

/// The knee of the study `light-arm` as it was without output bearings.
fn light_arm_knee() -> Arm {
    let joint = |name: &str, axis: [f64; 3], [k1, k2, k3, t1, t2, mass_kg]: [f64; 6]| {
        json!({"type": "joint", "name": name, "axis": axis, "mass_kg": mass_kg, "windup": {"k1_nm_per_rad": k1,
            "k2_nm_per_rad": k2, "k3_nm_per_rad": k3, "t1_nm": t1, "t2_nm": t2}})
    };
    let tube = |name: &str, length_m: f64, section: Value| json!({"type": "link", "name": name, "vector_m": [length_m, 0, 0], "material": "CFRP", "section": section});
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let (large, small) = ([250e3, 400e3, 440e3, 108.0, 382.0], [4700.0, 6100.0, 7100.0, 2.0, 6.9, 0.63]);
    let with_mass = |[k1, k2, k3, t1, t2]: [f64; 5], kg: f64| [k1, k2, k3, t1, t2, kg];
    let text = json!({"gravity_m_s2": GRAVITY_M_S2,
        "materials": {"CFRP": {"youngs_modulus_pa": 93.44e9, "shear_modulus_pa": 35.38e9,
            "density_kg_m3": 1590, "poisson": 0.32}},
        "chain": [
            joint("j1", z, with_mass(large, 9.24)),
            {"type": "link", "name": "shoulder", "vector_m": [0, 0, 0.3]},
            joint("j2", y, with_mass(large, 9.49)),
            tube("upper_arm", 0.8, json!({"shape": "rectangular_tube", "width_m": 0.16, "height_m": 0.16, "wall_m": 0.003})),
            joint("j3", y, [67e3, 110e3, 120e3, 29.0, 108.0, 3.54]),
            tube("forearm", 0.5, json!({"shape": "round_tube", "diameter_m": 0.12, "wall_m": 0.002})),
            joint("j4", x, small), joint("j5", y, small), joint("j6", x, small),
            {"type": "link", "name": "flange", "vector_m": [0.05, 0, 0]}]});
    let document = Document::parse("arm.json", &text.to_string()).expect("JSON");
    read_arm_document(document, &Catalogs::default()).expect("sound")
}

#[test]
fn the_knee_of_light_arm_has_a_lower_mode_in_a_pose_that_the_study_does_not_list() {
    let payload = Payload { mass_kg: 5.0, cg_m: Vector3::new(0.0, 0.0, 0.05), ..Payload::default() };
    let poses = [[0.0; 6], [0.0, -45.0, 90.0, 0.0, 45.0, 0.0]];
    let cases = poses.map(|pose_deg| case(&pose_deg, payload, [0.0; 3]));
    let arm = light_arm_knee();
    let WorstPoses { mode, deflection } = found(&arm, &cases, &[[-180.0, 180.0]; 6]);
    assert!((mode.judged - 18.074).abs() < 1e-3, "{mode:?}");
    // another program found 15.60 Hz
    assert!(mode.value < 15.60, "{mode:?}");
    assert!((full_model(&arm, &cases[0], &mode.pose_deg)[1] / mode.value - 1.0).abs() < 1e-12);
    assert!(deflection.value > deflection.judged, "{deflection:?}");
}
