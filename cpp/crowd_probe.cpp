#include "crowd_probe.h"

#include "crowd.h"
#include "pluvia/src/world/bullet/ffi.rs.h"

#include <algorithm>
#include <vector>

namespace pluvia {

rust::Vec<double> crowd_speeds(rust::Slice<const CrowdProbeBody> bodies,
                               const std::array<double, 3> &frame, double step, double margin) {
    std::vector<CrowdBody> members;
    for (const CrowdProbeBody &body : bodies) {
        CrowdBody member{};
        std::copy(body.centre.begin(), body.centre.end(), member.centre);
        std::copy(body.velocity.begin(), body.velocity.end(), member.velocity);
        member.radius = body.radius;
        member.turning = body.turning;
        member.free = body.free;
        members.push_back(member);
    }
    Crowd crowd;
    rust::Vec<double> speeds;
    if (crowd.gather(members, frame.data(), step, margin)) {
        for (std::size_t i = 0; i < members.size(); ++i) {
            speeds.push_back(crowd.speed(i));
        }
    }
    return speeds;
}

} // namespace pluvia
