//! Analyses displacements, frequencies and bench readings: whether they differ from the model, which effects are
//! missing, how certain these are, and whether they predict held-out poses. In addition to effects of the library, the
//! analysis tries *laws without a name*: smooth functions that reveal physics which the library lacks.

use super::fit::descent::{Effort, Fit};
use super::fit::held_out::{self, HeldOut, rms};
use super::fit::interval::intervals;
use super::fit::noise::Noise;
use super::fit::units;
use super::fit::weights::Weights;
use super::forward::prepared::Forward;
use super::found::Found;
use super::long::Part;
use super::model::estimate::{Finding, Interval};
use super::model::parameters::Model;
use super::readings::campaign::Campaign;
use super::readings::components::DISPLACEMENT;
use super::select::empirical;
use super::select::few_rows;
use super::select::lack_of_fit::{LackOfFit, lack_of_fit};
use super::select::screening::Selection;
use super::select::search::{Scored, Search};
use super::select::unnamed::{self, Better};
use super::verdict::corrected_model::Choice;
use super::verdict::in_series::InSeries;
use super::verdict::judgement::{BEYOND_TOLERANCE, NOTHING_MISSING, WEAK_EVIDENCE, shows_in_few_poses};
use super::verdict::next_test;
use super::verdict::outcome::{Calibrated, Evidence, Law, Located, Outcome, ReadingResidual, Row, Verdict};
use super::verdict::{caution, correct, corrected_model, fitted, locate, unit_words};
use crate::arm::Arm;
use serde_json::Value;
use std::cell::OnceCell;

/// Reconciles displacements, frequencies and bench readings with the arm; positions and records are not used. In a long
/// campaign the effects are sought in a part of its displacements.
pub(crate) fn reconcile(campaign: &Campaign) -> Outcome {
    let Some(part) = Part::of(campaign) else { return analysed(Found::of(campaign)) };
    let found = Found::of(&part.campaign).on_all_rows(campaign, &part);
    analysed(found.unwrap_or_else(|| Found::of(campaign)))
}

/// The outcome for a campaign whose effects were found.
fn analysed(found: Found) -> Outcome {
    let Found { mut sought, few, settled: mut found, stood, .. } = found;
    sought.refresh(&found.selection.best);
    let (campaign, forward, candidates) = (sought.campaign, &sought.forward, &sought.candidates);
    let weights = found.noise.weights(forward);
    let search = sought.search(&weights);
    let (best, in_series) = best_model(&search, &mut found.selection, few);
    let chosen = &found.selection.best;
    let baseline = search.fit(&[], &found.selection.baseline.u, Effort::default());
    let with_laws = [candidates.as_slice(), &empirical::laws(forward, &baseline, &weights)].concat();
    let fit_test = lack_of_fit(campaign, forward, &best, &weights);
    let alternatives = search.alternatives(chosen, &found.selection.others);
    let explaining = few.then(|| found.selection.others.clone());
    let unnamed = match () {
        () if few => None,
        () if fit_test.fails => unnamed::better_than_calibration(&search, &baseline),
        () if best.model.effects.is_empty() || (stood && in_series.is_none()) => None,
        () => unnamed::instead(&search, &search.scored(&chosen.effects, &best), &baseline, &found.noise),
    };
    let without = is_weak(&found.selection).then(|| lack_of_fit(campaign, forward, &baseline, &weights));
    let left_out = [&baseline, &best].map(|f| held_out::residuals(forward, &f.model, &f.point.u, &weights));
    let expected_rms = held_out::expected_rms(forward, &best, &weights);
    let analysis = Analysis {
        campaign,
        forward,
        search: &search,
        with_laws: &Search { candidates: &with_laws, ..search },
        selection: &found.selection,
        noise: &found.noise,
        remarks: &found.remarks,
        weights: &weights,
        best,
        baseline,
        lack_of_fit: fit_test,
        unnamed,
        in_series,
        alternatives,
        explaining,
        without,
        ends: OnceCell::new(),
        left_out,
        expected_rms,
    };
    analysis.conclude()
}

