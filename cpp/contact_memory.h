// What a world remembers of its contacts, for another world to go on from.
#pragma once

#include "convert.h"
#include "rust/cxx.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pluvia {

struct ContactRead;
struct PairContact;

// The whole impulse of the last step on the manifold's first body.
btVector3 impulse_of(const btManifoldPoint &point);

// Adds the points of a manifold that bear something, where they are now and
// not where they were when the step began.
void remember(const Units &units, const btPersistentManifold &manifold,
              rust::Vec<ContactRead> &out);

// Contacts of another world, until the first step of this one is over.
class RecalledContacts {
  public:
    // Bodies are named by their numbers in this world; ANY_WALL stands for
    // whatever does not move freely.
    static constexpr std::uint32_t ANY_WALL = UINT32_MAX;

    void take(const Units &units, rust::Slice<const ContactRead> contacts);
    bool empty() const { return by_pair_.empty(); }
    void forget() { by_pair_.clear(); }

    // Gives a new manifold the points recalled of its pair that lie within
    // `match` of a point of `contact`, as if they were those of the last step.
    void give(const PairContact &contact, btScalar match, btPersistentManifold &manifold) const;

  private:
    struct Recalled {
        btVector3 point, normal, impulse; // in the world, on the first of the pair
    };
    std::unordered_map<std::uint64_t, std::vector<Recalled>> by_pair_;
};

} // namespace pluvia
