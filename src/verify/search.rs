//! Going through the boxes: cut, halved, or a single design.

use super::arm::Arm;
use super::bound::{Ceiling, Members, compliances};
use super::drives::{Choice, angle_rad};
use super::layout::Coordinate;
use super::pencil::{Factor, Pencil, square};
use super::pose::Pose;
use super::region::corners::Corner;
use super::staircase::Staircase;
use super::tubes::{DENSITIES, TubeRange, Tubes};
use super::{PartsBox, Place, Witness};
use crate::arm::joint_law::Windup;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Single designs beyond which the search stops: what it looks beside is far from a front.
const MOST_DESIGNS: usize = 200_000;

/// A design, or those that no objective tells apart: what each level may be, tip first.
pub(super) type Design = Vec<Choice>;

/// What a search found.
#[derive(Default)]
pub(super) struct Found {
    pub boxes: u64,
    pub open: u64,
}

impl Found {
    pub fn with(self, other: Self) -> Self {
        Self { boxes: self.boxes + other.boxes, open: self.open + other.open }
    }
}

/// A search of all boxes beside a front.
pub(super) struct Search<'s> {
    pub witness: &'s Witness,
    pub front: &'s Staircase,
    /// What is not below it is left out.
    pub corner: Corner,
    pub halt: &'s Halt<'s>,
}

/// What a search has come to, and what ends it early.
pub(super) struct Halt<'s> {
    pub stop: &'s AtomicBool,
    pub deadline: Option<Instant>,
    /// Single designs that no bound cut, and how many.
    pub designs: Mutex<BTreeSet<Design>>,
    pub count: AtomicUsize,
}

impl Halt<'_> {
    /// Whether the search is to end early.
    pub fn stopped(&self) -> bool {
        self.count.load(Ordering::Relaxed) > MOST_DESIGNS || self.out_of_time()
    }

    /// Notes a design; it may be known from another region.
    fn note(&self, design: Option<Design>) {
        let mut designs = self.designs.lock().unwrap_or_else(PoisonError::into_inner);
        designs.extend(design);
        self.count.store(designs.len(), Ordering::Relaxed);
    }

    /// Whether whoever asked wants an end.
    pub fn out_of_time(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}

impl Search<'_> {
    /// Looks into a box and, if it is not cut, into its halves.
    pub fn explore(&self, parts: &PartsBox) -> Found {
        if self.halt.stopped() {
            return Found { open: 1, ..Found::default() };
        }
        let here = Found { boxes: 1, ..Found::default() };
        let Some(level) = self.level_to_halve(parts) else { return here };
        let Some([a, b]) = level.and_then(|level| self.witness.halves(parts, level)) else {
            self.halt.note(self.witness.design(parts));
            return here;
        };
        let (a, b) = rayon::join(|| self.explore(&a), || self.explore(&b));
        here.with(a).with(b)
    }

    /// The level to halve; none inside if the box is a single design, none at all if the box is cut.
    fn level_to_halve(&self, parts: &PartsBox) -> Option<Option<usize>> {
        let witness = self.witness;
        let members = witness.members(parts)?;
        let ceiling = witness.arm.ceiling(&members)?;
        if !self.corner.is_in_reach_of(&ceiling) {
            return None;
        }
        let beaten_hz = self.front.beaten_up_to_hz(ceiling.mass_kg, ceiling.tip_m);
        let too_slow_hz = beaten_hz.max(witness.arm.required_hz()).max(self.corner.hz);
        let slow = witness.arm.slowest(&members, too_slow_hz)?;
        let open = witness.open_levels(parts);
        if open.len() < 2 {
            return Some(open.first().copied());
        }
        let weigh = Weigh { witness, members: &members, ceiling: &ceiling, slow: &slow, parts };
        open.into_iter()
            .map(|level| (level, weigh.harm(level)))
            .reduce(|a, b| if b.1 > a.1 { b } else { a })
            .map(|(level, _)| Some(level))
    }
}

/// The judged case in which the stiffest arm of a box is slowest.
pub(super) struct Slow<'w> {
    pose: &'w Pose,
    mode: Vec<f64>,
    eigenvalue: f64,
}

