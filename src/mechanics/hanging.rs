//! The arm as it hangs: statics about the deflected pose, with large displacements.
//!
//! [`Posed::statics`] is linear about the undeflected pose. In truth each element turns everything outboard of it by a
//! finite angle, and the loads then act with the levers of the deflected pose. Both change the displacement by terms
//! of the order of `δ²/L`, with `δ` the displacement and `L` the reach. If a reach of 1 m deflects by 5 mm, this is
//! 0.03 mm, which is more than a laser tracker's error.
//!
//! The arm is built up from base to tip, and each element moves everything outboard by the screw motion (exponential)
//! of its deflection. Statics in this pose give new deflections, until the tip rests. The rotation of a link's end is
//! then exact. Its displacement is not: a cantilever with a load at its end shortens by `0.75 δ²/L`, where the
//! elastica gives `0.6 δ²/L` to second order.

use super::chain::{Chain, Posed};
use super::deflections::Deflections;
use crate::arm::load::Payload;
use nalgebra::{DVector, Vector3};

/// Largest number of times that the statics are repeated in the pose of the last deflections.
const MOST_ROUNDS: usize = 20;
/// The tip counts as at rest if it moves by less than this from one round to the next \[m\].
const RESTS_M: f64 = 1e-9;
/// If the tip is displaced by less than this, the linear statics are used \[m\]. The terms of second order are then
/// below 1e-8 m for a reach of 1 m.
const SMALL_M: f64 = 1e-4;

impl Chain {
    /// Position of the tip of the arm as it hangs in the pose `pose_rad` \[rad, m\] under gravity, with a payload, in
    /// the world \[m\].
    pub(crate) fn hanging_tip_m(&self, pose_rad: &[f64], payload: &Payload) -> Vector3<f64> {
        hanging_tip_m(|deflections| self.pose_with(pose_rad, payload, Vector3::zeros(), deflections))
    }
}

/// An arm in a pose and out of it by the deflections of its elements, under load.
pub(crate) trait Deflected {
    /// The deflections of all elements.
    type Deflections: Default;

    /// Position of the tip in the world \[m\].
    fn tip_m(&self) -> Vector3<f64>;

    /// Displacement of the tip \[m\] by linear statics about this pose, and the deflections of all elements.
    fn statics_of_tip(&self) -> (Vector3<f64>, Self::Deflections);
}

/// Position of the tip of an arm as it hangs, in the world \[m\]. `posed` puts the arm into its pose, with its loads
/// and with the deflections that it is given. If the deflections do not settle, because the arm would buckle or turn
/// over, the result is the position by linear statics.
pub(crate) fn hanging_tip_m<P: Deflected>(posed: impl Fn(P::Deflections) -> P) -> Vector3<f64> {
    let Hanging { tip_m, .. } = Hanging::new(posed);
    tip_m
}

/// Error of the linear statics at the tip \[m\]: the position of the tip as the arm hangs, minus its position by linear
/// statics. The vector is in world axes.
pub(crate) fn beyond_linear_m<P: Deflected>(posed: impl Fn(P::Deflections) -> P) -> Vector3<f64> {
    let Hanging { tip_m, straight_tip_m, displacement_m } = Hanging::new(posed);
    tip_m - straight_tip_m - displacement_m
}

/// The tip of an arm as it hangs.
struct Hanging {
    /// Position of the tip \[m\].
    tip_m: Vector3<f64>,
    /// Position of the tip without deflection \[m\].
    straight_tip_m: Vector3<f64>,
    /// Displacement of the tip by linear statics \[m\].
    displacement_m: Vector3<f64>,
}

impl Hanging {
    fn new<P: Deflected>(posed: impl Fn(P::Deflections) -> P) -> Self {
        let straight = posed(P::Deflections::default());
        let straight_tip_m = straight.tip_m();
        let (displacement_m, deflections) = straight.statics_of_tip();
        let is_small = displacement_m.norm() < SMALL_M;
        let at_rest_m = if is_small { None } else { resting_tip_m(posed, straight_tip_m, deflections) };
        let tip_m = at_rest_m.unwrap_or(straight_tip_m + displacement_m);
        Self { tip_m, straight_tip_m, displacement_m }
    }
}

/// Position of the tip at rest \[m\]. The first position of the tip is `tip_m`; the deflections `first` then move it.
/// `None` if the tip does not come to rest.
fn resting_tip_m<P: Deflected>(
    posed: impl Fn(P::Deflections) -> P,
    mut tip_m: Vector3<f64>,
    first: P::Deflections,
) -> Option<Vector3<f64>> {
    let mut deflections = first;
    for _ in 0..MOST_ROUNDS {
        let next = posed(deflections);
        let moved_m = (next.tip_m() - tip_m).norm();
        tip_m = next.tip_m();
        if moved_m < RESTS_M {
            return Some(tip_m);
        }
        deflections = next.statics_of_tip().1;
    }
    None
}

