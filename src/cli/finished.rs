//! The output of a finished search: its files, the page for a browser, and the text for the terminal.

use super::exit::Exit;
use super::extra_files::{ExtraFiles, say_missing};
use super::failure::Failure;
use super::manifest::{FRONT, Files, OF_A_RUN, PICTURE, RUN, STUDY, SUMMARY, hash};
use super::progress::Progress;
use super::setup::Setup;
use super::stop::stop_if_wanted;
use super::supplements::{Found, SupplementArgs};
use crate::catalog::Catalogs;
use crate::pareto::hypervolume::front_hypervolume;
use crate::report::budget::{PickBudget, budget_csv};
use crate::report::certificate::certificate_section;
use crate::report::facts::{SummaryFacts, constraint_words};
use crate::report::file_names::file_names;
use crate::report::front_svg::{FrontPicture, PlottedFront, designs_of, mixed_designs};
use crate::report::front_table::FrontTable;
use crate::report::html::gallery::Page;
use crate::report::html::study::StudyPage;
use crate::report::key_words::key_words;
use crate::report::number::significant;
use crate::report::picks;
use crate::report::section::PageSection;
use crate::report::summary::{
    MaterialFront, SummaryInput, single_materials, summary_md, terminal_summary, timing_words,
};
use crate::report::supplement::Supplement;
use crate::search::near::NearDesigns;
use crate::search::sweep::Status;
use crate::space::design_space::DesignSpace;
use crate::space::problem::ArmProblem;
use crate::study::asked::Asked;
use crate::study::budget::budgets;
use crate::study::definition::Study;
use crate::study::effects::Correction;
use crate::study::effects::corrections_json;
use crate::study::front_remarks::{caveats_of, caveats_on, effects_json, judged_cases, table_and_remarks};
use crate::study::outcome::StudyOutcome;
use crate::study::page::study_page;
use crate::study::partial_materials::links_without;
use crate::study::range::range_words;
use crate::study::table::front_table;
use crate::study::ties::ties;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// A function that writes files as a result and replaces the result that was written before. It returns the names of
/// files that it did not write, because files with these names exist that are not part of a result.
pub(super) type Keep<'a> = dyn Fn(&[(String, Vec<u8>)]) -> Result<Vec<String>, Failure> + Sync + 'a;

/// A finished search whose files are written.
pub(super) struct Written {
    /// Name and contents of each file.
    pub files: Files,
    /// Text for the terminal.
    pub terminal: String,
    /// Table of the front of all designs.
    pub front: FrontTable,
    /// How the search ended.
    pub status: Status,
    /// Exit status with which the program ends.
    pub exit: Exit,
    /// Whether only the front was written, because the user stopped the program.
    pub is_front_only: bool,
    /// One line on how long the search took.
    pub timing: String,
    /// Optimality gap that was proved, as a fraction; 0 means that the front is whole. `None` for an exhaustive search,
    /// or if no gap was proved.
    pub gap: Option<f64>,
    /// Whether no design is missing in the front.
    pub is_whole: bool,
    /// Mass up to which no design of the front is missing \[kg\]. `None` if this is not proved, or if the study does
    /// not limit the mass.
    pub proved_to_mass_kg: Option<f64>,
    /// The state of the search at its end.
    pub progress: Progress,
    /// Time that the search took \[s\].
    pub elapsed_s: f64,
}

/// Text that `run.json` has under `not_written` while only the front is written. It stands for all files that are made
/// after the front.
pub(super) const NOTHING_ELSE: &str =
    "what goes with the front: budget.csv, summary.md, report.html, plots, ties and supplements";

/// Name of the file with the front of one material. `file` is the short name of the material.
pub(super) fn front_of_material(file: &str) -> String {
    format!("front.{file}.csv")
}

/// Whether a file of this name contains the front of one material.
pub(super) fn is_front_of_material(name: &str) -> bool {
    name.starts_with("front.") && name.ends_with(".csv") && name != FRONT
}

