//! Reduced-cost fixing: it removes the options that no member below a local upper bound can have.
//!
//! A member is a design of the box that is searched. It is below a local upper bound if its mass and deflection are
//! less and its mode is higher. Every such member satisfies some inequalities ([`rows`](super::rows)). Multipliers are
//! weights of these inequalities. The price of a part is what it adds to their weighted sum.
//!
//! At a dual point (a set of multipliers), let every other part be the cheapest one. The weighted limits then allow a
//! greatest price for the remaining part. An option with a higher price belongs to no member below the local upper
//! bound. A box of options is compared with eight dual points at a time.

use super::dual_price::{DualPrice, GearStates, JointPrice};
use super::local_upper_bounds::LocalUpperBound;
use super::parts::{DriveBox, INERTIAS, LinkBox, STIFFNESSES, inertia, stiffness_of};
use super::pose::TILT;
use super::problem::Part;
use super::rows::{DualPoint, ROUNDING, Rows};
use crate::mechanics::lanes::{Eight, LANES, LaneWork, Lanes, in_lanes};

/// Approximate number of tree nodes by which the remaining options of a level are described.
const NODES_PER_LEVEL: usize = 256;
/// Number of dual points (sets of multipliers) that are used to exclude options. The points are taken whose least
/// weighted sum comes nearest to the sum that the local upper bound allows.
const DUAL_POINTS_USED: usize = 32;

/// The dual prices of a level at one dual point, and the greatest price at which an option of the level may still
/// belong to a member below the local upper bound.
type PricedLimit = (DualPrice, f64);

impl Rows<'_> {
    /// The options that remain in each level after reduced-cost fixing, as nodes of its base tree (the tree over all
    /// options). `points` are the dual points by which options are excluded that no member below `upper` can have.
    /// `None` if a level has no option left.
    pub(super) fn affordable_options(
        &self,
        design_box: &[u32],
        points: &[DualPoint],
        upper: &LocalUpperBound,
    ) -> Option<Vec<Vec<u32>>> {
        let mut strict: Vec<(f64, Vec<f64>, &DualPoint)> = points
            .iter()
            .map(|point| {
                let room = self.allowed_sum(point, upper) - point.least + ROUNDING;
                // The dual points have no multipliers for mode rows that were added after them.
                let mut multipliers = point.multipliers.clone();
                multipliers.resize(self.scale.len(), 0.0);
                (room, multipliers, point)
            })
            .collect();
        // The dual points that allow the lowest prices exclude most options. After some dozens of dual points, a
        // further one hardly excludes enough options to save the time that it takes.
        strict.sort_by(|a, b| a.0.total_cmp(&b.0));
        strict.truncate(DUAL_POINTS_USED);
        let levels = self.problem.level_pieces.iter().enumerate();
        levels
            .map(|(level, &piece)| {
                let afforded: Vec<PricedLimit> = strict
                    .iter()
                    .map(|(room, multipliers, point)| {
                        (self.price(piece, multipliers, point.lambda), point.levels[level] + room)
                    })
                    .collect();
                let kept = self.affordable(piece, design_box[level], &afforded);
                (!kept.is_empty()).then_some(kept)
            })
            .collect()
    }

    /// Nodes of a level's base tree (the tree over all options) below `node`. They contain every option that no dual
    /// point excludes. `afforded` has, for each dual point, the prices of the level and the greatest price that an
    /// option may have.
    fn affordable(&self, piece: usize, node: u32, afforded: &[PricedLimit]) -> Vec<u32> {
        let prices: Vec<EightPrices> = afforded.chunks(LANES).map(EightPrices::new).collect();
        let prices = &prices[..];
        match &self.problem.parts[piece] {
            Part::Drives { tree, .. } => {
                let asked = self.work.least_demands[piece].as_ref();
                let gears = afforded.first().map_or(&[][..], |(price, _)| &price.joint);
                tree.kept(node, NODES_PER_LEVEL, |drives| {
                    asked.is_none_or(|asked| drives.may_hold(asked))
                        && !in_lanes(DrivesCost { drives, gears, prices })
                })
            }
            Part::Links { tree, .. } => {
                tree.kept(node, NODES_PER_LEVEL, |links| !in_lanes(LinksCost { links, prices }))
            }
            _ => Vec::new(),
        }
    }
}

