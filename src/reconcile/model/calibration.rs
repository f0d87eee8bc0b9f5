//! Calibration within tolerance: the properties of an arm that are adjusted, and how the arm changes with them.

use crate::arm::effect::subject::Subject;
use crate::arm::joint_law::Curve;
use crate::arm::prismatic::Prismatic;
use crate::arm::structure::Piece;
use crate::arm::{Arm, Element, LinkBody};
use crate::reconcile::readings::campaign::Tolerance;
use nalgebra::Vector3;

/// A property that calibration adjusts within tolerance.
#[derive(Debug, Clone, PartialEq)]
pub enum Calibration {
    /// Factor on the stiffness of the joint with this name.
    Stiffness(String),
    /// Factor on the moduli E and G of a material: name of the material, and names of the links made of it.
    Modulus(String, Vec<String>),
    /// Factor on the mass of the joint with this name.
    Mass(String),
    /// Factor on the tilting stiffness of a joint's nominal bearing.
    Bearing {
        /// Name of the joint.
        joint: String,
        /// Tilt per moment of the nominal bearing \[rad/(N m)\].
        tilt_rad_per_nm: f64,
    },
    /// Factor on the stiffness of a prismatic joint along its travel.
    Drive {
        /// Name of the joint.
        joint: String,
        /// Displacement per force of the nominal drive along the travel \[m/N\].
        m_per_n: f64,
    },
    /// Factor on the stiffnesses of a prismatic joint's nominal guide.
    Guide {
        /// Name of the joint.
        joint: String,
        /// Tilt per moment of the nominal guide about its three axes \[rad/(N m)\].
        rad_per_nm: Vector3<f64>,
    },
}

impl Calibration {
    /// Name of the calibrated property in result files, such as `j2.stiffness`.
    pub(crate) fn name(&self) -> String {
        match self {
            Calibration::Stiffness(joint) => format!("{joint}.stiffness"),
            Calibration::Mass(joint) => format!("{joint}.mass"),
            Calibration::Modulus(material, _) => format!("{material}.modulus"),
            Calibration::Bearing { joint, .. } => format!("{joint}.bearing_stiffness"),
            Calibration::Drive { joint, .. } => format!("{joint}.stiffness"),
            Calibration::Guide { joint, .. } => format!("{joint}.guide_stiffness"),
        }
    }
}

/// The calibrated parameters of an arm (nuisance parameters). They are free in every model.
#[derive(Debug, Clone)]
pub struct Nuisance {
    /// For each parameter, the property that it adjusts, and the standard deviation of the natural logarithm of the
    /// factor on this property.
    pub numbers: Vec<(Calibration, f64)>,
}

impl Nuisance {
    /// The calibrated parameters whose tolerance is above zero. A tolerance is a 95 % limit, so half of it is the
    /// standard deviation.
    pub fn new(arm: &Arm, tolerance: &Tolerance) -> Self {
        let mut numbers = Vec::new();
        let joints = || arm.joints();
        if tolerance.joint_stiffness > 0.0 {
            numbers.extend(
                joints()
                    .filter(|j| j.curve != Curve::Rigid)
                    .map(|j| (Calibration::Stiffness(j.name.clone()), tolerance.joint_stiffness / 2.0)),
            );
        }
        if tolerance.modulus > 0.0 {
            for (material, links) in materials(arm) {
                numbers.push((Calibration::Modulus(material, links), tolerance.modulus / 2.0));
            }
        }
        if tolerance.joint_mass > 0.0 {
            numbers.extend(
                joints()
                    .filter(|j| j.mass_kg > 0.0)
                    .map(|j| (Calibration::Mass(j.name.clone()), tolerance.joint_mass / 2.0)),
            );
        }
        numbers.extend(bearings(arm, tolerance.bearing_stiffness));
        numbers.extend(prismatics(arm, tolerance));
        Self { numbers }
    }

    /// Factor on the property with index `index` if its parameter is `u`, in standard deviations of the tolerance.
    pub fn factor(&self, index: usize, u: f64) -> f64 {
        libm::exp(u * self.numbers[index].1)
    }

