//! What a reader should know of the analysis of an arm besides its numbers.

use super::creep::creep_sentence;
use crate::arm::effect::entry::Effect;
use crate::arm::pieces::factors_sentence;
use crate::arm::{Arm, Element, Link, LinkBody};
use crate::catalog::Catalogs;

/// What an analysis leaves out of every number of an arm with gears.
const LEFT_OUT: &str = "Left out of every number, unless the file states it: the compliance of the connections between links and \
    joints, and the cables along the links. Also temperature, and whether the parts fit into each other.";

/// Remarks on the analysis of an arm, in sentences: on links of materials that creep, on links with stated factors, and
/// on what is left out of every number.
pub fn arm_remarks(arm: &Arm, catalogs: &Catalogs) -> Vec<String> {
    let has_gear = |element: &Element| matches!(element, Element::Joint(joint) if joint.gear.is_some());
    let left_out = arm.chain.iter().any(has_gear).then(|| LEFT_OUT.to_string());
    creep_sentences(arm, catalogs).into_iter().chain(left_out).collect()
}

/// The names of the effects that an analysis ignores because they describe a test and not the arm, in words; `None` if
/// there are none.
pub fn ignored_words(arm: &Arm) -> Option<String> {
    let effects: Vec<String> = arm.ignored_effects().into_iter().map(Effect::label).collect();
    (!effects.is_empty())
        .then(|| format!("ignored, because they describe a test and not the arm: {}", effects.join(", ")))
}

fn creep_sentences(arm: &Arm, catalogs: &Catalogs) -> Vec<String> {
    let tubes = arm.chain.iter().filter_map(|element| match element {
        Element::Link(Link { name, body: LinkBody::Tube { material_name, .. }, .. }) => {
            Some((material_name.as_str(), name.as_str()))
        }
        _ => None,
    });
    let tubes: Vec<(&str, &str)> = tubes.collect();
    let creep = tubes.iter().filter_map(|(material, link)| creep_sentence(catalogs, material, link));
    creep.chain(factors_sentence(tubes.iter().copied())).collect()
}
