// Asks the memory for what will be read soon.
#pragma once

#include <cstddef>

namespace pluvia {

template <class T> void prefetch(const T &what) {
    constexpr std::size_t LINE = 64;
    const auto *at = reinterpret_cast<const char *>(&what);
    for (std::size_t i = 0; i < sizeof(T); i += LINE) {
        __builtin_prefetch(at + i);
    }
}

} // namespace pluvia
