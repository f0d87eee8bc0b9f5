//! Absolute positions that were written by another convention, such as other units or axes: the verdict names the
//! convention that would fit, and changes nothing.

use crate::positions_maker::standard;
use armwright::catalog::Catalogs;
use armwright::reconcile::Campaign;
use armwright::reconcile::reconcile;
use armwright::reconcile::{Outcome, Verdict};
use nalgebra::{Rotation3, Vector3};
use serde_json::json;
use std::path::Path;

/// A row of positions: the angles of the three joints \[deg\], and the position \[mm\].
type Row = ([f64; 3], [f64; 3]);

fn outcome(folder: &Path) -> Outcome {
    reconcile(&Campaign::read(folder, &Catalogs::default()).expect("readable"))
}

/// What the verdict says of a sagging arm whose file `written` writes otherwise.
fn said_of(written: &dyn Fn(Row) -> Row) -> (Outcome, Option<String>) {
    let folder = standard().write(&crate::positions_maker::Made::sagging);
    rewrite(folder.path(), written);
    said(folder.path())
}

fn said(folder: &Path) -> (Outcome, Option<String>) {
    let outcome = outcome(folder);
    let said = outcome.reasons.iter().find(|r| r.contains("correct the file if that is so")).cloned();
    (outcome, said)
}

fn rewrite(folder: &Path, written: &dyn Fn(Row) -> Row) {
    let path = folder.join("positions.csv");
    let text = std::fs::read_to_string(&path).expect("text");
    let line = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|c| c.parse().expect("a number")).collect();
        let (angles, at) = written(([cells[1], cells[2], cells[3]], [cells[4], cells[5], cells[6]]));
        let all = [cells[0]].into_iter().chain(angles).chain(at).chain([cells[7]]);
        all.map(|x| format!("{x}")).collect::<Vec<_>>().join(",") + "\n"
    };
    let rows: String = text.lines().skip(1).map(line).collect();
    std::fs::write(&path, format!("{}\n{rows}", text.lines().next().expect("a header"))).expect("written");
}

#[test]
fn what_is_written_as_asked_is_not_doubted() {
    let (outcome, said) = said_of(&|row| row);
    assert_eq!((outcome.verdict, said), (Verdict::Explained, None));
}

#[test]
fn metres_are_recognized() {
    let (_, said) = said_of(&|(angles, at)| (angles, at.map(|x| x / 1e3)));
    let said = said.expect("said");
    assert!(said.contains("the positions are in metres (calibration"), "nothing else is named: {said}");
}

/// The second and the third joint are parallel, so that either may be the one that is coupled.
#[test]
fn swapped_columns_and_coupled_axes_are_recognized() {
    let (_, said) = said_of(&|([a, b, c], at)| ([b, a, c], at));
    let said = said.expect("said");
    assert!(said.contains("the columns of q1 and q2 are swapped"), "{said}");
    let (_, said) = said_of(&|([a, b, c], at)| ([a, b, c - b], at));
    let said = said.expect("said");
    assert!(said.contains("q3 turns by the column of q3 plus the column of q2"), "{said}");
    let (_, said) = said_of(&|([a, b, c], at)| ([a, b, c + b], at));
    let said = said.expect("said");
    assert!(said.contains("q3 turns by the column of q3 less the column of q2"), "{said}");
}

#[test]
fn a_scale_that_the_links_absorb_explains_nothing() {
    for scale in [0.6, 0.9, 1.1] {
        let (outcome, said) = said_of(&|(angles, at)| (angles, at.map(|x| scale * x)));
        assert_eq!(outcome.verdict, Verdict::InsufficientData, "{}", outcome.to_text());
        let told = |part: &str| outcome.reasons.iter().any(|r| r.contains(part));
        assert!(told("check the unit of the positions"), "{}", outcome.to_text());
        assert!(told("the vector of link2 by"), "{}", outcome.to_text());
        assert_eq!(said, None, "no convention has this scale");
    }
}

