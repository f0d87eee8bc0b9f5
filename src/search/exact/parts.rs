//! What the bound sees of a part, and of a box of parts: every number as an interval.

use super::play::Play;
use super::tree::{Bounds, Key};
use crate::arm::{Beam, Curve, JointLaw, LinkModel, LinkPiece, Windup};
use crate::mechanics::beam::{line_stiffnesses, tube_inertia};
use crate::search::figures::StressCheck;
use crate::search::space::LinkOption;
use crate::sizing::{DriveLimits, JointDemand, JointMotion};

/// Number of [`Line`]'s inertias and of its stiffnesses.
pub(super) const INERTIAS: usize = 5;
pub(super) const STIFFNESSES: usize = 5;

/// A tube per metre: what moves and what yields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    /// Mass \[kg/m\], outer area \[m²\], rotary inertia about the link, its y and its z \[kg m\].
    pub inertias: [f64; INERTIAS],
    /// `EI` about y, `EI` about z, `κGA`, `GJ`, `EA`; infinite where the link model has no such strain.
    pub stiffnesses: [f64; STIFFNESSES],
}

/// Places in [`Line::inertias`].
pub(super) mod inertia {
    pub const MASS: usize = 0;
    pub const OUTER_AREA: usize = 1;
    pub const POLAR: usize = 2;
    pub const ROTARY_Y: usize = 3;
    pub const ROTARY_Z: usize = 4;
}

impl Line {
    /// A tube, and what hangs along it, under a link model.
    pub fn new(beam: &Beam, harness_kg_per_m: f64, model: LinkModel) -> Self {
        let tube = tube_inertia(beam, model);
        let yields = |place: usize| match model {
            LinkModel::Rigid => false,
            LinkModel::Bending => place < 2,
            LinkModel::Full => true,
        };
        let mut stiffnesses = line_stiffnesses(beam).map(|s| s / beam.flexibility);
        for (place, stiffness) in stiffnesses.iter_mut().enumerate() {
            if !yields(place) {
                *stiffness = f64::INFINITY;
            }
        }
        Self {
            inertias: [
                tube.along_kg_per_m + harness_kg_per_m,
                beam.section.properties(beam.material.poisson).outer_area_m2,
                tube.polar_kg_m,
                tube.rotary_y_kg_m,
                tube.rotary_z_kg_m,
            ],
            stiffnesses,
        }
    }
}

/// A box of link options.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LinkBox {
    pub low: Line,
    pub high: Line,
    /// Least stress over strength per axial force, moments about y and z, and torsion; zero where a
    /// strength is unknown.
    pub stress: [f64; 4],
    /// Whether some member is a round tube, whose bending about two axes adds up as a vector.
    pub round: bool,
    /// Least cost of the material \[EUR/m\].
    pub cost_eur_per_m: f64,
}

impl LinkBox {
    /// The box of one option, which the study's effects make this link.
    pub fn of(option: &LinkOption, link: &LinkPiece, model: LinkModel) -> Self {
        let nominal = Beam { material: option.material, section: option.section, flexibility: 1.0 };
        let line = Line::new(link.beam.as_ref().unwrap_or(&nominal), link.harness_kg_per_m, model);
        let check = StressCheck::new(option);
        let stress = check.as_ref().map_or([0.0; 4], |s| {
            [s.per_axial_n, s.per_moment_y, s.per_moment_z, s.per_torsion].map(|x| x / s.strength_pa)
        });
        Self {
            low: line,
            high: line,
            stress,
            round: check.is_none_or(|s| s.round),
            cost_eur_per_m: option.cost_eur_per_kg.unwrap_or(0.0) * option.mass_kg_per_m(),
        }
    }
}

fn pairwise<const N: usize>(a: &[f64; N], b: &[f64; N], pick: fn(f64, f64) -> f64) -> [f64; N] {
    std::array::from_fn(|i| pick(a[i], b[i]))
}

