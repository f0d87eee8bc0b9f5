//! The keys of the parts of an arm, of the payload and of water. The readers use these lists, and `armwright schema`
//! prints them.

use crate::input::key::{Key, Kind, Rule, Shape, optional, required};

/// A vector of three numbers.
pub(crate) const VECTOR: Kind = Kind::Array(3, &Kind::Number);

/// A number greater than zero, or `null`.
pub(crate) const POSITIVE_OR_NULL: Kind = Kind::Either(&[Kind::Positive, Kind::Null]);

/// The key for the gravity of an arm or a study.
pub(crate) const GRAVITY: Key = optional(
    "gravity_m_s2",
    Kind::Either(&[Kind::NonNegative, VECTOR]),
    "m/s²",
    "9.81",
    "A number along world -z, 0 for none, or a vector in the world.",
);

/// Which mass of a gear counts: component set or housed unit.
pub(crate) const GEAR_MASS: Kind = Kind::Word(&["component_set", "housed_unit"]);

/// A bearing: its numbers, the name of a housed gear, or `null`.
pub(crate) const BEARING_VALUE: Kind = Kind::Either(&[Kind::Object(&BEARING), Kind::Text, Kind::Null]);

/// A list of rigid bodies on a link.
pub(crate) const LINK_BODIES: Kind = Kind::List(&Kind::Object(&LINK_BODY));

/// A list of rigid bodies on a joint.
pub(crate) const JOINT_BODIES: Kind = Kind::List(&Kind::Object(&JOINT_BODY));

/// A map from the names of the driving joints of a passive joint to their factors.
pub(crate) const COUPLING: Kind = Kind::Map(&Kind::Number);

/// The section of a link that is given, not chosen by the search.
pub(crate) const SECTION: Kind = Kind::Either(&[
    Kind::Object(&RECTANGULAR_TUBE),
    Kind::Object(&ROUND_TUBE),
    Kind::Object(&RECTANGULAR_BAR),
    Kind::Object(&ROUND_BAR),
    Kind::Object(&I_BEAM),
    Kind::Object(&STATED),
]);

/// The keys of a torsion curve.
pub(crate) static WINDUP: Shape = Shape::new(
    "windup",
    "The torsion curve of a joint in three segments; T is the whole torque on the joint.",
    &[
        required("k1_nm_per_rad", Kind::Positive, "N m/rad", "Slope up to t1_nm."),
        required("k2_nm_per_rad", Kind::Positive, "N m/rad", "Slope from t1_nm to t2_nm."),
        required("k3_nm_per_rad", Kind::Positive, "N m/rad", "Slope beyond t2_nm."),
        required("t1_nm", Kind::Positive, "N m", "Where the first segment ends."),
        required("t2_nm", Kind::Positive, "N m", "Where the second segment ends; not below t1_nm."),
    ],
    &[],
);

/// The keys of an output bearing.
pub(crate) static BEARING: Shape = Shape::new(
    "bearing",
    "An output bearing: it tilts about the two axes across the joint's.",
    &[
        optional(
            "tilt_stiffness_nm_per_rad",
            POSITIVE_OR_NULL,
            "N m/rad",
            "null",
            "Moment per tilt; null is rigid.",
        ),
        optional(
            "permissible_moment_nm",
            POSITIVE_OR_NULL,
            "N m",
            "null",
            "Largest moment across the axis while the joint turns; null is not checked.",
        ),
        optional("mass_kg", Kind::NonNegative, "kg", "0", "Mass of a bearing that is a part of its own."),
        optional(
            "offset_m",
            Kind::Either(&[Kind::Number, Kind::Null]),
            "m",
            "null",
            "Lever along the axis from the bearing's centre to where the link attaches; null is the flange's offset and half the link's width.",
        ),
        optional("pitch_diameter_m", POSITIVE_OR_NULL, "m", "null", "Pitch diameter of the rollers."),
        optional("static_load_rating_n", POSITIVE_OR_NULL, "N", "null", "Static load rating C0."),
        optional("dynamic_load_rating_n", POSITIVE_OR_NULL, "N", "null", "Dynamic load rating C."),
    ],
    &[],
);

/// The key for the mass of a body.
pub(super) const BODY_MASS: Key = required("mass_kg", Kind::NonNegative, "kg", "Mass.");

