//! Statics: joint torques and displacement of the tip under gravity and load (Eqs 4, 7 and 13-15 of docs/model.md).
//!
//! The calculation is linear about the undeformed pose, except for the torsion of joints, which follows their joint
//! laws. In a serial chain every internal force follows from the loads alone, so one pass from the tip to the base is
//! enough.

use super::chain::{Compliance, ElasticElement, Item, OwnMass, Posed};
use super::linkage::Transferred;
use super::prismatic::GuideLoad;
use super::{Twist, Wrench, angular, displacement_at, force_wrench, linear, stack};
use nalgebra::{DVector, Vector3};

/// The static state of an arm in a pose under a load.
#[derive(Debug, Clone, PartialEq)]
pub struct Statics {
    /// Torque on each joint about its axis \[N m\], with the name of the joint: the torque of gravity and load
    /// (Eq 7), plus any further torque that acts on the joint.
    pub joint_torques_nm: Vec<(String, f64)>,
    /// Force of gravity and load on each prismatic joint along its travel \[N\], with the name of the joint. The
    /// joint deflects by force over stiffness.
    pub joint_forces_n: Vec<(String, f64)>,
    /// Force and moment on the guide of each prismatic joint, in the order of `joint_forces_n`. They are the same
    /// whether the guide is rigid or compliant.
    pub guide_loads: Vec<GuideLoad>,
    /// Force and moment on the output bearing of each joint, in the order of `joint_torques_nm`. They are the same
    /// whether the bearing is rigid or compliant.
    pub bearing_loads: Vec<JointLoad>,
    /// Displacement of the tip from its position in the weightless arm, in world axes \[m\] (Eq 15).
    pub tip_displacement_m: Vector3<f64>,
    /// The part of this displacement that each element causes \[m\], with the name of the element, base to tip. The
    /// parts add up to the whole.
    pub shares_m: Vec<(String, Vector3<f64>)>,
    /// Value of each strain coordinate (elastic degree of freedom), as one list for each element, base to tip.
    pub deformations: Vec<Vec<f64>>,
    /// Force and moment at the root of each link, base to tip.
    pub link_roots: Vec<SectionLoad>,
    /// Force and moment at the end of each link, in the order of `link_roots`.
    pub link_ends: Vec<SectionLoad>,
    /// Tangent compliance of each strain coordinate, as one list for each element, base to tip.
    pub tangent_compliances: Vec<Vec<f64>>,
    /// Force and moment on the base, as a wrench about the world's origin.
    pub base_wrench: Wrench,
}

/// Force and moment that everything outboard puts on a joint, split into components along the joint's axis and at
/// right angles to it. All are magnitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLoad {
    /// Moment about an axis at right angles to the joint's axis, taken at the position of the joint \[N m\].
    pub moment_nm: f64,
    /// Force at right angles to the joint's axis \[N\].
    pub radial_n: f64,
    /// Force along the joint's axis \[N\].
    pub axial_n: f64,
}

impl JointLoad {
    /// Force and moment that everything outboard puts on a joint, given as the `wrench` about the world's origin.
    /// `axis` is the unit vector along the axis of the joint, and `at_m` its position \[m\].
    fn of(wrench: &Wrench, axis: &Vector3<f64>, at_m: &Vector3<f64>) -> Self {
        let force_n = linear(wrench);
        let moment_nm = angular(wrench) - at_m.cross(&force_n);
        let across = |v: &Vector3<f64>| (v - axis * axis.dot(v)).norm();
        Self { moment_nm: across(&moment_nm), radial_n: across(&force_n), axial_n: axis.dot(&force_n).abs() }
    }
}

/// Force and moment that a section of a link transmits, in its section frame.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionLoad {
    /// Name of the link.
    pub name: String,
    /// Index of the link among the pieces of the chain.
    pub piece: usize,
    /// Force along the link, along y and along z of the section \[N\].
    pub force_n: Vector3<f64>,
    /// Moment about the link (torsion), about y and about z of the section \[N m\].
    pub moment_nm: Vector3<f64>,
}

