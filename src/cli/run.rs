//! `armwright run`: finds the front of a study and writes it.

use super::asked::{Asked, load_study};
use super::corrections;
use super::failure::Failure;
use super::finished::{catalogs_hash, facts_of, is_front_of_material, pretty};
use super::search::{SearchArgs, With, search};
use super::supplements::SupplementArgs;
use super::write::write_all;
use crate::catalog::Catalogs;
use crate::paper::names::{NAMES, question};
use crate::report::html::document::DocumentPage;
use crate::report::html::render::PLOTS;
use crate::report::section::Figure;
use crate::report::table::Table;
use crate::report::words::{TERMINAL, wrap};
use crate::search::sweep::Status;
use crate::study::effects::left_out;
use crate::study::table::slug;
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs a study: finds its Pareto front on tip deflection, mass and lowest mode, and one front per material.
/// Every design is visited in parallel, or the exact search proves the front without visiting every design.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright run compare-materials\n         armwright run my-study.json --out results/mine\n         \
                  armwright run my-study.json --effects results/may/arm.corrected.json\n         \
                  armwright run my-study.json --within 2% --tolerance gear_stiffness=20%"
)]
pub(crate) struct RunArgs {
    /// A built-in study (see `armwright studies`) or a study file
    study: String,
    /// Folder for the results; default results/<study>, or results/<study>-with-effects
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Arm file, such as the arm.corrected.json of `reconcile`: its effects are applied to the study's joints
    /// and links of the same name; every effect that does not apply is listed
    #[arg(long, value_name = "ARM")]
    effects: Option<PathBuf>,
    #[command(flatten)]
    search: SearchArgs,
    #[command(flatten)]
    supplements: SupplementArgs,
}

/// Executes the verb.
pub(super) fn run(args: &RunArgs, catalogs: &Catalogs, overlay: Option<&Path>) -> Result<String, Failure> {
    if NAMES.contains(&args.study.as_str()) {
        return run_paper(args, catalogs);
    }
    let (study, text) = load_study(&args.study, catalogs)?;
    let (asked, suffix) = match &args.effects {
        None => (Asked { corrections: left_out(&study), study, text }, ""),
        Some(path) => (corrections::from_arm_file(path, &study, &text, catalogs)?, "-with-effects"),
    };
    let name = format!("{}{suffix}", slug(&asked.study.name));
    let dir = args.out.clone().unwrap_or_else(|| Path::new("results").join(name));
    let written = search(
        &asked,
        &With { catalogs, overlay, dir: &dir, how: &args.search, supplements: &args.supplements },
    )?;
    written.write(&dir)?;
    let applied = corrections::to_text(&asked.corrections);
    Ok(format!("{}{applied}\n{}", written.terminal, told(&dir, &written.files)))
}

/// Runs one of the paper's studies, which are computed without a search.
fn run_paper(args: &RunArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    let dir = args.out.clone().unwrap_or_else(|| Path::new("results").join(&args.study));
    write_all(&dir, &[])?;
    let started = Instant::now();
    let output = crate::paper::run::run(&args.study, catalogs).map_err(|e| Failure::Usage(e.to_string()))?;
    let run = json!({
        "schema_version": 1,
        "study": args.study,
        "status": Status::Complete.word(),
        "elapsed_s": started.elapsed().as_secs_f64(),
        "tool_version": env!("CARGO_PKG_VERSION"),
        "catalogs_hash": catalogs_hash(catalogs),
    });
    let mut files = output.files;
    let page = paper_page(&args.study, &files, &run).page();
    files.push(("run.json".into(), pretty(&run)));
    files.extend(page.into_files());
    write_all(&dir, &files)?;
    Ok(format!("{}\n{}", output.terminal, told(&dir, &files)))
}

/// Digits of the numbers in the tables of a page; files have all.
const PAGE_DIGITS: usize = 5;

/// The page of a study of the paper: its pictures and tables.
fn paper_page(study: &str, files: &[(String, Vec<u8>)], run: &Value) -> DocumentPage {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let ending = |end: &'static str| files.iter().filter_map(move |(n, b)| Some((n.strip_suffix(end)?, b)));
    DocumentPage {
        title: study.to_string(),
        question: question(study).unwrap_or_default().to_string(),
        words: Vec::new(),
        figures: ending(".svg")
            .map(|(name, bytes)| Figure { name: name.into(), svg: text(bytes), ..Figure::default() })
            .collect(),
        tables: ending(".csv")
            .map(|(name, bytes)| {
                let caption = format!("{name}.csv, its numbers to {PAGE_DIGITS} digits");
                (caption, Table::from_csv(&text(bytes)).rounded(PAGE_DIGITS))
            })
            .collect(),
        facts: facts_of(run),
    }
}

/// Says which files were written, in lines of at most 80 columns.
fn told(dir: &Path, files: &[(String, Vec<u8>)]) -> String {
    wrap(&format!("written to {}: {}", dir.display(), names(files)), TERMINAL, "")
}

/// Names of the files that were written; fronts by material and plots are only counted.
fn names(files: &[(String, Vec<u8>)]) -> String {
    let kind = |name: &str| match name {
        n if n.starts_with(PLOTS) => 2,
        n if is_front_of_material(n) => 1,
        _ => 0,
    };
    let count = |which: usize| files.iter().filter(|(n, _)| kind(n) == which).count();
    let mut names: Vec<String> = files.iter().map(|(n, _)| n.clone()).filter(|n| kind(n) == 0).collect();
    match count(1) {
        0 => {}
        1 => names.push("one front by material".into()),
        n => names.push(format!("{n} fronts by material")),
    }
    if count(2) > 0 {
        names.push(format!("{} files in {PLOTS}", count(2)));
    }
    names.join(", ")
}
