//! Rigid bodies with centre and inertia against kinetic energy summed body by body, and against links that are divided
//! where a body stands. [`add_bodies`] puts bodies into the random studies of other tests.

use crate::dice::Dice;
use armwright::arm::{Arm, JointModel, LinkModel, Payload, read_arm_document, read_load_cases};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::Chain;
use armwright::report::analysis::Analysis;
use nalgebra::{DMatrix, Matrix3, Rotation3, SymmetricEigen, Unit, Vector3};
use serde_json::{Value, json};
use std::f64::consts::TAU;

fn read(arm: &Value) -> Arm {
    let document = Document::parse("arm.json", &arm.to_string()).expect("JSON");
    read_arm_document(document, &Catalogs::default()).unwrap_or_else(|faults| panic!("{faults}\n{arm}"))
}

/// A body of some size somewhere near the start of an element.
fn random_body(dice: &mut Dice, size_m: f64, most_kg: f64) -> Value {
    let turn =
        Rotation3::from_euler_angles(dice.within(-3.0, 3.0), dice.within(-1.5, 1.5), dice.within(-3.0, 3.0));
    let mass_kg = dice.within(0.1, most_kg);
    // a box: its moments are those of a solid
    let sides = [0; 3].map(|_| dice.within(0.2, 1.0) * size_m);
    let square = |i: usize| sides[i] * sides[i] * mass_kg / 12.0;
    let moments = Vector3::new(square(1) + square(2), square(0) + square(2), square(0) + square(1));
    let tensor = turn.matrix() * Matrix3::from_diagonal(&moments) * turn.matrix().transpose();
    let cg_m = [0; 3].map(|_| dice.within(-1.0, 1.0) * size_m);
    let rows: Vec<Vec<f64>> = tensor.row_iter().map(|row| row.iter().copied().collect()).collect();
    json!({"mass_kg": mass_kg, "cg_m": cg_m, "inertia_kgm2": rows})
}

/// Gives some joints and links of a study or an arm one or two bodies each. The same seed gives the same bodies.
pub fn add_bodies(study: &mut Value, seed: u64) {
    let dice = &mut Dice(seed.wrapping_mul(0x2545_F491_4F6C_DD1D) ^ 0xB0D1E5);
    for piece in study["chain"].as_array_mut().expect("a chain") {
        if dice.below(2) == 0 {
            continue;
        }
        let mut bodies: Vec<Value> = (0..1 + dice.below(2)).map(|_| random_body(dice, 0.15, 2.0)).collect();
        if piece["type"] == "joint" {
            bodies.iter_mut().for_each(|body| body["rotates"] = json!(dice.below(2) == 0));
        } else {
            // along the link, near its axis or beside it
            for body in &mut bodies {
                let along = dice.within(-0.1, 1.1);
                for axis in 0..3 {
                    let way_m = along * piece["vector_m"][axis].as_f64().expect("a number");
                    body["cg_m"][axis] = json!(way_m + 0.4 * body["cg_m"][axis].as_f64().expect("a number"));
                }
            }
        }
        piece["bodies"] = json!(bodies);
    }
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_fn(|i, _| value[i].as_f64().expect("a number"))
}

/// A joint of the witness: axis and place in the world, and stiffness.
type Hinge = (Vector3<f64>, Vector3<f64>, f64);

