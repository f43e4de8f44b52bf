//! The bridge to the C++ shims. All values are SI in double precision; the
//! shims scale them to engine units (`cpp/convert.h`).
//!
//! To add a binding: declare it here, implement it as a method of `BulletWorld` in
//! `cpp/world.{h,cpp}` (or a file of its own for a new concern, named in `build.rs`), return
//! `Result` when it can throw, pass many values in one slice, and validate in Rust
//! (`world/bullet/mod.rs`) before crossing. What returns no `Result` can fail by lack of memory
//! alone, which ends the program as it does in Rust; `shim_tests.rs` lists these.

#![allow(unsafe_code)] // cxx generates it; every function below is safe to call
#![cfg_attr(not(test), allow(dead_code))] // some are for unit tests alone

#[cxx::bridge(namespace = "pluvia")]
mod bridge {
    /// How a body moves.
    enum BodyKind {
        Static,
        Kinematic,
        Free,
    }

    /// How moments of inertia are found.
    enum InertiaRule {
        Exact,
        BoundingBox,
        BoundingBoxWithDefaultMargin,
    }

    /// Lengths of Pluvia's own contacts in m, made from the size of the grains
    /// (`scale.rs`, where each is explained).
    struct Tolerances {
        contact_margin: f64,
        closed_gap: f64,
        unsolved_gap: f64,
        hysteresis: f64,
        hold: f64,
        face_preference: f64,
        match_distance: f64,
        box_slack: f64,
    }

    /// Everything about a world that is fixed at its creation.
    struct WorldDefinition {
        /// Engine length units in a metre.
        length_scale: f64,
        /// Length of a step in s.
        time_step: f64,
        /// Gravity in m/s².
        gravity: [f64; 3],
        iterations: i32,
        /// Bits of Bullet's `btSolverMode`.
        solver_mode: i32,
        /// In m.
        contact_threshold: f64,
        /// Growth of the broadphase's leaves in m, of stock worlds.
        broadphase_margin: f64,
        tolerances: Tolerances,
        erp: f64,
        warm_start: f64,
        split_impulse: bool,
        /// In m/s.
        restitution_velocity_threshold: f64,
        linear_damping: f64,
        angular_damping: f64,
        gyroscopic: bool,
        /// Of every hull, in m.
        collision_margin: f64,
        inertia: InertiaRule,
        /// In kg; 0 for none.
        least_mass: f64,
        /// Share of the smaller body's radius; 0 for the absolute threshold.
        relative_contact_threshold: f64,
        sleeping: bool,
        /// In m/s.
        sleeping_speed: f64,
        /// In rad/s.
        sleeping_spin: f64,
        /// Number of materials; the pair table has its square.
        materials: usize,
        /// Contacts of Pluvia's own hull–hull test instead of Bullet's.
        own_collision: bool,
        /// Of a contact point of Pluvia's own solver, in N/m.
        contact_stiffness: f64,
        contact_damping_ratio: f64,
        /// In m/s.
        max_depenetration_velocity: f64,
        /// Of Pluvia's own solver in a step.
        substeps: i32,
        /// Over all contacts in a sub-step, at least.
        native_iterations: i32,
        /// What the last iteration may change of any body, as a share of what contacts change
        /// of a free one in a sub-step (root mean square).
        solver_tolerance: f64,
        /// That share the work of a step.
        threads: i32,
        /// Whether to use the instructions that every processor has.
        portable: bool,
        /// 8 in single precision, or 1 in double.
        contacts_at_once: u32,
    }

    /// Friction and restitution of a pair of materials.
    struct PairValue {
        friction: f64,
        restitution: f64,
    }

    /// A body to add.
    struct BodyDefinition {
        shape: u32,
        kind: BodyKind,
        material: u32,
        /// In kg.
        mass: f64,
        /// In kg m².
        inertia: [f64; 3],
        /// In m.
        position: [f64; 3],
        /// x, y, z, w.
        rotation: [f64; 4],
        /// In m/s.
        linear_velocity: [f64; 3],
        /// In rad/s, world axes.
        angular_velocity: [f64; 3],
    }

    /// How a pressed body moves: along a direction, or, where it `turns`, about an axis through a
    /// point.
    struct PressDefinition {
        turns: bool,
        direction: [f64; 3],
        /// In m.
        about: [f64; 3],
        /// In kg, or a moment of inertia about the axis in kg m².
        mass: f64,
        /// In m/s or rad/s.
        speed: f64,
    }

