// Compiles the kernels of the separating axis test twice, for every processor and for AVX2, and
// chooses one at run time.
#include "hull_axis.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>

namespace pluvia {

void AxisScratch::grow(const HullData &a, const HullData &b) {
    for (const HullData *hull : {&a, &b}) {
        vertices_ = std::max(vertices_, hull->vertices);
        faces_ = std::max(faces_, hull->faces);
        edges_ = std::max(edges_, hull->edges);
    }
    const auto v = static_cast<std::size_t>(padded(vertices_));
    const auto f = static_cast<std::size_t>(padded(faces_));
    const auto e = static_cast<std::size_t>(padded(edges_));
    stride = static_cast<int>(e);
    block_.reset();
    // Four bytes an entry throughout; the lists of two-byte entries fit with room to spare.
    block_.reset(new LaneRoom[(5 * v + 6 * f + 26 * e) / LANES]);
    float *next = reinterpret_cast<float *>(block_.get());
    const auto take = [&next](std::size_t count) {
        float *taken = next;
        next += count;
        return taken;
    };
    bx = take(v), by = take(v), bz = take(v);
    bnx = take(f), bny = take(f), bnz = take(f), boffset = take(f);
    gap_a = take(f), gap_b = take(f);
    near_a = reinterpret_cast<std::int32_t *>(take(v));
    near_b = reinterpret_cast<std::int32_t *>(take(v));
    edges_a = take(12 * e), edges_b = take(12 * e);
    list_a = reinterpret_cast<std::uint16_t *>(take(e));
    list_b = reinterpret_cast<std::uint16_t *>(take(e));
}

namespace portable {
constexpr int WIDTH = 4; // every 64-bit processor has vectors of 16 bytes
using Vector = float __attribute__((vector_size(16), may_alias));
using Mask = std::int32_t __attribute__((vector_size(16), may_alias));
static inline Vector smaller(Vector a, Vector b) { return a < b ? a : b; }
static inline float smallest(Vector v) {
    v = smaller(v, __builtin_shuffle(v, Mask{2, 3, 0, 1}));
    v = smaller(v, __builtin_shuffle(v, Mask{1, 0, 3, 2}));
    return v[0];
}
static inline bool any(Mask m) { return (m[0] | m[1] | m[2] | m[3]) != 0; }
#include "hull_axis_kernels.h"
const AxisKernels KERNELS{&gap_along, &faces, &edges, &box};
} // namespace portable

#if defined(__x86_64__)
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
constexpr int WIDTH = 8;
using Vector = float __attribute__((vector_size(32), may_alias));
using Mask = std::int32_t __attribute__((vector_size(32), may_alias));
static inline Vector smaller(Vector a, Vector b) { return a < b ? a : b; }
static inline float smallest(Vector v) {
    v = smaller(v, __builtin_shuffle(v, Mask{4, 5, 6, 7, 0, 1, 2, 3}));
    v = smaller(v, __builtin_shuffle(v, Mask{2, 3, 0, 1, 6, 7, 4, 5}));
    v = smaller(v, __builtin_shuffle(v, Mask{1, 0, 3, 2, 5, 4, 7, 6}));
    return v[0];
}
static inline bool any(Mask m) {
    using Half = std::int64_t __attribute__((vector_size(32), may_alias));
    const Half h = reinterpret_cast<Half>(m);
    return (h[0] | h[1] | h[2] | h[3]) != 0;
}
#include "hull_axis_kernels.h"
const AxisKernels KERNELS{&gap_along, &faces, &edges, &box};
} // namespace avx2
#pragma GCC pop_options
#endif

bool has_avx2() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx2");
#else
    return false;
#endif
}

const AxisKernels &axis_kernels(bool runs_everywhere) {
#if defined(__x86_64__)
    if (!runs_everywhere && has_avx2()) {
        return avx2::KERNELS;
    }
#endif
    return portable::KERNELS;
}

} // namespace pluvia
