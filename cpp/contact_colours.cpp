#include "contact_colours.h"

#include "hull_memory.h"

#include <algorithm>

namespace pluvia {

namespace {

// Pairs of a colour are sorted by these: near ones first, then along the specimen, then
// by the number of points.
constexpr int BLOCKS = 8;
constexpr int POINTS = MOST_POINTS + 1;
constexpr int KINDS = 2 * BLOCKS * POINTS;

int kind(const PairPlace &pair, int free) {
    const bool moves_a = pair.a > 0 && pair.a <= free;
    const bool moves_b = pair.b > 0 && pair.b <= free;
    const int body = moves_a && moves_b ? std::min(pair.a, pair.b) : moves_a ? pair.a : pair.b;
    const int block = static_cast<int>(std::int64_t{body - 1} * BLOCKS / free);
    // Falling in one block and rising in the next: packs that reach into the next have like pairs.
    const int order = block % 2 == 0 ? MOST_POINTS - pair.points : pair.points;
    return ((pair.near ? 0 : BLOCKS) + block) * POINTS + order;
}

} // namespace

// Near pairs first: they are solved in every iteration, and get the fuller colours.
void Colours::paint(const std::vector<PairPlace> &pairs, int free) {
    used_.assign(static_cast<std::size_t>(free) + 1, 0);
    colour_.resize(pairs.size());
    std::uint64_t unmoved = 0;
    const auto used = [&](int body) -> std::uint64_t & {
        return body > 0 && body <= free ? used_[body] : unmoved;
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

void Colours::gather(const std::vector<PairPlace> &pairs, int free, int width) {
    // A counting sort, which keeps the order of equals.
    counts_.assign((LAST + 1) * KINDS + 1, 0);
    const auto bin = [&](std::size_t i) { return colour_[i] * KINDS + kind(pairs[i], free); };
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        ++counts_[bin(i) + 1];
    }
    for (std::size_t i = 1; i < counts_.size(); ++i) {
        counts_[i] += counts_[i - 1];
    }
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
        while (place < all && colour_[order_[place]] == colour) {
            Pack pack{place, 0, 0, points_, pair(place).near};
            while (place < all && pack.pairs < most && pair(place).near == pack.near &&
                   colour_[order_[place]] == colour) {
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

void Colours::sort(const std::vector<PairPlace> &pairs, int free, int width) {
    paint(pairs, free);
    gather(pairs, free, width);
}

} // namespace pluvia
