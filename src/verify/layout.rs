//! Where joints, tubes and masses are in a pose, and how each coordinate moves a point.
//!
//! The coordinates of a joint are its angle of torsion and its tilts about two axes at right angles to its axis.
//! Springs of effects and of prismatic joints are coordinates too. The coordinates of a tube are constant and linear
//! curvature in both planes, and constant shear, torsion and stretch. The full model has all of these, and more. A
//! model with fewer ways to deform is stiffer, so its lowest mode is at least as high as the lowest mode of the full
//! model.

use crate::arm::LinkModel;
use crate::arm::body::RigidBody;
use crate::arm::load::LoadCase;
use crate::arm::prismatic::{Moves, PrismaticPiece};
use crate::arm::structure::{LinkPiece, Piece, Structure};
use crate::mechanics::across;
use crate::mechanics::beam::section_frame;
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Rank of the springs on which the arm stands. No piece has a lower rank.
const BASE_RANK: usize = 0;

/// Rank of the springs of a piece, and of masses inboard of these springs. Ranks order all elements from base to tip.
fn spring_rank(piece: usize) -> usize {
    3 * piece + 1
}

/// Rank of a piece itself. It is higher than the rank of the piece's springs, which are inboard of it.
fn piece_rank(piece: usize) -> usize {
    3 * piece + 2
}

/// A joint in a pose.
pub(super) struct PlacedJoint {
    /// Place in the order of all elements from base to tip.
    pub rank: usize,
    pub at_m: Vector3<f64>,
    pub axis: Vector3<f64>,
    /// The two axes about which the bearing of the joint tilts.
    pub across: [Vector3<f64>; 2],
}

/// A prismatic joint (rail) in a pose. Its travel moves everything of a higher rank along `axis`.
pub(super) struct PlacedRail {
    /// Place in the order of all elements from base to tip.
    pub rank: usize,
    pub axis: Vector3<f64>,
}

/// A tube in a pose. The columns of `frame` are the axis of the tube and the y and z axes of its section, in the world.
pub(super) struct PlacedTube {
    /// Place in the order of all elements from base to tip.
    pub rank: usize,
    pub root_m: Vector3<f64>,
    pub frame: Matrix3<f64>,
    pub length_m: f64,
}

/// A rigid mass that is the same in all designs.
pub(super) struct PlacedMass {
    /// The point of the arm with which the mass moves.
    pub carrier: Point,
    /// Vector from the point `carrier` to the centre of mass \[m\].
    pub arm_m: Vector3<f64>,
    pub mass_kg: f64,
    /// Inertia about the centre of mass, in the axes of the world \[kg m²\].
    pub inertia_kgm2: Matrix3<f64>,
}

impl PlacedMass {
    fn new(body: &RigidBody, rotation: &Matrix3<f64>, carrier: Point, arm_m: Vector3<f64>) -> Self {
        let inertia_kgm2 = rotation * body.inertia_kgm2 * rotation.transpose();
        Self { carrier, arm_m, mass_kg: body.mass_kg, inertia_kgm2 }
    }

    /// Position of the centre of mass in the world \[m\].
    pub(super) fn centre_m(&self) -> Vector3<f64> {
        self.carrier.at_m + self.arm_m
    }

    /// Whether the mass loads the section of the arm at `point`. At the root of a tube all bodies of the tube load the
    /// section, at its end none does.
    pub(super) fn is_outboard_of(&self, point: &Point) -> bool {
        match (self.carrier.rank.cmp(&point.rank), self.carrier.inside_m, point.inside_m) {
            (std::cmp::Ordering::Equal, Some(mass_m), Some(x)) => mass_m > x || x == 0.0,
            (order, _, _) => order.is_gt(),
        }
    }
}

/// A spring that is the same in all designs: of an effect, or of a prismatic joint. It tilts everything outboard of
/// it about an axis or, with `slides`, moves it along the axis.
pub(super) struct PlacedSpring {
    pub rank: usize,
    pub at_m: Vector3<f64>,
    pub axis: Vector3<f64>,
    pub slides: bool,
    /// Tilt per moment \[rad/(N m)\], or displacement per force \[m/N\] if the spring slides.
    pub compliance: f64,
}

