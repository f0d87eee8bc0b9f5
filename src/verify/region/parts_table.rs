//! All parts of a space, as lists of numbers that can have prices. The price of a number is what each unit of it adds
//! to a weighted sum of inequalities ([`rows`](super::rows)).
//!
//! The list of a tube has its mass; for each of the study's surroundings its weight and its inertias per length;
//! its stiffnesses and its compliances. The tubes of a link are in a tree whose nodes store the least and the
//! greatest of every number. A drive has a mass, a torsion curve and the tilt compliance of its bearing. Many
//! drives share one curve and one bearing, whose price is then computed only once.

use super::super::drive_range::DriveRange;
use super::super::drives::DriveOptions;
use super::super::skeleton::Parts;
use super::super::tree::Tree;
use super::super::tubes::{
    DENSITIES, STIFFNESSES, STRESSES, TubeAround, TubeNumbers, TubeOptions, TubeRange,
};
use rayon::prelude::*;

/// All parts of a space, as lists of numbers.
pub(super) struct PartsTable {
    pub joints: Vec<JointTable>,
    pub tubes: Vec<TubeTable>,
}

/// The numbers of each torsion curve that the drives of a joint have. The numbers are, in this order: the twist in
/// every judged case (a case that counts for deflection and lowest mode), the slope in every judged case, and
/// compliance and stiffness of the output bearing that goes with the curve. `None` for a curve that no drive of the
/// subproblem has.
pub(super) type Numbers = Vec<Option<Vec<f64>>>;

/// The drives that a joint may have, each with the index of its torsion curve and bearing.
pub(super) struct JointTable {
    pub drives: DriveOptions,
    pub masses_kg: Vec<f64>,
    /// For each drive, the index of its torsion curve in `curves`.
    pub curve: Vec<u32>,
    /// The distinct torsion curves, each together with a bearing. An entry has the numbers of the first drive with this
    /// curve and this bearing.
    pub curves: Vec<DriveRange>,
}

/// The tubes that a link may have.
pub(super) struct TubeTable {
    pub options: TubeOptions,
    pub tree: Tree,
    /// For each node of the tree, the least value of every number over the node's tubes, then the greatest value of
    /// every number.
    bounds: Vec<f64>,
    width: usize,
    priced: usize,
}

/// Number of entries in a tube's list that have no price and are not stresses: whether the tube is round, half its
/// width, and the largest widths of gear and motor.
const BESIDE_STRESSES: usize = 5;

/// Positions of a tube's numbers in its list.
pub(super) mod place {
    use crate::verify::tubes::{DENSITIES, STIFFNESSES};
    pub(crate) const MASS: usize = 0;
    const AROUND: usize = 1 + DENSITIES;

    pub(crate) fn weight(water: usize) -> usize {
        1 + water * AROUND
    }

    pub(crate) fn density(water: usize, which: usize) -> usize {
        2 + water * AROUND + which
    }

    pub(crate) fn stiffness(waters: usize, which: usize) -> usize {
        1 + waters * AROUND + which
    }

    pub(crate) fn compliance(waters: usize, which: usize) -> usize {
        stiffness(waters, STIFFNESSES + which)
    }

    /// Number of leading entries in a tube's list that can have a price. The entries after them (stresses,
    /// roundness, half width, widths of gear and motor) never have one.
    pub(crate) fn priced(waters: usize) -> usize {
        stiffness(waters, 2 * STIFFNESSES)
    }
}

impl PartsTable {
    pub(super) fn new(parts: Parts) -> Self {
        Self {
            joints: parts.joints.into_iter().map(JointTable::new).collect(),
            tubes: parts.tubes.into_par_iter().map(TubeTable::new).collect(),
        }
    }
}

impl JointTable {
    fn new(drives: DriveOptions) -> Self {
        let mut curves: Vec<DriveRange> = Vec::new();
        let compliances = |a: &DriveRange| (a.stiff, a.soft, a.modal_nm_per_rad, a.tilt_rad_per_nm);
        let curve = |range: &DriveRange| {
            let known = curves.iter().position(|known| compliances(known) == compliances(range));
            known.unwrap_or_else(|| {
                curves.push(*range);
                curves.len() - 1
            }) as u32
        };
        let curve = drives.options.iter().map(|option| &option.range).map(curve).collect();
        let masses_kg = drives.options.iter().map(|option| option.range.least_kg).collect();
        Self { drives, masses_kg, curve, curves }
    }
}

impl JointTable {
    /// The numbers of the drive with this index, as a range that contains this drive alone.
    pub(super) fn range(&self, drive: u32) -> &DriveRange {
        &self.drives.options[drive as usize].range
    }
}

