#include "contact_loads.h"

#include <algorithm>
#include <numeric>

namespace pluvia {

namespace {

// Cosine of the angle between old and new normal from which impulses go on as they are.
constexpr double SAME_NORMAL = 0.99;

double square(const float a[3], const float b[3]) {
    const float d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return three(d).dot(three(d));
}

// For each new point the old one that it continues, or -1.
void match_points(const KeptContact &contact, const KeptContact &before, double match,
                  int from[MOST_POINTS]) {
    bool taken[MOST_POINTS] = {};
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
                const KeptPoint &point = contact.points[i];
                const KeptPoint &old = before.points[k];
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
Load turned(const Load &load, const Vec &before, const Vec &now) {
    Load out = load;
    ++out.age;
    const Vec impulse = three(load.impulse);
    const Vec &normal = before.dot(now) >= SAME_NORMAL ? before : now;
    const double pressed = std::max(0.0, -impulse.dot(normal));
    const Vec rest = impulse + normal * pressed;
    // What would pull holds by no friction.
    store(pressed > 0 ? rest - now * (rest.dot(now) + pressed) : Vec{0, 0, 0}, out.impulse);
    return out;
}

} // namespace

void take_contact(const PairContact &contact, double match, PairState &state) {
    const KeptContact before = state.memory.last;
    KeptContact &now = state.memory.last;
    now.keep(contact);
    const Vec old_normal = three(before.normal), new_normal = three(now.normal);
    int from[MOST_POINTS];
    std::iota(from, from + MOST_POINTS, 0);
    if (!contact.held) {
        match_points(now, before, match, from);
    }
    Load loads[MOST_POINTS];
    for (int i = 0; i < now.count; ++i) {
        if (from[i] >= 0) {
            loads[i] = turned(state.loads[from[i]], old_normal, new_normal);
        }
    }
    std::copy(loads, loads + now.count, state.loads);
}

} // namespace pluvia
