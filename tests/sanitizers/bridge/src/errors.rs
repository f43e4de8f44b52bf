//! What the shims refuse: every failure comes back as an error.

use crate::worlds::{STILL, at, body, cuboid, definition, pairs, tolerances};
use crate::{BodyKind, ShapeDefinition, new_hull_probe, new_world, shared_sum};

/// Spoils a hull in one way.
type Spoil = fn(&mut ShapeDefinition);

const SPOILT: [Spoil; 12] = [
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
    }
    failures
}

/// Failures in each thread of several; how many.
pub fn in_threads() -> usize {
    let mut failures = 0;
    for threads in [1, 2, 3, 8] {
        let sum = shared_sum(threads, 1000, 50, usize::MAX).expect("nothing fails");
        assert_eq!(sum, 50 * 1000 * 999 / 2, "law: {threads} threads lose nothing");
        for fails_at in [0, 1, 250, 499, 500, 750, 999] {
            let failed = shared_sum(threads, 1000, 50, fails_at).err().expect("it fails");
            assert_eq!(failed.what(), format!("asked to fail at {fails_at}"));
            failures += 1;
        }
    }
    failures
}
