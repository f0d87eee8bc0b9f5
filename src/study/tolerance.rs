//! Scatter: catalog ratings are averages, and real parts differ from them. Sampling shows which designs stay on a
//! front.
//!
//! A stated scatter of `p` is a log-normal factor on a catalog rating with the median 1: 95 % of the factors lie
//! between `1/(1+p)` and `1+p`, like the tolerances of a campaign. One factor belongs to one row of a catalog, and so
//! to every joint and design that uses this part. Each rating has its own stream of random numbers, made from the
//! seed and the name of the row. Its factors therefore do not depend on other parts on the front, on the number of
//! samples or on threads.
//!
//! | scatter | of | default |
//! |---|---|---|
//! | `gear_stiffness` | K1, K2 and K3 of a gear, together | 20 % |
//! | `bearing_stiffness` | the tilting stiffness of an output bearing | 20 % |
//! | `modulus` | E and G of a material, together | 3 % |
//! | `mass` | a gear's and a motor's mass, each | 2 % |
//!
//! The defaults are assumptions. The vendor calls the stiffnesses of gears and bearings "average values" and states no
//! scatter (Harmonic Drive SE, engineering data 1018856, 08/2018, p. 70). The default for the modulus is for metals.
//! The modulus of a laminate scatters more.

use super::outcome::Front;
use crate::catalog::Catalogs;
use crate::pareto::front::nondominated;
use crate::pareto::objectives::Objectives;
use crate::reconcile::model::estimate::Z_95;
use crate::report::picks::{self, Design, PICKS};
use crate::report::tolerance::{Fate, Scattered, percentiles};
use crate::search::scatter::{ChosenParts, Factors, Rating};
use crate::space::constraint::Constraints;
use crate::space::design_space::DesignSpace;
use crate::space::design_space::SpacePiece;
use crate::space::problem::ArmProblem;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of samples that are evaluated in parallel and then added to the tally, so that only one batch is held in
/// memory. The result does not depend on this number.
const SAMPLES_PER_BATCH: u32 = 256;

/// Names of the ratings that may scatter, each with the default scatter for a name without a value.
const KINDS: [(&str, f64); 4] =
    [("gear_stiffness", 0.20), ("bearing_stiffness", 0.20), ("modulus", 0.03), ("mass", 0.02)];

/// Scatter of catalog ratings, as fractions: 0.2 means 20 %.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tolerance {
    /// Scatter of each rating in the order of [`KINDS`]; 0 means no scatter.
    parts: [f64; 4],
}

/// A scatter, with the number of samples and the seed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Scatter of each catalog rating.
    pub tolerance: Tolerance,
    /// Number of samples to draw.
    pub samples: u32,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl FromStr for Tolerance {
    type Err = String;

    /// Reads a text such as `gear_stiffness=20%,bearing_stiffness=20%,modulus=3%,mass=2%`. A name without a value has
    /// its default scatter.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = [0.0; 4];
        for item in text.split(',').map(str::trim) {
            let (name, value) =
                item.split_once('=').map_or((item, None), |(n, v)| (n.trim(), Some(v.trim())));
            let Some(kind) = KINDS.iter().position(|(n, _)| *n == name) else {
                let known: Vec<&str> = KINDS.iter().map(|(n, _)| *n).collect();
                return Err(format!("\"{name}\" does not scatter; choose from {}", known.join(", ")));
            };
            if parts[kind] > 0.0 {
                return Err(format!("{name} is given twice"));
            }
            parts[kind] = value.map_or(Ok(KINDS[kind].1), part)?;
        }
        Ok(Self { parts })
    }
}

/// Parses a percentage or a fraction between 0 and 1, such as `20%` or `0.2`, and returns the fraction, 0.2.
pub fn part(text: &str) -> Result<f64, String> {
    let (number, scale) = text.strip_suffix('%').map_or((text, 1.0), |n| (n.trim_end(), 0.01));
    match number.parse::<f64>() {
        Ok(x) if x > 0.0 && x * scale < 1.0 => Ok(x * scale),
        _ => Err(format!("\"{text}\" is not a percentage above 0 % and below 100 %, such as 20%")),
    }
}

