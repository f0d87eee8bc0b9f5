//! Chunks: the numbers of eight options of the row's link, next to each other in memory.
//!
//! A row is the set of designs that differ in the options of one link alone, the row's link. A hinge
//! is one elastic coordinate inboard of this link ([`row`](super::row)).

use super::row_case::{Entry, Hinge, RowCase};
use crate::mechanics::lanes::{Eight, LANES};
use crate::mechanics::link_stress::StressCheck;
use crate::mechanics::lowest_lanes::LaneLink;
use crate::space::attributes::OptionAttributes;
use crate::space::problem::ArmProblem;
use crate::space::station::{Block, BlockSlot, Modal, Station, StationLink, StationSlot};
use nalgebra::{Matrix3x6, Vector3};

/// Eight options of the row's link. The last chunk is filled up with copies of the last option.
pub(crate) struct Chunk {
    /// Mass of each option \[kg\].
    pub mass_kg: Eight,
    /// Material cost of each option \[EUR\]; 0 if it is not known.
    pub cost_eur: Eight,
    /// Number of the material of each option, in the list of the materials that get a front of their own.
    pub materials: [Option<usize>; LANES],
    /// Whether the eight options are of the same material.
    pub of_one_material: bool,
    /// Bit mask, one bit per option: the options whose wall is too slender.
    pub slender: u8,
    /// For each option, the factors that turn the loads on the link into its stress.
    pub stress: StressEight,
    /// The numbers of the eight options that differ from case to case.
    pub cases: Vec<CaseChunk>,
}

/// Ratio of stress to strength, per unit of force or moment, for eight link options. It is 0 if the strength is not
/// known.
#[derive(Default)]
pub(crate) struct StressEight {
    /// Ratio of stress to strength per newton of axial force.
    pub per_axial_n: Eight,
    /// Ratio of stress to strength per newton metre of bending moment about the section's y axis.
    pub per_moment_y: Eight,
    /// Ratio of stress to strength per newton metre of bending moment about the section's z axis.
    pub per_moment_z: Eight,
    /// Ratio of stress to strength per newton metre of torsion.
    pub per_torsion: Eight,
    /// Bit mask, one bit per option: the options of round section, in which both bending moments add as vectors.
    pub round: u8,
}

/// What each of eight options of the row's link contributes in one case: weight, tip displacement, inertia about the
/// inner joints, and the terms for the lowest mode.
pub(crate) struct CaseChunk {
    /// Weight of each option \[N\].
    pub weight_n: Eight,
    /// Displacement of the tip \[m\] in x, y and z, per unit of each component of the wrench on the link's end.
    pub flexibility: [[Eight; 6]; 3],
    /// Displacement of the tip \[m\] in x, y and z, caused by the weight of the link itself.
    pub own_weight_deflection_m: [Eight; 3],
    /// Inertia of the row's link, with each option, about each hinge inboard \[kg m²\].
    pub inertia_at: Vec<Eight>,
    /// Contribution to Dunkerley's sum (the sum of `1/λ` over all eigenvalues) per unit of each entry of the outboard
    /// inertia matrix, in the order of [`RowCase::spread_entries`].
    pub spread: Vec<Eight>,
    /// Contribution of the row's link, with its own mass alone, to Dunkerley's sum (the sum of `1/λ` over the
    /// eigenvalues) of each block \[s²\].
    pub trace_s2: [Eight; 2],
    /// The eight link options in the form in which the computation of the lowest mode needs them.
    pub modal: ChunkModal,
}

/// Eight options of the row's link, in the form in which the computation of the lowest mode needs them.
pub(crate) enum ChunkModal {
    Planar(Box<[LaneLink<3>; 2]>),
    Spatial(Box<LaneLink<6>>),
}

