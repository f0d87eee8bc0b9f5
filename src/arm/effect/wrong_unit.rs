//! `wrong_unit`: the readings of a channel are written in another unit than their column states, such as inches, metres
//! or degrees. Or the loads in the file of a channel are, such as forces in kgf.

use super::channel::Channel;
use super::kind::{EVERY_CHANNEL, Kind, Parameter, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] = &[Parameter::number("factor", 1e-7, 1e7, 25.4, Scale::Log)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "wrong_unit",
    summary: "a channel is written in another unit than its column says",
    scope: Scope::Test,
    places: EVERY_CHANNEL,
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { is_sought: false, ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(reading) = subject.channel_mut(at) {
        reading.factor *= numbers[0];
    }
}

/// The column of a channel's file that is written in another unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitColumn {
    /// The column of the readings.
    Reading,
    /// The columns of forces or torques. The actual load then differs from the stated one by a factor, and so do the
    /// readings from the values that the stated load would cause.
    Force,
    /// The column of payloads.
    Payload,
}

/// A unit that is mistaken for another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitSlip {
    /// Factor by which the readings differ from the readings that the model predicts, if the column is in this other
    /// unit.
    pub factor: f64,
    /// The column that is written in another unit.
    pub column: UnitColumn,
    /// The mistake in words, for messages, such as "inches in a column of mm".
    pub cause: &'static str,
    /// The channels whose quantity has these units.
    pub channels: &'static [Channel],
}

impl UnitSlip {
    /// Whether a column of the channel can have these units.
    pub fn is_of(&self, channel: Channel) -> bool {
        self.channels.contains(&channel)
    }
}

/// Standard acceleration of gravity \[m/s²\], which is also one kgf in N.
const KGF_N: f64 = 9.806_65;
/// One pound in kg.
const POUND_KG: f64 = 0.453_592_37;
/// One pound-force in N.
const LBF_N: f64 = POUND_KG * KGF_N;
/// Inches in one foot.
const FOOT_IN: f64 = 12.0;
/// One inch in m.
const INCH_M: f64 = 0.0254;
/// Ounces in one pound.
const POUND_OZ: f64 = 16.0;
/// One radian in arcmin.
const RADIAN_ARCMIN: f64 = 10_800.0 / std::f64::consts::PI;

const LENGTHS: &[Channel] = &[Channel::Static, Channel::Positions];
const FREQUENCIES: &[Channel] = &[Channel::Modal];
const ANGLES: &[Channel] = &[Channel::Windup];
/// The channel whose readings are proportional to forces and payloads at the tip.
const TIP_LOADS: &[Channel] = &[Channel::Static];

const fn slip(factor: f64, cause: &'static str, channels: &'static [Channel]) -> UnitSlip {
    UnitSlip { factor, column: UnitColumn::Reading, cause, channels }
}

const fn force(factor: f64, cause: &'static str) -> UnitSlip {
    UnitSlip { factor, column: UnitColumn::Force, cause, channels: TIP_LOADS }
}

const fn torque(factor: f64, cause: &'static str) -> UnitSlip {
    UnitSlip { factor, column: UnitColumn::Force, cause, channels: ANGLES }
}

const fn payload(factor: f64, cause: &'static str) -> UnitSlip {
    UnitSlip { factor, column: UnitColumn::Payload, cause, channels: TIP_LOADS }
}

