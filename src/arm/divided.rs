//! Structures whose links are divided where bodies, or springs, load them.
//!
//! The strains of a link are smooth along its length (see [`crate::mechanics::beam`]). A body off the axis of a link
//! twists the link inboard of it and not outboard of it, so the twist rate has a step at the body. Smooth strains
//! reproduce only a part of such a step. The deflection of the tip is exact all the same. But the frequency of a mode
//! in which the body swings about the link comes out too high, by up to 6 %. Where the link is divided at the body, the
//! step lies between two links, and the frequency is right.
//!
//! The stress in a link is largest at one of its ends, at a body or where a spring pulls. In a link that is divided at
//! all of them, the stress has to be looked for only at the ends of the parts.

use super::body::RigidBody;
use super::springs::{SpringEnd, SpringKind, SpringPlace};
use super::structure::{FrameCompliance, LinkPiece, Piece, Structure};
use nalgebra::Vector3;

/// Smallest distance between two divisions, or between a division and an end of the link, relative to the length of the
/// link.
const LEAST_SPACING: f64 = 1e-3;

/// A structure whose tubes are divided.
pub(crate) struct Divided {
    /// The divided structure.
    pub structure: Structure,
    /// For each piece of the divided structure, the index of the piece of the whole structure that it is a part of.
    pub whole: Vec<usize>,
}

impl Structure {
    /// This structure with every tube divided where a body moves with it; `None` if no body is between the ends of a
    /// tube. Springs stay where they are.
    pub(crate) fn divided_at_bodies(&self) -> Option<Structure> {
        let between_ends = |xi: &f64| (LEAST_SPACING..1.0 - LEAST_SPACING).contains(xi);
        let divided = self.divided(|_, link| bodies_along(link).filter(between_ends).collect());
        (divided.structure.pieces.len() > self.pieces.len()).then_some(divided.structure)
    }

    /// This structure with every tube divided where a body moves with it and where a spring pulls at it. A load at an end
    /// of a tube gets a short part of its own, so that both sides of the load are ends of parts.
    pub(crate) fn divided_at_loads(&self) -> Divided {
        self.divided(|piece, link| {
            let pulls = self.pulls_on(piece).map(|point_m| along(link, &point_m));
            let places = bodies_along(link).chain(pulls);
            places.map(|xi| xi.clamp(LEAST_SPACING, 1.0 - LEAST_SPACING)).collect()
        })
    }

    /// The points of a piece at which springs pull \[m\], from its root in the frame that it carries.
    fn pulls_on(&self, piece: usize) -> impl Iterator<Item = Vector3<f64>> {
        let ends = self.springs.iter().filter_map(|spring| match &spring.kind {
            SpringKind::Line { ends, .. } => Some(ends),
            SpringKind::Torsion { .. } => None,
        });
        ends.flatten().filter(move |end| end.on == SpringPlace::Element(piece)).map(|end| end.point_m)
    }

    /// This structure with every tube divided at `places`, positions along the tube (0 at its root, 1 at its end), which
    /// are given for each tube and its index.
    fn divided(&self, places: impl Fn(usize, &LinkPiece) -> Vec<f64>) -> Divided {
        let starts_of = |(piece, what): (usize, &Piece)| match what {
            Piece::Link(link) if link.beam.is_some() => starts(places(piece, link)),
            Piece::Link(_) | Piece::Joint(_) | Piece::Prismatic(_) => vec![0.0],
        };
        let starts: Vec<Vec<f64>> = self.pieces.iter().enumerate().map(starts_of).collect();
        let parts = self.pieces.iter().zip(&starts).flat_map(|(piece, starts)| parts(piece, starts));
        let mut out = Structure { pieces: parts.collect(), ..self.clone() };
        // index of the first part of each piece in the divided structure
        let first = |piece: usize| starts[..piece].iter().map(Vec::len).sum::<usize>();
        let moved = |end: &mut SpringEnd| {
            let SpringPlace::Element(piece) = end.on else { return };
            let part = match &self.pieces[piece] {
                Piece::Link(link) => part_at(&starts[piece], along(link, &end.point_m)),
                Piece::Joint(_) | Piece::Prismatic(_) => 0,
            };
            if let Piece::Link(link) = &self.pieces[piece] {
                end.point_m -= link.vector_m * starts[piece][part];
            }
            end.on = SpringPlace::Element(first(piece) + part);
        };
        for spring in &mut out.springs {
            match &mut spring.kind {
                SpringKind::Line { ends, .. } => ends.iter_mut().for_each(moved),
                SpringKind::Torsion { joint, .. } => *joint = first(*joint),
            }
        }
        let whole = starts.iter().enumerate().flat_map(|(piece, starts)| vec![piece; starts.len()]).collect();
        Divided { structure: out, whole }
    }
}

