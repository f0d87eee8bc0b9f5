//! The values that the page of a campaign shows.

use super::outcome::{NextTest, Outcome, ReadingResidual, Verdict};
use super::record_report;
use super::stage::Stage;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::entry::word_of;
use crate::reconcile::model::estimate::{Estimate, Finding};
use crate::reconcile::readings::campaign::{Campaign, driven_joints};
use crate::report::html::campaign::{CampaignPage, Compared, Found, Ranged, Reading, Test, Weighed};
use crate::report::html::positions::{Position, Step};
use crate::report::number::{fixed, shortest};
use crate::report::pose::pose_signs;
use crate::report::section::PageSection;
use crate::report::table::{Column, Table};

/// The values that the page of a campaign shows, from the campaign and the result of its reconciliation.
pub fn campaign_page(campaign: &Campaign, outcome: &Outcome) -> CampaignPage {
    let text = outcome.to_text();
    CampaignPage {
        name: outcome.campaign.clone(),
        sentence: sentence(outcome),
        reasons: outcome.reasons.clone(),
        explained: outcome.verdict == Verdict::Explained,
        joints: driven_joints(&campaign.arms()),
        parts: outcome
            .located
            .iter()
            .map(|l| Compared {
                part: l.part.clone(),
                count: l.count,
                before: l.rms_before,
                after: l.rms_after,
            })
            .collect(),
        readings: readings(campaign, outcome),
        steps: outcome.stages.iter().map(step).collect(),
        positions: positions(campaign, outcome),
        found: outcome.effects.iter().chain(&outcome.suspects).map(found).collect(),
        // positions are judged by the error of held-out poses, which `steps` shows
        weighed: outcome
            .evidence
            .iter()
            .filter(|_| campaign.has_displacements())
            .map(|e| Weighed { model: e.model.clone(), score: e.score, chi_squared: e.objective })
            .collect(),
        calibrated: outcome.calibrated.iter().map(|c| ranged(c.name.clone(), &c.factor)).collect(),
        kept_out: outcome.held_out.map(|k| (k.count, k.rms_before, k.rms_after)),
        quality: text.lines().filter(|l| is_quality(l)).map(|l| l.trim().to_string()).collect(),
        tests: outcome.next_tests.iter().map(test).collect(),
        records: record_report::sections(&outcome.records),
        corrected_models: corrected_models(outcome),
        optimum: None,
        facts: facts(campaign, outcome),
    }
}

/// The verdict as a full sentence.
fn sentence(outcome: &Outcome) -> String {
    let place = |f: &Finding| match f.at.as_str() {
        "" => f.effect.replace('_', " "),
        at => format!("{} at {at}", f.effect.replace('_', " ")),
    };
    match outcome.verdict {
        Verdict::NoGap => {
            "There is no gap: noise and the calibration of the parts explain every reading.".into()
        }
        Verdict::Explained => {
            let names: Vec<String> = outcome.effects.iter().map(place).collect();
            format!("The gap between model and measurement is explained by {}.", names.join(" and "))
        }
        Verdict::Unexplained => {
            "The model is wrong, and no known effect can be named as what is missing.".into()
        }
        Verdict::InsufficientData => "The readings do not suffice to tell what is behind the gap.".into(),
    }
}

/// Section on the corrected arm for the verdict `unexplained`. It has the models from which the model of
/// `arm.corrected.json` was chosen, and the laws without a name in the chosen model. `None` if the outcome lists no
/// models.
fn corrected_models(outcome: &Outcome) -> Option<PageSection> {
    if outcome.models.is_empty() {
        return None;
    }
    let mut table = Table::new(vec![
        Column::left("model"),
        Column::unit("error on held-out readings", "sigma"),
        Column::left("in arm.corrected.json"),
    ]);
    for row in &outcome.models {
        let mark = if row.is_written { "yes" } else { "" };
        table.row([row.model.clone(), fixed(row.kept_out_rms_sigma, 2), mark.into()]);
    }
    let laws = outcome.empirical.iter().map(|law| format!("{}: {}", law.law, law.may_be));
    Some(PageSection {
        title: "The corrected arm".into(),
        words: [
            "The model in arm.corrected.json predicts held-out readings best. It explains nothing.".into()
        ]
        .into_iter()
        .chain(laws)
        .collect(),
        tables: vec![("The models from which it was chosen.".into(), table)],
        figures: Vec::new(),
    })
}

/// Whether a line of the verdict's text is about the quality of the readings (gross errors, scatter).
fn is_quality(line: &str) -> bool {
    line.trim_start().starts_with("gross error") || line.ends_with("times as much as declared")
}

