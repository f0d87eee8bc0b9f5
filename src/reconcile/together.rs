//! Reconciles all kinds of readings of a campaign together.
//!
//! Absolute positions determine the geometry of the arm. The analysis of displacements, frequencies and bench readings
//! takes the geometry as given. These readings determine compliances under various loads, while absolute positions are
//! mostly measured under gravity alone. Each of the two kinds is therefore reconciled with the findings of the other.
//! Records against time are judged separately.

use super::analysis;
use super::fit::held_out::HeldOut;
use super::fit::noise::Noise;
use super::model::direct::subject;
use super::model::estimate::Finding;
use super::positions;
use super::positions::analysis::Calibrated;
use super::positions::outcome::FEWEST_POSITIONS;
use super::positions::setups;
use super::readings::campaign::Campaign;
use super::records;
use super::select::few_rows::FEWEST_ROWS;
use super::select::lack_of_fit::LackOfFit;
use super::verdict::outcome::{Outcome, Verdict};
use super::verdict::stage::Stage;
use super::verdict::too_little::rows;
use crate::arm::effect::entry::Effect;
use crate::arm::{Arm, Element};
use serde_json::{Value, json};

/// Reconciles a campaign with its arm. If there are absolute positions and other readings, each of the two kinds gets a
/// verdict of its own, and the less favourable one is the verdict of the campaign.
///
/// ```
/// use armwright::catalog::Catalogs;
/// use armwright::reconcile::{Campaign, Verdict, reconcile};
/// use std::path::Path;
///
/// // three frequencies of the paper's arm: far too few readings to name an effect
/// let folder = Path::new("examples/paper-frequencies");
/// let campaign = Campaign::read(folder, &Catalogs::builtin()).expect("a sound campaign");
/// let outcome = reconcile(&campaign);
/// assert_eq!(outcome.verdict, Verdict::InsufficientData);
/// assert!(outcome.effects.is_empty());
/// ```
pub fn reconcile(campaign: &Campaign) -> Outcome {
    let in_one_frame = setups::in_one_frame(campaign);
    let campaign = in_one_frame.as_ref().unwrap_or(campaign);
    let mut outcome = of_all(campaign);
    outcome.reasons.extend(beyond_the_file(campaign, &outcome));
    outcome.reasons.extend(campaign.remarks.iter().cloned());
    outcome
}

/// Sentence which says that an effect was found in addition to an effect of the same name and place in the arm file.
/// `None` if there is no such effect.
fn beyond_the_file(campaign: &Campaign, outcome: &Outcome) -> Option<String> {
    let stated: Vec<String> = campaign.arm.effects.iter().map(Effect::label).collect();
    let found = outcome.effects.iter().map(Finding::label).filter(|label| stated.contains(label));
    let found: Vec<String> = found.collect();
    (!found.is_empty()).then(|| {
        format!(
            "found in addition to what the arm file states under the same name: {}; the corrected arm has both",
            found.join(", ")
        )
    })
}

/// Reconciles the records against time, and separately all other readings, and joins the two outcomes. Either kind may
/// be missing.
fn of_all(campaign: &Campaign) -> Outcome {
    let has_others = campaign.has_displacements() || !campaign.positions.is_empty();
    if campaign.records.is_empty() {
        return of_readings(campaign);
    }
    let recorded = records::outcome::reconcile(campaign);
    if has_others { records::outcome::joined(of_readings(campaign), recorded) } else { recorded }
}

/// Reconciles the readings that are not records against time. If there are positions and other readings, but too few
/// of one kind, only the other kind is reconciled and a reason says so.
fn of_readings(campaign: &Campaign) -> Outcome {
    let (loaded, placed) = (campaign.without_positions(), campaign.positions_alone());
    let (rows, count) = (rows(&loaded), placed.positions.len());
    if count == 0 {
        return analysis::reconcile(campaign);
    }
    if rows == 0 {
        return positions::outcome::reconcile(campaign);
    }
    let left_out = |mut outcome: Outcome, what: String| {
        outcome.reasons.push(format!("{what}: they are left out"));
        outcome
    };
    if count < FEWEST_POSITIONS {
        let what =
            format!("{count} positions are too few to calibrate an arm, give at least {FEWEST_POSITIONS}");
        return left_out(analysis::reconcile(&loaded), what);
    }
    if rows < FEWEST_ROWS {
        let what = format!("{rows} rows other than positions are too few, give at least {FEWEST_ROWS}");
        return left_out(positions::outcome::reconcile(&placed), what);
    }
    of_both(campaign, loaded, placed)
}

