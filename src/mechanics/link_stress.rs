//! The stress in a link: the forces and moments that a section transmits, and the ratio of the equivalent stress to the
//! strength of the material.

use super::chain::Chain;
use super::statics::SectionLoad;
use crate::arm::load::LoadCase;
use crate::arm::section::{LinkMaterial, Section};
use crate::arm::structure::Piece;
use crate::arm::{Arm, LinkModel};

/// Factors with which the forces and moments at an end of a link give its equivalent stress (von Mises; in a material
/// with a shear strength of its own, Tsai and Hill).
pub(crate) struct StressCheck {
    /// Normal stress per axial force \[1/m²\].
    pub per_axial_n: f64,
    /// Largest normal stress per bending moment about the section's y axis \[1/m³\].
    pub per_moment_y: f64,
    /// Largest normal stress per bending moment about the section's z axis \[1/m³\].
    pub per_moment_z: f64,
    /// Largest shear stress per torsional moment \[1/m³\], times
    /// [`Strength::shear_factor`](crate::arm::section::Strength::shear_factor).
    pub per_torsion: f64,
    /// Whether the section is round. The stresses of the two bending moments then add as vectors.
    pub round: bool,
    /// Strength along the link, with which the stress is compared \[Pa\].
    pub strength_pa: f64,
}

impl StressCheck {
    /// The check of a link of this material and section; `None` if the strength of the material is unknown.
    pub(crate) fn new(material: &LinkMaterial, section: &Section) -> Option<Self> {
        let p = section.properties(material.poisson);
        let (width, height) = section.outer_m();
        let strength = material.strength?;
        Some(Self {
            per_axial_n: 1.0 / p.area_m2,
            per_moment_y: height / 2.0 / p.second_moment_y_m4,
            per_moment_z: width / 2.0 / p.second_moment_z_m4,
            per_torsion: p.torsion_shear_per_m3 * strength.shear_factor(),
            round: section.is_round(),
            strength_pa: strength.along_pa,
        })
    }

    /// Ratio of the equivalent stress (bending, axial force and torsion) to the strength. The section transmits an axial
    /// force \[N\], a torsion and the bending moments about its y and z axes \[N m\].
    pub(crate) fn ratio(&self, [axial_n, torsion_nm, moment_y_nm, moment_z_nm]: [f64; 4]) -> f64 {
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

/// The links of an arm in a load case, prepared for the stress in them at rest. Only links whose material has a known
/// strength are judged.
pub(crate) struct LinkStresses {
    /// The arm, with its links divided where bodies and springs load them.
    chain: Chain,
    /// For each piece of this chain, the name of the link that it is a part of, and the check of its section.
    checks: Vec<Option<(String, StressCheck)>>,
}

impl LinkStresses {
    /// Prepares the links of `arm` in the structure that it has in `case`.
    pub(crate) fn new(arm: &Arm, case: &LoadCase) -> Self {
        let whole = arm.structure_in(case);
        let divided = whole.divided_at_loads();
        let checks = divided.structure.pieces.iter().zip(divided.whole).map(|(part, index)| {
            let (Piece::Link(part), Piece::Link(link)) = (part, &whole.pieces[index]) else { return None };
            let beam = part.beam?;
            Some((link.name.clone(), StressCheck::new(&beam.material, &beam.section)?))
        });
        // every link has to deform for its loads to be listed, and no load depends on the deformations
        Self { checks: checks.collect(), chain: Chain::new(&divided.structure, LinkModel::Full) }
    }

    /// Largest ratio of stress to strength in each link under the load of `case`, with the name of the link, base to
    /// tip.
    pub(crate) fn in_case(&self, case: &LoadCase) -> Vec<(&str, f64)> {
        let statics = self.chain.pose(case).statics();
        let mut out: Vec<(&str, f64)> = Vec::new();
        for (root, end) in statics.link_roots.iter().zip(&statics.link_ends) {
            let Some((name, check)) = &self.checks[root.piece] else { continue };
            let ratio = check.ratio(transmitted(root)).max(check.ratio(transmitted(end)));
            match out.last_mut() {
                Some((last, largest)) if last == name => *largest = largest.max(ratio),
                _ => out.push((name, ratio)),
            }
        }
        out
    }
}

/// Axial force, torsion and both bending moments of a section's load, as [`StressCheck::ratio`] takes them.
fn transmitted(load: &SectionLoad) -> [f64; 4] {
    let moment_nm = &load.moment_nm;
    [load.force_n.x, moment_nm.x, moment_nm.y, moment_nm.z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::section::Strength;

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
        let check = StressCheck::new(&material, &section).unwrap();
        let polar_m4 = std::f64::consts::PI / 32.0 * (0.06f64.powi(4) - 0.036f64.powi(4));
        let shear_pa = 0.03 / polar_m4;
        assert!((check.per_torsion / shear_pa - 1.0).abs() < 1e-12);
    }
}
