//! Runs the course of any stage in a laboratory, segment by segment.

use std::sync::atomic::AtomicBool;

use super::*;
use crate::plain::counted;

pub(super) type StageResult = Result<StageOutcome, StageError>;

/// A laboratory in which a stage is to be done.
pub(super) struct Laboratory<'a> {
    pub(super) setup: &'a Setup,
    pub(super) make_world: WorldMaker<'a>,
    pub(super) stage: &'a StageSpec,
    pub(super) midway: Option<Midway>,
    pub(super) observer: &'a mut dyn Observer,
    pub(super) cancel: &'a AtomicBool,
}

/// A stage that has run its course.
pub(super) struct Ended<'a> {
    pub(super) stand: Stand<'a>,
    pub(super) settled: bool,
    pub(super) feeder: Option<Feeder>,
}

impl<'a> Laboratory<'a> {
    /// Runs a stage segment by segment, from where it was interrupted or else from the specimen.
    pub(super) fn carry_out(
        &mut self,
        specimen: Specimen,
        course: &Course,
    ) -> Result<Ended<'a>, StageError> {
        let Specimen { grains, state } = specimen;
        let mut midway = match &self.midway {
            Some(midway) => midway.clone(),
            None => Midway {
                kept_stress: course.keeper.as_ref().map(|(_, kept)| *kept),
                ..Midway::at_start(state, course.collar, self.setup)
            },
        };
        loop {
            let fed = midway.fed.take();
            let part = midway.part;
            let mut stand =
                Stand::new(self.setup, self.make_world, grains.clone(), course, midway)?;
            let begin = |feed| Feeder::new(self.setup, &stand.specimen, feed, fed);
            let mut feeder = course.feed.clone().map(begin);
            let end = stand.segment(course, feeder.as_mut(), self.observer, self.cancel);
            match end.map_err(|source| stand.failed(source))? {
                SegmentEnd::OfPart { settled } if part < course.last_part() => {
                    if !settled {
                        // Said at once: no summary will, if a later part fails.
                        let text = not_settled("seating the top plate", course.until.limit);
                        self.observer.warn(&text);
                        stand.warn(text);
                    }
                    midway = stand.pause(feeder);
                    midway.next_part();
                    continue;
                }
                SegmentEnd::OfPart { settled } => return Ok(Ended { stand, settled, feeder }),
                SegmentEnd::Seam => midway = stand.pause(feeder),
                SegmentEnd::Cancelled => return Err(StageError::Cancelled),
            }
            if let ControlFlow::Break(()) = self.observer.seam(&midway) {
                return Err(StageError::Cancelled);
            }
        }
    }

    /// The same, with a warning that names `what` was done where not everything settled within a
    /// limit in s.
    pub(super) fn settled(
        &mut self,
        specimen: Specimen,
        course: &Course,
        what: &str,
        limit: f64,
    ) -> Result<Ended<'a>, StageError> {
        let mut ended = self.carry_out(specimen, course)?;
        if !ended.settled {
            ended.stand.warn(not_settled(what, limit));
        }
        Ok(ended)
    }

    pub(super) fn refused(&self, reason: impl Into<Cow<'static, str>>) -> StageError {
        StageError::OutOfOrder { stage: self.stage.name(), reason: reason.into() }
    }

    /// Runs a stage that lets grains go, and warns of those left; also whether everything settled,
    /// which nothing does while grains are still to come.
    pub(super) fn feed(
        &mut self,
        specimen: Specimen,
        course: &Course,
        what: &str,
        left: &str,
    ) -> Result<(StageOutcome, bool), StageError> {
        let Ended { mut stand, settled, feeder } = self.carry_out(specimen, course)?;
        let (limit, time) = (course.until.limit, stand.time_s());
        // Less than a step before its end, a stage has reached its limit.
        let stuck = feeder.as_ref().is_some_and(Feeder::is_stuck) && time < limit - 1e-3;
        let met = feeder.as_ref().filter(|_| stuck).map_or_else(Vec::new, |feeder| {
            feeder.in_the_way(&stand.specimen, &Solids::of(self.setup))
        });
        let met: Vec<String> =
            met.into_iter().map(|n| format!("`{}`", self.setup.pieces[n].name)).collect();
        let fall = feeder.as_ref().and_then(|feeder| feeder.fall(&stand.specimen));
        let waiting = feeder.map_or(0, |feeder| feeder.waiting());
        if stuck {
            stand.warn(format!(
                "the stage ended after {time:.2} s, before its limit of {limit} s: everything was at \
                 rest, and no place was free for the next of {} still to come{}",
                counted(waiting, "grain"),
                match met.is_empty() {
                    true => String::new(),
                    false => format!("; pieces in its area: {}", met.join(", ")),
                }
            ));
        } else if waiting > 0 {
            stand.warn(format!("after {limit} s {} {left}", counted(waiting, "grain")));
        } else if !settled {
            stand.warn(not_settled(what, limit));
        }
        Ok((StageOutcome { fall, ..stand.finish() }, settled))
    }
}

pub(super) fn not_settled(what: &str, limit: f64) -> String {
    format!("after {limit} s of {what} the grains had not settled by the stated criterion")
}
