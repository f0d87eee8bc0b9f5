//! A binary tree over the options of one level, each node a box that holds its members.

/// What a node knows of all its members.
pub(super) trait Bounds: Clone {
    /// The box around two boxes.
    fn join(&self, other: &Self) -> Self;

    /// Coordinates by which options are told apart, scaled so that a larger spread matters more.
    fn key(&self) -> Vec<f64>;
}

/// Nodes in preorder: the first child of a node follows it.
pub(super) struct Tree<B> {
    nodes: Vec<Node<B>>,
}

/// One node of a [`Tree`].
pub(super) struct Node<B> {
    pub bounds: B,
    /// Options below it.
    pub members: u32,
    /// The second child of a box of several, or the option of a box of one.
    pub kind: NodeKind,
}

/// What is below a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NodeKind {
    /// Two boxes: the next node, and this one.
    Split { second: u32 },
    /// One option.
    Option(u32),
}

impl<B: Bounds> Tree<B> {
    /// Halves the options at the median of the coordinate with the largest spread, down to single ones.
    /// `None` without options.
    pub fn build(options: impl Iterator<Item = (u32, B)>) -> Option<Self> {
        let mut items: Vec<Item<B>> =
            options.map(|(option, bounds)| Item { option, key: bounds.key(), bounds }).collect();
        if items.is_empty() {
            return None;
        }
        let mut nodes = Vec::with_capacity(2 * items.len() - 1);
        grow(&mut items, &mut nodes);
        Some(Self { nodes })
    }

    /// A node; the root is node 0.
    #[inline]
    pub fn node(&self, index: u32) -> &Node<B> {
        &self.nodes[index as usize]
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
            NodeKind::Split { second } => Some([index + 1, second]),
            NodeKind::Option(_) => None,
        }
    }

    /// The option of a box of one.
    #[inline]
    pub fn option(&self, index: u32) -> Option<u32> {
        match self.node(index).kind {
            NodeKind::Split { .. } => None,
            NodeKind::Option(option) => Some(option),
        }
    }
}

struct Item<B> {
    option: u32,
    key: Vec<f64>,
    bounds: B,
}

fn grow<B: Bounds>(items: &mut [Item<B>], nodes: &mut Vec<Node<B>>) -> B {
    if let [only] = items {
        nodes.push(Node { bounds: only.bounds.clone(), members: 1, kind: NodeKind::Option(only.option) });
        return only.bounds.clone();
    }
    let here = nodes.len();
    let members = items.len() as u32;
    nodes.push(Node { bounds: items[0].bounds.clone(), members, kind: NodeKind::Split { second: 0 } });
    let axis = widest(items);
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        a.key[axis].total_cmp(&b.key[axis]).then(a.option.cmp(&b.option))
    });
    let (low, high) = items.split_at_mut(middle);
    let first = grow(low, nodes);
    let second = nodes.len() as u32;
    let bounds = first.join(&grow(high, nodes));
    nodes[here] = Node { bounds: bounds.clone(), members, kind: NodeKind::Split { second } };
    bounds
}

/// The coordinate with the largest spread.
fn widest<B>(items: &[Item<B>]) -> usize {
    let spread = |axis: usize| {
        let (low, high) = items.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), item| {
            (low.min(item.key[axis]), high.max(item.key[axis]))
        });
        high - low
    };
    let spreads: Vec<f64> = (0..items[0].key.len()).map(spread).collect();
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
        fn key(&self) -> Vec<f64> {
            vec![self.0[0]]
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
    }
}
