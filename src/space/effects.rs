//! The arm of a study and its effects, as *layers*: what the search adds to the arm, step by step from the tip inward.
//!
//! An effect may change the joint law of a joint (its angle as a function of torque) or the tube of a link. It may also
//! add an element to the chain: a spring that tilts, or a mass. The code that applies an effect to an arm file applies
//! it here too, so that the search, `analyze` and `reconcile` compute the same thing. The code that evaluates designs
//! knows only these elements, and nothing of effects.

use super::design_space::{DesignSpace, MotorPlace, SpaceJoint, SpacePiece};
use super::prismatic::SpacePrismatic;
use crate::arm::bearing::Bearing;
use crate::arm::body::{JointBodies, RigidBody, total_kg};
use crate::arm::effect::subject::Subject;
use crate::arm::joint_law::{Curve, JointLaw};
use crate::arm::joint_torque::JointTorque;
use crate::arm::prismatic::{Moves, PrismaticPiece};
use crate::arm::springs::{Side, SpringKind, SpringPlace};
use crate::arm::structure::{JointAngle, JointPiece, LinkPiece, Piece, Structure, link_piece};
use crate::arm::{Link, LinkBody};
use crate::mechanics::across;
use crate::mechanics::beam::section_frame;
use nalgebra::{Rotation3, Vector3};

/// A layer: one element that the search adds to an arm in one step. Each layer becomes one slot of the arm
/// ([`slot`](super::slot)).
#[derive(Debug, Clone, Copy)]
pub(crate) enum Layer<'s> {
    /// A rotary joint, link or prismatic joint of the chain.
    Piece(&'s SpacePiece),
    /// A spring that lets a joint tilt about an axis at right angles to the joint's axis.
    Tilt(Tilt<'s>),
    /// A rotational spring of the guide (rail and runner blocks) of a prismatic joint.
    Guide(GuideSpring<'s>),
    /// A spring of the output bearing that comes with the gear chosen for a joint.
    Bearing(BearingSpring<'s>),
    /// The motor of a sized drive, at the place where it stands instead of at its joint.
    Motor(MotorElsewhere),
    /// A point mass \[kg\] that an effect adds at a joint. It has weight and inertia, but does not count in the mass of
    /// the design.
    Mass(f64),
    /// A point mass \[kg\] that an effect adds at the moving point of a prismatic joint. It has weight and inertia, but
    /// does not count in the mass of the design.
    Travelling(f64),
    /// A point mass \[kg\] at a joint that counts in the mass of the design, such as a separate output bearing.
    Extra(f64),
    /// Rigid bodies of a piece. They count in the mass of the design.
    Bodies(Carried<'s>),
    /// Forces and moments of the springs that balance the arm, on one side of a joint or on a link.
    Springs(Side),
}

/// The motor of a sized drive that does not stand at its joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotorElsewhere {
    /// Number of the piece that is the motor's joint.
    pub of: usize,
    pub place: MotorPlace,
    /// Whether the motor stands at the end of the piece `place.piece` and not at its beginning. This is so if this
    /// piece is a joint and the motor moves with it.
    is_at_end: bool,
}

/// Rigid bodies of a piece.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried<'s> {
    /// The rigid bodies.
    pub bodies: &'s [RigidBody],
    /// The frame or tube to which the bodies are attached.
    pub by: Carrier,
}

/// The frame or tube to which the bodies of a piece are attached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Carrier {
    /// The frame in which the piece begins, inboard of any rotation of the piece itself.
    Frame,
    /// The frame after the rotation or travel of the joint.
    RotatedFrame,
    /// The axis of a tube. The weight of the bodies bends the tube, but their mass moves with the root of the tube.
    Tube,
}

impl Carried<'_> {
    /// Mass of the bodies \[kg\].
    pub(crate) fn mass_kg(&self) -> f64 {
        total_kg(self.bodies)
    }
}

