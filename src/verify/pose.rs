//! One case of a study as sums over parts: torques, deflection, stress and inertia.
//!
//! *Loads* are the masses of drives \[kg\] and the weights of tubes per length \[N/m\]. The torque on a joint, and the
//! force and the moment in a tube's section, are sums of contributions that are proportional to the loads. The factor
//! of a torque is a lever arm.
//!
//! *Deflection* follows from the method of the unit load. The displacement of the tip along `e` is the work of the real
//! internal loads, divided by the stiffness, on the internal loads of a unit force `e` at the tip:
//! `Σ θ_j (a_j · (r_j x e)) + Σ ∫ (N n/EA + V·v/κGA + T t/GJ + M_y m_y/EI_y + M_z m_z/EI_z) dx`. Real loads are at most
//! quadratic in `x` and virtual loads are linear, so the quadrature is exact.
//!
//! *Inertia* is the kinetic energy of the coordinates of [`super::layout`], a sum over the masses of drives
//! and the inertias of tubes per length.

use super::layout::{Coordinate, Layout, Point};
use super::question::Question;
use super::span::{Linear, LinearVector};
use super::tubes::{DENSITIES, STIFFNESSES};
use crate::arm::load::{LoadCase, Water};
use crate::arm::structure::Structure;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Points and weights of Gauss-Legendre quadrature on 0..1, exact for polynomials up to degree 7.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// A case of the study, prepared for bounds: everything in it that does not depend on the design.
pub(super) struct Pose {
    pub judged: bool,
    pub sizing: bool,
    /// Index of the medium around the arm (air or water) in the list of the study's media.
    pub water: usize,
    /// Ratio of the stress during acceleration to the stress under static loads. 1 if the case is not a sizing
    /// case.
    pub stress_factor: f64,
    /// Torque on each joint \[N m\], as a linear function of the loads (masses of drives, weights per length of tubes).
    pub torques: Vec<Linear>,
    /// Displacement of the tip per radian of torsion of each joint \[m/rad\].
    pub tip_m_per_rad: Vec<Vector3<f64>>,
    /// Displacement of the tip by the tilt of each joint's bearing, divided by the compliance of the bearing, as a
    /// linear function of the loads \[m N m/rad\].
    pub by_tilts: Vec<LinearVector>,
    /// Displacement of the tip that each spring of an effect or prismatic joint causes, as a linear function of the
    /// loads \[m\].
    pub by_springs_m: Vec<LinearVector>,
    /// For each tube and each of its stiffnesses, the tip displacement that the strain against this stiffness causes,
    /// times the stiffness. It is a linear function of the loads.
    pub works: Vec<[LinearVector; STIFFNESSES]>,
    /// Force and moment at root and end of each tube, in the tube's frame, as linear functions of the loads.
    pub ends: Vec<[[Linear; 6]; 2]>,
    /// Inertia matrix, over all coordinates, of everything that is the same in all designs: lower triangle, row by row.
    pub inertia: Vec<f64>,
    /// Inertia matrices over all coordinates: one for each drive, per unit of its mass, then one for each inertia per
    /// length of each tube, per unit of it. All are lower triangles, row by row.
    pub inertia_per: Vec<Vec<f64>>,
}

/// A force and a moment on a section of the arm.
#[derive(Debug, Clone, Copy, Default)]
struct Wrench {
    force: Vector3<f64>,
    moment: Vector3<f64>,
}

/// Force and moment that a section of the arm transmits from everything outboard: the constant part, and the part per
/// unit of each load.
pub(super) struct Carried {
    fixed: Wrench,
    per_load: Vec<Wrench>,
}

/// Displacements and rotations of a point in the world frame, each list with one entry per unit of each coordinate.
struct Motions {
    moved: Vec<Vector3<f64>>,
    turned: Vec<Vector3<f64>>,
}

