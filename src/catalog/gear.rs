//! Harmonic-drive (strain-wave) gears.

use super::Provenance;
use super::envelope::Envelope;

/// Which printed mass of a gear is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GearMass {
    /// Wave generator, flexspline and circular spline; no bearing, no housing.
    ComponentSet,
    /// With cross-roller bearing and housing.
    HousedUnit,
}

/// What the vendor prints of a housed unit's output bearing, for the check of its moments, its static
/// safety and its life. `None` is a figure the catalog does not give.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BearingRatings {
    /// Pitch circle diameter dp of the rollers \[m\].
    pub pitch_diameter_m: Option<f64>,
    /// Distance R from the bearing's centre to the face of the output flange \[m\].
    pub offset_m: Option<f64>,
    /// Static load rating C0 \[N\].
    pub static_load_rating_n: Option<f64>,
    /// Dynamic load rating C \[N\].
    pub dynamic_load_rating_n: Option<f64>,
}

/// One gear: series, size and ratio. `None` is a figure the catalog does not give.
#[derive(Debug, Clone, PartialEq)]
pub struct Gear {
    /// `series-size-ratio`, e.g. `HFUC-58-100`.
    pub id: String,
    /// Series, e.g. `CSG`.
    pub series: String,
    /// Size (about the pitch diameter in tenths of an inch).
    pub size: u32,
    /// Reduction ratio N.
    pub ratio: u32,
    /// Rated torque at 2000 rpm input \[N m\].
    pub rated_torque_nm: Option<f64>,
    /// Limit for repeated peak torque \[N m\].
    pub repeated_peak_torque_nm: Option<f64>,
    /// Limit for average torque \[N m\].
    pub average_torque_limit_nm: Option<f64>,
    /// Limit for momentary peak torque \[N m\].
    pub momentary_peak_torque_nm: Option<f64>,
    /// Largest input speed \[rpm\].
    pub max_input_speed_rpm: Option<f64>,
    /// Limit for average input speed \[rpm\].
    pub average_input_speed_limit_rpm: Option<f64>,
    /// Moment of inertia at the input (wave generator) \[kg m²\].
    pub inertia_input_kgm2: Option<f64>,
    /// Mass of the component set \[kg\].
    pub mass_component_set_kg: Option<f64>,
    /// Mass of the housed unit \[kg\].
    pub mass_housed_unit_kg: Option<f64>,
    /// Torsion curve: end of the first segment \[N m\].
    pub t1_nm: Option<f64>,
    /// Torsion curve: end of the second segment \[N m\].
    pub t2_nm: Option<f64>,
    /// Torsion curve: stiffness up to T1 \[N m/rad\].
    pub k1_nm_per_rad: Option<f64>,
    /// Torsion curve: stiffness between T1 and T2 \[N m/rad\].
    pub k2_nm_per_rad: Option<f64>,
    /// Torsion curve: stiffness beyond T2 \[N m/rad\].
    pub k3_nm_per_rad: Option<f64>,
    /// Hysteresis loss \[arcmin\].
    pub hysteresis_loss_arcmin: Option<f64>,
    /// Transmission accuracy \[arcmin\].
    pub transmission_accuracy_arcmin: Option<f64>,
    /// Tilting stiffness of the output bearing (housed unit) \[N m/rad\].
    pub tilting_stiffness_nm_per_rad: Option<f64>,
    /// Permissible tilting moment of the output bearing while the gear runs \[N m\].
    pub permissible_tilting_moment_nm: Option<f64>,
    /// Ratings of the output bearing (housed unit).
    pub bearing: BearingRatings,
    /// Torque at which the flexspline buckles \[N m\].
    pub buckling_torque_nm: Option<f64>,
    /// Torque at which the teeth jump \[N m\].
    pub ratcheting_torque_nm: Option<f64>,
    /// Outer size of the housed unit.
    pub envelope: Envelope,
    /// Efficiency at rated torque and 2000 rpm.
    pub efficiency: Option<f64>,
    /// Where the row comes from.
    pub provenance: Provenance,
}

impl Gear {
    /// Mass of the gear in the build a study asks for \[kg\].
    pub fn mass_kg(&self, which: GearMass) -> Option<f64> {
        match which {
            GearMass::ComponentSet => self.mass_component_set_kg,
            GearMass::HousedUnit => self.mass_housed_unit_kg,
        }
    }
}
