//! Lists the small sets of effects that explain a handful of readings. With few rows there are always several such
//! sets.
//!
//! Sets of one, two and three effects are fitted, up to one effect more than the smallest explaining set has. A set is
//! kept if it explains the readings within their standard deviations, and if no smaller set that is a part of it does
//! so too. A set whose evidence is far below the best is dropped.
//!
//! The readings determine the properties in which all kept sets agree, masses and stiffnesses included. They do not
//! determine a property in which the sets differ.

use super::screening::{MOST_EFFECTS, Selection};
use super::search::{Scored, Search};
use crate::arm::effect::setup::Setup;
use crate::arm::effect::subject::Subject;
use crate::arm::structure::Piece;
use crate::reconcile::fit::descent::{Effort, Fit, fit};
use crate::reconcile::fit::interval::intervals;
use crate::reconcile::fit::stats::ln_chi_squared_tail;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::model::calibration::Calibration;
use crate::reconcile::model::estimate::{Estimate, Finding};
use crate::reconcile::model::parameters::{FreeParameter, Model};
use crate::reconcile::readings::campaign::Campaign;
use rayon::prelude::*;

/// Smallest number of rows of displacements, frequencies and bench readings from which one model can be chosen.
pub(crate) const FEWEST_ROWS: usize = 11;
/// Largest number of fits for sets of the same number of effects. If more would be needed, only the most promising
/// smaller sets are extended.
const MOST_FITS: usize = 6000;
/// A set of effects explains the readings if noise alone would give a misfit at least as large with a probability above
/// this.
const LEAST_PROBABILITY: f64 = 0.01;
/// Sets that explain the readings are left out if the logarithm of their evidence is this far below the best. The
/// limit is wide, because with few readings the evidence mostly repeats the prior.
const EVIDENCE_BELOW_BEST: f64 = 15.0;
/// A missing mass is reported if in every set the mass outboard of a joint differs from that of the arm file by more
/// than this fraction.
const LEAST_MASS_CHANGE: f64 = 0.02;
/// A stiffness is not identified if the ratio of its largest to its smallest possible value is larger than this.
const WIDEST_STIFFNESS_RATIO: f64 = 1.2;
/// Factors by which a stiffness is divided, and then multiplied, to find its possible range.
const STIFFNESS_FACTORS: [f64; 9] = [1.1, 1.2, 1.4, 1.7, 2.0, 3.0, 4.0, 6.0, 10.0];
/// Largest number of explaining sets, the best first, for which the stiffnesses are varied.
const MOST_PROFILES: usize = 6;

/// Fits every small set of effects of the campaign. In the result, `others` lists the sets that explain the readings,
/// the best first.
pub(crate) fn weigh(search: &Search) -> Selection {
    let baseline = scored(search, &[], &[]);
    let mut tried = vec![baseline.clone()];
    let mut level = tried.clone();
    // the search goes on to one effect more than the smallest explaining set has, because other effects may explain the
    // readings with as few parameters
    let mut beyond = false;
    for _ in 0..MOST_EFFECTS.min(search.forward.data.len()) {
        if beyond {
            break;
        }
        beyond = level.iter().any(|s| explains(search, s));
        level = extend(search, &level);
        tried.extend(level.iter().cloned());
    }
    let others = explaining(search, tried);
    let best = others.first().cloned().unwrap_or_else(|| baseline.clone());
    Selection { best, baseline, others, given_up: false }
}

/// Those of the sets `tried` that explain the readings and do not contain a smaller set that explains them, the best
/// first.
fn explaining(search: &Search, tried: Vec<Scored>) -> Vec<Scored> {
    let all: Vec<Scored> = tried.into_iter().filter(|s| explains(search, s)).collect();
    let within = |a: &Scored, b: &Scored| {
        a.effects.len() < b.effects.len() && a.effects.iter().all(|e| b.effects.contains(e))
    };
    let mut out: Vec<Scored> = all.iter().filter(|s| !all.iter().any(|t| within(t, s))).cloned().collect();
    out.sort_by(|a, b| b.score.total_cmp(&a.score).then(a.effects.cmp(&b.effects)));
    let top = out.first().map_or(0.0, |s| s.score);
    out.retain(|s| s.score > top - EVIDENCE_BELOW_BEST);
    out
}

/// Whether the misfit of the set `scored` is no larger than the standard deviations of the readings allow.
fn explains(search: &Search, scored: &Scored) -> bool {
    is_probable(search, scored, scored.objective)
}

