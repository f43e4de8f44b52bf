//! How rounded polyhedra rest, roll on an edge, bounce and slide.

use super::*;

fn rounded(sides: [f64; 3], radius: f64, at: Vector, turn: UnitQuaternion<f64>) -> Body {
    let core = ConvexPolyhedron::cuboid(Vector::from(sides)).expect("a core");
    let shape = ConvexPolyhedron::of_rounded(core, radius).expect("a rounded body");
    free(shape, 2500.0, Pose::from_parts(at.into(), turn))
}

#[test]
fn a_rounded_block_rests_on_its_face() {
    each(|engine| {
        let mut world = engine.world(&uniform(0.5, 0.0));
        let floor = world.add(&slab(Motion::Static)).expect("added");
        let body = rounded(
            [0.012, 0.01, 0.006],
            0.002,
            Vector::new(0.01, -0.02, 0.005),
            UnitQuaternion::identity(),
        );
        let id = world.add(&body).expect("added");
        steps(world.as_mut(), 480);
        let contacts = contacts(world.as_ref());
        let force: f64 = contacts
            .iter()
            .map(|c| c.impulse.z * if c.a == floor { -1.0 } else { 1.0 } / world.time_step())
            .sum();
        let weight = 9.81 * mass(&body);
        engine.expect("the floor bears the weight, N", weight, force, 0.02 * weight);
        // Stock Bullet contacts gather points over steps, and drop some.
        let native = engine.backend == Backend::Bullet
            && engine.settings.contact_solver == ContactSolver::Native;
        let least = if native { 4 } else { 3 };
        let count = contacts.len();
        assert!((least..=4).contains(&count), "{:?}: law: on a face, {count}", engine.backend);
        let now = state(world.as_ref(), id);
        engine.expect("it stays where it was put, m", 0.005, now.pose.translation.z, 3e-5);
        engine.expect("upright", 0.0, now.pose.rotation.angle(), 1e-3);
        engine.expect("nothing moves, m/s", 0.0, now.linear_velocity.norm(), 1e-3);
        engine.expect("nothing turns, rad/s", 0.0, now.angular_velocity.norm(), 0.02);
    });
}

/// Law: a long rod with a rounded edge of nearly the whole section rolls as a cylinder does: a rod
/// whose core is a thin square rolls down an incline with a = 2/3 g sin θ.
#[test]
fn a_rounded_rod_rolls_as_a_cylinder() {
    each(|engine| {
        let degrees: f64 = 10.0;
        let angle = degrees.to_radians();
        let gravity = Vector::new(angle.sin(), 0.0, -angle.cos()) * 9.81;
        let mut world = engine.world_under(gravity, &uniform(0.5, 0.0));
        world.add(&slab(Motion::Static)).expect("added");
        let (radius, core) = (0.005, 2e-4);
        let body = rounded(
            [core, 0.04, core],
            radius,
            Vector::new(-0.15, 0.0, radius + core / 2.0),
            UnitQuaternion::identity(),
        );
        let id = world.add(&body).expect("added");
        // Rolling already: it passes from edge to edge of its core.
        let count = (0.4 / world.time_step()).round() as u32;
        steps(world.as_mut(), count);
        let now = state(world.as_ref(), id);
        let Motion::Free { mass, inertia } = body.motion else { panic!("free") };
        let share = 1.0 / (1.0 + inertia.y / (mass * radius * radius));
        let speed = share * 9.81 * angle.sin() * f64::from(count) * world.time_step();
        engine.expect("speed, m/s", speed, now.linear_velocity.x, 0.04 * speed);
        let rolled = now.angular_velocity.y * (radius + core / 2.0);
        engine.expect("v = ω r, m/s", now.linear_velocity.x, rolled, 0.05 * speed);
        let aside = now.linear_velocity.y.abs();
        engine.expect("and not aside, m/s", 0.0, aside, 0.01 * speed);
    });
}

#[test]
fn a_rounded_cube_falls_on_its_corner_and_rebounds() {
    each(|engine| {
        // Frictionless, upright on a corner: no moment, the centre rebounds with e.
        let restitution = 0.6;
        let mut world = engine.world(&uniform(0.0, restitution));
        world.add(&slab(Motion::Static)).expect("added");
        let up =
            UnitQuaternion::rotation_between(&Vector::repeat(1.0), &Vector::z()).expect("a turn");
        let low = 0.006 * 3.0_f64.sqrt() + 0.002;
        let drop = 0.03;
        let body = rounded([0.012; 3], 0.002, Vector::new(0.0, 0.0, low + drop), up);
        let id = world.add(&body).expect("added");
        let mut highest: f64 = 0.0;
        let mut hit = false;
        for _ in 0..400 {
            steps(world.as_mut(), 1);
            let now = state(world.as_ref(), id);
            hit |= now.linear_velocity.z > 0.0;
            if hit {
                highest = highest.max(now.pose.translation.z - low);
                if now.linear_velocity.z < 0.0 {
                    break;
                }
            }
        }
        let lost = if engine.backend == Backend::Rapier
            || engine.settings.contact_solver == ContactSolver::Stock
        {
            0.35
        } else {
            0.05
        };
        let expected = restitution * restitution * drop;
        engine.expect("rises to e² of the drop, m", expected, highest, lost * expected);
    });
}

#[test]
fn a_rounded_body_is_read_back_with_its_core_and_radius() {
    each(|engine| {
        let mut world = engine.world(&uniform(0.5, 0.0));
        let body =
            rounded([0.012, 0.01, 0.006], 0.002, Vector::zeros(), UnitQuaternion::identity());
        world.add(&body).expect("added");
        steps(world.as_mut(), 2);
        let mut corners = Vec::new();
        world.corners(&mut corners);
        let held = corners[0].clone().expect("it is there");
        engine.expect("the radius is held, m", 0.002, held.rounding, 1e-9);
        assert_eq!(held.corners.len(), 8, "{:?}: law: the core's corners", engine.backend);
        let farthest = held.corners.iter().map(|c| c.norm()).fold(0.0, f64::max);
        let expected = Vector::new(0.006, 0.005, 0.003).norm();
        engine.expect("where they were given, m", expected, farthest, 2e-9);
    });
}
