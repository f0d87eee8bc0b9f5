//! The fronts of the choices of springs and counterweights of a study, joined into one.

use super::front_table::FrontTable;
use super::picks::{Design, Pick, designs, picks};
use super::table::{Column, Table};
use crate::pareto::front::nondominated;

/// Column of the joint front with the folder of the choice to which a design belongs.
const CHOICE: &str = "choice";
/// Column of a front with the number of the set of equally good designs to which a design belongs.
const TIE_GROUP: &str = "tie_group";

/// The front of one choice of springs and counterweights.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ChoiceFront {
    /// Name of the folder with the result of this choice.
    pub folder: String,
    /// The choice of springs and counterweights in words.
    pub words: String,
    /// Name of the column of each number that is chosen, and the number's value.
    pub values: Vec<(String, f64)>,
    /// How the search of this choice ended, as in its `run.json`.
    pub status: String,
    /// The gap that an exact search of this choice proved; `None` for a visit of all designs, and if none was proved.
    pub gap: Option<f64>,
    /// The front of this choice; without rows if no design meets the limits.
    pub front: FrontTable,
}

/// The joint front: the designs of all choices that no design of any choice dominates. Its columns are the choice, the
/// numbers that are chosen, and the columns of the fronts; a cell is blank where a front does not have the column.
pub(crate) fn joint_front(choices: &[ChoiceFront]) -> FrontTable {
    let listed: Vec<(&ChoiceFront, Design)> = choices
        .iter()
        .flat_map(|of| designs(&of.front).into_iter().map(move |design| (of, design)))
        .collect();
    let points: Vec<[f64; 3]> = listed
        .iter()
        .map(|(_, design)| [design.tip_deflection_mm, design.mass_kg, -design.lowest_mode_hz])
        .collect();
    let groups = nondominated(&points).expect("the objectives of listed designs are finite");
    let own = columns(choices);
    let row = |tie_group: usize, (of, design): &(&ChoiceFront, Design)| -> Vec<String> {
        let cell = |name: &String| match of.front.column(name) {
            _ if name == TIE_GROUP => tie_group.to_string(),
            Some(column) => of.front.rows[design.row][column].clone(),
            None => String::new(),
        };
        let chosen = of.values.iter().map(|(_, value)| value.to_string());
        std::iter::once(of.folder.clone()).chain(chosen).chain(own.iter().map(cell)).collect()
    };
    let rows = groups
        .iter()
        .enumerate()
        .flat_map(|(group, members)| members.iter().map(move |&i| (group + 1, i)))
        .map(|(tie_group, i)| row(tie_group, &listed[i]));
    let chosen = choices.first().into_iter().flat_map(|of| &of.values).map(|(column, _)| column.clone());
    FrontTable {
        columns: std::iter::once(CHOICE.to_string()).chain(chosen).chain(own.clone()).collect(),
        rows: rows.collect(),
    }
}

/// The columns of all fronts, each once, in the order in which they are found.
fn columns(choices: &[ChoiceFront]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for column in choices.iter().flat_map(|of| &of.front.columns) {
        if !out.contains(column) {
            out.push(column.clone());
        }
    }
    out
}

/// A table with one row per choice: how its search ended, the size of its front, and how many of these designs are on
/// the joint front `joint`.
pub(crate) fn choices_table(choices: &[ChoiceFront], joint: &FrontTable) -> Table {
    let mut table = Table::new(vec![
        Column::left("folder"),
        Column::left("choice"),
        Column::left("search"),
        Column::right("designs on its front"),
        Column::right("of these on the joint front"),
    ]);
    for of in choices {
        let on_joint = folders(joint).filter(|folder| *folder == of.folder).count();
        table.row([
            of.folder.clone(),
            of.words.clone(),
            of.status.clone(),
            of.front.rows.len().to_string(),
            on_joint.to_string(),
        ]);
    }
    table
}

/// The picks of the joint front, each with the choice to which it belongs.
pub(crate) fn picks_of_joint<'c>(
    choices: &'c [ChoiceFront],
    joint: &FrontTable,
) -> Vec<(Pick, &'c ChoiceFront)> {
    let of_row: Vec<&str> = folders(joint).collect();
    let with_choice = |pick: Pick| {
        let of = choices.iter().find(|of| of.folder == of_row[pick.design.row])?;
        Some((pick, of))
    };
    picks(&designs(joint)).into_iter().filter_map(with_choice).collect()
}

/// The folder of each row of a joint front.
fn folders(joint: &FrontTable) -> impl Iterator<Item = &str> {
    let column = joint.column(CHOICE);
    joint.rows.iter().filter_map(move |row| Some(row[column?].as_str()))
}
