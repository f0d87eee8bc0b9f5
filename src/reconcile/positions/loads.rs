//! Computes the deflection of the arm under gravity in each measured pose: the displacement by compliances that the arm
//! file already has, and the displacement by each candidate per unit of its compliance.
//!
//! A joint of compliance `c` about an axis `u` through `p` moves a point `r` by `c g (u × (r - p)) (u × (S - m p))ᵀ ĝ`.
//! Here `m` and `S` are mass and first moment of everything outboard, `g` the strength and `ĝ` the direction of
//! gravity. The mass of other arms on the same trunk is included.

use super::kinematics::Geometry;
use super::shape::{Shape, beyond_nm};
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
use crate::mechanics::hanging::beyond_linear_m;
use crate::mechanics::{Twist, angular, displacement_at, linear};
use crate::reconcile::model::direct::{seen_from_tool, with_tool};
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::rows::PositionRow;
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Row and column of each entry of the compliance matrix of a frame (a rotational spring about all three axes), in
/// the order in which the entries are fitted.
pub(crate) const FRAME_ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (0, 1), (0, 2), (1, 2), (2, 2)];

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

/// How one measured point deflects under gravity in its pose, in the level frame.
#[derive(Debug, Clone)]
pub(crate) struct Deflection {
    /// Displacement of the point by the compliances that the arm file already has \[m\].
    pub known_m: Vector3<f64>,
    /// Derivatives of the known displacement with respect to the two horizontal components of the unit vector of
    /// gravity \[m\].
    pub known_slopes_m: [Vector3<f64>; 2],
    /// The rotations of all candidates, in the order of the candidates.
    rotations: Arc<[UnitRotation]>,
    slots: Arc<[Slot]>,
    /// For each driven joint, sine and cosine of its angle and of twice its angle; empty if no candidate needs them.
    waves: Arc<[[f64; 4]]>,
}

/// One rotation by which a candidate can deflect: how the rotation moves the point, and the torque about its axis.
#[derive(Debug, Clone, Copy, Default)]
struct UnitRotation {
    /// Displacement of the point per angle of the rotation \[m/rad\].
    motion_m: Vector3<f64>,
    /// Torque about the axis of rotation, one entry for gravity along each axis of the level frame \[N m\].
    pull_nm: Vector3<f64>,
}

/// Where a candidate is among the rotations of all candidates: index of its first rotation, the number of its
/// rotations, and the number of its compliances. A candidate that is no spring uses the rotations of the spring at the
/// same place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    first: usize,
    rotations: usize,
    compliances: usize,
    shape: Shape,
    /// Index of the driven joint at the candidate's place, on whose angle the compliance may depend; 0 if there is
    /// none.
    driven: usize,
}

impl Deflection {
    /// A deflection with the known displacement `known_m` and without candidates.
    pub(crate) fn known(known_m: Vector3<f64>) -> Self {
        let (known_slopes_m, rotations, slots, waves) = Default::default();
        Self { known_m, known_slopes_m, rotations, slots, waves }
    }

    /// Number of compliances of a candidate.
    pub(crate) fn count(&self, candidate: usize) -> usize {
        self.slots[candidate].compliances
    }

    /// Whether the displacement by a candidate is proportional to the weight.
    pub(crate) fn is_proportional(&self, candidate: usize) -> bool {
        self.slots[candidate].shape.is_proportional()
    }

    /// The candidates of this deflection, with the threshold (torque scale of play, or preload) of the candidate
    /// `candidate` set to `nm` \[N m\].
    pub(super) fn slots_with_threshold(&self, candidate: usize, nm: f64) -> Arc<[Slot]> {
        let mut slots = self.slots.to_vec();
        slots[candidate].shape = slots[candidate].shape.with_threshold(nm);
        slots.into()
    }

    /// This deflection with the candidates `slots`, which differ in their thresholds only.
    pub(super) fn with_slots(&self, slots: &Arc<[Slot]>) -> Self {
        Self { slots: Arc::clone(slots), ..self.clone() }
    }

    /// The largest magnitude of the torques about the axes of a candidate, under gravity along -z \[N m\].
    pub(crate) fn torque_nm(&self, candidate: usize) -> f64 {
        self.rotations(candidate).iter().map(|rotation| rotation.pull_nm.z.abs()).fold(0.0, f64::max)
    }

    fn rotations(&self, candidate: usize) -> &[UnitRotation] {
        let slot = &self.slots[candidate];
        &self.rotations[slot.first..slot.first + slot.rotations]
    }

