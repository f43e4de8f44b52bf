// Gives a world's settings to Bullet, and reads them back from it.
#include "settings.h"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

namespace pluvia {

void set_world(btDiscreteDynamicsWorld &world, const Units &units,
               const WorldDefinition &definition) {
    world.setGravity(units.length(definition.gravity));
    if (definition.own_collision) {
        return;
    }
    auto &dispatch = world.getDispatchInfo();
    dispatch.m_useContinuous = false;
    dispatch.m_enableSatConvex = false;
    auto &info = world.getSolverInfo();
    info.m_numIterations = definition.iterations;
    info.m_solverMode = definition.solver_mode;
    info.m_erp = static_cast<btScalar>(definition.erp);
    info.m_erp2 = static_cast<btScalar>(definition.erp);
    info.m_warmstartingFactor = static_cast<btScalar>(definition.warm_start);
    info.m_splitImpulse = definition.split_impulse ? 1 : 0;
    // Bullet compares with an absolute length; scaled, it stays the 0.04
    // that it is for bodies of one metre.
    info.m_splitImpulsePenetrationThreshold = units.length(-0.04);
    info.m_restitutionVelocityThreshold = units.length(definition.restitution_velocity_threshold);
    info.m_linearSlop = 0;
    info.m_globalCfm = 0;
    info.m_frictionERP = 0;
    info.m_frictionCFM = 0;
    info.m_leastSquaresResidualThreshold = 0;
    info.m_sor = 1;
}

void read_world(const Units &units, btDiscreteDynamicsWorld &world, bool stock, ReadBack &into) {
    into.put("gravity_x_m_per_s2", units.metres(world.getGravity().x()));
    into.put("gravity_y_m_per_s2", units.metres(world.getGravity().y()));
    into.put("gravity_z_m_per_s2", units.metres(world.getGravity().z()));
    if (!stock) {
        return;
    }
    const auto &info = world.getSolverInfo();
    const auto &dispatch = world.getDispatchInfo();
    into.put("iterations", info.m_numIterations);
    into.put("solver_mode", info.m_solverMode);
    into.put("erp", info.m_erp);
    into.put("erp2", info.m_erp2);
    into.put("friction_erp", info.m_frictionERP);
    into.put("friction_cfm", info.m_frictionCFM);
    into.put("global_cfm", info.m_globalCfm);
    into.put("sor", info.m_sor);
    into.put("linear_slop_m", units.metres(info.m_linearSlop));
    into.put("warm_starting_factor", info.m_warmstartingFactor);
    into.put("split_impulse", info.m_splitImpulse);
    into.put("split_impulse_penetration_threshold_m",
             units.metres(info.m_splitImpulsePenetrationThreshold));
    into.put("split_impulse_turn_erp", info.m_splitImpulseTurnErp);
    into.put("restitution_velocity_threshold_m_per_s",
             units.metres(info.m_restitutionVelocityThreshold));
    into.put("least_squares_residual_threshold", info.m_leastSquaresResidualThreshold);
    into.put("minimum_solver_batch_size", info.m_minimumSolverBatchSize);
    into.put("continuous_collision", dispatch.m_useContinuous);
    into.put("separating_axis_test_for_hulls", dispatch.m_enableSatConvex);
    into.put("speculative_contact_restitution", world.getApplySpeculativeContactRestitution());
}

void read_body(const Units &units, const btRigidBody &body, bool stock, ReadBack &into) {
    into.put("linear_damping", body.getLinearDamping());
    into.put("angular_damping", body.getAngularDamping());
    into.put("collision_margin_m", units.metres(body.getCollisionShape()->getMargin()));
    // Whether it sleeps at this moment is no setting; whether it may, is.
    into.put("sleeping", body.getActivationState() != DISABLE_DEACTIVATION);
    if (!stock) {
        return;
    }
    into.put("rigid_body_flags", body.getFlags());
    into.put("activation_state", body.getActivationState());
    into.put("sleeping_speed_m_per_s", units.metres(body.getLinearSleepingThreshold()));
    into.put("sleeping_spin_rad_per_s", body.getAngularSleepingThreshold());
    into.put("sleeping_time_s", gDeactivationTime);
}

} // namespace pluvia
