//! Cross-sections of links, and the numbers of a material that the mechanics needs.
//!
//! | symbol | formula | source |
//! |---|---|---|
//! | `I` rectangular | `(b h³ - (b-2t)(h-2t)³)/12` | Eq 5 |
//! | `A` rectangular | `b h - (b-2t)(h-2t)` | Eq 6 |
//! | `J` rectangular | Bredt for thin walls; thick ones and bars after Saint-Venant | `torsion.rs` |
//! | `J` round | `2 I` | exact for a circular tube |
//! | shear factor, rectangular | `20(1+nu)/(48+39nu)` | Cowper 1966, thin square tube |
//! | shear factor, round | `2(1+nu)/(4+3nu)` | Cowper 1966, thin round tube |
//! | shear factor, bars | `10(1+nu)/(12+11nu)`, round `6(1+nu)/(7+6nu)` | Cowper 1966, solid sections |
//!
//! A bar is a tube whose wall is half its smaller side: `A` and `I` are the same formulas.

use super::torsion;
use std::f64::consts::PI;

/// Elastic properties and density of the material of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkMaterial {
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Shear modulus \[Pa\].
    pub shear_modulus_pa: f64,
    /// Density \[kg/m³\].
    pub density_kg_m3: f64,
    /// Poisson's ratio. It is used in Cowper's shear factor only, and never follows from E and G.
    pub poisson: f64,
}

impl LinkMaterial {
    /// The material with E and G multiplied by a factor.
    #[must_use]
    pub fn stiffened(&self, factor: f64) -> LinkMaterial {
        LinkMaterial {
            youngs_modulus_pa: self.youngs_modulus_pa * factor,
            shear_modulus_pa: self.shear_modulus_pa * factor,
            ..*self
        }
    }
}

/// A cross-section, hollow or solid. Height is along the z axis of the section, width along its y axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Section {
    /// Rectangular tube with sharp corners.
    RectangularTube {
        /// Outer width b \[m\].
        width_m: f64,
        /// Outer height h \[m\].
        height_m: f64,
        /// Wall thickness t \[m\].
        wall_m: f64,
    },
    /// Round tube.
    RoundTube {
        /// Outer diameter \[m\].
        diameter_m: f64,
        /// Wall thickness \[m\].
        wall_m: f64,
    },
    /// Solid rectangular bar.
    RectangularBar {
        /// Width b \[m\].
        width_m: f64,
        /// Height h \[m\].
        height_m: f64,
    },
    /// Solid round bar.
    RoundBar {
        /// Diameter \[m\].
        diameter_m: f64,
    },
}

/// Geometric properties of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionProperties {
    /// Cross-section area A \[m²\].
    pub area_m2: f64,
    /// Second moment of area about y, for bending that moves the link along z \[m⁴\].
    pub second_moment_y_m4: f64,
    /// Second moment of area about z, for bending that moves the link along y \[m⁴\].
    pub second_moment_z_m4: f64,
    /// Torsion constant J \[m⁴\].
    pub torsion_constant_m4: f64,
    /// Largest shear stress of torsion per torque \[1/m³\].
    pub torsion_shear_per_m3: f64,
    /// Cowper's shear factor.
    pub shear_factor: f64,
    /// Area within the outer contour, which displaces water \[m²\].
    pub outer_area_m2: f64,
}

impl Section {
    /// Outer width and height \[m\]. For a round section both are the diameter.
    pub fn outer_m(&self) -> (f64, f64) {
        match *self {
            Section::RectangularTube { width_m, height_m, .. }
            | Section::RectangularBar { width_m, height_m } => (width_m, height_m),
            Section::RoundTube { diameter_m, .. } | Section::RoundBar { diameter_m } => {
                (diameter_m, diameter_m)
            }
        }
    }

    /// Wall thickness \[m\]. That of a bar is half its smaller side.
    pub fn wall_m(&self) -> f64 {
        match *self {
            Section::RectangularTube { wall_m, .. } | Section::RoundTube { wall_m, .. } => wall_m,
            Section::RectangularBar { width_m, height_m } => width_m.min(height_m) / 2.0,
            Section::RoundBar { diameter_m } => diameter_m / 2.0,
        }
    }

    /// Whether the outer contour is a circle.
    pub fn is_round(&self) -> bool {
        matches!(self, Section::RoundTube { .. } | Section::RoundBar { .. })
    }

    /// Whether the section has no hollow.
    pub fn is_bar(&self) -> bool {
        matches!(self, Section::RectangularBar { .. } | Section::RoundBar { .. })
    }

