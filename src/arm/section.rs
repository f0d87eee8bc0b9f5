//! Cross-sections of links, and the properties of a material that the mechanics needs.
//!
//! | symbol | formula | source |
//! |---|---|---|
//! | `I` rectangular | `(b h³ - (b-2t)(h-2t)³)/12` | Eq 5 of docs/model.md |
//! | `A` rectangular | `b h - (b-2t)(h-2t)` | Eq 6 of docs/model.md |
//! | `J` rectangular | Bredt for thin walls; thick walls and bars after Saint-Venant | `torsion.rs` |
//! | `J` I | two flanges, web and junctions; free to warp | `torsion.rs` |
//! | `Cw` I | `Iz (h-t)²/4`, t the flange | warping constant, Vlasov's thin-walled beams |
//! | `J` round | `2 I` | exact for a circular tube |
//! | shear factor, rectangular | `20(1+nu)/(48+39nu)` | Cowper 1966, thin square tube |
//! | shear factor, round | `2(1+nu)/(4+3nu)` | Cowper 1966, thin round tube |
//! | shear factor, I | in `i_beam` | Cowper 1966, thin-walled I section |
//! | shear factor, bars | `10(1+nu)/(12+11nu)`, round `6(1+nu)/(7+6nu)` | Cowper 1966, solid sections |
//!
//! A solid bar is treated as a tube whose wall is half its smaller side: the same formulas of `A` and `I` apply.

use super::torsion;
use crate::catalog::material::{MaterialClass, isotropic_shear_modulus_pa};
use std::f64::consts::PI;

/// A size of a section in millimetres, rounded to a nanometre: 48.3 for a tube of 48.3 mm, whose metres times 1000 are
/// 48.300000000000004. Every text and table that prints a size of a section uses this function.
pub(crate) fn millimetres(size_m: f64) -> f64 {
    (size_m * 1e9).round() / 1e6
}

/// Elastic properties and density of the material of a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkMaterial {
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Shear modulus \[Pa\].
    pub shear_modulus_pa: f64,
    /// Density \[kg/m³\].
    pub density_kg_m3: f64,
    /// Poisson's ratio. It is used only in Cowper's shear factor. It is never derived from E and G.
    pub poisson: f64,
    /// Strength of the material; `None` if it is not known. Then no stress is compared with it.
    pub strength: Option<Strength>,
    /// Class of the material, from which a report knows whether it creeps. `None` if it is not stated. No number
    /// depends on it.
    pub class: Option<MaterialClass>,
}

impl LinkMaterial {
    /// This material with E and G multiplied by `factor`. Density and Poisson's ratio stay.
    #[must_use]
    pub fn stiffened(&self, factor: f64) -> LinkMaterial {
        LinkMaterial {
            youngs_modulus_pa: self.youngs_modulus_pa * factor,
            shear_modulus_pa: self.shear_modulus_pa * factor,
            ..*self
        }
    }

    /// Whether the shear modulus is less than half of that of an isotropic material, `E/2(1+ν)`. The strength in shear
    /// of such a material does not follow from its strength along the link.
    pub(crate) fn is_soft_in_shear(&self) -> bool {
        self.shear_modulus_pa < 0.5 * isotropic_shear_modulus_pa(self.youngs_modulus_pa, self.poisson)
    }
}

/// Strength of a material along a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strength {
    /// Strength along the link \[Pa\]. Bending puts one side of a link in tension and the other in compression, so this
    /// is the lower of both strengths.
    pub along_pa: f64,
    /// Strength in shear \[Pa\]. `None` in an isotropic material, for which von Mises gives `along_pa / √3`.
    pub shear_pa: Option<f64>,
}

impl Strength {
    /// Factor on a shear stress τ such that von Mises' stress √(σ² + 3 τ²) reaches `along_pa` where the criterion of the
    /// material is reached: (σ/X)² + (τ/S)² = 1 with X along the link and S in shear. This is the criterion of Tsai and
    /// Hill for a layer of fibres along the link. The factor is 1 in an isotropic material.
    pub fn shear_factor(&self) -> f64 {
        self.shear_pa.map_or(1.0, |shear_pa| self.along_pa / (3f64.sqrt() * shear_pa))
    }
}

