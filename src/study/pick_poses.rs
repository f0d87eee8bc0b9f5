//! Report on the picks of a front in other poses than the judged ones, with warnings for picks that deflect too far.

use super::range::{range_words, ranges, stated_ranges};
use super::worst_pose::{WorstPose, WorstPoses, loads, worst_poses};
use crate::arm::pose::{DrivenJoint, pose_json};
use crate::report::divided::{divided_lowest_hz, too_high};
use crate::report::front_table::FrontTable;
use crate::report::number::{percent, significant};
use crate::report::picks::{Objective, Pick, designs, picks};
use crate::report::pose::pose_words;
use crate::report::section::PageSection;
use crate::report::small_displacement::too_far;
use crate::report::supplement::Supplement;
use crate::report::table::{Column, Table};
use crate::report::words::{TERMINAL, wrap};
use crate::space::problem::ArmProblem;
use rayon::prelude::*;
use serde_json::{Map, Value, json};

/// Key of this report in `run.json`.
pub(crate) const KEY: &str = "worst_poses";
/// Threshold: a pose is reported if it is worse than the judged cases by more than this fraction.
const WORSE_BY: f64 = 0.02;
/// Remark on what this search for poses leaves out.
const LEFT_OUT: &str = "Not modelled in these poses: an arm that passes through itself, its base or the floor. Drives and stresses are \
                        checked in the sizing poses only. The poses were found by a search; worse ones are not excluded.";

/// A pick, the reach of its arm ([`Arm::reach_m`](crate::arm::Arm::reach_m)), and the poses in which its deflection and
/// its lowest mode are worst.
#[derive(Debug, Clone, PartialEq)]
struct PickPoses {
    pick: Pick,
    reach_m: f64,
    worst: WorstPoses,
    /// The lowest mode over the judged cases with every tube divided at the bodies on it \[Hz\]; `None` if no tube has
    /// a body between its ends.
    divided_hz: Option<f64>,
}

/// A driven joint with its range.
#[derive(Debug, Clone, PartialEq)]
struct JointRange {
    joint: DrivenJoint,
    /// Lower and upper end \[deg or mm\].
    range: [f64; 2],
    /// Whether the study states the range.
    is_stated: bool,
}

/// The worst pose of a pick for one objective.
struct WorstFor<'a> {
    objective: Objective,
    /// Factor from the library's unit of the objective to the printed one (mm, Hz).
    of_unit: f64,
    pose: &'a WorstPose,
}

/// The picks of a front in their worst poses.
#[derive(Debug, Clone, PartialEq)]
pub struct PicksInPoses {
    picks: Vec<PickPoses>,
    /// The range of each driven joint, base to tip.
    ranges: Vec<JointRange>,
    range_words: Vec<String>,
    /// Whether the judged cases have different loads.
    has_loads: bool,
}

/// Searches for the worst poses of the picks of a front. `front` is the front as a table.
pub fn picks_in_poses(problem: &ArmProblem, front: &FrontTable) -> PicksInPoses {
    let space = problem.space();
    let (cases, ranges) = (problem.load_cases(), ranges(space));
    let of_pick = |pick: Pick| {
        let arm = problem.arm(&problem.options_of_id(&pick.design.design_id)?)?;
        let worst = worst_poses(&arm, &cases, &ranges)?;
        let divided_hz = cases.iter().filter_map(|case| divided_lowest_hz(&arm, case)).reduce(f64::min);
        Some(PickPoses { pick, reach_m: arm.reach_m(), worst, divided_hz })
    };
    PicksInPoses {
        picks: picks(&designs(front)).into_par_iter().filter_map(of_pick).collect(),
        ranges: stated_ranges(space)
            .into_iter()
            .zip(ranges)
            .map(|((joint, is_stated), range)| JointRange { joint, range, is_stated })
            .collect(),
        range_words: range_words(space),
        has_loads: loads(&cases).len() > 1,
    }
}

impl WorstPose {
    /// The fraction by which the objective in the worst pose is worse than in the judged cases; 0 if either value is
    /// not a finite number.
    fn worse(&self) -> f64 {
        let by = (self.value - self.judged).abs() / self.judged;
        if by.is_finite() { by } else { 0.0 }
    }

