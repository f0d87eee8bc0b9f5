//! Named questions: read, resolve, run.

pub(crate) mod alternatives;
pub(crate) mod ballast;
pub(crate) mod bearing_remarks;
pub(crate) mod bodies;
pub(crate) mod bounds;
pub(crate) mod budget;
pub(crate) mod arm_capacity;
pub(crate) mod capacity;
pub(crate) mod cases;
pub(crate) mod check;
mod connections;
pub(crate) mod creep;
pub(crate) mod definition;
pub(crate) mod diagnose;
mod drives;
pub(crate) mod effects;
mod fit;
mod harness;
pub(crate) mod joint_obstacle;
mod limit;
mod linkages;
pub(crate) mod motion;
mod motor_kinds;
pub(crate) mod named;
pub(crate) mod near;
pub(crate) mod omissions;
pub(crate) mod outcome;
pub(crate) mod page;
pub(crate) mod pick_poses;
pub(crate) mod pose_search;
pub mod question;
pub(crate) mod range;
pub(crate) mod read;
mod relaxed_limits;
pub(crate) mod same_drives;
pub(crate) mod search_cost;
pub(crate) mod sections;
pub(crate) mod shards;
pub(crate) mod table;
pub(crate) mod ties;
pub(crate) mod tolerance;
pub(crate) mod worst_pose;

pub use ballast::{BallastFlags, ballast_flags};
pub use budget::budgets;
pub use check::{Claim, Completeness, FrontCheck, check_front};
pub use definition::Study;
pub use diagnose::{empty_pieces, why_infeasible};
pub use effects::{CorrectedStudy, Correction, apply_corrections, left_out};
pub use named::{NAMED, list, named, names};
pub use near::{NearFront, near_front};
pub use outcome::{
    ExactStudy, Extent, Front, Judged, OfMaterial, StudyOutcome, judge_swept, run_exact, run_study,
    sweep_shard,
};
pub use page::study_page;
pub use pick_poses::{PicksInPoses, picks_in_poses};
pub use read::read_study;
pub use same_drives::{PicksOnSameDrives, picks_on_same_drives};
pub use shards::{Swept, candidates_csv, gaps, joined, read_candidates};
pub use table::front_table;
pub use ties::{Ties, ties};
pub use tolerance::{Sampling, Tolerance, part, scatter_front};
pub use worst_pose::{WorstPose, WorstPoses, worst_poses};
