//! Statements of the paper that were checked.

use crate::report::table::{Column, Table};

/// A statement of the paper with the evidence computed for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// Key of the claim, which stays the same in all versions.
    pub id: &'static str,
    /// The paper's statement, in words.
    pub statement: String,
    /// The computed evidence, in words.
    pub evidence: String,
    /// Whether the evidence supports the statement.
    pub holds: bool,
}

impl Claim {
    /// A claim with its evidence.
    pub fn new(id: &'static str, statement: &str, holds: bool, evidence: impl Into<String>) -> Self {
        Self { id, statement: statement.to_string(), evidence: evidence.into(), holds }
    }

    /// The verdict in words: `holds` or `does not hold`.
    pub fn verdict(&self) -> &'static str {
        if self.holds { "holds" } else { "does not hold" }
    }
}

/// The claims as a table.
pub fn table(claims: &[Claim]) -> Table {
    let columns = ["claim", "statement", "holds", "evidence"].map(Column::left).to_vec();
    let mut table = Table::new(columns);
    for claim in claims {
        table.row([
            claim.id.to_string(),
            claim.statement.clone(),
            if claim.holds { "true" } else { "false" }.to_string(),
            claim.evidence.clone(),
        ]);
    }
    table
}

/// The claims as a Markdown list.
pub fn list(claims: &[Claim]) -> String {
    claims.iter().map(|c| format!("- {} -- **{}**: {}.\n", c.statement, c.verdict(), c.evidence)).collect()
}
