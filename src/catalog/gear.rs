//! Gears of any kind: strain-wave (harmonic drive), planetary, cycloidal, belt and spur. A direct drive and an
//! integrated actuator also have an entry here, so that every drive consists of a gear and a motor.

use super::Provenance;
use super::envelope::Envelope;
use super::motor::{Motor, MotorKind};
use std::fmt;

/// Kinds of gears, as in the column `kind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GearKind {
    /// Strain-wave gear (harmonic drive). Its input is the *wave generator*, an elliptical disc in a ball bearing. It
    /// deforms the *flexspline*, a thin toothed cup, whose teeth then mesh with a rigid ring, the *circular spline*. A
    /// blank cell means this kind.
    StrainWave,
    /// Planetary gear.
    Planetary,
    /// Cycloidal gear (RV).
    Cycloidal,
    /// Toothed belt and its pulleys.
    Belt,
    /// Spur or helical gear.
    Spur,
    /// Direct drive: there is no gear, and the motor turns the joint.
    Direct,
    /// The gear inside an actuator of `actuators.csv`. Its ratings hold for the whole actuator.
    Actuator,
    /// Ball screw of a prismatic joint: its ratings are forces, its ratio is in rad/m.
    Screw,
    /// Rack and pinion of a prismatic joint: its ratings are forces, its ratio is in rad/m.
    Rack,
}

impl GearKind {
    /// Words of the column `kind` of `gears.csv`. Actuators have no word, because they are in their own file.
    pub const WORDS: [&'static str; 6] = ["strain_wave", "planetary", "cycloidal", "belt", "spur", "direct"];

    /// The kind that a word of the column means; `None` if it is not one of [`Self::WORDS`].
    pub fn from_word(word: &str) -> Option<Self> {
        use GearKind::{Belt, Cycloidal, Direct, Planetary, Spur, StrainWave};
        let kinds = [StrainWave, Planetary, Cycloidal, Belt, Spur, Direct];
        Self::WORDS.iter().position(|w| w.eq_ignore_ascii_case(word)).map(|place| kinds[place])
    }

    /// The word for this kind.
    pub fn word(self) -> &'static str {
        match self {
            GearKind::Screw => "screw",
            GearKind::Rack => "rack",
            _ => Self::WORDS.get(self as usize).copied().unwrap_or("actuator"),
        }
    }

    /// Whether a gear of this kind drives a prismatic joint, so that forces take the place of torques.
    pub fn slides(self) -> bool {
        matches!(self, GearKind::Screw | GearKind::Rack)
    }

    /// Whether a blank rating of gears of this kind means that there is no limit. A direct drive has no teeth, an
    /// actuator is rated as a whole by the numbers of its motor, and a screw or rack may be stated with few ratings.
    pub fn has_no_ratings_of_its_own(self) -> bool {
        self.slides() || matches!(self, GearKind::Direct | GearKind::Actuator)
    }

    /// Whether the life of gears of this kind is limited by their bearings, so that it is always checked. The life of a
    /// belt, a direct drive or an actuator is checked only if its row states one.
    pub fn wears_out(self) -> bool {
        !self.slides() && !matches!(self, GearKind::Belt | GearKind::Direct | GearKind::Actuator)
    }

    /// The rated life if the cell is blank \[h\]: 7000 h for strain-wave gears, at rated torque and 2000 rpm;
    /// `None` for other kinds. Source: Harmonic Drive LLC, CSF/CSG catalog (L10 of the CSF wave-generator bearing).
    pub fn usual_life_h(self) -> Option<f64> {
        (self == GearKind::StrainWave).then_some(7_000.0)
    }

    /// The input speed of the rated life if the cell is blank \[rpm\]; `None` for other kinds than strain-wave
    /// gears.
    pub fn usual_life_speed_rpm(self) -> Option<f64> {
        (self == GearKind::StrainWave).then_some(2_000.0)
    }

    /// The exponent of torque in the life equation of gears of this kind, for a row whose cell is blank. It is 3 for
    /// the ball bearing of a wave generator (Harmonic Drive LLC, CSF/CSG catalog), and 10/3 for the roller bearings of
    /// other gears (ISO 281). Makers of cycloidal gears use 10/3 too; this statement is from memory.
    pub fn usual_life_exponent(self) -> f64 {
        if self == GearKind::StrainWave { 3.0 } else { 10.0 / 3.0 }
    }
}

impl fmt::Display for GearKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

/// The life equation of a gear. L10 is the life that 90 % of the gears reach: L10 = rated life (T_rated /
/// T_mean)^exponent (rated speed / n_mean). Where a row leaves a cell blank, the value of its [`GearKind`] is taken.
/// The number is `None` if the kind has no value either.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LifeLaw {
    /// L10 life at rated torque and at [`Self::rated_speed_rpm`] \[h\]; `None` if unknown.
    pub rated_h: Option<f64>,
    /// Input speed at which the rated life is stated \[rpm\]; `None` if unknown.
    pub rated_speed_rpm: Option<f64>,
    /// Exponent of the torque ratio in the life equation.
    pub exponent: f64,
}