    /// The word that files use for the shape.
    pub fn shape(&self) -> &'static str {
        match self {
            Section::RectangularTube { .. } => "rectangular_tube",
            Section::RoundTube { .. } => "round_tube",
            Section::RectangularBar { .. } => "rectangular_bar",
            Section::RoundBar { .. } => "round_bar",
        }
    }

    /// The bar that a tube is if its wall fills the whole section, else the section itself.
    #[must_use]
    pub fn closed(self) -> Section {
        let (width_m, height_m) = self.outer_m();
        if 2.0 * self.wall_m() < width_m.min(height_m) {
            return self;
        }
        match self.is_round() {
            true => Section::RoundBar { diameter_m: width_m },
            false => Section::RectangularBar { width_m, height_m },
        }
    }

    /// Geometric properties of the section. `poisson` is Poisson's ratio of the material; the shear factor depends on it.
    ///
    /// ```
    /// use armwright::arm::Section;
    ///
    /// let section = Section::RectangularTube { width_m: 0.16, height_m: 0.16, wall_m: 0.01 };
    /// let properties = section.properties(0.3);
    /// assert!((properties.area_m2 - 0.006).abs() < 1e-15);
    /// assert!((properties.second_moment_y_m4 - 2.26e-5).abs() < 1e-8, "Eq 5");
    /// ```
    pub fn properties(&self, poisson: f64) -> SectionProperties {
        match *self {
            Section::RectangularTube { width_m: b, height_m: h, wall_m: t } => rectangular(b, h, t, poisson),
            Section::RoundTube { diameter_m, wall_m } => round(diameter_m, wall_m, poisson),
            Section::RectangularBar { width_m, height_m } => rectangular_bar(width_m, height_m, poisson),
            Section::RoundBar { diameter_m } => round_bar(diameter_m, poisson),
        }
    }
}

fn rectangular(b: f64, h: f64, t: f64, nu: f64) -> SectionProperties {
    let (bi, hi) = (b - 2.0 * t, h - 2.0 * t);
    let torsion = torsion::tube(b, h, t);
    SectionProperties {
        area_m2: b * h - bi * hi,
        second_moment_y_m4: (b * h.powi(3) - bi * hi.powi(3)) / 12.0,
        second_moment_z_m4: (h * b.powi(3) - hi * bi.powi(3)) / 12.0,
        torsion_constant_m4: torsion.constant_m4,
        torsion_shear_per_m3: torsion.shear_per_m3,
        shear_factor: 20.0 * (1.0 + nu) / (48.0 + 39.0 * nu),
        outer_area_m2: b * h,
    }
}

fn round(d: f64, t: f64, nu: f64) -> SectionProperties {
    let di = d - 2.0 * t;
    let second_moment = PI / 64.0 * (d.powi(4) - di.powi(4));
    SectionProperties {
        area_m2: PI / 4.0 * (d * d - di * di),
        second_moment_y_m4: second_moment,
        second_moment_z_m4: second_moment,
        torsion_constant_m4: 2.0 * second_moment,
        torsion_shear_per_m3: d / 2.0 / (2.0 * second_moment),
        shear_factor: 2.0 * (1.0 + nu) / (4.0 + 3.0 * nu),
        outer_area_m2: PI / 4.0 * d * d,
    }
}

fn rectangular_bar(b: f64, h: f64, nu: f64) -> SectionProperties {
    let torsion = torsion::bar(b, h);
    SectionProperties {
        area_m2: b * h,
        second_moment_y_m4: b * h.powi(3) / 12.0,
        second_moment_z_m4: h * b.powi(3) / 12.0,
        torsion_constant_m4: torsion.constant_m4,
        torsion_shear_per_m3: torsion.shear_per_m3,
        shear_factor: 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu),
        outer_area_m2: b * h,
    }
}

fn round_bar(d: f64, nu: f64) -> SectionProperties {
    SectionProperties { shear_factor: 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu), ..round(d, d / 2.0, nu) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_link_1_has_the_second_moment_of_eq_5() {
        let section = Section::RectangularTube { width_m: 0.16, height_m: 0.16, wall_m: 0.01 };
        let p = section.properties(0.3);
        assert!((p.second_moment_y_m4 - (0.16f64.powi(4) - 0.14f64.powi(4)) / 12.0).abs() < 1e-18);
        assert!((p.area_m2 - 0.006).abs() < 1e-15);
        assert!((p.torsion_constant_m4 - 0.01 * 0.15f64.powi(3)).abs() < 1e-15);
    }

    #[test]
    fn a_thin_round_tube_approaches_pi_d3_t_over_8() {
        let (d, t) = (0.1, 1e-5);
        let p = Section::RoundTube { diameter_m: d, wall_m: t }.properties(0.3);
        assert!((p.second_moment_z_m4 / (PI * d.powi(3) * t / 8.0) - 1.0).abs() < 1e-3);
        assert!((p.torsion_constant_m4 / p.second_moment_z_m4 - 2.0).abs() < 1e-12);
    }
}
