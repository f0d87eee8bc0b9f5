//! The lowest modes of eight designs at once.
//!
//! Few eigenproblems are solved to the end. When mass and deflection of a design are known, the *bar* is the lowest mode of
//! some known design that is no worse in both. A design below its bar is dominated and its mode need not be computed. The
//! tests, from the cheapest to the dearest:
//!
//! 1. The compliance of a single joint bounds the lowest mode from above. Most often this decides, and a single bar serves
//!    all eight designs.
//! 2. Otherwise one pass over a block at the bar shows whether an eigenvalue is below it.
//! 3. For designs above the bar, the block with the largest Dunkerley sum is solved first. Another block can only matter
//!    if its lower bound is below the root just found. It then gets one pass at this root, and is solved only if a pivot is
//!    negative there.

use super::arms::EightArms;
use super::row::{ChunkModal, RowCase, RowChunk};
use super::row_begun::{Begun, CaseOutboard};
use crate::mechanics::lanes::{Eight, LANES, Lanes};
use crate::mechanics::lowest_lanes::{Inner, LaneLink, Outboard, Walk, pass, roots};
use crate::space::levels::Keep;
use crate::space::station::{Block, BlockSlot, Modal};
use std::f64::consts::TAU;

/// A question about the lowest modes of eight complete arms.
#[derive(Clone, Copy)]
pub(crate) struct Question<'a, 'c> {
    at: RowChunk<'a, 'c>,
    begun: &'a Begun,
    arms: &'a EightArms,
}

/// A question about the lowest eigenvalues of one block.
#[derive(Clone, Copy)]
struct Ask<V> {
    /// The lanes in question, one bit for each.
    open: u8,
    /// Eigenvalues that are not below this number are of no interest.
    below: V,
    /// Where to start to look for the eigenvalues; `None` if only the lanes below are asked for.
    guess: Option<V>,
}

impl RowChunk<'_, '_> {
    /// The group (material) of the design in a lane.
    #[inline(always)]
    pub(crate) fn group(&self, lane: usize) -> Option<usize> {
        let material = self.row.chunks.get(self.chunk).and_then(|chunk| chunk.materials[lane]);
        self.from.group.with(material).material()
    }

    /// Whether the eight are all of one group.
    #[inline(always)]
    fn of_one_group(&self) -> bool {
        self.row.chunks.get(self.chunk).is_none_or(|chunk| chunk.of_one_material)
    }
}

impl<'a, 'c> Question<'a, 'c> {
    pub(crate) fn new(at: RowChunk<'a, 'c>, begun: &'a Begun, arms: &'a EightArms) -> Self {
        Self { at, begun, arms }
    }

    /// The designs that a single bar for all eight shows to be of no interest. It is the bar of a design with the least
    /// mass and the least deflection of the eight, and so no bar of the eight is lower. `tip_m2` has the squares of the deflections.
    #[inline(always)]
    pub(crate) fn below_one_bar<V: Lanes>(&self, keep: &impl Keep, tip_m2: &Eight, held: u8) -> u8 {
        if !self.at.of_one_group() {
            return 0;
        }
        let bar_hz = keep.bar_hz(self.at.group(0), least(&self.arms.mass_kg), least(tip_m2).sqrt());
        held & self.sluggish(V::splat(eigenvalue(bar_hz)))
    }

    /// The designs whose lowest mode is below their own bars.
    #[inline(always)]
    pub(crate) fn below_bar<V: Lanes>(&self, keep: &impl Keep, held: u8) -> u8 {
        let (mass_kg, tip_deflection_m) = (&self.arms.mass_kg, &self.arms.tip_deflection_m);
        let mut bars = [0.0; LANES];
        for lane in (0..LANES).filter(|lane| held >> lane & 1 == 1) {
            bars[lane] = eigenvalue(keep.bar_hz(self.at.group(lane), mass_kg[lane], tip_deflection_m[lane]));
        }
        self.below::<V>(&bars, held)
    }

