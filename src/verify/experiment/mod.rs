//! The experiments, each a function of its numbers and a bench.

/// The built-in cases of one experiment, each with its numbers, `$least` at least.
#[cfg(test)]
macro_rules! cases_of {
    ($experiment:ident, $least:literal) => {{
        let cases = crate::verify::builtin().expect("sound").into_iter();
        let of_one = cases.filter_map(|case| match case.experiment.clone() {
            crate::verify::experiment::Experiment::$experiment(numbers) => Some((case, numbers)),
            _ => None,
        });
        let found: Vec<_> = of_one.collect();
        assert!(found.len() >= $least, "expected {} cases, found {}", $least, found.len());
        found
    }};
}

mod arrest;
mod drag;
mod drag_law;
mod flight;
mod friction;
mod impact;
mod impact_law;
mod inner_edge;
mod invariance;
mod mass;
mod ode;
mod packing;
mod packing_stability;
mod pivot;
mod rebound;
mod resting;
mod rocking;
mod round;
mod spin;
mod spin_law;
mod statics;
mod supports;
mod table;
mod top;

// What experiments are made of.
use std::f64::consts::TAU;

use nalgebra::{Matrix3, SVector, UnitQuaternion, Vector2};
use serde::{Deserialize, Serialize};

use super::scene::{
    START_GAP, Scene, block, floor, free, grain_body, grains, lowest, mass_of, piece, profile,
    solid, uniform, wall, walls_around, with_plate,
};
use super::{Bench, VerifyError, bench::GRAVITY};
use crate::geometry::{ConvexPolyhedron, Point, Pose, Vector};
use crate::units::{from_deg, from_mm, to_mm};
use crate::world::{Body, BodyId, BodyState, Material, Motion, PairTable};
use ode::runge_kutta;
use {flight::*, invariance::invariance, mass::properties, rebound::*, resting::*};

/// What becomes of a part of an experiment.
type Result<T, E = VerifyError> = std::result::Result<T, E>;
/// What becomes of an experiment.
type Measured = Result<Outcome>;
/// Points of a curve.
type Points = Vec<(f64, f64)>;

/// What an experiment measured, and the curves to show.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    /// The measured value, in the unit of the case.
    pub got: f64,
    /// What else is to be said.
    pub note: Option<String>,
    /// Name and unit of the horizontal axis.
    pub x: String,
    /// Name and unit of the vertical axis.
    pub y: String,
    /// Curves: what was measured, and what the law says.
    pub curves: Vec<Curve>,
}

/// A curve of the figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Whether it is the law's, not the engine's.
    pub law: bool,
    /// Points.
    pub points: Vec<(f64, f64)>,
}

impl Outcome {
    fn new(x: &str, y: &str) -> Self {
        Self { x: x.to_owned(), y: y.to_owned(), ..Self::default() }
    }

    /// What an engine did over time, and the law's curve.
    fn over_time(y: &str, engine: Points, name: &str, law: Points) -> Self {
        let mut outcome = Self::new("Time (s)", y);
        outcome.measured("Engine", engine);
        outcome.law(name, law);
        outcome
    }

    fn measured(&mut self, name: impl Into<String>, points: Points) {
        self.curves.push(Curve { name: name.into(), law: false, points });
    }

    fn law(&mut self, name: impl Into<String>, points: Points) {
        self.curves.push(Curve { name: name.into(), law: true, points });
    }

    fn said(mut self, note: String) -> Self {
        self.note = Some(note);
        self
    }

    fn got(mut self, got: f64) -> Self {
        self.got = got;
        self
    }
}

