//! Pictures of absolute positions: the error at each stage of the model, its distribution, its direction, and how
//! it depends on the angle of each joint.

use crate::report::number::fixed;
use crate::report::section::Figure;
use crate::report::svg::draw::MUTED;
use crate::report::svg::plot::{Axis, Plot, Series, Stroke};
use crate::report::svg::rows::{Mark, Row, RowPlot};
use crate::report::svg::scale::Scale;
use crate::report::svg::sheet::Sheet;
use crate::report::table::csv_line;

/// Number of bins into which each joint's range is divided.
const BINS: usize = 9;
/// A bin with fewer positions than this gets no median.
const FEWEST_IN_BIN: usize = 4;
/// Largest number of joints that are drawn: those whose angle has the most effect on the error.
const MOST_JOINTS: usize = 8;
const NAMES: [&str; 3] = ["before", "after", "after, pose held out"];

/// Size of the position error at one stage of the model \[mm\].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Step {
    /// Words that name what the stage adds to the model.
    pub added: String,
    /// Median error over the poses to which the model was fitted \[mm\].
    pub fitted_median: f64,
    /// Median error over held-out poses \[mm\].
    pub median: f64,
    /// Mean error over held-out poses \[mm\].
    pub mean: f64,
    /// Largest error over held-out poses \[mm\].
    pub max: f64,
}

/// The error of one position: measured less predicted, by component \[mm\].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Position {
    /// Row in the file without its header, counted from 1.
    pub row: usize,
    /// Joint angles \[deg\].
    pub pose_deg: Vec<f64>,
    /// Error with calibration only, by component \[mm\].
    pub before_mm: [f64; 3],
    /// Error with the effects found, by component \[mm\].
    pub after_mm: [f64; 3],
    /// Error of this position with the effects found and parameters fitted without its pose, by component \[mm\].
    pub kept_out_mm: [f64; 3],
}