impl Tolerance {
    /// Name and scatter (a fraction) of each kind of rating whose scatter is not zero.
    fn named(&self) -> impl Iterator<Item = (&'static str, f64)> {
        KINDS.iter().zip(self.parts).map(|((name, _), part)| (*name, part)).filter(|(_, part)| *part > 0.0)
    }

    /// The scatter of the rating `figure` as a fraction; 0 if ratings of its kind do not scatter.
    fn of(&self, figure: &Rating) -> f64 {
        let [gear_stiffness, bearing_stiffness, modulus, mass] = self.parts;
        match figure {
            Rating::GearStiffness(_) => gear_stiffness,
            Rating::BearingStiffness(_) | Rating::StatedBearingStiffness(_) => bearing_stiffness,
            Rating::Modulus(_) => modulus,
            Rating::GearMass(_) | Rating::MotorMass(_) => mass,
        }
    }
}

/// The stream of random factors of one rating.
struct Stream {
    generator: Xoshiro256PlusPlus,
    sigma: f64,
}

impl Stream {
    fn new(seed: u64, figure: &Rating, part: f64) -> Self {
        let named = blake3::hash(format!("{seed} {figure:?}").as_bytes());
        Self { generator: Xoshiro256PlusPlus::from_seed(*named.as_bytes()), sigma: libm::log1p(part) / Z_95 }
    }

    /// A uniformly distributed number in (0, 1].
    fn uniform(&mut self) -> f64 {
        ((self.generator.next_u64() >> 11) + 1) as f64 / (1u64 << 53) as f64
    }

    /// The next random factor on the rating. Its logarithm is a normally distributed number, by the method of Box and
    /// Muller.
    fn factor(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * libm::log(self.uniform())).sqrt(), TAU * self.uniform());
        libm::exp(self.sigma * radius * libm::cos(angle))
    }
}

/// The result of one sample: which designs of the front meet the limits, which are still on the front, and which are
/// then its picks.
struct Sample {
    keeps_limits: Vec<bool>,
    on_front: Vec<usize>,
    /// For each of [`PICKS`], the index of the design that is this pick in the sample.
    picked: [Option<usize>; 4],
    /// The picks of the nominal front, with their objectives in the sample.
    picks: Vec<Design>,
}

/// A front whose designs are evaluated with scattered ratings.
struct Trial<'a> {
    parts: &'a ChosenParts<'a, 'a>,
    constraints: &'a Constraints,
    /// The designs of the front, with their nominal objectives.
    designs: &'a [Design],
    /// Indices of the nominal picks in `designs`.
    picks: &'a [usize],
}

impl Trial<'_> {
    fn sample(&self, factors: &Factors) -> Sample {
        let built = self.parts.built(factors);
        let all: Vec<Objectives> = (0..self.parts.len()).map(|i| built.objectives(i)).collect();
        let keeps_limits: Vec<bool> =
            all.iter().map(|o| !self.constraints.broken(o).contains(&true)).collect();
        let keeping: Vec<usize> = (0..all.len()).filter(|&i| keeps_limits[i]).collect();
        let points: Vec<[f64; 3]> = keeping.iter().map(|&i| all[i].minimized()).collect();
        let groups = nondominated(&points).expect("the model answers in numbers");
        let on_front: Vec<usize> = groups.concat().into_iter().map(|i| keeping[i]).collect();
        let as_built = |i: usize| with_objectives(&self.designs[i], i, &all[i]);
        let front: Vec<Design> = on_front.iter().map(|&i| as_built(i)).collect();
        let chosen = picks::picks(&front);
        let pick = |name| chosen.iter().find(|p| p.names.contains(&name)).map(|p| p.design.row);
        Sample {
            keeps_limits,
            on_front,
            picked: PICKS.map(pick),
            picks: self.picks.iter().map(|&i| as_built(i)).collect(),
        }
    }
}

