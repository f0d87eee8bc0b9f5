//! Drives of prismatic joints: ball screws, and racks with their pinions, as gears.
//!
//! A screw of lead p turns the motor by `2π/p` radians per metre of travel. A pinion of radius r turns it by `1/r`,
//! times the ratio of a gear at the pinion. With this ratio N, every equation of a joint holds along a travel. Torques
//! are then forces \[N\], angular speeds are speeds \[m/s\], and stiffnesses are in N/m. The motor's torque is `F / (N
//! η) + J N a` (Eqs 9 to 12 of docs/model.md). So a screw *is* a [`Gear`] whose ratings are forces.
//!
//! | of a screw | formula | source |
//! |---|---|---|
//! | buckling | F = 0.5 η₁ π² E I / L² (Euler) | THK, general catalog 514E, page A15-30 |
//! | critical speed | n = 0.8 · 60 λ² / (2π L²) √(E I / ρ A) | MISUMI 2025, page 1677 |
//! | life of the nut | L10 = (C / F_m)³ · 10⁶ turns | linearwizard.com, screw drives, calculation principles |
//! | stiffness of the shaft | E A / L, with both ends fixed 4 E A / L | the bar, the bar held at both ends |
//!
//! The factors depend on the ends of the shaft. In the order of [`Ends`], η₁ is 1/4, 1, 2, 4, and λ is 1.875, π, 3.927,
//! 4.730, the lowest root of the frequency equation of a uniform beam with these ends. F_m is the cubic mean of the
//! force over the way; the source gives the definition of C. The stiffness is taken with the nut farthest from the
//! supports of the shaft.
//!
//! I and A are the second moment and the area of the section at the root of the thread. E = 206 GPa and ρ = 7850 kg/m³
//! are the values of steel. The mass of the shaft turns with the motor and does not travel.

use super::bearing::RATED_TURNS;
use crate::catalog::gear::{Gear, GearKind, LifeLaw};
use crate::catalog::{Confidence, Provenance};
use std::f64::consts::PI;

/// Young's modulus of the shaft \[Pa\]: THK, general catalog 514E, page A15-30.
const YOUNGS_MODULUS_PA: f64 = 2.06e11;
/// Density of the shaft \[kg/m³\].
const DENSITY_KG_M3: f64 = 7850.0;
/// Fraction of Euler's buckling load that the makers allow (THK, page A15-30).
const OF_EULER: f64 = 0.5;
/// Fraction of the critical speed that the makers allow (MISUMI, page 1677).
const OF_CRITICAL: f64 = 0.8;

/// How the ends of a screw are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// One end fixed, the other free.
    FixedFree,
    /// Both ends supported.
    Supported,
    /// One end fixed, the other supported.
    FixedSupported,
    /// Both ends fixed.
    Fixed,
}

