//! Remarks that are printed with a comparison: where the questions of the results differ, and what each result leaves
//! out.

use super::failure::Failure;
use super::manifest::STUDY;
use super::results::Results;
use crate::report::number::{shortest, significant};
use serde_json::Value;
use std::path::PathBuf;

/// A result that is compared: its label, its `run.json`, which also has its remarks, and its study.
pub(super) struct Said {
    label: String,
    run: Value,
    /// Contents of `study.json`; null if this file is missing.
    study: Value,
}

/// Keys of a study that state the task of the arm and do not describe the arm itself. Results whose studies differ in
/// such a key, or in the geometry of the chain, answer different questions.
const TASK: [&str; 8] = [
    "payload",
    "tip_force_n",
    "tip_moment_nm",
    "poses",
    "gravity_m_s2",
    "environments",
    "motion",
    "constraints",
];

/// Keys of a study that state which physics and which masses its numbers contain.
const MODEL: [&str; 6] = ["models", "effects", "extras", "harness_kg_per_m", "connection_share", "fit"];

/// The result folders among the compared paths `results`, each with its label from `labels`.
///
/// # Errors
/// The same errors as of [`Results::open`].
pub(super) fn said_by(results: &[PathBuf], labels: Vec<String>) -> Result<Vec<Said>, Failure> {
    let folders = results.iter().zip(labels).filter(|(path, _)| path.join("run.json").is_file());
    let said = folders.map(|(path, label)| {
        let study = std::fs::read_to_string(path.join(STUDY)).unwrap_or_default();
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
    let known: Vec<&Said> = said.iter().filter(|result| result.study.is_object()).collect();
    [tasks_differ(&known), models_differ(&known)].into_iter().flatten().chain(of_results).collect()
}

/// A sentence that names what differs in the tasks of the studies: reach, joints and the keys of [`TASK`]. `None` if
/// nothing differs.
fn tasks_differ(known: &[&Said]) -> Option<String> {
    let of_chain = [reaches_differ(known), joints_differ(known)].into_iter().flatten();
    let words = |key: &str| match key {
        "payload" => {
            let mass_kg = |study: &Value| study["payload"]["mass_kg"].as_f64().unwrap_or(0.0);
            format!("payload ({})", each(known, |study| format!("{} kg", shortest(mass_kg(study)))))
        }
        key => key.to_string(),
    };
    let differing: Vec<String> = of_chain.chain(differing_keys(known, &TASK).map(words)).collect();
    (!differing.is_empty()).then(|| {
        format!(
            "The results answer different questions, so that a lighter arm need not be a better one; their studies differ in: {}.",
            differing.join(", ")
        )
    })
}

/// A sentence that names the keys of [`MODEL`] in which the studies differ; `None` if there is none.
fn models_differ(known: &[&Said]) -> Option<String> {
    let differing: Vec<&str> = differing_keys(known, &MODEL).collect();
    (!differing.is_empty()).then(|| {
        format!(
            "The numbers of the results do not contain the same physics and masses; their studies differ in: {}.",
            differing.join(", ")
        )
    })
}

/// The keys among `keys` whose values are not the same in all studies.
fn differing_keys<'a>(known: &'a [&Said], keys: &'a [&'a str]) -> impl Iterator<Item = &'a str> {
    keys.iter().copied().filter(|key| differs(known, |study| study[*key].clone()))
}

/// Whether the function `of` has different values for two of the studies.
fn differs(known: &[&Said], of: impl Fn(&Value) -> Value) -> bool {
    known.windows(2).any(|pair| of(&pair[0].study) != of(&pair[1].study))
}

/// Words on every study, each followed by the label of its result: `2 kg in a, 3 kg in b`. `words` makes the words on
/// one study.
fn each(known: &[&Said], words: impl Fn(&Value) -> String) -> String {
    let labelled = known.iter().map(|said| format!("{} in {}", words(&said.study), said.label));
    labelled.collect::<Vec<_>>().join(", ")
}

/// Words on the differences in the vectors of the links, with the reach of each stretched arm; `None` if nothing
/// differs.
fn reaches_differ(known: &[&Said]) -> Option<String> {
    let vectors = |study: &Value| elements(study, "link").map(|link| link["vector_m"].clone()).collect();
    differs(known, vectors).then(|| {
        let lengths = each(known, |study| format!("{} m", significant(reach_m(study), 4)));
        format!("lengths and directions of the links (together {lengths})")
    })
}

/// Words on the differences in number, kind and axes of the joints; `None` if nothing differs.
fn joints_differ(known: &[&Said]) -> Option<String> {
    let joints = |study: &Value| -> Vec<Value> {
        let axis = |kind| elements(study, kind).map(|joint| joint["axis"].clone()).collect::<Value>();
        vec![axis("joint"), axis("prismatic")]
    };
    let count = |study: &Value| elements(study, "joint").count() + elements(study, "prismatic").count();
    differs(known, |study| joints(study).into()).then(|| match differs(known, |study| count(study).into()) {
        true => format!("joints ({})", each(known, |study| count(study).to_string())),
        false => "kinds and axes of the joints".to_string(),
    })
}

/// The elements of the chain of the kind `kind`.
fn elements<'a>(study: &'a Value, kind: &'a str) -> impl Iterator<Item = &'a Value> {
    study["chain"].as_array().into_iter().flatten().filter(move |element| element["type"] == kind)
}

/// Length of all links of a study together \[m\].
fn reach_m(study: &Value) -> f64 {
    let length_m = |link: &Value| {
        let components = link["vector_m"].as_array().into_iter().flatten().filter_map(Value::as_f64);
        libm::sqrt(components.map(|x| x * x).sum())
    };
    elements(study, "link").map(length_m).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn said(label: &str, study: Value) -> Said {
        Said { label: label.into(), run: Value::Null, study }
    }

    fn study(lengths_m: [f64; 2], axis: [u8; 3]) -> Value {
        let link = |x: f64| json!({"type": "link", "vector_m": [x, 0, 0]});
        let joint = json!({"type": "joint", "axis": axis});
        json!({"chain": [joint, link(lengths_m[0]), link(lengths_m[1])], "payload": {"mass_kg": 2}})
    }

    #[test]
    fn arms_of_another_reach_or_with_other_joints_answer_another_question() {
        let long = said("front", study([0.6, 0.5], [0, 1, 0]));
        let short = said("short", study([0.3, 0.25], [0, 1, 0]));
        let words = remarks(&[long, short]);
        assert!(words[0].contains("different questions"), "{words:?}");
        assert!(words[0].ends_with("the links (together 1.100 m in front, 0.5500 m in short)."), "{words:?}");
        let turned = [[0, 1, 0], [0, 0, 1]].map(|axis| said("a", study([1.0, 1.0], axis)));
        assert!(remarks(&turned)[0].ends_with("differ in: kinds and axes of the joints."));
        let same = [said("a", study([1.0, 1.0], [0, 1, 0])), said("b", study([1.0, 1.0], [0, 1, 0]))];
        assert_eq!(remarks(&same), Vec::<String>::new());
    }

    #[test]
    fn results_of_other_models_say_so_without_a_word_on_the_task() {
        let mut other = study([1.0, 1.0], [0, 1, 0]);
        other["harness_kg_per_m"] = json!(0.4);
        let words = remarks(&[said("a", study([1.0, 1.0], [0, 1, 0])), said("b", other)]);
        assert_eq!(words.len(), 1, "{words:?}");
        assert!(words[0].ends_with("physics and masses; their studies differ in: harness_kg_per_m."));
    }
}
