//! Small aligned tables: as text for a terminal, as Markdown for a summary, as CSV for programs.

use super::number::significant;

/// The side on which the cells of a column are aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// At the left, for words.
    Left,
    /// At the right, for numbers.
    Right,
}

/// One column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name of the column's content, with the unit in brackets if it has one: `mass [kg]`.
    pub header: String,
    /// Side on which the cells are aligned.
    pub align: Align,
}

impl Column {
    /// A column of words.
    pub fn left(header: &str) -> Self {
        Self { header: header.to_string(), align: Align::Left }
    }

    /// A column of numbers.
    pub fn right(header: &str) -> Self {
        Self { header: header.to_string(), align: Align::Right }
    }

    /// A column of numbers with a unit.
    pub fn unit(name: &str, unit: &str) -> Self {
        Self::right(&format!("{name} [{unit}]"))
    }
}

/// A table of text cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new(columns: Vec<Column>) -> Self {
        Self { columns, rows: Vec::new() }
    }

    /// Adds a row. Missing cells are blank, surplus cells are dropped.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        let mut row: Vec<String> = cells.into_iter().map(Into::into).collect();
        row.resize(self.columns.len(), String::new());
        self.rows.push(row);
    }

    /// A table from CSV text. A column is aligned at the right if all of its cells are numbers or blank.
    pub fn from_csv(text: &str) -> Self {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let headers: Vec<String> =
            reader.headers().map_or(Vec::new(), |h| h.iter().map(String::from).collect());
        let cells = |r: csv::StringRecord| r.iter().map(String::from).collect::<Vec<_>>();
        let rows: Vec<Vec<String>> = reader.records().flatten().map(cells).collect();
        let number =
            |i: usize| rows.iter().all(|r| r.get(i).is_none_or(|c| c.is_empty() || c.parse::<f64>().is_ok()));
        let column = |(i, header): (usize, &String)| {
            if number(i) { Column::right(header) } else { Column::left(header) }
        };
        let mut table = Self::new(headers.iter().enumerate().map(column).collect());
        rows.into_iter().for_each(|row| table.row(row));
        table
    }

    /// This table with numbers rounded to at most `digits` significant digits. Whole numbers are not changed.
    #[must_use]
    pub fn rounded(mut self, digits: usize) -> Self {
        for cell in self.rows.iter_mut().flatten() {
            if let Ok(value) = cell.parse::<f64>()
                && cell.contains('.')
                && cell.len() > digits + 1
            {
                *cell = significant(value, digits);
            }
        }
        self
    }

    /// The table without the columns of these headers.
    pub(crate) fn without(mut self, headers: &[&str]) -> Self {
        let keeps: Vec<bool> = self.columns.iter().map(|c| !headers.contains(&c.header.as_str())).collect();
        let mut kept = keeps.iter();
        self.columns.retain(|_| kept.next().copied().unwrap_or(true));
        for row in &mut self.rows {
            let mut kept = keeps.iter();
            row.retain(|_| kept.next().copied().unwrap_or(true));
        }
        self
    }

    /// The table with its headers replaced by the words that `words` has for them.
    pub(crate) fn with_headers(mut self, words: impl Fn(&str) -> String) -> Self {
        self.columns.iter_mut().for_each(|column| column.header = words(&column.header));
        self
    }

    /// The columns of the table.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The rows that have been added.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// The table as aligned text, with a rule under the header, two blanks between columns and no blanks at line
    /// ends.
    pub fn to_text(&self) -> String {
        let widths = self.widths(|cell| cell.to_string());
        let headers: Vec<String> = self.columns.iter().map(|c| c.header.clone()).collect();
        let rule: Vec<String> = widths.iter().map(|w| "-".repeat(*w)).collect();
        let lines = [&headers, &rule].into_iter().chain(&self.rows);
        lines.map(|cells| format!("{}\n", self.line(cells, &widths, "  ").trim_end())).collect()
    }

    /// The table in Markdown. The source text is aligned too.
    pub fn to_markdown(&self) -> String {
        let widths: Vec<usize> = self.widths(escape_markdown).iter().map(|w| (*w).max(3)).collect();
        let headers: Vec<String> = self.columns.iter().map(|c| escape_markdown(&c.header)).collect();
        let rule: Vec<String> = self
            .columns
            .iter()
            .zip(&widths)
            .map(|(column, width)| match column.align {
                Align::Left => "-".repeat(*width),
                Align::Right => format!("{}:", "-".repeat(width - 1)),
            })
            .collect();
        let escaped: Vec<Vec<String>> =
            self.rows.iter().map(|row| row.iter().map(|cell| escape_markdown(cell)).collect()).collect();
        [headers, rule]
            .iter()
            .chain(&escaped)
            .map(|cells| format!("| {} |\n", self.line(cells, &widths, " | ")))
            .collect()
    }

    /// The table as CSV. Cells are quoted only if necessary.
    pub fn to_csv(&self) -> String {
        let headers: Vec<String> = self.columns.iter().map(|c| c.header.clone()).collect();
        std::iter::once(&headers).chain(&self.rows).map(|cells| csv_line(cells)).collect()
    }

    fn widths(&self, shown: impl Fn(&str) -> String) -> Vec<usize> {
        let mut widths: Vec<usize> = self.columns.iter().map(|c| length(&shown(&c.header))).collect();
        for row in &self.rows {
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = (*width).max(length(&shown(cell)));
            }
        }
        widths
    }

    fn line(&self, cells: &[String], widths: &[usize], between: &str) -> String {
        let padded: Vec<String> = cells
            .iter()
            .zip(widths)
            .zip(&self.columns)
            .map(|((cell, width), column)| pad(cell, *width, column.align))
            .collect();
        padded.join(between)
    }
}

