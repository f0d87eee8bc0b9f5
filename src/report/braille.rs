//! A small plot for a terminal. Each braille character has dots in two columns and four rows.

use super::number::significant;

/// Bit of each dot of a braille character, by column and row.
const DOTS: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];
/// Width of the numbers on the vertical axis \[characters\].
const MARGIN: usize = 7;

/// A plot of points, `width` characters wide, with `height` lines for the points. An axis that spans more than a decade
/// is logarithmic.
pub(crate) fn plot(
    title: &str,
    x_label: &str,
    points: &[(f64, f64)],
    width: usize,
    height: usize,
) -> Vec<String> {
    let (x, y) = (Scale::of(points.iter().map(|p| p.0)), Scale::of(points.iter().map(|p| p.1)));
    let columns = width.saturating_sub(MARGIN + 1).max(8);
    let mut cells = vec![vec![0u8; columns]; height];
    for point in points {
        let across = (x.place(point.0) * (2 * columns - 1) as f64).round() as usize;
        let down = ((1.0 - y.place(point.1)) * (4 * height - 1) as f64).round() as usize;
        cells[down / 4][across / 2] |= DOTS[across % 2][down % 4];
    }
    let mut out = vec![format!("{:MARGIN$} {title}", "")];
    for (i, row) in cells.iter().enumerate() {
        let label = match i {
            0 => significant(y.high, 3),
            _ if i + 1 == height => significant(y.low, 3),
            _ => String::new(),
        };
        let dots: String =
            row.iter().map(|bits| char::from_u32(0x2800 + u32::from(*bits)).unwrap_or(' ')).collect();
        out.push(format!("{label:>w$} \u{2502}{dots}", w = MARGIN - 1));
    }
    let (low, high) = (significant(x.low, 3), significant(x.high, 3));
    let rest = columns.saturating_sub(low.len() + high.len());
    let x_label = if x_label.len() + 2 <= rest { x_label } else { "" };
    out.push(format!("{:w$} \u{2514}{}", "", "\u{2500}".repeat(columns), w = MARGIN - 1));
    out.push(format!("{:MARGIN$} {low}{x_label:^rest$}{high}", ""));
    out
}

/// Two lists of lines as one text, side by side. The right list starts at the column `width`.
pub(crate) fn beside(left: &[String], right: &[String], width: usize) -> String {
    let blank = String::new();
    let line = |i: usize| {
        let (a, b) = (left.get(i).unwrap_or(&blank), right.get(i).unwrap_or(&blank));
        let gap = width.saturating_sub(a.chars().count());
        format!("{}\n", format!("{a}{}{b}", " ".repeat(gap)).trim_end())
    };
    (0..left.len().max(right.len())).map(line).collect()
}

/// A bar of block characters for the fraction `share` (0 to 1): its length is this fraction of `width`, but at least
/// one character.
pub(crate) fn bar(share: f64, width: usize) -> String {
    "\u{2588}".repeat(((share.clamp(0.0, 1.0) * width as f64).round() as usize).max(1))
}

/// Maps values to positions from 0 (smallest value) to 1 (largest value). `ratio` is true for a logarithmic scale.
struct Scale {
    low: f64,
    high: f64,
    ratio: bool,
}

impl Scale {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let ends = values.filter(|v| v.is_finite());
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        Self { low, high, ratio: low > 0.0 && high > 10.0 * low }
    }

    fn place(&self, value: f64) -> f64 {
        let share = match self.ratio {
            true => libm::log(value / self.low) / libm::log(self.high / self.low),
            false => (value - self.low) / (self.high - self.low),
        };
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_dot_is_at_the_lower_left_and_the_last_at_the_upper_right() {
        let lines = plot("y [mm]", "x [kg]", &[(1.0, 1.0), (2.0, 2.0)], 20, 3);
        assert!(lines[1].ends_with('\u{2808}'), "upper right dot: {}", lines[1]);
        assert!(lines[3].contains("1.00 \u{2502}\u{2840}"), "lower left dot: {}", lines[3]);
        assert!(lines.iter().all(|l| l.chars().count() <= 20), "{lines:#?}");
    }

    #[test]
    fn a_single_point_has_a_place() {
        assert_eq!(plot("y", "x", &[(3.0, 3.0)], 20, 3).len(), 6);
    }

    #[test]
    fn blocks_stand_beside_one_another() {
        let block = |words: &[&str]| words.iter().map(|w| w.to_string()).collect::<Vec<_>>();
        assert_eq!(beside(&block(&["a", "b"]), &block(&["c"]), 3), "a  c\nb\n");
    }
}