    /// The lanes whose lowest eigenvalue is below a bar.
    #[inline(always)]
    fn below<V: Lanes>(&self, bars: &Eight, held: u8) -> u8 {
        let below = V::load(bars);
        // a bar of zero excludes nothing
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

    /// The lowest eigenvalue over all judged cases, and the lanes in which it was not found.
    #[inline(always)]
    pub(crate) fn lowest<V: Lanes>(&self, held: u8) -> (V, u8) {
        let (mut lowest, mut unsure) = (V::splat(f64::INFINITY), 0);
        for block in self.blocks(held) {
            let least = self.least::<V>(block);
            let open = held & least.less(lowest);
            if open != 0 {
                // blocks that still matter have roots close to the one known so far: start just below it
                let guess = V::choose(lowest.less(V::splat(f64::INFINITY)), V::splat(0.97) * lowest, least);
                let ask = Ask { open, below: lowest, guess: Some(guess.max(least)) };
                let (root, lost) = self.answer(block, ask);
                lowest = lowest.min(root);
                unsure |= lost;
            }
        }
        (lowest, unsure)
    }

    /// The lanes in which a single joint yields so much that the lowest eigenvalue is below a bar. The reciprocal of the
    /// lowest eigenvalue is the largest eigenvalue of flexibility times mass (in its symmetric form), and no diagonal entry
    /// of a symmetric matrix exceeds its largest eigenvalue.
    #[inline(always)]
    fn sluggish<V: Lanes>(&self, below: V) -> u8 {
        V::splat(1.0).less(V::load(&self.arms.largest_s2) * below)
    }

    /// Dunkerley's lower bound of the lowest eigenvalue of a block.
    #[inline(always)]
    fn least<V: Lanes>(&self, (case, block): (usize, usize)) -> V {
        V::splat(1.0) / V::load(&self.arms.cases[case].trace_s2[block])
    }

    /// The blocks of the judged cases. The one with the largest Dunkerley sum comes first, since it most likely has the
    /// lowest eigenvalue.
    fn blocks(&self, of: u8) -> impl Iterator<Item = (usize, usize)> {
        let sum = move |(case, block): (usize, usize)| -> f64 {
            let traces = &self.arms.cases[case].trace_s2[block];
            (0..LANES).filter(|lane| of >> lane & 1 == 1).map(|lane| traces[lane]).sum()
        };
        let judged = self.at.row.cases.iter().enumerate().filter(|(_, case)| case.judged);
        let blocks = judged.flat_map(|(case, _)| [(case, 0), (case, 1)]);
        let (mut first, mut largest) = (None, 0.0);
        for (block, sum) in blocks.clone().map(|block| (block, sum(block))) {
            if sum > largest {
                (first, largest) = (Some(block), sum);
            }
        }
        first.into_iter().chain(blocks.filter(move |&block| Some(block) != first && sum(block) > 0.0))
    }

    /// The eigenvalues of a block, and the lanes in which none was found. Without a guess: the lanes in which an eigenvalue
    /// is below.
    #[inline(always)]
    fn answer<V: Lanes>(&self, (case, block): (usize, usize), ask: Ask<V>) -> (V, u8) {
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
            // a case keeps its kind; if it did not, these lanes would be solved by themselves
            _ => (ask.below, ask.open),
        }
    }

    /// The inner pieces of the eight arms in a block.
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

    /// Answers for a block of `N` motions.
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
            // no pivot is negative at `below`: the lowest eigenvalue is above it, and the lane is done
            let here = pass(outboard, inner, V::choose(known, below, guess.unwrap_or(below)));
            open &= !(known & here.below_all);
        }
        // without a guess only the side of `below` was asked for
        let Some(guess) = guess.filter(|_| open != 0) else { return (below, open) };
        let found = roots(outboard, inner, guess, open);
        (V::choose(open, found.eigenvalue, below), found.unsure)
    }
}

/// The least of eight.
#[inline(always)]
fn least(numbers: &Eight) -> f64 {
    let less = |a: f64, b: f64| if a < b { a } else { b };
    let [a, b, c, d, e, f, g, h] = *numbers;
    less(less(less(a, e), less(c, g)), less(less(b, f), less(d, h)))
}

/// `(2πf)²`.
#[inline(always)]
fn eigenvalue(hz: f64) -> f64 {
    (TAU * hz) * (TAU * hz)
}

/// The inner pieces of eight arms in one block, up to the last that yields.
struct Pieces<'a, const N: usize> {
    slots: &'a [BlockSlot<N>],
    end: usize,
    link: Option<&'a LaneLink<N>>,
    case: &'a RowCase,
    masses_kg: &'a [Eight],
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
                    // the mass of the last drive that yields is inboard of everything that yields: no mode moves it
                    if k + 1 < self.end {
                        walk.mass(V::load(&self.masses_kg[k]), inertia_per_kg);
                    }
                }
                BlockSlot::Body(inertia) => walk.body(inertia),
                // a given tube: only the first slot may be the link of the row
                BlockSlot::Links(options) if k > 0 => walk.shared_link(&options[0]),
                BlockSlot::Links(_) => match self.link {
                    Some(link) if self.case.links_yield => walk.link(link),
                    Some(link) => walk.rigid(link),
                    None => {}
                },
            }
        }
    }
}
