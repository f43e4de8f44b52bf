// Finds the contacts of all pairs whose boxes meet.
#pragma once

#include "hull_algorithm.h"
#include "pool.h"
#include "workers.h"

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace pluvia {

// The dispatcher of a native world, which Bullet's world and its cache of pairs ask for: it has the
// room for what pairs carry from step to step, and takes it back when their boxes part.
class HullDispatcher final : public btCollisionDispatcher {
  public:
    using btCollisionDispatcher::btCollisionDispatcher;

    void *room() { return room_.take(); }
    // Throws: only Bullet's own narrow phase asks for an algorithm, which never runs here, and the
    // room that it would get is not of the pool that takes it back.
    void *allocateCollisionAlgorithm(int size) override;
    void freeCollisionAlgorithm(void *algorithm) override { room_.give_back(algorithm); }

  private:
    Pool room_{sizeof(HullAlgorithm)};
};

class HullSearch {
  public:
    // All must outlive the search. Every shape must be a TightHull.
    HullSearch(HullCollision &collision, HullDispatcher &dispatcher, Workers &workers);

    // Pairs are culled in fixed blocks and computed one by one by all threads, each writing
    // only what belongs to its pair or block: the result does not depend on the
    // number of threads. `homes`: by body the thread at which its pairs are computed, if there
    // is such a thread: the one that solves them has in its cache what they carry.
    void find(btOverlappingPairCache &pairs, const std::vector<std::uint16_t> &homes);

  private:
    struct Work {
        HullAlgorithm *algorithm;
        const HullBody *a, *b;
        double travelled; // by both
        int points;       // found, copied here since the next pass would read all pairs for them
    };
    // A pair that is looked at for the first time, and its place in `work_`.
    struct Fresh {
        btBroadphasePair *pair;
        std::size_t at;
    };
    // Pairs that follow each other in the broadphase.
    struct Block {
        std::size_t begin, end; // in `work_`
        std::size_t touching;   // pairs that touch in the blocks before
        std::vector<Fresh> fresh;
    };
    HullCollision &collision_;
    HullDispatcher &dispatcher_;
    Workers &workers_;
    std::vector<Work> work_; // a stretch for every block, as long as it has pairs
    std::vector<Block> blocks_;
    std::vector<std::uint32_t> order_; // of work_, by thread
    std::vector<std::size_t> ends_;    // of each
    std::deque<PairScratch> scratch_;  // by thread

    void cull(btBroadphasePair *first, std::size_t count, std::size_t block);
    void take(btBroadphasePair &pair, Block &block);
    void send_home(const std::vector<std::uint16_t> &homes);
    void find(std::size_t begin, std::size_t end, PairScratch &scratch);
    void list_touching();
    void ask_ahead(std::size_t k, std::size_t end) const;
};

} // namespace pluvia
