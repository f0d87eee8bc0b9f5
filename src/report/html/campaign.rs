//! The values from which the page of a campaign is made. `campaign_page` makes the page.

use super::positions::{Position, Step};
use crate::arm::pose::DrivenJoint;
use crate::report::section::PageSection;

/// Root mean square of the residuals (measured less predicted) of a group of readings, before and after \[standard
/// deviations\]. "Before" means the calibrated model as given, "after" this model with the effects that were found.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// Words that name the group of readings, such as a channel or a pose.
    pub part: String,
    /// Number of measured values.
    pub count: usize,
    /// Root mean square of the residuals with the model as given, after calibration \[standard deviations\].
    pub before: f64,
    /// Root mean square of the residuals with the effects that were found \[standard deviations\].
    pub after: f64,
}

/// One measured value with its residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Channel of the reading: `static`, `modal`, `windup`.
    pub channel: &'static str,
    /// Row in the file of the channel, counted from 1.
    pub row: usize,
    /// Measured quantity: `dx_mm`, `frequency_hz` ...
    pub quantity: &'static str,
    /// Joint angles \[deg\]; `None` for a reading on a bench.
    pub pose_deg: Option<Vec<f64>>,
    /// Measured less predicted value, by the model as given \[standard deviations\].
    pub before_sigma: f64,
    /// Measured less predicted value, with the effects found \[standard deviations\].
    pub after_sigma: f64,
    /// Measured less predicted value, with the effects found and parameters fitted without this pose (held out)
    /// \[standard deviations\]; `None` if it was not predicted.
    pub kept_out_sigma: Option<f64>,
    /// Whether the reading was excluded as a gross error.
    pub gross: bool,
}

/// A value with its 95 % interval. An end that the readings do not bound is `None`.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranged {
    /// Name of the quantity, with the unit in it.
    pub name: String,
    /// Best value of the quantity.
    pub value: f64,
    /// Lower end of the 95 % interval; `None` if the readings do not bound it.
    pub low: Option<f64>,
    /// Upper end of the 95 % interval; `None` if the readings do not bound it.
    pub high: Option<f64>,
}

/// An effect that was found, or is suspected.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Name of the effect and its place: `effect@place`.
    pub label: String,
    /// Parameters of the effect, with intervals.
    pub parameters: Vec<Ranged>,
    /// Effects that the readings of the campaign cannot distinguish from this effect.
    pub like: Vec<String>,
}

/// A model for which the evidence was computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Weighed {
    /// Names of the model's effects, or `calibration only`.
    pub model: String,
    /// Score of the model: logarithm of its evidence, less the logarithm of the evidence of the best model.
    pub score: f64,
    /// Sum of the squared residuals \[standard deviations squared\].
    pub chi_squared: f64,
}

/// A recommended test.
#[derive(Debug, Clone, PartialEq)]
pub struct Test {
    /// Description of the test.
    pub words: String,
    /// The models that the test distinguishes.
    pub separates: Vec<String>,
    /// Expected difference between the models in `separates` \[standard deviations\].
    pub expected_sigmas: f64,
    /// Number of readings after which one model can be ruled out.
    pub readings_needed: usize,
}

/// All contents of a campaign's page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CampaignPage {
    /// Name of the campaign.
    pub name: String,
    /// The verdict in a sentence.
    pub sentence: String,
    /// Reasons for the verdict, one sentence each.
    pub reasons: Vec<String>,
    /// Whether the effects in `found` explain the difference between model and readings. Otherwise these effects are
    /// only suspected.
    pub explained: bool,
    /// The driven joints, base to tip.
    pub joints: Vec<DrivenJoint>,
    /// Root mean squares of the residuals \[declared standard deviations\], with calibration alone and with the effects,
    /// for each part of the readings: by channel, branch, load, mode and joint of a bench, by point of absolute
    /// positions, and for the poses with the largest errors. Gross errors are left out.
    pub parts: Vec<Compared>,
    /// All measured values.
    pub readings: Vec<Reading>,
    /// Absolute positions: position error at each stage of the model.
    pub steps: Vec<Step>,
    /// Position error of every absolute position.
    pub positions: Vec<Position>,
    /// Effects that were found or are suspected.
    pub found: Vec<Found>,
    /// Models that were compared, best first.
    pub weighed: Vec<Weighed>,
    /// Calibrated factors on nominal values.
    pub calibrated: Vec<Ranged>,
    /// Held-out readings: their number, and the root mean square of their residuals before and after the effects were
    /// added \[standard deviations\]. `None` if no readings were held out.
    pub kept_out: Option<(usize, f64, f64)>,
    /// Gross errors and wrongly declared standard deviations, in words.
    pub quality: Vec<String>,
    /// Recommended tests, best first.
    pub tests: Vec<Test>,
    /// Results of the records against time, one section per joint.
    pub records: Vec<PageSection>,
    /// The models that the corrected arm could have, if no effect explains the difference; `None` if there are none.
    pub corrected_models: Option<PageSection>,
    /// How the optimum of the study changes with the corrected arm; `None` if no study was run again.
    pub optimum: Option<PageSection>,
    /// Further facts: pairs of name and value.
    pub facts: Vec<(String, String)>,
}
