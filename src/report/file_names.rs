//! File names made from names of studies, campaigns, materials, poses, joints or pictures.
//!
//! A name may contain any characters. The file name that is made of it contains only lower-case letters, digits and
//! `-`. It is never empty, has at most 64 letters, and differs from the other file names that are made together
//! with it.

use std::collections::HashSet;

/// Largest number of letters of a file name, without prefix and ending. File systems allow 255 bytes.
const MOST_LETTERS: usize = 64;
/// Number of letters of a hash. The hash replaces what a file name cannot contain.
const HASH_LETTERS: usize = 8;
/// Names that Windows reserves for devices.
const DEVICES: [&str; 4] = ["aux", "con", "nul", "prn"];

/// File names for these names, in the same order. All differ from each other.
///
/// If several names give the same letters and digits, the first keeps them and the next ones get a number at the
/// end.
///
/// ```
/// use armwright::report::file_names::file_names;
///
/// assert_eq!(file_names(["Aluminium 6082-T6", "PA6+X", "PA6 X"]), ["aluminium-6082-t6", "pa6-x", "pa6-x-2"]);
/// assert_eq!(file_names(["../../etc"]), ["etc"]);
/// ```
pub fn file_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let mut taken = HashSet::new();
    names.into_iter().map(|name| unique_file_name(name, &mut taken)).collect()
}

/// The file name for a single name.
pub fn file_name(name: &str) -> String {
    unique_file_name(name, &mut HashSet::new())
}

/// The name of the folder of results for a name. If the name has characters beyond ASCII, which the folder's name
/// cannot contain, a hash of the whole name is added. Names that differ in such characters only have different folders.
pub(crate) fn folder_name(name: &str) -> String {
    let plain = file_name(name);
    let hash = hash_of(name);
    if name.is_ascii() || plain.ends_with(&hash) { plain } else { shortened_with(&plain, &hash) }
}

/// A file name for `name` that differs from all names in `taken`. The file name is added to `taken`.
pub(crate) fn unique_file_name(name: &str, taken: &mut HashSet<String>) -> String {
    let plain = not_empty_and_short(name);
    let numbered = (2..).map(|number: u64| format!("{plain}-{number}"));
    let mut candidates = std::iter::once(plain.clone()).chain(numbered);
    // numbers do not end, so one of them is always free
    let free = candidates.find(|candidate| !taken.contains(candidate)).unwrap_or(plain);
    taken.insert(free.clone());
    free
}

/// The letters and digits of a name. If the name has none, is too long, or is one of [`DEVICES`], a hash of the whole
/// name is added.
fn not_empty_and_short(name: &str) -> String {
    let plain = letters_and_digits(name);
    match plain.len() {
        0 => format!("name-{}", hash_of(name)),
        _ if DEVICES.contains(&plain.as_str()) => format!("{plain}-{}", hash_of(name)),
        1..=MOST_LETTERS => plain,
        _ => shortened_with(&plain, &hash_of(name)),
    }
}

/// A plain name and a hash, with as much of the name as there is room for.
fn shortened_with(plain: &str, hash: &str) -> String {
    let kept = plain.len().min(MOST_LETTERS - HASH_LETTERS - 1);
    format!("{}-{hash}", plain[..kept].trim_end_matches('-'))
}

/// A hash of a whole name, in [`HASH_LETTERS`] letters.
fn hash_of(name: &str) -> String {
    blake3::hash(name.as_bytes()).to_hex()[..HASH_LETTERS].to_string()
}

/// The name in lower case, with every run of characters other than ASCII letters and digits replaced by one `-`.
fn letters_and_digits(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        match c.is_ascii_alphanumeric() {
            true => out.push(c.to_ascii_lowercase()),
            false if !out.is_empty() && !out.ends_with('-') => out.push('-'),
            false => {}
        }
    }
    out.trim_end_matches('-').to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_of_any_names_are_plain_short_and_different() {
        let long = "m".repeat(300);
        let longer = "m".repeat(301);
        let names = [
            "PA6+X", "PA6 X", "pa6-x 2", "PA6/X", "", "..", "../..", "鋼", "鉄", "con", &long, &longer, "\n",
        ];
        let made = file_names(names);
        assert_eq!(made.iter().collect::<HashSet<_>>().len(), names.len(), "{made:?}");
        for name in &made {
            assert!((1..=MOST_LETTERS + 3).contains(&name.len()), "{name}");
            assert!(name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'), "{name}");
            assert!(!DEVICES.contains(&name.as_str()) && !name.starts_with('-'), "{name}");
        }
        // the third name would give `pa6-x-2`, but the second name has this already; so the third gets a further number
        assert_eq!(made[..3], ["pa6-x", "pa6-x-2", "pa6-x-2-2"]);
    }

    #[test]
    fn folders_of_names_that_differ_beyond_ascii_differ() {
        let long = "鋼".to_string() + &"m".repeat(300);
        let names = ["arm", "árm", "àrm", "arm é", "arm è", "鋼", "鉄", "con", "cön", &long];
        let made: HashSet<String> = names.iter().map(|name| folder_name(name)).collect();
        assert_eq!(made.len(), names.len(), "{made:?}");
        assert!(made.iter().all(|name| (1..=MOST_LETTERS).contains(&name.len())), "{made:?}");
        for plain in ["Light arm (2)", "con", "", &"m".repeat(300)] {
            assert_eq!(folder_name(plain), file_name(plain));
        }
    }

    #[test]
    fn the_file_name_of_a_long_name_does_not_depend_on_what_else_is_there() {
        let long = |end: &str| format!("{}{end}", "a long name ".repeat(20));
        assert_ne!(file_name(&long("1")), file_name(&long("2")));
        assert_eq!(file_name(&long("1")), file_names([long("1").as_str(), "b"])[0]);
    }
}
