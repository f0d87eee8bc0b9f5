//! JSON documents. A reader finds all faults of a file at once, each with file, line, field, the value and a hint.
//!
//! A [`Document`] is the text of one JSON file. Readers walk it through [`Node`]s. A node never fails: it records a
//! [`Fault`] and returns `None`, so that one pass over a file finds all of its faults. [`Document::finish`] turns the
//! faults into an error.

pub use super::lines::LineCounter;

use super::encoding::{NotUtf8, decode};
use super::key::Shape;
use super::magnitude::{beyond_calculation, not_positive};
use super::names::visible;
use super::path::join;
use serde_json::{Map, Value};
use std::cell::RefCell;
use std::fmt;
use std::path::Path;

/// One fault of an input file.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// File name as the user gave it.
    pub file: String,
    /// Line in the file, counted from 1; `None` if it is unknown.
    pub line: Option<usize>,
    /// Path of the field (`chain[2].section.wall_m`), or name of the column.
    pub field: String,
    /// Description of the fault, with the value that was found.
    pub problem: String,
    /// Hint: what is allowed, or what to try next.
    pub hint: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", visible(&self.file))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if !self.field.is_empty() {
            write!(f, ": {}", visible(&self.field))?;
        }
        write!(f, ": {}", visible(&self.problem))?;
        if !self.hint.is_empty() {
            write!(f, "; {}", self.hint)?;
        }
        Ok(())
    }
}

/// All faults of one or more input files. There is at least one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", list(.0))]
pub struct Faults(pub Vec<Fault>);

fn list(faults: &[Fault]) -> String {
    let mut text = match faults.len() {
        1 => "1 fault in the input:".to_string(),
        n => format!("{n} faults in the input:"),
    };
    for fault in faults {
        text.push_str("\n  ");
        text.push_str(&fault.to_string());
    }
    text
}

/// Reason why an input file could not be used.
#[derive(Debug, thiserror::Error)]
pub enum InputError {
    /// The file could not be opened or read.
    #[error("cannot read {file}: {source}")]
    Unreadable {
        /// File name as the user gave it.
        file: String,
        /// Reason that the operating system gives.
        source: std::io::Error,
    },
    /// The file was read and has faults.
    #[error(transparent)]
    Faulty(#[from] Faults),
}

/// Reads a text file.
///
/// # Errors
/// [`InputError::Unreadable`] if the file cannot be read, [`InputError::Faulty`] if it is not in UTF-8.
pub fn read_text(path: &Path) -> Result<String, InputError> {
    let file = path.display().to_string();
    let unreadable = |source| InputError::Unreadable { file: file.clone(), source };
    let bytes = std::fs::read(path).map_err(|source| unreadable(is_folder(path).unwrap_or(source)))?;
    let in_file = |wrong: NotUtf8| Fault {
        file,
        line: Some(wrong.line),
        field: String::new(),
        problem: wrong.problem,
        hint: wrong.hint.into(),
    };
    Ok(decode(bytes).map_err(|wrong| Faults(vec![in_file(wrong)]))?)
}

/// The error for a path that is a folder, with the JSON files in it; `None` for other paths.
fn is_folder(path: &Path) -> Option<std::io::Error> {
    let entries = std::fs::read_dir(path).ok()?;
    let paths = entries.flatten().map(|entry| entry.path());
    let mut inside: Vec<String> = paths
        .filter(|p| p.extension().is_some_and(|e| e == "json"))
        .map(|p| p.display().to_string())
        .collect();
    inside.sort();
    let hint = match inside.as_slice() {
        [] => "it has no JSON file".into(),
        [one] => format!("give a file, such as {one}"),
        several => format!("give a file; it has {}", several.join(", ")),
    };
    Some(std::io::Error::new(std::io::ErrorKind::IsADirectory, format!("it is a folder; {hint}")))
}

/// The text of one JSON file, its parsed value, and the faults found in it so far.
///
/// ```
/// use armwright::input::Document;
///
/// let document = Document::parse("x.json", "{\"mass_kg\": -5,\n \"lenght_m\": 1}").expect("JSON");
/// let mass_kg = document.root().object(&["mass_kg", "length_m"]).and_then(|o| o.required("mass_kg")?.non_negative());
/// let faults = document.finish(mass_kg).expect_err("two faults").0;
/// assert_eq!(faults.len(), 2);
/// assert!(faults[0].to_string().starts_with("x.json:2: lenght_m: unknown key; did you mean \"length_m\"?"));
/// ```
pub struct Document {
    file: String,
    text: String,
    value: Value,
    faults: RefCell<Vec<Fault>>,
}

impl Document {
    /// Reads a JSON file from disk.
    ///
    /// # Errors
    /// [`InputError::Unreadable`] if the file is missing, [`InputError::Faulty`] if it is not JSON.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let file = path.display().to_string();
        Ok(Self::parse(&file, &read_text(path)?)?)
    }

