//! The `armwright` command: parse, call a verb, print one error.

use armwright::command_line::{Cli, Failure, print, printed, run, say};
use clap::Parser;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

fn main() -> ExitCode {
    let done = match Cli::try_parse() {
        Ok(cli) => without_panic(cli).and_then(|text| print(&text)),
        Err(asked) if asked.use_stderr() => {
            // wrong usage; where standard error cannot be written the exit code says it
            let _ = asked.print();
            return ExitCode::from(Failure::Usage(String::new()).exit_code());
        }
        // help and version
        Err(asked) => printed(asked.print()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            say(&format!("error: {failure}\n"));
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Executes a command line; a panic, whose message is on standard error by now, becomes an internal error.
fn without_panic(cli: Cli) -> Result<String, Failure> {
    catch_unwind(AssertUnwindSafe(|| run(cli))).unwrap_or_else(|_| {
        let words = "this is a fault of armwright, please report it with the input and the lines above";
        Err(Failure::Internal(words.into()))
    })
}
