// Groups the touching pairs so that several can be solved at once with the same result (graph
// colouring), and gives each group of pairs to a thread.
#include "contact_colours.h"

#include "hull_memory.h"

#include <algorithm>
#include <numeric>

namespace pluvia {

namespace {

// Pairs of a colour are sorted by these: near ones first, then along the specimen, then
// by the number of points.
constexpr int BLOCKS = 8;
constexpr int POINTS = MOST_POINTS + 1;
constexpr int KINDS = 2 * BLOCKS * POINTS;

int kind(const PairPlace &pair, const Moves &moves) {
    const int body = moves.still(pair.a)   ? pair.b
                     : moves.still(pair.b) ? pair.a
                                           : std::min(pair.a, pair.b);
    const int block = static_cast<int>(std::int64_t{body - 1} * BLOCKS / moves.all);
    // Falling in one block and rising in the next: packs that reach into the next have like pairs.
    const int order = block % 2 == 0 ? MOST_POINTS - pair.points : pair.points;
    return ((pair.near ? 0 : BLOCKS) + block) * POINTS + order;
}

// Whose packs have a body.
constexpr std::uint16_t NOBODY = 0, SEVERAL = 0xffff;

} // namespace

// Near pairs first: they are solved in every iteration, and get the fuller colours.
void Colours::paint(const std::vector<PairPlace> &pairs, const Moves &moves) {
    used_.assign(static_cast<std::size_t>(moves.all) + 1, 0);
    colour_.resize(pairs.size());
    std::uint64_t unmoved = 0;
    const auto used = [&](int body) -> std::uint64_t & {
        return moves.still(body) ? unmoved : used_[body];
    };
    for (const bool near : {true, false}) {
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (pairs[i].near != near) {
                continue;
            }
            unmoved = 0;
            std::uint64_t &a = used(pairs[i].a);
            std::uint64_t &b = used(pairs[i].b);
            const std::uint64_t left = ~(a | b) | std::uint64_t{1} << LAST;
            const int colour = __builtin_ctzll(left);
            a |= std::uint64_t{1} << colour;
            b |= std::uint64_t{1} << colour;
            colour_[i] = static_cast<std::uint8_t>(colour);
        }
    }
}

void Colours::gather(const std::vector<PairPlace> &pairs, const Moves &moves, int width) {
    // A counting sort, which keeps the order of equals.
    counts_.assign((LAST + 1) * KINDS + 1, 0);
    const auto bin = [&](std::size_t i) { return colour_[i] * KINDS + kind(pairs[i], moves); };
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        ++counts_[bin(i) + 1];
    }
    std::partial_sum(counts_.begin(), counts_.end(), counts_.begin());
    order_.resize(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        order_[counts_[bin(i)]++] = static_cast<int>(i);
    }
    packs_.clear();
    begin_.assign(LAST + 2, 0);
    points_ = 0;
    const auto pair = [&](int place) -> const PairPlace & { return pairs[order_[place]]; };
    int place = 0;
    const int all = static_cast<int>(order_.size());
    for (std::size_t colour = 0; colour <= LAST; ++colour) {
        const int most = in_order(colour) ? 1 : width;
        const auto left = [&] { return place < all && colour_[order_[place]] == colour; };
        while (left()) {
            Pack pack{place, 0, 0, points_, pair(place).near};
            while (left() && pack.pairs < most && pair(place).near == pack.near) {
                pack.points = std::max(pack.points, static_cast<int>(pair(place).points));
                ++pack.pairs;
                ++place;
            }
            points_ += pack.points;
            packs_.push_back(pack);
        }
        begin_[colour + 1] = static_cast<int>(packs_.size());
    }
}

void Colours::sort(const std::vector<PairPlace> &pairs, const Moves &moves, int width) {
    paint(pairs, moves);
    gather(pairs, moves, width);
}

void Homes::find(const Colours &colours, const std::vector<PairPlace> &pairs, const Moves &moves,
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
    const auto bodies = static_cast<std::size_t>(moves.all) + 1;
    // Calls `what` with every moving body of a pack.
    const auto each = [&](const Colours::Pack &pack, const auto &what) {
        for (int i = pack.begin; i < pack.begin + pack.pairs; ++i) {
            const PairPlace &pair = pairs[colours.order()[i]];
            for (const int body : {pair.a, pair.b}) {
                if (!moves.still(body)) {
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
    std::exclusive_scan(ends_.begin(), ends_.end(), ends_.begin(), std::size_t{0});
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