/// The layer of the bodies `bodies`, which are attached to `by`. `None` if there are none.
fn carried(bodies: &[RigidBody], by: Carrier) -> Option<Layer<'_>> {
    (!bodies.is_empty()).then_some(Layer::Bodies(Carried { bodies, by }))
}

/// The axis about which a rotational spring turns.
#[derive(Debug, Clone, Copy)]
enum About<'s> {
    /// One of the two axes at right angles to the axis of a joint; the number (0 or 1) says which.
    Across(&'s SpaceJoint, usize),
    /// An axis in the frame to which the spring is attached.
    Fixed(Vector3<f64>),
    /// An axis in the world.
    World(Vector3<f64>),
}

/// A rotational spring: of a bearing that tilts, of a compliant frame at the root of a link, or of the base.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tilt<'s> {
    about: About<'s>,
    /// Angle of the spring \[rad\] as a function of the moment \[N m\].
    law: JointLaw,
}

/// One of the two springs of the output bearing of a joint whose gear is chosen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BearingSpring<'s> {
    /// The joint to which the bearing belongs.
    pub joint: &'s SpaceJoint,
    /// Number of the axis about which the spring turns: 0 or 1 for the two axes at right angles to the joint's axis.
    which: usize,
}

/// A rotational spring of the guide of a prismatic joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GuideSpring<'s> {
    /// The prismatic joint.
    slide: &'s SpacePrismatic,
    /// Axis of the spring: 0 along the travel, 1 and 2 at right angles to it.
    which: usize,
    /// Compliance of the spring \[rad/(N m)\].
    rad_per_nm: f64,
}

impl GuideSpring<'_> {
    /// Axis of the spring in the world. `rotation` is the attitude of the frame in which the joint begins.
    pub(crate) fn axis(&self, rotation: &Rotation3<f64>) -> Vector3<f64> {
        rotation * section_frame(&self.slide.joint.axis).column(self.which)
    }

    /// Angle of the spring \[rad\] as a function of the moment \[N m\].
    pub(crate) fn law(&self) -> JointLaw {
        linear_law(self.rad_per_nm)
    }
}

/// The joint law of a linear spring with this compliance (rad/(N m), or m/N for a prismatic joint).
fn linear_law(compliance: f64) -> JointLaw {
    JointLaw { connection_rad_per_nm: compliance, ..JointLaw::from(Curve::Rigid) }
}

impl<'s> Layer<'s> {
    /// Whether the layer is placed at the end of its piece rather than at its beginning.
    pub(crate) fn is_at_end(&self) -> bool {
        let is_carriage = |slide: &SpacePrismatic| slide.joint.moves == Moves::Carriage;
        match self {
            Layer::Bodies(Carried { by: Carrier::RotatedFrame, .. }) | Layer::Travelling(_) => true,
            Layer::Motor(motor) => motor.is_at_end,
            Layer::Guide(spring) => is_carriage(spring.slide),
            Layer::Piece(SpacePiece::Prismatic(slide)) => is_carriage(slide),
            _ => false,
        }
    }

    /// The joint of which this layer is a spring of the stated bearing; `None` for every other layer.
    pub(crate) fn bearing_of(&self) -> Option<&'s SpaceJoint> {
        match self {
            Layer::Tilt(Tilt { about: About::Across(joint, _), .. }) => Some(joint),
            _ => None,
        }
    }
}

impl BearingSpring<'_> {
    /// Axis of the spring in the world. `rotation` is the attitude of the frame in which the joint begins.
    pub(crate) fn axis(&self, rotation: &Rotation3<f64>) -> Vector3<f64> {
        across(&(rotation * self.joint.axis))[self.which]
    }
}

