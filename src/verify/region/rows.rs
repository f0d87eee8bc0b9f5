//! Linear inequalities that every member of a subproblem below an upper bound satisfies, as sums over the parts.
//!
//! The upper bound is a mass, a deflection and a frequency. A design is below it if it is no heavier, deflects no
//! further and has no lower mode. A subproblem has the options that such a design may have, and its members are the
//! designs that these options make.
//!
//! | sum over the parts | upper limit |
//! |---|---|
//! | mass: the sum of the parts' masses | mass of the upper bound |
//! | in a judged case, displacement of the tip along a direction `e` | deflection of the upper bound |
//! | in a judged case, for a shape `x`: `λ xᵀMx - xᵀKx`, `λ` of the upper bound | 0 |
//! | a torque that has an interval, and its negative | the end of the interval |
//!
//! A judged case counts for deflection and lowest mode.
//!
//! *Tip displacement.* With force `F`, a sum over the loads, and compliance `c` of a tube, `(F - F₀)(c - c₀) >= 0`
//! gives `F c >= F₀ c + c₀ (F - F₀)`. Under a torque `T`, in the sense that moves the tip along `e`, a gear twists
//! by at least `φ(T₀) + c₀ (T - T₀)`. Here `φ(T₀)` is the twist of the gear itself, and `c₀` is the least twist per
//! torque that any gear of the subproblem adds beyond `T₀`.
//!
//! A bearing is treated like a tube. Its force is the tip displacement per compliance.
//!
//! *Modes.* `M` is linear in masses and inertias per length, `K` is diagonal. The slope of a gear is its largest
//! slope under the torques of the subproblem.
//!
//! The upper limit is subtracted from every row, and the row is divided by about this limit. Each row is then at
//! most zero.

use super::super::bound::{Members, compliances, direction};
use super::super::drive_range::{DriveRange, angle_rad};
use super::super::layout::Coordinate;
use super::super::pencil::{Pencil, square};
use super::super::pose::Pose;
use super::super::skeleton::Skeleton;
use super::super::span::{Linear, LinearVector, Span};
use super::super::tubes::{DENSITIES, STIFFNESSES};
use super::super::upper_bound::UpperBound;
use super::parts_table::{Numbers, PartsTable, place};
use super::subproblem::{Subproblem, TorqueInterval};
use nalgebra::Vector3;

/// Margin for rounding in the rows of torque intervals (relative).
const ROUNDING: f64 = 1e-9;

/// An inequality that every member below the upper bound satisfies: a linear function of the numbers of all parts is
/// at most zero.
pub(super) struct Row {
    pub per_number: Vec<f64>,
    pub fixed: f64,
}

/// Positions of each part's numbers in the list of all numbers. A joint has its mass, then its twist in every
/// judged case, then its slope in every judged case, then compliance and stiffness of its bearing. A tube has the
/// numbers of the parts table.
#[derive(Clone)]
pub(super) struct Columns {
    pub cases: usize,
    pub joints: usize,
    /// Position of the first number of each tube; the last entry is the length of the list.
    pub tubes: Vec<usize>,
}

/// The rows of a subproblem below an upper bound.
pub(super) struct Rows<'a> {
    pub skeleton: &'a Skeleton,
    pub table: &'a PartsTable,
    pub columns: Columns,
    pub upper: UpperBound,
    pub rows: Vec<Row>,
    /// Index of the first row of a torque interval.
    pub first_interval: usize,
    /// Index of the first row of a mode. `modes` has the case and the trial shape (the motion
    /// that bounds the mode) of each row of a mode.
    pub first_mode: usize,
    pub modes: Vec<(usize, Vec<f64>)>,
    /// For each joint, the twists, slopes and bearing numbers of its torsion curves. `None` for a curve that no
    /// drive of the subproblem has.
    pub curves: Vec<Numbers>,
    /// Interval of the torque on each joint in each judged case \[N m\]: first index the case, second the joint.
    /// `per_torque` has, with the same indices, the least compliance \[rad/(N m)\] by which the twist grows with the
    /// torque. It is measured from the end of the interval at which the twist is least.
    pub torques: Vec<Vec<Span>>,
    pub per_torque: Vec<Vec<f64>>,
    /// For each row on a tip displacement: the index of the row, its judged case, and the direction along which the
    /// displacement is taken.
    pub tips: Vec<(usize, usize, Vector3<f64>)>,
    /// For each judged case and each elastic coordinate, whether the coordinate may be rigid in some member of the
    /// subproblem.
    rigid: Vec<Vec<bool>>,
}

