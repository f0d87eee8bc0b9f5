//! Chains: an arm prepared for many poses (`Chain`), and the arm in one of them (`Posed`).
//!
//! A posed arm is a list from base to tip of elastic elements, each with the motions that it allows, and of rigid
//! bodies with their inertia.

use super::beam::{PreparedBeam, pull_on};
use super::deflections::{Deflections, screw};
use super::{Twist, Wrench, across, body_inertia, force_wrench, rotation_twist, stack};
use crate::arm::base_lift::BaseLift;
use crate::arm::body::RigidBody;
use crate::arm::effect::base_lift;
use crate::arm::joint_law::JointLaw;
use crate::arm::linkage::{Linkage, linkages};
use crate::arm::load::{LoadCase, Payload, Water};
use crate::arm::pose::{DrivenJoint, pose_si};
use crate::arm::prismatic::PrismaticPiece;
use crate::arm::springs::{Drawn, ElementFrame, EndLoad, Side, Spring, end_loads};
use crate::arm::structure::{FrameCompliance, JointPiece, LinkPiece, Piece, Structure};
use crate::arm::{BASE, LinkModel};
use nalgebra::{DMatrix, Matrix3, Matrix6, Matrix6xX, Rotation3, Vector3};

/// An arm prepared for many poses and loads.
///
/// Everything that does not depend on the pose is computed in [`Chain::new`]. [`Chain::pose`] puts the arm into the
/// pose of a load case and applies its load; [`Posed::statics`] and [`Posed::modes`] then compute deflection and
/// modes.
///
/// ```
/// use armwright::arm::{JointModel, LinkModel, Payload, read_arm_document};
/// use armwright::catalog::Catalogs;
/// use armwright::input::Document;
/// use armwright::mechanics::Chain;
/// use nalgebra::Vector3;
///
/// let text = r#"{"name": "one joint", "gravity_m_s2": 9.81, "chain": [
///     {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5},
///     {"type": "link", "name": "arm", "vector_m": [1, 0, 0]}]}"#;
/// let document = Document::parse("arm.json", text).expect("JSON");
/// let arm = read_arm_document(document, &Catalogs::default()).expect("a sound arm");
/// let chain = Chain::new(&arm.structure(JointModel::ThreeSegment), LinkModel::Full);
///
/// // 10 kg at the end of a lever of 1 m, on a spring of 1e5 N m/rad
/// let payload = Payload { mass_kg: 10.0, ..Payload::default() };
/// let posed = chain.pose_rad(&[0.0], &payload, Vector3::zeros());
/// let statics = posed.statics();
/// assert!((statics.joint_torques_nm[0].1 - 98.1).abs() < 1e-9);
/// assert!((statics.tip_displacement_m.z + 98.1 / 1e5).abs() < 1e-12);
/// let lowest = &posed.modes(&statics, 1)[0];
/// assert!((lowest.frequency_hz - (1e5_f64 / 10.0).sqrt() / std::f64::consts::TAU).abs() < 1e-9);
/// ```
#[derive(Debug, Clone)]
pub struct Chain {
    gravity_m_s2: f64,
    down: Vector3<f64>,
    base_tilt_rad_per_nm: f64,
    base_lift: Option<BaseLift>,
    base_frame: FrameCompliance,
    water: Option<Water>,
    pub(super) pieces: Vec<Prepared>,
    linkages: Vec<Linkage>,
    driven: Vec<DrivenJoint>,
    springs: Vec<Spring>,
}

/// A joint or a link of the chain, with everything that does not depend on the pose.
#[derive(Debug, Clone)]
pub(super) enum Prepared {
    Joint(JointPiece),
    Prismatic(PrismaticPiece),
    Link(LinkPiece, Option<PreparedBeam>),
}

