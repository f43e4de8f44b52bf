//! The test stand: a world built from a specimen, and the one loop that steps it.

mod ending;
mod moving;
mod reading;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::*;
use crate::specimen::{FunnelState, GrainState, centroids};
use crate::world::World;

/// A world with everything in it.
pub(super) struct Stand<'a> {
    setup: &'a Setup,
    world: Box<dyn World + Send>,
    /// As last read from the world.
    pub(super) specimen: Specimen,
    /// The table and the pieces when it was last read: these go on between two looks.
    looked_at: (Vector, Vec<PieceState>),
    /// Bodies of the grains; `None` for those no longer present.
    grains: Vec<Option<BodyId>>,
    plate: Option<BodyId>,
    /// What the plate is, with what lies on it.
    of_plate: TopPlate,
    /// Every body that is there, by what it is.
    parties: HashMap<Party, BodyId>,
    /// Bodies standing on the table, with their poses at rest.
    on_table: Vec<(BodyId, Pose)>,
    pieces: Pieces,
    whereabouts: Whereabouts,
    check: RunTimeCheck,
    snapshot: Snapshot,
    /// What ends the stage, and where the grains were when that was last looked at.
    endings: Option<Endings>,
    places: Vec<Option<Vector>>,
    keeper: Option<StressKeeper>,
    /// Where the stage is; the specimen is in the field of that name, and the spout is handed in.
    midway: Midway,
}

/// How a segment ended.
pub(super) enum SegmentEnd {
    /// With the stage or a part of it, and whether everything had settled.
    OfPart {
        settled: bool,
    },
    /// Because its time was up.
    Seam,
    Cancelled,
}

