//! Parallel coordinates: one vertical axis per choice or result, one line per design.

use super::draw::{FONT_PX, INK, colour, head, line, px, text, text_px, wrap};
use std::fmt::Write;

const HEIGHT_PX: f64 = 420.0;
/// Least distance between the names of two lines, from baseline to baseline \[px\].
const NAME_ROW_PX: f64 = 15.0;
const LEGEND_ROW_PX: f64 = 20.0;
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
    /// Entries of the legend: the style index of each colour, and what the colour means.
    pub legend: Vec<(usize, String)>,
}

impl Parallel {
    /// The picture as a self-contained SVG document.
    pub(crate) fn to_svg(&self) -> String {
        let width = 120.0 + AXIS_PX * self.axes.len().saturating_sub(1) as f64 + 90.0;
        let legend = self.legend_rows(width);
        let height = HEIGHT_PX + LEGEND_ROW_PX * legend.len() as f64;
        let mut out = head(&self.title, &self.description, width, height);
        text(&mut out, (16.0, 26.0), "start", " font-size=\"16\" font-weight=\"bold\"", &self.title);
        for line in self.lines.iter().filter(|l| l.name.is_none()) {
            self.draw(&mut out, line, "stroke-width=\"0.8\" stroke-opacity=\"0.35\"");
        }
        let named = || self.lines.iter().filter_map(|l| Some((l, l.name.as_ref()?)));
        for (i, (line, _)) in named().enumerate() {
            let dashes = ["", "8 4", "2 4", "10 3 2 3"][i % 4];
            self.draw(&mut out, line, "stroke-width=\"5\" stroke=\"#FFFFFF\"");
            let ink = ParallelLine { style: 6, ..line.clone() };
            self.draw(&mut out, &ink, &format!("stroke-width=\"2.2\" stroke-dasharray=\"{dashes}\""));
        }
        // the axes are drawn on top, so that no line strikes through the names of parts
        for (i, axis) in self.axes.iter().enumerate() {
            self.axis(&mut out, axis, x(i));
        }
        let ends = named().filter_map(|(line, name)| Some((y((*line.places.last()?)?), name.as_str())));
        let left = x(self.axes.len().saturating_sub(1)) + 8.0;
        for (at, name) in apart(ends.collect()) {
            let style = " font-size=\"12\" font-weight=\"bold\" paint-order=\"stroke\" stroke=\"#FFFFFF\" stroke-width=\"3\"";
            text(&mut out, (left, at + 4.0), "start", style, name);
        }
        for (i, row) in legend.iter().enumerate() {
            let y = HEIGHT_PX + LEGEND_ROW_PX * i as f64;
            for (x, entry) in row {
                let (style, name) = &self.legend[*entry];
                line(&mut out, (*x, y - 4.0), (x + 20.0, y - 4.0), colour(*style), 2.5);
                text(&mut out, (x + 26.0, y), "start", "", name);
            }
        }
        out.push_str("</svg>\n");
        out
    }

    /// The legend in rows that fit the width: position \[px\] and index of each entry.
    fn legend_rows(&self, width_px: f64) -> Vec<Vec<(f64, usize)>> {
        let mut rows: Vec<Vec<(f64, usize)>> = Vec::new();
        let mut x = width_px;
        for (i, (_, name)) in self.legend.iter().enumerate() {
            let entry_px = 44.0 + text_px(name, FONT_PX);
            if x + entry_px > width_px {
                rows.push(Vec::new());
                x = 16.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, i));
            }
            x += entry_px;
        }
        rows
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

/// The names with their heights \[px\], moved apart so that no two overlap, from top to bottom. Names that crowd at the
/// bottom move up.
fn apart(mut names: Vec<(f64, &str)>) -> Vec<(f64, &str)> {
    names.sort_by(|a, b| a.0.total_cmp(&b.0));
    for i in 1..names.len() {
        names[i].0 = names[i].0.max(names[i - 1].0 + NAME_ROW_PX);
    }
    let mut lowest = BOTTOM_PX;
    for (at, _) in names.iter_mut().rev() {
        *at = at.min(lowest);
        lowest = *at - NAME_ROW_PX;
    }
    names
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
        let svg = Parallel { legend: vec![(0, "steel".into()), (1, "titanium".into())], ..plot }.to_svg();
        assert!(svg.contains(">steel<") && svg.contains(">titanium<"));
        let path = svg.lines().find(|l| l.contains("stroke-width=\"2.2\"")).unwrap_or_default();
        assert_eq!(path.matches('M').count(), 2, "{path}");
        assert!(svg.contains(">knee<"));
    }

    #[test]
    fn names_at_one_height_are_moved_apart_within_the_picture() {
        let names = apart(vec![(200.0, "b"), (199.0, "a"), (BOTTOM_PX, "d"), (BOTTOM_PX, "c")]);
        assert!(names.windows(2).all(|pair| pair[1].0 - pair[0].0 >= NAME_ROW_PX), "{names:?}");
        assert!(names.iter().all(|(at, _)| *at <= BOTTOM_PX), "{names:?}");
        assert_eq!(names[0], (199.0, "a"));
    }
}
