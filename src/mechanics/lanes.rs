//! Lanes: arithmetic on eight numbers at once, one for each of eight designs.
//!
//! A kernel is written once over the trait [`Lanes`] and compiled for three instruction sets. [`in_lanes`] takes the
//! widest set that the processor has. With every set, the same IEEE operations run in the same order, without
//! contraction to fused multiply-add. Results are therefore equal to the last bit on every machine. `std::simd` is
//! not stable yet, so the few operations that the kernels need are written out here.

use std::ops::{Add, Div, Mul, Sub};

/// Number of designs that are evaluated side by side.
pub(crate) const LANES: usize = 8;
/// One number for each of eight designs.
pub(crate) type Eight = [f64; LANES];

/// Eight numbers in the registers of the processor.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The same number in every lane.
    fn splat(x: f64) -> Self;
    /// Reads eight numbers from memory.
    fn load(from: &Eight) -> Self;
    /// Writes the eight numbers to memory.
    fn store(self) -> Eight;
    /// The numbers of the list `from` at the eight indices `at`.
    ///
    /// # Panics
    /// If an index is beyond the end of the list.
    fn gather(from: &[f64], at: &[usize; LANES]) -> Self;
    /// Square root in each lane.
    fn sqrt(self) -> Self;
    /// The smaller of the two numbers in each lane; the second one if either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of the two numbers in each lane; the second one if either is NaN.
    fn max(self, other: Self) -> Self;
    /// Bit mask: a bit is set for each lane in which the first number is less than the second. The bit of a lane with
    /// a NaN is not set.
    fn less(self, other: Self) -> u8;
    /// In each lane the number of `set` if the lane's bit in `bits` is set, else the number of `clear`.
    fn choose(bits: u8, set: Self, clear: Self) -> Self;

    /// Zero in every lane.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }

    /// The absolute value in each lane.
    #[inline(always)]
    fn abs(self) -> Self {
        self.max(Self::zero() - self)
    }
}

/// Several numbers, each of them repeated in every lane.
#[inline(always)]
pub(crate) fn splat_all<V: Lanes, const K: usize>(numbers: [f64; K]) -> [V; K] {
    let mut out = [V::zero(); K];
    for k in 0..K {
        out[k] = V::splat(numbers[k]);
    }
    out
}

/// Loads several sets of eight numbers from memory.
#[inline(always)]
pub(crate) fn load_all<V: Lanes, const K: usize>(from: &[Eight; K]) -> [V; K] {
    let mut out = [V::zero(); K];
    for k in 0..K {
        out[k] = V::load(&from[k]);
    }
    out
}

/// Stores several sets of eight numbers in memory.
#[inline(always)]
pub(crate) fn store_all<V: Lanes, const K: usize>(from: [V; K]) -> [Eight; K] {
    let mut out = [[0.0; LANES]; K];
    for k in 0..K {
        out[k] = from[k].store();
    }
    out
}

/// Subtracts `factor` times each number of `list` from the number of `from` at the same place. Both lists have the same
/// length.
#[inline(always)]
pub(crate) fn subtract_multiple<V: Lanes>(from: &mut [f64], factor: f64, list: &[f64]) {
    let (eights, rest) = from.as_chunks_mut::<LANES>();
    let (list_eights, list_rest) = list.as_chunks::<LANES>();
    for (x, y) in eights.iter_mut().zip(list_eights) {
        *x = (V::load(x) - V::splat(factor) * V::load(y)).store();
    }
    for (x, y) in rest.iter_mut().zip(list_rest) {
        *x -= factor * y;
    }
}

/// A computation that is written over [`Lanes`], so that it can be compiled for each instruction set.
///
/// All functions that handle lanes must be inlined into `run`, because only `run` is compiled for a particular
/// instruction set. A closure is a function of its own and would be compiled for the basic instruction set. The
/// kernels are therefore written with plain loops.
pub(crate) trait LaneWork {
    /// Result of the computation.
    type Output;
    /// Carries out the computation.
    fn run<V: Lanes>(self) -> Self::Output;
}

/// Carries out a computation with the widest registers that the processor has.
#[inline]
pub(crate) fn in_lanes<W: LaneWork>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
            // SAFETY: the machine has the features for which the function is compiled
            return unsafe { x86::with_avx512(work) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the machine has the features for which the function is compiled
            return unsafe { x86::with_avx2(work) };
        }
    }
    work.run::<Portable>()
}

