//! Finding a moment of a run by stage and time.

use std::ops::Range;

use super::*;

/// Where a frame of a run is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct At {
    /// Number of the stage, from 0.
    pub stage: usize,
    /// Number of the frame in the stage, from 0.
    pub frame: usize,
}

/// How much farther from a frame than one interval of frames a time may lie, in s: rounding.
const BEYOND: f64 = 1e-4;

/// The moment of a run at a time in s since it began, in a stage named by its
/// number from 0 or its name. Without a time it is the end of the stage, without
/// a stage any may have that time; without both it is the end of the run.
///
/// # Errors
/// [`PictureError::Stage`] and [`PictureError::NoTime`], saying what there is.
pub fn at(run: &Playback, stage: Option<&str>, time: Option<f64>) -> Result<At, PictureError> {
    let chosen = stage.map(|asked| stage_of(run, asked)).transpose()?;
    let nothing = || PictureError::Stage("no stage `the last`; the run has none".to_owned());
    let last = chosen.or(run.stages.len().checked_sub(1)).ok_or_else(nothing)?;
    let Some(time) = time else {
        let frame = run.stages[last].frames.len().checked_sub(1).ok_or_else(nothing)?;
        return Ok(At { stage: last, frame });
    };
    let near = run.setup.observed_every().max(run.setup.look_interval) + BEYOND;
    let off = |at: &At| (frame_at(run, *at).time - time).abs();
    let nearest = frames_of(run, chosen).into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.filter(|at| off(at) <= near).ok_or_else(|| {
        let kept = stages_of(run, chosen).map(|n| {
            let stage = &run.stages[n];
            let end = |f: Option<&Frame>| f.map_or(f64::NAN, |f| f.time);
            let (first, last) = (end(stage.frames.first()), end(stage.frames.last()));
            match stage.kept {
                true => format!("{}: {} to {} s", stage.name, number(first), number(last)),
                false => format!("{}: its end alone, {} s", stage.name, number(last)),
            }
        });
        let allowed = format!("there are {}", kept.collect::<Vec<_>>().join(", "));
        PictureError::NoTime { asked_s: time, allowed }
    })
}

/// A frame of a run.
pub fn frame_at(run: &Playback, at: At) -> &Frame {
    &run.stages[at.stage].frames[at.frame]
}

/// Number of one stage, or of each.
fn stages_of(run: &Playback, only: Option<usize>) -> Range<usize> {
    only.map_or(0..run.stages.len(), |stage| stage..stage + 1)
}

/// The frames of one stage, or of all, in their order.
pub fn frames_of(run: &Playback, only: Option<usize>) -> Vec<At> {
    let frames =
        |stage: usize| (0..run.stages[stage].frames.len()).map(move |frame| At { stage, frame });
    stages_of(run, only).flat_map(frames).collect()
}

/// Number of a stage named by its number or by a name that it alone has.
pub fn stage_of(run: &Playback, asked: &str) -> Result<usize, PictureError> {
    let names = run.stages.iter().map(|stage| stage.name.as_str());
    MeantStage::one(asked, names, None).map_err(PictureError::Stage)
}

/// A moment with what came before it. A stage whose frames were not kept began as
/// the one before it ended.
pub fn moments(run: &Playback, at: At) -> Moments<'_> {
    let stage = &run.stages[at.stage];
    let before_stage = at.stage.checked_sub(1).and_then(|s| run.stages[s].frames.last());
    let began = if stage.kept { stage.frames.first() } else { before_stage };
    let before = at.frame.checked_sub(1).map(|n| &stage.frames[n]);
    // Two frames of one step tell no speed.
    Moments { now: frame_at(run, at), before, began }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::export::{PlayedStage, testing::laboratory};
    use crate::plain::assert_holds;

    /// A few grains that sink by 1 mm a frame: a stage with frames, one without.
    pub fn canned() -> Playback {
        let (setup, grains) = laboratory();
        let frame = |time: f64, z: f64| {
            let place = |n: usize| {
                let (column, row) = ((n % 4) as f64, (n / 4) as f64);
                Some(Pose::translation(0.018 * (column - 1.5), 0.018 * (row - 1.5), z))
            };
            let grains = (0..grains.grains.len()).map(place).collect();
            Frame { time, cylinder: true, grains, ..Frame::default() }
        };
        let frames = (0..4).map(|n| frame(0.08 * f64::from(n), 0.02 - 1e-3 * f64::from(n)));
        let stage = |name: &str, frames, kept| PlayedStage { name: name.to_owned(), frames, kept };
        let stages = vec![
            stage("fill_funnel", frames.collect(), true),
            stage("pour", vec![frame(1.0, 0.01)], false),
        ];
        Playback { scenario: "canned".to_owned(), setup, grains, stages }
    }

    #[test]
    fn moments_are_found_by_stage_and_time() {
        let run = canned();
        let found = |stage, time| at(&run, stage, time).expect("a moment");
        assert_eq!(found(None, None), At { stage: 1, frame: 0 }, "law: the end of the run");
        assert_eq!(found(Some("fill_funnel"), None), At { stage: 0, frame: 3 });
        assert_eq!(found(Some("0"), Some(0.09)), At { stage: 0, frame: 1 }, "law: the nearest");
        assert_eq!(found(None, Some(0.95)), At { stage: 1, frame: 0 }, "law: in any stage");
    }

    #[test]
    fn what_is_not_there_is_said_with_what_is() {
        let run = canned();
        let refused = |stage, time| at(&run, stage, time).expect_err("nothing there").to_string();
        for (said, words) in [
            (refused(Some("melt"), None), ["melt", "0 fill_funnel, 1 pour"]),
            (refused(Some("7"), None), ["`7`", "1 pour"]),
            (refused(None, Some(0.6)), ["0.6 s", "fill_funnel: 0 to 0.24 s"]),
            (refused(Some("pour"), Some(0.1)), ["its end alone", "1 s"]),
            (refused(None, Some(1e300)), [" at 1e300 s", "fill_funnel: 0 to 0.24 s"]),
        ] {
            assert_holds(&said, &words);
        }
    }

    /// Law: of several stages of a name none is taken; each has its number.
    #[test]
    fn several_stages_of_a_name_are_told_apart_by_number() {
        let mut run = canned();
        run.stages[0].name = "pour".to_owned();
        let said = at(&run, Some("pour"), None).expect_err("law: which of them?").to_string();
        assert!(said.contains("`pour`") && said.contains("0 or 1"), "law: said, got `{said}`");
        let found = at(&run, Some("0"), None).expect("law: by its number");
        assert_eq!(found, At { stage: 0, frame: 3 });
    }

    #[test]
    fn a_stage_without_frames_began_where_the_last_ended() {
        let run = canned();
        let ended = moments(&run, At { stage: 1, frame: 0 });
        assert_eq!(ended.began.map(|f| f.time), Some(0.24), "law: the end of the stage before");
        assert!(ended.before.is_none(), "law: no frame before the only one");
        let going = moments(&run, At { stage: 0, frame: 2 });
        assert_eq!(going.began.map(|f| f.time), Some(0.0), "law: its own first frame");
        assert_eq!(going.before.map(|f| f.time), Some(0.08));
    }
}
