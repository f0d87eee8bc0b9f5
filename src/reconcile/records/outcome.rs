//! Verdict from records against time: named effects, calibrated stiffnesses and the corrected arm.

use super::compliance::GRAVITY_OR_ERROR;
use super::curve::TORSION_CURVE;
use super::judge::judge;
use super::twist::Group;
use crate::arm::effect::entry::Effect;
use crate::arm::effect::kind::Place;
use crate::arm::effect::{
    connection_compliance, hysteresis, joint_compliance, lost_motion, soft_windup, time_shift,
    transmission_error,
};
use crate::arm::{Arm, Element};
use crate::reconcile::fit::held_out::HeldOut;
use crate::reconcile::fit::noise::Noise;
use crate::reconcile::model::direct::subject;
use crate::reconcile::model::estimate::{Estimate, Finding};
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::verdict::correct::provenance;
use crate::reconcile::verdict::files::CORRECTED_FILE;
use crate::reconcile::verdict::joint_record::{JointRecord, State, Stated};
use crate::reconcile::verdict::outcome::{Calibrated, Located, NextTest, Outcome, Verdict};
use serde_json::json;

/// A joint is explained if the root mean square error of its twist on held-out blocks is at most this fraction of the
/// error of a fit by an offset and the time shift alone. Its square is then at most 2.5 % of the square of that error.
const LEFT: f64 = 0.158;
/// A joint is also explained if the root mean square error of its twist on held-out blocks is at most this many times
/// the noise of the averaged twist. The model is fitted to averages over a window of rows, so its errors are compared
/// with their noise.
const NOISY: f64 = 1.5;
/// A joint whose recorded twist is mostly a time shift is also explained if the root mean square error of its twist on
/// held-out blocks is at most this angle \[rad\], 20 seconds of arc. Encoders at the output are not more accurate. The
/// error must also be at most the fraction [`LEFT`] of the error of a fit by an offset alone.
const ENCODER_RAD: f64 = 1e-4;
/// A wrong unit is suspected if a joint is too stiff by about its gear ratio, or by about 57.3, the degrees of a
/// radian. "About" means that the natural logarithms of the factors differ by less than this.
const NEAR: f64 = 0.25;
/// Effects that change how far a joint twists under torque. If displacements, frequencies, bench readings or positions
/// name one of these effects at a joint, the records add none of them at this joint.
const OF_TWIST: [&str; 5] = [
    joint_compliance::KIND.name,
    connection_compliance::KIND.name,
    soft_windup::KIND.name,
    lost_motion::KIND.name,
    hysteresis::KIND.name,
];

/// How the recorded stiffness of a joint compares with the nominal stiffness. At most one of `finding` and
/// `calibrated` is present.
struct Stiffness {
    finding: Option<Finding>,
    calibrated: Option<Calibrated>,
    /// Factor by which the nominal stiffness is multiplied in the corrected arm; `None` if the nominal stiffness
    /// stays.
    factor: Option<f64>,
    /// Sentence on a joint that is stiffer than the tolerance allows; `None` otherwise.
    remark: Option<String>,
}

/// Reconciles the records of a campaign with its arm, and reaches the verdict. Readings other than records are not
/// used.
pub(crate) fn reconcile(campaign: &Campaign) -> Outcome {
    let joints: Vec<JointRecord> =
        campaign.driven_joint_names().iter().filter_map(|joint| judge(&campaign.records, joint)).collect();
    let stiffnesses: Vec<Stiffness> = joints.iter().map(|j| stiffness(campaign, j)).collect();
    let mut findings: Vec<Finding> = Vec::new();
    for (joint, stiffness) in joints.iter().zip(&stiffnesses) {
        findings.extend(named(joint));
        findings.extend(stiffness.finding.clone());
    }
    let (verdict, mut reasons) = verdict(&joints, &findings, &stiffnesses);
    reasons.extend(stiffnesses.iter().filter_map(|s| s.remark.clone()));
    reasons.extend(campaign.records.iter().flat_map(|r| r.remarks.clone()));
    reasons.extend(joints.iter().flat_map(|j| j.remarks.iter().map(|r| format!("{}: {r}", j.joint))));
    let (effects, suspects) = verdict.named_and_suspected(findings.clone(), Vec::new());
    let calibrated: Vec<Calibrated> = stiffnesses.iter().filter_map(|s| s.calibrated.clone()).collect();
    let sources = calibrated.iter().map(|c| {
        json!({"value": c.name, "factor": c.factor.value, "low": c.factor.low, "high": c.factor.high, "source": "record against time"})
    });
    let provenance = provenance(campaign, verdict, sources.collect());
    Outcome {
        campaign: campaign.statement.name.clone(),
        hash: campaign.hash.clone(),
        verdict,
        reasons,
        effects,
        suspects,
        held_out: held_out(&joints),
        located: located(&joints),
        next_tests: next_tests(&joints),
        noise: Noise { scale: [1.0; 3], outliers: Vec::new() },
        lack_of_fit: None,
        calibrated,
        evidence: Vec::new(),
        stages: Vec::new(),
        residuals: Vec::new(),
        corrected: corrected(campaign, &findings, &joints, &stiffnesses),
        other_corrected: campaign.other_arms.clone(),
        provenance,
        records: joints,
        empirical: Vec::new(),
        models: Vec::new(),
    }
}

