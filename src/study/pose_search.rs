//! Searches for the pose with the largest score within ranges of the joints.
//!
//! First, the score is computed at a fixed set of poses: the corners, where every joint is at a multiple of 90
//! degrees or at an end of its range, and points of Halton's sequence between them. Then a compass search starts from
//! the best of these poses that are far enough apart. It turns one joint at a time, or two at once where no single
//! joint improves the score, by steps that become smaller. Nothing is random and nothing depends on the number of
//! threads. The result is the best pose that was found; it is not proved to be the best of all.

use crate::arm::halton::halton;
use crate::arm::pose::{DrivenJoint, Motion};
use rayon::prelude::*;

/// Largest number of corner poses at which the score is computed. If there are more, this many are selected by Halton's
/// sequence.
const MOST_CORNERS: usize = 1024;
/// Number of poses between the corners.
const POSES_BETWEEN_CORNERS: usize = 512;
/// Number of poses from which a compass search (moves along one joint at a time) starts.
const COMPASS_STARTS: usize = 6;
/// Smallest distance between two starting poses: they differ by at least this angle in some joint \[deg\].
const APART_DEG: f64 = 40.0;
/// Number of coarse searches that are continued with fine steps.
const FINE_SEARCHES: usize = 2;
/// Step sizes of a coarse search, one after the other \[deg\].
const COARSE_DEG: [f64; 3] = [24.0, 12.0, 6.0];
/// Step sizes of a fine search, one after the other \[deg\].
const FINE_DEG: [f64; 5] = [6.0, 2.0, 0.7, 0.3, 0.1];
/// Largest number of moves with one step size. After this many the search continues with the next smaller step.
const MOST_MOVES: usize = 60;
/// Smallest relative increase of the score that counts as an improvement; less is rounding.
const LEAST_RISE: f64 = 1e-9;

/// The range of one joint: of its angle \[deg\], or of its travel \[mm\].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    low_deg: f64,
    high_deg: f64,
    /// Whether the range is a full turn, so that both ends are the same angle.
    is_full: bool,
    /// The step that corresponds to one degree of an angle: 1 for an angle, 1/360 of the range for a travel \[mm\].
    degree: f64,
}

impl Turn {
    /// The range of a joint's angle, from `low_deg` to `high_deg` \[deg\]. A range of more than a full turn is reduced
    /// to one full turn: of the full turns that it contains, the one nearest to the range from -180 to 180 degrees.
    fn new([low_deg, high_deg]: [f64; 2]) -> Self {
        if high_deg - low_deg < 360.0 {
            return Self { low_deg, high_deg, is_full: false, degree: 1.0 };
        }
        let low_deg = (-180.0f64).clamp(low_deg, high_deg - 360.0);
        Self { low_deg, high_deg: low_deg + 360.0, is_full: true, degree: 1.0 }
    }

    /// The range of a travel \[mm\], from the smallest to the largest.
    fn travel([low_mm, high_mm]: [f64; 2]) -> Self {
        let degree = (high_mm - low_mm) / 360.0;
        Self { low_deg: low_mm, high_deg: high_mm, is_full: false, degree }
    }

    /// The value in the range that is nearest to `angle_deg`, rounded to tenths of a degree (or of a millimetre, for a
    /// travel), or an end of the range.
    fn within(self, angle_deg: f64) -> f64 {
        let turned = match self.is_full {
            // the upper end is kept, because 180 reads better than -180
            true if angle_deg <= self.low_deg || angle_deg > self.high_deg => {
                self.high_deg - (self.high_deg - angle_deg).rem_euclid(360.0)
            }
            _ => angle_deg,
        };
        ((turned * 10.0).round() / 10.0).clamp(self.low_deg, self.high_deg)
    }

    /// The values of a joint at corner poses, sorted from zero outward. For an angle they are multiples of 90 degrees
    /// and the ends of the range, for a travel the middle and the ends.
    fn corners_deg(self) -> Vec<f64> {
        if self.degree != 1.0 {
            return vec![self.low_deg, self.within(0.5 * (self.low_deg + self.high_deg)), self.high_deg];
        }
        let first = (self.low_deg / 90.0).ceil() as i64;
        let last = (self.high_deg / 90.0).floor() as i64;
        let mut out: Vec<f64> = (first..=last).map(|i| 90.0 * i as f64).collect();
        match self.is_full {
            true => out.retain(|&angle| angle != self.low_deg),
            false => out.extend([self.low_deg, self.high_deg].iter().filter(|end| *end % 90.0 != 0.0)),
        }
        out.sort_by(|a, b| a.abs().total_cmp(&b.abs()).then(b.total_cmp(a)));
        out
    }
}

