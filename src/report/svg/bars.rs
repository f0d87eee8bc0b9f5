//! Stacked bars: the parts of a whole, one bar per case, with the parts in the same order and look.
//!
//! Two families of parts differ by hue *and* by hatching. Parts of a family differ by lightness. A part that is
//! wide enough has its name and share written on it, so that the picture can be read in greyscale.

use super::draw::{FONT_PX, INK, WIDTH_PX, head, line, px, text, text_px};
use crate::interchange::xml::escaped;
use crate::report::number::{percent, shortest};
use crate::report::table::csv_line;
use std::fmt::Write;

const BAR_PX: f64 = 34.0;
const GAP_PX: f64 = 18.0;
const TOP_PX: f64 = 44.0;

/// A part of the stack, which every bar has.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    /// Name of the part.
    pub name: String,
    /// Whether the part belongs to the second family, which is hatched.
    pub hatched: bool,
}

/// One bar.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Bar {
    /// Text to the left of the bar.
    pub label: String,
    /// Text to the right of the bar: its total.
    pub total: String,
    /// The value of each part. Negative values extend to the left of zero.
    pub values: Vec<f64>,
}

/// A picture of bars, one below the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct StackedBars {
    /// Title of the picture.
    pub title: String,
    /// Description of the bars in a sentence or two, for readers who cannot see them.
    pub description: String,
    /// Unit of the values.
    pub unit: String,
    /// The parts, in the order of the stack.
    pub parts: Vec<Part>,
    /// The bars from top to bottom.
    pub bars: Vec<Bar>,
}

/// Ratio of the longest to the shortest bar above which the parts of the shortest bar would be too small to be seen.
const FAR_APART: f64 = 8.0;

impl StackedBars {
    /// This picture in a readable form. If some bar would be too short to be seen, all bars get the same length, and
    /// each shows fractions of its own total.
    #[must_use]
    pub(crate) fn readable(mut self) -> Self {
        let whole = |bar: &Bar| bar.values.iter().sum::<f64>();
        let (least, most) = self
            .bars
            .iter()
            .map(whole)
            .fold((f64::INFINITY, 0.0f64), |(least, most), x| (least.min(x), most.max(x)));
        if least > 0.0 && most > FAR_APART * least {
            self.title.push_str(", each bar a whole");
            for bar in &mut self.bars {
                let whole = whole(bar);
                bar.values.iter_mut().for_each(|value| *value /= whole);
            }
        }
        self
    }

    /// The bars as a self-contained SVG document.
    pub(crate) fn to_svg(&self) -> String {
        let legend = self.legend_rows();
        let bars_px = self.bars.len() as f64 * (BAR_PX + GAP_PX);
        let height = TOP_PX + bars_px + 20.0 + legend.len() as f64 * 22.0 + 8.0;
        let mut out = head(&self.title, &self.description, WIDTH_PX, height);
        self.hatching(&mut out);
        text(&mut out, (16.0, 26.0), "start", " font-size=\"16\" font-weight=\"bold\"", &self.title);
        let label_px = self.bars.iter().map(|b| text_px(&b.label, FONT_PX)).fold(0.0, f64::max);
        let total_px = self.bars.iter().map(|b| text_px(&b.total, FONT_PX)).fold(0.0, f64::max);
        let (left, right) = (24.0 + label_px, WIDTH_PX - 24.0 - total_px);
        let (low, high) = self.extent();
        let x = |value: f64| left + (value - low) / (high - low) * (right - left);
        for (i, bar) in self.bars.iter().enumerate() {
            let y = TOP_PX + i as f64 * (BAR_PX + GAP_PX);
            let middle = y + BAR_PX / 2.0 + 4.5;
            text(&mut out, (left - 10.0, middle), "end", "", &bar.label);
            let end = self.bar(&mut out, bar, y, &x);
            text(&mut out, (end + 8.0, middle), "start", " font-weight=\"bold\"", &bar.total);
        }
        line(&mut out, (x(0.0), TOP_PX - 4.0), (x(0.0), TOP_PX + bars_px - GAP_PX + 4.0), INK, 1.2);
        for (i, row) in legend.iter().enumerate() {
            let y = TOP_PX + bars_px + 14.0 + i as f64 * 22.0;
            for (part, x) in row {
                self.swatch(&mut out, *part, (*x, y));
            }
        }
        out.push_str("</svg>\n");
        out
    }

    /// The values of the bars as CSV, one line per bar and part.
    pub(crate) fn to_csv(&self) -> String {
        let mut out = csv_line(&["case".into(), "part".into(), self.unit.clone()]);
        for bar in &self.bars {
            for (part, value) in self.parts.iter().zip(&bar.values) {
                let value = shortest(*value);
                out.push_str(&csv_line(&[bar.label.clone(), part.name.clone(), value]));
            }
        }
        out
    }

    fn extent(&self) -> (f64, f64) {
        let sum = |bar: &Bar, sign: f64| bar.values.iter().map(|v| (sign * v).max(0.0)).sum::<f64>();
        let high = self.bars.iter().map(|b| sum(b, 1.0)).fold(0.0, f64::max);
        let low = -self.bars.iter().map(|b| sum(b, -1.0)).fold(0.0, f64::max);
        if high > low { (low, high) } else { (0.0, 1.0) }
    }

