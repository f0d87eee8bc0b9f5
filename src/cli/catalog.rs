//! `armwright catalog check` and `armwright catalog show`: the catalog parts, and how reliable their ratings
//! are.
//!
//! The functions return the text; nothing is printed here.

use super::catalog_check::check;
use super::catalog_table::{TextTable, actuators_of, cell, gears_of, motors_of, provenances};
use super::failure::Failure;
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::lookup::PartError;
use crate::catalog::material::{Material, MaterialClass};
use crate::catalog::motor::{Motor, MotorKind};
use crate::catalog::profile::{Profile, ProfileShape};
use crate::catalog::schema::{CatalogFile, Column};
use crate::catalog::{Catalogs, Confidence, Provenance};
use std::path::Path;

/// Catalogs: check them, or show parts.
#[derive(Debug, Clone, clap::Args)]
#[command(
    about = "Check the catalogs, or show parts of them",
    after_help = "Example: armwright catalog show gears --series CSG --size 32"
)]
pub(crate) struct CatalogArgs {
    /// What to do with the catalogs.
    #[command(subcommand)]
    pub verb: CatalogVerb,
}

/// What to do with the catalogs.
#[derive(Debug, Clone, clap::Subcommand)]
pub(crate) enum CatalogVerb {
    /// Validate every row; count rows, confidence and blank ratings; list what is odd.
    ///
    /// Reports every fault of every file at once, with file, line, column, value and what is allowed.
    #[command(after_help = "Example: armwright catalog check --catalogs my-parts")]
    Check,
    /// List parts as a table, or one part with every rating and its source.
    #[command(after_help = "Examples:\n  armwright catalog show gears --series CSG --size 32\n  \
        armwright catalog show motors --kind electric\n  \
        armwright catalog show gears --kind cycloidal\n  \
        armwright catalog show materials --class composite\n  \
        armwright catalog show profiles --family steel --shape square --csv\n  \
        armwright catalog show --part HFUC-58-100")]
    Show(ShowArgs),
}

/// Parts one can list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Parts {
    /// Gears: strain-wave, planetary, cycloidal, belts.
    Gears,
    /// Actuators: motor, gear and bearing in one part.
    Actuators,
    /// Electric and hydraulic motors.
    Motors,
    /// Link materials.
    Materials,
    /// Hollow profiles.
    Profiles,
}

/// Which parts to show, and how.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct ShowArgs {
    /// What to list; may be left out with --part, e.g. `gears`.
    #[arg(value_enum, required_unless_present = "part")]
    pub parts: Option<Parts>,
    /// Show every field of one part, with source and trust, e.g. `--part HFUC-58-100`.
    #[arg(long, value_name = "NAME")]
    pub part: Option<String>,
    /// Only gears of this series or its other name, e.g. `--series CSG` [default: all].
    #[arg(long)]
    pub series: Option<String>,
    /// Only gears of this size, e.g. `--size 32` [default: all].
    #[arg(long)]
    pub size: Option<u32>,
    /// Only gears of this ratio, e.g. `--ratio 100` [default: all].
    #[arg(long)]
    pub ratio: Option<f64>,
    /// Only gears or motors of this kind: `gears --kind planetary`, `motors --kind electric` [default: all].
    #[arg(long)]
    pub kind: Option<String>,
    /// Only materials of this class: metal, composite or `--class metal-matrix` [default: all].
    #[arg(long)]
    pub class: Option<String>,
    /// Only profiles of this family of materials, e.g. `--family steel` [default: all].
    #[arg(long)]
    pub family: Option<String>,
    /// Only profiles of this shape: square, rectangular or `--shape round` [default: all].
    #[arg(long)]
    pub shape: Option<String>,
    /// Print the rows as they stand in their files, as CSV for your own catalog folder [default: a table].
    #[arg(long)]
    pub csv: bool,
}

/// Runs `armwright catalog` and returns the text to print.
///
/// # Errors
/// The catalogs are faulty, a filter is unknown or does not belong to the parts that are listed, or there is no such
/// part.
pub(crate) fn run(args: &CatalogArgs, overlay: Option<&Path>) -> Result<String, Failure> {
    match &args.verb {
        CatalogVerb::Check => check(overlay).map_err(Failure::catalog),
        CatalogVerb::Show(args) => show(&Catalogs::load(overlay).map_err(Failure::catalog)?, args),
    }
}