/// A pose and its score.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scored {
    /// One entry for each joint, base to tip \[deg\], or \[mm\] for a travel.
    pub pose_deg: Vec<f64>,
    /// Score of the pose, in the unit of the function that is maximized.
    pub score: f64,
}

/// The ranges of all joints, and which joints influence the score.
#[derive(Debug, Clone)]
pub(super) struct PoseRanges {
    turns: Vec<Turn>,
    /// Indices of the joints that influence the score.
    free: Vec<usize>,
}

/// How many joints a compass search turns at once.
#[derive(Clone, Copy)]
enum Moves {
    OneJoint,
    /// Two joints are turned at once where no single joint improves the score.
    OneOrTwoJoints,
}

impl PoseRanges {
    /// The ranges of all joints \[deg or mm\]. Until [`that_matter`](Self::that_matter) is called, every joint counts
    /// as one that influences the score.
    pub(super) fn new(ranges: &[[f64; 2]], joints: &[DrivenJoint]) -> Self {
        let turn = |(range, joint): (&[f64; 2], &DrivenJoint)| match joint.motion {
            Motion::Turns => Turn::new(*range),
            Motion::Slides => Turn::travel(*range),
        };
        let turns: Vec<Turn> = ranges.iter().zip(joints).map(turn).collect();
        Self { free: (0..turns.len()).collect(), turns }
    }