/// How the strain coordinates of an element (its deflections) follow from the generalized forces on them.
#[derive(Debug, Clone)]
pub enum Compliance {
    /// The deflection is proportional to the force. There is one compliance for each coordinate.
    Linear(Vec<f64>),
    /// The joint law of a revolute joint gives the deflection. There is one coordinate: the angle of torsion.
    Joint(JointLaw),
    /// The deflection is along the travel of a prismatic joint, and is proportional to the force. The x axis of
    /// `frame`, the frame of the joint's guide, points along the travel.
    Slide { m_per_n: f64, frame: Matrix3<f64> },
    /// The deflection is the tilt of a base whose feet can lift off. There are two coordinates: the rotations about
    /// world x and about world y.
    Lift(BaseLift),
}

/// The part of the arm to which an elastic element belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// The base of the arm.
    Base,
    /// The piece of the chain with this index.
    Piece(usize),
}

/// One elastic element of an arm in a pose.
#[derive(Debug, Clone)]
pub struct ElasticElement {
    /// Name of the element: the name of the joint or link, `NAME.bearing`, `NAME.guide`, `NAME.frame_compliance`, or
    /// `base`. It is `base.ground` if a joint or a tube has the name `base`.
    pub name: String,
    /// The part of the arm to which the element belongs.
    pub owner: Owner,
    /// Position of the element in the world \[m\]. For a link it is the position of its root.
    pub at_m: Vector3<f64>,
    /// Motion of everything outboard per unit of each strain coordinate, as a vector of velocity and angular velocity
    /// at the world's origin.
    pub twists: Vec<Twist>,
    /// How the strain coordinates (the deflections of the element) follow from the generalized forces on them.
    pub compliance: Compliance,
    /// Torque on the coordinate of a joint that comes neither from weight nor from the load, such as the torque of a
    /// counterbalance \[N m\]; 0 for other elements.
    pub torque_nm: f64,
    /// The distributed mass of the element, if it is a link with mass along it.
    pub own: Option<OwnMass>,
}

/// The distributed mass of a link in a pose.
#[derive(Debug, Clone)]
pub struct OwnMass {
    /// Index of the link among the pieces of the chain.
    pub piece: usize,
    /// Position of the root of the link in the world \[m\].
    pub root_m: Vector3<f64>,
    /// Axes of the section of the link (columns), in the world.
    pub frame: Matrix3<f64>,
    /// Inertia matrix of the undeformed link about the world's origin.
    pub rigid: Matrix6<f64>,
    /// Momentum about the world's origin per unit rate of each strain coordinate.
    pub coupling: Matrix6xX<f64>,
    /// Inertia matrix over the strain coordinates of the link.
    pub inner: DMatrix<f64>,
    /// Weight of the link and forces of springs that act along it, as a wrench about the world's origin.
    pub weight: Wrench,
    /// Work of this weight and these forces per unit of each strain coordinate.
    pub weight_work: Vec<f64>,
}

/// A rigid body of an arm in a pose.
#[derive(Debug, Clone)]
pub struct Body {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Centre of gravity in the world \[m\].
    pub cg_m: Vector3<f64>,
    /// Inertia about the centre of gravity in world axes \[kg m²\].
    pub inertia_kgm2: Matrix3<f64>,
    /// Weight minus buoyancy \[N\]; a magnitude, without sign.
    pub weight_n: f64,
    /// Direction of gravity in the world, a unit vector.
    pub down: Vector3<f64>,
}

/// An item of a posed arm, in the order from base to tip. A body or a load is moved by every elastic element that
/// comes before it.
#[derive(Debug, Clone)]
pub enum Item {
    /// An elastic element.
    Elastic(ElasticElement),
    /// A rigid body.
    Body(Body),
    /// Force and moment that springs put on the arm, as a wrench about the world's origin.
    Load(Wrench),
}

