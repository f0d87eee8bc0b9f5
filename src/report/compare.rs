//! Fronts side by side: which is lightest at a given deflection, stiffest or fastest at a given mass,
//! lightest for a given lowest mode, and what the material costs.
//!
//! A *contender* is a front with a label: one material of a study, or one of several results. The
//! front of all materials mixed is at least as good as each of them, so it stands beside the
//! competition as a reference and wins nothing. Every function here is pure; [`text`] writes the
//! comparison for people, [`thresholds`] chooses round limits where the user gives none, [`moved`]
//! tells what changed between two runs of a study.

pub mod changes;
pub mod moved;
pub mod text;
pub mod thresholds;

use super::front_table::FrontTable;
use super::number::significant;
use super::picks::{Design, Objective, best, designs};
use serde::Serialize;
pub use thresholds::Thresholds;

/// A front that takes part in a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Contender {
    /// Name of the material or of the result.
    pub label: String,
    /// Its designs.
    pub front: FrontTable,
    /// Whether it only stands beside the others: the front of all materials mixed.
    pub reference: bool,
}

impl Contender {
    /// A front that competes.
    pub fn new(label: &str, front: FrontTable) -> Self {
        Self { label: label.to_string(), front, reference: false }
    }
}

/// What is asked of every front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    /// The smallest mass, the tip deflection being at most the limit.
    LightestAtDeflection,
    /// The smallest tip deflection, the mass being at most the limit.
    StiffestAtMass,
    /// The highest lowest mode, the mass being at most the limit.
    HighestModeAtMass,
    /// The smallest mass, the lowest mode being at least the limit.
    LightestAtMode,
}

impl Question {
    /// All questions that have a limit.
    pub const ALL: [Self; 4] =
        [Self::LightestAtDeflection, Self::StiffestAtMass, Self::HighestModeAtMass, Self::LightestAtMode];

    /// What is made best.
    pub fn sought(self) -> Objective {
        match self {
            Self::LightestAtDeflection | Self::LightestAtMode => Objective::Mass,
            Self::StiffestAtMass => Objective::Deflection,
            Self::HighestModeAtMass => Objective::Mode,
        }
    }

    /// What is limited.
    pub fn limited(self) -> Objective {
        match self {
            Self::LightestAtDeflection => Objective::Deflection,
            Self::StiffestAtMass | Self::HighestModeAtMass => Objective::Mass,
            Self::LightestAtMode => Objective::Mode,
        }
    }

    /// The word in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::LightestAtDeflection => "lightest_at_deflection",
            Self::StiffestAtMass => "stiffest_at_mass",
            Self::HighestModeAtMass => "highest_mode_at_mass",
            Self::LightestAtMode => "lightest_at_mode",
        }
    }

    /// The limit in words: `tip deflection at most 2 mm`.
    pub fn limit_words(self, limit: f64) -> String {
        let limit = plain(limit);
        match self.limited() {
            Objective::Deflection => format!("tip deflection at most {limit} mm"),
            Objective::Mass => format!("mass at most {limit} kg"),
            Objective::Mode => format!("lowest mode at least {limit} Hz"),
        }
    }

    fn holds(self, limit: f64, design: &Design) -> bool {
        let value = self.limited().of(design);
        if self.limited() == Objective::Mode { value >= limit } else { value <= limit }
    }
}

/// What one front answers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// Label of the front.
    pub label: String,
    /// Whether a design of the front keeps the limit.
    pub reached: bool,
    /// Whether no other competing front has a better answer.
    pub winner: bool,
    /// Whether the front only stands beside the others.
    pub reference: bool,
    /// The best design, or, where none keeps the limit, the one that comes nearest to it; `None` if the
    /// front is empty.
    pub design: Option<Design>,
}

/// All answers to one question at one limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The question.
    pub question: Question,
    /// Its limit \[mm, kg or Hz\].
    pub limit: f64,
    /// One answer a front, in the order of the contenders.
    pub answers: Vec<Answer>,
    /// Which wins and by how much, in a sentence.
    pub sentence: String,
}

/// The best that one front reaches in each objective, without any limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reach {
    /// Label of the front.
    pub label: String,
    /// Whether the front only stands beside the others.
    pub reference: bool,
    /// Number of its designs.
    pub designs: usize,
    /// The lightest design.
    pub lightest: Option<Design>,
    /// The stiffest design.
    pub stiffest: Option<Design>,
    /// The design with the highest lowest mode.
    pub highest_mode: Option<Design>,
}

/// Fronts side by side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The best of each front, in the order of the contenders.
    pub reach: Vec<Reach>,
    /// One row a question and limit.
    pub rows: Vec<Row>,
    /// What moved from the first result to each other one, where they are runs of one study.
    pub moved: Vec<moved::Moved>,
}

/// Puts fronts side by side; limits that are not given are chosen.
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
    let value = amount(sought, sought.of(best));
    let cost = best.material_cost_eur.map_or(String::new(), |c| format!(", material {} EUR", cost_words(c)));
    let lead = match reached.get(winners.len()) {
        Some((a, second)) => format!(
            ", {} {} than {} ({})",
            percent(sought, best, second),
            comparative(question),
            a.label,
            amount(sought, sought.of(second))
        ),
        None if winners.len() == 1 && answers.iter().filter(|a| !a.reference).count() > 1 => {
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

/// What the reference front reaches, where it beats the winner.
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
            amount(sought, sought.of(d)),
            percent(sought, d, winner),
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
            format!("none reaches it; nearest is {} with {}.", a.label, amount(limited, limited.of(d)))
        }
        None => "none reaches it: every front is empty.".into(),
    }
}

/// How much better a design is than another, as a share of the other: `12.3 %`.
fn percent(sought: Objective, better: &Design, other: &Design) -> String {
    let (a, b) = (sought.of(better), sought.of(other));
    let percent = 100.0 * ((a - b) / b).abs();
    format!("{} %", significant(percent, if percent < 10.0 { 2 } else { 3 }))
}

fn superlative(question: Question, several: bool) -> &'static str {
    match (question.sought(), several) {
        (Objective::Mass, false) => "is lightest",
        (Objective::Mass, true) => "are lightest",
        (Objective::Deflection, false) => "is stiffest",
        (Objective::Deflection, true) => "are stiffest",
        (Objective::Mode, false) => "has the highest lowest mode",
        (Objective::Mode, true) => "have the highest lowest mode",
    }
}

fn comparative(question: Question) -> &'static str {
    match question.sought() {
        Objective::Mass => "lighter",
        Objective::Deflection => "less",
        Objective::Mode => "higher",
    }
}

/// A value with four digits and its unit.
fn amount(objective: Objective, value: f64) -> String {
    format!("{} {}", significant(value, 4), objective.unit())
}

/// A limit as it was given.
fn plain(value: f64) -> String {
    super::number::shortest(value)
}

/// A cost with three digits, whole above 100.
pub fn cost_words(value: f64) -> String {
    if value.abs() >= 100.0 { format!("{value:.0}") } else { significant(value, 3) }
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}