/// Reconciles positions and other readings together. `loaded` is the campaign with the readings other than positions,
/// and `placed` is the campaign with positions alone.
///
/// First, the geometry of the arm is calibrated from the positions, and effects are found from the other readings. If
/// the other readings are explained, their effects are added to the arm, and the positions are searched for further
/// effects. If not, effects are sought from the positions alone, and the other readings are reconciled again with the
/// arm that has these effects.
fn of_both(campaign: &Campaign, mut loaded: Campaign, placed: Campaign) -> Outcome {
    let calibrated = positions::analysis::calibrated(&placed);
    loaded.arm = calibrated.arms[0].clone();
    let first = analysis::reconcile(&loaded);
    if first.verdict.is_settled() {
        let second = positions::outcome::reconcile(&with_what_yields(&placed, &first));
        let corrected = second.corrected.clone();
        let told = Both {
            campaign,
            calibrated,
            with_laws: None,
            loaded: first,
            placed: second,
            told: true,
            corrected,
        };
        return told.outcome();
    }
    let second = positions::outcome::reconcile(&placed);
    loaded.arm = second.corrected.clone();
    let again = if second.effects.is_empty() { first } else { analysis::reconcile(&loaded) };
    let corrected = again.corrected.clone();
    // laws without a name also change the deflection under gravity, so the geometry is calibrated again with them
    let with_laws = (!again.empirical.is_empty())
        .then(|| positions::analysis::calibrated(&with_what_yields(&placed, &again)));
    Both { campaign, calibrated, with_laws, loaded: again, placed: second, told: false, corrected }.outcome()
}

/// Largest factor by which a corrected arm may increase the median error at held-out positions, compared with
/// calibration alone, if the readings are not explained. A model with a larger error is not written, no matter how well
/// it predicts the other readings.
const MOST_HARM: f64 = 1.1;

/// The corrected arms for the case that some readings are not explained.
struct Unexplained {
    arms: Vec<Arm>,
    /// Placements of the arms in the frame of the instrument, as entries of the provenance.
    placements: Value,
    /// Whether the arms have laws without a name.
    has_laws: bool,
}

impl Unexplained {
    /// Returns the first arm and the others, and writes the placements of the arms into `provenance`.
    fn arms_with(mut self, provenance: &mut Value) -> (Arm, Vec<Arm>) {
        let places = self.placements.as_object().into_iter().flatten();
        places.for_each(|(key, value)| provenance[key.as_str()] = value.clone());
        let first = self.arms.remove(0);
        (first, self.arms)
    }
}

/// Adds the calibrated factors in the provenance `own` of the other readings to those in the provenance of the
/// positions.
fn add_calibrated(provenance: &mut Value, own: &Value) {
    if let (Some(all), Some(own)) = (provenance["calibrated"].as_array_mut(), own["calibrated"].as_array()) {
        all.extend(own.iter().cloned());
    }
}

/// The less favourable of two tests for lack of fit. A test that fails is less favourable than one that passes;
/// otherwise the one with the larger chi-squared per degree of freedom is. `None` if there is no test.
fn worse_fit(loaded: Option<LackOfFit>, placed: Option<LackOfFit>) -> Option<LackOfFit> {
    let order =
        |a: &LackOfFit, b: &LackOfFit| a.fails.cmp(&b.fails).then(a.chi2_per_dof.total_cmp(&b.chi2_per_dof));
    [loaded, placed].into_iter().flatten().max_by(order)
}

/// Labels of the findings (effect and place), joined by `and`.
fn labels(findings: &[Finding]) -> String {
    findings.iter().map(Finding::label).collect::<Vec<_>>().join(" and ")
}

