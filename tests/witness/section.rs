//! Cross-sections of hollow links.

use serde_json::Value;
use std::f64::consts::PI;

use super::arm::number;

/// What a beam needs to know of its section; y along the width, z along the height.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    pub area_m2: f64,
    /// Area of the fluid a sealed tube displaces, per length.
    pub outer_area_m2: f64,
    /// Integral of z^2: bending in the x-z plane.
    pub inertia_y_m4: f64,
    /// Integral of y^2: bending in the x-y plane.
    pub inertia_z_m4: f64,
    pub torsion_m4: f64,
    /// Cowper's factor on the area in shear.
    pub shear_factor: f64,
}

impl Section {
    pub fn from_json(section: &Value, poisson: f64) -> Self {
        let wall_m = number(section, "wall_m");
        match section["shape"].as_str() {
            Some("rectangular_tube") => {
                Self::rectangular(number(section, "width_m"), number(section, "height_m"), wall_m, poisson)
            }
            Some("round_tube") => Self::round(number(section, "diameter_m"), wall_m, poisson),
            other => panic!("unknown section shape {other:?}"),
        }
    }

    /// A rectangular tube; torsion by Bredt's thin-wall formula over the wall's middle line.
    pub fn rectangular(width_m: f64, height_m: f64, wall_m: f64, poisson: f64) -> Self {
        let (hole_width_m, hole_height_m) = (width_m - 2.0 * wall_m, height_m - 2.0 * wall_m);
        let (mid_width_m, mid_height_m) = (width_m - wall_m, height_m - wall_m);
        Self {
            area_m2: width_m * height_m - hole_width_m * hole_height_m,
            outer_area_m2: width_m * height_m,
            inertia_y_m4: (width_m * height_m.powi(3) - hole_width_m * hole_height_m.powi(3)) / 12.0,
            inertia_z_m4: (height_m * width_m.powi(3) - hole_height_m * hole_width_m.powi(3)) / 12.0,
            torsion_m4: 2.0 * wall_m * (mid_width_m * mid_height_m).powi(2) / (mid_width_m + mid_height_m),
            shear_factor: 20.0 * (1.0 + poisson) / (48.0 + 39.0 * poisson),
        }
    }

    /// A round tube; torsion exact.
    pub fn round(diameter_m: f64, wall_m: f64, poisson: f64) -> Self {
        let hole_m = diameter_m - 2.0 * wall_m;
        let inertia_m4 = PI / 64.0 * (diameter_m.powi(4) - hole_m.powi(4));
        Self {
            area_m2: PI / 4.0 * (diameter_m.powi(2) - hole_m.powi(2)),
            outer_area_m2: PI / 4.0 * diameter_m.powi(2),
            inertia_y_m4: inertia_m4,
            inertia_z_m4: inertia_m4,
            torsion_m4: 2.0 * inertia_m4,
            shear_factor: 2.0 * (1.0 + poisson) / (4.0 + 3.0 * poisson),
        }
    }
}
