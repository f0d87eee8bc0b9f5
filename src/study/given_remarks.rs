//! Remarks on given drives. They say which drives are too weak for some designs of a front, and which checks cannot be
//! made because ratings are blank. They are printed with the front.

use crate::catalog::Catalogs;
use crate::sizing::check::{Check, CheckState};
use crate::sizing::sheet::{JointSizingRow, with_part};
use crate::space::problem::ArmProblem;

/// A given drive, with the checks that it fails in designs of a front.
struct Overloaded {
    joint: String,
    drive: String,
    /// Number of designs in which the drive fails a check.
    designs: usize,
    /// For each kind of check that the drive fails, the check with the smallest margin over the designs.
    worst: Vec<Check>,
    /// The checks that cannot be made because a rating is blank, in words.
    open: Vec<String>,
}

impl Overloaded {
    /// Adds the checks that the drive fails in one design, whose sizing of the joint is `row`. Checks of the output
    /// bearing are left out, because other remarks name overloaded bearings.
    fn take(&mut self, row: &JointSizingRow) {
        let fails = row.checks.iter().filter(|c| c.state == CheckState::Fails && !c.kind.is_bearing());
        let fails: Vec<&Check> = fails.collect();
        let is_open = |c: &&Check| matches!(c.state, CheckState::NotChecked(_)) && !c.holds();
        let open = row.checks.iter().filter(is_open).filter(|c| !c.kind.is_bearing());
        for words in open.map(with_part) {
            if !self.open.contains(&words) {
                self.open.push(words);
            }
        }
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

/// The given drives of a study, with the checks that they fail in the designs examined so far.
pub(crate) struct GivenDrives(Vec<Overloaded>);

impl GivenDrives {
    /// The given drives of a study, before any design is examined.
    pub(crate) fn of(problem: &ArmProblem, catalogs: &Catalogs) -> Self {
        let given = problem.space().pieces.iter().enumerate().filter_map(|(piece, what)| {
            let drive = problem.fixed_drive(piece, catalogs)?.drive.name();
            Some(Overloaded {
                joint: what.name().to_string(),
                drive,
                designs: 0,
                worst: Vec::new(),
                open: Vec::new(),
            })
        });
        Self(given.collect())
    }

    /// Adds the checks that the given drives fail in one design. `rows` is the sizing of its joints.
    pub(crate) fn take(&mut self, rows: &[JointSizingRow]) {
        for drive in &mut self.0 {
            if let Some(row) = rows.iter().find(|row| row.joint == drive.joint) {
                drive.take(row);
            }
        }
    }

    /// A sentence for each given drive that fails checks in some of the `designs` designs of a front, and one on the
    /// checks that cannot be made.
    pub(crate) fn remarks(&self, designs: usize) -> Vec<String> {
        let too_weak = self.0.iter().filter_map(|drive| drive.sentence(designs));
        too_weak.chain(self.open_sentence()).collect()
    }

    /// The checks of given drives that cannot be made, with the joints; `None` if all can.
    fn open_sentence(&self) -> Option<String> {
        let mut joints: Vec<(&str, Vec<&str>)> = Vec::new();
        for drive in &self.0 {
            for words in &drive.open {
                match joints.iter_mut().find(|(known, _)| known == words) {
                    Some((_, names)) => names.push(&drive.joint),
                    None => joints.push((words, vec![&drive.joint])),
                }
            }
        }
        let listed: Vec<String> =
            joints.iter().map(|(words, names)| format!("{}: {words}", names.join(", "))).collect();
        (!listed.is_empty()).then(|| {
            format!("Checks of given drives that the catalog does not allow: {}.", listed.join("; "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_that_a_blank_rating_prevents_are_named_once_with_their_joints() {
        let drive = |joint: &str, open: &[&str]| Overloaded {
            joint: joint.into(),
            drive: "CSG-20-100 + M".into(),
            designs: 0,
            worst: Vec::new(),
            open: open.iter().map(|words| words.to_string()).collect(),
        };
        let peak = "motor peak not checked: lacks rotor_inertia_kgm2";
        let given = GivenDrives(vec![drive("j1", &[peak]), drive("j2", &[]), drive("j3", &[peak])]);
        let said = format!("Checks of given drives that the catalog does not allow: j1, j3: {peak}.");
        assert_eq!(given.remarks(1), [said]);
        assert!(GivenDrives(vec![drive("j2", &[])]).remarks(1).is_empty());
    }
}
