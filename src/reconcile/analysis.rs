//! Analyses displacements, frequencies and bench readings: whether they differ from the model, which effects are
//! missing, how certain these are, and whether they predict held-out poses. In addition to effects of the library, the
//! analysis tries *laws without a name*: smooth functions that reveal physics which the library lacks.

use super::fit::descent::{Effort, Fit, Weights};
use super::fit::held_out::{self, HeldOut, rms};
use super::fit::interval::intervals;
use super::fit::noise::Noise;
use super::fit::units;
use super::forward::prepared::Forward;
use super::model::calibration::Nuisance;
use super::model::candidates::candidates;
use super::model::estimate::{Finding, Interval};
use super::model::parameters::{Candidate, Model};
use super::readings::campaign::Campaign;
use super::readings::components::DISPLACEMENT;
use super::select::empirical;
use super::select::few_rows;
use super::select::lack_of_fit::{LackOfFit, lack_of_fit};
use super::select::screening::Selection;
use super::select::search::{Scored, Search};
use super::select::seen::seen;
use super::select::settle::Settled;
use super::select::unnamed::{self, Better};
use super::verdict::corrected_model::Choice;
use super::verdict::judgement::{
    BEYOND_TOLERANCE, MOST_UNCONFIRMED, NOTHING_MISSING, SHOWN_BY_ONE_FOLD, TOO_FAR_OFF, WEAK_EVIDENCE,
    does_not_predict, shows_in_few_poses, too_many_alternatives,
};
use super::verdict::next_test;
use super::verdict::outcome::{Calibrated, Evidence, Law, Located, Outcome, ReadingResidual, Row, Verdict};
use super::verdict::too_little::{rows, too_little};
use super::verdict::{caution, correct, corrected_model, fitted, locate, unit_words};
use crate::arm::Arm;
use serde_json::Value;
use std::cell::OnceCell;

/// Reconciles displacements, frequencies and bench readings with the arm; positions and records are not used.
pub(crate) fn reconcile(campaign: &Campaign) -> Outcome {
    let mut forward = Forward::new(campaign);
    let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
    let few = rows(campaign) < few_rows::FEWEST_ROWS;
    let candidates = sought(campaign, &forward, &nuisance, few);
    let found = settled(campaign, &mut forward, &nuisance, &candidates, few);
    let weights = found.noise.weights(&forward);
    let chosen = &found.selection.best;
    let coefficients = Model::of(&nuisance, &candidates, &chosen.effects).coefficients(&forward, &chosen.u);
    forward.refresh(&coefficients);
    let search = Search {
        campaign,
        forward: &forward,
        nuisance: &nuisance,
        candidates: &candidates,
        weights: &weights,
    };
    let hopeless = found.selection.given_up || !search.may_explain(chosen);
    let best = match hopeless {
        true => search.fit(&chosen.effects, &chosen.u, Effort::default()),
        false => search.polish(&chosen.effects, &chosen.u),
    };
    let baseline = search.fit(&[], &found.selection.baseline.u, Effort::default());
    let with_laws = [candidates.as_slice(), &empirical::laws(&forward, &baseline, &weights)].concat();
    let fit_test = lack_of_fit(campaign, &forward, &best, &weights);
    let alternatives = search.alternatives(chosen, &found.selection.others);
    let explaining = few.then(|| found.selection.others.clone());
    let unnamed = match () {
        () if few => None,
        () if fit_test.fails => unnamed::better_than_calibration(&search, &baseline),
        () if best.model.effects.is_empty() => None,
        () => unnamed::instead(&search, &search.scored(&chosen.effects, &best), &baseline),
    };
    let without = is_weak(&found.selection).then(|| lack_of_fit(campaign, &forward, &baseline, &weights));
    let left_out = [&baseline, &best].map(|f| held_out::residuals(&forward, &f.model, &f.point.u, &weights));
    let expected_rms = held_out::expected_rms(&forward, &best, &weights);
    let analysis = Analysis {
        campaign,
        forward: &forward,
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
        alternatives,
        explaining,
        without,
        ends: OnceCell::new(),
        left_out,
        expected_rms,
    };
    analysis.conclude()
}

