// Runs single parts of a world outside any world, for tests: the hull–hull test on one pair, the
// threads, the speeds within a crowd, the memory of the process.
#include "probe.h"

#include "crowd.h"
#include "pluvia/src/world/bullet/ffi.rs.h"
#include "shapes.h"
#include "workers.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#if defined(__linux__)
#include <features.h>
#endif
#if defined(__GLIBC__)
#if __GLIBC_PREREQ(2, 33)
#define PLUVIA_COUNTS_BYTES 1
#include <malloc.h>
#endif
#endif

namespace pluvia {

HullProbe::HullProbe(double scale, const Tolerances &tolerances, bool portable,
                     const ShapeDefinition &a, const ShapeDefinition &b)
    : units_(scale), collision_(tolerances, scale, portable), a_(make_hull_data(units_, a)),
      b_(make_hull_data(units_, b)) {}

rust::Vec<HullProbePoint> HullProbe::step(const BodyPose &a, const BodyPose &b) {
    const Rigid pose_a = rigid(units_.pose(a));
    const Rigid pose_b = rigid(units_.pose(b));
    // Counts steps in what a point hands on to the one that continues it, and no solver reads here.
    for (Load &load : state_.loads) {
        load.warm_start += 1;
    }
    PairContact found;
    collide({*collision_.kernels, *a_, *b_, pose_a, pose_b, PairMotion{}, collision_.settings,
             state_.memory, scratch_, found, Lightness{1, 1}});
    take_contact(found, collision_.match, state_);
    const KeptContact &contact = state_.memory.last;
    const Vec normal = three(contact.normal);
    rust::Vec<HullProbePoint> out;
    for (int i = 0; i < contact.count; ++i) {
        const KeptPoint &p = contact.points[i];
        const Load &load = state_.loads[i];
        const Vec impulse = three(load.impulse);
        const double pressed = -impulse.dot(normal);
        HullProbePoint point{};
        point.gap = units_.metres(static_cast<double>(p.gap));
        point.normal = array(-normal);
        point.on_a = units_.metres(pose_a.apply(three(p.on_a)));
        point.on_b = units_.metres(pose_b.apply(three(p.on_b)));
        point.id = p.id;
        point.age = static_cast<std::int32_t>(load.warm_start) - 1;
        point.impulse = units_.metres(pressed);
        point.friction = units_.metres(impulse + normal * pressed);
        out.push_back(point);
    }
    return out;
}

void HullProbe::set_impulse(std::size_t point, double normal,
                            const std::array<double, 3> &friction) {
    const KeptContact &contact = state_.memory.last;
    if (point >= static_cast<std::size_t>(contact.count)) {
        throw std::runtime_error("the pair has no such contact point");
    }
    store((three(friction.data()) - three(contact.normal) * normal) * units_.scale(),
          state_.loads[point].impulse);
}

void HullProbe::forget() { state_ = PairState(); }

HullProbeGap HullProbe::widest_gap(const BodyPose &a, const BodyPose &b, bool all_edges) {
    const Rigid pose_a = rigid(units_.pose(a));
    const Rigid pose_b = rigid(units_.pose(b));
    const Relative pose = Rigid::between(pose_b, pose_a).rounded();
    AxisScratch &scratch = scratch_.axis;
    scratch.fit(*a_, *b_);
    FaceGaps faces;
    collision_.kernels->faces(*a_, *b_, pose, scratch, faces);
    const bool is_a = faces.gap_a >= faces.gap_b;
    double gap = is_a ? faces.gap_a : faces.gap_b;
    Vec axis = is_a ? a_->normal(faces.face_a) : -scratch.normal_b(faces.face_b);
    const auto margin = static_cast<float>(collision_.settings.speculative_margin);
    const auto best = static_cast<float>(gap);
    EdgeGap edges;
    collision_.kernels->edges(*a_, *b_, pose, faces, best, 1e30F,
                              all_edges ? -1 : std::max(margin, -best), scratch, edges);
    if (edges.edge_a >= 0) {
        gap = edges.gap;
        axis = three(edges.axis);
    }
    return {units_.metres(gap), array(pose_a.turn(axis))};
}

std::unique_ptr<HullProbe> new_hull_probe(double scale, const Tolerances &tolerances, bool portable,
                                          const ShapeDefinition &a, const ShapeDefinition &b) {
    return std::make_unique<HullProbe>(scale, tolerances, portable, a, b);
}

std::uint64_t shared_sum(std::int32_t threads, std::size_t size, std::size_t rounds,
                         std::size_t fails_at) {
    if (threads < 1) {
        throw std::runtime_error("work is shared by one thread at least");
    }
    Workers workers(threads);
    // Plain numbers, as in a world: only one thread at a time may touch each.
    std::vector<std::uint64_t> parts(static_cast<std::size_t>(threads), 0);
    std::vector<std::uint64_t> here(size, 0), there(size, 0);
    std::uint64_t early = 0;
    const std::array<Share, 3> shares{{{size, 3, 3}, {size, 5, 5}, {size > 0 ? 1U : 0U, 1, 1}}};
    for (std::size_t round = 0; round < rounds; ++round) {
        const auto part = [&](std::size_t share, int worker, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (share == 0) {
                    if (i == fails_at) {
                        throw std::runtime_error("asked to fail at " + std::to_string(i));
                    }
                    here[i] += i;
                } else if (share == 1) {
                    // By whoever had the other end in the share before.
                    there[i] += here[size - 1 - i];
                } else {
                    const std::uint64_t sum =
                        std::accumulate(there.begin(), there.end(), std::uint64_t{0});
                    const std::uint64_t times = (round + 1) * (round + 2) / 2;
                    early += sum != times * (size * (size - 1) / 2);
                }
            }
            parts[static_cast<std::size_t>(worker)] += end - begin;
        };
        workers.share(shares.data(), shares.size(), part);
    }
    const std::uint64_t touched = std::accumulate(parts.begin(), parts.end(), std::uint64_t{0});
    if (touched != (2 * size + shares[2].size) * rounds) {
        throw std::logic_error("work was lost or done twice");
    }
    if (early > 0) {
        throw std::logic_error("a share began before the one before was over");
    }
    return std::accumulate(here.begin(), here.end(), std::uint64_t{0});
}