/// Whether noise alone gives a misfit (chi-squared) of at least `misfit` with a probability above
/// [`LEAST_PROBABILITY`]. The degrees of freedom are those of the set `set`.
fn is_probable(search: &Search, set: &Scored, misfit: f64) -> bool {
    let readings = search.forward.data.len();
    let free = free_parameters(search, &set.effects);
    let dof = readings.saturating_sub(free).max(1) as f64;
    ln_chi_squared_tail(misfit, dof) > libm::log(LEAST_PROBABILITY)
}

fn free_parameters(search: &Search, effects: &[usize]) -> usize {
    effects.iter().map(|&e| search.candidates[e].free_parameters.len()).sum()
}

/// Fits every set that consists of a set of `level` (the sets of one size) and one more effect.
fn extend(search: &Search, level: &[Scored]) -> Vec<Scored> {
    let candidates = 0..search.candidates.len();
    let mut from: Vec<&Scored> = level.iter().collect();
    from.sort_by(|a, b| a.objective.total_cmp(&b.objective).then(a.effects.cmp(&b.effects)));
    // the number of fits is limited, and sets that fit badly seldom lead to one that explains
    from.truncate((MOST_FITS / candidates.len().max(1)).max(1));
    let mut sets: Vec<(Vec<usize>, &Scored, usize)> = from
        .into_iter()
        .flat_map(|base| candidates.clone().map(move |c| (base, c)))
        .filter(|(base, c)| !base.effects.contains(c))
        .map(|(base, c)| {
            let mut sorted = [base.effects.as_slice(), &[c]].concat();
            sorted.sort_unstable();
            (sorted, base, c)
        })
        .filter(|(sorted, ..)| sorted.len() <= search.forward.data.len())
        .collect();
    sets.sort_by(|a, b| a.0.cmp(&b.0));
    // the same set is reached from several smaller ones
    sets.dedup_by(|a, b| a.0 == b.0);
    sets.into_par_iter()
        .map(|(_, base, c)| {
            let effects = [base.effects.as_slice(), &[c]].concat();
            let starts = search.candidates[c].starts.iter();
            let starts: Vec<Vec<f64>> = starts.map(|s| [base.u.as_slice(), s].concat()).collect();
            scored(search, &effects, &starts)
        })
        .collect()
}

/// The best fit of the set of effects `effects` from several starts, with its score. Each start is a parameter
/// vector; without any, the fit starts at the nominal arm.
fn scored(search: &Search, effects: &[usize], starts: &[Vec<f64>]) -> Scored {
    let nothing = [vec![0.0; search.nuisance.numbers.len()]];
    let starts = if starts.is_empty() { &nothing } else { starts };
    let fits = starts.iter().map(|u| search.fit(effects, u, Effort::default()));
    let best =
        fits.min_by(|a, b| a.point.objective.total_cmp(&b.point.objective)).expect("at least one start");
    // without this charge, a size beyond the expected range would cost nothing if readings are few
    let strange: f64 = best
        .model
        .free_parameters()
        .zip(&best.point.u[best.model.calibrated()..])
        .map(|(k, u)| surprise(k, *u))
        .sum();
    let scored = search.scored(effects, &best);
    Scored { score: scored.score - strange, ..scored }
}

/// Charge for a parameter whose `u` is beyond its expected range \[ln of the evidence\]. The distance beyond the range
/// is treated as a normal deviate whose standard deviation is a quarter of the range's width.
fn surprise(parameter: &FreeParameter, u: f64) -> f64 {
    0.5 * (parameter.beyond_expected(u) / 0.25).powi(2)
}

/// Sentences on what the sets `explaining`, which explain the readings, have in common, and in what they differ.
pub(crate) fn sentences(
    search: &Search,
    campaign: &Campaign,
    baseline: &Fit,
    explaining: &[Scored],
) -> Vec<String> {
    let Some(first) = explaining.first() else {
        return vec![
            gap(search, baseline),
            format!("no {MOST_EFFECTS} effects of the library explain every reading"),
        ];
    };
    if first.effects.is_empty() {
        return vec!["noise and calibration within tolerance explain every reading".into()];
    }
    let mut out = vec![gap(search, baseline)];
    out.push(match explaining.len() {
        1 => format!("one set of effects explains every reading: {}", search.model(&first.effects).label()),
        n => format!(
            "{n} sets of effects explain every reading and cannot be told apart by these; the most probable: {}",
            explaining[..n.min(3)].iter().map(|s| search.model(&s.effects).label()).collect::<Vec<_>>().join("; ")
        ),
    });
    let subjects: Vec<Subject> =
        explaining.iter().map(|s| search.model(&s.effects).subject(search.forward, &s.u)).collect();
    out.extend(missing_mass(search, campaign, explaining, &subjects));
    out.extend(unidentified_stiffnesses(search, explaining, &subjects));
    out
}

