//! What a run works out beside its front: the front under scatter, the designs near it, and those that are on it for
//! their ballast; each against a slow calculation from its definition.

use crate::dice::Dice;
use armwright::arm::{Element, LinkBody};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::pareto::Objectives;
use armwright::report::picks;
use armwright::report::tolerance::Scattered;
use armwright::search::near::{Slack, near_designs};
use armwright::search::scatter::{ChosenParts, Factors, Rating};
use armwright::space::ArmProblem;
use armwright::space::OutwardIn;
use armwright::space::design::{full_objectives, id_of, number, number_of, options};
use armwright::space::design_space::SpacePiece;
use armwright::space::evaluate;
use armwright::study::ballast_flags;
use armwright::study::front_table;
use armwright::study::picks_on_same_drives;
use armwright::study::{Extent, Judged, StudyOutcome, run_exact, run_study};
use armwright::study::{NearFront, near_front};
use armwright::study::{Sampling, scatter_front};
use armwright::study::{Study, read_study};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::AtomicBool;

fn read(study: &Value, catalogs: &Catalogs) -> Study {
    let text = study.to_string();
    let document = Document::parse("study", &text).unwrap_or_else(|e| panic!("{e}"));
    read_study(document, catalogs).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn outcome(study: &Study, catalogs: &Catalogs) -> StudyOutcome {
    run_study(study, catalogs, &AtomicBool::new(false), |_, _, _| ())
}

fn wrist_drives(motors: &[&str]) -> Value {
    json!({"gear_series": ["CSG", "HFUC"], "ratios": [100], "motor_models": motors})
}

/// A small arm with an open drive, two open links, a gear given by name, and one or two random poses.
fn random_study(seed: u64) -> Value {
    let dice = &mut Dice(seed);
    let tube = |dice: &mut Dice, name: &str, length_m: f64| {
        let widths: Vec<u64> = (0..2).map(|k| 50 + 20 * k + dice.below(15)).collect();
        json!({"type": "link", "name": name, "vector_m": [length_m, 0, dice.of(&[0.0, 0.05])], "choose": {
            "materials": ["Structural steel S355", "Aluminium 6061-T6"],
            "sections": [{"shape": "rectangular_tube", "width_mm": widths, "height_mm": "=width", "wall_mm": [2, 4]}]}})
    };
    let poses: Vec<Value> = (0..1 + dice.below(2))
        .map(|_| json!({"pose_deg": [dice.within(-60.0, 60.0), dice.within(-90.0, 90.0)]}))
        .collect();
    let (upper, fore) = (tube(dice, "upper_arm", 0.5), tube(dice, "forearm", 0.4));
    let effects = dice.of(&[
        json!([]),
        json!([
        {"effect": "connection_compliance", "at": "elbow", "parameters": {"stiffness_nm_per_rad": 4e4}},
        {"effect": "harness_mass", "at": "upper_arm", "parameters": {"kg_per_m": 1.0}},
        {"effect": "bearing_tilt", "at": "shoulder", "parameters": {"stiffness_nm_per_rad": 2e5}}]),
    ]);
    json!({"name": "random", "chain": [
        {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "gear": "CSG-32-100", "mass_kg": 4.0},
        upper,
        {"type": "joint", "name": "elbow", "axis": [0, 1, 0], "drive": "all_fits", "drives": wrist_drives(&["ILM70x18", "ILM85x26"])},
        fore],
        "payload": {"mass_kg": dice.within(1.0, 4.0), "cg_m": [0.05, dice.of(&[0.0, 0.03]), 0]},
        "poses": poses, "effects": effects,
        "models": {"joints": dice.of(&["three_segment", "three_segment", "k2"])}})
}

fn apart(a: &Objectives, b: &Objectives) -> f64 {
    let pairs = a.minimized().into_iter().zip(b.minimized());
    pairs.map(|(x, y)| if x == y { 0.0 } else { (x / y - 1.0).abs() }).fold(0.0, f64::max)
}

/// Objectives by the full model of a design whose arm is taken out and changed part by part.
fn by_the_full_model(problem: &ArmProblem, chosen: &[u32], factors: &Factors) -> Objectives {
    let factor = |figure: Rating| factors.get(&figure).copied().unwrap_or(1.0);
    let mut arm = problem.arm(chosen).expect("a design that holds");
    for element in &mut arm.chain {
        match element {
            Element::Joint(joint) => {
                let Some(gear) = joint.gear.clone() else { continue };
                joint.curve = joint.curve.stiffened(factor(Rating::GearStiffness(gear.clone())));
                if let Some(stiffness) =
                    joint.bearing.as_mut().and_then(|b| b.tilt_stiffness_nm_per_rad.as_mut())
                {
                    // a given joint has a rating of its own, whatever gear another joint takes
                    let stated = factors.get(&Rating::StatedBearingStiffness(joint.name.clone())).copied();
                    *stiffness *= stated.unwrap_or_else(|| factor(Rating::BearingStiffness(gear.clone())));
                }
                let Some(motor) = joint.motor.clone() else { continue };
                let catalogs = Catalogs::builtin();
                let motor_kg = catalogs.motor(&motor).expect("a motor").mass_kg.expect("its mass");
                let gear_kg = joint.mass_kg - motor_kg;
                joint.mass_kg =
                    gear_kg * factor(Rating::GearMass(gear)) + motor_kg * factor(Rating::MotorMass(motor));
            }
            Element::Prismatic(_) => {}
            Element::Link(link) => {
                if let LinkBody::Tube { material_name, material, .. } = &mut link.body {
                    *material = material.stiffened(factor(Rating::Modulus(material_name.clone())));
                }
            }
        }
    }
    full_objectives(&arm, &problem.load_cases())
}

#[test]
fn a_scattered_design_has_the_objectives_of_the_full_model_with_the_same_parts() {
    let catalogs = Catalogs::builtin();
    let (mut compared, mut moved) = (0, 0);
    for seed in 0..12 {
        let study = read(&random_study(seed), &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let dice = &mut Dice(seed + 100);
        let total: u128 = problem.level_sizes().iter().map(|&n| u128::from(n)).product();
        let picked = (0..40).filter_map(|_| options(problem.level_sizes(), u128::from(dice.next()) % total));
        let designs: Vec<Vec<u32>> = picked.filter(|o| problem.arm(o).is_some()).take(5).collect();
        let parts = ChosenParts::new(&problem, &designs).expect("designs that hold");
        for kinds in [1, 2, 3] {
            let draw = |figure: Rating| {
                let scatters = kinds == 3 || matches!(figure, Rating::GearStiffness(_)) == (kinds == 1);
                (figure, if scatters { dice.within(0.7, 1.3) } else { 1.0 })
            };
            let factors: Factors = parts.ratings().into_iter().map(draw).collect();
            let built = parts.built(&factors);
            for (i, design) in designs.iter().enumerate() {
                let full = by_the_full_model(&problem, design, &factors);
                let difference = apart(&built.objectives(i), &full);
                assert!(difference < 1e-10, "seed {seed}: {difference:e}, {factors:?}");
                let nominal = evaluate(&problem, number(problem.level_sizes(), design)).expect("holds");
                moved += usize::from(apart(&nominal.objectives, &full) > 1e-3);
                compared += 1;
            }
        }
    }
    assert!(compared > 100 && moved > compared / 2, "{moved} of {compared} designs moved");
}

fn scattered(study: &Study, catalogs: &Catalogs, sampling: &Sampling) -> Scattered {
    let problem = ArmProblem::new(&study.space, catalogs);
    let outcome = outcome(study, catalogs);
    let designs = picks::designs(&front_table(&problem, catalogs, &outcome.front));
    scatter_front(&problem, catalogs, &outcome.front, &designs, sampling, &AtomicBool::new(false))
        .expect("not stopped")
}

fn sampling(tolerance: &str, samples: u32, seed: u64) -> Sampling {
    Sampling { tolerance: tolerance.parse().expect("a scatter"), samples, seed }
}

/// The error function by its power series.
fn normal_share_below(z: f64) -> f64 {
    let x = z / 2f64.sqrt();
    let (mut term, mut sum) = (x, x);
    for n in 1..80 {
        term *= -x * x / f64::from(n);
        sum += term / f64::from(2 * n + 1);
    }
    0.5 + sum / std::f64::consts::PI.sqrt()
}

/// One joint and a rigid link: deflection is as 1/K, the mode as the root of K. Of two gears the heavier is on the
/// front as long as it is the stiffer one.
#[test]
fn how_often_a_stiffer_gear_stays_on_the_front_follows_from_the_normal_distribution() {
    let mut catalogs = Catalogs::builtin();
    let k2 =
        |catalogs: &Catalogs, name: &str| catalogs.gear(name).expect("a gear").k2_nm_per_rad.expect("K2");
    let [light, heavy] = ["CSG-32-100", "CSG-40-100"];
    let ratio = 1.08;
    let of_light = k2(&catalogs, light);
    for gear in catalogs.gears.iter_mut().filter(|g| g.id == heavy) {
        (gear.k1_nm_per_rad, gear.k2_nm_per_rad, gear.k3_nm_per_rad) =
            (Some(of_light), Some(of_light * ratio), Some(of_light * 2.0));
    }
    let study = json!({"name": "two gears", "chain": [
        {"type": "joint", "name": "j", "axis": [0, 1, 0], "drive": "all_fits",
            "drives": {"gears": [light, heavy], "motor_models": ["ILM85x26"]}},
        {"type": "link", "name": "arm", "vector_m": [0.6, 0, 0]}],
        "payload": {"mass_kg": 3}, "poses": [{"pose_deg": [0]}], "models": {"links": "rigid", "joints": "k2"}});
    let found = scattered(&read(&study, &catalogs), &catalogs, &sampling("gear_stiffness=10%", 20_000, 3));
    assert_eq!(found.fates.len(), 2);
    let share = f64::from(found.fates[1].on_front) / 20_000.0;
    let sigma = 1.1f64.ln() / 1.959_964;
    let expected = normal_share_below(ratio.ln() / (sigma * 2f64.sqrt()));
    println!("{share} of the samples, {expected} by the normal distribution");
    assert!((share - expected).abs() < 3.0 * (expected * (1.0 - expected) / 20_000.0).sqrt());
    assert_eq!(found.fates[0].on_front, 20_000, "the lighter gear is always on the front");
    assert_eq!(
        found.fates[0].picked[1] + found.fates[1].picked[1],
        20_000,
        "something is always the stiffest"
    );
    // deflection goes as the inverse of the factor: its 5 and 95 % points are known too
    let band = found.fates[0].percentiles.expect("a pick")[0];
    let expected = (1.644_854 * sigma).exp();
    assert!(
        (band[2] / band[1] / expected - 1.0).abs() < 5e-3
            && (band[1] / band[0] / expected - 1.0).abs() < 5e-3
    );
}

/// One joint with a rigid link that stands out along its axis: a payload at the tip loads the bearing alone.
fn arm_on_its_bearing(bearing: Option<Value>) -> Value {
    let mut joint = json!({"type": "joint", "name": "j", "axis": [1, 0, 0], "max_speed_rad_s": 1.0, "drive": "all_fits",
        "drives": {"gears": ["CSG-32-100"], "gear_mass": "housed_unit", "motor_models": ["ILM85x26"]}});
    bearing.into_iter().for_each(|stated| joint["bearing"] = stated);
    json!({"name": "bearing alone", "chain": [
        joint, {"type": "link", "name": "arm", "vector_m": [0.6, 0, 0]}],
        "payload": {"mass_kg": 3}, "poses": [{"pose_deg": [0]}]})
}

#[test]
fn a_tip_on_a_bearing_alone_scatters_as_the_inverse_of_its_stiffness() {
    let catalogs = Catalogs::builtin();
    let numbers = json!({"tilt_stiffness_nm_per_rad": 2e5, "permissible_moment_nm": 500});
    for stated in [None, Some(numbers)] {
        let study = read(&arm_on_its_bearing(stated), &catalogs);
        let found = scattered(&study, &catalogs, &sampling("bearing_stiffness=10%", 20_000, 5));
        let [low, middle, high] = found.fates[0].percentiles.expect("a pick")[0];
        let nominal_mm = found.fates[0].design.tip_deflection_mm;
        // the factor is log-normal with median 1, and 1.96 sigmas are the stated scatter
        let expected = (1.644_854 * 1.1f64.ln() / 1.959_964).exp();
        assert!((middle / nominal_mm - 1.0).abs() < 2e-3, "{middle} {nominal_mm}");
        assert!((high / middle / expected - 1.0).abs() < 5e-3, "{high} {middle}");
        assert!((middle / low / expected - 1.0).abs() < 5e-3, "{middle} {low}");
        let of_gear = scattered(&study, &catalogs, &sampling("gear_stiffness=10%", 50, 5));
        let [low, _, high] = of_gear.fates[0].percentiles.expect("a pick")[0];
        assert_eq!(low, high, "the gear's torsion carries nothing");
    }
}

#[test]
fn samples_are_the_same_on_any_number_of_threads_and_limits_count() {
    let catalogs = Catalogs::builtin();
    let mut study = random_study(4);
    let plain =
        scattered(&read(&study, &catalogs), &catalogs, &sampling("gear_stiffness,modulus,mass", 300, 9));
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let again = pool.install(|| {
            scattered(&read(&study, &catalogs), &catalogs, &sampling("gear_stiffness,modulus,mass", 300, 9))
        });
        assert_eq!(again, plain, "{threads} threads");
    }
    assert!(plain.fates.iter().all(|f| f.keeps_limits == 300));
    let lightest = plain.fates.iter().find(|f| f.picks.contains(&"lightest")).expect("a lightest design");
    study["constraints"] = json!({"tip_deflection_max_mm": lightest.design.tip_deflection_mm * 1.0001});
    let limited = scattered(&read(&study, &catalogs), &catalogs, &sampling("gear_stiffness", 300, 9));
    let same = |f: &&armwright::report::tolerance::Fate| f.design.design_id == lightest.design.design_id;
    let at_the_limit = limited.fates.iter().find(same).expect("it keeps the limit");
    let kept = at_the_limit.keeps_limits;
    assert!(at_the_limit.on_front <= kept && (75..225).contains(&kept), "about half keep it: {kept}");
}

/// The designs within a slack by the definition, all pairs, the full model.
fn near_by_definition(all: &[(u128, Objectives)], front: &BTreeSet<u128>, slack: f64) -> BTreeSet<u128> {
    let on: Vec<[f64; 3]> =
        all.iter().filter(|(n, _)| front.contains(n)).map(|(_, o)| o.minimized()).collect();
    let near = |o: &Objectives| {
        let worst = [
            o.mass_kg / (1.0 + slack),
            o.tip_deflection_m / (1.0 + slack),
            -o.lowest_mode_hz * (1.0 + slack),
        ];
        on.iter().any(|f| (0..3).all(|k| worst[k] <= f[k]))
    };
    all.iter().filter(|(n, o)| !front.contains(n) && near(o)).map(|(n, _)| *n).collect()
}

#[test]
fn the_designs_near_a_front_are_those_of_the_definition_and_a_cap_keeps_the_nearest() {
    let catalogs = Catalogs::builtin();
    let stop = AtomicBool::new(false);
    let (mut listed, mut tied) = (0, 0);
    for seed in 0..4 {
        let study = read(&random_study(seed), &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let outcome = outcome(&study, &catalogs);
        let total: u128 = problem.level_sizes().iter().map(|&n| u128::from(n)).product();
        let all: Vec<(u128, Objectives)> = (0..total as u64)
            .into_par_iter()
            .filter_map(|n| Some((n.into(), evaluate(&problem, n.into())?.objectives)))
            .collect();
        let front: BTreeSet<u128> = outcome.front.iter().map(|j| j.design.number).collect();
        for slack in [0.004, 0.06] {
            let expected = near_by_definition(&all, &front, slack);
            let found =
                near_front(&problem, &catalogs, &outcome, Slack { part: slack, most: 100_000 }, &stop)
                    .expect("done");
            let ids: BTreeSet<String> = found.table.rows.iter().map(|r| r[0].clone()).collect();
            assert_eq!(ids, expected.iter().map(|&n| id_of(n)).collect(), "seed {seed}, slack {slack}");
            assert_eq!((found.total, found.capped), (Some(expected.len() as u64), false));
            listed += ids.len();
            let column = found.table.column("interchangeable").expect("the column");
            tied += found.table.rows.iter().filter(|r| !r[column].is_empty()).count();
            let shortfalls: Vec<f64> =
                found.table.numbers("shortfall_percent").into_iter().map(|s| s.expect("a number")).collect();
            assert!(shortfalls.is_sorted() && shortfalls.iter().all(|s| (0.0..=100.0 * slack).contains(s)));
            // the nearest few of the same list
            let few = ids.len() / 3;
            let candidates: Vec<_> =
                outcome.sweep.front.iter().filter(|c| front.contains(&c.number)).copied().collect();
            let capped = near_designs(
                &problem,
                &study.space.constraints,
                &candidates,
                Slack { part: slack, most: few },
                &stop,
            )
            .expect("done");
            assert_eq!((capped.nearest.len(), capped.total), (few, Some(expected.len() as u64)));
            let nearest = capped.nearest.iter().map(|d| 100.0 * d.shortfall);
            assert!(nearest.zip(&shortfalls).all(|(a, b)| (a - b).abs() < 1e-6));
        }
    }
    println!("{listed} near designs, {tied} with an interchangeable part");
    assert!(listed > 200, "only {listed} designs are near");
}

#[test]
fn an_exact_search_lists_the_same_materials_and_the_same_near_designs() {
    let (catalogs, stop) = (Catalogs::builtin(), AtomicBool::new(false));
    let (mut of_materials, mut listed) = (0, 0);
    for seed in 0..6 {
        let study = read(&random_study(seed), &catalogs);
        let slack = Slack { part: 0.03, most: if seed % 2 == 0 { 100_000 } else { 40 } };
        let problem = ArmProblem::new(&study.space, &catalogs);
        let visited = outcome(&study, &catalogs);
        let exact =
            run_exact(&study, &catalogs, &stop, Extent { near: Some(slack), ..Extent::default() }, |_, _| ());
        let excerpt = ArmProblem::new(&exact.study.space, &catalogs);
        let ids = |problem: &ArmProblem, front: &[Judged]| -> BTreeSet<String> {
            front.iter().map(|j| id_of(problem.whole_number(j.design.number))).collect()
        };
        assert_eq!(ids(&excerpt, &exact.outcome.front), ids(&problem, &visited.front), "seed {seed}");
        assert_eq!(exact.outcome.by_material.len(), visited.by_material.len(), "seed {seed}");
        for (a, b) in exact.outcome.by_material.iter().zip(&visited.by_material) {
            assert_eq!((&a.name, ids(&excerpt, &a.front)), (&b.name, ids(&problem, &b.front)), "seed {seed}");
            of_materials += a.front.len();
        }
        let found = exact.near.expect("the search came to its end");
        let near = NearFront::of(&excerpt, &catalogs, &exact.outcome.front, &found, slack);
        let expected = near_front(&problem, &catalogs, &visited, slack, &stop).expect("done");
        let cells = |near: &NearFront, column: &str| -> Vec<String> {
            let column = near.table.column(column).expect("the column");
            near.table.rows.iter().map(|row| row[column].clone()).collect()
        };
        for column in ["design_id", "shortfall_percent", "near_to", "interchangeable"] {
            assert_eq!(cells(&near, column), cells(&expected, column), "seed {seed}");
        }
        assert_eq!((near.total, near.capped), (expected.total, expected.capped), "seed {seed}");
        listed += near.table.rows.len();
    }
    println!("{of_materials} designs on fronts of materials, {listed} near");
    assert!(of_materials > 100 && listed > 100);
}

/// An arm whose heavier wrist drives press joint 2 into a stiffer segment of its gear.
fn ballast_study(joint: &Value) -> Value {
    let wrist = json!({"gear_series": ["CSG"], "ratios": [100], "motors": ["electric"]});
    let mut j2 = json!({"type": "joint", "name": "j2", "axis": [0, 1, 0], "mass_kg": 10});
    j2.as_object_mut().expect("an object").extend(joint.as_object().expect("an object").clone());
    json!({"name": "ballast", "chain": [
        j2,
        {"type": "link", "name": "arm", "vector_m": [0.8, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "rectangular_tube", "width_mm": [80, 100, 120], "height_mm": [100, 140], "wall_mm": [3, 5]}]}},
        {"type": "joint", "name": "j3", "axis": [0, 1, 0], "drive": "all_fits", "drives": wrist, "bearing": null},
        {"type": "link", "name": "flange", "vector_m": [0.2, 0, 0]}],
        "payload": {"mass_kg": 3}, "poses": [{"pose_deg": [0, 0]}], "extras": "none"})
}

