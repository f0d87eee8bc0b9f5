//! The keys of study files. The readers use these lists, and `armwright schema study` prints them.

use super::choose_keys::CHOOSE;
use super::drive_keys::{BRAKE, DRIVES};
use super::rail_keys::PRISMATIC;
use crate::arm::case_keys::{
    AROUND, CASE_NAME, HELD, JOINT_MODELS, LINK_MODELS, POSE as POSE_BY_NAMES, POSE_DEG, POSE_RULES,
    TIP_FORCE, TIP_MOMENT,
};
use crate::arm::file_keys::{EFFECT_LIST, GIVEN_LINK_RULES};
use crate::arm::keys::{
    EXTRAS, GEAR_AT, GEAR_RATIO, GRAVITY, MASS_FACTOR, MOTOR_AT, MOTOR_MASS, MOTOR_POINT,
    OPEN_COUNTERWEIGHTS, OPEN_SPRINGS, POSITIVE_OR_NULL, STIFFNESS_FACTOR, TRANSMISSION, TRANSMISSION_RULES,
    TURNS_WITH,
};
use crate::arm::shared_keys::{
    AXIS, BODIES_OF_JOINT, BODIES_OF_LINK, COUPLED, GEAR, IS_JOINT, IS_LINK, LINK_MASS, LINK_PIECES,
    LINK_SECTION, LINK_VECTOR, MOTOR, NAME, OUTPUT_BEARING, STIFFNESS, TORSION_CURVE, WHICH_GEAR_MASS,
};
use crate::input::key::{Kind, Rule, SCHEMA_ADDRESS, Shape, optional, required};
use crate::input::schema::FileKind;

/// The format of a study file.
pub const STUDY_FILE: FileKind = FileKind {
    name: "study",
    about: "A named question about an arm: what is fixed, what may be chosen, and what the arm must do.",
    root: Kind::Object(&STUDY),
};

const EXTRAS_VALUE: Kind = Kind::Either(&[Kind::Word(&["usual", "none"]), Kind::Object(&EXTRAS)]);
const FIT_VALUE: Kind = Kind::Either(&[Kind::Object(&FIT), Kind::Null]);
const DUTY: Kind = Kind::NonEmpty(&Kind::Object(&STATED_PHASE));

/// The keys of a study.
pub(super) static STUDY: Shape = Shape::new(
    "study",
    "A study.",
    &[
        SCHEMA_ADDRESS,
        required("name", Kind::Name, "-", "Name; results go to `results/<name>`."),
        optional("question", Kind::Text, "-", "\"\"", "The question in a sentence."),
        optional("notes", Kind::Text, "-", "\"\"", "A text for people; read and otherwise ignored."),
        GRAVITY,
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
        HELD,
        TIP_FORCE,
        TIP_MOMENT,
        required(
            "poses",
            Kind::NonEmpty(&Kind::Object(&POSE)),
            "-",
            "The poses in which the arm is judged and sized.",
        ),
        optional(
            "environments",
            Kind::NonEmpty(&Kind::Object(&ENVIRONMENT)),
            "-",
            "one, dry",
            "What the arm is in; every pose is taken in each.",
        ),
        optional("motion", Kind::Object(&MOTION), "-", "the paper's", "What the tip must do."),
        optional("duty", DUTY, "-", "none", "The duty of the only joint."),
        optional(
            "drives",
            Kind::Object(&DRIVES),
            "-",
            "strain-wave gears, servo and hydraulic motors",
            "Which catalog parts may be chosen.",
        ),
        optional(
            "extras",
            EXTRAS_VALUE,
            "-",
            "\"usual\"",
            "What every sized joint weighs beyond gear, motor and bearing.",
        ),
        optional("fit", FIT_VALUE, "-", "null", "What is asked of the sizes of every sized joint's parts."),
        optional("harness_kg_per_m", Kind::NonNegative, "kg/m", "0", "Cables and hoses along every link."),
        optional(
            "connection_share",
            Kind::NonNegative,
            "-",
            "0",
            "Compliance of the connections at every joint, as a share of that of its gear and bearing.",
        ),
        optional(
            "constraints",
            Kind::Object(&CONSTRAINTS),
            "-",
            "none",
            "Limits that every design must keep.",
        ),
        optional("models", Kind::Object(&MODELS), "-", "{}", "Physics of links and joints."),
        optional(
            "effects",
            EFFECT_LIST,
            "-",
            "[]",
            "Physics beyond the nominal model that every design has.",
        ),
        optional("springs", OPEN_SPRINGS, "-", "[]", "Springs that balance every design."),
        optional("counterweights", OPEN_COUNTERWEIGHTS, "-", "[]", "Point masses that balance every design."),
        optional(
            "gap_percent",
            Kind::Below(100.0),
            "%",
            "0",
            "An exact search ends when no design is better than a listed one by more than this; 0 finds the whole front.",
        ),
    ],
    &[],
);

