//! Loads on the output bearings of inner joints, eight designs at once.
//!
//! A row is the set of designs that differ in the choice of one part alone, the row level. Inner joints are the joints
//! from the row level to the base. If the row level is a link, this link is the row's link.
//!
//! The loads are defined in [`bearing_loads`](crate::space::bearing_loads). Each load is a sum of three terms: from
//! everything outboard of the row, from the row's link, and from the inner drives. The third term grows linearly with
//! the masses of these drives. Each term is projected in advance on the five force and moment components that load a
//! bearing. During the sweep the terms then only need to be added and squared.

use crate::mechanics::Wrench;
use crate::mechanics::lanes::{Eight, LANES, Lanes};
use crate::sizing::eight::EightBearing;
use crate::space::bearing_loads::{Components, PosedBearing};
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::Slot;
use crate::space::station::{Station, StationSlot};
use nalgebra::Matrix6;

/// The output bearing of an inner joint, with its loads prepared for the designs of a row.
pub(crate) struct RowBearing {
    /// Index of the joint among the inner slots (the slots from the row level to the base).
    pub k: usize,
    /// The bearing in each sizing case (a case in which drives and stresses are checked). Each entry has the index of
    /// the case and the bearing's loads in it.
    cases: Vec<(usize, BearingCase)>,
    /// The lever: the distance along the joint's axis from the face of its flange to the point at which the link
    /// attaches. The moment on the bearing includes the radial force times this lever.
    lever: RowLever,
}

/// Source of the lever: the distance \[m\] along the joint's axis from the face of its flange to the point at which the
/// link attaches.
enum RowLever {
    /// The lever does not depend on the link of the row, because the study states it, or because the link at the joint
    /// is given or outboard of the row. The number is the slot of the joint.
    OfSlot(usize),
    /// The lever depends on the link of the row: one lever \[m\] for each option, eight in a chunk.
    OfChunk(Vec<Eight>),
}

/// The loads on one bearing in one case: the load at rest, and the additional load while each joint accelerates.
struct BearingCase {
    /// Position and axes of the bearing in this pose.
    joint: PosedBearing,
    /// Load at rest from the weight of the row's link and of the inner pieces. The load from the arm outboard of the
    /// row is added later.
    at_rest: Source,
    /// Additional load while each joint accelerates, one entry for each joint whose acceleration loads the bearing, tip
    /// first.
    ramps: Vec<Ramp>,
}

/// Load on a bearing while one joint accelerates and the other joints are at rest.
struct Ramp {
    /// Number of the accelerating joint in the list of all movers (the driven joints, tip first).
    mover: usize,
    /// Acceleration of everything outboard of the accelerating joint: the twist of this joint (a kinematic vector)
    /// times its angular acceleration. `None` if the joint is outboard of the row, since then the load is known from
    /// the outboard arm.
    inner: Option<Wrench>,
    /// Load that the accelerated inertia of the row's link and of the inner pieces makes. The load from the arm
    /// outboard of the row is added later.
    source: Source,
}

/// A load on a bearing, as far as it comes from the row's link and from the inner pieces (from the row level to the
/// base).
#[derive(Default)]
struct Source {
    /// Load from inner pieces whose mass is given \[N, N m\].
    fixed: Components,
    /// For each inner drive that is chosen or sized: its inner slot, and the load per kilogram of the drive.
    per_kg: Vec<(usize, Components)>,
    /// Load on the bearing from the row's link, one entry for each chunk of eight options: the five [`Components`] (three
    /// forces \[N\], two moments \[N m\]), each with one value for each option. Empty if the row level is not a link.
    link: Vec<[Eight; 5]>,
}

