//! What is said beside a comparison: where the questions of the results differ, and what each leaves out.

use super::failure::Failure;
use super::results::Results;
use crate::report::number::shortest;
use serde_json::Value;
use std::path::PathBuf;

/// A result with its question and what it says beside its numbers.
pub(super) struct Said {
    label: String,
    run: Value,
    /// The study; null if the file is gone.
    study: Value,
}

/// Keys of a study that are the task of the arm, and not the arm: results in which they differ answer different questions.
const TASK: [&str; 7] =
    ["payload", "poses", "cases", "gravity_m_s2", "motion", "constraints", "judged_poses"];

/// The result folders among what is compared, each with its label.
///
/// # Errors
/// As of [`Results::open`].
pub(super) fn said_by(results: &[PathBuf], labels: Vec<String>) -> Result<Vec<Said>, Failure> {
    let folders = results.iter().zip(labels).filter(|(path, _)| path.join("run.json").is_file());
    let said = folders.map(|(path, label)| {
        let study = std::fs::read_to_string(path.join("study.json")).unwrap_or_default();
        let study = serde_json::from_str(&study).unwrap_or_default();
        Ok(Said { label, run: Results::open(path)?.run, study })
    });
    said.collect()
}

/// Where the questions differ, then the remarks of the results, each once.
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

/// Which keys of the task differ, the payloads with their masses.
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
