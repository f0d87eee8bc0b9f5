//! Computes the positions of up to eight points of one arm at once, and their derivatives with respect to the numbers
//! of the geometry.
//!
//! The equations are those of [`Placer`], with one point in each lane. Every lane does the same operations in the same
//! order as the placer, so the results are the same to the last bit.

use super::kinematics::{EVEN, Geometry, Number, Placer, Placing, rate};
use super::pose::Turn;
use crate::arm::effect::waves::{transmission_rad, transmission_waves};
use crate::arm::structure::JointAngle;
use crate::mechanics::lanes::{Eight, LANES, LaneWork, Lanes, in_lanes, load_all, splat_all, store_all};
use nalgebra::{Rotation3, Vector3};

/// The three components of a vector, each in eight lanes.
pub(crate) type Vectors = [Eight; 3];

/// Rotation (column by column) and origin \[m\] of a frame relative to the instrument's frame, in eight lanes.
#[derive(Clone, Copy)]
struct Frames {
    rotation: [Eight; 9],
    at_m: Vectors,
}

/// How a piece of the chain changes the frame that is passed along the chain.
enum Step {
    /// A joint turns the frame about this axis.
    Turn([f64; 3]),
    /// A link shifts the frame by this vector \[m\].
    Shift([f64; 3]),
    /// A link of unknown mounting shifts the frame by this vector \[m\], and turns it by this rotation.
    Mount([f64; 3], [f64; 9]),
}

/// The direction of the derivative of a point's position with respect to one number. A [`Factor`] may multiply it.
/// Frame `k` is inboard of the chain's piece `k`.
enum Part {
    Zero,
    /// The instrument axis with this index.
    Unit(usize),
    /// Turning about the instrument axis with this index through the base's origin.
    About(usize),
    /// Axis of a frame: index of the frame, index of the axis.
    Column(usize, usize),
    /// Turning at the outboard end of a piece about an axis of its inboard frame: index of the piece in the chain, index
    /// of the axis.
    Mount(usize, usize),
    /// Tilting the axis of a joint about a vector across it: index of the joint in the chain, the vector.
    Tilt(usize, [f64; 3]),
    /// Turning about the axes of joints: for each, its index in the chain, its axis, and the derivative of its angle.
    Turning(Vec<(usize, [f64; 3], f64)>),
}

/// A factor of a derivative that differs from lane to lane.
enum Factor {
    /// 1 for the point with this index, 0 for others.
    OfPoint(usize),
    /// 1 in the session with this index, 0 in others.
    OfStation(usize),
    /// A wave of the transmission error of a driven joint: index of the joint in a pose, index of the wave.
    Wave(usize, usize),
    /// Angle of a driven joint \[rad\], by its index in a pose.
    Turned(usize),
}

/// The derivative with respect to one number, prepared for the points of one arm.
pub(crate) struct Slope {
    part: Part,
    factor: Option<Factor>,
}

/// Computes positions of eight points at a time for one geometry.
pub(crate) struct EightPlacer<'a> {
    placer: Placer<'a>,
    /// The steps along the chain of each arm.
    chains: Vec<Vec<Step>>,
    /// Whether a joint needs the angles of the driven joints, and not only their sines and cosines.
    needs_angles: bool,
    /// Angles of the driven joints with zeros and transmission errors \[rad\], lane by lane; empty if no joint needs them.
    turned_rad: Vec<f64>,
    /// Sine and cosine of each joint along the chain.
    sin_cos: Vec<[Eight; 2]>,
    /// The frames along the chain.
    frames: Vec<Frames>,
    /// Positions of the points of the last call of `place_m`, without the motion of their sessions \[m\].
    at_m: Vectors,
}

impl<'a> EightPlacer<'a> {
    pub(crate) fn new(geometry: &'a Geometry) -> Self {
        let chain = |pieces: &Vec<usize>| pieces.iter().map(|&piece| step(geometry, piece)).collect();
        Self {
            placer: geometry.placer(),
            chains: geometry.arms.iter().map(chain).collect(),
            needs_angles: geometry.transmissions_rad.iter().any(|waves| *waves != EVEN)
                || geometry.angles.iter().flatten().any(|angle| matches!(angle, JointAngle::Coupled(_))),
            turned_rad: Vec::new(),
            sin_cos: Vec::new(),
            frames: Vec::new(),
            at_m: [[0.0; LANES]; 3],
        }
    }

