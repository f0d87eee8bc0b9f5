//! Properties of a link option that do not depend on the pose: mass, cost, slenderness of the wall and stress
//! factors.

use super::design_space::{DesignSpace, LinkOption};
use super::station::Place;
use nalgebra::{Vector3, Vector6};

/// Properties of a link option on which the limits and the objectives of a study depend, in addition to stiffness and
/// inertia.
pub(crate) struct OptionAttributes {
    /// Mass of the link \[kg\].
    pub mass_kg: f64,
    /// Index of the material in the study's list. `None` for a tube that the study gives: it has no influence on the
    /// group (material) of a design.
    pub material: Option<usize>,
    /// Cost of the material \[EUR\]; `None` if unknown.
    pub cost_eur: Option<f64>,
    /// Factors from which the stress in the link is computed; `None` if the strength of the material is unknown.
    pub stress: Option<StressCheck>,
    /// Whether the wall is more slender than the study allows.
    pub slender: bool,
}

/// Factors with which the forces and moments at an end of a link give its equivalent stress (von Mises; in a material
/// with a shear strength of its own, Tsai and Hill). Forces and moments are in
/// the section frame of the link.
pub(crate) struct StressCheck {
    /// Normal stress per axial force \[1/m²\].
    pub per_axial_n: f64,
    /// Largest normal stress per bending moment about the section's y axis \[1/m³\].
    pub per_moment_y: f64,
    /// Largest normal stress per bending moment about the section's z axis \[1/m³\].
    pub per_moment_z: f64,
    /// Largest shear stress per torsional moment \[1/m³\], times [`Strength::shear_factor`].
    pub per_torsion: f64,
    /// Whether the section is round. The stresses of the two bending moments then add as vectors.
    pub round: bool,
    /// Strength along the link, with which the stress is compared \[Pa\].
    pub strength_pa: f64,
}

impl StressCheck {
    pub(crate) fn new(option: &LinkOption) -> Option<Self> {
        let p = option.section.properties(option.material.poisson);
        let (width, height) = option.section.outer_m();
        let strength = option.material.strength?;
        Some(Self {
            per_axial_n: 1.0 / p.area_m2,
            per_moment_y: height / 2.0 / p.second_moment_y_m4,
            per_moment_z: width / 2.0 / p.second_moment_z_m4,
            per_torsion: p.torsion_shear_per_m3 * strength.shear_factor(),
            round: option.section.is_round(),
            strength_pa: strength.along_pa,
        })
    }

    /// Ratio of the equivalent stress (bending, axial force and torsion) to the strength, at the point `at_m` \[m\] of
    /// the link's axis. `wrench` is the force and moment that the section at this point transmits, with the moment
    /// taken about the world's origin. `place` is the position and attitude of the link.
    pub(crate) fn ratio(&self, wrench: &Vector6<f64>, at_m: &Vector3<f64>, place: &Place) -> f64 {
        let [axial_n, torsion_nm, moment_y_nm, moment_z_nm] = place.local(wrench, at_m);
        let (y, z) = (moment_y_nm.abs() * self.per_moment_y, moment_z_nm.abs() * self.per_moment_z);
        // In a corner of a rectangle the stresses of both bending moments add. In a circle the two stresses have their
        // maxima at different points.
        let bending = if self.round { libm::hypot(y, z) } else { y + z };
        let normal = axial_n.abs() * self.per_axial_n + bending;
        let shear = torsion_nm.abs() * self.per_torsion;
        von_mises(normal, shear) / self.strength_pa
    }
}

/// Von Mises stress of a normal stress and a shear stress. The result has the unit of the arguments.
pub(crate) fn von_mises(normal: f64, shear: f64) -> f64 {
    (normal * normal + 3.0 * shear * shear).sqrt()
}

/// The properties of a link of the length `length_m` \[m\] with the material and section of `option`. The limit of
/// `space` on the slenderness of walls is checked.
pub(crate) fn attributes_of(space: &DesignSpace, option: &LinkOption, length_m: f64) -> OptionAttributes {
    let mass_kg = option.mass_kg_per_m() * length_m;
    OptionAttributes {
        slender: space.constraints.wall_slenderness_max.is_some_and(|max| option.wall_slenderness() > max),
        mass_kg,
        material: Some(option.material_index),
        cost_eur: option.cost_eur_per_kg.map(|cost| cost * mass_kg),
        stress: StressCheck::new(option),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::section::{LinkMaterial, Section, Strength};

    /// `τ = T r / J` on the outside of a round tube with a thick wall; Bredt's formula gives a sixth less here.
    #[test]
    fn a_round_tube_is_twisted_most_on_its_outside() {
        let material = LinkMaterial {
            youngs_modulus_pa: 2.1e11,
            shear_modulus_pa: 8.1e10,
            density_kg_m3: 7850.0,
            poisson: 0.3,
            strength: Some(Strength { along_pa: 355e6, shear_pa: None }),
            class: None,
        };
        let section = Section::RoundTube { diameter_m: 0.06, wall_m: 0.012 };
        let option = LinkOption::given(material, section);
        let check = StressCheck::new(&option).unwrap();
        let polar_m4 = std::f64::consts::PI / 32.0 * (0.06f64.powi(4) - 0.036f64.powi(4));
        let shear_pa = 0.03 / polar_m4;
        assert!((check.per_torsion / shear_pa - 1.0).abs() < 1e-12);
    }
}
