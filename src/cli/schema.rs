//! `armwright schema`: the keys or columns of a kind of file, for editors and other programs. It describes the files
//! that users write and the files that the program writes.

use super::effects_schema::{EFFECTS, effects_schema};
use super::failure::Failure;
use super::output_keys::OUTPUTS;
use super::output_tables::TABLES;
use super::values::proposed;
use crate::arm::{ARM_FILE, CASES_FILE};
use crate::catalog::schema::CatalogFile;
use crate::input::schema::FileKind;
use crate::interchange::keys::STIFFNESS_FILE;
use crate::reconcile::CAMPAIGN_FILE;
use crate::study::STUDY_FILE;
use crate::study::load_limits::LIMITS_FILE;
use clap::Args;
use serde_json::Value;

/// Arguments of `schema`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  armwright schema\n  armwright schema study > study.schema.json\n  \
    armwright schema gears\n  armwright schema arm --markdown\n  armwright schema run > run.schema.json\n\n\
    Prints the JSON Schema of a kind of file (draft 2020-12), or the Table Schema of a catalog file; without a kind, lists the \
    kinds. An editor that knows the schema completes keys and marks faults while one types. A file may name its schema: \
    {\"$schema\": \"study.schema.json\", ...}")]
pub(crate) struct SchemaArgs {
    /// Kind of file
    #[arg(value_name = "KIND", value_parser = proposed(kinds()), hide_possible_values = true)]
    kind: Option<String>,
    /// Print the keys as Markdown tables; without a kind, those of every JSON file
    #[arg(long)]
    markdown: bool,
}

/// The kinds of JSON files that users write.
pub(super) const FILES: [FileKind; 6] =
    [ARM_FILE, CASES_FILE, STUDY_FILE, CAMPAIGN_FILE, STIFFNESS_FILE, LIMITS_FILE];

/// Beginning of the page with all keys.
const PAGE_HEAD: &str = "# Keys of all files\n\nEvery key that the readers know, printed by `armwright schema --markdown`. \
    A key that is not here is a fault in a file. [arm-format.md](arm-format.md), [study-format.md](study-format.md) and \
    [reconcile.md](reconcile.md) explain how the keys work together. `armwright schema KIND` prints the same as a JSON Schema.\n";

/// Text before the keys of the files that the program writes.
const WRITTEN_HEAD: &str = "The following files are written by the program, for other programs to read. A key that is added later is \
    no change of the form; none is renamed. What stands under *default* says when a key is missing. The columns of `front.csv` and \
    `bom.csv` are printed by `armwright schema front` and `bom`, the parameters of effects by `armwright schema effects`.\n";

/// Runs `armwright schema` and returns the text to print.
///
/// # Errors
/// There is no kind of file with this name.
pub(super) fn run(args: &SchemaArgs) -> Result<String, Failure> {
    let file = |name: &str| FILES.iter().chain(&OUTPUTS).find(|file| file.name == name);
    match (args.kind.as_deref(), args.markdown) {
        (None, false) => Ok(list()),
        (None, true) => Ok(page()),
        (Some(name), true) => file(name).map(FileKind::tables).ok_or_else(|| unknown(name)),
        (Some(name), false) => {
            let schema = file(name).map(FileKind::schema);
            schema.or_else(|| table_schema(name)).map(|s| format!("{s:#}\n")).ok_or_else(|| unknown(name))
        }
    }
}

/// The schema of the table `name`, or that of effects; `None` if there is no such schema.
fn table_schema(name: &str) -> Option<Value> {
    let catalog = CatalogFile::ALL.into_iter().find(|file| stem(*file) == name);
    let written = || TABLES.iter().find(|table| table.name == name).map(|table| table.schema());
    let effects = || (name == EFFECTS.0).then(effects_schema);
    catalog.map(CatalogFile::table_schema).or_else(written).or_else(effects)
}

/// Name of a catalog file without `.csv`.
fn stem(file: CatalogFile) -> &'static str {
    file.file_name().trim_end_matches(".csv")
}

fn unknown(name: &str) -> Failure {
    Failure::Usage(format!("there is no kind of file \"{name}\"; kinds: {}", kinds().join(", ")))
}

/// The names of all kinds of files.
fn kinds() -> Vec<&'static str> {
    let json = FILES.iter().chain(&OUTPUTS).map(|file| file.name);
    let tables = TABLES.iter().map(|table| table.name).chain([EFFECTS.0]);
    json.chain(CatalogFile::ALL.into_iter().map(stem)).chain(tables).collect()
}

fn list() -> String {
    let json = FILES.iter().map(|file| (file.name, file.about.to_string()));
    let csv = CatalogFile::ALL
        .into_iter()
        .map(|file| (stem(file), format!("The catalog file {}, as a Table Schema.", file.file_name())));
    let written = OUTPUTS.iter().map(|file| (file.name, format!("Written: {}", file.about.replace('`', ""))));
    let tables = TABLES.iter().map(|table| (table.name, format!("Written: {}", table.about)));
    let effects = std::iter::once((EFFECTS.0, EFFECTS.1.to_string()));
    let all = json.chain(csv).chain(effects).chain(written).chain(tables);
    all.map(|(name, about)| format!("{name:<18}{about}\n")).collect()
}

fn page() -> String {
    let tables = |files: &[FileKind]| files.iter().map(FileKind::tables).collect::<Vec<_>>().join("\n");
    format!("{PAGE_HEAD}\n{}\n{WRITTEN_HEAD}\n{}", tables(&FILES), tables(&OUTPUTS))
}