/// An experiment with its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Experiment {
    /// Known polyhedra turned, scaled and moved: largest relative error of
    /// volume, centroid and inertia.
    MassProperties,
    /// A cube let go: distance from the discrete solution at the end, in mm.
    FreeFall { height_mm: f64, duration_s: f64 },
    /// A cube thrown: distance from the discrete solution at the end, in mm.
    Projectile { speed_m_per_s: [f64; 3], duration_s: f64 },
    /// An irregular grain turning freely.
    Tumbling { spin_rad_per_s: [f64; 3], duration_s: f64, quantity: Tumbling },
    /// A box spun about its middle axis: time of the first flip over that of Euler's equations.
    Flip { spin_rad_per_s: f64, disturbance: f64 },
    /// Two grains collide without gravity: relative change of momentum, in %.
    Collision { speed_m_per_s: f64, friction: f64, restitution: f64 },
    /// A block on a slope of a share of the friction angle.
    Incline(friction::Incline),
    /// A block slides to rest: distance over v²/2μg, the worst heading.
    SlideStops(friction::SlideStops),
    /// A block on a shaking table: largest distance in mm between its travel
    /// on the table and the law's.
    BlockOnTable(table::BlockOnTable),
    /// A cube dropped flat: restitution from the rebound height, the rate with the largest error.
    Rebound { restitution: f64, height_mm: f64, rates_hz: Vec<f64> },
    /// A cube bounces: restitution from the heights of successive peaks, the
    /// one with the largest error.
    Bounces { restitution: f64, height_mm: f64, count: usize },
    /// A thin block slides and spins to rest: distance in mm, angle in rad or time in s.
    SpinSlide(spin::SpinSlide),
    /// Several of them: distance, angle or time over that of the law, the worst.
    SpinSlides(spin::SpinSlides),
    /// A block rocks from edge to edge: ratio of angular velocities at the
    /// first impact, or a peak over that of the law.
    RockingBlock(rocking::RockingBlock),
    /// A block falls over an edge or a corner: time over that of the pendulum.
    Pivot(pivot::Pivot),
    /// A top on its tip: precession or spin over that of the law.
    Top(top::Top),
    /// A tilted block falls on an edge or a corner: largest error of impulse
    /// and angular momentum, or what breaks a law, in %.
    ImpactTilted(impact::ImpactTilted),
    /// A level block falls on several points: largest error of the velocities in %.
    ImpactAtSeveralPoints(supports::ImpactAtSeveralPoints),
    /// A block is caught above a floor and let down on it: largest upward
    /// velocity in mm/s, or restitution from the rise.
    ApproachArrested(arrest::ApproachArrested),
    /// Blocks that stand by friction: the least friction coefficient.
    CriticalFriction(statics::CriticalFriction),
    /// A block slides over joints: distance from the path without joints, in mm.
    InnerEdge(inner_edge::InnerEdge),
    /// A block is pushed steadily over a joint and the step down behind it: mean force over μ m g.
    Dragged(drag::Dragged),
    /// A ball on a slope or a floor: speed or spin over that of the law, the worse.
    BallOnPlane(round::BallOnPlane),
    /// A ball slides off a body without friction: horizontal velocity over that of the law.
    SlidesOff(round::SlidesOff),
    /// Rounded cubes meet corner to corner: relative velocity after over before.
    CornersMeet(round::CornersMeet),
    /// A rounded block on steeper slopes: tangent at which it topples over that of the law.
    RoundedTopples(round::RoundedTopples),
    /// A body at rest: distance it moves in mm.
    Rests { body: RestingBody, settle_s: f64, duration_s: f64 },
    /// Grains piled three below, one above: largest movement in mm.
    GrainOnThree { settle_s: f64, duration_s: f64 },
    /// Cubes on top of each other, guided by walls or not: height lost in mm.
    Cubes { count: u32, guided: bool, duration_s: f64 },
    /// Grains in a box: vertical force on the floor over their weight.
    FloorForce { grains: usize, settle_s: f64, duration_s: f64 },
    /// A packing of grains in a box.
    Packing(packing::OfGrains),
    /// Another experiment under changes that should not matter: largest
    /// difference between the values got.
    Invariance { over: invariance::Change, of: Box<Experiment> },
}

/// What is watched of a tumbling grain; largest relative change, in %.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tumbling {
    AngularMomentum,
    /// Kinetic energy.
    Energy,
}

/// A body to lie still.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RestingBody {
    /// A cube of 10 mm.
    Cube,
    Grain,
}

impl Experiment {
    /// Whether it changes what the engine keeps for the whole process.
    pub fn needs_the_process(&self) -> bool {
        matches!(self, Self::Invariance { over: invariance::Change::LengthScale { .. }, .. })
    }