impl<'a> Stand<'a> {
    /// Builds the world of a specimen: cylinder, funnel and plate where its
    /// state says they stand, every present grain with its velocity. What moves, presses or ends
    /// the stage is that of the course.
    pub(super) fn new(
        setup: &'a Setup,
        make_world: WorldMaker,
        grains: Arc<GrainSet>,
        course: &Course,
        mut midway: Midway,
    ) -> Result<Self, StageError> {
        let of_plate = match course.placing {
            Some(placing) => placing.plate(&setup.plate, midway.part),
            None => setup.plate.clone(),
        };
        let nothing = SpecimenState::before_everything(0);
        let mut specimen =
            Specimen { grains, state: std::mem::replace(&mut midway.state, nothing) };
        let under_way = midway.steps > 0;
        let gravity = Vector::new(0.0, 0.0, -setup.gravity);
        let pairs = base::pairs(setup, &specimen.state);
        let mut world = make_world(&setup.engine, gravity, &pairs)
            .map_err(|source| failed(source, &specimen))?;
        let base = base::base_pieces(&specimen.grains, specimen.state.base.as_ref())?;
        let state = &specimen.state;
        let up = |f: FunnelState| Funnel::new(&setup.funnel, f.opening_height, midway.collar_m);
        let funnel = state.funnel.map(up).transpose()?;

        let drive = course.drive_after(midway.judged.reached_s);
        let mut on_table = Vec::new();
        let mut parties = HashMap::new();
        let build = || -> Result<_, WorldError> {
            if state.cylinder {
                for (n, piece) in setup.cylinder.pieces.iter().enumerate() {
                    let mut body = wall_piece(piece, Motion::Kinematic);
                    if under_way {
                        body.state.pose = moved(&piece.pose, &state.table());
                    }
                    let id = world.add(&body)?;
                    parties.insert(Party::Other(Other::Cylinder(n)), id);
                    on_table.push((id, piece.pose));
                }
            }
            if let Some(funnel) = &funnel {
                let lid = state.funnel.filter(|f| f.lid).map(|_| &funnel.lid);
                for (n, piece) in funnel.pieces.iter().chain(lid).enumerate() {
                    let id = world.add(&wall_piece(piece, Motion::Static))?;
                    parties.insert(Party::Other(Other::Funnel(n)), id);
                }
            }
            for (n, (piece, material)) in base.iter().enumerate() {
                let body = Body { material: *material, ..wall_piece(piece, Motion::Static) };
                parties.insert(Party::Other(Other::Base(n)), world.add(&body)?);
            }
            let plate = state
                .top_plate
                .map(|state| {
                    world.add(&Body {
                        shape: of_plate.shape.clone(),
                        motion: Motion::Free { mass: of_plate.mass, inertia: of_plate.inertia },
                        material: Material::Plate,
                        state,
                    })
                })
                .transpose()?;
            let grains = specimen.grains.grains.iter().zip(&state.bodies);
            let grains = grains.map(|(grain, s)| match s.fate {
                Fate::Present => world.add(&free_grain(grain, s.body)).map(Some),
                _ => Ok(None),
            });
            let grains = grains.collect::<Result<Vec<_>, WorldError>>()?;
            let began = &midway.pieces_began;
            let world = world.as_mut();
            let pieces = Pieces::add(world, setup, state, began, drive, &mut parties)?;
            if under_way {
                pieces.recall(world, midway.steps)?;
            }
            Ok((plate, grains, pieces))
        };
        let (plate, mut grains, mut pieces) =
            build().map_err(|source| failed(source, &specimen))?;
        parties.extend(plate.map(|id| (Party::Other(Other::TopPlate), id)));
        let present = grains.iter().enumerate();
        parties.extend(present.filter_map(|(n, id)| Some((Party::Grain(n), (*id)?))));
        let remembered = remembered(&state.contacts, &parties);
        world.recall(&remembered).map_err(|source| failed(source, &specimen))?;
        let mut whereabouts = Whereabouts::of(setup, &specimen, funnel.as_ref());
        if !setup.pieces.is_empty() {
            whereabouts.floor_at(pieces.lowest(state));
        }
        if under_way {
            // Whoever leaves must have been seen inside.
            for index in specimen.present() {
                let place = level(specimen.centroid(index), state);
                whereabouts.note(index, &place, state.table_x);
            }
        } else if !setup.pieces.is_empty() {
            // What pieces carried that are gone is below all that there is.
            let lowest = whereabouts.lowest();
            let is_below = |s: &GrainState| s.body.pose.translation.z < lowest;
            let bodies = specimen.state.bodies.iter_mut().zip(&mut grains);
            let mut fallen = Vec::new();
            for (state, id) in bodies.filter(|(s, id)| id.is_some() && is_below(s)) {
                state.fate = Fate::Spilled;
                fallen.extend(id.take());
            }
            for id in fallen {
                world.remove(id).map_err(|source| failed(source, &specimen))?;
            }
        }
        if let Some(endings) = &course.endings {
            pieces.feel(endings);
        }
        Ok(Self {
            places: centroids(&specimen),
            looked_at: (specimen.state.table(), specimen.state.pieces.clone()),
            setup,
            world,
            specimen,
            grains,
            plate,
            of_plate,
            parties,
            on_table,
            pieces,
            whereabouts,
            check: check(setup, 0.0),
            snapshot: Snapshot::new(),
            endings: course.endings.clone(),
            keeper: course.keeper.as_ref().map(|(keeper, _)| keeper.clone()),
            midway,
        })
    }

