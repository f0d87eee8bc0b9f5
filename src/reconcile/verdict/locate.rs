//! Locates the discrepancy between model and measurement: divides the readings by channel, branch, load, mode, joint
//! and pose.

use super::outcome::Located;
use crate::arm::effect::channel::Channel;
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::fit::held_out::rms;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::readings::campaign::Campaign;
use std::collections::HashMap;

/// Number of poses that are listed, those with the largest errors first.
pub(crate) const WORST_POSES: usize = 3;

/// Root mean square of the residuals of every part of the readings (such as a channel, a load, a mode) with
/// `baseline` and with `best` \[declared standard deviations\]. Gross errors are left out.
pub(crate) fn located(
    campaign: &Campaign,
    forward: &Forward,
    baseline: &Fit,
    best: &Fit,
    weights: &Weights,
) -> Vec<Located> {
    let mut parts: Vec<(String, Vec<usize>)> = Vec::new();
    let mut known: HashMap<String, usize> = HashMap::new();
    for i in 0..forward.data.len() {
        if weights.inverse[i] > 0.0 {
            for name in names(campaign, forward, i) {
                let part = *known.entry(name).or_insert_with_key(|name| {
                    parts.push((name.clone(), Vec::new()));
                    parts.len() - 1
                });
                parts[part].1.push(i);
            }
        }
    }
    let residual =
        |fit: &Fit, i: usize| (forward.data[i].value - fit.point.predicted[i]) / forward.data[i].sigma;
    let mut all: Vec<Located> = parts
        .into_iter()
        .map(|(part, list)| Located {
            count: list.len(),
            rms_before: rms(list.iter().map(|&i| residual(baseline, i))),
            rms_after: rms(list.iter().map(|&i| residual(best, i))),
            part,
        })
        .collect();
    let (mut poses, mut rest): (Vec<_>, Vec<_>) = all.drain(..).partition(|l| l.part.starts_with("pose"));
    poses.sort_by(|a, b| b.rms_before.total_cmp(&a.rms_before));
    rest.extend(poses.into_iter().take(WORST_POSES));
    rest
}

fn names(campaign: &Campaign, forward: &Forward, i: usize) -> Vec<String> {
    let datum = &forward.data[i];
    let mut out = vec![datum.channel.word().to_string()];
    match datum.channel {
        Channel::Static => {
            let row = &campaign.statics[datum.index];
            if !row.branch.is_empty() {
                out.push(format!("static, {}", row.branch));
            }
            out.push(if row.force_n.norm() > 0.0 {
                "static, tip force".into()
            } else {
                format!("static, payload {} kg", row.payload.mass_kg)
            });
        }
        Channel::Modal => {
            let row = &campaign.modal[i - forward.starts[1]];
            out.push(format!("modal, mode {}", row.mode));
            out.push(format!("modal, payload {} kg", row.payload.mass_kg));
        }
        _ => out.push(format!("windup, {}", campaign.windup[i - forward.starts[2]].joint)),
    }
    if let Some(pose) = forward.groups.get(datum.group) {
        out.push(format!("pose {pose} deg"));
    }
    out
}
