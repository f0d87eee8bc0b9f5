//! Loads on the output bearing of a joint, as intervals over the members of a box.
//!
//! A bearing carries the wrench of everything outboard: of gravity and load, and of the ramp or the stop of one joint while
//! the others are at rest ([`bearing_loads`](crate::space::bearing_loads)). Every component of such a wrench is linear in
//! the weights and the inertias of the parts, so it is an interval. A load is the length of a vector of components. Its
//! least value takes each component at its least size, its greatest each at its greatest. For a box of one design both are
//! the load itself.

use super::parts::INERTIAS;
use crate::mechanics::{Twist, Wrench, linear, rotation_twist, stack};
use crate::sizing::bearing::{BearingDemand, BearingLoad};
use nalgebra::{Matrix6, Vector3};

/// A coefficient below this part of what the wrench could make of it is rounding.
const NOTHING: f64 = 1e-13;
/// Components of a load: moments about the two axes across, forces along them, and the force along the axis.
const COMPONENTS: usize = 5;
/// The components whose length is the moment, the radial force and the axial force.
const MOMENT: [usize; 2] = [0, 1];
const RADIAL: [usize; 2] = [2, 3];
const AXIAL: [usize; 1] = [4];

/// The loads on the bearing of one joint in one case.
pub(super) struct BearingRows {
    /// Of gravity and load, over the weight of each piece \[N\].
    at_rest: Components,
    /// Of the ramp of each joint, over the line inertias of each piece, [`INERTIAS`] places each.
    ramps: Vec<Components>,
}

/// The components of a load.
type Components = [Sum; COMPONENTS];

/// `fixed + Σ coefficient · number`, over those numbers that count.
#[derive(Default)]
struct Sum {
    fixed: f64,
    terms: Vec<(usize, f64)>,
}

/// The numbers of a box: weights in the case as intervals \[N\], least and greatest line inertias of each piece.
pub(super) struct Numbers<'a> {
    pub weights_n: &'a [[f64; 2]],
    pub light: &'a [[f64; INERTIAS]],
    pub heavy: &'a [[f64; INERTIAS]],
}

/// What is outboard of some joint: a constant wrench, and that of each piece.
pub(super) struct Loads<'a> {
    /// Wrench of payload, tip force and given bodies.
    pub fixed: Wrench,
    /// Wrench of each piece per newton of its weight.
    pub per_n: &'a [Wrench],
}

/// What moves with a joint: its acceleration as a twist, and the inertia that it accelerates.
pub(super) struct Ramp<'a> {
    /// Twist of the joint times its acceleration.
    pub acceleration: Twist,
    /// Inertia of payload and given bodies that move with the joint.
    pub fixed: Matrix6<f64>,
    /// Inertia of each piece that moves with the joint, per unit of each line inertia.
    pub inertia: &'a [[Matrix6<f64>; INERTIAS]],
}

/// The axes about and along which the components of a load are taken.
struct Frame([Twist; COMPONENTS]);

impl Frame {
    /// The frame of a joint at a point with two axes across its own.
    fn new(at_m: &Vector3<f64>, axis: &Vector3<f64>, [first, second]: &[Vector3<f64>; 2]) -> Self {
        let along = |direction: &Vector3<f64>| stack(direction, &Vector3::zeros());
        let about = |direction: &Vector3<f64>| rotation_twist(direction, at_m);
        Self([about(first), about(second), along(first), along(second), along(axis)])
    }

    /// The components of a wrench.
    fn components(&self, wrench: &Wrench) -> [f64; COMPONENTS] {
        self.0.each_ref().map(|unit| {
            let component = unit.dot(wrench);
            let scale = unit.abs().dot(&wrench.abs()) + linear(wrench).norm();
            if component.abs() > NOTHING * scale { component } else { 0.0 }
        })
    }

