//! Shards of a search: the files with what each shard found, and how the results of an exhaustive search are joined
//! into one front.
//!
//! A shard keeps the candidates in its range of design numbers. When shards are joined, a candidate is dropped if a
//! candidate of another shard clearly dominates it, and the full model evaluates the rest. This is the same as after a
//! search on one machine, so the files of the front are equal byte by byte.

use crate::exact::outcome::FoundInShard;
use crate::pareto::objectives::Objectives;
use crate::search::sweep::{Candidate, Status, SweepOutcome, clear_dominated};
use std::fmt::Write;
use std::ops::Range;

/// The candidates of a sweep as CSV. The columns are the front (`all`, or the index of a material), the number of the
/// design, and its objectives by the fast model in m, kg and Hz. Numbers have the shortest form that reads back to the
/// same bits.
pub fn candidates_csv(swept: &SweepOutcome) -> String {
    let mut out = String::from(HEADER);
    let groups = swept.groups.iter().enumerate().map(|(k, group)| (k.to_string(), group));
    for (front, candidates) in std::iter::once(("all".to_string(), &swept.front)).chain(groups) {
        for Candidate { number, objectives: o } in candidates {
            let _ =
                writeln!(out, "{front},{number},{},{},{}", o.tip_deflection_m, o.mass_kg, o.lowest_mode_hz);
        }
    }
    out
}

const HEADER: &str = "front,number,tip_deflection_m,mass_kg,lowest_mode_hz\n";

/// Reads the text of [`candidates_csv`] for a study with this number of materials.
///
/// # Errors
/// The number of the first line that is not a candidate.
pub fn read_candidates(text: &str, materials: usize) -> Result<(Vec<Candidate>, Vec<Vec<Candidate>>), usize> {
    let mut front = Vec::new();
    let mut groups = vec![Vec::new(); materials];
    let rows = text.strip_prefix(HEADER).ok_or(1usize)?;
    for (line, row) in rows.lines().enumerate() {
        let cells: Vec<&str> = row.split(',').collect();
        let mut read = || -> Option<()> {
            let (of, rest) = cells.split_first()?;
            let (of, candidate) = (front_at(of)?, candidate(rest)?);
            match of.checked_sub(1) {
                None => front.push(candidate),
                Some(material) => groups.get_mut(material)?.push(candidate),
            }
            Some(())
        };
        read().ok_or(line + 2)?;
    }
    Ok((front, groups))
}

/// Index of the front with this name in a list that has the front of all designs first: 0 for `all`, and `k + 1` for
/// the index `k` of a material. `None` if the name is neither.
fn front_at(name: &str) -> Option<usize> {
    if name == ALL { Some(0) } else { name.parse::<usize>().ok()?.checked_add(1) }
}

/// Reads a candidate from the cells of its number and objectives; `None` if a cell is not a number or their count is
/// wrong.
fn candidate(cells: &[&str]) -> Option<Candidate> {
    let [number, tip, mass, mode] = cells[..] else { return None };
    let value = |cell: &str| cell.parse::<f64>().ok();
    let objectives =
        Objectives { tip_deflection_m: value(tip)?, mass_kg: value(mass)?, lowest_mode_hz: value(mode)? };
    Some(Candidate { number: number.parse().ok()?, objectives })
}

/// Name of the front of all designs. The name of a material's front is the index of the material.
const ALL: &str = "all";

/// The designs that a shard of an exact search found, front by front, as CSV. The columns are those of
/// [`candidates_csv`] and the column `decided`, which is `no` if rounding leaves open whether some part of the design
/// passes its checks.
pub fn found_csv(fronts: &[FoundInShard]) -> String {
    let mut out = String::from(FOUND_HEADER);
    for (at, found) in fronts.iter().enumerate() {
        let name = at.checked_sub(1).map_or(ALL.to_string(), |material| material.to_string());
        let decided = found.decided.iter().map(|candidate| (candidate, "yes"));
        for (Candidate { number, objectives: o }, word) in
            decided.chain(found.undecided.iter().map(|candidate| (candidate, "no")))
        {
            let Objectives { tip_deflection_m, mass_kg, lowest_mode_hz } = o;
            let _ = writeln!(out, "{name},{word},{number},{tip_deflection_m},{mass_kg},{lowest_mode_hz}");
        }
    }
    out
}

const FOUND_HEADER: &str = "front,decided,number,tip_deflection_m,mass_kg,lowest_mode_hz\n";

/// Reads the text of [`found_csv`] for this number of fronts. Only the designs are filled in; all other fields of the
/// results keep their defaults.
///
/// # Errors
/// The number of the first line that is no candidate.
pub fn read_found(text: &str, fronts: usize) -> Result<Vec<FoundInShard>, usize> {
    let mut out = vec![FoundInShard::default(); fronts];
    let rows = text.strip_prefix(FOUND_HEADER).ok_or(1usize)?;
    for (line, row) in rows.lines().enumerate() {
        let cells: Vec<&str> = row.split(',').collect();
        let mut read = || -> Option<()> {
            let [of, decided, rest @ ..] = &cells[..] else { return None };
            let found = out.get_mut(front_at(of)?)?;
            match *decided {
                "yes" => found.decided.push(candidate(rest)?),
                "no" => found.undecided.push(candidate(rest)?),
                _ => return None,
            }
            Some(())
        };
        read().ok_or(line + 2)?;
    }
    Ok(out)
}

