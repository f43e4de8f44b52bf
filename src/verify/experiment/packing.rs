//! A packing of grains in a box, small enough to be run often.

use super::*;
use crate::grains::{GrainSet, streams};

/// Friction and restitution of the gravel (paper, section 3).
pub(super) const FRICTION: f64 = 0.793;
const RESTITUTION: f64 = 0.315;
/// Inner width of the box in m: about four grains.
pub(super) const WIDTH: f64 = 0.04;
const WALL: f64 = 0.02;
const SEED: u64 = 11;

/// A packing of grains in a box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OfGrains {
    pub(super) grains: usize,
    pub(super) settle_s: f64,
    pub(super) duration_s: f64,
    quantity: Quantity,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Change of the mean grain height over the duration, in mm, after settling.
    Creep,
    /// Grains still in the box after the duration of shaking at the paper's
    /// amplitude, over those put in; 1 only if their mass is there as well.
    GrainsKept,
    /// Largest rise of the total energy above its lowest value so far, in % of
    /// what the fall sets free, from the start to the end of the settling time.
    EnergyGain,
    /// Furthest that a vertex gets beyond a wall's inner face while shaken, in mm,
    /// with the grains added in several orders.
    BeyondWalls,
    /// Mean grain height with the grains added in other orders over that in the first order.
    OtherOrders,
    /// Difference of mean grain height in mm, after the duration, between
    /// going on and going on from poses and velocities alone.
    Reload,
    /// Mean grain height after settling, in mm.
    MeanHeight,
}

/// Grains in a box.
pub(super) struct Packing {
    pub scene: Scene,
    pub floor: BodyId,
    pub ids: Vec<BodyId>,
    pub bodies: Vec<Body>,
    walls: Vec<(BodyId, Pose)>,
}

/// Coefficients of a packing; the box's sides are of the plate's material, so
/// that they can have a friction of their own.
fn pairs(side_friction: f64) -> PairTable {
    with_plate(uniform(FRICTION, RESTITUTION), Material::Grain, side_friction, RESTITUTION)
}

impl Packing {
    /// Grains in loose layers above the floor, each turned at random; the
    /// order in which they are added is the `order`-th shuffle.
    pub fn new(bench: &Bench, count: usize, order: u64, side_friction: f64) -> Result<Self> {
        let set = grains(count, SEED)?;
        let mut bodies = laid_out(&set);
        if order > 0 {
            streams::shuffle(&mut streams::stream(SEED, &format!("order {order}")), &mut bodies);
        }
        Self::of(bench, bodies, side_friction)
    }

    /// The bodies as they are.
    pub fn of(bench: &Bench, bodies: Vec<Body>, side_friction: f64) -> Result<Self> {
        let mut scene = bench.scene(&pairs(side_friction))?;
        let highest = bodies.iter().map(|b| b.state.pose.translation.z).fold(0.0, f64::max);
        let height = highest + 0.05;
        let base = floor(WIDTH, Motion::Kinematic)?;
        let floor = scene.add(&base);
        let mut walls = vec![(floor, base.state.pose)];
        let off = (WIDTH + WALL) / 2.0;
        for mut body in walls_around(off, WALL, 2.0 * WIDTH, height, Motion::Kinematic)? {
            body.material = Material::Plate;
            walls.push((scene.add(&body), body.state.pose));
        }
        let ids = bodies.iter().map(|b| scene.add(b)).collect();
        Ok(Self { scene, floor, ids, bodies, walls })
    }

    /// Mass of all grains in kg.
    pub fn mass(&self) -> f64 {
        self.bodies.iter().map(|body| mass_of(body).0).sum()
    }

    /// Moves the whole box to a displacement along x (m) at the end of the next step.
    pub fn drive(&mut self, x: f64) -> Result<()> {
        for (id, pose) in &self.walls {
            self.scene.shift(*id, pose, Vector::new(x, 0.0, 0.0))?;
        }
        Ok(())
    }

    pub fn states(&mut self) -> Result<Vec<BodyState>> {
        self.scene.states(&self.ids)
    }

    /// Mean height of the grains' centroids in m.
    pub fn mean_height(&mut self) -> Result<f64> {
        Ok(mean_height(&self.states()?))
    }

    /// Goes on for a time in s: some mean heights in m, and when they were, in s since it began.
    pub fn heights(&mut self, time: f64, samples: u64) -> Result<Points> {
        let ids = &self.ids;
        self.scene.sampled(time, samples, |scene, n| {
            Ok((n as f64 * scene.time_step(), mean_height(&scene.states(ids)?)))
        })
    }

