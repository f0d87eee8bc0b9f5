//! `armwright completions` and `armwright man`: completion scripts for shells, and manual pages. Both are made from
//! the description of the command line.

use super::failure::Failure;
use super::own_files::write_recognized;
use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;
use std::path::PathBuf;

/// Name of the program.
const NAME: &str = "armwright";

/// Prints a script with which a shell completes verbs, flags and file names.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  armwright completions bash > ~/.local/share/bash-completion/completions/armwright\n  \
    armwright completions zsh > ~/.zfunc/_armwright\n  \
    armwright completions fish > ~/.config/fish/completions/armwright.fish"
)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Writes a manual page for the program and for each verb.
#[derive(Debug, Args)]
#[command(after_help = "Example: armwright man --out ~/.local/share/man/man1")]
pub(crate) struct ManArgs {
    /// Folder to write to, made with its parents
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// The script with which a shell completes verbs, flags and file names, made from the description of the command line.
pub(super) fn completions(args: &CompletionsArgs, mut command: Command) -> String {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, NAME, &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// Writes the manual pages.
///
/// # Errors
/// A file cannot be written.
pub(super) fn man(args: &ManArgs, command: Command) -> Result<String, Failure> {
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let mut pages = Vec::new();
    add_pages(&command, NAME, &mut pages)?;
    // manual pages are put into folders that are packed and shared, so no list of files is written there
    let is_page = |_: &str, there: &[u8]| String::from_utf8_lossy(there).contains("\n.TH armwright");
    write_recognized(&args.out, &pages, &[], is_page)?;
    Ok(format!("{} pages written to {}\n", pages.len(), args.out.display()))
}

/// Adds the manual page of a command and the pages of its verbs.
fn add_pages(command: &Command, name: &str, pages: &mut Vec<(String, Vec<u8>)>) -> Result<(), Failure> {
    let mut page = Vec::new();
    let man = Man::new(command.clone()).title(name);
    man.render(&mut page).map_err(|e| Failure::Internal(e.to_string()))?;
    pages.push((format!("{name}.1"), page));
    command
        .get_subcommands()
        .try_for_each(|verb| add_pages(verb, &format!("{name}-{}", verb.get_name()), pages))
}
