#include "contact_homes.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pluvia {

namespace {

constexpr std::uint16_t NOBODY = 0, SEVERAL = 0xffff;

} // namespace

void Homes::find(const Colours &colours, const std::vector<PairPlace> &pairs, int moving,
                 int threads) {
    threads_ = threads;
    const auto &packs = colours.packs();
    kinds_.assign(packs.size(), static_cast<std::uint16_t>(threads));
    order_.resize(packs.size());
    ends_.assign(static_cast<std::size_t>(threads), 0);
    if (threads == 1) {
        std::iota(order_.begin(), order_.end(), 0);
        ends_[0] = packs.size();
        return;
    }
    const auto bodies = static_cast<std::size_t>(moving) + 1;
    // Calls `what` with every moving body of a pack.
    const auto each = [&](const Colours::Pack &pack, const auto &what) {
        for (int i = pack.begin; i < pack.begin + pack.pairs; ++i) {
            const PairPlace &pair = pairs[colours.order()[i]];
            for (const int body : {pair.a, pair.b}) {
                if (body > 0 && body <= moving) {
                    what(static_cast<std::size_t>(body));
                }
            }
        }
    };
    const auto middle = [&](const Colours::Pack &pack) {
        std::size_t low = bodies - 1, high = 0;
        each(pack, [&](std::size_t body) {
            low = std::min(low, body);
            high = std::max(high, body);
        });
        return low < high ? (low + high) / 2 : high;
    };
    at_.assign(bodies, 0);
    for (const Colours::Pack &pack : packs) {
        at_[middle(pack)] += pack.points;
    }
    std::int64_t before = 0;
    for (int &at : at_) {
        const int points = at;
        at = static_cast<int>(
            std::min<std::int64_t>(before * threads / std::max(1, colours.points()), threads - 1));
        before += points;
    }
    owner_.assign(bodies, NOBODY);
    for (std::size_t i = 0; i < packs.size(); ++i) {
        const auto home = static_cast<std::uint16_t>(at_[middle(packs[i])]);
        kinds_[i] = home;
        ++ends_[home];
        each(packs[i], [&](std::size_t body) {
            const auto own = static_cast<std::uint16_t>(home + 1);
            owner_[body] = owner_[body] == NOBODY || owner_[body] == own ? own : SEVERAL;
        });
    }
    std::size_t begin = 0;
    for (std::size_t &end : ends_) {
        begin += std::exchange(end, begin);
    }
    for (std::size_t i = 0; i < packs.size(); ++i) {
        order_[ends_[kinds_[i]]++] = static_cast<int>(i);
        bool between = false;
        each(packs[i], [&](std::size_t body) { between = between || owner_[body] == SEVERAL; });
        if (!between) {
            kinds_[i] = static_cast<std::uint16_t>(kinds_[i] + threads);
        }
    }
}

} // namespace pluvia
