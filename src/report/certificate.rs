//! How sure a front is: what was visited, what was cut and why, what may be missing.

use super::facts::SummaryFacts;
use super::number::{large, percent_rounded};
use super::section::PageSection;
use super::words::{TERMINAL, wrap};

/// The section of a page; `boxes` are those bounded and left open by an exact search.
pub fn certificate_section(facts: &SummaryFacts, boxes: Option<[u64; 2]>) -> PageSection {
    let words = match (boxes, facts.is_stopped()) {
        (None, false) => vec![format!(
            "Every design was visited: of {} {} hold and were judged, and {} were excluded because a drive, a link \
             or a limit does not hold. None is missing.",
            large(facts.designs_total),
            large(facts.designs_evaluated),
            large(facts.designs_excluded),
        )],
        (None, true) => vec![format!(
            "The search was stopped after {} of {} designs: any design that was not visited may be missing.",
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
            "That is what was asked for. A smaller --gap lists more designs and takes longer; limits on mass, deflection \
             or mode (constraints) leave a part of the front that can be had whole."
                .into(),
        ],
        (Some([bounded, _]), false) => vec![
            format!(
                "The front is proved complete without visiting all {} designs: {} boxes of parts cover them. Each was cut \
                 because not even the best its members could be meets the limits, or because a design listed here is \
                 better than that.",
                large(facts.designs_total),
                large(bounded.into()),
            ),
            "Designs that differ by less than a part in 1e9 in every objective count as equal.".into(),
        ],
        (Some([bounded, open]), true) => vec![
            format!(
                "The search was stopped: of the {} boxes of parts that were bounded {} were left open.",
                large(bounded.into()),
                large(open.into()),
            ),
            match facts.gap {
                Some(gap) => {
                    format!("Of what they hold {}. A longer --time-limit narrows this.", gap_words(gap))
                }
                None => "Nothing can be said of what they hold. A longer --time-limit helps.".into(),
            },
        ],
    };
    let how = "Check it again from this front (the check says by whose bounds): armwright front check";
    let words = words.into_iter().chain([format!("{how} {}", facts.results)]).collect();
    PageSection { title: "How sure is this front?".into(), words, tables: Vec::new(), figures: Vec::new() }
}

/// How much an exact search may have missed: the words that page, terminal and summary share.
pub fn gap_words(gap: f64) -> String {
    format!(
        "no design beats every listed one by more than {} in tip deflection, mass and lowest mode at once",
        percent_rounded(100.0 * gap, 2)
    )
}

/// What an exact search proves, for the terminal; `boxes` as for the page.
pub fn certificate_words([boxes, open]: [u64; 2], gap: Option<f64>) -> String {
    match (open, gap) {
        (0, None | Some(0.0)) => {
            format!("certified: no design that is not listed is on the front ({boxes} boxes)\n")
        }
        (0, Some(gap)) => wrap(&format!("certified: {} ({boxes} boxes)", gap_words(gap)), TERMINAL, ""),
        (_, Some(gap)) => {
            let words = format!("partial: {} ({boxes} boxes bounded, {open} open)", gap_words(gap));
            wrap(&words, TERMINAL, "")
        }
        (_, None) => {
            format!("partial: nothing can be said of what is missing ({boxes} boxes, {open} open)\n")
        }
    }
}
