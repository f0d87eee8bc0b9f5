//! Loads on the output bearings of inner joints, eight designs at once.
//!
//! The loads are those of [`bearing_loads`](crate::space::bearing_loads). Here each is a sum of parts that are linear in
//! what is chosen: what is outboard of the row, the link of the row, and the masses of inner drives. The parts are
//! projected once on the five components that a bearing feels, so that the kernel only adds and squares.

use crate::mechanics::Wrench;
use crate::mechanics::lanes::{Eight, LANES, Lanes};
use crate::sizing::eight::EightBearing;
use crate::space::bearing_loads::{Components, PosedBearing};
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::Slot;
use crate::space::station::{Station, StationSlot};
use nalgebra::Matrix6;

/// The bearing of an inner joint that is checked.
pub(crate) struct RowBearing {
    /// Inner slot of the joint.
    pub k: usize,
    /// One entry for each sizing case, with the number of the case.
    cases: Vec<(usize, BearingCase)>,
    lever: RowLever,
}

/// Lever from the face of the flange to where the link attaches \[m\].
enum RowLever {
    /// The link is outboard of the row, or the lever is stated.
    OfSlot(usize),
    /// The link is that of the row: the lever in each lane of each chunk.
    OfChunk(Vec<Eight>),
}

/// One bearing in one case: what loads it at rest, and what each joint adds when it moves.
struct BearingCase {
    joint: PosedBearing,
    at_rest: Source,
    ramps: Vec<Ramp>,
}

/// What a ramp adds.
struct Ramp {
    /// Number of the joint among the movers.
    mover: usize,
    /// Twist times acceleration of an inner joint; `None` if the joint is outboard of the row.
    inner: Option<Wrench>,
    source: Source,
}

/// The parts of a load that do not depend on what is outboard of the row.
#[derive(Default)]
struct Source {
    /// From inner pieces that are not chosen.
    fixed: Components,
    /// Per kilogram of each inner drive that is chosen, with its inner slot.
    per_kg: Vec<(usize, Components)>,
    /// From the link of the row, by chunk; empty if the row has no link.
    link: Vec<[Eight; 5]>,
}

impl Source {
    /// Adds up what the inner pieces outboard of `limit` do; `effect` is what an inertia and a weight do.
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

/// Eight sets of components, component by component.
fn side_by_side(lanes: [Components; LANES]) -> [Eight; 5] {
    std::array::from_fn(|i| lanes.map(|components| components[i]))
}

impl BearingCase {
    /// Compiles the bearing of the joint in slot `slot` in one case.
    fn new(problem: &ArmProblem, station: &Station, first: usize, slot: usize) -> Option<Self> {
        let StationSlot::Joint(place) = &station.slots[slot] else { return None };
        let joint = PosedBearing::new(place);
        let at_rest = Source::new(problem, station, first, slot, &|_, weight| joint.components(weight));
        let movers = problem.bearing_loads().movers.iter().enumerate();
        let ramps = movers
            .map(|(mover, moving)| match &station.slots[moving.slot] {
                StationSlot::Joint(of) if moving.slot >= first => {
                    let motion = of.twist * moving.acceleration_rad_s2;
                    // a joint moves what is outboard of it, and the bearing feels what is outboard of itself
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
    /// The checked bearings of the joints inboard of the row level, compiled; that of the row level itself is not among them,
    /// because all its drives feel the same loads.
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

    /// What is outboard of a row, by case: at rest, then for each mover.
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

/// What is outboard of a row, for each checked bearing, case and source.
pub(crate) type BearingsBegun = Vec<Vec<Vec<Components>>>;

impl RowBearing {
    /// Loads on the bearing in eight designs of a chunk. `begun` is what is outboard of the row, `masses_kg` those of the
    /// inner drives so far.
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
                let ramp = ramp.source.load(chunk, begun, masses_kg);
                out.moving(&at_rest, &ramp, V::splat(loads.stop_factor));
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
    /// The components of a load: outboard of the row, of its link, and of the drives so far.
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
