//! A picture of fronts: tip deflection and lowest mode over mass, by material.
//!
//! The picture has two panels, one for each of these objectives. With three objectives, a front is a cloud of points on
//! each panel, and the clouds of nine materials hide one another. So every design is a small dot. On top of all dots
//! the edge of each front is drawn. It is a line through the designs that have the best value of the panel's objective
//! for their mass, with the markers of the legend.

use super::front_table::FrontTable;
use super::number::significant;
use super::picks::{Design, Objective, Pick, designs, materials};
use super::svg::draw::{MUTED, PALETTE, WIDTH_PX};
use super::svg::plot::{Axis, Note, Plot, Series, Side, Stroke};
use super::svg::scale::Scale;
use super::svg::sheet::Sheet;
use std::collections::HashSet;

const HEIGHT_PX: f64 = 460.0;
/// An axis whose ends differ by more than this factor is logarithmic. On a linear axis light arms would crowd at
/// the left.
pub(crate) const LOGARITHMIC_ABOVE: f64 = 5.0;
/// Distance, as a fraction of each axis, within which only one design of a front is drawn.
const DRAWN_DISTANCE: f64 = 1.0 / 200.0;
/// Least distance between two markers on the line of best designs of a front, in units of [`DRAWN_DISTANCE`].
const MARKER_STEPS: f64 = 3.0;

/// Entry of the legend that explains what is drawn without a marker of its own in the legend.
const SMALL_DOTS: &str = "small dots: all designs; lines: the best at each mass; rings: picks";

/// A front in the picture.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlottedFront<'a> {
    /// Name in the legend.
    pub name: String,
    /// Designs of the front.
    pub front: &'a FrontTable,
    /// Whether the front is drawn in grey behind the others.
    pub muted: bool,
}

/// A picture with fronts and picks.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrontPicture<'a> {
    /// Title of the picture.
    pub title: String,
    /// The fronts, in the order of the legend.
    pub fronts: Vec<PlottedFront<'a>>,
    /// Designs that are marked with a ring and a name.
    pub picks: Vec<Pick>,
}

/// The designs of a front whose links are of more than one material.
pub(crate) fn mixed_designs(front: &FrontTable) -> FrontTable {
    designs_where(front, |materials| materials.len() > 1)
}

/// The designs of a front whose links are all of one material.
pub(crate) fn designs_of(front: &FrontTable, material: &str) -> FrontTable {
    designs_where(front, |materials| materials == [material])
}

fn designs_where(front: &FrontTable, wanted: impl Fn(&[&str]) -> bool) -> FrontTable {
    let rows = (0..front.rows.len()).filter(|r| wanted(&materials(front, *r)));
    FrontTable { columns: front.columns.clone(), rows: rows.map(|r| front.rows[r].clone()).collect() }
}

/// A front whose designs have been read, ready to be drawn.
struct Drawn<'a> {
    name: &'a str,
    muted: bool,
    designs: Vec<Design>,
}

