//! Long campaigns: effects are sought in a part of the displacements, and then fitted to all.
//!
//! The search for effects fits hundreds of models, each to every row. What some thousand rows show clearly, all rows show
//! too. So the search goes through a part of the rows. The models near the best one are then fitted to all rows, and compared
//! again. The result of the part counts only if all of this holds; otherwise all rows are searched, as in a shorter campaign:
//!
//! - in the part, the best model leaves no structure, and no law without a name explains the rows as well;
//! - on all rows, the same effects are the best, they leave no structure, and no more rows are gross errors than in the part.
//!
//! The rows of the part are whole visits of poses (rows that follow each other in one pose), because the order of the loads in a
//! pose matters. The visits are spread over the file in an irregular order that is the same in each run. Those with the smallest
//! and the largest angle of each joint and with the smallest and the largest loads are among them, and so is the first visit of
//! each file and each branch of loading.

use super::fit::descent::{Effort, fit};
use super::fit::noise::Noise;
use super::fit::stats::scrambled;
use super::forward::prepared::Forward;
use super::found::Found;
use super::model::parameters::Model;
use super::readings::campaign::Campaign;
use super::readings::rows::StaticRow;
use super::select::lack_of_fit::lack_of_fit;
use super::select::search::Search;
use super::select::settle::Settled;
use super::select::unnamed;
use crate::arm::effect::channel::Channel;
use std::collections::HashSet;
use std::ops::Range;

/// A campaign with more displacements than this is long.
const LONG: usize = 5_000;
/// Number of displacements in which effects are sought, not counting those with extreme angles.
const SOUGHT_IN: usize = 2_500;
/// Rows of one pose that follow each other are one visit, up to this number. What friction keeps of earlier loads is lost where
/// a visit is divided.
const LONGEST_VISIT: usize = 250;

/// A part of a long campaign.
pub(super) struct Part {
    /// The campaign with a part of its displacements, and all other readings.
    pub(super) campaign: Campaign,
    /// The index of each displacement of the part among those of the long campaign.
    kept: Vec<usize>,
    /// Number of displacements of the long campaign.
    of: usize,
}

impl Part {
    /// The part of `campaign` in which effects are sought; `None` if the campaign is not long.
    pub(super) fn of(campaign: &Campaign) -> Option<Self> {
        let rows = &campaign.statics;
        if rows.len() <= LONG {
            return None;
        }
        let visits = visits(rows);
        let mut order: Vec<usize> = (0..visits.len()).collect();
        order.sort_by_key(|&visit| scrambled(visit));
        let mut left = SOUGHT_IN;
        let mut chosen = order;
        chosen.retain(|&visit| {
            let is_chosen = left > 0;
            left = left.saturating_sub(visits[visit].len());
            is_chosen
        });
        chosen.extend(ends(rows, &visits));
        chosen.sort_unstable();
        chosen.dedup();
        let kept: Vec<usize> = chosen.into_iter().flat_map(|visit| visits[visit].clone()).collect();
        let statics = kept.iter().map(|&row| rows[row].clone()).collect();
        let campaign = Campaign { statics, ..campaign.clone() };
        Some(Self { campaign, kept, of: rows.len() })
    }

    fn sentence(&self) -> String {
        format!("effects were sought in {} of the {} displacements", self.kept.len(), self.of)
    }
}

/// The visits of poses, each as a range of rows.
fn visits(rows: &[StaticRow]) -> Vec<Range<usize>> {
    let mut out: Vec<Range<usize>> = Vec::new();
    for (row, own) in rows.iter().enumerate() {
        match out.last_mut() {
            Some(visit) if rows[visit.start].pose_deg == own.pose_deg && visit.len() < LONGEST_VISIT => {
                visit.end = row + 1
            }
            _ => out.push(row..row + 1),
        }
    }
    out
}

/// The visits with the smallest and the largest angle of each joint, payload and force, and the first visit of each file and
/// branch of loading.
fn ends(rows: &[StaticRow], visits: &[Range<usize>]) -> Vec<usize> {
    let visit_of = |row: usize| visits.partition_point(|visit| visit.end <= row);
    let joints = rows.first().map_or(0, |row| row.pose_deg.len());
    let end = |size: &dyn Fn(&StaticRow) -> f64| {
        (0..rows.len()).min_by(|a, b| size(&rows[*a]).total_cmp(&size(&rows[*b])))
    };
    let both = |size: &dyn Fn(&StaticRow) -> f64| [end(size), end(&|row| -size(row))];
    let angles = (0..joints).flat_map(|joint| both(&|row| row.pose_deg[joint]));
    let loads = both(&|row| row.payload.mass_kg).into_iter().chain(both(&|row| row.force_n.norm()));
    let mut known = HashSet::new();
    let firsts = (0..rows.len()).filter(|&row| known.insert((rows[row].file, rows[row].branch.as_str())));
    let firsts: Vec<usize> = firsts.collect();
    angles.chain(loads).flatten().chain(firsts).map(visit_of).collect()
}

impl<'c> Found<'c> {
    /// Whether the effects explain the readings in which they were found, and no law without a name explains them as well.
    fn stands(&self) -> bool {
        let weights = self.settled.noise.weights(&self.forward);
        let Self { campaign, forward, nuisance, candidates, settled, .. } = self;
        let search = Search { campaign, forward, nuisance, candidates, weights: &weights };
        let chosen = &settled.selection.best;
        if settled.selection.given_up {
            return false;
        }
        let best = search.polish(&chosen.effects, &chosen.u);
        if lack_of_fit(campaign, forward, &best, &weights).fails {
            return false;
        }
        let against_laws = || {
            let baseline = search.fit(&[], &settled.selection.baseline.u, Effort::default());
            unnamed::instead(&search, &search.scored(&chosen.effects, &best), &baseline, &settled.noise)
                .is_none()
        };
        chosen.effects.is_empty() || against_laws()
    }