impl Bounds for LinkBox {
    fn join(&self, other: &Self) -> Self {
        let line = |a: &Line, b: &Line, pick| Line {
            inertias: pairwise(&a.inertias, &b.inertias, pick),
            stiffnesses: pairwise(&a.stiffnesses, &b.stiffnesses, pick),
        };
        Self {
            low: line(&self.low, &other.low, f64::min),
            high: line(&self.high, &other.high, f64::max),
            stress: pairwise(&self.stress, &other.stress, f64::min),
            round: self.round || other.round,
            cost_eur_per_m: self.cost_eur_per_m.min(other.cost_eur_per_m),
        }
    }

    /// Mass counts twice: it is an objective, and it loads everything inboard. Shear and stretch hardly
    /// move any objective.
    fn key(&self) -> Key {
        let s = self.low.stiffnesses.map(|s| if s.is_finite() { s.ln() } else { 0.0 });
        [2.0 * self.low.inertias[inertia::MASS].ln(), s[0], 0.7 * s[1], 0.1 * s[2], 0.3 * s[3]]
    }
}

/// Stiffness of a rigid gear beside lost motion: to any that yields it adds a part in 1e9 at the most \[N m/rad\].
const RIGID_NM_PER_RAD: f64 = 1e18;

/// A torsion curve between two: stiffest and softest slope at every torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CurveBox {
    /// Nowhere softer than a member; of one curve, the curve.
    pub stiff: Windup,
    /// Nowhere stiffer than a member; of one curve, the curve.
    pub soft: Windup,
    /// Whether modes see the first slope under any torque.
    pub k1_in_modes: bool,
}

impl CurveBox {
    /// The box of one joint's law without its play; a joint that does not twist has none.
    pub fn of(law: &JointLaw) -> Option<Self> {
        let curve = match law.without_play() {
            Curve::Rigid if law.lost_motion.is_some() => Curve::Linear(RIGID_NM_PER_RAD),
            curve => curve,
        };
        let windup = curve.segments()?;
        Some(Self { stiff: windup, soft: windup, k1_in_modes: !matches!(curve, Curve::Windup(_)) })
    }

    /// Whether modes see one slope under all torques of these sizes, whichever gear it is, and its play does not change.
    pub fn keeps_its_slope(
        &self,
        play: Option<&Play>,
        [least_nm, most_nm]: [f64; 2],
        breaks: Breaks,
    ) -> bool {
        let between = |t_nm: f64| least_nm <= t_nm && t_nm <= most_nm;
        let keeps_its_segment = self.k1_in_modes
            || match self.stiff == self.soft {
                true => !between(self.stiff.t1_nm) && !between(self.stiff.t2_nm),
                false => !breaks.any_between(least_nm, most_nm),
            };
        keeps_its_segment && play.is_none_or(|play| play.stays(most_nm))
    }

    /// The greatest slope at torques of these sizes \[N m\].
    pub fn stiffest(&self, least_nm: f64, most_nm: f64) -> f64 {
        self.slopes(&self.stiff, least_nm, most_nm).fold(0.0, f64::max)
    }

    /// The least slope at torques of these sizes \[N m\].
    pub fn softest(&self, least_nm: f64, most_nm: f64) -> f64 {
        self.slopes(&self.soft, least_nm, most_nm).fold(f64::INFINITY, f64::min)
    }

    /// The greatest slope of the twist at torques of these sizes \[N m\], whatever modes see.
    pub fn steepest(&self, least_nm: f64, most_nm: f64) -> f64 {
        slopes(&self.stiff, least_nm, most_nm).fold(0.0, f64::max)
    }

    /// Least and most twist between two torques, with the play beside it \[rad\].
    pub fn twist(&self, play: Option<&Play>, [low, high]: [f64; 2]) -> [f64; 2] {
        let least = if low >= 0.0 { &self.stiff } else { &self.soft }.angle_rad(low);
        let most = if high >= 0.0 { &self.soft } else { &self.stiff }.angle_rad(high);
        let [less, more] = self.twist_of_play(play, [low, high]);
        [least + less, most + more]
    }

    /// What play adds to it.
    pub fn twist_of_play(&self, play: Option<&Play>, between_nm: [f64; 2]) -> [f64; 2] {
        let middle = [&self.stiff, &self.soft].map(|curve| 1.0 / curve.k2_nm_per_rad);
        play.map_or([0.0; 2], |play| play.twist(middle, between_nm))
    }

