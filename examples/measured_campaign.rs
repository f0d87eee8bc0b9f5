//! Makes a campaign folder from published measurements of a real machine, for `armwright reconcile`.
//!
//! Run: cargo run --release --example measured_campaign -- MACHINE DATA FOLDER
//! (MACHINE: motoman or justin; DATA: the CSV file of its positions; FOLDER: made with its parents)

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