/// Frequencies \[Hz\], highest compliance first, and joint torques of an arm of rigid links: `M = Σ m Jvᵀ Jv + Jwᵀ I Jw`.
fn by_hand(arm: &Value, pose_deg: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut hinges: Vec<Hinge> = Vec::new();
    // number of hinges inboard, mass, centre and inertia in the world
    let mut bodies: Vec<(usize, f64, Vector3<f64>, Matrix3<f64>)> = Vec::new();
    let (mut at_m, mut turn) = (Vector3::zeros(), Rotation3::identity());
    let mut angles = pose_deg.iter();
    for piece in arm["chain"].as_array().expect("a chain") {
        let of_piece = piece["bodies"].as_array().cloned().unwrap_or_default();
        let mut take = |rotates: bool, hinges: usize, at_m: &Vector3<f64>, turn: &Rotation3<f64>| {
            for body in of_piece.iter().filter(|b| b["rotates"].as_bool().unwrap_or(false) == rotates) {
                let tensor = Matrix3::from_fn(|i, j| body["inertia_kgm2"][i][j].as_f64().expect("a number"));
                let world = turn.matrix() * tensor * turn.matrix().transpose();
                bodies.push((
                    hinges,
                    body["mass_kg"].as_f64().expect("kg"),
                    at_m + turn * vector(&body["cg_m"]),
                    world,
                ));
            }
        };
        take(false, hinges.len(), &at_m, &turn);
        if piece["type"] == "joint" {
            let axis = vector(&piece["axis"]).normalize();
            hinges.push((turn * axis, at_m, piece["stiffness_nm_per_rad"].as_f64().expect("a spring")));
            let angle = angles.next().expect("an angle").to_radians();
            turn *= Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle);
            take(true, hinges.len(), &at_m, &turn);
        } else {
            at_m += turn * vector(&piece["vector_m"]);
        }
    }
    let n = hinges.len();
    let mut mass = DMatrix::<f64>::zeros(n, n);
    let mut torques = vec![0.0; n];
    for (inboard, kg, centre_m, inertia) in &bodies {
        let velocity = |h: &Hinge| h.0.cross(&(centre_m - h.1));
        for i in 0..*inboard {
            torques[i] += velocity(&hinges[i]).z * -9.81 * kg;
            for j in 0..*inboard {
                mass[(i, j)] += kg * velocity(&hinges[i]).dot(&velocity(&hinges[j]))
                    + hinges[i].0.dot(&(inertia * hinges[j].0));
            }
        }
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| mass[(i, j)] / (hinges[i].2 * hinges[j].2).sqrt());
    let mut inverse: Vec<f64> = SymmetricEigen::new(scaled).eigenvalues.iter().copied().collect();
    inverse.sort_by(|a, b| b.total_cmp(a));
    (inverse.iter().map(|mu| 1.0 / (mu.sqrt() * TAU)).collect(), torques)
}

/// Frequencies and torques of the same arm by the library.
fn by_library(arm: &Value, pose_deg: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let chain = Chain::new(&read(arm).structure(JointModel::ThreeSegment), LinkModel::Full);
    let pose_rad: Vec<f64> = pose_deg.iter().map(|a| a.to_radians()).collect();
    let posed = chain.pose_rad(&pose_rad, &Payload::default(), Vector3::zeros());
    let statics = posed.statics();
    let modes = posed.modes(&statics, pose_rad.len()).iter().map(|m| m.frequency_hz).collect();
    (modes, statics.joint_torques_nm.iter().map(|(_, t)| *t).collect())
}

fn random_arm(dice: &mut Dice) -> (Value, Vec<f64>) {
    let unit = |dice: &mut Dice| [0; 3].map(|_| dice.within(-1.0, 1.0));
    let (mut chain, mut pose_deg) = (Vec::new(), Vec::new());
    for i in 0..2 + dice.below(5) {
        let bodies = |dice: &mut Dice, least: u64| -> Vec<Value> {
            (0..least + dice.below(3)).map(|_| random_body(dice, 0.3, 8.0)).collect()
        };
        let mut of_joint = bodies(dice, 0);
        of_joint.iter_mut().for_each(|body| body["rotates"] = json!(dice.below(2) == 0));
        chain.push(json!({"type": "joint", "name": format!("j{i}"), "axis": unit(dice),
            "stiffness_nm_per_rad": 10f64.powf(dice.within(3.0, 5.0)), "bodies": of_joint}));
        chain.push(json!({"type": "link", "name": format!("l{i}"), "vector_m": unit(dice), "bodies": bodies(dice, 1)}));
        pose_deg.push(dice.within(-180.0, 180.0));
    }
    (json!({"chain": chain}), pose_deg)
}

/// Both sum the same products in another order, so that 1e-9 leaves room for rounding of the eigenvalues alone.
#[test]
fn arms_with_bodies_vibrate_and_weigh_as_their_kinetic_energy_says() {
    let dice = &mut Dice(11);
    for round in 0..60 {
        let (arm, pose_deg) = random_arm(dice);
        let ((hz, torques), (own_hz, own_torques)) = (by_hand(&arm, &pose_deg), by_library(&arm, &pose_deg));
        assert_eq!(hz.len(), own_hz.len(), "round {round}: {arm}");
        for (a, b) in hz.iter().zip(&own_hz) {
            assert!((a / b - 1.0).abs() < 1e-9, "round {round}: {hz:?} {own_hz:?}");
        }
        let largest = torques.iter().fold(0.0f64, |m, t| m.max(t.abs()));
        for (a, b) in torques.iter().zip(&own_torques) {
            assert!((a - b).abs() < 1e-12 * largest, "round {round}: {torques:?} {own_torques:?}");
        }
    }
}

