//! The arm under test: the product, and the deviations of the test from its description. Effects change it.

use super::channel::{Channel, Reading};
use super::setup::Setup;
use super::warming::{Moment, Softening, Warming};
use super::waves::transmission_rad;
use crate::arm::load::Payload;
use crate::arm::structure::{JointAngle, LinkPiece, Piece, Structure};
use nalgebra::Vector3;

/// An arm under test: the product, and the deviations of the test from its description.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The arm as the mechanics needs it, with the effects of the product applied.
    pub structure: Structure,
    /// Actual mass minus stated mass of the payload, in every load case with a payload \[kg\].
    pub payload_delta_kg: f64,
    /// Actual centre of gravity of the payload minus its stated centre of gravity, in the last frame \[m\].
    pub payload_offset_m: Vector3<f64>,
    /// Transmission errors: the name of the joint, and the amplitudes \[rad\] of sine and cosine of the angle and of
    /// twice the angle.
    pub transmissions_rad: Vec<(String, [f64; 4])>,
    /// Zeros of angles that are off in static and modal tests: the name of the joint, and its true angle minus the stated
    /// one \[rad\].
    pub zeros_rad: Vec<(String, f64)>,
    /// How each channel turns actual values into readings, in the order of [`Channel::ALL`].
    pub channels: [Reading; 4],
    /// Differences between the arm in the tests of each channel and the arm by itself, in the order of
    /// [`Channel::ALL`].
    pub setups: [Setup; 4],
    /// How the moduli of the links change in the course of the tests.
    pub warming: Warming,
}

impl Subject {
    /// The arm `structure` under test, with tests that do not deviate from their description.
    pub fn new(structure: Structure) -> Self {
        Self {
            structure,
            payload_delta_kg: 0.0,
            payload_offset_m: Vector3::zeros(),
            transmissions_rad: Vec::new(),
            zeros_rad: Vec::new(),
            channels: std::array::from_fn(|_| Reading::default()),
            setups: std::array::from_fn(|_| Setup::default()),
            warming: Warming::default(),
        }
    }

    /// For each entry of a pose, the true angle minus the stated one in static and modal tests \[rad\]; 0 for travels.
    /// Empty if no zero is off.
    pub(crate) fn turns_rad(&self) -> Vec<f64> {
        if self.zeros_rad.is_empty() {
            return Vec::new();
        }
        let mut out = vec![0.0; self.structure.driven_joints().len()];
        for (name, zero_rad) in &self.zeros_rad {
            let joint = self.structure.joints().find(|j| j.name == *name);
            if let Some(JointAngle::Driven(entry)) = joint.map(|j| &j.angle) {
                out[*entry] += zero_rad;
            }
        }
        out
    }

    /// The pose in which the arm stands in a static or modal test that states the pose `pose_rad` \[rad, m\].
    pub(crate) fn standing_rad(&self, mut pose_rad: Vec<f64>) -> Vec<f64> {
        pose_rad.iter_mut().zip(self.turns_rad()).for_each(|(angle, zero)| *angle += zero);
        pose_rad
    }

    /// The angles to which the driven joints actually turn when `pose_rad` is commanded \[rad\].
    pub fn turned_rad(&self, pose_rad: &[f64]) -> Vec<f64> {
        let mut out = pose_rad.to_vec();
        for (name, waves_rad) in &self.transmissions_rad {
            let joint = self.structure.joints().find(|j| j.name == *name);
            if let Some(JointAngle::Driven(i)) = joint.map(|j| &j.angle) {
                out[*i] += transmission_rad(waves_rad, pose_rad[*i]);
            }
        }
        out
    }

    /// How the channel named `at` turns actual values into readings; `None` if there is no such channel.
    pub fn channel_mut(&mut self, at: &str) -> Option<&mut Reading> {
        Channel::from_word(at).map(|c| &mut self.channels[c as usize])
    }

    /// Differences between the arm in the tests of the channel named `at` and the arm by itself; `None` if there is
    /// no such channel.
    pub fn setup_mut(&mut self, at: &str) -> Option<&mut Setup> {
        Channel::from_word(at).map(|c| &mut self.setups[c as usize])
    }

    /// The structure of the arm in the tests of a channel, with the additional mass and compliance of these tests.
    pub fn structure_in(&self, channel: Channel) -> Structure {
        self.setups[channel as usize].of(&self.structure)
    }

    /// Whether the arm is the same in all tests of a channel.
    pub fn is_steady(&self, channel: Channel) -> bool {
        self.warming.is_none() && self.setups[channel as usize].is_steady()
    }

    /// The structure of the arm in a test of the channel `channel`, at the row and the temperature `when`.
    pub fn structure_at(&self, channel: Channel, when: &Moment) -> Structure {
        self.softened(channel, when, |softening| softening.factor(when.row))
    }

    /// The structure of the arm as it was when the reference of a displacement was read. `when` is the moment of the
    /// displacement itself.
    pub fn reference_at(&self, when: &Moment) -> Structure {
        self.softened(Channel::Static, when, |softening| softening.reference_factor(when.row))
    }

    fn softened(&self, channel: Channel, when: &Moment, factor: impl Fn(&Softening) -> f64) -> Structure {
        let mut out = self.structure_in(channel);
        self.setups[channel as usize].soften(&mut out, factor);
        let stiffer = self.warming.factor(when);
        for piece in &mut out.pieces {
            if let Piece::Link(LinkPiece { beam: Some(beam), .. }) = piece {
                beam.material.youngs_modulus_pa *= stiffer;
                beam.material.shear_modulus_pa *= stiffer;
            }
        }
        out
    }

    /// The actual payload, given the payload that a load case states. A load case without a payload stays without one.
    pub fn payload(&self, stated: &Payload) -> Payload {
        if stated.mass_kg == 0.0 {
            return *stated;
        }
        Payload {
            mass_kg: stated.mass_kg + self.payload_delta_kg,
            cg_m: stated.cg_m + self.payload_offset_m,
            ..*stated
        }
    }
}