impl PlacedSpring {
    /// Motion of the point `at_m`, which is outboard of the spring, per unit of the spring's coordinate.
    pub(super) fn way(&self, at_m: &Vector3<f64>) -> Motion {
        match self.slides {
            true => Motion::along(self.axis),
            false => Motion { moved: self.axis.cross(&(at_m - self.at_m)), turned: self.axis },
        }
    }
}

/// Displacement and rotation of a point, per unit of a coordinate.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Motion {
    pub moved: Vector3<f64>,
    pub turned: Vector3<f64>,
}

impl Motion {
    /// A displacement without rotation.
    fn along(moved: Vector3<f64>) -> Self {
        Self { moved, turned: Vector3::zeros() }
    }
}

/// The geometry of an arm in a pose. All lists are ordered from base to tip.
pub(super) struct Layout {
    pub joints: Vec<PlacedJoint>,
    pub rails: Vec<PlacedRail>,
    pub tubes: Vec<PlacedTube>,
    pub masses: Vec<PlacedMass>,
    pub springs: Vec<PlacedSpring>,
    pub tip_m: Vector3<f64>,
    pub tip_rotation: Matrix3<f64>,
}

impl Layout {
    /// Puts an arm into the pose of a case.
    pub(super) fn new(structure: &Structure, case: &LoadCase) -> Self {
        let mut entries = case.pose_deg.iter();
        let mut rotation = Rotation3::identity();
        let mut layout = Self {
            joints: Vec::new(),
            rails: Vec::new(),
            tubes: Vec::new(),
            masses: Vec::new(),
            springs: Vec::new(),
            tip_m: Vector3::zeros(),
            tip_rotation: Matrix3::identity(),
        };
        for (place, piece) in structure.pieces.iter().enumerate() {
            match piece {
                Piece::Joint(joint) => {
                    let axis = rotation * joint.axis.into_inner();
                    layout.add_mass(piece_rank(place), layout.tip_m, joint.mass_kg);
                    layout.add_bodies(piece_rank(place), &joint.bodies.fixed, &rotation);
                    let (rank, at_m) = (piece_rank(place), layout.tip_m);
                    layout.joints.push(PlacedJoint { rank, at_m, axis, across: across(&axis) });
                    let angle = entries.next().copied().unwrap_or_default().to_radians();
                    rotation *= Rotation3::from_axis_angle(&joint.axis, angle);
                    // These bodies are outboard of the joint, and inboard of the next piece.
                    layout.add_bodies(piece_rank(place) + 1, &joint.bodies.rotating, &rotation);
                }
                Piece::Prismatic(joint) => {
                    let travel_m = entries.next().copied().unwrap_or_default() / 1e3;
                    layout.add_prismatic(place, joint, travel_m, &rotation);
                }
                Piece::Link(link) => layout.add_link(place, link, &rotation),
            }
            if place == 0 {
                layout.add_base(structure);
            }
        }
        layout.tip_rotation = *rotation.matrix();
        layout
    }

    /// Adds the springs on which the arm stands, such as the springs of a base that tilts. They are inboard of the
    /// first piece, although the list has them after the springs of that piece.
    fn add_base(&mut self, structure: &Structure) {
        let fixed = structure.base_frame.springs();
        let level = [Vector3::x(), Vector3::y()].map(|axis| (axis, structure.base_tilt_rad_per_nm));
        for (axis, rad_per_nm) in fixed.into_iter().chain(level) {
            if rad_per_nm > 0.0 {
                let at_m = Vector3::zeros();
                let (rank, compliance) = (BASE_RANK, rad_per_nm);
                self.springs.push(PlacedSpring { rank, at_m, axis, slides: false, compliance });
            }
        }
    }

