//! Energy and speeds while a stage goes on: whether gravity and the table can have given them.
//!
//! Between two looks the mechanical energy of what moves (kinetic, and m g z) can rise only by the
//! work of the table: contacts and friction take. Its work is the integral of its velocity over the
//! momentum that it gives, and along each direction at most the larger of its velocities at the two
//! looks times that momentum; along z what gravity has taken is given, too. What rises beyond is
//! unexplained. It is summed up, and the sum falls, to zero at the least, where more is lost than
//! given: it is the largest rise without a cause from any earlier moment to now. Between the pieces
//! of a laboratory contacts are loaded springs: what pieces gave them, and what they held when the
//! stage began, may come back; so may what they hold when a weight is laid on the top plate or
//! taken off.

use super::*;

/// A stage is warned of when the unexplained energy gain exceeds this share of what
/// gravity and table could give together.
const ENERGY_SHARE: f64 = 0.05;

/// The same share, at which it ends: as much has come unexplained as there was.
const ENERGY_RUNAWAY: f64 = 1.0;

/// A stage is warned of when something is faster than this many times what
/// free fall through the whole apparatus and an impact of the table give together.
const SPEED_FACTOR: f64 = 1.5;

/// The same, at which it ends.
const SPEED_RUNAWAY: f64 = 5.0;

/// Looks in a cycle of the table, at least: between them its velocity changes
/// by less than 40 % of its peak.
const LOOKS_A_CYCLE: f64 = 16.0;

/// What is watched about the motion of a stage.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Watch {
    /// How often every body was checked to be somewhere, with finite numbers.
    pub checks: u64,
    /// Grains that passed through a wall or a floor, or were found in one.
    pub through_walls: u32,
    /// Largest speed of grains, plate, and pressed and free pieces in m/s.
    pub speed: Watched,
    /// Unexplained energy gain in J.
    pub energy: Watched,
    /// What was given and taken since the stage began; nothing in a checkpoint of before this was.
    #[serde(default)]
    pub balance: EnergyBalance,
    /// None before the stage has begun.
    budget: Option<Budget>,
}

/// Energy that bodies were given and have lost since a stage began, in J. What is taken off with
/// bodies that leave, and what others bring that are let go, is neither.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyBalance {
    /// Work of the table, of moving pieces and on pressed ones, and of a weight on the top plate.
    /// That of the table is its mean velocity between two looks, sixteen to a cycle at least, times
    /// the momentum given between them; that of pieces is summed over every contact in every step;
    /// that of the weight is the energy that it loses.
    pub input: f64,
    /// What friction and impacts have taken: input less the gain of kinetic and potential energy.
    pub dissipated: f64,
}

/// What speeds and energies are compared with, in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Budget {
    table_peak: f64,
    /// Height below which nothing is seen.
    lowest: f64,
    gravity: f64,
    /// Largest speed that something can have by fall and table.
    speed: f64,
    /// Energy that gravity and the table can give at once, with what there was.
    available: f64,
    /// Energy, momentum and mass at the last look, the table's velocity, and when that was.
    energy: f64,
    momentum: Vector,
    mass: f64,
    table: Vector,
    time: f64,
    /// How far the table has moved since then.
    #[serde(default, rename = "way")]
    displacement: Vector,
    gained: f64,
    /// In a laboratory, or with a weight on the top plate, what contacts may have stored as springs
    /// and give back: their energy at the beginning, and the work of pieces since.
    stored: Option<f64>,
    /// The part of the energy that a weight on the top plate has; none without one.
    #[serde(default)]
    of_weight: Option<f64>,
}

/// A body that moves freely: mass in kg, principal moments of inertia in kg m², state.
pub(super) type Moving<'a> = (f64, &'a Vector, &'a BodyState);

/// What is summed over all bodies that move freely, in SI units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Tally {
    pub(super) energy: f64,
    momentum: Vector,
    mass: f64,
    fastest: f64,
    /// The part of the energy that a weight on the top plate has; none without one.
    of_weight: Option<f64>,
}