/// Eight numbers in an array, for processors without wide registers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Portable(Eight);

macro_rules! array_operator {
    ($trait:ident, $name:ident, $operator:tt) => {
        impl $trait for Portable {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(std::array::from_fn(|i| self.0[i] $operator other.0[i]))
            }
        }
    };
}
array_operator!(Add, add, +);
array_operator!(Sub, sub, -);
array_operator!(Mul, mul, *);
array_operator!(Div, div, /);

impl Lanes for Portable {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; LANES])
    }

    #[inline(always)]
    fn load(from: &Eight) -> Self {
        Self(*from)
    }

    #[inline(always)]
    fn store(self) -> Eight {
        self.0
    }

    #[inline(always)]
    fn gather(from: &[f64], at: &[usize; LANES]) -> Self {
        Self(at.map(|i| from[i]))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] }))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] }))
    }

    #[inline(always)]
    fn less(self, other: Self) -> u8 {
        (0..LANES).fold(0, |bits, i| bits | u8::from(self.0[i] < other.0[i]) << i)
    }

    #[inline(always)]
    fn choose(bits: u8, set: Self, clear: Self) -> Self {
        Self(std::array::from_fn(|i| if bits >> i & 1 == 1 { set.0[i] } else { clear.0[i] }))
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! Registers of x86-64. [`super::in_lanes`] runs a kernel on these types only after it has found their instruction
    //! set on the machine. Every intrinsic here belongs to that set.

    use super::{Add, Div, Eight, LANES, LaneWork, Lanes, Mul, Sub};
    use std::arch::x86_64::*;

    #[target_feature(enable = "avx512f,avx512dq")]
    pub(super) fn with_avx512<W: LaneWork>(work: W) -> W::Output {
        work.run::<Wide>()
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn with_avx2<W: LaneWork>(work: W) -> W::Output {
        work.run::<Halves>()
    }

    /// Eight numbers in one register (AVX-512).
    #[derive(Clone, Copy)]
    pub(super) struct Wide(__m512d);

    /// Eight numbers in two registers of four (AVX2).
    #[derive(Clone, Copy)]
    pub(super) struct Halves(__m256d, __m256d);

    macro_rules! register_operator {
        ($trait:ident, $name:ident, $wide:ident, $half:ident) => {
            impl $trait for Wide {
                type Output = Self;
                #[inline(always)]
                fn $name(self, other: Self) -> Self {
                    // SAFETY: this code runs only where the instruction set was found
                    Self(unsafe { $wide(self.0, other.0) })
                }
            }

            impl $trait for Halves {
                type Output = Self;
                #[inline(always)]
                fn $name(self, other: Self) -> Self {
                    // SAFETY: this code runs only where the instruction set was found
                    unsafe { Self($half(self.0, other.0), $half(self.1, other.1)) }
                }
            }
        };
    }
    register_operator!(Add, add, _mm512_add_pd, _mm256_add_pd);
    register_operator!(Sub, sub, _mm512_sub_pd, _mm256_sub_pd);
    register_operator!(Mul, mul, _mm512_mul_pd, _mm256_mul_pd);
    register_operator!(Div, div, _mm512_div_pd, _mm256_div_pd);

    // SAFETY, for every block below: it runs only where its instruction set was found. Loads and stores need no
    // alignment and stay within the array.
    impl Lanes for Wide {
        #[inline(always)]
        fn splat(x: f64) -> Self {
            Self(unsafe { _mm512_set1_pd(x) })
        }

        #[inline(always)]
        fn load(from: &Eight) -> Self {
            Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
        }

        #[inline(always)]
        fn store(self) -> Eight {
            let mut out = [0.0; 8];
            unsafe { _mm512_storeu_pd(out.as_mut_ptr(), self.0) };
            out
        }

        #[inline(always)]
        fn gather(from: &[f64], at: &[usize; LANES]) -> Self {
            assert_within(from, at);
            // SAFETY: every place is within the list; `usize` is 64 bits wide here
            unsafe {
                let places = _mm512_loadu_si512(at.as_ptr().cast());
                Self(_mm512_i64gather_pd::<8>(places, from.as_ptr()))
            }
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm512_sqrt_pd(self.0) })
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { _mm512_min_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm512_max_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn less(self, other: Self) -> u8 {
            unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
        }

        #[inline(always)]
        fn choose(bits: u8, set: Self, clear: Self) -> Self {
            Self(unsafe { _mm512_mask_blend_pd(bits, clear.0, set.0) })
        }
    }

    /// Panics if an index of a gather is beyond the end of the list. The hardware does not check this.
    #[inline(always)]
    fn assert_within(list: &[f64], at: &[usize; LANES]) {
        let mut highest = 0;
        for &place in at {
            highest = place.max(highest);
        }
        assert!(highest < list.len(), "place {highest} of {}", list.len());
    }

    impl Lanes for Halves {
        #[inline(always)]
        fn splat(x: f64) -> Self {
            let half = unsafe { _mm256_set1_pd(x) };
            Self(half, half)
        }

        #[inline(always)]
        fn load(from: &Eight) -> Self {
            let start = from.as_ptr();
            unsafe { Self(_mm256_loadu_pd(start), _mm256_loadu_pd(start.add(4))) }
        }

        #[inline(always)]
        fn store(self) -> Eight {
            let mut out = [0.0; 8];
            let start = out.as_mut_ptr();
            unsafe {
                _mm256_storeu_pd(start, self.0);
                _mm256_storeu_pd(start.add(4), self.1);
            }
            out
        }

        #[inline(always)]
        fn gather(from: &[f64], at: &[usize; LANES]) -> Self {
            assert_within(from, at);
            // SAFETY: every place is within the list; `usize` is 64 bits wide here
            unsafe {
                let low = _mm256_loadu_si256(at.as_ptr().cast());
                let high = _mm256_loadu_si256(at.as_ptr().add(4).cast());
                let start = from.as_ptr();
                Self(_mm256_i64gather_pd::<8>(start, low), _mm256_i64gather_pd::<8>(start, high))
            }
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            unsafe { Self(_mm256_sqrt_pd(self.0), _mm256_sqrt_pd(self.1)) }
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            unsafe { Self(_mm256_min_pd(self.0, other.0), _mm256_min_pd(self.1, other.1)) }
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            unsafe { Self(_mm256_max_pd(self.0, other.0), _mm256_max_pd(self.1, other.1)) }
        }

        #[inline(always)]
        fn less(self, other: Self) -> u8 {
            unsafe {
                let low = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0));
                let high = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.1, other.1));
                (low | high << 4) as u8
            }
        }

        #[inline(always)]
        fn choose(bits: u8, set: Self, clear: Self) -> Self {
            unsafe {
                // AVX2 has no mask registers, so each bit is expanded to a lane of its own
                let place = |first: i64| {
                    let own = _mm256_setr_epi64x(first, first << 1, first << 2, first << 3);
                    let all = _mm256_set1_epi64x(i64::from(bits));
                    _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(all, own), own))
                };
                Self(_mm256_blendv_pd(clear.0, set.0, place(1)), _mm256_blendv_pd(clear.1, set.1, place(16)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Everything(Eight, Eight);

    impl LaneWork for Everything {
        type Output = (Vec<Eight>, u8);

        fn run<V: Lanes>(self) -> Self::Output {
            let (a, b) = (V::load(&self.0), V::load(&self.1));
            let bits = a.less(b);
            let results = [
                a + b,
                a - b,
                a * b,
                a / b,
                a.abs().sqrt(),
                a.min(b),
                a.max(b),
                V::choose(bits, a, V::splat(7.0)),
                V::gather(&self.1, &[7, 0, 3, 3, 1, 6, 2, 5]),
            ];
            (results.iter().map(|v| v.store()).collect(), bits)
        }
    }

    #[test]
    fn every_set_gives_the_same_bits() {
        let a = [1.0, -2.5, 3e300, f64::NAN, 0.1, 0.2, -0.3, 1e-310];
        let b = [3.0, 7.7, 2e300, 1.0, 0.3, 0.2, 0.7, 2.0];
        let (wide, wide_bits) = in_lanes(Everything(a, b));
        let (plain, plain_bits) = Everything(a, b).run::<Portable>();
        assert_eq!(wide_bits, plain_bits);
        for (w, p) in wide.iter().flatten().zip(plain.iter().flatten()) {
            assert!(w.to_bits() == p.to_bits() || (w.is_nan() && p.is_nan()), "{w} {p}");
        }
    }
}
