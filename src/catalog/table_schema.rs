//! The columns of a catalog file as a Table Schema (<https://specs.frictionlessdata.io/table-schema/>), which programs
//! that check CSV files read.

use super::schema::{CatalogFile, Cell, Column};
use serde_json::{Value, json};

impl CatalogFile {
    /// The columns of the file as a Table Schema, in JSON.
    pub fn table_schema(self) -> Value {
        json!({
            "$schema": "https://datapackage.org/profiles/2.0/tableschema.json",
            "title": format!("Armwright: {}", self.file_name()),
            "fields": self.columns().iter().map(field).collect::<Vec<_>>(),
            "primaryKey": self.key(),
            "missingValues": [""],
        })
    }
}

fn field(column: &Column) -> Value {
    let (kind, mut constraints) = match column.cell {
        Cell::Text => ("string", json!({})),
        Cell::Word(words) => ("string", json!({"pattern": any_case(words)})),
        Cell::Count => ("integer", json!({"minimum": 1})),
        Cell::Number => ("number", json!({})),
        Cell::NonNegative => ("number", json!({"minimum": 0})),
        Cell::Positive => ("number", json!({"exclusiveMinimum": 0})),
        Cell::Fraction => ("number", json!({"exclusiveMinimum": 0, "maximum": 1})),
    };
    if column.required {
        constraints["required"] = json!(true);
    }
    let figure = if column.figure { "a figure of the part" } else { "its name, its source or a remark" };
    json!({"name": column.name, "type": kind, "description": figure, "constraints": constraints})
}

/// A regular expression that matches some words in upper or lower case.
fn any_case(words: &[&str]) -> String {
    let word = |word: &&str| -> String {
        let letter = |c: char| match c.is_ascii_alphabetic() {
            true => format!("[{}{}]", c.to_ascii_uppercase(), c.to_ascii_lowercase()),
            false if c.is_ascii_punctuation() && c != '-' && c != '_' => format!("\\{c}"),
            false => c.to_string(),
        };
        word.chars().map(letter).collect()
    };
    format!("^({})$", words.iter().map(word).collect::<Vec<_>>().join("|"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_schema_has_every_column_with_what_its_cells_may_hold() {
        let schema = CatalogFile::Profiles.table_schema();
        assert_eq!(schema["fields"].as_array().map(Vec::len), Some(CatalogFile::Profiles.columns().len()));
        assert_eq!(schema["primaryKey"], json!(["material_family", "designation"]));
        let wall = &schema["fields"][5];
        assert_eq!(wall["name"], "wall_t_m");
        assert_eq!(wall["constraints"], json!({"exclusiveMinimum": 0, "required": true}));
        assert_eq!(any_case(&["ac-servo"]), "^([Aa][Cc]-[Ss][Ee][Rr][Vv][Oo])$");
    }
}