impl Columns {
    pub(super) fn new(table: &PartsTable, cases: usize) -> Self {
        let joints = table.joints.len();
        let mut tubes = vec![joints * (3 + 2 * cases)];
        for tube in &table.tubes {
            tubes.push(tubes[tubes.len() - 1] + tube.priced());
        }
        Self { cases, joints, tubes }
    }

    pub(super) fn mass(&self, joint: usize) -> usize {
        joint * (3 + 2 * self.cases)
    }

    pub(super) fn twist(&self, joint: usize, case: usize) -> usize {
        self.mass(joint) + 1 + case
    }

    pub(super) fn slope(&self, joint: usize, case: usize) -> usize {
        self.mass(joint) + 1 + self.cases + case
    }

    /// Position of the compliance of the joint's bearing.
    pub(super) fn tilt(&self, joint: usize) -> usize {
        self.mass(joint) + 1 + 2 * self.cases
    }

    /// Position of the stiffness of the joint's bearing. The stiffness is stored as 0 if the bearing is rigid, so
    /// that it never contributes to a price.
    fn tilt_stiffness(&self, joint: usize) -> usize {
        self.tilt(joint) + 1
    }

    pub(super) fn len(&self) -> usize {
        self.tubes[self.tubes.len() - 1]
    }

    /// Positions of the numbers of a part; joints are numbered before tubes.
    pub(super) fn of_part(&self, part: usize) -> std::ops::Range<usize> {
        match part.checked_sub(self.joints) {
            None => self.mass(part)..self.mass(part + 1),
            Some(tube) => self.tubes[tube]..self.tubes[tube + 1],
        }
    }

    /// Position, in the list of all numbers, of the number to which the load with the index `load` is proportional: the
    /// mass of a drive, or the weight per length of a tube. `water` is the index of the medium around the arm.
    pub(super) fn load(&self, load: usize, water: usize) -> usize {
        match load.checked_sub(self.joints) {
            None => self.mass(load),
            Some(tube) => self.tubes[tube] + place::weight(water),
        }
    }
}

impl Row {
    fn new(columns: &Columns) -> Self {
        Self { per_number: vec![0.0; columns.len()], fixed: 0.0 }
    }

    /// Adds a quantity that is linear in the loads (masses of drives, weights per length of tubes) to this row: its
    /// constant part `fixed`, and its coefficients `per_load`. `water` is the index of the medium around the arm.
    fn add(&mut self, columns: &Columns, water: usize, fixed: f64, per_load: impl Iterator<Item = f64>) {
        self.fixed += fixed;
        per_load.enumerate().for_each(|(load, per)| self.per_number[columns.load(load, water)] += per);
    }

    /// Subtracts the upper limit `allowed` from the row and divides the row by `scale`. The row is then at most zero
    /// for every member below the upper bound.
    fn less(mut self, allowed: f64, scale: f64) -> Self {
        self.fixed = (self.fixed - allowed) / scale;
        self.per_number.iter_mut().for_each(|per| *per /= scale);
        self
    }

    pub(super) fn value(&self, numbers: &[f64]) -> f64 {
        self.fixed + self.per_number.iter().zip(numbers).map(|(a, b)| a * b).sum::<f64>()
    }
}

