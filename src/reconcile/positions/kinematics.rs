//! Computes the position of a point on the tool for any calibrated geometry, and its derivatives with respect to the
//! numbers of the geometry.

use super::pose::{Pose, Turn};
use super::tree::Tree;
use crate::arm::effect::waves::{transmission_rad, transmission_waves};
use crate::arm::structure::{JointAngle, Piece};
use crate::arm::{Arm, Element};
use crate::mechanics::turn;
use crate::reconcile::readings::campaign::PositionsSpec;
use nalgebra::{Rotation3, Unit, Vector3};

/// The amplitudes of a joint's transmission error if the joint has none.
pub(super) const EVEN: [f64; 4] = [0.0; 4];

/// One number of the geometry that a fit can change. Rotations, tilts and shifts are counted from the nominal geometry.
/// The indices say to which part of the geometry a number belongs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Number {
    /// Rotation of the arm's base about the instrument axis with this index \[rad\].
    BaseRotation(usize),
    /// Coordinate with this index of the base's origin in the instrument's frame \[m\].
    BasePosition(usize),
    /// Offset of a point on the last frame \[m\]: index of the point, component.
    Tool(usize, usize),
    /// Rotation of everything outboard of a link of unknown mounting \[rad\]: index of the link among the pieces, and
    /// axis of the frame inboard of the link.
    Mount(usize, usize),
    /// Vector of a link of unknown mounting \[m\]: index of the piece, component.
    MountVector(usize, usize),
    /// Shift of the zero of a driven joint \[rad\]: index of the joint in a pose.
    Zero(usize),
    /// Tilt of a joint's axis \[rad\]: index of the piece, and which of the two axes across the joint's axis.
    Axis(usize, usize),
    /// Component of a link's vector \[m\]: index of the piece, component.
    Vector(usize, usize),
    /// One amplitude of a driven joint's transmission error \[rad\]: index of the joint in a pose, and which wave
    /// (sine or cosine, once or twice a turn).
    Transmission(usize, usize),
    /// Factor by which the angle of a passive joint follows that of a driven joint: index of the piece, index of the
    /// term among those of the joint's coupling.
    Ratio(usize, usize),
    /// Factor within tolerance on a stiffness, modulus or mass \[standard deviations\]: index of the dependence.
    Tolerance(usize),
    /// Effect on the nominal deflection, in the unit that its dependence defines: index of the dependence.
    Effect(usize),
    /// Horizontal component of the unit vector of gravity \[-\]: index of the axis, x or y, of the level frame.
    Gravity(usize),
    /// Rotation of all points of a later session relative to the first session, about the base's origin \[rad\]:
    /// index of the session, instrument axis.
    SessionRotation(usize, usize),
    /// Shift of all points of a later session relative to the first session \[m\]: index of the session, instrument
    /// axis.
    SessionPosition(usize, usize),
    /// Drift of all points from the first row to the last, along the instrument axis with this index \[m\].
    Drift(usize),
}

impl Number {
    /// Prior standard deviation of the number's change from nominal, in the number's unit. For placements it is far
    /// larger than any change that occurs, so that the readings alone decide.
    pub(crate) fn prior(&self) -> f64 {
        match self {
            Number::BaseRotation(_) | Number::Mount(..) => 10.0,
            Number::BasePosition(_) => 100.0,
            Number::Tool(..) | Number::MountVector(..) | Number::Tolerance(_) => 1.0,
            // wide: the range of the effect's parameter is checked after the fit
            Number::Effect(_) => 100.0,
            Number::Zero(_) => 0.03,
            Number::Axis(..) | Number::Vector(..) | Number::Ratio(..) => 0.01,
            Number::Transmission(..) => 0.002,
            Number::Gravity(_) | Number::SessionPosition(..) | Number::Drift(_) => 0.05,
            Number::SessionRotation(..) => 0.02,
        }
    }

