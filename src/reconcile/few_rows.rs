//! What a handful of readings can say: every small set of effects that explains them is listed, because
//! with few rows several always do.
//!
//! Sets of one effect, then of two, then of three are fitted, none with more effects than there are
//! readings, until some explain every reading within its standard deviation. No set is preferred for its
//! place in the list: what all of them share is what the readings say, and a number on which they differ,
//! or that some of them do without, is one that the readings cannot give.

use super::fit::{Effort, Fit};
use super::model::Knob;
use super::select::{MOST_EFFECTS, Scored, Search, Selection};
use super::stats::ln_chi_squared_tail;
use super::verdict::{Estimate, Finding};
use rayon::prelude::*;

/// Fewest rows from which one model can be chosen.
pub const FEWEST_ROWS: usize = 11;
/// Most fits for sets of one size; beyond it only the most promising smaller sets are extended.
const MOST_FITS: usize = 6000;
/// Probability below which a set does not explain the readings.
const IMPROBABLE: f64 = 0.01;
/// Explaining sets that are this far behind the best in evidence are not listed.
const IMPLAUSIBLE: f64 = 6.0;

/// Weighs every small set of effects; the first of `others` are those that explain the readings.
pub fn weigh(search: &Search) -> Selection {
    let bare = scored(search, &[], &[]);
    let mut others: Vec<Scored> = Vec::new();
    let mut level = vec![bare.clone()];
    for _ in 0..MOST_EFFECTS {
        if level.iter().any(|s| explains(search, s)) {
            break;
        }
        level = extend(search, &level);
        others.extend(level.iter().cloned());
    }
    let mut explaining = explaining(search, &others);
    let best = explaining.first().cloned().unwrap_or_else(|| bare.clone());
    if explaining.is_empty() {
        others.sort_by(|a, b| b.score.total_cmp(&a.score));
        explaining = others;
    }
    Selection { best, bare, others: explaining }
}

/// The sets among `models` that explain the readings, best first.
pub fn explaining(search: &Search, models: &[Scored]) -> Vec<Scored> {
    let mut out: Vec<Scored> = models.iter().filter(|s| explains(search, s)).cloned().collect();
    out.sort_by(|a, b| b.score.total_cmp(&a.score).then(a.effects.cmp(&b.effects)));
    let top = out.first().map_or(0.0, |s| s.score);
    out.retain(|s| s.score > top - IMPLAUSIBLE);
    out
}

/// Whether the readings are as near to the set's predictions as their standard deviations say.
fn explains(search: &Search, scored: &Scored) -> bool {
    let readings = search.forward.data.len();
    let free = knobs(search, &scored.effects);
    let dof = readings.saturating_sub(free).max(1) as f64;
    ln_chi_squared_tail(scored.objective, dof) > IMPROBABLE.ln()
}

fn knobs(search: &Search, effects: &[usize]) -> usize {
    effects.iter().map(|&e| search.candidates[e].knobs.len()).sum()
}

/// Every set of `level` with one more effect, fitted; no set twice.
fn extend(search: &Search, level: &[Scored]) -> Vec<Scored> {
    let candidates = 0..search.candidates.len();
    let mut from: Vec<&Scored> = level.iter().collect();
    from.sort_by(|a, b| a.objective.total_cmp(&b.objective).then(a.effects.cmp(&b.effects)));
    from.truncate((MOST_FITS / candidates.len().max(1)).max(1));
    let mut sets: Vec<(Vec<usize>, &Scored, usize)> = from
        .into_iter()
        .flat_map(|base| candidates.clone().map(move |c| (base, c)))
        .filter(|(base, c)| !base.effects.contains(c))
        .map(|(base, c)| {
            let mut sorted = [base.effects.as_slice(), &[c]].concat();
            sorted.sort_unstable();
            (sorted, base, c)
        })
        .filter(|(sorted, ..)| sorted.len() <= search.forward.data.len())
        .collect();
    sets.sort_by(|a, b| a.0.cmp(&b.0));
    sets.dedup_by(|a, b| a.0 == b.0);
    sets.into_par_iter()
        .map(|(_, base, c)| {
            let effects = [base.effects.as_slice(), &[c]].concat();
            let starts = search.candidates[c].starts.iter();
            let starts: Vec<Vec<f64>> = starts.map(|s| [base.u.as_slice(), s].concat()).collect();
            scored(search, &effects, &starts)
        })
        .collect()
}

/// The best fit of a set from several starts.
fn scored(search: &Search, effects: &[usize], starts: &[Vec<f64>]) -> Scored {
    let nothing = [vec![0.0; search.nuisance.numbers.len()]];
    let starts = if starts.is_empty() { &nothing } else { starts };
    let fits = starts.iter().map(|u| search.fit(effects, u, Effort::default()));
    let best = fits.min_by(|a, b| a.point.objective.total_cmp(&b.point.objective));
    search.scored(effects, &best.expect("at least one start"))
}

