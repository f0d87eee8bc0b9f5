//! The page of a campaign: the verdict in a sentence, the difference between model and readings before and after the
//! effects were added, where this difference is largest, the evidence for each candidate, its parameters with
//! intervals, the prediction of held-out readings, and the next measurements.

use super::campaign::{CampaignPage, Compared, Found, Ranged, Reading, Test, Weighed};
use super::gallery::{Gallery, Page};
use super::positions::{angles_figure, axes_figure, sizes_figure, steps_figure};
use crate::arm::pose::{DrivenJoint, Motion};
use crate::report::braille::bar;
use crate::report::number::{fixed, significant, with_ends};
use crate::report::pose::pose_signs;
use crate::report::section::Figure;
use crate::report::svg::draw::MUTED;
use crate::report::svg::plot::{Axis, Guide, Plot, Series, Stroke};
use crate::report::svg::rows::{Mark, Row, RowPlot};
use crate::report::svg::scale::Scale;
use crate::report::svg::sheet::Sheet;
use serde_json::{Value, json};

/// Largest number of rows (poses, or parts of joint ranges) in a picture.
const MOST_ROWS: usize = 26;
/// Scores below this are drawn at the edge of the picture.
const LEAST_SCORE: f64 = -30.0;
/// Number of equal parts into which each joint's range is divided.
const PARTS_OF_RANGE: usize = 3;
const BEFORE_AFTER: [&str; 2] = ["before: the model as given, calibrated", "after: with what was found"];

impl CampaignPage {
    /// The page as HTML, with its pictures.
    pub fn page(&self) -> Page {
        let mut gallery = Gallery::default();
        let show = |gallery: &mut Gallery, figure: Option<Figure>| figure.map(|f| gallery.show(&f));
        let channels = show(&mut gallery, self.channels_figure());
        let located = self.located_figures();
        let names: Vec<String> = self.joints.iter().map(|joint| joint.name.clone()).collect();
        let angles = angles_figure(&names, &self.positions);
        let located: Vec<Value> = located.into_iter().chain(angles).map(|f| gallery.show(&f)).collect();
        let residuals = self.residual_figures().into_iter().chain(axes_figure(&self.positions));
        let residuals: Vec<Value> = residuals.map(|f| gallery.show(&f)).collect();
        let steps: Vec<Value> = [steps_figure(&self.steps), sizes_figure(&self.positions)]
            .into_iter()
            .flatten()
            .map(|f| gallery.show(&f))
            .collect();
        let records: Vec<Value> = self.records.iter().map(|r| gallery.extra(r)).collect();
        let (evidence, intervals, kept_out) = (self.evidence(), self.intervals(), self.kept_out_figure());
        let content = json!({
            "name": self.name,
            "sentence": self.sentence,
            "reasons": self.reasons,
            "explained": self.explained,
            "channels": channels,
            "located": located,
            "steps": steps,
            "residuals": residuals,
            "found": self.found.iter().map(found).collect::<Vec<_>>(),
            "evidence": show(&mut gallery, evidence),
            "intervals": show(&mut gallery, intervals),
            "kept_out": show(&mut gallery, kept_out),
            "kept_out_words": self.kept_out_words(),
            "quality": self.quality,
            "tests": self.tests.iter().map(test).collect::<Vec<_>>(),
            "records": records,
            "corrected_models": self.corrected_models.as_ref().map(|e| gallery.extra(e)),
            "optimum": self.optimum.as_ref().map(|e| gallery.extra(e)),
            "facts": self.facts,
        });
        gallery.page("campaign.html", &self.name, content, &json!({}))
    }

    /// Whether a group of readings is a whole channel, so that its name is one word.
    fn is_channel(part: &Compared) -> bool {
        !part.part.contains([',', ' '])
    }

    /// A picture of the root mean square of the residuals in each channel, before and after the effects were added;
    /// `None` if no channel has readings.
    fn channels_figure(&self) -> Option<Figure> {
        let channels: Vec<Compared> = self.parts.iter().filter(|p| Self::is_channel(p)).cloned().collect();
        (!channels.is_empty()).then(|| {
            let caption = "Root mean square of measured less predicted, in declared standard deviations; noise alone \
                           gives 1.";
            gap_figure("channels", "The gap by channel", caption, channels)
        })
    }