/// The facts that an exact search proved about its front.
#[derive(Debug, Clone, Copy)]
pub(super) struct FoundExactly {
    /// Number of boxes whose bounds were computed, and number of boxes that were left open.
    pub boxes: [u64; 2],
    /// Optimality gap that was proved, as a fraction; 0 if the front is whole, `None` if no gap was proved.
    pub gap: Option<f64>,
    /// Whether each design has a row of its own even if it differs from another one only in drives of equal mass and
    /// torsion curve (ties). If not, one row stands for all of them.
    pub ties_listed: bool,
}

/// A finished search, with everything that is needed to write its result.
pub(super) struct Finished<'a> {
    pub study: &'a Study,
    /// Text of the study's file.
    pub text: &'a str,
    /// Corrections of a measured arm.
    pub corrections: &'a [Correction],
    /// The search problem, either with all options of the study or with only those options that the designs of the
    /// front use.
    pub problem: &'a ArmProblem<'a>,
    /// The space with all options of the study.
    pub whole: &'a DesignSpace,
    /// The fronts that were found.
    pub outcome: &'a StudyOutcome,
    /// The near designs that an exact search listed; `None` if it was not asked for them, or could not list them.
    pub near: Option<&'a NearDesigns>,
    /// The facts that an exact search proved about its front; `None` if every design was visited.
    pub exact: Option<FoundExactly>,
    /// Time that the search took \[s\].
    pub elapsed_s: f64,
    pub setup: Setup<'a>,
    /// Folder of the result.
    pub dir: &'a Path,
}

/// The result of a search that visited every design.
pub(super) struct Visited<'a> {
    pub problem: &'a ArmProblem<'a>,
    pub outcome: &'a StudyOutcome,
    /// Time that the search took \[s\].
    pub elapsed_s: f64,
}

impl<'a> Finished<'a> {
    /// A finished search that visited every design of a study, on one computer or in shards. `dir` is the folder of
    /// results.
    pub(super) fn visit(asked: &'a Asked, visited: Visited<'a>, dir: &'a Path, setup: Setup<'a>) -> Self {
        let Asked { study, text, corrections } = asked;
        let Visited { problem, outcome, elapsed_s } = visited;
        let whole = &study.space;
        let (near, exact) = (None, None);
        Self { study, text, corrections, problem, whole, outcome, near, exact, elapsed_s, setup, dir }
    }
}

