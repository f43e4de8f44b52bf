//! Pieces of a laboratory in a world: where they are, how they are moved, what the grains do
//! to them.

use std::f64::consts::PI;

use super::*;
use crate::motion::PieceMotion;
use crate::world::{Contact, World};

/// Pieces that move as one in a stage.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drive {
    pub pieces: Vec<usize>,
    pub motion: PieceMotion,
}

/// Impulse and its moment, in N s and N m s.
#[derive(Debug, Clone, Copy, Default)]
struct Load {
    impulse: Vector,
    moment: Vector,
}

/// What grains did to each piece in a number of steps.
struct Loads {
    of_pieces: Vec<Load>,
    steps: u32,
}

impl Loads {
    fn of(pieces: usize) -> Self {
        Self { of_pieces: vec![Load::default(); pieces], steps: 0 }
    }

    /// Writes the mean force and moment into a state, and begins anew; steps have a length in s.
    fn take(&mut self, state: &mut SpecimenState, step: f64) {
        let time = f64::from(self.steps) * step;
        for (piece, load) in state.pieces.iter_mut().zip(&mut self.of_pieces) {
            let load = std::mem::take(load);
            if time > 0.0 {
                (piece.force_n, piece.moment_n_m) = (load.impulse / time, load.moment / time);
            }
        }
        self.steps = 0;
    }
}

/// A piece that is pressed: its number, its body, and where that is in its frame.
struct Pressed {
    piece: usize,
    body: BodyId,
    part: Pose,
}

/// The bodies of the pieces that stand.
pub(super) struct Pieces {
    /// Of each piece its parts with their places in its frame; none of one that is removed.
    parts: Vec<Vec<(BodyId, Pose)>>,
    pub(super) solids: Solids,
    of_body: HashMap<BodyId, usize>,
    drive: Option<Drive>,
    /// Where the pieces were when the stage began.
    began: Vec<PieceState>,
    /// Of each that stands whether it falls, and the height in m below which it does not reach as it
    /// stood then and is moved as prescribed.
    reach: Vec<(bool, f64)>,
    /// Where each was at the beginning of the last step.
    before: Vec<Pose>,
    /// What grains did to the pieces since the last look, and since the last sample.
    loads: Loads,
    sampled: Loads,
    /// Work of the pieces on the grains since it was taken, in J.
    pub(super) work: f64,
    /// Those that are pressed, and the work done on them since it was taken, in J.
    pressed: Vec<Pressed>,
    pub(super) pressed_work: f64,
    free: Vec<Free>,
    /// By condition, the pieces whose force may end the stage, and the impulse in N s of the grains
    /// on them since it was taken; no pieces for a condition on anything but a force.
    watched: Vec<(Vec<usize>, Vector)>,
    contacts: Vec<Contact>,
}

impl Pieces {
    /// Puts the pieces that stand into a world, as kinematic, pressed or free bodies; `began` is where
    /// they were when the stage began.
    pub(super) fn add(
        world: &mut dyn World,
        setup: &Setup,
        state: &SpecimenState,
        began: &[PieceState],
        drive: Option<Drive>,
        parties: &mut HashMap<Party, BodyId>,
    ) -> Result<Self, WorldError> {
        let mut parts = Vec::new();
        let mut of_body = HashMap::new();
        let (mut pressed, mut free) = (Vec::new(), Vec::new());
        for (n, (piece, at)) in setup.pieces.iter().zip(&state.pieces).enumerate() {
            let material = setup.piece_materials[n];
            let motion = at.press.map_or(Motion::Kinematic, |press| motion_of(&press));
            let velocity = at.press.map_or([Vector::zeros(); 2], |press| velocity_of(&press));
            let is_whole = at.free.is_some() || at.press.is_some() && piece.parts.len() > 1;
            let bodies: Vec<(BodyId, Pose)> = if !at.present {
                Vec::new()
            } else if is_whole {
                let ids = add_whole(world, piece, material, at, motion, velocity)?;
                ids.into_iter().map(|id| (id, Pose::identity())).collect()
            } else {
                let add = |part: &Piece| -> Result<(BodyId, Pose), WorldError> {
                    let mut body = wall_piece(part, motion);
                    body.state.pose = at.pose * part.pose;
                    [body.state.linear_velocity, body.state.angular_velocity] = velocity;
                    Ok((world.add(&Body { material, ..body })?, part.pose))
                };
                piece.parts.iter().map(add).collect::<Result<_, _>>()?
            };
            for (k, (id, _)) in bodies.iter().enumerate() {
                parties.insert(Party::Other(Other::Piece(n, k)), *id);
                of_body.insert(*id, n);
            }
            if let Some(&(body, part)) = bodies.first() {
                pressed.extend(at.press.map(|_| Pressed { piece: n, body, part }));
                free.extend(at.free.map(|state| Free::new(n, piece, &state, body)));
            }
            parts.push(bodies);
        }
        let solids = Solids::of(setup);
        Ok(Self {
            parts,
            reach: reach(began, &solids.radii, drive.as_ref()),
            solids,
            of_body,
            drive,
            began: began.to_vec(),
            before: state.pieces.iter().map(|piece| piece.pose).collect(),
            loads: Loads::of(state.pieces.len()),
            sampled: Loads::of(state.pieces.len()),
            work: 0.0,
            pressed,
            pressed_work: 0.0,
            free,
            watched: Vec::new(),
            contacts: Vec::new(),
        })
    }

