// Vectors of three components, each a number or, in the lanes of a pack, several.
#pragma once

#include <cmath>

#define PLUVIA_INLINED __attribute__((always_inline)) // of a lambda
#define PLUVIA_INLINE inline PLUVIA_INLINED

namespace pluvia {

template <class L> struct Three {
    L x, y, z;

    PLUVIA_INLINE L dot(const Three &o) const { return x * o.x + y * o.y + z * o.z; }
    PLUVIA_INLINE Three cross(const Three &o) const {
        return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x};
    }
    PLUVIA_INLINE Three operator+(const Three &o) const { return {x + o.x, y + o.y, z + o.z}; }
    PLUVIA_INLINE Three operator-(const Three &o) const { return {x - o.x, y - o.y, z - o.z}; }
    PLUVIA_INLINE Three operator-() const { return {-x, -y, -z}; }
    PLUVIA_INLINE Three operator*(const L &s) const { return {x * s, y * s, z * s}; }
    PLUVIA_INLINE Three operator/(const L &s) const { return {x / s, y / s, z / s}; }
};

// A symmetric matrix.
template <class L> struct Symmetric {
    L xx, yy, zz, xy, xz, yz;

    PLUVIA_INLINE Three<L> operator*(const Three<L> &v) const {
        return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
                xz * v.x + yz * v.y + zz * v.z};
    }
};

using Vec = Three<double>;

PLUVIA_INLINE double length(const Vec &v) { return std::sqrt(v.dot(v)); }

// Three numbers of any precision, as they are kept in memory.
template <class N> PLUVIA_INLINE Vec three(const N x[3]) {
    return {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])};
}
template <class N> PLUVIA_INLINE void store(const Vec &v, N out[3]) {
    out[0] = static_cast<N>(v.x), out[1] = static_cast<N>(v.y), out[2] = static_cast<N>(v.z);
}

} // namespace pluvia