#[test]
fn designs_are_flagged_whose_heavier_part_only_presses_a_gear_into_a_stiffer_segment() {
    let catalogs = Catalogs::builtin();
    let steps = json!({"windup": {"k1_nm_per_rad": 2e5, "k2_nm_per_rad": 3.6e5, "k3_nm_per_rad": 4.4e5, "t1_nm": 90, "t2_nm": 130}});
    let study = read(&ballast_study(&steps), &catalogs);
    let problem = ArmProblem::new(&study.space, &catalogs);
    let outcome = outcome(&study, &catalogs);
    let [drives, tubes] = *problem.level_sizes() else { panic!("two levels") };
    let table = &problem.sized_joint(2).expect("joint 3 is sized").table;
    // torque on joint 2 by hand: the payload at 1.0 m, the drive at 0.8 m, the tube's middle at 0.4 m
    let segment = |drive: u32, o: &Objectives| {
        let drive_kg = table.mass_kg(drive as usize);
        let tube_kg = o.mass_kg - 10.0 - drive_kg;
        let torque_nm = 9.81 * (3.0 + 0.8 * drive_kg + 0.4 * tube_kg);
        usize::from(torque_nm > 90.0) + usize::from(torque_nm > 130.0)
    };
    let stiffness = |drive: u32, torque_nm: f64| {
        let gear = table.drive(drive as usize).gear;
        let [k1, k2, k3] =
            [gear.k1_nm_per_rad, gear.k2_nm_per_rad, gear.k3_nm_per_rad].map(|k| k.expect("known"));
        let [t1, t2] = [gear.t1_nm, gear.t2_nm].map(|t| t.expect("known"));
        if torque_nm <= t1 {
            k1
        } else if torque_nm <= t2 {
            k2
        } else {
            k3
        }
    };
    let never_softer =
        |a: u32, b: u32| (0..4000).map(|t| 0.5 * f64::from(t)).all(|t| stiffness(a, t) >= stiffness(b, t));
    let mut expected = BTreeSet::new();
    for judged in &outcome.front {
        let o = judged.design.objectives;
        let [drive, tube] = options(problem.level_sizes(), judged.design.number).expect("in range")[..]
        else {
            panic!()
        };
        // tubes of one material never count: the lighter has less area and is softer in stretch
        let mut lighter =
            (0..drives).filter_map(|d| Some((d, evaluate(&problem, number(&[drives, tubes], &[d, tube]))?)));
        let shows = lighter.any(|(d, e)| {
            let e = e.objectives;
            e.mass_kg < o.mass_kg
                && e.tip_deflection_m <= o.tip_deflection_m * (1.0 + 1e-9)
                && e.lowest_mode_hz < o.lowest_mode_hz
                && never_softer(d, drive)
                && segment(d, &e) < segment(drive, &o)
        });
        if shows {
            expected.insert(id_of(judged.design.number));
        }
    }
    let flags = ballast_flags(&problem, &outcome.front);
    let csv = String::from_utf8(flags.to_csv()).expect("text");
    let flagged: BTreeSet<String> =
        csv.lines().skip(1).filter_map(|line| Some(line.split(',').next()?.to_string())).collect();
    println!("{} of {}\n{}", flags.len(), outcome.front.len(), flags.to_markdown());
    assert_eq!(flagged, expected);
    assert!(!flagged.is_empty() && flagged.len() < outcome.front.len());
    // a joint of one stiffness has no segment to be pressed into
    let flags = |study: &Value| {
        let straight = read(study, &catalogs);
        let outcome = self::outcome(&straight, &catalogs);
        ballast_flags(&ArmProblem::new(&straight.space, &catalogs), &outcome.front)
    };
    let mut straight = ballast_study(&json!({"stiffness_nm_per_rad": 3.6e5}));
    assert!(flags(&straight).is_empty());
    // its play closes under weight
    let play = json!({"half_width_rad": 2e-3, "torque_nm": 25});
    straight["effects"] = json!([{"effect": "lost_motion", "at": "j2", "parameters": play}]);
    let words = flags(&straight).to_markdown();
    assert!(
        words.contains("because the play of j2 opens.") && words.contains("where it is stiffer"),
        "{words}"
    );
}