impl Tilt<'_> {
    /// Axis of the spring in the world. `rotation` is the attitude of the frame to which the spring is attached.
    pub(crate) fn axis(&self, rotation: &Rotation3<f64>) -> Vector3<f64> {
        match self.about {
            About::Across(joint, which) => across(&(rotation * joint.axis))[which],
            About::Fixed(axis) => rotation * axis,
            About::World(axis) => axis,
        }
    }

    /// A linear spring that turns about the axis `about` with the compliance `rad_per_nm` \[rad/(N m)\].
    fn linear(about: About<'_>, rad_per_nm: f64) -> Tilt<'_> {
        Tilt { about, law: JointLaw { connection_rad_per_nm: rad_per_nm, ..JointLaw::from(Curve::Rigid) } }
    }

    /// Angle of the spring \[rad\] as a function of the moment \[N m\].
    pub(crate) fn law(&self) -> JointLaw {
        self.law
    }
}

/// Where a motor stands on a piece.
#[derive(Clone, Copy, PartialEq)]
enum Stands {
    /// The motor moves with the piece.
    MovingWith,
    /// The motor stands where the piece begins, and does not move with it.
    AtStartOf,
}

impl DesignSpace {
    /// All layers that the search adds, tip first, each with the number of its piece (base to tip).
    ///
    /// All three springs of a joint (the torsion of its drive and two tilts of its bearing) turn about the same point,
    /// so their order does not change the mechanics. If the bearing of a joint is stated, its springs are added before
    /// the torsion of the joint. They are then computed once and not once for each drive. If the bearing comes with the
    /// gear, its springs are added after the gear is chosen.
    pub(crate) fn layers(&self) -> Vec<(usize, Layer<'_>)> {
        let mut out = Vec::with_capacity(self.pieces.len());
        for (index, piece) in self.pieces.iter().enumerate().rev() {
            match piece {
                SpacePiece::Joint(joint) => self.add_joint(index, piece, joint, &mut out),
                SpacePiece::Prismatic(slide) => self.add_prismatic(index, piece, slide, &mut out),
                SpacePiece::Link(link) => {
                    let is_tube = matches!(link.body, LinkBody::Tube { .. });
                    let by = if is_tube { Carrier::Tube } else { Carrier::Frame };
                    self.add_link(index, piece, link, carried(&link.bodies, by), &mut out);
                }
                SpacePiece::Choice(choice) => {
                    let bodies = carried(&choice.bodies, Carrier::Tube);
                    self.add_link(index, piece, &choice.first_link(), bodies, &mut out);
                }
            }
        }
        self.add_base(&mut out);
        out
    }

    /// Adds the layers of a link or of a choice of links, tip first: the link, its bodies, the springs that pull on it,
    /// the motors on it and the springs at its root. `link` is the link or the first option.
    fn add_link<'s>(
        &'s self,
        index: usize,
        piece: &'s SpacePiece,
        link: &Link,
        bodies: Option<Layer<'s>>,
        out: &mut Vec<(usize, Layer<'s>)>,
    ) {
        out.push((index, Layer::Piece(piece)));
        out.extend(bodies.map(|bodies| (index, bodies)));
        out.extend(self.pulled(index, Side::Moving(index)));
        out.extend(self.motors_on(index, Stands::MovingWith));
        out.extend(self.motors_on(index, Stands::AtStartOf));
        out.extend(self.root_springs(link).map(|tilt| (index, tilt)));
    }

