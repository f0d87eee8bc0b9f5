//! Cables and hoses along the links of a study.

use crate::arm::effect::entry::Effect;
use crate::arm::effect::harness_mass;
use crate::space::design_space::{DesignSpace, SpacePiece};
use serde_json::json;

/// Name of the effect that adds cables and hoses to a link.
const EFFECT: &str = harness_mass::KIND.name;

/// The effects that add cables and hoses of `kg_per_m` \[kg/m\] along every link. A link that already has such an
/// effect in `own`, the study's effects, keeps that one.
pub(super) fn harness_effects(pieces: &[SpacePiece], kg_per_m: f64, own: &[Effect]) -> Vec<Effect> {
    let has_own = |link: &str| own.iter().any(|effect| effect.effect == EFFECT && effect.at == link);
    let links = pieces.iter().filter_map(|piece| match piece {
        SpacePiece::Joint(_) | SpacePiece::Prismatic(_) => None,
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

/// Whether some link has a harness.
pub(super) fn has_harness(space: &DesignSpace) -> bool {
    space.effects.iter().any(|effect| effect.effect == EFFECT)
}

/// The mass of cables and hoses along all links, in a sentence; `None` if the study states none.
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

#[cfg(test)]
mod tests {
    use super::harness_mass;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::space::evaluate;
    use crate::space::problem::ArmProblem;
    use crate::study::definition::Study;
    use crate::study::read::read_study;
    use serde_json::{Value, json};

    fn read(extra: Value) -> Study {
        let mut study = json!({"name": "cables", "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "gear": "CSG-32-100", "motor": "ILM85x26", "mass_kg": 4},
            {"type": "link", "name": "bracket", "vector_m": [0.1, 0, 0]},
            {"type": "link", "name": "arm", "vector_m": [0.6, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
                "sections": [{"shape": "round_tube", "diameter_mm": 60, "wall_mm": 2}]}}],
            "poses": [{"pose_deg": [0]}]});
        study.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
        read_study(Document::parse("study", &study.to_string()).unwrap(), &Catalogs::builtin()).unwrap()
    }

    #[test]
    fn cables_along_every_link_are_the_effect_at_every_link() {
        let effect = |at: &str, kg_per_m: f64| json!({"effect": harness_mass::KIND.name, "at": at, "parameters": {"kg_per_m": kg_per_m}});
        let catalogs = Catalogs::builtin();
        let judge =
            |extra: Value| evaluate(&ArmProblem::new(&read(extra).space, &catalogs), 0).unwrap().objectives;
        let by_key = judge(json!({"harness_kg_per_m": 0.5}));
        assert_eq!(by_key, judge(json!({"effects": [effect("bracket", 0.5), effect("arm", 0.5)]})));
        assert!(by_key.tip_deflection_m > 1.05 * judge(json!({})).tip_deflection_m);
        // a link keeps its own harness effect
        let own = json!({"harness_kg_per_m": 0.5, "effects": [effect("arm", 2.0)]});
        assert_eq!(judge(own), judge(json!({"effects": [effect("arm", 2.0), effect("bracket", 0.5)]})));
    }

    #[test]
    fn what_the_harness_weighs_is_said_and_cables_are_no_longer_left_out() {
        let [with, without] =
            [json!({"harness_kg_per_m": 0.5}), json!({})].map(|extra| read(extra).remarks.join(" "));
        assert!(with.contains("A harness of 0.5 kg/m along every link, 0.35 kg in all"), "{with}");
        assert!(
            !with.contains("the cables along the links") && without.contains("the cables along the links")
        );
    }
}
