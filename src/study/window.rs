//! The payloads that an arm holds: a window from a smallest to a largest one, and what fails beyond its ends.
//!
//! Every load on a drive, a bearing or a link is a convex function of the payload's mass, because it is a norm or a
//! mean of quantities that are affine in this mass. The payloads that an arm holds are therefore one interval.

use super::overload::Overload;
use serde_json::{Value, json};

/// Largest amount that is tried, such as a payload \[kg\]. An arm that still holds it is reported as having no limit.
pub(crate) const MOST_KG: f64 = 1e6;
/// A bisection for an end of a window stops when its interval is this narrow, relative to the payload.
const BISECTION_TOLERANCE: f64 = 1e-13;
/// Payload below which the tolerance does not shrink any more \[kg\].
const SMALL_KG: f64 = 1e-3;

/// One end of the payloads that an arm holds, and what fails beyond it.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// The last payload that passes every check \[kg\]. At the upper end it is infinite if nothing limits the payload;
    /// at the lower end it is 0 if the empty arm passes.
    pub payload_kg: f64,
    /// Name of the joint or link that fails beyond this payload; empty if none does.
    pub piece: String,
    /// Label of the check that fails beyond this payload.
    pub check: String,
}

/// The payloads that an arm holds, in one pose or in several.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// The smallest payload that the arm holds; 0 if it holds even without a payload. It exceeds `most` if the arm
    /// holds no payload at all.
    pub least: Limit,
    /// The largest payload that the arm holds.
    pub most: Limit,
}

impl Limit {
    pub(crate) fn new(payload_kg: f64, beyond: Overload) -> Self {
        Self { payload_kg, piece: beyond.piece, check: beyond.check }
    }
}

impl Window {
    /// The window of an arm that holds every payload.
    pub(crate) fn unlimited() -> Self {
        let end = |payload_kg| Limit::new(payload_kg, Overload::default());
        Self { least: end(0.0), most: end(f64::INFINITY) }
    }

    /// The window of an arm that holds no payload at all; `fails` is what the arm overloads without a payload.
    pub(crate) fn empty(fails: Overload) -> Self {
        Self { least: Limit::new(f64::INFINITY, fails.clone()), most: Limit::new(0.0, fails) }
    }

    /// Whether the arm holds any payload.
    pub fn holds(&self) -> bool {
        self.least.payload_kg <= self.most.payload_kg
    }

    /// The payloads that are in this window and in `other`.
    #[must_use]
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            least: if other.least.payload_kg > self.least.payload_kg { other.least } else { self.least },
            most: if other.most.payload_kg < self.most.payload_kg { other.most } else { self.most },
        }
    }

    /// The window in JSON. `payload_kg` is the largest payload: null if nothing limits it, 0 if no payload holds.
    pub(super) fn to_json(&self) -> Value {
        let finite = |x: f64| if x.is_finite() { json!(x) } else { Value::Null };
        let holds = self.holds();
        let (most, least) = (&self.most, &self.least);
        let ends = if holds { most } else { least };
        json!({"payload_kg": if holds { finite(most.payload_kg) } else { json!(0.0) },
            "joint": ends.piece, "check": ends.check, "holds": holds,
            "least_payload_kg": finite(least.payload_kg), "least_joint": least.piece, "least_check": least.check})
    }
}

/// The payloads around `held_kg` that the arm holds. `overload` returns what a payload \[kg\] overloads, or `None` if
/// the arm holds it; it must be `None` for `held_kg`.
pub(crate) fn window_around(held_kg: f64, overload: &dyn Fn(f64) -> Option<Overload>) -> Window {
    let least = overload(0.0).map(|fails| end_between(held_kg, 0.0, fails, overload));
    let open = Window::unlimited();
    Window {
        least: least.map_or(open.least, |(payload_kg, fails)| Limit::new(payload_kg, fails)),
        most: largest_held(held_kg, overload)
            .map_or(open.most, |(most_kg, fails)| Limit::new(most_kg, fails)),
    }
}

/// The largest amount that the arm holds, such as a payload or a speed, and what a larger one overloads; `None` if it
/// holds amounts beyond [`MOST_KG`]. `overload` returns what an amount overloads, or `None` if the arm holds it; it
/// must be `None` for `held`.
pub(crate) fn largest_held(
    mut held: f64,
    overload: &dyn Fn(f64) -> Option<Overload>,
) -> Option<(f64, Overload)> {
    let mut more = (2.0 * held).max(1.0);
    loop {
        match overload(more) {
            Some(fails) => break Some(end_between(held, more, fails, overload)),
            None if more > MOST_KG => break None,
            None => (held, more) = (more, 2.0 * more),
        }
    }
}

/// The last amount that passes, between the amount `held` that passes and the amount `failed` that does not, by
/// bisection, and what fails beyond it. `fails` is what the amount `failed` overloads.
fn end_between(
    mut held: f64,
    mut failed: f64,
    mut fails: Overload,
    overload: &dyn Fn(f64) -> Option<Overload>,
) -> (f64, Overload) {
    while (failed - held).abs() > BISECTION_TOLERANCE * failed.max(held).max(SMALL_KG) {
        let middle = 0.5 * (held + failed);
        match overload(middle) {
            Some(found) => (failed, fails) = (middle, found),
            None => held = middle,
        }
    }
    (held, fails)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_ends_where_checks_begin_to_fail_on_either_side() {
        let overload = |kg: f64| {
            let piece = if kg < 2.5 { "spring" } else { "motor" };
            ((kg - 10.0).abs() > 7.5).then(|| Overload { piece: piece.into(), check: "torque".into() })
        };
        let window = window_around(4.0, &overload);
        assert!(
            (window.least.payload_kg - 2.5).abs() < 1e-12 && window.least.piece == "spring",
            "{window:?}"
        );
        assert!((window.most.payload_kg - 17.5).abs() < 1e-12 && window.most.piece == "motor", "{window:?}");
        let above = window_around(1e3, &|kg: f64| (kg < 20.0).then(Overload::default));
        assert!(above.most.payload_kg.is_infinite() && !window.and(above).holds());
    }
}
