//! Estimates the cost of evaluating every design of a study and the cost of an exact search.
//!
//! Evaluating every design costs a known time for each design, piece and case. It costs less where drives or stresses
//! exclude a design early. No formula tells how much an exact search can discard. Both searches are therefore tried on
//! two thinned spaces, which have some of the sections and gears of the study. The trials give the fraction of feasible
//! designs, and the exponent with which the number of boxes grows with the number of designs. Only counts are used and
//! no clock, so the same study gets the same search on every machine.

use crate::catalog::Catalogs;
use crate::exact::run::Exact;
use crate::report::number::significant;
use crate::search::sweep::Sweep;
use crate::sizing::select::DriveFilter;
use crate::space::design_space::{DesignSpace, DriveChoice, SpacePiece};
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use std::sync::atomic::AtomicBool;

/// Processor time of an exhaustive search for each design, piece and case \[s\]. `benches/growth.py` measures 12e-9
/// to 50e-9.
const VISIT_S: f64 = 25e-9;
/// Time for a design that is excluded early, as a fraction of the time for a feasible design.
const COST_OF_EXCLUDED: f64 = 0.1;
/// Processor time of an exact search for each box, piece and case \[s\], measured with the built-in studies.
const BOX_S: f64 = 2.5e-6;
/// Time of an exhaustive search below which it runs without an estimate of the exact search \[s\].
const QUICK_S: f64 = 10.0;
/// Time of an exhaustive search above which it is ruled out without an estimate of the exact search \[s\].
const HOPELESS_S: f64 = 1e6;
/// Largest number of designs of each of the two thinned spaces.
const THINNED_DESIGNS: [f64; 2] = [1e4, 1e5];
/// Factor by which an exact search must be cheaper to be chosen. An exhaustive search relies on no bounds, and it
/// counts the designs that each limit excludes.
const LEAST_SAVING: f64 = 2.0;

/// Estimated processor times of both searches on one core \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SearchCost {
    /// Time of evaluating every design \[s\].
    pub(crate) exhaustive_core_s: f64,
    /// Time of an exact search \[s\]; `None` if it was not estimated, because an exhaustive search is quick or ruled
    /// out.
    pub(crate) exact_core_s: Option<f64>,
}

impl SearchCost {
    /// Estimates the times of both searches for a study with `designs` designs.
    pub(crate) fn of(space: &DesignSpace, catalogs: &Catalogs, designs: f64) -> Self {
        let each = (space.pieces.len() * space.cases.len()) as f64;
        let exhaustive_core_s = designs * each * VISIT_S;
        if !(QUICK_S..HOPELESS_S).contains(&exhaustive_core_s) {
            return Self { exhaustive_core_s, exact_core_s: None };
        }
        let [small, large] =
            THINNED_DESIGNS.map(|most| Trial::new(&thinned(space, catalogs, most), catalogs));
        Self {
            exhaustive_core_s: exhaustive_core_s * (large.held + COST_OF_EXCLUDED * (1.0 - large.held)),
            exact_core_s: Some(grown(&small, &large, designs) * each * BOX_S),
        }
    }

    /// Both estimated times and the search that is chosen, in two sentences; `None` if the exact search was not
    /// estimated.
    pub(crate) fn words(&self) -> Option<String> {
        let seconds = |s: f64| format!("{} s", significant(s, 1));
        let exact_core_s = self.exact_core_s?;
        let choice =
            if self.speaks_for_exact() { "The exact search runs" } else { "Every design is visited" };
        Some(format!(
            "Visiting every design is estimated to take {} of one core, the exact search {}. {choice}.",
            seconds(self.exhaustive_core_s),
            seconds(exact_core_s)
        ))
    }

    /// Whether the exact search is estimated to be cheaper by the factor [`LEAST_SAVING`], or an exhaustive search is
    /// ruled out.
    pub(crate) fn speaks_for_exact(&self) -> bool {
        match self.exact_core_s {
            Some(exact_core_s) => exact_core_s * LEAST_SAVING < self.exhaustive_core_s,
            None => self.exhaustive_core_s >= HOPELESS_S,
        }
    }
}

/// Counts from both searches of a thinned space.
struct Trial {
    designs: f64,
    /// Fraction of the designs that are feasible.
    held: f64,
    /// Number of boxes (sets of designs) that the exact searches for the front and for the fronts of single materials
    /// bounded.
    boxes: f64,
}

impl Trial {
    fn new(space: &DesignSpace, catalogs: &Catalogs) -> Self {
        let stop = AtomicBool::new(false);
        let problem = ArmProblem::new(space, catalogs);
        let sweep = Sweep::new(&problem, space.constraints, &stop).run();
        let search = Exact::new(space, catalogs, &stop, None);
        search.run(&[]);
        let materials = space.material_names().len();
        if materials > 1 {
            (0..materials).for_each(|material| {
                search.run_of_material(material);
            });
        }
        let designs: f64 = problem.level_sizes().iter().map(|&size| f64::from(size)).product();
        Self {
            designs: designs.max(1.0),
            held: sweep.designs_evaluated as f64 / designs.max(1.0),
            boxes: search.known().boxes as f64,
        }
    }
}

/// Estimated number of boxes of an exact search in a space with `designs` designs. It is extrapolated with the exponent
/// that the trials in two smaller spaces show.
fn grown(small: &Trial, large: &Trial, designs: f64) -> f64 {
    let growth = libm::log(large.boxes.max(1.0) / small.boxes.max(1.0));
    let of_designs = libm::log(large.designs / small.designs);
    // two spaces of nearly the same size show no exponent; the number of boxes is then taken as proportional to the
    // number of designs
    let power = if of_designs > 0.1 { (growth / of_designs).clamp(0.0, 1.0) } else { 1.0 };
    large.boxes.max(1.0) * libm::pow((designs / large.designs).max(1.0), power)
}

