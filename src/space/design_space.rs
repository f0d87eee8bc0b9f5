//! What there is to choose: an arm with open links and drives, and the task it must do.

use super::constraint::Constraints;
use super::prismatic::SpacePrismatic;
use crate::arm::bearing::{Bearing, BearingSource};
use crate::arm::body::{JointBodies, RigidBody};
use crate::arm::effect::entry::Effect;
use crate::arm::extras::ExtrasSource;
use crate::arm::file::windup_of;
use crate::arm::joint_law::Curve;
use crate::arm::linkage::composed;
use crate::arm::load::Payload;
use crate::arm::load::Water;
use crate::arm::pose::{DrivenJoint, Motion};
use crate::arm::section::{LinkMaterial, Section};
use crate::arm::springs::{Side, Spring};
use crate::arm::structure::Beam;
use crate::arm::transmission::Stages;
use crate::arm::{JointModel, Link, LinkBody, LinkModel};
use crate::catalog::gear::Gear;
use crate::sizing::demand::JointMotion;
use crate::sizing::drive::Drive;
use crate::sizing::fit::FitRequirement;
use crate::sizing::requirement::MotionRequirement;
use crate::sizing::select::DriveFilter;
use crate::sizing::stated::StatedDuty;
use nalgebra::{Unit, Vector3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// An arm with open choices, the cases in which it is judged, and the limits that every design must keep.
///
/// A study file is the usual source: `read_study` and `resolve` of [`study`](crate::study) make a design space of it. A
/// program can also fill in the fields itself, as below: a steel upper arm of two possible walls on one given joint.
///
/// ```
/// use armwright::arm::{BearingSource, Curve, ExtrasSource, JointModel, LinkMaterial, LinkModel, Payload, Section};
/// use armwright::catalog::Catalogs;
/// use armwright::sizing::{FitRequirement, MotionRequirement};
/// use armwright::space::constraint::Constraints;
/// use armwright::space::design_space::{Case, DriveChoice, LinkChoice, LinkOption, SpaceJoint, SpacePiece};
/// use armwright::space::{ArmProblem, DesignSpace, evaluate};
/// use nalgebra::Vector3;
///
/// let steel = LinkMaterial {
///     youngs_modulus_pa: 2.1e11,
///     shear_modulus_pa: 8.1e10,
///     density_kg_m3: 7850.0,
///     poisson: 0.3,
/// };
/// let tube = |wall_m: f64| LinkOption {
///     material_index: 0,
///     material_name: "steel".into(),
///     material: steel,
///     section: Section::RectangularTube { width_m: 0.12, height_m: 0.12, wall_m },
///     profile: None,
///     strength_pa: Some(355e6),
///     compressive_strength_pa: None,
///     cost_eur_per_kg: None,
/// };
/// let drive = DriveChoice::Given { curve: Curve::Linear(405e3), mass_kg: 8.2, gear: None, motor: None };
/// let space = DesignSpace {
///     name: "one link".into(),
///     gravity_m_s2: 9.81,
///     down: -Vector3::z(),
///     pieces: vec![
///         SpacePiece::Joint(SpaceJoint {
///             name: "j2".into(),
///             axis: Vector3::y_axis(),
///             bearing: BearingSource::Stated(None),
///             extras: ExtrasSource::NONE,
///             bodies: Default::default(),
///             drive,
///             max_speed_rad_s: None,
///             range_deg: None,
///             has_brake: false,
///             duty: None,
///             fit: FitRequirement::default(),
///             connection_share: 0.0,
///             coupled: None,
///             stages: Default::default(),
///             motor_place: None,
///             turns_with: Vec::new(),
///         }),
///         SpacePiece::Choice(LinkChoice {
///             name: "upper_arm".into(),
///             vector_m: Vector3::new(0.8, 0.0, 0.0),
///             options: [tube(0.005), tube(0.010)].into(),
///             bodies: Vec::new(),
///             excerpt: None,
///         }),
///     ],
///     cases: vec![Case {
///         name: "stretched".into(),
///         pose_deg: vec![0.0],
///         payload: Payload { mass_kg: 5.0, ..Payload::default() },
///         tip_force_n: Vector3::zeros(),
///         tip_moment_nm: Vector3::zeros(),
///         water: None,
///     }],
///     judged_cases: vec![0],
///     sizing_cases: vec![0],
///     motion: MotionRequirement::default(),
///     links: LinkModel::Full,
///     joints: JointModel::ThreeSegment,
///     constraints: Constraints::default(),
///     effects: Vec::new(),
///     springs: Vec::new(),
/// };
/// assert_eq!(space.link_options(), 2);
/// let catalogs = Catalogs::builtin();
/// let problem = ArmProblem::new(&space, &catalogs);
/// let [thin, thick] = [0, 1].map(|number| evaluate(&problem, number).expect("this design holds").objectives);
/// assert!(thin.mass_kg < thick.mass_kg);
/// // the joint yields far more than the tube, and the heavier tube turns it further
/// assert!(thin.tip_deflection_m < thick.tip_deflection_m);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DesignSpace {
    /// Name of the arm.
    pub name: String,
    /// Gravity \[m/s²\].
    pub gravity_m_s2: f64,
    /// Direction of gravity in the world, a unit vector: -z for an arm that stands upright.
    pub down: Vector3<f64>,
    /// Joints and links from base to tip.
    pub pieces: Vec<SpacePiece>,
    /// Every case in which the arm is judged or sized.
    pub cases: Vec<Case>,
    /// Indices of the cases over which the objectives are taken. The worst of these cases counts.
    pub judged_cases: Vec<usize>,
    /// Indices of the cases in which joints are sized and stress is checked.
    pub sizing_cases: Vec<usize>,
    /// The motion that the tip must do; joints are sized for it.
    pub motion: MotionRequirement,
    /// Physics of the links.
    pub links: LinkModel,
    /// Physics of the joints.
    pub joints: JointModel,
    /// What every design must meet.
    pub constraints: Constraints,
    /// Physics beyond the nominal model. Effects that describe a test are left out of every calculation.
    pub effects: Vec<Effect>,
    /// Springs that balance every design; their elements are numbered as the pieces are.
    pub springs: Vec<Spring>,
}