    /// Adds the layers of a joint, tip first: first what turns with the joint, then its drive and its bearing, then
    /// what does not turn with it.
    fn add_joint<'s>(
        &'s self,
        index: usize,
        piece: &'s SpacePiece,
        joint: &'s SpaceJoint,
        out: &mut Vec<(usize, Layer<'s>)>,
    ) {
        out.extend(carried(&joint.bodies.rotating, Carrier::RotatedFrame).map(|bodies| (index, bodies)));
        out.extend(self.pulled(index, Side::Moving(index)));
        out.extend(self.motors_on(index, Stands::MovingWith));
        let bearing = joint.bearing.stated();
        let affected = self.joint_piece(joint, Curve::Rigid, bearing);
        out.extend(leans(&affected).map(|lean| (index, lean)));
        if joint.bearing_is_open() {
            out.push((index, Layer::Piece(piece)));
            out.extend([0, 1].map(|which| (index, Layer::Bearing(BearingSpring { joint, which }))));
        } else {
            let across = [About::Across(joint, 0), About::Across(joint, 1)];
            out.extend(tilts(across, affected.tilt_rad_per_nm).map(|tilt| (index, tilt)));
            out.push((index, Layer::Piece(piece)));
        }
        if let Some(mass_kg) = bearing.map(|b| b.mass_kg).filter(|mass_kg| *mass_kg > 0.0) {
            out.push((index, Layer::Extra(mass_kg)));
        }
        if affected.mass_kg != 0.0 {
            out.push((index, Layer::Mass(affected.mass_kg)));
        }
        out.extend(carried(&joint.bodies.fixed, Carrier::Frame).map(|bodies| (index, bodies)));
        out.extend(self.pulled(index, Side::Fixed(index)));
        out.extend(self.motors_on(index, Stands::AtStartOf));
    }

    /// Adds the layers of the base: the springs that balance the arm, the springs of a compliant frame, and the tilts
    /// of a base that can lift off or is compliant.
    fn add_base<'s>(&'s self, out: &mut Vec<(usize, Layer<'s>)>) {
        out.extend(self.pulled(0, Side::Base));
        let base = self.surroundings();
        let fixed = base.base_frame.springs().into_iter();
        out.extend(fixed.map(|(axis, c)| (0, Layer::Tilt(Tilt::linear(About::World(axis), c)))));
        let level = [About::World(Vector3::x()), About::World(Vector3::y())];
        out.extend(base.base_lift.iter().flat_map(|lift| {
            let law = JointLaw::from(Curve::Windup(lift.as_windup()));
            level.map(|about| (0, Layer::Tilt(Tilt { about, law })))
        }));
        out.extend(tilts(level, base.base_tilt_rad_per_nm).map(|tilt| (0, tilt)));
    }

    /// Adds the layers of a prismatic joint, tip first: the bodies that travel, the drive and the guide, and the
    /// bodies that stay in place.
    fn add_prismatic<'s>(
        &'s self,
        index: usize,
        piece: &'s SpacePiece,
        slide: &'s SpacePrismatic,
        out: &mut Vec<(usize, Layer<'s>)>,
    ) {
        let affected = self.prismatic_piece(slide);
        out.extend(carried(&slide.travelling, Carrier::RotatedFrame).map(|bodies| (index, bodies)));
        let added_kg = affected.mass_kg - slide.joint.mass_kg;
        if added_kg != 0.0 {
            out.push((index, Layer::Travelling(added_kg)));
        }
        out.extend(self.pulled(index, Side::Moving(index)));
        out.extend(self.motors_on(index, Stands::MovingWith));
        out.push((index, Layer::Piece(piece)));
        let springs = affected.guide_rad_per_nm.iter().enumerate().filter(|(_, c)| **c > 0.0);
        out.extend(
            springs.map(|(which, c)| (index, Layer::Guide(GuideSpring { slide, which, rad_per_nm: *c }))),
        );
        out.extend(carried(&slide.staying, Carrier::Frame).map(|bodies| (index, bodies)));
        out.extend(self.motors_on(index, Stands::AtStartOf));
    }

    /// A prismatic joint, changed by the effects that act on it.
    fn prismatic_piece(&self, slide: &SpacePrismatic) -> PrismaticPiece {
        let nominal = slide.joint.piece(0);
        match self.affected(Piece::Prismatic(nominal.clone())) {
            Some(Piece::Prismatic(affected)) => affected,
            _ => nominal,
        }
    }

    /// The linear law by which a prismatic joint deflects elastically along its travel: the displacement \[m\] as a
    /// function of the force \[N\]. Effects on the joint are included.
    pub(crate) fn slide_law(&self, slide: &SpacePrismatic) -> JointLaw {
        linear_law(self.prismatic_piece(slide).m_per_n)
    }

