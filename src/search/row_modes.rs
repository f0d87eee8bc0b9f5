//! The lowest modes of eight designs at once.
//!
//! Few eigenproblems are solved to the end. A design whose mass and deflection are known need not be looked at further
//! if its lowest mode is below a bar, that of a design no worse in both. Most often what one joint yields tells by
//! itself, and one bar serves all eight; else one pass a block tells. Of the others the block whose Dunkerley sum is
//! largest is solved first; any other block whose lower bound lies below that root gets one pass at it, and only if a
//! pivot is negative there, a root of its own.

use super::arms::EightArms;
use super::row::{Begun, CaseOutboard, ChunkModal, MOST_CASES, RowCase, RowChunk};
use crate::mechanics::lanes::{Eight, LANES, Lanes};
use crate::mechanics::lowest_lanes::{Inner, LaneLink, Outboard, Walk, pass, roots};
use crate::space::levels::Keep;
use crate::space::station::{Block, BlockSlot, Modal};
use std::f64::consts::TAU;

/// Cases and their blocks.
type Blocks = [Option<(usize, usize)>; 2 * MOST_CASES];

/// Eight complete arms, asked for their lowest modes.
#[derive(Clone, Copy)]
pub(crate) struct Question<'a, 'c> {
    at: RowChunk<'a, 'c>,
    begun: &'a Begun,
    arms: &'a EightArms,
}

/// What is asked of a block.
#[derive(Clone, Copy)]
struct Ask<V> {
    /// In which lanes.
    open: u8,
    /// Which of their lowest eigenvalues are below these?
    below: V,
    /// And what are they? Where to look for them first.
    guess: Option<V>,
}

impl RowChunk<'_, '_> {
    /// The group of a design.
    #[inline(always)]
    pub fn group(&self, lane: usize) -> Option<usize> {
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
    pub fn new(at: RowChunk<'a, 'c>, begun: &'a Begun, arms: &'a EightArms) -> Self {
        Self { at, begun, arms }
    }

    /// Designs that one bar for all eight shows to be of no interest, that of the least mass and the least deflection
    /// among them; `tip_m2` are the squares of their deflections.
    #[inline(always)]
    pub fn below_one_bar<V: Lanes>(&self, keep: &impl Keep, tip_m2: &Eight, held: u8) -> u8 {
        if !self.at.of_one_group() {
            return 0;
        }
        let bar_hz = keep.bar_hz(self.at.group(0), least(&self.arms.mass_kg), least(tip_m2).sqrt());
        held & self.sluggish(V::splat(eigenvalue(bar_hz)))
    }

    /// Designs whose lowest mode is below the bar of what is of interest.
    #[inline(always)]
    pub fn below_bar<V: Lanes>(&self, keep: &impl Keep, held: u8) -> u8 {
        let (mass_kg, tip_deflection_m) = (&self.arms.mass_kg, &self.arms.tip_deflection_m);
        let mut bars = [0.0; LANES];
        for lane in (0..LANES).filter(|lane| held >> lane & 1 == 1) {
            bars[lane] = eigenvalue(keep.bar_hz(self.at.group(lane), mass_kg[lane], tip_deflection_m[lane]));
        }
        self.below::<V>(&bars, held)
    }

    /// Lanes whose lowest eigenvalue is below a bar.
    #[inline(always)]
    fn below<V: Lanes>(&self, bars: &Eight, held: u8) -> u8 {
        let below = V::load(bars);
        let asked = held & V::zero().less(below);
        let mut above = asked & !self.sluggish(below);
        if above == 0 {
            return asked;
        }
        for &block in self.blocks(above).iter().flatten() {
            let open = above & self.least::<V>(block).less(below);
            if open != 0 {
                above &= !self.answer(block, Ask { open, below, guess: None }).1;
            }
        }
        asked & !above
    }

    /// Lowest eigenvalue over all judged cases, and the lanes in which it was not found.
    #[inline(always)]
    pub fn lowest<V: Lanes>(&self, held: u8) -> (V, u8) {
        let (mut lowest, mut unsure) = (V::splat(f64::INFINITY), 0);
        for &block in self.blocks(held).iter().flatten() {
            let least = self.least::<V>(block);
            let open = held & least.less(lowest);
            if open != 0 {
                let guess = V::choose(lowest.less(V::splat(f64::INFINITY)), V::splat(0.97) * lowest, least);
                let ask = Ask { open, below: lowest, guess: Some(guess.max(least)) };
                let (root, lost) = self.answer(block, ask);
                lowest = lowest.min(root);
                unsure |= lost;
            }
        }
        (lowest, unsure)
    }

    /// Lanes in which a single joint yields so much that the lowest eigenvalue is below a bar. One over it is the largest
    /// eigenvalue of flexibility times mass, and nothing on the diagonal of a symmetric matrix is larger than that.
    #[inline(always)]
    fn sluggish<V: Lanes>(&self, below: V) -> u8 {
        V::splat(1.0).less(V::load(&self.arms.largest_s2) * below)
    }

    /// Dunkerley's lower bound of a block's lowest eigenvalue.
    #[inline(always)]
    fn least<V: Lanes>(&self, (case, block): (usize, usize)) -> V {
        V::splat(1.0) / V::load(&self.arms.cases[case].trace_s2[block])
    }

    /// Blocks of the judged cases, that of the largest Dunkerley sum first.
    fn blocks(&self, of: u8) -> Blocks {
        let mut blocks = [None; 2 * MOST_CASES];
        let (mut largest, mut count) = (0.0, 0);
        for (c, _) in self.at.row.cases.iter().enumerate().filter(|(_, case)| case.judged) {
            for block in 0..2 {
                let traces = &self.arms.cases[c].trace_s2[block];
                let sum: f64 = (0..LANES).filter(|lane| of >> lane & 1 == 1).map(|lane| traces[lane]).sum();
                if sum > 0.0 {
                    blocks[count] = Some((c, block));
                    if sum > largest {
                        blocks.swap(0, count);
                        largest = sum;
                    }
                    count += 1;
                }
            }
        }
        blocks
    }

    /// The eigenvalues, and the lanes in which none was found; without a guess the lanes in which they are below.
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
            _ => (ask.below, ask.open),
        }
    }

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
            let here = pass(outboard, inner, V::choose(known, below, guess.unwrap_or(below)));
            open &= !(known & here.sound & V::zero().less(here.last));
        }
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

/// The inner pieces of eight arms in a block, up to the last that yields.
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
    fn carry(&self, walk: &mut Walk<V, N>) {
        for (k, slot) in self.slots[..self.end].iter().enumerate() {
            match slot {
                BlockSlot::Joint { twist, inertia_per_kg } => {
                    if twist.amax() > 0.0 {
                        walk.joint(twist, V::load(&self.compliance[k]));
                    }
                    if k + 1 < self.end {
                        walk.mass(V::load(&self.masses_kg[k]), inertia_per_kg);
                    }
                }
                BlockSlot::Body(inertia) => walk.body(inertia),
                BlockSlot::Links(_) => match self.link {
                    Some(link) if self.case.links_yield => walk.link(link),
                    Some(link) => walk.rigid(link),
                    None => {}
                },
            }
        }
    }
}