impl LifeLaw {
    /// The life equation of a gear of this kind whose row leaves all cells of the equation blank.
    pub fn usual(kind: GearKind) -> Self {
        Self {
            rated_h: kind.usual_life_h(),
            rated_speed_rpm: kind.usual_life_speed_rpm(),
            exponent: kind.usual_life_exponent(),
        }
    }
}

/// The version of a gear whose printed mass is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GearMass {
    /// Component set: wave generator, flexspline and circular spline, without bearing and housing.
    ComponentSet,
    /// Housed unit: with cross-roller bearing and housing.
    HousedUnit,
}

/// Ratings of a housed unit's output bearing, for the checks of its moments, its static safety and its life. `None`
/// means that the catalog does not give the number.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BearingRatings {
    /// Pitch circle diameter dp of the rollers \[m\]; `None` if unknown.
    pub pitch_diameter_m: Option<f64>,
    /// Distance R from the bearing's centre to the face of the output flange \[m\]; `None` if unknown.
    pub offset_m: Option<f64>,
    /// Static load rating C0 \[N\]; `None` if unknown.
    pub static_load_rating_n: Option<f64>,
    /// Dynamic load rating C \[N\]; `None` if unknown.
    pub dynamic_load_rating_n: Option<f64>,
}

/// One gear: series, size and ratio. `None` means that the catalog does not give the number.
#[derive(Debug, Clone, PartialEq)]
pub struct Gear {
    /// Name of the gear: `series-size-ratio`, e.g. `HFUC-58-100`.
    pub id: String,
    /// Series, e.g. `CSG`.
    pub series: String,
    /// Kind of the gear.
    pub kind: GearKind,
    /// Size number of the maker. For harmonic drives it is about the pitch diameter in tenths of an inch.
    pub size: u32,
    /// Reduction ratio N.
    pub ratio: f64,
    /// Life equation of the gear.
    pub life: LifeLaw,
    /// Torque for which the life is stated \[N m\]; for harmonic drives at 2000 rpm input; `None` if unknown.
    pub rated_torque_nm: Option<f64>,
    /// Limit for repeated peak torque \[N m\]; `None` if unknown.
    pub repeated_peak_torque_nm: Option<f64>,
    /// Limit for average torque \[N m\]; `None` if unknown.
    pub average_torque_limit_nm: Option<f64>,
    /// Limit for momentary peak torque \[N m\]; `None` if unknown.
    pub momentary_peak_torque_nm: Option<f64>,
    /// Largest input speed \[rpm\]; `None` if unknown.
    pub max_input_speed_rpm: Option<f64>,
    /// Limit for average input speed \[rpm\]; `None` if unknown.
    pub average_input_speed_limit_rpm: Option<f64>,
    /// Moment of inertia at the gear's input (of the wave generator) \[kg m²\]; `None` if unknown.
    pub inertia_input_kgm2: Option<f64>,
    /// Mass of the component set \[kg\]; `None` if unknown.
    pub mass_component_set_kg: Option<f64>,
    /// Mass of the housed unit \[kg\]; `None` if unknown.
    pub mass_housed_unit_kg: Option<f64>,
    /// Torsion curve: end of the first segment \[N m\]; `None` if unknown.
    pub t1_nm: Option<f64>,
    /// Torsion curve: end of the second segment \[N m\]; `None` if unknown.
    pub t2_nm: Option<f64>,
    /// Torsion curve: stiffness up to T1 \[N m/rad\]; `None` if unknown.
    pub k1_nm_per_rad: Option<f64>,
    /// Torsion curve: stiffness between T1 and T2 \[N m/rad\]; `None` if unknown.
    pub k2_nm_per_rad: Option<f64>,
    /// Torsion curve: stiffness beyond T2 \[N m/rad\]; `None` if unknown.
    pub k3_nm_per_rad: Option<f64>,
    /// Hysteresis loss, as the vendor states it \[arcmin\]: the difference between the two output angles at zero
    /// torque, after a torque of one sign and after a torque of the other; `None` if unknown.
    pub hysteresis_loss_arcmin: Option<f64>,
    /// Backlash: play without torque \[arcmin\]; `None` if unknown.
    pub backlash_arcmin: Option<f64>,
    /// Lost motion \[arcmin\]: the rotation of the output between a few percent of the rated torque in one direction
    /// and in the other; `None` if unknown.
    pub lost_motion_arcmin: Option<f64>,
    /// Transmission accuracy, as the vendor states it \[arcmin\]: the difference between the actual output angle and
    /// the input angle divided by the ratio; `None` if unknown.
    pub transmission_accuracy_arcmin: Option<f64>,
    /// Tilting stiffness of the output bearing (housed unit) \[N m/rad\]; `None` if unknown.
    pub tilting_stiffness_nm_per_rad: Option<f64>,
    /// Permissible tilting moment of the output bearing while the gear runs \[N m\]; `None` if unknown.
    pub permissible_tilting_moment_nm: Option<f64>,
    /// Ratings of the output bearing (housed unit).
    pub bearing: BearingRatings,
    /// Torque at which the flexspline buckles \[N m\]; `None` if unknown.
    pub buckling_torque_nm: Option<f64>,
    /// Torque at which teeth slip past each other \[N m\]; `None` if unknown.
    pub ratcheting_torque_nm: Option<f64>,
    /// Outer size of the housed unit.
    pub envelope: Envelope,
    /// Efficiency at rated torque and 2000 rpm; `None` if unknown.
    pub efficiency: Option<f64>,
    /// Source of the row.
    pub provenance: Provenance,
}

