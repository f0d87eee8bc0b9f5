//! Prismatic joints against closed forms, against a program of its own over Jacobians, and in every search.
//! [`add_prismatic`] puts prismatic joints into the random studies of other tests.

use crate::dice::Dice;
use armwright::arm::{
    Arm, DrivenJoint, JointModel, LinkModel, LoadCase, Payload, pose_si, read_arm_document, read_load_cases,
};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::mechanics::{Chain, Mode, Statics};
use armwright::study::worst_poses;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, SymmetricEigen, Unit, Vector3};
use serde_json::{Value, json};
use std::f64::consts::TAU;

const GRAVITY_M_S2: f64 = 9.81;

fn read(arm: &Value) -> Arm {
    let document = Document::parse("arm.json", &arm.to_string()).expect("JSON");
    read_arm_document(document, &Catalogs::default()).unwrap_or_else(|faults| panic!("{faults}\n{arm}"))
}

fn cases(arm: &Arm, cases: Value) -> Vec<LoadCase> {
    let document = Document::parse("cases.json", &cases.to_string()).expect("JSON");
    read_load_cases(document, &arm.driven_joints()).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Statics and modes in one pose.
fn solve(arm: &Value, pose: Value, payload_kg: f64) -> (Statics, Vec<Mode>) {
    let arm = read(arm);
    let case = &cases(&arm, json!([{"pose": pose, "payload": {"mass_kg": payload_kg}}]))[0];
    let chain = Chain::new(&arm.structure_in(case), case.links);
    let posed = chain.pose(case);
    let statics = posed.statics();
    let modes = posed.modes(&statics, 3);
    (statics, modes)
}

#[track_caller]
fn assert_close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1e-12), "{found} against {expected}");
}

/// A carriage on a vertical column, and an arm that sticks out of it: the droop is that of the screw under all that travels,
/// and that of the guide, whose moment goes with the overhang and whose tilt goes with it again.
#[test]
fn the_droop_of_a_column_is_its_screw_and_its_guide() {
    let (overhang_m, payload_kg, carriage_kg) = (0.6, 10.0, 8.0);
    let column = json!({"chain": [
        {"type": "link", "name": "foot", "vector_m": [0, 0, 0.5]},
        {"type": "prismatic", "name": "lift", "axis": [0, 0, 1], "stiffness_n_per_m": 2e7, "mass_kg": carriage_kg,
         "fixed_mass_kg": 30, "guide": {"roll_nm_per_rad": 3e5, "pitch_nm_per_rad": 1e5, "yaw_nm_per_rad": 2e5}},
        {"type": "link", "name": "boom", "vector_m": [overhang_m, 0, 0]}]});
    for travel_mm in [0.0, 400.0] {
        let (statics, _) = solve(&column, json!({"lift_mm": travel_mm}), payload_kg);
        let force_n = -(payload_kg + carriage_kg) * GRAVITY_M_S2;
        assert_eq!(statics.joint_forces_n.len(), 1);
        assert_close(statics.joint_forces_n[0].1, force_n);
        let moment_nm = payload_kg * GRAVITY_M_S2 * overhang_m;
        // the frame of a guide that travels up has y = -world y: the boom pitches about it
        let guide = &statics.guide_loads[0];
        assert_close(guide.moment_nm.y, -moment_nm);
        assert!(guide.moment_nm.x.abs() + guide.moment_nm.z.abs() < 1e-12 * moment_nm, "{guide:?}");
        assert_close(guide.force_n.x, force_n);
        assert_close(statics.tip_displacement_m.z, force_n / 2e7 - moment_nm / 1e5 * overhang_m);
        let names: Vec<&str> = statics.shares_m.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["lift.guide", "lift"]);
        assert_close(statics.shares_m[1].1.z, force_n / 2e7);
    }
}

