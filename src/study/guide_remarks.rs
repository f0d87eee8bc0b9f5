//! Remarks on the loads on the guides of a study's prismatic joints. Where the study does not state what a guide holds,
//! a reader can compare its load with the ratings of the maker.

use super::picked::options_of_picks;
use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::arm::prismatic::{GuideLimits, Prismatic};
use crate::mechanics::GuideLoad;
use crate::report::front_table::FrontTable;
use crate::report::number::{percent, significant};
use crate::space::design_space::SpacePiece;
use crate::space::guide::guide_load;
use crate::space::problem::ArmProblem;

/// The largest load on one guide.
#[derive(Debug, Clone, Copy, Default)]
struct Largest {
    /// Force across the travel \[N\].
    across_n: f64,
    /// Moment \[N m\].
    moment_nm: f64,
    /// Fraction of the guide's load capacity that the load uses, 1 if it is fully used; `None` if the study states no
    /// limit of this guide.
    part_used: Option<f64>,
}

impl Largest {
    fn with(self, load: &GuideLoad, limits: &GuideLimits) -> Self {
        let part_used = limits.part_used(&load.force_n, &load.moment_nm);
        Self {
            across_n: self.across_n.max(libm::hypot(load.force_n.y, load.force_n.z)),
            moment_nm: self.moment_nm.max(load.moment_nm.norm()),
            part_used: part_used.map(|part| self.part_used.map_or(part, |most| most.max(part))),
        }
    }

    fn words(&self) -> String {
        let loads = format!("{} N and {} N m", significant(self.across_n, 3), significant(self.moment_nm, 3));
        match self.part_used {
            Some(part) if part > 1.0 => format!("{loads} ({} times what it holds)", significant(part, 3)),
            Some(part) => format!("{loads} ({} of what it holds)", percent(100.0 * part, 0)),
            None => loads,
        }
    }
}

/// The load on one guide at rest, and in an emergency stop of its own travel.
struct OnGuide<'s> {
    joint: &'s Prismatic,
    deceleration_m_s2: f64,
    at_rest: Largest,
    in_stop: Largest,
}

/// Sentences on the force across the travel and the moment on every guide: the largest of the picks of `front` in the
/// cases of the study.
pub(super) fn guide_remarks(problem: &ArmProblem, front: &FrontTable) -> Vec<String> {
    sentences(problem, &options_of_picks(problem, front), " of the picks")
}

/// Sentences on the loads on every guide in the design with the options `chosen`, one for each level, tip first.
pub(super) fn guide_remarks_on(problem: &ArmProblem, chosen: &[u32]) -> Vec<String> {
    sentences(problem, &[chosen.to_vec()], "")
}

/// Sentences on the largest loads on every guide in these `designs`, given by their options, in the cases of the study.
/// `whose` are words that say which designs they are.
fn sentences(problem: &ArmProblem, designs: &[Vec<u32>], whose: &str) -> Vec<String> {
    let mut guides = guides(problem);
    if guides.is_empty() || load_by(&mut guides, problem, designs).is_none() {
        return Vec::new();
    }
    let words = guides.iter().map(|guide| {
        let name = &guide.joint.name;
        format!(
            "{name} {} at rest, {} in an emergency stop of its own travel",
            guide.at_rest.words(),
            guide.in_stop.words()
        )
    });
    let bear = format!("Guides bear across their travel, at most in all cases{whose}");
    let mut out = vec![format!("{bear}: {}.", words.collect::<Vec<_>>().join("; "))];
    out.extend(unknown_limits(&guides));
    out
}

/// A sentence that names the guides of which the study does not state all that they hold; `None` if there are none.
pub(super) fn guide_limits_remark(problem: &ArmProblem) -> Option<String> {
    unknown_limits(&guides(problem))
}

fn unknown_limits(guides: &[OnGuide]) -> Option<String> {
    let lacking: Vec<String> = guides.iter().filter_map(OnGuide::unknown).collect();
    (!lacking.is_empty()).then(|| {
        format!(
            "Whether guides hold their loads is not checked where nothing is stated of it: {}. Compare with the ratings of \
             the maker over its safety factor.",
            lacking.join("; ")
        )
    })
}

/// The guides of the study, base to tip, each with the deceleration of its stop and without a load.
fn guides<'s>(problem: &'s ArmProblem) -> Vec<OnGuide<'s>> {
    let motion = &problem.space().motion;
    let guide = |piece: &'s SpacePiece| {
        let SpacePiece::Prismatic(rail) = piece else { return None };
        Some(OnGuide {
            joint: &rail.joint,
            deceleration_m_s2: rail.stop_m_s2(motion),
            at_rest: Largest::default(),
            in_stop: Largest::default(),
        })
    };
    problem.space().pieces.iter().filter_map(guide).collect()
}

/// Adds the loads of the designs with these options in the judged cases and in the sizing cases. `None` if one of them
/// is no design of the problem.
fn load_by(guides: &mut [OnGuide], problem: &ArmProblem, designs: &[Vec<u32>]) -> Option<()> {
    let space = problem.space();
    let cases: Vec<usize> = (0..space.cases.len())
        .filter(|case| space.judged_cases.contains(case) || space.sizing_cases.contains(case))
        .collect();
    let cases: Vec<LoadCase> = cases.iter().map(|&case| space.load_case(&space.cases[case])).collect();
    for options in designs {
        let arm = problem.arm(options)?;
        for case in &cases {
            guides.iter_mut().try_for_each(|guide| guide.add(&arm, case))?;
        }
    }
    Some(())
}

impl OnGuide<'_> {
    /// Adds the loads of an arm in a case. In a stop everything outboard is accelerated along the travel, which acts
    /// like an additional gravity in the opposite direction. `None` if the arm has no such guide.
    fn add(&mut self, arm: &Arm, case: &LoadCase) -> Option<()> {
        let limits = &self.joint.guide.limits;
        self.at_rest = self.at_rest.with(&guide_load(arm, case, &self.joint.name, 0.0)?, limits);
        for acceleration_m_s2 in [-self.deceleration_m_s2, self.deceleration_m_s2] {
            self.in_stop =
                self.in_stop.with(&guide_load(arm, case, &self.joint.name, acceleration_m_s2)?, limits);
        }
        Some(())
    }

    /// The keys that would state what the guide holds, in words; `None` if all are stated.
    fn unknown(&self) -> Option<String> {
        let keys = self.joint.guide.limits.unknown();
        (!keys.is_empty()).then(|| format!("{} has no {} in its guide", self.joint.name, keys.join(", ")))
    }
}
