// The kernels of hull_axis.h. Included once for each kind of processor by
// hull_axis.cpp, in a namespace of its own that defines the vector types of
// WIDTH lanes, `smaller`, `smallest` and `any`; there is no guard.
//
// Without fused operations, with minima and maxima that do not depend on their order, and with
// candidates examined one after the other, every width gives the same bits.

static inline Vector &at(float *p) { return *reinterpret_cast<Vector *>(p); }
static inline const Vector &at(const float *p) { return *reinterpret_cast<const Vector *>(p); }
static inline Vector larger(Vector a, Vector b) { return a > b ? a : b; }
static inline Vector dot(float x, float y, float z, Vector vx, Vector vy, Vector vz) {
    return x * vx + y * vy + z * vz;
}
static inline Vector all(float x) { return x - Vector{}; }
static inline float largest(Vector v) { return -smallest(-v); }

// Highest point of a set along an axis.
static inline float highest(const float *x, const float *y, const float *z, int count,
                            const float n[3]) {
    Vector best = dot(n[0], n[1], n[2], at(x), at(y), at(z));
    for (int i = WIDTH; i < count; i += WIDTH) {
        best = larger(best, dot(n[0], n[1], n[2], at(x + i), at(y + i), at(z + i)));
    }
    return largest(best);
}

static inline float lowest(const float *x, const float *y, const float *z, int count,
                           const float n[3]) {
    Vector best = dot(n[0], n[1], n[2], at(x), at(y), at(z));
    for (int i = WIDTH; i < count; i += WIDTH) {
        best = smaller(best, dot(n[0], n[1], n[2], at(x + i), at(y + i), at(z + i)));
    }
    return smallest(best);
}

static float gap_along(const HullData &a, const HullData &b, const float axis_a[3],
                       const float axis_b[3], float shift) {
    return lowest(b.vx, b.vy, b.vz, b.vertices, axis_b) + shift -
           highest(a.vx, a.vy, a.vz, a.vertices, axis_a);
}

static void box(const HullData &hull, const float r[9], float low[3], float high[3]) {
    for (int i = 0; i < 3; ++i) {
        low[i] = lowest(hull.vx, hull.vy, hull.vz, hull.vertices, r + 3 * i);
        high[i] = highest(hull.vx, hull.vy, hull.vz, hull.vertices, r + 3 * i);
    }
}

static inline void turn(const float *r, Vector x, Vector y, Vector z, Vector &ox, Vector &oy,
                        Vector &oz) {
    ox = dot(r[0], r[1], r[2], x, y, z);
    oy = dot(r[3], r[4], r[5], x, y, z);
    oz = dot(r[6], r[7], r[8], x, y, z);
}

// Lowest of the points above each plane; two blocks of planes at a time, so
// that each point is read once for both.
static void plane_gaps(const float *nx, const float *ny, const float *nz, const float *offset,
                       int planes, const float *x, const float *y, const float *z, int points,
                       float *gaps) {
    for (int f = 0; f < planes; f += 2 * WIDTH) {
        const int g = f + WIDTH < planes ? f + WIDTH : f;
        const Vector fx = at(nx + f), fy = at(ny + f), fz = at(nz + f);
        const Vector gx = at(nx + g), gy = at(ny + g), gz = at(nz + g);
        Vector low_f = fx * x[0] + fy * y[0] + fz * z[0];
        Vector low_g = gx * x[0] + gy * y[0] + gz * z[0];
        for (int v = 1; v < points; ++v) {
            low_f = smaller(low_f, fx * x[v] + fy * y[v] + fz * z[v]);
            low_g = smaller(low_g, gx * x[v] + gy * y[v] + gz * z[v]);
        }
        at(gaps + g) = low_g - at(offset + g);
        at(gaps + f) = low_f - at(offset + f);
    }
}

static inline void widest(const float *gaps, int count, float &gap, int &index) {
    Vector best = at(gaps);
    for (int i = WIDTH; i < count; i += WIDTH) {
        best = larger(best, at(gaps + i));
    }
    gap = largest(best);
    index = 0;
    while (gaps[index] != gap && index + 1 < count) { // NaN equals none: the last one, then
        ++index;
    }
}

