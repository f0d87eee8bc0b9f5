//! Outlines of markers, centred on the origin.

use super::draw::{MUTED, PALETTE, px};

/// Outline of the marker of a style, as an SVG path: circle, square, triangle up, diamond, triangle down, plus,
/// cross or star. `r` is its radius \[px\].
pub(crate) fn outline(style: usize, r: f64) -> String {
    const UP: &[(f64, f64)] = &[(0.0, -1.25), (1.15, 0.8), (-1.15, 0.8)];
    const DOWN: &[(f64, f64)] = &[(0.0, 1.25), (1.15, -0.8), (-1.15, -0.8)];
    const SQUARE: &[(f64, f64)] = &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)];
    const DIAMOND: &[(f64, f64)] = &[(0.0, -1.35), (1.1, 0.0), (0.0, 1.35), (-1.1, 0.0)];
    const PLUS: &[(f64, f64)] = &[
        (-0.4, -1.2),
        (0.4, -1.2),
        (0.4, -0.4),
        (1.2, -0.4),
        (1.2, 0.4),
        (0.4, 0.4),
        (0.4, 1.2),
        (-0.4, 1.2),
        (-0.4, 0.4),
        (-1.2, 0.4),
        (-1.2, -0.4),
        (-0.4, -0.4),
    ];
    const STAR: &[(f64, f64)] = &[
        (0.0, -1.4),
        (0.33, -0.45),
        (1.33, -0.43),
        (0.53, 0.17),
        (0.82, 1.13),
        (0.0, 0.56),
        (-0.82, 1.13),
        (-0.53, 0.17),
        (-1.33, -0.43),
        (-0.33, -0.45),
    ];
    // beyond the number of colours, styles repeat the colours with other shapes, which have a hole
    let hole = style != MUTED && (style / PALETTE.len()) % 2 == 1;
    let polygon = |corners: &[(f64, f64)], r: f64, turn_rad: f64| {
        let inner = if hole { polygon(corners.iter().rev(), 0.45 * r, turn_rad) } else { String::new() };
        polygon(corners.iter(), r, turn_rad) + &inner
    };
    match (style + style / PALETTE.len()) % PALETTE.len() {
        _ if style == MUTED => circle(r, 0),
        0 if hole => circle(r, 0) + &circle(0.45 * r, 1),
        0 => circle(r, 0),
        1 => polygon(SQUARE, r, 0.0),
        2 => polygon(UP, r, 0.0),
        3 => polygon(DIAMOND, r, 0.0),
        4 => polygon(DOWN, r, 0.0),
        5 => polygon(PLUS, r, 0.0),
        6 => polygon(PLUS, r, std::f64::consts::FRAC_PI_4),
        _ => polygon(STAR, r, 0.0),
    }
}

/// A circle, drawn anticlockwise or clockwise (`sweep` 0 or 1). Two circles of opposite sense make a ring.
fn circle(r: f64, sweep: u8) -> String {
    let (r, d) = (px(r), px(2.0 * r));
    format!("M-{r} 0a{r} {r} 0 1 {sweep} {d} 0a{r} {r} 0 1 {sweep} -{d} 0z")
}

fn polygon<'a>(corners: impl Iterator<Item = &'a (f64, f64)>, r: f64, turn_rad: f64) -> String {
    let (sin, cos) = libm::sincos(turn_rad);
    let corners: Vec<String> = corners
        .map(|(x, y)| format!("{} {}", px(r * (cos * x - sin * y)), px(r * (sin * x + cos * y))))
        .collect();
    format!("M{}z", corners.join("L"))
}