/// One case of a study: a pose, a load, and what is around the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name.
    pub name: String,
    /// One entry per driven joint, base to tip: an angle \[deg\], or the travel of a prismatic joint \[mm\].
    pub pose_deg: Vec<f64>,
    /// What the arm holds.
    pub payload: Payload,
    /// Force at the tip, world \[N\].
    pub tip_force_n: Vector3<f64>,
    /// Moment at the tip, world \[N m\].
    pub tip_moment_nm: Vector3<f64>,
    /// The water the arm is in.
    pub water: Option<Water>,
}

/// One piece of the chain.
#[derive(Debug, Clone, PartialEq)]
pub enum SpacePiece {
    /// A joint.
    Joint(SpaceJoint),
    /// A prismatic joint, which the study gives.
    Prismatic(SpacePrismatic),
    /// A link or offset without a choice.
    Link(Link),
    /// A link whose material and section are chosen.
    Choice(LinkChoice),
}

impl SpacePiece {
    /// Name.
    pub fn name(&self) -> &str {
        match self {
            Self::Joint(joint) => &joint.name,
            Self::Prismatic(slide) => &slide.joint.name,
            Self::Link(link) => &link.name,
            Self::Choice(choice) => &choice.name,
        }
    }

    /// Where the motor of a drive that is sized stands, if not at its joint. The piece has this number.
    pub(crate) fn motor_place(&self, number: usize) -> Option<MotorPlace> {
        match self {
            Self::Joint(joint) => joint.motor_place,
            Self::Prismatic(slide) => {
                let stays = MotorPlace { piece: number, moves: false, point_m: Vector3::zeros() };
                slide.drive.as_ref().map(|_| stays)
            }
            Self::Link(_) | Self::Choice(_) => None,
        }
    }

