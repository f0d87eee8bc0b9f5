//! Loads on the output bearing of a joint, as intervals over the members of a box.
//!
//! A box is a set of designs; its members are these designs. A piece is a joint with its drive, or a link.
//!
//! A bearing transmits the wrench of everything outboard. This is the wrench of gravity and load, and the wrench that
//! arises while one joint accelerates (its ramp) or stops and the other joints are at rest
//! ([`bearing_loads`](crate::space::bearing_loads)). Every component of such a wrench is linear in the weights and the
//! inertias of the parts, so its range over a box is an interval. A load (moment, radial or axial force) is the length
//! of a vector of components. The least load takes each component at its least magnitude, the greatest load takes each
//! component at its greatest. For a box of one design both loads equal the load of this design.

use super::parts::INERTIAS;
use crate::mechanics::{Twist, Wrench, linear, rotation_twist, stack};
use crate::sizing::bearing::{BearingDemand, BearingLoad};
use nalgebra::{Matrix6, Vector3};

/// A component of a wrench is set to zero if its magnitude is below this fraction of the greatest magnitude that a
/// component of this wrench could have. Such a component is due to rounding.
const RELATIVE_ROUNDING: f64 = 1e-13;
/// Number of components of a load: the moments about two axes at right angles to the joint axis, the forces along
/// these two axes, and the force along the joint axis.
const COMPONENTS: usize = 5;
/// Indices of the components that make up the moment, the radial force and the axial force. Each of these three is the
/// length of its components as a vector.
const MOMENT: [usize; 2] = [0, 1];
const RADIAL: [usize; 2] = [2, 3];
const AXIAL: [usize; 1] = [4];

/// The loads on the output bearing of one joint in one case, as linear functions of the weights and inertias of the
/// parts.
pub(super) struct BearingRows {
    /// Load components at rest, caused by gravity and the tip load \[N m for moments, N for forces\]. Each component is
    /// a linear function of the weights of the pieces \[N\].
    at_rest: Components,
    /// Load components that are added while one joint accelerates, one entry for each joint whose acceleration loads
    /// this bearing. Each component is a linear function of the line inertias (inertias per metre of a tube) of all
    /// pieces. Each piece has [`INERTIAS`] such numbers.
    ramps: Vec<RampRow>,
}

/// The additional load on a bearing while one joint accelerates.
struct RampRow {
    /// The load components that the acceleration adds to the components at rest.
    sums: Components,
    /// Ratio of the deceleration in the joint's emergency stop to its acceleration in the ramp, at least 1.
    stop_factor: f64,
}

/// The [`COMPONENTS`] components of a load, each as a linear function of the weights or inertias of the parts.
type Components = [Sum; COMPONENTS];

/// A linear function `fixed + Σ coefficient · number`. The numbers are the weights of the pieces or their line
/// inertias. `terms` has the index and the coefficient of each number whose coefficient is not zero.
#[derive(Default)]
struct Sum {
    fixed: f64,
    terms: Vec<(usize, f64)>,
}

/// The numbers of a box from which the loads follow: `weights_n` is the least and greatest weight of each piece in the
/// case \[N\]; `light` and `heavy` are the least and greatest line inertias (inertias per metre) of each piece.
pub(super) struct Numbers<'a> {
    pub weights_n: &'a [[f64; 2]],
    pub light: &'a [[f64; INERTIAS]],
    pub heavy: &'a [[f64; INERTIAS]],
}

/// The load at rest of everything outboard of a joint. It consists of the wrench of the loads and bodies that the
/// study gives, and of the wrench of each piece that has a weight of its own.
pub(super) struct Loads<'a> {
    /// Wrench of payload, tip force and the bodies that the study gives, about the world's origin.
    pub fixed: Wrench,
    /// Wrench of each piece per newton of its weight.
    pub per_n: &'a [Wrench],
}