    /// Positions of the points `asked`, in the instrument's frame \[m\]. There must be one to eight points, all of the
    /// same arm. Lanes without a point repeat the last point.
    pub(crate) fn place_m(&mut self, asked: &[Placing]) -> [Vector3<f64>; LANES] {
        let lanes: [&Placing; LANES] = std::array::from_fn(|lane| &asked[lane.min(asked.len() - 1)]);
        let geometry = self.placer.geometry;
        self.turn(&lanes);
        let chain = &self.chains[lanes[0].arm];
        let zero = Frames { rotation: [[0.0; LANES]; 9], at_m: [[0.0; LANES]; 3] };
        self.frames.resize(chain.len() + 1, zero);
        let tools_m = std::array::from_fn(|c| lanes.map(|own| geometry.tools_m[own.point][c]));
        let kinematics = ForwardKinematics {
            base: (columns(&geometry.base), geometry.origin_m.into()),
            chain,
            sin_cos: &self.sin_cos,
            tools_m: &tools_m,
            frames: &mut self.frames,
        };
        self.at_m = in_lanes(kinematics);
        std::array::from_fn(|lane| {
            let at_m = Vector3::from(self.at_m.map(|own| own[lane]));
            let (turn, shift_m) = &geometry.stations[lanes[lane].station];
            geometry.origin_m + turn * (at_m - geometry.origin_m) + shift_m
        })
    }

    /// Computes the angles of the driven joints, and sine and cosine of each joint along the chain.
    fn turn(&mut self, lanes: &[&Placing; LANES]) {
        let own = self.placer.geometry;
        self.turned_rad.clear();
        let asked_for = if self.needs_angles { lanes.as_slice() } else { &[] };
        for asked in asked_for {
            let joints = asked.pose.turns().iter().zip(&own.zeros_rad).zip(&own.transmissions_rad);
            self.turned_rad.extend(joints.map(|((q, zero), waves)| match *waves == EVEN {
                true => q.rad + zero,
                false => q.rad + zero + transmission_rad(waves, q.rad),
            }));
        }
        self.sin_cos.clear();
        for angle in own.arms[lanes[0].arm].iter().filter_map(|&piece| own.angles[piece].as_ref()) {
            let mut turns = [[0.0; LANES]; 2];
            for (lane, asked) in lanes.iter().enumerate() {
                let (sin, cos) = match angle {
                    JointAngle::Driven(j) if own.transmissions_rad[*j] == EVEN => {
                        let Turn { sin, cos, .. } = asked.pose.turns()[*j];
                        let (zero_sin, zero_cos) = self.placer.zero_sin_cos[*j];
                        (sin * zero_cos + cos * zero_sin, cos * zero_cos - sin * zero_sin)
                    }
                    _ => {
                        let driven = own.zeros_rad.len();
                        libm::sincos(angle.of(&self.turned_rad[lane * driven..][..driven]))
                    }
                };
                (turns[0][lane], turns[1][lane]) = (sin, cos);
            }
            self.sin_cos.push(turns);
        }
    }

    /// Prepares the derivatives with respect to `numbers` for points of the arm with the index `arm`.
    pub(crate) fn prepare(&self, arm: usize, numbers: &[Number]) -> Vec<Slope> {
        numbers.iter().map(|number| self.slope(arm, number)).collect()
    }

    fn slope(&self, arm: usize, number: &Number) -> Slope {
        let along = |piece: usize| self.placer.along[arm][piece];
        let own = self.placer.geometry;
        let part = match *number {
            Number::BaseRotation(c) | Number::SessionRotation(_, c) => Part::About(c),
            Number::BasePosition(c) | Number::SessionPosition(_, c) => Part::Unit(c),
            Number::Tool(_, c) => Part::Column(self.chains[arm].len(), c),
            // these numbers do not act through the geometry
            Number::Gravity(_) | Number::Tolerance(_) | Number::Effect(_) | Number::Drift(_) => Part::Zero,
            Number::Zero(j) | Number::Transmission(j, _) => self.turning(arm, j),
            Number::Ratio(i, _) => along(i)
                .map_or(Part::Zero, |k| Part::Turning(vec![(k, own.axes[i].into_inner().into(), 1.0)])),
            Number::Axis(i, side) => {
                along(i).map_or(Part::Zero, |k| Part::Tilt(k, self.placer.across[i][side].into()))
            }
            Number::Mount(i, c) => along(i).map_or(Part::Zero, |k| Part::Mount(k, c)),
            Number::Vector(i, c) | Number::MountVector(i, c) => {
                along(i).map_or(Part::Zero, |k| Part::Column(k, c))
            }
        };
        let factor = match (number, &part) {
            (_, Part::Zero) => None,
            (Number::SessionRotation(s, _) | Number::SessionPosition(s, _), _) => Some(Factor::OfStation(*s)),
            (Number::Tool(p, _), _) => Some(Factor::OfPoint(*p)),
            (Number::Transmission(j, wave), _) => Some(Factor::Wave(*j, *wave)),
            (Number::Ratio(i, t), _) => match &own.angles[*i] {
                Some(JointAngle::Coupled(terms)) => Some(Factor::Turned(terms[*t].0)),
                _ => None,
            },
            _ => None,
        };
        Slope { part, factor }
    }

