//! Reading a URDF file as a tree, or every fault of the file at once.
//!
//! The text is parsed by the crate `urdf-rs`. [`urdf_place`](super::urdf_place) finds the attributes that the crate cannot
//! read, and [`urdf_faults`](super::urdf_faults) what it does not check.

use super::urdf_faults::problems;
use super::urdf_place::{Look, cut_off_at};
use super::urdf_shapes::without_shapes;
use super::urdf_tree::UrdfTree;
use crate::input::json::{Fault, Faults};

/// Reads a robot from the text of a URDF file. `file` is the name of the file in messages.
///
/// # Errors
/// All faults of the file at once.
pub(crate) fn read_urdf(file: &str, text: &str) -> Result<UrdfTree, Faults> {
    let shapeless = without_shapes(text);
    let look = Look::at(&shapeless);
    let fault = |line: Option<usize>, field: &str, problem: String, hint: &str| Fault {
        file: file.into(),
        line,
        field: field.into(),
        problem,
        hint: hint.into(),
    };
    let is_xacro = text.contains("xacro:") || text.contains("${");
    let hint = |other: &'static str| match is_xacro {
        true => "expand its macros first with `xacro FILE.xacro > FILE.urdf`",
        false => other,
    };
    let wrong = || {
        let hint = hint(
            "write numbers with a point, separated by spaces; the format of URDF says what each element has",
        );
        let words = |problem: &str| format!("is no URDF: {problem}");
        look.wrong.iter().map(|w| fault(Some(w.line), &w.of, words(&w.problem), hint)).collect::<Vec<_>>()
    };
    let robot = match urdf_rs::read_from_string(&shapeless) {
        Ok(robot) if look.wrong.is_empty() => robot,
        Err(_) if cut_off_at(text).is_some() => {
            let hint = "save the whole file again; it ends with </robot>";
            let problem = "is empty or cut off: no </robot> ends it".to_string();
            return Err(Faults(vec![fault(cut_off_at(text), "", problem, hint)]));
        }
        Err(e) if look.wrong.is_empty() => {
            let hint =
                hint("check the elements and attributes of its links and joints against the format of URDF");
            return Err(Faults(vec![fault(None, "", format!("is no URDF: {e}"), hint)]));
        }
        _ => return Err(Faults(wrong())),
    };
    let tree = UrdfTree::new(robot);
    let found = problems(&tree).into_iter();
    let faults: Vec<Fault> = found.map(|p| fault(look.line_of(&p.of), &p.of, p.problem, p.hint)).collect();
    if faults.is_empty() { Ok(tree) } else { Err(Faults(faults)) }
}

#[cfg(test)]
mod tests {
    use super::super::urdf_faults::impossible_and_still;
    use super::super::urdf_tree::tensor;
    use super::*;
    use nalgebra::SymmetricEigen;

    #[test]
    fn every_fault_of_a_file_is_found_at_once() {
        let text = r#"<robot name="r">
          <link name="a"><inertial><mass value="-1"/><inertia ixx="1" ixy="2" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
          <link name="b"/><link name="b"/><link name="c"/>
          <joint name="j" type="revolute"><parent link="d"/><child link="a"/><axis xyz="0 0 0"/>
            <limit effort="1" velocity="1"/><mimic joint="k"/></joint>
        </robot>"#;
        let faults = read_urdf("r.urdf", text).expect_err("faults").0;
        let said: Vec<String> = faults.iter().map(ToString::to_string).collect();
        for part in [
            "r.urdf:3: b: the name of the link is taken",
            "r.urdf:2: a: has a mass of -1 kg",
            "principal moment of inertia, -1",
            "r.urdf:4: j: names the link \"d\"",
            "axis without direction",
            "mimics \"k\"",
            "is not the only root",
        ] {
            assert!(said.iter().any(|s| s.contains(part)), "{part} in {said:#?}");
        }
        let refused = |text: &str| read_urdf("r.urdf", text).expect_err("no URDF").to_string();
        let nameless = refused("<robot name=\"r\"><link/></robot>");
        assert!(nameless.contains("is no URDF") && !nameless.contains("xacro"), "{nameless}");
        let xacro = refused("<robot name=\"r\"><xacro:part/><link/></robot>");
        assert!(xacro.contains("is no URDF") && xacro.contains("expand its macros"), "{xacro}");
        for cut in ["", "<robot", "<robot name=\"r\">\n<link name=\"a\"/>"] {
            let said = refused(cut);
            assert!(said.contains("is empty or cut off"), "{cut}: {said}");
        }
        let far = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/>\
                   <child link=\"b\"/><origin xyz=\"0 0 X\"/></joint></robot>";
        assert!(refused(&far.replace('X', "nan")).contains("j: has an origin that is no number"));
        assert!(refused(&far.replace('X', "1e300")).contains("m away"));
    }

    /// A product of inertia of 1e-20, where all other entries are zero, is a rounding error of a tensor that was moved
    /// from the origin.
    #[test]
    fn a_tensor_within_rounding_has_no_negative_moments_and_a_link_that_stands_still_may_have_any() {
        let inertial = |ixx: &str, ixz: &str| {
            format!(
                "<inertial><origin xyz=\"0.1 0 0.3\"/><mass value=\"0.5\"/>\
                 <inertia ixx=\"{ixx}\" ixy=\"0\" ixz=\"{ixz}\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial>"
            )
        };
        let robot = |kind: &str, of_b: String| {
            let text = format!(
                "<robot name=\"r\"><link name=\"a\"/><link name=\"b\">{of_b}</link><joint name=\"j\" type=\"{kind}\">\
                 <parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 1 0\"/>\
                 <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/></joint></robot>"
            );
            read_urdf("r.urdf", &text)
        };
        let rounded = robot("revolute", inertial("0", "1e-20")).expect("rounding");
        let tensor = tensor(&rounded.links[1]);
        assert!(SymmetricEigen::new(tensor).eigenvalues.min() >= -1e-6 * tensor.amax(), "{tensor}");
        assert!(impossible_and_still(&rounded).is_empty());
        assert!(robot("revolute", inertial("-1", "0")).is_err());
        let still = robot("fixed", inertial("-1", "0")).expect("it never moves");
        assert_eq!(impossible_and_still(&still), ["b"]);
    }

    #[test]
    fn what_the_robot_looks_like_does_not_matter() {
        let text = "<robot name=\"r\"><link name=\"a\"><visual><geometry><box size=\"1 1 1\"/></geometry>\
            <material name=\"m\"><texture/></material></visual></link></robot>";
        assert_eq!(read_urdf("r.urdf", text).expect("a robot").links.len(), 1);
    }
}