/// The prices of a level's numbers at eight dual points (sets of multipliers), and the greatest price that an option
/// may have at each.
struct EightPrices {
    /// The greatest price that an option may have at each dual point (set of multipliers).
    most: Eight,
    /// Price per unit of each line inertia (inertia per metre of a tube) at each dual point.
    inertia: [Eight; INERTIAS],
    /// Price per unit of each compliance at each dual point.
    compliance: [Eight; STIFFNESSES],
    /// Amount by which each unit of a stiffness lowers the weighted sum of the rows at each dual point.
    stiffness: [Eight; STIFFNESSES],
    /// Three numbers for each judged case, which counts for deflection and lowest mode: the price of a joint per unit
    /// of twist, its price per unit of torque, and the amount by which each unit of slope lowers the weighted sum.
    joint: Vec<[Eight; 3]>,
}

impl EightPrices {
    /// Packs up to eight dual points into the eight places (lanes) of a vector. In unused lanes any price is allowed.
    fn new(afforded: &[PricedLimit]) -> Self {
        let lanes = |of: &dyn Fn(&DualPrice) -> f64| -> Eight {
            std::array::from_fn(|lane| afforded.get(lane).map_or(0.0, |(price, _)| of(price)))
        };
        let joints = afforded.first().map_or(0, |(price, _)| price.joint.len());
        Self {
            most: std::array::from_fn(|lane| afforded.get(lane).map_or(f64::INFINITY, |(_, most)| *most)),
            inertia: std::array::from_fn(|k| lanes(&|price| price.inertia[k])),
            compliance: std::array::from_fn(|k| lanes(&|price| price.compliance[k])),
            stiffness: std::array::from_fn(|k| lanes(&|price| price.stiffness[k])),
            joint: (0..joints)
                .map(|g| {
                    [
                        lanes(&|price| price.joint[g].twist),
                        lanes(&|price| price.joint[g].torque),
                        lanes(&|price| price.joint[g].slope),
                    ]
                })
                .collect(),
        }
    }
}

/// Computes whether every drive of a box is excluded. This is so if, at some dual point (set of multipliers), the least
/// price of a drive in the box is above the allowed price. A price that is not a number excludes nothing.
struct DrivesCost<'a> {
    drives: &'a DriveBox,
    gears: &'a [JointPrice],
    prices: &'a [EightPrices],
}

impl LaneWork for DrivesCost<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Lanes>(self) -> bool {
        let Self { drives, gears, prices } = self;
        let mut ends = GearStates::default();
        let mut left = [V::zero(); DUAL_POINTS_USED / LANES];
        let tilt_stiffness = V::splat(stiffness_of(drives.tilt_rad_per_nm[0]));
        for (left, eight) in left.iter_mut().zip(prices) {
            let of_mass = least::<V>(&eight.inertia[inertia::MASS], drives.mass_kg);
            let of_tilt = least::<V>(&eight.compliance[TILT], drives.tilt_rad_per_nm)
                - V::load(&eight.stiffness[TILT]) * tilt_stiffness;
            *left = V::load(&eight.most) - of_mass - of_tilt;
        }
        for (g, gear) in gears.iter().enumerate() {
            // The price of a box with a rigid member has no finite bound, so the box stays.
            let Some(curve) = &drives.curve else { return false };
            gear.ends(curve, &mut ends);
            for (left, eight) in left.iter_mut().zip(prices) {
                let [twist, torque, slope] = &eight.joint[g];
                let mut best = V::splat(f64::INFINITY);
                for end in ends.as_slice() {
                    let price = least::<V>(twist, end.twist_rad) + V::load(torque) * V::splat(end.torque_nm);
                    best = best.min(price - V::load(slope) * V::splat(end.slope));
                }
                *left = *left - best;
            }
        }
        let mut excluded = 0;
        for left in left {
            excluded |= left.less(V::zero());
        }
        excluded != 0
    }
}

