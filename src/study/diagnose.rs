//! Why no design meets the constraints, and the smallest relaxation that would help.

use super::definition::Study;
use super::outcome::StudyOutcome;
use crate::catalog::Catalogs;
use crate::pareto::objectives::Objectives;
use crate::search::finish::{FinishRows, finish_one_by_one};
use crate::search::sweep::Sweep;
use crate::sizing::rpm_from_rad_s;
use crate::space::constraint::Constraints;
use crate::space::design_space::SpacePiece;
use crate::space::levels::{DesignRow, Keep, OutwardIn};
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::SizedJoint;
use std::sync::atomic::AtomicBool;

/// The reason in words: every limit that alone prevents a design, with the value that would suffice, or the
/// joint for which no drive is strong enough.
pub fn why_infeasible(study: &Study, catalogs: &Catalogs, outcome: &StudyOutcome) -> String {
    let head = format!("no design of {} meets the study \"{}\"", outcome.sweep.designs_total, study.name);
    let mut reasons: Vec<String> = limits(&study.space.constraints)
        .into_iter()
        .filter_map(|l| l.relaxed(study, catalogs, outcome))
        .collect();
    if reasons.is_empty() {
        reasons.push(first_obstacle(study, catalogs));
    }
    format!("{head}\n  {}", reasons.join("\n  "))
}

/// What a limit is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    Deflection,
    Mode,
    Mass,
    Stress,
    Slenderness,
    Cost,
}

/// One limit of a study, in the unit of its key.
struct Limit {
    quantity: Quantity,
    name: &'static str,
    key: &'static str,
    unit: &'static str,
    asked: f64,
    /// Factor from the limited quantity to the number in the key: the servo key is a bandwidth, not a mode.
    key_per_unit: f64,
}

fn limits(constraints: &Constraints) -> Vec<Limit> {
    use Quantity::{Cost, Deflection, Mass, Mode, Slenderness, Stress};
    let servo_binds =
        constraints.servo.filter(|_| constraints.lowest_mode_min_hz != Some(constraints.required_mode_hz()));
    let (mode_key, key_per_unit) =
        servo_binds.map_or(("lowest_mode_min_hz", 1.0), |servo| ("servo_bandwidth_hz", 1.0 / servo.ratio));
    let mode = (constraints.required_mode_hz() > 0.0).then(|| constraints.required_mode_hz());
    let rows = [
        (
            Deflection,
            "tip deflection",
            "tip_deflection_max_mm",
            "mm",
            constraints.tip_deflection_max_m.map(|m| m * 1e3),
            1.0,
        ),
        (Mode, "lowest mode", mode_key, "Hz", mode, key_per_unit),
        (Mass, "mass", "mass_max_kg", "kg", constraints.mass_max_kg, 1.0),
        (
            Stress,
            "strength over stress",
            "stress_safety_factor_min",
            "",
            constraints.stress_safety_factor_min,
            1.0,
        ),
        (Slenderness, "wall slenderness", "wall_slenderness_max", "", constraints.wall_slenderness_max, 1.0),
        (Cost, "material cost", "material_cost_max_eur", "EUR", constraints.material_cost_max_eur, 1.0),
    ];
    rows.into_iter()
        .filter_map(|(quantity, name, key, unit, asked, key_per_unit)| {
            Some(Limit { quantity, name, key, unit, asked: asked?, key_per_unit })
        })
        .collect()
}

impl Limit {
    /// Whether the limit is a minimum.
    fn is_least(&self) -> bool {
        matches!(self.quantity, Quantity::Mode | Quantity::Stress)
    }

    /// The best value among designs that meet all other limits, in words; `None` if relaxing this limit alone
    /// does not help.
    fn relaxed(&self, study: &Study, catalogs: &Catalogs, outcome: &StudyOutcome) -> Option<String> {
        let reached = match self.quantity {
            Quantity::Deflection => outcome.sweep.near_misses[0]? * 1e3,
            Quantity::Mode => -outcome.sweep.near_misses[2]?,
            quantity => best_without(study, catalogs, quantity)?,
        };
        let enough = toward(reached * self.key_per_unit, !self.is_least());
        Some(format!(
            "{}: {} {unit} asked, {} {unit} reached by designs that meet all else (short by {} {unit}); relaxing \
             \"{}\" to {enough} is enough",
            self.name,
            short(self.asked),
            short(reached),
            short((reached - self.asked).abs()),
            self.key,
            unit = self.unit,
        )
        .replace("  ", " ")
        .replace(" )", ")"))
    }
}

/// Four significant digits.
fn short(x: f64) -> String {
    crate::report::number::significant(x, 4)
}

