//! Excerpts: a design space reduced to the options that a few of its designs use.
//!
//! A space may have a hundred thousand sections for each link, while its front has a few thousand designs. An
//! [`ArmProblem`] has tables of every option in every pose, so that an `ArmProblem` of an excerpt is much smaller. A
//! design keeps the number that it has in the whole space, and with it its name.

use super::design::{number, number_of, options};
use super::design_space::{DesignSpace, Excerpt, LinkChoice, LinkOption, SpacePiece};
use super::joints::TabulatedJoints;
use super::problem::ArmProblem;
use super::slot::Slot;
use crate::catalog::Catalogs;
use std::collections::BTreeSet;
use std::sync::Arc;

impl DesignSpace {
    /// Number of options of each level, tip first. The tables of link options are not needed for it.
    pub fn level_sizes(&self, catalogs: &Catalogs) -> Vec<u32> {
        self.level_sizes_with(&TabulatedJoints::new(self, catalogs))
    }

    /// Does the same as [`level_sizes`](Self::level_sizes), for joints whose drives are already in tables.
    fn level_sizes_with(&self, joints: &TabulatedJoints) -> Vec<u32> {
        let size = |(place, piece): (usize, &SpacePiece)| match piece {
            SpacePiece::Joint(_) => joints.get(place).filter(|slot| slot.is_level()).map(Slot::options),
            SpacePiece::Choice(choice) => Some(choice.options.len() as u32),
            SpacePiece::Prismatic(_) | SpacePiece::Link(_) => None,
        };
        let mut sizes: Vec<u32> = self.pieces.iter().enumerate().filter_map(size).collect();
        sizes.reverse();
        sizes
    }

    /// Number of designs in the space; `None` if it does not fit into 128 bits.
    pub fn designs(&self, catalogs: &Catalogs) -> Option<u128> {
        self.designs_with(&TabulatedJoints::new(self, catalogs))
    }

    /// Does the same as [`designs`](Self::designs), for joints whose drives are already in tables.
    pub(crate) fn designs_with(&self, joints: &TabulatedJoints) -> Option<u128> {
        let sizes = self.level_sizes_with(joints);
        sizes.into_iter().try_fold(1u128, |n, size| n.checked_mul(u128::from(size)))
    }

    /// The space reduced to the link options that the designs with these numbers use; `None` if a number belongs to
    /// no design of the space.
    pub fn excerpt(&self, catalogs: &Catalogs, designs: &[u128]) -> Option<DesignSpace> {
        self.excerpt_with(&TabulatedJoints::new(self, catalogs), designs)
    }

    /// Does the same as [`excerpt`](Self::excerpt), for joints whose drives are already in tables.
    pub(crate) fn excerpt_with(&self, joints: &TabulatedJoints, designs: &[u128]) -> Option<DesignSpace> {
        let sizes = self.level_sizes_with(joints);
        let mut used: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); sizes.len()];
        for &design in designs {
            for (used, option) in used.iter_mut().zip(options(&sizes, design)?) {
                used.insert(option);
            }
        }
        let lists: Vec<Vec<u32>> = used.into_iter().map(|used| used.into_iter().collect()).collect();
        self.of_options(&lists)
    }

    /// The space reduced to the link options that are listed for each level. Levels are in order from the tip, and
    /// the options of a level are in ascending order. Returns `None` if there are fewer lists than levels.
    pub fn of_options(&self, lists: &[Vec<u32>]) -> Option<DesignSpace> {
        let mut out = self.clone();
        let mut levels = lists.iter();
        for piece in out.pieces.iter_mut().rev() {
            match piece {
                SpacePiece::Choice(choice) => choice.keep(levels.next()?.clone()),
                SpacePiece::Joint(joint) if joint.drive.is_open() => {
                    levels.next()?;
                }
                _ => {}
            }
        }
        out.renumber_materials();
        Some(out)
    }

    /// The space with at most `most` options for each open link (a link whose section the search chooses): the options
    /// in the middle of the order by mass.
    pub fn middle(&self, most: u32) -> DesignSpace {
        let mut out = self.clone();
        for piece in &mut out.pieces {
            if let SpacePiece::Choice(choice) = piece
                && choice.options.len() as u32 > most
            {
                let by_mass = choice.by_mass();
                let first = by_mass.len() / 2 - most as usize / 2;
                let mut kept = by_mass[first..first + most as usize].to_vec();
                kept.sort_unstable();
                choice.keep(kept);
            }
        }
        out.renumber_materials();
        out
    }

    /// Numbers the remaining materials from 0 without gaps, in the order of the study.
    pub(crate) fn renumber_materials(&mut self) {
        let choices = self.pieces.iter().filter_map(SpacePiece::as_choice);
        let used: BTreeSet<usize> =
            choices.flat_map(|c| c.options.iter()).map(|o| o.material_index).collect();
        let place: Vec<usize> = used.into_iter().collect();
        for choice in self.pieces.iter_mut().filter_map(SpacePiece::as_choice_mut) {
            for option in Arc::make_mut(&mut choice.options) {
                option.material_index = place.binary_search(&option.material_index).unwrap_or_default();
            }
        }
    }
}

