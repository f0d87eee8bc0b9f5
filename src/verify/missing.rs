//! Search for designs that belong on a front and are missing from it. A design belongs on the front if it meets all
//! checks and limits and no design of the front dominates it.

use super::boxes::Boxes;
use super::drives::Ties;
use super::front_index::FrontIndex;
use super::halt::{Found, Halt};
use super::judge::{Judge, Judged, Pick};
use super::ledger::{Branch, Ledger};
use super::offers::JointOffers;
use super::parts_box::{Choice, Design};
use super::question::{AskedPiece, Question};
use super::region::search::{RegionSearch, Work};
use super::search::Search;
use super::settings::Settings;
use super::upper_bound::UpperBound;
use crate::pareto::objectives::Objectives;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, PoisonError};
use std::time::Instant;

/// Number of single designs that are judged together. After each batch, the search checks whether it must stop.
const DESIGNS_PER_BATCH: usize = 4096;
/// Largest number of designs up to which all ties are listed. If there are more, one design of each set of ties is
/// listed.
const MOST_TIES: f64 = 2e4;

/// The result of a search for missing designs.
#[derive(Debug, Clone, PartialEq)]
pub struct Looked {
    /// The designs that pass all checks and limits and that no design of the front dominates. The front's own
    /// designs are among them.
    pub candidates: Vec<Judged>,
    /// Number of boxes that were bounded.
    pub boxes: u64,
    /// Number of boxes and designs that were not examined because the search was stopped.
    pub open: u64,
    /// Whether the candidates include every design that ties with another.
    pub ties_listed: bool,
}

/// Checks whether the verifier's bounds are valid for a question.
///
/// # Errors
/// A sentence that names what the bounds do not take into account, if they are not valid.
pub fn conditions(question: &Question) -> Result<(), String> {
    match question.motion.grows() {
        true => Ok(()),
        false => {
            Err("its bounds do not know a duty cycle that decelerates longer than it accelerates".into())
        }
    }
}

impl Judge<'_> {
    /// Searches for designs that belong on a front but are missing from it. The question must meet the
    /// [`conditions`].
    ///
    /// The result does not depend on the number of threads, unless the search is stopped.
    pub fn missing(
        &self,
        front: &[Objectives],
        settings: Settings,
        stop: &AtomicBool,
        deadline: Option<Instant>,
    ) -> Looked {
        self.missing_since(&Ledger::default(), front, settings, (stop, deadline))
    }

    /// Does the same as [`missing`](Self::missing), but skips the branches that are finished in `ledger`. The ledger
    /// must be of the same question and the same front.
    pub fn missing_since(
        &self,
        ledger: &Ledger,
        front: &[Objectives],
        settings: Settings,
        (stop, deadline): (&AtomicBool, Option<Instant>),
    ) -> Looked {
        let index = FrontIndex::new(front);
        let designs = ledger.designs();
        let halt = Halt { stop, deadline, count: designs.len().into(), designs: designs.into() };
        let found = match self.designs().is_none_or(|designs| designs > settings.regions_from) {
            false => self.explore_boxes(&index, &halt, ledger),
            true => {
                let parts = self.skeleton.parts(self.question, &self.offers, Ties::Together);
                let work = Work { front, index: &index, settings, halt: &halt, ledger };
                RegionSearch::explore_all(Arc::clone(&self.skeleton), parts, &work)
            }
        };
        let designs = halt.designs.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let (designs, ties_listed) = one_by_one(&designs);
        let mut looked = Looked { candidates: Vec::new(), boxes: found.boxes, open: found.open, ties_listed };
        for batch in designs.chunks(DESIGNS_PER_BATCH) {
            match halt.out_of_time() {
                true => looked.open += batch.len() as u64,
                false => looked.candidates.extend(self.unbeaten(batch, &index)),
            }
        }
        looked
    }

    fn explore_boxes(&self, front: &FrontIndex, halt: &Halt, ledger: &Ledger) -> Found {
        let parts = self.skeleton.parts(self.question, &self.offers, Ties::Apart);
        let boxes = Boxes::of(Arc::clone(&self.skeleton), parts);
        let search = Search { boxes: &boxes, front, upper: UpperBound::OPEN, halt, ledger };
        boxes.root().map_or_else(Found::default, |root| search.explore(&root, Branch::ROOT))
    }

    /// Number of designs of the question; `None` if it exceeds 128 bits.
    fn designs(&self) -> Option<u128> {
        let drives = self.offers.iter().filter_map(JointOffers::of_catalog);
        let drives = drives.filter(|offers| offers.is_choice).map(|offers| offers.offers.len());
        let tubes = self.question.pieces.iter().filter_map(|piece| match piece {
            AskedPiece::Choice(choice) => Some(choice.tubes.len()),
            _ => None,
        });
        drives.chain(tubes).try_fold(1u128, |product, options| product.checked_mul(options as u128))
    }

    /// Judges designs by the full model. Returns the designs that pass all checks and limits and that no design of the
    /// front dominates. Each design in `designs` is given by its options, one for each level.
    fn unbeaten(&self, designs: &[Vec<u32>], front: &FrontIndex) -> Vec<Judged> {
        let judged = designs.par_iter().filter_map(|options| self.judge(&self.picks(options)));
        judged.filter(|design| !front.beats(&design.objectives)).collect()
    }

    /// The part at each piece of a design, base to tip. `options` are the design's options at each level, tip first.
    pub fn picks(&self, options: &[u32]) -> Vec<Pick> {
        let (mut levels, mut joints) = (options.iter().rev(), self.offers.iter());
        let mut next = || levels.next().map_or(0, |&option| option as usize);
        let pick = |piece: &AskedPiece| match piece {
            AskedPiece::Prismatic(_) | AskedPiece::Link(_) => Pick::Given,
            AskedPiece::Choice(_) => Pick::Tube(next()),
            AskedPiece::Joint(_) => match joints.next().and_then(JointOffers::of_catalog) {
                Some(offers) if offers.is_choice => {
                    let offer = &offers.offers[next()];
                    Pick::Drive { gear: offer.gear, motor: offer.motor }
                }
                _ => Pick::Given,
            },
        };
        self.question.pieces.iter().map(pick).collect()
    }
}

/// The options of each single design, in ascending order, and a flag that tells whether all ties are listed. If there
/// are too many ties, one design of each set of ties is listed. A level at which no option surely passes its checks
/// always keeps all of its options, because its first option may fail.
fn one_by_one(designs: &BTreeSet<Design>) -> (Vec<Vec<u32>>, bool) {
    let count = |design: &Design| design.iter().map(|choice| choice.options.len() as f64).product::<f64>();
    let is_one = |design: &Design| count(design) == 1.0;
    let ties_listed = designs.iter().map(count).sum::<f64>() <= MOST_TIES || designs.iter().all(is_one);
    let mut all = Vec::new();
    for design in designs {
        let mut chosen: Vec<Vec<u32>> = vec![Vec::new()];
        for Choice { options, one_holds } in design {
            let options = if ties_listed || !one_holds { &options[..] } else { &options[..1] };
            let longer = |start: Vec<u32>| options.iter().map(move |&o| [&start[..], &[o]].concat());
            chosen = chosen.into_iter().flat_map(longer).collect();
        }
        all.extend(chosen);
    }
    all.sort_unstable();
    all.dedup();
    (all, ties_listed)
}
