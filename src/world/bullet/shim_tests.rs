//! What the C++ side refuses by itself, whatever Rust has let through: every
//! exception comes back as an error with its words, and ends nothing.

use super::definition::tolerances;
use super::ffi::{chained_work, shared_sum, shared_time};
use super::tests::{
    GRAVITY, exclusive_turn, free_box, native_world, shared_turn, slab, state, steps, uniform,
};
use super::*;
use crate::scale::Scale;
use crate::scenario::ContactSolver;

const PATHS: [ContactSolver; 2] = [ContactSolver::Stock, ContactSolver::Native];

/// Other values of what Bullet keeps once for the whole process.
const OTHERWISE: [fn(&mut ffi::WorldDefinition); 2] =
    [|d| d.broadphase_margin *= 2.0, |d| d.contact_threshold *= 2.0];

/// An empty world, past all that Rust checks.
fn bare(path: ContactSolver) -> cxx::UniquePtr<ffi::BulletWorld> {
    made(path, |_| {}, 9).expect("a world")
}

fn made(
    path: ContactSolver,
    change: impl FnOnce(&mut ffi::WorldDefinition),
    pairs: usize,
) -> Result<cxx::UniquePtr<ffi::BulletWorld>, cxx::Exception> {
    let settings = EngineSettings { contact_solver: path, ..Default::default() };
    let mut definition = definition(&settings, GRAVITY, 3).expect("settings");
    change(&mut definition);
    let pair = || ffi::PairValue { friction: 0.5, restitution: 0.0 };
    let pairs: Vec<_> = std::iter::repeat_with(pair).take(pairs).collect();
    ffi::new_world(&definition, &pairs)
}

/// A tetrahedron of a centimetre.
fn tetrahedron() -> ffi::ShapeDefinition {
    ffi::ShapeDefinition {
        radius: 0.0,
        coordinates: vec![0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01],
        face_starts: vec![0, 3, 6, 9, 12],
        face_vertices: vec![0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3],
    }
}

fn body(shape: u32, material: u32) -> ffi::BodyDefinition {
    ffi::BodyDefinition {
        shape,
        kind: ffi::BodyKind::Free,
        material,
        mass: 1e-3,
        inertia: [1e-7; 3],
        position: [0.0; 3],
        rotation: [0.0, 0.0, 0.0, 1.0],
        linear_velocity: [0.0; 3],
        angular_velocity: [0.0; 3],
    }
}

/// Asserts that a shim threw, and said so.
fn assert_thrown<T>(got: Result<T, cxx::Exception>, words: &str, what: &str) {
    let said = got.err().map(|e| e.what().to_owned());
    assert!(
        said.as_deref().is_some_and(|said| said.contains(words)),
        "law: {what} comes back as an error that says `{words}`, got {said:?}"
    );
}

/// Shapes that lead out of their lists or are no solids.
fn malformed() -> Vec<(&'static str, ffi::ShapeDefinition)> {
    let spoilt = |_what: &str, words, spoil: fn(&mut ffi::ShapeDefinition)| {
        let mut shape = tetrahedron();
        spoil(&mut shape);
        (words, shape)
    };
    let (vertices, faces, closed) = ("three finite numbers", "follow one another", "closed");
    let radius = "negative or not finite";
    vec![
        spoilt("no vertex", vertices, |s| s.coordinates.clear()),
        spoilt("half a vertex", vertices, |s| s.coordinates.truncate(11)),
        spoilt("not a number", vertices, |s| s.coordinates[4] = f64::NAN),
        spoilt("infinite", vertices, |s| s.coordinates[4] = f64::INFINITY),
        spoilt("corners of nothing", vertices, |s| {
            s.radius = 0.001;
            s.coordinates.clear();
            s.face_starts.clear();
        }),
        spoilt("a ball of less than nothing", radius, |s| s.radius = -0.001),
        spoilt("a ball of no number", radius, |s| s.radius = f64::NAN),
        spoilt("an infinite ball", radius, |s| s.radius = f64::INFINITY),
        spoilt("no list of faces", faces, |s| s.face_starts.clear()),
        spoilt("no face", faces, |s| s.face_starts.truncate(1)),
        spoilt("beginning late", faces, |s| s.face_starts[0] = 1),
        spoilt("ending late", faces, |s| s.face_starts[4] = 4000),
        spoilt("ending early", faces, |s| s.face_starts[4] = 10),
        spoilt("turning back", faces, |s| s.face_starts[2] = 1),
        spoilt("two corners", faces, |s| s.face_starts[1] = 2),
        spoilt("an unknown vertex", closed, |s| s.face_vertices[0] = 4),
        spoilt("a far vertex", closed, |s| s.face_vertices[0] = u32::MAX),
        spoilt("a face turned over", closed, |s| s.face_vertices.swap(0, 1)),
        spoilt("a corner twice", closed, |s| {
            s.face_vertices.insert(0, 0);
            s.face_starts[1..].iter_mut().for_each(|start| *start += 1);
        }),
        spoilt("a vertex in no face", "in no face", |s| s.coordinates.extend([0.001; 3])),
        spoilt("a hole", closed, |s| {
            s.face_starts.pop();
            s.face_vertices.truncate(9);
        }),
    ]
}

