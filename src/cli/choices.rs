//! Runs a study that leaves values of springs or counterweights open: it searches one choice after the other, each in a
//! folder of its own, and joins their fronts.

use super::compare::files_of_comparison;
use super::compare_remarks::{remarks, said_by};
use super::corrections;
use super::exit::{Answer, Exit};
use super::extra_files::say_taken;
use super::failure::Failure;
use super::finished::{Written, catalogs_hash, pretty};
use super::log::Log;
use super::manifest::{CHOICES, FRONT, PAGE, PICTURE, STUDY, SUMMARY, hash};
use super::result_folder::{ResultFolder, unfinished_in};
use super::results::Results;
use super::search::SearchArgs;
use super::unfinished::Unfinished;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::choice_fronts::{ChoiceFront, choices_table, joint_front, picks_of_joint};
use crate::report::compare::comparison::{Comparison, compare};
use crate::report::compare::contender::Contender;
use crate::report::compare::thresholds::Thresholds;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::report::words::{TERMINAL, wrap};
use crate::search::resume::KeepState;
use crate::search::sweep::Status;
use crate::study::asked::Asked;
use crate::study::balance_choices::{BalanceChoice, balance_choices};
use crate::study::definition::Study;
use crate::study::read::read_study;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Names of the files of the joint result, without the folders of the choices.
const FILES: [&str; 6] = [FRONT, STUDY, CHOICES, PICTURE, SUMMARY, PAGE];

/// Number of letters of a hash in the name of a choice's folder.
const HASH_LETTERS: usize = 6;

/// How the search of one choice of springs and counterweights ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Ended {
    /// At least one design was found, and the result is in the folder of the choice.
    Written,
    /// No design meets the limits.
    Infeasible,
    /// The time was over before a design was found.
    NothingFound,
}

/// A function that searches a study, given with its text, and writes its result to a folder.
type SearchInto<'a> = dyn Fn(&SearchArgs, &Path, Study, String) -> Result<Written, Failure> + 'a;

/// How each choice is searched.
pub(super) struct Each<'a> {
    /// The search options that the user gives. The time limit is for all choices together.
    pub how: &'a SearchArgs,
    /// The other options of the command line as text. An unfinished run is continued only if they are the same.
    pub further: String,
    /// The function that searches one choice.
    pub search: &'a SearchInto<'a>,
}

/// Runs every choice of a study and writes the joint result to the folder `dir`.
///
/// # Errors
/// No choice has a design, the user stops the run, or a file cannot be written.
pub(super) fn run_choices(
    asked: &Asked,
    dir: &Path,
    each: &Each,
    catalogs: &Catalogs,
    log: Log,
) -> Result<Answer, Failure> {
    let folder = ResultFolder::open(dir, CHOICES, &FILES)?;
    let answer = fronts_of_all(asked, dir, each, catalogs, log)
        .and_then(|fronts| publish(asked, &fronts, (dir, &folder), catalogs, log));
    folder.settle(answer.as_ref().map(|answer| answer.exit))?;
    answer
}

/// Searches every choice that an earlier process did not finish, and reads the fronts of all.
fn fronts_of_all(
    asked: &Asked,
    dir: &Path,
    each: &Each,
    catalogs: &Catalogs,
    log: Log,
) -> Result<Vec<ChoiceFront>, Failure> {
    let choices = balance_choices(&asked.text);
    let search = json!({
        "study_hash": hash(asked.text.as_bytes()),
        "catalogs_hash": catalogs_hash(catalogs),
        "tool_version": env!("CARGO_PKG_VERSION"),
        "flags": format!("{:?} {}", each.how.without_fresh(), each.further),
    });
    let unfinished = Unfinished::open(&unfinished_in(dir, "choices"), search, each.how.earlier(), log)?;
    let earlier = unfinished.resume().from;
    let mut ended: Vec<Ended> =
        earlier.map_or(Ok(Vec::new()), serde_json::from_slice).map_err(|_| unfinished.damaged())?;
    let deadline = each.how.time_limit().map(|limit| Instant::now() + limit);
    for (at, choice) in choices.iter().enumerate().skip(ended.len()) {
        log.note(&format!("choice {} of {}: {}", at + 1, choices.len(), choice.words));
        let how = each.how.limited_to(share_of_time(deadline, choices.len() - at));
        ended.push(search_choice(each, &how, choice, &dir.join(folder_of_choice(at, choice)), catalogs)?);
        unfinished.keep(&serde_json::to_vec(&ended).unwrap_or_default());
    }
    choices
        .iter()
        .zip(ended)
        .enumerate()
        .map(|(at, (choice, ended))| front_of(dir, at, choice, ended))
        .collect()
}