    /// Parses JSON text. `file` is the name that is used in messages.
    ///
    /// # Errors
    /// [`Faults`] with the line of the first syntax error.
    pub fn parse(file: &str, text: &str) -> Result<Self, Faults> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let value = serde_json::from_str(text).map_err(|e| {
            Faults(vec![Fault {
                file: file.to_string(),
                line: Some(e.line()),
                field: format!("column {}", e.column()),
                problem: format!("not valid JSON: {}", syntax_message(&e)),
                hint: "JSON has no NaN, no comments and no trailing commas".into(),
            }])
        })?;
        let document =
            Self { file: file.to_string(), text: text.to_string(), value, faults: RefCell::default() };
        for path in super::duplicates::duplicate_keys(text) {
            document.fault(&path, "is given more than once".into(), "keep the one that holds");
        }
        for (path, (problem, hint)) in super::texts::unfit_texts(&document.value) {
            document.fault(&path, problem, hint);
        }
        Ok(document)
    }

    /// The whole document as a node.
    pub fn root(&self) -> Node<'_> {
        Node { document: self, value: &self.value, path: String::new() }
    }

    /// The file name that is used in messages.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Records a fault of the field at `path`, which is its place in the document, such as `chain[2].mass_kg`. A fault
    /// that is recorded already is not repeated.
    pub fn fault(&self, path: &str, problem: String, hint: &str) {
        let fault = Fault {
            file: self.file.clone(),
            line: line_of(&self.text, path),
            field: path.to_string(),
            problem,
            hint: hint.to_string(),
        };
        let mut faults = self.faults.borrow_mut();
        // the same field may be read twice, which gives the same fault twice
        if !faults.contains(&fault) {
            faults.push(fault);
        }
    }

    /// The value if no fault was found.
    ///
    /// # Errors
    /// All faults recorded so far. A reader that returns `None` has recorded the reason.
    pub fn finish<T>(self, value: Option<T>) -> Result<T, Faults> {
        let faults = self.faults.into_inner();
        match value {
            Some(value) if faults.is_empty() => Ok(value),
            _ if faults.is_empty() => Err(Faults(vec![Fault {
                file: self.file,
                line: None,
                field: String::new(),
                problem: "the file is incomplete".into(),
                hint: String::new(),
            }])),
            _ => Err(Faults(faults)),
        }
    }
}

fn syntax_message(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.split(" at line").next().unwrap_or(&text).to_string()
}

/// One value inside a [`Document`], with its path.
#[derive(Clone)]
pub struct Node<'a> {
    document: &'a Document,
    value: &'a Value,
    path: String,
}

