//! Runs one stage on a specimen; holds those of funnel and cylinder, while `laboratory` has those
//! of pieces.

use std::sync::atomic::AtomicBool;

use super::*;
use crate::plain::{counted, in_number};
use crate::scenario::{PlaceTopPlateSpec, SlowPluviationSpec};
use crate::specimen::FunnelState;

/// Runs one stage on a specimen, as it is at the end of the stage before;
/// from `midway`, where it was interrupted.
///
/// # Errors
/// See [`StageError`]; on a failed simulation it holds the last good specimen.
pub fn run(
    setup: &Setup,
    make_world: WorldMaker,
    specimen: Specimen,
    stage: &StageSpec,
    midway: Option<Midway>,
    observer: &mut dyn Observer,
    cancel: &AtomicBool,
) -> Result<StageOutcome, StageError> {
    let specimen = laboratory::begun(setup, specimen);
    let mut lab = Laboratory { setup, make_world, stage, midway, observer, cancel };
    match *stage {
        StageSpec::FillFunnel { time_limit_s } => lab.fill(specimen, time_limit_s),
        StageSpec::SlowPluviation(ref stage) => lab.slow_pluviation(specimen, stage),
        StageSpec::Pour { falling_height_mm, time_limit_s } => {
            lab.pour(specimen, from_mm(falling_height_mm), time_limit_s)
        }
        StageSpec::PlaceTopPlate(ref stage) => lab.place_top_plate(specimen, stage),
        StageSpec::Vibrate { .. } => lab.vibrate(specimen),
        StageSpec::Deposit(ref stage) => lab.deposit(specimen, stage),
        StageSpec::Move(ref stage) => lab.move_pieces(specimen, stage),
        StageSpec::Press(ref stage) => lab.press(specimen, stage),
        StageSpec::Release(ref stage) => lab.release(specimen, stage),
        StageSpec::Remove(ref stage) => lab.remove(specimen, stage),
        StageSpec::Rest { duration_s } => {
            Ok(lab.carry_out(specimen, &Course::of_length(duration_s))?.stand.finish())
        }
    }
}

