//! `armwright compare`: compares fronts with each other.

use super::compare_remarks::{remarks, said_by};
use super::failure::Failure;
use super::finished::front_of_material;
use super::manifest::FRONT;
use super::own_files::write_own;
use super::result_folder::complete;
use super::results::Results;
use super::values::number_list;
use crate::report::compare::comparison::{Comparison, compare};
use crate::report::compare::contender::Contender;
use crate::report::compare::moved::moved;
use crate::report::compare::thresholds::Thresholds;
use crate::report::front_svg::{FrontPicture, PlottedFront};
use crate::report::front_table::{FrontTable, FrontTableError};
use crate::report::html::comparison::page as comparison_page;
use crate::report::whole_file::folder_of;
use clap::Args;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Compares fronts: which is lightest at a given tip deflection, which is stiffest and has the highest mode
/// at a given mass, which is lightest for a given lowest mode, and what the material costs.
///
/// Given one result folder, it compares the materials of that study. Given several, it compares their overall
/// fronts and, if they are runs of one study, says what changed. Front files (`front.csv`,
/// `front.<material>.csv`) may be given too.
#[derive(Debug, Args)]
#[command(after_help = "Examples: armwright compare results/compare-materials\n          \
                        armwright compare results/compare-materials --deflection-mm 1,2,5 --mass-kg 40,60 \
                        --mode-hz 10,15 --out comparison\n          \
                        armwright compare results/light-arm results/stiff-arm")]
pub(crate) struct CompareArgs {
    /// Result folders of `armwright run`, or front files
    #[arg(required = true, value_name = "RESULTS")]
    pub results: Vec<PathBuf>,
    /// Tip deflections (mm) at which masses are compared, separated by commas. If no limit of any kind is
    /// given, round numbers are chosen where the fronts overlap; otherwise only what is given is compared
    #[arg(long, value_name = "MM", value_parser = limits)]
    pub deflection_mm: Option<Limits>,
    /// Masses (kg) at which deflections and modes are compared
    #[arg(long, value_name = "KG", value_parser = limits)]
    pub mass_kg: Option<Limits>,
    /// Limits on the lowest mode (Hz), separated by commas. For each, the lightest design of every front whose lowest
    /// mode is at least the limit is shown
    #[arg(long, value_name = "HZ", value_parser = limits)]
    pub mode_hz: Option<Limits>,
    /// Folder for compare.md, compare.csv, compare.svg and report.html, a page for a browser
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print JSON instead of tables
    #[arg(long)]
    pub json: bool,
}

/// Numbers from the command line at which fronts are compared.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Limits(pub Vec<f64>);

/// Reads numbers greater than zero, separated by commas.
fn limits(text: &str) -> Result<Limits, String> {
    let list = number_list(text)?;
    match list.iter().find(|x| **x <= 0.0) {
        Some(x) => Err(format!("{x} is not greater than zero")),
        None => Ok(Limits(list)),
    }
}

/// Runs `armwright compare` and returns the text to print.
///
/// # Errors
/// A folder or file is missing, is not a result, or cannot be written.
pub(crate) fn run(args: &CompareArgs) -> Result<String, Failure> {
    let loaded = load(&args.results)?;
    let mut comparison = compare(&loaded.contenders, &thresholds(args));
    if loaded.one_study {
        let (first, others) = loaded.contenders.split_first().unzip();
        let pairs = first.into_iter().flat_map(|a| others.unwrap_or_default().iter().map(move |b| (a, b)));
        comparison.moved = pairs.map(|(a, b)| moved(a, b)).collect();
    }
    comparison.remarks = remarks(&said_by(&args.results, labels(&args.results))?);
    let mut out = if args.json { json_text(&comparison) } else { comparison.to_text() };
    if let Some(dir) = &args.out {
        let inputs: Vec<&Path> = args.results.iter().map(PathBuf::as_path).collect();
        write_own(dir, &files_of_comparison(&comparison, &loaded.contenders), &inputs)?;
        if !args.json {
            out.push_str(&format!(
                "\nwritten to {}: compare.md, compare.csv, compare.svg, report.html\n",
                dir.display()
            ));
        }
    }
    Ok(out)
}

fn thresholds(args: &CompareArgs) -> Thresholds {
    let given = |limits: &Option<Limits>| limits.as_ref().map_or(Vec::new(), |l| l.0.clone());
    Thresholds {
        deflection_mm: given(&args.deflection_mm),
        mass_kg: given(&args.mass_kg),
        mode_hz: given(&args.mode_hz),
    }
}

fn json_text(comparison: &Comparison) -> String {
    serde_json::to_string_pretty(comparison).expect("a comparison of numbers and strings serializes")
}

/// The files of a comparison of fronts.
pub(super) fn files_of_comparison(
    comparison: &Comparison,
    contenders: &[Contender],
) -> Vec<(String, Vec<u8>)> {
    let picture = FrontPicture {
        title: "Fronts side by side".into(),
        fronts: contenders
            .iter()
            .map(|c| PlottedFront { name: c.label.clone(), front: &c.front, muted: c.reference })
            .collect(),
        picks: Vec::new(),
    };
    let svg = picture.to_svg();
    let mut out: Vec<(String, Vec<u8>)> = vec![
        ("compare.md".into(), comparison.to_markdown().into_bytes()),
        ("compare.csv".into(), comparison.to_csv().into_bytes()),
        ("compare.svg".into(), svg.clone().into_bytes()),
    ];
    out.extend(comparison_page(comparison, contenders, svg).into_files());
    out
}

