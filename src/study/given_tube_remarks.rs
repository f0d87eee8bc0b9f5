//! Remarks on the stress in tubes that the study gives. The search checks the stress of the links that it chooses, so a
//! reader must be told where a given tube is stressed too much.

use super::picked::options_of_picks;
use crate::arm::{Link, LinkBody};
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::space::design_space::SpacePiece;
use crate::space::problem::ArmProblem;

/// Sentences on the given tubes in the design with the options `chosen`, one for each level, tip first.
pub(super) fn given_tube_remarks_on(problem: &ArmProblem, chosen: &[u32]) -> Vec<String> {
    sentences(problem, &in_design(problem, chosen), "")
}

/// Sentences on the given tubes in the picks of a front.
pub(super) fn given_tube_remarks(problem: &ArmProblem, front: &FrontTable) -> Vec<String> {
    let picked = options_of_picks(problem, front);
    let all: Vec<(usize, f64)> = picked.iter().flat_map(|chosen| in_design(problem, chosen)).collect();
    sentences(problem, &all, " in the picks")
}

/// The given tubes of a design: the number of the piece, base to tip, and the largest ratio of stress to strength over
/// all cases.
fn in_design(problem: &ArmProblem, chosen: &[u32]) -> Vec<(usize, f64)> {
    let cases: Vec<usize> = (0..problem.stations().len()).collect();
    let mut out = Vec::new();
    // a design that breaks a limit has no remarks
    let _ = problem.walk(chosen, |slot, outboard| {
        let ratio = problem.given_tube_stress(&cases, outboard, slot);
        out.extend(ratio.map(|ratio| (problem.piece_of_slot(slot), ratio)));
    });
    out
}

/// Sentences on the tubes `all`, each with its largest ratio of stress to strength. `whose` are words that say which
/// designs were examined. A tube is named if its ratio breaks the limit of the study; without a limit, if it would fail.
fn sentences(problem: &ArmProblem, all: &[(usize, f64)], whose: &str) -> Vec<String> {
    let space = problem.space();
    let limit = space.constraints.stress_safety_factor_min;
    let tubes = space.pieces.iter().enumerate().rev().filter_map(|(piece, what)| match what {
        SpacePiece::Link(Link { name, body: LinkBody::Tube { material, .. }, .. }) => {
            Some((piece, name, material.strength))
        }
        _ => None,
    });
    let (mut weak, mut of_unknown_strength) = (Vec::new(), Vec::new());
    for (piece, name, strength) in tubes {
        let ratio = all.iter().filter(|(of, _)| *of == piece).map(|(_, ratio)| *ratio).fold(0.0, f64::max);
        if strength.is_none() {
            of_unknown_strength.push(name.clone());
        } else if ratio * limit.unwrap_or(1.0) > 1.0 {
            weak.push(format!("{name} ({} times)", significant(1.0 / ratio, 3)));
        }
    }
    let sentence = |names: Vec<String>, words: String| {
        (!names.is_empty()).then(|| format!("{words}: {}.", names.join(", ")))
    };
    let asked = limit.map_or("at least 1 time".into(), |least| format!("{} times", significant(least, 3)));
    let weak = sentence(
        weak,
        format!(
            "Links that the study gives are stressed too much{whose}, which excludes no design. Strength over stress, \
             instead of {asked}"
        ),
    );
    let unknown = limit.and_then(|_| {
        let words = "Stress not checked in links that the study gives, of unknown strength";
        sentence(of_unknown_strength, words.into())
    });
    weak.into_iter().chain(unknown).collect()
}
