//! The key tables of a kind of file, written as a JSON Schema (draft 2020-12) for editors and other programs, and
//! as Markdown for people.

use super::key::{Key, Kind, Rule, Shape};
use serde_json::{Map, Value, json};

/// A kind of file: its name, its description, and the allowed content of the whole document.
#[derive(Debug, Clone, Copy)]
pub struct FileKind {
    /// Name of the kind of file on the command line.
    pub name: &'static str,
    /// Description of such a file, in a sentence.
    pub about: &'static str,
    /// Allowed content of the whole document.
    pub root: Kind,
}

impl FileKind {
    /// The JSON Schema of this kind of file.
    pub fn schema(&self) -> Value {
        let mut definitions = Map::new();
        for shape in self.shapes() {
            definitions.insert(shape.name.into(), object(shape));
        }
        let mut out = json!({
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": format!("Armwright: {}", self.name),
            "description": self.about,
        });
        merge(&mut out, value(&self.root));
        out["$defs"] = Value::Object(definitions);
        out
    }

    /// Every kind of object in such a file, each once. The outermost object comes first.
    pub fn shapes(&self) -> Vec<&'static Shape> {
        let mut found = Vec::new();
        collect(&self.root, &mut found);
        found
    }

    /// The keys of this kind of file as Markdown tables.
    pub fn tables(&self) -> String {
        let mut out = format!("## {}\n\n{}\n", self.name, self.about);
        for shape in self.shapes() {
            out.push_str(&format!("\n### {}: {}\n\n{}\n", self.name, shape.name, shape.about));
            out.push_str("\n| key | value | unit | default | meaning |\n|---|---|---|---|---|\n");
            out.extend(shape.keys.iter().map(row));
            let rules: Vec<String> = shape.rules.iter().map(in_words).collect();
            if !rules.is_empty() {
                out.push_str(&format!("\n{}\n", rules.join(" ")));
            }
        }
        out
    }
}

/// Adds the shapes that occur in a kind of value to `found`.
fn collect(kind: &Kind, found: &mut Vec<&'static Shape>) {
    match kind {
        Kind::Object(shape) if !found.iter().any(|other| other.name == shape.name) => {
            found.push(shape);
            shape.keys.iter().map(|key| &key.kind).chain(shape.others).for_each(|k| collect(k, found));
        }
        Kind::Array(_, inner) | Kind::List(inner) | Kind::NonEmpty(inner) | Kind::Map(inner) => {
            collect(inner, found);
        }
        Kind::Either(kinds) => kinds.iter().for_each(|k| collect(k, found)),
        _ => {}
    }
}

/// Adds the entries of the JSON object `from` to the JSON object `into`.
fn merge(into: &mut Value, from: Value) {
    if let (Value::Object(into), Value::Object(from)) = (into, from) {
        into.extend(from);
    }
}

/// The JSON Schema of a kind of value.
fn value(kind: &Kind) -> Value {
    match kind {
        Kind::Anything => json!({}),
        Kind::Null => json!({"type": "null"}),
        Kind::Flag => json!({"type": "boolean"}),
        Kind::Text => json!({"type": "string"}),
        Kind::Name => json!({"type": "string", "minLength": 1}),
        Kind::Word([word]) => json!({"const": word}),
        Kind::Word(words) => json!({"enum": words}),
        Kind::Number => json!({"type": "number"}),
        Kind::Positive => json!({"type": "number", "exclusiveMinimum": 0}),
        Kind::NonNegative => json!({"type": "number", "minimum": 0}),
        Kind::Below(most) => json!({"type": "number", "minimum": 0, "exclusiveMaximum": most}),
        Kind::Range(from, to) => json!({"type": "number", "minimum": from, "maximum": to}),
        Kind::Whole(least) => json!({"type": "integer", "minimum": least}),
        Kind::Array(count, inner) => {
            json!({"type": "array", "items": value(inner), "minItems": count, "maxItems": count})
        }
        Kind::List(inner) => json!({"type": "array", "items": value(inner)}),
        Kind::NonEmpty(inner) => json!({"type": "array", "items": value(inner), "minItems": 1}),
        Kind::Map(inner) => json!({"type": "object", "additionalProperties": value(inner)}),
        Kind::Object(shape) => json!({"$ref": format!("#/$defs/{}", pointer(shape.name))}),
        Kind::Either(kinds) => json!({"anyOf": kinds.iter().map(value).collect::<Vec<_>>()}),
    }
}

/// The name of a definition in the form that it has inside a JSON reference.
fn pointer(name: &str) -> String {
    name.replace(' ', "%20")
}

fn object(shape: &Shape) -> Value {
    let properties: Map<String, Value> = shape.keys.iter().map(|k| (k.name.into(), property(k))).collect();
    let required: Vec<&str> = shape.keys.iter().filter(|k| k.default.is_none()).map(|k| k.name).collect();
    let mut out = json!({
        "description": shape.about,
        "type": "object",
        "properties": properties,
        "additionalProperties": shape.others.map_or(json!(false), value),
    });
    if !required.is_empty() {
        out["required"] = json!(required);
    }
    if !shape.rules.is_empty() {
        out["allOf"] = shape.rules.iter().map(rule).collect();
    }
    out
}

fn property(key: &Key) -> Value {
    let mut out = value(&key.kind);
    out["description"] = json!(sentence(key));
    if let Some(default) = key.default.and_then(|text| serde_json::from_str::<Value>(text).ok()) {
        out["default"] = default;
    }
    out
}