/// Sentence on the reading at which the arm as given, calibrated within its tolerances (`baseline`), has its largest
/// error.
fn gap(search: &Search, baseline: &Fit) -> String {
    let sigmas = |i: usize| {
        let datum = &search.forward.data[i];
        ((datum.value - baseline.point.predicted[i]) / datum.sigma).abs()
    };
    let worst = (0..search.forward.data.len()).max_by(|&a, &b| sigmas(a).total_cmp(&sigmas(b)));
    let Some(i) = worst else { return "there is no reading".into() };
    let datum = &search.forward.data[i];
    format!(
        "the arm as given, calibrated within tolerance, cannot give the readings: {} row {} is {} where the arm has {:.2}",
        datum.channel.word(),
        datum.row + 1,
        datum.value,
        baseline.point.predicted[i]
    )
}

/// A sentence that names the outermost joint from which on, the joint included, the mass is wrong. Only sets of effects
/// that leave the stiffnesses unchanged are considered, and all of them must agree. `None` if there is no such joint.
/// `subjects` are the arms with the sets `explaining`.
fn missing_mass(
    search: &Search,
    campaign: &Campaign,
    explaining: &[Scored],
    subjects: &[Subject],
) -> Option<String> {
    let forward = search.forward;
    let nominal = &forward.nominal;
    let as_stiff: Vec<usize> = (0..subjects.len()).filter(|&i| is_as_stiff(&subjects[i], nominal)).collect();
    let first = explaining.get(*as_stiff.first()?)?;
    let payloads =
        campaign.modal.iter().map(|r| &r.payload).chain(campaign.statics.iter().map(|r| &r.payload));
    let stated = payloads.max_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg)).copied().unwrap_or_default();
    let names: Vec<String> = nominal.structure.joints().map(|j| j.name.clone()).collect();
    names.iter().rev().find_map(|joint| {
        let outboard = |s: &Subject| s.payload(&stated).mass_kg + outboard_kg(s, joint);
        let known_kg = outboard(nominal);
        // a wrong mass also changes the sum at every joint inboard of it, so the outermost joint is named
        let missing_kg = |i: &usize| outboard(&subjects[*i]) - known_kg;
        let (low, high) = span(as_stiff.iter().map(missing_kg));
        let (word, low, high) = if high < 0.0 { ("too much", -high, -low) } else { ("missing", low, high) };
        let kg =
            if high - low < 0.005 { format!("{low:.2} kg") } else { format!("{low:.2} to {high:.2} kg") };
        (low > LEAST_MASS_CHANGE * known_kg).then(|| {
            format!(
                "with the stiffnesses as given the masses cannot give the readings: {kg} are {word} at and beyond {joint}, \
                 where the arm file and the payload have {known_kg:.2} kg; most probably {} with {:.2} kg",
                search.model(&first.effects).label(),
                missing_kg(&as_stiff[0]).abs()
            )
        })
    })
}

/// Whether `subject` has exactly the compliances of the arm file (`nominal`). They are those of joints, bearings,
/// guides, links and base, and those that the tests add (servos, joints that soften, moduli that change).
fn is_as_stiff(subject: &Subject, nominal: &Subject) -> bool {
    let pieces = subject.structure.pieces.iter().zip(&nominal.structure.pieces);
    let same = |(a, b): (&Piece, &Piece)| match (a, b) {
        (Piece::Joint(a), Piece::Joint(b)) => {
            a.law == b.law && a.tilt_rad_per_nm == b.tilt_rad_per_nm && a.lean_rad_per_nm == b.lean_rad_per_nm
        }
        (Piece::Prismatic(a), Piece::Prismatic(b)) => {
            a.m_per_n == b.m_per_n && a.guide_rad_per_nm == b.guide_rad_per_nm
        }
        (Piece::Link(a), Piece::Link(b)) => a.beam == b.beam && a.root_frame == b.root_frame,
        _ => false,
    };
    let base =
        |s: &Subject| (s.structure.base_tilt_rad_per_nm, s.structure.base_lift, s.structure.base_frame);
    let soft =
        |setup: &Setup| (setup.servo_rad_per_nm.clone(), setup.softening.clone(), setup.load_twists.clone());
    let of_tests = |s: &Subject| (s.setups.each_ref().map(soft), s.warming);
    base(subject) == base(nominal) && of_tests(subject) == of_tests(nominal) && pieces.into_iter().all(same)
}