    /// Whether the number acts through a point's deflection or its row in the file, and not through the geometry.
    pub(crate) fn acts_beyond_geometry(&self) -> bool {
        matches!(self, Number::Gravity(_) | Number::Tolerance(_) | Number::Effect(_) | Number::Drift(_))
    }

    /// Whether the number is a rotation that may be large, as for a placement. The fit shortens a step in which such a
    /// rotation is too large.
    pub(crate) fn turns(&self) -> bool {
        matches!(self, Number::BaseRotation(_) | Number::Mount(..))
    }
}

/// The numbers of the geometry that a campaign leaves free, in named groups of numbers. These are freed one after the
/// other: placement of arm and points, joint zeros, geometry, direction of gravity. `points` is the number of measured
/// points.
pub(crate) fn number_groups(
    tree: &Tree,
    spec: &PositionsSpec,
    points: usize,
) -> Vec<(&'static str, Vec<Number>)> {
    let mut placement = Vec::new();
    if spec.base_placement {
        placement.extend((0..3).map(Number::BaseRotation));
        placement.extend((0..3).map(Number::BasePosition));
    }
    if spec.tool_offset {
        placement.extend((0..points).flat_map(|p| (0..3).map(move |c| Number::Tool(p, c))));
    }
    placement.extend(mount_numbers(tree, spec));
    let mut out = vec![("nominal arm, placed", placement)];
    if spec.joint_offsets {
        out.push(("joint offsets", (0..tree.driven.len()).map(Number::Zero).collect()));
    }
    if spec.geometry {
        out.push(("geometry", geometry_numbers(tree, spec)));
    }
    if spec.frees_gravity() {
        out.push(("direction of gravity", (0..2).map(Number::Gravity).collect()));
    }
    out
}

/// The numbers that describe the mounting of each link of unknown mounting: three for the attitude of the part outboard
/// of it, three for its vector.
pub(crate) fn mount_numbers(tree: &Tree, spec: &PositionsSpec) -> Vec<Number> {
    let mounts = (0..tree.pieces.len()).filter(|&i| is_mount(&tree.pieces[i], spec));
    mounts
        .flat_map(|i| {
            (0..3).map(move |c| Number::Mount(i, c)).chain((0..3).map(move |c| Number::MountVector(i, c)))
        })
        .collect()
}

fn is_mount(piece: &Piece, spec: &PositionsSpec) -> bool {
    matches!(piece, Piece::Link(link) if spec.mounts.contains(&link.name))
}

/// The numbers of all joint axes and coupling ratios, and of the link vectors between the first and the last joint. If
/// links follow one another, only the last vector is free, because the readings depend on the sum of their vectors
/// only. Links before the first joint and after the last are covered by base placement and tool offsets.
fn geometry_numbers(tree: &Tree, spec: &PositionsSpec) -> Vec<Number> {
    let is_joint = |i: usize| matches!(tree.pieces[i], Piece::Joint(_));
    let between = |i: usize| {
        tree.arms.iter().any(|chain| {
            let Some(at) = chain.iter().position(|&p| p == i) else { return false };
            chain[..at].iter().any(|&p| is_joint(p)) && chain.get(at + 1).is_some_and(|&next| is_joint(next))
        })
    };
    let mut out = Vec::new();
    for (i, piece) in tree.pieces.iter().enumerate() {
        match piece {
            Piece::Joint(joint) => {
                out.extend((0..2).map(|k| Number::Axis(i, k)));
                if let JointAngle::Coupled(terms) = &joint.angle {
                    out.extend((0..terms.len()).map(|t| Number::Ratio(i, t)));
                }
            }
            Piece::Link(_) if between(i) && !is_mount(piece, spec) => {
                out.extend((0..3).map(|c| Number::Vector(i, c)));
            }
            Piece::Link(_) | Piece::Prismatic(_) => {}
        }
    }
    out
}