/// The parts that the user asks for as a table or as CSV, or one part with all its columns.
///
/// # Errors
/// A filter is unknown or does not belong to the parts that are listed, or there is no such part.
pub(crate) fn show(catalogs: &Catalogs, args: &ShowArgs) -> Result<String, Failure> {
    if let Some(name) = &args.part {
        return show_part(catalogs, args.parts, name);
    }
    let Some(parts) = args.parts else {
        return Err(Failure::Usage(
            "say what to list: gears, actuators, motors, materials or profiles".into(),
        ));
    };
    refuse_stray_filters(parts, args)?;
    match parts {
        Parts::Gears => {
            list(catalogs, CatalogFile::Gears, &gears(catalogs, args)?, GEAR_FIELDS, |g| &g.provenance, args)
        }
        Parts::Actuators => list(
            catalogs,
            CatalogFile::Actuators,
            &actuators_of(catalogs).collect::<Vec<_>>(),
            ACTUATOR_FIELDS,
            |g| &g.provenance,
            args,
        ),
        Parts::Motors => list(
            catalogs,
            CatalogFile::Motors,
            &motors(catalogs, args)?,
            MOTOR_FIELDS,
            |m| &m.provenance,
            args,
        ),
        Parts::Materials => list(
            catalogs,
            CatalogFile::Materials,
            &materials(catalogs, args)?,
            MATERIAL_FIELDS,
            |m| &m.provenance,
            args,
        ),
        Parts::Profiles => list(
            catalogs,
            CatalogFile::Profiles,
            &profiles(catalogs, args)?,
            PROFILE_FIELDS,
            |p| &p.provenance,
            args,
        ),
    }
}

/// Refuses a filter that belongs to another kind of part. Such a filter is a mistake, and ignoring it would mislead.
fn refuse_stray_filters(parts: Parts, args: &ShowArgs) -> Result<(), Failure> {
    let given = [
        ("--series", args.series.is_some(), &[Parts::Gears][..]),
        ("--size", args.size.is_some(), &[Parts::Gears]),
        ("--ratio", args.ratio.is_some(), &[Parts::Gears]),
        ("--kind", args.kind.is_some(), &[Parts::Motors, Parts::Gears]),
        ("--class", args.class.is_some(), &[Parts::Materials]),
        ("--family", args.family.is_some(), &[Parts::Profiles]),
        ("--shape", args.shape.is_some(), &[Parts::Profiles]),
    ];
    for (flag, is_given, belongs_to) in given {
        if is_given && !belongs_to.contains(&parts) {
            let belongs_to: Vec<String> = belongs_to.iter().map(|parts| format!("{parts:?}")).collect();
            return Err(Failure::Usage(format!(
                "{flag} filters {}, not {parts:?}; leave it away",
                belongs_to.join(" and ")
            )));
        }
    }
    Ok(())
}

fn gears<'c>(catalogs: &'c Catalogs, args: &ShowArgs) -> Result<Vec<&'c Gear>, Failure> {
    let series = args.series.as_ref().map(|name| series(catalogs, name)).transpose()?;
    let kind = word("--kind", &args.kind, GearKind::from_word, &GearKind::WORDS)?;
    let wanted = |g: &&Gear| {
        series.as_ref().is_none_or(|s| g.series.eq_ignore_ascii_case(s))
            && args.size.is_none_or(|size| g.size == size)
            && args.ratio.is_none_or(|ratio| g.ratio == ratio)
            && kind.is_none_or(|kind| g.kind == kind)
    };
    Ok(gears_of(catalogs).filter(wanted).collect())
}

fn series(catalogs: &Catalogs, name: &str) -> Result<String, Failure> {
    if let Some(gear) = gears_of(catalogs).find(|g| g.series.eq_ignore_ascii_case(name)) {
        return Ok(gear.series.clone());
    }
    if let Some((_, series)) =
        catalogs.series_aliases.iter().find(|(alias, _)| alias.eq_ignore_ascii_case(name))
    {
        return Ok(series.clone());
    }
    let mut known: Vec<_> = gears_of(catalogs).map(|g| g.series.as_str()).collect();
    known.sort_unstable();
    known.dedup();
    Err(Failure::Usage(format!("--series {name} is not known; choose one of: {}", known.join(", "))))
}

fn motors<'c>(catalogs: &'c Catalogs, args: &ShowArgs) -> Result<Vec<&'c Motor>, Failure> {
    let kinds = word("--kind", &args.kind, MotorKind::of_class, &MotorKind::CLASS_WORDS)?;
    Ok(motors_of(catalogs).filter(|m| kinds.as_ref().is_none_or(|k| k.contains(&m.kind))).collect())
}

