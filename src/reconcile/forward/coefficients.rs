//! Lists the strain coordinates that an arm can have, and expresses a subject as numbers on these coordinates.

use crate::arm::LinkModel;
use crate::arm::base_lift::BaseLift;
use crate::arm::effect::channel::{Channel, Reading};
use crate::arm::effect::setup::{LoadTwist, Loading, Setup, Slipped, Turned, slip_m};
use crate::arm::effect::subject::Subject;
use crate::arm::effect::warming::{Softening, Warming};
use crate::arm::joint_law::{Curve, JointLaw};
use crate::arm::joint_torque::JointTorque;
use crate::arm::load::Water;
use crate::arm::structure::{FrameCompliance, LinkPiece, Piece, Structure};
use crate::mechanics::beam::{Strain, compliances, strains};
use crate::mechanics::chain::Chain;
use crate::mechanics::{Wrench, force_wrench};
use nalgebra::{Rotation3, Vector3};

/// Number of coordinates of a base or a bearing: its tilts about two axes. The coordinates of a bearing come directly
/// before the coordinate of the joint's twist.
const TILTS: usize = 2;
/// Number of coordinates of a guide: its rotations about three axes. They come directly before the coordinate of the
/// joint's travel.
pub(crate) const GUIDE_ROTATIONS: usize = 3;

/// Where the strain coordinates of a joint stand among all strain coordinates.
#[derive(Debug, Clone)]
pub struct JointSlot {
    /// Name of the joint.
    pub name: String,
    /// Index of the coordinate of the joint's twist (torsion). The two coordinates before it are the joint's tilts.
    pub twist: usize,
}

/// Where the strain coordinates of a link stand among all strain coordinates.
#[derive(Debug, Clone)]
pub struct LinkSlot {
    /// Name of the link.
    pub name: String,
    /// Index of the link's first coordinate.
    pub first: usize,
    /// For each coordinate of the link, the kind of strain, and the degree of its polynomial along the link.
    pub strains: Vec<(Strain, usize)>,
}

/// The strain coordinates of every elastic element that an arm can have, base to tip: the two tilts of the base
/// (indices 0 and 1), two tilts and the twist of each joint, three rotations and the travel of each prismatic joint,
/// and the strains of each link. An arm also has coordinates for each frame compliance (a rotational compliance about
/// three axes) of its base and of its links' roots.
pub struct Layout {
    /// Number of strain coordinates.
    pub n: usize,
    /// Strain coordinates of the joints, base to tip.
    pub joints: Vec<JointSlot>,
    /// Strain coordinates of the links, base to tip.
    pub links: Vec<LinkSlot>,
    /// For each prismatic joint, base to tip, the first of its four coordinates: three of its guide, then its travel.
    pub(crate) slides: Vec<usize>,
    /// Index and compliance of each coordinate that belongs to a frame compliance of the base or of a link's root. No
    /// fit changes these compliances.
    frames: Vec<(usize, f64)>,
    /// Compliance that each strain coordinate of a link has according to the link's section. It is used for trial
    /// shapes where the nominal model has rigid links. It is 0 for all other coordinates.
    pub lacking: Vec<f64>,
    /// The arm with every elastic element present, so that mechanics lists all coordinates.
    pub template: Chain,
    /// For each of the masses that a fit can change, the arm `template` with one unit of this mass added.
    pub with_mass: Vec<Chain>,
    /// Acceleration of gravity \[m/s²\].
    pub gravity_m_s2: f64,
}

/// The special set-up of the tests of one channel, as numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct TestNumbers {
    /// Additional mass at the tip in these tests \[kg\].
    pub mass_kg: f64,
    /// Vector from the tip to the centre of gravity of the additional mass, in the last frame \[m\].
    pub cg_m: Vector3<f64>,
    /// Additional compliance of each joint in these tests, base to tip \[rad/(N m)\]; empty if there is none.
    pub servo_rad_per_nm: Vec<f64>,
    /// How each joint softens in the course of the tests, base to tip; empty if none does.
    pub softening: Vec<Option<Softening>>,
    /// How the base turned and the instrument moved in the course of the tests.
    pub turned: Vec<Turned>,
    /// How the payload's centre of gravity moved in the course of the tests.
    pub slipped: Vec<Slipped>,
    /// Further twists of each joint under a load, base to tip; empty if there are none.
    pub load_twists: Vec<Vec<LoadTwist>>,
    /// How loads act otherwise than stated.
    pub loading: Loading,
}

