//! The lowest modes of eight designs at once.
//!
//! For most designs the lowest mode itself is never computed. When mass and deflection of a design are known, its
//! *bar* is the highest lowest mode among the known designs that are no worse in both. A design whose lowest mode is
//! below its bar is dominated. The tests, from the cheapest to the most expensive:
//!
//! 1. The compliance of a single joint gives an upper bound of the lowest mode. Most often this bound is below the
//!    bar, and a single bar decides for all eight designs.
//! 2. Otherwise one factorization of a block at the frequency of the bar shows whether an eigenvalue is below it.
//! 3. For designs above the bar, the block with the largest Dunkerley sum is solved first. Another block matters only
//!    if its lower bound is below the eigenvalue just found. It is then factorized once at this eigenvalue, and solved
//!    only if a pivot is negative there.
//!
//! Dunkerley's sum of a block is the sum of `1/λ` over all its eigenvalues λ. It is found without solving for them, and
//! its reciprocal is a lower bound of the lowest eigenvalue.

use super::arms::EightArms;
use super::row::RowChunk;
use super::row_begun::{Begun, CaseOutboard};
use super::row_case::RowCase;
use super::row_chunk::ChunkModal;
use crate::mechanics::lanes::{Eight, LANES, Lanes};
use crate::mechanics::lowest_lanes::{Inner, LaneLink, Outboard, Walk, pass, roots};
use crate::space::levels::Keep;
use crate::space::station::{Block, BlockSlot, Modal};
use std::f64::consts::TAU;

/// Eight complete arms whose lowest modes are to be found, or at least compared with a bar. A design whose lowest mode
/// is below its bar is dominated.
#[derive(Clone, Copy)]
pub(crate) struct Question<'a, 'c> {
    at: RowChunk<'a, 'c>,
    begun: &'a Begun,
    arms: &'a EightArms,
}

/// One block of the eigenvalue problem of a case.
#[derive(Clone, Copy, PartialEq)]
struct BlockOf {
    case: usize,
    block: usize,
}

/// A question about the lowest eigenvalue of one block of the eigenvalue problem, for eight arms.
#[derive(Clone, Copy)]
struct Ask<V> {
    /// Bit mask, one bit per arm: the arms for which the question is asked.
    open: u8,
    /// Upper limit of the eigenvalues that are sought \[1/s²\]. Larger eigenvalues need not be computed.
    below: V,
    /// Eigenvalue at which the iteration starts; `None` if the question is only whether an eigenvalue is below
    /// `below`.
    guess: Option<V>,
}

impl RowChunk<'_, '_> {
    /// Number of the group (material) of the design in a lane (0 to 7); `None` if its links are of several materials.
    #[inline(always)]
    pub(crate) fn group(&self, lane: usize) -> Option<usize> {
        let material = self.row.chunks.get(self.chunk).and_then(|chunk| chunk.materials[lane]);
        self.from.group.with(material).material()
    }

    /// Whether the eight designs all belong to the same group (material).
    #[inline(always)]
    fn of_one_group(&self) -> bool {
        self.row.chunks.get(self.chunk).is_none_or(|chunk| chunk.of_one_material)
    }
}

impl<'a, 'c> Question<'a, 'c> {
    pub(crate) fn new(at: RowChunk<'a, 'c>, begun: &'a Begun, arms: &'a EightArms) -> Self {
        Self { at, begun, arms }
    }

    /// The designs among `held` that one bar, used for all eight, shows to be dominated. The bar of a design of known
    /// mass and deflection is the lowest mode below which the design is dominated. The bar that is used here belongs
    /// to an imagined design with the least mass and the least deflection of the eight. The bar of each of the eight is
    /// at least as high. `tip_m2` has the squares of the deflections \[m²\].
    #[inline(always)]
    pub(crate) fn below_one_bar<V: Lanes>(&self, keep: &impl Keep, tip_m2: &Eight, held: u8) -> u8 {
        if !self.at.of_one_group() {
            return 0;
        }
        let bar_hz = keep.bar_hz(self.at.group(0), least(&self.arms.mass_kg), least(tip_m2).sqrt());
        held & self.sluggish(V::splat(eigenvalue(bar_hz)))
    }

    /// The designs among `held` whose lowest mode is below their own bar. A design of this mass and deflection is
    /// dominated if its lowest mode is below the bar.
    #[inline(always)]
    pub(crate) fn below_bar<V: Lanes>(&self, keep: &impl Keep, held: u8) -> u8 {
        let (mass_kg, tip_deflection_m) = (&self.arms.mass_kg, &self.arms.tip_deflection_m);
        let mut bars = [0.0; LANES];
        for lane in (0..LANES).filter(|lane| held >> lane & 1 == 1) {
            bars[lane] = eigenvalue(keep.bar_hz(self.at.group(lane), mass_kg[lane], tip_deflection_m[lane]));
        }
        self.below::<V>(&bars, held)
    }