    /// Adds up the impulse of the grains on pieces from now on, for the conditions on their force.
    pub(super) fn feel(&mut self, endings: &Endings) {
        let watched = endings.each.iter().map(|ending| match &ending.subject {
            Subject::Force(pieces, _) => (pieces.clone(), Vector::zeros()),
            _ => (Vec::new(), Vector::zeros()),
        });
        self.watched = watched.collect();
    }

    /// Impulse in N s of the grains on the pieces of a condition since it was taken last.
    pub(super) fn take_felt(&mut self, condition: usize) -> Vector {
        std::mem::replace(&mut self.watched[condition].1, Vector::zeros())
    }

    /// Lets the motion die away from a time in s on.
    pub(super) fn end_at(&mut self, time: f64) {
        if let Some(drive) = &mut self.drive {
            drive.motion = drive.motion.ended_at(time);
        }
    }

    /// Displacement in m of some pieces since the stage began, in the mean.
    pub(super) fn moved(&self, pieces: &[usize], state: &SpecimenState) -> Vector {
        let way = |n: &usize| {
            state.pieces[*n].pose.translation.vector - self.began[*n].pose.translation.vector
        };
        pieces.iter().map(way).sum::<Vector>() / pieces.len().max(1) as f64
    }

    /// Angle in rad by which some pieces have turned since the stage began, a time in s ago, in the
    /// mean: of one that a moment turns, about its axis.
    pub(super) fn turned(&self, pieces: &[usize], state: &SpecimenState, time: f64) -> f64 {
        let about = |piece: &PieceState| piece.press?.turns.map(|turns| turns.turned_rad);
        // Orientations show half a turn at most.
        let prescribed = |n: usize| {
            let drive = self.drive.as_ref().filter(|_| self.is_moved(n))?;
            drive.motion.turned(time).filter(|angle| *angle > PI)
        };
        let angle = |n: &usize| {
            let (began, now) = (&self.began[*n], &state.pieces[*n]);
            match (about(began), about(now)) {
                (Some(before), Some(after)) => (after - before).abs(),
                _ => prescribed(*n)
                    .unwrap_or_else(|| (now.pose.rotation * began.pose.rotation.inverse()).angle()),
            }
        };
        pieces.iter().map(angle).sum::<f64>() / pieces.len().max(1) as f64
    }

    /// Height in m below which nothing of the pieces reaches, as they are moved in this stage and as
    /// far as pressed ones have sunk so far, which nothing prescribes; of those that fall, only where
    /// there are no others.
    pub(super) fn lowest(&self, state: &SpecimenState) -> f64 {
        let sunk = self.pressed.iter().map(|pressed| {
            let n = pressed.piece;
            (false, state.pieces[n].pose.translation.z - self.solids.radii[n])
        });
        lowest_of(self.reach.iter().copied().chain(sunk))
    }

    /// Largest speed in m/s of any point of the pieces in this stage.
    pub(super) fn peak_speed(&self, setup: &Setup) -> f64 {
        let pressed = self.began.iter().filter_map(|piece| piece.press);
        let approach = pressed.map(|press| press.of_points(press.approach_m_per_s));
        let approach = approach.fold(0.0, f64::max);
        let Some(Drive { pieces, motion }) = &self.drive else { return approach };
        let farthest = pieces.iter().map(|&n| {
            let origin = Point::from(self.began[n].pose.translation.vector);
            motion.from_axis(&origin) + setup.pieces[n].radius
        });
        motion.peak_speed(farthest.fold(0.0, f64::max)).max(approach)
    }