const OF_GIVEN_DRIVE: [&str; 6] = ["stiffness_nm_per_rad", "windup", "gear", "motor", "gear_mass", "mass_kg"];

/// The keys of a joint of a study.
pub(super) static JOINT: Shape = Shape::new(
    "joint",
    "A joint: its drive is searched for or given.",
    &[
        IS_JOINT,
        NAME,
        AXIS,
        optional(
            "drive",
            Kind::Word(&["first_fit", "all_fits"]),
            "-",
            "none",
            "Search for it: the drive that is lightest with its extras among those that pass all checks, or every drive that passes them as a choice.",
        ),
        optional(
            "drives",
            Kind::Object(&DRIVES),
            "-",
            "the study's",
            "Which parts this joint's drive may have.",
        ),
        STIFFNESS,
        TORSION_CURVE,
        GEAR,
        MOTOR,
        WHICH_GEAR_MASS,
        optional("mass_kg", Kind::NonNegative, "kg", "from the parts, else 0", "Mass of a given drive."),
        optional(
            "max_speed_rad_s",
            Kind::Positive,
            "rad/s",
            "tip speed over reach",
            "The speed that the joint must reach.",
        ),
        OUTPUT_BEARING,
        optional(
            "extras",
            EXTRAS_VALUE,
            "-",
            "the study's; none for a given drive",
            "What the joint weighs beyond gear, motor and bearing.",
        ),
        optional(
            "range_deg",
            Kind::Array(2, &Kind::Number),
            "deg",
            "-180 to 180",
            "Smallest and largest angle of the joint.",
        ),
        BRAKE,
        optional("duty", DUTY, "-", "the cycle", "What the joint does in numbers."),
        optional("fit", FIT_VALUE, "-", "the study's", "What is asked of the sizes of the joint's parts."),
        BODIES_OF_JOINT,
        COUPLED,
        MOTOR_AT,
        MOTOR_POINT,
        MOTOR_MASS,
        GEAR_AT,
        GEAR_RATIO,
        TRANSMISSION,
        TURNS_WITH,
    ],
    &[
        Rule::Any(&["drive", "stiffness_nm_per_rad", "windup", "gear", "coupled"]),
        Rule::Refuses("stiffness_nm_per_rad", &["windup"]),
        Rule::Refuses("drive", &OF_GIVEN_DRIVE),
        Rule::Needs("drives", &["drive"]),
        Rule::Needs("brake", &["drive", "motor"]),
        Rule::Needs("duty", &["drive", "motor"]),
        Rule::Needs("fit", &["drive", "motor"]),
        Rule::Refuses("coupled", &["drive", "motor", "range_deg", "max_speed_rad_s", "brake", "duty"]),
        Rule::Refuses("drive", &["motor_mass_kg", "gear_at", "gear_ratio"]),
        TRANSMISSION_RULES[0],
        TRANSMISSION_RULES[1],
        TRANSMISSION_RULES[2],
        TRANSMISSION_RULES[3],
    ],
);

