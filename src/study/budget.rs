//! The stiffness budget of a front's picks: what one more kilogram buys at each joint and link, and how far a
//! pick is from the lightest arm that could do as well.
//!
//! Two answers a piece, both by the full model with all other parts kept. *In place*: the piece's mass and
//! stiffness grow in proportion (a thicker wall, a gear scaled up), a central difference over 0.1 % of its mass.
//! *Next part*: of the heavier catalog parts that may stand there, the one with the best change of deflection per
//! kilogram; a difference between two parts one can buy. Drives further inboard are not sized again.

use crate::arm::{Arm, Curve, Element, Joint, LoadCase, Piece, Structure, windup_of};
use crate::mechanics::Chain;
use crate::report::budget::{BudgetRow, Gain, NextPart, PickBound, PickBudget};
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::report::picks::{Pick, designs, picks};
use crate::search::design::{evaluate, full_objectives, number, number_of, objectives_with};
use crate::search::relax::Relaxation;
use crate::search::space::{LinkOption, SpacePiece};
use crate::search::{ArmProblem, Objectives, OutwardIn};
use crate::sizing::Drive;
use rayon::prelude::*;

/// Relative step of the derivative in place.
const STEP: f64 = 1e-3;
/// Parts heavier than the one in place by more than this part of the arm are not looked at.
const MOST_OF_ARM: f64 = 0.25;

/// Budgets of the picks of a front. A bound is given only if the problem has all options of the study.
pub fn budgets(problem: &ArmProblem, table: &FrontTable) -> Vec<PickBudget> {
    let relaxation = (!is_excerpt(problem)).then(|| Relaxation::new(problem));
    let picks = picks(&designs(table)).into_par_iter();
    picks.filter_map(|pick| pick_budget(problem, relaxation.as_ref(), pick)).collect()
}

fn pick_budget(problem: &ArmProblem, relaxation: Option<&Relaxation>, pick: Pick) -> Option<PickBudget> {
    let options = problem.options_of_whole(number_of(&pick.design.design_id)?)?;
    let objectives = &evaluate(problem, number(problem.level_sizes(), &options))?.objectives;
    let bound = relaxation.and_then(|r| r.mass_lower_bound(&options, objectives));
    let bound = bound.map(|b| PickBound {
        mass_kg: b.mass_lower_bound_kg,
        mixture_kg: b.mixture_kg,
        loads_oppose: b.loads_oppose,
    });
    Some(PickBudget {
        bound,
        rows: budget(problem, &options, objectives)?,
        names: pick.names,
        design_id: pick.design.design_id,
        mass_kg: objectives.mass_kg,
    })
}

fn is_excerpt(problem: &ArmProblem) -> bool {
    let kept = |piece: &SpacePiece| matches!(piece, SpacePiece::Choice(choice) if choice.excerpt.is_some());
    problem.space().pieces.iter().any(kept)
}

fn budget(problem: &ArmProblem, options: &[u32], objectives: &Objectives) -> Option<Vec<BudgetRow>> {
    let arm = problem.arm(options)?;
    let cases = problem.load_cases();
    let others = alternatives(problem, options, &arm)?;
    let shares = shares(&arm, &cases);
    let heaviest_kg = objectives.mass_kg * MOST_OF_ARM;
    let pieces: Vec<(usize, &Element)> =
        arm.chain.iter().enumerate().filter(|(_, e)| e.mass_kg() > 0.0).collect();
    let row = |&(piece, element): &(usize, &Element)| {
        let mass_kg = element.mass_kg();
        let with = |other: &Element| {
            let mut changed = arm.clone();
            changed.chain[piece] = other.clone();
            gain(objectives, &full_objectives(&changed, &cases))
        };
        let heavier = |kg: f64| kg > mass_kg * (1.0 + 1e-6) && kg - mass_kg <= heaviest_kg;
        let next_part = others[piece]
            .iter()
            .filter(|(_, other)| heavier(other.mass_kg()))
            .map(|(name, other)| NextPart { name: name.clone(), mass_kg: other.mass_kg(), gain: with(other) })
            .min_by(|a, b| a.gain.mm_per_kg.total_cmp(&b.gain.mm_per_kg));
        BudgetRow {
            piece: element.name().to_string(),
            is_joint: matches!(element, Element::Joint(_)),
            mass_kg,
            share: shares[piece],
            in_place: in_place(&arm, piece, &cases),
            next_part,
        }
    };
    Some(pieces.par_iter().map(row).collect())
}

/// What else may stand in each place, by name.
fn alternatives(problem: &ArmProblem, options: &[u32], arm: &Arm) -> Option<Vec<Vec<(String, Element)>>> {
    let mut others: Vec<Vec<(String, Element)>> = vec![Vec::new(); arm.chain.len()];
    let complete = problem.walk(options, |slot, outboard| {
        let piece = problem.piece_of_slot(slot);
        if let (Some(sized), Element::Joint(joint)) = (problem.sized_joint(piece), &arm.chain[piece]) {
            let demand = problem.demand_at(outboard, slot);
            let holding =
                sized.table.all_fits(&demand).map(|i| (sized.table.drive(i), sized.table.mass_kg(i)));
            others[piece] = drives(joint, holding);
        }
    });
    complete.ok()?;
    for (piece, what) in problem.space().pieces.iter().enumerate() {
        if let SpacePiece::Choice(choice) = what {
            let links = stiffest_by_mass(&choice.options);
            others[piece] =
                links.map(|option| (section_words(option), Element::Link(choice.link(option)))).collect();
        }
    }
    Some(others)
}

