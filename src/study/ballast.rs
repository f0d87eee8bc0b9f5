//! Ballast: a table of the designs that are on a front only because extra weight loads a gear into the stiffer part
//! of its torsion curve.

use super::outcome::{Front, Judged};
use super::table::link_words;
use crate::pareto::objectives::Objectives;
use crate::report::front_table::FrontTable;
use crate::report::number::{shortest, significant};
use crate::report::section::PageSection;
use crate::report::supplement::Supplement;
use crate::report::words::{TERMINAL, wrap};
use crate::search::ballast::Ballast;
use crate::space::design::evaluate;
use crate::space::design::{Part, id_of, options};
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use rayon::prelude::*;
use serde_json::json;

/// A design of a front that has ballast, as a table row and in words.
#[derive(Debug, Clone, PartialEq)]
struct Flagged {
    row: Vec<String>,
    words: String,
    by_segment: bool,
}

/// The designs of a front that have a heavy part only for its weight (ballast).
#[derive(Debug, Clone, PartialEq)]
pub struct BallastFlags {
    flagged: Vec<Flagged>,
    front: usize,
}

/// Name of the file that lists the designs with ballast.
pub(crate) const FILE: &str = "ballast.csv";

const COLUMNS: [&str; 13] = [
    "design_id",
    "at",
    "part",
    "lighter_part",
    "lighter_design_id",
    "pressed_joint",
    "pose",
    "mass_kg",
    "lighter_mass_kg",
    "tip_deflection_mm",
    "lighter_tip_deflection_mm",
    "lowest_mode_hz",
    "lighter_lowest_mode_hz",
];

/// Finds the designs of a front that have a heavy part only for its weight. None are reported for a study with linkages
/// or springs, because the effect of extra weight on the joint torques is not known here.
pub fn ballast_flags(problem: &ArmProblem, front: &Front) -> BallastFlags {
    // with linkages the torque on a driving joint is not known here, and with springs extra weight may also unload a
    // joint
    if problem.space().beyond_bounds().is_some() {
        return BallastFlags { flagged: Vec::new(), front: front.len() };
    }
    let flag = |judged: &Judged| flagged(problem, judged, &problem.ballast(judged.design.number)?);
    BallastFlags { flagged: front.par_iter().filter_map(flag).collect(), front: front.len() }
}

fn flagged(problem: &ArmProblem, judged: &Judged, ballast: &Ballast) -> Option<Flagged> {
    let space = problem.space();
    let name = |piece: usize| space.pieces[piece].name().to_string();
    let part = |design: u128| {
        let parts = problem.parts(&options(problem.level_sizes(), design)?)?;
        Some(match &parts[ballast.piece] {
            Part::Drive(drive) => drive.name(),
            Part::Link(option) => link_words(option),
            Part::Given => return None,
        })
    };
    let (heavy, light) = (judged.design.objectives, evaluate(problem, ballast.lighter)?.objectives);
    let id = id_of(problem.whole_number(judged.design.number));
    let (at, pressed) = (name(ballast.piece), name(ballast.pressed));
    let (kept, lighter) = (part(judged.design.number)?, part(ballast.lighter)?);
    let why = match ballast.by_segment {
        true => format!("{pressed} moves to a softer segment of its gear"),
        false => format!("the play of {pressed} opens"),
    };
    let words = format!(
        "{id}: with {lighter} instead of {kept} at {at} it weighs {} kg less and deflects no more, but its lowest mode falls from {} to {} Hz, because {why}.",
        significant(heavy.mass_kg - light.mass_kg, 3),
        significant(heavy.lowest_mode_hz, 4),
        significant(light.lowest_mode_hz, 4),
    );
    let each = |value: fn(&Objectives) -> f64| [value(&heavy), value(&light)].map(shortest);
    let mut row = vec![id, at, kept, lighter, id_of(problem.whole_number(ballast.lighter)), pressed];
    row.push(space.cases[ballast.case].name.clone());
    row.extend(each(|o| o.mass_kg));
    row.extend(each(|o| o.tip_deflection_m * 1e3));
    row.extend(each(|o| o.lowest_mode_hz));
    Some(Flagged { row, words, by_segment: ballast.by_segment })
}

impl BallastFlags {
    /// Number of designs with ballast.
    pub fn len(&self) -> usize {
        self.flagged.len()
    }

    /// Whether no design has ballast.
    pub fn is_empty(&self) -> bool {
        self.flagged.is_empty()
    }

    /// The table as CSV, one row for each design with ballast.
    pub fn to_csv(&self) -> Vec<u8> {
        let rows = self.flagged.iter().map(|f| f.row.clone()).collect();
        FrontTable { columns: COLUMNS.map(String::from).into(), rows }.to_csv()
    }

    /// Number of designs with ballast and the reason why they are on the front, in one sentence.
    pub fn sentence(&self) -> String {
        let are = if self.len() == 1 { "is" } else { "are" };
        let presses = match self.flagged.iter().all(|f| f.by_segment) {
            true => "a gear into the stiffer part of its curve",
            false => "a joint into a range where it is stiffer",
        };
        format!(
            "{} of the front's {} designs {are} on it only because extra weight loads {presses}; see ballast.csv.",
            self.len(),
            self.front
        )
    }

    /// Everything that a result reports about ballast: file, sections, entry of `run.json`, terminal text.
    pub fn supplement(&self) -> Supplement {
        let run = Some(("ballast_designs", json!(self.len())));
        if self.is_empty() {
            return Supplement { run, ..Supplement::default() };
        }
        Supplement {
            file: Some((FILE, self.to_csv())),
            markdown: self.to_markdown(),
            section: Some(self.section()),
            run,
            terminal: wrap(&self.sentence(), TERMINAL, ""),
        }
    }

    /// The section on ballast for the HTML page, with the first five designs in words.
    pub fn section(&self) -> PageSection {
        let words =
            std::iter::once(self.sentence()).chain(self.flagged.iter().take(5).map(|f| f.words.clone()));
        PageSection {
            title: "Ballast".into(),
            words: words.collect(),
            tables: Vec::new(),
            figures: Vec::new(),
        }
    }

    /// The section on ballast for the Markdown summary, with the first five designs in words.
    pub fn to_markdown(&self) -> String {
        let lines: Vec<String> = self.flagged.iter().take(5).map(|f| format!("- {}\n", f.words)).collect();
        format!("\n## Ballast\n\n{}\n\n{}", self.sentence(), lines.concat())
    }
}
