//! Rows of marks along one axis: for example values before and after, or values with intervals.

use super::draw::{
    FAINT, FONT_PX, INK, MUTED, NOTE_PX, WIDTH_PX, colour, dashed, head, line, px, text, text_px,
};
use super::plot::{Axis, Series, Stroke, markers};
use super::scale::Scale;
use super::ticks::rule;
use crate::report::number::shortest;
use crate::report::table::csv_line;
use std::fmt::Write;

const ROW_PX: f64 = 26.0;
const TOP_PX: f64 = 88.0;

/// A mark in a row: a value, with an interval around it if it has one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mark {
    /// Value at which the mark is drawn, in the unit of the axis.
    pub value: f64,
    /// Ends of the interval around the value; `None` for a mark without an interval. An end that is itself `None` is
    /// unknown and is drawn as an arrow at the frame.
    pub interval: Option<(Option<f64>, Option<f64>)>,
    /// Index of the mark's entry in the legend.
    pub kind: usize,
}

/// One row of marks.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// Text to the left of the row.
    pub label: String,
    /// Marks; several marks are joined by a line.
    pub marks: Vec<Mark>,
    /// Text to the right of the row.
    pub remark: String,
}

/// A picture of rows of marks with a common axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct RowPlot {
    /// Title of the picture.
    pub title: String,
    /// Description of the rows in a sentence or two, for readers who cannot see them.
    pub description: String,
    /// The common axis.
    pub x: Axis,
    /// Names of the kinds of marks, for the legend. If there are several, the markers of the first kind are hollow.
    pub kinds: Vec<String>,
    /// Rows from top to bottom.
    pub rows: Vec<Row>,
    /// Values at which dashed lines are drawn, with their texts.
    pub guides: Vec<(f64, String)>,
}

impl RowPlot {
    /// The rows as a self-contained SVG document.
    pub(crate) fn to_svg(&self) -> String {
        let bottom = TOP_PX + self.rows.len() as f64 * ROW_PX;
        let mut out = head(&self.title, &self.description, WIDTH_PX, bottom + 52.0);
        text(&mut out, (16.0, 26.0), "start", " font-size=\"16\" font-weight=\"bold\"", &self.title);
        let widest = |of: fn(&Row) -> &str| {
            self.rows.iter().map(|r| text_px(of(r), FONT_PX)).fold(0.0, f64::max).min(0.55 * WIDTH_PX)
        };
        let (left, right) = (26.0 + widest(|r| &r.label), WIDTH_PX - 30.0 - widest(|r| &r.remark));
        let (low, high) = self.extent();
        let ruling = rule(self.x.scale, low, high, ((right - left) / 75.0) as usize);
        let x = |value: f64| left + ruling.position(value).clamp(0.0, 1.0) * (right - left);
        for tick in &ruling.ticks {
            line(&mut out, (x(tick.value), TOP_PX - 8.0), (x(tick.value), bottom), FAINT, 1.0);
            if let Some(label) = &tick.label {
                text(&mut out, (x(tick.value), bottom + 18.0), "middle", "", label);
            }
        }
        line(&mut out, (left, bottom), (right, bottom), INK, 1.0);
        text(&mut out, ((left + right) / 2.0, bottom + 40.0), "middle", "", &self.x.label);
        for (value, words) in &self.guides {
            dashed(&mut out, (x(*value), TOP_PX - 12.0), (x(*value), bottom));
            let style = format!(" font-size=\"{NOTE_PX}\"");
            text(&mut out, (x(*value) + 5.0, TOP_PX - 12.0), "start", &style, words);
        }
        self.legend(&mut out);
        for (i, row) in self.rows.iter().enumerate() {
            self.row(&mut out, row, TOP_PX + (i as f64 + 0.5) * ROW_PX, (left, right), &x);
        }
        out.push_str("</svg>\n");
        out
    }