/// A calibrated geometry: the nominal geometry changed by the calibrated numbers.
#[derive(Debug, Clone)]
pub(crate) struct Geometry {
    /// Rotation from the base frame to the instrument's frame.
    pub base: Rotation3<f64>,
    /// Origin of the base, in the instrument's frame \[m\].
    pub origin_m: Vector3<f64>,
    /// Points on the tools, each in the last frame of the point's arm \[m\].
    pub tools_m: Vec<Vector3<f64>>,
    /// For each session, relative to the first one: how all points turn about the base's origin, and how they shift
    /// \[m\].
    pub stations: Vec<(Rotation3<f64>, Vector3<f64>)>,
    /// How far all points drift from the first row to the last \[m\].
    pub drift_m: Vector3<f64>,
    /// Rotation from the base frame to the level frame, whose z axis is opposite to gravity.
    pub level: Rotation3<f64>,
    /// Direction of gravity in the level frame. It is -z, unless it was fitted after the frame was last levelled.
    pub gravity: Vector3<f64>,
    pub(super) zeros_rad: Vec<f64>,
    /// Transmission error of each driven joint: sine and cosine, once and twice a turn \[rad\].
    pub transmissions_rad: Vec<[f64; 4]>,
    pub(super) axes: Vec<Unit<Vector3<f64>>>,
    pub(super) vectors_m: Vec<Vector3<f64>>,
    pub(super) mounts: Vec<Rotation3<f64>>,
    pub(super) angles: Vec<Option<JointAngle>>,
    /// How far the arm is from its nominal state: one number for each
    /// [`Dependence`](super::dependence::Dependence) of the nominal deflection. All are 0 for the nominal arm.
    pub dependences: Vec<f64>,
    pub(super) arms: Vec<Vec<usize>>,
}

/// States which point's position is asked for, and in which arm, pose and session.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placing<'a> {
    /// Index of the arm.
    pub arm: usize,
    /// Angles of the driven joints.
    pub pose: &'a Pose,
    /// Index of the point.
    pub point: usize,
    /// Index of the session.
    pub station: usize,
}

/// Rotation and origin \[m\] of a frame, relative to the instrument's frame.
#[derive(Clone, Copy)]
struct Frame {
    rotation: Rotation3<f64>,
    at_m: Vector3<f64>,
}

impl Geometry {
    /// The nominal geometry, with the arm at the instrument's origin and `points` points at the origin of the last
    /// frame.
    pub(crate) fn nominal(tree: &Tree, points: usize) -> Self {
        let axis = |p: &Piece| match p {
            Piece::Joint(j) => j.axis,
            _ => Vector3::z_axis(),
        };
        let vector = |p: &Piece| match p {
            Piece::Link(l) => l.vector_m,
            _ => Vector3::zeros(),
        };
        let angle = |p: &Piece| match p {
            Piece::Joint(j) => Some(j.angle.clone()),
            _ => None,
        };
        Self {
            base: Rotation3::identity(),
            origin_m: Vector3::zeros(),
            tools_m: vec![Vector3::zeros(); points],
            stations: vec![(Rotation3::identity(), Vector3::zeros())],
            drift_m: Vector3::zeros(),
            level: Rotation3::identity(),
            gravity: -Vector3::z(),
            zeros_rad: vec![0.0; tree.driven.len()],
            transmissions_rad: vec![[0.0; 4]; tree.driven.len()],
            axes: tree.pieces.iter().map(axis).collect(),
            vectors_m: tree.pieces.iter().map(vector).collect(),
            mounts: vec![Rotation3::identity(); tree.pieces.len()],
            angles: tree.pieces.iter().map(angle).collect(),
            dependences: Vec::new(),
            arms: tree.arms.clone(),
        }
    }

    /// Sets the attitude of everything outboard of a link of unknown mounting to `rotation`. The link has the index
    /// `piece` among the pieces.
    pub(crate) fn set_mount(&mut self, piece: usize, rotation: Rotation3<f64>) {
        self.mounts[piece] = rotation;
    }