    /// The points of the link at `piece` at which springs pull, from 0 (root) to 1 (end), in the order in which the
    /// springs load it. Empty for a joint.
    pub(crate) fn pulled_at(&self, piece: usize) -> Vec<f64> {
        let vector_m = match &self.pieces[piece] {
            SpacePiece::Link(link) => link.vector_m,
            SpacePiece::Choice(choice) => choice.vector_m,
            SpacePiece::Joint(_) | SpacePiece::Prismatic(_) => return Vec::new(),
        };
        let ends = self.springs.iter().flat_map(|spring| match &spring.kind {
            SpringKind::Line { ends, .. } => ends.to_vec(),
            SpringKind::Torsion { .. } => Vec::new(),
        });
        let here = ends.filter(|end| end.on == SpringPlace::Element(piece));
        here.map(|end| along(&vector_m, &end.point_m)).collect()
    }

    /// The layer with the forces of the springs that act on `on`: one side of a joint, a link or the base. The layer
    /// belongs to the piece with the number `piece`. `None` if no spring acts there.
    fn pulled(&self, piece: usize, on: Side) -> Option<(usize, Layer<'_>)> {
        let is_pulled = self.springs.iter().any(|spring| spring.sides().contains(&on));
        is_pulled.then_some((piece, Layer::Springs(on)))
    }

    /// The layers of the motors that stand on the piece with the number `piece`, on the side that `stands` gives. The
    /// layer of the motor of a sized prismatic joint includes its screw or rack.
    fn motors_on(&self, piece: usize, stands: Stands) -> impl Iterator<Item = (usize, Layer<'_>)> {
        let is_joint = !matches!(self.pieces[piece], SpacePiece::Link(_) | SpacePiece::Choice(_));
        let moves = stands == Stands::MovingWith;
        self.pieces.iter().enumerate().filter_map(move |(of, what)| {
            let place = what.motor_place(of).filter(|place| place.piece == piece && place.moves == moves)?;
            Some((piece, Layer::Motor(MotorElsewhere { of, place, is_at_end: is_joint && moves })))
        })
    }

    /// The springs of the frame to which the root of a link is attached; none if no effect makes this frame compliant.
    fn root_springs(&self, link: &Link) -> impl Iterator<Item = Layer<'_>> + use<'_> {
        let springs = self.link_piece(link).root_frame.springs().into_iter();
        springs.map(|(axis, c)| Layer::Tilt(Tilt::linear(About::Fixed(axis), c)))
    }

    /// The joint with the torsion curve `curve` and the output bearing `bearing`. The joint model of the study and the
    /// effects at the joint are applied. The mass of the returned piece is only the mass that the effects add \[kg\].
    pub(crate) fn joint_piece(
        &self,
        joint: &SpaceJoint,
        curve: Curve,
        bearing: Option<Bearing>,
    ) -> JointPiece {
        let mut nominal = nominal_joint(joint, self.curve(curve));
        nominal.tilt_rad_per_nm = bearing.map_or(0.0, |bearing| bearing.tilt_rad_per_nm());
        let mut affected = match self.affected(Piece::Joint(nominal.clone())) {
            Some(Piece::Joint(joint)) => joint,
            _ => nominal,
        };
        // An effect may replace the torsion curve, so the joint model is applied to the new curve too.
        affected.law.curve = affected.law.curve.reduced(self.joints);
        affected
    }

    /// A link, changed by the effects that act on it.
    pub(crate) fn link_piece(&self, link: &Link) -> LinkPiece {
        let nominal = link_piece(link);
        match self.affected(Piece::Link(nominal.clone())) {
            Some(Piece::Link(link)) => link,
            _ => nominal,
        }
    }

    /// Gravity, base and water around the arm, as a structure without pieces. Effects that act on them are included.
    pub(crate) fn surroundings(&self) -> Structure {
        self.with_effects(Vec::new())
    }

    /// The torque that effects exert on a joint in addition to weight and load, as a function of the joint's angle.
    pub(crate) fn joint_torque(&self, joint: &SpaceJoint) -> JointTorque {
        self.joint_piece(joint, Curve::Rigid, None).torque
    }

