//! Parts that must fit: gear beside its link, motor in the hollow, cables through the bores, room at the joint. The sweep,
//! the exact search, the brute force and the verifier must have the same designs.

use crate::brute::catalog::Catalog;
use crate::brute::design::chains;
use crate::brute::study::Study as BruteStudy;
use crate::brute_force::assert_same;
use crate::brute_studies::{ALUMINIUM, STEEL, boxes, six_axes};
use crate::dice::Dice;
use crate::exact_front::random_study;
use crate::exact_support::{both_searches, read};
use crate::witness_drives::{Row, Spoil, faults, front, spoiled, times};
use armwright::arm::BearingSource;
use armwright::catalog::Catalogs;
use armwright::pareto::Objectives;
use armwright::relax::Relaxation;
use armwright::search::Sweep;
use armwright::search::sweep::Candidate;
use armwright::sizing::LinkRoom;
use armwright::space::design_space::SpacePiece;
use armwright::space::{ArmProblem, OutwardIn, evaluate};
use armwright::study::Study;
use armwright::study::question::question;
use armwright::verify::{Judge, Settings};
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// Gives every part other sizes: most are shrunk, so that some fit into these links, and some are blank.
pub fn change_sizes(catalogs: &mut Catalogs, seed: u64) {
    let dice = &mut Dice(seed + 6_000);
    let gears = catalogs.gears.iter_mut().map(|gear| &mut gear.envelope);
    for size in gears.chain(catalogs.motors.iter_mut().map(|motor| &mut motor.envelope)) {
        let by = dice.within(0.4, 1.0);
        size.outer_diameter_m = size.outer_diameter_m.map(|m| m * by).filter(|_| dice.below(8) > 0);
        size.length_m = size.length_m.map(|m| m * by).filter(|_| dice.below(8) > 0);
        size.hollow_bore_m = Some(dice.within(0.0, 0.04)).filter(|_| dice.below(4) > 0);
    }
}

/// The catalogs with other sizes.
fn other_sizes(seed: u64) -> Catalogs {
    let mut catalogs = Catalogs::builtin();
    change_sizes(&mut catalogs, seed);
    catalogs
}

fn wishes(dice: &mut Dice) -> Value {
    let mut fit = json!({"motor": dice.of(&["behind", "in_link", "in_link", "beside"])});
    if dice.below(4) > 0 {
        fit["gear_to_link_max"] = json!(dice.within(0.6, 1.4));
    }
    if dice.below(3) == 0 {
        fit["cable_bore_min_mm"] = json!(dice.within(2.0, 12.0));
    }
    if dice.below(3) == 0 {
        fit["drive_length_max_mm"] = json!(dice.within(50.0, 140.0));
    }
    fit
}

/// Asks for room in a study, with a joint that asks for another, a link that is given, or an offset before the link.
pub fn add_fits(study: &mut Value, seed: u64) {
    let dice = &mut Dice(seed + 7_000);
    study["fit"] = wishes(dice);
    study["connection_share"] = json!(dice.of(&[0.0, 0.0, 0.2]));
    study["harness_kg_per_m"] = json!(dice.of(&[0.0, 0.0, 0.6]));
    let chain = study["chain"].as_array_mut().expect("a chain");
    for joint in chain.iter_mut().filter(|piece| piece["drive"].is_string()) {
        match dice.below(4) {
            0 => joint["fit"] = wishes(dice),
            1 => joint["fit"] = dice.of(&[Value::Null, json!({"gear_to_link_max": null, "motor": "behind"})]),
            _ => {}
        }
    }
    if dice.below(2) == 0 {
        // the upper arm is the innermost choice, and the shoulder is sized for eight of them at once
        let sized = |joint: &&mut Value| {
            joint["drive"] == "all_fits" && joint["name"] != "j3" && joint["name"] != "j4"
        };
        chain.iter_mut().filter(sized).for_each(|joint| joint["drive"] = json!("first_fit"));
    }
    let column = json!({"type": "link", "name": "shoulder", "vector_m": [0, 0, 0.3], "material": "Aluminium 6061-T6",
        "section": {"shape": "round_tube", "diameter_m": dice.within(0.08, 0.2), "wall_m": 0.006}});
    if dice.below(2) == 0 {
        chain[1] = column;
    }
    if dice.below(3) == 0 {
        let elbow = chain.iter().position(|piece| piece["name"] == "j3").expect("an elbow");
        chain.insert(
            elbow + 1,
            json!({"type": "link", "name": "bracket", "vector_m": [0, 0.05, 0], "mass_kg": 0.3}),
        );
    }
}