#[test]
fn malformed_hulls_come_back_as_errors() {
    let _turn = shared_turn();
    for path in PATHS {
        let mut world = bare(path);
        for (i, (words, shape)) in malformed().iter().enumerate() {
            let added = world.pin_mut().add_shape(shape);
            assert_thrown(added, words, &format!("hull {i} on {path:?}"));
        }
        let shape = world.pin_mut().add_shape(&tetrahedron());
        let shape = shape.expect("law: a sound one is taken after them");
        world.pin_mut().add_body(&body(shape, 0)).expect("law: and its bodies");
        world.pin_mut().step(false).expect("law: and steps");
    }
    for (i, (words, shape)) in malformed().iter().enumerate() {
        for (a, b) in [(shape, &tetrahedron()), (&tetrahedron(), shape)] {
            let made = ffi::new_hull_probe(100.0, &tolerances(&Scale::PAPER), false, a, b);
            assert_thrown(made, words, &format!("probed hull {i}"));
        }
    }
    let mut most = tetrahedron();
    most.coordinates = [0.01; 3 * 70_000].to_vec();
    let added = bare(PATHS[1]).pin_mut().add_shape(&most);
    assert_thrown(added, "70000 vertices", "a hull of too many vertices");
}

/// Law: a hull of more edges than packed features have numbers for is refused; one of as many is
/// not.
#[test]
fn hulls_of_too_many_edges_are_refused_bodies() {
    let _turn = shared_turn();
    let cylinder = |sides: u32| {
        let corner = |k: u32| (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
        let outline: Vec<(f64, f64)> = (0..sides).map(corner).map(|(y, x)| (x, y)).collect();
        Arc::new(ConvexPolyhedron::prism(&outline, -0.5, 0.5).expect("a prism"))
    };
    for (sides, fits) in [(5460, true), (5461, false)] {
        let shape = cylinder(sides);
        for path in PATHS {
            let settings = EngineSettings { contact_solver: path, ..Default::default() };
            let world = BulletBackend::new(&settings, GRAVITY, &uniform(0.5, 0.0));
            let floor = Body { shape: Arc::clone(&shape), ..slab(Motion::Static) };
            let added = world.expect("a world").add(&floor);
            let refused = matches!(
                &added,
                Err(WorldError::BadBody(reason))
                    if reason.contains("16383 edges") && reason.contains("16382")
            );
            assert!(
                if fits { added.is_ok() } else { refused },
                "law: {sides} sides on {path:?} fit: {fits}, got {added:?}"
            );
        }
    }
}

#[test]
fn what_a_world_has_not_comes_back_as_an_error() {
    let _turn = shared_turn();
    for path in PATHS {
        let mut world = bare(path);
        let shape = world.pin_mut().add_shape(&tetrahedron()).expect("added");
        for (shape, material) in [(shape + 1, 0), (u32::MAX, 0), (shape, 3), (shape, u32::MAX)] {
            let what = format!("shape {shape} of material {material}");
            let added = world.pin_mut().add_body(&body(shape, material));
            assert_thrown(added, "that this world has not", &what);
        }
        let id = world.pin_mut().add_body(&body(shape, 2)).expect("added");
        world.pin_mut().remove_body(id).expect("removed");
        for id in [id, 1, u32::MAX] {
            let words = format!("no body {id} in this world");
            assert_thrown(world.pin_mut().remove_body(id), &words, "removing");
            let driven = world.pin_mut().drive_body(id, &body_pose(&Pose::identity()));
            assert_thrown(driven, &words, "driving");
            assert_thrown(world.pair_value(id, id), &words, "asking for its coefficients");
        }
        world.pin_mut().step(false).expect("law: the world goes on");
    }
    let shape = tetrahedron();
    let mut pair = ffi::new_hull_probe(100.0, &tolerances(&Scale::PAPER), false, &shape, &shape)
        .expect("a pair");
    let set = pair.pin_mut().set_impulse(4, 1.0, &[0.0; 3]);
    assert_thrown(set, "no such contact point", "an impulse of no point");
}

#[test]
fn worlds_that_cannot_be_come_back_as_errors() {
    let _turn = exclusive_turn();
    for path in PATHS {
        for pairs in [0, 8, 10] {
            assert_thrown(made(path, |_| {}, pairs), "not square", "a table of pairs");
        }
        for threads in [0, -1] {
            let none = made(path, |d| d.threads = threads, 9);
            assert_thrown(none, "one thread", "a world of no thread");
        }
        for otherwise in OTHERWISE {
            let first = bare(path);
            let second = made(path, otherwise, 9);
            if path == ContactSolver::Stock {
                assert_thrown(second, "whole process", "another margin or threshold");
            } else {
                assert!(second.is_ok(), "law: a native world reads nothing of the process");
            }
            drop(first);
            let third = made(path, otherwise, 9);
            assert!(third.is_ok(), "law: what failed holds nothing");
        }
    }
}

#[test]
fn native_worlds_live_beside_any_stock_world() {
    let _turn = exclusive_turn();
    for ([first, other], otherwise) in
        [PATHS, [PATHS[1], PATHS[0]]].into_iter().flat_map(|paths| OTHERWISE.map(|o| (paths, o)))
    {
        let _first = bare(first);
        let beside = made(other, otherwise, 9);
        assert!(beside.is_ok(), "law: beside {first:?} one of {other:?} lives");
    }
}

#[test]
fn contacts_of_no_body_are_left_aside() {
    let _turn = shared_turn();
    let mut world = native_world(Default::default(), 0.5, 0.0);
    let floor = world.add(&slab(Motion::Static)).expect("added");
    let grain =
        world.add(&free_box(Vector::repeat(0.01), Vector::new(0.0, 0.0, 0.005))).expect("added");
    let one = |a: u32, b: u32, feature: [u32; 2]| RememberedContact {
        a: BodyId(a),
        b: BodyId(b),
        point: Vector::zeros(),
        normal: Vector::z(),
        force: Vector::z() * 0.01,
        warm_start: 1.0,
        feature,
    };
    let mut all =
        vec![one(7, 9, [0, 0]), one(u32::MAX, u32::MAX, [1, 1]), one(grain.0, grain.0, [1, 1])];
    // Every kind of feature, of faces and edges that the hulls have not, and
    // more points than a pair can have.
    for kind in 0..16 {
        all.push(one(floor.0, grain.0, [kind << 28 | 0x0fff_ffff, u32::MAX]));
    }
    world.recall(&all).expect("law: what does not fit is not taken");
    steps(&mut world, 10);
    let z = state(&world, grain).pose.translation.z;
    assert!((z - 0.005).abs() < 1e-3, "law: the box lies where it lay, 0.005 m to 1 mm, got {z}");
}

#[test]
fn what_fails_in_a_thread_comes_back_from_all_of_them() {
    for threads in [1, 2, 3, 8] {
        let size = 1000;
        let expected = 50 * (size as u64) * (size as u64 - 1) / 2;
        let got = shared_sum(threads, size, 50, usize::MAX).expect("law: nothing fails by itself");
        assert_eq!(got, expected, "law: {threads} threads add up what one does");
        // In the share of each thread, the caller's too.
        for fails_at in [0, 1, 250, 499, 500, 750, 999] {
            let failed = shared_sum(threads, size, 50, fails_at);
            let words = format!("asked to fail at {fails_at}");
            assert_thrown(failed, &words, &format!("what one of {threads} threads throws"));
        }
    }
    assert!(shared_sum(0, 10, 1, usize::MAX).is_err(), "law: no thread, no work");
    assert_eq!(shared_sum(4, 0, 3, usize::MAX).expect("nothing to do"), 0);
}

/// Law: shares of which a thread begins the next before others are done with the last give what
/// one thread gives, since each waits for the neighbours that it meets.
#[test]
fn threads_that_run_ahead_wait_where_they_meet() {
    for threads in [1, 2, 3, 8] {
        let [got, expected] = chained_work(threads, 2000).expect("shares");
        assert_eq!(got, expected, "law: {threads} threads make what one makes");
    }
    assert!(chained_work(0, 1).is_err(), "law: no thread, no work");
}

/// Law: what threads can share of a job would take 1/n of its time on n threads, but no less than
/// the least that a thread takes; shares follow each other.
#[test]
fn what_more_threads_would_save_is_told() {
    // Sizes and leasts of shares, and the part of the time that is left on 2, 8 and 16 threads.
    let cases: [(&[usize], &[usize], [f64; 3]); 5] = [
        (&[64], &[1], [1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0]),
        (&[24], &[8], [1.0 / 2.0, 1.0 / 3.0, 1.0 / 3.0]),
        // The second is one thread's, and does not count.
        (&[16, 8], &[1, 8], [1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0]),
        (&[16, 24], &[1, 8], [1.0 / 2.0, 3.0 / 19.0, 2.0 / 19.0]),
        (&[16, 0, 16], &[1, 8, 1], [1.0 / 2.0, 1.0 / 8.0, 1.0 / 16.0]),
    ];
    for (sizes, leasts, expected) in cases {
        let [now, on @ ..] = shared_time(1, sizes, leasts).expect("shares");
        assert!(now >= 0.9e-3, "law: one thread's time of what others can share, got {now} s");
        for (left, expected) in on.iter().zip(expected) {
            let got = left / now;
            assert!(
                (got - expected).abs() < 1e-3,
                "law: of {sizes:?} by {leasts:?} a part of {expected:.4} is left, got {got:.4}, \
                 tolerance 0.001"
            );
        }
    }
    // Nothing that pays for another thread's coming: nothing to share.
    let none = shared_time(2, &[8, 3], &[8, 8]).expect("shares");
    assert_eq!(none, [0.0; 4], "law: less than the least is one thread's");
    assert!(shared_time(1, &[1], &[]).is_err(), "law: a least for every size");
}

/// Functions of the bridge that return no `Result`, and why they need none:
/// they read, write into Rust's lists and compute, and allocate at most.
const CANNOT_FAIL: [&str; 15] = [
    "read_bodies",
    "read_corners",
    "read_drives",
    "read_contacts",
    "remember_contacts",
    "phases",
    "solver_residual",
    "record_substeps",
    "read_substep",
    "effective",
    "step", // of a probed pair; that of a world returns a Result
    "forget",
    "widest_gap",
    "bytes_handed_out",
    "crowd_speeds",
];

#[test]
fn every_shim_that_may_throw_says_so() {
    let source = include_str!("ffi.rs");
    let bridge = source.split("unsafe extern \"C++\"").nth(1).expect("the bridge");
    let functions: Vec<&str> = bridge.split(" fn ").skip(1).collect();
    assert!(functions.len() > 20, "the check sees the functions, got {}", functions.len());
    for function in functions {
        let name = function.split('(').next().unwrap_or_default();
        let declared = function.split(";\n").next().unwrap_or_default();
        let says_so = declared.contains("-> Result<");
        assert!(
            says_so || CANNOT_FAIL.contains(&name),
            "law: `{name}` returns a Result, or is listed with those that cannot fail"
        );
    }
}

/// What Bullet keeps once for the whole process and a program may change.
const OF_THE_PROCESS: [&str; 5] = [
    "btAlignedAllocSetCustom",
    "btAlignedAllocSetCustomAligned",
    "btSetCustomEnterProfileZoneFunc",
    "btSetCustomLeaveProfileZoneFunc",
    "btSetTaskScheduler",
];

/// Places of a C++ source where a variable of the process is changed: Bullet's
/// begin with `g` and a capital letter.
fn changed_globals(source: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (number, line) in source.lines().enumerate() {
        let code = line.split("//").next().unwrap_or_default();
        let words = code.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        for word in words.filter(|w| !w.is_empty()) {
            let mut letters = word.chars();
            let global = letters.next() == Some('g')
                && letters.next().is_some_and(|c| c.is_ascii_uppercase());
            let after = code.split(word).nth(1).unwrap_or_default().trim_start();
            let assigned = (after.starts_with('=') && !after.starts_with("=="))
                || ["++", "--", "+=", "-=", "|=", "&="].iter().any(|op| after.starts_with(op));
            if global && assigned || OF_THE_PROCESS.contains(&word) {
                found.push(format!("line {}: {}", number + 1, line.trim()));
            }
        }
    }
    found
}

#[test]
fn only_globals_cpp_changes_what_bullet_keeps_for_the_process() {
    for (source, expected) in [
        ("gDbvtMargin = 1;", 1),
        ("    gNumSomething++;", 1),
        ("if (gContactAddedCallback == nullptr) {", 0),
        ("x = gDbvtMargin;", 0),
        ("// gDbvtMargin = 1;", 0),
        ("gap = 1; gravity = 2;", 0),
        ("btAlignedAllocSetCustom(a, b);", 1),
    ] {
        let got = changed_globals(source);
        assert_eq!(got.len(), expected, "law: changes in `{source}`, got {got:?}");
    }
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("cpp");
    let mut changes = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the shims").flatten() {
        let source = std::fs::read_to_string(entry.path()).expect("text");
        let name = entry.file_name().into_string().expect("UTF-8");
        changes.extend(changed_globals(&source).into_iter().map(|c| (name.clone(), c)));
    }
    let (inside, outside): (Vec<_>, Vec<_>) = changes.iter().partition(|c| c.0 == "globals.cpp");
    assert_eq!(inside.len(), 4, "globals.cpp sets four of them, got {inside:?}");
    assert!(outside.is_empty(), "law: no other shim changes any: {outside:?}");
}