    /// The values of the marks as CSV, one line per mark.
    pub(crate) fn to_csv(&self) -> String {
        let cells = ["row", "mark", "value", "low", "high"].map(String::from);
        let mut out = csv_line(&cells);
        let number = |x: Option<f64>| x.map_or(String::new(), shortest);
        for row in &self.rows {
            for mark in &row.marks {
                let (low, high) = mark.interval.unwrap_or_default();
                let kind = self.kinds.get(mark.kind).cloned().unwrap_or_default();
                out.push_str(&csv_line(&[
                    row.label.clone(),
                    kind,
                    number(Some(mark.value)),
                    number(low),
                    number(high),
                ]));
            }
        }
        out
    }

    fn extent(&self) -> (f64, f64) {
        let marks = self.rows.iter().flat_map(|r| &r.marks);
        let ends = |m: &Mark| {
            let (low, high) = m.interval.unwrap_or_default();
            [Some(m.value), low, high]
        };
        let values = marks.flat_map(ends).flatten().chain(self.guides.iter().map(|g| g.0));
        let (low, high) = values
            .filter(|v| v.is_finite() && (self.x.scale == Scale::Linear || *v > 0.0))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        self.x.range.unwrap_or(if low <= high { (low, high) } else { (0.1, 1.0) })
    }

    fn row(&self, out: &mut String, row: &Row, y: f64, (left, right): (f64, f64), x: &impl Fn(f64) -> f64) {
        text(out, (left - 10.0, y + 4.5), "end", "", &row.label);
        text(out, (right + 12.0, y + 4.5), "start", "", &row.remark);
        let places = row.marks.iter().map(|m| x(m.value));
        let (first, last) = (places.clone().fold(right, f64::min), places.fold(left, f64::max));
        if row.marks.len() > 1 {
            line(out, (first, y), (last, y), "#A0A0A0", 2.0);
        }
        for mark in &row.marks {
            if let Some((low, high)) = mark.interval {
                self.interval(out, y, (low.map(x), high.map(x)), (left, right), mark.kind);
            }
            markers(out, &self.look(mark.kind), &[(x(mark.value), y)]);
        }
    }

    fn interval(
        &self,
        out: &mut String,
        y: f64,
        (low, high): (Option<f64>, Option<f64>),
        (left, right): (f64, f64),
        kind: usize,
    ) {
        let colour = colour(self.look(kind).style);
        let (from, to) = (low.unwrap_or(left), high.unwrap_or(right));
        line(out, (from, y), (to, y), colour, 2.0);
        for (end, known, side) in [(from, low.is_some(), 1.0), (to, high.is_some(), -1.0)] {
            let d = match known {
                true => format!("M{} {}v10", px(end), px(y - 5.0)),
                false => format!(
                    "M{} {}L{} {}l{} 5",
                    px(end + 6.0 * side),
                    px(y - 5.0),
                    px(end),
                    px(y),
                    px(6.0 * side)
                ),
            };
            let _ = writeln!(out, "<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>");
        }
    }

    /// The look of a kind of marks. The first of several kinds (before) is hollow and grey, the others are filled.
    /// A single kind is filled and blue.
    fn look(&self, kind: usize) -> Series {
        let before = self.kinds.len() > 1 && kind == 0;
        let (style, open) = if before { (MUTED, true) } else { (kind.saturating_sub(1), false) };
        Series { style, open, marker_px: 5.5, stroke: Stroke::None, ..Series::default() }
    }

    fn legend(&self, out: &mut String) {
        let mut x = 24.0;
        for (kind, name) in self.kinds.iter().enumerate().filter(|_| self.kinds.len() > 1) {
            markers(out, &self.look(kind), &[(x, 50.0)]);
            text(out, (x + 12.0, 54.5), "start", "", name);
            x += 44.0 + text_px(name, FONT_PX);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_ends_of_an_interval_run_to_the_frame() {
        let mark = Mark { value: 2.0, interval: Some((Some(1.0), None)), kind: 0 };
        let plot = RowPlot {
            rows: vec![Row { label: "a".into(), marks: vec![mark], remark: String::new() }],
            kinds: vec!["value".into()],
            ..RowPlot::default()
        };
        assert_eq!(plot.to_csv(), "row,mark,value,low,high\na,value,2,1,\n");
        let svg = plot.to_svg();
        assert!(!svg.contains("NaN") && svg.contains("v10"), "{svg}");
    }
}