/// The space thinned to at most `most` designs. Every second option of the piece with the most options is dropped,
/// repeatedly.
fn thinned(space: &DesignSpace, catalogs: &Catalogs, most: f64) -> DesignSpace {
    let mut space = space.clone();
    while space.designs(catalogs).is_none_or(|designs| designs as f64 > most)
        && drop_half(&mut space, catalogs)
    {}
    // a material of which no section is left must not stay as a group without designs
    space.renumber_materials();
    space
}

/// Drops every second option of the piece with the most options. Returns false if no piece has two options.
fn drop_half(space: &mut DesignSpace, catalogs: &Catalogs) -> bool {
    let largest = space.pieces.iter_mut().max_by_key(|piece| options(piece, catalogs));
    let Some(largest) = largest.filter(|piece| options(piece, catalogs) > 1) else { return false };
    match largest {
        SpacePiece::Choice(choice) => choice.options = every_second(&choice.options).into(),
        SpacePiece::Joint(joint) => {
            if let DriveChoice::AllFits(filter) = &mut joint.drive {
                let [gears, motors] = allowed(filter, catalogs);
                match gears.len() >= motors.len() {
                    true => filter.gear_ids = Some(every_second(&gears)),
                    false => filter.motor_ids = Some(every_second(&motors)),
                }
            }
        }
        SpacePiece::Prismatic(_) | SpacePiece::Link(_) => {}
    }
    true
}

/// Number of sections of an open link, or of pairs of gear and motor of a joint with `all_fits`; else 0.
fn options(piece: &SpacePiece, catalogs: &Catalogs) -> usize {
    match piece {
        SpacePiece::Choice(choice) => choice.options.len(),
        SpacePiece::Joint(joint) => match &joint.drive {
            DriveChoice::AllFits(filter) => allowed(filter, catalogs).iter().map(Vec::len).product(),
            _ => 0,
        },
        SpacePiece::Prismatic(_) | SpacePiece::Link(_) => 0,
    }
}

/// Names of the gears and names of the motors that the filter allows.
fn allowed(filter: &DriveFilter, catalogs: &Catalogs) -> [Vec<String>; 2] {
    let gears = catalogs.gears.iter().filter(|gear| filter.allows_gear(gear)).map(|gear| gear.id.clone());
    let motors =
        catalogs.motors.iter().filter(|motor| filter.allows_motor(motor)).map(|motor| motor.id.clone());
    [gears.collect(), motors.collect()]
}

fn every_second<T: Clone>(list: &[T]) -> Vec<T> {
    list.iter().step_by(2).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Document;
    use crate::study::definition::Study;
    use crate::study::named::named;
    use crate::study::read::read_study;

    fn study(name: &str, catalogs: &Catalogs) -> Study {
        let text = named(name).expect("a named study");
        read_study(Document::parse(name, text).expect("JSON"), catalogs).expect("a sound study")
    }

    #[test]
    fn a_thinned_space_has_at_most_the_designs_asked_for_and_not_far_less() {
        let catalogs = Catalogs::builtin();
        for name in ["stiff-arm", "compare-materials", "full-catalog"] {
            let space = thinned(&study(name, &catalogs).space, &catalogs, 1e5);
            let designs = space.designs(&catalogs).expect("countable") as f64;
            assert!((1e3..=1e5).contains(&designs), "{name}: {designs}");
        }
    }

    #[test]
    fn materials_without_a_section_left_are_no_groups_of_a_thinned_space() {
        let catalogs = Catalogs::builtin();
        let space = thinned(&study("compare-materials", &catalogs).space, &catalogs, 200.0);
        let materials = space.material_names().len();
        let numbers = space.pieces.iter().flat_map(|piece| match piece {
            SpacePiece::Choice(choice) => choice.options.iter().map(|o| o.material_index).collect(),
            _ => Vec::new(),
        });
        assert!(numbers.max().expect("sections") < materials, "{materials} materials are left");
        assert!(Trial::new(&space, &catalogs).designs <= 200.0);
    }

    #[test]
    fn boxes_grow_by_the_power_that_two_spaces_show() {
        let trial = |designs: f64, boxes: f64| Trial { designs, held: 1.0, boxes };
        let by_root = grown(&trial(1e4, 100.0), &trial(1e6, 1000.0), 1e8);
        assert!((by_root - 1e4).abs() < 1e-6, "{by_root}");
        // an exponent above one or below zero is an accident of two small spaces
        assert_eq!(grown(&trial(1e4, 10.0), &trial(1e5, 1e4), 1e6), 1e5);
        assert_eq!(grown(&trial(1e4, 10.0), &trial(1e5, 5.0), 1e6), 5.0);
    }

    #[test]
    fn a_quick_visit_is_not_compared_and_a_hopeless_one_is_not_thought_of() {
        let catalogs = Catalogs::builtin();
        let cost =
            |name: &str, designs: f64| SearchCost::of(&study(name, &catalogs).space, &catalogs, designs);
        let quick = cost("stiff-arm", 1e5);
        assert!(quick.exact_core_s.is_none() && !quick.speaks_for_exact(), "{quick:?}");
        let hopeless = cost("full-catalog", 1e32);
        assert!(hopeless.exact_core_s.is_none() && hopeless.speaks_for_exact(), "{hopeless:?}");
        let compared = cost("stiff-arm", 1e9);
        assert!(compared.exact_core_s.is_some_and(|s| s > 0.0), "{compared:?}");
        assert_eq!(compared, cost("stiff-arm", 1e9), "no clock enters");
        let exact_runs = compared.words().expect("words").contains("The exact search runs");
        assert_eq!(exact_runs, compared.speaks_for_exact());
    }
}