/// The residuals of all readings except positions, each with its pose \[standard deviations\]. They are sorted by
/// channel, then by the order in the file.
fn readings(campaign: &Campaign, outcome: &Outcome) -> Vec<Reading> {
    let own = outcome.residuals.iter().filter(|r| r.channel != Channel::Positions);
    own.map(|r| {
        let pose = match r.channel {
            Channel::Static => campaign.statics.get(r.index).map(|s| s.pose_deg.clone()),
            Channel::Modal => campaign.modal.get(r.index).map(|m| m.pose_deg.clone()),
            Channel::Windup | Channel::Positions => None,
        };
        Reading {
            channel: r.channel.word(),
            row: r.row,
            quantity: r.quantity,
            pose_deg: pose,
            before_sigma: (r.measured - r.before) / r.sigma,
            after_sigma: (r.measured - r.after) / r.sigma,
            kept_out_sigma: r.held_out,
            gross: r.gross,
        }
    })
    .collect()
}

/// The errors of absolute positions as vectors, one per position \[mm\]. A coordinate that was not measured is zero.
fn positions(campaign: &Campaign, outcome: &Outcome) -> Vec<Position> {
    let own: Vec<&ReadingResidual> =
        outcome.residuals.iter().filter(|r| r.channel == Channel::Positions).collect();
    let rows = own.chunk_by(|a, b| a.index == b.index);
    let rows = rows.filter_map(|axes| Some((axes, campaign.positions.get(axes[0].index)?)));
    rows.map(|(axes, row)| {
        let along = |of: fn(&ReadingResidual) -> f64| {
            let read = |c: usize| axes.iter().find(|r| r.component == c);
            std::array::from_fn(|c| read(c).map_or(0.0, |r| of(r)))
        };
        Position {
            row: axes[0].row,
            pose_deg: row.pose_deg.clone(),
            before_mm: along(|r| r.measured - r.before),
            after_mm: along(|r| r.measured - r.after),
            kept_out_mm: along(|r| r.held_out.unwrap_or_default() * r.sigma),
        }
    })
    .collect()
}

fn step(stage: &Stage) -> Step {
    let Stage { added, fitted_median_mm, median_mm, mean_mm, max_mm, .. } = stage;
    Step {
        added: added.clone(),
        fitted_median: *fitted_median_mm,
        median: *median_mm,
        mean: *mean_mm,
        max: *max_mm,
    }
}

fn found(finding: &Finding) -> Found {
    let word = |name: &str, e: &Estimate| word_of(&finding.effect, name, e.value);
    let named = |(name, estimates): &(String, Vec<Estimate>)| -> Vec<Ranged> {
        // a parameter that is a word is part of the label
        if estimates.iter().any(|e| word(name, e).is_some()) {
            return Vec::new();
        }
        let axis = |i: usize| if estimates.len() > 1 { format!("{name} [{i}]") } else { name.clone() };
        estimates.iter().enumerate().map(|(i, e)| ranged(axis(i), e)).collect()
    };
    let words: Vec<&str> =
        finding.parameters.iter().filter_map(|(name, estimates)| word(name, estimates.first()?)).collect();
    Found {
        label: words.iter().fold(finding.label(), |label, word| format!("{label} ({word})")),
        parameters: finding.parameters.iter().flat_map(named).collect(),
        like: finding.indistinguishable_from.iter().map(|(effect, at)| format!("{effect}@{at}")).collect(),
    }
}

fn ranged(name: String, estimate: &Estimate) -> Ranged {
    Ranged { name, value: estimate.value, low: estimate.low, high: estimate.high }
}

fn test(test: &NextTest) -> Test {
    let mut words = format!("{}: {}", test.kind, test.description);
    if let Some(joint) = &test.joint {
        words.push_str(&format!(" of {joint}"));
    }
    if let Some(pose) = &test.pose_deg {
        let rounded: Vec<f64> = pose.iter().map(|a| (10.0 * a).round() / 10.0).collect();
        words.push_str(&format!(" at pose {}", pose_signs(&test.joints, &rounded)));
    }
    if test.payload_kg > 0.0 {
        words.push_str(&format!(", payload {} kg", shortest(test.payload_kg)));
    }
    if test.force_n.iter().any(|f| *f != 0.0) {
        let force: Vec<String> = test.force_n.iter().map(|f| shortest(*f)).collect();
        words.push_str(&format!(", tip force {} N", force.join(", ")));
    }
    Test {
        words,
        separates: test.separates.clone(),
        expected_sigmas: test.expected_sigmas,
        readings_needed: test.readings_needed,
    }
}

fn facts(campaign: &Campaign, outcome: &Outcome) -> Vec<(String, String)> {
    let named = |name: &str, value: String| (name.to_string(), value);
    let mut out = vec![
        named("arm", campaign.arm.name.clone()),
        named("static rows", campaign.statics.len().to_string()),
        named("modal rows", campaign.modal.len().to_string()),
        named("wind-up rows", campaign.windup.len().to_string()),
        named("position rows", campaign.positions.len().to_string()),
        named("rows of records", campaign.records.iter().map(|r| r.t_s.len()).sum::<usize>().to_string()),
        named("verdict", outcome.verdict.word().to_string()),
        named("tool version", env!("CARGO_PKG_VERSION").into()),
        named("blake3 of the campaign", outcome.hash.clone()),
    ];
    if let Some(fit) = &outcome.lack_of_fit {
        out.push(named(
            "squares per degree of freedom",
            crate::report::number::significant(fit.chi2_per_dof, 3),
        ));
    }
    out
}