    /// State of a body; `present` is false where it was removed.
    struct BodyRead {
        present: bool,
        position: [f64; 3],
        rotation: [f64; 4],
        linear_velocity: [f64; 3],
        angular_velocity: [f64; 3],
    }

    /// Where a body is, or was.
    struct BodyPose {
        /// In m.
        position: [f64; 3],
        /// x, y, z, w.
        rotation: [f64; 4],
    }

    /// How a kinematic body goes through a step: velocities in its last sub-step, and
    /// accelerations, which are the same in all of them.
    #[derive(Debug, PartialEq)]
    struct DriveRead {
        id: u32,
        velocity: [f64; 3],
        acceleration: [f64; 3],
        spin: [f64; 3],
        spin_up: [f64; 3],
    }

    /// One contact point.
    struct ContactRead {
        a: u32,
        b: u32,
        point: [f64; 3],
        /// From `b` to `a`.
        normal: [f64; 3],
        gap: f64,
        /// On `a`, in N s.
        impulse: [f64; 3],
        /// Share of the impulse that the next step begins with.
        warm_start: f64,
        /// What touches, and which of its points this is; 0 unless remembered.
        feature: u32,
        id: u32,
    }

    /// A hull, a hull swept by a ball, or a sphere about the body's origin, which has no lists.
    #[derive(Default)]
    struct ShapeDefinition {
        /// Of a sphere, or of the ball that sweeps a hull, in m; 0 for a hull as it is.
        radius: f64,
        /// x, y, z of every vertex in m.
        coordinates: Vec<f64>,
        /// Corners of face f: `face_vertices[face_starts[f]..face_starts[f + 1]]`,
        /// counter-clockwise from outside.
        face_starts: Vec<u32>,
        face_vertices: Vec<u32>,
    }

    /// A contact point of a probed pair.
    struct HullProbePoint {
        gap: f64,
        /// From `b` to `a`.
        normal: [f64; 3],
        on_a: [f64; 3],
        on_b: [f64; 3],
        id: u32,
        /// Steps since the point appeared.
        age: i32,
        /// Normal impulse carried over, in N s.
        impulse: f64,
        /// Friction impulse carried over, in N s.
        friction: [f64; 3],
    }

    /// The widest gap of a probed pair.
    struct HullProbeGap {
        /// In m.
        gap: f64,
        /// Unit vector from `a` to `b`.
        axis: [f64; 3],
    }

    /// What the speed of a velocity-based AABB margin is found from, in m and s.
    #[derive(Debug, Clone)]
    struct CrowdProbeBody {
        /// Of a ball that holds the body.
        centre: [f64; 3],
        velocity: [f64; 3],
        radius: f64,
        /// Speed at which its farthest point turns.
        turning: f64,
        /// Whether it moves by itself.
        free: bool,
    }

    /// Wall time of the parts of a step in s, since the world was made.
    struct PhaseTimes {
        broadphase: f64,
        collision: f64,
        solver: f64,
        integration: f64,
        /// Of all these, in jobs that threads can share.
        shared: f64,
        /// Numbers of threads, and how long those jobs would take on each.
        threads: [u32; 3],
        shared_on: [f64; 3],
    }

    /// A setting as Bullet holds it.
    struct EngineSetting {
        name: String,
        value: f64,
    }

