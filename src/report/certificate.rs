//! The certificate of a front: how many designs were evaluated or discarded, and what may be missing.

use super::facts::SummaryFacts;
use super::number::{large, percent_rounded, shortest};
use super::section::PageSection;
use super::words::{TERMINAL, wrap};

/// The certificate as a section of a page. For an exact search, `boxes` has the numbers of boxes that were bounded
/// and that were left open; `None` for an exhaustive search.
pub(crate) fn certificate_section(facts: &SummaryFacts, boxes: Option<[u64; 2]>) -> PageSection {
    let words = match (boxes, facts.is_stopped()) {
        (None, false) => vec![format!(
            "Every design was visited, so none is missing: of {} designs {} meet the limits, and {} were excluded \
             because a drive or a link is too weak or a limit is broken.",
            large(facts.designs_total),
            large(facts.designs_evaluated),
            large(facts.designs_excluded),
        )],
        (None, true) => vec![format!(
            "The search was stopped after {} of {} designs: designs that were not visited may be missing.",
            large(facts.designs_evaluated + facts.designs_excluded),
            large(facts.designs_total),
        )],
        (Some([bounded, _]), false) if !facts.is_whole() => vec![
            format!(
                "Proved without visiting all {} designs, by {} boxes and regions of parts that cover them: {}.",
                large(facts.designs_total),
                large(bounded.into()),
                gap_words(facts.gap.unwrap_or_default()),
            ),
            "This is the gap that was asked for. A smaller --gap lists more designs and takes longer. With tighter limits on \
             mass, deflection or mode (constraints) the remaining part of the front can be complete."
                .into(),
        ],
        (Some([bounded, _]), false) => vec![
            format!(
                "The front is proved complete without visiting all {} designs. They are covered by {} boxes (groups of \
                 designs). Each box was discarded because none of its designs can meet the limits, or because a design \
                 listed here is better than any of them can be.",
                large(facts.designs_total),
                large(bounded.into()),
            ),
            "Designs whose objectives all differ by less than one part in 1e9 count as equal.".into(),
        ],
        (Some([bounded, open]), true) => vec![
            format!(
                "The search was stopped: {} boxes of designs were bounded, and {} were left open.",
                large(bounded.into()),
                large(open.into()),
            ),
            match facts.gap {
                Some(gap) => {
                    format!("What is known of the designs in them: {}. A longer --time-limit narrows this.", gap_words(gap))
                }
                None => "Nothing is known of the designs in them. A longer --time-limit helps.".into(),
            },
        ],
    };
    let how = "To verify this front again, run: armwright front check";
    let words = words.into_iter().chain([format!("{how} {}", facts.results)]).collect();
    PageSection { title: "How sure is this front?".into(), words, tables: Vec::new(), figures: Vec::new() }
}

/// How much an exact search may have missed, in the same words for page, terminal and summary.
///
/// The gap promises that every design of the study has a listed design that is nearly as good in all objectives. A
/// weaker promise, that no design beats *every* listed one, would be worth nothing: the lightest listed design
/// alone could ensure it.
pub(crate) fn gap_words(gap: f64) -> String {
    format!(
        "for every design of the study some listed one is at most {} worse in each of tip deflection, mass and lowest mode",
        percent_rounded(100.0 * gap, 2)
    )
}

/// Words on what an exact search proved, for the terminal. The array has the number of boxes that were bounded, and the
/// number that were left open. `up_to_kg` is the largest mass up to which the whole front is proved \[kg\]; `None` if
/// the study does not limit the mass or the front is not whole.
pub(crate) fn certificate_words([boxes, open]: [u64; 2], gap: Option<f64>, up_to_kg: Option<f64>) -> String {
    match (open, gap) {
        (0, None | Some(0.0)) => {
            let limit = up_to_kg.map_or(String::new(), |kg| format!(" up to {} kg", shortest(kg)));
            format!("certified: every design of the front{limit} is listed ({boxes} boxes)\n")
        }
        (0, Some(gap)) => wrap(&format!("certified: {} ({boxes} boxes)", gap_words(gap)), TERMINAL, ""),
        (_, Some(gap)) => {
            let words = format!("partial: {} ({boxes} boxes bounded, {open} open)", gap_words(gap));
            wrap(&words, TERMINAL, "")
        }
        (_, None) => {
            format!("partial: what is missing is not known ({boxes} boxes, {open} open)\n")
        }
    }
}