    /// The arms among `held` whose lowest eigenvalue is below the arm's entry in `bars` \[1/s²\], as a bit mask.
    #[inline(always)]
    fn below<V: Lanes>(&self, bars: &Eight, held: u8) -> u8 {
        let below = V::load(bars);
        // A bar of zero means that no known design can dominate a design of this mass and deflection.
        let asked = held & V::zero().less(below);
        let mut above = asked & !self.sluggish(below);
        if above == 0 {
            return asked;
        }
        for block in self.blocks(above) {
            let open = above & self.least::<V>(block).less(below);
            if open != 0 {
                above &= !self.answer(block, Ask { open, below, guess: None }).1;
            }
        }
        asked & !above
    }

    /// The lowest eigenvalue of each arm over all judged cases (which count for deflection and lowest mode) \[1/s²\],
    /// and a bit mask of the arms for which the iteration did not converge. `held` is a bit mask of the arms for which
    /// it is computed.
    #[inline(always)]
    pub(crate) fn lowest<V: Lanes>(&self, held: u8) -> (V, u8) {
        let (mut lowest, mut unsure) = (V::splat(f64::INFINITY), 0);
        for block in self.blocks(held) {
            let least = self.least::<V>(block);
            let open = held & least.less(lowest);
            if open != 0 {
                // a block that still matters has an eigenvalue just below the lowest one so far, so the iteration
                // starts slightly below it
                let guess = V::choose(lowest.less(V::splat(f64::INFINITY)), V::splat(0.97) * lowest, least);
                let ask = Ask { open, below: lowest, guess: Some(guess.max(least)) };
                let (root, lost) = self.answer(block, ask);
                lowest = lowest.min(root);
                unsure |= lost;
            }
        }
        (lowest, unsure)
    }

    /// Bit mask of the arms in which a single joint is so compliant that the lowest eigenvalue must be below the bar
    /// `below` \[1/s²\]. The reason: the reciprocal of the lowest eigenvalue is the largest eigenvalue of flexibility
    /// times mass (in its symmetric form). No diagonal entry of a symmetric matrix exceeds its largest eigenvalue.
    #[inline(always)]
    fn sluggish<V: Lanes>(&self, below: V) -> u8 {
        V::splat(1.0).less(V::load(&self.arms.largest_s2) * below)
    }

    /// Dunkerley's lower bound of the lowest eigenvalue of a block \[1/s²\]: the reciprocal of the sum of `1/λ` over
    /// its eigenvalues.
    #[inline(always)]
    fn least<V: Lanes>(&self, BlockOf { case, block }: BlockOf) -> V {
        V::splat(1.0) / V::load(&self.arms.cases[case].trace_s2[block])
    }

    /// The blocks of the eigenvalue problems of all judged cases. The block with the
    /// largest Dunkerley sum over the arms in the bit mask `of` comes first, since it most likely has the lowest
    /// eigenvalue.
    fn blocks(&self, of: u8) -> impl Iterator<Item = BlockOf> {
        let sum = move |BlockOf { case, block }: BlockOf| -> f64 {
            let traces = &self.arms.cases[case].trace_s2[block];
            (0..LANES).filter(|lane| of >> lane & 1 == 1).map(|lane| traces[lane]).sum()
        };
        let judged = self.at.row.cases.iter().enumerate().filter(|(_, case)| case.judged);
        let blocks = judged.flat_map(|(case, _)| [0, 1].map(|block| BlockOf { case, block }));
        let (mut first, mut largest) = (None, 0.0);
        for (block, sum) in blocks.clone().map(|block| (block, sum(block))) {
            if sum > largest {
                (first, largest) = (Some(block), sum);
            }
        }
        first.into_iter().chain(blocks.filter(move |&block| Some(block) != first && sum(block) > 0.0))
    }

    /// Answers the question `ask` for one block. Returns the lowest eigenvalue of each arm \[1/s²\], and a bit mask of
    /// the arms for which none was found. If the question has no guess, the bit mask has the arms with an eigenvalue
    /// below `below` instead.
    #[inline(always)]
    fn answer<V: Lanes>(&self, BlockOf { case, block }: BlockOf, ask: Ask<V>) -> (V, u8) {
        let chunk = self.at.row.chunks.get(self.at.chunk).map(|chunk| &chunk.cases[case].modal);
        match (&self.at.problem.stations()[case].modal, &self.begun.cases[case].outboard) {
            (Modal::Planar(blocks), CaseOutboard::Planar(outboard)) => {
                let link = match chunk {
                    Some(ChunkModal::Planar(links)) => Some(&links[block]),
                    _ => None,
                };
                self.solve(&self.pieces(case, block, &blocks[block], link), &outboard[block], ask)
            }
            (Modal::Spatial(pieces), CaseOutboard::Spatial(outboard)) => {
                let link = match chunk {
                    Some(ChunkModal::Spatial(link)) => Some(&**link),
                    _ => None,
                };
                self.solve(&self.pieces(case, block, pieces, link), outboard, ask)
            }
            // A case is always planar or always spatial, so this arm of the match is never reached. If it were, the
            // eight designs would be solved one by one.
            _ => (ask.below, ask.open),
        }
    }

