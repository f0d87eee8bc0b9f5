//! An arm as a chain of rigid bodies with hinges between them, at zero joint angles, as simulators and URDF files
//! need it.
//!
//! A driven joint becomes several hinges in series: one that the motor turns, one with the spring of the gear, and two
//! with the springs of the bearing. A prismatic joint becomes a slide that the motor moves, a slide with the spring of
//! the drive, and up to three hinges with the springs of the guide. The hinges of the guide are outboard of the motor's
//! slide if a carriage travels, and inboard of it if a ram travels.
//!
//! A link is rigid, or it is cut into rigid pieces with springs between them. The springs are in the middle of each of
//! `N` equal parts of the link: two hinges for bending, one hinge for twist, and three slides for shear and stretch.
//! The error of the compliance falls with 1/N².

use super::free_name::FreeNames;
use super::snapshot::{Snapshot, Working};
use crate::arm::LinkModel;
use crate::arm::body::RigidBody;
use crate::arm::prismatic::PrismaticPiece;
use crate::arm::structure::{Beam, LinkPiece, Piece};
use crate::mechanics::beam::{line_stiffnesses, tube_inertia};
use crate::mechanics::chain::{Compliance, ElasticElement, Item, OwnMass};
use crate::mechanics::{Twist, angular, body_inertia, linear, stack};
use nalgebra::{Matrix3, Matrix6, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// Radius with which a link without a section is drawn \[m\].
const THIN_M: f64 = 0.02;
/// Rounding error of an inertia about the centre of gravity, relative to that about the world's origin.
const ROUNDING: f64 = 1e-13;
/// Largest number of hinges of one body in MuJoCo.
const MOST_HINGES: usize = 6;

/// The purpose of a hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Role {
    /// A motor turns the hinge.
    Motor,
    /// The hinge of a passive joint follows its driving joints, and has the spring of the joint between them and
    /// itself.
    Follower(Working),
    /// A spring acts on the hinge.
    Spring(Working),
    /// The hinge turns freely, as the backlash of a gear.
    Play {
        /// Half width of the range in which it turns \[rad\].
        half_rad: f64,
        /// The spring of the gear, whose load pushes it to one end of this range.
        gear: Working,
    },
}

/// One axis about which a body rotates relative to the body inboard of it, or along which it slides.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hinge {
    /// Name of the hinge.
    pub name: String,
    /// Name of the elastic element to which the hinge belongs.
    pub element: String,
    /// Direction of the axis in the world at zero joint angles, a unit vector.
    pub axis: Vector3<f64>,
    /// Position in the world at zero joint angles \[m\].
    pub at_m: Vector3<f64>,
    /// Whether the hinge slides along its axis; else it turns about it.
    pub slides: bool,
    /// The purpose of the hinge.
    pub role: Role,
}

/// A rigid body, and the hinges that connect it to the body inboard of it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    /// Name of the body.
    pub name: String,
    /// Origin of the body's frame in the world at zero joint angles \[m\].
    pub origin_m: Vector3<f64>,
    /// Hinges between the body inboard of this body and this body, base to tip. The first body has none.
    pub hinges: Vec<Hinge>,
    /// Inertia matrix about the world's origin at zero joint angles, 6 x 6: mass \[kg\], first moments \[kg m\] and
    /// moments of inertia \[kg m²\].
    pub inertia: Matrix6<f64>,
    /// Rods for drawing: both ends in the world and radius \[m\].
    pub rods: Vec<(Vector3<f64>, Vector3<f64>, f64)>,
}

/// A rigid body, computed from its inertia matrix about the world's origin.
pub(crate) fn mass_properties(inertia: &Matrix6<f64>) -> RigidBody {
    let mass_kg = inertia[(0, 0)];
    if mass_kg == 0.0 {
        let inertia_kgm2 = inertia.fixed_view::<3, 3>(3, 3).into_owned();
        return RigidBody { mass_kg, cg_m: Vector3::zeros(), inertia_kgm2 };
    }
    let cg_m = Vector3::new(inertia[(1, 5)], -inertia[(0, 5)], inertia[(0, 4)]) / mass_kg;
    let cross = cg_m.cross_matrix();
    let about_cg = inertia.fixed_view::<3, 3>(3, 3) + mass_kg * cross * cross;
    let rounding_kgm2 = ROUNDING * inertia.fixed_view::<3, 3>(3, 3).amax();
    let inertia_kgm2 = without_rounding(0.5 * (about_cg + about_cg.transpose()), rounding_kgm2);
    RigidBody { mass_kg, cg_m, inertia_kgm2 }
}

