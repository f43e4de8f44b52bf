//! Bodies for the tests of worlds; how worlds go on, and what is read from them.

use super::*;
use crate::geometry::MassProperties;

/// In m/s².
pub(super) const GRAVITY: Vector = Vector::new(0.0, 0.0, -9.81);

pub(super) fn uniform(friction: f64, restitution: f64) -> PairTable {
    PairTable::uniform(PairCoefficients { friction, restitution })
}

/// A free body of a density in kg/m³, of a shape whose frame is central and principal.
pub(super) fn free(shape: ConvexPolyhedron, density: f64, pose: Pose) -> Body {
    let properties = MassProperties::of(&shape);
    Body {
        shape: Arc::new(shape),
        motion: Motion::Free {
            mass: density * properties.volume,
            inertia: properties.inertia_per_density.diagonal() * density,
        },
        material: Material::Grain,
        state: BodyState::at_rest(pose),
    }
}

pub(super) fn free_box(sides: Vector, at: Vector) -> Body {
    let shape = ConvexPolyhedron::cuboid(sides).expect("a box");
    free(shape, 2673.9, Pose::translation(at.x, at.y, at.z))
}

/// A slab whose upper face is the plane z = 0.
pub(super) fn slab(motion: Motion) -> Body {
    let shape = ConvexPolyhedron::cuboid(Vector::new(0.4, 0.4, 0.02)).expect("a slab");
    Body {
        shape: Arc::new(shape),
        motion,
        material: Material::Wall,
        state: BodyState::at_rest(Pose::translation(0.0, 0.0, -0.01)),
    }
}

pub(super) fn steps(world: &mut dyn World, count: u32) {
    for _ in 0..count {
        world.step().expect("a step");
    }
}

pub(super) fn state(world: &dyn World, id: BodyId) -> BodyState {
    snapshot(world)[id.0 as usize].expect("a body")
}

pub(super) fn snapshot(world: &dyn World) -> Snapshot {
    let mut snapshot = Snapshot::new();
    world.read(&mut snapshot);
    snapshot
}

pub(super) fn remembered(world: &dyn World) -> Vec<RememberedContact> {
    let mut contacts = Vec::new();
    world.remember(&mut contacts);
    contacts
}

pub(super) fn contacts(world: &dyn World) -> Vec<Contact> {
    let mut contacts = Vec::new();
    world.contacts(&mut contacts);
    contacts
}