    /// The slopes that modes may see.
    fn slopes(&self, w: &Windup, least_nm: f64, most_nm: f64) -> impl Iterator<Item = f64> {
        let (least_nm, most_nm) = if self.k1_in_modes { (0.0, 0.0) } else { (least_nm, most_nm) };
        slopes(w, least_nm, most_nm)
    }

    pub fn join(&self, other: &Self) -> Self {
        let extreme = |a: &Windup, b: &Windup, k: fn(f64, f64) -> f64, t: fn(f64, f64) -> f64| Windup {
            k1_nm_per_rad: k(a.k1_nm_per_rad, b.k1_nm_per_rad),
            k2_nm_per_rad: k(a.k2_nm_per_rad, b.k2_nm_per_rad),
            k3_nm_per_rad: k(a.k3_nm_per_rad, b.k3_nm_per_rad),
            t1_nm: t(a.t1_nm, b.t1_nm),
            t2_nm: t(a.t2_nm, b.t2_nm),
        };
        Self {
            stiff: extreme(&rising(&self.stiff), &rising(&other.stiff), f64::max, f64::min),
            soft: extreme(&rising_below(&self.soft), &rising_below(&other.soft), f64::min, f64::max),
            k1_in_modes: self.k1_in_modes && other.k1_in_modes,
        }
    }
}

/// The lowest curve of slopes that do not fall with torque and are nowhere below these: of such curves the
/// largest slopes and the smallest break points make one that is nowhere below either.
fn rising(w: &Windup) -> Windup {
    let k2 = w.k1_nm_per_rad.max(w.k2_nm_per_rad);
    Windup { k2_nm_per_rad: k2, k3_nm_per_rad: k2.max(w.k3_nm_per_rad), ..*w }
}

/// The highest curve of slopes that do not fall with torque and are nowhere above these.
fn rising_below(w: &Windup) -> Windup {
    let k2 = w.k2_nm_per_rad.min(w.k3_nm_per_rad);
    Windup { k1_nm_per_rad: k2.min(w.k1_nm_per_rad), k2_nm_per_rad: k2, ..*w }
}

/// Slope and ends of each segment of a curve.
pub(super) fn segments(w: &Windup) -> [(f64, f64, f64); 3] {
    [
        (w.k1_nm_per_rad, 0.0, w.t1_nm),
        (w.k2_nm_per_rad, w.t1_nm, w.t2_nm),
        (w.k3_nm_per_rad, w.t2_nm, f64::INFINITY),
    ]
}

/// The slopes of the segments that torques of these sizes lie in.
fn slopes(w: &Windup, least_nm: f64, most_nm: f64) -> impl Iterator<Item = f64> {
    // a break point belongs to the segment below it
    let touched = move |&(_, from, to): &(f64, f64, f64)| least_nm <= to && (most_nm > from || from == 0.0);
    segments(w).into_iter().filter(touched).map(|(slope, ..)| slope)
}

/// The break points of a set of curves, on a grid of about 5 %.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Breaks([u64; 4]);

impl Breaks {
    const CELLS: f64 = 256.0;
    const OCTAVES: f64 = 18.0;
    const LEAST_LOG2: f64 = -4.0;

    /// Those of one curve.
    pub fn of(w: &Windup) -> Self {
        [w.t1_nm, w.t2_nm].into_iter().filter(|t| t.is_finite()).fold(Self::default(), |mut set, t_nm| {
            let cell = Self::cell(t_nm);
            set.0[cell / 64] |= 1 << (cell % 64);
            set
        })
    }

    fn join(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] | other.0[i]))
    }

    /// Whether a break point may lie between two torques \[N m\].
    fn any_between(&self, least_nm: f64, most_nm: f64) -> bool {
        (Self::cell(least_nm)..=Self::cell(most_nm)).any(|cell| self.0[cell / 64] >> (cell % 64) & 1 == 1)
    }

    /// Torques beyond the grid count to its ends.
    fn cell(t_nm: f64) -> usize {
        let at = (t_nm.log2() - Self::LEAST_LOG2) * (Self::CELLS / Self::OCTAVES);
        at.clamp(0.0, Self::CELLS - 1.0) as usize
    }
}

