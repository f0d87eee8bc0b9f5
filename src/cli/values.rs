//! Reads the values of options: lists of numbers, and words of which one is to be chosen.

use crate::arm::Words;
use crate::input::magnitude::beyond_calculation;
use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Command};
use std::ffi::OsStr;

/// Reads exactly `N` numbers, separated by commas.
pub(super) fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let list = number_list(text)?;
    list.try_into()
        .map_err(|list: Vec<f64>| format!("{} numbers given, {N} needed, separated by commas", list.len()))
}

/// Reads finite numbers, separated by commas.
pub(super) fn number_list(text: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|cell| match cell.trim().parse::<f64>() {
            Ok(x) => beyond_calculation(x).map_or(Ok(x), |(problem, _)| Err(problem)),
            Err(_) => Err(format!("\"{cell}\" is not a number")),
        })
        .collect()
}

/// Reads a number that is not negative.
pub(super) fn non_negative(text: &str) -> Result<f64, String> {
    match number_list(text)?.as_slice() {
        [x] if *x >= 0.0 => Ok(*x),
        _ => Err("give a number that is not negative".into()),
    }
}

/// Reads entries `key=number`, separated by commas.
pub(super) fn entries(text: &str) -> Result<Vec<(String, f64)>, String> {
    let entry = |cell: &str| match cell.rsplit_once('=') {
        Some((key, value)) => Ok((key.trim().to_string(), number_list(value)?[0])),
        None => Err(format!("\"{}\" is no entry such as j2_deg=30 or rail_mm=250", cell.trim())),
    };
    text.split(',').map(entry).collect()
}

/// Reads one of the words that `T` allows, which shells propose.
pub(super) fn choice<T: Words + Send + Sync>() -> Proposed<T> {
    let read = |text: &str| T::from_word(text).ok_or_else(|| format!("choose one of: {}", T::words()));
    Proposed { read, words: T::WORDS.iter().map(|(word, _)| *word).collect() }
}

/// Reads any text; shells propose some words.
pub(super) fn proposed(words: Vec<&'static str>) -> Proposed<String> {
    Proposed { read: |text| Ok(text.to_string()), words }
}

/// The reader of a value for which shells propose words.
#[derive(Clone)]
pub(super) struct Proposed<T> {
    read: fn(&str) -> Result<T, String>,
    words: Vec<&'static str>,
}

impl<T: Clone + Send + Sync + 'static> TypedValueParser for Proposed<T> {
    type Value = T;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<T, clap::Error> {
        self.read.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.words.iter().map(|word| PossibleValue::new(*word))))
    }
}
