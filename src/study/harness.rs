//! Cables and hoses along the links of a study.

use crate::arm::effect::entry::Effect;
use crate::space::design_space::{DesignSpace, SpacePiece};
use serde_json::json;

/// Name of the effect that adds them.
const EFFECT: &str = "harness_mass";

/// A harness of a mass per length \[kg/m\] along every link, as effects. A link for which the study has an effect of its own keeps
/// that.
pub(super) fn harness_effects(pieces: &[SpacePiece], kg_per_m: f64, own: &[Effect]) -> Vec<Effect> {
    let has_own = |link: &str| own.iter().any(|effect| effect.effect == EFFECT && effect.at == link);
    let links = pieces.iter().filter_map(|piece| match piece {
        SpacePiece::Joint(_) => None,
        SpacePiece::Link(link) => Some((&link.name, link.vector_m.norm())),
        SpacePiece::Choice(choice) => Some((&choice.name, choice.vector_m.norm())),
    });
    let carrying = links.filter(|(name, length_m)| kg_per_m > 0.0 && *length_m > 0.0 && !has_own(name));
    let effect = |(name, _): (&String, f64)| Effect {
        effect: EFFECT.to_string(),
        at: name.clone(),
        parameters: vec![("kg_per_m".to_string(), vec![kg_per_m])],
        source: Some(json!("harness_kg_per_m of the study")),
    };
    carrying.map(effect).collect()
}

/// Whether some link carries cables.
pub(super) fn has_harness(space: &DesignSpace) -> bool {
    space.effects.iter().any(|effect| effect.effect == EFFECT)
}

/// What the harness along every link weighs, in a sentence; `None` without one.
pub(super) fn harness_remark(space: &DesignSpace, kg_per_m: f64) -> Option<String> {
    let without = space.effects.iter().filter(|effect| effect.effect != EFFECT).cloned().collect();
    let without = DesignSpace { effects: without, ..space.clone() };
    let harness_kg = space.effects_mass_kg() - without.effects_mass_kg();
    (kg_per_m > 0.0).then(|| {
        format!(
            "A harness of {kg_per_m} kg/m along every link, {harness_kg:.2} kg in all, loads the arm and its drives; it is no part \
             of mass_kg."
        )
    })
}
