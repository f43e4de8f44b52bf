// What finding contacts reads of the bodies of a world, gathered once a step
// and packed beside each other.
#pragma once

#include "crowd.h"
#include "hull_axis.h"
#include "hull_passing.h"
#include "workers.h"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pluvia {

Rigid rigid(const btTransform &pose);

struct HullBody {
    const btCollisionObject *object = nullptr; // null where no body has this number
    const HullData *hull = nullptr;
    int number = -1; // in its world
    Rigid pose;
    HullMotion motion;
    // Speed of its points beside that of its origin: at which the farthest one turns, and what
    // forces may add in the step.
    double besides;
};

// Speeds that bodies gain by forces in a step, as the mean that they move at; engine units.
struct Gains {
    double free = 0; // every free body, beyond what half the speculative margin has room for
    struct Of {
        int number; // in the world
        double speed;
    };
    std::vector<Of> others;
};

// A length by which points of two bodies can come closer within a step, at the speeds that they
// have when it begins and with what forces may add. A pair that may so meet within the step has
// contact points before it meets, and is stopped at the surface. What a third body's impact
// within the step adds is not foreseen: it may drive a body as deep as that goes in the step.
double approach_in_step(const HullBody &a, const HullBody &b, double step);

// Where a body can be within the step, in the frame of HullBodies, with half the speculative margin
// around it. All that is read of the bodies of most pairs, in one line of the cache.
struct alignas(64) HullRange {
    double travelled = 0; // by any of its points since it was first seen, in the frame
    float low[3], high[3];
    float centre[3], radius;
    float around; // how far beyond the body

    // False for bodies that do not come within the speculative margin of each other.
    bool meets(const HullRange &o) const {
        float square = 0;
        bool apart = false;
        for (int i = 0; i < 3; ++i) {
            apart = apart || low[i] > o.high[i] || o.low[i] > high[i];
            square += (centre[i] - o.centre[i]) * (centre[i] - o.centre[i]);
        }
        return !apart && square <= (radius + o.radius) * (radius + o.radius);
    }
};

// Where distances are counted from: a place that moves along.
struct Frame {
    Vec origin{0, 0, 0}, velocity{0, 0, 0};
};

// All bodies of a world by the number of their broadphase proxy.
class HullBodies {
  public:
    // To be called with the proxy of every body that comes.
    void expect(const btBroadphaseProxy &proxy) { most_ = std::max(most_, index(proxy) + 1); }
    // Begins a step with these objects; `margin` is the gap up to which contacts are kept.
    void begin(const Frame &frame, const btCollisionObjectArray &objects, double step,
               double margin);
    // What the bodies gain from now on.
    Gains gains;
    // Reads all of those, by all threads: each writes only what belongs to its bodies. In `left`
    // whether an object's range has left the box of its proxy.
    void take(const btCollisionObjectArray &objects, const AxisKernels &kernels, Workers &workers,
              std::vector<std::uint8_t> &left);

    // Whether bodies are so fast that ranges in this step go by
    // speeds against the bodies around (crowd.h).
    bool crowded() const { return crowded_; }

    // By the number of their proxy.
    const HullBody &body(std::size_t at) const { return bodies_[at]; }
    const HullRange &range(std::size_t at) const { return ranges_[at]; }
    static std::size_t index(const btBroadphaseProxy &proxy) {
        return static_cast<std::size_t>(proxy.m_uniqueId);
    }

  private:
    std::vector<HullBody> bodies_;
    std::vector<HullRange> ranges_;
    Frame frame_;        // of the step
    Vec moved_{0, 0, 0}; // by the frame since the last
    double step_ = 0, margin_ = 0;
    double fastest_ = 0;             // speed in the frame, of all read since the step began
    std::vector<double> fastest_of_; // by thread
    std::size_t most_ = 0;           // numbers of bodies
    bool crowded_ = false;
    Crowd crowd_;
    std::vector<CrowdBody> members_; // of the crowd, in the order of the objects

    // Brings what is kept of a body up to date, and how far its range has travelled.
    HullBody &read(const btCollisionObject &object);
    // Reads object number `i`; `fastest` is raised to its speed in the frame.
    const HullRange &take(const btCollisionObjectArray &objects, int i, const AxisKernels &kernels,
                          double &fastest);
    // Asks the memory for what `read` will look at of the objects that come after number `i`: one
    // leads to the next, so that the farther ahead an object is the less is asked for.
    static void ask_ahead(const btCollisionObjectArray &objects, int i);
    // Reads all bodies, and finds the speeds for their AABB margins. False where it cannot.
    bool gather(const btCollisionObjectArray &objects);
    // How far any point of a body has gone from one pose to the next.
    static double displacement(const HullBody &body, const Rigid &before, const Vec &moved);
};

} // namespace pluvia
