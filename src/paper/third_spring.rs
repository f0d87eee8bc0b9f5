//! Arms that have the paper's three frequencies. Eq 16 has three springs: for joint 2, for joint 3 and for the
//! wrist.
//! Several arms have the paper's frequencies, so the frequencies do not determine the third spring.

use super::arm::PaperArm;
use super::coupled::{CoupledArm, masses_that_give};
use crate::arm::joint_law::Curve;
use crate::report::number::{fixed, percent_change};
use crate::report::table::{Column, Table};

/// The paper's three frequencies \[Hz\].
pub const PRINTED_HZ: [f64; 3] = [14.8, 74.6, 159.6];

/// One interpretation of the third spring of Eq 16 (K4 alone, or K4 in series with K5, or with K5 and K6), with the
/// masses that then give the paper's three frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Names of the joints that make up the third spring.
    pub spring: &'static str,
    /// Stiffness of the third spring \[N m/rad\].
    pub stiffness_nm_per_rad: f64,
    /// The arm with this third spring and these masses.
    pub arm: PaperArm,
    /// The three frequencies of this arm \[Hz\].
    pub frequencies_hz: [f64; 3],
    /// Lowest frequency with four times the stiffness of joint 2, divided by the lowest frequency with the
    /// stiffness of Table 1.
    pub four_times_joint_2: f64,
}

impl Reading {
    /// Mass at and beyond the wrist \[kg\].
    pub fn outboard_kg(&self) -> f64 {
        self.arm.wrist_kg + self.arm.load_kg
    }

    /// Largest relative difference between one of the three frequencies and the frequency that the paper prints.
    pub fn worst(&self) -> f64 {
        let gaps = self.frequencies_hz.iter().zip(PRINTED_HZ).map(|(f, p)| (f / p - 1.0).abs());
        gaps.fold(0.0, f64::max)
    }

    fn of(spring: &'static str, arm: PaperArm) -> Self {
        let frequencies_hz = CoupledArm::new(&arm).frequencies_hz();
        let stiffer = CoupledArm::new(&arm.with_stiffness_factors([4.0, 1.0, 1.0])).frequencies_hz();
        let stiffness_nm_per_rad = 1.0 / arm.curves[2].tangent_compliance_rad_per_nm(0.0);
        Self {
            spring,
            stiffness_nm_per_rad,
            frequencies_hz,
            four_times_joint_2: stiffer[0] / frequencies_hz[0],
            arm,
        }
    }
}

/// Stiffnesses K4, K5 and K6 of joints 4, 5 and 6 as printed \[N m/rad\].
const K4_K5_K6: [f64; 3] = [108e3, 108e3, 17.5e3];

/// Stiffness of the first `count` of joints 4, 5 and 6 in series \[N m/rad\].
fn in_series(count: usize) -> f64 {
    1.0 / K4_K5_K6[..count].iter().map(|k| 1.0 / k).sum::<f64>()
}

/// Every interpretation of the third spring, each with the masses that give the paper's frequencies. The masses are
/// found by Newton's method.
pub fn readings() -> Vec<Reading> {
    let springs = [
        ("K4 alone", in_series(1)),
        ("K4 and K5 in series", in_series(2)),
        ("K4, K5 and K6 in series", in_series(3)),
    ];
    springs
        .into_iter()
        .filter_map(|(name, stiffness)| {
            let [k2, k3, _] = PaperArm::table_1().curves;
            let start = PaperArm { curves: [k2, k3, Curve::Linear(stiffness)], ..PaperArm::table_1() };
            Some(Reading::of(name, masses_that_give(&start, PRINTED_HZ)?))
        })
        .collect()
}

/// The interpretation closest to Table 1: K4 and K5 in series, the wrist mass of the table, and a load of 7.33 kg
/// at 0.1238 m.
pub fn closest_reading() -> Reading {
    let [k2, k3, _] = PaperArm::table_1().curves;
    let arm = PaperArm {
        curves: [k2, k3, Curve::Linear(in_series(2))],
        load_kg: 7.33,
        third_link_m: 0.1238,
        ..PaperArm::table_1()
    };
    Reading::of("K4 and K5 in series, table's wrist, rounded load", arm)
}

/// The interpretations as a table.
pub fn table(readings: &[Reading]) -> Table {
    let mut table = Table::new(vec![
        Column::left("third spring"),
        Column::unit("stiffness", "N m/rad"),
        Column::unit("wrist", "kg"),
        Column::unit("load", "kg"),
        Column::unit("at", "m"),
        Column::unit("wrist and load", "kg"),
        Column::unit("frequencies", "Hz"),
        Column::right("4 x K of joint 2"),
    ]);
    for reading in readings {
        let frequencies = reading.frequencies_hz.map(|f| fixed(f, 3)).join(" / ");
        table.row([
            reading.spring.to_string(),
            fixed(reading.stiffness_nm_per_rad, 0),
            fixed(reading.arm.wrist_kg, 3),
            fixed(reading.arm.load_kg, 3),
            fixed(reading.arm.third_link_m, 4),
            fixed(reading.outboard_kg(), 3),
            frequencies,
            percent_change(reading.four_times_joint_2, 1),
        ]);
    }
    table
}