impl FrontPicture<'_> {
    /// The picture as a self-contained SVG document.
    pub(crate) fn to_svg(&self) -> String {
        let drawn: Vec<Drawn> = self
            .fronts
            .iter()
            .map(|f| Drawn { name: &f.name, muted: f.muted, designs: designs(f.front) })
            .filter(|f| !f.designs.is_empty())
            .collect();
        Sheet {
            title: self.title.clone(),
            description: self.description(&drawn),
            plots: vec![
                self.panel(&drawn, Objective::Deflection, &self.title),
                self.panel(&drawn, Objective::Mode, ""),
            ],
        }
        .to_svg()
    }

    fn panel(&self, drawn: &[Drawn], over: Objective, title: &str) -> Plot {
        let shown: Vec<&Design> = drawn.iter().flat_map(|f| &f.designs).collect();
        let (x, y) = (axis(Objective::Mass, &shown), axis(over, &shown));
        let grain = Grain::new([(Objective::Mass, x.scale), (over, y.scale)], &shown);
        let style = |index: usize| drawn[..index].iter().filter(|f| !f.muted).count();
        let numbered = || drawn.iter().enumerate();
        let clouds = numbered().map(|(i, f)| grain.cloud(f, style(i)));
        let edges = numbered().map(|(i, f)| grain.edge(f, style(i)));
        let mut series: Vec<Series> = clouds.chain(edges).collect();
        // all dots lie behind all edges, and grey dots or edges lie behind coloured ones
        series.sort_by_key(|s| (!s.name.is_empty(), s.style != MUTED));
        if !series.is_empty() {
            series.push(Series { name: SMALL_DOTS.into(), style: MUTED, ..Series::default() });
        }
        let notes = self.picks.iter().map(|p| Note {
            at: (Objective::Mass.of(&p.design), over.of(&p.design)),
            text: p.names.join(", "),
            side: Side::default(),
        });
        Plot {
            title: title.to_string(),
            x,
            y,
            series,
            notes: notes.collect(),
            width_px: WIDTH_PX,
            height_px: HEIGHT_PX,
            ..Plot::default()
        }
    }

    /// A description of the picture in words, for readers who cannot see it.
    fn description(&self, drawn: &[Drawn]) -> String {
        let mut out = String::from(
            "Two panels over the mass of links and drives: tip deflection above, lowest mode below. \
             Every dot is a design; lines join the best designs of a front at each mass.",
        );
        for front in drawn {
            let range = |o: Objective| {
                let values = || front.designs.iter().map(|d| o.of(d));
                let (low, high) =
                    (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
                format!("{} to {} {}", significant(low, 3), significant(high, 3), o.unit())
            };
            let ranges = [Objective::Mass, Objective::Deflection, Objective::Mode].map(range).join(", ");
            out.push_str(&format!(" {}: {} designs, {ranges}.", front.name, front.designs.len()));
        }
        for pick in &self.picks {
            let values = [Objective::Mass, Objective::Deflection, Objective::Mode]
                .map(|o| format!("{} {}", significant(o.of(&pick.design), 4), o.unit()));
            let names = pick.names.join(", ");
            out.push_str(&format!(
                " Picked as {names}: design {}, {}.",
                pick.design.design_id,
                values.join(", ")
            ));
        }
        out
    }
}

/// An axis for an objective: logarithmic if the values span more than the factor [`LOGARITHMIC_ABOVE`].
fn axis(objective: Objective, shown: &[&Design]) -> Axis {
    let values = || shown.iter().map(|d| objective.of(d));
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    let scale = if low > 0.0 && high > LOGARITHMIC_ABOVE * low { Scale::Log } else { Scale::Linear };
    let label = match objective {
        Objective::Deflection => "tip deflection [mm]",
        Objective::Mass => "mass of links and drives [kg]",
        Objective::Mode => "lowest mode [Hz]",
    };
    Axis::new(label, scale)
}

/// The resolution of a panel: designs that are closer than one step on both axes look like one.
struct Grain {
    axes: [(Objective, Scale); 2],
    low: [f64; 2],
    step: [f64; 2],
}

impl Grain {
    fn new(axes: [(Objective, Scale); 2], shown: &[&Design]) -> Self {
        let ends = axes.map(|axis| {
            let values = || shown.iter().map(|d| place(axis, d));
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
        });
        let step = ends.map(|(low, high)| ((high - low) * DRAWN_DISTANCE).max(f64::MIN_POSITIVE));
        Self { axes, low: ends.map(|e| e.0), step }
    }

    /// All designs of a front as small dots without a name in the legend. If several fall on the same place of the
    /// picture, only the first is drawn.
    fn cloud(&self, front: &Drawn, index: usize) -> Series {
        let mut seen = HashSet::new();
        let cell =
            |d: &Design, i: usize| ((place(self.axes[i], d) - self.low[i]) / self.step[i]).round() as i64;
        let apart = front.designs.iter().filter(|d| seen.insert((cell(d, 0), cell(d, 1))));
        let points = apart.map(|d| self.point(d)).collect();
        Series { marker_px: 1.6, ..Series::scatter("", front.style(index), points) }
    }