/// The Puma 560 of robotics textbooks (Corke, Robotics Toolbox): its published gravity torques in the pose `qn`, and the
/// modes that its published masses, centres and inertias have on springs.
#[test]
fn a_textbook_arm_has_its_published_torques() {
    let joint = |name: &str, axis: [f64; 3], k: f64| json!({"type": "joint", "name": name, "axis": axis, "stiffness_nm_per_rad": k});
    let link = |name: &str, vector_m: [f64; 3], kg: f64, cg_m: [f64; 3], i: [f64; 3]| {
        json!({"type": "link", "name": name, "vector_m": vector_m, "bodies": [
            {"mass_kg": kg, "cg_m": cg_m, "inertia_kgm2": [[i[0], 0, 0], [0, i[1], 0], [0, 0, i[2]]]}]})
    };
    // moments in the axes of each Denavit-Hartenberg frame, turned into those of the zero pose
    let arm = json!({"name": "puma560", "chain": [
        joint("j1", [0.0, 0.0, 1.0], 2e4), link("l1", [0.0; 3], 0.0, [0.0; 3], [0.0, 0.0, 0.35]),
        joint("j2", [0.0, -1.0, 0.0], 5e4),
        link("l2", [0.4318, 0.0, 0.0], 17.4, [0.068, -0.2275, 0.006], [0.13, 0.539, 0.524]),
        joint("j3", [0.0, -1.0, 0.0], 2e4),
        link("l3", [0.0203, -0.15005, 0.0], 4.8, [0.0, -0.16415, 0.07], [0.066, 0.086, 0.0125]),
        joint("j4", [0.0, 0.0, 1.0], 2e3),
        link("l4", [0.0, 0.0, 0.4318], 0.82, [0.0, 0.0, 0.4508], [1.8e-3, 1.8e-3, 1.3e-3]),
        joint("j5", [0.0, -1.0, 0.0], 2e3), link("l5", [0.0; 3], 0.34, [0.0; 3], [0.3e-3, 0.4e-3, 0.3e-3]),
        joint("j6", [0.0, 0.0, 1.0], 2e3),
        link("l6", [0.0; 3], 0.09, [0.0, 0.0, 0.032], [0.15e-3, 0.15e-3, 0.04e-3])]});
    let pose_deg = [0.0, 45.0, -180.0, 1f64.to_degrees(), 45.0, 0.0];
    let (hz, torques) = by_library(&arm, &pose_deg);
    println!("{hz:?} {torques:?}");
    for (own, hand) in hz.iter().zip([13.20, 23.69, 44.17, 170.7, 281.5, 1132.0]) {
        assert!((own / hand - 1.0).abs() < 5e-4, "{hz:?}");
    }
    // printed to four decimals; the toolbox gives the torque that holds the arm, here it is that of gravity
    for (own, published) in torques.iter().zip([0.0, 31.6334, 6.0286, -0.0119, 0.0218, 0.0]) {
        assert!((own + published).abs() < 6e-5, "{torques:?}");
    }
}

