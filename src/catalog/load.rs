//! The built-in catalogs, and a user's folder of rows that replace or extend them.

use super::read::log::Log;
use super::read::row::Row;
use super::read::table::rows;
use super::read::{actuators, efficiency, gears, materials, motor_curves, motors, profiles, trend};
use super::schema::CatalogFile;
use super::{BUILT_IN, Catalogs, Confidence, Provenance};
use crate::input::json::{Fault, Faults, InputError, closest};
use std::path::Path;

/// The result of reading one catalog file.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// Kind of the file.
    pub file: CatalogFile,
    /// Name of the file in messages.
    pub name: String,
    /// Number of rows in the file.
    pub rows: usize,
    /// Number of its rows that replaced a row of an earlier file.
    pub replaced: usize,
    /// Number of its rows of each confidence, in the order of [`Confidence::ALL`].
    pub by_confidence: [usize; 4],
}

/// A catalog file that is to be read: its kind, its name in messages, and its content.
struct Source {
    file: CatalogFile,
    name: String,
    bytes: Vec<u8>,
}

impl Catalogs {
    /// The catalogs that are built into the program.
    ///
    /// ```
    /// use armwright::catalog::Catalogs;
    ///
    /// let catalogs = Catalogs::builtin();
    /// let gear = catalogs.gear("HFUC-58-100").expect("a gear of the catalog");
    /// assert_eq!((gear.ratio, gear.rated_torque_nm), (100.0, Some(696.0)));
    /// assert!(catalogs.gear("HFUC-58-101").is_err(), "the error lists names that are near");
    /// ```
    pub fn builtin() -> Self {
        // The files are compiled in, and a test loads them, so users never see this fail.
        from_sources(&builtin_sources(), Vec::new()).expect("the built-in catalogs are tested to be sound")
    }

    /// The built-in catalogs with the rows of a user's folder added. A row with a new name is added; a row whose
    /// name exists replaces the earlier one. The folder must have at least one of the files of [`CatalogFile`].
    ///
    /// # Errors
    /// [`InputError::Unreadable`] if the folder cannot be read. [`InputError::Faulty`] with every fault of every
    /// file, or if the folder has none of the files.
    pub fn load(overlay: Option<&Path>) -> Result<Self, InputError> {
        let Some(folder) = overlay else { return Ok(Self::builtin()) };
        let (own, warnings) = overlay_sources(folder)?;
        let mut sources = builtin_sources();
        sources.extend(own);
        Ok(from_sources(&sources, warnings)?)
    }
}

fn builtin_sources() -> Vec<Source> {
    let source = |file: CatalogFile| Source {
        file,
        name: format!("{BUILT_IN}{}", file.file_name()),
        bytes: file.builtin_text().as_bytes().to_vec(),
    };
    CatalogFile::ALL.map(source).into()
}

/// The catalog files of a folder, and a warning for each `.csv` file with another name.
fn overlay_sources(folder: &Path) -> Result<(Vec<Source>, Vec<Fault>), InputError> {
    let shown = folder.display().to_string();
    let unreadable = |source| InputError::Unreadable { file: shown.clone(), source };
    let entries: Vec<_> =
        std::fs::read_dir(folder).map_err(unreadable)?.collect::<Result<_, _>>().map_err(unreadable)?;
    let mut names: Vec<_> = entries.iter().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    let mut sources = Vec::new();
    for file in CatalogFile::ALL.into_iter().filter(|f| names.iter().any(|n| n == f.file_name())) {
        let path = folder.join(file.file_name());
        let name = path.display().to_string();
        let bytes =
            std::fs::read(&path).map_err(|source| InputError::Unreadable { file: name.clone(), source })?;
        sources.push(Source { file, name, bytes });
    }
    if sources.is_empty() {
        return Err(Faults(vec![no_catalog_file(&shown, &names)]).into());
    }
    Ok((sources, names.iter().filter_map(|name| stray_file(folder, name)).collect()))
}

/// Names of all files that a catalog folder may have.
fn file_names() -> [&'static str; 7] {
    CatalogFile::ALL.map(CatalogFile::file_name)
}

fn no_catalog_file(folder: &str, names: &[String]) -> Fault {
    let near = names.iter().find_map(|name| Some((name, closest(name, &file_names())?)));
    let near = near.map(|(name, known)| format!("should {name} be {known}? ")).unwrap_or_default();
    Fault {
        file: folder.into(),
        line: None,
        field: String::new(),
        problem: "the folder holds no catalog file".into(),
        hint: format!("{near}put in any of: {}", file_names().join(", ")),
    }
}

