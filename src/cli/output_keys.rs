//! Keys of the JSON files that the program writes, for programs that read them. The columns of tables are in
//! `output_tables`.
//! `tests/program/output_schemas.rs` compares them with files that the program has written.

use crate::input::key::{Key, Kind, Shape, optional, required};
use crate::input::schema::FileKind;
use crate::interchange::keys::IMPORT_FILE;

/// The kinds of JSON files that the program writes and other programs read.
pub(super) const OUTPUTS: [FileKind; 6] = [
    FileKind {
        name: "run",
        about: "`run.json`: what was searched, how it ended, and the files of a study's result.",
        root: Kind::Object(&RUN),
    },
    FileKind {
        name: "shard",
        about: "`shard.json`: one shard of a search, as `armwright merge` reads it.",
        root: Kind::Object(&SHARD),
    },
    FileKind {
        name: "choices",
        about: "`choices.json`: a study whose choices of springs and counterweights were searched one by one.",
        root: Kind::Object(&CHOICES),
    },
    FileKind {
        name: "verdict",
        about: "`verdict.json`: what `armwright reconcile` found in a campaign.",
        root: Kind::Object(&VERDICT),
    },
    FileKind {
        name: "export",
        about: "`export.json`: what an export carries, what it leaves out, and what the other program must find.",
        root: Kind::Object(&EXPORT),
    },
    IMPORT_FILE,
];

const NUMBER_OR_NULL: Kind = Kind::Either(&[Kind::NonNegative, Kind::Null]);
const COUNT_OR_NULL: Kind = Kind::Either(&[Kind::Whole(0), Kind::Null]);
const WORDS: Kind = Kind::List(&Kind::Text);
const LIST: Kind = Kind::List(&Kind::Anything);
const STATUS: Kind = Kind::Word(&["complete", "certified", "partial", "interrupted", "infeasible"]);
const FILES: Key =
    required("files", Kind::Map(&Kind::Text), "-", "Every other file, with the BLAKE3 hash of its bytes.");
const OWN_HASH: Key = optional(
    "manifest_hash",
    Kind::Text,
    "-",
    "left out by early versions",
    "BLAKE3 hash of the other keys, without times and machine, so that an edited file is noticed.",
);
const NOT_WRITTEN: Key =
    required("not_written", WORDS, "-", "What could not be made or written; empty in a whole result.");
const VERSION: Key = required("tool_version", Kind::Text, "-", "Version of armwright that wrote the file.");
const SCHEMA_VERSION: Key = required("schema_version", Kind::Whole(1), "-", "Of this file.");
const STUDY: Key = required("study", Kind::Text, "-", "Name of the study.");
const STUDY_HASH: Key = required("study_hash", Kind::Text, "-", "BLAKE3 hash of the study's text.");
const CATALOGS_HASH: Key = required("catalogs_hash", Kind::Text, "-", "Hash of every catalog rating.");
const DESIGNS_TOTAL: Key =
    required("designs_total", Kind::NonNegative, "-", "Designs in the space; rounded above 2^53.");
const DESIGNS_EVALUATED: Key =
    required("designs_evaluated", Kind::Whole(0), "-", "Designs that were evaluated.");
const ELAPSED: Key = required("elapsed_s", Kind::NonNegative, "s", "How long the search took.");
const THREADS: Key = required("threads", Kind::Whole(1), "-", "Number of threads.");
const PLATFORM: Key = required("platform", Kind::Text, "-", "System and processor.");
const TIES_LISTED: Key =
    required("ties_listed", Kind::Flag, "-", "Whether tied drives are rows of their own.");

/// The shape of an object of which only the keys `keys` are described. The object may have any other keys.
const fn open(name: &'static str, about: &'static str, keys: &'static [Key]) -> Shape {
    Shape { name, about, keys, rules: &[], others: Some(&Kind::Anything) }
}

