// Hands out pieces of memory of one size from large blocks.
#include "pool.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace pluvia {

namespace {

// A large page of x86-64 and of most of AArch64.
constexpr std::size_t BLOCK = std::size_t{1} << 21;

constexpr std::size_t CACHE_LINE = 64;

} // namespace

Pool::Pool(std::size_t size) : size_((size + CACHE_LINE - 1) / CACHE_LINE * CACHE_LINE) {}

void *Pool::take() {
    if (!free_.empty()) {
        void *piece = free_.back();
        free_.pop_back();
        return piece;
    }
    if (blocks_.empty() || cut_ + size_ > BLOCK) {
        std::unique_ptr<void, Release> block(std::aligned_alloc(BLOCK, BLOCK));
        if (!block) {
            throw std::bad_alloc();
        }
#if defined(__linux__)
        // Advice only: where it is refused, pages are of the usual size.
        static_cast<void>(madvise(block.get(), BLOCK, MADV_HUGEPAGE));
#endif
        blocks_.push_back(std::move(block));
        cut_ = 0;
    }
    void *piece = static_cast<char *>(blocks_.back().get()) + cut_;
    cut_ += size_;
    return piece;
}

} // namespace pluvia