/// A cross-section, hollow or solid. Height is along the z axis of the section, width along its y axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Section {
    /// Rectangular tube with sharp edges.
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
    /// I section with its web upright. Only a given link can have it; no study chooses one.
    IBeam {
        /// Width b of the flanges \[m\].
        width_m: f64,
        /// Height h over the flanges \[m\].
        height_m: f64,
        /// Thickness of the web \[m\].
        web_m: f64,
        /// Thickness of the flanges \[m\].
        flange_m: f64,
    },
    /// A section given by its stiffnesses and its mass. Only a given link can have it.
    Stated(StatedSection),
}

/// A section given by its stiffnesses and its mass. Its area and second moments of area are computed such that, with a
/// fictitious [`material`](Self::material), stiffnesses and mass are as stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedSection {
    /// Outer width \[m\], used for pictures, buoyancy and the lever of a bearing.
    pub width_m: f64,
    /// Outer height \[m\].
    pub height_m: f64,
    /// Bending stiffness E I for bending that moves the link along z \[N m²\].
    pub ei_y_nm2: f64,
    /// Bending stiffness E I for bending that moves the link along y \[N m²\].
    pub ei_z_nm2: f64,
    /// Torsional stiffness G J \[N m²\].
    pub gj_nm2: f64,
    /// Axial stiffness E A \[N\]; infinite if it is not stated. The mechanics then uses the E A for which the mass is
    /// spread evenly over the rectangle of width and height.
    pub ea_n: f64,
    /// Mass per length \[kg/m\].
    pub kg_per_m: f64,
}

/// Shear modulus of the fictitious material of a stated section \[Pa\]. It is so large that shear deformation is
/// negligible. It is Young's modulus too if the section has no mass, because E A divided by the mass per length is then
/// infinite.
const STATED_PA: f64 = 1e15;

impl StatedSection {
    /// The fictitious material with which the section has its stated stiffnesses and mass. Its density is 1 kg/m³.
    /// Shear stiffness is not stated, so it is taken as practically infinite.
    pub fn material(&self) -> LinkMaterial {
        // Modulus and density also determine the rotary inertia per length about the axis, ρ (Iy + Iz) = m' (EIy + EIz)
        // / EA, where m' is the mass per length. For a mass that is spread evenly over the rectangle b h it is m' (b² +
        // h²) / 12. If EA is not stated, it is chosen so that both are equal.
        let outline_m2 = (self.width_m * self.width_m + self.height_m * self.height_m) / 12.0;
        let even_ea_n = (self.ei_y_nm2 + self.ei_z_nm2) / outline_m2;
        let of_ea_pa = if self.ea_n.is_finite() { self.ea_n } else { even_ea_n } / self.kg_per_m;
        LinkMaterial {
            youngs_modulus_pa: if of_ea_pa.is_finite() { of_ea_pa } else { STATED_PA },
            shear_modulus_pa: STATED_PA,
            density_kg_m3: 1.0,
            poisson: 0.0,
            strength: None,
            class: None,
        }
    }

    fn properties(&self) -> SectionProperties {
        let LinkMaterial { youngs_modulus_pa: e_pa, shear_modulus_pa: g_pa, .. } = self.material();
        let torsion_constant_m4 = self.gj_nm2 / g_pa;
        SectionProperties {
            area_m2: self.kg_per_m,
            second_moment_y_m4: self.ei_y_nm2 / e_pa,
            second_moment_z_m4: self.ei_z_nm2 / e_pa,
            torsion_constant_m4,
            torsion_shear_per_m3: self.width_m.max(self.height_m) / 2.0 / torsion_constant_m4,
            shear_factor: 1.0,
            outer_area_m2: self.width_m * self.height_m,
        }
    }
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
    /// Largest shear stress of torsion divided by the torque \[1/m³\].
    pub torsion_shear_per_m3: f64,
    /// Cowper's shear factor.
    pub shear_factor: f64,
    /// Area within the outer contour \[m²\]. It determines the water that the link displaces.
    pub outer_area_m2: f64,
}