impl Laboratory<'_> {
    fn fill(&mut self, mut specimen: Specimen, limit: f64) -> StageResult {
        // Where the funnel stands does not matter before it opens; here it
        // stands on the cylinder, at falling height zero.
        let opening_height = self.setup.cylinder.height;
        let bare = Funnel::new(&self.setup.funnel, opening_height, 0.0)?;
        let mixed = grains::mix(&specimen.grains, self.setup.seed, self.setup.configuration);
        let poses = grains::rain(
            &specimen.grains,
            &mixed,
            bare.top_radius - scale::COLLAR_CLEARANCE.at(&self.setup.scale),
            bare.top_height,
        )
        .map_err(|error| StageError::Placing(error.to_string()))?;
        let highest = poses
            .iter()
            .zip(&specimen.grains.grains)
            .map(|(p, g)| p.translation.z + g.shape.radius_about_origin())
            .fold(bare.top_height, f64::max);
        for (state, pose) in specimen.state.bodies.iter_mut().zip(&poses) {
            state.body = BodyState::at_rest(*pose);
            state.fate = Fate::Present;
        }
        specimen.state.funnel = Some(FunnelState { opening_height, lid: true });
        specimen.state.cylinder = false;

        let collar = highest - bare.top_height;
        let course = Course { collar, ..Course::until_settled(limit) };
        Ok(self.settled(specimen, &course, "filling the funnel", limit)?.stand.finish())
    }

    fn slow_pluviation(
        &mut self,
        mut specimen: Specimen,
        stage: &SlowPluviationSpec,
    ) -> StageResult {
        let Setup { seed, configuration, .. } = *self.setup;
        let state = &mut specimen.state;
        *state = SpecimenState::before_everything(state.bodies.len());
        for grain in &mut state.bodies {
            grain.fate = Fate::Waiting;
        }
        let radius = from_mm(stage.base_diameter_mm) / 2.0;
        state.base = Some(base::build(&stage.base, radius, &specimen.grains, seed, configuration));
        let feed = Feed {
            rate: Rate::Grains(stage.feed_rate_grains_per_s),
            outlet: Outlet::Spout {
                drop_height: from_mm(stage.drop_height_mm),
                radius: from_mm(stage.spout_diameter_mm) / 2.0,
            },
            grains: None,
        };
        let limit_s = stage.time_limit_s;
        let course = Course { feed: Some(feed), ..Course::until_settled(limit_s) };
        let left = "had not been fed: each waits until the one before it is out of its way";
        let (mut outcome, settled) = self.feed(specimen, &course, "slow pluviation", left)?;
        outcome.settling = Some(Settling { time_s: outcome.simulated, limit_s, settled });
        Ok(outcome)
    }

    fn pour(&mut self, mut specimen: Specimen, falling_height: f64, limit: f64) -> StageResult {
        let Some(FunnelState { opening_height: was, lid: true }) = specimen.state.funnel else {
            return Err(self.refused("it needs grains in a funnel closed by its lid"));
        };
        // The filled funnel is lifted to its place as it is.
        let opening_height = self.setup.cylinder.height + falling_height;
        for state in specimen.state.bodies.iter_mut().filter(|s| s.fate == Fate::Present) {
            state.body.pose.translation.vector.z += opening_height - was;
        }
        for contact in &mut specimen.state.contacts {
            contact.point_m.z += opening_height - was;
        }
        specimen.state.funnel = Some(FunnelState { opening_height, lid: false });
        specimen.state.cylinder = true;

        let course = Course::until_settled(limit);
        let Ended { mut stand, settled, .. } = self.settled(specimen, &course, "pouring", limit)?;
        // The funnel is taken away, with what hangs in it.
        let cylinder = &self.setup.cylinder;
        let (rim, radius) = (cylinder.height, cylinder.radius);
        let (mut hanging, mut heaped) = (0, 0);
        let bodies = stand.specimen.state.bodies.iter_mut();
        for grain in bodies.filter(|s| s.fate == Fate::Present) {
            let at = grain.body.pose.translation.vector;
            if let Some(fate) = above_rim(&at, rim, radius, opening_height) {
                grain.fate = fate;
                let taken = fate == Fate::LeftInFunnel;
                let is_heap = taken && is_below_funnel(&at, opening_height);
                hanging += usize::from(taken && !is_heap);
                heaped += usize::from(is_heap);
            }
        }
        stand.take_funnel_away();
        let when = if settled { "everything had come to rest" } else { "the stage ended" };
        if hanging > 0 {
            let (who, were) = (counted(hanging, "grain"), in_number(hanging, "was", "were"));
            stand.warn(format!("{who} {were} left hanging in the funnel when {when}"));
        }
        if heaped > 0 {
            let (who, were) = (counted(heaped, "grain"), in_number(heaped, "was", "were"));
            let them = in_number(heaped, "it", "them");
            stand.warn(format!(
                "{who} lay heaped above the rim when {when}, and {were} taken away with the funnel: \
                 the cylinder is too low for {them}"
            ));
        }
        Ok(came_to_rest(stand, settled, 0.0, limit))
    }

    fn place_top_plate(
        &mut self,
        mut specimen: Specimen,
        stage: &PlaceTopPlateSpec,
    ) -> StageResult {
        if !specimen.state.cylinder || specimen.state.funnel.is_some() {
            return Err(self.refused("it needs grains poured into the cylinder"));
        }
        let placing = Placing::of(stage, self.setup);
        let highest = specimen.present().map(|i| specimen.top(i)).fold(0.0, f64::max);
        let release = scale::PLATE_RELEASE.at(&self.setup.scale);
        let height = highest + release + self.setup.plate.thickness / 2.0;
        let pose = placing.pose(specimen.state.table(), height);
        specimen.state.top_plate = Some(BodyState::at_rest(pose));
        let limit = placing.limit;
        let course = Course { placing: Some(placing), ..Course::until_settled(limit) };
        let Ended { stand, settled, .. } =
            self.settled(specimen, &course, "placing the top plate", limit)?;
        // Each part may take as long as the limit.
        let after = stand.part_began_s();
        Ok(came_to_rest(stand, settled, after, limit))
    }

    fn vibrate(&mut self, specimen: Specimen) -> StageResult {
        let Some(motion) = self.stage.motion().filter(|_| specimen.state.cylinder) else {
            return Err(self.refused("it needs grains poured into the cylinder"));
        };
        let (shaken, limit) = (motion.total(), self.stage.settle_limit());
        let until = Until { limit: shaken + limit, calm_from: Some(shaken) };
        let course = Course { motion: Some(motion), ..Course::until(until) };
        let Ended { stand, settled, .. } =
            self.settled(specimen, &course, "rest after the vibration", limit)?;
        Ok(came_to_rest(stand, settled, shaken, limit))
    }
}

/// The end of a stage that waits, after a time in s, for everything to settle, at most for a limit
/// in s.
fn came_to_rest(stand: Stand<'_>, settled: bool, after: f64, limit_s: f64) -> StageOutcome {
    let mut outcome = stand.finish();
    let time_s = outcome.simulated - after;
    outcome.settling = Some(Settling { time_s, limit_s, settled });
    outcome
}

/// What became of a grain whose centroid is above the cylinder's rim when a pour ends, all in m:
/// it hangs in the funnel, or lies on the wall. Grains piled above the rim, which may reach into
/// the funnel, are taken away with it.
fn above_rim(at: &Vector, rim: f64, radius: f64, opening_height: f64) -> Option<Fate> {
    let on_wall = at.z < opening_height && at.xy().norm() > radius;
    (at.z > rim).then_some(if on_wall { Fate::Spilled } else { Fate::LeftInFunnel })
}

/// Whether a grain that is taken away with the funnel lay below its opening, on the heap above the
/// rim, and did not hang in it.
fn is_below_funnel(at: &Vector, opening_height: f64) -> bool {
    at.z < opening_height
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grain_above_the_rim_hangs_in_the_funnel_or_lies_on_the_wall() {
        let (rim, radius, opening) = (0.145, 0.036, 0.195);
        for (x, z, expected) in [
            (0.0, 0.1, None),
            (0.05, 0.1, None),
            (0.044, 0.146, Some(Fate::Spilled)),
            (0.0, 0.146, Some(Fate::LeftInFunnel)),
            (0.044, 0.2, Some(Fate::LeftInFunnel)),
        ] {
            let got = above_rim(&Vector::new(0.0, x, z), rim, radius, opening);
            assert_eq!(got, expected, "law: a grain {x} m off the axis, {z} m high");
        }
        let at_rim = above_rim(&Vector::new(0.044, 0.0, 0.146), rim, radius, rim);
        assert_eq!(at_rim, Some(Fate::LeftInFunnel), "law: a funnel at the rim holds it");
    }
}
