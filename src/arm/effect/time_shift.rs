//! `time_shift`: the clock of a channel is ahead or behind. It matters for time records only.

use super::kind::{EVERY_CHANNEL, Kind, Parameter, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] = &[Parameter::number("seconds", -3600.0, 3600.0, 0.01, Scale::Linear)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "time_shift",
    summary: "the clock of a channel runs ahead or behind (time records)",
    scope: Scope::Test,
    places: EVERY_CHANNEL,
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { is_sought: false, ..Traits::USUAL },
};

fn apply(_numbers: &[f64], _at: &str, _subject: &mut Subject) {
    // readings of statics, modes, benches and positions have no time, so nothing changes
}
