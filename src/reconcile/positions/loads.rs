//! Computes the deflection of the arm under gravity in each measured pose: the displacement by compliances that the arm
//! file already has, and the displacement by each candidate per unit of its compliance.
//!
//! A joint of compliance `c` about an axis `u` through `p` moves a point `r` by `c g (u × (r - p)) (u × (S - m p))ᵀ ĝ`.
//! Here `m` and `S` are mass and first moment of everything outboard, `g` the strength and `ĝ` the direction of
//! gravity. The mass of other arms on the same trunk is included.

use super::deflection::{Deflection, Slot};
use super::kinematics::Geometry;
use super::shape::Shape;
use super::tree::Tree;
use crate::arm::body::total_kg;
use crate::arm::effect::kind::{ElasticRotation, Kind};
use crate::arm::effect::subject::Subject;
use crate::arm::effect::waves::transmission_waves;
use crate::arm::effect::{
    base_compliance, bearing_tilt, connection_compliance, frame_compliance, joint_compliance,
};
use crate::arm::joint_law::{Curve, JointLaw};
use crate::arm::load::Payload;
use crate::arm::structure::{FrameCompliance, Piece, Structure};
use crate::arm::{Arm, BASE, JointModel, LinkModel};
use crate::mechanics::chain::{Chain, Item, Posed};
use crate::mechanics::deflections::Deflections;
use crate::mechanics::hanging::beyond_linear_m;
use crate::mechanics::tip::{Loaded, Strain, Tip, UnitRotation, Weights};
use crate::mechanics::{linear, stack};
use crate::reconcile::model::direct::{seen_from_tool, with_tool};
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::rows::PositionRow;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// A candidate: an effect at a place, which makes the arm compliant or gives it play there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CompliantPlace {
    /// Name of the effect.
    pub effect: &'static str,
    /// Direction of the compliance: about a joint's axis, tilt about the two axes perpendicular to it, or rotation of
    /// a frame about every axis.
    pub rotation: ElasticRotation,
    /// Place of the effect: the name of a joint or link, or `base`.
    pub at: String,
    /// How the displacement depends on the torque. The parameter of play is a half width \[rad\] and not a compliance.
    pub shape: Shape,
}

/// All candidates that are springs: every joint about and across its axis, the base, and a frame behind every joint at
/// the link that follows it.
pub(crate) fn candidates(tree: &Tree) -> Vec<CompliantPlace> {
    let mut out = Vec::new();
    for piece in &tree.pieces {
        if let Piece::Joint(joint) = piece {
            let rigid = joint.law.is_rigid();
            let about_axis = if rigid { &joint_compliance::KIND } else { &connection_compliance::KIND };
            out.extend(CompliantPlace::new(about_axis, &joint.name));
            out.extend(CompliantPlace::new(&bearing_tilt::KIND, &joint.name));
        }
    }
    out.extend(CompliantPlace::new(&base_compliance::KIND, BASE));
    out.extend(CompliantPlace::new(&frame_compliance::KIND, BASE));
    let behind = tree.arms.iter().flat_map(|chain| chain.windows(2));
    for (joint, link) in behind.map(|pair| (&tree.pieces[pair[0]], &tree.pieces[pair[1]])) {
        if let (Piece::Joint(_), Piece::Link(link)) = (joint, link)
            && !out.iter().any(|c| c.rotation == ElasticRotation::Frame && c.at == link.name)
        {
            out.extend(CompliantPlace::new(&frame_compliance::KIND, &link.name));
        }
    }
    out
}

impl Tree {
    /// Whether the compliance of the candidate `frame` can have the same effect as the candidate `other`. The frame
    /// of the base includes the tilt of the base, and the frame of a link includes the compliance of the joint before
    /// it.
    pub(crate) fn contains(&self, frame: &CompliantPlace, other: &CompliantPlace) -> bool {
        let is_behind = |pair: &[usize]| match (&self.pieces[pair[0]], &self.pieces[pair[1]]) {
            (Piece::Joint(joint), Piece::Link(link)) => joint.name == other.at && link.name == frame.at,
            _ => false,
        };
        frame.rotation == ElasticRotation::Frame
            && other.rotation != ElasticRotation::Frame
            && other.shape == Shape::Spring
            && (frame.at == other.at || self.arms.iter().any(|chain| chain.windows(2).any(is_behind)))
    }
}

