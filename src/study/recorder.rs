//! Measures what is observed during a stage.

use std::time::Instant;

use super::*;
use super::{
    checks::{last_look_at_overlap, look_at_overlap},
    laboratory::LaboratoryRecorder,
};
use crate::measure::{body_energy, largest_speed, mean_grain_height, plate_position};
use crate::protocol::{Moment, Observer};
use crate::record::Observed;
use crate::specimen::FreeState;
use crate::world::BodyState;

/// An observer that turns every observation into a row of `series.csv`.
pub struct Recorder<'a, F: FnMut(&SeriesRow)> {
    setup: &'a Setup,
    stage: &'a StageSpec,
    /// Whether the table moves along y, and along z.
    table_moves: [bool; 2],
    /// Beginning and end of the rests of the stage, in s since it began.
    rests: Vec<(f64, f64)>,
    /// At what time of the run, in s, the stage begins.
    pub(super) start: f64,
    /// What was observed so far; its wall time is that before `began`.
    pub(super) observed: Observed,
    began: Instant,
    laboratory: LaboratoryRecorder,
    frames: Option<FrameWriter>,
    /// Where checkpoints are kept, in a stage that has segments.
    pub(super) checkpoints: Option<&'a Checkpoints>,
    /// Why one could not be.
    fault: Option<FileError>,
    /// Told of every row as it comes.
    on_row: F,
    /// Told of what a check finds.
    pub(super) on_finding: &'a dyn Fn(&str),
}

/// The cylinder where the specimen has it, the space over a pile's base, or around all grains
/// of a laboratory of pieces.
pub fn container(setup: &Setup, specimen: &Specimen) -> Container {
    if let Some(base) = &specimen.state.base {
        return measure::over(base, &specimen.grains);
    }
    if !setup.pieces.is_empty() {
        return Container::around(specimen);
    }
    Container {
        centre_x: specimen.state.table_x,
        radius: setup.cylinder.radius,
        height: setup.cylinder.height,
    }
}

impl<'a, F: FnMut(&SeriesRow)> Recorder<'a, F> {
    /// A recorder for one stage; `frames` get every state that is observed.
    pub fn new(
        setup: &'a Setup,
        stage: &'a StageSpec,
        frames: Option<FrameWriter>,
        on_row: F,
    ) -> Self {
        Self {
            setup,
            stage,
            table_moves: stage.motion().map_or([false; 2], |m| m.moves_along_y_z()),
            rests: checks::rests(stage, &setup.scale),
            start: 0.0,
            observed: Observed::default(),
            began: Instant::now(),
            laboratory: LaboratoryRecorder::new(setup),
            frames,
            checkpoints: None,
            fault: None,
            on_row,
            on_finding: &|_| {},
        }
    }

    /// Height of a pile above its base in m; none without a base.
    fn pile_height(&mut self, specimen: &Specimen) -> Option<f64> {
        specimen.state.base.as_ref()?;
        let level = *self
            .observed
            .reference
            .base_level_m
            .get_or_insert_with(|| measure::base_level(specimen).unwrap_or(0.0));
        Some(measure::pile_top(specimen).map_or(0.0, |top| (top - level).max(0.0)))
    }

    /// Potential energy of grains, plate and free pieces in J.
    fn potential(&self, specimen: &Specimen) -> f64 {
        let (gravity, still) = (self.setup.gravity, Vector::zeros());
        let of_plate = |body: &BodyState| {
            let plate = &self.setup.plate;
            body_energy(body, plate.mass, &plate.inertia, gravity, &still).potential
        };
        let plate = specimen.state.top_plate.as_ref().map_or(0.0, of_plate);
        let free = specimen.state.pieces.iter().filter_map(|piece| piece.free);
        let pieces: f64 = free.map(|f| f.mass_kg * gravity * f.body.pose.translation.z).sum();
        grain_energy(specimen, gravity, &still).potential + plate + pieces
    }