    /// Changes each of the geometry's `numbers` by its amount in `step`, in the number's unit.
    pub(crate) fn step(&mut self, numbers: &[Number], step: &[f64]) {
        let about =
            |c: usize, by: f64| Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::ith(c, 1.0)), by);
        for (number, &by) in numbers.iter().zip(step) {
            match *number {
                Number::BaseRotation(c) => self.base = about(c, by) * self.base,
                Number::BasePosition(c) => self.origin_m[c] += by,
                Number::Tool(p, c) => self.tools_m[p][c] += by,
                Number::SessionRotation(s, c) => self.stations[s].0 = about(c, by) * self.stations[s].0,
                Number::SessionPosition(s, c) => self.stations[s].1[c] += by,
                Number::Drift(c) => self.drift_m[c] += by,
                Number::Mount(i, c) => self.mounts[i] = about(c, by) * self.mounts[i],
                Number::Zero(j) => self.zeros_rad[j] += by,
                Number::Transmission(j, k) => self.transmissions_rad[j][k] += by,
                Number::Ratio(i, t) => {
                    if let Some(JointAngle::Coupled(terms)) = &mut self.angles[i] {
                        terms[t].1 += by;
                    }
                }
                Number::Axis(i, k) => {
                    let turn = Rotation3::from_axis_angle(&across(&self.axes[i])[k], by);
                    self.axes[i] = Unit::new_normalize(turn * self.axes[i].into_inner());
                }
                Number::Vector(i, c) | Number::MountVector(i, c) => self.vectors_m[i][c] += by,
                Number::Tolerance(k) | Number::Effect(k) => self.dependences[k] += by,
                Number::Gravity(c) => {
                    self.gravity[c] += by;
                    self.gravity.normalize_mut();
                }
            }
        }
    }

    /// Turns the level frame so that gravity again points along its -z axis.
    pub(crate) fn relevel(&mut self) {
        if let Some(turn) = Rotation3::rotation_between(&self.gravity, &-Vector3::z()) {
            self.level = turn * self.level;
            self.gravity = -Vector3::z();
        }
    }

    /// Rotation from the level frame to the instrument's frame.
    pub(crate) fn level_to_instrument(&self) -> Rotation3<f64> {
        self.base * self.level.inverse()
    }

    /// Writes the calibrated axes and vectors into `arm`, which has the index `index` in the tree, in the level
    /// frame.
    ///
    /// A joint's zero and a mounting turn everything outboard, so later axes and vectors turn with them. Returns the
    /// resulting rotation of the arm's last frame.
    pub(crate) fn write_into(&self, index: usize, arm: &mut Arm) -> Rotation3<f64> {
        let mut turned = self.level;
        for (&i, element) in self.arms[index].iter().zip(&mut arm.chain) {
            match element {
                Element::Joint(joint) => {
                    joint.axis = Unit::new_normalize(turned * self.axes[i].into_inner());
                    if let Some(angle) = &self.angles[i] {
                        let zero = angle.of(&self.zeros_rad);
                        turned *= Rotation3::from_axis_angle(&self.axes[i], zero);
                    }
                    if let (Some(JointAngle::Coupled(own)), Some(terms)) =
                        (&self.angles[i], &mut joint.coupled)
                    {
                        terms.iter_mut().zip(own).for_each(|(term, (_, factor))| term.1 = *factor);
                    }
                }
                Element::Prismatic(_) => {}
                Element::Link(link) => {
                    link.vector_m = turned * self.vectors_m[i];
                    turned *= self.mounts[i];
                }
            }
        }
        turned
    }

    /// Prepares the computation of many positions with this geometry. Numbers that do not depend on the pose are
    /// computed here once.
    pub(crate) fn placer(&self) -> Placer<'_> {
        let along = |chain: &Vec<usize>| {
            let mut out = vec![None; self.axes.len()];
            chain.iter().enumerate().for_each(|(k, &piece)| out[piece] = Some(k));
            out
        };
        let turns = |driven: usize, piece: usize| match &self.angles[piece] {
            Some(JointAngle::Driven(index)) => *index == driven,
            Some(JointAngle::Coupled(terms)) => terms.iter().any(|(index, _)| *index == driven),
            None => false,
        };
        let turned_by = |j: usize| (0..self.axes.len()).filter(|&piece| turns(j, piece)).collect();
        Placer {
            geometry: self,
            across: self.axes.iter().map(|axis| across(axis).map(Unit::into_inner)).collect(),
            turned_by: (0..self.zeros_rad.len()).map(turned_by).collect(),
            along: self.arms.iter().map(along).collect(),
            zero_sin_cos: self.zeros_rad.iter().map(|zero| libm::sincos(*zero)).collect(),
            turned_rad: Vec::new(),
            frames: Vec::new(),
            at_m: Vector3::zeros(),
        }
    }

    /// Number of arms.
    pub(crate) fn arms(&self) -> usize {
        self.arms.len()
    }

    /// Position of the point `asked`, in the instrument's frame \[m\]. For many points a [`placer`](Self::placer) is faster.
    pub(crate) fn place_m(&self, asked: Placing) -> Vector3<f64> {
        self.placer().place_m(asked)
    }
}

