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

use super::fit::descent::{Effort, Fit};
use super::fit::noise::Noise;
use super::fit::stats::scrambled;
use super::forward::prepared::Forward;
use super::found::{Found, Sought};
use super::readings::campaign::Campaign;
use super::readings::rows::StaticRow;
use super::select::lack_of_fit::lack_of_fit;
use super::select::search::{Scored, Search};
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
/// For each gross error that the part lets one expect among all rows, this many may be there.
const MOST_SLIPS: f64 = 2.0;
/// This fraction of all rows may be gross errors although the part has none, by chance.
const FEW_SLIPS: f64 = 0.001;

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
        let (kept, of) = (self.kept.len(), self.of);
        format!("effects were sought in {kept} of the {of} displacements and then fitted to all of them")
    }

    /// Whether more displacements are gross errors by `in_all`, the judgement of all rows, than `in_part`, that of the part, lets
    /// one expect.
    fn has_fewer_slips(&self, in_part: &Noise, in_all: &Noise) -> bool {
        let slips =
            |noise: &Noise| noise.outliers.iter().filter(|o| o.channel == Channel::Static).count() as f64;
        let of = self.of as f64;
        slips(in_all) > MOST_SLIPS * slips(in_part) * of / self.kept.len() as f64 + FEW_SLIPS * of
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

impl Found<'_> {
    /// The models that were found in the part `part` of the rows of `campaign`, fitted to all rows and compared again. `None` if
    /// the result of the part does not hold there, or if its readings were found to be in another unit.
    pub(super) fn on_all_rows<'l>(self, campaign: &'l Campaign, part: &Part) -> Option<Found<'l>> {
        if !self.as_declared || !self.stands() {
            return None;
        }
        let Found { sought: Sought { forward: of_part, nuisance, candidates, .. }, settled: found, .. } =
            self;
        let mut sought = Sought { campaign, forward: Forward::new(campaign), nuisance, candidates };
        number_modes(&of_part, &mut sought.forward);
        let best = &found.selection.best;
        sought.refresh(best);
        let noise = noise_of_all(&sought, best, &found.noise);
        if part.has_fewer_slips(&found.noise, &noise) {
            return None;
        }
        let weights = noise.weights(&sought.forward);
        let search = sought.search(&weights);
        let selection = search.weigh_again(&found.selection);
        if selection.best.effects != best.effects || explaining(&search, &selection.best).is_none() {
            return None;
        }
        let mut remarks = found.remarks;
        remarks.push(part.sentence());
        let settled = Settled { selection, noise, remarks };
        Some(Found { sought, few: false, settled, as_declared: true, stood: true })
    }

    /// Whether the effects explain the readings in which they were found, and no law without a name explains them as well.
    fn stands(&self) -> bool {
        let Settled { selection, noise, .. } = &self.settled;
        let weights = noise.weights(&self.sought.forward);
        let search = self.sought.search(&weights);
        if selection.given_up {
            return false;
        }
        let Some(best) = explaining(&search, &selection.best) else { return false };
        let effects = &selection.best.effects;
        let stands_against_laws = || {
            let baseline = search.fit(&[], &selection.baseline.u, Effort::default());
            unnamed::instead(&search, &search.scored(effects, &best), &baseline, noise).is_none()
        };
        effects.is_empty() || stands_against_laws()
    }
}

/// The model `scored`, fitted until it has converged; `None` if it leaves structure.
fn explaining<'s>(search: &Search<'s>, scored: &Scored) -> Option<Fit<'s>> {
    let best = search.polish(&scored.effects, &scored.u);
    (!lack_of_fit(search.campaign, search.forward, &best, search.weights).fails).then_some(best)
}

/// The gross errors and the scatter of all rows, judged by the model `best` that was found in a part of them. `in_part` is the
/// scatter there.
fn noise_of_all(sought: &Sought, best: &Scored, in_part: &Noise) -> Noise {
    let judged = |noise: &Noise| {
        let weights = noise.weights(&sought.forward);
        let best = sought.search(&weights).fit(&best.effects, &best.u, Effort::default());
        Noise::from_fit(&sought.forward, &best, &weights)
    };
    judged(&judged(&Noise { scale: in_part.scale, outliers: Vec::new() }))
}

/// Numbers the modes of `to` as they are numbered in `from`, which has the same frequencies.
fn number_modes(from: &Forward, to: &mut Forward) {
    let (own, there) = (from.starts[1], to.starts[1]);
    for (list, other) in from.modal.iter().zip(&mut to.modal) {
        other.modes = list.modes.iter().map(|(datum, mode)| (datum - own + there, *mode)).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::reconcile::fit::noise::Outlier;
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

    #[test]
    fn modes_that_were_put_in_order_keep_their_readings_among_more_rows() {
        let (short, whole) = (campaign(20), campaign(60));
        let [mut from, mut to] = [&short, &whole].map(Forward::new);
        from.modal[0].modes.reverse();
        from.modal[0].modes[0].1 += 1;
        number_modes(&from, &mut to);
        for (list, other) in from.modal.iter().zip(&to.modal) {
            let of = |forward: &Forward, modes: &[(usize, usize)]| -> Vec<(usize, usize)> {
                modes.iter().map(|(datum, mode)| (forward.data[*datum].row, *mode)).collect()
            };
            assert_eq!(of(&from, &list.modes), of(&to, &other.modes));
        }
    }

    #[test]
    fn as_many_gross_errors_for_each_row_are_no_more_and_a_rare_load_that_is_off_is() {
        let part = Part { campaign: campaign(1), kept: (0..2500).collect(), of: 100_000 };
        let slips = |count: usize| {
            let outlier = |row| Outlier { channel: Channel::Static, row, sigmas: 9.0 };
            Noise { outliers: (0..count).map(outlier).collect(), ..Noise::default() }
        };
        for (in_part, in_all, is_more) in
            [(0, 0, false), (0, 90, false), (0, 110, true), (5, 250, false), (5, 600, true)]
        {
            assert_eq!(part.has_fewer_slips(&slips(in_part), &slips(in_all)), is_more, "{in_part}, {in_all}");
        }
    }
}