    /// Draws one bar at the height `y` \[px\]. `x` converts values to horizontal positions \[px\]. Returns the position
    /// of the bar's right end \[px\].
    fn bar(&self, out: &mut String, bar: &Bar, y: f64, x: &impl Fn(f64) -> f64) -> f64 {
        let (mut below, mut above) = (0.0, 0.0);
        let whole: f64 = bar.values.iter().sum();
        for (part, value) in bar.values.iter().enumerate() {
            let side = if *value < 0.0 { &mut below } else { &mut above };
            let (from, to) = (*side, *side + value);
            *side = to;
            let (left, right) = (x(from.min(to)), x(from.max(to)));
            self.block(out, part, (left, y), (right - left, BAR_PX));
            let share = percent(100.0 * value / whole, 0);
            let full = format!("{} {share}", self.parts[part].name);
            let fitting = [full, share].into_iter().find(|w| text_px(w, 12.0) < right - left - 6.0);
            if let Some(words) = fitting {
                // hatching makes text hard to read, so the text gets a rim in the colour of the part
                let hatched = self.parts[part].hatched;
                let ink = if !hatched && self.shade(part) < 0.45 { "#FFFFFE" } else { "#111111" };
                let rim = if hatched { self.fill(part) } else { "none".into() };
                let style = format!(
                    " font-size=\"12\" fill=\"{ink}\" paint-order=\"stroke\" stroke=\"{rim}\" stroke-width=\"4\""
                );
                text(out, ((left + right) / 2.0, y + BAR_PX / 2.0 + 4.5), "middle", &style, &words);
            }
        }
        x(above)
    }

    fn block(&self, out: &mut String, part: usize, (x, y): (f64, f64), (width, height): (f64, f64)) {
        let fill = self.fill(part);
        let mut rect = |fill: &str| {
            let _ = writeln!(
                out,
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{fill}\" stroke=\"#FFFFFF\" \
                 stroke-width=\"1.5\"><title>{}</title></rect>",
                px(x),
                px(y),
                px(width.max(0.0)),
                px(height),
                escaped(&self.parts[part].name)
            );
        };
        rect(&fill);
        if self.parts[part].hatched {
            rect("url(#hatch)");
        }
    }

    fn swatch(&self, out: &mut String, part: usize, (x, y): (f64, f64)) {
        self.block(out, part, (x, y - 11.0), (16.0, 14.0));
        text(out, (x + 22.0, y), "start", "", &self.parts[part].name);
    }

    /// The legend in rows that fit the width: index of each part, and horizontal position of its entry \[px\].
    fn legend_rows(&self) -> Vec<Vec<(usize, f64)>> {
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new()];
        let mut x = 24.0;
        for (i, part) in self.parts.iter().enumerate() {
            let width = 46.0 + text_px(&part.name, FONT_PX);
            if x + width > WIDTH_PX && x > 24.0 {
                rows.push(Vec::new());
                x = 24.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((i, x));
            }
            x += width;
        }
        rows
    }

    /// Lightness of a part within its family: 0 is the darkest, 1 the lightest.
    fn shade(&self, part: usize) -> f64 {
        let same = |p: &&Part| p.hatched == self.parts[part].hatched;
        let count = self.parts.iter().filter(same).count();
        let index = self.parts[..part].iter().filter(same).count();
        if count > 1 { index as f64 / (count - 1) as f64 } else { 0.0 }
    }

    fn fill(&self, part: usize) -> String {
        let (dark, light) = match self.parts[part].hatched {
            false => ([8.0, 69.0, 119.0], [176.0, 212.0, 238.0]),
            true => ([214.0, 122.0, 40.0], [253.0, 222.0, 176.0]),
        };
        let t = self.shade(part);
        let mix = |i: usize| (dark[i] + t * (light[i] - dark[i])).round() as u8;
        format!("#{:02X}{:02X}{:02X}", mix(0), mix(1), mix(2))
    }

    fn hatching(&self, out: &mut String) {
        if self.parts.iter().any(|p| p.hatched) {
            out.push_str(
                "<defs><pattern id=\"hatch\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\" \
                 patternTransform=\"rotate(45)\"><path d=\"M0 0v6\" stroke=\"#00000055\" stroke-width=\"2\"/>\
                 </pattern></defs>\n",
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_far_apart_are_drawn_as_long_as_each_other() {
        let of = |values: [f64; 2]| Bar { values: values.to_vec(), ..Bar::default() };
        let near = StackedBars { bars: vec![of([1.0, 2.0]), of([5.0, 4.0])], ..bars() };
        assert_eq!(near.clone().readable(), near);
        let far = StackedBars { bars: vec![of([0.1, 0.3]), of([50.0, 40.0])], ..bars() }.readable();
        assert!(far.title.ends_with("each bar a whole"));
        assert!(far.bars.iter().all(|bar| (bar.values.iter().sum::<f64>() - 1.0).abs() < 1e-12));
        assert!((far.bars[0].values[0] - 0.25).abs() < 1e-12);
    }

    fn bars() -> StackedBars {
        StackedBars {
            title: "t".into(),
            unit: "mm".into(),
            parts: ["j1", "j2", "arm"].map(|n| Part { name: n.into(), hatched: n == "arm" }).to_vec(),
            bars: vec![Bar { label: "a".into(), total: "5 mm".into(), values: vec![3.0, -1.0, 3.0] }],
            ..StackedBars::default()
        }
    }

    #[test]
    fn parts_have_looks_of_their_own_and_say_their_share() {
        let svg = bars().to_svg();
        assert!(svg.contains(">j1 60 %<") && svg.contains("url(#hatch)") && !svg.contains("NaN"));
        let bars = bars();
        assert_ne!(bars.fill(0), bars.fill(1));
        assert_eq!(bars.extent(), (-1.0, 6.0));
    }

    #[test]
    fn the_numbers_behind_the_bars_are_all_there() {
        assert_eq!(bars().to_csv(), "case,part,mm\na,j1,3\na,j2,-1\na,arm,3\n");
    }
}