/// A tube with a body is two tubes with a rigid link between them. Deflections are exact in both; the modes of two tubes have
/// twice as many shapes, so that only the lowest agree closely.
#[test]
fn a_body_on_a_tube_moves_with_the_nearest_point_of_its_axis() {
    let dice = &mut Dice(5);
    let tube = |name: &str, vector_m: Vector3<f64>| {
        json!({"type": "link", "name": name, "vector_m": vector_m.as_slice(), "material": "al",
        "section": {"shape": "rectangular_tube", "width_m": 0.05, "height_m": 0.07, "wall_m": 0.003}})
    };
    for round in 0..30 {
        let vector_m = Vector3::new(dice.within(0.4, 0.9), dice.within(-0.3, 0.3), dice.within(-0.3, 0.3));
        let along = dice.within(0.05, 0.95);
        let aside = vector_m.cross(&Vector3::new(dice.within(-1.0, 1.0), 0.3, 1.0)).normalize()
            * dice.within(0.0, 0.2);
        let mut body = random_body(dice, 0.1, 4.0);
        body["cg_m"] = json!((vector_m * along + aside).as_slice());
        let mut whole = tube("tube", vector_m);
        whole["bodies"] = json!([body]);
        body["cg_m"] = json!(aside.as_slice());
        let knot = json!({"type": "link", "name": "knot", "vector_m": [0, 0, 0], "bodies": [body]});
        let parts = [tube("root", vector_m * along), knot, tube("end", vector_m * (1.0 - along))];
        let arm = |links: &[Value]| {
            let mut chain = vec![
                json!({"type": "joint", "name": "j", "axis": [0.2, 1, 0.4], "stiffness_nm_per_rad": 3e4}),
            ];
            chain.extend_from_slice(links);
            json!({"materials": {"al": {"youngs_modulus_pa": 7e10, "shear_modulus_pa": 2.6e10, "density_kg_m3": 2700}},
                "chain": chain})
        };
        let solve = |arm: &Value| {
            let chain = Chain::new(&read(arm).structure(JointModel::ThreeSegment), LinkModel::Full);
            let payload = Payload { mass_kg: 2.0, ..Payload::default() };
            let posed = chain.pose_rad(&[0.7], &payload, Vector3::new(3.0, -20.0, 5.0));
            let statics = posed.statics();
            let hz: Vec<f64> = posed.modes(&statics, 3).iter().map(|m| m.frequency_hz).collect();
            (statics.tip_displacement_m, statics.base_wrench, hz)
        };
        let ((tip, base, hz), (tip_2, base_2, hz_2)) = (solve(&arm(&[whole])), solve(&arm(&parts)));
        assert!((tip - tip_2).norm() < 1e-10 * tip.norm(), "round {round}: {tip} {tip_2}");
        assert!((base - base_2).norm() < 1e-12 * base.norm(), "round {round}: {base} {base_2}");
        // more shapes are softer: a point load makes a kink in the curvature, which four polynomials follow in the first
        // modes and less so where the tube bends between its ends
        for (mode, largest) in [5e-4, 5e-3, 0.3].into_iter().enumerate() {
            let stiffer = hz[mode] / hz_2[mode] - 1.0;
            assert!((-1e-9..largest).contains(&stiffer), "round {round}, mode {mode}: {hz:?} {hz_2:?}");
        }
    }
}

/// A body beside the axis of an I beam twists the beam inboard of it alone, which the shapes of a whole link hold in part.
/// The report says how much lower the lowest mode is. The frequencies are those of a model of 20 elements on either side of
/// the body, by another program (wrenches as coordinates of each element).
#[test]
fn a_body_beside_a_tube_is_said_to_lower_the_lowest_mode() {
    let analysis = |section: Value, cg_m: [f64; 3], mass_kg: f64| {
        let tensor = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.01]];
        let arm = read(&json!({"name": "b",
            "materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
            "chain": [
                {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e6},
                {"type": "link", "name": "l", "vector_m": [0.6, 0, 0], "material": "steel", "section": section,
                "bodies": [{"mass_kg": mass_kg, "cg_m": cg_m, "inertia_kgm2": tensor}]}]}));
        let cases = r#"[{"name": "level", "pose_deg": [0], "payload": {"mass_kg": 1}}]"#;
        let cases =
            read_load_cases(Document::parse("cases.json", cases).expect("JSON"), &arm.driven_joints());
        let solved = Analysis::of(&arm, cases.expect("sound")[0].clone(), 1, None);
        (solved.to_json(&arm), solved.to_text(&arm))
    };
    let beam =
        json!({"shape": "i_beam", "width_m": 0.08, "height_m": 0.1, "web_m": 0.005, "flange_m": 0.006});
    for (cg_m, mass_kg, lowest_hz) in [([0.3, 0.15, 0.0], 5.0, 27.811), ([0.25, 0.08, 0.0], 3.0, 55.276)] {
        let (json, text) = analysis(beam.clone(), cg_m, mass_kg);
        let divided_hz = json["lowest_mode_divided_hz"].as_f64().expect("a frequency");
        assert!((divided_hz / lowest_hz - 1.0).abs() < 1e-4, "{divided_hz}");
        assert!(json["modes"][0]["frequency_hz"].as_f64().expect("a frequency") > 1.03 * lowest_hz);
        assert!(text.contains("lower than printed"), "{text}");
    }
    // on the axis of a bar, which is stiff in torsion, nothing needs to be said
    let bar = json!({"shape": "round_bar", "diameter_m": 0.06});
    let (json, text) = analysis(bar, [0.3, 0.0, 0.0], 5.0);
    assert!(json["lowest_mode_divided_hz"].is_f64() && !text.contains("lower than printed"), "{text}");
}

#[test]
fn an_arm_with_bodies_reads_back_as_it_was_written() {
    let (arm, _) = random_arm(&mut Dice(3));
    let arm = read(&arm);
    assert_eq!(read(&arm.to_json()), arm);
    assert!(arm.joints().any(|joint| !joint.bodies.rotating.is_empty()));
}
