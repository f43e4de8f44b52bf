#include "contact_parts.h"

#include <algorithm>

namespace pluvia {

namespace {

// Pairs from which on a part takes in no further heap: some dozens of full
// batches.
constexpr int ENOUGH = 128;

} // namespace

// The body with the smallest number of its heap (path halving).
int Parts::root(int body) {
    while (parent_[body] != body) {
        parent_[body] = parent_[parent_[body]];
        body = parent_[body];
    }
    return body;
}

// Counting sort: what has no part is left out.
void Parts::Sorted::sort(const std::vector<int> &part_of, std::size_t parts) {
    begin_of.assign(parts + 1, 0);
    for (const int part : part_of) {
        if (part >= 0) {
            ++begin_of[static_cast<std::size_t>(part) + 1];
        }
    }
    for (std::size_t i = 0; i < parts; ++i) {
        begin_of[i + 1] += begin_of[i];
    }
    numbers.resize(begin_of[parts]);
    // Filled from the end, which leaves each beginning where it was.
    std::vector<std::size_t> at(begin_of.begin() + 1, begin_of.end());
    for (std::size_t i = part_of.size(); i-- > 0;) {
        if (part_of[i] >= 0) {
            numbers[--at[static_cast<std::size_t>(part_of[i])]] = static_cast<int>(i);
        }
    }
}

void Parts::split(std::size_t bodies, const std::vector<Link> &pairs) {
    parent_.resize(bodies);
    for (std::size_t i = 0; i < bodies; ++i) {
        parent_[i] = static_cast<int>(i);
    }
    for (const Link &pair : pairs) {
        if (pair.a >= 0 && pair.b >= 0) {
            const int a = root(pair.a);
            const int b = root(pair.b);
            parent_[std::max(a, b)] = std::min(a, b);
        }
    }
    weight_.assign(bodies, 0);
    part_of_pair_.resize(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const int body = std::max(pairs[i].a, pairs[i].b);
        part_of_pair_[i] = body >= 0 ? root(body) : -1;
        if (body >= 0) {
            ++weight_[part_of_pair_[i]];
        }
    }
    int parts = bodies > 0 ? 1 : 0;
    int weight = 0;
    part_of_body_.resize(bodies);
    for (std::size_t i = 0; i < bodies; ++i) {
        const int first = root(static_cast<int>(i));
        if (first == static_cast<int>(i)) {
            if (weight >= ENOUGH) {
                ++parts;
                weight = 0;
            }
            weight += weight_[i];
            part_of_body_[i] = parts - 1;
        } else {
            part_of_body_[i] = part_of_body_[first];
        }
    }
    for (int &part : part_of_pair_) {
        part = part >= 0 ? part_of_body_[part] : -1;
    }
    bodies_.sort(part_of_body_, static_cast<std::size_t>(parts));
    pairs_.sort(part_of_pair_, static_cast<std::size_t>(parts));
}

} // namespace pluvia
