//! The keys of prismatic joints of a study, and of the screws and racks from which their drives are sized.

use super::drive_keys::{BRAKE, DRIVES};
use crate::arm::keys::POSITIVE_OR_NULL;
use crate::arm::prismatic_keys;
use crate::input::key::{Key, Kind, Rule, Shape, optional, required};

/// The keys of a ball screw, as an object of a study file.
pub(super) static SCREW: Shape =
    Shape::new("screw", "A ball screw with its nut, its shaft of steel.", &SCREW_KEYS, &[]);

/// The keys of a rack, as an object of a study file.
pub(super) static RACK: Shape =
    Shape::new("rack", "A rack with its pinion and the gear at it.", &RACK_KEYS, &[]);

const SCREWS: Kind = Kind::NonEmpty(&SCREW_OBJECT);
const SCREW_OBJECT: Kind = Kind::Object(&SCREW);
const RACKS: Kind = Kind::NonEmpty(&RACK_OBJECT);
const RACK_OBJECT: Kind = Kind::Object(&RACK);

/// The keys of a prismatic joint of a study.
pub(super) static PRISMATIC: Shape = Shape::new(
    "prismatic joint",
    "A joint that slides everything after it along its axis; its drive is given in numbers or sized.",
    &PRISMATIC_KEYS,
    &[
        Rule::Any(&["stiffness_n_per_m", "drive"]),
        Rule::Refuses("drive", &["stiffness_n_per_m"]),
        Rule::Needs("drives", &["drive"]),
        Rule::Needs("screws", &["drive"]),
        Rule::Needs("racks", &["drive"]),
        Rule::Needs("brake", &["drive"]),
    ],
);

const PRISMATIC_KEYS: [Key; 16] = {
    let mut keys = [RANGE_MM; 16];
    let mut i = 0;
    while i < prismatic_keys::KEYS.len() {
        keys[i] = prismatic_keys::KEYS[i];
        i += 1;
    }
    keys[prismatic_keys::STIFFNESS] = optional(
        "stiffness_n_per_m",
        POSITIVE_OR_NULL,
        "N/m",
        "that of the screw or rack",
        "Stiffness of a given drive along the travel; null is rigid.",
    );
    let mut k = 0;
    while k < RAIL_KEYS.len() {
        keys[i + 1 + k] = RAIL_KEYS[k];
        k += 1;
    }
    keys
};

/// Keys of a prismatic joint whose drive is sized.
const RAIL_KEYS: [Key; 6] = [
    optional(
        "drive",
        Kind::Word(&["first_fit"]),
        "-",
        "none",
        "Size it: the lightest pair of a screw or rack and a motor that passes all checks.",
    ),
    optional("screws", SCREWS, "-", "none", "Ball screws to choose from."),
    optional("racks", RACKS, "-", "none", "Racks to choose from."),
    optional(
        "drives",
        Kind::Object(&DRIVES),
        "-",
        "the study's",
        "Which motors it may have; gears do not count.",
    ),
    optional("max_speed_m_s", Kind::Positive, "m/s", "the tip's", "The speed that the joint must reach."),
    BRAKE,
];

const PART_NAME: Key =
    required("name", Kind::Name, "-", "Name, unique among the screws and racks of the joint.");

const PART_EFFICIENCY: Key =
    optional("efficiency", Kind::Positive, "-", "0.9", "Part of the power that arrives, at most 1.");

const PART_FORCE: Key = optional(
    "max_force_n",
    Kind::Positive,
    "N",
    "not checked",
    "Largest force, reached in an emergency stop.",
);

const PART_BACKLASH: Key = optional(
    "backlash_mm",
    Kind::NonNegative,
    "mm",
    "0",
    "Way along the travel from stop to stop without force; results say it where it matters.",
);

/// Keys of a ball screw.
const SCREW_KEYS: [Key; 14] = [
    PART_NAME,
    required("lead_mm", Kind::Positive, "mm", "Way of the nut a turn."),
    required("root_diameter_mm", Kind::Positive, "mm", "Diameter of the shaft at the root of the thread."),
    required("length_mm", Kind::Positive, "mm", "Length between what holds the shaft."),
    optional(
        "ends",
        Kind::Word(&["fixed_free", "supported_supported", "fixed_supported", "fixed_fixed"]),
        "-",
        "\"fixed_supported\"",
        "How the ends of the shaft are held.",
    ),
    optional(
        "dynamic_load_rating_n",
        Kind::Positive,
        "N",
        "life is not checked",
        "Dynamic load rating C of the nut.",
    ),
    PART_FORCE,
    optional("max_speed_rpm", Kind::Positive, "rpm", "the critical speed", "Largest speed for the balls."),
    optional(
        "ratio",
        Kind::Positive,
        "-",
        "1",
        "Turns of the motor per turn of the screw, by a belt or gear between them.",
    ),
    PART_EFFICIENCY,
    PART_BACKLASH,
    optional(
        "nut_stiffness_n_per_m",
        Kind::Positive,
        "N/m",
        "rigid",
        "Stiffness of nut and end bearings in series.",
    ),
    optional(
        "inertia_kgm2",
        Kind::NonNegative,
        "kg m²",
        "0",
        "Moment of inertia beyond that of the shaft, at the screw.",
    ),
    optional(
        "mass_kg",
        Kind::NonNegative,
        "kg",
        "0",
        "Mass beyond that of the shaft, which stays where the joint begins.",
    ),
];

/// Keys of a rack.
const RACK_KEYS: [Key; 10] = [
    PART_NAME,
    required("pinion_radius_mm", Kind::Positive, "mm", "Pitch radius of the pinion."),
    optional("ratio", Kind::Positive, "-", "1", "Turns of the motor per turn of the pinion."),
    PART_EFFICIENCY,
    PART_BACKLASH,
    PART_FORCE,
    optional("max_speed_rpm", Kind::Positive, "rpm", "not checked", "Largest speed of the motor's side."),
    required("stiffness_n_per_m", Kind::Positive, "N/m", "Stiffness along the travel."),
    optional("inertia_kgm2", Kind::NonNegative, "kg m²", "0", "Moment of inertia at the motor."),
    optional("mass_kg", Kind::NonNegative, "kg", "0", "Mass, which stays where the joint begins."),
];

const RANGE_MM: Key = optional(
    "range_mm",
    Kind::Array(2, &Kind::Number),
    "mm",
    "the travels of the poses",
    "Smallest and largest travel of the joint.",
);

/// Keys that name catalog parts of a drive. A prismatic joint must not have them.
pub(super) const OF_CATALOG_DRIVE: [&str; 2] = ["gear", "motor"];
