//! The design space: an arm whose links and drives are open, the cases in which it is judged, and its limits.

use super::constraint::Constraints;
use super::prismatic::SpacePrismatic;
use crate::arm::bearing::{Bearing, BearingSource};
use crate::arm::body::{JointBodies, RigidBody};
use crate::arm::effect::entry::Effect;
use crate::arm::extras::ExtrasSource;
use crate::arm::file::windup_of;
use crate::arm::joint_law::Curve;
use crate::arm::linkage::composed;
use crate::arm::load::{Payload, Water};
use crate::arm::pose::{DrivenJoint, Motion};
use crate::arm::section::{LinkMaterial, Section};
use crate::arm::springs::{Side, Spring};
use crate::arm::structure::Beam;
use crate::arm::transmission::Stages;
use crate::arm::{JointModel, Link, LinkBody, LinkModel};
use crate::catalog::Catalogs;
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::motor::Motor;
use crate::sizing::demand::JointMotion;
use crate::sizing::drive::Drive;
use crate::sizing::fit::FitRequirement;
use crate::sizing::requirement::MotionRequirement;
use crate::sizing::select::DriveFilter;
use crate::sizing::stated::StatedDuty;
use nalgebra::{Unit, Vector3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// An arm with open choices, the cases in which it is judged, and the limits that every design must meet.
///
/// A study file is the usual source: `read_study` and `resolve` of [`study`](crate::study) turn it into a design
/// space. A program can also fill in the fields itself, as below. The example has a steel upper arm with a choice of
/// two walls, on one given joint.
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
///     strength: None,
///     class: None,
/// };
/// let tube = |wall_m: f64| LinkOption {
///     material_index: 0,
///     material_name: "steel".into(),
///     material: steel,
///     section: Section::RectangularTube { width_m: 0.12, height_m: 0.12, wall_m },
///     profile: None,
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
/// // the joint twists far more than the tube, and the heavier tube turns it further
/// assert!(thin.tip_deflection_m < thick.tip_deflection_m);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DesignSpace {
    /// Name of the arm.
    pub name: String,
    /// Gravitational acceleration \[m/s²\].
    pub gravity_m_s2: f64,
    /// Direction of gravity in the world, a unit vector: -z for an arm that stands upright.
    pub down: Vector3<f64>,
    /// Joints and links of the arm, from base to tip.
    pub pieces: Vec<SpacePiece>,
    /// Every case of the study: the cases in which the arm is judged and the cases in which it is sized.
    pub cases: Vec<Case>,
    /// Indices of the judged cases, over which the objectives are taken: the largest deflection and the smallest lowest
    /// mode of these cases count.
    pub judged_cases: Vec<usize>,
    /// Indices of the cases in which joints are sized and stress is checked.
    pub sizing_cases: Vec<usize>,
    /// The motion that the tip must be able to make. The drives are sized for it.
    pub motion: MotionRequirement,
    /// Model of the links: rigid, or with bending alone, or with all deformations.
    pub links: LinkModel,
    /// Model of the joints: which slopes of a torsion curve are used.
    pub joints: JointModel,
    /// The limits that every design must meet.
    pub constraints: Constraints,
    /// Effects: physics beyond the nominal model. Effects that describe a test are left out of every calculation.
    pub effects: Vec<Effect>,
    /// Springs that balance every design. The ends of a spring refer to elements by their indices in `pieces`.
    pub springs: Vec<Spring>,
}

/// One case of a study: a pose, a load, and the medium around the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name of the case.
    pub name: String,
    /// Pose of the arm: one entry per driven joint, base to tip. An entry is an angle \[deg\], or the travel of a
    /// prismatic joint \[mm\].
    pub pose_deg: Vec<f64>,
    /// The payload at the tip.
    pub payload: Payload,
    /// Force on the tip, in world axes \[N\].
    pub tip_force_n: Vector3<f64>,
    /// Moment on the tip, in world axes \[N m\].
    pub tip_moment_nm: Vector3<f64>,
    /// The water around the arm; `None` in air.
    pub water: Option<Water>,
}

/// One piece of the chain.
#[derive(Debug, Clone, PartialEq)]
pub enum SpacePiece {
    /// A joint that turns.
    Joint(SpaceJoint),
    /// A prismatic joint. The study gives its guide and masses; its drive is given or sized.
    Prismatic(SpacePrismatic),
    /// A given link, or a rigid offset.
    Link(Link),
    /// A link whose material and section the search chooses.
    Choice(LinkChoice),
}

