//! Compiles a design space into the [`Problem`] of branch and bound.

use super::box_work::BoxWork;
use super::compile_pose::{JointNeeds, harness_kg};
use super::joint_play::JointPlay;
use super::kinds::{Kinds, Ties};
use super::lowest_eigenvalue::CaseInertia;
use super::parts::{DriveBox, LinkBox, RIGID_RAD_PER_NM, Rays};
use super::pose::Pose;
use super::problem::{Ladder, Lever, Part, Problem, Room};
use super::shape::Ideal;
use super::torsion::{BreakPoints, CurveBox};
use super::tree::Tree;
use crate::arm::LinkBody;
use crate::arm::joint_law::Curve;
use crate::catalog::Catalogs;
use crate::sizing::bearing::BearingLimits;
use crate::sizing::demand::JointMotion;
use crate::sizing::fit::LinkRoom;
use crate::space::bearing_loads::Lever as LeverByOption;
use crate::space::design_space::{DesignSpace, LinkOption, SpaceJoint, SpacePiece};
use crate::space::effects::Layer;
use crate::space::fit::RoomAtJoint;
use crate::space::joints::TabulatedJoints;
use crate::space::slot::{SizedJoint, Slot};
use crate::space::station::reaches_m;
use std::sync::Arc;

/// The joints of a chain with their drives, before anything is compiled. Every list has one entry for each piece of the
/// chain, base to tip.
struct Joints<'c> {
    /// For each joint, its given drive or the drives that it may have; `None` for any other piece, and after the joint
    /// was compiled.
    slots: Vec<Option<Slot<'c>>>,
    /// What a compiled pose needs to know of each joint: how it accelerates, and whether its bearing tilts or is
    /// checked. Default values for a piece that is not a joint.
    needs: Vec<JointNeeds>,
    /// For each joint whose bearing is checked, its lever for each option of the link outboard. The lever is the
    /// distance along the joint's axis from the face of its flange to the point where the link attaches. `None` for any
    /// other piece.
    levers: Vec<Option<LeverByOption>>,
    /// The space for gear and motor at each joint whose drives must fit into a link, for each option of that link;
    /// `None` for any other piece.
    rooms: Vec<Option<RoomAtJoint>>,
    /// The number of each piece in the compiled problem, which counts from the tip.
    numbers: Vec<usize>,
}

impl<'c> Joints<'c> {
    /// Collects the joints of a space. `tabulated` has the drives of each joint with the loads that they can carry.
    fn new(space: &'c DesignSpace, tabulated: &TabulatedJoints<'c>) -> Self {
        let numbers = piece_numbers(space);
        let sizing = space.sizing_cases.iter().map(|&i| &space.cases[i]);
        let mut reaches_m = reaches_m(space, sizing).into_iter();
        let room = |place| RoomAtJoint::new(&space.pieces, place, &numbers);
        let rooms = (0..space.pieces.len()).map(room).collect();
        let mut joints =
            Self { slots: Vec::new(), needs: Vec::new(), levers: Vec::new(), rooms, numbers: Vec::new() };
        for (place, piece) in space.pieces.iter().enumerate() {
            let (SpacePiece::Joint(joint), Some(slot)) = (piece, tabulated.slot(place)) else {
                joints.slots.push(None);
                joints.needs.push(JointNeeds::without_bearing(space, piece));
                joints.levers.push(None);
                continue;
            };
            let reach_m = reaches_m.next().unwrap_or_default();
            let needs = JointNeeds::of(space, joint, reach_m, &slot);
            let lever = needs.is_checked.then(|| LeverByOption::new(space, place, joint, &numbers));
            joints.slots.push(Some(slot));
            joints.needs.push(needs);
            joints.levers.push(lever);
        }
        Self { numbers, ..joints }
    }

    /// The space that the link at `place` leaves with this option for gear and motor of the joint inboard. Unlimited if
    /// no joint has to fit its drive into this link.
    fn room(&self, place: usize, option: usize) -> LinkRoom {
        let mut rooms = self.rooms[..place].iter().flatten();
        let room = rooms.find(|room| room.link_slot == self.numbers[place]);
        room.and_then(|room| room.rooms.get(option)).copied().unwrap_or(LinkRoom::ANY)
    }

