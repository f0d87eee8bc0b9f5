//! A drawing of an arm to scale, with its deformation exaggerated by a stated factor.
//!
//! Links have their length and outer size to scale. Joints are symbols: a circle if the axis is perpendicular to
//! the drawing, a bar along the axis if it lies in the plane, a square if the joint slides.

use super::draw::{CHARACTER_WIDTH, FONT_PX, INK, NOTE_PX, head, line, px, text, text_px, wrap};
use crate::interchange::xml::escaped;
use crate::report::number::shortest;
use std::fmt::Write;

/// A point in the plane of the drawing \[m\], x to the right, y up.
pub(crate) type Place = (f64, f64);

/// A link of the drawing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tube {
    /// Name of the link.
    pub name: String,
    /// Points of the link's centre line, each with its displacement \[m\].
    pub line: Vec<(Place, Place)>,
    /// Outer size of the link, across its centre line in the plane \[m\]; 0 draws a line.
    pub size_m: f64,
}

/// A joint of the drawing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pivot {
    /// Name of the joint.
    pub name: String,
    /// Position of the joint, and its displacement \[m\].
    pub at: (Place, Place),
    /// Direction of the joint's axis in the plane; `None` if the axis is perpendicular to it.
    pub axis: Option<Place>,
    /// Whether the joint slides along its axis, instead of turning about it.
    pub slides: bool,
}

/// A drawing of an arm in a pose.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ArmSketch {
    /// Title of the drawing.
    pub title: String,
    /// Description of the drawing in a sentence or two, for readers who cannot see it.
    pub description: String,
    /// Links from base to tip.
    pub tubes: Vec<Tube>,
    /// Joints from base to tip.
    pub pivots: Vec<Pivot>,
    /// Position of the tip, and its displacement \[m\]. A line joins the tip with the payload. `None` draws no such
    /// line.
    pub tip: Option<(Place, Place)>,
    /// Position of the payload's centre, and its displacement \[m\]; `None` draws no payload.
    pub payload: Option<(Place, Place)>,
    /// The two end points of each spring \[m\].
    pub springs: Vec<(Place, Place)>,
    /// Factor by which all displacements are exaggerated.
    pub factor: f64,
    /// Caption below the drawing.
    pub caption: String,
    /// Whether gravity points down in the drawing.
    pub upright: bool,
    /// Width of the drawing \[px\].
    pub width_px: f64,
}

const MARGIN_PX: f64 = 44.0;
const TOP_PX: f64 = 40.0;
/// Height below the arm for the scale bar, without the rows of the caption \[px\].
const FOOT_PX: f64 = 40.0;
/// Distance of the left edge to the scale bar and the caption \[px\].
const EDGE_PX: f64 = 16.0;
const CAPTION_ROW_PX: f64 = 16.0;

impl ArmSketch {
    /// A factor, rounded, by which displacements are exaggerated so that the largest one looks about a tenth as large
    /// as the arm.
    pub(crate) fn fitting_factor(&self) -> f64 {
        let places: Vec<Place> = self.stations().map(|(at, _)| at).collect();
        let span = |of: fn(&Place) -> f64| {
            let values = || places.iter().map(of);
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        };
        let size = span(|p| p.0).max(span(|p| p.1));
        let most = self.stations().map(|(_, moved)| libm::hypot(moved.0, moved.1)).fold(0.0, f64::max);
        let ideal = 0.12 * size / most;
        if !ideal.is_finite() || ideal <= 0.0 {
            return 1.0;
        }
        let power = libm::pow(10f64, libm::log10(ideal).floor());
        let step = [5.0, 2.0, 1.0].into_iter().find(|s| s * power <= ideal).unwrap_or(1.0);
        step * power
    }

    /// The drawing as a self-contained SVG document.
    pub(crate) fn to_svg(&self) -> String {
        let (low, high) = self.bounds();
        let room = self.width_px - 2.0 * MARGIN_PX;
        let (wide, tall) = ((high.0 - low.0).max(1e-6), (high.1 - low.1).max(1e-6));
        let scale = (room / wide).min(0.62 * room / tall);
        let caption = self.caption_rows();
        let height = TOP_PX + tall * scale + FOOT_PX + CAPTION_ROW_PX * caption.len() as f64 + 26.0;
        let left = (self.width_px - wide * scale) / 2.0;
        let at = |p: Place| (left + (p.0 - low.0) * scale, TOP_PX + 12.0 + (high.1 - p.1) * scale);
        let mut out = head(&self.title, &self.description, self.width_px, height);
        text(&mut out, (16.0, 24.0), "start", " font-size=\"15\" font-weight=\"bold\"", &self.title);
        for tube in &self.tubes {
            tube.draw(&mut out, 0.0, scale, &at, "fill=\"#D5D5D5\" stroke=\"#8A8A8A\"");
        }
        self.ground(&mut out, &at);
        for tube in &self.tubes {
            tube.draw(
                &mut out,
                self.factor,
                scale,
                &at,
                "fill=\"#56B4E955\" stroke=\"#0072B2\" stroke-width=\"1.8\"",
            );
        }
        self.springs.iter().for_each(|(from, to)| coil(&mut out, at(*from), at(*to)));
        self.pivots(&mut out, &at);
        self.pivot_names(&mut out, scale, &at);
        self.payload(&mut out, &at);
        self.foot(&mut out, scale, height, &caption);
        out.push_str("</svg>\n");
        out
    }

