//! Rows of `profiles.csv`, and the checks within one row.

use super::row::Row;
use crate::catalog::profile::{Profile, ProfileShape};
use std::f64::consts::PI;

/// The profile that a row describes; `None` if its name, shape, source or a dimension is blank or not valid.
pub(crate) fn profile(row: &Row) -> Option<Profile> {
    check(row);
    Some(Profile {
        designation: row.filled("designation")?.to_string(),
        shape: ProfileShape::from_word(row.text("shape"))?,
        material_family: row.filled("material_family")?.to_lowercase(),
        width_m: row.number("outer_b_m")?,
        height_m: row.number("outer_h_m")?,
        wall_m: row.number("wall_t_m")?,
        corner_radius_m: row.number("corner_radius_outer_m"),
        area_m2: row.number("area_m2"),
        second_moment_m4: row.number("second_moment_iy_m4"),
        mass_per_length_kg_m: row.number("mass_per_m_kg"),
        provenance: row.provenance()?,
    })
}

/// Outer width `b`, outer height `h` and wall `t` \[m\].
#[derive(Clone, Copy)]
struct Outline {
    b: f64,
    h: f64,
    t: f64,
}

fn check(row: &Row) {
    let (Some(b), Some(h), Some(t)) =
        (row.number("outer_b_m"), row.number("outer_h_m"), row.number("wall_t_m"))
    else {
        return;
    };
    for (column, x) in [("outer_b_m", b), ("outer_h_m", h)] {
        row.within(column, x, [1e-3, 5.0], [1e-3, 1.0], "write m (1 mm = 0.001 m)");
    }
    let shape = ProfileShape::from_word(row.text("shape"));
    if matches!(shape, Some(ProfileShape::Round | ProfileShape::Square)) && b != h {
        row.fault(
            "outer_h_m",
            format!("= {h} differs from outer_b_m = {b}"),
            "write both equal, or shape rectangular",
        );
    }
    if t >= b.min(h) / 2.0 {
        let hint = "a hollow profile's wall is less than half its smaller outer size; write m";
        return row.fault("wall_t_m", format!("= {t} leaves no hollow in {b} x {h}"), hint);
    }
    if let Some(shape) = shape {
        printed_properties(row, shape, Outline { b, h, t });
    }
}

/// Checks that the printed area, second moment of area and mass of a profile agree with the values that follow from
/// its outline.
fn printed_properties(row: &Row, shape: ProfileShape, outline: Outline) {
    let area_m2 = row.number("area_m2");
    if let Some(printed) = area_m2 {
        let computed = area(shape, outline, corner_radii(row, outline.t));
        // Without the corner radius only the area with sharp corners can be computed, which is larger than the real
        // area.
        let known = shape == ProfileShape::Round || row.number("corner_radius_outer_m").is_some();
        row.agrees("area_m2", printed, computed, "the outline", 0.025, if known { 0.025 } else { 0.12 });
    }
    if let Some(printed) = row.number("second_moment_iy_m4") {
        row.agrees(
            "second_moment_iy_m4",
            printed,
            second_moment(shape, outline),
            "the sharp outline",
            0.12,
            0.25,
        );
    }
    let density = density_kg_m3(row.text("material_family"));
    if let (Some(printed), Some(area_m2), Some(density)) = (row.number("mass_per_m_kg"), area_m2, density) {
        row.agrees("mass_per_m_kg", printed, area_m2 * density, "area and density", 0.012, 0.1);
    }
}

fn density_kg_m3(family: &str) -> Option<f64> {
    match family.to_lowercase().as_str() {
        "steel" => Some(7850.0),
        "aluminium" => Some(2700.0),
        "stainless" => Some(7900.0),
        _ => None,
    }
}

/// Outer and inner corner radius \[m\]; zero if the row gives none. For steel profiles the inner radius is taken equal
/// to the wall thickness.
fn corner_radii(row: &Row, wall_m: f64) -> [f64; 2] {
    let Some(outer) = row.number("corner_radius_outer_m") else { return [0.0, 0.0] };
    let steel = row.text("material_family").eq_ignore_ascii_case("steel");
    [outer, if steel { wall_m } else { (outer - wall_m).max(0.0) }]
}

fn area(shape: ProfileShape, Outline { b, h, t }: Outline, [outer, inner]: [f64; 2]) -> f64 {
    match shape {
        ProfileShape::Round => PI * (b - t) * t,
        _ => b * h - (b - 2.0 * t) * (h - 2.0 * t) - (4.0 - PI) * (outer.powi(2) - inner.powi(2)),
    }
}

fn second_moment(shape: ProfileShape, Outline { b, h, t }: Outline) -> f64 {
    match shape {
        ProfileShape::Round => PI / 64.0 * (b.powi(4) - (b - 2.0 * t).powi(4)),
        _ => (b * h.powi(3) - (b - 2.0 * t) * (h - 2.0 * t).powi(3)) / 12.0,
    }
}
