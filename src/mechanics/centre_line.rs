//! The centre line of an arm and its displacement, for drawings.
//!
//! Strain coordinates ([`Statics::deformations`](super::statics::Statics), [`Mode::coordinates`](super::modes::Mode))
//! determine the displacement of every point of the chain. An element moves everything outboard of it; inside a link,
//! the displacement fields of its beam are added. The elements come in the same order as in
//! [`Chain::pose_rad`](super::chain::Chain::pose_rad).

use super::chain::{ElasticElement, Owner, Posed, Prepared};
use super::{Twist, displacement_at};
use crate::arm::prismatic::Moves;
use nalgebra::{DVector, Rotation3, Vector3};

/// A point of the centre line.
#[derive(Debug, Clone, PartialEq)]
pub struct Station {
    /// Name of the joint or link to which the point belongs.
    pub piece: String,
    /// Position of the point in the undeformed arm, in the world \[m\].
    pub at_m: Vector3<f64>,
    /// Displacement of the point, in world axes \[m\].
    pub moved_m: Vector3<f64>,
    /// Unit vector along the axis of the joint, in the world; `None` on a link.
    pub axis: Option<Vector3<f64>>,
}

/// Number of points along a link, including both ends.
const POINTS: usize = 9;

impl Posed<'_> {
    /// The points of the centre line, base to tip, with their displacement. `coordinates` has the strain coordinates
    /// of each element, base to tip; `pose_rad` is the pose in which the arm is. A joint has one point; a link and
    /// the travel of a prismatic joint have several.
    pub fn centre_line(&self, pose_rad: &[f64], coordinates: &[Vec<f64>]) -> Vec<Station> {
        let mut elements = self.elements().zip(coordinates).peekable();
        let mut walk = Walk::default();
        let mut out = Vec::new();
        while let Some(element) = elements.next_if(|(e, _)| e.owner == Owner::Base) {
            walk.deflects(Some(element));
        }
        for (index, piece) in self.chain.pieces.iter().enumerate() {
            let is_own = |e: &ElasticElement| e.owner == Owner::Piece(index);
            match piece {
                Prepared::Joint(joint) => {
                    let axis = walk.rotation * joint.axis.into_inner();
                    out.push(walk.station(&joint.name, walk.at_m, Some(axis)));
                    while let Some(element) = elements.next_if(|(e, _)| is_own(e)) {
                        walk.deflects(Some(element));
                    }
                    walk.rotation *= Rotation3::from_axis_angle(&joint.axis, joint.angle.of(pose_rad));
                }
                Prepared::Prismatic(joint) => {
                    // The springs are at one end of the part that travels, so this part is drawn rigid.
                    let travel = walk.rotation * joint.axis.into_inner() * pose_rad[joint.entry];
                    out.push(walk.station(&joint.name, walk.at_m, None));
                    if joint.moves == Moves::Carriage {
                        out.push(walk.station(&joint.name, walk.at_m + travel, None));
                    }
                    while let Some(element) = elements.next_if(|(e, _)| is_own(e)) {
                        walk.deflects(Some(element));
                    }
                    walk.at_m += travel;
                    out.push(walk.station(&joint.name, walk.at_m, None));
                }
                Prepared::Link(link, beam) => {
                    let is_frame = |e: &ElasticElement| is_own(e) && e.own.is_none();
                    while let Some(element) = elements.next_if(|(e, _)| is_frame(e)) {
                        walk.deflects(Some(element));
                    }
                    let element = elements.next_if(|(e, _)| is_own(e));
                    let vector = walk.rotation * link.vector_m;
                    for point in 0..POINTS {
                        let xi = point as f64 / (POINTS - 1) as f64;
                        let mut station = walk.station(&link.name, walk.at_m + vector * xi, None);
                        if let (Some(beam), Some((element, q))) = (beam, element) {
                            station.moved_m += self.inside(element, beam, q, xi);
                        }
                        out.push(station);
                    }
                    walk.deflects(element);
                    walk.at_m += vector;
                }
            }
        }
        out
    }

    /// Displacement \[m\] of a point inside a link, in world axes, caused by the strain coordinates `q` of this link
    /// alone. `xi` is the position of the point along the link, from 0 to 1.
    fn inside(
        &self,
        element: &ElasticElement,
        beam: &super::beam::PreparedBeam,
        q: &[f64],
        xi: f64,
    ) -> Vector3<f64> {
        let Some(own) = &element.own else { return Vector3::zeros() };
        let fields = beam.fields(xi);
        let local = fields.columns_range(6..) * DVector::from_column_slice(q);
        own.frame * local.fixed_rows::<3>(0)
    }
}

/// The walk from base to tip: position and attitude reached so far, and the motion caused by all elements passed so
/// far.
#[derive(Default)]
struct Walk {
    at_m: Vector3<f64>,
    rotation: Rotation3<f64>,
    motion: Twist,
}

impl Walk {
    fn station(&self, piece: &str, at_m: Vector3<f64>, axis: Option<Vector3<f64>>) -> Station {
        Station { piece: piece.to_string(), at_m, moved_m: displacement_at(&self.motion, &at_m), axis }
    }

