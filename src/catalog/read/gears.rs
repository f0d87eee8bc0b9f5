//! Rows of `gears.csv`, and the checks within one row.

use super::envelope::envelope;
use super::row::{Order, Row};
use super::usual;
use crate::catalog::gear::{BearingRatings, Gear, GearKind, LifeLaw};

/// The gear that a row describes; `None` if its name or source is blank or not valid.
pub(crate) fn gear(row: &Row) -> Option<Gear> {
    check(row);
    let (series, size, ratio) = (row.filled("series")?.to_string(), row.count("size")?, row.number("ratio")?);
    let kind = kind(row);
    let ratings = if kind == GearKind::Belt { Ratings::of_belt(row) } else { Ratings::of_gear(row) };
    Some(Gear {
        id: format!("{series}-{size}-{ratio}"),
        series,
        kind,
        size,
        ratio,
        life: life(row, kind),
        rated_torque_nm: row.number("rated_torque_nm"),
        repeated_peak_torque_nm: ratings.repeated_peak_nm,
        average_torque_limit_nm: ratings.average_nm,
        momentary_peak_torque_nm: ratings.momentary_peak_nm,
        max_input_speed_rpm: row.number("max_input_speed_rpm"),
        average_input_speed_limit_rpm: ratings.average_speed_rpm,
        inertia_input_kgm2: row.number("inertia_input_kgm2"),
        mass_component_set_kg: row.number("mass_component_set_kg"),
        mass_housed_unit_kg: row.number("mass_housed_unit_kg"),
        t1_nm: row.number("t1_nm"),
        t2_nm: row.number("t2_nm"),
        k1_nm_per_rad: row.number("k1_nm_per_rad"),
        k2_nm_per_rad: row.number("k2_nm_per_rad"),
        k3_nm_per_rad: row.number("k3_nm_per_rad"),
        hysteresis_loss_arcmin: row.number("hysteresis_loss_arcmin"),
        backlash_arcmin: row.number("backlash_arcmin"),
        lost_motion_arcmin: row.number("lost_motion_arcmin"),
        transmission_accuracy_arcmin: row.number("transmission_accuracy_arcmin"),
        tilting_stiffness_nm_per_rad: row.number("tilting_stiffness_nm_per_rad"),
        permissible_tilting_moment_nm: row.number("permissible_tilting_moment_nm"),
        bearing: bearing(row),
        buckling_torque_nm: row.number("buckling_torque_nm"),
        ratcheting_torque_nm: row.number("ratcheting_torque_nm"),
        envelope: envelope(row),
        efficiency: row.number("efficiency_rated_2000rpm"),
        provenance: row.provenance()?,
    })
}

/// Those ratings of a gear that, for a belt, are filled in from another rating of the row if they are blank.
struct Ratings {
    average_nm: Option<f64>,
    repeated_peak_nm: Option<f64>,
    momentary_peak_nm: Option<f64>,
    average_speed_rpm: Option<f64>,
}

impl Ratings {
    /// The ratings as the row states them.
    fn of_gear(row: &Row) -> Self {
        Self {
            average_nm: row.number("average_torque_limit_nm"),
            repeated_peak_nm: row.number("repeated_peak_torque_nm"),
            momentary_peak_nm: row.number("momentary_peak_torque_nm"),
            average_speed_rpm: row.number("average_input_speed_limit_rpm"),
        }
    }

    /// The ratings of a toothed belt. Makers of belts rate one torque, which holds at a speed and for any duration, and
    /// a largest speed. They do not rate peaks, but divide them by a service factor. A blank rating therefore gets the
    /// value of the next lower rating in the row, so that every check can be made and none is too mild.
    fn of_belt(row: &Row) -> Self {
        let stated = Self::of_gear(row);
        let average_nm = stated.average_nm.or(row.number("rated_torque_nm"));
        let repeated_peak_nm = stated.repeated_peak_nm.or(average_nm);
        Self {
            average_nm,
            repeated_peak_nm,
            momentary_peak_nm: stated.momentary_peak_nm.or(repeated_peak_nm),
            average_speed_rpm: stated.average_speed_rpm.or(row.number("max_input_speed_rpm")),
        }
    }
}