    /// The edge of a front on this panel: a line with markers through the designs that have the best value of the
    /// panel's objective among all designs of no more mass.
    fn edge(&self, front: &Drawn, index: usize) -> Series {
        let over = self.axes[1].0;
        let mut rising: Vec<&Design> = front.designs.iter().collect();
        rising.sort_by(|a, b| {
            a.mass_kg.total_cmp(&b.mass_kg).then(over.minimized(a).total_cmp(&over.minimized(b)))
        });
        let mut best = f64::INFINITY;
        rising.retain(|d| {
            let better = over.minimized(d) < best;
            best = best.min(over.minimized(d));
            better
        });
        // markers that would touch each other are left out, except at the ends
        let last = rising.len().saturating_sub(1);
        let mut shown: Option<&Design> = None;
        let mut points = Vec::new();
        for (i, d) in rising.into_iter().enumerate() {
            if i == 0 || i == last || shown.is_none_or(|s| self.apart(s, d)) {
                points.push(self.point(d));
                shown = Some(d);
            }
        }
        // if there are more fronts than colours, the colours repeat, and hollow markers tell the fronts apart
        let open = !front.muted && (index / PALETTE.len()) % 2 == 1;
        let marker_px = if front.muted { 2.5 } else { 4.0 };
        let stroke = Stroke::Patterned;
        Series { open, marker_px, stroke, ..Series::line(front.name, front.style(index), points) }
    }

    fn point(&self, design: &Design) -> (f64, f64) {
        (self.axes[0].0.of(design), self.axes[1].0.of(design))
    }

    /// Whether the markers of two designs are far enough apart that they do not touch.
    fn apart(&self, a: &Design, b: &Design) -> bool {
        let steps = |i: usize| (place(self.axes[i], a) - place(self.axes[i], b)) / self.step[i];
        libm::hypot(steps(0), steps(1)) > MARKER_STEPS
    }
}

impl Drawn<'_> {
    fn style(&self, index: usize) -> usize {
        if self.muted { MUTED } else { index }
    }
}

/// Coordinate of a design along the axis of an objective, up to a scale factor and an offset. On a logarithmic axis it
/// is the logarithm of the value.
fn place((objective, scale): (Objective, Scale), design: &Design) -> f64 {
    let value = objective.of(design);
    if scale == Scale::Log { libm::log(value) } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[(&str, &str, f64, f64, f64)]) -> FrontTable {
        let columns =
            ["design_id", "a_material", "b_material", "tip_deflection_mm", "mass_kg", "lowest_mode_hz"];
        let row = |(a, b, d, m, f): &(&str, &str, f64, f64, f64)| {
            ["x", a, b, &d.to_string(), &m.to_string(), &f.to_string()].map(String::from).to_vec()
        };
        FrontTable { columns: columns.map(String::from).to_vec(), rows: rows.iter().map(row).collect() }
    }

    fn picture(front: &FrontTable) -> FrontPicture<'_> {
        FrontPicture {
            title: "t".into(),
            fronts: vec![PlottedFront { name: "steel & co".into(), front, muted: false }],
            picks: super::super::picks::picks(&designs(front)),
        }
    }

    #[test]
    fn axes_are_logarithmic_where_the_data_are_wide() {
        let front = table(&[("s", "s", 1.0, 30.0, 10.0), ("s", "s", 11.0, 20.0, 5.0)]);
        let designs = designs(&front);
        let shown: Vec<&Design> = designs.iter().collect();
        assert_eq!(axis(Objective::Deflection, &shown).scale, Scale::Log);
        assert_eq!(axis(Objective::Mass, &shown).scale, Scale::Linear);
    }

    #[test]
    fn mixed_designs_have_links_of_two_materials() {
        let front = table(&[("s", "t", 1.0, 2.0, 3.0), ("s", "s", 1.0, 2.0, 3.0)]);
        assert_eq!(mixed_designs(&front).rows.len(), 1);
        assert_eq!(designs_of(&front, "s").rows.len(), 1);
        assert_eq!(designs_of(&front, "t").rows.len(), 0);
    }

    #[test]
    fn the_picture_names_its_picks_and_says_itself_in_words() {
        let front = table(&[("s", "s", 1.0, 30.0, 10.0), ("s", "s", 11.0, 20.0, 5.0)]);
        let svg = picture(&front).to_svg();
        assert!(svg.contains(">small dots: all designs;<"), "the dots have an entry in the legend");
        assert!(svg.contains(">lightest") && svg.contains(">stiffest, highest mode"));
        assert!(svg.contains("steel &amp; co: 2 designs, 20.0 to 30.0 kg"));
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn an_empty_front_still_gives_a_picture() {
        let front = table(&[]);
        assert!(picture(&front).to_svg().ends_with("</svg>\n"));
    }
}