static RUN: Shape = Shape::new(
    "run",
    "A study's result. `docs/results-format.md` explains each key.",
    &[
        SCHEMA_VERSION,
        STUDY,
        required("question", Kind::Either(&[Kind::Text, Kind::Null]), "-", "Its question."),
        required("search", Kind::Word(&["exhaustive", "exact"]), "-", "How the front was found."),
        required("status", STATUS, "-", "How the search ended."),
        DESIGNS_TOTAL,
        DESIGNS_EVALUATED,
        required("designs_excluded", Kind::NonNegative, "-", "Designs that were left out."),
        required("front_size", Kind::Whole(0), "-", "Rows of `front.csv`."),
        required("hypervolume", Kind::Number, "-", "Of the front, in logarithms."),
        required("boxes", COUNT_OR_NULL, "-", "Boxes that an exact search bounded."),
        required("boxes_open", COUNT_OR_NULL, "-", "Boxes that an exact search left open."),
        required("gap", NUMBER_OR_NULL, "-", "The gap that an exact search proved; 0 for a whole front."),
        required(
            "proved_to_mass_kg",
            NUMBER_OR_NULL,
            "kg",
            "The mass up to which the front is proved whole.",
        ),
        TIES_LISTED,
        required(
            "picks",
            Kind::List(&Kind::Object(&PICK)),
            "-",
            "Lightest, stiffest, highest mode and knee.",
        ),
        ELAPSED,
        required("designs_per_s", Kind::NonNegative, "1/s", "Designs evaluated in a second."),
        THREADS,
        VERSION,
        PLATFORM,
        required("models", Kind::Map(&Kind::Text), "-", "Models of links and joints."),
        required("constraints", WORDS, "-", "The limits, in words."),
        required("cases", WORDS, "-", "The cases, in words."),
        required("materials", Kind::List(&Kind::Object(&MATERIAL)), "-", "The front of each material."),
        required("not_checked", WORDS, "-", "Options left out because a rating is blank."),
        required("remarks", WORDS, "-", "What a reader should know."),
        required(
            "caveats",
            Kind::Either(&[Kind::Text, Kind::Null]),
            "-",
            "Parts of the picks whose ratings were not seen in a document of the vendor, in a sentence.",
        ),
        required("effects", LIST, "-", "The study's effects, and whether they count."),
        required("effects_mass_kg", Kind::Number, "kg", "Mass that effects add to every design."),
        required("carried_over", LIST, "-", "Corrections of an arm file, and whether they apply."),
        required("catalogs", Kind::Either(&[Kind::Text, Kind::Null]), "-", "Folder of own rows."),
        STUDY_HASH,
        CATALOGS_HASH,
        NOT_WRITTEN,
        optional(
            "worst_poses",
            Kind::Anything,
            "-",
            "left out while not made",
            "Poses in which picks are worse.",
        ),
        optional(
            "lighter_on_same_drives",
            LIST,
            "-",
            "left out while not made",
            "Picks whose drives came with weight.",
        ),
        optional("ballast_designs", Kind::Whole(0), "-", "left out while not made", "Rows of `ballast.csv`."),
        optional(
            "tolerance",
            Kind::Anything,
            "-",
            "left out while not made",
            "The front under scatter, or null.",
        ),
        optional(
            "within",
            Kind::Anything,
            "-",
            "left out while not made",
            "Designs near the front, or null.",
        ),
        FILES,
        OWN_HASH,
    ],
    &[],
);

static CHOICES: Shape = Shape::new(
    "choices",
    "A study that was searched choice by choice, and its joint front.",
    &[
        SCHEMA_VERSION,
        STUDY,
        required("question", Kind::Text, "-", "Its question."),
        required("choices", Kind::List(&Kind::Object(&CHOICE)), "-", "The choices."),
        required("front_size", Kind::Whole(0), "-", "Rows of `front.csv`."),
        STUDY_HASH,
        CATALOGS_HASH,
        VERSION,
        FILES,
        OWN_HASH,
        NOT_WRITTEN,
    ],
    &[],
);

static CHOICE: Shape = Shape::new(
    "choice",
    "One choice of springs and counterweights.",
    &[
        required("folder", Kind::Text, "-", "Folder with its result."),
        required("words", Kind::Text, "-", "The choice in words."),
        required("values", Kind::Map(&Kind::Number), "-", "Each number that was chosen, by its column."),
        required("status", STATUS, "-", "How its search ended."),
        required("gap", NUMBER_OR_NULL, "-", "The gap that an exact search proved; 0 for a whole front."),
        required("front_size", Kind::Whole(0), "-", "Rows of its front."),
    ],
    &[],
);

