//! The cheapest tube when every number of a tube has a price, and the tubes whose price is within a limit.
//!
//! The price of a number is what each unit of it adds to a weighted sum of inequalities ([`rows`](super::rows)).

use super::parts_table::TubeTable;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Largest number of nodes that are priced in the search for the cheapest tube. If it is reached, the price of a
/// node with several tubes is used as a lower bound.
const MOST_LOOKS: usize = 400;

/// Prices of a tube's numbers, separated into positive prices (`paid`) and negative prices (`earned`). For a set of
/// tubes, a number with a positive price is taken at its least value, and a number with a negative price at its
/// greatest.
pub(super) struct Prices {
    paid: Vec<f64>,
    earned: Vec<f64>,
}

impl Prices {
    pub(super) fn new(prices: &[f64]) -> Self {
        Self {
            paid: prices.iter().map(|p| p.max(0.0)).collect(),
            earned: prices.iter().map(|p| p.min(0.0)).collect(),
        }
    }

    /// Lower bound of the price of every tube in a set whose numbers lie between `least` and `most`.
    pub(super) fn of(&self, [least, most]: [&[f64]; 2]) -> f64 {
        dot(&self.paid, least) + dot(&self.earned, most)
    }

    /// The values of a tube's numbers that [`Self::of`] uses: the least value of a number with a positive price, and
    /// the greatest value of one with a negative price.
    pub(super) fn numbers(&self, [least, most]: [&[f64]; 2]) -> Vec<f64> {
        let cheapest = |i: usize| if self.earned[i] < 0.0 { most[i] } else { least[i] };
        (0..least.len()).map(cheapest).collect()
    }
}

/// Dot product of two lists. It is summed in four separate sums, which a processor computes in parallel.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours, others) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest = fours.remainder().iter().zip(others.remainder());
    for (a, b) in fours.zip(others) {
        (0..4).for_each(|i| sums[i] += a[i] * b[i]);
    }
    rest.map(|(a, b)| a * b).sum::<f64>() + (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Price and node of the cheapest tube below the nodes `nodes`. If the search takes too many steps, the returned node
/// has several tubes, and the price is a lower bound for all of them.
pub(super) fn cheapest(table: &TubeTable, nodes: &[u32], prices: &Prices) -> (f64, u32) {
    let price = |node: u32| prices.of(table.bounds(node));
    // The cheapest node is taken first. Of equal prices, the node with the lowest index is taken.
    let offer = |node: u32| Reverse((rank(price(node)), node));
    let mut open: BinaryHeap<Reverse<(i64, u32)>> = nodes.iter().map(|&node| offer(node)).collect();
    let mut looks = 0;
    loop {
        let Reverse((_, best)) = open.pop().expect("a subproblem has tubes");
        match table.tree.halves(best).filter(|_| looks < MOST_LOOKS) {
            Some(halves) => open.extend(halves.map(offer)),
            None => return (price(best), best),
        }
        looks += 2;
    }
}

/// About `about` nodes that together contain every tube below `nodes` that is cheap enough under all sets of prices in
/// `limits`. Each set of prices comes with the greatest price that a tube may have under these prices. The nodes with
/// the most tubes are divided first.
pub(super) fn affordable(
    table: &TubeTable,
    nodes: &[u32],
    limits: &[(Prices, f64)],
    about: usize,
) -> Vec<u32> {
    let can = |node: &u32| limits.iter().all(|(prices, most)| prices.of(table.bounds(*node)) <= *most);
    let sized = |node: u32| (table.tree.options(node).len(), node);
    let mut open: BinaryHeap<(usize, u32)> = nodes.iter().copied().filter(can).map(sized).collect();
    while open.len() < about {
        let Some(halves) = open.peek().and_then(|&(_, node)| table.tree.halves(node)) else { break };
        open.pop();
        open.extend(halves.into_iter().filter(can).map(sized));
    }
    let mut kept: Vec<u32> = open.into_iter().map(|(_, node)| node).collect();
    kept.sort_unstable();
    kept
}

/// An integer that grows with the price, in the order of [`f64::total_cmp`]. A heap can order integers but not
/// floating-point numbers.
fn rank(price: f64) -> i64 {
    let bits = price.to_bits() as i64;
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}
