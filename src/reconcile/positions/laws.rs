//! Tries competing laws: physics that is no effect in absolute positions, but looks like effects that were found, or
//! like sessions.
//!
//! A bent torsion curve of a joint looks like lost motion, and so does a backlash that follows the direction of motion.
//! A tool that bends looks like two compliant joints. A tracker that drifts, or links that grow, look like sessions.
//! Each law is linear in its amplitudes. It is tried in the place of every single effect that was found, of all effects
//! at one place, of all effects together, and of the sessions that nobody declared. If a law fits clearly better, these
//! effects and sessions are not named, and the verdict says which law fits better.

use super::analysis::Positions;
use super::fit::likeliest;
use super::fitted::{Fitted, Sample};
use super::kinematics::{Number, Placer};
use super::law::{CompetingLaws, Law};
use super::normal::Factor;
use super::rows::normal;
use super::search::{FULL_FITS, TIE};
use super::transmission::EFFECT;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Number of Gauss-Newton steps with which a law is fitted. The displacements by a law are small, so a few steps are
/// enough.
const STEPS: usize = 3;

/// Effects and sessions of the model in whose place a law is tried.
#[derive(Clone, Default, PartialEq)]
struct Group {
    /// Indices of candidates.
    effects: Vec<usize>,
    /// Indices of driven joints with a transmission error.
    transmissions: Vec<usize>,
    /// Indices of dependences of the nominal deflection.
    dependences: Vec<usize>,
    /// Whether the law takes the place of the sessions that were found.
    sessions: bool,
}

impl Group {
    /// A group of one effect.
    fn effect(candidate: usize) -> Self {
        Self { effects: vec![candidate], ..Self::default() }
    }

    /// A group of one transmission error.
    fn transmission(joint: usize) -> Self {
        Self { transmissions: vec![joint], ..Self::default() }
    }

    /// A group of one effect on the nominal deflection.
    fn dependence(k: usize) -> Self {
        Self { dependences: vec![k], ..Self::default() }
    }

    /// This group with the effects of another one added.
    fn with(mut self, other: &Self) -> Self {
        self.effects.extend(&other.effects);
        self.transmissions.extend(&other.transmissions);
        self.dependences.extend(&other.dependences);
        self
    }
}