static void faces(const HullData &a, const HullData &b, const Relative &pose, AxisScratch &s,
                  FaceGaps &out) {
    for (int i = 0; i < b.vertices; i += WIDTH) {
        turn(pose.r, at(b.vx + i), at(b.vy + i), at(b.vz + i), at(s.bx + i), at(s.by + i),
             at(s.bz + i));
        at(s.bx + i) += pose.t[0];
        at(s.by + i) += pose.t[1];
        at(s.bz + i) += pose.t[2];
    }
    for (int i = 0; i < b.faces; i += WIDTH) {
        turn(pose.r, at(b.nx + i), at(b.ny + i), at(b.nz + i), at(s.bnx + i), at(s.bny + i),
             at(s.bnz + i));
        at(s.boffset + i) = at(b.offset + i) + dot(pose.t[0], pose.t[1], pose.t[2], at(s.bnx + i),
                                                   at(s.bny + i), at(s.bnz + i));
    }
    plane_gaps(a.nx, a.ny, a.nz, a.offset, a.faces, s.bx, s.by, s.bz, b.vertices, s.gap_a);
    plane_gaps(s.bnx, s.bny, s.bnz, s.boffset, b.faces, a.vx, a.vy, a.vz, a.vertices, s.gap_b);
    widest(s.gap_a, a.faces, out.gap_a, out.face_a);
    widest(s.gap_b, b.faces, out.gap_b, out.face_b);
}

// For each vertex: bit 0 when it is not lower than `low` above its own body's
// best face, bit 1 when not higher than `high` above the other's.
static inline void mark(const float *x, const float *y, const float *z, int count,
                        const float own[4], float low, const float other[4], float high,
                        std::int32_t *marks) {
    for (int i = 0; i < count; i += WIDTH) {
        const Vector vx = at(x + i), vy = at(y + i), vz = at(z + i);
        const Mask upper = dot(own[0], own[1], own[2], vx, vy, vz) >= all(own[3] + low);
        const Mask lower = dot(other[0], other[1], other[2], vx, vy, vz) <= all(other[3] + high);
        *reinterpret_cast<Mask *>(marks + i) = (upper & 1) | (lower & 2);
    }
}

// Edges of which an end has bit 0, and an end has bit 1.
static inline int chosen(const HullData &hull, const std::int32_t *marks, std::uint16_t *list) {
    int count = 0;
    for (int e = 0; e < hull.edges; ++e) {
        list[count] = static_cast<std::uint16_t>(e);
        count += (marks[hull.edge[e].from] | marks[hull.edge[e].to]) == 3;
    }
    return count;
}

static inline int every(const HullData &hull, std::uint16_t *list) {
    for (int e = 0; e < hull.edges; ++e) {
        list[e] = static_cast<std::uint16_t>(e);
    }
    return hull.edges;
}

// Point, direction, left and right normal of A's listed edges, one after the other.
static inline void gather_a(const HullData &a, const AxisScratch &s, int count) {
    for (int i = 0; i < count; ++i) {
        const int e = s.list_a[i];
        const HullEdge &edge = a.edge[e];
        float *o = s.edges_a + 12 * i;
        o[0] = a.vx[edge.from], o[1] = a.vy[edge.from], o[2] = a.vz[edge.from];
        o[3] = a.ex[e], o[4] = a.ey[e], o[5] = a.ez[e];
        o[6] = a.nx[edge.left], o[7] = a.ny[edge.left], o[8] = a.nz[edge.left];
        o[9] = a.nx[edge.right], o[10] = a.ny[edge.right], o[11] = a.nz[edge.right];
    }
}

// The same of B, in A's frame, one array a component.
static inline void gather_b(const HullData &b, const Relative &pose, const AxisScratch &s,
                            int count) {
    float *o[12];
    for (int k = 0; k < 12; ++k) {
        o[k] = s.edges_b + k * s.stride;
    }
    for (int i = 0; i < count; ++i) {
        const int e = s.list_b[i];
        const HullEdge &edge = b.edge[e];
        o[0][i] = s.bx[edge.from], o[1][i] = s.by[edge.from], o[2][i] = s.bz[edge.from];
        o[3][i] = b.ex[e], o[4][i] = b.ey[e], o[5][i] = b.ez[e];
        o[6][i] = s.bnx[edge.left], o[7][i] = s.bny[edge.left], o[8][i] = s.bnz[edge.left];
        o[9][i] = s.bnx[edge.right], o[10][i] = s.bny[edge.right], o[11][i] = s.bnz[edge.right];
    }
    for (int i = count; i < padded(count); ++i) {
        for (int k = 0; k < 12; ++k) {
            o[k][i] = 0; // no direction: parallel to every edge
        }
    }
    for (int i = 0; i < count; i += WIDTH) {
        turn(pose.r, at(o[3] + i), at(o[4] + i), at(o[5] + i), at(o[3] + i), at(o[4] + i),
             at(o[5] + i));
    }
}

// Product of two sines above which both count as clearly on one side. Near
// the threshold the axis all but coincides with a face normal, which is among
// the axes already: what is lost is less than 1e-7 of the bodies' size.
static constexpr float SAME_SIDE = 1e-7F;
// Square of the sine between two edges below which they count as parallel:
// the face that they would span is narrower than 3e-4 of its length.
static constexpr float PARALLEL = 1e-7F;

