//! A plot: axes, series, notes and guides in a frame, with the legend to the right of it.

use super::draw::{
    FAINT, FONT_PX, INK, MUTED, NOTE_PX, TITLE_PX, colour, dashed, head, line, px, text, text_px, wrap,
};
use super::marker::outline;
use super::scale::Scale;
use super::ticks::{Ruling, rule};
use std::fmt::Write;

const LEGEND_CHARACTERS: usize = 26;

/// An axis of a plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// Label with its unit: `deflection [mm]`.
    pub label: String,
    /// Linear or logarithmic scale.
    pub scale: Scale,
    /// Ends of the axis in data units; `None` takes them from the data.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// An axis whose ends follow the data.
    pub fn new(label: &str, scale: Scale) -> Self {
        Self { label: label.to_string(), scale, range: None }
    }
}

/// How the points of a series are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stroke {
    /// The points are not joined.
    #[default]
    None,
    /// The points are joined by a solid line.
    Solid,
    /// The points are joined by a dashed line.
    Dashed,
    /// A dash pattern that depends on the style, so that lines differ without colour.
    Patterned,
}

/// A series of points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Name in the legend; empty leaves the series out of the legend.
    pub name: String,
    /// Points, in the order in which they are joined.
    pub points: Vec<(f64, f64)>,
    /// Index of colour and marker shape. Series with equal `style` look the same.
    pub style: usize,
    /// Whether the markers are hollow.
    pub open: bool,
    /// How the points are joined.
    pub stroke: Stroke,
    /// Radius of the markers \[px\]; 0 draws none.
    pub marker_px: f64,
}

impl Series {
    /// A series of markers that are joined by a solid line.
    pub fn line(name: &str, style: usize, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, style, open: false, stroke: Stroke::Solid, marker_px: 4.5 }
    }

    /// A series of hollow markers that are joined by a dashed line. It shows a variant of another series.
    pub fn variant(name: &str, style: usize, points: Vec<(f64, f64)>) -> Self {
        Self { open: true, stroke: Stroke::Dashed, ..Self::line(name, style, points) }
    }

    /// A series of markers that are not joined. They are smaller if there are many.
    pub fn scatter(name: &str, style: usize, points: Vec<(f64, f64)>) -> Self {
        let marker_px = match points.len() {
            0..=60 => 4.5,
            61..=400 => 3.5,
            _ => 2.5,
        };
        Self { stroke: Stroke::None, marker_px, ..Self::line(name, style, points) }
    }
}

/// The side of its point on which a note is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Side {
    /// Right of and above the point.
    #[default]
    RightAbove,
    /// Left of and below the point.
    LeftBelow,
}

/// A text at a point of the plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// The point in data units.
    pub at: (f64, f64),
    /// The text. It is moved until it is inside the frame.
    pub text: String,
    /// Side of the point on which the text is written.
    pub side: Side,
}

/// A dashed line across the whole plot at a value of one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// Whether the value belongs to the x axis, so that the line is vertical.
    pub vertical: bool,
    /// Value on the axis, in data units.
    pub value: f64,
    /// Text next to the line.
    pub text: String,
}

/// A plot: data in a frame with two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Title of the plot.
    pub title: String,
    /// Description of the plot in a sentence or two, for readers who cannot see it.
    pub description: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Series of data.
    pub series: Vec<Series>,
    /// Texts in the plot.
    pub notes: Vec<Note>,
    /// Dashed lines at stated values.
    pub guides: Vec<Guide>,
    /// Width of the plot \[px\].
    pub width_px: f64,
    /// Height of the plot \[px\].
    pub height_px: f64,
}

impl Default for Plot {
    fn default() -> Self {
        Self {
            title: String::new(),
            description: String::new(),
            x: Axis::default(),
            y: Axis::default(),
            series: Vec::new(),
            notes: Vec::new(),
            guides: Vec::new(),
            width_px: 800.0,
            height_px: 500.0,
        }
    }
}

impl Plot {
    /// The plot as a self-contained SVG document.
    pub fn to_svg(&self) -> String {
        let canvas = Canvas::new(self);
        let mut out = self.head();
        canvas.grid(&mut out, self);
        canvas.guides(&mut out, &self.guides);
        for series in &self.series {
            canvas.series(&mut out, series);
        }
        canvas.notes(&mut out, &self.notes);
        canvas.legend(&mut out, &self.series);
        out.push_str("</svg>\n");
        out
    }