/// Computes positions of points for one geometry. The memory for the frames of a pose is used again for each pose, so
/// that nothing is allocated for each point.
pub(crate) struct Placer<'a> {
    pub(super) geometry: &'a Geometry,
    /// For each piece, the two unit axes perpendicular to the joint's axis.
    pub(super) across: Vec<[Vector3<f64>; 2]>,
    /// For each driven joint, the joints whose angle depends on it: the joint itself and its passive joints.
    pub(super) turned_by: Vec<Vec<usize>>,
    /// For each arm and piece, the index of the piece in the arm's chain; `None` for pieces of other arms.
    pub(super) along: Vec<Vec<Option<usize>>>,
    /// Sine and cosine of each driven joint's zero.
    pub(super) zero_sin_cos: Vec<(f64, f64)>,
    /// Angles of the driven joints in the pose, with zeros and transmission errors added \[rad\].
    turned_rad: Vec<f64>,
    /// The frames along the chain: frame `k` is inboard of the chain's piece `k`, frame `k + 1` outboard of it.
    frames: Vec<Frame>,
    /// Position of the point that was placed last, without the motion of its session \[m\].
    pub(super) at_m: Vector3<f64>,
}

impl Placer<'_> {
    /// Position of the point `asked`, in the instrument's frame \[m\]. The [slopes](Self::slopes) refer to the point
    /// that was placed last.
    pub(crate) fn place_m(&mut self, asked: Placing) -> Vector3<f64> {
        let own = self.geometry;
        self.turned_rad.clear();
        let joints = asked.pose.turns().iter().zip(&own.zeros_rad).zip(&own.transmissions_rad);
        self.turned_rad.extend(joints.map(|((q, zero), waves)| match *waves == EVEN {
            true => q.rad + zero,
            false => q.rad + zero + transmission_rad(waves, q.rad),
        }));
        let mut last = Frame { rotation: own.base, at_m: own.origin_m };
        self.frames.clear();
        self.frames.push(last);
        for &i in &own.arms[asked.arm] {
            match &own.angles[i] {
                Some(angle) => last.rotation *= turn(&own.axes[i], self.sin_cos(angle, asked.pose)),
                None => {
                    last.at_m += last.rotation * own.vectors_m[i];
                    // most links have a known mounting, and the product can be skipped
                    if own.mounts[i] != Rotation3::identity() {
                        last.rotation *= own.mounts[i];
                    }
                }
            }
            self.frames.push(last);
        }
        self.at_m = last.at_m + last.rotation * own.tools_m[asked.point];
        let (turn, shift_m) = &own.stations[asked.station];
        own.origin_m + turn * (self.at_m - own.origin_m) + shift_m
    }

    /// Sine and cosine of the joint angle `angle` in a pose. For a driven joint without transmission error they follow,
    /// by the addition theorems, from those of its stated angle and of its zero. Computing sines would otherwise take
    /// most of the time.
    fn sin_cos(&self, angle: &JointAngle, pose: &Pose) -> (f64, f64) {
        match angle {
            JointAngle::Driven(j) if self.geometry.transmissions_rad[*j] == EVEN => {
                let (Turn { sin, cos, .. }, (zero_sin, zero_cos)) = (pose.turns()[*j], self.zero_sin_cos[*j]);
                (sin * zero_cos + cos * zero_sin, cos * zero_cos - sin * zero_sin)
            }
            _ => libm::sincos(angle.of(&self.turned_rad)),
        }
    }

    /// Appends to `out` the derivatives of the position of the point that was placed last with respect to the
    /// `numbers` of the geometry, one vector per number \[m per unit of the number\]. `asked` must be this point.
    pub(crate) fn slopes(&self, asked: Placing, numbers: &[Number], out: &mut Vec<Vector3<f64>>) {
        // the rotation of a session is small, so the derivatives of the first session are used for all sessions
        out.extend(numbers.iter().map(|number| self.slope(number, asked)));
    }

    fn slope(&self, number: &Number, asked: Placing) -> Vector3<f64> {
        let own = self.geometry;
        let zero = Vector3::zeros();
        let along = &self.along[asked.arm];
        let last = || self.frames[self.frames.len() - 1].rotation;
        match *number {
            Number::BaseRotation(c) => Vector3::ith(c, 1.0).cross(&(self.at_m - own.origin_m)),
            Number::BasePosition(c) => Vector3::ith(c, 1.0),
            Number::SessionRotation(s, c) if s == asked.station => {
                Vector3::ith(c, 1.0).cross(&(self.at_m - own.origin_m))
            }
            Number::SessionPosition(s, c) if s == asked.station => Vector3::ith(c, 1.0),
            Number::SessionRotation(..) | Number::SessionPosition(..) | Number::Drift(_) => zero,
            Number::Tool(p, c) if p == asked.point => last() * Vector3::ith(c, 1.0),
            Number::Tool(..) | Number::Gravity(_) | Number::Tolerance(_) | Number::Effect(_) => zero,
            Number::Zero(j) => self.turning(j, along),
            Number::Transmission(j, k) => {
                self.turning(j, along) * transmission_waves(asked.pose.turns()[j].rad)[k]
            }
            Number::Ratio(i, t) => match (along[i], &own.angles[i]) {
                (Some(k), Some(JointAngle::Coupled(terms))) => self.lever(i, k) * self.turned_rad[terms[t].0],
                _ => zero,
            },
            Number::Axis(i, side) => along[i].map_or(zero, |k| {
                let (before, behind) = (&self.frames[k], &self.frames[k + 1]);
                let tilt = self.across[i][side];
                (before.rotation * tilt - behind.rotation * tilt).cross(&(self.at_m - before.at_m))
            }),
            Number::Mount(i, c) => along[i].map_or(zero, |k| {
                let about = self.frames[k].rotation * Vector3::ith(c, 1.0);
                about.cross(&(self.at_m - self.frames[k + 1].at_m))
            }),
            Number::Vector(i, c) | Number::MountVector(i, c) => {
                along[i].map_or(zero, |k| self.frames[k].rotation * Vector3::ith(c, 1.0))
            }
        }
    }

    /// Derivative of the placed point's position with respect to the angle of the driven joint with index `driven`
    /// \[m/rad\]. `along` gives the index of each piece in the arm's chain; `None` for a piece of another arm.
    fn turning(&self, driven: usize, along: &[Option<usize>]) -> Vector3<f64> {
        let pieces = self.turned_by[driven].iter();
        pieces
            .filter_map(|&i| Some((i, along[i]?, rate(self.geometry.angles[i].as_ref()?, driven))))
            .map(|(i, k, rate)| rate * self.lever(i, k))
            .sum()
    }

    /// Derivative of the placed point's position with respect to the angle of the joint with the piece index `piece`
    /// \[m/rad\]. The index of this joint in the arm's chain is `k`.
    fn lever(&self, piece: usize, k: usize) -> Vector3<f64> {
        let before = &self.frames[k];
        (before.rotation * self.geometry.axes[piece].into_inner()).cross(&(self.at_m - before.at_m))
    }
}

