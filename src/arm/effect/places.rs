//! Finds the pieces of an arm by name, and the places where an effect can be.

use super::kind::Place;
use crate::arm::prismatic::PrismaticPiece;
use crate::arm::structure::{JointPiece, LinkPiece, Piece, Structure};
use crate::arm::{BASE, PAYLOAD};

impl Structure {
    /// Which kind of place the name `at` denotes in this arm. Only the kinds in `allowed` are tried; `None` if `at`
    /// denotes none of them. Where the base is allowed, `base` denotes the base, even if a piece has this name.
    pub fn place(&self, at: &str, allowed: &[Place]) -> Option<Place> {
        if at == BASE && allowed.contains(&Place::Base) {
            return Some(Place::Base);
        }
        allowed.iter().copied().find(|place| match place {
            Place::Joint => self.joints().any(|j| j.name == at),
            Place::Prismatic => self.prismatics().any(|j| j.name == at),
            Place::Link => self.links().any(|l| l.name == at),
            Place::Tube => self.links().any(|l| l.name == at && l.beam.is_some()),
            Place::Base => false, // decided above
            Place::Payload => at == PAYLOAD,
            Place::Arm => at == "arm",
            Place::Channel(channel) => at == channel.word(),
        })
    }

    /// The names of all places of the kind `place` in this arm.
    pub fn places(&self, place: Place) -> Vec<String> {
        match place {
            Place::Joint => self.joints().map(|j| j.name.clone()).collect(),
            Place::Prismatic => self.prismatics().map(|j| j.name.clone()).collect(),
            Place::Link => self.links().map(|l| l.name.clone()).collect(),
            Place::Tube => self.links().filter(|l| l.beam.is_some()).map(|l| l.name.clone()).collect(),
            Place::Base => vec![BASE.into()],
            Place::Payload => vec![PAYLOAD.into()],
            Place::Arm => vec!["arm".into()],
            Place::Channel(channel) => vec![channel.word().into()],
        }
    }

    /// The revolute joints, base to tip.
    pub fn joints(&self) -> impl Iterator<Item = &JointPiece> {
        self.pieces.iter().filter_map(|p| match p {
            Piece::Joint(joint) => Some(joint),
            _ => None,
        })
    }

    /// The links, base to tip.
    pub fn links(&self) -> impl Iterator<Item = &LinkPiece> {
        self.pieces.iter().filter_map(|p| match p {
            Piece::Link(link) => Some(link),
            _ => None,
        })
    }

    /// The revolute joint with this name; `None` if there is none.
    pub fn joint_mut(&mut self, name: &str) -> Option<&mut JointPiece> {
        self.pieces.iter_mut().find_map(|p| match p {
            Piece::Joint(joint) if joint.name == name => Some(joint),
            _ => None,
        })
    }

    /// The prismatic joints, base to tip.
    pub fn prismatics(&self) -> impl Iterator<Item = &PrismaticPiece> {
        self.pieces.iter().filter_map(|p| match p {
            Piece::Prismatic(joint) => Some(joint),
            _ => None,
        })
    }

    /// The prismatic joint with this name; `None` if there is none.
    pub fn prismatic_mut(&mut self, name: &str) -> Option<&mut PrismaticPiece> {
        self.pieces.iter_mut().find_map(|p| match p {
            Piece::Prismatic(joint) if joint.name == name => Some(joint),
            _ => None,
        })
    }

    /// The link with this name; `None` if there is none.
    pub fn link_mut(&mut self, name: &str) -> Option<&mut LinkPiece> {
        self.pieces.iter_mut().find_map(|p| match p {
            Piece::Link(link) if link.name == name => Some(link),
            _ => None,
        })
    }
}