/// What the sets that explain the readings have in common, and what they do not.
pub fn sentences(search: &Search, bare: &Fit, explaining: &[Scored]) -> Vec<String> {
    let mut out = vec![gap(search, bare)];
    let Some(first) = explaining.first() else {
        out.push(format!("no {MOST_EFFECTS} effects of the library explain every reading"));
        return out;
    };
    let (count, size) = (explaining.len(), first.effects.len());
    if size == 0 {
        return vec!["noise and calibration within tolerance explain every reading".into()];
    }
    out.push(match count {
        1 => format!(
            "one set of {size} effect(s) explains every reading: {}",
            search.model(&first.effects).label()
        ),
        _ => format!(
            "{count} sets of {size} effects explain every reading; these readings cannot tell them apart"
        ),
    });
    for (label, values) in shared(search, explaining) {
        out.push(format!("all of them have {label}{values}"));
    }
    out.extend(optional(search, explaining));
    out
}

/// The worst reading of the arm as given.
fn gap(search: &Search, bare: &Fit) -> String {
    let data = search.forward.data.iter().zip(&bare.point.predicted);
    let worst = data.max_by(|a, b| {
        ((a.0.value - a.1) / a.0.sigma).abs().total_cmp(&((b.0.value - b.1) / b.0.sigma).abs())
    });
    let Some((datum, predicted)) = worst else { return "there is no reading".into() };
    format!(
        "the arm as given, calibrated within tolerance, cannot give the readings: chi-squared {:.0} on {}; the worst \
         is {} row {}, measured {} where the arm has {predicted:.2}",
        bare.point.objective,
        search.forward.data.len(),
        datum.channel.word(),
        datum.row + 1,
        datum.value
    )
}

/// Effects that are in every set, with the range of their values.
fn shared(search: &Search, explaining: &[Scored]) -> Vec<(String, String)> {
    let first = &explaining[0].effects;
    first
        .iter()
        .filter(|e| explaining.iter().all(|s| s.effects.contains(e)))
        .map(|&e| {
            let candidate = &search.candidates[e];
            let ranges: Vec<String> = (0..candidate.knobs.len())
                .map(|k| {
                    let (low, high) = range(search, explaining, e, k);
                    format!("{} from {low:.4} to {high:.4}", candidate.knobs[k].name)
                })
                .collect();
            let values = if ranges.is_empty() { String::new() } else { format!(": {}", ranges.join(", ")) };
            (candidate.label(), values)
        })
        .collect()
}

/// Effects that some sets have and others do without: the readings cannot give their numbers.
fn optional(search: &Search, explaining: &[Scored]) -> Option<String> {
    let mut counts: Vec<(usize, usize)> = Vec::new();
    for &e in explaining.iter().flat_map(|s| &s.effects) {
        match counts.iter_mut().find(|(known, _)| *known == e) {
            Some((_, count)) => *count += 1,
            None => counts.push((e, 1)),
        }
    }
    counts.retain(|(_, count)| *count < explaining.len());
    counts.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    let names: Vec<String> =
        counts.iter().map(|(e, n)| format!("{} (in {n})", search.candidates[*e].label())).collect();
    (!names.is_empty())
        .then(|| format!("in some of them, so that their numbers cannot be identified: {}", names.join(", ")))
}

/// Smallest and largest value of one number over the sets that have its effect.
fn range(search: &Search, explaining: &[Scored], effect: usize, knob: usize) -> (f64, f64) {
    let values = explaining.iter().filter_map(|s| value(search, s, effect, knob));
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

fn value(search: &Search, scored: &Scored, effect: usize, knob: usize) -> Option<f64> {
    let position = scored.effects.iter().position(|e| *e == effect)?;
    let first = search.model(&scored.effects).first_knob(position);
    Some(search.candidates[effect].knobs[knob].value(scored.u[first + knob]))
}

/// Widens the intervals of the best set's effects to what the other sets say: an effect that some set does
/// without may be absent.
pub fn widen(search: &Search, explaining: &[Scored], findings: &mut [Finding]) {
    let Some(best) = explaining.first() else { return };
    for (&effect, finding) in best.effects.iter().zip(findings) {
        let candidate = &search.candidates[effect];
        let absent = explaining.iter().any(|s| !s.effects.contains(&effect));
        let estimates = finding.parameters.iter_mut().flat_map(|(_, list)| list.iter_mut());
        for (k, (knob, estimate)) in candidate.knobs.iter().zip(estimates).enumerate() {
            widen_one(estimate, range(search, explaining, effect, k), absent.then_some(knob));
        }
        let rivals = explaining.iter().filter(|s| !s.effects.contains(&effect)).flat_map(|s| &s.effects);
        for &rival in rivals.filter(|r| !best.effects.contains(r)) {
            let name = (search.candidates[rival].kind.name.to_string(), search.candidates[rival].at.clone());
            if !finding.indistinguishable_from.contains(&name) {
                finding.indistinguishable_from.push(name);
            }
        }
    }
}

/// `absent`: the number, if its effect may be absent, where a stiffness has no bound and others are 0.
fn widen_one(estimate: &mut Estimate, (low, high): (f64, f64), absent: Option<&Knob>) {
    estimate.low = estimate.low.map(|l| l.min(low));
    estimate.high = estimate.high.map(|h| h.max(high));
    match absent {
        Some(knob) if knob.reversed() => estimate.high = None,
        Some(_) => {
            estimate.low = estimate.low.map(|l| l.min(0.0));
            estimate.high = estimate.high.map(|h| h.max(0.0));
        }
        None => {}
    }
}