    /// Calls `each` once for each compliance of a candidate, with the displacement of the point per unit of this
    /// compliance, under gravity along `gravity` \[m per rad/(N m)\]. For play the unit is the half width \[m/rad\].
    pub(crate) fn per_compliance(
        &self,
        candidate: usize,
        gravity: &Vector3<f64>,
        mut each: impl FnMut(Vector3<f64>),
    ) {
        let own = self.rotations(candidate);
        let mut torques_nm = [0.0; 3];
        torques_nm.iter_mut().zip(own).for_each(|(nm, rotation)| *nm = rotation.pull_nm.dot(gravity));
        let along = |i: usize, j: usize| own[i].motion_m * torques_nm[j];
        let slot = &self.slots[candidate];
        match (slot.shape, slot.compliances) {
            (Shape::Play(scale_nm), _) => each(own[0].motion_m * libm::tanh(torques_nm[0] / scale_nm)),
            (Shape::Lift(preload_nm), _) => {
                let tilt = |i: usize| own[i].motion_m * beyond_nm(torques_nm[i], preload_nm);
                each((0..own.len()).map(tilt).sum());
            }
            (Shape::Waves(waves), _) => {
                let angle = &self.waves[slot.driven][waves.range()];
                angle.iter().for_each(|wave| each(along(0, 0) * *wave));
            }
            (Shape::Spring, 1) => each((0..own.len()).fold(Vector3::zeros(), |sum, i| sum + along(i, i))),
            (Shape::Spring, count) => FRAME_ENTRIES[..count].iter().for_each(|&(i, j)| {
                each(if i == j { along(i, i) } else { along(i, j) + along(j, i) });
            }),
        }
    }

    /// Displacement of the point under gravity along `gravity` if the candidate has the compliances `compliances`
    /// \[rad/(N m)\], in the level frame \[m\]. For play the entry is the half width \[rad\].
    pub(crate) fn displaced_m(
        &self,
        candidate: usize,
        compliances: &[f64],
        gravity: &Vector3<f64>,
    ) -> Vector3<f64> {
        let mut out = Vector3::zeros();
        let mut compliances = compliances.iter();
        self.per_compliance(candidate, gravity, |by| {
            out += by * compliances.next().copied().unwrap_or_default();
        });
        out
    }

    /// Displacement of the point per angle of rotation about the first axis of a candidate \[m/rad\], and the torque
    /// about this axis under gravity along -z \[N m\]. For a joint's axis, an error of the joint angle moves the
    /// point in the same direction.
    pub(crate) fn lever(&self, candidate: usize) -> (Vector3<f64>, f64) {
        self.rotations(candidate).first().map_or_else(Default::default, |s| (s.motion_m, -s.pull_nm.z))
    }
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
    gravity_m_s2: f64,
    known: Chain,
    unit: Chain,
    structure: Structure,
    unit_structure: Structure,
    point_m: Vector3<f64>,
    /// For each candidate, the places of its elements in this arm.
    places: Vec<Place>,
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
    /// Number of items (bodies and elastic elements) of a posed arm that belong to the trunk: first in the arm with
    /// unit compliances, then in the arm as it is.
    trunk: [usize; 2],
    slots: Arc<[Slot]>,
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
        Self { tree, trunk: trunk_items(campaign, tree, &ready), ready, slots }
    }

    /// How the point with index `point` deflects in the pose and with the payload of `row`. The derivatives with
    /// respect to the direction of gravity are not computed and stay zero.
    pub(crate) fn deflection(&self, row: &PositionRow, point: usize) -> Deflection {
        let hung = self.hung(row, point);
        let mut unit = hung.own.pose(&hung.own.unit, &hung.pose_rad, &row.payload);
        hung.load_trunk(&mut unit, self.trunk[0]);
        let varies = self.slots.iter().any(|slot| slot.shape.waves().is_some());
        let angles = row.pose_deg.iter().filter(|_| varies);
        Deflection {
            waves: angles.map(|angle| transmission_waves(angle.to_radians())).collect(),
            known_m: self.known_of(&hung, row).displaced().0,
            known_slopes_m: [Vector3::zeros(); 2],
            rotations: hung.own.rotations(&unit, &self.slots).into(),
            slots: Arc::clone(&self.slots),
        }
    }

    /// Displacement of a point under gravity by the compliances that the arm file already has, in the level frame
    /// \[m\].
    pub(crate) fn known_m(&self, row: &PositionRow, point: usize) -> Vector3<f64> {
        self.known_of(&self.hung(row, point), row).displaced().0
    }

    /// The error of the linear displacement of [`known_m`](Self::known_m): the displacement of the point with the
    /// levers of the deflected pose, less the linear displacement \[m\]. The bodies of other arms keep their places
    /// without deflection.
    pub(crate) fn second_order_m(&self, row: &PositionRow, point: usize) -> Vector3<f64> {
        let hung = self.hung(row, point);
        let payload = seen_from_tool(&row.payload, &hung.own.point_m);
        beyond_linear_m(|deflections| {
            let mut posed = hung.own.known.pose_with(&hung.pose_rad, &payload, Vector3::zeros(), deflections);
            hung.load_trunk(&mut posed, self.trunk[1]);
            posed
        })
    }

    /// The arm with the compliances of its file, in the pose and with the payload of `row`. The pose is not deflected.
    fn known_of<'b>(&self, hung: &Hung<'b>, row: &PositionRow) -> Posed<'b> {
        let mut known = hung.own.pose(&hung.own.known, &hung.pose_rad, &row.payload);
        hung.load_trunk(&mut known, self.trunk[1]);
        known
    }

    /// The arm that ends at the point with the index `point`, its pose in `row`, and the bodies of the other arms.
    fn hung(&self, row: &PositionRow, point: usize) -> Hung<'_> {
        let pose_rad: Vec<f64> = row.pose_deg.iter().map(|a| a.to_radians()).collect();
        let others = (0..self.ready.len()).filter(|&other| other != row.arm);
        let outboard = others.map(|other| {
            let neighbour = &self.ready[other][0];
            let pose = self.tree.pose_of(other, &pose_rad);
            let hanging = neighbour.pose(&neighbour.unit, &pose, &Payload::default());
            let outboard = hanging.items.into_iter().skip(self.trunk[0]);
            outboard.filter(|item| matches!(item, Item::Body(_))).collect()
        });
        Hung {
            neighbours: outboard.collect(),
            own: &self.ready[row.arm][point],
            pose_rad: self.tree.pose_of(row.arm, &pose_rad),
        }
    }
}