/// Whether the model explains the twist of a joint: the error on held-out blocks is noise or a small part of the twist,
/// and no cause outside the library explains the twist better.
fn is_explained(joint: &JointRecord) -> bool {
    if joint.unnamed.is_some() {
        return false;
    }
    let of_encoders = ENCODER_RAD.min(LEFT * joint.before_rad);
    joint.after_rad <= (LEFT * joint.unshifted_rad).max(NOISY * joint.averaged_noise_rad).max(of_encoders)
}

/// Whether the joint is explained and the records leave no question about it open. Only the results of such joints
/// enter the corrected arm.
fn is_settled(joint: &JointRecord) -> bool {
    is_explained(joint) && joint.undecided.is_empty()
}

/// End of a sentence on the error of the twist of a joint: it says that this error is more than noise. Empty if the
/// error is only noise.
fn left_beyond_noise(joint: &JointRecord) -> String {
    match joint.after_rad > NOISY * joint.averaged_noise_rad {
        true => format!(
            ", of which noise explains {:.4}: little is left, but not only noise",
            1e3 * joint.averaged_noise_rad
        ),
        false => String::new(),
    }
}

/// Sentence on a joint at which no effect was found.
fn no_gap(joint: &JointRecord) -> String {
    format!(
        "{}: the nominal joint within its tolerance explains the records: {:.4} of {:.4} mrad of the twist are left on held-out \
         blocks{}",
        joint.joint,
        1e3 * joint.after_rad,
        1e3 * joint.before_rad,
        left_beyond_noise(joint)
    )
}

/// The verdict from the results for all joints, with sentences that give the reasons.
fn verdict(
    joints: &[JointRecord],
    findings: &[Finding],
    stiffnesses: &[Stiffness],
) -> (Verdict, Vec<String>) {
    if joints.is_empty() {
        let text = "no joint of the records could be judged: nothing moves, or nearly all rows stand at gaps in time";
        return (Verdict::InsufficientData, vec![text.into()]);
    }
    let open: Vec<&JointRecord> = joints.iter().filter(|j| !is_explained(j)).collect();
    if !open.is_empty() {
        let left = open.iter().map(|j| match &j.unnamed {
            Some(cause) => format!("{}: {cause}", j.joint),
            None => format!(
                "{}: {:.4} of {:.4} mrad of the twist are left on held-out blocks{}, of which noise explains {:.4} mrad",
                j.joint,
                1e3 * j.after_rad,
                1e3 * j.unshifted_rad,
                if j.unshifted_rad < j.before_rad { " after the time shift" } else { "" },
                1e3 * j.averaged_noise_rad
            ),
        });
        return (Verdict::Unexplained, left.collect());
    }
    let undecided = joints.iter().flat_map(|j| j.undecided.iter().map(|why| format!("{}: {why}", j.joint)));
    let undecided: Vec<String> = undecided.collect();
    if !undecided.is_empty() {
        return (Verdict::InsufficientData, undecided);
    }
    if stiffnesses.iter().any(|s| s.remark.is_some()) {
        let text = "no effect of the library explains a joint that is stiffer than its nominal one";
        return (Verdict::Unexplained, vec![text.into()]);
    }
    if !findings.is_empty() {
        let fall = joints.iter().map(|j| {
            format!(
                "{}: on held-out blocks the error of the twist falls from {:.4} to {:.4} mrad{}",
                j.joint,
                1e3 * j.before_rad,
                1e3 * j.after_rad,
                left_beyond_noise(j)
            )
        });
        return (Verdict::Explained, fall.collect());
    }
    (Verdict::NoGap, joints.iter().map(no_gap).collect())
}