impl SpacePiece {
    /// Name of the piece.
    pub fn name(&self) -> &str {
        match self {
            Self::Joint(joint) => &joint.name,
            Self::Prismatic(slide) => &slide.joint.name,
            Self::Link(link) => &link.name,
            Self::Choice(choice) => &choice.name,
        }
    }

    /// Place of the motor of this joint, if its drive is sized and the motor does not stand at the joint; otherwise
    /// `None`. `number` is the number of this piece.
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

    /// The choices of a link, to be changed. `None` for a piece that leaves no section open.
    pub(crate) fn as_choice_mut(&mut self) -> Option<&mut LinkChoice> {
        match self {
            Self::Choice(choice) => Some(choice),
            _ => None,
        }
    }
}

/// A joint that turns, and how its drive is found.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceJoint {
    /// Name of the joint.
    pub name: String,
    /// Axis of the joint, in the frame that the joints inboard of it carry along.
    pub axis: Unit<Vector3<f64>>,
    /// Where the output bearing of the joint comes from: it is stated, or it comes with the chosen gear.
    pub bearing: BearingSource,
    /// Where the masses of further parts at the joint come from, such as housing, brake, encoders and cables.
    pub extras: ExtrasSource,
    /// Rigid bodies at the joint, in addition to drive, bearing and extras.
    pub bodies: JointBodies,
    /// How the drive of the joint is found: given, by first fit (the lightest that meets the demand), or chosen by the
    /// search.
    pub drive: DriveChoice,
    /// Largest speed that the study asks of the joint \[rad/s\]; `None` if the speed follows from the speed of the
    /// tip.
    pub max_speed_rad_s: Option<f64>,
    /// Smallest and largest angle of the joint \[deg\]; `None` if the study does not state them.
    pub range_deg: Option<[f64; 2]>,
    /// Whether a brake holds the joint at rest, so that the motor does not need a holding torque.
    pub has_brake: bool,
    /// Duty that the study states for this joint in numbers; `None` if the duty follows from the study's cycle.
    pub duty: Option<StatedDuty>,
    /// Limits of the study on the sizes of the joint's parts.
    pub fit: FitRequirement,
    /// Compliance of the connections at the joint, as a fraction of the compliance of gear and bearing (0.1 is 10 %).
    /// Compliances that the study states in numbers include the connections already.
    pub connection_share: f64,
    /// For a passive joint, the driven joints inboard that turn it, each by name and with its factor: the angle of the
    /// passive joint is the sum of the factors times their angles. `None` for a driven joint, which has an entry in
    /// every pose.
    pub coupled: Option<Vec<(String, f64)>>,
    /// Stages (belts, chains, shafts or gears) between motor and gear, and between gear and joint. If the drive is
    /// given, its torsion curve already includes their compliance.
    pub stages: Stages,
    /// Place of the motor, if the drive is sized and the motor does not stand at the joint; otherwise `None`.
    pub motor_place: Option<MotorPlace>,
    /// The joints inboard that turn this driven joint along while its own motor stands still, each by name and with its
    /// factor: the angle of this joint per angle of the joint inboard. Empty unless the motor of this joint sits
    /// inboard of such joints.
    pub turns_with: Vec<(String, f64)>,
}

/// Where a motor stands that is not at its joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorPlace {
    /// Number of the piece on which the motor stands.
    pub piece: usize,
    /// Whether the motor moves with this piece. If not, it stands where the piece begins: at the base if the piece is
    /// the first one.
    pub moves: bool,
    /// Position of the motor \[m\], measured from the beginning of the piece, in the frame of the part on which it
    /// stands.
    pub point_m: Vector3<f64>,
}

/// How the drive of a joint is found.
#[derive(Debug, Clone, PartialEq)]
pub enum DriveChoice {
    /// The study gives the drive in numbers. It may name its gear and motor, if they are in a catalog.
    Given {
        /// Torsion curve of the drive.
        curve: Curve,
        /// Mass of the drive \[kg\].
        mass_kg: f64,
        /// Name of the gear; `None` if the study names none.
        gear: Option<String>,
        /// Name of the motor; `None` if the study names none.
        motor: Option<String>,
    },
    /// The lightest drive of the catalogs that meets the demand, as in the paper.
    FirstFit(DriveFilter),
    /// Every drive of the catalogs that meets the demand. The search chooses between them.
    AllFits(DriveFilter),
}

/// A link whose material and section the search chooses.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkChoice {
    /// Name of the link.
    pub name: String,
    /// Vector from the root to the end of the link \[m\].
    pub vector_m: Vector3<f64>,
    /// The materials and sections to choose from. Copies of a space share this list, because it may be long.
    pub options: Arc<[LinkOption]>,
    /// Rigid bodies attached to the link, the same for every option.
    pub bodies: Vec<RigidBody>,
    /// Which options of the whole list these are; `None` if this is the whole list.
    pub excerpt: Option<Excerpt>,
}