impl Positions {
    /// Sentence that effects or sessions of the model must not be named, because a competing law explains the positions
    /// better. `None` if no law does.
    pub(super) fn better_law(&self, campaign: &Campaign) -> Option<String> {
        let competing = CompetingLaws::new(self, campaign);
        let better = self.groups().into_iter().filter_map(|group| {
            let (law, gain) = self.best_law(&competing, &group)?;
            Some((
                gain,
                format!(
                    "{} explains the positions better than {}",
                    competing.words(&law),
                    self.words(&group)
                ),
            ))
        });
        better.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, sentence)| sentence)
    }

    /// The groups of effects in whose place laws are tried: each by itself, all at one place, all together, and sessions.
    fn groups(&self) -> Vec<Group> {
        let effects = self.fitted.effects.iter().map(|c| (self.candidates[*c].at.clone(), Group::effect(*c)));
        let uneven =
            self.transmissions.iter().map(|j| (self.tree.driven[*j].clone(), Group::transmission(*j)));
        let dependent = self.named_dependences.iter().map(|k| {
            let at = self.dependences[*k].effect().map_or("", |(_, at)| at);
            (at.to_string(), Group::dependence(*k))
        });
        let single: Vec<(String, Group)> = effects.chain(uneven).chain(dependent).collect();
        let mut out: Vec<Group> = single.iter().map(|(_, group)| group.clone()).collect();
        let together = |at: Option<&str>| {
            let own = single.iter().filter(|(place, _)| at.is_none_or(|at| at == place));
            own.fold(Group::default(), |sum, (_, group)| sum.with(group))
        };
        for (at, _) in &single {
            out.push(together(Some(at)));
        }
        out.push(together(None));
        if self.sessions.iter().any(|boundary| !boundary.declared) {
            out.push(Group { sessions: true, ..Group::default() });
        }
        let is_new = |i: &usize| out[*i] != Group::default() && !out[..*i].contains(&out[*i]);
        (0..out.len()).filter(is_new).map(|i| out[i].clone()).collect()
    }

    /// The names of the effects of a group in words.
    fn words(&self, group: &Group) -> String {
        let effects = group.effects.iter().map(|c| self.label(*c));
        let uneven = group.transmissions.iter().map(|j| format!("{EFFECT}@{}", self.tree.driven[*j]));
        let dependent = group.dependences.iter().map(|k| self.dependence_label(*k));
        let sessions = group.sessions.then(|| "sessions that nobody declared".to_string());
        effects.chain(uneven).chain(dependent).chain(sessions).collect::<Vec<_>>().join(" + ")
    }

    /// Price of a group of effects and sessions \[ln of the likelihood\].
    fn price_of_group(&self, group: &Group) -> f64 {
        self.prices(&group.effects)
            + group.transmissions.len() as f64 * self.transmission_price()
            + group.dependences.len() as f64 * self.dependence_price()
            + if group.sessions { self.sessions_price() } else { 0.0 }
    }

    /// The model without a group of effects and sessions, fitted again.
    fn without_group(&self, group: &Group) -> Self {
        let mut out = self.without_numbers(|number| match number {
            Number::Transmission(j, _) => group.transmissions.contains(j),
            Number::Effect(k) => group.dependences.contains(k),
            _ => false,
        });
        for joint in &group.transmissions {
            out.fitted.geometry.transmissions_rad[*joint] = [0.0; 4];
        }
        for k in &group.dependences {
            out.fitted.geometry.dependences[*k] = 0.0;
        }
        if group.sessions {
            out = out.without_found_sessions();
        }
        let rest: Vec<usize> =
            out.fitted.effects.iter().copied().filter(|e| !group.effects.contains(e)).collect();
        let all: Vec<&Sample> = out.samples.iter().collect();
        let fitted = likeliest(&all, &out.numbers, &rest, &out.fitted);
        Self { fitted, ..out }
    }

    /// The law that fits best in the place of a group, and how much more the law raises the logarithm of the likelihood
    /// than the group does, each less its price. `None` if no law is clearly better. All laws are screened with the
    /// linearized model, and the most promising are fitted in full.
    fn best_law(&self, competing: &CompetingLaws, group: &Group) -> Option<(Law, f64)> {
        let without = self.without_group(group);
        let counts: Vec<usize> = competing.laws.iter().map(Law::count).collect();
        let from_level = without.fitted.geometry.level_to_instrument();
        let gains = without.linear_gains(&without.fitted, &counts, true, &|sample, placer, columns| {
            competing
                .laws
                .iter()
                .for_each(|law| competing.push_columns(law, sample, placer, &from_level, columns));
        });
        let missing = self.fitted.ln_likelihood - without.fitted.ln_likelihood;
        let mut order: Vec<(&Law, f64)> = competing.laws.iter().zip(gains).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        order.truncate(FULL_FITS);
        order.retain(|(_, gain)| without.keeps_its_promise(*gain, missing));
        let named_price = self.price_of_group(group);
        let judged = order.into_par_iter().filter_map(|(law, _)| {
            let rise = without.with_law(competing, law)? - self.fitted.ln_likelihood;
            let worth = rise + named_price - self.price(law.numbers(), competing.laws.len());
            (worth > 0.0 && rise > TIE).then(|| (law.clone(), worth))
        });
        judged.collect::<Vec<_>>().into_iter().max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The logarithm of the likelihood of this model with the law `law`. Its amplitudes are found by Gauss-Newton
    /// steps, with all other numbers of the model fitted again after each. `None` if the positions do not determine the
    /// amplitudes.
    fn with_law(&self, competing: &CompetingLaws, law: &Law) -> Option<f64> {
        let mut samples = self.samples.clone();
        let mut sizes = vec![0.0; law.count()];
        let mut fitted: Fitted = self.fitted.clone();
        for _ in 0..STEPS {
            let from_level = fitted.geometry.level_to_instrument();
            let columns_of = |sample: &Sample, placer: &Placer, out: &mut Vec<Vector3<f64>>| {
                competing.push_columns(law, sample, placer, &from_level, out);
            };
            let all: Vec<&Sample> = samples.iter().collect();
            let normal = normal(&all, &self.numbers, &fitted, &|s, p, out| columns_of(s, p, out));
            let own: Vec<usize> = (0..normal.own + sizes.len()).collect();
            let step = Factor::new(&normal.curvature, &own)?.solve(&normal.gradient);
            sizes.iter_mut().zip(step.iter().skip(normal.own)).for_each(|(size, step)| *size += step);
            let mut placer = fitted.geometry.placer();
            for (sample, read) in samples.iter_mut().zip(&self.samples) {
                placer.place_m(sample.placing());
                let mut columns = Vec::with_capacity(sizes.len());
                columns_of(sample, &placer, &mut columns);
                let moved_m: Vector3<f64> = columns.iter().zip(&sizes).map(|(by, size)| by * *size).sum();
                sample.measured_m = read.measured_m - moved_m;
            }
            let all: Vec<&Sample> = samples.iter().collect();
            fitted = likeliest(&all, &self.numbers, &self.fitted.effects, &fitted);
        }
        Some(fitted.ln_likelihood)
    }
}
