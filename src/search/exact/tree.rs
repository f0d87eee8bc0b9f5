//! A binary tree over the options of one level, each node a box that holds its members.

use std::collections::BinaryHeap;
use std::sync::Arc;

/// What a node knows of all its members.
pub(super) trait Bounds: Clone {
    /// The box around two boxes.
    fn join(&self, other: &Self) -> Self;

    /// Coordinates by which options are told apart, scaled so that a larger spread matters more.
    fn key(&self) -> Key;
}

/// Coordinates of an option.
pub(super) type Key = [f64; 5];

/// The whole tree of a level, or one over some of its nodes.
pub(super) struct Tree<B> {
    nodes: Vec<Node<B>>,
    /// The tree whose nodes it stands on; they count from [`WHOLE`].
    whole: Option<Arc<Tree<B>>>,
    /// The nodes that it stands on.
    stands_on: Vec<u32>,
}

/// The number of the first node of the tree that another stands on.
const WHOLE: u32 = 1 << 31;

/// One node of a [`Tree`].
pub(super) struct Node<B> {
    pub bounds: B,
    /// Where it is among others.
    pub key: Key,
    /// Options below it.
    pub members: u32,
    /// The two halves of a box of several, or the option of a box of one.
    pub kind: NodeKind,
}

/// What is below a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NodeKind {
    /// Two boxes.
    Split([u32; 2]),
    /// One option.
    Option(u32),
}

impl<B: Bounds> Tree<B> {
    /// Halves the options at the median of the coordinate with the largest spread, down to single ones.
    /// `None` without options.
    pub fn build(options: impl Iterator<Item = (u32, B)>) -> Option<Self> {
        let mut items: Vec<Item<B>> =
            options.map(|(option, bounds)| Item { option, members: 1, key: bounds.key(), bounds }).collect();
        if items.is_empty() {
            return None;
        }
        let mut nodes = Vec::with_capacity(2 * items.len() - 1);
        grow(&mut items, &mut nodes, &|item| Some(NodeKind::Option(item.option)));
        Some(Self { nodes, whole: None, stands_on: vec![0] })
    }

    /// A tree over some nodes of a tree, none of which is below another.
    pub fn over(tree: &Arc<Self>, kept: &[u32]) -> Option<Arc<Self>> {
        if tree.whole.is_some() && tree.stands_on == kept {
            return Some(Arc::clone(tree));
        }
        let whole = tree.whole.as_ref().unwrap_or(tree);
        let mut items: Vec<Item<B>> = kept
            .iter()
            .map(|&at| {
                let node = whole.node(at);
                Item { option: WHOLE + at, members: node.members, key: node.key, bounds: node.bounds.clone() }
            })
            .collect();
        if items.is_empty() {
            return None;
        }
        let mut nodes = Vec::with_capacity(2 * items.len() - 1);
        if let [only] = &items[..] {
            let at = whole.node(only.option - WHOLE);
            let kind = match at.kind {
                NodeKind::Split(halves) => NodeKind::Split(halves.map(|h| h + WHOLE)),
                option => option,
            };
            nodes.push(Node { bounds: at.bounds.clone(), key: at.key, members: at.members, kind });
        } else {
            grow(&mut items, &mut nodes, &|_| None);
        }
        Some(Arc::new(Self { nodes, whole: Some(Arc::clone(whole)), stands_on: kept.to_vec() }))
    }

    /// Nodes of the whole tree that may do below a node, in about so many boxes: the largest are opened first.
    pub fn kept(&self, node: u32, most: usize, may: impl Fn(&B) -> bool) -> Vec<u32> {
        let mut heap = BinaryHeap::new();
        let mut enter = |at: u32| {
            let node = self.node(at);
            if may(&node.bounds) {
                heap.push((node.members, at));
            }
        };
        match &self.whole {
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

    /// Options below some nodes of the whole tree.
    pub fn members_of(&self, kept: &[u32]) -> f64 {
        let whole = self.whole.as_deref().unwrap_or(self);
        kept.iter().map(|&at| f64::from(whole.node(at).members)).sum()
    }

    /// Numbers of the options below some nodes of the whole tree, ascending.
    pub fn options_of(&self, kept: &[u32]) -> Vec<u32> {
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

    /// A node of the whole tree.
    pub fn whole_node(&self, index: u32) -> &Node<B> {
        &self.whole.as_deref().unwrap_or(self).nodes[index as usize]
    }

    /// A node; the root is node 0.
    #[inline]
    pub fn node(&self, index: u32) -> &Node<B> {
        match &self.whole {
            Some(whole) if index >= WHOLE => &whole.nodes[(index - WHOLE) as usize],
            _ => &self.nodes[index as usize],
        }
    }

    /// The smallest box with all the options below a node that may hold; `None` if there are none.
    pub fn narrowed(&self, mut node: u32, holds: impl Fn(&B) -> bool) -> Option<u32> {
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

    /// The children of a node.
    #[inline]
    pub fn children(&self, index: u32) -> Option<[u32; 2]> {
        match self.node(index).kind {
            NodeKind::Split(halves) if index >= WHOLE => Some(halves.map(|half| half + WHOLE)),
            NodeKind::Split(halves) => Some(halves),
            NodeKind::Option(_) => None,
        }
    }

    /// The option of a box of one.
    #[inline]
    pub fn option(&self, index: u32) -> Option<u32> {
        match self.node(index).kind {
            NodeKind::Split(_) => None,
            NodeKind::Option(option) => Some(option),
        }
    }
}

struct Item<B> {
    /// The option, or the node that it stands for.
    option: u32,
    members: u32,
    key: Key,
    bounds: B,
}

/// Grows the tree over some items and returns its root; `leaf` says what a node of one item is, unless it has a node
/// already.
fn grow<B: Bounds>(
    items: &mut [Item<B>],
    nodes: &mut Vec<Node<B>>,
    leaf: &impl Fn(&Item<B>) -> Option<NodeKind>,
) -> (u32, B) {
    if let [only] = items {
        let Some(kind) = leaf(only) else { return (only.option, only.bounds.clone()) };
        nodes.push(Node { bounds: only.bounds.clone(), key: only.key, members: 1, kind });
        return (nodes.len() as u32 - 1, only.bounds.clone());
    }
    let here = nodes.len();
    let members = items.iter().map(|item| item.members).sum();
    nodes.push(Node {
        bounds: items[0].bounds.clone(),
        key: items[0].key,
        members,
        kind: NodeKind::Option(0),
    });
    let axis = widest(items);
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        a.key[axis].total_cmp(&b.key[axis]).then(a.option.cmp(&b.option))
    });
    let (low, high) = items.split_at_mut(middle);
    let (first, a) = grow(low, nodes, leaf);
    let (second, b) = grow(high, nodes, leaf);
    let bounds = a.join(&b);
    let key = bounds.key();
    nodes[here] = Node { bounds: bounds.clone(), key, members, kind: NodeKind::Split([first, second]) };
    (here as u32, bounds)
}

/// The coordinate with the largest spread.
fn widest<B>(items: &[Item<B>]) -> usize {
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
