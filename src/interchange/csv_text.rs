//! Tables as CSV text.

/// The text of a table with a header and rows. Cells with commas, quotes or line breaks are quoted.
pub(crate) fn csv_text<const N: usize>(
    header: &[&str; N],
    rows: impl Iterator<Item = Vec<String>>,
) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header: Vec<String> = header.iter().map(ToString::to_string).collect();
    for row in std::iter::once(header).chain(rows) {
        writer.write_record(&row).expect("rows of equal length go into memory");
    }
    writer.into_inner().expect("memory needs no flushing")
}
