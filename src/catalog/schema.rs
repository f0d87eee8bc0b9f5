//! The columns of the catalog files: names with units, allowed content of cells, whether a column is required, and
//! whether it is a property of the part.

use super::Confidence;
use super::efficiency::EfficiencyKind;
use super::gear::GearKind;
use super::material::MaterialClass;
use super::motor::MotorKind;
use super::profile::{Profile, ProfileShape};

/// The files that a catalog folder can contain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum CatalogFile {
    /// `gears.csv`
    Gears,
    /// `gears_efficiency.csv`
    Efficiency,
    /// `actuators.csv`
    Actuators,
    /// `motors.csv`
    Motors,
    /// `motor_curves.csv`
    MotorCurves,
    /// `materials.csv`
    Materials,
    /// `profiles.csv`
    Profiles,
}

/// Allowed content of a cell. A blank cell means unknown, unless the column is required.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// Any text.
    Text,
    /// One of some words, in upper or lower case.
    Word(&'static [&'static str]),
    /// A whole number greater than zero.
    Count,
    /// A finite number.
    Number,
    /// A finite number not less than zero.
    NonNegative,
    /// A finite number greater than zero.
    Positive,
    /// A number greater than zero and at most one.
    Fraction,
}

/// One column of a catalog file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Name in the header line, with the unit.
    pub name: &'static str,
    /// Allowed content of the column's cells.
    pub cell: Cell,
    /// Whether the column must be present and all of its cells filled.
    pub required: bool,
    /// Whether the column is a property of the part, and not its name, its source or a remark.
    pub figure: bool,
}

const fn core(name: &'static str, cell: Cell) -> Column {
    Column { name, cell, required: true, figure: false }
}

const fn core_figure(name: &'static str) -> Column {
    Column { name, cell: Cell::Positive, required: true, figure: true }
}

const fn figure(name: &'static str) -> Column {
    Column { name, cell: Cell::Positive, required: false, figure: true }
}

const fn figure_of(name: &'static str, cell: Cell) -> Column {
    Column { name, cell, required: false, figure: true }
}

const fn remark(name: &'static str) -> Column {
    Column { name, cell: Cell::Text, required: false, figure: false }
}

const SOURCE: Column = core("source", Cell::Text);
const CONFIDENCE: Column = core("confidence", Cell::Word(&Confidence::WORDS));

const GEARS: &[Column] = &[
    Column { name: "kind", cell: Cell::Word(&GearKind::WORDS), required: false, figure: false },
    core("series", Cell::Text),
    remark("alias_series"),
    remark("vendor"),
    remark("housing"),
    core("size", Cell::Count),
    core("ratio", Cell::Positive),
    figure("rated_torque_nm"),
    figure("repeated_peak_torque_nm"),
    figure("average_torque_limit_nm"),
    figure("momentary_peak_torque_nm"),
    figure("max_input_speed_rpm"),
    figure("average_input_speed_limit_rpm"),
    figure("inertia_input_kgm2"),
    figure("mass_component_set_kg"),
    figure("mass_housed_unit_kg"),
    figure("mass_housed_unit_light_kg"),
    figure("t1_nm"),
    figure("t2_nm"),
    figure("k1_nm_per_rad"),
    figure("k2_nm_per_rad"),
    figure("k3_nm_per_rad"),
    figure("rated_life_h"),
    figure("rated_life_speed_rpm"),
    figure("life_exponent"),
    figure_of("backlash_arcmin", Cell::NonNegative),
    figure_of("lost_motion_arcmin", Cell::NonNegative),
    figure_of("hysteresis_loss_arcmin", Cell::NonNegative),
    figure_of("transmission_accuracy_arcmin", Cell::NonNegative),
    figure("tilting_stiffness_nm_per_rad"),
    figure("permissible_tilting_moment_nm"),
    figure("bearing_pitch_diameter_m"),
    figure_of("bearing_offset_m", Cell::NonNegative),
    figure("bearing_static_load_rating_n"),
    figure("bearing_dynamic_load_rating_n"),
    figure("buckling_torque_nm"),
    figure("ratcheting_torque_nm"),
    figure("outer_diameter_mm"),
    figure("length_mm"),
    figure_of("hollow_bore_mm", Cell::NonNegative),
    figure_of("efficiency_rated_2000rpm", Cell::Fraction),
    remark("efficiency_basis"),
    SOURCE,
    CONFIDENCE,
    remark("unverified_fields"),
    remark("notes"),
];

