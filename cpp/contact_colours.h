// The order in which the pairs of a step are solved, and which thread solves which.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pluvia {

// A pair that touches, as the solver sorts it.
struct PairPlace {
    int a, b; // bodies by number, 0 the world
    std::int16_t points;
    bool near; // may well bear something in the step
};

// Which bodies move, by number: from 1 on the free ones, then those that are pressed;
// kinematic ones follow.
struct Moves {
    int free, all;

    bool still(int body) const { return body <= 0 || body > all; }
    bool pressed(int body) const { return body > free && body <= all; }
};

// Sorts pairs into colours and packs. In a colour no moving body occurs twice, so that its pairs
// can be solved in any order and at the same time with the same result: side by side in the lanes
// of a vector, a pack, and on several threads. Every pair gets the first colour that both of its
// bodies have left (greedy graph colouring in the order of the pairs, near ones first). What does
// not move is not changed by its contacts and may occur any number of times. Bodies with more pairs
// than there are colours, such as a plate on many grains, have the rest in a last colour, whose
// packs hold one pair each and are solved one after the other.
//
// Bodies are numbered along the specimen, and in a colour pairs follow these
// numbers in blocks: the bodies of a pack are near each other, and a thread that has
// the packs of one part of the specimen (Homes) has these bodies in its cache.
class Colours {
  public:
    struct Pack {
        int begin, pairs; // which of order()
        int points;       // of the pair that has most
        int first;        // of its points among those of all packs
        bool near;        // whether its pairs are
    };

    // `width`: pairs in a pack, at most. Pairs of a pack have about the same number of points, and
    // all of them are near or none is.
    void sort(const std::vector<PairPlace> &pairs, const Moves &moves, int width);

    const std::vector<int> &order() const { return order_; } // numbers of pairs, pack by pack
    const std::vector<Pack> &packs() const { return packs_; }
    int points() const { return points_; } // of all packs
    // Packs of colour c: begin()[c] up to begin()[c + 1].
    const std::vector<int> &begin() const { return begin_; }
    std::size_t count() const { return begin_.size() - 1; }
    // Whether the packs of a colour must be solved one after the other.
    bool in_order(std::size_t colour) const { return colour == LAST; }
    // Whether a body that moves has pairs.
    bool touched(int body) const { return used_[body] != 0; }

    static constexpr std::size_t MOST = 64; // colours

  private:
    static constexpr std::size_t LAST = MOST - 1;

    std::vector<std::uint64_t> used_;  // by body: colours that it has
    std::vector<std::uint8_t> colour_; // by pair
    std::vector<int> order_, begin_, counts_;
    std::vector<Pack> packs_;
    int points_ = 0;

    void paint(const std::vector<PairPlace> &pairs, const Moves &moves);
    void gather(const std::vector<PairPlace> &pairs, const Moves &moves, int width);
};

// Every pack is at home with a thread, by where its bodies are along the specimen. Most have
// none that packs of other threads have, too, in any colour: those of the next colour need not
// wait for them. Only packs between two threads must come one colour after the other; they are
// solved first in each, so that there is something to do meanwhile.
class Homes {
  public:
    void find(const Colours &colours, const std::vector<PairPlace> &pairs, const Moves &moves,
              int threads);

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
            before += std::exchange(ends[k], before);
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
