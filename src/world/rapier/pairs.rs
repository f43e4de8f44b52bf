//! Friction and restitution of each pair of materials, exactly as typed.
//!
//! Rapier combines one value of each body. Its rule `Average` is linear: with `g` for grains and
//! `2·t - g` for another material, grains and that material get `t`. So every pair with a grain
//! gets its own value, to rounding. A pair of two other materials gets what then comes out of it;
//! where that is not what the table says, rapier's hook for the contacts sets it. The hook is left
//! off where it is not needed because rapier never recycles contacts that have one.

use rapier3d_f64::prelude::{
    ActiveHooks, CoefficientCombineRule, Collider, ColliderBuilder, ColliderHandle,
    ContactModificationContext, PhysicsHooks, PhysicsWorld,
};

use super::super::{Material, PairCoefficients, PairTable};

/// How far rounding may take the average from the table's value.
const ROUNDING: f64 = 1e-14;

impl PairTable {
    /// What a body of this material gets, so that averages with grains come out.
    fn own(&self, material: Material) -> PairCoefficients {
        let grains = self.get(Material::Grain, Material::Grain);
        let with = self.get(Material::Grain, material);
        PairCoefficients {
            friction: 2.0 * with.friction - grains.friction,
            restitution: 2.0 * with.restitution - grains.restitution,
        }
    }

    /// Whether averages fail for a pair of this material with any other.
    fn needs_hook(&self, material: Material) -> bool {
        self.materials().into_iter().any(|other| {
            let (a, b, exact) = (self.own(material), self.own(other), self.get(material, other));
            let off = |a: f64, b: f64, exact: f64| ((a + b) / 2.0 - exact).abs() > ROUNDING;
            off(a.friction, b.friction, exact.friction)
                || off(a.restitution, b.restitution, exact.restitution)
        })
    }

    /// Gives a collider its material; walls that are not free meet no others.
    pub(super) fn apply(
        &self,
        builder: ColliderBuilder,
        material: Material,
        is_free: bool,
    ) -> ColliderBuilder {
        let own = self.own(material);
        // A hook on either of two bodies is enough, and walls have many contacts. Grains have what
        // is typed by averages.
        let may_need = material == Material::Plate || is_free && material != Material::Grain;
        let hook = may_need && self.needs_hook(material);
        builder
            .friction(own.friction)
            .friction_combine_rule(CoefficientCombineRule::Average)
            .restitution(own.restitution)
            .restitution_combine_rule(CoefficientCombineRule::Average)
            .active_hooks(if hook {
                ActiveHooks::MODIFY_SOLVER_CONTACTS
            } else {
                ActiveHooks::empty()
            })
            .user_data(material.index() as u128)
    }

    fn exact(&self, a: &Collider, b: &Collider) -> Option<PairCoefficients> {
        let all = self.materials();
        let material = |c: &Collider| {
            usize::try_from(c.user_data).ok().and_then(|number| all.get(number).copied())
        };
        Some(self.get(material(a)?, material(b)?))
    }

    /// What a contact of two colliders has; where they do not touch, what
    /// rapier's rules and the hook would give it.
    pub(super) fn held(
        &self,
        world: &PhysicsWorld,
        a: ColliderHandle,
        b: ColliderHandle,
    ) -> PairCoefficients {
        let touching = world.narrow_phase.contact_pair(a, b);
        if let Some(manifold) = touching
            .and_then(|pair| pair.solver_manifolds().first())
            .filter(|manifold| !manifold.data.solver_contacts.is_empty())
        {
            let data = &manifold.data;
            return PairCoefficients { friction: data.friction, restitution: data.restitution };
        }
        let (a, b) = (&world.colliders[a], &world.colliders[b]);
        let hooked = !(a.active_hooks() | b.active_hooks()).is_empty();
        if let (true, Some(exact)) = (hooked, self.exact(a, b)) {
            return exact;
        }
        PairCoefficients {
            friction: CoefficientCombineRule::combine(
                a.friction(),
                b.friction(),
                a.friction_combine_rule(),
                b.friction_combine_rule(),
            ),
            restitution: CoefficientCombineRule::combine(
                a.restitution(),
                b.restitution(),
                a.restitution_combine_rule(),
                b.restitution_combine_rule(),
            ),
        }
    }
}

/// What of the table rapier's own rule cannot give.
impl PhysicsHooks for PairTable {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let (a, b) =
            (context.colliders.get(context.collider1), context.colliders.get(context.collider2));
        let exact = a.zip(b).and_then(|(a, b)| self.exact(a, b));
        if let (Some(exact), Some(manifold)) = (exact, context.rigid_mut()) {
            *manifold.friction = exact.friction;
            *manifold.restitution = exact.restitution;
        }
    }
}