    /// Pictures that show where the model and the readings differ: by load, branch, mode and bench joint; by joint
    /// angle; by pose.
    fn located_figures(&self) -> Vec<Figure> {
        let of_part = |p: &&Compared| !Self::is_channel(p) && !p.part.starts_with("pose");
        let mut parts: Vec<Compared> = self.parts.iter().filter(of_part).cloned().collect();
        // sorted by channel, and within a channel by kind of part
        parts.sort_by_key(|p| p.part.split(' ').take(2).map(String::from).collect::<Vec<_>>());
        let all = [
            (
                "parts",
                "Where the gap is: by load, branch, mode and joint on the bench",
                "The readings, divided by load, branch, mode and bench joint.",
                parts,
            ),
            (
                "joints",
                "Where the gap is: joint by joint",
                "Each joint's range of angles in three parts: a gap that depends on an angle shows here.",
                self.by_joint(),
            ),
            ("poses", "Where the gap is: pose by pose", "The poses with the largest gap.", self.by_pose()),
        ];
        let filled = all.into_iter().filter(|(.., rows)| !rows.is_empty());
        filled.map(|(name, title, caption, rows)| gap_figure(name, title, caption, rows)).collect()
    }

    /// The root mean square of the residuals by channel, before and after the effects were added, as bars for a
    /// terminal of 80 columns. The lengths of the bars are logarithmic.
    pub fn terminal(&self) -> String {
        let rows = || self.parts.iter().filter(|p| Self::is_channel(p));
        let values = || rows().flat_map(|c| [c.before, c.after]).filter(|v| *v > 0.0);
        let (low, high) = (values().fold(f64::INFINITY, f64::min).min(0.5), values().fold(1.0, f64::max));
        let share = |v: f64| libm::log(v.max(low) / low) / libm::log(high / low).max(1e-9);
        let line = |name: &str, when: &str, v: f64| {
            format!("  {name:<10} {when:<6} {:>6} {}\n", significant(v, 3), bar(share(v), 50))
        };
        let lines: String =
            rows().map(|c| line(&c.part, "before", c.before) + &line("", "after", c.after)).collect();
        if lines.is_empty() {
            lines
        } else {
            format!("\nGap by channel [declared standard deviations, logarithmic bars]\n{lines}\n")
        }
    }

    /// Root mean squares of the residuals in each pose, the largest first.
    fn by_pose(&self) -> Vec<Compared> {
        let name = |r: &Reading| r.pose_deg.as_ref().map(|p| pose_signs(&self.joints, p));
        let mut rows = self.split(|r| name(r).into_iter().collect());
        rows.sort_by(|a, b| b.before.total_cmp(&a.before));
        rows.truncate(MOST_ROWS);
        rows
    }