/// The candidates (effects at places) that the search tries: every effect that the campaign admits and the readings
/// could show. If `few`, the campaign has only a handful of rows. Rare effects are then left out, and fits begin from
/// more starting points.
fn sought(campaign: &Campaign, forward: &Forward, nuisance: &Nuisance, few: bool) -> Vec<Candidate> {
    let mut candidates = candidates(forward);
    candidates.retain(|c| campaign.statement.considers(c.kind.name));
    let mut candidates = seen(forward, nuisance, candidates);
    if few {
        // rare effects are left out, because a handful of readings cannot show them convincingly
        candidates.retain(|c| c.kind.traits.odds >= 1.0);
        candidates = candidates.into_iter().map(Candidate::from_corners).collect();
    }
    candidates
}

/// Whether the evidence for the best effects is weak: their score exceeds the score of the baseline by less than
/// [`WEAK_EVIDENCE`]. `false` if there are no effects.
fn is_weak(selection: &Selection) -> bool {
    !selection.best.effects.is_empty() && selection.best.score - selection.baseline.score < WEAK_EVIDENCE
}

/// Finds the effects and the noise. If a channel is so noisy that its readings may be in another unit than stated, the
/// search is repeated with larger standard deviations of this channel. The repetition counts only if it finds the wrong
/// unit as an effect. In that case `forward` gets the larger standard deviations too.
fn settled(
    campaign: &Campaign,
    forward: &mut Forward,
    nuisance: &Nuisance,
    candidates: &[Candidate],
    few: bool,
) -> Settled {
    if few {
        return Settled::of_few(campaign, forward, nuisance, candidates);
    }
    let found = Settled::of_many(campaign, forward, nuisance, candidates);
    let best = &found.selection.best;
    let coefficients = Model::of(nuisance, candidates, &best.effects).coefficients(forward, &best.u);
    let stretches = units::stretches(forward, &coefficients);
    if stretches.is_empty() {
        return found;
    }
    let mut stretched = Forward::new(campaign);
    units::stretch(&mut stretched, &stretches);
    let mut again = Settled::of_many(campaign, &mut stretched, nuisance, candidates);
    let named: Vec<&Candidate> = again.selection.best.effects.iter().map(|&i| &candidates[i]).collect();
    // unless the wrong unit is found as an effect, larger standard deviations would only hide other physics
    if !stretches.iter().all(|stretch| stretch.is_among(&named)) {
        return found;
    }
    *forward = stretched;
    again.remarks.extend(stretches.iter().map(units::Stretch::sentence));
    again
}