impl CompliantPlace {
    /// The candidate of the effect `kind` at the place `at`; `None` if the effect adds no compliance that positions
    /// can show.
    fn new(kind: &'static Kind, at: &str) -> Option<Self> {
        kind.traits.rotation.map(|rotation| Self {
            effect: kind.name,
            rotation,
            at: at.into(),
            shape: Shape::Spring,
        })
    }

    /// Number of compliances of the candidate. A frame has xx, yy, xy, xz and yz. The frame of a link also has zz,
    /// because weights can turn it about z; they cannot turn the base about z.
    pub(crate) fn count(&self) -> usize {
        match (self.shape.waves(), self.rotation, self.at.as_str()) {
            (Some(waves), ..) => waves.len(),
            (None, ElasticRotation::Frame, BASE) => 5,
            (None, ElasticRotation::Frame, _) => 6,
            _ => 1,
        }
    }

    /// Number of parameters of the candidate: its compliances, and the threshold that is chosen.
    pub(crate) fn numbers(&self) -> usize {
        self.count() + usize::from(self.shape.threshold_nm().is_some())
    }

    /// Number of axes about which the candidate rotates under load.
    fn axes(&self) -> usize {
        match self.rotation {
            ElasticRotation::AboutAxis => 1,
            ElasticRotation::Tilt => 2,
            ElasticRotation::Frame => 3,
        }
    }

    /// The name of the elastic element in the chain that stands for the candidate.
    fn element(&self) -> String {
        let is_base_tilt = self.effect == base_compliance::KIND.name;
        match self.rotation {
            ElasticRotation::AboutAxis => self.at.clone(),
            ElasticRotation::Tilt if is_base_tilt => self.at.clone(),
            ElasticRotation::Tilt => format!("{}.bearing", self.at),
            ElasticRotation::Frame => format!("{}.{}", self.at, self.effect),
        }
    }
}

/// One arm in the level frame (z opposite to gravity), with calibrated geometry and its tip at one point on the tool,
/// ready to be posed.
struct Ready {
    known: Tip,
    unit: Tip,
    structure: Structure,
    unit_structure: Structure,
    point_m: Vector3<f64>,
    /// For each candidate, the places of its elements in this arm.
    places: Vec<Place>,
    /// The arm as it is.
    chain: Chain,
}

/// Places of a candidate's elements in an arm: indices among the elastic elements, counted from the tip to the base.
/// `own` is the candidate's own element; it is `None` if the candidate is on another arm. A passive joint turns with
/// its driving joint. So the candidate at the driving joint also includes the elements of the passive joints: `passive`
/// has their indices, and the factors of their angles.
struct Place {
    own: Option<usize>,
    passive: Vec<(usize, f64)>,
}

/// Computes how gravity deflects the measured points of a campaign, for one geometry.
pub(crate) struct Loads<'a> {
    tree: &'a Tree,
    /// For each arm and each point on a tool, the arm that ends at this point.
    ready: Vec<Vec<Ready>>,
    trunk: Trunk,
    slots: Arc<[Slot]>,
}

/// How much of an arm belongs to the trunk.
struct Trunk {
    /// Number of steps of the arm with unit compliances.
    unit: usize,
    /// Number of steps of the arm as it is.
    known: usize,
    /// Number of items of the posed arm.
    items: usize,
}

impl<'a> Loads<'a> {
    /// Prepares the arms with the calibrated geometry, once for each point on a tool.
    pub(crate) fn new(
        campaign: &Campaign,
        tree: &'a Tree,
        geometry: &Geometry,
        candidates: &[CompliantPlace],
    ) -> Self {
        Self::changed(campaign, tree, geometry, candidates, &|_| {})
    }

    /// Prepares arms that differ from those of the campaign by `change`, as [`new`](Self::new) does.
    pub(crate) fn changed(
        campaign: &Campaign,
        tree: &'a Tree,
        geometry: &Geometry,
        candidates: &[CompliantPlace],
        change: &dyn Fn(&mut Subject),
    ) -> Self {
        let ready: Vec<Vec<Ready>> = campaign
            .arms()
            .iter()
            .enumerate()
            .map(|(i, arm)| {
                let mut calibrated = (*arm).clone();
                let turned = geometry.write_into(i, &mut calibrated);
                let point = |t| Ready::new(campaign, &calibrated, turned * t, candidates, change);
                geometry.tools_m.iter().map(point).collect()
            })
            .collect();
        let slots = slots(tree, candidates);
        Self { tree, trunk: Trunk::new(campaign, tree, &ready), ready, slots }
    }

