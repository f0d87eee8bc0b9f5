//! Reads a time limit from the command line.

use std::time::Duration;

/// The longest time limit \[s\]: ten years. A longer one is taken for a typing error.
const LONGEST_S: f64 = 10.0 * 365.25 * 86_400.0;

/// Reads a time limit in seconds.
///
/// # Errors
/// The text is not a number above zero and up to ten years. The error is a hint to the user.
pub(super) fn time_limit(text: &str) -> Result<Duration, String> {
    let seconds = text.parse::<f64>().map_err(|_| "a number of seconds, such as 60".to_string())?;
    if seconds > 0.0 && seconds <= LONGEST_S {
        return Ok(Duration::from_secs_f64(seconds));
    }
    Err(format!(
        "a number of seconds above zero and at most {LONGEST_S:.0} (ten years); leave it out for no limit"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_time_that_can_be_waited_for_is_a_limit() {
        assert_eq!(time_limit("1.5"), Ok(Duration::from_millis(1500)));
        for text in ["0", "-1", "nan", "inf", "-inf", "1e19", "1e300", "ten", ""] {
            assert!(time_limit(text).is_err(), "{text}");
        }
    }
}