    /// The components of a constant wrench and of wrenches per number.
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
    /// The loads on the bearing of a joint at a point, with two axes across its own.
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
            frame.sums(&(ramp.fixed * ramp.acceleration), lines.enumerate())
        };
        // A joint whose ramp loads nothing here need not be looked at for every box.
        let counts = |sums: &Components| sums.iter().any(|sum| sum.fixed != 0.0 || !sum.terms.is_empty());
        Self { at_rest, ramps: ramps.map(of_ramp).filter(counts).collect() }
    }

    /// The least and the greatest loads, before levers along the axis.
    pub(super) fn loads(&self, numbers: &Numbers, stop_factor: f64) -> [BearingDemand; 2] {
        let at_rest = self.at_rest.each_ref().map(|sum| sum.between_weights(numbers.weights_n));
        let rest = lengths(&at_rest);
        let [mut running, mut in_stop] = [rest; 2];
        for ramp in &self.ramps {
            let ramp = ramp
                .each_ref()
                .map(|sum| sum.between_inertias(numbers.light.as_flattened(), numbers.heavy.as_flattened()));
            for sign in [1.0, -1.0] {
                widen(&mut running, lengths(&moving(&at_rest, &ramp, sign)));
                widen(&mut in_stop, lengths(&moving(&at_rest, &ramp, sign * stop_factor)));
            }
        }
        [0, 1].map(|end| BearingDemand { at_rest: rest[end], running: running[end], in_stop: in_stop[end] })
    }

    /// Whether no load can fall when a drive gets heavier.
    ///
    /// The length of a sum of vectors grows with the share of one of them if that one has no negative dot product with any
    /// other. For `a` at rest and `b` of a ramp, the greater of `|a + b|` and `|a - b|` grows if `|a|`, `|b|` and `|a·b|` do,
    /// and `|a·b|` grows if all products of a share of `a` and a share of `b` have one sign.
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
                    let ramp = shares(ramp, places);
                    let products = || at_rest.iter().flat_map(|(_, a)| ramp.iter().map(|(_, b)| dot(a, b)));
                    grows(&ramp, INERTIAS) && (products().all(|p| p >= 0.0) || products().all(|p| p <= 0.0))
                })
        })
    }
}

/// The share of one number, or of what is given (`None`), in some components of a load.
type Share = (Option<usize>, [f64; COMPONENTS]);

/// The shares of all numbers in the components at some places.
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

/// The dot product of two shares; 0 if it is rounding.
fn dot(a: &[f64; COMPONENTS], b: &[f64; COMPONENTS]) -> f64 {
    let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let scale: f64 = a.iter().zip(b).map(|(a, b)| (a * b).abs()).sum();
    if product.abs() > 1e-9 * scale { product } else { 0.0 }
}

impl Sum {
    /// The interval of the sum over weights.
    fn between_weights(&self, weights_n: &[[f64; 2]]) -> [f64; 2] {
        self.terms.iter().fold([self.fixed; 2], |[low, high], &(at, c)| {
            let [a, b] = weights_n[at].map(|weight| c * weight);
            [low + a.min(b), high + a.max(b)]
        })
    }

    /// The interval of the sum over line inertias.
    fn between_inertias(&self, light: &[f64], heavy: &[f64]) -> [f64; 2] {
        self.terms.iter().fold([self.fixed; 2], |[low, high], &(at, c)| {
            let (a, b) = (c * light[at], c * heavy[at]);
            [low + a.min(b), high + a.max(b)]
        })
    }
}

/// The components of a load at rest plus a ramp times a factor.
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

/// The least and the greatest load of components in intervals.
fn lengths(components: &[[f64; 2]; COMPONENTS]) -> [BearingLoad; 2] {
    let sizes = components.map(|[low, high]| [low.max(-high).max(0.0), high.max(-low)]);
    [0, 1].map(|end| {
        let length = |[a, b]: [usize; 2]| sizes[a][end].hypot(sizes[b][end]);
        BearingLoad { moment_nm: length(MOMENT), radial_n: length(RADIAL), axial_n: sizes[AXIAL[0]][end] }
    })
}

/// Makes each end of a load the larger of two.
fn widen(load: &mut [BearingLoad; 2], other: [BearingLoad; 2]) {
    for (load, other) in load.iter_mut().zip(other) {
        *load = load.max(other);
    }
}
