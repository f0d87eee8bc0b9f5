//! The answers of all fronts to all questions, with the winner and how much better it is than the next front.

use super::contender::Contender;
use super::moved::Moved;
use super::question::{Question, comparative, superlative};
use super::thresholds::Thresholds;
use crate::report::number::{cost_words, percent_rounded};
use crate::report::picks::{Design, Objective, best, designs};
use crate::report::words::capital;
use serde::Serialize;

/// The answer of one front to a question.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// Label of the front.
    pub label: String,
    /// Whether at least one design of the front meets the limit.
    pub reached: bool,
    /// Whether the front meets the limit and no other competing front has a better answer.
    pub winner: bool,
    /// Whether the front is only a reference and cannot win.
    pub reference: bool,
    /// The best design within the limit. If no design meets the limit, the design that comes nearest to it; `None`
    /// if the front is empty.
    pub design: Option<Design>,
}

/// All answers to one question at one limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The question that the fronts answer.
    pub question: Question,
    /// The limit of the question \[mm, kg or Hz\].
    pub limit: f64,
    /// One answer per front, in the order of the contenders.
    pub answers: Vec<Answer>,
    /// Which front wins and by how much, in a sentence.
    pub sentence: String,
}

/// The best that one front reaches in each objective, without any limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reach {
    /// Label of the front.
    pub label: String,
    /// Whether the front is only a reference and cannot win.
    pub reference: bool,
    /// Number of designs on the front.
    pub designs: usize,
    /// The lightest design of the front; `None` if the front is empty.
    pub lightest: Option<Design>,
    /// The stiffest design of the front; `None` if the front is empty.
    pub stiffest: Option<Design>,
    /// The design of the front with the highest lowest mode; `None` if the front is empty.
    pub highest_mode: Option<Design>,
}

/// The comparison of several fronts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The best values of each front, in the order of the contenders.
    pub reach: Vec<Reach>,
    /// One row per question and limit.
    pub rows: Vec<Row>,
    /// Sentences for the reader: where the questions of the results differ, and the remarks of the results.
    pub remarks: Vec<String>,
    /// Changes from the first result to each of the other results, if all are runs of one study.
    pub moved: Vec<Moved>,
}

/// Compares fronts by the best design of each under the limits in `thresholds`. If no limit is given, round limits are
/// chosen.
pub fn compare(contenders: &[Contender], thresholds: &Thresholds) -> Comparison {
    let fronts: Vec<Vec<Design>> = contenders.iter().map(|c| designs(&c.front)).collect();
    let competing: Vec<&[Design]> = contenders
        .iter()
        .zip(&fronts)
        .filter(|(c, f)| !c.reference && !f.is_empty())
        .map(|(_, f)| f.as_slice())
        .collect();
    let thresholds = thresholds.or_chosen(&competing);
    let ask = |question: Question| {
        let limits = thresholds.of(question).to_vec();
        let (contenders, fronts) = (contenders, &fronts);
        limits.into_iter().map(move |limit| row(question, limit, contenders, fronts))
    };
    Comparison {
        reach: contenders.iter().zip(&fronts).map(|(c, f)| reach(c, f)).collect(),
        rows: Question::ALL.into_iter().flat_map(ask).collect(),
        remarks: Vec::new(),
        moved: Vec::new(),
    }
}

fn reach(contender: &Contender, front: &[Design]) -> Reach {
    let of = |objective| best(objective, front).cloned();
    Reach {
        label: contender.label.clone(),
        reference: contender.reference,
        designs: front.len(),
        lightest: of(Objective::Mass),
        stiffest: of(Objective::Deflection),
        highest_mode: of(Objective::Mode),
    }
}

fn row(question: Question, limit: f64, contenders: &[Contender], fronts: &[Vec<Design>]) -> Row {
    let mut answers: Vec<Answer> =
        contenders.iter().zip(fronts).map(|(c, f)| answer(question, limit, c, f)).collect();
    let value = |a: &Answer| a.design.as_ref().map(|d| question.sought().minimized(d));
    let running = |a: &&Answer| a.reached && !a.reference;
    let best = answers.iter().filter(running).filter_map(value).fold(f64::INFINITY, f64::min);
    for a in &mut answers {
        a.winner = a.reached && !a.reference && value(a) == Some(best);
    }
    Row { question, limit, sentence: sentence(question, limit, &answers), answers }
}

