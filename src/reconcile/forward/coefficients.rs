//! Lists the coordinates that an arm can have, and expresses a subject as numbers on these coordinates.

use crate::arm::LinkModel;
use crate::arm::effect::channel::Reading;
use crate::arm::effect::subject::Subject;
use crate::arm::joint_law::{Curve, JointLaw};
use crate::arm::load::Water;
use crate::arm::structure::{FrameCompliance, LinkPiece, Piece, Structure};
use crate::mechanics::beam::{Strain, compliances, strains};
use crate::mechanics::chain::Chain;
use nalgebra::Vector3;

/// A joint's coordinates.
#[derive(Debug, Clone)]
pub struct JointSlot {
    /// Name.
    pub name: String,
    /// Coordinate of its twist. Its two tilts are the two coordinates before it.
    pub twist: usize,
}

/// A link's coordinates.
#[derive(Debug, Clone)]
pub struct LinkSlot {
    /// Name.
    pub name: String,
    /// Index of its first coordinate.
    pub first: usize,
    /// The strain that each of its coordinates produces, and the degree of its polynomial along the link.
    pub strains: Vec<(Strain, usize)>,
}

/// The coordinates of every elastic thing that an arm can have, base to tip. They are the base's tilts (0 and
/// 1), each joint's two tilts and its twist, and each link's strains. An arm with yielding frames also has
/// theirs.
pub struct Layout {
    /// Number of coordinates.
    pub n: usize,
    /// Joints, base to tip.
    pub joints: Vec<JointSlot>,
    /// Links, base to tip.
    pub links: Vec<LinkSlot>,
    /// Coordinates of yielding frames with their compliance. No fit changes them.
    frames: Vec<(usize, f64)>,
    /// Compliance of coordinates that a nominal arm may lack: of links as they are drawn. It is 0 for all
    /// other coordinates.
    pub lacking: Vec<f64>,
    /// The arm with every elastic thing present, so that mechanics lists all coordinates.
    pub template: Chain,
    /// The template with a unit of one mass added, for each of the masses.
    pub with_mass: Vec<Chain>,
    /// Acceleration of gravity \[m/s²\].
    pub gravity_m_s2: f64,
}

/// A subject, expressed as numbers on the coordinates.
#[derive(Debug, Clone)]
pub struct Coefficients {
    /// Compliance of each coordinate. That of a joint's twist is 0 here, because its law is in `laws`.
    pub linear: Vec<f64>,
    /// Laws of the joints, base to tip.
    pub laws: Vec<JointLaw>,
    /// Mass beyond the template: of each joint \[kg\], of each link's harness \[kg/m\], and water density
    /// times added-mass coefficient \[kg/m³\].
    pub masses: Vec<f64>,
    /// Weight beyond the template in the same units, except that water has its density alone.
    pub weights: Vec<f64>,
    /// True minus stated payload mass \[kg\].
    pub payload_delta_kg: f64,
    /// True minus stated centre of gravity of the payload, in the last frame \[m\].
    pub payload_offset_m: Vector3<f64>,
    /// Part of the payload's weight that buoyancy leaves.
    pub payload_weight: f64,
    /// How the channels read.
    pub channels: [Reading; 4],
    /// Width over which the slope of a gear's curve changes at a break point \[ln of the torque\].
    pub smoothing: f64,
}

/// What differs between two subjects for static readings.
#[derive(Debug)]
pub(crate) struct StaticChanges {
    /// Linear compliances.
    pub linear: bool,
    /// Weights of the arm's masses.
    pub weights: bool,
    /// The payload's mass, place or buoyancy.
    pub payload: bool,
    /// The law of each joint.
    pub laws: Vec<bool>,
}

impl StaticChanges {
    /// Everything differs.
    pub(crate) fn all(joints: usize) -> Self {
        Self { linear: true, weights: true, payload: true, laws: vec![true; joints] }
    }

    /// Whether all static readings are the same.
    pub(crate) fn is_none(&self) -> bool {
        !(self.linear || self.weights || self.payload || self.laws.contains(&true))
    }
}

impl Layout {
    /// Lists the coordinates of an arm.
    pub fn new(structure: &Structure) -> Self {
        let full = with_everything(structure);
        let mut n = 2;
        let (mut joints, mut links) = (Vec::new(), Vec::new());
        let (mut frames, mut drawn) = (Vec::new(), Vec::new());
        let mut add_frame = |frame: &FrameCompliance, n: &mut usize| {
            for (_, compliance) in frame.springs() {
                frames.push((*n, compliance));
                *n += 1;
            }
        };
        add_frame(&full.base_frame, &mut n);
        for piece in &full.pieces {
            match piece {
                Piece::Joint(joint) => {
                    joints.push(JointSlot { name: joint.name.clone(), twist: n + 2 });
                    n += 3;
                }
                Piece::Link(link) => {
                    add_frame(&link.root_frame, &mut n);
                    let strains = strains(link, LinkModel::Full);
                    let count = strains.len();
                    drawn.push((n, link_compliances(link)));
                    links.push(LinkSlot { name: link.name.clone(), first: n, strains });
                    n += count;
                }
            }
        }
        let mut lacking = vec![0.0; n];
        for (first, compliances) in drawn {
            lacking[first..first + compliances.len()].copy_from_slice(&compliances);
        }
        Self {
            n,
            joints,
            links,
            frames,
            lacking,
            template: Chain::new(&full, LinkModel::Full),
            with_mass: unit_masses(&full).iter().map(|s| Chain::new(s, LinkModel::Full)).collect(),
            gravity_m_s2: structure.gravity_m_s2,
        }
    }
}