    fn stations(&self) -> impl Iterator<Item = (Place, Place)> + '_ {
        let tubes = self.tubes.iter().flat_map(|t| t.line.iter().copied());
        let springs = self.springs.iter().flat_map(|(a, b)| [(*a, (0.0, 0.0)), (*b, (0.0, 0.0))]);
        tubes.chain(self.pivots.iter().map(|p| p.at)).chain(self.payload).chain(springs)
    }

    /// Lower left and upper right limits of all that is drawn \[m\].
    fn bounds(&self) -> (Place, Place) {
        let half = self.tubes.iter().map(|t| t.size_m / 2.0).fold(0.02, f64::max);
        let (mut low, mut high) = ((0.0f64, 0.0f64), (0.0f64, 0.0f64));
        for (at, moved) in self.stations() {
            for p in [at, displaced((at, moved), self.factor)] {
                low = (low.0.min(p.0), low.1.min(p.1));
                high = (high.0.max(p.0), high.1.max(p.1));
            }
        }
        ((low.0 - half, low.1 - half), (high.0 + half, high.1 + half))
    }

    fn ground(&self, out: &mut String, at: &impl Fn(Place) -> (f64, f64)) {
        let (x, y) = at((0.0, 0.0));
        if self.upright {
            let _ = writeln!(
                out,
                "<path d=\"M{} {}h44m-40 0l-8 9m18 -9l-8 9m18 -9l-8 9m18 -9l-8 9m14 -9\" fill=\"none\" stroke=\"{INK}\" \
                 stroke-width=\"1.4\"/>",
                px(x - 22.0),
                px(y + 10.0)
            );
        }
    }

    /// Draws the joints at their positions in the deformed arm.
    fn pivots(&self, out: &mut String, at: &impl Fn(Place) -> (f64, f64)) {
        for pivot in &self.pivots {
            let (x, y) = at(displaced(pivot.at, self.factor));
            match pivot.axis {
                _ if pivot.slides => {
                    let (left, top) = (px(x - 7.0), px(y - 7.0));
                    let _ = writeln!(
                        out,
                        "<rect x=\"{left}\" y=\"{top}\" width=\"14\" height=\"14\" fill=\"#FFFFFF\" stroke=\"{INK}\" stroke-width=\"2\"/>"
                    );
                }
                None => {
                    let _ = writeln!(
                        out,
                        "<circle cx=\"{0}\" cy=\"{1}\" r=\"6.5\" fill=\"#FFFFFF\" stroke=\"{INK}\" stroke-width=\"2\"/>\
                         <circle cx=\"{0}\" cy=\"{1}\" r=\"1.8\"/>",
                        px(x),
                        px(y)
                    );
                }
                Some(axis) => {
                    let long = libm::hypot(axis.0, axis.1).max(1e-9);
                    let (dx, dy) = (11.0 * axis.0 / long, -11.0 * axis.1 / long);
                    line(out, (x - dx, y - dy), (x + dx, y + dy), INK, 3.0);
                }
            }
        }
    }

    /// Writes the names of the joints above the undeformed arm. Joints at the same position share one label.
    fn pivot_names(&self, out: &mut String, scale: f64, at: &impl Fn(Place) -> (f64, f64)) {
        // labels are above the thickest link
        let raised = 9.0 + self.tubes.iter().map(|t| t.size_m / 2.0 * scale).fold(8.0, f64::max);
        let mut labels: Vec<((f64, f64), Vec<&str>)> = Vec::new();
        for pivot in &self.pivots {
            let (x, y) = at(pivot.at.0);
            match labels.iter_mut().find(|((lx, ly), _)| libm::hypot(lx - x, ly - y) < 24.0) {
                Some((_, names)) => names.push(&pivot.name),
                None => labels.push(((x, y), vec![&pivot.name])),
            }
        }
        for ((x, y), names) in labels {
            let words = names.join(", ");
            // the label is moved so that it does not leave the picture
            let half = text_px(&words, FONT_PX) / 2.0;
            let x = x.min(self.width_px - 8.0 - half).max(8.0 + half);
            let rim = " font-size=\"12\" paint-order=\"stroke\" stroke=\"#FFFFFF\" stroke-width=\"3\"";
            text(out, (x, (y - raised).max(TOP_PX - 2.0)), "middle", rim, &words);
        }
    }

    fn payload(&self, out: &mut String, at: &impl Fn(Place) -> (f64, f64)) {
        if let Some(payload) = self.payload {
            let (x, y) = at(displaced(payload, self.factor));
            if let Some(tip) = self.tip {
                line(out, at(displaced(tip, self.factor)), (x, y), INK, 1.4);
            }
            let _ = writeln!(
                out,
                "<rect x=\"{}\" y=\"{}\" width=\"13\" height=\"13\" fill=\"#D55E00\" stroke=\"{INK}\"><title>payload</title></rect>",
                px(x - 6.5),
                px(y - 6.5)
            );
        }
    }

    /// Draws the scale bar, the direction of gravity and the caption.
    fn foot(&self, out: &mut String, scale: f64, height: f64, caption: &[String]) {
        let bar_m =
            [2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02].into_iter().find(|m| m * scale < 0.3 * self.width_px);
        let bar_m = bar_m.unwrap_or(0.01);
        let caption_px = CAPTION_ROW_PX * caption.len() as f64;
        let y = height - caption_px - 18.0;
        let end = EDGE_PX + bar_m * scale;
        let _ = writeln!(
            out,
            "<path d=\"M{EDGE_PX} {0}v6H{1}v-6\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.4\"/>",
            px(y - 3.0),
            px(end)
        );
        let small = format!(" font-size=\"{NOTE_PX}\"");
        text(out, (end + 8.0, y + 4.0), "start", &small, &format!("{} m", shortest(bar_m)));
        if self.upright {
            let x = self.width_px - 22.0;
            let _ = writeln!(
                out,
                "<path d=\"M{0} {1}v22m-5 -7l5 7l5 -7\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.4\"/>",
                px(x),
                px(y - 22.0)
            );
            text(out, (x - 8.0, y - 6.0), "end", &small, "g");
        }
        for (i, row) in caption.iter().enumerate() {
            let y = height - caption_px + 6.0 + CAPTION_ROW_PX * i as f64;
            text(out, (EDGE_PX, y), "start", &small, row);
        }
    }

    /// The caption, broken into rows that are no wider than the drawing.
    fn caption_rows(&self) -> Vec<String> {
        wrap(&self.caption, ((self.width_px - 2.0 * EDGE_PX) / (CHARACTER_WIDTH * NOTE_PX)) as usize)
    }
}

