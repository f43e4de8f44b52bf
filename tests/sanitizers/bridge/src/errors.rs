//! What the shims refuse: every failure comes back as an error.

use crate::worlds::{STILL, at, body, cuboid, definition, pairs, tolerances};
use crate::{
    BodyKind, PressDefinition, ShapeDefinition, chained_work, new_hull_probe, new_world,
    shared_sum, shared_time,
};

/// Spoils a hull in one way.
type Spoil = fn(&mut ShapeDefinition);

const SPOILT: [Spoil; 15] = [
    |s| s.coordinates.clear(),
    |s| s.coordinates.truncate(11),
    |s| s.coordinates[4] = f64::NAN,
    |s| s.face_starts.clear(),
    |s| s.face_starts.truncate(1),
    |s| s.face_starts[0] = 1,
    |s| s.face_starts[6] = 4000,
    |s| s.face_starts[2] = 1,
    |s| s.face_starts[1] = 2,
    |s| s.face_vertices[0] = 8,
    |s| s.face_vertices[0] = u32::MAX,
    |s| s.face_vertices.swap(0, 1),
    // A vertex in no face, a corner twice in a row, and corners alone.
    |s| s.coordinates.extend([0.001; 3]),
    |s| {
        let first = s.face_vertices[0];
        s.face_vertices.insert(0, first);
        s.face_starts[1..].iter_mut().for_each(|n| *n += 1);
    },
    |s| {
        s.radius = 0.001;
        s.coordinates.clear();
        s.face_starts.clear();
    },
];

/// Every failure there is; how many.
pub fn all() -> usize {
    let mut failures = in_threads();
    let mut failed = |failed: bool| {
        assert!(failed, "law: what makes no sense is refused, {failures} were");
        failures += 1;
    };
    for own in [false, true] {
        let sound = || cuboid([0.01; 3]);
        let mut world = new_world(&definition((own, 1, false, 8)), &pairs()).expect("a world");
        for spoil in SPOILT {
            let mut s = sound();
            spoil(&mut s);
            failed(world.pin_mut().add_shape(&s).is_err());
            failed(new_hull_probe(100.0, &tolerances(), false, &s, &sound()).is_err());
            failed(new_hull_probe(100.0, &tolerances(), true, &sound(), &s).is_err());
        }
        for (shape, material) in [(0, 0), (u32::MAX, 0)] {
            let mut body = body(shape, BodyKind::Free, [0.0; 3], 1.0, STILL);
            body.material = material;
            failed(world.pin_mut().add_body(&body).is_err());
        }
        failed(world.pin_mut().remove_body(4).is_err());
        failed(world.pin_mut().drive_body(4, &at([0.0; 3])).is_err());
        failed(world.pair_value(0, 1).is_err());
        let mut other = definition((own, 1, false, 8));
        other.broadphase_margin *= 2.0;
        // A native world reads nothing that Bullet has once for the process.
        let beside = new_world(&other, &pairs());
        if own {
            assert!(beside.is_ok(), "law: native worlds of two margins live together");
        } else {
            failed(beside.is_err());
        }
        failed(new_world(&definition((own, 0, false, 8)), &pairs()).is_err());
        failed(new_world(&definition((own, 1, false, 8)), &pairs()[..8]).is_err());
        let shape = world.pin_mut().add_shape(&sound()).expect("a shape");
        let [whole, part, other] = [(); 3].map(|()| {
            let body = body(shape, BodyKind::Free, [0.0; 3], 1.0, STILL);
            world.pin_mut().add_body(&body).expect("a body")
        });
        let press = PressDefinition {
            turns: false,
            direction: [0.0, 0.0, 1.0],
            about: [0.0; 3],
            mass: 1.0,
            speed: 0.0,
        };
        failed(world.pin_mut().press_body(whole, &press).is_err());
        failed(world.pin_mut().set_force(whole, 1.0).is_err());
        failed(world.pin_mut().join_body(whole, whole).is_err());
        let joined = world.pin_mut().join_body(part, whole);
        if own {
            joined.expect("one body");
            // The whole leaves before its part, and what has parts becomes a part.
            failed(world.pin_mut().remove_body(whole).is_err());
            failed(world.pin_mut().join_body(whole, other).is_err());
            world.pin_mut().remove_body(part).expect("removed");
            world.pin_mut().remove_body(whole).expect("removed");
        } else {
            failed(joined.is_err());
        }
    }
    failures
}

/// Failures in each thread of several; how many.
pub fn in_threads() -> usize {
    let mut failures = 0;
    for threads in [1, 2, 3, 8] {
        let sum = shared_sum(threads, 1000, 50, usize::MAX).expect("nothing fails");
        assert_eq!(sum, 50 * 1000 * 999 / 2, "law: {threads} threads lose nothing");
        let [got, expected] = chained_work(threads, 50).expect("nothing fails");
        assert_eq!(got, expected, "law: {threads} threads make what one makes");
        let times = shared_time(threads, &[8], &[1]).expect("nothing fails");
        assert!(times[0] > 0.0, "law: it takes time, got {times:?}");
        for fails_at in [0, 1, 250, 499, 500, 750, 999] {
            let failed = shared_sum(threads, 1000, 50, fails_at).err().expect("it fails");
            assert_eq!(failed.what(), format!("asked to fail at {fails_at}"));
            failures += 1;
        }
    }
    assert!(chained_work(0, 1).is_err(), "law: no thread, no work");
    assert!(shared_time(1, &[1], &[]).is_err(), "law: a least for every size");
    failures + 2
}