/// The best model of the search, fitted until it has converged. If a calibrated factor is rare in it, the model with an
/// effect that takes the place of the factor becomes the best one, and is returned too.
fn best_model<'s>(search: &Search<'s>, selection: &mut Selection, few: bool) -> (Fit<'s>, Option<InSeries>) {
    let chosen = &selection.best;
    if selection.given_up || !search.may_explain(chosen) {
        return (search.fit(&chosen.effects, &chosen.u, Effort::default()), None);
    }
    let best = search.polish(&chosen.effects, &chosen.u);
    let found = (!few).then(|| InSeries::of_rare_factors(search, &search.scored(&chosen.effects, &best)));
    let Some(found) = found.flatten() else { return (best, None) };
    let best = search.polish(&found.model.effects, &found.model.u);
    selection.best = found.model.clone();
    (best, Some(found))
}

/// Whether the evidence for the best effects is weak: their score exceeds the score of the baseline by less than
/// [`WEAK_EVIDENCE`]. `false` if there are no effects.
fn is_weak(selection: &Selection) -> bool {
    !selection.best.effects.is_empty() && selection.best.score - selection.baseline.score < WEAK_EVIDENCE
}

/// An analysis of the readings: the models that were fitted, and what is needed to judge them.
pub(super) struct Analysis<'a> {
    pub(super) campaign: &'a Campaign,
    pub(super) forward: &'a Forward,
    pub(super) search: &'a Search<'a>,
    /// A copy of `search` to whose candidates the laws without a name are appended.
    pub(super) with_laws: &'a Search<'a>,
    pub(super) selection: &'a Selection,
    pub(super) noise: &'a Noise,
    pub(super) remarks: &'a [String],
    pub(super) weights: &'a Weights,
    pub(super) best: Fit<'a>,
    pub(super) baseline: Fit<'a>,
    pub(super) lack_of_fit: LackOfFit,
    /// A law without a name that explains the readings better than the named effects, or better than calibration alone
    /// if the model fails the test for lack of fit. `None` if there is no such law.
    pub(super) unnamed: Option<Better>,
    /// An effect of the best model that was offered because a calibrated factor without it is rare; `None` if there is
    /// none.
    pub(super) in_series: Option<InSeries>,
    pub(super) alternatives: Vec<Vec<Scored>>,
    /// All sets of effects that explain the readings. `None` unless the campaign has only a handful of rows.
    pub(super) explaining: Option<Vec<Scored>>,
    /// Result of the test for lack of fit of calibration alone; `None` unless the evidence for the effects is weak.
    pub(super) without: Option<LackOfFit>,
    /// 95 % intervals of the parameters of the best model's effects. They are computed when they are first asked for.
    pub(super) ends: OnceCell<Vec<Interval>>,
    /// Residuals of held-out readings \[sigma\]: with the baseline, then with the best model.
    pub(super) left_out: [Vec<Option<f64>>; 2],
    /// Root mean square that the residuals of held-out poses would have if the best model were right \[sigma\].
    pub(super) expected_rms: f64,
}

/// The corrected arm, and what was changed in it: calibrated factors and laws without a name.
struct Corrections {
    calibrated: Vec<Calibrated>,
    empirical: Vec<Law>,
    models: Vec<Row>,
    corrected: Arm,
    provenance: Value,
}

