//! What a joint's drives are in numbers, and the least and the most of each over a set of drives.
//!
//! A set of drives is bounded by two torsion curves. Of each member's curve the slopes are first made to
//! rise: lifted (each at least the one before) or lowered (each at most the one after). The largest lifted
//! slopes with the least break points make a curve that at every torque is at least as steep as any
//! member's, for a member that is in a later segment there has a slope that the later segment of the bound
//! exceeds too. The least lowered slopes with the largest break points make one that is nowhere steeper.

use super::span::Span;
use super::tree::Tree;
use crate::arm::joint_law::{Curve, JointLaw, LostMotion, Windup};
use crate::catalog::Catalogs;
use crate::sizing::demand::{JointDemand, JointMotion};
use crate::sizing::limits::DriveLimits;
use crate::space::design_space::{DesignSpace, SpaceJoint};
use crate::space::slot::{SizedJoint, Slot, joint_slot};

/// Sets of drives no larger than this are looked through one by one.
const FEW: usize = 64;

/// Least, largest and middling numbers of a set of drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DriveRange {
    pub least_kg: f64,
    pub most_kg: f64,
    /// Nowhere softer than any of the drives.
    pub stiff: Windup,
    /// Nowhere stiffer than any of the drives.
    pub soft: Windup,
    /// Largest slope in modes of any drive that has one slope there, whatever the torque \[N m/rad\];
    /// infinite if a drive has not.
    pub modal_nm_per_rad: f64,
    /// Of the joint, the same for all its drives: what closes with the torque.
    pub lost_motion: Option<LostMotion>,
    /// Of the joint: half width of what friction holds back of the middle slope's twist \[rad\].
    pub friction_rad: f64,
}

/// What a joint may have as its drive.
pub(super) struct DriveOptions {
    /// Place among the levels of the space, if there is a choice.
    pub level: Option<usize>,
    /// What the joint does, if a drive must hold it.
    pub motion: Option<JointMotion>,
    /// Lightest first.
    pub options: Vec<DriveOption>,
}

/// A drive, or a kind of drives that weigh and twist alike.
#[derive(Debug, Clone)]
pub(super) struct DriveOption {
    pub range: DriveRange,
    /// Number of each drive, and what it holds.
    pub drives: Vec<(u32, DriveLimits)>,
}

/// Whether drives that weigh and twist alike are one option.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Alike {
    Apart,
    Together,
}

/// Drives that a joint may have, halved again and again.
pub(super) struct Drives {
    pub level: Option<usize>,
    pub motion: Option<JointMotion>,
    pub tree: Tree,
    /// Range and largest limits of each node.
    nodes: Vec<(DriveRange, DriveLimits)>,
    options: Vec<DriveOption>,
}

/// Options of a level that no objective tells apart.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Choice {
    /// Their numbers, those first that hold whatever rounding does.
    pub options: Vec<u32>,
    /// Whether the first is one.
    pub one_holds: bool,
}

impl DriveOptions {
    /// All drives of a joint; `level` counts if the drive is a choice.
    pub fn new(
        space: &DesignSpace,
        joint: &SpaceJoint,
        reach_m: f64,
        level: usize,
        catalogs: &Catalogs,
        alike: Alike,
    ) -> Self {
        match joint_slot(space, joint, reach_m, catalogs) {
            Slot::Given { law, mass_kg } => {
                let drives = vec![(0, without_limit())];
                let given = DriveOption { range: DriveRange::of(&law, mass_kg), drives };
                Self { level: None, motion: None, options: vec![given] }
            }
            Slot::Sized(sized) => {
                let kinds = match (sized.all_fits, alike) {
                    (true, Alike::Together) => sized.kinds(),
                    (true, Alike::Apart) => (0..sized.table.len() as u32).map(|i| vec![i]).collect(),
                    (false, _) => sized.table.first_fit_candidates().iter().map(|&i| vec![i]).collect(),
                };
                let options = kinds.iter().map(|kind| DriveOption::of_kind(&sized, kind)).collect();
                let level = sized.all_fits.then_some(level);
                Self { level, motion: Some(*sized.table.motion()), options }
            }
            Slot::Link { .. } | Slot::Offset { .. } => {
                Self { level: None, motion: None, options: Vec::new() }
            }
        }
    }

    /// Some of the options, ascending.
    pub fn only(&self, some: &[u32]) -> Self {
        let options = some.iter().map(|&i| self.options[i as usize].clone()).collect();
        Self { options, ..*self }
    }
}

impl DriveOption {
    fn of_kind(sized: &SizedJoint, kind: &[u32]) -> Self {
        let first = kind[0] as usize;
        Self {
            range: DriveRange::of(&sized.laws[first], sized.table.mass_kg(first)),
            drives: kind.iter().map(|&i| (i, *sized.table.limits(i as usize))).collect(),
        }
    }