/// An arm in a pose under a load.
#[derive(Debug, Clone)]
pub struct Posed<'a> {
    /// The chain that was put into the pose.
    pub chain: &'a Chain,
    /// Elements, bodies and spring loads, base to tip.
    pub items: Vec<Item>,
    /// Position of the tip in the world, without deflection \[m\].
    pub tip_m: Vector3<f64>,
    /// Rotation from the axes of the last frame to the world.
    pub tip_rotation: Rotation3<f64>,
    /// Force at the tip in world axes \[N\].
    pub tip_force_n: Vector3<f64>,
    /// Moment at the tip in world axes \[N m\].
    pub tip_moment_nm: Vector3<f64>,
}

impl Chain {
    /// Prepares the pieces of an arm for any pose, with the link model `links`.
    /// [`Arm::structure`](crate::arm::Arm::structure) makes the structure of an arm.
    pub fn new(structure: &Structure, links: LinkModel) -> Self {
        let pieces = structure
            .pieces
            .iter()
            .map(|piece| match piece {
                Piece::Joint(joint) => Prepared::Joint(joint.clone()),
                Piece::Prismatic(joint) => Prepared::Prismatic(joint.clone()),
                Piece::Link(link) => Prepared::Link(link.clone(), PreparedBeam::new(link, structure, links)),
            })
            .collect();
        Self {
            gravity_m_s2: structure.gravity_m_s2,
            down: structure.down,
            base_tilt_rad_per_nm: structure.base_tilt_rad_per_nm,
            base_lift: structure.base_lift,
            base_frame: structure.base_frame,
            water: structure.water,
            pieces,
            linkages: linkages(structure),
            driven: structure.driven_joints(),
            springs: structure.springs.clone(),
        }
    }

    /// Converts a pose as files have it (degrees, and millimetres of travel) to radians and metres.
    pub fn pose_si(&self, pose_deg: &[f64]) -> Vec<f64> {
        pose_si(&self.driven, pose_deg)
    }

