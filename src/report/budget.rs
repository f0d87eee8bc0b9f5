//! The stiffness budget of a front's picks as words, tables and CSV. It tells how much one more kilogram changes
//! deflection and lowest mode at each joint and link, and how much heavier each pick is than the lower bound on
//! mass.

use super::number::{fixed, percent, shortest, significant};
use super::picks::KNEE;
use super::section::PageSection;
use super::table::{Column, Table, csv_line};
use super::words::wrap;

/// Change of deflection and lowest mode per kilogram added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Change of the tip's deflection \[mm/kg\]; negative is better.
    pub mm_per_kg: f64,
    /// Change of the lowest mode \[Hz/kg\]; positive is better.
    pub hz_per_kg: f64,
}

impl Gain {
    /// Whether one more kilogram lowers the deflection or raises the lowest mode by more than rounding errors.
    pub fn helps(&self) -> bool {
        self.mm_per_kg < -LEAST_CHANGE_PER_KG || self.hz_per_kg > LEAST_CHANGE_PER_KG
    }
}

/// A heavier part that may replace the part of a piece.
#[derive(Debug, Clone, PartialEq)]
pub struct NextPart {
    /// Name of the gear, or size and material of the tube.
    pub name: String,
    /// Mass of the piece with the new part \[kg\].
    pub mass_kg: f64,
    /// Change of deflection and lowest mode per kilogram that the new part adds.
    pub gain: Gain,
}

/// Kind of the piece in a row of a budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PieceKind {
    /// A joint: its drive, with the masses that belong to it.
    Joint,
    /// The output bearing of a joint, or the guide of a prismatic joint. It has its own share of the deflection. Its
    /// mass and its changes per kilogram are included in those of the joint.
    Bearing,
    /// A link: its tube.
    Link,
}

impl PieceKind {
    fn word(self) -> &'static str {
        match self {
            Self::Joint => "joint",
            Self::Bearing => "bearing",
            Self::Link => "link",
        }
    }
}

/// One piece of an arm, and the effect of one more kilogram at this piece.
#[derive(Debug, Clone, PartialEq)]
pub struct BudgetRow {
    /// Name of the joint, of the output bearing (`NAME.bearing`), of the guide (`NAME.guide`) or of the link.
    pub piece: String,
    /// Kind of the piece.
    pub kind: PieceKind,
    /// Mass of the piece \[kg\]; 0 for a bearing, whose mass is included in that of its joint.
    pub mass_kg: f64,
    /// Share of the piece in the tip deflection of the worst case, from 0 to 1; negative if the piece reduces the
    /// deflection.
    pub share: f64,
    /// Changes of deflection and lowest mode per kilogram if mass and stiffness of the piece grow in proportion; `None`
    /// for a bearing, which grows with its joint.
    pub in_place: Option<Gain>,
    /// The heavier part that lowers the deflection most per kilogram; `None` if no part helps.
    pub next_part: Option<NextPart>,
}

/// Lower bounds on the mass of a design that is as good as a pick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PickBound {
    /// Lower bound: no design of the study that is at least as stiff and has at least as high a lowest mode
    /// weighs less \[kg\].
    pub mass_kg: f64,
    /// Approximate mass of an equally good arm if parts could be blended between catalog options \[kg\]. It is at most
    /// `mass_kg`, the bound.
    pub mixture_kg: f64,
    /// Whether the torque of some joint may have either sign within the options that the bound considers. The bound
    /// then takes the more favourable sign and is weaker.
    pub loads_oppose: bool,
}

/// The stiffness budget of one pick.
#[derive(Debug, Clone, PartialEq)]
pub struct PickBudget {
    /// What the design was picked for: lightest, stiffest, highest mode, knee.
    pub names: Vec<&'static str>,
    /// Name of the design.
    pub design_id: String,
    /// Mass of the design \[kg\].
    pub mass_kg: f64,
    /// Mass of the joints in addition to drives and bearings \[kg\]; it is included in `mass_kg`.
    pub extras_mass_kg: f64,
    /// Lower bounds on the mass of an equally good design; `None` if they could not be computed.
    pub bound: Option<PickBound>,
    /// One row for each joint and link that has mass, and for each bearing or guide that is compliant, from base to
    /// tip.
    pub rows: Vec<BudgetRow>,
}

impl PickBudget {
    /// How much heavier the pick is than a design with the mass `mass_kg` \[kg\], in percent of this mass.
    fn above_percent(&self, mass_kg: f64) -> f64 {
        100.0 * (self.mass_kg / mass_kg - 1.0)
    }

