//! Reaches the verdict on a campaign of absolute positions.

use super::analysis::{Positions, analyze};
use super::angle_laws::Competing;
use super::drift;
use super::fitted::Fitted;
use super::intervals::{frame_parameters, reciprocal, stiffness, within};
use super::kinematics::Number;
use super::search::TIE;
use super::shape::Shape;
use super::structure::{MATERIAL_VARIANCE, mean_median_length};
use super::transmission;
use super::waves;
use crate::arm::effect::catalogue::kind;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::entry::Effect;
use crate::arm::effect::kind::ElasticRotation;
use crate::arm::{Arm, BASE};
use crate::reconcile::fit::held_out::{HeldOut, rms};
use crate::reconcile::fit::noise::{FEW, Noise, Outlier};
use crate::reconcile::model::estimate::{Estimate, Finding};
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::components::POSITION;
use crate::reconcile::readings::rows::PositionRow;
use crate::reconcile::select::lack_of_fit::LackOfFit;
use crate::reconcile::verdict::files::CORRECTED_FILE;
use crate::reconcile::verdict::judgement::{TOO_FAR_OFF, does_not_predict, too_many_alternatives};
use crate::reconcile::verdict::locate::WORST_POSES;
use crate::reconcile::verdict::outcome::{Calibrated, Evidence, Located, Outcome, ReadingResidual, Verdict};
use crate::reconcile::verdict::stage::Stage;
use crate::reconcile::verdict::{caution, correct};
use crate::report::number::significant;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::{HashMap, HashSet};

/// Smallest number of positions from which anything can be concluded.
pub(crate) const FEWEST_POSITIONS: usize = 20;
/// Largest ratio of the median error at held-out poses to the median error in the fit, or to the declared standard
/// deviation if that is larger. If the ratio is larger, the poses are too similar to determine everything that is
/// calibrated.
const UNSTABLE: f64 = 8.0;
/// Effects that do not explain everything are still written into the corrected arm if they lower the median error at
/// held-out poses to less than this fraction of the error with calibration alone.
const HELPFUL: f64 = 0.8;
/// Word for a session in the list of alternatives of an effect.
const SESSION: &str = "session";

/// Reconciles a campaign of absolute positions with its arms, and reaches the verdict.
pub(crate) fn reconcile(campaign: &Campaign) -> Outcome {
    let found = analyze(campaign);
    let lack_of_fit = found.lack_of_fit(campaign);
    // the model without each of its effects
    let without: Vec<Fitted> =
        (0..found.fitted.effects.len()).into_par_iter().map(|i| found.without_effect(i)).collect();
    let competitors: Vec<Vec<(usize, Fitted)>> =
        without.iter().enumerate().map(|(i, without)| found.competitors(i, without)).collect();
    let findings = found.findings(campaign, &without, &competitors);
    let adjusted = found.adjusted(&found.fitted);
    let offered = found.in_series();
    let (verdict, mut reasons) =
        found.verdict(campaign, &lack_of_fit, &findings, &adjusted, offered.as_ref());
    reasons.extend(found.remarks(campaign, &adjusted));
    let next_tests = found.next_tests(campaign, verdict, &lack_of_fit, &competitors);
    let helps = verdict == Verdict::Unexplained && found.helps(&findings);
    reasons.extend(helps.then(|| found.help_words()));
    let drifts: Vec<Finding> = findings.iter().filter(|f| f.effect == drift::EFFECT).cloned().collect();
    let (shown, in_arm) = match verdict == Verdict::Explained || helps {
        true => (&found.fitted, findings.as_slice()),
        // a drift is part of the calibration, as sessions are
        false => (&found.rigid, drifts.as_slice()),
    };
    let mut provenance = correct::provenance(campaign, verdict, found.calibrated(shown));
    let corrected = found.corrected_arms(campaign, shown, in_arm, &mut provenance);
    let (effects, suspects) =
        verdict.named_and_suspected(findings, offered.into_iter().map(|(finding, _)| finding).collect());
    let scale_mm = 1e3 * found.fitted.scale_m;
    let residuals = found.residuals(campaign);
    Outcome {
        campaign: campaign.statement.name.clone(),
        hash: campaign.hash.clone(),
        verdict,
        reasons,
        suspects,
        held_out: Some(found.confirmation(campaign)),
        located: located(campaign, &residuals),
        next_tests,
        noise: Noise {
            scale: [1.0; 3],
            outliers: (found.gross.iter())
                .map(|(row, mm)| Outlier { channel: Channel::Positions, row: *row, sigmas: mm / scale_mm })
                .collect(),
        },
        lack_of_fit: Some(lack_of_fit),
        calibrated: adjusted,
        evidence: found.evidence(),
        residuals,
        provenance,
        corrected: corrected[0].clone(),
        other_corrected: corrected[1..].to_vec(),
        stages: found.stages.clone(),
        records: Vec::new(),
        empirical: Vec::new(),
        models: Vec::new(),
        effects,
    }
}