/// An inertia tensor without rounding errors. It was computed as the difference of two larger tensors, so its entries
/// have errors of up to `rounding_kgm2` \[kg m²\]. A tensor without a larger entry becomes zero. A negative principal
/// moment of this size becomes zero, and the other two moments rise by the same amount.
fn without_rounding(tensor: Matrix3<f64>, rounding_kgm2: f64) -> Matrix3<f64> {
    if tensor.amax() <= rounding_kgm2 {
        return Matrix3::zeros();
    }
    let least = tensor.symmetric_eigenvalues().min();
    match least < 0.0 && least >= -rounding_kgm2 {
        true => tensor - Matrix3::identity() * least,
        false => tensor,
    }
}

/// Options of the conversion of an arm to a tree.
#[derive(Debug, Clone, Default)]
pub(crate) struct TreeOptions {
    /// Whether gears, bearings and frames are hinges with springs. If not, they are rigid.
    pub springs: bool,
    /// Number of rigid pieces into which each flexible link is divided; 0 for rigid links.
    pub pieces: usize,
    /// Which deformations the springs between the pieces allow.
    pub links: LinkModel,
    /// Half width of the backlash \[rad\] by name of the joint; joints without backlash are missing.
    pub plays: BTreeMap<String, f64>,
}

/// The rigid bodies of an arm, base to tip.
pub(crate) fn tree(snapshot: &Snapshot, options: &TreeOptions) -> Vec<Node> {
    let pieces = snapshot.structure.pieces.iter();
    let joints =
        pieces.filter(|piece| !matches!(piece, Piece::Link(_))).map(|piece| piece.name().to_string());
    let passive = snapshot.structure.joints().filter(|joint| !joint.is_driven());
    let passive = passive.map(|joint| joint.name.clone()).collect();
    let mut builder = Builder { options, nodes: Vec::new(), passive, free: FreeNames::all_but(joints) };
    builder.open("base", Vector3::zeros());
    let posed = snapshot.at_zero();
    let mut workings = snapshot.working_points().into_iter();
    for item in &posed.items {
        match item {
            Item::Body(body) => builder.last().inertia += body.inertia(),
            // a tree has bodies and hinges only, no loads
            Item::Load(_) => {}
            Item::Elastic(element) => {
                let workings = workings.next().unwrap_or_default();
                match &element.own {
                    Some(own) => builder.link(snapshot.link(own.piece), own),
                    None => builder.springs(element, &workings, snapshot.carriage(&element.name)),
                }
            }
        }
    }
    builder.nodes
}

struct Builder<'o> {
    options: &'o TreeOptions,
    nodes: Vec<Node>,
    /// Names of the passive joints.
    passive: BTreeSet<String>,
    /// Free names for hinges. The hinge of a motor is not among them: it has the name of its joint.
    free: FreeNames,
}

