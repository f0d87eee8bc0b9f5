//! A first look at the XML of a URDF file: where its links and joints begin, and which attributes are missing or hold no
//! numbers. The parser of URDF reports such faults without their place.
//!
//! Only elements that an arm is made of are looked at: links, joints, and what is directly in them or in an `<inertial>`.

use quick_xml::Reader;
use quick_xml::escape::unescape;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;

/// Attributes of one number.
const ONE: usize = 1;
/// Attributes of three numbers, such as positions.
const THREE: usize = 3;

/// The attributes of an element that hold numbers, and those that it must have.
struct Rule {
    element: &'static str,
    /// Names of attributes, each with its count of numbers.
    numbers: &'static [(&'static str, usize)],
    required: &'static [&'static str],
}

/// The rules for what is directly in a `<joint>`.
const IN_JOINT: [Rule; 9] = [
    Rule { element: "origin", numbers: &[("xyz", THREE), ("rpy", THREE)], required: &[] },
    Rule { element: "parent", numbers: &[], required: &["link"] },
    Rule { element: "child", numbers: &[], required: &["link"] },
    Rule { element: "axis", numbers: &[("xyz", THREE)], required: &["xyz"] },
    Rule {
        element: "limit",
        numbers: &[("lower", ONE), ("upper", ONE), ("effort", ONE), ("velocity", ONE)],
        required: &["velocity"],
    },
    Rule { element: "mimic", numbers: &[("multiplier", ONE), ("offset", ONE)], required: &["joint"] },
    Rule { element: "dynamics", numbers: &[("damping", ONE), ("friction", ONE)], required: &[] },
    Rule { element: "calibration", numbers: &[("rising", ONE), ("falling", ONE)], required: &[] },
    Rule {
        element: "safety_controller",
        numbers: &[
            ("soft_lower_limit", ONE),
            ("soft_upper_limit", ONE),
            ("k_position", ONE),
            ("k_velocity", ONE),
        ],
        required: &["k_velocity"],
    },
];

/// The rules for what is directly in an `<inertial>`.
const IN_INERTIAL: [Rule; 3] = [
    Rule { element: "origin", numbers: &[("xyz", THREE), ("rpy", THREE)], required: &[] },
    Rule { element: "mass", numbers: &[("value", ONE)], required: &["value"] },
    Rule {
        element: "inertia",
        numbers: &[("ixx", ONE), ("ixy", ONE), ("ixz", ONE), ("iyy", ONE), ("iyz", ONE), ("izz", ONE)],
        required: &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"],
    },
];

/// The elements that a joint or an inertial must have.
const REQUIRED: [(&str, &[&str]); 2] = [("joint", &["parent", "child"]), ("inertial", &["mass", "inertia"])];

/// The types of joints.
const TYPES: [&str; 7] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"];

/// An attribute or an element that is missing, or that cannot be read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wrong {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// The joint or the link: `joint elbow`.
    pub of: String,
    /// Description of the fault.
    pub problem: String,
}

/// What the first look at a file finds.
#[derive(Debug, Clone, Default)]
pub(super) struct Look {
    /// For each name of a link or a joint, the line in which the first one begins.
    lines: BTreeMap<String, usize>,
    /// The line in which the robot begins.
    robot: Option<usize>,
    /// What is missing or cannot be read, in the order of the file.
    pub wrong: Vec<Wrong>,
}

/// An element that is open while a file is read.
struct Open {
    name: String,
    line: usize,
    /// Names of the elements directly in it.
    has: Vec<String>,
}

impl Look {
    /// Looks at the text of a URDF file. It ends where the text is no XML.
    pub(super) fn at(text: &str) -> Self {
        let (mut out, mut open, mut of) = (Self::default(), Vec::<Open>::new(), String::new());
        let (mut reader, mut line, mut counted) = (Reader::from_str(text), 1, 0);
        loop {
            let from = reader.buffer_position() as usize;
            let Ok(event) = reader.read_event() else { break };
            line += text[counted..from].matches('\n').count();
            counted = from;
            match event {
                Event::Start(element) => {
                    out.element(&element, line, &mut open, &mut of);
                    open.push(Open { name: element.name().as_ref().to_string(), line, has: Vec::new() });
                }
                Event::Empty(element) => {
                    out.element(&element, line, &mut open, &mut of);
                    let name = element.name().as_ref().to_string();
                    out.lacks(&Open { name, line, has: Vec::new() }, open.len(), &of);
                }
                Event::End(_) => {
                    if let Some(ended) = open.pop() {
                        out.lacks(&ended, open.len(), &of);
                    }
                }
                Event::Eof => break,
                _ => {}
            }
        }
        out
    }

    /// The line of the link or joint of this name, or else that of the robot; `None` if there is neither.
    pub(super) fn line_of(&self, name: &str) -> Option<usize> {
        self.lines.get(name).copied().or(self.robot)
    }