    /// Root mean squares of the residuals in each third of the range of each joint.
    fn by_joint(&self) -> Vec<Compared> {
        let range = |j: usize| {
            let angles = self.readings.iter().filter_map(|r| r.pose_deg.as_ref()?.get(j).copied());
            angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), a| (low.min(a), high.max(a)))
        };
        let ranges: Vec<(f64, f64)> = (0..self.joints.len()).map(range).collect();
        let part = |j: usize, third: usize| {
            let (low, high) = ranges[j];
            let end = |i: usize| fixed(low + (high - low) * i as f64 / PARTS_OF_RANGE as f64, 0);
            let DrivenJoint { name, motion } = &self.joints[j];
            match motion {
                Motion::Turns => format!("{name} at {}° to {}°", end(third), end(third + 1)),
                Motion::Slides => format!("{name} at {} to {} mm", end(third), end(third + 1)),
            }
        };
        let names = |r: &Reading| -> Vec<String> {
            let Some(pose) = &r.pose_deg else { return Vec::new() };
            let moves = pose.iter().zip(&ranges).enumerate().filter(|(_, (_, (low, high)))| high > low);
            moves
                .map(|(j, (a, (low, high)))| {
                    let third = (PARTS_OF_RANGE as f64 * (a - low) / (high - low)).floor() as usize;
                    part(j, third.min(PARTS_OF_RANGE - 1))
                })
                .collect()
        };
        let mut rows = self.split(names);
        let order = |c: &Compared| {
            let all = (0..self.joints.len()).flat_map(|j| (0..PARTS_OF_RANGE).map(move |t| (j, t)));
            all.filter(|(j, _)| ranges[*j].0 < ranges[*j].1).position(|(j, t)| part(j, t) == c.part)
        };
        rows.sort_by_key(order);
        rows.truncate(MOST_ROWS);
        rows
    }

    /// Root mean squares of the residuals of groups of readings. `names` gives the names of the groups to which a
    /// reading belongs; these may be several. Gross errors are left out.
    fn split(&self, names: impl Fn(&Reading) -> Vec<String>) -> Vec<Compared> {
        let mut out: Vec<Compared> = Vec::new();
        for reading in self.readings.iter().filter(|r| !r.gross) {
            let squares = (reading.before_sigma.powi(2), reading.after_sigma.powi(2));
            for part in names(reading) {
                let place = out.iter().position(|c| c.part == part).unwrap_or_else(|| {
                    out.push(Compared { part, count: 0, before: 0.0, after: 0.0 });
                    out.len() - 1
                });
                let entry = &mut out[place];
                entry.count += 1;
                (entry.before, entry.after) = (entry.before + squares.0, entry.after + squares.1);
            }
        }
        for entry in &mut out {
            let mean = |sum: f64| (sum / entry.count as f64).sqrt();
            (entry.before, entry.after) = (mean(entry.before), mean(entry.after));
        }
        out
    }

    /// Pictures of the residuals before and after the effects were added, over the rows of the file; one picture per
    /// channel.
    fn residual_figures(&self) -> Vec<Figure> {
        let mut channels: Vec<&'static str> = Vec::new();
        for reading in &self.readings {
            if !channels.contains(&reading.channel) {
                channels.push(reading.channel);
            }
        }
        channels.into_iter().map(|c| self.residual_figure(c)).collect()
    }

    fn residual_figure(&self, channel: &str) -> Figure {
        let readings = || self.readings.iter().filter(|r| r.channel == channel);
        let panel = |title: &str, label: &str, style: usize, open: bool, of: fn(&Reading) -> f64| {
            // the range does not depend on gross errors: those beyond it are drawn at the edge
            let most = readings().filter(|r| !r.gross).map(|r| of(r).abs()).fold(3.0, f64::max).ceil();
            let points = |gross: bool| -> Vec<(f64, f64)> {
                let own = readings().filter(|r| r.gross == gross);
                own.map(|r| (r.row as f64, of(r).clamp(-most, most))).collect()
            };
            let look = |name: &str, style, open, points| Series {
                open,
                stroke: Stroke::None,
                marker_px: 3.2,
                ..Series::scatter(name, style, points)
            };
            let mut series = vec![look("", style, open, points(false))];
            let gross = points(true);
            if !gross.is_empty() {
                series.push(look("", 1, false, gross));
            }
            Plot {
                title: title.into(),
                x: Axis::new(&format!("row of {channel}.csv"), Scale::Linear),
                y: Axis { range: Some((-most, most)), ..Axis::new(label, Scale::Linear) },
                series,
                guides: [-2.0, 2.0]
                    .map(|value| Guide { vertical: false, value, text: String::new() })
                    .to_vec(),
                width_px: 900.0,
                height_px: 270.0,
                ..Plot::default()
            }
        };
        let title = format!("{channel}: measured less predicted, row by row");
        let caption = "In declared standard deviations; the dotted lines are two of them. Above: the model as given, \
                       calibrated within tolerance. Below: with what was found. Squares: gross errors, left out of the fit; at the edge where they lie beyond it.";
        let sheet = Sheet {
            title: title.clone(),
            description: caption.into(),
            plots: vec![
                panel(&title, "before [σ]", MUTED, true, |r| r.before_sigma),
                panel("", "after [σ]", 0, false, |r| r.after_sigma),
            ],
        };
        let mut csv = String::from("row,quantity,before_sigma,after_sigma,gross_error\n");
        for r in readings() {
            csv.push_str(&format!(
                "{},{},{},{},{}\n",
                r.row, r.quantity, r.before_sigma, r.after_sigma, r.gross
            ));
        }
        Figure { name: format!("residuals-{channel}"), caption: caption.into(), svg: sheet.to_svg(), csv }
    }

    fn evidence(&self) -> Option<Figure> {
        if self.weighed.is_empty() {
            return None;
        }
        let row = |w: &Weighed| Row {
            label: w.model.clone(),
            marks: vec![Mark { value: w.score.max(LEAST_SCORE), interval: None, kind: 0 }],
            remark: format!("{}{}", if w.score < LEAST_SCORE { "\u{25c2} " } else { "" }, fixed(w.score, 1)),
        };
        let caption = "Logarithm of each model's evidence less that of the best. Right of the dotted line at -3 \
                       the readings hardly choose; left of the dotted line at -10 a model is out of the question. An arrow marks what lies beyond the edge.";
        let plot = RowPlot {
            title: "What speaks for each candidate".into(),
            description: caption.into(),
            x: Axis {
                range: Some((LEAST_SCORE, 0.0)),
                ..Axis::new("log-evidence less the best's", Scale::Linear)
            },
            kinds: vec!["score".into()],
            rows: self.weighed.iter().map(row).collect(),
            guides: vec![(-10.0, String::new()), (-3.0, String::new())],
        };
        let mut csv = String::from("model,score,chi_squared\n");
        for w in &self.weighed {
            csv.push_str(&crate::report::table::csv_line(&[
                w.model.clone(),
                w.score.to_string(),
                w.chi_squared.to_string(),
            ]));
        }
        Some(Figure { name: "evidence".into(), caption: caption.into(), svg: plot.to_svg(), csv })
    }

    fn intervals(&self) -> Option<Figure> {
        if self.calibrated.is_empty() {
            return None;
        }
        let caption = "Factor on the nominal value with its 95 % interval; a long bar means that the readings say little.";
        let row = |c: &Ranged| {
            let [value, low, high] = with_ends(c.value, [c.low, c.high]);
            Row {
                label: c.name.clone(),
                marks: vec![Mark { value: c.value, interval: Some((c.low, c.high)), kind: 0 }],
                remark: format!("{value} ({low} to {high})"),
            }
        };
        let plot = RowPlot {
            title: "Calibrated within tolerance".into(),
            description: caption.into(),
            x: Axis::new("factor on the nominal value", Scale::Linear),
            kinds: vec!["factor".into()],
            rows: self.calibrated.iter().map(row).collect(),
            guides: vec![(1.0, "nominal".into())],
        };
        Some(Figure {
            name: "calibrated".into(),
            caption: caption.into(),
            csv: plot.to_csv(),
            svg: plot.to_svg(),
        })
    }

    /// A picture of the residuals of held-out readings, in the order of the readings; `None` without such readings.
    fn kept_out_figure(&self) -> Option<Figure> {
        let predicted: Vec<(usize, &Reading, f64)> = self
            .readings
            .iter()
            .filter_map(|r| Some((r, r.kept_out_sigma?)))
            .enumerate()
            .map(|(i, (r, k))| (i + 1, r, k))
            .collect();
        if predicted.is_empty() {
            return None;
        }
        let mut series: Vec<Series> = Vec::new();
        for (i, reading, sigma) in &predicted {
            match series.iter_mut().find(|s| s.name == reading.channel) {
                Some(one) => one.points.push((*i as f64, *sigma)),
                None => series.push(Series {
                    marker_px: 3.2,
                    ..Series::scatter(reading.channel, series.len(), vec![(*i as f64, *sigma)])
                }),
            }
        }
        let caption = "Each reading is predicted by the model fitted without its pose. Noise alone puts 95 of 100 between the \
                       dotted lines.";
        let plot = Plot {
            title: "Held-out readings: measured less predicted".into(),
            description: caption.into(),
            x: Axis::new("reading", Scale::Linear),
            y: Axis::new("measured less predicted [σ]", Scale::Linear),
            series,
            guides: [-2.0, 2.0].map(|value| Guide { vertical: false, value, text: String::new() }).to_vec(),
            width_px: 900.0,
            height_px: 360.0,
            ..Plot::default()
        };
        let mut csv = String::from("reading,channel,row,quantity,kept_out_sigma\n");
        for (i, r, sigma) in &predicted {
            csv.push_str(&format!("{i},{},{},{},{sigma}\n", r.channel, r.row, r.quantity));
        }
        Some(Figure { name: "kept-out".into(), caption: caption.into(), svg: plot.to_svg(), csv })
    }

    fn kept_out_words(&self) -> Option<String> {
        let (count, before, after) = self.kept_out?;
        Some(format!(
            "On {count} held-out readings (their poses were not used in the fit) the gap is {} standard deviations before and {} after.",
            fixed(before, 2),
            fixed(after, 2)
        ))
    }
}

