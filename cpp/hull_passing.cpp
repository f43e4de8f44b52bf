// Predicts where two bodies are later in the step, and chooses the face along which they slide past
// each other where there is one.
#include "hull_pair.h"

#include <cmath>

namespace pluvia {

namespace {

// In which the moment of meeting is found.
constexpr int MOST_STEPS = 16;

// Whether a face other than the one found has a gap of `most` at most, or is as deep.
bool has_other(const float *gaps, int count, int besides, float most) {
    for (int f = 0; f < count; ++f) {
        if (f != besides && std::abs(gaps[f]) <= most) {
            return true;
        }
    }
    return false;
}

} // namespace

Rigid ahead(const Rigid &pose, const HullMotion &motion, double step) {
    // By Cayley's form, a rotation at any speed: (1 + k×)/(1 − k×) turns about k by 2 atan |k|,
    // with the series of the tangent, right to 1e-3 rad up to a turn of 1 rad.
    const Vec w = motion.spin * step;
    const double square = w.dot(w);
    const Vec k = w * (0.5 * (1 + square / 12 * (1 + square / 10)));
    const double twice = 2 / (1 + k.dot(k));
    const double rest = 1 - twice * k.dot(k);
    const double turn[9] = {
        rest + twice * k.x * k.x,  twice * (k.x * k.y - k.z), twice * (k.x * k.z + k.y),
        twice * (k.x * k.y + k.z), rest + twice * k.y * k.y,  twice * (k.y * k.z - k.x),
        twice * (k.x * k.z - k.y), twice * (k.y * k.z + k.x), rest + twice * k.z * k.z};
    Rigid out;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out.r[3 * i + j] = turn[3 * i] * pose.r[j] + turn[3 * i + 1] * pose.r[3 + j] +
                               turn[3 * i + 2] * pose.r[6 + j];
        }
    }
    out.t = pose.t + motion.velocity * step;
    return out;
}

bool Meeting::go_on(double gap, double closing) {
    if (gap <= 0 || steps++ == MOST_STEPS) {
        return false;
    }
    double next;
    if (closing > 0) {
        early = time;
        next = time + gap / closing;
        if (next >= late) {
            next = late < step ? (early + late) / 2 : step;
        }
    } else {
        late = time;
        next = (early + late) / 2;
    }
    if (std::abs(next - time) <= 1e-6 * step) {
        return false;
    }
    time = next;
    return true;
}

Rigid b_to_a_ahead(const PairCase &pair) {
    const PairMotion &motion = pair.motion;
    return Rigid::between(ahead(pair.pose_b, motion.b, motion.step),
                          ahead(pair.pose_a, motion.a, motion.step));
}

PairFace passing_face(const PairCase &pair, const PairFace &found) {
    const HullData &a = pair.a, &b = pair.b;
    const AxisScratch &now = pair.scratch.axis;
    AxisScratch &ahead = pair.scratch.ahead;
    const auto most = static_cast<float>(pair.settings.hysteresis);
    if (!has_other(now.gap_a, a.faces, found.is_a ? found.face : -1, most) &&
        !has_other(now.gap_b, b.faces, found.is_a ? -1 : found.face, most)) {
        return found;
    }
    ahead.fit(a, b);
    FaceGaps widest;
    pair.kernels.faces(a, b, b_to_a_ahead(pair).rounded(), ahead, widest);
    const auto approach = [&](bool is_a, int f) {
        return is_a ? now.gap_a[f] - ahead.gap_a[f] : now.gap_b[f] - ahead.gap_b[f];
    };
    PairFace best = found;
    float least = approach(found.is_a, found.face) / 2;
    if (!(least > 0)) {
        return found;
    }
    for (const bool is_a : {true, false}) {
        const float *gap = is_a ? now.gap_a : now.gap_b;
        const float *then = is_a ? ahead.gap_a : ahead.gap_b;
        for (int f = 0; f < (is_a ? a.faces : b.faces); ++f) {
            if (std::abs(gap[f]) <= most && std::abs(then[f]) <= most &&
                approach(is_a, f) < least) {
                least = approach(is_a, f);
                best = {is_a, f};
            }
        }
    }
    return best;
}

} // namespace pluvia
