//! The output bearing of a joint: its tilting stiffness, permissible moment, load ratings and mass.
//!
//! A bearing tilts about the two axes across the axis of the joint. The tilt is the moment across the axis over one
//! stiffness, which is the same about both axes: `γ = M / K` (Harmonic Drive AG, engineering data SHG-2UH 1021387,
//! page 45).

use super::keys::BEARING;
use crate::catalog::Catalogs;
use crate::catalog::gear::{BearingRatings, Gear, GearMass};
use crate::input::json::{Node, Object};
use serde_json::{Value, json};

/// The output bearing of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bearing {
    /// Tilting stiffness, the same about each of the two axes perpendicular to the axis of the joint \[N m/rad\];
    /// `None` means rigid.
    pub tilt_stiffness_nm_per_rad: Option<f64>,
    /// Largest moment across the axis that the vendor permits while the joint turns \[N m\]; `None` means unknown.
    pub permissible_moment_nm: Option<f64>,
    /// Mass of the bearing if it is a separate part, not contained in the mass of the gear \[kg\]. It is a point mass
    /// on the axis of the joint, inboard of its springs.
    pub mass_kg: f64,
    /// Lever along the axis from the centre of the bearing to the point where the link attaches \[m\]. `None` means
    /// that the lever is not stated; it is then `ratings.offset_m` plus half the width of the link.
    pub offset_m: Option<f64>,
    /// Ratings of the vendor for load and life.
    pub ratings: BearingRatings,
}

impl Bearing {
    /// The bearing inside a gear of the catalog; `None` for a component set, which has no bearing. `which` says whether
    /// the gear is bought as a housed unit or as a component set.
    ///
    /// A number that the catalog does not have stays unknown. A bearing of unknown tilting stiffness is taken as
    /// rigid.
    pub fn of_gear(gear: &Gear, which: GearMass) -> Option<Self> {
        (which == GearMass::HousedUnit).then_some(Self {
            tilt_stiffness_nm_per_rad: gear.tilting_stiffness_nm_per_rad,
            permissible_moment_nm: gear.permissible_tilting_moment_nm,
            mass_kg: 0.0,
            offset_m: None,
            ratings: gear.bearing,
        })
    }

    /// The bearing of a housed gear as a separate part, for use with a component set. Its mass is the mass of the
    /// housed unit less the mass of the component set. `None` if one of the two masses is unknown.
    fn as_part(gear: &Gear) -> Option<Self> {
        let mass_kg = gear.mass_housed_unit_kg? - gear.mass_component_set_kg?;
        Some(Self { mass_kg, ..Self::of_gear(gear, GearMass::HousedUnit)? })
    }

    /// Tilt per moment, about each of the two axes across the joint \[rad/(N m)\]; 0 if the bearing is rigid.
    pub fn tilt_rad_per_nm(&self) -> f64 {
        self.tilt_stiffness_nm_per_rad.map_or(0.0, |stiffness| 1.0 / stiffness)
    }

    /// This bearing with its tilting stiffness multiplied by `factor`. A rigid bearing stays rigid.
    pub(crate) fn stiffened(self, factor: f64) -> Self {
        Self { tilt_stiffness_nm_per_rad: self.tilt_stiffness_nm_per_rad.map(|k| k * factor), ..self }
    }

