//! The keys of cases files: what the reader knows, and what `armwright schema cases` prints.

use super::keys::{PAYLOAD, VECTOR, WATER};
use super::{JointModel, LinkModel, Words};
use crate::input::key::{Kind, Shape, optional, required, words_of};
use crate::input::schema::FileKind;

/// A cases file.
pub const CASES_FILE: FileKind = FileKind {
    name: "cases",
    about: "Load cases of an arm, for `armwright analyze --cases`.",
    root: Kind::NonEmpty(&Kind::Object(&CASE)),
};

/// Words of the models of links.
pub(crate) const LINK_MODELS: Kind = Kind::Word(&words_of::<LinkModel, 3>(LinkModel::WORDS));

/// Words of the models of joints.
pub(crate) const JOINT_MODELS: Kind = Kind::Word(&words_of::<JointModel, 3>(JointModel::WORDS));

/// A load case.
pub(crate) static CASE: Shape = Shape::new(
    "case",
    "A load case: a pose, a load and the models to use.",
    &[
        optional("name", Kind::Text, "-", "its place in the list", "Name."),
        required("pose_deg", Kind::List(&Kind::Number), "deg", "One angle a driven joint, base to tip."),
        optional("payload", Kind::Object(&PAYLOAD), "-", "none", "What the arm holds."),
        optional("tip_force_n", VECTOR, "N", "[0, 0, 0]", "Force at the tip, in world axes."),
        optional("tip_moment_nm", VECTOR, "N m", "[0, 0, 0]", "Moment at the tip, in world axes."),
        optional("links", LINK_MODELS, "-", "\"full\"", "Physics of the links."),
        optional("joints", JOINT_MODELS, "-", "\"three_segment\"", "Physics of the joints."),
        optional("water", Kind::Object(&WATER), "-", "dry", "Water around the arm."),
    ],
    &[],
);