impl Finished<'_> {
    /// Writes the front first. Then computes the other files and writes them too, unless `stop` is set. If one of
    /// these files cannot be made, it is left out with a warning, and the front stays.
    ///
    /// # Errors
    /// The front cannot be written, or the user stops the work on the other files.
    pub(super) fn keep(
        &self,
        asked: &SupplementArgs,
        stop: &AtomicBool,
        keep: &Keep,
    ) -> Result<Written, Failure> {
        let mut summary = self.summary();
        let tables = self.tables(&summary);
        let mut first = tables.clone();
        first.push((RUN.into(), pretty(&self.run_json(&summary, &[], &[NOTHING_ELSE.to_string()]))));
        let mut left_out = keep(&first)?;
        let (mut files, mut supplements, mut extra) = (first, Vec::new(), ExtraFiles::default());
        stop_if_wanted("front");
        // a user who wants to stop gets the front at once, and nothing that takes longer
        let is_front_only = stop.load(Ordering::Relaxed);
        if !is_front_only {
            let (problem, catalogs) = (self.problem, self.setup.catalogs);
            let budgets =
                extra.make("budget.csv", || budgets(problem, self.whole, catalogs, &summary.overall));
            summary.budgets = budgets.unwrap_or_default();
            supplements = self.supplements(asked, stop, &summary, &mut extra)?;
            let run = self.fill(&summary, &supplements, &mut extra);
            let mut all = [tables, std::mem::take(&mut extra.files)].concat();
            all.push((RUN.into(), pretty(&run)));
            match keep(&all) {
                Ok(names) => (left_out, files) = (names, all),
                Err(e) => extra.missing.push(format!("what goes with the front: {e}")),
            }
        }
        let terminal = extra.make("the summary on the terminal", || terminal_summary(&summary));
        say_missing(&extra.missing_with(&left_out), self.setup.log);
        files.retain(|(name, _)| !left_out.contains(name));
        let paragraphs = supplements.iter().map(|s| &s.terminal).filter(|text| !text.is_empty());
        let paragraphs: String = paragraphs.map(|text| format!("\n{text}")).collect();
        Ok(Written {
            files,
            terminal: terminal.unwrap_or_default() + &paragraphs,
            status: self.outcome.sweep.status,
            exit: Exit::Done,
            is_front_only,
            timing: format!("{}\n", timing_words(&summary.facts)),
            gap: summary.facts.gap,
            is_whole: summary.facts.is_whole(),
            proved_to_mass_kg: self.proved_to_mass_kg(&summary.facts),
            progress: self.progress(&summary.facts),
            elapsed_s: self.elapsed_s,
            front: summary.overall,
        })
    }

    /// Computes the supplements that the user asked for, such as near designs, and adds their files to `extra`.
    ///
    /// # Errors
    /// The user stopped the computation.
    fn supplements(
        &self,
        asked: &SupplementArgs,
        stop: &AtomicBool,
        summary: &SummaryInput,
        extra: &mut ExtraFiles,
    ) -> Result<Vec<Supplement>, Failure> {
        let Self { problem, outcome, near, setup: Setup { catalogs, .. }, .. } = *self;
        let (is_exact, ties_listed) = (self.exact.is_some(), self.ties_listed());
        let found = Found { problem, catalogs, outcome, near, is_exact, ties_listed, stop };
        let what = "what was asked for in addition to the front";
        let supplements = extra.make(what, || asked.work_out(&found, &summary.overall));
        let supplements = supplements.transpose()?.unwrap_or_default();
        let listed = supplements.iter().filter_map(|s| s.file.clone());
        extra.files.extend(listed.map(|(name, bytes)| (name.to_string(), bytes)));
        Ok(supplements)
    }

    /// Makes the tables, the picture, the summary and the page, and adds them to `extra`. Returns the content of
    /// `run.json`.
    fn fill(&self, summary: &SummaryInput, supplements: &[Supplement], extra: &mut ExtraFiles) -> Value {
        for (file, of) in self.file_names().iter().zip(&self.outcome.by_material) {
            if !of.ties_listed {
                extra.file(&format!("ties.{file}.csv"), || ties(self.problem, &of.front).to_csv());
            }
        }
        extra.file("budget.csv", || budget_csv(&summary.budgets).into_bytes());
        let picture = extra.make(PICTURE, || picture(summary)).unwrap_or_default();
        if !picture.is_empty() {
            extra.files.push((PICTURE.into(), picture.clone().into_bytes()));
        }
        let markdown: String = supplements.iter().map(|s| s.markdown.as_str()).collect();
        extra.file(SUMMARY, || (summary_md(summary) + &markdown).into_bytes());
        let run = self.run_json(summary, supplements, &extra.missing);
        let sections = supplements.iter().filter_map(|s| s.section.clone()).collect();
        let page = extra.make("report.html and plots", || self.page(summary, picture, sections, &run));
        extra.files.extend(page.map(Page::into_files).unwrap_or_default());
        self.run_json(summary, supplements, &extra.missing)
    }

    /// Mass up to which no design of the front is missing \[kg\]: the study's limit on mass. `None` if the study has
    /// none, or if the front is not whole.
    fn proved_to_mass_kg(&self, facts: &SummaryFacts) -> Option<f64> {
        self.study.space.constraints.mass_max_kg.filter(|_| facts.is_whole())
    }

    /// The state of the search at its end. If the search was exhaustive, every design counts as visited.
    fn progress(&self, facts: &SummaryFacts) -> Progress {
        let sweep = &self.outcome.sweep;
        let visited = u64::try_from(sweep.designs_total).unwrap_or(u64::MAX);
        Progress {
            designs: self.exact.map_or(visited, |_| sweep.designs_evaluated),
            gap: facts.gap.or(facts.is_whole().then_some(0.0)),
            front_size: Some(self.outcome.front.len() as u64),
            boxes_open: self.exact.map(|exact| exact.boxes[1]),
        }
    }

    /// The files with the study, the front of all designs, and the front of every material.
    fn tables(&self, summary: &SummaryInput) -> Files {
        let mut files = vec![
            (FRONT.to_string(), summary.overall.to_csv()),
            (STUDY.to_string(), self.text.as_bytes().to_vec()),
        ];
        let fronts = self.file_names().into_iter().zip(&summary.materials);
        files.extend(fronts.map(|(file, of)| (front_of_material(&file), of.front.to_csv())));
        files
    }

    /// A short name for each material, which is a part of the names of its files.
    fn file_names(&self) -> Vec<String> {
        file_names(self.outcome.by_material.iter().map(|of| of.name.as_str()))
    }

    /// The fronts and facts of the result. The stiffness budget is added later, because it takes longer.
    fn summary(&self) -> SummaryInput {
        let (study, sweep) = (self.study, &self.outcome.sweep);
        let cost =
            |name: &str| self.setup.catalogs.materials.iter().find(|m| m.name == name)?.cost_eur_per_kg;
        let (overall, remarks) =
            table_and_remarks(study, self.problem, self.setup.catalogs, &self.outcome.front);
        SummaryInput {
            budgets: Vec::new(),
            facts: SummaryFacts {
                study: study.name.clone(),
                question: study.question.clone(),
                status: sweep.status.word().into(),
                designs_total: sweep.designs_total,
                designs_evaluated: sweep.designs_evaluated.into(),
                designs_excluded: sweep.designs_excluded,
                gap: self.exact.and_then(|exact| exact.gap),
                elapsed_s: self.elapsed_s,
                threads: rayon::current_num_threads(),
                tool_version: env!("CARGO_PKG_VERSION").into(),
                constraints: constraint_words(&study.space.constraints),
                cases: judged_cases(study),
                ranges: range_words(&study.space),
                not_checked: study.not_checked.clone(),
                remarks,
                materials_of_some_links: links_without(self.whole),
                caveats: caveats_of(study, self.setup.catalogs),
                results: self.dir.display().to_string(),
            },
            overall,
            materials: self
                .outcome
                .by_material
                .iter()
                .map(|of| MaterialFront {
                    cost_eur_per_kg: cost(&of.name),
                    name: of.name.clone(),
                    ties_listed: of.ties_listed,
                    status: of.status.word().into(),
                    front: front_table(self.problem, self.setup.catalogs, &of.front),
                })
                .collect(),
        }
    }

    /// The page of the result for a browser. `picture` is the picture of the front, `sections` are those of the
    /// supplements, and `run` is the content of `run.json`.
    fn page(&self, summary: &SummaryInput, picture: String, sections: Vec<PageSection>, run: &Value) -> Page {
        let mut page = study_page(self.study, self.problem, self.setup.catalogs, summary);
        page.extras.extend(sections);
        page.extras.push(certificate_section(&summary.facts, self.exact.map(|exact| exact.boxes)));
        let Facts { lasting, timing } = facts_of(run);
        StudyPage { scatter_svg: picture, run: lasting, timing, ..page }.page()
    }

    fn ties_listed(&self) -> bool {
        self.exact.is_none_or(|exact| exact.ties_listed)
    }

    fn run_json(&self, summary: &SummaryInput, supplements: &[Supplement], not_written: &[String]) -> Value {
        let (study, sweep) = (self.study, &self.outcome.sweep);
        let materials: Vec<Value> = summary
            .materials
            .iter()
            .zip(self.file_names())
            .map(|(m, file)| {
                json!({
                    "name": m.name, "slug": file, "status": m.status,
                    "front_size": m.front.rows.len(), "cost_eur_per_kg": m.cost_eur_per_kg,
                    "ties_listed": m.ties_listed,
                })
            })
            .collect();
        let mut run = json!({
            "schema_version": 1,
            "study": study.name,
            "question": study.question,
            "status": sweep.status.word(),
            "designs_total": count(sweep.designs_total),
            "designs_evaluated": sweep.designs_evaluated,
            "designs_excluded": count(sweep.designs_excluded),
            "front_size": self.outcome.front.len(),
            "hypervolume": front_hypervolume(self.outcome.front.iter().map(|d| d.design.objectives)),
            "picks": summary.budgets.iter().map(PickBudget::to_json).collect::<Vec<Value>>(),
            "elapsed_s": self.elapsed_s,
            "designs_per_s": sweep.designs_evaluated as f64 / self.elapsed_s,
            "threads": rayon::current_num_threads(),
            "tool_version": env!("CARGO_PKG_VERSION"),
            "platform": format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
            "models": {"links": study.space.links.word(), "joints": study.space.joints.word()},
            "constraints": summary.facts.constraints,
            "cases": summary.facts.cases,
            "materials": materials,
            "not_checked": study.not_checked,
            "remarks": summary.facts.remarks,
            "caveats": caveats_on(study, self.setup.catalogs, &summary.overall),
            "effects": effects_json(study),
            "effects_mass_kg": study.space.effects_mass_kg(),
            "carried_over": corrections_json(self.corrections),
            "catalogs": self.setup.overlay.map(|p| p.display().to_string()),
            "study_hash": hash(self.text.as_bytes()),
            "catalogs_hash": catalogs_hash(self.setup.catalogs),
            "search": if self.exact.is_some() { "exact" } else { "exhaustive" },
            "boxes": self.exact.map(|exact| exact.boxes[0]),
            "boxes_open": self.exact.map(|exact| exact.boxes[1]),
            "gap": self.exact.and_then(|exact| exact.gap),
            "proved_to_mass_kg": self.proved_to_mass_kg(&summary.facts),
            "ties_listed": self.ties_listed(),
            "not_written": not_written,
        });
        for (key, value) in supplements.iter().filter_map(|s| s.run.as_ref()) {
            run[*key] = value.clone();
        }
        run
    }
}