/// How often a link keeps a drive that would hold out of a joint, in some of the designs.
fn decided_by_links(problem: &ArmProblem) -> usize {
    let mut decided = 0;
    let sizes = problem.level_sizes();
    let total: u64 = sizes.iter().map(|n| u64::from(*n)).product();
    for number in (0..total).step_by(1 + total as usize / 50) {
        let options = armwright::space::design::options(sizes, u128::from(number)).expect("in range");
        let _ = problem.walk(&options, |slot, outboard| {
            let Some(sized) = problem.sized_joint(problem.piece_of_slot(slot)) else { return };
            let demand = problem.demand_at(outboard, slot);
            let anywhere = demand.with_room(LinkRoom::ANY);
            decided +=
                usize::from(sized.table.all_fits(&demand).count() != sized.table.all_fits(&anywhere).count());
        });
    }
    decided
}

/// A sweep that took another drive than the one that fits would have other objectives.
fn assert_objectives_are_those_of_the_full_model(problem: &ArmProblem, front: &[Candidate], what: &str) {
    for candidate in front {
        let full =
            evaluate(problem, candidate.number).expect("a design of the front holds").objectives.minimized();
        let fast = candidate.objectives.minimized();
        let off = full.iter().zip(fast).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9, "{candidate:?}, by the full model {full:?}: {what}");
    }
}

/// The relaxation bounds the mass of what is as good as some designs of a front; how many it was asked of.
fn bounds_on_mass_hold(problem: &ArmProblem, front: &[Candidate], what: &str) -> usize {
    let relaxation = Relaxation::new(problem);
    let known = front.iter().step_by(1 + front.len() / 8);
    let mut bounds = 0;
    for Candidate { number, objectives, .. } in known {
        // a little less is asked, so that rounding cannot decide
        let asked = Objectives {
            tip_deflection_m: objectives.tip_deflection_m * (1.0 + 1e-6),
            mass_kg: objectives.mass_kg,
            lowest_mode_hz: objectives.lowest_mode_hz * (1.0 - 1e-6),
        };
        let is_as_good = |o: &Objectives| {
            o.tip_deflection_m <= asked.tip_deflection_m && o.lowest_mode_hz >= asked.lowest_mode_hz
        };
        let options = armwright::space::design::options(problem.level_sizes(), *number).expect("a design");
        let Some(bound) = relaxation.mass_lower_bound(&options, &asked) else { continue };
        let as_good = front.iter().map(|c| c.objectives).filter(is_as_good);
        let lightest_kg = as_good.map(|o| o.mass_kg).fold(f64::INFINITY, f64::min);
        assert!(
            bound.mass_lower_bound_kg <= lightest_kg * (1.0 + 1e-9),
            "{bound:?} {lightest_kg} kg: {what}"
        );
        bounds += 1;
    }
    bounds
}

#[test]
fn the_exact_front_is_whole_where_parts_must_fit() {
    let studies: u64 =
        std::env::var("ARMWRIGHT_EXACT_STUDIES").ok().and_then(|n| n.parse().ok()).unwrap_or(8);
    let (mut points, mut feasible, mut decided, mut bounds) = (0, 0, 0, 0);
    for seed in 0..studies {
        let (mut text, catalogs) = (random_study(seed), other_sizes(seed));
        add_fits(&mut text, seed);
        let study = read(&text, &catalogs);
        let problem = ArmProblem::new(&study.space, &catalogs);
        let what = format!("seed {seed}: {text}");
        let (front, listed) = both_searches(&study, &catalogs, seed.is_multiple_of(4), &what);
        assert_objectives_are_those_of_the_full_model(&problem, &front, &what);
        bounds += bounds_on_mass_hold(&problem, &front, &what);
        points += listed;
        feasible += u64::from(listed > 0);
        decided += usize::from(decided_by_links(&problem) > 0);
    }
    println!(
        "{studies} studies, {feasible} feasible, {points} front designs; links decide in {decided}; {bounds} bounds"
    );
    assert!(feasible * 3 > studies, "only {feasible} of {studies} studies are feasible");
    assert!(points as u64 > 6 * feasible, "fronts are too small to say much: {points} designs");
    assert!(decided as u64 * 4 > studies, "links decide in {decided} of {studies} studies only");
}

