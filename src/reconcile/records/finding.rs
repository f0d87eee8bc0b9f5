//! What a record says about one joint, each thing found, absent, not identified, or refused.

use crate::reconcile::model::estimate::Estimate;
use serde_json::{Map, Value, json};

/// Whether something was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Held-out blocks are predicted better with it, and its interval excludes zero.
    Found,
    /// It was looked for, and held-out blocks are not predicted better with it.
    Absent,
    /// The record cannot tell: too little excitation, or another cause does the same.
    NotIdentified,
    /// The best value is physically impossible, such as a hysteresis that leads.
    Refused,
}

impl State {
    /// The word in `verdict.json`.
    pub fn word(self) -> &'static str {
        match self {
            State::Found => "found",
            State::Absent => "absent",
            State::NotIdentified => "not_identified",
            State::Refused => "refused",
        }
    }
}

/// One thing that was looked for at one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// What: `time_shift`, `compliance`, `hysteresis` ...
    pub what: &'static str,
    /// Whether it was found.
    pub state: State,
    /// Its numbers with intervals; present where they are worth printing.
    pub parameters: Vec<(String, Vec<Estimate>)>,
    /// Why, where it is not found, or what limits the finding.
    pub words: String,
}

impl Stated {
    /// Something with one number.
    pub(crate) fn one(what: &'static str, state: State, name: &str, value: Estimate, words: &str) -> Self {
        let parameters = vec![(name.to_string(), vec![value])];
        Self { what, state, parameters, words: words.into() }
    }

    /// Something without numbers.
    pub(crate) fn none(what: &'static str, state: State, words: impl Into<String>) -> Self {
        Self { what, state, parameters: Vec::new(), words: words.into() }
    }

    /// As JSON of `verdict.json`.
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

/// The error of the twist on held-out blocks, with each thing added.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// What was added.
    pub added: String,
    /// Root mean square on held-out blocks \[rad\].
    pub held_out_rad: f64,
}

/// A twist and the torque at which it was read, thinned for a picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Traced {
    /// Torque \[N m\].
    pub torque_nm: f64,
    /// As recorded: motor less link, about its mean \[rad\].
    pub before_rad: f64,
    /// With time shift, friction and transmission error taken out: what the spring does \[rad\].
    pub after_rad: f64,
    /// What the model says of the spring \[rad\].
    pub model_rad: f64,
}

/// What the records say about one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRecord {
    /// The joint.
    pub joint: String,
    /// Rows that count.
    pub rows: usize,
    /// Independent readings that they are worth, because errors follow each other.
    pub effective_rows: f64,
    /// Blocks of time that were held out in turn.
    pub blocks: usize,
    /// Range of the joint's angle \[rad\].
    pub range_rad: f64,
    /// Noise of the twist from row to row \[rad\].
    pub noise_rad: f64,
    /// Error with the nominal arm, and the best held-out one \[rad\].
    pub before_rad: f64,
    /// Error on held-out blocks with everything found \[rad\].
    pub after_rad: f64,
    /// Everything that was looked for.
    pub stated: Vec<Stated>,
    /// How the error on held-out blocks falls.
    pub steps: Vec<Step>,
    /// Twist against torque.
    pub trace: Vec<Traced>,
    /// Further sentences.
    pub remarks: Vec<String>,
}

impl JointRecord {
    /// What was stated about one thing.
    pub fn of(&self, what: &str) -> Option<&Stated> {
        self.stated.iter().find(|s| s.what == what)
    }

    /// The first estimate of something that was found.
    pub fn found(&self, what: &str) -> Option<&Stated> {
        self.of(what).filter(|s| s.state == State::Found)
    }

    /// As JSON of `verdict.json`.
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
