//! The `armwright` command: parse, call a verb, print one error.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = armwright::command_line::Cli::parse();
    match armwright::command_line::run(cli) {
        Ok(text) => {
            armwright::command_line::print(&text);
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}