/// The ramp of one joint (the time in which it accelerates): its acceleration as a twist, and the inertia that it
/// accelerates.
pub(super) struct Ramp<'a> {
    /// Twist of everything outboard per radian of the joint's angle, times the joint's angular acceleration \[rad/s²\].
    pub acceleration: Twist,
    /// Inertia matrix of the payload and of the bodies that the study gives, as far as they move with the joint.
    pub fixed: Matrix6<f64>,
    /// Inertia matrix of each piece that moves with the joint, per unit of each of its line inertias (inertias per
    /// metre of a tube).
    pub inertia: &'a [[Matrix6<f64>; INERTIAS]],
    /// Ratio of the deceleration in the joint's emergency stop to its acceleration in the ramp, at least 1.
    pub stop_factor: f64,
}

/// The directions of the components of a load, each as the twist of a unit motion. The first two motions turn about the
/// two axes at right angles to the joint axis. The other three move along these two axes and along the joint axis. The
/// dot product of such a twist and a wrench is one component.
struct Frame([Twist; COMPONENTS]);

impl Frame {
    /// The frame of a joint at the point `at_m` with the given `axis`. `first` and `second` are two directions at
    /// right angles to the axis.
    fn new(at_m: &Vector3<f64>, axis: &Vector3<f64>, [first, second]: &[Vector3<f64>; 2]) -> Self {
        let along = |direction: &Vector3<f64>| stack(direction, &Vector3::zeros());
        let about = |direction: &Vector3<f64>| rotation_twist(direction, at_m);
        Self([about(first), about(second), along(first), along(second), along(axis)])
    }

    /// The moments and forces of `wrench` about and along the axes of this frame. A component that is only due to
    /// rounding becomes zero.
    fn components(&self, wrench: &Wrench) -> [f64; COMPONENTS] {
        self.0.each_ref().map(|unit| {
            let component = unit.dot(wrench);
            let scale = unit.abs().dot(&wrench.abs()) + linear(wrench).norm();
            if component.abs() > RELATIVE_ROUNDING * scale { component } else { 0.0 }
        })
    }

    /// The components of the wrench `fixed + Σ wrench · number`, each as a linear function of the numbers. `wrenches`
    /// has the index of each number (a weight or an inertia) and the wrench per unit of it.
    fn sums(&self, fixed: &Wrench, wrenches: impl Iterator<Item = (usize, Wrench)>) -> Components {
        let mut sums: Components = self.components(fixed).map(|fixed| Sum { fixed, terms: Vec::new() });
        for (number, wrench) in wrenches {
            for (sum, coefficient) in sums.iter_mut().zip(self.components(&wrench)) {
                if coefficient != 0.0 {
                    sum.terms.push((number, coefficient));
                }
            }
        }
        sums
    }
}

