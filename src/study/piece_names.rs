//! Names of the pieces of a study: each is unique, and no two give the same column of a front.

use crate::arm::element_names::{PART_HINT, part_of, part_problem};
use crate::arm::pose::Motion;
use crate::input::json::Node;
use crate::space::design_space::{DriveChoice, SpacePiece};
use std::collections::HashMap;

/// Columns of every link that is chosen.
const LINK_COLUMNS: [&str; 6] = ["material", "shape", "width_mm", "height_mm", "wall_mm", "profile"];
/// Columns of every joint that has a gear and a motor: the parts.
const DRIVE_COLUMNS: [&str; 2] = ["gear", "motor"];
/// Columns of every joint that has a gear and a motor: margins and speeds of the drive.
const JOINT_COLUMNS: [&str; 6] =
    ["margin", "binds", "bearing_margin", "motor_rms_margin", "input_rpm", "critical_rpm"];

/// Names of the columns of a front that say what was chosen for a piece; none if the study states all of it.
pub(super) fn choice_columns(piece: &SpacePiece) -> Vec<String> {
    match piece {
        SpacePiece::Choice(choice) => of(&choice.name, &LINK_COLUMNS),
        SpacePiece::Joint(joint) if has_parts(&joint.drive) => of(&joint.name, &DRIVE_COLUMNS),
        SpacePiece::Prismatic(slide) if slide.drive.is_some() => of(&slide.joint.name, &DRIVE_COLUMNS),
        _ => Vec::new(),
    }
}

/// Names of the columns of a front with the margins and speeds of the drive of a joint.
pub(super) fn joint_columns(piece: &SpacePiece) -> Vec<String> {
    of(piece.name(), &JOINT_COLUMNS)
}

/// Whether a gear or a motor of the catalogs is chosen or given.
pub(super) fn has_parts(drive: &DriveChoice) -> bool {
    !matches!(drive, DriveChoice::Given { gear: None, motor: None, .. })
}

fn of(name: &str, columns: &[&str]) -> Vec<String> {
    columns.iter().map(|what| format!("{name}_{what}")).collect()
}

/// Checks the names of the chain `node`: each is unique, none is that of a part of a joint, and no two pieces would
/// give two columns of a front the same name. Returns `None` after recording a fault.
pub(super) fn check_names(node: &Node, pieces: &[SpacePiece]) -> Option<()> {
    let names: Vec<&str> = pieces.iter().map(SpacePiece::name).collect();
    if let Some(i) = (1..names.len()).find(|&i| names[..i].contains(&names[i])) {
        return node
            .fault(format!("has two pieces named \"{}\"", names[i]), "give every piece a name of its own");
    }
    let joint = |piece: &'_ SpacePiece| match piece {
        SpacePiece::Joint(_) => Some(Motion::Turns),
        SpacePiece::Prismatic(_) => Some(Motion::Slides),
        _ => None,
    };
    let joints = || pieces.iter().filter_map(|piece| Some((piece.name(), joint(piece)?)));
    if let Some((name, of)) = names.iter().find_map(|name| Some((name, part_of(name, joints())?))) {
        return node.fault(part_problem(name, of), PART_HINT);
    }
    match shared_column(pieces) {
        Some((column, [a, b])) => node.fault(
            format!("\"{a}\" and \"{b}\" would both have the column {column} of front.csv"),
            "give one of them another name",
        ),
        None => Some(()),
    }
}

/// A column that two pieces would have, and the names of both; `None` if there is no such column.
fn shared_column(pieces: &[SpacePiece]) -> Option<(String, [&str; 2])> {
    let mut owners: HashMap<String, &str> = HashMap::new();
    for piece in pieces {
        let chosen = choice_columns(piece);
        // a chosen link has no margins, and a joint without gear and motor has no columns at all
        let holds = match piece {
            SpacePiece::Choice(_) => Vec::new(),
            _ if chosen.is_empty() => Vec::new(),
            _ => joint_columns(piece),
        };
        for column in chosen.into_iter().chain(holds) {
            if let Some(other) = owners.insert(column.clone(), piece.name()) {
                return Some((column, [other, piece.name()]));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use crate::catalog::Catalogs;
    use crate::input::Document;
    use crate::study::read_study;
    use serde_json::json;

    fn faults(names: [&str; 2], link: &str) -> Option<String> {
        let joint =
            |name: &str| json!({"type": "joint", "name": name, "axis": [0, 1, 0], "drive": "first_fit"});
        let study = json!({"name": "two joints", "payload": {"mass_kg": 1}, "drives": {"gear_series": ["CSG"]},
            "motion": {"tip_speed_m_s": 0.8, "ramp_time_s": 0.25, "life_h": 10000}, "poses": [{"pose_deg": [0, 0]}], "chain": [
            joint(names[0]), {"type": "link", "name": link, "vector_m": [0.3, 0, 0], "mass_kg": 1}, joint(names[1])]});
        let document = Document::parse("study.json", &study.to_string()).expect("JSON");
        read_study(document, &Catalogs::builtin()).err().map(|faults| faults.to_string())
    }

    #[test]
    fn no_two_joints_share_a_column_and_no_piece_has_the_name_of_a_part() {
        for (names, column) in
            [(["a", "a_bearing"], "a_bearing_margin"), (["x_motor_rms", "x"], "x_motor_rms_margin")]
        {
            let fault = faults(names, "arm").expect("a fault");
            let said = [names[0], names[1], column].map(|word| fault.contains(word));
            assert_eq!(said, [true; 3], "{fault}");
        }
        let fault = faults(["a", "b"], "b.bearing").expect("a fault");
        assert!(fault.contains("\"b.bearing\" is taken"), "{fault}");
        assert_eq!(faults(["a", "a_b"], "b.guide"), None);
    }
}
