//! Runs a study twice, without and with the corrections of a measured arm, and compares both fronts.

use super::corrections;
use super::exit::Exit;
use super::failure::Failure;
use super::finished::{Keep, Written};
use super::manifest::{Files, RUN, sealed};
use super::result_folder::unfinished_in;
use super::search::{SearchArgs, SearchSettings, search};
use super::setup::Setup;
use super::supplements::SupplementArgs;
use super::wrong_kind::study_of;
use crate::catalog::Catalogs;
use crate::reconcile::verdict::outcome::{Outcome, Verdict};
use crate::report::certificate::gap_words;
use crate::report::compare::changes::{Changes, Model, Values};
use crate::report::picks::designs;
use crate::report::words::{TERMINAL, wrap};
use crate::search::sweep::Status;
use crate::space::design::evaluate;
use crate::space::design::{number, number_of};
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use crate::study::asked::Asked;
use crate::study::effects::corrections_json;
use serde_json::{Value, json};
use std::path::Path;

/// Name of the file with all designs of both fronts under both models.
pub(super) const CHANGES: &str = "study_changes.csv";

/// The result of running a study again: the results of both runs, and what the corrections change.
pub(super) struct Rerun {
    /// Text for the terminal.
    pub text: String,
    /// Entry for `verdict.json`.
    pub json: Value,
    /// Files of both runs in `study/nominal` and `study/corrected`, and `study_changes.csv` if both runs found a
    /// front.
    pub files: Files,
    /// Exit status of the program. If one of the runs was stopped or found no design, the status is that of this run.
    pub exit: Exit,
}

impl Rerun {
    /// The result if the study was not run, or if a run found no design. `why` gives the reason in words.
    fn without(study: &str, status: &str, why: &str) -> Self {
        Self {
            text: format!("\nstudy {study}: {why}\n"),
            json: json!({"study": study, "status": status, "why": why}),
            files: Vec::new(),
            exit: Exit::Done,
        }
    }
}

/// The result if the study is not run again, because the verdict names no effect.
fn not_explained(outcome: &Outcome, study: &str) -> Rerun {
    let verdict = outcome.verdict.word();
    let why = format!("not re-run: the verdict is {verdict}, so there is no effect to put into it");
    Rerun::without(study, "not_run", &why)
}

/// The result if the study is not run again, because no effect of the corrected arm applies to it.
fn nothing_applies(name: &str, corrected: &Asked) -> Rerun {
    let mut rerun = Rerun::without(name, "not_run", "not re-run: no effect of the arm applies to it");
    rerun.text.push_str(corrections::to_text(&corrected.corrections).trim_start());
    rerun.json["carried_over"] = corrections_json(&corrected.corrections);
    rerun
}

/// The study that is run again, how it is searched, and where its files go.
pub(super) struct Again<'a> {
    /// Name or file of the study.
    pub study: &'a str,
    /// The search options of each of the two runs.
    pub how: &'a SearchArgs,
    /// Folder of the campaign's result.
    pub dir: &'a Path,
    /// The function that writes the files of a finished run into this folder at once.
    pub keep: &'a Keep<'a>,
}

/// Runs the study without and with the corrections of the outcome.
///
/// # Errors
/// The study has faults, its results cannot be written, or the user stops the search.
pub(super) fn rerun(outcome: &Outcome, again: &Again, setup: Setup) -> Result<Rerun, Failure> {
    let catalogs = setup.catalogs;
    if outcome.verdict != Verdict::Explained {
        return Ok(not_explained(outcome, again.study));
    }
    let (nominal, text) = study_of(again.study, catalogs)?;
    let name = nominal.name.clone();
    let calibrated: Vec<(String, f64)> =
        outcome.calibrated.iter().map(|c| (c.name.clone(), c.factor.value)).collect();
    let corrected = Asked::corrected(&nominal, &text, &outcome.corrected, &calibrated, catalogs)?;
    if corrected.study.space.effects.len() == nominal.space.effects.len() {
        return Ok(nothing_applies(&name, &corrected));
    }
    let nominal = Asked { study: nominal, text, corrections: Vec::new() };
    let (mut found, mut kept) = (Vec::new(), Files::new());
    for (asked, folder) in [(&nominal, "nominal"), (&corrected, "corrected")] {
        match run_once(asked, folder, &kept, again, setup) {
            Ok(written) => {
                kept.extend(placed(&written.files, folder)?);
                if written.exit == Exit::Interrupted {
                    let words = format!(
                        "the search with the {folder} model was stopped, so nothing is compared; the same command goes on"
                    );
                    let without = Rerun::without(&name, Status::Interrupted.word(), &words);
                    return Ok(Rerun { files: kept, exit: Exit::Interrupted, ..without });
                }
                found.push(written);
            }
            Err(Failure::Infeasible(why)) => {
                let words = format!("the {folder} model finds no design: {why}");
                let without = Rerun::without(&name, "infeasible", &words);
                return Ok(Rerun { files: kept, exit: Exit::Infeasible, ..without });
            }
            Err(other) => return Err(other),
        }
    }
    let changes = changes([&nominal, &corrected], &found, catalogs);
    let mut rerun = told(&name, &corrected, &found, &changes);
    rerun.files.extend(kept);
    Ok(rerun)
}

