//! Named questions: read, resolve, run.

pub(crate) mod alternatives;
pub(crate) mod ballast;
pub(crate) mod bounds;
pub(crate) mod budget;
pub(crate) mod check;
pub(crate) mod definition;
pub(crate) mod diagnose;
pub(crate) mod effects;
pub(crate) mod motion;
pub(crate) mod named;
pub(crate) mod near;
pub(crate) mod outcome;
pub(crate) mod page;
pub mod question;
pub(crate) mod read;
pub(crate) mod sections;
pub(crate) mod table;
pub(crate) mod ties;
pub(crate) mod tolerance;

pub use ballast::{BallastFlags, ballast_flags};
pub use budget::budgets;
pub use check::{Claim, Completeness, FrontCheck, check_front};
pub use definition::Study;
pub use diagnose::{empty_pieces, why_infeasible};
pub use effects::{CorrectedStudy, Correction, apply_corrections, left_out};
pub use named::{NAMED, list, named, names};
pub use near::{NearFront, near_front};
pub use outcome::{ExactStudy, Extent, Front, Judged, OfMaterial, StudyOutcome, run_exact, run_study};
pub use page::study_page;
pub use read::read_study;
pub use table::{front_table, slug};
pub use ties::{Ties, ties};
pub use tolerance::{Sampling, Tolerance, part, scatter_front};