impl TestNumbers {
    fn of(setup: &Setup, layout: &Layout) -> Self {
        let servo_rad_per_nm = match setup.servo_rad_per_nm.is_empty() {
            true => Vec::new(),
            false => layout.joints.iter().map(|j| setup.servo_of(&j.name)).collect(),
        };
        let softening = match setup.is_steady() {
            true => Vec::new(),
            false => layout.joints.iter().map(|j| setup.softening_of(&j.name)).collect(),
        };
        let load_twists = match setup.load_twists.is_empty() {
            true => Vec::new(),
            false => layout.joints.iter().map(|j| setup.load_twists_of(&j.name)).collect(),
        };
        Self {
            mass_kg: setup.mass_kg,
            cg_m: setup.cg_m,
            servo_rad_per_nm,
            softening,
            turned: setup.turned.clone(),
            slipped: setup.slipped.clone(),
            load_twists,
            loading: setup.loading,
        }
    }

    /// The further twists of a joint under a load.
    pub(crate) fn load_twists_of(&self, joint: usize) -> &[LoadTwist] {
        self.load_twists.get(joint).map_or(&[], Vec::as_slice)
    }

    /// How a joint softens; `None` if it does not.
    pub(crate) fn softening_of(&self, joint: usize) -> Option<Softening> {
        self.softening.get(joint).copied().flatten()
    }

    /// Weight of the additional mass as a wrench about the world's origin; zero if there is no such mass. `tip_m` is
    /// the position of the tip and `rotation` the rotation of the last frame in the world.
    pub fn weight(&self, tip_m: &Vector3<f64>, rotation: &Rotation3<f64>, gravity_m_s2: f64) -> Wrench {
        match self.mass_kg {
            0.0 => Wrench::zeros(),
            kg => force_wrench(&Vector3::new(0.0, 0.0, -kg * gravity_m_s2), &(tip_m + rotation * self.cg_m)),
        }
    }
}

/// A subject (an arm under test), expressed as compliances, joint laws and masses on the strain coordinates of a
/// [`Layout`].
#[derive(Debug, Clone)]
pub struct Coefficients {
    /// Compliance of each strain coordinate. It is 0 for a joint's torsion, because the joint's law is in `laws`.
    pub linear: Vec<f64>,
    /// How the base tilts once its feet lift off; `None` if the feet stay on the ground.
    pub lift: Option<BaseLift>,
    /// Torsion laws of the joints, base to tip.
    pub laws: Vec<JointLaw>,
    /// Torques on the joints by springs and the like, in addition to weight, load and the torques of the template.
    pub torques: Vec<JointTorque>,
    /// Masses in addition to the template, one per entry of the layout's `with_mass`: of each joint \[kg\], of each
    /// link's harness \[kg/m\], of each prismatic joint \[kg\], and water density times added-mass coefficient
    /// \[kg/m³\].
    pub masses: Vec<f64>,
    /// The part of `masses` that has weight, in the same order and units. The last entry is the water's density alone
    /// \[kg/m³\], without the added-mass coefficient.
    pub weights: Vec<f64>,
    /// Actual minus stated payload mass \[kg\].
    pub payload_delta_kg: f64,
    /// Actual minus stated centre of gravity of the payload, in the last frame \[m\].
    pub payload_offset_m: Vector3<f64>,
    /// Fraction of the payload's weight that remains after buoyancy; 1 in air.
    pub payload_weight: f64,
    /// Errors of the measuring channels (gain, sign and the like), one entry per channel.
    pub channels: [Reading; 4],
    /// Special set-up of the tests of each channel, such as a mass at the tip.
    pub tests: [TestNumbers; 4],
    /// Change of the links' moduli during the tests.
    pub warming: Warming,
    /// For each entry of a pose, how far the arm is turned from the pose that was prepared, because the zero of an angle
    /// is off \[deg\]; empty if it is not turned. [`Coefficients::new`] leaves it empty, because a preparation knows it.
    pub turned_deg: Vec<f64>,
    /// Width over which the slope of a gear's curve changes at a break point \[ln of the torque\]; 0 for a sharp break.
    pub smoothing: f64,
}

/// Which of the numbers that static readings depend on differ between two subjects.
#[derive(Debug)]
pub(crate) struct StaticChanges {
    /// Whether the linear compliances differ.
    pub linear: bool,
    /// Whether the weights of the arm's masses differ so that readings can change.
    pub weights: bool,
    /// Whether the payload's mass, centre of gravity or buoyancy differ.
    pub payload: bool,
    /// Whether the lift-off of the feet differs.
    pub lift: bool,
    /// For each joint, whether its torsion law differs.
    pub laws: Vec<bool>,
    /// Whether the axes of the instrument or a turn of the base differ. The deflections are then the same, but the
    /// readings of them differ.
    pub seen: bool,
}

impl StaticChanges {
    /// States that all numbers differ, for an arm with this number of joints.
    pub(crate) fn all(joints: usize) -> Self {
        Self { linear: true, weights: true, payload: true, lift: true, laws: vec![true; joints], seen: true }
    }