impl Positions {
    /// Sentence on a corrected arm whose effects predict better but do not explain everything.
    fn help_words(&self) -> String {
        let [before, after] = self.before_and_after();
        format!(
            "{CORRECTED_FILE} has what predicts best, but not all that is missing: on poses held out of the fit the median error falls from {:.3} to {:.3} mm",
            before.median_mm, after.median_mm
        )
    }

    /// The arms of the campaign, calibrated as in the fit `shown` and with the effects `in_arm`. Their placements are
    /// added to `provenance`.
    fn corrected_arms(
        &self,
        campaign: &Campaign,
        shown: &Fitted,
        in_arm: &[Finding],
        provenance: &mut Value,
    ) -> Vec<Arm> {
        let corrected = |i: usize| {
            let mut arm = self.corrected(campaign, i, shown, in_arm, provenance);
            self.adjust(shown, &mut arm);
            arm
        };
        (0..campaign.arms().len()).map(corrected).collect()
    }

    /// Findings for all effects of the model. For each effect that is a candidate, `without` has the fit without it,
    /// and `competitors` the candidates that would fit as well in its place.
    fn findings(
        &self,
        campaign: &Campaign,
        without: &[Fitted],
        competitors: &[Vec<(usize, Fitted)>],
    ) -> Vec<Finding> {
        let compliant = without.iter().zip(competitors).enumerate();
        let compliant = compliant.map(|(i, (without, own))| {
            self.with_session_instead(campaign, without, self.finding(i, without, own))
        });
        let dependent = self.named_dependences.iter().map(|&k| self.dependence_finding(k));
        let uneven = self.transmissions.iter().map(|&joint| self.transmission_finding(joint));
        compliant.chain(dependent).chain(uneven).chain(self.drift_finding(campaign)).collect()
    }

    /// Sentences for the reader on sessions, on the rows on which effects were screened, on factors in `adjusted`
    /// beyond their tolerance, on zeros and geometry that moved far, on joints that hardly turned, and on another
    /// convention or too large standard deviations in the file.
    fn remarks(&self, campaign: &Campaign, adjusted: &[Calibrated]) -> Vec<String> {
        let mut out = self.session_sentences(campaign);
        out.extend(self.screening_sentence());
        out.extend(caution::beyond_tolerance(self.tolerances(), adjusted));
        out.extend(self.moved_zeros());
        out.extend(self.moved_geometry());
        out.extend(self.still_joints());
        out.extend(self.other_convention(campaign).into_iter().chain(self.too_careful(campaign)));
        out
    }

    /// Whether an arm with the effects `findings` is useful although something else is missing: it predicts held-out
    /// poses much better than calibration alone, and every effect is physically possible.
    fn helps(&self, findings: &[Finding]) -> bool {
        let [before, after] = self.before_and_after();
        let is_possible = |finding: &Finding| beyond_bounds(finding).is_none();
        after.median_mm < HELPFUL * before.median_mm && findings.iter().all(is_possible)
    }

