//! The outputs of a figure's study: the picture, its points, the claims and a summary.

use super::beam::{BeamPoint, points_csv};
use crate::paper::claim::{self, Claim};
use crate::paper::output::PaperStudyOutput;
use crate::report::svg::plot::{Axis, Plot};
use crate::report::svg::scale::Scale;
use crate::report::table::Table;

/// A plot with the axes of the paper's figures: weight per length and deflection.
pub(crate) fn deflection_plot(title: &str, description: &str) -> Plot {
    Plot {
        title: title.to_string(),
        description: description.to_string(),
        x: Axis::new("weight per length q (\u{201c}specific gravity\u{201d}) [N/m]", Scale::Linear),
        y: Axis::new("deflection at the end [mm]", Scale::Log),
        ..Plot::default()
    }
}

/// The contents of a figure's study: picture, points, claims and tables.
pub(super) struct Figure {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) plot: Plot,
    pub(super) points: Vec<BeamPoint>,
    pub(super) claims: Vec<Claim>,
    /// Tables of the summary: title, name of the CSV file, and table.
    pub(super) tables: Vec<(&'static str, &'static str, Table)>,
    /// Text at the end of the summary.
    pub(super) words: String,
}

impl Figure {
    pub(super) fn output(self) -> PaperStudyOutput {
        let mut out = PaperStudyOutput { files: Vec::new(), terminal: self.terminal() };
        out.file("summary.md", self.summary());
        out.file(&format!("{}.csv", self.name), points_csv(&self.points));
        out.file(&format!("{}.svg", self.name), self.plot.to_svg());
        out.file("claims.csv", claim::table(&self.claims).to_csv());
        for (_, file, table) in &self.tables {
            out.file(&format!("{file}.csv"), table.to_csv());
        }
        out
    }

    fn terminal(&self) -> String {
        let mut text = format!("{}\n\n", self.title);
        for claim in &self.claims {
            text.push_str(&format!("[{}] {}\n  {}\n", claim.verdict(), claim.statement, claim.evidence));
        }
        for (title, _, table) in &self.tables {
            text.push_str(&format!("\n{title}\n\n{}", table.to_text()));
        }
        text
    }

    fn summary(&self) -> String {
        let mut text = format!(
            "# {}\n\n![{}]({}.svg)\n\nA square tube, clamped at one end: L = 0.8 m, F = 500 N at the end, no end \
             torque, wall 10 mm and b = h = 70 to 160 mm unless said otherwise (the paper prints none of these). \
             Deflection by Eq 4; the CSV has that of the full link model, with shear, beside it.\n\n\
             ## The figure's claims\n\n{}",
            self.title,
            self.plot.title,
            self.name,
            claim::list(&self.claims)
        );
        for (title, _, table) in &self.tables {
            text.push_str(&format!("\n## {title}\n\n{}", table.to_markdown()));
        }
        if !self.words.is_empty() {
            text.push_str(&format!("\n{}\n", self.words));
        }
        text
    }
}