impl Analysis<'_> {
    fn conclude(self) -> Outcome {
        let held_out = self.held_out();
        let (verdict, mut reasons) = self.verdict(&held_out);
        if verdict == Verdict::Explained && self.shows_in_one_fold() {
            reasons.push(shows_in_few_poses(&self.best.model.label()));
        }
        if verdict == Verdict::Unexplained {
            reasons.splice(0..0, self.other_conventions());
        }
        if matches!(verdict, Verdict::Explained | Verdict::Unexplained) {
            reasons.extend(self.at_a_limit());
        }
        reasons.extend(units::like_positions(self.forward));
        reasons.extend(self.remarks.iter().cloned());
        // the findings are named with the verdict `Explained`, and are suspects with `NoGap` and `InsufficientData`
        let findings = match verdict {
            Verdict::Unexplained => Vec::new(),
            _ => self.findings(),
        };
        let (effects, suspects) = verdict.named_and_suspected(findings, Vec::new());
        let Corrections { calibrated, empirical, models, corrected, provenance } =
            self.corrections(verdict, &effects);
        if verdict == Verdict::Explained {
            reasons.extend(caution::unbounded(&self.best, self.ends()));
        }
        let mut next_tests = next_test::propose(&self.next_question(verdict));
        reasons.extend(unit_words::note(self.forward, &effects, &mut next_tests));
        if matches!(verdict, Verdict::Explained | Verdict::NoGap) {
            let shown = if verdict == Verdict::NoGap { &self.baseline } else { &self.best };
            if let Some(text) = caution::beyond_tolerance(fitted::tolerances(shown), &calibrated) {
                let within = reasons.iter_mut().filter(|reason| reason.starts_with(NOTHING_MISSING));
                within.for_each(|reason| *reason = reason.replacen(NOTHING_MISSING, BEYOND_TOLERANCE, 1));
                reasons.push(text);
            }
        }
        Outcome {
            campaign: self.campaign.statement.name.clone(),
            hash: self.campaign.hash.clone(),
            verdict,
            reasons,
            next_tests,
            effects: unit_words::joined(effects),
            suspects: unit_words::joined(suspects),
            empirical,
            models,
            held_out,
            located: self.located(),
            noise: self.noise.clone(),
            lack_of_fit: Some(self.lack_of_fit.clone()),
            calibrated,
            evidence: if verdict == Verdict::Unexplained { Vec::new() } else { self.evidence() },
            stages: Vec::new(),
            records: Vec::new(),
            residuals: self.residuals(),
            corrected,
            other_corrected: Vec::new(),
            provenance,
        }
    }

    /// The corrections of the arm. They depend on `verdict`: if it is `unexplained`, a model for the corrected arm is
    /// chosen first. `named` are the effects that the verdict names.
    fn corrections(&self, verdict: Verdict, named: &[Finding]) -> Corrections {
        let choice = (verdict == Verdict::Unexplained).then(|| self.model_without_explanation());
        let written = match (&choice, verdict) {
            (Some(choice), _) => choice.fit.as_ref(),
            (None, Verdict::InsufficientData) => None,
            (None, Verdict::NoGap) => Some(&self.baseline),
            (None, _) => Some(&self.best),
        };
        let in_arm = match (&choice, written) {
            (Some(choice), Some(fit)) => choice.findings(fit, self.forward, self.weights),
            _ => named.to_vec(),
        };
        let unwritten = if choice.is_some() { &self.baseline } else { &self.best };
        let calibrated = fitted::calibrated(written.unwrap_or(unwritten));
        let (corrected, provenance) =
            correct::corrected(self.campaign, self.forward, written, &in_arm, &calibrated, verdict);
        let empirical = written.map_or(Vec::new(), |fit| fitted::laws(fit, &in_arm));
        let models = choice.map_or(Vec::new(), |choice| choice.rows);
        Corrections { calibrated, empirical, models, corrected, provenance }
    }

    /// 95 % intervals of the parameters of all effects of the best model, in the order of the parameters. The first
    /// call computes them.
    pub(super) fn ends(&self) -> &[Interval] {
        self.ends.get_or_init(|| intervals(self.forward, &self.best, self.weights))
    }

    fn held_out(&self) -> Option<HeldOut> {
        let [before, after] = &self.left_out;
        let count = after.iter().flatten().count();
        let scaled = |list: &[Option<f64>]| {
            let each = list.iter().zip(&self.forward.data);
            rms(each.filter_map(|(r, d)| Some((*r)? / self.noise.scale[d.channel as usize])))
        };
        // if there is a single pose, no other readings are left from which to predict it
        (count > 0 && self.forward.groups.len() > 1).then(|| HeldOut {
            rms_before: scaled(before),
            rms_after: scaled(after),
            rms_declared_after: rms(after.iter().flatten().copied()),
            count,
        })
    }

    fn findings(&self) -> Vec<Finding> {
        if let Some(explaining) = &self.explaining {
            return few_rows::suspects(self.search, explaining, self.weights);
        }
        let competitors: Vec<_> = (0..self.best.model.effects.len()).map(|i| self.competitors(i)).collect();
        fitted::effects(&self.best, self.ends(), &competitors)
    }

    /// Chooses the model of the corrected arm for the case that no effect explains the readings.
    fn model_without_explanation(&self) -> Choice<'_> {
        let first_law = self.search.candidates.len();
        let again =
            |fit: &Fit, effects: &[usize]| self.with_laws.fit(effects, &fit.point.u, Effort::default());
        let chosen = &self.selection.best.effects;
        let (baseline, named) = (again(&self.baseline, &[]), again(&self.best, chosen));
        corrected_model::choose(self.with_laws, first_law, self.noise, &baseline, &named, chosen)
    }

    fn competitors(&self, effect: usize) -> Vec<(String, String)> {
        let own: Vec<usize> = self.selection.best.effects.clone();
        let twins = self.best.model.effects[effect].twins.iter().cloned();
        let others = self.alternatives[effect]
            .iter()
            .filter_map(|s| s.effects.iter().find(|e| !own.contains(e)))
            .map(|&e| &self.search.candidates[e])
            .map(|c| (c.kind.name.to_string(), c.at.clone()));
        twins.chain(others).collect()
    }

    fn located(&self) -> Vec<Located> {
        locate::located(self.campaign, self.forward, &self.baseline, &self.best, self.weights)
    }

    fn evidence(&self) -> Vec<Evidence> {
        let best = self.selection.best.score;
        let label = |s: &Scored| self.search.model(&s.effects).label();
        let named = |s: &Scored| Evidence {
            model: if s.effects.is_empty() { "calibration only".into() } else { label(s) },
            score: s.score - best,
            objective: s.objective,
        };
        let mut out = vec![named(&self.selection.best), named(&self.selection.baseline)];
        out.extend(self.selection.others.iter().map(named));
        let mut seen: Vec<String> = Vec::new();
        out.retain(|e| {
            let new = !seen.contains(&e.model);
            seen.push(e.model.clone());
            new
        });
        out.truncate(20);
        out
    }

    fn residuals(&self) -> Vec<ReadingResidual> {
        let quantity = |i: usize| -> &'static str {
            let datum = &self.forward.data[i];
            match datum.channel.word() {
                "static" => DISPLACEMENT.values[datum.component],
                "modal" => "frequency_hz",
                _ => "windup_arcmin",
            }
        };
        (0..self.forward.data.len())
            .map(|i| {
                let datum = &self.forward.data[i];
                ReadingResidual {
                    channel: datum.channel,
                    row: datum.row + 1,
                    index: datum.index,
                    component: datum.component,
                    quantity: quantity(i),
                    measured: datum.value,
                    sigma: datum.sigma,
                    before: self.baseline.point.predicted[i],
                    after: self.best.point.predicted[i],
                    held_out: self.left_out[1][i],
                    gross: self.weights.inverse[i] == 0.0,
                }
            })
            .collect()
    }

    fn next_question(&self, verdict: Verdict) -> next_test::Question<'_> {
        let subject = |model: &Model, u: &[f64]| model.subject(self.forward, u);
        let best = (self.best.model.label(), subject(&self.best.model, &self.best.point.u));
        let others: Vec<&Scored> = match &self.explaining {
            Some(sets) => sets.iter().skip(1).collect(),
            None => self.alternatives.iter().flatten().collect(),
        };
        let mut competitors: Vec<(String, crate::arm::effect::subject::Subject)> = others
            .into_iter()
            .take(4)
            .map(|s| {
                let model = self.search.model(&s.effects);
                (model.label(), subject(&model, &s.u))
            })
            .collect();
        if competitors.is_empty() {
            competitors = self.without_each();
        }
        next_test::Question {
            campaign: self.campaign,
            best,
            competitors,
            residuals: self.worst_pose(),
            verdict,
        }
    }

    /// Arms with which the next test could compare the best model, each with a name: the same arm without one of the
    /// named effects. If nothing else could be the cause, a test that separates an effect from its absence confirms it.
    /// Other parameters stay as they were fitted with the effect.
    fn without_each(&self) -> Vec<(String, crate::arm::effect::subject::Subject)> {
        let best = &self.best;
        (0..best.model.effects.len())
            .map(|i| {
                let first = best.model.first_parameter(i);
                let mut u = best.point.u.clone();
                u.drain(first..first + best.model.effects[i].free_parameters.len());
                let name = format!("the same arm without {}", best.model.effects[i].label());
                (name, best.model.without(i).subject(self.forward, &u))
            })
            .collect()
    }

    /// The pose in which the residuals of the best model have the largest root mean square, as joint positions \[deg,
    /// mm\]. `None` if there are no poses.
    fn worst_pose(&self) -> Option<Vec<f64>> {
        let residuals = self.best.residuals(self.forward, self.weights);
        let mut of_groups: Vec<Vec<f64>> = vec![Vec::new(); self.forward.groups.len()];
        for (residual, datum) in residuals.iter().zip(&self.forward.data) {
            // bench readings have no pose and belong to no group
            of_groups.get_mut(datum.group).into_iter().for_each(|own| own.push(*residual));
        }
        let sizes = of_groups.into_iter().map(|own| rms(own.into_iter()));
        let group = sizes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?.0;
        let name = self.forward.groups.get(group)?;
        Some(name.split(',').filter_map(|a| a.parse().ok()).collect())
    }
}