    /// The fraction of the tip deflection that joints and their bearings cause together, from 0 to 1.
    fn joints_share(&self) -> f64 {
        self.rows.iter().filter(|r| r.kind != PieceKind::Link).map(|r| r.share).sum()
    }

    /// The piece of this kind (joints, or links) at which one more kilogram reduces the tip deflection most, with the
    /// changes per kilogram; `None` if the arm has no such piece.
    fn best(&self, kind: PieceKind) -> Option<(&BudgetRow, Gain)> {
        let of_kind = self.rows.iter().filter(|r| r.kind == kind).filter_map(|r| Some((r, r.in_place?)));
        of_kind.min_by(|a, b| a.1.mm_per_kg.total_cmp(&b.1.mm_per_kg))
    }

    fn title(&self) -> String {
        format!("{} ({})", self.names.join(", "), self.design_id)
    }

    /// A sentence that says at which joint or link of this pick mass should be added first.
    fn advice(&self) -> String {
        let lead = format!(
            "{}: joints give {} of the tip's deflection",
            self.title(),
            percent(100.0 * self.joints_share(), 0)
        );
        let (joint, link) = (self.best(PieceKind::Joint), self.best(PieceKind::Link));
        let [first, second] = match (joint, link) {
            (Some((_, j)), Some((_, l))) if l.mm_per_kg < j.mm_per_kg => [link, joint],
            (None, _) => [link, joint],
            _ => [joint, link],
        };
        match (first, second) {
            (Some((best, gain)), other) if gain.mm_per_kg < 0.0 => {
                let other = other.map_or(String::new(), |(row, gain)| self.elsewhere(row, &gain));
                let place = if best.kind == PieceKind::Joint { "the drive of" } else { "the link" };
                format!(
                    "{lead}; add mass first to {place} {}, where it {}{other}.{}",
                    best.piece,
                    effect(&gain),
                    self.mode_advice(best)
                )
            }
            _ => format!("{lead}; added mass does not reduce the deflection anywhere."),
        }
    }

    /// Words on the other kind of piece (links if the sentence is about a joint, and joints if it is about a link).
    /// `row` is the best piece of this kind, and `gain` is what one more kilogram changes there. If more mass raises
    /// the deflection at every piece of this kind, the words name a heavier catalog part that lowers it.
    fn elsewhere(&self, row: &BudgetRow, gain: &Gain) -> String {
        let kind = row.kind.word();
        if gain.mm_per_kg <= 0.0 {
            return format!("; at the best {kind} ({}) it {}", row.piece, effect(gain));
        }
        let of_kind = self.rows.iter().filter(|r| r.kind == row.kind);
        let helps =
            of_kind.filter_map(|r| Some((r, r.next_part.as_ref()?))).filter(|(_, n)| n.gain.mm_per_kg < 0.0);
        let best = helps.min_by(|a, b| a.1.gain.mm_per_kg.total_cmp(&b.1.gain.mm_per_kg));
        let next = best.map_or(String::new(), |(r, next)| {
            format!(", but the next part for {} ({}) {}", r.piece, next.name, effect(&next.gain))
        });
        format!("; at every {kind}, more of the same raises the deflection{next}")
    }

    /// A sentence that names the piece at which one more kilogram raises the lowest mode most. It is empty if `told` is
    /// that piece, because an earlier sentence has named it.
    fn mode_advice(&self, told: &BudgetRow) -> String {
        let rises = self.rows.iter().filter_map(|r| Some((r, r.in_place?.hz_per_kg)));
        let best = rises.max_by(|a, b| a.1.total_cmp(&b.1));
        best.filter(|(row, hz)| row.piece != told.piece && *hz > LEAST_CHANGE_PER_KG).map_or(
            String::new(),
            |(row, hz)| {
                format!(" The lowest mode rises most at {}, by {} Hz/kg.", row.piece, significant(hz, 2))
            },
        )
    }

    /// The pick with its mass and its lower bounds on mass, as an object for `run.json`.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::json!({
            "names": self.names,
            "design_id": self.design_id,
            "mass_kg": self.mass_kg,
            "extras_mass_kg": self.extras_mass_kg,
            "mass_lower_bound_kg": self.bound.map(|b| b.mass_kg),
            "mixture_kg": self.bound.map(|b| b.mixture_kg),
            "loads_oppose": self.bound.map(|b| b.loads_oppose),
        })
    }
}

/// Changes per kilogram below this are rounding errors \[mm/kg or Hz/kg\].
const LEAST_CHANGE_PER_KG: f64 = 1e-6;