    /// The choices of a link; `None` for a piece that leaves no section open.
    pub(crate) fn as_choice(&self) -> Option<&LinkChoice> {
        match self {
            Self::Choice(choice) => Some(choice),
            _ => None,
        }
    }

    /// The choices of a link, to be changed; `None` for a piece that leaves no section open.
    pub(crate) fn as_choice_mut(&mut self) -> Option<&mut LinkChoice> {
        match self {
            Self::Choice(choice) => Some(choice),
            _ => None,
        }
    }
}

/// A joint and how its drive is found.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceJoint {
    /// Name.
    pub name: String,
    /// Axis, in the frame that the joints before it carry.
    pub axis: Unit<Vector3<f64>>,
    /// Where the output bearing of the joint comes from.
    pub bearing: BearingSource,
    /// Where the masses beyond gear, motor and bearing come from.
    pub extras: ExtrasSource,
    /// Rigid bodies that the joint carries beyond all these.
    pub bodies: JointBodies,
    /// How the drive of the joint is found.
    pub drive: DriveChoice,
    /// Largest speed that the study asks for \[rad/s\]; `None`: the speed that follows from the tip's.
    pub max_speed_rad_s: Option<f64>,
    /// Smallest and largest angle to which the joint turns \[deg\]; `None`: not stated.
    pub range_deg: Option<[f64; 2]>,
    /// Whether a brake holds the joint at rest, so that the motor need not.
    pub has_brake: bool,
    /// A duty that the study states for this joint, in place of its cycle.
    pub duty: Option<StatedDuty>,
    /// What the study asks of the sizes of the joint's parts.
    pub fit: FitRequirement,
    /// Compliance of the connections at the joint as a share of that of its gear and its bearing. What the study states in
    /// numbers has it already.
    pub connection_share: f64,
    /// The angle of a passive joint: a sum of factors times the angles of driven joints inboard of it. `None` for a driven
    /// joint, which has an entry in every pose.
    pub coupled: Option<Vec<(String, f64)>>,
    /// Stages between motor, gear and joint. Those of a drive that is given yield in its curve already.
    pub stages: Stages,
    /// Where the motor of a drive that is sized stands, if not at the joint.
    pub motor_place: Option<MotorPlace>,
    /// How far a driven joint turns per turn of joints inboard of it while its own motor stands; empty unless its motor sits
    /// inboard of them.
    pub turns_with: Vec<(String, f64)>,
}

/// Where a motor stands that is not at its joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorPlace {
    /// Number of the piece that carries it.
    pub piece: usize,
    /// Whether it moves with that piece; if not, it stands where the chain begins.
    pub moves: bool,
    /// Where it is, from the start of the piece in the frame that it carries \[m\].
    pub point_m: Vector3<f64>,
}

/// How a joint's drive is found.
#[derive(Debug, Clone, PartialEq)]
pub enum DriveChoice {
    /// The study gives the drive in numbers, with the names of its parts if they are in a catalog.
    Given {
        /// Torsion curve.
        curve: Curve,
        /// Mass \[kg\].
        mass_kg: f64,
        /// Gear by name.
        gear: Option<String>,
        /// Motor by name.
        motor: Option<String>,
    },
    /// The lightest drive of the catalogs that holds (the paper's way).
    FirstFit(DriveFilter),
    /// Every drive of the catalogs that holds.
    AllFits(DriveFilter),
}

/// A link whose material and section are chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkChoice {
    /// Name.
    pub name: String,
    /// From root to end \[m\].
    pub vector_m: Vector3<f64>,
    /// The materials and sections to choose from; shared, so that a copy of a space of many is cheap.
    pub options: Arc<[LinkOption]>,
    /// Rigid bodies that the link carries, whichever tube it has.
    pub bodies: Vec<RigidBody>,
    /// The places of these options in the whole list; `None` if this is the whole list.
    pub excerpt: Option<Excerpt>,
}

/// Which options of a longer list were kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Excerpt {
    /// Place of each option in the whole list, ascending.
    pub places: Vec<u32>,
    /// Number of options in the whole list.
    pub of: u32,
}