impl BearingRows {
    /// Prepares the loads on the bearing of a joint that lies at `at_m` and turns about `axis`. `across` are two
    /// directions at right angles to the axis. `loads` act at rest, and `ramps` are the accelerations of each joint.
    pub(super) fn new<'a>(
        [at_m, axis]: [&Vector3<f64>; 2],
        across: &[Vector3<f64>; 2],
        loads: &Loads,
        ramps: impl Iterator<Item = Ramp<'a>>,
    ) -> Self {
        let frame = Frame::new(at_m, axis, across);
        let at_rest = frame.sums(&loads.fixed, loads.per_n.iter().copied().enumerate());
        let of_ramp = |ramp: Ramp| {
            let lines = ramp.inertia.as_flattened().iter().map(|form| form * ramp.acceleration);
            RampRow {
                sums: frame.sums(&(ramp.fixed * ramp.acceleration), lines.enumerate()),
                stop_factor: ramp.stop_factor,
            }
        };
        // A joint whose ramp does not load this bearing is left out, so that it takes no time in any box.
        let counts = |row: &RampRow| row.sums.iter().any(|sum| sum.fixed != 0.0 || !sum.terms.is_empty());
        Self { at_rest, ramps: ramps.map(of_ramp).filter(counts).collect() }
    }

    /// Least and greatest loads on the output bearing over the box, in this order: moment, radial and axial force at
    /// rest, while a joint accelerates, and in an emergency stop. The moment of the radial force about the bearing
    /// (force times the distance along the axis to the link) is left out; the caller adds it.
    pub(super) fn loads(&self, numbers: &Numbers) -> [BearingDemand; 2] {
        let at_rest = self.at_rest.each_ref().map(|sum| sum.between_weights(numbers.weights_n));
        let rest = squared_lengths(&at_rest);
        let [mut running, mut in_stop] = [rest; 2];
        for RampRow { sums, stop_factor } in &self.ramps {
            let ramp = sums
                .each_ref()
                .map(|sum| sum.between_inertias(numbers.light.as_flattened(), numbers.heavy.as_flattened()));
            for sign in [1.0, -1.0] {
                widen(&mut running, squared_lengths(&moving(&at_rest, &ramp, sign)));
                widen(&mut in_stop, squared_lengths(&moving(&at_rest, &ramp, sign * stop_factor)));
            }
        }
        [0, 1].map(|end| BearingDemand {
            at_rest: load(&rest[end]),
            running: load(&running[end]),
            in_stop: load(&in_stop[end]),
        })
    }

    /// Whether none of the three loads on the bearing (moment, radial force, axial force) can fall when a drive gets
    /// heavier. `is_drive` tells whether the piece with a given index is a drive.
    ///
    /// The length of a sum of vectors grows with one contribution if this contribution has no negative dot product with
    /// any other. For `a` at rest and `b` of a ramp, the greater of `|a + b|` and `|a - b|` grows if `|a|`, `|b|` and
    /// `|a·b|` do. `|a·b|` grows if all products of a contribution to `a` and a contribution to `b` have one sign.
    pub(super) fn grow_with_mass(&self, is_drive: &impl Fn(usize) -> bool) -> bool {
        [&MOMENT[..], &RADIAL, &AXIAL].into_iter().all(|places| {
            let at_rest = shares(&self.at_rest, places);
            let of_drive = |number: &Option<usize>, per: usize| number.is_some_and(|n| is_drive(n / per));
            let grows = |shares: &[Share], per: usize| {
                let drives = shares.iter().filter(|(number, _)| of_drive(number, per));
                drives.into_iter().all(|(_, drive)| shares.iter().all(|(_, other)| dot(drive, other) >= 0.0))
            };
            grows(&at_rest, 1)
                && self.ramps.iter().all(|ramp| {
                    let ramp = shares(&ramp.sums, places);
                    let products = || at_rest.iter().flat_map(|(_, a)| ramp.iter().map(|(_, b)| dot(a, b)));
                    grows(&ramp, INERTIAS) && (products().all(|p| p >= 0.0) || products().all(|p| p <= 0.0))
                })
        })
    }
}

/// The contribution of one weight or one line inertia to some components of a load, per unit of it. Without an index
/// (`None`), it is the constant contribution of payload, tip force and the bodies that the study gives.
type Share = (Option<usize>, [f64; COMPONENTS]);

/// The contributions to the load components with the indices `places`. The contribution of the given bodies comes
/// first, and then one contribution for each weight or inertia in `sums`.
fn shares(sums: &Components, places: &[usize]) -> Vec<Share> {
    let mut shares: Vec<Share> = vec![(None, [0.0; COMPONENTS])];
    for &place in places {
        shares[0].1[place] = sums[place].fixed;
        for &(number, coefficient) in &sums[place].terms {
            let at = match shares.iter().position(|(of, _)| *of == Some(number)) {
                Some(at) => at,
                None => {
                    shares.push((Some(number), [0.0; COMPONENTS]));
                    shares.len() - 1
                }
            };
            shares[at].1[place] = coefficient;
        }
    }
    shares
}

/// The dot product of two contributions. It is 0 if its magnitude is at most 1e-9 of the sum of the magnitudes of its
/// terms, because then it is rounding.
fn dot(a: &[f64; COMPONENTS], b: &[f64; COMPONENTS]) -> f64 {
    let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let scale: f64 = a.iter().zip(b).map(|(a, b)| (a * b).abs()).sum();
    if product.abs() > 1e-9 * scale { product } else { 0.0 }
}

