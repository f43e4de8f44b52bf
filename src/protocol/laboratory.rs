//! Stages of a laboratory of pieces: deposit, move, press, remove.

use super::*;
use crate::plain::{components, counted, four_digits, in_number, three_decimals};
use crate::scenario::{
    DepositKind, DepositSpec, MoveSpec, PIECE_DENSITY, PressSpec, ReleaseSpec, RemoveSpec,
};
use crate::specimen::TurnState;
use crate::units::{from_kpa, to_g, to_mm};

/// Places of a lattice that are tried for each grain before there counts as no room.
const TRIES: usize = 1000;

/// A specimen with its laboratory: at the beginning pieces are put up, and every grain waits.
pub(super) fn begun(setup: &Setup, mut specimen: Specimen) -> Specimen {
    let state = &mut specimen.state;
    if state.pieces.len() < setup.pieces.len() {
        state.pieces = setup.pieces.iter().map(|p| PieceState::standing(p.at)).collect();
        for grain in &mut state.bodies {
            grain.fate = Fate::Waiting;
        }
    }
    specimen
}

impl Laboratory<'_> {
    /// Lets grains that wait fall from an area.
    pub(super) fn deposit(&mut self, mut specimen: Specimen, stage: &DepositSpec) -> StageResult {
        // The engine of the stage has the speed at which overlaps are pushed apart.
        let DepositSpec { at_mm, area_mm, diameter_mm, mass_g, .. } = *stage;
        let area = Area {
            middle: Vector::from(at_mm.map(from_mm)),
            half: match (area_mm, diameter_mm) {
                (Some(sides), _) => sides.map(|side| from_mm(side) / 2.0),
                (None, Some(diameter)) => [from_mm(diameter) / 2.0; 2],
                (None, None) => return Err(self.refused("it needs an area")),
            },
            round: area_mm.is_none(),
        };
        let sizes = stage.sizes_mm.map(|sizes| sizes.map(from_mm));
        let chosen = self.waiting(&specimen, sizes, mass_g.map(from_g));
        if chosen.is_empty() {
            return Err(self.refused("no grains of that kind are waiting any more"));
        }
        let short = mass_g.and_then(|asked| too_few(&specimen.grains, &chosen, asked));
        let fallen_before = fallen_out(&specimen);
        let mut course = Course::until_settled(stage.time_limit_s);
        let mut too_high = None;
        match (stage.how, stage.rate_g_per_s) {
            (DepositKind::Lattice, _) => {
                let height = self.lay_out(&mut specimen, &area, &chosen)?;
                too_high = too_fast_from(height, self.setup);
                // Said at once: no summary will, if the stage fails by it.
                if let Some(told) = &too_high {
                    self.observer.warn(told);
                }
            }
            (DepositKind::Rain, Some(rate)) => {
                course.feed = Some(Feed {
                    rate: Rate::Mass(from_g(rate)),
                    outlet: match stage.above_surface_mm.map(from_mm) {
                        Some(fall) => Outlet::Above { area, fall },
                        None => Outlet::Area(area),
                    },
                    grains: Some(chosen),
                });
            }
            (DepositKind::Rain, None) => return Err(self.refused("rain needs a rate")),
        }
        let left = "of the deposit had not been let go: each waits until others and the pieces \
                    are out of its way";
        let (mut outcome, _) = self.feed(specimen, &course, "depositing", left)?;
        outcome.warnings.extend(too_high.into_iter().chain(short));
        let fallen = fallen_out(&outcome.specimen) - fallen_before;
        if fallen > 0 {
            let all = fallen + outcome.specimen.present().count();
            outcome.warnings.push(format!(
                "{fallen} of {} fell out during the deposit: {} missed the pieces, or ran over them",
                counted(all, "grain"),
                in_number(fallen, "it", "they")
            ));
        }
        Ok(outcome)
    }

    /// Grains that wait, of sieve fractions between two openings in m, up to a mass in kg, in
    /// the order in which they are mixed.
    fn waiting(
        &self,
        specimen: &Specimen,
        sizes: Option<[f64; 2]>,
        mass: Option<f64>,
    ) -> Vec<usize> {
        let set = &specimen.grains;
        let mixed = grains::mix(set, self.setup.seed, self.setup.configuration);
        let fits = |grain: usize| set.is_between(grain, sizes);
        let mut taken = 0.0;
        let waits = |grain: &usize| specimen.state.bodies[*grain].fate == Fate::Waiting;
        let chosen = mixed.order.into_iter().filter(waits).filter(|grain| fits(*grain));
        let enough = |grain: &usize| {
            let more = mass.is_none_or(|mass| taken < mass);
            taken += set.grains[*grain].mass;
            more
        };
        chosen.take_while(enough).collect()
    }

    /// Puts grains at rest on a lattice, clear of pieces and of grains that are there, and no farther
    /// away than bodies are followed. Gives the height in m above the area at which the last begins.
    fn lay_out(
        &self,
        specimen: &mut Specimen,
        area: &Area,
        chosen: &[usize],
    ) -> Result<f64, StageError> {
        let set = specimen.grains.clone();
        let mixed = grains::mix(&set, self.setup.seed, self.setup.configuration);
        let clearance = set.rain_clearance();
        let radius = |grain: usize| set.grains[grain].shape.radius_about_origin() + clearance;
        let largest = chosen.iter().map(|&grain| radius(grain)).fold(0.0, f64::max);
        let solids = Solids::of(self.setup);
        let there: Vec<(Vector, f64)> =
            specimen.present().map(|n| (specimen.centroid(n), radius(n))).collect();
        let state = &specimen.state;
        let clear = |place: &Vector| solids.is_clear(place, largest, state);
        // What a piece parts from the area lies outside of the drum or box that is to be filled.
        let above_area = |place: &Vector| {
            let steps = ((place.z - area.middle.z) / largest).ceil().max(1.0);
            let down = |n: u32| Vector::new(0.0, 0.0, f64::from(n) * largest);
            // From the area up: a piece is met soon, however high the lattice has come.
            (0..steps as u32).rev().all(|n| clear(&(place - down(n))))
        };
        let free = |place: &Vector| {
            above_area(place) && there.iter().all(|(at, r)| (at - place).norm() > r + largest)
        };
        let farthest = check(self.setup, 0.0).distance;
        let mut is_beyond = false;
        let is_followed = |place: &Vector| {
            is_beyond = place.norm() > farthest;
            !is_beyond
        };
        let places: Vec<Vector> = area
            .lattice(largest)
            .take(TRIES * chosen.len())
            .filter(free)
            .take_while(is_followed)
            .take(chosen.len())
            .collect();
        if places.len() < chosen.len() {
            let within = match is_beyond {
                true => format!(
                    "within the {} m from the origin up to which bodies are followed",
                    three_decimals(farthest)
                ),
                false => "clear of the pieces".to_owned(),
            };
            return Err(StageError::Placing(format!(
                "the area of the deposit has room for {} of {}, {within} (allowed: another place, \
                 `at_mm`, a larger area, `{}`, or fewer grains, `mass_g`)",
                places.len(),
                counted(chosen.len(), "grain"),
                if area.round { "diameter_mm" } else { "area_mm" }
            )));
        }
        let highest = places.iter().map(|place| place.z).fold(area.middle.z, f64::max);
        for (&grain, place) in chosen.iter().zip(places) {
            let pose = Pose::from_parts(place.into(), mixed.orientations[grain]);
            let state = &mut specimen.state.bodies[grain];
            (state.body, state.fate) = (BodyState::at_rest(pose), Fate::Present);
        }
        Ok(highest - area.middle.z)
    }

    pub(super) fn move_pieces(&mut self, mut specimen: Specimen, stage: &MoveSpec) -> StageResult {
        let motion = self.stage.piece_motion();
        let motion = motion.ok_or_else(|| self.refused("it needs a motion"))?;
        let names = &stage.pieces;
        let stands = |n: &usize| specimen.state.pieces[*n].present;
        // Those that are pressed or free go on as they are unless they are named.
        let held = |n: &usize| stands(n) && specimen.state.pieces[*n].is_held();
        let pieces: Vec<usize> = match names.is_empty() {
            true => (0..specimen.state.pieces.len()).filter(held).collect(),
            false => self.setup.numbers(names).filter(|p| p.iter().all(stands)).unwrap_or_default(),
        };
        if pieces.is_empty() {
            return Err(self.refused("its pieces do not stand"));
        }
        for &n in &pieces {
            specimen.state.pieces[n].hold();
        }
        let limit = self.stage.settle_limit();
        let calm_from = (limit > 0.0).then_some(motion.duration);
        let mut course = Course::until(Until { limit: motion.duration + limit, calm_from });
        course.drive = Some(Drive { pieces, motion });
        course.endings = self.endings();
        if let Some(keep) = &stage.keep_mean_stress {
            let keeper = StressKeeper::of(keep, self.setup, &specimen);
            course.keeper = Some(keeper.map_err(|reason| self.refused(reason))?);
        }
        let Ended { mut stand, settled, .. } = self.carry_out(specimen, &course)?;
        if limit > 0.0 && !settled {
            stand.warn(not_settled("rest after the motion", limit));
        }
        Ok(stand.finish())
    }

    /// Presses pieces, or locks what was pressed.
    pub(super) fn press(&mut self, mut specimen: Specimen, stage: &PressSpec) -> StageResult {
        for load in &stage.loads {
            let number = self.setup.number(&load.piece);
            let number = number.filter(|n| specimen.state.pieces[*n].present);
            let n = number.ok_or_else(|| self.refused("its pieces do not stand"))?;
            let (piece, state) = (&self.setup.pieces[n], &mut specimen.state.pieces[n]);
            if load.locked {
                state.hold();
                continue;
            }
            state.free = None;
            let turning = load.moment_n_m.zip(load.axis);
            let direction = turning.map_or(load.direction, |(_, axis)| axis);
            let direction = Vector::from(direction).normalize();
            let about = turning.map(|_| load.about_mm.unwrap_or_default().map(from_mm).into());
            let axis = state.pose.rotation.inverse() * direction;
            let area = piece.area_along(&axis);
            let target = match (load.force_n.or(load.moment_n_m), load.stress_kpa) {
                (Some(force), _) => force,
                (None, Some(stress)) => from_kpa(stress) * area,
                (None, None) => return Err(self.refused("a load needs a force or a stress")),
            };
            let alike = |press: &PressState| {
                press.direction == direction && press.turns.map(|turns| turns.about) == about
            };
            let before = state.press.filter(alike).unwrap_or_else(|| {
                let borne = borne(state, &direction, about);
                PressState { force_n: borne, resistance_n: borne, ..PressState::default() }
            });
            let force = before.force_n;
            // A force that the approach holds down must be able to come back.
            let change = if before.arrived { (target - force).abs() } else { target.max(force) };
            let mass = load.mass_g.map_or_else(|| piece.volume() * PIECE_DENSITY, from_g);
            let place = |about: Vector| state.pose.inverse() * Point::from(about);
            let turns = about.map(|about| TurnState {
                about,
                reach_m: piece.reach_from(&axis, &place(about)),
                turned_rad: before.turns.map_or(0.0, |turns| turns.turned_rad),
            });
            // Of what turns the moment of inertia, and the speed about the axis.
            let inertia = about.map(|about| piece.inertia_about(&axis, &place(about), mass));
            let approach = from_mm(stage.approach_mm_per_s);
            state.press = Some(PressState {
                direction,
                mass_kg: inertia.unwrap_or(mass),
                area_m2: area,
                target_n: target,
                rate_n_per_s: change / stage.ramp_s,
                approach_m_per_s: turns.map_or(approach, |turns| approach / turns.reach_m),
                turns,
                ..before
            });
        }
        let mut outcome = self.until_settled(specimen, stage.time_limit_s, "pressing")?;
        if outcome.until.as_ref().is_none_or(|found| !found.reached) {
            let pieces = self.setup.pieces.iter().zip(&outcome.specimen.state.pieces);
            let told = pieces.filter_map(|(piece, state)| lacking(&piece.name, state.press?));
            outcome.warnings.extend(told);
        }
        Ok(outcome)
    }

    /// Lets pieces move freely from now on.
    pub(super) fn release(&mut self, mut specimen: Specimen, stage: &ReleaseSpec) -> StageResult {
        let pieces = self.setup.numbers(&stage.pieces);
        let pieces = pieces.ok_or_else(|| self.refused("there is no such piece"))?;
        let solid = self.setup.pieces.iter().map(|p| RigidPiece { may_cross: false, ..p.clone() });
        let solid: Vec<RigidPiece> = solid.collect();
        let states = &mut specimen.state.pieces;
        let at: Vec<Option<Pose>> =
            states.iter().map(|piece| piece.present.then_some(piece.pose)).collect();
        let own_mass = |n: usize| solid[n].volume() * PIECE_DENSITY;
        let mass_of = |n: usize| stage.mass_g.map_or_else(|| own_mass(n), from_g);
        let others = states.iter().enumerate().filter(|(n, _)| !pieces.contains(n));
        let others: f64 = others.filter_map(|(_, piece)| Some(piece.free?.mass_kg)).sum();
        let all = others + pieces.iter().map(|&n| mass_of(n)).sum::<f64>();
        let sunk = sunk_at_rest(self.setup, all);
        for n in pieces {
            if !states[n].present {
                return Err(self.refused("its pieces do not stand"));
            }
            if let Some(other) = stands_in(&solid, &at, n, sunk) {
                let (one, other) = (&solid[n].name, &solid[other].name);
                return Err(self.refused(format!(
                    "`{one}` stands in `{other}`: a free piece must not overlap another piece"
                )));
            }
            states[n].hold();
            states[n].free = Some(released(&solid[n], &states[n], mass_of(n)));
        }
        if states.iter().all(|piece| !piece.present || piece.free.is_some()) {
            return Err(self.refused("nothing is left that could carry what moves freely"));
        }
        self.until_settled(specimen, stage.time_limit_s, "moving freely")
    }

    pub(super) fn remove(&mut self, mut specimen: Specimen, stage: &RemoveSpec) -> StageResult {
        let pieces = self.setup.numbers(&stage.pieces);
        let pieces = pieces.ok_or_else(|| self.refused("there is no such piece"))?;
        for n in pieces {
            let piece = &mut specimen.state.pieces[n];
            if !piece.present {
                return Err(self.refused("its pieces do not stand"));
            }
            *piece = PieceState { present: false, ..PieceState::standing(piece.pose) };
        }
        self.until_settled(specimen, stage.time_limit_s, "flow")
    }

    /// Carries a stage out that ends by its condition or when everything has settled.
    fn until_settled(&mut self, specimen: Specimen, limit: f64, what: &str) -> StageResult {
        let course = Course { endings: self.endings(), ..Course::until_settled(limit) };
        let Ended { mut stand, settled, .. } = self.carry_out(specimen, &course)?;
        if !settled && course.endings.is_none() {
            stand.warn(not_settled(what, limit));
        }
        Ok(stand.finish())
    }

    /// What ends a stage before its time.
    fn endings(&self) -> Option<Endings> {
        Endings::of(self.stage.until()?, self.setup)
    }
}

