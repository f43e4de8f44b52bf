#include "rounded_pair.h"

#include "rounded_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pluvia {

namespace {

// Steps in which the moment of meeting is found.
constexpr int MOST_STEPS = 16;

// A contact found at poses to come, as the bodies are now. The solver pushes both in one point,
// nearer to the lighter one, and takes its two ends to lie on the normal now: they are put where
// the one point will be right (sphere_pair.cpp).
void bring_back(const HullData &a, const HullData &b, const Rigid &pose_a, const Rigid &pose_b,
                const Rigid &then_a, const Rigid &then_b, const Lightness &lightness,
                PairContact &out) {
    const double all = std::max(lightness.a + lightness.b, std::numeric_limits<double>::min());
    for (int p = 0; p < out.count; ++p) {
        PairPoint &point = out.points[p];
        // Points of the cores go with their bodies, what the balls add stays where it looks.
        const auto arm = [&](const Rigid &then, const Rigid &now, double ball, const double on[3],
                             double out_arm[3]) {
            double turned[3], core[3], local[3];
            then.turn(on, turned);
            for (int i = 0; i < 3; ++i) {
                core[i] = turned[i] - ball * out.normal[i];
            }
            then.inverse().turn(core, local);
            now.turn(local, out_arm);
            for (int i = 0; i < 3; ++i) {
                out_arm[i] += ball * out.normal[i];
            }
        };
        double arm_a[3], arm_b[3], apart[3], across[3];
        arm(then_a, pose_a, a.rounding, point.on_a, arm_a);
        arm(then_b, pose_b, -b.rounding, point.on_b, arm_b);
        for (int i = 0; i < 3; ++i) {
            apart[i] = arm_b[i] + pose_b.t[i] - arm_a[i] - pose_a.t[i];
        }
        point.gap = dot(apart, out.normal);
        for (int i = 0; i < 3; ++i) {
            across[i] = apart[i] - point.gap * out.normal[i];
            arm_a[i] += lightness.b / all * across[i];
            arm_b[i] -= lightness.a / all * across[i];
        }
        pose_a.inverse().turn(arm_a, point.on_a);
        pose_b.inverse().turn(arm_b, point.on_b);
    }
}

} // namespace

double collide_rounded(const AxisKernels &kernels, const HullData &a, const HullData &b,
                       const Rigid &pose_a, const Rigid &pose_b, const PairMotion &motion,
                       const Lightness &lightness, const PairSettings &settings, PairMemory &memory,
                       PairScratch &scratch, PairContact &out) {
    out.count = 0;
    out.feature = 0;
    out.held = false;
    RoundedPair now(kernels, a, b, pose_a, pose_b, settings, memory, scratch, out);
    if (now.hold()) {
        out.feature = packed(memory.feature, memory.first, memory.second);
        double deepest = std::numeric_limits<double>::infinity();
        for (int i = 0; i < out.count; ++i) {
            deepest = std::min(deepest, out.points[i].gap);
        }
        return deepest;
    }
    const double gap = now.look(settings.speculative_margin);
    const double margin = settings.speculative_margin;
    if (gap > margin) {
        memory.feature = Feature::None;
        memory.has_axis = false;
        memory.recalled = false;
        return gap;
    }
    const Rigid end = b_to_a_ahead(pose_a, pose_b, motion);
    // Newton's method on the gap, which is nearly convex in time, as for spheres.
    double time = 0, early = 0, late = motion.step, left = gap, closing = now.closing(motion);
    for (int i = 0; i < MOST_STEPS && gap > margin - settings.approach && left > 0; ++i) {
        double next;
        if (closing > 0) {
            early = time;
            next = time + left / closing;
            if (next >= late) {
                next = late < motion.step ? (early + late) / 2 : motion.step;
            }
        } else {
            late = time;
            next = (early + late) / 2;
        }
        if (std::abs(next - time) <= 1e-6 * motion.step) {
            break;
        }
        time = next;
        const Rigid then_a = ahead(pose_a, motion.a, time), then_b = ahead(pose_b, motion.b, time);
        RoundedPair then(kernels, a, b, then_a, then_b, settings, memory, scratch, out);
        left = then.look(std::numeric_limits<double>::infinity());
        closing = then.closing(motion);
    }
    if (time > 0) {
        const Rigid then_a = ahead(pose_a, motion.a, time), then_b = ahead(pose_b, motion.b, time);
        RoundedPair then(kernels, a, b, then_a, then_b, settings, memory, scratch, out);
        then.look(std::numeric_limits<double>::infinity());
        then.take(end);
        bring_back(a, b, pose_a, pose_b, then_a, then_b, lightness, out);
        // Nothing was found at the poses of now that could be held.
        memory.feature = Feature::None;
    } else {
        now.take(end);
    }
    if (out.count > 0 && memory.feature != Feature::None) {
        out.feature = packed(memory.feature, memory.first, memory.second);
    }
    return gap;
}

} // namespace pluvia
