//! The size of a tube in words: a round tube has one diameter and is never written like a square one.

use crate::arm::section::Section;

/// Outer size and wall of a tube, `60 x 40 x 2 mm` or `Ø60 x 2 mm`; the numbers are written by the caller, in
/// millimetres: width, height, wall.
pub(crate) fn tube_size(is_round: bool, [width, height, wall]: [&str; 3]) -> String {
    match is_round {
        true => format!("Ø{width} x {wall} mm"),
        false => format!("{width} x {height} x {wall} mm"),
    }
}

/// [`tube_size`] of a section; `outer` and `wall` write a length given in metres as millimetres.
pub(crate) fn section_size(
    section: &Section,
    outer: impl Fn(f64) -> String,
    wall: impl Fn(f64) -> String,
) -> String {
    let (width_m, height_m) = section.outer_m();
    let is_round = matches!(section, Section::RoundTube { .. });
    tube_size(is_round, [&outer(width_m), &outer(height_m), &wall(section.wall_m())])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_tube_is_written_with_its_diameter() {
        let whole = |m: f64| format!("{:.0}", m * 1e3);
        let tenths = |m: f64| format!("{:.1}", m * 1e3);
        let round = Section::RoundTube { diameter_m: 0.06, wall_m: 0.002 };
        let square = Section::RectangularTube { width_m: 0.06, height_m: 0.06, wall_m: 0.002 };
        assert_eq!(section_size(&round, whole, tenths), "Ø60 x 2.0 mm");
        assert_eq!(section_size(&square, whole, tenths), "60 x 60 x 2.0 mm");
    }
}
