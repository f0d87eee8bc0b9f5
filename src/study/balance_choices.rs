//! Choices of springs and counterweights: a study may list several values for a number of a spring or a counterweight.
//!
//! Each combination of these values is a study of its own, with one value each. Every design belongs to one of these
//! studies. The front of the whole study is therefore found from the fronts of these studies: it consists of the
//! designs on them that no design on another one of these fronts dominates.

use serde_json::{Map, Value};

/// Largest number of choices of a study (combinations of the listed values). It is limited because each choice needs a
/// search of its own.
pub(super) const MOST_CHOICES: usize = 200;

/// The springs or the counterweights of a study, with those of their numbers that may be lists of values.
struct Balanced {
    /// Key of the list in the study.
    list: &'static str,
    /// Word that names an item without a name of its own; its number in the list, from 1, follows the word.
    unnamed: &'static str,
    /// Key, name and unit of each number.
    numbers: &'static [[&'static str; 3]],
}

const BALANCED: [Balanced; 2] = [
    Balanced {
        list: "springs",
        unnamed: "spring",
        numbers: &[
            ["force_n", "force", "N"],
            ["stiffness_n_per_m", "stiffness", "N/m"],
            ["free_length_m", "free length", "m"],
            ["stiffness_nm_per_rad", "stiffness", "N m/rad"],
            ["free_deg", "free angle", "deg"],
        ],
    },
    Balanced { list: "counterweights", unnamed: "counterweight", numbers: &[["mass_kg", "mass", "kg"]] },
];

/// A number of a spring or a counterweight that has several values to choose from.
#[derive(Debug, Clone, PartialEq)]
struct OpenNumber {
    /// Key of the list in the study: `springs` or `counterweights`.
    list: &'static str,
    /// Index of the spring or counterweight in this list.
    index: usize,
    /// Key of the number.
    key: &'static str,
    /// Name of the spring or counterweight.
    of: String,
    /// Name of the number in words, and its unit.
    words: [&'static str; 2],
    /// The values to choose from, in the unit of the key.
    values: Vec<f64>,
}

/// One choice of values for all springs and counterweights of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct BalanceChoice {
    /// Name of each number that is chosen, as a column with its unit, such as `gas_spring_force_n`, and its value.
    pub values: Vec<(String, f64)>,
    /// The choice in words, such as `gas spring: force -1300 N`.
    pub words: String,
    /// Text of the study with these values. Its name ends with the choice in words.
    pub text: String,
}

/// The choices of springs and counterweights in the text of a study that was read without faults. They are in the order
/// of the values in the file, and the last number changes first. The list is empty if the study leaves nothing open.
///
/// ```
/// use armwright::study::balance_choices;
///
/// let text = r#"{"name": "crane", "springs": [{"name": "gas spring", "force_n": [-900, -1300]}]}"#;
/// let choices = balance_choices(text);
/// assert_eq!(choices.len(), 2);
/// assert_eq!(choices[1].words, "gas spring: force -1300 N");
/// assert_eq!(choices[1].values, [("gas_spring_force_n".to_string(), -1300.0)]);
/// assert!(balance_choices(&choices[1].text).is_empty(), "each choice is a study with one value");
/// ```
pub fn balance_choices(text: &str) -> Vec<BalanceChoice> {
    let Ok(Value::Object(study)) = serde_json::from_str(text) else { return Vec::new() };
    let open = open_numbers(&study);
    if open.is_empty() {
        return Vec::new();
    }
    let mut picked: Vec<Vec<f64>> = vec![Vec::new()];
    for number in &open {
        let longer = |values: Vec<f64>| number.values.iter().map(move |v| [&values[..], &[*v]].concat());
        picked = picked.into_iter().flat_map(longer).collect();
    }
    picked.iter().map(|values| choice(&study, &open, values)).collect()
}

/// Number of choices of springs and counterweights that a study leaves open; 1 if it leaves none open.
pub(super) fn number_of_choices(study: &Map<String, Value>) -> usize {
    open_numbers(study).iter().map(|number| number.values.len()).fold(1, usize::saturating_mul)
}

/// The numbers of a study's springs and counterweights that are lists of values, in the order of the file.
fn open_numbers(study: &Map<String, Value>) -> Vec<OpenNumber> {
    let mut out = Vec::new();
    for Balanced { list, unnamed, numbers } in BALANCED {
        for (index, item) in study.get(list).and_then(Value::as_array).into_iter().flatten().enumerate() {
            let unnamed = || format!("{unnamed} {}", index + 1);
            let of = item["name"].as_str().filter(|n| !n.is_empty()).map_or_else(unnamed, String::from);
            for &[key, name, unit] in numbers {
                let Some(values) = item[key].as_array() else { continue };
                let values = values.iter().filter_map(Value::as_f64).collect();
                out.push(OpenNumber { list, index, key, of: of.clone(), words: [name, unit], values });
            }
        }
    }
    out
}

/// The choice that gives each of the numbers `open` its value in `values`.
fn choice(study: &Map<String, Value>, open: &[OpenNumber], values: &[f64]) -> BalanceChoice {
    let mut study = study.clone();
    for (number, value) in open.iter().zip(values) {
        study[number.list][number.index][number.key] = (*value).into();
    }
    let words: Vec<String> = open.iter().zip(values).map(|(number, value)| number.in_words(*value)).collect();
    let words = words.join(", ");
    let name = study.get("name").and_then(Value::as_str).unwrap_or_default();
    study["name"] = format!("{name} ({words})").into();
    BalanceChoice {
        values: open.iter().zip(values).map(|(number, value)| (number.column(), *value)).collect(),
        words,
        text: format!("{:#}\n", Value::Object(study)),
    }
}

impl OpenNumber {
    /// Name of the column, in tables of choices, with the chosen value of this number.
    fn column(&self) -> String {
        let plain = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
        format!("{}_{}", self.of.chars().map(plain).collect::<String>(), self.key)
    }

    /// The number with its chosen value, in words.
    fn in_words(&self, value: f64) -> String {
        let [name, unit] = self.words;
        format!("{}: {name} {value} {unit}", self.of)
    }
}