std::array<std::uint64_t, 2> chained_work(std::int32_t threads, std::size_t rounds) {
    if (threads < 1) {
        throw std::runtime_error("work is shared by one thread at least");
    }
    Workers workers(threads);
    const auto count = static_cast<std::size_t>(workers.count());
    constexpr std::size_t COLOURS = 20;
    std::vector<std::size_t> ends(count);
    std::iota(ends.begin(), ends.end(), std::size_t{1});
    // Of a colour, what is between threads and what is a thread's own.
    std::vector<Share> shares;
    std::size_t next = 0;
    for (std::size_t c = 0; c < COLOURS; ++c) {
        shares.push_back({count, count, 1, ends.data(), next});
        next = shares.size();
        shares.push_back({count, count, 1, ends.data(), 0});
    }
    struct Numbers {
        std::vector<std::uint64_t> own, between;
        void work(std::size_t share, std::size_t thread) {
            std::uint64_t &mine = own[thread];
            if (share % 2 == 1) {
                for (int i = 0; i < 20; ++i) {
                    mine = 31 * mine + share;
                }
                return;
            }
            std::uint64_t &ours = between[thread + share / 2 % 2];
            ours = 17 * ours + mine;
            mine = 13 * mine + ours;
        }
    };
    Numbers shared{std::vector<std::uint64_t>(count, 1), std::vector<std::uint64_t>(count + 1, 2)};
    Numbers alone = shared;
    for (std::size_t round = 0; round < rounds; ++round) {
        workers.share(shares.data(), shares.size(),
                      [&](std::size_t share, int, std::size_t begin, std::size_t end) {
                          for (std::size_t i = begin; i < end; ++i) {
                              shared.work(share, i);
                          }
                      });
        for (std::size_t share = 0; share < shares.size(); ++share) {
            for (std::size_t i = 0; i < count; ++i) {
                alone.work(share, i);
            }
        }
    }
    const auto sum = [](const Numbers &numbers) {
        std::uint64_t all = 0;
        for (const auto *list : {&numbers.own, &numbers.between}) {
            for (const std::uint64_t number : *list) {
                all = 7 * all + number;
            }
        }
        return all;
    };
    return {sum(shared), sum(alone)};
}

std::array<double, 4> shared_time(std::int32_t threads, rust::Slice<const std::size_t> sizes,
                                  rust::Slice<const std::size_t> leasts) {
    if (threads < 1 || sizes.size() != leasts.size()) {
        throw std::runtime_error("a least for every size, and one thread at least");
    }
    Workers workers(threads);
    std::vector<Share> shares;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
        shares.push_back({sizes[k], leasts[k], leasts[k]});
    }
    workers.share(shares.data(), shares.size(), [](std::size_t, int, std::size_t, std::size_t) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    });
    const SharedTime &time = workers.shared();
    return {time.now, time.on[0], time.on[1], time.on[2]};
}

rust::Vec<double> crowd_speeds(rust::Slice<const CrowdProbeBody> bodies,
                               const std::array<double, 3> &frame, double step, double margin) {
    std::vector<CrowdBody> members;
    for (const CrowdProbeBody &body : bodies) {
        const auto &c = body.centre;
        members.push_back({{c[0], c[1], c[2]},
                           three(body.velocity.data()),
                           body.radius,
                           body.turning,
                           body.free});
    }
    Crowd crowd;
    rust::Vec<double> speeds;
    if (crowd.gather(members, three(frame.data()), step, margin)) {
        for (std::size_t i = 0; i < members.size(); ++i) {
            speeds.push_back(crowd.speed(i));
        }
    }
    return speeds;
}

std::int64_t bytes_handed_out() {
#if defined(PLUVIA_COUNTS_BYTES)
    const auto held = mallinfo2();
    return static_cast<std::int64_t>(held.uordblks + held.hblkhd);
#else
    return -1;
#endif
}

} // namespace pluvia