/// The campaign of positions `placed` with an arm that has the stiffnesses, masses and effects of the corrected arm in
/// `found`, the outcome of the other readings. The geometry stays as in `placed`. The payloads get the mass that the
/// other readings showed.
fn with_what_yields(placed: &Campaign, found: &Outcome) -> Campaign {
    let mut out = placed.clone();
    let known = out.arm.effects.len();
    for arm in std::iter::once(&mut out.arm).chain(&mut out.other_arms) {
        for element in &mut arm.chain {
            let own = found.corrected.chain.iter().find(|e| e.name() == element.name());
            match (element, own) {
                (Element::Joint(joint), Some(Element::Joint(corrected))) => {
                    let (axis, coupled) = (joint.axis, joint.coupled.clone());
                    *joint = corrected.clone();
                    (joint.axis, joint.coupled) = (axis, coupled);
                }
                (Element::Link(link), Some(Element::Link(corrected))) => {
                    let vector_m = link.vector_m;
                    *link = corrected.clone();
                    link.vector_m = vector_m;
                }
                _ => {}
            }
        }
        let names: Vec<&str> = arm.chain.iter().map(Element::name).collect();
        let new = found.corrected.effects[known..].iter();
        let elsewhere =
            |at: &str| found.corrected.chain.iter().any(|e| e.name() == at) && !names.contains(&at);
        let own: Vec<_> = new.filter(|e| !elsewhere(&e.at)).cloned().collect();
        arm.effects.extend(own);
    }
    let felt = subject(&out.arm, &out.statement);
    out.positions.iter_mut().for_each(|row| row.payload = felt.payload(&row.payload));
    out
}

/// The outcome for the positions and the outcome for the other readings, from which the common outcome is made.
struct Both<'a> {
    campaign: &'a Campaign,
    /// The arms calibrated from the positions alone, without effects.
    calibrated: Calibrated,
    /// The arms calibrated again from the positions, with the laws without a name that the other readings showed;
    /// `None` if they showed none.
    with_laws: Option<Calibrated>,
    /// Outcome for the readings other than positions.
    loaded: Outcome,
    /// Outcome for the positions.
    placed: Outcome,
    /// Whether the positions were analysed on an arm with the findings of the other readings.
    told: bool,
    /// The arm with the findings from both kinds of readings.
    corrected: Arm,
}

