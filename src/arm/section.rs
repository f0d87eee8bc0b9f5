//! Cross-sections of links, and the numbers of a material that the mechanics needs.
//!
//! | symbol | formula | source |
//! |---|---|---|
//! | `I` rectangular | `(b h³ - (b-2t)(h-2t)³)/12` | Eq 5 |
//! | `A` rectangular | `b h - (b-2t)(h-2t)` | Eq 6 |
//! | `J` rectangular | `2 t (b-t)² (h-t)² / ((b-t)+(h-t))` | Bredt, thin closed wall |
//! | `J` round | `2 I` | exact for a circular tube |
//! | shear factor, rectangular | `20(1+nu)/(48+39nu)` | Cowper 1966, thin square tube |
//! | shear factor, round | `2(1+nu)/(4+3nu)` | Cowper 1966, thin round tube |

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

/// A hollow cross-section. Height is along the z axis of the section, width along its y axis.
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
    /// Cowper's shear factor.
    pub shear_factor: f64,
    /// Area within the outer contour, which displaces water \[m²\].
    pub outer_area_m2: f64,
}

impl Section {
    /// Outer width and height \[m\]. For a round tube both are the diameter.
    pub fn outer_m(&self) -> (f64, f64) {
        match *self {
            Section::RectangularTube { width_m, height_m, .. } => (width_m, height_m),
            Section::RoundTube { diameter_m, .. } => (diameter_m, diameter_m),
        }
    }

    /// Wall thickness \[m\].
    pub fn wall_m(&self) -> f64 {
        match *self {
            Section::RectangularTube { wall_m, .. } | Section::RoundTube { wall_m, .. } => wall_m,
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
        }
    }
}

fn rectangular(b: f64, h: f64, t: f64, nu: f64) -> SectionProperties {
    let (bi, hi) = (b - 2.0 * t, h - 2.0 * t);
    let (bm, hm) = (b - t, h - t);
    SectionProperties {
        area_m2: b * h - bi * hi,
        second_moment_y_m4: (b * h.powi(3) - bi * hi.powi(3)) / 12.0,
        second_moment_z_m4: (h * b.powi(3) - hi * bi.powi(3)) / 12.0,
        torsion_constant_m4: 2.0 * t * bm * bm * hm * hm / (bm + hm),
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
        shear_factor: 2.0 * (1.0 + nu) / (4.0 + 3.0 * nu),
        outer_area_m2: PI / 4.0 * d * d,
    }
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