fn stray_file(folder: &Path, name: &str) -> Option<Fault> {
    let stray = name.to_lowercase().ends_with(".csv") && !file_names().contains(&name);
    stray.then(|| Fault {
        file: folder.join(name).display().to_string(),
        line: None,
        field: String::new(),
        problem: "is not read".into(),
        hint: format!("catalog files are called {}", file_names().join(", ")),
    })
}

/// The catalogs that consist of the rows of all `sources`. A row of a later source replaces a row of the same name.
/// The error has all faults of all sources.
fn from_sources(sources: &[Source], warnings: Vec<Fault>) -> Result<Catalogs, Faults> {
    let log = Log::default();
    log.warnings.borrow_mut().extend(warnings);
    let mut catalogs = Catalogs::default();
    for source in sources {
        let before = log.faults.borrow().len();
        let rows = rows(source.file, &source.name, &source.bytes, &log);
        add_file(&mut catalogs, source, &rows);
        log.faults.borrow_mut()[before..].sort_by_key(|fault| fault.line);
    }
    trend::check(&catalogs, &log);
    motor_curves::check(&catalogs, &log);
    let faults = log.faults.into_inner();
    if !faults.is_empty() {
        return Err(Faults(faults));
    }
    catalogs.warnings = log.warnings.into_inner();
    Ok(catalogs)
}

fn add_file(catalogs: &mut Catalogs, source: &Source, rows: &[Row]) {
    let replaced = match source.file {
        CatalogFile::Gears => {
            rows.iter().for_each(|row| add_alias(catalogs, row));
            add(&mut catalogs.gears, rows, gears::gear, |g| g.id.clone())
        }
        CatalogFile::Efficiency => add(&mut catalogs.efficiency, rows, efficiency::point, |p| {
            format!("{:?} {} {:?} {:?} {}", p.kind, p.series, p.size, p.ratio, p.x)
        }),
        CatalogFile::Actuators => {
            add(&mut catalogs.motors, rows, actuators::motor, |m| m.id.clone());
            add(&mut catalogs.gears, rows, actuators::gear, |g| g.id.clone())
        }
        CatalogFile::MotorCurves => {
            motor_curves::attach(catalogs, rows);
            0
        }
        CatalogFile::Motors => add(&mut catalogs.motors, rows, motors::motor, |m| m.id.clone()),
        CatalogFile::Materials => add(&mut catalogs.materials, rows, materials::material, |m| m.name.clone()),
        CatalogFile::Profiles => add(&mut catalogs.profiles, rows, profiles::profile, |p| {
            format!("{} {}", p.material_family, p.designation)
        }),
    };
    catalogs.printed.extend(rows.iter().map(|row| ((source.name.clone(), row.line()), row.printed())));
    catalogs.loaded.push(Loaded {
        file: source.file,
        name: source.name.clone(),
        rows: rows.len(),
        replaced,
        by_confidence: confidence_counts(rows),
    });
}

/// Adds the parts of a file's rows to `parts`. A part whose name exists replaces the earlier one. `read` makes a part
/// of a row, and `name` gives its name. Returns how many parts were replaced.
fn add<T>(parts: &mut Vec<T>, rows: &[Row], read: fn(&Row) -> Option<T>, name: fn(&T) -> String) -> usize {
    let mut places: std::collections::BTreeMap<String, usize> =
        parts.iter().enumerate().map(|(i, part)| (name(part).to_lowercase(), i)).collect();
    let mut replaced = 0;
    for part in rows.iter().filter_map(read) {
        match places.get(&name(&part).to_lowercase()) {
            Some(&place) => {
                parts[place] = part;
                replaced += 1;
            }
            None => {
                places.insert(name(&part).to_lowercase(), parts.len());
                parts.push(part);
            }
        }
    }
    replaced
}

fn confidence_counts(rows: &[Row]) -> [usize; 4] {
    let confidences: Vec<_> =
        rows.iter().filter_map(Row::provenance).map(|p: Provenance| p.confidence).collect();
    Confidence::ALL.map(|level| confidences.iter().filter(|&&c| c == level).count())
}

fn add_alias(catalogs: &mut Catalogs, row: &Row) {
    let (Some(alias), Some(series)) = (gears::alias(row), row.filled("series")) else { return };
    let known = catalogs.series_aliases.entry(alias.to_string()).or_insert_with(|| series.to_string());
    if known != series {
        let problem = format!("\"{alias}\" is already the other name of {known}");
        row.fault("alias_series", problem, "a name stands for one series");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_catalogs_are_sound() {
        let found = from_sources(&builtin_sources(), Vec::new());
        assert!(found.is_ok(), "{}", found.expect_err("faults"));
    }
}
