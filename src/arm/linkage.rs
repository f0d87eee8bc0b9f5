//! Linkages: which joints turn another joint in addition to its own drive, and how far.
//!
//! In a linkage, driving joints turn a passive joint. A driven joint is turned by other joints if its motor sits
//! inboard of them: while the motor stands still, they turn the driven joint through its stages
//! ([`transmission`](super::transmission)). A joint may turn with a second joint, which turns with a third. The factors
//! along each such path from one joint to another are multiplied, and the products of all paths are added.

use super::structure::{JointAngle, JointPiece, Structure};

/// A joint that turns another.
#[derive(Debug, Clone, PartialEq)]
pub struct Linkage {
    /// Name of the driving joint.
    pub driver: String,
    /// Name of the joint that it turns.
    pub passive: String,
    /// Rotation of the passive joint divided by rotation of the driving joint.
    pub factor: f64,
}

/// The linkages of an arm: every joint that turns another.
pub(crate) fn linkages(structure: &Structure) -> Vec<Linkage> {
    let direct =
        |name: &str| structure.joints().find(|j| j.name == name).map_or(Vec::new(), |j| terms(j, structure));
    let of = |joint: &JointPiece| {
        let passive = joint.name.clone();
        let all = composed(&joint.name, &direct).into_iter();
        all.map(move |(driver, factor)| Linkage { driver, passive: passive.clone(), factor })
            .collect::<Vec<_>>()
    };
    structure.joints().flat_map(of).collect()
}

/// The joints that turn `joint` directly, each with its factor.
fn terms(joint: &JointPiece, structure: &Structure) -> Vec<(String, f64)> {
    let JointAngle::Coupled(entries) = &joint.angle else { return joint.turns_with.clone() };
    let name = |entry: usize| {
        structure.joints().find(|j| j.angle == JointAngle::Driven(entry)).map(|j| j.name.clone())
    };
    entries.iter().filter_map(|(entry, factor)| Some((name(*entry)?, *factor))).collect()
}

/// All joints that turn the joint named `name`, directly or through other joints, each with its factor. `direct`
/// returns the joints that turn a named joint directly. No joint may turn itself, not even through others.
pub(crate) fn composed(name: &str, direct: &dyn Fn(&str) -> Vec<(String, f64)>) -> Vec<(String, f64)> {
    let mut out: Vec<(String, f64)> = Vec::new();
    let mut add = |driver: String, factor: f64| match out.iter_mut().find(|(known, _)| *known == driver) {
        Some((_, sum)) => *sum += factor,
        None => out.push((driver, factor)),
    };
    for (driver, factor) in direct(name) {
        for (beyond, further) in composed(&driver, direct) {
            add(beyond, factor * further);
        }
        add(driver, factor);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_multiply_along_a_way_and_add_over_ways() {
        let direct = |name: &str| match name {
            "c" => vec![("a".to_string(), 0.5), ("b".to_string(), -2.0)],
            "b" => vec![("a".to_string(), -1.0)],
            _ => Vec::new(),
        };
        let mut of_c = composed("c", &direct);
        of_c.sort_by(|x, y| x.0.cmp(&y.0));
        assert_eq!(of_c, [("a".to_string(), 0.5 + 2.0), ("b".to_string(), -2.0)]);
        assert_eq!(composed("a", &direct), []);
    }
}