    /// Looks at the attributes of an element that begins. `open` are the elements around it, and `of` names the link or
    /// joint that was begun last.
    fn element(&mut self, element: &BytesStart, line: usize, open: &mut [Open], of: &mut String) {
        let qualified = element.name();
        let name: &str = qualified.as_ref();
        let depth = open.len();
        if let Some(around) = open.last_mut() {
            around.has.push(name.to_string());
        }
        let attributes = attributes(element);
        let value =
            |key: &str| attributes.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str());
        let around = open.last().map_or("", |around| around.name.as_str());
        match (depth, around, name) {
            (0, _, "robot") => self.robot = Some(line),
            (1, "robot", "link" | "joint") => {
                *of = format!("{name} {}", value("name").unwrap_or_default()).trim_end().to_string();
                match value("name") {
                    Some(own) => drop(self.lines.entry(own.to_string()).or_insert(line)),
                    None => self.wrong(line, of, format!("<{name}> lacks the attribute name")),
                }
                match value("type").filter(|_| name == "joint") {
                    Some(kind) if !TYPES.contains(&kind) => {
                        self.wrong(line, of, format!("type=\"{kind}\" is none of {}", TYPES.join(", ")));
                    }
                    None if name == "joint" => {
                        self.wrong(line, of, "<joint> lacks the attribute type".into())
                    }
                    _ => {}
                }
            }
            (2, "joint", _) => self.follow(&IN_JOINT, name, &attributes, line, of),
            (3, "inertial", _) => self.follow(&IN_INERTIAL, name, &attributes, line, of),
            _ => {}
        }
    }

    /// Checks the attributes of the element `name` by its rule among `rules`.
    fn follow(&mut self, rules: &[Rule], name: &str, attributes: &[(String, String)], line: usize, of: &str) {
        let Some(rule) = rules.iter().find(|rule| rule.element == name) else { return };
        for key in rule.required.iter().filter(|key| !attributes.iter().any(|(own, _)| own == *key)) {
            self.wrong(line, of, format!("<{name}> lacks the attribute {key}"));
        }
        for (key, value) in attributes {
            let Some((_, count)) = rule.numbers.iter().find(|(own, _)| own == key) else { continue };
            let numbers: Vec<&str> = value.split_whitespace().collect();
            let is_read = numbers.iter().all(|number| number.parse::<f64>().is_ok());
            if !is_read || numbers.len() != *count {
                let wanted = if *count == ONE { "no number" } else { "no list of three numbers" };
                self.wrong(line, of, format!("<{name} {key}=\"{value}\"> is {wanted}"));
            }
        }
    }

    /// Checks that a joint or an inertial that ends at this depth has the elements that it must have.
    fn lacks(&mut self, ended: &Open, depth: usize, of: &str) {
        let place = if ended.name == "joint" { 1 } else { 2 };
        let Some((_, required)) = REQUIRED.iter().find(|(name, _)| *name == ended.name && depth == place)
        else {
            return;
        };
        for name in required.iter().filter(|name| !ended.has.iter().any(|has| has == *name)) {
            self.wrong(ended.line, of, format!("<{}> lacks the element <{name}>", ended.name));
        }
    }

    fn wrong(&mut self, line: usize, of: &str, problem: String) {
        self.wrong.push(Wrong { line, of: of.into(), problem });
    }
}

/// Names and values of the attributes of an element, as far as they can be read.
fn attributes(element: &BytesStart) -> Vec<(String, String)> {
    let read = element.attributes().flatten().filter_map(|attribute| {
        let value = unescape(&attribute.value).ok()?.into_owned();
        Some((attribute.key.as_ref().to_string(), value))
    });
    read.collect()
}

/// The last line of a text that is cut off; `None` if it is whole. A text is cut off if it has no tag at all, or if it
/// has a `<robot` and no `</robot`.
pub(super) fn cut_off_at(text: &str) -> Option<usize> {
    let is_other = text.contains('<') && !text.contains("<robot");
    let is_whole = text.contains("</robot") || is_other;
    (!is_whole).then(|| text.lines().count().max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_placed_by_line_element_and_attribute() {
        let text = "<robot name=\"r\">\n<link name=\"a\"/><link name=\"b\"><inertial>\n<mass value=\"2kg\"/></inertial></link>\n\
            <joint name=\"j\" type=\"hinge\"><parent link=\"a\"/>\n<origin xyz=\"1 2\" rpy=\"0 0 0\"/><limit effort=\"1\"/></joint>\n\
            <ros2_control><joint name=\"j\"><limit lower=\"x\"/></joint></ros2_control></robot>";
        let look = Look::at(text);
        let said: Vec<String> = look
            .wrong
            .iter()
            .map(|wrong| format!("{} {}: {}", wrong.line, wrong.of, wrong.problem))
            .collect();
        assert_eq!(
            said,
            [
                "3 link b: <mass value=\"2kg\"> is no number",
                "2 link b: <inertial> lacks the element <inertia>",
                "4 joint j: type=\"hinge\" is none of revolute, continuous, prismatic, fixed, floating, planar, spherical",
                "5 joint j: <origin xyz=\"1 2\"> is no list of three numbers",
                "5 joint j: <limit> lacks the attribute velocity",
                "4 joint j: <joint> lacks the element <child>",
            ]
        );
        assert_eq!([look.line_of("b"), look.line_of("j"), look.line_of("none")], [Some(2), Some(4), Some(1)]);
        assert_eq!(Look::at("no XML").line_of("a"), None);
        assert!(Look::at("<robot name=\"r\"><link name=\"a\"").wrong.is_empty());
    }
}
