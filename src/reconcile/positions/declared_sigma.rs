//! Compares the standard deviations that the file of positions declares with the scatter of the positions.

use super::analysis::Positions;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::median::median;
use crate::report::number::significant;

/// Declared standard deviations are reported if they are more than this many times larger than the scatter. The
/// specification of an instrument is rarely so cautious, and numbers in micrometres would be a thousand times too
/// large.
const FAR_LARGER: f64 = 10.0;

impl Positions {
    /// Sentence on declared standard deviations that are far larger than the scatter of the positions. `None` if they
    /// are not. Standard deviations that are too small are found by the test for lack of fit.
    pub(crate) fn too_careful(&self, campaign: &Campaign) -> Option<String> {
        let declared_mm = median(campaign.positions.iter().map(|row| row.sigma_mm()).collect());
        sentence(declared_mm, 1e3 * self.fitted.scale_m)
    }
}

fn sentence(declared_mm: f64, scatter_mm: f64) -> Option<String> {
    (declared_mm > FAR_LARGER * scatter_mm).then(|| {
        let [declared, scatter] = [declared_mm, scatter_mm].map(|mm| significant(mm, 2));
        format!(
            "the standard deviation that the positions declare, {declared} mm, is {} times their scatter about the best \
             model, {scatter} mm: is it in another unit than mm? The scatter was used to weigh them",
            significant(declared_mm / scatter_mm, 2)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn micrometres_in_a_column_of_millimetres_are_noticed_and_a_careful_sigma_is_not() {
        let said = sentence(50.0, 0.05).expect("a thousand times");
        assert!(said.contains("50 mm, is 1000 times their scatter"), "{said}");
        assert_eq!(sentence(0.2, 0.05), None);
        assert_eq!(sentence(0.0005, 0.05), None);
    }
}