fn length(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// A picture of the position error (median, mean and largest) at each stage of the model; `None` if there are no
/// stages.
pub(crate) fn steps_figure(steps: &[Step]) -> Option<Figure> {
    let row = |s: &Step| Row {
        label: s.added.clone(),
        marks: [s.median, s.mean, s.max]
            .into_iter()
            .enumerate()
            .map(|(kind, value)| Mark { value, interval: None, kind })
            .collect(),
        remark: format!("{} / {} / {}", fixed(s.median, 3), fixed(s.mean, 3), fixed(s.max, 2)),
    };
    let caption = "Distance between measured and predicted position, each pose predicted by the model fitted without \
                   it: median, mean and largest. Every line adds one thing to the model above it.";
    let plot = RowPlot {
        title: "The error of held-out poses, step by step".into(),
        description: caption.into(),
        x: Axis::new("position error [mm]", Scale::Log),
        kinds: ["median", "mean", "largest"].map(String::from).to_vec(),
        rows: steps.iter().map(row).collect(),
        guides: Vec::new(),
    };
    let mut csv =
        String::from("added,fitted_median_mm,kept_out_median_mm,kept_out_mean_mm,kept_out_largest_mm\n");
    for s in steps {
        let numbers = [s.fitted_median, s.median, s.mean, s.max].map(|x| x.to_string());
        csv.push_str(&csv_line(&[vec![s.added.clone()], numbers.to_vec()].concat()));
    }
    (!steps.is_empty()).then(|| Figure {
        name: "stages".into(),
        caption: caption.into(),
        svg: plot.to_svg(),
        csv,
    })
}

/// A picture of the distribution of position errors: the percentage of positions whose error is at most a given size
/// \[mm\], with calibration only, with the effects found, and held out. `None` if there are no positions.
pub(crate) fn sizes_figure(positions: &[Position]) -> Option<Figure> {
    let sorted = |of: fn(&Position) -> &[f64; 3]| {
        let mut out: Vec<f64> = positions.iter().map(|p| length(of(p))).collect();
        out.sort_by(f64::total_cmp);
        out
    };
    let sizes = [sorted(|p| &p.before_mm), sorted(|p| &p.after_mm), sorted(|p| &p.kept_out_mm)];
    let share = |i: usize| 100.0 * (i as f64 + 0.5) / positions.len() as f64;
    let look = |k: usize| {
        let points = sizes[k].iter().enumerate().map(|(i, mm)| (*mm, share(i))).collect();
        let stroke = if k == 1 { Stroke::Solid } else { Stroke::Dashed };
        let style = [MUTED, 0, 1][k];
        Series {
            stroke,
            open: k != 1,
            marker_px: [2.2, 0.0, 0.0][k],
            ..Series::line(NAMES[k], style, points)
        }
    };
    let caption = "How many positions of a hundred are off by at most so much: calibration only (circles), with what was found \
                   (solid), and with what was found but predicted without their own pose (dashed). Where the last two part, the model knows its own poses better than others.";
    let plot = Plot {
        title: "How large the errors are".into(),
        description: caption.into(),
        x: Axis::new("position error [mm]", Scale::Log),
        y: Axis {
            range: Some((0.0, 100.0)),
            ..Axis::new("positions off by at most this [%]", Scale::Linear)
        },
        series: (0..3).map(look).collect(),
        width_px: 900.0,
        height_px: 380.0,
        ..Plot::default()
    };
    let mut csv = String::from("share_percent,before_mm,after_mm,kept_out_mm\n");
    for (i, ((before, after), kept_out)) in sizes[0].iter().zip(&sizes[1]).zip(&sizes[2]).enumerate() {
        csv.push_str(&format!("{},{before},{after},{kept_out}\n", share(i)));
    }
    (!positions.is_empty()).then(|| Figure {
        name: "errors".into(),
        caption: caption.into(),
        svg: plot.to_svg(),
        csv,
    })
}

/// A picture of the position errors along each axis of the instrument, over the rows of the file. `None` if there are
/// no positions.
pub(crate) fn axes_figure(positions: &[Position]) -> Option<Figure> {
    let panel = |axis: usize| {
        let points =
            |of: fn(&Position) -> &[f64; 3]| -> Vec<f64> { positions.iter().map(|p| of(p)[axis]).collect() };
        let (before, after) = (points(|p| &p.before_mm), points(|p| &p.after_mm));
        // the range does not depend on a few gross errors: those beyond it are drawn at the edge
        let mut sizes: Vec<f64> = before.iter().map(|x| x.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let most = 1.2 * sizes.get(sizes.len() * 98 / 100).copied().unwrap_or(1.0).max(1e-6);
        let look = |name: &str, style, open, values: &[f64]| Series {
            open,
            stroke: Stroke::None,
            marker_px: 2.6,
            ..Series::line(name, style, row_points(positions, values, most))
        };
        Plot {
            title: if axis == 0 { "Which way the errors point".into() } else { String::new() },
            x: Axis::new("row of positions.csv", Scale::Linear),
            y: Axis {
                range: Some((-most, most)),
                ..Axis::new(&format!("{} [mm]", ["x", "y", "z"][axis]), Scale::Linear)
            },
            series: vec![look(NAMES[0], MUTED, true, &before), look(NAMES[1], 0, false, &after)],
            width_px: 900.0,
            height_px: 220.0,
            ..Plot::default()
        }
    };
    let caption = "Measured less predicted along each axis of the instrument, row by row: open and grey with calibration \
                   only, filled with what was found. What lies beyond the edge stands at it.";
    let sheet = Sheet {
        title: "Which way the errors point".into(),
        description: caption.into(),
        plots: (0..3).map(panel).collect(),
    };
    let mut csv = String::from("row,before_x_mm,before_y_mm,before_z_mm,after_x_mm,after_y_mm,after_z_mm\n");
    for p in positions {
        let numbers: Vec<String> = p.before_mm.iter().chain(&p.after_mm).map(f64::to_string).collect();
        csv.push_str(&format!("{},{}\n", p.row, numbers.join(",")));
    }
    (!positions.is_empty()).then(|| Figure {
        name: "axes".into(),
        caption: caption.into(),
        svg: sheet.to_svg(),
        csv,
    })
}

fn row_points(positions: &[Position], values: &[f64], most: f64) -> Vec<(f64, f64)> {
    positions.iter().zip(values).map(|(p, v)| (p.row as f64, v.clamp(-most, most))).collect()
}

/// One bin of a joint's range, with the median errors in it.
#[derive(Debug, Clone, PartialEq)]
struct Bin {
    centre_deg: f64,
    count: usize,
    before_mm: f64,
    after_mm: f64,
}

/// Median position errors in each bin of the range of the joint with the index `joint`. Bins with fewer than
/// [`FEWEST_IN_BIN`] positions are left out.
fn bins(positions: &[Position], joint: usize) -> Vec<Bin> {
    let angles = || positions.iter().filter_map(|p| p.pose_deg.get(joint).copied());
    let (low, high) = angles().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), a| (l.min(a), h.max(a)));
    if positions.is_empty() || high - low < 1.0 {
        return Vec::new();
    }
    let width = (high - low) / BINS as f64;
    let part =
        |p: &&Position, bin: usize| (((p.pose_deg[joint] - low) / width) as usize).min(BINS - 1) == bin;
    let median = |own: &[&Position], of: fn(&Position) -> &[f64; 3]| {
        let mut sizes: Vec<f64> = own.iter().map(|p| length(of(p))).collect();
        sizes.sort_by(f64::total_cmp);
        sizes[sizes.len() / 2]
    };
    (0..BINS)
        .filter_map(|bin| {
            let own: Vec<&Position> = positions.iter().filter(|p| part(p, bin)).collect();
            (own.len() >= FEWEST_IN_BIN).then(|| Bin {
                centre_deg: low + width * (bin as f64 + 0.5),
                count: own.len(),
                before_mm: median(&own, |p| &p.before_mm),
                after_mm: median(&own, |p| &p.after_mm),
            })
        })
        .collect()
}

