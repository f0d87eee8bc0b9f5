//! Ties: drives that can replace those of a design without changing any objective. They are listed in a file of their
//! own if the designs with them are too many to be rows of the front.

use super::outcome::{Front, Judged};
use crate::report::front_table::FrontTable;
use crate::report::number::large;
use crate::report::section::PageSection;
use crate::report::supplement::Supplement;
use crate::report::words::{TERMINAL, wrap};
use crate::sizing::demand::JointDemand;
use crate::space::design::{id_of, options};
use crate::space::design_space::SpacePiece;
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// The ties of a front: for every design, the drives of equal mass and torsion curve that may replace its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Ties {
    rows: Vec<Vec<String>>,
    /// Number of rows of the front.
    front: usize,
    designs: f64,
}

/// Name of the file that lists the ties.
pub(crate) const FILE: &str = "ties.csv";

const COLUMNS: [&str; 4] = ["design_id", "at", "part", "instead"];

/// Separator between drives that may replace each other.
const OR: &str = "; ";

/// Finds the ties of a front. The drives of one joint may be exchanged independently of those of other joints.
pub fn ties(problem: &ArmProblem, front: &Front) -> Ties {
    let of_designs: Vec<(Vec<Vec<String>>, f64)> =
        front.par_iter().filter_map(|judged| ties_of(problem, judged)).collect();
    let designs = of_designs.iter().map(|(_, designs)| designs).sum();
    let rows = of_designs.into_iter().flat_map(|(rows, _)| rows).collect();
    Ties { rows, front: front.len(), designs }
}

/// The rows of one design in `ties.csv`, and the number of designs with the same objectives that it represents, itself
/// among them. `None` if the design does not meet its limits.
fn ties_of(problem: &ArmProblem, judged: &Judged) -> Option<(Vec<Vec<String>>, f64)> {
    let mut demands: Vec<(usize, JointDemand)> = Vec::new();
    let chosen = options(problem.level_sizes(), judged.design.number)?;
    let complete = problem
        .walk(&chosen, |slot, outboard| {
            let piece = problem.piece_of_slot(slot);
            if problem.sized_joint(piece).is_some_and(|sized| sized.is_level()) {
                demands.push((piece, problem.demand_at(outboard, slot)));
            }
        })
        .ok()?;
    let of_pieces: Vec<u32> = problem.options(&complete).collect();
    let id = id_of(problem.whole_number(judged.design.number));
    let (mut rows, mut designs) = (Vec::new(), 1.0);
    for (piece, demand) in demands.iter().rev() {
        let (Some(sized), SpacePiece::Joint(joint)) =
            (problem.sized_joint(*piece), &problem.space().pieces[*piece])
        else {
            continue;
        };
        let own = of_pieces[*piece] as usize;
        let tied: Vec<usize> = sized.ties_of(own, demand).collect();
        designs *= tied.len() as f64;
        let name = |drive: usize| sized.table.drive(drive).name();
        let others: Vec<String> = tied.iter().filter(|&&drive| drive != own).map(|&d| name(d)).collect();
        if !others.is_empty() {
            rows.push(vec![id.clone(), joint.name.clone(), name(own), others.join(OR)]);
        }
    }
    Some((rows, designs))
}

impl Ties {
    /// The table as CSV, with one row for each joint of a design that has alternatives.
    pub fn to_csv(&self) -> Vec<u8> {
        FrontTable { columns: COLUMNS.map(String::from).into(), rows: self.rows.clone() }.to_csv()
    }

    /// Differences, in words, between these ties and the content of a `ties.csv` that should list them. Empty if there
    /// are none.
    pub fn faults_of(&self, file: &[u8]) -> Vec<String> {
        let mut reader = csv::Reader::from_reader(file);
        let columns: Vec<String> =
            reader.headers().map_or_else(|_| Vec::new(), |found| found.iter().map(String::from).collect());
        if columns != COLUMNS {
            return vec![format!(
                "ties.csv: its columns are {}, not {}",
                columns.join(","),
                COLUMNS.join(",")
            )];
        }
        let found: BTreeSet<Vec<String>> =
            reader.records().flatten().map(|row| row.iter().map(String::from).collect()).collect();
        let right: BTreeSet<Vec<String>> = self.rows.iter().cloned().collect();
        let place = |row: &Vec<String>| format!("ties.csv, design {} at {}", row[0], row[1]);
        let lacks = right.difference(&found);
        let lacks = lacks.map(|row| format!("{}: {} may be {}", place(row), row[2], row[3]));
        let adds = found.difference(&right);
        let adds = adds.map(|row| format!("{}: {} may not be {}", place(row), row[2], row[3]));
        lacks.chain(adds).collect()
    }

    /// A sentence that says how many designs with the same objectives the rows of the front stand for.
    pub fn sentence(&self) -> String {
        format!(
            "The {} rows of the front stand for {} designs with the same objectives: at some joints several drives have \
             equal mass and an equal torsion curve. ties.csv lists them.",
            large(self.front as u128),
            large(self.designs as u128)
        )
    }

    /// Everything that a result reports about ties: file, sections, terminal text.
    pub fn supplement(&self) -> Supplement {
        Supplement {
            file: Some((FILE, self.to_csv())),
            markdown: self.to_markdown(),
            section: Some(self.section()),
            run: None,
            terminal: wrap(&self.sentence(), TERMINAL, ""),
        }
    }

    /// The section on ties for the HTML page.
    pub fn section(&self) -> PageSection {
        PageSection {
            title: "Drives that may be exchanged".into(),
            words: vec![self.sentence()],
            tables: Vec::new(),
            figures: Vec::new(),
        }
    }

    /// The section on ties for the Markdown summary.
    pub fn to_markdown(&self) -> String {
        format!("\n## Drives that may be exchanged\n\n{}\n", self.sentence())
    }
}