/// The result of one shard of an exhaustive search.
#[derive(Debug, Clone, PartialEq)]
pub struct Swept {
    /// Number of designs that no drive, link or limit excludes, so that their objectives were computed.
    pub designs_evaluated: u64,
    /// Candidates of the front of all designs.
    pub front: Vec<Candidate>,
    /// Candidates of the front of each material.
    pub groups: Vec<Vec<Candidate>>,
}

/// The result of an exhaustive search of a whole space, joined from the results of its shards, which together must
/// cover the space.
pub fn joined(shards: Vec<Swept>, designs_total: u128) -> SweepOutcome {
    let materials = shards.iter().map(|shard| shard.groups.len()).max().unwrap_or_default();
    let (mut front, mut groups, mut designs_evaluated) = (Vec::new(), vec![Vec::new(); materials], 0u64);
    for shard in shards {
        designs_evaluated += shard.designs_evaluated;
        front.extend(shard.front);
        groups.iter_mut().zip(shard.groups).for_each(|(all, of)| all.extend(of));
    }
    for candidates in groups.iter_mut().chain([&mut front]) {
        clear_dominated(candidates);
        candidates.sort_unstable_by_key(|candidate| candidate.number);
    }
    SweepOutcome {
        status: if front.is_empty() { Status::Infeasible } else { Status::Complete },
        designs_total,
        designs_evaluated,
        designs_excluded: designs_total.saturating_sub(u128::from(designs_evaluated)),
        front,
        groups,
    }
}

/// The ranges of design numbers in `0..total` that none of `ranges` covers, and the first number that two of `ranges`
/// have in common (`None` if there is none).
pub fn gaps(mut ranges: Vec<Range<u128>>, total: u128) -> (Vec<Range<u128>>, Option<u128>) {
    ranges.retain(|range| !range.is_empty());
    ranges.sort_unstable_by_key(|range| range.start);
    let (mut missing, mut shared, mut covered) = (Vec::new(), None, 0u128);
    for range in ranges {
        if range.start > covered {
            missing.push(covered..range.start);
        }
        if range.start < covered {
            shared = shared.or(Some(range.start));
        }
        covered = covered.max(range.end);
    }
    if covered < total {
        missing.push(covered..total);
    }
    (missing, shared)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_read_back_to_the_same_bits() {
        let candidate = |number, tip_deflection_m| Candidate {
            number,
            objectives: Objectives { tip_deflection_m, mass_kg: 0.1 + 0.2, lowest_mode_hz: 1.0 / 3.0 },
        };
        let swept = joined(
            vec![Swept {
                designs_evaluated: 2,
                front: vec![candidate(u128::MAX, 1e-5 / 7.0)],
                groups: vec![vec![], vec![candidate(3, 2e-308)]],
            }],
            9,
        );
        let text = candidates_csv(&swept);
        assert_eq!(read_candidates(&text, 2), Ok((swept.front.clone(), swept.groups.clone())));
        assert_eq!(read_candidates(&text, 1), Err(3), "a material that the study does not have");
        assert_eq!(read_candidates(&text.replace("0.3333", "x"), 2), Err(2));
    }

    #[test]
    fn what_an_exact_shard_found_reads_back_to_the_same_bits() {
        let candidate = |number, mass_kg| Candidate {
            number,
            objectives: Objectives { tip_deflection_m: 1e-5 / 7.0, mass_kg, lowest_mode_hz: 1.0 / 3.0 },
        };
        let found = |decided, undecided| FoundInShard { decided, undecided, ..FoundInShard::default() };
        let fronts = vec![
            found(vec![candidate(u128::MAX, 0.1 + 0.2)], vec![candidate(5, 2e-308)]),
            found(vec![], vec![]),
            found(vec![candidate(0, 7.0)], vec![]),
        ];
        let text = found_csv(&fronts);
        assert_eq!(read_found(&text, 3), Ok(fronts));
        assert_eq!(read_found(&text, 2), Err(4), "a front that the study does not have");
        assert_eq!(read_found(&text.replace(",no,", ",maybe,"), 3), Err(3));
        assert_eq!(read_found(HEADER, 3), Err(1), "candidates of a sweep");
    }

    #[test]
    fn what_no_shard_covers_is_found_and_what_two_do() {
        assert_eq!(gaps(vec![4..9, 0..4], 9), (vec![], None));
        assert_eq!(gaps(vec![6..8, 1..3, 2..2], 9), (vec![0..1, 3..6, 8..9], None));
        assert_eq!(gaps(vec![0..5, 4..9], 9).1, Some(4));
        assert_eq!(gaps(vec![], 0), (vec![], None));
    }
}