/// The options of a link that were kept in a reduced space, as places in the whole list of the link.
#[derive(Debug, Clone, PartialEq)]
pub struct Excerpt {
    /// Index of each kept option in the whole list, ascending.
    pub places: Vec<u32>,
    /// Number of options in the whole list.
    pub of: u32,
}

/// One material and cross-section of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkOption {
    /// Number of the material in the study. A material has the same number on every link.
    pub material_index: usize,
    /// Name of the material.
    pub material_name: String,
    /// Elastic properties and density of the material.
    pub material: LinkMaterial,
    /// Cross-section of the link.
    pub section: Section,
    /// Designation of the catalog profile; `None` if the section is not from a catalog.
    pub profile: Option<String>,
    /// Cost of the material \[EUR/kg\]; `None` if unknown.
    pub cost_eur_per_kg: Option<f64>,
}

impl SpaceJoint {
    /// Whether the output bearing depends on the gear that is chosen.
    pub(crate) fn bearing_is_open(&self) -> bool {
        self.bearing == BearingSource::OfGear && self.drive.is_sized()
    }

    /// Torsion curve of the joint with a catalog gear. It includes the compliance of the connections at the joint. The
    /// curve is rigid if the catalog has none for this gear.
    pub(crate) fn curve_with(&self, gear: &Gear) -> Curve {
        let softer = 1.0 + self.connection_share;
        let of_gear =
            windup_of(gear).map_or(Curve::Rigid, |windup| Curve::Windup(windup.stiffened(1.0 / softer)));
        of_gear.in_series(self.stages.before.rad_per_nm / (gear.ratio * gear.ratio))
    }

    /// The part of the mass of `drive` that does not sit at the joint \[kg\]: the mass of the motor if the motor stands
    /// elsewhere, otherwise 0.
    pub(crate) fn away_kg(&self, drive: &Drive) -> f64 {
        self.motor_place.and(drive.motor.mass_kg).unwrap_or(0.0)
    }

    /// Output bearing of the joint with a catalog drive. It includes the compliance of the connections at the joint.
    /// `None` if there is no bearing.
    pub(crate) fn bearing_with(&self, drive: &Drive) -> Option<Bearing> {
        match self.bearing {
            BearingSource::Stated(bearing) => bearing,
            BearingSource::OfGear => {
                drive.bearing().map(|b| b.stiffened(1.0 / (1.0 + self.connection_share)))
            }
        }
    }

    /// The motion of the joint that follows from the motion asked of the tip. The tip is at most `reach_m` \[m\] away
    /// from the axis of the joint.
    pub(crate) fn motion(&self, asked: &MotionRequirement, reach_m: f64) -> JointMotion {
        let motion = asked.joint_motion(reach_m, self.max_speed_rad_s);
        let motion = motion.of_joint(self.max_speed_rad_s, self.has_brake, self.duty.as_ref());
        JointMotion { fit: self.fit, ..motion }
    }
}

impl DriveChoice {
    /// The filter that selects the parts from which the drive is sized; `None` if the drive is given.
    pub(crate) fn filter(&self) -> Option<&DriveFilter> {
        match self {
            DriveChoice::FirstFit(filter) | DriveChoice::AllFits(filter) => Some(filter),
            DriveChoice::Given { .. } => None,
        }
    }

    /// Gear and motor of a given drive that names both, if both are in the catalogs. An actuator has both, so that its
    /// name as the gear suffices.
    pub(crate) fn named_parts<'c>(&self, catalogs: &'c Catalogs) -> Option<(&'c Gear, &'c Motor)> {
        let Self::Given { gear: Some(gear), motor, .. } = self else { return None };
        let gear = catalogs.gear(gear).ok()?;
        let of_actuator = (gear.kind == GearKind::Actuator).then_some(&gear.id);
        Some((gear, catalogs.motor(motor.as_ref().or(of_actuator)?).ok()?))
    }

    /// Whether the search chooses the drive.
    pub fn is_open(&self) -> bool {
        matches!(self, DriveChoice::AllFits(_))
    }

    /// Whether a drive from the catalogs is sized for the joint, by first fit or as a choice of the search.
    pub fn is_sized(&self) -> bool {
        !matches!(self, DriveChoice::Given { .. })
    }
}

impl LinkOption {
    /// The tube as the mechanics needs it, without any effect.
    pub fn beam(&self) -> Beam {
        Beam { material: self.material, section: self.section, flexibility: 1.0 }
    }