/// One material and section.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkOption {
    /// Number of the material in the study. A material has the same number on every link.
    pub material_index: usize,
    /// Name of the material.
    pub material_name: String,
    /// Elastic properties and density of the material.
    pub material: LinkMaterial,
    /// Cross-section.
    pub section: Section,
    /// Designation, if the section is a catalog profile.
    pub profile: Option<String>,
    /// Strength of the material \[Pa\]; that in tension if it has another in compression.
    pub strength_pa: Option<f64>,
    /// Strength of the material in compression \[Pa\]; `None` if it is the same.
    pub compressive_strength_pa: Option<f64>,
    /// Cost of the material \[EUR/kg\].
    pub cost_eur_per_kg: Option<f64>,
}

impl SpaceJoint {
    /// Whether the bearing depends on the gear that is chosen.
    pub(crate) fn bearing_is_open(&self) -> bool {
        self.bearing == BearingSource::OfGear && self.drive.is_sized()
    }

    /// Torsion curve of the joint with a gear of the catalogs, its connections included; rigid if the gear has none.
    pub(crate) fn curve_with(&self, gear: &Gear) -> Curve {
        let yields = 1.0 + self.connection_share;
        let of_gear =
            windup_of(gear).map_or(Curve::Rigid, |windup| Curve::Windup(windup.stiffened(1.0 / yields)));
        of_gear.in_series(self.stages.before.rad_per_nm / (gear.ratio * gear.ratio))
    }

    /// Mass of what sits elsewhere than the joint with this drive \[kg\]: of a motor that does, its own.
    pub(crate) fn away_kg(&self, drive: &Drive) -> f64 {
        self.motor_place.and(drive.motor.mass_kg).unwrap_or(0.0)
    }

    /// Output bearing of the joint with a drive of the catalogs, its connections included.
    pub(crate) fn bearing_with(&self, drive: &Drive) -> Option<Bearing> {
        match self.bearing {
            BearingSource::Stated(bearing) => bearing,
            BearingSource::OfGear => {
                drive.bearing().map(|b| b.stiffened(1.0 / (1.0 + self.connection_share)))
            }
        }
    }

    /// The motion of the joint when its axis is at most `reach_m` \[m\] away from the tip.
    pub(crate) fn motion(&self, asked: &MotionRequirement, reach_m: f64) -> JointMotion {
        let motion = asked.joint_motion(reach_m, self.max_speed_rad_s);
        let motion = motion.of_joint(self.max_speed_rad_s, self.has_brake, self.duty.as_ref());
        JointMotion { fit: self.fit, ..motion }
    }
}

impl DriveChoice {
    /// Among which parts the drive is sized; `None` if it is given.
    pub(crate) fn filter(&self) -> Option<&DriveFilter> {
        match self {
            DriveChoice::FirstFit(filter) | DriveChoice::AllFits(filter) => Some(filter),
            DriveChoice::Given { .. } => None,
        }
    }

    /// Whether the search chooses the drive.
    pub fn is_open(&self) -> bool {
        matches!(self, DriveChoice::AllFits(_))
    }

    /// Whether the drive is found by sizing.
    pub fn is_sized(&self) -> bool {
        !matches!(self, DriveChoice::Given { .. })
    }
}

impl LinkOption {
    /// The tube as the mechanics sees it, without any effect.
    pub fn beam(&self) -> Beam {
        Beam { material: self.material, section: self.section, flexibility: 1.0 }
    }

    /// The option of a tube that the study gives: it has no strength and no cost.
    pub(crate) fn given(material: LinkMaterial, section: Section) -> Self {
        Self {
            material_index: 0,
            material_name: String::new(),
            material,
            section,
            profile: None,
            strength_pa: None,
            compressive_strength_pa: None,
            cost_eur_per_kg: None,
        }
    }

