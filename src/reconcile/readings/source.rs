//! Where the readings of a channel are: the file, the sheet if the file is a spreadsheet, and the names that the
//! columns have in the file.

use super::keys::{COLUMNS as COLUMN_NAMES, FILES, SHEET};
use super::record_spec::record_columns;
use crate::arm::effect::channel::Channel;
use crate::arm::pose::DrivenJoint;
use crate::input::json::{Node, Object, closest};

/// Names of the files that are read if `campaign.json` names none, one for each channel in the order of
/// [`Channel::ALL`].
pub(crate) const DEFAULT_FILES: [&str; 4] = ["static.csv", "modal.csv", "windup.csv", "positions.csv"];

/// Column with the temperature of the arm. Few files have it.
const TEMPERATURE: &str = "temperature_c";

/// Names of the columns of each channel, in the order of [`Channel::ALL`]. The angles `q_<joint>_deg`, the travels
/// `q_<joint>_mm` and the temperature are not in this list.
const COLUMNS: [&[&str]; 4] = [
    &[
        "test",
        "payload_kg",
        "payload_cg_x_m",
        "payload_cg_y_m",
        "payload_cg_z_m",
        TEMPERATURE,
        "force_x_n",
        "force_y_n",
        "force_z_n",
        "branch",
        "dx_mm",
        "dy_mm",
        "dz_mm",
        "sigma_mm",
        "sigma_dx_mm",
        "sigma_dy_mm",
        "sigma_dz_mm",
    ],
    &[
        "test",
        "payload_kg",
        "payload_cg_x_m",
        "payload_cg_y_m",
        "payload_cg_z_m",
        TEMPERATURE,
        "mode",
        "frequency_hz",
        "sigma_hz",
    ],
    &["test", "joint", "torque_nm", "branch", "windup_arcmin", "sigma_arcmin"],
    &[
        "test",
        "payload_kg",
        "payload_cg_x_m",
        "payload_cg_y_m",
        "payload_cg_z_m",
        TEMPERATURE,
        "arm",
        "point",
        "x_mm",
        "y_mm",
        "z_mm",
        "sigma_mm",
        "sigma_x_mm",
        "sigma_y_mm",
        "sigma_z_mm",
    ],
];

/// Names of the columns of the table of a new campaign, for an arm with the driven joints `joints`: first the test,
/// then the angles, then the rest in the order of [`COLUMNS`]. Columns that few files need are left out.
pub(crate) fn columns_for(channel: Channel, joints: &[DrivenJoint]) -> Vec<String> {
    let (label, others) = COLUMNS[channel as usize].split_at(1);
    let angles = joints.iter().map(|joint| format!("q_{}", joint.key()));
    let angles: Vec<String> = angles.filter(|_| channel != Channel::Windup).collect();
    let own = |name: &&&str| !OWN_SIGMAS.contains(*name) && ![TEMPERATURE, "arm"].contains(*name);
    let others = others.iter().filter(own).map(|name| name.to_string());
    label.iter().map(|name| name.to_string()).chain(angles).chain(others).collect()
}

/// Columns with the standard deviation of a single component. Few files have them, because most state one for all
/// components.
const OWN_SIGMAS: [&str; 6] =
    ["sigma_dx_mm", "sigma_dy_mm", "sigma_dz_mm", "sigma_x_mm", "sigma_y_mm", "sigma_z_mm"];

/// Where the readings of a channel are: file, sheet and names of columns.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Source {
    /// Name of the file, in the folder of `campaign.json`; `None` for the usual name (`DEFAULT_FILES`).
    pub file: Option<String>,
    /// Name of the sheet of a spreadsheet; `None` for a spreadsheet with one sheet, or for a CSV file.
    pub sheet: Option<String>,
    /// Row of a spreadsheet that names the columns, from 1; `None` for the first row that is not blank.
    pub header_row: Option<usize>,
    /// Columns whose names differ, as pairs: the name in this program, and the name in the file.
    pub columns: Vec<(String, String)>,
}