    /// How the point with index `point` deflects in the pose and with the payload of `row`. The derivatives with
    /// respect to the direction of gravity are not computed and stay zero.
    pub(super) fn deflection(&self, pose: &ArmPoses, row: &PositionRow, point: usize) -> Deflection {
        let hung = self.hung(pose, row, point);
        Deflection {
            known_m: self.known_of(&hung),
            known_slopes_m: [Vector3::zeros(); 2],
            rotations: hung.own.rotations(&hung.load(self.trunk.unit), &self.slots).into(),
            waves: self.waves(row),
            slots: Arc::clone(&self.slots),
        }
    }

    /// The deflection `found` of the point in `row`, which was computed with the springs among the candidates alone, with all
    /// candidates.
    pub(super) fn with_all_candidates(&self, row: &PositionRow, found: &Deflection) -> Deflection {
        Deflection { waves: self.waves(row), slots: Arc::clone(&self.slots), ..found.clone() }
    }

    /// For each driven joint, the waves of its angle, if a candidate depends on them.
    fn waves(&self, row: &PositionRow) -> Arc<[[f64; 4]]> {
        let varies = self.slots.iter().any(|slot| slot.shape.waves().is_some());
        let angles = row.pose_deg.iter().filter(|_| varies);
        angles.map(|angle| transmission_waves(angle.to_radians())).collect()
    }

    /// Displacement of a point under gravity by the compliances that the arm file already has, in the level frame
    /// \[m\].
    pub(crate) fn known_m(&self, row: &PositionRow, point: usize) -> Vector3<f64> {
        self.known_in_m(&self.pose(row), row, point)
    }

    /// The same, for a row whose [pose](Self::pose) is known.
    pub(super) fn known_in_m(&self, pose: &ArmPoses, row: &PositionRow, point: usize) -> Vector3<f64> {
        self.known_of(&self.hung(pose, row, point))
    }

    fn known_of(&self, hung: &Hung) -> Vector3<f64> {
        match hung.only_weights() {
            true => hung.own.known.displacement_m(&hung.load(self.trunk.known)),
            false => hung.posed(self.trunk.items, Deflections::default()).displaced().0,
        }
    }

    /// The error of the linear displacement of [`known_m`](Self::known_m): the displacement of the point with the
    /// levers of the deflected pose, less the linear displacement \[m\]. The bodies of other arms keep their places
    /// without deflection.
    pub(crate) fn second_order_m(&self, row: &PositionRow, point: usize) -> Vector3<f64> {
        let pose = self.pose(row);
        let hung = self.hung(&pose, row, point);
        let load = hung.load(self.trunk.known);
        match hung.only_weights() {
            true => beyond_linear_m(|by: Vec<Strain>| hung.own.known.hung(&load, &by)),
            false => beyond_linear_m(|by| hung.posed(self.trunk.items, by)),
        }
    }

    /// The angles of all arms in `row`.
    pub(super) fn pose(&self, row: &PositionRow) -> ArmPoses {
        let all_rad: Vec<f64> = row.pose_deg.iter().map(|a| a.to_radians()).collect();
        let own = |arm: usize| {
            let pose_rad = self.tree.pose_of(arm, &all_rad);
            let sin_cos = pose_rad.iter().map(|angle| libm::sincos(*angle)).collect();
            ArmPose { pose_rad, sin_cos }
        };
        ArmPoses((0..self.ready.len()).map(own).collect())
    }

    /// The arm that ends at the point with the index `point`, its pose in `row`, and the weights of the other arms.
    fn hung<'b>(&'b self, pose: &'b ArmPoses, row: &PositionRow, point: usize) -> Hung<'b> {
        let mut neighbours = Weights::default();
        for other in (0..self.ready.len()).filter(|&other| other != row.arm) {
            let ArmPose { pose_rad, sin_cos } = &pose.0[other];
            let trunk = (0, Weights::default());
            let load = Loaded { pose_rad, sin_cos, payload: &Payload::default(), trunk };
            neighbours.join(&self.ready[other][0].unit.weights_from(self.trunk.unit, &load));
        }
        let own = &self.ready[row.arm][point];
        let payload = seen_from_tool(&row.payload, &own.point_m);
        Hung { own, pose: &pose.0[row.arm], payload, neighbours }
    }
}