/// Effects of the library that the records show at a joint, as findings. The compliance of the joint is not among them;
/// [`stiffness`] compares it with the nominal one.
fn named(joint: &JointRecord) -> Vec<Finding> {
    let like = |what: &str| -> Vec<(String, String)> {
        // gravity on a compliance gives the same twist as a transmission error once a turn, if no other joint changes
        // the torque
        let is_alike = joint
            .of("compliance")
            .is_some_and(|s| s.state == State::Found || s.words.starts_with(GRAVITY_OR_ERROR));
        match what == transmission_error::KIND.name && is_alike {
            true => vec![(connection_compliance::KIND.name.into(), joint.joint.clone())],
            false => Vec::new(),
        }
    };
    let of = |what: &str, effect: &str, keep: &[&str]| {
        let stated = joint.found(what)?;
        let parameters = stated.parameters.iter().filter(|(name, _)| keep.contains(&name.as_str()));
        Some(Finding {
            effect: effect.into(),
            at: joint.joint.clone(),
            parameters: parameters.cloned().collect(),
            indistinguishable_from: like(effect),
        })
    };
    const CURVE: [&str; 5] = ["k1_nm_per_rad", "k2_nm_per_rad", "k3_nm_per_rad", "t1_nm", "t2_nm"];
    [
        of(Group::Shift.what(), time_shift::KIND.name, &["seconds"]),
        of(TORSION_CURVE, soft_windup::KIND.name, &CURVE),
        of(hysteresis::KIND.name, hysteresis::KIND.name, &["half_width_rad"]),
        of(lost_motion::KIND.name, lost_motion::KIND.name, &["half_width_rad", "torque_nm"]),
        of(Group::Output.what(), transmission_error::KIND.name, &["sin_cos_sin2_cos2_rad"]),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Compares the recorded stiffness of a joint with the nominal stiffness. If the joint is certainly more compliant than
/// the tolerance allows, the result is an effect. Otherwise the result is a factor on the stiffness (calibration), with
/// a remark if the joint is certainly stiffer than the tolerance allows. Nothing is compared if the compliance is not
/// identified, or if a torsion curve was found.
fn stiffness(campaign: &Campaign, joint: &JointRecord) -> Stiffness {
    let nothing = Stiffness { finding: None, calibrated: None, factor: None, remark: None };
    // a torsion curve that was found replaces the single stiffness
    if joint.found(TORSION_CURVE).is_some() {
        return nothing;
    }
    let Some(measured) = joint.found("compliance").and_then(|s| Some(s.parameters.first()?.1[0])) else {
        return nothing;
    };
    let torque_nm = joint.trace.iter().fold(0.0f64, |m, t| m.max(t.torque_nm.abs()));
    let nominal_rad_per_nm = nominal_compliance(campaign, &joint.joint, torque_nm);
    let finding = |effect: &str, value: Estimate| Finding {
        effect: effect.into(),
        at: joint.joint.clone(),
        parameters: vec![("stiffness_nm_per_rad".into(), vec![value])],
        indistinguishable_from: Vec::new(),
    };
    if nominal_rad_per_nm <= 0.0 {
        return Stiffness { finding: Some(finding(joint_compliance::KIND.name, measured)), ..nothing };
    }
    let factor = |k: f64| k * nominal_rad_per_nm;
    let ends = (factor(measured.low.unwrap_or(0.0)), factor(measured.high.unwrap_or(f64::INFINITY)));
    let tolerance = campaign.statement.tolerance.joint_stiffness;
    if ends.1 < 1.0 - tolerance {
        let series = |k: f64| 1.0 / (1.0 / k - nominal_rad_per_nm);
        let value = Estimate {
            value: series(measured.value),
            low: measured.low.map(series),
            high: measured.high.map(series),
        };
        return Stiffness { finding: Some(finding(connection_compliance::KIND.name, value)), ..nothing };
    }
    let own = Estimate {
        value: factor(measured.value),
        low: measured.low.map(factor),
        high: measured.high.map(factor),
    };
    let spread = 0.25 * libm::log(ends.1 / ends.0.max(1e-9));
    let calibrated = Calibrated {
        name: format!("{}.stiffness", joint.joint),
        factor: own,
        learnt: (2.0 * spread / tolerance.max(1e-9)).min(1.0),
    };
    let remark = (ends.0 > 1.0 + tolerance).then(|| {
        format!(
            "{} is {:.2} times as stiff as its nominal joint ({:.2} to {:.2}), beyond the tolerance of {:.0} %",
            joint.joint,
            own.value,
            ends.0,
            ends.1,
            100.0 * tolerance
        )
    });
    let hint = remark.is_some().then(|| stiff_by_unit(campaign, &joint.joint, own.value)).flatten();
    let remark = remark.map(|r| r + hint.as_deref().unwrap_or_default());
    // a joint that no effect explains keeps its nominal stiffness in the corrected arm
    let factor = remark.is_none().then_some(own.value);
    Stiffness { calibrated: Some(calibrated), factor, remark, finding: None }
}

/// Hint at a wrong unit of torques or angles, if the stiffness of the joint is about its gear ratio or about 57.3 (the
/// degrees of a radian) times the nominal one. `factor` is the stiffness over the nominal stiffness. If both causes are
/// near, the nearer one is named; `None` if neither is.
fn stiff_by_unit(campaign: &Campaign, joint: &str, factor: f64) -> Option<String> {
    let own = campaign.records.iter().flat_map(|r| &r.joints).find(|j| j.joint == joint);
    let of_ratio = own.and_then(|j| j.ratio).filter(|n| *n > 2.0).map(|ratio| {
        let words = format!(
            "; this is about its ratio of {ratio}: if the torque is at the output, state \"torque_at\": \"output\""
        );
        (ratio, words)
    });
    let of_radians = "; this is about 57.3: angles must be in degrees, and these may be in radians";
    nearest_cause(factor, of_ratio.into_iter().chain([(1f64.to_degrees(), of_radians.into())]))
}

/// Words of the cause whose factor is nearest to `factor`. Each cause is the factor that it produces and its words.
/// Distances are measured in natural logarithms. `None` if the nearest cause is not within [`NEAR`].
fn nearest_cause(factor: f64, causes: impl Iterator<Item = (f64, String)>) -> Option<String> {
    let off = |by: f64| libm::log(factor / by).abs();
    let nearest = causes.min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
    (off(nearest.0) < NEAR).then_some(nearest.1)
}

/// Compliance of the nominal joint, including effects that the arm file states, as twist divided by torque at the
/// torque `torque_nm` \[N m\] (secant) \[rad/(N m)\]. 0 if there is no such joint.
fn nominal_compliance(campaign: &Campaign, joint: &str, torque_nm: f64) -> f64 {
    let mut subject = subject(&campaign.arm, &campaign.statement);
    let law = subject.structure.joint_mut(joint).map(|j| j.law);
    law.map_or(0.0, |law| law.angle_rad(torque_nm) / torque_nm.max(1e-9))
}

/// The corrected arm. It has the effects and the calibrated stiffness of each joint that is settled, even if other
/// joints are not explained.
fn corrected(
    campaign: &Campaign,
    findings: &[Finding],
    joints: &[JointRecord],
    stiffnesses: &[Stiffness],
) -> Arm {
    let mut arm = campaign.arm.clone();
    for (joint, stiffness) in joints.iter().zip(stiffnesses) {
        let Some(factor) = stiffness.factor.filter(|_| is_settled(joint)) else { continue };
        for element in &mut arm.chain {
            if let Element::Joint(own) = element
                && own.name == joint.joint
            {
                own.curve = own.curve.stiffened(factor);
            }
        }
    }
    let explained = |f: &&Finding| joints.iter().any(|j| j.joint == f.at && is_settled(j));
    arm.effects.extend(findings.iter().filter(explained).filter_map(|f| as_effect(campaign, f)));
    arm
}

/// The finding as an entry of the arm file. `None` for an effect that cannot be at a joint. The time shift is one: it
/// belongs to the record and not to the arm.
fn as_effect(campaign: &Campaign, finding: &Finding) -> Option<Effect> {
    let kind = crate::arm::effect::catalogue::kind(&finding.effect)?;
    if !kind.places.contains(&Place::Joint) {
        return None;
    }
    let source = json!({"campaign": campaign.statement.name, "campaign_blake3": campaign.hash, "reading": "record against time"});
    Some(finding.as_effect(source))
}

/// Root mean square error of the twist on held-out blocks, of a fit by an offset alone (before) and of the last fit
/// (after), over all joints. The errors of each joint are divided by the noise of its averaged twist, so the results
/// have no unit. Joints are weighted by their number of rows. `None` if there are no rows.
fn held_out(joints: &[JointRecord]) -> Option<HeldOut> {
    let count: usize = joints.iter().map(|j| j.rows).sum();
    let mean = |of: fn(&JointRecord) -> f64| {
        let sum: f64 =
            joints.iter().map(|j| j.rows as f64 * (of(j) / j.averaged_noise_rad.max(1e-12)).powi(2)).sum();
        (sum / count as f64).sqrt()
    };
    let after = mean(|j| j.after_rad);
    (count > 0).then(|| HeldOut {
        rms_before: mean(|j| j.before_rad),
        rms_after: after,
        rms_declared_after: after,
        count,
    })
}

/// Errors before and after the fit, for all joints together and for each joint, as multiples of the noise.
fn located(joints: &[JointRecord]) -> Vec<Located> {
    let all = held_out(joints).map(|h| Located {
        part: "record".into(),
        count: h.count,
        rms_before: h.rms_before,
        rms_after: h.rms_after,
    });
    let each = joints.iter().map(|j| Located {
        part: format!("record, {}", j.joint),
        count: j.rows,
        rms_before: j.before_rad / j.averaged_noise_rad.max(1e-12),
        rms_after: j.after_rad / j.averaged_noise_rad.max(1e-12),
    });
    all.into_iter().chain(each).collect()
}

/// Recommends tests for joints whose compliance is not identified, at most one test for each of three cases. In the
/// first two, the torque is nearly all acceleration and friction of the joint itself, and the rotor's inertia is not
/// stated or is stated. In the third, a transmission error explains the same twist as the compliance.
fn next_tests(joints: &[JointRecord]) -> Vec<NextTest> {
    let named = |start: &str, wanted: fn(&JointRecord) -> bool| -> Vec<&str> {
        let has = |j: &&JointRecord| {
            j.of("compliance").is_some_and(|s: &Stated| s.state != State::Found && s.words.starts_with(start))
        };
        joints.iter().filter(has).filter(|j| wanted(j)).map(|j| j.joint.as_str()).collect()
    };
    let tests = [
        (
            named("insufficient excitation", |j| !j.rotor_is_stated),
            "state rotor_inertia_kgm2, or load the joint with its output locked",
        ),
        (named("insufficient excitation", |j| j.rotor_is_stated), "load the joint with its output locked"),
        (
            named(GRAVITY_OR_ERROR, |_| true),
            "state rotor_inertia_kgm2, or move with another payload or pose, so that gravity differs at the same angle",
        ),
    ];
    let asked = tests.iter().filter(|(names, _)| !names.is_empty());
    asked
        .map(|(names, what)| NextTest::of_another_kind(format!("compliance of {}: {what}", names.join(", "))))
        .collect()
}

/// Joins the outcome of the records, `records`, with the outcome of the other readings, `other`. Each was judged
/// without the other, and the common verdict is the less favourable of the two. Effects of the records are added to the
/// corrected arm only if the common verdict is `Explained`.
pub(crate) fn joined(mut other: Outcome, records: Outcome) -> Outcome {
    let verdict = Verdict::on_all(&[other.verdict, records.verdict]);
    let words = |what: &str, outcome: &Outcome| -> Vec<String> {
        outcome.reasons.iter().map(|r| format!("{what}: {r}")).collect()
    };
    let mut reasons = [words("the other readings", &other), words("the records", &records)].concat();
    reasons.push(
        "records and other readings are each judged by itself, and the verdict is the less favourable one"
            .into(),
    );
    let known: Vec<Finding> = [other.effects.as_slice(), &other.suspects].concat();
    let is_told = |at: &str| known.iter().any(|f| f.at == at && OF_TWIST.contains(&f.effect.as_str()));
    let is_new = |f: &&Finding| !(OF_TWIST.contains(&f.effect.as_str()) && is_told(&f.at));
    let new: Vec<Finding> = records.effects.iter().filter(is_new).cloned().collect();
    for at in records.effects.iter().filter(|f| !is_new(f)).map(Finding::label) {
        reasons.push(format!("the records show {at}; the value of the other readings stands"));
    }
    let all = [other.effects, new.clone()].concat();
    (other.effects, other.suspects) = verdict.named_and_suspected(all, other.suspects);
    if verdict == Verdict::Explained {
        let added = records
            .corrected
            .effects
            .iter()
            .filter(|e| new.iter().any(|f| f.effect == e.effect && f.at == e.at));
        other.corrected.effects.extend(added.cloned());
    } else if records.verdict == Verdict::Explained {
        reasons.push(format!(
            "{CORRECTED_FILE} has nothing of the records, because the other readings are not explained"
        ));
    }
    other.verdict = verdict;
    other.reasons = reasons;
    other.located.extend(records.located);
    other.records = records.records;
    other
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hint_is_the_one_whose_factor_is_nearest() {
        let hint = |factor: f64, ratio: f64| {
            let causes = [(ratio, "ratio".to_string()), (1f64.to_degrees(), "radians".to_string())];
            nearest_cause(factor, causes.into_iter())
        };
        // the ratio of 50 is within the margin of 57 too, but 57.3 is nearer
        assert_eq!(hint(57.0, 50.0).as_deref(), Some("radians"));
        assert_eq!(hint(51.0, 50.0).as_deref(), Some("ratio"));
        assert_eq!(hint(3.0, 100.0), None);
    }
}
