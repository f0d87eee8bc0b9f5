//! The summary of a finished study: the question, the answer in two sentences, picks, materials and counts.

use super::budget::{PickBudget, budget_markdown, budget_text};
use super::certificate::gap_words;
use super::compare::text::short_labels;
use super::facts::SummaryFacts;
use super::front_table::FrontTable;
use super::number::{cost_words, fixed, grouped, large, percent_of, significant};
use super::picks::{
    Design, KNEE, Objective, Pick, TightestCheck, best, designs, knee, marked_choices, materials, picks,
    rows_and_names, tightest_check,
};
use super::resonance::warnings;
use super::table::{Column, Table};
use super::words::{TERMINAL, and, capital, wrap};

/// Height of the small plots on the terminal \[lines\].
const PLOT_ROWS: usize = 8;

/// The front of the designs of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialFront {
    /// Whether each design has a row of its own even if it differs from another one only in drives of equal mass and
    /// torsion curve (ties). If not, one row stands for all of them.
    pub ties_listed: bool,
    /// Name of the material.
    pub name: String,
    /// Cost of the raw material \[EUR/kg\]; `None` if it is unknown.
    pub cost_eur_per_kg: Option<f64>,
    /// How the search of this material's front ended: complete, certified, partial or infeasible.
    pub status: String,
    /// The front of the designs whose links are all of this material.
    pub front: FrontTable,
}

/// All inputs of a summary.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SummaryInput {
    /// Facts of the run.
    pub facts: SummaryFacts,
    /// Front of all designs.
    pub overall: FrontTable,
    /// Front of each material, in the study's order.
    pub materials: Vec<MaterialFront>,
    /// The stiffness budget and the lower bound on mass of each pick.
    pub budgets: Vec<PickBudget>,
}

/// The summary as a Markdown document.
pub fn summary_md(input: &SummaryInput) -> String {
    let facts = &input.facts;
    let found = Found::of(input);
    let mut out = format!("# {}\n\n{}\n\n", facts.study, facts.question);
    out.push_str(&format!("**Answer.** {}\n", answer(input, &found)));
    if !found.picks.is_empty() {
        out.push_str("\n![The front](front.svg)\n");
        out.push_str(&format!("\n## Picks\n\n{}\n", picks_table(&found.picks, MARKDOWN_PICKS).to_markdown()));
        for pick in &found.picks {
            let choices = marked_choices(&input.overall, pick.design.row, &facts.caveats).join("; ");
            out.push_str(&format!(
                "- {} ({}): {choices}{}\n",
                pick.names.join(", "),
                pick.design.design_id,
                ties(pick, &found.designs)
            ));
        }
        let tightest = tightest_words(&input.overall, &found.picks);
        if !tightest.is_empty() {
            out.push_str(&format!("\n{tightest}\n"));
        }
        let caveats = facts.caveats.sentence(&input.overall, &rows_and_names(&found.picks));
        if !caveats.is_empty() {
            out.push_str(&format!("\n{caveats}\n"));
        }
        out.push_str(KNEE_NOTE);
        let names: Vec<String> = input.materials.iter().map(|m| m.name.clone()).collect();
        if !names.is_empty() {
            out.push_str(&format!(
                "\n## Materials\n\n{}",
                materials_table(input, &names, MARKDOWN_MATERIALS).to_markdown()
            ));
            out.push_str("\nThe front of a material holds the designs whose links are all of that material. Its share is the part of the whole front that is made of it alone.\n");
            empty_fronts(input).iter().for_each(|words| out.push_str(&format!("{words}\n")));
        }
    }
    out.push_str(&budget_markdown(&input.budgets));
    out.push_str(&format!("\n## What was searched\n\n- {}\n", counts(facts)));
    out.push_str(&format!("- {}{}{}\n", TIMING[0], timing_words(facts), TIMING[1]));
    out.push_str(&format!(
        "- Constraints: {}.\n- Cases (the worst counts): {}.\n",
        listed(&facts.constraints),
        listed(&facts.cases)
    ));
    if !facts.ranges.is_empty() {
        out.push_str(&format!("- Ranges of the joints: {}.\n", listed(&facts.ranges)));
    }
    out.push_str(&section("Remarks", &facts.remarks));
    out.push_str(&section("Warnings", &warnings(&input.overall, &found.picks)));
    out.push_str(&section("Not checked", &facts.not_checked));
    if let Some(pick) = found.default_pick() {
        out.push_str(&format!("\n## Take a design out\n\n```\n{}```\n", commands(facts, pick)));
    }
    if !facts.tool_version.is_empty() {
        out.push_str(&format!("\narmwright {}\n", facts.tool_version));
    }
    out
}