    /// Kinetic and potential energy of all grains in J.
    pub fn energy(&mut self) -> Result<f64> {
        let energy = |(s, body): (&BodyState, &Body)| {
            let (mass, inertia) = mass_of(body);
            0.5 * mass * s.linear_velocity.norm_squared()
                + spin(s, &inertia).1
                + mass * GRAVITY * s.pose.translation.z
        };
        Ok(self.states()?.iter().zip(&self.bodies).map(energy).sum())
    }

    /// The grains as they are now.
    pub fn as_now(&mut self) -> Result<Vec<Body>> {
        let states = self.states()?;
        let bodies = self.bodies.iter().zip(states);
        Ok(bodies.map(|(body, state)| Body { state, ..body.clone() }).collect())
    }
}

/// Mean height of centroids in m.
fn mean_height(states: &[BodyState]) -> f64 {
    states.iter().map(|s| s.pose.translation.z).sum::<f64>() / states.len() as f64
}

fn laid_out(set: &GrainSet) -> Vec<Body> {
    let reach = set.largest_bounding_radius();
    let across = (WIDTH / (2.0 * reach)).floor().max(1.0) as usize;
    let pitch = WIDTH / across as f64;
    set.grains
        .iter()
        .enumerate()
        .map(|(n, grain)| {
            let layer = n / (across * across);
            let (i, j) = (n % across, n / across % across);
            let centre = |i: usize| (i as f64 + 0.5) * pitch - WIDTH / 2.0;
            let at = Vector::new(centre(i), centre(j), (2.0 * layer as f64 + 1.0) * reach);
            let rotation = streams::rotation(&mut streams::stream(SEED, &format!("grain {n}")));
            grain_body(grain, Pose::from_parts(at.into(), rotation))
        })
        .collect()
}

impl OfGrains {
    pub(super) fn run(&self, bench: &Bench) -> Measured {
        match self.quantity {
            Quantity::Creep => self.creep(bench),
            Quantity::Reload => self.reload(bench),
            Quantity::GrainsKept => self.kept(bench),
            Quantity::BeyondWalls => self.beyond(bench),
            Quantity::EnergyGain => self.energy_gain(bench),
            Quantity::OtherOrders => self.other_orders(bench),
            Quantity::MeanHeight => {
                let mut outcome = Outcome::new("Time (s)", "Mean grain height (mm)");
                let (curve, height) = self.settled(bench, 0)?;
                outcome.measured("Engine", curve);
                Ok(outcome.got(to_mm(height)))
            }
        }
    }

    /// The packing in an order, with the friction of the gravel on every surface.
    pub(super) fn in_order(&self, bench: &Bench, order: u64) -> Result<Packing> {
        Packing::new(bench, self.grains, order, FRICTION)
    }

    /// Lets a packing settle; the mean height in mm over time, and in m at the end.
    fn settled(&self, bench: &Bench, order: u64) -> Result<(Points, f64)> {
        let mut packing = self.in_order(bench, order)?;
        let heights = packing.heights(self.settle_s, 300)?;
        let in_mm = heights.into_iter().map(|(time, height)| (time, to_mm(height)));
        Ok((in_mm.collect(), packing.mean_height()?))
    }

    fn energy_gain(&self, bench: &Bench) -> Measured {
        let mut packing = self.in_order(bench, 0)?;
        let start = packing.energy()?;
        let mut outcome = Outcome::new("Time (s)", "Energy of the grains (J)");
        let (mut curve, mut lowest, mut gain) = (vec![(0.0, start)], start, 0.0_f64);
        for _ in 0..packing.scene.steps_in(self.settle_s) {
            packing.scene.step()?;
            let now = packing.energy()?;
            gain = largest([gain, now - lowest]);
            lowest = lowest.min(now);
            curve.push((packing.scene.time(), now));
        }
        outcome.measured("Kinetic and potential", curve);
        Ok(outcome.got(100.0 * gain / (start - lowest)))
    }

    fn other_orders(&self, bench: &Bench) -> Measured {
        const ORDERS: u64 = 4;
        let mut outcome = Outcome::new("Time (s)", "Mean grain height (mm)");
        let mut heights = Vec::new();
        for order in 0..=ORDERS {
            let (curve, height) = self.settled(bench, order)?;
            let name = if order == 0 { "As cut".into() } else { format!("Order {order}") };
            outcome.measured(name, curve);
            heights.push(height);
        }
        let others = heights[1..].iter().sum::<f64>() / ORDERS as f64;
        Ok(outcome.got(others / heights[0]))
    }
}
