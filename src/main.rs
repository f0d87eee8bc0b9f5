//! The `armwright` command: parses the command line, runs one subcommand, and prints at most one error.

use armwright::command_line::{Answer, Cli, Exit, Failure, Log, print, printed, run};
use clap::Parser;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut log = Log::asked_by(std::env::args_os());
    let done = match Cli::try_parse() {
        Ok(cli) => {
            log = cli.log();
            without_panic(cli).and_then(|answer| print(&answer.text).map(|()| answer.exit))
        }
        Err(asked) if asked.use_stderr() => {
            log.wrong_usage(&asked);
            return ExitCode::from(Exit::Usage.code());
        }
        // help and version
        Err(asked) => printed(asked.print()).map(|()| Exit::Done),
    };
    match done {
        Ok(exit) => ExitCode::from(exit.code()),
        Err(failure) => {
            log.error(&failure);
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Executes a command line. If it panics, the panic message is on standard error already, and the result is an
/// internal error.
fn without_panic(cli: Cli) -> Result<Answer, Failure> {
    catch_unwind(AssertUnwindSafe(|| run(cli))).unwrap_or_else(|_| {
        let words = "this is a fault of armwright, please report it with the input and the lines above";
        Err(Failure::Internal(words.into()))
    })
}
