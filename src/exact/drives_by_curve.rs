//! The feasible drives below a node, grouped by torsion curve and bearing.
//!
//! A joint has hundreds of drives but only some dozens of torsion curves, and gears of one curve mostly have one
//! bearing. The price of a drive is what it adds to a weighted sum of inequalities ([`dual_price`](super::dual_price)).
//! It is the price of the drive's mass plus the prices of its curve and its bearing. Drives of one group differ only in
//! mass. Whatever the prices are, the cheapest drive of a group is therefore its lightest or its heaviest.
//!
//! The parts of a region are priced at dozens of sets of multipliers (the weights of the inequalities). A state of a
//! gear is its torque with its twist and slope. The states that may be the cheapest are the same for all multipliers,
//! so they are collected once ([`PricedDrives`]), and eight groups are priced side by side.

use super::dual_price::{DualPrice, Gear, GearStates, states_of};
use super::joint_play::JointPlay;
use super::parts::{DriveBox, LeastDemand, inertia, stiffness_of};
use super::pose::TILT;
use super::torsion::CurveBox;
use super::tree::Tree;
use crate::mechanics::lanes::{Eight, LANES, LaneWork, Lanes, in_lanes};
use std::sync::Arc;

/// The drives with the same torsion curve and the same bearing: mass \[kg\] and node of the lightest and of the
/// heaviest. `curve` is `None` for a rigid drive.
struct CurveGroup {
    curve: Option<CurveBox>,
    tilt_rad_per_nm: [f64; 2],
    lightest: (f64, u32),
    heaviest: (f64, u32),
}

impl CurveGroup {
    /// Adds a drive, given by its mass \[kg\] and its node. Among equal masses the lower node is taken, so that the
    /// result does not depend on the order of the drives.
    fn add(&mut self, drive: (f64, u32)) {
        if drive < self.lightest {
            self.lightest = drive;
        }
        if drive.0 > self.heaviest.0 || (drive.0 == self.heaviest.0 && drive.1 < self.heaviest.1) {
            self.heaviest = drive;
        }
    }
}

/// The feasible drives below a node of a joint's tree, one group for each torsion curve and bearing.
struct DrivesByCurve(Vec<CurveGroup>);

impl DrivesByCurve {
    /// The drives below a node, grouped by curve and bearing. Drives that cannot carry the least demand `asked` are
    /// left out; `None` keeps all.
    fn new(tree: &Tree<DriveBox>, node: u32, asked: Option<&LeastDemand>) -> Self {
        let mut curves: Vec<CurveGroup> = Vec::new();
        let (mut open, mut last) = (vec![(node, asked)], 0);
        while let Some((at, asked)) = open.pop() {
            let drives = &tree.node(at).bounds;
            if asked.is_some_and(|asked| !drives.may_hold(asked)) {
                continue;
            }
            if let Some(halves) = tree.children(at) {
                // If even the least limits of the node carry the demand, every drive below the node carries it, and
                // none of them is tested.
                let asked = asked.filter(|asked| !drives.least_limits.hold(&asked.demand));
                open.extend(halves.map(|half| (half, asked)));
                continue;
            }
            let drive = (drives.mass_kg[0], at);
            let DriveBox { curve, tilt_rad_per_nm, .. } = *drives;
            // Neighbours in the tree mostly have the same curve, so the last group is tried first.
            let is_of = |at: &usize| {
                curves.get(*at).is_some_and(|of| of.curve == curve && of.tilt_rad_per_nm == tilt_rad_per_nm)
            };
            match Some(last).filter(is_of).or_else(|| (0..curves.len()).find(|at| is_of(at))) {
                Some(place) => {
                    curves[place].add(drive);
                    last = place;
                }
                None => {
                    last = curves.len();
                    curves.push(CurveGroup { curve, tilt_rad_per_nm, lightest: drive, heaviest: drive });
                }
            }
        }
        Self(curves)
    }
}