    /// The pieces of the eight arms from the row level to the base, in one block of the eigenvalue problem.
    #[inline(always)]
    fn pieces<'s, const N: usize>(
        &'s self,
        case: usize,
        block: usize,
        pieces: &'s Block<N>,
        link: Option<&'s LaneLink<N>>,
    ) -> Pieces<'s, N> {
        Pieces {
            slots: &pieces.slots[self.at.row.first..],
            end: self.at.row.cases[case].ends[block],
            link,
            case: &self.at.row.cases[case],
            masses_kg: &self.arms.masses_kg,
            compliance: &self.arms.cases[case].compliance,
        }
    }

    /// Answers the question `ask` for a block of `N` motions, as [`answer`](Self::answer) does. `inner` are the inner
    /// pieces of the arms, and `outboard` is the arm outboard of the row.
    #[inline(always)]
    fn solve<V: Lanes, const N: usize>(
        &self,
        inner: &Pieces<'_, N>,
        outboard: &Outboard<N>,
        ask: Ask<V>,
    ) -> (V, u8) {
        let Ask { mut open, below, guess } = ask;
        let known = open & below.less(V::splat(f64::INFINITY));
        if known != 0 {
            // If no pivot is negative at `below`, the lowest eigenvalue is above `below`, and the question is answered
            // for this arm.
            let here = pass(outboard, inner, V::choose(known, below, guess.unwrap_or(below)));
            open &= !(known & here.below_all);
        }
        // Without a guess, the question is only whether an eigenvalue is below `below`.
        let Some(guess) = guess.filter(|_| open != 0) else { return (below, open) };
        let found = roots(outboard, inner, guess, open);
        (V::choose(open, found.eigenvalue, below), found.unsure)
    }
}

/// The least of eight numbers.
#[inline(always)]
fn least(numbers: &Eight) -> f64 {
    let less = |a: f64, b: f64| if a < b { a } else { b };
    let [a, b, c, d, e, f, g, h] = *numbers;
    less(less(less(a, e), less(c, g)), less(less(b, f), less(d, h)))
}

/// Eigenvalue `(2πf)²` \[1/s²\] of a frequency \[Hz\].
#[inline(always)]
fn eigenvalue(hz: f64) -> f64 {
    (TAU * hz) * (TAU * hz)
}

/// The pieces of eight arms from the row level to the last compliant one, in one block of the eigenvalue problem.
struct Pieces<'a, const N: usize> {
    slots: &'a [BlockSlot<N>],
    /// Number of inner slots from the row level to the last one that is compliant.
    end: usize,
    /// The eight options of the row's link; `None` if the row level is a joint.
    link: Option<&'a LaneLink<N>>,
    case: &'a RowCase,
    /// Mass of the drive in each inner slot (from the row level to the base) \[kg\], in eight arms.
    masses_kg: &'a [Eight],
    /// Tangent compliance of the joint or spring in each inner slot (from the row level to the base) \[rad/(N m)\], in
    /// eight arms.
    compliance: &'a [Eight],
}

impl<V: Lanes, const N: usize> Inner<V, N> for Pieces<'_, N> {
    #[inline(always)]
    fn add_to(&self, walk: &mut Walk<V, N>) {
        for (k, slot) in self.slots[..self.end].iter().enumerate() {
            match slot {
                BlockSlot::Joint { twist, inertia_per_kg } => {
                    if twist.amax() > 0.0 {
                        walk.joint(twist, V::load(&self.compliance[k]));
                    }
                    // The drive of the last compliant joint is inboard of all elastic coordinates, so its mass stands
                    // still in every mode.
                    if k + 1 < self.end {
                        walk.mass(V::load(&self.masses_kg[k]), inertia_per_kg);
                    }
                }
                BlockSlot::Body(inertia) => walk.body(inertia),
                // Only the first slot may have the link of the row. A link in any other slot is a given tube, the same
                // in all eight arms.
                BlockSlot::Links(options) if k > 0 => walk.shared_link(&options[0]),
                BlockSlot::Links(_) => match self.link {
                    Some(link) if self.case.links_are_compliant => walk.link(link),
                    Some(link) => walk.rigid(link),
                    None => {}
                },
            }
        }
    }
}
