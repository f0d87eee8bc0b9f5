//! The `armwright` command: parse, call a verb, print one error.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = armwright::cli::Cli::parse();
    match armwright::cli::run(cli) {
        Ok(text) => {
            armwright::cli::print(&text);
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}
