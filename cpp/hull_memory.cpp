// What a pair of hulls remembers of its last contact: packs it into numbers, restores it, and
// bounds how far the bodies have moved since.
#include "hull_memory.h"

#include <cmath>

namespace pluvia {

namespace {

// Two numbers in the bits of a number, each in the other's place.
std::uint32_t exchanged(std::uint32_t bits) {
    return (bits & INDEX) << INDEX_BITS | (bits >> INDEX_BITS & INDEX);
}

} // namespace

// The numbers of a face contact are of the reference face and the incident one,
// whichever body has them; those of edges are of A and B.
std::uint32_t swapped_feature(std::uint32_t feature) {
    switch (static_cast<Feature>(feature >> 2 * INDEX_BITS)) {
    case Feature::FaceOfA:
    case Feature::FaceOfB:
        return feature ^ (3U << 2 * INDEX_BITS); // one into the other
    case Feature::Edges:
        return (feature & FROM_EDGES) | exchanged(feature);
    default:
        return feature;
    }
}

std::uint32_t swapped_id(std::uint32_t id) {
    const bool edges = (id & FROM_EDGES) == FROM_EDGES;
    return edges ? FROM_EDGES | exchanged(id) : id ^ FROM_FACE_OF_B;
}

void KeptContact::keep(const PairContact &contact) {
    count = contact.count;
    feature = contact.feature;
    store(contact.normal, normal);
    for (int i = 0; i < contact.count; ++i) {
        const PairPoint &point = contact.points[i];
        store(point.on_a, points[i].on_a);
        store(point.on_b, points[i].on_b);
        points[i].gap = static_cast<float>(point.gap);
        points[i].id = point.id;
    }
}

float farthest_displacement(const Relative &from, const Relative &to, float radius) {
    float turn = 0;
    float shift = 0;
    for (int i = 0; i < 9; ++i) {
        turn += (to.r[i] - from.r[i]) * (to.r[i] - from.r[i]);
    }
    for (int i = 0; i < 3; ++i) {
        shift += (to.t[i] - from.t[i]) * (to.t[i] - from.t[i]);
    }
    return std::sqrt(shift) + std::sqrt(turn / 2) * radius;
}

void recall(const HullData &a, const HullData &b, std::uint32_t feature, PairMemory &memory) {
    const std::uint32_t kind = feature >> 2 * INDEX_BITS;
    const auto first = static_cast<std::int32_t>(feature >> INDEX_BITS & INDEX);
    const auto second = static_cast<std::int32_t>(feature & INDEX);
    const bool edges = kind == static_cast<std::uint32_t>(Feature::Edges);
    const bool of_b = kind == static_cast<std::uint32_t>(Feature::FaceOfB);
    const int firsts = edges ? a.edges : of_b ? b.faces : a.faces;
    const int seconds = edges ? b.edges : of_b ? a.faces : b.faces;
    if (kind == 0 || kind > 3 || first >= firsts || second >= seconds) {
        return;
    }
    memory.feature = static_cast<Feature>(kind);
    memory.first = first;
    memory.second = second;
    memory.recalled = true;
    memory.widest = 1e30F; // unknown: the next search is a whole one
}

} // namespace pluvia
