//! Where a point on the tool is, for any calibrated geometry, and how it moves with each number of it.

use crate::arm::{JointAngle, Piece, Structure};
use crate::reconcile::campaign::PositionsSpec;
use nalgebra::{Rotation3, Unit, Vector3};

/// One calibrated number of the geometry.
#[derive(Debug, Clone, PartialEq)]
pub enum Number {
    /// Rotation of the arm's base about an instrument axis \[rad\].
    BaseRotation(usize),
    /// Position of the arm's base \[m\].
    BasePosition(usize),
    /// Offset of a point on the last frame \[m\].
    Tool(usize, usize),
    /// Zero of a driven joint \[rad\]: index in the pose.
    Zero(usize),
    /// Tilt of a joint's axis \[rad\]: piece, and which of the two axes across.
    Axis(usize, usize),
    /// Component of a link's vector \[m\]: piece, component.
    Vector(usize, usize),
}

impl Number {
    /// Standard deviation before anything is measured.
    pub fn prior(&self) -> f64 {
        match self {
            Number::BaseRotation(_) => 10.0,
            Number::BasePosition(_) => 100.0,
            Number::Tool(..) => 1.0,
            Number::Zero(_) => 0.03,
            Number::Axis(..) => 0.01,
            Number::Vector(..) => 0.01,
        }
    }
}

/// The numbers a campaign leaves free.
pub fn numbers(structure: &Structure, spec: &PositionsSpec, points: usize, driven: usize) -> Vec<Number> {
    let mut out = Vec::new();
    if spec.base_placement {
        out.extend((0..3).map(Number::BaseRotation));
        out.extend((0..3).map(Number::BasePosition));
    }
    if spec.tool_offset {
        out.extend((0..points).flat_map(|p| (0..3).map(move |c| Number::Tool(p, c))));
    }
    if spec.joint_offsets {
        out.extend((0..driven).map(Number::Zero));
    }
    if spec.geometry {
        for (i, piece) in structure.pieces.iter().enumerate() {
            match piece {
                Piece::Joint(_) => out.extend((0..2).map(|k| Number::Axis(i, k))),
                Piece::Link(_) => out.extend((0..3).map(|c| Number::Vector(i, c))),
            }
        }
    }
    out
}

/// A calibrated geometry: the nominal one and the numbers' values.
#[derive(Debug, Clone)]
pub struct Geometry {
    /// Base frame in the instrument's.
    pub base: Rotation3<f64>,
    /// Base origin \[m\].
    pub origin_m: Vector3<f64>,
    /// Points on the last frame \[m\].
    pub tools_m: Vec<Vector3<f64>>,
    zeros_rad: Vec<f64>,
    axes: Vec<Unit<Vector3<f64>>>,
    vectors_m: Vec<Vector3<f64>>,
    angles: Vec<Option<JointAngle>>,
}

/// A point and its motion with each number, base frame of the arm.
pub struct Placed {
    /// Position, instrument's frame \[m\].
    pub at_m: Vector3<f64>,
    /// Its derivatives.
    pub slopes: Vec<Vector3<f64>>,
}

struct Frame {
    rotation: Rotation3<f64>,
    at_m: Vector3<f64>,
}

impl Geometry {
    /// The nominal geometry, the arm standing at the instrument's origin.
    pub fn nominal(structure: &Structure, points: usize, driven: usize) -> Self {
        let axis = |p: &Piece| match p {
            Piece::Joint(j) => j.axis,
            Piece::Link(_) => Vector3::z_axis(),
        };
        let vector = |p: &Piece| match p {
            Piece::Joint(_) => Vector3::zeros(),
            Piece::Link(l) => l.vector_m,
        };
        let angle = |p: &Piece| match p {
            Piece::Joint(j) => Some(j.angle.clone()),
            Piece::Link(_) => None,
        };
        Self {
            base: Rotation3::identity(),
            origin_m: Vector3::zeros(),
            tools_m: vec![Vector3::zeros(); points],
            zeros_rad: vec![0.0; driven],
            axes: structure.pieces.iter().map(axis).collect(),
            vectors_m: structure.pieces.iter().map(vector).collect(),
            angles: structure.pieces.iter().map(angle).collect(),
        }
    }