/// A section of the summary with one line for each of the `lines`; empty without lines.
fn section(title: &str, lines: &[String]) -> String {
    let listed: String = lines.iter().map(|words| format!("- {words}\n")).collect();
    if listed.is_empty() { listed } else { format!("\n## {title}\n\n{listed}") }
}

const KNEE_NOTE: &str = "\nThe knee is the design nearest to the ideal point, which has the best value of every objective. Distances are\nmeasured in logarithms, each objective scaled by its range over the front.\n";

/// The summary for a terminal of 80 columns.
pub fn terminal_summary(input: &SummaryInput) -> String {
    let facts = &input.facts;
    let found = Found::of(input);
    let mut out = wrap(&format!("{}: {}", facts.study, facts.question), TERMINAL, "");
    out.push_str(&format!("\n{}", wrap(&answer(input, &found), TERMINAL, "")));
    if !found.picks.is_empty() {
        // one point makes no plot
        if found.designs.len() > 1 {
            out.push_str(&format!("\n{}", small_plots(&found.designs)));
        }
        out.push_str(&format!("\n{}", picks_table(&found.picks, TERMINAL_PICKS).to_text()));
        let tightest = tightest_words(&input.overall, &found.picks);
        if !tightest.is_empty() {
            out.push_str(&wrap(&tightest, TERMINAL, ""));
        }
        let caveats = facts.caveats.sentence(&input.overall, &rows_and_names(&found.picks));
        if !caveats.is_empty() {
            out.push_str(&wrap(&caveats, TERMINAL, ""));
        }
        let names: Vec<String> = input.materials.iter().map(|m| m.name.clone()).collect();
        if !names.is_empty() {
            out.push_str(&format!(
                "\n{}",
                materials_table(input, &short_labels(&names), TERMINAL_MATERIALS).to_text()
            ));
            empty_fronts(input).iter().for_each(|words| out.push_str(&wrap(words, TERMINAL, "")));
        }
        out.push_str(&format!("\n{}", budget_text(&input.budgets, TERMINAL)));
    }
    out.push_str(&format!("\n{}", wrap(&counts(facts), TERMINAL, "")));
    facts.remarks.iter().for_each(|words| out.push_str(&wrap(words, TERMINAL, "")));
    for words in warnings(&input.overall, &found.picks) {
        out.push_str(&wrap(&format!("{words}."), TERMINAL, ""));
    }
    if !facts.not_checked.is_empty() {
        let words = format!("Options or parts not checked: {}; see summary.md.", facts.not_checked.len());
        out.push_str(&wrap(&words, TERMINAL, ""));
    }
    if let Some(pick) = found.default_pick() {
        let (results, id) = (&facts.results, &pick.design.design_id);
        out.push_str(&format!("\narmwright design {results} {id}\narmwright compare {results}\n"));
    }
    out
}

/// The answer to the study's question in two sentences.
pub fn answer_words(input: &SummaryInput) -> String {
    answer(input, &Found::of(input))
}

/// A table of the materials side by side: size of each front, its best values, and its share of the whole front.
pub fn materials_side_by_side(input: &SummaryInput) -> Table {
    let names: Vec<String> = input.materials.iter().map(|m| m.name.clone()).collect();
    materials_table(input, &names, MARKDOWN_MATERIALS)
}

/// The front in two small plots for the terminal: tip deflection and lowest mode, both over mass.
fn small_plots(designs: &[Design]) -> String {
    let plot = |title: &str, over: Objective| {
        let points: Vec<(f64, f64)> = designs.iter().map(|d| (d.mass_kg, over.of(d))).collect();
        super::braille::plot(title, "mass [kg]", &points, TERMINAL / 2 - 1, PLOT_ROWS)
    };
    let (left, right) =
        (plot("tip deflection [mm]", Objective::Deflection), plot("lowest mode [Hz]", Objective::Mode));
    super::braille::beside(&left, &right, TERMINAL / 2)
}

/// The designs of the front and the picks among them.
struct Found {
    designs: Vec<Design>,
    picks: Vec<Pick>,
}

impl Found {
    fn of(input: &SummaryInput) -> Self {
        let designs = designs(&input.overall);
        Self { picks: picks(&designs), designs }
    }

    /// The pick that examples of commands use: the knee; `None` if the front is empty.
    fn default_pick(&self) -> Option<&Pick> {
        self.picks.iter().find(|p| p.names.contains(&KNEE))
    }
}

/// Marks before and after the timing in a summary. They allow a comparison of all other text between runs.
pub(crate) const TIMING: [&str; 2] = ["<!-- timing -->", "<!-- /timing -->"];