impl TubeTable {
    fn new(options: TubeOptions) -> Self {
        let tree = options.tree();
        let waters = options.tubes.first().map_or(0, |(_, tube)| tube.around.len());
        let priced = place::priced(waters);
        let width = priced + STRESSES + BESIDE_STRESSES;
        let mut bounds = vec![0.0; 2 * width * tree.len()];
        // The halves of a node have higher indices than the node. The loop goes backward, so they are computed before
        // it.
        for node in (0..tree.len() as u32).rev() {
            let at = 2 * width * node as usize;
            match tree.halves(node) {
                None => {
                    let numbers = numbers(&options.tubes[tree.options(node)[0] as usize].1);
                    bounds[at..at + width].copy_from_slice(&numbers);
                    bounds[at + width..at + 2 * width].copy_from_slice(&numbers);
                }
                Some(halves) => {
                    let [a, b] = halves.map(|half| 2 * width * half as usize);
                    for i in 0..2 * width {
                        let (x, y) = (bounds[a + i], bounds[b + i]);
                        bounds[at + i] = if i < width { x.min(y) } else { x.max(y) };
                    }
                }
            }
        }
        Self { options, tree, bounds, width, priced }
    }

    /// The least and the greatest value of every number that may have a price, over the tubes below the node `node`.
    pub(super) fn bounds(&self, node: u32) -> [&[f64]; 2] {
        self.all_bounds(node).map(|bounds| &bounds[..self.priced])
    }

    fn all_bounds(&self, node: u32) -> [&[f64]; 2] {
        let at = 2 * self.width * node as usize;
        let both = &self.bounds[at..at + 2 * self.width];
        [&both[..self.width], &both[self.width..]]
    }

    /// Number of leading entries in a tube's list that can have a price.
    pub(super) fn priced(&self) -> usize {
        self.priced
    }

    /// Least and greatest numbers of the tubes below the nodes `nodes` of the tree.
    pub(super) fn range(&self, nodes: &[u32]) -> TubeRange {
        let [mut least, mut most] = self.all_bounds(nodes[0]).map(<[f64]>::to_vec);
        for &node in nodes {
            let [low, high] = self.all_bounds(node);
            least.iter_mut().zip(low).for_each(|(a, b)| *a = a.min(*b));
            most.iter_mut().zip(high).for_each(|(a, b)| *a = a.max(*b));
        }
        let [least, most] = [least, most].map(|numbers| tube(&numbers));
        TubeRange { middle: least.clone(), least, most }
    }

    /// The tubes below the nodes `nodes` of the tree, as a list of options.
    pub(super) fn only(&self, nodes: &[u32]) -> TubeOptions {
        let mut options: Vec<u32> = nodes.iter().flat_map(|&node| self.tree.options(node)).copied().collect();
        options.sort_unstable();
        self.options.only(&options)
    }

    /// Number of tubes below the nodes `nodes` of the tree.
    pub(super) fn count(&self, nodes: &[u32]) -> usize {
        nodes.iter().map(|&node| self.tree.options(node).len()).sum()
    }
}

fn numbers(tube: &TubeNumbers) -> Vec<f64> {
    // A rigid tube has stiffness and compliance zero here, so that neither ever contributes to a price.
    let stiffness = |k: &f64| if k.is_finite() { *k } else { 0.0 };
    let mut numbers = vec![tube.mass_kg];
    for around in &tube.around {
        numbers.push(around.weight_n_per_m);
        numbers.extend(around.densities);
    }
    numbers.extend(tube.stiffnesses.iter().map(stiffness));
    numbers.extend(tube.stiffnesses.iter().map(|k| 1.0 / k));
    numbers.extend(tube.stresses);
    numbers.extend([tube.round, tube.half_width_m]);
    numbers.extend(tube.room);
    numbers
}

fn tube(numbers: &[f64]) -> TubeNumbers {
    let waters = (numbers.len() - 1 - 2 * STIFFNESSES - STRESSES - BESIDE_STRESSES) / (1 + DENSITIES);
    let stiffness = |k: f64| if k > 0.0 { k } else { f64::INFINITY };
    let around = |water: usize| TubeAround {
        weight_n_per_m: numbers[place::weight(water)],
        densities: std::array::from_fn(|i| numbers[place::density(water, i)]),
    };
    let rest = &numbers[place::priced(waters)..];
    TubeNumbers {
        mass_kg: numbers[place::MASS],
        stiffnesses: std::array::from_fn(|i| stiffness(numbers[place::stiffness(waters, i)])),
        stresses: std::array::from_fn(|i| rest[i]),
        round: rest[STRESSES],
        half_width_m: rest[STRESSES + 1],
        room: std::array::from_fn(|i| rest[STRESSES + 2 + i]),
        around: (0..waters).map(around).collect(),
    }
}