/// The key for the inertia tensor of a body.
pub(super) const BODY_INERTIA: Key = optional(
    "inertia_kgm2",
    Kind::Array(3, &VECTOR),
    "kg m²",
    "[[0, 0, 0], [0, 0, 0], [0, 0, 0]]",
    "Inertia about the centre of gravity, in the same frame.",
);

/// The keys of a body of a link.
pub(crate) static LINK_BODY: Shape = Shape::new(
    "body of a link",
    "A rigid part of a link.",
    &[
        BODY_MASS,
        optional(
            "cg_m",
            VECTOR,
            "m",
            "[0, 0, 0]",
            "Centre of gravity from the start of the link, in the frame of vector_m.",
        ),
        BODY_INERTIA,
    ],
    &[],
);

/// The keys of a body of a joint.
pub(crate) static JOINT_BODY: Shape = Shape::new(
    "body of a joint",
    "A rigid part of a joint.",
    &[
        BODY_MASS,
        optional("cg_m", VECTOR, "m", "[0, 0, 0]", "Centre of gravity from the joint's point."),
        BODY_INERTIA,
        optional(
            "rotates",
            Kind::Flag,
            "-",
            "false",
            "Whether the body is outboard of the joint's springs, in the frame after the rotation.",
        ),
    ],
    &[],
);

const WIDTH: Key = required("width_m", Kind::Positive, "m", "Outer width, along the section's y.");

const HEIGHT: Key = required("height_m", Kind::Positive, "m", "Outer height, along the section's z.");

const WALL: Key = required("wall_m", Kind::Positive, "m", "Thickness of the wall.");

const DIAMETER: Key = required("diameter_m", Kind::Positive, "m", "Outer diameter.");

const fn shape_key(word: &'static [&'static str]) -> Key {
    required("shape", Kind::Word(word), "-", "The shape.")
}

/// The keys of a rectangular tube.
pub(crate) static RECTANGULAR_TUBE: Shape = Shape::new(
    "rectangular tube",
    "A rectangular tube.",
    &[shape_key(&["rectangular_tube"]), WIDTH, HEIGHT, WALL],
    &[],
);

/// The keys of a round tube.
pub(crate) static ROUND_TUBE: Shape =
    Shape::new("round tube", "A round tube.", &[shape_key(&["round_tube"]), DIAMETER, WALL], &[]);

/// The keys of a solid rectangular bar.
pub(crate) static RECTANGULAR_BAR: Shape = Shape::new(
    "rectangular bar",
    "A solid rectangular bar.",
    &[shape_key(&["rectangular_bar"]), WIDTH, HEIGHT],
    &[],
);

/// The keys of a solid round bar.
pub(crate) static ROUND_BAR: Shape =
    Shape::new("round bar", "A solid round bar.", &[shape_key(&["round_bar"]), DIAMETER], &[]);

/// The keys of an I section.
pub(crate) static I_BEAM: Shape = Shape::new(
    "I beam",
    "An I section with its web upright.",
    &[
        shape_key(&["i_beam"]),
        WIDTH,
        HEIGHT,
        required("web_m", Kind::Positive, "m", "Thickness of the web."),
        required("flange_m", Kind::Positive, "m", "Thickness of each flange."),
    ],
    &[],
);

/// The keys of a section that states its stiffnesses and its mass.
pub(crate) static STATED: Shape = Shape::new(
    "stated section",
    "A section by its stiffnesses and its mass; it is rigid in shear.",
    &[
        shape_key(&["stated"]),
        WIDTH,
        HEIGHT,
        required(
            "ei_y_nm2",
            Kind::Positive,
            "N m²",
            "Bending stiffness that resists motion along the section's z.",
        ),
        required(
            "ei_z_nm2",
            Kind::Positive,
            "N m²",
            "Bending stiffness that resists motion along the section's y.",
        ),
        required("gj_nm2", Kind::Positive, "N m²", "Torsional stiffness."),
        required("kg_per_m", Kind::Positive, "kg/m", "Mass per length."),
        optional(
            "ea_n",
            Kind::Positive,
            "N",
            "of an even outline",
            "Axial stiffness. With the bending stiffnesses it determines the rotary inertia.",
        ),
    ],
    &[],
);