    /// Whether no number differs, so that all static readings are the same.
    pub(crate) fn is_none(&self) -> bool {
        let deflects = self.linear || self.weights || self.payload || self.lift || self.laws.contains(&true);
        !(deflects || self.seen)
    }
}

impl Layout {
    /// Whether the strain coordinate with this index belongs to a link.
    pub(crate) fn is_of_link(&self, coordinate: usize) -> bool {
        self.links.iter().any(|link| (link.first..link.first + link.strains.len()).contains(&coordinate))
    }

    /// Lists the strain coordinates that the arm `structure` can have.
    pub fn new(structure: &Structure) -> Self {
        let full = with_everything(structure);
        let mut n = TILTS;
        let (mut joints, mut links) = (Vec::new(), Vec::new());
        let (mut frames, mut drawn, mut slides) = (Vec::new(), Vec::new(), Vec::new());
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
                    joints.push(JointSlot { name: joint.name.clone(), twist: n + TILTS });
                    n += TILTS + 1;
                }
                Piece::Prismatic(_) => {
                    slides.push(n);
                    n += GUIDE_ROTATIONS + 1;
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
            slides,
            frames,
            lacking,
            template: Chain::new(&full, LinkModel::Full),
            with_mass: unit_masses(&full).iter().map(|s| Chain::new(s, LinkModel::Full)).collect(),
            gravity_m_s2: structure.gravity_m_s2,
        }
    }
}

/// The structure with every elastic element present, each with an arbitrary compliance. Lift-off of the feet and
/// water are left out.
fn with_everything(structure: &Structure) -> Structure {
    let mut full = structure.clone();
    full.base_tilt_rad_per_nm = 1.0;
    // lift-off of the feet acts on the coordinates of the base's tilts
    full.base_lift = None;
    full.water = None;
    for piece in &mut full.pieces {
        match piece {
            Piece::Joint(joint) => {
                joint.tilt_rad_per_nm = 1.0;
                joint.lean_rad_per_nm = [0.0; 2];
            }
            Piece::Prismatic(joint) => joint.guide_rad_per_nm = Vector3::from_element(1.0),
            Piece::Link(link) => {
                if let Some(beam) = &mut link.beam {
                    beam.flexibility = 1.0;
                }
            }
        }
    }
    full
}

/// For each mass that a fit can change, the structure with one unit of this mass added: the joints first, then
/// harnesses, travelling parts and water.
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
    let slides = full.prismatics().map(|joint| {
        let mut with = full.clone();
        if let Some(j) = with.prismatic_mut(&joint.name) {
            j.mass_kg += 1.0;
        }
        with
    });
    let water =
        Water { density_kg_m3: 1.0, added_mass_coefficient: 1.0, payload_density_kg_m3: f64::INFINITY };
    let wet = Structure { water: Some(water), ..full.clone() };
    joints.chain(links).chain(slides).chain([wet]).collect()
}

impl Coefficients {
    /// Expresses `subject` as numbers on the coordinates of `layout`. Its masses are given as differences from those
    /// of `nominal`.
    pub fn new(layout: &Layout, nominal: &Subject, subject: &Subject) -> Self {
        let structure = &subject.structure;
        let mut linear = vec![0.0; layout.n];
        // a frame of the nominal base has coordinates of its own; a further compliance of a subject's base is entered
        // as a tilt
        let further = structure.base_frame.0 - nominal.structure.base_frame.0;
        (0..2).for_each(|i| linear[i] = structure.base_tilt_rad_per_nm + further[(i, i)]);
        layout.frames.iter().for_each(|(at, compliance)| linear[*at] = *compliance);
        let mut masses = Vec::with_capacity(layout.with_mass.len());
        let mut laws = Vec::with_capacity(layout.joints.len());
        let mut torques = Vec::with_capacity(layout.joints.len());
        for ((slot, joint), before) in
            layout.joints.iter().zip(structure.joints()).zip(nominal.structure.joints())
        {
            let tilts = joint.lean_rad_per_nm.map(|lean| joint.tilt_rad_per_nm + lean);
            linear[slot.twist - TILTS..slot.twist].copy_from_slice(&tilts);
            laws.push(joint.law);
            torques.push(joint.torque.beyond(&before.torque));
            masses.push(joint.mass_kg - before.mass_kg);
        }
        for ((slot, link), before) in
            layout.links.iter().zip(structure.links()).zip(nominal.structure.links())
        {
            linear[slot.first..slot.first + slot.strains.len()].copy_from_slice(&link_compliances(link));
            masses.push(link.harness_kg_per_m - before.harness_kg_per_m);
        }
        for ((first, joint), before) in
            layout.slides.iter().zip(structure.prismatics()).zip(nominal.structure.prismatics())
        {
            let travel = first + GUIDE_ROTATIONS;
            linear[*first..travel].copy_from_slice(joint.guide_rad_per_nm.as_slice());
            linear[travel] = joint.m_per_n;
            masses.push(joint.mass_kg - before.mass_kg);
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
            lift: structure.base_lift,
            laws,
            torques,
            masses,
            weights,
            payload_delta_kg: subject.payload_delta_kg,
            payload_offset_m: subject.payload_offset_m,
            payload_weight,
            channels: subject.channels.clone(),
            tests: std::array::from_fn(|c| TestNumbers::of(&subject.setups[c], layout)),
            warming: subject.warming,
            turned_deg: Vec::new(),
            smoothing: 0.0,
        }
    }