static PICK: Shape = Shape::new(
    "pick",
    "A design of the front that is best in something.",
    &[
        required("names", WORDS, "-", "What it is picked for."),
        required("design_id", Kind::Text, "-", "Name of the design."),
        required("mass_kg", Kind::NonNegative, "kg", "Its mass."),
        required(
            "extras_mass_kg",
            Kind::NonNegative,
            "kg",
            "Of that, what joints weigh beyond their drives.",
        ),
        required(
            "mass_lower_bound_kg",
            NUMBER_OR_NULL,
            "kg",
            "No design that is as stiff and has as high a lowest mode weighs less.",
        ),
        required("mixture_kg", NUMBER_OR_NULL, "kg", "Approximate mass if parts could be blended."),
        required(
            "loads_oppose",
            Kind::Either(&[Kind::Flag, Kind::Null]),
            "-",
            "Whether loads of both signs weaken the bound; null if there is none.",
        ),
    ],
    &[],
);

static MATERIAL: Shape = Shape::new(
    "material",
    "The front of the designs whose links are all of one material.",
    &[
        required("name", Kind::Text, "-", "Catalog name."),
        required("slug", Kind::Text, "-", "Its part of file names."),
        required("status", STATUS, "-", "How its search ended."),
        required("front_size", Kind::Whole(0), "-", "Rows of its front."),
        required("cost_eur_per_kg", NUMBER_OR_NULL, "EUR/kg", "Price of the material."),
        TIES_LISTED,
    ],
    &[],
);

static SHARD: Shape = Shape::new(
    "shard",
    "A shard of a search.",
    &[
        SCHEMA_VERSION,
        STUDY,
        VERSION,
        STUDY_HASH,
        CATALOGS_HASH,
        required("flags", Kind::Object(&FLAGS), "-", "Kind of search."),
        DESIGNS_TOTAL,
        required("shard", Kind::Array(2, &Kind::Whole(1)), "-", "Its number and the number of shards."),
        optional(
            "range",
            Kind::Array(2, &Kind::Whole(0)),
            "-",
            "left out by an exact search",
            "First number of its designs, and the first after them.",
        ),
        optional(
            "fronts",
            Kind::List(&Kind::Object(&SHARD_FRONT)),
            "-",
            "left out by a visit",
            "What was searched for each front.",
        ),
        optional(
            "boxes",
            Kind::Whole(0),
            "-",
            "left out by a visit",
            "Boxes bounded for the front of all designs.",
        ),
        DESIGNS_EVALUATED,
        required("candidates", Kind::Whole(0), "-", "Designs found for the front of all designs."),
        required("proved", Kind::Flag, "-", "Whether no design of the shard is missing."),
        required("command", WORDS, "-", "Words that name study, limits, catalogs and search."),
        ELAPSED,
        THREADS,
        PLATFORM,
        FILES,
        OWN_HASH,
        NOT_WRITTEN,
    ],
    &[],
);

static FLAGS: Shape = Shape::new(
    "flags",
    "In these all shards of a search agree.",
    &[
        required("search", Kind::Word(&["exhaustive", "exact"]), "-", "Kind of search."),
        optional("gap", Kind::Below(1.0), "-", "left out by a visit", "Gap to which an exact search goes."),
    ],
    &[],
);

static SHARD_FRONT: Shape = Shape::new(
    "front of a shard",
    "What an exact search did for one front.",
    &[
        required("front", Kind::Text, "-", "`all`, or a material."),
        required("subtrees", WORDS, "-", "Names of the subtrees: the halves that lead to each."),
        DESIGNS_EVALUATED,
        required("boxes", Kind::Whole(0), "-", "Boxes bounded up to the end of this front."),
        required("gap", Kind::NonNegative, "-", "The gap that was proved."),
    ],
    &[],
);

