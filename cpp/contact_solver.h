// Pluvia's contact solver in the place of Bullet's.
#pragma once

#include "contact_iterations.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/ConstraintSolver/btConstraintSolver.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <unordered_map>
#include <vector>

namespace pluvia {

// Solves all contacts of a step at once: projected Gauss–Seidel in sub-steps that
// begins with the whole of the last step's impulses, friction within its cone,
// normals as implicit springs, restitution as typed. The world must call it once
// a step with all its bodies, and must hold no joints.
class ContactSolver final : public btConstraintSolver {
  public:
    // `touching`: the contacts of the step at hand, in the place of Bullet's
    // manifolds. `gyroscopic`: uneven bodies turn by Euler's equations.
    ContactSolver(const std::vector<Touching> &touching, const ContactLaw &law, Sweep sweep,
                  bool gyroscopic)
        : touching_(touching), law_(law), sweep_(sweep), gyroscopic_(gyroscopic) {}

    btScalar solveGroup(btCollisionObject **bodies, int body_count,
                        btPersistentManifold **manifolds, int manifold_count,
                        btTypedConstraint **constraints, int constraint_count,
                        const btContactSolverInfo &info, btIDebugDraw *drawer,
                        btDispatcher *dispatcher) override;
    void reset() override {}
    btConstraintSolverType getSolverType() const override { return BT_SEQUENTIAL_IMPULSE_SOLVER; }

    // To be called when the step has moved the bodies: gives each the velocity
    // it has at its end, and the spin that its angular momentum has in the
    // orientation it has come to.
    void after_step();

    const ContactLaw &law() const { return law_; }
    Sweep sweep() const { return sweep_; }
    int rows() const { return static_cast<int>(rows_.size()); }

  private:
    // A body with its motion at the end of the step.
    struct Moving {
        btRigidBody *body;
        Three<double> velocity, spin;
        bool is_momentum; // the spin stands for the angular momentum in world axes
    };

    const std::vector<Touching> &touching_;
    ContactLaw law_;
    Sweep sweep_;
    bool gyroscopic_;
    std::vector<SolverBody> solver_bodies_;
    std::vector<btRigidBody *> bodies_; // by solver body; null for the world
    std::vector<ContactRow> rows_;
    std::vector<Moving> moving_;
    // A driven body's velocities: of the last step, and their change from the
    // one before.
    struct Drive {
        Three<double> velocity{0, 0, 0}, spin{0, 0, 0};
        Three<double> change{0, 0, 0}, spin_change{0, 0, 0};
    };
    std::unordered_map<const btCollisionObject *, Drive> drives_;
    Iterations iterations_;

    void take_bodies(btCollisionObject **bodies, int count, double step);
    void accelerate_driven(const btCollisionObject *body, double step, SolverBody &driven);
    void make_rows(double step);
    void give_back(double step);
    int index_of(const btCollisionObject *body) const;
};

} // namespace pluvia