/// The keys of a stage between a motor and the joint that it drives.
pub(crate) static STAGE: Shape = Shape::new(
    "stage",
    "A belt, chain, shaft or gear stage between a motor and the joint that it drives.",
    &[
        required("ratio", Kind::Positive, "-", "Turns of the input per turn of the output; 1 for an idler."),
        optional("efficiency", Kind::Positive, "-", "1", "Part of the power that arrives, at most 1."),
        optional(
            "stiffness_nm_per_rad",
            POSITIVE_OR_NULL,
            "N m/rad",
            "null",
            "Torque at the output per twist there, with the input held; null is rigid.",
        ),
        optional("inertia_kgm2", Kind::NonNegative, "kg m²", "0", "Moment of inertia at the input."),
        optional("mass_kg", Kind::NonNegative, "kg", "0", "Mass, half of it at either end."),
    ],
    &[],
);

/// Key for the part on which a motor sits that is not at its joint.
pub(crate) const MOTOR_AT: Key = optional(
    "motor_at",
    Kind::Name,
    "-",
    "the joint",
    "The part that carries the joint's motor: an element inboard of the joint, or base.",
);

/// Key for the point at which the motor sits on the part that `motor_at` names.
pub(crate) const MOTOR_POINT: Key = optional(
    "motor_point_m",
    VECTOR,
    "m",
    "[0, 0, 0]",
    "Where it is, from the start of the element in the frame that it carries.",
);

/// Key for the mass of a motor that is not at its joint, with the gear if the gear sits at the motor.
pub(crate) const MOTOR_MASS: Key = optional(
    "motor_mass_kg",
    Kind::NonNegative,
    "kg",
    "from the parts, else 0",
    "Mass of what sits at a motor elsewhere; mass_kg is then what stays at the joint.",
);

/// Key that says whether the gear sits at the joint or at the motor.
pub(crate) const GEAR_AT: Key = optional(
    "gear_at",
    Kind::Word(&["joint", "motor"]),
    "-",
    "\"joint\"",
    "Whether the gear stands at the joint, after the stages, or at the motor, before them.",
);

/// Key for the ratio of a gear that is given in numbers and not by its name.
pub(crate) const GEAR_RATIO: Key = optional(
    "gear_ratio",
    Kind::Positive,
    "-",
    "the gear's",
    "Ratio of a gear at the joint that is given in numbers; 1 if the stages drive the joint itself.",
);

/// A list of stages.
const STAGES: Kind = Kind::List(&STAGE_OBJECT);

const STAGE_OBJECT: Kind = Kind::Object(&STAGE);

/// Key for the stages between the motor and the joint.
pub(crate) const TRANSMISSION: Key = optional(
    "transmission",
    STAGES,
    "-",
    "[]",
    "Stages from the motor to the gear (or from motor and gear to the joint), in this order; the last ones run along the links \
     behind the joints that lie between.",
);

/// Key for the joints inboard of a joint that turn it while its own motor stands still.
pub(crate) const TURNS_WITH: Key = optional(
    "turns_with",
    COUPLING,
    "-",
    "what the stages give",
    "How far the joint turns per turn of joints inboard of it, while its own motor stands.",
);

/// Rules for the keys of stages and of motors that are not at their joints.
pub(crate) const TRANSMISSION_RULES: [Rule; 4] = [
    Rule::Needs("motor_point_m", &["motor_at"]),
    Rule::Needs("motor_mass_kg", &["motor_at"]),
    Rule::Needs("gear_ratio", &["transmission"]),
    Rule::Refuses(
        "coupled",
        &[
            "motor_at",
            "motor_point_m",
            "motor_mass_kg",
            "gear_at",
            "gear_ratio",
            "transmission",
            "turns_with",
        ],
    ),
];

/// A list of springs of an arm.
pub(crate) const SPRINGS: Kind =
    Kind::List(&Kind::Either(&[Kind::Object(&SPRING), Kind::Object(&TORSION_SPRING)]));

/// A list of springs of a study.
pub(crate) const OPEN_SPRINGS: Kind =
    Kind::List(&Kind::Either(&[Kind::Object(&OPEN_SPRING), Kind::Object(&OPEN_TORSION_SPRING)]));

/// A list of counterweights of an arm.
pub(crate) const COUNTERWEIGHTS: Kind = Kind::List(&Kind::Object(&COUNTERWEIGHT));

/// A list of counterweights of a study.
pub(crate) const OPEN_COUNTERWEIGHTS: Kind = Kind::List(&Kind::Object(&OPEN_COUNTERWEIGHT));

