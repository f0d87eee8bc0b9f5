//! Faults and warnings, collected while the catalog files are read.

use crate::input::json::Fault;
use std::cell::RefCell;

/// What was found wrong (`faults`) or odd (`warnings`) so far.
#[derive(Debug, Default)]
pub(crate) struct Log {
    /// Reasons to refuse the file.
    pub faults: RefCell<Vec<Fault>>,
    /// Things to look at.
    pub warnings: RefCell<Vec<Fault>>,
}

impl Log {
    /// Records a reason to refuse a file.
    pub(crate) fn fault(&self, file: &str, line: Option<usize>, field: &str, problem: String, hint: String) {
        self.faults.borrow_mut().push(Fault { file: file.into(), line, field: field.into(), problem, hint });
    }

    /// Records something to look at.
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
