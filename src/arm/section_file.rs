//! Reads sections that are neither tubes nor bars: I sections, and sections given by stiffnesses.

use super::keys::{I_BEAM, STATED};
use super::section::{Section, StatedSection};
use crate::input::json::Node;

/// Reads an I section. Returns `None` after recording a fault.
pub(super) fn read_i_beam(node: &Node) -> Option<Section> {
    let object = node.shaped(&I_BEAM)?;
    let [width_m, height_m, web_m, flange_m] =
        ["width_m", "height_m", "web_m", "flange_m"].map(|k| object.required(k).and_then(|n| n.positive()));
    let (width_m, height_m, web_m, flange_m) = (width_m?, height_m?, web_m?, flange_m?);
    if web_m > width_m || 2.0 * flange_m >= height_m {
        return node.fault(
            format!("has a web of {web_m} m and flanges of {flange_m} m in {width_m} x {height_m} m"),
            "web and flanges lie within the width and the height",
        );
    }
    Some(Section::IBeam { width_m, height_m, web_m, flange_m })
}

/// Reads a section that states its stiffnesses and its mass. Returns `None` after recording a fault.
pub(super) fn read_stated_section(node: &Node) -> Option<StatedSection> {
    let keys = ["width_m", "height_m", "ei_y_nm2", "ei_z_nm2", "gj_nm2", "kg_per_m"];
    let object = node.shaped(&STATED)?;
    let [width, height, ei_y, ei_z, gj, kg] = keys.map(|k| object.required(k).and_then(|n| n.positive()));
    let ea_n = object.or("ea_n", f64::INFINITY, Node::positive);
    Some(StatedSection {
        width_m: width?,
        height_m: height?,
        ei_y_nm2: ei_y?,
        ei_z_nm2: ei_z?,
        gj_nm2: gj?,
        ea_n: ea_n?,
        kg_per_m: kg?,
    })
}