/// The facts of `run.json` that are a word or a number, as text for people. Each is a name and a value.
pub(super) struct Facts {
    /// The facts that are equal in every run of the study.
    pub lasting: Vec<(String, String)>,
    /// The facts that differ from run to run.
    pub timing: Vec<(String, String)>,
}

pub(super) fn facts_of(run: &Value) -> Facts {
    let plain = |value: &Value| match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) if number.is_f64() => Some(significant(number.as_f64()?, 4)),
        Value::Number(number) => Some(number.to_string()),
        Value::Object(map) => {
            let parts = map.iter().filter_map(|(k, v)| Some(format!("{k} {}", v.as_str()?)));
            Some(parts.collect::<Vec<_>>().join(", ")).filter(|words| !words.is_empty())
        }
        _ => None,
    };
    let facts = run.as_object().into_iter().flatten();
    let known = facts.filter(|(key, _)| !["schema_version", "study", "question"].contains(&key.as_str()));
    let (timing, lasting): (Vec<_>, Vec<_>) = known.partition(|(key, _)| OF_A_RUN.contains(&key.as_str()));
    let in_words = |facts: Vec<(&String, &Value)>| {
        facts.into_iter().filter_map(|(key, value)| Some((key_words(key), plain(value)?))).collect()
    };
    Facts { lasting: in_words(lasting), timing: in_words(timing) }
}

