#include "engine_world.h"

namespace pluvia {

Stopwatch::~Stopwatch() {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
    sum_ += spent.count();
    of_ -= spent.count();
}

void EngineWorld::add(btRigidBody &body, BodyKind kind) {
    const bool free = kind == BodyKind::Free;
    addRigidBody(&body, free ? Group::FREE : Group::WALL,
                 free ? Group::FREE | Group::WALL : Group::FREE);
}

} // namespace pluvia