    /// The strength that a stress is compared with \[Pa\]. Bending pulls one side of a link and presses the other, so that
    /// the lower one counts.
    pub fn lower_strength_pa(&self) -> Option<f64> {
        let tensile_pa = self.strength_pa?;
        Some(self.compressive_strength_pa.map_or(tensile_pa, |pa| pa.min(tensile_pa)))
    }

    /// Mass per length \[kg/m\].
    pub fn mass_kg_per_m(&self) -> f64 {
        self.material.density_kg_m3 * self.section.properties(self.material.poisson).area_m2
    }

    /// Wall slenderness: the larger flat width (or the diameter) over the wall thickness. A bar has none.
    pub fn wall_slenderness(&self) -> f64 {
        let (width, height) = self.section.outer_m();
        let wall = self.section.wall_m();
        match self.section {
            Section::RectangularTube { .. } => (width.max(height) - 2.0 * wall) / wall,
            Section::RoundTube { .. } => width / wall,
            Section::RectangularBar { .. }
            | Section::RoundBar { .. }
            | Section::IBeam { .. }
            | Section::Stated(_) => 0.0,
        }
    }
}

/// A joint that turns another beside its own drive, by the numbers of their pieces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SpaceLinkage {
    pub driver: usize,
    pub passive: usize,
    /// Rotation of the passive joint per rotation of the driver.
    pub factor: f64,
}

/// A list in words; `None` if it is empty.
fn in_words(list: [Option<String>; 2]) -> Option<String> {
    let words: Vec<String> = list.into_iter().flatten().collect();
    (!words.is_empty()).then(|| words.join(" and "))
}

impl DesignSpace {
    /// Whether a joint turns with others: linkages turn it, or its motor sits beyond other joints.
    pub fn has_linkages(&self) -> bool {
        self.joints().any(|(_, joint)| joint.coupled.is_some() || !joint.turns_with.is_empty())
    }

    /// Whether a motor of a drive that is sized stands elsewhere than its joint, or at the end of a rail.
    pub fn has_motors_elsewhere(&self) -> bool {
        self.pieces.iter().any(|piece| piece.motor_place(0).is_some())
    }

    /// Whether the drive of a prismatic joint is sized.
    fn sizes_rails(&self) -> bool {
        self.pieces.iter().any(|piece| matches!(piece, SpacePiece::Prismatic(slide) if slide.drive.is_some()))
    }

    /// What the bounds of the exact search do not cover in this space, in words for people; `None` if they cover all of it.
    pub(crate) fn beyond_exact(&self) -> Option<String> {
        let is_known =
            |effect: &&Effect| effect.is_of_test() || effect.kind().is_none_or(|kind| kind.traits.in_bounds);
        let law = self.effects.iter().find(|effect| !is_known(effect)).map(Effect::label);
        let motors = match (self.sizes_rails(), self.has_motors_elsewhere()) {
            (true, _) => Some("rails whose drive is sized".to_string()),
            (false, elsewhere) => elsewhere.then(|| "motors that sit elsewhere than their joints".into()),
        };
        let turns = self.has_linkages().then(|| "joints that turn with others".to_string());
        in_words([in_words([turns, motors]), law])
    }

    /// What the bounds of the verifier and of the relaxation do not cover in this space, in words for people; `None` if they
    /// cover all of it.
    pub fn beyond_bounds(&self) -> Option<String> {
        in_words([self.beyond_exact(), (!self.springs.is_empty()).then(|| "springs".into())])
    }

    /// Whether a piece is a tube, or may be one.
    pub(crate) fn is_tube(&self, piece: usize) -> bool {
        match &self.pieces[piece] {
            SpacePiece::Choice(_) => true,
            SpacePiece::Link(link) => matches!(link.body, LinkBody::Tube { .. }),
            SpacePiece::Joint(_) | SpacePiece::Prismatic(_) => false,
        }
    }

    /// Whether a spring pulls on a tube.
    pub(crate) fn pulls_on_tubes(&self) -> bool {
        let on_tube = |side| matches!(side, Side::Moving(piece) if self.is_tube(piece));
        self.springs.iter().flat_map(Spring::sides).any(on_tube)
    }

