//! Paths of values in a JSON document, such as `chain[2].section.wall_m`.

/// The path of a key inside the object at `path`.
pub(crate) fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_string() } else { format!("{path}.{key}") }
}