impl Tube {
    fn draw(&self, out: &mut String, factor: f64, scale: f64, at: &impl Fn(Place) -> (f64, f64), look: &str) {
        let points: Vec<(f64, f64)> = self.line.iter().map(|s| at(displaced(*s, factor))).collect();
        let half = (self.size_m * scale / 2.0).max(1.6);
        let normals: Vec<(f64, f64)> = (0..points.len()).map(|i| normal(&points, i)).collect();
        let side = |sign: f64| -> Vec<String> {
            let both = points.iter().zip(&normals);
            both.map(|(p, n)| format!("{} {}", px(p.0 + sign * half * n.0), px(p.1 + sign * half * n.1)))
                .collect()
        };
        let mut corners = side(1.0);
        corners.extend(side(-1.0).into_iter().rev());
        let _ = writeln!(
            out,
            "<path d=\"M{}z\" {look} stroke-linejoin=\"round\"><title>{}</title></path>",
            corners.join("L"),
            escaped(&self.name)
        );
    }
}

/// Unit vector perpendicular to the line through `points`, at the point with the index `i`.
fn normal(points: &[(f64, f64)], i: usize) -> (f64, f64) {
    let (a, b) = (points[i.saturating_sub(1)], points[(i + 1).min(points.len() - 1)]);
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let long = libm::hypot(dx, dy);
    if long > 0.0 { (-dy / long, dx / long) } else { (0.0, 0.0) }
}

