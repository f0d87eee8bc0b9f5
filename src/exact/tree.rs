//! A binary tree over the options of one level. Each node is a box: its bounds enclose the numbers of all options below
//! it.
//!
//! A tree may also be built over some nodes of a base tree: the nodes whose options may still belong to a design of a
//! region. Such a tree shares the nodes of the base tree and does not copy them.

use std::collections::{BTreeSet, BinaryHeap, HashMap};
use std::sync::Arc;

/// The bounds of a box of parts: intervals that enclose the numbers of all its members.
pub(super) trait Bounds: Clone {
    /// The smallest bounds that enclose all members of this box and of the box of `other`.
    fn join(&self, other: &Self) -> Self;

    /// Coordinates by which options are separated into halves. The options are divided at the coordinate with the
    /// greatest spread. A coordinate that matters more to the objectives is therefore scaled up.
    fn key(&self) -> Key;
}

/// Coordinates of an option by which a tree separates it from others.
pub(super) type Key = [f64; 5];

/// A tree over the options of a level. It is either the base tree, which has all options, or a tree that is built over
/// some nodes of the base tree.
pub(super) struct Tree<B> {
    nodes: Vec<Node<B>>,
    /// The base tree, if this tree is built over some of its nodes; `None` for a base tree. In this tree, nodes of the
    /// base tree are numbered from [`WHOLE`] on.
    whole: Option<Arc<Tree<B>>>,
    /// The nodes of the base tree over which this tree is built.
    stands_on: Vec<u32>,
}

/// Offset of the node numbers of the base tree within a tree that is built over some of its nodes.
const WHOLE: u32 = 1 << 31;

/// One node of a [`Tree`].
pub(super) struct Node<B> {
    pub bounds: B,
    /// The coordinates by which the node is separated from others; `None` for a node over which no other tree is built.
    key: Option<Key>,
    /// Number of options below the node.
    pub members: u32,
    /// The two halves of the node, or its single option.
    pub kind: NodeKind,
}

/// The two halves of a node or its single option.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NodeKind {
    /// Numbers of the two nodes into which the options are halved.
    Split([u32; 2]),
    /// A leaf: the number of its only option.
    Option(u32),
}

impl<B: Bounds> Node<B> {
    /// The coordinates by which the node is separated from others.
    pub(super) fn key(&self) -> Key {
        self.key.unwrap_or_else(|| self.bounds.key())
    }
}

impl<B: Bounds> Tree<B> {
    /// Builds a tree over options, each given by its number and its bounds. The options are halved at the median of the
    /// coordinate with the greatest spread, down to single options. `None` if there are no options.
    pub(super) fn build(options: impl Iterator<Item = (u32, B)>) -> Option<Self> {
        let options: Vec<(u32, B)> = options.collect();
        let item =
            |(at, (_, bounds)): (usize, &(u32, B))| Item { at: at as u32, members: 1, key: bounds.key() };
        let mut items: Vec<Item> = options.iter().enumerate().map(item).collect();
        if items.is_empty() {
            return None;
        }
        let mut nodes = Vec::with_capacity(2 * items.len() - 1);
        let leaf = |item: &Item| {
            let (option, bounds) = &options[item.at as usize];
            (Some(NodeKind::Option(*option)), bounds)
        };
        grow(&mut items, &mut nodes, &leaf);
        Some(Self { nodes, whole: None, stands_on: vec![0] })
    }

    /// A tree over the nodes `kept` of the base tree `tree`. None of these nodes may lie below another. `None` if
    /// `kept` is empty.
    pub(super) fn over(tree: &Arc<Self>, kept: &[u32]) -> Option<Arc<Self>> {
        // Nothing was excluded, so the same tree serves.
        if tree.whole.is_some() && tree.stands_on == kept {
            return Some(Arc::clone(tree));
        }
        let whole = tree.whole.as_ref().unwrap_or(tree);
        let item =
            |&at: &u32| Item { at: WHOLE + at, members: whole.node(at).members, key: whole.node(at).key() };
        let mut items: Vec<Item> = kept.iter().map(item).collect();
        let mut nodes = Vec::with_capacity((2 * items.len()).max(1) - 1);
        match &items[..] {
            [] => return None,
            [only] => {
                let Node { bounds, key, members, kind } = whole.node(only.at - WHOLE);
                let kind = match kind {
                    NodeKind::Split(halves) => NodeKind::Split(halves.map(|h| h + WHOLE)),
                    option => *option,
                };
                nodes.push(Node { bounds: bounds.clone(), key: *key, members: *members, kind });
            }
            _ => {
                grow(&mut items, &mut nodes, &|item| (None, &whole.node(item.at - WHOLE).bounds));
            }
        }
        Some(Arc::new(Self { nodes, whole: Some(Arc::clone(whole)), stands_on: kept.to_vec() }))
    }