    /// Whether a drive of it holds a demand.
    pub fn holds(&self, asked: &JointDemand) -> bool {
        self.drives.iter().any(|(_, limits)| limits.hold(asked))
    }

    /// Its drives that may hold a demand between two, and whether the first of them surely does.
    pub fn holding(&self, [least, most]: &[JointDemand; 2]) -> Choice {
        let may = self.drives.iter().filter(|(_, limits)| limits.hold(least));
        let (mut drives, unsure): (Vec<&(u32, DriveLimits)>, Vec<_>) =
            may.partition(|(_, limits)| limits.hold(most));
        let one_holds = !drives.is_empty();
        drives.extend(unsure);
        Choice { options: drives.into_iter().map(|&(number, _)| number).collect(), one_holds }
    }

    /// Largest of each limit of its drives.
    fn limits(&self) -> DriveLimits {
        let (first, rest) = self.drives.split_first().expect("an option has a drive");
        rest.iter().fold(first.1, |limits, (_, other)| limits.max(other))
    }
}

impl Drives {
    /// Halves the options.
    pub fn new(DriveOptions { level, motion, options }: DriveOptions) -> Self {
        let all: Vec<u32> = (0..options.len() as u32).collect();
        let tree = Tree::new(all, &options.iter().map(keys).collect::<Vec<_>>());
        let nodes = (0..tree.len() as u32)
            .filter_map(|node| {
                let members = tree.options(node).iter().map(|&i| &options[i as usize]);
                let members = members.map(|option| (option.range, option.limits()));
                members.reduce(|(a, limits), (b, other)| (a.with(&b), limits.max(&other)))
            })
            .collect();
        Self { level, motion, tree, nodes, options }
    }

    /// The options of a node.
    pub fn options(&self, node: u32) -> impl Iterator<Item = &DriveOption> {
        self.tree.options(node).iter().map(|&i| &self.options[i as usize])
    }

    /// The drives of a node that may hold what is asked at least; `None` if there is none.
    pub fn holding(&self, node: u32, asked: &JointDemand) -> Option<DriveRange> {
        if self.tree.options(node).len() > FEW {
            let (range, limits) = &self.nodes[node as usize];
            return limits.hold(asked).then_some(*range);
        }
        let holding = self.options(node).filter(|option| option.holds(asked));
        holding.map(|option| option.range).reduce(|a, b| a.with(&b))
    }

    /// The drives that may be the lightest that holds a demand between two; `None` if none holds the least.
    pub fn first_fits(&self, least: &JointDemand, most: &JointDemand) -> Option<DriveRange> {
        let fits = first_fits(self.options.iter().map(|option| ((), option)), least, most);
        fits.map(|(_, option)| option.range).reduce(|a, b| a.with(&b))
    }

    /// Range of all drives of a node.
    pub fn range(&self, node: u32) -> &DriveRange {
        &self.nodes[node as usize].0
    }

    /// Whether there is no drive at all.
    pub fn is_empty(&self) -> bool {
        self.options.is_empty()
    }
}

/// The drives that may be the lightest that holds a demand between two: all that hold the least, up to the
/// first that holds the most.
pub(super) fn first_fits<'o, T>(
    options: impl Iterator<Item = (T, &'o DriveOption)>,
    least: &JointDemand,
    most: &JointDemand,
) -> impl Iterator<Item = (T, &'o DriveOption)> {
    let (least, most) = (*least, *most);
    let fit = move |fitted: &mut bool, (what, option): (T, &'o DriveOption)| {
        let goes_on = !*fitted;
        *fitted |= option.holds(&most);
        goes_on.then_some((what, option))
    };
    options.scan(false, fit).filter(move |(_, option)| option.holds(&least))
}

/// What drives are told apart by.
fn keys(option: &DriveOption) -> Vec<f64> {
    let (drive, limits) = (&option.range, option.limits());
    let stiff = &drive.stiff;
    vec![
        drive.least_kg.ln(),
        0.5 * stiff.k1_nm_per_rad.ln(),
        0.5 * stiff.k3_nm_per_rad.ln(),
        0.2 * stiff.t1_nm.ln(),
        0.2 * limits.peak_torque_nm.ln(),
        0.2 * limits.static_torque_nm.ln(),
    ]
}

fn without_limit() -> DriveLimits {
    DriveLimits {
        static_torque_nm: f64::INFINITY,
        peak_torque_nm: f64::INFINITY,
        stop_torque_nm: f64::INFINITY,
        mean_torque_cubed_nm3: f64::INFINITY,
        tilting_moment_nm: f64::INFINITY,
    }
}

