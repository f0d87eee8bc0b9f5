//! What the records say about one joint. Each effect is found, absent, not identified, or refused.

use crate::reconcile::model::estimate::Estimate;
use serde_json::{Map, Value, json};

/// Whether an effect was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Held-out blocks are predicted better with the effect, and the interval of its size excludes zero.
    Found,
    /// The effect was looked for, and held-out blocks are not predicted better with it.
    Absent,
    /// The record cannot tell: the excitation is too small, or another cause gives the same signal.
    NotIdentified,
    /// The best value is physically impossible, such as a hysteresis that leads the torque.
    Refused,
}

impl State {
    /// Word for the state in `verdict.json`.
    pub fn word(self) -> &'static str {
        match self {
            State::Found => "found",
            State::Absent => "absent",
            State::NotIdentified => "not_identified",
            State::Refused => "refused",
        }
    }
}

/// One effect that was looked for at one joint, with the result.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Name of the effect: `time_shift`, `compliance`, `hysteresis` ...
    pub what: &'static str,
    /// Whether the effect was found.
    pub state: State,
    /// Parameters of the effect by name, each with its interval; empty if none is worth printing.
    pub parameters: Vec<(String, Vec<Estimate>)>,
    /// Reason if the effect was not found; otherwise a limitation of the finding. May be empty.
    pub words: String,
}

impl Stated {
    /// The result for an effect with a single parameter, which has the name `name`.
    pub(crate) fn one(what: &'static str, state: State, name: &str, value: Estimate, words: &str) -> Self {
        let parameters = vec![(name.to_string(), vec![value])];
        Self { what, state, parameters, words: words.into() }
    }

    /// The result for an effect without parameters.
    pub(crate) fn none(what: &'static str, state: State, words: impl Into<String>) -> Self {
        Self { what, state, parameters: Vec::new(), words: words.into() }
    }

    /// The entry of the effect in `verdict.json`.
    fn json(&self) -> Value {
        let parameters: Map<String, Value> = self
            .parameters
            .iter()
            .map(|(name, list)| match list.as_slice() {
                [one] => (name.clone(), one.json()),
                many => {
                    let part = |f: fn(&Estimate) -> Option<f64>| many.iter().map(f).collect::<Vec<_>>();
                    let value = json!({"value": part(|e| Some(e.value)), "low": part(|e| e.low), "high": part(|e| e.high)});
                    (name.clone(), value)
                }
            })
            .collect();
        json!({"what": self.what, "state": self.state.word(), "parameters": parameters, "words": self.words})
    }
}

/// One step of the fit of the twist (the angle of the motor less that of the link): what was added to the model, and
/// the error on held-out blocks with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// What was added to the model.
    pub added: String,
    /// Root mean square error of the twist on held-out blocks after the addition \[rad\].
    pub held_out_rad: f64,
}

/// Twist and torque of one row of the records, for the picture of the joint. Only every n-th row is kept.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Traced {
    /// Torque of the spring if a torsion law was found, otherwise of the motor, at the output \[N m\].
    pub torque_nm: f64,
    /// Recorded twist (the motor's angle less the link's), without the constant offset of the record \[rad\].
    pub before_rad: f64,
    /// Recorded twist without time shift, offset and transmission error: the deflection of the spring with its friction
    /// loop \[rad\].
    pub after_rad: f64,
    /// Deflection of the spring according to the model \[rad\].
    pub model_rad: f64,
}

/// What all records together say about one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRecord {
    /// Name of the joint.
    pub joint: String,
    /// Whether the campaign states the inertia of the joint's rotor.
    pub rotor_is_stated: bool,
    /// Number of rows that enter the fit.
    pub rows: usize,
    /// Number of independent readings that have as much information as these rows. It is smaller than `rows` because
    /// errors are autocorrelated.
    pub effective_rows: f64,
    /// Number of blocks of time that were held out in turn.
    pub blocks: usize,
    /// Largest minus smallest angle of the joint in the records \[rad\].
    pub range_rad: f64,
    /// Standard deviation of the noise of the twist from row to row \[rad\].
    pub noise_rad: f64,
    /// Standard deviation of the noise that the average over neighbouring rows leaves in the twist \[rad\]. The error
    /// fields below refer to such averages.
    pub(crate) averaged_noise_rad: f64,
    /// Root mean square error of the twist on held-out blocks with an offset alone as model \[rad\].
    pub before_rad: f64,
    /// Root mean square error of the twist on held-out blocks with an offset as model, and with the time shift too if
    /// one was found \[rad\].
    pub(crate) unshifted_rad: f64,
    /// Root mean square error of the twist on held-out blocks with everything that was found \[rad\].
    pub after_rad: f64,
    /// All effects that were looked for, found or not.
    pub stated: Vec<Stated>,
    /// Error of the twist on held-out blocks after each step of the fit, in the order of the steps.
    pub steps: Vec<Step>,
    /// Twist against torque, thinned for the picture.
    pub trace: Vec<Traced>,
    /// A sentence on a cause that explains the records better than a transmission error of the output and is no effect
    /// of the library; `None` if there is none.
    pub(crate) unnamed: Option<String>,
    /// What the records leave open, such as a transmission error that they cannot tell from the twist by gravity. The
    /// data are then insufficient.
    pub undecided: Vec<String>,
    /// Further sentences for the reader, such as a law that explains the record as well.
    pub remarks: Vec<String>,
}

impl JointRecord {
    /// Result for the effect with the name `what`; `None` if it was not looked for.
    pub fn of(&self, what: &str) -> Option<&Stated> {
        self.stated.iter().find(|s| s.what == what)
    }

    /// Result for the effect with the name `what`; `None` if it was not found.
    pub fn found(&self, what: &str) -> Option<&Stated> {
        self.of(what).filter(|s| s.state == State::Found)
    }

    /// The entry of the joint in `verdict.json`.
    pub(crate) fn json(&self) -> Value {
        json!({
            "joint": self.joint, "rows": self.rows, "effective_rows": self.effective_rows,
            "blocks": self.blocks, "range_deg": self.range_rad.to_degrees(), "noise_rad": self.noise_rad,
            "rms_rad_before": self.before_rad, "kept_out_rms_rad_after": self.after_rad,
            "findings": self.stated.iter().map(Stated::json).collect::<Vec<_>>(),
            "steps": self.steps.iter().map(|s| json!({
                "added": s.added, "kept_out_rms_rad": s.held_out_rad,
            })).collect::<Vec<_>>(),
            "remarks": self.remarks,
        })
    }
}
