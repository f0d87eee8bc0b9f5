//! `fig4-composites`: boron, kevlar and silicon-carbide composites against aluminium.
//!
//! A link that is loaded in torsion needs a quasi-isotropic laminate, whose fibres run in several directions. In a
//! unidirectional laminate all fibres run along the link. Its curve is dashed and marked "axial". Its large modulus
//! along the fibres matters in bending only. The deflection with shear shows the effect of its small shear modulus.

use super::beam::{BeamPoint, WALL_M, sizes};
use super::figure::{Figure, deflection_plot};
use crate::catalog::Catalogs;
use crate::catalog::material::Material;
use crate::paper::claim::Claim;
use crate::paper::output::{PaperError, PaperStudyOutput};
use crate::paper::parts;
use crate::report::number::{fixed, percent_change};
use crate::report::svg::plot::{Guide, Plot, Series};
use crate::report::table::{Column, Table};

/// Deflection at which the materials of the figure are compared \[m\].
pub const REFERENCE_M: f64 = 0.2e-3;

/// One curve of the figure: name in the legend, name in the catalog, style, and whether all fibres run along the
/// link.
struct Row {
    name: &'static str,
    material: &'static str,
    style: usize,
    axial: bool,
}

const ROWS: [Row; 7] = [
    Row { name: "aluminium", material: "Aluminium 6082-T6", style: 0, axial: false },
    Row { name: "boron quasi-isotropic", material: "Boron/epoxy quasi-isotropic", style: 1, axial: false },
    Row { name: "boron UD (axial)", material: "Boron/epoxy UD", style: 1, axial: true },
    Row {
        name: "kevlar quasi-isotropic",
        material: "Kevlar 49/epoxy quasi-isotropic",
        style: 2,
        axial: false,
    },
    Row { name: "kevlar UD (axial)", material: "Kevlar 49/epoxy UD", style: 2, axial: true },
    Row {
        name: "SiC/Al 25 vol%",
        material: "SiC particle/Al 2124 25 vol% wrought PM",
        style: 3,
        axial: false,
    },
    Row { name: "SiC/Al 55 vol%", material: "SiC particle/Al 55 vol% infiltrated", style: 4, axial: false },
];

/// One curve of the figure, for one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the material in the legend.
    pub name: &'static str,
    /// Whether all fibres of the material run along the link.
    pub axial: bool,
    /// Index of the colour and of the marker.
    pub style: usize,
    /// Sections of the curve, smallest first.
    pub points: Vec<BeamPoint>,
    /// The section with [`REFERENCE_M`] deflection in bending (Eq 4); `None` if it cannot be computed.
    pub at_reference: Option<BeamPoint>,
    /// The section with [`REFERENCE_M`] deflection in bending and shear; `None` if the shear modulus is unknown.
    pub at_reference_with_shear: Option<BeamPoint>,
}

/// The curves of the figure, aluminium first.
///
/// # Errors
/// The catalog lacks a material.
pub fn curves(catalogs: &Catalogs) -> Result<Vec<Curve>, PaperError> {
    ROWS.iter()
        .map(|row| {
            let material = parts::material(catalogs, row.material)?;
            Ok(Curve {
                name: row.name,
                axial: row.axial,
                style: row.style,
                points: sizes(material),
                at_reference: section_for(material, |p| Some(p.deflection_m)),
                at_reference_with_shear: section_for(material, |p| p.full_deflection_m),
            })
        })
        .collect()
}

/// The square tube of this material that deflects by [`REFERENCE_M`]; `None` if its deflection is unknown.
/// `deflection_m` returns the deflection of a tube \[m\]. The outer size is found by bisection between 21 mm and 1 m.
fn section_for(material: &Material, deflection_m: impl Fn(&BeamPoint) -> Option<f64>) -> Option<BeamPoint> {
    let (mut small, mut large) = (2.1 * WALL_M, 1.0);
    for _ in 0..60 {
        let middle = (small + large) / 2.0;
        if deflection_m(&BeamPoint::new(material, middle, WALL_M))? > REFERENCE_M {
            small = middle;
        } else {
            large = middle;
        }
    }
    Some(BeamPoint::new(material, large, WALL_M))
}

/// The claims of the paper about the figure, checked.
pub fn claims(curves: &[Curve]) -> Vec<Claim> {
    let Some((aluminium, composites)) = curves.split_first() else { return Vec::new() };
    vec![
        lighter("lighter_at_reference", "in bending (Eq 4)", aluminium, composites, |c| {
            c.at_reference.as_ref()
        }),
        lighter("lighter_with_shear", "with shear counted", aluminium, composites, |c| {
            c.at_reference_with_shear.as_ref()
        }),
        dimensions(curves),
        shear_of_axial_rows(curves),
    ]
}