/// The time limit of the next search: the time that is left until `deadline`, divided by the number `searches` of
/// searches that remain. `None` if there is no deadline.
fn share_of_time(deadline: Option<Instant>, searches: usize) -> Option<Duration> {
    deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()) / searches as u32)
}

/// Searches a choice and writes its result to the folder `dir`.
///
/// # Errors
/// The user stopped the search, or it failed for another reason than that no design was found.
fn search_choice(
    each: &Each,
    how: &SearchArgs,
    choice: &BalanceChoice,
    dir: &Path,
    catalogs: &Catalogs,
) -> Result<Ended, Failure> {
    let study = read_study(Document::parse(&choice.words, &choice.text)?, catalogs)?;
    match (each.search)(how, dir, study, choice.text.clone()) {
        Ok(written) if written.exit == Exit::Interrupted => Err(Failure::Interrupted(format!(
            "stopped in the choice \"{}\"; the same command goes on from there",
            choice.words
        ))),
        Ok(_) => Ok(Ended::Written),
        Err(Failure::Infeasible(_)) => Ok(Ended::Infeasible),
        Err(Failure::Partial(_)) => Ok(Ended::NothingFound),
        Err(failure) => Err(failure),
    }
}

/// Folder name of choice `at` (counted from 0). It contains a part of the hash of this choice of the study. If the
/// study is edited, its results go to new folders, so that the folders to which an earlier joint front refers keep
/// their results.
fn folder_of_choice(at: usize, choice: &BalanceChoice) -> String {
    format!("choice-{}-{}", at + 1, &hash(choice.text.as_bytes())[..HASH_LETTERS])
}

/// The front of a choice, read from its folder; without rows if none was written.
///
/// # Errors
/// The result in the folder is not complete.
fn front_of(dir: &Path, at: usize, choice: &BalanceChoice, ended: Ended) -> Result<ChoiceFront, Failure> {
    let folder = folder_of_choice(at, choice);
    let (status, gap, front) = match ended {
        Ended::Infeasible => (Status::Infeasible.word().to_string(), None, FrontTable::default()),
        Ended::NothingFound => (Status::Partial.word().to_string(), None, FrontTable::default()),
        Ended::Written => {
            let results = Results::open(&dir.join(&folder))?;
            let status = results.run["status"].as_str().unwrap_or_default().to_string();
            (status, results.run["gap"].as_f64(), results.front(FRONT)?)
        }
    };
    let (words, values) = (choice.words.clone(), choice.values.clone());
    Ok(ChoiceFront { folder, words, values, status, gap, front })
}

/// Writes the joint result of all choices, and returns the text to print.
///
/// # Errors
/// No choice has a design, or a file cannot be written.
fn publish(
    asked: &Asked,
    fronts: &[ChoiceFront],
    (dir, folder): (&Path, &ResultFolder),
    catalogs: &Catalogs,
    log: Log,
) -> Result<Answer, Failure> {
    let with_designs: Vec<&ChoiceFront> = fronts.iter().filter(|of| !of.front.rows.is_empty()).collect();
    let is_partial = fronts.iter().any(|of| of.status == Status::Partial.word());
    if with_designs.is_empty() {
        return Err(nothing_found(is_partial, &asked.study.name));
    }
    let joint = joint_front(fronts);
    let (comparison, contenders) = compared(dir, &with_designs)?;
    let mut files = vec![
        (FRONT.to_string(), joint.to_csv()),
        (STUDY.to_string(), asked.text.as_bytes().to_vec()),
        (SUMMARY.to_string(), summary(asked, fronts, &joint, &comparison).into_bytes()),
        (CHOICES.to_string(), pretty(&manifest(asked, fronts, &joint, catalogs))),
    ];
    files.extend(pictures(&comparison, &contenders));
    let left_out = folder.publish(&files)?;
    say_taken(&left_out, log);
    let written: Vec<&str> =
        FILES.into_iter().filter(|name| left_out.iter().all(|other| other != name)).collect();
    let sentences = words_of(dir, fronts, &joint);
    let lines = |words: &[String]| words.iter().map(|w| wrap(w, TERMINAL, "")).collect::<String>();
    let text = format!(
        "{}\n{}\n{}{}\nwritten to {}: {}\n",
        choices_table(fronts, &joint).to_text(),
        lines(&sentences),
        lines(&comparison.remarks),
        corrections::to_text(&asked.corrections),
        dir.display(),
        written.join(", ")
    );
    Ok(Answer { text, exit: if is_partial { Exit::Partial } else { Exit::Done } })
}

/// The failure of a study named `study` if no choice gave a design: proved, or unproved if the time ended in some choice
/// (`is_partial`).
fn nothing_found(is_partial: bool, study: &str) -> Failure {
    match is_partial {
        true => Failure::Partial(format!(
            "no choice of springs and counterweights of {study} gave a design in its share of the time; give more with \
             --time-limit"
        )),
        false => Failure::Infeasible(format!(
            "no choice of springs and counterweights has a design that meets the limits; `armwright run` with one value in \
             place of each list of {study} says which limit ends each"
        )),
    }
}