/// Reads from `root`, the content of `campaign.json`, where the readings of each channel are, in the order of
/// [`Channel::ALL`]. `None` for a channel about which it says nothing.
pub(crate) fn read_sources(root: &Object) -> [Option<Source>; 4] {
    let files = root.optional("files").and_then(|n| n.shaped(&FILES));
    let columns = root.optional("columns").and_then(|node| {
        let of_records = record_columns(&node).into_iter().map(|(name, _)| name);
        node.object(&COLUMN_NAMES.names().into_iter().chain(of_records).collect::<Vec<_>>())
    });
    Channel::ALL.map(|channel| {
        let word = channel.word();
        let block = root.optional(word);
        let file = files.as_ref().and_then(|f| f.optional(word));
        let mut out = match (&block, &file) {
            (_, Some(node)) => read_file(node).unwrap_or_default(),
            (Some(node), None) => {
                let file = read_block(node).unwrap_or(DEFAULT_FILES[channel as usize].into());
                Source { file: Some(file), ..Source::default() }
            }
            (None, None) => Source::default(),
        };
        let own = columns.as_ref().and_then(|c| c.optional(word));
        out.columns = own.and_then(|node| read_columns(&node, channel)).unwrap_or_default();
        (out != Source::default()).then_some(out)
    })
}

/// Reads the name of the file from the block of a channel, for example `"static": {"file": "a.csv"}`. Other keys of the
/// block are not read here. `None` if the block has no key `file`, or after recording a fault.
fn read_block(node: &Node) -> Option<String> {
    let (_, file) = node.entries()?.into_iter().find(|(key, _)| *key == "file")?;
    file.string().map(String::from)
}

/// Reads an entry of `files`: a name such as `"m.xlsx"`, or an object such as `{"file": "m.xlsx", "sheet": "S1",
/// "header_row": 3}`. Returns `None` after recording a fault.
fn read_file(node: &Node) -> Option<Source> {
    if node.value().is_string() {
        return Some(Source { file: Some(node.string()?.into()), ..Source::default() });
    }
    let object = node.shaped(&SHEET)?;
    let file = object.required("file").and_then(|n| n.string().map(String::from));
    let sheet = object.or("sheet", None, |n| n.string().map(|s| Some(s.to_string())));
    let header_row = object.or("header_row", None, |n| match n.number()? {
        row if row >= 1.0 && row.fract() == 0.0 => Some(Some(row as usize)),
        row => n.fault(format!("= {row}"), "rows are numbered 1, 2, 3 ... as the spreadsheet shows them"),
    });
    Some(Source { file: Some(file?), sheet: sheet?, header_row: header_row?, columns: Vec::new() })
}

/// Reads pairs of column names, such as `{"dz_mm": "Gauge 1"}`: the name in this program, and the name in the file.
/// Returns `None` after recording a fault.
fn read_columns(node: &Node, channel: Channel) -> Option<Vec<(String, String)>> {
    let known = COLUMNS[channel as usize];
    let mut out = Vec::new();
    for (name, value) in node.entries()? {
        let is_of_pose = name.starts_with("q_") && (name.ends_with("_deg") || name.ends_with("_mm"));
        if name == "note" {
            continue;
        }
        if !known.contains(&name) && !is_of_pose {
            let near = closest(name, known).map_or(String::new(), |near| format!("is it \"{near}\"? "));
            let hint = format!("{near}the columns: q_<joint>_deg, q_<joint>_mm, {}", known.join(", "));
            value.fault::<()>(format!("{} readings have no such column", channel.word()), &hint);
        }
        out.push((name.to_string(), value.string()?.trim().to_string()));
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::json::Document;

    fn columns_of(channel: Channel, text: &str) -> Result<usize, String> {
        let document = Document::parse("campaign.json", text).expect("JSON");
        let read = read_columns(&document.root(), channel).map(|columns| columns.len());
        document.finish(read).map_err(|faults| faults.0.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn travels_and_temperatures_may_have_other_names_too() {
        let text = r#"{"q_lift_mm": "Hub [mm]", "q_s1_deg": "A1", "temperature_c": "Temp [C]"}"#;
        for channel in [Channel::Static, Channel::Modal, Channel::Positions] {
            assert_eq!(columns_of(channel, text), Ok(3), "{channel:?}");
        }
        let faults = columns_of(Channel::Windup, text).expect_err("a bench has neither");
        assert!(faults.contains("temperature_c"), "{faults}");
    }
}
