//! Coulomb friction of a block on a plane.

use super::*;

/// Sides in m, flat enough not to tip over on any slope of these cases.
pub(super) const BLOCK: Vector = Vector::new(0.02, 0.02, 0.006);

/// A block on a slope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Incline {
    friction: f64,
    share_of_friction_angle: f64,
    headings_deg: Vec<f64>,
    duration_s: f64,
    quantity: Quantity,
}

/// What is watched of a block on a slope, the worst heading counting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Distance moved, in mm.
    Drift,
    /// Acceleration over g (sin θ − μ cos θ).
    Acceleration,
}

impl Incline {
    /// The slope is made by tilting gravity, the heading by turning it about the
    /// normal: the block lies as it lies, and the solver's own directions with it.
    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let Self { friction, share_of_friction_angle, duration_s: duration, quantity, .. } = *self;
        let angle = share_of_friction_angle * friction.atan();
        let acceleration = (GRAVITY * (angle.sin() - friction * angle.cos())).max(0.0);
        let reach = (acceleration * duration * duration).max(0.2);
        let (y, end) = match quantity {
            Quantity::Drift => ("Distance moved (mm)", 0.0),
            Quantity::Acceleration => ("Speed down the slope (m/s)", acceleration * duration),
        };
        let mut outcome = Outcome::new("Time (s)", y);
        let mut found = Vec::new();
        for &degrees in &self.headings_deg {
            let down = heading(degrees);
            let gravity = GRAVITY * (angle.sin() * down - angle.cos() * Vector::z());
            let mut scene = floored(bench.scene_under(gravity, &uniform(friction, 0.0))?, reach)?;
            let start = Vector::new(0.0, 0.0, BLOCK.z / 2.0 + START_GAP);
            let id = scene.add(&block(BLOCK, start)?);
            let curve = scene.sampled(duration, 400, |scene, _| {
                let state = scene.state(id)?;
                let shown = match quantity {
                    Quantity::Drift => to_mm((state.pose.translation.vector - start).norm()),
                    Quantity::Acceleration => state.linear_velocity.dot(&down),
                };
                Ok((scene.time(), shown))
            })?;
            found.push(match quantity {
                Quantity::Drift => at_end(&curve),
                Quantity::Acceleration => at_end(&curve) / scene.time() / acceleration,
            });
            outcome.measured(format!("{degrees}°"), curve);
        }
        outcome.law("Known solution", vec![(0.0, 0.0), (duration, end)]);
        let error = |got: f64| match quantity {
            Quantity::Drift => got,
            Quantity::Acceleration => (got - 1.0).abs(),
        };
        Ok(outcome.got(worst_of(&found, error)))
    }
}

/// A sliding block. With `plate` it is of the plate's material and only its pair with
/// the wall has the stated friction, every other pair twice as much.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlideStops {
    speed_m_per_s: f64,
    friction: f64,
    headings_deg: Vec<f64>,
    plate: bool,
    start_gap_um: f64,
}

/// Distance in m of a body that starts with a speed and loses an acceleration's
/// worth of it in every step (sub-step, where the engine has those) before it moves.
fn in_steps(speed: f64, deceleration: f64, scene: &Scene) -> f64 {
    let step = scene.integration_step();
    let lost = deceleration * step;
    let n = (speed / lost).floor();
    step * (n * speed - lost * n * (n + 1.0) / 2.0)
}

impl SlideStops {
    pub(super) fn run(&self, bench: &Bench) -> Measured {
        let Self { speed_m_per_s: speed, friction, plate, start_gap_um, .. } = *self;
        let gap = start_gap_um * 1e-6;
        // In space and time without steps; the law in steps is below.
        let smooth = speed * speed / (2.0 * friction * GRAVITY);
        let pairs = if plate {
            with_plate(uniform(2.0 * friction, 0.0), Material::Wall, friction, 0.0)
        } else {
            uniform(friction, 0.0)
        };
        let mut outcome = Outcome::new("Time (s)", "Distance (mm)");
        let mut found = Vec::new();
        let duration = 1.5 * speed / (friction * GRAVITY);
        for &degrees in &self.headings_deg {
            let mut scene = floored(bench.scene(&pairs)?, 4.0 * smooth)?;
            let start = Vector::new(0.0, 0.0, BLOCK.z / 2.0 + gap);
            let mut body = block(BLOCK, start)?;
            body.state.linear_velocity = speed * heading(degrees);
            if plate {
                body.material = Material::Plate;
            }
            let id = scene.add(&body);
            let mut curve = vec![(0.0, 0.0)];
            let mut moved = 0.0;
            scene.follow(id, duration, |time, state| {
                moved = (state.pose.translation.vector - start).xy().norm();
                curve.push((time, to_mm(moved)));
            })?;
            found.push(moved / in_steps(speed, friction * GRAVITY, &scene));
            outcome.measured(format!("{degrees}°"), curve);
        }
        let stop = speed / (friction * GRAVITY);
        let parabola = over(duration, 100, |t| {
            let t_moving = t.min(stop);
            to_mm(speed * t_moving - 0.5 * friction * GRAVITY * t_moving * t_moving)
        });
        outcome.law("v t − μ g t²/2", parabola);
        Ok(outcome.got(worst_of(&found, |got| (got - 1.0).abs())))
    }
}
