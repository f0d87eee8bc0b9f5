//! `armwright run`: finds the front of a study and writes it.

use super::choices::{Each, run_choices};
use super::corrections;
use super::exit::Answer;
use super::extra_files::say_taken;
use super::failure::Failure;
use super::finished::{
    Facts, Written, catalogs_hash, facts_of, front_of_material, is_front_of_material, pretty,
};
use super::manifest::{FRONT, PAGE, PICTURE, RUN, SHARD, STUDY, SUMMARY};
use super::progress::Record;
use super::result_folder::{ResultFolder, unfinished_in};
use super::search::{SearchArgs, SearchSettings, search};
use super::setup::Setup;
use super::shard::{run_shard, shard_of};
use super::shard_files::{CANDIDATES, folder_of};
use super::stop::refuse_if_stopped;
use super::supplements::{FILES, SupplementArgs};
use super::write::{is_same_file, refuse_overwriting};
use super::wrong_kind::study_of;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::input::magnitude::{beyond_calculation, not_positive};
use crate::paper::names::{NAMES, question};
use crate::report::file_names::{file_names, folder_name};
use crate::report::html::document::DocumentPage;
use crate::report::html::render::PLOTS;
use crate::report::key_words::key_words;
use crate::report::section::Figure;
use crate::report::table::Table;
use crate::report::whole_file;
use crate::report::words::{TERMINAL, wrap};
use crate::search::sweep::{Shard, Status};
use crate::study::asked::Asked;
use crate::study::definition::Study;
use crate::study::read::read_study;
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
                  armwright run my-study.json --within 2% --tolerance gear_stiffness=20%\n         \
                  armwright run full-catalog --gap 0% --mass-max-kg 14.5 --progress progress.jsonl"
)]
pub(crate) struct RunArgs {
    /// A built-in study (see `armwright studies`) or a study file
    study: String,
    /// Folder for the results; default results/<study>, or results/<study>-with-effects, and with -choices at the end
    /// if the study leaves springs or counterweights open
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Arm file, such as the arm.corrected.json of `reconcile`: its effects are applied to the study's joints
    /// and links of the same name; every effect that does not apply is listed
    #[arg(long, value_name = "ARM")]
    effects: Option<PathBuf>,
    /// Look for arms of at most this mass only. With --gap 0 this part of the front is proved whole, which takes
    /// seconds for light arms where the whole front would take years; run.json then has proved_to_mass_kg
    #[arg(long, value_name = "KG", value_parser = mass_limit)]
    mass_max_kg: Option<f64>,
    /// Record the progress of the search in a file, a JSON object a line: elapsed_s, designs, gap, front_size,
    /// boxes_open. There is a line every second and whenever the gap falls; null stands for what is not known. A search
    /// that goes on adds to its record; a file that is no record is not replaced
    #[arg(long, value_name = "FILE")]
    progress: Option<PathBuf>,
    /// Search part M of N of the designs only, and write what it found for `armwright merge`. The parts can run one
    /// after the other or on many machines; the front is the same. Every design is visited unless --search exact or
    /// --gap is given
    #[arg(long, value_name = "M/N", value_parser = shard_of)]
    shard: Option<Shard>,
    /// Shards of other exact searches of the same study, such as a search with a wide gap on one machine. A shard of an
    /// exact search begins with the designs that they found, and discards from the start what these dominate
    #[arg(long, value_name = "SHARD|DIR", num_args = 1.., requires = "shard")]
    incumbents: Vec<PathBuf>,
    #[command(flatten)]
    search: SearchArgs,
    #[command(flatten)]
    supplements: SupplementArgs,
}

impl RunArgs {
    /// The study to be searched, with the mass limit and the effects that the user gives.
    fn asked(&self, catalogs: &Catalogs) -> Result<Asked, Failure> {
        let (study, text) = study_of(&self.study, catalogs)?;
        let (study, text) = match self.mass_max_kg {
            Some(most_kg) => up_to_mass(most_kg, study, text, catalogs)?,
            None => (study, text),
        };
        match &self.effects {
            None => Ok(Asked::as_stated(study, text)),
            Some(path) => corrections::from_arm_file(path, &study, &text, catalogs),
        }
    }

