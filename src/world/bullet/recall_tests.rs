//! Contacts that a world recalls from another: all of them are taken over,
//! whatever the order of the bodies.

use super::tests::{free_box, native_world, remembered, shared_turn, slab, snapshot, steps};
use super::*;
use crate::grains::generate;
use crate::scenario::{NativeSettings, SievedGrains};

/// Half the inner width of the trough that the specimen lies in, in m.
const HALF_WIDTH: f64 = 0.03;

fn world() -> BulletBackend {
    // Iterations that go on until forces are found would hide that one was not recalled.
    let native = NativeSettings { solver_tolerance: 1.0, ..Default::default() };
    native_world(native, 0.8, 0.3)
}

/// A floor and four walls, then some seventy grains and cubes above one another,
/// turned every which way; `seed` decides what grains they are.
pub(super) fn bodies(seed: u64) -> Vec<Body> {
    let mut bodies = vec![slab(Motion::Kinematic)];
    for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        let mut wall = slab(Motion::Static);
        let out = Vector::new(x, y, 0.0);
        let rotation = UnitQuaternion::rotation_between(&Vector::z(), &out).expect("no half turn");
        let place = out * (HALF_WIDTH + 0.01) + Vector::z() * 0.15;
        wall.state.pose = Pose::from_parts(place.into(), rotation);
        bodies.push(wall);
    }
    let spec: SievedGrains = serde_json::from_value(serde_json::json!({
        "total_mass_g": 100, "density_kg_per_m3": 2673.9,
        "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]
    }))
    .expect("grains");
    let set = generate(&spec, seed).expect("grains");
    let cubes = (0..20).map(|_| free_box(Vector::repeat(0.009), Vector::zeros()));
    let grains = set.grains.iter().map(|grain| Body {
        shape: Arc::clone(&grain.shape),
        motion: Motion::Free { mass: grain.mass, inertia: grain.inertia },
        ..free_box(Vector::repeat(0.01), Vector::zeros())
    });
    for (i, mut body) in (0_u32..).zip(grains.chain(cubes)) {
        let (x, y, z) = (f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9));
        let at = Vector::new(0.018 * (x - 1.0), 0.018 * (y - 1.0), 0.012 + 0.018 * z);
        let turn = Vector::new(x + 0.3 * z, 0.7 * y, 1.1 * z + 0.2 * x);
        body.state.pose = Pose::from_parts(at.into(), UnitQuaternion::from_scaled_axis(turn));
        bodies.push(body);
    }
    bodies
}

/// The bodies where they have come to rest, and their loaded contacts, by places
/// in the list of bodies.
struct Specimen {
    bodies: Vec<Body>,
    contacts: Vec<RememberedContact>,
}

fn settled() -> Specimen {
    let mut world = world();
    let mut bodies = bodies(1);
    for body in &bodies {
        world.add(body).expect("added");
    }
    steps(&mut world, 4 * 480);
    for (body, state) in bodies.iter_mut().zip(snapshot(&world)) {
        body.state = state.expect("none was removed");
    }
    Specimen { bodies, contacts: remembered(&world) }
}

/// Orders in which bodies may be added: as they were, the other way round, and
/// mixed, with walls between the grains.
fn orders(count: usize) -> Vec<(&'static str, Vec<usize>)> {
    let same: Vec<usize> = (0..count).collect();
    let reversed = same.iter().rev().copied().collect();
    // With no common divisor, each body comes once.
    let apart =
        |step: &usize| (2..=*step).all(|d| !(step.is_multiple_of(d) && count.is_multiple_of(d)));
    let step = (count / 3..).find(apart).expect("there are primes");
    let mixed = same.iter().map(|place| (place * step + 7) % count).collect();
    vec![("the same", same), ("reversed", reversed), ("mixed", mixed)]
}

/// A new world with the specimen in it, its bodies added in an order and its
/// contacts told; and where each body of the list is in it.
fn told(specimen: &Specimen, order: &[usize]) -> (BulletBackend, Vec<BodyId>) {
    let mut world = world();
    let mut ids = vec![BodyId(u32::MAX); order.len()];
    for &body in order {
        ids[body] = world.add(&specimen.bodies[body]).expect("added");
    }
    let of = |id: BodyId| ids[id.0 as usize];
    let contacts: Vec<_> = specimen
        .contacts
        .iter()
        .map(|c| RememberedContact { a: of(c.a), b: of(c.b), ..*c })
        .collect();
    world.recall(&contacts).expect("recalled");
    (world, ids)
}