impl Deflected for Posed<'_> {
    type Deflections = Deflections;

    fn tip_m(&self) -> Vector3<f64> {
        self.tip_m
    }

    fn statics_of_tip(&self) -> (Vector3<f64>, Deflections) {
        let (displacement_m, strains) = self.displaced();
        (displacement_m, self.hung(strains))
    }
}

impl Posed<'_> {
    /// The deflections of all elements with these strain coordinates, given as one list for each element.
    fn hung(&self, strains: Vec<Vec<f64>>) -> Deflections {
        let strains: Vec<f64> = strains.into_iter().flatten().collect();
        Deflections::of(self.with_passive(&DVector::from_vec(strains)).as_slice().to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::arm::{JointModel, LinkModel};
    use crate::catalog::Catalogs;
    use crate::input::Document;
    use nalgebra::Rotation3;

    /// The chain of the arm that an arm file with this text describes.
    fn chain(text: &str) -> Chain {
        let document = Document::parse("arm.json", text).expect("JSON");
        let arm = read_arm_document(document, &Catalogs::default()).expect("a sound arm");
        Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full)
    }

    fn payload(mass_kg: f64) -> Payload {
        Payload { mass_kg, ..Payload::default() }
    }

    #[test]
    fn a_lever_hangs_where_its_spring_balances_the_turned_load() {
        let chain = chain(
            r#"{"gravity_m_s2": 9.81, "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2000},
            {"type": "link", "name": "arm", "vector_m": [1, 0, 0]}]}"#,
        );
        for above_deg in [-60.0f64, 0.0, 30.0, 45.0] {
            let above_rad = above_deg.to_radians();
            let tip_m = chain.hanging_tip_m(&[-above_rad], &payload(10.0));
            let mut turned_rad: f64 = 0.0;
            for _ in 0..200 {
                turned_rad = 98.1 / 2000.0 * (above_rad - turned_rad).cos();
            }
            let (sin, cos) = (above_rad - turned_rad).sin_cos();
            assert!((tip_m - Vector3::new(cos, 0.0, sin)).norm() < 1e-8, "{above_deg}: {tip_m}");
        }
    }

    /// The tip of an arm with joints about three axes is where the energy of springs and weight is smallest. That
    /// place is found by gradient steps on the energy alone.
    #[test]
    fn an_arm_hangs_where_its_energy_is_smallest() {
        let chain = chain(
            r#"{"gravity_m_s2": 9.81, "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 3000, "mass_kg": 4},
            {"type": "link", "name": "post", "vector_m": [0.1, 0, 0.4]},
            {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 5000, "mass_kg": 3},
            {"type": "link", "name": "arm", "vector_m": [0.5, 0, 0]},
            {"type": "joint", "name": "j3", "axis": [1, 0, 0], "stiffness_nm_per_rad": 2000, "mass_kg": 2},
            {"type": "link", "name": "hand", "vector_m": [0.3, 0.2, 0]}]}"#,
        );
        let (pose_rad, stiffness) = ([0.3, -0.4, 0.5], [3000.0, 5000.0, 2000.0]);
        let place = |q: &Vector3<f64>| {
            let turn =
                |axis: Vector3<f64>, j: usize| Rotation3::from_scaled_axis(axis * (pose_rad[j] + q[j]));
            let first = turn(Vector3::z(), 0);
            let elbow_m = first * Vector3::new(0.1, 0.0, 0.4);
            let second = first * turn(Vector3::y(), 1);
            let wrist_m = elbow_m + second * Vector3::new(0.5, 0.0, 0.0);
            let tip_m = wrist_m + second * turn(Vector3::x(), 2) * Vector3::new(0.3, 0.2, 0.0);
            (elbow_m, wrist_m, tip_m)
        };
        let energy = |q: &Vector3<f64>| {
            let (elbow_m, wrist_m, tip_m) = place(q);
            let springs: f64 = (0..3).map(|j| 0.5 * stiffness[j] * q[j] * q[j]).sum();
            springs + 9.81 * (3.0 * elbow_m.z + 2.0 * wrist_m.z + 8.0 * tip_m.z)
        };
        let slope = |q: &Vector3<f64>| {
            let h = 1e-5;
            Vector3::from_fn(|j, _| {
                let by = Vector3::ith(j, h);
                (energy(&(q + by)) - energy(&(q - by))) / (2.0 * h)
            })
        };
        let mut q = Vector3::zeros();
        for _ in 0..200 {
            // The springs are far stiffer than gravity's part of the energy. A step therefore uses the stiffness of the
            // springs alone.
            q -= slope(&q).component_div(&Vector3::from(stiffness));
        }
        let tip_m = chain.hanging_tip_m(&pose_rad, &payload(8.0));
        let linear_m = {
            let posed = chain.pose_rad(&pose_rad, &payload(8.0), Vector3::zeros());
            posed.tip_m + posed.statics().tip_displacement_m
        };
        assert!((tip_m - place(&q).2).norm() < 2e-7, "{tip_m} {}", place(&q).2);
        assert!((linear_m - tip_m).norm() > 1e-4, "the linear displacement is far from it");
    }

    /// Sinking and shortening of a cantilever of unit length (elastica) under a load at its end with `P L²/(E I)` =
    /// `load`. The curvature is integrated along the beam with the levers of the last shape, until the shape no longer
    /// changes.
    fn elastica(load: f64) -> [f64; 2] {
        const PARTS: usize = 2000;
        let step = 1.0 / PARTS as f64;
        let mut along: Vec<f64> = (0..=PARTS).map(|i| i as f64 * step).collect();
        let mut sunk = 0.0;
        for _ in 0..40 {
            let (tip, mut slope) = (along[PARTS], 0.0f64);
            let mut next = vec![0.0];
            sunk = 0.0;
            for i in 0..PARTS {
                let turned = slope + 0.5 * step * load * (2.0 * tip - along[i] - along[i + 1]);
                next.push(next[i] + 0.5 * step * (slope.cos() + turned.cos()));
                sunk += 0.5 * step * (slope.sin() + turned.sin());
                slope = turned;
            }
            along = next;
        }
        [sunk, 1.0 - along[PARTS]]
    }

    #[test]
    fn a_cantilever_that_bends_far_shortens_nearly_as_the_elastica() {
        let chain = chain(
            r#"{"gravity_m_s2": 9.81,
            "materials": {"light": {"youngs_modulus_pa": 7e10, "shear_modulus_pa": 2.6e10, "density_kg_m3": 1e-6}},
            "chain": [{"type": "link", "name": "arm", "vector_m": [1, 0, 0], "material": "light",
             "section": {"shape": "round_tube", "diameter_m": 0.02, "wall_m": 0.002}}]}"#,
        );
        let area_m4 = std::f64::consts::PI / 64.0 * (0.02f64.powi(4) - 0.016f64.powi(4));
        let mass_kg = 0.25 * 7e10 * area_m4 / 9.81;
        let tip_m = chain.hanging_tip_m(&[], &payload(mass_kg));
        let [sunk, shortened] = elastica(0.25);
        assert!((-tip_m.z / sunk - 1.0).abs() < 5e-3, "{tip_m} and {sunk}");
        assert!(((1.0 - tip_m.x) / shortened - 1.0).abs() < 0.3, "{tip_m} and {shortened}");
    }

    #[test]
    fn what_a_linkage_keeps_level_stays_level_as_the_arm_hangs() {
        let chain = chain(
            r#"{"gravity_m_s2": 9.81, "chain": [
            {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
            {"type": "link", "name": "arm", "vector_m": [0.6, 0, 0]},
            {"type": "joint", "name": "wrist", "axis": [0, 1, 0], "stiffness_nm_per_rad": null,
             "coupled": {"shoulder": -1}},
            {"type": "link", "name": "hand", "vector_m": [0.2, 0, 0]}]}"#,
        );
        let mut turned_rad: f64 = 0.0;
        for _ in 0..100 {
            turned_rad = 40.0 * 9.81 * 0.6 * turned_rad.cos() / 1e4;
        }
        let tip_m = chain.hanging_tip_m(&[0.0], &payload(40.0));
        let (sin, cos) = turned_rad.sin_cos();
        assert!((tip_m - Vector3::new(0.6 * cos + 0.2, 0.0, -0.6 * sin)).norm() < 1e-8, "{tip_m}");
    }

    /// A joint about y on a bearing that tilts, with a load beside the arm. The bearing tilts about x alone, since weight has
    /// no moment about z, and turns the joint's axis with it. The arm rests where the energy of springs and weight is least.
    #[test]
    fn a_joint_turns_about_the_axis_that_its_bearing_has_tilted() {
        let (along_m, beside_m, weight_n) = (0.8, 0.5, 20.0 * 9.81);
        let (of_joint, of_bearing) = (3000.0, 1500.0);
        let chain = chain(&format!(
            r#"{{"gravity_m_s2": 9.81, "chain": [
            {{"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": {of_joint}}},
            {{"type": "link", "name": "l1", "vector_m": [{along_m}, {beside_m}, 0]}}],
            "effects": [{{"effect": "bearing_tilt", "at": "j1", "parameters": {{"stiffness_nm_per_rad": {of_bearing}}}}}]}}"#
        ));
        // the tip is at Rx(tilt) Ry(twist) (along, beside, 0); each angle in turn, with the other one as it is
        let (mut tilt, mut twist) = (0.0f64, 0.0f64);
        for _ in 0..100 {
            let lever_m = beside_m * tilt.cos() + along_m * twist.sin() * tilt.sin();
            (tilt, twist) =
                (-weight_n * lever_m / of_bearing, weight_n * along_m * twist.cos() * tilt.cos() / of_joint);
        }
        let turned = Rotation3::from_axis_angle(&Vector3::x_axis(), tilt)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), twist);
        let right_m = turned * Vector3::new(along_m, beside_m, 0.0);
        let found_m = hanging_tip_m(|by| chain.pose_with(&[0.0], &payload(20.0), Vector3::zeros(), by));
        assert!((found_m - right_m).norm() < 1e-9, "{found_m} {right_m}");
    }
}