/// The overhang of a ram grows with its travel, that of a carriage does not.
#[test]
fn a_ram_droops_with_the_square_of_its_travel() {
    let arm = |moves: &str| {
        json!({"chain": [
        {"type": "prismatic", "name": "reach", "axis": [1, 0, 0], "stiffness_n_per_m": null, "moves": moves,
         "guide": {"pitch_nm_per_rad": 1e5}}, {"type": "link", "name": "hand", "vector_m": [0.1, 0, 0]}]})
    };
    let droop_m =
        |moves: &str, mm: f64| solve(&arm(moves), json!({"reach_mm": mm}), 5.0).0.tip_displacement_m.z;
    let by_hand = |lever_m: f64| -5.0 * GRAVITY_M_S2 * lever_m * lever_m / 1e5;
    for mm in [200.0, 900.0] {
        assert_close(droop_m("ram", mm), by_hand(0.1 + mm / 1e3));
        assert_close(droop_m("carriage", mm), by_hand(0.1));
    }
    let ram = read(&arm("ram"));
    let case = &cases(&ram, json!([{"pose": {"reach_mm": 300}, "payload": {"mass_kg": 5}}]));
    let worst = worst_poses(&ram, case, &[[0.0, 800.0]]).expect("a case");
    assert_eq!((worst.deflection.pose_deg, worst.mode.pose_deg), (vec![800.0], vec![800.0]));
    assert_close(worst.deflection.value, -by_hand(0.9));
}

/// A gantry: two axes that carry one another. Each mode along an axis is all that travels there on its own drive; the
/// strain energy of a mode is in one spring.
#[test]
fn a_gantry_vibrates_on_its_drives() {
    let slide = |name: &str, axis: [f64; 3], k: f64, kg: f64| json!({"type": "prismatic", "name": name, "axis": axis, "stiffness_n_per_m": k, "mass_kg": kg});
    let gantry = json!({"chain": [slide("bridge", [1.0, 0.0, 0.0], 3e7, 80.0), slide("trolley", [0.0, 1.0, 0.0], 2e7, 25.0),
        slide("ram", [0.0, 0.0, 1.0], 1e7, 12.0)]});
    let (_, modes) = solve(&gantry, json!({"bridge_mm": 2000, "trolley_mm": -300, "ram_mm": -500}), 6.0);
    let hz = |k: f64, kg: f64| (k / kg).sqrt() / TAU;
    let expected = [("bridge", hz(3e7, 123.0)), ("trolley", hz(2e7, 43.0)), ("ram", hz(1e7, 18.0))];
    for (mode, (drive, hz)) in modes.iter().zip(expected) {
        assert!((mode.frequency_hz / hz - 1.0).abs() < 1e-12, "{drive}: {} {hz}", mode.frequency_hz);
        let energy = mode.strain_energy.iter().find(|(name, _)| name == drive).expect("the drive").1;
        assert!((energy - 1.0).abs() < 1e-12, "{drive}: {energy}");
    }
}

/// A random prismatic joint that somewhere yields.
fn random_prismatic(dice: &mut Dice, name: &str) -> Value {
    let axis = match dice.below(4) {
        0 => json!([1, 0, 0]),
        1 => json!([0, 0, -1]),
        2 => json!([0, 1, 0]),
        _ => json!([dice.within(-1.0, 1.0), dice.within(-1.0, 1.0), 1.0]),
    };
    let spring = |dice: &mut Dice, low: f64, high: f64| match dice.below(4) {
        0 => Value::Null,
        _ => json!(10f64.powf(dice.within(low, high))),
    };
    let guide = json!({"roll_nm_per_rad": spring(dice, 4.0, 6.0), "pitch_nm_per_rad": 10f64.powf(dice.within(4.0, 6.0)),
        "yaw_nm_per_rad": spring(dice, 4.0, 6.0)});
    let body = |dice: &mut Dice, travels: bool| {
        let i = dice.within(0.01, 0.1);
        json!({"mass_kg": dice.within(0.5, 4.0), "cg_m": [dice.within(-0.2, 0.2), 0.05, dice.within(-0.2, 0.2)],
            "inertia_kgm2": [[i, 0.2 * i, 0], [0.2 * i, i, 0], [0, 0, 0.8 * i]], "travels": travels})
    };
    json!({"type": "prismatic", "name": name, "axis": axis, "stiffness_n_per_m": spring(dice, 5.5, 7.5), "guide": guide,
        "moves": dice.of(&["carriage", "ram"]), "mass_kg": dice.within(0.0, 10.0), "fixed_mass_kg": dice.within(0.0, 5.0),
        "bodies": [body(dice, true), body(dice, false)]})
}

