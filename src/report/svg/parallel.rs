//! Parallel coordinates: one vertical axis per choice or result, one line per design.

use super::draw::{INK, colour, head, line, px, text, wrap};
use std::fmt::Write;

const HEIGHT_PX: f64 = 420.0;
const AXIS_PX: f64 = 88.0;
const TOP_PX: f64 = 92.0;
const BOTTOM_PX: f64 = HEIGHT_PX - 26.0;
const HEAD_CHARACTERS: usize = 13;
const TICK_CHARACTERS: usize = 13;

/// One vertical axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ParallelAxis {
    /// Name of the axis, with its unit.
    pub label: String,
    /// Position of each labelled value from 0 (bottom) to 1 (top), and its label.
    pub ticks: Vec<(f64, String)>,
}

/// One line across all axes, which stands for a design.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ParallelLine {
    /// Position of the line on each axis from 0 to 1. `None` where the design has no value; the line is interrupted
    /// there.
    pub places: Vec<Option<f64>>,
    /// Style index, which determines the colour as in the other pictures.
    pub style: usize,
    /// Name of the line; `None` for a line that is not highlighted.
    pub name: Option<String>,
}

/// A picture of parallel coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Parallel {
    /// Title of the picture.
    pub title: String,
    /// Description in a sentence or two, for readers who cannot see the picture.
    pub description: String,
    /// Axes from left to right.
    pub axes: Vec<ParallelAxis>,
    /// The lines. Those with a name are drawn last and are highlighted.
    pub lines: Vec<ParallelLine>,
}

impl Parallel {
    /// The picture as a self-contained SVG document.
    pub(crate) fn to_svg(&self) -> String {
        let width = 120.0 + AXIS_PX * self.axes.len().saturating_sub(1) as f64 + 90.0;
        let mut out = head(&self.title, &self.description, width, HEIGHT_PX);
        text(&mut out, (16.0, 26.0), "start", " font-size=\"16\" font-weight=\"bold\"", &self.title);
        for line in self.lines.iter().filter(|l| l.name.is_none()) {
            self.draw(&mut out, line, "stroke-width=\"0.8\" stroke-opacity=\"0.35\"");
        }
        for (i, axis) in self.axes.iter().enumerate() {
            self.axis(&mut out, axis, x(i));
        }
        let named = self.lines.iter().filter_map(|l| Some((l, l.name.as_ref()?)));
        for (i, (line, name)) in named.enumerate() {
            let dashes = ["", "8 4", "2 4", "10 3 2 3"][i % 4];
            self.draw(&mut out, line, "stroke-width=\"5\" stroke=\"#FFFFFF\"");
            let ink = ParallelLine { style: 6, ..line.clone() };
            self.draw(&mut out, &ink, &format!("stroke-width=\"2.2\" stroke-dasharray=\"{dashes}\""));
            if let Some(Some(last)) = line.places.last() {
                let at = (x(self.axes.len() - 1) + 8.0, y(*last) + 4.0);
                let style = " font-size=\"12\" font-weight=\"bold\" paint-order=\"stroke\" stroke=\"#FFFFFF\" stroke-width=\"3\"";
                text(&mut out, at, "start", style, name);
            }
        }
        out.push_str("</svg>\n");
        out
    }

    fn draw(&self, out: &mut String, line: &ParallelLine, look: &str) {
        let mut d = String::new();
        let mut joined = false;
        for (i, place) in line.places.iter().enumerate() {
            match place {
                Some(place) => {
                    let _ = write!(d, "{}{} {}", if joined { 'L' } else { 'M' }, px(x(i)), px(y(*place)));
                    joined = true;
                }
                None => joined = false,
            }
        }
        let stroke = if look.contains("stroke=") {
            String::new()
        } else {
            format!(" stroke=\"{}\"", colour(line.style))
        };
        let _ = writeln!(out, "<path d=\"{d}\" fill=\"none\"{stroke} {look}/>");
    }

    fn axis(&self, out: &mut String, axis: &ParallelAxis, x: f64) {
        line(out, (x, TOP_PX), (x, BOTTOM_PX), INK, 1.2);
        let rows = wrap(&axis.label, HEAD_CHARACTERS);
        for (i, row) in rows.iter().enumerate() {
            let y = TOP_PX - 12.0 - 14.0 * (rows.len() - 1 - i) as f64;
            text(out, (x, y), "middle", " font-size=\"12\" font-weight=\"bold\"", row);
        }
        for (place, words) in &axis.ticks {
            line(out, (x - 3.0, y(*place)), (x, y(*place)), INK, 1.0);
            let style = " font-size=\"10\" paint-order=\"stroke\" stroke=\"#FFFFFF\" stroke-width=\"3\"";
            text(out, (x - 5.0, y(*place) + 3.5), "end", style, &shortened(words));
        }
    }
}

fn x(axis: usize) -> f64 {
    104.0 + AXIS_PX * axis as f64
}

fn y(place: f64) -> f64 {
    BOTTOM_PX - place * (BOTTOM_PX - TOP_PX)
}

/// The beginning of a text, as much as fits next to an axis.
fn shortened(words: &str) -> String {
    if words.chars().count() <= TICK_CHARACTERS {
        return words.to_string();
    }
    let kept: String = words.chars().take(TICK_CHARACTERS - 1).collect();
    format!("{}\u{2026}", kept.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_broken_where_a_design_has_no_place() {
        let axis = |label: &str| ParallelAxis { label: label.into(), ticks: vec![(0.0, "0".into())] };
        let line =
            ParallelLine { places: vec![Some(0.0), None, Some(1.0)], style: 0, name: Some("knee".into()) };
        let plot =
            Parallel { axes: ["a", "b", "c"].map(axis).to_vec(), lines: vec![line], ..Parallel::default() };
        let svg = plot.to_svg();
        let path = svg.lines().find(|l| l.contains("stroke-width=\"2.2\"")).unwrap_or_default();
        assert_eq!(path.matches('M').count(), 2, "{path}");
        assert!(svg.contains(">knee<"));
    }
}
