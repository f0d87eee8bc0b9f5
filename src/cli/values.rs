//! Parsers for the values of options: lists of numbers, and one of several words.

use crate::arm::Words;

/// Comma-separated numbers, as many as asked.
pub(super) fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let list = number_list(text)?;
    list.try_into()
        .map_err(|list: Vec<f64>| format!("{} numbers given, {N} needed, separated by commas", list.len()))
}

/// Comma-separated finite numbers.
pub(super) fn number_list(text: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|cell| match cell.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(format!("\"{cell}\" is not a finite number")),
        })
        .collect()
}

/// Comma-separated `key=number`.
pub(super) fn entries(text: &str) -> Result<Vec<(String, f64)>, String> {
    let entry = |cell: &str| match cell.rsplit_once('=') {
        Some((key, value)) => Ok((key.trim().to_string(), number_list(value)?[0])),
        None => Err(format!("\"{}\" is no entry such as j2_deg=30 or rail_mm=250", cell.trim())),
    };
    text.split(',').map(entry).collect()
}

/// One of the words of a choice.
pub(super) fn choice<T: Words>(text: &str) -> Result<T, String> {
    T::from_word(text).ok_or_else(|| format!("choose one of: {}", T::words()))
}