impl Builder<'_> {
    fn open(&mut self, name: &str, origin_m: Vector3<f64>) {
        self.nodes.push(Node {
            name: name.into(),
            origin_m,
            hinges: Vec::new(),
            inertia: Matrix6::zeros(),
            rods: Vec::new(),
        });
    }

    fn last(&mut self) -> &mut Node {
        self.nodes.last_mut().expect("the base is opened first")
    }

    /// Adds the hinges of a joint, of its bearing or guide, or of a frame. If the element is the guide of a carriage,
    /// `carriage` is its prismatic joint.
    fn springs(&mut self, element: &ElasticElement, workings: &[Working], carriage: Option<&PrismaticPiece>) {
        let slides = matches!(element.compliance, Compliance::Slide { .. });
        let is_joint = slides || matches!(element.compliance, Compliance::Joint(_));
        let is_compliant = self.options.springs && workings.iter().any(|working| !working.is_rigid());
        if !is_joint && !is_compliant {
            return;
        }
        // a joint is in one body with its bearing or guide, whose name begins with the joint's
        let of_joint = [".bearing", ".guide"].iter().find_map(|end| element.name.strip_suffix(end));
        let node = of_joint.unwrap_or(&element.name).to_string();
        // the first body is the ground, even if a joint has its name
        let is_first = self.nodes.len() == 1;
        let last = self.last();
        let shares = !is_first && last.name == node && last.inertia == Matrix6::zeros();
        // a body must have room for the further hinges of the same joint: the motor's, and the backlash's if the joint
        // turns
        let more = if slides { 1 } else { 2 };
        if !shares || last.hinges.len() + element.twists.len() > MOST_HINGES - more {
            self.open(&node, element.at_m);
        }
        if let Some(joint) = carriage {
            let travel = stack(&joint.axis, &Vector3::zeros());
            let motor = hinge(&travel, joint.name.clone(), &joint.name, element.at_m, Role::Motor);
            self.last().hinges.push(motor);
        }
        let is_passive = is_joint && self.passive.contains(&element.name);
        let has_motor = self.last().hinges.iter().any(|hinge| hinge.name == element.name);
        if is_joint && !has_motor {
            let name = element.name.clone();
            let role = match (is_passive, workings.first()) {
                (true, Some(spring)) if is_compliant => Role::Follower(*spring),
                (true, _) => Role::Follower(Working::default()),
                (false, _) => Role::Motor,
            };
            let first = hinge(&element.twists[0], name.clone(), &name, element.at_m, role);
            self.last().hinges.push(first);
            if let Some(half_rad) = self.options.plays.get(&name).copied() {
                let name = self.free.take(&format!("{name}.backlash"), "_hinge");
                let role = Role::Play { half_rad, gear: workings.first().copied().unwrap_or_default() };
                let play = hinge(&element.twists[0], name, &element.name, element.at_m, role);
                self.last().hinges.push(play);
            }
        }
        // a passive joint has its spring in its first hinge, so it gets no further hinges
        if !is_compliant || is_passive {
            return;
        }
        // a spring may be rigid about one axis only, such as that of a base whose feet lift off about the other
        let springs = element.twists.iter().zip(workings).enumerate();
        for (i, (twist, working)) in springs.filter(|(_, (_, working))| !working.is_rigid()) {
            let name = match is_joint {
                true if slides => format!("{}.drive", element.name),
                true => format!("{}.gear", element.name),
                false => format!("{}_{}", element.name, i + 1),
            };
            let name = self.free.take(&name, "_hinge");
            let spring = hinge(twist, name, &element.name, element.at_m, Role::Spring(*working));
            self.last().hinges.push(spring);
        }
    }

    /// Adds a link with mass along it, as one rigid body, or as rigid pieces with springs between them if the options
    /// ask for it.
    fn link(&mut self, link: Option<&LinkPiece>, own: &OwnMass) {
        let Some(link) = link else { return };
        let vector_m = own.frame.column(0) * link.vector_m.norm();
        let radius_m = link.beam.map_or(THIN_M, |beam| {
            let (width_m, height_m) = beam.section.outer_m();
            width_m.min(height_m) / 2.0
        });
        match link.beam.filter(|beam| self.options.pieces > 0 && beam.flexibility > 0.0) {
            Some(beam) => self.pieces(link, &beam, own, radius_m),
            None => {
                let node = self.last();
                node.inertia += own.rigid;
                node.rods.push((own.root_m, own.root_m + vector_m, radius_m));
            }
        }
    }

    /// Adds a link as rigid pieces with springs between them. `own` has its root and its section frame; `radius_m` is
    /// the radius with which it is drawn \[m\].
    fn pieces(&mut self, link: &LinkPiece, beam: &Beam, own: &OwnMass, radius_m: f64) {
        let count = self.options.pieces;
        let length_m = link.vector_m.norm();
        let along = own.frame.column(0).into_owned();
        let cut = |k: usize| match k {
            0 => 0.0,
            k if k > count => 1.0,
            k => (k as f64 - 0.5) / count as f64,
        };
        for k in 0..=count {
            let (from, to) = (cut(k), cut(k + 1));
            let place = |xi: f64| own.root_m + along * (xi * length_m);
            if k > 0 {
                self.open(&format!("{}.{k}", link.name), place(from));
                let mut hinges = piece_hinges(link, beam, own, place(from), k, self.options);
                hinges.iter_mut().for_each(|hinge| hinge.name = self.free.take(&hinge.name, "_hinge"));
                self.last().hinges.extend(hinges);
            }
            let model = self.options.links;
            let mut inertia = piece_inertia(link, beam, own, (place(from), place(to)), model);
            for body in &link.bodies {
                // at zero angles the carried frame is parallel to the world's, so no rotation is needed
                let xi = (body.cg_m.dot(&along) / length_m).clamp(0.0, 1.0);
                if xi >= from && (xi < to || k == count) {
                    inertia += body_inertia(body.mass_kg, &(own.root_m + body.cg_m), &body.inertia_kgm2);
                }
            }
            let node = self.last();
            node.inertia += inertia;
            node.rods.push((place(from), place(to), radius_m));
        }
    }
}

