//! What the drives of a design hold while another joint moves, in sentences. Drives are sized for their own joints' ramps
//! and stops, so that such a torque is in no check of the search.

use super::table::driven_joints;
use crate::catalog::Catalogs;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::report::picks::{designs, picks};
use crate::sizing::check::{Check, CheckState};
use crate::sizing::checks::{binding, reaction_checks};
use crate::space::design::number_of;
use crate::space::problem::ArmProblem;
use crate::space::reaction::Reaction;

/// A joint is named if its reaction exceeds the torque of its own motion by more than this fraction.
const NAMED_FROM: f64 = 0.02;

/// The reaction on one joint, next to what its own motion asks.
struct Held {
    joint: String,
    mover: String,
    /// Unit of the torques: N m, or N of a prismatic joint.
    unit: &'static str,
    reaction: Reaction,
    /// Largest torque of the joint's own ramp and of its own stop.
    own_nm: [f64; 2],
    /// The check with the smallest margin; `None` if no check could be made.
    binding: Option<Check>,
}

impl Held {
    /// How far the reaction exceeds what the joint's own motion asks, as a ratio.
    fn excess(&self) -> f64 {
        let [ramp_nm, stop_nm] = self.own_nm;
        (self.reaction.in_ramp_nm / ramp_nm).max(self.reaction.in_stop_nm / stop_nm)
    }

    /// The margin of the drive; infinite where it is not known.
    fn margin(&self) -> f64 {
        self.binding.as_ref().and_then(Check::torque_margin).unwrap_or(f64::INFINITY)
    }

    fn fails(&self) -> bool {
        self.binding.as_ref().is_some_and(|check| check.state == CheckState::Fails)
    }

    /// The check with the smallest margin, and the margin: `motor peak of w, 0.699`.
    fn margin_words(&self) -> Option<String> {
        let label = self.binding.as_ref()?.kind.label();
        Some(format!("{label} of {}, {}", self.joint, significant(self.margin(), 3)))
    }

    fn words(&self) -> String {
        let Self { joint, mover, unit, reaction, own_nm: [ramp_nm, stop_nm], .. } = self;
        let short = |x: f64| significant(x, 3);
        let margin = self.margin_words().map_or(String::new(), |words| format!(" (margin: {words})"));
        format!(
            "{joint} holds {} {unit} while {mover} ramps and {} {unit} while it stops{margin}; its own motion asks {} and {} {unit}",
            short(reaction.in_ramp_nm),
            short(reaction.in_stop_nm),
            short(*ramp_nm),
            short(*stop_nm)
        )
    }
}

/// The reactions of one design that exceed what the joints' own motions ask. `chosen` are the options of the design, one
/// for each level, tip first.
fn held(problem: &ArmProblem, catalogs: &Catalogs, chosen: &[u32]) -> Option<Vec<Held>> {
    let driven = driven_joints(problem, catalogs, chosen).ok()?;
    let pieces = &problem.space().pieces;
    let of_joint = |reaction: Reaction| {
        let joint = driven.iter().find(|joint| joint.piece == reaction.piece)?;
        let checks = reaction_checks(&joint.drive, &joint.motion, reaction.in_ramp_nm, reaction.in_stop_nm);
        let held = Held {
            joint: pieces[reaction.piece].name().to_string(),
            mover: pieces[reaction.mover].name().to_string(),
            unit: if joint.drive.gear.kind.slides() { "N" } else { "N m" },
            own_nm: [joint.demand.peak_torque_nm(), joint.demand.stop_torque_nm],
            binding: binding(&checks).copied(),
            reaction,
        };
        (held.excess() > 1.0 + NAMED_FROM).then_some(held)
    };
    Some(problem.reactions(chosen)?.into_iter().filter_map(of_joint).collect())
}

/// A sentence on the reactions that exceed what the joints' own motions ask; `None` if there are none. It names the joints
/// whose drives do not hold their reactions, each in the design with the smallest margin, or the smallest margin if all
/// hold. `whose` says of which designs it tells.
fn sentence(all: Vec<Held>, whose: &str) -> Option<String> {
    let mut worst: Vec<Held> = Vec::new();
    for held in all {
        match worst.iter_mut().find(|known| known.joint == held.joint) {
            Some(known) if held.margin() < known.margin() => *known = held,
            Some(_) => {}
            None => worst.push(held),
        }
    }
    let nearest = worst.iter().min_by(|a, b| a.margin().total_cmp(&b.margin()))?;
    let weak: Vec<String> = worst.iter().filter(|held| held.fails()).map(Held::words).collect();
    Some(match (weak.is_empty(), nearest.margin_words()) {
        (true, Some(margin)) => format!(
            "Drives are sized for the motion of their own joint. What a joint holds while another one ramps or stops is held \
             too {whose} (smallest margin: {margin})."
        ),
        (true, None) => format!(
            "Drives are sized for the motion of their own joint. Whether they hold what another joint's ramp or stop asks of \
             them is not known {whose}, since ratings are blank."
        ),
        (false, _) => format!(
            "Drives are sized for the motion of their own joint. What a joint holds while another one ramps or stops is too \
             much for some {whose}: {}. This excludes no design.",
            weak.join("; ")
        ),
    })
}

/// The remark on one design.
pub(super) fn reaction_remark_on(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    chosen: &[u32],
) -> Option<String> {
    sentence(held(problem, catalogs, chosen)?, "in the sizing cases")
}

/// The remark on the picks of a front.
pub(super) fn reaction_remark(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    front: &FrontTable,
) -> Option<String> {
    let of_pick = |id: &str| held(problem, catalogs, &problem.options_of_whole(number_of(id)?)?);
    let picks = picks(&designs(front));
    let all = picks.iter().filter_map(|pick| of_pick(&pick.design.design_id)).flatten();
    sentence(all.collect(), "in the sizing cases of the picks")
}
