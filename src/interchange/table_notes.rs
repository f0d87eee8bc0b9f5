//! Notes that name the properties of an arm that its tables `design.csv` and `bom.csv` do not show.

use crate::arm::{Arm, Element, Extras, LinkBody, Section};

/// A note that names the properties of the arm for which `design.csv` has no columns; `None` if the arm has no such
/// properties.
pub(super) fn not_in_design_table(arm: &Arm) -> Option<String> {
    let joints = |has: &dyn Fn(&crate::arm::Joint) -> bool| -> Vec<String> {
        arm.joints().filter(|joint| has(joint)).map(|joint| joint.name.clone()).collect()
    };
    let guides = arm.prismatics().filter(|joint| joint.guide.stiffnesses().iter().any(Option::is_some));
    let with_bodies = arm.chain.iter().filter(|element| has_bodies(element));
    let stated = arm.links().filter(
        |link| matches!(&link.body, LinkBody::Tube { section, .. } if matches!(section, Section::Stated(_))),
    );
    let parts = [
        ("springs", names_of_springs(arm)),
        ("guides and masses that travel of", guides.map(|joint| joint.name.clone()).collect()),
        (
            "places and inertia of the bodies of",
            with_bodies.map(|element| element.name().to_string()).collect(),
        ),
        ("stiffnesses of the sections of", stated.map(|link| link.name.clone()).collect()),
        ("ratings and places of the bearings of", joints(&|joint| joint.bearing.is_some())),
        ("extras of", joints(&|joint| joint.extras != Extras::default())),
        ("stages of", joints(&|joint| joint.stages != Default::default())),
        ("turns_with of", joints(&|joint| !joint.turns_with.is_empty())),
        ("effects", names_of_effects(arm)),
    ];
    sentence("design.csv", &parts)
}

/// A note that names the properties of the arm for which `bom.csv` has no row; `None` if the arm has no such
/// properties. `effects_mass_kg` is the mass that effects add.
pub(super) fn not_in_bill(arm: &Arm, effects_mass_kg: f64) -> Option<String> {
    let added = match effects_mass_kg == 0.0 {
        true => Vec::new(),
        false => vec![format!("{effects_mass_kg} kg ({})", names_of_effects(arm).join(", "))],
    };
    sentence("bom.csv", &[("springs", names_of_springs(arm)), ("what effects add to the mass,", added)])
}

fn sentence(file: &str, parts: &[(&str, Vec<String>)]) -> Option<String> {
    let present = parts.iter().filter(|(_, names)| !names.is_empty());
    let words: Vec<String> = present.map(|(what, names)| format!("{what} {}", names.join(", "))).collect();
    (!words.is_empty()).then(|| format!("{file} does not have (--to json does): {}", words.join("; ")))
}

fn has_bodies(element: &Element) -> bool {
    match element {
        Element::Joint(joint) => joint.bodies.iter().next().is_some(),
        Element::Prismatic(joint) => joint.bodies.iter().next().is_some(),
        Element::Link(link) => !link.bodies.is_empty(),
    }
}

fn names_of_springs(arm: &Arm) -> Vec<String> {
    arm.springs.iter().map(|spring| spring.name.clone()).collect()
}

fn names_of_effects(arm: &Arm) -> Vec<String> {
    let ignored = arm.ignored_effects();
    arm.effects.iter().filter(|effect| !ignored.contains(effect)).map(|effect| effect.label()).collect()
}
