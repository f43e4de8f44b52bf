//! Keeps the mean stress of a region while a stage goes on.

use super::{Stand, StressKeeper};

impl Stand<'_> {
    /// Keeps a mean stress from now on.
    pub(in crate::protocol) fn keep_stress(&mut self, keeper: StressKeeper) {
        self.keeper = Some(keeper);
    }

    /// Says by what forces pieces are pressed until the next look, `every` seconds later. What a
    /// reader must know is noted, and given back.
    pub(super) fn keep_mean_stress(&mut self, every: f64) -> Option<String> {
        let (Some(keeper), Some(mut kept)) = (self.keeper.take(), self.midway.kept_stress) else {
            return None;
        };
        self.specimen.state.contacts = self.contacts();
        let state = &mut self.specimen.state;
        let told = keeper.look(&mut kept, &self.midway.pieces_began, state, every);
        state.contacts.clear();
        self.midway.kept_stress = Some(kept);
        self.keeper = Some(keeper);
        if let Some(told) = &told {
            self.warn(told.clone());
        }
        told
    }
}
