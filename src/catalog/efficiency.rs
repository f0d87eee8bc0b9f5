//! Efficiency of gears away from the rated point, for gears whose curves are in the catalog.
//!
//! There are two kinds of curve. For a single gear, the curve is the efficiency at rated torque against the input
//! speed. For a whole series, it is a factor `K_e` on the efficiency at rated torque, against the ratio of torque to
//! rated torque. Both hold for grease lubrication at about 20 °C. The efficiency of a sealed housed unit is a few
//! percentage points lower.

use super::gear::{Gear, GearKind};
use super::{Catalogs, Provenance};

/// The two kinds of curve in `gears_efficiency.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EfficiencyKind {
    /// The value is the efficiency at rated torque, and x is the input speed \[rpm\].
    AgainstInputSpeed,
    /// The value is a factor on the efficiency at rated torque, and x is the torque divided by the rated torque.
    FactorAgainstTorqueRatio,
}

impl EfficiencyKind {
    /// Words of the column `kind`.
    pub const WORDS: [&'static str; 2] =
        ["efficiency_at_rated_torque_vs_input_speed", "efficiency_factor_Ke_vs_torque_ratio"];

    /// The kind that a word of the column means; `None` if it is not one of [`Self::WORDS`].
    pub fn from_word(word: &str) -> Option<Self> {
        let kinds = [EfficiencyKind::AgainstInputSpeed, EfficiencyKind::FactorAgainstTorqueRatio];
        Self::WORDS.iter().position(|w| w.eq_ignore_ascii_case(word)).map(|i| kinds[i])
    }

    /// Unit of x, as the column `x_unit` writes it.
    pub fn x_unit(self) -> &'static str {
        match self {
            EfficiencyKind::AgainstInputSpeed => "rpm",
            EfficiencyKind::FactorAgainstTorqueRatio => "T/T_rated",
        }
    }
}

/// One point of an efficiency curve.
#[derive(Debug, Clone, PartialEq)]
pub struct EfficiencyPoint {
    /// Kind of the curve, which says what `x` and `value` are.
    pub kind: EfficiencyKind,
    /// Series as printed, e.g. `HFUC-2A` (component set) or `CSF/CSG` (both series).
    pub series: String,
    /// Size of the gear; `None` for a curve of whole series.
    pub size: Option<u32>,
    /// Reduction ratio of the gear; `None` for a curve of whole series.
    pub ratio: Option<f64>,
    /// Input speed \[rpm\], or torque divided by rated torque.
    pub x: f64,
    /// Efficiency, or factor on the efficiency, as `kind` says.
    pub value: f64,
    /// Source of the row.
    pub provenance: Provenance,
}

impl EfficiencyPoint {
    /// Whether the point belongs to a curve of this gear. A series may be printed with the ending `-2A` of the
    /// component set. Several series may be printed together, as in `CSF/CSG`. `also_sold_as` has other names of the
    /// gear's series.
    fn is_of(&self, gear: &Gear, also_sold_as: &[&str]) -> bool {
        let named = |name: &str| name == gear.series || also_sold_as.contains(&name);
        let series = self.series.trim_end_matches("-2A").split('/').any(named);
        series && self.size.is_none_or(|s| s == gear.size) && self.ratio.is_none_or(|r| r == gear.ratio)
    }
}

impl Catalogs {
    /// Efficiency of `gear` at rated torque and at an input speed \[rpm\], interpolated between the points of the
    /// gear's own curve.
    ///
    /// `None` if the catalog has no curve of this gear, or if the speed is outside the curve. The caller may then
    /// use [`Gear::efficiency`] (at 2000 rpm) and should say so. The four HFUC sizes 14 to 25 at 100:1 have a
    /// built-in curve.
    pub fn efficiency_at(&self, gear: &Gear, input_speed_rpm: f64) -> Option<f64> {
        interpolate(&self.efficiency_curve(gear, EfficiencyKind::AgainstInputSpeed), input_speed_rpm)
    }

    /// Factor on the efficiency at rated torque for another torque, which is the fraction `torque_over_rated` of the
    /// rated torque. It is interpolated between points.
    ///
    /// `None` if the catalog has no factor of this series, or if the fraction is outside its range (0.1 to 1 in the
    /// built-in file).
    pub fn efficiency_factor_at(&self, gear: &Gear, torque_over_rated: f64) -> Option<f64> {
        interpolate(&self.efficiency_curve(gear, EfficiencyKind::FactorAgainstTorqueRatio), torque_over_rated)
    }