    /// The joints with the numbers of their pieces, base to tip.
    pub(crate) fn joints(&self) -> impl Iterator<Item = (usize, &SpaceJoint)> {
        self.pieces.iter().enumerate().filter_map(|(piece, what)| match what {
            SpacePiece::Joint(joint) => Some((piece, joint)),
            _ => None,
        })
    }

    /// Every joint that turns another beside its own drive.
    pub(crate) fn linkages(&self) -> Vec<SpaceLinkage> {
        let named = |name: &str| self.joints().find(|(_, joint)| joint.name == name);
        let direct = |name: &str| {
            let terms =
                |(_, joint): (usize, &SpaceJoint)| joint.coupled.clone().unwrap_or(joint.turns_with.clone());
            named(name).map_or(Vec::new(), terms)
        };
        let of = |(passive, joint): (usize, &SpaceJoint)| -> Vec<SpaceLinkage> {
            let all = composed(&joint.name, &direct).into_iter();
            let linkage = |(name, factor): (String, f64)| {
                Some(SpaceLinkage { driver: named(&name)?.0, passive, factor })
            };
            all.filter_map(linkage).collect()
        };
        self.joints().flat_map(of).collect()
    }

    /// Every driven joint with its entry in the pose of a case \[rad, m\].
    fn entries_si(&self, case: &Case) -> Vec<(DrivenJoint, f64)> {
        let driven = self.pieces.iter().filter_map(|piece| match piece {
            SpacePiece::Joint(joint) if joint.coupled.is_none() => Some(DrivenJoint::turning(&joint.name)),
            SpacePiece::Prismatic(slide) => {
                Some(DrivenJoint { name: slide.joint.name.clone(), motion: Motion::Slides })
            }
            _ => None,
        });
        let entries = driven.zip(&case.pose_deg);
        entries.map(|(joint, entry)| (joint.clone(), joint.motion.si(*entry))).collect()
    }

    /// Travel of every prismatic joint in a case, base to tip \[m\].
    pub(crate) fn travels_m(&self, case: &Case) -> Vec<f64> {
        let entries = self.entries_si(case).into_iter();
        entries.filter(|(joint, _)| joint.motion == Motion::Slides).map(|(_, travel_m)| travel_m).collect()
    }

    /// Angle of every joint in a case, base to tip, those of passive joints too \[rad\].
    pub(crate) fn angles_rad(&self, case: &Case) -> Vec<f64> {
        let entries = self.entries_si(case);
        let of = |name: &String| {
            entries.iter().find(|(driver, _)| driver.name == *name).map_or(0.0, |(_, angle)| *angle)
        };
        let angle = |(_, joint): (usize, &SpaceJoint)| match &joint.coupled {
            None => of(&joint.name),
            Some(terms) => terms.iter().map(|(name, factor)| factor * of(name)).sum(),
        };
        self.joints().map(angle).collect()
    }

    /// Stress at peak load over stress at rest: by the paper's reading the acceleration a adds a/g times the static load.
    /// Without gravity no stress is limited, and the factor is 1.
    pub(crate) fn peak_factor(&self) -> f64 {
        match self.gravity_m_s2 > 0.0 {
            true => 1.0 + self.motion.tip_acceleration_m_s2() / self.gravity_m_s2,
            false => 1.0,
        }
    }

    /// Number of options of all open links together.
    pub fn link_options(&self) -> usize {
        let options = |piece: &SpacePiece| match piece {
            SpacePiece::Choice(choice) => choice.options.len(),
            _ => 0,
        };
        self.pieces.iter().map(options).sum()
    }

    /// Names of the materials that links can be made of, in the study's order.
    pub fn material_names(&self) -> Vec<String> {
        let choices = self.pieces.iter().filter_map(SpacePiece::as_choice);
        let options = choices.flat_map(|choice| choice.options.iter());
        let names: BTreeSet<_> = options.map(|o| (o.material_index, o.material_name.as_str())).collect();
        names.into_iter().map(|(_, name)| name.to_string()).collect()
    }
}
