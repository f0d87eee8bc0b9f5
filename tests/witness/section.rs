//! Cross-sections of links, hollow and solid.

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
        let size_m = |key| number(section, key);
        match section["shape"].as_str() {
            Some("rectangular_tube") => {
                Self::rectangular(size_m("width_m"), size_m("height_m"), size_m("wall_m"), poisson)
            }
            Some("round_tube") => Self::round(size_m("diameter_m"), size_m("wall_m"), poisson),
            Some("rectangular_bar") => {
                let (width_m, height_m) = (size_m("width_m"), size_m("height_m"));
                let solid = Self::rectangular(width_m, height_m, 0.5 * width_m.min(height_m), poisson);
                Self { shear_factor: 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson), ..solid }
            }
            Some("round_bar") => {
                let diameter_m = size_m("diameter_m");
                let solid = Self::round(diameter_m, 0.5 * diameter_m, poisson);
                Self { shear_factor: 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson), ..solid }
            }
            other => panic!("unknown section shape {other:?}"),
        }
    }

    /// A rectangular tube.
    pub fn rectangular(width_m: f64, height_m: f64, wall_m: f64, poisson: f64) -> Self {
        let (hole_width_m, hole_height_m) = (width_m - 2.0 * wall_m, height_m - 2.0 * wall_m);
        Self {
            area_m2: width_m * height_m - hole_width_m * hole_height_m,
            outer_area_m2: width_m * height_m,
            inertia_y_m4: (width_m * height_m.powi(3) - hole_width_m * hole_height_m.powi(3)) / 12.0,
            inertia_z_m4: (height_m * width_m.powi(3) - hole_height_m * hole_width_m.powi(3)) / 12.0,
            torsion_m4: rectangle_in_torsion(width_m, height_m, wall_m).0,
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

/// Torsion constant \[m⁴\] of a rectangular tube, and its largest shear stress per torque \[1/m³\].
///
/// A membrane over the wall's middle line is Bredt's thin-walled tube. Walls above 0.15 of the smaller side also resist as
/// the strip they are, (t^3 / 3) a length, times a factor with which the wall that fills the tube is Saint-Venant's
/// prism; it is there in full from 0.155 on. In the same way the strip's t is added to the membrane's slope.
pub fn rectangle_in_torsion(width_m: f64, height_m: f64, wall_m: f64) -> (f64, f64) {
    let (short_m, long_m) = (width_m.min(height_m), width_m.max(height_m));
    let membrane = |t: f64| {
        let (area_m2, around_m) = ((short_m - t) * (long_m - t), 2.0 * (short_m + long_m - 2.0 * t));
        (4.0 * area_m2.powi(2) * t / around_m, 2.0 * area_m2 / around_m)
    };
    let strip_m4 = |t: f64| t.powi(3) / 3.0 * 2.0 * (short_m + long_m - 2.0 * t);
    let full_m = short_m / 2.0;
    let (prism_m4, prism_slope_m) = prism_in_torsion(short_m, long_m);
    let strip_factor = (prism_m4 - membrane(full_m).0) / strip_m4(full_m);
    let slope_factor = (prism_slope_m - membrane(full_m).1) / full_m;
    let there = ((wall_m / short_m - 0.15) / 0.005).clamp(0.0, 1.0);
    let torsion_m4 = membrane(wall_m).0 + there * strip_factor * strip_m4(wall_m);
    (torsion_m4, (membrane(wall_m).1 + there * slope_factor * wall_m) / torsion_m4)
}

/// Saint-Venant's series for a prism: J, and the steepest slope of the stress function per twist; enough terms for twelve
/// digits.
fn prism_in_torsion(short_m: f64, long_m: f64) -> (f64, f64) {
    let (mut warping, mut middle) = (0.0, 0.0);
    for n in (1..1000).step_by(2).map(f64::from).rev() {
        let half_turns = n * PI * long_m / (2.0 * short_m);
        warping += half_turns.tanh() / n.powi(5);
        middle += 1.0 / (half_turns.cosh() * n * n);
    }
    let j_m4 = long_m * short_m.powi(3) / 3.0 - 64.0 * short_m.powi(4) / PI.powi(5) * warping;
    (j_m4, short_m * (1.0 - 8.0 * middle / PI.powi(2)))
}