/// The kinds of value that the numbers of springs and counterweights have in a file: any number, a number that is not
/// negative, and a positive number.
struct BalanceNumbers {
    any: Kind,
    non_negative: Kind,
    positive: Kind,
}

/// The kinds of value in an arm file, where each number has one value.
const ONE_VALUE: BalanceNumbers =
    BalanceNumbers { any: Kind::Number, non_negative: Kind::NonNegative, positive: Kind::Positive };

/// The kinds of value in a study, where each number may be a list of values to choose from.
const CHOICES: BalanceNumbers = BalanceNumbers {
    any: Kind::Either(&[Kind::Number, Kind::NonEmpty(&Kind::Number)]),
    non_negative: Kind::Either(&[Kind::NonNegative, Kind::NonEmpty(&Kind::NonNegative)]),
    positive: Kind::Either(&[Kind::Positive, Kind::NonEmpty(&Kind::Positive)]),
};

const SPRING_NAME: Key =
    optional("name", Kind::Name, "-", "spring 1, ...", "Name, unique among the springs.");

const fn spring_keys(numbers: &BalanceNumbers) -> [Key; 6] {
    [
        SPRING_NAME,
        required("from", Kind::Object(&SPRING_END), "-", "One end."),
        required("to", Kind::Object(&SPRING_END), "-", "The other end, on another part of the arm."),
        optional("stiffness_n_per_m", numbers.non_negative, "N/m", "none", "Stiffness, with free_length_m."),
        optional(
            "free_length_m",
            numbers.non_negative,
            "m",
            "none",
            "Length at which the stiffness has no part in the force, with stiffness_n_per_m; 0 is allowed.",
        ),
        optional(
            "force_n",
            numbers.any,
            "N",
            "0",
            "Constant part of the force; negative pushes the ends apart.",
        ),
    ]
}

static SPRING_KEYS: [Key; 6] = spring_keys(&ONE_VALUE);
static OPEN_SPRING_KEYS: [Key; 6] = spring_keys(&CHOICES);
const SPRING_RULES: &[Rule] = &[
    Rule::Any(&["force_n", "stiffness_n_per_m"]),
    Rule::Needs("stiffness_n_per_m", &["free_length_m"]),
    Rule::Needs("free_length_m", &["stiffness_n_per_m"]),
];

/// The keys of a spring between two points.
pub(crate) static SPRING: Shape = Shape::new(
    "spring",
    "A spring between two points: its force is force_n + stiffness (length - free length).",
    &SPRING_KEYS,
    SPRING_RULES,
);

/// The keys of a spring of a study, whose numbers may be open.
static OPEN_SPRING: Shape = Shape::new(
    "spring",
    "A spring between two points: its force is force_n + stiffness (length - free length). A list of numbers is a choice.",
    &OPEN_SPRING_KEYS,
    SPRING_RULES,
);

/// The keys of an end of a spring.
pub(crate) static SPRING_END: Shape = Shape::new(
    "end of a spring",
    "An end of a spring.",
    &[
        required("at", Kind::Text, "-", "A joint or a link, base, or world."),
        optional(
            "point_m",
            VECTOR,
            "m",
            "[0, 0, 0]",
            "The point, from the start of the element in the frame that it carries.",
        ),
    ],
    &[],
);

const fn torsion_spring_keys(numbers: &BalanceNumbers) -> [Key; 4] {
    [
        SPRING_NAME,
        required("joint", Kind::Text, "-", "The joint."),
        required("stiffness_nm_per_rad", numbers.positive, "N m/rad", "Stiffness."),
        required("free_deg", numbers.any, "deg", "Angle of the joint at which it has no torque."),
    ]
}

static TORSION_SPRING_KEYS: [Key; 4] = torsion_spring_keys(&ONE_VALUE);
static OPEN_TORSION_SPRING_KEYS: [Key; 4] = torsion_spring_keys(&CHOICES);

/// The keys of a spring about a joint.
pub(crate) static TORSION_SPRING: Shape =
    Shape::new("torsion spring", "A spring that turns a joint.", &TORSION_SPRING_KEYS, &[]);

/// The keys of a spring about a joint of a study, whose numbers may be open.
static OPEN_TORSION_SPRING: Shape = Shape::new(
    "torsion spring",
    "A spring that turns a joint. A list of numbers is a choice.",
    &OPEN_TORSION_SPRING_KEYS,
    &[],
);

