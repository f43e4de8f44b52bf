//! Which stage is asked of the store, and when what is found there is believed.

use super::*;

/// Which stage is asked of the store, and what it must be to be believed.
#[derive(Clone, Copy)]
pub struct AskedStage<'a> {
    /// What it is.
    pub identity: &'a StageIdentity,
    /// SHA-256 of the specimen that it begins with, as the stage before was
    /// stored; none for the first of a run.
    pub began_with: Option<&'a str>,
    /// Whether what was found can be the end of this stage; why it cannot.
    pub plausible: &'a dyn Fn(&StoredStage) -> Result<(), String>,
}
