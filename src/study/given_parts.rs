//! Names of the parts that a study gives: they are in every design, and the columns of a front lack most of them.

use crate::arm::pieces::without_factors;
use crate::arm::{Link, LinkBody};
use crate::space::design_space::{DesignSpace, DriveChoice, SpacePiece};

/// Names of the materials of given links and of the gears and motors of given drives, from base to tip, each once.
pub(crate) fn given_parts(space: &DesignSpace) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for name in space.pieces.iter().flat_map(parts_of) {
        if !out.contains(&name) {
            out.push(name);
        }
    }
    out
}

/// Names of the parts that the study gives for a piece.
fn parts_of(piece: &SpacePiece) -> Vec<String> {
    match piece {
        SpacePiece::Link(Link { body: LinkBody::Tube { material_name, .. }, .. }) => {
            vec![without_factors(material_name).to_string()]
        }
        SpacePiece::Joint(joint) => match &joint.drive {
            DriveChoice::Given { gear, motor, .. } => [gear, motor].into_iter().flatten().cloned().collect(),
            DriveChoice::FirstFit(_) | DriveChoice::AllFits(_) => Vec::new(),
        },
        SpacePiece::Prismatic(slide) if slide.drive.is_none() => {
            let named = [&slide.joint.gear, &slide.joint.motor].into_iter().flatten();
            named.map(|part| part.name.clone()).collect()
        }
        SpacePiece::Link(_) | SpacePiece::Prismatic(_) | SpacePiece::Choice(_) => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::report::caveats::Caveats;
    use crate::report::front_table::FrontTable;
    use crate::report::picks::{designs, picks, rows_and_names};
    use crate::study::read::read_study;
    use serde_json::json;

    #[test]
    fn a_given_tube_and_a_given_drive_are_named_with_the_caveats_of_every_pick() {
        let catalogs = Catalogs::builtin();
        let study = json!({
            "name": "given",
            "chain": [
                {"type": "joint", "name": "j1", "axis": [0, 1, 0], "gear": "HFUC-50-100", "motor": "F11-10"},
                {"type": "link", "name": "column", "vector_m": [0.3, 0, 0], "material": "Aluminium 6082-T6",
                 "section": {"shape": "round_tube", "diameter_m": 0.1, "wall_m": 0.005}},
                {"type": "joint", "name": "j2", "axis": [0, 1, 0], "drive": "first_fit"},
                {"type": "link", "name": "arm", "vector_m": [0.3, 0, 0], "choose": {
                    "materials": ["Structural steel S355"],
                    "sections": [{"shape": "round_tube", "diameter_mm": [60], "wall_mm": [3]}]}}
            ],
            "payload": {"mass_kg": 1},
            "poses": [{"name": "stretched", "pose_deg": [0, 0]}]
        });
        let document = Document::parse("study.json", &study.to_string()).expect("JSON");
        let read = read_study(document, &catalogs).expect("a study");
        let given = given_parts(&read.space);
        assert_eq!(given, ["HFUC-50-100", "F11-10", "Aluminium 6082-T6"]);
        let words = |row: &str| row.split(';').map(String::from).collect::<Vec<_>>();
        let front = FrontTable {
            columns: words("design_id;arm_material;tip_deflection_mm;mass_kg;lowest_mode_hz"),
            rows: vec![words("a;Structural steel S355;1;20;30")],
        };
        let picked = rows_and_names(&picks(&designs(&front)));
        let sentence = Caveats::of(&catalogs).with_given(given).sentence(&front, &picked);
        let sentence = sentence.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            sentence.ends_with(
                "F11-10 (from memory) in every pick; Aluminium 6082-T6 (representative) in every pick."
            ),
            "{sentence}"
        );
    }
}
