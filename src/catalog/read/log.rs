//! Faults and warnings, collected while the catalog files are read.

use crate::input::json::Fault;
use std::cell::RefCell;

/// The faults and warnings that were found so far.
#[derive(Debug, Default)]
pub(crate) struct Log {
    /// Faults, for which the file is refused.
    pub faults: RefCell<Vec<Fault>>,
    /// Warnings about unusual entries.
    pub warnings: RefCell<Vec<Fault>>,
}

impl Log {
    /// Records a fault, for which the file is refused.
    pub(crate) fn fault(&self, file: &str, line: Option<usize>, field: &str, problem: String, hint: String) {
        self.faults.borrow_mut().push(Fault { file: file.into(), line, field: field.into(), problem, hint });
    }

    /// Records a warning about an unusual entry.
    pub(crate) fn warn(&self, file: &str, line: Option<usize>, field: &str, problem: String, hint: String) {
        self.warnings.borrow_mut().push(Fault {
            file: file.into(),
            line,
            field: field.into(),
            problem,
            hint,
        });
    }
}
