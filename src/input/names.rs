//! Rules on the characters of names and other texts in input files.
//!
//! Names are printed in tables, pages and messages. Control characters, and characters that change the direction of
//! writing, would make a text look different from its content. So no text may contain such characters. A spreadsheet
//! runs a cell that begins with `=`, `+`, `-` or `@` as a formula. So no name may begin with one of these, unless it is
//! a number.

/// Description of what is wrong with a text, and a hint.
pub(crate) type Unfit = (String, &'static str);

/// Reason why a text is not allowed; `None` if it is. Line breaks and tabs are allowed.
pub(crate) fn unfit_text(text: &str) -> Option<Unfit> {
    unfit_character(text, |c| !matches!(c, '\n' | '\r' | '\t'))
}

/// Reason why a text is not allowed as a cell of a table; `None` if it is. Line breaks and tabs are allowed.
pub(crate) fn unfit_cell(text: &str) -> Option<Unfit> {
    unfit_text(text).or_else(|| would_run(text))
}

/// Reason why a text is not allowed as a name; `None` if it is.
pub(crate) fn unfit_name(text: &str) -> Option<Unfit> {
    unfit_character(text, |_| true).or_else(|| would_run(text))
}

/// A fault for the first hidden character of a text; `None` if there is none. Only characters for which `counts` is
/// true are examined.
fn unfit_character(text: &str, counts: impl Fn(char) -> bool) -> Option<Unfit> {
    let hidden = text.chars().filter(|c| counts(*c)).find(|c| is_hidden(*c))?;
    let what = if hidden.is_control() {
        "a control character"
    } else {
        "a character that turns the direction of writing"
    };
    Some((format!("has U+{:04X}, {what}", u32::from(hidden)), "remove it"))
}

/// Whether a character is a control character, or one of the Unicode characters that change the direction of
/// writing (marks, embeddings, overrides and isolates).
fn is_hidden(c: char) -> bool {
    let turns =
        matches!(c, '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || turns
}

/// A fault for a text that a spreadsheet would run as a formula; `None` for other texts. A sign alone is allowed.
fn would_run(text: &str) -> Option<Unfit> {
    let begins = text.chars().count() > 1 && text.starts_with(['=', '+', '-', '@']);
    let is_number = text.replace(',', ".").parse::<f64>().is_ok();
    (begins && !is_number).then(|| match has_unit(text) {
        true => {
            (format!("\"{}\" is a number with a unit", visible(text)), "write the number without the unit")
        }
        false => (
            format!("\"{}\" would run as a formula in a spreadsheet", visible(text)),
            "begin it with another character than =, +, - and @",
        ),
    })
}

/// Whether a text is a number, a blank and a unit: `-0.303 mm`.
fn has_unit(text: &str) -> bool {
    let (number, unit) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    !unit.trim().is_empty() && number.replace(',', ".").parse::<f64>().is_ok()
}

/// The text with its hidden characters replaced by escape sequences, for messages.
pub(crate) fn visible(text: &str) -> String {
    let shown = |c: char| match is_hidden(c) && c != '\n' {
        true => c.escape_unicode().to_string(),
        false => c.to_string(),
    };
    text.chars().map(shown).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_deceive_or_run_are_unfit() {
        for name in [
            "a\u{7}b",
            "a\nb",
            "a\tb",
            "\u{202e}gpj.exe",
            "a\u{2066}b",
            "=1+1",
            "+x",
            "@SUM(A1)",
            "-x",
            "-1e",
        ] {
            assert!(unfit_name(name).is_some(), "{name:?}");
        }
        for name in ["PA6+X", "j-1", "-30", "+90", "-1e-3", "-3,5", "-", "Größe", "鋼", "a=b", ""] {
            assert!(unfit_name(name).is_none(), "{name:?}");
        }
        let with_unit = unfit_name("-0.303 mm").unwrap_or_default();
        assert_eq!(with_unit.1, "write the number without the unit", "{with_unit:?}");
        assert!(unfit_text("two\nlines, = 1\tcm").is_none() && unfit_text("\u{1b}[2J").is_some());
        assert_eq!(visible("a\u{1b}b\nc"), "a\\u{1b}b\nc");
    }
}
