//! The stiffness budget of a front's picks: by how much one more kilogram at each joint and link changes deflection and
//! lowest mode, and how far a pick is from the lightest arm that could be as good.
//!
//! For each piece there are two such changes. Both are computed by the full model with all other parts unchanged:
//!
//! - *In place*: mass and stiffness of the piece grow in proportion, as with a thicker wall, or with a gear that is
//!   scaled up together with its output bearing. The derivative is a central difference over 0.1 % of the piece's mass.
//! - *Next part*: the piece is replaced by a heavier catalog part that fits there and improves deflection or lowest
//!   mode. Of all such parts it is the one with the best change of deflection per kilogram. Drives further inboard are
//!   not sized again.
//!
//! The output bearing of a joint has a row of its own, with its part of the deflection.

use super::alternatives::alternatives;
use super::bounds::MassBounds;
use crate::arm::load::LoadCase;
use crate::arm::structure::Piece;
use crate::arm::{Arm, Element, Joint};
use crate::catalog::Catalogs;
use crate::exact::domain_reduction::DomainReduction;
use crate::mechanics::chain::Chain;
use crate::mechanics::prismatic::guide_name;
use crate::pareto::objectives::Objectives;
use crate::relax::relaxation::Relaxation;
use crate::report::budget::{BudgetRow, Gain, NextPart, PickBound, PickBudget, PieceKind};
use crate::report::front_table::FrontTable;
use crate::report::picks::{Pick, designs, picks};
use crate::space::design::{
    evaluate, full_deflection_m, full_objectives, number, number_of, objectives_with,
};
use crate::space::design_space::DesignSpace;
use crate::space::design_space::SpacePiece;
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Fraction by which mass and stiffness of a piece are raised and lowered to find the effect of one more kilogram *in
/// place*.
const MASS_STEP: f64 = 1e-3;
/// Largest mass that a *next part* may add, as a fraction of the arm's mass.
const MOST_OF_ARM: f64 = 0.25;

/// The stiffness budgets of the picks of a front. `table` is the front; `problem` has the options of the whole space or
/// of an excerpt; `whole` is the whole space.
pub fn budgets(
    problem: &ArmProblem,
    whole: &DesignSpace,
    catalogs: &Catalogs,
    table: &FrontTable,
) -> Vec<PickBudget> {
    let is_excerpt = is_excerpt(problem);
    let tabulated = (is_excerpt && MassBounds::can_tabulate(whole)).then(|| ArmProblem::new(whole, catalogs));
    let bounds = match tabulated.as_ref().or((!is_excerpt).then_some(problem)) {
        Some(all) => MassBounds::Tabulated(all, Relaxation::new(all)),
        None => {
            let is_covered = whole.beyond_bounds().is_none();
            let reach = is_covered.then(|| DomainReduction::new(whole, catalogs)).flatten();
            MassBounds::InReach { space: whole, catalogs, reach }
        }
    };
    let picks = picks(&designs(table)).into_par_iter();
    picks.filter_map(|pick| pick_budget(problem, whole, &bounds, pick)).collect()
}

fn pick_budget(
    problem: &ArmProblem,
    whole: &DesignSpace,
    bounds: &MassBounds,
    pick: Pick,
) -> Option<PickBudget> {
    let known = number_of(&pick.design.design_id)?;
    let options = problem.options_of_whole(known)?;
    let objectives = &evaluate(problem, number(problem.level_sizes(), &options))?.objectives;
    let bound = bounds.below(known, objectives).map(|b| PickBound {
        mass_kg: b.mass_lower_bound_kg,
        mixture_kg: b.mixture_kg,
        loads_oppose: b.loads_oppose,
    });
    Some(PickBudget {
        bound,
        rows: budget(problem, whole, &options, objectives)?,
        names: pick.names,
        design_id: pick.design.design_id,
        mass_kg: objectives.mass_kg,
        extras_mass_kg: problem.extras_mass_kg(&options)?,
    })
}

fn is_excerpt(problem: &ArmProblem) -> bool {
    let kept = |piece: &SpacePiece| matches!(piece, SpacePiece::Choice(choice) if choice.excerpt.is_some());
    problem.space().pieces.iter().any(kept)
}

