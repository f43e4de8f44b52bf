//! How spheres roll, slide, bounce and meet.

use super::*;

const RADIUS: f64 = 0.005;

fn ball(at: Vector, velocity: Vector) -> Body {
    let mut ball =
        free(ConvexPolyhedron::ball(RADIUS), 2500.0, Pose::translation(at.x, at.y, at.z));
    ball.state.linear_velocity = velocity;
    ball
}

/// On a slab whose normal leans by an angle against gravity, so far along it after a time.
fn on_incline(engine: &Engine, degrees: f64, friction: f64, time: f64) -> (BodyState, f64) {
    let angle = degrees.to_radians();
    let gravity = Vector::new(angle.sin(), 0.0, -angle.cos()) * 9.81;
    let mut world = engine.world_under(gravity, &uniform(friction, 0.0));
    world.add(&slab(Motion::Static)).expect("added");
    let id = world.add(&ball(Vector::new(-0.15, 0.0, RADIUS), Vector::zeros())).expect("added");
    let count = (time / world.time_step()).round() as u32;
    steps(world.as_mut(), count);
    (state(world.as_ref(), id), f64::from(count) * world.time_step())
}

#[test]
fn a_sphere_rolls_down_an_incline_that_is_not_too_steep() {
    each(|engine| {
        // tan 10° = 0.176 is at most 3.5 μ.
        for friction in [0.06, 0.5] {
            let (now, time) = on_incline(engine, 10.0, friction, 0.4);
            let acceleration = 5.0 / 7.0 * 9.81 * 10.0_f64.to_radians().sin();
            let speed = acceleration * time;
            let law = format!("a = 5/7 g sin θ, μ = {friction}: speed, m/s");
            engine.expect(&law, speed, now.linear_velocity.x, 0.01 * speed);
            let law = format!("v = ω r, μ = {friction}: ω r, m/s");
            let rolled = now.angular_velocity.y * RADIUS;
            engine.expect(&law, now.linear_velocity.x, rolled, 0.01 * speed);
            engine.expect("it stays on the slab, m", RADIUS, now.pose.translation.z, 3e-5);
            let aside = now.angular_velocity.xz().norm() * RADIUS + now.linear_velocity.y.abs();
            engine.expect("it turns about y alone", 0.0, aside, 1e-3 * speed);
        }
    });
}

#[test]
fn a_sphere_slides_down_a_steep_incline() {
    each(|engine| {
        // tan 30° = 0.577 is more than 3.5 μ = 0.35.
        let friction = 0.1;
        let (now, time) = on_incline(engine, 30.0, friction, 0.3);
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let speed = 9.81 * (sin - friction * cos) * time;
        let law = "a = g (sin θ - μ cos θ): speed, m/s";
        engine.expect(law, speed, now.linear_velocity.x, 0.01 * speed);
        let spin = 2.5 * friction * 9.81 * cos / RADIUS * time;
        let law = "α = 5/2 μ g cos θ / r: ω, rad/s";
        engine.expect(law, spin, now.angular_velocity.y, 0.02 * spin);
    });
}

#[test]
fn a_sliding_sphere_ends_up_rolling_at_five_sevenths_of_its_speed() {
    each(|engine| {
        let mut world = engine.world(&uniform(0.3, 0.0));
        world.add(&slab(Motion::Static)).expect("added");
        let (speed, from) = (0.5, Vector::new(-0.15, 0.0, RADIUS));
        let id = world.add(&ball(from, Vector::x() * speed)).expect("added");
        // It slides for 2/7 v / (μ g), 0.049 s.
        steps(world.as_mut(), 48);
        let now = state(world.as_ref(), id);
        let expected = 5.0 / 7.0 * speed;
        engine.expect("v = 5/7 v0, m/s", expected, now.linear_velocity.x, 0.01 * speed);
        engine.expect("ω r = v, m/s", expected, now.angular_velocity.y * RADIUS, 0.01 * speed);
        steps(world.as_mut(), 144);
        let later = state(world.as_ref(), id).linear_velocity.x;
        engine.expect("and goes on so, m/s", now.linear_velocity.x, later, 0.002 * speed);
    });
}

/// Stock Bullet contacts lose restitution where a body is not stopped at the surface, as with
/// blocks (case `rebound` of the verification).
fn loses_restitution(engine: &Engine) -> bool {
    (engine.backend, engine.settings.contact_solver) == (Backend::Bullet, ContactSolver::Stock)
}

