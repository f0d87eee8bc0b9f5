//! Measures how the time of the exact search grows with the size of the space.
//!
//! `cargo run --release --example exact_growth -- 60` makes three series of searches of the study `full-catalog`:
//!
//! - in thinned spaces, from a few parts to all parts, for at most 60 s each (the argument). This is done once with
//!   modes that use the slope of a gear at its torque, and once with modes that use the gear's first slope K1.
//! - in the whole space up to a few limits of mass, without a gap.
//! - in the whole space for all arms, to smaller and smaller gaps. The last gap is the gap that the study asks for.
//!
//! Each line of the output has the elapsed time. It also has the processor time of all threads if the system tells it
//! (Linux).

use armwright::arm::JointModel;
use armwright::catalog::Catalogs;
use armwright::exact::Exact;
use armwright::input::Document;
use armwright::space::DesignSpace;
use armwright::space::design_space::{DriveChoice, SpacePiece};
use armwright::study::named;
use armwright::study::read_study;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// How spaces are thinned. A pair (n, m) keeps every n-th gear, every ceil(n/4)-th motor and every m-th option of a
/// link.
const THINNED: [(usize, usize); 8] =
    [(40, 4000), (25, 2000), (15, 1000), (10, 400), (6, 100), (4, 30), (2, 6), (1, 1)];

/// Limits of mass up to which the front is found whole \[kg\]. The lightest arm weighs 13.69 kg.
const UP_TO_KG: [f64; 5] = [13.75, 14.0, 14.25, 14.5, 14.75];
/// Gaps (relative) to which all arms are searched before the gap of the study.
const GAPS: [f64; 3] = [0.08, 0.05, 0.03];

fn main() {
    let limit_s = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(60);
    let catalogs = Catalogs::builtin();
    let text = named("full-catalog").expect("a named study");
    let document = Document::parse("full-catalog", text).expect("a named study is JSON");
    let study = read_study(document, &catalogs).expect("a named study is whole");
    head("designs");
    for joints in [JointModel::ThreeSegment, JointModel::ThreeSegmentK1] {
        for (parts, options) in THINNED {
            let space = DesignSpace { joints, ..thinned(&study.space, &catalogs, parts, options) };
            search(&space, &catalogs, 0.0, Some(Duration::from_secs(limit_s)));
        }
    }
    println!();
    head("up to");
    for mass_kg in UP_TO_KG {
        let mut space = study.space.clone();
        space.constraints.mass_max_kg = Some(mass_kg);
        search(&space, &catalogs, 0.0, None);
    }
    for joints in [JointModel::ThreeSegment, JointModel::ThreeSegmentK1] {
        for gap in GAPS.into_iter().chain([study.gap]) {
            search(&DesignSpace { joints, ..study.space.clone() }, &catalogs, gap, None);
        }
    }
}

fn head(space: &str) {
    println!(
        "{:<18}{:>10}{:>10}{:>12}{:>10}{:>13}{:>9}",
        "modes", space, "front", "boxes", "s", "processor s", "gap"
    );
}

/// Processor time of all threads of this process so far \[s\], in steps of 10 ms. `None` if the system does not tell
/// it.
fn processor_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program is in brackets and may have spaces. User time and system time are the fields 14 and 15.
    let fields: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |field: usize| fields.get(field - 3)?.parse::<f64>().ok();
    Some((ticks(14)? + ticks(15)?) / 100.0)
}

fn search(space: &DesignSpace, catalogs: &Catalogs, gap: f64, limit: Option<Duration>) {
    let stop = AtomicBool::new(false);
    let (started, before_s) = (Instant::now(), processor_s());
    let search = Exact::new(space, catalogs, &stop, limit.map(|limit| started + limit));
    let outcome = search.with_ties_up_to(0).to_gap(gap).run(&[]);
    println!(
        "{:<18}{:>10}{:>10}{:>12.2e}{:>10.2}{:>13}{:>9}",
        space.joints.word(),
        match (space.constraints.mass_max_kg, limit) {
            (Some(mass_kg), _) => format!("{mass_kg} kg"),
            (None, Some(_)) => format!("{:.1e}", outcome.designs_total as f64),
            (None, None) => "any mass".into(),
        },
        outcome.front.len(),
        outcome.boxes as f64,
        started.elapsed().as_secs_f64(),
        before_s.zip(processor_s()).map_or("-".into(), |(before, now)| format!("{:.2}", now - before)),
        outcome.gap.map_or("-".into(), |gap| format!("{:.1} %", 100.0 * gap)),
    );
}

/// The space with every `parts`-th gear of the catalogs, every `parts / 4`-th motor (rounded up), and every
/// `options`-th option of its links.
fn thinned(space: &DesignSpace, catalogs: &Catalogs, parts: usize, options: usize) -> DesignSpace {
    let mut space = space.clone();
    for piece in &mut space.pieces {
        match piece {
            SpacePiece::Joint(joint) => {
                if let DriveChoice::AllFits(filter) = &mut joint.drive {
                    // A catalog lists the gears of a series by torque, so every n-th gear gives gears of all sizes.
                    filter.gear_ids =
                        Some(catalogs.gears.iter().step_by(parts).map(|g| g.id.clone()).collect());
                    filter.motor_ids = Some(
                        catalogs.motors.iter().step_by(parts.div_ceil(4)).map(|m| m.id.clone()).collect(),
                    );
                }
            }
            SpacePiece::Choice(choice) => {
                choice.options = choice.options.iter().step_by(options).cloned().collect();
            }
            SpacePiece::Prismatic(_) | SpacePiece::Link(_) => {}
        }
    }
    space
}