/// Puts one or two prismatic joints somewhere into the chain of a study and gives its poses travels. The same seed gives the
/// same joints.
pub fn add_prismatic(study: &mut Value, seed: u64) {
    let dice = &mut Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5_11DE);
    let chain = study["chain"].as_array_mut().expect("a chain");
    for i in 0..1 + dice.below(2) {
        let place = dice.below(chain.len() as u64 + 1) as usize;
        let mut rail = random_prismatic(dice, &format!("slide{i}"));
        if (seed + i).is_multiple_of(3) {
            rail["max_speed_m_s"] = json!(0.2 + 0.4 * (seed % 5) as f64);
        }
        chain.insert(place, rail);
    }
    let driven: Vec<(String, bool)> = chain
        .iter()
        .filter(|piece| piece["type"] != "link" && piece["coupled"].is_null())
        .map(|piece| (piece["name"].as_str().expect("a name").to_string(), piece["type"] == "joint"))
        .collect();
    for pose in study["poses"].as_array_mut().expect("poses") {
        let pose = pose.as_object_mut().expect("a pose");
        let angles = pose.remove("pose_deg").expect("angles");
        let mut angles = angles.as_array().expect("a list").iter();
        let entries = driven.iter().map(|(name, turns)| match turns {
            true => (format!("{name}_deg"), angles.next().expect("an angle").clone()),
            false => (format!("{name}_mm"), json!(dice.within(-200.0, 500.0).round())),
        });
        let entries: serde_json::Map<String, Value> = entries.collect();
        pose.insert("pose".into(), Value::Object(entries));
    }
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_fn(|i, _| value[i].as_f64().expect("a number"))
}

/// A coordinate of the witness: how it moves a point, and what it yields.
enum Moves {
    /// About an axis through a point.
    Turns(Vector3<f64>, Vector3<f64>),
    /// Along a direction.
    Slides(Vector3<f64>),
}

impl Moves {
    fn velocity(&self, at_m: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Moves::Turns(axis, through) => axis.cross(&(at_m - through)),
            Moves::Slides(along) => *along,
        }
    }

    fn spin(&self) -> Vector3<f64> {
        match self {
            Moves::Turns(axis, _) => *axis,
            Moves::Slides(_) => Vector3::zeros(),
        }
    }
}

/// What a chain is to the witness: coordinates with stiffnesses and names, and bodies with the number of coordinates inboard.
#[derive(Default)]
struct ByHand {
    coordinates: Vec<(Moves, f64, String)>,
    bodies: Vec<(usize, f64, Vector3<f64>, Matrix3<f64>)>,
    at_m: Vector3<f64>,
    turn: Rotation3<f64>,
}

impl ByHand {
    fn of(arm: &Value, pose_si: &[f64]) -> Self {
        let mut out = Self::default();
        let mut entries = pose_si.iter();
        for piece in arm["chain"].as_array().expect("a chain") {
            match piece["type"].as_str().expect("a type") {
                "joint" => out.joint(piece, *entries.next().expect("an angle")),
                "prismatic" => out.prismatic(piece, *entries.next().expect("a travel")),
                _ => {
                    out.bodies(piece, None);
                    out.at_m += out.turn * vector(&piece["vector_m"]);
                }
            }
        }
        out
    }

    /// Adds the bodies whose key `outboard` is true, or those without the key.
    fn bodies(&mut self, piece: &Value, outboard: Option<(&str, bool)>) {
        for body in piece["bodies"].as_array().into_iter().flatten() {
            if outboard.is_some_and(|(key, wanted)| body[key].as_bool().unwrap_or(false) != wanted) {
                continue;
            }
            let tensor = Matrix3::from_fn(|i, j| body["inertia_kgm2"][i][j].as_f64().expect("a number"));
            let (turn, kg) = (self.turn.matrix(), body["mass_kg"].as_f64().expect("kg"));
            let centre_m = self.at_m + self.turn * vector(&body["cg_m"]);
            self.bodies.push((self.coordinates.len(), kg, centre_m, turn * tensor * turn.transpose()));
        }
    }

    fn point(&mut self, kg: &Value) {
        let kg = kg.as_f64().unwrap_or(0.0);
        self.bodies.push((self.coordinates.len(), kg, self.at_m, Matrix3::zeros()));
    }