    /// The worst pose for one objective, as an entry of `run.json`. `unit` is the unit in the names of keys, and
    /// `of_unit` the factor from the library's unit to it.
    fn to_json(&self, driven: &[DrivenJoint], unit: &str, of_unit: f64) -> Value {
        let mut out = Map::new();
        out.insert(format!("judged_{unit}"), json!(of_unit * self.judged));
        out.insert(format!("worst_{unit}"), json!(of_unit * self.value));
        out.insert("worse_percent".into(), json!(100.0 * self.worse()));
        let (key, pose) = pose_json(driven, &self.pose_deg);
        out.insert(key.into(), pose);
        out.insert("load_of_case".into(), json!(self.load_of));
        Value::Object(out)
    }
}

/// The objective in words, as sentences on worst poses name it.
fn name_of(objective: Objective) -> &'static str {
    if objective == Objective::Mode { "lowest mode" } else { "tip deflection" }
}

impl PickPoses {
    /// Names of the pick and id of its design.
    fn title(&self) -> String {
        format!("{} ({})", self.pick.names.join(", "), self.pick.design.design_id)
    }

    /// The worst pose for deflection and the worst pose for the lowest mode.
    fn both(&self) -> [WorstFor<'_>; 2] {
        [
            WorstFor { objective: Objective::Deflection, of_unit: 1e3, pose: &self.worst.deflection },
            WorstFor { objective: Objective::Mode, of_unit: 1.0, pose: &self.worst.mode },
        ]
    }

    /// The worst poses for deflection and for the lowest mode, but only those in which the objective is worse than in
    /// the judged cases by more than [`WORSE_BY`].
    fn worse(&self) -> impl Iterator<Item = WorstFor<'_>> {
        self.both().into_iter().filter(|worst| worst.pose.worse() > WORSE_BY)
    }

    fn sentence(
        &self,
        WorstFor { objective, of_unit, pose }: WorstFor,
        driven: &[DrivenJoint],
        has_loads: bool,
    ) -> String {
        let what = name_of(objective);
        let side = if objective == Objective::Mode { "lower" } else { "more" };
        let load = if has_loads { format!(" with the load of \"{}\"", pose.load_of) } else { String::new() };
        let far = match objective {
            Objective::Deflection => too_far(pose.value, self.reach_m),
            _ => None,
        };
        format!(
            "{}: {what} {} in pose {}{load}, {} {side} than the {} of the judged cases.{}",
            self.title(),
            objective.amount(of_unit * pose.value),
            pose_words(driven, &pose.pose_deg),
            percent(100.0 * pose.worse(), 1),
            objective.amount(of_unit * pose.judged),
            far.map_or(String::new(), |words| format!(" There the tip {words}."))
        )
    }

    fn to_json(&self, driven: &[DrivenJoint]) -> Value {
        json!({
            "names": self.pick.names,
            "design_id": self.pick.design.design_id,
            "reach_m": self.reach_m,
            "small_displacements": too_far(self.worst.deflection.judged, self.reach_m).is_none(),
            "tip_deflection": self.worst.deflection.to_json(driven, "mm", 1e3),
            "lowest_mode": self.worst.mode.to_json(driven, "hz", 1.0),
        })
    }
}

impl PicksInPoses {
    /// Warnings: a sentence for each pick that deflects too far already in the judged cases, and for each whose lowest
    /// mode comes out too high because of bodies on its tubes.
    fn warnings(&self) -> Vec<String> {
        let warnings = |of: &PickPoses| {
            let far = too_far(of.worst.deflection.judged, of.reach_m)
                .map(|words| format!("{}: the tip {words}.", of.title()));
            let high = of.divided_hz.and_then(|divided_hz| too_high(of.worst.mode.judged, divided_hz));
            [far, high.map(|words| format!("{}: {words}.", of.title()))].into_iter().flatten()
        };
        self.picks.iter().flat_map(warnings).collect()
    }

    /// The driven joints of the arm, base to tip.
    fn driven(&self) -> Vec<DrivenJoint> {
        self.ranges.iter().map(|range| range.joint.clone()).collect()
    }

    /// A sentence for each pick and each objective (deflection, lowest mode) that is worse in some pose than in the
    /// judged cases by more than [`WORSE_BY`].
    fn worse(&self) -> Vec<String> {
        let driven = self.driven();
        let of_pick = |of: &PickPoses| {
            of.worse().map(|worse| of.sentence(worse, &driven, self.has_loads)).collect::<Vec<_>>()
        };
        self.picks.iter().flat_map(of_pick).collect()
    }