/// A contact seen from the other body; features and points are numbered as in `cpp/hull_memory.h`.
fn turned(c: &RememberedContact) -> RememberedContact {
    let exchanged = |bits: u32| (bits & 0x3fff) << 14 | bits >> 14 & 0x3fff;
    let [feature, id] = c.feature;
    let feature = match feature >> 28 {
        1 => 2 << 28 | feature & 0x0fff_ffff,
        2 => 1 << 28 | feature & 0x0fff_ffff,
        3 => 3 << 28 | exchanged(feature),
        kind => panic!("a feature of kind {kind}"),
    };
    let id = if id >> 28 == 3 { 3 << 28 | exchanged(id) } else { id ^ 1 << 30 };
    RememberedContact {
        a: c.b,
        b: c.a,
        point: c.point,
        normal: -c.normal,
        force: -c.force,
        warm_start: c.warm_start,
        feature: [feature, id],
    }
}

#[test]
fn every_loaded_contact_is_recalled_whatever_the_order_of_the_bodies() {
    let _turn = shared_turn();
    let specimen = settled();
    let kinds: Vec<u32> = specimen.contacts.iter().map(|c| c.feature[0] >> 28).collect();
    assert!(
        (1..=3).all(|kind| kinds.iter().filter(|k| **k == kind).count() > 10),
        "the check sees faces of either body and edges: {kinds:?}"
    );
    for (name, order) in orders(specimen.bodies.len()) {
        let (mut world, ids) = told(&specimen, &order);
        world.find_contacts().expect("found");
        let number = |id: BodyId| ids.iter().position(|i| *i == id).expect("a body") as u32;
        let found: Vec<RememberedContact> = remembered(&world)
            .iter()
            .map(|c| RememberedContact { a: BodyId(number(c.a)), b: BodyId(number(c.b)), ..*c })
            .collect();
        let mut turned_round = 0;
        for c in &specimen.contacts {
            let same = |f: &&RememberedContact, c: &RememberedContact| {
                (f.a, f.b, f.feature) == (c.a, c.b, c.feature)
            };
            let as_told = found.iter().find(|f| same(f, c)).copied();
            let other = turned(c);
            let from_other = || found.iter().find(|f| same(f, &other)).map(turned);
            turned_round += usize::from(as_told.is_none());
            let Some(got) = as_told.or_else(from_other) else {
                panic!("law: every loaded contact is recalled, order {name}: {c:?} is not");
            };
            // A load is kept in single precision.
            let force = (got.force - c.force).norm() / c.force.norm();
            assert!(
                force < 1e-5,
                "law: with its force, order {name}, to 1e-5, got {force:.1e}: {c:?}, {got:?}"
            );
            assert_eq!(
                got.warm_start, c.warm_start,
                "law: with the share that the next step begins with, order {name}"
            );
            let normal = (got.normal - c.normal).norm();
            assert!(normal < 1e-5, "law: with its normal, order {name}, to 1e-5, got {normal:.1e}");
            // Points are found anew where the bodies are: up to 0.02 mm from where they
            // were held (HOLD in src/scale.rs).
            let point = (got.point - c.point).norm();
            assert!(point < 5e-5, "law: at its place, order {name}, to 0.05 mm, got {point:.1e} m");
        }
        let places: Vec<usize> = ids.iter().map(|id| id.0 as usize).collect();
        let changed =
            specimen.contacts.iter().filter(|c| places[c.a.0 as usize] > places[c.b.0 as usize]);
        assert_eq!(turned_round, changed.count(), "law: the other way round where bodies are");
        assert_eq!(turned_round > 0, name != "the same", "the check sees pairs turned round");
    }
}

/// Kinetic energy in J of a specimen after its first step in a new world.
fn energy(specimen: &Specimen, order: &[usize]) -> f64 {
    let (mut world, ids) = told(specimen, order);
    world.step().expect("a step");
    let states = snapshot(&world);
    let of = |(body, id): (&Body, &BodyId)| match body.motion {
        Motion::Free { mass, inertia } => {
            let state = states[id.0 as usize].expect("there");
            0.5 * mass * state.linear_velocity.norm_squared() + state.rotational_energy(&inertia)
        }
        _ => 0.0,
    };
    specimen.bodies.iter().zip(&ids).map(of).sum()
}

#[test]
fn a_specimen_stays_as_still_whatever_the_order_of_the_bodies() {
    let _turn = shared_turn();
    let mut specimen = settled();
    let orders = orders(specimen.bodies.len());
    let as_it_was = energy(&specimen, &orders[0].1);
    for (name, order) in &orders[1..] {
        let told = energy(&specimen, order);
        assert!(
            told < 2.0 * as_it_was,
            "law: as still as in the order that it had, {as_it_was:.2e} J, to a factor of 2; got \
             {told:.2e} J, order {name}"
        );
    }
    // Contacts that are not recalled are found again within the step; the check sees a body that
    // moves.
    let body = specimen.bodies.last_mut().expect("bodies");
    body.state.linear_velocity.z += 0.1;
    let moving = energy(&specimen, &orders[2].1);
    assert!(
        moving > 2.0 * as_it_was,
        "the check sees a body that moves: more than twice {as_it_was:.2e} J, got {moving:.2e} J"
    );
}
