#include "crowd_probe.h"

#include "crowd.h"
#include "pluvia/src/world/bullet/ffi.rs.h"

#include <vector>

namespace pluvia {

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

} // namespace pluvia
