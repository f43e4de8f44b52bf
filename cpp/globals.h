// Bullet keeps some of its settings in variables of the process.
//
// They are set when the first stock world is made and must not differ between
// stock worlds that live at the same time; one that asks for other values is
// refused. Native worlds read none of them. The same mutex guards the making and unmaking of shapes
// and bodies, which count in unprotected process variables.
#pragma once

#include <LinearMath/btScalar.h>

#include <mutex>

namespace pluvia {

std::mutex &construction_mutex();

// Holds the process's settings for the life of one world. Construct and
// destroy under `construction_mutex`.
class GlobalsHold {
  public:
    // In engine length units. Throws std::runtime_error when a living world holds other values.
    GlobalsHold(btScalar contact_breaking_threshold, btScalar broadphase_margin);
    ~GlobalsHold();
    GlobalsHold(const GlobalsHold &) = delete;
    GlobalsHold &operator=(const GlobalsHold &) = delete;
};

} // namespace pluvia
