//! The keys of arm files. The reader uses this list, and `armwright schema arm` prints it.

use super::effect::catalogue::NAMES as EFFECTS;
use super::keys::{
    COUNTERWEIGHTS, EXTRAS, GEAR_AT, GEAR_RATIO, GRAVITY, MASS_FACTOR, MOTOR_AT, MOTOR_MASS, MOTOR_POINT,
    SPRINGS, STATED, STIFFNESS_FACTOR, TRANSMISSION, TRANSMISSION_RULES, TURNS_WITH,
};
use super::prismatic_keys::PRISMATIC;
use super::shared_keys::{
    AXIS, BODIES_OF_JOINT, BODIES_OF_LINK, COUPLED, GEAR, IS_JOINT, IS_LINK, LINK_MASS, LINK_PIECES,
    LINK_SECTION, LINK_VECTOR, MOTOR, NAME, OUTPUT_BEARING, STIFFNESS, TORSION_CURVE, WHICH_GEAR_MASS,
};
use crate::catalog::material::MaterialClass;
use crate::input::key::{Kind, Rule, SCHEMA_ADDRESS, Shape, optional, required};
use crate::input::schema::FileKind;

/// The format of an arm file.
pub const ARM_FILE: FileKind =
    FileKind { name: "arm", about: "An arm from base to tip.", root: Kind::Object(&ARM) };

/// A list of effects.
pub(crate) const EFFECT_LIST: Kind = Kind::List(&Kind::Object(&EFFECT));
/// The keys of an arm.
pub(crate) static ARM: Shape = Shape::new(
    "arm",
    "An arm: joints and links from base to tip.",
    &[
        SCHEMA_ADDRESS,
        optional("name", Kind::Text, "-", "\"arm\"", "Name of the arm."),
        GRAVITY,
        optional(
            "materials",
            Kind::Map(&Kind::Object(&MATERIAL)),
            "-",
            "{}",
            "Materials of this file by name; other names are looked up in the catalog.",
        ),
        required(
            "chain",
            Kind::NonEmpty(&Kind::Either(&[
                Kind::Object(&JOINT),
                Kind::Object(&PRISMATIC),
                Kind::Object(&LINK),
            ])),
            "-",
            "Joints, prismatic joints and links from base to tip.",
        ),
        optional("effects", EFFECT_LIST, "-", "[]", "Physics beyond the nominal model."),
        optional("springs", SPRINGS, "-", "[]", "Springs that balance the arm."),
        optional("counterweights", COUNTERWEIGHTS, "-", "[]", "Point masses that balance the arm."),
        optional("provenance", Kind::Anything, "-", "none", "Anything; kept for people."),
    ],
    &[],
);

/// The keys of a material.
pub(crate) static MATERIAL: Shape = Shape::new(
    "material",
    "A material of the links.",
    &[
        required("youngs_modulus_pa", Kind::Positive, "Pa", "Young's modulus E along the link."),
        required("shear_modulus_pa", Kind::Positive, "Pa", "Shear modulus G."),
        required("density_kg_m3", Kind::Positive, "kg/m³", "Density."),
        optional(
            "poisson",
            Kind::Range(-1.0, 0.5),
            "-",
            "0.3",
            "Poisson's ratio, used in the shear factor only.",
        ),
        optional(
            "strength_pa",
            Kind::Positive,
            "Pa",
            "none",
            "Strength along the link, the lower of tension and compression. `analyze` and `capacity` compare the stress at rest with it.",
        ),
        optional(
            "shear_strength_pa",
            Kind::Positive,
            "Pa",
            "strength_pa / √3",
            "Strength in shear of a material whose fibres run along the link (Tsai and Hill).",
        ),
        optional(
            "class",
            Kind::Word(&MaterialClass::WORDS),
            "-",
            "that of the catalog's material of this name",
            "Class of the material; a report says which classes creep. No number depends on it.",
        ),
    ],
    &[],
);

/// The keys of a joint.
pub(crate) static JOINT: Shape = Shape::new(
    "joint",
    "A joint: it turns everything after it about its axis.",
    &[
        IS_JOINT,
        NAME,
        AXIS,
        STIFFNESS,
        TORSION_CURVE,
        GEAR,
        MOTOR,
        WHICH_GEAR_MASS,
        optional(
            "mass_kg",
            Kind::NonNegative,
            "kg",
            "gear and motor, else 0",
            "A point on the axis, inboard of the joint.",
        ),
        OUTPUT_BEARING,
        optional(
            "extras",
            Kind::Object(&EXTRAS),
            "kg",
            "none",
            "What the joint weighs beyond drive and bearing.",
        ),
        BODIES_OF_JOINT,
        COUPLED,
        MOTOR_AT,
        MOTOR_POINT,
        MOTOR_MASS,
        GEAR_AT,
        GEAR_RATIO,
        TRANSMISSION,
        TURNS_WITH,
    ],
    &[
        Rule::Any(&["stiffness_nm_per_rad", "windup", "gear", "coupled"]),
        Rule::Refuses("stiffness_nm_per_rad", &["windup"]),
        TRANSMISSION_RULES[0],
        TRANSMISSION_RULES[1],
        TRANSMISSION_RULES[2],
        TRANSMISSION_RULES[3],
    ],
);

/// The keys of a link.
pub(crate) static LINK: Shape = Shape::new(
    "link",
    "A link: a tube or bar, or a rigid offset if it has no section.",
    &[
        IS_LINK,
        NAME,
        LINK_VECTOR,
        optional(
            "material",
            Kind::Text,
            "-",
            "none",
            "Name of the tube's material, in the file or the catalog.",
        ),
        LINK_SECTION,
        LINK_MASS,
        BODIES_OF_LINK,
        LINK_PIECES,
        STIFFNESS_FACTOR,
        MASS_FACTOR,
    ],
    &GIVEN_LINK_RULES,
);

/// Rules for the keys of a link that is given, not chosen by the search.
pub(crate) const GIVEN_LINK_RULES: [Rule; 6] = [
    Rule::Refuses("mass_kg", &["section"]),
    Rule::Refuses("pieces", &["section", "mass_kg", "stiffness_factor", "mass_factor"]),
    Rule::Needs("stiffness_factor", &["section"]),
    Rule::Needs("mass_factor", &["section"]),
    Rule::Needs("material", &["section", "pieces"]),
    Rule::When {
        key: "section",
        is: Kind::Object(&STATED),
        then: [&[], &["material"]],
        otherwise: [&["material"], &[]],
    },
];

/// The keys of an effect.
pub(crate) static EFFECT: Shape = Shape::new(
    "effect",
    "Physics beyond the nominal model; docs/effects describes each.",
    &[
        required("effect", Kind::Word(&EFFECTS), "-", "Name of the effect."),
        required("at", Kind::Text, "-", "Where it sits: a joint, a link, base, payload, arm or a channel."),
        required(
            "parameters",
            Kind::Object(&PARAMETERS),
            "-",
            "Its numbers by name, with the unit in the name.",
        ),
        optional("source", Kind::Anything, "-", "none", "Where they come from; kept as written."),
    ],
    &[],
);

static PARAMETERS: Shape = Shape {
    name: "parameters",
    about: "The numbers of an effect by name; a vector is a list.",
    keys: &[optional(
        "channel",
        Kind::Word(&["static", "modal", "windup", "positions"]),
        "-",
        "none",
        "The kind of readings, of effects that belong to one.",
    )],
    rules: &[],
    others: Some(&Kind::Either(&[Kind::Number, Kind::List(&Kind::Number)])),
};