/// The fronts to compare.
struct Loaded {
    contenders: Vec<Contender>,
    /// Whether the fronts are several runs of one study.
    one_study: bool,
}

fn load(results: &[PathBuf]) -> Result<Loaded, Failure> {
    for path in results {
        complete(&if path.is_dir() { path.clone() } else { folder_of(path) })?;
    }
    if let [one] = results
        && one.is_dir()
    {
        return Ok(Loaded { contenders: materials_of(one)?, one_study: false });
    }
    let labels = labels(results);
    let contenders = results
        .iter()
        .zip(&labels)
        .map(|(path, label)| Ok(Contender::new(label, front_at(path)?)))
        .collect::<Result<Vec<_>, Failure>>()?;
    Ok(Loaded { contenders, one_study: results.len() > 1 && is_one_study(results) })
}

/// The front of a result folder or of a front file. If there is no `run.json` in its folder, the front is read
/// without information on the run.
fn front_at(path: &Path) -> Result<FrontTable, Failure> {
    if path.is_dir() {
        return match Results::around(&front_file(path)?)? {
            Some(results) => results.front(FRONT),
            None => read_front(&front_file(path)?),
        };
    }
    if !path.exists() {
        return Err(Failure::File(format!(
            "cannot read {}: no such file or folder; give a result folder of `armwright run` or a front file",
            path.display()
        )));
    }
    match (Results::around(path)?, path.file_name().and_then(|name| name.to_str())) {
        (Some(results), Some(name)) if results.has(name) => results.front(name),
        _ => read_front(path),
    }
}

/// The file with the front of all designs in a result folder.
fn front_file(dir: &Path) -> Result<PathBuf, Failure> {
    let file = dir.join(FRONT);
    if file.is_file() {
        return Ok(file);
    }
    Err(Failure::File(format!(
        "{} is not a result folder: it has no front.csv; `armwright run STUDY --out {}` writes one",
        dir.display(),
        dir.display()
    )))
}

fn read_front(file: &Path) -> Result<FrontTable, Failure> {
    FrontTable::read(file).map_err(|error: FrontTableError| Failure::File(error.to_string()))
}

/// The front of all designs of a result as the reference, followed by the front of each material.
fn materials_of(dir: &Path) -> Result<Vec<Contender>, Failure> {
    front_file(dir)?;
    let results = Results::open(dir)?;
    let mut out = vec![Contender { reference: true, ..Contender::new("all", results.front(FRONT)?) }];
    for Listed { name, slug } in listed_materials(&results.run) {
        out.push(Contender::new(&name, results.front(&front_of_material(&slug))?));
    }
    // if there are no fronts of materials, the front of all designs is compared like any other
    out[0].reference = out.len() > 1;
    Ok(out)
}

/// A material of `run.json`.
struct Listed {
    name: String,
    /// Short name of the material, which is a part of the names of its files.
    slug: String,
}

/// Every material of `run.json`.
fn listed_materials(run: &Value) -> Vec<Listed> {
    let entries = run["materials"].as_array().cloned().unwrap_or_default();
    let text = |entry: &Value, key: &str| entry[key].as_str().map(String::from);
    entries.iter().filter_map(|e| Some(Listed { name: text(e, "name")?, slug: text(e, "slug")? })).collect()
}

/// Whether all paths are result folders of the same study.
fn is_one_study(results: &[PathBuf]) -> bool {
    let study = |path: &PathBuf| Results::open(path).ok()?.run["study"].as_str().map(String::from);
    let first = results.first().and_then(study);
    first.is_some() && results.iter().all(|r| study(r) == first)
}

/// A label for every path: the fewest last components of the path that distinguish it from the other paths.
fn labels(results: &[PathBuf]) -> Vec<String> {
    let most = results.iter().map(|r| r.components().count()).max().unwrap_or(1);
    let at = |parts: usize| results.iter().map(|r| last_parts(r, parts)).collect::<Vec<_>>();
    let differ = |labels: &Vec<String>| labels.iter().enumerate().all(|(i, l)| !labels[..i].contains(l));
    (1..=most).map(at).find(differ).unwrap_or_else(|| numbered(at(most)))
}

/// The last `parts` components of a path. For a file, `front.` and `.csv` are removed from its name.
fn last_parts(path: &Path, parts: usize) -> String {
    let full: Vec<String> = path.components().map(|c| c.as_os_str().to_string_lossy().into_owned()).collect();
    let mut kept = full[full.len().saturating_sub(parts)..].to_vec();
    if let Some(name) = kept.last_mut().filter(|_| !path.is_dir()) {
        let stem = name.trim_end_matches(".csv");
        *name = stem.strip_prefix("front.").unwrap_or(stem).to_string();
    }
    kept.join("/")
}

fn numbered(labels: Vec<String>) -> Vec<String> {
    labels.into_iter().enumerate().map(|(i, l)| format!("{l} #{}", i + 1)).collect()
}