    unsafe extern "C++" {
        include!("pluvia/cpp/world.h");

        type BulletWorld;

        fn new_world(
            definition: &WorldDefinition,
            pairs: &[PairValue],
        ) -> Result<UniquePtr<BulletWorld>>;
        fn add_shape(self: Pin<&mut BulletWorld>, definition: &ShapeDefinition) -> Result<u32>;
        fn add_body(self: Pin<&mut BulletWorld>, definition: &BodyDefinition) -> Result<u32>;
        fn remove_body(self: Pin<&mut BulletWorld>, id: u32) -> Result<()>;
        fn drive_body(self: Pin<&mut BulletWorld>, id: u32, end: &BodyPose) -> Result<()>;
        /// Tells a new world, before its first step, where a kinematic body was at the
        /// ends of the last three, the last one last.
        fn recall_drive(self: Pin<&mut BulletWorld>, id: u32, ends: &[BodyPose]) -> Result<()>;
        /// From now on a kinematic body moves only as `definition` says.
        fn press_body(
            self: Pin<&mut BulletWorld>,
            id: u32,
            definition: &PressDefinition,
        ) -> Result<()>;
        /// Sets the force on it along the direction in N, or the moment about the axis in N m.
        fn set_force(self: Pin<&mut BulletWorld>, id: u32, force: f64) -> Result<()>;
        /// Makes a body a further part of another, at the same pose: they move as one.
        fn join_body(self: Pin<&mut BulletWorld>, id: u32, whole: u32) -> Result<()>;
        /// `alone`: one thread does it, whatever the number of the world's threads.
        fn step(self: Pin<&mut BulletWorld>, alone: bool) -> Result<()>;
        fn read_one_body(self: &BulletWorld, id: u32) -> Result<BodyRead>;
        fn read_bodies(self: &BulletWorld, out: &mut Vec<BodyRead>);
        /// Corners of the hulls that contacts are found with, in m: how many
        /// each body has, and x, y, z of each; of a sphere one, on its surface; none for a
        /// removed body. `roundings`: radius in m of the ball that sweeps each hull, or 0.
        fn read_corners(
            self: &BulletWorld,
            counts: &mut Vec<u32>,
            coordinates: &mut Vec<f64>,
            roundings: &mut Vec<f64>,
        );
        /// How each kinematic body went through the last step. Empty with stock Bullet
        /// contacts, and once a body came or went.
        fn read_drives(self: &BulletWorld, out: &mut Vec<DriveRead>);
        fn read_contacts(self: &BulletWorld, out: &mut Vec<ContactRead>);
        /// Finds the contact points with what they carry, without a step; refused with stock
        /// Bullet contacts.
        fn find_contacts(self: Pin<&mut BulletWorld>) -> Result<()>;
        /// Points that bear something, where they are now. Empty with stock Bullet contacts.
        fn remember_contacts(self: &BulletWorld, out: &mut Vec<ContactRead>);
        /// Hands a new world, before its first step, what another remembered.
        fn recall_contacts(self: Pin<&mut BulletWorld>, contacts: &[ContactRead]) -> Result<()>;
        fn pair_value(self: &BulletWorld, a: u32, b: u32) -> Result<PairValue>;
        fn phases(self: &BulletWorld) -> PhaseTimes;
        /// See `World::solver_residual`; negative with stock Bullet contacts and before the first step.
        fn solver_residual(self: &BulletWorld) -> f64;
        /// From now on.
        fn record_substeps(self: Pin<&mut BulletWorld>);
        /// The numbers of the last `SubstepRecord`.
        fn read_substep(self: &BulletWorld, bodies: &mut Vec<f64>, contacts: &mut Vec<f64>);
        fn effective(self: &BulletWorld) -> Vec<EngineSetting>;

        include!("pluvia/cpp/probe.h");

        type HullProbe;

        fn new_hull_probe(
            scale: f64,
            tolerances: &Tolerances,
            portable: bool,
            a: &ShapeDefinition,
            b: &ShapeDefinition,
        ) -> Result<UniquePtr<HullProbe>>;
        fn step(self: Pin<&mut HullProbe>, a: &BodyPose, b: &BodyPose) -> Vec<HullProbePoint>;
        fn set_impulse(
            self: Pin<&mut HullProbe>,
            point: usize,
            normal: f64,
            friction: &[f64; 3],
        ) -> Result<()>;
        fn forget(self: Pin<&mut HullProbe>);
        fn widest_gap(
            self: Pin<&mut HullProbe>,
            a: &BodyPose,
            b: &BodyPose,
            all_edges: bool,
        ) -> HullProbeGap;

        // Threads of a world without the world.
        fn shared_sum(threads: i32, size: usize, rounds: usize, fails_at: usize) -> Result<u64>;
        fn chained_work(threads: i32, rounds: usize) -> Result<[u64; 2]>;
        fn shared_time(threads: i32, sizes: &[usize], leasts: &[usize]) -> Result<[f64; 4]>;

        /// Of the allocator, by the whole process; -1 where it does not say.
        fn bytes_handed_out() -> i64;

        /// The speed of the velocity-based AABB margin of each body within a step, in worlds of
        /// many bodies (`cpp/crowd.h`). `frame`: velocity of the place that boxes are counted
        /// from. Empty where a number is not finite or no body is free.
        fn crowd_speeds(
            bodies: &[CrowdProbeBody],
            frame: &[f64; 3],
            step: f64,
            speculative_margin: f64,
        ) -> Vec<f64>;
    }
}

pub(super) use bridge::*;

// SAFETY: a BulletWorld owns everything it points to and keeps no reference to
// the thread that made it; Bullet 3.24 has no thread-local state in the paths
// used here (it is built with BT_THREADSAFE 0 and profiling off). What Bullet
// keeps per process is guarded by `construction_mutex` in cpp/globals.h.
unsafe impl Send for bridge::BulletWorld {}