    /// Runs it.
    ///
    /// # Errors
    /// [`VerifyError`] when the engine fails or the event waited for does not come.
    pub fn run(&self, bench: &Bench) -> Result<Outcome> {
        match *self {
            Self::MassProperties => properties(),
            Self::FreeFall { height_mm, duration_s } => {
                flight(bench, Vector::z() * from_mm(height_mm), Vector::zeros(), duration_s)
            }
            Self::Projectile { speed_m_per_s, duration_s } => {
                flight(bench, Vector::zeros(), speed_m_per_s.into(), duration_s)
            }
            Self::Tumbling { spin_rad_per_s, duration_s, quantity } => {
                tumbling(bench, spin_rad_per_s.into(), duration_s, quantity)
            }
            Self::Flip { spin_rad_per_s, disturbance } => flip(bench, spin_rad_per_s, disturbance),
            Self::Collision { speed_m_per_s, friction, restitution } => {
                collision(bench, speed_m_per_s, friction, restitution)
            }
            Self::Incline(ref incline) => incline.run(bench),
            Self::SlideStops(ref slide) => slide.run(bench),
            Self::BlockOnTable(ref on_table) => on_table.run(bench),
            Self::Rebound { restitution, height_mm, ref rates_hz } => {
                rebound(bench, restitution, height_mm, rates_hz)
            }
            Self::Bounces { restitution, height_mm, count } => {
                bounces(bench, restitution, height_mm, count)
            }
            Self::SpinSlide(ref slide) => slide.run(bench),
            Self::SpinSlides(ref slides) => slides.run(bench),
            Self::RockingBlock(ref rocking) => rocking.run(bench),
            Self::Pivot(ref pivot) => pivot.run(bench),
            Self::Top(ref top) => top.run(bench),
            Self::ImpactTilted(ref impact) => impact.run(bench),
            Self::ImpactAtSeveralPoints(ref impact) => impact.run(bench),
            Self::ApproachArrested(ref arrested) => arrested.run(bench),
            Self::CriticalFriction(ref critical) => critical.run(bench),
            Self::InnerEdge(ref joints) => joints.run(bench),
            Self::Dragged(ref dragged) => dragged.run(bench),
            Self::BallOnPlane(ref ball) => ball.run(bench),
            Self::SlidesOff(ref ball) => ball.run(bench),
            Self::CornersMeet(ref cubes) => cubes.run(bench),
            Self::RoundedTopples(ref block) => block.run(bench),
            Self::Rests { body, settle_s, duration_s } => rests(bench, body, settle_s, duration_s),
            Self::GrainOnThree { settle_s, duration_s } => {
                grain_on_three(bench, settle_s, duration_s)
            }
            Self::Cubes { count, guided, duration_s } => cubes(bench, count, guided, duration_s),
            Self::FloorForce { grains, settle_s, duration_s } => {
                floor_force(bench, grains, settle_s, duration_s)
            }
            Self::Packing(ref packing) => packing.run(bench),
            Self::Invariance { ref over, ref of } => invariance(bench, over, of),
        }
    }
}

/// A scene on a floor of a half width (m) with one friction coefficient, on which nothing rebounds.
fn on_floor(bench: &Bench, half_width: f64, friction: f64) -> Result<Scene> {
    floored(bench.scene(&uniform(friction, 0.0))?, half_width)
}

/// A scene with a floor of a half width (m).
fn floored(mut scene: Scene, half_width: f64) -> Result<Scene> {
    scene.add(&floor(half_width, Motion::Static)?);
    Ok(scene)
}

fn in_m(mm: [f64; 3]) -> Vector {
    Vector::from(mm).map(from_mm)
}

/// A turn about y by an angle (rad), which takes z towards x.
fn about_y(angle: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector::y_axis(), angle)
}

/// A curve at equal parts of a time from 0 to an end.
fn over(end: f64, parts: u32, value: impl Fn(f64) -> f64) -> Points {
    let times = (0..=parts).map(|n| end * f64::from(n) / f64::from(parts));
    times.map(|time| (time, value(time))).collect()
}