    /// Changes an arm by the parameters `u`, in standard deviations of the tolerance.
    pub(in crate::reconcile) fn apply(&self, u: &[f64], subject: &mut Subject) {
        let structure = &mut subject.structure;
        for (index, (calibration, _)) in self.numbers.iter().enumerate() {
            let factor = self.factor(index, u[index]);
            match calibration {
                Calibration::Stiffness(name) => {
                    if let Some(joint) = structure.joint_mut(name) {
                        joint.law.curve = joint.law.curve.stiffened(factor);
                    }
                }
                Calibration::Mass(name) => {
                    if let Some(joint) = structure.joint_mut(name) {
                        joint.mass_kg *= factor;
                    }
                    if let Some(joint) = structure.prismatic_mut(name) {
                        joint.mass_kg *= factor;
                    }
                }
                Calibration::Bearing { joint, tilt_rad_per_nm } => {
                    if let Some(joint) = structure.joint_mut(joint) {
                        // only the tilt of the nominal bearing is scaled; tilt by effects of the arm file stays as it
                        // is
                        joint.tilt_rad_per_nm += tilt_rad_per_nm * (1.0 / factor - 1.0);
                    }
                }
                Calibration::Drive { joint, m_per_n } => {
                    if let Some(joint) = structure.prismatic_mut(joint) {
                        joint.m_per_n += m_per_n * (1.0 / factor - 1.0);
                    }
                }
                Calibration::Guide { joint, rad_per_nm } => {
                    if let Some(joint) = structure.prismatic_mut(joint) {
                        joint.guide_rad_per_nm += rad_per_nm * (1.0 / factor - 1.0);
                    }
                }
                Calibration::Modulus(_, links) => {
                    for piece in &mut structure.pieces {
                        if let Piece::Link(link) = piece
                            && links.contains(&link.name)
                            && let Some(beam) = &mut link.beam
                        {
                            beam.material.youngs_modulus_pa *= factor;
                            beam.material.shear_modulus_pa *= factor;
                        }
                    }
                }
            }
        }
    }
}

/// The bearings of an arm that are compliant in the nominal model, each with the standard deviation of the logarithm
/// of its stiffness. Empty if the tolerance is zero.
fn bearings(arm: &Arm, tolerance: f64) -> impl Iterator<Item = (Calibration, f64)> + '_ {
    let joints = arm.joints().filter(move |_| tolerance > 0.0);
    joints.filter_map(move |joint| {
        let tilt_rad_per_nm = joint.bearing?.tilt_rad_per_nm();
        let calibration = Calibration::Bearing { joint: joint.name.clone(), tilt_rad_per_nm };
        (tilt_rad_per_nm > 0.0).then_some((calibration, tolerance / 2.0))
    })
}

/// The properties of prismatic joints that are calibrated, each with the standard deviation of the logarithm of its
/// factor. The stiffness of the drive and the travelling mass have the tolerances of joints, and the guide has the
/// tolerance of bearings.
fn prismatics<'a>(arm: &'a Arm, tolerance: &'a Tolerance) -> impl Iterator<Item = (Calibration, f64)> + 'a {
    let of_joint = |joint: &Prismatic| {
        let (name, m_per_n, rad_per_nm) = (&joint.name, joint.piece(0).m_per_n, joint.guide.rad_per_nm());
        let drive = Calibration::Drive { joint: name.clone(), m_per_n };
        let guide = Calibration::Guide { joint: name.clone(), rad_per_nm };
        [
            (m_per_n > 0.0).then_some((drive, tolerance.joint_stiffness)),
            (rad_per_nm != Vector3::zeros()).then_some((guide, tolerance.bearing_stiffness)),
            (joint.mass_kg > 0.0).then_some((Calibration::Mass(name.clone()), tolerance.joint_mass)),
        ]
    };
    let open = arm.prismatics().flat_map(of_joint).flatten();
    open.filter(|(_, limit)| *limit > 0.0).map(|(calibration, limit)| (calibration, limit / 2.0))
}

fn materials(arm: &Arm) -> Vec<(String, Vec<String>)> {
    let mut out: Vec<(String, Vec<String>)> = Vec::new();
    for element in &arm.chain {
        let Element::Link(link) = element else { continue };
        let LinkBody::Tube { material_name, .. } = &link.body else { continue };
        match out.iter_mut().find(|(name, _)| name == material_name) {
            Some((_, links)) => links.push(link.name.clone()),
            None => out.push((material_name.clone(), vec![link.name.clone()])),
        }
    }
    out
}
