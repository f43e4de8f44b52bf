// Which thread solves which packs.
#pragma once

#include "contact_colours.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pluvia {

// Every pack is at home with a thread, by where its bodies are along the specimen. Most have
// none that packs of other threads have, too, in any colour: those of the next colour need not
// wait for them. Only packs between two threads must come one colour after the other; they are
// solved first in each, so that there is something to do meanwhile.
class Homes {
  public:
    // Bodies 1 to `moving` move.
    void find(const Colours &colours, const std::vector<PairPlace> &pairs, int moving, int threads);

    // Packs between threads come first, and of either those of the first thread.
    std::size_t kinds() const { return 2 * static_cast<std::size_t>(threads_); }
    std::size_t kind(std::size_t pack) const { return kinds_[pack]; }
    // The thread of packs in whose middle a body is.
    std::size_t of_body(int body) const {
        return threads_ == 1 ? 0 : static_cast<std::size_t>(at_[body]);
    }
    // All packs by thread, and where those of each end.
    const std::vector<int> &order() const { return order_; }
    const std::size_t *ends() const { return ends_.data(); }

  private:
    int threads_ = 1;
    std::vector<std::uint16_t> kinds_; // by pack
    std::vector<int> order_;
    std::vector<std::size_t> ends_;
    std::vector<std::uint16_t> owner_; // by body: whose packs have it; 0 nobody's
    std::vector<int> at_; // by body: points of the packs whose middle it is, then their thread
};

// Packs to visit, by colour; in a colour by kind, or in their order where that matters.
struct Turn {
    std::vector<int> packs;
    std::vector<int> begin;        // by colour
    std::vector<std::size_t> ends; // by colour and kind, counted from where the kinds begin that
                                   // are between threads, or not
};

// Chooses those that `takes`.
template <class F>
void choose(const Colours &colours, const Homes &homes, Turn &turn, const F &takes) {
    const std::size_t kinds = homes.kinds();
    turn.packs.clear();
    turn.begin.assign(1, 0);
    turn.ends.clear();
    for (std::size_t c = 0; c < colours.count(); ++c) {
        const auto first = static_cast<std::size_t>(turn.begin.back());
        turn.ends.resize((c + 1) * kinds, 0);
        std::size_t *const ends = turn.ends.data() + c * kinds;
        const bool in_order = colours.in_order(c);
        const auto each = [&](const auto &what) {
            for (int i = colours.begin()[c]; i < colours.begin()[c + 1]; ++i) {
                if (takes(static_cast<std::size_t>(i))) {
                    what(i, ends[in_order ? 0 : homes.kind(static_cast<std::size_t>(i))]);
                }
            }
        };
        each([](int, std::size_t &count) { ++count; });
        std::size_t before = 0;
        for (std::size_t k = 0; k < kinds; ++k) {
            const std::size_t count = ends[k];
            ends[k] = before;
            before += count;
        }
        turn.packs.resize(first + before);
        each([&](int i, std::size_t &end) { turn.packs[first + end++] = i; });
        const std::size_t between = ends[kinds / 2 - 1];
        for (std::size_t k = kinds / 2; k < kinds; ++k) {
            ends[k] -= between;
        }
        turn.begin.push_back(static_cast<int>(turn.packs.size()));
    }
}

} // namespace pluvia
