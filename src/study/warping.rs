//! Remarks on links whose restrained warping is left out: I sections.
//!
//! The mechanics takes the ends of every link as free to warp, so a torque M twists a link of length L by M L/(G J). If
//! one end is clamped against warping and the other is free, Vlasov's theory gives M L/(G J) (1 - tanh(kL)/(kL)) with k
//! = √(G J/(E Cw)); if both ends are clamped, the argument is kL/2, and the twist is less. For a steel IPE 200 of 0.6 m
//! the factor is 0.15: the part of a deflection that comes from its torsion is more than six times too large. A link
//! that carries no torsion is not affected.

use crate::arm::section::{LinkMaterial, Section};
use crate::arm::{Arm, Element, Link, LinkBody};
use crate::report::number::significant;
use crate::space::design_space::{DesignSpace, SpacePiece};

/// Factor on the twist above which no remark is made, because the ends are then practically free to warp.
const NEARLY_FREE: f64 = 0.95;

/// Links that follow each other without a joint and have sections that warp, as one beam.
struct Run<'a> {
    name: &'a str,
    /// Sum of k L over the links, with the length L and the decay constant k of each link.
    k_length: f64,
    length_m: f64,
}

/// Remarks on the links of an arm, one sentence for each beam that warps.
pub(super) fn of_arm(arm: &Arm) -> Vec<String> {
    sentences(arm.chain.iter().map(|element| match element {
        Element::Link(link) => Some(link),
        _ => None,
    }))
}

/// Remarks on the given links of a study. No other link can have a section that warps.
pub(super) fn of_space(space: &DesignSpace) -> Vec<String> {
    sentences(space.pieces.iter().map(|piece| match piece {
        SpacePiece::Link(link) => Some(link),
        _ => None,
    }))
}

/// One sentence for each beam among the pieces of a chain. An item is `None` if the piece is no link.
fn sentences<'a>(pieces: impl Iterator<Item = Option<&'a Link>>) -> Vec<String> {
    let mut runs: Vec<Run> = Vec::new();
    let mut goes_on = false;
    for piece in pieces {
        let Some((link, k_per_m)) = piece.and_then(|link| Some((link, of_body(&link.body)?))) else {
            goes_on = false;
            continue;
        };
        let length_m = link.vector_m.norm();
        match runs.last_mut().filter(|_| goes_on) {
            Some(run) => {
                run.k_length += k_per_m * length_m;
                run.length_m += length_m;
            }
            None => runs.push(Run { name: &link.name, k_length: k_per_m * length_m, length_m }),
        }
        goes_on = true;
    }
    runs.iter().filter_map(sentence).collect()
}

fn of_body(body: &LinkBody) -> Option<f64> {
    match body {
        LinkBody::Tube { material, section, .. } => k_per_m(section, material),
        LinkBody::Offset { .. } => None,
    }
}

/// k = √(G J/(E Cw)) of a link \[1/m\]; `None` if its section hardly warps.
fn k_per_m(section: &Section, material: &LinkMaterial) -> Option<f64> {
    let warping_nm4 = material.youngs_modulus_pa * section.warping_constant_m6()?;
    let torsion_nm2 = material.shear_modulus_pa * section.properties(material.poisson).torsion_constant_m4;
    Some((torsion_nm2 / warping_nm4).sqrt())
}

/// The twist of a beam that is clamped against warping at one end, as a fraction of its twist if both ends warp freely.
fn clamped_twist(k_length: f64) -> f64 {
    1.0 - libm::tanh(k_length) / k_length
}

fn sentence(run: &Run) -> Option<String> {
    let [one, both] = [run.k_length, run.k_length / 2.0].map(clamped_twist);
    (both < NEARLY_FREE).then(|| {
        format!(
            "{} is an I section, {} m long, whose ends are taken as free to warp. If it carries torsion, its computed twist \
             is too large: it is {} of this twist if one end is clamped against warping, as by a thick plate, and {} if both \
             are. Its bending is not affected.",
            run.name,
            significant(run.length_m, 3),
            significant(one, 2),
            significant(both, 2)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: LinkMaterial = LinkMaterial {
        youngs_modulus_pa: 2.1e11,
        shear_modulus_pa: 8.1e10,
        density_kg_m3: 7850.0,
        poisson: 0.3,
        strength: None,
        class: None,
    };
    const IPE_200: Section = Section::IBeam { width_m: 0.1, height_m: 0.2, web_m: 0.0056, flange_m: 0.0085 };
    const STEPS: usize = 4000;

    /// Solves Vlasov's equation θ - θ''/k² = 1 for the twist per length θ, in units of M/(G J), by finite differences:
    /// θ = 0 at the clamped end, and θ' = 0 at the free one. Returns the mean of θ over the length.
    fn twist_by_differences(k_per_m: f64, length_m: f64) -> f64 {
        let load = (k_per_m * length_m / STEPS as f64).powi(2);
        let (mut upper, mut right) = (vec![0.0], vec![0.0]);
        for i in 1..=STEPS {
            // the node beyond the free end mirrors the one before it
            let lower = if i == STEPS { 2.0 } else { 1.0 };
            let pivot = 2.0 + load - lower * upper[i - 1];
            upper.push(1.0 / pivot);
            right.push((load + lower * right[i - 1]) / pivot);
        }
        let mut rate = vec![0.0; STEPS + 1];
        rate[STEPS] = right[STEPS];
        for i in (1..STEPS).rev() {
            rate[i] = right[i] + upper[i] * rate[i + 1];
        }
        rate.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).sum::<f64>() / STEPS as f64
    }

    #[test]
    fn a_clamped_ipe_200_of_0_6_m_twists_a_sixth_as_much_as_one_that_warps_freely() {
        let k = k_per_m(&IPE_200, &STEEL).expect("it warps");
        let factor = clamped_twist(0.6 * k);
        assert!((factor / twist_by_differences(k, 0.6) - 1.0).abs() < 1e-3, "{factor}");
        assert!((0.14..0.16).contains(&factor), "{factor}");
        assert!((clamped_twist(20.0) / twist_by_differences(20.0, 1.0) - 1.0).abs() < 1e-3, "a long beam");
    }

    #[test]
    fn the_warping_constant_is_that_of_the_makers_table() {
        // ArcelorMittal, Sections and Merchant Bars, IPE 200: Iw = 13.0e3 cm6 (value from memory)
        let warping_m6 = IPE_200.warping_constant_m6().expect("it warps");
        assert!((warping_m6 / 13.0e-9 - 1.0).abs() < 0.02, "{warping_m6}");
        assert_eq!(Section::RoundBar { diameter_m: 0.1 }.warping_constant_m6(), None);
    }

    #[test]
    fn links_without_a_joint_between_them_are_one_beam() {
        let link = |name: &str| Link {
            name: name.into(),
            vector_m: nalgebra::Vector3::new(0.3, 0.0, 0.0),
            body: LinkBody::Tube { material_name: "steel".into(), material: STEEL, section: IPE_200 },
            bodies: Vec::new(),
        };
        let (a, b) = (link("a"), link("b"));
        let together = sentences([Some(&a), Some(&b)].into_iter());
        assert_eq!(together.len(), 1);
        assert!(
            together[0].contains("a is an I section, 0.6") && together[0].contains("0.15"),
            "{together:?}"
        );
        assert_eq!(sentences([Some(&a), None, Some(&b)].into_iter()).len(), 2);
    }
}
