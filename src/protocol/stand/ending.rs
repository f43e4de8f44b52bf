//! What looks at the specimen while a stage goes on: whether the conditions that end it hold, and
//! how pieces are pressed to keep a mean stress.

use super::{Stand, centroids};
use crate::protocol::ending::Subject;
use crate::specimen::Opening;

impl Stand<'_> {
    /// Looks, at a time in s since the stage began, `every` seconds after the look before, whether
    /// the conditions end it for the first time; from then on what moves dies away.
    pub(super) fn ends_now(&mut self, time: f64, every: f64) -> bool {
        let Self { endings: Some(endings), pieces, specimen, midway, places, .. } = self else {
            return false;
        };
        if midway.judged.reached_s.is_some() {
            return false;
        }
        let found = endings.each.iter().enumerate().map(|(n, ending)| match &ending.subject {
            Subject::Force(_, along) => pieces.take_felt(n).dot(along),
            Subject::Displacement(which, along) => {
                let by = pieces.moved(which, &specimen.state);
                along.map_or(by.norm(), |along| by.dot(&along))
            }
            Subject::Turn(which) => pieces.turned(which, &specimen.state, time),
            Subject::Flow(opening) => Opening::mass_passed(opening, places, specimen),
        });
        let found: Vec<f64> = found.collect();
        if endings.each.iter().any(|ending| matches!(ending.subject, Subject::Flow(_))) {
            *places = centroids(specimen);
        }
        let ends = midway.judged.look_at_all(endings, &found, time, every);
        if ends {
            pieces.end_at(time);
        }
        ends
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