fn materials<'c>(catalogs: &'c Catalogs, args: &ShowArgs) -> Result<Vec<&'c Material>, Failure> {
    let class = word("--class", &args.class, MaterialClass::from_word, &MaterialClass::WORDS)?;
    Ok(catalogs.materials.iter().filter(|m| class.is_none_or(|class| m.class == class)).collect())
}

fn profiles<'c>(catalogs: &'c Catalogs, args: &ShowArgs) -> Result<Vec<&'c Profile>, Failure> {
    let families = Profile::MATERIAL_FAMILIES;
    let read =
        |word: &str| families.iter().position(|f| f.eq_ignore_ascii_case(word)).map(|place| families[place]);
    let family = word("--family", &args.family, read, &families)?;
    let shape = word("--shape", &args.shape, ProfileShape::from_word, &ProfileShape::WORDS)?;
    let wanted = |p: &&Profile| {
        family.is_none_or(|family| p.material_family == family) && shape.is_none_or(|shape| p.shape == shape)
    };
    Ok(catalogs.profiles.iter().filter(wanted).collect())
}

fn word<T>(
    flag: &str,
    given: &Option<String>,
    read: impl Fn(&str) -> Option<T>,
    words: &[&str],
) -> Result<Option<T>, Failure> {
    let Some(text) = given else { return Ok(None) };
    let known = || Failure::Usage(format!("{flag} {text} is not known; choose one of: {}", words.join(", ")));
    read(text).map(Some).ok_or_else(known)
}

/// How far a row of a catalog can be trusted, as one letter of [`LEGEND`], which is printed below the table.
fn trust(provenance: &Provenance) -> String {
    let letter = match provenance.confidence {
        Confidence::Verified => "V",
        Confidence::ThirdParty => "T",
        Confidence::FromMemory => "M",
        Confidence::Representative => "R",
    };
    letter.into()
}

/// Explanation that is printed below a table of parts.
const LEGEND: &str =
    "a blank cell is unknown; trust: V verified, T third party, M from memory, R representative";