/// An arm in a pose, and the bodies of the other arms that hang on its trunk.
struct Hung<'a> {
    own: &'a Ready,
    /// Angles of the arm's own joints \[rad\].
    pose_rad: Vec<f64>,
    /// For each other arm, its bodies outboard of the trunk.
    neighbours: Vec<Vec<Item>>,
}

impl Hung<'_> {
    /// Adds the bodies of the other arms to the trunk of a posed arm. Their weight deflects the trunk and so moves
    /// the point too. The trunk ends after `items` items of the posed arm.
    fn load_trunk(&self, posed: &mut Posed, items: usize) {
        for bodies in &self.neighbours {
            posed.items.splice(items..items, bodies.iter().cloned());
        }
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
        let known = Chain::new(&structure, LinkModel::Full);
        let unit_structure = compliant_everywhere(&structure, &known, arm.driven_joint_names().len());
        let unit = Chain::new(&unit_structure, LinkModel::Full);
        Self {
            gravity_m_s2: structure.gravity_m_s2,
            known,
            places: places(&unit, arm, candidates),
            unit,
            structure,
            unit_structure,
            point_m,
        }
    }

    fn pose<'a>(&self, chain: &'a Chain, pose_rad: &[f64], payload: &Payload) -> Posed<'a> {
        chain.pose_rad(pose_rad, &seen_from_tool(payload, &self.point_m), Vector3::zeros())
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

/// Number of items (bodies and elastic elements) of a posed arm that belong to the trunk: first in the arm with unit
/// compliances, then in the arm as it is.
fn trunk_items(campaign: &Campaign, tree: &Tree, ready: &[Vec<Ready>]) -> [usize; 2] {
    let rest = vec![0.0; tree.driven.len()];
    let first = &ready[0][0];
    let names: Vec<&str> = campaign.arm.chain[..tree.trunk].iter().map(|e| e.name()).collect();
    let of = |structure: &Structure| {
        let mut trunk = structure.clone();
        trunk.pieces.retain(|piece| names.contains(&piece.name()));
        // the payload is the last item
        Chain::new(&trunk, LinkModel::Full).pose_rad(&rest, &Payload::default(), Vector3::zeros()).items.len()
            - 1
    };
    [of(&first.unit_structure), of(&first.structure)]
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
    /// The rotations of all candidates in a pose, in the order of `slots`. `unit` is the posed arm with unit
    /// compliances.
    fn rotations(&self, unit: &Posed, slots: &[Slot]) -> Vec<UnitRotation> {
        let (elements, rotations) = self.rotations_of_elements(unit);
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

    /// The rotations of every elastic element in a pose, from the tip to the base. The first result is, for each
    /// element, the index of its first rotation.
    fn rotations_of_elements(&self, unit: &Posed) -> (Vec<usize>, Vec<UnitRotation>) {
        let (mut elements, mut rotations) = (Vec::new(), Vec::new());
        // weight, and its first moment, of the bodies passed so far
        let (mut weight_n, mut moment_nm) = (0.0, Vector3::zeros());
        // from the tip to the base: all items that were passed are outboard
        for item in unit.items.iter().rev() {
            match item {
                Item::Body(body) if self.gravity_m_s2 > 0.0 => {
                    weight_n += body.weight_n;
                    moment_nm += body.cg_m * body.weight_n;
                }
                // campaigns of positions refuse arms with springs
                Item::Body(_) | Item::Load(_) => {}
                Item::Elastic(element) => {
                    elements.push(rotations.len());
                    rotations.extend(element.twists.iter().map(|t| UnitRotation {
                        motion_m: displacement_at(t, &unit.tip_m),
                        pull_nm: pull(t, weight_n, &moment_nm),
                    }));
                }
            }
        }
        (elements, rotations)
    }
}

/// Generalized force of gravity on the motion `twist` (a kinematic vector) of everything outboard \[N m\], one entry
/// for gravity along each axis. `weight_n` is the weight of everything outboard, and `moment_nm` this weight times
/// its centre of gravity.
fn pull(twist: &Twist, weight_n: f64, moment_nm: &Vector3<f64>) -> Vector3<f64> {
    linear(twist) * weight_n + angular(twist).cross(moment_nm)
}