    fn verdict(
        &self,
        campaign: &Campaign,
        left: &LackOfFit,
        findings: &[Finding],
        adjusted: &[Calibrated],
        offered: Option<&(Finding, String)>,
    ) -> (Verdict, Vec<String>) {
        if let Some(said) = self.not_described(campaign, left, findings) {
            return said;
        }
        let angle_laws = self.angle_laws();
        if let Some(text) = angle_laws.iter().find_map(Competing::better) {
            return (Verdict::Unexplained, vec![text]);
        }
        if let Some(text) = self.unsteady_drift().or_else(|| self.better_law(campaign)) {
            return (Verdict::Unexplained, vec![text]);
        }
        if let Some(said) = self.not_calibrated(campaign, findings, adjusted, offered) {
            return said;
        }
        if findings.is_empty() {
            let text = "noise and the calibration of everything that is free explain every position";
            return (Verdict::NoGap, vec![text.into()]);
        }
        if let Some(text) = self.undecided(findings) {
            return (Verdict::InsufficientData, vec![text]);
        }
        let [before, after] = self.before_and_after();
        let mut reasons = vec![format!(
            "on poses held out of the fit the median error falls from {:.3} to {:.3} mm",
            before.median_mm, after.median_mm
        )];
        if left.chi2_per_dof > MATERIAL_VARIANCE {
            reasons.extend(self.left_over(left));
        }
        reasons.extend(angle_laws.iter().filter_map(Competing::as_good));
        (Verdict::Explained, reasons)
    }

    /// Verdict and reasons if the model does not describe the positions: there are too few positions, or the errors are
    /// too large, or too many positions are gross errors, or an effect is physically impossible. Otherwise `None`.
    fn not_described(
        &self,
        campaign: &Campaign,
        left: &LackOfFit,
        findings: &[Finding],
    ) -> Option<(Verdict, Vec<String>)> {
        let count = campaign.positions.len();
        if count < FEWEST_POSITIONS {
            let text = format!("{count} positions are too few: give at least {FEWEST_POSITIONS}");
            return Some((Verdict::InsufficientData, vec![text]));
        }
        let excess = left.chi2_per_dof > MATERIAL_VARIANCE;
        if left.fails || (findings.is_empty() && excess) || left.chi2_per_dof.sqrt() > TOO_FAR_OFF {
            return Some((Verdict::Unexplained, self.left_over(left)));
        }
        if self.gross.len() as f64 > FEW * count as f64 {
            let text = format!(
                "{} of {count} positions would be gross errors: so many are a structure that the model lacks",
                self.gross.len()
            );
            return Some((Verdict::Unexplained, vec![text]));
        }
        findings.iter().find_map(beyond_bounds).map(|text| (Verdict::Unexplained, vec![text]))
    }

    /// Verdict and reasons if the calibration cannot be right: the poses do not determine it, a factor is rare among
    /// faultless parts, or the geometry is far from the arm file. Otherwise `None`. `offered` is the compliance that may
    /// take the place of the rare factors.
    fn not_calibrated(
        &self,
        campaign: &Campaign,
        findings: &[Finding],
        adjusted: &[Calibrated],
        offered: Option<&(Finding, String)>,
    ) -> Option<(Verdict, Vec<String>)> {
        let last = &self.stages[self.stages.len() - 1];
        if last.median_mm > UNSTABLE * last.fitted_median_mm.max(campaign.positions[0].sigma_mm()) {
            let text = format!(
                "the median error is {:.3} mm for poses held out of the fit and {:.3} mm for those in it: the poses are too \
                 similar to calibrate everything that is free; turn every joint through more of its range, or free less",
                last.median_mm, last.fitted_median_mm
            );
            return Some((Verdict::InsufficientData, vec![text]));
        }
        if let Some((_, text)) = offered {
            return Some((Verdict::InsufficientData, vec![text.clone()]));
        }
        let named = findings.iter().map(Finding::label).collect::<Vec<_>>().join(" + ");
        if let Some(text) = caution::impossible_calibration(campaign, &named, self.tolerances(), adjusted) {
            return Some((Verdict::Unexplained, vec![text]));
        }
        let text = "the positions fit only an arm that is far from the arm file: check the unit of the positions, and the \
                    lengths and axes in the arm file";
        self.has_far_geometry().then(|| (Verdict::InsufficientData, vec![text.into()]))
    }

    /// Sentence with the reason why the effects `findings` cannot be named although they fit; `None` if they can be
    /// named.
    fn undecided(&self, findings: &[Finding]) -> Option<String> {
        let crowded = |f: &Finding| too_many_alternatives(&f.label(), f.indistinguishable_from.len());
        if let Some(text) = findings.iter().find_map(crowded) {
            return Some(text);
        }
        if let Some(finding) = findings.iter().find(|finding| finding.is_within_its_deviation()) {
            return Some(format!(
                "{} is smaller than its own standard deviation: it is a suspect and no finding",
                finding.label()
            ));
        }
        let [before, after] = self.before_and_after();
        if after.median_mm > before.median_mm {
            let labels: Vec<String> = findings.iter().map(Finding::label).collect();
            let [after, before] =
                [after, before].map(|stage| format!("a median error of {:.3} mm", stage.median_mm));
            return Some(does_not_predict(&labels.join(" + "), &after, &before));
        }
        let jumps = self.large_jumps();
        (!jumps.is_empty()).then(|| {
            format!(
                "the measured points jump by {} and nobody declared it: state positions.sessions in campaign.json if \
                 something was moved there; if not, something that this model lacks changes at that row",
                jumps.join(", ")
            )
        })
    }