impl<'a> Node<'a> {
    /// Path of this node, as printed in messages.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The JSON value of this node, unchecked.
    pub fn value(&self) -> &'a Value {
        self.value
    }

    /// Whether the value is JSON `null`.
    pub fn is_null(&self) -> bool {
        self.value.is_null()
    }

    /// Records a fault at this node and returns `None`.
    pub fn fault<T>(&self, problem: impl Into<String>, hint: &str) -> Option<T> {
        self.document.fault(&self.path, problem.into(), hint);
        None
    }

    /// Records a fault at a path below this node and returns `None`.
    pub fn fault_below<T>(&self, path: &str, problem: impl Into<String>, hint: &str) -> Option<T> {
        self.document.fault(&join(&self.path, path), problem.into(), hint);
        None
    }

    /// This node as an object of a given shape. Keys that the shape does not have are recorded as faults. Records a
    /// fault and returns `None` for any other value.
    pub fn shaped(&self, shape: &Shape) -> Option<Object<'a>> {
        self.object(&shape.names())
    }

    /// This node as an object. Keys that are not among `known` are recorded as faults. Objects of files should be read
    /// by [`Node::shaped`], because then their keys are in the schema too. Records a fault and returns `None` for any
    /// other value.
    pub fn object(&self, known: &[&str]) -> Option<Object<'a>> {
        let Value::Object(map) = self.value else {
            return self.fault(format!("is {}, not an object", kind(self.value)), "write { ... }");
        };
        for key in map.keys().filter(|k| !known.contains(&k.as_str())) {
            let hint = match closest(key, known) {
                Some(name) => format!("did you mean \"{name}\"? known keys: {}", known.join(", ")),
                None => format!("known keys: {}", known.join(", ")),
            };
            self.document.fault(&join(&self.path, key), "unknown key".into(), &hint);
        }
        Some(Object { node: self.clone(), map })
    }

    /// This node as an object with any keys: pairs of key and node, in the order of the file. Records a fault and
    /// returns `None` for any other value.
    pub fn entries(&self) -> Option<Vec<(&'a str, Node<'a>)>> {
        let Value::Object(map) = self.value else {
            return self.fault(format!("is {}, not an object", kind(self.value)), "write { ... }");
        };
        Some(map.iter().map(|(k, v)| (k.as_str(), self.child(&join(&self.path, k), v))).collect())
    }

    /// This node as an array of nodes. Records a fault and returns `None` for any other value.
    pub fn array(&self) -> Option<Vec<Node<'a>>> {
        let Value::Array(items) = self.value else {
            return self.fault(format!("is {}, not an array", kind(self.value)), "write [ ... ]");
        };
        Some(items.iter().enumerate().map(|(i, v)| self.child(&format!("{}[{i}]", self.path), v)).collect())
    }

    /// This node as a string. Records a fault and returns `None` for any other value.
    pub fn string(&self) -> Option<&'a str> {
        match self.value {
            Value::String(s) => Some(s),
            other => self.fault(format!("is {}, not a string", kind(other)), "write \"...\""),
        }
    }

    /// This node as `true` or `false`. Records a fault and returns `None` for any other value.
    pub fn boolean(&self) -> Option<bool> {
        match self.value {
            Value::Bool(b) => Some(*b),
            other => self.fault(format!("is {}", kind(other)), "write true or false"),
        }
    }

    /// This node as a number that can be calculated with: finite, and of a magnitude up to 1e30. Records a fault and
    /// returns `None` for any other value.
    pub fn number(&self) -> Option<f64> {
        match self.value.as_f64() {
            Some(x) => match beyond_calculation(x) {
                None => Some(x),
                Some((problem, hint)) => self.fault(problem, hint),
            },
            None => self.fault(format!("is {}, not a number", kind(self.value)), "give a number in SI units"),
        }
    }

    /// This node as a number greater than zero. Records a fault and returns `None` for any other value.
    pub fn positive(&self) -> Option<f64> {
        let x = self.number()?;
        match not_positive(x) {
            None => Some(x),
            Some((problem, hint)) => self.fault(problem, hint),
        }
    }

    /// This node as a number that is not negative. Records a fault and returns `None` for any other value.
    pub fn non_negative(&self) -> Option<f64> {
        match self.number()? {
            x if x >= 0.0 => Some(x),
            x => self.fault(format!("= {x} must not be negative"), "check the sign"),
        }
    }

    /// This node as an array of `N` finite numbers. Records a fault and returns `None` for any other value.
    pub fn numbers<const N: usize>(&self) -> Option<[f64; N]> {
        let items = self.array()?;
        if items.len() != N {
            return self.fault(format!("has {} numbers, not {N}", items.len()), &format!("give {N} numbers"));
        }
        let mut out = [0.0; N];
        let mut complete = true;
        for (slot, item) in out.iter_mut().zip(&items) {
            match item.number() {
                Some(x) => *slot = x,
                None => complete = false,
            }
        }
        complete.then_some(out)
    }

    fn child(&self, path: &str, value: &'a Value) -> Node<'a> {
        Node { document: self.document, value, path: path.to_string() }
    }
}

