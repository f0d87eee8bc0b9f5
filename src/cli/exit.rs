//! How the program ends: every exit code, what it means, and the answer of a verb that has one.

/// The end of a run. A caller that would do something else in another case gets another code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// What was asked for is done.
    Done,
    /// Something that should not happen.
    Internal,
    /// A word on the command line that is not known.
    Usage,
    /// An input file is wrong.
    Input,
    /// A catalog is wrong.
    Catalog,
    /// There is nothing to choose from.
    EmptySpace,
    /// No design meets what is asked.
    Infeasible,
    /// A file cannot be read or written.
    File,
    /// The user stopped the run, whatever was kept.
    Interrupted,
    /// A check found a difference.
    CheckFailed,
    /// A time limit came before what was asked for was proved.
    Partial,
    /// A check settled nothing.
    Unsettled,
    /// Another process is writing the results.
    Locked,
}

impl Exit {
    const ALL: [Self; 13] = [
        Self::Done,
        Self::Internal,
        Self::Usage,
        Self::Input,
        Self::Catalog,
        Self::EmptySpace,
        Self::Infeasible,
        Self::File,
        Self::Interrupted,
        Self::CheckFailed,
        Self::Partial,
        Self::Unsettled,
        Self::Locked,
    ];

    /// The process exit code, and its meaning in a few words.
    const fn row(self) -> (u8, &'static str) {
        match self {
            Self::Done => (0, "done"),
            Self::Internal => (1, "internal error"),
            Self::Usage => (2, "wrong usage"),
            Self::Input => (3, "faulty input file"),
            Self::Catalog => (4, "faulty catalog"),
            Self::EmptySpace => (5, "empty design space"),
            Self::Infeasible => (6, "infeasible"),
            Self::File => (7, "file cannot be read or written"),
            Self::Interrupted => (8, "interrupted, whatever was kept"),
            Self::CheckFailed => (9, "a check failed"),
            Self::Partial => (10, "partial: a time limit came before what was asked for was proved"),
            Self::Unsettled => (11, "a check settled nothing"),
            Self::Locked => (12, "the results are being written by another process"),
        }
    }

    /// The process exit code.
    pub const fn code(self) -> u8 {
        self.row().0
    }

    /// Every code with its meaning, for the help.
    pub(super) fn help() -> String {
        let rows = Self::ALL.map(|exit| format!("{} {}", exit.row().0, exit.row().1));
        format!("Exit codes: {}.\n\nStart with: armwright run compare-materials", rows.join("; "))
    }
}

/// The answer of a verb: the text that it prints, and how it ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// For standard output.
    pub text: String,
    /// How the verb ended.
    pub exit: Exit,
}

impl From<String> for Answer {
    fn from(text: String) -> Self {
        Self { text, exit: Exit::Done }
    }
}