impl Section {
    /// Outer width and height \[m\]. For a round section both are the diameter.
    pub fn outer_m(&self) -> (f64, f64) {
        match *self {
            Section::RectangularTube { width_m, height_m, .. }
            | Section::RectangularBar { width_m, height_m }
            | Section::IBeam { width_m, height_m, .. }
            | Section::Stated(StatedSection { width_m, height_m, .. }) => (width_m, height_m),
            Section::RoundTube { diameter_m, .. } | Section::RoundBar { diameter_m } => {
                (diameter_m, diameter_m)
            }
        }
    }

    /// Wall thickness \[m\]. For a section without a hollow it is half the smaller side.
    pub fn wall_m(&self) -> f64 {
        match *self {
            Section::RectangularTube { wall_m, .. } | Section::RoundTube { wall_m, .. } => wall_m,
            Section::RectangularBar { width_m, height_m }
            | Section::IBeam { width_m, height_m, .. }
            | Section::Stated(StatedSection { width_m, height_m, .. }) => width_m.min(height_m) / 2.0,
            Section::RoundBar { diameter_m } => diameter_m / 2.0,
        }
    }

    /// Warping constant Cw \[m⁶\] of a section whose twist depends much on whether its ends can warp; `None` for
    /// sections whose ends hardly warp. The mechanics does not use it.
    pub fn warping_constant_m6(&self) -> Option<f64> {
        match *self {
            Section::IBeam { height_m, flange_m, .. } => {
                let middles_m = height_m - flange_m;
                Some(self.properties(0.0).second_moment_z_m4 * middles_m * middles_m / 4.0)
            }
            _ => None,
        }
    }

    /// Whether the outer contour is a circle.
    pub fn is_round(&self) -> bool {
        matches!(self, Section::RoundTube { .. } | Section::RoundBar { .. })
    }

    /// Whether the section is a solid bar.
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
            Section::IBeam { .. } => "i_beam",
            Section::Stated(_) => "stated",
        }
    }

    /// The section itself. If the wall of a tube fills the whole section, the result is the solid bar that the tube
    /// then is.
    #[must_use]
    pub fn closed(self) -> Section {
        if matches!(self, Section::IBeam { .. } | Section::Stated(_)) {
            return self;
        }
        let (width_m, height_m) = self.outer_m();
        if 2.0 * self.wall_m() < width_m.min(height_m) {
            return self;
        }
        match self.is_round() {
            true => Section::RoundBar { diameter_m: width_m },
            false => Section::RectangularBar { width_m, height_m },
        }
    }

    /// Geometric properties of the section. `poisson` is Poisson's ratio of the material, on which the shear factor
    /// depends.
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
            Section::IBeam { width_m, height_m, web_m, flange_m } => {
                i_beam([width_m, height_m, web_m, flange_m], poisson)
            }
            Section::Stated(stated) => stated.properties(),
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

/// Properties of an I section. The torsion constant is the sum over three thin strips: the two flanges, and the web
/// between their middles. Cowper's shear factor is for shear along the web. It is used for shear across the web as
/// well, where bending of the flanges is far larger than shear.
fn i_beam([b, h, web, flange]: [f64; 4], nu: f64) -> SectionProperties {
    let clear = h - 2.0 * flange;
    let middles = h - flange;
    let torsion_constant_m4 = torsion::i_constant(b, h, web, flange);
    let (m, n) = (2.0 * b * flange / (middles * web), b / middles);
    let shear_factor = 10.0 * (1.0 + nu) * (1.0 + 3.0 * m).powi(2)
        / ((12.0 + 72.0 * m + 150.0 * m * m + 90.0 * m.powi(3))
            + nu * (11.0 + 66.0 * m + 135.0 * m * m + 90.0 * m.powi(3))
            + 30.0 * n * n * (m + m * m)
            + 5.0 * nu * n * n * (8.0 * m + 9.0 * m * m));
    SectionProperties {
        area_m2: 2.0 * b * flange + clear * web,
        second_moment_y_m4: (b * h.powi(3) - (b - web) * clear.powi(3)) / 12.0,
        second_moment_z_m4: (2.0 * flange * b.powi(3) + clear * web.powi(3)) / 12.0,
        torsion_constant_m4,
        torsion_shear_per_m3: flange.max(web) / torsion_constant_m4,
        shear_factor,
        outer_area_m2: 2.0 * b * flange + clear * web,
    }
}