/// Height in m of a body that falls from rest at a height under a gravity in m/s², and rebounds from
/// the floor with a coefficient of restitution, at a time in s.
fn rebounding(height: f64, gravity: f64, restitution: f64, time: f64) -> f64 {
    let fall = (2.0 * height / gravity).sqrt();
    let up = time - fall;
    if up < 0.0 {
        height - 0.5 * gravity * time * time
    } else {
        restitution * gravity * fall * up - 0.5 * gravity * up * up
    }
}

/// A curve that steps from one value to another at a time.
fn stepped(from: f64, to: f64, at: f64, end: f64) -> Points {
    vec![(0.0, from), (at, from), (at, to), (end, to)]
}

/// The unit vector of a direction in the horizontal plane, from x in degrees.
fn heading(degrees: f64) -> Vector {
    let (sin, cos) = from_deg(degrees).sin_cos();
    Vector::new(cos, sin, 0.0)
}

/// The value of a curve's last point; no number where there is none.
fn at_end(curve: &[(f64, f64)]) -> f64 {
    curve.last().map_or(f64::NAN, |point| point.1)
}

/// Halves a range as many times as asked. `holds` stays true at its upper end and false at its
/// lower one.
fn halved<E>(
    (mut low, mut high): (f64, f64),
    times: u32,
    mut holds: impl FnMut(f64) -> Result<bool, E>,
) -> Result<(f64, f64), E> {
    for _ in 0..times {
        let middle = 0.5 * (low + high);
        if holds(middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok((low, high))
}

/// How many contacts of the last step push.
fn pushing(scene: &Scene) -> usize {
    scene.contacts().iter().filter(|c| c.impulse.norm() > 0.0).count()
}

/// Runs an impact for each coefficient of restitution: the worst error in %, and words on each.
fn of_each(
    restitutions: &[f64],
    y: &str,
    mut one: impl FnMut(f64, &mut Outcome) -> Result<(f64, String)>,
) -> Measured {
    let mut outcome = Outcome::new("Time (s)", y);
    let (mut worst, mut notes) = (0.0_f64, Vec::new());
    for &restitution in restitutions {
        let (got, note) = one(restitution, &mut outcome)?;
        notes.push(format!("e = {restitution}: {note}"));
        worst = if got.is_nan() { got } else { worst.max(got) };
    }
    Ok(outcome.said(notes.join("; ")).got(worst))
}

/// Room in m below a body that is about to fall on something.
const ROOM: f64 = 0.5e-3;
/// Steps after which an impact is over, counted from when it began.
const OVER: u64 = 4;

/// Adds a body that meets something at a time (s), and steps until `over` steps after that: its
/// state at the end, and the curve of a value of it.
fn through_impact(
    scene: &mut Scene,
    body: &Body,
    meets: f64,
    over: u64,
    value: impl Fn(&BodyState) -> f64,
) -> Result<(BodyState, Points)> {
    let id = scene.add(body);
    let (mut curve, mut state) = (vec![(0.0, value(&body.state))], body.state);
    for _ in 0..(meets / scene.time_step()).ceil() as u64 + over {
        scene.step()?;
        state = scene.state(id)?;
        curve.push((scene.time(), value(&state)));
    }
    Ok((state, curve))
}

/// The value with the largest error; no number where there is none, or one is none.
fn worst_of(values: &[f64], error: impl Fn(f64) -> f64) -> f64 {
    let worse =
        |worst: f64, &v: &f64| if error(v) > error(worst) || v.is_nan() { v } else { worst };
    values.iter().fold(values.first().copied().unwrap_or(f64::NAN), worse)
}

/// The largest of numbers that are not negative, 0 of none; no number as soon as one
/// of them is none, which `f64::max` would pass over.
fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    let worse = |most: f64, n: f64| if most.is_nan() || n <= most { most } else { n };
    numbers.into_iter().fold(0.0, worse)
}

#[cfg(test)]
mod tests {
    use super::largest;

    #[test]
    fn the_largest_is_found_and_what_is_no_number_is_not_hidden() {
        assert_eq!(largest([]), 0.0);
        assert_eq!(largest([0.1, 0.3, 0.2]), 0.3);
        for at in 0..3 {
            let mut numbers = [0.1, 0.3, 0.2];
            numbers[at] = f64::NAN;
            assert!(largest(numbers).is_nan(), "law: what is no number is reported, at place {at}");
        }
    }
}
