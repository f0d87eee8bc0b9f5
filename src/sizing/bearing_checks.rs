//! The checks of an output bearing one by one, the ratings that are missing for them, and what helps where a check
//! fails.

use super::bearing::{self, BearingDemand, BearingLimits, BearingLoad};
use super::check::{Check, CheckKind, check, plain};
use super::demand::JointMotion;
use super::drive::known;
use crate::arm::bearing::{Bearing, BearingSource};
use crate::catalog::gear::{Gear, GearMass};

/// The four checks of an output bearing: moment while running, static safety at rest, static safety in an emergency
/// stop, life.
pub(crate) fn bearing_checks(bearing: &Bearing, motion: &JointMotion, demand: &BearingDemand) -> [Check; 4] {
    let speed_rad_s = motion.mean_speed_rad_s();
    let limits = BearingLimits::of(Some(bearing), speed_rad_s, motion.life_h);
    let ratings = &bearing.ratings;
    let known_pitch = |rating, name| {
        known(ratings.pitch_diameter_m, "bearing_pitch_diameter_m").and_then(|_| known(rating, name))
    };
    let moment_nm = limits.moment_nm(&demand.running);
    let permissible = known(bearing.permissible_moment_nm, "permissible_tilting_moment_nm");
    let safety = |kind, asked, load: &BearingLoad, limit_n: f64| {
        let load_n = limits.static_load_n(load);
        let rating = known_pitch(ratings.static_load_rating_n, "bearing_static_load_rating_n");
        check(kind, Ok(asked), rating.map(|c0_n| c0_n / load_n), load_n, rating.map(|_| limit_n))
    };
    let load_n = limits.dynamic_load_n(&demand.at_rest);
    let rating = known_pitch(ratings.dynamic_load_rating_n, "bearing_dynamic_load_rating_n");
    let life = rating.map(|c_n| bearing::life_h(c_n, load_n, speed_rad_s));
    [
        plain(CheckKind::BearingMoment, moment_nm, permissible),
        safety(CheckKind::BearingRest, bearing::SAFETY_AT_REST, &demand.at_rest, limits.at_rest_n),
        safety(CheckKind::BearingStop, bearing::SAFETY_IN_A_STOP, &demand.in_stop, limits.in_stop_n),
        check(CheckKind::BearingLife, Ok(motion.life_h), life, load_n, rating.map(|_| limits.life_n)),
    ]
}

/// The margin of an output bearing: the largest factor by which all its loads may grow together until one of its
/// checks fails. It equals [`BearingLimits::multiple_of`]. `None` if no check could be made.
pub fn bearing_margin(checks: &[Check]) -> Option<f64> {
    checks.iter().filter(|c| c.kind.is_bearing()).filter_map(Check::torque_margin).reduce(f64::min)
}

/// Ratings of an output bearing that are blank, so that some or all of its checks cannot be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlankRatings {
    /// Names of the blank ratings: columns of `gears.csv` for the bearing of a gear, keys of the study for a stated
    /// bearing.
    pub names: Vec<&'static str>,
    /// Whether no check at all can be made.
    pub nothing_is_checked: bool,
}

/// Names of the four ratings of a bearing: first as columns of the gear catalog, then as keys of a bearing that a
/// file states.
const RATINGS: [[&str; 4]; 2] = [
    [
        "permissible_tilting_moment_nm",
        "bearing_pitch_diameter_m",
        "bearing_static_load_rating_n",
        "bearing_dynamic_load_rating_n",
    ],
    ["permissible_moment_nm", "pitch_diameter_m", "static_load_rating_n", "dynamic_load_rating_n"],
];

impl BlankRatings {
    /// The blank ratings of the output bearing of a joint with this gear. `source` says where the bearing comes from,
    /// `which` whether the gear is a housed unit or a component set. `None` if all ratings are known or the joint has
    /// no bearing.
    pub fn of(source: &BearingSource, gear: &Gear, which: GearMass) -> Option<Self> {
        match source {
            BearingSource::OfGear => Self::under(&RATINGS[0], Bearing::of_gear(gear, which)?),
            BearingSource::Stated(bearing) => Self::of_stated((*bearing)?),
        }
    }

    /// The blank ratings of a bearing that a file states; `None` if all are known.
    pub fn of_stated(bearing: Bearing) -> Option<Self> {
        Self::under(&RATINGS[1], bearing)
    }