impl Tally {
    /// The sums of bodies under a gravity in m/s².
    pub(super) fn of<'a>(bodies: impl Iterator<Item = Moving<'a>>, gravity: f64) -> Self {
        bodies.fold(Self::default(), |sum, (mass, inertia, state)| {
            let square = state.linear_velocity.norm_squared();
            let kinetic = 0.5 * mass * square + state.rotational_energy(inertia);
            Self {
                energy: sum.energy + kinetic + mass * gravity * state.pose.translation.z,
                momentum: sum.momentum + mass * state.linear_velocity,
                mass: sum.mass + mass,
                fastest: faster(sum.fastest, square.sqrt()),
                of_weight: None,
            }
        })
    }

    /// With a kinetic energy in J beside, of what moves at up to a speed in m/s.
    pub(super) fn and(self, kinetic: f64, fastest: f64) -> Self {
        Self { energy: self.energy + kinetic, fastest: faster(self.fastest, fastest), ..self }
    }

    /// With the part of the energy in J that a weight on the top plate has, where there is one.
    pub(super) fn with_weight(self, of_weight: Option<f64>) -> Self {
        Self { of_weight, ..self }
    }
}

/// The larger of two speeds; no number where one of them is none, which `f64::max` passes over.
pub(super) fn faster(one: f64, other: f64) -> f64 {
    if one.is_nan() || other <= one { one } else { other }
}

/// `Ok` with what a reader must know, where a stage has it for the first time; `Err` with why the
/// stage cannot go on.
pub(super) type Finding = Result<Option<String>, String>;

impl Watch {
    /// Begins, where that has not been done, with the bodies of a stage, a table
    /// whose peak speed and velocity are given in m/s, the height in m below which
    /// nothing is seen, and the time in s since the first stage began. Whether it has.
    pub(super) fn begin<'a>(
        &mut self,
        bodies: impl Iterator<Item = Moving<'a>> + Clone,
        lowest: f64,
        gravity: f64,
        table: (f64, Vector),
        time: f64,
    ) -> bool {
        if self.budget.is_some() {
            return false;
        }
        let (table_peak, table) = table;
        let now = Tally::of(bodies.clone(), gravity);
        let mut budget = Budget {
            table_peak,
            lowest,
            gravity,
            speed: 2.0 * table_peak,
            available: 0.0,
            energy: now.energy,
            momentum: now.momentum,
            mass: now.mass,
            table,
            time,
            displacement: Vector::zeros(),
            gained: 0.0,
            stored: None,
            of_weight: None,
        };
        for body in bodies {
            budget.add(body);
        }
        self.budget = Some(budget);
        true
    }

    /// Takes pieces, or a weight on the plate, into account: the kinetic energy of pressed pieces,
    /// and what the contacts hold as springs, both in J.
    pub(super) fn press(&mut self, kinetic: f64, springs: f64) {
        if let Some(budget) = &mut self.budget {
            budget.energy += kinetic;
            budget.available += kinetic + springs;
            budget.stored = Some(springs);
        }
    }

    /// Takes into account which part of the energy in J a weight on the top plate has, where there
    /// is one.
    pub(super) fn weigh(&mut self, of_weight: Option<f64>) {
        if let Some(budget) = &mut self.budget {
            budget.of_weight = of_weight;
        }
    }

    /// Takes work in J into account that was done on pressed pieces.
    pub(super) fn pressed(&mut self, work: f64) {
        if let Some(budget) = &mut self.budget {
            budget.available += work.max(0.0);
        }
        self.given(work);
    }

    /// Takes a body that is let go into account.
    pub(super) fn let_go(&mut self, body: Moving) {
        if let Some(budget) = &mut self.budget {
            budget.add(body);
            let own = Tally::of(std::iter::once(body), budget.gravity);
            budget.energy += own.energy;
            budget.momentum += own.momentum;
            budget.mass += own.mass;
        }
    }

    /// Takes into account that the table has moved, in m.
    pub(super) fn table_moved(&mut self, by: Vector) {
        if let Some(budget) = &mut self.budget {
            budget.displacement += by;
        }
    }

    /// Takes work in J into account that pieces did on the bodies.
    pub(super) fn given(&mut self, work: f64) {
        if let Some(budget) = &mut self.budget {
            budget.energy += work;
            self.balance.input += work;
            // As much may have gone into the springs of contacts.
            if let Some(stored) = &mut budget.stored {
                *stored += work.max(0.0);
            }
        }
    }

    /// Goes on from what there is after bodies were taken away.
    pub(super) fn taken_away(&mut self, left: Tally) {
        if let Some(budget) = &mut self.budget {
            (budget.energy, budget.momentum, budget.mass) = (left.energy, left.momentum, left.mass);
        }
    }

    /// Begins anew with what there will be: something was added or taken off by hand.
    pub(super) fn begin_anew(&mut self) {
        self.budget = None;
    }

    /// Notes energy and momentum between two looks, where the table is fast, at a time as in `look`.
    pub(super) fn follow(&mut self, now: &Tally, table: Vector, time: f64) {
        if let Some(budget) = &mut self.budget {
            budget.follow(now, table, time, &mut self.balance);
        }
    }

    /// Looks: at sums, with the table's velocity in m/s, at a time in s
    /// since the first stage began.
    pub(super) fn look(&mut self, now: &Tally, table: Vector, time: f64) -> Finding {
        let Some(budget) = &mut self.budget else { return Ok(None) };
        budget.follow(now, table, time, &mut self.balance);
        let (gained, available, natural) = (budget.gained, budget.available, budget.speed);
        let fast = self.speed.note(now.fastest, SPEED_FACTOR * natural, time);
        let energetic = self.energy.note(gained, ENERGY_SHARE * available, time);
        let energy = || {
            format!(
                "unexplained energy gain: {gained:.3e} J more than contacts can give, {:.1} % of the \
                 {available:.3e} J of gravity and table",
                100.0 * gained / available
            )
        };
        let speed = || {
            format!(
                "a body has a speed of {:.2} m/s; free fall through the apparatus and the table give \
                 at most {natural:.2} m/s",
                now.fastest
            )
        };
        // Written so that what is no number counts as too much.
        if !(gained <= ENERGY_RUNAWAY * available) {
            return Err(energy());
        }
        if !(now.fastest <= SPEED_RUNAWAY * natural) {
            return Err(speed());
        }
        Ok(match (energetic, fast) {
            (true, _) => Some(energy()),
            (false, true) => Some(speed()),
            (false, false) => None,
        })
    }
}