    /// These ranges, in which the search turns only the joints that influence `values`. `values` returns numbers of the
    /// arm at a pose, such as the score. A joint that changes none of them, such as a vertical first joint under weight
    /// alone, stays as near to zero as its range allows.
    pub(super) fn that_matter<const N: usize>(mut self, values: impl Fn(&[f64]) -> [f64; N]) -> Self {
        const TURNED_DEG: [f64; 2] = [31.7, 123.4];
        let differs =
            |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > LEAST_RISE * a.abs());
        let matters = |joint: usize| {
            (1..=2).any(|index| {
                let pose_deg = self.spread(index);
                let here = values(&pose_deg);
                TURNED_DEG.iter().any(|by| {
                    let mut turned = pose_deg.clone();
                    turned[joint] += by * self.turns[joint].degree;
                    differs(&here, &values(&turned))
                })
            })
        };
        self.free = (0..self.turns.len()).filter(|&joint| matters(joint)).collect();
        self
    }

    /// The fixed set of poses at which the score is computed first.
    pub(super) fn first_poses(&self) -> Vec<Vec<f64>> {
        let corners: Vec<Vec<f64>> = self.free.iter().map(|&joint| self.turns[joint].corners_deg()).collect();
        let all = corners.iter().try_fold(1usize, |n, of| n.checked_mul(of.len()));
        let count = all.map_or(MOST_CORNERS, |all| all.min(MOST_CORNERS));
        let corner = |index: usize| {
            let mut pose_deg = self.home();
            let mut rest = index;
            for (place, (&joint, of)) in self.free.iter().zip(&corners).enumerate() {
                pose_deg[joint] = match all {
                    Some(all) if all <= MOST_CORNERS => of[rest % of.len()],
                    _ => of[(halton(index, place) * of.len() as f64) as usize],
                };
                rest /= of.len();
            }
            pose_deg
        };
        (0..count).map(corner).chain((1..=POSES_BETWEEN_CORNERS).map(|index| self.spread(index))).collect()
    }

    /// The pose within the ranges that is nearest to `pose_deg`. Joints that do not influence the score are set as near
    /// to zero as their ranges allow.
    pub(super) fn nearest(&self, pose_deg: &[f64]) -> Vec<f64> {
        let mut out = self.home();
        self.free.iter().for_each(|&joint| out[joint] = self.turns[joint].within(pose_deg[joint]));
        out
    }

    /// The best pose that compass searches find. They start from the best of the poses `from`, with coarse steps. The
    /// best results are then continued with fine steps. `None` if `from` is empty.
    pub(super) fn climb(&self, from: &[Scored], score: impl Fn(&[f64]) -> f64 + Sync) -> Option<Scored> {
        let mut climbed: Vec<Scored> = self
            .starts(from)
            .into_par_iter()
            .map(|start| self.climbed(start, &COARSE_DEG, Moves::OneJoint, &score))
            .collect();
        climbed.sort_by(|a, b| b.score.total_cmp(&a.score));
        climbed.dedup_by(|a, b| a.pose_deg == b.pose_deg);
        climbed.truncate(FINE_SEARCHES);
        let followed: Vec<Scored> = climbed
            .into_par_iter()
            .map(|start| self.climbed(start, &FINE_DEG, Moves::OneOrTwoJoints, &score))
            .collect();
        followed.into_iter().reduce(|best, other| if other.score > best.score { other } else { best })
    }

    /// The poses of `from` with the highest scores that are at least [`APART_DEG`] apart, at most [`COMPASS_STARTS`] of
    /// them.
    fn starts(&self, from: &[Scored]) -> Vec<Scored> {
        let mut order: Vec<&Scored> = from.iter().collect();
        order.sort_by(|a, b| b.score.total_cmp(&a.score));
        let mut out: Vec<Scored> = Vec::new();
        for scored in order {
            if out.len() < COMPASS_STARTS
                && out.iter().all(|other| self.apart_deg(other, scored) >= APART_DEG)
            {
                out.push(scored.clone());
            }
        }
        out
    }

    /// The largest difference between the poses `one` and `other` in a joint that influences the score \[deg\]. A
    /// travel is converted to degrees.
    fn apart_deg(&self, one: &Scored, other: &Scored) -> f64 {
        let apart = |&joint: &usize| {
            let by = (one.pose_deg[joint] - other.pose_deg[joint]).abs();
            let turn = self.turns[joint];
            if turn.is_full { by.min(360.0 - by) } else { by / turn.degree }
        };
        self.free.iter().map(apart).fold(0.0, f64::max)
    }

    /// The result of a compass search from the pose `start`. Each of `steps_deg` \[deg\] is used until no move with
    /// this step improves the score.
    fn climbed(
        &self,
        start: Scored,
        steps_deg: &[f64],
        moves: Moves,
        score: &impl Fn(&[f64]) -> f64,
    ) -> Scored {
        let mut here = start;
        for &step_deg in steps_deg {
            for _ in 0..MOST_MOVES {
                let single = self.turned_once(&here, step_deg, score);
                let pair = || match moves {
                    Moves::OneJoint => None,
                    Moves::OneOrTwoJoints => self.turned_in_pair(&here, step_deg, score),
                };
                match single.or_else(pair) {
                    Some(better) => here = better,
                    None => break,
                }
            }
        }
        here
    }

    /// Turns each joint by `step_deg`, one after the other, in the direction that improves the score, and keeps every
    /// turn that improves it. `None` if no turn improves the score.
    fn turned_once(&self, from: &Scored, step_deg: f64, score: &impl Fn(&[f64]) -> f64) -> Option<Scored> {
        let mut best: Option<Scored> = None;
        for &joint in &self.free {
            for by in [step_deg, -step_deg] {
                let here = best.as_ref().unwrap_or(from);
                if let Some(better) = self.moved(here, &[(joint, by)], score) {
                    best = Some(better);
                    break;
                }
            }
        }
        best
    }

    /// Turns two joints by `step_deg` at once, and returns the first such pose that improves the score; `None` if there
    /// is none.
    fn turned_in_pair(&self, from: &Scored, step_deg: f64, score: &impl Fn(&[f64]) -> f64) -> Option<Scored> {
        let pairs =
            self.free.iter().enumerate().flat_map(|(i, &a)| self.free[i + 1..].iter().map(move |&b| [a, b]));
        pairs
            .flat_map(|pair| [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|signs| (pair, signs)))
            .find_map(|([a, b], [x, y])| self.moved(from, &[(a, x * step_deg), (b, y * step_deg)], score))
    }

    /// The pose after joints of `from` were turned, if its score is higher; else `None`. Each item of `by_deg` is the
    /// index of a joint and the angle \[deg\].
    fn moved(
        &self,
        from: &Scored,
        by_deg: &[(usize, f64)],
        score: &impl Fn(&[f64]) -> f64,
    ) -> Option<Scored> {
        let mut pose_deg = from.pose_deg.clone();
        for &(joint, by) in by_deg {
            pose_deg[joint] = self.turns[joint].within(pose_deg[joint] + by * self.turns[joint].degree);
        }
        if pose_deg == from.pose_deg {
            return None;
        }
        let score = score(&pose_deg);
        (score > from.score + LEAST_RISE * from.score.abs()).then_some(Scored { pose_deg, score })
    }

    /// The pose with the index `index` in Halton's sequence, within the ranges and in whole degrees.
    fn spread(&self, index: usize) -> Vec<f64> {
        let mut pose_deg = self.home();
        for (place, &joint) in self.free.iter().enumerate() {
            let Turn { low_deg, high_deg, .. } = self.turns[joint];
            let part = halton(index, place);
            pose_deg[joint] = self.turns[joint].within((low_deg + (high_deg - low_deg) * part).round());
        }
        pose_deg
    }

    /// The pose in which every joint is as near to zero as its range allows.
    fn home(&self) -> Vec<f64> {
        self.turns.iter().map(|turn| turn.within(0.0)).collect()
    }
}
