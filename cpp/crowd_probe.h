// The speeds by which boxes stand off, outside any world, for tests.
#pragma once

#include "rust/cxx.h"

#include <array>

namespace pluvia {

struct CrowdProbeBody;

// The speed of each body, as of Crowd; lengths in any one unit. Empty where
// Crowd finds none.
rust::Vec<double> crowd_speeds(rust::Slice<const CrowdProbeBody> bodies,
                               const std::array<double, 3> &frame, double step, double margin);

} // namespace pluvia
