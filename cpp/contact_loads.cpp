#include "contact_loads.h"

#include <algorithm>

namespace pluvia {

namespace {

// Cosine of the angle between old and new normal from which impulses go on as they are.
constexpr double SAME_NORMAL = 0.99;

double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

double square(const double a[3], const double b[3]) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return dot(d, d);
}

// For each new point the old one that it continues, or -1.
void match_points(const PairContact &contact, const PairContact &before, double match,
                  int from[4]) {
    bool taken[4] = {false, false, false, false};
    int left = 0;
    for (int i = 0; i < contact.count; ++i) {
        from[i] = -1;
        for (int k = 0; k < before.count && from[i] < 0; ++k) {
            if (!taken[k] && before.points[k].id == contact.points[i].id) {
                from[i] = k;
                taken[k] = true;
            }
        }
        left += from[i] < 0;
    }
    // What is left: nearest first, so that the result does not hang on the order.
    while (left > 0) {
        double nearest = match * match;
        int new_point = -1;
        int old_point = -1;
        for (int i = 0; i < contact.count; ++i) {
            for (int k = 0; k < before.count; ++k) {
                if (from[i] >= 0 || taken[k]) {
                    continue;
                }
                const PairPoint &point = contact.points[i];
                const PairPoint &old = before.points[k];
                const double distance =
                    std::min(square(old.on_a, point.on_a), square(old.on_b, point.on_b));
                if (distance < nearest) {
                    nearest = distance;
                    new_point = i;
                    old_point = k;
                }
            }
        }
        if (new_point < 0) {
            return;
        }
        from[new_point] = old_point;
        taken[old_point] = true;
        --left;
    }
}

// A load on a contact whose normal has turned; normals lead out of A, so that
// what presses on A points against them.
Load turned(const Load &load, const double before[3], const double now[3]) {
    Load out = load;
    ++out.age;
    const bool same = dot(before, now) >= SAME_NORMAL;
    const double pressed = std::max(0.0, -dot(load.impulse, same ? before : now));
    double rest[3];
    for (int i = 0; i < 3; ++i) {
        rest[i] = load.impulse[i] + pressed * (same ? before[i] : now[i]);
    }
    const double out_of_plane = dot(rest, now);
    for (int i = 0; i < 3; ++i) {
        // What would pull holds by no friction.
        out.impulse[i] = pressed > 0 ? rest[i] - (out_of_plane + pressed) * now[i] : 0;
    }
    return out;
}

} // namespace

void take_contact(const PairContact &contact, double match, PairState &state) {
    PairContact &before = state.memory.last;
    Load loads[4];
    if (contact.held) {
        for (int i = 0; i < contact.count; ++i) {
            loads[i] = turned(state.loads[i], before.normal, contact.normal);
        }
    } else {
        int from[4];
        match_points(contact, before, match, from);
        for (int i = 0; i < contact.count; ++i) {
            if (from[i] >= 0) {
                loads[i] = turned(state.loads[from[i]], before.normal, contact.normal);
            }
        }
    }
    std::copy(loads, loads + contact.count, state.loads);
    before.count = contact.count;
    before.feature = contact.feature;
    before.held = contact.held;
    std::copy(contact.normal, contact.normal + 3, before.normal);
    std::copy(contact.points, contact.points + contact.count, before.points);
}

} // namespace pluvia