impl Arm {
    /// The slowest case if the stiffest arm is faster than `hz` in every case; `None` if in one it is not.
    pub fn slowest(&self, members: &Members, hz: f64) -> Option<Slow<'_>> {
        let eigenvalue = eigenvalue_of(hz);
        if !eigenvalue.is_finite() {
            return None;
        }
        let judged = self.poses.iter().filter(|pose| pose.judged);
        let pencils: Vec<(&Pose, Pencil, Factor)> = judged
            .map(|pose| {
                let pencil = self.pencil(pose, members);
                pencil.factor(eigenvalue).map(|factor| (pose, pencil, factor))
            })
            .collect::<Option<_>>()?;
        let slow = pencils.into_iter().map(|(pose, pencil, factor)| {
            let mode = pencil.lowest_mode(&factor);
            Slow { pose, eigenvalue: pencil.strain(&mode), mode }
        });
        slow.reduce(|a, b| if b.eigenvalue < a.eigenvalue { b } else { a })
    }

    /// Whether in some judged case no member of a box is faster than `hz`.
    pub fn none_faster(&self, members: &Members, hz: f64) -> bool {
        self.slowest(members, hz).is_none()
    }

    /// The least frequency that the study asks for \[Hz\], less rounding.
    pub fn required_hz(&self) -> f64 {
        self.constraints.required_mode_hz() * (1.0 - super::bound::ROUNDING)
    }
}

impl Witness {
    /// A box of one option a level.
    fn design(&self, parts: &PartsBox) -> Option<Design> {
        let members = self.members(parts)?;
        let choice = |(place, &node): (&Place, &u32)| match *place {
            Place::Joint(joint) => {
                let drives = &self.joints[joint];
                let demands = self.arm.demands(joint, drives.motion.as_ref()?, &members);
                Some(drives.options(node).next()?.holding(&demands))
            }
            Place::Tube(tube) => {
                let Tubes { tree, numbers, .. } = &self.tubes[tube];
                let options = tree.options(node).iter().map(|&i| numbers[i as usize]).collect();
                Some(Choice { options, one_holds: true })
            }
        };
        self.arm.levels.iter().zip(&parts.0).map(choice).collect()
    }

    /// Levels with more than one option left.
    fn open_levels(&self, parts: &PartsBox) -> Vec<usize> {
        (0..self.arm.levels.len())
            .filter(|&level| self.tree(level).halves(parts.0[level]).is_some())
            .collect()
    }
}

/// `(2 π f)²`.
pub(super) fn eigenvalue_of(hz: f64) -> f64 {
    (std::f64::consts::TAU * hz).powi(2)
}

/// By how much a middling part in place of the best harms the ceiling: the level that harms it most is halved.
/// Any rule would do; this one only says where boxes shrink fastest.
struct Weigh<'a> {
    witness: &'a Witness,
    members: &'a Members<'a>,
    ceiling: &'a Ceiling,
    slow: &'a Slow<'a>,
    parts: &'a PartsBox,
}

