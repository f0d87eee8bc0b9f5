//! Data that all designs of a question have in common, and the options of each joint and tube.

use super::bearing_loads::{Mover, PosedBearing, bearings};
use super::carriers::{carriers, is_tube};
use super::drives::{DriveOptions, Ties};
use super::duty::{Duty, stop_ratio};
use super::layout::{Coordinate, Layout, coordinates};
use super::offers::JointOffers;
use super::parts_box::Place;
use super::pose::{Builder, Pose, water_of};
use super::question::{AskedJoint, AskedMotion, AskedPiece, AskedRail, Limits, Question};
use super::tubes::TubeOptions;
use crate::arm::LinkBody;
use crate::arm::body::total_kg;
use crate::arm::load::Water;
use crate::arm::structure::{Piece, Structure};
use crate::catalog::Catalogs;

/// An arm without its drives and tubes: everything that is the same in all designs.
pub(super) struct Skeleton {
    /// Lengths of the tubes \[m\].
    pub lengths_m: Vec<f64>,
    /// Mass of rigid offsets, rigid bodies, prismatic joints, and bearings that the study states \[kg\].
    pub offsets_kg: f64,
    pub poses: Vec<Pose>,
    /// Loads on the bearing of every joint; first index the case, second the joint. The list of a case that is not a
    /// sizing case is empty, and a bearing that is not checked is `None`.
    pub bearings: Vec<Vec<Option<PosedBearing>>>,
    /// For each joint, the lever of the loads on its bearing.
    pub levers: Vec<Lever>,
    /// Index of the first tube between each joint and the next; `None` if there is none.
    pub first_tubes: Vec<Option<usize>>,
    /// The distinct media around the arm in the cases: `None` is air.
    pub waters: Vec<Option<Water>>,
    pub coordinates: Vec<Coordinate>,
    /// Stiffnesses of the springs that are the same in all designs \[N m/rad\]; \[N/m\] for a spring that slides.
    pub spring_stiffnesses: Vec<f64>,
    pub limits: Limits,
    /// The joint or tube whose part each level chooses, tip first.
    pub levels: Vec<Place>,
}

/// The options of each joint and of each tube, base to tip.
pub(super) struct Parts {
    pub joints: Vec<DriveOptions>,
    pub tubes: Vec<TubeOptions>,
}

/// Lever of the loads on a joint's bearing: the distance along the axis from the face of the joint's flange to the
/// point where the link attaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Lever {
    /// The distance that the study states \[m\]. It is measured from the centre of the bearing. Zero if the study
    /// states none and no tube follows the joint directly.
    Stated(f64),
    /// Half the width of the tube with this index (in the list of links with weight along their length).
    HalfOf(usize),
}

impl Skeleton {
    /// Puts the arm of a question into each of its cases. `offers` are the drives of its joints.
    pub(super) fn new(question: &Question, offers: &[JointOffers]) -> Self {
        let structure = question.nominal_structure();
        let mut waters: Vec<Option<Water>> = Vec::new();
        for water in question.cases.iter().map(|case| water_of(&structure, case)) {
            if !waters.contains(&water) {
                waters.push(water);
            }
        }
        let mut skeleton = Self {
            lengths_m: tube_lengths_m(&structure),
            offsets_kg: offsets_kg(question),
            poses: Vec::new(),
            bearings: Vec::new(),
            levers: levers(question),
            first_tubes: first_tubes(question),
            waters,
            coordinates: Vec::new(),
            spring_stiffnesses: Vec::new(),
            limits: question.limits,
            levels: levels(question, &structure),
        };
        if let Some(case) = question.cases.first() {
            let layout = Layout::new(&structure, case);
            let tilting: Vec<bool> = offers.iter().map(JointOffers::tilts).collect();
            skeleton.coordinates = coordinates(&layout, question.links, &tilting);
            skeleton.spring_stiffnesses = layout.springs.iter().map(|s| 1.0 / s.compliance).collect();
        }
        skeleton.pose_all(question, &structure, offers);
        skeleton
    }