/// The drives that hold at a joint, lightest first, each with a gear that no lighter one matches in stiffness.
fn drives<'c>(joint: &Joint, drives: impl Iterator<Item = (Drive<'c>, f64)>) -> Vec<(String, Element)> {
    let mut out: Vec<(String, Element)> = Vec::new();
    let mut kept: Vec<[f64; 3]> = Vec::new();
    for (drive, mass_kg) in drives {
        let Some(windup) = windup_of(drive.gear) else { continue };
        let stiffness = [windup.k1_nm_per_rad, windup.k2_nm_per_rad, windup.k3_nm_per_rad];
        if kept.iter().any(|other| (0..3).all(|i| other[i] >= stiffness[i])) {
            continue;
        }
        kept.push(stiffness);
        let curve = Curve::Windup(windup);
        out.push((drive.gear.id.clone(), Element::Joint(Joint { curve, mass_kg, ..joint.clone() })));
    }
    out
}

/// Options that no lighter one matches in bending stiffness.
fn stiffest_by_mass(options: &[LinkOption]) -> impl Iterator<Item = &LinkOption> {
    let stiffness = |o: &LinkOption| {
        let section = o.section.properties(o.material.poisson);
        o.material.youngs_modulus_pa * section.second_moment_y_m4.min(section.second_moment_z_m4)
    };
    let mut by_mass: Vec<&LinkOption> = options.iter().collect();
    by_mass.sort_by(|a, b| {
        a.mass_kg_per_m().total_cmp(&b.mass_kg_per_m()).then(stiffness(b).total_cmp(&stiffness(a)))
    });
    let mut best = 0.0;
    by_mass.into_iter().filter(move |o| {
        let better = stiffness(o) > best;
        best = stiffness(o).max(best);
        better
    })
}

fn section_words(option: &LinkOption) -> String {
    let (width, height) = option.section.outer_m();
    let sizes = [width, height, option.section.wall_m()].map(|m| significant(m * 1e3, 4));
    let sizes =
        sizes.map(|s| if s.contains('.') { s.trim_end_matches('0').trim_end_matches('.').into() } else { s });
    format!("{} mm {}", sizes.join(" x "), option.material_name)
}

/// Change from one design to another per kilogram.
fn gain(from: &Objectives, to: &Objectives) -> Gain {
    let kg = to.mass_kg - from.mass_kg;
    Gain {
        mm_per_kg: 1e3 * (to.tip_deflection_m - from.tip_deflection_m) / kg,
        hz_per_kg: (to.lowest_mode_hz - from.lowest_mode_hz) / kg,
    }
}

/// Each piece's part of the tip's deflection in the worst case, along it; a bearing's tilt is its joint's.
fn shares(arm: &Arm, cases: &[LoadCase]) -> Vec<f64> {
    let solve = |case: &LoadCase| Chain::new(&arm.structure_in(case), case.links).pose(case).statics();
    let statics = cases.iter().map(solve);
    let worst = statics.max_by(|a, b| a.tip_displacement_m.norm().total_cmp(&b.tip_displacement_m.norm()));
    let Some(worst) = worst else { return vec![0.0; arm.chain.len()] };
    let whole = worst.tip_displacement_m;
    let of = |name: &str| {
        let own = worst.shares_m.iter().filter(|(n, _)| n.strip_suffix(".bearing_tilt").unwrap_or(n) == name);
        own.map(|(_, moved)| moved.dot(&whole)).sum::<f64>() / whole.norm_squared().max(f64::MIN_POSITIVE)
    };
    arm.chain.iter().map(|element| of(element.name())).collect()
}

/// Central difference with a piece's mass and stiffness in proportion.
fn in_place(arm: &Arm, piece: usize, cases: &[LoadCase]) -> Gain {
    let mass_kg = arm.chain[piece].mass_kg();
    let with = |step: f64| Objectives {
        mass_kg: arm.mass_kg() + step * mass_kg,
        ..objectives_with(arm, cases, |structure| grow(structure, piece, step, mass_kg))
    };
    gain(&with(-STEP), &with(STEP))
}

/// Lets mass and stiffness of a piece grow by a part of themselves; what effects add to it stays.
fn grow(structure: &mut Structure, piece: usize, step: f64, mass_kg: f64) {
    let factor = 1.0 + step;
    match &mut structure.pieces[piece] {
        Piece::Joint(joint) => {
            joint.mass_kg += step * mass_kg;
            joint.law.curve = joint.law.curve.stiffened(factor);
        }
        Piece::Link(link) => match &mut link.beam {
            Some(beam) => {
                beam.material.youngs_modulus_pa *= factor;
                beam.material.shear_modulus_pa *= factor;
                beam.material.density_kg_m3 *= factor;
            }
            None => link.point_mass_kg += step * mass_kg,
        },
    }
}
