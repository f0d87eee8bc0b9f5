//! Finding a part by its name, or by an unambiguous part of the name.
//!
//! Upper and lower case do not matter. A text is first compared with whole names, then with the beginnings of names,
//! then with the beginnings of words in names (`S355` in `Structural steel S355`). It must not end within a number:
//! `F11-1` does not mean `F11-10`. The first of these comparisons that finds any part must find only one.

use super::Catalogs;
use super::gear::Gear;
use super::material::Material;
use super::motor::Motor;
use super::profile::Profile;
use crate::input::json::closest;
use std::fmt;

/// Kinds of parts in the catalogs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartKind {
    /// A gear.
    Gear,
    /// A motor.
    Motor,
    /// A material.
    Material,
    /// A profile.
    Profile,
}

impl fmt::Display for PartKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            PartKind::Gear => "gear",
            PartKind::Motor => "motor",
            PartKind::Material => "material",
            PartKind::Profile => "profile",
        })
    }
}

/// Reason why a text does not identify a part.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PartError {
    /// No part of this kind has a name that fits the text.
    #[error("no {kind} is called \"{name}\"; {}", near(.kind, .nearest))]
    Unknown {
        /// Kind of part that was asked for.
        kind: PartKind,
        /// Name that was asked for.
        name: String,
        /// Similar names, nearest first; may be empty.
        nearest: Vec<String>,
    },
    /// The text fits the names of several parts.
    #[error("{kind} \"{name}\" may be any of: {}; give more of the name", first_names(.candidates, NAMES_SHOWN))]
    Ambiguous {
        /// Kind of part that was asked for.
        kind: PartKind,
        /// Name that was asked for.
        name: String,
        /// All names that the text fits.
        candidates: Vec<String>,
    },
}

fn near(kind: &PartKind, nearest: &[String]) -> String {
    match nearest {
        [] => format!("`armwright catalog show {kind}s` lists them"),
        names => format!("nearest: {}", names.join(", ")),
    }
}

/// Number of names that a message about an ambiguous name shows.
const NAMES_SHOWN: usize = 6;

/// The first `most` names of a list in words, with the number of the others: `A, B and 3 more`.
pub(crate) fn first_names<S: AsRef<str>>(names: &[S], most: usize) -> String {
    let shown = names.iter().take(most).map(S::as_ref).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(most) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

impl Catalogs {
    /// The gear with the name `SERIES-SIZE-RATIO`. Other names of the series may be used: `CSF-58-100` is
    /// `HFUC-58-100`.
    ///
    /// # Errors
    /// No gear has the name. The error lists similar names.
    pub fn gear(&self, name: &str) -> Result<&Gear, PartError> {
        let own = self.alias_resolved(name);
        find(PartKind::Gear, &self.gears, own.as_deref().unwrap_or(name), |g| &g.id)
    }

    /// The name with another name of a series, such as `CSF`, replaced by the name of the series itself. `None` if
    /// there is nothing to replace, or if a gear has `name` as it is written.
    fn alias_resolved(&self, name: &str) -> Option<String> {
        let (alias, rest) = name.trim().split_once('-')?;
        if self.gears.iter().any(|gear| gear.id.eq_ignore_ascii_case(name.trim())) {
            return None;
        }
        let (_, series) = self.series_aliases.iter().find(|(other, _)| other.eq_ignore_ascii_case(alias))?;
        Some(format!("{series}-{rest}"))
    }

    /// The motor with this model name, or with an unambiguous part of it: `J 8.2` is `J 8.2 (129-)`.
    ///
    /// # Errors
    /// No motor has the name, or the text fits several.
    pub fn motor(&self, name: &str) -> Result<&Motor, PartError> {
        find(PartKind::Motor, &self.motors, name, |m| &m.id)
    }

    /// The material with this name, or with an unambiguous part of it.
    ///
    /// # Errors
    /// No material has the name, or the text fits several.
    pub fn material(&self, name: &str) -> Result<&Material, PartError> {
        find(PartKind::Material, &self.materials, name, |m| &m.name)
    }

    /// The profile with this designation, or with an unambiguous part of it.
    ///
    /// # Errors
    /// No profile has the designation, or the text fits several.
    pub fn profile(&self, name: &str) -> Result<&Profile, PartError> {
        find(PartKind::Profile, &self.profiles, name, |p| &p.designation)
    }
}

fn find<'p, T>(
    kind: PartKind,
    parts: &'p [T],
    name: &str,
    id: fn(&T) -> &String,
) -> Result<&'p T, PartError> {
    let wanted = name.trim().to_lowercase();
    let fits: [fn(&str, &str) -> bool; 3] = [|id, name| id == name, begins, has_word];
    for fit in fits {
        let found: Vec<_> = parts.iter().filter(|part| fit(&id(part).to_lowercase(), &wanted)).collect();
        match found.as_slice() {
            [] => {}
            [part] => return Ok(part),
            several => {
                let mut candidates: Vec<_> = several.iter().map(|part| id(part).clone()).collect();
                candidates.sort();
                return Err(PartError::Ambiguous { kind, name: name.into(), candidates });
            }
        }
    }
    let mut ids: Vec<_> = parts.iter().map(|part| id(part).as_str()).collect();
    ids.sort_unstable();
    Err(PartError::Unknown { kind, name: name.into(), nearest: nearest(&wanted, ids) })
}

