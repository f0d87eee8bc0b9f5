//! Properties of a link option that do not depend on the pose: mass, cost, slenderness of the wall and stress
//! factors.

use super::design_space::{DesignSpace, LinkOption};
use crate::mechanics::link_stress::StressCheck;

/// Properties of a link option on which the limits and the objectives of a study depend, in addition to stiffness and
/// inertia.
pub(crate) struct OptionAttributes {
    /// Mass of the link \[kg\].
    pub mass_kg: f64,
    /// Index of the material in the study's list. `None` for a tube that the study gives: it has no influence on the
    /// group (material) of a design.
    pub material: Option<usize>,
    /// Cost of the material \[EUR\]; `None` if unknown.
    pub cost_eur: Option<f64>,
    /// Factors from which the stress in the link is computed; `None` if the strength of the material is unknown.
    pub stress: Option<StressCheck>,
    /// Whether the wall is more slender than the study allows.
    pub slender: bool,
}

/// The properties of a link of the length `length_m` \[m\] with the material and section of `option`. The limit of
/// `space` on the slenderness of walls is checked.
pub(crate) fn attributes_of(space: &DesignSpace, option: &LinkOption, length_m: f64) -> OptionAttributes {
    let mass_kg = option.mass_kg_per_m() * length_m;
    OptionAttributes {
        slender: space.constraints.wall_slenderness_max.is_some_and(|max| option.wall_slenderness() > max),
        mass_kg,
        material: Some(option.material_index),
        cost_eur: option.cost_eur_per_kg.map(|cost| cost * mass_kg),
        stress: StressCheck::new(&option.material, &option.section),
    }
}
