// Asks the memory for what will be read soon.
#pragma once

#include <cstddef>

namespace pluvia {

inline void prefetch(const void *begin, const void *end) {
    constexpr std::ptrdiff_t LINE = 64;
    const auto *last = static_cast<const char *>(end);
    for (const auto *at = static_cast<const char *>(begin); at < last; at += LINE) {
        __builtin_prefetch(at);
    }
}

template <class T> void prefetch(const T &what) { prefetch(&what, &what + 1); }

} // namespace pluvia
