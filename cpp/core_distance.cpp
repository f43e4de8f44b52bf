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
    double x[3];
    double on_a[3], on_b[3];
    int a, b;
};

struct Simplex {
    Corner corners[4];
    int count = 0;
    double share[4] = {0, 0, 0, 0};
    double x[3] = {0, 0, 0}; // its point closest to the origin

    bool has(const Corner &c) const {
        return std::any_of(corners, corners + count,
                           [&](const Corner &o) { return o.a == c.a && o.b == c.b; });
    }
};

int highest(const HullData &hull, const double d[3]) {
    int best = 0;
    double most = -1e300;
    for (int v = 0; v < hull.vertices; ++v) {
        const double h = d[0] * static_cast<double>(hull.vx[v]) +
                         d[1] * static_cast<double>(hull.vy[v]) +
                         d[2] * static_cast<double>(hull.vz[v]);
        if (h > most) {
            most = h;
            best = v;
        }
    }
    return best;
}

void place(const HullData &hull, int v, double out[3]) {
    out[0] = static_cast<double>(hull.vx[v]);
    out[1] = static_cast<double>(hull.vy[v]);
    out[2] = static_cast<double>(hull.vz[v]);
}

// Shares of the corners `chosen` in the point closest to the origin of the flat through them; false
// where one is not positive, or the corners do not span the flat.
bool shares(const Simplex &s, const int *chosen, int count, double share[4]) {
    // With y = x0 + Σ t_i e_i: normal equations G t = -e·x0, solved by Cramer's rule.
    const double *x0 = s.corners[chosen[0]].x;
    double e[3][3], g[3][3], f[3];
    const int n = count - 1;
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < 3; ++k) {
            e[i][k] = s.corners[chosen[i + 1]].x[k] - x0[k];
        }
    }
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            g[i][j] = dot(e[i], e[j]);
        }
        f[i] = -dot(e[i], x0);
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
        double c[3];
        const auto cross = [](const double *p, const double *q, double out[3]) {
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                out[i] = p[j] * q[k] - p[k] * q[j];
            }
        };
        cross(e[1], e[2], c);
        const double det = dot(e[0], c);
        if (!(std::abs(det) > 1e-12 * std::sqrt(g[0][0] * g[1][1] * g[2][2]))) {
            return false;
        }
        t[0] = -dot(x0, c) / det;
        cross(e[2], e[0], c);
        t[1] = -dot(x0, c) / det;
        cross(e[0], e[1], c);
        t[2] = -dot(x0, c) / det;
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
        double x[3] = {0, 0, 0};
        for (int i = 0; i < count; ++i) {
            for (int k = 0; k < 3; ++k) {
                x[k] += share[i] * s.corners[chosen[i]].x[k];
            }
        }
        const double square = count == 4 ? 0 : dot(x, x);
        if (square < least) {
            least = square;
            best.count = count;
            for (int i = 0; i < count; ++i) {
                best.corners[i] = s.corners[chosen[i]];
                best.share[i] = share[i];
            }
            std::copy(x, x + 3, best.x);
        }
    }
    s = best;
    return s.count == 4;
}

class Search {
  public:
    Search(const HullData &a, const HullData &b, const Rigid &b_to_a)
        : a_(a), b_(b), b_to_a_(b_to_a) {}

    // The corner of B − A that lies deepest against a direction.
    Corner corner(const double direction[3]) const {
        double against[3], seen[3];
        for (int i = 0; i < 3; ++i) {
            const double *r = b_to_a_.r;
            seen[i] = -(r[i] * direction[0] + r[3 + i] * direction[1] + r[6 + i] * direction[2]);
            against[i] = direction[i];
        }
        Corner c;
        c.a = highest(a_, against);
        c.b = highest(b_, seen);
        double local[3];
        place(a_, c.a, c.on_a);
        place(b_, c.b, local);
        b_to_a_.apply(local, c.on_b);
        for (int i = 0; i < 3; ++i) {
            c.x[i] = c.on_b[i] - c.on_a[i];
        }
        return c;
    }

  private:
    const HullData &a_;
    const HullData &b_;
    const Rigid &b_to_a_;
};

} // namespace

CoreDistance core_distance(const HullData &a, const HullData &b, const Rigid &b_to_a,
                           double enough) {
    const Search search(a, b, b_to_a);
    const double touching = TOUCHING * static_cast<double>(std::min(a.radius, b.radius));
    CoreDistance out{};
    Simplex simplex;
    simplex.corners[0] = search.corner(b_to_a.t);
    simplex.count = 1;
    simplex.share[0] = 1;
    std::copy(simplex.corners[0].x, simplex.corners[0].x + 3, simplex.x);
    double square = dot(simplex.x, simplex.x);
    for (int step = 0; step < MOST_STEPS; ++step) {
        if (square <= touching * touching) {
            return out;
        }
        const Corner next = search.corner(simplex.x);
        // Nothing of B − A lies deeper than this plane.
        const double above = dot(next.x, simplex.x);
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
        const double nearer = dot(grown.x, grown.x);
        if (!(nearer < square)) {
            break;
        }
        simplex = grown;
        square = nearer;
    }
    out.apart = true;
    out.distance = std::sqrt(square);
    for (int i = 0; i < 3; ++i) {
        out.axis[i] = simplex.x[i] / out.distance;
        for (int k = 0; k < simplex.count; ++k) {
            out.on_a[i] += simplex.share[k] * simplex.corners[k].on_a[i];
            out.on_b[i] += simplex.share[k] * simplex.corners[k].on_b[i];
        }
    }
    return out;
}

} // namespace pluvia
