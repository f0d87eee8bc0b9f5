//! The keys of the files of an import: the stiffness file, which users write, and `import.json`, which the program
//! writes.

use crate::arm::prismatic_keys::{DRIVE_STIFFNESS, GUIDE_STIFFNESSES, MOVES};
use crate::arm::shared_keys::{GEAR, MOTOR, OUTPUT_BEARING, STIFFNESS, TORSION_CURVE, WHICH_GEAR_MASS};
use crate::input::key::{Kind, Rule, SCHEMA_ADDRESS, Shape, required};
use crate::input::schema::FileKind;

/// The format of a stiffness file.
pub(crate) const STIFFNESS_FILE: FileKind = FileKind {
    name: "stiffness",
    about: "What `armwright import --stiffness` takes: the stiffness of the joints of a robot, which a URDF does not state.",
    root: Kind::Object(&ALL_JOINTS),
};

/// The format of `import.json`.
pub(crate) const IMPORT_FILE: FileKind = FileKind {
    name: "import",
    about: "`import.json`: what an import lumped, guessed and left rigid, and the ranges and limits of the joints.",
    root: Kind::Object(&IMPORT),
};

/// The keys of a stiffness file.
pub(super) static ALL_JOINTS: Shape = Shape::new(
    "stiffness",
    "The stiffness of joints; those that are left away are rigid.",
    &[
        SCHEMA_ADDRESS,
        required(
            "joints",
            Kind::Map(&Kind::Either(&[Kind::Object(&HINGE), Kind::Object(&SLIDE)])),
            "-",
            "The joints by name.",
        ),
    ],
    &[],
);

/// The keys of a joint that turns.
pub(super) static HINGE: Shape = Shape::new(
    "joint that turns",
    "A joint that turns; masses of its parts are not added.",
    &[STIFFNESS, TORSION_CURVE, GEAR, WHICH_GEAR_MASS, MOTOR, OUTPUT_BEARING],
    &[
        Rule::Any(&["stiffness_nm_per_rad", "windup", "gear"]),
        Rule::Refuses("stiffness_nm_per_rad", &["windup"]),
    ],
);

/// The keys of a joint that slides.
pub(super) static SLIDE: Shape = Shape::new(
    "joint that slides",
    "A joint that slides.",
    &[DRIVE_STIFFNESS, GUIDE_STIFFNESSES, MOVES],
    &[],
);

const LIST: Kind = Kind::List(&Kind::Anything);
const NAMES: Kind = Kind::List(&Kind::Text);

static IMPORT: Shape = Shape::new(
    "import",
    "An import of a robot.",
    &[
        required("source", Kind::Text, "-", "The URDF file."),
        required("robot", Kind::Text, "-", "Name of the robot."),
        required("tip", Kind::Text, "-", "Link where the arm ends."),
        required(
            "tip_frame_at_zero",
            Kind::Anything,
            "-",
            "Frame of this link at zero angles: xyz_m and rpy_deg.",
        ),
        required("tip_frame_note", Kind::Text, "-", "In which frame an arm measures payloads."),
        required("mass_kg", Kind::NonNegative, "kg", "Mass of the arm."),
        required("payload", Kind::Null, "-", "A URDF states none."),
        required("gravity_m_s2", Kind::NonNegative, "m/s²", "Assumed, because a URDF states none."),
        required("joints", Kind::List(&Kind::Object(&JOINT)), "-", "The joints of the arm, base to tip."),
        required("joined", LIST, "-", "Joints on the way to the tip that do not move."),
        required(
            "lumped",
            LIST,
            "-",
            "Links beside the way to the tip, which are bodies of the arm's links.",
        ),
        required("guessed", NAMES, "-", "What was assumed."),
        required("left_rigid", NAMES, "-", "Joints whose stiffness is not known."),
        required("ignored", NAMES, "-", "What of the URDF is not used."),
        required("impossible_inertias", NAMES, "-", "Elements with an inertia that no solid can have."),
    ],
    &[],
);

static JOINT: Shape = Shape {
    name: "joint of an import",
    about: "A joint of the arm; ranges of joints that slide are in mm, their limits in N and m/s.",
    keys: &[
        required("name", Kind::Text, "-", "Its name."),
        required("type", Kind::Text, "-", "Its type in the URDF."),
        required("stiffness", Kind::Text, "-", "Whether a stiffness was given."),
    ],
    rules: &[],
    others: Some(&Kind::Anything),
};