/// A waist on a bracket, a shoulder and an elbow; the gears are about as wide as the tubes, and the motors about as wide as their
/// hollows.
fn tight(fit: Value, catalogs: &Catalogs) -> Study {
    let tubes = |diameters_mm: Value| {
        json!({"materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "round_tube", "diameter_mm": diameters_mm, "wall_mm": [3, 5]}]})
    };
    let few = json!({"gear_series": ["CSG", "SHG"], "ratios": [100], "motor_models": ["ILM70x10", "ILM70x18", "ILM85x26"]});
    read(
        &json!({
            "name": "tight", "fit": fit, "connection_share": 0.15, "harness_kg_per_m": 0.4,
            "chain": [
                {"type": "joint", "name": "waist", "axis": [0, 0, 1], "drive": "first_fit", "drives": few},
                {"type": "link", "name": "bracket", "vector_m": [0, 0, 0.1]},
                {"type": "link", "name": "column", "vector_m": [0, 0, 0.2], "material": "Aluminium 6061-T6",
                    "section": {"shape": "round_tube", "diameter_m": 0.16, "wall_m": 0.006}},
                {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "drive": "all_fits", "drives": few},
                {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "choose": tubes(json!([76, 90, 120, 150]))},
                {"type": "joint", "name": "elbow", "axis": [0, 1, 0], "drive": "first_fit", "drives": few},
                {"type": "link", "name": "fore", "vector_m": [0.4, 0, 0], "choose": tubes(json!([60, 76, 90, 110]))}],
            "payload": {"mass_kg": 2, "cg_m": [0.05, 0.03, 0]},
            "poses": [{"pose_deg": [0, 0, 0]}, {"pose_deg": [0, -40, 90]}],
            "motion": {"tip_speed_m_s": 0.5},
        }),
        catalogs,
    )
}

/// The drives of a first-fit joint are bounded from above only where no bearing may ask for a heavier one.
#[test]
fn the_bound_on_mass_holds_where_narrow_tubes_need_other_drives() {
    let mut bounds = 0;
    for seed in 0..24 {
        let catalogs = other_sizes(seed);
        let mut study = tight(json!({"gear_to_link_max": 0.9, "motor": "in_link"}), &catalogs);
        for piece in &mut study.space.pieces {
            if let SpacePiece::Joint(joint) = piece {
                joint.bearing = BearingSource::Stated(None);
            }
        }
        let problem = ArmProblem::new(&study.space, &catalogs);
        let front = Sweep::new(&problem, study.space.constraints, &AtomicBool::new(false)).run().front;
        bounds += bounds_on_mass_hold(&problem, &front, &format!("seed {seed}"));
    }
    assert!(bounds > 60, "{bounds} bounds say too little");
}

/// The catalogs with a hollow through every gear.
fn hollow_gears() -> Catalogs {
    let mut catalogs = Catalogs::builtin();
    for gear in &mut catalogs.gears {
        gear.envelope.hollow_bore_m = gear.envelope.outer_diameter_m.map(|m| 0.3 * m);
    }
    catalogs
}

const ALL_ASKED: &str =
    r#"{"gear_to_link_max": 1.25, "motor": "in_link", "cable_bore_min_mm": 10, "drive_length_max_mm": 70}"#;
/// The column of the study `tight` is 200 mm long, so that motors are too long for it that are some times as long.
const LONG_MOTOR: &str = r#"{"motor": "in_link"}"#;
const ON_AXIS: &str = r#"{"cable_bore_min_mm": 25, "drive_length_max_mm": 110}"#;

fn asked(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// One size each, and a study in which it decides.
const SIZES: [(&str, &str, Spoil); 7] = [
    ("gear diameter", ALL_ASKED, |gear, _, by| times(&mut gear.envelope.outer_diameter_m, by)),
    ("gear bore", ALL_ASKED, |gear, _, by| times(&mut gear.envelope.hollow_bore_m, by)),
    ("gear length", ALL_ASKED, |gear, _, by| times(&mut gear.envelope.length_m, by)),
    ("motor diameter", ALL_ASKED, |_, motor, by| times(&mut motor.envelope.outer_diameter_m, by)),
    ("length of a motor in its link", LONG_MOTOR, |_, motor, by| times(&mut motor.envelope.length_m, by)),
    ("motor bore", ON_AXIS, |_, motor, by| times(&mut motor.envelope.hollow_bore_m, by)),
    ("motor length", ON_AXIS, |_, motor, by| times(&mut motor.envelope.length_m, by)),
];

#[test]
fn one_wrong_size_is_found_by_the_verifier_and_each_decides() {
    let catalogs = hollow_gears();
    for (name, fit, spoil) in SIZES {
        let study = tight(asked(fit), &catalogs);
        let true_front = front(&study, &catalogs, &catalogs);
        assert_eq!(faults(&study, &catalogs, &true_front), [0, 0], "{name}");
        let mut decides = false;
        for factor in [0.4, 0.7, 1.4, 2.5, 12.0] {
            let rows = front(&study, &spoiled(&catalogs, spoil, factor), &catalogs);
            let found = faults(&study, &catalogs, &rows);
            println!("{name} times {factor}: {} rows of {}, faults {found:?}", rows.len(), true_front.len());
            assert_eq!(found == [0, 0], rows == true_front, "{name} times {factor}: {found:?}");
            decides |= rows != true_front;
        }
        assert!(decides, "no front depends on the {name}");
    }
}

#[test]
fn a_dropped_row_is_found_where_fit_decides() {
    let catalogs = hollow_gears();
    let study = tight(asked(ALL_ASKED), &catalogs);
    let rows = front(&study, &catalogs, &catalogs);
    let anything = front(&tight(json!({}), &catalogs), &catalogs, &catalogs);
    assert!(rows.len() > 5 && rows != anything, "{} rows", rows.len());
    // rows of the study that asks for nothing break the wishes of the other, all but those of both fronts
    let [wrong, _] = faults(&study, &catalogs, &anything);
    assert!(wrong > 0 && wrong >= anything.iter().filter(|row| !rows.contains(row)).count() / 2, "{wrong}");
    let by_regions = Settings { regions_from: 1, boxes_to: 60.0, apart: 0.0 };
    for dropped in (0..rows.len()).step_by(2) {
        let mut rest: Vec<Row> = rows.clone();
        let (_, lost) = rest.remove(dropped);
        if rest.iter().any(|row| row.1 == lost) {
            continue;
        }
        for by in [Settings::default(), by_regions] {
            let question = question(&study.space);
            let listed: Vec<Objectives> = rest.iter().map(|row| row.1).collect();
            let looked = Judge::new(&question, &catalogs).missing(&listed, by, &AtomicBool::new(false), None);
            assert!(looked.candidates.iter().any(|c| c.objectives == lost), "{lost:?} is not found");
        }
    }
}

/// A six-axis arm that asks for room at every joint but the waist, and whose roll joint is within its link.
fn six_axes_that_fit() -> Value {
    let mut chain = six_axes(
        boxes(&[STEEL, ALUMINIUM], json!([100, 160]), json!([120, 180]), json!([4])),
        boxes(&[STEEL, ALUMINIUM], json!([70, 120]), json!([90, 130]), json!([3])),
    );
    // the upper arm is the innermost choice, so the sweep sizes the shoulder for eight of them at once
    chain[0]["fit"] = json!({"gear_to_link_max": null, "motor": "beside"});
    chain[4]["fit"] = json!({"gear_to_link_max": 1.3});
    // a rolling wrist joint that carries a tube of its own, seen along its axis
    chain[9] = json!({"type": "link", "name": "flange", "vector_m": [0.05, 0, 0],
        "choose": {"materials": [ALUMINIUM], "sections": [{"shape": "rectangular_tube", "width_mm": [90, 110],
            "height_mm": [80, 100], "wall_mm": 4}]}});
    json!({
        "name": "brute-fit", "extras": "none",
        "fit": {"gear_to_link_max": 1.05, "motor": "in_link", "drive_length_max_mm": 75},
        "chain": chain,
        "payload": {"mass_kg": 3, "cg_m": [0.02, 0.06, 0.04]},
        "poses": [{"name": "stretched", "pose_deg": [0, 0, 0, 0, 0, 0]},
            {"name": "aside", "pose_deg": [30, -40, 70, 50, -60, 20]}],
        "motion": {"tip_speed_m_s": 0.5, "ramp_time_s": 0.2},
        "drives": {"gear_series": ["CSG", "SHG"], "ratios": [100], "motor_models": ["ILM70x10", "ILM70x18", "ILM85x26",
            "ILM115x25"], "gear_mass": "housed_unit"}
    })
}

#[test]
fn the_brute_force_has_the_same_front_where_parts_must_fit() {
    let agreement = assert_same(&six_axes_that_fit());
    assert!(agreement.front > 5, "{agreement:?}");
    let designs = |study: &Value| chains(&BruteStudy::from_json(study, &Catalog::built_in())).len();
    let mut anything = six_axes_that_fit();
    anything["fit"] = Value::Null;
    let (fitting, all) = (designs(&six_axes_that_fit()), designs(&anything));
    println!("{fitting} designs fit, {all} if nothing is asked");
    assert!(fitting * 10 < all * 9, "{fitting} of {all}");
}