/// A JSON object inside a [`Document`].
pub struct Object<'a> {
    node: Node<'a>,
    map: &'a Map<String, Value>,
}

impl<'a> Object<'a> {
    /// The node of the object itself.
    pub fn node(&self) -> &Node<'a> {
        &self.node
    }

    /// Whether the object has the key, with any value, `null` included.
    pub fn has(&self, key: &str) -> bool {
        self.map.contains_key(key)
    }

    /// The node under `key`; `None` if the object does not have the key.
    pub fn optional(&self, key: &str) -> Option<Node<'a>> {
        self.map.get(key).map(|v| self.node.child(&join(&self.node.path, key), v))
    }

    /// The node under `key`. If the object does not have the key, this is recorded as a fault and the result is `None`.
    pub fn required(&self, key: &str) -> Option<Node<'a>> {
        self.optional(key).or_else(|| {
            self.node.document.fault(
                &self.node.path,
                format!("lacks \"{key}\""),
                &format!("add \"{key}\": ..."),
            );
            None
        })
    }

    /// The value under `key`, converted by `read`, or `default` if the object has no such key. `None` means that
    /// the value is faulty.
    pub fn or<T>(&self, key: &str, default: T, read: impl FnOnce(&Node<'a>) -> Option<T>) -> Option<T> {
        match self.optional(key) {
            Some(node) => read(&node),
            None => Some(default),
        }
    }
}

/// Description of a JSON value for messages, with the value itself if it is short.
fn kind(value: &Value) -> String {
    match value {
        Value::Null => "null".into(),
        Value::Bool(b) => format!("{b}"),
        Value::Number(n) => format!("the number {n}"),
        Value::String(s) => format!("the text \"{s}\""),
        Value::Array(a) => format!("an array of {}", a.len()),
        Value::Object(_) => "an object".into(),
    }
}

/// The known name that is most similar to `word`. `None` if none is so similar that `word` may be a
/// misspelling of it.
pub fn closest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    known
        .iter()
        .map(|k| (edit_distance(&word.to_lowercase(), &k.to_lowercase()), *k))
        .min()
        .filter(|(d, k)| *d <= 2.max(k.len() / 3) && *d < word.len())
        .map(|(_, k)| k)
}

/// Levenshtein distance between two words: the least number of bytes to insert, remove or replace.
fn edit_distance(a: &str, b: &str) -> usize {
    let b = b.as_bytes();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.bytes().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let cost = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = cost.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// Line, counted from 1, at which the value at `path` stands in a valid JSON text; `None` if there is no such value.
fn line_of(text: &str, path: &str) -> Option<usize> {
    let offset = Locator { bytes: text.as_bytes(), at: 0 }.find(&segments(path))?;
    Some(1 + text.as_bytes()[..offset].iter().filter(|&&b| b == b'\n').count())
}

/// Whether a JSON string, which may contain escapes, is equal to this key.
fn is_key(quoted: &[u8], wanted: &str) -> bool {
    match quoted.contains(&b'\\') {
        true => serde_json::from_slice::<String>(quoted).is_ok_and(|key| key == wanted),
        false => {
            quoted.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\"")) == Some(wanted.as_bytes())
        }
    }
}