/// The kind of gear that a row describes. A blank cell means a strain-wave gear.
fn kind(row: &Row) -> GearKind {
    GearKind::from_word(row.text("kind")).unwrap_or(GearKind::StrainWave)
}

/// The life equation of the gear that a row describes. Blank cells are filled with the values of its kind.
fn life(row: &Row, kind: GearKind) -> LifeLaw {
    let usual = LifeLaw::usual(kind);
    LifeLaw {
        rated_h: row.number("rated_life_h").or(usual.rated_h),
        rated_speed_rpm: row.number("rated_life_speed_rpm").or(usual.rated_speed_rpm),
        exponent: row.number("life_exponent").unwrap_or(usual.exponent),
    }
}

pub(super) fn bearing(row: &Row) -> BearingRatings {
    BearingRatings {
        pitch_diameter_m: row.number("bearing_pitch_diameter_m"),
        offset_m: row.number("bearing_offset_m"),
        static_load_rating_n: row.number("bearing_static_load_rating_n"),
        dynamic_load_rating_n: row.number("bearing_dynamic_load_rating_n"),
    }
}

/// Another name of the row's series; `None` if it has none. A cell of several words, such as `HFUS outline`,
/// describes the series and is no name. A remark in brackets is ignored.
pub(crate) fn alias<'r>(row: &'r Row) -> Option<&'r str> {
    let word = row.filled("alias_series")?.split('(').next()?.trim();
    (!word.is_empty() && !word.contains(' ')).then_some(word)
}

fn check(row: &Row) {
    ratings_in_order(row);
    pitch_circle_within(row);
    if let Some(exponent) = row.number("life_exponent") {
        row.within(
            "life_exponent",
            exponent,
            [1.0, 10.0],
            [3.0, 10.0 / 3.0],
            "3 for balls, 3.333 for rollers",
        );
    }
    if kind(row) == GearKind::StrainWave {
        usual_figures(row);
    }
    usual::of_gear(row, kind(row));
}

fn ratings_in_order(row: &Row) {
    let torques = "rated <= average limit <= repeated peak < momentary peak";
    // Makers of other kinds may rate one torque as both peaks, or leave the ratings in between blank.
    let below_momentary = usual::TORQUES[..3].iter().rfind(|column| row.number(column).is_some());
    let last_two = [below_momentary.copied().unwrap_or(usual::TORQUES[0]), usual::TORQUES[3]];
    let (not_falling, rising): (&[&str], &[&str]) = match kind(row) {
        GearKind::StrainWave => (&usual::TORQUES[..3], &last_two),
        _ => (&usual::TORQUES, &[]),
    };
    let survives = "a gear survives its momentary peak torque";
    let rules: [(&[&str], Order, &str); 8] = [
        (not_falling, Order::NotFalling, torques),
        (rising, Order::Rising, torques),
        (
            &["k1_nm_per_rad", "k2_nm_per_rad", "k3_nm_per_rad"],
            Order::NotFalling,
            "a gear stiffens: K1 <= K2 <= K3",
        ),
        (&["t1_nm", "t2_nm"], Order::Rising, "the first segment of the torsion curve ends before the second"),
        (
            &["average_input_speed_limit_rpm", "max_input_speed_rpm"],
            Order::NotFalling,
            "the limit for the average speed is not above that for the peak",
        ),
        (
            &["mass_component_set_kg", "mass_housed_unit_kg"],
            Order::Rising,
            "the housed unit contains the component set",
        ),
        (&["momentary_peak_torque_nm", "buckling_torque_nm"], Order::NotFalling, survives),
        (&["momentary_peak_torque_nm", "ratcheting_torque_nm"], Order::NotFalling, survives),
    ];
    for (columns, order, hint) in rules {
        let figures: Vec<_> = columns.iter().map(|column| (*column, row.number(column))).collect();
        row.ascending(&figures, order, hint);
    }
}