impl Sum {
    /// The least and the greatest value of this sum if each weight lies in its interval of `weights_n` \[N\].
    fn between_weights(&self, weights_n: &[[f64; 2]]) -> [f64; 2] {
        self.terms.iter().fold([self.fixed; 2], |[low, high], &(at, c)| {
            let [a, b] = weights_n[at].map(|weight| c * weight);
            [low + a.min(b), high + a.max(b)]
        })
    }

    /// The least and the greatest value of this sum if each line inertia lies between its entries of `light` and
    /// `heavy`.
    fn between_inertias(&self, light: &[f64], heavy: &[f64]) -> [f64; 2] {
        self.terms.iter().fold([self.fixed; 2], |[low, high], &(at, c)| {
            let (a, b) = (c * light[at], c * heavy[at]);
            [low + a.min(b), high + a.max(b)]
        })
    }
}

/// The load components of a moving arm, as intervals: the components `at_rest` plus `times` the components `ramp` that
/// one accelerating joint adds.
#[inline]
fn moving(
    at_rest: &[[f64; 2]; COMPONENTS],
    ramp: &[[f64; 2]; COMPONENTS],
    times: f64,
) -> [[f64; 2]; COMPONENTS] {
    std::array::from_fn(|k| {
        let [a, b] = ramp[k].map(|x| times * x);
        [at_rest[k][0] + a.min(b), at_rest[k][1] + a.max(b)]
    })
}

/// Squares of the moment \[N² m²\], of the radial force and of the axial force \[N²\]. The largest load has the largest
/// square, so the root is taken only once, after all ramps are compared.
type Squares = [f64; 3];

/// Squares of the least and of the greatest loads (moment, radial force, axial force), if each component lies in its
/// interval of `components`.
#[inline]
fn squared_lengths(components: &[[f64; 2]; COMPONENTS]) -> [Squares; 2] {
    let mut squares = [[0.0; COMPONENTS]; 2];
    for (at, [low, high]) in components.iter().enumerate() {
        let sizes = [low.max(-high).max(0.0), high.max(-low)];
        squares[0][at] = sizes[0] * sizes[0];
        squares[1][at] = sizes[1] * sizes[1];
    }
    squares.map(|of| [of[MOMENT[0]] + of[MOMENT[1]], of[RADIAL[0]] + of[RADIAL[1]], of[AXIAL[0]]])
}

/// Replaces each of the least and greatest loads in `load` by the corresponding load in `other` if that is larger. The
/// largest load over all ramps counts, so its least value over the box is the largest of the least values.
fn widen(load: &mut [Squares; 2], other: [Squares; 2]) {
    for (load, other) in load.iter_mut().flatten().zip(other.iter().flatten()) {
        *load = load.max(*other);
    }
}