    /// Adds the prismatic joint `joint`, the piece with the number `place`, at its travel `travel_m`: the fixed mass
    /// with the springs of guide and drive, then the moving mass.
    fn add_prismatic(
        &mut self,
        place: usize,
        joint: &PrismaticPiece,
        travel_m: f64,
        rotation: &Rotation3<f64>,
    ) {
        let still = spring_rank(place);
        self.add_mass(still, self.tip_m, joint.fixed_mass_kg);
        self.add_bodies(still, &joint.bodies.fixed, rotation);
        let frame = rotation.matrix() * section_frame(&joint.axis);
        self.rails.push(PlacedRail { rank: still, axis: frame.column(0).into_owned() });
        let moved_m = self.tip_m + frame.column(0) * travel_m;
        let at_m = if joint.moves == Moves::Carriage { moved_m } else { self.tip_m };
        let guide = frame.column_iter().zip(joint.guide_rad_per_nm.iter().copied());
        let springs = guide.map(|(axis, c)| (axis.into_owned(), false, c));
        let drive = (frame.column(0).into_owned(), true, joint.m_per_n);
        for (axis, slides, compliance) in springs.chain([drive]).filter(|(_, _, c)| *c > 0.0) {
            self.springs.push(PlacedSpring { rank: still, at_m, axis, slides, compliance });
        }
        self.tip_m = moved_m;
        self.add_mass(piece_rank(place), moved_m, joint.mass_kg);
        self.add_bodies(piece_rank(place), &joint.bodies.rotating, rotation);
    }

    /// Adds rotational springs at the end of the chain as far as it has been built. `springs` has the axis of each
    /// spring in the world and its compliance \[rad/(N m)\]. Springs without compliance are left out. `place` is the
    /// number of the piece to which they belong.
    fn add_springs(&mut self, place: usize, springs: &[(Vector3<f64>, f64)]) {
        for &(axis, rad_per_nm) in springs.iter().filter(|(_, rad_per_nm)| *rad_per_nm > 0.0) {
            let (rank, at_m, compliance) = (spring_rank(place), self.tip_m, rad_per_nm);
            self.springs.push(PlacedSpring { rank, at_m, axis, slides: false, compliance });
        }
    }

    fn add_mass(&mut self, rank: usize, at_m: Vector3<f64>, mass_kg: f64) {
        if mass_kg != 0.0 {
            self.masses.push(PlacedMass {
                carrier: Point { at_m, rank, inside_m: None },
                arm_m: Vector3::zeros(),
                mass_kg,
                inertia_kgm2: Matrix3::zeros(),
            });
        }
    }

    /// Adds rigid bodies whose positions are measured from the end of the chain as far as it has been built. `rank` is
    /// their place in the order from base to tip.
    fn add_bodies(&mut self, rank: usize, bodies: &[RigidBody], rotation: &Rotation3<f64>) {
        for body in bodies {
            let carrier = Point { at_m: self.tip_m, rank, inside_m: None };
            self.masses.push(PlacedMass::new(body, rotation.matrix(), carrier, rotation * body.cg_m));
        }
    }

    /// Adds the bodies of a tube whose root is the end of the chain as far as it has been built. Each body moves with
    /// the point of the tube's axis that is nearest to it.
    fn add_bodies_on_tube(&mut self, rank: usize, link: &LinkPiece, rotation: &Rotation3<f64>) {
        let length_m = link.vector_m.norm();
        for body in &link.bodies {
            let along_m = (body.cg_m.dot(&link.vector_m) / length_m).clamp(0.0, length_m);
            let foot_m = rotation * link.vector_m * (along_m / length_m);
            let carrier = Point { at_m: self.tip_m + foot_m, rank, inside_m: Some(along_m) };
            let arm_m = rotation * body.cg_m - foot_m;
            self.masses.push(PlacedMass::new(body, rotation.matrix(), carrier, arm_m));
        }
    }