    /// Puts the arm into the pose of a case and applies its load. The pose of the case has one entry for each driven
    /// joint, base to tip: an angle \[deg\], or the travel of a prismatic joint \[mm\].
    pub fn pose(&self, case: &LoadCase) -> Posed<'_> {
        let pose_rad = self.pose_si(&case.pose_deg);
        let posed = self.pose_rad(&pose_rad, &case.payload, case.tip_force_n);
        Posed { tip_moment_nm: case.tip_moment_nm, ..posed }
    }

    /// Puts the arm into a pose given in radians (metres for prismatic joints), with a payload and a force at the tip
    /// \[N\].
    pub fn pose_rad(&self, pose_rad: &[f64], payload: &Payload, tip_force_n: Vector3<f64>) -> Posed<'_> {
        self.pose_with(pose_rad, payload, tip_force_n, Deflections::default())
    }

    /// Does the same as [`pose_rad`](Self::pose_rad), for an arm whose elements have deflected by `deflections`.
    pub(crate) fn pose_with(
        &self,
        pose_rad: &[f64],
        payload: &Payload,
        tip_force_n: Vector3<f64>,
        deflections: Deflections,
    ) -> Posed<'_> {
        let springs = self.spring_loads(pose_rad, &deflections);
        let mut walk = self.walk(pose_rad, springs, deflections);
        // The payload is the last body, so every element moves it.
        walk.items.push(Item::Body(self.payload_body(payload, &walk)));
        Posed {
            chain: self,
            items: walk.items,
            tip_m: walk.at_m,
            tip_rotation: walk.rotation,
            tip_force_n,
            tip_moment_nm: Vector3::zeros(),
        }
    }

    /// Walks from base to tip and collects the elements and bodies. On the way it inserts the forces of the springs,
    /// `springs`, and moves the arm by the deflections of its elements, `deflections`.
    fn walk(&self, pose_rad: &[f64], springs: Vec<EndLoad>, deflections: Deflections) -> Walk {
        let mut walk = Walk {
            items: Vec::new(),
            at_m: Vector3::zeros(),
            rotation: Rotation3::identity(),
            gravity: (self.gravity_m_s2, self.down),
            springs,
            deflections,
            frames: Vec::with_capacity(self.pieces.len()),
        };
        if self.base_tilt_rad_per_nm > 0.0 {
            walk.tilt(
                (Owner::Base, self.base_name()),
                [Vector3::x(), Vector3::y()].map(|axis| (axis, self.base_tilt_rad_per_nm)),
            );
        }
        walk.lift(self.base_lift);
        walk.frame(Owner::Base, BASE, &self.base_frame);
        walk.load(Side::Base);
        for (index, piece) in self.pieces.iter().enumerate() {
            match piece {
                Prepared::Joint(joint) => walk.joint(index, joint, joint.angle.of(pose_rad)),
                Prepared::Prismatic(joint) => walk.prismatic(index, joint, pose_rad[joint.entry]),
                Prepared::Link(link, beam) => walk.link(index, link, beam.as_ref()),
            }
        }
        walk
    }

    /// Name of the elastic element of a base that tilts. Results have a row for each name, so it differs from the names
    /// of all joints and tubes.
    fn base_name(&self) -> String {
        let is_taken = self.pieces.iter().any(|piece| match piece {
            Prepared::Joint(JointPiece { name, .. }) | Prepared::Prismatic(PrismaticPiece { name, .. }) => {
                name == BASE
            }
            Prepared::Link(link, beam) => beam.is_some() && link.name == BASE,
        });
        if is_taken { format!("{BASE}.ground") } else { BASE.into() }
    }

    /// Forces of the springs on the arm in a pose. The forces depend on the positions of the springs' ends, so a first
    /// walk from base to tip without springs finds these positions.
    fn spring_loads(&self, pose_rad: &[f64], deflections: &Deflections) -> Vec<EndLoad> {
        match self.springs.is_empty() {
            true => Vec::new(),
            false => end_loads(&self.springs, &self.walk(pose_rad, Vec::new(), deflections.clone()).frames),
        }
    }

    /// The springs in the pose `pose_rad` \[rad, m\], each with its name. Springs whose ends are not in the chain are
    /// left out.
    pub fn springs_in(&self, pose_rad: &[f64]) -> Vec<(&str, Drawn)> {
        let frames = self.walk(pose_rad, Vec::new(), Deflections::default()).frames;
        let drawn = |spring: &'_ Spring| spring.drawn(&frames);
        self.springs.iter().filter_map(|spring| Some((spring.name.as_str(), drawn(spring)?))).collect()
    }

    /// The linkages of the arm: every joint that turns another.
    pub fn linkages(&self) -> &[Linkage] {
        &self.linkages
    }

    /// The prepared beam of the piece with this index, for the displacement inside a link. `None` if the piece is not
    /// a link, or is a link without a beam.
    pub(crate) fn beam(&self, piece: usize) -> Option<&PreparedBeam> {
        match &self.pieces[piece] {
            Prepared::Link(_, beam) => beam.as_ref(),
            _ => None,
        }
    }

    /// The payload as a rigid body at the tip, where the walk from base to tip has ended. In water, buoyancy is
    /// subtracted from its weight.
    fn payload_body(&self, payload: &Payload, walk: &Walk) -> Body {
        let rotation = walk.rotation.matrix();
        let buoyancy = self.water.map_or(0.0, |w| w.density_kg_m3 / w.payload_density_kg_m3);
        Body {
            mass_kg: payload.mass_kg,
            cg_m: walk.at_m + rotation * payload.cg_m,
            inertia_kgm2: rotation
                * Matrix3::from_diagonal(&payload.inertia_about_cg_kgm2)
                * rotation.transpose(),
            weight_n: payload.mass_kg * self.gravity_m_s2 * (1.0 - buoyancy),
            down: self.down,
        }
    }
}

