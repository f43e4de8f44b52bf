// What a pair of hulls carries from step to step: its contact points with the impulses that the
// solver found there. And what a world remembers of them, for another world to go on from.
#pragma once

#include "convert.h"
#include "hull_pair.h"
#include "rust/cxx.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pluvia {

struct ContactRead;
struct HullBody;
struct Touching;

// What a contact point bears.
struct Load {
    float impulse[3] = {0, 0, 0}; // of the last step on A, in the world
    float warm_start = 1;         // share of it that the next step begins with: impacts are not
};

// One pair: the contact found last with its loads, point by point.
struct PairState {
    PairMemory memory;
    float friction = 0, restitution = 0;
    Load loads[MOST_POINTS];
};

// Makes a contact found now the one of the pair.
//
// A new point takes over the load of the old one with the same id, or else of the nearest one left
// over that is closer than `match` (a length, in the frame of either body). The normal impulse goes
// on along the new normal as it is, friction as what lies in the new plane; where the normal has
// turned by more than eight degrees, the whole impulse is split anew, and a part that would pull is
// dropped.
void take_contact(const PairContact &contact, double match, PairState &state);

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
    void give(const HullBody &a, const HullBody &b, PairState &state) const;

  private:
    struct Recalled {
        btVector3 point, normal, impulse; // in the world, on the first of the pair
        float warm_start;                 // share of the impulse that the next step begins with
        std::uint32_t feature, id;
    };
    std::unordered_map<std::uint64_t, std::vector<Recalled>> by_pair_;
};

} // namespace pluvia
