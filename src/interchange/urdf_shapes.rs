//! Blanks out the parts of a URDF file that say how a robot looks, which no arm needs.
//!
//! The reader of URDF refuses a whole file for a texture without a file name. So these parts are blanked out before it
//! reads the text. Line breaks stay, so that faults name the right line.

use quick_xml::Reader;
use quick_xml::events::Event;

/// Elements that do not matter for an arm.
const IGNORED: [&str; 5] = ["visual", "collision", "material", "gazebo", "transmission"];

/// The text of a URDF file in which the elements of [`IGNORED`] are overwritten with spaces. Line breaks stay. A text
/// that is not XML is returned unchanged.
pub(super) fn without_shapes(text: &str) -> String {
    let mut out = text.as_bytes().to_vec();
    let mut reader = Reader::from_str(text);
    loop {
        let from = reader.buffer_position() as usize;
        match reader.read_event() {
            Ok(Event::Start(element)) if IGNORED.contains(&element.name().as_ref()) => {
                if reader.read_to_end(element.name()).is_err() {
                    return text.to_string();
                }
            }
            Ok(Event::Empty(element)) if IGNORED.contains(&element.name().as_ref()) => {}
            Ok(Event::Eof) => break,
            Ok(_) => continue,
            Err(_) => return text.to_string(),
        }
        let ignored = &mut out[from..reader.buffer_position() as usize];
        ignored.iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
    }
    String::from_utf8(out).unwrap_or_else(|_| text.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_robot_looks_like_is_blank_and_every_line_stays_where_it_is() {
        let text = "<robot name=\"r\">\n <material name=\"é\"/>\n <link name=\"a\">\n  <visual><geometry>\n\
            <visual/></geometry></visual> <inertial/>\n </link>\n</robot>";
        let blank = without_shapes(text);
        assert_eq!(blank.lines().count(), text.lines().count());
        let words: Vec<&str> = blank.split_whitespace().collect();
        assert_eq!(
            words,
            ["<robot", "name=\"r\">", "<link", "name=\"a\">", "<inertial/>", "</link>", "</robot>"]
        );
        for broken in ["<robot><visual></robot>", "no XML", ""] {
            assert_eq!(without_shapes(broken), broken);
        }
    }
}