/// Pictures of the median position error over the angle of each joint. The joints whose angle has the most effect come
/// first. `None` if no joint has several bins with enough positions.
pub(crate) fn angles_figure(joints: &[String], positions: &[Position]) -> Option<Figure> {
    let swing = |bins: &[Bin]| {
        let (low, high) =
            bins.iter().fold((f64::INFINITY, 0.0f64), |(l, h), b| (l.min(b.after_mm), h.max(b.after_mm)));
        high / low.max(1e-9)
    };
    let mut parts: Vec<(&String, Vec<Bin>)> = joints
        .iter()
        .enumerate()
        .map(|(j, name)| (name, bins(positions, j)))
        .filter(|(_, b)| b.len() > 1)
        .collect();
    parts.sort_by(|a, b| swing(&b.1).total_cmp(&swing(&a.1)));
    let mut csv = String::from("joint,angle_deg,positions,before_median_mm,after_median_mm\n");
    for (name, bins) in &parts {
        for b in bins {
            csv.push_str(&format!("{name},{},{},{},{}\n", b.centre_deg, b.count, b.before_mm, b.after_mm));
        }
    }
    parts.truncate(MOST_JOINTS);
    let sizes = || parts.iter().flat_map(|(_, bins)| bins).flat_map(|b| [b.before_mm, b.after_mm]);
    let range = (0.9 * sizes().fold(f64::INFINITY, f64::min), 1.1 * sizes().fold(0.0, f64::max));
    let panel = |(i, (name, bins)): (usize, &(&String, Vec<Bin>))| {
        let points = |of: fn(&Bin) -> f64| bins.iter().map(|b| (b.centre_deg, of(b))).collect();
        Plot {
            title: if i == 0 { "Where the gap sits: by joint angle".into() } else { String::new() },
            x: Axis::new(&format!("angle of {name} [deg]"), Scale::Linear),
            y: Axis { range: Some(range), ..Axis::new("error [mm]", Scale::Log) },
            series: vec![
                Series::variant(NAMES[0], MUTED, points(|b| b.before_mm)),
                Series::line(NAMES[1], 0, points(|b| b.after_mm)),
            ],
            width_px: 900.0,
            height_px: 190.0,
            ..Plot::default()
        }
    };
    let caption = "Median position error over each joint's range: dashed and grey with calibration only, solid with what was \
                   found. A line that rises or falls says that the error goes with this joint's angle; the joints where it does so most come first.";
    let sheet = Sheet {
        title: "Where the gap sits: by joint angle".into(),
        description: caption.into(),
        plots: parts.iter().enumerate().map(panel).collect(),
    };
    (!parts.is_empty()).then(|| Figure {
        name: "angles".into(),
        caption: caption.into(),
        svg: sheet.to_svg(),
        csv,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn positions() -> Vec<Position> {
        let at = |i: usize| {
            let angle = i as f64;
            Position {
                row: i + 1,
                pose_deg: vec![angle, 0.0],
                before_mm: [3.0, 0.0, 4.0],
                after_mm: [angle / 90.0, 0.0, 0.0],
                kept_out_mm: [0.0, 1.0, 0.0],
            }
        };
        (0..90).map(at).collect()
    }

    #[test]
    fn the_median_error_over_a_joints_range_is_that_of_its_parts() {
        let bins = bins(&positions(), 0);
        assert_eq!(bins.len(), BINS);
        assert!(bins.iter().all(|b| b.before_mm == 5.0 && b.count >= 9));
        assert!(bins[0].after_mm < 0.1 && bins[8].after_mm > 0.9, "{bins:?}");
        assert!(super::bins(&positions(), 1).is_empty(), "a joint that does not move");
    }

    #[test]
    fn every_picture_has_its_numbers_beside_it() {
        let joints = ["a".to_string(), "b".to_string()];
        let step = Step { added: "sessions".into(), fitted_median: 1.0, median: 2.0, mean: 3.0, max: 4.0 };
        let figures = [
            steps_figure(&[step]),
            sizes_figure(&positions()),
            axes_figure(&positions()),
            angles_figure(&joints, &positions()),
        ];
        for (figure, lines) in figures.into_iter().map(|f| f.expect("a picture")).zip([2, 91, 91, 1 + BINS]) {
            assert_eq!(figure.csv.lines().count(), lines, "{}", figure.name);
            assert!(figure.svg.contains("<desc"), "{} says what it shows", figure.name);
        }
        assert!(steps_figure(&[]).is_none() && angles_figure(&joints, &[]).is_none());
    }
}
