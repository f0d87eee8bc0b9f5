//! The page of a comparison: results side by side, their fronts in one picture, and the changes between them.

use super::front_data::{FrontData, Group, MOST_BYTES, Row};
use super::front_views::FrontViews;
use super::gallery::{Gallery, Page, table};
use crate::report::compare::comparison::Comparison;
use crate::report::compare::contender::Contender;
use crate::report::compare::question::Question;
use crate::report::picks;
use crate::report::section::Figure;
use crate::report::svg::draw::MUTED;
use serde_json::{Value, json};

/// The page of a comparison. `picture` is the content of `compare.svg`.
pub(crate) fn page(comparison: &Comparison, contenders: &[Contender], picture: String) -> Page {
    let mut gallery = Gallery::default();
    let views = views(contenders, picture);
    let competing: Vec<&str> = contenders.iter().filter(|c| !c.reference).map(|c| c.label.as_str()).collect();
    let question = |question: Question| -> Option<Value> {
        let rows: Vec<_> = comparison.rows.iter().filter(|r| r.question == question).collect();
        (!rows.is_empty()).then(|| {
            let sentences: Vec<&str> = rows.iter().map(|r| r.sentence.as_str()).collect();
            json!({"title": title(question), "table": table(&comparison.table(question)), "sentences": sentences})
        })
    };
    let content = json!({
        "title": format!("{} side by side", competing.join(", ")),
        "front": views.context(&mut gallery),
        "reach": table(&comparison.reach_table()),
        "star": comparison.star_words(),
        "questions": Question::ALL.into_iter().filter_map(question).collect::<Vec<_>>(),
        "remarks": comparison.remarks,
        "moved": comparison.moved.iter().map(|m| m.words.as_str()).collect::<Vec<_>>(),
    });
    let data = json!({"front": views.json()});
    gallery.page("comparison.html", "Fronts side by side", content, &data)
}

fn title(question: Question) -> &'static str {
    match question {
        Question::LightestAtDeflection => "Lightest at a given tip deflection",
        Question::StiffestAtMass => "Stiffest at a given mass",
        Question::HighestModeAtMass => "Highest mode at a given mass",
        Question::LightestAtMode => "Lightest for a given lowest mode",
    }
}

fn views(contenders: &[Contender], picture: String) -> FrontViews<'_> {
    let style = |i: usize| contenders[..i].iter().filter(|c| !c.reference).count();
    let groups = contenders.iter().enumerate().map(|(i, c)| match c.reference {
        true => Group { name: "mixed".into(), style: MUTED },
        false => Group { name: c.label.clone(), style: style(i) },
    });
    let rows = contenders.iter().enumerate().flat_map(|(group, c)| {
        // the front of all materials repeats designs of the competing fronts, so only its mixed designs are drawn
        let shown = |row: &usize| !c.reference || picks::materials(&c.front, *row).len() > 1;
        (0..c.front.rows.len())
            .filter(shown)
            .map(move |row| Row { table: &c.front, row, group, on_front: true })
            .collect::<Vec<_>>()
    });
    FrontViews {
        data: FrontData::new(groups.collect(), rows.collect(), &[], MOST_BYTES),
        picks: &[],
        scatter: Figure {
            name: "fronts".into(),
            caption: "The fronts overlaid: tip deflection and lowest mode over mass. Lines join the best of each front at \
                      each mass."
                .into(),
            svg: picture,
            csv: String::new(),
        },
        coloured_by: "front",
        has_both: false,
        all_in: "each result's front.csv",
    }
}