    /// Kinetic energy in J of the pieces that are pressed, and the speed in m/s of the fastest;
    /// none where none is.
    pub(super) fn pressed_motion(&self, state: &SpecimenState) -> Option<(f64, f64)> {
        let of = |pressed: &Pressed| state.pieces[pressed.piece].press;
        let sums = self.pressed.iter().filter_map(of).fold((0.0, 0.0_f64), |(energy, fast), p| {
            (energy + p.kinetic_energy(), faster(fast, p.of_points(p.speed_m_per_s)))
        });
        (!self.pressed.is_empty()).then_some(sums)
    }

    /// Masses in kg, principal moments of inertia in kg m² and motions of those that move freely.
    pub(super) fn free_motion<'a>(
        &'a self,
        state: &'a SpecimenState,
    ) -> impl Iterator<Item = (f64, &'a Vector, &'a BodyState)> + Clone {
        self.free.iter().filter_map(|free| free.moving(state))
    }

    /// What is wrong with a piece that moves freely, where something is; `lowest` is the height in
    /// m below which nothing else reaches.
    pub(super) fn lost(&self, setup: &Setup, lowest: f64, state: &SpecimenState) -> Option<String> {
        self.free.iter().find_map(|free| free.lost(setup, &self.solids, lowest, state))
    }

    /// Says where the pieces that move as prescribed are at the end of the next step, at a time
    /// in s, and by what force the others are pressed in it.
    pub(super) fn advance(
        &mut self,
        world: &mut dyn World,
        state: &mut SpecimenState,
        time: f64,
    ) -> Result<(), WorldError> {
        let step = world.time_step();
        for pressed in &self.pressed {
            let Some(press) = &mut state.pieces[pressed.piece].press else { continue };
            press.next(step);
            world.press(pressed.body, press.force_n + press.stop(step))?;
        }
        let Some(drive) = &self.drive else { return Ok(()) };
        let by = drive.motion.displacement(time);
        for &n in &drive.pieces {
            self.before[n] = state.pieces[n].pose;
            state.pieces[n].pose = by * self.began[n].pose;
            for (id, part) in &self.parts[n] {
                world.drive(*id, &(state.pieces[n].pose * part))?;
            }
        }
        Ok(())
    }

    /// Tells a world in which the stage goes on how the pieces moved in its last steps.
    pub(super) fn recall(&self, world: &mut dyn World, steps: u64) -> Result<(), WorldError> {
        let Some(drive) = &self.drive else { return Ok(()) };
        let dt = world.time_step();
        let place = |step: u64| drive.motion.displacement(step as f64 * dt);
        let ends = [2, 1, 0].map(|ago| steps.checked_sub(ago).map_or(Pose::identity(), place));
        for &n in &drive.pieces {
            for (id, part) in &self.parts[n] {
                world.recall_drive(*id, &ends.map(|by| by * self.began[n].pose * part))?;
            }
        }
        Ok(())
    }

    /// Reads where the last step left the pieces that are pressed, and adds up what grains and
    /// pieces did to each other in it.
    pub(super) fn gather(
        &mut self,
        world: &dyn World,
        state: &mut SpecimenState,
    ) -> Result<(), WorldError> {
        if self.of_body.is_empty() {
            return Ok(());
        }
        for free in &self.free {
            free.read(world, state)?;
        }
        for pressed in &self.pressed {
            let piece = &mut state.pieces[pressed.piece];
            let Some(press) = &mut piece.press else { continue };
            let body = world.read_body(pressed.body)?;
            press.resistance_n = 0.0;
            if let Some(turns) = &mut press.turns {
                let now = body.pose * pressed.part.inverse();
                let turned = (now.rotation * piece.pose.rotation.inverse()).scaled_axis();
                let way = turned.dot(&press.direction);
                self.pressed_work += press.force_n * way;
                turns.turned_rad += way;
                let speed = body.angular_velocity.dot(&press.direction);
                press.has_turned(speed, world.time_step());
                piece.pose = now;
                continue;
            }
            let now = body.pose.translation.vector
                - piece.pose.rotation * pressed.part.translation.vector;
            let way = (now - piece.pose.translation.vector).dot(&press.direction);
            self.pressed_work += press.force_n * way;
            piece.pose.translation.vector = now;
            press.speed_m_per_s = body.linear_velocity.dot(&press.direction);
        }
        let dt = world.time_step();
        let mut contacts = std::mem::take(&mut self.contacts);
        world.contacts(&mut contacts);
        for contact in &contacts {
            for (body, impulse) in [(contact.a, contact.impulse), (contact.b, -contact.impulse)] {
                let Some(&n) = self.of_body.get(&body) else { continue };
                let now = state.pieces[n].pose;
                let moment = (contact.point - now.translation.vector).cross(&impulse);
                for loads in [&mut self.loads, &mut self.sampled] {
                    loads.of_pieces[n].impulse += impulse;
                    loads.of_pieces[n].moment += moment;
                }
                for (_, felt) in self.watched.iter_mut().filter(|(of, _)| of.contains(&n)) {
                    *felt += impulse;
                }
                if let Some(press) = state.pieces[n].press.as_mut().filter(|p| p.turns.is_none()) {
                    press.resistance_n -= press.direction.dot(&impulse) / dt;
                }
                if self.is_moved(n) {
                    let point = Point::from(contact.point);
                    let velocity = (point - self.before[n] * now.inverse() * point) / dt;
                    self.work -= velocity.dot(&impulse);
                }
            }
        }
        self.contacts = contacts;
        self.loads.steps += 1;
        self.sampled.steps += 1;
        Ok(())
    }

    /// Writes the mean force and moment since the look before into a state, and begins anew; or since
    /// these bodies were added, where that was later. A segment hands no loads on to the next: a piece
    /// that is pressed after it was held begins from the last of these means, which keeps its bits.
    pub(super) fn take_loads(&mut self, state: &mut SpecimenState, step: f64) {
        self.loads.take(state, step);
    }

    /// The same since the sample before, into a state that is only shown.
    pub(super) fn take_sampled_loads(&mut self, state: &mut SpecimenState, step: f64) {
        self.sampled.take(state, step);
    }

    /// A piece that is pressed and stands in another, which it does not feel: both by number.
    pub(super) fn pressed_into(
        &self,
        setup: &Setup,
        state: &SpecimenState,
    ) -> Option<(usize, usize)> {
        if self.pressed.is_empty() {
            return None;
        }
        // What moves freely is felt.
        let stands = |piece: &PieceState| piece.present && piece.free.is_none();
        let places = |pieces: &[PieceState]| -> Vec<Option<Pose>> {
            pieces.iter().map(|piece| stands(piece).then_some(piece.pose)).collect()
        };
        let (began, at) = (places(&self.began), places(&state.pieces));
        let into = |pressed: &Pressed| {
            let n = pressed.piece;
            stands_in(&setup.pieces, &at, n, 0.0)?;
            // What lay on another piece, or leant on it, begins in the springs of their contacts.
            let press = state.pieces[n].press.filter(|press| press.turns.is_none());
            let most = sunk_at_rest(setup, press.map_or(0.0, |press| press.mass_kg));
            let before = depth_in_others(&setup.pieces, &began, n).min(most);
            Some((n, stands_in(&setup.pieces, &at, n, before)?))
        };
        self.pressed.iter().find_map(into)
    }

    /// Whether the stage moves a piece as prescribed.
    pub(super) fn is_moved(&self, piece: usize) -> bool {
        self.drive.as_ref().is_some_and(|drive| drive.pieces.contains(&piece))
    }
}