/// Position of the foot of the perpendicular from a point to the line of a link: 0 at the root of the link, 1 at its
/// end. It is 0 for a link without length.
fn along(link: &LinkPiece, point_m: &Vector3<f64>) -> f64 {
    let length2_m2 = link.vector_m.norm_squared();
    if length2_m2 > 0.0 { link.vector_m.dot(point_m) / length2_m2 } else { 0.0 }
}

/// Positions of the bodies of a link along it.
fn bodies_along(link: &LinkPiece) -> impl Iterator<Item = f64> {
    link.bodies.iter().map(|body| along(link, &body.cg_m))
}

/// Positions at which the parts of a tube begin that is divided at `places`: 0 at its root, 1 at its end.
fn starts(places: Vec<f64>) -> Vec<f64> {
    let mut out = [vec![0.0], places].concat();
    out.sort_by(f64::total_cmp);
    out.dedup_by(|next, before| *next - *before < LEAST_SPACING);
    out
}

/// Index of the part that contains the point at `xi` along a piece (0 at its root, 1 at its end).
fn part_at(starts: &[f64], xi: f64) -> usize {
    starts.iter().rposition(|start| *start <= xi).unwrap_or_default()
}

/// The parts of a piece that begin at the positions `starts` (0 at its root, 1 at its end).
fn parts(piece: &Piece, starts: &[f64]) -> Vec<Piece> {
    let Piece::Link(link) = piece else { return vec![piece.clone()] };
    let part = |(i, &start): (usize, &f64)| {
        let end = starts.get(i + 1).copied().unwrap_or(1.0);
        let own = link.bodies.iter().filter(|body| part_at(starts, along(link, &body.cg_m)) == i);
        let moved = own.map(|body| RigidBody { cg_m: body.cg_m - link.vector_m * start, ..*body });
        Piece::Link(LinkPiece {
            name: if i == 0 { link.name.clone() } else { format!("{}, part {}", link.name, i + 1) },
            vector_m: link.vector_m * (end - start),
            bodies: moved.collect(),
            root_frame: if i == 0 { link.root_frame } else { FrameCompliance::default() },
            ..link.clone()
        })
    };
    starts.iter().enumerate().map(part).collect()
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

    const ARM: &str = r#"{"name": "a",
        "materials": {"steel": {"youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850}},
        "chain": [
            {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5},
            {"type": "link", "name": "l", "vector_m": [0.8, 0, 0], "material": "steel",
             "section": {"shape": "round_tube", "diameter_m": 0.08, "wall_m": 0.004},
             "bodies": [{"mass_kg": 3, "cg_m": [0.6, 0.05, 0]}, {"mass_kg": 2, "cg_m": [0.2, 0, -0.1]}]},
            {"type": "joint", "name": "k", "axis": [0, 1, 0], "stiffness_nm_per_rad": 5e4},
            {"type": "link", "name": "m", "vector_m": [0.4, 0, 0], "mass_kg": 1}],
        "springs": [
            {"name": "s", "from": {"at": "base", "point_m": [0, 0, 0.3]}, "to": {"at": "l", "point_m": [0.5, 0, 0.05]},
             "stiffness_n_per_m": 2000, "free_length_m": 0.3},
            {"name": "t", "joint": "k", "stiffness_nm_per_rad": 20, "free_deg": -30}]}"#;

    /// The deflections of the whole and of the divided arm are both exact, so they agree. Each spring acts at the same
    /// points as before.
    #[test]
    fn a_divided_arm_is_as_heavy_and_bends_as_far_with_its_springs_where_they_were() {
        let arm = read_arm_document(Document::parse("a.json", ARM).unwrap(), &Catalogs::default()).unwrap();
        let whole = arm.structure(JointModel::ThreeSegment);
        let divided = whole.divided_at_bodies().expect("two bodies");
        assert_eq!(divided.pieces.len(), whole.pieces.len() + 2);
        assert!((divided.mass_kg() - whole.mass_kg()).abs() < 1e-12);
        let tip_m = |structure| {
            let chain = Chain::new(structure, LinkModel::Full);
            let payload = Payload { mass_kg: 2.0, ..Payload::default() };
            chain.pose_rad(&[0.3, -0.5], &payload, Vector3::zeros()).statics().tip_displacement_m
        };
        let (whole_m, divided_m): (Vector3<f64>, Vector3<f64>) = (tip_m(&whole), tip_m(&divided));
        assert!((whole_m - divided_m).norm() < 1e-10 * whole_m.norm(), "{whole_m} {divided_m}");
        let mut without = whole.clone();
        without.springs.clear();
        assert!((tip_m(&without) - whole_m).norm() > 1e-2 * whole_m.norm(), "the springs act");
        assert!(divided.divided_at_bodies().is_none(), "its bodies are at the ends of its parts");
    }
}
