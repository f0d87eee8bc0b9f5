//! The page of a study: the question and its answer, the front in linked views, the picks in detail, the materials,
//! the run, and the sources of all numbers.

use super::front_data::{FrontData, Group, MOST_BYTES, Row};
use super::front_views::FrontViews;
use super::gallery::{Gallery, Page, table};
use super::pick::{PickedArm, deflection_bars};
use super::render::anchor;
use crate::report::number::large;
use crate::report::picks::{self, materials};
use crate::report::resonance::warnings;
use crate::report::section::{Figure, PageSection};
use crate::report::summary::{
    SummaryInput, answer_words, empty_fronts, materials_side_by_side, single_materials,
};
use crate::report::svg::draw::MUTED;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashSet};

/// Largest size of a page \[bytes\].
const MOST_PAGE_BYTES: usize = 2_000_000;

/// A catalog row from which numbers on the page come.
#[derive(Debug, Clone, PartialEq)]
pub struct CatalogRow {
    /// Kind of the part: `gear`, `motor`, `material` or `profile`.
    pub kind: &'static str,
    /// Name of the part.
    pub name: String,
    /// File and line of the row.
    pub place: String,
    /// Document from which the ratings come.
    pub source: String,
    /// Confidence of the row, in a word.
    pub confidence: String,
    /// Columns of the row whose values were not read from a document.
    pub unverified: Vec<String>,
    /// The row as it is in the file: column names and cells.
    pub cells: Vec<(String, String)>,
}

/// All contents of a study's page.
pub struct StudyPage<'a> {
    /// Question, answer, fronts and counts.
    pub summary: &'a SummaryInput,
    /// The picks, each with its arm.
    pub picks: Vec<PickedArm>,
    /// The fronts as a static picture (`front.svg`).
    pub scatter_svg: String,
    /// Deflection over weight for the study's materials, as in the paper's Figs 2 to 4; `None` if there is no such
    /// picture.
    pub beams: Option<Figure>,
    /// Catalog rows of the parts in the picks.
    pub parts: Vec<CatalogRow>,
    /// Facts of the run: pairs of name and value.
    pub run: Vec<(String, String)>,
    /// Facts that differ between runs of the same study: time, threads, machine.
    pub timing: Vec<(String, String)>,
    /// Further sections, such as the stiffness budget, the front under scatter, or the certificate.
    pub extras: Vec<PageSection>,
}

impl StudyPage<'_> {
    /// The page as HTML, with its pictures. If the page would be too large, fewer designs of the front are drawn.
    pub fn page(&self) -> Page {
        let page = self.page_with(MOST_BYTES);
        match page.html.len().saturating_sub(MOST_PAGE_BYTES) {
            0 => page,
            excess => self.page_with(MOST_BYTES.saturating_sub(excess)),
        }
    }

    fn page_with(&self, front_bytes: usize) -> Page {
        let mut gallery = Gallery::default();
        let facts = &self.summary.facts;
        let designs = picks::designs(&self.summary.overall);
        let chosen = picks::picks(&designs);
        let views = self.views(&chosen, front_bytes);
        let data = views.json();
        let extras: Vec<Value> = self.extras.iter().map(|e| gallery.extra(e)).collect();
        let caveat = |part: &CatalogRow| Some((part.name.clone(), facts.caveats.of_part(&part.name)?));
        let caveats: BTreeMap<String, &str> = self.parts.iter().filter_map(caveat).collect();
        let content = json!({
            "study": facts.study,
            "question": facts.question,
            "answer": answer_words(self.summary),
            "whole": facts.is_whole(),
            "facts": self.facts(designs.len()),
            "front": views.context(&mut gallery),
            "bars": (!self.picks.is_empty()).then(|| gallery.show(&deflection_bars(&self.picks))),
            "picks": self.picks.iter().map(|p| p.context(&mut gallery)).collect::<Vec<_>>(),
            "own_fronts": !self.summary.materials.is_empty(),
            "materials": table(&materials_side_by_side(self.summary)),
            "empty_fronts": empty_fronts(self.summary),
            "beams": self.beams.as_ref().map(|f| gallery.show(f)),
            "extras": extras,
            "run": self.run,
            "timing": self.timing,
            "not_checked": facts.not_checked,
            "remarks": facts.remarks,
            "warnings": warnings(&self.summary.overall, &chosen),
            "parts": self.parts.iter().map(part).collect::<Vec<_>>(),
            "caveats": caveats,
            "results": facts.results,
        });
        gallery.page("study.html", &facts.study, content, &json!({"front": data}))
    }

    /// Facts about the study in short: names and values.
    fn facts(&self, front: usize) -> Vec<(&'static str, String)> {
        let facts = &self.summary.facts;
        let listed = |words: &[String]| if words.is_empty() { "none".into() } else { words.join("; ") };
        vec![
            ("designs searched", large(facts.designs_total)),
            ("on the front", large(front as u128)),
            ("limits", listed(&facts.constraints)),
            ("poses (the worst counts)", listed(&facts.cases)),
            ("ranges of the joints", listed(&facts.ranges)),
        ]
    }

    /// The fronts as linked views: the front of all designs, and the designs that are only on the front of their
    /// material.
    fn views<'v>(&'v self, chosen: &'v [picks::Pick], front_bytes: usize) -> FrontViews<'v> {
        let summary = self.summary;
        let names = single_materials(summary);
        let mut groups: Vec<Group> =
            names.iter().enumerate().map(|(style, m)| Group { name: m.to_string(), style }).collect();
        let mixed = groups.len();
        groups.push(Group { name: "mixed".into(), style: MUTED });
        let group_of = |row: usize| match materials(&summary.overall, row).as_slice() {
            [one] => names.iter().position(|m| m == one).unwrap_or(mixed),
            _ => mixed,
        };
        let mut rows: Vec<Row> = (0..summary.overall.rows.len())
            .map(|row| Row { table: &summary.overall, row, group: group_of(row), on_front: true })
            .collect();
        let id = |r: &Row<'v>| r.table.column("design_id").map_or("", |c| r.table.rows[r.row][c].as_str());
        let listed: HashSet<&str> = rows.iter().map(id).collect();
        for (group, material) in summary.materials.iter().enumerate() {
            let own = (0..material.front.rows.len()).map(|row| Row {
                table: &material.front,
                row,
                group,
                on_front: false,
            });
            rows.extend(own.filter(|r| !listed.contains(id(r))));
        }
        if rows.iter().all(|r| r.group != mixed) {
            groups.pop();
        }
        let kept: Vec<String> = chosen.iter().map(|p| p.design.design_id.clone()).collect();
        let has_both = rows.iter().any(|r| !r.on_front);
        FrontViews {
            data: FrontData::new(groups, rows, &kept, front_bytes),
            picks: chosen,
            scatter: Figure {
                name: "front".into(),
                caption: "Tip deflection and lowest mode over mass. Every dot is a design. A line joins the best designs \
                          of a material at each mass. The picks have rings."
                    .into(),
                svg: self.scatter_svg.clone(),
                csv: String::new(),
            },
            coloured_by: "material",
            has_both,
            all_in: if has_both { "front.csv and front.<material>.csv" } else { "front.csv" },
        }
    }
}

fn part(row: &CatalogRow) -> Value {
    json!({
        "anchor": anchor(&row.name),
        "kind": row.kind,
        "name": row.name,
        "place": row.place,
        "source": row.source,
        "confidence": row.confidence,
        "unverified": row.unverified,
        "cells": row.cells.iter().filter(|(_, cell)| !cell.is_empty()).collect::<Vec<_>>(),
    })
}