/// The walk from base to tip. It collects the elements, bodies and loads on its way.
pub(super) struct Walk {
    pub(super) items: Vec<Item>,
    pub(super) at_m: Vector3<f64>,
    pub(super) rotation: Rotation3<f64>,
    /// Acceleration of gravity \[m/s²\] and its direction.
    gravity: (f64, Vector3<f64>),
    /// Forces that the springs put on the arm.
    springs: Vec<EndLoad>,
    /// Deflections of the elements; none in the undeflected pose.
    deflections: Deflections,
    /// Position and attitude of each piece passed so far.
    pub(super) frames: Vec<ElementFrame>,
}

impl Walk {
    /// Adds a joint at the angle `angle_rad`. The mass of the joint is inboard of its springs, so its own deflection
    /// does not move it. The springs of its bearing come before its torsion spring.
    fn joint(&mut self, index: usize, joint: &JointPiece, angle_rad: f64) {
        self.point_mass(joint.mass_kg, self.at_m);
        self.bodies(&joint.bodies.fixed);
        self.load(Side::Fixed(index));
        self.bearing(index, joint);
        let axis = self.rotation * joint.axis; // the bearing turns it as it deflects
        self.elastic(ElasticElement {
            name: joint.name.clone(),
            owner: Owner::Piece(index),
            at_m: self.at_m,
            twists: vec![rotation_twist(&axis, &self.at_m)],
            compliance: Compliance::Joint(joint.law.at_angle(angle_rad)),
            torque_nm: joint.torque.at(angle_rad),
            own: None,
        });
        self.rotation *= Rotation3::from_axis_angle(&joint.axis, angle_rad);
        self.bodies(&joint.bodies.rotating);
        self.load(Side::Moving(index));
        let hinge = Some((axis.into_inner(), angle_rad));
        self.frames.push(ElementFrame { at_m: self.at_m, rotation: self.rotation, hinge });
    }

    /// Adds a link; the compliance of the frame at its root comes before it. `piece` is the index of the link in the
    /// chain.
    fn link(&mut self, piece: usize, link: &LinkPiece, beam: Option<&PreparedBeam>) {
        self.frame(Owner::Piece(piece), &link.name, &link.root_frame);
        let vector = self.rotation * link.vector_m;
        self.point_mass(link.point_mass_kg, self.at_m + vector / 2.0);
        let end_m = self.at_m + vector;
        let element = beam.map(|beam| self.beam_element(piece, link, beam, &end_m));
        // Bodies on a tube are part of its beam, where each moves with a point of the axis. Only bodies on a rigid
        // offset are added here.
        if link.beam.is_none() {
            self.bodies(&link.bodies);
            self.load(Side::Moving(piece));
        }
        self.frames.push(ElementFrame { at_m: self.at_m, rotation: self.rotation, hinge: None });
        self.at_m = end_m;
        if let Some(element) = element {
            self.elastic(element);
        }
    }

    /// Adds an elastic element. If the walk applies deflections, the deflection of the element then moves the frame
    /// that the walk has reached.
    pub(super) fn elastic(&mut self, element: ElasticElement) {
        if let Some(motion) = self.deflections.motion_of_next(&element.twists) {
            screw(&motion, &mut self.at_m, &mut self.rotation);
        }
        self.items.push(Item::Elastic(element));
    }

    /// The elastic element of a link. `piece` is the index of the link in the chain, and its end is at `end_m` in the
    /// world \[m\].
    fn beam_element(
        &self,
        piece: usize,
        link: &LinkPiece,
        beam: &PreparedBeam,
        end_m: &Vector3<f64>,
    ) -> ElasticElement {
        let frame = self.rotation.matrix() * beam.frame;
        let twists = beam
            .end_fields
            .column_iter()
            .map(|field| {
                let rotation = frame * field.fixed_rows::<3>(3);
                stack(&(frame * field.fixed_rows::<3>(0) + end_m.cross(&rotation)), &rotation)
            })
            .collect();
        ElasticElement {
            name: link.name.clone(),
            owner: Owner::Piece(piece),
            at_m: self.at_m,
            twists,
            compliance: Compliance::Linear(beam.compliances.clone()),
            torque_nm: 0.0,
            own: Some(self.own_mass(piece, link, beam, &frame)),
        }
    }