    /// The introductory sentence: which poses were searched, and whether worse ones were found.
    fn lead(&self) -> String {
        let ranges = self.range_words.join("; ");
        match self.worse().is_empty() {
            true => format!(
                "No pose within the ranges of the joints ({ranges}) was found in which a pick is more than {} worse than \
                 in the judged cases.",
                percent(100.0 * WORSE_BY, 0)
            ),
            false => format!(
                "Picks that are more than {} worse in another pose within the ranges of the joints ({ranges}) than in \
                 the judged cases:",
                percent(100.0 * WORSE_BY, 0)
            ),
        }
    }

    /// Everything that a result reports about these poses: sections, entry of `run.json`, terminal text.
    pub fn supplement(&self) -> Supplement {
        let run = Some((KEY, self.to_json()));
        if self.picks.is_empty() {
            return Supplement { run, ..Supplement::default() };
        }
        let paragraphs = |words: &[String]| words.iter().map(|s| wrap(s, TERMINAL, "")).collect::<String>();
        let listed = self.worse().into_iter().map(|s| format!("- {s}"));
        let words: Vec<String> =
            [self.lead()].into_iter().chain(listed).chain([LEFT_OUT.to_string()]).collect();
        let warnings = paragraphs(&self.warnings());
        let gap = if warnings.is_empty() { "" } else { "\n" };
        Supplement {
            file: None,
            markdown: self.to_markdown(),
            section: Some(self.section()),
            run,
            terminal: format!("{warnings}{gap}{}", paragraphs(&words)),
        }
    }

    /// The entry on the worst poses in `run.json`.
    fn to_json(&self) -> Value {
        let range = |JointRange { joint, range: [low, high], is_stated }: &JointRange| {
            let unit = joint.motion.unit();
            json!({"joint": joint.name, format!("low_{unit}"): low, format!("high_{unit}"): high, "stated": is_stated})
        };
        let driven = self.driven();
        json!({
            "ranges": self.ranges.iter().map(range).collect::<Vec<Value>>(),
            "picks": self.picks.iter().map(|pick| pick.to_json(&driven)).collect::<Vec<Value>>(),
            "left_out": [LEFT_OUT],
        })
    }

    /// The section on other poses for the HTML page.
    fn section(&self) -> PageSection {
        let words =
            self.warnings().into_iter().chain([self.lead()]).chain(self.worse()).chain([LEFT_OUT.into()]);
        PageSection {
            title: "Other poses".into(),
            words: words.collect(),
            tables: vec![("The worst pose found for each pick".into(), self.table())],
            figures: Vec::new(),
        }
    }

    /// The section on other poses for the Markdown summary.
    fn to_markdown(&self) -> String {
        let list = |words: Vec<String>| words.iter().map(|s| format!("- {s}\n")).collect::<String>();
        let (warnings, worse) = (list(self.warnings()), list(self.worse()));
        let gap = |list: &str| if list.is_empty() { "" } else { "\n" };
        format!(
            "\n## Other poses\n\n{warnings}{}{}\n\n{worse}{}{}\n{LEFT_OUT}\n",
            gap(&warnings),
            self.lead(),
            gap(&worse),
            self.table().to_markdown()
        )
    }

    /// The table of worst poses, one row for each pick and objective.
    fn table(&self) -> Table {
        let mut table = Table::new(vec![
            Column::left("pick"),
            Column::left("design"),
            Column::left("objective"),
            Column::right("judged"),
            Column::right("worst"),
            Column::right("worse by [%]"),
            Column::left("pose"),
            Column::left("load of"),
        ]);
        let driven = self.driven();
        for of in &self.picks {
            for WorstFor { objective, of_unit, pose } in of.both() {
                table.row([
                    of.pick.names.join(", "),
                    of.pick.design.design_id.clone(),
                    format!("{} [{}]", name_of(objective), objective.unit()),
                    significant(of_unit * pose.judged, 4),
                    significant(of_unit * pose.value, 4),
                    significant(100.0 * pose.worse(), 3),
                    pose_words(&driven, &pose.pose_deg),
                    pose.load_of.clone(),
                ]);
            }
        }
        table
    }
}