    fn pose_all(&mut self, question: &Question, structure: &Structure, offers: &[JointOffers]) {
        let checked: Vec<bool> = offers.iter().map(JointOffers::checks_bearing).collect();
        let movers = movers(question);
        for (index, case) in question.cases.iter().enumerate() {
            let layout = Layout::new(structure, case);
            let builder = Builder::new(question, structure, case, &layout, &self.coordinates);
            let water = self.waters.iter().position(|other| *other == water_of(structure, case));
            let pose = Pose::new(question, index, water.unwrap_or_default(), &builder);
            self.bearings.push(match pose.sizing {
                true => bearings(&builder, case, &checked, &movers),
                false => Vec::new(),
            });
            self.poses.push(pose);
        }
    }

    /// The options of every joint and tube of the question. `offers` are the drives that the catalogs offer for each
    /// joint, and `ties` tells whether drives that no objective tells apart are one option.
    pub(super) fn parts(&self, question: &Question, offers: &[JointOffers], ties: Ties) -> Parts {
        let level = |place: Place| self.levels.iter().position(|other| *other == place);
        let joints = offers.iter().enumerate().map(|(joint, offers)| {
            DriveOptions::new(offers, level(Place::Joint(joint)).unwrap_or_default(), ties)
        });
        let mut tubes = Vec::new();
        for (carrier, piece) in carriers(question) {
            match piece {
                AskedPiece::Joint(_) | AskedPiece::Prismatic(_) => {}
                AskedPiece::Choice(choice) => {
                    let level = level(Place::Tube(tubes.len())).unwrap_or_default();
                    tubes.push(TubeOptions::of_choice(question, carrier, choice, level, &self.waters));
                }
                AskedPiece::Link(link) => {
                    tubes.extend(TubeOptions::of_link(question, carrier, link, &self.waters));
                }
            }
        }
        Parts { joints: joints.collect(), tubes }
    }
}

/// For each joint, base to tip: the first tube between it and the next joint, as an index into the list of links with
/// weight along their length. `None` if there is no tube between the two joints.
fn first_tubes(question: &Question) -> Vec<Option<usize>> {
    let mut first: Vec<Option<usize>> = Vec::new();
    let mut tubes = 0;
    for (carrier, piece) in carriers(question) {
        let has_line = match piece {
            AskedPiece::Joint(_) => {
                first.push(None);
                false
            }
            AskedPiece::Prismatic(_) => false,
            AskedPiece::Choice(_) => true,
            AskedPiece::Link(link) => super::layout::has_line(&question.link_piece(link.clone())),
        };
        if let (true, Some(_), Some(last)) = (is_tube(piece), carrier.of_first_tube, first.last_mut()) {
            *last = Some(tubes);
        }
        tubes += usize::from(has_line);
    }
    first
}

/// The lever of the loads on the bearing of every joint, base to tip.
fn levers(question: &Question) -> Vec<Lever> {
    let mut levers = Vec::new();
    let mut tubes = 0;
    for (carrier, piece) in carriers(question) {
        let is_tube = match piece {
            AskedPiece::Joint(joint) => {
                let offset_m = joint.bearing.stated().and_then(|bearing| bearing.offset_m);
                levers.push(Lever::Stated(offset_m.unwrap_or(0.0).abs()));
                false
            }
            AskedPiece::Prismatic(_) => false,
            AskedPiece::Choice(_) => true,
            AskedPiece::Link(link) => super::layout::has_line(&question.link_piece(link.clone())),
        };
        let is_stated = |joint: &AskedJoint| joint.bearing.stated().is_some_and(|b| b.offset_m.is_some());
        if is_tube && carrier.next.is_some_and(|joint| !is_stated(joint)) {
            levers.pop();
            levers.push(Lever::HalfOf(tubes));
        }
        tubes += usize::from(is_tube);
    }
    levers
}