    /// Actual minus stated centre of gravity of the payload in a row of a channel's file, counted from 0, in the last
    /// frame \[m\].
    pub(crate) fn payload_offset_in(&self, channel: Channel, row: usize) -> Vector3<f64> {
        self.payload_offset_m + slip_m(&self.tests[channel as usize].slipped, row)
    }

    /// Torsion law of a joint at the joint angle `angle_rad`, in the test that one row of a channel's file reports.
    pub(crate) fn law_at(&self, joint: usize, channel: Channel, angle_rad: f64, row: usize) -> JointLaw {
        let law = self.law(joint, channel).at_angle(angle_rad);
        match self.tests[channel as usize].softening_of(joint) {
            Some(softening) => law.softer(softening.factor(row)),
            None => law,
        }
    }

    /// Torsion law of a joint in a test of the channel `channel`, averaged over all joint angles.
    pub(crate) fn law(&self, joint: usize, channel: Channel) -> JointLaw {
        let mut law = self.laws[joint];
        if let Some(servo) = self.tests[channel as usize].servo_rad_per_nm.get(joint) {
            law.connection_rad_per_nm += servo;
        }
        law
    }

    /// Compares the numbers on which static readings depend with those of `other`, and says which of them differ. A
    /// difference of the weights counts only if it can change the readings.
    pub(crate) fn static_changes(&self, other: &Self) -> StaticChanges {
        let in_test = |c: &Self, joint: usize| {
            let test = &c.tests[Channel::Static as usize];
            (c.law(joint, Channel::Static), test.softening_of(joint), test.load_twists_of(joint).to_vec())
        };
        let laws: Vec<bool> = (0..self.laws.len()).map(|j| in_test(self, j) != in_test(other, j)).collect();
        let linear = self.linear != other.linear || self.warming != other.warming;
        let [own, others] = [self, other].map(|c| &c.tests[Channel::Static as usize]);
        let payload = self.payload_delta_kg != other.payload_delta_kg
            || self.payload_offset_m != other.payload_offset_m
            || self.payload_weight != other.payload_weight
            || own.slipped != others.slipped
            || own.loading != others.loading;
        // readings are differences from the unloaded arm, so weights have no effect where twists are proportional to
        // torques
        let is_proportional = |law: &JointLaw| !law.has_play() && !matches!(law.curve, Curve::Windup(_));
        let lift = self.lift != other.lift;
        let is_other = linear || payload || lift || laws.contains(&true);
        let is_heavier = (own.mass_kg, own.cg_m) != (others.mass_kg, others.cg_m)
            || self.weights != other.weights
            || self.torques != other.torques;
        let is_steady = [own, others].iter().all(|test| test.softening.is_empty());
        let is_linear = self.lift.is_none() && is_steady && self.laws.iter().all(is_proportional);
        let weights = is_heavier && (is_other || !is_linear);
        let mix = |c: &Self| c.channels[Channel::Static as usize].mix;
        let seen = own.turned != others.turned || mix(self) != mix(other);
        StaticChanges { linear, weights, payload, lift, laws, seen }
    }

    /// Whether all numbers on which natural frequencies depend are equal for this subject and `other`. The errors of
    /// the modal channel are not compared.
    pub fn same_modes(&self, other: &Self) -> bool {
        self.linear == other.linear
            && self.lift == other.lift
            && self.masses == other.masses
            && self.weights == other.weights
            && self.torques == other.torques
            && self.payload_delta_kg == other.payload_delta_kg
            && self.payload_offset_m == other.payload_offset_m
            && self.payload_weight == other.payload_weight
            && self.smoothing == other.smoothing
            && self.warming == other.warming
            && self.tests[Channel::Modal as usize] == other.tests[Channel::Modal as usize]
            && self.laws.iter().zip(&other.laws).all(|(a, b)| {
                a.curve == b.curve
                    && a.connection_rad_per_nm == b.connection_rad_per_nm
                    && a.lost_motion == b.lost_motion
                    && a.waves == b.waves
                    && a.further == b.further
            })
    }
}

fn link_compliances(link: &LinkPiece) -> Vec<f64> {
    compliances(link, LinkModel::Full)
}