/// A picture with one row per group of readings: root mean square of the residuals before and after the effects were
/// added.
fn gap_figure(name: &str, title: &str, caption: &str, rows: Vec<Compared>) -> Figure {
    let row = |c: &Compared| Row {
        label: c.part.clone(),
        marks: [c.before, c.after]
            .into_iter()
            .enumerate()
            .map(|(kind, value)| Mark { value, interval: None, kind })
            .collect(),
        remark: format!("{} → {}   n = {}", significant(c.before, 3), significant(c.after, 3), c.count),
    };
    let values = || rows.iter().flat_map(|c| [c.before, c.after]);
    let (low, high) = (values().fold(1.0, f64::min), values().fold(1.0, f64::max));
    let plot = RowPlot {
        title: title.into(),
        description: caption.into(),
        x: Axis::new(
            "root mean square of measured less predicted [σ]",
            if low > 0.0 && high > 3.0 * low { Scale::Log } else { Scale::Linear },
        ),
        kinds: BEFORE_AFTER.map(String::from).to_vec(),
        rows: rows.iter().map(row).collect(),
        guides: vec![(1.0, "noise".into())],
    };
    Figure { name: name.into(), caption: caption.into(), csv: plot.to_csv(), svg: plot.to_svg() }
}

fn found(found: &Found) -> Value {
    let parameters: Vec<Value> = found
        .parameters
        .iter()
        .map(|p| {
            let [value, low, high] = with_ends(p.value, [p.low, p.high]);
            json!({"name": p.name, "value": value, "low": low, "high": high})
        })
        .collect();
    json!({"label": found.label, "parameters": parameters, "like": found.like})
}