    fn add_link(&mut self, place: usize, link: &LinkPiece, rotation: &Rotation3<f64>) {
        let springs = link.root_frame.springs();
        let turned: Vec<_> = springs.into_iter().map(|(axis, c)| (rotation * axis, c)).collect();
        self.add_springs(place, &turned);
        let vector_m = rotation * link.vector_m;
        self.add_mass(piece_rank(place), self.tip_m + vector_m / 2.0, link.point_mass_kg);
        match link.beam {
            Some(_) => self.add_bodies_on_tube(piece_rank(place), link, rotation),
            None => self.add_bodies(piece_rank(place), &link.bodies, rotation),
        }
        if has_line(link) {
            self.tubes.push(PlacedTube {
                rank: piece_rank(place),
                root_m: self.tip_m,
                frame: rotation.matrix() * section_frame(&link.vector_m),
                length_m: link.vector_m.norm(),
            });
        }
        self.tip_m += vector_m;
    }
}

/// Whether a link has weight along its length: because it is a tube, or because cables run along it.
pub(super) fn has_line(link: &LinkPiece) -> bool {
    let has_cables = link.harness_kg_per_m != 0.0 && link.vector_m.norm() > 0.0;
    link.beam.is_some() || has_cables
}

/// A point of the arm. Everything of a lower rank is inboard of the point. A point in a tube has the rank of that
/// tube.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub at_m: Vector3<f64>,
    pub rank: usize,
    /// Distance from the root of the tube in which the point lies \[m\]; `None` if it lies in no tube.
    pub inside_m: Option<f64>,
}

/// One way in which a tube deforms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// Curvature that bends the tube in z: constant, or falling linearly from 1 at the root to -1 at the end.
    BendZ {
        linear: bool,
    },
    /// Curvature that bends the tube in y: constant, or falling linearly from 1 at the root to -1 at the end.
    BendY {
        linear: bool,
    },
    ShearZ,
    ShearY,
    Twist,
    Stretch,
}

const BENDING: [Shape; 4] = [
    Shape::BendZ { linear: false },
    Shape::BendZ { linear: true },
    Shape::BendY { linear: false },
    Shape::BendY { linear: true },
];
const REST: [Shape; 4] = [Shape::ShearZ, Shape::ShearY, Shape::Twist, Shape::Stretch];

impl Shape {
    /// Motion of the section at the distance `x` from the root, per unit of the shape, in the tube's frame. The root is
    /// clamped.
    fn field(self, x: f64, length_m: f64) -> Motion {
        let slope = |linear: bool| if linear { x - x * x / length_m } else { x };
        let moved =
            |linear: bool| if linear { x * x / 2.0 - x.powi(3) / (3.0 * length_m) } else { x * x / 2.0 };
        match self {
            // A positive rotation about y moves the end along -z. A positive rotation about z moves it along y.
            Shape::BendZ { linear } => Motion {
                moved: Vector3::new(0.0, 0.0, moved(linear)),
                turned: Vector3::new(0.0, -slope(linear), 0.0),
            },
            Shape::BendY { linear } => Motion {
                moved: Vector3::new(0.0, moved(linear), 0.0),
                turned: Vector3::new(0.0, 0.0, slope(linear)),
            },
            Shape::ShearZ => Motion::along(Vector3::new(0.0, 0.0, x)),
            Shape::ShearY => Motion::along(Vector3::new(0.0, x, 0.0)),
            Shape::Twist => Motion { moved: Vector3::zeros(), turned: Vector3::new(x, 0.0, 0.0) },
            Shape::Stretch => Motion::along(Vector3::new(x, 0.0, 0.0)),
        }
    }

    /// Index of the tube's stiffness that resists the shape, and the integral of the squared strain along the tube
    /// \[m\]. Their product is the stiffness of the coordinate.
    pub(super) fn stiffness(self, length_m: f64) -> (usize, f64) {
        let bending = |linear: bool| if linear { length_m / 3.0 } else { length_m };
        match self {
            Shape::BendZ { linear } => (0, bending(linear)),
            Shape::BendY { linear } => (1, bending(linear)),
            Shape::ShearZ | Shape::ShearY => (2, length_m),
            Shape::Twist => (3, length_m),
            Shape::Stretch => (4, length_m),
        }
    }
}