/// The answer to the study's question in two sentences.
fn answer(input: &SummaryInput, found: &Found) -> String {
    let facts = &input.facts;
    let Some(knee) = knee(&found.designs) else {
        return match facts.status.as_str() {
            "interrupted" | "partial" => "No design was found before the search stopped.".into(),
            _ => "No design meets the constraints.".into(),
        };
    };
    let caution = match (facts.status.as_str(), facts.gap) {
        ("certified", Some(gap)) if gap > 0.0 => {
            format!("Better designs may exist, but {}. ", gap_words(gap))
        }
        ("partial", Some(gap)) => {
            format!("The search was stopped, so better designs may exist, but {}. ", gap_words(gap))
        }
        ("interrupted" | "partial", _) => {
            "The search did not visit every design, so better ones may exist. ".to_string()
        }
        _ => String::new(),
    };
    match found.picks.as_slice() {
        [only] if found.designs.len() == 1 => format!("{caution}{}", only_design(input, only)),
        _ => format!("{caution}{} {}", winners(input, found), compromise(input, found, knee)),
    }
}

/// The only design of a front: what is achieved with which parts, and how near the drives are to their limits.
fn only_design(input: &SummaryInput, only: &Pick) -> String {
    let amounts =
        [Objective::Mass, Objective::Deflection, Objective::Mode].map(|o| o.amount(o.of(&only.design)));
    let how_many = match input.facts.designs_total {
        1 => "The study has one design",
        _ => "One design is at least as good as every other in all three objectives",
    };
    let choices = marked_choices(&input.overall, only.design.row, &input.facts.caveats);
    let parts = if choices.is_empty() { String::new() } else { format!(" It has {}.", choices.join("; ")) };
    let margin = tightest_check(&input.overall, only.design.row).map_or(String::new(), |tightest| {
        let TightestCheck { joint, check, margin } = tightest;
        let verdict = if margin < 1.0 { ", which is too little" } else { "" };
        format!(
            " Of the checks that were made, the tightest is {check} at {joint}: {} times what is needed is allowed{verdict}.",
            fixed(margin, 3)
        )
    });
    format!("{how_many}: {}.{parts}{margin}", amounts.join(", "))
}

/// The materials with the best value of each objective: `A gives the lightest arm (31 kg); B the stiffest (0.8 mm)
/// and the highest mode (40 Hz).`
fn winners(input: &SummaryInput, found: &Found) -> String {
    let sought = [
        (Objective::Mass, "the lightest arm"),
        (Objective::Deflection, "the stiffest"),
        (Objective::Mode, "the highest lowest mode"),
    ];
    let mut by_material: Vec<(String, Vec<String>)> = Vec::new();
    for (objective, words) in sought {
        let Some(design) = best(objective, &found.designs) else { continue };
        let what = format!("{words} ({})", objective.amount(objective.of(design)));
        let material = made_of(&input.overall, design.row);
        match by_material.iter_mut().find(|(m, _)| *m == material) {
            Some((_, list)) => list.push(what),
            None => by_material.push((material, vec![what])),
        }
    }
    let clauses: Vec<String> =
        by_material.iter().map(|(material, what)| format!("{material} gives {}", and(what))).collect();
    format!("{}.", capital(&clauses.join("; ")))
}

fn compromise(input: &SummaryInput, found: &Found, knee: &Design) -> String {
    let values: Vec<String> =
        [Objective::Mass, Objective::Deflection, Objective::Mode].map(|o| o.amount(o.of(knee))).into();
    let mut out = format!(
        "The knee, nearest to the best of all three, is design {} ({}): {}",
        knee.design_id,
        made_of(&input.overall, knee.row),
        values.join(", ")
    );
    let share = |(name, count): &(String, usize)| {
        format!("{} of them {name}", percent_of(*count, found.designs.len()))
    };
    if let Some(most) = owners(input).iter().max_by_key(|(_, count)| *count).filter(|(_, c)| *c > 0) {
        let size = found.designs.len();
        let designs = if size == 1 { "design" } else { "designs" };
        out.push_str(&format!("; the front has {} {designs}, {}", grouped(size as u128), share(most)));
    }
    out + "."
}

/// For each single material, and for mixed materials, the number of designs of the overall front that consist of it.
fn owners(input: &SummaryInput) -> Vec<(String, usize)> {
    let of_row: Vec<Vec<&str>> =
        (0..input.overall.rows.len()).map(|r| materials(&input.overall, r)).collect();
    let alone = |name: &str| of_row.iter().filter(|m| m.len() == 1 && m[0] == name).count();
    let mut out: Vec<(String, usize)> =
        single_materials(input).into_iter().map(|m| (m.to_string(), alone(m))).collect();
    out.push((MIXED.into(), of_row.iter().filter(|m| m.len() > 1).count()));
    out
}

