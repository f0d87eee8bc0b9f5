//! Laws of links that are longer or shorter than drawn. A longer link also has more mass and compliance.

use super::{Builder, Law};
use crate::arm::Element;
use crate::reconcile::readings::campaign::Campaign;
use rayon::prelude::*;

/// Step for the difference quotient of the readings: the link is longer by this fraction of its length.
const LENGTH_STEP: f64 = 1e-3;
/// Change of a link's length that counts as the full size of the law, as a fraction of the length.
const FULL_PART: f64 = 0.1;

impl Builder<'_> {
    /// For each link, the law that it is longer or shorter than drawn.
    pub(super) fn length_laws(&self) -> Vec<Law> {
        let names: Vec<&str> = self.campaign.arm.links().map(|link| link.name.as_str()).collect();
        let columns = self.forward.length_columns.get_or_init(|| self.length_columns(&names));
        let law = |(name, column): (&&str, &Vec<f64>)| {
            Law::new(format!("a length of {name} other than drawn"), vec![column.clone()])
        };
        names.iter().zip(columns).map(law).collect()
    }

    /// For each link, the change of every reading of the nominal arm, in its unit, if the link is longer by
    /// [`FULL_PART`] of its length. All poses have to be prepared again for this. It is therefore computed once about
    /// the nominal arm, and not for every fit.
    fn length_columns(&self, names: &[&str]) -> Vec<Vec<f64>> {
        let stated = self.forward.nominal_readings(self.campaign);
        let column = |name: &&str| {
            let longer = self.forward.nominal_readings(&lengthened(self.campaign, name));
            longer
                .iter()
                .zip(&stated)
                .map(|(longer, stated)| FULL_PART / LENGTH_STEP * (longer - stated))
                .collect()
        };
        names.par_iter().map(column).collect()
    }
}

/// The campaign with the link `name` of its arm lengthened by [`LENGTH_STEP`].
fn lengthened(campaign: &Campaign, name: &str) -> Campaign {
    let mut out = campaign.clone();
    for element in &mut out.arm.chain {
        if let Element::Link(link) = element
            && link.name == name
        {
            link.vector_m *= 1.0 + LENGTH_STEP;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::testing::about_the_nominal_arm;

    #[test]
    fn a_longer_link_is_a_law_of_its_own_and_moves_static_readings_and_frequencies() {
        about_the_nominal_arm(|builder, _| {
            let laws = builder.length_laws();
            assert_eq!(laws.len(), builder.campaign.arm.links().count());
            let largest = |range: std::ops::Range<usize>, column: &[f64]| {
                range.map(|i| column[i].abs()).fold(0.0, f64::max)
            };
            let [modal, windup] = [builder.forward.starts[1], builder.forward.starts[2]];
            let moves = laws.iter().filter(|law| {
                largest(0..modal, &law.columns[0]) > 1e-3 && largest(modal..windup, &law.columns[0]) > 1e-3
            });
            assert!(moves.count() >= 2, "two long links");
        });
    }
}
