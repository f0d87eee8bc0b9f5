//! The keys of arm files. The reader uses this list, and `armwright schema arm` prints it.

use super::effect::catalogue::NAMES as EFFECTS;
use super::keys::{
    BEARING_VALUE, COUNTERWEIGHTS, COUPLING, EXTRAS, GEAR_AT, GEAR_MASS, GEAR_RATIO, GRAVITY, JOINT_BODIES,
    LINK_BODIES, MASS_FACTOR, MOTOR_AT, MOTOR_MASS, MOTOR_POINT, PIECES, POSITIVE_OR_NULL, SECTION, SPRINGS,
    STATED, STIFFNESS_FACTOR, TRANSMISSION, TRANSMISSION_RULES, TURNS_WITH, VECTOR, WINDUP,
};
use super::prismatic_keys::PRISMATIC;
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
        optional(
            "gravity_m_s2",
            GRAVITY,
            "m/s²",
            "9.81",
            "A number along world -z, 0 for none, or a vector in the world.",
        ),
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
    ],
    &[],
);

/// The keys of a joint.
pub(crate) static JOINT: Shape = Shape::new(
    "joint",
    "A joint: it turns everything after it about its axis.",
    &[
        required("type", Kind::Word(&["joint"]), "-", "Says that this is a joint."),
        required("name", Kind::Name, "-", "Name, unique in the arm."),
        required(
            "axis",
            VECTOR,
            "-",
            "Direction in the frame moved by the joints before it; its length does not matter.",
        ),
        optional(
            "stiffness_nm_per_rad",
            POSITIVE_OR_NULL,
            "N m/rad",
            "the gear's",
            "One stiffness; null is rigid.",
        ),
        optional("windup", Kind::Object(&WINDUP), "-", "the gear's", "The three-segment torsion curve."),
        optional(
            "gear",
            Kind::Text,
            "-",
            "none",
            "A gear of the catalog; gives curve and mass where they are not written.",
        ),
        optional("motor", Kind::Text, "-", "none", "A motor of the catalog; gives its mass."),
        optional("gear_mass", GEAR_MASS, "-", "\"housed_unit\"", "Which mass of the gear counts."),
        optional(
            "mass_kg",
            Kind::NonNegative,
            "kg",
            "gear and motor, else 0",
            "A point on the axis, inboard of the joint.",
        ),
        optional(
            "bearing",
            BEARING_VALUE,
            "-",
            "the gear's, if it is a housed unit",
            "The output bearing: its numbers, the name of a housed gear, or null for a rigid one.",
        ),
        optional(
            "extras",
            Kind::Object(&EXTRAS),
            "kg",
            "none",
            "What the joint weighs beyond drive and bearing.",
        ),
        optional("bodies", JOINT_BODIES, "-", "[]", "Rigid parts with centre and inertia."),
        optional(
            "coupled",
            COUPLING,
            "-",
            "none",
            "A passive joint of a linkage: the factors of the driven joints that turn it.",
        ),
        MOTOR_AT,
        MOTOR_POINT,
        MOTOR_MASS,
        GEAR_AT,
        GEAR_RATIO,
        TRANSMISSION,
        TURNS_WITH,
    ],
    &[
        Rule::Any(&["stiffness_nm_per_rad", "windup", "gear"]),
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
        required("type", Kind::Word(&["link"]), "-", "Says that this is a link."),
        required("name", Kind::Name, "-", "Name, unique in the arm."),
        required("vector_m", VECTOR, "m", "From root to end, in the frame moved by the joints before it."),
        optional(
            "material",
            Kind::Text,
            "-",
            "none",
            "Name of the tube's material, in the file or the catalog.",
        ),
        optional(
            "section",
            SECTION,
            "-",
            "none",
            "The cross-section; without it the link is a rigid offset.",
        ),
        optional("mass_kg", Kind::NonNegative, "kg", "0", "Point mass at mid-length of a rigid offset."),
        optional("bodies", LINK_BODIES, "-", "[]", "Rigid parts with centre and inertia."),
        optional("pieces", PIECES, "-", "none", "Steps and tapers, instead of a section."),
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
