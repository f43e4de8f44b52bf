//! The loaded contacts of a stand.

use std::collections::HashMap;

use super::{BodyId, Party, SavedContact, Stand};

impl Stand<'_> {
    /// The loaded contacts between what is still present.
    pub(super) fn contacts(&self) -> Vec<SavedContact> {
        let mut contacts = Vec::new();
        self.world.remember(&mut contacts);
        let of_body: HashMap<BodyId, Party> =
            self.parties.iter().map(|(p, id)| (*id, *p)).collect();
        let saved = contacts.iter().filter_map(|c| {
            Some(SavedContact {
                between: [*of_body.get(&c.a)?, *of_body.get(&c.b)?],
                point_m: c.point,
                normal: c.normal,
                force_n: c.force,
                warm_start: c.warm_start,
                feature: c.feature,
            })
        });
        saved.collect()
    }
}