impl<'a> Rows<'a> {
    /// The rows (inequalities) of a subproblem for the local upper bound `upper`. `members` has the intervals of the
    /// numbers of the subproblem's parts. There is one row of a mode for each trial shape of the subproblem.
    pub(super) fn new(
        skeleton: &'a Skeleton,
        table: &'a PartsTable,
        subproblem: &Subproblem,
        members: &Members,
        upper: UpperBound,
    ) -> Self {
        let judged: Vec<&Pose> = skeleton.poses.iter().filter(|pose| pose.judged).collect();
        let columns = Columns::new(table, judged.len());
        let torques =
            judged.iter().enumerate().map(|(case, pose)| subproblem.torques(case, pose, members)).collect();
        let rigid = |pose: &&Pose| -> Vec<bool> {
            skeleton.stiffnesses(pose, members).iter().map(|stiffness| stiffness.is_infinite()).collect()
        };
        let mut rows = Self {
            skeleton,
            table,
            upper,
            rows: Vec::new(),
            first_interval: 0,
            first_mode: 0,
            modes: Vec::new(),
            curves: table.joints.iter().map(|joint| vec![None; joint.curves.len()]).collect(),
            per_torque: vec![vec![0.0; table.joints.len()]; judged.len()],
            tips: Vec::new(),
            torques,
            rigid: judged.iter().map(rigid).collect(),
            columns,
        };
        for (joint, kept) in subproblem.joints.iter().enumerate() {
            for &drive in kept {
                let curve = table.joints[joint].curve[drive as usize] as usize;
                let range = &table.joints[joint].curves[curve];
                rows.curves[joint][curve].get_or_insert_with(|| numbers_of(range, judged.len()));
            }
        }
        rows.add_mass();
        for (case, pose) in judged.iter().enumerate() {
            rows.add_tip(case, pose, members);
        }
        rows.add_slopes();
        rows.first_interval = rows.rows.len();
        for interval in &subproblem.torque_intervals {
            rows.add_interval(interval, judged[interval.case], members);
        }
        rows.first_mode = rows.rows.len();
        for shape in &subproblem.shapes {
            rows.add_mode(shape.case, shape.motion.clone());
        }
        rows
    }

    fn add_mass(&mut self) {
        if self.upper.mass_kg.is_finite() {
            let mut row = Row::new(&self.columns);
            row.fixed = self.skeleton.offsets_kg;
            (0..self.columns.joints).for_each(|joint| row.per_number[self.columns.mass(joint)] = 1.0);
            let tubes = self.columns.tubes.len() - 1;
            (0..tubes).for_each(|tube| row.per_number[self.columns.tubes[tube] + place::MASS] = 1.0);
            self.rows.push(row.less(self.upper.mass_kg, self.upper.mass_kg));
        }
    }

    /// Adds the row on the tip displacement in a judged case. The displacement is taken along the direction in which
    /// the tip of the stiffest arm moves.
    fn add_tip(&mut self, case: usize, pose: &Pose, members: &Members) {
        let Some(direction) = direction(pose, members) else { return };
        let loads = &members.loads[pose.water];
        let mut row = Row::new(&self.columns);
        for joint in 0..self.columns.joints {
            let along_m = pose.tip_m_per_rad[joint].dot(&direction);
            if along_m != 0.0 {
                self.add_twist(&mut row, case, joint, &pose.torques[joint], pose.water, along_m);
            }
        }
        for (tube, works) in pose.works.iter().enumerate() {
            let compliances = compliances(members.tubes[tube]);
            for (which, (work, compliance)) in works.iter().zip(compliances).enumerate() {
                let number = self.columns.tubes[tube] + place::compliance(self.skeleton.waters.len(), which);
                let force = Force { work, least: work.along(&direction, loads).least, water: pose.water };
                self.add_product(&mut row, number, compliance.least, &force, &direction);
            }
        }
        for (joint, work) in pose.by_tilts.iter().enumerate() {
            let force = Force { work, least: work.along(&direction, loads).least, water: pose.water };
            let least = members.drives[joint].tilt_rad_per_nm.least;
            self.add_product(&mut row, self.columns.tilt(joint), least, &force, &direction);
        }
        for by_spring_m in &pose.by_springs_m {
            let per_load = by_spring_m.per_load.iter().map(|per| per.dot(&direction));
            row.add(&self.columns, pose.water, by_spring_m.fixed.dot(&direction), per_load);
        }
        if self.upper.tip_m.is_finite() {
            self.tips.push((self.rows.len(), case, direction));
            self.rows.push(row.less(self.upper.tip_m, self.upper.tip_m));
        }
    }

