//! Tail probabilities of the chi-squared and normal distributions, and medians.

pub(crate) use crate::reconcile::readings::median::median;

/// Natural logarithm of the probability that a chi-squared variable of `dof` degrees of freedom exceeds `x`.
pub(crate) fn ln_chi_squared_tail(x: f64, dof: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let (a, x) = (dof / 2.0, x / 2.0);
    if x < a + 1.0 { ln_tail_by_series(a, x) } else { ln_tail_by_fraction(a, x) }
}

/// Natural logarithm of the probability that the absolute value of a standard normal deviate exceeds `z`.
pub(crate) fn ln_normal_tail(z: f64) -> f64 {
    ln_chi_squared_tail(z * z, 1.0)
}

/// Probability that a standard normal deviate is below `z`.
pub(crate) fn normal_below(z: f64) -> f64 {
    let beyond = 0.5 * libm::exp(ln_normal_tail(z));
    if z < 0.0 { beyond } else { 1.0 - beyond }
}

fn ln_tail_by_series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
    while term > sum * 1e-16 {
        n += 1.0;
        term *= x / n;
        sum += term;
    }
    let lower = libm::exp(libm::log(sum) + a * libm::log(x) - x - ln_gamma(a));
    libm::log((1.0 - lower).max(1e-300))
}

/// Natural logarithm of the upper tail, by Lentz's continued fraction of the incomplete gamma function.
fn ln_tail_by_fraction(a: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..500 {
        let an = -(i as f64) * (i as f64 - a);
        b += 2.0;
        d = 1.0 / non_zero(an * d + b);
        c = non_zero(b + an / c);
        let factor = d * c;
        h *= factor;
        if (factor - 1.0).abs() < 1e-15 {
            break;
        }
    }
    libm::log(h) + a * libm::log(x) - x - ln_gamma(a)
}

fn non_zero(x: f64) -> f64 {
    if x.abs() < 1e-300 { 1e-300 } else { x }
}

/// Natural logarithm of the gamma function at `x` > 0, by Lanczos' approximation (g = 7, 9 terms).
fn ln_gamma(x: f64) -> f64 {
    const C: [f64; 8] = [
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let sum = C.iter().enumerate().fold(0.999_999_999_999_809_9, |s, (i, c)| s + c / (x + i as f64 + 1.0));
    let t = x + 7.5;
    0.5 * libm::log(std::f64::consts::TAU) + (x + 0.5) * libm::log(t) - t + libm::log(sum)
}

/// The median of the magnitude of a standard normal deviate.
pub(crate) const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_082;

/// A pseudo-random number for each index, the same in each run (SplitMix64). Sorting by it breaks up regular orders of
/// poses.
pub(crate) fn scrambled(index: usize) -> u64 {
    let mut z = (index as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_match_tabulated_quantiles() {
        // 95 % and 99.9 % points of chi-squared (Abramowitz and Stegun, table 26.8)
        for (x, dof, p) in
            [(3.841_46, 1.0, 0.05), (18.307, 10.0, 0.05), (10.828, 1.0, 0.001), (124.342, 100.0, 0.05)]
        {
            assert!((libm::exp(ln_chi_squared_tail(x, dof)) / p - 1.0).abs() < 1e-3, "{x} {dof}");
        }
        assert!((libm::exp(ln_normal_tail(1.959_964)) - 0.05).abs() < 1e-6);
        assert!(
            (normal_below(1.959_964) - 0.975).abs() < 1e-6 && (normal_below(-1.0) - 0.158_655).abs() < 1e-6
        );
        assert!((normal_below(0.0) - 0.5).abs() < 1e-12);
        assert!(ln_chi_squared_tail(2000.0, 10.0) < -900.0);
    }
}