/// The pose of each arm.
pub(super) struct ArmPoses(Vec<ArmPose>);

/// The angles of one arm's driven joints \[rad\], and sine and cosine of each.
struct ArmPose {
    pose_rad: Vec<f64>,
    sin_cos: Vec<(f64, f64)>,
}

/// An arm in a pose, and the weights of the other arms that hang on its trunk.
struct Hung<'a> {
    own: &'a Ready,
    pose: &'a ArmPose,
    /// The payload. Its centre of gravity is counted from the point.
    payload: Payload,
    neighbours: Weights,
}

impl Hung<'_> {
    /// Whether all loads are weights. The forces of springs between parts of the arm are more than that.
    fn only_weights(&self) -> bool {
        self.own.structure.springs.is_empty()
    }

    /// Pose and load of the arm, of whose steps the first `trunk` belong to the trunk. The weight of the other arms deflects
    /// the trunk and so moves the point too.
    fn load(&self, trunk: usize) -> Loaded<'_> {
        let ArmPose { pose_rad, sin_cos } = self.pose;
        Loaded { pose_rad, sin_cos, payload: &self.payload, trunk: (trunk, self.neighbours) }
    }

    /// The arm in this pose, with the deflections `by`. The first `trunk` of its items belong to the trunk.
    fn posed(&self, trunk: usize, by: Deflections) -> Posed<'_> {
        let mut posed = self.own.chain.pose_with(&self.pose.pose_rad, &self.payload, Vector3::zeros(), by);
        let down = self.own.structure.down;
        let load = stack(&(down * self.neighbours.weight_n), &self.neighbours.moment_nm.cross(&down));
        posed.items.insert(trunk, Item::Load(load));
        posed
    }
}

impl Ready {
    fn new(
        campaign: &Campaign,
        arm: &Arm,
        point_m: Vector3<f64>,
        candidates: &[CompliantPlace],
        change: &dyn Fn(&mut Subject),
    ) -> Self {
        let mut subject = arm.subject(JointModel::ThreeSegment);
        change(&mut subject);
        let mut structure = subject.structure;
        for piece in &mut structure.pieces {
            if let Piece::Link(link) = piece
                && let Some(beam) = &mut link.beam
                && campaign.statement.rigid_links
            {
                beam.flexibility = 0.0;
            }
        }
        let structure = with_tool(&structure, point_m);
        let chain = Chain::new(&structure, LinkModel::Full);
        let unit_structure = compliant_everywhere(&structure, &chain, arm.driven_joint_names().len());
        Self {
            known: Tip::new(&structure, LinkModel::Full),
            unit: Tip::new(&unit_structure, LinkModel::Full),
            places: places(&Chain::new(&unit_structure, LinkModel::Full), arm, candidates),
            chain,
            structure,
            unit_structure,
            point_m,
        }
    }
}

/// The structure in which every joint (about and across its axis), the base and every frame have unit compliance. The
/// links are rigid, each with its mass at its middle. `known` is the arm as it is, from which the masses come.
fn compliant_everywhere(structure: &Structure, known: &Chain, joints: usize) -> Structure {
    let mut unit = structure.clone();
    unit.base_tilt_rad_per_nm = 1.0;
    unit.base_frame = FrameCompliance(Matrix3::identity());
    for piece in &mut unit.pieces {
        match piece {
            Piece::Joint(joint) => {
                joint.law = JointLaw::from(Curve::Linear(1.0));
                joint.tilt_rad_per_nm = 1.0;
                joint.lean_rad_per_nm = [0.0; 2];
            }
            // campaigns of positions refuse arms with prismatic joints
            Piece::Prismatic(_) => {}
            Piece::Link(link) => {
                link.root_frame = FrameCompliance(Matrix3::identity());
                link.beam = None;
            }
        }
    }
    // weight less buoyancy is the same in every pose, so the zero pose is enough to find it
    let rest = known.pose_rad(&vec![0.0; joints], &Payload::default(), Vector3::zeros());
    for own in rest.elements().filter_map(|element| element.own.as_ref()) {
        if let Piece::Link(link) = &mut unit.pieces[own.piece]
            && structure.gravity_m_s2 > 0.0
        {
            // the bodies on the link stay in the model, so that their mass is subtracted
            link.point_mass_kg -= linear(&own.weight).z / structure.gravity_m_s2 + total_kg(&link.bodies);
        }
    }
    unit
}