/// Mass of the joint with the name `joint` and of everything from it to the tip, without the payload \[kg\].
fn outboard_kg(subject: &Subject, joint: &str) -> f64 {
    let pieces = subject.structure.pieces.iter();
    let outboard = pieces.skip_while(|piece| piece.name() != joint);
    outboard
        .map(|piece| match piece {
            Piece::Joint(joint) => joint.mass_kg,
            Piece::Prismatic(joint) => joint.total_mass_kg(),
            Piece::Link(link) => link.mass_kg(),
        })
        .sum()
}

/// Stiffnesses of a joint with which the readings are still explained \[N m/rad\].
struct StiffnessRange {
    joint: String,
    low: f64,
    high: f64,
}

impl StiffnessRange {
    fn ratio(&self) -> f64 {
        self.high / self.low
    }
}

/// Sentences on joints whose stiffness cannot be identified: the readings are still explained with very different
/// values of this stiffness. The joint with the widest range comes first.
fn unidentified_stiffnesses(search: &Search, explaining: &[Scored], subjects: &[Subject]) -> Vec<String> {
    let joints = search.forward.nominal.structure.joints().filter(|j| !j.law.is_rigid());
    let mut ranges: Vec<StiffnessRange> = joints
        .map(|joint| {
            let ends = explaining.par_iter().zip(subjects).take(MOST_PROFILES).map(|(set, subject)| {
                let stiffness = stiffness_nm_per_rad(subject, &joint.name);
                let (low, high) = free_factors(search, set, &joint.name);
                (low * stiffness, high * stiffness)
            });
            let ends: Vec<(f64, f64)> = ends.collect();
            let (low, high) = span(ends.into_iter().flat_map(|(low, high)| [low, high]));
            StiffnessRange { joint: joint.name.clone(), low, high }
        })
        .filter(|range| range.ratio() > WIDEST_STIFFNESS_RATIO)
        .collect();
    ranges.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
    ranges
        .into_iter()
        .map(|StiffnessRange { joint, low, high }| {
            format!(
                "the stiffness of {joint} cannot be identified: the readings are explained as well with {low:.0} as with \
                 {high:.0} N m/rad"
            )
        })
        .collect()
}

fn stiffness_nm_per_rad(subject: &Subject, joint: &str) -> f64 {
    let joint = subject.structure.joints().find(|j| j.name == joint);
    joint.map_or(f64::INFINITY, |j| 1.0 / j.law.tangent_compliance_rad_per_nm(0.0))
}

/// Smallest and largest factor on the stiffness of the joint `joint` with which the set `set`, fitted again, still
/// explains the readings.
fn free_factors(search: &Search, set: &Scored, joint: &str) -> (f64, f64) {
    let mut nuisance = search.nuisance.clone();
    let index = nuisance.numbers.len();
    nuisance.numbers.push((Calibration::Stiffness(joint.to_string()), 1.0));
    let mut model = Model { nuisance: &nuisance, ..search.model(&set.effects) };
    let mut reach = |factors: &[f64]| {
        let mut u = set.u.clone();
        // the factor is an additional calibrated parameter with a prior of its own
        u.insert(index, 0.0);
        let mut reached = 1.0;
        for factor in factors {
            model.held = vec![(index, libm::log(*factor))];
            let fitted = fit(search.forward, &model, &u, search.weights, Effort::default());
            // the prior of the fixed factor is not part of the misfit
            let misfit = fitted.point.objective - libm::log(*factor).powi(2);
            if !is_probable(search, set, misfit) {
                break;
            }
            (reached, u) = (*factor, fitted.point.u);
        }
        reached
    };
    (reach(&STIFFNESS_FACTORS.map(|f| 1.0 / f)), reach(&STIFFNESS_FACTORS))
}