/// The bearing load whose moment, radial force and axial force have these squares.
fn load(squares: &Squares) -> BearingLoad {
    let [moment_nm, radial_n, axial_n] = squares.map(f64::sqrt);
    BearingLoad { moment_nm, radial_n, axial_n }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::exact::box_work::BoxWork;
    use crate::exact::kinds::Ties;
    use crate::exact::parts::inertia;
    use crate::exact::problem::{Part, Problem};
    use crate::input::Document;
    use crate::space::ArmProblem;
    use crate::space::problem::Partial;
    use crate::study::{Study, read_study};
    use proptest::prelude::*;
    use serde_json::json;
    use std::collections::BTreeSet;

    /// A study of an arm with three joints whose drives are sized, in the pose `pose_deg` and in the stretched pose.
    /// The upper arm, between the second and the third joint, has an offset of `side_m` to the side. `tip_n` is the
    /// force at the tip along y.
    fn study(pose_deg: [f64; 3], side_m: f64, tip_n: f64, catalogs: &Catalogs) -> Study {
        let drives =
            json!({"gear_series": ["CSG"], "ratios": [100], "motor_models": ["ILM70x18", "ILM85x26"]});
        let joint = |name: &str, axis: [f64; 3], drive: &str| json!({"type": "joint", "name": name, "axis": axis, "drive": drive, "drives": drives});
        let text = json!({"name": "loads", "chain": [
            joint("waist", [0.0, 0.0, 1.0], "first_fit"),
            {"type": "link", "name": "column", "vector_m": [0, 0, 0.3], "mass_kg": 3},
            joint("shoulder", [0.0, 1.0, 0.0], "all_fits"),
            {"type": "link", "name": "upper_arm", "vector_m": [0.6, side_m, 0], "choose": {"materials": ["Aluminium 6061-T6", "Structural steel S355"],
                "sections": [{"shape": "rectangular_tube", "width_mm": [60, 120], "height_mm": [80, 110], "wall_mm": [3]},
                             {"shape": "round_tube", "diameter_mm": [70, 100], "wall_mm": [4]}]}},
            joint("elbow", [0.0, 1.0, 0.0], "all_fits"),
            {"type": "link", "name": "forearm", "vector_m": [0.4, 0, 0], "mass_kg": 1}],
            "payload": {"mass_kg": 3, "cg_m": [0.05, side_m / 5.0, 0.03], "inertia_about_cg_kgm2": [0.01, 0.02, 0.015]},
            "tip_force_n": [0, tip_n, -10],
            "poses": [{"pose_deg": pose_deg}, {"pose_deg": [0, 0, 0]}],
            "motion": {"tip_speed_m_s": 1.0, "ramp_time_s": 0.2}});
        let document = Document::parse("loads", &text.to_string()).expect("JSON");
        read_study(document, catalogs).unwrap_or_else(|fault| panic!("{fault}"))
    }

    fn numbers(demand: &BearingDemand) -> [f64; 9] {
        let of = |load: BearingLoad| [load.moment_nm, load.radial_n, load.axial_n];
        let all = [of(demand.at_rest), of(demand.running), of(demand.in_stop)];
        std::array::from_fn(|k| all[k / 3][k % 3])
    }

    /// Whether each number of `demand` lies between the corresponding numbers of the two demands in `ends`, up to a
    /// relative tolerance.
    fn is_between(demand: &BearingDemand, ends: &[BearingDemand; 2], tolerance: f64) -> bool {
        let [low, high] = ends.each_ref().map(numbers);
        let slack = |x: f64| tolerance * (1.0 + x);
        numbers(demand).iter().enumerate().all(|(k, x)| low[k] - slack(*x) <= *x && *x <= high[k] + slack(*x))
    }

    /// The loads on every joint of a design whose drive is sized, tip first, as they are computed while its arm is
    /// built up from the tip. `None` if some part cannot carry its load.
    fn walked(problem: &ArmProblem, options: &[u32]) -> Option<Vec<BearingDemand>> {
        let mut loads = Vec::new();
        let see = |slot: usize, outboard: &Partial| {
            if problem.sized_joint(problem.piece_of_slot(slot)).is_some() {
                loads.push(problem.demand_at(outboard, slot).bearing);
            }
        };
        problem.walk(options, see).ok()?;
        Some(loads)
    }

    /// The least and greatest loads of a box on every joint whose drive is sized, tip first.
    fn of_box(
        problem: &Problem,
        design_box: &mut [u32],
        work: &mut BoxWork,
    ) -> Option<Vec<[BearingDemand; 2]>> {
        problem.fill(design_box, work)?;
        let sized = problem
            .parts
            .iter()
            .enumerate()
            .filter(|(_, part)| matches!(part, Part::Drives { .. } | Part::FirstFit { .. }));
        Some(sized.map(|(piece, _)| problem.bearing_loads(piece, work)).collect())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// The box of one design has exactly the design's loads, and the box of all designs encloses them.
        #[test]
        fn loads_of_a_box_enclose_those_of_its_members(
            pose_deg in prop::array::uniform3(-150.0f64..150.0), side_m in prop::sample::select(vec![0.0, 0.1]),
            tip_n in prop::sample::select(vec![0.0, 25.0]), picks in prop::collection::vec(any::<u32>(), 72),
        ) {
            let catalogs = Catalogs::builtin();
            let study = study(pose_deg, side_m, tip_n, &catalogs);
            let arms = ArmProblem::new(&study.space, &catalogs);
            let problem = Problem::new(&study.space, &catalogs, &|_| true, Ties::Separate).expect("options");
            let mut work = BoxWork::default();
            let all = of_box(&problem, &mut problem.root(), &mut work).expect("some arm holds");
            let mut held = 0;
            for picks in picks.chunks(3) {
                let options: Vec<u32> = picks.iter().zip(&problem.level_sizes).map(|(p, n)| p % n).collect();
                let leaf = |(&piece, &option): (&usize, &u32)| {
                    let wanted = BTreeSet::from([option]);
                    match &problem.parts[piece] {
                        Part::Drives { tree, .. } => tree.leaves_of(&wanted)[&option],
                        Part::Links { tree, .. } => tree.leaves_of(&wanted)[&option],
                        _ => 0,
                    }
                };
                let mut design_box: Vec<u32> = problem.level_pieces.iter().zip(&options).map(leaf).collect();
                let of_box = of_box(&problem, &mut design_box, &mut work);
                let of_arm = walked(&arms, &options);
                prop_assert_eq!(of_box.is_some(), of_arm.is_some(), "{:?}", options);
                let (Some(of_box), Some(of_arm)) = (of_box, of_arm) else { continue };
                prop_assert_eq!(of_arm.len(), 3);
                held += 1;
                for (joint, load) in of_arm.iter().enumerate() {
                    let [least, most] = of_box[joint];
                    prop_assert!(is_between(load, &[most, least], 1e-9), "{load:?} is not {:?}", of_box[joint]);
                    prop_assert!(is_between(load, &all[joint], 1e-9), "{load:?} is outside {:?}", all[joint]);
                }
            }
            prop_assume!(held > 0);
        }

        /// If `grow_with_mass` returns true, every load on the bearing grows with the mass of every drive, whatever the
        /// other parts weigh.
        #[test]
        fn loads_that_are_said_to_grow_with_a_drive_do(
            pose_deg in prop::array::uniform3(-60.0f64..60.0), side_m in prop::sample::select(vec![0.0, 0.1]),
            masses in prop::collection::vec(0.0f64..20.0, 16), more_kg in 0.1f64..10.0,
        ) {
            let catalogs = Catalogs::builtin();
            for pose_deg in [pose_deg, [0.0; 3], [pose_deg[0], 0.0, 0.0]] {
                let study = study(pose_deg, side_m, 0.0, &catalogs);
                let problem = Problem::new(&study.space, &catalogs, &|_| true, Ties::Separate).expect("options");
                let is_drive = |piece: usize| matches!(problem.parts[piece], Part::Drives { .. });
                for rows in problem.poses.iter().flat_map(|pose| pose.bearings.iter().flatten()) {
                    // With all joint angles zero and no offset to the side, the answer must be yes.
                    let grows = rows.grow_with_mass(&is_drive);
                    prop_assert!(grows || pose_deg != [0.0; 3] || side_m != 0.0);
                    if !grows {
                        continue;
                    }
                    let loads = |more: Option<usize>| {
                        let mass = |piece: usize| masses[piece % 16] + if more == Some(piece) { more_kg } else { 0.0 };
                        let pieces = 0..problem.parts.len();
                        let weights: Vec<[f64; 2]> = pieces.clone().map(|piece| [9.81 * mass(piece); 2]).collect();
                        let lines: Vec<[f64; INERTIAS]> = pieces
                            .map(|piece| std::array::from_fn(|k| if k == inertia::MASS { mass(piece) } else { 0.01 }))
                            .collect();
                        rows.loads(&Numbers { weights_n: &weights, light: &lines, heavy: &lines })[0]
                    };
                    for piece in (0..problem.parts.len()).filter(|piece| is_drive(*piece)) {
                        let (before, after) = (numbers(&loads(None)), numbers(&loads(Some(piece))));
                        prop_assert!(before.iter().zip(after).all(|(a, b)| *a <= b * (1.0 + 1e-12) + 1e-9), "{before:?} {after:?}");
                    }
                }
            }
        }
    }
}