/// An arm whose shoulder and elbow take the lightest drive that holds.
fn first_fit_study() -> Value {
    let tube = |name: &str, length_m: f64| {
        json!({"type": "link", "name": name, "vector_m": [length_m, 0, 0], "choose": {
            "materials": ["Structural steel S355", "Aluminium 6061-T6"],
            "sections": [{"shape": "rectangular_tube", "width_mm": [60, 90, 120], "height_mm": "=width", "wall_mm": [2, 4, 8]}]}})
    };
    let joint = |name: &str| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "drive": "first_fit"});
    json!({"name": "first fit", "chain": [
        joint("shoulder"), tube("upper_arm", 0.6), joint("elbow"), tube("forearm", 0.5)],
        "payload": {"mass_kg": 3}, "poses": [{"pose_deg": [0, 0]}]})
}

/// Whether an arm with the drives of a design and one other, lighter tube is no worse, by the full model.
fn one_lighter_tube_is_no_worse(problem: &ArmProblem, design: &[u32]) -> bool {
    let arm = problem.arm(design).expect("a design that holds");
    let cases = problem.load_cases();
    let judged = full_objectives(&arm, &cases);
    let choices = problem.space().pieces.iter().enumerate().filter_map(|(piece, what)| match what {
        SpacePiece::Choice(choice) => Some((piece, choice)),
        _ => None,
    });
    let mut others =
        choices.flat_map(|(piece, choice)| choice.options.iter().map(move |o| (piece, choice.link(o))));
    others.any(|(piece, link)| {
        let mut other = arm.clone();
        other.chain[piece] = Element::Link(link);
        let o = full_objectives(&other, &cases);
        o.mass_kg < judged.mass_kg
            && o.tip_deflection_m <= judged.tip_deflection_m
            && o.lowest_mode_hz >= judged.lowest_mode_hz
    })
}