/// What grains bear of a piece in N, against a direction; or in N m, about an axis through a point.
/// A piece that was held while it bore something is pressed on from there.
pub(super) fn borne(state: &PieceState, direction: &Vector, about: Option<Vector>) -> f64 {
    let by_grains = match about {
        None => state.force_n,
        Some(about) => {
            let arm = state.pose.translation.vector - about;
            state.moment_n_m + arm.cross(&state.force_n)
        }
    };
    (-by_grains.dot(direction)).max(0.0)
}

/// Says that fewer grains were left than a deposit asks for, in g; none where those that were
/// chosen lack less than one of them: each layer before may have taken a part of a grain more.
fn too_few(set: &GrainSet, chosen: &[usize], asked: f64) -> Option<String> {
    let masses = || chosen.iter().map(|&grain| to_g(set.grains[grain].mass));
    let (there, heaviest) = (masses().sum::<f64>(), masses().fold(0.0, f64::max));
    (there < asked - heaviest).then(|| {
        format!(
            "the deposit asks for {} g of grains, and only {} g were waiting",
            three_decimals(asked),
            three_decimals(there)
        )
    })
}

/// Says that grains which fall from the top of a lattice of a height in m move by more than the size
/// of the smallest in a step; none of a lower one. With the automatic step rate nothing does whose
/// speed follows from the scenario; how high a lattice is does not.
fn too_fast_from(height: f64, setup: &Setup) -> Option<String> {
    let speed = (2.0 * setup.gravity * height).sqrt();
    let (step, size) = (speed / setup.engine.rate_hz, setup.scale.sizes.smallest);
    let [height_mm, step_mm, size_mm] = [height, step, size].map(|m| four_digits(to_mm(m)));
    (step > size).then(|| {
        format!(
            "the lattice of the deposit is {height_mm} mm high: its last grains land at about {} m/s, \
             {step_mm} mm in a step, more than the smallest grain's size, {size_mm} mm, and may get \
             into walls (advised: a larger area, or rain with `above_surface_mm`)",
            four_digits(speed)
        )
    })
}

/// Number of grains that have fallen below all pieces.
fn fallen_out(specimen: &Specimen) -> usize {
    specimen.state.bodies.iter().filter(|grain| grain.fate == Fate::Spilled).count()
}

/// What a pressed piece lacks of its load.
pub(super) fn lacking(name: &str, press: PressState) -> Option<String> {
    let bears = press.arrived || press.target_n == 0.0;
    let unit = if press.turns.is_some() { "N m" } else { "N" };
    let [force, target] = components([press.force_n, press.target_n]);
    (!(press.is_reached() && bears)).then(|| match press.is_reached() {
        true => format!("`{name}` is pressed with {target} {unit}, but nothing carries it yet"),
        false => format!("`{name}` is pressed with {force} {unit} of the {target} asked for"),
    })
}