/// The structure with every elastic thing present, whatever its size, and nothing else changed.
fn with_everything(structure: &Structure) -> Structure {
    let mut full = structure.clone();
    full.base_tilt_rad_per_nm = 1.0;
    full.water = None;
    for piece in &mut full.pieces {
        match piece {
            Piece::Joint(joint) => joint.tilt_rad_per_nm = 1.0,
            Piece::Link(link) => {
                if let Some(beam) = &mut link.beam {
                    beam.flexibility = 1.0;
                }
            }
        }
    }
    full
}

/// The structure with one unit of each mass added, one at a time: joints, harnesses, water.
fn unit_masses(full: &Structure) -> Vec<Structure> {
    let joints = full.joints().map(|joint| {
        let mut with = full.clone();
        if let Some(j) = with.joint_mut(&joint.name) {
            j.mass_kg += 1.0;
        }
        with
    });
    let links = full.links().map(|link| {
        let mut with = full.clone();
        if let Some(l) = with.link_mut(&link.name) {
            l.harness_kg_per_m += 1.0;
        }
        with
    });
    let water =
        Water { density_kg_m3: 1.0, added_mass_coefficient: 1.0, payload_density_kg_m3: f64::INFINITY };
    let wet = Structure { water: Some(water), ..full.clone() };
    joints.chain(links).chain([wet]).collect()
}

impl Coefficients {
    /// Expresses a subject on the coordinates of `layout`. Masses count from those of `nominal`.
    pub fn new(layout: &Layout, nominal: &Subject, subject: &Subject) -> Self {
        let structure = &subject.structure;
        let mut linear = vec![0.0; layout.n];
        linear[..2].fill(structure.base_tilt_rad_per_nm);
        layout.frames.iter().for_each(|(at, compliance)| linear[*at] = *compliance);
        let mut masses = Vec::with_capacity(layout.with_mass.len());
        let mut laws = Vec::with_capacity(layout.joints.len());
        for ((slot, joint), before) in
            layout.joints.iter().zip(structure.joints()).zip(nominal.structure.joints())
        {
            linear[slot.twist - 2..slot.twist].fill(joint.tilt_rad_per_nm);
            laws.push(joint.law);
            masses.push(joint.mass_kg - before.mass_kg);
        }
        for ((slot, link), before) in
            layout.links.iter().zip(structure.links()).zip(nominal.structure.links())
        {
            linear[slot.first..slot.first + slot.strains.len()].copy_from_slice(&link_compliances(link));
            masses.push(link.harness_kg_per_m - before.harness_kg_per_m);
        }
        let mut weights = masses.clone();
        let (added, density, payload_weight) = structure.water.map_or((0.0, 0.0, 1.0), |w| {
            let density = w.density_kg_m3;
            (density * w.added_mass_coefficient, density, 1.0 - density / w.payload_density_kg_m3)
        });
        masses.push(added);
        weights.push(density);
        Self {
            linear,
            laws,
            masses,
            weights,
            payload_delta_kg: subject.payload_delta_kg,
            payload_offset_m: subject.payload_offset_m,
            payload_weight,
            channels: subject.channels.clone(),
            smoothing: 0.0,
        }
    }

    /// What differs between two subjects for static readings.
    pub(crate) fn static_changes(&self, other: &Self) -> StaticChanges {
        let laws: Vec<bool> = self.laws.iter().zip(&other.laws).map(|(a, b)| a != b).collect();
        let linear = self.linear != other.linear;
        let payload = self.payload_delta_kg != other.payload_delta_kg
            || self.payload_offset_m != other.payload_offset_m
            || self.payload_weight != other.payload_weight;
        // readings count from the unloaded arm, so where twists are proportional to torques, weights do not show
        let is_proportional = |law: &JointLaw| !law.has_play() && !matches!(law.curve, Curve::Windup(_));
        let is_other = linear || payload || laws.contains(&true);
        let weights = self.weights != other.weights && (is_other || !self.laws.iter().all(is_proportional));
        StaticChanges { linear, weights, payload, laws }
    }

    /// Whether two subjects have the same frequencies and the same modal channel.
    pub fn same_modes(&self, other: &Self) -> bool {
        self.linear == other.linear
            && self.masses == other.masses
            && self.weights == other.weights
            && self.payload_delta_kg == other.payload_delta_kg
            && self.payload_offset_m == other.payload_offset_m
            && self.payload_weight == other.payload_weight
            && self.smoothing == other.smoothing
            && self.laws.iter().zip(&other.laws).all(|(a, b)| {
                a.curve == b.curve
                    && a.connection_rad_per_nm == b.connection_rad_per_nm
                    && a.lost_motion == b.lost_motion
                    && a.further == b.further
            })
    }
}

fn link_compliances(link: &LinkPiece) -> Vec<f64> {
    compliances(link, LinkModel::Full)
}
