// What the process holds of its allocator, for tests that look for leaks.
#pragma once

#include <cstdint>

namespace pluvia {

// Bytes handed out and not given back, in all arenas and in blocks that the
// allocator mapped one by one; C++ and Rust share the allocator. -1 where it
// does not say.
std::int64_t bytes_handed_out();

} // namespace pluvia
