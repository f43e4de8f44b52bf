// Computes the closest points of two convex polyhedra that are apart, by the algorithm of Gilbert,
// Johnson and Keerthi.
#include "core_distance.h"

#include <algorithm>
#include <cmath>

namespace pluvia {

namespace {

// Steps at most; pairs of grains need some ten.
constexpr int MOST_STEPS = 100;
// Share of the distance by which it may be wrong.
constexpr double EXACT = 1e-12;
// Polyhedra that are nearer to each other than this, as a fraction of the smaller one's size, are
// taken to overlap: their vertices are no more exact than single precision.
constexpr double TOUCHING = 1e-6;

// A corner of B less a corner of A.
struct Corner {
    Vec x, on_a, on_b;
    int a, b;
};

struct Simplex {
    Corner corners[4];
    int count = 0;
    double share[4] = {0, 0, 0, 0};
    Vec x{0, 0, 0}; // its point closest to the origin

    bool has(const Corner &c) const {
        return std::any_of(corners, corners + count,
                           [&](const Corner &o) { return o.a == c.a && o.b == c.b; });
    }
};

int highest(const HullData &hull, const Vec &d) {
    int best = 0;
    double most = -1e300;
    for (int v = 0; v < hull.vertices; ++v) {
        const double h = d.dot(hull.vertex(v));
        if (h > most) {
            most = h;
            best = v;
        }
    }
    return best;
}

// Shares of the corners `chosen` in the point closest to the origin of the flat through them; false
// where one is not positive, or the corners do not span the flat.
bool shares(const Simplex &s, const int *chosen, int count, double share[4]) {
    // With y = x0 + Σ t_i e_i: normal equations G t = -e·x0, solved by Cramer's rule.
    const Vec x0 = s.corners[chosen[0]].x;
    Vec e[3];
    double g[3][3], f[3];
    const int n = count - 1;
    for (int i = 0; i < n; ++i) {
        e[i] = s.corners[chosen[i + 1]].x - x0;
    }
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            g[i][j] = e[i].dot(e[j]);
        }
        f[i] = -e[i].dot(x0);
    }
    double t[3] = {0, 0, 0};
    if (n == 1) {
        if (!(g[0][0] > 0)) {
            return false;
        }
        t[0] = f[0] / g[0][0];
    } else if (n == 2) {
        const double det = g[0][0] * g[1][1] - g[0][1] * g[1][0];
        if (!(det > 1e-14 * g[0][0] * g[1][1])) {
            return false;
        }
        t[0] = (f[0] * g[1][1] - f[1] * g[0][1]) / det;
        t[1] = (g[0][0] * f[1] - g[1][0] * f[0]) / det;
    } else if (n == 3) {
        // The origin in the frame of the edges: -x0 = Σ t_i e_i.
        const double det = e[0].dot(e[1].cross(e[2]));
        if (!(std::abs(det) > 1e-12 * std::sqrt(g[0][0] * g[1][1] * g[2][2]))) {
            return false;
        }
        for (int i = 0; i < 3; ++i) {
            t[i] = -x0.dot(e[(i + 1) % 3].cross(e[(i + 2) % 3])) / det;
        }
    }
    double rest = 1;
    for (int i = 0; i < n; ++i) {
        share[i + 1] = t[i];
        rest -= t[i];
    }
    share[0] = rest;
    return std::all_of(share, share + count, [](double x) { return x > 0; });
}

// Leaves of the simplex what its point closest to the origin lies on. True where the origin lies
// within it.
bool reduce(Simplex &s) {
    double least = 1e300;
    Simplex best;
    for (int set = 1; set < 1 << s.count; ++set) {
        int chosen[4], count = 0;
        for (int i = 0; i < s.count; ++i) {
            if ((set >> i & 1) != 0) {
                chosen[count++] = i;
            }
        }
        double share[4] = {1, 0, 0, 0};
        if (!shares(s, chosen, count, share)) {
            continue;
        }
        Vec x{0, 0, 0};
        for (int i = 0; i < count; ++i) {
            x = x + s.corners[chosen[i]].x * share[i];
        }
        const double square = count == 4 ? 0 : x.dot(x);
        if (square < least) {
            least = square;
            best.count = count;
            for (int i = 0; i < count; ++i) {
                best.corners[i] = s.corners[chosen[i]];
                best.share[i] = share[i];
            }
            best.x = x;
        }
    }
    s = best;
    return s.count == 4;
}

// The corner of B − A that lies deepest against a direction.
Corner corner(const HullData &a, const HullData &b, const Rigid &b_to_a, const Vec &direction) {
    Corner c;
    c.a = highest(a, direction);
    c.b = highest(b, -b_to_a.turn_back(direction));
    c.on_a = a.vertex(c.a);
    c.on_b = b_to_a.apply(b.vertex(c.b));
    c.x = c.on_b - c.on_a;
    return c;
}

} // namespace

CoreDistance core_distance(const HullData &a, const HullData &b, const Rigid &b_to_a,
                           double enough) {
    const double touching = TOUCHING * static_cast<double>(std::min(a.radius, b.radius));
    CoreDistance out{};
    Simplex simplex;
    simplex.corners[0] = corner(a, b, b_to_a, b_to_a.t);
    simplex.count = 1;
    simplex.share[0] = 1;
    simplex.x = simplex.corners[0].x;
    double square = simplex.x.dot(simplex.x);
    for (int step = 0; step < MOST_STEPS; ++step) {
        if (square <= touching * touching) {
            return out;
        }
        const Corner next = corner(a, b, b_to_a, simplex.x);
        // Nothing of B − A lies deeper than this plane.
        const double above = next.x.dot(simplex.x);
        if (above > 0 && above * above > enough * enough * square) {
            out.apart = true;
            out.distance = above / std::sqrt(square);
            return out;
        }
        if (square - above <= EXACT * square || simplex.has(next)) {
            break;
        }
        Simplex grown = simplex;
        grown.corners[grown.count++] = next;
        if (reduce(grown)) {
            return out;
        }
        const double nearer = grown.x.dot(grown.x);
        if (!(nearer < square)) {
            break;
        }
        simplex = grown;
        square = nearer;
    }
    out.apart = true;
    out.distance = std::sqrt(square);
    out.axis = simplex.x / out.distance;
    for (int k = 0; k < simplex.count; ++k) {
        out.on_a = out.on_a + simplex.corners[k].on_a * simplex.share[k];
        out.on_b = out.on_b + simplex.corners[k].on_b * simplex.share[k];
    }
    return out;
}

} // namespace pluvia
