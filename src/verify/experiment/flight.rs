//! Bodies that touch nothing, or only each other.

use super::*;

const CUBE: f64 = 0.01;

/// Against x₀ + v t − g h²·n(n+1)/2 for n steps of h: velocity first, then
/// position, once a step or once a sub-step where the engine has those.
pub(super) fn flight(bench: &Bench, from: Vector, velocity: Vector, duration: f64) -> Measured {
    let mut scene = bench.scene(&uniform(0.0, 0.0))?;
    let mut body = block(Vector::repeat(CUBE), from)?;
    body.state.linear_velocity = velocity;
    let id = scene.add(&body);
    let substeps = scene.integration_substeps();
    let law = |time: f64| {
        let h = bench.time_step() / substeps;
        let n = (time / h).round();
        from + velocity * time - Vector::z() * (GRAVITY * h * h * n * (n + 1.0) / 2.0)
    };
    let (mut measured, mut stated, mut off) = (Vec::new(), Vec::new(), 0.0);
    scene.follow(id, duration, |time, state| {
        let (at, expected) = (state.pose.translation.vector, law(time));
        off = to_mm((at - expected).norm());
        measured.push((time, to_mm(at.z)));
        stated.push((time, to_mm(expected.z)));
    })?;
    Ok(Outcome::over_time("Height (mm)", measured, "Discrete solution", stated).got(off))
}

/// Angular momentum about the centroid, and kinetic energy of turning.
pub(super) fn spin(state: &BodyState, inertia: &Vector) -> (Vector, f64) {
    let rotation = state.pose.rotation;
    let omega = rotation.inverse() * state.angular_velocity;
    let momentum = inertia.component_mul(&omega);
    (rotation * momentum, 0.5 * omega.dot(&momentum))
}

pub(super) fn tumbling(bench: &Bench, rate: Vector, duration: f64, quantity: Tumbling) -> Measured {
    let set = grains(20, 3)?;
    let mut body = grain_body(&set.grains[0], Pose::identity());
    body.state.angular_velocity = rate;
    let (_, inertia) = mass_of(&body);
    let mut scene = bench.scene_under(Vector::zeros(), &uniform(0.0, 0.0))?;
    let id = scene.add(&body);
    let (momentum, energy) = spin(&body.state, &inertia);
    let (mut curve, mut worst) = (Vec::new(), 0.0_f64);
    scene.follow(id, duration, |time, state| {
        let (l, e) = spin(&state, &inertia);
        let change = 100.0
            * match quantity {
                Tumbling::AngularMomentum => (l - momentum).norm() / momentum.norm(),
                Tumbling::Energy => e / energy - 1.0,
            };
        worst = if change.abs() > worst.abs() || change.is_nan() { change } else { worst };
        curve.push((time, change));
    })?;
    let law = vec![(0.0, 0.0), (scene.time(), 0.0)];
    Ok(Outcome::over_time("Relative change (%)", curve, "Known solution", law).got(worst))
}

/// Spin about each body axis by Euler's equations, integrated by the classical
/// Runge-Kutta method in steps small enough to count as exact.
fn euler_equations(inertia: &Vector, start: Vector, end: f64) -> Vec<(f64, Vector)> {
    const STEP: f64 = 1e-5;
    let rate = |w: &Vector| {
        Vector::new(
            (inertia.y - inertia.z) / inertia.x * w.y * w.z,
            (inertia.z - inertia.x) / inertia.y * w.z * w.x,
            (inertia.x - inertia.y) / inertia.z * w.x * w.y,
        )
    };
    let mut curve = vec![(0.0, start)];
    let mut w = start;
    for n in 1..=(end / STEP).round() as u64 {
        w = runge_kutta(&w, STEP, rate);
        if n.is_multiple_of(100) {
            curve.push((n as f64 * STEP, w));
        }
    }
    curve
}

/// First time at which a curve changes its sign, between its points.
fn first_crossing(curve: &[(f64, f64)]) -> Option<f64> {
    curve.windows(2).find(|w| w[0].1.signum() != w[1].1.signum()).map(|w| {
        let [(t0, y0), (t1, y1)] = [w[0], w[1]];
        t0 + (t1 - t0) * y0 / (y0 - y1)
    })
}

