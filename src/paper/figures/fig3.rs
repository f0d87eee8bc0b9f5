//! `fig3-wall-or-width`: whether weight is better spent on wall thickness or on outer dimensions.

use super::beam::{BeamPoint, WALL_M, sizes};
use super::figure::Figure;
use crate::catalog::Catalogs;
use crate::catalog::material::Material;
use crate::paper::claim::Claim;
use crate::paper::output::{PaperError, PaperStudyOutput};
use crate::paper::parts;
use crate::report::number::{fixed, percent_change};
use crate::report::svg::plot::{Axis, Plot, Series};
use crate::report::svg::scale::Scale;
use crate::report::table::{Column, Table};

/// Material of the figure.
pub const MATERIAL: &str = "Aluminium 6082-T6";
/// Outer sizes for which the wall is thickened step by step \[m\].
const THICKENED_M: [f64; 3] = [0.07, 0.10, 0.13];
/// Largest weight per length of the thickened sections, divided by the weight per length of the section with the
/// largest outer size.
const WEIGHT_SHOWN: f64 = 1.1;

/// A section that is made heavier by the same factor in two ways: with larger outer dimensions, and with a thicker
/// wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Growth {
    /// The section before it is made heavier.
    pub from: BeamPoint,
    /// Weight after the change, divided by the weight before.
    pub weight_ratio: f64,
    /// Stiffness after the change, divided by the stiffness before, if the outer dimensions grow.
    pub by_width: f64,
    /// Stiffness after the change, divided by the stiffness before, if the wall grows inward. `None` if the hollow
    /// is too small for this.
    pub by_wall: Option<f64>,
}

/// Every base section of the figure, made heavier by 10 % and by 50 %.
///
/// # Errors
/// The catalog lacks the material.
pub fn growths(catalogs: &Catalogs) -> Result<Vec<Growth>, PaperError> {
    let material = parts::material(catalogs, MATERIAL)?;
    let ratios = [1.1, 1.5];
    Ok(sizes(material).iter().flat_map(|from| ratios.map(|ratio| growth(material, from, ratio))).collect())
}

/// Makes the section `from` heavier by the factor `weight_ratio` in two ways. The area of a square tube with outer size
/// b and wall t is 4 t (b - t). This is solved for b with t unchanged, and for t with b unchanged.
fn growth(material: &Material, from: &BeamPoint, weight_ratio: f64) -> Growth {
    let (b, t) = (from.size_m, from.wall_m);
    let area_m2 = weight_ratio * 4.0 * t * (b - t);
    let wider = BeamPoint::new(material, area_m2 / (4.0 * t) + t, t);
    let room = b * b - area_m2;
    let thicker = (room > 0.0).then(|| BeamPoint::new(material, b, (b - room.sqrt()) / 2.0));
    let gain = |point: &BeamPoint| point.stiffness_n_per_m() / from.stiffness_n_per_m();
    Growth { from: from.clone(), weight_ratio, by_width: gain(&wider), by_wall: thicker.as_ref().map(gain) }
}

/// The claim of the paper about the figure, checked.
pub fn claims(growths: &[Growth]) -> Vec<Claim> {
    let pairs: Vec<(f64, f64)> =
        growths.iter().filter_map(|g| Some((g.by_width - 1.0, g.by_wall? - 1.0))).collect();
    let advantage = pairs.iter().map(|(width, wall)| width / wall);
    let (least, most) =
        advantage.clone().fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(r), high.max(r)));
    vec![Claim::new(
        "width_beats_wall",
        "Outer dimensions buy more stiffness per weight than wall thickness",
        !pairs.is_empty() && advantage.clone().all(|r| r > 1.0),
        format!(
            "the same weight put into outer size gains {} to {} times the stiffness it gains in the wall, for every \
             section from 70 to 160 mm with 10 mm wall ({} cases)",
            fixed(least, 1),
            fixed(most, 1),
            pairs.len()
        ),
    )]
}

