//! `fig2-metals`: deflection against weight per length of steel, titanium and aluminium.

use super::beam::{BeamPoint, sizes};
use super::figure::{Figure, deflection_plot};
use crate::catalog::Catalogs;
use crate::catalog::material::Material;
use crate::paper::claim::Claim;
use crate::paper::output::{PaperError, PaperStudyOutput};
use crate::paper::parts;
use crate::report::number::{fixed, shortest, significant};
use crate::report::svg::plot::{Note, Plot, Series, Side};
use crate::report::table::{Column, Table};

/// The metals of the figure: name in the legend, and name in the catalog.
pub const METALS: [(&str, &str); 3] = [
    ("steel", "Structural steel S235"),
    ("titanium", "Titanium Ti-6Al-4V"),
    ("aluminium", "Aluminium 6082-T6"),
];
/// Other rows of the catalog that the paper's metals could be.
const OTHERS: [&str; 4] =
    ["Structural steel S355", "Titanium grade 2", "Aluminium 6061-T6", "Aluminium 7075-T6"];

/// One curve of the figure, for one metal.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the metal in the legend.
    pub name: &'static str,
    /// Sections of the curve, smallest first.
    pub points: Vec<BeamPoint>,
}

/// The three curves of the figure.
///
/// # Errors
/// The catalog lacks a material.
pub fn curves(catalogs: &Catalogs) -> Result<Vec<Curve>, PaperError> {
    METALS
        .iter()
        .map(|(name, row)| Ok(Curve { name, points: sizes(parts::material(catalogs, row)?) }))
        .collect()
}

/// The claims of the paper about the figure, checked.
pub fn claims(curves: &[Curve]) -> Vec<Claim> {
    vec![falls(curves), converges(curves), in_ratio(curves), gains_more(curves), best_metal(curves)]
}

/// Computes Fig 2 of the paper (deflection against weight of a hollow beam in three metals) with its table and claims.
///
/// # Errors
/// A material of the figure is not in the catalog.
pub fn run(catalogs: &Catalogs) -> Result<PaperStudyOutput, PaperError> {
    let curves = curves(catalogs)?;
    let figure = Figure {
        name: "fig2-metals",
        title: "Fig 2: deflection of a hollow beam in three metals",
        plot: plot(&curves),
        claims: claims(&curves),
        points: curves.into_iter().flat_map(|c| c.points).collect(),
        tables: vec![("Which alloy gives which range", "alloys", alloys(catalogs)?)],
        words: String::new(),
    };
    Ok(figure.output())
}

fn plot(curves: &[Curve]) -> Plot {
    let series = |(style, curve): (usize, &Curve)| {
        Series::line(curve.name, style, curve.points.iter().map(BeamPoint::in_figure).collect())
    };
    let note = |point: &BeamPoint, side| Note {
        at: point.in_figure(),
        text: format!("{} mm", fixed(1e3 * point.size_m, 0)),
        side,
    };
    let smallest = curves.iter().filter_map(|c| c.points.first()).map(|p| note(p, Side::RightAbove));
    let largest = curves.iter().filter_map(|c| c.points.last()).map(|p| note(p, Side::LeftBelow));
    Plot {
        series: curves.iter().enumerate().map(series).collect(),
        notes: smallest.chain(largest).collect(),
        ..deflection_plot(
            "Deflection against weight: metals, square tubes, wall 10 mm",
            "Deflection of a 0.8 m cantilever under 500 N against its weight per length, for steel, titanium and \
             aluminium, one marker a centimetre of outer size from 70 to 160 mm. All three fall steeply; at equal \
             weight aluminium deflects least.",
        )
    }
}

fn falls(curves: &[Curve]) -> Claim {
    let monotone = |c: &Curve| c.points.windows(2).all(|w| w[1].deflection_m < w[0].deflection_m);
    let ranges: Vec<String> = curves.iter().map(|c| format!("{} {} mm", c.name, range(&c.points))).collect();
    Claim::new(
        "grows_stiffer",
        "Deflection falls when the outer dimensions grow",
        curves.iter().all(monotone),
        ranges.join(", "),
    )
}

fn range(points: &[BeamPoint]) -> String {
    let mm = |p: Option<&BeamPoint>| p.map_or_else(|| "-".to_string(), |p| fixed(1e3 * p.deflection_m, 3));
    format!("{} to {}", mm(points.first()), mm(points.last()))
}