/// A copy of `design` with the objectives `o` of one sample. `row` is the index of the design in the list of all
/// designs.
fn with_objectives(design: &Design, row: usize, o: &Objectives) -> Design {
    Design {
        tip_deflection_mm: o.tip_deflection_m * 1e3,
        mass_kg: o.mass_kg,
        lowest_mode_hz: o.lowest_mode_hz,
        row,
        ..design.clone()
    }
}

/// Samples a front: draws ratings of its parts and finds out which designs are then on the front. `designs` are the
/// rows of the front. `None` if the user stopped it.
pub fn scatter_front(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    front: &Front,
    designs: &[Design],
    sampling: &Sampling,
    stop: &AtomicBool,
) -> Option<Scattered> {
    // every sample computes the tables of the parts anew; to save time they have only the options of these designs
    let numbers: Vec<u128> = designs.iter().map(|d| front[d.row].design.number).collect();
    let place = |(row, design): (usize, &Design)| Design { row, ..design.clone() };
    let designs: &[Design] = &designs.iter().enumerate().map(place).collect::<Vec<_>>();
    let unrestricted = without_excerpt(problem);
    let space = unrestricted.excerpt(catalogs, &numbers)?;
    let small = ArmProblem::new(&space, catalogs);
    let chosen: Option<Vec<Vec<u32>>> = numbers.iter().map(|&n| small.options_of_whole(n)).collect();
    let parts = ChosenParts::new(&small, &chosen?)?;
    let tolerance = &sampling.tolerance;
    let mut streams: BTreeMap<Rating, Stream> = parts
        .ratings()
        .into_iter()
        .filter(|figure| tolerance.of(figure) > 0.0)
        .map(|figure| (figure.clone(), Stream::new(sampling.seed, &figure, tolerance.of(&figure))))
        .collect();
    let nominal = picks::picks(designs);
    let picks: Vec<usize> = nominal.iter().map(|p| p.design.row).collect();
    let trial = Trial { parts: &parts, constraints: &space.constraints, designs, picks: &picks };
    let mut tally = Tally::new(designs.len(), picks.len());
    let mut left = sampling.samples;
    while left > 0 {
        let batch = left.min(SAMPLES_PER_BATCH);
        left -= batch;
        let draw = |_| streams.iter_mut().map(|(figure, s)| (figure.clone(), s.factor())).collect();
        let factors: Vec<Factors> = (0..batch).map(draw).collect();
        let unless_stopped = |factors| (!stop.load(Ordering::Relaxed)).then(|| trial.sample(factors));
        let samples: Option<Vec<Sample>> = factors.par_iter().map(unless_stopped).collect();
        samples?.into_iter().for_each(|sample| tally.add(sample));
    }
    Some(tally.told(designs, &nominal, sampling))
}

/// The space of the problem, marked as if it were a whole space and not an excerpt. Designs then have the numbers that
/// they have in this space.
fn without_excerpt(problem: &ArmProblem) -> DesignSpace {
    let mut space = problem.space().clone();
    for piece in &mut space.pieces {
        if let SpacePiece::Choice(choice) = piece {
            choice.excerpt = None;
        }
    }
    space
}

/// Counts over all samples.
struct Tally {
    on_front: Vec<u32>,
    keeps_limits: Vec<u32>,
    picked: Vec<[u32; 4]>,
    without_design: u32,
    /// For each nominal pick, its objectives in every sample.
    picks: Vec<Vec<Design>>,
}

impl Tally {
    fn new(designs: usize, picks: usize) -> Self {
        Self {
            on_front: vec![0; designs],
            keeps_limits: vec![0; designs],
            picked: vec![[0; 4]; designs],
            without_design: 0,
            picks: vec![Vec::new(); picks],
        }
    }

