//! The arm put into a pose: elements with their twists, bodies with their inertia, from base to tip.

use super::beam::PreparedBeam;
use super::{Twist, Wrench, body_inertia, force_wrench, rotation_twist, stack};
use crate::arm::LinkModel;
use crate::arm::joint_law::JointLaw;
use crate::arm::linkage::{Linkage, linkages};
use crate::arm::load::Water;
use crate::arm::load::{LoadCase, Payload};
use crate::arm::structure::{FrameCompliance, JointPiece, LinkPiece, Piece, Structure};
use nalgebra::{DMatrix, Matrix3, Matrix6, Matrix6xX, Rotation3, Vector3};

/// An arm prepared for many poses and loads.
#[derive(Debug, Clone)]
pub struct Chain {
    gravity_m_s2: f64,
    base_tilt_rad_per_nm: f64,
    base_frame: FrameCompliance,
    water: Option<Water>,
    pub(super) pieces: Vec<Prepared>,
    linkages: Vec<Linkage>,
}

#[derive(Debug, Clone)]
pub(super) enum Prepared {
    Joint(JointPiece),
    Link(LinkPiece, Option<PreparedBeam>),
}

/// How an element yields to the generalized force on its coordinates.
#[derive(Debug, Clone)]
pub enum Yielding {
    /// Compliance of each coordinate.
    Linear(Vec<f64>),
    /// One coordinate: a joint about its axis.
    Joint(JointLaw),
}

/// One elastic element of an arm in a pose.
#[derive(Debug, Clone)]
pub struct ElasticElement {
    /// Name: of a joint or link, `NAME.bearing_tilt`, `NAME.frame_compliance`, or `base`.
    pub name: String,
    /// Motion of everything outboard per unit of each coordinate.
    pub twists: Vec<Twist>,
    /// Force to deformation.
    pub yielding: Yielding,
    /// The link's own distributed mass, if the element is a link.
    pub own: Option<OwnMass>,
}

/// A link's distributed mass in a pose.
#[derive(Debug, Clone)]
pub struct OwnMass {
    /// Index of the link among the chain's pieces.
    pub piece: usize,
    /// Root of the link, world \[m\].
    pub root_m: Vector3<f64>,
    /// Section frame, world.
    pub frame: Matrix3<f64>,
    /// Rigid inertia about the world origin.
    pub rigid: Matrix6<f64>,
    /// Momentum about the world origin per unit rate of each coordinate.
    pub coupling: Matrix6xX<f64>,
    /// Generalized inertia among the coordinates.
    pub inner: DMatrix<f64>,
    /// Weight as a wrench about the world origin.
    pub weight: Wrench,
    /// Work of the weight per unit of each coordinate.
    pub weight_work: Vec<f64>,
}

/// A rigid body of an arm in a pose.
#[derive(Debug, Clone)]
pub struct Body {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Centre of gravity, world \[m\].
    pub cg_m: Vector3<f64>,
    /// Inertia about the centre of gravity, world axes \[kg m²\].
    pub inertia_kgm2: Matrix3<f64>,
    /// Weight less buoyancy \[N\].
    pub weight_n: f64,
}

/// What stands in the chain, base to tip. A body is moved by every element before it.
#[derive(Debug, Clone)]
pub enum Item {
    /// Something that yields.
    Elastic(ElasticElement),
    /// Something that weighs.
    Body(Body),
}

/// An arm in a pose under a load.
#[derive(Debug, Clone)]
pub struct Posed<'a> {
    /// The arm it was made from.
    pub chain: &'a Chain,
    /// Elements and bodies, base to tip.
    pub items: Vec<Item>,
    /// Where the tip is, world \[m\].
    pub tip_m: Vector3<f64>,
    /// The last frame, world.
    pub tip_rotation: Rotation3<f64>,
    /// Force at the tip, world \[N\].
    pub tip_force_n: Vector3<f64>,
}

impl Chain {
    /// Prepares the arm's pieces with a link model.
    pub fn new(structure: &Structure, links: LinkModel) -> Self {
        let pieces = structure
            .pieces
            .iter()
            .map(|piece| match piece {
                Piece::Joint(joint) => Prepared::Joint(joint.clone()),
                Piece::Link(link) => Prepared::Link(link.clone(), PreparedBeam::new(link, structure, links)),
            })
            .collect();
        Self {
            gravity_m_s2: structure.gravity_m_s2,
            base_tilt_rad_per_nm: structure.base_tilt_rad_per_nm,
            base_frame: structure.base_frame,
            water: structure.water,
            pieces,
            linkages: linkages(structure),
        }
    }

    /// Puts the arm into the pose and load of a case. The pose has one angle per driven joint.
    pub fn pose(&self, case: &LoadCase) -> Posed<'_> {
        let pose_rad: Vec<f64> = case.pose_deg.iter().map(|a| a.to_radians()).collect();
        self.pose_rad(&pose_rad, &case.payload, case.tip_force_n)
    }

    /// Puts the arm into a pose given in radians.
    pub fn pose_rad(&self, pose_rad: &[f64], payload: &Payload, tip_force_n: Vector3<f64>) -> Posed<'_> {
        let mut walk = Walk { items: Vec::new(), at_m: Vector3::zeros(), rotation: Rotation3::identity() };
        if self.base_tilt_rad_per_nm > 0.0 {
            walk.tilt("base".into(), &[Vector3::x(), Vector3::y()], self.base_tilt_rad_per_nm);
        }
        walk.frame("base", &self.base_frame);
        for (index, piece) in self.pieces.iter().enumerate() {
            match piece {
                Prepared::Joint(joint) => walk.joint(joint, joint.angle.of(pose_rad), self.gravity_m_s2),
                Prepared::Link(link, beam) => walk.link(index, link, beam.as_ref(), self.gravity_m_s2),
            }
        }
        walk.items.push(Item::Body(self.payload_body(payload, &walk)));
        Posed { chain: self, items: walk.items, tip_m: walk.at_m, tip_rotation: walk.rotation, tip_force_n }
    }

    /// What turns the passive joints.
    pub fn linkages(&self) -> &[Linkage] {
        &self.linkages
    }

    /// The prepared beam of a piece, for interior fields.
    pub(crate) fn beam(&self, piece: usize) -> Option<&PreparedBeam> {
        match &self.pieces[piece] {
            Prepared::Link(_, beam) => beam.as_ref(),
            Prepared::Joint(_) => None,
        }
    }

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
        }
    }
}

