//! Which kind of file a document or a table is, by its keys or columns.

use super::output_keys::OUTPUTS;
use super::schema::FILES;
use crate::arm::case_keys::CASE;
use crate::input::key::{Kind, SCHEMA_ADDRESS, Shape};
use crate::input::schema::FileKind;
use serde_json::{Map, Value};

/// The kind of file to which a document belongs. A list of cases is of the kind "cases". For an object it is the kind
/// with which the object has most keys in common. If several kinds have equally many, files that users write come
/// before files that the program writes. `None` if no kind has a key of the object.
pub(super) fn kind_of(value: &Value) -> Option<&'static str> {
    let Value::Object(map) = value else {
        let is_case = |item: &Value| item.as_object().is_some_and(|map| map.keys().any(|key| CASE.has(key)));
        return value.as_array()?.iter().any(is_case).then_some("cases");
    };
    let of_itself = map.contains_key(SCHEMA_ADDRESS.name) as usize;
    let mut best = (of_itself, None);
    for file in FILES.iter().chain(&OUTPUTS) {
        if let Kind::Object(shape) = file.root
            && known(shape, map) > best.0
        {
            best = (known(shape, map), Some(file.name));
        }
    }
    best.1
}

/// Number of keys of a document that files of the kind named `kind` have too; 0 for other values than objects.
pub(super) fn keys_of_kind(kind: &str, value: &Value) -> usize {
    let file = FILES.iter().chain(&OUTPUTS).find(|file| file.name == kind);
    match (file.map(|file| file.root), value) {
        (Some(Kind::Object(shape)), Value::Object(map)) => known(shape, map),
        _ => 0,
    }
}

/// Number of keys of a document that a kind of object has too, with values that may be of their kind.
fn known(shape: &Shape, map: &Map<String, Value>) -> usize {
    shape.keys.iter().filter(|key| map.get(key.name).is_some_and(|value| may_be(&key.kind, value))).count()
}

/// Whether `value` has the JSON type that `kind` needs: an object for a map, an array for a list. All other kinds are
/// not checked, and the answer is true.
fn may_be(kind: &Kind, value: &Value) -> bool {
    match kind {
        Kind::Map(_) => value.is_object(),
        Kind::List(_) => value.is_array(),
        _ => true,
    }
}

/// The keys that a document lacks, although every file of this kind has them. `kind` is a kind of file that the program
/// writes.
pub(super) fn missing_keys(kind: &str, value: &Value) -> Vec<&'static str> {
    let file: Option<&FileKind> = OUTPUTS.iter().find(|file| file.name == kind);
    let Some(Kind::Object(shape)) = file.map(|file| file.root) else { return Vec::new() };
    let required = shape.keys.iter().filter(|key| key.default.is_none());
    required.map(|key| key.name).filter(|name| value.get(name).is_none()).collect()
}

/// The kind of a table that an export writes, by the first columns of its header; `None` for other tables.
pub(super) fn table_of(text: &str) -> Option<&'static str> {
    const TABLES: [(&str, &str); 2] =
        [("item,count,part,", "bill of materials"), ("element,type,axis_x,", "design table")];
    TABLES.iter().find(|(header, _)| text.starts_with(header)).map(|(_, kind)| *kind)
}