    /// Adds to the alternatives of the finding `finding` the session that would explain the readings as well, if there
    /// is one. `without` is the fit without this effect.
    fn with_session_instead(&self, campaign: &Campaign, without: &Fitted, mut finding: Finding) -> Finding {
        let row = self.session_instead(campaign, without, TIE);
        finding.indistinguishable_from.extend(row.map(|row| (SESSION.into(), format!("before row {row}"))));
        finding
    }

    /// Sentences on the structure that is left in the errors of the best model. They name no effect.
    fn left_over(&self, left: &LackOfFit) -> Vec<String> {
        let mut out = vec![format!(
            "the best model leaves {:.2} times the declared standard deviation",
            left.chi2_per_dof.sqrt()
        )];
        let telling = left.structures.iter().filter(|s| s.ln_p < libm::log(1e-6f64)).take(3);
        out.extend(telling.map(|s| {
            format!("{}: {:.0} % of the remaining sum of squares", s.sentence(), 100.0 * self.part(s))
        }));
        if out.len() == 1 {
            out.push("the remaining errors follow neither order, angles, torques nor payload".into());
        }
        out
    }

    /// Two rows of the table of position errors: the last one without effects, and the last one with all effects.
    fn before_and_after(&self) -> [&Stage; 2] {
        let calibration = self.stages.iter().rposition(|s| !s.added.contains('@')).unwrap_or_default();
        [&self.stages[calibration], &self.stages[self.stages.len() - 1]]
    }

    fn confirmation(&self, campaign: &Campaign) -> HeldOut {
        let scale_mm = 1e3 * self.fitted.scale_m;
        let sigma_mm = campaign.positions.first().map_or(1.0, PositionRow::sigma_mm);
        let usual = mean_median_length(&self.samples);
        let [before, after] = self.before_and_after();
        HeldOut {
            rms_before: before.median_mm / scale_mm / usual,
            rms_after: after.median_mm / scale_mm / usual,
            rms_declared_after: after.median_mm / sigma_mm / usual,
            count: campaign.positions.len(),
        }
    }

    pub(super) fn finding(&self, i: usize, without: &Fitted, competitors: &[(usize, Fitted)]) -> Finding {
        let candidate = &self.candidates[self.fitted.effects[i]];
        let (c, reaches) = (&self.fitted.compliances[i], self.reaches(i));
        let parameters = match candidate.rotation {
            _ if candidate.shape != Shape::Spring => self.shape_parameters(i),
            ElasticRotation::Frame => frame_parameters(c, &reaches),
            ElasticRotation::AboutAxis | ElasticRotation::Tilt => {
                vec![("stiffness_nm_per_rad".into(), vec![stiffness(c[0], reaches[0])])]
            }
        };
        let names = competitors.iter().map(|(r, _)| &self.candidates[*r]);
        let springs = names.map(|r| (r.effect.to_string(), r.at.clone()));
        Finding {
            effect: candidate.effect.into(),
            at: candidate.at.clone(),
            parameters,
            indistinguishable_from: springs
                .chain(self.dependences_instead(without))
                .chain(self.transmissions_instead(i, without))
                .collect(),
        }
    }

    /// Parameters, with their intervals, of effect number `i` of the model, which is no spring.
    fn shape_parameters(&self, i: usize) -> Vec<(String, Vec<Estimate>)> {
        let shape = self.candidates[self.fitted.effects[i]].shape;
        if let Some(waves) = waves::of(shape) {
            return self.wave_parameters(i, waves);
        }
        let Some([size, threshold]) = self.profile(i) else { return Vec::new() };
        match shape {
            Shape::Lift(_) => vec![
                ("stiffness_nm_per_rad".into(), vec![reciprocal(size)]),
                ("preload_nm".into(), vec![threshold]),
            ],
            _ => vec![("half_width_rad".into(), vec![size]), ("torque_nm".into(), vec![threshold])],
        }
    }

