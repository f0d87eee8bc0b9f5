//! The options of one level, halved again and again into a binary tree.

use std::cmp::Ordering;

/// A binary tree over the options of a level; every node is a set of options.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// The options, in an order in which the options of each node are next to each other.
    order: Vec<u32>,
}

#[derive(Debug, Clone)]
struct Node {
    first: usize,
    end: usize,
    halves: Option<[u32; 2]>,
}

impl Tree {
    /// Builds the tree over `options`. `keys` has the coordinates of each option. A set of options is halved at the
    /// median of the coordinate in which the set has the widest spread.
    pub(super) fn new(options: Vec<u32>, keys: &[Vec<f64>]) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: options };
        if !tree.order.is_empty() {
            tree.grow(0, tree.order.len(), keys);
        }
        tree
    }

    fn grow(&mut self, first: usize, end: usize, keys: &[Vec<f64>]) -> u32 {
        let place = self.nodes.len();
        self.nodes.push(Node { first, end, halves: None });
        if end - first > 1 {
            let options = &mut self.order[first..end];
            let key = widest(options, keys);
            let value = |option: u32| keys[option as usize].get(key).copied().unwrap_or(0.0);
            let half = (end - first) / 2;
            options.select_nth_unstable_by(half, |&a, &b| value(a).total_cmp(&value(b)).then(a.cmp(&b)));
            let middle = first + half;
            let halves = [self.grow(first, middle, keys), self.grow(middle, end, keys)];
            self.nodes[place].halves = Some(halves);
        }
        place as u32
    }

    /// Number of nodes. The root is node 0; without options there is no node.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The options below the node `node` of the tree.
    pub(super) fn options(&self, node: u32) -> &[u32] {
        let node = &self.nodes[node as usize];
        &self.order[node.first..node.end]
    }

    /// The two halves of a node; `None` for a single option.
    pub(super) fn halves(&self, node: u32) -> Option<[u32; 2]> {
        self.nodes[node as usize].halves
    }
}

/// Index of the coordinate in `keys` in which the options differ most.
fn widest(options: &[u32], keys: &[Vec<f64>]) -> usize {
    let width = |key: usize| {
        let values = options.iter().map(|&option| keys[option as usize][key]);
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if (most - least).is_finite() { most - least } else { 0.0 }
    };
    let keys = options.first().map_or(0, |&option| keys[option as usize].len());
    let compare = |a: &usize, b: &usize| width(*a).partial_cmp(&width(*b)).unwrap_or(Ordering::Equal);
    (0..keys).rev().max_by(compare).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_share_the_options_of_their_node() {
        let keys: Vec<Vec<f64>> = (0..13).map(|i| vec![f64::from(i % 4), f64::from(i * i)]).collect();
        let tree = Tree::new((0..13).collect(), &keys);
        for node in 0..tree.len() as u32 {
            let Some([a, b]) = tree.halves(node) else {
                assert_eq!(tree.options(node).len(), 1);
                continue;
            };
            assert_eq!([tree.options(a), tree.options(b)].concat(), tree.options(node));
            assert!(!tree.options(a).is_empty() && !tree.options(b).is_empty());
        }
        assert_eq!(tree.options(0).len(), 13);
    }

    #[test]
    fn options_are_parted_where_they_differ_most() {
        let keys: Vec<Vec<f64>> = [0.0f64, 9.0, 1.0, 8.0].map(|wide| vec![0.5 * wide.sqrt(), wide]).to_vec();
        let tree = Tree::new((0..4).collect(), &keys);
        let [light, heavy] = tree.halves(0).expect("four options");
        assert_eq!([tree.options(light), tree.options(heavy)], [[0, 2], [3, 1]]);
    }
}
