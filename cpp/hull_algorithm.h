// What a pair in Bullet's broadphase carries from step to step, and its hull–hull test.
#pragma once

#include "contact_memory.h"
#include "hull_bodies.h"
#include "hull_pair.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>

#include <vector>

namespace pluvia {

struct Materials;
struct PairValue;
struct Tolerances;
struct Touching;

// What all pairs of a world share; lengths in engine units, of which `scale` make a metre.
struct HullCollision {
    HullCollision(const Tolerances &tolerances, double scale, bool portable);

    const Materials *materials = nullptr;
    PairSettings settings;
    double match; // distance up to which points of successive steps are taken for the same
    const AxisKernels *kernels;
    double step = 0;                // length of a step, for the speculative margin of fast pairs
    RecalledContacts recalled;      // for the first step
    HullBodies bodies;              // of this step
    std::vector<Touching> touching; // of this step, in the order of the pairs

    // Drops what `touching` says of a body that leaves.
    void forget(const btCollisionObject &body);
};

// Finds the contact of a pair of whatever shapes. Returns a distance that they are apart, where one
// is known, or NOT_APART.
double collide(const PairCase &pair);

// One for each pair in the broadphase; holds what the pair carries from step
// to step. No manifold of Bullet's: the solver reads the pairs themselves.
//
// A collision algorithm of Bullet's, because a pair in the broadphase can carry nothing else, and
// Bullet destroys it when the boxes part. What such a class must define besides is never called.
class HullAlgorithm final : public btCollisionAlgorithm {
  public:
    // `at_a`, `at_b`: the bodies' places in HullBodies.
    HullAlgorithm(HullCollision &shared, const PairValue &value, std::size_t at_a,
                  std::size_t at_b);

    // HullSearch calls `find` instead.
    void processCollision(const btCollisionObjectWrapper *, const btCollisionObjectWrapper *,
                          const btDispatcherInfo &, btManifoldResult *) override {}
    // Bodies are not swept.
    btScalar calculateTimeOfImpact(btCollisionObject *, btCollisionObject *,
                                   const btDispatcherInfo &, btManifoldResult *) override {
        return 1;
    }
    // There are none.
    void getAllContactManifolds(btManifoldArray &) override {}

    // Finds the contact of the pair; both shapes are TightHulls. `travelled`: the
    // bodies' paths, added up. Writes only what belongs to the pair.
    void find(const HullBody &a, const HullBody &b, double travelled, PairScratch &scratch);
    // Whether the pair was apart, and cannot have come within the speculative margin since.
    bool rests(double travelled, double margin) const { return travelled + margin < apart_until_; }
    // The bodies' places in HullBodies.
    std::size_t at_a() const { return at_a_; }
    std::size_t at_b() const { return at_b_; }
    // Asks the memory for what the pair will read of its hulls.
    void ask_for_hulls(const HullData &a, const HullData &b) const;
    // Contact points that it holds.
    int points() const { return points_; }
    PairState &state() { return state_; }

  private:
    HullCollision &shared_;
    // First what is read of every pair in every step.
    //
    // The bodies' paths, added up, at which they may meet.
    double apart_until_ = -1;
    std::uint32_t at_a_, at_b_;
    int points_ = 0;
    PairState state_;
};

// A pair that touches.
struct Touching {
    PairState *state;
    const HullBody *a, *b;
    int points;
};

} // namespace pluvia