    /// Names of the files that the run will write, as far as they are known before it.
    ///
    /// # Errors
    /// One of these files is an input and would be changed.
    fn planned(&self, dir: &Path, asked: &Asked) -> Result<Vec<String>, Failure> {
        let study = Path::new(&self.study);
        self.refuse_record_over_input()?;
        let own = dir.join(STUDY);
        let is_same = is_same_file(study, &own);
        let stays = is_same && std::fs::read(&own).is_ok_and(|bytes| bytes == asked.text.as_bytes());
        if is_same && !stays {
            return Err(Failure::Usage(format!(
                "{} is the study that is asked for and would be replaced by another one; choose another --out",
                own.display()
            )));
        }
        Ok(planned(&asked.study).into_iter().filter(|name| !stays || name != STUDY).collect())
    }

    /// Refuses the file of `--progress` if it is an input, or a file of a result.
    ///
    /// # Errors
    /// The file is one of these.
    fn refuse_record_over_input(&self) -> Result<(), Failure> {
        let inputs = [Some(Path::new(&self.study)), self.effects.as_deref()];
        let inputs: Vec<&Path> = inputs.into_iter().flatten().collect();
        refuse_overwriting(self.progress.as_slice(), &inputs)
    }

    /// Opens the file of `--progress`, if the user asks for one. `dir` is the folder of the result, `planned` are the
    /// names of the files that the run will write there, and `unfinished` is the file with the state of a search that
    /// was stopped.
    ///
    /// # Errors
    /// The file is one of those that the run will write, or it cannot be written.
    fn record(&self, dir: &Path, planned: &[String], unfinished: &Path) -> Result<Option<Record>, Failure> {
        let Some(path) = &self.progress else { return Ok(None) };
        let is_planned =
            path.file_name().is_some_and(|name| planned.iter().any(|planned| name == planned.as_str()));
        if is_planned && is_same_file(&whole_file::folder_of(path), dir) {
            return Err(Failure::Usage(format!(
                "{} is the place of a file of the result; choose another file for --progress",
                path.display()
            )));
        }
        let goes_on = unfinished.is_file() && !self.search.is_fresh();
        Record::open(path, goes_on).map(Some)
    }

    /// The options that the user gives and that have no meaning for a study of the paper, which is not searched.
    fn options_of_a_search(&self) -> Vec<&'static str> {
        let own = [
            ("--effects", self.effects.is_some()),
            ("--mass-max-kg", self.mass_max_kg.is_some()),
            ("--progress", self.progress.is_some()),
            ("--shard", self.shard.is_some()),
            ("--incumbents", !self.incumbents.is_empty()),
        ];
        let all = own.into_iter().chain(self.search.given()).chain(self.supplements.given());
        all.filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect()
    }

    /// Name of the folder of results if the user gives none. It names the study, the mass limit and whether there are
    /// effects.
    fn folder(&self, study: &Study) -> String {
        let up_to = self.mass_max_kg.map_or(String::new(), |kg| format!("-up-to-{kg}-kg"));
        let effects = if self.effects.is_some() { "-with-effects" } else { "" };
        format!("{}{up_to}{effects}", folder_name(&study.name))
    }
}

/// The folder `name` among all results.
fn in_results(name: &str) -> PathBuf {
    Path::new("results").join(name)
}

/// Names of the files of a study's result, without those in `plots`.
pub(super) fn planned(study: &Study) -> Vec<String> {
    let materials = study.space.material_names();
    let of_materials = file_names(materials.iter().map(String::as_str)).into_iter();
    let of_materials = of_materials.flat_map(|file| [front_of_material(&file), format!("ties.{file}.csv")]);
    let always = [FRONT, STUDY, RUN, PICTURE, "budget.csv", SUMMARY, PAGE];
    always.into_iter().chain(FILES).map(String::from).chain(of_materials).collect()
}