// Takes the pair's gap from true supports if it is wider than the best so far.
static inline void examine(const HullData &a, const HullData &b, const AxisScratch &s, int i, int j,
                           float &best, EdgeGap &out) {
    const float *e = s.edges_a + 12 * i;
    const auto f = [&s, j](int k) { return static_cast<double>(s.edges_b[k * s.stride + j]); };
    double n[3] = {e[4] * f(5) - e[5] * f(4), e[5] * f(3) - e[3] * f(5), e[3] * f(4) - e[4] * f(3)};
    double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (n[0] * (e[6] + e[9]) + n[1] * (e[7] + e[10]) + n[2] * (e[8] + e[11]) < 0) {
        length = -length;
    }
    const float axis[3] = {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length),
                           static_cast<float>(n[2] / length)};
    const float gap =
        lowest(s.bx, s.by, s.bz, b.vertices, axis) - highest(a.vx, a.vy, a.vz, a.vertices, axis);
    if (gap > best) {
        best = gap;
        out.edge_a = s.list_a[i];
        out.edge_b = s.list_b[j];
        out.gap = gap;
        out.axis[0] = axis[0], out.axis[1] = axis[1], out.axis[2] = axis[2];
    }
}

static void edges(const HullData &a, const HullData &b, const Relative &pose, const FaceGaps &face,
                  float best, float enough, float depth, AxisScratch &s, EdgeGap &out) {
    out.edge_a = out.edge_b = -1;
    int count_a, count_b;
    if (depth >= 0) {
        const float plane_a[4] = {a.nx[face.face_a], a.ny[face.face_a], a.nz[face.face_a],
                                  a.offset[face.face_a]};
        const float plane_b[4] = {s.bnx[face.face_b], s.bny[face.face_b], s.bnz[face.face_b],
                                  s.boffset[face.face_b]};
        mark(a.vx, a.vy, a.vz, a.vertices, plane_a, face.gap_a - depth, plane_b, depth, s.near_a);
        mark(s.bx, s.by, s.bz, b.vertices, plane_b, face.gap_b - depth, plane_a, depth, s.near_b);
        count_a = chosen(a, s.near_a, s.list_a);
        count_b = chosen(b, s.near_b, s.list_b);
    } else {
        count_a = every(a, s.list_a);
        count_b = every(b, s.list_b);
    }
    gather_a(a, s, count_a);
    gather_b(b, pose, s, count_b);
    const float *o = s.edges_b;
    const int k = s.stride;
    for (int i = 0; i < count_a; ++i) {
        const float *e = s.edges_a + 12 * i;
        const float sum[3] = {e[6] + e[9], e[7] + e[10], e[8] + e[11]};
        for (int j = 0; j < count_b; j += WIDTH) {
            const float *f = o + j;
            const Vector px = at(f), py = at(f + k), pz = at(f + 2 * k);
            const Vector dx = at(f + 3 * k), dy = at(f + 4 * k), dz = at(f + 5 * k);
            const Vector fl = dot(e[3], e[4], e[5], at(f + 6 * k), at(f + 7 * k), at(f + 8 * k));
            const Vector fr = dot(e[3], e[4], e[5], at(f + 9 * k), at(f + 10 * k), at(f + 11 * k));
            const Vector el = dot(e[6], e[7], e[8], dx, dy, dz);
            const Vector er = dot(e[9], e[10], e[11], dx, dy, dz);
            // The ends of each arc lie on both sides of the other's plane, and
            // both arcs (B's reversed) on the same hemisphere.
            const Vector sides = larger(larger(fl * fr, el * er), larger(fl * er, fr * el));
            const Vector nx = e[4] * dz - e[5] * dy;
            const Vector ny = e[5] * dx - e[3] * dz;
            const Vector nz = e[3] * dy - e[4] * dx;
            const Vector square = nx * nx + ny * ny + nz * nz;
            // Gap between the edges times the sine between them, positive
            // when the normal that points out of A leads from A to B.
            const Vector out_of_a = nx * sum[0] + ny * sum[1] + nz * sum[2];
            const Vector apart = nx * (px - e[0]) + ny * (py - e[1]) + nz * (pz - e[2]);
            const Vector signed_apart = out_of_a < 0.0F ? -apart : apart;
            // apart / sine > best without root or division: x |x| grows with x.
            const Vector size = signed_apart < 0.0F ? -signed_apart : signed_apart;
            const float limit = best < 0 ? -best * best : best * best;
            const Mask better = (sides <= SAME_SIDE) & (square >= PARALLEL) &
                                (signed_apart * size > limit * square);
            if (__builtin_expect(any(better), 0)) {
                for (int lane = 0; lane < WIDTH; ++lane) {
                    // The best may have changed since.
                    const float now = best < 0 ? -best * best : best * best;
                    if (better[lane] && signed_apart[lane] * size[lane] > now * square[lane]) {
                        examine(a, b, s, i, j + lane, best, out);
                        if (best > enough) {
                            return;
                        }
                    }
                }
            }
        }
    }
}
