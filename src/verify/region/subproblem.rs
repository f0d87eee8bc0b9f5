//! Options that may reach below a upper bound.

use super::super::bound::Members;
use super::super::drive_range::DriveRange;
use super::super::drives::first_fits;
use super::super::pose::Pose;
use super::super::skeleton::{Parts, Skeleton};
use super::super::span::Span;
use super::super::tubes::TubeRange;
use super::parts_table::PartsTable;

/// Weights of shapes no larger than this are not passed on.
const NO_SAY: f64 = 0.01;

/// The torque on a joint in a judged case, torque_intervals between two.
#[derive(Debug, Clone, Copy)]
pub(super) struct TorqueInterval {
    pub case: usize,
    pub joint: usize,
    pub between: Span,
}

/// Options of every joint and link, and what the subproblem around them knew.
#[derive(Clone)]
pub(super) struct Subproblem {
    /// Drives of each joint, ascending.
    pub joints: Vec<Vec<u32>>,
    /// Nodes of each link's tree of tubes.
    pub tubes: Vec<Vec<u32>>,
    pub torque_intervals: Vec<TorqueInterval>,
    /// Weights of the rows but for torques and modes, and shapes, to begin with.
    pub weights: Vec<f64>,
    pub shapes: Vec<Shape>,
}

/// A motion of a judged case and the weight of its row.
#[derive(Clone)]
pub(super) struct Shape {
    pub case: usize,
    pub motion: Vec<f64>,
    pub weight: f64,
}

impl Subproblem {
    /// All options; `None` if a piece has none.
    pub fn whole(table: &PartsTable) -> Option<Self> {
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

    /// How many designs there are: of a joint sized by first fit every drive counts for none.
    pub fn designs(&self, table: &PartsTable) -> f64 {
        let joints = self.joints.iter().zip(&table.joints);
        let joints = joints.map(|(kept, joint)| if joint.drives.level.is_some() { kept.len() } else { 1 });
        let tubes = self.tubes.iter().zip(&table.tubes).map(|(nodes, tubes)| tubes.count(nodes));
        joints.chain(tubes).map(|count| count as f64).product()
    }

    /// Holds a torque between two, within those it is torque_intervals between already.
    pub fn keep_torque(&mut self, new: TorqueInterval) {
        let known = self.torque_intervals.iter_mut().find(|torque_intervals| {
            torque_intervals.case == new.case && torque_intervals.joint == new.joint
        });
        match known {
            Some(TorqueInterval { between, .. }) => {
                between.least = between.least.max(new.between.least);
                between.most = between.most.min(new.between.most);
            }
            None => self.torque_intervals.push(new),
        }
    }

    /// Keeps the shapes that have a say, and of each case the last.
    pub fn keep_shapes(&mut self, cases: usize) {
        let mut kept = Vec::new();
        for case in 0..cases {
            let of_case = self.shapes.iter().filter(|shape| shape.case == case);
            let count = of_case.clone().count();
            let has_say = |(at, shape): &(usize, &Shape)| at + 1 == count || shape.weight > NO_SAY;
            kept.extend(of_case.enumerate().filter(has_say).map(|(_, shape)| shape.clone()));
        }
        self.shapes = kept;
    }

    pub fn tube_ranges(&self, table: &PartsTable) -> Vec<TubeRange> {
        self.tubes.iter().zip(&table.tubes).map(|(nodes, tubes)| tubes.range(nodes)).collect()
    }

    /// Leaves out the drives that do not hold; what is left as ranges. `None` if no member holds.
    pub fn hold<'t>(
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

    /// The options as parts.
    pub fn parts(&self, table: &PartsTable) -> Parts {
        let joints = self.joints.iter().zip(&table.joints);
        let tubes = self.tubes.iter().zip(&table.tubes);
        Parts {
            joints: joints.map(|(kept, joint)| joint.drives.only(kept)).collect(),
            tubes: tubes.map(|(nodes, tubes)| tubes.only(nodes)).collect(),
        }
    }

    /// Torque on each joint in a judged case, within what is torque_intervals.
    pub fn torques(&self, case: usize, pose: &Pose, members: &Members) -> Vec<Span> {
        let torque = |(joint, torque): (usize, &super::super::span::Linear)| {
            let own = torque.over(&members.loads[pose.water]);
            let torque_intervals = self
                .torque_intervals
                .iter()
                .filter(|torque_intervals| torque_intervals.case == case && torque_intervals.joint == joint);
            torque_intervals.fold(own, |span, torque_intervals| Span {
                least: span.least.max(torque_intervals.between.least).min(span.most),
                most: span.most.min(torque_intervals.between.most).max(span.least),
            })
        };
        pose.torques.iter().enumerate().map(torque).collect()
    }
}
