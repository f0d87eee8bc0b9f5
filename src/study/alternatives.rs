//! Alternatives to each part of a design: other drives that meet the demand at the same joint, and other tubes.

use crate::arm::file::windup_of;
use crate::arm::structure::Beam;
use crate::arm::{Arm, Element, Link, LinkBody};
use crate::mechanics::beam::line_stiffnesses;
use crate::report::tube::section_size;
use crate::sizing::drive::Drive;
use crate::space::constraint::Constraints;
use crate::space::design::joint_with;
use crate::space::design_space::DesignSpace;
use crate::space::design_space::{LinkChoice, LinkOption, SpaceJoint, SpacePiece};
use crate::space::problem::ArmProblem;

/// For each element of the chain of `arm`, the parts that may stand in the place of its present part. Each item is the
/// name of a part and the element as it would be with this part. `options` are the options of the design, one for each
/// level, tip first. `problem` may have an excerpt of the space; the parts come from the whole space `whole`. `None` if
/// the design is not possible.
pub(super) fn alternatives(
    problem: &ArmProblem,
    whole: &DesignSpace,
    options: &[u32],
    arm: &Arm,
) -> Option<Vec<Vec<(String, Element)>>> {
    let mut others: Vec<Vec<(String, Element)>> = vec![Vec::new(); arm.chain.len()];
    let complete = problem.walk(options, |slot, outboard| {
        let piece = problem.piece_of_slot(slot);
        if let (Some(sized), SpacePiece::Joint(asked)) = (problem.sized_joint(piece), &whole.pieces[piece]) {
            let demand = problem.demand_at(outboard, slot);
            others[piece] = drives(asked, sized.table.all_fits(&demand).map(|i| sized.table.drive(i)));
        }
    });
    complete.ok()?;
    for (piece, what) in whole.pieces.iter().enumerate() {
        if let SpacePiece::Choice(choice) = what {
            others[piece] = tubes(choice, &whole.constraints, &arm.chain[piece]);
        }
    }
    Some(others)
}

/// The element `asked` with each of `drives` (drives that meet the demand, lightest first). Each item is the name of
/// the gear, and the joint as an element with bearing and extras. A drive is listed only if it is stiffer than every
/// lighter one, in a segment of its torsion curve or in its bearing.
fn drives<'c>(asked: &SpaceJoint, drives: impl Iterator<Item = Drive<'c>>) -> Vec<(String, Element)> {
    let mut out: Vec<(String, Element)> = Vec::new();
    let mut kept: Vec<[f64; 4]> = Vec::new();
    for drive in drives {
        let (Some(windup), Some(joint)) = (windup_of(drive.gear), joint_with(asked, &drive)) else {
            continue;
        };
        let tilt = joint.bearing.and_then(|bearing| bearing.tilt_stiffness_nm_per_rad);
        let stiffness =
            [windup.k1_nm_per_rad, windup.k2_nm_per_rad, windup.k3_nm_per_rad, tilt.unwrap_or(f64::INFINITY)];
        if kept.iter().any(|other| other.iter().zip(&stiffness).all(|(other, own)| other >= own)) {
            continue;
        }
        kept.push(stiffness);
        out.push((drive.gear.id.clone(), Element::Joint(joint)));
    }
    out
}

/// The tubes that a link may have and that are no softer than its present tube `now` along either axis of the section,
/// lightest first. A tube is listed only if a force at its end deflects it less than every lighter one: along z, along
/// y, or in the sum of both.
fn tubes(choice: &LinkChoice, limits: &Constraints, now: &Element) -> Vec<(String, Element)> {
    let Element::Link(Link { body: LinkBody::Tube { material, section, .. }, .. }) = now else {
        return Vec::new();
    };
    let length_m = choice.vector_m.norm();
    let now = Beam { material: *material, section: *section, flexibility: 1.0 };
    let [now_z, now_y, _] = end_compliances(&now, length_m);
    let slender_most = limits.wall_slenderness_max.unwrap_or(f64::INFINITY);
    let mut by_mass: Vec<(f64, [f64; 3], &LinkOption)> = choice
        .options
        .iter()
        .filter(|option| option.wall_slenderness() <= slender_most)
        .map(|o| (o.mass_kg_per_m(), end_compliances(&o.beam(), length_m), o))
        .filter(|(_, [along_z, along_y, _], _)| *along_z <= now_z && *along_y <= now_y)
        .collect();
    by_mass.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = [f64::INFINITY; 3];
    by_mass.retain(|(_, compliances, _)| {
        let is_stiffer = compliances.iter().zip(&best).any(|(own, best)| own < best);
        best.iter_mut().zip(compliances).for_each(|(best, own)| *best = best.min(*own));
        is_stiffer
    });
    let named = |(_, _, option): (f64, [f64; 3], &LinkOption)| {
        (section_words(option), Element::Link(choice.link(option)))
    };
    by_mass.into_iter().map(named).collect()
}

/// Deflection of a cantilever by bending and shear, per force at its end \[m/N\]: along z of its section, along y, and
/// the sum of both.
fn end_compliances(beam: &Beam, length_m: f64) -> [f64; 3] {
    let [bending_y, bending_z, shear, ..] = line_stiffnesses(beam);
    let [along_z, along_y] =
        [bending_y, bending_z].map(|bending| length_m.powi(3) / (3.0 * bending) + length_m / shear);
    [along_z, along_y, along_z + along_y]
}

/// Size and material of a tube in words: `60 x 40 x 2 mm Aluminium 6061-T6`.
fn section_words(option: &LinkOption) -> String {
    format!("{} {}", section_size(&option.section), option.material_name)
}
