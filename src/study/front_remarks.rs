//! What a reader should know of a front besides its numbers: remarks, caveats, and what the study judged.

use super::bearing_remarks::bearing_remarks;
use super::definition::Study;
use super::gear_remarks::{life_remarks_on, play_remarks};
use super::given_parts::given_parts;
use super::given_remarks::GivenDrives;
use super::given_tube_remarks::given_tube_remarks;
use super::guide_remarks::guide_remarks;
use super::motor_remarks::{heat_remark, stop_remark};
use super::outcome::Front;
use super::reaction_remarks::reaction_remark;
use super::stated_bearing_remarks::stated_bearing_remarks;
use super::table::front_table_with;
use crate::arm::effect::entry::Effect;
use crate::catalog::Catalogs;
use crate::report::caveats::Caveats;
use crate::report::front_table::FrontTable;
use crate::report::picks;
use crate::space::problem::ArmProblem;
use serde_json::{Value, json};

/// The table of the front of a study, and remarks in sentences: on the question, and on the output bearings, gears,
/// motors, given drives and guides in the answer. The remarks are those that `run.json` has under `remarks`.
pub fn table_and_remarks(
    study: &Study,
    problem: &ArmProblem,
    catalogs: &Catalogs,
    front: &Front,
) -> (FrontTable, Vec<String>) {
    let mut given = GivenDrives::of(problem, catalogs);
    let table = front_table_with(problem, catalogs, front, |rows| given.take(rows));
    let of_study = study.remarks.iter().cloned();
    let of_bearings = bearing_remarks(&study.space, catalogs, &table);
    let of_stated = stated_bearing_remarks(problem, catalogs, &table);
    let of_lives = life_remarks_on(&study.space, catalogs, &table);
    let of_play = play_remarks(&study.space, catalogs, &table);
    let of_given = given.remarks(front.len());
    let of_guides = guide_remarks(problem, &table);
    let of_tubes = given_tube_remarks(problem, &table);
    let of_reactions = reaction_remark(problem, catalogs, &table);
    let of_stops = stop_remark(problem, catalogs, &table);
    let of_motors = of_stops.into_iter().chain(heat_remark(problem, catalogs, &table));
    let of_drives = of_lives.into_iter().chain(of_play).chain(of_given).chain(of_reactions).chain(of_motors);
    let of_structure = of_guides.into_iter().chain(of_tubes);
    let of_parts = of_bearings.into_iter().chain(of_stated).chain(of_drives).chain(of_structure);
    let remarks = of_study.chain(of_parts).collect();
    (table, remarks)
}

/// The caveats of the catalogs' parts, and of the parts that the study gives.
pub(crate) fn caveats_of(study: &Study, catalogs: &Catalogs) -> Caveats {
    Caveats::of(catalogs).with_given(given_parts(&study.space))
}

/// A sentence on parts whose ratings were not read in a document of their vendor, with the picks of the front that use
/// them. `run.json` has this sentence under `caveats`. `None` if there is no such part.
pub fn caveats_on(study: &Study, catalogs: &Catalogs, front: &FrontTable) -> Option<String> {
    let picked = picks::rows_and_names(&picks::picks(&picks::designs(front)));
    let sentence = caveats_of(study, catalogs).sentence(front, &picked);
    (!sentence.is_empty()).then(|| sentence.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// The effects of a study as JSON. The key `counts` of an effect is false if it describes a test, because its results
/// then ignore the effect.
pub fn effects_json(study: &Study) -> Vec<Value> {
    let counted = |effect: &Effect| {
        let mut value = effect.to_json();
        value["counts"] = json!(!effect.is_of_test());
        value
    };
    study.space.effects.iter().map(counted).collect()
}

/// The names of the cases in which a study judges its designs.
pub fn judged_cases(study: &Study) -> Vec<String> {
    let space = &study.space;
    space.judged_cases.iter().map(|&i| space.cases[i].name.clone()).collect()
}
