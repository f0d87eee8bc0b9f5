//! Remarks that are printed with a comparison: where the questions of the results differ, and what each result leaves
//! out.

use super::failure::Failure;
use super::results::Results;
use crate::report::number::shortest;
use serde_json::Value;
use std::path::PathBuf;

/// A result that is compared: its label, its `run.json`, which has its remarks, and its study.
pub(super) struct Said {
    label: String,
    run: Value,
    /// Contents of `study.json`; null if this file is missing.
    study: Value,
}

/// Keys of a study that state the task of the arm and do not describe the arm itself. Results whose studies differ in
/// such a key answer different questions.
const TASK: [&str; 7] =
    ["payload", "poses", "cases", "gravity_m_s2", "motion", "constraints", "judged_poses"];

/// The result folders among the compared paths `results`, each with its label from `labels`.
///
/// # Errors
/// The same errors as of [`Results::open`].
pub(super) fn said_by(results: &[PathBuf], labels: Vec<String>) -> Result<Vec<Said>, Failure> {
    let folders = results.iter().zip(labels).filter(|(path, _)| path.join("run.json").is_file());
    let said = folders.map(|(path, label)| {
        let study = std::fs::read_to_string(path.join("study.json")).unwrap_or_default();
        let study = serde_json::from_str(&study).unwrap_or_default();
        Ok(Said { label, run: Results::open(path)?.run, study })
    });
    said.collect()
}

/// The remarks on a comparison: first a sentence that says where the questions differ, then the remarks of the results.
/// A remark that several results have is listed once.
pub(super) fn remarks(said: &[Said]) -> Vec<String> {
    let mut by_words: Vec<(&str, Vec<&str>)> = Vec::new();
    for result in said {
        let listed = result.run["remarks"].as_array().into_iter().flatten();
        for words in listed.chain([&result.run["caveats"]]).filter_map(Value::as_str) {
            match by_words.iter_mut().find(|(known, _)| *known == words) {
                Some((_, labels)) => labels.push(result.label.as_str()),
                None => by_words.push((words, vec![result.label.as_str()])),
            }
        }
    }
    let of_results = by_words.into_iter().map(|(words, labels)| match labels.len() == said.len() {
        true => words.to_string(),
        false => format!("{}: {words}", labels.join(", ")),
    });
    tasks_differ(said).into_iter().chain(of_results).collect()
}

/// A sentence that names those keys of [`TASK`] in which the studies differ, with the mass of each payload if the
/// payloads differ. `None` if no key differs.
fn tasks_differ(said: &[Said]) -> Option<String> {
    let known: Vec<&Said> = said.iter().filter(|result| result.study.is_object()).collect();
    let (first, others) = known.split_first()?;
    let differs = |key: &&&str| others.iter().any(|other| other.study[**key] != first.study[**key]);
    let words = |key: &&str| match *key {
        "payload" => {
            let carried = known.iter().map(|result| {
                let kg = result.study["payload"]["mass_kg"].as_f64().unwrap_or(0.0);
                format!("{} kg in {}", shortest(kg), result.label)
            });
            format!("payload ({})", carried.collect::<Vec<_>>().join(", "))
        }
        key => key.to_string(),
    };
    let differing: Vec<String> = TASK.iter().filter(differs).map(words).collect();
    (!differing.is_empty()).then(|| {
        format!(
            "The results answer different questions, so that a lighter arm need not be a better one; their studies differ in: {}.",
            differing.join(", ")
        )
    })
}