impl Budget {
    /// Takes into account what gravity and table can do with a body.
    fn add(&mut self, (mass, inertia, state): Moving) {
        let height = (state.pose.translation.z - self.lowest).max(0.0);
        let square = state.linear_velocity.norm_squared();
        let fall = (square + 2.0 * self.gravity * height).sqrt();
        // A body that a wall meets at its peak may leave with twice that.
        self.speed = self.speed.max(fall + 2.0 * self.table_peak);
        self.available += 0.5 * mass * (square + self.table_peak * self.table_peak)
            + state.rotational_energy(inertia)
            + mass * self.gravity * height;
    }

    fn follow(&mut self, now: &Tally, table: Vector, time: f64, balance: &mut EnergyBalance) {
        let mut given = now.momentum - self.momentum;
        given.z += self.mass * self.gravity * (time - self.time);
        let work = self.table.component_mul(&given).sup(&table.component_mul(&given)).sum();
        // Not the mean of both velocities: the table may jump to a speed, or stop, in between.
        let displacement = std::mem::take(&mut self.displacement);
        let passed = time - self.time;
        let work_of_table = if passed > 0.0 { displacement.dot(&given) / passed } else { 0.0 };
        // Of a stage that went on from an older checkpoint it is not known before.
        let lost = self.of_weight.zip(now.of_weight).map_or(0.0, |(before, now)| before - now);
        self.of_weight = now.of_weight;
        balance.input += work_of_table + lost;
        balance.dissipated += work_of_table + self.energy - now.energy;
        let mut rise = now.energy - self.energy - work;
        if let Some(stored) = &mut self.stored {
            // Of what is no number nothing comes back.
            let back = rise.max(0.0).min(*stored);
            *stored -= back;
            rise -= back;
        }
        // Not `max`, which passes over what is no number.
        let gained = self.gained + rise;
        self.gained = if gained < 0.0 { 0.0 } else { gained };
        (self.energy, self.momentum, self.mass) = (now.energy, now.momentum, now.mass);
        (self.table, self.time) = (table, time);
    }
}

/// Engine steps between two looks at the momentum under a table of the given
/// frequency in Hz; a step has a length in s.
pub(super) fn steps_a_look(frequency: f64, step: f64) -> u64 {
    // What is whole but for rounding is whole.
    (1.0 / (LOOKS_A_CYCLE * frequency * step) + 1e-9).floor().max(1.0) as u64
}