fn lighter(
    id: &'static str,
    how: &str,
    aluminium: &Curve,
    composites: &[Curve],
    section: impl Fn(&Curve) -> Option<&BeamPoint>,
) -> Claim {
    let weight = |curve: &Curve| section(curve).map_or(f64::NAN, |p| p.weight_n_per_m);
    let base = weight(aluminium);
    let words: Vec<String> = composites
        .iter()
        .map(|c| format!("{} {} N/m ({})", c.name, fixed(weight(c), 1), percent_change(weight(c) / base, 0)))
        .collect();
    Claim::new(
        id,
        &format!("Composites reach 0.2 mm with less weight than aluminium, {how}"),
        composites.iter().all(|c| weight(c) < base),
        format!("aluminium {} N/m; {}", fixed(base, 1), words.join(", ")),
    )
}

fn dimensions(curves: &[Curve]) -> Claim {
    let sizes: Vec<f64> =
        curves.iter().filter_map(|c| c.at_reference.as_ref()).map(|p| 1e3 * p.size_m).collect();
    let (low, high) = sizes.iter().fold((f64::INFINITY, 0.0f64), |(l, h), s| (l.min(*s), h.max(*s)));
    Claim::new(
        "sizes_differ",
        "At 0.2 mm the materials need different dimensions and weights",
        high > 1.2 * low,
        format!("outer size from {} to {} mm", fixed(low, 0), fixed(high, 0)),
    )
}

/// Checks whether Eq 4, which leaves out shear, is accurate for unidirectional laminates.
fn shear_of_axial_rows(curves: &[Curve]) -> Claim {
    let share = |c: &Curve| {
        let point = c.at_reference.as_ref()?;
        Some(point.full_deflection_m? / point.deflection_m)
    };
    let axial: Vec<(&str, f64)> =
        curves.iter().filter(|c| c.axial).filter_map(|c| Some((c.name, share(c)?))).collect();
    let words: Vec<String> =
        axial.iter().map(|(name, ratio)| format!("{name} {}", percent_change(*ratio, 0))).collect();
    Claim::new(
        "eq_4_suffices",
        "Eq 4, which has no shear, describes the unidirectional tubes",
        axial.iter().all(|(_, ratio)| *ratio < 1.1),
        format!("deflection with shear against Eq 4 at the 0.2 mm section: {}", words.join(", ")),
    )
}

/// Computes Fig 4 of the paper (deflection against weight of composite tubes) with its table and claims.
///
/// # Errors
/// A material of the figure is not in the catalog.
pub fn run(catalogs: &Catalogs) -> Result<PaperStudyOutput, PaperError> {
    let curves = curves(catalogs)?;
    let figure = Figure {
        name: "fig4-composites",
        title: "Fig 4: composites against the best metal",
        plot: plot(&curves),
        claims: claims(&curves),
        tables: vec![("Sections that deflect by 0.2 mm", "at-reference", reference_table(&curves))],
        points: curves.into_iter().flat_map(|c| c.points).collect(),
        words: "Unidirectional (UD) rows have all fibres along the link: they are shown for bending alone. A link \
                that carries torsion needs a quasi-isotropic or angle-ply laminate."
            .into(),
    };
    Ok(figure.output())
}

fn plot(curves: &[Curve]) -> Plot {
    let series = |curve: &Curve| {
        let points = curve.points.iter().map(BeamPoint::in_figure).collect();
        if curve.axial {
            Series::variant(curve.name, curve.style, points)
        } else {
            Series::line(curve.name, curve.style, points)
        }
    };
    Plot {
        series: curves.iter().map(series).collect(),
        guides: vec![Guide { vertical: false, value: 1e3 * REFERENCE_M, text: "0.2 mm".into() }],
        ..deflection_plot(
            "Deflection against weight: composites, square tubes, wall 10 mm",
            "Deflection of a 0.8 m cantilever under 500 N against its weight per length for boron, kevlar and \
             silicon-carbide composites and aluminium, one marker a centimetre of outer size from 70 to 160 mm. \
             Every composite crosses 0.2 mm at a lower weight than aluminium.",
        )
    }
}

fn reference_table(curves: &[Curve]) -> Table {
    let mut table = Table::new(vec![
        Column::left("material"),
        Column::unit("outer size", "mm"),
        Column::unit("weight", "N/m"),
        Column::unit("outer size with shear", "mm"),
        Column::unit("weight with shear", "N/m"),
    ]);
    let size = |p: &Option<BeamPoint>| p.as_ref().map_or_else(|| "?".into(), |p| fixed(1e3 * p.size_m, 1));
    let weight =
        |p: &Option<BeamPoint>| p.as_ref().map_or_else(|| "?".into(), |p| fixed(p.weight_n_per_m, 1));
    for curve in curves {
        table.row([
            curve.name.to_string(),
            size(&curve.at_reference),
            weight(&curve.at_reference),
            size(&curve.at_reference_with_shear),
            weight(&curve.at_reference_with_shear),
        ]);
    }
    table
}