/// One line of CSV with its line end.
pub(crate) fn csv_line(cells: &[String]) -> String {
    let quoted: Vec<String> = cells.iter().map(|cell| csv_cell(cell)).collect();
    format!("{}\n", quoted.join(","))
}

fn csv_cell(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_string()
    }
}

fn pad(cell: &str, width: usize, align: Align) -> String {
    let blanks = " ".repeat(width.saturating_sub(length(cell)));
    match align {
        Align::Left => format!("{cell}{blanks}"),
        Align::Right => format!("{blanks}{cell}"),
    }
}

fn length(text: &str) -> usize {
    text.chars().count()
}

fn escape_markdown(cell: &str) -> String {
    cell.replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(vec![Column::left("joint"), Column::unit("torque", "N m")]);
        table.row(["j2", "568.3"]);
        table.row(["j3 | wrist, \"bent\"", "2.45"]);
        table
    }

    #[test]
    fn numbers_are_rounded_for_people_and_words_and_whole_numbers_are_not() {
        let csv = "what,value,count\nlength 1.23456789 m,0.123456789,1234567\nnothing,,0.5\n";
        let table = Table::from_csv(csv).rounded(4);
        let rows = [["length 1.23456789 m", "0.1235", "1234567"], ["nothing", "", "0.5"]];
        assert_eq!(table.rows(), rows.map(|row| row.map(String::from).to_vec()));
    }

    #[test]
    fn text_is_aligned_and_has_no_trailing_blanks() {
        let expected = "joint               torque [N m]\n\
                        ------------------  ------------\n\
                        j2                         568.3\n\
                        j3 | wrist, \"bent\"          2.45\n";
        assert_eq!(table().to_text(), expected);
    }

    #[test]
    fn markdown_escapes_bars_and_marks_numbers() {
        let text = table().to_markdown();
        assert!(text.contains("j3 \\| wrist") && text.contains("-----------: |"));
        assert!(text.lines().all(|line| line.starts_with("| ") && line.ends_with(" |")));
    }

    #[test]
    fn csv_quotes_what_must_be_quoted() {
        assert!(table().to_csv().ends_with("\"j3 | wrist, \"\"bent\"\"\",2.45\n"));
    }
}
