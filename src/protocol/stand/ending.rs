//! Whether the condition that ends a stage holds.

use super::{Ending, Stand};
use crate::protocol::ending::Subject;
use crate::specimen::{Opening, centroids};

impl Stand<'_> {
    /// Watches for a condition from now on.
    pub(in crate::protocol) fn end_when(&mut self, ending: Ending) {
        if let Subject::Force(pieces, _) = &ending.subject {
            self.pieces.feel(pieces);
        }
        self.places = centroids(&self.specimen);
        self.ending = Some(ending);
    }

    /// Looks, at a time in s since the stage began, `every` seconds after the look before, whether
    /// the condition holds for the first time; from then on what moves dies away.
    pub(super) fn ends_now(&mut self, time: f64, every: f64) -> bool {
        let Self { ending: Some(ending), pieces, specimen, midway, places, .. } = self else {
            return false;
        };
        if midway.judged.reached_s.is_some() {
            return false;
        }
        let found = match &ending.subject {
            Subject::Force(_, along) => pieces.take_felt().dot(along),
            Subject::Way(which, along) => {
                let way = pieces.moved(which, &specimen.state);
                along.map_or(way.norm(), |along| way.dot(&along))
            }
            Subject::Flow(opening) => {
                let passed = Opening::mass_passed(opening, places, specimen);
                *places = centroids(specimen);
                passed
            }
        };
        let holds = midway.judged.look(ending, found, every);
        if holds {
            midway.judged.reached_s = Some(time);
            pieces.end_at(time);
        }
        holds
    }
}