#[test]
fn a_sphere_rebounds_with_the_coefficient_of_restitution() {
    each(|engine| {
        for restitution in [0.0, 0.5, 0.9] {
            let weightless = Vector::zeros();
            let mut world = engine.world_under(weightless, &uniform(0.5, restitution));
            world.add(&slab(Motion::Static)).expect("added");
            let speed = 1.0;
            let at = Vector::new(0.0, 0.0, RADIUS + 0.0213);
            let id = world.add(&ball(at, -Vector::z() * speed)).expect("added");
            steps(world.as_mut(), 20);
            let now = state(world.as_ref(), id);
            let law = format!("v' = e v, e = {restitution}, m/s");
            let up = now.linear_velocity.z;
            if loses_restitution(engine) {
                assert!((0.0..=restitution * speed + 0.3).contains(&up), "stock, e v: got {up}");
            } else {
                engine.expect(&law, restitution * speed, up, 0.02 * speed);
            }
            let rest = now.linear_velocity.xy().norm() + now.angular_velocity.norm() * RADIUS;
            engine.expect("straight up, without spin", 0.0, rest, 1e-6);
        }
    });
}

#[test]
fn spheres_collide_centrally() {
    each(|engine| {
        for restitution in [0.0, 0.6, 1.0] {
            let mut world = engine.world_under(Vector::zeros(), &uniform(0.5, restitution));
            let speed = 0.8;
            let one = ball(Vector::new(-0.03, 0.0, 0.0), Vector::x() * speed);
            let one = world.add(&one).expect("added");
            let two = world.add(&ball(Vector::zeros(), Vector::zeros())).expect("added");
            steps(world.as_mut(), 24);
            let velocity = |id| state(world.as_ref(), id).linear_velocity;
            for (name, id, share) in
                [("hit", two, 1.0 + restitution), ("hitting", one, 1.0 - restitution)]
            {
                let law = format!("the {name} one has (1 ± e)/2 v, e = {restitution}, m/s");
                let lost = if loses_restitution(engine) { 0.3 } else { 0.02 };
                engine.expect(&law, share / 2.0 * speed, velocity(id).x, lost * speed);
                engine.expect("nothing aside", 0.0, velocity(id).yz().norm(), 1e-6);
            }
            let sum = velocity(one).x + velocity(two).x;
            engine.expect("momentum", speed, sum, engine.precision(1e-6, 1e-5) * speed);
        }
    });
}

#[test]
fn a_sphere_rests_on_one_point_that_bears_its_weight() {
    each(|engine| {
        let mut world = engine.world(&uniform(0.5, 0.0));
        let floor = world.add(&slab(Motion::Static)).expect("added");
        let body = ball(Vector::new(0.01, -0.02, RADIUS), Vector::zeros());
        let id = world.add(&body).expect("added");
        steps(world.as_mut(), 240);
        let contacts = contacts(world.as_ref());
        assert_eq!(contacts.len(), 1, "{:?}: law: one contact point", engine.backend);
        let contact = contacts[0];
        let sign = if contact.a == floor { -1.0 } else { 1.0 };
        let weight = 9.81 * mass(&body);
        let force = sign * contact.impulse.z / world.time_step();
        engine.expect("it bears the weight, N", weight, force, 0.02 * weight);
        engine.expect("the normal is upright", 1.0, sign * contact.normal.z, 1e-6);
        let now = state(world.as_ref(), id);
        let below = now.pose.translation.vector - Vector::z() * RADIUS;
        engine.expect("it is below the centre, m", 0.0, (contact.point - below).norm(), 2e-5);
        engine.expect("and nothing moves, m/s", 0.0, now.linear_velocity.norm(), 1e-3);
    });
}

#[test]
fn a_sphere_is_read_back_with_its_radius() {
    each(|engine| {
        let mut world = engine.world(&uniform(0.5, 0.0));
        world.add(&ball(Vector::zeros(), Vector::zeros())).expect("added");
        steps(world.as_mut(), 2);
        let mut corners = Vec::new();
        world.corners(&mut corners);
        let held = corners[0].clone().expect("it is there").corners;
        assert_eq!(held.len(), 1, "{:?}: law: one point, on the surface", engine.backend);
        engine.expect("the radius is held, m", RADIUS, held[0].norm(), 1e-9);
    });
}
