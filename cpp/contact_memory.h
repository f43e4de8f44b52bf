// What a world remembers of its contacts, for another world to go on from.
#pragma once

#include "contact_loads.h"
#include "convert.h"
#include "rust/cxx.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pluvia {

struct ContactRead;
struct Touching;

// Adds the points of a pair as they were when the step began.
void read(const Units &units, const Touching &pair, rust::Vec<ContactRead> &out);

// Adds the points of a pair that bear something, where they are now.
void remember(const Units &units, const Touching &pair, rust::Vec<ContactRead> &out);

// Contacts of another world, until the first step of this one is over.
class RecalledContacts {
  public:
    // Whichever body of a pair each names first.
    void take(const Units &units, rust::Slice<const ContactRead> contacts);
    bool empty() const { return by_pair_.empty(); }
    void forget() { by_pair_.clear(); }

    // Gives a pair the feature that touched and the points recalled of it, as
    // if they were those of the last step.
    void give(const btCollisionObject &a, const btCollisionObject &b, const HullData &hull_a,
              const HullData &hull_b, PairState &state) const;

  private:
    struct Recalled {
        btVector3 point, normal, impulse; // in the world, on the first of the pair
        float warm_start;                 // share of the impulse that the next step begins with
        std::uint32_t feature, id;
    };
    std::unordered_map<std::uint64_t, std::vector<Recalled>> by_pair_;
};

} // namespace pluvia