    /// The lever that the link at `place` has with this option \[m\]. The lever is a distance along the axis of the
    /// joint directly inboard: from the face of the joint's flange to the point where the link attaches. It is 0 if the
    /// bearing of this joint is not checked.
    fn lever_m(&self, place: usize, option: usize) -> f64 {
        let inboard = place.checked_sub(1).and_then(|inboard| self.levers[inboard].as_ref());
        inboard.and_then(|lever| lever.lever_m.get(option)).copied().unwrap_or_default()
    }
}

impl JointNeeds {
    /// The data of a piece that is no joint with an output bearing. Only a rail moves; its acceleration and its stop
    /// load the bearings of other joints.
    fn without_bearing(space: &DesignSpace, piece: &SpacePiece) -> Self {
        match piece {
            SpacePiece::Prismatic(rail) => Self::moving(&rail.motion(&space.motion)),
            _ => Self::default(),
        }
    }

    /// The data of a joint that moves as `motion` says and whose bearing is rigid and not checked.
    fn moving(motion: &JointMotion) -> Self {
        Self {
            acceleration_rad_s2: motion.acceleration_rad_s2,
            stop_factor: motion.stop.factor,
            ..Self::default()
        }
    }

    /// The data of `joint` that a compiled pose needs. `slot` is its place in the arm, with its drives. `reach_m` is
    /// the distance of the tip from the joint's axis \[m\]; the angular acceleration follows from it and the tip's
    /// acceleration.
    fn of(space: &DesignSpace, joint: &SpaceJoint, reach_m: f64, slot: &Slot) -> Self {
        let of_gear = Self::moving(&joint.motion(&space.motion, reach_m));
        let Slot::Sized(sized) = slot else { return of_gear };
        let limits = (0..sized.table.len()).map(|i| sized.table.limits(i).bearing);
        Self {
            // A bearing that the study states is a separate spring in the chain.
            tilts: joint.bearing_is_open() && sized.tilts_rad_per_nm.iter().any(|tilt| *tilt > 0.0),
            is_checked: limits.into_iter().any(|limits| limits != BearingLimits::NONE),
            ..of_gear
        }
    }
}

impl<'c> Problem<'c> {
    /// Prepares a space for the exact search, with only those link options for which `takes` is true. `ties` tells
    /// whether drives of equal mass, torsion curve and bearing stiffness become one option. `None` if some level
    /// (choice) has no option, or if this search cannot treat a piece of the arm.
    pub(super) fn new(
        space: &'c DesignSpace,
        catalogs: &'c Catalogs,
        takes: &dyn Fn(&LinkOption) -> bool,
        ties: Ties,
    ) -> Option<Self> {
        Self::with_joints(space, &TabulatedJoints::new(space, catalogs), takes, ties)
    }

    /// Does the same as [`new`](Self::new), for joints whose drives are tabulated already.
    pub(super) fn with_joints(
        space: &'c DesignSpace,
        tabulated: &TabulatedJoints<'c>,
        takes: &dyn Fn(&LinkOption) -> bool,
        ties: Ties,
    ) -> Option<Self> {
        let mut joints = Joints::new(space, tabulated);
        let poses = (0..space.cases.len()).map(|i| Pose::new(space, i, &joints.needs)).collect();
        let mut problem = Self {
            space,
            parts: Vec::new(),
            level_pieces: Vec::new(),
            level_sizes: Vec::new(),
            poses: Arc::new(poses),
            inertias: Arc::default(),
            peak_factor: space.peak_factor(),
            lighter_is_better: false,
            joint_plays: Vec::new(),
            levers: Vec::new(),
            rooms: Vec::new(),
            force_bounds: Arc::default(),
        };
        for (place, layer) in space.layers() {
            // The tilts of a gear's bearing are coordinates of its joint, so they make no part of their own.
            if let Layer::Bearing(_) = layer {
                continue;
            }
            let part = problem.part((place, layer), &mut joints, takes, ties)?;
            match layer {
                Layer::Piece(SpacePiece::Joint(joint)) => problem.push_joint(part, joint, &joints, place),
                _ => problem.push(part),
            }
            // A harness moves and weighs with its link, so the inertia of the link includes it. The mass of a design
            // does not include it, so a negative offset subtracts it from the sum of masses.
            if let Layer::Piece(piece) = layer
                && let Some(harness_kg) = harness_kg(space, piece)
            {
                problem.push(Part::Offset { mass_kg: -harness_kg });
            }
        }
        problem.lighter_is_better = problem.grows_with_weight();
        Some(problem.with_inertias())
    }

