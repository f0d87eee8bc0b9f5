//! Several plots in one picture, one below the other, with aligned frames and one legend.

use super::draw::{INK, NOTE_PX, line, px, text, text_px};
use super::plot::{Canvas, Plot, Series};
use crate::interchange::xml::escaped;
use std::fmt::Write;

/// Radius of the ring around a point that has a note \[px\].
const RING_PX: f64 = 7.0;

/// Several plots in one picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// Title for readers who cannot see the picture; the plots have their own titles.
    pub title: String,
    /// Description of the picture in a sentence or two, for readers who cannot see it.
    pub description: String,
    /// Plots from top to bottom. The legend is next to the first one. The points of notes get a ring. The notes are
    /// placed where they cover least, whatever their `side` is.
    pub plots: Vec<Plot>,
}

impl Sheet {
    /// The sheet as a self-contained SVG document.
    pub fn to_svg(&self) -> String {
        let cover = Plot {
            title: self.title.clone(),
            description: self.description.clone(),
            width_px: self.plots.iter().map(|p| p.width_px).fold(0.0, f64::max),
            height_px: self.plots.iter().map(|p| p.height_px).sum(),
            ..Plot::default()
        };
        let mut out = cover.head();
        let mut top = 0.0;
        for (index, (plot, canvas)) in self.plots.iter().zip(self.canvases()).enumerate() {
            let _ = writeln!(
                out,
                "<g transform=\"translate(0 {})\" role=\"group\" aria-label=\"{}\">",
                px(top),
                escaped(&format!("{} over {}", plot.y.label, plot.x.label))
            );
            canvas.panel(&mut out, plot, index == 0);
            out.push_str("</g>\n");
            top += plot.height_px;
        }
        out.push_str("</svg>\n");
        out
    }

    /// The frame of each plot, with left and right edges aligned.
    fn canvases(&self) -> Vec<Canvas> {
        let mut canvases: Vec<Canvas> = self.plots.iter().map(Canvas::new).collect();
        let left = canvases.iter().map(|c| c.left).fold(0.0, f64::max);
        let right = canvases.iter().map(|c| c.right).fold(f64::INFINITY, f64::min);
        for canvas in &mut canvases {
            (canvas.left, canvas.right) = (left, right);
        }
        canvases
    }
}

impl Canvas {
    fn panel(&self, out: &mut String, plot: &Plot, with_legend: bool) {
        self.grid(out, plot);
        self.guides(out, &plot.guides);
        for series in &plot.series {
            self.series(out, series);
        }
        self.ringed_notes(out, plot);
        if with_legend {
            self.legend(out, &plot.series);
        }
    }

    /// Draws notes with rings at their points. Each note is placed where it covers least.
    fn ringed_notes(&self, out: &mut String, plot: &Plot) {
        let noted: Vec<_> = plot.notes.iter().filter_map(|n| Some((n, self.inside(n.at)?))).collect();
        let mut obstacles = Obstacles {
            points: plot
                .series
                .iter()
                .flat_map(|s: &Series| &s.points)
                .filter_map(|p| self.inside(*p))
                .collect(),
            rings: noted.iter().map(|(_, place)| *place).collect(),
            boxes: Vec::new(),
        };
        for (note, place) in noted {
            let size = (text_px(&note.text, NOTE_PX), NOTE_PX);
            let set = self.candidates(place, size).into_iter().min_by_key(|b| obstacles.cost(b, place));
            ring(out, place);
            if let Some(set) = set {
                leader(out, place, &set);
                let style = " font-size=\"12\" font-weight=\"bold\" paint-order=\"stroke\" stroke=\"#FFFFFF\" \
                             stroke-width=\"3\" stroke-linejoin=\"round\"";
                text(out, (set.left, set.bottom - 2.0), "start", style, &note.text);
                obstacles.boxes.push(set);
            }
        }
    }

    /// Possible positions for a note with the size (`width`, `height`) around the point (`x`, `y`), inside the frame
    /// \[px\]. The nearest come first.
    fn candidates(&self, (x, y): (f64, f64), (width, height): (f64, f64)) -> Vec<Rect> {
        let inside = |b: &Rect| {
            b.left >= self.left + 4.0
                && b.right <= self.right - 4.0
                && b.top >= self.top + 4.0
                && b.bottom <= self.bottom - 4.0
        };
        [16.0, 34.0, 56.0, 80.0, 110.0]
            .into_iter()
            .flat_map(|r| (0..16).map(move |i| (r, f64::from(i) * std::f64::consts::PI / 8.0)))
            .map(|(r, angle)| {
                let (sin, cos) = libm::sincos(angle);
                let middle = (x + cos * (r + width / 2.0), y - sin * (r + height / 2.0));
                Rect::around(middle, width, height)
            })
            .filter(inside)
            .collect()
    }
}

/// Positions that a note should not cover: points of the data, rings, and other notes.
struct Obstacles {
    points: Vec<(f64, f64)>,
    rings: Vec<(f64, f64)>,
    boxes: Vec<Rect>,
}

impl Obstacles {
    /// Cost of the position `place` for a note. Covering other notes and rings costs most, then covering points, then
    /// the distance to `own`, the ring of the note.
    fn cost(&self, place: &Rect, own: (f64, f64)) -> u64 {
        let boxes = self.boxes.iter().filter(|b| b.touches(place)).count() as u64;
        let rings =
            self.rings.iter().filter(|r| place.touches(&Rect::around(**r, 16.0, 16.0))).count() as u64;
        let points =
            self.points.iter().filter(|p| place.touches(&Rect::around(**p, 3.0, 3.0))).count() as u64;
        let (x, y) = place.nearest(own);
        let way = libm::hypot(x - own.0, y - own.1);
        (boxes + rings) * 1_000_000 + points * 200 + (way * 10.0) as u64
    }
}

/// A rectangle \[px\].
#[derive(Debug, Clone, Copy)]
struct Rect {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Rect {
    fn around((x, y): (f64, f64), width: f64, height: f64) -> Self {
        Self {
            left: x - width / 2.0,
            right: x + width / 2.0,
            top: y - height / 2.0,
            bottom: y + height / 2.0,
        }
    }

    fn touches(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    /// The point of the rectangle that is nearest to the point (`x`, `y`) \[px\].
    fn nearest(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (x.clamp(self.left, self.right), y.clamp(self.top, self.bottom))
    }
}

fn ring(out: &mut String, (x, y): (f64, f64)) {
    for (colour, width) in [("#FFFFFF", 4.5), (INK, 2.0)] {
        let _ = writeln!(
            out,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{RING_PX}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>",
            px(x),
            px(y)
        );
    }
}

/// Draws a thin line from a ring to its note, if the note is not next to the ring.
fn leader(out: &mut String, (x, y): (f64, f64), note: &Rect) {
    let (end_x, end_y) = note.nearest((x, y));
    let way = libm::hypot(end_x - x, end_y - y);
    if way > RING_PX + 6.0 {
        let start = RING_PX / way;
        line(out, (x + start * (end_x - x), y + start * (end_y - y)), (end_x, end_y), INK, 1.0);
    }
}