    /// About `most` nodes of the base tree that together contain every option below `node` for which `may` is true.
    /// `may` is asked for boxes of options, so the nodes may also contain options for which it is false. The node with
    /// the most options is divided first.
    pub(super) fn kept(&self, node: u32, most: usize, may: impl Fn(&B) -> bool) -> Vec<u32> {
        let mut heap = BinaryHeap::new();
        let mut enter = |at: u32| {
            let node = self.node(at);
            if may(&node.bounds) {
                heap.push((node.members, at));
            }
        };
        match &self.whole {
            // The root contains every node over which the tree is built.
            Some(_) if node == 0 => self.stands_on.iter().for_each(|&at| enter(at + WHOLE)),
            Some(_) => {
                let mut open = vec![node];
                while let Some(at) = open.pop() {
                    match self.children(at) {
                        Some(halves) if at < WHOLE => open.extend(halves),
                        _ => enter(at),
                    }
                }
            }
            None => enter(node),
        }
        while heap.len() < most {
            let Some(&(members, at)) = heap.peek() else { break };
            if members == 1 {
                break;
            }
            heap.pop();
            for half in self.children(at).into_iter().flatten() {
                if may(&self.node(half).bounds) {
                    heap.push((self.node(half).members, half));
                }
            }
        }
        let mut kept: Vec<u32> = heap.into_iter().map(|(_, at)| at & !WHOLE).collect();
        kept.sort_unstable();
        kept
    }

    /// Number of options below the nodes `kept` of the base tree (the tree over all options of the level).
    pub(super) fn members_of(&self, kept: &[u32]) -> f64 {
        let whole = self.whole.as_deref().unwrap_or(self);
        kept.iter().map(|&at| f64::from(whole.node(at).members)).sum()
    }

    /// The options below the nodes `kept` of the base tree (the tree over all options of the level), ascending.
    pub(super) fn options_of(&self, kept: &[u32]) -> Vec<u32> {
        let whole = self.whole.as_deref().unwrap_or(self);
        let (mut options, mut open) = (Vec::new(), kept.to_vec());
        while let Some(at) = open.pop() {
            match whole.node(at).kind {
                NodeKind::Split(halves) => open.extend(halves),
                NodeKind::Option(option) => options.push(option),
            }
        }
        options.sort_unstable();
        options
    }

    /// The leaf (node of a single option) of each option in `wanted`, by the number of the option.
    pub(super) fn leaves_of(&self, wanted: &BTreeSet<u32>) -> HashMap<u32, u32> {
        let nodes = self.nodes.iter().zip(0..);
        nodes
            .filter_map(|(node, at)| match node.kind {
                NodeKind::Option(option) if wanted.contains(&option) => Some((option, at)),
                _ => None,
            })
            .collect()
    }

    /// The node of the base tree with this number.
    pub(super) fn whole_node(&self, index: u32) -> &Node<B> {
        &self.whole.as_deref().unwrap_or(self).nodes[index as usize]
    }

    /// Whether a base tree has a node with this number.
    pub(super) fn has(&self, index: u32) -> bool {
        (index as usize) < self.nodes.len()
    }

    /// The node with this number. The root is node 0.
    #[inline]
    pub(super) fn node(&self, index: u32) -> &Node<B> {
        match &self.whole {
            Some(whole) if index >= WHOLE => &whole.nodes[(index - WHOLE) as usize],
            _ => &self.nodes[index as usize],
        }
    }

    /// The smallest node at or below `node` that contains every option for which `holds` is true. For a box, `holds`
    /// must be true if it is true for any option in the box. `None` if it is false for all options.
    pub(super) fn smallest_node(&self, mut node: u32, holds: impl Fn(&B) -> bool) -> Option<u32> {
        if !holds(&self.node(node).bounds) {
            return None;
        }
        while let Some([a, b]) = self.children(node) {
            node = match (holds(&self.node(a).bounds), holds(&self.node(b).bounds)) {
                (true, true) => return Some(node),
                (true, false) => a,
                (false, true) => b,
                (false, false) => return None,
            };
        }
        Some(node)
    }

    /// The two halves of a node. `None` for a leaf.
    #[inline]
    pub(super) fn children(&self, index: u32) -> Option<[u32; 2]> {
        match self.node(index).kind {
            NodeKind::Split(halves) if index >= WHOLE => Some(halves.map(|half| half + WHOLE)),
            NodeKind::Split(halves) => Some(halves),
            NodeKind::Option(_) => None,
        }
    }

    /// The option of a leaf. `None` for a node of several options.
    #[inline]
    pub(super) fn option(&self, index: u32) -> Option<u32> {
        match self.node(index).kind {
            NodeKind::Split(_) => None,
            NodeKind::Option(option) => Some(option),
        }
    }
}

/// An option, or a node of the base tree, during the construction of a tree. Its bounds are not stored here, so that
/// items are quick to sort.
struct Item {
    /// Index of the option, or number of the node of the base tree.
    at: u32,
    members: u32,
    key: Key,
}