    /// Compiles one layer of the chain: the piece at `place`, or a spring, a mass or a load that belongs to this piece.
    /// The drives of a joint are taken out of `joints`. `takes` and `ties` have the same meaning as in
    /// [`new`](Self::new). `None` if a choice has no option, or if this search cannot treat the layer.
    fn part(
        &mut self,
        (place, layer): (usize, Layer<'c>),
        joints: &mut Joints<'c>,
        takes: &dyn Fn(&LinkOption) -> bool,
        ties: Ties,
    ) -> Option<Part<'c>> {
        Some(match layer {
            Layer::Piece(SpacePiece::Joint(_)) => {
                self.joint(joints.slots[place].take()?, joints.needs[place].tilts, ties)?
            }
            Layer::Piece(SpacePiece::Prismatic(slide)) => {
                Part::Given { mass_kg: 0.0, curve: CurveBox::of(&self.space.slide_law(slide)) }
            }
            Layer::Piece(piece) => {
                let leaves = |option| (joints.lever_m(place, option), joints.room(place, option));
                self.link(piece, takes, leaves)?
            }
            Layer::Tilt(tilt) => Part::Given { mass_kg: 0.0, curve: CurveBox::of(&tilt.law()) },
            Layer::Guide(spring) => Part::Given { mass_kg: 0.0, curve: CurveBox::of(&spring.law()) },
            // A given mass that belongs to no part loads the arm, but is not counted in the mass of a design.
            Layer::Mass(_) | Layer::Travelling(_) | Layer::Springs(_) => Part::Offset { mass_kg: 0.0 },
            Layer::Extra(mass_kg) => Part::Offset { mass_kg },
            Layer::Bodies(bodies) => Part::Offset { mass_kg: bodies.mass_kg() },
            // This search cannot treat a motor that stands away from its joint. The tilts of a gear's bearing belong to
            // its joint.
            Layer::Motor(_) | Layer::Bearing(_) => return None,
        })
    }

    /// Adds the compiled part of the joint at `place`, together with its play. Also adds two things that depend on the
    /// link outboard: the lever of the joint's bearing, and the space for its drive.
    fn push_joint(&mut self, part: Part<'c>, joint: &SpaceJoint, joints: &Joints<'c>, place: usize) {
        self.levers.push(joints.levers[place].as_ref().map(|lever| self.lever(lever)));
        self.rooms.push(joints.rooms[place].as_ref().map(|room| self.room_at(room)));
        self.parts.push(part);
        // Play (lost motion and friction) belongs to the joint and is the same for every drive.
        self.joint_plays.push(JointPlay::of(&self.space.joint_piece(joint, Curve::Linear(1.0), None).law));
    }

    /// Adds a compiled part that is not a joint. Such a part has no play, no bearing with a lever, and no drive that
    /// must fit into a link.
    fn push(&mut self, part: Part<'c>) {
        self.levers.push(None);
        self.rooms.push(None);
        self.parts.push(part);
        self.joint_plays.push(None);
    }

