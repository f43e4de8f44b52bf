// Splits a step into parts that have nothing to do with each other.
#pragma once

#include <cstddef>
#include <vector>

namespace pluvia {

// The bodies of a pair, by number; less than 0 for one that does not move.
struct Link {
    int a, b;
};

// Bodies that hang together through contacts with each other are in one part,
// with the pairs they have. So a part stays in the processor's cache while it
// is solved, a blow to one heap asks for no work in another, and threads can
// take a part each. Small heaps share a part, so that the lanes are filled.
class Parts {
  public:
    struct Range {
        const int *first, *last;
        const int *begin() const { return first; }
        const int *end() const { return last; }
        std::size_t size() const { return static_cast<std::size_t>(last - first); }
    };

    // Every body is in a part; every pair of which a body moves, as well.
    void split(std::size_t bodies, const std::vector<Link> &pairs);
    std::size_t count() const { return pairs_.begin_of.size() - 1; }
    // In the order of their numbers.
    Range bodies(std::size_t part) const { return bodies_.of(part); }
    Range pairs(std::size_t part) const { return pairs_.of(part); }

  private:
    // Numbers sorted by part.
    struct Sorted {
        std::vector<int> numbers;
        std::vector<std::size_t> begin_of{0};

        void sort(const std::vector<int> &part_of, std::size_t parts);
        Range of(std::size_t part) const {
            return {numbers.data() + begin_of[part], numbers.data() + begin_of[part + 1]};
        }
    };

    std::vector<int> parent_; // by body: one of its heap with a smaller number, or itself
    std::vector<int> weight_; // by body that is its own parent: pairs of the heap
    std::vector<int> part_of_body_, part_of_pair_;
    Sorted bodies_, pairs_;

    int root(int body);
};

} // namespace pluvia
