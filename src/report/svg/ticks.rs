//! Positions and labels of the ticks of an axis.

use super::scale::Scale;
use crate::report::number::times_power_of_ten;

/// One tick of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    /// Value of the tick, in data units.
    pub value: f64,
    /// Label of the tick; `None` for a minor tick.
    pub label: Option<String>,
}

/// The range of an axis, widened to round numbers, and its ticks.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ruling {
    /// Scale of the axis.
    pub scale: Scale,
    /// Lower end of the axis, in data units.
    pub low: f64,
    /// Upper end of the axis, in data units.
    pub high: f64,
    /// Ticks in ascending order.
    pub ticks: Vec<Tick>,
}

/// Chooses range and ticks of an axis for data from `low` to `high`, with about `count` labelled ticks.
pub(crate) fn rule(scale: Scale, low: f64, high: f64, count: usize) -> Ruling {
    match scale {
        Scale::Linear => linear(low, high, count),
        Scale::Log => logarithmic(low, high, count),
    }
}

impl Ruling {
    /// Position of a value along the axis: 0 at the lower end, 1 at the upper end.
    pub(crate) fn position(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => libm::log(value / self.low) / libm::log(self.high / self.low),
        }
    }
}

fn linear(low: f64, high: f64, count: usize) -> Ruling {
    let (low, high) = widen(low, high);
    // a range that begins near zero begins at zero
    let low = if low > 0.0 && low < 0.35 * high { 0.0 } else { low };
    let (step, decimals) = nice_step((high - low) / count.max(1) as f64);
    let first = (low / step + 1e-9).floor();
    let last = (high / step - 1e-9).ceil();
    let ticks = (first as i64..=last as i64)
        .map(|i| Tick { value: i as f64 * step, label: Some(label(i as f64 * step, decimals)) })
        .collect();
    Ruling { scale: Scale::Linear, low: first * step, high: last * step, ticks }
}

/// A step of 1, 2, 2.5 or 5 times a power of ten that is at least `least`, and the number of decimals for its
/// labels.
fn nice_step(least: f64) -> (f64, usize) {
    let power = libm::log10(least).floor() as i32;
    let unit = 10f64.powi(power);
    let (factor, extra) = [(1.0, 0), (2.0, 0), (2.5, 1), (5.0, 0), (10.0, -1)]
        .into_iter()
        .find(|(f, _)| f * unit >= least * (1.0 - 1e-9))
        .unwrap_or((10.0, -1));
    (factor * unit, (extra - power).max(0) as usize)
}

fn logarithmic(low: f64, high: f64, count: usize) -> Ruling {
    let (low, high) = if high / low < 1.02 { (low / 1.5, high * 1.5) } else { (low, high) };
    let (low, high) = (stop_below(low), stop_above(high));
    let decades = libm::log10(high / low);
    let labelled: &[f64] = if 3.0 * decades > (2 * count + 1) as f64 {
        &[1.0]
    } else if decades <= 1.05 {
        &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
    } else if decades <= 3.0 {
        &[1.0, 2.0, 5.0]
    } else {
        &[1.0]
    };
    let every = ((decades / (2 * count.max(1)) as f64).ceil() as i32).max(1);
    let ticks = (libm::log10(low).floor() as i32..=libm::log10(high).ceil() as i32)
        .flat_map(|power| (1..10).map(move |m| (m, power)))
        .map(|(m, power)| (f64::from(m), power, times_power_of_ten(f64::from(m), power)))
        .filter(|(_, _, value)| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(value))
        .map(|(m, power, value)| Tick {
            value,
            label: (labelled.contains(&m) && power.rem_euclid(every) == 0)
                .then(|| label(value, (-power).max(0) as usize)),
        })
        .collect();
    Ruling { scale: Scale::Log, low, high, ticks }
}

/// Numbers within a decade at which a logarithmic axis may end.
const STOPS: [f64; 3] = [1.0, 2.0, 5.0];

fn stop_below(value: f64) -> f64 {
    let power = libm::log10(value).floor() as i32;
    let candidates = STOPS.iter().map(|s| times_power_of_ten(*s, power));
    candidates.filter(|s| *s <= value * (1.0 + 1e-9)).fold(times_power_of_ten(1.0, power), f64::max)
}

fn stop_above(value: f64) -> f64 {
    let power = libm::log10(value).floor() as i32;
    let candidates = STOPS.iter().map(|s| times_power_of_ten(*s, power));
    candidates.filter(|s| *s >= value * (1.0 - 1e-9)).fold(times_power_of_ten(1.0, power + 1), f64::min)
}

/// The range from `low` to `high`, or a wider one if it is empty or nearly so.
fn widen(low: f64, high: f64) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    if high - low > 1e-9 * size {
        (low, high)
    } else if size == 0.0 {
        (0.0, 1.0)
    } else {
        (low - 0.1 * size, high + 0.1 * size)
    }
}

fn label(value: f64, decimals: usize) -> String {
    let size = value.abs();
    if size >= 1e6 || (size != 0.0 && size < 1e-4) {
        return format!("{value:e}").replace('-', "\u{2212}");
    }
    crate::report::number::fixed(value, decimals).replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ruling: &Ruling) -> Vec<&str> {
        ruling.ticks.iter().filter_map(|t| t.label.as_deref()).collect()
    }

    #[test]
    fn linear_ticks_are_round_and_cover_the_data() {
        let r = rule(Scale::Linear, 0.023, 0.855, 5);
        assert_eq!(labels(&r), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        let r = rule(Scale::Linear, 13.1, 15.9, 6);
        assert_eq!((r.low, r.high), (13.0, 16.0));
        let r = rule(Scale::Linear, -3.0, 4.0, 5);
        assert_eq!(labels(&r), ["\u{2212}4", "\u{2212}2", "0", "2", "4"]);
    }

    #[test]
    fn logarithmic_ticks_label_1_2_5_and_decades() {
        let r = rule(Scale::Log, 0.023, 0.855, 6);
        assert_eq!(labels(&r), ["0.02", "0.05", "0.1", "0.2", "0.5", "1"]);
        let r = rule(Scale::Log, 0.5, 30_000.0, 6);
        assert_eq!(labels(&r), ["1", "10", "100", "1000", "10000"]);
    }

    #[test]
    fn an_empty_range_still_has_a_width() {
        for scale in [Scale::Linear, Scale::Log] {
            let r = rule(scale, 2.0, 2.0, 5);
            assert!(r.low < 2.0 && r.high > 2.0 && labels(&r).len() >= 2, "{r:?}");
        }
    }
}