const fn counterweight_keys(numbers: &BalanceNumbers) -> [Key; 4] {
    [
        optional("name", Kind::Text, "-", "none", "Name, for people."),
        required("at", Kind::Text, "-", "The joint or link that carries it; of a joint the side that turns."),
        required(
            "point_m",
            VECTOR,
            "m",
            "Where it is, from the start of the element in the frame that it carries.",
        ),
        required("mass_kg", numbers.non_negative, "kg", "Mass."),
    ]
}

static COUNTERWEIGHT_KEYS: [Key; 4] = counterweight_keys(&ONE_VALUE);
static OPEN_COUNTERWEIGHT_KEYS: [Key; 4] = counterweight_keys(&CHOICES);

/// The keys of a counterweight.
pub(crate) static COUNTERWEIGHT: Shape =
    Shape::new("counterweight", "A point mass that balances the arm.", &COUNTERWEIGHT_KEYS, &[]);

/// The keys of a counterweight of a study, whose mass may be open.
static OPEN_COUNTERWEIGHT: Shape = Shape::new(
    "counterweight",
    "A point mass that balances the arm. A list of masses is a choice.",
    &OPEN_COUNTERWEIGHT_KEYS,
    &[],
);

/// A list of pieces of a link.
pub(crate) const PIECES: Kind = Kind::NonEmpty(&Kind::Object(&PIECE));

/// The key for a factor on the moduli of a tube, for holes and inserts.
pub(crate) const STIFFNESS_FACTOR: Key = optional(
    "stiffness_factor",
    Kind::Positive,
    "-",
    "1",
    "Factor on the moduli of a tube, for holes and inserts.",
);

/// The key for a factor on the mass of a tube, for holes and inserts.
pub(crate) const MASS_FACTOR: Key =
    optional("mass_factor", Kind::Positive, "-", "1", "Factor on the mass of a tube, for holes and inserts.");

/// The keys of a piece of a link.
pub(crate) static PIECE: Shape = Shape::new(
    "piece",
    "A piece of a link: a step, or a taper.",
    &[
        required("length_m", Kind::Positive, "m", "Length; the pieces fill the link."),
        optional("material", Kind::Text, "-", "the link's", "Name of its material."),
        required("section", SECTION, "-", "The cross-section, of a taper at its start."),
        optional(
            "end_section",
            SECTION,
            "-",
            "none",
            "The cross-section at the end of a taper, of the same shape.",
        ),
        STIFFNESS_FACTOR,
        MASS_FACTOR,
    ],
    &[],
);

/// The keys of a payload.
pub(crate) static PAYLOAD: Shape = Shape::new(
    "payload",
    "What the arm holds at its tip.",
    &[
        BODY_MASS,
        optional("cg_m", VECTOR, "m", "[0, 0, 0]", "Centre of gravity from the tip, in the last frame."),
        optional(
            "inertia_about_cg_kgm2",
            Kind::Array(3, &Kind::NonNegative),
            "kg m²",
            "[0, 0, 0]",
            "Moments of inertia about the centre of gravity: ixx, iyy, izz.",
        ),
    ],
    &[],
);

/// The keys of the water around the arm.
pub(crate) static WATER: Shape = Shape::new(
    "water",
    "Water around the arm; links are sealed tubes.",
    &[
        required("density_kg_m3", Kind::Positive, "kg/m³", "Density of the water."),
        optional(
            "added_mass_coefficient",
            Kind::NonNegative,
            "-",
            "1.0",
            "Added mass across a link over the mass of the water that it displaces.",
        ),
        optional(
            "payload_density_kg_m3",
            Kind::Positive,
            "kg/m³",
            "7850",
            "Density of the payload, for its buoyancy.",
        ),
    ],
    &[],
);

/// The keys of the extras of a joint.
pub(crate) static EXTRAS: Shape = Shape::new(
    "extras",
    "What a joint weighs beyond gear, motor and bearing: points on the axis, inboard of the springs.",
    &[
        optional("housing_kg", Kind::NonNegative, "kg", "0", "Housing of the motor, or of gear and motor."),
        optional("brake_kg", Kind::NonNegative, "kg", "0", "Holding brake."),
        optional("encoder_kg", Kind::NonNegative, "kg", "0", "Encoders."),
        optional("flange_kg", Kind::NonNegative, "kg", "0", "Flange that carries the next link."),
        optional("cable_kg", Kind::NonNegative, "kg", "0", "Cables and connectors within the joint."),
    ],
    &[],
);