/// Description of a key with its unit and its default, in sentences.
fn sentence(key: &Key) -> String {
    let unit = if key.unit == "-" { String::new() } else { format!(" [{}]", key.unit) };
    let default = key.default.map(|text| format!(" Default: {text}."));
    format!("{}{unit}{}", key.about, default.unwrap_or_default())
}

/// JSON Schema for a list of keys that must all occur, and a list of keys of which none may occur.
fn needs_and_refuses([needed, refused]: [&[&str]; 2]) -> Value {
    let mut out = json!({});
    if !needed.is_empty() {
        out["required"] = json!(needed);
    }
    if !refused.is_empty() {
        out["not"] = any_of(refused);
    }
    out
}

fn any_of(keys: &[&str]) -> Value {
    json!({"anyOf": keys.iter().map(|key| json!({"required": [key]})).collect::<Vec<_>>()})
}

fn rule(rule: &Rule) -> Value {
    match rule {
        Rule::Any(keys) => any_of(keys),
        Rule::Needs(key, others) => json!({"if": {"required": [key]}, "then": any_of(others)}),
        Rule::Refuses(key, others) => json!({"if": {"required": [key]}, "then": {"not": any_of(others)}}),
        Rule::When { key, is, then, otherwise } => json!({
            "if": {"required": [key]},
            "then": {
                "if": {"properties": {*key: value(is)}},
                "then": needs_and_refuses(*then),
                "else": needs_and_refuses(*otherwise),
            },
        }),
    }
}

fn row(key: &Key) -> String {
    let default = match key.default {
        None => "required".to_string(),
        Some(text) if serde_json::from_str::<Value>(text).is_ok() => format!("`{text}`"),
        Some(text) => text.to_string(),
    };
    format!("| `{}` | {} | {} | {default} | {} |\n", key.name, words(&key.kind), key.unit, key.about)
}

/// Description in words of the values that are allowed.
fn words(kind: &Kind) -> String {
    let codes = |words: &[&str]| words.iter().map(|w| format!("`{w}`")).collect::<Vec<_>>().join(", ");
    match kind {
        Kind::Anything => "anything".into(),
        Kind::Null => "`null`".into(),
        Kind::Flag => "`true` or `false`".into(),
        Kind::Text | Kind::Name => "text".into(),
        Kind::Word([word]) => format!("`\"{word}\"`"),
        Kind::Word(words) => format!("one of {}", codes(words)),
        Kind::Number => "number".into(),
        Kind::Positive => "number > 0".into(),
        Kind::NonNegative => "number >= 0".into(),
        Kind::Below(most) => format!("number from 0 to below {most}"),
        Kind::Range(from, to) => format!("number from {from} to {to}"),
        Kind::Whole(least) => format!("whole number from {least}"),
        Kind::Array(count, inner) => format!("list of {count}: {}", words(inner)),
        Kind::List(inner) => format!("list: {}", words(inner)),
        Kind::NonEmpty(inner) => format!("list of at least one: {}", words(inner)),
        Kind::Map(inner) => format!("names with: {}", words(inner)),
        Kind::Object(shape) => format!("object *{}*", shape.name),
        Kind::Either(kinds) => kinds.iter().map(words).collect::<Vec<_>>().join("; or "),
    }
}

/// A rule on which keys may or must occur together, in words.
fn in_words(rule: &Rule) -> String {
    let list = |keys: &[&str], last: &str| {
        let codes: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
        match codes.split_last() {
            Some((end, rest)) if !rest.is_empty() => format!("{} {last} {end}", rest.join(", ")),
            _ => codes.concat(),
        }
    };
    let both = |[needed, refused]: &[&[&str]; 2]| {
        let needs = (!needed.is_empty()).then(|| format!("needs {}", list(needed, "and")));
        let refuses = (!refused.is_empty()).then(|| format!("refuses {}", list(refused, "and")));
        [needs, refuses].into_iter().flatten().collect::<Vec<_>>().join(" and ")
    };
    match rule {
        Rule::Any(keys) => format!("At least one of {} is given.", list(keys, "and")),
        Rule::Needs(key, others) => format!("`{key}` needs {}.", list(others, "or")),
        Rule::Refuses(key, others) => format!("`{key}` stands without {}.", list(others, "and")),
        Rule::When { key, is, then, otherwise } => {
            let otherwise = match both(otherwise) {
                nothing if nothing.is_empty() => String::new(),
                words => format!("; any other {words}"),
            };
            format!("A `{key}` that is {} {}{otherwise}.", words(is), both(then))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::key::{optional, required};

    static INNER: Shape =
        Shape::new("inner", "Inside.", &[required("x_m", Kind::Positive, "m", "Length.")], &[]);
    static OUTER: Shape = Shape::new(
        "outer",
        "Outside.",
        &[
            optional("a", Kind::NonNegative, "kg", "2", "Mass."),
            optional("b", Kind::List(&Kind::Object(&INNER)), "-", "none", "Parts."),
        ],
        &[Rule::Refuses("a", &["b"])],
    );

    #[test]
    fn a_table_becomes_a_schema_with_each_object_once() {
        let file = FileKind { name: "things", about: "A thing.", root: Kind::Object(&OUTER) };
        let schema = file.schema();
        assert_eq!(schema["$ref"], "#/$defs/outer");
        let a = &schema["$defs"]["outer"]["properties"]["a"];
        assert_eq!((&a["default"], &a["description"]), (&json!(2), &json!("Mass. [kg] Default: 2.")));
        assert_eq!(schema["$defs"]["inner"]["required"], json!(["x_m"]));
        assert!(file.tables().contains("| `a` | number >= 0 | kg | `2` | Mass. |"));
        assert!(file.tables().contains("`a` stands without `b`."));
    }
}