impl DriveRange {
    fn of(law: &JointLaw, mass_kg: f64) -> Self {
        let one_slope = |k: f64| Windup {
            k1_nm_per_rad: k,
            k2_nm_per_rad: k,
            k3_nm_per_rad: k,
            t1_nm: f64::INFINITY,
            t2_nm: f64::INFINITY,
        };
        let (windup, modal_nm_per_rad) = match law.without_play() {
            Curve::Rigid => (one_slope(f64::INFINITY), f64::INFINITY),
            Curve::Linear(k) => (one_slope(k), k),
            Curve::Windup(windup) => (windup, f64::INFINITY),
            Curve::WindupK1(windup) => (windup, windup.k1_nm_per_rad),
        };
        let [k1, k2, k3] = [windup.k1_nm_per_rad, windup.k2_nm_per_rad, windup.k3_nm_per_rad];
        let slopes = |[k1, k2, k3]: [f64; 3]| Windup {
            k1_nm_per_rad: k1,
            k2_nm_per_rad: k2,
            k3_nm_per_rad: k3,
            ..windup
        };
        Self {
            least_kg: mass_kg,
            most_kg: mass_kg,
            stiff: slopes([k1, k1.max(k2), k1.max(k2).max(k3)]),
            soft: slopes([k1.min(k2).min(k3), k2.min(k3), k3]),
            modal_nm_per_rad,
            lost_motion: law.lost_motion,
            friction_rad: law.hysteresis_rad,
        }
    }

    pub fn with(&self, other: &Self) -> Self {
        Self {
            least_kg: self.least_kg.min(other.least_kg),
            most_kg: self.most_kg.max(other.most_kg),
            stiff: curve(&self.stiff, &other.stiff, f64::max, f64::min),
            soft: curve(&self.soft, &other.soft, f64::min, f64::max),
            modal_nm_per_rad: self.modal_nm_per_rad.max(other.modal_nm_per_rad),
            ..*self
        }
    }

    /// Least twist under any of some torques, with its sign \[rad\]: the gear and what closes with the torque twist least
    /// under the least torque, and friction holds back most under the most.
    pub fn least_angle_rad(&self, torque_nm: Span) -> f64 {
        let Span { least, most } = torque_nm;
        let gear = if least >= 0.0 { angle_rad(&self.stiff, least) } else { -angle_rad(&self.soft, -least) };
        let closed = self.lost_motion.map_or(0.0, |lost| lost.angle_rad(least));
        gear + closed - self.most_held_rad(most)
    }

    /// The most that friction may hold back of a twist under torques of no more than this, with its sign \[rad\].
    fn most_held_rad(&self, torque_nm: f64) -> f64 {
        match torque_nm >= 0.0 {
            true => (torque_nm / self.soft.k2_nm_per_rad).min(self.friction_rad),
            false => (torque_nm / self.stiff.k2_nm_per_rad).max(-self.friction_rad),
        }
    }

    /// Largest slope for a small further torque at any torque up to this size \[N m/rad\].
    pub fn largest_slope(&self, torque_nm: f64) -> f64 {
        // beyond a break point by less than rounding counts as beyond
        let reach_nm = torque_nm * (1.0 + 1e-9) + 1e-9;
        let gear = self.stiff.tangent_nm_per_rad(reach_nm).min(self.modal_nm_per_rad);
        let open = self.lost_motion.map_or(0.0, |lost| lost.tangent_compliance_rad_per_nm(reach_nm));
        1.0 / (1.0 / gear + open)
    }
}

fn curve(a: &Windup, b: &Windup, slope: fn(f64, f64) -> f64, break_point: fn(f64, f64) -> f64) -> Windup {
    Windup {
        k1_nm_per_rad: slope(a.k1_nm_per_rad, b.k1_nm_per_rad),
        k2_nm_per_rad: slope(a.k2_nm_per_rad, b.k2_nm_per_rad),
        k3_nm_per_rad: slope(a.k3_nm_per_rad, b.k3_nm_per_rad),
        t1_nm: break_point(a.t1_nm, b.t1_nm),
        t2_nm: break_point(a.t2_nm, b.t2_nm),
    }
}

/// Twist under a torque that is not negative; break points may be infinite.
pub(super) fn angle_rad(curve: &Windup, torque_nm: f64) -> f64 {
    let first = torque_nm.min(curve.t1_nm);
    let second = torque_nm.min(curve.t2_nm) - first;
    let third = torque_nm - first - second.max(0.0);
    first / curve.k1_nm_per_rad + second.max(0.0) / curve.k2_nm_per_rad + third / curve.k3_nm_per_rad
}
