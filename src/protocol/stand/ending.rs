//! Whether the conditions that end a stage hold.

use super::{Endings, Stand};
use crate::protocol::ending::Subject;
use crate::specimen::{Opening, centroids};

impl Stand<'_> {
    /// Watches for conditions from now on.
    pub(in crate::protocol) fn end_when(&mut self, endings: Endings) {
        for (n, ending) in endings.each.iter().enumerate() {
            if let Subject::Force(pieces, _) = &ending.subject {
                self.pieces.feel(n, pieces);
            }
        }
        self.places = centroids(&self.specimen);
        self.endings = Some(endings);
    }

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
            Subject::Way(which, along) => {
                let way = pieces.moved(which, &specimen.state);
                along.map_or(way.norm(), |along| way.dot(&along))
            }
            Subject::Turn(which) => pieces.turned(which, &specimen.state),
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
}
