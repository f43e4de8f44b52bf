// Contact points of two hulls once the feature that touches is known: a face
// of one clipped against a face of the other, or two edges.
//
// In double, since points of a flat contact differ by little and are what the
// solver remembers from step to step.
#pragma once

#include "hull_axis.h"

#include <vector>

namespace pluvia {

struct KeptContact;

// A rigid motion x -> r x + t, r row by row.
struct Rigid {
    double r[9];
    Vec t;

    Vec turn(const Vec &x) const {
        return {r[0] * x.x + r[1] * x.y + r[2] * x.z, r[3] * x.x + r[4] * x.y + r[5] * x.z,
                r[6] * x.x + r[7] * x.y + r[8] * x.z};
    }
    Vec apply(const Vec &x) const { return turn(x) + t; }
    Vec turn_back(const Vec &x) const {
        return {r[0] * x.x + r[3] * x.y + r[6] * x.z, r[1] * x.x + r[4] * x.y + r[7] * x.z,
                r[2] * x.x + r[5] * x.y + r[8] * x.z};
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
    Vec x;      // on the incident face, in the frame of the reference hull
    double gap; // above the reference face
    // What meets here, `packed`: a corner of the incident face (kind 0), one of its edges and a
    // side of the reference face (1), or two such sides at their corner (2).
    std::uint32_t id;

    bool is_near(const Vec &place, double within) const {
        const Vec d = x - place;
        return d.dot(d) <= within * within;
    }
};

// Buffers of one thread.
struct ClipScratch {
    struct Corner {
        Vec x;
        std::uint32_t id;
        std::uint32_t edge; // to the next corner; SIDE added for a side of the reference face
        double out;         // distance outside the side at hand
    };
    std::vector<Corner> polygon, clipped;
    std::vector<ClipPoint> points;
};

// The face of a hull that meets a reference face with outward normal `normal` (in the frame of
// `incident`): of the faces around its lowest vertex the one that looks most against the normal.
// `before` (-1: none), the one of the last step, is kept while it is nearly as good: its lowest
// corner not `slack` higher, its direction not much less opposite.
struct Incident {
    int face;
    double lowest; // of the whole hull along the normal
};
Incident incident_face(const HullData &incident, const Vec &normal, int before, double slack);

// Fills `scratch.points` with all corners of the incident face inside the
// sides of the reference face that are at most `margin` above it. `pose` leads
// from the incident hull's frame to the reference hull's.
void clip_face(const HullData &reference, int reference_face, const HullData &incident,
               int incident_face, const Rigid &pose, double margin, ClipScratch &scratch);

// Picks at most four of the points that hold the bodies best: the deepest, the farthest from it,
// and those that span the largest area. Points that `last` has win over others that are better by
// little (`slack`, a length). The picked ones are moved to the front; returns their number.
int reduce_points(std::vector<ClipPoint> &points, const Vec &normal, double margin, double slack,
                  const KeptContact &last);

// The same where the points that `last` has are to be kept whatever else
// there is: they come first, then, up to four, those farthest from all before.
int keep_points(std::vector<ClipPoint> &points, double slack, const KeptContact &last);

// Where two edges come closest. `pose` leads from B's frame to A's.
struct EdgeContact {
    Vec axis;       // unit normal of both out of A, in A's frame
    Vec on_a, on_b; // in A's frame, one facing the other: midway where edges miss each other
    double gap;     // between the edges along the axis
    Vec across;     // the way by which the edges miss each other, from A's to B's
    double off;     // its length
    bool defined;   // false for edges that are parallel or without direction

    // Of edges that miss each other: looks from the one to the other, as bodies apart do.
    void look_across();
};
EdgeContact edge_contact(const HullData &a, int edge_a, const HullData &b, int edge_b,
                         const Rigid &pose);

} // namespace pluvia