    /// Mass that the effects add to the joints and links of the arm \[kg\]. It is the same for every design.
    pub fn effects_mass_kg(&self) -> f64 {
        self.nominal_structure()
            .pieces
            .into_iter()
            .filter_map(|piece| self.affected(piece))
            .map(|piece| match piece {
                Piece::Joint(joint) => joint.mass_kg,
                Piece::Prismatic(joint) => joint.mass_kg,
                Piece::Link(link) => link.harness_kg_per_m * link.vector_m.norm(),
            })
            .sum()
    }

    /// All pieces of the arm without any effect, to check at which pieces an effect can act. Joints are rigid and
    /// have no mass. Links that are chosen have their first option.
    pub fn nominal_structure(&self) -> Structure {
        let piece = |piece: &SpacePiece| match piece {
            SpacePiece::Joint(joint) => Piece::Joint(nominal_joint(joint, Curve::Rigid)),
            SpacePiece::Prismatic(slide) => Piece::Prismatic(PrismaticPiece {
                mass_kg: 0.0,
                fixed_mass_kg: 0.0,
                bodies: JointBodies::default(),
                ..slide.joint.piece(0)
            }),
            SpacePiece::Link(link) => Piece::Link(link_piece(link)),
            SpacePiece::Choice(choice) => Piece::Link(link_piece(&choice.first_link())),
        };
        self.structure_of(self.pieces.iter().map(piece).collect())
    }

    /// A structure of these pieces under the gravity of the study, without any effect.
    pub(crate) fn structure_of(&self, pieces: Vec<Piece>) -> Structure {
        Structure { down: self.down, ..Structure::nominal(self.gravity_m_s2, pieces) }
    }

    fn affected(&self, piece: Piece) -> Option<Piece> {
        self.with_effects(vec![piece]).pieces.pop()
    }

    fn with_effects(&self, pieces: Vec<Piece>) -> Structure {
        let mut subject = Subject::new(self.structure_of(pieces));
        self.effects.iter().filter(|effect| !effect.is_of_test()).for_each(|effect| subject.apply(effect));
        subject.structure
    }
}

fn nominal_joint(joint: &SpaceJoint, curve: Curve) -> JointPiece {
    JointPiece {
        name: joint.name.clone(),
        axis: joint.axis,
        law: JointLaw::from(curve),
        torque: JointTorque::default(),
        tilt_rad_per_nm: 0.0,
        lean_rad_per_nm: [0.0; 2],
        mass_kg: 0.0,
        bodies: JointBodies::default(),
        angle: JointAngle::Driven(0),
        turns_with: Vec::new(),
    }
}

/// The springs of a joint's housing that tilts about axes of its own; none if the housing is rigid.
fn leans<'s>(joint: &JointPiece) -> impl Iterator<Item = Layer<'s>> + use<'s> {
    let springs = across(&joint.axis).into_iter().zip(joint.lean_rad_per_nm).filter(|(_, c)| *c > 0.0);
    springs.map(|(axis, c)| Layer::Tilt(Tilt::linear(About::Fixed(axis), c)))
}

/// The two springs of a bearing or base that tilts about the axes `axes`, each with the compliance `rad_per_nm`; none
/// if the compliance is 0.
fn tilts(axes: [About<'_>; 2], rad_per_nm: f64) -> impl Iterator<Item = Layer<'_>> {
    let present = axes.into_iter().filter(move |_| rad_per_nm > 0.0);
    present.map(move |about| Layer::Tilt(Tilt::linear(about, rad_per_nm)))
}

/// The point of a link's axis that is nearest to a point of the link's frame, from 0 (root) to 1 (end).
pub(crate) fn along(vector_m: &Vector3<f64>, point_m: &Vector3<f64>) -> f64 {
    (vector_m.dot(point_m) / vector_m.norm_squared()).clamp(0.0, 1.0)
}
