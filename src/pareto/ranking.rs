//! Ranking: sorts points into the order of a sweep, by radix sort.
//!
//! Each number is converted to an integer code in the same order: the leading 32 of the bits in which the points
//! differ. Three passes of eleven bits sort the codes. If two numbers have the same 32 bits, the numbers themselves
//! are compared. The sort is therefore exact and takes at most O(n log n) time.
//!
//! Points are sorted by the second objective first, which gives the ranks of this objective. A stable sort by the
//! first objective follows.

use rayon::prelude::*;

/// A point and the rank of its second objective. Equal objectives have equal ranks.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Ranked {
    pub point: u32,
    pub rank: u32,
}

/// Points in the order in which a sweep visits them.
pub(crate) struct Ranking {
    /// The points, sorted by first objective, then second, then third, then index.
    pub order: Vec<Ranked>,
    /// Value of the second objective of each rank.
    pub second: Vec<f64>,
}

impl Ranking {
    /// Sorts and ranks points.
    pub(crate) fn new(points: &[[f64; 3]]) -> Self {
        let count = u32::try_from(points.len()).expect("fewer than 2^32 points fit into memory");
        let order: Vec<Ranked> = (0..count).map(|point| Ranked { point, rank: 0 }).collect();
        let objective = |k: usize| move |r: &Ranked| key(points[r.point as usize][k]);
        let by = |k: usize, order| sorted(order, objective(k), objective(k));
        let mut order = by(1, order);
        let mut second = rank(&mut order, points);
        if second.len() < order.len() / 16 {
            // If only few different values of the second objective occur, many points are equal in it. The sort below
            // would need many comparisons between them. A radix sort by the third objective costs less than these
            // comparisons.
            order = by(1, by(2, order));
            second = rank(&mut order, points);
        }
        let all = |r: &Ranked| {
            let [first, _, third] = points[r.point as usize];
            (key(first), r.rank, key(third), r.point)
        };
        Self { order: sorted(order, objective(0), all), second }
    }
}

/// An integer key with the same order as the numbers. Both zeros have the same key.
fn key(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// Sets the rank of each point in `order`, which is sorted by the second objective. Returns the value of the second
/// objective of each rank.
fn rank(order: &mut [Ranked], points: &[[f64; 3]]) -> Vec<f64> {
    let mut second: Vec<f64> = Vec::new();
    for ranked in order {
        let value = points[ranked.point as usize][1];
        if second.last() != Some(&value) {
            second.push(value);
        }
        ranked.rank = second.len() as u32 - 1;
    }
    second
}

/// A point with the 32-bit code by which it is sorted.
#[derive(Clone, Copy, Default)]
struct Coded {
    code: u32,
    ranked: Ranked,
}

/// Sorts points in two steps. First they are sorted by the leading bits of `key`, and points with equal bits keep their
/// order. Then each run of points with equal leading bits is sorted by `whole`, unless it is in order already.
fn sorted<O: Ord + Send>(
    order: Vec<Ranked>,
    key: impl Fn(&Ranked) -> u64 + Sync,
    whole: impl Fn(&Ranked) -> O + Sync,
) -> Vec<Ranked> {
    let keys = || order.par_iter().map(&key);
    let (low, high) = (keys().min().unwrap_or(0), keys().max().unwrap_or(0));
    // Bits above the range of the keys are equal in all points, so the code leaves them out.
    let shift = 32 - (high - low).leading_zeros().min(32);
    let coded = order.par_iter().map(|r| Coded { code: ((key(r) - low) >> shift) as u32, ranked: *r });
    let mut coded = by_code(coded.collect());
    for run in coded.chunk_by_mut(|a, b| a.code == b.code) {
        if !run.is_sorted_by_key(|c| whole(&c.ranked)) {
            run.par_sort_unstable_by_key(|c| whole(&c.ranked));
        }
    }
    coded.into_iter().map(|c| c.ranked).collect()
}

const DIGIT_BITS: u32 = 11;
const DIGITS_COMPARED: usize = 3;

/// Stable radix sort, least significant digit first. A digit that all codes share is skipped.
fn by_code(mut items: Vec<Coded>) -> Vec<Coded> {
    let digit = |code: u32, place: usize| (code >> (DIGIT_BITS * place as u32)) as usize % (1 << DIGIT_BITS);
    let mut counts = vec![[0usize; 1 << DIGIT_BITS]; DIGITS_COMPARED];
    for item in &items {
        for (place, counts) in counts.iter_mut().enumerate() {
            counts[digit(item.code, place)] += 1;
        }
    }
    let mut spare = vec![Coded::default(); items.len()];
    let all = items.len();
    for (place, counts) in counts.iter_mut().enumerate().filter(|(_, c)| !c.contains(&all)) {
        let mut before = 0;
        for count in counts.iter_mut() {
            before += std::mem::replace(count, before);
        }
        for item in &items {
            let slot = &mut counts[digit(item.code, place)];
            spare[*slot] = *item;
            *slot += 1;
        }
        std::mem::swap(&mut items, &mut spare);
    }
    items
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn keys_have_the_order_of_the_numbers() {
        let numbers = [f64::NEG_INFINITY, -2.0, -1e-300, 0.0, 1e-300, 1.0, f64::INFINITY];
        assert!(numbers.windows(2).all(|w| key(w[0]) < key(w[1])));
        assert_eq!(key(0.0), key(-0.0));
    }

    proptest! {
        #[test]
        fn points_come_in_lexicographic_order_with_the_ranks_of_their_seconds(
            points in prop::collection::vec([-3i8..3, -3i8..3, -3i8..3], 0..300),
            spread in prop::sample::select(vec![1.0, 1e-14, 1e9]),
        ) {
            let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(|x| 1.0 + f64::from(x) * spread)).collect();
            let ranking = Ranking::new(&points);
            let mut expected: Vec<u32> = (0..points.len() as u32).collect();
            expected.sort_by(|&a, &b| points[a as usize].partial_cmp(&points[b as usize]).unwrap());
            prop_assert_eq!(ranking.order.iter().map(|r| r.point).collect::<Vec<_>>(), expected);
            prop_assert!(ranking.second.windows(2).all(|w| w[0] < w[1]));
            for r in &ranking.order {
                prop_assert_eq!(ranking.second[r.rank as usize], points[r.point as usize][1]);
            }
        }
    }
}
