//! A structure in residuals: the result of one test of them.

use crate::arm::effect::channel::Channel;

/// One test of the residuals for a structure, and its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// The channel whose residuals are tested; `None` if the test is about all channels together.
    pub channel: Option<Channel>,
    /// The quantity that the residuals would follow, in words.
    pub follows: String,
    /// Test statistic, which follows a chi-squared distribution if there is no structure.
    pub statistic: f64,
    /// Degrees of freedom of the statistic.
    pub dof: f64,
    /// Natural logarithm of the probability that chance gives so large a statistic, corrected for the number of tests
    /// (Bonferroni).
    pub ln_p: f64,
}

impl Structure {
    /// The structure as a sentence.
    pub fn sentence(&self) -> String {
        let of = self.channel.map_or(String::new(), |c| format!(" of {}", c.word()));
        format!(
            "the residuals{of} follow {} (chi-squared {:.0} on {} degrees of freedom)",
            self.follows, self.statistic, self.dof
        )
    }
}
