//! `paper-table1`: the paper's numbers next to the numbers of this program.

use super::arm::PaperArm;
use super::output::{PaperError, PaperStudyOutput};
use super::remedies::{
    CatalogGears, connection_table, connections, error_left, error_left_table, stiffer, stiffer_table,
};
use super::rows::{self, PaperRow};
use super::third_spring::{self, Reading, closest_reading, readings};
use super::{modes_rows, parts, statics_rows, torque_rows};
use crate::arm::{JointModel, LinkModel};
use crate::catalog::Catalogs;
use crate::mechanics::response::frequency_response;
use crate::report::number::{fixed, shortest};
use crate::report::svg::plot::{Axis, Guide, Plot, Series, Stroke};
use crate::report::svg::scale::Scale;
use crate::report::table::{Column, Table};
use nalgebra::Vector3;

/// Damping ratio of every mode in the frequency response.
pub const DAMPING_RATIO: f64 = 0.02;

/// All results of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct Table1 {
    /// Rows with the paper's numbers next to the numbers of this program.
    pub rows: Vec<PaperRow>,
    /// Further tables with titles, such as the errors that remain with the remedies of the paper's conclusions.
    pub sections: Vec<Section>,
}

/// One further table of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Name of the table's CSV file, without the ending.
    pub file: &'static str,
    /// Title of the table.
    pub title: &'static str,
    /// Explanation of the table.
    pub words: String,
    /// Numbers of the table.
    pub table: Table,
}

/// Computes all results of the study.
///
/// # Errors
/// The catalogs lack a part that the paper names.
pub fn compute(catalogs: &Catalogs) -> Result<Table1, PaperError> {
    let gears = CatalogGears::new(catalogs)?;
    let rows =
        [statics_rows::rows(&gears), modes_rows::rows(&closest_reading()), torque_rows::rows(catalogs)?];
    Ok(Table1 { rows: rows.concat(), sections: sections(catalogs, &gears)? })
}

fn sections(catalogs: &Catalogs, gears: &CatalogGears) -> Result<Vec<Section>, PaperError> {
    let arm = PaperArm::table_1();
    let mut springs = readings();
    springs.push(closest_reading());
    Ok(vec![
        Section {
            file: "third-spring",
            title: "Arms that have the paper's three frequencies",
            words: third_spring_words(&springs),
            table: third_spring::table(&springs),
        },
        Section {
            file: "error-left",
            title: "What is left of the tip error",
            words: "Measuring each joint at its output leaves the links' part. Computing the joints' part from motor \
                    torque leaves the links' part and as much of the joints' as the gear's curve is unknown; \
                    with K2 alone for gears that follow the curve, much of the error stays.".into(),
            table: error_left_table(&error_left(gears)),
        },
        Section {
            file: "stiffer",
            title: "Stiffer drives first",
            words: "Twice the stiffness of one element, masses unchanged, full links, Table 1's joint stiffnesses.".into(),
            table: stiffer_table(&stiffer(&arm)),
        },
        Section {
            file: "connections",
            title: "Connections in series with the gears",
            words: "Of Rivin's four sources, structure is the links, contacts are the connections here, energy \
                    transformation the gears, and kinematic transformation is what makes the first two columns \
                    equal: a connection between motor and gear is seen through the square of the ratio (100:1), \
                    one between gear and arm as it is.".into(),
            table: connection_table(&connections(&arm)),
        },
        Section {
            file: "gears",
            title: "Table 1 against the catalog",
            words: "The paper's stiffnesses are the middle slopes K2; its masses are bare component sets, but for \
                    HFUC 20, which is a housed unit.".into(),
            table: parts::gear_table(catalogs)?,
        },
    ])
}

fn third_spring_words(springs: &[Reading]) -> String {
    let table_kg = PaperArm::table_1().wrist_kg + PaperArm::table_1().load_kg;
    let missing = springs.iter().map(|s| s.outboard_kg() - table_kg);
    let (least, most) = missing.fold((f64::INFINITY, 0.0f64), |(low, high), m| (low.min(m), high.max(m)));
    format!(
        "Wrist mass, load and its distance were searched for each reading of the third spring until all three \
         frequencies are the paper's. Different springs with different masses give the same three: three frequencies \
         cannot identify the third spring. All of them want {} to {} kg more at and beyond the wrist than the {} kg \
         of Table 1. The last row keeps the table's wrist and rounds the load.",
        fixed(least, 1),
        fixed(most, 1),
        fixed(table_kg, 2)
    )
}