impl SectionLoad {
    /// What the section at the point `at_m` \[m\] of the link `name` transmits. `wrench` is the load of everything
    /// outboard of the section, about the world's origin, and `own` has the attitude of the link.
    fn of(name: &str, own: &OwnMass, wrench: &Wrench, at_m: &Vector3<f64>) -> Self {
        let to_section = own.frame.transpose();
        Self {
            name: name.into(),
            piece: own.piece,
            force_n: to_section * linear(wrench),
            moment_nm: to_section * (angular(wrench) - at_m.cross(&linear(wrench))),
        }
    }
}

impl Statics {
    /// Square root of the tangent compliance of each strain coordinate, base to tip: the diagonal of `C^½`.
    pub(super) fn root_compliances(&self) -> DVector<f64> {
        let count = self.tangent_compliances.iter().map(Vec::len).sum();
        DVector::from_iterator(count, self.tangent_compliances.iter().flatten().map(|c| c.sqrt()))
    }
}

impl Posed<'_> {
    /// Computes the static state of the arm.
    ///
    /// One pass goes from the tip to the base. It adds up the wrench of everything outboard, computes the deflection
    /// of each element under it, and sums the displacements of the tip. [`Chain`](super::Chain) has an example.
    pub fn statics(&self) -> Statics {
        let mut wrench = self.tip_load();
        let transferred = self.transferred();
        let mut out = Statics {
            joint_torques_nm: Vec::new(),
            joint_forces_n: Vec::new(),
            guide_loads: Vec::new(),
            bearing_loads: Vec::new(),
            tip_displacement_m: Vector3::zeros(),
            shares_m: Vec::new(),
            deformations: Vec::new(),
            link_roots: Vec::new(),
            link_ends: Vec::new(),
            tangent_compliances: Vec::new(),
            base_wrench: Wrench::zeros(),
        };
        for item in self.items.iter().rev() {
            match item {
                Item::Body(body) => wrench += body.weight(),
                Item::Load(load) => wrench += load,
                Item::Elastic(element) => self.yield_to(element, &transferred, &mut wrench, &mut out),
            }
        }
        out.joint_torques_nm.reverse();
        out.joint_forces_n.reverse();
        out.guide_loads.reverse();
        out.bearing_loads.reverse();
        out.shares_m.reverse();
        out.deformations.reverse();
        out.link_roots.reverse();
        out.link_ends.reverse();
        out.tangent_compliances.reverse();
        out.tip_displacement_m = out.shares_m.iter().map(|(_, share)| share).sum();
        out.base_wrench = wrench;
        out
    }

    /// The tip displacement \[m\] and the strain coordinates of all elements, base to tip. The method
    /// [`statics`](Self::statics) finds the same values, and in addition the loads on bearings, guides and roots of
    /// links.
    pub(crate) fn displaced(&self) -> (Vector3<f64>, Vec<Vec<f64>>) {
        let mut wrench = self.tip_load();
        let transferred = self.transferred();
        let (mut shares_m, mut strains) = (Vec::new(), Vec::new());
        for item in self.items.iter().rev() {
            match item {
                Item::Body(body) => wrench += body.weight(),
                Item::Load(load) => wrench += load,
                Item::Elastic(element) => {
                    let strained = element.strained(&transferred, &wrench);
                    shares_m.push(displacement_at(&strained.motion, &self.tip_m));
                    strains.push(strained.strains);
                    element.own.iter().for_each(|own| wrench += own.weight);
                }
            }
        }
        strains.reverse();
        (shares_m.iter().rev().sum(), strains)
    }

    /// Force and moment at the tip, as a wrench about the world's origin.
    pub(crate) fn tip_load(&self) -> Wrench {
        force_wrench(&self.tip_force_n, &self.tip_m) + stack(&Vector3::zeros(), &self.tip_moment_nm)
    }

    /// Computes the deflection of one element under `wrench`, the load of everything outboard. Records its strain
    /// coordinates, its tangent compliance and the tip displacement that it causes in `out`. Then adds the element's
    /// own weight to `wrench`. `transferred` are the torques that linkages put on driving joints.
    fn yield_to(
        &self,
        element: &ElasticElement,
        transferred: &[Transferred],
        wrench: &mut Wrench,
        out: &mut Statics,
    ) {
        let Strained { forces, strains, motion } = element.strained(transferred, wrench);
        let tangents = match &element.compliance {
            Compliance::Joint(law) => {
                out.joint_torques_nm.push((element.name.clone(), forces[0]));
                let axis = angular(&element.twists[0]);
                out.bearing_loads.push(JointLoad::of(wrench, &axis, &element.at_m));
                vec![law.tangent_compliance_rad_per_nm(forces[0])]
            }
            Compliance::Slide { m_per_n, frame } => {
                out.joint_forces_n.push((element.name.clone(), forces[0]));
                out.guide_loads.push(GuideLoad::of(&element.name, wrench, frame, &element.at_m));
                vec![*m_per_n]
            }
            Compliance::Lift(lift) => {
                forces.iter().map(|nm| lift.tangent_compliance_rad_per_nm(*nm)).collect()
            }
            Compliance::Linear(compliances) => compliances.clone(),
        };
        out.shares_m.push((element.name.clone(), displacement_at(&motion, &self.tip_m)));
        out.deformations.push(strains);
        out.tangent_compliances.push(tangents);
        // The work of a link's own weight is already counted above. From here on, this weight loads everything inboard.
        if let Some(own) = &element.own {
            let length_m = self.chain.beam(own.piece).map_or(0.0, |beam| beam.length_m);
            let end_m = own.root_m + own.frame.column(0) * length_m;
            out.link_ends.push(SectionLoad::of(&element.name, own, wrench, &end_m));
            *wrench += own.weight;
            out.link_roots.push(SectionLoad::of(&element.name, own, wrench, &own.root_m));
        }
    }
}