    /// Kinetic energy in J of what moves, relative to a table of a velocity in m/s.
    fn kinetic(&self, specimen: &Specimen, table: &Vector) -> f64 {
        let gravity = self.setup.gravity;
        let of = |body: &BodyState, mass: f64, inertia: &Vector| {
            body_energy(body, mass, inertia, gravity, table).kinetic()
        };
        let plate = &self.setup.plate;
        let of_plate = specimen.state.top_plate.as_ref();
        let of_plate = of_plate.map_or(0.0, |body| of(body, plate.mass, &plate.inertia));
        let pieces = self.setup.pieces.iter().zip(&specimen.state.pieces);
        let of_pieces = pieces.map(|(piece, state)| {
            let free = |free: FreeState| {
                of(&free.body, free.mass_kg, &(piece.principal_frame().1 * free.mass_kg))
            };
            state.press.map_or(0.0, |press| press.kinetic_energy()) + state.free.map_or(0.0, free)
        });
        grain_energy(specimen, gravity, table).kinetic() + of_plate + of_pieces.sum::<f64>()
    }

    /// Keeps the heights of the grains there at those rows of a rest from which numerical creep may
    /// be asked for, the first and those about its middle; times in s since the stage began.
    fn note_sinking(&mut self, specimen: &Specimen, there: &[usize], stage_time: f64) {
        let rest = self.rests.iter().copied().find(|rest| checks::is_within(stage_time, *rest));
        let sinking = &mut self.observed.sinking;
        let Some((from, to)) = rest else { return sinking.begin() };
        let before = self.observed.rows.last().map(|row| row.time_s - self.start);
        let is_first = before.is_none_or(|time| !checks::is_within(time, (from, to)));
        if is_first {
            sinking.begin();
        }
        let middle = f64::midpoint(from, to.min(self.stage.longest()));
        let near = (stage_time - middle).abs() <= 2.0 * self.setup.observed_every();
        let there = there.iter().map(|&grain| (grain, specimen.centroid(grain).z)).collect();
        sinking.note(self.start + stage_time, there, is_first || near);
    }

    /// Looks once more, at a finished stage of a length in s.
    pub fn end(&mut self, specimen: &Specimen, length: f64) {
        let (overlap, time) = (&mut self.observed.overlap, self.start + length);
        if let Some(text) = last_look_at_overlap(overlap, specimen, length, time) {
            (self.on_finding)(&text);
        }
    }

    /// Goes on from what was observed before. `specimen` is where it goes on.
    pub fn go_on(&mut self, observed: Observed, specimen: &Specimen) {
        self.laboratory.go_on(specimen);
        self.observed = observed;
    }

    /// Counts the wall time that has passed since it was last counted.
    fn count_time(&mut self) {
        self.observed.wall_s += self.began.elapsed().as_secs_f64();
        self.began = Instant::now();
    }

    /// Why a checkpoint could not be kept, if that is so.
    pub fn fault(&mut self) -> Option<FileError> {
        self.fault.take()
    }

    /// What was observed, and its frames.
    pub fn into_parts(mut self) -> (Observed, Option<FrameWriter>) {
        self.count_time();
        (self.observed, self.frames)
    }
}

/// What matters most of a row, in a few words for a progress line; `all` is the number of grains.
pub fn note(row: &SeriesRow, all: usize) -> String {
    let grains = format!("{} of {}", row.grains_in_cylinder, counted(all, "grain"));
    let surface = row.mean_surface_mm.filter(|surface| *surface > 0.0);
    match (row.settlement_mm, row.pile_height_mm, surface) {
        (Some(settlement), _, _) => format!("settlement {settlement:.1} mm"),
        (_, Some(pile), _) => format!("{grains} on the base, pile {pile:.0} mm high"),
        (_, _, Some(surface)) => format!("{grains} in, surface {surface:.0} mm"),
        _ if row.grains_in_cylinder > 0 => format!("{grains} in"),
        _ => String::new(),
    }
}

