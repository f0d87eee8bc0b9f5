//! Chooses the search for the front of a study: the method that the user asked for, or the one that is estimated to
//! cost less.

use super::definition::Study;
use super::load::refuse_empty;
use super::refusal::Refusal;
use super::search_cost::SearchCost;
use crate::catalog::Catalogs;

/// The two methods of searching for a front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum SearchMethod {
    /// Every design is visited
    Exhaustive,
    /// Groups (boxes) of designs that cannot be on the front are discarded without evaluation; for spaces of
    /// any size
    Exact,
}

/// The wishes of the user for a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SearchWish {
    /// The method that the user asked for; `None` if the user asked for none.
    pub method: Option<SearchMethod>,
    /// Whether the user asked for a gap at which the search may end.
    pub has_gap: bool,
    /// Whether the user set a time limit.
    pub has_time_limit: bool,
}

/// Largest number of designs for which an exhaustive search is accepted. With more designs it would take years.
const MOST_CONCEIVABLE: u128 = 1_000_000_000_000_000;

impl SearchWish {
    /// The method that the user asked for, or the one that is estimated to cost less, with the estimate in words.
    ///
    /// # Errors
    /// The method does not suit the study, or it would take years.
    pub fn method(
        &self,
        study: &Study,
        catalogs: &Catalogs,
    ) -> Result<(SearchMethod, Option<String>), Refusal> {
        let designs = self.check(study, catalogs)?;
        Ok(match (self.method, self.has_gap || self.has_time_limit) {
            (Some(method), _) => (method, None),
            (None, true) => (SearchMethod::Exact, None),
            (None, false) if study.space.beyond_exact().is_some() => (SearchMethod::Exhaustive, None),
            (None, false) => cheaper(study, catalogs, designs as f64),
        })
    }

    /// Checks that the request suits the study, and returns its number of designs.
    ///
    /// # Errors
    /// The study has nothing to choose from, the request does not suit it, or the search would take years.
    pub fn check(&self, study: &Study, catalogs: &Catalogs) -> Result<u128, Refusal> {
        refuse_empty(study, catalogs)?;
        let refused = |why: String| Err(Refusal::Unknown(why));
        let Some(designs) = study.space.designs(catalogs) else {
            return refused(format!("the study \"{}\" has more than 1e38 designs; thin a grid", study.name));
        };
        let exhaustive = self.method == Some(SearchMethod::Exhaustive);
        let by_bounds = self.method == Some(SearchMethod::Exact) || self.has_time_limit || self.has_gap;
        if let Some(unknown) = study.space.beyond_exact().filter(|_| by_bounds) {
            return refused(format!(
                "the study \"{}\" has {unknown}, which the bounds of the exact search do not cover; leave --search \
                 exact, --gap and --time-limit away, and every design is visited",
                study.name
            ));
        }
        if exhaustive && designs > MOST_CONCEIVABLE {
            return refused(format!(
                "visiting the {:.1e} designs of the study \"{}\" would take years; use --search exact",
                designs as f64, study.name
            ));
        }
        if exhaustive && self.has_time_limit {
            return refused("--time-limit goes with --search exact".into());
        }
        if exhaustive && self.has_gap {
            return refused("--gap goes with --search exact".into());
        }
        Ok(designs)
    }
}

/// The search method that is estimated to cost less processor time, with both estimated times in words.
fn cheaper(study: &Study, catalogs: &Catalogs, designs: f64) -> (SearchMethod, Option<String>) {
    let cost = SearchCost::of(&study.space, catalogs, designs);
    let method = if cost.speaks_for_exact() { SearchMethod::Exact } else { SearchMethod::Exhaustive };
    (method, cost.words())
}