/// The keys of a link of a study.
pub(super) static LINK: Shape = Shape::new(
    "link",
    "A link: its tube is chosen or given, or it is a rigid offset.",
    &[
        IS_LINK,
        NAME,
        LINK_VECTOR,
        optional(
            "choose",
            Kind::Object(&CHOOSE),
            "-",
            "none",
            "An open link: materials and sections to choose from.",
        ),
        optional("material", Kind::Text, "-", "none", "Material of a given tube, by its catalog name."),
        LINK_SECTION,
        LINK_MASS,
        BODIES_OF_LINK,
        LINK_PIECES,
        STIFFNESS_FACTOR,
        MASS_FACTOR,
    ],
    &LINK_RULES,
);

const LINK_RULES: [Rule; 7] = [
    GIVEN_LINK_RULES[0],
    GIVEN_LINK_RULES[1],
    GIVEN_LINK_RULES[2],
    GIVEN_LINK_RULES[3],
    GIVEN_LINK_RULES[4],
    GIVEN_LINK_RULES[5],
    Rule::Refuses("choose", &["material", "section", "mass_kg", "pieces", "stiffness_factor", "mass_factor"]),
];

/// The keys of a pose of a study.
pub(super) static POSE: Shape = Shape::new(
    "pose",
    "A pose in which the arm is judged and sized.",
    &[
        CASE_NAME,
        POSE_DEG,
        POSE_BY_NAMES,
        HELD.or("the study's"),
        TIP_FORCE.or("the study's"),
        TIP_MOMENT.or("the study's"),
        optional(
            "sizing",
            Kind::Flag,
            "-",
            "true",
            "Whether the pose counts for the sizing of drives and the stress check.",
        ),
        optional(
            "judged",
            Kind::Flag,
            "-",
            "true",
            "Whether the pose counts for deflection and lowest mode.",
        ),
    ],
    &POSE_RULES,
);

/// The keys of an environment: the medium around the arm.
pub(super) static ENVIRONMENT: Shape = Shape::new(
    "environment",
    "What the arm is in.",
    &[required("name", Kind::Text, "-", "Appended to the names of the poses."), AROUND],
    &[],
);

/// The keys of the motion that the tip must make.
pub(super) static MOTION: Shape = Shape::new(
    "motion",
    "What the tip must do.",
    &[
        optional("tip_speed_m_s", Kind::Positive, "m/s", "1.0", "Speed of the tip."),
        optional("ramp_time_s", Kind::Positive, "s", "0.2", "Time in which it is reached."),
        optional(
            "emergency_deceleration_m_s2",
            Kind::Positive,
            "m/s²",
            "twice speed over ramp time",
            "Deceleration of the tip in an emergency stop.",
        ),
        optional(
            "min_lever_m",
            Kind::Positive,
            "m",
            "0.3",
            "Smallest lever that turns tip speed into joint speed.",
        ),
        optional("life_h", Kind::Positive, "h", "10000", "L10 life that every gear must reach."),
        optional(
            "cycle",
            Kind::NonEmpty(&Kind::Object(&PHASE)),
            "-",
            "ramp up, three ramp times at speed, ramp down, five at rest",
            "What every joint repeats.",
        ),
        optional(
            "emergency_stops",
            Kind::Positive,
            "-",
            "not asked",
            "Emergency stops that every gear must bear in its life.",
        ),
        optional(
            "check_motor_heat",
            Kind::Flag,
            "-",
            "true",
            "Whether the root mean square of a motor's torque must be within its continuous torque.",
        ),
    ],
    &[],
);