fn answer(question: Question, limit: f64, contender: &Contender, front: &[Design]) -> Answer {
    let found = best(question.sought(), front.iter().filter(|d| question.holds(limit, d)));
    let nearest = || best(question.limited(), front);
    Answer {
        label: contender.label.clone(),
        reached: found.is_some(),
        winner: false,
        reference: contender.reference,
        design: found.or_else(nearest).cloned(),
    }
}

fn sentence(question: Question, limit: f64, answers: &[Answer]) -> String {
    let (sought, words) = (question.sought(), question.limit_words(limit));
    let mut reached: Vec<(&Answer, &Design)> = answers
        .iter()
        .filter(|a| a.reached && !a.reference)
        .filter_map(|a| Some((a, a.design.as_ref()?)))
        .collect();
    reached.sort_by(|(_, a), (_, b)| sought.minimized(a).total_cmp(&sought.minimized(b)));
    let Some((_, best)) = reached.first() else {
        return capital(&format!("{words}: {}", out_of_reach(question, answers)));
    };
    let winners: Vec<&str> =
        reached.iter().filter(|(a, _)| a.winner).map(|(a, _)| a.label.as_str()).collect();
    let value = sought.amount(sought.of(best));
    let cost = best.material_cost_eur.map_or(String::new(), |c| format!(", material {} EUR", cost_words(c)));
    let lead = match reached.get(winners.len()) {
        Some((a, second)) => format!(
            ", {} {} than {} ({})",
            advantage(sought, best, second),
            comparative(question),
            a.label,
            sought.amount(sought.of(second))
        ),
        // a front without designs does not compete
        None if winners.len() == 1
            && answers.iter().filter(|a| !a.reference && a.design.is_some()).count() > 1 =>
        {
            ", the only one that reaches it".to_string()
        }
        None => String::new(),
    };
    let mut out = format!(
        "{words}: {} {} with {value} (design {}{cost}){lead}",
        winners.join(" and "),
        superlative(question, winners.len() > 1),
        best.design_id
    );
    out.push_str(&mixed(question, best, answers));
    capital(&(out + "."))
}

/// Words on the reference front, which cannot win: the best value that it reaches in this question. Empty if this value
/// is no better than that of `winner`.
fn mixed(question: Question, winner: &Design, answers: &[Answer]) -> String {
    let sought = question.sought();
    let better = |a: &&Answer| {
        a.reference
            && a.reached
            && a.design.as_ref().is_some_and(|d| sought.minimized(d) < sought.minimized(winner))
    };
    match answers.iter().find(better).and_then(|a| a.design.as_ref()) {
        Some(d) => format!(
            "; materials mixed reach {}, {} {}",
            sought.amount(sought.of(d)),
            advantage(sought, d, winner),
            comparative(question)
        ),
        None => String::new(),
    }
}

fn out_of_reach(question: Question, answers: &[Answer]) -> String {
    let limited = question.limited();
    let competing = answers.iter().filter(|a| !a.reference);
    let nearest = competing
        .filter_map(|a| Some((a, a.design.as_ref()?)))
        .min_by(|(_, a), (_, b)| limited.minimized(a).total_cmp(&limited.minimized(b)));
    match nearest {
        Some((a, d)) => {
            format!("none reaches it; nearest is {} with {}.", a.label, limited.amount(limited.of(d)))
        }
        None => "none reaches it: every front is empty.".into(),
    }
}

/// The advantage of the design `better` over the design `other` in the objective `sought`, in percent of the value of
/// `other`: `12.3 %`.
fn advantage(sought: Objective, better: &Design, other: &Design) -> String {
    let (a, b) = (sought.of(better), sought.of(other));
    let percent = 100.0 * ((a - b) / b).abs();
    percent_rounded(percent, if percent < 10.0 { 2 } else { 3 })
}
