//! Circles in a list in which every entry leads to at most one other: joints that mimic each other, links that hold each
//! other.

/// The circles of a list, in which each entry is the index of the entry to which it leads. Each circle is found once: its
/// entries in the order in which they lead to each other, from the one that comes first in the list. The time grows with
/// the length of the list.
pub(super) fn circles(next: &[Option<usize>]) -> Vec<Vec<usize>> {
    let mut out: Vec<Vec<usize>> = Vec::new();
    // the walk in which an entry was first reached
    let mut walk_of: Vec<Option<usize>> = vec![None; next.len()];
    for start in 0..next.len() {
        let mut way = Vec::new();
        let mut at = Some(start);
        while let Some(entry) = at.filter(|entry| walk_of[*entry].is_none()) {
            walk_of[entry] = Some(start);
            way.push(entry);
            at = next[entry];
        }
        let Some(met) = at.filter(|entry| walk_of[*entry] == Some(start)) else { continue };
        let mut circle = way.split_off(way.iter().position(|entry| *entry == met).unwrap_or_default());
        let first = circle.iter().enumerate().min_by_key(|(_, entry)| **entry).map_or(0, |(place, _)| place);
        circle.rotate_left(first);
        out.push(circle);
    }
    out.sort_unstable();
    out
}

#[cfg(test)]
mod tests {
    use super::circles;

    #[test]
    fn every_circle_is_found_once_from_its_first_entry() {
        // 0 -> 3 -> 1 -> 3: a way into the circle of 1 and 3; 2 leads to itself; 4 ends; 5 leads into the circle
        let next = [Some(3), Some(3), Some(2), Some(1), None, Some(1)];
        assert_eq!(circles(&next), [vec![1, 3], vec![2]]);
        assert_eq!(circles(&[Some(1), Some(2), None]), Vec::<Vec<usize>>::new());
        // a ring of a million takes no longer than a walk around it
        let ring: Vec<Option<usize>> = (1..=1_000_000).map(|next| Some(next % 1_000_000)).collect();
        assert_eq!(circles(&ring).len(), 1);
    }
}
