//! Computes what gravity does to the arm in each measured pose, by mechanics: the displacement that the model
//! already has, and that of each candidate per unit of its compliance.
//!
//! A joint that yields by `c` about an axis `u` through `p` moves a point `x` by `c g (u x (x - p)) (u x (S -
//! m p))ᵀ ĝ`. Here `m` and `S` are mass and first moment of everything outboard, `g` the strength and `ĝ` the
//! direction of gravity. Other arms on the same trunk count too.

use super::kinematics::Geometry;
use super::tree::Tree;
use crate::arm::effect::kind::{Kind, Yields};
use crate::arm::effect::{
    base_compliance, bearing_tilt, connection_compliance, frame_compliance, joint_compliance,
};
use crate::arm::joint_law::{Curve, JointLaw};
use crate::arm::load::Payload;
use crate::arm::structure::{FrameCompliance, Piece, Structure};
use crate::arm::{Arm, JointModel, LinkModel};
use crate::mechanics::chain::Chain;
use crate::mechanics::chain::{Body, ElasticElement, Item, Posed};
use crate::mechanics::{Twist, angular, displacement_at, linear};
use crate::reconcile::model::exact::{seen_from_tool, with_tool};
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::rows::PositionRow;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// Row and column of each entry of a frame's compliance matrix, in the order in which the entries are fitted.
pub(crate) const FRAME_ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (0, 1), (0, 2), (1, 2), (2, 2)];

/// A candidate: an effect at a place, by which something yields there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Yielding {
    /// Name of the effect.
    pub effect: &'static str,
    /// How the place yields: about a joint's axis, by tilting, or as a frame about every axis.
    pub yields: Yields,
    /// Name of the place.
    pub at: String,
}

/// The effect of gravity on one measured position, in the level frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Deflection {
    /// Displacement that the model already has \[m\].
    pub known_m: Vector3<f64>,
    /// Derivatives of the known displacement by the two components of gravity across the vertical \[m\].
    pub known_slopes_m: [Vector3<f64>; 2],
    /// For each compliance of each candidate, the displacement of the point per compliance, for gravity along each
    /// axis \[m per rad/(N m)\].
    pub per_compliance: Vec<Vec<Matrix3<f64>>>,
    /// For each candidate, the motion of the point per rotation about the candidate's first axis \[m\], and the
    /// torque about this axis under gravity along -z \[N m\]. Errors of a joint's angle show along this motion.
    pub levers: Vec<(Vector3<f64>, f64)>,
}

/// All candidates: every joint about its axis and across its axis, the base, and the structures behind the joints.
pub(crate) fn candidates(tree: &Tree) -> Vec<Yielding> {
    let mut out = Vec::new();
    for piece in &tree.pieces {
        if let Piece::Joint(joint) = piece {
            let rigid = joint.law.is_rigid();
            let about_axis = if rigid { &joint_compliance::KIND } else { &connection_compliance::KIND };
            out.extend(Yielding::new(about_axis, &joint.name));
            out.extend(Yielding::new(&bearing_tilt::KIND, &joint.name));
        }
    }
    out.extend(Yielding::new(&base_compliance::KIND, "base"));
    out.extend(Yielding::new(&frame_compliance::KIND, "base"));
    let behind = tree.arms.iter().flat_map(|chain| chain.windows(2));
    for (joint, link) in behind.map(|pair| (&tree.pieces[pair[0]], &tree.pieces[pair[1]])) {
        if let (Piece::Joint(_), Piece::Link(link)) = (joint, link)
            && !out.iter().any(|c| c.yields == Yields::Frame && c.at == link.name)
        {
            out.extend(Yielding::new(&frame_compliance::KIND, &link.name));
        }
    }
    out
}

impl Tree {
    /// Whether the compliance of a frame can have the same effect as another candidate. The frame of the base
    /// includes the tilt of the base, and the structure behind a joint includes the compliance of the joint.
    pub(crate) fn contains(&self, frame: &Yielding, other: &Yielding) -> bool {
        let is_behind = |pair: &[usize]| match (&self.pieces[pair[0]], &self.pieces[pair[1]]) {
            (Piece::Joint(joint), Piece::Link(link)) => joint.name == other.at && link.name == frame.at,
            _ => false,
        };
        frame.yields == Yields::Frame
            && other.yields != Yields::Frame
            && (frame.at == other.at || self.arms.iter().any(|chain| chain.windows(2).any(is_behind)))
    }
}

impl Yielding {
    /// The candidate of an effect at a place; `None` if positions do not show that the effect yields.
    fn new(kind: &'static Kind, at: &str) -> Option<Self> {
        kind.traits.yields.map(|yields| Self { effect: kind.name, yields, at: at.into() })
    }

    /// Number of compliances of the candidate. A frame has xx, yy, xy, xz, yz, and zz where weights can turn it about
    /// z.
    pub(crate) fn count(&self) -> usize {
        match (self.yields, self.at.as_str()) {
            (Yields::Frame, "base") => 5,
            (Yields::Frame, _) => 6,
            _ => 1,
        }
    }

