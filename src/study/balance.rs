//! Springs and counterweights of a study, and remarks on them.

use super::balance_choices::{MOST_CHOICES, number_of_choices};
use crate::arm::springs::Spring;
use crate::arm::springs_file::{BodiesOf, Named, Values, hang, read_counterweights, read_springs};
use crate::input::json::Object;
use crate::space::design_space::{DesignSpace, SpacePiece};

/// Reads the springs of a study from `root`, and adds its counterweights as bodies to the pieces on which they sit.
/// Returns `None` after recording a fault.
pub(super) fn read_balance(root: &Object, pieces: &mut [SpacePiece]) -> Option<Vec<Spring>> {
    let named: Vec<Named> = pieces.iter().map(|p| (p.name(), matches!(p, SpacePiece::Joint(_)))).collect();
    let springs = read_springs(root, &named, Values::Choices);
    let counterweights = read_counterweights(root, &named, Values::Choices);
    let bodies = pieces.iter_mut().map(|piece| match piece {
        SpacePiece::Joint(joint) => BodiesOf::Joint(&mut joint.bodies),
        SpacePiece::Prismatic(slide) => BodiesOf::Joint(&mut slide.joint.bodies),
        SpacePiece::Link(link) => BodiesOf::Link(&mut link.bodies),
        SpacePiece::Choice(choice) => BodiesOf::Link(&mut choice.bodies),
    });
    hang(counterweights?, bodies.collect());
    pieces.iter_mut().for_each(|piece| {
        if let SpacePiece::Prismatic(slide) = piece {
            slide.collect_bodies();
        }
    });
    springs
}

/// Reads the number of choices of springs and counterweights that a study leaves open; 1 if it leaves none open.
/// Returns `None` after recording a fault.
pub(super) fn read_number_of_choices(root: &Object) -> Option<usize> {
    match root.node().value().as_object().map_or(1, number_of_choices) {
        many if many > MOST_CHOICES => root.node().fault(
            format!("has {many} choices of springs and counterweights"),
            &format!("leave at most {MOST_CHOICES}, because each is searched by itself"),
        ),
        choices => Some(choices),
    }
}

/// Remarks that results print with the numbers of an arm with springs; empty without springs.
pub(super) fn balance_remarks(space: &DesignSpace) -> Vec<String> {
    if space.springs.is_empty() {
        return Vec::new();
    }
    let loaded = |&case: &usize| space.cases[case].payload.mass_kg > 0.0;
    let one_load = space.sizing_cases.iter().all(loaded).then(|| {
        "Springs push hardest against a joint whose arm is empty, and every sizing pose holds the payload: state a pose with \
         \"payload\": {\"mass_kg\": 0} too."
            .to_string()
    });
    let stiffness = "Springs count in torques, stresses and deflection by their force in the pose as it is without deflection. \
                     The stiffness that they add to modes is left out, and so is their mass: state it as a body."
        .to_string();
    one_load.into_iter().chain([stiffness]).collect()
}
