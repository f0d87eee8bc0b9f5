//! Setups: differences between the arm in the tests of one channel and the arm by itself. Instruments may hang on the
//! arm in one kind of test only. A joint may be held by its servo in one kind of test and by its brake in another, and
//! the servo may be softer than the brake.

use super::warming::Softening;
use crate::arm::structure::{FrameCompliance, LinkPiece, Piece, Structure};
use nalgebra::{Rotation3, Vector3};

/// Something that happened once, between two rows of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// The first row of the file after it happened, counted from 0.
    pub from_row: usize,
    /// Mark of the file in which it happened: a number made from the content of the file; 0 for any file. In a file with
    /// another mark, which is another series of tests, it did not happen.
    pub file: usize,
}

impl Event {
    /// The event just before the row `from_row`, counted from 1, of the file with the mark `file`. Files write both
    /// numbers so. `None` if `from_row` is 0: it did not happen in this file.
    pub(crate) fn of_file(from_row: f64, file: f64) -> Option<Self> {
        (from_row >= 1.0).then(|| Self { from_row: from_row as usize - 1, file: file as usize })
    }

    /// Whether it happened in the file with the mark `file`.
    pub fn is_in(&self, file: usize) -> bool {
        self.file == 0 || self.file == file
    }
}

/// A base that turned, or an instrument that moved: once between two rows of a file, or more and more in the course of the
/// tests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turned {
    /// Rotation vector of the base about the origin of the chain \[rad\].
    pub turn_rad: Vector3<f64>,
    /// Displacement of every point as the instrument sees it \[m\].
    pub shift_m: Vector3<f64>,
    /// When it happened, or began.
    pub event: Event,
    /// Number of rows in which 63 % of it came; 0 if all of it came at once.
    pub rows: f64,
}

impl Turned {
    /// Displacement \[m\] of the point `at_m` that the instrument sees. `row` is the row of the file, counted from 0; in
    /// the rows before the event the displacement is zero.
    pub fn moved_m(&self, at_m: &Vector3<f64>, row: usize) -> Vector3<f64> {
        let Some(since) = row.checked_sub(self.event.from_row) else { return Vector3::zeros() };
        let part = if self.rows > 0.0 { -libm::expm1(-(since as f64) / self.rows) } else { 1.0 };
        part * (self.turn_rad.cross(at_m) + self.shift_m)
    }
}

/// A payload whose centre of gravity moved once between two rows of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slipped {
    /// Displacement of the centre of gravity, in the last frame \[m\].
    pub offset_m: Vector3<f64>,
    /// When it happened.
    pub event: Event,
}

/// A further twist of a joint under a load, in proportion to the torques that the load puts on its neighbours, or by play
/// that the unloaded arm leaves open to both sides.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoadTwist {
    /// Twist per torque of the load on the next joint inboard and on the next joint outboard \[rad/(N m)\].
    pub neighbours_rad_per_nm: [f64; 2],
    /// Twist under a large torque of the load on the joint itself \[rad\].
    pub play_rad: f64,
    /// Torque of the load at which 76 % of this twist is reached \[N m\].
    pub play_nm: f64,
}

impl LoadTwist {
    /// The twist under the torques that a load puts on the next joint inboard, on the joint itself and on the next joint
    /// outboard \[rad\].
    pub fn angle_rad(&self, [inboard_nm, own_nm, outboard_nm]: [f64; 3]) -> f64 {
        let play_rad =
            if self.play_rad == 0.0 { 0.0 } else { self.play_rad * libm::tanh(own_nm / self.play_nm) };
        let [inboard, outboard] = self.neighbours_rad_per_nm;
        inboard * inboard_nm + outboard * outboard_nm + play_rad
    }
}

/// How loads act otherwise than stated, and what they move wherever the tip is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Loading {
    /// Part of a stated force on the tip by which the force is larger.
    pub force_part: f64,
    /// Horizontal pull of a payload at the tip along world x and y, as a part of its weight.
    pub payload_pull: [f64; 2],
    /// Displacement along each direction per force of the load along it \[m/N\].
    pub sway_m_per_n: Vector3<f64>,
    /// Force on the tip in every load case with a payload, in the last frame \[N\].
    pub grip_n: Vector3<f64>,
    /// Part of the displacement of the load before, in the same pose, that remains.
    pub remaining: f64,
}

impl Loading {
    /// The force on the tip under a load that states the force `stated_n` and has a payload of the weight `weight_n`, without
    /// this weight itself \[N\]. `rotation` is that of the last frame.
    pub fn force_n(&self, stated_n: &Vector3<f64>, weight_n: f64, rotation: &Rotation3<f64>) -> Vector3<f64> {
        let [x, y] = self.payload_pull;
        let grip_n = if weight_n > 0.0 { rotation * self.grip_n } else { Vector3::zeros() };
        stated_n * (1.0 + self.force_part) + Vector3::new(x, y, 0.0) * weight_n + grip_n
    }