/// A hint for a reader whose file has the name `name`, which no part has. It names the parts of `known` that may be meant:
/// the one that differs by a typing error, else those with a name or a word that begins so. `list` is the list of
/// `armwright catalog show` that has them all.
pub(crate) fn hint_for_unknown(name: &str, known: &[&str], list: &str) -> String {
    let wanted = name.trim().to_lowercase();
    let longer = |fits: fn(&str, &str) -> bool| {
        let mut found: Vec<&str> =
            known.iter().copied().filter(|id| fits(&id.to_lowercase(), &wanted)).collect();
        found.sort_unstable();
        found.dedup();
        found
    };
    let ways: [fn(&str, &str) -> bool; 2] = [begins, has_word];
    let near = match closest(name, known) {
        Some(id) => vec![id],
        None => ways.into_iter().map(longer).find(|found| !found.is_empty()).unwrap_or_default(),
    };
    let meant = match near.as_slice() {
        [] => "no name is similar; ".to_string(),
        [one] => format!("did you mean \"{one}\"? "),
        several => format!("did you mean one of {}? ", first_names(several, NAMES_SHOWN)),
    };
    format!("{meant}`armwright catalog show {list}` lists them")
}

/// Whether `id` begins with `name`, and `name` does not end within a number of `id`: `F11-1` is no beginning of
/// `F11-10`.
fn begins(id: &str, name: &str) -> bool {
    let Some(rest) = id.strip_prefix(name).filter(|_| !name.is_empty()) else { return false };
    let mut rest = rest.chars();
    let within_number = match rest.next() {
        Some('.') => rest.next().is_some_and(|c| c.is_ascii_digit()),
        next => next.is_some_and(|c| c.is_ascii_digit()),
    };
    !(within_number && name.ends_with(|c: char| c.is_ascii_digit()))
}

/// Whether some word of `id` begins with `name`, as in [`begins`].
fn has_word(id: &str, name: &str) -> bool {
    let starts = id.char_indices().filter(|(i, _)| {
        id[..*i].chars().next_back().is_some_and(|before| !before.is_alphanumeric() && before != '.')
    });
    starts.into_iter().any(|(i, _)| begins(&id[i..], name))
}

/// Up to four of the names `ids` that are similar to `wanted`, a name in lower case. Names that begin with `wanted`
/// come first, then names that differ from it by a typing error.
fn nearest(wanted: &str, mut ids: Vec<&str>) -> Vec<String> {
    let mut out: Vec<&str> = Vec::new();
    while out.len() < 4 {
        let longer =
            ids.iter().copied().find(|id| !wanted.is_empty() && id.to_lowercase().starts_with(wanted));
        let Some(next) = longer.or_else(|| closest(wanted, &ids)) else { break };
        ids.retain(|id| *id != next);
        out.push(next);
    }
    out.into_iter().map(String::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_does_not_end_within_a_number() {
        assert!(begins("j 8.2 (129-)", "j 8.2"));
        assert!(!begins("j 8.2 (129-)", "j 8"));
        assert!(!begins("f11-10", "f11-1"));
        assert!(!begins("j 50.0 (129-)", "j 5"));
        assert!(begins("f11-10", "f11"));
    }

    #[test]
    fn a_word_within_a_name_is_enough_when_it_is_the_only_one() {
        assert!(has_word("structural steel s355", "s355"));
        assert!(!has_word("structural steel s355", "355"));
        assert!(has_word("283860 (ec-max 22 25 w)", "ec-max 22 25"));
    }

    #[test]
    fn an_exact_name_wins_over_longer_ones() {
        let ids = ["A".to_string(), "A 2".into(), "a 3".into()];
        assert_eq!(find(PartKind::Motor, &ids, "a", |id| id), Ok(&ids[0]));
        assert!(matches!(
            find(PartKind::Motor, &ids[1..], "a", |id| id),
            Err(PartError::Ambiguous { candidates, .. }) if candidates.len() == 2
        ));
    }

    #[test]
    fn the_empty_name_names_nothing() {
        let ids = ["A".to_string()];
        assert!(find(PartKind::Motor, &ids, " ", |id| id).is_err());
    }

    #[test]
    fn unknown_names_come_with_the_nearest() {
        let error = Catalogs::builtin().motor("F11-1O").expect_err("letter O");
        assert!(error.to_string().starts_with("no motor is called \"F11-1O\"; nearest: F11-10"), "{error}");
    }

    #[test]
    fn the_hint_for_an_unknown_name_names_what_may_be_meant() {
        let known = ["Aluminium 6061-T6", "Aluminium 6082-T6", "Structural steel S355", "Invar 36"];
        let hint = |name| hint_for_unknown(name, &known, "materials");
        let lists = "`armwright catalog show materials` lists them";
        assert_eq!(hint("Aluminum 6061-T6"), format!("did you mean \"Aluminium 6061-T6\"? {lists}"));
        assert_eq!(hint("S355"), format!("did you mean \"Structural steel S355\"? {lists}"));
        assert_eq!(
            hint("aluminium"),
            format!("did you mean one of Aluminium 6061-T6, Aluminium 6082-T6? {lists}")
        );
        assert_eq!(hint("Beryllium copper"), format!("no name is similar; {lists}"));
    }
}