    pub(super) fn head(&self) -> String {
        head(&self.title, &self.description, self.width_px, self.height_px)
    }

    /// Ends of the x axis.
    fn x_extent(&self) -> (f64, f64) {
        let guides = self.guides.iter().filter(|g| g.vertical).map(|g| g.value);
        self.x.extent(self.shown().map(|(x, _)| *x).chain(guides))
    }

    /// Ends of the y axis.
    fn y_extent(&self) -> (f64, f64) {
        let guides = self.guides.iter().filter(|g| !g.vertical).map(|g| g.value);
        self.y.extent(self.shown().map(|(_, y)| *y).chain(guides))
    }

    fn shown(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.series.iter().flat_map(|s| &s.points).filter(|p| self.shows(p))
    }

    fn shows(&self, point: &(f64, f64)) -> bool {
        usable(self.x.scale, point.0) && usable(self.y.scale, point.1)
    }
}

impl Axis {
    /// Ends of the axis: its stated range, or else the smallest and largest value of the data. Without any data they
    /// are 1 and 10.
    fn extent(&self, values: impl Iterator<Item = f64>) -> (f64, f64) {
        let (low, high) = values
            .filter(|v| usable(self.scale, *v))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        self.range.unwrap_or(if low <= high { (low, high) } else { (1.0, 10.0) })
    }
}

/// Whether a value can be drawn on an axis. A logarithmic axis needs a positive value.
fn usable(scale: Scale, value: f64) -> bool {
    value.is_finite() && (scale == Scale::Linear || value > 0.0)
}

/// The frame of a plot, and the conversion from data units to pixels.
pub(super) struct Canvas {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    pub(super) x: Ruling,
    pub(super) y: Ruling,
}

impl Canvas {
    pub(super) fn new(plot: &Plot) -> Self {
        let (x_low, x_high) = plot.x_extent();
        let (y_low, y_high) = plot.y_extent();
        let (top, bottom) = (46.0, plot.height_px - 58.0);
        let y = rule(plot.y.scale, y_low, y_high, ((bottom - top) / 60.0) as usize);
        let labels = y.ticks.iter().filter_map(|t| t.label.as_deref());
        let left = 44.0 + labels.map(|l| text_px(l, FONT_PX)).fold(0.0, f64::max);
        let right = plot.width_px - legend_px(&plot.series);
        let x = rule(plot.x.scale, x_low, x_high, ((right - left) / 75.0) as usize);
        Self { left, right, top, bottom, x, y }
    }

    pub(super) fn at(&self, point: (f64, f64)) -> (f64, f64) {
        (
            self.left + self.x.position(point.0) * (self.right - self.left),
            self.bottom - self.y.position(point.1) * (self.bottom - self.top),
        )
    }

    /// Position of a point, given in data units, in the picture \[px\]; `None` if it is outside the frame.
    pub(super) fn inside(&self, point: (f64, f64)) -> Option<(f64, f64)> {
        if !usable(self.x.scale, point.0) || !usable(self.y.scale, point.1) {
            return None;
        }
        let (x, y) = self.at(point);
        let within = (self.left - 0.5..=self.right + 0.5).contains(&x)
            && (self.top - 0.5..=self.bottom + 0.5).contains(&y);
        within.then_some((x, y))
    }

    pub(super) fn grid(&self, out: &mut String, plot: &Plot) {
        let (left, right, top, bottom) = (self.left, self.right, self.top, self.bottom);
        for tick in &self.x.ticks {
            let x = left + self.x.position(tick.value) * (right - left);
            line(out, (x, top), (x, bottom), FAINT, if tick.label.is_some() { 1.0 } else { 0.4 });
            if let Some(label) = &tick.label {
                line(out, (x, bottom), (x, bottom + 5.0), INK, 1.0);
                text(out, (x, bottom + 20.0), "middle", "", label);
            }
        }
        for tick in &self.y.ticks {
            let y = bottom - self.y.position(tick.value) * (bottom - top);
            line(out, (left, y), (right, y), FAINT, if tick.label.is_some() { 1.0 } else { 0.4 });
            if let Some(label) = &tick.label {
                line(out, (left - 5.0, y), (left, y), INK, 1.0);
                text(out, (left - 8.0, y + 4.5), "end", "", label);
            }
        }
        let _ = writeln!(
            out,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"{INK}\"/>",
            px(left),
            px(top),
            px(right - left),
            px(bottom - top)
        );
        self.labels(out, plot);
    }