/// Torques that differ by less than this part may lie on the same side of a break point or not.
pub(super) const SAME_TORQUE: f64 = 1e-12;

/// Proportions of static torque and inertia in which a box of drives knows what it holds.
pub(super) const RAYS: usize = 12;

/// Demands in fixed proportions. A drive that holds a demand holds every ray's multiple below it, so a box
/// none of whose members does holds no demand above, though each single limit may be met by some member.
pub(super) struct Rays {
    /// Static torque \[N m\] and inertia \[kg m²\].
    loads: [(f64, f64); RAYS],
    demands: [JointDemand; RAYS],
}

impl Rays {
    /// Around the proportion that the payload alone asks for.
    pub fn new(motion: &JointMotion, payload_static_nm: f64, payload_inertia_kgm2: f64) -> Self {
        let loads = std::array::from_fn(|k| match k {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            _ if payload_static_nm > 0.0 => {
                (1.0, 1.25 * 0.8f64.powi(k as i32 - 2) * payload_inertia_kgm2 / payload_static_nm)
            }
            _ => (0.0, 1.0),
        });
        Self { demands: loads.map(|(static_nm, inertia)| motion.demand(static_nm, inertia)), loads }
    }

    /// How many times each ray's demand a drive holds.
    pub fn held(&self, limits: &DriveLimits) -> [f64; RAYS] {
        self.demands.each_ref().map(|demand| limits.multiple_of(demand))
    }
}

/// What a joint is asked for at least.
pub(super) struct Asked {
    pub demand: JointDemand,
    /// Multiples of the rays below it.
    multiples: [f64; RAYS],
}

impl Asked {
    /// A static torque and an inertia.
    pub fn new(motion: &JointMotion, rays: &Rays, static_nm: f64, inertia_kgm2: f64) -> Self {
        let times = |asked: f64, unit: f64| if unit > 0.0 { asked / unit } else { f64::INFINITY };
        let multiples =
            rays.loads.map(|(t, i)| times(static_nm, t).min(times(inertia_kgm2, i)) * (1.0 - 1e-12));
        Self { demand: motion.demand(static_nm, inertia_kgm2), multiples }
    }
}

/// A box of drives.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DriveBox {
    /// Least and largest mass \[kg\].
    pub mass_kg: [f64; 2],
    /// The largest of each limit.
    pub limits: DriveLimits,
    /// The smallest of each limit.
    pub least_limits: DriveLimits,
    /// The largest multiple of each ray's demand that a member holds.
    pub multiples: [f64; RAYS],
    pub curve: Option<CurveBox>,
    pub breaks: Breaks,
}

impl DriveBox {
    /// Whether a member may hold what is asked.
    #[inline]
    pub fn may_hold(&self, asked: &Asked) -> bool {
        self.limits.hold(&asked.demand)
            && self.multiples.iter().zip(&asked.multiples).all(|(held, asked)| held >= asked)
    }
}

impl Bounds for DriveBox {
    fn join(&self, other: &Self) -> Self {
        Self {
            mass_kg: [self.mass_kg[0].min(other.mass_kg[0]), self.mass_kg[1].max(other.mass_kg[1])],
            limits: self.limits.max(&other.limits),
            least_limits: self.least_limits.min(&other.least_limits),
            multiples: pairwise(&self.multiples, &other.multiples, f64::max),
            // a rigid member makes the stiff side rigid
            curve: self.curve.zip(other.curve).map(|(a, b)| a.join(&b)),
            breaks: self.breaks.join(&other.breaks),
        }
    }

    /// First by curve: drives with one gear share it. Then by mass.
    fn key(&self) -> Key {
        let k = self.curve.map_or([0.0; 3], |c| {
            [c.stiff.k1_nm_per_rad.ln(), c.stiff.k3_nm_per_rad.ln(), 0.2 * c.stiff.t1_nm.min(1e9).ln()]
        });
        [
            4.0 * k[0],
            2.0 * k[1],
            k[2],
            self.mass_kg[0].max(1e-3).ln(),
            3.0 * self.multiples[RAYS / 2].clamp(1e-9, 1e9).ln(),
        ]
    }
}