/// The change of deflection and lowest mode in words:
/// `lowers the deflection by 0.021 mm/kg and raises the mode by 0.40 Hz/kg`. The numbers are rates, because a kilogram
/// may be more than the piece weighs.
fn effect(gain: &Gain) -> String {
    let part = |change: f64, what: &str, unit: &str| {
        if change.abs() < LEAST_CHANGE_PER_KG {
            return format!("does not change the {what}");
        }
        let verb = if change < 0.0 { "lowers" } else { "raises" };
        format!("{verb} the {what} by {} {unit}", significant(change.abs(), 2))
    };
    format!("{} and {}", part(gain.mm_per_kg, "deflection", "mm/kg"), part(gain.hz_per_kg, "mode", "Hz/kg"))
}

/// The pick whose budget the terminal shows: the knee, or the last pick if there is no knee; `None` without budgets.
fn shown(budgets: &[PickBudget]) -> Option<&PickBudget> {
    budgets.iter().find(|b| b.names.contains(&KNEE)).or(budgets.last())
}

/// A change per kilogram with its sign, in at most seven characters if its magnitude is below 1000.
fn signed(value: f64) -> String {
    let text = if value.abs() < 0.1 { fixed(value, 4) } else { significant(value, 3) };
    let rises = value > 0.0 && text.bytes().any(|b| (b'1'..=b'9').contains(&b));
    if rises { format!("+{text}") } else { text }
}

const FULL_HEADERS: [&str; 9] = [
    "piece",
    "mass [kg]",
    "share of deflection [%]",
    "tip [mm/kg]",
    "mode [Hz/kg]",
    "next part to buy",
    "adds [kg]",
    "with it: tip [mm/kg]",
    "mode [Hz/kg]",
];
const NARROW_HEADERS: [&str; 9] =
    ["piece", "mass kg", "% of tip", "mm/kg", "Hz/kg", "", "next: kg", "mm/kg", "Hz/kg"];

/// The stiffness budget of a pick as a table, with `headers` as the headers of its columns. A column with an empty
/// header is left out.
fn budget_table(pick: &PickBudget, headers: [&str; 9]) -> Table {
    let shown: Vec<usize> = (0..headers.len()).filter(|&i| !headers[i].is_empty()).collect();
    let words = |i: usize| i == 0 || i == 5;
    let column = |&i: &usize| if words(i) { Column::left(headers[i]) } else { Column::right(headers[i]) };
    let mut table = Table::new(shown.iter().map(column).collect());
    for row in &pick.rows {
        let next = row.next_part.as_ref();
        let of_next =
            |cell: fn(&NextPart, &BudgetRow) -> String| next.map_or(String::new(), |n| cell(n, row));
        let cells = [
            row.piece.clone(),
            row.in_place.map_or(String::new(), |_| significant(row.mass_kg, 4)),
            fixed(100.0 * row.share, 1),
            row.in_place.map_or(String::new(), |gain| signed(gain.mm_per_kg)),
            row.in_place.map_or(String::new(), |gain| signed(gain.hz_per_kg)),
            match (next, row.kind) {
                (Some(next), _) => next.name.clone(),
                (None, PieceKind::Bearing) => "with its joint".into(),
                (None, _) => "none".into(),
            },
            of_next(|n, row| significant(n.mass_kg - row.mass_kg, 3)),
            of_next(|n, _| signed(n.gain.mm_per_kg)),
            of_next(|n, _| signed(n.gain.hz_per_kg)),
        ];
        table.row(shown.iter().map(|&i| cells[i].clone()));
    }
    table
}

/// A table of the mass of each pick and of how far it is above its lower bound. `None` if a bound is not known.
fn bounds_table(budgets: &[PickBudget]) -> Option<Table> {
    let mut table = Table::new(vec![
        Column::left("pick"),
        Column::right("mass kg"),
        Column::right("lower bound"),
        Column::right("above %"),
        Column::right("mixture"),
    ]);
    for pick in budgets {
        let bound = pick.bound?;
        let mark = if bound.loads_oppose { " *" } else { "" };
        table.row([
            format!("{}{mark}", pick.names.join(", ")),
            significant(pick.mass_kg, 4),
            significant(bound.mass_kg, 4),
            fixed(pick.above_percent(bound.mass_kg), 1),
            significant(bound.mixture_kg, 4),
        ]);
    }
    (!table.rows().is_empty()).then_some(table)
}

const BOUND_WORDS: &str = "Lower bound: no arm of this study that is as stiff and has as high a lowest mode weighs less. It is \
                           proved without visiting designs and may be far too low: where the search is complete, no \
                           design as good as a pick weighs less than the pick itself. \
                           Mixture: the mass if parts could be blended between catalog options.";