    /// Steps the world until the stage or its segment ends. A feeder lets grains go
    /// at every check; nothing counts as settled while some are still to come.
    pub(super) fn segment(
        &mut self,
        course: &Course,
        mut feeder: Option<&mut Feeder>,
        observer: &mut dyn Observer,
        cancel: &AtomicBool,
    ) -> Result<SegmentEnd, WorldError> {
        let dt = self.world.time_step();
        let steps_in = |time: f64| (time / dt).round() as u64;
        let part_began = self.midway.part_began;
        // By what has ended the stage: its last step, from which on it may settle, and the end
        // of shaking, which is observed as that of the stage is.
        let ends = |reached: Option<f64>| {
            let until = course.until_after(reached);
            let calm_from = until.calm_from.map(|time| part_began + steps_in(time));
            let shaken = calm_from.filter(|step| *step > part_began);
            (part_began + steps_in(until.limit).max(1), calm_from, shaken)
        };
        let (mut last_step, mut calm_from, mut shaken) = ends(self.midway.judged.reached_s);
        let motion = course.motion.as_ref();
        let check_every = steps_a_check(self.setup, dt);
        let segment = segment_steps(self.setup, self.specimen.grains.grains.len());
        let seam = segment.map(|segment| (self.midway.steps / segment + 1).saturating_mul(segment));
        let look_every = motion
            .map(|m| m.fastest_component().map_or(1, |f| steps_a_look(f, dt)))
            .filter(|n| *n < check_every);
        let mut settled = false;
        let table_velocity = |time: f64| motion.map_or(Vector::zeros(), |m| m.velocity(time, dt));
        let peak = motion.map_or(self.pieces.peak_speed(self.setup), |m| m.peak_speed_in_steps(dt));
        self.check = check(self.setup, peak);
        self.begin_watch((peak, table_velocity(self.midway.steps as f64 * dt)));
        if self.midway.steps == 0 {
            let moment = self.moment(0.0, table_velocity(0.0));
            observer.observe(&self.specimen, moment);
        }
        if let Some(motion) = motion.filter(|_| self.midway.steps > 0) {
            self.recall_table(motion)?;
        }
        while self.midway.steps < last_step {
            let step = self.midway.steps + 1;
            let time = step as f64 * dt;
            if let Some(motion) = motion {
                self.move_table(motion.displacement(time))?;
            }
            self.pieces.advance(self.world.as_mut(), &mut self.specimen.state, time)?;
            let started = Instant::now();
            let stepped = self.world.step();
            self.midway.engine_s += started.elapsed().as_secs_f64();
            self.midway.steps = step;
            stepped?;
            self.pieces.gather(self.world.as_ref(), &mut self.specimen.state)?;

            let looks = time >= self.midway.next_look_s - dt / 2.0;
            let sampled = self.setup.is_sampled(step, dt, looks);
            let regular = step.is_multiple_of(check_every);
            if !(regular || looks || step == last_step || Some(step) == shaken) {
                if look_every.is_some_and(|n| step.is_multiple_of(n)) {
                    self.world.read(&mut self.snapshot);
                    let now = self.tally();
                    let time = self.midway.began_s + time;
                    self.midway.watch.follow(&now, table_velocity(step as f64 * dt), time);
                }
                if sampled {
                    self.show(observer, time, table_velocity(time));
                }
                continue;
            }
            if cancel.load(Ordering::Relaxed) {
                return Ok(SegmentEnd::Cancelled);
            }
            let told = self.midway.warnings.len();
            let finding = self.read_back(time, table_velocity(time))?;
            for text in self.midway.warnings[told..].iter().chain(&finding) {
                observer.warn(text);
            }
            if regular && self.ends_now(time, check_every as f64 * dt) {
                (last_step, calm_from, shaken) = ends(Some(time));
            }
            if calm_from.is_some_and(|from| step > from) {
                let fed = feeder.as_ref().is_none_or(|f| f.is_empty());
                let calm = fed && self.calm();
                let since = self.midway.calm_since_s.unwrap_or(time);
                self.midway.calm_since_s = calm.then_some(since);
                settled = calm && time - since >= self.setup.settle.hold;
            }
            // Nothing at rest makes room.
            let stuck = feeder.as_deref().is_some_and(Feeder::is_stuck);
            // What settles has the forces that the last look asked for; those until the next look
            // are set now.
            if regular && let Some(text) = self.keep_mean_stress(check_every as f64 * dt) {
                observer.warn(&text);
            }
            let is_end = step == last_step || Some(step) == shaken || settled || stuck;
            if looks {
                self.midway.next_look_s += self.setup.look_interval;
            }
            if looks || is_end {
                self.pieces.take_loads(&mut self.specimen.state, dt);
                self.look_at_presses(time)?;
                self.midway.residuals.extend(self.world.solver_residual());
            }
            if sampled || is_end {
                self.show(observer, time, table_velocity(time));
            }
            if looks || is_end {
                observer.look(&self.specimen, time);
            }
            if settled || stuck {
                break;
            }
            if let Some(feeder) = feeder.as_deref_mut().filter(|_| step < last_step) {
                let state = &self.specimen.state;
                let clear = |at: &Vector, r: f64| self.pieces.solids.is_clear(at, r, state);
                let let_go = feeder.due(&self.specimen, time, &clear);
                let is_blocked = let_go.is_empty() && feeder.is_blocked(time);
                feeder.note_blocked(is_blocked && self.calm());
                for (grain, pose) in let_go {
                    self.let_go(grain, pose)?;
                    observer.let_go(grain, &pose.translation.vector);
                }
            }
            if Some(step) == seam && step < last_step {
                return Ok(SegmentEnd::Seam);
            }
        }
        Ok(SegmentEnd::OfPart { settled })
    }

