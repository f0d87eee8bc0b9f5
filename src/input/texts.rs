//! Checks every text of a JSON document for characters that are not allowed.

use super::names::{Unfit, unfit_name, unfit_text};
use super::path::join;
use serde_json::Value;

/// Name of the key whose value is a name, so that the stricter rules for names apply.
const NAME: &str = "name";

/// Path of every text that is not allowed, with the reason. Keys are checked like names.
pub(crate) fn unfit_texts(value: &Value) -> Vec<(String, Unfit)> {
    let mut found = Vec::new();
    walk(value, "", false, &mut found);
    found
}

fn walk(value: &Value, path: &str, is_name: bool, found: &mut Vec<(String, Unfit)>) {
    match value {
        Value::String(text) => {
            let unfit = if is_name { unfit_name(text) } else { unfit_text(text) };
            found.extend(unfit.map(|unfit| (path.to_string(), unfit)));
        }
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                walk(item, &format!("{path}[{i}]"), false, found);
            }
        }
        Value::Object(map) => {
            for (key, value) in map {
                let inside = join(path, key);
                found.extend(unfit_name(key).map(|unfit| (inside.clone(), unfit)));
                walk(value, &inside, key == NAME, found);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn names_keys_and_texts_are_looked_at_at_any_depth() {
        let value = json!({"name": "=1", "notes": "= 1\nis fine", "chain": [{"name": "a\u{7}"}, {"why": "\u{202e}"}], "+x": 1});
        let paths: Vec<String> = unfit_texts(&value).into_iter().map(|(path, _)| path).collect();
        assert_eq!(paths, ["name", "chain[0].name", "chain[1].why", "+x"]);
    }
}