    /// A tube that the study gives, in the form of a link's only option. Its cost is unknown, so that no limit on
    /// the cost applies.
    pub(crate) fn given(material: LinkMaterial, section: Section) -> Self {
        Self {
            material_index: 0,
            material_name: String::new(),
            material,
            section,
            profile: None,
            cost_eur_per_kg: None,
        }
    }

    /// Mass of the link per length \[kg/m\].
    pub fn mass_kg_per_m(&self) -> f64 {
        self.material.density_kg_m3 * self.section.properties(self.material.poisson).area_m2
    }

    /// Wall slenderness: ratio of the larger flat width (or of the diameter) to the wall thickness. It is 0 for a
    /// section that is not a tube.
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

/// A driven joint, and another joint that turns along with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SpaceLinkage {
    /// Number of the piece that is the driven joint.
    pub driver: usize,
    /// Number of the piece that is the other joint. It is passive, or it is a driven joint whose motor sits inboard of
    /// the joint `driver`.
    pub passive: usize,
    /// Rotation of the other joint per rotation of the driven joint.
    pub factor: f64,
}

impl DesignSpace {
    /// Whether some joint turns along with others: a linkage turns it, or its motor sits inboard of other joints.
    pub fn has_linkages(&self) -> bool {
        self.joints().any(|(_, joint)| joint.coupled.is_some() || !joint.turns_with.is_empty())
    }

    /// Whether the motor of some sized drive does not stand at its joint. This is always so for a sized prismatic
    /// joint: its motor stays where the joint begins.
    pub fn has_motors_elsewhere(&self) -> bool {
        self.pieces.iter().any(|piece| piece.motor_place(0).is_some())
    }

    /// Whether a piece is a tube, or a link whose tube is chosen.
    pub(crate) fn is_tube(&self, piece: usize) -> bool {
        match &self.pieces[piece] {
            SpacePiece::Choice(_) => true,
            SpacePiece::Link(link) => matches!(link.body, LinkBody::Tube { .. }),
            SpacePiece::Joint(_) | SpacePiece::Prismatic(_) => false,
        }
    }

    /// Whether a balancing spring pulls on a tube.
    pub(crate) fn pulls_on_tubes(&self) -> bool {
        let on_tube = |side| matches!(side, Side::Moving(piece) if self.is_tube(piece));
        self.springs.iter().flat_map(Spring::sides).any(on_tube)
    }

    /// The joints that turn, each with the number of its piece, base to tip.
    pub(crate) fn joints(&self) -> impl Iterator<Item = (usize, &SpaceJoint)> {
        self.pieces.iter().enumerate().filter_map(|(piece, what)| match what {
            SpacePiece::Joint(joint) => Some((piece, joint)),
            _ => None,
        })
    }

    /// All pairs of a driven joint and another joint that turns along with it.
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

    /// Every driven joint with its entry in the pose of a case: an angle \[rad\], or the travel of a prismatic joint
    /// \[m\].
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

    /// Travel of every prismatic joint in the pose of a case, base to tip \[m\].
    pub(crate) fn travels_m(&self, case: &Case) -> Vec<f64> {
        let entries = self.entries_si(case).into_iter();
        entries.filter(|(joint, _)| joint.motion == Motion::Slides).map(|(_, travel_m)| travel_m).collect()
    }

    /// Angle of every joint in a case, base to tip \[rad\]. The angles of passive joints are included.
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

    /// Ratio of the stress at peak load to the stress at rest. As the paper does, it assumes that an acceleration a
    /// of the tip adds a/g times the static load. Without gravity no stress is limited, and the ratio is 1.
    pub(crate) fn peak_factor(&self) -> f64 {
        match self.gravity_m_s2 > 0.0 {
            true => 1.0 + self.motion.tip_acceleration_m_s2() / self.gravity_m_s2,
            false => 1.0,
        }
    }

    /// Number of options of all open links, added up.
    pub fn link_options(&self) -> usize {
        let options = |piece: &SpacePiece| match piece {
            SpacePiece::Choice(choice) => choice.options.len(),
            _ => 0,
        };
        self.pieces.iter().map(options).sum()
    }

    /// Names of the materials that links can be made of, in the order of the study.
    pub fn material_names(&self) -> Vec<String> {
        let choices = self.pieces.iter().filter_map(SpacePiece::as_choice);
        let options = choices.flat_map(|choice| choice.options.iter());
        let names: BTreeSet<_> = options.map(|o| (o.material_index, o.material_name.as_str())).collect();
        names.into_iter().map(|(_, name)| name.to_string()).collect()
    }
}