impl Source {
    /// Sums the loads from the row's link and from the inner pieces outboard of the slot `limit`. `effect` returns the
    /// load on the bearing that a piece makes with a given inertia and weight. `first` is the slot of the row level.
    fn new(
        problem: &ArmProblem,
        station: &Station,
        first: usize,
        limit: usize,
        effect: &dyn Fn(&Matrix6<f64>, &Wrench) -> Components,
    ) -> Self {
        let mut out = Self::default();
        let slots = problem.slots()[first..limit].iter().zip(&station.slots[first..limit]);
        for (k, (slot, place)) in slots.enumerate() {
            match place {
                StationSlot::Joint(joint) => {
                    let per_kg = effect(&joint.inertia_per_kg, &joint.weight_per_kg);
                    match slot.fixed_kg() {
                        Some(mass_kg) => add_times(&mut out.fixed, &per_kg, mass_kg),
                        None => out.per_kg.push((k, per_kg)),
                    }
                }
                StationSlot::Body { inertia, weight } => {
                    add_times(&mut out.fixed, &effect(inertia, weight), 1.0);
                }
                StationSlot::Link { options, .. } if k > 0 => {
                    add_times(&mut out.fixed, &effect(&options[0].inertia, &options[0].weight), 1.0);
                }
                StationSlot::Link { options, .. } => {
                    let of = |option: usize| {
                        let link = &options[option.min(options.len() - 1)];
                        effect(&link.inertia, &link.weight)
                    };
                    out.link = (0..options.len().div_ceil(LANES))
                        .map(|chunk| side_by_side(std::array::from_fn(|lane| of(LANES * chunk + lane))))
                        .collect();
                }
            }
        }
        out
    }
}

fn add_times(to: &mut Components, what: &Components, times: f64) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += times * what);
}

/// Converts eight loads of five components each into five components with eight values each.
fn side_by_side(lanes: [Components; LANES]) -> [Eight; 5] {
    std::array::from_fn(|i| lanes.map(|components| components[i]))
}

impl BearingCase {
    /// Prepares the loads on the bearing of the joint in `slot` for one case. `first` is the slot of the row level.
    /// `None` if the slot has no joint.
    fn new(problem: &ArmProblem, station: &Station, first: usize, slot: usize) -> Option<Self> {
        let StationSlot::Joint(place) = &station.slots[slot] else { return None };
        let joint = PosedBearing::new(place);
        let at_rest = Source::new(problem, station, first, slot, &|_, weight| joint.components(weight));
        let movers = problem.bearing_loads().movers.iter().enumerate();
        let ramps = movers
            .map(|(mover, moving)| match &station.slots[moving.slot] {
                StationSlot::Joint(of) if moving.slot >= first => {
                    let motion = of.twist * moving.acceleration_rad_s2;
                    // A joint accelerates only the pieces outboard of it, and a bearing is loaded only by the pieces
                    // outboard of the bearing. The limit is therefore the more outboard of the two slots.
                    let limit = slot.min(moving.slot);
                    let source = Source::new(problem, station, first, limit, &|inertia, _| {
                        joint.components(&(inertia * motion))
                    });
                    Ramp { mover, inner: Some(motion), source }
                }
                _ => Ramp { mover, inner: None, source: Source::default() },
            })
            .collect();
        Some(Self { joint, at_rest, ramps })
    }
}

impl RowBearing {
    /// Prepares the checked bearings of the joints inboard of the row level. `first` is the slot of the row level. If
    /// the row level is itself a joint, its bearing is left out, because its load is the same for all drives of the
    /// row.
    pub(crate) fn all(problem: &ArmProblem, first: usize) -> Vec<Self> {
        let slots = problem.slots();
        let loads = problem.bearing_loads();
        let levers = loads.levers.iter().enumerate().skip(first).filter(|(slot, _)| loads.checked[*slot]);
        let checked = levers.filter_map(|(slot, lever)| {
            let is_inboard = matches!(&slots[slot], Slot::Sized(sized) if slot > first || !sized.all_fits);
            lever.as_ref().filter(|_| is_inboard).map(|lever| (slot, lever))
        });
        checked
            .map(|(slot, lever)| {
                let cases = problem.space().sizing_cases.iter();
                let lever = match lever.link_slot == Some(first) {
                    false => RowLever::OfSlot(slot),
                    true => {
                        let of = |i: usize| lever.lever_m[i.min(lever.lever_m.len() - 1)];
                        let chunks = 0..lever.lever_m.len().div_ceil(LANES);
                        let eight = |c: usize| std::array::from_fn(|lane| of(LANES * c + lane));
                        RowLever::OfChunk(chunks.map(eight).collect())
                    }
                };
                let case = |&case: &usize| {
                    BearingCase::new(problem, &problem.stations()[case], first, slot).map(|of| (case, of))
                };
                Self { k: slot - first, cases: cases.filter_map(case).collect(), lever }
            })
            .collect()
    }

