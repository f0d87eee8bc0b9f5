//! Loads on the output bearings in a pose, as linear functions of the weights and inertias of parts.
//!
//! A bearing is loaded by the weight of everything outboard of its joint, and by inertia forces. These arise while one
//! joint, or one rail, ramps (changes its speed) or stops and the other joints are at rest. By virtual work, the
//! component of an inertia force or moment along a direction is the coupling `Σ m (v · w)` of two motions: the motion of
//! the joint that accelerates, and a *probe*. A probe is a virtual motion that shifts or tilts everything outboard of the bearing
//! along that direction. Couplings are entries of the inertia matrix of [`super::pose`] with probes as further
//! coordinates. Only mass outboard of both joints contributes, because all other mass is at rest in one of the two
//! motions.

use super::bearing::{BearingDemand, BearingLoad};
use super::layout::{Coordinate, Point};
use super::pose::Builder;
use super::span::{Linear, Span};
use crate::arm::load::LoadCase;

/// Components of the load on a bearing, in this order: the forces along two axes at right angles to the axis of the
/// joint, the force along the axis of the joint, and the moments about the first two axes.
type Components<T> = [T; COMPONENTS];
const COMPONENTS: usize = 5;

/// The loads on the output bearing of one joint in one case, as functions of the weights and inertias of the parts.
pub(super) struct PosedBearing {
    /// The five components of the load at rest, each a linear function of the weights of the parts.
    rest: Components<Linear>,
    /// The five components of the load that the ramp of each mover adds, in the order of the movers. Each is a linear
    /// function of the inertias of the parts.
    ramps: Vec<RampLoad>,
}

/// The load that the ramp of one joint or rail adds.
struct RampLoad {
    components: Components<Linear>,
    /// Ratio of the deceleration in the joint's stop to the acceleration in its ramp, at least 1.
    stop_factor: f64,
}

/// How a joint or a rail (prismatic joint) moves while the others are at rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mover {
    /// Its travel: an angle \[rad\], or a length \[m\] for a rail.
    pub coordinate: Coordinate,
    /// Acceleration in a ramp \[rad/s²\], or \[m/s²\] for a rail.
    pub acceleration_per_s2: f64,
    /// Ratio of the deceleration in a stop to this acceleration, at least 1.
    pub stop_factor: f64,
}

/// Lower and upper bounds of the largest loads on a bearing over the cases treated so far. First index: at rest, in a
/// ramp, in a stop. Second index: moment, radial force, axial force.
#[derive(Default)]
pub(super) struct Largest([[Span; 3]; 3]);

/// The output bearings of all joints in a case, base first; `None` for a joint whose bearing is not checked. `movers`
/// says how each joint and each rail moves.
pub(super) fn bearings(
    builder: &Builder,
    case: &LoadCase,
    checked: &[bool],
    movers: &[Mover],
) -> Vec<Option<PosedBearing>> {
    let joints = checked.len();
    let probes = (0..joints).filter(|joint| checked[*joint]).flat_map(probes_of);
    let coordinates: Vec<Coordinate> = movers.iter().map(|mover| mover.coordinate).chain(probes).collect();
    let probing = builder.with_coordinates(&coordinates);
    let (fixed, per_inertia) = (probing.fixed_inertia(case), probing.inertia_per());
    let mut first = movers.len();
    (0..joints)
        .map(|joint| {
            checked[joint].then(|| {
                let ramp = |(number, mover): (usize, &Mover)| {
                    let components = std::array::from_fn(|component| {
                        let row = first + component;
                        let entry = row * (row + 1) / 2 + number;
                        let per = per_inertia.iter().map(|per| per[entry] * mover.acceleration_per_s2);
                        Linear { fixed: fixed[entry] * mover.acceleration_per_s2, per_load: per.collect() }
                    });
                    RampLoad { components, stop_factor: mover.stop_factor }
                };
                let ramps = movers.iter().enumerate().map(ramp).collect();
                first += COMPONENTS;
                PosedBearing { rest: at_rest(builder, joint), ramps }
            })
        })
        .collect()
}

/// Virtual motions of everything outboard of a joint, one for each component of the load.
fn probes_of(joint: usize) -> Components<Coordinate> {
    [
        Coordinate::Shift(joint, 0),
        Coordinate::Shift(joint, 1),
        Coordinate::Shift(joint, 2),
        Coordinate::Tilt(joint, 0),
        Coordinate::Tilt(joint, 1),
    ]
}

/// The five components of the load on the bearing of `joint` that the weights outboard of it cause, each as a linear
/// function of these weights.
fn at_rest(builder: &Builder, joint: usize) -> Components<Linear> {
    let placed = &builder.layout.joints[joint];
    let carried = builder.carried(&Point { at_m: placed.at_m, rank: placed.rank, inside_m: None });
    let [u, v] = placed.across;
    [
        carried.force_along(&u),
        carried.force_along(&v),
        carried.force_along(&placed.axis),
        carried.moment_about(&u),
        carried.moment_about(&v),
    ]
}

impl PosedBearing {
    /// Raises `largest` to the loads on this bearing in this case. `loads` and `inertias` are the intervals of the
    /// weights and inertias of the parts.
    pub(super) fn load(&self, loads: &[Span], inertias: &[Span], largest: &mut Largest) {
        let rest = self.rest.each_ref().map(|component| component.over(loads));
        let [at_rest, running, in_stop] = &mut largest.0;
        take(at_rest, &rest);
        for RampLoad { components, stop_factor } in &self.ramps {
            let ramp = components.each_ref().map(|component| component.over(inertias));
            for (load, factor) in [(&mut *running, 1.0), (&mut *in_stop, *stop_factor)] {
                for signed in [factor, -factor] {
                    take(load, &std::array::from_fn(|i| rest[i].plus(ramp[i].times(signed))));
                }
            }
        }
    }
}

/// Raises the largest moment, radial force and axial force in `largest` to the values of one load, where these are
/// larger. The load is given by its forces and moments along the three axes, as intervals.
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
    /// Lower and upper bound of the largest loads.
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