/// Eight groups of drives ([`CurveGroup`]) that are not rigid, and the states of their gears in each judged case. A
/// judged case counts for deflection and lowest mode.
struct EightGroups {
    /// Mass \[kg\] of the lightest and of the heaviest drive of each group, and their nodes. Places (of eight)
    /// without a group of their own repeat the last group.
    mass_kg: [Eight; 2],
    nodes: [[u32; LANES]; 2],
    tilt_rad_per_nm: [Eight; 2],
    tilt_stiffness: Eight,
    /// For each judged case, the candidate states. A gear with fewer states than another of the eight repeats its first
    /// state.
    states: Vec<Vec<EightStates>>,
    count: usize,
}

/// A candidate state of the gear of each of eight groups of drives ([`CurveGroup`]).
#[derive(Clone, Copy)]
struct EightStates {
    torque_nm: Eight,
    twist_rad: [Eight; 2],
    slope: Eight,
}

impl EightGroups {
    /// Packs at most eight groups of drives that are not rigid. `gears` are the gear of their joint in each judged
    /// case, and `play` is the play of the joint.
    fn new(groups: &[(&CurveGroup, &CurveBox)], gears: &[&Gear], play: Option<&JointPlay>) -> Self {
        let group = |lane: usize| groups[lane.min(groups.len() - 1)].0;
        let lanes =
            |of: &dyn Fn(&CurveGroup) -> f64| -> Eight { std::array::from_fn(|lane| of(group(lane))) };
        let both = |group: &CurveGroup| [group.lightest, group.heaviest];
        Self {
            mass_kg: [0, 1].map(|end| lanes(&|group| both(group)[end].0)),
            nodes: [0, 1].map(|end| std::array::from_fn(|lane| both(group(lane))[end].1)),
            tilt_rad_per_nm: [0, 1].map(|end| lanes(&|group| group.tilt_rad_per_nm[end])),
            tilt_stiffness: lanes(&|group| stiffness_of(group.tilt_rad_per_nm[0])),
            states: gears.iter().map(|gear| EightStates::all(groups, gear.torques_nm, play)).collect(),
            count: groups.len(),
        }
    }
}

impl EightStates {
    /// The candidate states of the curves of at most eight groups of drives, under torques in an interval \[N m\].
    fn all(
        groups: &[(&CurveGroup, &CurveBox)],
        torques_nm: [f64; 2],
        play: Option<&JointPlay>,
    ) -> Vec<EightStates> {
        let mut of_lane: [GearStates; LANES] = Default::default();
        for (lane, states) in of_lane.iter_mut().enumerate() {
            states_of(groups[lane.min(groups.len() - 1)].1, play, torques_nm, states);
        }
        let most = of_lane.iter().map(|states| states.as_slice().len()).max().unwrap_or(0);
        let at = |lane: usize, place: usize| {
            let states = of_lane[lane].as_slice();
            states.get(place).or(states.first()).copied().unwrap_or_default()
        };
        (0..most)
            .map(|place| EightStates {
                torque_nm: std::array::from_fn(|lane| at(lane, place).torque_nm),
                twist_rad: [0, 1].map(|end| std::array::from_fn(|lane| at(lane, place).twist_rad[end])),
                slope: std::array::from_fn(|lane| at(lane, place).slope),
            })
            .collect()
    }
}

/// Computes the least price of a drive in each of eight groups of drives ([`CurveGroup`]).
struct GroupPrices<'a> {
    groups: &'a EightGroups,
    price: &'a DualPrice,
}

