//! The columns of the tables that the program writes and other programs read, and their Table Schemas.

use crate::input::key::{Key, Kind, optional, required};
use serde_json::{Value, json};

/// A table that the program writes: its name, what it is, and its columns. In the names of columns, `<link>` and
/// `<joint>` stand for the names of links and joints.
pub(super) struct OutputTable {
    pub name: &'static str,
    pub about: &'static str,
    columns: &'static [Key],
}

/// The tables that other programs read.
pub(super) const TABLES: [OutputTable; 2] = [
    OutputTable {
        name: "front",
        about: "front.csv: a design of the front in each row, lightest first.",
        columns: &FRONT,
    },
    OutputTable {
        name: "bom",
        about: "bom.csv: equal parts in each row; masses add up to the arm's.",
        columns: &BOM,
    },
];

const NONE: &str = "blank";

static FRONT: [Key; 22] = [
    required("design_id", Kind::Text, "-", "Name of the design."),
    required("<link>_material", Kind::Text, "-", "Catalog name."),
    required("<link>_shape", Kind::Text, "-", "Shape of the section."),
    required("<link>_width_mm", Kind::Positive, "mm", "Outer size along the section's y."),
    required("<link>_height_mm", Kind::Positive, "mm", "Outer size along the section's z."),
    required("<link>_wall_mm", Kind::Positive, "mm", "Wall."),
    optional("<link>_profile", Kind::Text, "-", NONE, "Designation of a catalog profile."),
    optional("<joint>_gear", Kind::Text, "-", NONE, "Catalog name."),
    optional("<joint>_motor", Kind::Text, "-", NONE, "Catalog name."),
    required("tip_deflection_mm", Kind::NonNegative, "mm", "Largest over the judged poses."),
    required("mass_kg", Kind::NonNegative, "kg", "Links and drives."),
    required("lowest_mode_hz", Kind::NonNegative, "Hz", "Smallest over the judged poses."),
    required("tie_group", Kind::Whole(1), "-", "Designs of one number have equal objectives."),
    optional(
        "<joint>_margin",
        Kind::NonNegative,
        "-",
        NONE,
        "Allowed over needed value of the binding check.",
    ),
    optional("<joint>_binds", Kind::Text, "-", NONE, "That check."),
    optional(
        "<joint>_bearing_margin",
        Kind::NonNegative,
        "-",
        NONE,
        "Factor by which the bearing's loads may grow.",
    ),
    optional(
        "<joint>_motor_rms_margin",
        Kind::NonNegative,
        "-",
        NONE,
        "Continuous torque over root mean square.",
    ),
    optional("<joint>_input_rpm", Kind::NonNegative, "rpm", NONE, "Speed of the motor."),
    optional(
        "<joint>_critical_rpm",
        Kind::NonNegative,
        "rpm",
        NONE,
        "Speed at which the gear excites the lowest mode.",
    ),
    optional(
        "stress_safety_factor",
        Kind::NonNegative,
        "-",
        NONE,
        "Strength over stress, smallest over the links.",
    ),
    optional("material_cost_eur", Kind::NonNegative, "EUR", NONE, "Raw material of the open links."),
    required("extras_mass_kg", Kind::NonNegative, "kg", "What joints weigh beyond their drives."),
];

static BOM: [Key; 10] = [
    required("item", Kind::Whole(1), "-", "Number of the row."),
    required("count", Kind::Whole(1), "-", "How many there are."),
    required("part", Kind::Text, "-", "What it is."),
    required("kind", Kind::Text, "-", "Kind of part, such as gear, motor, link."),
    required("mass_kg", Kind::NonNegative, "kg", "Mass of all of them."),
    optional("length_m", Kind::NonNegative, "m", NONE, "Length of each link."),
    optional("source", Kind::Text, "-", NONE, "Where its figures are from."),
    optional("confidence", Kind::Text, "-", NONE, "How sure they are."),
    optional("cost_eur", Kind::NonNegative, "EUR", NONE, "Cost of all of them."),
    required("used_at", Kind::Text, "-", "Joints and links that have one."),
];

impl OutputTable {
    /// The columns as a Table Schema, a JSON description of a CSV file.
    pub(super) fn schema(&self) -> Value {
        let field = |column: &Key| {
            let kind = match column.kind {
                Kind::Whole(_) => "integer",
                Kind::Number | Kind::Positive | Kind::NonNegative => "number",
                _ => "string",
            };
            let mut out = json!({
                "name": column.name,
                "type": kind,
                "description": column.about,
                "constraints": {"required": column.default.is_none()},
            });
            if column.unit != "-" {
                out["unit"] = json!(column.unit);
            }
            out
        };
        json!({
            "title": format!("Armwright: {}", self.name),
            "description": self.about,
            "fields": self.columns.iter().map(field).collect::<Vec<_>>(),
            "missingValues": [""],
        })
    }
}