    /// What the force `load_n` of a load, weight included, moves wherever the tip is \[m\].
    pub fn sway_m(&self, load_n: &Vector3<f64>) -> Vector3<f64> {
        self.sway_m_per_n.component_mul(load_n)
    }
}

/// The differences between the arm in the tests of one channel and the arm by itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Setup {
    /// Additional mass at the tip \[kg\].
    pub mass_kg: f64,
    /// Centre of gravity of the additional mass, measured from the tip in the last frame \[m\].
    pub cg_m: Vector3<f64>,
    /// Additional compliance of joints about their axes in these tests: name of the joint and compliance
    /// \[rad/(N m)\].
    pub servo_rad_per_nm: Vec<(String, f64)>,
    /// Joints that soften in the course of the tests, by name.
    pub softening: Vec<(String, Softening)>,
    /// Turns of the base and motions of the instrument between two rows of the tests.
    pub turned: Vec<Turned>,
    /// Displacements of the payload's centre of gravity between two rows of the tests.
    pub slipped: Vec<Slipped>,
    /// Joints that twist further under a load, by name.
    pub load_twists: Vec<(String, LoadTwist)>,
    /// How loads act otherwise than stated.
    pub loading: Loading,
}

impl Setup {
    /// Whether the arm has neither additional mass nor additional compliance in the tests of this channel, and no joint
    /// softens.
    pub fn is_plain(&self) -> bool {
        self.mass_kg == 0.0 && self.servo_rad_per_nm.is_empty() && self.is_steady()
    }

    /// Whether the structure is the same in all rows.
    pub fn is_steady(&self) -> bool {
        self.softening.is_empty()
    }

    /// Forgets what happened in files with another mark than `file`.
    pub(crate) fn keep_events_of(&mut self, file: usize) {
        self.turned.retain(|turned| turned.event.is_in(file));
        self.slipped.retain(|slipped| slipped.event.is_in(file));
    }

    /// Displacement of the payload's centre of gravity by all slips before the row `row`, counted from 0, in the last
    /// frame \[m\].
    pub fn slip_m(&self, row: usize) -> Vector3<f64> {
        slip_m(&self.slipped, row)
    }

    /// The further twists under a load of the joint named `joint`.
    pub fn load_twists_of(&self, joint: &str) -> Vec<LoadTwist> {
        self.load_twists.iter().filter(|(name, _)| name == joint).map(|(_, twist)| *twist).collect()
    }

    /// How the joint named `joint` softens in these tests; `None` if it does not.
    pub fn softening_of(&self, joint: &str) -> Option<Softening> {
        self.softening.iter().rfind(|(name, _)| name == joint).map(|(_, softening)| *softening)
    }

    /// Multiplies the compliance of each joint that softens in these tests, in `structure`, by the value of `factor`.
    pub(crate) fn soften(&self, structure: &mut Structure, factor: impl Fn(&Softening) -> f64) {
        for (name, softening) in &self.softening {
            if let Some(joint) = structure.joint_mut(name) {
                joint.law = joint.law.softer(factor(softening));
            }
        }
    }

    /// Additional compliance of the joint named `joint` about its axis in these tests \[rad/(N m)\]; 0 if there is
    /// none.
    pub fn servo_of(&self, joint: &str) -> f64 {
        self.servo_rad_per_nm.iter().filter(|(name, _)| name == joint).map(|(_, c)| c).sum()
    }

    /// The `structure` of an arm, changed to the arm in the tests of this channel. The additional mass is placed by two
    /// rigid offsets, one forth and one back, so that the tip stays where it is.
    pub fn of(&self, structure: &Structure) -> Structure {
        let mut out = structure.clone();
        for (name, compliance) in &self.servo_rad_per_nm {
            if let Some(joint) = out.joint_mut(name) {
                joint.law.connection_rad_per_nm += compliance;
            }
        }
        if self.mass_kg != 0.0 {
            // the point mass of an offset is at its mid-length, so the offset is twice as long as the way to the mass
            let there = offset("test_mass", 2.0 * self.cg_m, self.mass_kg);
            out.pieces.extend([there, offset("test_mass.back", -2.0 * self.cg_m, 0.0)]);
        }
        out
    }
}

/// Displacement of a payload's centre of gravity by those of the slips that came before the row `row`, counted from 0
/// \[m\].
pub(crate) fn slip_m(slipped: &[Slipped], row: usize) -> Vector3<f64> {
    slipped.iter().filter(|slip| row >= slip.event.from_row).map(|slip| slip.offset_m).sum()
}

fn offset(name: &str, vector_m: Vector3<f64>, point_mass_kg: f64) -> Piece {
    Piece::Link(LinkPiece {
        name: name.into(),
        vector_m,
        beam: None,
        point_mass_kg,
        bodies: Vec::new(),
        harness_kg_per_m: 0.0,
        root_frame: FrameCompliance::default(),
    })
}