fn budget(
    problem: &ArmProblem,
    whole: &DesignSpace,
    options: &[u32],
    objectives: &Objectives,
) -> Option<Vec<BudgetRow>> {
    let arm = problem.arm(options)?;
    let cases = problem.load_cases();
    let others = alternatives(problem, whole, options, &arm)?;
    let shares = Shares::of(&arm, &cases);
    let heaviest_kg = objectives.mass_kg * MOST_OF_ARM;
    let row = |(piece, element): (usize, &Element)| {
        let mass_kg = element.mass_kg();
        let heavier = |kg: f64| kg > mass_kg * (1.0 + 1e-6) && kg - mass_kg <= heaviest_kg;
        let others = others[piece].iter().filter(|(_, other)| heavier(other.mass_kg()));
        BudgetRow {
            piece: element.name().to_string(),
            kind: if matches!(element, Element::Link(_)) { PieceKind::Link } else { PieceKind::Joint },
            mass_kg,
            share: shares.of_element(element.name()).unwrap_or(0.0),
            in_place: Some(in_place(&arm, piece, &cases)),
            next_part: next_part(&arm, piece, others, objectives, &cases),
        }
    };
    let rows = |(piece, element): (usize, &Element)| {
        let own = (element.mass_kg() > 0.0).then(|| row((piece, element)));
        own.into_iter().chain(shares.bearing_row(element)).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<BudgetRow>> = arm.chain.par_iter().enumerate().map(rows).collect();
    Some(rows.concat())
}

/// The best of the heavier parts `others` that improve deflection or lowest mode of the arm: the part with the best
/// change of deflection per kilogram, of equal parts the first. `None` if no part improves the arm.
///
/// The parts are sorted by their change of deflection. Modes, which take most of the time of the full model, are
/// computed for one part after another until a part improves the arm.
fn next_part<'o>(
    arm: &Arm,
    piece: usize,
    others: impl Iterator<Item = &'o (String, Element)>,
    objectives: &Objectives,
    cases: &[LoadCase],
) -> Option<NextPart> {
    let with = |other: &Element| {
        let mut changed = arm.clone();
        changed.chain[piece] = other.clone();
        changed
    };
    let mm_per_kg = |other: &Element| {
        let changed = with(other);
        let tip_deflection_m = full_deflection_m(&changed, cases);
        gain(objectives, &Objectives { tip_deflection_m, mass_kg: changed.mass_kg(), ..*objectives })
            .mm_per_kg
    };
    let mut by_deflection: Vec<(f64, &(String, Element))> =
        others.map(|other| (mm_per_kg(&other.1), other)).collect();
    by_deflection.sort_by(|a, b| a.0.total_cmp(&b.0));
    by_deflection.into_iter().find_map(|(_, (name, other))| {
        let gain = gain(objectives, &full_objectives(&with(other), cases));
        gain.helps().then(|| NextPart { name: name.clone(), mass_kg: other.mass_kg(), gain })
    })
}

/// Change of deflection and lowest mode from the objectives `from` to `to`, per kilogram of additional mass.
fn gain(from: &Objectives, to: &Objectives) -> Gain {
    let kg = to.mass_kg - from.mass_kg;
    Gain {
        mm_per_kg: 1e3 * (to.tip_deflection_m - from.tip_deflection_m) / kg,
        hz_per_kg: (to.lowest_mode_hz - from.lowest_mode_hz) / kg,
    }
}

/// For each element, the fraction of the tip deflection that it causes, along the direction of the deflection, in the
/// judged case with the largest deflection.
struct Shares(Vec<(String, f64)>);

impl Shares {
    fn of(arm: &Arm, cases: &[LoadCase]) -> Self {
        let solve = |case: &LoadCase| Chain::new(&arm.structure_in(case), case.links).pose(case).statics();
        let statics = cases.iter().map(solve);
        let worst =
            statics.max_by(|a, b| a.tip_displacement_m.norm().total_cmp(&b.tip_displacement_m.norm()));
        let Some(worst) = worst else { return Self(Vec::new()) };
        let whole = worst.tip_displacement_m;
        let share = |moved: &Vector3<f64>| moved.dot(&whole) / whole.norm_squared().max(f64::MIN_POSITIVE);
        Self(worst.shares_m.iter().map(|(name, moved)| (name.clone(), share(moved))).collect())
    }

    /// The fraction of the tip deflection that an element causes; `None` if no compliant element has this name.
    fn of_element(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(n, _)| n == name).map(|(_, share)| *share)
    }

    /// The row of the budget for the bearing of a joint or the guide of a prismatic joint; `None` if it is rigid.
    fn bearing_row(&self, element: &Element) -> Option<BudgetRow> {
        let piece = match element {
            Element::Joint(joint) => format!("{}.bearing", joint.name),
            Element::Prismatic(joint) => guide_name(&joint.name),
            Element::Link(_) => return None,
        };
        let share = self.of_element(&piece)?;
        Some(BudgetRow {
            piece,
            kind: PieceKind::Bearing,
            mass_kg: 0.0,
            share,
            in_place: None,
            next_part: None,
        })
    }
}

/// Change of deflection and lowest mode per kilogram if mass and stiffness of the element with the index `piece` grow
/// in proportion. It is a central difference, with the element made lighter and heavier by [`MASS_STEP`].
fn in_place(arm: &Arm, piece: usize, cases: &[LoadCase]) -> Gain {
    let mass_kg = arm.chain[piece].mass_kg();
    let with = |step: f64| Objectives {
        mass_kg: arm.mass_kg() + step * mass_kg,
        ..objectives_with(arm, cases, |structure| grow(&mut structure.pieces[piece], &arm.chain[piece], step))
    };
    gain(&with(-MASS_STEP), &with(MASS_STEP))
}

/// Increases mass and stiffness of `piece` by the fraction `step`, and also the tilting stiffness of a joint's bearing.
/// `element` is the piece without effects: what effects add to the piece stays as it is.
fn grow(piece: &mut Piece, element: &Element, step: f64) {
    let factor = 1.0 + step;
    match piece {
        Piece::Joint(joint) => {
            joint.mass_kg += step * element.mass_kg();
            joint.law.curve = joint.law.curve.stiffened(factor);
            if let Element::Joint(Joint { bearing: Some(bearing), .. }) = element {
                joint.tilt_rad_per_nm += bearing.tilt_rad_per_nm() * (1.0 / factor - 1.0);
            }
        }
        Piece::Prismatic(joint) => {
            joint.mass_kg += step * joint.mass_kg;
            joint.fixed_mass_kg += step * joint.fixed_mass_kg;
            joint.m_per_n /= factor;
            joint.guide_rad_per_nm /= factor;
        }
        Piece::Link(link) => match &mut link.beam {
            Some(beam) => {
                beam.material.youngs_modulus_pa *= factor;
                beam.material.shear_modulus_pa *= factor;
                beam.material.density_kg_m3 *= factor;
            }
            None => link.point_mass_kg += step * element.mass_kg(),
        },
    }
}
