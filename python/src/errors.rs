//! Why there is no answer, as the exceptions of `armwright.errors`.

use armwright::input::{Fault, Faults, InputError};
use armwright::study::Refusal;
use pyo3::prelude::*;

/// A fault as Python gets it: file, line, field, message, hint.
type FaultRow = (String, Option<usize>, String, String, String);

fn row(fault: Fault) -> FaultRow {
    (fault.file, fault.line, fault.field, fault.problem, fault.hint)
}

/// An exception of `armwright.errors`; what prevents it from being made is raised instead.
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

fn faulty(class: &str, faults: Faults) -> PyErr {
    let message = faults.to_string();
    exception(class, message, Some(faults.0.into_iter().map(row).collect()))
}

/// What messages call options and verbs of the program, and what a call has in their place.
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

/// A message of the program in the words of a call.
fn in_python(words: impl ToString) -> String {
    IN_PYTHON.iter().fold(words.to_string(), |words, (theirs, ours)| words.replace(theirs, ours))
}

/// The words or options of a call are wrong.
pub(crate) fn usage(words: impl ToString) -> PyErr {
    exception("UsageError", in_python(words), None)
}

/// An input file is faulty or cannot be read.
pub(crate) fn input(error: InputError) -> PyErr {
    match error {
        InputError::Faulty(faults) => faulty("InputError", faults),
        unreadable @ InputError::Unreadable { .. } => file(unreadable),
    }
}

/// An input is faulty.
pub(crate) fn faults(faults: Faults) -> PyErr {
    faulty("InputError", faults)
}

/// A catalog is faulty or cannot be read.
pub(crate) fn catalog_fault(error: InputError) -> PyErr {
    match error {
        InputError::Faulty(faults) => faulty("CatalogError", faults),
        unreadable @ InputError::Unreadable { .. } => file(unreadable),
    }
}

/// A file cannot be read or written.
pub(crate) fn file(error: impl ToString) -> PyErr {
    exception("FileError", error.to_string(), None)
}

/// A time limit came before anything was found.
pub(crate) fn out_of_time(words: String) -> PyErr {
    exception("OutOfTimeError", words, None)
}

/// A question about a study has no answer.
pub(crate) fn refused(refusal: Refusal) -> PyErr {
    match refusal {
        Refusal::Unknown(words) => usage(words),
        Refusal::Unreadable(words) => file(words),
        Refusal::Faulty(all) => faults(all),
        Refusal::EmptySpace(words) => exception("EmptySpaceError", in_python(words), None),
        Refusal::Infeasible(words) => exception("InfeasibleError", in_python(words), None),
    }
}