/// The keys of a phase of the duty cycle.
pub(super) static PHASE: Shape = Shape::new(
    "phase",
    "A phase of the cycle.",
    &[
        required(
            "phase",
            Kind::Word(&["accelerate", "constant", "decelerate", "rest", "fraction"]),
            "-",
            "What the joint does.",
        ),
        required("time_s", Kind::NonNegative, "s", "How long."),
        optional(
            "of_static_torque",
            Kind::Range(0.0, 1.0),
            "-",
            "none",
            "Part of the joint's static torque.",
        ),
        optional("of_speed", Kind::Range(0.0, 1.0), "-", "none", "Part of the joint's speed."),
    ],
    &[Rule::When {
        key: "phase",
        is: Kind::Word(&["fraction"]),
        then: [&["of_static_torque", "of_speed"], &[]],
        otherwise: [&[], &["of_static_torque", "of_speed"]],
    }],
);

/// The keys of a phase of a stated duty.
pub(super) static STATED_PHASE: Shape = Shape::new(
    "duty phase",
    "A phase of a duty that is stated in numbers.",
    &[
        required("torque_nm", Kind::Number, "N m", "Torque; negative where the load drives the motor."),
        required("time_s", Kind::NonNegative, "s", "How long."),
        required("speed_rpm", Kind::NonNegative, "rpm", "Mean speed of the phase."),
    ],
    &[],
);

/// The keys of `fit`: limits on the sizes of the parts of a joint.
pub(super) static FIT: Shape = Shape::new(
    "fit",
    "Whether the parts of a joint go where they must; null asks nothing.",
    &[
        optional(
            "gear_to_link_max",
            POSITIVE_OR_NULL,
            "-",
            "not asked",
            "Largest outer diameter of the gear over the width of the link that the joint carries.",
        ),
        optional("motor", Kind::Word(&["behind", "in_link", "beside"]), "-", "behind", "Where the motor is."),
        optional(
            "cable_bore_min_mm",
            POSITIVE_OR_NULL,
            "mm",
            "not asked",
            "Smallest bore of the gear, and of a motor behind it.",
        ),
        optional(
            "drive_length_max_mm",
            POSITIVE_OR_NULL,
            "mm",
            "not asked",
            "Largest length of the gear, with that of a motor behind it.",
        ),
    ],
    &[],
);

/// The keys of the limits that every design must meet.
pub(super) static CONSTRAINTS: Shape = Shape::new(
    "constraints",
    "Limits that every design must keep.",
    &[
        optional(
            "tip_deflection_max_mm",
            Kind::Positive,
            "mm",
            "no limit",
            "Largest tip deflection in the worst judged pose.",
        ),
        optional("mass_max_kg", Kind::Positive, "kg", "no limit", "Largest mass of links and drives."),
        optional(
            "lowest_mode_min_hz",
            Kind::Positive,
            "Hz",
            "no limit",
            "Smallest lowest mode in the worst judged pose.",
        ),
        optional(
            "servo_bandwidth_hz",
            Kind::Positive,
            "Hz",
            "no limit",
            "Bandwidth of the servo; the lowest mode is at least servo_ratio times this.",
        ),
        optional(
            "servo_ratio",
            Kind::Positive,
            "-",
            "3",
            "Smallest ratio of lowest mode to servo bandwidth.",
        ),
        optional(
            "stress_safety_factor_min",
            Kind::Positive,
            "-",
            "no limit",
            "Smallest strength over stress at both ends of every open link.",
        ),
        optional(
            "wall_slenderness_max",
            Kind::Positive,
            "-",
            "no limit",
            "Largest flat width, or diameter, over wall.",
        ),
        optional(
            "material_cost_max_eur",
            Kind::Positive,
            "EUR",
            "no limit",
            "Largest cost of the links' raw material.",
        ),
    ],
    &[Rule::Needs("servo_ratio", &["servo_bandwidth_hz"])],
);

/// The keys of the models of links and joints.
pub(super) static MODELS: Shape = Shape::new(
    "models",
    "Physics of links and joints.",
    &[
        optional("links", LINK_MODELS, "-", "\"full\"", "Physics of the links."),
        optional("joints", JOINT_MODELS, "-", "\"three_segment\"", "Physics of the joints."),
    ],
    &[],
);
