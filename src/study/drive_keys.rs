//! The keys of `drives`, which select the parts from which drives are sized.

use super::motor_kinds::MOTOR_WORDS;
use crate::arm::keys::GEAR_MASS;
use crate::catalog::gear::GearKind;
use crate::input::key::{Key, Kind, Shape, optional, words_of};

const TEXTS: Kind = Kind::List(&Kind::Text);

/// The key that says whether a sized joint has a brake.
pub(super) const BRAKE: Key = optional(
    "brake",
    Kind::Flag,
    "-",
    "false",
    "Whether a brake holds the joint at rest; then its motor need not.",
);

/// The keys of `drives`, which select the catalog parts that may be chosen.
pub(super) static DRIVES: Shape = Shape::new(
    "drives",
    "Which catalog parts may be chosen; a part must pass every filter given.",
    &[
        optional("gear_series", TEXTS, "-", "all", "Series of gears."),
        optional("gears", TEXTS, "-", "all", "Single gears by name."),
        optional(
            "gear_kinds",
            Kind::List(&Kind::Word(&GearKind::WORDS)),
            "-",
            "strain_wave; all if gears or series are named",
            "Kinds of gears.",
        ),
        optional("ratios", Kind::List(&Kind::Positive), "-", "all", "Ratios of gears."),
        optional("gear_mass", GEAR_MASS, "-", "\"housed_unit\"", "Which mass of a gear counts."),
        optional(
            "actuators",
            Kind::Either(&[Kind::Word(&["all"]), TEXTS]),
            "-",
            "none",
            "Models of actuators, or all of them.",
        ),
        optional(
            "motors",
            Kind::List(&Kind::Word(&words_of::<_, 7>(&MOTOR_WORDS))),
            "-",
            "all but steppers",
            "Kinds of motors.",
        ),
        optional("motor_models", TEXTS, "-", "all", "Single motors by name."),
    ],
    &[],
);