pub(super) fn flip(bench: &Bench, spin_rate: f64, disturbance: f64) -> Measured {
    // Moments ∝ 356, 292, 136: the middle axis is y.
    let mut body = block(Vector::new(0.006, 0.010, 0.016), Vector::zeros())?;
    let start = spin_rate * Vector::new(disturbance, 1.0, 0.0);
    body.state.angular_velocity = start;
    let (_, inertia) = mass_of(&body);
    // The disturbance grows no faster than the spin: ten turns are enough for e-fold growth
    // from a thousandth.
    let end = 10.0 * TAU / spin_rate;
    let law: Points =
        euler_equations(&inertia, start, end).into_iter().map(|(t, w)| (t, w.y)).collect();
    let mut scene = bench.scene_under(Vector::zeros(), &uniform(0.0, 0.0))?;
    let id = scene.add(&body);
    let mut curve = vec![(0.0, spin_rate)];
    scene.follow(id, end, |time, state| {
        curve.push((time, (state.pose.rotation.inverse() * state.angular_velocity).y));
    })?;
    let expected = first_crossing(&law).ok_or(VerifyError::NoEvent("a flip in the law itself"))?;
    let got = first_crossing(&curve).unwrap_or(f64::INFINITY);
    let y = "Spin about the middle axis (rad/s)";
    Ok(Outcome::over_time(y, curve, "Euler's equations", law)
        .said(format!("first flip after {got:.4} s, by Euler's equations {expected:.4} s"))
        .got(got / expected))
}

/// Two irregular grains meet off their centres, each spinning.
pub(super) fn collision(bench: &Bench, speed: f64, friction: f64, restitution: f64) -> Measured {
    let set = grains(20, 3)?;
    let mut scene = bench.scene_under(Vector::zeros(), &uniform(friction, restitution))?;
    let (mut ids, mut bodies) = (Vec::new(), Vec::new());
    for (index, side) in [-1.0, 1.0].into_iter().enumerate() {
        let grain = &set.grains[index];
        let at = Vector::new(side * 0.02, side * 0.0015, 0.0);
        let pose = Pose::from_parts(at.into(), UnitQuaternion::from_euler_angles(side, 0.5, 0.2));
        let mut body = grain_body(grain, pose);
        body.state.linear_velocity = Vector::new(-side * speed, 0.0, 0.1 * side * speed);
        body.state.angular_velocity = Vector::new(5.0, side * 3.0, 8.0);
        ids.push(scene.add(&body));
        bodies.push(body);
    }
    let totals = |states: &[BodyState]| {
        let (mut linear, mut angular) = (Vector::zeros(), Vector::zeros());
        for (state, body) in states.iter().zip(&bodies) {
            let (mass, inertia) = mass_of(body);
            let momentum = mass * state.linear_velocity;
            linear += momentum;
            angular += state.pose.translation.vector.cross(&momentum) + spin(state, &inertia).0;
        }
        (linear, angular)
    };
    let before: Vec<BodyState> = bodies.iter().map(|body| body.state).collect();
    let (linear, angular) = totals(&before);
    // What flows through the contact: the scale on which a change counts.
    let scale = mass_of(&bodies[0]).0 * speed;
    let mut outcome = Outcome::new("Time (s)", "Change of momentum (% of one grain's)");
    let (mut of_linear, mut of_angular, mut worst) = (Vec::new(), Vec::new(), 0.0_f64);
    let mut met = false;
    for _ in 0..scene.steps_in(0.06 / speed) {
        scene.step()?;
        met |= pushing(&scene) > 0;
        let (l, a) = totals(&scene.states(&ids)?);
        let change =
            (100.0 * (l - linear).norm() / scale, 100.0 * (a - angular).norm() / (scale * CUBE));
        of_linear.push((scene.time(), change.0));
        of_angular.push((scene.time(), change.1));
        worst = largest([worst, change.0, change.1]);
    }
    if !met {
        return Err(VerifyError::NoEvent("a collision"));
    }
    outcome.measured("Linear", of_linear);
    outcome.measured("Angular, over 10 mm", of_angular);
    outcome.law("Known solution", vec![(0.0, 0.0), (scene.time(), 0.0)]);
    Ok(outcome.got(worst))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eulers_equations_keep_energy_and_momentum() {
        let inertia = Vector::new(3.0, 2.0, 1.0);
        let curve = euler_equations(&inertia, Vector::new(0.1, 5.0, 0.2), 3.0);
        let energy = |w: &Vector| w.dot(&inertia.component_mul(w));
        let momentum = |w: &Vector| inertia.component_mul(w).norm();
        let (first, last) = (curve[0].1, curve.last().expect("points").1);
        for (law, before, after) in [
            ("energy is constant", energy(&first), energy(&last)),
            ("|L| is constant", momentum(&first), momentum(&last)),
        ] {
            let change = (after / before - 1.0).abs();
            assert!(change < 1e-10, "law: {law}, expected change 0, got {change}, tolerance 1e-10");
        }
    }

    #[test]
    fn crossings_are_found_between_points() {
        let got = first_crossing(&[(0.0, 2.0), (1.0, 1.0), (2.0, -3.0), (3.0, 1.0)]);
        assert_eq!(got, Some(1.25), "law: the line through (1, 1) and (2, -3) meets 0 at 1.25");
        assert_eq!(first_crossing(&[(0.0, 1.0), (1.0, 0.5)]), None);
    }
}