static VERDICT: Shape = Shape::new(
    "verdict",
    "What was found in a campaign. `docs/reconcile.md` explains it.",
    &[
        required("schema", Kind::Whole(1), "-", "Version of this file's form."),
        required("campaign", Kind::Text, "-", "Name of the campaign."),
        required("campaign_blake3", Kind::Text, "-", "Hash of the campaign's files."),
        optional(
            "catalogs_hash",
            Kind::Text,
            "-",
            "left out by the library",
            "Hash of every catalog rating.",
        ),
        VERSION,
        required(
            "verdict",
            Kind::Word(&["no_gap", "explained", "unexplained", "insufficient_data"]),
            "-",
            "The verdict.",
        ),
        required("reasons", WORDS, "-", "Why, in sentences."),
        required(
            "effects",
            Kind::List(&Kind::Object(&FINDING)),
            "-",
            "Effects that explain the gap; empty unless explained.",
        ),
        required("suspects", Kind::List(&Kind::Object(&FINDING)), "-", "Effects that may be there."),
        required("empirical", Kind::List(&Kind::Object(&FINDING)), "-", "Laws without a name."),
        required("corrected_models", LIST, "-", "Models that the corrected arm could have."),
        required("kept_out", Kind::Anything, "-", "Errors on held-out readings, before and after."),
        required("located", Kind::Anything, "-", "Where the gap is."),
        required(
            "next_test",
            Kind::Anything,
            "-",
            "The test that separates best what is open; may be empty.",
        ),
        required("further_tests", LIST, "-", "The next best tests."),
        required("readings", Kind::Anything, "-", "Gross errors, and noise over what was declared."),
        required("lack_of_fit", Kind::Anything, "-", "Structure that is left; may be empty."),
        required("calibrated", LIST, "-", "Parameters calibrated within their tolerance."),
        required("records", LIST, "-", "What records against time show."),
        required("stages", LIST, "-", "Steps of an analysis of absolute positions."),
        required("evidence", LIST, "-", "Score of each candidate model."),
        optional("study", Kind::Anything, "-", "left out without --study", "The study under both models."),
        optional(
            "files",
            Kind::Map(&Kind::Text),
            "-",
            "left out by the library",
            "Every other file, with the BLAKE3 hash of its bytes.",
        ),
        OWN_HASH,
        optional(
            "not_written",
            WORDS,
            "-",
            "left out by the library",
            "What could not be made or written; empty in a whole result.",
        ),
    ],
    &[],
);

static FINDING: Shape = open(
    "finding",
    "An effect with its values.",
    &[
        required("effect", Kind::Text, "-", "Name of the effect (`armwright schema effects`)."),
        required("at", Kind::Text, "-", "Its place."),
        required("parameters", Kind::Map(&Kind::Object(&INTERVAL)), "-", "Its parameters."),
        required(
            "indistinguishable_from",
            LIST,
            "-",
            "At most three effects that these readings cannot tell from it.",
        ),
    ],
);

static INTERVAL: Shape = open(
    "interval",
    "A value with its interval; numbers, or lists of them.",
    &[
        required("value", Kind::Anything, "-", "Best value."),
        required("low", Kind::Anything, "-", "Lower end; null if the readings do not bound it."),
        required("high", Kind::Anything, "-", "Upper end; null if the readings do not bound it."),
    ],
);

static EXPORT: Shape = Shape::new(
    "export",
    "An export of an arm.",
    &[
        required("to", Kind::Word(&["calculix", "mjcf", "urdf", "json", "csv", "bom"]), "-", "The form."),
        required("arm", Kind::Text, "-", "Name of the arm."),
        required("mass_kg", Kind::NonNegative, "kg", "Its mass, without payload and effects."),
        required("effects_mass_kg", Kind::Number, "kg", "Mass that effects add, which is in the files too."),
        required(
            "case",
            Kind::Anything,
            "-",
            "The case at whose loads curves became numbers, as in cases files.",
        ),
        required("files", WORDS, "-", "Names of the files."),
        required("left_out", Kind::List(&Kind::Object(&LEFT_OUT)), "-", "What the files cannot carry."),
        required("notes", WORDS, "-", "What a reader of the files must know."),
        required(
            "expected",
            Kind::Either(&[Kind::Object(&EXPECTED), Kind::Null]),
            "-",
            "What a program must find; null if the files are no model.",
        ),
        VERSION,
    ],
    &[],
);

static LEFT_OUT: Shape = Shape::new(
    "left out",
    "Something that files do not carry.",
    &[
        required("what", Kind::Text, "-", "What it is."),
        required("at", Kind::Text, "-", "Where it is."),
        required("why", Kind::Text, "-", "Why, and what to do instead."),
        required("tip_share", Kind::Number, "-", "Its share of the tip's deflection."),
    ],
    &[],
);

static EXPECTED: Shape = Shape::new(
    "expected",
    "What a program must find that is given the files.",
    &[
        required("joint_torque_nm", Kind::Map(&Kind::Number), "N m", "What holds each joint that turns."),
        optional(
            "joint_force_n",
            Kind::Map(&Kind::Number),
            "N",
            "none",
            "What holds each joint that slides.",
        ),
        optional(
            "tip_displacement_m",
            Kind::Array(3, &Kind::Number),
            "m",
            "none",
            "Displacement of the tip.",
        ),
        optional("frequencies_hz", Kind::List(&Kind::Positive), "Hz", "none", "Lowest frequencies."),
    ],
    &[],
);
