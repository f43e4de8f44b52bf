// What a world remembers of its contacts, for another world to go on from.
#pragma once

#include "convert.h"
#include "hull_pair.h"
#include "rust/cxx.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pluvia {

struct ContactRead;

// The whole impulse of the last step on the manifold's first body.
btVector3 impulse_of(const btManifoldPoint &point);

// Adds the points of a manifold that bear something, where they are now and
// not where they were when the step began.
void remember(const Units &units, const btPersistentManifold &manifold,
              rust::Vec<ContactRead> &out);

// Contacts of another world, until the first step of this one is over.
class RecalledContacts {
  public:
    void take(const Units &units, rust::Slice<const ContactRead> contacts);
    bool empty() const { return by_pair_.empty(); }
    void forget() { by_pair_.clear(); }

    // Lets a pair remember the feature that touched.
    void give(const btCollisionObject &a, const btCollisionObject &b, const HullData &hull_a,
              const HullData &hull_b, PairMemory &memory) const;

    // Gives a new manifold the points recalled of its pair, as if they were
    // those of the last step.
    void give(btPersistentManifold &manifold) const;

  private:
    struct Recalled {
        btVector3 point, normal, impulse; // in the world, on the first of the pair
        std::uint32_t feature, id;
    };
    std::unordered_map<std::uint64_t, std::vector<Recalled>> by_pair_;

    const std::vector<Recalled> *of(const btCollisionObject &a, const btCollisionObject &b) const;
};

} // namespace pluvia
