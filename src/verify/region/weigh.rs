//! Weightings of a zone's rows: the least weighted sum of any member, found part by part; and those that refute the
//! corner or say which parts it cannot afford.

use super::game::{Game, solve};
use super::price::{Prices, affordable, cheapest};
use super::rows::Rows;
use super::zone::Zone;
use std::ops::Range;

/// Weightings at the most for a zone, and new sets of shapes; weightings once none can refute.
const MOST_PLANES: usize = 24;
const MOST_SHAPES: usize = 3;
const TO_NARROW: usize = 4;
/// The best weighting is as good as any if the game promises no more than this beyond it.
const SETTLED: f64 = 5e-4;
/// A row this far from what is allowed has no more say.
const FAR: f64 = 10.0;
/// Rounding of sums whose terms are about one.
pub(super) const ROUNDING: f64 = 1e-9;
/// Weightings that say what can be afforded: the strictest.
const STRICTEST: usize = 12;
/// Nodes that a link's tubes are kept in, about.
const NODES: usize = 128;

/// A weighting, the least weighted sum of any member, and what each part adds to it.
struct Plane {
    weights: Vec<f64>,
    least: f64,
    parts: Vec<f64>,
}

/// The cheapest member under a weighting, in the numbers of its parts; its gears may be at torques of their own.
pub(super) struct Member {
    pub numbers: Vec<f64>,
    /// Its drive of each joint.
    pub drives: Vec<u32>,
}

/// What is left of a zone below a corner.
pub(super) struct Left {
    /// Drives of each joint and nodes of each link's tubes that a member below the corner may have.
    pub joints: Vec<Vec<u32>>,
    pub tubes: Vec<Vec<u32>>,
    /// The cheapest members with their shares in the mixture that no weights refute.
    pub mixed: Vec<(f64, Member)>,
    /// The weights that come nearest to refuting them.
    pub weights: Vec<f64>,
}

