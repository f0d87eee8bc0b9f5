//! A design as a flat table: one row for each joint and link, base to tip.

use super::bill::section_words;
use super::csv_text::csv_text;
use crate::arm::joint_law::Curve;
use crate::arm::{Arm, Element, Joint, Link, LinkBody, Prismatic};

const HEADER: [&str; 22] = [
    "element",
    "type",
    "axis_x",
    "axis_y",
    "axis_z",
    "x_m",
    "y_m",
    "z_m",
    "length_m",
    "section",
    "material",
    "mass_kg",
    "gear",
    "motor",
    "k1_nm_per_rad",
    "k2_nm_per_rad",
    "k3_nm_per_rad",
    "t1_nm",
    "t2_nm",
    "tilt_stiffness_nm_per_rad",
    "coupled",
    "stiffness_n_per_m",
];

/// The elements of an arm as a table, the content of `design.csv`.
pub(crate) fn design_csv(arm: &Arm) -> Vec<u8> {
    let rows = arm.chain.iter().map(|element| match element {
        Element::Joint(joint) => joint_row(joint, element.mass_kg()),
        Element::Prismatic(joint) => prismatic_row(joint, element.mass_kg()),
        Element::Link(link) => link_row(link, element.mass_kg()),
    });
    csv_text(&HEADER, rows)
}

/// A row of the table in which only the given columns are filled.
fn row(cells: Vec<(&str, String)>) -> Vec<String> {
    let cell = |column: &&str| cells.iter().find(|(name, _)| name == column).map(|(_, cell)| cell.clone());
    HEADER.iter().map(|column| cell(column).unwrap_or_default()).collect()
}

fn joint_row(joint: &Joint, mass_kg: f64) -> Vec<String> {
    let text = |x: f64| format!("{x}");
    let mut cells = vec![
        ("element", joint.name.clone()),
        ("type", "joint".into()),
        ("axis_x", text(joint.axis.x)),
        ("axis_y", text(joint.axis.y)),
        ("axis_z", text(joint.axis.z)),
        ("mass_kg", text(mass_kg)),
        ("gear", joint.gear.clone().unwrap_or_default()),
        ("motor", joint.motor.clone().unwrap_or_default()),
    ];
    match joint.curve {
        Curve::Rigid => {}
        // a curve with a single slope has only K1
        Curve::Linear(stiffness) => cells.push(("k1_nm_per_rad", text(stiffness))),
        Curve::Windup(w) | Curve::WindupK1(w) => cells.extend([
            ("k1_nm_per_rad", text(w.k1_nm_per_rad)),
            ("k2_nm_per_rad", text(w.k2_nm_per_rad)),
            ("k3_nm_per_rad", text(w.k3_nm_per_rad)),
            ("t1_nm", text(w.t1_nm)),
            ("t2_nm", text(w.t2_nm)),
        ]),
    }
    if let Some(tilt) = joint.bearing.and_then(|bearing| bearing.tilt_stiffness_nm_per_rad) {
        cells.push(("tilt_stiffness_nm_per_rad", text(tilt)));
    }
    let terms = joint.coupled.iter().flatten();
    let coupled: Vec<String> = terms.map(|(driver, factor)| format!("{factor} {driver}")).collect();
    cells.push(("coupled", coupled.join(" + ")));
    row(cells)
}

fn prismatic_row(joint: &Prismatic, mass_kg: f64) -> Vec<String> {
    let text = |x: f64| format!("{x}");
    row(vec![
        ("element", joint.name.clone()),
        ("type", "prismatic".into()),
        ("axis_x", text(joint.axis.x)),
        ("axis_y", text(joint.axis.y)),
        ("axis_z", text(joint.axis.z)),
        ("mass_kg", text(mass_kg)),
        ("stiffness_n_per_m", joint.stiffness_n_per_m.map(text).unwrap_or_default()),
    ])
}

fn link_row(link: &Link, mass_kg: f64) -> Vec<String> {
    let text = |x: f64| format!("{x}");
    let mut cells = vec![
        ("element", link.name.clone()),
        ("type", "link".into()),
        ("x_m", text(link.vector_m.x)),
        ("y_m", text(link.vector_m.y)),
        ("z_m", text(link.vector_m.z)),
        ("length_m", text(link.vector_m.norm())),
        ("mass_kg", text(mass_kg)),
    ];
    if let LinkBody::Tube { material_name, section, .. } = &link.body {
        cells.extend([("section", section_words(section)), ("material", material_name.clone())]);
    }
    row(cells)
}