/// Computes the numbers of the paper's Table 1 and writes them next to the paper's own numbers, as a summary and as
/// tables.
///
/// # Errors
/// The catalogs lack a part that the paper names.
pub fn run(catalogs: &Catalogs) -> Result<PaperStudyOutput, PaperError> {
    let study = compute(catalogs)?;
    let mut out = PaperStudyOutput { files: Vec::new(), terminal: terminal(&study) };
    out.file("summary.md", summary(&study));
    out.file("paper-table1.csv", rows::csv(&study.rows));
    let json =
        serde_json::json!({"schema_version": 1, "study": "paper-table1", "rows": rows::json(&study.rows)});
    out.file("paper-table1.json", format!("{json:#}\n"));
    for section in &study.sections {
        out.file(&format!("{}.csv", section.file), section.table.to_csv());
    }
    let (rigid, full) = (response(LinkModel::Rigid), response(LinkModel::Full));
    out.file("frequency-response.csv", response_csv(&rigid, &full));
    out.file("frequency-response.svg", response_plot(rigid, full).to_svg());
    Ok(out)
}

fn terminal(study: &Table1) -> String {
    let mut text = format!("The paper's numbers beside ours\n\n{}\n", rows::table(&study.rows).to_text());
    text.push_str(&rows::notes(&study.rows));
    for section in &study.sections {
        text.push_str(&format!("\n{}\n\n{}", section.title, section.table.to_text()));
    }
    text
}

fn summary(study: &Table1) -> String {
    let mut text = format!(
        "# The paper's Table 1\n\nEach of the paper's numbers beside ours. *Paper's reading*: our value under the \
         reading of the paper that gives its number. *Exact*: the frame without the paper's \
         simplifications (links with bending, shear and end slopes, everything at the load), or the equation with its \
         sides set right. A dash: not printed, or no such value.\n\n{}\n\
         Reading and reason, by row:\n\n{}",
        rows::table(&study.rows).to_markdown(),
        rows::notes(&study.rows)
    );
    for section in &study.sections {
        let (title, words, table) = (section.title, &section.words, section.table.to_markdown());
        text.push_str(&format!("\n## {title}\n\n{words}\n\n{table}"));
    }
    text.push_str(
        "\n## The response to F(t)\n\n`frequency-response.csv` and `frequency-response.svg`: amplitude at the load \
         under a vertical harmonic force of 1 N there (the right side of Eq 16), 2 % damping in every mode.\n",
    );
    text
}

/// Frequency response of the load to a vertical harmonic force of 1 N at the load, for the arm of Table 1: pairs of
/// frequency \[Hz\] and vertical amplitude \[µm\]. `links` is the link model.
fn response(links: LinkModel) -> Vec<(f64, f64)> {
    let arm = PaperArm::table_1();
    let frequencies_hz: Vec<f64> = (0..=600).map(|i| libm::pow(10f64, f64::from(i) / 200.0)).collect();
    arm.with_posed(&arm.arm().structure(JointModel::K2), links, |posed| {
        frequency_response(posed, &posed.statics(), &Vector3::z(), DAMPING_RATIO, &frequencies_hz)
            .iter()
            .map(|r| (r.frequency_hz, 1e6 * r.amplitude_m().z))
            .collect()
    })
}

fn response_csv(rigid: &[(f64, f64)], full: &[(f64, f64)]) -> String {
    let mut table = Table::new(
        ["frequency_hz", "rigid_links_um_per_n", "full_links_um_per_n"].map(Column::right).to_vec(),
    );
    for ((frequency, rigid), (_, full)) in rigid.iter().zip(full) {
        table.row([*frequency, *rigid, *full].map(shortest));
    }
    table.to_csv()
}

fn response_plot(rigid: Vec<(f64, f64)>, full: Vec<(f64, f64)>) -> Plot {
    let lowest = PaperArm::table_1().solve(LinkModel::Full).lowest_hz();
    let unmarked =
        |name, style, points, stroke| Series { stroke, marker_px: 0.0, ..Series::line(name, style, points) };
    Plot {
        title: "The paper's arm under a harmonic force at the load".into(),
        description: format!(
            "Amplitude at the load per newton against frequency, 2 % damping. The first peak is at {} Hz; the servo's \
             bandwidth must lie below it.",
            fixed(lowest, 2)
        ),
        x: Axis::new("frequency [Hz]", Scale::Log),
        y: Axis::new("amplitude at the load [\u{b5}m/N]", Scale::Log),
        series: vec![
            unmarked("flexible links", 0, full, Stroke::Solid),
            unmarked("rigid links (Eq 16)", 1, rigid, Stroke::Dashed),
        ],
        guides: vec![Guide {
            vertical: true,
            value: lowest,
            text: format!("lowest mode {} Hz", fixed(lowest, 2)),
        }],
        ..Plot::default()
    }
}