impl Chunk {
    /// Computes the numbers of chunk `c`: of the eight link options from number `8 c` on. `options` are all options of
    /// the link.
    pub(super) fn new(
        problem: &ArmProblem,
        cases: &[RowCase],
        hinges: &[Hinge],
        options: &[OptionAttributes],
        c: usize,
    ) -> Self {
        let first = problem.row_slot().unwrap_or_default();
        // Lanes beyond the last option repeat the last option. Their results are ignored.
        let at = |lane: usize| (LANES * c + lane).min(options.len() - 1);
        let lanes =
            |of: &dyn Fn(&OptionAttributes) -> f64| std::array::from_fn(|lane| of(&options[at(lane)]));
        let bits = |of: &dyn Fn(&OptionAttributes) -> bool| {
            (0..LANES).fold(0, |bits, lane| bits | u8::from(of(&options[at(lane)])) << lane)
        };
        let stress = |of: &dyn Fn(&StressCheck) -> f64| {
            // The stress of a material of unknown strength is not checked, so its ratio of stress to strength is 0.
            lanes(&|o| o.stress.as_ref().map_or(0.0, |s| of(s) / s.strength_pa))
        };
        let materials: [Option<usize>; LANES] = std::array::from_fn(|lane| options[at(lane)].material);
        Self {
            mass_kg: lanes(&|o| o.mass_kg),
            cost_eur: lanes(&|o| o.cost_eur.unwrap_or(0.0)),
            materials,
            of_one_material: materials.iter().all(|m| *m == materials[0]),
            slender: bits(&|o| o.slender),
            stress: StressEight {
                per_axial_n: stress(&|s| s.per_axial_n),
                per_moment_y: stress(&|s| s.per_moment_y),
                per_moment_z: stress(&|s| s.per_moment_z),
                per_torsion: stress(&|s| s.per_torsion),
                round: bits(&|o| o.stress.as_ref().is_some_and(|s| s.round)),
            },
            cases: problem
                .stations()
                .iter()
                .zip(cases)
                .filter_map(|(station, case)| CaseChunk::new(station, case, hinges, first, &at))
                .collect(),
        }
    }
}

impl CaseChunk {
    /// Computes the numbers of the eight link options of a chunk in one case. `at(lane)` is the number of the option in
    /// a lane, and `first` the slot (place in the arm) of the link.
    fn new(
        station: &Station,
        case: &RowCase,
        hinges: &[Hinge],
        first: usize,
        at: &dyn Fn(usize) -> usize,
    ) -> Option<Self> {
        let StationSlot::Link { options, .. } = &station.slots[first] else { return None };
        let links: [&StationLink; LANES] = std::array::from_fn(|lane| &options[at(lane)]);
        let lanes = |of: &dyn Fn(&StationLink) -> f64| links.map(of);
        let (flexibility, own_m) =
            (links.map(StationLink::flexibility), links.map(StationLink::own_weight_deflection_m));
        let mut inertia_at = vec![[0.0; LANES]; case.turned.len()];
        for hinge in hinges {
            let twist = hinge.twist(&station.slots[first..]);
            inertia_at[hinge.number] = lanes(&|l| twist.dot(&(l.inertia * twist)));
        }
        let trace = |block: usize| {
            lanes(&|l| {
                // The end coordinates have unit stiffness, so their inertias are the terms of Dunkerley's sum.
                let ends: f64 = (0..6).filter(|&g| l.block[g] == block).map(|g| l.end_inertia[g]).sum();
                ends + l.inner_trace_s2
            })
        };
        Some(Self {
            // the weight acts along the direction of gravity, `down`
            weight_n: lanes(&|l| l.weight_n(&station.down)),
            flexibility: std::array::from_fn(|i| {
                std::array::from_fn(|j| flexibility.map(|f: Matrix3x6<f64>| f[(i, j)]))
            }),
            own_weight_deflection_m: std::array::from_fn(|i| own_m.map(|s: Vector3<f64>| s[i])),
            inertia_at,
            spread: case.spread_entries.iter().map(|entry| lanes(&|l| spread_of(l, *entry))).collect(),
            trace_s2: [trace(0), trace(1)],
            modal: chunk_modal(&station.modal, first, at),
        })
    }
}

/// Contribution of a link to Dunkerley's sum (the sum of `1/λ` over all eigenvalues) per unit of one entry of the
/// outboard inertia matrix.
fn spread_of(link: &StationLink, Entry { block, row, column }: Entry) -> f64 {
    (0..6).filter(|&g| link.block[g] == block).map(|g| link.end[(row, g)] * link.end[(column, g)]).sum()
}

/// The eight options of a chunk as the computation of the lowest mode needs them. `at(lane)` is the number of the
/// option in a lane, and `first` the slot of the link.
fn chunk_modal(modal: &Modal, first: usize, at: &dyn Fn(usize) -> usize) -> ChunkModal {
    match modal {
        Modal::Planar(blocks) => {
            let [within, across] = &**blocks;
            ChunkModal::Planar(Box::new([lane_link(within, first, at), lane_link(across, first, at)]))
        }
        Modal::Spatial(block) => ChunkModal::Spatial(Box::new(lane_link(block, first, at))),
    }
}

/// The eight options of a chunk in one block of the eigenvalue problem. `at(lane)` is the number of the option in a
/// lane, and `first` the slot of the link.
fn lane_link<const N: usize>(block: &Block<N>, first: usize, at: &dyn Fn(usize) -> usize) -> LaneLink<N> {
    match &block.slots[first] {
        BlockSlot::Links(options) => LaneLink::new(std::array::from_fn(|lane| &options[at(lane)])),
        _ => unreachable!("a chunk is made of a slot of links"),
    }
}