/// The walk from base to tip.
struct Walk {
    items: Vec<Item>,
    at_m: Vector3<f64>,
    rotation: Rotation3<f64>,
}

impl Walk {
    fn joint(&mut self, joint: &JointPiece, angle_rad: f64, gravity_m_s2: f64) {
        self.point_mass(joint.mass_kg, self.at_m, gravity_m_s2);
        let axis = self.rotation * joint.axis;
        if joint.tilt_rad_per_nm > 0.0 {
            let across = across(&axis);
            self.tilt(format!("{}.bearing_tilt", joint.name), &across, joint.tilt_rad_per_nm);
        }
        self.items.push(Item::Elastic(ElasticElement {
            name: joint.name.clone(),
            twists: vec![rotation_twist(&axis, &self.at_m)],
            yielding: Yielding::Joint(joint.law),
            own: None,
        }));
        self.rotation *= Rotation3::from_axis_angle(&joint.axis, angle_rad);
    }

    fn link(&mut self, piece: usize, link: &LinkPiece, beam: Option<&PreparedBeam>, gravity_m_s2: f64) {
        self.frame(&link.name, &link.root_frame);
        let vector = self.rotation * link.vector_m;
        self.point_mass(link.point_mass_kg, self.at_m + vector / 2.0, gravity_m_s2);
        let end_m = self.at_m + vector;
        if let Some(beam) = beam {
            self.items.push(Item::Elastic(self.beam_element(piece, link, beam, &end_m)));
        }
        self.at_m = end_m;
    }

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
            twists,
            yielding: Yielding::Linear(beam.compliances.clone()),
            own: Some(own_mass(piece, beam, &frame, &self.at_m)),
        }
    }

    fn tilt(&mut self, name: String, axes: &[Vector3<f64>; 2], compliance: f64) {
        self.items.push(Item::Elastic(ElasticElement {
            name,
            twists: axes.iter().map(|axis| rotation_twist(axis, &self.at_m)).collect(),
            yielding: Yielding::Linear(vec![compliance; 2]),
            own: None,
        }));
    }

    fn frame(&mut self, name: &str, frame: &FrameCompliance) {
        let (axes, compliances): (Vec<_>, Vec<_>) = frame.springs().into_iter().unzip();
        if axes.is_empty() {
            return;
        }
        let turn = |axis: &Vector3<f64>| rotation_twist(&(self.rotation * axis), &self.at_m);
        self.items.push(Item::Elastic(ElasticElement {
            name: format!("{name}.frame_compliance"),
            twists: axes.iter().map(turn).collect(),
            yielding: Yielding::Linear(compliances),
            own: None,
        }));
    }

    fn point_mass(&mut self, mass_kg: f64, cg_m: Vector3<f64>, gravity_m_s2: f64) {
        if mass_kg != 0.0 {
            self.items.push(Item::Body(Body {
                mass_kg,
                cg_m,
                inertia_kgm2: Matrix3::zeros(),
                weight_n: mass_kg * gravity_m_s2,
            }));
        }
    }
}

/// Two unit axes across `axis` and each other.
pub(crate) fn across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let least = axis.iamin();
    let first = axis.cross(&Vector3::ith(least, 1.0)).normalize();
    [first, axis.cross(&first)]
}

/// Carries a link's inertia and weight from its section frame to the world.
fn own_mass(piece: usize, beam: &PreparedBeam, frame: &Matrix3<f64>, root_m: &Vector3<f64>) -> OwnMass {
    // twist about the world origin -> translation and rotation of the root in the section frame
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
    let down = Vector3::new(0.0, 0.0, -beam.weight_n_per_m);
    let centre = root_m + frame.column(0) * (beam.length_m / 2.0);
    let local_down = frame.transpose() * down;
    let weight_work = beam.area_fields.column_iter().map(|f| f.fixed_rows::<3>(0).dot(&local_down)).collect();
    OwnMass {
        piece,
        root_m: *root_m,
        frame: *frame,
        rigid: to_local.transpose() * local_rigid * to_local,
        coupling: Matrix6xX::from_iterator(n, (to_local.transpose() * local_coupling).iter().copied()),
        inner: beam.inertia.view((6, 6), (n, n)).into_owned(),
        weight: force_wrench(&(down * beam.length_m), &centre),
        weight_work,
    }
}

impl Body {
    /// Inertia about the world origin.
    pub fn inertia(&self) -> Matrix6<f64> {
        body_inertia(self.mass_kg, &self.cg_m, &self.inertia_kgm2)
    }

    /// Weight as a wrench about the world origin.
    pub fn weight(&self) -> Wrench {
        force_wrench(&Vector3::new(0.0, 0.0, -self.weight_n), &self.cg_m)
    }
}