impl Both<'_> {
    fn outcome(self) -> Outcome {
        let verdict = self.verdict();
        let (stages, held_out, reasons) = (self.stages(), self.held_out(), self.reasons(verdict));
        let unexplained = (!verdict.is_settled()).then(|| self.unexplained());
        let Self { campaign, calibrated, loaded, mut placed, corrected, .. } = self;
        let mut next_tests = [loaded.next_tests, placed.next_tests].concat();
        next_tests.sort_by(|a, b| b.expected_sigmas.total_cmp(&a.expected_sigmas));
        for residual in &mut placed.residuals {
            residual.before = calibrated.predicted_mm[residual.index][residual.component];
        }
        let effects = [loaded.effects, placed.effects].concat();
        let suspects = [loaded.suspects, placed.suspects].concat();
        let (effects, suspects) = verdict.named_and_suspected(effects, suspects);
        let mut provenance = placed.provenance;
        provenance["verdict"] = json!(verdict.word());
        let has_laws = unexplained.as_ref().is_some_and(|written| written.has_laws);
        let (corrected, other_corrected) = match unexplained {
            None => (corrected, placed.other_corrected),
            Some(written) => written.arms_with(&mut provenance),
        };
        add_calibrated(&mut provenance, &loaded.provenance);
        Outcome {
            verdict,
            reasons,
            effects,
            suspects,
            held_out,
            located: [loaded.located, positions::outcome::located(campaign, &placed.residuals)].concat(),
            next_tests,
            noise: Noise {
                outliers: [loaded.noise.outliers, placed.noise.outliers].concat(),
                ..loaded.noise
            },
            lack_of_fit: worse_fit(loaded.lack_of_fit, placed.lack_of_fit),
            residuals: [loaded.residuals, placed.residuals].concat(),
            corrected,
            other_corrected,
            provenance,
            stages,
            campaign: loaded.campaign,
            hash: loaded.hash,
            calibrated: loaded.calibrated,
            evidence: loaded.evidence,
            records: Vec::new(),
            empirical: if has_laws { loaded.empirical } else { Vec::new() },
            models: if has_laws { loaded.models } else { Vec::new() },
        }
    }

    /// The corrected arms for the case that some readings are not explained. They have the laws without a name, or the
    /// effects, that the other readings showed. If they predict positions worse than [`MOST_HARM`] allows, the arms are
    /// calibrated only.
    fn unexplained(&self) -> Unexplained {
        let error_mm = |stage: Option<&Stage>| stage.map_or(f64::INFINITY, |s| s.median_mm);
        let most_mm = MOST_HARM * error_mm(self.calibrated.stages.last());
        let without_laws = |calibrated: &Calibrated| Unexplained {
            arms: calibrated.written.clone(),
            placements: calibrated.placements.clone(),
            has_laws: false,
        };
        if let Some(with_laws) = self.with_laws.as_ref().filter(|c| error_mm(c.stages.last()) <= most_mm) {
            return Unexplained { has_laws: true, ..without_laws(with_laws) };
        }
        let told = self.last_calibration().map(|i| &self.placed.stages[i]);
        if self.told && error_mm(told) <= most_mm {
            let others = self.placed.other_corrected.iter().cloned();
            let arms = std::iter::once(self.corrected.clone()).chain(others).collect();
            return Unexplained { arms, placements: json!({}), has_laws: false };
        }
        without_laws(&self.calibrated)
    }

    /// The verdict on the arm as a whole. It is the less favourable of the verdicts from the positions and from the
    /// other readings.
    fn verdict(&self) -> Verdict {
        Verdict::on_all(&[self.loaded.verdict, self.placed.verdict])
    }

    /// The reasons of both outcomes, each with the kind of readings to which it belongs.
    fn reasons(&self, verdict: Verdict) -> Vec<String> {
        let of = |outcome: &Outcome, what: &str| {
            let mut out: Vec<String> = outcome.reasons.iter().map(|r| format!("{what}: {r}")).collect();
            if verdict == Verdict::Unexplained && outcome.verdict == Verdict::Explained {
                out.insert(0, format!("{what} alone would be explained by {}", labels(&outcome.effects)));
            }
            out
        };
        [of(&self.loaded, "the readings other than positions"), of(&self.placed, "the positions")].concat()
    }

    /// Index of the last stage of the positions that adds no effect (the name of an effect contains `@`); `None` if
    /// there is none.
    fn last_calibration(&self) -> Option<usize> {
        self.placed.stages.iter().rposition(|s| !s.added.contains('@'))
    }

    /// The table of position errors, stage by stage. Its rows are the stages of calibration alone, one row for the
    /// findings of the other readings if the positions were analysed with them, and then the effects found in
    /// positions.
    fn stages(&self) -> Vec<Stage> {
        let Some(last) = self.last_calibration() else { return Vec::new() };
        let mut out = self.calibrated.stages.clone();
        if self.told {
            let added = "what the other readings show".into();
            out.push(Stage { added, ..self.placed.stages[last].clone() });
        }
        out.extend(self.placed.stages[last + 1..].iter().cloned());
        out
    }

    /// Root mean squares of the residuals of held-out readings of both kinds together \[sigma\]. If only one kind has
    /// held-out readings, the result is that of this kind; `None` if neither has.
    ///
    /// `rms_before` is the error of calibration alone. The fit of the positions may already have effects that the other
    /// readings showed. Its root mean square is therefore multiplied by the median position error with calibration
    /// alone, divided by the median position error with these effects.
    fn held_out(&self) -> Option<HeldOut> {
        let (Some(loaded), Some(placed)) = (self.loaded.held_out, self.placed.held_out) else {
            return self.loaded.held_out.or(self.placed.held_out);
        };
        let median_mm = |s: Option<&Stage>| s.map_or(1.0, |s| s.median_mm);
        let told = median_mm(self.last_calibration().map(|i| &self.placed.stages[i]));
        let rigid = median_mm(self.calibrated.stages.last());
        let count = loaded.count + placed.count;
        let mean = |a: f64, b: f64| {
            ((loaded.count as f64 * a.powi(2) + placed.count as f64 * b.powi(2)) / count as f64).sqrt()
        };
        Some(HeldOut {
            rms_before: mean(loaded.rms_before, placed.rms_before * rigid / told),
            rms_after: mean(loaded.rms_after, placed.rms_after),
            rms_declared_after: mean(loaded.rms_declared_after, placed.rms_declared_after),
            count,
        })
    }
}