    fn spring(&mut self, moves: Moves, stiffness: &Value, name: String) {
        if let Some(stiffness) = stiffness.as_f64() {
            self.coordinates.push((moves, stiffness, name));
        }
    }

    fn joint(&mut self, piece: &Value, angle_rad: f64) {
        self.point(&piece["mass_kg"]);
        let axis = vector(&piece["axis"]).normalize();
        let name = piece["name"].as_str().expect("a name").to_string();
        self.spring(Moves::Turns(self.turn * axis, self.at_m), &piece["stiffness_nm_per_rad"], name);
        self.turn *= Rotation3::from_axis_angle(&Unit::new_normalize(axis), angle_rad);
    }

    fn prismatic(&mut self, piece: &Value, travel_m: f64) {
        self.point(&piece["fixed_mass_kg"]);
        self.bodies(piece, Some(("travels", false)));
        let x = vector(&piece["axis"]).normalize();
        let up = if x.z.abs() > 0.99 { Vector3::x() } else { Vector3::z() };
        let y = up.cross(&x).normalize();
        let axes = [x, y, x.cross(&y)].map(|axis| self.turn * axis);
        let moved_m = self.at_m + axes[0] * travel_m;
        let through = if piece["moves"] == "ram" { self.at_m } else { moved_m };
        let name = piece["name"].as_str().expect("a name");
        for (axis, key) in axes.iter().zip(["roll_nm_per_rad", "pitch_nm_per_rad", "yaw_nm_per_rad"]) {
            self.spring(Moves::Turns(*axis, through), &piece["guide"][key], format!("{name}.guide"));
        }
        self.spring(Moves::Slides(axes[0]), &piece["stiffness_n_per_m"], name.to_string());
        self.at_m = moved_m;
        self.point(&piece["mass_kg"]);
        self.bodies(piece, Some(("travels", true)));
    }

    /// `M = Σ m Jvᵀ Jv + Jwᵀ I Jw`.
    fn mass(&self) -> DMatrix<f64> {
        let n = self.coordinates.len();
        let mut mass = DMatrix::zeros(n, n);
        for (inboard, kg, centre_m, inertia) in &self.bodies {
            for i in 0..*inboard {
                for j in 0..*inboard {
                    let (a, b) = (&self.coordinates[i].0, &self.coordinates[j].0);
                    mass[(i, j)] += kg * a.velocity(centre_m).dot(&b.velocity(centre_m))
                        + a.spin().dot(&(inertia * b.spin()));
                }
            }
        }
        mass
    }

    /// Work of the weights per unit of each coordinate.
    fn forces(&self) -> DVector<f64> {
        let mut forces = DVector::zeros(self.coordinates.len());
        for (inboard, kg, centre_m, _) in &self.bodies {
            for i in 0..*inboard {
                forces[i] -= kg * GRAVITY_M_S2 * self.coordinates[i].0.velocity(centre_m).z;
            }
        }
        forces
    }

    fn tip_m(&self, forces: &DVector<f64>) -> Vector3<f64> {
        let yields = self.coordinates.iter().zip(forces.iter());
        yields.map(|((moves, stiffness, _), force)| moves.velocity(&self.at_m) * (force / stiffness)).sum()
    }

    /// Frequencies \[Hz\], lowest first.
    fn frequencies_hz(&self) -> Vec<f64> {
        let mass = self.mass();
        let scaled = DMatrix::from_fn(mass.nrows(), mass.ncols(), |i, j| {
            mass[(i, j)] / (self.coordinates[i].1 * self.coordinates[j].1).sqrt()
        });
        let mut inverse: Vec<f64> = SymmetricEigen::new(scaled).eigenvalues.iter().copied().collect();
        inverse.sort_by(|a, b| b.total_cmp(a));
        inverse.iter().map(|mu| 1.0 / (mu.max(0.0).sqrt() * TAU)).collect()
    }
}

