//! The results of the records as text, tables and pictures.

use super::joint_record::{JointRecord, State, Stated, Traced};
use crate::reconcile::model::estimate::Estimate;
use crate::report::number::significant;
use crate::report::section::{Figure, PageSection};
use crate::report::svg::draw::MUTED;
use crate::report::svg::plot::{Axis, Plot, Series};
use crate::report::svg::scale::Scale;
use crate::report::svg::sheet::Sheet;
use crate::report::table::{Column, Table};
use std::fmt::Write as _;

/// Unit in which the parameter `name` of an effect is printed, and the factor from the SI unit to this unit.
fn shown_as(name: &str) -> (&'static str, f64) {
    match name {
        "seconds" => ("ms", 1e3),
        "frequency_hz" => ("Hz", 1.0),
        "nm_per_nm" => ("of the load", 1.0),
        "nms_per_rad" => ("Nms/rad", 1.0),
        n if n.ends_with("nm_per_rad") => ("Nm/rad", 1.0),
        n if n.ends_with("_nm") => ("Nm", 1.0),
        n if n.ends_with("_rad") => ("mrad", 1e3),
        _ => ("", 1.0),
    }
}

fn end(value: Option<f64>, factor: f64) -> String {
    value.map_or("?".into(), |v| significant(v * factor, 3))
}

fn interval(estimate: &Estimate, factor: f64) -> String {
    format!(
        "{} ({} to {})",
        significant(estimate.value * factor, 3),
        end(estimate.low, factor),
        end(estimate.high, factor)
    )
}

/// Parameters of an effect with their intervals and units, as text.
fn numbers(stated: &Stated) -> String {
    let one = |(name, list): &(String, Vec<Estimate>)| {
        let (unit, factor) = shown_as(name);
        let values: Vec<String> = list.iter().map(|e| interval(e, factor)).collect();
        let label = match name.as_str() {
            "k1_nm_per_rad" | "k2_nm_per_rad" | "k3_nm_per_rad" | "t1_nm" | "t2_nm" => {
                format!("{} ", &name[..2])
            }
            "peak_to_peak_rad" => "peak to peak ".into(),
            "sin_cos_sin2_cos2_rad" => "sin, cos, sin 2, cos 2: ".into(),
            _ => String::new(),
        };
        format!("{label}{} {unit}", values.join("; "))
    };
    stated.parameters.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn state_words(state: State) -> &'static str {
    match state {
        State::Found => "",
        State::Absent => "none",
        State::NotIdentified => "not identified",
        State::Refused => "refused",
    }
}

/// The result for one effect as text: its state, its parameters with intervals, and the reason or limitation.
fn sentence(stated: &Stated) -> String {
    let values = numbers(stated);
    let parts = [state_words(stated.state), &values, &stated.words];
    parts.iter().filter(|p| !p.is_empty()).map(|p| p.to_string()).collect::<Vec<_>>().join(": ")
}

/// The results of all joints as lines of text.
pub(crate) fn text(joints: &[JointRecord]) -> String {
    let mut out = String::new();
    for joint in joints {
        let _ = writeln!(
            out,
            "  record of {}: {} rows, worth {:.0} independent readings; {} blocks held out in turn; {:.1} deg of motion",
            joint.joint,
            joint.rows,
            joint.effective_rows,
            joint.blocks,
            joint.range_rad.to_degrees()
        );
        let steps: Vec<String> =
            joint.steps.iter().map(|s| format!("{} {:.4}", s.added, 1e3 * s.held_out_rad)).collect();
        let _ = writeln!(out, "    error of the twist on held-out blocks [mrad]: {}", steps.join(", "));
        for stated in &joint.stated {
            let _ = writeln!(out, "    {:<26} {}", stated.what.replace('_', " "), sentence(stated));
        }
    }
    out
}

/// The sections of the page on records: tables and a picture for each joint.
pub(crate) fn sections(joints: &[JointRecord]) -> Vec<PageSection> {
    joints.iter().map(section).collect()
}

fn section(joint: &JointRecord) -> PageSection {
    let mut table =
        Table::new(vec![Column::left("what"), Column::left("state"), Column::left("value and why")]);
    for stated in &joint.stated {
        let values = numbers(stated);
        let words: Vec<&str> =
            [values.as_str(), stated.words.as_str()].into_iter().filter(|w| !w.is_empty()).collect();
        table.row([stated.what.replace('_', " "), stated.state.word().replace('_', " "), words.join(": ")]);
    }
    let mut steps = Table::new(vec![Column::left("with"), Column::unit("error on held-out blocks", "mrad")]);
    for step in &joint.steps {
        steps.row([step.added.clone(), significant(1e3 * step.held_out_rad, 3)]);
    }
    PageSection {
        title: format!("Record of {}", joint.joint),
        words: vec![format!(
            "{} rows are worth {:.0} independent readings. {} blocks of time are held out in turn.",
            joint.rows, joint.effective_rows, joint.blocks
        )],
        tables: vec![
            ("What the record says, with intervals of 95 %.".into(), table),
            ("How the error of the twist falls.".into(), steps),
        ],
        figures: vec![figure(joint)],
    }
}

/// The picture of a joint: two diagrams of twist against torque. The upper one shows them as recorded, the lower one
/// corrected so that the spring and its friction are left.
fn figure(joint: &JointRecord) -> Figure {
    let points = |of: fn(&Traced) -> f64| -> Vec<(f64, f64)> {
        joint.trace.iter().map(|t| (t.torque_nm, 1e3 * of(t))).collect()
    };
    let title = format!("{}: twist against torque", joint.joint);
    let caption = "Above: motor less link, as recorded, without a constant offset. Below: without the time shift and the \
                   transmission error that were found too. The loop of friction stays. The model is drawn with it.";
    let panel = |title: &str, label: &str, series: Vec<Series>| Plot {
        title: title.into(),
        x: Axis::new("torque at the output [Nm]", Scale::Linear),
        y: Axis::new(label, Scale::Linear),
        series,
        width_px: 900.0,
        height_px: 300.0,
        ..Plot::default()
    };
    let scatter =
        |name: &str, style: usize, points| Series { marker_px: 2.0, ..Series::scatter(name, style, points) };
    let mut model = points(|t| t.model_rad);
    model.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sheet = Sheet {
        title: title.clone(),
        description: caption.into(),
        plots: vec![
            panel(&title, "before [mrad]", vec![scatter("recorded", MUTED, points(|t| t.before_rad))]),
            panel(
                "",
                "after [mrad]",
                vec![scatter("corrected", 0, points(|t| t.after_rad)), scatter("model", 1, model)],
            ),
        ],
    };
    let mut csv = String::from("torque_nm,twist_before_rad,twist_after_rad,model_rad\n");
    for t in &joint.trace {
        let _ = writeln!(csv, "{},{},{},{}", t.torque_nm, t.before_rad, t.after_rad, t.model_rad);
    }
    Figure { name: format!("record-{}", joint.joint), caption: caption.into(), svg: sheet.to_svg(), csv }
}