    /// Adds to `row`, which bounds the tip's displacement along `direction`, a linear lower bound of one displacement:
    /// force times compliance. `number` is the position of the compliance in the list of numbers, and `least` its least
    /// value.
    fn add_product(&self, row: &mut Row, number: usize, least: f64, force: &Force, direction: &Vector3<f64>) {
        row.per_number[number] += force.least;
        let per_load = force.work.per_load.iter().map(|per| least * per.dot(direction));
        let fixed = least * (force.work.fixed.dot(direction) - force.least);
        row.add(&self.columns, force.water, fixed, per_load);
    }

    /// Adds the displacement of the tip by the twist of a gear to `row`, and stores the least twist of each torsion
    /// curve among the numbers of the curve. `torque` is the torque on the joint as a function of the loads. `along_m`
    /// is the displacement of the tip per radian along the direction of the row.
    fn add_twist(
        &mut self,
        row: &mut Row,
        case: usize,
        joint: usize,
        torque: &Linear,
        water: usize,
        along_m: f64,
    ) {
        let sense = 1.0f64.copysign(along_m);
        let span = self.torques[case][joint].times(sense);
        let mut per_torque = f64::INFINITY;
        for (numbers, range) in self.curves[joint].iter_mut().zip(&self.table.joints[joint].curves) {
            if let Some(numbers) = numbers {
                numbers[case] = range.least_angle_rad(span);
                per_torque = per_torque.min(least_twist_per_nm(range, span));
            }
        }
        row.per_number[self.columns.twist(joint, case)] += along_m.abs();
        self.per_torque[case][joint] = per_torque;
        let by = along_m.abs() * per_torque;
        let per_load = torque.per_load.iter().map(|per| by * sense * per);
        row.add(&self.columns, water, by * (sense * torque.fixed - span.least), per_load);
    }

    /// Stores the greatest slope that each torsion curve has under the torques of the subproblem among the numbers of
    /// the curve.
    fn add_slopes(&mut self) {
        let cases = self.columns.cases;
        for (joint, curves) in self.curves.iter_mut().enumerate() {
            for (numbers, range) in curves.iter_mut().zip(&self.table.joints[joint].curves) {
                let Some(numbers) = numbers else { continue };
                for case in 0..cases {
                    let slope = range.largest_slope(self.torques[case][joint].largest_size());
                    numbers[cases + case] = if slope.is_finite() { slope } else { 0.0 };
                }
            }
        }
    }

    fn add_interval(&mut self, interval: &TorqueInterval, pose: &Pose, members: &Members) {
        let torque = &pose.torques[interval.joint];
        let own = torque.over(&members.loads[pose.water]);
        let scale = (own.most - own.least).max(0.01 * own.largest_size()).max(f64::MIN_POSITIVE);
        for (sense, bound) in [(1.0, interval.between.most), (-1.0, -interval.between.least)] {
            if bound.is_finite() {
                let mut row = Row::new(&self.columns);
                let per_load = torque.per_load.iter().map(|per| sense * per);
                row.add(&self.columns, pose.water, sense * torque.fixed, per_load);
                let room = ROUNDING * bound.abs();
                self.rows.push(row.less(bound + room, scale));
            }
        }
    }

    /// Adds the row of a mode for the trial shape `shape` in a judged case. Coordinates that may be rigid in some
    /// member are set to zero in the shape, because a rigid coordinate cannot move.
    pub(super) fn add_mode(&mut self, case: usize, mut shape: Vec<f64>) {
        let eigenvalue = self.upper.eigenvalue();
        if eigenvalue == 0.0 {
            return;
        }
        let rigid = shape.iter_mut().zip(&self.rigid[case]).filter(|(_, rigid)| **rigid);
        rigid.for_each(|(x, _)| *x = 0.0);
        let pose = self.pose(case);
        let mut row = Row::new(&self.columns);
        row.fixed = eigenvalue * square(&pose.inertia, &shape);
        for (number, per) in self.inertias(pose.water).zip(&pose.inertia_per) {
            row.per_number[number] += eigenvalue * square(per, &shape);
        }
        for (coordinate, x) in self.skeleton.coordinates.iter().zip(&shape) {
            match self.stiffness(case, coordinate) {
                Ok((number, times)) => row.per_number[number] -= times * x * x,
                Err(nm_per_rad) => row.fixed -= nm_per_rad * x * x,
            }
        }
        self.rows.push(row.less(0.0, eigenvalue));
        self.modes.push((case, shape));
    }