impl LaneWork for GroupPrices<'_> {
    type Output = Eight;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Eight {
        let Self { groups, price } = self;
        let mut torsion = V::splat(-0.0);
        for (gear, states) in price.joint.iter().zip(&groups.states) {
            let (twist, torque, slope) = (V::splat(gear.twist), V::splat(gear.torque), V::splat(gear.slope));
            let mut least = V::splat(f64::INFINITY);
            for state in states {
                let [less, more] =
                    [twist * V::load(&state.twist_rad[0]), twist * V::load(&state.twist_rad[1])];
                let of_state = less.min(more) + torque * V::load(&state.torque_nm);
                least = least.min(of_state - slope * V::load(&state.slope));
            }
            torsion = torsion + least;
        }
        let per_kg = price.inertia[inertia::MASS];
        let of_mass = V::splat(per_kg) * V::load(&groups.mass_kg[usize::from(per_kg < 0.0)]);
        let per_tilt = price.compliance[TILT];
        let of_tilt = V::splat(per_tilt) * V::load(&groups.tilt_rad_per_nm[usize::from(per_tilt < 0.0)]);
        let of_tilt = of_tilt - V::splat(price.stiffness[TILT]) * V::load(&groups.tilt_stiffness);
        (of_mass + torsion + of_tilt).store()
    }
}

/// The feasible drives of a level (the drives of one joint), with the states that their gears may have in a region.
pub(super) struct PricedDrives {
    drives: Arc<DrivesByCurve>,
    eights: Vec<EightGroups>,
}

impl PricedDrives {
    /// The feasible drives of a level with the states of their gears. `gears` has the gear of the joint in each judged
    /// case, and `play` is the lost motion and friction of the joint.
    pub(super) fn new(feasible: &FeasibleDrives, gears: &[&Gear], play: Option<&JointPlay>) -> Self {
        let drives = Arc::clone(&feasible.drives);
        let with_curve: Vec<(&CurveGroup, &CurveBox)> =
            drives.0.iter().filter_map(|group| Some((group, group.curve.as_ref()?))).collect();
        let eights = with_curve.chunks(LANES).map(|groups| EightGroups::new(groups, gears, play)).collect();
        Self { eights, drives }
    }

    /// The least price of a drive, and the drive's node in the tree. Among equal prices the lower node is taken. `None`
    /// if no drive is feasible.
    pub(super) fn cheapest(&self, price: &DualPrice) -> Option<(f64, u32)> {
        let end = usize::from(price.of_mass([0.0, 1.0]) < 0.0);
        let in_eights = self.eights.iter().flat_map(|groups| {
            let prices = in_lanes(GroupPrices { groups, price });
            (0..groups.count).map(move |lane| (prices[lane], groups.nodes[end][lane]))
        });
        let rigid = self.drives.0.iter().filter(|group| group.curve.is_none()).map(|group| {
            let (mass_kg, node) = [group.lightest, group.heaviest][end];
            (price.of_joint([mass_kg; 2], None, group.tilt_rad_per_nm), node)
        });
        in_eights.chain(rigid).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
    }
}

/// The feasible drives of a level. They are reused from one box to the next as long as neither the drives nor the
/// demand on them change.
#[derive(Clone)]
pub(super) struct FeasibleDrives {
    tree: Arc<Tree<DriveBox>>,
    node: u32,
    asked: Option<LeastDemand>,
    drives: Arc<DrivesByCurve>,
}

