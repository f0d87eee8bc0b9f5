//! The keys of `campaign.json`. The code that reads the file uses these tables, and `armwright schema campaign` prints
//! them as a JSON Schema.

use crate::arm::effect::catalogue::NAMES as EFFECTS;
use crate::input::key::{Key, Kind, SCHEMA_ADDRESS, Shape, optional, required};
use crate::input::schema::FileKind;

/// The kind of file `campaign.json`.
pub const CAMPAIGN_FILE: FileKind = FileKind {
    name: "campaign",
    about: "What is stated about a set of measurements of one arm: `campaign.json`.",
    root: Kind::Object(&CAMPAIGN),
};

const TEXTS: Kind = Kind::List(&Kind::Text);
const PER_JOINT: Kind = Kind::Either(&[Kind::Number, Kind::Map(&Kind::Number)]);
const INERTIAS: Kind = Kind::Either(&[Kind::NonNegative, Kind::Map(&Kind::NonNegative)]);

const NOTE: Key = optional("note", Kind::Anything, "-", "none", "For people; ignored.");
const REMARK: Kind = Kind::Anything;

const RATIO: Key = optional(
    "ratio",
    PER_JOINT,
    "-",
    "not stated",
    "Turns of the motor for one of the output: one number, or one for each joint.",
);
const TORQUE_CONSTANT: Key = optional(
    "torque_constant_nm_per_a",
    PER_JOINT,
    "N m/A",
    "none",
    "Torque at the motor shaft for each ampere.",
);
const ROTOR_INERTIA: Key = optional(
    "rotor_inertia_kgm2",
    INERTIAS,
    "kg m²",
    "none",
    "Inertia of rotor and wave generator at the motor shaft; at the output where no ratio is stated.",
);
const TORQUE_AT: Key = optional(
    "torque_at",
    Kind::Word(&["shaft", "output"]),
    "-",
    "\"shaft\"",
    "Where the torques of the record act.",
);

/// Keys of `campaign.json` itself.
pub(crate) static CAMPAIGN: Shape = Shape::new(
    "campaign",
    "What is stated about a campaign.",
    &[
        SCHEMA_ADDRESS,
        optional("name", Kind::Text, "-", "\"campaign\"", "Name of the campaign."),
        optional("arm", Kind::Text, "-", "\"arm.json\"", "File of the nominal arm, in the same folder."),
        optional("other_arms", TEXTS, "-", "[]", "Files of further arms on the same trunk."),
        optional("conventions", Kind::Object(&CONVENTIONS), "-", "{}", "How the readings are meant."),
        optional(
            "tolerance",
            Kind::Object(&TOLERANCE),
            "-",
            "stiffness 0.10, modulus 0.03, mass 0.02",
            "How far good parts may be from their nominal values.",
        ),
        optional(
            "static",
            Kind::Object(&BLOCK),
            "-",
            "static.csv, if it is there",
            "Displacements of the tip under load.",
        ),
        optional("modal", Kind::Object(&BLOCK), "-", "modal.csv, if it is there", "Natural frequencies."),
        optional(
            "windup",
            Kind::Object(&BLOCK),
            "-",
            "windup.csv, if it is there",
            "Twist of one joint on a bench.",
        ),
        optional(
            "positions",
            Kind::Object(&POSITIONS),
            "-",
            "positions.csv, if it is there",
            "Absolute positions of points, and what is unknown in them.",
        ),
        optional(
            "files",
            Kind::Object(&FILES),
            "-",
            "{}",
            "Files of the channels with other names, or sheets of spreadsheets.",
        ),
        optional("columns", Kind::Object(&COLUMNS), "-", "{}", "What columns are called in the files."),
        optional(
            "links",
            Kind::Word(&["rigid", "full"]),
            "-",
            "\"full\"",
            "Whether the nominal model holds the links rigid.",
        ),
        optional("effects", Kind::List(&Kind::Word(&EFFECTS)), "-", "all", "The effects that may be named."),
        optional(
            "records",
            Kind::List(&Kind::Object(&RECORD)),
            "-",
            "record.csv, if it is there",
            "Records against time.",
        ),
        RATIO,
        TORQUE_CONSTANT,
        ROTOR_INERTIA,
        TORQUE_AT,
        optional("description", REMARK, "-", "none", "For people; ignored."),
        optional("machine", REMARK, "-", "none", "For people; ignored."),
        optional("date", REMARK, "-", "none", "For people; ignored."),
        optional("provenance", REMARK, "-", "none", "For people; ignored."),
        NOTE,
    ],
    &[],
);

static CONVENTIONS: Shape = Shape {
    name: "conventions",
    about: "How the readings are meant; texts for people may stand here too.",
    keys: &[optional(
        "payload_density_kg_m3",
        Kind::Positive,
        "kg/m³",
        "7850",
        "Density of the payloads, for their buoyancy.",
    )],
    rules: &[],
    others: Some(&Kind::Anything),
};

static BLOCK: Shape = Shape {
    name: "readings",
    about: "A file of readings; texts for people may stand here too.",
    keys: &[optional("file", Kind::Text, "-", "the usual name", "Name of the file, in the same folder.")],
    rules: &[],
    others: Some(&Kind::Anything),
};