/// Derivative of a joint's angle with respect to the angle of the driven joint with index `driven`: 1 for the driven
/// joint itself, the coupling factor for a passive joint, otherwise 0.
pub(super) fn rate(angle: &JointAngle, driven: usize) -> f64 {
    match angle {
        JointAngle::Driven(index) => f64::from(u8::from(*index == driven)),
        JointAngle::Coupled(terms) => terms.iter().filter(|(i, _)| *i == driven).map(|(_, f)| f).sum(),
    }
}

/// Two unit vectors that are perpendicular to the axis `axis` and to each other.
fn across(axis: &Unit<Vector3<f64>>) -> [Unit<Vector3<f64>>; 2] {
    let least = Vector3::ith(axis.iamin(), 1.0);
    let first = Unit::new_normalize(axis.cross(&least));
    [first, Unit::new_normalize(axis.cross(&first))]
}

#[cfg(test)]
pub(crate) mod testing {
    /// An arm with two driven joints, and a passive joint whose angle depends on both.
    pub(crate) const ARM: &str = r#"{"name": "a", "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": null},
        {"type": "link", "name": "l1", "vector_m": [0.1, 0, 0.4]},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": null},
        {"type": "link", "name": "l2", "vector_m": [0.6, 0, 0]},
        {"type": "joint", "name": "j3", "axis": [0, 1, 0], "stiffness_nm_per_rad": null,
         "coupled": {"j2": -1, "j1": 0.2}},
        {"type": "link", "name": "l3", "vector_m": [0.2, 0.1, 0]}]}"#;
}

