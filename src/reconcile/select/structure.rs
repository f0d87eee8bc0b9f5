//! A structure that residuals follow: the answer to one question about them.

use crate::arm::effect::channel::Channel;

/// One question about the residuals, and its answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// The channel; `None` if the question is about all channels together.
    pub channel: Option<Channel>,
    /// What the residuals would follow, in words.
    pub follows: String,
    /// Test statistic.
    pub statistic: f64,
    /// Degrees of freedom of the statistic.
    pub dof: f64,
    /// ln of the probability that chance gives so large a statistic, times the number of questions.
    pub ln_p: f64,
}

impl Structure {
    /// The structure in one line.
    pub fn sentence(&self) -> String {
        let of = self.channel.map_or(String::new(), |c| format!(" of {}", c.word()));
        format!(
            "the residuals{of} follow {} (chi-squared {:.0} on {} degrees of freedom)",
            self.follows, self.statistic, self.dof
        )
    }
}
