//! Halton's low-discrepancy sequence: numbers that are spread evenly over every joint's range, the same in every run.

/// Bases of the sequence, one for each joint. From the 21st joint on, the bases are used again.
const PRIMES: [usize; 20] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71];

/// The number with the index `index` in the sequence of the joint with the number `joint`, both counted from 0. It is
/// at least 0 and less than 1.
pub(crate) fn halton(mut index: usize, joint: usize) -> f64 {
    let base = PRIMES[joint % PRIMES.len()];
    let (mut part, mut sum) = (1.0, 0.0);
    while index > 0 {
        part /= base as f64;
        sum += part * (index % base) as f64;
        index /= base;
    }
    sum
}