/// The materials of which a whole design can consist. If the search made a front for each material, these
/// materials; otherwise those of the designs found.
pub fn single_materials(input: &SummaryInput) -> Vec<&str> {
    if !input.materials.is_empty() {
        return input.materials.iter().map(|m| m.name.as_str()).collect();
    }
    let mut names: Vec<&str> = Vec::new();
    for row in 0..input.overall.rows.len() {
        if let [one] = materials(&input.overall, row).as_slice()
            && !names.contains(one)
        {
            names.push(one);
        }
    }
    names.sort_unstable();
    names
}

const MIXED: &str = "of mixed materials";

/// The materials of a design in words.
fn made_of(front: &FrontTable, row: usize) -> String {
    match materials(front, row).as_slice() {
        [] => "this arm".into(),
        [one] => (*one).to_string(),
        several => format!("a mix of {}", and(several)),
    }
}

const MARKDOWN_PICKS: [&str; 6] =
    ["pick", "design", "mass [kg]", "tip deflection [mm]", "lowest mode [Hz]", "material cost [EUR]"];
const TERMINAL_PICKS: [&str; 6] = ["pick", "design", "mass kg", "tip mm", "mode Hz", "material EUR"];

fn picks_table(picks: &[Pick], headers: [&str; 6]) -> Table {
    let columns =
        headers.iter().enumerate().map(|(i, h)| if i < 2 { Column::left(h) } else { Column::right(h) });
    let mut table = Table::new(columns.collect());
    for Pick { names, design } in picks {
        let mut cells = vec![names.join(", "), design.design_id.clone()];
        cells.extend(
            [Objective::Mass, Objective::Deflection, Objective::Mode].map(|o| significant(o.of(design), 4)),
        );
        cells.push(known(design.material_cost_eur));
        table.row(cells);
    }
    table
}

/// A sentence that names, for each pick, the check of a drive that is nearest to its limit. Empty if the study sizes no
/// drive. The sentence shows where the drives of the catalogs, and not the tubes, decide how good a design can be.
fn tightest_words(front: &FrontTable, picks: &[Pick]) -> String {
    let words: Vec<String> = picks
        .iter()
        .filter_map(|pick| {
            let tightest = tightest_check(front, pick.design.row)?;
            let TightestCheck { joint, check, margin } = &tightest;
            Some(format!("{}: {joint} {check} {}", pick.names.join(", "), fixed(*margin, 3)))
        })
        .collect();
    match words.is_empty() {
        true => String::new(),
        false => format!("Tightest check of the drives (allowed over needed): {}.", words.join("; ")),
    }
}

const MARKDOWN_MATERIALS: [&str; 7] = [
    "material",
    "designs on its front",
    "lightest [kg]",
    "stiffest [mm]",
    "highest mode [Hz]",
    "share of the whole front",
    "material [EUR/kg]",
];
const TERMINAL_MATERIALS: [&str; 7] =
    ["material", "front", "least kg", "least mm", "most Hz", "share", "EUR/kg"];

/// The reason for each front of a material that is empty although its search ended, in sentences: some links do not
/// offer the material, or no design of this material alone meets the limits.
pub(crate) fn empty_fronts(input: &SummaryInput) -> Vec<String> {
    let reason = |material: &MaterialFront| {
        let name = &material.name;
        let stopped = ["partial", "interrupted"].contains(&material.status.as_str());
        match input.facts.materials_of_some_links.get(name) {
            _ if !material.front.rows.is_empty() => None,
            Some(links) => {
                Some(format!("No design is of {name} alone: the study does not offer it for {}.", and(links)))
            }
            None => (!stopped).then(|| format!("No design of {name} alone meets the limits.")),
        }
    };
    input.materials.iter().filter_map(reason).collect()
}

/// A table with one row per material of which a whole design can consist. The last row is for designs of mixed
/// materials.
fn materials_table(input: &SummaryInput, names: &[String], headers: [&str; 7]) -> Table {
    let columns =
        headers.iter().enumerate().map(|(i, h)| if i < 1 { Column::left(h) } else { Column::right(h) });
    let mut table = Table::new(columns.collect());
    let total = input.overall.rows.len();
    let owners = owners(input);
    let of_all_links =
        |material: &MaterialFront| !input.facts.materials_of_some_links.contains_key(&material.name);
    for ((material, name), (_, count)) in
        input.materials.iter().zip(names).zip(&owners).filter(|((material, _), _)| of_all_links(material))
    {
        let cost = known(material.cost_eur_per_kg);
        let name = match material.status.as_str() {
            "partial" | "interrupted" => &format!("{name} (stopped)"),
            _ => name,
        };
        table.row(material_cells(name, &designs(&material.front), percent_of(*count, total), cost));
    }
    let mixed = designs(&super::front_svg::mixed_designs(&input.overall));
    if !mixed.is_empty() {
        table.row(material_cells("mixed", &mixed, percent_of(mixed.len(), total), String::new()));
    }
    table
}