/// The study with the limit `most_kg` on the mass of the arm \[kg\], and the text of its file. If the study already has
/// a limit that is as low or lower, nothing changes.
fn up_to_mass(
    most_kg: f64,
    study: Study,
    text: String,
    catalogs: &Catalogs,
) -> Result<(Study, String), Failure> {
    if study.space.constraints.mass_max_kg.is_some_and(|kg| kg <= most_kg) {
        return Ok((study, text));
    }
    let mut file: Value = serde_json::from_str(&text).map_err(|e| Failure::Internal(e.to_string()))?;
    file["constraints"]["mass_max_kg"] = json!(most_kg);
    let text = format!("{file:#}\n");
    let name = format!("{} up to {most_kg} kg", study.name);
    Ok((read_study(Document::parse(&name, &text)?, catalogs)?, text))
}

/// Reads a mass limit \[kg\].
fn mass_limit(text: &str) -> Result<f64, String> {
    let kg = text.parse::<f64>().ok().filter(|kg| beyond_calculation(*kg).or(not_positive(*kg)).is_none());
    kg.ok_or_else(|| "a finite mass above zero, in kilograms".into())
}

/// Runs `armwright run`: writes the result, and returns the text to print.
pub(super) fn run(args: &RunArgs, setup: Setup) -> Result<Answer, Failure> {
    if NAMES.contains(&args.study.as_str()) {
        let useless = args.options_of_a_search();
        if !useless.is_empty() {
            return Err(Failure::Usage(format!(
                "{} is computed without a search; options that mean nothing there: {}; leave them away",
                args.study,
                useless.join(", ")
            )));
        }
        return run_paper(args, setup).map(Answer::from);
    }
    let asked = args.asked(setup.catalogs)?;
    if let Some(shard) = args.shard {
        return run_part(args, shard, &asked, setup);
    }
    if asked.study.balance_choices > 1 {
        return run_each_choice(args, &asked, setup);
    }
    let dir = args.out.clone().unwrap_or_else(|| in_results(&args.folder(&asked.study)));
    let written = search_into(args, &args.search, &dir, &asked, setup)?;
    let applied = corrections::to_text(&asked.corrections);
    let text = format!("{}{applied}\n{}{}", written.terminal, told(&dir, &written.files), written.timing);
    Ok(Answer { text, exit: written.exit })
}

/// Runs a study that leaves values of springs or counterweights open.
fn run_each_choice(args: &RunArgs, asked: &Asked, setup: Setup) -> Result<Answer, Failure> {
    if args.progress.is_some() {
        let why = "each choice of springs and counterweights is a search of its own";
        return Err(Failure::Usage(format!("--progress does not go with this study: {why}")));
    }
    let name = format!("{}-choices", args.folder(&asked.study));
    let dir = args.out.clone().unwrap_or_else(|| in_results(&name));
    // the text of each choice comes from the text of the study, which has the effects that the user gives
    let search = |how: &SearchArgs, dir: &Path, study: Study, text: String| {
        let asked = Asked { study, text, corrections: asked.corrections.clone() };
        search_into(args, how, dir, &asked, setup)
    };
    let further = format!("{:?} {:?}", args.supplements, args.effects);
    run_choices(asked, &dir, &Each { how: &args.search, further, search: &search }, setup.catalogs, setup.log)
}

/// Searches a study in the way `how` and writes its result to a folder.
fn search_into(
    args: &RunArgs,
    how: &SearchArgs,
    dir: &Path,
    asked: &Asked,
    setup: Setup,
) -> Result<Written, Failure> {
    let planned = args.planned(dir, asked)?;
    // if the folder cannot be written, the run fails now and not after the search
    let folder = ResultFolder::open(dir, RUN, &planned)?;
    let unfinished = &unfinished_in(dir, "search");
    let record = args.record(dir, &planned, unfinished)?;
    let (supplements, record) = (&args.supplements, record.as_ref());
    let keep = |files: &[(String, Vec<u8>)]| folder.publish(files);
    let settings = SearchSettings { setup, dir, keep: &keep, unfinished, how, supplements, record };
    let written = search(asked, &settings);
    folder.settle(written.as_ref().map(|written| written.exit))?;
    written
}

