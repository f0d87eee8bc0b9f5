//! Refuses results of early versions, whose model had no output bearings.

use super::failure::Failure;
use crate::input::json::{Fault, Faults};
use serde_json::Value;
use std::path::Path;

/// The first version whose model has output bearings.
const WITH_BEARINGS: [u64; 3] = [0, 2, 0];

/// Refuses a result that was computed before output bearings were modelled. Its objectives are not those that this
/// version computes.
///
/// # Errors
/// The `tool_version` of the run is lower than [`WITH_BEARINGS`], or is missing.
pub(super) fn refuse_earlier(run_file: &Path, run: &Value) -> Result<(), Failure> {
    let made_by = run["tool_version"].as_str();
    if made_by.and_then(numbers).is_some_and(|version| version >= WITH_BEARINGS) {
        return Ok(());
    }
    let version = made_by.map_or("an unknown version".into(), |version| format!("version {version}"));
    Err(Failure::Input(Faults(vec![Fault {
        file: run_file.display().to_string(),
        line: None,
        field: "tool_version".into(),
        problem: format!("made by {version}, before output bearings were modelled"),
        hint: "run the study again".into(),
    }])))
}

/// The three numbers of a version, without a suffix such as `-rc1`; `None` if there are not three numbers.
fn numbers(version: &str) -> Option<[u64; 3]> {
    let release = version.split(['-', '+']).next()?;
    let parts: Vec<u64> = release.split('.').map(|part| part.parse().ok()).collect::<Option<_>>()?;
    parts.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn versions_are_compared_by_number_and_an_unknown_one_is_refused() {
        let refuse =
            |version: Value| refuse_earlier(Path::new("run.json"), &json!({"tool_version": version}));
        for sound in ["0.2.0", "0.2.1", "0.10.0", "1.0.0", "0.2.0-rc.1"] {
            assert!(refuse(json!(sound)).is_ok(), "{sound}");
        }
        for earlier in [json!("0.1.0"), json!("0.1.99"), json!("new"), Value::Null] {
            assert_eq!(refuse(earlier.clone()).expect_err("earlier").exit_code(), 3, "{earlier}");
        }
    }
}