/// Draws a spring as a zigzag between two points.
fn coil(out: &mut String, from: (f64, f64), to: (f64, f64)) {
    const TURNS: usize = 12;
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let long = libm::hypot(dx, dy).max(1e-9);
    let mut path = format!("M{} {}", px(from.0), px(from.1));
    for turn in 1..TURNS {
        let (part, side) = (turn as f64 / TURNS as f64, if turn % 2 == 0 { 4.0 } else { -4.0 });
        let (x, y) = (from.0 + part * dx - side * dy / long, from.1 + part * dy + side * dx / long);
        let _ = write!(path, "L{} {}", px(x), px(y));
    }
    let _ = writeln!(
        out,
        "<path d=\"{path}L{} {}\" fill=\"none\" stroke=\"#009E73\" stroke-width=\"1.6\"><title>spring</title></path>",
        px(to.0),
        px(to.1)
    );
}

fn displaced(((x, y), (dx, dy)): (Place, Place), factor: f64) -> Place {
    (x + factor * dx, y + factor * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sketch() -> ArmSketch {
        let line = vec![((0.0, 0.0), (0.0, 0.0)), ((1.0, 0.0), (0.0, -0.002))];
        ArmSketch {
            title: "arm".into(),
            tubes: vec![Tube { name: "a".into(), line, size_m: 0.1 }],
            pivots: vec![Pivot { name: "j".into(), at: ((0.0, 0.0), (0.0, 0.0)), axis: None, slides: false }],
            factor: 50.0,
            upright: true,
            width_px: 500.0,
            ..ArmSketch::default()
        }
    }

    #[test]
    fn the_factor_is_round_and_makes_the_motion_visible() {
        assert_eq!(sketch().fitting_factor(), 50.0);
        assert_eq!(ArmSketch::default().fitting_factor(), 1.0);
    }

    #[test]
    fn a_spring_goes_from_end_to_end_and_is_within_the_drawing() {
        let sprung = ArmSketch { springs: vec![((-0.5, 0.8), (0.5, 0.0))], ..sketch() };
        let ((left, _), (_, top)) = sprung.bounds();
        assert!(left <= -0.5 && top >= 0.8);
        let svg = sprung.to_svg();
        let path = svg.lines().find(|line| line.contains("<title>spring</title>")).unwrap_or_default();
        assert_eq!(path.matches('L').count(), 12, "{path}");
        assert!(!sketch().to_svg().contains("<title>spring</title>"));
    }

    #[test]
    fn the_payload_hangs_at_the_tip_and_names_at_one_place_are_divided() {
        let mut arm = sketch();
        let pivot = |name: &str| Pivot { name: name.into(), ..arm.pivots[0].clone() };
        arm.pivots = ["roll", "quill"].map(pivot).to_vec();
        // the last tube of the drawing ends at x = 1 m; the tip is 0.2 m below this end, at the lower end of a vertical
        // slide
        arm.tip = Some(((1.0, -0.2), (0.0, 0.0)));
        arm.payload = Some(((1.0, -0.4), (0.0, 0.0)));
        let svg = arm.to_svg();
        assert!(svg.contains(">roll, quill<"), "{svg}");
        let to_payload = svg.lines().find(|l| l.contains("stroke-width=\"1.4\"") && l.contains('L'));
        let numbers: Vec<f64> = to_payload
            .unwrap_or_default()
            .split(['M', 'L', ' ', '"'])
            .filter_map(|w| w.parse().ok())
            .collect();
        // the line to the payload goes down by 0.2 m and not sideways
        assert!(
            numbers.len() >= 4 && (numbers[0] - numbers[2]).abs() < 0.01 && numbers[3] > numbers[1],
            "{numbers:?}"
        );
    }

    #[test]
    fn a_long_caption_is_broken_into_rows_within_the_drawing() {
        let caption =
            "links to scale, joints as symbols; bent shape exaggerated 50 times: 1.234 mm at the tip"
                .to_string();
        let narrow = ArmSketch { caption, width_px: 300.0, ..sketch() };
        let rows = narrow.caption_rows();
        assert!(
            rows.len() > 1 && rows.iter().all(|row| text_px(row, NOTE_PX) <= 300.0 - 2.0 * EDGE_PX),
            "{rows:?}"
        );
        let svg = narrow.to_svg();
        assert!(rows.iter().all(|row| svg.contains(&format!(">{row}</text>"))), "{svg}");
    }

    #[test]
    fn a_tube_is_as_wide_as_it_is_beside_its_length() {
        let svg = sketch().to_svg();
        let path = svg.lines().find(|l| l.contains("#D5D5D5")).unwrap_or_default();
        let numbers: Vec<f64> =
            path.split(['M', 'L', ' ', 'z', '"']).filter_map(|w| w.parse().ok()).collect();
        let (length, size) = (numbers[2] - numbers[0], (numbers[1] - numbers[7]).abs());
        assert!((length / size - 10.0).abs() < 0.1, "{length} {size} {path}");
    }
}