impl Ends {
    /// The words for the ends of a screw in files, each with its value.
    pub const WORDS: [(&'static str, Self); 4] = [
        ("fixed_free", Self::FixedFree),
        ("supported_supported", Self::Supported),
        ("fixed_supported", Self::FixedSupported),
        ("fixed_fixed", Self::Fixed),
    ];

    /// Euler's buckling load with these ends, divided by Euler's buckling load with both ends supported.
    fn buckling(self) -> f64 {
        match self {
            Self::FixedFree => 0.25,
            Self::Supported => 1.0,
            Self::FixedSupported => 2.0,
            Self::Fixed => 4.0,
        }
    }

    /// The lowest root λ of the frequency equation of a uniform beam with these ends. It determines the critical speed.
    fn root(self) -> f64 {
        match self {
            Self::FixedFree => 1.875_104,
            Self::Supported => PI,
            Self::FixedSupported => 3.926_602,
            Self::Fixed => 4.730_041,
        }
    }
}

/// A ball screw with its nut.
#[derive(Debug, Clone, PartialEq)]
pub struct Screw {
    /// Name of the screw.
    pub name: String,
    /// Travel of the nut per turn of the screw \[m\].
    pub lead_m: f64,
    /// Diameter at the root of the thread \[m\].
    pub root_diameter_m: f64,
    /// Length of the shaft between its supports, or from the fixed to the free end \[m\].
    pub length_m: f64,
    /// How the ends are held.
    pub ends: Ends,
    /// Dynamic load rating C of the nut \[N\]; `None` means that its life is not checked.
    pub dynamic_load_rating_n: Option<f64>,
    /// Largest axial force \[N\], such as the static load rating divided by a factor; `None` means that it is not
    /// checked.
    pub max_force_n: Option<f64>,
    /// Largest speed that the balls allow \[rpm\]; `None` means that only the critical speed limits it.
    pub max_speed_rpm: Option<f64>,
    /// Turns of the motor per turn of the screw, by a belt or gear between them.
    pub ratio: f64,
    /// Efficiency of the screw, including the efficiency of a belt or gear.
    pub efficiency: f64,
    /// Stiffness of nut and end bearings in series \[N/m\]; `None` means rigid.
    pub series_n_per_m: Option<f64>,
    /// Moment of inertia in addition to the shaft, referred to the screw \[kg m²\], such as the inertia of a coupling
    /// or a pulley.
    pub further_inertia_kgm2: f64,
    /// Mass in addition to the shaft, which stays where the joint begins \[kg\].
    pub further_mass_kg: f64,
}

impl Screw {
    fn area_m2(&self) -> f64 {
        PI / 4.0 * self.root_diameter_m.powi(2)
    }

    fn second_moment_m4(&self) -> f64 {
        PI / 64.0 * self.root_diameter_m.powi(4)
    }

    fn shaft_kg(&self) -> f64 {
        DENSITY_KG_M3 * self.area_m2() * self.length_m
    }

    /// Axial force up to which the shaft does not buckle \[N\]: half of Euler's buckling load.
    pub fn buckling_n(&self) -> f64 {
        let euler_n = PI * PI * YOUNGS_MODULUS_PA * self.second_moment_m4() / self.length_m.powi(2);
        OF_EULER * self.ends.buckling() * euler_n
    }

    /// Largest speed \[rpm\]: 80 % of the shaft's critical speed, or the speed that the balls allow if that is smaller.
    pub fn max_speed_rpm(&self) -> f64 {
        let rigidity = YOUNGS_MODULUS_PA * self.second_moment_m4() / (DENSITY_KG_M3 * self.area_m2());
        let critical_rad_s = (self.ends.root() / self.length_m).powi(2) * rigidity.sqrt();
        let bent_rpm = OF_CRITICAL * critical_rad_s * 60.0 / (2.0 * PI);
        self.max_speed_rpm.map_or(bent_rpm, |balls_rpm| bent_rpm.min(balls_rpm))
    }

    /// Stiffness along the travel \[N/m\]: shaft, nut and bearings in series, with the nut where the shaft is most
    /// compliant.
    pub fn stiffness_n_per_m(&self) -> f64 {
        let held = if self.ends == Ends::Fixed { 4.0 } else { 1.0 };
        let shaft = self.length_m / (held * YOUNGS_MODULUS_PA * self.area_m2());
        1.0 / (shaft + self.series_n_per_m.map_or(0.0, |k| 1.0 / k))
    }

    /// Moment of inertia of the shaft and of the parts that turn with it, referred to the motor \[kg m²\].
    pub fn inertia_kgm2(&self) -> f64 {
        let at_screw = self.shaft_kg() * self.root_diameter_m.powi(2) / 8.0 + self.further_inertia_kgm2;
        at_screw / self.ratio.powi(2)
    }

