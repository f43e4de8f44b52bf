// What a pair of hulls carries from step to step: its contact points with the
// impulses that the solver found there.
#pragma once

#include "hull_pair.h"

#include <cstdint>

namespace pluvia {

// What a contact point bears.
struct Load {
    float impulse[3] = {0, 0, 0}; // of the last step on A, in the world
    float warm_start = 1;         // share of it that the next step begins with: impacts are not
    std::int32_t age = 0;         // steps since the point was made
};

// One pair: the contact found last with its loads, point by point.
struct PairState {
    PairMemory memory;
    float friction = 0, restitution = 0;
    Load loads[MOST_POINTS];
};

// Makes a contact found now the one of the pair.
//
// A new point takes over the load of the old one with the same id, or else of
// the nearest one left over that is closer than `match` (a length, in the frame
// of either body). The normal impulse goes on along the new normal as it is,
// friction as what lies in the new plane; where the normal has turned by more
// than eight degrees, the whole impulse is split anew, and a part that would
// pull is dropped.
void take_contact(const PairContact &contact, double match, PairState &state);

} // namespace pluvia