    /// The derivative with respect to the angle of the driven joint with the index `driven`, which also turns its
    /// passive joints.
    fn turning(&self, arm: usize, driven: usize) -> Part {
        let own = self.placer.geometry;
        let pieces = self.placer.turned_by[driven].iter();
        let turns: Vec<(usize, [f64; 3], f64)> = pieces
            .filter_map(|&i| {
                let rate = rate(own.angles[i].as_ref()?, driven);
                Some((self.placer.along[arm][i]?, own.axes[i].into_inner().into(), rate))
            })
            .collect();
        if turns.is_empty() { Part::Zero } else { Part::Turning(turns) }
    }

    /// Writes the derivatives of the positions that were placed last into the columns of a matrix, one column for each
    /// of the `slopes`. The columns start `stride` numbers apart in `out`. Each column has x, y and z of the first
    /// lane, then of the second, and so on, each multiplied by its entry in `scales`. `asked` are the points that were
    /// placed.
    pub(crate) fn write_slopes(
        &self,
        asked: &[Placing],
        slopes: &[Slope],
        scales: &Vectors,
        out: &mut [f64],
        stride: usize,
    ) {
        let lanes: [&Placing; LANES] = std::array::from_fn(|lane| &asked[lane.min(asked.len() - 1)]);
        let factors = slopes.iter().filter_map(|slope| slope.factor.as_ref());
        let factors: Vec<Eight> = factors.map(|factor| self.factors(factor, &lanes)).collect();
        let origin_m = self.placer.geometry.origin_m.into();
        let (frames, at_m) = (&self.frames, &self.at_m);
        in_lanes(Slopes { slopes, factors: &factors, frames, at_m, origin_m, scales, out, stride });
    }

    fn factors(&self, factor: &Factor, lanes: &[&Placing; LANES]) -> Eight {
        let driven = self.placer.geometry.zeros_rad.len();
        match *factor {
            Factor::OfPoint(p) => lanes.map(|asked| f64::from(u8::from(asked.point == p))),
            Factor::OfStation(s) => lanes.map(|asked| f64::from(u8::from(asked.station == s))),
            Factor::Wave(j, k) => lanes.map(|asked| transmission_waves(asked.pose.turns()[j].rad)[k]),
            Factor::Turned(j) => std::array::from_fn(|lane| self.turned_rad[lane * driven + j]),
        }
    }
}

fn step(geometry: &Geometry, piece: usize) -> Step {
    let (vector_m, mount) = (geometry.vectors_m[piece].into(), &geometry.mounts[piece]);
    match &geometry.angles[piece] {
        Some(_) => Step::Turn(geometry.axes[piece].into_inner().into()),
        None if *mount == Rotation3::identity() => Step::Shift(vector_m),
        None => Step::Mount(vector_m, columns(mount)),
    }
}

fn columns(rotation: &Rotation3<f64>) -> [f64; 9] {
    let matrix = rotation.matrix();
    std::array::from_fn(|k| matrix[k])
}

/// The forward kinematics of an arm, from the base to the points on the tools.
struct ForwardKinematics<'a> {
    base: ([f64; 9], [f64; 3]),
    chain: &'a [Step],
    sin_cos: &'a [[Eight; 2]],
    tools_m: &'a Vectors,
    frames: &'a mut [Frames],
}