/// Rounds to five significant digits, up or down, so that a sufficient value stays sufficient.
fn toward(x: f64, up: bool) -> f64 {
    let scale = 10f64.powi(4 - libm::log10(x.abs().max(f64::MIN_POSITIVE)).floor() as i32);
    let scaled = x * scale;
    (if up { (scaled * (1.0 + 1e-12)).ceil() } else { (scaled * (1.0 - 1e-12)).floor() }) / scale
}

/// The best a quantity can be among the designs that meet every other limit.
fn best_without(study: &Study, catalogs: &Catalogs, quantity: Quantity) -> Option<f64> {
    let mut space = study.space.clone();
    let limits = &mut space.constraints;
    match quantity {
        Quantity::Mass => limits.mass_max_kg = None,
        Quantity::Stress => limits.stress_safety_factor_min = None,
        Quantity::Slenderness => limits.wall_slenderness_max = None,
        _ => limits.material_cost_max_eur = None,
    }
    let problem = ArmProblem::new(&space, catalogs);
    let relaxed = Relaxed { problem: &problem, quantity };
    let never = AtomicBool::new(false);
    let outcome = Sweep::new(&relaxed, Constraints::default(), &never).run();
    let best = outcome.front.iter().map(|c| c.objectives.mass_kg).reduce(f64::min)?;
    Some(if quantity == Quantity::Stress { 1.0 / best } else { best })
}

/// A problem whose only objective is the limited quantity, to be minimized.
struct Relaxed<'p, 'c> {
    problem: &'p ArmProblem<'c>,
    quantity: Quantity,
}

impl Relaxed<'_, '_> {
    fn value(&self, complete: &Partial) -> Option<f64> {
        match self.quantity {
            Quantity::Mass => Some(self.problem.mass_kg(complete)),
            Quantity::Stress => self.problem.stress_safety_factor(complete).map(|factor| 1.0 / factor),
            Quantity::Cost => self.problem.material_cost_eur(complete),
            _ => Some(self.problem.wall_slenderness(complete)),
        }
    }
}

impl OutwardIn for Relaxed<'_, '_> {
    type Partial = Partial;

    fn level_sizes(&self) -> &[u32] {
        self.problem.level_sizes()
    }

    fn root(&self) -> Option<Partial> {
        self.problem.root()
    }

    fn extend(&self, level: usize, option: u32, from: &Partial, to: &mut Partial) -> bool {
        self.problem.extend(level, option, from, to)
    }

    fn objectives(&self, complete: &Partial) -> Option<Objectives> {
        let limits = &self.problem.space().constraints;
        if limits.tip_deflection_max_m.is_some() || limits.required_mode_hz() > 0.0 {
            let o = self.problem.objectives(complete)?;
            if limits.tip_deflection_max_m.is_some_and(|max| o.tip_deflection_m > max)
                || o.lowest_mode_hz < limits.required_mode_hz()
            {
                return None;
            }
        }
        // the quantity in every objective: the front is its least value
        let value = self.value(complete)?;
        Some(Objectives { tip_deflection_m: value, mass_kg: value, lowest_mode_hz: 1.0 / value })
    }

    fn groups(&self) -> usize {
        0
    }

    fn group(&self, _: &Partial) -> Option<usize> {
        None
    }
}

impl FinishRows for Relaxed<'_, '_> {
    type Compiled = ();
    type Scratch = Partial;

    fn compile(&self) {}

    fn scratch(&self) -> Partial {
        Partial::default()
    }

    fn finish<K: Keep>(&self, (): &(), rows: &[DesignRow<Partial>], spare: &mut Partial, keep: &mut K) {
        finish_one_by_one(self, rows, spare, keep);
    }
}

/// Takes the lightest option at every level, ignoring all limits but those of the drives, until no drive
/// holds at a joint.
fn first_obstacle(study: &Study, catalogs: &Catalogs) -> String {
    let keys: Vec<String> =
        limits(&study.space.constraints).iter().map(|l| format!("\"{}\"", l.key)).collect();
    let together = format!(
        "no limit alone stands in the way: at least two of {} must be relaxed together",
        if keys.is_empty() { "the requirements".to_string() } else { keys.join(", ") }
    );
    let space = crate::space::design_space::DesignSpace {
        constraints: Constraints::default(),
        ..study.space.clone()
    };
    let problem = ArmProblem::new(&space, catalogs);
    let mut last: Option<Partial> = None;
    let Err(slot) = problem.walk(&lightest_options(&problem), |_, partial| last = Some(partial.clone()))
    else {
        return together;
    };
    let Some(sized) = problem.sized_joint(problem.piece_of_slot(slot)) else { return together };
    let table = &sized.table;
    if table.is_empty() && !table.motion().fit.is_asked() {
        return too_fast(sized);
    }
    let demand = problem.demand_at(&last.unwrap_or_default(), slot);
    let also = if keys.is_empty() {
        String::new()
    } else {
        format!("; {} may stand in the way too", keys.join(", "))
    };
    match table.smallest_shortfall(&demand) {
        // a wider link would be heavier
        Some(shortfall) if shortfall.check.kind.is_fit() => {
            format!("with the lightest links, {shortfall}{also}")
        }
        Some(shortfall) => {
            format!("even with the lightest links, {shortfall}{}{also}", missing_words(table))
        }
        None if table.is_empty() => too_fast(sized),
        None => together,
    }
}