/// Of each piece that stands whether it falls, and the height in m below which it does not reach,
/// from where it is when a stage begins.
fn reach(began: &[PieceState], radii: &[f64], drive: Option<&Drive>) -> Vec<(bool, f64)> {
    let stand = began.iter().zip(radii).enumerate().filter(|(_, (piece, _))| piece.present);
    let low = stand.map(|(n, (piece, radius))| {
        let origin = Point::from(piece.pose.translation.vector);
        let path = drive.filter(|drive| drive.pieces.contains(&n));
        let lowest = path.map_or(origin.z, |drive| drive.motion.lowest(&origin));
        (piece.free.is_some(), lowest - radius)
    });
    low.collect()
}

/// Velocity and angular velocity of a body that is pressed, in m/s and rad/s.
fn velocity_of(press: &PressState) -> [Vector; 2] {
    let speed = press.direction * press.speed_m_per_s;
    match press.turns {
        Some(_) => [Vector::zeros(), speed],
        None => [speed, Vector::zeros()],
    }
}

fn motion_of(press: &PressState) -> Motion {
    if let Some(turns) = press.turns {
        let axis = press.direction;
        return Motion::Turned { inertia: press.mass_kg, axis, about: turns.about };
    }
    Motion::Pressed { mass: press.mass_kg, direction: press.direction }
}
