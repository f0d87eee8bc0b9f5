//! Columns with few distinct values in a short form: the list of values once, then one or two letters per row.
//!
//! A front of ten thousand designs names the same few gears, materials and walls in every row. In this form a
//! choice takes one letter per row. The page's program decodes it with [`ALPHABET`].

use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::LazyLock;

/// The letters that encode indices, in order: printable ASCII characters that need no escape in JSON or in a script
/// element.
pub(crate) static ALPHABET: LazyLock<String> =
    LazyLock::new(|| (' '..='~').filter(|c| !['"', '\\', '<'].contains(c)).collect());

/// Indices below `count` as text. Each takes as many letters as the largest index needs.
pub(crate) fn packed(indexes: impl Iterator<Item = usize>, count: usize) -> Value {
    let letters = ALPHABET.as_bytes();
    let base = letters.len();
    let width = (1..).find(|w| base.pow(*w) >= count).unwrap_or(1);
    let mut text = String::new();
    for index in indexes {
        text.extend((0..width).rev().map(|place| char::from(letters[index / base.pow(place) % base])));
    }
    json!({ "width": width, "text": text })
}

/// A column of numbers, some of them blank. It is encoded with a list of its distinct values, if that is shorter.
pub(crate) fn column(values: &[Option<f64>]) -> Value {
    let key = |v: &Option<f64>| v.map(f64::to_bits);
    let mut places: HashMap<Option<u64>, usize> = HashMap::new();
    let mut list = Vec::new();
    let indexes: Vec<usize> = values
        .iter()
        .map(|v| {
            *places.entry(key(v)).or_insert_with(|| {
                list.push(number(*v));
                list.len() - 1
            })
        })
        .collect();
    let mut packed = packed(indexes.into_iter(), list.len());
    packed["list"] = list.into();
    let plain = Value::from(values.iter().map(|v| number(*v)).collect::<Vec<_>>());
    if packed.to_string().len() < plain.to_string().len() { packed } else { plain }
}

/// A number in the shortest JSON form: without a fraction it is an integer, because `80` is shorter than `80.0`.
fn number(value: Option<f64>) -> Value {
    match value {
        Some(v) if v.fract() == 0.0 && v.abs() < 1e15 => json!(v as i64),
        Some(v) => json!(v),
        None => Value::Null,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(packed: &Value) -> Vec<usize> {
        let width = packed["width"].as_u64().expect("a width") as usize;
        let text = packed["text"].as_str().expect("text").as_bytes();
        let place = |c: &u8| ALPHABET.bytes().position(|l| l == *c).expect("a letter");
        text.chunks(width).map(|c| c.iter().fold(0, |sum, l| sum * ALPHABET.len() + place(l))).collect()
    }

    #[test]
    fn what_is_packed_is_read_back() {
        for count in [1, 2, 92, 93, 9000] {
            let indexes: Vec<usize> = (0..count).chain([0]).collect();
            assert_eq!(read(&packed(indexes.iter().copied(), count)), indexes, "{count}");
        }
    }

    #[test]
    fn few_values_are_packed_and_many_are_not() {
        let few: Vec<Option<f64>> = (0..400).map(|i| (i % 5 > 0).then_some(f64::from(i % 5) * 0.5)).collect();
        let column_of_few = column(&few);
        assert_eq!(column_of_few["list"], json!([null, 0.5, 1, 1.5, 2]));
        assert_eq!(read(&column_of_few)[..6], [0, 1, 2, 3, 4, 0]);
        let many: Vec<Option<f64>> = (0..400).map(|i| Some(f64::from(i) * 0.37)).collect();
        assert!(column(&many).is_array());
    }

    #[test]
    fn the_letters_need_no_escape() {
        assert_eq!(json!(*ALPHABET).to_string().len(), ALPHABET.len() + 2);
        assert!(!ALPHABET.contains('<'));
    }
}