fn material_cells(name: &str, front: &[Design], share: String, cost: String) -> Vec<String> {
    let reach = [Objective::Mass, Objective::Deflection, Objective::Mode]
        .map(|o| best(o, front).map_or("none".into(), |d| significant(o.of(d), 4)));
    let head = [name.to_string(), grouped(front.len() as u128)];
    head.into_iter().chain(reach).chain([share, cost]).collect()
}

/// Words that say how many other designs have the same objectives as the pick; empty if there are none.
fn ties(pick: &Pick, designs: &[Design]) -> String {
    let same = |d: &&Design| Objective::ALL.iter().all(|o| o.of(d) == o.of(&pick.design));
    match designs.iter().filter(same).count() {
        0 | 1 => String::new(),
        2 => " (1 other design has the same objectives)".into(),
        n => format!(" ({} other designs have the same objectives)", n - 1),
    }
}

/// Total number of designs, and how many were evaluated and excluded, in words.
fn counts(facts: &SummaryFacts) -> String {
    if ["certified", "partial"].contains(&facts.status.as_str()) {
        return format!(
            "{} designs: {} evaluated one by one, the others discarded in groups; search {}.",
            large(facts.designs_total),
            grouped(facts.designs_evaluated),
            facts.status
        );
    }
    format!(
        "{} {}: {} evaluated, {} excluded by a limit; search {}.",
        grouped(facts.designs_total),
        if facts.designs_total == 1 { "design" } else { "designs" },
        grouped(facts.designs_evaluated),
        grouped(facts.designs_excluded),
        facts.status
    )
}

/// Number of designs, duration and rate, in words. Everything else in a summary is the same in each run of a study.
pub fn timing_words(facts: &SummaryFacts) -> String {
    let threads = match facts.threads {
        0 => String::new(),
        1 => " on 1 thread".into(),
        n => format!(" on {n} threads"),
    };
    let rate = facts.designs_evaluated as f64 / facts.elapsed_s;
    let rate = match rate.is_finite() && rate > 0.0 {
        true => format!(", {} evaluated/s", grouped(rate.round() as u128)),
        false => String::new(),
    };
    let elapsed = significant(facts.elapsed_s, 3);
    format!("{} designs in {elapsed} s{threads}{rate}", large(facts.designs_total))
}

/// The commands that extract a pick and analyse it, one per line.
fn commands(facts: &SummaryFacts, pick: &Pick) -> String {
    let (results, id) = (&facts.results, &pick.design.design_id);
    let dir = format!("{results}/design-{id}");
    format!(
        "armwright design {results} {id}\n\
         armwright analyze {dir}/arm.json --cases {dir}/cases.json\n\
         armwright compare {results}\n"
    )
}

fn known(value: Option<f64>) -> String {
    value.map_or("unknown".into(), cost_words)
}

fn listed(words: &[String]) -> String {
    if words.is_empty() { "none".into() } else { words.join("; ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_design_is_answered_with_its_parts_and_a_margin_below_one_is_called_too_little() {
        let words = |row: &str| row.split(';').map(String::from).collect::<Vec<_>>();
        let answer = |margin: &str| {
            let row = format!("x0;CSG-20-100;M;{margin};gear mean;1.5;20;30");
            let overall = FrontTable {
                columns: words(
                    "design_id;j1_gear;j1_motor;j1_margin;j1_binds;tip_deflection_mm;mass_kg;lowest_mode_hz",
                ),
                rows: vec![words(&row)],
            };
            let facts =
                SummaryFacts { designs_total: 1, status: "complete".into(), ..SummaryFacts::default() };
            answer_words(&SummaryInput { facts, overall, ..SummaryInput::default() })
        };
        let holds = answer("1.25");
        assert!(holds.starts_with("The study has one design: 20.00 kg"), "{holds}");
        assert!(holds.contains("It has j1 CSG-20-100 + M."), "{holds}");
        assert!(holds.ends_with("gear mean at j1: 1.250 times what is needed is allowed."), "{holds}");
        assert!(answer("0.8").ends_with("0.800 times what is needed is allowed, which is too little."));
    }
}