    /// Reads a bearing that a file describes by its numbers. Returns `None` after recording a fault.
    fn read(node: &Node) -> Option<Self> {
        let object = node.shaped(&BEARING)?;
        let positive =
            |key| object.or(key, None, |n| if n.is_null() { Some(None) } else { n.positive().map(Some) });
        let stiffness = positive("tilt_stiffness_nm_per_rad");
        let permissible = positive("permissible_moment_nm");
        let ratings = ["pitch_diameter_m", "static_load_rating_n", "dynamic_load_rating_n"].map(positive);
        let mass_kg = object.or("mass_kg", 0.0, Node::non_negative);
        let offset_m =
            object.or("offset_m", None, |n| if n.is_null() { Some(None) } else { n.number().map(Some) });
        let [pitch_diameter_m, static_load_rating_n, dynamic_load_rating_n] = ratings;
        Some(Self {
            tilt_stiffness_nm_per_rad: stiffness?,
            permissible_moment_nm: permissible?,
            mass_kg: mass_kg?,
            offset_m: offset_m?,
            ratings: BearingRatings {
                pitch_diameter_m: pitch_diameter_m?,
                offset_m: None,
                static_load_rating_n: static_load_rating_n?,
                dynamic_load_rating_n: dynamic_load_rating_n?,
            },
        })
    }

    /// The bearing of the housed gear whose name is the value of `node`. A fault is reported if the catalogs have no
    /// such gear, or if one of its two masses is unknown. Returns `None` after recording a fault.
    fn named(node: &Node, catalogs: &Catalogs) -> Option<Self> {
        let gear = match catalogs.gear(node.string()?) {
            Ok(gear) => gear,
            Err(unknown) => {
                return node
                    .fault(unknown.to_string(), "name a gear of the catalog, give numbers, or write null");
            }
        };
        Self::as_part(gear).or_else(|| {
            node.fault(
                "is no housed unit whose two masses the catalog knows",
                "`armwright catalog show gears` lists mass_housed_unit_kg and mass_component_set_kg",
            )
        })
    }

    /// The bearing as an arm file writes it: an object of stiffness, ratings, mass and lever.
    pub(crate) fn to_json(self) -> Value {
        json!({
            "tilt_stiffness_nm_per_rad": self.tilt_stiffness_nm_per_rad,
            "permissible_moment_nm": self.permissible_moment_nm,
            "mass_kg": self.mass_kg,
            "offset_m": self.offset_m,
            "pitch_diameter_m": self.ratings.pitch_diameter_m,
            "static_load_rating_n": self.ratings.static_load_rating_n,
            "dynamic_load_rating_n": self.ratings.dynamic_load_rating_n,
        })
    }
}

/// Where the bearing of a joint with a gear comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BearingSource {
    /// From the gear: a housed unit has one, a component set has none.
    OfGear,
    /// Stated by the file. `None` means that the joint has no bearing of its own: it does not tilt and adds no mass.
    Stated(Option<Bearing>),
}

impl BearingSource {
    /// The output bearing of the joint if `gear` is its gear, bought as `which` says (housed unit or component set).
    /// `None`: the joint has no bearing.
    pub fn with_gear(&self, gear: &Gear, which: GearMass) -> Option<Bearing> {
        match self {
            BearingSource::OfGear => Bearing::of_gear(gear, which),
            BearingSource::Stated(bearing) => *bearing,
        }
    }

    /// The bearing that the file states. `None` if the file states that there is none, or if the bearing comes from the
    /// gear.
    pub fn stated(&self) -> Option<Bearing> {
        match self {
            BearingSource::OfGear => None,
            BearingSource::Stated(bearing) => *bearing,
        }
    }
}

/// What a file states about the bearing of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stated {
    /// The file states nothing. The bearing of the gear is taken, if it has one.
    Nothing,
    /// The file states a bearing by its numbers or by the name of a part. `None`: the file has `null`, the joint does
    /// not tilt.
    Bearing(Option<Bearing>),
}

/// Reads the key `bearing` of a joint. Returns `None` after recording a fault.
pub(crate) fn read_bearing(object: &Object, catalogs: &Catalogs) -> Option<Stated> {
    object.or("bearing", Stated::Nothing, |n| {
        let bearing = match n.value() {
            Value::Null => None,
            Value::String(_) => Some(Bearing::named(n, catalogs)?),
            _ => Some(Bearing::read(n)?),
        };
        Some(Stated::Bearing(bearing))
    })
}