#[test]
fn picks_are_named_whose_weight_alone_gives_them_their_drives() {
    let catalogs = Catalogs::builtin();
    let named = |study: &Value| {
        let study = read(study, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let front = front_table(&problem, &catalogs, &outcome(&study, &catalogs).front);
        let told = picks_on_same_drives(&problem, &front).supplement();
        let (_, told) = told.run.expect("a fact for run.json");
        let beaten = picks::picks(&picks::designs(&front)).into_iter().filter_map(|pick| {
            let number = number_of(&pick.design.design_id).expect("an id");
            let design = options(problem.level_sizes(), number).expect("in range");
            one_lighter_tube_is_no_worse(&problem, &design)
                .then_some((pick.design.design_id, pick.design.mass_kg))
        });
        (told, beaten.collect::<Vec<_>>())
    };
    let (told, beaten) = named(&first_fit_study());
    let told = told.as_array().expect("a list");
    assert!(!beaten.is_empty(), "no pick has its drives for its weight");
    assert_eq!(told.len(), beaten.len(), "{told:?} {beaten:?}");
    for (told, (id, mass_kg)) in told.iter().zip(&beaten) {
        assert_eq!(told["design_id"], json!(id));
        assert!(told["mass_kg"].as_f64().expect("a number") < *mass_kg);
        assert!(!told["joints"].as_array().expect("joints").is_empty(), "{told}");
    }
    // a search that chooses the drives itself finds the lighter arm
    let mut chosen = first_fit_study();
    for joint in ["/chain/0", "/chain/2"] {
        let joint = chosen.pointer_mut(joint).expect("a joint");
        joint["drive"] = json!("all_fits");
        joint["drives"] = wrist_drives(&["ILM70x18", "ILM85x26"]);
    }
    let (told, beaten) = named(&chosen);
    assert_eq!((told, beaten.len()), (json!([]), 0));
}

fn run(dir: &Path, out: &str, words: &[&str]) -> (Option<i32>, String, String) {
    let file = dir.join("study.json");
    std::fs::write(&file, random_study(4).to_string()).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    let output = command
        .current_dir(dir)
        .args(["run", "study.json", "--out", out])
        .args(words)
        .output()
        .expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn a_run_writes_what_was_asked_for_beside_its_front() {
    let dir = tempfile::tempdir().expect("a folder");
    let words =
        ["--tolerance", "gear_stiffness=20%,modulus=3%", "--samples", "60", "--seed", "7", "--within", "5%"];
    let (code, plain, _) = run(dir.path(), "plain", &[]);
    assert_eq!(code, Some(0));
    let (code, printed, errors) = run(dir.path(), "one", &[&words[..], &["--threads", "1"]].concat());
    assert_eq!(code, Some(0), "{errors}");
    run(dir.path(), "two", &[&words[..], &["--threads", "2"]].concat());
    println!("{printed}");
    assert!(printed.lines().all(|line| line.chars().count() <= 80) && printed.len() > plain.len());
    let read = |folder: &str, file: &str| std::fs::read(dir.path().join(folder).join(file)).ok();
    for file in ["tolerance.csv", "near.csv", "front.csv"] {
        assert!(read("one", file).is_some() && read("one", file) == read("two", file), "{file}");
    }
    assert_eq!(read("plain", "front.csv"), read("one", "front.csv"), "the front is not touched");
    assert!(read("plain", "tolerance.csv").is_none() && read("plain", "near.csv").is_none());
    let facts: Value = serde_json::from_slice(&read("one", "run.json").expect("run.json")).expect("JSON");
    assert_eq!(facts["tolerance"]["scatter"], json!({"gear_stiffness": 0.2, "modulus": 0.03}));
    assert_eq!((&facts["tolerance"]["seed"], &facts["tolerance"]["samples"]), (&json!(7), &json!(60)));
    let near_rows =
        csv::Reader::from_reader(&read("one", "near.csv").expect("near.csv")[..]).into_records().count();
    assert_eq!((&facts["within"]["designs"], &facts["within"]["capped"]), (&json!(near_rows), &json!(false)));
    let summary = String::from_utf8(read("one", "summary.md").expect("summary.md")).expect("text");
    assert!(summary.contains("## Under scatter") && summary.contains("## Near the front"));
    let page = |folder: &str| String::from_utf8(read(folder, "report.html").expect("a page")).expect("text");
    let says = |folder: &str, words: &str| page(folder).contains(words);
    let sections = ["<h2>Under scatter</h2>", "<h2>Near the front</h2>"];
    assert!(sections.iter().all(|section| says("one", section) && !says("plain", section)));
    assert!(says("one", "seed 7") && says("plain", "Every design was visited"));
    let (_, _, _) = run(dir.path(), "few", &["--within", "20%", "--within-most", "3"]);
    let few = read("few", "near.csv").expect("near.csv");
    assert_eq!(csv::Reader::from_reader(&few[..]).into_records().count(), 3);
}

#[test]
fn what_cannot_be_answered_is_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    for (words, said) in [
        (&["--within", "200%"][..], "not a percentage"),
        (
            &["--tolerance", "stiffness=20%"][..],
            "choose from gear_stiffness, bearing_stiffness, modulus, mass",
        ),
        (&["--seed", "3"][..], "--tolerance"),
    ] {
        let (code, _, errors) = run(dir.path(), "out", words);
        assert!(code == Some(2) && errors.contains(said), "{words:?}: {errors}");
    }
}