/// An elastic element under a load.
struct Strained {
    /// Torque or force on each strain coordinate \[N m or N\].
    forces: Vec<f64>,
    /// Value of each strain coordinate.
    strains: Vec<f64>,
    /// Motion that the strains give to everything outboard of the element.
    motion: Twist,
}

impl ElasticElement {
    /// The deflection of the element under `wrench`, the load of everything outboard. `transferred` are the torques
    /// that linkages put on driving joints.
    fn strained(&self, transferred: &[Transferred], wrench: &Wrench) -> Strained {
        let mut motion = Twist::zeros();
        let mut forces: Vec<f64> = self.twists.iter().map(|twist| twist.dot(wrench)).collect();
        let strains: Vec<f64> = match &self.compliance {
            Compliance::Joint(law) => {
                // A driving joint also holds the torque that the linkage transfers from its passive joint.
                forces[0] += self.torque_nm;
                let mut passive_twist = Twist::zeros();
                for passive in transferred.iter().filter(|c| c.driver == self.name) {
                    passive_twist += passive.twist;
                    forces[0] += passive.torque_nm;
                }
                let angle_rad = law.rising_angle_rad(forces[0]);
                motion += passive_twist * angle_rad;
                vec![angle_rad]
            }
            Compliance::Slide { m_per_n, .. } => vec![m_per_n * forces[0]],
            Compliance::Lift(lift) => forces.iter().map(|nm| lift.angle_rad(*nm)).collect(),
            Compliance::Linear(compliances) => {
                let work = |i: usize| self.own.as_ref().map_or(0.0, |own| own.weight_work[i]);
                forces.iter_mut().enumerate().for_each(|(i, force)| *force += work(i));
                forces.iter().zip(compliances).map(|(force, c)| c * force).collect()
            }
        };
        motion += self.twists.iter().zip(&strains).map(|(twist, q)| twist * *q).sum::<Twist>();
        Strained { forces, strains, motion }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::arm::load::Payload;
    use crate::arm::{JointModel, LinkModel};
    use crate::catalog::Catalogs;
    use crate::input::Document;
    use crate::mechanics::chain::Chain;

    #[test]
    fn the_displacement_alone_has_the_bits_of_the_whole_statics() {
        let text = include_str!("../../examples/measured-arm/arm.json");
        let document = Document::parse("arm.json", text).expect("JSON");
        let arm = read_arm_document(document, &Catalogs::default()).expect("a sound arm");
        let chain = Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full);
        let payload = Payload { mass_kg: 5.0, ..Payload::default() };
        for k in 0..5 {
            let pose_rad: Vec<f64> = (0..6).map(|j| 0.3 * f64::from(k) - 0.2 * f64::from(j)).collect();
            let posed = chain.pose_rad(&pose_rad, &payload, Vector3::new(1.0, -20.0, 3.0));
            let whole = posed.statics();
            assert_eq!(posed.displaced(), (whole.tip_displacement_m, whole.deformations));
        }
    }
}
