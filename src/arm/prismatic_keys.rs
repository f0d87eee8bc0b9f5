//! The keys of prismatic joints, in arm files and in studies.

use super::keys::{BODY_INERTIA, BODY_MASS, POSITIVE_OR_NULL, VECTOR};
use super::shared_keys::NAME;
use crate::input::key::{Key, Kind, Rule, Shape, optional, required};

/// A list of bodies of a prismatic joint.
const PRISMATIC_BODIES: Kind = Kind::List(&Kind::Object(&PRISMATIC_BODY));

/// The key for the stiffness of the drive along the travel.
pub(crate) const DRIVE_STIFFNESS: Key = required(
    "stiffness_n_per_m",
    POSITIVE_OR_NULL,
    "N/m",
    "Stiffness of the drive along the travel; null is rigid.",
);

/// The key for the stiffnesses of the guide and the loads that it holds.
pub(crate) const GUIDE_STIFFNESSES: Key =
    optional("guide", Kind::Object(&GUIDE), "-", "rigid", "Stiffnesses of the guide, and what it holds.");

/// The key that says whether the springs of the guide travel.
pub(crate) const MOVES: Key = optional(
    "moves",
    Kind::Word(&["carriage", "ram"]),
    "-",
    "\"carriage\"",
    "Whether the springs of the guide travel (carriage) or stay (ram).",
);

/// Index in [`KEYS`] of the key for the stiffness of the drive.
pub(crate) const STIFFNESS: usize = 3;

/// The keys of a prismatic joint in an arm file; a study has more.
pub(crate) const KEYS: [Key; 9] = [
    required("type", Kind::Word(&["prismatic"]), "-", "Says that this is a prismatic joint."),
    NAME,
    required(
        "axis",
        VECTOR,
        "-",
        "Direction of the travel in the frame moved by the joints before it; its length does not matter.",
    ),
    DRIVE_STIFFNESS,
    GUIDE_STIFFNESSES,
    MOVES,
    optional("mass_kg", Kind::NonNegative, "kg", "0", "What travels: a point at the moved point."),
    optional("fixed_mass_kg", Kind::NonNegative, "kg", "0", "What stays: a point where the joint begins."),
    optional("bodies", PRISMATIC_BODIES, "-", "[]", "Rigid parts with centre and inertia."),
];

/// The keys of a prismatic joint of an arm file.
pub(crate) static PRISMATIC: Shape = Shape::new(
    "prismatic joint",
    "A joint that slides everything after it along its axis.",
    &ARM_KEYS,
    &[
        Rule::Needs("gear", &["gear_mass_kg"]),
        Rule::Needs("gear_mass_kg", &["gear"]),
        Rule::Needs("motor", &["motor_mass_kg"]),
        Rule::Needs("motor_mass_kg", &["motor"]),
    ],
);

const ARM_KEYS: [Key; KEYS.len() + PART_KEYS.len()] = {
    let mut keys = [NAME; KEYS.len() + PART_KEYS.len()];
    let mut i = 0;
    while i < keys.len() {
        keys[i] = if i < KEYS.len() { KEYS[i] } else { PART_KEYS[i - KEYS.len()] };
        i += 1;
    }
    keys
};

/// The keys that name the parts of the drive, in an arm file. A study has lists of parts to choose from instead.
const PART_KEYS: [Key; 4] = [
    optional("gear", Kind::Name, "-", "none", "Name of the screw or rack, for the bill of materials."),
    optional(
        "gear_mass_kg",
        Kind::NonNegative,
        "kg",
        "none",
        "Mass of the screw or rack, a part of fixed_mass_kg.",
    ),
    optional("motor", Kind::Name, "-", "none", "Name of the motor, for the bill of materials."),
    optional("motor_mass_kg", Kind::NonNegative, "kg", "none", "Mass of the motor, a part of fixed_mass_kg."),
];

/// The keys of the guide of a prismatic joint.
pub(crate) static GUIDE: Shape = Shape::new(
    "guide",
    "The guide of a prismatic joint, rigid about an axis that is left away.",
    &[
        optional("roll_nm_per_rad", POSITIVE_OR_NULL, "N m/rad", "null", "About the travel."),
        optional(
            "pitch_nm_per_rad",
            POSITIVE_OR_NULL,
            "N m/rad",
            "null",
            "About the y of a section frame whose x is the travel.",
        ),
        optional("yaw_nm_per_rad", POSITIVE_OR_NULL, "N m/rad", "null", "About the z of this frame."),
        optional(
            "max_force_n",
            Kind::Positive,
            "N",
            "unknown",
            "Force across the travel that the guide holds alone: the maker's rating over the safety factor that it asks for.",
        ),
        optional(
            "max_roll_nm",
            Kind::Positive,
            "N m",
            "unknown",
            "Moment about the travel that it holds alone.",
        ),
        optional("max_pitch_nm", Kind::Positive, "N m", "unknown", "Moment about the y that it holds alone."),
        optional("max_yaw_nm", Kind::Positive, "N m", "unknown", "Moment about the z that it holds alone."),
    ],
    &[],
);

/// The keys of a body of a prismatic joint.
pub(crate) static PRISMATIC_BODY: Shape = Shape::new(
    "body of a prismatic joint",
    "A rigid part of a prismatic joint.",
    &[
        BODY_MASS,
        optional(
            "cg_m",
            VECTOR,
            "m",
            "[0, 0, 0]",
            "Centre of gravity from the moved point, of a body that stays from where the joint begins.",
        ),
        BODY_INERTIA,
        optional("travels", Kind::Flag, "-", "false", "Whether the body travels, outboard of the springs."),
    ],
    &[],
);