fn random_arm(dice: &mut Dice) -> (Value, Vec<f64>) {
    let unit = |dice: &mut Dice| [0; 3].map(|_| dice.within(-1.0, 1.0));
    let (mut chain, mut pose) = (Vec::new(), Vec::new());
    for i in 0..3 + dice.below(3) {
        // the first slides, so that every arm has both
        if i == 0 || (i > 1 && dice.below(2) == 0) {
            chain.push(random_prismatic(dice, &format!("s{i}")));
            pose.push(dice.within(-800.0, 800.0));
        } else {
            chain.push(json!({"type": "joint", "name": format!("j{i}"), "axis": unit(dice), "mass_kg": dice.within(0.5, 5.0),
                "stiffness_nm_per_rad": 10f64.powf(dice.within(3.0, 5.0))}));
            pose.push(dice.within(-180.0, 180.0));
        }
        let i = dice.within(0.01, 0.2);
        chain.push(json!({"type": "link", "name": format!("l{}", chain.len()), "vector_m": unit(dice), "bodies": [
            {"mass_kg": dice.within(1.0, 9.0), "cg_m": unit(dice), "inertia_kgm2": [[i, 0, 0], [0, i, 0], [0, 0, 1.5 * i]]}]}));
    }
    (json!({"chain": chain}), pose)
}

/// Forces, torques, the tip, and as many modes as there are springs. Both sum the same products in another order, so that
/// 1e-9 leaves room for rounding of the eigenvalues alone.
#[test]
fn random_arms_behave_as_their_jacobians_say() {
    let dice = &mut Dice(31);
    for round in 0..40 {
        let (arm, pose) = random_arm(dice);
        let library = read(&arm);
        let pose_si = pose_si(&library.driven_joints(), &pose);
        let hand = ByHand::of(&arm, &pose_si);
        let chain = Chain::new(&library.structure(JointModel::ThreeSegment), LinkModel::Full);
        let posed = chain.pose_rad(&pose_si, &Payload::default(), Vector3::zeros());
        let statics = posed.statics();
        let (forces, what) = (hand.forces(), format!("round {round}: {arm} {pose:?}"));
        let held = statics.joint_torques_nm.iter().chain(&statics.joint_forces_n);
        for (name, own) in held {
            let by_hand = hand.coordinates.iter().position(|(_, _, n)| n == name).map(|i| forces[i]);
            // a rigid drive is no coordinate of the witness
            assert!(by_hand.is_none_or(|f| (f - own).abs() < 1e-9 * forces.amax()), "{name} {own}: {what}");
        }
        let (tip, by_hand) = (statics.tip_displacement_m, hand.tip_m(&forces));
        assert!((tip - by_hand).norm() < 1e-9 * by_hand.norm(), "{tip} {by_hand}: {what}");
        let hz = hand.frequencies_hz();
        let own: Vec<f64> = posed.modes(&statics, hz.len()).iter().map(|mode| mode.frequency_hz).collect();
        assert_eq!(own.len(), hz.len(), "{what}");
        for (a, b) in hz.iter().zip(&own) {
            assert!((a / b - 1.0).abs() < 1e-9, "{hz:?} {own:?}: {what}");
        }
    }
}

/// The point of the centre line that is last moves like the tip.
#[test]
fn a_drawing_ends_where_the_tip_is() {
    let dice = &mut Dice(8);
    for _ in 0..10 {
        let (arm, pose) = random_arm(dice);
        let library = read(&arm);
        let chain = Chain::new(&library.structure(JointModel::ThreeSegment), LinkModel::Full);
        let pose_si = chain.pose_si(&pose);
        let posed = chain.pose_rad(&pose_si, &Payload::default(), Vector3::zeros());
        let statics = posed.statics();
        let line = posed.centre_line(&pose_si, &statics.deformations);
        let last = line.last().expect("stations");
        assert!((last.at_m - posed.tip_m).norm() < 1e-12);
        assert!((last.moved_m - statics.tip_displacement_m).norm() < 1e-12, "{}", last.moved_m);
    }
}

#[test]
fn a_case_is_written_as_it_is_read() {
    let (arm, pose) = random_arm(&mut Dice(2));
    let arm = read(&arm);
    let driven = arm.driven_joints();
    let entries: serde_json::Map<String, Value> =
        driven.iter().zip(&pose).map(|(joint, entry)| (joint.key(), json!(entry))).collect();
    let read = cases(&arm, json!([{"name": "a", "pose": entries}]));
    let again = cases(&arm, json!([read[0].to_json(&driven)]));
    assert_eq!(again, read);
    assert_eq!(read[0].to_json(&[DrivenJoint::turning("a")])["pose_deg"], json!(pose));
}