fn round_bar(d: f64, nu: f64) -> SectionProperties {
    SectionProperties { shear_factor: 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu), ..round(d, d / 2.0, nu) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn millimetres_have_no_digits_of_rounding() {
        for mm in [48.3, 2.6 + 0.1, 0.1 + 0.2, 114.3, 3.175, 60.0] {
            let said = format!("{}", millimetres(mm / 1e3));
            assert!(said.len() <= 5 && (said.parse::<f64>().unwrap() - mm).abs() < 1e-9, "{said}");
            assert_eq!(said, format!("{}", millimetres(mm * 1e-3)), "either way into metres");
        }
    }

    #[test]
    fn the_papers_link_1_has_the_second_moment_of_eq_5() {
        let section = Section::RectangularTube { width_m: 0.16, height_m: 0.16, wall_m: 0.01 };
        let p = section.properties(0.3);
        assert!((p.second_moment_y_m4 - (0.16f64.powi(4) - 0.14f64.powi(4)) / 12.0).abs() < 1e-18);
        assert!((p.area_m2 - 0.006).abs() < 1e-15);
        assert!((p.torsion_constant_m4 - 0.01 * 0.15f64.powi(3)).abs() < 1e-15);
    }

    #[test]
    fn an_i_section_has_the_moments_of_the_tables() {
        // IPE 200: 100 x 200 mm, web 5.6 mm, flange 8.5 mm. Tables list 1943 and 142 cm4 and 28.5 cm2 including the
        // fillets, which are up to 5.5 % of these numbers
        let section = Section::IBeam { width_m: 0.1, height_m: 0.2, web_m: 0.0056, flange_m: 0.0085 };
        let p = section.properties(0.3);
        assert!((0.945..1.0).contains(&(p.second_moment_y_m4 / 1.943e-5)), "{p:?}");
        assert!((0.99..1.0).contains(&(p.second_moment_z_m4 / 1.42e-6)), "{p:?}");
        assert!((0.94..1.0).contains(&(p.area_m2 / 2.85e-3)), "{p:?}");
        // the web takes most of the shear
        let web_share = 0.0056 * (0.2 - 0.0085) / p.area_m2;
        assert!((0.75..1.1).contains(&(p.shear_factor / web_share)), "{p:?}, web {web_share}");
    }

    #[test]
    fn a_stated_section_has_the_stiffnesses_and_the_mass_that_it_states() {
        let stated = StatedSection {
            width_m: 0.05,
            height_m: 0.08,
            ei_y_nm2: 3e4,
            ei_z_nm2: 2e4,
            gj_nm2: 1e4,
            ea_n: 5e7,
            kg_per_m: 2.5,
        };
        for stated in [stated, StatedSection { ea_n: f64::INFINITY, ..stated }] {
            let (p, m) = (Section::Stated(stated).properties(0.0), stated.material());
            let near = |x: f64, wanted: f64| assert!((x / wanted - 1.0).abs() < 1e-12, "{x}, not {wanted}");
            near(m.youngs_modulus_pa * p.second_moment_y_m4, 3e4);
            near(m.youngs_modulus_pa * p.second_moment_z_m4, 2e4);
            near(m.shear_modulus_pa * p.torsion_constant_m4, 1e4);
            near(m.density_kg_m3 * p.area_m2, 2.5);
            assert!(stated.ea_n.is_infinite() || (m.youngs_modulus_pa * p.area_m2 / 5e7 - 1.0).abs() < 1e-12);
            assert!(m.youngs_modulus_pa * p.area_m2 >= 5e7 * (1.0 - 1e-12));
        }
    }

    #[test]
    fn a_thin_round_tube_approaches_pi_d3_t_over_8() {
        let (d, t) = (0.1, 1e-5);
        let p = Section::RoundTube { diameter_m: d, wall_m: t }.properties(0.3);
        assert!((p.second_moment_z_m4 / (PI * d.powi(3) * t / 8.0) - 1.0).abs() < 1e-3);
        assert!((p.torsion_constant_m4 / p.second_moment_z_m4 - 2.0).abs() < 1e-12);
    }
}