impl Rows<'_> {
    /// Price of each number under a weighting of the rows.
    fn prices(&self, weights: &[f64]) -> Vec<f64> {
        let mut prices = vec![0.0; self.columns.len()];
        for (row, weight) in self.rows.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            prices.iter_mut().zip(&row.per_number).for_each(|(price, per)| *price += weight * per);
        }
        prices
    }

    /// What each curve of a joint costs; infinite if the zone has it not.
    fn curve_prices(&self, joint: usize, prices: &[f64]) -> Vec<f64> {
        let first = self.columns.mass(joint) + 1;
        let price = |numbers: &Vec<f64>| numbers.iter().zip(&prices[first..]).map(|(a, b)| a * b).sum();
        self.curves[joint].iter().map(|numbers| numbers.as_ref().map_or(f64::INFINITY, price)).collect()
    }

    /// The least weighted sum of any member of a zone, and a member that has it.
    fn least(&self, zone: &Zone, weights: Vec<f64>) -> (Plane, Member) {
        let prices = self.prices(&weights);
        let mut numbers = vec![0.0; self.columns.len()];
        let (mut parts, mut drives) = (Vec::new(), Vec::new());
        for (joint, kept) in zone.joints.iter().enumerate() {
            let (stock, first) = (&self.stock.joints[joint], self.columns.mass(joint));
            let (per_kg, curves) = (prices[first], self.curve_prices(joint, &prices));
            let price = |drive: u32| {
                per_kg * stock.masses_kg[drive as usize] + curves[stock.curve[drive as usize] as usize]
            };
            let mut best = (f64::INFINITY, kept[0]);
            for &drive in kept {
                let price = price(drive);
                if price < best.0 {
                    best = (price, drive);
                }
            }
            numbers[first] = stock.masses_kg[best.1 as usize];
            if let Some(curve) = &self.curves[joint][stock.curve[best.1 as usize] as usize] {
                numbers[first + 1..=first + curve.len()].copy_from_slice(curve);
            }
            drives.push(best.1);
            parts.push(best.0);
        }
        for (tube, kept) in zone.tubes.iter().enumerate() {
            let (stock, columns) =
                (&self.stock.tubes[tube], self.columns.of_part(self.columns.joints + tube));
            let prices = Prices::new(&prices[columns.clone()]);
            let (price, node) = cheapest(stock, kept, &prices);
            numbers[columns].copy_from_slice(&prices.numbers(stock.bounds(node)));
            parts.push(price);
        }
        let fixed: f64 = self.rows.iter().zip(&weights).map(|(row, weight)| weight * row.fixed).sum();
        let least = fixed + parts.iter().sum::<f64>();
        (Plane { weights, least, parts }, Member { numbers, drives })
    }

    /// The weights that a zone came with; even ones if it has none.
    fn inherited(&self, zone: &Zone) -> Vec<f64> {
        let mut weights = zone.weights.clone();
        weights.resize(self.first_mode, 0.0);
        weights.extend(zone.shapes.iter().map(|shape| shape.weight));
        let stakes = (0..weights.len()).filter(|row| !self.conditions().contains(row));
        let sum: f64 = stakes.map(|row| weights[row]).sum();
        let fits = weights.len() == self.rows.len() && sum > 0.0;
        let even = vec![1.0 / self.rows.len() as f64; self.rows.len()];
        if fits { weights.iter().map(|weight| weight / sum).collect() } else { even }
    }

    /// What is left of a zone; `None` if some weighting refutes that a member is below the corner.
    pub fn left(&mut self, zone: &Zone) -> Option<Left> {
        let (mut planes, mut members, mut values) = (Vec::new(), Vec::new(), Vec::<Vec<f64>>::new());
        let (mut shapes, mut to_narrow, mut nearest) = (0, 0, f64::NEG_INFINITY);
        let mut weights = self.inherited(zone);
        let game = loop {
            let (plane, member) = self.least(zone, weights);
            if plane.least > ROUNDING {
                return None;
            }
            nearest = f64::max(nearest, plane.least);
            planes.push(plane);
            values.push(self.values(&member));
            members.push(member);
            let mut game = solve(&values, self.conditions());
            if game.most <= ROUNDING && shapes < MOST_SHAPES {
                shapes += 1;
                if self.add_shapes(&members, &game) {
                    values = members.iter().map(|member| self.values(member)).collect();
                    game = solve(&values, self.conditions());
                }
            }
            to_narrow += usize::from(game.most <= ROUNDING);
            if planes.len() >= MOST_PLANES || to_narrow > TO_NARROW || game.most <= nearest + SETTLED {
                break game;
            }
            weights = game.weights;
        };
        // a zone that came with weights has left out what the objectives exclude one by one
        let first = if zone.weights.is_empty() { 0 } else { self.first_held };
        let singles = (first..self.first_mode).map(|row| {
            let mut weights = vec![0.0; self.rows.len()];
            weights[row] = 1.0;
            weights
        });
        for weights in singles {
            let (plane, _) = self.least(zone, weights);
            if plane.least > ROUNDING {
                return None;
            }
            planes.push(plane);
        }
        let [joints, tubes] = self.affordable(zone, planes)?;
        Some(Left {
            joints,
            tubes,
            mixed: game.shares.into_iter().zip(members).collect(),
            weights: game.weights,
        })
    }

    /// The rows that are no stakes of the game: torques that are held.
    fn conditions(&self) -> Range<usize> {
        self.first_held..self.first_mode
    }

    fn values(&self, member: &Member) -> Vec<f64> {
        self.rows.iter().map(|row| row.value(&member.numbers).clamp(-FAR, FAR)).collect()
    }

    /// Adds the lowest modes of the arm in between some members where they are below the corner's; whether any is.
    fn add_shapes(&mut self, members: &[Member], game: &Game) -> bool {
        let mut between = vec![0.0; self.columns.len()];
        for (member, share) in members.iter().zip(&game.shares) {
            between.iter_mut().zip(&member.numbers).for_each(|(sum, number)| *sum += share * number);
        }
        let before = self.rows.len();
        for case in 0..self.columns.cases {
            let pencil = self.pencil(case, &between);
            if let Some(shape) = pencil.slower_motion(self.corner.eigenvalue()) {
                self.add_mode(case, shape);
            }
        }
        self.rows.len() > before
    }

    /// The options of each joint and of each link that no weighting excludes; `None` if one has none.
    fn affordable(&self, zone: &Zone, mut planes: Vec<Plane>) -> Option<[Vec<Vec<u32>>; 2]> {
        planes.sort_by(|a, b| b.least.total_cmp(&a.least));
        planes.truncate(STRICTEST);
        let rooms: Vec<(Vec<f64>, f64, Plane)> = planes
            .into_iter()
            .map(|mut plane| {
                plane.weights.resize(self.rows.len(), 0.0);
                (self.prices(&plane.weights), ROUNDING - plane.least, plane)
            })
            .collect();
        let joints = zone.joints.iter().enumerate().map(|(joint, kept)| {
            let stock = &self.stock.joints[joint];
            let mut kept = kept.clone();
            for (prices, room, plane) in &rooms {
                let (per_kg, most) = (prices[self.columns.mass(joint)], plane.parts[joint] + room);
                let curves = self.curve_prices(joint, prices);
                kept.retain(|&drive| {
                    let curve = curves[stock.curve[drive as usize] as usize];
                    per_kg * stock.masses_kg[drive as usize] + curve <= most
                });
            }
            (!kept.is_empty()).then_some(kept)
        });
        let tubes = zone.tubes.iter().enumerate().map(|(tube, kept)| {
            let part = self.columns.joints + tube;
            let limit = |(prices, room, plane): &(Vec<f64>, f64, Plane)| {
                (Prices::new(&prices[self.columns.of_part(part)]), plane.parts[part] + room)
            };
            let limits: Vec<(Prices, f64)> = rooms.iter().map(limit).collect();
            let kept = affordable(&self.stock.tubes[tube], kept, &limits, NODES);
            (!kept.is_empty()).then_some(kept)
        });
        Some([joints.collect::<Option<_>>()?, tubes.collect::<Option<_>>()?])
    }
}
