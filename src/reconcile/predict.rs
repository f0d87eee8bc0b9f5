//! The verb `predict`: adds the predictions of the model to a table of readings.

use super::model::direct::{Direct, subject};
use super::positions;
use super::readings::campaign::{Campaign, Statement, driven_joints};
use super::readings::cells::Purpose;
use super::readings::components::{DISPLACEMENT, POSITION};
use super::readings::rows::{modal_rows, position_rows, static_rows, windup_rows};
use super::readings::table::Table;
use crate::arm::Arm;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::subject::Subject;
use crate::input::json::Faults;
use crate::reconcile::readings::placement::Placed;

/// The channel (kind of readings) of a file, recognized by its columns; `None` if the file has no column of readings.
pub fn channel_of(table: &Table) -> Option<Channel> {
    let has = |name: &str| table.optional(name).is_some();
    match () {
        () if DISPLACEMENT.values.into_iter().any(has) => Some(Channel::Static),
        () if has("frequency_hz") => Some(Channel::Modal),
        () if has("windup_arcmin") => Some(Channel::Windup),
        () if POSITION.values.into_iter().any(has) => Some(Channel::Positions),
        () => None,
    }
}

/// The table of readings as CSV text, with columns of the model's predictions added. `arms` are the arm and the other
/// arms on the same trunk, each with its placement.
///
/// # Errors
/// All faults of the table.
pub fn predict(arms: &[Placed], statement: &Statement, table: Table) -> Result<String, Faults> {
    let arm = &arms[0].arm;
    let subject = subject(arm, statement);
    let exact = Direct::new(&subject);
    let (names, columns): (&[&str], Vec<Vec<f64>>) = match channel_of(&table) {
        Some(Channel::Static) => {
            let rows = exact.statics_mm(&static_rows(&table, arm, Purpose::Predict));
            (&["model_dx_mm", "model_dy_mm", "model_dz_mm"], rows.iter().map(|r| r.to_vec()).collect())
        }
        Some(Channel::Modal) => {
            let rows = exact.frequencies_hz(&modal_rows(&table, arm, Purpose::Predict));
            (&["model_frequency_hz"], rows.iter().map(|f| vec![f.unwrap_or(f64::NAN)]).collect())
        }
        Some(Channel::Windup) => {
            let rows = exact.windups_arcmin(&windup_rows(&table, arm, Purpose::Predict));
            (&["model_windup_arcmin"], rows.iter().map(|w| vec![*w]).collect())
        }
        Some(Channel::Positions) => {
            let rows = positions_mm(arms, statement, &exact, &table)?;
            (&["model_x_mm", "model_y_mm", "model_z_mm"], rows.iter().map(|r| r.to_vec()).collect())
        }
        None => {
            table.fault(
                Some(1),
                "",
                "none of the columns dx_mm (or dy_mm, dz_mm), frequency_hz, windup_arcmin, x_mm (or y_mm, z_mm) is there"
                    .into(),
                "give a file of static, modal, windup or positions readings",
            );
            (&[], Vec::new())
        }
    };
    let text = text(&table, names, &columns);
    let faults = table.into_faults();
    if faults.is_empty() { Ok(text) } else { Err(Faults(faults)) }
}

/// Predicted positions of the rows of `table` \[mm\], in the frame of the instrument, one for each row. If there are
/// several arms, their weights all load the common trunk.
fn positions_mm(
    arms: &[Placed],
    statement: &Statement,
    exact: &Direct,
    table: &Table,
) -> Result<Vec<[f64; 3]>, Faults> {
    let all: Vec<&Arm> = arms.iter().map(|a| &a.arm).collect();
    let names: Vec<&str> = all.iter().map(|a| a.name.as_str()).collect();
    let rows = position_rows(table, &names, &driven_joints(&all), Purpose::Predict);
    match arms {
        [one] => Ok(exact.positions_mm(&rows, &one.placement)),
        several => {
            let subjects: Vec<Subject> = all.iter().map(|arm| subject(arm, statement)).collect();
            let campaign = Campaign::of_positions(statement, &all, rows)?;
            Ok(positions::predict::predicted_mm(campaign, several, &subjects))
        }
    }
}

/// Sentence on rows of positions that belong to no known session (a run of readings between two changes of the set-up).
/// Such rows are predicted with the placement that fits all sessions best. `None` if there are none.
pub(crate) fn unplaced(arms: &[Placed], table: &Table) -> Option<String> {
    if channel_of(table) != Some(Channel::Positions) {
        return None;
    }
    let all: Vec<&Arm> = arms.iter().map(|a| &a.arm).collect();
    let names: Vec<&str> = all.iter().map(|a| a.name.as_str()).collect();
    let rows = position_rows(table, &names, &driven_joints(&all), Purpose::Predict);
    let count = |(i, placed): (usize, &Placed)| {
        let strangers = placed.placement.strangers(&rows);
        strangers.into_iter().filter(|row| rows[*row].arm == i).count()
    };
    let unplaced: usize = arms.iter().enumerate().map(count).sum();
    (unplaced > 0).then(|| {
        format!(
            "{unplaced} of {} rows belong to no known session: they are predicted from the place that suits all sessions \
             best. A session is known by the numbers of its tests",
            rows.len()
        )
    })
}

/// The table as CSV text with the columns `names` added. `columns` has the values of these columns for each row; NaN
/// becomes a blank cell.
fn text(table: &Table, names: &[&str], columns: &[Vec<f64>]) -> String {
    let mut out = joined(table.shown());
    names.iter().for_each(|name| out.push_str(&format!(",{name}")));
    out.push('\n');
    for (cells, values) in table.rows.iter().zip(columns) {
        out.push_str(&joined(cells));
        for value in values {
            match value.is_nan() {
                true => out.push(','),
                false => out.push_str(&format!(",{value:.6}")),
            }
        }
        out.push('\n');
    }
    out
}

/// The cells as one line of CSV.
fn joined(cells: &[String]) -> String {
    let quoted = |cell: &String| match cell.contains([',', '"', '\n']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell.clone(),
    };
    cells.iter().map(quoted).collect::<Vec<_>>().join(",")
}
