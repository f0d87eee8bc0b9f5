//! Turns the errors of the library into exceptions of the Python module `armwright.errors`.

use armwright::input::{Fault, Faults, InputError};
use armwright::study::Refusal;
use pyo3::prelude::*;

/// A fault of an input file as Python gets it: file, line, field, problem, hint. The line is `None` if the fault is not
/// in one line.
type FaultRow = (String, Option<usize>, String, String, String);

fn row(fault: Fault) -> FaultRow {
    (fault.file, fault.line, fault.field, fault.problem, fault.hint)
}

/// Creates an exception of the class with the name `class` in `armwright.errors`. If this fails, the result is the
/// exception that explains the failure.
fn exception(class: &str, message: String, faults: Option<Vec<FaultRow>>) -> PyErr {
    Python::attach(|py| {
        let made = py.import("armwright.errors").and_then(|module| {
            let class = module.getattr(class)?;
            match faults {
                Some(faults) => class.call1((message, faults)),
                None => class.call1((message,)),
            }
        });
        made.map_or_else(|error| error, PyErr::from_value)
    })
}

/// An exception of the class with the name `class` that lists all faults.
fn faulty(class: &str, faults: Faults) -> PyErr {
    let message = faults.to_string();
    exception(class, message, Some(faults.0.into_iter().map(row).collect()))
}

/// Words of the messages of the command line (options and verbs), each with the word that a Python call has in its
/// place.
const IN_PYTHON: [(&str, &str); 8] = [
    ("--search exact", "search=\"exact\""),
    ("--search", "search"),
    ("--time-limit", "time_limit_s"),
    ("--gap", "gap_percent"),
    ("--design", "design"),
    ("--limits FILE", "limits"),
    ("--cases FILE", "cases"),
    ("`armwright run` has it, no other verb", "armwright.paper has it"),
];

/// Replaces the options and verbs of the command line in a message by the arguments and functions of Python.
fn in_python(words: impl ToString) -> String {
    IN_PYTHON.iter().fold(words.to_string(), |words, (theirs, ours)| words.replace(theirs, ours))
}

/// `UsageError`: an argument of the call is wrong.
pub(crate) fn usage(words: impl ToString) -> PyErr {
    exception("UsageError", in_python(words), None)
}

/// `InputError` for an input file with faults, `FileError` for one that cannot be read.
pub(crate) fn input(error: InputError) -> PyErr {
    match error {
        InputError::Faulty(faults) => faulty("InputError", faults),
        unreadable @ InputError::Unreadable { .. } => file(unreadable),
    }
}

/// `InputError`: an input has these faults.
pub(crate) fn faults(faults: Faults) -> PyErr {
    faulty("InputError", faults)
}

/// `CatalogError` for a catalog with faults, `FileError` for one that cannot be read.
pub(crate) fn catalog_fault(error: InputError) -> PyErr {
    match error {
        InputError::Faulty(faults) => faulty("CatalogError", faults),
        unreadable @ InputError::Unreadable { .. } => file(unreadable),
    }
}

/// `FileError`: a file cannot be read or written.
pub(crate) fn file(error: impl ToString) -> PyErr {
    exception("FileError", error.to_string(), None)
}

/// `OutOfTimeError`: the time limit ended the search before a design was found.
pub(crate) fn out_of_time(words: String) -> PyErr {
    exception("OutOfTimeError", words, None)
}

/// The exception for a question about a study that has no answer. Its class depends on the reason, for example
/// `InfeasibleError` if no design meets the limits.
pub(crate) fn refused(refusal: Refusal) -> PyErr {
    match refusal {
        Refusal::Unknown(words) => usage(words),
        Refusal::Unreadable(words) => file(words),
        Refusal::Faulty(all) => faults(all),
        Refusal::EmptySpace(words) => exception("EmptySpaceError", in_python(words), None),
        Refusal::Infeasible(words) => exception("InfeasibleError", in_python(words), None),
    }
}
