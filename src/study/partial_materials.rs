//! Materials that only some of the open links of a study offer.

use crate::space::design_space::{DesignSpace, SpacePiece};
use std::collections::BTreeMap;

/// For each material that some open links of the study offer and others do not, the names of the links that do not
/// offer it. No design is of such a material alone.
pub(crate) fn links_without(space: &DesignSpace) -> BTreeMap<String, Vec<String>> {
    let lacking = |material: &String| -> Vec<String> {
        let choices = space.pieces.iter().filter_map(SpacePiece::as_choice);
        let lack = choices.filter(|choice| choice.options.iter().all(|o| o.material_name != *material));
        lack.map(|choice| choice.name.clone()).collect()
    };
    let of_some = |material: String| Some(lacking(&material)).filter(|links| !links.is_empty());
    let materials = space.material_names().into_iter();
    materials.filter_map(|material| Some((material.clone(), of_some(material)?))).collect()
}
