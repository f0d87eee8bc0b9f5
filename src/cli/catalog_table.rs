//! The rows of each catalog file, and tables of text in which they are shown.

use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::motor::{Motor, MotorKind};
use crate::catalog::schema::CatalogFile;
use crate::catalog::{Catalogs, Provenance};

/// The gears that are sold alone.
pub(super) fn gears_of(catalogs: &Catalogs) -> impl Iterator<Item = &Gear> {
    catalogs.gears.iter().filter(|gear| gear.kind != GearKind::Actuator)
}

/// The gears that are part of an actuator.
pub(super) fn actuators_of(catalogs: &Catalogs) -> impl Iterator<Item = &Gear> {
    catalogs.gears.iter().filter(|gear| gear.kind == GearKind::Actuator)
}

/// The motors that are sold alone.
pub(super) fn motors_of(catalogs: &Catalogs) -> impl Iterator<Item = &Motor> {
    catalogs.motors.iter().filter(|motor| motor.kind != MotorKind::OfActuator)
}

pub(super) fn provenances(
    catalogs: &Catalogs,
    file: CatalogFile,
) -> Box<dyn Iterator<Item = &Provenance> + '_> {
    match file {
        CatalogFile::Gears => Box::new(gears_of(catalogs).map(|g| &g.provenance)),
        CatalogFile::Actuators => Box::new(actuators_of(catalogs).map(|g| &g.provenance)),
        CatalogFile::MotorCurves => Box::new(std::iter::empty()),
        CatalogFile::Efficiency => Box::new(catalogs.efficiency.iter().map(|p| &p.provenance)),
        CatalogFile::Motors => Box::new(motors_of(catalogs).map(|m| &m.provenance)),
        CatalogFile::Materials => Box::new(catalogs.materials.iter().map(|m| &m.provenance)),
        CatalogFile::Profiles => Box::new(catalogs.profiles.iter().map(|p| &p.provenance)),
    }
}

pub(super) fn cell<'r>(row: &'r [(&'static str, String)], column: &str) -> &'r str {
    row.iter().find(|(name, _)| *name == column).map_or("", |(_, text)| text)
}

/// A table of text with headers (`name|unit`) above the columns. Columns of numbers are aligned to the right.
pub(super) struct TextTable {
    pub head: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl TextTable {
    pub(super) fn new(head: Vec<String>) -> Self {
        Self { head, rows: Vec::new() }
    }

    pub(super) fn to_text(&self) -> String {
        let heads = self.head.iter().map(|head| head.split_once('|').unwrap_or((head, "")));
        let (names, units): (Vec<_>, Vec<_>) =
            heads.map(|(name, unit)| (name.to_string(), unit.to_string())).unzip();
        let mut lines = vec![names];
        if units.iter().any(|unit| !unit.is_empty()) {
            lines.push(units);
        }
        lines.extend(self.rows.iter().cloned());
        let columns: Vec<_> = (0..self.head.len()).map(|i| self.column(i, &lines)).collect();
        lines.iter().fold(String::new(), |out, line| out + &aligned(line, &columns) + "\n")
    }

    /// Width of the column `i` in `lines` \[characters\], and whether all cells of the column are numbers or blank.
    fn column(&self, i: usize, lines: &[Vec<String>]) -> (usize, bool) {
        let width = lines.iter().map(|line| line[i].chars().count()).max().unwrap_or(0);
        (width, self.rows.iter().all(|row| row[i].is_empty() || row[i].parse::<f64>().is_ok()))
    }
}

fn aligned(line: &[String], columns: &[(usize, bool)]) -> String {
    let mut out = String::new();
    for (text, (width, is_number)) in line.iter().zip(columns) {
        let padding = " ".repeat(width - text.chars().count());
        out += &if *is_number { format!("{padding}{text}  ") } else { format!("{text}{padding}  ") };
    }
    out.trim_end().to_string()
}