/// The units that are mistaken for each other.
pub const SLIPS: &[UnitSlip] = &[
    slip(25.4, "a value in mm stands 25.4 times too large: converted from inches twice", LENGTHS),
    slip(1.0 / 25.4, "inches in a column of mm", LENGTHS),
    slip(1000.0 / 25.4, "thousandths of an inch in a column of mm", LENGTHS),
    slip(1000.0, "thousandths (micrometres in a column of mm), or a conversion done twice", LENGTHS),
    slip(100.0, "hundredths (divisions of 0.01 mm of a dial gauge in a column of mm)", LENGTHS),
    slip(10.0, "tenths (divisions of 0.1 mm in a column of mm)", LENGTHS),
    slip(0.1, "tens (cm in a column of mm)", LENGTHS),
    slip(1e-3, "thousands (metres in a column of mm)", LENGTHS),
    slip(60.0, "revolutions per minute in a column of Hz", FREQUENCIES),
    slip(std::f64::consts::TAU, "rad/s in a column of Hz", FREQUENCIES),
    slip(1.0 / std::f64::consts::TAU, "a frequency divided by 2 pi twice", FREQUENCIES),
    slip(1000.0, "mHz in a column of Hz", FREQUENCIES),
    slip(1e-3, "kHz in a column of Hz", FREQUENCIES),
    slip(60.0, "arcseconds in a column of arcmin", ANGLES),
    slip(1.0 / 60.0, "degrees in a column of arcmin", ANGLES),
    slip(1.0 / RADIAN_ARCMIN, "radians in a column of arcmin", ANGLES),
    slip(1e3 / RADIAN_ARCMIN, "milliradians in a column of arcmin", ANGLES),
    slip(1e6 / RADIAN_ARCMIN, "microradians in a column of arcmin", ANGLES),
    force(KGF_N, "forces in kgf in a column of N"),
    force(1.0 / KGF_N, "forces multiplied by g although they were in N"),
    force(1e-3 * KGF_N, "forces in gf in a column of N"),
    force(LBF_N, "forces in lbf in a column of N"),
    force(1.0 / LBF_N, "forces multiplied by 4.448 although they were in N"),
    force(LBF_N / POUND_OZ, "forces in ozf in a column of N"),
    force(1e3, "forces in kN in a column of N"),
    torque(KGF_N, "torques in kgf m in a column of N m"),
    torque(1.0 / KGF_N, "torques multiplied by g although they were in N m"),
    torque(1e-2 * KGF_N, "torques in kgf cm in a column of N m"),
    torque(LBF_N * FOOT_IN * INCH_M, "torques in ft lbf in a column of N m"),
    torque(1.0 / (LBF_N * FOOT_IN * INCH_M), "torques multiplied by 1.356 although they were in N m"),
    torque(LBF_N * INCH_M, "torques in in lbf in a column of N m"),
    torque(LBF_N / POUND_OZ * INCH_M, "torques in ozf in in a column of N m"),
    torque(10.0, "torques in daN m in a column of N m"),
    torque(0.01, "torques in N cm in a column of N m"),
    torque(1e-3, "torques in N mm in a column of N m"),
    torque(1e3, "torques in kN m in a column of N m"),
    payload(POUND_KG, "payloads in pounds in a column of kg"),
    payload(1.0 / POUND_KG, "payloads multiplied by 0.4536 although they were in kg"),
    payload(POUND_KG / POUND_OZ, "payloads in ounces in a column of kg"),
    payload(1.0 / KGF_N, "payloads as weights in N in a column of kg"),
    payload(1e-3, "payloads in grams in a column of kg"),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn a_length_is_mistaken_for_no_angle() {
        let of_lengths: Vec<f64> =
            SLIPS.iter().filter(|slip| slip.is_of(Channel::Static)).map(|slip| slip.factor).collect();
        assert!(of_lengths.contains(&(1000.0 / 25.4)) && !of_lengths.contains(&60.0), "{of_lengths:?}");
        assert!(SLIPS.iter().any(|slip| slip.is_of(Channel::Modal) && slip.factor == 60.0));
    }

    #[test]
    fn the_units_of_loads_are_among_those_of_the_readings_of_the_tip() {
        let of = |channel: Channel, column: UnitColumn| {
            let own = SLIPS.iter().filter(move |slip| slip.is_of(channel) && slip.column == column);
            own.map(|slip| slip.factor).collect::<Vec<_>>()
        };
        // NIST SP 811: 1 kgf = 9.80665 N, 1 lbf = 4.448 222 N, 1 lb = 0.453 592 37 kg
        for factor in [9.80665, 4.448_222, 1.0 / 9.80665, 1.0 / 4.448_222] {
            let forces = of(Channel::Static, UnitColumn::Force);
            assert!(forces.iter().any(|f| (f / factor - 1.0).abs() < 1e-6), "{factor}");
        }
        for factor in [0.453_592_37, 1.0 / 0.453_592_37, 1e-3] {
            let payloads = of(Channel::Static, UnitColumn::Payload);
            assert!(payloads.iter().any(|f| (f / factor - 1.0).abs() < 1e-9), "{factor}");
        }
        assert!(
            of(Channel::Modal, UnitColumn::Payload).is_empty(),
            "a frequency is not proportional to a payload"
        );
    }

    #[test]
    fn every_unit_of_a_bench_and_of_a_gauge_has_the_factor_of_the_tables() {
        let has = |channel: Channel, cause: &str, factor: f64| {
            let unit = SLIPS.iter().find(|slip| slip.is_of(channel) && slip.cause.contains(cause));
            let found = unit.expect(cause).factor;
            assert!((found / factor - 1.0).abs() < 1e-6, "{cause}: {found}");
        };
        // the radian is 3437.7468 arcmin; the torques are those of NIST SP 811
        for (cause, factor) in [
            ("milliradians", 0.290_888_2),
            ("microradians", 290.888_2),
            ("radians in", 2.908_882e-4),
            ("arcseconds", 60.0),
            ("kgf cm", 9.806_65e-2),
            ("ft lbf", 1.355_818),
            ("in in lbf", 0.112_984_8),
            ("ozf in", 7.061_552e-3),
            ("N cm", 0.01),
        ] {
            has(Channel::Windup, cause, factor);
        }
        has(Channel::Static, "ozf", 0.278_013_9);
        has(Channel::Static, "ounces", 2.834_952e-2);
        has(Channel::Static, "dial gauge", 100.0);
        let of_bench = SLIPS.iter().filter(|slip| slip.is_of(Channel::Windup));
        let in_degrees = |factor: f64| libm::log(factor * std::f64::consts::PI / 180.0).abs() < 0.01;
        assert!(of_bench.clone().all(|slip| !in_degrees(slip.factor)), "no bench has radians or degrees");
    }

    #[test]
    fn metres_in_a_column_of_millimetres() {
        let mut subject = subject();
        apply(&[1e-3], "static", &mut subject);
        assert_eq!(subject.channels[Channel::Static as usize].of(2.0, 0, 0), 2e-3);
    }
}