    /// The distributed mass of a link, and the forces that springs put on a tube along its length. `frame` is the
    /// section frame of the link in the world.
    fn own_mass(&self, piece: usize, link: &LinkPiece, beam: &PreparedBeam, frame: &Matrix3<f64>) -> OwnMass {
        let mut own = own_mass(piece, beam, frame, &self.at_m, &self.gravity.1);
        let on_tube = |load: &&EndLoad| link.beam.is_some() && load.on == Side::Moving(piece);
        for load in self.springs.iter().filter(on_tube) {
            own.weight += wrench_of(load);
            let (xi, local) = pull_on(beam.length_m, &self.at_m, frame, load);
            let work = beam.fields(xi).columns_range(6..).tr_mul(&local);
            own.weight_work.iter_mut().zip(work.iter()).for_each(|(sum, work)| *sum += work);
        }
        own
    }

    /// Adds the forces that springs put on a part of the arm; nothing if there are none.
    pub(super) fn load(&mut self, on: Side) {
        let loads = self.springs.iter().filter(|load| load.on == on);
        self.items.extend(loads.map(|load| Item::Load(wrench_of(load))).collect::<Vec<_>>());
    }

    /// Adds the springs of a joint's bearing and housing. Their axes stand still in the housing.
    fn bearing(&mut self, index: usize, joint: &JointPiece) {
        let axes = across(&joint.axis).map(|axis| self.rotation * axis);
        let springs = axes.into_iter().zip(joint.lean_rad_per_nm.map(|lean| joint.tilt_rad_per_nm + lean));
        self.tilt((Owner::Piece(index), format!("{}.bearing", joint.name)), springs);
    }

    /// Adds rotational springs about axes through the position that the walk has reached. Each spring is given by an
    /// axis in the world and the compliance about this axis \[rad/(N m)\]. Springs without compliance are left out.
    fn tilt(&mut self, named: (Owner, String), springs: impl IntoIterator<Item = (Vector3<f64>, f64)>) {
        let present = springs.into_iter().filter(|(_, compliance)| *compliance > 0.0);
        let (axes, compliances): (Vec<Vector3<f64>>, Vec<f64>) = present.unzip();
        if axes.is_empty() {
            return;
        }
        self.rotations(named, &axes, Compliance::Linear(compliances));
    }

    /// Adds an elastic element that rotates about `axes`, unit vectors in the world, through the position that the walk
    /// has reached. It has one strain coordinate for each axis.
    fn rotations(&mut self, (owner, name): (Owner, String), axes: &[Vector3<f64>], compliance: Compliance) {
        self.elastic(ElasticElement {
            name,
            owner,
            at_m: self.at_m,
            twists: axes.iter().map(|axis| rotation_twist(axis, &self.at_m)).collect(),
            compliance,
            torque_nm: 0.0,
            own: None,
        });
    }

    /// Adds the element of a base whose feet can lift off. It tilts about the x and y axes of the world. `None` adds
    /// nothing.
    fn lift(&mut self, lift: Option<BaseLift>) {
        let Some(lift) = lift else { return };
        let name = base_lift::KIND.name.into();
        self.rotations((Owner::Base, name), &[Vector3::x(), Vector3::y()], Compliance::Lift(lift));
    }

    /// Adds the springs of a compliant frame at the position that the walk has reached; nothing if the frame is rigid.
    /// The name `base.frame_compliance` is the base's, even if a link is named `base`.
    fn frame(&mut self, owner: Owner, name: &str, frame: &FrameCompliance) {
        let (axes, compliances): (Vec<_>, Vec<_>) = frame.springs().into_iter().unzip();
        if axes.is_empty() {
            return;
        }
        let axes: Vec<Vector3<f64>> = axes.iter().map(|axis| self.rotation * axis).collect();
        let name = match owner {
            Owner::Piece(_) if name == BASE => format!("{BASE}.link.frame_compliance"),
            _ => format!("{name}.frame_compliance"),
        };
        self.rotations((owner, name), &axes, Compliance::Linear(compliances));
    }

