//! The HTML page of a study: picks with their arms, the catalog rows of their parts, and a comparison of the
//! materials as beams.

use super::definition::Study;
use crate::arm::pieces::without_factors;
use crate::arm::{Element, LinkBody};
use crate::catalog::{Catalogs, Provenance};
use crate::paper::figures::beam::{BeamPoint, points_csv, sizes};
use crate::paper::figures::figure::deflection_plot;
use crate::report::budget::budget_extra;
use crate::report::html::pick::PickedArm;
use crate::report::html::study::{CatalogRow, StudyPage};
use crate::report::picks;
use crate::report::section::Figure;
use crate::report::summary::SummaryInput;
use crate::report::svg::plot::Series;
use crate::space::problem::ArmProblem;

/// The content of the page of a finished study, except for the facts of the run.
pub fn study_page<'a>(
    study: &Study,
    problem: &ArmProblem,
    catalogs: &Catalogs,
    summary: &'a SummaryInput,
) -> StudyPage<'a> {
    let designs = picks::designs(&summary.overall);
    let chosen = picks::picks(&designs);
    let picks: Vec<PickedArm> =
        chosen.into_iter().filter_map(|pick| picked(study, problem, catalogs, summary, pick)).collect();
    StudyPage {
        summary,
        parts: parts(catalogs, &picks),
        picks,
        scatter_svg: String::new(),
        beams: beams(study, catalogs),
        run: Vec::new(),
        timing: Vec::new(),
        extras: budget_extra(&summary.budgets).into_iter().collect(),
    }
}

/// The part of the page about a pick: its arm, its cases and the sizing of its drives. `None` if the pick is no design
/// of the problem.
fn picked(
    study: &Study,
    problem: &ArmProblem,
    catalogs: &Catalogs,
    summary: &SummaryInput,
    pick: picks::Pick,
) -> Option<PickedArm> {
    let chosen = problem.options_of_id(&pick.design.design_id)?;
    let mut arm = problem.arm(&chosen)?;
    arm.name = format!("{} {}", study.name, pick.design.design_id);
    let row = &summary.overall.rows[pick.design.row];
    Some(PickedArm {
        arm,
        cases: problem.load_cases(),
        drives: super::table::sizing_rows(problem, catalogs, &chosen).ok()?,
        row: summary.overall.columns.iter().cloned().zip(row.iter().cloned()).collect(),
        pick,
    })
}

/// The catalog rows of every part that a pick has, each row once.
fn parts(catalogs: &Catalogs, picks: &[PickedArm]) -> Vec<CatalogRow> {
    let mut out: Vec<CatalogRow> = Vec::new();
    let mut add = |kind: &'static str, name: &str, provenance: &Provenance| {
        if out.iter().all(|r| r.kind != kind || r.name != name) {
            out.push(catalog_row(catalogs, kind, name, provenance));
        }
    };
    for pick in picks {
        for element in &pick.arm.chain {
            match element {
                Element::Joint(joint) => {
                    if let Some(gear) = joint.gear.as_ref().and_then(|g| catalogs.gear(g).ok()) {
                        add("gear", &gear.id, &gear.provenance);
                    }
                    if let Some(motor) = joint.motor.as_ref().and_then(|m| catalogs.motor(m).ok()) {
                        add("motor", &motor.id, &motor.provenance);
                    }
                }
                Element::Prismatic(slide) => {
                    if let Some(gear) = slide.gear.as_ref().and_then(|part| catalogs.gear(&part.name).ok()) {
                        add("gear", &gear.id, &gear.provenance);
                    }
                    if let Some(motor) = slide.motor.as_ref().and_then(|part| catalogs.motor(&part.name).ok())
                    {
                        add("motor", &motor.id, &motor.provenance);
                    }
                }
                Element::Link(link) => {
                    if let LinkBody::Tube { material_name, .. } = &link.body
                        && let Ok(material) = catalogs.material(without_factors(material_name))
                    {
                        add("material", &material.name, &material.provenance);
                    }
                }
            }
        }
        for profile in profiles(pick).filter_map(|name| catalogs.profile(name).ok()) {
            add("profile", &profile.designation, &profile.provenance);
        }
    }
    out.sort_by(|a, b| (a.kind, &a.name).cmp(&(b.kind, &b.name)));
    out
}

/// Designations of the catalog profiles that a pick has.
fn profiles(pick: &PickedArm) -> impl Iterator<Item = &str> {
    pick.row
        .iter()
        .filter(|(c, cell)| c.ends_with("_profile") && !cell.is_empty())
        .map(|(_, cell)| cell.as_str())
}

fn catalog_row(catalogs: &Catalogs, kind: &'static str, name: &str, provenance: &Provenance) -> CatalogRow {
    let cells = catalogs.printed_row(provenance);
    CatalogRow {
        kind,
        name: name.to_string(),
        place: format!("{} line {}", provenance.file, provenance.line),
        source: provenance.source.clone(),
        confidence: provenance.confidence.to_string(),
        unverified: provenance.unverified_fields.clone(),
        cells: cells.iter().map(|(column, cell)| ((*column).to_string(), cell.clone())).collect(),
    }
}

/// A figure that compares the study's materials in the way of the paper's Figs 2 to 4, by square tubes of growing
/// size. `None` if the study has fewer than two materials.
fn beams(study: &Study, catalogs: &Catalogs) -> Option<Figure> {
    let names = study.space.material_names();
    let materials = names.iter().filter_map(|name| catalogs.materials.iter().find(|m| m.name == *name));
    let curves: Vec<Vec<BeamPoint>> = materials.map(sizes).collect();
    if curves.len() < 2 {
        return None;
    }
    let series = |(style, curve): (usize, &Vec<BeamPoint>)| {
        let name = curve.first().map_or("", |p| p.material.as_str());
        Series::line(name, style, curve.iter().map(BeamPoint::in_figure).collect())
    };
    let caption = "The materials alone, as in Figs 2 to 4 of the paper: deflection (4) of a clamped square tube, 0.8 m long, \
                   wall 10 mm, 70 to 160 mm wide, under 500 N, against its weight per length (6). Down and left is better.";
    let mut plot = deflection_plot("Deflection against weight of the materials", caption);
    plot.series = curves.iter().enumerate().map(series).collect();
    let points: Vec<BeamPoint> = curves.into_iter().flatten().collect();
    Some(Figure {
        name: "materials".into(),
        caption: caption.into(),
        svg: plot.to_svg(),
        csv: points_csv(&points),
    })
}
