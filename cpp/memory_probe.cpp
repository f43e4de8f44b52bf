#include "memory_probe.h"

#if defined(__linux__)
#include <features.h>
#endif
#if defined(__GLIBC__)
#if __GLIBC_PREREQ(2, 33)
#define PLUVIA_COUNTS_BYTES 1
#include <malloc.h>
#endif
#endif

namespace pluvia {

std::int64_t bytes_handed_out() {
#if defined(PLUVIA_COUNTS_BYTES)
    const auto held = mallinfo2();
    return static_cast<std::int64_t>(held.uordblks + held.hblkhd);
#else
    return -1;
#endif
}

} // namespace pluvia
