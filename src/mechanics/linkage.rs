//! Passive joints: a linkage turns a passive joint together with its driving joint, also when the driving joint
//! deflects.
//!
//! When the driving joint (the *driver*) deflects by a unit angle, everything outboard of it moves. In addition the
//! linkage turns the passive joint by its factor, which moves everything outboard of that joint. The generalized
//! force on the driver is the work of the loads on both motions. In matrices, forces become `Tᵀ f` and the mass
//! matrix becomes `Tᵀ M T`. `T` is the unit matrix, with the factor in the row of the passive joint and the column of
//! the driver.

use super::chain::{Compliance, ElasticElement, Item, Posed};
use super::{Twist, Wrench};
use crate::arm::linkage::Linkage;
use nalgebra::{DMatrix, DVector};

/// Motion and torque that a linkage transfers to the driving joint, for an arm in a pose under a load.
#[derive(Debug, Clone, PartialEq)]
pub struct Transferred {
    /// Name of the driving joint.
    pub driver: String,
    /// Motion of everything outboard of the passive joint, per radian by which the driving joint deflects.
    pub twist: Twist,
    /// Work of the loads, and of the passive joint's own torque, on this motion. It acts as a torque on the driving
    /// joint \[N m\].
    pub torque_nm: f64,
}

/// The strain coordinates (angles of torsion) of two joints that a linkage couples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LinkedCoordinates {
    /// Index of the strain coordinate of the driving joint.
    pub driver: usize,
    /// Index of the strain coordinate of the passive joint.
    pub passive: usize,
    /// Rotation of the passive joint per rotation of the driving joint.
    pub factor: f64,
}

impl LinkedCoordinates {
    /// The product `T q`: the strain coordinates `shape`, to which the rotations of the passive joints are added.
    /// These rotations follow from the rotations of the driving joints.
    pub(super) fn turned_along(linked: &[Self], shape: &DVector<f64>) -> DVector<f64> {
        let mut out = shape.clone();
        for of in linked {
            out[of.passive] += of.factor * shape[of.driver];
        }
        out
    }

    /// The product `Tᵀ f`: the generalized forces `forces`, to which the effect of the linkages is added. The force on
    /// each passive joint, times the factor of its linkage, is added to the force on its driving joint.
    pub(super) fn transferred(linked: &[Self], forces: &DVector<f64>) -> DVector<f64> {
        let mut out = forces.clone();
        for of in linked {
            out[of.driver] += of.factor * forces[of.passive];
        }
        out
    }
}

impl ElasticElement {
    /// Whether the element is the torsion spring of the revolute joint `name`. The name alone is not enough, because
    /// the element of a base may have the same name as a joint.
    fn is_joint(&self, name: &str) -> bool {
        matches!(self.compliance, Compliance::Joint(_)) && self.name == name
    }
}