impl LinkChoice {
    /// Indices of the options from the lightest to the heaviest; options of equal mass are in the order of the list.
    pub(crate) fn by_mass(&self) -> Vec<u32> {
        let kg_per_m: Vec<f64> = self.options.iter().map(LinkOption::mass_kg_per_m).collect();
        let mut places: Vec<u32> = (0..self.options.len() as u32).collect();
        places.sort_by(|&a, &b| kg_per_m[a as usize].total_cmp(&kg_per_m[b as usize]));
        places
    }

    /// Reduces the options to at most `most`: the lightest, the heaviest, and others at equal steps between them in the
    /// order by mass.
    pub(crate) fn spread(&mut self, most: u32) {
        let by_mass = self.by_mass();
        let (last, steps) = (by_mass.len().saturating_sub(1), most.max(2) as usize - 1);
        if last > steps {
            let mut kept: Vec<u32> = (0..=steps).map(|k| by_mass[k * last / steps]).collect();
            kept.sort_unstable();
            self.keep(kept);
        }
    }

    /// Keeps only the options at these indices of the list, and remembers the indices.
    fn keep(&mut self, places: Vec<u32>) {
        let of = self.options.len() as u32;
        self.options = places.iter().map(|&i| self.options[i as usize].clone()).collect();
        self.excerpt = Some(Excerpt { places, of });
    }
}

impl ArmProblem<'_> {
    /// Whether two designs are ties: they differ only in drives of equal mass, torsion curve and bearing stiffness.
    /// Both designs are given by their options in the whole space, one for each level.
    pub fn are_ties(&self, a: &[u32], b: &[u32]) -> bool {
        let pairs = self.level_slots().iter().zip(a.iter().zip(b));
        pairs.into_iter().all(|(&slot, (a, b))| match &self.slots()[slot] {
            Slot::Sized(sized) => sized.are_ties(*a as usize, *b as usize),
            _ => a == b,
        })
    }

    /// Number that a design of this (reduced) space has in the whole space.
    pub fn whole_number(&self, design: u128) -> u128 {
        let here = options(self.level_sizes_slice(), design).unwrap_or_default();
        // A level that was not reduced has the same size and the same options in both spaces.
        let (sizes, places): (Vec<u32>, Vec<u32>) = self
            .excerpts()
            .zip(here.iter().zip(self.level_sizes_slice()))
            .map(|(excerpt, (&option, &size))| {
                excerpt.map_or((size, option), |e| (e.of, e.places[option as usize]))
            })
            .unzip();
        number(&sizes, &places)
    }

    /// Options, in this (reduced) space, of the design with the name `design_id`, one for each level. `None` if there is no
    /// such design, or if it uses an option that was not kept.
    pub(crate) fn options_of_id(&self, design_id: &str) -> Option<Vec<u32>> {
        self.options_of_whole(number_of(design_id)?)
    }

    /// Options, in this (reduced) space, of a design of the whole space, one for each level; `None` if the design
    /// uses an option that was not kept.
    pub fn options_of_whole(&self, design: u128) -> Option<Vec<u32>> {
        let excerpts: Vec<Option<&Excerpt>> = self.excerpts().collect();
        let sizes: Vec<u32> = excerpts
            .iter()
            .zip(self.level_sizes_slice())
            .map(|(e, &size)| e.map_or(size, |e| e.of))
            .collect();
        let whole = options(&sizes, design)?;
        excerpts
            .iter()
            .zip(whole)
            .map(|(e, option)| {
                e.map_or(Some(option), |e| e.places.binary_search(&option).ok().map(|i| i as u32))
            })
            .collect()
    }

    /// For each level, tip first, which options of its whole list were kept; `None` for a level that was not reduced.
    fn excerpts(&self) -> impl Iterator<Item = Option<&Excerpt>> {
        self.level_slots().iter().map(|&slot| match &self.space().pieces[self.piece_of_slot(slot)] {
            SpacePiece::Choice(choice) => choice.excerpt.as_ref(),
            _ => None,
        })
    }
}