/// Computes Fig 3 of the paper (whether wall thickness or outer size is the better use of weight) with its table and
/// claims.
///
/// # Errors
/// The material of the figure is not in the catalog.
pub fn run(catalogs: &Catalogs) -> Result<PaperStudyOutput, PaperError> {
    let material = parts::material(catalogs, MATERIAL)?;
    let growths = growths(catalogs)?;
    let (series, points) = curves(material);
    let figure = Figure {
        name: "fig3-wall-or-width",
        title: "Fig 3: a kilogram in the wall or in the width",
        plot: plot(series),
        points,
        claims: claims(&growths),
        tables: vec![("The same weight spent in two ways", "growth", growth_table(&growths))],
        words: "The limit of a wide thin tube is local buckling of its walls, which this comparison does not see; \
                the studies that choose sections bound the walls' slenderness."
            .into(),
    };
    Ok(figure.output())
}

fn curves(material: &Material) -> (Vec<Series>, Vec<BeamPoint>) {
    let widening = sizes(material);
    let most = widening.last().map_or(0.0, |p| p.weight_n_per_m) * WEIGHT_SHOWN;
    let mut series =
        vec![Series::line("outer size 70 to 160 mm, wall 10 mm", 0, widening.iter().map(place).collect())];
    let mut points = widening;
    for (i, size_m) in THICKENED_M.into_iter().enumerate() {
        let walls = thickening(material, size_m, most);
        let first = walls.first().map_or(0.0, |p| p.wall_m);
        let last = walls.last().map_or(0.0, |p| p.wall_m);
        let name = format!(
            "outer size {} mm, wall {} to {} mm",
            fixed(1e3 * size_m, 0),
            fixed(1e3 * first, 0),
            fixed(1e3 * last, 0)
        );
        series.push(Series::variant(&name, i + 1, walls.iter().map(place).collect()));
        points.extend(walls);
    }
    (series, points)
}

/// Sections of one outer size, with walls from 4 mm in steps of 2 mm. The hollow is at least a fifth of the size
/// wide, and the weight per length is at most `most_n_per_m`.
fn thickening(material: &Material, size_m: f64, most_n_per_m: f64) -> Vec<BeamPoint> {
    (2..)
        .map(|i| f64::from(i) * WALL_M / 5.0)
        .take_while(|wall_m| 2.0 * wall_m < 0.8 * size_m)
        .map(|wall_m| BeamPoint::new(material, size_m, wall_m))
        .take_while(|point| point.weight_n_per_m <= most_n_per_m)
        .collect()
}

fn place(point: &BeamPoint) -> (f64, f64) {
    (point.weight_n_per_m, 1e-6 * point.stiffness_n_per_m())
}

fn plot(series: Vec<Series>) -> Plot {
    Plot {
        title: "Stiffness against weight: wider or thicker aluminium tubes".into(),
        description: "Force over deflection of a 0.8 m aluminium cantilever against its weight per length. Widening \
                      at constant wall climbs steeply; thickening the wall at constant width climbs slowly and \
                      levels off."
            .into(),
        x: Axis::new("weight per length q [N/m]", Scale::Linear),
        y: Axis::new("stiffness F/\u{3b4} [N/\u{b5}m]", Scale::Linear),
        series,
        ..Plot::default()
    }
}

fn growth_table(growths: &[Growth]) -> Table {
    let mut table = Table::new(vec![
        Column::unit("from outer size", "mm"),
        Column::right("weight"),
        Column::right("stiffness by width"),
        Column::right("stiffness by wall"),
    ]);
    for growth in growths {
        table.row([
            fixed(1e3 * growth.from.size_m, 0),
            percent_change(growth.weight_ratio, 0),
            percent_change(growth.by_width, 1),
            growth.by_wall.map_or_else(|| "no room".to_string(), |w| percent_change(w, 1)),
        ]);
    }
    table
}
