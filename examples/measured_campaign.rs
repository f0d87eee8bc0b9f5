//! Makes a campaign folder for `armwright reconcile` from published measurements of a real machine.
//!
//! Run: cargo run --release --example measured_campaign -- MACHINE DATA FOLDER
//!
//! MACHINE is `motoman` or `justin`, and DATA is the CSV file with the positions of this machine. FOLDER is made,
//! together with its parent folders.

mod measured;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let made = match words[..] {
        ["motoman", data, folder] => measured::motoman::campaign(Path::new(data), Path::new(folder)),
        ["justin", data, folder] => measured::justin::campaign(Path::new(data), Path::new(folder)),
        _ => {
            eprintln!("give a machine (motoman, justin), its data and a folder");
            return ExitCode::FAILURE;
        }
    };
    match made {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}