    pub(super) fn labels(&self, out: &mut String, plot: &Plot) {
        let (middle_x, middle_y) = ((self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0);
        let title = format!(" font-size=\"{TITLE_PX}\" font-weight=\"bold\"");
        let centre = plot.width_px / 2.0;
        text(out, (centre, 26.0), "middle", &title, &plot.title);
        text(out, (middle_x, self.bottom + 44.0), "middle", "", &plot.x.label);
        let turn = format!(" transform=\"rotate(-90 18 {})\"", px(middle_y));
        text(out, (18.0, middle_y), "middle", &turn, &plot.y.label);
    }

    pub(super) fn series(&self, out: &mut String, series: &Series) {
        let points: Vec<(f64, f64)> = series.points.iter().filter_map(|p| self.inside(*p)).collect();
        let colour = colour(series.style);
        if series.stroke != Stroke::None && points.len() > 1 {
            let _ = writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\"{}/>",
                points.iter().map(|(x, y)| format!("{},{}", px(*x), px(*y))).collect::<Vec<_>>().join(" "),
                dashes(series)
            );
        }
        markers(out, series, &points);
    }

    pub(super) fn guides(&self, out: &mut String, guides: &[Guide]) {
        for guide in guides {
            if guide.vertical {
                let x = self.left + self.x.position(guide.value) * (self.right - self.left);
                dashed(out, (x, self.top), (x, self.bottom));
                self.words(out, (x + 6.0, self.top + 16.0), &guide.text);
            } else {
                let y = self.bottom - self.y.position(guide.value) * (self.bottom - self.top);
                dashed(out, (self.left, y), (self.right, y));
                let x = self.right - 6.0 - text_px(&guide.text, NOTE_PX);
                self.words(out, (x, y - 6.0), &guide.text);
            }
        }
    }

    pub(super) fn notes(&self, out: &mut String, notes: &[Note]) {
        for note in notes {
            if let Some((x, y)) = self.inside(note.at) {
                let at = match note.side {
                    Side::RightAbove => (x + 9.0, y - 8.0),
                    Side::LeftBelow => (x - 9.0 - text_px(&note.text, NOTE_PX), y + 16.0),
                };
                self.words(out, at, &note.text);
            }
        }
    }

    /// Writes text with a white rim, moved so that it is inside the frame.
    pub(super) fn words(&self, out: &mut String, (x, y): (f64, f64), words: &str) {
        let x = x.min(self.right - 6.0 - text_px(words, NOTE_PX)).max(self.left + 6.0);
        let y = y.clamp(self.top + 15.0, self.bottom - 6.0);
        let rim = " paint-order=\"stroke\" stroke=\"#FFFFFF\" stroke-width=\"3\" \
                   stroke-linejoin=\"round\"";
        let rim = format!(" font-size=\"{NOTE_PX}\"{rim}");
        text(out, (x, y), "start", &rim, words);
    }

    pub(super) fn legend(&self, out: &mut String, series: &[Series]) {
        let mut y = self.top + 10.0;
        for entry in series.iter().filter(|s| !s.name.is_empty()) {
            let x = self.right + 16.0;
            if entry.stroke != Stroke::None {
                let _ = writeln!(
                    out,
                    "<path d=\"M{} {}h28\" stroke=\"{}\" stroke-width=\"1.8\"{}/>",
                    px(x),
                    px(y),
                    colour(entry.style),
                    dashes(entry)
                );
            }
            let sample = Series { marker_px: entry.marker_px.max(4.0), ..entry.clone() };
            markers(out, if entry.marker_px > 0.0 { &sample } else { entry }, &[(x + 14.0, y)]);
            for row in wrap(&entry.name, LEGEND_CHARACTERS) {
                text(out, (x + 36.0, y + 4.5), "start", "", &row);
                y += 17.0;
            }
            y += 6.0;
        }
    }
}

/// Width of the legend to the right of the frame \[px\].
fn legend_px(series: &[Series]) -> f64 {
    let rows = series.iter().flat_map(|s| wrap(&s.name, LEGEND_CHARACTERS));
    let widest = rows.map(|row| text_px(&row, FONT_PX)).fold(0.0, f64::max);
    if widest > 0.0 { widest + 58.0 } else { 24.0 }
}

