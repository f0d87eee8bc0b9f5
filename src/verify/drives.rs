//! The drives that a joint may have in a box or a region, and the tree that halves them.

use super::demand::{Demand, Quantity};
use super::drive_range::DriveRange;
use super::duty::Duty;
use super::offers::{CatalogOffers, JointOffers};
use super::parts_box::Choice;
use super::ratings::Ratings;
use super::tree::Tree;

/// In sets of no more drives than this, every drive is compared with the demand.
const FEW: usize = 64;

/// The drives that a joint may have.
pub(super) struct DriveOptions {
    /// Index among the levels of the space; `None` if the drive is no choice.
    pub level: Option<usize>,
    /// The motion of the joint; `None` for a given drive, which is not checked.
    pub duty: Option<Duty>,
    /// The drives, lightest first.
    pub options: Vec<DriveOption>,
}

/// A drive, or several drives of equal mass, torsion curve and tilt of the bearing.
#[derive(Debug, Clone)]
pub(super) struct DriveOption {
    pub range: DriveRange,
    /// Number of each drive, and the torques that the drive holds.
    pub drives: Vec<(u32, Ratings)>,
}

/// Whether drives of equal mass, torsion curve and tilt, which no objective tells apart, are one option.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ties {
    Apart,
    Together,
}

/// The drives that a joint may have, in a tree whose nodes are halved down to single options.
pub(super) struct Drives {
    pub level: Option<usize>,
    pub duty: Option<Duty>,
    pub tree: Tree,
    /// For each node of the tree, range and greatest ratings of its drives.
    nodes: Vec<(DriveRange, Ratings)>,
    options: Vec<DriveOption>,
}

impl DriveOptions {
    /// All drives of a joint. `level` is used only if the drive is a choice.
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

    /// Some of the options, given by ascending indices.
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

    /// Whether at least one drive of the option holds a demand.
    pub(super) fn holds(&self, asked: &Demand) -> bool {
        self.drives.iter().any(|(_, ratings)| ratings.hold(asked))
    }

    /// The drives of the option that may hold a demand that lies between two, and whether the first of them surely
    /// holds.
    pub(super) fn holding(&self, [least, most]: &[Demand; 2]) -> Choice {
        let may = self.drives.iter().filter(|(_, ratings)| ratings.hold(least));
        let (mut drives, unsure): (Vec<&(u32, Ratings)>, Vec<_>) =
            may.partition(|(_, ratings)| ratings.hold(most));
        let one_holds = !drives.is_empty();
        drives.extend(unsure);
        Choice { options: drives.into_iter().map(|&(number, _)| number).collect(), one_holds }
    }

    /// The greatest rating of the option's drives for each quantity.
    fn ratings(&self) -> Ratings {
        let (first, rest) = self.drives.split_first().expect("an option has a drive");
        rest.iter().fold(first.1, |ratings, (_, other)| ratings.max(other))
    }
}

impl Drives {
    /// Builds the tree of the options.
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

    /// The options of a node.
    pub(super) fn options(&self, node: u32) -> impl Iterator<Item = &DriveOption> {
        self.tree.options(node).iter().map(|&i| &self.options[i as usize])
    }

    /// Range of a node's drives that may hold a demand of at least `asked`; `None` if there is none.
    pub(super) fn holding(&self, node: u32, asked: &Demand) -> Option<DriveRange> {
        if self.tree.options(node).len() > FEW {
            let (range, ratings) = &self.nodes[node as usize];
            return ratings.hold(asked).then_some(*range);
        }
        let holding = self.options(node).filter(|option| option.holds(asked));
        holding.map(|option| option.range).reduce(|a, b| a.with(&b))
    }

    /// Range of the drives that may be the lightest to hold a demand that lies between two. `None` if no drive holds
    /// the least.
    pub(super) fn first_fits(&self, least: &Demand, most: &Demand) -> Option<DriveRange> {
        let fits = first_fits(self.options.iter().map(|option| ((), option)), least, most);
        fits.map(|(_, option)| option.range).reduce(|a, b| a.with(&b))
    }

    /// Range of all drives of a node.
    pub(super) fn range(&self, node: u32) -> &DriveRange {
        &self.nodes[node as usize].0
    }

    /// Whether there is no drive at all.
    pub(super) fn is_empty(&self) -> bool {
        self.options.is_empty()
    }
}

/// The drives that may be the lightest to hold a demand that lies between two. These are all drives that hold the
/// least demand, up to the first that holds the greatest.
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

/// The numbers by which the tree separates drives.
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