/// Builds the tree over `items`, appends its nodes to `nodes` and returns the number of its root. For an item, `leaf`
/// returns its bounds and the kind of its node; the kind is `None` if the item is a node of the base tree already.
fn grow<'b, B: Bounds + 'b>(
    items: &mut [Item],
    nodes: &mut Vec<Node<B>>,
    leaf: &impl Fn(&Item) -> (Option<NodeKind>, &'b B),
) -> u32 {
    let here = nodes.len();
    let (kind, bounds) = leaf(&items[0]);
    if let [Item { at, members, key }] = *items {
        let Some(kind) = kind else { return at };
        nodes.push(Node { bounds: bounds.clone(), key: Some(key), members, kind });
        return here as u32;
    }
    // The root is the first node, so its place is taken before its halves grow.
    nodes.push(Node { bounds: bounds.clone(), key: None, members: 0, kind: NodeKind::Option(0) });
    // Halving the widest coordinate keeps the boxes narrow, and so their bounds sharp.
    let axis = widest(items);
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| a.key[axis].total_cmp(&b.key[axis]).then(a.at.cmp(&b.at)));
    let (low, high) = items.split_at_mut(middle);
    let halves = [grow(low, nodes, leaf), grow(high, nodes, leaf)];
    // If the node of a half is in the base tree, the half is a single item, and `leaf` returns its bounds.
    let of =
        |half: &[Item], at: u32| nodes.get(at as usize).map_or_else(|| leaf(&half[0]).1, |node| &node.bounds);
    let bounds = of(low, halves[0]).join(of(high, halves[1]));
    // Only nodes of the base tree store keys, because other trees are built over these nodes. For any other node a key
    // would be computed in vain, and its logarithms take time.
    let key = kind.map(|_| bounds.key());
    let members = items.iter().map(|item| item.members).sum();
    nodes[here] = Node { bounds, key, members, kind: NodeKind::Split(halves) };
    here as u32
}

/// Index of the coordinate with the greatest spread over some items.
fn widest(items: &[Item]) -> usize {
    let spread = |axis: usize| {
        let (low, high) = items.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), item| {
            (low.min(item.key[axis]), high.max(item.key[axis]))
        });
        high - low
    };
    let spreads = [0, 1, 2, 3, 4].map(spread);
    (0..spreads.len()).max_by(|&a, &b| spreads[a].total_cmp(&spreads[b]).then(b.cmp(&a))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[derive(Clone)]
    struct Span([f64; 2]);

    impl Bounds for Span {
        fn join(&self, other: &Self) -> Self {
            Span([self.0[0].min(other.0[0]), self.0[1].max(other.0[1])])
        }
        fn key(&self) -> Key {
            [self.0[0], 0.0, 0.0, 0.0, 0.0]
        }
    }

    proptest! {
        #[test]
        fn every_option_is_in_one_leaf_and_inside_every_box_above(
            values in prop::collection::vec(0.0f64..100.0, 1..60)
        ) {
            let options = values.iter().enumerate().map(|(i, &v)| (i as u32, Span([v, v])));
            let tree = Tree::build(options).unwrap();
            let mut seen = vec![0; values.len()];
            let mut stack = vec![(0, vec![0])];
            while let Some((node, path)) = stack.pop() {
                if let Some(option) = tree.option(node) {
                    seen[option as usize] += 1;
                    let value = values[option as usize];
                    for &above in &path {
                        let Span([low, high]) = tree.node(above).bounds;
                        prop_assert!(low <= value && value <= high);
                    }
                }
                for child in tree.children(node).into_iter().flatten() {
                    stack.push((child, [path.clone(), vec![child]].concat()));
                }
            }
            prop_assert!(seen.iter().all(|&n| n == 1));
        }

        #[test]
        fn what_is_kept_of_a_tree_is_what_may_do_and_stands_on_its_own(
            values in prop::collection::vec(0.0f64..100.0, 1..60), limits in prop::collection::vec(0.0f64..100.0, 3),
            most in 1usize..20
        ) {
            let options = values.iter().enumerate().map(|(i, &v)| (i as u32, Span([v, v])));
            let mut tree = Arc::new(Tree::build(options).unwrap());
            let mut least: f64 = 0.0;
            for limit in limits {
                least = least.max(limit);
                let kept = tree.kept(0, most, |span| span.0[1] >= least);
                let Some(narrower) = Tree::over(&tree, &kept) else {
                    prop_assert!(values.iter().all(|v| *v < least));
                    return Ok(());
                };
                prop_assert_eq!(narrower.members_of(&kept), f64::from(narrower.node(0).members));
                let (mut below, mut open) = (Vec::new(), vec![0]);
                while let Some(node) = open.pop() {
                    open.extend(narrower.children(node).into_iter().flatten());
                    below.extend(narrower.option(node));
                }
                below.sort_unstable();
                prop_assert_eq!(&tree.options_of(&kept), &below);
                for (option, value) in values.iter().enumerate().filter(|(_, v)| **v >= least) {
                    let times = below.iter().filter(|o| **o == option as u32).count();
                    prop_assert_eq!(times, 1, "option {} of value {}", option, value);
                }
                tree = narrower;
            }
        }
    }
}
