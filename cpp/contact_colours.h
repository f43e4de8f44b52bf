// The order in which the pairs of a step are solved.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pluvia {

// A pair that touches, as the solver sorts it.
struct PairPlace {
    int a, b; // bodies by number, 0 the world
    std::int16_t points;
    bool near; // may well bear something in the step
};

// Which bodies move, by number: from 1 on the free ones, then those that are pressed; what is
// driven or stands still follows.
struct Moves {
    int free, all;

    bool still(int body) const { return body <= 0 || body > all; }
    bool pressed(int body) const { return body > free && body <= all; }
};

// Sorts pairs into colours and packs. In a colour no moving body occurs twice,
// so that its pairs can be solved in any order and at the same time with the
// same result: side by side in the lanes of a vector, a pack, and on several
// threads. Every pair gets the first colour that both of its bodies have left
// (greedy graph colouring in the order of the pairs). What does not move is not
// changed by its contacts and may occur any number of times. Bodies with more
// pairs than there are colours, such as a plate on many grains, have the rest
// in a last colour, whose packs hold one pair each and are solved one after the
// other.
//
// Bodies are numbered along the specimen, and in a colour pairs follow these
// numbers in blocks: the bodies of a pack are near each other, and a thread that has
// the packs of one part of the specimen (contact_homes.h) has these bodies in its cache.
class Colours {
  public:
    struct Pack {
        int begin, pairs; // which of order()
        int points;       // of the pair that has most
        int first;        // of its points among those of all packs
        bool near;        // whether its pairs are
    };

    // Bodies 1 to `free` move. `width`: pairs in a pack, at most. Pairs of a pack
    // have about the same number of points, and all of them are near or none is.
    void sort(const std::vector<PairPlace> &pairs, int free, int width);

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

    void paint(const std::vector<PairPlace> &pairs, int free);
    void gather(const std::vector<PairPlace> &pairs, int free, int width);
};

} // namespace pluvia
