//! Finds picks that are on a front only because of their weight: first fit gave them larger drives because of this
//! weight. For each such pick, there is a lighter arm with the same drives.

use super::table::link_words;
use crate::pareto::objectives::Objectives;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::report::picks::{Pick, designs, picks};
use crate::report::section::PageSection;
use crate::report::supplement::Supplement;
use crate::report::words::{TERMINAL, and, wrap};
use crate::search::same_drives::OnSameDrives;
use crate::space::design::{Part, full_objectives};
use crate::space::problem::ArmProblem;
use rayon::prelude::*;
use serde_json::{Value, json};

/// Key of this report in `run.json`.
pub(crate) const KEY: &str = "lighter_on_same_drives";

/// A pick, and a lighter arm with the same drives that is at least as good.
#[derive(Debug, Clone, PartialEq)]
struct Beaten {
    pick: Pick,
    /// The pieces that differ, each with its part in the lighter arm.
    exchanged: Vec<(String, String)>,
    /// Names of the joints for which first fit would choose a smaller drive in the lighter arm.
    joints: Vec<String>,
    lighter: Objectives,
}

/// The picks of a front that a lighter arm with the same drives dominates.
#[derive(Debug, Clone, PartialEq)]
pub struct PicksOnSameDrives(Vec<Beaten>);

/// Searches for a lighter arm with the drives of each pick, among the options of `problem`.
pub fn picks_on_same_drives(problem: &ArmProblem, front: &FrontTable) -> PicksOnSameDrives {
    let beaten = |pick: Pick| {
        let options = problem.options_of_id(&pick.design.design_id)?;
        Beaten::new(problem, pick, &problem.lighter_on_same_drives(&options)?)
    };
    PicksOnSameDrives(picks(&designs(front)).into_par_iter().filter_map(beaten).collect())
}

impl Beaten {
    fn new(problem: &ArmProblem, pick: Pick, on: &OnSameDrives) -> Option<Self> {
        let pieces = &problem.space().pieces;
        let parts = problem.parts_of(&on.arm);
        let exchanged = on.exchanged.iter().map(|&piece| {
            let part = match &parts[piece] {
                Part::Drive(drive) => drive.name(),
                Part::Link(option) => link_words(option),
                Part::Given => String::new(),
            };
            (pieces[piece].name().to_string(), part)
        });
        Some(Self {
            pick,
            exchanged: exchanged.collect(),
            joints: on.oversized.iter().map(|&piece| pieces[piece].name().to_string()).collect(),
            lighter: full_objectives(&problem.arm_of(&on.arm)?, &problem.load_cases()),
        })
    }

    fn sentence(&self) -> String {
        let Objectives { tip_deflection_m, mass_kg, lowest_mode_hz } = self.lighter;
        let parts: Vec<String> = self.exchanged.iter().map(|(at, part)| format!("{part} at {at}")).collect();
        format!(
            "{} ({}) is on the front only because its weight gives {} a larger drive. On the same drives, an arm with {} has {} kg \
             instead of {} kg, {} mm instead of {} mm and {} Hz instead of {} Hz.",
            self.pick.names.join(", "),
            self.pick.design.design_id,
            and(&self.joints),
            and(&parts),
            significant(mass_kg, 4),
            significant(self.pick.design.mass_kg, 4),
            significant(1e3 * tip_deflection_m, 4),
            significant(self.pick.design.tip_deflection_mm, 4),
            significant(lowest_mode_hz, 4),
            significant(self.pick.design.lowest_mode_hz, 4),
        )
    }

    fn to_json(&self) -> Value {
        let part = |(at, part): &(String, String)| json!({"at": at, "part": part});
        json!({
            "names": self.pick.names,
            "design_id": self.pick.design.design_id,
            "joints": self.joints,
            "exchanged": self.exchanged.iter().map(part).collect::<Vec<Value>>(),
            "mass_kg": self.lighter.mass_kg,
            "tip_deflection_mm": 1e3 * self.lighter.tip_deflection_m,
            "lowest_mode_hz": self.lighter.lowest_mode_hz,
        })
    }
}

/// Advice at the end of the report: why the lighter arm is no design of the study, and what makes it one.
const ADVICE: &str = "That arm is not a design of this study, because first fit would give it smaller drives. With `\"drive\": \"all_fits\"` at \
                      these joints the search chooses the drives itself.";

impl PicksOnSameDrives {
    /// Everything that a result reports about these picks: sections, entry of `run.json`, terminal text.
    pub fn supplement(&self) -> Supplement {
        let run = Some((KEY, self.0.iter().map(Beaten::to_json).collect()));
        if self.0.is_empty() {
            return Supplement { run, ..Supplement::default() };
        }
        let words: Vec<String> = self.0.iter().map(Beaten::sentence).chain([ADVICE.into()]).collect();
        Supplement {
            file: None,
            markdown: format!("\n## Drives that came with weight\n\n{}\n", words.join("\n\n")),
            terminal: words.iter().map(|sentence| wrap(sentence, TERMINAL, "")).collect(),
            section: Some(PageSection {
                title: "Drives that came with weight".into(),
                words,
                ..PageSection::default()
            }),
            run,
        }
    }
}