    /// The blank ratings of a bearing that a file states, or of the bearing of the gear that the file names, and the name
    /// of the gear if the bearing is the gear's. `None` if all are known.
    pub(crate) fn of_given<'g>(bearing: &Bearing, gear: Option<&'g Gear>) -> Option<(Self, Option<&'g str>)> {
        match gear.filter(|gear| is_of(bearing, gear)) {
            Some(gear) => Some((Self::under(&RATINGS[0], *bearing)?, Some(&gear.id))),
            None => Some((Self::of_stated(*bearing)?, None)),
        }
    }

    /// The blank ratings of a bearing. `names` are the names under which its four ratings are reported, in the order of
    /// [`RATINGS`]. `None` if all four are known.
    fn under(names: &[&'static str; 4], bearing: Bearing) -> Option<Self> {
        let ratings = bearing.ratings;
        let loads_n = [ratings.static_load_rating_n, ratings.dynamic_load_rating_n];
        let known = [bearing.permissible_moment_nm, ratings.pitch_diameter_m, loads_n[0], loads_n[1]];
        let names: Vec<&str> =
            names.iter().zip(known).filter(|(_, rating)| rating.is_none()).map(|(name, _)| *name).collect();
        let some_load = ratings.pitch_diameter_m.is_some() && loads_n.iter().any(Option::is_some);
        let nothing_is_checked = bearing.permissible_moment_nm.is_none() && !some_load;
        (!names.is_empty()).then_some(Self { names, nothing_is_checked })
    }

    /// The message, such as `bearing not checked: CSF-25-100 lacks bearing_static_load_rating_n`. `whose` lists the
    /// gears that have this bearing.
    pub fn words(&self, whose: &[&str]) -> String {
        let how_far = if self.nothing_is_checked { "" } else { " in full" };
        let lack = if whose.len() > 1 { "lack" } else { "lacks" };
        format!("bearing not checked{how_far}: {} {lack} {}", whose.join(", "), self.names.join(", "))
    }
}

/// Whether `bearing` is the output bearing of `gear` as a housed unit.
fn is_of(bearing: &Bearing, gear: &Gear) -> bool {
    Bearing::of_gear(gear, GearMass::HousedUnit).as_ref() == Some(bearing)
}

/// Names of the tilting stiffness: a column of the catalog of gears, and a key of a bearing that a file states.
const STIFFNESS: [&str; 2] = ["tilting_stiffness_nm_per_rad", "tilt_stiffness_nm_per_rad"];

/// A bearing whose tilting stiffness is unknown, so that it is taken as rigid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RigidBearing {
    /// Name under which the blank stiffness is reported, one of [`STIFFNESS`].
    lacks: &'static str,
}

impl RigidBearing {
    /// The output bearing of a joint with this gear, if its stiffness is unknown. `None` if the stiffness is known, the
    /// joint has no bearing, or the joint slides.
    pub(crate) fn of(source: &BearingSource, gear: &Gear, which: GearMass) -> Option<Self> {
        let has_stiffness = source.with_gear(gear, which)?.tilt_stiffness_nm_per_rad.is_some();
        let lacks = match source {
            BearingSource::OfGear => STIFFNESS[0],
            BearingSource::Stated(_) => STIFFNESS[1],
        };
        (!has_stiffness && !gear.kind.slides()).then_some(Self { lacks })
    }

    /// A bearing that a file states, or the bearing of the gear that the file names, if its stiffness is unknown; else
    /// `None`. The second value is the name of the gear if the bearing is the gear's.
    pub(crate) fn of_given<'g>(bearing: &Bearing, gear: Option<&'g Gear>) -> Option<(Self, Option<&'g str>)> {
        if bearing.tilt_stiffness_nm_per_rad.is_some() {
            return None;
        }
        match gear.filter(|gear| is_of(bearing, gear)) {
            Some(gear) => Some((Self { lacks: STIFFNESS[0] }, Some(&gear.id))),
            None => Some((Self { lacks: STIFFNESS[1] }, None)),
        }
    }

    /// The message, such as `rigid output bearing: TPMA-50-55 lacks tilting_stiffness_nm_per_rad (the tip deflects more
    /// than printed)`. `whose` lists the gears that have this bearing.
    pub(crate) fn words(&self, whose: &[&str]) -> String {
        let lack = if whose.len() > 1 { "lack" } else { "lacks" };
        format!(
            "rigid output bearing: {} {lack} {} (the tip deflects more than printed)",
            whose.join(", "),
            self.lacks
        )
    }
}

/// The ratings that a separate output bearing needs so that it passes the checks `failed`, in words: of static and of
/// dynamic load, how many times as large as those of the bearing that fails. `None` if checks of other parts fail too,
/// which another bearing does not help.
pub(super) fn bearing_that_holds(failed: &[Check]) -> Option<String> {
    if failed.is_empty() || failed.iter().any(|check| !check.kind.is_bearing()) {
        return None;
    }
    let of = |kinds: &[CheckKind]| {
        let margins =
            failed.iter().filter(|check| kinds.contains(&check.kind)).filter_map(Check::torque_margin);
        margins.reduce(f64::min).map(|margin| (100.0 / margin).ceil() / 100.0)
    };
    let moment = failed.iter().find(|check| check.kind == CheckKind::BearingMoment);
    let moment = moment
        .and_then(|check| check.needed)
        .map(|nm| format!("permissible_moment_nm of at least {}", nm.ceil()));
    let statically = of(&[CheckKind::BearingRest, CheckKind::BearingStop])
        .map(|times| format!("static_load_rating_n at least {times} times as large"));
    let life = of(&[CheckKind::BearingLife])
        .map(|times| format!("dynamic_load_rating_n at least {times} times as large"));
    let ratings: Vec<String> = [moment, statically, life].into_iter().flatten().collect();
    (!ratings.is_empty())
        .then(|| format!("a bearing of the joint's own (\"bearing\") with {}", ratings.join(", ")))
}
