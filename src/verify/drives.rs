//! The drives that a joint may have in a box or a region, and the binary tree over them.

use super::demand::{Demand, Quantity};
use super::drive_range::DriveRange;
use super::duty::Duty;
use super::offers::{CatalogOffers, JointOffers};
use super::parts_box::Choice;
use super::ratings::Ratings;
use super::tree::Tree;

/// For sets of at most this many drives, every drive is compared with the demand. In larger sets only the greatest
/// ratings of the whole set are compared.
const SMALL_SET: usize = 64;

/// The drives that a joint may have, as a list.
pub(super) struct DriveOptions {
    /// Index of the joint's choice among the levels (choices) of the space; `None` if the search does not choose the
    /// drive.
    pub level: Option<usize>,
    /// The motion of the joint; `None` for a given drive, on which nothing is checked.
    pub duty: Option<Duty>,
    /// The options, lightest first.
    pub options: Vec<DriveOption>,
}

/// One option: a drive, or several drives of equal mass, torsion curve and bearing stiffness.
#[derive(Debug, Clone)]
pub(super) struct DriveOption {
    pub range: DriveRange,
    /// The drives of the option, each with its index among the joint's drives and its ratings.
    pub drives: Vec<(u32, Ratings)>,
}

/// How drives of equal mass, torsion curve and bearing stiffness are treated. No objective tells them apart. `Apart`
/// makes one option of each drive, `Together` one option of all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ties {
    Apart,
    Together,
}

/// The drives that a joint may have, as a binary tree. Branching halves its nodes down to single options.
pub(super) struct Drives {
    pub level: Option<usize>,
    pub duty: Option<Duty>,
    pub tree: Tree,
    /// For each node of the tree: the least and greatest numbers of the drives below it, and the greatest of their
    /// ratings.
    nodes: Vec<(DriveRange, Ratings)>,
    options: Vec<DriveOption>,
}

impl DriveOptions {
    /// All drives that a joint may have, as the catalogs offer them. `level` is the index of the joint's choice among
    /// the levels; it is stored only if the search chooses the drive. `ties` tells whether drives that no objective
    /// tells apart are one option.
    pub(super) fn new(offers: &JointOffers, level: usize, ties: Ties) -> Self {
        let offers = match offers {
            JointOffers::Given { law, tilt_rad_per_nm, mass_kg } => {
                let drives = vec![(0, Ratings::UNLIMITED)];
                let range = DriveRange::of(law, *tilt_rad_per_nm, *mass_kg);
                return Self { level: None, duty: None, options: vec![DriveOption { range, drives }] };
            }
            JointOffers::Catalog(offers) => offers,
        };
        let one_each = |places: Vec<u32>| places.into_iter().map(|place| vec![place]).collect();
        let sets: Vec<Vec<u32>> = match (offers.is_choice, ties) {
            (true, Ties::Together) => offers.ties(),
            (true, Ties::Apart) => one_each((0..offers.offers.len() as u32).collect()),
            (false, _) => one_each(offers.first_fits()),
        };
        let options = sets.iter().map(|set| DriveOption::of_ties(offers, set)).collect();
        Self { level: offers.is_choice.then_some(level), duty: Some(offers.duty.clone()), options }
    }

    /// A list of some of the options of this list. `some` has the indices of these options in ascending order.
    pub(super) fn only(&self, some: &[u32]) -> Self {
        let options = some.iter().map(|&i| self.options[i as usize].clone()).collect();
        Self { level: self.level, duty: self.duty.clone(), options }
    }
}

impl DriveOption {
    fn of_ties(CatalogOffers { offers, .. }: &CatalogOffers, set: &[u32]) -> Self {
        let first = &offers[set[0] as usize];
        Self {
            range: first.range(),
            drives: set.iter().map(|&place| (place, offers[place as usize].ratings)).collect(),
        }
    }

    /// Whether at least one drive of the option meets the demand `asked`.
    pub(super) fn holds(&self, asked: &Demand) -> bool {
        self.drives.iter().any(|(_, ratings)| ratings.hold(asked))
    }