    /// Compiles the joint in `slot`. `tilts` tells whether its bearing tilts with some drive. `ties` tells whether
    /// drives of equal mass, torsion curve and bearing stiffness become one option. `None` if the joint has no drive.
    fn joint(&mut self, slot: Slot<'c>, tilts: bool, ties: Ties) -> Option<Part<'c>> {
        match slot {
            Slot::Given { law, mass_kg } => Some(Part::Given { mass_kg, curve: CurveBox::of(&law) }),
            Slot::Sized(sized) if sized.all_fits => self.drives(sized, tilts, ties),
            Slot::Sized(sized) => self.first_fit(sized, tilts),
            Slot::Link { .. } | Slot::Offset { .. } | Slot::Bearing { .. } | Slot::Motor { .. } => None,
        }
    }

    /// Finds out on which link of the compiled problem the lever of a joint depends. That link is compiled already,
    /// because compilation goes inward from the tip.
    fn lever(&self, lever: &LeverByOption) -> Lever {
        match lever.link_slot {
            Some(link) if matches!(self.parts[link], Part::Links { .. }) => Lever::OfLink(link),
            _ => Lever::Given(lever.lever_m[0]),
        }
    }

    /// Finds out on which link of the compiled problem the space at a joint depends. That link is compiled already,
    /// because compilation goes inward from the tip.
    fn room_at(&self, room: &RoomAtJoint) -> Room {
        match &self.parts[room.link_slot] {
            Part::Links { .. } => Room::OfLink(room.link_slot),
            _ => Room::Given(room.rooms[0]),
        }
    }

    /// Compiles a link of the chain with the options for which `takes` is true. For the index of an option, `leaves`
    /// returns two values: the lever of the loads on the bearing of the joint inboard \[m\], and the space that the
    /// link leaves for the drive of this joint. `None` if no option is admitted.
    fn link(
        &mut self,
        piece: &'c SpacePiece,
        takes: &dyn Fn(&LinkOption) -> bool,
        leaves: impl Fn(usize) -> (f64, LinkRoom),
    ) -> Option<Part<'c>> {
        let space = self.space;
        let slender = |option: &LinkOption| {
            space.constraints.wall_slenderness_max.is_some_and(|max| option.wall_slenderness() > max)
        };
        match piece {
            SpacePiece::Joint(_) | SpacePiece::Prismatic(_) => None,
            SpacePiece::Choice(choice) => {
                let options = self.level(choice.options.len());
                let tube = |(i, option): (u32, &LinkOption)| {
                    let link = space.link_piece(&choice.link(option));
                    let (lever_m, room) = leaves(i as usize);
                    (i, LinkBox::of(option, &link, space.links, lever_m, room))
                };
                let boxes = options
                    .map(|i| (i, &choice.options[i as usize]))
                    .filter(|(_, option)| takes(option) && !slender(option))
                    .map(tube);
                let tree = Arc::new(Tree::build(boxes)?);
                Some(Part::Links { length_m: choice.vector_m.norm(), tree })
            }
            SpacePiece::Link(link) => match &link.body {
                LinkBody::Offset { mass_kg } => Some(Part::Offset { mass_kg: *mass_kg }),
                LinkBody::Tube { material, section, .. } => {
                    let option = LinkOption::given(*material, *section);
                    let tube = LinkBox::of(&option, &space.link_piece(link), space.links, 0.0, LinkRoom::ANY);
                    (!slender(&option))
                        .then(|| Part::Tube { length_m: link.vector_m.norm(), tube: Box::new(tube) })
                }
            },
        }
    }

