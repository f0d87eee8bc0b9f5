//! Tied designs, which differ only in drives of one kind, and their listing.

use super::box_work::BoxWork;
use super::problem::{Part, Problem};
use crate::search::sweep::Candidate;
use crate::space::design::{number, options};
use std::collections::{BTreeSet, HashMap};

impl Problem<'_> {
    /// All designs that the designs in `found` represent. The drive of such a design represents all drives of its kind
    /// (equal mass, curve and bearing stiffness). If there are more than `most` designs, only the first design for each
    /// design in `found` is returned. The flag is `true` if all are returned.
    pub(super) fn with_ties(&self, found: &[Candidate], most: usize) -> (Vec<Candidate>, bool) {
        let with_ties: Vec<(&Candidate, Vec<Vec<u32>>)> = self.feasible_drives(found);
        let count = |lists: &Vec<Vec<u32>>| lists.iter().map(|list| list.len() as f64).product::<f64>();
        let all: f64 = with_ties.iter().map(|(_, lists)| count(lists)).sum();
        let lists_all = all <= most as f64;
        let mut designs = Vec::new();
        for (candidate, lists) in &with_ties {
            let mut chosen: Vec<Vec<u32>> = vec![Vec::new()];
            for list in lists {
                // Either all ties of all designs are listed, or one design of each set of ties. A list that ends
                // somewhere in between would be arbitrary.
                let choices = if lists_all { &list[..] } else { &list[..1] };
                let longer = |start: Vec<u32>| choices.iter().map(move |o| [&start[..], &[*o]].concat());
                chosen = chosen.into_iter().flat_map(longer).collect();
            }
            designs.extend(
                chosen
                    .into_iter()
                    .map(|options| Candidate { number: number(&self.level_sizes, &options), ..**candidate }),
            );
        }
        (designs, lists_all)
    }

    /// For each design in `found`, the options of each level that may replace its own, tip first. For a level of
    /// drives, these are the drives of the same kind that carry the demand. Drives that carry it by more than rounding
    /// come first.
    fn feasible_drives<'f>(&self, found: &'f [Candidate]) -> Vec<(&'f Candidate, Vec<Vec<u32>>)> {
        let chosen: Vec<Option<Vec<u32>>> =
            found.iter().map(|candidate| options(&self.level_sizes, candidate.number)).collect();
        let leaves = self.leaves_of(&chosen);
        let mut work = BoxWork::default();
        let mut lists_of = |options: &[u32]| -> Option<Vec<Vec<u32>>> {
            let mut design_box: Vec<u32> = options
                .iter()
                .zip(&leaves)
                .map(|(o, leaves)| leaves.get(o).copied())
                .collect::<Option<_>>()?;
            self.fill(&mut design_box, &mut work)?;
            let levels = self.level_pieces.iter().zip(options);
            levels
                .map(|(&piece, &option)| match (&self.parts[piece], &work.least_demands[piece]) {
                    (Part::Drives { sized, kinds, .. }, Some(asked)) => {
                        let holds = |drive: &&u32| sized.table.limits(**drive as usize).hold(&asked.demand);
                        let mut drives: Vec<u32> =
                            kinds.drives(option).iter().filter(holds).copied().collect();
                        // A drive that carries even the greatest demand carries the demand whatever the rounding is.
                        // Such drives come first.
                        let surely = |drive: &u32| {
                            let limits = sized.table.limits(*drive as usize);
                            work.greatest_demands[piece].as_ref().is_some_and(|most| limits.hold(most))
                        };
                        drives.sort_by_key(|drive| !surely(drive));
                        (!drives.is_empty()).then_some(drives)
                    }
                    _ => Some(vec![option]),
                })
                .collect()
        };
        let pairs = found.iter().zip(&chosen);
        pairs.filter_map(|(candidate, options)| Some((candidate, lists_of(options.as_ref()?)?))).collect()
    }

    /// For each level, the leaf of each option that one of the designs has. Each design is given by its options.
    fn leaves_of(&self, designs: &[Option<Vec<u32>>]) -> Vec<HashMap<u32, u32>> {
        let of_level = |(level, &piece): (usize, &usize)| {
            let wanted: BTreeSet<u32> = designs.iter().flatten().map(|options| options[level]).collect();
            match &self.parts[piece] {
                Part::Drives { tree, .. } => tree.leaves_of(&wanted),
                Part::Links { tree, .. } => tree.leaves_of(&wanted),
                _ => HashMap::new(),
            }
        };
        self.level_pieces.iter().enumerate().map(of_level).collect()
    }
}