/// One way in which the arm deforms elastically, or a virtual motion (`Shift`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Coordinate {
    /// Angle of torsion of a joint.
    Joint(usize),
    /// Tilt of a joint's bearing about one of two axes at right angles to the joint's axis.
    Tilt(usize, usize),
    /// Travel of a prismatic joint. It is virtual too: the motor holds the carriage, and the compliance of its drive is a
    /// spring.
    Rail(usize),
    /// Displacement of everything outboard of a joint along one of two axes at right angles to the joint's axis (index
    /// 0 or 1), or along the joint's axis (index 2). The arm does not deform in this way: the motion is virtual and
    /// serves to compute forces.
    Shift(usize, usize),
    /// Deformation of a tube in one shape.
    Tube(usize, Shape),
    /// Tilt or displacement of a spring that is the same in all designs.
    Spring(usize),
}

/// All coordinates (ways to deform) of an arm, the coordinates of the joints first. `model` tells which deformations
/// of links count, and `tilting` tells for each joint whether its bearing may tilt.
pub(super) fn coordinates(layout: &Layout, model: LinkModel, tilting: &[bool]) -> Vec<Coordinate> {
    let shapes: &[&[Shape]] = match model {
        LinkModel::Rigid => &[],
        LinkModel::Bending => &[&BENDING],
        LinkModel::Full => &[&BENDING, &REST],
    };
    let shapes = shapes.concat();
    let joints = (0..layout.joints.len()).map(Coordinate::Joint);
    let tubes = 0..layout.tubes.len();
    let tubes = tubes.flat_map(|tube| shapes.iter().map(move |&shape| Coordinate::Tube(tube, shape)));
    let tilting = (0..layout.joints.len()).filter(|&joint| tilting[joint]);
    let tilts = tilting.flat_map(|joint| [Coordinate::Tilt(joint, 0), Coordinate::Tilt(joint, 1)]);
    let springs = (0..layout.springs.len()).map(Coordinate::Spring);
    joints.chain(tubes).chain(tilts).chain(springs).collect()
}

impl Layout {
    /// Motion of `point` per unit of `coordinate`, in the world frame. Zero if the point is inboard of the element that
    /// deforms.
    pub(super) fn motion(&self, coordinate: Coordinate, point: &Point) -> Motion {
        let still = Motion::default();
        let turned =
            |axis: &Vector3<f64>, at_m| Motion { moved: axis.cross(&(point.at_m - at_m)), turned: *axis };
        match coordinate {
            Coordinate::Joint(joint) => {
                let joint = &self.joints[joint];
                if joint.rank < point.rank { turned(&joint.axis, joint.at_m) } else { still }
            }
            Coordinate::Tilt(joint, which) => {
                let joint = &self.joints[joint];
                if joint.rank < point.rank { turned(&joint.across[which], joint.at_m) } else { still }
            }
            Coordinate::Shift(joint, which) => {
                let joint = &self.joints[joint];
                let direction = joint.across.get(which).unwrap_or(&joint.axis);
                if joint.rank < point.rank { Motion::along(*direction) } else { still }
            }
            Coordinate::Rail(rail) => {
                let rail = &self.rails[rail];
                if rail.rank < point.rank { Motion::along(rail.axis) } else { still }
            }
            Coordinate::Spring(spring) => {
                let spring = &self.springs[spring];
                if spring.rank < point.rank { spring.way(&point.at_m) } else { still }
            }
            Coordinate::Tube(tube, shape) => self.tubes[tube].motion(shape, point).unwrap_or(still),
        }
    }
}

impl PlacedTube {
    /// Motion of `point` per unit of a shape of this tube, in the world frame. The point lies in the tube or outboard of
    /// it. `None` for a point inboard of the tube.
    fn motion(&self, shape: Shape, point: &Point) -> Option<Motion> {
        let world = |x: f64| {
            let Motion { moved, turned } = shape.field(x, self.length_m);
            Motion { moved: self.frame * moved, turned: self.frame * turned }
        };
        if self.rank == point.rank {
            return point.inside_m.map(world);
        }
        let Motion { moved, turned } = world(self.length_m);
        let end_m = self.root_m + self.frame.column(0) * self.length_m;
        let moved = moved + turned.cross(&(point.at_m - end_m));
        (self.rank < point.rank).then_some(Motion { moved, turned })
    }
}