    /// Adds rigid bodies. Their centres of gravity are given from the position that the walk has reached, in the
    /// carried frame (it turns with the joints inboard).
    pub(super) fn bodies(&mut self, bodies: &[RigidBody]) {
        for body in bodies {
            let turn = self.rotation.matrix();
            self.items.push(Item::Body(Body {
                mass_kg: body.mass_kg,
                cg_m: self.at_m + turn * body.cg_m,
                inertia_kgm2: turn * body.inertia_kgm2 * turn.transpose(),
                weight_n: body.mass_kg * self.gravity.0,
                down: self.gravity.1,
            }));
        }
    }

    /// Adds a point mass \[kg\] at `cg_m` \[m\], unless the mass is zero.
    pub(super) fn point_mass(&mut self, mass_kg: f64, cg_m: Vector3<f64>) {
        if mass_kg != 0.0 {
            self.items.push(Item::Body(Body {
                mass_kg,
                cg_m,
                inertia_kgm2: Matrix3::zeros(),
                weight_n: mass_kg * self.gravity.0,
                down: self.gravity.1,
            }));
        }
    }
}

/// Force and moment of a spring at its end, as a wrench about the world's origin.
pub(crate) fn wrench_of(load: &EndLoad) -> Wrench {
    force_wrench(&load.force_n, &load.at_m) + stack(&Vector3::zeros(), &load.moment_nm)
}

/// The distributed mass and weight of a link in the world, computed from its mass and weight in its section frame.
/// `root_m` is the root of the link \[m\], `frame` its section frame and `down` the direction of gravity.
fn own_mass(
    piece: usize,
    beam: &PreparedBeam,
    frame: &Matrix3<f64>,
    root_m: &Vector3<f64>,
    down: &Vector3<f64>,
) -> OwnMass {
    // The matrix from a twist about the world's origin to translation and rotation of the root in the section frame.
    let to_local = {
        let mut x = Matrix6::zeros();
        let turn = frame.transpose();
        x.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
        x.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-turn * root_m.cross_matrix()));
        x.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
        x
    };
    let n = beam.compliances.len();
    let local_rigid = beam.inertia.fixed_view::<6, 6>(0, 0);
    let local_coupling = beam.inertia.view((0, 6), (6, n));
    let along = frame.transpose() * (*down * beam.weight_n_per_m);
    let local_down = frame.transpose() * down;
    // The work of a uniform weight is the weight per length times the area under the deflected shape.
    let areas = beam.area_fields.column_iter().map(|f| f.dot(&along));
    let bodies = beam.bodies.fields.column_iter().map(|f| f.dot(&local_down));
    let weight_work = areas.zip(bodies).map(|(tube, bodies)| tube + bodies).collect();
    OwnMass {
        piece,
        root_m: *root_m,
        frame: *frame,
        rigid: to_local.transpose() * local_rigid * to_local,
        coupling: Matrix6xX::from_iterator(n, (to_local.transpose() * local_coupling).iter().copied()),
        inner: beam.inertia.view((6, 6), (n, n)).into_owned(),
        weight: beam.weight(root_m, frame, down),
        weight_work,
    }
}

impl Body {
    /// Inertia matrix of the body about the world's origin.
    pub fn inertia(&self) -> Matrix6<f64> {
        body_inertia(self.mass_kg, &self.cg_m, &self.inertia_kgm2)
    }

    /// Weight of the body as a wrench about the world's origin.
    pub fn weight(&self) -> Wrench {
        force_wrench(&(self.down * self.weight_n), &self.cg_m)
    }
}
