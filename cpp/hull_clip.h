// Contact points of two hulls once the feature that touches is known: a face
// of one clipped against a face of the other, or two edges.
//
// In double, since points of a flat contact differ by little and are what the
// solver remembers from step to step.
#pragma once

#include "hull_axis.h"

#include <vector>

namespace pluvia {

inline double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// A rigid motion x -> r x + t, r row by row.
struct Rigid {
    double r[9];
    double t[3];

    template <class N> void apply(const N x[3], double out[3]) const {
        for (int i = 0; i < 3; ++i) {
            out[i] = r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2] + t[i];
        }
    }
    template <class N> void turn(const N x[3], double out[3]) const {
        for (int i = 0; i < 3; ++i) {
            out[i] = r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2];
        }
    }
    // The inverse motion.
    Rigid inverse() const;
    // From the frame of `from` to the frame of `to`, both given in the world.
    static Rigid between(const Rigid &from, const Rigid &to);
    // In single precision.
    Relative rounded() const;
};

// A point of a face contact.
struct ClipPoint {
    double x[3]; // on the incident face, in the frame of the reference hull
    double gap;  // above the reference face
    // What meets here: a corner of the incident face (0), one of its edges and
    // one of the reference face's (1), a corner of the reference face (2); in
    // the two highest bits, before the indices. Never negative as an int.
    std::uint32_t id;
};

// Buffers of one thread.
struct ClipScratch {
    struct Corner {
        double x[3];
        std::uint32_t id;
        std::uint32_t edge; // to the next corner; SIDE added for a side of the reference face
        double out;         // distance outside the side at hand
    };
    std::vector<Corner> polygon, clipped;
    std::vector<ClipPoint> points;
};

// The face of a hull that meets a reference face with outward normal `normal`
// (in the frame of `incident`): of the faces around its lowest vertex the one
// that looks most against the normal. `before` (-1: none), the one of the last
// step, is kept while it is nearly as good: its lowest corner not `slack`
// higher, its direction not much less opposite.
struct Incident {
    int face;
    double lowest; // of the whole hull along the normal
};
Incident incident_face(const HullData &incident, const double normal[3], int before, double slack);

// Fills `scratch.points` with all corners of the incident face inside the
// sides of the reference face that are at most `margin` above it. `pose` leads
// from the incident hull's frame to the reference hull's.
void clip_face(const HullData &reference, int reference_face, const HullData &incident,
               int incident_face, const Rigid &pose, double margin, ClipScratch &scratch);

// Picks at most four of the points that hold the bodies best: the deepest,
// the farthest from it, and those that span the largest area. Points with one
// of the `known` ids win over others that are better by little (`slack`, a
// length). The picked ones are moved to the front; returns their number.
int reduce_points(std::vector<ClipPoint> &points, const double normal[3], double margin,
                  double slack, const std::uint32_t *known, int known_count);

// The same where the points with the `known` ids are to be kept whatever else
// there is: they come first, then, up to four, those farthest from all before.
int keep_points(std::vector<ClipPoint> &points, double slack, const std::uint32_t *known,
                int known_count);

// Where two edges come closest. `pose` leads from B's frame to A's.
struct EdgeContact {
    double axis[3]; // unit normal of both out of A, in A's frame
    double on_a[3]; // in A's frame
    double on_b[3]; // in A's frame
    double gap;     // between the edges along the axis
    double off;     // how far the points are from facing each other
    bool defined;   // false for edges that are parallel or without direction
};
EdgeContact edge_contact(const HullData &a, int edge_a, const HullData &b, int edge_b,
                         const Rigid &pose);

} // namespace pluvia
