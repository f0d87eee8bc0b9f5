//! The keys of prismatic joints, in arm files and in studies.

use super::keys::{BODY_INERTIA, BODY_MASS, POSITIVE_OR_NULL, VECTOR};
use super::shared_keys::NAME;
use crate::input::key::{Key, Kind, Shape, optional, required};

/// A list of bodies of a prismatic joint.
const PRISMATIC_BODIES: Kind = Kind::List(&Kind::Object(&PRISMATIC_BODY));

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
    required(
        "stiffness_n_per_m",
        POSITIVE_OR_NULL,
        "N/m",
        "Stiffness of the drive along the travel; null is rigid.",
    ),
    optional("guide", Kind::Object(&GUIDE), "N m/rad", "rigid", "Stiffnesses of the guide."),
    optional(
        "moves",
        Kind::Word(&["carriage", "ram"]),
        "-",
        "\"carriage\"",
        "Whether the springs of the guide travel (carriage) or stay (ram).",
    ),
    optional("mass_kg", Kind::NonNegative, "kg", "0", "What travels: a point at the moved point."),
    optional("fixed_mass_kg", Kind::NonNegative, "kg", "0", "What stays: a point where the joint begins."),
    optional("bodies", PRISMATIC_BODIES, "-", "[]", "Rigid parts with centre and inertia."),
];

/// The keys of a prismatic joint of an arm file.
pub(crate) static PRISMATIC: Shape =
    Shape::new("prismatic joint", "A joint that slides everything after it along its axis.", &KEYS, &[]);

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