    /// The name of the candidate's element in the chain.
    fn element(&self) -> String {
        let is_base_tilt = self.effect == base_compliance::KIND.name;
        match self.yields {
            Yields::AboutAxis => self.at.clone(),
            Yields::Tilt if is_base_tilt => self.at.clone(),
            Yields::Tilt | Yields::Frame => format!("{}.{}", self.at, self.effect),
        }
    }
}

/// One arm in the level frame with calibrated geometry, ready to be posed.
struct Ready {
    gravity_m_s2: f64,
    known: Chain,
    unit: Chain,
    structure: Structure,
    unit_structure: Structure,
    point_m: Vector3<f64>,
}

/// The effect of gravity on every measured position. `points` holds the index of each row's point.
pub(crate) fn deflections(
    campaign: &Campaign,
    tree: &Tree,
    geometry: &Geometry,
    candidates: &[Yielding],
    points: &[usize],
) -> Vec<Deflection> {
    let ready: Vec<Vec<Ready>> = campaign
        .arms()
        .iter()
        .enumerate()
        .map(|(i, arm)| {
            let mut calibrated = (*arm).clone();
            let turned = geometry.write_into(i, &mut calibrated);
            geometry.tools_m.iter().map(|t| Ready::new(campaign, &calibrated, turned * t)).collect()
        })
        .collect();
    let trunk = trunk_items(campaign, tree, &ready);
    campaign
        .positions
        .par_iter()
        .zip(points)
        .map(|(row, &point)| deflection(tree, &ready, trunk, candidates, row, point))
        .collect()
}

impl Ready {
    fn new(campaign: &Campaign, arm: &Arm, point_m: Vector3<f64>) -> Self {
        let mut structure = arm.structure(JointModel::ThreeSegment);
        for piece in &mut structure.pieces {
            if let Piece::Link(link) = piece
                && let Some(beam) = &mut link.beam
                && campaign.statement.rigid_links
            {
                beam.flexibility = 0.0;
            }
        }
        let structure = with_tool(&structure, point_m);
        let unit_structure = yielding_everywhere(&structure);
        Self {
            gravity_m_s2: structure.gravity_m_s2,
            known: Chain::new(&structure, LinkModel::Full),
            unit: Chain::new(&unit_structure, LinkModel::Full),
            structure,
            unit_structure,
            point_m,
        }
    }

    fn pose<'a>(&self, chain: &'a Chain, pose_rad: &[f64], payload: &Payload) -> Posed<'a> {
        chain.pose_rad(pose_rad, &seen_from_tool(payload, &self.point_m), Vector3::zeros())
    }
}

/// The structure in which every joint, about and across its axis, the base and every frame have unit compliance.
fn yielding_everywhere(structure: &Structure) -> Structure {
    let mut unit = structure.clone();
    unit.base_tilt_rad_per_nm = 1.0;
    unit.base_frame = FrameCompliance(Matrix3::identity());
    for piece in &mut unit.pieces {
        match piece {
            Piece::Joint(joint) => {
                joint.law = JointLaw::from(Curve::Linear(1.0));
                joint.tilt_rad_per_nm = 1.0;
            }
            Piece::Link(link) => link.root_frame = FrameCompliance(Matrix3::identity()),
        }
    }
    unit
}

/// How many items of a posed arm belong to the trunk: in the arm with unit compliances, and in the arm as it is.
fn trunk_items(campaign: &Campaign, tree: &Tree, ready: &[Vec<Ready>]) -> [usize; 2] {
    let rest = vec![0.0; tree.driven.len()];
    let first = &ready[0][0];
    let names: Vec<&str> = campaign.arm.chain[..tree.trunk].iter().map(|e| e.name()).collect();
    let of = |structure: &Structure| {
        let mut trunk = structure.clone();
        trunk.pieces.retain(|p| match p {
            Piece::Joint(j) => names.contains(&j.name.as_str()),
            Piece::Link(l) => names.contains(&l.name.as_str()),
        });
        // the payload is the last item
        Chain::new(&trunk, LinkModel::Full).pose_rad(&rest, &Payload::default(), Vector3::zeros()).items.len()
            - 1
    };
    [of(&first.unit_structure), of(&first.structure)]
}

fn deflection(
    tree: &Tree,
    ready: &[Vec<Ready>],
    [unit_trunk, known_trunk]: [usize; 2],
    candidates: &[Yielding],
    row: &PositionRow,
    point: usize,
) -> Deflection {
    let pose_rad: Vec<f64> = row.pose_deg.iter().map(|a| a.to_radians()).collect();
    let own = &ready[row.arm][point];
    let own_pose = tree.pose_of(row.arm, &pose_rad);
    let mut known = own.pose(&own.known, &own_pose, &row.payload);
    let mut unit = own.pose(&own.unit, &own_pose, &row.payload);
    let empty = Payload::default();
    // the weight of other arms loads the trunk, and so moves the point
    for other in (0..ready.len()).filter(|&other| other != row.arm) {
        let neighbour = &ready[other][0];
        let posed = neighbour.pose(&neighbour.unit, &tree.pose_of(other, &pose_rad), &empty);
        let hanging = || bodies(&posed.items[unit_trunk..], &neighbour.unit_structure);
        known.items.splice(known_trunk..known_trunk, hanging().map(Item::Body));
        unit.items.splice(unit_trunk..unit_trunk, hanging().map(Item::Body));
    }
    let (per_compliance, levers) = signatures(&unit, own, candidates);
    Deflection {
        known_m: known.statics().tip_displacement_m,
        known_slopes_m: [Vector3::zeros(); 2],
        per_compliance,
        levers,
    }
}