/// For each candidate, its place among the rotations. In `candidates`, the springs must come first.
fn slots(tree: &Tree, candidates: &[CompliantPlace]) -> Arc<[Slot]> {
    let mut first = 0;
    let mut out: Vec<Slot> = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        let is_spring_there = |c: &CompliantPlace| {
            (c.shape, c.rotation, &c.at) == (Shape::Spring, candidate.rotation, &candidate.at)
        };
        let own = candidates[..out.len()].iter().position(is_spring_there);
        out.push(Slot {
            first: own.map_or(first, |spring| out[spring].first),
            rotations: candidate.axes(),
            compliances: candidate.count(),
            shape: candidate.shape,
            driven: tree.driven.iter().position(|name| *name == candidate.at).unwrap_or_default(),
        });
        if candidate.shape == Shape::Spring {
            first += candidate.axes();
        }
    }
    out.into()
}

impl Trunk {
    fn new(campaign: &Campaign, tree: &Tree, ready: &[Vec<Ready>]) -> Self {
        let first = &ready[0][0];
        let names: Vec<&str> = campaign.arm.chain[..tree.trunk].iter().map(|e| e.name()).collect();
        let of = |structure: &Structure| {
            let mut trunk = structure.clone();
            trunk.pieces.retain(|piece| names.contains(&piece.name()));
            trunk
        };
        let [unit, known] = [&first.unit_structure, &first.structure].map(of);
        let chain = Chain::new(&known, LinkModel::Full);
        let rest = chain.pose_rad(&vec![0.0; tree.driven.len()], &Payload::default(), Vector3::zeros());
        Self {
            unit: Tip::new(&unit, LinkModel::Full).steps(),
            known: Tip::new(&known, LinkModel::Full).steps(),
            // the payload is the last item
            items: rest.items.len() - 1,
        }
    }
}

/// Places of each candidate's elements in an arm. An arm has the same elements in every pose, so they are looked up in
/// one pose.
fn places(unit: &Chain, arm: &Arm, candidates: &[CompliantPlace]) -> Vec<Place> {
    let rest = vec![0.0; arm.driven_joint_names().len()];
    let posed = unit.pose_rad(&rest, &Payload::default(), Vector3::zeros());
    let mut names: Vec<&str> = posed.elements().map(|element| element.name.as_str()).collect();
    names.reverse();
    let place = |name: &str| names.iter().position(|n| *n == name);
    let of = |candidate: &CompliantPlace| {
        let driven = unit.linkages().iter().filter(|l| l.driver == candidate.element());
        let passive = driven.filter_map(|l| Some((place(&l.passive)?, l.factor)));
        Place { own: place(&candidate.element()), passive: passive.collect() }
    };
    candidates.iter().map(of).collect()
}

impl Ready {
    /// The rotations of all candidates in a pose, in the order of `slots`. `load` is that of the arm with unit compliances.
    fn rotations(&self, load: &Loaded, slots: &[Slot]) -> Vec<UnitRotation> {
        let (elements, rotations) = self.unit.rotations(load);
        let mut out: Vec<UnitRotation> = Vec::new();
        for (place, slot) in self.places.iter().zip(slots).filter(|(_, slot)| slot.shape == Shape::Spring) {
            // a candidate on another arm does not move this point
            let own =
                |k: usize| place.own.map_or_else(UnitRotation::default, |at| rotations[elements[at] + k]);
            out.extend((0..slot.rotations).map(own));
            for (at, factor) in &place.passive {
                let (driver, passive) = (&mut out[slot.first], &rotations[elements[*at]]);
                driver.motion_m += passive.motion_m * *factor;
                driver.pull_nm += passive.pull_nm * *factor;
            }
        }
        out
    }
}
