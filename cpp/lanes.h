// Several numbers worked on at once, with the operators of one.
//
// A lane type is a plain number (one lane) or a vector of GCC's vector
// extension, for which the compiler takes whatever vector instructions the
// target has: AVX2 where the function is compiled for it, pairs of SSE
// instructions else. Only addition, multiplication, division, square root and
// comparison are used, each rounded for itself (-ffp-contract=off), so that
// the bits do not depend on the instructions.
#pragma once

#include <cmath>

namespace pluvia {

using Float8 = float __attribute__((vector_size(32)));

template <class L> struct Lane;

template <> struct Lane<double> {
    using Number = double;
    static constexpr int WIDTH = 1;
    static double get(double lanes, int) { return lanes; }
    static void set(double &lanes, int, double value) { lanes = value; }
};

template <> struct Lane<Float8> {
    using Number = float;
    static constexpr int WIDTH = 8;
    static float get(const Float8 &lanes, int i) { return lanes[i]; }
    static void set(Float8 &lanes, int i, float value) { lanes[i] = value; }
};

// References throughout: a vector passed by value would have another calling
// convention in functions compiled for other instructions.
template <class L> inline __attribute__((always_inline)) L larger(const L &a, const L &b) {
    return a > b ? a : b;
}

template <class L> inline __attribute__((always_inline)) L smaller(const L &a, const L &b) {
    return a < b ? a : b;
}

inline __attribute__((always_inline)) double root(const double &a) { return std::sqrt(a); }

inline __attribute__((always_inline)) Float8 root(const Float8 &a) {
    Float8 out;
    for (int i = 0; i < 8; ++i) {
        out[i] = std::sqrt(a[i]);
    }
    return out;
}

// Three components, each in all lanes.
template <class L> struct Three {
    L x, y, z;

    inline __attribute__((always_inline)) L dot(const Three &o) const {
        return x * o.x + y * o.y + z * o.z;
    }
    inline __attribute__((always_inline)) Three cross(const Three &o) const {
        return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x};
    }
    inline __attribute__((always_inline)) Three operator+(const Three &o) const {
        return {x + o.x, y + o.y, z + o.z};
    }
    inline __attribute__((always_inline)) Three operator-(const Three &o) const {
        return {x - o.x, y - o.y, z - o.z};
    }
    inline __attribute__((always_inline)) Three operator*(const L &s) const {
        return {x * s, y * s, z * s};
    }
};

// A symmetric matrix.
template <class L> struct Symmetric {
    L xx, yy, zz, xy, xz, yz;

    inline __attribute__((always_inline)) Three<L> operator*(const Three<L> &v) const {
        return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
                xz * v.x + yz * v.y + zz * v.z};
    }
};

} // namespace pluvia