/// The inputs from which a [`Pose`] is computed.
#[derive(Clone, Copy)]
pub(super) struct Builder<'a> {
    pub layout: &'a Layout,
    gravity_m_s2: f64,
    down: Vector3<f64>,
    /// Weight of the payload and tip force \[N\], each with the point where it acts \[m\].
    tip_loads: [(Vector3<f64>, Vector3<f64>); 2],
    tip_moment_nm: Vector3<f64>,
    coordinates: &'a [Coordinate],
}

impl Pose {
    /// Computes the case with the index `index`. `water` is the index of the medium around the arm.
    pub(super) fn new(question: &Question, index: usize, water: usize, builder: &Builder) -> Self {
        let (case, layout) = (&question.cases[index], builder.layout);
        let sizing = question.sizing_cases.contains(&index);
        // Without gravity there is no static stress to compare with, so the stress is not raised for acceleration.
        let acceleration = match question.gravity_m_s2 > 0.0 {
            true => question.motion.tip_acceleration_m_s2() / question.gravity_m_s2,
            false => 0.0,
        };
        Self {
            judged: question.judged_cases.contains(&index),
            sizing,
            water,
            stress_factor: if sizing { 1.0 + acceleration } else { 1.0 },
            torques: (0..layout.joints.len()).map(|joint| builder.torque(joint)).collect(),
            tip_m_per_rad: layout.joints.iter().map(|j| j.axis.cross(&(layout.tip_m - j.at_m))).collect(),
            by_tilts: (0..layout.joints.len()).map(|joint| builder.by_tilt(joint)).collect(),
            by_springs_m: (0..layout.springs.len()).map(|spring| builder.by_spring(spring)).collect(),
            works: (0..layout.tubes.len()).map(|tube| builder.works(tube)).collect(),
            ends: (0..layout.tubes.len()).map(|tube| builder.ends(tube)).collect(),
            inertia: builder.fixed_inertia(case),
            inertia_per: builder.inertia_per(),
        }
    }
}

/// The water around the arm: as stated by the case, or else by an effect. `None` in air.
pub(super) fn water_of(structure: &Structure, case: &LoadCase) -> Option<Water> {
    case.water.or(structure.water)
}

fn payload_weight(question: &Question, case: &LoadCase, water: Option<Water>) -> Vector3<f64> {
    let lifted = water.map_or(0.0, |water| water.density_kg_m3 / water.payload_density_kg_m3);
    question.down * (case.payload.mass_kg * question.gravity_m_s2 * (1.0 - lifted))
}

fn payload_at(layout: &Layout, case: &LoadCase) -> Vector3<f64> {
    layout.tip_m + layout.tip_rotation * case.payload.cg_m
}

impl Wrench {
    fn of(force: Vector3<f64>, at_m: &Vector3<f64>, about_m: &Vector3<f64>) -> Self {
        Self { force, moment: (at_m - about_m).cross(&force) }
    }

    fn plus(self, other: Self) -> Self {
        Self { force: self.force + other.force, moment: self.moment + other.moment }
    }

    /// Components of the wrench along the axes of `frame`: three of the force, then three of the moment.
    fn in_frame(&self, frame: &Matrix3<f64>) -> [f64; 6] {
        let (force, moment) = (frame.tr_mul(&self.force), frame.tr_mul(&self.moment));
        [force.x, force.y, force.z, moment.x, moment.y, moment.z]
    }
}

impl Carried {
    /// Component of the force along `direction`, as a linear function of the loads.
    pub(super) fn force_along(&self, direction: &Vector3<f64>) -> Linear {
        self.linear(|wrench| direction.dot(&wrench.force))
    }

    /// Component of the moment about `axis`, as a linear function of the loads.
    pub(super) fn moment_about(&self, axis: &Vector3<f64>) -> Linear {
        self.linear(|wrench| axis.dot(&wrench.moment))
    }

    fn linear(&self, part: impl Fn(&Wrench) -> f64) -> Linear {
        Linear { fixed: part(&self.fixed), per_load: self.per_load.iter().map(part).collect() }
    }
}

