//! Going through the boxes: cut, halved, or a single design.

use super::bound::{Ceiling, Members, compliances};
use super::drives::angle_rad;
use super::layout::Coordinate;
use super::pencil::{Factor, Pencil, square};
use super::pose::Pose;
use super::staircase::Staircase;
use super::tubes::{DENSITIES, TubeRange};
use super::{PartsBox, Place, Witness};
use crate::arm::Windup;
use crate::search::design::number;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

/// Single designs beyond which the search stops: what it looks beside is far from a front.
const MOST_DESIGNS: usize = 200_000;

/// What a search found.
#[derive(Default)]
pub(super) struct Found {
    /// Numbers of single designs that no bound cut.
    pub designs: Vec<u128>,
    pub boxes: u64,
    pub open: u64,
}

impl Found {
    fn with(mut self, other: Self) -> Self {
        self.designs.extend(other.designs);
        Self { designs: self.designs, boxes: self.boxes + other.boxes, open: self.open + other.open }
    }
}

/// A search of all boxes beside a front.
pub(super) struct Search<'s> {
    pub witness: &'s Witness,
    pub front: &'s Staircase,
    pub stop: &'s AtomicBool,
    pub deadline: Option<Instant>,
    /// Single designs so far.
    pub designs: AtomicUsize,
}

impl Search<'_> {
    /// Whether the search is to end early.
    fn stopped(&self) -> bool {
        self.designs.load(Ordering::Relaxed) > MOST_DESIGNS || self.out_of_time()
    }

    /// Whether whoever asked wants an end.
    pub fn out_of_time(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Looks into a box and, if it is not cut, into its halves.
    pub fn explore(&self, parts: &PartsBox) -> Found {
        if self.stopped() {
            return Found { open: 1, ..Found::default() };
        }
        let here = Found { boxes: 1, ..Found::default() };
        let Some(level) = self.level_to_halve(parts) else { return here };
        let Some([a, b]) = level.and_then(|level| self.witness.halves(parts, level)) else {
            self.designs.fetch_add(1, Ordering::Relaxed);
            return Found { designs: vec![self.witness.number_of(parts)], ..here };
        };
        let (a, b) = rayon::join(|| self.explore(&a), || self.explore(&b));
        here.with(a).with(b)
    }

    /// The level to halve; none inside if the box is a single design, none at all if the box is cut.
    fn level_to_halve(&self, parts: &PartsBox) -> Option<Option<usize>> {
        let witness = self.witness;
        let members = witness.members(parts)?;
        let ceiling = witness.ceiling(&members)?;
        let beaten_hz = self.front.beaten_up_to_hz(ceiling.mass_kg, ceiling.tip_m);
        let slow = witness.slowest(&members, beaten_hz.max(witness.required_hz()))?;
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
struct Slow<'w> {
    pose: &'w Pose,
    mode: Vec<f64>,
    eigenvalue: f64,
}

impl Witness {
    /// The slowest case if the stiffest arm is faster than `hz` in every case; `None` if in one it is not.
    fn slowest(&self, members: &Members, hz: f64) -> Option<Slow<'_>> {
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
    pub(super) fn none_faster(&self, members: &Members, hz: f64) -> bool {
        self.slowest(members, hz).is_none()
    }

    /// The least frequency that the study asks for \[Hz\], less rounding.
    fn required_hz(&self) -> f64 {
        self.constraints.required_mode_hz() * (1.0 - super::bound::ROUNDING)
    }

    /// Levels with more than one option left.
    fn open_levels(&self, parts: &PartsBox) -> Vec<usize> {
        (0..self.levels.len()).filter(|&level| self.tree(level).halves(parts.0[level]).is_some()).collect()
    }

    /// Number of a single design.
    fn number_of(&self, parts: &PartsBox) -> u128 {
        let options = (0..self.levels.len()).map(|level| self.tree(level).options(parts.0[level])[0]);
        number(&self.level_sizes, &options.collect::<Vec<_>>())
    }
}

/// `(2 π f)²`.
fn eigenvalue_of(hz: f64) -> f64 {
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
        let [mass_kg, tip_m, eigenvalue] = match self.witness.place(level) {
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
        let pose = &self.witness.poses[self.ceiling.worst];
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
        let pose = &self.witness.poses[self.ceiling.worst];
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
            .coordinates
            .iter()
            .zip(x)
            .filter_map(|(coordinate, x)| match *coordinate {
                Coordinate::Tube(t, shape) if t == tube => {
                    let (which, integral_m) = shape.stiffness(self.witness.tubes[tube].length_m);
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
        let pose = &self.witness.poses[self.ceiling.worst];
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