fn test(test: &Test) -> Value {
    json!({
        "words": test.words, "separates": test.separates,
        "sigmas": significant(test.expected_sigmas, 3), "needed": test.readings_needed,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(pose: f64, before: f64) -> Reading {
        Reading {
            channel: "static",
            row: 1,
            quantity: "dz_mm",
            pose_deg: Some(vec![pose, 0.0]),
            before_sigma: before,
            after_sigma: 1.0,
            kept_out_sigma: Some(0.5),
            gross: false,
        }
    }

    fn page() -> CampaignPage {
        CampaignPage {
            name: "c".into(),
            sentence: "The gap is explained by lost motion at j2.".into(),
            joints: ["j1", "j2"].map(DrivenJoint::turning).to_vec(),
            readings: vec![reading(0.0, 3.0), reading(90.0, 4.0), reading(90.0, 4.0)],
            ..CampaignPage::default()
        }
    }

    #[test]
    fn poses_are_listed_by_their_gap() {
        let poses = page().by_pose();
        assert_eq!((poses[0].part.as_str(), poses[0].count, poses[0].before), ("90°, 0°", 2, 4.0));
    }

    #[test]
    fn a_joint_that_does_not_move_has_no_rows() {
        let joints: Vec<String> = page().by_joint().into_iter().map(|c| c.part).collect();
        assert_eq!(joints, ["j1 at 0° to 30°", "j1 at 60° to 90°"]);
    }

    #[test]
    fn the_page_has_every_picture_as_a_file() {
        let page = page().page();
        assert!(page.html.contains("explained by lost motion at j2"));
        let names: Vec<&str> = page.files.iter().map(|(n, _)| n.as_str()).collect();
        for name in ["poses.svg", "joints.svg", "residuals-static.svg", "kept-out.csv"] {
            assert!(names.contains(&name), "{name} of {names:?}");
        }
    }
}
