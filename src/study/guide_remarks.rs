//! What the guides of a study's prismatic joints bear, for comparison with the ratings of their makers, which the study
//! does not know.

use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::mechanics::GuideLoad;
use crate::mechanics::chain::Chain;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::report::picks::{designs, picks};
use crate::space::design::number_of;
use crate::space::design_space::SpacePiece;
use crate::space::problem::ArmProblem;

/// The largest load on one guide: force across the travel \[N\] and moment \[N m\].
#[derive(Debug, Clone, Copy, Default)]
struct Largest {
    across_n: f64,
    moment_nm: f64,
}

impl Largest {
    fn with(self, load: &GuideLoad) -> Self {
        Self {
            across_n: self.across_n.max(load.force_n.y.hypot(load.force_n.z)),
            moment_nm: self.moment_nm.max(load.moment_nm.norm()),
        }
    }

    fn words(&self) -> String {
        format!("{} N and {} N m", significant(self.across_n, 3), significant(self.moment_nm, 3))
    }
}

/// The load on one guide at rest, and in the ramp of its own travel.
struct OnGuide<'s> {
    joint: &'s str,
    acceleration_m_s2: f64,
    at_rest: Largest,
    in_ramp: Largest,
}

/// A sentence on the force across the travel and the moment on every guide: the largest of the picks of `front` in the
/// judged cases. `None` if the study has no prismatic joint.
pub(super) fn guide_remark(problem: &ArmProblem, front: &FrontTable) -> Option<String> {
    let mut guides = guides(problem);
    if guides.is_empty() {
        return None;
    }
    let cases = problem.load_cases();
    for pick in picks(&designs(front)) {
        let options = problem.options_of_whole(number_of(&pick.design.design_id)?)?;
        let arm = problem.arm(&options)?;
        for (case, guide) in cases.iter().flat_map(|case| guides.iter_mut().map(move |guide| (case, guide))) {
            guide.add(&arm, case)?;
        }
    }
    let words = guides.iter().map(|guide| {
        format!("{} {} at rest, {} in its ramp", guide.joint, guide.at_rest.words(), guide.in_ramp.words())
    });
    Some(format!(
        "Guides bear across their travel, at most in the judged cases of the picks: {}. Whether they hold this is not \
         checked: compare with the load and moment ratings of the maker, with the safety factor that it asks for.",
        words.collect::<Vec<_>>().join("; ")
    ))
}

/// The guides of the study, base to tip, each with the acceleration of its ramp and without a load.
fn guides<'s>(problem: &'s ArmProblem) -> Vec<OnGuide<'s>> {
    let motion = &problem.space().motion;
    let guide = |piece: &'s SpacePiece| {
        let SpacePiece::Prismatic(rail) = piece else { return None };
        let sized = rail.drive.as_ref().map(|drive| drive.motion(motion).acceleration_rad_s2);
        Some(OnGuide {
            joint: &rail.joint.name,
            acceleration_m_s2: sized.unwrap_or(motion.tip_acceleration_m_s2()),
            at_rest: Largest::default(),
            in_ramp: Largest::default(),
        })
    };
    problem.space().pieces.iter().filter_map(guide).collect()
}

impl OnGuide<'_> {
    /// Adds the loads of an arm in a case. In the ramp everything outboard is accelerated along the travel, which acts as
    /// gravity the other way does. `None` if the arm has no such guide.
    fn add(&mut self, arm: &Arm, case: &LoadCase) -> Option<()> {
        let at_rest = self.load(arm, case, 0.0)?;
        self.at_rest = self.at_rest.with(&at_rest);
        for acceleration_m_s2 in [-self.acceleration_m_s2, self.acceleration_m_s2] {
            self.in_ramp = self.in_ramp.with(&self.load(arm, case, acceleration_m_s2)?);
        }
        Some(())
    }

    /// The load on the guide while everything outboard has this acceleration along the travel.
    fn load(&self, arm: &Arm, case: &LoadCase, acceleration_m_s2: f64) -> Option<GuideLoad> {
        let mut structure = arm.structure_in(case);
        let of_guide = |structure: &_| {
            let statics = Chain::new(structure, case.links).pose(case).statics();
            statics.guide_loads.into_iter().find(|load| load.name == self.joint)
        };
        let at_rest = of_guide(&structure)?;
        if acceleration_m_s2 == 0.0 {
            return Some(at_rest);
        }
        let gravity = structure.down * structure.gravity_m_s2 - at_rest.travel * acceleration_m_s2;
        structure.gravity_m_s2 = gravity.norm();
        structure.down = gravity.try_normalize(0.0).unwrap_or(structure.down);
        of_guide(&structure)
    }
}