/// How every joint and every rail moves in its ramp and in its stop: the joints base to tip, then the rails.
fn movers(question: &Question) -> Vec<Mover> {
    let joints = question.joints().zip(reaches_m(question));
    let turning = joints.enumerate().map(|(number, (joint, reach_m))| {
        let duty = Duty::new(&question.motion, reach_m, joint);
        Mover {
            coordinate: Coordinate::Joint(number),
            acceleration_per_s2: duty.acceleration_rad_s2,
            stop_factor: duty.stop_factor,
        }
    });
    let rails = question.pieces.iter().filter_map(|piece| match piece {
        AskedPiece::Prismatic(rail) => Some(rail),
        _ => None,
    });
    let sliding = rails.enumerate().map(|(number, rail)| sliding(number, rail, &question.motion));
    turning.chain(sliding).collect()
}

/// How `rail`, which has this number, moves: as fast as the study asks of it or else as fast as the tip, with the tip's
/// ramp time and the tip's emergency stop.
fn sliding(number: usize, rail: &AskedRail, motion: &AskedMotion) -> Mover {
    let acceleration_m_s2 = rail.max_speed_m_s.unwrap_or(motion.tip_speed_m_s) / motion.ramp_time_s;
    Mover {
        coordinate: Coordinate::Rail(number),
        acceleration_per_s2: acceleration_m_s2,
        stop_factor: stop_ratio(motion, acceleration_m_s2).max(1.0),
    }
}

/// The drives of every joint, base to tip.
pub(super) fn joint_offers(question: &Question, catalogs: &Catalogs) -> Vec<JointOffers> {
    let reaches_m = reaches_m(question);
    let joints = question.joints().zip(reaches_m);
    joints.map(|(joint, reach_m)| JointOffers::new(question, joint, reach_m, catalogs)).collect()
}

/// Reach of each joint \[m\]: the largest distance of the tip from the joint's axis over the sizing cases.
fn reaches_m(question: &Question) -> Vec<f64> {
    let structure = question.nominal_structure();
    let mut reaches_m = vec![0.0f64; question.joints().count()];
    for &case in &question.sizing_cases {
        let layout = Layout::new(&structure, &question.cases[case]);
        for (reach_m, joint) in reaches_m.iter_mut().zip(&layout.joints) {
            *reach_m = reach_m.max(joint.axis.cross(&(layout.tip_m - joint.at_m)).norm());
        }
    }
    reaches_m
}

fn tube_lengths_m(structure: &Structure) -> Vec<f64> {
    let lengths = structure.pieces.iter().filter_map(|piece| match piece {
        Piece::Link(link) if super::layout::has_line(link) => Some(link.vector_m.norm()),
        _ => None,
    });
    lengths.collect()
}

fn offsets_kg(question: &Question) -> f64 {
    let masses = question.pieces.iter().map(|piece| match piece {
        AskedPiece::Link(link) => match link.body {
            LinkBody::Offset { mass_kg } => mass_kg + total_kg(&link.bodies),
            LinkBody::Tube { .. } => total_kg(&link.bodies),
        },
        AskedPiece::Joint(joint) => {
            joint.bearing.stated().map_or(0.0, |bearing| bearing.mass_kg) + joint.bodies.mass_kg()
        }
        AskedPiece::Prismatic(rail) => rail.joint.total_mass_kg(),
        AskedPiece::Choice(choice) => total_kg(&choice.bodies),
    });
    masses.sum()
}

/// For each level of the search, tip first: the joint or link whose part is chosen at this level.
fn levels(question: &Question, structure: &Structure) -> Vec<Place> {
    let (mut joints, mut tubes, mut levels) = (0, 0, Vec::new());
    for (asked, piece) in question.pieces.iter().zip(&structure.pieces) {
        let place = match piece {
            Piece::Joint(_) => {
                joints += 1;
                Place::Joint(joints - 1)
            }
            Piece::Prismatic(_) => continue,
            Piece::Link(link) => {
                // A link without any admitted tube has no weight along its length, but it still has a level.
                let is_tube = matches!(asked, AskedPiece::Choice(_)) || super::layout::has_line(link);
                tubes += usize::from(is_tube);
                Place::Tube(tubes.saturating_sub(1))
            }
        };
        if asked.is_choice() {
            levels.push(place);
        }
    }
    levels.reverse();
    levels
}