    /// Compiles a joint whose drive the search chooses, and adds its level.
    fn drives(&mut self, sized: Arc<SizedJoint<'c>>, tilts: bool, ties: Ties) -> Option<Part<'c>> {
        self.level(sized.table.len());
        let rays = self.rays(self.parts.len(), sized.table.motion());
        let kinds = Kinds::of(&sized, ties);
        let drives =
            |kind: &[u32]| DriveBox::of_kind(kind.iter().map(|&i| drive_box(&sized, i, &rays, tilts)));
        let tree = Tree::build(kinds.iter().filter_map(|kind| Some((kind[0], drives(kind)?))))?;
        Some(Part::Drives { sized, kinds: Arc::new(kinds), tree: Arc::new(tree), rays: Arc::new(rays) })
    }

    /// Compiles a joint that takes the lightest drive that can carry its load.
    fn first_fit(&self, sized: Arc<SizedJoint<'c>>, tilts: bool) -> Option<Part<'c>> {
        let rays = self.rays(self.parts.len(), sized.table.motion());
        let candidates = sized.table.first_fit_candidates();
        let steps: Vec<DriveBox> = candidates.iter().map(|&i| drive_box(&sized, i, &rays, tilts)).collect();
        let ladder = (!steps.is_empty()).then(|| Arc::new(Ladder::new(steps)))?;
        Some(Part::FirstFit { ladder, sized })
    }

    /// Adds a level (choice) with `size` options for the piece that is compiled next. Returns the numbers of the
    /// options.
    fn level(&mut self, size: usize) -> std::ops::Range<u32> {
        self.level_pieces.push(self.parts.len());
        self.level_sizes.push(size as u32);
        0..size as u32
    }

    /// The rays of a joint, which test whether drives can carry its load: fixed proportions of static torque \[N m\]
    /// and inertia \[kg m²\], around the proportion that the payload alone causes.
    fn rays(&self, piece: usize, motion: &JointMotion) -> Rays {
        let (mut static_nm, mut inertia_kgm2) = (0.0f64, 0.0f64);
        for pose in self.poses.iter().filter(|pose| pose.sizing) {
            let Some(row) = &pose.inertia_about[piece] else { continue };
            static_nm = static_nm.max(pose.payload_torque_nm(piece).abs());
            inertia_kgm2 = inertia_kgm2.max(row.fixed);
        }
        Rays::new(motion, static_nm, inertia_kgm2)
    }

    /// Adds the inertia matrices of every judged case (a case that counts for deflection and lowest mode) to the
    /// problem. Which coordinates deflect elastically is taken from the ideal arm of the box of all designs. This arm
    /// has every stiffness at its greatest and every inertia at its least. No matrices are added if no design meets the
    /// constraints.
    pub(super) fn with_inertias(mut self) -> Self {
        let mut work = BoxWork::default();
        let filled = self.fill(&mut self.root(), &mut work);
        if filled.and_then(|()| self.least_tip_m(&mut work)).is_some() {
            let of = |case: usize| {
                let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
                CaseInertia::new(&self.poses[case], &ideal)
            };
            self.inertias = Arc::new(self.judged_cases().map(of).collect());
        }
        self
    }
}

/// The number of each piece of the chain in the compiled problem, base to tip. The numbers count from the tip and have
/// gaps, because effects have pieces in between.
fn piece_numbers(space: &DesignSpace) -> Vec<usize> {
    let (mut numbers, mut next) = (vec![0; space.pieces.len()], 0);
    for (place, layer) in space.layers() {
        if let Layer::Piece(piece) = layer {
            numbers[place] = next;
            next += usize::from(harness_kg(space, piece).is_some());
        }
        next += usize::from(!matches!(layer, Layer::Bearing(_)));
    }
    numbers
}

/// The box of the single drive with this index. `tilts` tells whether the bearing of some drive of the joint tilts. If
/// so, a bearing without tilt gets a very small compliance instead of none, so that all drives of the joint have the
/// same coordinates.
fn drive_box(sized: &SizedJoint, index: u32, rays: &Rays, tilts: bool) -> DriveBox {
    let index = index as usize;
    let tilt_rad_per_nm = if tilts { sized.tilts_rad_per_nm[index].max(RIGID_RAD_PER_NM) } else { 0.0 };
    let mass_kg = sized.table.mass_kg(index);
    let curve = CurveBox::of(&sized.laws[index]);
    DriveBox {
        mass_kg: [mass_kg; 2],
        limits: *sized.table.limits(index),
        least_limits: *sized.table.limits(index),
        multiples: rays.capacity(sized.table.limits(index)),
        curve,
        breaks: curve.map_or_else(BreakPoints::default, |c| BreakPoints::of(&c.stiff.windup)),
        tilt_rad_per_nm: [tilt_rad_per_nm; 2],
        each: None,
    }
}