    /// The models that were found in a part of the rows of `campaign`, fitted to all rows and compared again. `None` if the result
    /// of the part does not hold there, or if its readings were found to be in another unit.
    pub(super) fn on_all_rows<'l>(&self, campaign: &'l Campaign, part: &Part) -> Option<Found<'l>> {
        if !self.as_declared || !self.stands() {
            return None;
        }
        let (nuisance, candidates) = (self.nuisance.clone(), self.candidates.clone());
        let mut forward = Forward::new(campaign);
        self.number_modes_of(&mut forward);
        let best = &self.settled.selection.best;
        let model = Model::of(&nuisance, &candidates, &best.effects);
        let coefficients = model.coefficients(&forward, &best.u);
        forward.refresh(&coefficients);
        let judged = |noise: &Noise| {
            let weights = noise.weights(&forward);
            Noise::from_fit(&forward, &fit(&forward, &model, &best.u, &weights, Effort::default()), &weights)
        };
        let noise = judged(&judged(&Noise { outliers: Vec::new(), ..self.settled.noise.clone() }));
        let slips = |noise: &Noise| noise.outliers.iter().filter(|o| o.channel == Channel::Static).count();
        let expected = (slips(&self.settled.noise) * part.of) as f64 / part.kept.len() as f64;
        if slips(&noise) as f64 > 2.0 * expected + 0.001 * part.of as f64 {
            return None;
        }
        let weights = noise.weights(&forward);
        let search = Search {
            campaign,
            forward: &forward,
            nuisance: &nuisance,
            candidates: &candidates,
            weights: &weights,
        };
        let selection = search.weigh_again(&self.settled.selection);
        if selection.best.effects != best.effects {
            return None;
        }
        let fitted = search.polish(&selection.best.effects, &selection.best.u);
        if lack_of_fit(campaign, &forward, &fitted, &weights).fails {
            return None;
        }
        let mut remarks = self.settled.remarks.clone();
        remarks.push(format!("{} and then fitted to all of them", part.sentence()));
        let settled = Settled { selection, noise, remarks };
        Some(Found {
            campaign,
            few: false,
            forward,
            nuisance,
            candidates,
            settled,
            as_declared: true,
            stood: true,
        })
    }

    /// Numbers the modes of `forward`, which has the same frequencies, as they are numbered here.
    fn number_modes_of(&self, forward: &mut Forward) {
        let (own, there) = (self.forward.starts[1], forward.starts[1]);
        for (list, other) in self.forward.modal.iter().zip(&mut forward.modal) {
            other.modes = list.modes.iter().map(|(datum, mode)| (datum - own + there, *mode)).collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use std::path::Path;

    /// A test campaign whose displacements are repeated until there are `count`, each pose at other angles.
    fn campaign(count: usize) -> Campaign {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let mut campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        let rows = campaign.statics.clone();
        let row = |i: usize| {
            let mut row = rows[i % rows.len()].clone();
            row.row = i;
            row.pose_deg.iter_mut().for_each(|angle| *angle += 0.001 * (i / rows.len()) as f64);
            row
        };
        campaign.statics = (0..count).map(row).collect();
        campaign
    }

    #[test]
    fn a_part_has_whole_visits_in_their_order_and_the_ends_of_every_angle() {
        assert!(Part::of(&campaign(LONG)).is_none());
        let whole = campaign(LONG + 1);
        let part = Part::of(&whole).expect("long");
        assert!(part.kept.is_sorted() && part.kept.len() >= SOUGHT_IN);
        let longest = visits(&whole.statics).iter().map(|visit| visit.len()).max().expect("visits");
        // the ends of angles and loads, the branches, and the last visit
        let most = SOUGHT_IN + longest * (2 * whole.statics[0].pose_deg.len() + 4 + 3 + 1);
        assert!(part.kept.len() <= most, "{}", part.kept.len());
        for (index, row) in part.kept.iter().zip(&part.campaign.statics) {
            assert_eq!(&whole.statics[*index], row);
        }
        for visit in visits(&whole.statics) {
            let own = part.kept.iter().filter(|row| visit.contains(row)).count();
            assert!(own == 0 || own == visit.len(), "{visit:?}");
        }
        for joint in 0..whole.statics[0].pose_deg.len() {
            let largest =
                |rows: &[StaticRow]| rows.iter().map(|row| row.pose_deg[joint]).fold(f64::MIN, f64::max);
            assert_eq!(largest(&whole.statics), largest(&part.campaign.statics));
        }
    }

    #[test]
    fn a_pose_that_is_held_for_long_is_divided_into_visits() {
        let mut whole = campaign(LONG + 1);
        let pose_deg = whole.statics[0].pose_deg.clone();
        whole.statics.iter_mut().for_each(|row| row.pose_deg.clone_from(&pose_deg));
        let part = Part::of(&whole).expect("long");
        assert!(part.kept.len() < SOUGHT_IN + 9 * LONGEST_VISIT, "{}", part.kept.len());
        assert!(part.kept.first() == Some(&0) && part.kept.last() > Some(&(LONG / 2)));
    }
}
