//! Random numbers that are the same on every machine.

/// A small generator of random numbers (splitmix64).
pub struct Dice(pub u64);

impl Dice {
    /// Uniform in 0..1.
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().max(1e-300).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// One of a list.
    pub fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[((self.uniform() * list.len() as f64) as usize).min(list.len() - 1)]
    }

    /// Uniform between two numbers, of so many digits.
    pub fn rounded(&mut self, low: f64, high: f64, digits: i32) -> f64 {
        let f = 10f64.powi(digits);
        (self.between(low, high) * f).round() / f
    }
}