/// A column of a table of parts: its head (name and unit), and a function that gives the text for a part.
type Field<T> = (&'static str, fn(&T) -> String);

const GEAR_FIELDS: &[Field<Gear>] = &[
    ("gear|", |g| g.id.clone()),
    ("rated|Nm", |g| rating(g.rated_torque_nm, 1.0)),
    ("mean|Nm", |g| rating(g.average_torque_limit_nm, 1.0)),
    ("peak|Nm", |g| rating(g.repeated_peak_torque_nm, 1.0)),
    ("moment.|Nm", |g| rating(g.momentary_peak_torque_nm, 1.0)),
    ("speed|rpm", |g| rating(g.max_input_speed_rpm, 1.0)),
    ("inertia|kg cm2", |g| rating(g.inertia_input_kgm2, 1e4)),
    ("K1|kNm/rad", |g| rating(g.k1_nm_per_rad, 1e-3)),
    ("K2|kNm/rad", |g| rating(g.k2_nm_per_rad, 1e-3)),
    ("K3|kNm/rad", |g| rating(g.k3_nm_per_rad, 1e-3)),
    ("set|kg", |g| rating(g.mass_component_set_kg, 1.0)),
    ("unit|kg", |g| rating(g.mass_housed_unit_kg, 1.0)),
    ("eff.|", |g| rating(g.efficiency, 1.0)),
    ("trust|", |g| trust(&g.provenance)),
];

const ACTUATOR_FIELDS: &[Field<Gear>] = &[
    ("actuator|", |g| g.id.clone()),
    ("ratio|", |g| rating(Some(g.ratio), 1.0)),
    ("rated|Nm", |g| rating(g.rated_torque_nm, 1.0)),
    ("peak|Nm", |g| rating(g.momentary_peak_torque_nm, 1.0)),
    ("K1|kNm/rad", |g| rating(g.k1_nm_per_rad, 1e-3)),
    ("play|arcmin", |g| rating(g.backlash_arcmin, 1.0)),
    ("tilt|kNm/rad", |g| rating(g.tilting_stiffness_nm_per_rad, 1e-3)),
    ("moment|Nm", |g| rating(g.permissible_tilting_moment_nm, 1.0)),
    ("mass|kg", |g| rating(g.mass_housed_unit_kg, 1.0)),
    ("outer|mm", |g| rating(g.envelope.outer_diameter_m, 1e3)),
    ("bore|mm", |g| rating(g.envelope.hollow_bore_m, 1e3)),
    ("trust|", |g| trust(&g.provenance)),
];

const MOTOR_FIELDS: &[Field<Motor>] = &[
    ("motor|", |m| m.id.clone()),
    ("kind|", |m| m.kind.to_string()),
    ("rated|Nm", |m| rating(m.rated_torque_nm, 1.0)),
    ("peak|Nm", |m| rating(m.peak_torque_nm, 1.0)),
    ("rated|rpm", |m| rating(m.rated_speed_rpm, 1.0)),
    ("max|rpm", |m| rating(m.max_speed_rpm, 1.0)),
    ("inertia|kg cm2", |m| rating(m.rotor_inertia_kgm2, 1e4)),
    ("mass|kg", |m| rating(m.mass_kg, 1.0)),
    ("trust|", |m| trust(&m.provenance)),
];

const MATERIAL_FIELDS: &[Field<Material>] = &[
    ("material|", |m| m.name.clone()),
    ("E|GPa", |m| rating(Some(m.youngs_modulus_pa), 1e-9)),
    ("G|GPa", |m| rating(m.shear_modulus_pa, 1e-9)),
    ("density|kg/m3", |m| rating(Some(m.density_kg_m3), 1.0)),
    ("strength|MPa", |m| rating(m.strength_pa, 1e-6)),
    ("cost|EUR/kg", |m| rating(m.cost_eur_per_kg, 1.0)),
    ("trust|", |m| trust(&m.provenance)),
];

const PROFILE_FIELDS: &[Field<Profile>] = &[
    ("profile|", |p| p.designation.clone()),
    ("shape|", |p| p.shape.to_string()),
    ("family|", |p| p.material_family.clone()),
    ("width|mm", |p| rating(Some(p.width_m), 1e3)),
    ("height|mm", |p| rating(Some(p.height_m), 1e3)),
    ("wall|mm", |p| rating(Some(p.wall_m), 1e3)),
    ("area|cm2", |p| rating(p.area_m2, 1e4)),
    ("2nd moment|cm4", |p| rating(p.second_moment_m4, 1e8)),
    ("mass|kg/m", |p| rating(p.mass_per_length_kg_m, 1.0)),
    ("trust|", |p| trust(&p.provenance)),
];

fn list<T>(
    catalogs: &Catalogs,
    file: CatalogFile,
    parts: &[&T],
    fields: &[Field<T>],
    provenance: fn(&T) -> &Provenance,
    args: &ShowArgs,
) -> Result<String, Failure> {
    if args.csv {
        return rows_as_csv(file, parts.iter().map(|part| catalogs.printed_row(provenance(part))));
    }
    let mut table = TextTable::new(fields.iter().map(|(head, _)| head.to_string()).collect());
    table.rows = parts.iter().map(|part| fields.iter().map(|(_, show)| show(part)).collect()).collect();
    let (shown, all) = (parts.len(), provenances(catalogs, file).count());
    Ok(format!("{}{shown} of {all}; {LEGEND}\n", table.to_text()))
}

fn rows_as_csv<'r>(
    file: CatalogFile,
    rows: impl Iterator<Item = &'r [(&'static str, String)]>,
) -> Result<String, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer
        .write_record(file.columns().iter().map(|c| c.name))
        .expect("writing to memory does not fail and rows are of one length");
    for row in rows {
        writer
            .write_record(row.iter().map(|(_, text)| text))
            .expect("writing to memory does not fail and rows are of one length");
    }
    let bytes = writer.into_inner().expect("flushing to memory does not fail");
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The text with every column of one part.
fn show_part(catalogs: &Catalogs, parts: Option<Parts>, name: &str) -> Result<String, Failure> {
    let kinds = match parts {
        Some(parts) => vec![parts],
        None => vec![Parts::Gears, Parts::Motors, Parts::Materials, Parts::Profiles],
    };
    let mut errors = Vec::new();
    for parts in kinds {
        match find(catalogs, parts, name) {
            Ok((file, provenance)) => return Ok(all_fields(catalogs, file, provenance)),
            Err(error) => errors.push(error),
        }
    }
    // If several kinds of parts were searched, the most useful error is that the name fits several parts of one kind.
    // Next comes the error of a kind that has similar names.
    let ambiguous = errors.iter().position(|e| matches!(e, PartError::Ambiguous { .. }));
    let near =
        errors.iter().position(|e| matches!(e, PartError::Unknown { nearest, .. } if !nearest.is_empty()));
    match (ambiguous.or(near), parts) {
        (None, None) => Err(Failure::Usage(format!(
            "no gear, motor, material or profile is called \"{name}\"; `armwright catalog show gears` lists the gears, and in the same \
             way for motors, materials, profiles and actuators"
        ))),
        (best, _) => Err(errors.swap_remove(best.unwrap_or(0)).into()),
    }
}

