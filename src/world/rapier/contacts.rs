//! Contact points as rapier's solver saw them, with the impulses of the step.

use rapier3d_f64::{
    geometry::{ContactManifold, NEW_CONTACT_BIT},
    math,
    prelude::{FrictionModel, PhysicsWorld},
    utils::OrthonormalBasis,
};

use super::super::Contact;
use super::{RapierBackend, convert::Units};

/// Reads all contact points of the last step. Gaps are those of the poses now: the points stay
/// where they were found on each body, also while rapier recycles them.
pub(super) fn read(world: &PhysicsWorld, units: Units, into: &mut Vec<Contact>) {
    into.clear();
    let id = |handle| world.bodies.get(handle).map(RapierBackend::id);
    for pair in world.narrow_phase.contact_pairs() {
        let (Some(first), Some(second)) =
            (world.colliders.get(pair.collider1), world.colliders.get(pair.collider2))
        else {
            continue;
        };
        let bodies = (first.parent().and_then(id), second.parent().and_then(id));
        let (Some(a), Some(b)) = bodies else { continue };
        for manifold in pair.solver_manifolds() {
            // Rapier's normal points from the first to the second.
            let normal = -manifold.data.normal;
            for point in &manifold.data.solver_contacts {
                let index = (point.contact_id[0] & !NEW_CONTACT_BIT) as usize;
                let found = &manifold.points[index];
                let on_a = first.position() * found.local_p1;
                let on_b = second.position() * found.local_p2;
                let friction = friction(world, manifold, index, normal);
                into.push(Contact {
                    a,
                    b,
                    point: units.metres((on_a + on_b) * 0.5),
                    normal: super::convert::plain(normal),
                    gap: (on_a - on_b).dot(normal) / units.per_metre,
                    impulse: units.metres(normal * found.data.impulse + friction),
                });
            }
        }
    }
}

/// Friction impulse of a step on the first body, in engine units.
fn friction(
    world: &PhysicsWorld,
    manifold: &ContactManifold,
    index: usize,
    normal: math::Vector,
) -> math::Vector {
    let data = &manifold.points[index].data;
    match world.integration_parameters.friction_model {
        FrictionModel::Coulomb => {
            // The basis of the solver (`compute_tangent_contact_directions`, 0.36).
            let tangent = normal.orthonormal_vector();
            tangent * data.tangent_impulse.x + normal.cross(tangent) * data.tangent_impulse.y
        }
        // Rapier keeps only what the last sub-step applied to the whole manifold: taken for every
        // sub-step, and shared out by normal impulse. Exact at rest, an estimate elsewhere.
        FrictionModel::Simplified => {
            let points = &manifold.data.solver_contacts;
            let all: f64 = points
                .iter()
                .map(|p| (p.contact_id[0] & !NEW_CONTACT_BIT) as usize)
                .map(|i| manifold.points[i].data.impulse)
                .sum();
            let share = if all > 0.0 { data.impulse / all } else { 0.0 };
            let substeps = world.integration_parameters.num_solver_iterations as f64;
            data.warmstart_tangent_world * (share * substeps)
        }
    }
}