const EFFICIENCY: &[Column] = &[
    core("kind", Cell::Word(&EfficiencyKind::WORDS)),
    core("series", Cell::Text),
    Column { name: "size", cell: Cell::Count, required: false, figure: false },
    Column { name: "ratio", cell: Cell::Positive, required: false, figure: false },
    core_figure("x"),
    remark("x_unit"),
    Column { name: "value", cell: Cell::Fraction, required: true, figure: true },
    SOURCE,
    CONFIDENCE,
    remark("unverified_fields"),
    remark("notes"),
];

const MOTORS: &[Column] = &[
    core("type", Cell::Word(&MotorKind::WORDS)),
    core("model", Cell::Text),
    remark("vendor"),
    figure("rated_torque_nm"),
    figure("peak_torque_nm"),
    remark("peak_torque_basis"),
    figure("rated_speed_rpm"),
    figure("max_speed_rpm"),
    figure("rotor_inertia_kgm2"),
    figure("mass_kg"),
    figure("outer_diameter_mm"),
    figure("length_mm"),
    figure_of("hollow_bore_mm", Cell::NonNegative),
    figure("rated_power_w"),
    figure("bus_voltage_v"),
    figure("torque_constant_nm_per_a"),
    figure("displacement_cm3_per_rev"),
    figure("pressure_continuous_bar"),
    figure("pressure_intermittent_bar"),
    SOURCE,
    CONFIDENCE,
    remark("unverified_fields"),
    remark("derived_fields"),
    remark("notes"),
];

const ACTUATORS: &[Column] = &[
    core("model", Cell::Text),
    remark("vendor"),
    figure("ratio"),
    figure("rated_torque_nm"),
    figure("peak_torque_nm"),
    figure("rated_speed_rpm"),
    figure("max_speed_rpm"),
    figure("inertia_output_kgm2"),
    figure("k1_nm_per_rad"),
    figure("k2_nm_per_rad"),
    figure("k3_nm_per_rad"),
    figure("t1_nm"),
    figure("t2_nm"),
    figure_of("backlash_arcmin", Cell::NonNegative),
    figure("mass_kg"),
    figure("tilting_stiffness_nm_per_rad"),
    figure("permissible_tilting_moment_nm"),
    figure("bearing_pitch_diameter_m"),
    figure_of("bearing_offset_m", Cell::NonNegative),
    figure("bearing_static_load_rating_n"),
    figure("bearing_dynamic_load_rating_n"),
    figure_of("efficiency", Cell::Fraction),
    figure("outer_diameter_mm"),
    figure("length_mm"),
    figure_of("hollow_bore_mm", Cell::NonNegative),
    SOURCE,
    CONFIDENCE,
    remark("unverified_fields"),
    remark("notes"),
];

const MOTOR_CURVES: &[Column] = &[
    core("model", Cell::Text),
    Column { name: "speed_rpm", cell: Cell::NonNegative, required: true, figure: true },
    figure_of("continuous_torque_nm", Cell::NonNegative),
    figure_of("peak_torque_nm", Cell::NonNegative),
    remark("source"),
    Column { name: "confidence", cell: Cell::Word(&Confidence::WORDS), required: false, figure: false },
    remark("notes"),
];

const MATERIALS: &[Column] = &[
    core("name", Cell::Text),
    core("class", Cell::Word(&MaterialClass::WORDS)),
    Column { name: "unidirectional", cell: Cell::Word(&["yes", "no"]), required: false, figure: false },
    core_figure("e_pa"),
    figure("g_pa"),
    core_figure("density_kg_m3"),
    figure_of("poisson", Cell::Number),
    figure("yield_or_strength_pa"),
    figure("compressive_strength_pa"),
    figure("shear_strength_pa"),
    remark("strength_kind"),
    figure_of("cte_1_per_k", Cell::Number),
    figure_of("cost_eur_per_kg", Cell::NonNegative),
    figure_of("loss_factor", Cell::NonNegative),
    figure_of("corrosion_note", Cell::Text),
    SOURCE,
    CONFIDENCE,
    remark("unverified_fields"),
    remark("notes"),
];

