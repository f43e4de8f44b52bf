//! The same programme by other engines and settings, as columns beside ours.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::MeanSettlement;
use crate::paper::{Claim, Interval, NotValid, Verdict};

/// What one engine, or one choice of settings, made of the claims.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Head of the column: the engine, its contacts, and what is not default.
    pub label: String,
    /// What must be equal for two columns to stand side by side: a hash of
    /// everything but the engine.
    pub programme: String,
    /// Findings by the claims' names.
    pub claims: BTreeMap<String, Finding>,
    /// Whether stock Bullet found and solved the contacts.
    #[serde(default)]
    pub stock_bullet: bool,
    /// Its settlement under continuous vibration; null where it has none.
    #[serde(default)]
    pub settlement: Option<MeanSettlement>,
}

/// What one column has for one claim.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What the runs show, in the claim's unit; null where they are missing.
    pub ours: Option<f64>,
    /// Smallest and largest value, where several make `ours`.
    pub spread: Option<Interval>,
    /// Whether the statement was met.
    pub verdict: Verdict,
    /// What runs show that are left out, where no other does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_valid: Option<NotValid>,
}

impl Column {
    /// The column of judged claims.
    pub fn new(label: &str, programme: &str, claims: &[Claim]) -> Self {
        let finding = |c: &Claim| Finding {
            ours: c.ours,
            spread: c.spread,
            verdict: c.verdict,
            not_valid: c.not_valid,
        };
        Self {
            label: label.to_owned(),
            programme: programme.to_owned(),
            claims: claims.iter().map(|c| (c.id.clone(), finding(c))).collect(),
            stock_bullet: false,
            settlement: None,
        }
    }

    /// With its settlement, and with whose contacts it is.
    #[must_use]
    pub fn with_settlement(self, settlement: Option<MeanSettlement>, stock_bullet: bool) -> Self {
        Self { settlement, stock_bullet, ..self }
    }
}