    fn moment(&self, stage_time: f64, table_velocity: Vector) -> Moment {
        Moment { stage_time, table_velocity, balance: self.midway.watch.balance }
    }

    /// Takes the stage out of the world, to go on in another.
    pub(super) fn pause(self, feeder: Option<Feeder>) -> Midway {
        let contacts = self.contacts();
        let mut midway = self.midway;
        midway.state = self.specimen.state;
        midway.state.contacts = contacts;
        midway.fed = feeder.map(|feeder| feeder.so_far);
        midway
    }

    /// Adds a grain that was waiting.
    fn let_go(&mut self, index: usize, pose: Pose) -> Result<(), WorldError> {
        let state = BodyState::at_rest(pose);
        let grain = &self.specimen.grains.grains[index];
        let id = self.world.add(&free_grain(grain, state))?;
        self.midway.watch.let_go((grain.mass, &grain.inertia, &state));
        self.grains[index] = Some(id);
        self.parties.insert(Party::Grain(index), id);
        self.specimen.state.bodies[index] = GrainState { body: state, fate: Fate::Present };
        if let Some(place) = self.places.get_mut(index) {
            *place = Some(pose.translation.vector);
        }
        Ok(())
    }

    /// Takes the funnel away, with the grains that count as no longer present: their shapes and
    /// contacts are not read from the world any more.
    pub(super) fn take_funnel_away(&mut self) {
        self.specimen.state.funnel = None;
        let bodies = &self.specimen.state.bodies;
        self.parties.retain(|party, _| match party {
            Party::Grain(n) => bodies[*n].fate == Fate::Present,
            Party::Other(other) => !matches!(other, Other::Funnel(_)),
        });
        for (id, _) in self.grains.iter_mut().zip(bodies).filter(|(_, s)| s.fate != Fate::Present) {
            *id = None;
        }
    }

    /// Takes the specimen out of the world, with a warning where a condition was to end the stage
    /// and did not.
    pub(super) fn finish(mut self) -> StageOutcome {
        let until = self.endings.as_ref().map(|endings| endings.found(&self.midway.judged));
        if let Some(found) = until.as_ref().filter(|found| !found.reached) {
            self.warn(found.line());
        }
        self.specimen.state.contacts = self.contacts();
        let mut corners = Vec::new();
        self.world.corners(&mut corners);
        let of_grain = |id: &Option<BodyId>| corners.get(id.as_ref()?.0 as usize)?.clone();
        StageOutcome {
            corners: self.grains.iter().map(of_grain).collect(),
            settling: None,
            fall: None,
            until,
            simulated: self.midway.steps as f64 * self.world.time_step(),
            effective: self.world.effective(),
            specimen: self.specimen,
            steps: self.midway.steps,
            engine_time: Duration::from_secs_f64(self.midway.engine_s),
            warnings: self.midway.warnings,
            watch: self.midway.watch,
            residuals: self.midway.residuals,
        }
    }

    /// The failure of its world, with the specimen as it was when it was last found good. Without
    /// contacts: those at hand are of an earlier time.
    pub(super) fn failed(&self, source: WorldError) -> StageError {
        let mut last_good = self.specimen.clone();
        let (table, pieces) = &self.looked_at;
        last_good.state.set_table(*table);
        last_good.state.pieces.clone_from(pieces);
        last_good.state.contacts.clear();
        failed(source, &last_good)
    }

    /// When the part that goes on began, in s since the stage began.
    pub(super) fn part_began_s(&self) -> f64 {
        self.midway.part_began as f64 * self.world.time_step()
    }

    /// How long the stage has taken so far, in s.
    pub(super) fn time_s(&self) -> f64 {
        self.midway.steps as f64 * self.world.time_step()
    }

    pub(super) fn warn(&mut self, warning: String) {
        self.midway.warnings.push(warning);
    }
}

/// A world that failed, with the last state of a specimen that was found good.
fn failed(source: WorldError, specimen: &Specimen) -> StageError {
    StageError::World { source, last_good: Box::new(specimen.clone()) }
}