/// Searches the study with one of the two models. Its files go into the folder `study/` followed by `folder`. `kept`
/// has the files of the run that was finished before.
fn run_once(
    asked: &Asked,
    folder: &str,
    kept: &Files,
    again: &Again,
    setup: Setup,
) -> Result<Written, Failure> {
    // only the names in this run's own folder that are taken by other files concern this run
    let own = format!("study/{folder}/");
    let keep = |files: &[(String, Vec<u8>)]| {
        let taken = (again.keep)(&[kept.clone(), placed(files, folder)?].concat())?;
        Ok(taken.iter().filter_map(|name| name.strip_prefix(&own)).map(str::to_string).collect())
    };
    let settings = SearchSettings {
        setup,
        dir: &again.dir.join("study").join(folder),
        keep: &keep,
        unfinished: &unfinished_in(again.dir, folder),
        how: again.how,
        supplements: &SupplementArgs::default(),
        record: None,
    };
    search(asked, &settings)
}

/// The files of one run with their manifest, under their paths in the folder of the campaign's result. `folder` is
/// `nominal` or `corrected`.
fn placed(files: &[(String, Vec<u8>)], folder: &str) -> Result<Files, Failure> {
    let whole = sealed(files.to_vec(), RUN, &[])?;
    Ok(whole.into_iter().map(|(name, bytes)| (format!("study/{folder}/{name}"), bytes)).collect())
}

fn changes(asked: [&Asked; 2], found: &[Written], catalogs: &Catalogs) -> Changes {
    // both spaces are reduced to the options that designs of both fronts use
    let rows = found.iter().flat_map(|written| designs(&written.front));
    let numbers: Vec<u128> = rows.filter_map(|design| number_of(&design.design_id)).collect();
    let spaces = asked.map(|a| &a.study.space);
    let spaces = spaces.map(|s| s.excerpt(catalogs, &numbers).unwrap_or_else(|| s.clone()));
    let problems = spaces.each_ref().map(|space| ArmProblem::new(space, catalogs));
    let judge = |model: Model, id: &str| {
        let problem = &problems[model as usize];
        let here = number(problem.level_sizes(), &problem.options_of_id(id)?);
        let objectives = evaluate(problem, here)?.objectives;
        Some(Values {
            tip_deflection_mm: objectives.tip_deflection_m * 1e3,
            mass_kg: objectives.mass_kg,
            lowest_mode_hz: objectives.lowest_mode_hz,
        })
    };
    Changes::new([&found[0].front, &found[1].front], judge)
}

fn told(name: &str, corrected: &Asked, found: &[Written], changes: &Changes) -> Rerun {
    let [stay, leave, enter] = changes.counts();
    let sizes: Vec<usize> = found.iter().map(|w| w.front.rows.len()).collect();
    let all_whole = found.iter().all(|written| written.is_whole);
    let json = json!({
        "study": name,
        "status": if all_whole { Status::Complete } else { Status::Partial }.word(),
        "carried_over": corrections_json(&corrected.corrections),
        "effects_mass_kg": corrected.study.space.effects_mass_kg(),
        "nominal": {"results": "study/nominal", "front_size": sizes[0], "gap": found[0].gap},
        "corrected": {"results": "study/corrected", "front_size": sizes[1], "gap": found[1].gap},
        "front": {"stay": stay, "leave": leave, "enter": enter},
        "picks": changes.picks(),
    });
    let text = format!(
        "\nstudy {name}, re-run with the corrected arm\n{}\n{}{}",
        corrections::to_text(&corrected.corrections).trim_start(),
        changes.to_text(),
        if all_whole { String::new() } else { lacking_words(found) }
    );
    let stopped = found.iter().map(|written| written.exit).find(|exit| *exit != Exit::Done);
    Rerun {
        text,
        json,
        files: vec![(CHANGES.into(), changes.to_csv().into_bytes())],
        exit: stopped.unwrap_or(Exit::Done),
    }
}

/// A warning for the reader if one of the two fronts is not complete.
fn lacking_words(found: &[Written]) -> String {
    let lacks = |written: &Written| match (written.status, written.gap) {
        (_, Some(gap)) if gap > 0.0 => gap_words(gap),
        (Status::Partial, _) => "it is not known how much is missing".into(),
        _ => "no design is missing".into(),
    };
    let words = format!(
        "Not all designs are listed, so a design may also leave or enter because only one of the searches found it. \
         Nominal: {}. Corrected: {}.",
        lacks(&found[0]),
        lacks(&found[1])
    );
    wrap(&words, TERMINAL, "")
}
