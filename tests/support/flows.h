// One of each flow, at a size where a test can see what it does.
#pragma once

#include "terrain/fields/flow.h"

#include <string>
#include <vector>

namespace hoodoo::testing
{

struct NamedFlow {
    std::string name;
    FlowPtr flow;
    double longest;  ///< a duration that warps well
};

/// All kinds, sums, masks and drifts of them, about the origin, on a scale of metres.
const std::vector<NamedFlow>& named_flows();

/// The box to test them in.
Box3d flow_box();

}  // namespace hoodoo::testing