    /// Writes to `out` the loads that come from the arm `from`, which is outboard of the row. There is one list for
    /// each sizing case: first the load at rest, then the additional load during the acceleration of each mover (a
    /// joint that accelerates).
    pub(crate) fn begin(&self, from: &Partial, out: &mut Vec<Vec<Components>>) {
        out.resize_with(self.cases.len(), Vec::new);
        for ((case, of), out) in self.cases.iter().zip(out) {
            let state = &from.stations[*case];
            let fixed = |source: &Source, outboard: Components| {
                std::array::from_fn(|i| source.fixed[i] + outboard[i])
            };
            out.clear();
            out.push(fixed(&of.at_rest, of.joint.components(&state.wrench)));
            out.extend(of.ramps.iter().map(|ramp| {
                let outboard = match &ramp.inner {
                    Some(motion) => of.joint.components(&(state.inertia * motion)),
                    None => of.joint.components(&state.ramps[ramp.mover]),
                };
                fixed(&ramp.source, outboard)
            }));
        }
    }
}

/// Loads on the output bearings from the arm outboard of a row. The first index is the bearing, the second the sizing
/// case, the third the cause: first the load at rest, then the additional load during the acceleration of each mover (a
/// joint that accelerates).
pub(crate) type BearingsBegun = Vec<Vec<Vec<Components>>>;

impl RowBearing {
    /// Loads on the bearing in the eight designs of a chunk. `from` is the arm outboard of the row and `begun` are the
    /// loads from it. `masses_kg` are the masses of the drives in the inner slots.
    #[inline(always)]
    pub(crate) fn demands<V: Lanes>(
        &self,
        problem: &ArmProblem,
        (from, chunk): (&Partial, usize),
        begun: &[Vec<Components>],
        masses_kg: &[Eight],
    ) -> EightBearing<V> {
        let loads = problem.bearing_loads();
        let mut out = EightBearing::<V>::zero();
        for ((_, case), begun) in self.cases.iter().zip(begun) {
            let at_rest: [V; 5] = case.at_rest.load(chunk, &begun[0], masses_kg);
            out.rest(&at_rest);
            for (ramp, begun) in case.ramps.iter().zip(&begun[1..]) {
                let load = ramp.source.load(chunk, begun, masses_kg);
                out.moving(&at_rest, &load, V::splat(loads.movers[ramp.mover].stop_factor));
            }
        }
        let lever_m = match &self.lever {
            RowLever::OfChunk(chunks) => V::load(&chunks[chunk]),
            RowLever::OfSlot(slot) => match &loads.levers[*slot] {
                Some(lever) => V::splat(lever.lever_m(&from.options)),
                None => V::zero(),
            },
        };
        out.with_lever(lever_m)
    }
}

impl Source {
    /// The five components of this load in eight designs. The term `begun` comes from the arm outboard of the row. The
    /// terms of the row's link and of the inner drives are added to it. The masses of the inner drives are `masses_kg`.
    #[inline(always)]
    fn load<V: Lanes>(&self, chunk: usize, begun: &Components, masses_kg: &[Eight]) -> [V; 5] {
        let mut out = [V::zero(); 5];
        for i in 0..5 {
            out[i] = V::splat(begun[i]);
        }
        if let Some(link) = self.link.get(chunk) {
            for i in 0..5 {
                out[i] = out[i] + V::load(&link[i]);
            }
        }
        for (k, per_kg) in &self.per_kg {
            let mass_kg = V::load(&masses_kg[*k]);
            for i in 0..5 {
                out[i] = out[i] + mass_kg * V::splat(per_kg[i]);
            }
        }
        out
    }
}
