//! Finds the line of a fault in a URDF file. The parser of such files reports a fault without a line number.

/// Attributes of a URDF whose values are numbers, separated by spaces.
const NUMBERS: [&str; 17] = [
    "xyz",
    "rpy",
    "value",
    "ixx",
    "ixy",
    "ixz",
    "iyy",
    "iyz",
    "izz",
    "lower",
    "upper",
    "effort",
    "velocity",
    "multiplier",
    "offset",
    "friction",
    "damping",
];

/// The first attribute of numbers that holds something else, with its line: `xyz="0,5 0 0"`. `None` if all hold
/// numbers.
pub(super) fn no_numbers(text: &str) -> Option<(usize, String)> {
    text.lines().enumerate().find_map(|(at, line)| {
        let wrong = NUMBERS.iter().find_map(|key| {
            let value = value_of(line, key)?;
            let is_wrong = value.split_whitespace().any(|number| number.parse::<f64>().is_err());
            is_wrong.then(|| format!("{key}=\"{value}\""))
        });
        wrong.map(|wrong| (at + 1, wrong))
    })
}

/// The value of an attribute in a line; `None` if the line has no such attribute.
fn value_of<'t>(line: &'t str, key: &str) -> Option<&'t str> {
    let (at, _) = line.match_indices(key).find(|(at, _)| {
        let begins = line[..*at].chars().next_back().is_some_and(char::is_whitespace);
        begins && line[at + key.len()..].trim_start().starts_with('=')
    })?;
    let rest = line[at + key.len()..].trim_start().strip_prefix('=')?.trim_start();
    let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    rest[1..].split(quote).next()
}

/// The last line of a text that is cut off; `None` if it is whole. A text is cut off if it has no tag at all, or if it
/// has a `<robot` and no `</robot`.
pub(super) fn cut_off_at(text: &str) -> Option<usize> {
    let is_other = text.contains('<') && !text.contains("<robot");
    let is_whole = text.contains("</robot") || is_other;
    (!is_whole).then(|| text.lines().count().max(1))
}

/// The line in which the robot begins; `None` if there is none.
pub(super) fn line_of_robot(text: &str) -> Option<usize> {
    text.lines().position(|line| line.contains("<robot")).map(|at| at + 1)
}
