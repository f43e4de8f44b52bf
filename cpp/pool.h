// Memory: room for bodies and for what pairs carry from step to step, vectors that leave unset
// what they grow by, and what will be read soon.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace pluvia {

// Pieces of one size, cut from large blocks that grow as they are needed.
//
// Bullet's own pool has a fixed number of pieces and goes to the heap beyond. A step reads all
// bodies and pairs, far apart in memory: in pages of the usual size most of them would also cost a
// walk through the page tables, so the blocks ask for large pages where the system has them.
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

// As std::allocator, but an element that `resize` adds keeps what its memory
// held: for what is written whole before it is read.
template <class T> struct Unset : std::allocator<T> {
    template <class U> struct rebind { using other = Unset<U>; };
    template <class U> void construct(U *at) { ::new (static_cast<void *>(at)) U; }
    template <class U, class... Of> void construct(U *at, Of &&...of) {
        ::new (static_cast<void *>(at)) U(std::forward<Of>(of)...);
    }
};

template <class T> using UnsetVector = std::vector<T, Unset<T>>;

// Asks the memory for what will be read soon.
inline void prefetch(const void *begin, const void *end) {
    constexpr std::ptrdiff_t LINE = 64;
    const auto *last = static_cast<const char *>(end);
    for (const auto *at = static_cast<const char *>(begin); at < last; at += LINE) {
        __builtin_prefetch(at);
    }
}

template <class T> void prefetch(const T &what) { prefetch(&what, &what + 1); }

} // namespace pluvia