impl Weigh<'_> {
    fn harm(&self, level: usize) -> f64 {
        let node = self.parts.0[level];
        let [mass_kg, tip_m, eigenvalue] = match self.witness.arm.levels[level] {
            Place::Joint(joint) => self.of_joint(joint, node),
            Place::Tube(tube) => self.of_tube(tube),
        };
        let part = |harm: f64, of: f64| if of > 0.0 && harm.is_finite() { (harm / of).max(0.0) } else { 0.0 };
        let slower = part(eigenvalue, self.slow.eigenvalue);
        part(mass_kg, self.ceiling.mass_kg) + part(tip_m, self.ceiling.tip_m).ln_1p() + 0.5 * slower.ln_1p()
    }

    /// Mass, deflection and `λ` that the middle of a set of drives costs.
    fn of_joint(&self, joint: usize, node: u32) -> [f64; 3] {
        let (range, whole) = (&self.members.drives[joint], self.witness.joints[joint].range(node));
        let mass_kg = 0.5 * (whole.most_kg.min(range.most_kg) - range.least_kg);
        let pose = &self.witness.arm.poses[self.ceiling.worst];
        let torque_nm = pose.torques[joint].over(&self.members.loads[pose.water]).least_size();
        let softer = 0.5 * (angle_rad(&range.soft, torque_nm) - angle_rad(&range.stiff, torque_nm));
        let tip_m = softer * pose.ways_m[joint].dot(&self.ceiling.direction).abs();
        let slope = |curve: &Windup| curve.tangent_nm_per_rad(torque_nm);
        let weaker = 0.5 * (slope(&range.stiff) - slope(&range.soft));
        let x = &self.slow.mode;
        let inertia = mass_kg * square(&self.slow.pose.inertia_per[joint], x);
        let eigenvalue = weaker * x[joint] * x[joint] + self.slow.eigenvalue * inertia;
        [mass_kg, tip_m + self.sag_per(joint) * mass_kg, eigenvalue]
    }

    /// The same of a set of tubes.
    fn of_tube(&self, tube: usize) -> [f64; 3] {
        let range: &TubeRange = self.members.tubes[tube];
        let pose = &self.witness.arm.poses[self.ceiling.worst];
        let loads = &self.members.loads[pose.water];
        let works = pose.works[tube].iter().zip(compliances(range)).zip(range.middle.stiffnesses);
        let softer: f64 = works
            .map(|((work, compliance), middle)| {
                let work = work.along(&self.ceiling.direction, loads).middle().max(0.0);
                if compliance.least > 0.0 { work * (1.0 / middle - compliance.least) } else { 0.0 }
            })
            .sum();
        let load = self.witness.joints.len() + tube;
        let heavier =
            range.middle.around[pose.water].weight_n_per_m - range.least.around[pose.water].weight_n_per_m;
        let tip_m = softer + self.sag_per(load) * heavier;
        [range.middle.mass_kg - range.least.mass_kg, tip_m, self.slower_by_tube(tube, range)]
    }

    fn slower_by_tube(&self, tube: usize, range: &TubeRange) -> f64 {
        let (x, water) = (&self.slow.mode, self.slow.pose.water);
        let strain: f64 = self
            .witness
            .arm
            .coordinates
            .iter()
            .zip(x)
            .filter_map(|(coordinate, x)| match *coordinate {
                Coordinate::Tube(t, shape) if t == tube => {
                    let (which, integral_m) = shape.stiffness(self.witness.arm.lengths_m[tube]);
                    let weaker = range.most.stiffnesses[which] - range.middle.stiffnesses[which];
                    Some(weaker * integral_m * x * x)
                }
                _ => None,
            })
            .sum();
        let first = self.witness.joints.len() + DENSITIES * tube;
        let more =
            |i: usize| range.middle.around[water].densities[i] - range.least.around[water].densities[i];
        let inertia: f64 =
            (0..DENSITIES).map(|i| more(i) * square(&self.slow.pose.inertia_per[first + i], x)).sum();
        strain + self.slow.eigenvalue * inertia
    }

    /// What a unit of a load adds to the deflection of the stiffest arm.
    fn sag_per(&self, load: usize) -> f64 {
        let pose = &self.witness.arm.poses[self.ceiling.worst];
        let loads = &self.members.loads[pose.water];
        let direction = &self.ceiling.direction;
        let joints = self.members.drives.iter().zip(&pose.torques).zip(&pose.ways_m);
        let joints = joints.map(|((drive, torque), way_m)| {
            let slope = drive.stiff.tangent_nm_per_rad(torque.over(loads).least_size());
            torque.per_load[load] / slope * way_m.dot(direction)
        });
        let tubes = self.members.tubes.iter().zip(&pose.works).flat_map(|(tube, works)| {
            works.iter().zip(compliances(tube)).map(|(w, c)| w.per_load[load].dot(direction) * c.least)
        });
        let tilts = pose.tilts_m.iter().map(|tilt_m| tilt_m.per_load[load].dot(direction));
        joints.chain(tubes).chain(tilts).sum()
    }
}