#[cfg(test)]
mod tests {
    use super::testing::ARM;
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::reconcile::readings::campaign::Campaign;
    use crate::reconcile::readings::campaign::read_statement;

    #[test]
    fn slopes_are_differences_of_places_passive_and_uneven_joints_included() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("campaign.json");
        let free = r#"{"positions": {"joint_offsets": true, "geometry": true, "tool_offset": true}}"#;
        std::fs::write(&file, free).expect("written");
        let statement = read_statement(&file).expect("sound");
        let arm =
            read_arm_document(Document::parse("a", ARM).expect("JSON"), &Catalogs::default()).expect("sound");
        let campaign = Campaign::of_positions(&statement, &[&arm], Vec::new()).expect("one trunk");
        let tree = Tree::new(&campaign);
        let geometry = Geometry::nominal(&tree, 1);
        let groups = number_groups(&tree, &statement.positions, 1);
        let mut numbers: Vec<Number> = groups.into_iter().flat_map(|(_, group)| group).collect();
        assert!(numbers.contains(&Number::Ratio(4, 1)));
        numbers.extend((0..4).map(|k| Number::Transmission(1, k)));
        let asked = Placing { arm: 0, pose: &Pose::new(&[0.4, -0.7]), point: 0, station: 0 };
        let mut placer = geometry.placer();
        placer.place_m(asked);
        let mut slopes = Vec::new();
        placer.slopes(asked, &numbers, &mut slopes);
        for (number, slope) in numbers.iter().zip(&slopes) {
            let at = |by: f64| {
                let mut moved = geometry.clone();
                moved.step(std::slice::from_ref(number), &[by]);
                moved.place_m(asked)
            };
            let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
            assert!((difference - slope).norm() < 1e-8, "{number:?}: {difference} {slope}");
        }
    }
}
