//! Caveats of parts: some ratings were not read in a document of the vendor, or are typical values of a class of parts.
//! Every pick that uses such a part is marked.

use super::front_table::FrontTable;
use crate::arm::pieces::without_factors;
use crate::catalog::{Catalogs, Provenance};
use std::collections::BTreeMap;

/// The caveats of parts, by the names of the parts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Caveats {
    of_parts: BTreeMap<String, &'static str>,
    /// Parts that the study gives. Every design has them, and columns of the front may lack them.
    given: Vec<String>,
}

/// Endings of the columns that name parts. The name of the link or joint comes before the ending.
const PARTS: [&str; 4] = ["_material", "_profile", "_gear", "_motor"];

impl Caveats {
    /// Caveats of all parts of the catalogs.
    pub fn of(catalogs: &Catalogs) -> Self {
        let gears = catalogs.gears.iter().map(|p| (&p.id, &p.provenance));
        let motors = catalogs.motors.iter().map(|p| (&p.id, &p.provenance));
        let materials = catalogs.materials.iter().map(|p| (&p.name, &p.provenance));
        let profiles = catalogs.profiles.iter().map(|p| (&p.designation, &p.provenance));
        let parts = gears.chain(motors).chain(materials).chain(profiles);
        let caveat = |(name, provenance): (&String, &Provenance)| Some((name.clone(), provenance.caveat()?));
        Self { of_parts: parts.filter_map(caveat).collect(), given: Vec::new() }
    }

    /// These caveats for designs that all have the parts `given`.
    pub(crate) fn with_given(self, given: Vec<String>) -> Self {
        Self { given, ..self }
    }

    /// Caveat of a part: `third party`, `from memory` or `representative`; `None` if its ratings were read in a
    /// document of the vendor.
    pub fn of_part(&self, name: &str) -> Option<&'static str> {
        self.of_parts.get(without_factors(name)).copied()
    }

    /// The name of a part, followed by its caveat in brackets.
    pub fn marked(&self, name: &str) -> String {
        self.of_part(name).map_or(name.to_string(), |caveat| format!("{name} ({caveat})"))
    }

    /// One sentence that names the parts with caveats and the picks that use them. Each item of
    /// `picks` is the row of the front and the name of a pick. Empty if no part has a caveat.
    pub(crate) fn sentence(&self, front: &FrontTable, picks: &[(usize, String)]) -> String {
        let mut used: Vec<(&str, Vec<String>)> = Vec::new();
        for (row, name) in picks {
            let given = self.given.iter().map(String::as_str);
            for part in given.chain(parts(front, *row)).filter(|part| self.of_part(part).is_some()) {
                let name = name.clone();
                match used.iter_mut().find(|(known, _)| *known == part) {
                    Some((_, names)) if names.contains(&name) => {}
                    Some((_, names)) => names.push(name),
                    None => used.push((part, vec![name])),
                }
            }
        }
        let place = |names: &[String]| match names.len() == picks.len() {
            true => "every pick".to_string(),
            false => names.join(", "),
        };
        let words: Vec<String> =
            used.iter().map(|(part, names)| format!("{} in {}", self.marked(part), place(names))).collect();
        match words.is_empty() {
            true => String::new(),
            false => format!("Figures not seen in a document of the vendor: {}.", words.join("; ")),
        }
    }
}

/// The names of the parts (materials, profiles, gears and motors) of the design in the row `row`.
fn parts(front: &FrontTable, row: usize) -> impl Iterator<Item = &str> {
    let named = front.columns.iter().zip(&front.rows[row]);
    named
        .filter(|(column, cell)| PARTS.iter().any(|end| column.ends_with(end)) && !cell.is_empty())
        .map(|(_, cell)| cell.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::picks::{designs, picks, rows_and_names};

    #[test]
    fn a_recalled_motor_and_a_representative_laminate_are_named_with_their_picks() {
        let caveats = Caveats::of(&Catalogs::builtin());
        assert_eq!(caveats.of_part("Structural steel S355"), None);
        assert_eq!(caveats.marked("F11-10"), "F11-10 (from memory)");
        assert_eq!(caveats.marked("HG-KR73"), "HG-KR73 (third party)");
        let words = |row: &str| row.split(';').map(String::from).collect::<Vec<_>>();
        let front = FrontTable {
            columns: words("design_id;arm_material;j1_motor;tip_deflection_mm;mass_kg;lowest_mode_hz"),
            rows: vec![
                words("a;Boron/epoxy quasi-isotropic;F11-10;1;20;30"),
                words("b;Structural steel S355;F11-10;2;10;20"),
            ],
        };
        let picked = rows_and_names(&picks(&designs(&front)));
        let sentence = caveats.sentence(&front, &picked);
        assert!(
            sentence.contains("Boron/epoxy quasi-isotropic (representative) in stiffest, highest mode"),
            "{sentence}"
        );
        assert!(sentence.contains("F11-10 (from memory) in every pick"), "{sentence}");
        assert!(!sentence.contains("S355"), "{sentence}");
    }
}