    /// Adds the motion that an elastic element causes to the motion so far. `element` is the element and the values of
    /// its strain coordinates; `None` adds nothing.
    fn deflects(&mut self, element: Option<(&ElasticElement, &Vec<f64>)>) {
        if let Some((element, q)) = element {
            self.motion += element.twists.iter().zip(q).map(|(twist, q)| twist * *q).sum::<Twist>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::effect::subject::Subject;
    use crate::arm::file::read_arm_document;
    use crate::arm::load::Payload;
    use crate::arm::{JointModel, LinkModel};
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::mechanics::chain::Chain;

    const ARM: &str = r#"{"name": "a",
        "materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
        "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1e5, "mass_kg": 5},
            {"type": "link", "name": "column", "vector_m": [0, 0, 0.3]},
            {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": 5},
            {"type": "link", "name": "arm", "vector_m": [0.8, 0, 0], "material": "steel",
             "section": {"shape": "round_tube", "diameter_m": 0.06, "wall_m": 0.002}}]}"#;

    fn check(moved_m: impl Fn(&Posed) -> (Vec<Vec<f64>>, Vector3<f64>)) {
        let document = Document::parse("a.json", ARM).expect("JSON");
        let arm = read_arm_document(document, &Catalogs::default()).expect("an arm");
        let structure = arm.structure(JointModel::ThreeSegment);
        let chain = Chain::new(&structure, LinkModel::Full);
        let pose = [0.3, -0.4];
        let payload = Payload { mass_kg: 4.0, ..Payload::default() };
        let posed = chain.pose_rad(&pose, &payload, Vector3::new(0.0, 30.0, 0.0));
        let (coordinates, tip) = moved_m(&posed);
        let line = posed.centre_line(&pose, &coordinates);
        let last = line.last().expect("stations");
        assert!((last.at_m - posed.tip_m).norm() < 1e-12);
        assert!((last.moved_m - tip).norm() < 1e-12 * tip.norm().max(1.0), "{} {tip}", last.moved_m);
        assert_eq!(line[0].moved_m, Vector3::zeros());
    }

    /// Stations of the arm in a pose with these effects, where the first joint has the name `first`, and the
    /// displacement of the tip.
    fn stations(first: &str, effects: &str) -> (Vec<Station>, Vector3<f64>) {
        let text = ARM.replace("\"j1\"", &format!("\"{first}\""));
        let text = text.replacen("\"name\": \"a\"", &format!("\"name\": \"a\", \"effects\": [{effects}]"), 1);
        let arm = read_arm_document(Document::parse("a.json", &text).expect("JSON"), &Catalogs::default());
        let arm = arm.expect("an arm");
        let mut subject = Subject::new(arm.structure(JointModel::ThreeSegment));
        arm.effects.iter().for_each(|effect| subject.apply(effect));
        let chain = Chain::new(&subject.structure, LinkModel::Full);
        let pose = [0.3, -0.4];
        let payload = Payload { mass_kg: 4.0, ..Payload::default() };
        let posed = chain.pose_rad(&pose, &payload, Vector3::new(0.0, 30.0, 0.0));
        let statics = posed.statics();
        (posed.centre_line(&pose, &statics.deformations), statics.tip_displacement_m)
    }

    #[test]
    fn the_centre_line_follows_every_compliance_of_the_base_and_no_name() {
        let lift = r#"{"effect": "base_lift", "at": "base", "parameters": {"stiffness_nm_per_rad": 2e5, "preload_nm": 5}}"#;
        let tilt =
            r#"{"effect": "base_compliance", "at": "base", "parameters": {"stiffness_nm_per_rad": 3e5}}"#;
        let frame = r#"{"effect": "frame_compliance", "at": "base",
            "parameters": {"diagonal_rad_per_nm": [1e-5, 2e-5, 0], "coupling_rad_per_nm": [0, 0, 0]}}"#;
        let all = format!("{lift}, {tilt}, {frame}");
        for effects in ["", lift, tilt, frame, all.as_str()] {
            let (line, tip) = stations("j1", effects);
            let last = line.last().expect("stations");
            assert!((last.moved_m - tip).norm() < 1e-12, "{effects}: {} {tip}", last.moved_m);
            let (named, _) = stations("base", effects);
            for (one, other) in line.iter().zip(&named) {
                assert_eq!(one.moved_m, other.moved_m, "{effects}: {}", one.piece);
            }
        }
    }

    #[test]
    fn the_end_of_the_centre_line_moves_like_the_tip_in_statics() {
        check(|posed| {
            let statics = posed.statics();
            (statics.deformations, statics.tip_displacement_m)
        });
    }

    #[test]
    fn the_end_of_the_centre_line_moves_like_the_tip_in_every_mode() {
        for mode in 0..3 {
            check(|posed| {
                let mode = posed.modes(&posed.statics(), 3).remove(mode);
                (mode.coordinates, mode.tip_shape_m)
            });
        }
    }
}