    fn add(&mut self, sample: Sample) {
        self.without_design += u32::from(sample.on_front.is_empty());
        sample.on_front.iter().for_each(|&i| self.on_front[i] += 1);
        for (count, keeps) in self.keeps_limits.iter_mut().zip(sample.keeps_limits) {
            *count += u32::from(keeps);
        }
        for (name, picked) in sample.picked.into_iter().enumerate() {
            picked.into_iter().for_each(|i| self.picked[i][name] += 1);
        }
        for (all, one) in self.picks.iter_mut().zip(sample.picks) {
            all.push(one);
        }
    }

    fn told(self, designs: &[Design], nominal: &[picks::Pick], sampling: &Sampling) -> Scattered {
        let place = |row: usize| nominal.iter().position(|p| p.design.row == row);
        let fate = |(i, design): (usize, &Design)| Fate {
            design: design.clone(),
            picks: place(design.row).map_or(Vec::new(), |p| nominal[p].names.clone()),
            on_front: self.on_front[i],
            keeps_limits: self.keeps_limits[i],
            picked: self.picked[i],
            percentiles: place(design.row).map(|p| percentiles(&self.picks[p])),
        };
        Scattered {
            words: sampling
                .tolerance
                .named()
                .map(|(name, part)| format!("{name} {} %", round(100.0 * part)))
                .collect(),
            parts: sampling.tolerance.named().collect(),
            samples: sampling.samples,
            seed: sampling.seed,
            without_design: self.without_design,
            fates: designs.iter().enumerate().map(fate).collect(),
        }
    }
}

/// A percentage, rounded so that it has no error from its conversion from a fraction.
fn round(percent: f64) -> f64 {
    (percent * 1e9).round() / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scatter_is_read_with_defaults_and_faults_are_named() {
        let read = |text: &str| text.parse::<Tolerance>();
        assert_eq!(read("gear_stiffness=15%, mass"), Ok(Tolerance { parts: [0.15, 0.0, 0.0, 0.02] }));
        assert_eq!(read("modulus=0.05"), Ok(Tolerance { parts: [0.0, 0.0, 0.05, 0.0] }));
        assert_eq!(read("bearing_stiffness"), Ok(Tolerance { parts: [0.0, 0.2, 0.0, 0.0] }));
        for faulty in ["stiffness=20%", "mass=0", "mass=120%", "mass=1%,mass=2%", "mass=x", ""] {
            assert!(read(faulty).is_err(), "{faulty}");
        }
    }

    #[test]
    fn ninety_five_percent_of_the_factors_lie_within_the_stated_scatter_and_half_below_one() {
        let figure = Rating::GearStiffness("CSG-25-100".into());
        let mut stream = Stream::new(1, &figure, 0.2);
        let factors: Vec<f64> = (0..40_000).map(|_| stream.factor()).collect();
        let share = |within: &dyn Fn(f64) -> bool| {
            factors.iter().filter(|f| within(**f)).count() as f64 / factors.len() as f64
        };
        // the tolerances are three standard errors of a fraction that is estimated from 40,000 samples
        assert!((share(&|f| (1.0 / 1.2..=1.2).contains(&f)) - 0.95).abs() < 0.0033);
        assert!((share(&|f| f > 1.2) - 0.025).abs() < 0.0024);
        assert!((share(&|f| f < 1.0) - 0.5).abs() < 0.0075);
    }

    #[test]
    fn a_row_has_a_stream_of_its_own() {
        let first = |seed, name: &str| Stream::new(seed, &Rating::GearMass(name.into()), 0.1).factor();
        assert_eq!(first(1, "a"), first(1, "a"));
        assert_ne!(first(1, "a"), first(1, "b"));
        assert_ne!(first(1, "a"), first(2, "a"));
    }
}