/// The priors of a small arm's links leave room for links of any length.
#[test]
fn a_unit_that_the_links_absorb_is_named() {
    let folder = standard().write(&crate::positions_maker::Made::rigid);
    rewrite(folder.path(), &|(angles, at)| (angles, at.map(|x| 0.1 * x / 25.4)));
    let path = folder.path().join("arm.json");
    let text = std::fs::read_to_string(&path).expect("text");
    let mut arm: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for part in arm["chain"].as_array_mut().expect("a chain") {
        for x in part.get_mut("vector_m").and_then(|v| v.as_array_mut()).into_iter().flatten() {
            *x = json!(0.1 * x.as_f64().expect("a number"));
        }
    }
    std::fs::write(&path, arm.to_string()).expect("written");
    let (outcome, said) = said(folder.path());
    assert_eq!(outcome.verdict, Verdict::InsufficientData, "{}", outcome.to_text());
    let said = said.unwrap_or_else(|| panic!("{}", outcome.to_text()));
    let expected = "no link and no axis moves further than its prior expects if the positions are in inches (calibration";
    assert!(said.contains(expected), "{said}");
}

#[test]
fn swapped_axes_and_a_mirrored_frame_are_left_handed() {
    for written in [|[x, y, z]: [f64; 3]| [y, x, z], |[x, y, z]: [f64; 3]| [x, y, -z]] {
        let (outcome, said) = said_of(&|(angles, at)| (angles, written(at)));
        let said = said.unwrap_or_else(|| panic!("{}", outcome.to_text()));
        assert!(said.contains("the instrument's frame is left-handed"), "{said}");
        assert_eq!(outcome.verdict, Verdict::Unexplained, "nothing is applied");
    }
}

#[test]
fn angles_of_another_sign_or_zero_are_named_by_their_joints() {
    let (_, said) = said_of(&|([a, b, c], at)| ([a, b, -c], at));
    let said = said.expect("said");
    assert!(said.contains("the angles of q3 have the other sign"), "{said}");
    let (_, said) = said_of(&|([a, b, c], at)| ([a, b - 90.0, c], at));
    let said = said.expect("said");
    assert!(said.contains("90 degrees are added to the angles of q2") && !said.contains("-90"), "{said}");
}

/// The joints after the first are parallel: for such an arm a mirrored frame is the same as a zero of the other sign.
#[test]
fn metres_in_a_mirrored_frame_with_a_zero_are_recognized() {
    let (_, said) = said_of(&|([a, b, c], [x, y, z])| ([a, b - 90.0, c], [y, x, z].map(|x| x / 1e3)));
    let said = said.expect("said");
    for part in ["are in metres", "90 degrees are added to the angles of q2"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

#[test]
fn an_arm_that_stands_where_it_should_has_its_axes_named() {
    let said = said_of_a_standing_arm(&|own| [own.y, -own.x, own.z]);
    assert!(said.contains("the frame's x, y, z are -y_mm, x_mm, z_mm of the file"), "{said}");
    // metres, two axes swapped, and one turned round
    let said = said_of_a_standing_arm(&|own| [own.z / 1e3, own.x / 1e3, -own.y / 1e3]);
    for part in ["are in metres", "the frame's x, y, z are y_mm, -z_mm, x_mm of the file"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

/// What is said of an arm whose place is known, if its positions are written so \[mm\].
fn said_of_a_standing_arm(written: &dyn Fn(Vector3<f64>) -> [f64; 3]) -> String {
    let folder = standard().write(&crate::positions_maker::Made::sagging);
    let statement = json!({"name": "made", "positions": {"tool_offset": true, "joint_offsets": true}});
    std::fs::write(folder.path().join("campaign.json"), statement.to_string()).expect("written");
    // where the arms of these tests stand
    let askew = Rotation3::from_euler_angles(0.3, -0.2, 2.1);
    let own = |at: [f64; 3]| askew.inverse() * (Vector3::from(at) - Vector3::new(1e3, -2e3, 5e2));
    rewrite(folder.path(), &|(angles, at): Row| (angles, written(own(at))));
    let (outcome, said) = said(folder.path());
    said.unwrap_or_else(|| panic!("{}", outcome.to_text()))
}
