//! The course of a stage: what is let go, what moves, and how long it goes on.

use super::*;

/// How long to go on.
#[derive(Clone, Copy)]
pub(super) struct Until {
    /// At most so long, in s since the stage, or the part of it, began.
    pub limit: f64,
    /// From when on, in s, to end as soon as everything has settled; none where it does not count.
    pub calm_from: Option<f64>,
}

/// What happens in a stage, whichever stage it is.
pub(super) struct Course {
    pub(super) until: Until,
    /// Height in m of the funnel's collar.
    pub(super) collar: f64,
    pub(super) motion: Option<TableMotion>,
    pub(super) feed: Option<Feed>,
    pub(super) placing: Option<Placing>,
    /// The pieces of a laboratory that move.
    pub(super) drive: Option<Drive>,
    pub(super) endings: Option<Endings>,
    /// What keeps a mean stress, and how that begins.
    pub(super) keeper: Option<(StressKeeper, KeptStress)>,
}

impl Course {
    pub(super) fn until(until: Until) -> Self {
        let (motion, feed, placing, drive) = (None, None, None, None);
        Self { until, collar: 0.0, motion, feed, placing, drive, endings: None, keeper: None }
    }

    pub(super) fn until_settled(limit: f64) -> Self {
        Self::until(Until { limit, calm_from: Some(0.0) })
    }

    pub(super) fn of_length(limit: f64) -> Self {
        Self::until(Until { limit, calm_from: None })
    }

    /// How long it goes on where the condition that ends it held at a time in s: a motion dies
    /// away and settles, and without one it is over.
    pub(super) fn until_after(&self, reached: Option<f64>) -> Until {
        let Some(time) = reached else { return self.until };
        let Some(drive) = &self.drive else { return Until { limit: time, calm_from: None } };
        let end = drive.motion.ended_at(time).duration;
        let settling = self.until.limit - drive.motion.duration;
        Until { limit: end + settling, calm_from: self.until.calm_from.map(|_| end) }
    }

    /// What moves, where the condition that ends it held at a time in s.
    pub(super) fn drive_after(&self, reached: Option<f64>) -> Option<Drive> {
        let mut drive = self.drive.clone()?;
        if let Some(time) = reached {
            drive.motion = drive.motion.ended_at(time);
        }
        Some(drive)
    }

    pub(super) fn last_part(&self) -> u32 {
        self.placing.map_or(1, |p| p.parts()) - 1
    }
}