/// The fronts of the choices `fronts` side by side, with the remarks of their results.
///
/// # Errors
/// A result is not complete.
fn compared(dir: &Path, fronts: &[&ChoiceFront]) -> Result<(Comparison, Vec<Contender>), Failure> {
    let paths: Vec<PathBuf> = fronts.iter().map(|of| dir.join(&of.folder)).collect();
    let labels: Vec<String> = fronts.iter().map(|of| of.words.clone()).collect();
    let contenders: Vec<Contender> =
        fronts.iter().map(|of| Contender::new(&of.words, of.front.clone())).collect();
    let mut comparison = compare(&contenders, &Thresholds::default());
    comparison.remarks = remarks(&said_by(&paths, labels)?);
    Ok((comparison, contenders))
}

/// The picture and the page of the fronts of all choices.
fn pictures(comparison: &Comparison, contenders: &[Contender]) -> Vec<(String, Vec<u8>)> {
    let files = files_of_comparison(comparison, contenders).into_iter();
    files
        .filter_map(|(name, bytes)| match name.as_str() {
            "compare.svg" => Some((PICTURE.to_string(), bytes)),
            "compare.md" | "compare.csv" => None,
            _ => Some((name, bytes)),
        })
        .collect()
}

/// Sentences on the picks of the joint front and on what is proved. `dir` is the folder of all choices as a user types
/// it.
fn words_of(dir: &Path, fronts: &[ChoiceFront], joint: &FrontTable) -> Vec<String> {
    let picks = picks_of_joint(fronts, joint).into_iter().map(|(pick, of)| {
        let [mass, tip, mode] =
            [pick.design.mass_kg, pick.design.tip_deflection_mm, pick.design.lowest_mode_hz]
                .map(|x| significant(x, 4));
        format!(
            "{}: {} with {}, {mass} kg, {tip} mm, {mode} Hz; `armwright design {} {}` writes it.",
            pick.names.join(", "),
            pick.design.design_id,
            of.words,
            dir.join(&of.folder).display(),
            pick.design.design_id
        )
    });
    picks.chain([proof_words(fronts)]).collect()
}

/// A sentence on what is proved of the joint front.
fn proof_words(fronts: &[ChoiceFront]) -> String {
    let is_open = |of: &&ChoiceFront| of.status == Status::Partial.word();
    if let Some(of) = fronts.iter().find(is_open) {
        return format!(
            "The search of {} ended before its front was proved, so that designs may be missing here too.",
            of.folder
        );
    }
    match fronts.iter().filter_map(|of| of.gap).fold(0.0, f64::max) {
        0.0 => "Each choice was searched whole, so that no design of any choice is missing.".into(),
        gap => format!(
            "For every design of every choice, some listed one is worse by at most {} % in each objective.",
            significant(100.0 * gap, 3)
        ),
    }
}

/// The summary of all choices as Markdown. Its commands are typed in the folder of all choices.
fn summary(asked: &Asked, fronts: &[ChoiceFront], joint: &FrontTable, comparison: &Comparison) -> String {
    let listed: String =
        words_of(Path::new(""), fronts, joint).iter().map(|sentence| format!("- {sentence}\n")).collect();
    format!(
        "# {}\n\n{}\n\nThe study leaves springs or counterweights open. Each choice was searched by itself; its folder has its \
         result. Commands are for this folder.\n\n{}\n{listed}\n{}",
        asked.study.name,
        asked.study.question,
        choices_table(fronts, joint).to_markdown(),
        comparison.to_markdown().replacen("# Fronts compared", "## The choices side by side", 1)
    )
}

/// The contents of `choices.json`.
fn manifest(asked: &Asked, fronts: &[ChoiceFront], joint: &FrontTable, catalogs: &Catalogs) -> Value {
    let choice = |of: &ChoiceFront| {
        let values: serde_json::Map<String, Value> =
            of.values.iter().map(|(column, value)| (column.clone(), json!(value))).collect();
        json!({
            "folder": of.folder, "words": of.words, "values": values, "status": of.status, "gap": of.gap,
            "front_size": of.front.rows.len(),
        })
    };
    json!({
        "schema_version": 1,
        "study": asked.study.name,
        "question": asked.study.question,
        "choices": fronts.iter().map(choice).collect::<Vec<Value>>(),
        "front_size": joint.rows.len(),
        "study_hash": hash(asked.text.as_bytes()),
        "catalogs_hash": catalogs_hash(catalogs),
        "tool_version": env!("CARGO_PKG_VERSION"),
    })
}