const PROFILES: &[Column] = &[
    core("designation", Cell::Text),
    core("shape", Cell::Word(&ProfileShape::WORDS)),
    core("material_family", Cell::Word(&Profile::MATERIAL_FAMILIES)),
    core_figure("outer_b_m"),
    core_figure("outer_h_m"),
    core_figure("wall_t_m"),
    figure_of("corner_radius_outer_m", Cell::NonNegative),
    figure("area_m2"),
    figure("second_moment_iy_m4"),
    figure("mass_per_m_kg"),
    remark("standard"),
    SOURCE,
    CONFIDENCE,
    remark("unverified_fields"),
    remark("notes"),
];

impl CatalogFile {
    /// All files, in the order in which they are read.
    pub const ALL: [CatalogFile; 7] = [
        CatalogFile::Gears,
        CatalogFile::Efficiency,
        CatalogFile::Actuators,
        CatalogFile::Motors,
        CatalogFile::MotorCurves,
        CatalogFile::Materials,
        CatalogFile::Profiles,
    ];

    /// Name of the file in a catalog folder.
    pub fn file_name(self) -> &'static str {
        match self {
            CatalogFile::Gears => "gears.csv",
            CatalogFile::Efficiency => "gears_efficiency.csv",
            CatalogFile::Actuators => "actuators.csv",
            CatalogFile::Motors => "motors.csv",
            CatalogFile::MotorCurves => "motor_curves.csv",
            CatalogFile::Materials => "materials.csv",
            CatalogFile::Profiles => "profiles.csv",
        }
    }

    /// The columns of the file, in the order of the built-in file.
    pub fn columns(self) -> &'static [Column] {
        match self {
            CatalogFile::Gears => GEARS,
            CatalogFile::Efficiency => EFFICIENCY,
            CatalogFile::Actuators => ACTUATORS,
            CatalogFile::Motors => MOTORS,
            CatalogFile::MotorCurves => MOTOR_CURVES,
            CatalogFile::Materials => MATERIALS,
            CatalogFile::Profiles => PROFILES,
        }
    }

    /// The columns that together identify a row. No two rows of a file are equal in all of them.
    pub fn key(self) -> &'static [&'static str] {
        match self {
            CatalogFile::Gears => &["series", "size", "ratio"],
            CatalogFile::Efficiency => &["kind", "series", "size", "ratio", "x"],
            CatalogFile::Actuators | CatalogFile::Motors => &["model"],
            CatalogFile::MotorCurves => &["model", "speed_rpm"],
            CatalogFile::Materials => &["name"],
            CatalogFile::Profiles => &["material_family", "designation"],
        }
    }

    /// The content of the built-in file.
    pub(super) fn builtin_text(self) -> &'static str {
        match self {
            CatalogFile::Gears => include_str!("../../catalogs/gears.csv"),
            CatalogFile::Efficiency => include_str!("../../catalogs/gears_efficiency.csv"),
            CatalogFile::Actuators => include_str!("../../catalogs/actuators.csv"),
            CatalogFile::Motors => include_str!("../../catalogs/motors.csv"),
            CatalogFile::MotorCurves => include_str!("../../catalogs/motor_curves.csv"),
            CatalogFile::Materials => include_str!("../../catalogs/materials.csv"),
            CatalogFile::Profiles => include_str!("../../catalogs/profiles.csv"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_of_the_built_in_files_is_known() {
        for file in CatalogFile::ALL {
            let header = file.builtin_text().lines().next().expect("a header");
            for name in header.split(',') {
                assert!(file.columns().iter().any(|c| c.name == name), "{}: {name}", file.file_name());
            }
        }
    }

    #[test]
    fn key_columns_are_columns() {
        for file in CatalogFile::ALL {
            assert!(file.key().iter().all(|key| file.columns().iter().any(|c| c.name == *key)));
        }
    }
}
