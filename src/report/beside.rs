//! The same programme by other engines and settings, as columns beside ours.

use serde::{Deserialize, Serialize};

use super::MeanSettlement;
use crate::paper::Claim;

/// What one engine, or one choice of settings, made of the claims.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Head of the column: the engine, its contacts, and what is not default.
    pub label: String,
    /// What must be equal for two columns to stand side by side: a hash of
    /// everything but the engine.
    pub programme: String,
    /// The claims, judged.
    pub claims: Vec<Claim>,
    /// Whether stock Bullet found and solved the contacts.
    pub stock_bullet: bool,
    /// Its settlement under continuous vibration; null where it has none.
    pub settlement: Option<MeanSettlement>,
}
