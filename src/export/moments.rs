//! The moments of a run that are handed on: frames of its stages, thinned out,
//! and the end of each with all that is known there.

use super::parts::parts;
use super::*;
use crate::scale;
use crate::specimen::PieceState;

/// Least time in s between two frames where nothing else is asked for: every
/// fifth of those that are kept.
pub const DEFAULT_EVERY: f64 = 0.4;

/// Stages of a run, in their order, with all that was kept of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Moments {
    /// Name of the scenario.
    pub scenario: String,
    /// The laboratory.
    pub setup: Setup,
    /// The grains, in the order of the frames' grains.
    pub grains: Arc<GrainSet>,
    /// The apparatus.
    pub parts: Vec<Part>,
    /// The stages.
    pub stages: Vec<StageMoments>,
}

/// What was kept of a stage.
#[derive(Debug, Clone, PartialEq)]
pub struct StageMoments {
    /// Its name, as in the scenario; `rest_test` for the rest test.
    pub name: String,
    /// What was seen of it, by time; none where no frames were kept.
    pub frames: Vec<Frame>,
    /// Its beginning: its first frame, or else the end of the stage before;
    /// none where neither is known.
    pub begin: Option<Frame>,
    /// Its end.
    pub end: SpecimenState,
}

/// One moment that is handed on.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment<'a> {
    /// Index of its stage among those of [`Moments`].
    pub stage: usize,
    /// Where everything was.
    pub frame: Frame,
    /// The frame before it in its stage, or after it where it is the first.
    neighbour: Option<&'a Frame>,
    /// Where the stage began.
    begin: Option<&'a Frame>,
    /// All that is known at the end of a stage; none elsewhere.
    pub end: Option<&'a SpecimenState>,
}

/// Reads the stages of a run folder, or one of them, by the names and numbers of
/// [`super::read_run`].
///
/// # Errors
/// [`ExportError`], naming the file or what was asked for.
pub fn read_moments(folder: &Path, stage: Option<&str>) -> Result<Moments, ExportError> {
    let manifest = Manifest::of(folder)?;
    let before = |number: usize| number.checked_sub(1).and_then(|n| manifest.stages.get(n));
    let chosen: Vec<(String, &StageEntry, Option<&StageEntry>)> = match stage {
        None => {
            let all = manifest.stages.iter().enumerate();
            all.map(|(n, entry)| (entry.stage.clone(), entry, before(n))).collect()
        }
        Some(asked) => {
            let (number, name, entry) = manifest.find(asked)?;
            vec![(name, entry, before(number.unwrap_or(manifest.stages.len())))]
        }
    };
    let setup = manifest.setup()?;
    let grains = Arc::new(manifest.grains()?);
    let mut stages = Vec::new();
    for (name, entry, before) in chosen {
        let (end, frames) = manifest.stage(entry, &grains, FramesRead::All)?;
        let frames = frames.unwrap_or_default();
        let begin = match (frames.first(), before) {
            (Some(first), _) => Some(first.clone()),
            (None, Some(before)) => Some(Frame::of(&manifest.state(before, &grains)?)),
            (None, None) => None,
        };
        stages.push(StageMoments { name, frames, begin, end });
    }
    let base = stages.iter().find_map(|s| s.end.base.as_ref());
    let parts =
        parts(&setup, &grains, base).map_err(|reason| ExportError::apparatus(folder, reason))?;
    Ok(Moments { scenario: manifest.scenario.name, setup, grains, parts, stages })
}

impl Moments {
    /// Those to hand on, by time, at least about `every` s apart in a stage: its beginning, frames,
    /// and its end. Where a stage begins when the one before it ends, only that end is taken.
    pub fn thinned(&self, every: f64) -> Vec<Moment<'_>> {
        let mut taken: Vec<Moment> = Vec::new();
        let early = scale::FRAME_EARLY.at(&self.setup.scale);
        for (stage, of) in self.stages.iter().enumerate() {
            let begin = of.begin.as_ref();
            let last = taken.last().map_or(f64::NEG_INFINITY, |m| m.frame.time);
            let mut due = f64::NEG_INFINITY;
            for (n, frame) in of.frames.iter().enumerate() {
                if frame.time + early < due {
                    continue;
                }
                // From round times on, so that delays do not add up.
                due = if n == 0 { frame.time + every } else { (due + every).max(frame.time) };
                let at_an_end = frame.time <= last || frame.time >= of.end.time - early;
                if !at_an_end {
                    let neighbour = of.frames.get(if n == 0 { 1 } else { n - 1 });
                    let frame = frame.clone();
                    taken.push(Moment { stage, frame, neighbour, begin, end: None });
                }
            }
            let frame = Frame::of(&of.end);
            taken.push(Moment { stage, frame, neighbour: None, begin, end: Some(&of.end) });
        }
        taken
    }
}

