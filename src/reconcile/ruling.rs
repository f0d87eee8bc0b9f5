//! Reaches the verdict on an analysis of displacements, frequencies and bench readings, with its reasons.

use super::analysis::Analysis;
use super::fit::held_out::HeldOut;
use super::fit::{load_units, units};
use super::select::few_rows;
use super::select::lack_of_fit::LackOfFit;
use super::select::unnamed::Better;
use super::verdict::judgement::{
    NOTHING_MISSING, SHOWN_BY_ONE_FOLD, TOO_FAR_OFF, WEAK_EVIDENCE, does_not_predict, too_many_alternatives,
};
use super::verdict::outcome::Verdict;
use super::verdict::too_little::too_little;
use super::verdict::{caution, fitted};

impl Analysis<'_> {
    /// The verdict and the reasons for it.
    pub(super) fn verdict(&self, held_out: &Option<HeldOut>) -> (Verdict, Vec<String>) {
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
            return self.without_effect(Vec::new());
        }
        // a law that is only as good does not count against an effect that is only suspected
        if let Some(better) = self.unnamed.as_ref().filter(|law| law.is_clear() || self.without.is_none()) {
            return (Verdict::Unexplained, vec![self.beaten(better)]);
        }
        if let Some(text) = caution::opposed(self.forward, &self.best) {
            return (Verdict::Unexplained, vec![text]);
        }
        if let Some(in_series) = self.in_series.as_ref().filter(|found| found.gain < WEAK_EVIDENCE) {
            return (Verdict::InsufficientData, vec![in_series.sentence()]);
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
        if rms_after > rms_before + 0.02 {
            let [after, before] = [rms_after, rms_before].map(|rms| format!("{rms:.2} sigma"));
            let text = does_not_predict(&self.best.model.label(), &after, &before);
            return Some((Verdict::InsufficientData, text));
        }
        // a fit without the only fold that shows an effect knows nothing of the effect and cannot predict it
        let limit = if self.shows_in_one_fold() { TOO_FAR_OFF * self.expected_rms } else { TOO_FAR_OFF };
        (rms_after > limit).then(|| {
            let text = format!(
                "with {} the readings of poses held out of the fit are still {rms_after:.1} sigma off: something else is missing",
                self.best.model.label()
            );
            (Verdict::Unexplained, text)
        })
    }

    /// Verdict and reasons if no effect is named: `no_gap` if the readings scatter about as declared and no calibrated
    /// factor is rare. `suspected` is a sentence on an effect that is only suspected, if there is one.
    fn without_effect(&self, suspected: Vec<String>) -> (Verdict, Vec<String>) {
        let beyond = self.noise.beyond_declaration();
        if !beyond.is_empty() {
            let mut reasons = beyond;
            reasons.push(
                "noise as declared does not explain these readings: sigma in the file is too small, or the arm or the \
                 instrument does something there that no effect of the library describes"
                    .into(),
            );
            return (Verdict::Unexplained, reasons);
        }
        if suspected.is_empty()
            || !caution::has_rare(&self.baseline.point.u[..self.baseline.model.calibrated()])
        {
            return (Verdict::NoGap, [vec![self.nothing_missing()], suspected].concat());
        }
        let calibrated = fitted::calibrated(&self.baseline);
        let rare = caution::beyond_tolerance(fitted::tolerances(&self.baseline), &calibrated);
        (Verdict::InsufficientData, rare.into_iter().chain(suspected).collect())
    }

    /// Reason that is written for the verdict `no_gap`: which readings are explained.
    fn nothing_missing(&self) -> String {
        match self.noise.outliers.len() {
            0 => NOTHING_MISSING.into(),
            1 => format!("{NOTHING_MISSING} but one gross error"),
            count => format!("{NOTHING_MISSING} but {count} gross errors"),
        }
    }

    /// Verdict and reasons if the evidence for the best effects is weak. These effects are only suspected. The
    /// verdict is `no_gap` if calibration alone leaves only noise (`without` passes the test for lack of fit) and no
    /// calibrated factor is rare without the effects, otherwise `insufficient_data`.
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
            false => self.without_effect(vec![suspected]),
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

    /// Sentence which says that one of the best effects has the largest size that is sought; `None` if none has. It
    /// does not name the effect, because the effect may not be the right one.
    pub(super) fn at_a_limit(&self) -> Option<String> {
        let text = "the size of one of the best effects is the largest that is looked for: is arm.json the arm that was measured?";
        self.best.model.is_at_a_limit(&self.best.point.u).then(|| text.to_string())
    }

    /// Sentences on columns that seem to be in another unit, or to have another sign, than their names say. They are
    /// asked for where no effect explains the readings.
    pub(super) fn other_conventions(&self) -> Vec<String> {
        let mut out = units::other_conventions(self.forward);
        out.extend(load_units::other_units(self.campaign, self.search.nuisance));
        out
    }

    /// Sentences on the structure that the best model leaves in the residuals, without names of effects.
    fn left_over(&self) -> Vec<String> {
        let mut out = Vec::new();
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
            "the best model leaves {:.2} times the declared variance; no effect of the library can be named for the rest",
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
    /// library, or as well.
    fn beaten(&self, law: &Better) -> String {
        let start = match law.is_clear() {
            true => "the library lacks this law, and it explains the readings better than any effect of the library".into(),
            false => format!(
                "these readings cannot tell {} from a law that the library lacks, so that no effect is named",
                self.best.model.label()
            ),
        };
        let all = match law.put_back {
            0 => String::new(),
            rows => format!(" and with the {rows} row(s) that the effects leave out as gross errors"),
        };
        format!(
            "{start}: {} (chi-squared {:.0} with its {} parameter(s){all}, {:.0} with {} of the best effects; ln of the evidence \
             changes by {:+.1})",
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

    /// Whether the best model has a single effect, which the poses of one fold alone show. Even a right model then leaves an error of more than
    /// [`SHOWN_BY_ONE_FOLD`] standard deviations on held-out poses, so held-out poses cannot confirm it.
    pub(super) fn shows_in_one_fold(&self) -> bool {
        self.best.model.effects.len() == 1 && self.expected_rms > SHOWN_BY_ONE_FOLD
    }
}