    /// Moves the numbers by a step.
    pub fn step(&mut self, numbers: &[Number], step: &[f64]) {
        for (number, &by) in numbers.iter().zip(step) {
            match *number {
                Number::BaseRotation(c) => {
                    let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::ith(c, 1.0)), by);
                    self.base = turn * self.base;
                }
                Number::BasePosition(c) => self.origin_m[c] += by,
                Number::Tool(p, c) => self.tools_m[p][c] += by,
                Number::Zero(j) => self.zeros_rad[j] += by,
                Number::Axis(i, k) => {
                    let turn = Rotation3::from_axis_angle(&across(&self.axes[i])[k], by);
                    self.axes[i] = Unit::new_normalize(turn * self.axes[i].into_inner());
                }
                Number::Vector(i, c) => self.vectors_m[i][c] += by,
            }
        }
    }

    /// A point in a pose with its derivatives.
    pub fn place(&self, pose_rad: &[f64], point: usize, numbers: &[Number]) -> Placed {
        let pose: Vec<f64> = pose_rad.iter().zip(&self.zeros_rad).map(|(q, z)| q + z).collect();
        let mut frames = vec![Frame { rotation: self.base, at_m: self.origin_m }];
        for i in 0..self.axes.len() {
            let last = &frames[i];
            let (mut rotation, mut at_m) = (last.rotation, last.at_m);
            match &self.angles[i] {
                Some(angle) => rotation *= Rotation3::from_axis_angle(&self.axes[i], angle.of(&pose)),
                None => at_m += rotation * self.vectors_m[i],
            }
            frames.push(Frame { rotation, at_m });
        }
        let last = &frames[frames.len() - 1];
        let at_m = last.at_m + last.rotation * self.tools_m[point];
        let slopes = numbers.iter().map(|n| self.slope(n, &frames, &at_m, point)).collect();
        Placed { at_m, slopes }
    }

    fn slope(&self, number: &Number, frames: &[Frame], at_m: &Vector3<f64>, point: usize) -> Vector3<f64> {
        match *number {
            Number::BaseRotation(c) => Vector3::ith(c, 1.0).cross(&(at_m - self.origin_m)),
            Number::BasePosition(c) => Vector3::ith(c, 1.0),
            Number::Tool(p, c) if p == point => frames[frames.len() - 1].rotation * Vector3::ith(c, 1.0),
            Number::Tool(..) => Vector3::zeros(),
            Number::Zero(j) => (0..self.axes.len())
                .filter_map(|i| Some((i, rate(self.angles[i].as_ref()?, j))))
                .filter(|(_, rate)| *rate != 0.0)
                .map(|(i, rate)| {
                    rate * (frames[i].rotation * self.axes[i].into_inner()).cross(&(at_m - frames[i].at_m))
                })
                .sum(),
            Number::Axis(i, k) => {
                let tilt = across(&self.axes[i])[k].into_inner();
                let turn = frames[i].rotation * tilt - frames[i + 1].rotation * tilt;
                turn.cross(&(at_m - frames[i].at_m))
            }
            Number::Vector(i, c) => frames[i].rotation * Vector3::ith(c, 1.0),
        }
    }
}

/// How a joint's angle follows an entry of the pose.
fn rate(angle: &JointAngle, driven: usize) -> f64 {
    match angle {
        JointAngle::Driven(index) => f64::from(u8::from(*index == driven)),
        JointAngle::Coupled(terms) => terms.iter().filter(|(i, _)| *i == driven).map(|(_, f)| f).sum(),
    }
}

/// Two axes across a third and each other.
fn across(axis: &Unit<Vector3<f64>>) -> [Unit<Vector3<f64>>; 2] {
    let least = Vector3::ith(axis.iamin(), 1.0);
    let first = Unit::new_normalize(axis.cross(&least));
    [first, Unit::new_normalize(axis.cross(&first))]
}