fn find<'c>(
    catalogs: &'c Catalogs,
    parts: Parts,
    name: &str,
) -> Result<(CatalogFile, &'c Provenance), PartError> {
    Ok(match parts {
        Parts::Gears | Parts::Actuators => {
            let gear = catalogs.gear(name)?;
            match gear.kind {
                GearKind::Actuator => (CatalogFile::Actuators, &gear.provenance),
                _ => (CatalogFile::Gears, &gear.provenance),
            }
        }
        Parts::Motors => (CatalogFile::Motors, &catalogs.motor(name)?.provenance),
        Parts::Materials => (CatalogFile::Materials, &catalogs.material(name)?.provenance),
        Parts::Profiles => (CatalogFile::Profiles, &catalogs.profile(name)?.provenance),
    })
}

fn all_fields(catalogs: &Catalogs, file: CatalogFile, provenance: &Provenance) -> String {
    let row = catalogs.printed_row(provenance);
    let mut table = TextTable::new(["column", "value", ""].map(String::from).into());
    for Column { name, figure, .. } in file.columns() {
        let text = cell(row, name);
        let mark = match () {
            () if *figure && text.is_empty() => "unknown",
            () if provenance.unverified_fields.iter().any(|f| f == name) => "unverified",
            () => "",
        };
        let is_long = matches!(*name, "source" | "unverified_fields" | "notes" | "confidence");
        if !is_long && (*figure || !text.is_empty()) {
            table.rows.push([*name, text, mark].map(String::from).into());
        }
    }
    let mut out = table.to_text();
    let unverified = provenance.unverified_fields.join(" ");
    let remarks = [
        ("source", provenance.source.as_str()),
        ("confidence", &provenance.confidence.to_string()),
        ("unverified", if unverified.is_empty() { "none" } else { &unverified }),
        ("notes", cell(row, "notes")),
        ("read from", &format!("{}:{}", provenance.file, provenance.line)),
    ];
    for (name, text) in remarks.iter().filter(|(_, text)| !text.is_empty()) {
        out.push_str(&wrapped(&format!("{name}: {text}")));
    }
    out
}

/// Largest width of paragraphs \[characters\].
const TERMINAL_COLUMNS: usize = 110;

/// A paragraph broken into lines between words. All lines after the first are indented.
fn wrapped(text: &str) -> String {
    let mut out = String::new();
    let mut width = 0;
    for word in text.split_whitespace() {
        let length = word.chars().count();
        if width > 0 && width + 1 + length > TERMINAL_COLUMNS {
            out.push_str("\n  ");
            width = 2;
        } else if width > 0 {
            out.push(' ');
            width += 1;
        }
        out.push_str(word);
        width += length;
    }
    out.push('\n');
    out
}

/// A rating multiplied by `factor` (for example to convert its unit), with four significant digits and without trailing
/// zeros. Empty if the rating is unknown.
fn rating(x: Option<f64>, factor: f64) -> String {
    let Some(x) = x.map(|x| x * factor) else { return String::new() };
    if x == 0.0 {
        return "0".into();
    }
    let magnitude = libm::log10(x.abs()).floor() as i32;
    if !(-4..7).contains(&magnitude) {
        return format!("{x:.3e}");
    }
    // Digits before the decimal point are never rounded away: 10117 stays 10117.
    let decimals = (3 - magnitude).max(0) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratings_have_four_digits_and_no_noise() {
        let texts = [3.3e-6 * 1e4, 0.1 + 0.2, 2100000.0, 12345.678, 0.66, 17.0, 0.0, 2.4e-9]
            .map(|x| rating(Some(x), 1.0));
        assert_eq!(texts, ["0.033", "0.3", "2100000", "12346", "0.66", "17", "0", "2.400e-9"]);
        assert_eq!(rating(None, 1.0), "");
    }
}