impl LaneWork for ForwardKinematics<'_> {
    type Output = Vectors;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Vectors {
        let mut rotation = splat_all::<V, 9>(self.base.0);
        let mut at_m = splat_all::<V, 3>(self.base.1);
        self.frames[0] = Frames { rotation: store_all(rotation), at_m: store_all(at_m) };
        let mut joint = 0;
        for (k, step) in self.chain.iter().enumerate() {
            match step {
                Step::Turn(axis) => {
                    rotation = times(&rotation, &turn(axis, &self.sin_cos[joint]));
                    joint += 1;
                }
                Step::Shift(vector_m) => at_m = sum(&at_m, &apply(&rotation, &splat_all(*vector_m))),
                Step::Mount(vector_m, mount) => {
                    at_m = sum(&at_m, &apply(&rotation, &splat_all(*vector_m)));
                    rotation = times(&rotation, &splat_all(*mount));
                }
            }
            self.frames[k + 1] = Frames { rotation: store_all(rotation), at_m: store_all(at_m) };
        }
        store_all(sum(&at_m, &apply(&rotation, &load_all(self.tools_m))))
    }
}

/// The derivatives of the placed points, written into the columns of a matrix.
struct Slopes<'a> {
    slopes: &'a [Slope],
    /// The factors of those slopes that have one.
    factors: &'a [Eight],
    frames: &'a [Frames],
    at_m: &'a Vectors,
    origin_m: [f64; 3],
    scales: &'a Vectors,
    out: &'a mut [f64],
    stride: usize,
}

impl LaneWork for Slopes<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let at_m = load_all::<V, 3>(self.at_m);
        let from_base_m = difference(&at_m, &splat_all(self.origin_m));
        let scales = load_all::<V, 3>(self.scales);
        let mut next = 0;
        for (j, slope) in self.slopes.iter().enumerate() {
            let mut by = match &slope.part {
                Part::Zero => [V::zero(); 3],
                Part::Unit(c) => unit(*c),
                Part::About(c) => cross(&unit(*c), &from_base_m),
                Part::Column(k, c) => axis(&self.frames[*k], *c),
                Part::Mount(k, c) => {
                    let lever_m = difference(&at_m, &load_all(&self.frames[*k + 1].at_m));
                    cross(&axis(&self.frames[*k], *c), &lever_m)
                }
                Part::Tilt(k, tilt) => {
                    let (before, behind) = (&self.frames[*k], &self.frames[*k + 1]);
                    let tilt = splat_all(*tilt);
                    let moved = difference(
                        &apply(&load_all(&before.rotation), &tilt),
                        &apply(&load_all(&behind.rotation), &tilt),
                    );
                    cross(&moved, &difference(&at_m, &load_all(&before.at_m)))
                }
                Part::Turning(turns) => {
                    let mut all = [V::zero(); 3];
                    for (k, axis, rate) in turns {
                        let before = &self.frames[*k];
                        let axis = apply(&load_all(&before.rotation), &splat_all(*axis));
                        let lever = cross(&axis, &difference(&at_m, &load_all(&before.at_m)));
                        for c in 0..3 {
                            all[c] = all[c] + lever[c] * V::splat(*rate);
                        }
                    }
                    all
                }
            };
            if slope.factor.is_some() {
                let factor = V::load(&self.factors[next]);
                next += 1;
                for part in &mut by {
                    *part = *part * factor;
                }
            }
            let column = &mut self.out[j * self.stride..][..3 * LANES];
            for c in 0..3 {
                let own = (by[c] * scales[c]).store();
                for lane in 0..LANES {
                    column[3 * lane + c] = own[lane];
                }
            }
        }
    }
}

