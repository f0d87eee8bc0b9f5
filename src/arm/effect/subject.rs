//! The arm under test: its structure, and how the test deviates from its description. This is what effects change.

use super::channel::{Channel, Reading};
use super::setup::Setup;
use super::warming::{Moment, Softening, Warming};
use super::waves::transmission_rad;
use crate::arm::load::Payload;
use crate::arm::structure::{JointAngle, LinkPiece, Piece, Structure};
use nalgebra::Vector3;

/// An arm under test: the product, and how the test deviates from its description.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The product.
    pub structure: Structure,
    /// True mass minus stated mass, wherever a payload is stated \[kg\].
    pub payload_delta_kg: f64,
    /// True centre of gravity minus the stated one, in the last frame \[m\].
    pub payload_offset_m: Vector3<f64>,
    /// Uneven joints: the joint's name, and the amplitudes of sine and cosine once and twice a turn \[rad\].
    pub transmissions_rad: Vec<(String, [f64; 4])>,
    /// How each channel reads, in the order of [`Channel::ALL`].
    pub channels: [Reading; 4],
    /// What is special about the tests of each channel, in the same order.
    pub setups: [Setup; 4],
    /// How the moduli of the links change meanwhile.
    pub warming: Warming,
}

impl Subject {
    /// An arm whose test goes exactly as described.
    pub fn new(structure: Structure) -> Self {
        Self {
            structure,
            payload_delta_kg: 0.0,
            payload_offset_m: Vector3::zeros(),
            transmissions_rad: Vec::new(),
            channels: std::array::from_fn(|_| Reading::default()),
            setups: std::array::from_fn(|_| Setup::default()),
            warming: Warming::default(),
        }
    }

    /// The angles to which the driven joints turn when `pose_rad` is commanded \[rad\].
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

    /// How the channel named `at` reads; `None` if there is no such channel.
    pub fn channel_mut(&mut self, at: &str) -> Option<&mut Reading> {
        Channel::from_word(at).map(|c| &mut self.channels[c as usize])
    }

    /// What is special about the tests of the channel named `at`; `None` if there is no such channel.
    pub fn setup_mut(&mut self, at: &str) -> Option<&mut Setup> {
        Channel::from_word(at).map(|c| &mut self.setups[c as usize])
    }

    /// The arm as it is in a test of a channel.
    pub fn structure_in(&self, channel: Channel) -> Structure {
        self.setups[channel as usize].of(&self.structure)
    }

    /// Whether the arm is the same in all tests of a channel.
    pub fn is_steady(&self, channel: Channel) -> bool {
        self.warming.is_none() && self.setups[channel as usize].is_steady()
    }

    /// The arm as it is in a test of a channel at a moment.
    pub fn structure_at(&self, channel: Channel, when: &Moment) -> Structure {
        self.softened(channel, when, |softening| softening.factor(when.row))
    }

    /// The arm as it was when the reference of a displacement was read.
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

    /// The true payload where `stated` is stated. A load case without a payload stays without one.
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