/// The largest and the smallest deflection that any of the metals has \[m\], for each outer size.
fn extremes(curves: &[Curve]) -> Vec<(f64, f64)> {
    let at = |i: usize| curves.iter().filter_map(move |c| c.points.get(i)).map(|p| p.deflection_m);
    let count = curves.first().map_or(0, |c| c.points.len());
    (0..count).map(|i| (at(i).fold(0.0, f64::max), at(i).fold(f64::INFINITY, f64::min))).collect()
}

fn converges(curves: &[Curve]) -> Claim {
    let spread: Vec<f64> = extremes(curves).iter().map(|(high, low)| 1e3 * (high - low)).collect();
    let (first, last) = ends(&spread);
    Claim::new(
        "converge_in_mm",
        "The metals differ most at small sections and come together, in millimetres, at large ones",
        spread.windows(2).all(|w| w[1] < w[0]),
        format!("softest less stiffest: {} mm at 70 mm, {} mm at 160 mm", fixed(first, 3), fixed(last, 3)),
    )
}

fn in_ratio(curves: &[Curve]) -> Claim {
    let ratio: Vec<f64> = extremes(curves).iter().map(|(high, low)| high / low).collect();
    let (first, last) = ends(&ratio);
    Claim::new(
        "converge_in_ratio",
        "The same claim taken as a ratio: the deflections become approximately equal",
        last < 1.1,
        format!(
            "softest over stiffest: {} at 70 mm, {} at 160 mm; the ratio stays near that of the moduli",
            fixed(first, 2),
            fixed(last, 2)
        ),
    )
}

fn ends(values: &[f64]) -> (f64, f64) {
    (values.first().copied().unwrap_or(f64::NAN), values.last().copied().unwrap_or(f64::NAN))
}

/// Stiffness per weight of the largest section, minus the stiffness per weight of the smallest section.
fn rise(points: &[BeamPoint]) -> f64 {
    let values: Vec<f64> = points.iter().map(BeamPoint::stiffness_per_weight).collect();
    let (first, last) = ends(&values);
    last - first
}

fn gains_more(curves: &[Curve]) -> Claim {
    let rises: Vec<f64> = curves.iter().map(|c| rise(&c.points)).collect();
    let words: Vec<String> =
        curves.iter().zip(&rises).map(|(c, r)| format!("{} +{}", c.name, significant(*r, 3))).collect();
    let (steel, lightest) = ends(&rises);
    Claim::new(
        "light_gains_more",
        "The lighter metal's stiffness per weight rises more with size than steel's (the paper: much more)",
        lightest > steel,
        format!(
            "F/\u{3b4} over q from 70 to 160 mm: {}; aluminium's rise is {} times steel's",
            words.join(", "),
            fixed(lightest / steel, 2)
        ),
    )
}

fn best_metal(curves: &[Curve]) -> Claim {
    let best = |i: usize| {
        curves
            .iter()
            .max_by(|a, b| a.points[i].stiffness_per_weight().total_cmp(&b.points[i].stiffness_per_weight()))
            .map_or("-", |c| c.name)
    };
    let count = curves.first().map_or(0, |c| c.points.len());
    let wins = (0..count).filter(|i| best(*i) == "aluminium").count();
    Claim::new(
        "aluminium_best",
        "Aluminium has the best stiffness per weight of the three",
        wins == count,
        format!("largest F/\u{3b4} over q at {wins} of {count} sizes"),
    )
}

/// A table of every steel, titanium and aluminium of the catalog that the paper may mean.
fn alloys(catalogs: &Catalogs) -> Result<Table, PaperError> {
    let mut table = Table::new(vec![
        Column::left("material"),
        Column::unit("E", "Pa"),
        Column::unit("density", "kg/m3"),
        Column::unit("deflection at 70 to 160 mm", "mm"),
        Column::left("in the figure"),
    ]);
    for name in METALS.iter().map(|(_, row)| *row).chain(OTHERS) {
        let material: &Material = parts::material(catalogs, name)?;
        let drawn = METALS.iter().any(|(_, row)| *row == name);
        table.row([
            name.to_string(),
            significant(material.youngs_modulus_pa, 4),
            shortest(material.density_kg_m3),
            range(&sizes(material)),
            if drawn { "yes" } else { "no" }.to_string(),
        ]);
    }
    Ok(table)
}