#[inline(always)]
fn sum<V: Lanes>(a: &[V; 3], b: &[V; 3]) -> [V; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn difference<V: Lanes>(a: &[V; 3], b: &[V; 3]) -> [V; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn cross<V: Lanes>(a: &[V; 3], b: &[V; 3]) -> [V; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The instrument axis with the index `c`.
#[inline(always)]
fn unit<V: Lanes>(c: usize) -> [V; 3] {
    let mut out = [V::zero(); 3];
    out[c] = V::splat(1.0);
    out
}

/// The axis of the frames with the index `c`.
#[inline(always)]
fn axis<V: Lanes>(frames: &Frames, c: usize) -> [V; 3] {
    let rotation = &frames.rotation;
    [V::load(&rotation[3 * c]), V::load(&rotation[3 * c + 1]), V::load(&rotation[3 * c + 2])]
}

/// The product of rotations with vectors, summed in the order of the columns.
#[inline(always)]
fn apply<V: Lanes>(rotation: &[V; 9], vector: &[V; 3]) -> [V; 3] {
    let mut out = [V::zero(); 3];
    for i in 0..3 {
        out[i] = rotation[i] * vector[0] + rotation[3 + i] * vector[1] + rotation[6 + i] * vector[2];
    }
    out
}

#[inline(always)]
fn times<V: Lanes>(a: &[V; 9], b: &[V; 9]) -> [V; 9] {
    let mut out = [V::zero(); 9];
    for j in 0..3 {
        let column = apply(a, &[b[3 * j], b[3 * j + 1], b[3 * j + 2]]);
        for i in 0..3 {
            out[3 * j + i] = column[i];
        }
    }
    out
}

/// Rotations about the axis `axis` by angles that are given by their sines and cosines (Rodrigues' formula).
#[inline(always)]
fn turn<V: Lanes>(axis: &[f64; 3], sin_cos: &[Eight; 2]) -> [V; 9] {
    let [x, y, z] = *axis;
    let (sin, cos) = (V::load(&sin_cos[0]), V::load(&sin_cos[1]));
    let rest = V::splat(1.0) - cos;
    let (xy, xz, yz) = (V::splat(x * y) * rest, V::splat(x * z) * rest, V::splat(y * z) * rest);
    let [x_sin, y_sin, z_sin] = [V::splat(x) * sin, V::splat(y) * sin, V::splat(z) * sin];
    [
        V::splat(x * x) * rest + cos,
        xy + z_sin,
        xz - y_sin,
        xy - z_sin,
        V::splat(y * y) * rest + cos,
        yz + x_sin,
        xz + y_sin,
        yz - x_sin,
        V::splat(z * z) * rest + cos,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::reconcile::positions::kinematics::{number_groups, testing::ARM};
    use crate::reconcile::positions::pose::Pose;
    use crate::reconcile::positions::tree::Tree;
    use crate::reconcile::readings::campaign::{Campaign, read_statement};

    #[test]
    fn eight_places_and_their_slopes_have_the_bits_of_each_alone() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("campaign.json");
        let free = r#"{"positions": {"joint_offsets": true, "geometry": true, "tool_offset": true,
            "base_placement": true, "mounts": ["l2"]}}"#;
        std::fs::write(&file, free).expect("written");
        let statement = read_statement(&file).expect("sound");
        let arm =
            read_arm_document(Document::parse("a", ARM).expect("JSON"), &Catalogs::default()).expect("sound");
        let campaign = Campaign::of_positions(&statement, &[&arm], Vec::new()).expect("one trunk");
        let tree = Tree::new(&campaign);
        let groups = number_groups(&tree, &statement.positions, 2);
        let mut numbers: Vec<Number> = groups.into_iter().flat_map(|(_, group)| group).collect();
        let of_sessions = |c: usize| [Number::SessionRotation(1, c), Number::SessionPosition(1, c)];
        numbers.extend((0..3).flat_map(of_sessions));
        numbers.extend((0..4).map(|k| Number::Transmission(1, k)));
        numbers.extend([Number::Gravity(0), Number::Drift(1)]);
        assert!(numbers.contains(&Number::Ratio(4, 1)) && numbers.contains(&Number::Mount(3, 2)));
        let mut geometry = Geometry::nominal(&tree, 2);
        geometry.stations.push(geometry.stations[0]);
        let step: Vec<f64> = (0..numbers.len()).map(|k| 0.01 * ((k * k) % 7) as f64 - 0.025).collect();
        geometry.step(&numbers, &step);
        let poses: Vec<Pose> =
            (0..8).map(|k| Pose::new(&[0.4 * k as f64 - 1.0, 0.9 - 0.3 * k as f64])).collect();
        for count in [8, 5] {
            let of = |k: usize| Placing { arm: 0, pose: &poses[k], point: k % 2, station: k / 4 };
            let asked: Vec<Placing> = (0..count).map(of).collect();
            let mut eight = EightPlacer::new(&geometry);
            let own_m = eight.place_m(&asked);
            let slopes = eight.prepare(0, &numbers);
            let mut out = vec![f64::NAN; 30 * numbers.len()];
            let scales = [[2.0; LANES], [3.0; LANES], [0.5; LANES]];
            eight.write_slopes(&asked, &slopes, &scales, &mut out, 30);
            let mut placer = geometry.placer();
            for (lane, asked) in asked.iter().enumerate() {
                assert_eq!(own_m[lane], placer.place_m(*asked));
                let mut alone = Vec::new();
                placer.slopes(*asked, &numbers, &mut alone);
                for (j, slope) in alone.iter().enumerate() {
                    let scaled = slope.component_mul(&Vector3::new(2.0, 3.0, 0.5));
                    let own = &out[30 * j + 3 * lane..][..3];
                    assert_eq!(own, scaled.as_slice(), "{:?} in lane {lane}", numbers[j]);
                }
            }
        }
    }
}