/// The hinge that turns about, or slides along, the axis of the motion `twist` (velocity, angular velocity). `element`
/// is the name of the elastic element, and `at_m` the position of the hinge \[m\].
fn hinge(twist: &Twist, name: String, element: &str, at_m: Vector3<f64>, role: Role) -> Hinge {
    let turn = angular(twist);
    let slides = turn == Vector3::zeros();
    let axis = if slides { linear(twist) } else { turn };
    Hinge { name, element: element.into(), axis, at_m, slides, role }
}

/// Inertia matrix, about the world's origin, of the part of a link between the points `from_m` and `to_m` \[m\].
fn piece_inertia(
    link: &LinkPiece,
    beam: &Beam,
    own: &OwnMass,
    (from_m, to_m): (Vector3<f64>, Vector3<f64>),
    model: LinkModel,
) -> Matrix6<f64> {
    let length_m = (to_m - from_m).norm();
    let line = tube_inertia(beam, model);
    let mass_kg = (line.along_kg_per_m + link.harness_kg_per_m) * length_m;
    let rod = mass_kg * length_m * length_m / 12.0;
    let moments = Vector3::new(
        line.polar_kg_m * length_m,
        rod + line.rotary_y_kg_m * length_m,
        rod + line.rotary_z_kg_m * length_m,
    );
    let inertia = own.frame * Matrix3::from_diagonal(&moments) * own.frame.transpose();
    body_inertia(mass_kg, &((from_m + to_m) / 2.0), &inertia)
}

/// The springs between two pieces of a link: slides along the axes of the section, and hinges about them. They are at
/// `at_m` \[m\] and belong to the piece with the index `piece`.
fn piece_hinges(
    link: &LinkPiece,
    beam: &Beam,
    own: &OwnMass,
    at_m: Vector3<f64>,
    piece: usize,
    options: &TreeOptions,
) -> Vec<Hinge> {
    let length_m = link.vector_m.norm() / options.pieces as f64;
    let [bending_y, bending_z, shear, torsion, stretch] = line_stiffnesses(beam);
    let all = [
        ("stretch", 0, true, stretch, LinkModel::Full),
        ("shear_y", 1, true, shear, LinkModel::Full),
        ("shear_z", 2, true, shear, LinkModel::Full),
        ("twist", 0, false, torsion, LinkModel::Full),
        ("bend_y", 1, false, bending_y, LinkModel::Bending),
        ("bend_z", 2, false, bending_z, LinkModel::Bending),
    ];
    let asked = |model: LinkModel| options.links == LinkModel::Full || model == options.links;
    all.into_iter()
        .filter(|(_, _, _, stiffness, model)| stiffness.is_finite() && asked(*model))
        .map(|(word, column, slides, stiffness, _)| Hinge {
            name: format!("{}.{piece}.{word}", link.name),
            element: link.name.clone(),
            axis: own.frame.column(column).into_owned(),
            at_m,
            slides,
            // linear springs without preload
            role: Role::Spring(Working {
                load_nm: 0.0,
                deflection_rad: 0.0,
                tangent_rad_per_nm: beam.flexibility * length_m / stiffness,
            }),
        })
        .collect()
}
