#include "worker_probe.h"

#include "workers.h"

#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace pluvia {

std::uint64_t shared_sum(std::int32_t threads, std::size_t size, std::size_t rounds,
                         std::size_t fails_at) {
    if (threads < 1) {
        throw std::runtime_error("work is shared by one thread at least");
    }
    Workers workers(threads);
    // Plain numbers, as in a world: only one thread at a time may touch each.
    std::vector<std::uint64_t> parts(static_cast<std::size_t>(threads), 0);
    std::vector<std::uint64_t> sums(size, 0);
    for (std::size_t round = 0; round < rounds; ++round) {
        workers.share(size, 3, [&](int worker, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (i == fails_at) {
                    throw std::runtime_error("asked to fail at " + std::to_string(i));
                }
                sums[i] += i;
            }
            parts[static_cast<std::size_t>(worker)] += end - begin;
        });
    }
    const std::uint64_t touched = std::accumulate(parts.begin(), parts.end(), std::uint64_t{0});
    if (touched != size * rounds) {
        throw std::logic_error("work was lost or done twice");
    }
    return std::accumulate(sums.begin(), sums.end(), std::uint64_t{0});
}

} // namespace pluvia