    /// The drives of the option that may meet a demand of which only a least and a greatest value are known. Drives
    /// that meet even the greatest come first; the flag of the choice tells whether there is such a drive.
    pub(super) fn holding(&self, [least, most]: &[Demand; 2]) -> Choice {
        let may = self.drives.iter().filter(|(_, ratings)| ratings.hold(least));
        let (mut drives, unsure): (Vec<&(u32, Ratings)>, Vec<_>) =
            may.partition(|(_, ratings)| ratings.hold(most));
        let one_holds = !drives.is_empty();
        drives.extend(unsure);
        Choice { options: drives.into_iter().map(|&(number, _)| number).collect(), one_holds }
    }

    /// For each quantity, the greatest rating of any drive of the option.
    fn ratings(&self) -> Ratings {
        let (first, rest) = self.drives.split_first().expect("an option has a drive");
        rest.iter().fold(first.1, |ratings, (_, other)| ratings.max(other))
    }
}

impl Drives {
    /// Builds the tree over the options, and computes the least and greatest numbers of each node's drives.
    pub(super) fn new(DriveOptions { level, duty, options }: DriveOptions) -> Self {
        let all: Vec<u32> = (0..options.len() as u32).collect();
        let tree = Tree::new(all, &options.iter().map(keys).collect::<Vec<_>>());
        let nodes = (0..tree.len() as u32)
            .filter_map(|node| {
                let members = tree.options(node).iter().map(|&i| &options[i as usize]);
                let members = members.map(|option| (option.range, option.ratings()));
                members.reduce(|(a, ratings), (b, other)| (a.with(&b), ratings.max(&other)))
            })
            .collect();
        Self { level, duty, tree, nodes, options }
    }

    /// The options below a node of the tree.
    pub(super) fn options(&self, node: u32) -> impl Iterator<Item = &DriveOption> {
        self.tree.options(node).iter().map(|&i| &self.options[i as usize])
    }

    /// Least and greatest numbers of the drives below `node` that may meet a demand of at least `asked`. `None` if no
    /// drive can.
    pub(super) fn holding(&self, node: u32, asked: &Demand) -> Option<DriveRange> {
        if self.tree.options(node).len() > SMALL_SET {
            let (range, ratings) = &self.nodes[node as usize];
            return ratings.hold(asked).then_some(*range);
        }
        let holding = self.options(node).filter(|option| option.holds(asked));
        holding.map(|option| option.range).reduce(|a, b| a.with(&b))
    }

    /// Least and greatest numbers of the drives that may be the lightest to meet a demand. The demand lies between
    /// `least` and `most`. `None` if no drive meets the least demand.
    pub(super) fn first_fits(&self, least: &Demand, most: &Demand) -> Option<DriveRange> {
        let fits = first_fits(self.options.iter().map(|option| ((), option)), least, most);
        fits.map(|(_, option)| option.range).reduce(|a, b| a.with(&b))
    }

    /// Least and greatest numbers of all drives below a node of the tree.
    pub(super) fn range(&self, node: u32) -> &DriveRange {
        &self.nodes[node as usize].0
    }

    /// Whether the joint has no option at all.
    pub(super) fn is_empty(&self) -> bool {
        self.options.is_empty()
    }
}

/// The drives that may be the lightest to meet a demand that lies between `least` and `most`. These are all drives
/// that meet the least demand, up to the first drive that also meets the greatest demand.
pub(super) fn first_fits<'o, T>(
    options: impl Iterator<Item = (T, &'o DriveOption)>,
    least: &Demand,
    most: &Demand,
) -> impl Iterator<Item = (T, &'o DriveOption)> {
    let (least, most) = (*least, *most);
    let fit = move |fitted: &mut bool, (what, option): (T, &'o DriveOption)| {
        let goes_on = !*fitted;
        *fitted |= option.holds(&most);
        goes_on.then_some((what, option))
    };
    options.scan(false, fit).filter(move |(_, option)| option.holds(&least))
}

/// The coordinates by which the tree puts similar drives together, each multiplied by a weight. Any weights give a
/// valid proof; good weights make the bounds tight.
fn keys(option: &DriveOption) -> Vec<f64> {
    let (drive, ratings) = (&option.range, option.ratings());
    let stiff = &drive.stiff;
    vec![
        libm::log(drive.least_kg),
        0.5 * libm::log(stiff.k1_nm_per_rad),
        0.5 * libm::log(stiff.k3_nm_per_rad),
        0.2 * libm::log(stiff.t1_nm),
        0.3 * libm::log(drive.greatest_tilt_stiffness()),
        0.2 * libm::log(ratings.on(Quantity::Peak)),
        0.2 * libm::log(ratings.on(Quantity::Static)),
    ]
}