impl Moment<'_> {
    /// The specimen at this moment: velocities and contacts only at the end of a stage.
    pub fn specimen(&self, grains: &Arc<GrainSet>) -> Specimen {
        let state = self.end.cloned().unwrap_or_else(|| as_state(&self.frame));
        Specimen { grains: grains.clone(), state }
    }

    /// Speed of a grain's centroid in m/s: at the end of a stage its own; else
    /// the mean between this frame and the one before (in the first of a
    /// stage, the one after). None where it is not known.
    pub fn speed(&self, grain: usize) -> Option<f64> {
        if let Some(end) = self.end {
            return Some(end.bodies[grain].body.linear_velocity.norm());
        }
        let other = self.neighbour?;
        let time = (self.frame.time - other.time).abs();
        let way =
            self.frame.grains[grain]?.translation.vector - other.grains[grain]?.translation.vector;
        (time > 0.0).then(|| way.norm() / time)
    }

    /// How far a grain is, relative to the table, from where it was when the
    /// stage began, in m. None where that is not known.
    pub fn displacement(&self, grain: usize) -> Option<f64> {
        let begin = self.begin?;
        let table = Vector::new(self.frame.table_x - begin.table_x, 0.0, 0.0);
        let way = self.frame.grains[grain]?.translation.vector
            - begin.grains[grain]?.translation.vector
            - table;
        Some(way.norm())
    }
}

/// A frame as a state, with nothing moving and no contacts. Grains that were
/// no longer there count as spilled; what became of them a frame does not say.
pub fn as_state(frame: &Frame) -> SpecimenState {
    let grain = |pose: &Option<Pose>| GrainState {
        body: BodyState::at_rest(pose.unwrap_or_else(Pose::identity)),
        fate: if pose.is_some() { Fate::Present } else { Fate::Spilled },
    };
    let piece = |pose: &Option<Pose>| PieceState {
        present: pose.is_some(),
        ..PieceState::standing(pose.unwrap_or_else(Pose::identity))
    };
    SpecimenState {
        bodies: frame.grains.iter().map(grain).collect(),
        funnel: frame.funnel,
        cylinder: frame.cylinder,
        base: frame.base.as_deref().cloned(),
        top_plate: frame.top_plate.map(BodyState::at_rest),
        table_x: frame.table_x,
        pieces: frame.pieces.iter().map(piece).collect(),
        time: frame.time,
        ..SpecimenState::before_everything(0)
    }
}

#[cfg(test)]
mod tests {
    use crate::{export::testing, measure::testing::assert_near};

    #[test]
    fn what_is_taken_is_far_enough_apart_and_ends_with_the_stage() {
        let moments = testing::moments(&[21, 11], 0.08);
        for (every, expected) in [(0.08, 31), (0.4, 7), (10.0, 3)] {
            let taken = moments.thinned(every);
            // Two ends, the beginning, and what lies between.
            assert_eq!(taken.len(), expected, "law: moments every {every} s");
            let times: Vec<f64> = taken.iter().map(|m| m.frame.time).collect();
            assert!(times.windows(2).all(|t| t[0] < t[1]), "law: no time twice, got {times:?}");
            let ends: Vec<f64> =
                taken.iter().filter(|m| m.end.is_some()).map(|m| m.frame.time).collect();
            let expected: Vec<f64> = moments.stages.iter().map(|s| s.end.time).collect();
            assert_eq!(ends, expected, "law: the end of every stage is there");
        }
    }

    #[test]
    fn without_frames_the_ends_are_taken() {
        let mut moments = testing::moments(&[21, 11], 0.08);
        for stage in &mut moments.stages {
            stage.frames.clear();
        }
        assert_eq!(moments.thinned(0.08).len(), 2, "law: the ends alone");
    }

    /// Law: a grain that rises with v on a table of the velocity u has the speed
    /// √(v² + u²), and is v t away from where it began, seen from the table.
    #[test]
    fn speed_and_way_are_those_of_the_grains() {
        let moments = testing::moments(&[21], 0.08);
        let near = |what: &str, t: f64, got: Option<f64>, expected: f64| {
            assert_near(&format!("{what} at {t} s"), expected, got.expect("it is known"), 1e-9);
        };
        for moment in moments.thinned(0.08) {
            let t = moment.frame.time;
            near("displacement in m", t, moment.displacement(0), testing::SPEED * t);
            let other = if t == 0.0 { 0.08 } else { t - 0.08 };
            let table = (testing::table_x(t) - testing::table_x(other)) / 0.08;
            let mean = testing::SPEED.hypot(table);
            let expected = if moment.end.is_some() { testing::SPEED } else { mean };
            near("speed in m/s", t, moment.speed(0), expected);
            assert_eq!(moment.displacement(1), None, "a grain that is gone has none");
        }
    }
}
