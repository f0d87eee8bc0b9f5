//! Loads on the output bearings in a pose, as sums over the weights and inertias of parts.
//!
//! A bearing carries everything outboard of its joint: its weight, and the inertia forces of one joint at a time that
//! ramps or stops while the others are at rest. By virtual work, the component of an inertia force or moment along a
//! direction is the coupling `Σ m (v · w)` of two motions: that of the joint which accelerates, and a *probe*, which moves
//! or tilts everything outboard of the bearing along that direction. Couplings are entries of the inertia matrix of
//! [`super::pose`] with probes as further coordinates. What is not outboard of both joints stands still in one of the two.

use super::bearing::{BearingDemand, BearingLoad};
use super::layout::{Coordinate, Point};
use super::pose::Builder;
use super::span::{Linear, Span};
use crate::arm::load::LoadCase;
use nalgebra::Vector3;

/// Force along two axes across the axis of a joint and along it, and moment about the two axes across.
type Components<T> = [T; COMPONENTS];
const COMPONENTS: usize = 5;

/// The bearing of a joint in a case.
pub(super) struct PosedBearing {
    /// Of the weights, linear in the loads.
    rest: Components<Linear>,
    /// Of the ramp of each joint, linear in the inertias.
    ramps: Vec<Components<Linear>>,
}

/// The least and the most that the loads on a bearing are so far.
#[derive(Default)]
pub(super) struct Largest([[Span; 3]; 3]);

/// The bearings of all joints in a case; `None` where nothing is checked. Joint by joint `accelerations_rad_s2` is the ramp's.
pub(super) fn bearings(
    builder: &Builder,
    case: &LoadCase,
    checked: &[bool],
    accelerations_rad_s2: &[f64],
) -> Vec<Option<PosedBearing>> {
    let joints = checked.len();
    let is_checked = |joint: &usize| checked[*joint];
    let probes = (0..joints).filter(is_checked).flat_map(probes_of);
    let coordinates: Vec<Coordinate> = (0..joints).map(Coordinate::Joint).chain(probes).collect();
    let probing = builder.with_coordinates(&coordinates);
    let (fixed, per_inertia) = (probing.fixed_inertia(case), probing.inertia_per());
    let mut first = joints;
    (0..joints)
        .map(|joint| {
            checked[joint].then(|| {
                let ramp = |(mover, acceleration_rad_s2): (usize, &f64)| {
                    std::array::from_fn(|component| {
                        let row = first + component;
                        let entry = row * (row + 1) / 2 + mover;
                        let per = per_inertia.iter().map(|per| per[entry] * acceleration_rad_s2);
                        Linear { fixed: fixed[entry] * acceleration_rad_s2, per_load: per.collect() }
                    })
                };
                let ramps = accelerations_rad_s2.iter().enumerate().map(ramp).collect();
                first += COMPONENTS;
                PosedBearing { rest: at_rest(builder, joint), ramps }
            })
        })
        .collect()
}

/// Motions of everything outboard of a joint, one for each component.
fn probes_of(joint: usize) -> Components<Coordinate> {
    [
        Coordinate::Shift(joint, 0),
        Coordinate::Shift(joint, 1),
        Coordinate::Shift(joint, 2),
        Coordinate::Tilt(joint, 0),
        Coordinate::Tilt(joint, 1),
    ]
}

/// What the weights outboard do.
fn at_rest(builder: &Builder, joint: usize) -> Components<Linear> {
    let placed = &builder.layout.joints[joint];
    let carried = builder.carried(&Point { at_m: placed.at_m, rank: placed.rank, inside_m: None });
    let [u, v] = placed.across;
    let sides: Components<(bool, Vector3<f64>)> =
        [(true, u), (true, v), (true, placed.axis), (false, u), (false, v)];
    sides.map(|(is_force, direction)| carried.along(is_force, &direction))
}

impl PosedBearing {
    /// Takes the loads of this case, with the loads and inertias of parts as spans.
    pub(super) fn load(&self, loads: &[Span], inertias: &[Span], stop_factor: f64, largest: &mut Largest) {
        let rest = self.rest.each_ref().map(|component| component.over(loads));
        let [at_rest, running, in_stop] = &mut largest.0;
        take(at_rest, &rest);
        for ramp in &self.ramps {
            let ramp = ramp.each_ref().map(|component| component.over(inertias));
            for (load, factor) in [(&mut *running, 1.0), (&mut *in_stop, stop_factor)] {
                for signed in [factor, -factor] {
                    take(load, &std::array::from_fn(|i| rest[i].plus(ramp[i].times(signed))));
                }
            }
        }
    }
}

/// Takes moment, radial and axial force of some components where they are larger.
fn take(largest: &mut [Span; 3], [u_n, v_n, axial_n, u_nm, v_nm]: &Components<Span>) {
    let norm = |a: &Span, b: &Span| Span {
        least: libm::hypot(a.least_size(), b.least_size()),
        most: libm::hypot(a.largest_size(), b.largest_size()),
    };
    let axial = Span { least: axial_n.least_size(), most: axial_n.largest_size() };
    for (largest, here) in largest.iter_mut().zip([norm(u_nm, v_nm), norm(u_n, v_n), axial]) {
        *largest = Span { least: largest.least.max(here.least), most: largest.most.max(here.most) };
    }
}

impl Largest {
    /// The loads at least and at most.
    pub(super) fn demands(&self) -> [BearingDemand; 2] {
        [|span: &Span| span.least, |span: &Span| span.most].map(|end: fn(&Span) -> f64| {
            let [at_rest, running, in_stop] = self.0.each_ref().map(|[moment, radial, axial]| BearingLoad {
                moment_nm: end(moment),
                radial_n: end(radial),
                axial_n: end(axial),
            });
            BearingDemand { at_rest, running, in_stop }
        })
    }
}