/// Keys of `tolerance`: how far parts may deviate.
pub(super) static TOLERANCE: Shape = Shape::new(
    "tolerance",
    "95 % of good parts lie within these fractions of their nominal values; 0.1 is 10 %.",
    &[
        optional("joint_stiffness", Kind::Below(1.0), "-", "0", "Stiffness of each joint, on its own."),
        optional("modulus", Kind::Below(1.0), "-", "0", "One factor a material on E and G together."),
        optional("joint_mass", Kind::Below(1.0), "-", "0", "Mass of each joint, on its own."),
        optional(
            "bearing_stiffness",
            Kind::Below(1.0),
            "-",
            "0",
            "Tilting stiffness of each joint's bearing, on its own.",
        ),
        NOTE,
    ],
    &[],
);

/// Keys of `positions`: what is unknown in absolute positions.
pub(super) static POSITIONS: Shape = Shape::new(
    "positions",
    "Absolute positions: true is what nobody measured.",
    &[
        optional(
            "base_placement",
            Kind::Flag,
            "-",
            "false",
            "Whether the arm's place in the instrument's frame is unknown.",
        ),
        optional(
            "tool_offset",
            Kind::Flag,
            "-",
            "false",
            "Whether the place of each point on the last frame is unknown.",
        ),
        optional("joint_offsets", Kind::Flag, "-", "false", "Whether each joint's zero may be off."),
        optional(
            "geometry",
            Kind::Flag,
            "-",
            "false",
            "Whether each link's vector and each joint's axis may be off.",
        ),
        optional(
            "gravity_direction",
            Kind::Flag,
            "-",
            "false",
            "Whether gravity may deviate from the arm's -z.",
        ),
        optional("mounts", TEXTS, "-", "[]", "Links behind which place and attitude are unknown."),
        optional(
            "sessions",
            Kind::List(&Kind::Object(&SESSION)),
            "-",
            "[]",
            "Rows from which something stands elsewhere.",
        ),
        optional("file", Kind::Text, "-", "\"positions.csv\"", "Name of the file, in the same folder."),
        optional("boundary", REMARK, "-", "none", "For people; ignored."),
        optional("reference", REMARK, "-", "none", "For people; ignored."),
        NOTE,
    ],
    &[],
);

/// Keys of an entry of `positions.sessions`: a declared session.
pub(super) static SESSION: Shape = Shape::new(
    "session",
    "A row from which something stands elsewhere.",
    &[
        required(
            "from_row",
            Kind::Whole(2),
            "-",
            "The first row of the session, counted from 1 without the header.",
        ),
        required("moved", Kind::Text, "-", "What was moved: the name of a point, or base."),
    ],
    &[],
);

const FILE: Kind = Kind::Either(&[Kind::Text, Kind::Object(&SHEET)]);

/// Keys of `files`: for each channel, the file in which its readings are.
pub(super) static FILES: Shape = Shape::new(
    "files",
    "Where the readings of the channels are.",
    &[
        optional("static", FILE, "-", "static.csv", "Displacements."),
        optional("modal", FILE, "-", "modal.csv", "Frequencies."),
        optional("windup", FILE, "-", "windup.csv", "Twists."),
        optional("positions", FILE, "-", "positions.csv", "Positions."),
        NOTE,
    ],
    &[],
);

/// Keys of an entry of `files`: name of a file and, for a spreadsheet, the sheet and the row with the column names.
pub(super) static SHEET: Shape = Shape::new(
    "sheet",
    "A file, or a sheet of a spreadsheet.",
    &[
        required("file", Kind::Text, "-", "Name of the file, in the same folder."),
        optional("sheet", Kind::Text, "-", "the first", "Name of the sheet."),
        optional(
            "header_row",
            Kind::Whole(1),
            "-",
            "the first that is not blank",
            "Row that names the columns, from 1.",
        ),
        NOTE,
    ],
    &[],
);

const NAMES_OF_COLUMNS: Kind = Kind::Object(&COLUMN_NAMES);

static COLUMN_NAMES: Shape = Shape {
    name: "column names",
    about: "Columns of this program with the names that the file gives them.",
    keys: &[NOTE],
    rules: &[],
    others: Some(&Kind::Text),
};

/// Keys of `columns`: for each channel, the names that its columns have in the file.
pub(super) static COLUMNS: Shape = Shape {
    name: "columns",
    about: "What columns are called in the files. Columns of records stand here by their own names.",
    keys: &[
        optional("static", NAMES_OF_COLUMNS, "-", "{}", "Of the displacements."),
        optional("modal", NAMES_OF_COLUMNS, "-", "{}", "Of the frequencies."),
        optional("windup", NAMES_OF_COLUMNS, "-", "{}", "Of the twists."),
        optional("positions", NAMES_OF_COLUMNS, "-", "{}", "Of the positions."),
        NOTE,
    ],
    rules: &[],
    others: Some(&Kind::Text),
};

/// Keys of an entry of `records`: a record against time.
pub(crate) static RECORD: Shape = Shape::new(
    "record",
    "A record against time; constants that are not written are the campaign's.",
    &[
        optional("file", Kind::Text, "-", "\"record.csv\"", "Name of the file, in the same folder."),
        optional(
            "columns",
            Kind::Map(&Kind::Text),
            "-",
            "{}",
            "Columns of this program with the names that the file gives them.",
        ),
        RATIO,
        TORQUE_CONSTANT,
        ROTOR_INERTIA,
        TORQUE_AT,
    ],
    &[],
);