/// Searches one shard of a study (the part of its designs that `--shard M/N` names), and writes the shard.
fn run_part(args: &RunArgs, shard: Shard, asked: &Asked, setup: Setup) -> Result<Answer, Failure> {
    if args.effects.is_some() {
        let hint = "run the study.json of a run with --effects, which has them, in shards";
        return Err(Failure::Usage(format!("--shard does not go with --effects: {hint}")));
    }
    if !args.supplements.is_default() {
        return Err(Failure::Usage(
            "--shard does not go with --within and --tolerance: give them to merge".into(),
        ));
    }
    let mut words = vec!["run".to_string(), args.study.clone()];
    words.extend(args.mass_max_kg.into_iter().flat_map(|kg| ["--mass-max-kg".into(), kg.to_string()]));
    words.extend(args.search.words());
    words.extend(args.incumbents.iter().flat_map(|dir| ["--incumbents".into(), dir.display().to_string()]));
    words.extend(setup.overlay.into_iter().flat_map(|dir| ["--catalogs".into(), dir.display().to_string()]));
    let shards = in_results(&args.folder(&asked.study)).join("shards");
    let dir = args.out.clone().unwrap_or_else(|| folder_of(&shards, shard));
    args.refuse_record_over_input()?;
    let planned = [SHARD, CANDIDATES, STUDY].map(String::from);
    let folder = ResultFolder::open(&dir, SHARD, &planned)?;
    let unfinished = &unfinished_in(&dir, "search");
    let record = args.record(&dir, &planned, unfinished)?;
    let (how, supplements, record) = (&args.search, &args.supplements, record.as_ref());
    let keep = |files: &[(String, Vec<u8>)]| folder.publish(files);
    let settings = SearchSettings { setup, dir: &dir, keep: &keep, unfinished, how, supplements, record };
    let answer = run_shard(asked, shard, &args.incumbents, words, &settings);
    folder.settle(answer.as_ref().map(|answer| answer.exit))?;
    answer
}

/// Runs one of the studies of the paper, which are computed without a search.
fn run_paper(args: &RunArgs, Setup { catalogs, log, .. }: Setup) -> Result<String, Failure> {
    let dir = args.out.clone().unwrap_or_else(|| in_results(&args.study));
    let planned = [RUN, SUMMARY, PAGE];
    let folder = ResultFolder::open(&dir, RUN, &planned)?;
    let started = Instant::now();
    let output = crate::paper::run::run(&args.study, catalogs).map_err(|e| Failure::Usage(e.to_string()))?;
    refuse_if_stopped()?;
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
    files.push((RUN.into(), pretty(&run)));
    files.extend(page.into_files());
    let left_out = folder.publish(&files)?;
    say_taken(&left_out, log);
    files.retain(|(name, _)| !left_out.contains(name));
    Ok(format!("{}\n{}", output.terminal, told(&dir, &files)))
}

/// Significant digits of the numbers in the tables of a page. The files have all digits.
const PAGE_DIGITS: usize = 5;

/// Columns of the tables of the paper's studies that only programs use. The page leaves them out.
const MACHINE_COLUMNS: [&str; 2] = ["id", "paper"];

/// The header, in words, of a column of a table of the paper's studies.
fn header_words(column: &str) -> String {
    match column {
        "paper_words" => "in the paper".into(),
        "reading_value" => "by the reading".into(),
        "exact" => "exactly".into(),
        column => key_words(column),
    }
}

/// The page, for a browser, of one of the paper's studies, with the pictures and tables of the study.
fn paper_page(study: &str, files: &[(String, Vec<u8>)], run: &Value) -> DocumentPage {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let Facts { lasting: facts, timing } = facts_of(run);
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
                let table =
                    Table::from_csv(&text(bytes)).without(&MACHINE_COLUMNS).with_headers(header_words);
                (caption, table.rounded(PAGE_DIGITS))
            })
            .collect(),
        facts,
        timing,
    }
}

/// A text that says which files were written, in lines of at most 80 columns.
fn told(dir: &Path, files: &[(String, Vec<u8>)]) -> String {
    wrap(&format!("written to {}: {}", dir.display(), names(files)), TERMINAL, "")
}

/// Names of the files that were written. Fronts of materials and plots are only counted.
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
