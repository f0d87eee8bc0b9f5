//! The size of a section in words. A round section is written with one diameter, and a bar without a wall.

use super::number::shortest;
use crate::arm::section::{Section, millimetres};

/// Outer size and wall of a section: `60 x 40 x 2 mm`, `Ø60 x 2 mm` or `60 x 40 mm bar`. The numbers are texts in
/// millimetres: width, height, wall. `shape` is the name of the shape in files ([`Section::shape`]).
pub(crate) fn tube_size(shape: &str, [width, height, wall]: [&str; 3]) -> String {
    if matches!(shape, "i_beam" | "stated") {
        return format!("{width} x {height} mm {}", if shape == "stated" { "as stated" } else { "I" });
    }
    match (shape.starts_with("round"), shape.ends_with("bar")) {
        (true, false) => format!("Ø{width} x {wall} mm"),
        (true, true) => format!("Ø{width} mm bar"),
        (false, false) => format!("{width} x {height} x {wall} mm"),
        (false, true) => format!("{width} x {height} mm bar"),
    }
}

/// Outer size and wall of a section in words, as [`tube_size`] writes them, in millimetres without digits of rounding
/// and without zeros at the end. A tube has the same name everywhere.
pub(crate) fn section_size(section: &Section) -> String {
    let mm = |m: f64| shortest(millimetres(m));
    let (width_m, height_m) = section.outer_m();
    tube_size(section.shape(), [&mm(width_m), &mm(height_m), &mm(section.wall_m())])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_tube_is_written_with_its_diameter() {
        let round = Section::RoundTube { diameter_m: 0.06, wall_m: 0.002 };
        let square = Section::RectangularTube { width_m: 0.06, height_m: 0.06, wall_m: 0.0025 };
        assert_eq!(section_size(&round), "Ø60 x 2 mm");
        assert_eq!(section_size(&square), "60 x 60 x 2.5 mm");
    }

    #[test]
    fn a_bar_is_written_without_a_wall() {
        let flat = Section::RectangularBar { width_m: 0.06, height_m: 0.02 };
        let round = Section::RoundBar { diameter_m: 0.03 };
        assert_eq!(section_size(&flat), "60 x 20 mm bar");
        assert_eq!(section_size(&round), "Ø30 mm bar");
    }
}
