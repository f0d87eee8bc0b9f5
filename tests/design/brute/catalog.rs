//! The catalogs as plain rows.

use std::collections::HashMap;
use std::path::Path;

/// One row: text by column name.
#[derive(Clone, Debug)]
pub struct Row {
    /// What studies and results call the part.
    pub id: String,
    cells: HashMap<String, String>,
}

impl Row {
    /// The text of a cell.
    pub fn text(&self, column: &str) -> &str {
        self.cells.get(column).unwrap_or_else(|| panic!("no column {column}"))
    }

    /// The number in a cell; blank is unknown.
    pub fn number(&self, column: &str) -> Option<f64> {
        let text = self.text(column).trim();
        (!text.is_empty()).then(|| text.parse().unwrap_or_else(|_| panic!("{column}: {text}")))
    }
}

/// What can be bought.
pub struct Catalog {
    pub gears: Vec<Row>,
    pub motors: Vec<Row>,
    pub materials: Vec<Row>,
    pub profiles: Vec<Row>,
}

impl Catalog {
    /// The files in the project's `catalogs/`.
    pub fn built_in() -> Self {
        let gear_id =
            |row: &Row| format!("{}-{}-{}", row.text("series"), row.text("size"), row.text("ratio"));
        Self {
            gears: rows("gears.csv", &gear_id),
            motors: rows("motors.csv", &|row| row.text("model").to_owned()),
            materials: rows("materials.csv", &|row| row.text("name").to_owned()),
            profiles: rows("profiles.csv", &|row| row.text("designation").to_owned()),
        }
    }

    /// The material of this name.
    pub fn material(&self, name: &str) -> &Row {
        self.materials.iter().find(|row| row.id == name).unwrap_or_else(|| panic!("no material {name}"))
    }
}

fn rows(file: &str, id_of: &dyn Fn(&Row) -> String) -> Vec<Row> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("catalogs").join(file);
    let mut reader = csv::Reader::from_path(path).expect("the catalog opens");
    let read = reader.deserialize().map(|cells| {
        let mut row = Row { id: String::new(), cells: cells.expect("a row reads") };
        row.id = id_of(&row);
        row
    });
    read.collect()
}