impl Gear {
    /// A gear of which nothing but name, kind and ratio is known: it has the usual life of its kind, and no other
    /// number.
    pub(crate) fn unrated(id: &str, kind: GearKind, ratio: f64, provenance: Provenance) -> Self {
        Self {
            id: id.to_string(),
            series: id.to_string(),
            kind,
            size: 0,
            ratio,
            life: LifeLaw::usual(kind),
            rated_torque_nm: None,
            repeated_peak_torque_nm: None,
            average_torque_limit_nm: None,
            momentary_peak_torque_nm: None,
            max_input_speed_rpm: None,
            average_input_speed_limit_rpm: None,
            inertia_input_kgm2: None,
            mass_component_set_kg: None,
            mass_housed_unit_kg: None,
            t1_nm: None,
            t2_nm: None,
            k1_nm_per_rad: None,
            k2_nm_per_rad: None,
            k3_nm_per_rad: None,
            hysteresis_loss_arcmin: None,
            backlash_arcmin: None,
            lost_motion_arcmin: None,
            transmission_accuracy_arcmin: None,
            tilting_stiffness_nm_per_rad: None,
            permissible_tilting_moment_nm: None,
            bearing: BearingRatings::default(),
            buckling_torque_nm: None,
            ratcheting_torque_nm: None,
            envelope: Envelope::default(),
            efficiency: None,
            provenance,
        }
    }

    /// Mass of the gear \[kg\] as it is bought: as a component set or as a housed unit (`which`). `None` if this mass
    /// is blank.
    pub fn mass_kg(&self, which: GearMass) -> Option<f64> {
        match which {
            GearMass::ComponentSet => self.mass_component_set_kg,
            GearMass::HousedUnit => self.mass_housed_unit_kg,
        }
    }

    /// Outer size of the gear as it is bought, as a component set or as a housed unit (`which`). The catalog has the
    /// sizes of housed units only, so every size of a component set is unknown.
    pub(crate) fn envelope_as(&self, which: GearMass) -> Envelope {
        match which {
            GearMass::ComponentSet => Envelope::default(),
            GearMass::HousedUnit => self.envelope,
        }
    }

    /// Whether this gear and `motor` can make a drive. An actuator goes with its own motor only, and its motor
    /// goes with no other gear.
    pub fn goes_with(&self, motor: &Motor) -> bool {
        match (self.kind, motor.kind) {
            (GearKind::Actuator, MotorKind::OfActuator) => self.id == motor.id,
            (GearKind::Actuator, _) | (_, MotorKind::OfActuator) => false,
            _ => true,
        }
    }

    /// Names of the columns with numbers of the torsion curve that the catalog does not give but the curve needs. If
    /// the slopes are equal, or only K1 is given, the curve has one segment and needs no break points.
    pub fn missing_of_torsion(&self) -> Vec<&'static str> {
        let [k1, k2, k3] = [self.k1_nm_per_rad, self.k2_nm_per_rad, self.k3_nm_per_rad];
        if self.single_slope_nm_per_rad().is_some() {
            return Vec::new();
        }
        let figures = [
            ("k1_nm_per_rad", k1),
            ("k2_nm_per_rad", k2),
            ("k3_nm_per_rad", k3),
            ("t1_nm", self.t1_nm),
            ("t2_nm", self.t2_nm),
        ];
        // if no number of the curve is given, only K1 is named, because K1 alone would be enough
        let wanted = if figures.iter().all(|(_, figure)| figure.is_none()) { 1 } else { figures.len() };
        figures[..wanted].iter().filter(|(_, figure)| figure.is_none()).map(|(name, _)| *name).collect()
    }

    /// The slope of a torsion curve with one segment \[N m/rad\]: K1 if nothing else is given, or the common value
    /// of K1, K2 and K3 if a break point is blank. `None` for other curves.
    pub fn single_slope_nm_per_rad(&self) -> Option<f64> {
        let [k1, k2, k3] = [
            self.k1_nm_per_rad?,
            self.k2_nm_per_rad.unwrap_or(f64::NAN),
            self.k3_nm_per_rad.unwrap_or(f64::NAN),
        ];
        let alone = k2.is_nan() && k3.is_nan() && self.t1_nm.is_none() && self.t2_nm.is_none();
        let straight = k1 == k2 && k2 == k3 && (self.t1_nm.is_none() || self.t2_nm.is_none());
        (alone || straight).then_some(k1)
    }
}
