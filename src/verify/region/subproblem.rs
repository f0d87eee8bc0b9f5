//! A subproblem: the options of each part that designs below an upper bound may have.
//!
//! An upper bound is a mass, a deflection and a frequency. The members of a subproblem are the designs that its options
//! make.

use super::super::bound::Members;
use super::super::drive_range::DriveRange;
use super::super::drives::first_fits;
use super::super::pose::Pose;
use super::super::skeleton::{Parts, Skeleton};
use super::super::span::Span;
use super::super::tubes::TubeRange;
use super::parts_table::PartsTable;

/// A trial shape (motion that bounds the lowest mode) whose row has at most this weight is not passed on to the halves
/// of a subproblem.
const NO_SAY: f64 = 0.01;

/// Limits the torque on a joint in a judged case to an interval. Such limits come from branching. A judged case counts
/// for deflection and lowest mode.
#[derive(Debug, Clone, Copy)]
pub(super) struct TorqueInterval {
    pub case: usize,
    pub joint: usize,
    pub between: Span,
}

/// The options of every joint and link, together with what a subproblem takes over from its parent: torque intervals,
/// weights of rows and trial shapes.
#[derive(Clone)]
pub(super) struct Subproblem {
    /// Indices of the drives that each joint may have, in ascending order.
    pub joints: Vec<Vec<u32>>,
    /// For each link, the nodes of its tree whose tubes it may have.
    pub tubes: Vec<Vec<u32>>,
    pub torque_intervals: Vec<TorqueInterval>,
    /// Weights of the rows (inequalities), with which the search for better weights starts. Rows of torques and modes
    /// are left out.
    pub weights: Vec<f64>,
    pub shapes: Vec<Shape>,
}

/// A trial shape in a judged case, with the weight of its row.
#[derive(Clone)]
pub(super) struct Shape {
    pub case: usize,
    pub motion: Vec<f64>,
    pub weight: f64,
}

impl Subproblem {
    /// The subproblem with all options; `None` if a joint or link has no option.
    pub(super) fn whole(table: &PartsTable) -> Option<Self> {
        let joints: Vec<Vec<u32>> =
            table.joints.iter().map(|joint| (0..joint.masses_kg.len() as u32).collect()).collect();
        let some = joints.iter().all(|kept| !kept.is_empty()) && table.tubes.iter().all(|t| t.tree.len() > 0);
        let tubes = vec![vec![0]; table.tubes.len()];
        some.then_some(Self {
            joints,
            tubes,
            torque_intervals: Vec::new(),
            weights: Vec::new(),
            shapes: Vec::new(),
        })
    }

    /// Number of designs that the options make. A joint with the first-fit rule (it gets the lightest drive that meets
    /// the demand) is counted as having one option.
    pub(super) fn designs(&self, table: &PartsTable) -> f64 {
        let joints = self.joints.iter().zip(&table.joints);
        let joints = joints.map(|(kept, joint)| if joint.drives.level.is_some() { kept.len() } else { 1 });
        let tubes = self.tubes.iter().zip(&table.tubes).map(|(nodes, tubes)| tubes.count(nodes));
        joints.chain(tubes).map(|count| count as f64).product()
    }

    /// Limits the torque on a joint to the interval `new`. If the torque has an interval already, the intersection of
    /// both is taken.
    pub(super) fn keep_torque(&mut self, new: TorqueInterval) {
        let known =
            self.torque_intervals.iter_mut().find(|known| known.case == new.case && known.joint == new.joint);
        match known {
            Some(TorqueInterval { between, .. }) => {
                between.least = between.least.max(new.between.least);
                between.most = between.most.min(new.between.most);
            }
            None => self.torque_intervals.push(new),
        }
    }

    /// Removes trial shapes whose rows have little weight. The last shape of each of the `cases` judged cases is kept
    /// in any event.
    pub(super) fn keep_shapes(&mut self, cases: usize) {
        let mut kept = Vec::new();
        for case in 0..cases {
            let of_case = self.shapes.iter().filter(|shape| shape.case == case);
            let count = of_case.clone().count();
            let has_say = |(at, shape): &(usize, &Shape)| at + 1 == count || shape.weight > NO_SAY;
            kept.extend(of_case.enumerate().filter(has_say).map(|(_, shape)| shape.clone()));
        }
        self.shapes = kept;
    }

    pub(super) fn tube_ranges(&self, table: &PartsTable) -> Vec<TubeRange> {
        self.tubes.iter().zip(&table.tubes).map(|(nodes, tubes)| tubes.range(nodes)).collect()
    }

    /// Removes the drives that cannot meet their demand, going from the tip inward. Returns the remaining members, with
    /// the ranges of the drives that remain. `tubes` are the ranges of their tubes. `None` if it is proved that no
    /// member passes its checks.
    pub(super) fn hold<'t>(
        &mut self,
        skeleton: &Skeleton,
        table: &PartsTable,
        tubes: &'t [TubeRange],
    ) -> Option<Members<'t>> {
        let unknown = table.joints.iter().map(|joint| joint.curves[0]).collect();
        let mut members = Members::new(unknown, tubes.iter().collect(), skeleton.waters.len());
        for joint in (0..self.joints.len()).rev() {
            let (table, kept) = (&table.joints[joint], &mut self.joints[joint]);
            let option = |drive: u32| &table.drives.options[drive as usize];
            if let Some(duty) = &table.drives.duty {
                let [least, most] = skeleton.demands(joint, duty, &members);
                if table.drives.level.is_some() {
                    kept.retain(|&drive| option(drive).holds(&least));
                } else {
                    let fits = first_fits(kept.iter().map(|&drive| (drive, option(drive))), &least, &most);
                    *kept = fits.map(|(drive, _)| drive).collect();
                }
            }
            let ranges = kept.iter().map(|&drive| option(drive).range);
            members.set_drive(joint, ranges.reduce(|a: DriveRange, b| a.with(&b))?);
        }
        skeleton.strong_enough(&members).then_some(members)
    }

    /// The options of each joint and link that remain in this subproblem, in the form that the search box by box needs.
    pub(super) fn parts(&self, table: &PartsTable) -> Parts {
        let joints = self.joints.iter().zip(&table.joints);
        let tubes = self.tubes.iter().zip(&table.tubes);
        Parts {
            joints: joints.map(|(kept, joint)| joint.drives.only(kept)).collect(),
            tubes: tubes.map(|(nodes, tubes)| tubes.only(nodes)).collect(),
        }
    }

    /// Interval of the torque on each joint in a judged case, limited by the subproblem's torque intervals.
    pub(super) fn torques(&self, case: usize, pose: &Pose, members: &Members) -> Vec<Span> {
        let torque = |(joint, torque): (usize, &super::super::span::Linear)| {
            let own = torque.over(&members.loads[pose.water]);
            let intervals = self.torque_intervals.iter().filter(|i| i.case == case && i.joint == joint);
            intervals.fold(own, |span, TorqueInterval { between, .. }| Span {
                least: span.least.max(between.least).min(span.most),
                most: span.most.min(between.most).max(span.least),
            })
        };
        pose.torques.iter().enumerate().map(torque).collect()
    }
}
