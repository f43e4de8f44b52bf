// Room for bodies and for what pairs carry from step to step.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <vector>

namespace pluvia {

// Pieces of one size, cut from large blocks that grow as they are needed.
//
// Bullet's own pool has a fixed number of pieces and goes to the heap beyond.
// A step reads all bodies and pairs, far apart in memory: in pages of the usual
// size most of them would also cost a walk through the page tables, so the
// blocks ask for large pages where the system has them.
class Pool {
  public:
    explicit Pool(std::size_t size);
    Pool(const Pool &) = delete;
    Pool &operator=(const Pool &) = delete;

    void *take();
    // Only what was taken from this pool.
    void give_back(void *piece) { free_.push_back(piece); }

  private:
    struct Release {
        void operator()(void *block) const { std::free(block); }
    };
    std::size_t size_;
    std::vector<std::unique_ptr<void, Release>> blocks_;
    std::size_t cut_ = 0; // bytes of the last block
    std::vector<void *> free_;
};

} // namespace pluvia