const OPPOSED_WORDS: &str = "* Loads may oppose each other, which weakens the bound.";
const IN_PLACE_WORDS: &str = "Changes per kilogram added to a piece whose stiffness grows in proportion; a negative number \
                              lowers the tip's deflection. Next part: the heavier catalog part that improves deflection or \
                              mode most per kilogram, with all other parts unchanged. The mass of a joint is that of its drive, bearing and extras \
                              (housing, brake, encoders, flange, cables).";

fn opposed(budgets: &[PickBudget]) -> bool {
    budgets.iter().any(|b| b.bound.is_some_and(|b| b.loads_oppose))
}

/// The stiffness budget as a part of the summary on the terminal, within `width` columns: the budget of the knee and
/// the bounds of all picks.
pub fn budget_text(budgets: &[PickBudget], width: usize) -> String {
    let Some(pick) = shown(budgets) else { return String::new() };
    let mut out = format!("What one more kilogram buys at each joint and link: {}\n", pick.title());
    out.push_str(&budget_table(pick, NARROW_HEADERS).to_text());
    out.push_str(&wrap(&pick.advice(), width, ""));
    if let Some(table) = bounds_table(budgets) {
        out.push_str(&format!("\n{}", table.to_text()));
        out.push_str(&wrap(BOUND_WORDS, width, ""));
        if opposed(budgets) {
            out.push_str(&format!("{OPPOSED_WORDS}\n"));
        }
    }
    out
}

/// The stiffness budgets of the picks as a section of `summary.md`; empty if there are none.
pub fn budget_markdown(budgets: &[PickBudget]) -> String {
    if budgets.is_empty() {
        return String::new();
    }
    let mut out = String::from("\n## Stiffness budget\n\n");
    budgets.iter().for_each(|pick| out.push_str(&format!("- {}\n", pick.advice())));
    for pick in budgets {
        out.push_str(&format!("\n{}:\n\n{}", pick.title(), budget_table(pick, FULL_HEADERS).to_markdown()));
    }
    out.push_str(&format!("\n{IN_PLACE_WORDS}\n"));
    if let Some(table) = bounds_table(budgets) {
        out.push_str(&format!("\n## How light could they be?\n\n{}\n{BOUND_WORDS}\n", table.to_markdown()));
        if opposed(budgets) {
            out.push_str(&format!("\n{}\n", OPPOSED_WORDS.replace('*', "\\*")));
        }
    }
    out
}

/// The stiffness budgets of the picks as a section of the study page; `None` if there are none.
pub fn budget_extra(budgets: &[PickBudget]) -> Option<PageSection> {
    let mut tables: Vec<(String, Table)> = budgets
        .iter()
        .map(|pick| {
            (format!("What one more kilogram buys: {}", pick.title()), budget_table(pick, FULL_HEADERS))
        })
        .collect();
    let mut words: Vec<String> = budgets.iter().map(PickBudget::advice).collect();
    words.push(IN_PLACE_WORDS.into());
    if let Some(table) = bounds_table(budgets) {
        let note = if opposed(budgets) { format!(" {OPPOSED_WORDS}") } else { String::new() };
        tables.push((format!("How light could the picks be? {BOUND_WORDS}{note}"), table));
    }
    (!budgets.is_empty()).then(|| PageSection {
        title: "Stiffness budget".into(),
        words,
        tables,
        ..PageSection::default()
    })
}

/// The stiffness budgets of the picks as the content of `budget.csv`.
pub fn budget_csv(budgets: &[PickBudget]) -> String {
    let header = [
        "pick",
        "design_id",
        "piece",
        "kind",
        "mass_kg",
        "share_of_deflection",
        "in_place_mm_per_kg",
        "in_place_hz_per_kg",
        "next_part",
        "next_mass_kg",
        "next_mm_per_kg",
        "next_hz_per_kg",
    ];
    let mut out = csv_line(&header.map(String::from));
    for pick in budgets {
        for row in &pick.rows {
            let mut cells = vec![
                pick.names.join(", "),
                pick.design_id.clone(),
                row.piece.clone(),
                row.kind.word().to_string(),
            ];
            cells.extend([row.mass_kg, row.share].map(shortest));
            let in_place = row.in_place.map(|gain| [gain.mm_per_kg, gain.hz_per_kg].map(shortest));
            cells.extend(in_place.unwrap_or_default());
            match &row.next_part {
                Some(next) => {
                    cells.push(next.name.clone());
                    let numbers = [next.mass_kg, next.gain.mm_per_kg, next.gain.hz_per_kg];
                    cells.extend(numbers.map(shortest));
                }
                None => cells.extend(["", "", "", ""].map(String::from)),
            }
            out.push_str(&csv_line(&cells));
        }
    }
    out
}