impl FeasibleDrives {
    /// The drives below a node that carry the least demand `asked`. `before` has the drives of the parent box. Their
    /// groups are reused if they were made of the same tree, node and demand.
    pub(super) fn new(
        tree: &Arc<Tree<DriveBox>>,
        node: u32,
        asked: Option<&LeastDemand>,
        before: Option<&Self>,
    ) -> Self {
        let is_same =
            |of: &&Self| Arc::ptr_eq(&of.tree, tree) && of.node == node && of.asked.as_ref() == asked;
        before.filter(is_same).cloned().unwrap_or_else(|| Self {
            tree: Arc::clone(tree),
            node,
            asked: asked.cloned(),
            drives: Arc::new(DrivesByCurve::new(tree, node, asked)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::joint_law::{Curve, JointLaw, Windup};
    use crate::exact::dual_price::JointPrice;
    use crate::exact::parts::Rays;
    use crate::exact::pose::TILT;
    use crate::exact::torsion::BreakPoints;
    use crate::sizing::bearing::{BearingDemand, BearingLimits};
    use crate::sizing::fit::{DriveWidths, LinkRoom};
    use crate::sizing::heat::MotorHeat;
    use crate::sizing::limits::DriveLimits;
    use crate::sizing::requirement::MotionRequirement;
    use proptest::prelude::*;

    fn drive([mass_kg, k1, torque_nm, tilt]: [f64; 4], rays: &Rays) -> DriveBox {
        let windup = Windup {
            k1_nm_per_rad: k1,
            k2_nm_per_rad: 1.5 * k1,
            k3_nm_per_rad: 2.0 * k1,
            t1_nm: 1.0,
            t2_nm: 2.0,
        };
        let limits = DriveLimits {
            static_torque_nm: torque_nm,
            peak_torque_nm: torque_nm,
            stop_torque_nm: torque_nm,
            mean_torque_cubed_nm3: torque_nm.powi(3),
            bearing: BearingLimits::NONE,
            widths: DriveWidths::default(),
            heat: MotorHeat::NONE,
        };
        DriveBox {
            mass_kg: [mass_kg; 2],
            limits,
            least_limits: limits,
            multiples: rays.capacity(&limits),
            curve: CurveBox::of(&JointLaw::from(Curve::Windup(windup))),
            breaks: BreakPoints::of(&windup),
            tilt_rad_per_nm: [tilt; 2],
            each: None,
        }
    }

    proptest! {
        #[test]
        fn no_drive_that_holds_is_cheaper_whatever_the_prices_are(
            drives in prop::collection::vec(prop::array::uniform4(1u32..20), 1..60), asked_nm in 0.0f64..15.0, per_kg in -2.0f64..2.0,
            twist in -2.0f64..2.0, torque in -1.0f64..1.0, slope in 0.0f64..1.0, tilt in prop::array::uniform2(-1.0f64..1.0), from_nm in -3.0f64..3.0, wide_nm in 0.0f64..3.0,
        ) {
            let motion = MotionRequirement::default().joint_motion(1.35, None);
            let rays = Rays::new(&motion, 5.0, 1.0);
            let asked = LeastDemand::new(&motion, &rays, asked_nm, 0.1 * asked_nm, BearingDemand::default(), LinkRoom::ANY);
            let drives: Vec<DriveBox> = drives
                .into_iter()
                .map(|[kg, k, nm, tilt]| drive([kg, k % 5 + 1, nm, tilt % 3 + 1].map(f64::from), &rays))
                .collect();
            let joint = JointPrice { twist, torque, slope, torques_nm: [from_nm, from_nm + wide_nm], play: None };
            let mut price = DualPrice { joint: vec![joint], ..DualPrice::default() };
            price.inertia[0] = per_kg;
            price.compliance[TILT] = tilt[0];
            price.stiffness[TILT] = tilt[1].max(0.0);
            let options = drives.iter().cloned().enumerate().map(|(i, drive)| (i as u32, drive));
            let tree = Tree::build(options).unwrap();
            let cost =
                |drive: &DriveBox| price.of_joint(drive.mass_kg, drive.curve.as_ref(), drive.tilt_rad_per_nm);
            let holding: Vec<&DriveBox> = drives.iter().filter(|drive| drive.hold(&asked.demand)).collect();
            let least = holding.iter().map(|drive| cost(drive)).fold(f64::INFINITY, f64::min);
            let feasible = FeasibleDrives::new(&Arc::new(tree), 0, Some(&asked), None);
            let gear = Gear { piece: 0, judged: 0, torques_nm: [from_nm, from_nm + wide_nm], row: None, least_compliance: 0.0 };
            let found = PricedDrives::new(&feasible, &[&gear], None).cheapest(&price);
            prop_assert_eq!(found.is_none(), holding.is_empty());
            if let Some((found, node)) = found {
                let drive = &drives[feasible.tree.option(node).unwrap() as usize];
                prop_assert!(drive.hold(&asked.demand));
                prop_assert_eq!([found, cost(drive)], [least; 2]);
            }
        }
    }
}
