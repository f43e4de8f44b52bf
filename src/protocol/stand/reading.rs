//! Reads the world back into the specimen, and watches what it finds.

use super::{
    BodyId, BodyState, Fate, Grain, GrainState, HashMap, Moment, Observer, Party, SavedContact,
    Specimen, Stand, Tally, Vector, WorldError, grain_name, level, name_of, spring_energy,
};
use crate::plain::components;

impl Stand<'_> {
    /// Shows the specimen at a time in s since the stage began; with the contacts of the moment, where
    /// stresses are measured.
    pub(super) fn show(&mut self, observer: &mut dyn Observer, time: f64, table: Vector) {
        let stresses = !self.setup.measures.regions.is_empty();
        if self.setup.sample_interval.is_some() {
            let Some((mut shown, moment)) = self.sample(time, table) else { return };
            if stresses {
                shown.state.contacts = self.contacts();
            }
            observer.observe(&shown, moment);
            return;
        }
        if stresses {
            self.specimen.state.contacts = self.contacts();
        }
        observer.observe(&self.specimen, self.moment(time, table));
        if stresses {
            self.specimen.state.contacts.clear();
        }
    }

    /// The specimen as it is now, and what was given and taken until now: in copies, so that looks and
    /// checks find what they find without samples between them. None where what is read is unphysical,
    /// which the next check reports.
    fn sample(&mut self, time: f64, table: Vector) -> Option<(Specimen, Moment)> {
        self.world.read(&mut self.snapshot);
        let now_s = self.midway.began_s + time;
        let name = |index: usize| self.name_of(BodyId(index as u32));
        self.check.check(&self.snapshot, now_s, name).ok()?;
        let mut watch = self.midway.watch.clone();
        watch.given(self.pieces.work);
        watch.pressed(self.pieces.pressed_work);
        watch.follow(&self.tally(), table, now_s);
        let mut shown = self.specimen.clone();
        let body = |id: &Option<BodyId>| self.snapshot.get((*id)?.0 as usize).copied().flatten();
        for (grain, id) in shown.state.bodies.iter_mut().zip(&self.grains) {
            if let Some(body) = body(id) {
                grain.body = body;
            }
        }
        if let Some(plate) = body(&self.plate) {
            shown.state.top_plate = Some(plate);
        }
        shown.state.time = now_s;
        self.pieces.take_sampled_loads(&mut shown.state, self.world.time_step());
        let balance = watch.balance;
        Some((shown, Moment { stage_time: time, table_velocity: table, balance }))
    }

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

    /// What a reader knows a body as.
    fn name_of(&self, id: BodyId) -> String {
        let party = self.parties.iter().find_map(|(party, of)| (*of == id).then_some(party));
        party.map_or_else(|| format!("body {}", id.0), |party| name_of(party, self.setup))
    }

    /// Begins to watch the bodies as the specimen has them; the table's peak
    /// speed and its velocity now in m/s.
    pub(super) fn begin_watch(&mut self, table: (f64, Vector)) {
        let of_weight = self.specimen.state.top_plate.and_then(|plate| self.of_weight(&plate));
        let Specimen { grains, state } = &self.specimen;
        let present = |(_, s): &(&Grain, &GrainState)| s.fate == Fate::Present;
        let bodies = grains.grains.iter().zip(&state.bodies).filter(present);
        let bodies = bodies.map(|(grain, s)| (grain.mass, &grain.inertia, &s.body));
        let plate = &self.of_plate;
        let plate = state.top_plate.iter().map(|s| (plate.mass, &plate.inertia, s));
        let lowest = self.whereabouts.lowest();
        let began = self.midway.began_s + self.midway.steps as f64 * self.world.time_step();
        let bodies = bodies.chain(plate).chain(self.pieces.free_motion(state));
        let begins = self.midway.watch.begin(bodies, lowest, self.setup.gravity, table, began);
        if begins {
            self.midway.watch.weigh(of_weight);
        }
        // Grains between pieces may be loaded far beyond their weight, by what held them before; what
        // a weight on the plate has stored in contacts comes back as it is taken off.
        if begins && (!state.pieces.is_empty() || self.midway.part > 0) {
            let kinetic = self.pieces.pressed_motion(state).map_or(0.0, |(kinetic, _)| kinetic);
            let springs = spring_energy(&state.contacts, &self.setup.engine);
            self.midway.watch.press(kinetic, springs);
        }
    }

    /// Energy in J of the weight on the top plate, which moves as this does; none without one.
    fn of_weight(&self, plate: &BodyState) -> Option<f64> {
        let (loaded, alone) = (&self.of_plate, &self.setup.plate);
        let (mass, inertia) = (loaded.mass - alone.mass, loaded.inertia - alone.inertia);
        let weight = std::iter::once((mass, &inertia, plate));
        (mass > 0.0).then(|| Tally::of(weight, self.setup.gravity).energy)
    }

    /// Sums over the bodies of the last snapshot that are still followed.
    pub(super) fn tally(&self) -> Tally {
        let body = |id: &Option<BodyId>| self.snapshot.get((*id)?.0 as usize)?.as_ref();
        let grains = self.specimen.grains.grains.iter().zip(&self.grains);
        let grains = grains.filter_map(|(g, id)| Some((g.mass, &g.inertia, body(id)?)));
        let of_weight = body(&self.plate).and_then(|plate| self.of_weight(plate));
        let plate = &self.of_plate;
        let plate = body(&self.plate).map(|s| (plate.mass, &plate.inertia, s));
        let pieces = self.pieces.free_motion(&self.specimen.state);
        let free = Tally::of(grains.chain(plate).chain(pieces), self.setup.gravity);
        let free = free.with_weight(of_weight);
        let pressed = self.pieces.pressed_motion(&self.specimen.state);
        pressed.map_or(free, |(kinetic, fastest)| free.and(kinetic, fastest))
    }

    /// Reads the world, checks it, and only then takes it over into the specimen, at a time in s
    /// since the stage began. Gives what a check has to tell, with the time of the run.
    pub(super) fn read_back(
        &mut self,
        time: f64,
        table: Vector,
    ) -> Result<Option<String>, WorldError> {
        self.world.read(&mut self.snapshot);
        let name = |index: usize| self.name_of(BodyId(index as u32));
        let now_s = self.midway.began_s + time;
        self.check.check(&self.snapshot, now_s, name)?;
        let unphysical = |what: String| WorldError::Unphysical { time_s: now_s, what };
        let held = |id: &BodyId| self.snapshot.get(id.0 as usize).is_some_and(Option::is_some);
        if let Some(lost) = self.grains.iter().flatten().chain(&self.plate).find(|id| !held(id)) {
            let what = format!("{} is no longer in the engine", self.name_of(*lost));
            return Err(unphysical(what));
        }
        if !self.setup.pieces.is_empty() {
            // What is pressed may have sunk, with grains on it.
            self.whereabouts.floor_at(self.pieces.lowest(&self.specimen.state));
        }
        let lowest = self.whereabouts.lowest();
        if let Some(what) = self.pieces.lost(self.setup, lowest, &self.specimen.state) {
            return Err(unphysical(what));
        }
        let plate = self.plate.and_then(|id| self.snapshot[id.0 as usize]);
        let height = |body: BodyState| level(body.pose.translation.vector, &self.specimen.state).z;
        if plate.is_some_and(|body| height(body) < lowest) {
            return Err(unphysical("the top plate fell off the cylinder".to_owned()));
        }
        let now = self.tally();
        let watch = &mut self.midway.watch;
        watch.given(std::mem::take(&mut self.pieces.work));
        watch.pressed(std::mem::take(&mut self.pieces.pressed_work));
        watch.checks += 1;
        let finding = watch.look(&now, table, now_s).map_err(unphysical)?;
        let mut gone = false;
        let table_x = self.specimen.state.table_x;
        for index in 0..self.grains.len() {
            let Some(id) = self.grains[index] else { continue };
            let Some(body) = self.snapshot[id.0 as usize] else { continue };
            let at = body.pose.translation.vector;
            let place = level(at, &self.specimen.state);
            self.specimen.state.bodies[index].body = body;
            let mut fate = self.whereabouts.note(index, &place, table_x);
            // No grain should get into a piece; whether it comes out on the other side is not waited for.
            let in_piece = match fate {
                Fate::Present => self.pieces.solids.holding(&at, &self.specimen.state).next(),
                _ => None,
            };
            if in_piece.is_some() {
                fate = Fate::ThroughWall;
            }
            if fate == Fate::Present {
                continue;
            }
            self.specimen.state.bodies[index].fate = fate;
            self.grains[index] = None;
            gone = true;
            self.world.remove(id)?;
            if fate == Fate::ThroughWall {
                self.midway.watch.through_walls += 1;
                let (grain, [x, y, z]) = (grain_name(index), components::<3>((at * 1e3).into()));
                let (what, seen) = match in_piece.map(|n| &self.setup.pieces[n].name) {
                    Some(name) => (format!("was found with its centroid in `{name}`"), "at"),
                    None => ("passed through a wall".to_owned(), "last seen at"),
                };
                self.midway
                    .warnings
                    .push(format!("{grain} {what} at {now_s:.3} s, {seen} ({x}, {y}, {z}) mm"));
            }
        }
        if let Some(id) = self.plate {
            self.specimen.state.top_plate = self.snapshot[id.0 as usize];
        }
        self.specimen.state.time = now_s;
        self.looked_at.0 = self.specimen.state.table();
        self.looked_at.1.clone_from(&self.specimen.state.pieces);
        if gone {
            let left = self.tally();
            self.midway.watch.taken_away(left);
        }
        Ok(finding.map(|text| format!("at {now_s:.3} s {text}")))
    }
}