    fn transmission_finding(&self, joint: usize) -> Finding {
        let fitted = self.numbers.iter().zip(&self.fitted.moved).enumerate();
        let own = fitted.filter(|(_, (n, _))| matches!(n, Number::Transmission(j, _) if *j == joint));
        let named = |j: usize| (transmission::EFFECT.to_string(), self.tree.driven[j].clone());
        let (effect, at) = named(joint);
        Finding {
            effect,
            at,
            parameters: vec![(
                "sin_cos_sin2_cos2_rad".into(),
                own.map(|(at, (_, value))| within(*value, self.reach(&[(at, 1.0)]))).collect(),
            )],
            indistinguishable_from: self
                .transmission_competitors(joint)
                .into_iter()
                .map(named)
                .chain(self.waves_instead(joint))
                .collect(),
        }
    }

    /// The arm with the index `arm`, with the geometry of the fit `shown` and with those of the `effects` that belong
    /// to this arm. Its placement is written into `provenance`.
    pub(crate) fn corrected(
        &self,
        campaign: &Campaign,
        arm: usize,
        shown: &Fitted,
        effects: &[Finding],
        provenance: &mut Value,
    ) -> Arm {
        let mut out = campaign.arms()[arm].clone();
        let mut geometry = shown.geometry.clone();
        geometry.relevel();
        let turned = geometry.write_into(arm, &mut out);
        let names: Vec<String> = out.chain.iter().map(|e| e.name().to_string()).collect();
        let own = effects
            .iter()
            .filter(|f| [BASE, Channel::Positions.word()].contains(&f.at.as_str()) || names.contains(&f.at));
        out.effects.extend(own.map(|f| as_effect(campaign, f)));
        let placement = self.placement(campaign, arm, shown, turned).to_json();
        match arm {
            0 => provenance["placement"] = placement,
            _ => provenance["other_placements"][&out.name] = placement,
        }
        out
    }

    /// The calibrated numbers of the fit `shown`, as JSON: changes of the geometry without placements, and factors
    /// within tolerance.
    fn calibrated(&self, shown: &Fitted) -> Vec<Value> {
        let numbers = self.numbers.iter().zip(&shown.moved);
        let inside = numbers.filter(|(n, _)| {
            matches!(
                n,
                Number::Zero(_)
                    | Number::Axis(..)
                    | Number::Vector(..)
                    | Number::Ratio(..)
                    | Number::Gravity(_)
            )
        });
        let geometry = inside.map(
            |(n, moved)| json!({"value": self.name(n), "moved": moved, "source": "calibrated geometry"}),
        );
        let parts = self.adjusted(shown).into_iter().map(|c| {
            json!({
                "value": c.name, "factor": c.factor.value, "low": c.factor.low, "high": c.factor.high,
                "source": "calibrated within tolerance",
            })
        });
        geometry.chain(parts).collect()
    }

    fn name(&self, number: &Number) -> String {
        let piece = |i: usize| self.tree.pieces[i].name().to_string();
        match number {
            Number::Zero(j) => format!("{}.zero_rad", self.tree.driven[*j]),
            Number::Transmission(j, k) => format!("{}.transmission_rad[{k}]", self.tree.driven[*j]),
            Number::Ratio(i, t) => format!("{}.coupled[{t}]", piece(*i)),
            Number::Axis(i, k) => format!("{}.axis_rad[{k}]", piece(*i)),
            Number::Vector(i, c) | Number::MountVector(i, c) => format!("{}.vector_m[{c}]", piece(*i)),
            Number::Mount(i, c) => format!("{}.attitude_rad[{c}]", piece(*i)),
            Number::Gravity(c) => format!("gravity_direction[{c}]"),
            Number::Tolerance(k) | Number::Effect(k) => self.dependences[*k].name(),
            Number::SessionRotation(s, c) => format!("session_{s}.rotation_rad[{c}]"),
            Number::SessionPosition(s, c) => format!("session_{s}.position_m[{c}]"),
            Number::BaseRotation(c) => format!("base_rotation_rad[{c}]"),
            Number::Drift(c) => format!("drift_m[{c}]"),
            Number::BasePosition(c) => format!("base_position_m[{c}]"),
            Number::Tool(p, c) => format!("{}.tool_m[{c}]", self.points[*p].label()),
        }
    }