    /// The screw as a gear whose ratings are forces. Its input is the motor's shaft, so its speeds are speeds of the
    /// motor.
    pub fn gear(&self) -> Gear {
        let turns_h = self.dynamic_load_rating_n.map(|_| RATED_TURNS / 60.0 * self.ratio);
        Gear {
            life: LifeLaw { rated_h: turns_h.map(|_| 1.0), rated_speed_rpm: turns_h, exponent: 3.0 },
            rated_torque_nm: self.dynamic_load_rating_n,
            momentary_peak_torque_nm: self.max_force_n,
            buckling_torque_nm: Some(self.buckling_n()),
            max_input_speed_rpm: Some(self.max_speed_rpm() * self.ratio),
            inertia_input_kgm2: Some(self.inertia_kgm2()),
            k1_nm_per_rad: Some(self.stiffness_n_per_m()),
            ..linear(GearKind::Screw, &self.name, 2.0 * PI / self.lead_m * self.ratio, self.efficiency)
                .weighing(self.shaft_kg() + self.further_mass_kg)
        }
    }
}

/// A rack with its pinion.
#[derive(Debug, Clone, PartialEq)]
pub struct Rack {
    /// Name of the rack.
    pub name: String,
    /// Pitch radius of the pinion \[m\].
    pub pinion_radius_m: f64,
    /// Turns of the motor per turn of the pinion.
    pub ratio: f64,
    /// Efficiency of pinion and gear.
    pub efficiency: f64,
    /// Largest force that rack and pinion transmit \[N\]; `None` means that it is not checked.
    pub max_force_n: Option<f64>,
    /// Largest speed of the gear's input \[rpm\]; `None` means that it is not checked.
    pub max_speed_rpm: Option<f64>,
    /// Stiffness along the travel \[N/m\].
    pub stiffness_n_per_m: f64,
    /// Moment of inertia at the motor \[kg m²\].
    pub inertia_kgm2: f64,
    /// Mass \[kg\], which stays where the joint begins.
    pub mass_kg: f64,
}

impl Rack {
    /// The rack as a gear whose ratings are forces.
    pub fn gear(&self) -> Gear {
        Gear {
            momentary_peak_torque_nm: self.max_force_n,
            max_input_speed_rpm: self.max_speed_rpm,
            inertia_input_kgm2: Some(self.inertia_kgm2),
            k1_nm_per_rad: Some(self.stiffness_n_per_m),
            ..linear(GearKind::Rack, &self.name, self.ratio / self.pinion_radius_m, self.efficiency)
                .weighing(self.mass_kg)
        }
    }
}

/// A gear of a prismatic joint for which only the ratio \[rad/m\] and the efficiency are known.
fn linear(kind: GearKind, name: &str, ratio: f64, efficiency: f64) -> Gear {
    let provenance = Provenance {
        source: "the study".into(),
        confidence: Confidence::Verified,
        unverified_fields: Vec::new(),
        file: "the study".into(),
        line: 0,
    };
    let life = LifeLaw { rated_h: None, rated_speed_rpm: None, exponent: 3.0 };
    Gear { life, efficiency: Some(efficiency), ..Gear::unrated(name, kind, ratio, provenance) }
}

impl Gear {
    /// This gear with `mass_kg` \[kg\] as its mass, both as a component set and as a housed unit.
    fn weighing(self, mass_kg: f64) -> Self {
        Self { mass_component_set_kg: Some(mass_kg), mass_housed_unit_kg: Some(mass_kg), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::super::demand::JointMotion;
    use super::super::limits::gear_life_h;
    use super::super::requirement::MotionRequirement;
    use super::*;

    /// A screw that is `length_m` long between its ends, of which one is fixed and the other supported; the shaft has
    /// 12.5 mm at the root of the thread.
    fn screw(length_m: f64) -> Screw {
        Screw {
            name: "15 x 5".into(),
            lead_m: 0.005,
            root_diameter_m: 0.0125,
            length_m,
            ends: Ends::FixedSupported,
            dynamic_load_rating_n: None,
            max_force_n: None,
            max_speed_rpm: None,
            ratio: 1.0,
            efficiency: 0.9,
            series_n_per_m: None,
            further_inertia_kgm2: 0.0,
            further_mass_kg: 0.0,
        }
    }

    /// MISUMI, catalog 2025, page 1676: 3630 N at 820 mm, with the factor m = 10 in place of 9.98.
    #[test]
    fn the_makers_example_of_buckling_comes_out() {
        assert!((screw(0.820).buckling_n() / 3630.0 - 1.0).abs() < 0.003, "{}", screw(0.820).buckling_n());
    }

    /// MISUMI, page 1677, and Engineers Edge's table: n = 15.1 d / L² · 10⁷ with d and L in mm, here at 790 mm.
    #[test]
    fn the_makers_factor_of_the_critical_speed_comes_out() {
        let by_table = 15.1 * 12.5 / (790.0 * 790.0) * 1e7;
        assert!((screw(0.790).max_speed_rpm() / by_table - 1.0).abs() < 0.005);
        let of = |ends, factor: f64| {
            let by_table = factor * 12.5 / (790.0 * 790.0) * 1e7;
            // the table has its factors with one decimal; an error of 0.05 in 3.4 is 1.5 %
            let speed_rpm = Screw { ends, ..screw(0.790) }.max_speed_rpm();
            assert!((speed_rpm / by_table - 1.0).abs() < 0.05 / factor, "{ends:?}");
        };
        of(Ends::FixedFree, 3.4);
        of(Ends::Supported, 9.7);
        of(Ends::Fixed, 21.9);
    }

    /// The worked example of the program MITCalc (ball screws, sections 1.1 to 1.25): lead 20 mm, 1000 N with a load
    /// factor of 1.2, 2400 rpm, 20 000 h ask for C = 17 073.1 N; with an efficiency of 0.9484 the torque is 3.3564 N m.
    #[test]
    fn a_worked_example_of_life_and_torque_comes_out() {
        let screw =
            Screw { lead_m: 0.02, dynamic_load_rating_n: Some(17_073.1), efficiency: 0.9484, ..screw(1.2) };
        let gear = screw.gear();
        // the efficiency is printed to four digits, which is 1.8e-4 N m
        assert!((1000.0 / (gear.ratio * screw.efficiency) - 3.3564).abs() < 2e-4);
        let motion = MotionRequirement::default().joint_motion(1.0, Some(2400.0 / 60.0 * 0.02));
        let always = JointMotion { mean_speed_fraction: 1.0, ..motion };
        let life_h = gear_life_h(&gear, &always, 1200f64.powi(3)).expect("known");
        assert!((life_h / 20_000.0 - 1.0).abs() < 1e-4, "{life_h}");
    }

    /// A belt of 1 : 2 before the screw: the motor turns twice as fast with half the torque, and the screw lives as
    /// long.
    #[test]
    fn a_belt_before_the_screw_changes_what_the_motor_sees_and_not_the_life() {
        let alone = Screw { dynamic_load_rating_n: Some(9000.0), further_inertia_kgm2: 1e-4, ..screw(0.8) };
        let belted = Screw { ratio: 2.0, ..alone.clone() };
        let [a, b] = [alone.gear(), belted.gear()];
        assert!((b.ratio / a.ratio - 2.0).abs() < 1e-15);
        assert!((alone.inertia_kgm2() / belted.inertia_kgm2() - 4.0).abs() < 1e-12);
        assert!((b.max_input_speed_rpm.unwrap() / a.max_input_speed_rpm.unwrap() - 2.0).abs() < 1e-12);
        let motion = MotionRequirement::default().joint_motion(1.0, Some(0.1));
        let [of_a, of_b] = [a, b].map(|gear| gear_life_h(&gear, &motion, 1e9).expect("known"));
        assert!((of_a / of_b - 1.0).abs() < 1e-12, "{of_a} {of_b}");
    }

    /// A screw held at both ends is most compliant in its middle, where its two halves act in parallel.
    #[test]
    fn a_shaft_yields_as_a_bar_and_in_series_with_its_nut() {
        let bar = 2.06e11 * PI / 4.0 * 0.0125f64.powi(2) / 0.8;
        assert!((screw(0.8).stiffness_n_per_m() / bar - 1.0).abs() < 1e-12);
        let both = Screw { ends: Ends::Fixed, series_n_per_m: Some(bar), ..screw(0.8) };
        assert!((both.stiffness_n_per_m() / (bar * 4.0 / 5.0) - 1.0).abs() < 1e-12);
    }
}
