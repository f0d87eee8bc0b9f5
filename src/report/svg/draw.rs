//! Elements that all pictures use: colours, text, lines and the head of the file.

use crate::interchange::xml::escaped;
use crate::report::number::fixed;
use std::fmt::Write;

/// The palette of Okabe and Ito. The colours that contrast best with white come first.
pub const PALETTE: [&str; 8] =
    ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#B8A90A"];

/// Darker colours for styles beyond the number of colours in [`PALETTE`].
const DARKER: [&str; 8] =
    ["#003B5C", "#7A3500", "#00513B", "#7B3A60", "#8A5E00", "#1B6E9E", "#6E6E6E", "#635B00"];

/// Index of the style for series in the background: grey, with round markers.
pub const MUTED: usize = 999;

/// Width of the drawings that fill a page.
pub(crate) const WIDTH_PX: f64 = 900.0;
pub(crate) const INK: &str = "#222222";
pub(crate) const FAINT: &str = "#E3E3E3";
pub(crate) const FONT_PX: f64 = 13.0;
pub(crate) const TITLE_PX: f64 = 16.0;
pub(crate) const NOTE_PX: f64 = 12.0;
/// Width of an average character, divided by the font size. It is rounded up, so that no text needs more space than
/// was reserved.
pub(crate) const CHARACTER_WIDTH: f64 = 0.62;

/// The head of an SVG file: size, white background, and title and description for readers who cannot see it.
pub(crate) fn head(title: &str, description: &str, width_px: f64, height_px: f64) -> String {
    let (w, h, title) = (px(width_px), px(height_px), escaped(title));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
         role=\"img\" aria-label=\"{title}\" \
         font-family=\"'Helvetica Neue', Helvetica, Arial, 'DejaVu Sans', sans-serif\" \
         font-size=\"{FONT_PX}\" fill=\"{INK}\">\n\
         <title>{title}</title>\n<desc>{}</desc>\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"#FFFFFF\"/>\n",
        escaped(description)
    )
}

/// Breaks text into rows of at most `most` characters. Rows are broken only at blanks, so that a longer word makes
/// a longer row.
pub(crate) fn wrap(words: &str, most: usize) -> Vec<String> {
    let mut rows: Vec<String> = Vec::new();
    for word in words.split_whitespace() {
        match rows.last_mut() {
            Some(row) if row.chars().count() + 1 + word.chars().count() <= most => {
                row.push(' ');
                row.push_str(word);
            }
            _ => rows.push(word.to_string()),
        }
    }
    rows
}

/// Colour of a style, as an SVG colour.
pub(crate) fn colour(style: usize) -> &'static str {
    match (style / PALETTE.len()) % 2 {
        _ if style == MUTED => "#A0A0A0",
        0 => PALETTE[style % PALETTE.len()],
        _ => DARKER[style % PALETTE.len()],
    }
}

/// Draws a straight line.
pub(crate) fn line(out: &mut String, from: (f64, f64), to: (f64, f64), colour: &str, width: f64) {
    let _ = writeln!(
        out,
        "<path d=\"M{} {}L{} {}\" stroke=\"{colour}\" stroke-width=\"{width}\"/>",
        px(from.0),
        px(from.1),
        px(to.0),
        px(to.1)
    );
}

/// Draws a dotted grey line.
pub(crate) fn dashed(out: &mut String, from: (f64, f64), to: (f64, f64)) {
    let _ = writeln!(
        out,
        "<path d=\"M{} {}L{} {}\" stroke=\"#777777\" stroke-dasharray=\"2 4\"/>",
        px(from.0),
        px(from.1),
        px(to.0),
        px(to.1)
    );
}

/// Writes text at a position. `more` has further attributes of the SVG element.
pub(crate) fn text(out: &mut String, at: (f64, f64), anchor: &str, more: &str, words: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\"{more}>{}</text>",
        px(at.0),
        px(at.1),
        escaped(words)
    );
}

/// Width of a text, estimated so that it is rather too large \[px\].
pub(crate) fn text_px(words: &str, font_px: f64) -> f64 {
    words.chars().count() as f64 * CHARACTER_WIDTH * font_px
}

/// A coordinate with at most two decimals.
pub(crate) fn px(value: f64) -> String {
    let text = fixed(value, 2);
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}