fn span(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// All effects of the sets `explaining`, which explain the readings, as findings. The interval of a parameter covers
/// its intervals in all sets that contain the effect. The alternatives are the effects of the sets without it. If the
/// effect is a stiffness and some set does not contain the effect, the interval has no upper end.
pub(crate) fn suspects(search: &Search, explaining: &[Scored], weights: &Weights) -> Vec<Finding> {
    let mut effects: Vec<usize> = Vec::new();
    for &e in explaining.iter().flat_map(|s| &s.effects) {
        if !effects.contains(&e) {
            effects.push(e);
        }
    }
    let fits: Vec<Vec<(usize, Vec<Estimate>)>> =
        explaining.par_iter().map(|s| estimates(search, s, weights)).collect();
    effects.iter().map(|&e| suspect(search, explaining, &fits, e)).collect()
}

/// For each effect of the set `set`, its index and its parameters with their intervals.
fn estimates(search: &Search, set: &Scored, weights: &Weights) -> Vec<(usize, Vec<Estimate>)> {
    let fit = search.fit(&set.effects, &set.u, Effort { steps: 0, tolerance: 0.0 });
    let mut ends = intervals(search.forward, &fit, weights).into_iter();
    let of = |(position, &e): (usize, &usize)| {
        let candidate = &search.candidates[e];
        let first = fit.model.first_parameter(position);
        let values = candidate.free_values(&fit.point.u[first..first + candidate.free_parameters.len()]);
        let free_parameters = candidate.free_parameters.iter().zip(values).zip(ends.by_ref());
        (e, free_parameters.map(|((parameter, value), end)| parameter.estimate(value, &end)).collect())
    };
    set.effects.iter().enumerate().map(of).collect()
}

fn suspect(
    search: &Search,
    explaining: &[Scored],
    fits: &[Vec<(usize, Vec<Estimate>)>],
    effect: usize,
) -> Finding {
    let candidate = &search.candidates[effect];
    let own: Vec<&Vec<Estimate>> =
        fits.iter().flatten().filter(|(e, _)| *e == effect).map(|(_, list)| list).collect();
    let absent = own.len() < explaining.len();
    let mut parameters: Vec<(String, Vec<Estimate>)> = Vec::new();
    for (k, parameter) in candidate.free_parameters.iter().enumerate() {
        let end = |of: fn(&Estimate) -> Option<f64>, pick: fn(f64, f64) -> f64| {
            own.iter().map(|list| of(&list[k])).reduce(|a, b| Some(pick(a?, b?))).flatten()
        };
        let high = end(|e| e.high, f64::max).filter(|_| !(absent && parameter.reversed()));
        let estimate = Estimate { value: own[0][k].value, low: end(|e| e.low, f64::min), high };
        match parameters.iter_mut().find(|(name, _)| name == parameter.name) {
            Some((_, list)) => list.push(estimate),
            None => parameters.push((parameter.name.to_string(), vec![estimate])),
        }
    }
    let mut others: Vec<(String, String)> = Vec::new();
    for &e in explaining.iter().filter(|s| !s.effects.contains(&effect)).flat_map(|s| &s.effects) {
        let name = (search.candidates[e].kind.name.to_string(), search.candidates[e].at.clone());
        if !others.contains(&name) {
            others.push(name);
        }
    }
    Finding {
        effect: candidate.kind.name.into(),
        at: candidate.at.clone(),
        parameters,
        indistinguishable_from: others,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::JointModel;
    use crate::arm::file::read_arm_document;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;

    #[test]
    fn an_arm_is_as_stiff_only_if_every_compliance_is_as_given() {
        let text = r#"{"chain": [{"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
            {"type": "link", "name": "l", "vector_m": [1, 0, 0], "mass_kg": 2}]}"#;
        let document = Document::parse("a", text).expect("JSON");
        let arm = read_arm_document(document, &Catalogs::default()).expect("an arm");
        let nominal = Subject::new(arm.structure(JointModel::default()));
        let changed = |change: fn(&mut Subject)| {
            let mut subject = nominal.clone();
            change(&mut subject);
            is_as_stiff(&subject, &nominal)
        };
        assert!(
            changed(|_| {})
                && changed(|s| s.payload_delta_kg = 1.0)
                && changed(|s| s.setups[0].mass_kg = 1.0)
        );
        assert!(!changed(|s| s.structure.base_tilt_rad_per_nm = 1e-6));
        assert!(!changed(|s| s.structure.base_frame.0[(0, 0)] = 1e-6));
        assert!(!changed(|s| s.setups[0].servo_rad_per_nm.push(("j".into(), 1e-5))));
    }
}
