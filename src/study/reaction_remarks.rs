//! Remarks on reactions: the torques that the drives of a design must hold while another joint moves. Drives are sized
//! for the ramps and stops of their own joints, so no check of the search includes these torques.

use super::picked::options_of_picks;
use super::table::{DrivenJoint, driven_joints};
use crate::catalog::Catalogs;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::sizing::check::{Check, CheckKind, CheckState};
use crate::sizing::checks::{binding, reaction_checks};
use crate::space::problem::ArmProblem;
use crate::space::reaction::Reaction;

/// A joint is named if its reaction exceeds the torque of its own motion by more than this fraction.
const NAMED_FROM: f64 = 0.02;

/// The reaction on one joint (what it must hold while another joint moves), and the torque of its own motion.
struct Held {
    joint: String,
    /// The joint whose ramp gives the largest torque in a ramp, and the joint whose stop gives the largest torque in a
    /// stop.
    movers: [String; 2],
    /// Unit of the torques: N m, or N of a prismatic joint.
    unit: &'static str,
    /// Torques at this joint in the ramp and in the emergency stop of another joint, in this order, in the unit `unit`.
    reaction_nm: [f64; 2],
    /// Largest torques at this joint in its own ramp and in its own emergency stop, in this order, in the unit `unit`.
    own_nm: [f64; 2],
    /// The check with the smallest margin; `None` if no check could be made.
    binding: Option<Check>,
    /// Whether a check other than those of buckling and ratcheting could not be made because a rating is blank.
    is_open: bool,
}

impl Held {
    fn new(problem: &ArmProblem, joint: &DrivenJoint, reaction: &Reaction) -> Self {
        let name = |piece: usize| problem.space().pieces[piece].name().to_string();
        let at_gear_nm = [reaction.in_ramp_nm, reaction.in_stop_nm].map(|nm| nm / joint.gain_after_gear);
        let checks = reaction_checks(&joint.drive, &joint.motion, at_gear_nm[0], at_gear_nm[1]);
        // buckling and ratcheting are not checked where the catalog leaves them blank, as in sizing
        let is_needed =
            |kind: CheckKind| !matches!(kind, CheckKind::GearBuckling | CheckKind::GearRatcheting);
        let is_open =
            checks.iter().any(|c| is_needed(c.kind) && matches!(c.state, CheckState::NotChecked(_)));
        Self {
            joint: name(reaction.piece),
            movers: [reaction.ramps, reaction.stops].map(name),
            unit: if joint.drive.gear.kind.slides() { "N" } else { "N m" },
            reaction_nm: [reaction.in_ramp_nm, reaction.in_stop_nm],
            own_nm: [joint.demand.peak_torque_nm(), joint.demand.stop_torque_nm]
                .map(|nm| nm * joint.gain_after_gear),
            binding: binding(&checks).copied(),
            is_open,
        }
    }

    /// Whether the reaction exceeds the torque of the joint's own motion by more than [`NAMED_FROM`], in a ramp or in a
    /// stop.
    fn exceeds(&self) -> bool {
        (0..2).any(|i| self.reaction_nm[i] > (1.0 + NAMED_FROM) * self.own_nm[i])
    }

    /// The margin of the drive; infinite where it is not known.
    fn margin(&self) -> f64 {
        self.binding.as_ref().and_then(Check::torque_margin).unwrap_or(f64::INFINITY)
    }

    fn fails(&self) -> bool {
        self.binding.as_ref().is_some_and(|check| check.state == CheckState::Fails)
    }

    /// The check with the smallest margin and the joint, then the margin: `motor peak of w, 0.699`. `None` if no check
    /// could be made.
    fn margin_words(&self) -> Option<String> {
        let label = self.binding.as_ref()?.kind.label();
        Some(format!("{label} of {}, {}", self.joint, significant(self.margin(), 3)))
    }

    fn words(&self) -> String {
        let Self { joint, movers: [ramps, stops], unit, reaction_nm, own_nm, .. } = self;
        let [[in_ramp, in_stop], [own_ramp, own_stop]] =
            [reaction_nm, own_nm].map(|pair| pair.map(|nm| significant(nm, 3)));
        let margin = self.margin_words().map_or(String::new(), |words| format!(" (margin: {words})"));
        format!(
            "{joint} must hold {in_ramp} {unit} while {ramps} ramps and {in_stop} {unit} while {stops} stops{margin}; its own \
             motion asks {own_ramp} and {own_stop} {unit}"
        )
    }
}

/// The reactions of one design that exceed the torques of the joints' own motions. `chosen` are the options of the
/// design, one for each level, tip first. `None` if the design breaks a limit.
fn held(problem: &ArmProblem, catalogs: &Catalogs, chosen: &[u32]) -> Option<Vec<Held>> {
    let driven = driven_joints(problem, catalogs, chosen).ok()?;
    let of_joint = |reaction: Reaction| {
        let joint = driven.iter().find(|joint| joint.piece == reaction.piece)?;
        Some(Held::new(problem, joint, &reaction)).filter(Held::exceeds)
    };
    Some(problem.reactions(chosen)?.into_iter().filter_map(of_joint).collect())
}

/// A sentence on the reactions `all`. If drives fail under their reactions, it names their joints, each in the design
/// with the smallest margin. If all drives hold, it states the smallest margin. `whose` are words that say which
/// designs were examined. `None` if there are no reactions.
fn sentence(all: Vec<Held>, whose: &str) -> Option<String> {
    let mut worst: Vec<Held> = Vec::new();
    for held in all {
        match worst.iter_mut().find(|known| known.joint == held.joint) {
            Some(known) => {
                let is_open = known.is_open || held.is_open;
                if held.margin() < known.margin() {
                    *known = held;
                }
                known.is_open = is_open;
            }
            None => worst.push(held),
        }
    }
    let nearest = worst.iter().min_by(|a, b| a.margin().total_cmp(&b.margin()))?;
    let weak: Vec<String> = worst.iter().filter(|held| held.fails()).map(Held::words).collect();
    let open: Vec<&str> = worst.iter().filter(|held| held.is_open).map(|held| held.joint.as_str()).collect();
    let main = match (weak.is_empty(), nearest.margin_words()) {
        (true, Some(margin)) => format!(
            "As far as their ratings are known, they also withstand the ramps and stops of the other joints {whose} (smallest \
             margin: {margin})."
        ),
        (true, None) => {
            format!(
                "Whether they withstand the ramps and stops of the other joints {whose} cannot be checked."
            )
        }
        (false, _) => format!(
            "The ramps and stops of other joints are too much for some of them {whose}: {}. This excludes no design.",
            weak.join("; ")
        ),
    };
    let blank = match open.is_empty() {
        true => String::new(),
        false => format!(" Ratings are blank in {}.", open.join(", ")),
    };
    Some(format!("Drives are sized for the motion of their own joint. {main}{blank}"))
}

/// The remark on the reactions in one design, whose options are `chosen`; `None` if there is nothing to say. `whose` are
/// words that say which cases were examined.
pub(super) fn reaction_remark_on(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    chosen: &[u32],
    whose: &str,
) -> Option<String> {
    sentence(held(problem, catalogs, chosen)?, whose)
}

/// The remark on the reactions in the picks of a front; `None` if there is nothing to say.
pub(super) fn reaction_remark(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    front: &FrontTable,
) -> Option<String> {
    let picked = options_of_picks(problem, front);
    let all = picked.iter().filter_map(|chosen| held(problem, catalogs, chosen)).flatten();
    sentence(all.collect(), "in the sizing cases of the picks")
}