impl Posed<'_> {
    /// For each linkage, the motion and the torque that it transfers to the driving joint under weight and tip force.
    pub fn transferred(&self) -> Vec<Transferred> {
        let linkages = self.chain.linkages();
        let mut out = Vec::new();
        if linkages.is_empty() {
            return out;
        }
        let mut wrench: Wrench = self.tip_load();
        for item in self.items.iter().rev() {
            match item {
                Item::Body(body) => wrench += body.weight(),
                Item::Load(load) => wrench += load,
                Item::Elastic(element) => {
                    out.extend(linkages.iter().filter(|l| element.is_joint(&l.passive)).map(|l| {
                        let twist = element.twists[0] * l.factor;
                        let torque_nm = twist.dot(&wrench) + element.torque_nm * l.factor;
                        Transferred { driver: l.driver.clone(), twist, torque_nm }
                    }));
                    if let Some(own) = &element.own {
                        wrench += own.weight;
                    }
                }
            }
        }
        out
    }

    /// Motion of the last frame per unit of every strain coordinate, base to tip. The unit of a driving joint includes
    /// the motion of the passive joints that a linkage turns with it.
    pub fn tip_twists(&self) -> Vec<Twist> {
        let mut twists: Vec<Twist> = self.elements().flat_map(|e| e.twists.iter().copied()).collect();
        for LinkedCoordinates { driver, passive, factor } in self.linked_coordinates() {
            let transferred = twists[passive] * factor;
            twists[driver] += transferred;
        }
        twists
    }

    /// The strain coordinates `shape`, to which the rotations of the passive joints are added. These rotations follow
    /// from the rotations of the driving joints.
    pub(crate) fn with_passive(&self, shape: &DVector<f64>) -> DVector<f64> {
        LinkedCoordinates::turned_along(&self.linked_coordinates(), shape)
    }

    /// The mass matrix `Tᵀ M T` of the arm with linkages, given the mass matrix `M` of the arm without them. `T` turns
    /// each passive joint together with its driving joint.
    pub(crate) fn with_linkages(&self, mut mass: DMatrix<f64>) -> DMatrix<f64> {
        for LinkedCoordinates { driver, passive, factor } in self.linked_coordinates() {
            let column = mass.column(passive) * factor;
            mass.column_mut(driver).zip_apply(&column, |m, c| *m += c);
            let row = mass.row(passive) * factor;
            mass.row_mut(driver).zip_apply(&row, |m, r| *m += r);
        }
        mass
    }

    /// The coupled strain coordinates of each linkage.
    pub(super) fn linked_coordinates(&self) -> Vec<LinkedCoordinates> {
        let coordinate = |name: &str| {
            let before = self.elements().take_while(|e| !e.is_joint(name));
            before.map(|e| e.twists.len()).sum::<usize>()
        };
        let of = |l: &Linkage| LinkedCoordinates {
            driver: coordinate(&l.driver),
            passive: coordinate(&l.passive),
            factor: l.factor,
        };
        self.chain.linkages().iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::arm::file::read_arm_document;
    use crate::arm::load::Payload;
    use crate::arm::{JointModel, LinkModel};
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::mechanics::chain::Chain;
    use nalgebra::Vector3;

    /// An arm with a driven shoulder and a wrist that a linkage keeps level.
    const ARM: &str = r#"{"chain": [
        {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
        {"type": "link", "name": "arm", "vector_m": [0.6, 0, 0]},
        {"type": "joint", "name": "wrist", "axis": [0, 1, 0], "stiffness_nm_per_rad": null,
         "coupled": {"shoulder": -1}},
        {"type": "link", "name": "hand", "vector_m": [0.2, 0, 0]}]}"#;

    #[test]
    fn what_a_linkage_keeps_level_moves_without_turning() {
        let document = Document::parse("arm.json", ARM).expect("JSON");
        let arm = read_arm_document(document, &Catalogs::default()).expect("sound");
        let chain = Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full);
        let payload = Payload { mass_kg: 5.0, ..Payload::default() };
        let posed = chain.pose_rad(&[0.0], &payload, Vector3::zeros());
        let statics = posed.statics();
        // The hand stays level. Weight and deflection therefore act at the lever of the wrist, 0.6 m, and not at 0.8 m.
        let (weight_n, lever_m) = (5.0 * 9.81, 0.6);
        assert!((statics.joint_torques_nm[0].1 - weight_n * lever_m).abs() < 1e-9);
        let deflection_m = weight_n * lever_m / 1e4 * lever_m;
        assert!(
            (statics.tip_displacement_m.z + deflection_m).abs() < 1e-12,
            "{}",
            statics.tip_displacement_m
        );
        let frequency_hz = posed.modes(&statics, 1)[0].frequency_hz;
        let by_hand = (1e4 / (5.0 * lever_m * lever_m)).sqrt() / std::f64::consts::TAU;
        assert!((frequency_hz / by_hand - 1.0).abs() < 1e-9, "{frequency_hz} {by_hand}");
        assert!(posed.modes(&statics, 1)[0].tip_shape_m.z.abs() > 0.0);
    }

    /// A lever whose second joint turns against the first, which has the name `first`, on a base that tilts.
    fn lowest_hz_on_a_compliant_base(first: &str) -> f64 {
        let text = format!(
            r#"{{"name": "a", "effects": [
                {{"effect": "base_compliance", "at": "base", "parameters": {{"stiffness_nm_per_rad": 2e4}}}}], "chain": [
                {{"type": "joint", "name": "{first}", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4, "mass_kg": 1}},
                {{"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "mass_kg": 2}},
                {{"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2e4, "mass_kg": 1,
                  "coupled": {{"{first}": -1}}}},
                {{"type": "link", "name": "lower", "vector_m": [0.3, 0, 0], "mass_kg": 2}}]}}"#
        );
        let document = Document::parse("a.json", &text).expect("JSON");
        let arm = read_arm_document(document, &Catalogs::default()).expect("an arm");
        let chain = Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full);
        let posed = chain.pose_rad(&[0.35], &Payload::default(), Vector3::zeros());
        posed.modes(&posed.statics(), 1)[0].frequency_hz
    }

    #[test]
    fn a_linkage_turns_its_driving_joint_and_not_a_base_of_the_same_name() {
        assert_eq!(lowest_hz_on_a_compliant_base("base"), lowest_hz_on_a_compliant_base("j1"));
    }
}
