//! The keys of cases files. The reader uses this list, and `armwright schema cases` prints it.

use super::keys::{PAYLOAD, VECTOR, WATER};
use super::{JointModel, LinkModel, Words};
use crate::input::key::{Key, Kind, Rule, Shape, optional, words_of};
use crate::input::schema::FileKind;

/// The format of a cases file.
pub const CASES_FILE: FileKind = FileKind {
    name: "cases",
    about: "Load cases of an arm, for `armwright analyze --cases`.",
    root: Kind::NonEmpty(&Kind::Object(&CASE)),
};

/// The words for the link models in files.
pub(crate) const LINK_MODELS: Kind = Kind::Word(&words_of::<LinkModel, 3>(LinkModel::WORDS));

/// The words for the joint models in files.
pub(crate) const JOINT_MODELS: Kind = Kind::Word(&words_of::<JointModel, 3>(JointModel::WORDS));

/// The key for the name of a case or a pose.
pub(crate) const CASE_NAME: Key = optional("name", Kind::Text, "-", "its place in the list", "Name.");

/// The key for a pose as a list of numbers, one for each driven joint \[deg, or m for a prismatic joint\].
pub(crate) const POSE_DEG: Key = optional(
    "pose_deg",
    Kind::List(&Kind::Number),
    "deg",
    "pose",
    "One angle a driven joint, base to tip, of a chain without prismatic joints.",
);

/// The key for a pose as a map from the names of joints to their angles.
pub(crate) const POSE: Key = optional(
    "pose",
    Kind::Map(&Kind::Number),
    "deg, mm",
    "pose_deg",
    "Angles and travels by joint, `{\"rail_mm\": 250, \"j2_deg\": 30}`; joints left away stay at 0.",
);

/// The key for the payload of a case.
pub(crate) const HELD: Key = optional("payload", Kind::Object(&PAYLOAD), "-", "none", "What the arm holds.");

/// The key for the force at the tip \[N\].
pub(crate) const TIP_FORCE: Key =
    optional("tip_force_n", VECTOR, "N", "[0, 0, 0]", "Force at the tip, in world axes.");

/// The key for the moment at the tip \[N m\].
pub(crate) const TIP_MOMENT: Key =
    optional("tip_moment_nm", VECTOR, "N m", "[0, 0, 0]", "Moment at the tip, in world axes.");

/// The key for the water around the arm.
pub(crate) const AROUND: Key = optional("water", Kind::Object(&WATER), "-", "dry", "Water around the arm.");

/// The keys of a load case.
pub(crate) static CASE: Shape = Shape::new(
    "case",
    "A load case: a pose, a load and the models to use.",
    &[
        CASE_NAME,
        POSE_DEG,
        POSE,
        HELD,
        TIP_FORCE,
        TIP_MOMENT,
        optional("links", LINK_MODELS, "-", "\"full\"", "Physics of the links."),
        optional("joints", JOINT_MODELS, "-", "\"three_segment\"", "Physics of the joints."),
        AROUND,
    ],
    &POSE_RULES,
);

/// Rules for the keys `pose_deg` and `pose`: one of them must be given, but not both.
pub(crate) const POSE_RULES: [Rule; 2] =
    [Rule::Any(&["pose_deg", "pose"]), Rule::Refuses("pose_deg", &["pose"])];