fn pitch_circle_within(row: &Row) {
    if let (Some(pitch_m), Some(outer_mm)) =
        (row.number("bearing_pitch_diameter_m"), row.number("outer_diameter_mm"))
        && pitch_m * 1e3 >= outer_mm
    {
        let problem = format!("= {pitch_m} is not within outer_diameter_mm = {outer_mm}");
        row.fault("bearing_pitch_diameter_m", problem, "write the pitch diameter in m, the outer one in mm");
    }
}

/// Warns of numbers of a row that are far from the numbers of all known harmonic drives of the same size. Such a number
/// is often in the wrong unit.
fn usual_figures(row: &Row) {
    let Some(size) = row.count("size").map(f64::from) else { return };
    let scaled = |column: &str, scale: f64, [low, high]: [f64; 2], unit: &str| {
        if let Some(x) = row.number(column).filter(|x| !(low..=high).contains(&(x / scale))) {
            row.warn(
                column,
                format!("= {x} is unusual for size {size}"),
                &format!("usual of strain-wave gears: {:.3e} to {:.3e} {unit}; a slip of unit, or another kind (column kind)?", low * scale, high * scale),
            );
        }
    };
    scaled("k3_nm_per_rad", size.powi(3), [0.9, 4.2], "N m/rad");
    scaled("inertia_input_kgm2", size.powi(5), [2e-12, 3e-11], "kg m2");
    if let Some(t2) = row.number("t2_nm") {
        scaled("t1_nm", t2, [1.5e-3, 0.5], "N m");
    }
    scaled("bearing_pitch_diameter_m", size, [1e-3, 6e-3], "m");
    scaled("bearing_offset_m", size, [2e-4, 3e-3], "m");
    scaled("bearing_static_load_rating_n", size.powi(2), [5.0, 200.0], "N");
    scaled("bearing_dynamic_load_rating_n", size.powi(2), [5.0, 200.0], "N");
    scaled("efficiency_rated_2000rpm", 1.0, [0.5, 0.9], "");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::CatalogFile;
    use crate::catalog::read::log::Log;
    use crate::catalog::read::table::rows;

    const HEADER: &str = "series,size,ratio,source,confidence,momentary_peak_torque_nm,bearing_pitch_diameter_m,\
        bearing_offset_m,bearing_static_load_rating_n,bearing_dynamic_load_rating_n,buckling_torque_nm,\
        ratcheting_torque_nm,outer_diameter_mm,length_mm,hollow_bore_mm";

    /// The gear of a row whose cells after the confidence are `figures`, and the columns that have faults.
    fn read(figures: &str) -> (Option<Gear>, Vec<String>) {
        let log = Log::default();
        let text = format!("{HEADER}\nA,25,100,a test,verified,{figures}\n");
        let read = rows(CatalogFile::Gears, "gears.csv", text.as_bytes(), &log);
        let gear = read.first().and_then(gear);
        let faults = log.faults.borrow().iter().map(|fault| fault.field.clone()).collect();
        (gear, faults)
    }

    #[test]
    fn a_bearing_keeps_its_units_and_outer_sizes_become_metres() {
        let (gear, faults) = read("369,0.062,0.0115,15100,9600,1700,650,107,52,0");
        let gear = gear.expect("sound");
        assert!(faults.is_empty(), "{faults:?}");
        let bearing = gear.bearing;
        assert_eq!([bearing.pitch_diameter_m, bearing.offset_m], [Some(0.062), Some(0.0115)]);
        assert_eq!(
            [bearing.static_load_rating_n, bearing.dynamic_load_rating_n],
            [Some(15_100.0), Some(9_600.0)]
        );
        assert_eq!([gear.buckling_torque_nm, gear.ratcheting_torque_nm], [Some(1700.0), Some(650.0)]);
        let size = gear.envelope;
        assert_eq!([size.outer_diameter_m, size.length_m], [Some(0.107), Some(0.052)]);
        assert_eq!(size.hollow_bore_m, Some(0.0), "a gear without a passage");
    }

    #[test]
    fn blank_figures_of_bearing_and_size_are_unknown() {
        let (gear, faults) = read("369,,,,,,,,,");
        let gear = gear.expect("sound");
        assert!(faults.is_empty(), "{faults:?}");
        assert_eq!((gear.bearing, gear.envelope), Default::default());
        assert_eq!((gear.buckling_torque_nm, gear.ratcheting_torque_nm), (None, None));
    }

    #[test]
    fn impossible_figures_of_bearing_and_size_are_refused() {
        assert_eq!(read("369,0.120,,,,,,107,52,").1, ["bearing_pitch_diameter_m"], "wider than the gear");
        assert_eq!(read("369,,,,,,,107,52,110").1, ["outer_diameter_mm"], "narrower than its bore");
        assert_eq!(read("369,,,,,,,0.107,52,").1, ["outer_diameter_mm"], "metres");
        assert_eq!(read("369,,,-1,,,,,,").1, ["bearing_static_load_rating_n"]);
        assert_eq!(read("369,,,,,300,,,,").1, ["buckling_torque_nm"], "below the momentary peak");
        assert_eq!(read("369,,,,,,300,,,").1, ["ratcheting_torque_nm"], "below the momentary peak");
    }

    #[test]
    fn a_belt_whose_peak_is_below_its_rating_is_refused() {
        let faults = |momentary_nm: f64| {
            let log = Log::default();
            let text = format!(
                "series,size,ratio,source,confidence,kind,rated_torque_nm,max_input_speed_rpm,momentary_peak_torque_nm\n\
                 HTD,25,2,a test,verified,belt,20,3000,{momentary_nm}\n"
            );
            rows(CatalogFile::Gears, "gears.csv", text.as_bytes(), &log).first().and_then(gear);
            log.faults.borrow().iter().map(|fault| fault.field.clone()).collect::<Vec<_>>()
        };
        assert_eq!(faults(10.0), ["momentary_peak_torque_nm"]);
        assert!(faults(20.0).is_empty());
    }

    #[test]
    fn a_gear_whose_peak_is_not_above_its_rating_is_refused_where_the_ratings_between_are_blank() {
        let faults = |momentary_nm: f64| {
            let log = Log::default();
            let text = format!(
                "series,size,ratio,source,confidence,rated_torque_nm,momentary_peak_torque_nm\nA,25,100,a test,verified,369,{momentary_nm}\n"
            );
            rows(CatalogFile::Gears, "gears.csv", text.as_bytes(), &log).first().and_then(gear);
            log.faults.borrow().iter().map(|fault| fault.field.clone()).collect::<Vec<_>>()
        };
        assert_eq!(
            [faults(100.0), faults(369.0)],
            [["momentary_peak_torque_nm"], ["momentary_peak_torque_nm"]]
        );
        assert!(faults(370.0).is_empty());
    }

    #[test]
    fn a_bearing_in_millimetres_is_a_warning() {
        let log = Log::default();
        let text = format!("{HEADER}\nA,25,100,a test,verified,369,62,11.5,15100,9600,,,,,\n");
        let read = rows(CatalogFile::Gears, "gears.csv", text.as_bytes(), &log);
        assert!(read.first().and_then(gear).is_some());
        let warned: Vec<_> = log.warnings.borrow().iter().map(|w| w.field.clone()).collect();
        assert_eq!(warned, ["bearing_pitch_diameter_m", "bearing_offset_m"]);
    }
}