fn dashes(series: &Series) -> String {
    const PATTERNS: [&str; 8] = ["", "7 3", "2 2.5", "9 3 2 3", "13 4", "4 2", "9 2.5 2 2.5 2 2.5", "1.5 4"];
    let pattern = match series.stroke {
        Stroke::Dashed => "6 4",
        // beyond the number of patterns, styles repeat them with another colour
        Stroke::Patterned if series.style != MUTED => {
            PATTERNS[(series.style + series.style / PATTERNS.len()) % PATTERNS.len()]
        }
        _ => "",
    };
    if pattern.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{pattern}\"") }
}

/// Draws all markers of a series. The outline is written once, and an invisible path repeats it at each of its
/// points.
pub(super) fn markers(out: &mut String, series: &Series, points: &[(f64, f64)]) {
    if points.is_empty() || series.marker_px <= 0.0 {
        return;
    }
    let (fill, stroke, width) = if series.open {
        ("#FFFFFF", colour(series.style), "1.8")
    } else {
        (colour(series.style), "#FFFFFF", "0.6")
    };
    // the id contains everything that determines the outline, so that equal ids in one page mean equal outlines
    let open = if series.open { "o" } else { "f" };
    let id = format!("m{}{open}{}", series.style, px(10.0 * series.marker_px));
    let shape = outline(series.style, series.marker_px);
    let corners: Vec<String> = points.iter().map(|(x, y)| format!("{} {}", px(*x), px(*y))).collect();
    let _ = writeln!(
        out,
        "<marker id=\"{id}\" overflow=\"visible\" markerUnits=\"userSpaceOnUse\">\
         <path d=\"{shape}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"{width}\"/></marker>\n\
         <path d=\"M{}\" fill=\"none\" marker-start=\"url(#{id})\" marker-mid=\"url(#{id})\" \
         marker-end=\"url(#{id})\"/>",
        // a path needs two points, so a single point is given twice
        if corners.len() == 1 { format!("{0}L{0}", corners[0]) } else { corners.join("L") }
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        Plot {
            title: "a < b & \"c\"".into(),
            x: Axis::new("x [mm]", Scale::Linear),
            y: Axis::new("y [kg]", Scale::Log),
            series: vec![Series::line(
                "steel",
                0,
                vec![(0.0, 1.0), (5.0, 10.0), (7.0, -1.0), (f64::NAN, 2.0)],
            )],
            ..Plot::default()
        }
    }

    #[test]
    fn words_are_escaped_and_pixels_short() {
        let svg = plot().to_svg();
        assert!(svg.contains("a &lt; b &amp; &quot;c&quot;"));
        assert!(svg.contains("role=\"img\"") && svg.contains("<desc"));
        assert_eq!(px(1.50), "1.5");
        assert_eq!(px(100.0), "100");
    }

    #[test]
    fn values_without_a_place_are_left_out() {
        let svg = plot().to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let drawn = svg.lines().find(|l| l.contains("marker-mid")).unwrap_or_default();
        assert_eq!(drawn.matches('L').count(), 1, "two of four points: {drawn}");
    }

    #[test]
    fn a_front_of_thousands_stays_small_and_series_differ_without_colour() {
        let points = |i: usize| (0..600).map(|j| (1.0 + j as f64, 1.0 + (i * j) as f64)).collect();
        let series = (0..9).map(|i| Series::scatter("front", i, points(i))).collect();
        let svg = Plot { series, ..Plot::default() }.to_svg();
        assert!(svg.len() < 100_000, "{}", svg.len());
        let outlines: std::collections::BTreeSet<String> = (0..8).map(|i| outline(i, 4.0)).collect();
        assert_eq!(outlines.len(), 8);
        let colours: std::collections::BTreeSet<&str> = (0..16).map(colour).collect();
        assert_eq!(colours.len(), 16, "nine materials have nine colours");
        let line = |style: usize| dashes(&Series { stroke: Stroke::Patterned, style, ..Series::default() });
        assert_ne!(line(0), line(8));
        assert_ne!(outline(0, 4.0), outline(8, 4.0), "the ninth has another shape");
        assert_ne!(outline(1, 4.0), outline(8, 4.0), "the same shape comes again with a hole");
    }

    #[test]
    fn an_empty_plot_is_still_a_plot() {
        assert!(Plot::default().to_svg().ends_with("</svg>\n"));
    }

    #[test]
    fn long_names_are_wrapped() {
        let rows = wrap("CFRP AS4/3501-6 (standard modulus) quasi-isotropic", 26);
        assert_eq!(rows, ["CFRP AS4/3501-6 (standard", "modulus) quasi-isotropic"]);
    }
}