struct Analysis<'a> {
    campaign: &'a Campaign,
    forward: &'a Forward,
    search: &'a Search<'a>,
    /// A copy of `search` to whose candidates the laws without a name are appended.
    with_laws: &'a Search<'a>,
    selection: &'a Selection,
    noise: &'a Noise,
    remarks: &'a [String],
    weights: &'a Weights,
    best: Fit<'a>,
    baseline: Fit<'a>,
    lack_of_fit: LackOfFit,
    /// A law without a name that explains the readings better than the named effects, or better than calibration alone
    /// if the model fails the test for lack of fit. `None` if there is no such law.
    unnamed: Option<Better>,
    alternatives: Vec<Vec<Scored>>,
    /// All sets of effects that explain the readings. `None` unless the campaign has only a handful of rows.
    explaining: Option<Vec<Scored>>,
    /// Result of the test for lack of fit of calibration alone; `None` unless the evidence for the effects is weak.
    without: Option<LackOfFit>,
    /// 95 % intervals of the parameters of the best model's effects. They are computed when they are first asked for.
    ends: OnceCell<Vec<Interval>>,
    /// Residuals of held-out readings \[sigma\]: with the baseline, then with the best model.
    left_out: [Vec<Option<f64>>; 2],
    /// Root mean square that the residuals of held-out poses would have if the best model were right \[sigma\].
    expected_rms: f64,
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
            let several = self.best.model.effects.len() > 1;
            let label = self.best.model.label();
            reasons.push(shows_in_few_poses(&if several { format!("one of {label}") } else { label }));
        }
        if matches!(verdict, Verdict::Explained | Verdict::Unexplained) {
            reasons.extend(self.at_a_limit());
        }
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
                let within = reasons.iter_mut().filter(|reason| *reason == NOTHING_MISSING);
                within.for_each(|reason| *reason = BEYOND_TOLERANCE.into());
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

    fn verdict(&self, held_out: &Option<HeldOut>) -> (Verdict, Vec<String>) {
        let mut reasons = too_little(self.campaign, self.forward);
        if !reasons.is_empty() {
            if let Some(explaining) = self.explaining.as_ref().filter(|_| !self.forward.data.is_empty()) {
                reasons.extend(few_rows::sentences(self.search, self.campaign, &self.baseline, explaining));
            }
            reasons.extend(self.unidentified());
            return (Verdict::InsufficientData, reasons);
        }
        if self.lack_of_fit.fails {
            return (Verdict::Unexplained, self.left_over());
        }
        let (tolerances, calibrated) = (fitted::tolerances(&self.best), fitted::calibrated(&self.best));
        if let Some(text) =
            caution::impossible_calibration(self.campaign, &self.best.model.label(), tolerances, &calibrated)
        {
            return (Verdict::Unexplained, vec![text]);
        }
        if self.best.model.effects.is_empty() {
            return (Verdict::NoGap, vec![NOTHING_MISSING.to_string()]);
        }
        if let Some(better) = &self.unnamed {
            return (Verdict::Unexplained, vec![self.beaten(better)]);
        }
        if let Some(text) = caution::opposed(self.forward, &self.best) {
            return (Verdict::Unexplained, vec![text]);
        }
        if let Some(without) = &self.without {
            return self.weak(without);
        }
        for (effect, competitors) in self.best.model.effects.iter().zip(&self.alternatives) {
            if let Some(text) = too_many_alternatives(&effect.label(), competitors.len()) {
                return (Verdict::InsufficientData, vec![text]);
            }
        }
        if let Some((verdict, text)) = held_out.and_then(|held_out| self.badly_predicted(held_out)) {
            return (verdict, vec![text]);
        }
        if let Some(&i) = caution::may_be_absent(&self.best, self.ends()).first() {
            let text = format!(
                "the 95 % interval of {} contains its absence: it is a suspect and no finding",
                self.best.model.effects[i].label()
            );
            return (Verdict::InsufficientData, vec![text]);
        }
        (Verdict::Explained, vec![self.gap_sentence()])
    }

    /// Verdict and reason if the best effects predict the readings of held-out poses badly; `None` if they do not.
    fn badly_predicted(&self, held_out: HeldOut) -> Option<(Verdict, String)> {
        let HeldOut { rms_before, rms_after, .. } = held_out;
        // if one fold alone shows an effect, a fit without this fold knows nothing of the effect and cannot predict it
        if self.shows_in_one_fold() && rms_after <= TOO_FAR_OFF * self.expected_rms {
            return None;
        }
        if rms_after > rms_before + 0.02 {
            let [after, before] = [rms_after, rms_before].map(|rms| format!("{rms:.2} sigma"));
            let text = does_not_predict(&self.best.model.label(), &after, &before);
            return Some((Verdict::InsufficientData, text));
        }
        (rms_after > TOO_FAR_OFF).then(|| {
            let text = format!(
                "with {} the readings of poses held out of the fit are still {rms_after:.1} sigma off: something else is missing",
                self.best.model.label()
            );
            (Verdict::Unexplained, text)
        })
    }

    /// Verdict and reasons if the evidence for the best effects is weak. These effects are only suspected. The
    /// verdict is `no_gap` if calibration alone leaves only noise (`without` passes the test for lack of fit),
    /// otherwise `insufficient_data`.
    fn weak(&self, without: &LackOfFit) -> (Verdict, Vec<String>) {
        let gain = self.selection.best.score - self.selection.baseline.score;
        let suspected = format!(
            "{} is a suspect: ln of the evidence rises by {gain:.1} with it (chi-squared {:.0} to {:.0}), odds of {:.0} to 1. \
             Take the next test before relying on it",
            self.best.model.label(),
            self.baseline.point.objective,
            self.best.point.objective,
            libm::exp(gain)
        );
        match without.fails {
            true => (Verdict::InsufficientData, [without.sentences(), vec![suspected]].concat()),
            false => (Verdict::NoGap, vec![NOTHING_MISSING.to_string(), suspected]),
        }
    }

    fn gap_sentence(&self) -> String {
        format!(
            "with {} ln of the evidence rises by {:.1} (chi-squared {:.0} to {:.0} on {} readings)",
            self.best.model.label(),
            self.selection.best.score - self.selection.baseline.score,
            self.baseline.point.objective,
            self.best.point.objective,
            self.forward.data.len()
        )
    }

    /// 95 % intervals of the parameters of all effects of the best model, in the order of the parameters. The first
    /// call computes them.
    fn ends(&self) -> &[Interval] {
        self.ends.get_or_init(|| intervals(self.forward, &self.best, self.weights))
    }

    /// Sentence which says that one of the best effects has the largest size that is sought; `None` if none has. It
    /// does not name the effect, because the effect may not be the right one.
    fn at_a_limit(&self) -> Option<String> {
        let text = "the size of one of the best effects is the largest that is looked for: is arm.json the arm that was measured?";
        self.best.model.is_at_a_limit(&self.best.point.u).then(|| text.to_string())
    }

    /// Sentences on the structure that the best model leaves in the residuals, without names of effects.
    fn left_over(&self) -> Vec<String> {
        let mut out = units::other_conventions(self.forward);
        let beyond = self.lack_of_fit.sentences_beyond_scatter();
        let declared = self.lack_of_fit.sentences();
        if beyond.is_empty() && !declared.is_empty() {
            out.push(format!(
                "the readings scatter {:.1} times as much as declared. If this is their noise, they follow nothing that was \
                 asked, and sigma in the files is too small. If sigma is right, they do:",
                self.lack_of_fit.chi2_per_dof.sqrt()
            ));
            out.extend(declared);
        } else {
            out.extend(beyond);
        }
        out.push(format!(
            "the best model leaves {:.2} times the declared variance; no effect of the library explains the rest",
            self.lack_of_fit.chi2_per_dof
        ));
        out.extend(self.unnamed.as_ref().map(|law| {
            format!(
                "the best law without a name is {}: added to calibration alone it lowers chi-squared from {:.0} to {:.0}",
                law.what, self.baseline.point.objective, law.objective
            )
        }));
        out
    }

    /// Sentence which says that `law`, a law without a name, explains the readings better than the effects of the
    /// library.
    fn beaten(&self, law: &Better) -> String {
        format!(
            "the library lacks this law, and it explains the readings better than any effect of the library: {} \
             (chi-squared {:.0} with its {} parameter(s), {:.0} with {} of the best effects; ln of the evidence rises by {:.1})",
            law.what,
            law.objective,
            law.numbers,
            self.best.point.objective,
            self.best.model.free_parameters().count(),
            law.gain
        )
    }

    /// Sentence that lists the stiffnesses about which the readings say nothing: their standard deviation after the fit
    /// is more than 90 % of the one that their tolerance gives. Empty if there are none.
    fn unidentified(&self) -> Vec<String> {
        let blind: Vec<String> = fitted::calibrated(&self.best)
            .into_iter()
            .filter(|c| c.learnt > 0.9 && c.name.ends_with("stiffness"))
            .map(|c| c.name)
            .collect();
        let text = format!("the readings say nothing about {}", blind.join(", "));
        if blind.is_empty() { Vec::new() } else { vec![text] }
    }

    /// Whether one of a few effects shows in the poses of one fold alone. Even a right model then leaves an error of more
    /// than [`SHOWN_BY_ONE_FOLD`] standard deviations on held-out poses, so held-out poses cannot confirm it.
    fn shows_in_one_fold(&self) -> bool {
        self.expected_rms > SHOWN_BY_ONE_FOLD && self.best.model.effects.len() <= MOST_UNCONFIRMED
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
