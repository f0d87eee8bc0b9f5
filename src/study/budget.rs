//! The stiffness budget of a front's picks: what one more kilogram buys at each joint and link, and how far a
//! pick is from the lightest arm that could do as well.
//!
//! Two answers a piece, both by the full model with all other parts kept. *In place*: the piece's mass and
//! stiffness grow in proportion (a thicker wall, a gear scaled up), a central difference over 0.1 % of its mass.
//! *Next part*: of the heavier catalog parts that may stand there, the one with the best change of deflection per
//! kilogram; a difference between two parts one can buy. Drives further inboard are not sized again.

use super::Front;
use crate::arm::{Arm, Curve, Element, LinkBody, LoadCase, Windup, windup_of};
use crate::report::front_table::FrontTable;
use crate::report::number::{fixed, shortest, significant};
use crate::report::picks::{designs, picks};
use crate::report::table::{Column, Table, csv_line};
use crate::search::design::{full_objectives, number_of, options};
use crate::search::relax::{MassBound, mass_lower_bound};
use crate::search::space::{LinkOption, SpacePiece};
use crate::search::{ArmProblem, Objectives, OutwardIn};
use serde_json::{Value, json};

/// Relative step of the derivative in place.
const STEP: f64 = 1e-3;
/// Parts heavier than the one in place by more than this part of the arm are not looked at.
const MOST_OF_ARM: f64 = 0.25;

/// What one more kilogram buys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Change of the tip's deflection \[mm/kg\]; negative is better.
    pub mm_per_kg: f64,
    /// Change of the lowest mode \[Hz/kg\].
    pub hz_per_kg: f64,
}

/// One piece of an arm and what a kilogram buys there.
#[derive(Debug, Clone, PartialEq)]
pub struct BudgetRow {
    /// Joint or link.
    pub piece: String,
    /// Its mass \[kg\].
    pub mass_kg: f64,
    /// Mass and stiffness in proportion; none for a piece without mass.
    pub in_place: Option<Gain>,
    /// The best heavier part: its name, mass \[kg\] and gain.
    pub next_part: Option<(String, f64, Gain)>,
}

/// A pick with its bound and its budget.
#[derive(Debug, Clone, PartialEq)]
pub struct PickBudget {
    /// What it was picked for.
    pub names: Vec<&'static str>,
    /// Name of the design.
    pub design_id: String,
    /// Its objectives.
    pub objectives: Objectives,
    /// What is known of lighter designs as good as it.
    pub bound: MassBound,
    /// Pieces, base to tip.
    pub rows: Vec<BudgetRow>,
}

impl PickBudget {
    /// The keys of `run.json`.
    pub fn to_json(&self) -> Value {
        json!({
            "names": self.names,
            "design_id": self.design_id,
            "mass_kg": self.objectives.mass_kg,
            "mass_lower_bound_kg": self.bound.mass_lower_bound_kg,
            "loads_oppose": self.bound.loads_oppose,
        })
    }
}

/// Budgets of the picks of a front.
pub fn budgets(problem: &ArmProblem, front: &Front, table: &FrontTable) -> Vec<PickBudget> {
    let picked = picks(&designs(table));
    let judged = |id: &str| front.iter().find(|d| number_of(id) == Some(d.design.number));
    picked
        .into_iter()
        .filter_map(|pick| {
            let design = &judged(&pick.design.design_id)?.design;
            let options = options(problem.level_sizes(), design.number)?;
            Some(PickBudget {
                bound: mass_lower_bound(problem, &options, &design.objectives)?,
                rows: budget(problem, &options, &design.objectives)?,
                names: pick.names,
                design_id: pick.design.design_id,
                objectives: design.objectives,
            })
        })
        .collect()
}

fn budget(problem: &ArmProblem, options: &[u32], objectives: &Objectives) -> Option<Vec<BudgetRow>> {
    let arm = problem.arm(options)?;
    let cases = problem.load_cases();
    let mut alternatives: Vec<Vec<(String, Element)>> = vec![Vec::new(); arm.chain.len()];
    let complete = problem.walk(options, |slot, outboard| {
        let piece = problem.piece_of_slot(slot);
        if let Some(sized) = problem.sized_joint(piece) {
            let demand = problem.demand_at(outboard, slot);
            alternatives[piece] = drives(
                &arm.chain[piece],
                sized.table.all_fits(&demand).map(|i| (sized.table.drive(i), sized.table.mass_kg(i))),
            );
        }
    });
    complete.ok()?;
    for (piece, what) in problem.space().pieces.iter().enumerate() {
        if let SpacePiece::Choice(choice) = what {
            let links = stiffest_by_mass(&choice.options);
            alternatives[piece] =
                links.map(|option| (section_words(option), Element::Link(choice.link(option)))).collect();
        }
    }
    let heaviest_kg = objectives.mass_kg * MOST_OF_ARM;
    let rows = arm.chain.iter().zip(&alternatives).enumerate().filter_map(|(piece, (element, others))| {
        let mass_kg = element.mass_kg();
        if mass_kg <= 0.0 {
            return None;
        }
        let with = |element: Element| {
            let mut changed = arm.clone();
            changed.chain[piece] = element;
            full_objectives(&changed, &cases)
        };
        let next = others
            .iter()
            .map(|(name, other)| (name, other, other.mass_kg()))
            .filter(|(_, _, kg)| *kg > mass_kg * (1.0 + 1e-6) && kg - mass_kg <= heaviest_kg)
            .map(|(name, other, kg)| (name.clone(), kg, gain(objectives, &with(other.clone()))))
            .min_by(|a, b| a.2.mm_per_kg.total_cmp(&b.2.mm_per_kg));
        Some(BudgetRow {
            piece: element.name().to_string(),
            mass_kg,
            in_place: in_place(&arm, piece, &cases),
            next_part: next,
        })
    });
    Some(rows.collect())
}