/// The reason if no drive turns a joint fast enough, or all lack a rating.
fn too_fast(sized: &SizedJoint) -> String {
    let table = &sized.table;
    let needed_rpm = rpm_from_rad_s(table.motion().speed_rad_s);
    let fastest = table
        .gears()
        .iter()
        .flat_map(|gear| table.motors().iter().map(move |motor| (gear, motor)))
        .filter(|(gear, motor)| gear.goes_with(motor))
        .filter_map(|(gear, motor)| {
            let no_limit = gear.kind.has_no_ratings_of_its_own().then_some(f64::INFINITY);
            let input_rpm =
                gear.max_input_speed_rpm.or(no_limit)?.min(motor.max_speed_rpm.or(motor.rated_speed_rpm)?);
            Some((input_rpm / gear.ratio, gear, motor))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match fastest {
        Some((rpm, gear, motor)) if rpm < needed_rpm => {
            let rad_s = |rpm: f64| table.motion().speed_rad_s * rpm / needed_rpm;
            format!(
                "joint {}: {} rad/s needed, {} rad/s allowed by the fastest drive, {} (short by {} rad/s); slow \
                 the joint (tip_speed_m_s, min_lever_m, max_speed_rad_s) or widen \"drives\"{}",
                table.joint(),
                short(rad_s(needed_rpm)),
                short(rad_s(rpm)),
                table.pair(gear, motor).name(),
                short(rad_s(needed_rpm - rpm)),
                missing_words(table),
            )
        }
        _ => format!(
            "joint {joint}: every drive that \"drives\" offers is too fast for its average input speed{fit} or lacks a rating \
             that a check needs; `armwright size STUDY --explain {joint}` lists them{missing}",
            joint = table.joint(),
            fit = if table.motion().fit.is_asked() { ", does not fit" } else { "" },
            missing = missing_words(table),
        ),
    }
}

/// The figures that parts lack, as the end of a sentence.
fn missing_words(table: &crate::sizing::select::DriveTable) -> String {
    let missing = table.missing_beside_the_nearest();
    missing.map(|missing| format!("; not checked: {missing}")).unwrap_or_default()
}

/// The lightest option a level that keeps within the wall-slenderness limit.
fn lightest_options(problem: &ArmProblem) -> Vec<u32> {
    let space = problem.space();
    let slenderest = space.constraints.wall_slenderness_max.unwrap_or(f64::INFINITY);
    let lightest = |options: &[crate::space::design_space::LinkOption]| {
        let holding = options.iter().enumerate().filter(|(_, o)| o.wall_slenderness() <= slenderest);
        holding
            .min_by(|(_, a), (_, b)| a.mass_kg_per_m().total_cmp(&b.mass_kg_per_m()))
            .map_or(0, |(k, _)| k as u32)
    };
    space
        .pieces
        .iter()
        .enumerate()
        .rev()
        .filter_map(|(i, piece)| match piece {
            SpacePiece::Choice(choice) => Some(lightest(&choice.options)),
            SpacePiece::Joint(_) => problem.sized_joint(i).filter(|s| s.is_level()).map(|_| 0),
            SpacePiece::Link(_) => None,
        })
        .collect()
}

/// The pieces without any option, in words; empty if every piece has one.
pub fn empty_pieces(problem: &ArmProblem) -> Vec<String> {
    let space = problem.space();
    space
        .pieces
        .iter()
        .enumerate()
        .filter_map(|(i, piece)| match piece {
            SpacePiece::Choice(choice) if choice.options.is_empty() => Some(format!(
                "link {}: no section has a wall under half its outer size (all sizes are in mm), or no profile is sold in these \
                 materials; \
                 change its \"sections\" or \"materials\"",
                choice.name
            )),
            SpacePiece::Joint(joint) => {
                let table = &problem.sized_joint(i)?.table;
                (table.gears().is_empty() || table.motors().is_empty()).then(|| {
                    format!(
                        "joint {}: \"drives\" leaves {} gears and {} motors of the catalogs; widen it",
                        joint.name,
                        table.gears().len(),
                        table.motors().len()
                    )
                })
            }
            _ => None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_enough_is_rounded_to_stay_enough() {
        assert_eq!(toward(2.917_24, true), 2.9173);
        assert_eq!(toward(2.917_24, false), 2.9172);
        assert!(toward(12.0, true) >= 12.0 && toward(12.0, false) <= 12.0);
        assert!(toward(1e-7 / 3.0, true) >= 1e-7 / 3.0);
    }
}
