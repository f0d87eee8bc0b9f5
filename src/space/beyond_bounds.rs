//! Features of a design space that the bounds of the searches do not cover, in words. A search or a check that rests
//! on bounds refuses a space with such features, or says that it has them.

use super::design_space::{DesignSpace, SpacePiece};
use crate::arm::effect::entry::Effect;

impl DesignSpace {
    /// Whether the drive of a prismatic joint is sized.
    fn sizes_rails(&self) -> bool {
        self.pieces.iter().any(|piece| matches!(piece, SpacePiece::Prismatic(slide) if slide.drive.is_some()))
    }

    /// Names the features of this space that the bounds of the exact search do not cover. `None` if the bounds cover
    /// the whole space.
    pub(crate) fn beyond_exact(&self) -> Option<String> {
        let is_known =
            |effect: &&Effect| effect.is_of_test() || effect.kind().is_none_or(|kind| kind.traits.in_bounds);
        let law = self.effects.iter().find(|effect| !is_known(effect)).map(Effect::label);
        let motors = match (self.sizes_rails(), self.has_motors_elsewhere()) {
            (true, _) => Some("rails whose drive is sized".to_string()),
            (false, elsewhere) => elsewhere.then(|| "motors that sit elsewhere than their joints".into()),
        };
        let turns = self.has_linkages().then(|| "joints that turn with others".to_string());
        in_words([in_words([turns, motors]), law])
    }

    /// Names the features of this space that the bounds of the verifier and of the linear program (relaxation) do not
    /// cover. `None` if the bounds cover the whole space.
    pub fn beyond_bounds(&self) -> Option<String> {
        in_words([self.beyond_exact(), (!self.springs.is_empty()).then(|| "springs".into())])
    }
}

/// Joins the texts in `list` that are present by "and". `None` if there is none.
fn in_words(list: [Option<String>; 2]) -> Option<String> {
    let words: Vec<String> = list.into_iter().flatten().collect();
    (!words.is_empty()).then(|| words.join(" and "))
}