/// The drives that hold at a joint, one a gear (the lightest), as pieces of the arm.
fn drives<'c>(
    joint: &Element,
    drives: impl Iterator<Item = (crate::sizing::Drive<'c>, f64)>,
) -> Vec<(String, Element)> {
    let Element::Joint(joint) = joint else { return Vec::new() };
    let mut out: Vec<(String, Element)> = Vec::new();
    for (drive, mass_kg) in drives {
        let name = &drive.gear.id;
        if out.iter().any(|(n, _)| n == name) {
            continue;
        }
        let curve = windup_of(drive.gear).map_or(Curve::Rigid, Curve::Windup);
        out.push((name.clone(), Element::Joint(crate::arm::Joint { curve, mass_kg, ..joint.clone() })));
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

/// Central difference with a piece's mass and stiffness in proportion.
fn in_place(arm: &Arm, piece: usize, cases: &[LoadCase]) -> Option<Gain> {
    let with = |factor: f64| {
        let mut changed = arm.clone();
        scale(&mut changed.chain[piece], factor);
        full_objectives(&changed, cases)
    };
    let gain = gain(&with(1.0 - STEP), &with(1.0 + STEP));
    (gain.mm_per_kg.is_finite() && gain.hz_per_kg.is_finite()).then_some(gain)
}

fn scale(element: &mut Element, factor: f64) {
    match element {
        Element::Joint(joint) => {
            joint.mass_kg *= factor;
            joint.curve = match joint.curve {
                Curve::Rigid => Curve::Rigid,
                Curve::Linear(stiffness) => Curve::Linear(stiffness * factor),
                Curve::Windup(w) => Curve::Windup(Windup {
                    k1_nm_per_rad: w.k1_nm_per_rad * factor,
                    k2_nm_per_rad: w.k2_nm_per_rad * factor,
                    k3_nm_per_rad: w.k3_nm_per_rad * factor,
                    ..w
                }),
            };
        }
        Element::Link(link) => match &mut link.body {
            LinkBody::Tube { material, .. } => {
                material.youngs_modulus_pa *= factor;
                material.shear_modulus_pa *= factor;
                material.density_kg_m3 *= factor;
            }
            LinkBody::Offset { mass_kg } => *mass_kg *= factor,
        },
    }
}

/// `budget.csv`.
pub fn budget_csv(budgets: &[PickBudget]) -> String {
    let header = [
        "pick",
        "design_id",
        "piece",
        "mass_kg",
        "in_place_mm_per_kg",
        "in_place_hz_per_kg",
        "next_part",
        "next_mass_kg",
        "next_mm_per_kg",
        "next_hz_per_kg",
    ];
    let mut out = csv_line(&header.map(String::from));
    for pick in budgets {
        for row in &pick.rows {
            let gain = |g: Option<Gain>| {
                [g.map(|g| g.mm_per_kg), g.map(|g| g.hz_per_kg)].map(|x| x.map_or(String::new(), shortest))
            };
            let [mm, hz] = gain(row.in_place);
            let (name, kg, next) = match &row.next_part {
                Some((name, kg, next)) => (name.clone(), shortest(*kg), Some(*next)),
                None => Default::default(),
            };
            let [next_mm, next_hz] = gain(next);
            out.push_str(&csv_line(&[
                pick.names.join(", "),
                pick.design_id.clone(),
                row.piece.clone(),
                shortest(row.mass_kg),
                mm,
                hz,
                name,
                kg,
                next_mm,
                next_hz,
            ]));
        }
    }
    out
}

/// The block for a terminal: how far each pick is from its bound, and the budget of the last pick (the knee, where
/// there is one).
pub fn budget_text(budgets: &[PickBudget]) -> String {
    let Some(shown) = budgets.iter().find(|b| b.names.contains(&"knee")).or(budgets.first()) else {
        return String::new();
    };
    let mut table = Table::new(vec![
        Column::left("piece"),
        Column::unit("mass", "kg"),
        Column::unit("deflection", "mm/kg"),
        Column::unit("mode", "Hz/kg"),
        Column::left("next part"),
        Column::unit("deflection", "mm/kg"),
    ]);
    for row in &shown.rows {
        let (mm, hz) =
            row.in_place.map_or(Default::default(), |g| (fixed(g.mm_per_kg, 4), fixed(g.hz_per_kg, 3)));
        let (name, next) =
            row.next_part.as_ref().map_or(Default::default(), |(n, _, g)| (n.clone(), fixed(g.mm_per_kg, 4)));
        table.row([row.piece.clone(), significant(row.mass_kg, 4), mm, hz, name, next]);
    }
    let mut out = format!("What one more kilogram buys ({}, {}):\n", shown.names.join(", "), shown.design_id);
    out.push_str(&table.to_text());
    for pick in budgets {
        let (bound, mass) = (pick.bound.mass_lower_bound_kg, pick.objectives.mass_kg);
        out.push_str(&format!(
            "{}: {} kg; no design as stiff and as fast is below {} kg{}\n",
            pick.names.join(", "),
            significant(mass, 5),
            significant(bound, 5),
            if pick.bound.loads_oppose { " (loads oppose each other: the bound is weaker)" } else { "" }
        ));
    }
    out
}