/// All bodies of a posed arm, as point masses.
fn bodies<'a>(items: &'a [Item], structure: &'a Structure) -> impl Iterator<Item = Body> + 'a {
    items.iter().filter_map(|item| match item {
        Item::Body(body) => Some(body.clone()),
        Item::Elastic(element) => own_body(element, structure),
    })
}

/// The distributed mass of a link, as a point mass at the link's middle.
fn own_body(element: &ElasticElement, structure: &Structure) -> Option<Body> {
    let own = element.own.as_ref()?;
    let Piece::Link(link) = &structure.pieces[own.piece] else { return None };
    let weight_n = -linear(&own.weight).z;
    Some(Body {
        mass_kg: weight_n / structure.gravity_m_s2,
        cg_m: own.root_m + own.frame.column(0) * (link.vector_m.norm() / 2.0),
        inertia_kgm2: Matrix3::zeros(),
        weight_n,
    })
}

/// For a joint, the motion of the tip per rotation \[m\], and the torque on the joint \[N m\].
type Lever = (Vector3<f64>, f64);

/// For every candidate: the displacement at unit compliance for gravity along each axis, and the lever with its
/// torque.
fn signatures(unit: &Posed, own: &Ready, candidates: &[Yielding]) -> (Vec<Vec<Matrix3<f64>>>, Vec<Lever>) {
    let answers = answers(unit, own);
    let of =
        |name: &str| answers.iter().find(|(n, _)| *n == name).map_or(Vec::new(), |(_, list)| list.clone());
    candidates
        .iter()
        .map(|candidate| {
            let mut list = of(&candidate.element());
            // a passive joint turns with its driver, so its compliance acts through the driver
            for linkage in unit.chain.linkages().iter().filter(|l| l.driver == candidate.element()) {
                for (driver, passive) in list.iter_mut().zip(of(&linkage.passive)) {
                    driver.0 += passive.0 * linkage.factor;
                    driver.1 += passive.1 * linkage.factor;
                }
            }
            let lever = list.first().map_or((Vector3::zeros(), 0.0), |(motion, pull)| (*motion, -pull.z));
            (per_compliance(candidate.count(), &list), lever)
        })
        .unzip()
}

/// Displacement per unit of each of `count` compliances about the twists' axes.
fn per_compliance(count: usize, list: &[Answer]) -> Vec<Matrix3<f64>> {
    // a candidate on another arm has no twists here
    let along = |(i, j): (usize, usize)| match (list.get(i), list.get(j)) {
        (Some((motion, _)), Some((_, pull))) => motion * pull.transpose(),
        _ => Matrix3::zeros(),
    };
    match count {
        1 => vec![(0..list.len()).map(|i| along((i, i))).sum()],
        _ => FRAME_ENTRIES[..count]
            .iter()
            .map(|&(i, j)| if i == j { along((i, i)) } else { along((i, j)) + along((j, i)) })
            .collect(),
    }
}

/// Displacement of the point by a unit twist, and the generalized force on this twist by gravity along each axis.
type Answer = (Vector3<f64>, Vector3<f64>);

/// For every element, the answers of its twists, by the element's name.
fn answers<'a>(unit: &'a Posed, own: &Ready) -> Vec<(&'a str, Vec<Answer>)> {
    let mut out = Vec::new();
    // weight and its first moment of everything outboard so far
    let (mut weight_n, mut moment_nm) = (0.0, Vector3::zeros());
    // from the tip to the base: what has been passed is outboard
    for item in unit.items.iter().rev() {
        let body = match item {
            Item::Body(body) => Some(body.clone()),
            Item::Elastic(element) => {
                let answer = |t: &Twist| (displacement_at(t, &unit.tip_m), pull(t, weight_n, &moment_nm));
                out.push((element.name.as_str(), element.twists.iter().map(answer).collect()));
                own_body(element, &own.unit_structure)
            }
        };
        if let Some(body) = body.filter(|_| own.gravity_m_s2 > 0.0) {
            weight_n += body.weight_n;
            moment_nm += body.cg_m * body.weight_n;
        }
    }
    out
}

/// Generalized force on a twist, for gravity along each axis.
fn pull(twist: &Twist, weight_n: f64, moment_nm: &Vector3<f64>) -> Vector3<f64> {
    linear(twist) * weight_n + angular(twist).cross(moment_nm)
}
