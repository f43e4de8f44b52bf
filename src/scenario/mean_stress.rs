//! Pressed pieces whose forces keep a mean stress while others move.

use super::*;

parts! {
/// Which pieces keep the mean stress in which region.
pub struct KeepMeanStressSpec {
    /// Name of a region of `measures.regions`. The mean stress of its contacts, a third of the
    /// trace, is to stay what it was when the stage began.
    pub region: String, length 1 to 40;
    /// Names of pieces that forces press: all these forces are multiplied by the same factor.
    pub pieces: Vec<String>, length 1 to 100;
    /// Time in s over which the mean stress is smoothed, and within which the factor follows it.
    pub window_s: f64, else "window", above 0.0 to 60.0;
}
}

defaults! {
    pub(super) window: f64 = 0.1;
}
