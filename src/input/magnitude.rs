//! Which magnitudes of a number a file may state.

/// The largest magnitude of a number in a file, in its unit. The mechanics computes powers of such numbers, up to the
/// eighth. The eighth power of this number is still a finite number.
const LARGEST: f64 = 1e30;

/// The smallest number that a file may state for a quantity that must be greater than zero. Such quantities are used
/// as divisors.
const SMALLEST: f64 = 1e-30;

/// Why a number cannot be used in calculations, and a hint; `None` if it can be used.
pub(crate) fn beyond_calculation(x: f64) -> Option<(String, &'static str)> {
    match x {
        _ if !x.is_finite() => Some((format!("= {x} is not a finite number"), "give a finite number")),
        _ if x.abs() > LARGEST => Some((
            format!("= {x:e} is beyond {LARGEST:e}, which no quantity of an arm is in any unit"),
            "check the exponent; what is rigid or without a limit has null, or no such key",
        )),
        _ => None,
    }
}

/// Why a number cannot stand for a quantity that must be greater than zero, and a hint; `None` if it can.
pub(crate) fn not_positive(x: f64) -> Option<(String, &'static str)> {
    match x {
        _ if x <= 0.0 => Some((format!("= {x} must be greater than 0"), "check sign and unit")),
        _ if x < SMALLEST => Some((
            format!("= {x:e} is smaller than {SMALLEST:e}, which no quantity of an arm is in any unit"),
            "check the exponent",
        )),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_numbers_whose_powers_are_finite_are_taken() {
        for x in [0.0, -0.0, 1e-33, -1e30, 2.1e11, 1.0] {
            assert_eq!(beyond_calculation(x), None, "{x}");
        }
        for x in [f64::NAN, f64::INFINITY, 1e160, -1.1e30] {
            assert!(beyond_calculation(x).is_some(), "{x}");
        }
    }

    #[test]
    fn a_positive_quantity_can_be_divided_by() {
        for x in [1e-30, 1.0, 2.1e11] {
            assert_eq!(not_positive(x), None, "{x}");
        }
        for x in [0.0, -1.0, 1e-31, 5e-324] {
            assert!(not_positive(x).is_some(), "{x}");
        }
    }
}