    fn evidence(&self) -> Vec<Evidence> {
        let best = self.stages.last().map_or(0.0, |s| s.median_mm);
        self.stages
            .iter()
            .map(|s| Evidence { model: s.added.clone(), score: best - s.median_mm, objective: s.median_mm })
            .collect()
    }

    fn residuals(&self, campaign: &Campaign) -> Vec<ReadingResidual> {
        let [before, after] = [&self.rigid, &self.fitted].map(|fitted| self.predictions_m(fitted));
        let all_gross: HashSet<usize> = self.gross.iter().map(|(row, _)| *row).collect();
        let rows = campaign.positions.iter().zip(before.into_iter().zip(after)).enumerate();
        rows.flat_map(|(i, (row, at_m))| {
            let (before, after) = (1e3 * at_m.0, 1e3 * at_m.1);
            let gross = all_gross.contains(&i);
            let left_out_mm = 1e3 * self.held_out[i];
            let measured = row.measured.iter().enumerate().filter_map(|(c, read)| Some((c, (*read)?)));
            measured.map(move |(c, read)| ReadingResidual {
                channel: Channel::Positions,
                row: row.row + 1,
                index: i,
                component: c,
                quantity: POSITION.values[c],
                measured: read.value_mm,
                sigma: read.sigma_mm,
                before: before[c],
                after: after[c],
                held_out: Some(left_out_mm[c] / read.sigma_mm),
                gross,
            })
        })
        .collect()
    }
}

/// Root mean squares of the residuals of all positions, of each point, of each payload and of the worst poses
/// \[declared standard deviations\]. There are two of each: with calibration alone (before) and with the effects
/// (after). Gross errors are left out. `residuals` are the residuals of the positions, row by row.
pub(crate) fn located(campaign: &Campaign, residuals: &[ReadingResidual]) -> Vec<Located> {
    let mut parts: Vec<(String, Vec<&ReadingResidual>)> = Vec::new();
    let mut known: HashMap<String, usize> = HashMap::new();
    for own in residuals.chunk_by(|a, b| a.index == b.index).filter(|own| !own[0].gross) {
        let row = &campaign.positions[own[0].index];
        let pose: Vec<String> = row.pose_deg.iter().map(|a| format!("{a}")).collect();
        let names = [
            "positions".to_string(),
            format!("positions, point {}", row.point),
            format!("positions, payload {} kg", row.payload.mass_kg),
            format!("pose {} deg", pose.join(",")),
        ];
        for name in names {
            let part = *known.entry(name).or_insert_with_key(|name| {
                parts.push((name.clone(), Vec::new()));
                parts.len() - 1
            });
            parts[part].1.extend(own);
        }
    }
    let all = parts.into_iter().map(|(part, list)| Located {
        count: list.len(),
        rms_before: rms(list.iter().map(|r| (r.measured - r.before) / r.sigma)),
        rms_after: rms(list.iter().map(|r| (r.measured - r.after) / r.sigma)),
        part,
    });
    let (mut poses, mut rest): (Vec<_>, Vec<_>) = all.partition(|l| l.part.starts_with("pose"));
    poses.sort_by(|a, b| b.rms_before.total_cmp(&a.rms_before));
    rest.extend(poses.into_iter().take(WORST_POSES));
    rest
}

/// Sentence that an effect is physically impossible: one of its numbers is outside the range that an arm file may
/// state. `None` if all numbers are possible.
fn beyond_bounds(finding: &Finding) -> Option<String> {
    let kind = kind(&finding.effect)?;
    finding.parameters.iter().find_map(|(name, estimates)| {
        let mut known = kind.places.iter().flat_map(|place| (kind.parameters)(*place));
        let parameter = known.find(|parameter| parameter.name == name)?;
        let is_beyond = |e: &&Estimate| e.value.is_finite() && !parameter.allows(e.value);
        let value = estimates.iter().find(is_beyond)?.value;
        Some(format!(
            "{} would have {name} = {}, and only {} to {} is possible: something else is missing",
            finding.label(),
            significant(value, 3),
            parameter.low,
            parameter.high
        ))
    })
}

fn as_effect(campaign: &Campaign, finding: &Finding) -> Effect {
    finding.as_effect(json!({"campaign": campaign.statement.name, "campaign_blake3": campaign.hash}))
}
