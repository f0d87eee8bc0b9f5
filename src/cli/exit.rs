//! How the program ends: all exit codes with their meanings, and the answer of a verb.

/// How the program ends. Each case in which a calling script may want to react differently has its own exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// The task is done.
    Done,
    /// An internal error, which should not happen.
    Internal,
    /// The command line is wrong.
    Usage,
    /// An input file has faults.
    Input,
    /// A catalog has faults.
    Catalog,
    /// The design space has no designs.
    EmptySpace,
    /// No design meets the limits.
    Infeasible,
    /// A file cannot be read or written.
    File,
    /// The user stopped the run, whether or not results were written before.
    Interrupted,
    /// A check failed: a result is wrong, or two results differ.
    CheckFailed,
    /// A time limit ended the run before the result was proved.
    Partial,
    /// A check could not decide whether the result is right.
    Unsettled,
    /// Another process is writing the folder of results.
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

    /// The exit code with which the process ends, and its meaning in a few words.
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

    /// The exit code of the process.
    pub const fn code(self) -> u8 {
        self.row().0
    }

    /// A list of all exit codes with their meanings, for the help text.
    pub(super) fn help() -> String {
        let rows = Self::ALL.map(|exit| format!("{} {}", exit.row().0, exit.row().1));
        format!("Exit codes: {}.\n\nStart with: armwright run compare-materials", rows.join("; "))
    }
}

/// The answer of a verb: the text to print, and how the verb ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Text for standard output.
    pub text: String,
    /// How the verb ended.
    pub exit: Exit,
}

impl From<String> for Answer {
    fn from(text: String) -> Self {
        Self { text, exit: Exit::Done }
    }
}