impl<'a> Builder<'a> {
    /// Collects the inputs of a case. Its inertia matrices will be made over `coordinates`.
    pub(super) fn new(
        question: &Question,
        structure: &Structure,
        case: &LoadCase,
        layout: &'a Layout,
        coordinates: &'a [Coordinate],
    ) -> Self {
        let weight = payload_weight(question, case, water_of(structure, case));
        let tip_loads = [(weight, payload_at(layout, case)), (case.tip_force_n, layout.tip_m)];
        Self {
            layout,
            gravity_m_s2: question.gravity_m_s2,
            down: question.down,
            tip_loads,
            tip_moment_nm: case.tip_moment_nm,
            coordinates,
        }
    }

    /// These inputs, but with the coordinates `coordinates` for the inertia matrices.
    pub(super) fn with_coordinates(&self, coordinates: &'a [Coordinate]) -> Self {
        Self { coordinates, ..*self }
    }
}

impl Builder<'_> {
    /// Force and moment that the section of the arm at `point` transmits from everything outboard, taken about this
    /// point.
    pub(super) fn carried(&self, point: &Point) -> Carried {
        let down = |size: f64| self.down * size;
        let about_m = &point.at_m;
        let none = Wrench::default();
        let tip = self.tip_loads.iter().map(|(force, at_m)| Wrench::of(*force, at_m, about_m));
        let masses = self.layout.masses.iter().filter(|mass| mass.is_outboard_of(point));
        let masses = masses.map(|m| Wrench::of(down(m.mass_kg * self.gravity_m_s2), &m.centre_m(), about_m));
        let drives = self.layout.joints.iter().map(|joint| match joint.rank > point.rank {
            true => Wrench::of(down(self.gravity_m_s2), &joint.at_m, about_m),
            false => none,
        });
        let tubes = self.layout.tubes.iter().map(|tube| {
            let from_m = match (tube.rank.cmp(&point.rank), point.inside_m) {
                (std::cmp::Ordering::Greater, _) => 0.0,
                (std::cmp::Ordering::Equal, Some(x)) => x,
                _ => return none,
            };
            let middle_m = tube.root_m + tube.frame.column(0) * (0.5 * (from_m + tube.length_m));
            Wrench::of(down(tube.length_m - from_m), &middle_m, about_m)
        });
        let moment = Wrench { moment: self.tip_moment_nm, ..none };
        Carried {
            fixed: tip.chain(masses).fold(moment, Wrench::plus),
            per_load: drives.chain(tubes).collect(),
        }
    }

    fn torque(&self, joint: usize) -> Linear {
        let joint = &self.layout.joints[joint];
        let carried = self.carried(&Point { at_m: joint.at_m, rank: joint.rank, inside_m: None });
        carried.moment_about(&joint.axis)
    }

    /// Displacement of the tip if the bearing of `joint` had a compliance of 1 rad/(N m). The joint's two axes of tilt
    /// are at right angles to its own axis. The moment about each axis of tilt is multiplied by the displacement of
    /// the tip per tilt about this axis.
    fn by_tilt(&self, joint: usize) -> LinearVector {
        let joint = &self.layout.joints[joint];
        let carried = self.carried(&Point { at_m: joint.at_m, rank: joint.rank, inside_m: None });
        let tip_m = self.layout.tip_m - joint.at_m;
        let moved = |wrench: &Wrench| -> Vector3<f64> {
            joint.across.iter().map(|axis| axis.cross(&tip_m) * axis.dot(&wrench.moment)).sum()
        };
        LinearVector { fixed: moved(&carried.fixed), per_load: carried.per_load.iter().map(moved).collect() }
    }

    /// Displacement of the tip by a spring: the deflection of the spring under the moment about its axis (or the
    /// force along it), times the displacement of the tip per unit of that deflection.
    fn by_spring(&self, spring: usize) -> LinearVector {
        let spring = &self.layout.springs[spring];
        let carried = self.carried(&Point { at_m: spring.at_m, rank: spring.rank, inside_m: None });
        let along_m = spring.way(&self.layout.tip_m).moved * spring.compliance;
        let load = match spring.slides {
            true => carried.force_along(&spring.axis),
            false => carried.moment_about(&spring.axis),
        };
        LinearVector {
            fixed: along_m * load.fixed,
            per_load: load.per_load.iter().map(|load| along_m * *load).collect(),
        }
    }

    /// The point of a tube's axis at the distance `x` from its root.
    fn inside(&self, tube: usize, x: f64) -> Point {
        let tube = &self.layout.tubes[tube];
        Point { at_m: tube.root_m + tube.frame.column(0) * x, rank: tube.rank, inside_m: Some(x) }
    }

    fn ends(&self, tube: usize) -> [[Linear; 6]; 2] {
        let placed = &self.layout.tubes[tube];
        [0.0, placed.length_m].map(|x| {
            let carried = self.carried(&self.inside(tube, x));
            let fixed = carried.fixed.in_frame(&placed.frame);
            let per_load: Vec<[f64; 6]> =
                carried.per_load.iter().map(|wrench| wrench.in_frame(&placed.frame)).collect();
            std::array::from_fn(|i| Linear {
                fixed: fixed[i],
                per_load: per_load.iter().map(|wrench| wrench[i]).collect(),
            })
        })
    }

    fn works(&self, tube: usize) -> [LinearVector; STIFFNESSES] {
        let placed = &self.layout.tubes[tube];
        let loads = self.layout.joints.len() + self.layout.tubes.len();
        let mut works: [LinearVector; STIFFNESSES] = std::array::from_fn(|_| LinearVector {
            fixed: Vector3::zeros(),
            per_load: vec![Vector3::zeros(); loads],
        });
        for (x, length_m) in self.quadrature(tube) {
            let point = self.inside(tube, x);
            let carried = self.carried(&point);
            let units = [Vector3::x(), Vector3::y(), Vector3::z()]
                .map(|e| Wrench::of(e, &self.layout.tip_m, &point.at_m).in_frame(&placed.frame));
            let parts = |real: &Wrench| products(&real.in_frame(&placed.frame), &units, length_m);
            for (work, part) in works.iter_mut().zip(parts(&carried.fixed)) {
                work.fixed += part;
            }
            for (load, real) in carried.per_load.iter().enumerate() {
                for (work, part) in works.iter_mut().zip(parts(real)) {
                    work.per_load[load] += part;
                }
            }
        }
        works
    }

    /// Points of quadrature along a tube \[m\], each with its weight \[m\]. The tube is divided at every body on
    /// it, because the internal loads have a step there.
    fn quadrature(&self, tube: usize) -> Vec<(f64, f64)> {
        let placed = &self.layout.tubes[tube];
        let on_tube = self.layout.masses.iter().filter(|mass| mass.carrier.rank == placed.rank);
        let mut cuts: Vec<f64> = on_tube.filter_map(|mass| mass.carrier.inside_m).collect();
        cuts.extend([0.0, placed.length_m]);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let parts = cuts.windows(2).flat_map(|part| {
            let length_m = part[1] - part[0];
            GAUSS.map(|(xi, weight)| (part[0] + xi * length_m, weight * length_m))
        });
        parts.collect()
    }

    /// Inertia matrix, over all coordinates, of the payload and of the masses that are the same in all designs.
    pub(super) fn fixed_inertia(&self, case: &LoadCase) -> Vec<f64> {
        let mut out = self.no_inertia();
        let rotation = &self.layout.tip_rotation;
        let payload = Point { at_m: payload_at(self.layout, case), rank: usize::MAX, inside_m: None };
        let spin = Matrix3::from_diagonal(&case.payload.inertia_about_cg_kgm2.map(|i| i.max(0.0).sqrt()));
        let Motions { moved, turned } = self.motions(&payload);
        for axis in 0..3 {
            add_square(&mut out, &along(&moved, &Vector3::ith(axis, 1.0)), case.payload.mass_kg);
            add_square(&mut out, &along(&turned, &(rotation * spin.column(axis))), 1.0);
        }
        for mass in &self.layout.masses {
            let Motions { mut moved, turned } = self.motions(&mass.carrier);
            moved.iter_mut().zip(&turned).for_each(|(moved, turned)| *moved += turned.cross(&mass.arm_m));
            for axis in 0..3 {
                add_square(&mut out, &along(&moved, &Vector3::ith(axis, 1.0)), mass.mass_kg);
            }
            if mass.inertia_kgm2 != Matrix3::zeros() {
                let principal = SymmetricEigen::new(mass.inertia_kgm2);
                for (axis, moment) in principal.eigenvectors.column_iter().zip(&principal.eigenvalues) {
                    add_square(&mut out, &along(&turned, &axis.into_owned()), moment.max(0.0));
                }
            }
        }
        out
    }

    pub(super) fn inertia_per(&self) -> Vec<Vec<f64>> {
        let drives = self.layout.joints.iter().map(|joint| {
            let mut out = self.no_inertia();
            let Motions { moved, .. } =
                self.motions(&Point { at_m: joint.at_m, rank: joint.rank, inside_m: None });
            for axis in 0..3 {
                add_square(&mut out, &along(&moved, &Vector3::ith(axis, 1.0)), 1.0);
            }
            out
        });
        let tubes = (0..self.layout.tubes.len()).flat_map(|tube| self.tube_inertia(tube));
        drives.chain(tubes).collect()
    }

    /// Inertia matrices of a tube over all coordinates, one per unit of each of its inertias per length. Each is a
    /// lower triangle, row by row.
    fn tube_inertia(&self, tube: usize) -> [Vec<f64>; DENSITIES] {
        let mut out: [Vec<f64>; DENSITIES] = std::array::from_fn(|_| self.no_inertia());
        let placed = &self.layout.tubes[tube];
        for (xi, weight) in GAUSS {
            let weight_m = weight * placed.length_m;
            let Motions { moved, turned } = self.motions(&self.inside(tube, xi * placed.length_m));
            for axis in 0..3 {
                let direction = placed.frame.column(axis).into_owned();
                add_square(&mut out[axis.min(1)], &along(&moved, &direction), weight_m);
                add_square(&mut out[2 + axis], &along(&turned, &direction), weight_m);
            }
        }
        out
    }

    fn motions(&self, point: &Point) -> Motions {
        let each = self.coordinates.iter().map(|&coordinate| self.layout.motion(coordinate, point));
        let (moved, turned) = each.map(|motion| (motion.moved, motion.turned)).unzip();
        Motions { moved, turned }
    }

    fn no_inertia(&self) -> Vec<f64> {
        let n = self.coordinates.len();
        vec![0.0; n * (n + 1) / 2]
    }
}

/// One vector for each stiffness of a tube, by the method of the unit load. Its x, y and z entries are the real
/// internal load that the stiffness resists, times the same internal load of a unit tip force along the world's x, y or
/// z axis, times the length `length_m`.
fn products(real: &[f64; 6], units: &[[f64; 6]; 3], length_m: f64) -> [Vector3<f64>; STIFFNESSES] {
    let product = |i: usize| Vector3::from_fn(|axis, _| real[i] * units[axis][i] * length_m);
    [product(4), product(5), product(1) + product(2), product(3), product(0)]
}

fn along(motions: &[Vector3<f64>], direction: &Vector3<f64>) -> Vec<f64> {
    motions.iter().map(|motion| motion.dot(direction)).collect()
}

/// Adds the matrix `weight · row rowᵀ` to the lower triangle `triangle` of a symmetric matrix.
fn add_square(triangle: &mut [f64], row: &[f64], weight: f64) {
    let mut entries = triangle.iter_mut();
    for (i, a) in row.iter().enumerate() {
        for (b, entry) in row[..=i].iter().zip(&mut entries) {
            *entry += weight * a * b;
        }
    }
}
