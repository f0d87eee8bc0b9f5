//! Functions for sentences: breaking into lines, joining with "and", capital letters.

/// Width of a terminal for which text is wrapped \[characters\].
pub(crate) const TERMINAL: usize = 80;

/// Breaks text into lines of at most `width` characters. Each line begins with `lead`. A number and its unit stay
/// on the same line.
pub(crate) fn wrap(words: &str, width: usize, lead: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in bound(words) {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(format!("{lead}{word}")),
        }
    }
    lines.iter().map(|l| format!("{l}\n")).collect()
}

/// The words of a text. A unit is joined to the number before it.
fn bound(words: &str) -> Vec<String> {
    const UNITS: [&str; 5] = ["%", "mm", "kg", "Hz", "EUR"];
    let mut out: Vec<String> = Vec::new();
    for word in words.split_whitespace() {
        let is_unit = UNITS.contains(&word.trim_end_matches([',', ';', '.', ')', ':']));
        match out.last_mut() {
            Some(number) if is_unit && number.ends_with(|c: char| c.is_ascii_digit()) => {
                number.push(' ');
                number.push_str(word);
            }
            _ => out.push(word.to_string()),
        }
    }
    out
}

/// The text with its first letter in upper case.
pub(crate) fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}

/// The words joined as a list: `steel`, `steel and titanium`, `steel, titanium and CFRP`.
pub(crate) fn and(words: &[impl AsRef<str>]) -> String {
    match words {
        [] => String::new(),
        [one] => one.as_ref().to_string(),
        [init @ .., last] => {
            let init: Vec<&str> = init.iter().map(AsRef::as_ref).collect();
            format!("{} and {}", init.join(", "), last.as_ref())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_and_its_unit_stay_on_one_line() {
        assert_eq!(wrap("it is 28 %, or 12 kg", 8, ""), "it is\n28 %, or\n12 kg\n");
    }
}
