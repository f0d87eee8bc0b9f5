//! The keys of an open link: its materials and its families of sections.

use crate::catalog::profile::ProfileShape;
use crate::input::key::{Key, Kind, Shape, optional, required};

/// The keys of `choose`, the options of an open link.
pub(super) static CHOOSE: Shape = Shape::new(
    "choose",
    "The options of an open link: every pair of a material and a section.",
    &[
        required("materials", Kind::NonEmpty(&Kind::Text), "-", "Names of materials of the catalog."),
        required(
            "sections",
            Kind::List(&Kind::Either(&[
                Kind::Object(&RECTANGULAR_TUBES),
                Kind::Object(&ROUND_TUBES),
                Kind::Object(&RECTANGULAR_BARS),
                Kind::Object(&ROUND_BARS),
                Kind::Object(&PROFILES),
            ])),
            "-",
            "Families of sections.",
        ),
    ],
    &[],
);

const SIZES: Kind = Kind::Either(&[Kind::Positive, Kind::List(&Kind::Positive), Kind::Object(&GRID)]);

/// The keys of a grid of sizes.
pub(super) static GRID: Shape = Shape::new(
    "grid",
    "Sizes from one to another by a step, ends included.",
    &[
        required("from", Kind::Positive, "mm", "The smallest."),
        required("to", Kind::Positive, "mm", "The largest."),
        required("step", Kind::Positive, "mm", "The step."),
    ],
    &[],
);

const HEIGHT_SIZES: Kind = Kind::Either(&[SIZES, Kind::Word(&["=width"])]);

const WIDTHS: Key = required("width_mm", SIZES, "mm", "Outer width, along the section's y.");
const HEIGHTS: Key =
    optional("height_mm", HEIGHT_SIZES, "mm", "\"=width\"", "Outer height, along the section's z.");
const WALLS: Key =
    required("wall_mm", SIZES, "mm", "Thickness of the wall; one that leaves no hollow is skipped.");
const DIAMETERS: Key = required("diameter_mm", SIZES, "mm", "Outer diameter.");

const fn shape_key(word: &'static [&'static str]) -> Key {
    required("shape", Kind::Word(word), "-", "The shape.")
}

/// The keys of a family of rectangular tubes.
pub(super) static RECTANGULAR_TUBES: Shape = Shape::new(
    "rectangular tubes",
    "Rectangular tubes of all these sizes.",
    &[shape_key(&["rectangular_tube"]), WIDTHS, HEIGHTS, WALLS],
    &[],
);

/// The keys of a family of round tubes.
pub(super) static ROUND_TUBES: Shape = Shape::new(
    "round tubes",
    "Round tubes of all these sizes.",
    &[shape_key(&["round_tube"]), DIAMETERS, WALLS],
    &[],
);

/// The keys of a family of rectangular bars.
pub(super) static RECTANGULAR_BARS: Shape = Shape::new(
    "rectangular bars",
    "Solid rectangular bars of all these sizes.",
    &[shape_key(&["rectangular_bar"]), WIDTHS, HEIGHTS],
    &[],
);

/// The keys of a family of round bars.
pub(super) static ROUND_BARS: Shape = Shape::new(
    "round bars",
    "Solid round bars of all these sizes.",
    &[shape_key(&["round_bar"]), DIAMETERS],
    &[],
);

/// The keys of a family of sections that consists of catalog profiles.
pub(super) static PROFILES: Shape = Shape::new(
    "profiles",
    "Tubes that one can buy.",
    &[required("profiles", Kind::Object(&PROFILE_FILTER), "-", "Which profiles of the catalog.")],
    &[],
);

/// The keys that select profiles of the catalog.
pub(super) static PROFILE_FILTER: Shape = Shape::new(
    "profile filter",
    "Which profiles of the catalog.",
    &[
        required(
            "family",
            Kind::Text,
            "-",
            "Family of materials: `steel`, `stainless`, `aluminium`, or one of your own catalog.",
        ),
        optional("shapes", Kind::List(&Kind::Word(&ProfileShape::WORDS)), "-", "all", "Shapes."),
        optional("max_outer_mm", Kind::Positive, "mm", "no limit", "Largest outer size."),
    ],
    &[],
);
