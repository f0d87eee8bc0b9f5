//! Remarks on given drives that are too weak for some designs of a front. They are printed with the front.

use super::outcome::Front;
use super::table::sizing_rows;
use crate::catalog::Catalogs;
use crate::sizing::check::{Check, CheckState};
use crate::sizing::sheet::{JointSizingRow, with_part};
use crate::space::design::options;
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;

/// A given drive, with the checks that it fails in designs of a front.
struct Overloaded {
    joint: String,
    drive: String,
    /// Number of designs in which the drive fails a check.
    designs: usize,
    /// For each kind of check that the drive fails, the check with the smallest margin over the designs.
    worst: Vec<Check>,
}

impl Overloaded {
    /// Adds the checks that the drive fails in one design, whose sizing of the joint is `row`. Checks of the output
    /// bearing are left out, because other remarks name overloaded bearings.
    fn take(&mut self, row: &JointSizingRow) {
        let fails = row.checks.iter().filter(|c| c.state == CheckState::Fails && !c.kind.is_bearing());
        let fails: Vec<&Check> = fails.collect();
        self.designs += usize::from(!fails.is_empty());
        for check in fails {
            let margin = |check: &Check| check.margin().unwrap_or(0.0);
            match self.worst.iter_mut().find(|worst| worst.kind == check.kind) {
                Some(worst) if margin(check) < margin(worst) => *worst = *check,
                Some(_) => {}
                None => self.worst.push(*check),
            }
        }
    }

    fn sentence(&self, designs: usize) -> Option<String> {
        let worst: Vec<String> = self.worst.iter().map(with_part).collect();
        (!worst.is_empty()).then(|| {
            format!(
                "The drive of {} ({}) is too weak in {} of {designs} designs of the front, at worst {}: it is given, so that its \
                 checks exclude nothing.",
                self.joint,
                self.drive,
                self.designs,
                worst.join("; ")
            )
        })
    }
}

/// A sentence for each given drive that fails a check in some design of a front.
pub(crate) fn given_drive_remarks(problem: &ArmProblem, catalogs: &Catalogs, front: &Front) -> Vec<String> {
    let pieces = problem.space().pieces.iter().enumerate();
    let mut given: Vec<Overloaded> = pieces
        .filter_map(|(piece, what)| {
            let drive = problem.fixed_drive(piece, catalogs)?.drive.name();
            Some(Overloaded { joint: what.name().to_string(), drive, designs: 0, worst: Vec::new() })
        })
        .collect();
    if given.is_empty() {
        return Vec::new();
    }
    for judged in front {
        let chosen = options(problem.level_sizes(), judged.design.number);
        let rows = chosen.and_then(|chosen| sizing_rows(problem, catalogs, &chosen).ok()).unwrap_or_default();
        for drive in &mut given {
            if let Some(row) = rows.iter().find(|row| row.joint == drive.joint) {
                drive.take(row);
            }
        }
    }
    given.iter().filter_map(|drive| drive.sentence(front.len())).collect()
}