/// Computes whether every tube of a box is excluded. This is so if, at some dual point (set of multipliers), the least
/// price of a tube in the box is above the allowed price. A price that is not a number excludes nothing.
struct LinksCost<'a> {
    links: &'a LinkBox,
    prices: &'a [EightPrices],
}

impl LaneWork for LinksCost<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Lanes>(self) -> bool {
        let LinkBox { low, high, compliances, .. } = self.links;
        for eight in self.prices {
            let mut cost = V::zero();
            for k in 0..INERTIAS {
                cost = cost + least::<V>(&eight.inertia[k], [low.inertias[k], high.inertias[k]]);
            }
            let [stiff, soft] = compliances;
            for k in 0..STIFFNESSES {
                cost = cost + least::<V>(&eight.compliance[k], [stiff[k], soft[k]]);
                // A rigid coordinate does not lower the cost. An infinite stiffness times a zero price must not become
                // NaN.
                let price = V::load(&eight.stiffness[k]);
                let earned = price * V::splat(high.stiffnesses[k]);
                cost = cost - V::choose(V::zero().less(price), earned, V::zero());
            }
            if V::load(&eight.most).less(cost) != 0 {
                return true;
            }
        }
        false
    }
}

/// The least cost of a number that lies in an interval, at each of eight dual points with the prices `price`.
#[inline(always)]
fn least<V: Lanes>(price: &Eight, [low, high]: [f64; 2]) -> V {
    let price = V::load(price);
    (price * V::splat(low)).min(price * V::splat(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::joint_law::{Curve, JointLaw};
    use crate::exact::parts::Line;
    use crate::exact::torsion::CurveBox;
    use crate::sizing::bearing::BearingLimits;
    use crate::sizing::fit::{DriveWidths, LinkRoom};
    use crate::sizing::heat::MotorHeat;
    use crate::sizing::limits::DriveLimits;
    use proptest::prelude::*;

    /// Prices with an allowed price that is higher than the cost, except at the index `dear`, where it is lower.
    fn afforded(prices: Vec<DualPrice>, cost: impl Fn(&DualPrice) -> f64, dear: usize) -> Vec<PricedLimit> {
        let room = |at: usize| if at == dear { -0.1 } else { 0.1 };
        let afford = |(at, price): (usize, DualPrice)| {
            let cost = cost(&price);
            (price, cost + room(at) * (1.0 + cost.abs()))
        };
        prices.into_iter().enumerate().map(afford).collect()
    }

    fn excluded_one_by_one(afforded: &[PricedLimit], cost: impl Fn(&DualPrice) -> f64) -> bool {
        afforded.iter().any(|(price, most)| cost(price) > *most)
    }

    fn price(numbers: &[f64]) -> DualPrice {
        let mut numbers = numbers.iter().copied();
        let mut next = || numbers.next().unwrap_or_default();
        DualPrice {
            inertia: std::array::from_fn(|_| next()),
            compliance: std::array::from_fn(|_| next()),
            stiffness: std::array::from_fn(|_| next().max(0.0)),
            joint: Vec::new(),
        }
    }

    const ANY: DriveLimits = DriveLimits {
        static_torque_nm: 0.0,
        peak_torque_nm: 0.0,
        stop_torque_nm: 0.0,
        mean_torque_cubed_nm3: 0.0,
        bearing: BearingLimits::NONE,
        widths: DriveWidths { gear_m: 0.0, motor_m: 0.0, square_m: 0.0 },
        heat: MotorHeat::NONE,
    };

    proptest! {
        /// The comparison with eight prices at once excludes exactly the boxes that a comparison one by one excludes,
        /// for tubes with and without shear.
        #[test]
        fn tubes_cost_the_same_side_by_side(
            prices in prop::collection::vec(prop::collection::vec(-1.0f64..1.0, 15), 1..20),
            low in prop::array::uniform10(0.1f64..2.0), width in prop::array::uniform10(0.0f64..1.0),
            rigid in any::<bool>(), dear in 0usize..30,
        ) {
            let line = |times: f64| Line {
                inertias: std::array::from_fn(|k| low[k] + times * width[k]),
                stiffnesses: std::array::from_fn(|k| match rigid && k == 2 {
                    true => f64::INFINITY,
                    false => low[5 + k] + times * width[5 + k],
                }),
            };
            let (low, high) = (line(0.0), line(1.0));
            let compliances = [high.stiffnesses.map(f64::recip), low.stiffnesses.map(f64::recip)];
            let links =
                LinkBox { low, high, compliances, stress: [0.0; 4], round: false, cost_eur_per_m: 0.0, lever_m: [0.0; 2],
                    room: [LinkRoom::ANY; 2] };
            let prices = prices.iter().map(|numbers| price(numbers)).collect();
            let cost = |price: &DualPrice| price.of_tube(&links);
            let afforded = afforded(prices, cost, dear);
            let eights: Vec<EightPrices> = afforded.chunks(LANES).map(EightPrices::new).collect();
            let excluded = in_lanes(LinksCost { links: &links, prices: &eights });
            prop_assert_eq!(excluded, excluded_one_by_one(&afforded, cost));
        }

        /// The comparison with eight prices at once excludes exactly the boxes that a comparison one by one excludes,
        /// for drives whose gears are in one of three segments under torques of either sign, and whose bearings tilt or
        /// not.
        #[test]
        fn drives_cost_the_same_side_by_side(
            prices in prop::collection::vec(prop::array::uniform10(-1.0f64..1.0), 1..20),
            slopes in prop::array::uniform6(0.1f64..3.0), ends in prop::array::uniform2(0.1f64..3.0),
            torques in prop::array::uniform2((-5.0f64..5.0, 0.0f64..5.0)),
            mass_kg in 0.1f64..3.0, more_kg in 0.0f64..1.0, tilts: bool, tilt in prop::array::uniform2(0.1f64..3.0),
            dear in 0usize..30,
        ) {
            let curve = |k: &[f64]| {
                let windup = crate::arm::joint_law::Windup {
                    k1_nm_per_rad: k[0], k2_nm_per_rad: k[1], k3_nm_per_rad: k[2],
                    t1_nm: ends[0], t2_nm: ends[0] + ends[1],
                };
                CurveBox::of(&JointLaw::from(Curve::Windup(windup))).unwrap()
            };
            let curve = curve(&slopes[..3]).join(&curve(&slopes[3..]));
            let drives = DriveBox {
                mass_kg: [mass_kg, mass_kg + more_kg],
                limits: ANY, least_limits: ANY, multiples: Default::default(),
                curve: Some(curve), breaks: Default::default(), each: None,
                tilt_rad_per_nm: if tilts { [tilt[0], tilt[0] + tilt[1]] } else { [0.0; 2] },
            };
            let joint = |g: usize, n: &[f64]| JointPrice {
                twist: n[0], torque: n[1], slope: n[2].max(0.0),
                torques_nm: [torques[g].0, torques[g].0 + torques[g].1], play: None,
            };
            let prices = prices.iter().map(|n| {
                let mut price = DualPrice {
                    joint: vec![joint(0, &n[2..5]), joint(1, &n[5..8])],
                    ..price(&n[..1])
                };
                price.compliance[TILT] = n[8];
                price.stiffness[TILT] = n[9].max(0.0);
                price
            });
            let cost =
                |price: &DualPrice| price.of_joint(drives.mass_kg, drives.curve.as_ref(), drives.tilt_rad_per_nm);
            let afforded = afforded(prices.collect(), cost, dear);
            let eights: Vec<EightPrices> = afforded.chunks(LANES).map(EightPrices::new).collect();
            let gears = &afforded[0].0.joint;
            let excluded = in_lanes(DrivesCost { drives: &drives, gears, prices: &eights });
            prop_assert_eq!(excluded, excluded_one_by_one(&afforded, cost));
        }
    }
}
