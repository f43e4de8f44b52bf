// Several numbers worked on at once, with the operators of one.
//
// A lane type is a plain number (one lane) or a vector of GCC's vector extension, for which the
// compiler takes whatever vector instructions the target has: AVX2 where the function is compiled
// for it, pairs of SSE instructions else. Only addition, subtraction, multiplication, division,
// square root and comparison are used, each rounded for itself (-ffp-contract=off), so that the
// bits do not depend on the instructions.
#pragma once

#include "three.h"

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

// Eight numbers that are moved as one.
template <class N> struct alignas(32) Record { N at[8]; };

// The records of the bodies of a pack: `f[k]` gets number k of each.
template <class N>
PLUVIA_INLINE void gather(const Record<N> *records, const int *index, double (&f)[8]) {
    const double *from = records[index[0]].at;
#pragma GCC unroll 8
    for (int k = 0; k < 8; ++k) {
        f[k] = from[k];
    }
}

// Back again, but for the lanes whose bits are set in `except`.
template <class N>
PLUVIA_INLINE void scatter(const double (&f)[8], const int *index, unsigned except,
                           Record<N> *records) {
    if (except != 0) {
        return;
    }
    double *to = records[index[0]].at;
#pragma GCC unroll 8
    for (int k = 0; k < 8; ++k) {
        to[k] = f[k];
    }
}

using Float4 = float __attribute__((vector_size(16)));

// Four rows become four columns, in each half for itself; done twice, everything is where it was.
PLUVIA_INLINE void transpose(Float8 (&r)[4]) {
    const Float8 p = __builtin_shufflevector(r[0], r[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const Float8 q = __builtin_shufflevector(r[2], r[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const Float8 s = __builtin_shufflevector(r[0], r[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const Float8 t = __builtin_shufflevector(r[2], r[3], 2, 10, 3, 11, 6, 14, 7, 15);
    r[0] = __builtin_shufflevector(p, q, 0, 1, 8, 9, 4, 5, 12, 13);
    r[1] = __builtin_shufflevector(p, q, 2, 3, 10, 11, 6, 7, 14, 15);
    r[2] = __builtin_shufflevector(s, t, 0, 1, 8, 9, 4, 5, 12, 13);
    r[3] = __builtin_shufflevector(s, t, 2, 3, 10, 11, 6, 7, 14, 15);
}

// Halves of records are put beside each other when they are read, and taken
// apart when they are written, which costs less than to turn whole ones.
template <class N>
PLUVIA_INLINE void gather(const Record<N> *records, const int *index, Float8 (&f)[8]) {
#pragma GCC unroll 2
    for (int half = 0; half < 8; half += 4) {
        Float8 r[4];
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i) {
            const auto &first = *reinterpret_cast<const Float4 *>(records[index[i]].at + half);
            const auto &second = *reinterpret_cast<const Float4 *>(records[index[i + 4]].at + half);
            r[i] = __builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7);
        }
        transpose(r);
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i) {
            f[half + i] = r[i];
        }
    }
}

template <class N>
PLUVIA_INLINE void scatter(const Float8 (&f)[8], const int *index, unsigned except,
                           Record<N> *records) {
#pragma GCC unroll 2
    for (int half = 0; half < 8; half += 4) {
        Float8 r[4] = {f[half], f[half + 1], f[half + 2], f[half + 3]};
        transpose(r);
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i) {
            if ((except >> i & 1) == 0) {
                *reinterpret_cast<Float4 *>(records[index[i]].at + half) =
                    __builtin_shufflevector(r[i], r[i], 0, 1, 2, 3);
            }
            if ((except >> (i + 4) & 1) == 0) {
                *reinterpret_cast<Float4 *>(records[index[i + 4]].at + half) =
                    __builtin_shufflevector(r[i], r[i], 4, 5, 6, 7);
            }
        }
    }
}

// References throughout: a vector passed by value would have another calling
// convention in functions compiled for other instructions.
template <class L> PLUVIA_INLINE L larger(const L &a, const L &b) { return a > b ? a : b; }

template <class L> PLUVIA_INLINE L smaller(const L &a, const L &b) { return a < b ? a : b; }

PLUVIA_INLINE double root(const double &a) { return std::sqrt(a); }

PLUVIA_INLINE Float8 root(const Float8 &a) {
    Float8 out;
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) {
        out[i] = std::sqrt(a[i]);
    }
    return out;
}

} // namespace pluvia
