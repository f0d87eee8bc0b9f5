//! Options that may reach below a corner.

use super::super::arm::{Arm, Parts};
use super::super::bound::Members;
use super::super::drives::{DriveRange, first_fits};
use super::super::pose::Pose;
use super::super::span::Span;
use super::super::tubes::TubeRange;
use super::stock::Stock;

/// Weights of shapes no larger than this are not passed on.
const NO_SAY: f64 = 0.01;

/// The torque on a joint in a judged case, held between two.
#[derive(Debug, Clone, Copy)]
pub(super) struct Held {
    pub case: usize,
    pub joint: usize,
    pub between: Span,
}

/// Options of every joint and link, and what the zone around them knew.
#[derive(Clone)]
pub(super) struct Zone {
    /// Drives of each joint, ascending.
    pub joints: Vec<Vec<u32>>,
    /// Nodes of each link's tree of tubes.
    pub tubes: Vec<Vec<u32>>,
    pub held: Vec<Held>,
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

impl Zone {
    /// All options; `None` if a piece has none.
    pub fn whole(stock: &Stock) -> Option<Self> {
        let joints: Vec<Vec<u32>> =
            stock.joints.iter().map(|joint| (0..joint.masses_kg.len() as u32).collect()).collect();
        let some = joints.iter().all(|kept| !kept.is_empty()) && stock.tubes.iter().all(|t| t.tree.len() > 0);
        let tubes = vec![vec![0]; stock.tubes.len()];
        some.then_some(Self { joints, tubes, held: Vec::new(), weights: Vec::new(), shapes: Vec::new() })
    }

    /// How many designs there are: of a joint sized by first fit every drive counts for none.
    pub fn designs(&self, stock: &Stock) -> f64 {
        let joints = self.joints.iter().zip(&stock.joints);
        let joints = joints.map(|(kept, joint)| if joint.drives.level.is_some() { kept.len() } else { 1 });
        let tubes = self.tubes.iter().zip(&stock.tubes).map(|(nodes, tubes)| tubes.count(nodes));
        joints.chain(tubes).map(|count| count as f64).product()
    }

    /// Holds a torque between two, within those it is held between already.
    pub fn hold_torque(&mut self, new: Held) {
        let known = self.held.iter_mut().find(|held| held.case == new.case && held.joint == new.joint);
        match known {
            Some(Held { between, .. }) => {
                between.least = between.least.max(new.between.least);
                between.most = between.most.min(new.between.most);
            }
            None => self.held.push(new),
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

    pub fn tube_ranges(&self, stock: &Stock) -> Vec<TubeRange> {
        self.tubes.iter().zip(&stock.tubes).map(|(nodes, tubes)| tubes.range(nodes)).collect()
    }

    /// Leaves out the drives that do not hold; what is left as ranges. `None` if no member holds.
    pub fn hold<'t>(&mut self, arm: &Arm, stock: &Stock, tubes: &'t [TubeRange]) -> Option<Members<'t>> {
        let unknown = stock.joints.iter().map(|joint| joint.curves[0]).collect();
        let mut members = Members::new(unknown, tubes.iter().collect(), arm.waters);
        for joint in (0..self.joints.len()).rev() {
            let (stock, kept) = (&stock.joints[joint], &mut self.joints[joint]);
            let option = |drive: u32| &stock.drives.options[drive as usize];
            if let Some(motion) = &stock.drives.motion {
                let [least, most] = arm.demands(joint, motion, &members);
                if stock.drives.level.is_some() {
                    kept.retain(|&drive| option(drive).holds(&least));
                } else {
                    let fits = first_fits(kept.iter().map(|&drive| (drive, option(drive))), &least, &most);
                    *kept = fits.map(|(drive, _)| drive).collect();
                }
            }
            let ranges = kept.iter().map(|&drive| option(drive).range);
            members.set_drive(joint, ranges.reduce(|a: DriveRange, b| a.with(&b))?);
        }
        arm.strong_enough(&members).then_some(members)
    }

    /// The options as parts.
    pub fn parts(&self, stock: &Stock) -> Parts {
        let joints = self.joints.iter().zip(&stock.joints);
        let tubes = self.tubes.iter().zip(&stock.tubes);
        Parts {
            joints: joints.map(|(kept, joint)| joint.drives.only(kept)).collect(),
            tubes: tubes.map(|(nodes, tubes)| tubes.only(nodes)).collect(),
        }
    }

    /// Torque on each joint in a judged case, within what is held.
    pub fn torques(&self, case: usize, pose: &Pose, members: &Members) -> Vec<Span> {
        let torque = |(joint, torque): (usize, &super::super::span::Linear)| {
            let own = torque.over(&members.loads[pose.water]);
            let held = self.held.iter().filter(|held| held.case == case && held.joint == joint);
            held.fold(own, |span, held| Span {
                least: span.least.max(held.between.least).min(span.most),
                most: span.most.min(held.between.most).max(span.least),
            })
        };
        pose.torques.iter().enumerate().map(torque).collect()
    }
}