impl<F: FnMut(&SeriesRow)> Observer for Recorder<'_, F> {
    fn observe(&mut self, specimen: &Specimen, moment: Moment) {
        let table = moment.table_velocity;
        let at = specimen.state.table();
        let potential = self.potential(specimen);
        let specimen = &*specimen.on_level_table();
        let state = &specimen.state;
        let (surface, inside, there) = if state.cylinder || state.base.is_some() {
            let container = container(self.setup, specimen);
            let surface =
                HeightMap::of(specimen, &container, height_cell_over(&container, &specimen.grains))
                    .map_or(0.0, |map| map.standing_height().mean_surface);
            let there = container.members(specimen);
            (Some(surface), there.len(), there)
        } else {
            let present: Vec<usize> = specimen.present().collect();
            // The built-in cylinder is empty until it stands; pieces have no such surface.
            let (surface, inside) = match state.pieces.is_empty() {
                true => (Some(0.0), 0),
                false => (None, present.len()),
            };
            (surface, inside, present)
        };
        let grain_height = mean_grain_height(specimen, &there);
        self.note_sinking(specimen, &there, moment.stage_time);
        let plate = &self.setup.plate;
        let position = state.top_plate.map(|p| plate_position(&p, plate.thickness));
        let kinetic = self.kinetic(specimen, &table);
        let plate_height_mm = position.map(|p| to_mm(p.height));
        let mean_surface_mm = surface.map(to_mm);
        let begins = self.observed.rows.is_empty();
        let before = &mut self.observed.reference.before_vibration_mm;
        if matches!(self.stage, StageSpec::Vibrate { .. }) {
            match before {
                None => *before = mean_surface_mm.map(|surface| (plate_height_mm, surface)),
                // The plate was laid after an earlier vibration.
                Some((plate, _)) if begins => *plate = plate.or(plate_height_mm),
                Some(_) => {}
            }
        }
        let before = *before;
        let [moves_y, moves_z] = self.table_moves;
        let row = SeriesRow {
            time_s: self.start + moment.stage_time,
            stage: 0,
            plate_height_mm,
            settlement_mm: before.and_then(|(p, _)| Some(p? - plate_height_mm?)),
            surface_settlement_mm: before.and_then(|(_, s)| Some(s - mean_surface_mm?)),
            kinetic_energy_j: kinetic,
            table_x_mm: to_mm(state.table_x),
            mean_surface_mm,
            // A stored stage has a number in every row; the series of a run leaves it out where it
            // is that of no grain.
            mean_grain_height_mm: Some(to_mm(grain_height.unwrap_or(0.0))),
            grains_in_cylinder: inside as u32,
            plate_tilt_deg: position.map(|p| p.tilt.to_degrees()),
            largest_speed_m_per_s: largest_speed(specimen, &table),
            pile_height_mm: self.pile_height(specimen).map(to_mm),
            table_y_mm: moves_y.then(|| to_mm(at.y)),
            table_z_mm: moves_z.then(|| to_mm(at.z)),
        };
        if let Some(frames) = &mut self.frames {
            frames.add(state, row.time_s);
        }
        self.laboratory.observe(specimen, &mut self.observed.laboratory);
        (self.on_row)(&row);
        self.observed.rows.push(row);
        self.observed.energy.push(EnergyRow {
            potential_energy_j: potential,
            work_input_j: moment.balance.input,
            dissipated_j: moment.balance.dissipated,
        });
    }

    fn look(&mut self, specimen: &Specimen, stage_time: f64) {
        let specimen = &*specimen.on_level_table();
        if self.setup.sample_interval.is_some() {
            self.laboratory.look_at_flow(specimen, &mut self.observed.laboratory);
        }
        let (of, time) = ((self.stage, &self.setup.scale), self.start + stage_time);
        let found = look_at_overlap(&mut self.observed.overlap, of, specimen, stage_time, time);
        if let Some(text) = found {
            (self.on_finding)(&text);
        }
    }

    fn let_go(&mut self, grain: usize, at: &Vector) {
        self.laboratory.let_go(grain, at);
    }

    fn warn(&mut self, finding: &str) {
        (self.on_finding)(finding);
    }

    fn seam(&mut self, midway: &Midway) -> ControlFlow<()> {
        self.laboratory.leg_ends(&midway.state, &mut self.observed.laboratory);
        let Some(checkpoints) = self.checkpoints else { return ControlFlow::Continue(()) };
        self.count_time();
        self.fault = checkpoints.keep(midway, &self.observed, self.frames.as_mut()).err();
        if self.fault.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::protocol::EnergyBalance;
    use crate::record::mean_drop_mm;
    use crate::study::plan::PlannedRun;
    use crate::study::tests::{planned, scenario};

    /// Grains in the cylinder, four in each of several layers.
    fn poured(run: &PlannedRun) -> Specimen {
        let mut state = SpecimenState::before_everything(run.grains.grains.len());
        state.cylinder = true;
        for (n, grain) in state.bodies.iter_mut().enumerate() {
            let side = |turned: bool| if turned { 0.012 } else { -0.012 };
            let height = 0.01 + 0.015 * (n / 4) as f64;
            grain.body.pose = Pose::translation(side(n % 2 == 1), side(n % 4 > 1), height);
            grain.fate = Fate::Present;
        }
        Specimen { grains: run.grains.clone(), state }
    }

    fn at(stage_time: f64) -> Moment {
        let balance = EnergyBalance::default();
        Moment { stage_time, table_velocity: Vector::zeros(), balance }
    }

    /// Law: a grain that falls out in the second half of a rest does not make the others sink:
    /// their numerical creep is the speed at which these do, also over the whole rest.
    #[test]
    fn a_grain_that_falls_out_of_a_rest_is_no_creep() {
        let run = planned(scenario(50.0));
        let setup = Setup::new(&run.scenario).expect("a laboratory");
        let rest = StageSpec::Rest { duration_s: 10.0 };
        for speed in [0.0, 10.0] {
            let mut recorder = Recorder::new(&setup, &rest, None, |_| {});
            recorder.start = 3.7;
            let mut specimen = poured(&run);
            let mut before = 0.0;
            for time in (0..=125).map(|n| 0.08 * f64::from(n)) {
                for grain in &mut specimen.state.bodies {
                    grain.body.pose.translation.vector.z -= speed * 1e-6 * (time - before);
                }
                before = time;
                let falls_out = time > 9.6;
                specimen.state.bodies[0].fate =
                    if falls_out { Fate::Spilled } else { Fate::Present };
                recorder.observe(&specimen, at(time));
            }
            let Observed { rows, sinking, .. } = recorder.observed;
            let of_means = checks::creep_um_per_s(&rows, &[]).expect("a creep");
            assert!(of_means.abs() > 100.0, "law: means over whoever is there differ, {of_means}");
            let got = checks::creep_um_per_s(&rows, &sinking.sunk).expect("a creep");
            let law = "law: numerical creep of the grains that are left";
            assert!(
                (got - speed).abs() < 1e-6,
                "{law}, expected {speed} µm/s, got {got} µm/s, tolerance 1e-6 µm/s"
            );
            let watched = checks::creep(&rest, &rows, &sinking.sunk, &setup.scale);
            assert_eq!((watched.looks, watched.beyond), (1, u64::from(speed > 5.0)), "{law}");
            let whole = mean_drop_mm(&rows[0], &rows[125], &sinking.sunk).expect("a drop");
            let expected = 1e-3 * speed * 10.0;
            assert!(
                (whole - expected).abs() < 1e-9,
                "{law}, over all of it expected {expected} mm, got {whole} mm, tolerance 1e-9 mm"
            );
        }
    }

    /// Law: the settlement of a plate that was laid after a vibration counts from the beginning of
    /// the next one; the surface's counts from the first, and a plate's goes on from its own.
    #[test]
    fn a_plate_laid_after_a_vibration_settles_from_the_next_one_on() {
        let run = planned(scenario(50.0));
        let setup = Setup::new(&run.scenario).expect("a laboratory");
        let vibrate: StageSpec = serde_json::from_value(serde_json::json!({
            "stage": "vibrate", "frequency_hz": 1, "amplitude_mm": 1, "duration_s": 2
        }))
        .expect("a vibration");
        let mut specimen = poured(&run);
        let mut settlements = |before: Option<f64>| {
            let mut recorder = Recorder::new(&setup, &vibrate, None, |_| {});
            recorder.observed.reference.before_vibration_mm = Some((before, 500.0));
            for (time, height) in [(0.0, 0.3), (0.08, 0.298)] {
                specimen.state.top_plate =
                    Some(BodyState::at_rest(Pose::translation(0.0, 0.0, height)));
                recorder.observe(&specimen, at(time));
            }
            let rows = recorder.observed.rows;
            assert!(rows[0].surface_settlement_mm.is_some_and(|mm| mm > 0.0), "law: from 500 mm");
            let of = |row: &SeriesRow| row.settlement_mm.expect("law: it settles");
            [of(&rows[0]), of(&rows[1])]
        };
        for (before, expected) in [(None, 0.0), (Some(400.0), settlements(Some(400.0))[0])] {
            let got = settlements(before);
            assert!(
                (got[0] - expected).abs() < 1e-9 && (got[1] - expected - 2.0).abs() < 1e-9,
                "law: {expected} mm, then 2 mm more, before {before:?}; got {got:?} mm, tolerance \
                 1e-9 mm"
            );
        }
        let begun = settlements(Some(400.0))[0];
        assert!(begun > 50.0, "law: one that lay there before counts from 400 mm, got {begun} mm");
    }
}