    /// The pose of a judged case, given by its index among the judged cases.
    pub(super) fn pose(&self, case: usize) -> &'a Pose {
        self.skeleton.poses.iter().filter(|pose| pose.judged).nth(case).expect("a judged case")
    }

    /// Positions of the numbers to which inertia is proportional: masses of drives, then inertias per length of
    /// tubes.
    fn inertias(&self, water: usize) -> impl Iterator<Item = usize> {
        let (joints, tubes) = (self.columns.joints, self.columns.tubes.len() - 1);
        let masses = (0..joints).map(|joint| self.columns.mass(joint));
        let densities = (0..tubes).flat_map(move |tube| {
            (0..DENSITIES).map(move |which| self.columns.tubes[tube] + place::density(water, which))
        });
        masses.chain(densities)
    }

    /// Position of the number that determines the stiffness of `coordinate`, and the factor by which it is multiplied.
    /// If no part determines the stiffness, the stiffness itself is returned as `Err`.
    fn stiffness(&self, case: usize, coordinate: &Coordinate) -> Result<(usize, f64), f64> {
        match *coordinate {
            Coordinate::Joint(joint) => Ok((self.columns.slope(joint, case), 1.0)),
            Coordinate::Tube(tube, shape) => {
                let (which, integral_m) = shape.stiffness(self.skeleton.lengths_m[tube]);
                assert!(which < STIFFNESSES);
                Ok((
                    self.columns.tubes[tube] + place::stiffness(self.skeleton.waters.len(), which),
                    integral_m,
                ))
            }
            Coordinate::Tilt(joint, _) => Ok((self.columns.tilt_stiffness(joint), 1.0)),
            Coordinate::Shift(..) | Coordinate::Rail(_) => Err(f64::INFINITY),
            Coordinate::Spring(spring) => Err(self.skeleton.spring_stiffnesses[spring]),
        }
    }

    /// Stiffness and inertia matrices of an arm in a judged case. `numbers` is the list of the numbers of all its
    /// parts.
    pub(super) fn pencil(&self, case: usize, numbers: &[f64]) -> Pencil {
        let pose = self.pose(case);
        let stiffness = self.skeleton.coordinates.iter().zip(&self.rigid[case]);
        let stiffness = stiffness.map(|(coordinate, rigid)| match self.stiffness(case, coordinate) {
            _ if *rigid => f64::INFINITY,
            Ok((number, times)) => times * numbers[number],
            Err(nm_per_rad) => nm_per_rad,
        });
        let mut inertia = pose.inertia.clone();
        for (number, per) in self.inertias(pose.water).zip(&pose.inertia_per) {
            inertia.iter_mut().zip(per).for_each(|(entry, per)| *entry += numbers[number] * per);
        }
        Pencil::new(stiffness.collect(), inertia)
    }
}

/// A force that deforms a tube or bearing, given as the tip displacement that it causes per unit of compliance. `least`
/// is its least value along the direction of a row.
struct Force<'w> {
    work: &'w LinearVector,
    least: f64,
    water: usize,
}

/// The numbers of a torsion curve and of its bearing. Twists and slopes are zero at first and are filled in later.
fn numbers_of(range: &DriveRange, cases: usize) -> Vec<f64> {
    let stiffness = range.greatest_tilt_stiffness();
    let mut numbers = vec![0.0; 2 * cases];
    numbers.extend([range.tilt_rad_per_nm.least, if stiffness.is_finite() { stiffness } else { 0.0 }]);
    numbers
}

/// Least secant compliance \[rad/(N m)\] of the gears `range` between the least torque of an interval and any other
/// torque in it.
fn least_twist_per_nm(range: &DriveRange, torque_nm: Span) -> f64 {
    let Span { least, most } = torque_nm;
    let stiff = &range.stiff;
    match least >= 0.0 && most > least {
        // The slopes of this curve rise, so the secant to the end of the interval has the least compliance.
        true => (angle_rad(stiff, most) - angle_rad(stiff, least)) / (most - least) * (1.0 - ROUNDING),
        false => 1.0 / stiff.tangent_nm_per_rad(torque_nm.largest_size() * (1.0 + ROUNDING) + ROUNDING),
    }
}