enum Segment<'a> {
    Key(&'a str),
    Index(usize),
}

fn segments(path: &str) -> Vec<Segment<'_>> {
    let mut out = Vec::new();
    for part in path.split('.').filter(|p| !p.is_empty()) {
        let mut pieces = part.split('[');
        if let Some(key) = pieces.next().filter(|k| !k.is_empty()) {
            out.push(Segment::Key(key));
        }
        out.extend(pieces.filter_map(|p| p.trim_end_matches(']').parse().ok()).map(Segment::Index));
    }
    out
}

/// Finds the position of the value at a path in JSON text.
struct Locator<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Locator<'_> {
    fn find(mut self, path: &[Segment]) -> Option<usize> {
        for segment in path {
            self.space();
            let open = *self.bytes.get(self.at)?;
            self.at += 1;
            let mut index = 0;
            loop {
                self.space();
                match (segment, open) {
                    (Segment::Key(wanted), b'{') => {
                        let start = self.at;
                        self.skip();
                        let found = is_key(self.bytes.get(start..self.at)?, wanted);
                        self.space();
                        self.at += 1;
                        self.space();
                        if found {
                            break;
                        }
                    }
                    (Segment::Index(wanted), b'[') if index == *wanted => break,
                    (Segment::Index(_), b'[') => index += 1,
                    _ => return None,
                }
                self.skip();
                self.space();
                if *self.bytes.get(self.at)? != b',' {
                    return None;
                }
                self.at += 1;
            }
        }
        self.space();
        Some(self.at)
    }

    fn space(&mut self) {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    /// Moves the position past one JSON value.
    fn skip(&mut self) {
        let mut depth = 0usize;
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b'"' => {
                    self.at += 1;
                    while self.bytes.get(self.at).is_some_and(|&b| b != b'"') {
                        self.at += if self.bytes[self.at] == b'\\' { 2 } else { 1 };
                    }
                }
                b'{' | b'[' => depth += 1,
                b'}' | b']' if depth == 0 => return,
                b'}' | b']' => depth -= 1,
                b',' | b':' if depth == 0 => return,
                _ => {}
            }
            self.at += 1;
            if depth == 0 && matches!(byte, b'"' | b'}' | b']') {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "{\n \"a\": [1,\n  {\"b\": \"x\\\"}\",\n   \"c\": -2}],\n \"d\": true\n}";

    #[test]
    fn a_fault_names_the_line_of_its_field() {
        assert_eq!(line_of(TEXT, "a[1].c"), Some(4));
        assert_eq!(line_of(TEXT, "d"), Some(5));
        assert_eq!(line_of(TEXT, "a[0]"), Some(2));
        assert_eq!(line_of(TEXT, "a[2]"), None);
    }

    #[test]
    fn a_key_given_twice_is_a_fault_whoever_reads_the_document() {
        let doc = Document::parse("x.json", "{\"a\": 1,\n \"b\": {\"c\": 1, \"c\": 2}}").expect("valid");
        let faults = doc.finish(Some(())).expect_err("one fault").0;
        assert_eq!(faults[0].to_string(), "x.json:2: b.c: is given more than once; keep the one that holds");
    }

    #[test]
    fn all_faults_are_reported_at_once() {
        let doc = Document::parse("x.json", TEXT).expect("valid");
        let root = doc.root();
        let object = root.object(&["a", "e"]).expect("object");
        object.required("e");
        object.optional("a").expect("there").array().expect("array")[0].string();
        let faults = doc.finish(Some(())).expect_err("three faults").0;
        assert_eq!(faults.len(), 3);
        assert_eq!(faults[0].to_string(), "x.json:5: d: unknown key; known keys: a, e");
    }
}
