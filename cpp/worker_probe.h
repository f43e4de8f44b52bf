// The threads of a world outside any world, for tests: that they share work
// without losing any of it, and that what fails in one of them comes back.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pluvia {

// Adds up the numbers below `size`, `rounds` times, each number by whichever of
// `threads` threads comes to it. Throws std::runtime_error when one comes to
// the number `fails_at`.
std::uint64_t shared_sum(std::int32_t threads, std::size_t size, std::size_t rounds,
                         std::size_t fails_at);

} // namespace pluvia