/// The picture of the front. Designs of mixed materials are grey, and each material has a colour. For each material its
/// own front is drawn. If the search found no such front, the designs of the overall front that consist of this
/// material are drawn.
fn picture(summary: &SummaryInput) -> String {
    let mixed = mixed_designs(&summary.overall);
    let pure: Vec<(String, FrontTable)> = single_materials(summary)
        .into_iter()
        .map(|name| {
            let own = summary.materials.iter().find(|m| m.name == name).map(|m| m.front.clone());
            (name.to_string(), own.unwrap_or_else(|| designs_of(&summary.overall, name)))
        })
        .collect();
    let mut fronts = vec![PlottedFront { name: "mixed".into(), front: &mixed, muted: true }];
    fronts.extend(pure.iter().map(|(name, front)| PlottedFront { name: name.clone(), front, muted: false }));
    let picks = picks::picks(&picks::designs(&summary.overall));
    FrontPicture { title: summary.facts.study.clone(), fronts, picks }.to_svg()
}

pub(super) fn pretty(value: &Value) -> Vec<u8> {
    serde_json::to_vec_pretty(value).expect("a value of numbers and strings serializes")
}

/// A count as a JSON number; above 2^53 it is rounded.
pub(super) fn count(n: u128) -> Value {
    u64::try_from(n).map_or_else(|_| json!(n as f64), |n| json!(n))
}

/// A hash of every rating of every part. It shows whether a result was made with other catalogs.
pub(super) fn catalogs_hash(catalogs: &Catalogs) -> String {
    hash(format!("{catalogs:?}").as_bytes())
}
