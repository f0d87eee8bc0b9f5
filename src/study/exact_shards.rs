//! Shards of an exact search: the fronts that each shard searches for, and how the results of all shards are joined
//! into the result that one machine would give.

use super::definition::Study;
use super::outcome::{ExactStudy, Extent, Searched, judged_exactly, watched};
use crate::catalog::Catalogs;
use crate::exact::outcome::FoundInShard;
use crate::exact::run::Exact;
use crate::exact::{Known, refuse_holes};
use crate::search::resume::Resume;
use crate::search::sweep::Shard;
use crate::space::design_space::DesignSpace;
use std::sync::atomic::{AtomicBool, Ordering};

/// The fronts that an exact search of a space with the gap `gap` looks for. `None` stands for the front of all designs.
/// If the gap is 0 and the space has several materials, the front of each material follows, given by the index of the
/// material.
pub fn fronts_of(space: &DesignSpace, gap: f64) -> Vec<Option<usize>> {
    let materials = space.material_names().len();
    let of_materials = if gap == 0.0 && materials > 1 { materials } else { 0 };
    std::iter::once(None).chain((0..of_materials).map(Some)).collect()
}

/// Searches one shard of a study to a gap. Returns what the search found for each of the [`fronts_of`] the study.
/// `given` is what other searches of the study found: first index the search, second the front. The search continues
/// from the state in `resume`, and saves its own states there. `watch` runs on another thread and shows the progress
/// (see [`run_exact`](super::run_exact)). A search that was stopped returns fewer fronts, and the last of them has open
/// boxes.
///
/// # Errors
/// A message if the saved state belongs to another search.
pub fn exact_shard(
    (study, catalogs): (&Study, &Catalogs),
    (shard, gap): (Shard, f64),
    given: &[Vec<FoundInShard>],
    stop: &AtomicBool,
    resume: Resume,
    watch: impl FnOnce(&(dyn Fn() -> Known + Sync), &AtomicBool) + Send,
) -> Result<Vec<FoundInShard>, String> {
    let search =
        Exact::new(&study.space, catalogs, stop, None).to_gap(gap).of_shard(shard).resumed(resume)?;
    let of_front = |(at, material): (usize, Option<usize>)| {
        let given: Vec<FoundInShard> = given.iter().filter_map(|of| of.get(at).cloned()).collect();
        search.found(material, &given)
    };
    let go_on = |_: &_| !stop.load(Ordering::Relaxed);
    let fronts = fronts_of(&study.space, gap).into_iter().enumerate();
    let work = || fronts.take_while(go_on).map(of_front).collect();
    Ok(watched(|finished| watch(&|| search.known(), finished), work))
}

/// Joins what the shards found for each of the [`fronts_of`] a study, and finds the designs near the front if `extent`
/// asks for them. `shards` has what was found: first index the shard, second the front.
///
/// # Errors
/// A message if some design is in no shard, or in more than one.
pub fn joined_exactly(
    study: &Study,
    catalogs: &Catalogs,
    shards: &[Vec<FoundInShard>],
    stop: &AtomicBool,
    extent: Extent,
) -> Result<ExactStudy, String> {
    let search = Exact::new(&study.space, catalogs, stop, extent.deadline).to_gap(extent.gap);
    let of_front = |at: usize| -> Vec<FoundInShard> {
        shards.iter().map(|found| found.get(at).cloned().unwrap_or_default()).collect()
    };
    for at in 0..fronts_of(&study.space, extent.gap).len() {
        let found = of_front(at);
        refuse_holes(found.iter().flat_map(|found| &found.subtrees).map(String::as_str).collect())?;
    }
    let whole = search.joined(None, &of_front(0));
    let of_material = |index: usize| search.joined(Some(index), &of_front(1 + index));
    let searched = Searched::new(&search, &study.space, (whole, of_material), extent.near);
    Ok(judged_exactly(&searched, study, catalogs, extent.near))
}
