//! The front in linked views, for the pages of studies and comparisons.

use super::front_data::{Axis, FrontData, Row};
use super::gallery::Gallery;
use crate::report::number::{large, significant};
use crate::report::picks::{Design, Pick};
use crate::report::section::Figure;
use crate::report::svg::parallel::{Parallel, ParallelAxis, ParallelLine};
use serde_json::{Value, json};

/// Approximate largest number of lines in the static picture of parallel coordinates.
const STILL_LINES: usize = 400;

/// The linked views of a page, with the words about them.
pub(crate) struct FrontViews<'a> {
    /// Designs, groups and axes of the views.
    pub data: FrontData<'a>,
    /// The picks.
    pub picks: &'a [Pick],
    /// Static picture of both scatter views.
    pub scatter: Figure,
    /// The property that colours show: `material` or `front`.
    pub coloured_by: &'a str,
    /// Whether some designs are only on the front of their own group.
    pub has_both: bool,
    /// Name of the file with all designs.
    pub all_in: &'a str,
}

impl FrontViews<'_> {
    /// The values for the part of the page's template that shows the linked views. Pictures are added to `gallery`.
    pub(super) fn context(&self, gallery: &mut Gallery) -> Value {
        let data = &self.data;
        json!({
            "scatter": gallery.show(&self.scatter),
            "parallel": gallery.show(&self.parallel()),
            "sampled": self.left_out(),
            "coloured_by": self.coloured_by,
            "has_both": self.has_both,
            "all_in": self.all_in,
            "constants": data.constants,
            "groups": data.groups.iter().map(|g| g.name.clone()).collect::<Vec<_>>(),
        })
    }

    /// A sentence that says how many designs are not drawn because the page would be too large; `None` if all are
    /// drawn.
    fn left_out(&self) -> Option<String> {
        let ([front, own], [all_front, all_own]) = (self.data.rows_drawn(), self.data.rows_total);
        let part = |drawn: usize, all: usize, of: &str| {
            let (drawn, all) = (large(drawn as u128), large(all as u128));
            if drawn == all { format!("all {all} {of}") } else { format!("{drawn} of {all} {of}") }
        };
        let mut parts = vec![part(front, all_front, "designs of the front")];
        if all_own > 0 {
            parts.push(part(
                own,
                all_own,
                &format!("that are only on their own {}\u{2019}s", self.coloured_by),
            ));
        }
        (front + own < all_front + all_own).then(|| {
            format!(
                "To keep the page small it draws {}. The picks and the best designs at each mass are always drawn, the \
                 others at even steps of mass. All are in {}.",
                parts.join(" and "),
                self.all_in
            )
        })
    }

    /// The data of the views as JSON for the page's program.
    pub(crate) fn json(&self) -> Value {
        let mut out = self.data.to_json(&named(self.picks));
        out["colouredBy"] = self.coloured_by.into();
        out
    }

    /// A static picture of parallel coordinates: some hundreds of designs, with the picks drawn on top.
    fn parallel(&self) -> Figure {
        let data = &self.data;
        let step = data.rows.len().div_ceil(STILL_LINES).max(1);
        let line = |i: usize, name: Option<String>| ParallelLine {
            places: data.places(i),
            style: data.groups[data.rows[i].group].style,
            name,
        };
        let mut lines: Vec<ParallelLine> =
            (0..data.rows.len()).step_by(step).map(|i| line(i, None)).collect();
        for pick in self.picks {
            let is_pick = |r: &Row| {
                r.table.column("design_id").is_some_and(|c| r.table.rows[r.row][c] == pick.design.design_id)
            };
            if let Some(i) = data.rows.iter().position(is_pick) {
                lines.push(line(i, Some(pick.names.join(", "))));
            }
        }
        let drawn = lines.iter().filter(|l| l.name.is_none()).count();
        let caption = format!(
            "Every choice that differs among the designs, and its results: one line per design ({drawn} of {} drawn here), \
             coloured by {}; the picks are drawn on top.",
            large((data.rows_total[0] + data.rows_total[1]) as u128),
            self.coloured_by
        );
        let axes = data.axes.iter().map(|a| ParallelAxis { label: named_axis(a), ticks: a.ticks.clone() });
        let picture = Parallel {
            title: "Every choice and its results".into(),
            description: caption.clone(),
            axes: axes.collect(),
            lines,
            legend: data.groups.iter().map(|group| (group.style, group.name.clone())).collect(),
        };
        Figure { name: "parallel".into(), caption, svg: picture.to_svg(), csv: String::new() }
    }
}

fn named_axis(axis: &Axis) -> String {
    if axis.unit.is_empty() { axis.label.clone() } else { format!("{} [{}]", axis.label, axis.unit) }
}

/// Pairs of a pick's names and its `design_id`.
fn named(picks: &[Pick]) -> Vec<(String, String)> {
    picks.iter().map(|p| (p.names.join(", "), p.design.design_id.clone())).collect()
}

/// The objectives of a design in the form in which the page and the terminal print them: name, value with four
/// significant digits, unit.
pub(crate) fn headline(design: &Design) -> [(&'static str, String, &'static str); 3] {
    [
        ("tip deflection", significant(design.tip_deflection_mm, 4), "mm"),
        ("mass", significant(design.mass_kg, 4), "kg"),
        ("lowest mode", significant(design.lowest_mode_hz, 4), "Hz"),
    ]
}
