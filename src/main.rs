//! The `armwright` command: parse, call a verb, print one error.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = armwright::command_line::Cli::parse();
    let log = cli.log();
    match armwright::command_line::run(cli) {
        Ok(answer) => {
            armwright::command_line::print(&answer.text);
            ExitCode::from(answer.exit.code())
        }
        Err(failure) => {
            log.error(&failure);
            ExitCode::from(failure.exit_code())
        }
    }
}
