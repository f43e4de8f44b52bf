// Bullet's dispatcher with Pluvia's hull–hull test in it, or without.
#pragma once

#include "hull_algorithm.h"
#include "pool.h"
#include "workers.h"

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <deque>
#include <memory>
#include <vector>

namespace pluvia {

class HullDispatcher final : public btCollisionDispatcher {
  public:
    // With `collision`, which must outlive the dispatcher, pairs of hulls are
    // Pluvia's, on `threads` threads; with null they are Bullet's. Every shape
    // must be a TightHull.
    HullDispatcher(btCollisionConfiguration *configuration, HullCollision *collision, int threads);

    const HullCollision *collision() const { return collision_; }
    int threads() const { return workers_ ? workers_->count() : 1; }
    // Only with `collision`.
    Workers &workers() { return *workers_; }

    // Pairs are culled one after the other and computed by all threads, each
    // writing only what belongs to its pair: the result does not depend on the
    // number of threads.
    void dispatchAllCollisionPairs(btOverlappingPairCache *pairs, const btDispatcherInfo &info,
                                   btDispatcher *dispatcher) override;

    // With `collision`, of HullAlgorithms only.
    void *allocateCollisionAlgorithm(int size) override;
    void freeCollisionAlgorithm(void *algorithm) override;

  private:
    struct Work {
        HullAlgorithm *algorithm;
        const HullBody *a, *b;
        double travelled; // by both
        int points;       // found, copied here since the next pass would read all pairs for them
    };
    HullCollision *collision_;
    Pool pool_{sizeof(HullAlgorithm)};
    std::unique_ptr<HullCreateFunc> create_;
    std::unique_ptr<Workers> workers_;
    std::vector<Work> work_;
    std::deque<PairScratch> scratch_; // by thread

    void take(btBroadphasePair &pair);
    void ask_ahead(std::size_t i, std::size_t end) const;
};

} // namespace pluvia
