//! Where joints, tubes and masses are in a pose, and how every coordinate moves a point.
//!
//! The coordinates are a joint's twist and, for each tube, curvature constant and linear along it in both
//! planes, and constant shear, twist and stretch. The full model has these among its own and more; a body
//! that can move in fewer ways is stiffer, so its lowest mode is at least that of the full model.

use super::tubes::Tubes;
use crate::arm::{Link, LinkBody, LinkModel};
use crate::mechanics::beam::section_frame;
use crate::search::space::{Case, DesignSpace, SpacePiece};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// A joint in a pose.
pub(super) struct PlacedJoint {
    pub piece: usize,
    pub at_m: Vector3<f64>,
    pub axis: Vector3<f64>,
}

/// A tube in a pose; the frame's columns are its axis and the section's y and z.
pub(super) struct PlacedTube {
    pub piece: usize,
    pub root_m: Vector3<f64>,
    pub frame: Matrix3<f64>,
    pub length_m: f64,
}

/// A mass that no choice changes.
pub(super) struct PlacedMass {
    pub piece: usize,
    pub at_m: Vector3<f64>,
    pub mass_kg: f64,
}

/// An arm in a pose, base to tip.
pub(super) struct Layout {
    pub joints: Vec<PlacedJoint>,
    pub tubes: Vec<PlacedTube>,
    pub masses: Vec<PlacedMass>,
    pub tip_m: Vector3<f64>,
    pub tip_rotation: Matrix3<f64>,
}

impl Layout {
    /// Puts a space's arm into the pose of a case.
    pub fn new(space: &DesignSpace, case: &Case) -> Self {
        let mut angles = case.pose_deg.iter();
        let (mut at_m, mut rotation) = (Vector3::zeros(), Rotation3::identity());
        let (mut joints, mut tubes, mut masses) = (Vec::new(), Vec::new(), Vec::new());
        for (piece, what) in space.pieces.iter().enumerate() {
            let (vector_m, mass_kg) = match what {
                SpacePiece::Joint(joint) => {
                    joints.push(PlacedJoint { piece, at_m, axis: rotation * joint.axis.into_inner() });
                    let angle = angles.next().copied().unwrap_or_default().to_radians();
                    rotation *= Rotation3::from_axis_angle(&joint.axis, angle);
                    continue;
                }
                SpacePiece::Link(link) => (link.vector_m, offset_mass_kg(link)),
                SpacePiece::Choice(choice) => (choice.vector_m, None),
            };
            let turned = rotation * vector_m;
            match mass_kg {
                Some(mass_kg) => masses.push(PlacedMass { piece, at_m: at_m + 0.5 * turned, mass_kg }),
                None => tubes.push(PlacedTube {
                    piece,
                    root_m: at_m,
                    frame: rotation.matrix() * section_frame(&vector_m),
                    length_m: vector_m.norm(),
                }),
            }
            at_m += turned;
        }
        Self { joints, tubes, masses, tip_m: at_m, tip_rotation: *rotation.matrix() }
    }
}

/// Mass of a rigid offset; a tube is none.
pub(super) fn offset_mass_kg(link: &Link) -> Option<f64> {
    match link.body {
        LinkBody::Offset { mass_kg } => Some(mass_kg),
        LinkBody::Tube { .. } => None,
    }
}

/// A point of the arm: beyond all pieces before one, and maybe inside that piece's tube.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub at_m: Vector3<f64>,
    pub piece: usize,
    /// Distance from the root of the tube that the point is in \[m\].
    pub inside_m: Option<f64>,
}

/// In which ways a tube yields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// Curvature that moves the tube along z, constant or from 1 at the root to -1 at the end.
    BendZ {
        linear: bool,
    },
    /// The same along y.
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
    /// Displacement and rotation of the section at `x` per unit, from the clamped root, in the tube's frame.
    fn field(self, x: f64, length_m: f64) -> (Vector3<f64>, Vector3<f64>) {
        let slope = |linear: bool| if linear { x - x * x / length_m } else { x };
        let moved =
            |linear: bool| if linear { x * x / 2.0 - x.powi(3) / (3.0 * length_m) } else { x * x / 2.0 };
        let none = Vector3::zeros();
        match self {
            // a rotation about y lowers the end, one about z moves it along y
            Shape::BendZ { linear } => {
                (Vector3::new(0.0, 0.0, moved(linear)), Vector3::new(0.0, -slope(linear), 0.0))
            }
            Shape::BendY { linear } => {
                (Vector3::new(0.0, moved(linear), 0.0), Vector3::new(0.0, 0.0, slope(linear)))
            }
            Shape::ShearZ => (Vector3::new(0.0, 0.0, x), none),
            Shape::ShearY => (Vector3::new(0.0, x, 0.0), none),
            Shape::Twist => (none, Vector3::new(x, 0.0, 0.0)),
            Shape::Stretch => (Vector3::new(x, 0.0, 0.0), none),
        }
    }

    /// Which of a tube's stiffnesses resists, and the integral of the squared strain \[m\].
    pub fn stiffness(self, length_m: f64) -> (usize, f64) {
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

/// One way in which the arm yields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Coordinate {
    /// Twist of a joint.
    Joint(usize),
    /// A shape of a tube.
    Tube(usize, Shape),
}

/// All coordinates of an arm.
pub(super) fn coordinates(joints: usize, tubes: &[Tubes], model: LinkModel) -> Vec<Coordinate> {
    let shapes: &[&[Shape]] = match model {
        LinkModel::Rigid => &[],
        LinkModel::Bending => &[&BENDING],
        LinkModel::Full => &[&BENDING, &REST],
    };
    let shapes = shapes.concat();
    let tubes = (0..tubes.len()).flat_map(|tube| shapes.iter().map(move |&s| Coordinate::Tube(tube, s)));
    (0..joints).map(Coordinate::Joint).chain(tubes).collect()
}

impl Layout {
    /// Displacement and rotation of a point per unit of a coordinate, world.
    pub fn motion(&self, coordinate: Coordinate, point: &Point) -> (Vector3<f64>, Vector3<f64>) {
        match coordinate {
            Coordinate::Joint(joint) => {
                let joint = &self.joints[joint];
                match joint.piece < point.piece {
                    true => (joint.axis.cross(&(point.at_m - joint.at_m)), joint.axis),
                    false => (Vector3::zeros(), Vector3::zeros()),
                }
            }
            Coordinate::Tube(tube, shape) => {
                let tube = &self.tubes[tube];
                let world = |x: f64| {
                    let (moved, turned) = shape.field(x, tube.length_m);
                    (tube.frame * moved, tube.frame * turned)
                };
                if tube.piece < point.piece {
                    let (moved, turned) = world(tube.length_m);
                    let end_m = tube.root_m + tube.frame.column(0) * tube.length_m;
                    (moved + turned.cross(&(point.at_m - end_m)), turned)
                } else if let (true, Some(x)) = (tube.piece == point.piece, point.inside_m) {
                    world(x)
                } else {
                    (Vector3::zeros(), Vector3::zeros())
                }
            }
        }
    }
}