    /// Efficiency of a gear at an input speed \[rpm\] and a fraction of its rated torque. It is computed from
    /// curves of similar gears, so it is representative and not a rating of the vendor. `None` without a rated
    /// efficiency, and for every gear that is not a strain-wave gear.
    ///
    /// The curve against speed is the gear's own curve, or the curve of HFUC-25-100 if the gear has none. It is scaled
    /// to the gear's efficiency at 2000 rpm. The factor for the torque is the gear's own factor, or the factor of
    /// HFUC-25-100 (series CSF and CSG) if the gear has none. Beyond their ends the curves are constant. The influence
    /// of temperature is left out.
    pub fn representative_efficiency(
        &self,
        gear: &Gear,
        input_speed_rpm: f64,
        torque_over_rated: f64,
    ) -> Option<f64> {
        // the curves were measured on strain-wave gears, so no other kind gets an efficiency from them
        let rated = gear.efficiency.filter(|_| gear.kind == GearKind::StrainWave)?;
        let model = |of: &Gear, kind| Some(self.efficiency_curve(of, kind)).filter(|curve| !curve.is_empty());
        let other = self.gear(REPRESENTATIVE_GEAR).ok();
        let curve = |kind| model(gear, kind).or_else(|| model(other?, kind));
        let speed = curve(EfficiencyKind::AgainstInputSpeed);
        let at_speed = speed.and_then(|c| Some(level(&c, input_speed_rpm)? / level(&c, RATED_RPM)?));
        let load = curve(EfficiencyKind::FactorAgainstTorqueRatio);
        let at_load = load.and_then(|c| level(&c, torque_over_rated));
        Some(rated * at_speed.unwrap_or(1.0) * at_load.unwrap_or(1.0))
    }

    /// The points of the efficiency curve of `gear` of the kind `kind`, in ascending order of x. Each point is x and
    /// the value. Empty if the catalog has no such curve.
    pub(super) fn efficiency_curve(&self, gear: &Gear, kind: EfficiencyKind) -> Vec<[f64; 2]> {
        let aliases = self.series_aliases.iter().filter(|(_, series)| **series == gear.series);
        let names: Vec<&str> = aliases.map(|(alias, _)| alias.as_str()).collect();
        let points = self.efficiency.iter().filter(|p| p.kind == kind && p.is_of(gear, &names));
        let mut curve: Vec<_> = points.map(|p| [p.x, p.value]).collect();
        curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
        curve
    }
}

/// The gear whose curves are used for gears that have no curves.
const REPRESENTATIVE_GEAR: &str = "HFUC-25-100";
/// Input speed at which the rated efficiency is stated \[rpm\].
const RATED_RPM: f64 = 2000.0;

/// Value of a curve at `x`, by linear interpolation between its points, which are sorted by x. Beyond the ends the
/// value is constant; `None` without points.
fn level(curve: &[[f64; 2]], x: f64) -> Option<f64> {
    let (first, last) = (curve.first()?, curve.last()?);
    interpolate(curve, x.clamp(first[0], last[0]))
}

/// Value of a curve at `x`, by linear interpolation between its points, which are sorted by x; `None` outside them.
fn interpolate(curve: &[[f64; 2]], x: f64) -> Option<f64> {
    let after = curve.iter().position(|point| point[0] >= x)?;
    let [x1, y1] = curve[after];
    if x1 == x {
        return Some(y1);
    }
    let [x0, y0] = *curve.get(after.checked_sub(1)?)?;
    Some(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn efficiency_is_linear_between_the_points_of_a_gear_and_unknown_beyond() {
        let catalogs = Catalogs::builtin();
        let gear = catalogs.gear("HFUC-14-100").expect("built in");
        let at = |rpm| catalogs.efficiency_at(gear, rpm);
        assert_eq!(at(500.0), Some(0.83));
        assert!((at(1500.0).expect("inside") - 0.775).abs() < 1e-12);
        assert_eq!(at(3500.0), Some(0.70));
        assert_eq!((at(499.0), at(3501.0)), (None, None));
    }

    #[test]
    fn a_gear_without_a_curve_has_no_efficiency_away_from_its_rated_point() {
        let catalogs = Catalogs::builtin();
        let gear = catalogs.gear("HFUC-58-100").expect("built in");
        assert_eq!(catalogs.efficiency_at(gear, 1000.0), None);
        assert!(gear.efficiency.is_some());
    }

    #[test]
    fn the_efficiency_of_a_gear_without_curves_follows_those_of_another_scaled_to_its_own() {
        let catalogs = Catalogs::builtin();
        let gear = |id: &str| catalogs.gear(id).expect("built in");
        let at = |id: &str, rpm, torque| catalogs.representative_efficiency(gear(id), rpm, torque).unwrap();
        let rated = gear("SHG-32-100").efficiency.unwrap();
        assert_eq!(at("SHG-32-100", 2000.0, 1.0), rated);
        // 0.82 / 0.78 is the ratio of the efficiencies at 1000 and 2000 rpm; the factor at half the rated torque is
        // 0.9
        assert!((at("SHG-32-100", 1000.0, 0.5) - rated * 0.82 / 0.78 * 0.9).abs() < 1e-12);
        assert_eq!(at("SHG-32-100", 100.0, 2.0), at("SHG-32-100", 500.0, 1.0));
        // the vendor's example (1019658, page 25): 0.78 at 1000 rpm becomes 0.73 at 57 % of the rated torque
        let factor = at("HFUC-20-80", 1000.0, 0.57) / at("HFUC-20-80", 1000.0, 1.0);
        // the vendor's factor is read off a chart with steps of 0.01
        assert!((0.78 * factor - 0.73).abs() < 0.01, "{factor}");
    }

    #[test]
    fn the_torque_factor_reaches_hfuc_through_its_other_name_csf() {
        let catalogs = Catalogs::builtin();
        let factor = |id: &str| catalogs.efficiency_factor_at(catalogs.gear(id).expect("built in"), 0.45);
        assert!((factor("HFUC-58-100").expect("CSF") - 0.875).abs() < 1e-12);
        assert!(factor("CSG-32-100").is_some());
        assert_eq!(factor("SHG-32-100"), None);
    }
}
